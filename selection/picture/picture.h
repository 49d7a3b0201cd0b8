/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A picture in the making: what conus_render() hands from step to step, and what stands out in it; the view
 * of a cut. */
#ifndef CONUS_SELECTION_PICTURE_PICTURE_H
#define CONUS_SELECTION_PICTURE_PICTURE_H

#include "base/status.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "render/draw/draw.h"
#include "render/flat/cut.h"
#include "selection/selection.h"

/* How areas stand out in a picture with a cone. */

/** How each object, by number, stands out in a picture of @p selection: [object count + 1] of enum emphasis, to be
 * freed. @p chosen (0 = none) and what is below it in the area tree are never pale. NULL without memory. */
uint8_t *picture_emphasis(const conus_selection *selection, uint32_t chosen);

/** How far along the axis the farthest contact lies, mm; -INFINITY where nothing is hit. */
double picture_cone_depth(const conus_selection *selection);

/** Whether a picture of @p selection, which may be NULL, colours by rank: unless @p own_colours, or where the atlas has
 * a palette, which somebody chose. */
bool picture_has_ranks(const conus_selection *selection, bool own_colours);

/** conus_selection_rank() of each object, by number: [object count + 1], to be freed. NULL without memory. */
uint32_t *picture_ranks(const conus_selection *selection);

enum { PICTURE_RANKS = 6 };
/** sRGB of each object by its rank, to be freed; where the atlas has a palette its colours, but what has a rank has
 * none that a better one has, while there are some: of [object count + 1] @p ranks; 0, and all where that is NULL,
 * = @p not_hit, 0xRRGGBB, but what is @p listed ([object count + 1]; NULL = nothing is) has its own colour, so that
 * nothing that is not hit has the colour of a hit. With a @p selection as much of a rank's colour shows as
 * conus_selection_weight() says, and the rest is @p not_hit. NULL without memory. */
uint8_t (*picture_rank_colours(const uint32_t *ranks, const conus_atlas *atlas, unsigned not_hit, const bool *listed,
                               const conus_selection *selection))[3];

/* A picture in the making: what conus_render() hands from step to step. */

/** Tangents of a frustum's edges are at most so large. */
enum { PICTURE_FRUSTUM_LIMIT = 1000 };

/** Contrast of text to its background, at least (WCAG 2.2, 1.4.3). */
#define PICTURE_CONTRAST 4.5
#define PICTURE_DIM 0.87F

/** Letters of directions, in em. */
#define PICTURE_LETTER 1.1

/* Half the width of the disc of a number, em. */
#define PICTURE_TAG 0.75

/** The part of the picture from which on something is listed because it is seen: a square of a 140th of its side, 0.6
 * mm in a column of print. */
#define PICTURE_LEAST_PART (1.0 / 20000)

/** The dark edge of balls and of lines of probes, linear. */
#define PICTURE_CASING ((const float[4]){LOOK_PROBE_CASING, 1})

struct picture_legend;
struct picture_probes;

/** Points of one group, which have one colour. */
struct picture_group {
    const char *name; /**< NULL = none. */
    uint8_t rgb[3];
    size_t count;
};

/** Where an object's name stands on it. */
struct picture_name_place {
    double at[3];  /**< World: its middle. */
    int lines;     /**< 0 or less: it has none. */
    size_t number; /**< In place of the name, that of its row in the legend; 0 = the name. */
};

