/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes of closed surfaces in a region (Eq. 10) against closed forms, and against sums that they must give. */
#include "base/geometry/math3.h"
#include "mesh_scene.h"
#include "selection/measure/measure.h"
#include "selection/selection.h"
#include "test.h"

/* A device at the origin that looks along +z, and its frame. */
static struct region make_region(double degrees, double radius, bool square)
{
    struct cone cone = {.angle = radians_from_degrees(degrees),
                        .radius = radius,
                        .aperture = square ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE};
    struct region region;
    assert_ok(conus_pose_along(&cone.pose, (double[]){0, 0, 0}, (double[]){0, 0, 1}, NULL));
    region_from_cone(&region, &cone);
    return region;
}

/* Volume of a mesh, which is taken over, in a region. */
static double volume_in(struct mesh *mesh, const struct region *region)
{
    struct solids solids = {0};
    struct region_solid cut;
    assert_ok(mesh_check(mesh, NULL));
    assert_ok(mesh_measure(&mesh->shape, mesh));
    assert_true(mesh->shape.has_volume);
    assert_ok(solids_add(&solids, 1, mesh));
    region_solid_init(&cut, region);
    double volume = solid_volume(&solids.solids[0], &cut);
    solids_finish(&solids);
    mesh_finish(mesh);
    return volume;
}

static conus_status attempt_solids(void *data)
{
    struct solids solids = {0};
    conus_status status = solids_add(&solids, 1, data);
    solids_finish(&solids);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    struct mesh mesh = mesh_scene_sphere((double[]){0, 0, 0}, 10, 12, 12);
    test_every_allocation(attempt_solids, &mesh);
    mesh_finish(&mesh);
}

static double box_in(const double low[3], const double high[3], const struct region *region)
{
    struct mesh mesh = mesh_scene_box(low, high);
    return volume_in(&mesh, region);
}

static const double cube[2][3] = {{-5, -5, -5}, {5, 5, 5}};

/* Pyramid of 90 degrees from a cube's middle: a sixth. Cone: pi h^3 / 3, since its circle touches the face's edges. */
static void a_cone_in_a_cube(void **state)
{
    (void)state;
    struct region region = make_region(90, 0, true);
    assert_near(box_in(cube[0], cube[1], &region), 1000.0 / 6, 1e-9);
    region = make_region(90, 0, false);
    assert_near(box_in(cube[0], cube[1], &region), MATH3_PI * 125 / 3, 1e-9);
    region.near = 2; /* a frustum: the cube's faces do not matter */
    region.far = 4.5;
    assert_near(box_in(cube[0], cube[1], &region), MATH3_PI * (pow(4.5, 3) - 8) / 3, 1e-9);
    region.square = true;
    assert_near(box_in(cube[0], cube[1], &region), 4 * (pow(4.5, 3) - 8) / 3, 1e-9);
    region.far = 7; /* beyond the cube */
    assert_near(box_in(cube[0], cube[1], &region), 4 * (125.0 - 8) / 3, 1e-9);
}

/* A cylinder or rod from the middle plane on, cut by the cube's face or by its range. */
static void a_cylinder_in_a_cube(void **state)
{
    (void)state;
    struct region region = make_region(0, 3, false);
    assert_near(box_in(cube[0], cube[1], &region), MATH3_PI * 9 * 5, 1e-9);
    region.near = 1;
    region.far = 2.5;
    assert_near(box_in(cube[0], cube[1], &region), MATH3_PI * 9 * 1.5, 1e-9);
    region.square = true;
    assert_near(box_in(cube[0], cube[1], &region), 36 * 1.5, 1e-9);
    region = make_region(0, 3, false);
    /* half a cylinder: the axis runs in a face */
    assert_near(box_in((double[]){0, -5, -5}, cube[1], &region), MATH3_PI * 9 * 5 / 2, 1e-9);
    /* a segment of its circle, R^2 acos(h/R) - h sqrt(R^2 - h^2) */
    double segment = 9 * acos(2.0 / 3) - 2 * sqrt(5);
    assert_near(box_in((double[]){2, -5, -5}, cube[1], &region), segment * 5, 1e-9);
}

