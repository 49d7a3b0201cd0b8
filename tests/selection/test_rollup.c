/* SPDX-License-Identifier: BSD-3-Clause */
/* Rolled up areas (Eq. 10) are exactly as if their voxels had been relabelled beforehand. */
#include "base/geometry/math3.h"
#include "mesh_scene.h"
#include "report_scene.h"
#include "same_answer.h"
#include "scene.h"
#include "selection/selection.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

enum { SCENES = 60, DIM = 12 };

/* Tolerance for sums over voxels that are added in another order. */
#define SUMS 1e-9

/* Gives areas random parents, and some no voxels of their own to be hit. */
static void grow_tree(conus_atlas *atlas, uint64_t *state)
{
    for (size_t i = 1; i < atlas->area_count; i++) {
        bool root = test_random(state, 0, 1) < 0.1;
        atlas->objects[i].parent = root ? 0 : 1 + (uint32_t)test_random(state, 0, (double)i);
    }
}

/* Relabels every voxel with the area as which it is reported. */
static void relabel(conus_atlas *atlas, const uint32_t *group)
{
    struct volume *volume = &atlas->volumes[0];
    for (size_t i = 0; i < volume->voxel_count; i++) {
        if (volume->objects16) {
            volume->objects16[i] = (uint16_t)group[volume->objects16[i]];
        } else {
            volume->objects32[i] = group[volume->objects32[i]];
        }
    }
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        conus_object *from = &atlas->objects[number - 1];
        conus_object *to = &atlas->objects[group[number] - 1];
        if (from != to) {
            to->volume_mm3 += from->volume_mm3;
            to->voxels += from->voxels;
            from->volume_mm3 = 0;
            from->voxels = 0;
        }
    }
}

/* Two atlases with the same voxels and tree, and a depth of the tree that changes something; false if there is none. */
static bool make_pair(conus_atlas *out[2], char spec[16], uint64_t seed)
{
    struct level *level = NULL;
    for (int k = 0; k < 2; k++) {
        uint64_t state = seed;
        out[k] = scene_atlas(&state, DIM, 1);
        grow_tree(out[k], &state);
    }
    snprintf(spec, 16, "%d", 1 + (int)(seed % 3));
    if (level_create(&level, out[1], spec)) {
        return false; /* no tree, or not as deep */
    }
    bool changes = !level_is_identity(level);
    relabel(out[1], level_group(level));
    level_destroy(level);
    return changes;
}

static conus_selection *select_from(const conus_atlas *atlas, const conus_selector_options *options,
                                    const conus_pose *pose)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_select(&selection, selector, pose, degrees_from_radians(options->radius > 0 ? 0 : 0.7)));
    conus_selector_destroy(selector);
    return selection;
}

static void compare(const conus_selector_options *base)
{
    size_t compared = 0;
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
        conus_atlas *atlases[2];
        char spec[16];
        bool useful = make_pair(atlases, spec, seed);
        uint64_t state = seed;
        for (int pose = 0; useful && pose < 3; pose++) {
            const conus_pose from = scene_generic_pose(&state, atlases[0]);
            conus_selector_options options = *base;
            options.level = spec;
            conus_selection *rolled = select_from(atlases[0], &options, &from);
            conus_selection *relabelled = select_from(atlases[1], base, &from);
            assert_same_answer(rolled, relabelled, SUMS);
            compared += conus_selection_count(rolled) > 1;
            conus_selection_destroy(rolled);
            conus_selection_destroy(relabelled);
        }
        conus_atlas_destroy(atlases[0]);
        conus_atlas_destroy(atlases[1]);
    }
    assert_true(compared > SCENES / 2);
}

static void first_hits_are_as_if_relabelled(void **state)
{
    (void)state;
    compare(&(conus_selector_options){0});
    compare(&(conus_selector_options){.sampling = CONUS_SAMPLING_SLICES, .score = "centre"});
}

static void all_layers_are_as_if_relabelled(void **state)
{
    (void)state;
    compare(&(conus_selector_options){.layers = CONUS_LAYERS_ALL});
    compare(&(conus_selector_options){.layers = CONUS_LAYERS_ALL, .range = {5, 30}, .score = "distance"});
    compare(&(conus_selector_options){.layers = CONUS_LAYERS_ALL, .radius = 5});
}

