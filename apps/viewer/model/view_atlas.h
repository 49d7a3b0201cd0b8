/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One of the atlases in the window: what is hidden in it, and its answer to the question that all get. */
#ifndef CONUS_VIEWER_MODEL_VIEW_ATLAS_H
#define CONUS_VIEWER_MODEL_VIEW_ATLAS_H

#include "conus/own.h"
#include "viewer/model/tool.h"
#include "viewer/pictures/answer.h"
#include "viewer/pictures/appearance.h"

enum { SEARCH_SIZE = 64 };

/** Which areas and pathways of an atlas are shown. */
struct shown_objects {
    bool *hidden;    /**< [object_count + 1] */
    uint32_t chosen; /**< The object that was clicked in the list of areas; 0 = none. */
    char search[SEARCH_SIZE];
};

struct view_atlas {
    conus_atlas *atlas;
    char *path; /**< As it was given. */
    char *name; /**< In the column `atlas`; "" where it is the only one. */
    size_t object_count;
    double box[2][3]; /**< Around all of its objects, those that are hidden, too; low above high = there are none. */
    char *sides;      /**< [object_count + 1] Of conus_atlas_sides(). */
    const char **prefixes; /**< [object_count + 1] Of conus_atlas_prefixes(). */
    double found_grey[2];  /**< Grey values of the context that the cuts show as black and white, unless the look says
                            others: what air and bright tissue have; both 0 without one. */
    bool is_covered;       /**< conus_context_is_covered() */
    struct appearance appearance;
    struct shown_objects shown;
    struct file_watch *watch;
    conus_selector *selector;           /**< Made when needed; NULL after the atlas changed. */
    conus_selector_options made_with;   /**< The selector. */
    char *made_level;                   /**< Its level; NULL = none. */
    struct answer *answers[TOOL_COUNT]; /**< To the newest question, for each tool; NULL = none. */
    struct answer *nothing;             /**< Of view_atlas_nothing(). */
    conus_selector *pickers[2];         /**< For picker.c, by conus_layers; made when needed. */
    conus_cutter *probe;                /**< Likewise. */
};

/** The input of view_atlas_init(). */
struct view_source {
    conus_atlas *atlas;
    const char *path, *name; /**< NULL = "". */
};

/** Does not take the atlas over; false without memory. */
bool view_atlas_init(struct view_atlas *out, const struct view_source *source);
/** Ends all but the atlas itself. */
void view_atlas_finish(struct view_atlas *view);

/** Asks for what is in the cone of a tool, of full opening @p angle, degrees. Where that fails, there is no answer. */
conus_status view_atlas_select(struct view_atlas *view, enum tool_number tool, const conus_selector_options *options,
                               const conus_pose *pose, double angle);
/** The answer to a cone of these options from @p pose, where nothing is: pictures with it have no colour of their
 * files. NULL without memory. */
struct answer *view_atlas_nothing(struct view_atlas *view, const conus_selector_options *options,
                                  const conus_pose *pose);
/** Makes the selector, unless there is one with these options. */
conus_status view_atlas_prepare(struct view_atlas *view, const conus_selector_options *options);
/** Ends what was made for the atlas and would have to be made anew after a change; the answer stays. */
void view_atlas_invalidate(struct view_atlas *view);
/** Ends the answer for a tool. */
void view_atlas_forget(struct view_atlas *view, enum tool_number tool);

/** The answer for a tool; NULL = none. */
const conus_selection *view_atlas_selection(const struct view_atlas *view, enum tool_number tool);
/** Index of the context volume, or the number of volumes where there is none. */
size_t view_atlas_context(const struct view_atlas *view);
/** Grey values that the cuts show as black and white now. */
const double *view_atlas_grey(const struct view_atlas *view);
/** Whether the same file is the context of both, or none is. */
bool view_atlas_shares_context(const struct view_atlas *a, const struct view_atlas *b);
/** How many of its objects are hidden. */
size_t view_atlas_hidden(const struct view_atlas *view);
/** Whether pathways or bundles are shown, for which pictures leave areas out. */
bool view_atlas_shows_tracts(const struct view_atlas *view);
enum { VIEW_ATLAS_TITLE = 256 };
/** The name of object @p number in lists and pictures; its kind stands before the name where another kind has the same
 * name. */
const char *view_atlas_title(char out[VIEW_ATLAS_TITLE], const struct view_atlas *view, size_t number);
/** The title of object @p number under a @p name that it had before. */
const char *view_atlas_title_of(char out[VIEW_ATLAS_TITLE], const struct view_atlas *view, size_t number,
                                const char *name);
/** The side of object @p number as view_atlas.sides has it, but none where left and right are exchanged: 'L', 'R', 'B'
 * or a space. */
char view_atlas_side(const struct view_atlas *view, size_t number);
/** The volume of a pathway from a threshold on; NULL of another object. */
const conus_volume_info *view_atlas_pathway(const struct view_atlas *view, uint32_t object);

#endif
