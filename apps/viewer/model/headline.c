/* SPDX-License-Identifier: BSD-3-Clause */
/* Words the answer. */
#include "viewer/model/columns.h"

#include "base/path.h"
#include "viewer/model/viewer.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAMED = 3 /* of those that are as good as the best */ };

static bool find_verdict(struct headline *out, struct viewer *viewer)
{
    if (!plans_has_needle(viewer)) {
        return false;
    }
    const struct plan_verdict *verdict = plans_verdict(viewer);
    bool has_target = verdict->reaches[0];
    snprintf(out->what, sizeof out->what, "%s", has_target ? verdict->reaches : verdict->clears);
    snprintf(out->more, sizeof out->more, "%s", has_target && verdict->clears[0] ? verdict->clears : " ");
    out->what[0] = (char)toupper((unsigned char)out->what[0]);
    out->is_of_plan = true;
    return true;
}

/* Whether the answer is of a point, and not of a ball. */
static bool is_point(const struct viewer *viewer)
{
    return viewer->tools[FIRST_TOOL].is_point && !(viewer->cone.options.radius > 0);
}

/* How many of the first results have the share of the best as it is shown. */
static size_t count_best(const struct viewer *viewer, const conus_selection *selection)
{
    const conus_result *best = conus_selection_result(selection, 0);
    const char *score = viewer->cone.options.score;
    bool by_share = !viewer->cone.one_ray && best->pixels && (!score || strcmp(score, "share") == 0);
    char shown[2][SHARE_TEXT];
    size_t count = is_point(viewer) ? conus_selection_count(selection) : 1; /* all are as near */
    headline_share(shown[0], best->share);
    for (bool is_same = by_share; is_same && count < conus_selection_count(selection); count += is_same) {
        const conus_result *next = conus_selection_result(selection, count);
        headline_share(shown[1], next->share);
        is_same = next->object && next->pixels && strcmp(shown[0], shown[1]) == 0;
    }
    return count;
}

/* "A", "A and B", "A, B and C", "A, B, C and 2 more"; with the atlas's name before a number. */
static void name_best(char out[HEADLINE_TEXT], const struct viewer *viewer, const conus_selection *selection,
                      size_t count)
{
    size_t used = 0;
    for (size_t i = 0; i < count && i < NAMED && used < HEADLINE_TEXT; i++) {
        char buffer[VIEW_ATLAS_TITLE];
        const struct view_atlas *view = viewer->drawn;
        const char *before = !i ? "" : i + 1 == count ? " and " : ", ";
        const char *title = view_atlas_title(buffer, view, conus_selection_result(selection, i)->object);
        title = path_title(buffer, VIEW_ATLAS_TITLE, title, view->name[0] ? view->name : view->path);
        used += (size_t)snprintf(out + used, HEADLINE_TEXT - used, "%s%s", before, title);
    }
    if (count > NAMED && used < HEADLINE_TEXT) {
        snprintf(out + used, HEADLINE_TEXT - used, " and %zu more", count - NAMED);
    }
}

/* Where they begin, where a ray goes through them: " \u00b7\u00a027.5 mm from the start", or " \u00b7\u00a027.5 to 28.1
 * mm ..."
 */
static void put_distance(char *out, size_t size, const struct viewer *viewer, const conus_selection *selection,
                         size_t count)
{
    double ends[2] = {INFINITY, -INFINITY};
    char texts[2][32];
    for (size_t i = 0; i < count; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        double distance = result->pixels || viewer->tools[FIRST_TOOL].is_point ? result->distance : result->entry;
        ends[0] = fmin(ends[0], distance);
        ends[1] = fmax(ends[1], distance);
    }
    out[0] = '\0';
    if (isfinite(ends[0]) && isfinite(ends[1])) {
        snprintf(texts[0], sizeof texts[0], "%.1f", ends[0]);
        snprintf(texts[1], sizeof texts[1], "%.1f", ends[1]);
        bool is_one = strcmp(texts[0], texts[1]) == 0;
        snprintf(out, size, " \u00b7\u00a0%s%s%s mm from %s", texts[0], is_one ? "" : " to ", is_one ? "" : texts[1],
                 viewer->tools[FIRST_TOOL].is_point ? "it" : "the start");
    }
}

/* The side that all are on, unless names and places say different ones. */
static const char *side_of(const struct view_atlas *view, const conus_selection *selection, size_t count)
{
    char side = view_atlas_side(view, conus_selection_result(selection, 0)->object);
    for (size_t i = 1; i < count; i++) {
        side = view_atlas_side(view, conus_selection_result(selection, i)->object) == side ? side : ' ';
    }
    return side == 'L' ? " \u00b7\u00a0left" : side == 'R' ? " \u00b7\u00a0right" : "";
}

void headline_find(struct headline *out, struct viewer *viewer)
{
    const conus_selection *selection = viewer_selection(viewer);
    const conus_result *best = conus_selection_count(selection) ? conus_selection_result(selection, 0) : NULL;
    *out = (struct headline){.more = " "};
    if (find_verdict(out, viewer)) {
        return;
    }
    if (!best || !best->object) {
        snprintf(out->what, sizeof out->what, best ? "Nothing is hit" : "No answer yet");
        if (best) {
            snprintf(out->more, sizeof out->more, "no area lies in the %s", viewer_shape(viewer));
        }
        return;
    }
    size_t count = count_best(viewer, selection);
    char share[SHARE_TEXT];
    char distance[128];
    char of[64];
    headline_share(share, best->share);
    snprintf(of, sizeof of, "%s of the %s%s", share, viewer_shape(viewer), count > 1 ? " each" : "");
    put_distance(distance, sizeof distance, viewer, selection, count);
    name_best(out->what, viewer, selection, count);
    const bool is_there = viewer->tools[FIRST_TOOL].is_point && !(best->distance > 0);
    snprintf(out->more, sizeof out->more, "%s%s%s",
             is_point(viewer)                                     ? is_there ? "at the point" : "nearest to the point"
             : viewer->cone.one_ray                               ? "on the axis"
             : best->pixels || viewer->tools[FIRST_TOOL].is_point ? of
                                                                  : "behind others",
             is_there ? "" : distance, side_of(viewer->drawn, selection, count));
}
