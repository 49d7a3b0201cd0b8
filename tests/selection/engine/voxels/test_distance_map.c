/* SPDX-License-Identifier: BSD-3-Clause */
/* The distance map against a search of all voxels. */
#include "base/memory.h"
#include "selection/engine/voxels/distance_map.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

static size_t random_size(uint64_t *random, size_t limit)
{
    return 1 + (size_t)test_random(random, 0, (double)limit);
}

/* A grid of up to 40 voxels along each edge with a random few of them occupied, as 16-bit or 32-bit objects. */
static void make_volume(struct volume *out, uint64_t *random)
{
    *out = (struct volume){0};
    for (int a = 0; a < 3; a++) {
        out->info.dim[a] = random_size(random, 40);
    }
    out->voxel_count = out->info.dim[0] * out->info.dim[1] * out->info.dim[2];
    if (test_random(random, 0, 1) < 0.5) {
        out->objects16 = memory_zeroed(out->voxel_count, sizeof *out->objects16);
    } else {
        out->objects32 = memory_zeroed(out->voxel_count, sizeof *out->objects32);
    }
    size_t specks = test_random(random, 0, 1) < 0.1 ? 0 : random_size(random, 30);
    for (size_t i = 0; i < specks; i++) {
        size_t voxel = random_size(random, out->voxel_count) - 1;
        if (out->objects16) {
            out->objects16[voxel] = 0x100; /* the low byte is 0 */
        } else {
            out->objects32[voxel] = 0x10000;
        }
    }
}

/* Largest r for which the cube of half-edge r around the voxel is empty; 1000 if the volume is empty. */
static long empty_radius(const struct volume *volume, const long at[3])
{
    const long row = (long)volume->info.dim[0];
    const long layer = row * (long)volume->info.dim[1];
    long nearest = 1001;
    for (long v = 0; v < (long)volume->voxel_count; v++) {
        if (volume_object(volume, (size_t)v)) {
            long x = labs(v % row - at[0]);
            long y = labs(v % layer / row - at[1]);
            long z = labs(v / layer - at[2]);
            long far = x > y ? x : y;
            far = z > far ? z : far;
            nearest = far < nearest ? far : nearest;
        }
    }
    return nearest - 1;
}

/* A code is never larger than the true distance, is 0 only on objects, and is exact near objects. */
static void codes_tell_how_far_it_is_empty(void **state)
{
    (void)state;
    uint64_t random = 5;
    for (int round = 0; round < 60; round++) {
        struct volume volume;
        struct distance_map map;
        make_volume(&volume, &random);
        assert_ok(distance_map_init(&map, &volume));
        for (int probe = 0; probe < 200; probe++) {
            long at[3];
            for (int a = 0; a < 3; a++) {
                at[a] = (long)random_size(&random, volume.info.dim[a]) - 1;
            }
            long radius = empty_radius(&volume, at);
            long code = map.codes[distance_map_at(&map, (size_t)at[0], (size_t)at[1], (size_t)at[2])];
            assert_true(code <= radius + 1);
            assert_int_equal(code == 0, radius < 0);
            assert_true(radius + 1 >= 8 || code == radius + 1);
            assert_true(radius < 16 || code >= 9); /* two bricks away at least */
        }
        distance_map_finish(&map);
        volume_finish(&volume);
    }
}

static void the_box_just_holds_the_objects(void **state)
{
    (void)state;
    uint64_t random = 6;
    for (int round = 0; round < 100; round++) {
        struct volume volume;
        struct distance_map map;
        make_volume(&volume, &random);
        assert_ok(distance_map_init(&map, &volume));
        double low[3] = {1e9, 1e9, 1e9};
        double high[3] = {-1, -1, -1};
        for (size_t v = 0; v < volume.voxel_count; v++) {
            const size_t *dim = volume.info.dim;
            const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
            for (int a = 0; a < 3 && volume_object(&volume, v); a++) {
                low[a] = (double)at[a] < low[a] ? (double)at[a] : low[a];
                high[a] = (double)at[a] > high[a] ? (double)at[a] : high[a];
            }
        }
        for (int a = 0; a < 3; a++) {
            assert_near(map.last[a], high[a], 0);
            assert_true(high[a] < 0 ? map.first[a] > map.last[a] : map.first[a] == low[a]);
        }
        distance_map_finish(&map);
        volume_finish(&volume);
    }
}

/* Largest r up to 20 for which the cube of half-edge r holds only the same object; outside of the grid there is
 * none. */
static long uniform_radius(const struct volume *volume, const long at[3])
{
    const long dim[3] = {(long)volume->info.dim[0], (long)volume->info.dim[1], (long)volume->info.dim[2]};
    uint32_t object = volume_object(volume, (size_t)(at[0] + dim[0] * (at[1] + dim[1] * at[2])));
    for (long r = 1; r <= 20; r++) {
        long edge = 2 * r + 1;
        for (long n = 0; n < edge * edge * edge; n++) {
            const long p[3] = {at[0] - r + n % edge, at[1] - r + n / edge % edge, at[2] - r + n / edge / edge};
            bool inside = p[0] >= 0 && p[1] >= 0 && p[2] >= 0 && p[0] < dim[0] && p[1] < dim[1] && p[2] < dim[2];
            if ((inside ? volume_object(volume, (size_t)(p[0] + dim[0] * (p[1] + dim[1] * p[2]))) : 0) != object) {
                return r - 1;
            }
        }
    }
    return 20;
}

