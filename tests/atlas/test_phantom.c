/* SPDX-License-Identifier: BSD-3-Clause */
/* Phantoms against the volumes of their shapes and the rule for each voxel. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "test.h"

#include <string.h>

static const conus_phantom_options grids[] = {
    {0},
    {.size = 48},
    {.size = 64, .spacing = {1, 1, 2.5}},
    {.size = 96, .spacing = {2.0 / 3, 1, 2.0 / 3}, .flip = {true, false, false}},
    {.oblique = 0.4 * 180 / MATH3_PI, .flip = {false, true, true}},
    {.spacing = {1, 2, 1}, .oblique = -2 * 180 / MATH3_PI, .flip = {true, true, true}},
};
enum { GRIDS = sizeof grids / sizeof grids[0] };

static uint64_t count_label(const struct phantom_drawing *drawing, uint32_t label)
{
    const size_t *dim = drawing->grid.dim;
    uint64_t count = 0;
    for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++) {
        count += drawing->labels[i] == label;
    }
    return count;
}

/* A voxel that is counted wrongly has its centre within half a diagonal of the border, or a part of its cell outside.
 * Both lie between the shape and the shape grown by that half diagonal, on either side of the border. */
static double grown_volume(struct phantom_shape shape, double by)
{
    for (int axis = 0; axis < 3; axis++) {
        shape.half[axis] += by;
    }
    shape.radius += shape.kind == PHANTOM_BALL ? by : 0;
    shape.tube += by;
    return phantom_shape_volume(&shape);
}

static double volume_bound(const struct phantom_drawing *drawing, uint32_t label)
{
    double by = vec3_length(drawing->grid.spacing) / 2;
    double bound = 0;
    for (size_t i = 0; i < drawing->phantom->shape_count; i++) {
        const struct phantom_shape *shape = &drawing->shapes[i];
        if (shape->label == label || shape->inside == label) {
            bound += grown_volume(*shape, by) - phantom_shape_volume(shape);
        }
    }
    return bound;
}

static void check_volumes(const char *kind, const conus_phantom_options *options)
{
    struct phantom_drawing drawing;
    assert_ok(phantom_draw(&drawing, kind, options));
    const double *spacing = drawing.grid.spacing;
    for (size_t i = 0; i < drawing.phantom->area_count; i++) {
        uint32_t label = drawing.phantom->areas[i].label;
        double volume = (double)count_label(&drawing, label) * spacing[0] * spacing[1] * spacing[2];
        assert_near(volume, phantom_area_volume(&drawing, label), volume_bound(&drawing, label));
    }
    phantom_drawing_finish(&drawing);
}

static void voxels_fill_the_analytic_volume(void **state)
{
    (void)state;
    for (size_t i = 0; phantom_entry(i); i++) {
        for (size_t g = 0; g < GRIDS; g++) {
            check_volumes(phantom_entry(i)->info.name, &grids[g]);
        }
    }
}

/* Boxes whose faces run between voxel centres are counted exactly; of balls the error shrinks with the voxel. */
static void voxel_counts_are_the_known_ones(void **state)
{
    (void)state;
    struct phantom_drawing drawing;
    assert_ok(phantom_draw(&drawing, "slabs", NULL));
    assert_int_equal(count_label(&drawing, 1), 40 * 6 * 40);
    assert_int_equal(count_label(&drawing, 300), 40 * 6 * 40);
    phantom_drawing_finish(&drawing);
    assert_ok(phantom_draw(&drawing, "u-shape", NULL));
    assert_int_equal(count_label(&drawing, 1), 44 * 12 * 8 + 2 * 10 * 12 * 28);
    phantom_drawing_finish(&drawing);
    assert_ok(phantom_draw(&drawing, "sphere", NULL));
    assert_near((double)count_label(&drawing, 1), 4.0 / 3 * MATH3_PI * 8000, 4.0 / 3 * MATH3_PI * 8000 * 0.003);
    phantom_drawing_finish(&drawing);
}

/* The tubes of 1 to 6 voxels are all there, and none touches the next. */
static void tubes_grow_with_their_diameter(void **state)
{
    (void)state;
    struct phantom_drawing drawing;
    assert_ok(phantom_draw(&drawing, "tubes", NULL));
    uint64_t before = 0;
    for (uint32_t label = 1; label <= 6; label++) {
        uint64_t count = count_label(&drawing, label);
        assert_true(count > before);
        before = count;
    }
    for (size_t a = 0; a < 6; a++) {
        for (size_t b = a + 1; b < 6; b++) {
            const struct phantom_shape *s = drawing.shapes;
            assert_true(s[b].centre[0] - s[a].centre[0] > s[a].tube + s[b].tube + 1);
        }
    }
    phantom_drawing_finish(&drawing);
}

/* Every grid shows the same shapes: the label of a voxel is that of its centre, in world mm. */
static void every_voxel_follows_the_shapes(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        struct phantom_drawing drawing;
        assert_ok(phantom_draw(&drawing, "u-shape", &grids[g]));
        const size_t *dim = drawing.grid.dim;
        for (size_t v = 0; v < dim[0] * dim[1] * dim[2]; v++) {
            size_t row = v / dim[0];
            size_t slice = row / dim[1];
            double centre[3] = {(double)(v % dim[0]), (double)(row % dim[1]), (double)slice};
            uint32_t wanted = 0;
            mat4_point(centre, drawing.grid.world_from_voxel, centre);
            for (size_t s = 0; s < drawing.phantom->shape_count; s++) {
                wanted = phantom_shape_has(&drawing.shapes[s], centre) ? drawing.shapes[s].label : wanted;
            }
            assert_int_equal(drawing.labels[v], wanted);
        }
        phantom_drawing_finish(&drawing);
    }
}

