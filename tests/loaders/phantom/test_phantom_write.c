/* SPDX-License-Identifier: BSD-3-Clause */
/* Written phantoms: the same bytes each time, also as read by numpy and nibabel. */
#include "atlas/phantom/phantom.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/volumes/volumes.h"
#include "made_atlas.h"
#include "test.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LIMIT = 1 << 24 };

static conus_volume_info small_grid(double m01)
{
    conus_volume_info info = {.dim = {2, 1, 1}};
    mat4_identity(info.world_from_voxel);
    info.world_from_voxel[0] = -2;
    info.world_from_voxel[4] = m01;
    info.world_from_voxel[12] = 7.5;
    return info;
}

static void assert_stored(uint32_t label, int code, int bits)
{
    conus_volume_info info = small_grid(0);
    struct job job = {0};
    const struct bytes file = nifti_format_labels(&job, &info, (uint32_t[]){0, label}, 2);
    assert_int_equal(file.size, 352 + bits / 4);
    assert_int_equal(file.data[70] + 256 * file.data[71], code);
    assert_int_equal(file.data[72], bits);
    for (int byte = 0; byte < bits / 8; byte++) {
        assert_int_equal(file.data[352 + bits / 8 + byte], label >> 8 * byte & 0xff);
    }
    job_end(&job);
}

static void labels_take_the_narrowest_type(void **state)
{
    (void)state;
    assert_stored(255, 2, 8);
    assert_stored(256, 512, 16);
    assert_stored(65535, 512, 16);
    assert_stored(65536, 768, 32);
    assert_stored(UINT32_MAX, 768, 32);
}

static int form_code(const struct bytes *file, int at)
{
    return file->data[at] + 256 * file->data[at + 1];
}

static void a_sheared_matrix_has_no_qform(void **state)
{
    (void)state;
    conus_volume_info info = small_grid(0.5);
    struct job job = {0};
    const struct bytes file = nifti_format_labels(&job, &info, (uint32_t[]){0, 1}, 4);
    assert_int_equal(job.status, CONUS_OK);
    assert_int_equal(form_code(&file, 252), 0);
    assert_int_equal(form_code(&file, 254), 4);
    job_end(&job);
}

static conus_status format_on(const conus_volume_info *info)
{
    struct job job = {0};
    (void)nifti_format_labels(&job, info, (uint32_t[]){0, 1}, 1);
    return job_close(&job, NULL, NULL);
}

static void impossible_grids_are_refused(void **state)
{
    (void)state;
    conus_volume_info info = small_grid(0);
    info.dim[1] = 0;
    assert_fails(format_on(&info), CONUS_ERROR_ARGUMENT);
    info.dim[1] = 32768;
    assert_fails(format_on(&info), CONUS_ERROR_ARGUMENT);
    info = small_grid(1e39);
    assert_fails(format_on(&info), CONUS_ERROR_ARGUMENT);
}

static void read_phantom(struct bytes *out, const char *folder, const char *name)
{
    struct buffer path = {0};
    buffer_format(&path, "%s/%s", folder, name);
    assert_ok(file_read(out, path.data, LIMIT));
    buffer_finish(&path);
}

static void the_same_phantom_is_the_same_bytes(void **state)
{
    (void)state;
    const conus_phantom_options options = {.size = 20, .oblique = 0.3 * 180 / MATH3_PI};
    const char *once = test_scratch("once");
    const char *again = test_scratch("again");
    assert_ok(conus_phantom_write("nested", once, &options));
    assert_ok(conus_phantom_write("nested", again, &options));
    assert_ok(conus_phantom_write("nested", again, &options)); /* overwrites the first files */
    const char *const names[] = {"nested.nii.gz", "nested.tsv", "nested.json"};
    for (size_t i = 0; i < 3; i++) {
        struct bytes a;
        struct bytes b;
        read_phantom(&a, once, names[i]);
        read_phantom(&b, again, names[i]);
        assert_int_equal(a.size, b.size);
        assert_memory_equal(a.data, b.data, a.size);
        bytes_finish(&b);
        bytes_finish(&a);
    }
}

