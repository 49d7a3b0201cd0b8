/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas on several grids: the answers are those of each grid alone, joined at the nearest hit. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "gl_pair.h"
#include "scene.h"
#include "test.h"

#include "conus/own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 3, AREAS = 5, SCENES = 40, POSES = 6 };

/* Parcellations on random grids, together and each by itself. Labels of grid g: 10 g + 1 to 10 g + 5. */
struct grids {
    conus_atlas *joint;
    conus_atlas *single[MOST];
    size_t count;
};

static uint32_t *random_labels(uint64_t *state, const conus_volume_info *info, size_t grid)
{
    size_t voxels = info->dim[0] * info->dim[1] * info->dim[2];
    double filled = test_random(state, 0.01, 0.4);
    uint32_t *labels = memory_zeroed(voxels, sizeof *labels);
    assert_non_null(labels);
    for (size_t v = 0; v < voxels; v++) {
        bool is_area = test_random(state, 0, 1) < filled || v == 0;
        labels[v] = is_area ? (uint32_t)(10 * grid + 1 + (size_t)test_random(state, 0, AREAS)) : 0;
    }
    return labels;
}

static struct grids make_grids(uint64_t *state)
{
    struct grids grids = {.count = 2 + (size_t)test_random(state, 0, MOST - 1)};
    conus_volume_info infos[MOST];
    struct labelled_volume volumes[MOST];
    struct label_voxels labels[MOST] = {0};
    for (size_t g = 0; g < grids.count; g++) {
        const size_t dim[3] = {1 + (size_t)test_random(state, 0, 14), 1 + (size_t)test_random(state, 0, 14),
                               1 + (size_t)test_random(state, 0, 14)};
        infos[g] = scene_grid(state, dim);
        uint32_t *list = random_labels(state, &infos[g], g);
        assert_ok(label_voxels_of(&labels[g], list, dim[0] * dim[1] * dim[2]));
        volumes[g] = (struct labelled_volume){.info = &infos[g], .labels = &labels[g]};
        grids.single[g] = scene_parcellation(&infos[g], list);
        memory_free(list);
    }
    struct notes notes = {0};
    const struct label_table none = {0};
    assert_ok(atlas_create_of(&grids.joint, volumes, grids.count, &none, "grids", &notes));
    notes_finish(&notes);
    for (size_t g = 0; g < grids.count; g++) {
        label_voxels_finish(&labels[g]);
    }
    return grids;
}

static void destroy_grids(struct grids *grids)
{
    conus_atlas_destroy(grids->joint);
    for (size_t g = 0; g < grids->count; g++) {
        conus_atlas_destroy(grids->single[g]);
    }
}

static struct evidence trace(const conus_atlas *atlas, const struct cone *cone)
{
    struct engine *engine = NULL;
    assert_ok(engine_rays_create(&engine, atlas, &(struct engine_options){0}));
    struct evidence evidence = gl_pair_trace(engine, cone);
    engine_destroy(engine);
    return evidence;
}

static uint32_t label_of(const conus_atlas *atlas, uint32_t number)
{
    return number ? atlas->objects[number - 1].label : 0;
}

/* The joint atlas shows the nearest hit of all grids; where a ray enters two at the same distance, that of the
 * first. */
static size_t compare_traces(const struct grids *grids, const struct cone *cone)
{
    struct evidence joint = trace(grids->joint, cone);
    struct evidence single[MOST];
    size_t hits = 0;
    for (size_t g = 0; g < grids->count; g++) {
        single[g] = trace(grids->single[g], cone);
    }
    for (size_t p = 0; p < (size_t)cone->resolution * cone->resolution; p++) {
        size_t best = 0;
        for (size_t g = 1; g < grids->count; g++) {
            bool nearer = !single[best].object[p] || single[g].distance[p] < single[best].distance[p];
            best = single[g].object[p] && nearer ? g : best;
        }
        assert_int_equal(label_of(grids->joint, joint.object[p]),
                         label_of(grids->single[best], single[best].object[p]));
        if (joint.object[p]) {
            assert_true(joint.distance[p] == single[best].distance[p]);
            assert_int_equal(joint.voxel[p], single[best].voxel[p]);
            hits++;
        }
    }
    evidence_finish(&joint);
    for (size_t g = 0; g < grids->count; g++) {
        evidence_finish(&single[g]);
    }
    return hits;
}

static void the_nearest_of_all_grids_is_hit(void **state)
{
    (void)state;
    uint64_t random = 11;
    size_t hits = 0;
    for (int scene = 0; scene < SCENES; scene++) {
        struct grids grids = make_grids(&random);
        for (int pose = 0; pose < POSES; pose++) {
            struct cone cone = scene_cone(&random, grids.joint);
            hits += compare_traces(&grids, &cone);
        }
        destroy_grids(&grids);
    }
    assert_true(hits > 15000);
}

