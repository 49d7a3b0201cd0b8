/* SPDX-License-Identifier: BSD-3-Clause */
/* All layers of surfaces with answers in closed form (Eq. 10). */
#include "base/geometry/math3.h"
#include "conus/selection.h"
#include "mesh_scene.h"
#include "test.h"

#include <string.h>

#define CENTRE ((double[]){0, 0, 0})

static const conus_selector_options all_layers = {.resolution = 16, .layers = CONUS_LAYERS_ALL};

static conus_atlas *atlas_of(struct mesh mesh)
{
    conus_atlas *atlas = mesh_scene_atlas();
    mesh_scene_add(atlas, &mesh);
    return atlas;
}

static conus_selection *select_n(const conus_atlas *atlas, const struct cone *cone)
{
    conus_selector_options options = all_layers;
    options.resolution = cone->resolution;
    return mesh_scene_select(atlas, &options, cone);
}

/* The row of an object. */
static conus_result row_of(const conus_selection *selection, uint32_t object)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        if (conus_selection_result(selection, i)->object == object) {
            return *conus_selection_result(selection, i);
        }
    }
    fail_msg("object %u has no row", object);
    return (conus_result){0};
}

static conus_result measure(const conus_atlas *atlas, const conus_selector_options *options, const struct cone *cone)
{
    conus_selection *selection = mesh_scene_select(atlas, options, cone);
    conus_result row = row_of(selection, 1);
    conus_selection_destroy(selection);
    return row;
}

/* The only interval of a selection of one pixel, or number `index` of `count`. */
static conus_interval interval_of(const conus_selection *selection, size_t index, size_t count)
{
    size_t got;
    const conus_interval *intervals = conus_selection_intervals(&got, selection);
    assert_int_equal(got, count);
    return intervals[index];
}

/* Largest error of a chord against 2 sqrt(R^2 - d^2), over rays that pass within 0.9 R of the centre. */
static double chord_error(unsigned rings)
{
    conus_atlas *atlas = atlas_of(mesh_scene_sphere(CENTRE, 20, rings, 2 * rings));
    struct cone cone = mesh_scene_cone((double[]){70, 40, 30}, CENTRE, 24, 32);
    conus_selection *selection = select_n(atlas, &cone);
    double apex = sqrt(70 * 70 + 40 * 40 + 30 * 30), worst = 0;
    size_t count;
    const conus_interval *intervals = conus_selection_intervals(&count, selection);
    assert_true(count > 300);
    for (size_t s = 0; s < count; s++) {
        double ray[3], away[3];
        cone_ray(ray, &cone, intervals[s].pixel % 32, intervals[s].pixel / 32);
        vec3_cross(away, ray, cone.pose.world_from_device + 8);
        double d = apex * vec3_length(away);
        if (d < 18) {
            worst = fmax(worst, fabs(intervals[s].exit - intervals[s].entry - 2 * sqrt(400 - d * d)));
        }
    }
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
    return worst;
}

/* An inscribed sphere of edges h lies within h^2 / 4R of the true one. */
static void chords_converge_with_the_square_of_the_edges(void **state)
{
    (void)state;
    double coarse = chord_error(24), fine = chord_error(96);
    assert_true(coarse < 0.6 && fine < 0.04);
    assert_true(fine < coarse / 12);
}

static void volumes_are_the_mesh_s_whatever_the_rays(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 16, 64};
    for (int aperture = 0; aperture < 2; aperture++) {
        conus_atlas *atlas = atlas_of(mesh_scene_sphere((double[]){1, 2, 3}, 20, 60, 90));
        for (int i = 0; i < 3; i++) {
            struct cone cone = mesh_scene_cone((double[]){70, 50, 30}, CENTRE, 60, sizes[i]);
            conus_selector_options options = all_layers;
            options.resolution = sizes[i];
            options.aperture = aperture ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE;
            conus_result row = measure(atlas, &options, &cone);
            assert_near(row.volume, conus_atlas_object(atlas, 1)->volume_mm3, 0);
            assert_near(row.fraction, 1, 0);
            assert_near(row.cone_fraction, 1, 1e-12);
        }
        conus_atlas_destroy(atlas);
    }
}

