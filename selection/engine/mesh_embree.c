/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the scene of the meshes for Embree, and keeps Embree's errors. */
#include "selection/engine/mesh_embree.h"

#include "base/math3.h"
#include "base/memory.h"

#include <stdio.h>
#include <string.h>

/* Of the scene's size: far above what single precision can move a hit by, far below anything that matters. */
#define SLACK 1e-5

static void note_error(void *user, enum RTCError code, const char *message)
{
    struct mesh_rays *rays = user;
    pthread_mutex_lock(&rays->noting);
    if (rays->error == RTC_ERROR_NONE) {
        snprintf(rays->message, sizeof rays->message, "%s", message ? message : "no reason given");
        rays->error = code;
    }
    pthread_mutex_unlock(&rays->noting);
}

conus_status mesh_embree_status(const struct mesh_rays *rays)
{
    const enum RTCError error = rays->error; /* clang takes no atomic enumeration here */
    switch (error) {
    case RTC_ERROR_NONE:
        return CONUS_OK;
    case RTC_ERROR_OUT_OF_MEMORY:
        return fail(CONUS_ERROR_MEMORY, "out of memory for the triangles of the meshes");
    default:
        return fail(CONUS_ERROR_UNSUPPORTED, "Embree: %s", rays->message);
    }
}

static conus_status open_device(struct mesh_rays *rays)
{
    rays->device = rtcNewDevice("ignore_config_files=1");
    if (!rays->device) {
        note_error(rays, rtcGetDeviceError(NULL), "no device");
        return mesh_embree_status(rays);
    }
    rtcSetDeviceErrorFunction(rays->device, note_error, rays);
    return CONUS_OK;
}

/* Embree wants a few bytes more behind the last vertex: where there are none, it gets a copy. */
static bool set_positions(RTCGeometry geometry, const struct mesh *mesh)
{
    const size_t size = 3 * sizeof *mesh->positions;
    if (mesh->is_borrowed) {
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->positions, 0, size,
                                   mesh->vertex_count);
        return true;
    }
    float *positions =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, size, mesh->vertex_count);
    if (positions) {
        memcpy(positions, mesh->positions, mesh->vertex_count * size);
    }
    return positions;
}

static conus_status attach_mesh(struct mesh_rays *rays, RTCScene scene, const struct mesh *mesh, unsigned number)
{
    RTCGeometry geometry = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (set_positions(geometry, mesh)) {
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles, 0,
                                   3 * sizeof *mesh->triangles, mesh->triangle_count);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, number);
    }
    rtcReleaseGeometry(geometry);
    return mesh_embree_status(rays);
}

static RTCScene new_scene(const struct mesh_rays *rays)
{
    RTCScene scene = rtcNewScene(rays->device);
    embree_allow_filters(scene);
    return scene;
}

static void release(RTCScene scene)
{
    if (scene) {
        rtcReleaseScene(scene);
    }
}

static void attach_instance(struct mesh_rays *rays, RTCScene part, const double world_from_mesh[16], unsigned number)
{
    float matrix[16];
    for (int i = 0; i < 16; i++) {
        matrix[i] = (float)world_from_mesh[i];
    }
    RTCGeometry geometry = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, part);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, matrix);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(rays->scene, geometry, number);
    rtcReleaseGeometry(geometry);
}

static conus_status attach_all(struct mesh_rays *rays, const struct mesh_object *objects, size_t count)
{
    conus_status status = CONUS_OK;
    RTCScene part = NULL;
    const struct mesh *part_of = NULL;
    for (size_t i = 0; i < count && !status; i++) {
        const struct mesh_object *object = &objects[i];
        if (object->mesh && !object->world_from_mesh) {
            status = attach_mesh(rays, rays->scene, object->mesh, (unsigned)i);
        } else if (object->mesh) {
            if (object->mesh != part_of) {
                release(part);
                part = new_scene(rays);
                part_of = object->mesh;
                status = attach_mesh(rays, part, part_of, 0);
                rtcCommitScene(part);
            }
            attach_instance(rays, part, object->world_from_mesh, (unsigned)i);
        }
    }
    release(part);
    rtcCommitScene(rays->scene);
    return mesh_embree_status(rays);
}

static size_t count_triangles(const struct mesh_object *objects, size_t count)
{
    size_t triangles = 0;
    for (size_t i = 0; i < count; i++) {
        triangles += objects[i].mesh ? objects[i].mesh->triangle_count : 0;
    }
    return triangles;
}

static void measure_scene(struct mesh_rays *rays, size_t triangles)
{
    struct RTCBounds bounds;
    rtcGetSceneBounds(rays->scene, &bounds);
    const double low[3] = {(double)bounds.lower_x, (double)bounds.lower_y, (double)bounds.lower_z};
    const double high[3] = {(double)bounds.upper_x, (double)bounds.upper_y, (double)bounds.upper_z};
    double reach = 0;
    double volume = 1;
    for (int a = 0; a < 3; a++) {
        rays->low[a] = low[a];
        rays->high[a] = high[a];
        volume *= high[a] - low[a];
        reach = fmax(reach, fmax(fabs(low[a]), fabs(high[a])));
    }
    rays->slack = SLACK * reach;
    rays->cell = cbrt(volume / (double)triangles);
}

/* What weigh() needs of every object. */
static conus_status keep_surfaces(struct mesh_rays *rays, const struct mesh_object *objects, size_t count)
{
    bool placed = false;
    for (size_t i = 0; i < count; i++) {
        placed = placed || objects[i].world_from_mesh;
    }
    rays->surfaces = memory_zeroed(count, sizeof *rays->surfaces);
    rays->mesh_from_world = placed ? memory_raw(count, sizeof *rays->mesh_from_world) : NULL;
    if (!rays->surfaces || (placed && !rays->mesh_from_world)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        const double *place = objects[i].world_from_mesh;
        const struct mesh *mesh = objects[i].mesh;
        rays->surfaces[i] = (struct surface){.mesh = mesh, .mesh_from_world = place ? rays->mesh_from_world[i] : NULL};
        if (mesh) {
            rays->surfaces[i].triangles = mesh->triangles;
            rays->surfaces[i].positions = mesh->positions;
        }
        if (place && !mat4_invert_affine(rays->mesh_from_world[i], place)) {
            return fail(CONUS_ERROR_ARGUMENT, "object %zu: its matrix cannot be inverted", i + 1);
        }
    }
    return CONUS_OK;
}

conus_status mesh_rays_create(struct mesh_rays **out, const struct mesh_object *objects, size_t count)
{
    struct mesh_rays *rays = memory_zeroed(1, sizeof *rays);
    if (!rays) {
        return CONUS_ERROR_MEMORY;
    }
    pthread_mutex_init(&rays->noting, NULL);
    conus_status status = keep_surfaces(rays, objects, count);
    status = status ? status : open_device(rays);
    if (!status) {
        rays->scene = new_scene(rays);
        status = attach_all(rays, objects, count);
    }
    if (status) {
        mesh_rays_destroy(rays);
        return status;
    }
    measure_scene(rays, count_triangles(objects, count));
    *out = rays;
    return CONUS_OK;
}

void mesh_rays_destroy(struct mesh_rays *rays)
{
    if (rays) {
        release(rays->scene);
        if (rays->device) {
            rtcReleaseDevice(rays->device);
        }
        memory_free(rays->surfaces);
        memory_free(rays->mesh_from_world);
        pthread_mutex_destroy(&rays->noting);
        memory_free(rays);
    }
}
