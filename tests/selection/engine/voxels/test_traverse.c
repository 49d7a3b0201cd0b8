/* SPDX-License-Identifier: BSD-3-Clause */
/* Every kernel against the plain traversal, ray by ray, where rounding decides: rays along faces, edges and diagonals,
 * from faces and corners and from next to them, up to limits that are the contact itself. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "oracle_traversal.h"
#include "selection/engine/voxels/distance_map.h"
#include "selection/engine/voxels/traverse.h"
#include "test.h"

#include <string.h>

static size_t any_of(uint64_t *random, size_t count)
{
    return (size_t)test_random(random, 0, (double)count);
}

static double sign_of(uint64_t *random)
{
    return any_of(random, 2) ? 1 : -1;
}

/* A number of that many powers of ten, with a random sign. */
static double tiny(uint64_t *random, double low, double high)
{
    return sign_of(random) * pow(10, test_random(random, low, high));
}

enum pattern { CHECKERBOARD, WALLS, SPECKS, SINGLE, EMPTY, PATTERN_COUNT };

static bool is_occupied(enum pattern pattern, uint64_t *random, const size_t at[3])
{
    switch (pattern) {
    case CHECKERBOARD:
        return (at[0] + at[1] + at[2]) % 2;
    case WALLS: /* diagonal, one cell thick */
        return (at[0] + at[1] + at[2]) % 17 == 5;
    case SPECKS:
        return test_random(random, 0, 1) < 0.02;
    default:
        return false;
    }
}

/* Edges around the block sizes of the codes, or a long box. */
static void pick_dim(uint64_t *random, size_t dim[3])
{
    static const size_t edges[] = {1, 2, 3, 4, 5, 7, 8, 9, 31, 63, 64, 65};
    for (int a = 0; a < 3; a++) {
        dim[a] = edges[any_of(random, sizeof edges / sizeof edges[0])];
    }
    if (any_of(random, 3) == 0) {
        dim[0] = dim[1] = dim[2] = 1 + any_of(random, 4);
        dim[any_of(random, 3)] = any_of(random, 2) ? 32767 : 129 + any_of(random, 2000);
    }
}

/* Places the volume in index space, or in a sheared and scaled world. */
static void place_volume(struct volume *volume, uint64_t *random, double scale)
{
    double *m = volume->info.world_from_voxel;
    mat4_identity(m);
    bool plain = any_of(random, 2);
    for (size_t i = 0; i < 9; i++) {
        double *entry = &m[i / 3 * 4 + i % 3];
        *entry = plain ? *entry : *entry * test_random(random, 0.3, 3) + test_random(random, -0.2, 0.2);
        *entry *= scale;
    }
    assert_true(mat4_invert_affine(volume->voxel_from_world, m));
}

static void make_volume(struct volume *volume, struct distance_map *map, uint64_t *random, double scale)
{
    *volume = (struct volume){0};
    size_t *dim = volume->info.dim;
    pick_dim(random, dim);
    volume->voxel_count = dim[0] * dim[1] * dim[2];
    volume->objects16 = memory_zeroed(volume->voxel_count, sizeof *volume->objects16);
    assert_non_null(volume->objects16);
    enum pattern pattern = (enum pattern)any_of(random, PATTERN_COUNT);
    for (size_t v = 0; v < volume->voxel_count; v++) {
        const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
        volume->objects16[v] = is_occupied(pattern, random, at);
    }
    if (pattern == SINGLE) {
        volume->objects16[any_of(random, volume->voxel_count)] = 1;
    }
    place_volume(volume, random, scale);
    assert_ok(distance_map_init(map, volume));
}

static void end_volume(struct volume *volume, struct distance_map *map)
{
    distance_map_finish(map);
    volume_finish(volume);
}

/* A point in index space: anywhere, on faces, edges and corners, at centres, or next to those by 1e-13 to 1e-3. */
static void pick_point(uint64_t *random, const struct volume *volume, double out[3])
{
    size_t kind = any_of(random, 5);
    for (int a = 0; a < 3; a++) {
        double x = test_random(random, -2, (double)volume->info.dim[a] + 1);
        const double choices[] = {x, floor(x) + 0.5, floor(2 * x) / 2, floor(x) + 0.5 + tiny(random, -13, -3),
                                  any_of(random, 3) ? x : floor(x) + 0.5 + tiny(random, -6.5, -5)};
        out[a] = choices[kind];
    }
}

