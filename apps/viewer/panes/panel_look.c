/* SPDX-License-Identifier: BSD-3-Clause */
/* How the atlas looks: the view, an area, the context's grey values, pathways and streamlines. */
#include "viewer/panes/panes.h"

#include "base/look.h"
#include "conus/own.h"
#include "viewer/ui/ui.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const double least_pale = 0.02; /* what should not be seen at all is hidden */

static void look_at_view(struct window *window)
{
    static const enum property_id shown[] = {PROPERTY_FADE,         PROPERTY_FILL,         PROPERTY_OUTLINES,
                                             PROPERTY_RADIOLOGICAL, PROPERTY_SAFE_COLOURS, PROPERTY_OWN_COLOURS};
    double rest = window->viewer->drawn->appearance.opacity[0];
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++) {
        panel_property(window, shown[i]);
    }
    if (ui_slider(
            "Not hit", &rest, least_pale, 1, "opacity %.2f", false,
            "opacity in 3-D, 0 to 1, of the areas that the cone does not hit; , and . change it where no area is\n"
            "chosen. It is of the picture only: what is not hidden is hit")) {
        viewer_set_opacity(window->viewer, 0, rest);
    }
    panel_property(window, PROPERTY_BACKGROUND);
    static const char *const themes[THEME_COUNT] = {[THEME_DARK] = "dark", [THEME_LIGHT] = "light"};
    size_t theme = theme_used();
    if (ui_choose("Theme", &theme, themes, THEME_COUNT,
                  "of this window until it is closed; else as the desktop says, or --theme")) {
        theme_use((enum theme)theme);
        window->screen.next_scale = window->screen.scale; /* makes the widgets anew */
    }
}

/* Widens the sliders to values that were dragged beyond those of the image. */
static void edit_grey(struct viewer *viewer)
{
    const conus_volume_info *info = conus_atlas_volume(viewer->drawn->atlas, view_atlas_context(viewer->drawn));
    double black = view_atlas_grey(viewer->drawn)[0];
    double white = view_atlas_grey(viewer->drawn)[1];
    double least = fmin(info->minimum, black);
    double most = fmax(info->maximum, white);
    double gap = (most - least) / 1000;
    bool changed = ui_slider(
        "Black", &black, least, white - gap, "%.6g", false,
        "the grey value that the cuts show as black, in the image's own unit. In a cut drag with the middle button,\n"
        "or with Ctrl and the left one: up is brighter, right is more contrast; a double click resets");
    changed =
        ui_slider(
            "White", &white, fmin(black + gap, most), most, "%.6g", false,
            "the grey value that the cuts show as white, in the image's own unit; [ and ] change brightness, { and }\n"
            "contrast") ||
        changed;
    if (changed && white > black) {
        viewer_set_grey(viewer, black, white);
    }
    if (view_atlas_grey(viewer->drawn) != viewer->drawn->found_grey && ui_small_button("As found", NULL)) {
        viewer_set_grey(viewer, 0, 0);
    }
}

/* The first entry is as the context came. */
static void choose_preset(struct viewer *viewer)
{
    const char *names[HAZE_LIMIT] = {viewer->transfer ? "as given" : "as it came"};
    size_t count = 1;
    size_t chosen = 0;
    for (const char *name; count < HAZE_LIMIT && (name = conus_transfer_preset(count - 1)); count++) {
        names[count] = name;
        chosen = viewer->preset && strcmp(viewer->preset, name) == 0 ? count : chosen;
    }
    names[0] = viewer->transfer_editor.edited ? "edited" : names[0];
    chosen = viewer->transfer_editor.edited ? 0 : chosen;
    if (ui_choose("Colours", &chosen, names, count,
                  "colours and opacities of the context in 3-D by its values: a preset of conus render --transfer")) {
        viewer_use_preset(viewer, chosen ? names[chosen] : NULL);
    }
}

