/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file picture.h
 * Pictures of an atlas: a renderer draws it in space, a cut shows it in a plane.
 */
#ifndef CONUS_PUBLIC_PICTURE_H
#define CONUS_PUBLIC_PICTURE_H

#include <conus/image.h>
#include <conus/space.h>
#include <conus/study.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_renderer conus_renderer; /**< One atlas made ready for pictures. */

/** @name In space
 * A renderer belongs to the thread that made it. It draws with OpenGL, or by rays on all processors; the pictures look
 * the same. By rays they have the same bytes on every system.
 * @{ */

/** How a renderer draws a pathway as haze: by colours and opacities of its values, as a context. */
typedef struct conus_pathway_transfer {
    uint32_t pathway;     /**< Its number; 0 = every one that has no entry of its own. */
    const char *transfer; /**< Preset name or TF file, over the values from where the pathway begins to its largest;
                             "own" = its own colour, denser where values are larger. */
} conus_pathway_transfer;

/** How a renderer draws. */
typedef struct conus_renderer_options {
    size_t struct_size;   /**< Its size, as #CONUS_RENDERER_OPTIONS_INIT sets it; 0 = that of this version. */
    const char *transfer; /**< Preset name or TF file (docs/formats.md) of the context; NULL = the manifest's, or else
                             "brain". */
    uint64_t max_memory;  /**< Limit for textures, and for a picture, bytes; 0 = 8 GiB. */
    conus_log log;        /**< NULL = silent. */
    void *log_user;       /**< Passed to @p log. */
    const conus_pathway_transfer *pathways; /**< [pathway_count] Pathways that are haze in place of surfaces; only the
                                               voxels that belong to them are drawn. */
    size_t pathway_count;                   /**< 0 = none. */
    const char *streamline_colour; /**< Streamlines are coloured by "bundle", by "direction" (red: left to right, green:
                                      back to front, blue: upwards), or by a number that their files have for points or
                                      streamlines, by its name. NULL = "bundle". Copied. */
    conus_engine engine; /**< What draws. #CONUS_ENGINE_AUTO = OpenGL where there is a driver, else rays, with a word in
                            @p log. */
} conus_renderer_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_RENDERER_OPTIONS_INIT CONUS_INIT_(conus_renderer_options)

/** A point of a transfer function, which is piecewise linear between them (Eq. 8). */
typedef struct conus_transfer_point {
    double value;   /**< Grey value of the context. */
    double rgba[4]; /**< sRGB, and the opacity of 1 mm; 0 to 1. */
} conus_transfer_point;

/** Makes an atlas ready for pictures.
 * @param[out] out The renderer; end it with conus_renderer_destroy().
 * @param atlas Must outlive the renderer.
 * @param options NULL = defaults.
 * @return #CONUS_OK; with #CONUS_ENGINE_GL #CONUS_ERROR_GL without an OpenGL 4.5 context and #CONUS_ERROR_UNSUPPORTED
 * in a build without OpenGL; #CONUS_ERROR_MEMORY above max_memory; the errors of reading a TF file. */
CONUS_CHECKED conus_status conus_renderer_create(conus_renderer **out, const conus_atlas *atlas,
                                                 const conus_renderer_options *options);

/** Ends a renderer.
 * @param renderer NULL is allowed. */
CONUS_API void conus_renderer_destroy(conus_renderer *renderer);

/** Names what draws, as GL calls its renderer.
 * @param renderer The renderer.
 * @return "llvmpipe (LLVM 15.0.6, 256 bits)", or "rays". Borrowed from the renderer. */
CONUS_API const char *conus_renderer_device(const conus_renderer *renderer);

/** Gives the transfer function of the context.
 * @param[out] count How many points; 0 where there is no context.
 * @param renderer The renderer.
 * @return [count] Borrowed until it is changed. */
CONUS_API const conus_transfer_point *conus_renderer_transfer(size_t *count, const conus_renderer *renderer);

/** Changes the transfer function of the context.
 * @param renderer The renderer.
 * @param points [count] Their values never fall. Copied.
 * @param count 1 to 4096.
 * @return #CONUS_OK, also without a context, where it changes nothing; #CONUS_ERROR_ARGUMENT for other points. */
CONUS_CHECKED conus_status conus_renderer_set_transfer(conus_renderer *renderer, const conus_transfer_point *points,
                                                       size_t count);

