/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 13: the angle that admits an object, against a search of every voxel, against dense points of every triangle,
 * against the census of cones a little narrower and a little wider, and in closed form. And Eq. 14 for bundles. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "scene.h"
#include "tables.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A row, in radians. */
struct admission {
    uint32_t object;
    double angle, margin, distance, point[3];
};

static struct admission row_at(const conus_table *sweep, size_t row)
{
    struct admission out = {.object = conus_table_objects(sweep)[row],
                            .angle = radians_from_degrees(table_number_at(sweep, "angle_deg", row)),
                            .margin = radians_from_degrees(table_number_at(sweep, "margin_deg", row)),
                            .distance = table_number_at(sweep, "distance_mm", row)};
    table_point_at(out.point, sweep, "", row);
    return out;
}

static bool has(const conus_table *sweep, uint32_t object)
{
    return table_row_of(sweep, object) < conus_table_rows(sweep);
}

static struct admission find(const conus_table *sweep, uint32_t object)
{
    return row_at(sweep, table_row_of(sweep, object));
}

static conus_table *sweep_of(const conus_atlas *atlas, const conus_selector_options *options, const conus_pose *pose,
                             double degrees)
{
    conus_selector *selector = NULL;
    conus_table *sweep = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_sweep(&sweep, selector, pose, degrees));
    conus_selector_destroy(selector);
    return sweep;
}

/* Full opening angle of the narrowest cone that holds the point, between two depths. */
static double opening(const conus_pose *pose, const double point[3], const double range[2])
{
    const double *m = pose->world_from_device;
    double v[3];
    double cross[3];
    vec3_sub(v, point, m + 12);
    double depth = -vec3_dot(v, m + 8);
    vec3_cross(cross, v, m + 8);
    if (vec3_length(v) == 0 && range[0] <= 0) {
        return 0;
    }
    bool is_out = range[1] > 0 && (depth < range[0] || depth > range[1]);
    return is_out || (depth <= 0 && vec3_length(v) > 0) ? INFINITY : 2 * atan2(vec3_length(cross), depth);
}

/* The least opening angle of each object, found by trying all its voxels. */
static void search_voxels(double *openings, const conus_atlas *atlas, const conus_pose *pose, const double range[2])
{
    for (size_t i = 0; i <= atlas->object_count; i++) {
        openings[i] = INFINITY;
    }
    for (size_t v = 0; v < atlas->volume_count; v++) {
        const struct volume *volume = &atlas->volumes[v];
        const size_t *dim = volume->info.dim;
        for (size_t voxel = 0; voxel < volume->voxel_count; voxel++) {
            const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
            double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
            uint32_t object = volume_object(volume, voxel);
            mat4_point(p, volume->info.world_from_voxel, p);
            openings[object] = fmin(openings[object], opening(pose, p, range));
        }
    }
}

/* Rows are sorted, and each has its margin. */
static void check_order(const conus_table *sweep)
{
    for (size_t i = 0; i + 1 < conus_table_rows(sweep); i++) {
        struct admission row = row_at(sweep, i);
        struct admission next = row_at(sweep, i + 1);
        assert_true(row.angle <= next.angle);
        assert_near(row.margin, next.angle - row.angle, 1e-15);
        assert_int_equal(table_count_at(sweep, "rank", i), i + 1);
        assert_near(2 * table_number_at(sweep, "half_angle_deg", i), table_number_at(sweep, "angle_deg", i), 1e-12);
    }
}

static void check_volumes(uint64_t *state, const conus_atlas *atlas)
{
    conus_pose pose = scene_pose(state, atlas);
    double far = test_random(state, 1, 100);
    const conus_selector_options options = {.range = {0, test_random(state, 0, 1) < 0.5 ? 0 : far}};
    double *openings = malloc((atlas->object_count + 1) * sizeof *openings);
    double widest = test_random(state, 0, 1) < 0.5 ? 179.9 : test_random(state, 1, 100);
    conus_table *sweep = sweep_of(atlas, &options, &pose, widest);
    search_voxels(openings, atlas, &pose, options.range);
    check_order(sweep);
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        if (fabs(openings[number] - radians_from_degrees(widest)) < 1e-7) {
            continue; /* on the edge of the widest */
        }
        assert_int_equal(has(sweep, number), openings[number] < radians_from_degrees(widest));
        if (has(sweep, number)) {
            struct admission row = find(sweep, number);
            assert_near(row.angle, openings[number], 1e-7); /* near the axis, of a pose 10^5 mm away */
            assert_near(opening(&pose, row.point, options.range), row.angle, 1e-7);
            assert_string_equal(table_text_at(sweep, "kind", table_row_of(sweep, number)),
                                atlas_kind_word(conus_atlas_object(atlas, number)->kind));
        }
    }
    free(openings);
    conus_table_destroy(sweep);
}