static void choose_look_of_pathway(struct viewer *viewer, uint32_t pathway)
{
    const char *names[HAZE_LIMIT];
    size_t count = 0;
    size_t haze = viewer->drawn->appearance.haze[pathway];
    while (count < HAZE_LIMIT && (names[count] = haze_name(count))) {
        count++;
    }
    ui_id(pathway);
    if (ui_choose("Look", &haze, names, count,
                  "in 3-D: solid from its threshold on, or as haze, by colours and opacities of its value: own is its "
                  "colour,\n"
                  "the others are the presets of conus render --pathway-transfer")) {
        viewer_set_haze(viewer, pathway, haze);
    }
    ui_id_end();
}

/* Explains the colours of streamlines, as the legend of a figure does. */
static void explain_colours(const struct appearance *appearance)
{
    static const char *const directions[] = {"left to right", "back to front", "down to up"};
    static const ui_colour pure[] = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}};
    for (uint32_t i = 0; appearance->streamlines == TRACT_BY_DIRECTION && i < 3; i++) {
        ui_id(i);
        ui_chip(pure[i]);
        ui_same_line();
        ui_text("%s", directions[i]);
        ui_id_end();
    }
    if (appearance->streamlines >= TRACT_BY_NUMBER && isfinite(appearance->streamline_range[0])) {
        ui_text("dark blue %.4g, green, yellow %.4g", appearance->streamline_range[0], appearance->streamline_range[1]);
    } else if (appearance->streamlines >= TRACT_BY_NUMBER) {
        ui_text("no value of it is known: all grey");
    }
}

static void choose_look_of_streamlines(struct viewer *viewer)
{
    const char *names[TRACT_COLOUR_LIMIT];
    size_t count = tract_colour_count(viewer->drawn->atlas);
    size_t colour = viewer->drawn->appearance.streamlines;
    for (size_t i = 0; i < count; i++) {
        names[i] = tract_colour_name(viewer->drawn->atlas, i);
    }
    if (ui_choose("Coloured by", &colour, names, count,
                  "what colours streamlines in 3-D and in figures: their bundle, their direction, or a number that "
                  "their file\n"
                  "has, in its own unit, from the least to the largest; 9 takes the next")) {
        viewer_colour_streamlines(viewer, colour);
    }
    explain_colours(&viewer->drawn->appearance);
}

void panel_look_area(struct viewer *viewer, uint32_t object)
{
    const struct appearance *appearance = &viewer->drawn->appearance;
    bool is_set = !isnan(appearance->opacity[object]);
    double opacity = is_set ? appearance->opacity[object] : 1;
    if (appearance->haze[object] != HAZE_NONE ||
        conus_atlas_object(viewer->drawn->atlas, object)->kind == CONUS_KIND_BUNDLE) {
        return; /* neither haze nor tubes have an opacity */
    }
    bool is_known =
        is_set || appearance->opacity[0] >= 1; /* else that of the others, which what is hit does not have */
    if (ui_slider("Opacity", &opacity, 0, 1, is_known ? "%.2f" : "as others", false,
                  "opacity in 3-D, 0 to 1, with all below it in the tree; , and . change it. It is of the picture "
                  "only: what\n"
                  "is not hidden is hit")) {
        viewer_set_opacity(viewer, object, opacity);
    }
    if (is_set && ui_small_button("As others", NULL)) {
        viewer_set_opacity(viewer, object, NAN);
    }
}

static const ui_colour bars = {LOOK_RGB(LOOK_PLOT_BARS), 255};
static const ui_colour curve = {LOOK_RGB(LOOK_CONE), 255};
static const ui_colour dark = {LOOK_RGB(LOOK_PLOT), 255};

/* Opacities of 1 mm are small: the editor's height goes up to this. */
static const double highest = 0.3;

enum { HEIGHT = 110, REACH = 9 };

