/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Changes of the atlases themselves while they are shown: which of them is drawn, which of their objects are
 * shown, thresholds, colours, the
 * context's transfer function, and of how they look. */
#ifndef CONUS_VIEWER_MODEL_ATLAS_EDITS_H
#define CONUS_VIEWER_MODEL_ATLAS_EDITS_H

#include "conus/picture.h"
#include "viewer/pictures/appearance.h"

struct view_atlas;
struct viewer;

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
/** Moves them (appearance_move_grey()) from where they are; false where the drawn atlas has no context, or one of a
 * single value. */
bool viewer_move_grey(struct viewer *viewer, double right, double up);
/** Opacity in 3-D, 0 to 1, of an object of the drawn atlas and all below it, NaN = as if none was set; of object 0: of
 * what the cone does not hit, more than 0. */
void viewer_set_opacity(struct viewer *viewer, uint32_t object, double opacity);
/** Draws a pathway of the drawn atlas so (appearance.h). */
void viewer_set_haze(struct viewer *viewer, uint32_t pathway, size_t haze);
/** Colours the streamlines of the drawn atlas by this (tract_colour_name() in pictures/appearance.h). */
void viewer_colour_streamlines(struct viewer *viewer, size_t colour);
/** Takes over how @p view, one of the viewer's atlases, looks; @p look is of as many objects. */
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