static void voxels_are_admitted_by_their_centres(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (int i = 0; i < 300; i++) {
        conus_atlas *atlas = scene_atlas(&seed, 14, i % 3);
        check_volumes(&seed, atlas);
        conus_atlas_destroy(atlas);
    }
}

/* Voxels of the object in a cone of this angle, by Eq. 10. */
static uint64_t voxels_in(conus_selector *selector, const conus_pose *pose, double angle, uint32_t object)
{
    conus_selection *selection = NULL;
    uint64_t voxels = 0;
    assert_ok(conus_select(&selection, selector, pose, degrees_from_radians(angle)));
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        voxels = result->object == object ? result->voxels : voxels;
    }
    conus_selection_destroy(selection);
    return voxels;
}

static void a_little_less_is_too_narrow(void **state)
{
    (void)state;
    uint64_t seed = 7;
    size_t checked = 0;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .resolution = 1};
    for (int i = 0; i < 40; i++) {
        conus_atlas *atlas = scene_atlas(&seed, 14, 1);
        conus_pose pose = scene_generic_pose(&seed, atlas);
        conus_selector *selector = NULL;
        conus_table *sweep = sweep_of(atlas, &options, &pose, 170);
        assert_ok(conus_selector_create(&selector, atlas, &options));
        for (size_t r = 0; r < conus_table_rows(sweep); r++) {
            struct admission row = row_at(sweep, r);
            if (row.angle > 1e-6) {
                assert_true(voxels_in(selector, &pose, row.angle * (1 + 1e-9), row.object) > 0);
                assert_int_equal(voxels_in(selector, &pose, row.angle * (1 - 1e-9), row.object), 0);
                checked++;
            }
        }
        conus_selector_destroy(selector);
        conus_table_destroy(sweep);
        conus_atlas_destroy(atlas);
    }
    assert_true(checked > 100);
}

static conus_pose pose_of(const double origin[3], const double direction[3])
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, origin, direction, NULL));
    return pose;
}

/* The least opening over points of a triangle, `steps` along each edge. */
static double search_triangle(const float *const p[3], const conus_pose *pose, const double range[2], int steps)
{
    double least = INFINITY;
    for (int i = 0; i <= steps; i++) {
        for (int j = 0; i + j <= steps; j++) {
            double point[3];
            for (int a = 0; a < 3; a++) {
                point[a] = (p[0][a] * (double)(steps - i - j) + p[1][a] * (double)i + p[2][a] * (double)j) / steps;
            }
            least = fmin(least, opening(pose, point, range));
        }
    }
    return least;
}

static double search_mesh(const struct mesh *mesh, const conus_pose *pose, const double range[2], int steps)
{
    double least = INFINITY;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const float *p[3];
        for (size_t c = 0; c < 3; c++) {
            p[c] = &mesh->positions[3 * (size_t)mesh->triangles[3 * t + c]];
        }
        least = fmin(least, search_triangle(p, pose, range, steps));
    }
    return least;
}

static void surfaces_are_admitted_by_their_nearest_point(void **state)
{
    (void)state;
    enum { STEPS = 60 };
    uint64_t seed = 3;
    size_t found = 0;
    for (int i = 0; i < 200; i++) {
        conus_atlas *atlas = mesh_scene_atlas();
        struct mesh mesh = mesh_scene_soup(&seed, 3, 40, 10);
        mesh_scene_add(atlas, &mesh);
        const double origin[3] = {test_random(&seed, -80, 80), test_random(&seed, -80, 80), test_random(&seed, 20, 80)};
        const double direction[3] = {-origin[0] + test_random(&seed, -40, 40), -origin[1], -origin[2]};
        conus_pose pose = pose_of(origin, direction);
        const conus_selector_options options = {.range = {i % 2 ? 70 : 0, i % 2 ? 100 : 0}};
        conus_table *sweep = sweep_of(atlas, &options, &pose, 179.9);
        double wanted = search_mesh(&atlas->meshes[0], &pose, options.range, STEPS);
        if (isfinite(wanted)) {
            struct admission row = find(sweep, 1);
            assert_true(row.angle <= wanted + 1e-12);
            assert_true(wanted - row.angle < 2 * 40.0 / STEPS / row.distance + 0.02 * (i % 2)); /* of the points */
            assert_near(opening(&pose, row.point, (double[]){0, 0}), row.angle, 1e-9);
            found++;
        }
        conus_table_destroy(sweep);
        conus_atlas_destroy(atlas);
    }
    assert_true(found > 150);
}

