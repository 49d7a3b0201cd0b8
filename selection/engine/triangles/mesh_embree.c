/* SPDX-License-Identifier: BSD-3-Clause */
/* The tracer that asks Embree. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/engine/triangles/embree.h"
#include "selection/engine/triangles/mesh_tracer.h"

#include <assert.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

struct embree {
    RTCDevice device;
    RTCScene scene;
    pthread_mutex_t noting;       /* An error: several threads may send rays at once. */
    _Atomic(enum RTCError) error; /* Embree's first. */
    char message[160];            /* Written before it. */
};

static void note_error(void *user, enum RTCError code, const char *message)
{
    struct embree *embree = user;
    pthread_mutex_lock(&embree->noting);
    if (embree->error == RTC_ERROR_NONE) {
        snprintf(embree->message, sizeof embree->message, "%s", message ? message : "no reason given");
        embree->error = code;
    }
    pthread_mutex_unlock(&embree->noting);
}

/* CONUS_OK, or what Embree has complained about so far. */
static conus_status status_of(const struct embree *embree)
{
    const enum RTCError error = embree->error; /* clang takes no atomic enumeration here */
    switch (error) {
    case RTC_ERROR_NONE:
        return CONUS_OK;
    case RTC_ERROR_OUT_OF_MEMORY:
        return fail(CONUS_ERROR_MEMORY, "out of memory for the triangles of the meshes");
    default:
        return fail(CONUS_ERROR_UNSUPPORTED, "Embree: %s", embree->message);
    }
}

/* Embree reads a few bytes behind the last vertex: where there are none, it gets a copy. */
static bool set_positions(RTCGeometry geometry, const struct mesh *mesh)
{
    const size_t size = 3 * sizeof *mesh->positions;
    if (mesh->is_borrowed) {
        rtc.SetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->positions, 0, size,
                                    mesh->vertex_count);
        return true;
    }
    float *positions =
        rtc.SetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, size, mesh->vertex_count);
    if (positions) {
        memcpy(positions, mesh->positions, mesh->vertex_count * size);
    }
    return positions;
}

static conus_status attach_mesh(struct embree *embree, RTCScene scene, const struct mesh *mesh, unsigned number)
{
    RTCGeometry geometry = rtc.NewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (set_positions(geometry, mesh)) {
        rtc.SetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles, 0,
                                    3 * sizeof *mesh->triangles, mesh->triangle_count);
        rtc.CommitGeometry(geometry);
        rtc.AttachGeometryByID(scene, geometry, number);
    }
    rtc.ReleaseGeometry(geometry);
    return status_of(embree);
}

static RTCScene new_scene(const struct embree *embree)
{
    RTCScene scene = rtc.NewScene(embree->device);
    embree_allow_filters(scene);
    return scene;
}

static void release(RTCScene scene)
{
    if (scene) {
        rtc.ReleaseScene(scene);
    }
}

static conus_status attach_all(struct embree *embree, const struct mesh_object *objects, size_t count)
{
    conus_status status = CONUS_OK;
    RTCScene part = NULL;
    const struct mesh *part_of = NULL;
    for (size_t i = 0; i < count && !status; i++) {
        const struct mesh_object *object = &objects[i];
        if (object->mesh && !object->world_from_mesh) {
            status = attach_mesh(embree, embree->scene, object->mesh, (unsigned)i);
        } else if (object->mesh) {
            if (object->mesh != part_of) {
                release(part);
                part = new_scene(embree);
                part_of = object->mesh;
                status = attach_mesh(embree, part, part_of, 0);
                rtc.CommitScene(part);
            }
            float matrix[16];
            for (int k = 0; k < 16; k++) {
                matrix[k] = (float)object->world_from_mesh[k];
            }
            RTCGeometry geometry = rtc.NewGeometry(embree->device, RTC_GEOMETRY_TYPE_INSTANCE);
            rtc.SetGeometryInstancedScene(geometry, part);
            rtc.SetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, matrix);
            rtc.CommitGeometry(geometry);
            rtc.AttachGeometryByID(embree->scene, geometry, (unsigned)i);
            rtc.ReleaseGeometry(geometry);
        }
    }
    release(part);
    rtc.CommitScene(embree->scene);
    return status_of(embree);
}

