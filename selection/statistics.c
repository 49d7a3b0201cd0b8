/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/statistics.h"

#include "base/math3.h"
#include "base/memory.h"

#include <stdlib.h>

/* What is kept of an object while its pixels come by. */
struct gathered {
    uint32_t pixels;
    uint32_t i, j; /* the pixel of its contact so far */
    double weight;
    double radius;           /* r of that pixel */
    double contact_distance; /* and its distance */
    double nearest;
};

void statistics_finish(struct statistics *statistics)
{
    memory_free(statistics->results);
    *statistics = (struct statistics){0};
}

void evidence_position(double out[3], const struct evidence *evidence, const struct cone *cone, uint32_t i, uint32_t j)
{
    double ray[3];
    size_t pixel = (size_t)j * evidence->resolution + i;
    if (!evidence->object[pixel]) {
        out[0] = out[1] = out[2] = NAN;
        return;
    }
    cone_ray(ray, cone, i, j);
    vec3_add_scaled(out, cone->pose.world_from_device + 12, evidence->distance[pixel], ray);
}

/* Eq. 11: smallest r, ties: nearest. */
static bool is_better_contact(const struct gathered *object, double radius, double distance)
{
    return !object->pixels || radius < object->radius ||
           (radius == object->radius && distance < object->contact_distance);
}

static void add_pixel(struct gathered *object, const struct cone *cone, uint32_t i, uint32_t j, double distance)
{
    double radius = cone_radius(cone, i, j);
    if (is_better_contact(object, radius, distance)) {
        object->i = i;
        object->j = j;
        object->radius = radius;
        object->contact_distance = distance;
    }
    object->nearest = object->pixels ? fmin(object->nearest, distance) : distance;
    object->weight += cone_weight(cone, i, j);
    object->pixels++;
}

/* gathered[0] is the unassigned part. Returns the weight of the whole cone. */
static double gather_pixels(struct gathered *gathered, const struct evidence *evidence, const struct cone *cone)
{
    uint32_t n = evidence->resolution;
    double total = 0;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            if (cone_has_pixel(cone, i, j)) {
                size_t pixel = (size_t)j * n + i;
                add_pixel(&gathered[evidence->object[pixel]], cone, i, j, evidence->distance[pixel]);
                total += cone_weight(cone, i, j);
            }
        }
    }
    return total;
}

static conus_result describe(const struct gathered *object, uint32_t number, const struct evidence *evidence,
                             const struct cone *cone, double total)
{
    conus_result result = {.object = number, .pixels = object->pixels, .share = object->weight / total};
    result.center_px = object->radius * cone->resolution / 2;
    result.offset = atan(object->radius * tan(cone->angle / 2));
    result.distance = object->nearest;
    evidence_position(result.contact, evidence, cone, object->i, object->j);
    return result;
}

static conus_result describe_unassigned(const struct gathered *nothing, double total)
{
    return (conus_result){.pixels = nothing->pixels,
                          .share = nothing->weight / total,
                          .center_px = NAN,
                          .offset = NAN,
                          .distance = NAN,
                          .contact = {NAN, NAN, NAN},
                          .score = NAN};
}

conus_status statistics_gather(struct statistics *out, const struct evidence *evidence, const struct cone *cone,
                               size_t object_count)
{
    struct gathered *gathered = memory_zeroed(object_count + 1, sizeof *gathered);
    conus_result *results = NULL;
    size_t count = 0;
    if (!gathered) {
        return CONUS_ERROR_MEMORY;
    }
    double total = gather_pixels(gathered, evidence, cone);
    for (size_t number = 1; number <= object_count; number++) {
        count += gathered[number].pixels > 0;
    }
    results = memory_zeroed(count + 1, sizeof *results);
    if (!results) {
        memory_free(gathered);
        return CONUS_ERROR_MEMORY;
    }
    *out = (struct statistics){results, count + 1};
    for (size_t number = 1; number <= object_count; number++) {
        if (gathered[number].pixels) {
            *results++ = describe(&gathered[number], (uint32_t)number, evidence, cone, total);
        }
    }
    *results = describe_unassigned(&gathered[0], total);
    memory_free(gathered);
    return CONUS_OK;
}
