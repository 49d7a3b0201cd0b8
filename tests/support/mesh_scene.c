/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds meshes, and finds hits by trying every triangle. */
#include "mesh_scene.h"

#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "oracle_triangle.h"
#include "selection/engine/engine.h"
#include "test.h"
#include "value_maps.h"

#include <stdlib.h>
#include <string.h>

conus_atlas *mesh_scene_atlas(void)
{
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "test"));
    return atlas;
}

struct cone mesh_scene_cone(const double origin[3], const double target[3], double degrees, uint32_t resolution)
{
    struct cone cone = {.angle = radians_from_degrees(degrees), .resolution = resolution};
    assert_ok(conus_pose_toward(&cone.pose, origin, target, NULL));
    return cone;
}

void mesh_scene_trace(struct evidence *out, const conus_atlas *atlas, const struct cone *cone)
{
    struct engine *engine = NULL;
    assert_ok(engine_rays_create(&engine, atlas, &(struct engine_options){0}));
    assert_ok(evidence_init(out, cone->resolution));
    assert_ok(engine->functions->trace(engine, out, cone));
    engine_destroy(engine);
}

conus_selection *mesh_scene_select(const conus_atlas *atlas, const conus_selector_options *options,
                                   const struct cone *cone)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(
        conus_select(&selection, selector, &cone->pose, degrees_from_radians(options->radius > 0 ? 0 : cone->angle)));
    conus_selector_destroy(selector);
    return selection;
}

static struct mesh blank(size_t vertices, size_t triangles)
{
    struct mesh mesh;
    assert_ok(mesh_init(&mesh, vertices, triangles));
    return mesh;
}

static void put_vertex(struct mesh *mesh, size_t index, double x, double y, double z)
{
    mesh->positions[3 * index] = (float)x;
    mesh->positions[3 * index + 1] = (float)y;
    mesh->positions[3 * index + 2] = (float)z;
}

