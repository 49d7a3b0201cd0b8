/* SPDX-License-Identifier: BSD-3-Clause */
/* Widgets of how the atlas looks. */
#include "viewer/panes/panels.h"

#include <math.h>
#include <string.h>

static const double least_pale = 0.02; /* what should not be seen at all is hidden */

void panel_look_view(struct window *window)
{
    static const enum property_id shown[] = {PROPERTY_FADE, PROPERTY_FILL, PROPERTY_OUTLINES, PROPERTY_RADIOLOGICAL,
                                             PROPERTY_SAFE_COLOURS};
    double rest = window->viewer->drawn->appearance.opacity[0];
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++) {
        panel_property(window, shown[i]);
    }
    if (ui_slider("The rest", &rest, least_pale, 1, "%.2f opaque", false)) {
        viewer_set_opacity(window->viewer, 0, rest);
    }
    ui_tip("opacity in 3-D, 0 to 1, of the areas that the cone does not hit; , and . change it where no area is\n"
           "chosen. It is of the picture only: what is not hidden is hit");
    panel_property(window, PROPERTY_BACKGROUND);
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
    bool changed = ui_slider("Black", &black, least, white - gap, "%.6g", false);
    ui_tip(
        "the grey value that the cuts show as black, in the image's own unit. In a cut drag with the middle button,\n"
        "or with Ctrl and the left one: up is brighter, right is more contrast; a double click resets");
    changed = ui_slider("White", &white, fmin(black + gap, most), most, "%.6g", false) || changed;
    ui_tip("the grey value that the cuts show as white, in the image's own unit; [ and ] change brightness, { and }\n"
           "contrast");
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
    if (ui_choose("Colours", &chosen, names, count)) {
        viewer_use_preset(viewer, chosen ? names[chosen] : NULL);
    }
    ui_tip("colours and opacities of the context in 3-D by its values: a preset of conus render --transfer");
}

void panel_look_context(struct viewer *viewer)
{
    if (viewer->drawn->found_grey[1] > viewer->drawn->found_grey[0]) {
        edit_grey(viewer);
    }
    choose_preset(viewer);
}

void panel_look_pathway(struct viewer *viewer, uint32_t pathway)
{
    const char *names[HAZE_LIMIT];
    size_t count = 0;
    size_t haze = viewer->drawn->appearance.haze[pathway];
    while (count < HAZE_LIMIT && (names[count] = haze_name(count))) {
        count++;
    }
    ui_id(pathway);
    if (ui_choose("Drawn as", &haze, names, count)) {
        viewer_set_haze(viewer, pathway, haze);
    }
    ui_tip(
        "in 3-D: solid from its threshold on, or as haze, by colours and opacities of its value: own is its colour,\n"
        "the others are the presets of conus render --pathway-transfer");
    ui_id_end();
}

/* Explains the colours of streamlines, as the legend of a figure does. */
static void explain_colours(const struct appearance *appearance)
{
    static const char *const directions[] = {"left to right", "back to front", "down to up"};
    static const ui_colour pure[] = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}};
    for (uint32_t i = 0; appearance->streamlines == TRACT_BY_DIRECTION && i < 3; i++) {
        ui_id(i);
        ui_chip("direction", pure[i]);
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

void panel_look_streamlines(struct viewer *viewer)
{
    const char *names[TRACT_COLOUR_LIMIT];
    size_t count = tract_colour_count(viewer->drawn->atlas);
    size_t colour = viewer->drawn->appearance.streamlines;
    for (size_t i = 0; i < count; i++) {
        names[i] = tract_colour_name(viewer->drawn->atlas, i);
    }
    if (ui_choose("Coloured by", &colour, names, count)) {
        viewer_colour_streamlines(viewer, colour);
    }
    ui_tip(
        "what colours streamlines in 3-D and in figures: their bundle, their direction, or a number that their file\n"
        "has, in its own unit, from the least to the largest; 9 takes the next");
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
    ui_width(fminf(0.5F * ui_room(), 9 * ui_line()));
    if (ui_slider("##opacity", &opacity, 0, 1, is_set ? "%.2f opaque" : "opacity", false)) {
        viewer_set_opacity(viewer, object, opacity);
    }
    ui_tip("opacity in 3-D, 0 to 1, with all below it in the tree; , and . change it. It is of the picture only: what\n"
           "is not hidden is hit");
    if (is_set) {
        ui_same_line();
        if (ui_small_button("As others", NULL)) {
            viewer_set_opacity(viewer, object, NAN);
        }
    }
}