struct picture {
    conus_view options; /**< Defaults filled in. */
    const conus_atlas *atlas;
    const struct haze_choice *hazy;           /**< Pathways that are haze. */
    const struct tube_colouring *streamlines; /**< How they are coloured; NULL of a cut, where it is by bundle. */
    uint32_t drawing[2];           /**< Width and height of the drawing, in the image's top left corner.       */
    uint32_t sheet_height;         /**< Height of the image, which is options.width wide.                             */
    struct font *font;             /**< NULL = no text.                                                        */
    struct picture_legend *legend; /**< NULL = none.                                                   */
    bool is_low;                   /**< A legend that may stand anywhere stands below. */
    char *key;                     /**< What its colours mean, with the names that the atlas has; NULL = none. */
    char *sides;                   /**< [objects + 1] of conus_atlas_sides(); with a font. */
    const char **prefixes;         /**< Likewise, of conus_atlas_prefixes(). */
    struct picture_probes *probes; /**< Strips; NULL = none. */
    struct picture_group *groups;  /**< [group_count] Of points, in the order of the first of each. */
    size_t group_count;
    uint32_t *group_of;     /**< [options.point_count] */
    size_t first_named;     /**< The point whose name has a place before all others, from 1; 0 = none. */
    bool has_group_scale;   /**< Groups are numbers, with colours of a scale over their range. */
    bool has_unknown_group; /**< One that has no number is beside these. */
    double group_range[2];
    double em, line; /**< Size of letters, and the thinnest line (half a point), pixels. */
    float ink[4];    /**< Colour of letters, in the form of draw.h. */
    float dim;       /**< Opacity of letters that say less.                              */
    struct camera camera;
    struct camera_frame frame;
    double forward[3];        /**< Where a camera looks that is not given. */
    double centre[3], radius; /**< A ball around what shows, world mm. */
    struct colour_view view;
    struct colour_marker markers[COLOUR_MARKER_LIMIT];
    float *opacity;    /**< [objects + 1] of surfaces; NULL where all are opaque. */
    uint8_t *areas;    /**< [objects + 1] of enum pathways_area: those that are drawn beside pathways. */
    uint8_t *emphasis; /**< [objects + 1] of enum emphasis, by the cone; NULL without one. */
    uint32_t *ranks; /**< [objects + 1] of picture_ranks(), and of what is listed; NULL = all have their own colours. */
    uint8_t (*rgb)[3]; /**< [objects + 1] sRGB by rank, and of outlines in cuts; with `ranks`. */
    uint8_t (*line_rgb)[3];
    double *seen;           /**< [objects + 1] The part of the picture's light that is of each; NULL = not known. */
    conus_selection *sight; /**< The rays by which `seen` was found, where each was followed to what it meets first. */
    struct picture_name_place *names; /**< [objects + 1] NULL = none has its name on it. */
    float *rgba;                      /**< [height * width * 4], bottom row first. */
};

/** Appends the legend of the areas hit, a scale bar and the directions (R L A P S I); with a font. */
void picture_annotate(struct draw_list *list, const struct picture *picture);

/** Likewise of a cut, whose letters are light: the legend, a scale bar, and letters where the cut's axes are within 15
 * degrees of the world's; the camera's first two columns are the cut's right and up. */
void picture_annotate_cut(struct draw_list *list, struct picture *picture, double mm_per_pixel);

/** Draws the marks of the options. */
void picture_draw_marks(struct draw_list *list, const struct picture *picture);

/** Draws the line that the options measure, if both of its @p ends, pixels, lie in the drawing. These are @p away, mm
 * with a sign, from a cut: it is firm where it is in that, and has its length only then. */
void picture_draw_measured(struct draw_list *list, const struct picture *picture, double ends[2][2],
                           const double away[2]);

/** The letter of the direction, in the world, to which a picture's axis points; NULL where none is within 15 degrees.
 */
const char *picture_letter_of(const double axis[3]);

/** A bar, as long as so many mm are, in the lower right corner of the drawing. */
void picture_draw_bar(struct draw_list *list, const struct picture *picture, double pixels_per_mm);

/** Whether letters at the edges of the drawing say where it is seen from; else a cross of directions does. */
bool picture_is_across(const struct picture *picture);

/** Whether none of @p points, [count][3] in the world, lies under the scale and the directions in the lower right
 * corner. In @p size what these take of its width and height, pixels. */
bool picture_key_is_free(double size[2], const struct picture *picture, const double *points, size_t count);

/** Where directions and scale are drawn; empty boxes where they are not. */
void picture_key_boxes(struct draw_box out[2], const struct picture *picture);

bool picture_overlaps(const struct draw_box *a, const struct draw_box *b);

/** Under text that has no free place, so that it can be read. */
void picture_lay_patch(struct draw_list *list, const struct picture *picture, const struct draw_box *box);

/** The opacity that was drawn in a box of the drawing, summed over its pixels. */
double picture_covered(const struct picture *picture, const struct draw_box *box);

/** Whether the sheet's side, legend, background and dpi are some. */
conus_status picture_check_sheet(const conus_view *view);

/** Sets up the picture of cuts of its atlas: all areas show, also beside pathways. Of @p view count width, height,
 * selection and chosen. What it holds is the caller's to picture_finish() in any case. */
conus_status picture_cut_init(struct picture *picture, const conus_cut_view *view, const conus_view *sheet);

/** Frees what a picture holds. */
void picture_finish(struct picture *picture);

