/* SPDX-License-Identifier: BSD-3-Clause */
/* Telling labels from grey values: volumes made here, whose right answer is known, and real ones, whole and with every
 * 2nd, 3rd and 4th voxel. */
#include "loaders/volumes/volumes.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "conus/own.h"
#include "label_list.h"
#include "test.h"
#include "volume_on_job.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const struct grey_claims nothing;

struct voxels {
    size_t dim[3];
    uint32_t *labels;
};

static struct voxels make(size_t ni, size_t nj, size_t nk)
{
    struct voxels volume = {{ni, nj, nk}, calloc(ni * nj * nk, sizeof(uint32_t))};
    assert_non_null(volume.labels);
    return volume;
}

static size_t count_of(const struct voxels *volume)
{
    return volume->dim[0] * volume->dim[1] * volume->dim[2];
}

typedef uint32_t value_of(size_t i, size_t j, size_t k);

static struct voxels fill(size_t ni, size_t nj, size_t nk, value_of *value)
{
    struct voxels volume = make(ni, nj, nk);
    for (size_t n = 0; n < count_of(&volume); n++) {
        volume.labels[n] = value(n % ni, n / ni % nj, n / ni / nj);
    }
    return volume;
}

static struct grey_result judge(const struct voxels *volume, const struct grey_claims *claims)
{
    struct job job = {0};
    struct label_voxels labels = {0};
    assert_ok(label_voxels_of(&labels, volume->labels, count_of(volume)));
    const struct grey_result verdict = grey_judge(&job, &labels, volume->dim, claims);
    assert_ok(job_close(&job, NULL, NULL));
    label_voxels_finish(&labels);
    return verdict;
}

/* Judges a volume of n x n x n voxels and frees it. */
static struct grey_result judge_cube(size_t n, value_of *value)
{
    struct voxels volume = fill(n, n, n, value);
    struct grey_result verdict = judge(&volume, &nothing);
    free(volume.labels);
    return verdict;
}

/* A number from 0 to 99 that depends on the voxel and not on its neighbours. */
static uint32_t noise(size_t i, size_t j, size_t k)
{
    uint64_t state = (i * 1009 + j) * 1013 + k;
    return (uint32_t)test_random(&state, 0, 100);
}

static uint32_t blocks_of(size_t edge, size_t i, size_t j, size_t k)
{
    return (uint32_t)(1 + i / edge + 16 * (j / edge) + 256 * (k / edge));
}

static uint32_t blocks_of_4(size_t i, size_t j, size_t k)
{
    return blocks_of(4, i, j, k);
}

static uint32_t blocks_of_2(size_t i, size_t j, size_t k)
{
    return blocks_of(2, i, j, k);
}

static uint32_t one_mask(size_t i, size_t j, size_t k)
{
    return i > 3 && j > 4 && k > 5 ? 255 : 0;
}

static uint32_t sparse_mask(size_t i, size_t j, size_t k)
{
    return noise(i, j, k) == 0 ? 1 : 0;
}

static uint32_t scattered(size_t i, size_t j, size_t k)
{
    return noise(i, j, k) < 3 ? 1 + noise(k, i, j) : 0; /* points of 100 labels */
}

static uint32_t random_labels(size_t i, size_t j, size_t k)
{
    return 1 + noise(i, j, k);
}

/* Shells around the centre, like cortical layers or tissue classes: neighbours differ by 1 only. */
static uint32_t layers(size_t i, size_t j, size_t k)
{
    double r = hypot(hypot((double)i - 15.5, (double)j - 15.5), (double)k - 15.5);
    return r < 15 ? 1 + (uint32_t)(r / 2.5) : 0;
}

static uint32_t contacts(size_t i, size_t j, size_t k)
{
    return i % 3 == 0 && j % 8 == 0 && k % 8 == 0 ? (uint32_t)(1 + i / 3 + 11 * (j / 8) + 44 * (k / 8)) : 0;
}

static uint32_t zeros(size_t i, size_t j, size_t k)
{
    (void)i, (void)j, (void)k;
    return 0;
}