static void an_inward_facing_mesh_is_the_same(void **state)
{
    (void)state;
    conus_result rows[2];
    for (int turned = 0; turned < 2; turned++) {
        struct mesh sphere = mesh_scene_sphere(CENTRE, 20, 30, 45);
        if (turned) {
            mesh_scene_turn(&sphere);
        }
        conus_atlas *atlas = atlas_of(sphere);
        struct cone cone = mesh_scene_cone((double[]){50, 40, 30}, CENTRE, 40, 16);
        rows[turned] = measure(atlas, &all_layers, &cone);
        conus_atlas_destroy(atlas);
    }
    assert_int_equal(rows[0].pierced, rows[1].pierced);
    assert_near(rows[0].entry, rows[1].entry, 0);
    assert_near(rows[0].exit, rows[1].exit, 0);
    assert_near(rows[0].path, rows[1].path, 1e-9);
    assert_near(rows[0].volume, rows[1].volume, 1e-6);
}

/* A cylinder of radius a through the centre of a ball: 4/3 pi (R^3 - (R^2 - a^2)^(3/2)). */
static void a_cylinder_through_a_sphere(void **state)
{
    (void)state;
    const double a = 12, volume = 4.0 / 3 * MATH3_PI * (8000 - pow(400 - a * a, 1.5));
    conus_atlas *atlas = atlas_of(mesh_scene_sphere(CENTRE, 20, 128, 192));
    struct cone cone = mesh_scene_cone((double[]){70, 50, 30}, CENTRE, 1, 128);
    conus_selector_options options = all_layers;
    options.radius = a;
    options.resolution = 128;
    conus_result row = measure(atlas, &options, &cone);
    assert_int_equal(row.pierced, row.pixels);
    assert_near(row.volume, volume, 1e-3 * volume);
    assert_near(row.path, volume / (MATH3_PI * a * a), 1e-3 * row.path);
    assert_near(row.fraction, volume / (4.0 / 3 * MATH3_PI * 8000), 2e-3);
    conus_atlas_destroy(atlas);
}

/* Between two planes at z0 and z1 from its centre a ball has pi (R^2 (z1 - z0) - (z1^3 - z0^3) / 3). */
static void a_range_cuts_a_sphere_to_a_slab(void **state)
{
    (void)state;
    static const double slabs[][2] = {{5, 12}, {-25, -10}, {-30, 30}, {15, 40}};
    for (size_t i = 0; i < 4; i++) {
        for (int wide = 0; wide < 2; wide++) {
            double low = fmax(slabs[i][0], -20), high = fmin(slabs[i][1], 20);
            double volume = MATH3_PI * (400 * (high - low) - (pow(high, 3) - pow(low, 3)) / 3);
            conus_atlas *atlas = atlas_of(mesh_scene_sphere(CENTRE, 20, 128, 192));
            struct cone cone = mesh_scene_cone((double[]){0.3, 0.2, 60}, (double[]){0.3, 0.2, 0}, 60, 128);
            conus_selector_options options = all_layers;
            options.resolution = 128;
            options.radius = wide ? 0 : 22;
            options.range[0] = 60 + slabs[i][0];
            options.range[1] = 60 + slabs[i][1];
            conus_result row = measure(atlas, &options, &cone);
            assert_near(row.volume, volume, 4e-3 * volume);
            assert_true(row.entry >= options.range[0]);
            assert_int_equal(row.pierced, row.pixels);
            conus_atlas_destroy(atlas);
        }
    }
}

static struct cone along_x(void)
{
    return mesh_scene_cone((double[]){-100, 0.3, 0.2}, (double[]){0, 0.3, 0.2}, 0.01, 1);
}