/* A ball of many facets at `away` along x, whose tangent cone is known. */
static void a_ball_is_admitted_at_its_tangent(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh mesh = mesh_scene_sphere((double[]){0, 0, 0}, 20, 400, 800);
    mesh_scene_add(atlas, &mesh);
    conus_selector *selector = NULL;
    conus_table *sweep = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (int beside = 21; beside < 60; beside += 7) {
        conus_pose pose = pose_of((double[]){-100, beside, 0}, (double[]){1, 0, 0});
        double wanted = 2 * (atan2(beside, 100) - asin(20 / hypot(beside, 100)));
        assert_ok(conus_sweep(&sweep, selector, &pose, 170));
        assert_near(find(sweep, 1).angle, wanted, 1e-4);
        conus_table_destroy(sweep);
    }
    conus_pose through = pose_of((double[]){-100, 19, 0}, (double[]){1, 0, 0});
    conus_pose inside = pose_of((double[]){3, 4, 5}, (double[]){0, 0.6, 0.8});
    assert_ok(conus_sweep(&sweep, selector, &through, 1));
    assert_true(find(sweep, 1).angle == 0);
    assert_near(find(sweep, 1).distance, 100 - sqrt(400 - 19 * 19), 1); /* where the axis enters or leaves it */
    conus_table_destroy(sweep);
    assert_ok(conus_sweep(&sweep, selector, &inside, 1));
    assert_true(find(sweep, 1).angle == 0);
    assert_true(find(sweep, 1).distance == 0); /* the apex is in it */
    conus_table_destroy(sweep);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Between two depths the axis meets nothing of the ball's surface, but it is inside. */
static void what_is_inside_a_closed_surface_belongs_to_it(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh mesh = mesh_scene_sphere((double[]){0, 0, 0}, 20, 40, 80);
    mesh_scene_add(atlas, &mesh);
    conus_pose pose = pose_of((double[]){-100, 1, 2}, (double[]){1, 0, 0});
    const conus_selector_options in_it = {.range = {95, 105}};
    const conus_selector_options beside_it = {.range = {60, 78}};
    conus_table *sweep = sweep_of(atlas, &in_it, &pose, 1);
    assert_true(find(sweep, 1).angle == 0);
    assert_near(find(sweep, 1).distance, 95, 1e-9);
    conus_table_destroy(sweep);
    sweep = sweep_of(atlas, &beside_it, &pose, 170);
    assert_int_equal(conus_table_rows(sweep), 0);
    conus_table_destroy(sweep);
    conus_atlas_destroy(atlas);
}

/* Two shells, one in the other: both the space between them and the inner one are inside, unless the inner one faces
 * inwards. */
static void shells_in_shells_count_as_intervals_do(void **state)
{
    (void)state;
    const conus_selector_options middle = {.range = {98, 102}};
    conus_pose pose = pose_of((double[]){-100, 0.3, 0.2}, (double[]){1, 0, 0});
    for (int cavity = 0; cavity < 2; cavity++) {
        conus_atlas *atlas = mesh_scene_atlas();
        struct mesh outer = mesh_scene_sphere((double[]){0, 0, 0}, 20, 20, 40);
        struct mesh inner = mesh_scene_sphere((double[]){0, 0, 0}, 10, 20, 40);
        struct mesh both;
        assert_ok(mesh_init(&both, 2 * outer.vertex_count, 2 * outer.triangle_count));
        memcpy(both.positions, outer.positions, 3 * outer.vertex_count * sizeof(float));
        memcpy(both.positions + 3 * outer.vertex_count, inner.positions, 3 * inner.vertex_count * sizeof(float));
        memcpy(both.triangles, outer.triangles, 3 * outer.triangle_count * sizeof(uint32_t));
        for (size_t i = 0; i < 3 * inner.triangle_count; i++) {
            size_t to = cavity ? i / 3 * 3 + 2 - i % 3 : i;
            both.triangles[3 * outer.triangle_count + to] = inner.triangles[i] + (uint32_t)outer.vertex_count;
        }
        mesh_finish(&outer);
        mesh_finish(&inner);
        mesh_scene_add(atlas, &both);
        conus_table *sweep = sweep_of(atlas, &middle, &pose, 1);
        assert_int_equal(conus_table_rows(sweep), !cavity);
        conus_table_destroy(sweep);
        conus_atlas_destroy(atlas);
    }
}

/* A box around the apex with one side missing: the axis meets the far side at 5, and does not count as inside
 * before. */
static void an_open_surface_does_not_hold_the_axis(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((const double[]){-5, -5, -5}, (const double[]){5, 5, 5});
    for (int k = 0; k < 6; k++) { /* mesh_scene_box()'s last but two are the side at x = -5 */
        box.triangles[24 + k] = box.triangles[30 + k];
    }
    box.triangle_count -= 2;
    mesh_scene_add(atlas, &box);
    assert_false(atlas_object_mesh(atlas, 1)->shape.closed);
    conus_pose pose = pose_of((double[]){0.5, 0.25, 0}, (double[]){0, 0, 1});
    conus_table *sweep = sweep_of(atlas, NULL, &pose, 10);
    assert_true(find(sweep, 1).angle == 0);
    assert_near(find(sweep, 1).distance, 5, 1e-12);
    conus_table_destroy(sweep);
    conus_atlas_destroy(atlas);
}

/* Voxel centres at x = -5, 0 and 5 and z = -20 and -10, seen from the origin along -z: 1 and 2 on the axis, 3 and 4
 * both at atan(5 / 10) to its sides. Of equal angles the nearer comes first, then the lower number. The widest allowed
 * cone still admits an object that it just holds. */
static void ties_go_to_the_nearer_then_to_the_lower_number(void **state)
{
    (void)state;
    const double m[16] = {5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 10, 0, -5, 0, -20, 1};
    const conus_volume_info grid = scene_plain_grid((size_t[]){3, 1, 2}, m);
    uint32_t labels[6] = {0, 1, 0, 3, 2, 4};
    static const uint32_t order[4] = {2, 1, 3, 4};
    const double both = 2 * atan(0.5);
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    conus_selector *selector = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 0}, (double[]){0, 0, -1}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (int narrower = 0; narrower < 2; narrower++) {
        conus_table *sweep = NULL;
        assert_ok(conus_sweep(&sweep, selector, &pose, degrees_from_radians(narrower ? nextafter(both, 0) : both)));
        assert_int_equal(conus_table_rows(sweep), narrower ? 2 : 4);
        for (size_t i = 0; i < conus_table_rows(sweep); i++) {
            assert_int_equal(conus_table_objects(sweep)[i], order[i]);
            assert_true(table_number_at(sweep, "angle_deg", i) == (i < 2 ? 0 : degrees_from_radians(both)));
        }
        conus_table_destroy(sweep);
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* The hidden one of two bundles is admitted by no angle. */
static void a_hidden_bundle_is_not_admitted(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 0}, (double[]){0, 0, 1}, NULL));
    for (int hidden = 0; hidden < 2; hidden++) {
        assert_ok(conus_atlas_set_hidden(atlas, (const bool[]){false, hidden, false}));
        conus_table *sweep = sweep_of(atlas, NULL, &pose, 170);
        assert_int_equal(has(sweep, 1), !hidden);
        assert_true(has(sweep, 2));
        conus_table_destroy(sweep);
    }
    conus_atlas_destroy(atlas);
}

