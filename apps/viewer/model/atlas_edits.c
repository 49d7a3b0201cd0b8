/* SPDX-License-Identifier: BSD-3-Clause */
/* What of the atlas itself can be changed while it is shown: thresholds, colours, the context's transfer function. */
#include "viewer/model/viewer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The painter reads the atlas, and so do selectors: they rest while it changes. */
static void rest(struct viewer *viewer)
{
    painter_destroy(viewer->painter);
    viewer_rest_selectors(viewer);
    answer_drop(viewer->cone.answer);
    viewer->painter = NULL;
    viewer->cone.answer = NULL;
    viewer->cone.answer_number++;
}

/* What was edited of the transfer function outlives the painter. */
static bool pass_transfer(const struct viewer *viewer)
{
    const struct transfer_editor *editor = &viewer->transfer_editor;
    return viewer->painter && (!editor->edited || painter_set_transfer(viewer->painter, editor->points, editor->count));
}

static void resume_painter(struct viewer *viewer)
{
    struct painter *painter = NULL;
    if (painter_create(&painter, viewer->atlas, viewer->transfer, viewer->cone.options.log, viewer->wake)) {
        viewer->painter = painter;
        viewer->transfer_editor.ready = false;
    }
    viewer->scene_number++;
    if (!pass_transfer(viewer)) {
        viewer_say(viewer, "not enough memory");
    }
    viewer_reselect(viewer);
}

void viewer_use_transfer(struct viewer *viewer)
{
    viewer->transfer_editor.edited = true;
    if (!pass_transfer(viewer)) {
        viewer_say(viewer, "not enough memory");
    }
    viewer->scene_number++;
    viewer->version++;
}

/* ---- Thresholds and colours ----------------------------------------------------------------------------------------
 */

const conus_volume_info *viewer_pathway(const struct viewer *viewer, uint32_t object)
{
    const conus_object *pathway = conus_atlas_object(viewer->atlas, object);
    bool has_threshold = pathway && pathway->kind == CONUS_KIND_PATHWAY && !pathway->is_band;
    return has_threshold ? conus_atlas_volume(viewer->atlas, pathway->volume) : NULL;
}

void viewer_set_threshold(struct viewer *viewer, uint32_t object, double threshold)
{
    rest(viewer);
    if (conus_atlas_set_threshold(viewer->atlas, object, threshold)) {
        viewer_say(viewer, "%s", conus_message());
    }
    resume_painter(viewer);
}

static void set_colours(struct viewer *viewer, bool safe)
{
    if (safe) {
        conus_atlas_use_safe_colours(viewer->atlas);
    } else {
        conus_atlas_use_own_colours(viewer->atlas);
    }
    viewer->display.safe_colours = safe;
}

void viewer_use_safe_colours(struct viewer *viewer, bool safe)
{
    rest(viewer);
    set_colours(viewer, safe);
    resume_painter(viewer);
}

/* ---- All at once ---------------------------------------------------------------------------------------------------
 */

static bool differ(const struct viewer *viewer, const double *thresholds)
{
    for (uint32_t number = 1; thresholds && number <= viewer->object_count; number++) {
        const conus_volume_info *info = viewer_pathway(viewer, number);
        if (info && info->threshold != thresholds[number]) {
            return true;
        }
    }
    return false;
}

/* Those of pathways before @p end; what they were comes into @p was. */
static conus_status set_thresholds(struct viewer *viewer, double *was, const double *thresholds, uint32_t *end)
{
    conus_status status = CONUS_OK;
    for (uint32_t number = 1; number < *end && !status; number++) {
        const conus_volume_info *info = viewer_pathway(viewer, number);
        if (info) {
            was[number] = info->threshold;
            status = conus_atlas_set_threshold(viewer->atlas, number, thresholds[number]);
            *end = status ? number : *end;
        }
    }
    return status;
}

static conus_status change_thresholds(struct viewer *viewer, const double *thresholds)
{
    uint32_t end = (uint32_t)viewer->object_count + 1;
    double *was = calloc(2 * (size_t)end, sizeof *was);
    if (!was) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = set_thresholds(viewer, was, thresholds, &end);
    if (status && set_thresholds(viewer, was + viewer->object_count + 1, was, &end)) {
        viewer_say(viewer, "not enough memory");
    }
    free(was);
    return status;
}

static void set_points(struct transfer_editor *editor, const struct atlas_edits *settings)
{
    editor->edited = settings->point_count > 0;
    editor->count = settings->point_count;
    memcpy(editor->points, settings->points, sizeof editor->points);
    editor->ready = false;
}

conus_status viewer_set_up(struct viewer *viewer, const struct atlas_edits *settings)
{
    struct transfer_editor *editor = &viewer->transfer_editor;
    bool other = differ(viewer, settings->thresholds);
    bool back = settings->sets_transfer && editor->edited && !settings->point_count;
    bool rests = other || back || settings->safe_colours != viewer->display.safe_colours;
    conus_status status = CONUS_OK;
    if (rests) {
        rest(viewer);
        status = other ? change_thresholds(viewer, settings->thresholds) : CONUS_OK;
    }
    if (!status) {
        set_colours(viewer, settings->safe_colours);
    }
    if (!status && settings->sets_transfer) {
        set_points(editor, settings);
    }
    if (rests) {
        resume_painter(viewer);
    } else if (settings->sets_transfer && editor->edited) {
        viewer_use_transfer(viewer);
    }
    return status;
}
