/* SPDX-License-Identifier: BSD-3-Clause */
/* Ranks the results of a selection. Some scores of Eq. 12 need more than results: the box around the atlas, and which
 * objects touch the aperture's rim. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/selection.h"

#include <string.h>

conus_status selector_prepare_box(conus_selector *selector)
{
    conus_status status =
        selector->has_box ? CONUS_OK : conus_atlas_bounds(selector->box[0], selector->box[1], selector->atlas);
    selector->has_box = !status;
    return status;
}

conus_status selector_prepare_border(conus_selector *selector)
{
    if (!selector->ranking.needs_border) {
        return CONUS_OK;
    }
    selector->on_border = memory_zeroed(selector->atlas->object_count + 1, sizeof *selector->on_border);
    return selector->on_border ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status selector_prepare_ranking(conus_selector *selector)
{
    conus_status status = ranking_parse(&selector->ranking, selector->options.score);
    selector->options.score = NULL;
    if (status) {
        return status;
    }
    if (selector->ranking.info.needs_layers && selector->options.layers != CONUS_LAYERS_ALL) {
        return fail(CONUS_ERROR_ARGUMENT, "score: %s needs all layers", selector->ranking.formula.text);
    }
    if (selector->ranking.needs_box) { /* of an empty atlas it stays 0: nothing is hit */
        (void)selector_prepare_box(selector);
    }
    return selector_prepare_border(selector);
}

/* From the apex to the nearest point of the box, and to its farthest corner. */
static void measure_box(struct score_view *view, const double box[2][3], const double apex[3])
{
    double near[3];
    double far[3];
    for (int a = 0; a < 3; a++) {
        near[a] = fmax(0, fmax(box[0][a] - apex[a], apex[a] - box[1][a]));
        far[a] = fmax(fabs(box[0][a] - apex[a]), fabs(box[1][a] - apex[a]));
    }
    view->near = vec3_length(near);
    view->far = vec3_length(far);
}

/* Marks the objects of pixels at the border. */
static void mark_border(bool *on_border, const conus_selection *selection)
{
    const uint32_t n = selection->cone.resolution;
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        if (aperture_is_border(selection->in_cone, n, pixel)) {
            on_border[selection->evidence.object[pixel]] = true;
        }
    }
}

void selection_rank(conus_selection *selection, conus_selector *selector, const struct history *history)
{
    struct score_view view = {.cone = &selection->cone, .on_border = selector->on_border, .history = history};
    for (size_t i = 0; i < selection->statistics.count; i++) {
        view.cone_pixels += selection->statistics.results[i].pixels;
    }
    if (selector->ranking.needs_box) {
        measure_box(&view, (const double(*)[3])selector->box, selection->cone.pose.world_from_device + 12);
    }
    if (selector->on_border) {
        mark_border(selector->on_border, selection);
    }
    score_rank(&selection->statistics, &selector->ranking, &view);
    if (selector->on_border) {
        for (size_t i = 0; i < selection->statistics.count; i++) {
            selector->on_border[selection->statistics.results[i].object] = false;
        }
    }
}
