/* SPDX-License-Identifier: BSD-3-Clause */
/* Orders a list as a table has it (conus_order). */
#include "viewer/model/question.h"

#include <math.h>
#include <stdlib.h>

static double depth_of(const conus_result *result, bool by_entry)
{
    double depth = by_entry ? result->entry : result->distance;
    return result->object && isfinite(depth) ? depth : INFINITY;
}

/* Lists come by rank: of equal ones the best stays before. */
static void sort(size_t *order, size_t count, const conus_selection *selection, bool by_entry)
{
    for (size_t i = 0; i < count; i++) {
        double depth = depth_of(conus_selection_result(selection, i), by_entry);
        size_t place = i;
        for (; place && depth_of(conus_selection_result(selection, order[place - 1]), by_entry) > depth; place--) {
            order[place] = order[place - 1];
        }
        order[place] = i;
    }
}

size_t *question_order(const struct viewer *viewer, const conus_selection *selection)
{
    size_t count = conus_selection_count(selection);
    bool by_depth = viewer->cone.order == CONUS_ORDER_DEPTH && count;
    conus_selector_options asked;
    size_t *order = by_depth ? malloc(count * sizeof *order) : NULL;
    viewer_question(&asked, viewer, FIRST_TOOL, 0);
    if (order) {
        sort(order, count, selection, asked.layers == CONUS_LAYERS_ALL);
    }
    return order;
}
