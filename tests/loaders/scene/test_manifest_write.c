/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_manifest_write(): the kinds that it finds, and loading the manifests that it writes. */
#include "base/files/file.h"
#include "base/memory.h"
#include "builders/gifti_builder.h"
#include "conus/own.h"
#include "loaders/manifest/manifest.h"
#include "loaders/volumes/volumes.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A volume of 8 x 8 x 8 voxels with these values. */
static conus_status write_volume(const char *name, uint32_t (*value)(size_t i))
{
    conus_volume_info info = {.dim = {8, 8, 8}};
    uint32_t values[512];
    struct job job = {0};
    for (size_t i = 0; i < 16; i++) {
        info.world_from_voxel[i] = i % 5 == 0;
    }
    for (size_t i = 0; i < 512; i++) {
        values[i] = value(i);
    }
    const struct bytes file = nifti_format_values(&job, &info, values, 1);
    (void)JOB_CALL(&job, conus_write_file(test_in(name), file.data, file.size));
    return job_close(&job, NULL, NULL);
}

static uint32_t in_blocks(size_t i)
{
    return (uint32_t)(i / 128 * 7); /* 0, 7, 14, 21 */
}

static uint32_t in_a_spot(size_t i)
{
    return i > 200 && i < 260 ? (uint32_t)i : 0;
}

/* An image: most neighbours differ, by little. (Numbers without order would be labels.) */
static uint32_t everywhere(size_t i)
{
    return (uint32_t)(1 + 11 * (i % 8 + i / 8 % 8 + i / 64));
}

static int write_files(void **state)
{
    (void)state;
    test_folder("folder");
    conus_status status = write_volume("blocks.nii", in_blocks);
    status = status ? status : write_volume("spot.nii", in_a_spot);
    return status || write_volume("t1.nii", everywhere);
}

static conus_status guess_of(struct volume_guess *out, const char *path, uint64_t max_memory)
{
    struct job job = {.max_memory = max_memory};
    volume_guess_make(&job, out, path);
    return job_close(&job, NULL, NULL);
}

static void volumes_are_detected_from_their_values(void **state)
{
    (void)state;
    struct volume_guess guess;
    assert_ok(guess_of(&guess, test_in("blocks.nii"), 0));
    assert_int_equal(guess.use, VOLUME_LABELS);
    assert_ok(guess_of(&guess, test_in("spot.nii"), 0));
    assert_int_equal(guess.use, VOLUME_PATHWAY);
    assert_ok(guess_of(&guess, test_in("t1.nii"), 0));
    assert_int_equal(guess.use, VOLUME_CONTEXT);
    assert_fails(guess_of(&guess, test_in("none.nii"), 0), CONUS_ERROR_IO);
}

static uint32_t nothing(size_t i)
{
    (void)i;
    return 0;
}

static uint32_t mask(size_t i)
{
    return i < 40 ? 7 : 0; /* one value: a mask, however compact */
}

/* Thin areas, in slices of one voxel: along i and j half of the neighbours are 0, and two in three are equal. */
static uint32_t in_slices(size_t i)
{
    return (uint32_t)(i / 64 % 2 * (1 + i / 64));
}

static void masks_and_nothing_are_no_parcellation(void **state)
{
    (void)state;
    struct volume_guess guess;
    assert_ok(write_volume("mask.nii", mask));
    assert_ok(write_volume("slices.nii", in_slices));
    assert_ok(write_volume("nothing.nii", nothing));
    assert_ok(guess_of(&guess, test_in("mask.nii"), 0));
    assert_int_equal(guess.use, VOLUME_PATHWAY);
    assert_ok(guess_of(&guess, test_in("slices.nii"), 0));
    assert_int_equal(guess.use, VOLUME_LABELS);
    assert_fails(guess_of(&guess, test_in("nothing.nii"), 0), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "all of its values are 0"));
    remove(test_in("mask.nii"));
    remove(test_in("slices.nii"));
    remove(test_in("nothing.nii"));
}

