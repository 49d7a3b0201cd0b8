/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/mesh_rays.h"

#include "base/math3.h"
#include "base/memory.h"

#include <assert.h>
#include <embree3/rtcore.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Of the scene's size: far above what single precision can move a hit by, far below anything that matters. */
#define SLACK 1e-5

enum { WIDTH_LIMIT = 16 };

/* A packet of rays as Embree lays it out (rtcore_ray.h; its accessors are for C++): rows of `width` numbers. */
enum {
    ORIGIN_X = 0,
    NEAR = 3,
    DIRECTION_X = 4,
    TIME = 7,
    FAR = 8,
    MASK = 9,
    RAY = 10,
    FLAGS = 11,
    HIT = 12, /* rows of the ray; the hit follows, or lies apart */
    PRIMITIVE = 5,
    GEOMETRY = 6,
    INSTANCE = 7,
    ROWS = 20
};

union number {
    float real;
    uint32_t whole;
};

static_assert(sizeof(struct RTCRayHit16) == ROWS * WIDTH_LIMIT * sizeof(union number) &&
                  offsetof(struct RTCRayHit16, ray.tfar) == FAR * WIDTH_LIMIT * sizeof(float) &&
                  offsetof(struct RTCRayHit16, ray.id) == RAY * WIDTH_LIMIT * sizeof(float) &&
                  offsetof(struct RTCRayHit16, hit.instID) == (HIT + INSTANCE) * WIDTH_LIMIT * sizeof(float),
              "rows of a packet");

struct surface {
    const struct mesh *mesh;
    const double *mesh_from_world; /* NULL = the identity */
};

struct mesh_rays {
    RTCDevice device;
    RTCScene scene;
    struct surface *surfaces;      /* [count] */
    double (*mesh_from_world)[16]; /* [count] if any surface has one */
    double low[3], high[3];        /* bounds of everything           */
    double slack;                  /* mm                             */
    double cell;                   /* mm: how far apart triangles are */
    enum RTCError error;           /* Embree's first                 */
    char message[160];
};

/* What Embree hands to weigh(); the context comes first. */
struct walk {
    struct RTCIntersectContext context;
    const struct mesh_rays *rays;
    struct mesh_bundle *bundle;
    double start; /* mm from the apex to where Embree's rays begin; negative a little behind it */
};

/* ---- The scene -------------------------------------------------------------------------------------------- */

static void note_error(void *user, enum RTCError code, const char *message)
{
    struct mesh_rays *rays = user;
    if (rays->error == RTC_ERROR_NONE) {
        rays->error = code;
        snprintf(rays->message, sizeof rays->message, "%s", message ? message : "no reason given");
    }
}

static conus_status embree_status(const struct mesh_rays *rays)
{
    switch (rays->error) {
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
        return embree_status(rays);
    }
    rtcSetDeviceErrorFunction(rays->device, note_error, rays);
    return CONUS_OK;
}

static conus_status attach_mesh(struct mesh_rays *rays, RTCScene scene, const struct mesh *mesh, unsigned number)
{
    RTCGeometry geometry = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                               3 * sizeof *positions, mesh->vertex_count);
    if (positions) { /* a copy: Embree wants a few bytes more behind the last vertex */
        memcpy(positions, mesh->positions, 3 * mesh->vertex_count * sizeof *positions);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles, 0,
                                   3 * sizeof *mesh->triangles, mesh->triangle_count);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, number);
    }
    rtcReleaseGeometry(geometry);
    return embree_status(rays);
}

static RTCScene new_scene(const struct mesh_rays *rays)
{
    RTCScene scene = rtcNewScene(rays->device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
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
    return embree_status(rays);
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
        rays->surfaces[i] = (struct surface){objects[i].mesh, place ? rays->mesh_from_world[i] : NULL};
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
        memory_free(rays);
    }
}

/* ---- The rays --------------------------------------------------------------------------------------------- */

static double distance_to(const struct walk *walk, size_t ray, uint32_t object, size_t triangle)
{
    const struct mesh_bundle *bundle = walk->bundle;
    const struct surface *surface = &walk->rays->surfaces[object - 1];
    double direction[3] = {bundle->direction[0][ray], bundle->direction[1][ray], bundle->direction[2][ray]};
    if (!surface->mesh_from_world) {
        return mesh_distance(surface->mesh, triangle, bundle->origin, direction);
    }
    double origin[3];
    mat4_point(origin, surface->mesh_from_world, bundle->origin);
    mat4_direction(direction, surface->mesh_from_world, direction);
    return mesh_distance(surface->mesh, triangle, origin, direction);
}

/* Eq. 9: nearest first; of equally near ones the lower object, then the lower triangle. */
static bool is_first(const struct mesh_bundle *bundle, size_t ray, double t, uint32_t object, uint64_t triangle)
{
    if (!(t >= 0) || t > bundle->t[ray]) {
        return false;
    }
    return t < bundle->t[ray] || object < bundle->object[ray] ||
           (object == bundle->object[ray] && triangle < bundle->triangle[ray]);
}

