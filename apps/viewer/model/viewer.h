/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The state of the window apart from its look: the atlas, the cone and its hits, the hidden objects, the views of the
 * panes. Panels, panes, scripts and sessions read it and change it through these functions. */
#ifndef CONUS_VIEWER_MODEL_VIEWER_H
#define CONUS_VIEWER_MODEL_VIEWER_H

#include "viewer/model/plan_state.h"
#include "viewer/model/points.h"
#include "viewer/model/tool.h"
#include "viewer/model/view_atlas.h"
#include "viewer/pictures/camera.h"
#include "viewer/pictures/painter.h"

enum { EDITOR_POINTS = 32, EDITOR_BINS = 128 };

/** The context's transfer function while it is edited. */
struct transfer_editor {
    conus_transfer_point points[EDITOR_POINTS];
    size_t count;
    size_t held;                   /**< The point that is dragged; EDITOR_POINTS = none. */
    double low, high;              /**< Grey values shown.                               */
    double histogram[EDITOR_BINS]; /**< Heights, 0 to 1.                                 */
    bool ready;                    /**< The points are known.                            */
    bool counted;                  /**< And the grey values, which are when they are first shown. */
    bool edited;                   /**< The points are drawn with instead of the function that the context came with. */
};

enum shown { SHOWN_NOT = 0, SHOWN_IN_PART, SHOWN };

/** A session's settings of the atlases themselves. */
struct atlas_edits {
    double *const *thresholds; /**< [atlas_count][object_count + 1] by number; those of areas are not read. NULL, of all
                                    or of one atlas = as they are. Changed. */
    bool safe_colours;
    bool sets_transfer; /**< Then the points and the preset are; no points = the preset, or else the function that the
                             context came with. */
    const char *preset; /**< Static; NULL = none. */
    conus_transfer_point points[EDITOR_POINTS];
    size_t point_count;
};

/** The crosshair, and so the cuts, go along with this. */
enum follow { FOLLOW_NOTHING = 0, FOLLOW_TIP, FOLLOW_CONTACT, FOLLOW_COUNT };
enum plane { AXIAL = 0, CORONAL, SAGITTAL, PLANE_COUNT };
enum { PIN_LIMIT = 64, MESSAGE_SIZE_LIMIT = 256 };

/** A confirmed result, or the needle of a plan that was kept. */
struct pin {
    size_t atlas;    /**< Index of the viewer's atlas that was drawn then, in which it is. */
    uint32_t object; /**< 0 = a needle, or the atlas has it no longer, since its hemispheres are others. */
    char name[2 * PLAN_TEXT + 16]; /**< That it had then; of a needle the plan's verdict. */
    double share, distance;        /**< mm from the apex, of a needle to its tip. NaN = there was none. */
    double contact[3];             /**< World mm, of a needle its tip; NaN where there was none. */
    double entry[3];               /**< Where a needle begins; NaN of a result. */
    double apart;                  /**< mm from the pin before it; NaN of the first. */
};

/** Where the mouse's cones begin: at the surface under it, before that (point.h), or at the eye. */
enum starts { START_SURFACE = 0, START_BEFORE, START_EYE };

/** How all atlases are asked, for both tools, and what the first one's cone does besides. */
struct cone_state {
    enum starts start;              /**< Where the mouse's cones begin. */
    bool one_ray;                   /**< In place of the cone there is one ray along its axis, first hits only. */
    enum follow follow;             /**< The cone's tip, or the contact of its best hit in the drawn atlas. */
    conus_selector_options options; /**< Without a level. */
    char level[LEVEL_LIMIT];        /**< In the first atlas, as conus_selector_options has it; "" = none. */
    conus_order order;              /**< The order of the lists. */
};

/** How the panes draw. */
struct display {
    double fade, fill; /**< Fading of the context in 3-D; opacity of areas in the flat panes. */
    bool no_outlines, radiological, safe_colours, device_view;
    bool own_colours;       /**< With a cone, too, areas have the atlas's colours in place of those by rank. */
    enum backdrop backdrop; /**< Behind the 3-D pane and figures. */
};

/** Columns, order and format of the lists of hits (model/columns.h). All 0: the usual. */
struct result_list {
    uint32_t columns; /**< A bit for each column that was chosen; 0 = none was, the usual ones are shown. */
    size_t order;     /**< The column that rows are ordered by; 0 = the rank, */
    bool reversed;    /**< the other way round. */
    size_t format;    /**< The format of exported files (model/columns.h). */
};

struct viewer {
    struct view_atlas *atlases; /**< [atlas_count] As they were given. */
    size_t atlas_count;
    const char **names;       /**< [atlas_count] Theirs. */
    struct view_atlas *drawn; /**< The atlas that is drawn, searched, hidden in, picked and confirmed. */
    char *transfer;           /**< As it was given; NULL = the context's own. */
    const char *preset;       /**< Name of a transfer function in its place, static; NULL = none. */
    double centre[3], radius; /**< A ball around all atlases, world mm. */
    double half[3];           /**< Half the size of their box. */
    conus_frame frame;        /**< The space in which positions are typed, shown and written. */