static void names_give_labels_or_do_not(void **state)
{
    (void)state;
    static char *const numbers[] = {"01_a.gii", "2_b.gii", "x10.gii"};
    static char *const twice[] = {"01_a.gii", "1_b.gii"};
    static char *const some[] = {"01_a.gii", "b.gii"};
    static char *const none[] = {"a.gii", "b.gii"};
    static char *const zero[] = {"0.gii", "1.gii"};
    assert_true(surface_names_give_labels(&(struct names){(char **)numbers, 3}));
    assert_false(surface_names_give_labels(&(struct names){(char **)twice, 2}));
    assert_false(surface_names_give_labels(&(struct names){(char **)some, 2}));
    assert_true(surface_names_give_labels(&(struct names){(char **)none, 2}));
    assert_false(surface_names_give_labels(&(struct names){(char **)zero, 2}));
}

static void names_tell_left_from_right(void **state)
{
    (void)state;
    static const struct {
        const char *left, *right;
        bool halves;
    } cases[] = {
        {"x_LH.nii.gz", "x_RH.nii.gz", true},
        {"lh.aparc.mgz", "rh.aparc.mgz", true},
        {"sub-1_hemi-L_dseg.nii", "sub-1_hemi-R_dseg.nii", true},
        {"Julich left 31.nii", "Julich right 31.nii", true},
        {"aal_l.nii.gz", "aal_r.nii.gz", true},
        {"x_L_left.nii", "x_R_left.nii", true}, /* in one of its words */
        {"x_RH.nii.gz", "x_LH.nii.gz", false},
        {"x_LH.nii.gz", "x_RH.nii", false},
        {"x_LH.nii.gz", "y_RH.nii.gz", false},
        {"x_L_left.nii", "x_R_right.nii", false},
        {"x_LH.nii.gz", "x_Rh.nii.gz", false},
        {"small.nii", "large.nii", false},
        {"a_l_b.nii", "a_r_b.nii", false}, /* a letter between words */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct job job = {0};
        bool halves = volume_names_are_halves(&job, cases[i].left, cases[i].right);
        assert_ok(job_close(&job, NULL, NULL));
        assert_int_equal(halves, cases[i].halves);
    }
}

static uint32_t on_the_left(size_t i)
{
    return i % 8 < 4 ? in_blocks(i) : 0;
}

static uint32_t on_the_right(size_t i)
{
    return i % 8 < 4 ? 0 : in_blocks(i);
}

static uint32_t with_other_labels(size_t i)
{
    return on_the_right(i) ? 100 + on_the_right(i) : 0;
}

