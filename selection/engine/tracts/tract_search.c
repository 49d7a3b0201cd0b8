/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a search for segments begins, and the choice of a kernel. */
#include "selection/engine/tracts/tract_search.h"

#include "base/processor.h"

#include <math.h>

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
