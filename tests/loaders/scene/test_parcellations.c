/* SPDX-License-Identifier: BSD-3-Clause */
/* Several parcellations in one manifest: what follows from several grids. Whose a label is, and whose a voxel:
 * tests/corpus/scene/parcellations/. */
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/volumes/volumes.h"
#include "render/colour/colour.h"
#include "test.h"

#include <math.h>
#include <string.h>

/* Slabs across x in 12 x 8 x 8 voxels of 1 mm whose first centre is the origin, and in 8 x 4 x 4 voxels of 2 mm whose
 * first centre is at (1/4, 1/4, 1/4). By the index i along x:
 *
 * left.nii   1 mm  label 1: i 0 to 4, label 2: i 5 and 6
 * right.nii  1 mm  label 1: i 6 to 11
 * coarse.nii 2 mm  label 8: i 1, label 9: i 0 and 2 to 7
 *
 * In this order, right loses i = 6: 64 voxels, and keeps 5 * 64 = 320. Centres of the coarse voxels are at x = 1/4 +
 * 2i: up to i = 5 they lie in voxels of 1 mm (0 to 10), from 12.25 on outside. So 8 loses all of its 16 voxels, and 9
 * loses i = 0, 2, 3, 4, 5, which are 80, and keeps 32 of 8 mm^3. */
enum { FINE_LAYER = 64, COARSE_LAYER = 16 };

static uint32_t left(size_t i)
{
    return i <= 4 ? 1 : i <= 6 ? 2 : 0;
}

static uint32_t right(size_t i)
{
    return i >= 6 ? 1 : 0;
}

static uint32_t coarse(size_t i)
{
    return i == 1 ? 8 : 9;
}

static int space_code = 1; /* of the files that are written */

static conus_status write_slabs(const char *name, bool fine, uint32_t (*label)(size_t i))
{
    conus_volume_info info = {.dim = {fine ? 12 : 8, fine ? 8 : 4, fine ? 8 : 4}};
    uint32_t labels[12 * 8 * 8];
    struct job job = {0};
    mat4_identity(info.world_from_voxel);
    for (size_t a = 0; a < 3 && !fine; a++) {
        info.world_from_voxel[5 * a] = 2;
        info.world_from_voxel[12 + a] = 0.25;
    }
    for (size_t i = 0; i < info.dim[0] * info.dim[1] * info.dim[2]; i++) {
        labels[i] = label(i % info.dim[0]);
    }
    const struct bytes file = nifti_format_values(&job, &info, labels, space_code);
    (void)JOB_CALL(&job, conus_write_file(test_in(name), file.data, file.size));
    return job_close(&job, NULL, NULL);
}

static void write_text(const char *name, const char *text)
{
    assert_ok(conus_write_file(test_in(name), text, strlen(text)));
}

static int write_files(void **state)
{
    (void)state;
    test_folder("parcellations");
    conus_status status = write_slabs("left.nii", true, left);
    status = status ? status : write_slabs("right.nii", true, right);
    status = status ? status : write_slabs("coarse.nii", false, coarse);
    write_text("left.txt", "1 Front\n2 Back\n");
    write_text("right.txt", "1 Front\n");
    return status != CONUS_OK;
}

static conus_status load(conus_atlas **atlas, const char *keys)
{
    struct buffer text = {0};
    *atlas = NULL;
    buffer_format(&text, "{\"conus_atlas\": 1, %s}", keys);
    assert_ok(buffer_status(&text));
    write_text("test.atlas.json", text.data);
    buffer_finish(&text);
    conus_status status = conus_atlas_load(atlas, test_in("test.atlas.json"), NULL);
    assert_true(!status == (*atlas != NULL));
    return status;
}

static conus_atlas *loaded(const char *keys)
{
    conus_atlas *atlas;
    assert_ok(load(&atlas, keys));
    return atlas;
}

#define LEFT "{\"file\": \"left.nii\", \"hemisphere\": \"L\"}"
#define RIGHT "{\"file\": \"right.nii\", \"hemisphere\": \"R\", \"label_offset\": 100}"
#define PAIR "\"parcellations\": [" LEFT ", " RIGHT "]"
#define THREE "\"parcellations\": [" LEFT ", " RIGHT ", \"coarse.nii\"]"