/* Both begin at the same plane: the area of the earlier grid is hit, though its label is greater. */
/* Two grids of one voxel, both at 0, with the labels 9 and 3. */
static conus_atlas *two_voxels(const struct label_table *table)
{
    struct label_voxels labels[2] = {0};
    assert_ok(label_voxels_of(&labels[0], (uint32_t[]){9}, 1));
    assert_ok(label_voxels_of(&labels[1], (uint32_t[]){3}, 1));
    const conus_volume_info info = scene_plain_grid((size_t[]){1, 1, 1}, NULL);
    struct labelled_volume volumes[] = {{.info = &info, .labels = &labels[0]}, {.info = &info, .labels = &labels[1]}};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_of(&atlas, volumes, 2, table, "grids", &notes));
    label_voxels_finish(&labels[0]);
    label_voxels_finish(&labels[1]);
    notes_finish(&notes);
    return atlas;
}

static void the_earlier_of_equal_grids_is_hit(void **state)
{
    (void)state;
    conus_atlas *atlas = two_voxels(&(struct label_table){0});
    struct cone cone = {.angle = 0.01, .resolution = 2};
    assert_ok(conus_pose_along(&cone.pose, (double[]){-10, 0.1, 0.2}, (double[]){1, 0, 0}, NULL));
    struct evidence evidence = trace(atlas, &cone);
    assert_int_equal(label_of(atlas, evidence.object[0]), 9);
    evidence_finish(&evidence);
    conus_atlas_destroy(atlas);
}

static void a_packed_atlas_has_all_grids(void **state)
{
    (void)state;
    uint64_t random = 51;
    struct grids grids = make_grids(&random);
    conus_atlas *attached = NULL;
    size_t size = conus_atlas_packed_size(grids.joint);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(memory);
    assert_ok(conus_atlas_pack(memory, size, grids.joint));
    assert_ok(conus_atlas_attach(&attached, memory, size));
    assert_int_equal(atlas_parcellation_count(attached), grids.count);
    for (int pose = 0; pose < POSES; pose++) {
        struct cone cone = scene_cone(&random, grids.joint);
        struct evidence wanted = trace(grids.joint, &cone);
        struct evidence got = trace(attached, &cone);
        gl_pair_same_evidence(&got, &wanted);
        evidence_finish(&wanted);
        evidence_finish(&got);
    }
    conus_atlas_destroy(attached);
    free(memory);
    destroy_grids(&grids);
}

static conus_selection *ask(conus_selector **selector, const conus_atlas *atlas, const conus_pose *pose, double angle)
{
    const conus_selector_options options = {.resolution = 24, .layers = CONUS_LAYERS_ALL};
    conus_selection *selection = NULL;
    *selector = NULL;
    assert_ok(conus_selector_create(selector, atlas, &options));
    assert_ok(conus_select(&selection, *selector, pose, degrees_from_radians(angle)));
    return selection;
}

/* A mask lies on one grid: it needs the name of an area that has all its voxels there. */
static void a_mask_of_two_grids_is_refused(void **state)
{
    (void)state;
    static const struct {
        uint32_t label; /* 0: no area is named */
        const char *refused;
    } cases[] = {{9, NULL},
                 {3, NULL},
                 {0, "mask: the areas lie on 2 different grids, name one of them (--mask-object)"},
                 {7, "mask: Both has no voxels, or voxels on different grids"},
                 {8, "mask: None has no voxels, or voxels on different grids"}};
    struct label_table table = {0};
    for (uint32_t label = 3; label <= 9; label += label == 3 ? 4 : 1) { /* 3, 7, 8, 9 */
        struct label *entry = label_table_add(&table, label);
        assert_non_null(entry);
        assert_ok(label_set_text(&entry->name, text_from(label == 7 ? "Both" : label == 8 ? "None" : "Voxel")));
        entry->has_parent = label == 3 || label == 9;
        entry->parent = 7;
    }
    conus_atlas *atlas = two_voxels(&table);
    label_table_finish(&table);
    conus_pose pose;
    conus_selector *selector = NULL;
    assert_ok(conus_pose_along(&pose, (double[]){-10, 0, 0}, (double[]){1, 0, 0}, NULL));
    conus_selection *selection = ask(&selector, atlas, &pose, 0.3);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        conus_grid *grid = NULL;
        conus_grid_options options = {.content = CONUS_GRID_MASK_OF_AREAS};
        for (uint32_t object = 1; object <= atlas->object_count; object++) {
            options.object = cases[c].label && label_of(atlas, object) == cases[c].label ? object : options.object;
        }
        assert_true(!options.object == !cases[c].label);
        conus_status status = conus_selection_grid(&grid, selection, &options);
        assert_int_equal(status, cases[c].refused ? CONUS_ERROR_ARGUMENT : CONUS_OK);
        if (cases[c].refused) {
            assert_null(grid);
            assert_string_equal(conus_message(), cases[c].refused);
        } else {
            assert_int_equal(*(const uint8_t *)conus_grid_data(grid).data, 1);
        }
        conus_grid_destroy(grid);
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static const conus_result *find_label(const conus_selection *selection, const conus_atlas *atlas, uint32_t label)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && label_of(atlas, result->object) == label) {
            return result;
        }
    }
    return NULL;
}