    struct tool tools[TOOL_COUNT];
    struct cone_state cone;
    struct display display;
    struct result_list list;
    struct study_state study;
    struct plan_state plan;
    struct point_list points;
    uint32_t chosen_point; /**< Row of the list, from 1, that the first tool asks about; 0 = none. */

    /* where the panes look */
    struct orbit orbit;
    struct head head;
    struct measure {
        double points[6]; /**< Two places, mm. */
        uint32_t count;   /**< How many of them there are. */
        bool on;          /**< Clicks set them. */
    } measure;
    double crosshair[3];
    double magnification; /**< In the flat panes: 1 shows all. */

    struct pin pins[PIN_LIMIT];
    size_t pin_count;
    char message[MESSAGE_SIZE_LIMIT]; /**< The status line's last text. */
    struct painter *painter;
    unsigned atlas_number; /**< Grows when the atlas changes: what was made for it must be made anew. */
    unsigned scene_number; /**< Grows with what the painter draws otherwise than before from the same place. */
    struct transfer_editor transfer_editor;
    void (*wake)(void);
    unsigned version; /**< Grows with every change that the panes show. */
    unsigned moves;   /**< How many of these were moves of the first tool after which pictures have the same colours. */
    unsigned said;    /**< Grows with every message.                    */
};

/** Gets ready for @p count atlases, at least one, the first of which is drawn. They are taken over on success, their
 * strings, @p transfer and @p log are not; @p transfer, @p log and @p wake (painter.h) may be NULL. */
conus_status viewer_create(struct viewer *out, const struct view_source *sources, size_t count, const char *transfer,
                           conus_log log, void (*wake)(void));
void viewer_finish(struct viewer *viewer);
/** Finds the ball around all atlases anew, with what is hidden in them: what is seen stays where it is when another one
 * is drawn, or other areas are. */
void viewer_find_ball(struct viewer *viewer);

