/* SPDX-License-Identifier: BSD-3-Clause */
/* Contacts on meshes of simple forms against closed formulas. */
#include "base/geometry/math3.h"
#include "mesh_scene.h"
#include "selection/engine/triangles/mesh_rays.h"
#include "test.h"

static void contacts_of_a_sphere_lie_on_its_triangles(void **test)
{
    (void)test;
    const double centre[3] = {4, 5, -6};
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh sphere = mesh_scene_sphere(centre, 20, 40, 80);
    mesh_scene_add(atlas, &sphere);
    const struct mesh *mesh = atlas_object_mesh(atlas, 1);
    struct cone cone = mesh_scene_cone((double[]){-90, 20, 15}, centre, 26, 32);
    struct evidence evidence;
    mesh_scene_trace(&evidence, atlas, &cone);
    size_t hits = 0;
    double inner = 20 * cos(MATH3_PI / 80) * cos(MATH3_PI / 80) - 1e-5;
    for (uint32_t pixel = 0; pixel < 32 * 32; pixel++) {
        double ray[3], contact[3], from_centre[3];
        cone_ray(ray, &cone, pixel % 32, pixel / 32);
        if (evidence.object[pixel]) {
            hits++;
            vec3_add_scaled(contact, cone.pose.world_from_device + 12, evidence.distance[pixel], ray);
            vec3_sub(from_centre, contact, centre);
            assert_true(vec3_length(from_centre) <= 20 + 1e-5 && vec3_length(from_centre) >= inner);
            double t = mesh_distance(mesh, (size_t)evidence.voxel[pixel], cone.pose.world_from_device + 12, ray);
            assert_near(evidence.distance[pixel], t, 0);
        } else { /* then it passes the sphere by, or all but */
            vec3_sub(from_centre, centre, cone.pose.world_from_device + 12);
            double along = vec3_dot(from_centre, ray);
            assert_true(vec3_dot(from_centre, from_centre) - along * along >= inner * inner);
        }
    }
    assert_true(hits > 500 && hits < 32 * 32);
    evidence_finish(&evidence);
    conus_atlas_destroy(atlas);
}

/* Signed distance to a torus round z. */
static double torus_distance(const double p[3], double ring, double tube)
{
    double out = sqrt(p[0] * p[0] + p[1] * p[1]) - ring;
    return sqrt(out * out + p[2] * p[2]) - tube;
}

/* Cosine of the angle between a ray and the torus's normal at p. */
static double steepness(const double p[3], const double ray[3], double ring, double tube)
{
    double ahead[3];
    vec3_add_scaled(ahead, p, 1e-5, ray);
    return fabs(torus_distance(ahead, ring, tube) - torus_distance(p, ring, tube)) / 1e-5;
}

static void a_torus_is_hit_where_its_closed_form_says(void **test)
{
    (void)test;
    enum { SECTORS = 256, SIDES = 128 };
    const double ring = 35, tube = 15;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh torus = mesh_scene_torus(ring, tube, SECTORS, SIDES);
    mesh_scene_add(atlas, &torus);
    struct cone cone = mesh_scene_cone((double[]){40, -120, 90}, (double[]){0, 0, 0}, 40, 48);
    struct evidence evidence;
    mesh_scene_trace(&evidence, atlas, &cone);
    double sag = (ring + tube) * (1 - cos(MATH3_PI / SECTORS)) + tube * (1 - cos(MATH3_PI / SIDES)) + 1e-4;
    size_t misses = 0, steep = 0, through_the_hole = 0;
    for (uint32_t pixel = 0; pixel < 48 * 48; pixel++) {
        double ray[3], p[3];
        double t = 0, nearest = INFINITY;
        cone_ray(ray, &cone, pixel % 48, pixel / 48);
        for (int step = 0; step < 2000 && t < 400; step++) { /* safe steps towards the smooth surface */
            vec3_add_scaled(p, cone.pose.world_from_device + 12, t, ray);
            double clear = torus_distance(p, ring, tube);
            nearest = fmin(nearest, clear);
            if (clear < 1e-10) {
                break;
            }
            t += clear;
        }
        if (evidence.object[pixel]) {
            vec3_add_scaled(p, cone.pose.world_from_device + 12, evidence.distance[pixel], ray);
            assert_near(torus_distance(p, ring, tube), 0, sag);
            if (steepness(p, ray, ring, tube) > 0.3) {
                assert_near(evidence.distance[pixel], t, 2 * sag / 0.3);
                steep++;
            }
        } else {
            misses++;
            through_the_hole += nearest > 0.5 && nearest < tube;
            assert_true(nearest > -1e-9 || t < 400); /* all but missed */
        }
    }
    assert_true(steep > 300 && misses > 400 && through_the_hole > 10);
    evidence_finish(&evidence);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(mesh_forms)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_of_a_sphere_lie_on_its_triangles),
        cmocka_unit_test(a_torus_is_hit_where_its_closed_form_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
