/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays through streamlines. */
#include "selection/engine/tracts/tract_rays.h"

#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"

#include <stdlib.h>

/* A tractogram, and the objects of its streamlines. */
struct scene {
    const struct tractogram *tractogram;
    uint32_t of_all;   /* The one object, if it has all streamlines; else 0, and */
    size_t *first;     /* [streamline_count + 1] streamline s is in objects[first[s]] to objects[first[s + 1] - 1], */
    uint32_t *objects; /* ascending. */
};

struct tract_rays {
    tract_search_next *next;
    size_t scene_count;
    struct scene scenes[];
};

void tract_rays_destroy(struct tract_rays *rays)
{
    for (size_t i = 0; rays && i < rays->scene_count; i++) {
        memory_free(rays->scenes[i].first);
        memory_free(rays->scenes[i].objects);
    }
    memory_free(rays);
}

static size_t member_count(const struct tract_object *object)
{
    return object->group ? object->group->count : object->tractogram->streamline_count;
}

static uint32_t member(const struct tract_object *object, size_t index)
{
    return object->group ? object->group->members[index] : (uint32_t)index;
}

/* Makes first[s + 1] one past the last object of streamline s, where first[s] still is the first of them. */
static void deal(struct scene *scene, const struct tract_object *objects, size_t count)
{
    size_t streamlines = scene->tractogram->streamline_count;
    for (size_t k = 0; k < count; k++) {
        for (size_t i = 0; objects[k].tractogram == scene->tractogram && i < member_count(&objects[k]); i++) {
            scene->first[member(&objects[k], i) + 1]++;
        }
    }
    for (size_t s = 0; s < streamlines; s++) {
        scene->first[s + 1] += scene->first[s];
    }
    for (size_t k = count; k-- > 0;) { /* from behind, so that each list is filled from its end */
        for (size_t i = 0; objects[k].tractogram == scene->tractogram && i < member_count(&objects[k]); i++) {
            scene->objects[--scene->first[member(&objects[k], i) + 1]] = objects[k].number;
        }
    }
    for (size_t s = 0; s < streamlines; s++) { /* now first[s + 1] is where streamline s begins */
        scene->first[s] = scene->first[s + 1];
    }
}

static conus_status init_scene(struct scene *scene, const struct tract_object *objects, size_t count)
{
    size_t members = 0;
    const struct tract_object *last = NULL;
    for (size_t k = 0; k < count; k++) {
        if (objects[k].tractogram == scene->tractogram) {
            members += member_count(&objects[k]);
            scene->of_all = last || objects[k].group ? 0 : objects[k].number;
            last = &objects[k];
        }
    }
    if (scene->of_all) {
        return CONUS_OK;
    }
    size_t streamlines = scene->tractogram->streamline_count;
    scene->first = memory_zeroed(streamlines + 1, sizeof *scene->first);
    scene->objects = memory_raw(members, sizeof *scene->objects);
    if (!scene->first || !scene->objects) {
        return CONUS_ERROR_MEMORY;
    }
    deal(scene, objects, count);
    scene->first[streamlines] = members;
    return CONUS_OK;
}

conus_status tract_rays_create(struct tract_rays **out, const struct tract_object *objects, size_t count)
{
    return tract_rays_create_with(out, tract_search_best(), objects, count);
}

conus_status tract_rays_create_with(struct tract_rays **out, tract_search_next *next,
                                    const struct tract_object *objects, size_t count)
{
    struct tract_rays *rays = memory_zeroed(1, sizeof *rays + count * sizeof rays->scenes[0]);
    if (!rays) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = CONUS_OK;
    rays->next = next;
    for (size_t k = 0; k < count; k++) {
        size_t i = 0;
        while (i < rays->scene_count && rays->scenes[i].tractogram != objects[k].tractogram) {
            i++;
        }
        rays->scenes[i].tractogram = objects[k].tractogram;
        rays->scene_count += i == rays->scene_count;
    }
    for (size_t i = 0; i < rays->scene_count && !status; i++) {
        status = init_scene(&rays->scenes[i], objects, count);
    }
    if (status) {
        tract_rays_destroy(rays);
        return status;
    }
    *out = rays;
    return CONUS_OK;
}

/* The objects that the streamline of a point is in. */
static const uint32_t *objects_of(size_t *count, const struct scene *scene, uint64_t point)
{
    if (scene->of_all) {
        *count = 1;
        return &scene->of_all;
    }
    uint32_t streamline = tractogram_streamline_of(scene->tractogram, point);
    *count = scene->first[streamline + 1] - scene->first[streamline];
    return scene->objects + scene->first[streamline];
}

/* A ray in a scene. */
struct ray {
    const struct scene *scene;
    const double *origin;
    double direction[3];
};

static struct ray ray_of(const struct scene *scene, const struct tract_bundle *bundle, size_t index)
{
    return (struct ray){
        scene, bundle->origin, {bundle->direction[0][index], bundle->direction[1][index], bundle->direction[2][index]}};
}

