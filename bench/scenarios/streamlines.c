/* SPDX-License-Identifier: BSD-3-Clause */
/* 256 rays into 1,000 to 1,000,000 streamlines (Eq. 18), random walks and helices, by each kernel of the search. */
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/support/fibres.h"

#include <stdio.h>

enum { SIZES = 4, SMALLEST = 1000 };

struct way {
    struct tract_rays *rays;
    const struct fibre_rays *along;
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
        fibres_walk(bundle, way->rays, &way->along[i]);
        for (size_t ray = 0; ray < bundle->count; ray++) {
            way->sum += bundle->object[ray] ? bundle->t[ray] + (double)bundle->point[ray] : 0;
        }
    }
}

/* What making a tree took. */
struct growth {
    double seconds, bytes; /* of processor time; that lie in memory afterwards and did not before */
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

static conus_status measure(struct bench *bench, const struct tractogram *tractogram, const struct fibre_rays *along,
                            const char *kind, const struct growth *growth)
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
            *way = (struct way){.along = along, .count = bench->options.poses};
            snprintf(name[count], sizeof name[count], "%zu %s, %s", tractogram->streamline_count, kind, names[k]);
            variants[count] = (struct bench_variant){.name = name[count], .run = walk_all, .data = way};
            variants[count].more = facts(tractogram, growth);
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
    snprintf(key, sizeof key, "%s_cone_ms_%zu", kind, tractogram->streamline_count);
    status = status ? status : bench_value(bench, key, variants[0].median_ms, variants[count - 1].equal);
    for (size_t k = 0; k < count; k++) {
        tract_rays_destroy(ways[k].rays);
    }
    return status;
}

static conus_status measure_size(struct bench *bench, enum fibres kind, size_t count, const struct fibre_rays *along)
{
    static const char *const names[] = {[FIBRES_WALKS] = "streamlines", [FIBRES_HELICES] = "helices"};
    struct tractogram tractogram;
    conus_status status = fibres_make(&tractogram, kind, count);
    struct growth growth = {bench_cpu(), bench_resident()};
    status = status ? status : tractogram_grow_tree(&tractogram);
    growth = (struct growth){bench_cpu() - growth.seconds, bench_resident() - growth.bytes};
    status = status ? status : measure(bench, &tractogram, along, names[kind], &growth);
    tractogram_finish(&tractogram);
    return status;
}

conus_status bench_streamlines(struct bench *bench)
{
    size_t poses = bench->options.poses;
    struct cone *cones = memory_zeroed(poses, sizeof *cones);
    struct fibre_rays *along = memory_zeroed(poses, sizeof *along);
    conus_status status = cones && along ? CONUS_OK : CONUS_ERROR_MEMORY;
    bench->one_thread = true;
    for (enum fibres kind = FIBRES_WALKS; kind <= FIBRES_HELICES && !status; kind++) {
        size_t count = SMALLEST;
        status = fibres_cones(cones, poses, kind, bench->options.angle);
        for (size_t i = 0; i < poses; i++) {
            fibres_aim(&along[i], &cones[i]);
        }
        for (int size = 0; size < SIZES && !status; size++, count *= 10) {
            status = measure_size(bench, kind, bench->options.check ? (size_t)100 << size : count, along);
        }
    }
    memory_free(along);
    memory_free(cones);
    return status;
}
