/* SPDX-License-Identifier: BSD-3-Clause */
/* Changes atlases while they are shown: hidden objects, thresholds, colours, the context's transfer function; and
 * chooses the one that is drawn. */
#include "conus/own.h"
#include "viewer/model/viewer.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The painter reads the atlas, and so do selectors, studies and plans: they rest while it changes. */
static void stop_readers(struct viewer *viewer)
{
    painter_destroy(viewer->painter);
    viewer->painter = NULL;
    studier_hold(viewer->study.studier);
    plan_state_pause(&viewer->plan);
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        view_atlas_invalidate(&viewer->atlases[i]);
        view_atlas_forget(&viewer->atlases[i], FIRST_TOOL);
    }
    viewer->atlas_number++;
    viewer->tools[FIRST_TOOL].answer_number++;
}

/* Edits of the transfer function outlive the painter. */
static void pass_transfer(struct viewer *viewer)
{
    const struct transfer_editor *editor = &viewer->transfer_editor;
    if (!viewer->painter || (editor->edited && !painter_set_transfer(viewer->painter, editor->points, editor->count))) {
        viewer_say(viewer, "not enough memory");
    }
}

/* Replaces the painter. */
static void start_painter(struct viewer *viewer)
{
    painter_destroy(viewer->painter);
    viewer->painter = NULL;
    if (painter_create(&viewer->painter, viewer->drawn->atlas, viewer->preset ? viewer->preset : viewer->transfer,
                       &viewer->drawn->appearance, viewer->cone.options.log, viewer->wake)) {
        viewer->transfer_editor.ready = false;
    }
    viewer->scene_number++;
    pass_transfer(viewer);
}

static void start_readers(struct viewer *viewer)
{
    studier_resume(viewer->study.studier);
    plan_state_resume(&viewer->plan);
    start_painter(viewer);
    tool_reselect(viewer);
}

/* Edits for another context do not apply to this one. */
static void forget_transfer(struct viewer *viewer, const struct view_atlas *before, const struct view_atlas *next)
{
    if (!view_atlas_shares_context(before, next)) {
        viewer->transfer_editor.edited = false;
        viewer->preset = NULL;
    }
}

void viewer_draw(struct viewer *viewer, size_t index)
{
    const struct view_atlas *before = viewer->drawn;
    struct view_atlas *next = &viewer->atlases[index];
    if (next == before) {
        return;
    }
    viewer->drawn = next;
    forget_transfer(viewer, before, next);
    start_painter(viewer);
    viewer->atlas_number++;
    viewer->tools[FIRST_TOOL].answer_number++;
    viewer->version++;
}

void viewer_exchange(struct viewer *viewer, struct view_atlas *fresh)
{
    forget_transfer(viewer, viewer->drawn, &fresh[viewer->drawn - viewer->atlases]);
    stop_readers(viewer);
    studier_destroy(viewer->study.studier);
    study_answer_destroy(viewer->study.answer);
    plan_state_forget(&viewer->plan);
    viewer->study.studier = NULL;
    viewer->study.answer = NULL;
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        struct view_atlas before = viewer->atlases[i];
        viewer->atlases[i] = fresh[i];
        viewer->names[i] = fresh[i].name;
        fresh[i] = before;
        conus_atlas_destroy(before.atlas);
        fresh[i].atlas = NULL;
    }
    viewer_find_ball(viewer);
    start_readers(viewer);
}

/* Anew, for what a renderer is made with. */
static void repaint(struct viewer *viewer)
{
    start_painter(viewer);
    viewer->version++;
}

void viewer_use_preset(struct viewer *viewer, const char *preset)
{
    viewer->preset = preset;
    viewer->transfer_editor.edited = false;
    repaint(viewer);
}

void viewer_use_transfer(struct viewer *viewer)
{
    viewer->transfer_editor.edited = true;
    pass_transfer(viewer);
    viewer->scene_number++;
    viewer->version++;
}

void viewer_set_threshold(struct viewer *viewer, uint32_t object, double threshold)
{
    stop_readers(viewer);
    if (conus_atlas_set_threshold(viewer->drawn->atlas, object, threshold)) {
        viewer_say(viewer, "%s", conus_message());
    }
    start_readers(viewer);
}

