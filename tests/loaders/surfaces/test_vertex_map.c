/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers of vertices: written, read again, and what is refused. */
#include "base/files/file.h"
#include "loaders/surfaces/vertex_map.h"
#include "test.h"

#include <conus/mesh.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 5 };

static const float leeways[COUNT] = {1.5F, NAN, -0.25F, 3e8F, INFINITY};
static const float counts[COUNT] = {0, 1, 2, 3, 4};
static const conus_vertex_map maps[2] = {{"leeway_mm", leeways}, {"a & <b>", counts}};

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
            assert_ok(vertex_map_read(&map, path, names[k], 0, NULL));
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
    assert_fails(vertex_map_read(&map, test_in("m.func.gii"), "leeway", 0, NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "called \"leeway\", one is needed of 0 \"leeway_mm\", 1 \"a & <b>\""));
    assert_fails(vertex_map_read(&map, test_in("m.func.gii"), "2", 0, NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "m.func.gii: array 2: the file has 2 of numbers (counted from 0)"));
    assert_ok(conus_write_file(test_in("t.func.gii"), "text", 4));
    assert_fails(vertex_map_read(&map, test_in("t.func.gii"), "0", 0, NULL), CONUS_ERROR_DATA);
    assert_fails(vertex_map_read(&map, test_in("none.func.gii"), "0", 0, NULL), CONUS_ERROR_IO);
    assert_null(map.values);
}

static conus_status attempt_write(void *data)
{
    return conus_vertex_maps_write(data, maps, 2, COUNT, "CortexLeft");
}

static conus_status attempt_read(void *data)
{
    struct vertex_map map = {0};
    conus_status status = vertex_map_read(&map, data, "a & <b>", 0, NULL);
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
}

TEST_GROUP(vertex_map)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_come_back),
        cmocka_unit_test(the_same_numbers_are_the_same_bytes),
        cmocka_unit_test(what_is_no_map_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