/** Takes over what has been hidden and shown in the atlas since the renderer was made.
 * @param renderer The renderer.
 * @return #CONUS_OK; #CONUS_ERROR_GL where the driver fails. */
CONUS_CHECKED conus_status conus_renderer_update(conus_renderer *renderer);

/** A side of the head from which a picture shows it. */
typedef enum conus_side {
    CONUS_SIDE_OF_CONE = 0, /**< The cone's; without one from the front, left and above. */
    CONUS_SIDE_LEFT,        /**< From the left, anterior to the left of the picture. */
    CONUS_SIDE_RIGHT,       /**< From the right, anterior to the right of the picture. */
    CONUS_SIDE_FRONT,       /**< From the front, the person's right to the left of the picture. */
    CONUS_SIDE_BACK,        /**< From the back. */
    CONUS_SIDE_TOP,         /**< From above, anterior up. */
    CONUS_SIDE_BOTTOM,      /**< From below, anterior up, the person's right to the left of the picture. */
    CONUS_SIDE_BESIDE_CONE, /**< 60 degrees off the cone's axis, whence the place of the best hit is seen best, and with
                               all of the cone in the picture; without a cone as #CONUS_SIDE_OF_CONE. */
    CONUS_SIDE_ACROSS_CONE  /**< At right angles to the cone's axis, from above by 25 degrees where there is such a
                               direction, and with all of the cone in the picture; without a cone as
                               #CONUS_SIDE_OF_CONE. */
} conus_side;

/** Where a picture's legend is. */
typedef enum conus_legend {
    CONUS_LEGEND_AUTO = 0, /**< On the right of a picture that is wider than high, where it takes at most two fifths of
                              the width with all its letters as large as others; else, and with a frustum, below. */
    CONUS_LEGEND_RIGHT,    /**< Beside the drawing, in at most half the width; the picture is as large as asked for. */
    CONUS_LEGEND_BELOW, /**< Below the drawing, in columns: the picture becomes higher by it, at most by half, in print
                           at most twice as high. */
    CONUS_LEGEND_NONE   /**< Nowhere; letters of directions and the scale stay. */
} conus_legend;

/** The background of a drawing. */
typedef enum conus_background {
    CONUS_BACKGROUND_LIGHT = 0,  /**< A light grey, darker below. */
    CONUS_BACKGROUND_COLOUR,     /**< One colour. */
    CONUS_BACKGROUND_TRANSPARENT /**< Nothing; text is dark. */
} conus_background;

/** A probe in a picture: a line along the axis, with what it passes. */
typedef struct conus_drawn_probe {
    const char *name;            /**< UTF-8; NULL = none. */
    const conus_table *segments; /**< Of conus_segments(), of a selector whose frame is the world. The line ends where
                                    they end, and begins where they begin, or not far before the first object. */
} conus_drawn_probe;

/** A point in a picture: a ball, perhaps with a line to where it points. Or a mark over a picture in space, whatever
 * lies before it: a line, or a disc around its first end, or in place of both a name beside that, with a thin line to
 * it. */
typedef struct conus_drawn_point {
    const char *name;  /**< UTF-8, beside the ball where it hides neither a ball nor another name; NULL = none. */
    const char *group; /**< Points of one group have one colour and a row in the legend: the first six groups have one
                          each, all others one together. More than six that are numbers, or "n/a", have
                          the colours of a scale where @ref conus_view.group_title says what they are. NULL = none.
                          Not of marks. */
    double at[3];      /**< World mm. A mark is not drawn where one of its ends is behind the camera. */
    double end[3];     /**< Where the line ends, world mm; of points NaN = there is no line. A cut shows it firmly where
                          it is as near as a ball's middle has to be, and faintly where it goes on. */
    double radius;     /**< Of the ball, mm, from 0 on; 0 = 1. Balls that would hardly be seen are drawn larger, and the
                          paler the farther they lie behind the atlas's middle. Of a mark's disc, in 14ths of the
                          letters' size; 0 = the line. */
    uint8_t rgb[3];    /**< sRGB of a mark's line or disc. */
    bool dashed;       /**< A mark's line has dashes, which go on in the next mark. */
    bool hollow;       /**< A point's ball is a ring: its row has no answer. */
    uint32_t object;   /**< Of a mark: its name is that of this object, as in the legend; 0 = `name`. */
} conus_drawn_point;

