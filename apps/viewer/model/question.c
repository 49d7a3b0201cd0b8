/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries a question before it is asked; range, level and order. */
#include "viewer/model/question.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double first_range = 50; /* mm: about as deep as cortex and white matter of a side */

static void say_reason(struct viewer *viewer, conus_status status)
{
    viewer_say(viewer, "%s", status == CONUS_ERROR_MEMORY ? "not enough memory" : conus_message());
}

bool question_use(struct viewer *viewer, const conus_selector_options *options, const char *level)
{
    struct cone_state *cone = &viewer->cone;
    const struct cone_state before = *cone;
    conus_selector_options asked;
    if (strlen(level) >= LEVEL_LIMIT) {
        viewer_say(viewer, "level: %zu bytes, allowed are %d", strlen(level), LEVEL_LIMIT - 1);
        return false;
    }
    cone->options = *options;
    memmove(cone->level, level, strlen(level) + 1); /* it may be this one */
    viewer_question(&asked, viewer, FIRST_TOOL, 0);
    conus_status status = view_atlas_prepare(viewer->atlases, &asked);
    if (status) {
        say_reason(viewer, status);
        *cone = before;
        return false;
    }
    viewer_reselect(viewer);
    return true;
}

bool question_set_range(struct viewer *viewer, double nearest, double farthest)
{
    conus_selector_options options = viewer->cone.options;
    options.range[0] = nearest;
    options.range[1] = farthest;
    return question_use(viewer, &options, viewer->cone.level);
}

bool question_move_range(struct viewer *viewer, double nearest, double farthest)
{
    const double *range = viewer->cone.options.range;
    double from = range[1] > 0 ? fmax(range[0] + nearest, 0) : 0;
    double to = range[1] > 0 ? range[1] + farthest : first_range;
    bool fine = question_set_range(viewer, from, to);
    if (fine) {
        viewer_say(viewer, "depths from %.6g to %.6g mm count", from, to);
    }
    return fine;
}

bool question_set_level(struct viewer *viewer, const char *level)
{
    return question_use(viewer, &viewer->cone.options, level);
}

unsigned question_deepest(const struct viewer *viewer)
{
    const struct view_atlas *first = viewer->atlases;
    unsigned deepest = 0;
    for (size_t number = 1; number <= first->object_count; number++) {
        unsigned depth = conus_atlas_depth(first->atlas, number);
        deepest = depth > deepest ? depth : deepest;
    }
    return deepest > 1 ? deepest : 0;
}

unsigned question_depth(const struct viewer *viewer)
{
    char *end;
    unsigned long depth = strtoul(viewer->cone.level, &end, 10);
    return *end ? 0 : (unsigned)depth;
}

void question_next_level(struct viewer *viewer)
{
    char level[16] = "";
    unsigned depth = question_depth(viewer) + 1;
    unsigned deepest = question_deepest(viewer);
    if (!deepest) {
        viewer_say(viewer, "the atlas has no area tree: none of its areas is part of another");
        return;
    }
    if (depth <= deepest) {
        snprintf(level, sizeof level, "%u", depth);
    }
    if (question_set_level(viewer, level)) {
        viewer_say(viewer, level[0] ? "areas at level %s of %u" : "each area by itself", level, deepest);
    }
}