/* Through both tubes of a torus: chords 2 sqrt(tube^2 - z^2) long, ring apart. */
static void a_ray_through_both_tubes_of_a_torus(void **state)
{
    (void)state;
    conus_atlas *atlas = atlas_of(mesh_scene_torus(30, 8, 400, 300));
    struct cone cone = along_x();
    conus_selection *selection = select_n(atlas, &cone);
    double half = sqrt(64 - 0.04);
    double outer = sqrt((30 + half) * (30 + half) - 0.09), inner = sqrt((30 - half) * (30 - half) - 0.09);
    conus_interval near = interval_of(selection, 0, 2), far = interval_of(selection, 1, 2);
    assert_near(near.entry, 100 - outer, 3e-3);
    assert_near(near.exit, 100 - inner, 3e-3);
    assert_near(far.entry, 100 + inner, 3e-3);
    assert_near(far.exit, 100 + outer, 3e-3);
    assert_near(row_of(selection, 1).path, 2 * (outer - inner), 6e-3);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

/* 2 pi^2 ring tube^2, from all sides. */
static void the_volume_of_a_torus(void **state)
{
    (void)state;
    const double volume = 2 * MATH3_PI * MATH3_PI * 30 * 64;
    static const double origins[][3] = {{90, 20, 30}, {5, 8, 110}, {-70, 60, -50}, {0, 0, 0}};
    conus_atlas *atlas = atlas_of(mesh_scene_torus(30, 8, 200, 120));
    for (int i = 0; i < 4; i++) {
        struct cone cone = mesh_scene_cone(origins[i], i == 3 ? (double[]){90, 0, 0} : CENTRE, i == 3 ? 100 : 60, 160);
        conus_selector_options options = all_layers;
        options.resolution = 160;
        options.aperture = i == 3 ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE;
        conus_result row = measure(atlas, &options, &cone);
        double part = i == 3 ? 100.0 / 360 : 1; /* seen from the middle: a wedge between the sides of the square */
        assert_near(row.volume, part * volume, 2e-3 * volume);
        assert_near(row.fraction, part, 2e-3);
    }
    conus_atlas_destroy(atlas);
}

static void nested_objects_have_an_interval_each(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 4; i++) {
        struct mesh sphere = mesh_scene_sphere(CENTRE, 10 * (i + 1), 40, 60);
        mesh_scene_add(atlas, &sphere);
    }
    struct cone cone = along_x();
    conus_selection *selection = select_n(atlas, &cone);
    for (uint32_t k = 0; k < 4; k++) {
        conus_interval interval = interval_of(selection, k, 4);
        assert_int_equal(interval.object, 4 - k);
        assert_near(interval.entry, 100 - 10.0 * (4 - k), 0.15);
        assert_near(interval.exit, 100 + 10.0 * (4 - k), 0.15);
        assert_int_equal(row_of(selection, 4 - k).pixels, k == 0);
        assert_int_equal(row_of(selection, 4 - k).pierced, 1);
    }
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

/* Two shells in one mesh: one around the other, one with the other as a cavity, two that overlap. */
static void shells_of_one_mesh_are_one_body(void **state)
{
    (void)state;
    static const double apart[] = {0, 0, 25};
    static const double path[] = {60, 60 - 40, 75};
    static const size_t counts[] = {1, 2, 1};
    for (int i = 0; i < 3; i++) {
        struct mesh a = mesh_scene_sphere(CENTRE, 30, 60, 90);
        struct mesh b = mesh_scene_sphere((double[]){apart[i], 0, 0}, 20, 60, 90);
        if (i == 1) {
            mesh_scene_turn(&b);
        }
        conus_atlas *atlas = atlas_of(mesh_scene_join(&a, &b));
        struct cone cone = along_x();
        conus_selection *selection = select_n(atlas, &cone);
        interval_of(selection, 0, counts[i]);
        assert_near(row_of(selection, 1).path, path[i], 0.2);
        assert_near(row_of(selection, 1).entry, 70, 0.1);
        conus_selection_destroy(selection);
        conus_atlas_destroy(atlas);
    }
}

/* Two boxes with a face in common, and one across both: the ray leaves one where it enters the next. */
static void neighbours_share_a_face(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    static const double ends[][2] = {{-10, 0}, {0, 10}, {-5, 5}};
    for (int i = 0; i < 3; i++) {
        struct mesh box = mesh_scene_box((double[]){ends[i][0], -5, -5}, (double[]){ends[i][1], 5, 5});
        mesh_scene_add(atlas, &box);
    }
    struct cone cone = along_x();
    conus_selection *selection = select_n(atlas, &cone);
    for (uint32_t k = 0; k < 3; k++) {
        static const uint32_t order[] = {1, 3, 2};
        conus_interval interval = interval_of(selection, k, 3);
        assert_int_equal(interval.object, order[k]);
        assert_near(interval.entry, 100 + ends[order[k] - 1][0], 1e-9);
        assert_near(interval.exit, 100 + ends[order[k] - 1][1], 1e-9);
    }
    assert_true(interval_of(selection, 0, 3).exit == interval_of(selection, 2, 3).entry);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

/* A box seen along its axes: edges and corners lie exactly on rays. */
static void rays_at_edges_and_corners_count_once(void **state)
{
    (void)state;
    conus_atlas *atlas = atlas_of(mesh_scene_box((double[]){-8, -8, -8}, (double[]){8, 8, 8}));
    static const double origins[][3] = {{50, 0, 0}, {50, 50, 50}, {50, 50, 0}, {0, 0, 0}, {4, 4, 4}};
    static const double lengths[] = {16, 16 * 1.7320508075688772, 16 * 1.4142135623730951, 8, 12 * 1.7320508075688772};
    for (size_t i = 0; i < sizeof origins / sizeof origins[0]; i++) {
        bool inside = origins[i][0] < 8;
        double target[3] = {i == 3 ? -20 : 0, 0, 0};
        struct cone cone = mesh_scene_cone(origins[i], target, 1e-6, 1);
        conus_selection *selection = select_n(atlas, &cone);
        conus_interval interval = interval_of(selection, 0, 1);
        assert_near(interval.exit - interval.entry, lengths[i], 1e-5);
        assert_int_equal(interval.entry == 0, inside);
        conus_selection_destroy(selection);
    }
    conus_atlas_destroy(atlas);
}

static void an_apex_inside_nested_objects(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 3; i++) {
        struct mesh sphere = mesh_scene_sphere(CENTRE, 10 * (i + 1), 40, 60);
        mesh_scene_add(atlas, &sphere);
    }
    struct cone cone = mesh_scene_cone((double[]){1, 2, 3}, (double[]){40, 20, 30}, 179, 24);
    conus_selection *selection = select_n(atlas, &cone);
    for (uint32_t object = 1; object <= 3; object++) {
        conus_result row = row_of(selection, object);
        assert_int_equal(row.pierced, 448);
        assert_near(row.entry, 0, 0);
        assert_int_equal(row.pixels, object == 1 ? row.pierced : 0);
    }
    assert_true(row_of(selection, 1).distance > 5); /* Eq. 9: its inner face */
    conus_selection_destroy(selection);

    conus_selector_options options = all_layers; /* with a range it is a solid, hit where the range begins */
    options.range[0] = 2;
    options.range[1] = 100;
    cone = mesh_scene_cone((double[]){1, 2, 3}, (double[]){40, 20, 30}, 20, 16);
    conus_result row = measure(atlas, &options, &cone);
    assert_near(row.distance, 2 * cone_per_depth(&cone, 8, 8), 1e-9);
    assert_int_equal(row.pixels, 208);
    conus_atlas_destroy(atlas);
}

/* The upper half of a sphere: from below and above a ray crosses it once, without an exit; from the side twice. */
static void an_open_hemisphere(void **state)
{
    (void)state;
    struct mesh sphere = mesh_scene_sphere(CENTRE, 20, 40, 60);
    size_t dropped = sphere.triangle_count / 2;
    memmove(sphere.triangles, sphere.triangles + 3 * dropped, 3 * dropped * sizeof *sphere.triangles);
    sphere.triangle_count -= dropped;
    conus_atlas *atlas = atlas_of(sphere);
    for (int above = 0; above < 2; above++) {
        double z = above ? 80 : -80;
        struct cone cone = mesh_scene_cone((double[]){0.1, 0.2, z}, (double[]){0.1, 0.2, 0}, 10, 16);
        conus_result row = measure(atlas, &all_layers, &cone);
        assert_int_equal(row.pierced, 208);
        assert_int_equal(row.pixels, 208);
        assert_near(row.path, 0, 0);
        assert_near(row.entry, above ? 60 : 98, 2);
        assert_true(isnan(row.volume) && isnan(row.fraction));
    }
    struct cone side = mesh_scene_cone((double[]){-80, 0.3, 8}, (double[]){0, 0.3, 8}, 1, 8);
    conus_result row = measure(atlas, &all_layers, &side);
    assert_near(row.path, 2 * sqrt(400 - 64), 0.3);
    assert_true(isnan(row.fraction));
    struct cone inside = mesh_scene_cone((double[]){0, 0.3, 8}, (double[]){40, 0.3, 8}, 1, 8);
    row = measure(atlas, &all_layers, &inside);
    assert_near(row.path, 0, 0);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(mesh_layers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chords_converge_with_the_square_of_the_edges),
        cmocka_unit_test(volumes_are_the_mesh_s_whatever_the_rays),
        cmocka_unit_test(an_inward_facing_mesh_is_the_same),
        cmocka_unit_test(a_cylinder_through_a_sphere),
        cmocka_unit_test(a_range_cuts_a_sphere_to_a_slab),
        cmocka_unit_test(a_ray_through_both_tubes_of_a_torus),
        cmocka_unit_test(the_volume_of_a_torus),
        cmocka_unit_test(nested_objects_have_an_interval_each),
        cmocka_unit_test(shells_of_one_mesh_are_one_body),
        cmocka_unit_test(neighbours_share_a_face),
        cmocka_unit_test(rays_at_edges_and_corners_count_once),
        cmocka_unit_test(an_apex_inside_nested_objects),
        cmocka_unit_test(an_open_hemisphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
