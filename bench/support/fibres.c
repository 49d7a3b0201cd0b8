/* SPDX-License-Identifier: BSD-3-Clause */
/* Random walks in an ellipsoid, and a bundle of lines and helices. */
#include "bench/support/fibres.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"
#include "selection/cone/aperture.h"

#include <string.h>

enum { SEED = 18, RESOLUTION = 16 };

/* How much a step of 1 mm of a walk may turn away from that before. */
#define TURN 0.15

/* Of all streamlines, from the origin, mm: the half axes of a brain, and those of a box round the helices. */
static const double reach[][3] = {[FIBRES_WALKS] = {70, 90, 60}, [FIBRES_HELICES] = {12, 12, 49.5}};

static bool is_in_brain(const double point[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        sum += point[a] * point[a] / (reach[FIBRES_WALKS][a] * reach[FIBRES_WALKS][a]);
    }
    return sum < 1;
}

static void random_direction(double out[3], uint64_t *random)
{
    do {
        for (int a = 0; a < 3; a++) {
            out[a] = bench_random(random, -1, 1);
        }
    } while (!vec3_normalise(out, out));
}

/* A step of 1 mm, about straight on; where that leaves the brain, to anywhere. */
static void step(double point[3], double direction[3], uint64_t *random)
{
    double turned[3];
    double next[3];
    for (int tries = 0;; tries++) {
        random_direction(turned, random);
        vec3_add_scaled(turned, direction, tries < 20 ? TURN : 2, turned);
        vec3_normalise(turned, turned);
        vec3_add_scaled(next, point, 1, turned);
        if (is_in_brain(next)) {
            memcpy(point, next, sizeof next);
            memcpy(direction, turned, sizeof turned);
            return;
        }
    }
}

static void make_walk(float *points, uint64_t *random)
{
    double point[3];
    double direction[3];
    do {
        for (int a = 0; a < 3; a++) {
            point[a] = bench_random(random, -reach[FIBRES_WALKS][a], reach[FIBRES_WALKS][a]);
        }
    } while (!is_in_brain(point));
    random_direction(direction, random);
    for (int i = 0; i < FIBRES_POINTS; i++) {
        for (int a = 0; a < 3; a++) {
            points[3 * i + a] = (float)point[a];
        }
        step(point, direction, random);
    }
}

/* Number k of `count`: all are spread evenly over the disc, each a golden angle after the one before. */
static void make_helix(float *points, size_t k, size_t count)
{
    const double golden = 2.399963229728653;
    double radius = reach[FIBRES_HELICES][0] * sqrt(((double)k + 0.5) / (double)count);
    double phase = fmod((double)k * golden, 2 * MATH3_PI);
    double turn = k % 2 ? 2 * MATH3_PI / (FIBRES_POINTS - 1) : 0;
    for (int i = 0; i < FIBRES_POINTS; i++) {
        points[3 * i] = (float)(radius * cos(phase + i * turn));
        points[3 * i + 1] = (float)(radius * sin(phase + i * turn));
        points[3 * i + 2] = (float)(i - reach[FIBRES_HELICES][2]);
    }
}

conus_status fibres_make(struct tractogram *out, enum fibres kind, size_t count)
{
    uint64_t random = SEED;
    *out = (struct tractogram){.streamline_count = count, .point_count = count * FIBRES_POINTS, .radius = TRACT_RADIUS};
    out->points = memory_raw(out->point_count, 3 * sizeof *out->points);
    out->first = memory_raw(count + 1, sizeof *out->first);
    if (!out->points || !out->first) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t s = 0; s <= count; s++) {
        out->first[s] = s * FIBRES_POINTS;
    }
    for (size_t s = 0; s < count; s++) {
        float *points = out->points + 3 * s * FIBRES_POINTS;
        if (kind == FIBRES_WALKS) {
            make_walk(points, &random);
        } else {
            make_helix(points, s, count);
        }
    }
    return CONUS_OK;
}

conus_status fibres_cones(struct cone *out, size_t count, enum fibres kind, double degrees)
{
    uint64_t random = SEED + 1;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        double origin[3];
        double target[3];
        double away[3];
        out[i] = (struct cone){.angle = radians_from_degrees(degrees), .resolution = RESOLUTION};
        random_direction(away, &random);
        vec3_scale(origin, away, bench_random(&random, 150, 200));
        for (int a = 0; a < 3; a++) {
            target[a] = bench_random(&random, -reach[kind][a] / 2, reach[kind][a] / 2);
        }
        status = conus_pose_toward(&out[i].pose, origin, target, NULL);
    }
    return status;
}

void fibres_aim(struct fibre_rays *out, const struct cone *cone)
{
    memcpy(out->origin, cone->pose.world_from_device + 12, sizeof out->origin);
    for (uint32_t k = 0; k < TRACT_RAYS_LIMIT; k++) {
        double ray[3];
        cone_ray(ray, cone, aperture_column(k), aperture_row(k));
        for (int a = 0; a < 3; a++) {
            out->direction[a][k] = ray[a];
        }
    }
}

void fibres_walk(struct tract_bundle *hits, const struct tract_rays *rays, const struct fibre_rays *along)
{
    hits->count = TRACT_RAYS_LIMIT;
    hits->origin = along->origin;
    hits->direction = along->direction;
    for (size_t ray = 0; ray < hits->count; ray++) {
        hits->object[ray] = 0;
        hits->t[ray] = (double)INFINITY;
        hits->point[ray] = 0;
    }
    tract_rays_walk(rays, hits);
}