/* Areas instead of specks: adjacent blocks some voxels wide, and holes. */
static void make_areas(struct volume *volume, uint64_t *random)
{
    const size_t *dim = volume->info.dim;
    size_t width = random_size(random, 12);
    for (size_t v = 0; v < volume->voxel_count; v++) {
        size_t sum = v % dim[0] / width + v / dim[0] % dim[1] / (width + 1) * 3 + v / dim[0] / dim[1] / width * 5;
        volume_set_object(volume, v, (uint32_t)(sum % 5 * 0x100));
    }
}

/* Inside objects, too, a code is never larger than the true radius plus one, and near borders it is exact. */
static void uniform_codes_tell_how_far_it_is_the_same(void **state)
{
    (void)state;
    uint64_t random = 8;
    for (int round = 0; round < 40; round++) {
        struct volume volume;
        struct distance_map map;
        struct distance_map uniform;
        struct object_colours colours;
        make_volume(&volume, &random);
        make_areas(&volume, &random);
        assert_ok(distance_map_init(&map, &volume));
        assert_ok(distance_map_init_uniform(&uniform, &volume, &map));
        assert_ok(object_colours_find(&colours, &volume));
        assert_memory_equal(uniform.first, map.first, sizeof map.first);
        assert_memory_equal(uniform.last, map.last, sizeof map.last);
        for (int probe = 0; probe < 100; probe++) {
            long at[3];
            for (int a = 0; a < 3; a++) {
                at[a] = (long)random_size(&random, volume.info.dim[a]) - 1;
            }
            uint8_t code = uniform.codes[distance_map_at(&uniform, (size_t)at[0], (size_t)at[1], (size_t)at[2])];
            size_t voxel = (size_t)at[0] + volume.info.dim[0] * ((size_t)at[1] + volume.info.dim[1] * (size_t)at[2]);
            uint32_t object = volume_object(&volume, voxel);
            long radius = uniform_radius(&volume, at);
            assert_int_equal((code & UNIFORM_EMPTY) != 0, !object);
            assert_true(!object || (code & UNIFORM_COLOUR) / 0x10 == object_colour(&colours, object));
            assert_in_range(code & UNIFORM_RADIUS, 1, object ? radius + 1 : UNIFORM_EMPTY_RADIUS);
            assert_true(radius >= 8 || !object || (code & UNIFORM_RADIUS) == radius + 1);
        }
        distance_map_finish(&uniform);
        distance_map_finish(&map);
        volume_finish(&volume);
    }
}

/* Checks a voxel and the next one along an axis, whose index is larger by `step`. */
static void check_pair(const struct volume *volume, const struct object_colours *colours, size_t voxel, size_t step)
{
    uint32_t a = volume_object(volume, voxel);
    uint32_t b = volume_object(volume, voxel + step);
    if (a && b && a != b && object_colour(colours, a) != OBJECT_NO_COLOUR) {
        assert_int_not_equal(object_colour(colours, a), object_colour(colours, b));
    }
}

/* Returns the number of objects without a colour. */
static size_t check_colours(const struct volume *volume, uint32_t objects)
{
    const size_t *dim = volume->info.dim;
    struct object_colours colours;
    size_t without = 0;
    assert_ok(object_colours_find(&colours, volume));
    for (size_t v = 0; v < volume->voxel_count; v++) {
        size_t step = 1;
        for (int a = 0; a < 3; step *= dim[a++]) {
            if (v / step % dim[a] + 1 < dim[a]) {
                check_pair(volume, &colours, v, step);
            }
        }
    }
    for (uint32_t object = 1; object <= objects; object++) {
        without += object_colour(&colours, object) == OBJECT_NO_COLOUR;
    }
    return without;
}

/* In a jumble of 24^3 voxels every object touches every other, so that each needs another colour: of 40 objects only as
 * many have one as there are colours. */
static void neighbours_differ_in_colour(void **state)
{
    (void)state;
    uint64_t random = 9;
    for (uint32_t objects = 1; objects <= 40; objects++) {
        struct volume volume = {.info.dim = {24, 24, 24}, .voxel_count = (size_t)24 * 24 * 24};
        volume.objects16 = memory_zeroed(volume.voxel_count, sizeof *volume.objects16);
        assert_non_null(volume.objects16);
        for (size_t v = 0; v < volume.voxel_count; v++) {
            volume.objects16[v] = (uint16_t)(random_size(&random, objects + 1) - 1);
        }
        size_t with = objects < OBJECT_NO_COLOUR ? objects : OBJECT_NO_COLOUR;
        assert_int_equal(check_colours(&volume, objects), objects - with);
        volume_finish(&volume);
    }
    for (int round = 0; round < 20; round++) {
        struct volume volume;
        make_volume(&volume, &random);
        make_areas(&volume, &random);
        assert_int_equal(check_colours(&volume, OBJECTS_COLOURED), 1); /* the number that has none */
        volume_finish(&volume);
    }
}