struct wanted {
    uint32_t label;
    const char *name;
    char hemisphere;
    uint64_t voxels;
    double mm3;
};

static void assert_areas(const conus_atlas *atlas, const struct wanted *wanted, size_t count)
{
    assert_int_equal(conus_atlas_object_count(atlas), count);
    for (size_t i = 0; i < count; i++) {
        const conus_object *area = conus_atlas_object(atlas, i + 1);
        assert_int_equal(area->label, wanted[i].label);
        assert_string_equal(area->name, wanted[i].name);
        assert_int_equal(area->hemisphere, wanted[i].hemisphere);
        assert_int_equal(area->voxels, wanted[i].voxels);
        assert_near(area->volume_mm3, wanted[i].mm3, 1e-9);
    }
}

static bool has_file(const conus_atlas *atlas, const char *name)
{
    for (size_t i = 0; i < atlas->files.count; i++) {
        struct bytes content = {0};
        char sum[65];
        if (strcmp(atlas->files.items[i].path, test_in(name)) == 0) {
            assert_ok(file_read(&content, test_in(name), UINT64_MAX));
            file_sha256(sum, &content);
            bytes_finish(&content);
            return strcmp(sum, atlas->files.items[i].sha256) == 0;
        }
    }
    return false;
}

static void one_grid_makes_one_volume(void **state)
{
    (void)state;
    static const struct wanted wanted[] = {{1, "Front", 'L', 5 * FINE_LAYER, 5 * FINE_LAYER},
                                           {2, "Back", 'L', 2 * FINE_LAYER, 2 * FINE_LAYER},
                                           {101, "Front", 'R', 5 * FINE_LAYER, 5 * FINE_LAYER}};
    conus_atlas *atlas = loaded(PAIR);
    assert_areas(atlas, wanted, 3);
    assert_int_equal(conus_atlas_volume_count(atlas), 1);
    assert_non_null(atlas_parcellation(atlas));
    for (size_t i = 0; i < 12; i++) {
        assert_int_equal(volume_object(&atlas->volumes[0], i), i <= 4 ? 1 : i <= 6 ? 2 : 3);
    }
    assert_true(test_has_note(atlas, "parcellations: 2 on 1 grid (left.nii with right.nii)"));
    assert_true(test_has_note(
        atlas, "right.nii: voxels in areas of earlier parcellations, which keep them: 64 (of 1 of its areas)"));
    assert_false(test_has_note(atlas, "that lose all"));
    assert_true(has_file(atlas, "right.nii"));
    assert_true(has_file(atlas, "right.txt"));
    assert_false(has_file(atlas, "left.nii")); /* it is the volume's */
    assert_non_null(strstr(conus_atlas_label_source(atlas), "left.txt; "));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED)); /* Front, by the column hemisphere */
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    conus_atlas_destroy(atlas);
    atlas = loaded("\"parcellations\": [" RIGHT ", " LEFT "]"); /* values up to 1, and up to 2 */
    assert_near(conus_atlas_volume(atlas, 0)->maximum, 2, 0);
    conus_atlas_destroy(atlas);
}

static void the_tree_reaches_over_grids(void **state)
{
    (void)state;
    conus_atlas *atlas = loaded(THREE ", \"tree\": [{\"label\": 500, \"name\": \"Whole\"}, {\"label\": 9, \"parent\": "
                                      "500}, {\"label\": 101, \"parent\": 500}]");
    const struct volume *fine = &atlas->volumes[0];
    assert_int_equal(conus_atlas_object(atlas, 4)->parent, 5);
    assert_int_equal(conus_atlas_object(atlas, 3)->parent, 5);
    assert_ptr_equal(atlas_only_volume(atlas, 3), fine);
    assert_ptr_equal(atlas_only_volume(atlas, 4), fine + 1);
    assert_null(atlas_only_volume(atlas, 5));
    double centre[3]; /* of 320 mm^3 about x = 9 and 256 mm^3 about x = 13.25 */
    assert_ok(conus_atlas_centre(centre, atlas, 5));
    assert_near(centre[0], (320 * 9 + 256 * 13.25) / 576, 1e-12);
    conus_atlas_destroy(atlas);
}