static void pick_origin(uint64_t *random, const struct volume *volume, double out[3])
{
    pick_point(random, volume, out);
    size_t kind = any_of(random, 3);
    for (int a = 0; a < 3 && kind; a++) {
        out[a] += kind == 1 ? floor(test_random(random, -50, 50)) : test_random(random, -300, 300);
    }
}

/* A direction in index space: along axes, diagonals of faces and of cells, almost along them, or towards points like
 * the above. */
static void pick_direction(uint64_t *random, const struct volume *volume, const double origin[3], double out[3])
{
    double to[3];
    pick_point(random, volume, to);
    size_t kind = any_of(random, 5);
    for (int a = 0; a < 3; a++) {
        const double choices[] = {to[a] - origin[a], to[a] - origin[a], sign_of(random) * (double)any_of(random, 3),
                                  tiny(random, -14, 0), tiny(random, -320, -1)};
        out[a] = choices[kind];
    }
    size_t along = any_of(random, 3);
    if (kind >= 2 || !(vec3_length(out) > 0)) {
        out[along] = sign_of(random);
    }
}

/* Origin of a ray in index space. */
static void begin_of(double out[3], const struct traverse_bundle *bundle, size_t ray, const struct volume *volume)
{
    const double apart[3] = {bundle->origins[0][ray], bundle->origins[1][ray], bundle->origins[2][ray]};
    mat4_point(out, volume->voxel_from_world, bundle->is_apart ? apart : bundle->origin);
}

/* Rays with one origin; or each with its own, close to it on either side, or anywhere. */
static void aim(struct traverse_bundle *bundle, uint64_t *random, const struct volume *volume)
{
    double first[3], origin[3];
    pick_origin(random, volume, first);
    mat4_point(bundle->origin, volume->info.world_from_voxel, first);
    bundle->count = 1 + any_of(random, TRAVERSE_BUNDLE);
    bundle->is_apart = any_of(random, 2);
    bool anywhere = any_of(random, 4) == 0;
    for (size_t i = 0; i < bundle->count; i++) {
        double world[3], direction[3];
        memcpy(origin, first, sizeof origin);
        for (int a = 0; a < 3 && bundle->is_apart; a++) {
            origin[a] += any_of(random, 3) ? test_random(random, -1.5, 1.5) : 0;
        }
        if (bundle->is_apart && anywhere) {
            pick_origin(random, volume, origin);
        }
        mat4_point(world, volume->info.world_from_voxel, origin);
        for (int a = 0; a < 3; a++) {
            bundle->origins[a][i] = world[a];
        }
        pick_direction(random, volume, origin, direction);
        mat4_direction(direction, volume->info.world_from_voxel, direction);
        assert_true(vec3_normalise(direction, direction));
        for (int a = 0; a < 3; a++) {
            bundle->direction[a][i] = direction[a];
        }
    }
}

static void ask_oracle(struct oracle_hit *wanted, const struct traverse_bundle *bundle, const struct volume *volume)
{
    double origin[3];
    for (size_t i = 0; i < bundle->count; i++) {
        double direction[3] = {bundle->direction[0][i], bundle->direction[1][i], bundle->direction[2][i]};
        begin_of(origin, bundle, i, volume);
        mat4_direction(direction, volume->voxel_from_world, direction);
        wanted[i] = oracle_ray(volume, origin, direction);
    }
}

/* No limit, or the contact, or one next to it. */
static double pick_limit(uint64_t *random, double contact)
{
    const double choices[] = {contact, nextafter(contact, -1), nextafter(contact, INFINITY), contact * (1 + 1e-9),
                              contact * (1 - 1e-9)};
    return contact < INFINITY ? fmax(0, choices[any_of(random, 5)]) : test_random(random, 0, 300);
}