/* The share of a parent is the sum of the shares of its disjoint parts. */
static void shares_add_up(void **state)
{
    (void)state;
    size_t checked = 0;
    for (uint64_t seed = 100; seed < 120; seed++) {
        conus_atlas *atlases[2];
        char spec[16];
        double sums[512] = {0};
        if (make_pair(atlases, spec, seed) && atlases[0]->object_count < 512) {
            struct level *level = NULL;
            uint64_t random = seed;
            const conus_pose pose = scene_generic_pose(&random, atlases[0]);
            conus_selection *parts = select_from(atlases[0], &(conus_selector_options){0}, &pose);
            conus_selection *whole = select_from(atlases[0], &(conus_selector_options){.level = spec}, &pose);
            assert_ok(level_create(&level, atlases[0], spec));
            for (size_t i = 0; i < conus_selection_count(parts); i++) {
                const conus_result *part = conus_selection_result(parts, i);
                sums[level_group(level)[part->object]] += part->share;
            }
            for (size_t i = 0; i < conus_selection_count(whole); i++) {
                const conus_result *result = conus_selection_result(whole, i);
                assert_near(result->share, sums[result->object], 1e-12);
                checked++;
            }
            level_destroy(level);
            conus_selection_destroy(parts);
            conus_selection_destroy(whole);
        }
        conus_atlas_destroy(atlases[0]);
        conus_atlas_destroy(atlases[1]);
    }
    assert_true(checked > 20);
}

/* The result of the object with the name of `object`; `unassigned` has no name. */
static const conus_result *find_result(const conus_selection *selection, const conus_atlas *atlas,
                                       const conus_object *object)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        const conus_object *other = conus_atlas_object(atlas, result->object);
        if (object && other ? strcmp(object->name, other->name) == 0 : !object && !other) {
            return result;
        }
    }
    fail_msg("no result %s", object ? object->name : "unassigned");
    return NULL;
}

/* Splitting and merging again gives the same answers; only numbers and therefore the order of ties differ. */
static void merging_undoes_splitting(void **state)
{
    (void)state;
    size_t compared = 0;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
        uint64_t one = seed;
        uint64_t two = seed;
        conus_atlas *plain = scene_atlas(&one, DIM, 1);
        conus_atlas *undone = scene_atlas(&two, DIM, 1);
        if (!conus_atlas_set_hemispheres(undone, CONUS_HEMISPHERES_SPLIT) &&
            !conus_atlas_set_hemispheres(undone, CONUS_HEMISPHERES_MERGED)) {
            const conus_pose pose = scene_generic_pose(&one, plain);
            conus_selection *wanted = select_from(plain, &options, &pose);
            conus_selection *got = select_from(undone, &options, &pose);
            assert_int_equal(conus_selection_count(got), conus_selection_count(wanted));
            for (size_t i = 0; i < conus_selection_count(got); i++) {
                conus_result result = *conus_selection_result(got, i);
                const conus_object *area = conus_atlas_object(undone, result.object);
                const conus_result *same = find_result(wanted, plain, area);
                result.object = same->object;
                result.rank = same->rank;
                assert_same_result(&result, same, SUMS);
                compared++;
            }
            conus_selection_destroy(wanted);
            conus_selection_destroy(got);
        }
        conus_atlas_destroy(plain);
        conus_atlas_destroy(undone);
    }
    assert_true(compared > SCENES);
}

static void intervals_of_a_group_become_one(void **state)
{
    (void)state;
    const uint32_t group[] = {0, 4, 2, 4, 4, 2};
    const conus_interval given[] = {{0, 1, 1, 2, 10}, {0, 3, 2, 3, 11},  {0, 2, 2.5, 9, 12}, {0, 4, 4, 5, 13},
                                    {0, 1, 5, 6, 14}, {0, 5, 8, 10, 15}, {3, 3, 0, 1, 16},   {3, 1, 2, 3, 17}};
    const conus_interval wanted[] = {
        {0, 4, 1, 3, 10}, {0, 2, 2.5, 10, 12}, {0, 4, 4, 6, 13}, {3, 4, 0, 1, 16}, {3, 4, 2, 3, 17}};
    struct layers layers = {0};
    for (size_t i = 0; i < sizeof given / sizeof given[0]; i++) {
        assert_ok(layers_add(&layers, &given[i]));
    }
    assert_ok(layers_regroup(&layers, group, 5));
    assert_int_equal(layers.count, sizeof wanted / sizeof wanted[0]);
    for (size_t i = 0; i < layers.count; i++) {
        assert_int_equal(layers.intervals[i].pixel, wanted[i].pixel);
        assert_int_equal(layers.intervals[i].object, wanted[i].object);
        assert_int_equal(layers.intervals[i].voxel, wanted[i].voxel);
        assert_near(layers.intervals[i].entry, wanted[i].entry, 0);
        assert_near(layers.intervals[i].exit, wanted[i].exit, 0);
    }
    layers_finish(&layers);
}

