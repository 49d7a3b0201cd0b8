/* SPDX-License-Identifier: BSD-3-Clause */
/* dump_tract_hits: first hits of rays on streamlines (Eq. 18), for compare_tract_rays.py. Reads from stdin, in the
 * machine's own numbers: uint64 points, streamlines, blocks; double radius; float points[][3]; uint64 first[]; and for
 * each block of 256 rays double origin[3], directions[3][256]. Writes for each block double t[256], uint64
 * point[256]. */
#include "base/memory.h"
#include "selection/engine/tracts/tract_rays.h"

#include <math.h>
#include <stdio.h>

static bool take(void *out, size_t size, size_t count)
{
    return fread(out, size, count, stdin) == count;
}

static bool take_streamlines(struct tractogram *out)
{
    out->points = memory_raw(out->point_count, 3 * sizeof *out->points);
    out->first = memory_raw(out->streamline_count + 1, sizeof *out->first);
    return out->points && out->first && take(out->points, 3 * sizeof *out->points, out->point_count) &&
           take(out->first, sizeof *out->first, out->streamline_count + 1) && !tractogram_grow_tree(out);
}

static bool answer_block(const struct tract_rays *rays)
{
    double origin[3];
    static double directions[3][TRACT_RAYS_LIMIT];
    static struct tract_bundle bundle;
    if (!take(origin, sizeof origin, 1) || !take(directions, sizeof directions, 1)) {
        return false;
    }
    bundle.count = TRACT_RAYS_LIMIT;
    bundle.origin = origin;
    bundle.direction = (const double(*)[TRACT_RAYS_LIMIT])directions;
    for (size_t ray = 0; ray < TRACT_RAYS_LIMIT; ray++) {
        bundle.object[ray] = 0;
        bundle.t[ray] = (double)INFINITY;
        bundle.point[ray] = UINT64_MAX;
    }
    tract_rays_trace(rays, &bundle);
    return fwrite(bundle.t, sizeof bundle.t, 1, stdout) == 1 &&
           fwrite(bundle.point, sizeof bundle.point, 1, stdout) == 1;
}

int main(void)
{
    struct tractogram tractogram = {0};
    const struct tract_object object = {.tractogram = &tractogram, .number = 1};
    struct tract_rays *rays = NULL;
    uint64_t counts[3] = {0};
    bool ok = take(counts, sizeof counts, 1) && take(&tractogram.radius, sizeof tractogram.radius, 1);
    tractogram.point_count = counts[0];
    tractogram.streamline_count = counts[1];
    ok = ok && take_streamlines(&tractogram) && !tract_rays_create(&rays, &object, 1);
    for (uint64_t block = 0; block < counts[2] && ok; block++) {
        ok = answer_block(rays);
    }
    tract_rays_destroy(rays);
    tractogram_finish(&tractogram);
    return ok ? 0 : 1;
}