static void limits_are_named(void **state)
{
    (void)state;
    uint64_t seed = 2;
    conus_atlas *atlas = scene_atlas(&seed, 10, 0);
    conus_pose pose = scene_pose(&seed, atlas);
    const conus_selector_options wrong[] = {{.aperture = CONUS_APERTURE_SQUARE}, {.radius = 5}};
    conus_selector *selector = NULL;
    conus_table *sweep = NULL;
    for (int i = 0; i < 2; i++) {
        assert_ok(conus_selector_create(&selector, atlas, &wrong[i]));
        assert_fails(conus_sweep(&sweep, selector, &pose, degrees_from_radians(1)), CONUS_ERROR_ARGUMENT);
        conus_selector_destroy(selector);
    }
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (int i = 0; i < 4; i++) {
        static const double angles[] = {0, -1, MATH3_PI, NAN};
        assert_fails(conus_sweep(&sweep, selector, &pose, degrees_from_radians(angles[i])), CONUS_ERROR_ARGUMENT);
    }
    pose.world_from_device[3] = 1;
    assert_fails(conus_sweep(&sweep, selector, &pose, degrees_from_radians(1)), CONUS_ERROR_ARGUMENT);
    assert_null(sweep);
    assert_int_equal(conus_table_rows(NULL), 0);
    conus_table_destroy(NULL);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* The probability of a normal number below x. */
static double below(double x)
{
    return 0.5 * erfc(-x / sqrt(2));
}

/* A straight streamline at the distance y from the axis of a cylinder of radius R is in it with the probability of a
 * normal shift between -R - y and R - y. The tube that rays hit is 2 mm thicker, and the cylinder's rays reach 31/32 of
 * its radius. */
static void a_bundle_is_in_the_cone_with_a_line_of_it(void **state)
{
    (void)state;
    static const float points[] = {-500, 3, 0, 500, 3, 0};
    static const uint64_t first[] = {0, 2};
    const double radius = 1.5;
    const double shift = 2;
    const double tube = 2;
    const conus_polylines lines = {
        .points = points, .type = CONUS_SCALAR_FLOAT32, .point_count = 2, .first = first, .streamline_count = 1};
    const conus_selector_options options = {.resolution = 16, .radius = radius, .layers = CONUS_LAYERS_ALL};
    conus_atlas *atlas = mesh_scene_atlas();
    assert_ok(conus_atlas_add_polylines(atlas, &lines, &(conus_streamlines_options){.radius = tube}));
    conus_selector *selector = NULL;
    conus_table *jitter = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 50}, (double[]){0, 0, -1}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_jitter(&jitter, selector, &pose, 0, &(conus_jitter_options){.shift = shift, .samples = 4096}));
    conus_selector_destroy(selector);
    size_t row = table_row_of(jitter, 1);
    double in_cone = table_number_at(jitter, "p_in_cone", row);
    double is_seen = table_number_at(jitter, "p_seen", row);
    double in = below((radius - 3) / shift) - below((-radius - 3) / shift);
    double reach = radius * 15 / 16 + tube;
    double seen = below((reach - 3) / shift) - below((-reach - 3) / shift);
    assert_near(in_cone, in, 2e-3);
    assert_near(is_seen, seen, 5e-3);
    assert_true(is_seen > in_cone + 0.3);
    conus_table_destroy(jitter);
    conus_atlas_destroy(atlas);
}

