/* SPDX-License-Identifier: BSD-3-Clause */
/* Sparse maps of values against the arrays from which they are made, bit by bit. */
#include "atlas/volume.h"

#include "base/memory.h"
#include "test.h"
#include "value_maps.h"

#include <math.h>
#include <string.h>

enum { MOST = 3 * VALUE_PAGE };

/* Runs of random length, some of them background, with values that are hard to keep. */
static void make_values(float *values, size_t count, double full, uint64_t *random)
{
    static const float odd[] = {0.0F, -0.0F, NAN, -3.5F, INFINITY, -INFINITY, 1e-45F, 0.25F};
    const float background = odd[(size_t)test_random(random, 0, 8)];
    for (size_t v = 0, end; v < count; v = end) {
        bool is_full = test_random(random, 0, 1) < full;
        size_t run = 1 + (size_t)test_random(random, 0, test_random(random, 0, 1) < 0.1 ? VALUE_PAGE : 90);
        end = v + run < count ? v + run : count;
        for (size_t i = v; i < end; i++) {
            values[i] = is_full ? odd[(size_t)test_random(random, 0, 8)] : background;
        }
    }
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Counts the runs of an array with a voxel that differs from the first one: the definition. */
static size_t count_runs(const float *values, size_t count)
{
    size_t runs = 0;
    for (size_t first = 0; first < count; first += VALUE_RUN) {
        bool differs = false;
        for (size_t v = first; v < count && v < first + VALUE_RUN; v++) {
            differs = differs || bits_of(values[v]) != bits_of(values[0]);
        }
        runs += differs;
    }
    return runs;
}

static void check_map(const struct value_map *map, const float *values, size_t count)
{
    assert_true(value_map_is_sound(map, count));
    assert_int_equal(map->run_count, 1 + count_runs(values, count));
    for (size_t v = 0; v < count; v++) {
        float value = value_map_at(map, v);
        assert_memory_equal(&value, &values[v], sizeof value);
    }
    for (size_t v = 0; v < count; v++) {
        size_t next = value_map_next(map, v);
        assert_true(next >= v && next <= count && (next == v || next == count || next % VALUE_RUN == 0));
        for (size_t i = v; i < next && i < v + VALUE_RUN; i++) {
            assert_memory_equal(&values[i], &values[0], sizeof *values);
        }
    }
    assert_int_equal(value_map_next(map, count), count);
}

static void a_map_holds_what_it_was_made_of(void **state)
{
    (void)state;
    uint64_t random = 40;
    static float values[MOST];
    for (size_t round = 0; round < test_trials(200); round++) {
        static const double full[] = {0, 0.02, 0.3, 1};
        size_t count = 1 + (size_t)test_random(&random, 0, round % 3 ? MOST : 2 * VALUE_RUN);
        count -= round % 5 ? 0 : count > VALUE_RUN ? count % VALUE_RUN : 0; /* also whole runs */
        struct value_map map;
        struct value_map copy;
        make_values(values, count, full[round % 4], &random);
        assert_ok(value_map_of(&map, values, count));
        check_map(&map, values, count);
        assert_ok(value_map_copy(&copy, &map));
        value_map_finish(&map);
        check_map(&copy, values, count);
        value_map_finish(&copy);
    }
}

/* Copies bytes as codes, and adds to `user` how many were asked for. */
static void copy_bytes(void *user, void *codes, const uint8_t *stored, size_t count)
{
    *(size_t *)user += count;
    memcpy(codes, stored, count);
}

/* A box of 10 x 10 x 10 voxels in a background of 100 x 100 x 100 takes at most two runs of each of its rows. */
static void background_takes_no_memory(void **state)
{
    (void)state;
    enum { EDGE = 100, BOX = 10 };
    static uint8_t stored[EDGE * EDGE * EDGE];
    static float table[256];
    struct value_map map;
    size_t coded = 0;
    for (size_t v = 0; v < sizeof stored; v++) {
        const size_t at[3] = {v % EDGE, v / EDGE % EDGE, v / EDGE / EDGE};
        bool inside = at[0] / BOX == 4 && at[1] / BOX == 5 && at[2] / BOX == 6;
        stored[v] = inside ? (uint8_t)(1 + v % 255) : 0;
    }
    for (size_t i = 0; i < 256; i++) {
        table[i] = (float)i / 4;
    }
    assert_ok(value_map_init(&map, stored, 1, sizeof stored, 1, copy_bytes, &coded));
    assert_true(map.run_count > BOX * BOX / 2 && map.run_count <= 1 + 2 * BOX * BOX);
    assert_int_equal(coded, 1 + (map.run_count - 1) * VALUE_RUN); /* no run is the last, which is shorter */
    map.table = memory_copy(table, 256, sizeof *table);
    map.table_count = 256;
    assert_true(value_map_is_sound(&map, sizeof stored));
    for (size_t v = 0; v < sizeof stored; v++) {
        assert_true(value_map_at(&map, v) == table[stored[v]]);
    }
    map.table_count = 200; /* a code beyond, as damage makes it, is not followed */
    for (size_t v = 0; v < sizeof stored; v++) {
        assert_true(value_map_at(&map, v) == table[stored[v] < 200 ? stored[v] : 0]);
    }
    value_map_finish(&map);
}

/* Counted voxel by voxel, over a sparse map whose last run ends early, for backgrounds on both sides of the bounds. */
static void voxels_above_a_bound_are_counted(void **state)
{
    (void)state;
    enum { COUNT = 3 * VALUE_PAGE + 37 };
    static const double bounds[] = {-1, 0, 1.5, 7};
    for (int background = -2; background <= 8; background += 5) {
        static float values[COUNT];
        uint64_t wanted[4] = {0};
        uint64_t above[4] = {0};
        struct value_map map;
        for (size_t v = 0; v < COUNT; v++) {
            values[v] = v && (v % 701 < 3 || v > COUNT - 5) ? (float)(v % 11) : (float)background;
            for (size_t b = 0; b < 4; b++) {
                wanted[b] += (double)values[v] > bounds[b];
            }
        }
        assert_ok(value_map_of(&map, values, COUNT));
        value_map_spread(above, &map, bounds, 4);
        assert_memory_equal(above, wanted, sizeof wanted);
        value_map_finish(&map);
    }
}

static void values_are_divided_and_masks_found(void **state)
{
    (void)state;
    static const struct {
        float values[4];
        bool is_mask;
    } cases[] = {{{0, 0, 0, 0}, true},    {{0, 3, 3, 0}, true},   {{3, 3, 3, 3}, true},
                 {{3, 0, 3, 3}, true},    {{0, 3, 2, 0}, false},  {{2, 3, 3, 3}, false},
                 {{0, NAN, 0, 0}, false}, {{-1, 0, 0, -1}, true}, {{-1, 1, 0, 0}, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct value_map map;
        assert_ok(value_map_of(&map, cases[i].values, 4));
        assert_int_equal(value_map_is_mask(&map), cases[i].is_mask);
        value_map_divide(&map, 3);
        for (size_t v = 0; v < 4; v++) {
            float wanted = cases[i].values[v] < 0 ? 0 : (float)((double)cases[i].values[v] / 3);
            float value = value_map_at(&map, v);
            assert_memory_equal(&value, &wanted, sizeof value);
        }
        value_map_finish(&map);
    }
}

static void unsound_maps_are_found(void **state)
{
    (void)state;
    static float values[2 * VALUE_PAGE];
    values[VALUE_PAGE + 5] = 1;
    struct value_map map;
    assert_ok(value_map_of(&map, values, 2 * VALUE_PAGE));
    assert_true(value_map_is_sound(&map, 2 * VALUE_PAGE));
    assert_false(value_map_is_sound(&map, 2 * VALUE_PAGE - 1));
    uint32_t *const numbers[] = {&map.pages[1], &map.pages[2], &map.runs[0], &map.runs[2 * VALUE_RUNS - 1]};
    for (size_t i = 0; i < 4; i++) {
        uint32_t was = *numbers[i];
        *numbers[i] = 2; /* there are two pages and two runs: 0 and 1 */
        assert_false(value_map_is_sound(&map, 2 * VALUE_PAGE));
        *numbers[i] = was;
    }
    map.width = 2; /* without a table */
    assert_false(value_map_is_sound(&map, 2 * VALUE_PAGE));
    map.width = 4;
    assert_true(value_map_is_sound(&map, 2 * VALUE_PAGE));
    value_map_finish(&map);
}

static conus_status make_and_copy(void *data)
{
    struct value_map map = {0};
    struct value_map copy = {0};
    conus_status status = value_map_of(&map, data, MOST);
    status = status ? status : value_map_copy(&copy, &map);
    value_map_finish(&copy);
    value_map_finish(&map);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    static float values[MOST];
    uint64_t random = 41;
    make_values(values, MOST, 0.3, &random);
    test_every_allocation(make_and_copy, values);
}

/* Box, counts of steps and objects of a part against a loop over every voxel, also where the background belongs to a
 * step. */
static void steps_are_counted_where_they_are(void **state)
{
    (void)state;
    uint64_t random = 42;
    for (size_t round = 0; round < test_trials(60); round++) {
        struct volume volume = {.step_count = 1 + round % 3};
        struct volume_step steps[3] = {{0.1F, 0.3F, 7, 0}, {0.3F, 0.6F, 70000, round % 2}, {0.8F, INFINITY, 9, 0}};
        size_t *dim = volume.info.dim;
        uint64_t counts[3];
        uint64_t wanted[3] = {0};
        size_t low[3] = {SIZE_MAX, SIZE_MAX, SIZE_MAX};
        size_t high[3] = {0};
        volume.voxel_count = 1;
        for (int a = 0; a < 3; a++) {
            dim[a] = 1 + (size_t)test_random(&random, 0, 40);
            volume.voxel_count *= dim[a];
        }
        float *values = memory_zeroed(volume.voxel_count, sizeof *values);
        for (size_t v = 0; v < volume.voxel_count; v++) {
            bool full = v / 50 % 7 == round % 7;
            values[v] = full ? (float)test_random(&random, 0, 1) : round % 4 ? 0.05F : 0.2F;
        }
        volume.steps = steps;
        assert_ok(value_map_of(&volume.map, values, volume.voxel_count));
        volume_count_steps(counts, &volume);
        for (size_t v = 0; v < volume.voxel_count; v++) {
            const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
            uint32_t object = 0;
            bool any = false; /* hidden ones are in the box, too */
            for (size_t s = 0; s < volume.step_count; s++) {
                bool is_in = values[v] >= steps[s].low && values[v] < steps[s].high;
                wanted[s] += is_in;
                object = is_in && !steps[s].is_hidden ? steps[s].number : object;
                any = any || is_in;
            }
            assert_int_equal(volume_object(&volume, v), object);
            for (int a = 0; a < 3 && any; a++) {
                low[a] = at[a] < low[a] ? at[a] : low[a];
                high[a] = at[a] > high[a] ? at[a] : high[a];
            }
        }
        assert_memory_equal(counts, wanted, volume.step_count * sizeof *counts);
        assert_memory_equal(volume.box.first, low, sizeof low);
        assert_memory_equal(volume.box.last, high, sizeof high);
        const size_t first[3] = {dim[0] / 3, dim[1] / 4, dim[2] / 5};
        const size_t part[3] = {dim[0] - first[0], dim[1] - first[1], dim[2] - first[2]};
        struct volume spread;
        assert_ok(volume_spread(&spread, &volume, first, part));
        for (size_t v = 0; v < spread.voxel_count; v++) {
            size_t from = first[0] + v % part[0] +
                          dim[0] * (first[1] + v / part[0] % part[1] + dim[1] * (first[2] + v / part[0] / part[1]));
            assert_int_equal(volume_object(&spread, v), volume_object(&volume, from));
        }
        volume_finish(&spread);
        value_map_finish(&volume.map);
        memory_free(values);
    }
}

TEST_GROUP(value_map)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_map_holds_what_it_was_made_of),  cmocka_unit_test(background_takes_no_memory),
        cmocka_unit_test(voxels_above_a_bound_are_counted), cmocka_unit_test(values_are_divided_and_masks_found),
        cmocka_unit_test(unsound_maps_are_found),           cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(steps_are_counted_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
