/* SPDX-License-Identifier: BSD-3-Clause */
/* Places the tori and aims cones at them. */
#include "bench/torus/torus.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { SUBDIVISIONS = 16, PLACE_SEED = 777, CONE_SEED = 5 };

static const double tube_radius = 1.5;

static conus_status make_torus(struct mesh *out)
{
    enum { N = SUBDIVISIONS };
    conus_status status = mesh_init(out, N * N, TORUS_TRIANGLES);
    for (uint32_t i = 0; i < N && !status; i++) {
        for (uint32_t j = 0; j < N; j++) {
            double round = 2 * MATH3_PI * i / N, across = 2 * MATH3_PI * j / N;
            double away = TORUS_RING + tube_radius * cos(across);
            float *position = &out->positions[3 * (i * N + j)];
            position[0] = (float)(away * cos(round));
            position[1] = (float)(away * sin(round));
            position[2] = (float)(tube_radius * sin(across));
            uint32_t next_i = (i + 1) % N, next_j = (j + 1) % N;
            const uint32_t corners[] = {i * N + j, next_i * N + j,      next_i * N + next_j,
                                        i * N + j, next_i * N + next_j, i * N + next_j};
            memcpy(&out->triangles[6 * (i * N + j)], corners, sizeof corners);
        }
    }
    return status;
}

conus_status torus_scene_init(struct torus_scene *out, size_t count)
{
    struct torus_scene scene = {.count = count};
    uint64_t random = PLACE_SEED;
    conus_status status = make_torus(&scene.torus);
    scene.places = status ? NULL : memory_raw(count, sizeof *scene.places);
    if (!scene.places) {
        torus_scene_finish(&scene);
        return status ? status : CONUS_ERROR_MEMORY;
    }
    size_t edge = (size_t)ceil(cbrt((double)count) - 1e-9);
    scene.side = (double)edge * TORUS_SPACING;
    for (size_t i = 0; i < count; i++) {
        const size_t at[3] = {i % edge, i / edge % edge, i / edge / edge};
        double centre[3], wxyz[4];
        conus_pose pose;
        for (int a = 0; a < 3; a++) {
            centre[a] = ((double)at[a] - 0.5 * (double)(edge - 1)) * TORUS_SPACING;
        }
        for (int k = 0; k < 4; k++) {
            wxyz[k] = bench_random(&random, -0.5, 0.5);
        }
        conus_status placed = conus_pose_from_quaternion(&pose, centre, wxyz);
        assert(!placed);
        (void)placed;
        memcpy(scene.places[i], pose.world_from_device, sizeof pose.world_from_device);
    }
    *out = scene;
    return CONUS_OK;
}

void torus_scene_finish(struct torus_scene *scene)
{
    mesh_finish(&scene->torus);
    memory_free(scene->places);
    *scene = (struct torus_scene){0};
}

void torus_scene_cones(struct cone *out, const struct torus_scene *scene, size_t count, double angle_deg)
{
    static const double from[3] = {0.45, -0.2, 1}, from_range[3] = {0.15, 0.15, 0.1};
    static const double to[3] = {0, 0, 0.1}, to_range[3] = {0.25, 0.25, 0};
    uint64_t random = CONE_SEED;
    for (size_t i = 0; i < count; i++) {
        double origin[3], target[3];
        for (int a = 0; a < 3; a++) {
            origin[a] = scene->side * (from[a] + bench_random(&random, -1, 1) * from_range[a]);
            target[a] = scene->side * (to[a] + bench_random(&random, -1, 1) * to_range[a]);
        }
        out[i] = (struct cone){.angle = radians_from_degrees(angle_deg), .resolution = TORUS_RESOLUTION};
        conus_status status = conus_pose_toward(&out[i].pose, origin, target, NULL);
        assert(!status);
        (void)status;
    }
}

conus_status torus_scene_rays(struct mesh_rays **out, const struct torus_scene *scene)
{
    struct mesh_object *objects = memory_raw(scene->count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < scene->count; i++) {
        objects[i] = (struct mesh_object){&scene->torus, scene->places[i]};
    }
    conus_status status = mesh_rays_create(out, objects, scene->count);
    memory_free(objects);
    return status;
}

static conus_status add_torus(conus_atlas *atlas, const struct torus_scene *scene, size_t index)
{
    char name[32];
    struct mesh mesh;
    conus_status status = mesh_init(&mesh, scene->torus.vertex_count, scene->torus.triangle_count);
    if (status) {
        return status;
    }
    memcpy(mesh.positions, scene->torus.positions, 3 * mesh.vertex_count * sizeof *mesh.positions);
    memcpy(mesh.triangles, scene->torus.triangles, 3 * mesh.triangle_count * sizeof *mesh.triangles);
    mesh_transform(&mesh, scene->places[index]);
    snprintf(name, sizeof name, "torus %zu", index + 1);
    const conus_object area = {.label = (uint32_t)index + 1, .name = name, .abbreviation = ""};
    status = atlas_add_mesh(atlas, &area, &mesh);
    mesh_finish(&mesh);
    return status;
}

conus_status torus_scene_atlas(conus_atlas **out, const struct torus_scene *scene)
{
    conus_atlas *atlas = NULL;
    conus_status status = atlas_create_empty(&atlas, "tori");
    for (size_t i = 0; i < scene->count && !status; i++) {
        status = add_torus(atlas, scene, i);
    }
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    *out = atlas;
    return CONUS_OK;
}