/* Returns the number of rays that hit. */
static size_t walk_and_compare(struct traverse_bundle *bundle, const struct distance_map *map,
                               const struct volume *volume, const struct oracle_hit *wanted)
{
    size_t hits = 0;
    for (size_t k = 0; traverse_kernel(k); k++) {
        if (!traverse_kernel(k)->is_supported()) {
            continue;
        }
        traverse_bundle_trace(traverse_kernel(k), map, volume, bundle);
        for (size_t i = 0; i < bundle->count; i++) {
            bool hit = wanted[i].object && wanted[i].distance <= bundle->limit[i];
            double t = hit ? wanted[i].distance : INFINITY;
            uint64_t voxel = hit ? wanted[i].voxel : UINT64_MAX;
            assert_true(!hit || bundle->object[i] == wanted[i].object);
            if (bundle->t[i] != t || bundle->voxel[i] != voxel || signbit(bundle->t[i])) {
                fail_msg("%s, ray %zu to %.17g mm: voxel %lld at %.17g mm; wanted %lld at %.17g",
                         traverse_kernel(k)->name, i, bundle->limit[i], (long long)bundle->voxel[i], bundle->t[i],
                         (long long)voxel, t);
            }
            hits += hit;
        }
    }
    return hits;
}

/* Returns the number of rays that hit, with and without a limit. */
static size_t compare_bundle(uint64_t *random, const struct distance_map *map, const struct volume *volume)
{
    struct traverse_bundle bundle = {0};
    struct oracle_hit wanted[TRAVERSE_BUNDLE];
    aim(&bundle, random, volume);
    ask_oracle(wanted, &bundle, volume);
    for (size_t i = 0; i < bundle.count; i++) {
        bundle.limit[i] = INFINITY;
    }
    size_t hits = walk_and_compare(&bundle, map, volume, wanted);
    for (size_t i = 0; i < bundle.count; i++) {
        bundle.limit[i] = pick_limit(random, wanted[i].distance);
    }
    return hits + walk_and_compare(&bundle, map, volume, wanted);
}

/* Lists intervals in the order of traverse_bundle_pierce(): by ray, then along the ray. */
static void pierce_one_by_one(struct layers *out, const struct traverse_bundle *bundle, const struct distance_map *map,
                              const struct volume *volume)
{
    double origin[3];
    for (size_t i = 0; i < bundle->count; i++) {
        struct traverse_ray ray;
        begin_of(origin, bundle, i, volume);
        double direction[3] = {bundle->direction[0][i], bundle->direction[1][i], bundle->direction[2][i]};
        mat4_direction(direction, volume->voxel_from_world, direction);
        traverse_ray_init(&ray, origin, direction);
        assert_ok(traverse_pierce(out, map, volume, &ray, INFINITY, (uint32_t)i));
    }
    assert_ok(layers_sort(out, bundle->count));
}

/* The first interval of the ray that reaches beyond `from`; NULL if there is none. Sets the ray's first of all. */
static const conus_interval *first_from(const conus_interval **first, const struct layers *all, size_t ray, double from)
{
    *first = NULL;
    for (size_t i = 0; i < all->count; i++) {
        const conus_interval *interval = &all->intervals[i];
        if (interval->pixel == ray) {
            *first = *first ? *first : interval;
            if (interval->exit > from) {
                return interval;
            }
        }
    }
    return NULL;
}

/* Kernels that begin at `from` give the object there or the next one, or else the first hit of all. Returns the number
 * of rays with a hit before `from` for which they gave the former. */
