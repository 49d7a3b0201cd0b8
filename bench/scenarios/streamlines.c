/* SPDX-License-Identifier: BSD-3-Clause */
/* 256 rays into 1,000 to 1,000,000 streamlines (Eq. 18), random walks and helices, by each kernel of the search. */
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"
#include "selection/cone/cone.h"
#include "selection/engine/tracts/tract_rays.h"

#include <stdio.h>
#include <string.h>

enum { SIZES = 4, SMALLEST = 1000, POINTS = 100 /* of each streamline */, SEED = 18 };

/* Random walks in an ellipsoid of a brain's size, where neighbours run in all directions; and straight lines and
 * helices of one turn round the z axis, within 12 mm of it, as `conus phantom bundle` has them, where neighbours run
 * alike. All are in world mm about the origin. */
enum kind { WALKS, HELICES, KINDS };

/* The most by which a step of 1 mm of a walk turns away from the one before. */
#define TURN 0.15

/* How far streamlines reach from the origin, mm: the half axes of a brain, and those of a box round the helices. */
static const double reach[][3] = {[WALKS] = {70, 90, 60}, [HELICES] = {12, 12, 49.5}};

static bool is_in_brain(const double point[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        sum += point[a] * point[a] / (reach[WALKS][a] * reach[WALKS][a]);
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

/* A step of 1 mm, nearly straight on; a step that would leave the brain goes in any direction. */
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
            point[a] = bench_random(random, -reach[WALKS][a], reach[WALKS][a]);
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

/* Helix number k of `count`: all are spread evenly over the disc, each a golden angle after the one before. */
static void make_helix(float *points, size_t k, size_t count)
{
    const double golden = 2.399963229728653;
    double radius = reach[HELICES][0] * sqrt(((double)k + 0.5) / (double)count);
    double phase = fmod((double)k * golden, 2 * MATH3_PI);
    double turn = k % 2 ? 2 * MATH3_PI / (POINTS - 1) : 0;
    for (int i = 0; i < POINTS; i++) {
        points[3 * i] = (float)(radius * cos(phase + i * turn));
        points[3 * i + 1] = (float)(radius * sin(phase + i * turn));
        points[3 * i + 2] = (float)(i - reach[HELICES][2]);
    }
}

/* Streamlines with the default radius, and no tree. To be ended with tractogram_finish(), even if this fails. */
static conus_status make_streamlines(struct tractogram *out, enum kind kind, size_t count)
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
        float *points = out->points + 3 * s * POINTS;
        if (kind == WALKS) {
            make_walk(points, &random);
        } else {
            make_helix(points, s, count);
        }
    }
    return CONUS_OK;
}

/* The rays of a cone. */
struct rays {
    double origin[3];
    double direction[3][TRACT_RAYS_LIMIT]; /* ray k is that of column aperture_column(k) and row aperture_row(k) */
};

/* Cones of 16 x 16 rays, from 150 to 200 mm away, at points within the inner half of all streamlines. */
static conus_status aim_rays(struct rays *out, size_t count, enum kind kind, double degrees)
{
    uint64_t random = SEED + 1;
    for (size_t i = 0; i < count; i++) {
        double away[3], target[3], ray[3];
        struct cone cone = {.angle = radians_from_degrees(degrees), .resolution = BENCH_RESOLUTION};
        random_direction(away, &random);
        vec3_scale(out[i].origin, away, bench_random(&random, 150, 200));
        for (int a = 0; a < 3; a++) {
            target[a] = bench_random(&random, -reach[kind][a] / 2, reach[kind][a] / 2);
        }
        conus_status status = conus_pose_toward(&cone.pose, out[i].origin, target, NULL);
        if (status) {
            return status;
        }
        for (uint32_t k = 0; k < TRACT_RAYS_LIMIT; k++) {
            cone_ray(ray, &cone, aperture_column(k), aperture_row(k));
            for (int a = 0; a < 3; a++) {
                out[i].direction[a][k] = ray[a];
            }
        }
    }
    return CONUS_OK;
}

struct way {
    struct tract_rays *search;
    const struct rays *rays; /* [count] */
    size_t count;
    struct tract_bundle bundle; /* of the last query */
    double sum;                 /* of all distances and points that were hit */
};

static void walk_all(void *data)
{
    struct way *way = data;
    struct tract_bundle *bundle = &way->bundle;
    way->sum = 0;
    for (size_t i = 0; i < way->count; i++) {
        bundle->count = TRACT_RAYS_LIMIT;
        bundle->origin = way->rays[i].origin;
        bundle->direction = way->rays[i].direction;
        for (size_t ray = 0; ray < bundle->count; ray++) {
            bundle->object[ray] = 0;
            bundle->t[ray] = (double)INFINITY;
            bundle->point[ray] = 0;
        }
        tract_rays_trace(way->search, bundle);
        for (size_t ray = 0; ray < bundle->count; ray++) {
            way->sum += bundle->object[ray] ? bundle->t[ray] + (double)bundle->point[ray] : 0;
        }
    }
}

/* The cost of making trees of streamlines. */
struct growth {
    double seconds, bytes; /* of processor time; resident afterwards and not before */
};