/* Where the ray is in the capsule of segment @p k of a run, clipped to what is before the apex; false = nowhere. */
static bool settle(double interval[2], const struct ray *ray, const struct tract_found *run, uint32_t k)
{
    const struct tractogram *tractogram = ray->scene->tractogram;
    double a[3];
    double b[3];
    tractogram_point(a, tractogram, run->point + k);
    tractogram_point(b, tractogram, run->point + (run->segments ? k + 1 : k));
    if (!capsule_interval(interval, ray->origin, ray->direction, a, b, tractogram->radius) || interval[1] < 0) {
        return false;
    }
    interval[0] = interval[0] > 0 ? interval[0] : 0;
    return true;
}

/* What a ray has hit first so far. */
struct hit {
    uint32_t *object;
    double *t;
    uint64_t *point;
};

static void offer(const struct hit *hit, double t, uint32_t object, uint64_t point)
{
    bool is_lower = object < *hit->object || (object == *hit->object && point < *hit->point);
    if (t < *hit->t || (t == *hit->t && is_lower)) {
        *hit->t = t;
        *hit->object = object;
        *hit->point = point;
    }
}

/* Offers those segments of a run that may be hit. */
static void offer_run(const struct hit *hit, const struct ray *ray, const struct tract_found *run)
{
    size_t count;
    const uint32_t *objects = objects_of(&count, ray->scene, run->point);
    for (uint32_t bits = count ? run->hit : 0; bits; bits &= bits - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(bits);
        double interval[2];
        if (settle(interval, ray, run, k)) {
            offer(hit, interval[0], objects[0], run->point + k);
        }
    }
}

static void trace_ray(const struct tract_rays *rays, const struct scene *scene, struct tract_bundle *bundle,
                      size_t index)
{
    const struct hit hit = {&bundle->object[index], &bundle->t[index], &bundle->point[index]};
    struct ray ray = ray_of(scene, bundle, index);
    struct tract_search search;
    tract_search_init(&search, scene->tractogram, ray.origin, ray.direction);
    search.has_bound = scene->of_all != 0;
    for (struct tract_found found; rays->next(&found, &search, bundle->t[index]);) {
        offer_run(&hit, &ray, &found);
    }
}

void tract_rays_trace(const struct tract_rays *rays, struct tract_bundle *bundle)
{
    for (size_t i = 0; i < rays->scene_count; i++) {
        for (size_t index = 0; index < bundle->count; index++) {
            trace_ray(rays, &rays->scenes[i], bundle, index);
        }
    }
}

static int compare(const void *a, const void *b)
{
    const conus_interval *one = a;
    const conus_interval *other = b;
    if (one->pixel != other->pixel) {
        return one->pixel < other->pixel ? -1 : 1;
    }
    if (one->object != other->object) {
        return one->object < other->object ? -1 : 1;
    }
    if (one->entry != other->entry) {
        return one->entry < other->entry ? -1 : 1;
    }
    return one->voxel < other->voxel ? -1 : one->voxel > other->voxel;
}

/* From the first on, intervals of a pixel and an object that overlap or touch become one. */
static void join(struct layers *layers, size_t first)
{
    size_t kept = first;
    if (layers->count > first) {
        order_sort(layers->intervals + first, layers->count - first, sizeof *layers->intervals, compare);
    }
    for (size_t i = first; i < layers->count; i++) {
        conus_interval interval = layers->intervals[i];
        conus_interval *last = kept > first ? &layers->intervals[kept - 1] : NULL;
        bool is_same = last && last->pixel == interval.pixel && last->object == interval.object;
        if (is_same && interval.entry <= last->exit) {
            last->exit = fmax(last->exit, interval.exit);
        } else {
            layers->intervals[kept++] = interval;
        }
    }
    layers->count = kept;
}

/* Appends the interval of each segment of a run that may be hit, for each object of its streamline. */
static conus_status add_run(struct layers *out, const struct ray *ray, const struct tract_found *run, size_t pixel)
{
    size_t count;
    const uint32_t *objects = objects_of(&count, ray->scene, run->point);
    conus_status status = CONUS_OK;
    for (uint32_t bits = count ? run->hit : 0; bits && !status; bits &= bits - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(bits);
        double interval[2];
        bool is_hit = settle(interval, ray, run, k);
        for (size_t i = 0; i < count && is_hit && !status; i++) {
            conus_interval added = {(uint32_t)pixel, objects[i], interval[0], interval[1], run->point + k};
            status = layers_add(out, &added);
        }
    }
    return status;
}

static conus_status pierce_ray(const struct tract_rays *rays, const struct ray *ray, struct layers *out, size_t pixel)
{
    conus_status status = CONUS_OK;
    struct tract_search search;
    tract_search_init(&search, ray->scene->tractogram, ray->origin, ray->direction);
    for (struct tract_found found; !status && rays->next(&found, &search, INFINITY);) {
        status = add_run(out, ray, &found, pixel);
    }
    return status;
}

conus_status tract_rays_pierce(const struct tract_rays *rays, const struct tract_bundle *bundle, struct layers *out,
                               const size_t *pixel)
{
    conus_status status = CONUS_OK;
    for (size_t index = 0; index < bundle->count && !status; index++) {
        size_t first = out->count;
        for (size_t i = 0; i < rays->scene_count && !status; i++) {
            struct ray ray = ray_of(&rays->scenes[i], bundle, index);
            status = pierce_ray(rays, &ray, out, pixel[index]);
        }
        join(out, first);
    }
    return status;
}
