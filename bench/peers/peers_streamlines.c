/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines as tubes by VTK's locators, beside the search along streamlines. A tube of six sides lies within the
 * capsules of Eq. 18: seen from any side, on average, it is 6 sin(pi / 6) * 2 r / pi wide and not 2 r, which is 95.5 %
 * (a convex outline's mean width is its length over pi). So of the rays that hit a streamline that nothing hides, VTK's
 * miss one in 22, and may hit another one behind. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/peers/peers.h"
#include "bench/support/bench.h"
#include "bench/support/fibres.h"
#include "selection/cone/aperture.h"

#include <stdio.h>

enum { SIZES = 3, CONES = 4, PIXELS = PEER_RESOLUTION * PEER_RESOLUTION, SIDES = 6, WAYS = 3 };

/* Both locators of the largest take 4 GB. */
static const size_t sizes[SIZES] = {1000, 3000, 10000};

/* No cone is so far away, mm. */
#define REACH 400.0

/* Making something. */
struct cost {
    double seconds, bytes; /* of processor time; that lie in memory afterwards and did not before */
};

struct way {
    const struct tractogram *tractogram;
    struct tract_rays *rays; /* where it is that one */
    struct peer_tubes *tubes;
    enum peer_locator kind;
    const struct cone *cones;            /* [CONES] */
    uint32_t streamlines[CONES][PIXELS]; /* numbers from 1; 0 = none */
    struct cost cost;
    conus_status status;
};

static struct cost begin(void)
{
    return (struct cost){bench_cpu(), bench_resident()};
}

static struct cost end(struct cost before)
{
    return (struct cost){bench_cpu() - before.seconds, bench_resident() - before.bytes};
}

static void answer_by_rays(struct way *way)
{
    for (size_t i = 0; i < CONES; i++) {
        struct fibre_rays along;
        struct tract_bundle hits;
        fibres_aim(&along, &way->cones[i]);
        fibres_walk(&hits, way->rays, &along);
        for (uint32_t k = 0; k < PIXELS; k++) {
            size_t pixel = (size_t)aperture_row(k) * PEER_RESOLUTION + aperture_column(k);
            way->streamlines[i][pixel] =
                hits.object[k] ? tractogram_streamline_of(way->tractogram, hits.point[k]) + 1 : 0;
        }
    }
}

static void answer(void *data)
{
    struct way *way = data;
    if (way->rays) {
        answer_by_rays(way);
        return;
    }
    for (size_t i = 0; i < CONES; i++) {
        conus_status status = peer_tubes_trace(way->tubes, way->streamlines[i], &way->cones[i], REACH, way->kind);
        way->status = status ? status : way->status;
    }
}

/* Of rays that hit a streamline by the search along them: as tubes they hit the same one, another one or none. */
struct agreement {
    size_t hits, same, none;
    size_t only; /* other rays, which hit a tube */
};

static struct agreement compare(const struct way *way, const struct way *rays)
{
    struct agreement sum = {0};
    for (size_t i = 0; i < (size_t)CONES * PIXELS; i++) {
        uint32_t here = rays->streamlines[i / PIXELS][i % PIXELS];
        uint32_t there = way->streamlines[i / PIXELS][i % PIXELS];
        sum.hits += here > 0;
        sum.same += here && here == there;
        sum.none += here && !there;
        sum.only += !here && there;
    }
    return sum;
}

/* What tubes that lie within capsules can answer: a ray beside all capsules hits none, but for single precision, and
 * most others hit the same. */
static bool is_plausible(struct agreement agreement)
{
    return agreement.hits > 0 && 1000 * agreement.only <= agreement.hits && 10 * agreement.same >= 8 * agreement.hits;
}

static json_t *describe(const char *name, const struct way *way, struct agreement agreement)
{
    double all = fmax(1, (double)agreement.hits);
    double same = (double)agreement.same / all;
    double none = (double)agreement.none / all;
    printf("%s: %.0f ms and %.1f MB; of %zu rays that hit a streamline %.1f %% hit the same, %.1f %% none; %zu others "
           "hit one\n",
           name, 1000 * way->cost.seconds, way->cost.bytes / 1e6, agreement.hits, 100 * same, 100 * none,
           agreement.only);
    return json_pack("{s:I, s:f, s:f, s:I, s:f, s:f}", "hits", (json_int_t)agreement.hits, "same_streamline", same,
                     "no_streamline", none, "only_tubes", (json_int_t)agreement.only, "build_ms",
                     1000 * way->cost.seconds, "resident_bytes", way->cost.bytes);
}

/* One tractogram. */
struct contest {
    struct tractogram tractogram;
    struct cone cones[CONES];
    struct way ways[WAYS];
    char names[WAYS][64];
    struct bench_variant variants[WAYS];
};

static conus_status make_rays(struct contest *contest)
{
    const struct tract_object object = {.tractogram = &contest->tractogram, .number = 1};
    struct way *way = &contest->ways[0];
    struct cost before = begin();
    conus_status status = tractogram_grow_tree(&contest->tractogram);
    status = status ? status : tract_rays_create(&way->rays, &object, 1);
    way->cost = end(before);
    return status;
}

/* Tubes for both locators, whose cost is theirs and that of the tubes. */
static conus_status make_tubes(struct contest *contest)
{
    struct peer_tubes *tubes = NULL;
    struct cost before = begin();
    conus_status status = peer_tubes_create(&tubes, &contest->tractogram, SIDES);
    struct cost making = end(before);
    contest->ways[1].tubes = contest->ways[2].tubes = tubes;
    for (size_t w = 1; w < WAYS && !status; w++) {
        struct way *way = &contest->ways[w];
        way->kind = w == 1 ? PEER_CELL_LOCATOR : PEER_STATIC_LOCATOR;
        before = begin();
        status = peer_tubes_build(tubes, way->kind);
        way->cost = end(before);
        way->cost.seconds += making.seconds;
        way->cost.bytes += making.bytes;
    }
    return status;
}

static conus_status measure_ways(struct bench *bench, struct contest *contest)
{
    static const char *const names[WAYS] = {"search along streamlines", "vtkCellLocator", "vtkStaticCellLocator"};
    size_t count = contest->tractogram.streamline_count;
    conus_status status = CONUS_OK;
    for (size_t w = 0; w < WAYS && !status; w++) {
        struct way *way = &contest->ways[w];
        answer(way);
        struct agreement agreement = compare(way, &contest->ways[0]);
        snprintf(contest->names[w], sizeof contest->names[w], "%zu streamlines, %s", count, names[w]);
        contest->variants[w] = (struct bench_variant){.name = contest->names[w], .run = answer, .data = way};
        contest->variants[w].equal = is_plausible(agreement);
        contest->variants[w].more = describe(contest->names[w], way, agreement);
        status = way->status;
    }
    status = status ? status
                    : bench_measure(bench, "peers_streamlines", contest->variants, WAYS, CONES, bench->options.angle);
    for (size_t w = 1; w < WAYS && !status; w++) {
        char key[64];
        snprintf(key, sizeof key, "%s_over_search_%zu", w == 1 ? "vtkcelllocator" : "vtkstaticlocator", count);
        status = bench_ratio(bench, key, &contest->variants[w], &contest->variants[0]);
    }
    return status;
}

static conus_status run_contest(struct bench *bench, struct contest *contest, enum fibres kind, size_t count)
{
    conus_status status = fibres_make(&contest->tractogram, kind, count);
    status = status ? status : fibres_cones(contest->cones, CONES, kind, bench->options.angle);
    for (size_t w = 0; w < WAYS; w++) {
        contest->ways[w].tractogram = &contest->tractogram;
        contest->ways[w].cones = contest->cones;
    }
    status = status ? status : make_rays(contest);
    status = status ? status : make_tubes(contest);
    status = status ? status : measure_ways(bench, contest);
    peer_tubes_destroy(contest->ways[1].tubes);
    tract_rays_destroy(contest->ways[0].rays);
    tractogram_finish(&contest->tractogram);
    return status;
}

conus_status bench_peers_streamlines(struct bench *bench)
{
    conus_status status = CONUS_OK;
    bench->one_thread = true;
    snprintf(bench->driver, sizeof bench->driver, "%s", peer_version());
    for (size_t i = 0; i < SIZES && !status; i++) {
        struct contest *contest = memory_zeroed(1, sizeof *contest);
        status = contest ? run_contest(bench, contest, FIBRES_WALKS, bench_size(&bench->options, sizes[i]))
                         : CONUS_ERROR_MEMORY;
        memory_free(contest);
    }
    return status;
}
