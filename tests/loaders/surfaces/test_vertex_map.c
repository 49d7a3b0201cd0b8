/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers of vertices: written, read again, or refused. */
#include "base/files/file.h"
#include "loaders/surfaces/surfaces.h"
#include "test.h"
#include <conus/own.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 5 };

static const float leeways[COUNT] = {1.5F, NAN, -0.25F, 3e8F, INFINITY};
static const float counts[COUNT] = {0, 1, 2, 3, 4};
static const conus_vertex_map maps[2] = {{"leeway_mm", leeways, NULL}, {"a & <b>", counts, NULL}};

static conus_status read_map(struct vertex_map *out, const char *path, const char *name)
{
    struct job job = {0};
    *out = vertex_map_read(&job, path, name);
    return job_close(&job, NULL, NULL);
}

/* A number that is not finite comes back as NaN, all others bit for bit. */
static void numbers_come_back(void **state)
{
    (void)state;
    test_folder("maps");
    for (int shape = 0; shape < 2; shape++) {
        const char *path = test_in(shape ? "m.shape.gii" : "m.func.gii");
        assert_ok(conus_vertex_maps_write(path, maps, 2, COUNT, shape ? "CortexRight" : NULL));
        for (int k = 0; k < 4; k++) {
            static const char *const names[] = {"leeway_mm", "a & <b>", "0", "1"};
            struct vertex_map map = {0};
            assert_ok(read_map(&map, path, names[k]));
            assert_int_equal(map.count, COUNT);
            assert_int_equal(map.hemisphere, shape ? 'R' : 0);
            for (size_t v = 0; v < COUNT; v++) {
                float wanted = k % 2 ? counts[v] : leeways[v];
                assert_true(isfinite(wanted) ? map.values[v] == wanted : isnan(map.values[v]));
            }
            assert_string_equal(map.name, names[k % 2]);
            vertex_map_finish(&map);
        }
    }
}

static void the_same_numbers_are_the_same_bytes(void **state)
{
    (void)state;
    struct bytes a = {0};
    struct bytes b = {0};
    test_folder("same");
    assert_ok(conus_vertex_maps_write(test_in("a.func.gii"), maps, 2, COUNT, "Other"));
    assert_ok(conus_vertex_maps_write(test_in("b.func.gii"), maps, 2, COUNT, "Other"));
    assert_ok(file_read(&a, test_in("a.func.gii"), 1 << 20));
    assert_ok(file_read(&b, test_in("b.func.gii"), 1 << 20));
    assert_int_equal(a.size, b.size);
    assert_memory_equal(a.data, b.data, a.size);
    bytes_finish(&a);
    bytes_finish(&b);
}