/* A plane at the angle b to the axis's normal, at the distance d: pi t^2 d^3 / (3 (cos^2 b - t^2 sin^2 b)^(3/2)), the
 * cone below an ellipse; t = tan(angle / 2). Here the cone is turned, and the plane is the face of a large box. */
static void an_oblique_plane(void **state)
{
    (void)state;
    for (int degrees = 5; degrees <= 55; degrees += 10) {
        struct region region = make_region(60, 0, false);
        const double b = radians_from_degrees(degrees);
        const double t = tan(radians_from_degrees(30));
        const double d = 2;
        const double turned[3][3] = {{cos(b), 0, -sin(b)}, {0, 1, 0}, {sin(b), 0, cos(b)}};
        double wanted = MATH3_PI * t * t * d * d * d / 3 * pow(cos(b) * cos(b) - t * t * sin(b) * sin(b), -1.5);
        memcpy(region.up, turned[0], sizeof region.up);
        memcpy(region.right, turned[1], sizeof region.right);
        memcpy(region.axis, turned[2], sizeof region.axis);
        double got = box_in((double[]){-900, -900, -5}, (double[]){900, 900, d}, &region);
        assert_near(got / wanted, 1, 1e-9);
    }
}

/* About a corner, an edge and a face's middle a ball has an eighth, a quarter and a half in the cube; beyond a plane at
 * the distance h a cap, pi (R - h)^2 (2R + h) / 3; wholly inside all, and around the cube the cube. */