static void areas_are_labels(void **state)
{
    (void)state;
    /* In blocks of 4 voxels an edge, 24 of 31 pairs along an axis are equal; of 2 voxels, 16 of 31. */
    struct grey_result verdict = judge_cube(32, blocks_of_4);
    assert_false(verdict.grey);
    assert_near(verdict.equal, 24.0 / 31, 1e-12);
    verdict = judge_cube(32, blocks_of_2);
    assert_false(verdict.grey);
    assert_near(verdict.equal, 16.0 / 31, 1e-12);
    assert_near(verdict.needed, 0.2, 1e-12); /* 1 - 2.5 x 8^(2/3) / 8 is less */
    assert_true(verdict.telling);
}

static void masks_points_and_layers_are_labels(void **state)
{
    (void)state;
    static value_of *const labels[] = {one_mask, sparse_mask, scattered, random_labels, layers, contacts, zeros};
    for (size_t i = 0; i < sizeof labels / sizeof labels[0]; i++) {
        if (judge_cube(32, labels[i]).grey) {
            fail_msg("volume %zu is taken for an image", i);
        }
    }
}

/* Every voxel has another label: near in number to its neighbours, but there are too few voxels to tell. */
static void small_volumes_are_labels(void **state)
{
    (void)state;
    for (size_t n = 1; n <= 5; n++) {
        struct voxels volume = make(n, n, n);
        for (size_t v = 0; v < count_of(&volume); v++) {
            volume.labels[v] = (uint32_t)v + 1;
        }
        struct grey_result verdict = judge(&volume, &nothing);
        assert_false(verdict.grey);
        assert_int_equal(verdict.telling, n == 1); /* no neighbours, none of which differ */
        free(volume.labels);
    }
}

/* Noise in which each voxel is the mean of 4 x 4 x 4, as the point spread of a scanner or filter makes it. */
static uint32_t smooth_noise(size_t i, size_t j, size_t k)
{
    uint32_t sum = 0;
    for (size_t n = 0; n < 64; n++) {
        sum += noise(i + n % 4, j + n / 4 % 4, k + n / 16);
    }
    return 1 + sum / 4;
}

/* A probability of 0 to 100 percent, and the same in levels of ten, of ten subjects. */
static uint32_t percent(size_t i, size_t j, size_t k)
{
    double r2 = pow((double)i - 15, 2) + pow((double)j - 14, 2) + pow((double)k - 16, 2);
    return (uint32_t)lround(100 * exp(-r2 / 60));
}

static uint32_t tens(size_t i, size_t j, size_t k)
{
    return percent(i, j, k) / 10 * 10;
}

/* The skull-stripped noise in a background that is not 0, and with its upper part saturated. */
static uint32_t with_plateaus(size_t i, size_t j, size_t k)
{
    bool inside = i > 7 && i < 24 && j > 7 && j < 24 && k > 7 && k < 24;
    uint32_t value = smooth_noise(i, j, k);
    return !inside ? 30 : value > 900 ? 900 : value;
}

/* Steps of two voxels: resampled by the nearest neighbour. */
static uint32_t doubled(size_t i, size_t j, size_t k)
{
    return percent(i / 2 + 6, j / 2 + 6, k / 2 + 6);
}

static uint32_t ramp(size_t i, size_t j, size_t k)
{
    return (uint32_t)(i + j + k);
}

static void images_and_maps_are_grey(void **state)
{
    (void)state;
    static value_of *const images[] = {smooth_noise, percent, tens, with_plateaus, doubled, ramp};
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        struct grey_result verdict = judge_cube(32, images[i]);
        if (!verdict.grey) {
            fail_msg("volume %zu is taken for labels: %g equal, %g needed", i, verdict.equal, verdict.needed);
        }
    }
    /* In a ramp along a diagonal no two neighbours are equal. Each of its 94 values has at most 768 of 32768 voxels: no
     * plateau. */
    assert_near(judge_cube(32, ramp).equal, 0, 1e-12);
}

/* Volumes larger than those that are read as a whole, and with rows longer than the part that is counted at once. */
static void big_volumes_are_judged_by_some_of_their_planes(void **state)
{
    (void)state;
    struct voxels image = fill(110, 110, 200, ramp);
    assert_true(judge(&image, &nothing).grey);
    free(image.labels);
    struct voxels areas = fill(130, 130, 130, blocks_of_4);
    struct grey_result verdict = judge(&areas, &nothing);
    assert_false(verdict.grey);
    assert_true(verdict.equal > 0.7);
    free(areas.labels);
    struct voxels wide = fill(70000, 5, 1, ramp);
    assert_true(judge(&wide, &nothing).grey);
    /* Along i nothing is equal, nor along j. */
    assert_near(judge(&wide, &nothing).equal, 0, 1e-12);
    free(wide.labels);
}