/** Lays it over the whole image. */
void picture_lay_background(conus_image *image, const conus_view *options);

/** Whether light letters are seen better on the background than dark ones; what is transparent is taken for paper. */
bool picture_is_dark(const conus_view *options);

/** Sets drawing and sheet as options say, and gets text ready: font, letters and the legend. Without a font there is no
 * text, and a word about it in @p log (NULL = none). */
conus_status picture_prepare_sheet(struct picture *picture, uint64_t max_memory, conus_log log, void *log_user);

/** Gives ranks and their colours to the picture of a selection, unless its objects have their own colours; the picture
 * has its areas and opacities. CONUS_ERROR_MEMORY. */
conus_status picture_rank(struct picture *picture, bool on_dark);

/** sRGB of an object in the picture; of the only haze that is coloured by its values, the one half way between them. */
void picture_colour(uint8_t out[3], const struct picture *picture, size_t number);

/** Whether an object keeps its colour, and has a row in the legend, though the cone does not hit it: one that is
 * listed, or else that is given an opacity. */
bool picture_stands_out(const struct picture *picture, size_t number);

/** Lets what stands out keep its colour in `emphasis`, where that is not NULL. */
void picture_keep_listed(struct picture *picture);

/** The number that the picture and its legend give to what may look like another one: a pathway drawn as haze by
 * values, and what has a rank behind the colours and is hit first, or is a pathway, a bundle or listed; 0 where it has
 * none. */
size_t picture_tag(const struct picture *picture, uint32_t number);

/** Draws that number on a disc of the object's colour. */
void picture_draw_tag(struct draw_list *list, const struct picture *picture, uint32_t number, const double at[2]);

/** Whether the object, as it is in the atlas, is drawn: not hidden, left out or without opacity. */
bool picture_draws(const struct picture *picture, uint32_t number);

/** Fills in `seen`, by rays from the camera through the whole picture. Whatever is drawn is opaque or haze. */
conus_status picture_see(struct picture *picture);

/** Whether the camera sees neither it nor anything below it in the area tree, as far as that is known. */
bool picture_is_hidden(const struct picture *picture, uint32_t number);

/** Whether a legend without a cone names all that is in the picture. */
bool picture_lists_all(const struct picture *picture);

/** Finds room for names on what the picture shows, where a legend would have several rows of one colour. */
conus_status picture_names_init(struct picture *picture);
void picture_names_draw(struct draw_list *list, const struct picture *picture);

/** Black or white, whichever has the higher contrast to the object's colour. */
void picture_ink_on(float out[4], const struct picture *picture, uint32_t number);

/** Makes the legend of a picture with a font that has something to explain, in words as `key`, and unless its options
 * have none, place for it beside or below the drawing. */
conus_status picture_legend_init(struct picture *picture);
void picture_legend_finish(struct picture *picture);

/** Whether the probes of a view can be drawn. */
conus_status picture_probes_check(const conus_view *view);

/** [objects + 1] of enum emphasis: full is what a probe passes, with all below it in the area tree. NULL without
 * memory. */
uint8_t *picture_probe_emphasis(const struct picture *picture);

/** Where the line of a probe begins and ends near what shows, world mm; false where it does not come near. */
bool picture_probe_ends(double ends[2][3], const struct picture *picture, size_t index);

/** Makes place for the strips beside the drawing. */
conus_status picture_probes_init(struct picture *picture);
void picture_probes_finish(struct picture *picture);

/** The lines over the drawing, and their strips; with no font only the lines. */
conus_status picture_probes_draw(struct draw_list *list, const struct picture *picture);

/** Whether the points of a view can be drawn. */
conus_status picture_points_check(const conus_view *view);

/** Finds the groups of points. CONUS_ERROR_MEMORY. */
conus_status picture_points_init(struct picture *picture);

/** Whether the colours of points tell groups apart. */
static inline bool picture_has_groups(const struct picture *picture)
{
    return picture->group_count > 1 || (picture->group_count == 1 && picture->groups[0].name);
}

/** Six points around each ball that is not far from the atlas, world mm: [6 * point_count]. Returns how many. */
size_t picture_points_near(double (*out)[3], const struct picture *picture);

/** Balls with their lines and, with a font, their names, over the drawing. CONUS_ERROR_MEMORY. */
conus_status picture_points_draw(struct draw_list *list, const struct picture *picture);