/** How near to a cut the middle of a smaller ball is drawn there, mm. */
#define CONUS_POINT_NEAR_CUT 2.0

/** Options of conus_render(). */
typedef struct conus_view {
    size_t struct_size;   /**< Its size, as #CONUS_VIEW_INIT sets it; 0 = that of this version. */
    uint32_t width;       /**< Pixels, 1 to 16384; 0 = 1400. */
    uint32_t height;      /**< Pixels, 1 to 16384; 0 = 1050. */
    uint32_t slices;      /**< N of Eq. 7; 0 = default. */
    double field_of_view; /**< Vertical, degrees, in (0, 180); 0 = 30. */
    double frustum[4]; /**< Instead, of a camera: where its picture's left, right, lower and upper edge are at depth 1
                          (tangents, as glFrustum() has them at its near plane), off-axis, too. All 0 = symmetric, as
                          wide as field_of_view says. */
    const conus_pose *camera; /**< NULL = one that shows the whole atlas, from the cone's side where one is drawn. */
    const conus_selection *selection; /**< NULL = none; else draws its cone, axis and contacts. */
    uint32_t chosen;                  /**< Object that is never pale, with those below it in the area tree, in pictures
                                         with own_colours and without a selection; 0 = none. */
    bool no_legend;                   /**< Leave out the text. */
    bool draft;          /**< Leave edges rough, and many streamlines out where there are many: quicker. Lines
                            are at least a pixel wide. */
    double fade;         /**< How much the context is thinned: 0 = as its transfer function, or the opacity of its
                            surfaces, says, 1 = gone. */
    conus_side side;     /**< Without a camera: from where the whole atlas is seen. */
    conus_legend legend; /**< Where the legend is; it is there with a selection or coloured streamlines. */
    conus_background background; /**< The background. */
    uint8_t background_rgb[3];   /**< sRGB, of #CONUS_BACKGROUND_COLOUR. */
    double dpi; /**< Pixels per inch, up to 100000: letters have 7 points, and files say it; 0 = not known, letters
                   are as high as a 54th of the shorter side. */
    const double *opacity;    /**< [object count + 1] Opacity of the surface of each object, by number, 0 to 1; NaN =
                                 as @p pale says. An area that is given one is drawn beside pathways, too. NULL = all
                                 NaN. Not of pathways that are haze. */
    double pale;              /**< Opacity of what the selection does not hit, of all without a selection; 0 = 1, as of
                                 what it hits; with neither @p opacity, @p camera nor @p own_colours 0.1 where something
                                 hit would not be seen. */
    const conus_frame *frame; /**< In which the legend says where the cone begins; NULL = RAS mm. */
    const bool *listed;   /**< [object count + 1] What stands out and has a row in the legend beside what the selection
                             hits, as far as it is drawn, by number. NULL = with a selection what @p opacity names,
                             without one everything that is drawn, in a legend that is asked for by its place or by
                             @p legend_rows. */
    uint32_t legend_rows; /**< The legend has at most so many rows of objects, and one that counts the others; 0 = as
                             many as there is room for. Not 0 with #CONUS_LEGEND_NONE = the legend stands elsewhere,
                             with so many rows: what has a number there has it in the picture. */
    bool no_pale;         /**< Objects that the selection does not hit, and without one all, are not drawn
                             unless @p opacity says otherwise. */
    bool shapes;          /**< Keep text, legend, scale bar and the outlines of cuts out of the pixels, as shapes for
                              conus_image_write() of .svg and .pdf, which need it. */
    const double *measured;  /**< [6] Two places, world mm: the line between them lies over all else, with its length;
                                not with no_legend, nor where an end is not in the drawing. In a cut it is firm where
                                it lies in it, half a voxel away at most, faint to 25 mm, and has its length only where
                                some of it is firm: "in 3-D" unless all is. NULL = none. */
    conus_progress progress; /**< Called for each piece that is drawn; false ends the picture. NULL = no callback, and
                                quicker by what waiting for each piece costs. */
    void *progress_user;     /**< Passed to @p progress. */
    const conus_drawn_probe *probes; /**< [probe_count] Without a selection: lines over the drawing, in the colours of
                                        what they pass, which stands out as what a selection hits. On the right, in at
                                        most half of the width and in the place of a legend, each has a strip of its
                                        segments: by depth, mm from the pose, with names, or abbreviations where names
                                        do not fit; the names of the longest segments where they are too many. */
    size_t probe_count;              /**< 0 = none. */
    bool has_unselected; /**< Areas and pathways that the selection or the probes do not hit have one colour. */
    uint8_t
        unselected_rgb[3]; /**< It, sRGB; else they are a neutral grey with a selection, or have their own, paler. */
    bool own_colours;      /**< With a selection: objects have their own colours. Else, unless the atlas has a palette
                              (conus_atlas_use_palette(), not the safe colours), what is hit has one of six colours by
                              its place in the answer: what is hit first, then pathways, bundles and what is listed,
                              areas behind others, and what else stands out. From the seventh on it is grey, with a
                              number in picture and legend; areas that are only behind others have no chip there. All
                              else is a neutral grey. Pathways that are haze have their own. */
    bool no_cone;          /**< With a selection: only its contacts are drawn, not its cone. */
    bool print;            /**< As for paper: what is drawn in space has a thin dark line around it, and of several
                              panels each has a letter: a, b, c. */
    const conus_drawn_point *marks;  /**< [mark_count] Over the drawing; names not with no_legend, nor where they would
                                 lie on  one before or beside the drawing. */
    size_t mark_count;               /**< 0 = none. */
    const conus_drawn_point *points; /**< [point_count] Without probes: balls over the drawing, and over cuts
                                        that go through them or, of smaller ones, are up to #CONUS_POINT_NEAR_CUT from
                                        their middle. With a selection they are white, unless @p own_colours or the
                                        palette leave it no colours; without one areas are a neutral grey unless @p
                                        own_colours, the palette or
                                        @p listed gives them colours. The picture shows those up to three radii of the
                                        atlas from its middle; how many are outside, and how many names have no room,
                                        stands in its corner. */
    size_t point_count;              /**< 0 = none. */
    const char *title; /**< UTF-8: what the selection is of, such as the name of its pose, at the head of its legend;
                          NULL = nothing. */
    bool no_covered_context; /**< A context of which opaque areas cover all that could be seen is not drawn. */
    bool is_beam;            /**< The selection's cone is a beam from where it ends to its focus, at its apex. */
    const char *group_title; /**< UTF-8: what the groups of points are; those that are numbers have a scale of this
                                name. NULL = none has. */
} conus_view;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_VIEW_INIT CONUS_INIT_(conus_view)