/* Where Embree's ray has to look no farther: behind what the ray has met, and a little more. */
static float reach(const struct walk *walk, size_t ray)
{
    return (float)(walk->bundle->t[ray] - walk->start + walk->rays->slack);
}

/* Embree calls this for what it finds before the end of the ray. */
static void weigh(const struct RTCFilterFunctionNArguments *arguments)
{
    struct walk *walk = (struct walk *)arguments->context;
    struct mesh_bundle *bundle = walk->bundle;
    union number *rays = (union number *)arguments->ray;
    const union number *hits = (const union number *)arguments->hit;
    unsigned width = arguments->N;
    for (unsigned lane = 0; lane < width; lane++) {
        if (arguments->valid[lane]) {
            size_t ray = rays[RAY * width + lane].whole;
            uint32_t place = hits[INSTANCE * width + lane].whole;
            uint32_t geometry = hits[GEOMETRY * width + lane].whole;
            uint32_t object = 1 + (place == RTC_INVALID_GEOMETRY_ID ? geometry : place);
            uint32_t triangle = hits[PRIMITIVE * width + lane].whole;
            double t = distance_to(walk, ray, object, triangle);
            if (is_first(bundle, ray, t, object, triangle)) {
                bundle->t[ray] = t;
                bundle->object[ray] = object;
                bundle->triangle[ray] = triangle;
                rays[FAR * width + lane].real = reach(walk, ray);
            } else {
                arguments->valid[lane] = 0;
            }
        }
    }
}

static inline __attribute__((always_inline)) void set_ray(const struct walk *walk, union number *packet, unsigned width,
                                                          size_t ray)
{
    const struct mesh_bundle *bundle = walk->bundle;
    for (unsigned a = 0; a < 3; a++) {
        double direction = bundle->direction[a][ray];
        packet[(ORIGIN_X + a) * width].real = (float)(bundle->origin[a] + walk->start * direction);
        packet[(DIRECTION_X + a) * width].real = (float)direction;
    }
    packet[NEAR * width].real = 0;
    packet[TIME * width].real = 0;
    packet[FAR * width].real = reach(walk, ray);
    packet[MASK * width].whole = UINT32_MAX;
    packet[RAY * width].whole = (uint32_t)ray;
    packet[FLAGS * width].whole = 0;
    packet[(HIT + GEOMETRY) * width].whole = RTC_INVALID_GEOMETRY_ID;
    packet[(HIT + INSTANCE) * width].whole = RTC_INVALID_GEOMETRY_ID;
}

static inline __attribute__((always_inline)) void shoot(struct walk *walk, size_t first, const unsigned width)
{
    _Alignas(64) union number packet[ROWS * WIDTH_LIMIT];
    _Alignas(64) int valid[WIDTH_LIMIT];
    RTCScene scene = walk->rays->scene;
    for (unsigned lane = 0; lane < width; lane++) {
        bool used = first + lane < walk->bundle->count;
        valid[lane] = used ? -1 : 0;
        set_ray(walk, packet + lane, width, used ? first + lane : first);
    }
    if (width == 16) {
        rtcIntersect16(valid, scene, &walk->context, (struct RTCRayHit16 *)packet);
    } else if (width == 8) {
        rtcIntersect8(valid, scene, &walk->context, (struct RTCRayHit8 *)packet);
    } else if (width == 4) {
        rtcIntersect4(valid, scene, &walk->context, (struct RTCRayHit4 *)packet);
    } else {
        rtcIntersect1(scene, &walk->context, (struct RTCRayHit *)packet);
    }
}

/* A little before the nearest point of the scene's bounds; before the apex where that is inside. */
static double start_of(const struct mesh_rays *rays, const double apex[3])
{
    double away[3];
    for (int a = 0; a < 3; a++) {
        away[a] = fmax(fmax(rays->low[a] - apex[a], apex[a] - rays->high[a]), 0);
    }
    return vec3_length(away) - rays->slack;
}

conus_status mesh_rays_walk(struct mesh_rays *rays, struct mesh_bundle *bundle, unsigned width)
{
    struct walk walk = {.rays = rays, .bundle = bundle, .start = start_of(rays, bundle->origin)};
    rtcInitIntersectContext(&walk.context);
    walk.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    walk.context.filter = weigh;
    for (size_t first = 0; first < bundle->count; first += width) {
        switch (width) {
        case 16:
            shoot(&walk, first, 16);
            break;
        case 8:
            shoot(&walk, first, 8);
            break;
        case 4:
            shoot(&walk, first, 4);
            break;
        default:
            shoot(&walk, first, 1);
        }
    }
    return embree_status(rays);
}

unsigned mesh_rays_width(const struct mesh_rays *rays, const double apex[3], double pitch)
{
    double middle[3];
    for (int a = 0; a < 3; a++) {
        middle[a] = 0.5 * (rays->low[a] + rays->high[a]) - apex[a];
    }
    return pitch * vec3_length(middle) < rays->cell ? 16 : 1;
}