static void the_truth_is_what_was_drawn(void **state)
{
    (void)state;
    const char *folder = test_scratch("truth");
    struct phantom_drawing drawing;
    struct bytes text;
    assert_ok(conus_phantom_write("nested", folder, NULL));
    assert_ok(phantom_draw(&drawing, "nested", NULL));
    read_phantom(&text, folder, "nested.json");
    json_t *truth = json_loadb((const char *)text.data, text.size, 0, NULL);
    assert_non_null(truth);
    for (size_t i = 0; i < 3; i++) {
        json_t *area = json_array_get(json_object_get(truth, "areas"), i);
        json_t *shape = json_array_get(json_object_get(truth, "shapes"), i);
        json_int_t label = json_integer_value(json_object_get(area, "index"));
        assert_int_equal(label, drawing.phantom->areas[i].label);
        double volume = phantom_area_volume(&drawing, (uint32_t)label);
        assert_near(json_number_value(json_object_get(area, "volume_mm3")), volume, 1e-8 * volume);
        assert_near(json_number_value(json_object_get(shape, "radius")), drawing.shapes[i].radius, 0);
    }
    json_decref(truth);
    bytes_finish(&text);
    phantom_drawing_finish(&drawing);
}

static void unwritable_folders_are_named(void **state)
{
    (void)state;
    const char *file = test_scratch("file");
    assert_ok(conus_write_file(file, "x", 1));
    assert_fails(conus_phantom_write("sphere", file, NULL), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), file));
    assert_fails(conus_phantom_write("sphere", test_scratch("no/such"), NULL), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "cannot make this folder"));
    assert_fails(conus_phantom_write("sphere", "", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_phantom_write("sphere", NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_phantom_write("ball", test_scratch("kind"), NULL), CONUS_ERROR_ARGUMENT);
    assert_int_not_equal(access(test_scratch("kind"), F_OK), 0); /* nothing is made for a wrong kind */
}

static conus_status write_small(void *data)
{
    return conus_phantom_write("tubes", data, &(conus_phantom_options){.size = 16});
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_every_allocation(write_small, (void *)test_scratch("allocations"));
}

static void compare_atlases(const conus_atlas *loaded, const conus_atlas *drawn)
{
    const struct volume *a = &loaded->volumes[0];
    const struct volume *b = &drawn->volumes[0];
    assert_int_equal(a->voxel_count, b->voxel_count);
    for (int i = 0; i < 16; i++) {
        assert_near(a->info.world_from_voxel[i], b->info.world_from_voxel[i], 0);
    }
    for (size_t voxel = 0; voxel < a->voxel_count; voxel++) {
        assert_int_equal(volume_object(a, voxel), volume_object(b, voxel));
    }
    assert_int_equal(conus_atlas_object_count(loaded), conus_atlas_object_count(drawn));
    for (size_t i = 1; i <= conus_atlas_object_count(loaded); i++) {
        const conus_object *one = conus_atlas_object(loaded, i);
        const conus_object *other = conus_atlas_object(drawn, i);
        assert_int_equal(one->label, other->label);
        assert_int_equal(one->voxels, other->voxels);
        assert_string_equal(one->name, other->name);
        assert_string_equal(one->abbreviation, other->abbreviation);
        assert_memory_equal(one->rgb, other->rgb, sizeof one->rgb);
    }
}

static void assert_sample(const char *made, const char *name)
{
    struct bytes a;
    struct bytes b;
    read_phantom(&a, CONUS_SOURCE_DIR "/data-samples", name);
    read_phantom(&b, made, name);
    assert_int_equal(a.size, b.size);
    assert_memory_equal(a.data, b.data, a.size);
    bytes_finish(&b);
    bytes_finish(&a);
}

/* The sample in this repository is the one that its README describes; the packed bytes may depend on libdeflate's
 * version, the voxels may not. */
static void the_sample_can_be_made_again(void **state)
{
    (void)state;
    const conus_phantom_options options = {.size = 32, .spacing = {2, 2, 2}};
    const char *folder = test_scratch("sample");
    conus_atlas *sample = NULL;
    struct phantom_drawing drawing;
    conus_atlas *drawn = NULL;
    assert_ok(conus_phantom_write("u-shape", folder, &options));
    assert_sample(folder, "u-shape.tsv");
    assert_sample(folder, "u-shape.json");
    assert_ok(conus_atlas_load(&sample, CONUS_SOURCE_DIR "/data-samples/u-shape.nii.gz", NULL));
    assert_ok(phantom_draw(&drawing, "u-shape", &options));
    assert_ok(phantom_drawing_atlas(&drawn, &drawing));
    compare_atlases(sample, drawn);
    conus_atlas_destroy(sample);
    conus_atlas_destroy(drawn);
    phantom_drawing_finish(&drawing);
}

/* nibabel reads the files, and numpy paints every voxel again from the truth file alone. */
static void nibabel_and_numpy_agree(void **state)
{
    (void)state;
    static const conus_phantom_options grids[] = {
        {.size = 48},
        {.size = 48, .spacing = {1, 1.5, 2.5}, .flip = {true, false, false}},
        {.size = 40, .spacing = {0.75, 0.75, 1.25}, .oblique = 0.6 * 180 / MATH3_PI, .flip = {false, true, false}},
        {.size = 40, .oblique = 2.5 * 180 / MATH3_PI, .flip = {true, true, true}},
        {.size = 32, .oblique = 180},
    };
    if (system("/usr/bin/python3 -c 'import nibabel, numpy' 2>/dev/null")) {
        print_message("skipped: no nibabel for /usr/bin/python3\n");
        skip();
    }
    for (size_t g = 0; g < sizeof grids / sizeof grids[0]; g++) {
        struct buffer command = {0};
        const char *folder = test_scratch("oracle");
        buffer_format(&command, "/usr/bin/python3 '%s/tests/oracles/phantom.py' '%s'", CONUS_SOURCE_DIR, folder);
        for (size_t i = 0; phantom_entry(i); i++) {
            assert_ok(conus_phantom_write(phantom_entry(i)->info.name, folder, &grids[g]));
            buffer_format(&command, " %s", phantom_entry(i)->info.name);
        }
        assert_int_equal(system(command.data), 0);
        buffer_finish(&command);
    }
}

static void check_reading_back(const char *kind, const conus_phantom_options *options)
{
    const char *folder = test_scratch("back");
    struct phantom_drawing drawing;
    struct buffer path = {0};
    conus_atlas *loaded = NULL;
    conus_atlas *drawn = NULL;
    assert_ok(conus_phantom_write(kind, folder, options));
    assert_ok(phantom_draw(&drawing, kind, options));
    assert_ok(phantom_drawing_atlas(&drawn, &drawing));
    buffer_format(&path, "%s/%s.nii.gz", folder, kind);
    assert_ok(conus_atlas_load(&loaded, path.data, NULL));
    compare_atlases(loaded, drawn);
    conus_atlas_destroy(loaded);
    conus_atlas_destroy(drawn);
    buffer_finish(&path);
    phantom_drawing_finish(&drawing);
}

static void what_is_written_reads_back(void **state)
{
    (void)state;
    for (size_t i = 0; phantom_entry(i); i++) {
        check_reading_back(phantom_entry(i)->info.name, &(conus_phantom_options){.size = 40});
        check_reading_back(
            phantom_entry(i)->info.name,
            &(conus_phantom_options){.size = 30, .oblique = 1 * 180 / MATH3_PI, .flip = {true, false, false}});
    }
}

TEST_GROUP(phantom_write)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_take_the_narrowest_type),    cmocka_unit_test(a_sheared_matrix_has_no_qform),
        cmocka_unit_test(impossible_grids_are_refused),      cmocka_unit_test(the_same_phantom_is_the_same_bytes),
        cmocka_unit_test(the_truth_is_what_was_drawn),       cmocka_unit_test(unwritable_folders_are_named),
        cmocka_unit_test(every_failing_allocation_is_clean), cmocka_unit_test(what_is_written_reads_back),
        cmocka_unit_test(the_sample_can_be_made_again),      cmocka_unit_test(nibabel_and_numpy_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
