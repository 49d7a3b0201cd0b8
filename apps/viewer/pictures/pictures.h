/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The pictures of the window: the eye that sees them, the look of an atlas, and the thread that draws them. */
#ifndef CONUS_VIEWER_PICTURES_PICTURES_H
#define CONUS_VIEWER_PICTURES_PICTURES_H

#include "conus/picture.h"
#include "conus/selection.h"
#include "link/station.h"

#include <stddef.h>
#include <stdint.h>

/* The eye that sees a picture, and where things lie in the picture. The eye is on an orbit around a point, or that
 * of a tracked head. World RAS+, mm. */

struct orbit {
    double centre[3];
    double distance;           /**< From it to the eye. */
    double azimuth, elevation; /**< Radians: 0, 0 looks from the front (+y); azimuth grows to the head's left. */
    double field_of_view;      /**< Vertical, radians.                                                        */
};

/** Looks from the front left above, so that a ball of @p radius around @p centre fills the pane. */
void orbit_look_at(struct orbit *orbit, const double centre[3], double radius);

/** Fits the field of view to a pane, so that what fills a square one shows whole in any. */
void orbit_fit(struct orbit *orbit, const double size[2]);

/** The camera: looks down its own -z, +y up. */
void orbit_camera(conus_pose *out, const struct orbit *orbit);

/** Looks from there, radians, at the same centre. */
void orbit_look_from(struct orbit *orbit, double azimuth, double elevation);
/** Goes around by so many pixels of a pane @p height pixels high; moves the centre along the picture; comes nearer by
 * that many clicks of a wheel. */
void orbit_turn(struct orbit *orbit, double right, double down, double height);
void orbit_pan(struct orbit *orbit, double right, double down, double height);
void orbit_zoom(struct orbit *orbit, double clicks);

/** The eye of a picture: a camera and what it sees, as conus_view has them. */
struct eye {
    conus_pose camera; /**< Looks down its own -z, +y up.                               */
    double frustum[4]; /**< The picture's left, right, lower and upper edge at depth 1. */
};

/** The eye on an orbit, for a picture of width x height pixels. */
void eye_of_orbit(struct eye *out, const struct orbit *orbit, const double size[2]);
/** Whether both are the same to the last bit. */
bool pose_is_same(const conus_pose *a, const conus_pose *b);
/** Whether both see the same. */
bool eye_is_same(const struct eye *a, const struct eye *b);
/** Widens or narrows the frustum, so that a picture of that size has square pixels. */
void eye_fit(struct eye *eye, const double size[2]);

/** Where world point @p p lies in such a picture: x right, y down from the top left. False behind the eye. */
bool eye_project(double out[2], const struct eye *eye, const double size[2], const double p[3]);
/** The unit direction from the eye through a point of such a picture. */
void eye_ray(double direction[3], const struct eye *eye, const double size[2], const double at[2]);

struct head {
    bool named;               /**< A tool is on it: --head.                                       */
    bool on;                  /**< The 3-D pane shows what it sees.                               */
    bool known;               /**< The eye below is one.                                          */
    bool inside;              /**< The newest eye was in the screen's plane or behind, and is not the one below. */
    enum station_state state; /**< The state of its tool. */
    double eye[3];
    conus_pose screen; /**< Its middle, +x to its right, +y up, +z to the viewer.          */
    double size[2];    /**< Width and height of the screen, mm; 0, 0 = not known. */
    unsigned number;   /**< Grows with every change that shows.                            */
};

/** Takes over where the eye and the screen are now. */
void head_move(struct head *head, const double eye[3], const conus_pose *screen);
/** Takes over the state of the head's tool. */
void head_set_state(struct head *head, enum station_state state);
/** Switches between the head's view and the one that the mouse turns. False: there is no head. */
bool head_toggle(struct head *head);

/** Its view through a part of the screen: left, right, lower and upper edge, each from 0 to 1 of the whole. False
 * where that is not shown, or never was seen. */
bool head_eye(struct eye *out, const struct head *head, const double part[4]);
/** One line about the head; *is_well tells whether it is seen. NULL where it does not matter. */
const char *head_text(const struct head *head, bool *is_well);

/* A selection that the window and the painter hold together; it ends with the last of them. */

struct answer;

/** Takes @p selection over. NULL without memory, and then it is the caller's still. */
struct answer *answer_create(conus_selection *selection);
struct answer *answer_keep(struct answer *answer);                    /**< NULL is fine. */
void answer_drop(struct answer *answer);                              /**< NULL is fine. */
const conus_selection *answer_selection(const struct answer *answer); /**< NULL for NULL. */

/** Takes most of the colour out of [count] pixels of a picture of an answer that is old. */
void answer_pale(uint8_t *rgba, size_t count);

/* The look of an atlas: the user's settings of how it is drawn. They change pictures, never answers. */

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

bool sheet_is_same(const struct sheet *a, const struct sheet *b);

/* The 3-D pictures, drawn by conus_render() on a thread with a GL context of its own, so that the window never waits
 * for them. While the view moves they are coarse and quick, as is the first one without a GPU; when it rests they
 * become fine. All functions are for one thread, the window's. */

