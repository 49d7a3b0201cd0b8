/* SPDX-License-Identifier: BSD-3-Clause */
/* The head in a context, the place of a moved atlas in it, and the notes about that. */
#include "atlas/fit/fit.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

enum { EDGE = 10, VOXELS = EDGE * EDGE * EDGE };

/* Voxels of 4 mm, the middle of the grid where `centre` is. */
static conus_voxels grid_at(const void *data, conus_scalar type, const double centre[3])
{
    conus_voxels voxels = CONUS_VOXELS_INIT;
    voxels.data = data;
    voxels.type = type;
    for (size_t a = 0; a < 3; a++) {
        voxels.dim[a] = EDGE;
        voxels.world_from_voxel[5 * a] = 4;
        voxels.world_from_voxel[12 + a] = centre[a] - 4 * (EDGE - 1) / 2.0;
    }
    voxels.world_from_voxel[15] = 1;
    return voxels;
}

static bool is_within(size_t voxel, size_t margin)
{
    const size_t at[3] = {voxel % EDGE, voxel / EDGE % EDGE, voxel / EDGE / EDGE};
    bool within = true;
    for (size_t a = 0; a < 3; a++) {
        within = within && at[a] >= margin && at[a] < EDGE - margin;
    }
    return within;
}

/* A cube of 24 mm about 0: the inner 6 x 6 x 6 voxels. */
static conus_atlas *make_cube(void)
{
    static uint8_t labels[VOXELS];
    for (size_t v = 0; v < VOXELS; v++) {
        labels[v] = is_within(v, 2);
    }
    conus_atlas *atlas = NULL;
    const conus_voxels voxels = grid_at(labels, CONUS_SCALAR_UINT8, (const double[3]){0});
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, &(conus_create_options){.labels_anyway = true}));
    return atlas;
}

/* A head of 8 x 8 x 8 voxels about `centre`, as a shell like a skull: dark inside, and open below. Two specks are in
 * corners of the grid. */
static conus_status add_head(conus_atlas *atlas, const double centre[3])
{
    static float values[VOXELS];
    for (size_t v = 0; v < VOXELS; v++) {
        bool is_base = v / EDGE / EDGE == 1 && is_within(v + EDGE * EDGE, 2);
        values[v] = is_within(v, 1) && !is_within(v, 2) && !is_base ? 100 : 0;
    }
    values[0] = values[EDGE - 1] = 100;
    const conus_voxels voxels = grid_at(values, CONUS_SCALAR_FLOAT32, centre);
    return conus_atlas_set_context_voxels(atlas, &voxels, NULL);
}

/* The shell has two values, so that any threshold above 0 separates them best from the 0s in the first of 256 classes.
 * The head is everything that the shell encloses along two axes: 8^3 voxels. Between the specks there is none. */
static void a_skull_encloses_a_head(void **state)
{
    (void)state;
    struct head head;
    conus_atlas *atlas = make_cube();
    assert_ok(add_head(atlas, (const double[3]){0}));
    assert_ok(head_make(&head, atlas_context(atlas)));
    assert_near(head.threshold, 100.0 / 256, 1e-12);
    for (size_t v = 0; v < VOXELS; v++) {
        assert_int_equal(head.inside[v], is_within(v, 1) || v == 0 || v == EDGE - 1);
    }
    bool inside = false;
    assert_false(head_grid_has(&inside, &head, (const double[]){0, 0, 20.1}));
    assert_true(head_grid_has(&inside, &head, (const double[]){0, 0, 17}));
    assert_false(inside);
    assert_true(head_grid_has(&inside, &head, (const double[]){0, 0, 15.9}));
    assert_true(inside);
    head_finish(&head);
    conus_atlas_destroy(atlas);
}

/* In a grid of 300 each cell is three voxels: a bar from voxel 150 on is found from voxel 150 on, as a cell begins
 * there. */
static void large_grids_are_sampled_at_every_third_voxel(void **state)
{
    (void)state;
    static float values[300 * 2 * 2];
    for (size_t v = 0; v < sizeof values / sizeof *values; v++) {
        values[v] = v % 300 >= 150 ? 7 : 3;
    }
    struct volume context = {.values = values};
    const conus_volume_info info = scene_plain_grid((const size_t[]){300, 2, 2}, NULL);
    struct head head;
    assert_ok(volume_init(&context, &info));
    context.values = values;
    assert_ok(head_make(&head, &context));
    assert_int_equal(head.dim[0], 100);
    bool inside = true;
    assert_true(head_grid_has(&inside, &head, (const double[]){149, 1, 1}));
    assert_false(inside);
    assert_true(head_grid_has(&inside, &head, (const double[]){150, 1, 1}));
    assert_true(inside);
    head_finish(&head);
    memset(values, 0, sizeof values);
    assert_ok(head_make(&head, &context));
    assert_true(isinf(head.threshold));
    head_finish(&head);
    context.values = NULL;
    volume_finish(&context);
}