static json_t *facts(const struct tractogram *tractogram, const struct growth *growth)
{
    double points = (double)tractogram->point_count;
    double tree = (double)tract_leaf_count(tractogram->tree.run_count) * sizeof(struct tract_leaf);
    tree += (double)tract_mark_count(tractogram->point_count) * sizeof *tractogram->tree.marks;
    tree += (double)tractogram->tree.node_count * sizeof(struct tract_node);
    return json_pack("{s:I, s:f, s:f, s:f}", "streamlines", (json_int_t)tractogram->streamline_count, "build_ms",
                     1000 * growth->seconds, "tree_bytes_per_point", tree / points, "resident_bytes_per_point",
                     growth->bytes / points);
}

/* Measures cones of an angle; @p out_ms becomes the median of the fastest kernel, NAN where the answers differ. */
static conus_status measure(double *out_ms, struct bench *bench, const struct tractogram *tractogram,
                            const struct rays *rays, const char *kind, const struct growth *growth, double degrees)
{
    const struct tract_object object = {.tractogram = tractogram, .number = 1};
    static const char *const names[TRACT_SEARCH_KERNELS] = {"avx2", "plain"};
    struct way ways[TRACT_SEARCH_KERNELS] = {0};
    struct bench_variant variants[TRACT_SEARCH_KERNELS];
    char name[TRACT_SEARCH_KERNELS][64];
    size_t count = 0, poses = bench->options.poses;
    conus_status status = CONUS_OK;
    for (size_t k = 0; k < TRACT_SEARCH_KERNELS && !status; k++) {
        if (!tract_search_kernel(k)) {
            continue;
        }
        struct way *way = &ways[count];
        *way = (struct way){.rays = rays, .count = poses};
        snprintf(name[count], sizeof name[count], "%zu %s, %s", tractogram->streamline_count, kind, names[k]);
        variants[count] = (struct bench_variant){.name = name[count], .run = walk_all, .data = way};
        variants[count].more = facts(tractogram, growth);
        status = tract_rays_create_with(&way->search, tract_search_kernel(k), &object, 1);
        if (!status) {
            walk_all(way);
            variants[count].equal = way->sum == ways[0].sum;
        }
        count++;
    }
    status = status ? status : bench_measure(bench, "streamlines", variants, count, poses, degrees);
    *out_ms = !status && variants[count - 1].equal ? variants[0].median_ms : (double)NAN;
    for (size_t k = 0; k < count; k++) {
        tract_rays_destroy(ways[k].search);
    }
    return status;
}

/* The angles of which streamlines are asked: that of the options, and a wide one. */
enum { GIVEN, WIDE, ANGLES };
static const double wide_deg = 20;

static double angle_of(const struct bench *bench, int angle)
{
    return angle == WIDE ? wide_deg : bench->options.angle;
}

/* Fills in @p out_ms[ANGLES]. */
static conus_status measure_size(double *out_ms, struct bench *bench, enum kind kind, size_t count,
                                 const struct rays *rays)
{
    static const char *const names[] = {[WALKS] = "streamlines", [HELICES] = "helices"};
    char key[64];
    struct tractogram tractogram;
    conus_status status = make_streamlines(&tractogram, kind, count);
    struct growth growth = {bench_cpu(), bench_resident()};
    status = status ? status : tractogram_grow_tree(&tractogram);
    growth = (struct growth){bench_cpu() - growth.seconds, bench_resident() - growth.bytes};
    for (int a = 0; a < ANGLES && !status; a++) {
        status = measure(&out_ms[a], bench, &tractogram, rays + (size_t)a * bench->options.poses, names[kind], &growth,
                         angle_of(bench, a));
    }
    snprintf(key, sizeof key, "%s_cone_ms_%zu", names[kind], count);
    status = status ? status : bench_value(bench, key, out_ms[GIVEN], !isnan(out_ms[GIVEN]));
    tractogram_finish(&tractogram);
    return status;
}

conus_status bench_streamlines(struct bench *bench)
{
    size_t poses = bench->options.poses;
    struct rays *rays = memory_zeroed(ANGLES * poses, sizeof *rays);
    double ms[KINDS][SIZES][ANGLES];
    conus_status status = rays ? CONUS_OK : CONUS_ERROR_MEMORY;
    bench->one_thread = true;
    for (enum kind kind = WALKS; kind < KINDS && !status; kind++) {
        size_t count = SMALLEST;
        for (int a = 0; a < ANGLES && !status; a++) {
            status = aim_rays(rays + (size_t)a * poses, poses, kind, angle_of(bench, a));
        }
        for (int size = 0; size < SIZES && !status; size++, count *= 10) {
            status =
                measure_size(ms[kind][size], bench, kind, bench->options.check ? (size_t)100 << size : count, rays);
        }
    }
    memory_free(rays);
    if (status) {
        return status;
    }
    double ratio = ms[WALKS][SIZES - 1][WIDE] / ms[WALKS][SIZES - 3][WIDE];
    return bench_value(bench, "tracts_million_over_10k", ratio, !isnan(ratio));
}
