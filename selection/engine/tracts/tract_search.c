/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a search for segments begins, and the choice of a kernel. */
#include "selection/engine/tracts/tract_rays.h"

#include "base/geometry/math3.h"
#include "base/simd/processor.h"

#include <string.h>

/* A ray that moves by less than this of a mm per mm along a diagonal does not, as far as boxes are concerned. */
#define STILL 1e-20

/* Two axes across the direction, and the direction. */
static void set_axes(float out[3][3], const double direction[3])
{
    int least = fabs(direction[1]) < fabs(direction[0]) ? 1 : 0;
    least = fabs(direction[2]) < fabs(direction[least]) ? 2 : least;
    double axes[3][3] = {{0}, {least == 0, least == 1, least == 2}};
    memcpy(axes[2], direction, sizeof axes[2]);
    vec3_cross(axes[0], direction, axes[1]);
    vec3_normalise(axes[0], axes[0]);
    vec3_cross(axes[1], direction, axes[0]);
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) {
            out[i][a] = (float)axes[i][a];
        }
    }
}

/* In double, for what is left of a direction that is about square to a diagonal. */
static void set_slopes(float out[TRACT_DIAGONALS], const double direction[3])
{
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        double along = 0;
        for (int a = 0; a < 3; a++) {
            along += tract_diagonal(d, a) * direction[a];
        }
        out[d] = (float)(1 / (fabs(along) > STILL ? along : STILL));
    }
}

void tract_search_init(struct tract_search *out, const struct tractogram *tractogram, const double origin[3],
                       const double direction[3])
{
    out->tractogram = tractogram;
    out->levels = tract_levels_of(tractogram->tree.run_count);
    out->waiting = 0;
    out->aside = 0;
    out->ready = 0;
    out->has_bound = false;
    out->bound = INFINITY;
    if (!tract_start_find(&out->from, tractogram, origin, direction)) {
        return;
    }
    set_axes(out->axes, direction);
    set_slopes(out->slopes, direction);
    /* The root is the one item above all levels. */
    out->visits[out->waiting++] = (struct tract_visit){-out->from.slack, out->levels.count + 1, 0};
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
