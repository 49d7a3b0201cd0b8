/* SPDX-License-Identifier: BSD-3-Clause */
/* Thresholds, grey values, opacities, haze, colours of the context and the background, by words. */
#include "viewer/commands/script_look.h"

#include "viewer/commands/script_words.h"
#include "viewer/model/search.h"

#include <math.h>
#include <string.h>

bool script_threshold(struct window *window, char *const *arguments, size_t count)
{
    struct viewer *viewer = window->viewer;
    uint32_t object = search_best(viewer->drawn->atlas, arguments[0]);
    const conus_volume_info *info = view_atlas_pathway(viewer->drawn, object);
    double threshold;
    bool fine = info && count == 2 && script_number(&threshold, arguments[1]) && threshold >= info->minimum &&
                threshold <= info->maximum;
    if (fine) {
        viewer_set_threshold(viewer, object, threshold);
    }
    return fine;
}

bool script_fade(struct window *window, char *const *arguments, size_t count)
{
    double fade;
    bool fine = count == 1 && script_number(&fade, arguments[0]) && fade >= 0 && fade <= 1;
    if (fine) {
        window->viewer->display.fade = fade;
        window->viewer->version++;
    }
    return fine;
}

bool script_grey(struct window *window, char *const *arguments, size_t count)
{
    double black = 0;
    double white = 0;
    bool has_context =
        view_atlas_context(window->viewer->drawn) < conus_atlas_volume_count(window->viewer->drawn->atlas);
    bool fine = has_context && (count == 0 || (count == 2 && script_number(&black, arguments[0]) &&
                                               script_number(&white, arguments[1]) && black < white));
    if (fine) {
        viewer_set_grey(window->viewer, black, white);
    }
    return fine;
}

/* Of an area, or of what the cone does not hit, which stays to be seen. */
bool script_opacity(struct window *window, char *const *arguments, size_t count)
{
    struct viewer *viewer = window->viewer;
    const char *value = arguments[count - 1];
    double opacity = NAN;
    uint32_t object = count == 2 ? search_best(viewer->drawn->atlas, arguments[0]) : 0;
    bool resets = object && strcmp(value, "reset") == 0;
    bool fine = (count == 1 || object) &&
                (resets || (script_number(&opacity, value) && opacity >= 0 && opacity <= 1 && (object || opacity > 0)));
    if (fine) {
        viewer_set_opacity(viewer, object, opacity);
    }
    return fine;
}

bool script_haze(struct window *window, char *const *arguments, size_t count)
{
    const conus_atlas *atlas = window->viewer->drawn->atlas;
    uint32_t pathway = search_best(atlas, arguments[0]);
    size_t haze = haze_find(arguments[count - 1]);
    bool fine = pathway && conus_atlas_object(atlas, pathway)->kind == CONUS_KIND_PATHWAY && haze < HAZE_LIMIT;
    if (fine) {
        viewer_set_haze(window->viewer, pathway, haze);
    }
    return fine;
}

bool script_streamlines(struct window *window, char *const *arguments, size_t count)
{
    struct viewer *viewer = window->viewer;
    size_t colour = count ? tract_colour_find(viewer->drawn->atlas, arguments[0]) : TRACT_COLOUR_LIMIT;
    if (colour != TRACT_COLOUR_LIMIT) {
        viewer_colour_streamlines(viewer, colour);
    }
    return colour != TRACT_COLOUR_LIMIT;
}

bool script_preset(struct window *window, char *const *arguments, size_t count)
{
    const char *found = NULL;
    for (size_t i = 0; count && (found = conus_transfer_preset(i)) && strcmp(found, arguments[0]) != 0; i++) {
    }
    if (!count || found) {
        viewer_use_preset(window->viewer, found);
    }
    return !count || found;
}

bool script_background(struct window *window, char *const *arguments, size_t count)
{
    for (int i = 0; count && i < BACKDROP_COUNT; i++) {
        if (strcmp(backdrop_names[i], arguments[0]) == 0) {
            window->viewer->display.backdrop = (enum backdrop)i;
            window->viewer->version++;
            return true;
        }
    }
    return false;
}
