/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries query settings before they hold; range, level and order; the options of conus query as words. */
#include "viewer/model/viewer.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/options.h"
#include "settings/settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double first_range = 50; /* mm: about as deep as cortex and white matter of a side */

/* Asks with these options from now on. `options` are without a level; `level`, of the first atlas, is as --level has
 * it, "" = none. False: it was said why not. */
static bool ask_with(struct viewer *viewer, const conus_selector_options *options, const char *level)
{
    struct cone_state *cone = &viewer->cone;
    const struct cone_state before = *cone;
    conus_selector_options asked;
    if (strlen(level) >= LEVEL_LIMIT) {
        viewer_say(viewer, "level: %zu bytes, allowed are %d", strlen(level), LEVEL_LIMIT - 1);
        return false;
    }
    cone->options = *options;
    cone->options.resolution = options->resolution ? options->resolution : CONUS_RESOLUTION_DEFAULT;
    memmove(cone->level, level, strlen(level) + 1); /* it may be this one */
    viewer_query(&asked, viewer, FIRST_TOOL, 0);
    conus_status status = view_atlas_prepare(viewer->atlases, &asked);
    if (status) {
        viewer_say(viewer, "%s", status == CONUS_ERROR_MEMORY ? "not enough memory" : conus_message());
        *cone = before;
        return false;
    }
    tool_reselect(viewer);
    return true;
}

bool query_set_range(struct viewer *viewer, double nearest, double farthest)
{
    conus_selector_options options = viewer->cone.options;
    options.range[0] = nearest;
    options.range[1] = farthest;
    return ask_with(viewer, &options, viewer->cone.level);
}

bool query_move_range(struct viewer *viewer, double nearest, double farthest)
{
    const double *range = viewer->cone.options.range;
    double from = range[1] > 0 ? fmax(range[0] + nearest, 0) : 0;
    double to = range[1] > 0 ? range[1] + farthest : first_range;
    bool fine = query_set_range(viewer, from, to);
    if (fine) {
        viewer_say(viewer, "depths from %.6g to %.6g mm count", from, to);
    }
    return fine;
}

bool query_set_level(struct viewer *viewer, const char *level)
{
    return ask_with(viewer, &viewer->cone.options, level);
}

unsigned query_deepest(const struct viewer *viewer)
{
    const struct view_atlas *first = viewer->atlases;
    unsigned deepest = 0;
    for (size_t number = 1; number <= first->object_count; number++) {
        unsigned depth = conus_atlas_depth(first->atlas, number);
        deepest = depth > deepest ? depth : deepest;
    }
    return deepest > 1 ? deepest : 0;
}

unsigned query_depth(const struct viewer *viewer)
{
    char *end;
    unsigned long depth = strtoul(viewer->cone.level, &end, 10);
    return *end ? 0 : (unsigned)depth;
}

void query_next_level(struct viewer *viewer)
{
    char level[16] = "";
    unsigned depth = query_depth(viewer) + 1;
    unsigned deepest = query_deepest(viewer);
    if (!deepest) {
        viewer_say(viewer, "the atlas has no area tree: none of its areas is part of another");
        return;
    }
    if (depth <= deepest) {
        snprintf(level, sizeof level, "%u", depth);
    }
    if (query_set_level(viewer, level)) {
        viewer_say(viewer, level[0] ? "areas at level %s of %u" : "each area by itself", level, deepest);
    }
}

struct ask_settings {
    struct engine_settings engine;
    struct axis_settings axis;
    struct common_settings common;
};

static const struct option_group groups[] = {
    {"", shape_options, offsetof(struct ask_settings, engine)},
    {"", ray_options, offsetof(struct ask_settings, engine.numbers)},
    {"", pixel_options, offsetof(struct ask_settings, engine)},
    {"", engine_options, offsetof(struct ask_settings, engine)},
    {"", slices_options, offsetof(struct ask_settings, engine)},
    {"", axis_options, offsetof(struct ask_settings, axis)},
    {"", plain_options, offsetof(struct ask_settings, common)},
    {0},
};

static const struct command command = {
    .program = "conus view", .name = "ask", .groups = groups, .settings_size = sizeof(struct ask_settings)};

static bool use_settings(struct viewer *viewer, const struct ask_settings *settings)
{
    if (settings->engine.range.to_target) {
        viewer_say(viewer, "--range: the window has no targets, two numbers NEAR,FAR are needed");
        return false;
    }
    conus_selector_options options = settings_engine(&settings->engine, NULL, &settings->common);
    const char *score = settings->engine.score;
    options.level = NULL;
    options.score = viewer_find_score(score);
    options.log = viewer->cone.options.log;
    if (score && !options.score) {
        print_error_line("ask: --score: \"%s\" is no name of a score", score);
        return false;
    }
    viewer->cone.order = (conus_order)settings->axis.order;
    bool fine = ask_with(viewer, &options, settings->engine.level ? settings->engine.level : "");
    if (!fine) {
        print_error_line("ask: %s", viewer->message);
    }
    return fine;
}

bool query_set_words(struct viewer *viewer, char **words, int count)
{
    struct ask_settings settings = {0};
    struct arguments arguments;
    bool fine = options_parse(&arguments, &settings, &command, NULL, count, words, 1) < 0;
    if (fine && (settings.axis.segments || settings.axis.clearance || settings.axis.contacts)) {
        print_error_line("ask: --segments, --clearance and --contacts are for files, not for the window");
        fine = false;
    }
    fine = fine && settings_check_score(&settings.engine, false);
    conus_order before = viewer->cone.order;
    if (fine && !use_settings(viewer, &settings)) {
        viewer->cone.order = before;
        fine = false;
    }
    options_finish(&settings, &arguments);
    return fine;
}