static conus_status make_sweep(void *data)
{
    conus_selector *selector = NULL;
    conus_table *sweep = NULL;
    conus_pose pose;
    conus_status status = conus_pose_along(&pose, (double[]){0, 0, 50}, (double[]){0, 0, -1}, NULL);
    status = status ? status : conus_selector_create(&selector, data, NULL);
    status = status ? status : conus_sweep(&sweep, selector, &pose, 170);
    assert_true(!status == (sweep != NULL));
    conus_table_destroy(sweep);
    conus_selector_destroy(selector);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    uint64_t seed = 5;
    conus_atlas *atlas = scene_atlas(&seed, 6, 0);
    struct mesh box = mesh_scene_box((const double[]){-5, -5, -5}, (const double[]){5, 5, 5});
    mesh_scene_add(atlas, &box);
    test_every_allocation(make_sweep, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(sweep)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(voxels_are_admitted_by_their_centres),
        cmocka_unit_test(a_bundle_is_in_the_cone_with_a_line_of_it),
        cmocka_unit_test(a_little_less_is_too_narrow),
        cmocka_unit_test(surfaces_are_admitted_by_their_nearest_point),
        cmocka_unit_test(a_ball_is_admitted_at_its_tangent),
        cmocka_unit_test(what_is_inside_a_closed_surface_belongs_to_it),
        cmocka_unit_test(shells_in_shells_count_as_intervals_do),
        cmocka_unit_test(an_open_surface_does_not_hold_the_axis),
        cmocka_unit_test(ties_go_to_the_nearer_then_to_the_lower_number),
        cmocka_unit_test(a_hidden_bundle_is_not_admitted),
        cmocka_unit_test(limits_are_named),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
