/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The look of an atlas: the user's settings of how it is drawn. They change pictures, never answers. */
#ifndef CONUS_VIEWER_PICTURES_APPEARANCE_H
#define CONUS_VIEWER_PICTURES_APPEARANCE_H

#include "conus/picture.h"

/** The background behind the brain in 3-D. */
enum backdrop {
    BACKDROP_THEME = 0,
    BACKDROP_LIGHT,
    BACKDROP_WHITE,
    BACKDROP_BLACK,
    BACKDROP_TRANSPARENT,
    BACKDROP_COUNT
};
/** Their names: but the first, those that conus render --background has. */
extern const char *const backdrop_names[BACKDROP_COUNT];
/** Sets it in @p view, of a pane: there what is transparent is white, and the theme's is dark or white. */
void backdrop_set(conus_view *view, enum backdrop backdrop, bool theme_is_dark);
/** The name for conus render: figures have no theme, and are light there. */
const char *backdrop_of_figures(enum backdrop backdrop);

/** How a pathway is drawn: as a surface, or as haze by its values, in its own colour or a preset's. */
enum { HAZE_NONE = 0, HAZE_OWN, HAZE_LIMIT = 32 };
/** "solid" and, as conus render --pathway-transfer has them, "own", "brain", ...; NULL past the last. Static. */
const char *haze_name(size_t haze);
/** The preset of that name; HAZE_LIMIT = none. */
size_t haze_find(const char *name);

struct appearance {
    double grey[2]; /**< Values of the context that the cuts show as black and white; both 0 = those that were found. */
    double *opacity; /**< [object_count + 1] Of surfaces in 3-D, by number, 0 to 1; NaN = as the first entry says, which
                          is of what the cone does not hit and more than 0. */
    uint8_t *haze;   /**< [object_count + 1] Of pathways, as above. */
    size_t streamlines;         /**< How they are coloured (enum of TRACT_BY_BUNDLE). */
    double streamline_range[2]; /**< Values of the number that colours them; NaN = another colouring. */
    size_t object_count;
};

/** All as conus draws it by itself; false without memory. */
bool appearance_init(struct appearance *out, size_t object_count);
void appearance_finish(struct appearance *appearance);
/** Colours streamlines by this, see tract_colour_name(). */
void appearance_colour_streamlines(struct appearance *appearance, const conus_atlas *atlas, size_t colour);
/** Whether both draw pathways and streamlines in the same way. */
bool appearance_same_tracts(const struct appearance *a, const struct appearance *b);
/** Sets the opacities in @p view, which borrows them. */
void appearance_set(conus_view *view, const struct appearance *appearance);
/** Moves the grey values @p grey of the cuts: @p up makes it brighter, by the width of @p found for 1; @p right gives
 * more contrast, e times for 1. Black stays below white, and both near @p found, which some images were found with. */
void appearance_move_grey(double grey[2], const double found[2], double right, double up);
/** The name for conus_renderer_options; NULL = that of bundles. */
const char *appearance_streamline_colour(const struct appearance *appearance, const conus_atlas *atlas);
/** The pathways that are haze, in @p out of [object_count]; returns how many. */
size_t appearance_pathways(conus_pathway_transfer *out, const struct appearance *appearance);

enum { TRACT_BY_BUNDLE = 0, TRACT_BY_DIRECTION, TRACT_BY_NUMBER /**< and above */, TRACT_COLOUR_LIMIT = 64 };

/** "bundle", "direction", a number's name, which is the atlas's; NULL past the last, and without streamlines. */
const char *tract_colour_name(const conus_atlas *atlas, size_t colour);
/** The colouring of that name; TRACT_COLOUR_LIMIT = none. */
size_t tract_colour_find(const conus_atlas *atlas, const char *name);
/** How many there are; 0 where there are no streamlines. */
size_t tract_colour_count(const conus_atlas *atlas);
/** Least and largest finite value of a number, over all files that have it; false where there is none. */
bool tract_colour_range(double out[2], const conus_atlas *atlas, const char *name);

enum { SHEET_SIDE_LIMIT = 16384, SHEET_MM_LIMIT = 10000, SHEET_DPI_LIMIT = 10000, SHEET_DPI_LEAST = 10 };

struct sheet {
    bool in_mm;         /**< The size is that on paper. */
    uint32_t pixels[2]; /**< Width and height, 1 to SHEET_SIDE_LIMIT; */
    double mm[2];       /**< or 1 to SHEET_MM_LIMIT. Zeros = what conus render takes by itself. */
    double dpi;         /**< SHEET_DPI_LEAST to SHEET_DPI_LIMIT; 0 = not said, and 300 where the size is in mm. */
    conus_legend legend;
    bool no_text; /**< No legend, and no letters. */
};

/** The default of conus render. */
void sheet_init(struct sheet *out);
bool sheet_is_same(const struct sheet *a, const struct sheet *b);

#endif