static const conus_result *result_of(const conus_selection *selection, uint32_t number)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        if (conus_selection_result(selection, i)->object == number) {
            return conus_selection_result(selection, i);
        }
    }
    fail_msg("object %u is not in the answer", number);
    return NULL;
}

/* A ball around all: 768 voxels of 1 mm and 128 of 2 mm lie in it. */
static void a_ball_counts_each_grid(void **state)
{
    (void)state;
    static const struct {
        uint32_t number;
        uint64_t voxels;
        double share, mm3;
    } wanted[] = {
        {1, 320, 320.0 / 768, 320}, {2, 128, 128.0 / 768, 128}, {3, 320, 320.0 / 768, 320}, {4, 32, 32.0 / 128, 256}};
    conus_atlas *atlas = loaded(THREE);
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.layers = CONUS_LAYERS_ALL}));
    assert_ok(conus_select_ball(&selection, selector, (double[]){6, 3, 3}, 100));
    for (size_t i = 0; i < 4; i++) {
        const conus_result *result = result_of(selection, wanted[i].number);
        assert_int_equal(result->voxels, wanted[i].voxels);
        assert_near(result->share, wanted[i].share, 1e-12);
        assert_near(result->volume, wanted[i].mm3, 1e-9);
        assert_near(result->cone_fraction, wanted[i].mm3 / (320 + 128 + 320 + 256), 1e-12);
    }
    for (size_t i = 0; i < conus_selection_count(selection); i++) { /* no grid has "no area" for itself */
        const conus_result *result = conus_selection_result(selection, i);
        assert_true(result->object || (isnan(result->share) && isnan(result->volume)));
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* One ray along x, from either side: cells of 1 mm begin at x = -1/2, those of i = 6 and 7 are 11.25 to 15.25. */
static void a_ray_passes_the_grids_in_order(void **state)
{
    (void)state;
    static const double ends[][2] = {{-0.5, 4.5}, {4.5, 6.5}, {6.5, 11.5}, {11.25, 15.25}};
    conus_atlas *atlas = loaded(THREE);
    conus_selector *selector = NULL;
    const conus_selector_options options = {.resolution = 1, .radius = 0.01, .layers = CONUS_LAYERS_ALL};
    assert_ok(conus_selector_create(&selector, atlas, &options));
    for (int side = -1; side <= 1; side += 2) {
        conus_pose pose;
        conus_selection *selection = NULL;
        const double origin[3] = {50 * side, 3.3, 3.4};
        const double direction[3] = {-side, 0, 0};
        assert_ok(conus_pose_along(&pose, origin, direction, NULL));
        assert_ok(conus_select(&selection, selector, &pose, 0));
        for (uint32_t number = 1; number <= 4; number++) {
            const conus_result *result = result_of(selection, number);
            assert_near(result->entry, side < 0 ? ends[number - 1][0] + 50 : 50 - ends[number - 1][1], 1e-9);
            assert_near(result->exit, side < 0 ? ends[number - 1][1] + 50 : 50 - ends[number - 1][0], 1e-9);
            assert_int_equal(result->pixels, number == (side < 0 ? 1 : 4));
        }
        conus_selection_destroy(selection);
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_selection *select_all(conus_selector **selector, const conus_atlas *atlas)
{
    conus_selection *selection = NULL;
    *selector = NULL;
    assert_ok(conus_selector_create(selector, atlas, &(conus_selector_options){.layers = CONUS_LAYERS_ALL}));
    assert_ok(conus_select_ball(&selection, *selector, (double[]){6, 3, 3}, 100));
    return selection;
}

static size_t count_marked(const conus_grid *grid)
{
    const conus_grid_view view = conus_grid_data(grid);
    size_t count = 0;
    for (size_t i = 0; i < view.count; i++) {
        count += ((const uint8_t *)view.data)[i] != 0;
    }
    return count;
}

static void a_mask_lies_on_one_grid(void **state)
{
    (void)state;
    conus_selector *selector;
    conus_grid *grid = NULL;
    conus_atlas *atlas = loaded(THREE ", \"tree\": [{\"label\": 500, \"name\": \"Whole\"}, {\"label\": 9, \"parent\": "
                                      "500}, {\"label\": 101, \"parent\": 500}]");
    conus_selection *selection = select_all(&selector, atlas);
    assert_fails(conus_selection_grid(&grid, selection, NULL), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "mask: the areas lie on 2 different grids, name one of them (--mask-object)");
    assert_fails(conus_selection_grid(&grid, selection, &(conus_grid_options){.object = 5}), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "mask: Whole has no voxels, or voxels on different grids");
    static const struct {
        conus_grid_options options;
        size_t count, marked;
    } wanted[] = {{{.object = 3}, 768, 320},
                  {{.object = 4}, 128, 32},
                  {{.object = 4, .content = CONUS_GRID_MASK_OF_REGION}, 128, 128},
                  {{.object = 1, .content = CONUS_GRID_MAP_OF_LABELS}, 768, 320}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        assert_ok(conus_selection_grid(&grid, selection, &wanted[i].options));
        assert_int_equal(conus_grid_data(grid).count, wanted[i].count);
        assert_int_equal(count_marked(grid), wanted[i].marked);
        conus_grid_destroy(grid);
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void areas_of_any_grid_can_be_hidden(void **state)
{
    (void)state;
    conus_atlas *atlas = loaded(THREE);
    assert_ok(conus_atlas_show(atlas, NULL, "9,Back"));
    assert_int_equal(volume_object(&atlas->volumes[1], 7), 0);
    assert_int_equal(volume_object(&atlas->volumes[0], 5), 0);
    assert_int_equal(volume_object(&atlas->volumes[0], 4), 1);
    assert_ok(conus_atlas_show(atlas, NULL, NULL));
    assert_int_equal(volume_object(&atlas->volumes[1], 7), 4);
    assert_int_equal(volume_object(&atlas->volumes[0], 5), 2);
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_UNSUPPORTED);
    assert_string_equal(conus_message(), "hemispheres: split: the areas lie on 2 grids, only those on one can be cut");
    conus_atlas_destroy(atlas);
}

/* Object seen along the row along x at y = z = 3: the first grid's where both have an area, from 11.25 to 11.5. */
static uint32_t seen_at(double x)
{
    return x < -0.5 ? 0 : x < 4.5 ? 1 : x < 6.5 ? 2 : x < 11.5 ? 3 : x < 15.25 ? 4 : 0;
}

static void cuts_and_pictures_show_the_first(void **state)
{
    (void)state;
    enum { WIDTH = 18 };
    const conus_cut_view view = {.centre = {7.9, 3, 3}, .mm_per_pixel = 1, .width = WIDTH, .height = 1};
    uint8_t rgba[4 * WIDTH];
    uint32_t objects[WIDTH];
    struct volume joint;
    conus_atlas *atlas = loaded(THREE);
    assert_ok(conus_cut(rgba, objects, atlas, &view));
    for (int p = 0; p < WIDTH; p++) { /* -0.6, 0.4, ..., 11.4, ... */
        assert_int_equal(objects[p], seen_at(p - 0.6));
    }
    assert_ok(pathways_join(&joint, atlas, NULL, NULL)); /* on the finer grid, extended to x = 14 or more */
    assert_near(joint.info.world_from_voxel[0], 1, 0);
    assert_true(joint.info.dim[0] >= 15);
    for (size_t v = 0; v < joint.voxel_count; v++) {
        const size_t *dim = joint.info.dim;
        const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
        double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
        mat4_point(p, joint.info.world_from_voxel, p);
        if (p[1] == 3 && p[2] == 3) {
            assert_int_equal(joint.objects32[v], seen_at(p[0]));
        }
    }
    volume_finish(&joint);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(parcellations)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_grid_makes_one_volume),        cmocka_unit_test(the_tree_reaches_over_grids),
        cmocka_unit_test(a_ball_counts_each_grid),          cmocka_unit_test(a_ray_passes_the_grids_in_order),
        cmocka_unit_test(a_mask_lies_on_one_grid),          cmocka_unit_test(areas_of_any_grid_can_be_hidden),
        cmocka_unit_test(cuts_and_pictures_show_the_first),
    };
    return cmocka_run_group_tests(tests, write_files, NULL);
}