static void what_is_no_map_is_refused(void **state)
{
    (void)state;
    struct vertex_map map = {0};
    test_folder("bad");
    assert_fails(conus_vertex_maps_write(test_in("m.gii"), maps, 2, COUNT, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_vertex_maps_write(NULL, maps, 2, COUNT, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_vertex_maps_write(test_in("m.func.gii"), maps, 0, COUNT, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_vertex_maps_write(test_in("m.func.gii"), maps, 2, 0, NULL), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_vertex_maps_write(test_in("m.func.gii"), maps, 2, COUNT, NULL));
    assert_fails(read_map(&map, test_in("m.func.gii"), "leeway"), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "called \"leeway\", one is needed of 0 \"leeway_mm\", 1 \"a & <b>\""));
    assert_fails(read_map(&map, test_in("m.func.gii"), "2"), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "m.func.gii: array 2: the file has 2 of numbers (counted from 0)"));
    assert_ok(conus_write_file(test_in("t.func.gii"), "text", 4));
    assert_fails(read_map(&map, test_in("t.func.gii"), "0"), CONUS_ERROR_DATA);
    assert_fails(read_map(&map, test_in("none.func.gii"), "0"), CONUS_ERROR_IO);
    assert_null(map.values);
}

/* Whole numbers are exact in float32 up to 2^24; larger ones are stored in two arrays. */
static void whole_numbers_come_back(void **state)
{
    (void)state;
    static const uint64_t numbers[2][COUNT] = {{0, 1, 16777216, 16777215, 7},
                                               {0, 16777217, UINT64_C(1) << 40, 3000000, 1}};
    test_folder("whole");
    for (int is_large = 0; is_large < 2; is_large++) {
        const conus_vertex_map map = {.name = "candidate", .numbers = numbers[is_large]};
        struct vertex_map read[2] = {{0}};
        const char *path = test_in("w.func.gii");
        assert_ok(conus_vertex_maps_write(path, &map, 1, COUNT, NULL));
        assert_ok(read_map(&read[0], path, "candidate"));
        if (is_large) {
            assert_ok(read_map(&read[1], path, "candidate_millions"));
        } else {
            assert_fails(read_map(&read[1], path, "1"), CONUS_ERROR_ARGUMENT);
        }
        for (size_t v = 0; v < COUNT; v++) {
            double number = (double)read[0].values[v] + (is_large ? 1e6 * (double)read[1].values[v] : 0);
            assert_true(numbers[is_large][v] ? number == (double)numbers[is_large][v] : isnan(number));
        }
        vertex_map_finish(&read[0]);
        vertex_map_finish(&read[1]);
    }
}

/* The vertices of a surface, then the voxels of a mask. */
static conus_status write_sites(void *data)
{
    static const uint64_t candidates[8] = {UINT64_C(1) << 30, 2, 3, 4, 5, 6, 7, 8};
    static const float values[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    static const uint8_t mask[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    const conus_vertex_map both[2] = {{.name = "leeway_mm", .values = values},
                                      {.name = "candidate", .numbers = candidates}};
    const conus_voxels voxels = {.data = mask,
                                 .type = CONUS_SCALAR_UINT8,
                                 .dim = {2, 2, 2},
                                 .world_from_voxel = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    const char *const *paths = data;
    conus_roi *roi = NULL;
    conus_sites *sites[2] = {NULL, NULL};
    conus_status status = conus_sites_load(&sites[0], paths[0], false);
    status = status ? status : conus_sites_write_maps(paths[1], sites[0], both, 2, NULL, 100);
    status = status ? status : conus_roi_create(&roi, &voxels, NULL);
    status = status ? status : conus_sites_of_roi(&sites[1], roi);
    status = status ? status : conus_sites_write_maps(paths[2], sites[1], both, 2, NULL, 0);
    conus_roi_destroy(roi);
    conus_sites_destroy(sites[0]);
    conus_sites_destroy(sites[1]);
    return status;
}

static conus_status attempt_write(void *data)
{
    return conus_vertex_maps_write(data, maps, 2, COUNT, "CortexLeft");
}

static conus_status attempt_read(void *data)
{
    struct vertex_map map = {0};
    conus_status status = read_map(&map, data, "a & <b>");
    vertex_map_finish(&map);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    char path[512];
    test_folder("memory");
    snprintf(path, sizeof path, "%s", test_in("m.func.gii"));
    test_every_allocation(attempt_write, path);
    test_every_allocation(attempt_read, path);
    assert_true(test_every_primitive(attempt_write, path) > 5);
    assert_true(test_every_primitive(attempt_read, path) > 20);
    static const char surface[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                                  "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
                                  "end_header\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    char names[3][512];
    const char *paths[3] = {names[0], names[1], names[2]};
    snprintf(names[0], sizeof names[0], "%s", test_in("t.ply"));
    snprintf(names[1], sizeof names[1], "%s", test_in("s.func.gii"));
    snprintf(names[2], sizeof names[2], "%s", test_in("s.nii.gz"));
    assert_ok(file_write(names[0], surface, sizeof surface - 1));
    test_every_allocation(write_sites, paths);
}

TEST_GROUP(vertex_map)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_come_back),        cmocka_unit_test(the_same_numbers_are_the_same_bytes),
        cmocka_unit_test(whole_numbers_come_back),  cmocka_unit_test(what_is_no_map_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