/* The transform x' = 2 x + 8, y' = y - 4 leads from here to the atlas: the cube is 12 mm wide about x = -4, y = 4. */
static void a_placement_says_where_the_areas_are(void **state)
{
    (void)state;
    static const double centre[3] = {-4, 4, 0};
    static const double low[3] = {-10, -8, -12};
    static const double high[3] = {2, 16, 12};
    conus_placement place = CONUS_PLACEMENT_INIT;
    conus_atlas *atlas = make_cube();
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_false(place.is_moved || place.mirrors || place.has_context);
    assert_near(place.growth, 1, 0);
    assert_near(place.distance_mm, 0, 0);
    assert_near(place.low[0], -12, 1e-12);
    assert_ok(conus_atlas_move(atlas, (const double[16]){2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 8, -4, 0, 1}));
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_true(place.is_moved);
    assert_near(place.atlas_from_world[12], 8, 0);
    assert_near(place.growth, 0.5, 1e-12);
    for (int a = 0; a < 3; a++) {
        assert_near(place.own_low[a], -12, 1e-9);
        assert_near(place.own_high[a], 12, 1e-9);
        assert_near(place.centre[a], centre[a], 1e-9);
        assert_near(place.low[a], low[a], 1e-9);
        assert_near(place.high[a], high[a], 1e-9);
    }
    assert_near(place.distance_mm, sqrt(16 + 16), 1e-9);
    /* a head of 32 mm about x = -4, y = 20, in a grid of 40: it begins at y = 4, where half of the cube is; the grid at
     * y = 0, where a third of it is below */
    assert_ok(add_head(atlas, (const double[]){-4, 20, 0}));
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_true(place.has_context);
    assert_near(place.in_grid, 4.0 / 6, 1e-12);
    assert_near(place.in_head, 3.0 / 6, 1e-12);
    assert_near(place.head_threshold, 100.0 / 256, 1e-12);
    assert_ok(conus_atlas_move(atlas, (const double[16]){-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
    conus_placement shorter = {.struct_size = offsetof(conus_placement, growth), .growth = 77};
    assert_ok(conus_atlas_placement(&shorter, atlas));
    assert_true(shorter.mirrors);
    assert_near(shorter.growth, 77, 0);
    conus_atlas_destroy(atlas);
}

static void surfaces_have_a_place_and_an_empty_atlas_has_none(void **state)
{
    (void)state;
    conus_placement place = CONUS_PLACEMENT_INIT;
    conus_atlas *atlas = mesh_scene_atlas();
    assert_fails(conus_atlas_placement(&place, atlas), CONUS_ERROR_DATA);
    assert_fails(conus_atlas_placement(&place, NULL), CONUS_ERROR_ARGUMENT);
    struct mesh box = mesh_scene_box((const double[]){10, 0, 0}, (const double[]){12, 3, 4});
    mesh_scene_add(atlas, &box);
    assert_ok(conus_atlas_move(atlas, (const double[16]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}));
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_near(place.own_high[2], 4, 1e-5);
    assert_near(place.low[2], -5, 1e-5);
    assert_near(place.centre[0], 11, 1e-5);
    struct mesh other = mesh_scene_box((const double[]){20, 0, 0}, (const double[]){22, 3, 4});
    mesh_scene_add(atlas, &other); /* with as many vertices */
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_near(place.centre[0], (11 + 21) / 2.0, 1e-5);
    conus_atlas_destroy(atlas);
}

/* A box of 32 mm about `centre` around the areas, open at one end if not `closed`; of one side of a brain or none. */
static conus_status add_box(conus_atlas *atlas, const double centre[3], bool closed, char hemisphere)
{
    double low[3];
    double high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = centre[a] - 16;
        high[a] = centre[a] + 16;
    }
    struct context_surface surface = {.mesh = mesh_scene_box(low, high), .opacity = 1, .hemisphere = hemisphere};
    surface.mesh.triangle_count -= closed ? 0 : 1;
    conus_status status = mesh_check(&surface.mesh, &atlas->notes);
    status = status ? status : atlas_add_context_surface(atlas, &surface);
    mesh_finish(&surface.mesh);
    return status;
}

/* The cube's voxels have their centres at -10, -6, -2, 2, 6, 10 along each axis. A box that ends at x = 0 holds half of
 * them. The box around them and one more that begins at x = 4 hold five sixths: three in the one, two in the other. */
static void closed_surfaces_show_a_head(void **state)
{
    (void)state;
    conus_placement place = CONUS_PLACEMENT_INIT;
    conus_atlas *atlas = make_cube();
    assert_ok(add_box(atlas, (const double[]){-16, 0, 0}, false, 0));
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_false(place.has_context);
    assert_ok(add_box(atlas, (const double[]){-16, 0, 0}, true, 0));
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_true(place.has_context && place.head_threshold > 0 && place.head_threshold < 1);
    assert_near(place.in_grid, 0.5, 1e-12);
    assert_near(place.in_head, 0.5, 1e-12);
    assert_ok(add_box(atlas, (const double[]){-16, 0, 0}, true, 0)); /* once more: a point in both is in the head */
    assert_ok(add_box(atlas, (const double[]){20, 24, 0}, true, 0)); /* begins at y = 8, too */
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_near(place.in_grid, 1, 1e-12);
    assert_near(place.in_head, 0.5 + 2.0 / 6 / 6, 1e-12);
    assert_ok(add_head(atlas, (const double[]){100, 0, 0})); /* a volume shows more */
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_near(place.in_head, 0, 0);
    conus_atlas_destroy(atlas);
}

/* Two boxes of one surface around the cube, from z = -16 to 4 and from -4 to 16. Where they overlap, the surface winds
 * twice around the voxels, which are in the head just as those in one box. */
static void a_surface_may_wind_twice_around_a_head(void **state)
{
    (void)state;
    conus_placement place = CONUS_PLACEMENT_INIT;
    conus_atlas *atlas = make_cube();
    struct mesh below = mesh_scene_box((const double[]){-16, -16, -16}, (const double[]){16, 16, 4});
    struct mesh above = mesh_scene_box((const double[]){-16, -16, -4}, (const double[]){16, 16, 16});
    struct context_surface surface = {.mesh = mesh_scene_join(&below, &above), .opacity = 1};
    assert_ok(mesh_check(&surface.mesh, &atlas->notes));
    assert_ok(atlas_add_context_surface(atlas, &surface));
    mesh_finish(&surface.mesh);
    assert_ok(conus_atlas_placement(&place, atlas));
    assert_near(place.in_head, 1, 1e-12);
    conus_atlas_destroy(atlas);
}

static void surfaces_tell_of_other_readings(void **state)
{
    (void)state;
    conus_atlas *atlas = make_cube();
    assert_ok(conus_atlas_move(atlas, (const double[16]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 60, 24, 8, 1}));
    size_t before = conus_atlas_note_count(atlas);
    assert_ok(add_box(atlas, (const double[]){60, 24, 8}, true, 'L'));
    assert_ok(fit_note_surfaces(atlas)); /* with a left half alone, points right of it are not suspicious */
    assert_int_equal(conus_atlas_note_count(atlas), before);
    assert_ok(add_box(atlas, (const double[]){60, 24, 8}, true, 'R'));
    atlas->context_surfaces[1].mesh.path = memory_text("rh.pial", 7);
    assert_ok(fit_note_surfaces(atlas));
    assert_int_equal(conus_atlas_note_count(atlas), before + 1);
    assert_string_equal(conus_atlas_note(atlas, before),
                        "0 % of the atlas is in the head of rh.pial; in the other direction it would be 100 %");
    conus_atlas_destroy(atlas);
}

/* The nearer wall is hit, from either side; a ray that points away hits none. */
static void a_ray_meets_a_surface_around(void **state)
{
    (void)state;
    conus_atlas *atlas = make_cube();
    static const double towards[3] = {2, 0, 0};
    assert_true(isinf(conus_atlas_context_depth(atlas, (const double[]){-40, 1, 2}, towards)));
    assert_ok(add_box(atlas, (const double[3]){0}, true, 0));
    assert_near(conus_atlas_context_depth(atlas, (const double[]){-40, 1, 2}, towards), 12, 1e-9);
    assert_near(conus_atlas_context_depth(atlas, (const double[]){0, 1, 2}, towards), 8, 1e-9);
    assert_true(isinf(conus_atlas_context_depth(atlas, (const double[]){40, 1, 2}, towards)));
    assert_true(isinf(conus_atlas_context_depth(atlas, (const double[]){-40, 17, 2}, towards)));
    conus_atlas_destroy(atlas);
}

/* The note about a cube that was moved by `atlas_from_world`, with a head at `centre`; "" if there is none. */
static const char *said_of(const double atlas_from_world[16], const double centre[3])
{
    static char line[256];
    conus_atlas *atlas = make_cube();
    line[0] = '\0';
    assert_ok(conus_atlas_move(atlas, atlas_from_world));
    size_t before = conus_atlas_note_count(atlas);
    assert_ok(add_head(atlas, centre));
    assert_true(conus_atlas_note_count(atlas) <= before + 1);
    if (conus_atlas_note_count(atlas) > before) {
        snprintf(line, sizeof line, "%s", conus_atlas_note(atlas, before));
    }
    conus_atlas_destroy(atlas);
    return line;
}

/* The head is 60 mm to the right, 24 mm in front and 8 mm up; the transform to the atlas subtracts that. */
static void better_readings_are_noted(void **state)
{
    (void)state;
    static const double head[3] = {60, 24, 8};
    static const struct {
        double translation[3];
        const char *said;
    } cases[] = {
        {{-60, -24, -8}, ""},
        {{-56, -24, -8}, ""},
        {{60, 24, 8}, "0 % of the atlas is in the head of array; in the other direction it would be 100 %"},
        {{60, 24, -8}, "0 % of the atlas is in the head of array; with LPS in the place of RAS it would be 100 %"},
        {{-.06, -.024, -.008},
         "0 % of the atlas is in the head of array; with a translation 1000 times as long (metres) it would be 100 %"},
        {{-60, -24, 8},
         "50 % of the atlas is in the head of array; in the other direction and with LPS in the place of RAS "
         "it would be 100 %"},
        {{.06, .024, .008},
         "0 % of the atlas is in the head of array; in the other direction and with a translation 1000 times "
         "as long (metres) it would be 100 %"},
        {{-60, 90, 0}, "0 % of the atlas is in the head of array: is the transform of another image?"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double *t = cases[i].translation;
        const double move[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, t[0], t[1], t[2], 1};
        assert_string_equal(said_of(move, head), cases[i].said);
    }
    const double away[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 0, 0, 1};
    assert_string_equal(said_of(away, (const double[3]){0}),
                        "0 % of the atlas is in the head of array; without the transform it would be 100 %");
}

/* The cube is six layers of 4 mm, and the head reaches 16 mm to each side. */
static void slightly_better_readings_are_not_noted(void **state)
{
    (void)state;
    const double nearly[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -4, 0, 0, 1};
    assert_string_equal(said_of(nearly, (const double[]){-4, 0, 0}),
                        "83 % of the atlas is in the head of array; in the other direction it would be 100 %");
    assert_string_equal(said_of(nearly, (const double[]){0, 0, 0}), "");
    /* without a better transform four fifths inside are enough: the cube's layers, 4 mm each, reach from -12 to 12
     * along y; a head from -8 to 24 holds five of six, one from -4 to 28 four */
    const double aside[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -2, 0, 0, 1};
    assert_string_equal(said_of(aside, (const double[]){0, 8, 0}), "");
    assert_string_equal(said_of(aside, (const double[]){0, 12, 0}),
                        "67 % of the atlas is in the head of array: is the transform of another image?");
    /* a better transform must also leave at most half as much outside: one layer is in the head, and two would be in
     * the other direction */
    const double far[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1};
    assert_string_equal(said_of(far, (const double[]){22, 0, 0}),
                        "17 % of the atlas is in the head of array: is the transform of another image?");
}

static conus_status attempt(void *data)
{
    conus_atlas *atlas = data;
    size_t notes = conus_atlas_note_count(atlas);
    size_t volumes = conus_atlas_volume_count(atlas);
    conus_status status = add_head(atlas, (const double[]){60, 24, 8});
    if (status) {
        assert_int_equal(conus_atlas_note_count(atlas), notes);
        assert_int_equal(conus_atlas_volume_count(atlas), volumes);
    }
    return status;
}

static conus_status attempt_placement(void *data)
{
    conus_placement place = {.growth = 77};
    conus_status status = conus_atlas_placement(&place, data);
    assert_true(!status || place.growth > 76);
    return status;
}

static void every_failing_allocation_leaves_the_atlas(void **state)
{
    (void)state;
    conus_atlas *atlas = make_cube();
    assert_ok(conus_atlas_move(atlas, (const double[16]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 60, 24, 8, 1}));
    test_every_allocation(attempt, atlas);
    test_every_allocation(attempt_placement, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(fit)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_skull_encloses_a_head),
        cmocka_unit_test(large_grids_are_sampled_at_every_third_voxel),
        cmocka_unit_test(a_placement_says_where_the_areas_are),
        cmocka_unit_test(surfaces_have_a_place_and_an_empty_atlas_has_none),
        cmocka_unit_test(closed_surfaces_show_a_head),
        cmocka_unit_test(a_surface_may_wind_twice_around_a_head),
        cmocka_unit_test(surfaces_tell_of_other_readings),
        cmocka_unit_test(a_ray_meets_a_surface_around),
        cmocka_unit_test(better_readings_are_noted),
        cmocka_unit_test(slightly_better_readings_are_not_noted),
        cmocka_unit_test(every_failing_allocation_leaves_the_atlas),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
