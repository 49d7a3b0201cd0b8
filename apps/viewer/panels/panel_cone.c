/* SPDX-License-Identifier: BSD-3-Clause */
/* The panel of the cone: score, angle, shape, engine. */
#include "viewer/panels/panels.h"

#include "viewer/hands/hands.h"
#include "viewer/pointing/point.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SCORE_LIMIT = 64 };

static const char *const layers[] = {"visible", "all"};
static const char *const apertures[] = {"circle", "square"};
static const char *const samplings[] = {"exact", "slices"};
static const char *const engines[] = {"rays", "gl"};

static bool choose_score(struct viewer *viewer)
{
    const char *names[SCORE_LIMIT];
    size_t count = 0;
    size_t chosen = 0;
    const conus_score_info *info;
    for (size_t i = 0; count < SCORE_LIMIT && (info = conus_score(i)); i++) {
        if (!info->needs_history) {
            chosen = viewer->cone.options.score && strcmp(viewer->cone.options.score, info->name) == 0 ? count : chosen;
            names[count++] = info->name;
        }
    }
    bool changed = ui_choose("score", &chosen, names, count);
    viewer->cone.options.score = names[chosen];
    return changed;
}

/* Of the mouse's cone: where it begins. */
static void choose_apex(struct viewer *viewer)
{
    static const char *const places[] = {"at the surface", "at your eye"};
    size_t place = viewer->cone.apex_at_eye;
    if (ui_choose("begins", &place, places, 2)) {
        point_use_eye(viewer, place);
    }
    ui_tip("where the mouse's cone has its apex: at the first surface under the mouse, of the context or of an\n"
           "area, or at the eye that looks at the 3-D pane; X changes it");
}

static void choose_follow(struct viewer *viewer)
{
    static const char *const places[] = {"nothing", "the cone's tip", "the best contact"};
    size_t place = (size_t)viewer->cone.follow;
    if (ui_choose("cuts follow", &place, places, FOLLOW_COUNT)) {
        point_follow(viewer, (enum follow)place);
    }
    ui_tip("what the crosshair, and with it the three cuts, go along with; G changes it");
}

/* Whether there is a cone, and not one ray. */
static bool choose_ray(struct viewer *viewer)
{
    bool one_ray = viewer->cone.one_ray;
    if (ui_check("one area only", &one_ray)) {
        point_use_ray(viewer, one_ray);
    }
    ui_tip("in place of the cone a single ray along its axis, which names the area that it hits first; 1 changes it");
    return viewer->cone.one_ray;
}

static bool choose_shape(struct viewer *viewer)
{
    bool changed = ui_slider("angle", &viewer->cone.angle, 0.1, 179, "%.1f\u00b0", true);
    bool cylinder = viewer->cone.options.radius > 0;
    if (ui_check("cylinder instead", &cylinder)) {
        viewer->cone.options.radius = cylinder ? 2 : 0;
        changed = true;
    }
    if (cylinder) {
        changed = ui_slider("radius", &viewer->cone.options.radius, 0.1, 50, "%.1f mm", true) || changed;
    }
    return changed;
}

/* Exact sampling has none, so it has no part of them. */
static bool choose_slices(conus_selector_options *options)
{
    double part = options->slice_fraction > 0 ? options->slice_fraction : 0.2; /* the default, Eq. 7 */
    if (options->sampling == CONUS_SAMPLING_EXACT) {
        options->slice_fraction = 0;
        return false;
    }
    bool changed = ui_slider("slices", &part, 0.01, 1, "%.2f of the picture's", true);
    options->slice_fraction = changed ? part : options->slice_fraction;
    return changed;
}

static bool choose_look(struct viewer *viewer)
{
    conus_selector_options *options = &viewer->cone.options;
    uint32_t resolution = options->resolution ? options->resolution : 16;
    size_t layer = (size_t)options->layers;
    size_t aperture = (size_t)options->aperture;
    size_t sampling = (size_t)options->sampling;
    size_t engine = options->engine == CONUS_ENGINE_GL;
    bool changed = ui_choose("layers", &layer, layers, 2);
    changed = ui_count("pixels", &resolution, 1, 64) || changed;
    changed = ui_choose("aperture", &aperture, apertures, 2) || changed;
    changed = ui_choose("sampling", &sampling, samplings, 2) || changed;
    changed = ui_choose("engine", &engine, engines, 2) || changed;
    options->layers = sampling == CONUS_SAMPLING_SLICES ? CONUS_LAYERS_VISIBLE : (conus_layers)layer;
    options->resolution = resolution;
    options->aperture = (conus_aperture)aperture;
    options->sampling = (conus_sampling)sampling;
    changed = choose_slices(options) || changed;
    options->engine = engine ? CONUS_ENGINE_GL : CONUS_ENGINE_RAYS;
    return changed;
}

static void show_pose(struct viewer *viewer)
{
    const double *m = viewer->cone.pose.world_from_device;
    double origin[3] = {m[12], m[13], m[14]};
    double along[3] = {-m[8], -m[9], -m[10]};
    if (!viewer->cone.has_pose) {
        ui_text("no pose yet");
        return;
    }
    conus_space space = viewer->frame.space;
    char label[32] = "from, mm";
    if (space >= CONUS_SPACE_CCF) {
        snprintf(label, sizeof label, "%s %s %s, %s", conus_space_axis(space, 0), conus_space_axis(space, 1),
                 conus_space_axis(space, 2), conus_space_unit(space));
    }
    conus_frame_from_world(origin, &viewer->frame, origin);
    conus_frame_direction_from_world(along, &viewer->frame, along);
    bool moved = ui_numbers(label, origin, viewer_place_format(viewer));
    bool turned = ui_numbers("along", along, "%.3f");
    if ((moved || turned) && viewer_to_world(origin, viewer, origin)) {
        conus_frame_direction_to_world(along, &viewer->frame, along);
        viewer_aim_along(viewer, origin, along);
    }
}

void panel_cone(struct window *window)
{
    struct viewer *viewer = window->viewer;
    size_t pointer = (size_t)viewer->cone.pointer;
    if (!ui_section("Cone", true)) {
        return;
    }
    if (ui_choose("points", &pointer, hands_pointers, POINTER_COUNT)) {
        hands_choose(window, FIRST_HAND, (enum pointer)pointer);
    }
    panel_source(window);
    if (viewer->cone.pointer == POINT_BY_MOUSE) {
        choose_apex(viewer);
    }
    show_pose(viewer);
    choose_follow(viewer);
    if (!choose_ray(viewer)) {
        bool changed = choose_shape(viewer);
        changed = choose_score(viewer) || changed;
        changed = choose_look(viewer) || changed;
        if (changed) {
            viewer_reselect(viewer);
        }
    }
    if (ui_section("View", false)) {
        bool shown = ui_slider("context", &viewer->display.fade, 0, 1, "%.2f faded", false);
        shown = ui_slider("areas", &viewer->display.fill, 0, 1, "%.2f filled", false) || shown;
        bool outlines = !viewer->display.no_outlines;
        shown = ui_check("outlines", &outlines) || shown;
        viewer->display.no_outlines = !outlines;
        shown = ui_check("radiological (left is right)", &viewer->display.radiological) || shown;
        bool safe = viewer->display.safe_colours;
        if (ui_check("colours for any colour vision", &safe)) {
            viewer_use_safe_colours(viewer, safe);
        }
        viewer->version += shown;
        panel_look_view(viewer);
    }
    panel_transfer(window);
}