static void set_safe_colours(struct viewer *viewer, bool safe)
{
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        if (safe) {
            conus_atlas_use_safe_colours(viewer->atlases[i].atlas);
        } else {
            conus_atlas_use_own_colours(viewer->atlases[i].atlas);
        }
    }
    viewer->display.safe_colours = safe;
}

void viewer_use_safe_colours(struct viewer *viewer, bool safe)
{
    stop_readers(viewer);
    set_safe_colours(viewer, safe);
    start_readers(viewer);
}

void viewer_set_grey(struct viewer *viewer, double black, double white)
{
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        struct view_atlas *view = &viewer->atlases[i];
        if (view == viewer->drawn || view_atlas_shares_context(view, viewer->drawn)) {
            view->appearance.grey[0] = black;
            view->appearance.grey[1] = white;
        }
    }
    viewer->version++;
}

bool viewer_move_grey(struct viewer *viewer, double right, double up)
{
    const struct view_atlas *view = viewer->drawn;
    double grey[2];
    if (!(view->found_grey[1] > view->found_grey[0])) {
        return false;
    }
    memcpy(grey, view_atlas_grey(view), sizeof grey);
    appearance_move_grey(grey, view->found_grey, right, up);
    viewer_set_grey(viewer, grey[0], grey[1]);
    return true;
}

static void pass_opacity(struct viewer *viewer)
{
    if (viewer->painter && !painter_set_opacity(viewer->painter, &viewer->drawn->appearance)) {
        viewer_say(viewer, "not enough memory");
    }
    viewer->scene_number++;
    viewer->version++;
}

void viewer_set_opacity(struct viewer *viewer, uint32_t object, double opacity)
{
    double *list = viewer->drawn->appearance.opacity;
    for (uint32_t number = 1; object && number <= viewer->drawn->object_count; number++) {
        list[number] = viewer_is_below(viewer, number, object) ? opacity : list[number];
    }
    list[0] = object ? list[0] : opacity;
    pass_opacity(viewer);
}

void viewer_set_haze(struct viewer *viewer, uint32_t pathway, size_t haze)
{
    viewer->drawn->appearance.haze[pathway] = (uint8_t)haze;
    repaint(viewer);
}

void viewer_colour_streamlines(struct viewer *viewer, size_t colour)
{
    appearance_colour_streamlines(&viewer->drawn->appearance, viewer->drawn->atlas, colour);
    repaint(viewer);
}

void viewer_set_look(struct viewer *viewer, struct view_atlas *view, struct appearance *appearance)
{
    bool same = appearance_same_tracts(&view->appearance, appearance);
    appearance_finish(&view->appearance);
    view->appearance = *appearance;
    *appearance = (struct appearance){0};
    if (view != viewer->drawn) {
        viewer->version++;
    } else if (same) {
        pass_opacity(viewer);
    } else {
        repaint(viewer);
    }
}

/* Exchanges the first `end` thresholds of all atlases, or those up to one that fails, which `end` counts then. */
static conus_status swap_thresholds(struct viewer *viewer, double *const *thresholds, size_t *end)
{
    size_t at = 0;
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        struct view_atlas *view = &viewer->atlases[i];
        for (uint32_t number = 1; thresholds[i] && number <= view->object_count && at < *end; number++) {
            const conus_volume_info *info = view_atlas_pathway(view, number);
            if (!info) {
                continue;
            }
            const double was = info->threshold;
            const conus_status status = conus_atlas_set_threshold(view->atlas, number, thresholds[i][number]);
            if (status) {
                *end = at;
                return status;
            }
            thresholds[i][number] = was;
            at++;
        }
    }
    return CONUS_OK;
}

/* All of them, or none. */
static conus_status change_thresholds(struct viewer *viewer, double *const *thresholds)
{
    size_t end = SIZE_MAX;
    const conus_status status = swap_thresholds(viewer, thresholds, &end);
    if (status && swap_thresholds(viewer, thresholds, &end)) {
        viewer_say(viewer, "not enough memory");
    }
    return status;
}