/** Draws the atlas: its areas, or its pathways where it has any (all areas would hide them), and then of the areas
 * those that the selection hits, or with #CONUS_LAYERS_ALL passes. Where left and right, or the like, are across the
 * picture to within 15 degrees, letters at its edges say so; else a cross of all directions does. These and the scale
 * bar lie beside what is drawn; with a camera in the corner where they hide least, on a patch where they hide
 * something. The legend lists what conus_selection_result() lists, in that order. Its letters become smaller where
 * names do not fit, down to 6/7 of their size, below that only for a name that is wider than the place. Where rows do
 * not fit, the last ones behind others are counted in one. Where all is opaque, first hits that the camera does not see
 * are "(not seen)".
 * @param[out] out Channels R, G, B, A: float, linear light, premultiplied; A is 1 unless the background is transparent.
 * End it with conus_image_destroy().
 * @param renderer The renderer.
 * @param view What to draw.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a view out of its range; #CONUS_ERROR_MEMORY for a picture above the
 * renderer's max_memory, 32 bytes per pixel; #CONUS_ERROR_GL where the driver fails; #CONUS_ERROR_CANCELLED where
 * progress returns false. */
CONUS_CHECKED conus_status conus_render(conus_image **out, conus_renderer *renderer, const conus_view *view);
/** @} */

/** @name In a plane
 * The CPU draws cuts.
 * @{ */

/** A flat cut through an atlas: the context in grey, areas filled and outlined, surfaces as their contours, filled
 * where they are closed, pathways over them. Without a context areas lie on a grey. Labels are looked up, never
 * interpolated. In the picture borders are smooth: they move by at most half a voxel along each axis. */