/* A folder of a left and a right parcellation becomes an atlas with `labels` of its areas, three on each side. */
static void assert_halves(const char *folder, uint32_t (*right)(size_t i), const uint32_t labels[6])
{
    conus_atlas *atlas = NULL;
    test_folder(folder);
    assert_ok(write_volume("lh.nii", on_the_left));
    assert_ok(write_volume("rh.nii", right));
    assert_ok(conus_manifest_write(test_in("pair.atlas.json"), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("pair.atlas.json"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 6);
    for (size_t i = 0; i < 6; i++) {
        assert_int_equal(conus_atlas_object(atlas, i + 1)->label, labels[i]);
        assert_int_equal(conus_atlas_object(atlas, i + 1)->hemisphere, i < 3 ? 'L' : 'R');
    }
    conus_atlas_destroy(atlas);
}

static void halves_are_joined(void **state)
{
    (void)state;
    assert_halves("distinct", with_other_labels, (const uint32_t[]){7, 14, 21, 107, 114, 121});
    assert_halves("alike", on_the_right, (const uint32_t[]){7, 14, 21, 1007, 1014, 1021});
    test_folder("folder");
}

static void what_is_written_loads(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    remove(test_in("scene.atlas.json"));
    assert_ok(conus_manifest_write(test_in("scene.atlas.json"), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("scene.atlas.json"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    assert_string_equal(conus_atlas_object(atlas, 4)->name, "spot");
    assert_int_equal(conus_atlas_volume(atlas, 2)->role, CONUS_ROLE_CONTEXT);
    conus_atlas_destroy(atlas);
    assert_fails(conus_manifest_write(test_in("scene.atlas.json"), NULL), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "there is a file already, which is not replaced"));
    assert_fails(conus_manifest_write(test_in("none/scene.atlas.json"), NULL), CONUS_ERROR_IO);
    assert_fails(conus_manifest_write("", NULL), CONUS_ERROR_ARGUMENT);
}

static conus_status write_again(void *data)
{
    remove(data);
    return conus_manifest_write(data, NULL);
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    char path[512];
    snprintf(path, sizeof path, "%s", test_in("again.atlas.json"));
    assert_true(test_every_primitive(write_again, path) > 5);
    test_every_allocation(write_again, path);
    test_folder("alike");
    snprintf(path, sizeof path, "%s", test_in("again.atlas.json"));
    test_every_allocation(write_again, path);
}

static void count_notes(void *user, const conus_note *note)
{
    static const char words[] = "blocks.nii and surfaces: areas that are in both are there twice: take one out of the";
    *(int *)user += strncmp(note->line, words, strlen(words)) == 0;
}

/* Only the user can know whether surfaces belong to the parcellation's own areas. */
static void surfaces_beside_a_parcellation_are_noted(void **state)
{
    (void)state;
    int count = 0;
    const conus_manifest_options options = {.log = count_notes, .log_user = &count};
    struct buffer bytes = {0};
    test_folder("both");
    assert_ok(write_volume("blocks.nii", in_blocks));
    assert_ok(conus_manifest_write(test_in("one.atlas.json"), &options));
    assert_int_equal(count, 0);
    gifti_begin(&bytes, "", 2);
    gifti_append_tetrahedron(&bytes, "ASCII");
    gifti_end(&bytes);
    assert_ok(conus_write_file(test_in("a.gii"), bytes.data, bytes.size));
    buffer_finish(&bytes);
    assert_ok(conus_manifest_write(test_in("two.atlas.json"), &options));
    assert_int_equal(count, 1);
}

static uint32_t in_percent(size_t i)
{
    return i < 40 ? 70 : 0;
}

/* In percent, as the name says: alone it is an area, beside a parcellation a pathway, before the others. */
static void probabilities_stand_alone(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    char path[512];
    test_folder("probable");
    snprintf(path, sizeof path, "%s", test_in("scene.atlas.json"));
    assert_ok(write_volume("x_probseg.nii", in_percent));
    assert_true(test_every_primitive(write_again, path) > 5);
    test_every_allocation(write_again, path);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 1);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "x_probseg");
    assert_int_equal(conus_atlas_volume(atlas, 0)->role, CONUS_ROLE_PROBABILITY);
    conus_atlas_destroy(atlas);
    assert_ok(write_volume("blocks.nii", in_blocks));
    assert_ok(write_volume("spot.nii", in_a_spot));
    test_every_allocation(write_again, path);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 5);
    assert_int_equal(conus_atlas_object(atlas, 3)->kind, CONUS_KIND_AREA);
    assert_string_equal(conus_atlas_object(atlas, 4)->name, "x_probseg");
    assert_string_equal(conus_atlas_object(atlas, 5)->name, "spot");
    assert_int_equal(conus_atlas_volume(atlas, 1)->role, CONUS_ROLE_SCALAR);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(manifest_write)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_are_detected_from_their_values),
        cmocka_unit_test(masks_and_nothing_are_no_parcellation),
        cmocka_unit_test(names_give_labels_or_do_not),
        cmocka_unit_test(names_tell_left_from_right),
        cmocka_unit_test(halves_are_joined),
        cmocka_unit_test(what_is_written_loads),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(surfaces_beside_a_parcellation_are_noted),
        cmocka_unit_test(probabilities_stand_alone),
    };
    return cmocka_run_group_tests(tests, write_files, NULL);
}