/* Areas that are spheres: 2 and 3, which do not touch, lie in 1; 4 lies beside. */
static conus_atlas *sphere_atlas(void)
{
    static const struct {
        double centre[3], radius;
    } spheres[] = {{{0, 0, 0}, 20}, {{-8, 0, 0}, 5}, {{8, 0, 0}, 6}, {{0, 40, 0}, 10}};
    conus_atlas *atlas = mesh_scene_atlas();
    for (size_t i = 0; i < 4; i++) {
        struct mesh mesh = mesh_scene_sphere(spheres[i].centre, spheres[i].radius, 40, 80);
        mesh_scene_add(atlas, &mesh);
    }
    return atlas;
}

static const conus_result *result_of(const conus_selection *selection, uint32_t object)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        if (conus_selection_result(selection, i)->object == object) {
            return conus_selection_result(selection, i);
        }
    }
    fail_msg("no result for object %u", object);
    return NULL;
}

/* The spheres one by one, and rolled up to the topmost areas. */
struct spheres {
    conus_atlas *atlas;
    conus_selection *parts, *whole;
};

/* Seen from above by a cylinder; `parent` is that of the two small spheres. */
static struct spheres select_spheres(uint32_t parent, double radius)
{
    struct spheres spheres = {.atlas = sphere_atlas()};
    conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = radius};
    conus_pose pose;
    spheres.atlas->objects[1].parent = spheres.atlas->objects[2].parent = parent;
    assert_ok(conus_pose_toward(&pose, (double[]){0, 3, 200}, (double[]){0, 3, 0}, NULL));
    spheres.parts = select_from(spheres.atlas, &options, &pose);
    options.level = "1";
    spheres.whole = select_from(spheres.atlas, &options, &pose);
    return spheres;
}

static void finish(struct spheres *spheres)
{
    conus_selection_destroy(spheres->parts);
    conus_selection_destroy(spheres->whole);
    conus_atlas_destroy(spheres->atlas);
}

/* A mesh lies in that of its parent, so the union is that of the parent: nothing counts twice. */
static void nested_meshes_count_once(void **state)
{
    (void)state;
    struct spheres spheres = select_spheres(1, 30);
    const conus_result *own = result_of(spheres.parts, 1);
    const conus_result *group = result_of(spheres.whole, 1);
    assert_int_equal(conus_selection_count(spheres.parts), 5);
    assert_int_equal(conus_selection_count(spheres.whole), 3);
    assert_int_equal(group->pierced, own->pierced);
    assert_near(group->path, own->path, 1e-9);
    assert_near(group->volume, own->volume, 1e-6);
    assert_near(group->fraction, own->fraction, 1e-9);
    assert_near(group->fraction, 1, 0.05); /* the cylinder holds all of it */
    finish(&spheres);
}

/* Without a mesh the parent has the sum of its parts, which do not touch. */
static void meshes_apart_add_up(void **state)
{
    (void)state;
    struct spheres spheres = select_spheres(4, 12); /* far from both */
    const conus_result *left = result_of(spheres.parts, 2);
    const conus_result *right = result_of(spheres.parts, 3);
    const conus_result *group = result_of(spheres.whole, 4);
    assert_near(group->volume, left->volume + right->volume, 1e-6);
    assert_int_equal(group->pierced, left->pierced + right->pierced);
    double volume = 0; /* of the group: none of the three spheres lies in another */
    for (size_t i = 1; i < 4; i++) {
        volume += spheres.atlas->objects[i].volume_mm3;
    }
    assert_near(group->fraction, group->volume / volume, 1e-12);
    assert_near(group->path * group->pierced, left->path * left->pierced + right->path * right->pierced, 1e-6);
    finish(&spheres);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    uint64_t random = 48;
    conus_atlas *atlas = scene_atlas(&random, 8, 1);
    for (size_t i = 1; i < atlas->area_count; i++) {
        atlas->objects[i].parent = 1;
    }
    assert_true(atlas->area_count > 1);
    const struct report_attempt attempt = {.atlas = atlas,
                                           .options = {.layers = CONUS_LAYERS_ALL, .level = "1"},
                                           .pose = scene_generic_pose(&random, atlas),
                                           .angle = 57};
    report_every_allocation(&attempt);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(rollup)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_hits_are_as_if_relabelled),
        cmocka_unit_test(all_layers_are_as_if_relabelled),
        cmocka_unit_test(merging_undoes_splitting),
        cmocka_unit_test(shares_add_up),
        cmocka_unit_test(intervals_of_a_group_become_one),
        cmocka_unit_test(nested_meshes_count_once),
        cmocka_unit_test(meshes_apart_add_up),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