/** Puts one line into the status line. */
void viewer_say(struct viewer *viewer, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** A position of the viewer's space, in the world; false with a line in the status line. */
bool viewer_to_world(double world[3], struct viewer *viewer, const double given[3]);
enum { VIEWER_PLACE_TEXT = 96 };
/** A world position for people: "1.0, 2.0, 3.0 mm RAS", "AP 5400, DV 332, ML 5739 um". */
const char *viewer_place_text(char out[VIEWER_PLACE_TEXT], const struct viewer *viewer, const double world[3]);
/** How a coordinate is printed, and written so, without a "-0.0". Returns the characters. */
const char *viewer_place_format(const struct viewer *viewer);
size_t viewer_put_coordinate(char *out, size_t size, const struct viewer *viewer, double value);
/** How atlas @p index is asked for a tool: the options and its full opening, degrees, 0 of a cylinder; with one_ray
 * those of that ray. The level is borrowed from the viewer. */
double viewer_query(conus_selector_options *options, const struct viewer *viewer, enum tool_number tool, size_t index);
/** What the atlases are asked with: "cone", "cylinder", "axis" of a single ray, "point" or "ball". */
const char *viewer_shape(const struct viewer *viewer);
/** Pins @p pin. Its name is that of its object unless that is 0, and only then it has an entry. */
void viewer_pin(struct viewer *viewer, struct pin pin);
/** The first tool's answer in the drawn atlas; NULL = none. */
const conus_selection *viewer_selection(const struct viewer *viewer);
/** How lists call the object of a pin: as view_atlas_title() does, by the name that it had then. */
const char *viewer_pin_title(char out[VIEW_ATLAS_TITLE], const struct viewer *viewer, const struct pin *pin);
/** The pins as a table to paste, to be freed; NULL without memory. */
char *viewer_pins_text(const struct viewer *viewer);
/** The first tool's answers in all atlases as a table to paste, to be freed; NULL without memory. */
char *viewer_results_text(struct viewer *viewer);

/** Makes a report of @p format for each atlas, on a tool's answer, or why there is none; the texts of the first are
 * those of all. @p reports is [atlas_count], zeroed, and the caller's to end in any case. */
conus_status viewer_report(conus_report **reports, struct viewer *viewer, enum tool_number tool, conus_format format);

/** Writes what a tool selected in all atlases as conus query -o FILE.tsv does. */
conus_status viewer_write_results(struct viewer *viewer, enum tool_number tool, const char *path);

/** Sets the next of the two places whose distance is measured; after both the first one, anew. */
void viewer_measure(struct viewer *viewer, const double at[3]);
/** Their distance, mm; NaN without two. */
double viewer_distance(const struct viewer *viewer);
/** Puts the crosshair there, but not far from the atlas. */
void viewer_cross(struct viewer *viewer, const double at[3]);
/** The voxel that a place is in, of the first parcellation or else volume; false outside of it, or without. */
bool viewer_voxel(long voxel[3], const struct viewer *viewer, const double at[3]);
/** Chooses an object; the crosshair goes to its middle. */
void viewer_choose(struct viewer *viewer, uint32_t object);

/** The chosen object where all have the colours of their file; else only what is hit has one in pictures. 0 = none. */
uint32_t viewer_full(const struct viewer *viewer);
/** The place of an object in the answer, from 1, where pictures show it by a colour; 0 = it has its own, or is not hit.
 */
size_t viewer_rank(const struct viewer *viewer, uint32_t object);
/** The answer that pictures show the colours of: before there is a cone one without a hit; NULL = none, and all have
 * the colours of their file. */
struct answer *viewer_pictured(const struct viewer *viewer);
/** How much the context is thinned in 3-D: it is gone where it lies within areas through which nothing is seen. */
double viewer_fade(const struct viewer *viewer);
/** Grows with what cuts show: not with moves after which their colours are the same. */
unsigned viewer_cut_version(const struct viewer *viewer);
/** sRGB of an object that has this place; 0 = none. */
void viewer_rank_colour(uint8_t rgb[3], const struct viewer *viewer, uint32_t object, size_t rank);
/** sRGB of an object, as pictures have it. */
void viewer_colour(uint8_t rgb[3], const struct viewer *viewer, uint32_t object);

/** The library's own text of the score @p name, which selectors compare by its address; NULL = none of that name, such
 * as a formula, which a session cannot keep. */
const char *viewer_find_score(const char *name);

/** The cut through the crosshair, of @p size pixels: at magnification 1 the atlas fills the shorter side. */
void cut_view(conus_cut_view *out, const struct viewer *viewer, enum plane plane, const double size[2]);

/* Changes of the atlases themselves while they are shown (atlas_edits.c). */

/** Shows what is @p fresh, [atlas_count], in place of the viewer's atlases, which end: the same ones, otherwise divided
 * into areas, or with other pathways, bundles and contexts. Cone and views stay, and all are asked again. Then @p fresh
 * is to be ended by view_atlas_finish(). */
void viewer_exchange(struct viewer *viewer, struct view_atlas *fresh);

/** Draws atlas @p index of the viewer from now on; cone, answers and views stay. Points of the transfer function that
 * were edited stay where both atlases have the same context. */
void viewer_draw(struct viewer *viewer, size_t index);

/** Changes from which value on a pathway of the drawn atlas is one. */
void viewer_set_threshold(struct viewer *viewer, uint32_t object, double threshold);

/** Sets all at once; where that fails (memory), the atlases are as they were. */
conus_status viewer_set_up(struct viewer *viewer, const struct atlas_edits *settings);

/** Draws with a preset in place of the editor's points, or with NULL as the context came; @p preset is static. */
void viewer_use_preset(struct viewer *viewer, const char *preset);

/** Grey values that the cuts show as black and white, of the drawn atlas and those of the same context; both 0 = those
 * that were found. White is more than black. */
void viewer_set_grey(struct viewer *viewer, double black, double white);
/** Moves them (appearance_move_grey()); false where the drawn atlas has no context, or one of a single value. */
bool viewer_move_grey(struct viewer *viewer, double right, double up);
/** Sets the opacity in 3-D, 0 to 1, of an object of the drawn atlas and all below it; NaN = as if none was set. Object
 * 0: of everything that the cone does not hit, more than 0. */
void viewer_set_opacity(struct viewer *viewer, uint32_t object, double opacity);
/** Draws a pathway of the drawn atlas so (appearance.h). */
void viewer_set_haze(struct viewer *viewer, uint32_t pathway, size_t haze);
/** Colours the streamlines of the drawn atlas by this (tract_colour_name() in pictures/appearance.h). */
void viewer_colour_streamlines(struct viewer *viewer, size_t colour);
/** Gives @p view, one of the viewer's atlases, the look @p look, which is for as many objects. */
void viewer_set_look(struct viewer *viewer, struct view_atlas *view, struct appearance *appearance);

/** Draws with the editor's points from now on. */
void viewer_use_transfer(struct viewer *viewer);

/** Colours for any colour vision, or the atlases' own. */
void viewer_use_safe_colours(struct viewer *viewer, bool safe);

/** Hides or shows an object and all below it in the tree. What is hidden is not selected either. */
void viewer_hide(struct viewer *viewer, uint32_t object, bool hide);
/** Hides all but an object and what is below it. */
void viewer_isolate(struct viewer *viewer, uint32_t object);
void viewer_show_all(struct viewer *viewer);
/** Hides in @p view, one of the viewer's atlases, what @p hidden says, [object_count + 1], which is taken over. */
void viewer_set_hidden(struct viewer *viewer, struct view_atlas *view, bool *hidden);
/** Whether @p object is @p ancestor or below it. */
bool viewer_is_below(const struct viewer *viewer, uint32_t object, uint32_t ancestor);
/** How much of an object and all below it is shown. */
enum shown viewer_shown(const struct viewer *viewer, uint32_t object);

#endif