typedef struct conus_cut_view {
    size_t struct_size;  /**< Its size, as #CONUS_CUT_VIEW_INIT sets it; 0 = that of this version. */
    double centre[3];    /**< World position of the picture's middle, mm. */
    double right[3];     /**< Unit vector to the picture's right; both 0 = +x and +y: axial, neurological. */
    double up[3];        /**< Unit vector to the picture's top, perpendicular to right. */
    double mm_per_pixel; /**< 0 = 1. */
    uint32_t width;      /**< Pixels, 1 to 16384. */
    uint32_t height;     /**< Pixels, 1 to 16384. */
    double fill;         /**< Opacity of areas, 0 to 1; 0 leaves their outlines. */
    bool no_outlines;    /**< Leave out the outlines of areas. */
    double window[2];    /**< Grey values of black and white; both 0 = those that span the contrast, without
                            a few extremes. */
    const conus_selection *selection; /**< NULL = none: beside pathways and bundles, without own_colours and a palette,
                                         areas are as those that are not hit; else its cone is drawn, areas that it
                                         hits are full, those that it only pierces hatched, and others pale. */
    uint32_t chosen;                  /**< Object that is never pale, with those below it in the area tree, in cuts with
                                         own_colours; 0 = none. */
    bool own_colours;                 /**< As of conus_view. Else areas that are not hit have only an outline, over an
                                         image, and are a neutral grey without one. */
    bool no_cone;                     /**< The selection's cone is not drawn. */
    const conus_pathway_transfer *pathways; /**< [pathway_count] Pathways that conus_render_cuts() colours by their
                                               values; NULL = as its renderer does. */
    size_t pathway_count;                   /**< 0 where pathways is NULL. */
} conus_cut_view;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CUT_VIEW_INIT CONUS_INIT_(conus_cut_view)

/** Draws a cut.
 * @param[out] rgba [height width 4] sRGB and opacity, top row first.
 * @param[out] objects [height width] Number of the object that each pixel's centre is in, 0 = nothing; NULL = not
 * wanted.
 * @param atlas The atlas.
 * @param view What to draw.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a view out of its range. */
CONUS_CHECKED conus_status conus_cut(uint8_t *rgba, uint32_t *objects, const conus_atlas *atlas,
                                     const conus_cut_view *view);

/** A plane through an atlas. */
typedef struct conus_cut_plane {
    double at[3];    /**< A point of it, world mm. */
    double right[3]; /**< Unit vector to the picture's right. */
    double up[3];    /**< Unit vector to the picture's top, perpendicular to it. */
} conus_cut_plane;

/** Draws cuts side by side on one sheet, all at the largest scale at which the box around the atlas and its context
 * fits in each: with the letters of directions outside of the cuts, below each one where its plane is, one scale bar,
 * and with a selection its cone in each cut and one legend. Black at the edges of a cut is the background, if nothing
 * else is there; without a context all is where nothing is.
 * @param[out] out Channels R, G, B, A, as of conus_render(). End it with conus_image_destroy().
 * @param atlas The atlas.
 * @param planes [count] Where the cuts are, in the order of reading.
 * @param count 1 to 400; 0 with a renderer, too.
 * @param look Its fill, no_outlines, window and chosen are those of all cuts. NULL = defaults.
 * @param renderer The atlas's, which draws the view in space before the first cut; NULL = only cuts.
 * @param sheet Of the whole: its size, legend, background, dpi, no_legend, selection, own_colours, print, listed,
 * points, title, is_beam and frame; all else is of the view in space. Without a selection, points and colours that
 * somebody chose, what is listed has its colour, and all other areas only outlines over an image; where there are
 * pathways or bundles these are what is listed, too. Its height 0 means as high as the cuts need it, at most three
 * quarters of the width, in print 1.4 times the width. With dpi outlines are half a point wide and of one grey. NULL =
 * defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for something out of its range, and for a sheet too small for so many cuts;
 * #CONUS_ERROR_DATA for an atlas in which nothing shows; #CONUS_ERROR_MEMORY for more than 8 GiB, at 32 bytes per
 * pixel; the errors of conus_render().
 * @threads The one that made the renderer; without one any, while none changes the atlas. */
CONUS_CHECKED conus_status conus_render_cuts(conus_image **out, const conus_atlas *atlas, const conus_cut_plane *planes,
                                             size_t count, const conus_cut_view *look, conus_renderer *renderer,
                                             const conus_view *sheet);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