/* A sparse volume has codes only in the box of its objects: the same codes as the same objects stored one by one in all
 * voxels. */
static void a_sparse_volume_has_the_same_codes(void **state)
{
    (void)state;
    uint64_t random = 47;
    for (size_t round = 0; round < test_trials(40); round++) {
        struct volume_step step = {.low = 0.5F, .high = INFINITY, .number = 3};
        struct volume sparse = {.steps = &step, .step_count = 1, .voxel_count = 1};
        struct volume dense;
        struct distance_map maps[2];
        struct distance_map uniform[2];
        size_t middle[3];
        uint64_t count;
        for (int a = 0; a < 3; a++) {
            sparse.info.dim[a] = 1 + random_size(&random, 60);
            sparse.voxel_count *= sparse.info.dim[a];
            middle[a] = random_size(&random, sparse.info.dim[a]);
        }
        const size_t *dim = sparse.info.dim;
        float *values = memory_zeroed(sparse.voxel_count, sizeof *values);
        for (size_t v = 0; v < sparse.voxel_count; v++) {
            const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
            bool near = true;
            for (int a = 0; a < 3; a++) {
                near = near && at[a] + 1 + round % 20 > middle[a] && at[a] < middle[a] + 1 + round % 20;
            }
            values[v] = near && test_random(&random, 0, 1) < 0.7 ? 1 : 0.1F; /* perhaps none at all */
        }
        assert_ok(value_map_of(&sparse.map, values, sparse.voxel_count));
        volume_count_steps(&count, &sparse);
        assert_ok(volume_spread(&dense, &sparse, (const size_t[3]){0}, dim));
        assert_ok(distance_map_init(&maps[0], &sparse));
        assert_ok(distance_map_init(&maps[1], &dense));
        assert_ok(distance_map_init_uniform(&uniform[0], &sparse, &maps[0]));
        assert_ok(distance_map_init_uniform(&uniform[1], &dense, &maps[1]));
        assert_true(distance_map_codes(&maps[0]) <= distance_map_codes(&maps[1]));
        for (int a = 0; a < 3 && count; a++) {
            assert_true(maps[0].first[a] == maps[1].first[a] && maps[0].last[a] == maps[1].last[a]);
            assert_true(uniform[0].first[a] == maps[1].first[a] && uniform[0].last[a] == maps[1].last[a]);
        }
        assert_true(count || maps[0].first[0] > maps[0].last[0]);
        size_t part[3]; /* the box and a voxel around it */
        for (int a = 0; a < 3; a++) {
            part[a] = count ? (size_t)(maps[0].last[a] - maps[0].first[a]) + 3 : 0;
        }
        for (size_t n = 0; n < part[0] * part[1] * part[2]; n++) {
            size_t at[3] = {n % part[0], n / part[0] % part[1], n / part[0] / part[1]};
            for (int a = 0; a < 3; a++) {
                at[a] += (size_t)maps[0].first[a] - 1; /* wraps in front of the first */
            }
            size_t here = distance_map_at(&maps[0], at[0], at[1], at[2]);
            size_t there = distance_map_at(&maps[1], at[0], at[1], at[2]);
            assert_int_equal(maps[0].codes[here], maps[1].codes[there]);
            bool is_same = uniform[0].codes[here] == uniform[1].codes[there];
            bool is_inside = at[0] < dim[0] && at[1] < dim[1] && at[2] < dim[2];
            assert_true(is_same || !is_inside);
        }
        for (int n = 0; n < 2; n++) {
            distance_map_finish(&maps[n]);
            distance_map_finish(&uniform[n]);
        }
        volume_finish(&dense);
        value_map_finish(&sparse.map);
        memory_free(values);
    }
}

static conus_status make_uniform_and_finish(void *data)
{
    struct distance_map map = {0};
    struct distance_map uniform = {0};
    conus_status status = distance_map_init(&map, data);
    status = status ? status : distance_map_init_uniform(&uniform, data, &map);
    distance_map_finish(&uniform);
    distance_map_finish(&map);
    return status;
}

static conus_status make_and_finish(void *data)
{
    struct distance_map map = {0};
    conus_status status = distance_map_init(&map, data);
    distance_map_finish(&map);
    return status;
}

static void making_one_survives_every_failing_allocation(void **state)
{
    (void)state;
    uint64_t random = 7;
    struct volume volume;
    make_volume(&volume, &random);
    test_every_allocation(make_and_finish, &volume);
    test_every_allocation(make_uniform_and_finish, &volume);
    volume_finish(&volume);
}

TEST_GROUP(distance_map)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sparse_volume_has_the_same_codes),
        cmocka_unit_test(codes_tell_how_far_it_is_empty),
        cmocka_unit_test(the_box_just_holds_the_objects),
        cmocka_unit_test(uniform_codes_tell_how_far_it_is_the_same),
        cmocka_unit_test(neighbours_differ_in_colour),
        cmocka_unit_test(making_one_survives_every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