static void grids_are_where_the_options_put_them(void **state)
{
    (void)state;
    for (size_t g = 0; g < GRIDS; g++) {
        struct phantom_drawing drawing;
        assert_ok(phantom_draw(&drawing, "sphere", &grids[g]));
        const conus_volume_info *grid = &drawing.grid;
        const double *wanted = grids[g].spacing[0] > 0 ? grids[g].spacing : (double[]){1, 1, 1};
        const bool *flip = grids[g].flip;
        double sign = flip[0] ^ flip[1] ^ flip[2] ? -1 : 1;
        double determinant = sign * wanted[0] * wanted[1] * wanted[2];
        assert_near(mat4_determinant3(grid->world_from_voxel), determinant, 1e-6 * fabs(determinant));
        double middle[3];
        for (int axis = 0; axis < 3; axis++) {
            assert_near(grid->spacing[axis], wanted[axis], 1e-6);
            middle[axis] = ((double)grid->dim[axis] - 1) / 2;
        }
        mat4_point(middle, grid->world_from_voxel, middle);
        assert_near(vec3_length(middle), 0, 1e-4);
        phantom_drawing_finish(&drawing);
    }
}

static void assert_orientation(double degrees, bool flip_i, bool flip_k, const char *wanted)
{
    struct phantom_drawing drawing;
    conus_phantom_options options = {.oblique = degrees, .flip = {flip_i, false, flip_k}};
    assert_ok(phantom_draw(&drawing, "torus", &options));
    assert_string_equal(drawing.grid.orientation, wanted);
    phantom_drawing_finish(&drawing);
}

/* A turn of 120 degrees about (1, 1, 1) takes x to y, y to z, z to x. */
static void orientations_are_named_right(void **state)
{
    (void)state;
    assert_orientation(0, false, false, "RAS");
    assert_orientation(20, true, false, "LAS");
    assert_orientation(-20, true, true, "LAI");
    assert_orientation(120, false, false, "ASR");
    assert_orientation(120, true, false, "PSR");
}

static void shapes_stay_in_every_turned_grid(void **state)
{
    (void)state;
    for (size_t i = 0; phantom_entry(i); i++) {
        struct phantom_drawing drawing;
        assert_ok(phantom_draw(&drawing, phantom_entry(i)->info.name, NULL));
        uint64_t seed = 7;
        for (int n = 0; n < 20000; n++) {
            double p[3];
            for (int axis = 0; axis < 3; axis++) {
                p[axis] = test_random(&seed, -40, 40);
            }
            for (size_t s = 0; s < drawing.phantom->shape_count && vec3_length(p) > PHANTOM_EDGE / 2; s++) {
                assert_false(phantom_shape_has(&drawing.shapes[s], p));
            }
        }
        phantom_drawing_finish(&drawing);
    }
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    static const conus_phantom_options bad[] = {
        {.size = 15},
        {.size = 513},
        {.spacing = {1, 1, 0}},
        {.spacing = {-1, 1, 1}},
        {.spacing = {NAN, 1, 1}},
        {.spacing = {INFINITY, 1, 1}},
        {.spacing = {1, 1, 17}},
        {.spacing = {1e-4, 1e-4, 1e-4}},
        {.oblique = NAN},
    };
    struct phantom_drawing drawing = {0};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_fails(phantom_draw(&drawing, "sphere", &bad[i]), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(phantom_draw(&drawing, "cube", NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "'cube', allowed are sphere, nested, slabs, torus, u-shape, tubes"));
    assert_fails(phantom_draw(&drawing, NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_null(drawing.labels);
}

static conus_status make_atlas(void *data)
{
    conus_atlas **out = data;
    struct phantom_drawing drawing;
    conus_atlas *atlas = NULL;
    conus_status status = phantom_draw(&drawing, "nested", &(conus_phantom_options){.size = 16});
    if (!status) {
        status = phantom_drawing_atlas(&atlas, &drawing);
        phantom_drawing_finish(&drawing);
    }
    if (out) {
        *out = atlas;
    } else {
        conus_atlas_destroy(atlas);
    }
    return status;
}

static void a_drawing_becomes_an_atlas(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(make_atlas(&atlas));
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    const conus_object *core = conus_atlas_object(atlas, 3);
    assert_string_equal(core->name, "Core");
    assert_string_equal(core->abbreviation, "Cor");
    assert_int_equal(core->label, 4000000001U);
    assert_true(core->voxels > 0);
    assert_int_equal(conus_atlas_note_count(atlas), 0);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_every_allocation(make_atlas, NULL);
}

TEST_GROUP(phantom)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(voxels_fill_the_analytic_volume),      cmocka_unit_test(voxel_counts_are_the_known_ones),
        cmocka_unit_test(tubes_grow_with_their_diameter),       cmocka_unit_test(every_voxel_follows_the_shapes),
        cmocka_unit_test(grids_are_where_the_options_put_them), cmocka_unit_test(orientations_are_named_right),
        cmocka_unit_test(shapes_stay_in_every_turned_grid),     cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(a_drawing_becomes_an_atlas),           cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
