/* SPDX-License-Identifier: BSD-3-Clause */
/* 256 rays into 1,000 to 1,000,000 streamlines (Eq. 18), by each kernel of the search. */
#include "base/math3.h"
#include "base/memory.h"
#include "bench/bench.h"
#include "selection/cone/aperture.h"
#include "selection/engine/tracts/tract_rays.h"

#include <stdio.h>
#include <string.h>

enum { SIZES = 4, SMALLEST = 1000, POINTS = 100, SEED = 18, RESOLUTION = 16 };

/* Half of the axes of a brain, mm; how much a step of 1 mm may turn away from that before. */
static const double half_axes[3] = {70, 90, 60};
#define TURN 0.15

/* Rays of one cone. */
struct query {
    double origin[3];
    double direction[3][TRACT_RAYS_LIMIT];
};

struct way {
    struct tract_rays *rays;
    const struct query *queries;
    size_t count;
    struct tract_bundle bundle; /* of the last query */
    double sum;                 /* of all distances and points that were hit */
};

/* ---- Streamlines ------------------------------------------------------------------------------------------------ */

static bool is_in_brain(const double point[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        sum += point[a] * point[a] / (half_axes[a] * half_axes[a]);
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

static void make_streamline(float *points, uint64_t *random)
{
    double point[3];
    double direction[3];
    do {
        for (int a = 0; a < 3; a++) {
            point[a] = bench_random(random, -half_axes[a], half_axes[a]);
        }
    } while (!is_in_brain(point));
    random_direction(direction, random);
    for (int i = 0; i < POINTS; i++) {
        for (int a = 0; a < 3; a++) {
            points[3 * i + a] = (float)point[a];
        }
        step(point, direction, random);
    }
}

static conus_status make_streamlines(struct tractogram *out, size_t count)
{
    uint64_t random = SEED;
    *out = (struct tractogram){.streamline_count = count, .point_count = count * POINTS, .radius = TRACT_RADIUS};
    out->points = memory_raw(out->point_count, 3 * sizeof *out->points);
    out->first = memory_raw(count + 1, sizeof *out->first);
    if (!out->points || !out->first) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t s = 0; s <= count; s++) {
        out->first[s] = s * POINTS;
    }
    for (size_t s = 0; s < count; s++) {
        make_streamline(out->points + 3 * s * POINTS, &random);
    }
    return CONUS_OK;
}

/* ---- Rays ------------------------------------------------------------------------------------------------------- */

/* Towards the inner half of the brain, from 150 to 200 mm away. */
static conus_status make_queries(struct query *out, size_t count, double degrees)
{
    uint64_t random = SEED + 1;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        double target[3];
        double away[3];
        struct cone cone = {.angle = radians_from_degrees(degrees), .resolution = RESOLUTION};
        random_direction(away, &random);
        vec3_scale(out[i].origin, away, bench_random(&random, 150, 200));
        for (int a = 0; a < 3; a++) {
            target[a] = bench_random(&random, -half_axes[a] / 2, half_axes[a] / 2);
        }
        status = conus_pose_toward(&cone.pose, out[i].origin, target, NULL);
        for (uint32_t k = 0; k < TRACT_RAYS_LIMIT && !status; k++) {
            double ray[3];
            cone_ray(ray, &cone, aperture_column(k), aperture_row(k));
            for (int a = 0; a < 3; a++) {
                out[i].direction[a][k] = ray[a];
            }
        }
    }
    return status;
}

static void walk_all(void *data)
{
    struct way *way = data;
    struct tract_bundle *bundle = &way->bundle;
    way->sum = 0;
    for (size_t i = 0; i < way->count; i++) {
        bundle->count = TRACT_RAYS_LIMIT;
        bundle->origin = way->queries[i].origin;
        bundle->direction = way->queries[i].direction;
        for (size_t ray = 0; ray < bundle->count; ray++) {
            bundle->object[ray] = 0;
            bundle->t[ray] = (double)INFINITY;
            bundle->point[ray] = 0;
        }
        tract_rays_walk(way->rays, bundle);
        for (size_t ray = 0; ray < bundle->count; ray++) {
            way->sum += bundle->object[ray] ? bundle->t[ray] + (double)bundle->point[ray] : 0;
        }
    }
}

/* ---- The scenario ----------------------------------------------------------------------------------------------- */

static json_t *facts(const struct tractogram *tractogram, double build)
{
    double tree = (double)tract_leaf_count(tractogram->tree.run_count) * sizeof(struct tract_leaf);
    tree += (double)tract_mark_count(tractogram->point_count) * sizeof *tractogram->tree.marks;
    tree += (double)tractogram->tree.node_count * sizeof(struct tract_node);
    return json_pack("{s:I, s:f, s:f}", "streamlines", (json_int_t)tractogram->streamline_count, "build_ms",
                     1000 * build, "tree_bytes_per_point", tree / (double)tractogram->point_count);
}

static conus_status measure(struct bench *bench, const struct tractogram *tractogram, const struct query *queries,
                            double build)
{
    const struct tract_object object = {.tractogram = tractogram, .number = 1};
    static const char *const names[TRACT_SEARCH_KERNELS] = {"avx2", "plain"};
    struct way ways[TRACT_SEARCH_KERNELS] = {0};
    struct bench_variant variants[TRACT_SEARCH_KERNELS];
    char name[TRACT_SEARCH_KERNELS][64];
    char key[64];
    size_t count = 0;
    conus_status status = CONUS_OK;
    for (size_t k = 0; k < TRACT_SEARCH_KERNELS && !status; k++) {
        if (tract_search_kernel(k)) {
            struct way *way = &ways[count];
            *way = (struct way){.queries = queries, .count = bench->options.poses};
            snprintf(name[count], sizeof name[count], "%zu streamlines, %s", tractogram->streamline_count, names[k]);
            variants[count] = (struct bench_variant){.name = name[count], .run = walk_all, .data = way};
            variants[count].more = facts(tractogram, build);
            status = tract_rays_create_with(&way->rays, tract_search_kernel(k), &object, 1);
            if (!status) {
                walk_all(way);
                variants[count].equal = way->sum == ways[0].sum;
            }
            count++;
        }
    }
    status = status ? status
                    : bench_measure(bench, "streamlines", variants, count, bench->options.poses, bench->options.angle);
    snprintf(key, sizeof key, "streamlines_cone_ms_%zu", tractogram->streamline_count);
    status = status ? status : bench_value(bench, key, variants[0].median_ms, variants[count - 1].equal);
    for (size_t k = 0; k < count; k++) {
        tract_rays_destroy(ways[k].rays);
    }
    return status;
}

conus_status bench_streamlines(struct bench *bench)
{
    struct query *queries = memory_zeroed(bench->options.poses, sizeof *queries);
    conus_status status = queries ? CONUS_OK : CONUS_ERROR_MEMORY;
    size_t count = SMALLEST;
    bench->one_thread = true;
    status = status ? status : make_queries(queries, bench->options.poses, bench->options.angle);
    for (int size = 0; size < SIZES && !status; size++, count *= 10) {
        struct tractogram tractogram;
        status = make_streamlines(&tractogram, bench->options.check ? (size_t)100 << size : count);
        double start = bench_wall();
        status = status ? status : tractogram_grow_tree(&tractogram);
        status = status ? status : measure(bench, &tractogram, queries, bench_wall() - start);
        tractogram_finish(&tractogram);
    }
    memory_free(queries);
    return status;
}