conus_status viewer_set_up(struct viewer *viewer, const struct atlas_edits *settings)
{
    struct transfer_editor *editor = &viewer->transfer_editor;
    bool other = false;
    for (size_t i = 0; settings->thresholds && i < viewer->atlas_count; i++) {
        const struct view_atlas *view = &viewer->atlases[i];
        const double *thresholds = settings->thresholds[i];
        for (uint32_t number = 1; thresholds && number <= view->object_count; number++) {
            const conus_volume_info *info = view_atlas_pathway(view, number);
            other = other || (info && info->threshold != thresholds[number]);
        }
    }
    bool back = settings->sets_transfer && editor->edited && !settings->point_count;
    bool preset = settings->sets_transfer && settings->preset != viewer->preset;
    bool rests = other || back || preset || settings->safe_colours != viewer->display.safe_colours;
    conus_status status = CONUS_OK;
    if (rests) {
        stop_readers(viewer);
        status = other ? change_thresholds(viewer, settings->thresholds) : CONUS_OK;
    }
    if (!status) {
        set_safe_colours(viewer, settings->safe_colours);
    }
    if (!status && settings->sets_transfer) {
        viewer->preset = settings->preset;
        editor->edited = settings->point_count > 0;
        editor->count = settings->point_count;
        memcpy(editor->points, settings->points, sizeof editor->points);
        editor->ready = false;
    }
    if (rests) {
        start_readers(viewer);
    } else if (settings->sets_transfer && editor->edited) {
        viewer_use_transfer(viewer);
    }
    return status;
}

/* Hidden objects leave the atlas: they are not hit, not drawn, and block nothing. */
static void hide_in_atlas(struct viewer *viewer, struct view_atlas *view)
{
    if (viewer->painter) {
        painter_hold(viewer->painter);
    }
    studier_hold(viewer->study.studier);
    plan_state_pause(&viewer->plan);
    view_atlas_invalidate(view);
    viewer->atlas_number++;
    if (conus_atlas_set_hidden(view->atlas, view->shown.hidden)) {
        viewer_say(viewer, "%s", conus_message());
        for (size_t number = 1; number <= view->object_count; number++) {
            view->shown.hidden[number] = conus_atlas_is_hidden(view->atlas, number);
        }
    }
    if (viewer->painter) {
        painter_resume(viewer->painter);
    }
    studier_resume(viewer->study.studier);
    plan_state_resume(&viewer->plan);
    viewer->scene_number++;
    tool_reselect(viewer);
}

bool viewer_is_below(const struct viewer *viewer, uint32_t object, uint32_t ancestor)
{
    while (object && object != ancestor) {
        object = conus_atlas_object(viewer->drawn->atlas, object)->parent;
    }
    return object;
}

enum shown viewer_shown(const struct viewer *viewer, uint32_t object)
{
    bool any = false;
    bool all = true;
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        if (viewer_is_below(viewer, number, object)) {
            any = any || !viewer->drawn->shown.hidden[number];
            all = all && !viewer->drawn->shown.hidden[number];
        }
    }
    return all ? SHOWN : any ? SHOWN_IN_PART : SHOWN_NOT;
}

void viewer_hide(struct viewer *viewer, uint32_t object, bool hide)
{
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        if (viewer_is_below(viewer, number, object)) {
            viewer->drawn->shown.hidden[number] = hide;
        }
    }
    hide_in_atlas(viewer, viewer->drawn);
}

void viewer_isolate(struct viewer *viewer, uint32_t object)
{
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        viewer->drawn->shown.hidden[number] = !viewer_is_below(viewer, number, object);
    }
    hide_in_atlas(viewer, viewer->drawn);
}

void viewer_show_all(struct viewer *viewer)
{
    memset(viewer->drawn->shown.hidden, 0, (viewer->drawn->object_count + 1) * sizeof *viewer->drawn->shown.hidden);
    hide_in_atlas(viewer, viewer->drawn);
}

void viewer_set_hidden(struct viewer *viewer, struct view_atlas *view, bool *hidden)
{
    free(view->shown.hidden);
    view->shown.hidden = hidden;
    hide_in_atlas(viewer, view);
}