/* Names for the labels first, first + 1, ... */
static struct label_table names_for(uint32_t first, uint32_t count)
{
    struct label_table table = {0};
    for (uint32_t i = 0; i < count; i++) {
        struct label *label = label_table_add(&table, first + i);
        assert_non_null(label);
        label->name = memory_text("area", 4);
    }
    return table;
}

static bool is_grey_with(const struct voxels *volume, uint32_t first, uint32_t count)
{
    struct label_table table = names_for(first, count);
    struct grey_result verdict = judge(volume, &(struct grey_claims){.table = &table});
    label_table_finish(&table);
    return verdict.grey;
}

/* `doubled` has about half of its neighbours equal: more than two thirds of the 0.7 that areas of its size need. */
static void a_table_about_these_values_makes_half_doubtful_ones_labels(void **state)
{
    (void)state;
    struct voxels volume = fill(32, 32, 32, doubled);
    uint32_t maximum = 0;
    uint32_t minimum = UINT32_MAX;
    for (size_t i = 0; i < count_of(&volume); i++) {
        uint32_t value = volume.labels[i];
        maximum = value > maximum ? value : maximum;
        minimum = value && value < minimum ? value : minimum;
    }
    uint32_t count = maximum - minimum + 1;
    struct grey_result verdict = judge(&volume, &nothing);
    assert_true(verdict.equal > 0.7 * 2 / 3);
    assert_true(verdict.equal < 0.65);
    assert_false(is_grey_with(&volume, minimum, count));
    assert_true(is_grey_with(&volume, minimum, count * 8 / 10)); /* names too few of the values */
    assert_true(is_grey_with(&volume, minimum, count * 3));      /* is about something else, FreeSurfer's say */
    assert_true(is_grey_with(&volume, maximum + 1000, count));   /* names none of them */
    assert_false(judge(&volume, &(struct grey_claims){.stated = true}).grey);
    free(volume.labels);
    struct voxels image = fill(32, 32, 32, percent); /* nothing makes labels of an image */
    assert_true(is_grey_with(&image, 1, 100));
    assert_true(judge(&image, &(struct grey_claims){.stated = true}).grey);
    free(image.labels);
}

typedef struct bytes formatter(struct job *job, const conus_volume_info *info, const uint32_t *values, int code);

static const char *write_file(const char *name, value_of *value, formatter *format)
{
    struct voxels volume = fill(32, 32, 32, value);
    conus_volume_info info = {.dim = {32, 32, 32}};
    struct job job = {0};
    const char *path = test_scratch(name);
    for (size_t i = 0; i < 16; i++) {
        info.world_from_voxel[i] = i % 5 == 0;
    }
    const struct bytes file = format(&job, &info, volume.labels, 1);
    (void)JOB_CALL(&job, conus_write_file(path, file.data, file.size));
    assert_ok(job_close(&job, NULL, NULL));
    free(volume.labels);
    return path;
}

static void assert_loads(const char *path, const conus_load_options *options)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, path, options));
    conus_atlas_destroy(atlas);
}

static void assert_refused(const char *path)
{
    conus_atlas *atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, path, NULL), CONUS_ERROR_DATA);
    assert_null(atlas);
    assert_non_null(strstr(conus_message(), path));
    assert_non_null(strstr(conus_message(), "looks like an image, not like labels"));
    assert_non_null(strstr(conus_message(), "--context"));
    assert_non_null(strstr(conus_message(), "--pathway"));
    assert_non_null(strstr(conus_message(), "--labels-anyway"));
    assert_null(strchr(conus_message(), '\n'));
}

static const conus_load_options anyway = {.labels_anyway = true};

static void an_image_is_no_atlas(void **state)
{
    (void)state;
    const char *image = write_file("t1.nii", smooth_noise, nifti_format_values);
    assert_refused(image);
    assert_loads(image, &anyway);
    assert_loads(write_file("blocks.nii", blocks_of_4, nifti_format_values), NULL);
    assert_loads(write_file("intent.nii", smooth_noise, nifti_format_labels), NULL); /* code 1002: labels */
}