static void put_triangle(struct mesh *mesh, size_t *count, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *triangle = &mesh->triangles[3 * (*count)++];
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

struct mesh mesh_scene_sphere(const double centre[3], double radius, unsigned rings, unsigned sectors)
{
    struct mesh mesh = blank(2 + (size_t)(rings - 1) * sectors, 2 * (size_t)(rings - 1) * sectors);
    size_t count = 0;
    uint32_t last = (uint32_t)mesh.vertex_count - 1;
    put_vertex(&mesh, 0, centre[0], centre[1], centre[2] - radius);
    put_vertex(&mesh, last, centre[0], centre[1], centre[2] + radius);
    for (uint32_t ring = 1; ring < rings; ring++) {
        double down = MATH3_PI * (ring / (double)rings - 0.5);
        for (uint32_t s = 0; s < sectors; s++) {
            double turn = 2 * MATH3_PI * s / sectors;
            put_vertex(&mesh, 1 + (ring - 1) * sectors + s, centre[0] + radius * cos(down) * cos(turn),
                       centre[1] + radius * cos(down) * sin(turn), centre[2] + radius * sin(down));
        }
    }
    for (uint32_t ring = 0; ring < rings; ring++) {
        for (uint32_t s = 0; s < sectors; s++) {
            uint32_t next = (s + 1) % sectors;
            uint32_t below = 1 + (ring - 1) * sectors, here = 1 + ring * sectors;
            if (ring == 0) {
                put_triangle(&mesh, &count, 0, 1 + next, 1 + s);
            } else if (ring == rings - 1) {
                put_triangle(&mesh, &count, last, below + s, below + next);
            } else {
                put_triangle(&mesh, &count, below + s, below + next, here + next);
                put_triangle(&mesh, &count, below + s, here + next, here + s);
            }
        }
    }
    assert_int_equal(count, mesh.triangle_count);
    return mesh;
}

struct mesh mesh_scene_torus(double ring, double tube, unsigned sectors, unsigned sides)
{
    struct mesh mesh = blank((size_t)sectors * sides, 2 * (size_t)sectors * sides);
    size_t count = 0;
    for (uint32_t i = 0; i < sectors; i++) {
        for (uint32_t j = 0; j < sides; j++) {
            double a = 2 * MATH3_PI * i / sectors, b = 2 * MATH3_PI * j / sides;
            double out = ring + tube * cos(b);
            put_vertex(&mesh, i * sides + j, out * cos(a), out * sin(a), tube * sin(b));
            uint32_t next_i = (i + 1) % sectors * sides, next_j = (j + 1) % sides;
            put_triangle(&mesh, &count, i * sides + j, next_i + j, next_i + next_j);
            put_triangle(&mesh, &count, i * sides + j, next_i + next_j, i * sides + next_j);
        }
    }
    return mesh;
}

struct mesh mesh_scene_soup(uint64_t *state, size_t count, double size, double edge)
{
    struct mesh mesh = blank(3 * count, count);
    for (uint32_t i = 0; i < count; i++) {
        double p[3];
        bool thin = test_random(state, 0, 1) < 0.2;
        for (int a = 0; a < 3; a++) {
            p[a] = test_random(state, -size, size);
        }
        for (uint32_t k = 0; k < 3; k++) {
            double reach = thin && k == 2 ? edge * 1e-3 : edge;
            put_vertex(&mesh, 3 * i + k, p[0] + test_random(state, -reach, reach),
                       p[1] + test_random(state, -reach, reach), p[2] + test_random(state, -reach, reach));
            mesh.triangles[3 * i + k] = 3 * i + k;
        }
    }
    return mesh;
}

struct mesh mesh_scene_box(const double low[3], const double high[3])
{
    static const uint32_t triangles[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                              {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    struct mesh mesh = blank(8, 12);
    for (uint32_t i = 0; i < 8; i++) {
        put_vertex(&mesh, i, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
    }
    memcpy(mesh.triangles, triangles, sizeof triangles);
    return mesh;
}

void mesh_scene_turn(struct mesh *mesh)
{
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        uint32_t kept = mesh->triangles[3 * i];
        mesh->triangles[3 * i] = mesh->triangles[3 * i + 1];
        mesh->triangles[3 * i + 1] = kept;
    }
}

struct mesh mesh_scene_join(struct mesh *a, struct mesh *b)
{
    struct mesh mesh = blank(a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
    memcpy(mesh.positions, a->positions, 3 * a->vertex_count * sizeof *mesh.positions);
    memcpy(mesh.positions + 3 * a->vertex_count, b->positions, 3 * b->vertex_count * sizeof *mesh.positions);
    memcpy(mesh.triangles, a->triangles, 3 * a->triangle_count * sizeof *mesh.triangles);
    for (size_t i = 0; i < 3 * b->triangle_count; i++) {
        mesh.triangles[3 * a->triangle_count + i] = (uint32_t)a->vertex_count + b->triangles[i];
    }
    mesh_finish(a);
    mesh_finish(b);
    return mesh;
}

void mesh_scene_add(conus_atlas *atlas, struct mesh *mesh)
{
    const conus_object area = {.label = (uint32_t)atlas->object_count + 1, .name = "area", .abbreviation = ""};
    assert_ok(atlas_add_mesh(atlas, &area, mesh));
}

struct mesh_hit mesh_scene_first(const conus_atlas *atlas, const double origin[3], const double direction[3])
{
    struct mesh_hit first = {.t = INFINITY};
    int side;
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        for (size_t i = 0; mesh && i < mesh->triangle_count; i++) {
            double t = oracle_triangle(&side, mesh, i, origin, direction);
            if (t < first.t) {
                first = (struct mesh_hit){object, i, t};
            }
        }
    }
    return first;
}

static int by_distance(const void *a, const void *b)
{
    double x = ((const struct crossing *)a)->t, y = ((const struct crossing *)b)->t;
    return (x > y) - (x < y);
}

size_t mesh_scene_all(struct crossing *out, size_t limit, const struct mesh *mesh, const double origin[3],
                      const double direction[3])
{
    size_t count = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        int side;
        double t = oracle_triangle(&side, mesh, i, origin, direction);
        if (t < INFINITY) {
            assert_true(count < limit);
            out[count++] = (struct crossing){.triangle = i, .side = side, .t = t};
        }
    }
    qsort(out, count, sizeof *out, by_distance);
    return count;
}

/* Distance of the point 0 from the segment a b. */
static double distance_to_segment(const double a[3], const double b[3])
{
    double along[3], nearest[3];
    vec3_sub(along, b, a);
    double length = vec3_dot(along, along);
    double s = length > 0 ? -vec3_dot(a, along) / length : 0;
    vec3_add_scaled(nearest, a, fmin(fmax(s, 0), 1), along);
    return vec3_length(nearest);
}

double mesh_scene_edge_distance(const struct mesh *mesh, size_t triangle, const double origin[3],
                                const double direction[3])
{
    double p[3][3];
    for (size_t k = 0; k < 3; k++) { /* as the ray sees them: without the component along it */
        oracle_corner(p[k], mesh, triangle, k);
        vec3_sub(p[k], p[k], origin);
        vec3_add_scaled(p[k], p[k], -vec3_dot(p[k], direction), direction);
    }
    return fmin(distance_to_segment(p[0], p[1]),
                fmin(distance_to_segment(p[1], p[2]), distance_to_segment(p[2], p[0])));
}

static void random_point(uint64_t *state, double out[3], double size)
{
    for (int a = 0; a < 3; a++) {
        out[a] = test_random(state, -size, size);
    }
}

struct cone mesh_scene_random_cone(uint64_t *state, double size)
{
    double origin[3], target[3];
    double kind = test_random(state, 0, 1);
    random_point(state, target, 0.7 * size);
    random_point(state, origin, kind < 0.4 ? size : 4 * size);
    double degrees = test_random(state, 0, 1) < 0.6 ? test_random(state, 1, 20) : test_random(state, 20, 170);
    if (kind > 0.9) {
        vec3_scale(origin, origin, 1e5 / vec3_length(origin));
        degrees = degrees_from_radians(2 * atan(size * test_random(state, 0.1, 1.5) / 1e5));
    }
    return mesh_scene_cone(origin, target, degrees, 1 + (uint32_t)test_random(state, 0, kind < 0.8 ? 17 : 60));
}

conus_atlas *mesh_scene_nested(void)
{
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 5; i++) {
        struct mesh sphere = mesh_scene_sphere((double[]){3, -2, 1}, 50 - i * pow(10, -i), 30, 60);
        mesh_scene_add(atlas, &sphere);
    }
    return atlas;
}

conus_atlas *mesh_scene_brain(void)
{
    conus_atlas *atlas = mesh_scene_atlas();
    for (size_t i = 0; i < PHANTOM_BRAIN_AREAS; i++) {
        struct mesh mesh;
        assert_ok(phantom_brain_mesh(&mesh, i));
        mesh_scene_add(atlas, &mesh);
    }
    conus_volume_info info;
    assert_ok(phantom_brain_grid(&info));
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 16384;
    size_t count = info.dim[0] * info.dim[1] * info.dim[2];
    float *values = memory_raw(count, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < count; v++) {
        const size_t at[3] = {v % info.dim[0], v / info.dim[0] % info.dim[1], v / info.dim[0] / info.dim[1]};
        double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
        mat4_point(p, info.world_from_voxel, p);
        values[v] = phantom_brain_pathway(p);
    }
    assert_ok(pathway_of_values(atlas, &info, values, "arc"));
    return atlas;
}

void mesh_scene_add_soups(conus_atlas *atlas, uint64_t *state)
{
    for (int k = 0; k < 3; k++) {
        struct mesh soup = mesh_scene_soup(state, 1 + (size_t)test_random(state, 0, 30), 12, 6);
        mesh_scene_add(atlas, &soup);
    }
}