static void destroy(struct mesh_rays *rays)
{
    struct embree *embree = rays->scene;
    if (embree) {
        release(embree->scene);
        if (embree->device) {
            rtc.ReleaseDevice(embree->device);
        }
        pthread_mutex_destroy(&embree->noting);
        memory_free(embree);
    }
}

conus_status mesh_rays_load_embree(void)
{
    return library_load(&rtc, EMBREE_FUNCTIONS(LIBRARY_NAME), CONUS_EMBREE_FILE,
                        CONUS_EMBREE >= 4 ? "libembree4-4" : "libembree3-3");
}

static conus_status create(struct mesh_rays *rays, const struct mesh_object *objects, size_t count)
{
    struct embree *embree = rays->scene = memory_zeroed(1, sizeof *embree);
    if (!embree) {
        return CONUS_ERROR_MEMORY;
    }
    pthread_mutex_init(&embree->noting, NULL);
    embree->device = rtc.NewDevice("ignore_config_files=1");
    if (!embree->device) {
        note_error(embree, rtc.GetDeviceError(NULL), "no device");
        return status_of(embree);
    }
    rtc.SetDeviceErrorFunction(embree->device, note_error, embree);
    embree->scene = new_scene(embree);
    return attach_all(embree, objects, count);
}

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
    ROWS = 24 /* of the version that has most */
};

union number {
    float real;
    uint32_t whole;
};

static_assert(sizeof(struct RTCRay) == HIT * sizeof(union number) &&
                  sizeof(struct RTCRayHit16) <= ROWS * WIDTH_LIMIT * sizeof(union number) &&
                  offsetof(struct RTCRayHit16, ray.tfar) == FAR * WIDTH_LIMIT * sizeof(float) &&
                  offsetof(struct RTCRayHit16, ray.id) == RAY * WIDTH_LIMIT * sizeof(float) &&
                  offsetof(struct RTCRayHit16, hit.instID) == (HIT + INSTANCE) * WIDTH_LIMIT * sizeof(float),
              "rows of a packet");

/* Embree hands it to weigh() and collect(), as the address of the query, whose context comes first. */
struct tracing {
    struct embree_query query;
    const struct mesh_rays *rays;
    const struct embree *embree;
    struct mesh_bundle *bundle;
    double start; /* mm from the apex to where Embree's rays begin */

    struct mesh_intervals *out; /* of collect() */
    conus_status status;
};

/* One of Embree's findings. */
struct found {
    size_t ray;
    uint32_t object, triangle;
};

static struct found found_by(const struct RTCFilterFunctionNArguments *arguments, unsigned lane)
{
    const union number *rays = (const union number *)arguments->ray;
    const union number *hits = (const union number *)arguments->hit;
    unsigned width = arguments->N;
    uint32_t place = hits[INSTANCE * width + lane].whole;
    uint32_t geometry = hits[GEOMETRY * width + lane].whole;
    return (struct found){.ray = rays[RAY * width + lane].whole,
                          .object = 1 + (place == RTC_INVALID_GEOMETRY_ID ? geometry : place),
                          .triangle = hits[PRIMITIVE * width + lane].whole};
}

static float reach(const struct tracing *tracing, size_t ray)
{
    return (float)mesh_tracer_reach(tracing->rays, tracing->bundle, ray, tracing->start);
}

/* Embree calls this for what it finds before the end of the ray. */
static void weigh(const struct RTCFilterFunctionNArguments *arguments)
{
    struct tracing *tracing = (struct tracing *)arguments->context;
    union number *rays = (union number *)arguments->ray;
    for (unsigned lane = 0; lane < arguments->N; lane++) {
        if (arguments->valid[lane]) {
            struct found found = found_by(arguments, lane);
            if (mesh_tracer_offer(tracing->rays, tracing->bundle, found.ray, found.object, found.triangle)) {
                rays[FAR * arguments->N + lane].real = reach(tracing, found.ray);
            } else {
                arguments->valid[lane] = 0;
            }
        }
    }
}