static void a_name_or_an_fsl_atlas_may_state_labels(void **state)
{
    (void)state;
    static const char xml[] = "<atlas><type>Label</type><images><imagefile>/doubled</imagefile></images>"
                              "<label index=\"1\">one</label></atlas>";
    const char *path = write_file("doubled.nii", doubled, nifti_format_values);
    assert_refused(path);
    assert_loads(write_file("sub-1_dseg.nii", doubled, nifti_format_values), NULL);
    assert_refused(write_file("sub-2_dseg.nii", smooth_noise, nifti_format_values));
    assert_refused(write_file("sub-3_dsegs.nii", doubled, nifti_format_values));
    const char *atlas = test_scratch("atlas.xml");
    assert_ok(conus_write_file(atlas, xml, sizeof xml - 1));
    assert_loads(atlas, NULL);
    remove(atlas);
}

static void a_manifest_s_parcellation_is_judged_too(void **state)
{
    (void)state;
    static const char text[] = "{\"conus_atlas\": 1, \"parcellation\": \"t1.nii\"}";
    write_file("t1.nii", smooth_noise, nifti_format_values);
    const char *manifest = test_scratch("scene.atlas.json");
    assert_ok(conus_write_file(manifest, text, sizeof text - 1));
    assert_refused(manifest);
    assert_non_null(strstr(conus_message(), "parcellation: "));
    assert_loads(manifest, &anyway);
}

static void what_is_not_whole_is_told_where_it_belongs(void **state)
{
    (void)state;
    const char *path = write_file("half.nii", blocks_of_4, nifti_format_values);
    conus_atlas *atlas = NULL;
    struct bytes file = {0};
    float slope = 0.5F; /* scl_slope, at byte 112 of NIfTI-1 */
    assert_ok(file_read(&file, path, 1 << 20));
    memcpy(file.data + 112, &slope, sizeof slope);
    assert_ok(conus_write_file(path, file.data, file.size));
    bytes_finish(&file);
    assert_fails(conus_atlas_load(&atlas, path, &anyway), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "allowed labels are whole numbers"));
    assert_non_null(strstr(conus_message(), "--context"));
    assert_null(strstr(conus_message(), "--labels-anyway"));
}

static conus_status load_image(void *path)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, path, NULL);
    conus_atlas_destroy(atlas);
    return status == CONUS_ERROR_DATA ? CONUS_OK : status; /* refused, as it should be */
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    char path[256];
    snprintf(path, sizeof path, "%s", write_file("again.nii", smooth_noise, nifti_format_values));
    test_every_allocation(load_image, path);
}

/* Every step-th voxel along each axis, as resampling to a coarser grid by nearest neighbour gives. */
static size_t thinned(size_t edge, size_t step)
{
    return (edge - step / 2 + step - 1) / step;
}

static struct voxels thin_out(const uint32_t *labels, const size_t dim[3], size_t step)
{
    struct voxels out = make(thinned(dim[0], step), thinned(dim[1], step), thinned(dim[2], step));
    for (size_t n = 0; n < count_of(&out); n++) {
        size_t i = n % out.dim[0] * step + step / 2;
        size_t j = n / out.dim[0] % out.dim[1] * step + step / 2;
        size_t k = n / out.dim[0] / out.dim[1] * step + step / 2;
        out.labels[n] = labels[(k * dim[1] + j) * dim[0] + i];
    }
    return out;
}

/* Judges the values alone, without header and name. */
static void check_real(const char *path, bool grey, size_t steps)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    assert_ok(volume_file_open(&file, path, 0, &notes));
    assert_ok(label_list_read(&labels, &file));
    for (size_t step = 1; step <= steps; step++) {
        struct voxels volume = thin_out(labels, file.info.dim, step);
        struct grey_result verdict = judge(&volume, &nothing);
        if (verdict.grey != grey) {
            fail_msg("%s, every %zu. voxel: %s (%g equal, %g needed)", path, step, grey ? "labels" : "grey",
                     verdict.equal, verdict.needed);
        }
        free(volume.labels);
    }
    memory_free(labels);
    notes_finish(&notes);
    volume_file_finish(&file);
}