static size_t compare_later(uint64_t *random, const struct distance_map *map, const struct volume *volume)
{
    alignas(64) double from[TRAVERSE_BUNDLE];
    struct traverse_bundle bundle = {.from = from};
    struct layers wanted = {0};
    size_t told = 0;
    aim(&bundle, random, volume);
    pierce_one_by_one(&wanted, &bundle, map, volume);
    for (size_t i = 0; i < TRAVERSE_BUNDLE; i++) {
        const conus_interval *some = wanted.count ? &wanted.intervals[any_of(random, wanted.count)] : NULL;
        from[i] = some && some->exit > 0 ? test_random(random, 0.01, 1.2) * some->exit : 1;
        bundle.limit[i] = INFINITY;
    }
    for (size_t k = 0; traverse_kernel(k); k++) {
        if (!traverse_kernel(k)->is_supported()) {
            continue;
        }
        traverse_bundle_trace(traverse_kernel(k), map, volume, &bundle);
        for (size_t i = 0; i < bundle.count; i++) {
            const conus_interval *first;
            const conus_interval *want = first_from(&first, &wanted, i, from[i]);
            bool is_there = want && want->entry < from[i];
            double t = !want ? INFINITY : is_there ? TRAVERSE_THERE : want->entry;
            bool as_wanted = bundle.t[i] == t && (!want || bundle.object[i] == want->object) &&
                             (!want || is_there || bundle.voxel[i] == want->voxel);
            bool as_first = first && first->entry < from[i] && bundle.t[i] == first->entry;
            assert_true(as_wanted || as_first);
            told += as_wanted && first && first->entry < from[i];
        }
    }
    layers_finish(&wanted);
    return told;
}

/* Gives numbers to areas some voxels wide that touch, with holes, some with numbers too high for a colour; or to a
 * jumble with more neighbours than colours; or leaves the objects as they are. */
static void name_areas(struct volume *volume, uint64_t *random)
{
    size_t width = 1 + any_of(random, 9);
    size_t factor = any_of(random, 3) ? 1 : OBJECTS_COLOURED / 3 + 1;
    for (size_t v = 0; v < volume->voxel_count && width == 7; v++) {
        volume->objects16[v] = (uint16_t)any_of(random, 40);
    }
    for (size_t v = 0; v < volume->voxel_count && width < 7; v++) {
        const size_t *dim = volume->info.dim;
        size_t sum = v % dim[0] / width + 3 * (v / dim[0] % dim[1] / width) + 5 * (v / dim[0] / dim[1] / (width + 1));
        volume->objects16[v] = (uint16_t)(sum % 7 < 4 ? sum % 7 * factor : volume->objects16[v]);
    }
}

static void assert_same_intervals(const struct layers *got, const struct layers *wanted, const char *kernel)
{
    assert_int_equal(got->count, wanted->count);
    for (size_t i = 0; i < got->count; i++) {
        const conus_interval *a = &got->intervals[i];
        const conus_interval *b = &wanted->intervals[i];
        if (a->pixel != b->pixel || a->object != b->object || a->voxel != b->voxel || a->entry != b->entry ||
            a->exit != b->exit || signbit(a->entry)) {
            fail_msg(
                "%s, interval %zu of ray %u: object %u, %.17g to %.17g mm; wanted of ray %u object %u, %.17g to %.17g",
                kernel, i, a->pixel, a->object, a->entry, a->exit, b->pixel, b->object, b->entry, b->exit);
        }
    }
}

/* A bundle of one ray up to a limit: an interval that begins before it is whole, or goes on beyond it. `wanted` is
 * without a limit. */
static void compare_limited(uint64_t *random, const struct traverse_bundle *all, const struct layers *wanted,
                            const struct distance_map *map, const struct volume *volume)
{
    struct traverse_bundle lone = {.count = 1};
    struct layers got = {0};
    size_t pixel = any_of(random, all->count);
    struct traverse_piercing piercing = {.volume = volume, .pixel = &pixel, .out = &got};
    size_t first = 0;
    while (first < wanted->count && wanted->intervals[first].pixel < pixel) {
        first++;
    }
    memcpy(lone.origin, all->origin, sizeof lone.origin);
    lone.is_apart = all->is_apart;
    for (int a = 0; a < 3; a++) {
        lone.origins[a][0] = all->origins[a][pixel];
        lone.direction[a][0] = all->direction[a][pixel];
    }
    lone.limit[0] = pick_limit(random, first < wanted->count ? wanted->intervals[first].exit : 1);
    assert_ok(traverse_bundle_pierce(traverse_best_kernel(), map, &piercing, &lone));
    assert_ok(layers_sort(&got, 1 + pixel));
    size_t i = 0;
    for (; first + i < wanted->count && wanted->intervals[first + i].pixel == pixel; i++) {
        const conus_interval *want = &wanted->intervals[first + i];
        if (want->entry > lone.limit[0]) {
            break;
        }
        assert_true(i < got.count);
        assert_int_equal(got.intervals[i].object, want->object);
        assert_true(got.intervals[i].entry == want->entry && got.intervals[i].voxel == want->voxel);
        assert_true(got.intervals[i].exit == want->exit ||
                    (got.intervals[i].exit > lone.limit[0] && got.intervals[i].exit < want->exit));
    }
    assert_int_equal(got.count, i);
    layers_finish(&got);
}

