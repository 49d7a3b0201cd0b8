/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas's surfaces by Embree alone: the nearest triangle in single precision, of packets of 16 coherent rays. */
#include "atlas/atlas.h"
#include "base/memory.h"
#include "bench/support/trace.h"
#include "selection/engine/triangles/embree.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 16 };

struct bare_embree {
    struct engine base;
    RTCDevice device;
    RTCScene scene;
};

static conus_status trace(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    struct embree_query query;
    double direction[3][WIDTH];
    double *const axes[3] = {direction[0], direction[1], direction[2]};
    const double *apex = cone->pose.world_from_device + 12;
    embree_query_init(&query, NULL, true);
    evidence_clear(out);
    for (size_t first = 0; first < cone->tracing.rays->count; first += WIDTH) {
        struct RTCRayHit16 packet;
        _Alignas(64) int valid[WIDTH];
        size_t left = cone->tracing.rays->count - first, count = left < WIDTH ? left : WIDTH;
        cone_rays_from(axes, cone, cone->tracing.rays, first, count);
        for (size_t i = 0; i < WIDTH; i++) {
            size_t ray = i < count ? i : 0;
            valid[i] = i < count ? -1 : 0;
            packet.ray.org_x[i] = (float)apex[0];
            packet.ray.org_y[i] = (float)apex[1];
            packet.ray.org_z[i] = (float)apex[2];
            packet.ray.dir_x[i] = (float)direction[0][ray];
            packet.ray.dir_y[i] = (float)direction[1][ray];
            packet.ray.dir_z[i] = (float)direction[2][ray];
            packet.ray.tfar[i] = (float)INFINITY;
            packet.ray.tnear[i] = packet.ray.time[i] = 0;
            packet.ray.mask[i] = UINT32_MAX;
            packet.ray.flags[i] = 0;
            packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        embree_intersect(&query, ((struct bare_embree *)engine)->scene, valid, &packet, WIDTH);
        for (size_t i = 0; i < count; i++) {
            uint32_t pixel = cone->tracing.rays->pixel[first + i];
            out->object[pixel] = packet.hit.geomID[i] + 1; /* 0 of none */
            out->distance[pixel] = (double)packet.ray.tfar[i];
            out->voxel[pixel] = packet.hit.primID[i];
        }
    }
    return CONUS_OK;
}

static void destroy(struct engine *engine)
{
    struct bare_embree *own = (struct bare_embree *)engine;
    rtc.ReleaseScene(own->scene);
    rtc.ReleaseDevice(own->device);
    memory_free(own);
}

static void attach(const struct bare_embree *own, const struct mesh *mesh, unsigned number)
{
    RTCGeometry geometry = rtc.NewGeometry(own->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *positions = rtc.SetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                3 * sizeof *positions, mesh->vertex_count);
    memcpy(positions, mesh->positions, 3 * mesh->vertex_count * sizeof *positions);
    rtc.SetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles, 0,
                                3 * sizeof *mesh->triangles, mesh->triangle_count);
    rtc.CommitGeometry(geometry);
    rtc.AttachGeometryByID(own->scene, geometry, number);
    rtc.ReleaseGeometry(geometry);
}

conus_status bare_embree_create(struct engine **out, const conus_atlas *atlas)
{
    static const struct engine_functions functions = {.trace = trace, .destroy = destroy};
    conus_status status = library_load(&rtc, EMBREE_FUNCTIONS(LIBRARY_NAME), CONUS_EMBREE_FILE, "libembree");
    struct bare_embree *own = status ? NULL : memory_zeroed(1, sizeof *own);
    if (!own) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    *own = (struct bare_embree){.base = {&functions, "bare Embree"}, .device = rtc.NewDevice(NULL)};
    own->scene = rtc.NewScene(own->device);
    rtc.SetSceneFlags(own->scene, RTC_SCENE_FLAG_ROBUST);
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        attach(own, atlas_object_mesh(atlas, object), object - 1);
    }
    rtc.CommitScene(own->scene);
    *out = &own->base;
    return CONUS_OK;
}