/* Embree calls this for all that it finds, since nothing of it is accepted. */
static void collect(const struct RTCFilterFunctionNArguments *arguments)
{
    struct tracing *tracing = (struct tracing *)arguments->context;
    for (unsigned lane = 0; lane < arguments->N; lane++) {
        if (arguments->valid[lane]) {
            struct found found = found_by(arguments, lane);
            const struct crossing crossing = {
                .pixel = (uint32_t)found.ray, .object = found.object, .triangle = found.triangle};
            tracing->status = tracing->status ? tracing->status : mesh_intervals_add(tracing->out, &crossing);
            arguments->valid[lane] = 0;
        }
    }
}

static inline __attribute__((always_inline)) void set_ray(const struct tracing *tracing, union number *packet,
                                                          unsigned width, size_t ray)
{
    const struct mesh_bundle *bundle = tracing->bundle;
    for (unsigned a = 0; a < 3; a++) {
        double direction = bundle->direction[a][ray];
        packet[(ORIGIN_X + a) * width].real = (float)(bundle->origin[a] + tracing->start * direction);
        packet[(DIRECTION_X + a) * width].real = (float)direction;
    }
    packet[NEAR * width].real = 0;
    packet[TIME * width].real = 0;
    packet[FAR * width].real = reach(tracing, ray);
    packet[MASK * width].whole = UINT32_MAX;
    packet[RAY * width].whole = (uint32_t)ray;
    packet[FLAGS * width].whole = 0;
}

static inline __attribute__((always_inline)) void shoot(struct tracing *tracing, size_t first, const unsigned width)
{
    _Alignas(64) union number packet[ROWS * WIDTH_LIMIT];
    _Alignas(64) int valid[WIDTH_LIMIT];
    for (unsigned lane = 0; lane < width; lane++) {
        bool used = first + lane < tracing->bundle->count;
        valid[lane] = used ? -1 : 0;
        set_ray(tracing, packet + lane, width, used ? first + lane : first);
        packet[(HIT + GEOMETRY) * width + lane].whole = RTC_INVALID_GEOMETRY_ID;
        packet[(HIT + INSTANCE) * width + lane].whole = RTC_INVALID_GEOMETRY_ID;
    }
    embree_intersect(&tracing->query, tracing->embree->scene, valid, packet, width);
}

static conus_status trace(struct mesh_rays *rays, struct mesh_bundle *bundle, unsigned width)
{
    const struct embree *embree = rays->scene;
    struct tracing tracing = {.rays = rays, .embree = embree, .bundle = bundle};
    tracing.start = mesh_tracer_start(rays, bundle->origin);
    embree_query_init(&tracing.query, weigh, true);
    for (size_t first = 0; first < bundle->count; first += width) {
        switch (width) {
        case 16:
            shoot(&tracing, first, 16);
            break;
        case 8:
            shoot(&tracing, first, 8);
            break;
        case 4:
            shoot(&tracing, first, 4);
            break;
        default:
            shoot(&tracing, first, 1);
        }
    }
    return status_of(embree);
}

/* Embree's search for any hit is enough: all hits are wanted, so none has to be the nearest. */
static conus_status pierce(struct mesh_rays *rays, struct mesh_bundle *bundle, struct mesh_intervals *out)
{
    _Alignas(64) union number stream[MESH_RAYS_LIMIT][HIT];
    const struct embree *embree = rays->scene;
    struct tracing tracing = {.rays = rays, .embree = embree, .bundle = bundle, .out = out};
    tracing.start = mesh_tracer_start(rays, bundle->origin);
    embree_query_init(&tracing.query, collect, false);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        set_ray(&tracing, stream[ray], 1, ray);
    }
    embree_occlude(&tracing.query, embree->scene, (struct RTCRay *)stream, bundle->count, sizeof stream[0]);
    return tracing.status ? tracing.status : status_of(embree);
}

const struct mesh_tracer mesh_embree = {
    .name = "Embree " RTC_VERSION_STRING, .create = create, .destroy = destroy, .trace = trace, .pierce = pierce};