/* Returns the number of intervals. */
static size_t compare_intervals(uint64_t *random, const struct distance_map *map, const struct distance_map *uniform,
                                const struct volume *volume)
{
    struct traverse_bundle bundle = {0};
    struct layers wanted = {0};
    size_t pixel[TRAVERSE_BUNDLE];
    aim(&bundle, random, volume);
    for (size_t i = 0; i < TRAVERSE_BUNDLE; i++) {
        pixel[i] = i;
        bundle.limit[i] = INFINITY;
    }
    pierce_one_by_one(&wanted, &bundle, map, volume);
    compare_limited(random, &bundle, &wanted, map, volume);
    for (size_t k = 0; traverse_kernel(k); k++) {
        struct layers got = {0};
        struct traverse_piercing piercing = {.uniform = uniform, .volume = volume, .pixel = pixel, .out = &got};
        if (traverse_kernel(k)->is_supported()) {
            assert_ok(traverse_bundle_pierce(traverse_kernel(k), map, &piercing, &bundle));
            assert_ok(layers_sort(&got, bundle.count));
            assert_same_intervals(&got, &wanted, traverse_kernel(k)->name);
        }
        layers_finish(&got);
    }
    size_t count = wanted.count;
    layers_finish(&wanted);
    return count;
}

/* Numbers from an arbitrary one on, as many as a labelled map has codes for, or more. Returns whether it has codes for
 * all. */
static bool name_objects(struct volume *volume, uint64_t *random)
{
    static const size_t widths[] = {1, 2, 100, LABELLED_OBJECTS, LABELLED_OBJECTS + 1, 3000};
    size_t width = widths[any_of(random, sizeof widths / sizeof widths[0])];
    size_t first = 1 + any_of(random, 1000);
    size_t least = SIZE_MAX;
    size_t most = 0;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        if (volume->objects16[v]) {
            size_t object = first + (any_of(random, 4) ? any_of(random, width) : any_of(random, 2) * (width - 1));
            volume->objects16[v] = (uint16_t)object;
            least = object < least ? object : least;
            most = object > most ? object : most;
        }
    }
    return least <= most && most - least < LABELLED_OBJECTS;
}

static size_t compare_scenes(uint64_t random, int scenes, double scale)
{
    size_t hits = 0;
    size_t labelled_scenes = 0;
    for (int scene = 0; scene < scenes; scene++) {
        struct volume volume;
        struct distance_map map;
        struct distance_map labelled = {0};
        make_volume(&volume, &map, &random, scale);
        bool has_labelled = name_objects(&volume, &random);
        assert_int_equal(labelled_map_init(&labelled, &volume, &map), has_labelled);
        labelled_scenes += has_labelled;
        for (int bundle = 0; bundle < 5; bundle++) {
            hits += compare_bundle(&random, has_labelled && bundle < 3 ? &labelled : &map, &volume);
        }
        distance_map_finish(&labelled);
        end_volume(&volume, &map);
    }
    assert_true(labelled_scenes > 5 && labelled_scenes + 5 < (size_t)scenes);
    return hits;
}

static size_t count_kernels(void)
{
    size_t count = 0;
    for (size_t k = 0; traverse_kernel(k); k++) {
        count += traverse_kernel(k)->is_supported();
    }
    return count;
}