static void a_ball_and_a_cube(void **state)
{
    (void)state;
    struct region ball;
    const double all = 4 * MATH3_PI * 27 / 3;
    const double h = 1.25;
    const struct {
        double centre[3], volume;
    } cases[] = {{{5, 5, 5}, all / 8},
                 {{5, 5, 0.5}, all / 4},
                 {{5, 0.5, -1}, all / 2},
                 {{5 + h, 0.5, -1}, MATH3_PI * (3 - h) * (3 - h) * (6 + h) / 3},
                 {{5 - h, 0.5, -1}, all - MATH3_PI * (3 - h) * (3 - h) * (6 + h) / 3},
                 {{1, 1.5, -1}, all},
                 {{8.1, 0, 0}, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        region_ball(&ball, cases[i].centre, 3);
        assert_near(box_in(cube[0], cube[1], &ball), cases[i].volume, 1e-9);
    }
    region_ball(&ball, (double[]){1, 0, 0}, 10.5); /* the far corners are 9.3 mm away */
    assert_near(box_in(cube[0], cube[1], &ball), 1000, 1e-9);
}

/* A tetrahedron from the apex and three corners in the cone: |det| / 6. A sphere in it: all of the mesh, to the last
 * bit. */
static void what_is_wholly_inside(void **state)
{
    (void)state;
    struct region region = make_region(80, 0, false);
    struct mesh mesh;
    static const float corners[4][3] = {{0, 0, 0}, {1, 0, 4}, {-1, 2, 5}, {0, -1, 6}};
    static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
    assert_ok(mesh_init(&mesh, 4, 4));
    memcpy(mesh.positions, corners, sizeof corners);
    memcpy(mesh.triangles, faces, sizeof faces);
    /* (1 0 4) . ((-1 2 5) x (0 -1 6)) = 1 (12 + 5) + 4 (1) = 21 */
    assert_near(volume_in(&mesh, &region), 21.0 / 6, 1e-12);
    mesh = mesh_scene_sphere((double[]){1, 2, 40}, 10, 24, 48);
    assert_ok(mesh_measure(&mesh.shape, &mesh));
    double whole = mesh.shape.volume_mm3;
    assert_near(volume_in(&mesh, &region), whole, 0);
    mesh = mesh_scene_sphere((double[]){1, 2, -40}, 10, 24, 48); /* behind the apex */
    assert_near(volume_in(&mesh, &region), 0, 0);
    mesh = mesh_scene_sphere((double[]){1, 2, 40}, 10, 24, 48); /* inside out */
    mesh_scene_turn(&mesh);
    region.far = 40;
    double half = volume_in(&mesh, &region);
    assert_near(half, whole / 2, 1e-7 * whole); /* a mirror image beyond 40 mm, but for rounding to float */
}

static struct mesh random_solid(uint64_t *state, int kind)
{
    if (kind % 3 == 0) {
        return mesh_scene_torus(test_random(state, 20, 40), test_random(state, 3, 12), 30, 12);
    }
    const double centre[3] = {test_random(state, -20, 20), test_random(state, -20, 20), test_random(state, -20, 20)};
    return mesh_scene_sphere(centre, test_random(state, 5, 40), 5 + (unsigned)kind % 11, 9 + (unsigned)kind % 7);
}

static struct region random_region(uint64_t *state, int kind)
{
    struct cone cone = mesh_scene_random_cone(state, 30);
    double angle = test_random(state, 2, 175);
    cone.angle = kind % 2 ? 0 : radians_from_degrees(angle);
    cone.radius = kind % 2 ? test_random(state, 1, 30) : 0;
    cone.aperture = kind / 2 % 2 ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE;
    struct region region;
    region_from_cone(&region, &cone);
    return region;
}

/* Slabs of the depth add up to the region without a range, and no part is larger than the whole. */
static void slabs_add_up(void **state)
{
    (void)state;
    uint64_t random = 71;
    int cut = 0;
    for (int kind = 0; kind < (int)test_trials(400); kind++) {
        struct region region = random_region(&random, kind);
        uint64_t same = random;
        struct mesh mesh = random_solid(&random, kind);
        assert_ok(mesh_measure(&mesh.shape, &mesh));
        double whole = mesh.shape.volume_mm3;
        double middle[3];
        vec3_sub(middle, mesh.shape.centroid, region.origin);
        double all = volume_in(&mesh, &region);
        double depths[] = {0, vec3_length(middle) - test_random(&random, 0, 20),
                           vec3_length(middle) + test_random(&random, 0, 20), INFINITY};
        double sum = 0;
        for (int slab = 0; slab < 3; slab++) {
            uint64_t again = same;
            mesh = random_solid(&again, kind);
            region.near = fmax(depths[slab], 0);
            region.far = depths[slab + 1];
            sum += region.far > region.near ? volume_in(&mesh, &region) : (mesh_finish(&mesh), 0);
        }
        double noise = 1e-9 * (1 + whole) * (1 + vec3_length(middle) / 100);
        cut += all > 0 && all < whole;
        assert_near(sum, all, noise);
        assert_true(all >= 0 && all <= whole);
    }
    assert_true(cut > (int)test_trials(400) / 4);
}

/* A triangle adds as much as its four parts do, which cross the region's side, range and axis at other places. */
static void parts_of_a_triangle_add_up(void **state)
{
    (void)state;
    uint64_t random = 73;
    int cut = 0;
    for (int kind = 0; kind < (int)test_trials(40000); kind++) {
        struct region region = random_region(&random, kind);
        struct region_solid solid;
        double p[6][3]; /* three corners, and the middles of the edges */
        double reach = pow(10, test_random(&random, -2, 2));
        if (kind % 8 >= 6) {
            region_ball(&region, region.origin, region.radius + 5);
        } else if (kind % 3 == 0) {
            region.near = test_random(&random, 0, 40);
            region.far = region.near + test_random(&random, 0, 40);
        }
        double depth = test_random(&random, 0, 60);
        double beside = region.radius + depth * region.slope;
        for (int k = 0; k < 9; k++) {
            p[k / 3][k % 3] = region.origin[k % 3] + depth * region.axis[k % 3] + beside * region.up[k % 3] +
                              test_random(&random, -reach, reach);
        }
        for (int k = 0; k < 9; k++) {
            p[3 + k / 3][k % 3] = (p[k / 3][k % 3] + p[(k / 3 + 1) % 3][k % 3]) / 2;
        }
        static const int corners[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
        double part[3][3];
        double sum = 0;
        region_solid_init(&solid, &region);
        for (int t = 0; t < 4; t++) {
            for (int k = 0; k < 3; k++) {
                memcpy(part[k], p[corners[t][k]], sizeof part[k]);
            }
            sum += region_triangle(&solid, part);
        }
        double whole = region_triangle(&solid, p);
        cut += whole != 0;
        assert_near(whole, sum, 1e-9 * (1 + fabs(whole)) * (1 + reach));
    }
    assert_true(cut > (int)test_trials(40000) / 10);
}

/* The six pyramids of 90 degrees from a point fill space. */
static void six_pyramids_fill_space(void **state)
{
    (void)state;
    uint64_t random = 72;
    for (int kind = 0; kind < (int)test_trials(100); kind++) {
        struct region region = make_region(90, 0, true);
        uint64_t same = random;
        struct mesh mesh = random_solid(&random, kind);
        double from[3];
        double sum = 0;
        assert_ok(mesh_measure(&mesh.shape, &mesh));
        double whole = mesh.shape.volume_mm3;
        mesh_finish(&mesh);
        for (int a = 0; a < 3; a++) {
            from[a] = test_random(&random, -30, 30);
        }
        for (int side = 0; side < 6; side++) {
            uint64_t again = same;
            double axes[3][3] = {{0}};
            for (int a = 0; a < 3; a++) {
                axes[a][(side / 2 + a) % 3] = 1;
            }
            vec3_scale(region.axis, axes[2], side % 2 ? -1 : 1);
            vec3_scale(region.up, axes[side % 2], 1);
            vec3_scale(region.right, axes[!(side % 2)], 1);
            memcpy(region.origin, from, sizeof from);
            mesh = random_solid(&again, kind);
            sum += volume_in(&mesh, &region);
        }
        assert_near(sum, whole, 1e-9 * whole);
    }
}

/* Three rays that pass a ball of 4 mm do not make its volume larger than it is, and a ball between the rays is
 * found. */
static void answers_have_it(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    const double centres[2][3] = {{0, 0, 0}, {29.2, 0, 0}};
    struct cone cone = mesh_scene_cone((double[]){0, 0, 200}, (double[]){0, 0, 0}, 20, 16);
    for (int i = 0; i < 2; i++) {
        struct mesh ball = mesh_scene_sphere(centres[i], i ? 0.5 : 4, 24, 48);
        mesh_scene_add(atlas, &ball);
    }
    for (uint32_t n = 1; n <= 16; n += 3) {
        conus_selection *selection =
            mesh_scene_select(atlas, &(conus_selector_options){.layers = CONUS_LAYERS_ALL, .resolution = n}, &cone);
        double volumes = 0;
        for (uint32_t number = 1; number <= 2; number++) {
            const conus_result *result = conus_selection_result(selection, 0);
            for (size_t i = 0; result->object != number; i++) {
                result = conus_selection_result(selection, i);
                assert_non_null(result);
            }
            assert_near(result->fraction, 1, 0);
            assert_near(result->volume, conus_atlas_object(atlas, number)->volume_mm3, 0);
            volumes += result->volume;
        }
        const conus_result *first = conus_selection_result(selection, 0);
        assert_near(first->cone_fraction, first->volume / volumes, 1e-12);
        conus_selection_destroy(selection);
    }
    conus_atlas_destroy(atlas);
}

TEST_GROUP(solids)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cone_in_a_cube),
        cmocka_unit_test(a_cylinder_in_a_cube),
        cmocka_unit_test(an_oblique_plane),
        cmocka_unit_test(a_ball_and_a_cube),
        cmocka_unit_test(what_is_wholly_inside),
        cmocka_unit_test(slabs_add_up),
        cmocka_unit_test(parts_of_a_triangle_add_up),
        cmocka_unit_test(six_pyramids_fill_space),
        cmocka_unit_test(answers_have_it),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
