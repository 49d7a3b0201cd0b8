/* SPDX-License-Identifier: BSD-3-Clause */
/* Masks of a selection: the voxels of the census (Eq. 10), on the atlas's grid, and back from the file. */
#include "atlas/phantom/phantom.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "scene.h"
#include "selection/selection.h"
#include "test.h"
#include "value_maps.h"

#include <string.h>

struct fixture {
    conus_atlas *atlas; /* the phantom "nested", and a pathway whose values grow along i */
    conus_selector *selector;
    conus_selection *selection; /* a cone that has a part of everything */
};

/* On the grid `info`. */
static void add_pathway(conus_atlas *atlas, conus_volume_info info, const char *name)
{
    size_t count = info.dim[0] * info.dim[1] * info.dim[2];
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 8;
    float *values = memory_raw(count, sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < count; i++) {
        values[i] = (float)(i % info.dim[0]) + 0.25F;
    }
    assert_ok(pathway_of_values(atlas, &info, values, name));
}

static int set_up(void **state)
{
    static struct fixture fixture;
    const conus_phantom_options options = {
        .size = 32, .spacing = {2, 2.5, 3}, .oblique = 0.4 * 180 / MATH3_PI, .flip = {true, false, true}};
    struct phantom_drawing drawing;
    conus_pose pose;
    fixture = (struct fixture){0};
    assert_ok(phantom_draw(&drawing, "nested", &options));
    assert_ok(phantom_drawing_atlas(&fixture.atlas, &drawing));
    phantom_drawing_finish(&drawing);
    add_pathway(fixture.atlas, fixture.atlas->volumes[0].info, "tract");
    const conus_selector_options layers = {.layers = CONUS_LAYERS_ALL};
    assert_ok(conus_selector_create(&fixture.selector, fixture.atlas, &layers));
    assert_ok(conus_pose_toward(&pose, (double[]){-70, 20, 15}, (double[]){1, 2, 3}, NULL));
    assert_ok(conus_select(&fixture.selection, fixture.selector, &pose, degrees_from_radians(0.3)));
    *state = &fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    conus_selection_destroy(fixture->selection);
    conus_selector_destroy(fixture->selector);
    conus_atlas_destroy(fixture->atlas);
    return 0;
}

static double at(const conus_grid_view *view, size_t voxel)
{
    switch (view->number) {
    case CONUS_NUMBER_UINT8:
        return ((const uint8_t *)view->data)[voxel];
    case CONUS_NUMBER_UINT16:
        return ((const uint16_t *)view->data)[voxel];
    case CONUS_NUMBER_UINT32:
        return ((const uint32_t *)view->data)[voxel];
    case CONUS_NUMBER_FLOAT32:
        return (double)((const float *)view->data)[voxel];
    }
    return NAN;
}

static bool in_region(const struct fixture *fixture, size_t voxel)
{
    double p[3];
    scene_voxel(p, &fixture->atlas->volumes[0], voxel);
    return region_has(&fixture->selection->region, p);
}

static conus_grid *grid_of(const struct fixture *fixture, conus_grid_content content, uint32_t object)
{
    conus_grid *grid = NULL;
    const conus_grid_options options = {.content = content, .object = object};
    assert_ok(conus_selection_grid(&grid, fixture->selection, &options));
    return grid;
}

static void grids_hold_what_is_in_the_cone(void **state)
{
    const struct fixture *fixture = *state;
    const struct volume *areas = &fixture->atlas->volumes[0];
    uint32_t pathway = (uint32_t)fixture->atlas->object_count;
    conus_grid *grids[] = {
        grid_of(fixture, CONUS_GRID_MASK_OF_AREAS, 0), grid_of(fixture, CONUS_GRID_MASK_OF_REGION, 0),
        grid_of(fixture, CONUS_GRID_MAP_OF_LABELS, 0), grid_of(fixture, CONUS_GRID_MAP_OF_VALUES, 0),
        grid_of(fixture, CONUS_GRID_MASK_OF_AREAS, 1), grid_of(fixture, CONUS_GRID_MASK_OF_AREAS, pathway),
        grid_of(fixture, CONUS_GRID_MAP_OF_LABELS, 1), grid_of(fixture, CONUS_GRID_MAP_OF_LABELS, 2)};
    static const conus_number numbers[8] = {/* the smallest that hold 1, 300 and 4000000001 */
                                            [2] = CONUS_NUMBER_UINT32,
                                            [3] = CONUS_NUMBER_FLOAT32,
                                            [7] = CONUS_NUMBER_UINT16};
    size_t counts[8] = {0};
    for (size_t voxel = 0; voxel < areas->voxel_count; voxel++) {
        uint32_t object = volume_object(areas, voxel);
        double value = (double)volume_value(&fixture->atlas->volumes[1], voxel);
        bool in = in_region(fixture, voxel);
        const double wanted[] = {in && object,
                                 in,
                                 in && object ? fixture->atlas->objects[object - 1].label : 0,
                                 in && value >= 8 ? value : 0,
                                 in && object == 1,
                                 in && value >= 8,
                                 in && object == 1,
                                 in && object == 2 ? 300 : 0};
        for (size_t g = 0; g < 8; g++) {
            const conus_grid_view view = conus_grid_data(grids[g]);
            assert_int_equal(view.number, numbers[g]);
            assert_true(at(&view, voxel) == wanted[g]);
            counts[g] += wanted[g] != 0;
        }
    }
    assert_true(counts[4] > 0 && counts[4] < counts[0] && counts[0] < counts[1] && counts[3] > 0 && counts[7] > 0);
    for (size_t g = 0; g < 8; g++) {
        conus_grid_destroy(grids[g]);
    }
}