struct painter;

/** A picture to draw. */
struct painting {
    struct eye eye;
    uint32_t width, height;
    double fade;
    bool leaves_context; /**< A context that areas cover is not drawn. */
    enum backdrop backdrop;
    bool is_dark;           /**< The theme, if it is that of the theme. */
    bool own_colours;       /**< As of conus_view. */
    uint32_t chosen;        /**< Object that is never pale; 0 = none. */
    struct answer *answer;  /**< What it hits stands out; its cone is not drawn. NULL = none. */
    bool is_old;            /**< The answer: what it hits is pale. */
    unsigned answer_number; /**< Two paintings of the same number have the same answer. */
    unsigned plan_number;   /**< Likewise of plans, with which there is an answer before there is a cone. */
    unsigned scene_number;  /**< Changes with hidden objects, the transfer function, opacities and the atlas. */
    bool moving;            /**< Another one will follow soon: be quick. */
};

/** Whether both would give the same picture, be it coarse or fine. */
bool painting_shows_same(const struct painting *a, const struct painting *b);

/** A drawn picture. */
struct painted {
    uint32_t width, height; /**< At most what was asked. */
    uint8_t *rgba;          /**< sRGB, top row first; to be freed with free(). */
    struct painting what;   /**< Without the answer. */
    double milliseconds;
    bool fine; /**< Nothing finer will come of the same painting. */
};

/** sRGB of an image, not premultiplied, to be freed with free(); NULL without memory. */
uint8_t *painted_bytes(const conus_image *image);

/** Starts the thread; @p transfer and @p log (called on that thread) as in conus_renderer_options, opacities and haze
 * as @p appearance says, which is copied. @p wake (NULL = none) is called there when there is something new: a picture,
 * or a text. False without memory or threads. */
bool painter_create(struct painter **out, const conus_atlas *atlas, const char *transfer,
                    const struct appearance *appearance, conus_log log, void (*wake)(void));
void painter_destroy(struct painter *painter);

/** Asks for a picture instead of what was asked before. */
void painter_ask(struct painter *painter, const struct painting *what);
/** Whether there was something new since the last time this was asked. */
bool painter_has_update(struct painter *painter);
/** The newest picture, once: false if there is none since the last one. */
bool painter_take(struct painter *painter, struct painted *out);
/** Waits until the thread does not read the atlas, which it does not do again before painter_resume(). */
void painter_hold(struct painter *painter);
/** The atlas may hide other objects now. */
void painter_resume(struct painter *painter);
/** Draws with the opacities of @p appearance from now on; false without memory. */
bool painter_set_opacity(struct painter *painter, const struct appearance *appearance);
/** Draws with another transfer function; false without memory. */
bool painter_set_transfer(struct painter *painter, const conus_transfer_point *points, size_t count);

/** The transfer function that is used, up to @p capacity points; 0 before it is known, or where there is no context. */
size_t painter_transfer(struct painter *painter, conus_transfer_point *points, size_t capacity);

/** Whether areas that were shown in the newest picture cover the context, conus_context_is_covered(). */
bool painter_finds_cover(struct painter *painter);

/** Why nothing is drawn, in one line; what was logged last; the device that draws. */
enum painter_text { PAINTER_ERROR = 0, PAINTER_NOTE, PAINTER_DEVICE, PAINTER_TEXTS };
enum { PAINTER_TEXT = 256 };
/** False, and "", where there is none so far. */
bool painter_text(char out[PAINTER_TEXT], struct painter *painter, enum painter_text which);

/* The shape of some objects, as cells at its surface, and its shadow in a picture. World RAS+, mm. */

/** Cubes that have an object's place at their middle, and a neighbour that has not. */
struct cells {
    double (*middles)[3]; /**< [count] */
    size_t count;
    double edge; /**< Edge of each, mm. */
};

/** Finds the shape of all objects that @p wanted, [objects + 1], says, as cuts through @p atlas show them, in up to 64
 * cells along its longest side: where objects overlap, the one in front counts; hidden ones and surfaces that are not
 * closed have no cells. End it with cells_finish(). Errors: as of conus_cutter_draw(). */
conus_status cells_find(struct cells *out, const conus_atlas *atlas, const bool *wanted);
void cells_finish(struct cells *cells); /**< One that is all 0 is fine. */

/** Sets how far from the eye the nearest of them is, mm, in @p nearest, [height width], top row first, where what
 * stands there is farther: INFINITY = nothing. Each is a square; returns how wide the smallest is, pixels; 0 = there is
 * none. */
double cells_cast(float *nearest, uint32_t width, uint32_t height, const struct cells *cells, const struct eye *eye);

/* Edges of a picture of few pixels, which is to be enlarged: without steps as large as a pixel. */

/** Makes each pixel of @p rgba [height][width][4] at an edge the mean of those along the edge, whose direction is that
 * in which the colours around the pixel change least. Without memory it stays as it is. */
void edges_smooth(uint8_t *rgba, uint32_t width, uint32_t height);

#endif