/* The steps make 1, 2, 3 and 4 mm of 1 mm; of 2 mm, 4, 6 and 8 mm. */
static void mricron_s_templates_are_what_they_are(void **state)
{
    (void)state;
    static const char *const labels[] = {"aal",
                                         "AICHAmc",
                                         "brodmann",
                                         "HarvardOxford-cort-maxprob-thr0-1mm",
                                         "JHU-WhiteMatter-labels-1mm",
                                         "JHU-WhiteMatter-labels-2mm",
                                         "jhu189",
                                         "natbrainlab",
                                         "inia19-NeuroMaps"};
    static const char *const images[] = {"ch2", "ch2bet", "ch2better"};
    char name[64];
    for (size_t i = 0; i < test_trials(sizeof labels / sizeof labels[0]); i++) {
        snprintf(name, sizeof name, "%s.nii.gz", labels[i]);
        check_real(test_mricron(name), false, 4);
    }
    for (size_t i = 0; i < test_trials(sizeof images / sizeof images[0]); i++) {
        snprintf(name, sizeof name, "%s.nii.gz", images[i]);
        check_real(test_mricron(name), true, 4);
    }
}

static void shared_volumes_are_what_they_are(void **state)
{
    (void)state;
    static const char *const labels[] = {"labelvol/julich31/JulichBrainAtlas31_LH.nii.gz",
                                         "labelvol/julich31/JulichBrainAtlas31_RH.nii.gz",
                                         "labelvol/bigbrain-subcort/bigbrain.nii.gz",
                                         "prob/fsl/atlases/JHU/JHU-ICBM-labels-1mm.nii.gz",
                                         "prob/fsl/atlases/JHU/JHU-ICBM-labels-2mm.nii.gz",
                                         "prob/fsl/atlases/JHU/JHU-ICBM-tracts-maxprob-thr25-1mm.nii.gz",
                                         "prob/fsl/atlases/JHU/JHU-ICBM-tracts-maxprob-thr25-2mm.nii.gz",
                                         "prob/fsl/atlases/Thalamus/Thalamus-maxprob-thr25-2mm.nii.gz",
                                         "hostile/nifti-reader-js/with_extension.nii.gz"};
    static const char *const images[] = {"bonsai/bonsai.nii.gz",
                                         "tracts/fsleyes/dipy_ref.nii.gz",
                                         "hostile/nifti-rs/avg152T1_LR_nifti.nii.gz",
                                         "hostile/nibabel/example4d.nii.gz,volume=0",
                                         "hostile/nibabel/example_nifti2.nii.gz,volume=1",
                                         "prob/fsl/atlases/JHU/JHU-ICBM-tracts-prob-1mm.nii.gz,volume=3",
                                         "prob/fsl/atlases/JHU/JHU-ICBM-tracts-prob-2mm.nii.gz,volume=19",
                                         "prob/fsl/atlases/Thalamus/Thalamus-prob-2mm.nii.gz,volume=6",
                                         "prob/juelich-fibre-pathways-u16/Callosal_body.nii.gz",
                                         "prob/juelich-fibre-pathways-u16/Uncinate_fascicle_R.nii.gz"};
    test_shared("labelvol");
    for (size_t i = 0; i < test_trials(sizeof labels / sizeof labels[0]); i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", test_shared(""), labels[i]);
        check_real(path, false, 4);
    }
    for (size_t i = 0; i < test_trials(sizeof images / sizeof images[0]); i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", test_shared(""), images[i]);
        check_real(path, true, 1);
    }
}

TEST_GROUP(grey)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_are_labels),
        cmocka_unit_test(masks_points_and_layers_are_labels),
        cmocka_unit_test(small_volumes_are_labels),
        cmocka_unit_test(images_and_maps_are_grey),
        cmocka_unit_test(big_volumes_are_judged_by_some_of_their_planes),
        cmocka_unit_test(a_table_about_these_values_makes_half_doubtful_ones_labels),
        cmocka_unit_test(an_image_is_no_atlas),
        cmocka_unit_test(a_name_or_an_fsl_atlas_may_state_labels),
        cmocka_unit_test(a_manifest_s_parcellation_is_judged_too),
        cmocka_unit_test(what_is_not_whole_is_told_where_it_belongs),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(mricron_s_templates_are_what_they_are),
        cmocka_unit_test(shared_volumes_are_what_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
