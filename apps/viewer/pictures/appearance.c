/* SPDX-License-Identifier: BSD-3-Clause */
/* Background, opacities, pathways as haze, and colours of streamlines. */
#include "viewer/pictures/pictures.h"

#include "base/look.h"
#include "conus/own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const backdrop_names[BACKDROP_COUNT] = {"theme", "light", "white", "black", "transparent"};

void backdrop_set(conus_view *view, enum backdrop backdrop, bool theme_is_dark)
{
    static const uint8_t colours[BACKDROP_COUNT][3] = {[BACKDROP_THEME] = {LOOK_RGB(LOOK_PANE_DARK)},
                                                       [BACKDROP_WHITE] = {LOOK_RGB(LOOK_WHITE)},
                                                       [BACKDROP_BLACK] = {LOOK_RGB(LOOK_BLACK)},
                                                       [BACKDROP_TRANSPARENT] = {LOOK_RGB(LOOK_WHITE)}};
    enum backdrop of = backdrop == BACKDROP_THEME && !theme_is_dark ? BACKDROP_WHITE : backdrop;
    view->background = of == BACKDROP_LIGHT ? CONUS_BACKGROUND_LIGHT : CONUS_BACKGROUND_COLOUR;
    memcpy(view->background_rgb, colours[of], sizeof view->background_rgb);
}

const char *backdrop_of_figures(enum backdrop backdrop)
{
    return backdrop_names[backdrop == BACKDROP_THEME ? BACKDROP_LIGHT : backdrop];
}

bool sheet_is_same(const struct sheet *a, const struct sheet *b)
{
    return a->in_mm == b->in_mm && a->pixels[0] == b->pixels[0] && a->pixels[1] == b->pixels[1] &&
           a->mm[0] == b->mm[0] && a->mm[1] == b->mm[1] && a->dpi == b->dpi && a->legend == b->legend &&
           a->no_text == b->no_text;
}

const char *haze_name(size_t haze)
{
    return haze == HAZE_NONE   ? "solid"
           : haze == HAZE_OWN  ? "own"
           : haze < HAZE_LIMIT ? conus_transfer_preset(haze - HAZE_OWN - 1)
                               : NULL;
}

size_t haze_find(const char *name)
{
    for (size_t haze = 0; haze_name(haze); haze++) {
        if (strcmp(haze_name(haze), name) == 0) {
            return haze;
        }
    }
    return HAZE_LIMIT;
}

bool appearance_init(struct appearance *out, size_t object_count)
{
    *out = (struct appearance){.opacity = malloc((object_count + 1) * sizeof *out->opacity),
                               .haze = calloc(object_count + 1, sizeof *out->haze),
                               .streamline_range = {NAN, NAN},
                               .object_count = object_count};
    for (size_t number = 0; out->opacity && number <= object_count; number++) {
        out->opacity[number] = number ? NAN : 1;
    }
    if (!out->opacity || !out->haze) {
        appearance_finish(out);
        return false;
    }
    return true;
}

void appearance_finish(struct appearance *appearance)
{
    free(appearance->opacity);
    free(appearance->haze);
    *appearance = (struct appearance){0};
}

void appearance_colour_streamlines(struct appearance *appearance, const conus_atlas *atlas, size_t colour)
{
    const char *name = colour < TRACT_BY_NUMBER ? NULL : tract_colour_name(atlas, colour);
    appearance->streamlines = colour;
    appearance->streamline_range[0] = appearance->streamline_range[1] = NAN;
    if (name) {
        (void)tract_colour_range(appearance->streamline_range, atlas, name);
    }
}

const char *appearance_streamline_colour(const struct appearance *appearance, const conus_atlas *atlas)
{
    return appearance->streamlines == TRACT_BY_BUNDLE ? NULL : tract_colour_name(atlas, appearance->streamlines);
}