/* Counts grey values; heights are logarithms, since air and tissue differ a thousandfold. */
static void count_values(struct transfer_editor *editor, const conus_atlas *atlas, size_t volume)
{
    uint64_t counts[EDITOR_BINS];
    double most = 0;
    const conus_volume_info *info = conus_atlas_volume(atlas, volume);
    if (conus_atlas_histogram(counts, EDITOR_BINS, atlas, volume)) {
        return;
    }
    for (size_t i = 0; i < EDITOR_BINS; i++) {
        editor->histogram[i] = log1p((double)counts[i]);
        most = fmax(most, editor->histogram[i]);
    }
    for (size_t i = 0; i < EDITOR_BINS; i++) {
        editor->histogram[i] /= fmax(most, 1);
    }
    editor->low = info->minimum;
    editor->high = info->maximum > info->minimum ? info->maximum : info->minimum + 1;
    editor->counted = true;
}

static bool make_ready(struct viewer *viewer)
{
    struct transfer_editor *editor = &viewer->transfer_editor;
    size_t volume = view_atlas_context(viewer->drawn);
    if (editor->ready || !viewer->painter || volume == conus_atlas_volume_count(viewer->drawn->atlas)) {
        return editor->ready;
    }
    editor->count = painter_transfer(viewer->painter, editor->points, EDITOR_POINTS);
    editor->held = EDITOR_POINTS;
    editor->ready = editor->count > 0;
    editor->counted = false;
    return editor->ready;
}

static void place_of(float out[2], const struct transfer_editor *editor, const struct ui_box *box, size_t point)
{
    double across = (editor->points[point].value - editor->low) / (editor->high - editor->low);
    double up = fmin(editor->points[point].rgba[3] / highest, 1);
    out[0] = box->x + box->width * (float)fmin(fmax(across, 0), 1);
    out[1] = box->y + box->height * (float)(1 - up);
}

static size_t point_at(const struct transfer_editor *editor, const struct ui_box *box, const struct ui_mouse *mouse)
{
    size_t found = EDITOR_POINTS;
    float nearest = REACH;
    for (size_t i = 0; i < editor->count; i++) {
        float at[2];
        place_of(at, editor, box, i);
        float distance = hypotf(at[0] - mouse->x, at[1] - mouse->y);
        found = distance < nearest ? i : found;
        nearest = fminf(nearest, distance);
    }
    return found;
}

/* Moves the held point between its neighbours, since values never fall. */
static void drag(struct transfer_editor *editor, const struct ui_box *box, const struct ui_mouse *mouse)
{
    conus_transfer_point *point = &editor->points[editor->held];
    double across = (double)((mouse->x - box->x) / box->width);
    double value = editor->low + across * (editor->high - editor->low);
    double least = editor->held ? point[-1].value : editor->low;
    double most = editor->held + 1 < editor->count ? point[1].value : editor->high;
    point->value = fmin(fmax(value, least), most);
    point->rgba[3] = highest * fmin(fmax((double)(1 - (mouse->y - box->y) / box->height), 0), 1);
}

static void draw_editor(const struct transfer_editor *editor, const struct ui_box *box)
{
    float step = box->width / EDITOR_BINS;
    ui_draw_box(*box, dark, 0);
    for (size_t i = 0; i < EDITOR_BINS; i++) {
        float height = (float)editor->histogram[i] * box->height;
        ui_draw_box((struct ui_box){box->x + (float)i * step, box->y + box->height - height, step, height}, bars, 0);
    }
    for (size_t i = 0; i < editor->count; i++) {
        float at[2];
        float before[2];
        const double *rgba = editor->points[i].rgba;
        place_of(at, editor, box, i);
        place_of(before, editor, box, i ? i - 1 : 0);
        ui_draw_line(before, at, curve, 2);
        ui_draw_circle(
            at, 5, (ui_colour){(uint8_t)(255 * rgba[0]), (uint8_t)(255 * rgba[1]), (uint8_t)(255 * rgba[2]), 255}, 0);
        ui_draw_circle(at, 5, curve, 1.5F);
    }
}

