/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a search for segments begins, and the choice of a kernel. */
#include "selection/engine/tracts/tract_search.h"

#include "base/math3.h"
#include "base/processor.h"

/* A ray that moves by less than this of a mm per mm along an axis does not, as far as boxes are concerned. */
#define STILL 1e-20

/* Of how far away the ray begins: far above what double precision moves anything by. */
#define FAR_SLACK 1e-12

/* Where the ray is in the box round all capsules; false where it never is. By slabs. */
static bool is_in_bounds(double interval[2], const struct tract_search *search, const double origin[3],
                         const double direction[3])
{
    double grown = (double)search->radius + (double)search->slack;
    interval[0] = 0;
    interval[1] = INFINITY;
    for (int a = 0; a < 3; a++) {
        double low = search->tractogram->low[a] - grown - origin[a];
        double high = search->tractogram->high[a] + grown - origin[a];
        double inverse = fabs(direction[a]) > STILL ? 1 / direction[a] : 1 / STILL;
        interval[0] = fmax(interval[0], fmin(low * inverse, high * inverse));
        interval[1] = fmin(interval[1], fmax(low * inverse, high * inverse));
    }
    return interval[0] <= interval[1];
}

void tract_search_init(struct tract_search *out, const struct tractogram *tractogram, const double origin[3],
                       const double direction[3])
{
    double reach = 0;
    double away = 0;
    double interval[2];
    out->tractogram = tractogram;
    out->levels = tract_levels_of(tractogram->tree.run_count);
    out->waiting = 0;
    out->aside = 0;
    out->ready = 0;
    out->has_bound = false;
    out->bound = INFINITY;
    if (!out->levels.count) {
        return;
    }
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fmax(fabs(tractogram->low[a]), fabs(tractogram->high[a])));
        away = fmax(away, fabs(origin[a]));
    }
    out->radius = (float)tractogram->radius;
    out->slack = (float)(TRACT_SLACK * (reach + tractogram->radius) + FAR_SLACK * away);
    if (!is_in_bounds(interval, out, origin, direction)) {
        return;
    }
    out->start = interval[0];
    for (int a = 0; a < 3; a++) {
        out->origin[a] = (float)(origin[a] + out->start * direction[a]);
        out->direction[a] = (float)direction[a];
        out->inverse[a] = (float)(fabs(direction[a]) > STILL ? 1 / direction[a] : 1 / STILL);
    }
    /* The root is the one item above all levels. */
    out->visits[out->waiting++] = (struct tract_visit){-out->slack, out->levels.count + 1, 0};
}

tract_search_next tract_search_next_plain;
#if defined(__x86_64__)
tract_search_next tract_search_next_avx2;
#endif

tract_search_next *tract_search_kernel(size_t index)
{
#if defined(__x86_64__)
    if (index == 0 && processor_has_avx2()) {
        return tract_search_next_avx2;
    }
#endif
    return index == 1 ? tract_search_next_plain : NULL;
}

tract_search_next *tract_search_best(void)
{
    tract_search_next *best = tract_search_kernel(0);
    return best ? best : tract_search_kernel(1);
}
