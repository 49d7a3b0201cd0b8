/* SPDX-License-Identifier: BSD-3-Clause */
/* The panel of the cone: score, angle, shape, engine. */
#include "viewer/panes/panels.h"

#include "viewer/tools/point.h"

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
    ui_tip("by what the hits are ranked, the best first: conus query --help says what each means");
    viewer->cone.options.score = names[chosen];
    return changed;
}

/* Of the mouse's cone: where it begins. */
static void choose_apex(struct window *window)
{
    static const char *const places[] = {"at the surface", "at your eye"};
    size_t place = window->viewer->cone.apex_at_eye;
    if (ui_choose("begins", &place, places, 2)) {
        property_set(window, PROPERTY_APEX_AT_EYE, (double)place);
    }
    panel_tip(PROPERTY_APEX_AT_EYE);
}

static void choose_follow(struct window *window)
{
    static const char *const places[] = {"nothing", "the cone's tip", "the best contact"};
    size_t place = (size_t)window->viewer->cone.follow;
    if (ui_choose("cuts follow", &place, places, FOLLOW_COUNT)) {
        property_set(window, PROPERTY_FOLLOW, (double)place);
    }
    panel_tip(PROPERTY_FOLLOW);
}

/* Whether there is a cone, and not one ray. */
static bool choose_ray(struct window *window)
{
    bool one_ray = window->viewer->cone.one_ray;
    if (ui_check("one area only", &one_ray)) {
        property_set(window, PROPERTY_ONE_RAY, one_ray);
    }
    panel_tip(PROPERTY_ONE_RAY);
    return window->viewer->cone.one_ray;
}

static bool choose_shape(struct viewer *viewer)
{
    bool changed = ui_slider("angle", &viewer->tools[FIRST_TOOL].angle, 0.1, 179, "%.1f\u00b0", true);
    panel_tip(PROPERTY_ANGLE);
    bool cylinder = viewer->cone.options.radius > 0;
    if (ui_check("cylinder instead", &cylinder)) {
        viewer->cone.options.radius = cylinder ? 2 : 0;
        changed = true;
    }
    ui_tip("in place of the cone a tube around its axis, such as a needle or a probe");
    if (cylinder) {
        changed = ui_slider("radius", &viewer->cone.options.radius, 0.1, 50, "%.1f mm", true) || changed;
        ui_tip("radius of the cylinder, mm");
    }
    return changed;
}

/* Exact sampling has none, so it has no part of them. */
static bool choose_slices(conus_selector_options *options)
{
    double part = options->slice_fraction > 0 ? options->slice_fraction : 0.2; /* the default, Eq. 7 */
    if (options->sampling == CONUS_SAMPLING_EXACT) {
        options->slice_fraction = 0;
        options->slices = 0;
        return false;
    }
    bool changed = ui_slider("slices", &part, 0.01, 1, "%.2f of the picture's", true);
    ui_tip("which part of the picture's slices the cone asks at (--slice-fraction)");
    options->slice_fraction = changed ? part : options->slice_fraction;
    options->range[0] = options->range[1] = 0; /* needs exact sampling */
    changed = ui_count("picture's slices", &options->slices, 0, 2048) || changed;
    ui_tip("how many slices the picture has (--slices); 0 = 1.41 times the longest edge of the volume, in voxels");
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
    panel_tip(PROPERTY_LAYERS);
    changed = ui_count("pixels", &resolution, 1, 64) || changed;
    ui_tip("N, of N x N rays, one per pixel of the image that the device sees");
    changed = ui_choose("aperture", &aperture, apertures, 2) || changed;
    ui_tip("the pixels that count: those in the circle, or all of the square");
    changed = ui_choose("sampling", &sampling, samplings, 2) || changed;
    ui_tip("every voxel along a ray, or planes across the view only, which can miss thin objects");
    changed = ui_choose("engine", &engine, engines, 2) || changed;
    ui_tip("what traces the rays, the processor or OpenGL: the hits are the same");
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
    const double *m = viewer->tools[FIRST_TOOL].pose.world_from_device;
    double origin[3] = {m[12], m[13], m[14]};
    double along[3] = {-m[8], -m[9], -m[10]};
    if (!viewer->tools[FIRST_TOOL].has_pose) {
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
    ui_tip("where the cone has its apex, in the unit of the label beside it; type numbers and press Enter");
    bool turned = ui_numbers("along", along, "%.3f");
    ui_tip("the direction of the cone's axis, of any length; type numbers and press Enter");
    if ((moved || turned) && viewer_to_world(origin, viewer, origin)) {
        conus_frame_direction_to_world(along, &viewer->frame, along);
        tool_aim_along(viewer, FIRST_TOOL, origin, along);
    }
}

void panel_cone(struct window *window)
{
    struct viewer *viewer = window->viewer;
    size_t pointer = (size_t)viewer->tools[FIRST_TOOL].pointer;
    if (!ui_section("Cone", true)) {
        return;
    }
    if (ui_choose("points", &pointer, pointer_names, POINTER_COUNT)) {
        tool_choose(window->viewer, FIRST_TOOL, (enum pointer)pointer);
    }
    ui_tip("what moves the cone: the mouse, keys, a file of poses, or a tracked tool");
    panel_source(window);
    if (viewer->tools[FIRST_TOOL].pointer == POINT_BY_MOUSE) {
        choose_apex(window);
    }
    show_pose(viewer);
    choose_follow(window);
    if (!choose_ray(window)) {
        bool changed = choose_shape(viewer);
        changed = choose_score(viewer) || changed;
        changed = choose_look(viewer) || changed;
        if (changed) {
            viewer_reselect(viewer);
        }
    }
    panel_question(window);
    if (ui_section("View", false)) {
        bool shown = ui_slider("context", &viewer->display.fade, 0, 1, "%.2f faded", false);
        panel_tip(PROPERTY_FADE);
        shown = ui_slider("areas", &viewer->display.fill, 0, 1, "%.2f filled", false) || shown;
        panel_tip(PROPERTY_FILL);
        bool outlines = !viewer->display.no_outlines;
        shown = ui_check("outlines", &outlines) || shown;
        panel_tip(PROPERTY_OUTLINES);
        viewer->display.no_outlines = !outlines;
        shown = ui_check("radiological (left is right)", &viewer->display.radiological) || shown;
        panel_tip(PROPERTY_RADIOLOGICAL);
        bool safe = viewer->display.safe_colours;
        if (ui_check("colours for any colour vision", &safe)) {
            viewer_use_safe_colours(viewer, safe);
        }
        panel_tip(PROPERTY_SAFE_COLOURS);
        viewer->version += shown;
        panel_look_view(viewer);
    }
    panel_transfer(window);
}