static void edit_transfer(struct viewer *viewer)
{
    struct transfer_editor *editor = &viewer->transfer_editor;
    struct ui_box box = ui_area("transfer", HEIGHT);
    struct ui_mouse mouse = ui_mouse_now();
    bool held = ui_surface_held();
    if (!editor->counted) {
        count_values(editor, viewer->drawn->atlas, view_atlas_context(viewer->drawn));
    }
    if (held && mouse.pressed[0]) {
        editor->held = point_at(editor, &box, &mouse);
    }
    if (held && editor->held < editor->count && (mouse.moved_x != 0 || mouse.moved_y != 0)) {
        drag(editor, &box, &mouse);
        viewer_use_transfer(viewer);
    }
    editor->held = held ? editor->held : EDITOR_POINTS;
    ui_tip("drag the points: right is a brighter grey value, in the image's own unit; up is more opaque, 0 to 1 a mm");
    draw_editor(editor, &box);
}

/* Shows a band of values, which cannot be changed. */
static void show_band(const conus_object *band)
{
    char low[32] = "";
    char high[32] = "";
    if (isfinite(band->low)) {
        snprintf(low, sizeof low, " from %.6g", band->low);
    }
    if (isfinite(band->high)) {
        snprintf(high, sizeof high, " below %.6g", band->high);
    }
    char text[512];
    snprintf(text, sizeof text, "%s: values%s%s%s", band->name, low, low[0] && high[0] ? " to" : "", high);
    ui_text_wrapped(THEME_PLAIN, text);
}

static void edit_thresholds(struct viewer *viewer)
{
    for (uint32_t number = 1; number <= viewer->drawn->object_count; number++) {
        const conus_object *object = conus_atlas_object(viewer->drawn->atlas, number);
        const conus_volume_info *info = view_atlas_pathway(viewer->drawn, number);
        if (object->is_band) {
            show_band(object);
        }
        if (info && info->maximum > info->minimum) {
            double threshold = info->threshold;
            char part[48] = "";
            if (info->minimum >= 0) {
                double percent = 100 * threshold / info->maximum;
                snprintf(part, sizeof part, "%.*f %% of its largest value", percent < 1, percent);
            }
            ui_id(number);
            ui_name_cut(object->name, ui_room() - ui_text_width(part) - ui_line());
            ui_same_line();
            ui_text_coloured(THEME_HINT, "%s", part);
            ui_width(ui_room());
            ui_slider("##threshold", &threshold, info->minimum, info->maximum, "from %.6g", false, NULL);
            bool done = ui_edited();
            ui_tip("the value from which on voxels are of the pathway, in the unit of its file");
            ui_id_end();
            if (done && threshold != info->threshold) {
                viewer_set_threshold(viewer, number, threshold);
                return; /* objects and volumes have changed */
            }
        }
        if (object->kind == CONUS_KIND_PATHWAY) {
            choose_look_of_pathway(viewer, number);
        }
    }
}

/* Searches from the end, where bundles may come behind pathways. */
static bool has_pathways(const struct view_atlas *view)
{
    size_t number = view->object_count;
    while (number && conus_atlas_object(view->atlas, number)->kind != CONUS_KIND_PATHWAY) {
        number--;
    }
    return number;
}

void panel_look(struct window *window)
{
    struct viewer *viewer = window->viewer;
    look_at_view(window);
    bool has_context = view_atlas_context(viewer->drawn) < conus_atlas_volume_count(viewer->drawn->atlas);
    bool is_ready = make_ready(viewer);
    if (has_context && ui_section("Context", false)) {
        if (viewer->drawn->found_grey[1] > viewer->drawn->found_grey[0]) {
            edit_grey(viewer);
        }
        choose_preset(viewer);
        if (is_ready) {
            edit_transfer(viewer);
        }
    }
    if (has_pathways(viewer->drawn) && ui_section("Pathways", true)) {
        edit_thresholds(viewer);
    }
    if (conus_atlas_tractogram_count(viewer->drawn->atlas) && ui_section("Streamlines", true)) {
        choose_look_of_streamlines(viewer);
    }
}