/* The code that a grid has on the atlas's first volume. */
static int code_of(const struct fixture *fixture)
{
    conus_grid *grid = grid_of(fixture, CONUS_GRID_MASK_OF_AREAS, 0);
    int code = conus_grid_data(grid).space_code;
    conus_grid_destroy(grid);
    return code;
}

/* NIfTI-1: with code 0 a reader knows sizes only. Such a grid lies along the axes, i to the left, with its middle,
 * index (n - 1) / 2, at 0; the file has to state the place of any other grid. */
static void a_grid_says_where_it_lies(void **state)
{
    const struct fixture *fixture = *state;
    conus_volume_info *info = &fixture->atlas->volumes[0].info;
    info->space_code = 4;
    assert_int_equal(code_of(fixture), 4);
    info->space_code = 0;
    assert_int_equal(code_of(fixture), 2);
    const double guess[16] = {-2, 0, 0, 0, 0, 2.5, 0, 0, 0, 0, 3, 0, 31, -31.25, -31.5, 1}; /* a grid of 32, 26, 22 */
    for (int i = 0; i < 16; i++) {
        memcpy(info->world_from_voxel, guess, sizeof guess);
        assert_int_equal(code_of(fixture), 0);
        info->world_from_voxel[i] += i % 4 < 3 ? 0.01 : 0;
        assert_int_equal(code_of(fixture), i % 4 < 3 ? 2 : 0);
    }
}

/* Sums of the census's rows, for areas or pathways. */
static uint64_t counted(const struct fixture *fixture, conus_kind kind)
{
    uint64_t voxels = 0;
    for (size_t i = 0; i < conus_selection_count(fixture->selection); i++) {
        const conus_result *result = conus_selection_result(fixture->selection, i);
        voxels += result->kind == kind ? result->voxels : 0;
    }
    return voxels;
}

static void files_hold_what_the_census_counts(void **state)
{
    const struct fixture *fixture = *state;
    static const char *const names[] = {"labels_dseg.nii.gz", "labels_dseg.nii"};
    conus_grid *grid = grid_of(fixture, CONUS_GRID_MAP_OF_LABELS, 0);
    for (size_t n = 0; n < 2; n++) {
        conus_atlas *atlas = NULL;
        uint64_t voxels = 0;
        const char *path = test_scratch(names[n]);
        assert_ok(conus_grid_write(grid, path));
        assert_ok(conus_atlas_load(&atlas, path, NULL));
        const conus_volume_info *info = conus_atlas_volume(atlas, 0);
        assert_memory_equal(info->world_from_voxel, fixture->atlas->volumes[0].info.world_from_voxel,
                            sizeof info->world_from_voxel);
        for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
            voxels += conus_atlas_object(atlas, number)->voxels;
        }
        assert_int_equal(voxels, counted(fixture, CONUS_KIND_AREA));
        conus_atlas_destroy(atlas);
    }
    conus_grid_destroy(grid);
}

static void the_same_grid_is_the_same_bytes(void **state)
{
    const struct fixture *fixture = *state;
    struct bytes files[2];
    for (size_t i = 0; i < 2; i++) {
        conus_grid *grid = grid_of(fixture, CONUS_GRID_MAP_OF_VALUES, 0);
        const char *path = test_scratch(i ? "b.nii.gz" : "a.nii.gz");
        assert_ok(conus_grid_write(grid, path));
        assert_ok(file_read(&files[i], path, 1 << 24));
        conus_grid_destroy(grid);
    }
    assert_int_equal(files[0].size, files[1].size);
    assert_memory_equal(files[0].data, files[1].data, files[0].size);
    bytes_finish(&files[0]);
    bytes_finish(&files[1]);
}

static void assert_refused(const struct fixture *fixture, conus_grid_content content, uint32_t object,
                           const char *message)
{
    conus_grid *grid = NULL;
    const conus_grid_options options = {.content = content, .object = object};
    assert_fails(conus_selection_grid(&grid, fixture->selection, &options), CONUS_ERROR_ARGUMENT);
    assert_null(grid);
    assert_string_equal(conus_message(), message);
}