/* With all layers objects do not affect each other, so voxels, volume, path, entry and exit are those of the grid
 * alone. */
static size_t compare_layers(const conus_selection *got, const conus_atlas *joint, const conus_selection *wanted,
                             const conus_atlas *single)
{
    size_t compared = 0;
    for (size_t i = 0; i < conus_selection_count(wanted); i++) {
        const conus_result *of = conus_selection_result(wanted, i);
        if (of->object) {
            const conus_result *result = find_label(got, joint, label_of(single, of->object));
            assert_non_null(result);
            assert_int_equal(result->voxels, of->voxels);
            assert_int_equal(result->pierced, of->pierced);
            assert_memory_equal(&result->volume, &of->volume, sizeof of->volume);
            assert_memory_equal(&result->path, &of->path, sizeof of->path);
            assert_memory_equal(&result->entry, &of->entry, sizeof of->entry);
            assert_memory_equal(&result->exit, &of->exit, sizeof of->exit);
            assert_memory_equal(result->centroid, of->centroid, sizeof of->centroid);
            compared++;
        }
    }
    return compared;
}

static void layers_are_those_of_each_grid(void **state)
{
    (void)state;
    uint64_t random = 23;
    size_t compared = 0;
    for (int scene = 0; scene < SCENES; scene++) {
        struct grids grids = make_grids(&random);
        struct cone cone = scene_cone(&random, grids.joint);
        conus_selector *selector = NULL;
        double angle = fmin(cone.angle, 2);
        conus_selection *joint = ask(&selector, grids.joint, &cone.pose, angle);
        size_t rows = 0;
        for (size_t g = 0; g < grids.count; g++) {
            conus_selector *other = NULL;
            conus_selection *single = ask(&other, grids.single[g], &cone.pose, angle);
            rows += compare_layers(joint, grids.joint, single, grids.single[g]);
            conus_selection_destroy(single);
            conus_selector_destroy(other);
        }
        for (size_t i = 0; i < conus_selection_count(joint); i++) {
            rows -= conus_selection_result(joint, i)->object > 0;
        }
        assert_int_equal(rows, 0);
        compared += conus_selection_count(joint);
        conus_selection_destroy(joint);
        conus_selector_destroy(selector);
        destroy_grids(&grids);
    }
    assert_true(compared > 100);
}

static void both_engines_see_all_grids_alike(void **state)
{
    (void)state;
    uint64_t random = 37;
    size_t hits = 0;
    size_t intervals = 0;
    for (int scene = 0; scene < SCENES; scene++) {
        struct grids grids = make_grids(&random);
        struct gl_pair pair = gl_pair_create(grids.joint, CONUS_SAMPLING_EXACT);
        for (int pose = 0; pose < POSES; pose++) {
            struct cone cone = scene_cone(&random, grids.joint);
            hits += gl_pair_same_hits(&pair, &cone);
            struct layers gl = gl_pair_pierce(pair.gl, &cone);
            struct layers rays = gl_pair_pierce(pair.rays, &cone);
            assert_int_equal(gl.count, rays.count);
            for (size_t s = 0; s < gl.count; s++) {
                assert_true(gl_pair_same_interval(&gl.intervals[s], &rays.intervals[s]));
            }
            intervals += gl.count;
            layers_finish(&gl);
            layers_finish(&rays);
        }
        gl_pair_destroy(&pair);
        destroy_grids(&grids);
    }
    assert_true(hits > 20000 && intervals > 60000);
}

TEST_GROUP(grids)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_of_all_grids_is_hit), cmocka_unit_test(the_earlier_of_equal_grids_is_hit),
        cmocka_unit_test(a_packed_atlas_has_all_grids),    cmocka_unit_test(layers_are_those_of_each_grid),
        cmocka_unit_test(a_mask_of_two_grids_is_refused),  cmocka_unit_test(both_engines_see_all_grids_alike),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
