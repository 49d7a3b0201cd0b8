/* SPDX-License-Identifier: BSD-3-Clause */
/* Traces bundles of rays through the meshes with Embree. */
#include "selection/engine/mesh_embree.h"

#include "base/math3.h"

#include <assert.h>
#include <stddef.h>

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

/* What Embree hands to weigh() and collect(); the query, whose context comes first, does so here. */
struct walk {
    struct embree_query query;
    const struct mesh_rays *rays;
    struct mesh_bundle *bundle;
    double start; /* mm from the apex to where Embree's rays begin; negative a little behind it */

    struct mesh_intervals *out; /* of collect() */
    conus_status status;
};

/* One of Embree's findings. */
struct found {
    size_t ray;
    uint32_t object, triangle;
};

/* ---- What Embree finds ------------------------------------------------------------------------------------ */

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

static double distance_to(int *side, const struct walk *walk, size_t ray, uint32_t object, uint32_t triangle)
{
    const struct mesh_bundle *bundle = walk->bundle;
    const struct surface *surface = &walk->rays->surfaces[object - 1];
    double direction[3] = {bundle->direction[0][ray], bundle->direction[1][ray], bundle->direction[2][ray]};
    if (!surface->mesh_from_world) {
        return mesh_crossing(side, surface->mesh, triangle, bundle->origin, direction);
    }
    double origin[3];
    mat4_point(origin, surface->mesh_from_world, bundle->origin);
    mat4_direction(direction, surface->mesh_from_world, direction);
    return mesh_crossing(side, surface->mesh, triangle, origin, direction);
}

/* Eq. 9: nearest first; of equally near ones the lower object, then the lower triangle. */
static bool is_first(const struct mesh_bundle *bundle, const struct found *found, double t)
{
    size_t ray = found->ray;
    if (!(t >= 0) || t > bundle->t[ray]) {
        return false;
    }
    return t < bundle->t[ray] || found->object < bundle->object[ray] ||
           (found->object == bundle->object[ray] && found->triangle < bundle->triangle[ray]);
}

/* Where Embree's ray has to look no farther: behind what the ray has hit, and a little more. */
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
    for (unsigned lane = 0; lane < arguments->N; lane++) {
        if (arguments->valid[lane]) {
            struct found found = found_by(arguments, lane);
            int side;
            double t = distance_to(&side, walk, found.ray, found.object, found.triangle);
            if (is_first(bundle, &found, t)) {
                bundle->t[found.ray] = t;
                bundle->object[found.ray] = found.object;
                bundle->triangle[found.ray] = found.triangle;
                rays[FAR * arguments->N + lane].real = reach(walk, found.ray);
            } else {
                arguments->valid[lane] = 0;
            }
        }
    }
}

/* Embree calls this for all that it finds, since nothing of it is accepted. settle() does the rest. */
static void collect(const struct RTCFilterFunctionNArguments *arguments)
{
    struct walk *walk = (struct walk *)arguments->context;
    for (unsigned lane = 0; lane < arguments->N; lane++) {
        if (arguments->valid[lane]) {
            struct found found = found_by(arguments, lane);
            const struct crossing crossing = {
                .pixel = (uint32_t)found.ray, .object = found.object, .triangle = found.triangle};
            walk->status = walk->status ? walk->status : mesh_intervals_add(walk->out, &crossing);
            arguments->valid[lane] = 0;
        }
    }
}

static void fetch_triangle(const struct walk *walk, const struct crossing *crossing)
{
    const struct surface *surface = &walk->rays->surfaces[crossing->object - 1];
    __builtin_prefetch(surface->mesh);
    __builtin_prefetch(surface->triangles + 3 * (size_t)crossing->triangle);
}

static void fetch_corners(const struct walk *walk, const struct crossing *crossing)
{
    const struct surface *surface = &walk->rays->surfaces[crossing->object - 1];
    const uint32_t *corners = surface->triangles + 3 * (size_t)crossing->triangle;
    for (int k = 0; k < 3; k++) {
        __builtin_prefetch(surface->positions + 3 * (size_t)corners[k]);
    }
}

/* Gives the crossings from `first` on their distances and pixels, and drops those behind the apex. Memory is asked for
 * what the next ones need, or the processor would wait for it most of the time. */
static void settle(const struct walk *walk, size_t first, const size_t *pixel)
{
    enum { AHEAD = 8 };
    struct crossing *crossings = walk->out->crossings;
    size_t count = walk->out->count;
    size_t kept = first;
    for (size_t i = first; i < count + 2 * AHEAD; i++) {
        if (i < count) {
            fetch_triangle(walk, &crossings[i]);
        }
        if (i >= first + AHEAD && i < count + AHEAD) {
            fetch_corners(walk, &crossings[i - AHEAD]);
        }
        if (i >= first + 2 * AHEAD) {
            struct crossing crossing = crossings[i - 2 * AHEAD];
            crossing.t = distance_to(&crossing.side, walk, crossing.pixel, crossing.object, crossing.triangle);
            crossing.pixel = (uint32_t)pixel[crossing.pixel];
            crossings[kept] = crossing;
            kept += crossing.t >= 0;
        }
    }
    walk->out->count = kept;
}

/* ---- The rays --------------------------------------------------------------------------------------------- */

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
}

static inline __attribute__((always_inline)) void shoot(struct walk *walk, size_t first, const unsigned width)
{
    _Alignas(64) union number packet[ROWS * WIDTH_LIMIT];
    _Alignas(64) int valid[WIDTH_LIMIT];
    for (unsigned lane = 0; lane < width; lane++) {
        bool used = first + lane < walk->bundle->count;
        valid[lane] = used ? -1 : 0;
        set_ray(walk, packet + lane, width, used ? first + lane : first);
        packet[(HIT + GEOMETRY) * width + lane].whole = RTC_INVALID_GEOMETRY_ID;
        packet[(HIT + INSTANCE) * width + lane].whole = RTC_INVALID_GEOMETRY_ID;
    }
    embree_intersect(&walk->query, walk->rays->scene, valid, packet, width);
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
    embree_query_init(&walk.query, weigh, true);
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
    return mesh_embree_status(rays);
}

/* By Embree's search for any hit, which does not care what is nearest: for all of them there is no need to. */
conus_status mesh_rays_pierce(struct mesh_rays *rays, struct mesh_bundle *bundle, struct mesh_intervals *out,
                              const size_t *pixel)
{
    _Alignas(64) union number stream[MESH_RAYS_LIMIT][HIT];
    struct walk walk = {.rays = rays, .bundle = bundle, .start = start_of(rays, bundle->origin), .out = out};
    size_t first = out->count;
    embree_query_init(&walk.query, collect, false);
    for (size_t ray = 0; ray < bundle->count; ray++) {
        bundle->t[ray] = INFINITY;
        set_ray(&walk, stream[ray], 1, ray);
    }
    embree_occlude(&walk.query, rays->scene, (struct RTCRay *)stream, bundle->count, sizeof stream[0]);
    settle(&walk, first, pixel);
    return walk.status ? walk.status : mesh_embree_status(rays);
}

unsigned mesh_rays_width(const struct mesh_rays *rays, const double apex[3], double pitch)
{
    double middle[3];
    for (int a = 0; a < 3; a++) {
        middle[a] = 0.5 * (rays->low[a] + rays->high[a]) - apex[a];
    }
    return pitch * vec3_length(middle) < rays->cell ? 16 : 1;
}