static void what_has_no_voxels_is_refused(void **state)
{
    const struct fixture *fixture = *state;
    conus_selection alone = *fixture->selection;
    conus_atlas *empty = NULL;
    assert_refused(fixture, CONUS_GRID_MASK_OF_AREAS, 99, "object: 99, allowed is up to 4");
    assert_refused(fixture, CONUS_GRID_MAP_OF_VALUES, 1, "map of values: Shell outer is an area, a pathway is needed");
    assert_refused(fixture, CONUS_GRID_MAP_OF_LABELS, 4, "map of labels: tract is a pathway, an area is needed");
    assert_refused(fixture, CONUS_GRID_MASK_OF_REGION, 1,
                   "mask of everything: Shell outer is an area, which has no effect");
    assert_ok(atlas_create_empty(&empty, "none"));
    alone.atlas = empty;
    assert_refused(&(struct fixture){.selection = &alone}, CONUS_GRID_MASK_OF_AREAS, 0,
                   "mask of an atlas without labelled voxels: there is no pathway");
    assert_refused(&(struct fixture){.selection = &alone}, CONUS_GRID_MAP_OF_LABELS, 0,
                   "map of labels: the atlas has no labelled voxels");
    conus_atlas_destroy(empty);
    struct phantom_drawing drawing;
    conus_atlas *hidden = NULL;
    assert_ok(phantom_draw(&drawing, "nested", &(conus_phantom_options){.size = 16}));
    assert_ok(phantom_drawing_atlas(&hidden, &drawing));
    phantom_drawing_finish(&drawing);
    assert_ok(conus_atlas_show(hidden, NULL, "Core"));
    alone.atlas = hidden;
    assert_refused(&(struct fixture){.selection = &alone}, CONUS_GRID_MASK_OF_AREAS, 3, "object: Core is hidden");
    conus_atlas_destroy(hidden);
    conus_grid *grid = grid_of(fixture, CONUS_GRID_MASK_OF_AREAS, 0);
    assert_fails(conus_grid_write(grid, "mask.png"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "mask.png: a volume's name ends in .nii or .nii.gz");
    assert_fails(conus_grid_write(grid, test_scratch("missing/mask.nii")), CONUS_ERROR_IO);
    conus_grid_destroy(grid);
}

static conus_status make_and_write(void *data)
{
    const struct fixture *fixture = data;
    conus_grid *grid = NULL;
    const conus_grid_options options = {.content = CONUS_GRID_MAP_OF_LABELS};
    conus_status status = conus_selection_grid(&grid, fixture->selection, &options);
    status = status ? status : conus_grid_write(grid, test_scratch("memory.nii.gz"));
    conus_grid_destroy(grid);
    return status;
}

/* A mask of the region needs no name of a pathway while all pathways have one grid. */
static void everything_needs_no_name_on_one_grid(void **state)
{
    const struct fixture *fixture = *state;
    conus_volume_info info = fixture->atlas->volumes[0].info;
    const conus_grid_options everything = {.content = CONUS_GRID_MASK_OF_REGION};
    for (int moved = 0; moved < 2; moved++) {
        conus_atlas *atlas = NULL;
        conus_selector *selector = NULL;
        conus_selection *selection = NULL;
        conus_grid *grid = NULL;
        conus_pose pose;
        assert_ok(atlas_create_empty(&atlas, ""));
        add_pathway(atlas, info, "one");
        add_pathway(atlas, info, "two");
        info.world_from_voxel[12] += moved;
        add_pathway(atlas, info, "three");
        assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.layers = CONUS_LAYERS_ALL}));
        assert_ok(conus_pose_toward(&pose, (double[]){-70, 20, 15}, (double[]){1, 2, 3}, NULL));
        assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(0.3)));
        conus_status status = conus_selection_grid(&grid, selection, &everything);
        assert_int_equal(status, moved ? CONUS_ERROR_ARGUMENT : CONUS_OK);
        if (moved) { /* the third one */
            assert_non_null(strstr(conus_message(), "found 2 pathways on different grids, name one of them"));
        }
        conus_grid_destroy(grid);
        conus_selection_destroy(selection);
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
}

static void survives_every_failing_allocation(void **state)
{
    test_every_allocation(make_and_write, *state);
}

TEST_GROUP(mask)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(grids_hold_what_is_in_the_cone, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_grid_says_where_it_lies, set_up, tear_down),
        cmocka_unit_test_setup_teardown(files_hold_what_the_census_counts, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_same_grid_is_the_same_bytes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_has_no_voxels_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(everything_needs_no_name_on_one_grid, set_up, tear_down),
        cmocka_unit_test_setup_teardown(survives_every_failing_allocation, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