/** A cut on a sheet: its middle in the world, unit vectors to its right and top, and where it is drawn, pixels. */
struct picture_plane {
    const double *centre, *right, *up;
    double pixels_per_mm;
    double middle[2];
    struct draw_box box;
};

/** The balls that come near the cut, likewise: those that it goes through, and of smaller ones all to 2 mm from it.
 * Marks them in @p shown [options.point_count]. */
conus_status picture_points_cut(struct draw_list *list, const struct picture *picture,
                                const struct picture_plane *plane, bool *shown);

/** Likewise, of a cut that fills the drawing. */
conus_status picture_points_cut_whole(struct draw_list *list, const struct picture *picture, const conus_cut_view *view,
                                      bool *shown);

/** Writes into the lower left corner of the drawing how many are not @p shown in any cut, unless there are none. */
void picture_points_count(struct draw_list *list, const struct picture *picture, const bool *shown);

enum { PICTURE_TEXT = 160, PICTURE_NUMBER = 24 };

/** What pictures call an object, perhaps in @p out: path_title() of a number in the file of its voxels, or the atlas's
 * first; else its name with spaces for underscores, and "left" or "right" for a letter L or R at its beginning or end
 * where that is the area's side, unless left and right are exchanged, or another object would then be called so. */
const char *picture_name(char out[PICTURE_TEXT], const struct picture *picture, uint32_t number);

/** A coordinate: all its digits where it was given with up to six after the point, else @p most, which show less than
 * a pixel. */
void picture_put_place(char out[PICTURE_NUMBER], double value, int most);

/** The legend's words about where a cone begins, and its direction, in the space of @p frame; NULL = RAS mm. */
void picture_describe_cone(char out[2][PICTURE_TEXT], const struct cone *cone, const conus_frame *frame);

/** Makes the drawing, and with it the sheet, as low as @p height, but the sheet not lower than a legend beside the
 * drawing. A legend below follows. */
void picture_lower(struct picture *picture, uint32_t height);

/** Adds the key to the image. */
conus_status picture_add_key(conus_image *image, const struct picture *picture);

void picture_legend_draw(struct draw_list *list, const struct picture *picture);

/** Pixel of a device of n x n, the lowest row first, that a pixel of its image shows, which begins at the top; and the
 * other way round. */
static inline size_t picture_flipped(uint32_t n, size_t pixel)
{
    return (n - 1 - pixel / n) * n + pixel % n;
}

/** Adds paths and SHA-256 of the atlas's files to the image's header; those of the context only if @p context. */
conus_status picture_add_volumes(conus_image *image, const conus_atlas *atlas, bool context);

/* A cut's view, as the picture of a cut and the figure around it read it. */

/** CONUS_ERROR_ARGUMENT for a width or height that no cut has. */
conus_status cut_view_check_size(const conus_cut_view *view);

/** The axes of the picture; those of an axial cut unless the caller chose some. */
void cut_view_axes(double right[3], double up[3], const conus_cut_view *view);

/** The cone or cylinder of a selection, which must outlive @p out. */
void cutter_cone(struct cut_cone *out, const conus_selection *selection);

/** Without a cone, or colours that somebody chose, pathways and bundles stand out from areas: they have their own
 * colours, and areas that are not in @p listed, which may be NULL, are a neutral grey.
 * @param[out] out [objects + 1] What stands out, to be freed; NULL where there is a cone, colours were chosen, or
 * neither pathways nor bundles are shown.
 * @return CONUS_OK or CONUS_ERROR_MEMORY. */
conus_status cutter_list_tracts(bool **out, const conus_atlas *atlas, const conus_selection *selection,
                                bool own_colours, const bool *listed);

/** What the figure around a cut says about the answer. */
struct cutter_figure {
    cut_line *line; /**< Gets the lines of surfaces, which are then not drawn. */
    void *line_user;
    const uint32_t *ranks;   /**< [objects + 1] NULL = picture_ranks().                          */
    const uint8_t *emphasis; /**< [objects + 1] NULL = picture_emphasis(). */
    const bool *listed;      /**< [objects + 1] What has its own colour unless it has a rank; NULL = nothing. */
    bool has_cone;           /**< It is drawn. */
};

/** Draws what conus_cutter_draw() does, as the figure says. @p out is the cutter's. */
conus_status cutter_draw_figure(const struct cut **out, conus_cutter *cutter, const conus_cut_view *view,
                                const struct cutter_figure *figure);

#endif