bool appearance_same_tracts(const struct appearance *a, const struct appearance *b)
{
    return a->streamlines == b->streamlines && a->object_count == b->object_count &&
           memcmp(a->haze, b->haze, (a->object_count + 1) * sizeof *a->haze) == 0;
}

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

void appearance_move_grey(double grey[2], const double found[2], double right, double up)
{
    double range = found[1] - found[0];
    double width = clamp((grey[1] - grey[0]) * exp(-right), range / 1000, 10 * range);
    double level = clamp((grey[0] + grey[1]) / 2 - up * range, found[0] - range, found[1] + range);
    grey[0] = level - width / 2;
    grey[1] = level + width / 2;
}

size_t appearance_pathways(conus_pathway_transfer *out, const struct appearance *appearance)
{
    size_t count = 0;
    for (size_t number = 1; number <= appearance->object_count; number++) {
        if (appearance->haze[number] != HAZE_NONE) {
            out[count++] = (conus_pathway_transfer){(uint32_t)number, haze_name(appearance->haze[number])};
        }
    }
    return count;
}

static const char *const fixed[TRACT_BY_NUMBER] = {"bundle", "direction"};

/* The place of a name among others; @p count = it is not there. */
static size_t find(const char *const *names, size_t count, const char *name)
{
    size_t at = 0;
    while (at < count && strcmp(names[at], name) != 0) {
        at++;
    }
    return at;
}

/* Lists the names of all colourings, up to the limit. */
static size_t list(const char *names[TRACT_COLOUR_LIMIT], const conus_atlas *atlas)
{
    conus_tract_scalar scalar = CONUS_TRACT_SCALAR_INIT;
    size_t count = 0;
    while (conus_atlas_tractogram_count(atlas) && count < TRACT_BY_NUMBER) {
        names[count] = fixed[count];
        count++;
    }
    for (size_t i = 0; i < conus_atlas_tractogram_count(atlas); i++) {
        for (size_t s = 0; count < TRACT_COLOUR_LIMIT && !conus_atlas_tractogram_scalar(&scalar, atlas, i, s); s++) {
            if (scalar.components == 1 && find(names, count, scalar.name) == count) {
                names[count++] = scalar.name;
            }
        }
    }
    return count;
}

const char *tract_colour_name(const conus_atlas *atlas, size_t colour)
{
    const char *names[TRACT_COLOUR_LIMIT];
    return colour < list(names, atlas) ? names[colour] : NULL;
}

size_t tract_colour_find(const conus_atlas *atlas, const char *name)
{
    const char *names[TRACT_COLOUR_LIMIT];
    size_t count = list(names, atlas);
    size_t colour = find(names, count, name);
    return colour < count ? colour : TRACT_COLOUR_LIMIT;
}

size_t tract_colour_count(const conus_atlas *atlas)
{
    const char *names[TRACT_COLOUR_LIMIT];
    return list(names, atlas);
}

/* In one tractogram the first of that name counts, as in pictures. */
bool tract_colour_range(double out[2], const conus_atlas *atlas, const char *name)
{
    double range[2] = {INFINITY, -INFINITY};
    conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
    for (size_t i = 0; !conus_atlas_tractogram(&info, atlas, i); i++) {
        conus_tract_scalar scalar = CONUS_TRACT_SCALAR_INIT;
        bool found = false;
        for (size_t s = 0; !found && !conus_atlas_tractogram_scalar(&scalar, atlas, i, s); s++) {
            found = scalar.components == 1 && strcmp(scalar.name, name) == 0;
        }
        uint64_t count = !found ? 0 : scalar.per_point ? info.points : info.streamlines;
        for (uint64_t v = 0; v < count; v++) {
            double value = (double)scalar.values[v];
            range[0] = isfinite(value) ? fmin(range[0], value) : range[0];
            range[1] = isfinite(value) ? fmax(range[1], value) : range[1];
        }
    }
    if (range[0] > range[1]) {
        return false;
    }
    out[0] = range[0];
    out[1] = range[1];
    return true;
}