/* Eq. 5, with limits as another volume's hit sets them: a contact exactly at the limit counts. */
static void kernels_equal_the_plain_traversal(void **state)
{
    (void)state;
    assert_true(compare_scenes(11, (int)test_trials(150), 1) > test_trials(15000) * count_kernels());
}

/* Eq. 10: the object in which the ray is at the near end of a range, or the first one behind it. */
static void kernels_begin_later(void **state)
{
    (void)state;
    uint64_t random = 15;
    size_t told = 0;
    for (size_t scene = 0; scene < test_trials(150); scene++) {
        struct volume volume;
        struct distance_map map;
        make_volume(&volume, &map, &random, 1);
        for (int bundle = 0; bundle < 3; bundle++) {
            told += compare_later(&random, &map, &volume);
        }
        end_volume(&volume, &map);
    }
    assert_true(told > test_trials(1000) * count_kernels());
}

/* Voxels so small or so large that their size or its inverse is no float. */
static void voxels_of_any_size_do(void **state)
{
    (void)state;
    assert_true(compare_scenes(12, 20, 1e-42) > 3000);
    assert_true(compare_scenes(13, 20, 1e42) > 3000);
}

/* Eq. 10: to the bit, with skips inside objects or without. */
static void kernels_list_the_intervals_of_single_rays(void **state)
{
    (void)state;
    uint64_t random = 14;
    size_t intervals = 0;
    for (size_t scene = 0; scene < test_trials(150); scene++) {
        struct volume volume;
        struct distance_map map;
        struct distance_map uniform;
        make_volume(&volume, &map, &random, 1);
        distance_map_finish(&map);
        name_areas(&volume, &random);
        assert_ok(distance_map_init(&map, &volume));
        assert_ok(distance_map_init_uniform(&uniform, &volume, &map));
        for (int bundle = 0; bundle < 3; bundle++) {
            intervals += compare_intervals(&random, &map, &uniform, &volume);
        }
        distance_map_finish(&uniform);
        end_volume(&volume, &map);
    }
    assert_true(intervals > test_trials(100000));
}

/* From the face between cells 1 and 2, which belongs to cell 2, downwards: cell 1 is hit at once. */
static void what_is_hit_at_once_is_at_zero(void **state)
{
    (void)state;
    uint16_t objects[] = {0, 1, 0};
    struct volume volume = {.info = {.dim = {3, 1, 1}}, .voxel_count = 3, .objects16 = objects};
    struct distance_map map;
    mat4_identity(volume.voxel_from_world);
    assert_ok(distance_map_init(&map, &volume));
    for (size_t k = 0; traverse_kernel(k); k++) {
        struct traverse_bundle bundle = {.count = 1, .direction = {{-1}}, .limit = {INFINITY}, .origin = {1.5}};
        if (traverse_kernel(k)->is_supported()) {
            traverse_bundle_trace(traverse_kernel(k), &map, &volume, &bundle);
            assert_true(bundle.t[0] == 0 && !signbit(bundle.t[0]));
            assert_int_equal(bundle.voxel[0], 1);
        }
    }
    distance_map_finish(&map);
}

/* 1024 x 1024 lines of 64 codes are the most; the limit depends on neither codes nor voxels. */
static void large_volumes_have_no_labelled_map(void **state)
{
    (void)state;
    struct volume volume = {.info = {.dim = {4094, 4094, 7}}};
    struct distance_map map = {.dim = {4094, 4094, 7}, .lines = {1024, 1024, 2}, .last = {1, 1, 1}};
    struct distance_map out = {.least = 7};
    assert_false(labelled_map_init(&out, &volume, &map));
    assert_int_equal(out.least, 7);
    assert_int_equal(LABELLED_CODES, 1024 * 1024 * DISTANCE_LINE);
}

TEST_GROUP(traverse)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_equal_the_plain_traversal),         cmocka_unit_test(voxels_of_any_size_do),
        cmocka_unit_test(kernels_list_the_intervals_of_single_rays), cmocka_unit_test(what_is_hit_at_once_is_at_zero),
        cmocka_unit_test(large_volumes_have_no_labelled_map),        cmocka_unit_test(kernels_begin_later),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
