/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The state of the window apart from its look: tools, points, atlases, and the functions by which panels,
 * panes, scripts and sessions read and change it. */
#ifndef CONUS_VIEWER_MODEL_VIEWER_H
#define CONUS_VIEWER_MODEL_VIEWER_H

#include "conus/atlas.h"
#include "conus/own.h"
#include "conus/picture.h"
#include "conus/pose.h"
#include "conus/status.h"
#include "options/progress.h"
#include "viewer/model/study.h"
#include "viewer/pictures/pictures.h"

#include <jansson.h>
#include <stdint.h>

/* A list of points and poses, such as contacts, optodes or coils: all are balls over the pictures, and one is
 * chosen, which the first tool then asks about. */

struct atlases;
struct common_settings;
struct viewer;

enum { POINT_LIMIT = 10000 /* rows */ };

struct point_list {
    conus_pose_list *poses;    /**< NULL = none. */
    conus_drawn_point *points; /**< [count] Of rows without an error. */
    uint32_t *rows;            /**< [count] Their numbers from 1. */
    size_t count;
    bool has_electrodes; /**< The groups are the points' own. */
    unsigned number;     /**< Of lists that are not the same. */
};

/** Loads the list @p path, of positions in @p frame, for @p atlases, whose space it must share. Returns the exit code
 * and prints an error unless it is 0; then *out is unchanged. */
int points_load(struct point_list *out, const char *path, const struct atlases *atlases, const conus_frame *frame,
                double radius, const struct common_settings *common, uint64_t max_memory);
void points_finish(struct point_list *list);
/** Puts @p list, which it takes over, in the place of the viewer's. The chosen row stays where points_check() says so
 * and it has the angle and radius of before, with its depths now; else these go with it, and the mouse points again.
 * Depths that were set by hand stay. */
void points_use(struct viewer *viewer, struct point_list *list);
/** Chooses a row by its number from 1: the tool goes there, and the crosshair to what it hits, or there; 0 = none, and
 * the mouse points again. The status line says where a row has an error. */
void points_choose(struct viewer *viewer, uint32_t row);
/** Of a list that may have changed no row is chosen where the tool is not. */
void points_check(struct viewer *viewer);
/** Moves the first tool to a row, with its angle or radius if it has one. */
void points_aim(struct viewer *viewer, const conus_pose_row *row);
/** The point of the chosen row; NULL = none. */
const conus_drawn_point *points_chosen(const struct viewer *viewer);

/* The two tools of the window. The same functions move, hold and confirm both. All atlases of the viewer are asked
 * what a tool's cone hits; the questions about the two tools differ only in pose and angle. World RAS+, mm. */

enum pointer {
    POINT_BY_MOUSE = 0,
    POINT_BY_WAND,
    POINT_BY_REPLAY,
    POINT_BY_TRACKER,
    POINT_BY_SPACEMOUSE,
    POINT_BY_GAMEPAD,
    POINTER_COUNT
};
/** The names of pointers in panels, scripts and messages. */
extern const char *const pointer_names[POINTER_COUNT];

enum tool_number { FIRST_TOOL = 0, SECOND_TOOL, TOOL_COUNT };

struct tool {
    bool on;              /**< The first one is always; the second one is off at first. */
    enum pointer pointer; /**< It moves the tool: only a tracker moves both tools. The second one never a replay. */
    conus_pose pose;
    bool has_pose, held; /**< Held: neither mouse nor device moves it. */
    bool is_point;       /**< Of the pose only the place counts: what is there, or in a ball of the cylinder's radius,
                            is the answer. Only of the first tool. */
    double angle;        /**< Full opening, degrees. */
    unsigned answer_number; /**< Tells answers apart, whose addresses may come again. */
    double select_ms;       /**< For all atlases. */
    /* of the second tool, which is asked when its answer is needed: */
    unsigned version;     /**< Grows with every change that shows; the viewer's does not: its cuts stay as they are. */
    unsigned asked_after; /**< The first tool's answer_number when the second was asked: each change of the question
                             gives the first one a new number. */
    bool is_asked;        /**< Its answers belong to the present pose and angle. */
};

/** Asks again for the first tool. To be called after options, score, its angle, or whether it has a pose changed:
 * without a pose there is no answer. */
void tool_reselect(struct viewer *viewer);
/** Takes the first tool's pose and answer away; the mouse may give it another pose. */
void tool_clear(struct viewer *viewer);

/** To be called when its pose or angle was changed. */
void tool_changed(struct viewer *viewer, enum tool_number number);
/** Moves it, held or not. */
void tool_aim(struct viewer *viewer, enum tool_number number, const conus_pose *pose);
/** Puts the first tool where a pose is, of which only the place counts. */
void tool_aim_point(struct viewer *viewer, enum tool_number number, const conus_pose *pose);
/** A number for which objects the first tool's answer has in the drawn atlas, in which order, how strong their colours
 * are, and which of them are only behind others: what pictures show of it. */
uint64_t tool_answer_sum(const struct viewer *viewer);
/** Whether it has a cone: a pose, and not only a place. */
bool tool_has_cone(const struct viewer *viewer, enum tool_number number);
/** Aims it from @p origin along @p direction; where that is no direction, the status line says so. */
void tool_aim_along(struct viewer *viewer, enum tool_number number, const double origin[3], const double direction[3]);
/** Puts it where it is to start, looking at the brain's middle: the first before the face, the second to the right. */
void tool_place(struct viewer *viewer, enum tool_number number);
/** Holds it where it is, or lets it go; without a pose there is nothing to hold. */
void tool_hold(struct viewer *viewer, enum tool_number number);
/** Its angle times @p factor, from 0.1 to 179 degrees. */
void tool_widen(struct viewer *viewer, enum tool_number number, double factor);
/** Pins the best hit of its cone in the drawn atlas. */
void tool_confirm(struct viewer *viewer, enum tool_number number);
/** Has it moved by @p pointer from now on; then nothing holds it. */
void tool_choose(struct viewer *viewer, enum tool_number number, enum pointer pointer);
/** Has it moved by the next of all that can move it, and says so. */
void tool_choose_next(struct viewer *viewer, enum tool_number number);

/** Switches the second tool on or off; a pose stays. What moves the first tool does not move the second. */
void tool_use_second(struct viewer *viewer, bool on);
/** Whether the first tool has the device that shall move the second one. */
bool tool_second_is_taken(const struct viewer *viewer);
/** Asks the atlases about the second tool, if it is on and its answers are out of date. */
void tool_update_second(struct viewer *viewer);

/** Whether its pointer moves it: the second one only while it is on and the first has another pointer. */
bool tool_is_moved(const struct viewer *viewer, enum tool_number number);
/** The tool that @p pointer moves; TOOL_COUNT = none. */
enum tool_number tool_moved_by(const struct viewer *viewer, enum pointer pointer);

/* One of the atlases in the window: what is hidden in it, and its answer to the question that all get. */

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

/* How long frames, pictures and selections take, for docs/benchmarks.md. */

enum timed {
    TIMED_FRAME = 0, /**< Drawing the window, without waiting for the screen.                        */
    TIMED_PERIOD,    /**< From one frame to the next, where they follow at once.                      */
    TIMED_SELECTION, /**< Selecting, once per pose.                                                  */
    TIMED_LATENCY,   /**< From a tracker's message to the selection.                                 */
    TIMED_PICTURE,   /**< The 3-D picture, coarse or fine, on its own thread.                        */
    TIMED_KINDS
};

enum { TIMES_KEPT = 2048 };

struct times {
    double samples[TIMED_KINDS][TIMES_KEPT]; /**< ms; the newest replace the oldest. */
    size_t counts[TIMED_KINDS];              /**< All samples that were added. */
    double started, frame_started;           /**< Clock, ms: of the program, of the newest frame (0 = none yet). */
    double first_frame, first_picture;       /**< ms from the start; 0 = not yet.    */
    double written, used;                    /**< Clock and processor time, ms, when they were written last. */
};

/** Starts, at the clock @p started. */
void times_start(struct times *times, double started);
void times_add(struct times *times, enum timed kind, double milliseconds);
/** A frame begins now. */
void times_begin_frame(struct times *times);

/** Writes count, median, 90th percentile and maximum of each since the last time, as JSON, and starts anew; with
 * how long that was, and the processor time that the program took meanwhile. */
conus_status times_write(struct times *times, const char *path);

/* The search for areas and pathways of an atlas by what a user types. Names come before numbers. */

/** How well an object fits a text, the case of ASCII letters aside: by its name or its abbreviation, and last by its
 * label. A word begins where a letter or digit follows something else. Nothing fits an empty text. */
enum search_fit {
    SEARCH_NONE = 0,
    SEARCH_LABEL,  /**< The label is the text. */
    SEARCH_PART,   /**< The text is in the name. */
    SEARCH_WORD,   /**< A word of the name begins with it. */
    SEARCH_BEGIN,  /**< The name begins with it. */
    SEARCH_EXACT,  /**< The name is the text, but for the case, */
    SEARCH_SAME,   /**< or in every byte. */
    SEARCH_FIT_END /**< How many there are. */
};

enum search_fit search_fit(const conus_object *object, const char *text);

/** Numbers of the objects of @p atlas that fit, best first, and by number where they fit alike; the one that
 * conus_atlas_find() finds is as one whose name is the text, unless the text is a number. To be freed; @p count is how
 * many. NULL without memory. */
uint32_t *search_all(size_t *count, const conus_atlas *atlas, const char *text);

/** The best of them; 0 = none, or no memory. */
uint32_t search_best(const conus_atlas *atlas, const char *text);

/* The state of the window apart from its look: the atlas, the cone and its hits, the hidden objects, the views of
 * the panes. Panels, panes, scripts and sessions read it and change it through these functions. */

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

/** Where the mouse's cones begin: at the surface under it, before that (tools.h), or at the eye. */
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
 * strings, @p transfer and @p log are not; @p transfer, @p log and @p wake (pictures.h) may be NULL. */
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
conus_status viewer_report(conus_report **reports, struct viewer *viewer, enum tool_number tool, const char *format);

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
/** How much the context is thinned in the newest picture in 3-D: it is gone where areas cover it through which nothing
 * is seen. */
double viewer_fade(const struct viewer *viewer);
/** Whether nothing is seen through any area, and areas are not left out: a context that they cover is not drawn. */
bool viewer_leaves_context(const struct viewer *viewer);
/** Grows with what cuts show: not with moves after which their colours are the same. */
unsigned viewer_cut_version(const struct viewer *viewer);
/** Whether an object's colour is that of its place, as conus_view.own_colours says. */
bool viewer_colours_by_rank(const struct viewer *viewer, uint32_t object);
/** sRGB of an object that has this place; 0 = none; what a plan's needle is to reach has its own. */
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
/** Draws a pathway of the drawn atlas so (pictures.h). */
void viewer_set_haze(struct viewer *viewer, uint32_t pathway, size_t haze);
/** Colours the streamlines of the drawn atlas by this (tract_colour_name() in pictures/pictures.h). */
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

/* Changes the query settings, all at once or one. If the atlas refuses a value, the status line says so and nothing
 * changes. */

/** Only what lies between two depths along the axis, mm from the apex, counts; both 0 = everything. */
bool query_set_range(struct viewer *viewer, double nearest, double farthest);
/** Moves the limits by so many mm; where there are none they are 0 and 50 mm first. */
bool query_move_range(struct viewer *viewer, double nearest, double farthest);

/** Rolls areas of the first atlas up; @p level is as --level has it, "" = not at all. False: it was said why not. */
bool query_set_level(struct viewer *viewer, const char *level);
/** The deepest level of the first atlas; 0 where none of its areas is part of another. */
unsigned query_deepest(const struct viewer *viewer);
/** The level as a depth; 0 = there is none, or it is a list of areas. */
unsigned query_depth(const struct viewer *viewer);
/** One level deeper, from none to 1, and from the deepest to none. */
void query_next_level(struct viewer *viewer);

/** Asks as conus query does with the @p words behind the first: --layers, --range, --radius, --level, --score, --order,
 * --resolution, --aperture, --engine, --sampling, --slices, --slice-fraction. What they leave out is the default.
 * False: it was said why not, on stderr, and all stays as it was. */
bool query_set_words(struct viewer *viewer, char **words, int count);

/* Left and right areas: only one side of the drawn atlas is shown, as view_atlas.sides has them; --hemispheres among
 * the options that a session keeps (viewer/opening/opening.h). */

enum side { SIDE_BOTH = 0, SIDE_LEFT, SIDE_RIGHT, SIDE_COUNT };
/** "both", "left", "right", for scripts. */
extern const char *const side_names[SIDE_COUNT];

/** The sides that areas have, hidden ones, too: both, one of them, or SIDE_COUNT, none. */
enum side side_known(const struct viewer *viewer);
/** "no right areas", where there is one side at most. */
extern const char *const side_missing[SIDE_COUNT + 1];
/** The side whose areas are shown, if all of the other are hidden; SIDE_COUNT where those of both are. */
enum side side_shown(const struct viewer *viewer);
/** Hides the other side's areas; a side that is to be seen and was hidden whole is shown again. Others stay. */
void side_show(struct viewer *viewer, enum side side);
/** Both, left, right, and both again; says so. */
void side_show_next(struct viewer *viewer);

enum { HEMISPHERES_COUNT = CONUS_HEMISPHERES_MERGED + 1 };
/** The meaning of each, for people. */
extern const char *const hemispheres_meanings[HEMISPHERES_COUNT];

/** The hemispheres that the options ask for; NULL is no options. */
conus_hemispheres hemispheres_of_words(const json_t *words);
/** A copy of them that says this; NULL without memory. */
json_t *hemispheres_put_in_words(const json_t *words, conus_hemispheres how);

/* The study of the viewer's cone: sweep, jitter or none. */

/** Studies so from now on. False: it was said why not, and all stays as it was. */
bool studies_use(struct viewer *viewer, const struct study_settings *settings);

/** Asks for the study of the cone as it is now, unless that is known or under way, and takes what is answered. To be
 * called whenever something may have changed. */
void studies_step(struct viewer *viewer);
/** Asks @p study, of the cone or of a plan, unless the answer is known or under way. */
void studies_ask(struct viewer *viewer, struct study_state *study, const struct study_question *now);
/** Takes its newest answer. */
void studies_take(struct viewer *viewer, struct study_state *study);
/** Whether there is a study, of a cone that is there. */
bool studies_is_on(const struct viewer *viewer);
/** Whether the answer (viewer->study.answer) is missing, or one of another cone, atlas or setting. */
bool studies_is_old(const struct viewer *viewer);
/** The table that conus sweep prints of the cone as it is now, borrowed; NULL = there is none, and it was said why. */
const char *studies_text(struct viewer *viewer);

/* The plan of the window: constraints that the first tool is held against wherever it is, and the candidates of a
 * file, which are tried on a thread of their own. Its atlas is the first one. */

/** Takes the constraints of @p arguments, if there are any. The tool then begins with this radius and ends at this
 * depth, mm; 0 = not given. @p poses has the candidates; NULL = none. The viewer's frame is set. Returns the exit code
 * and prints an error unless it is 0. */
int plans_open(struct viewer *viewer, const struct arguments *arguments, const char *poses, double depth,
               double radius);

/** Takes the constraints of @p arguments and the candidates of @p poses in place of those before; the tool stays as it
 * is. Likewise; where it fails, the plan does, too. */
int plans_change(struct viewer *viewer, const struct arguments *arguments, const char *poses);

/** @p words with a click in the window done: this object of the first atlas is what the needle is to reach (@p kind),
 * in place of all before, or one more that it is to avoid; or, unless @p asks, nothing is to be reached, or this need
 * not be avoided. NULL without memory, or where the name is not UTF-8. */
json_t *plans_ask(const struct viewer *viewer, const json_t *words, conus_constraint_kind kind, const char *name,
                  bool asks);
/** @p words with what is asked (--reach, --avoid) by @p asked in place of their own; either may be NULL. NULL without
 * memory. */
json_t *plans_put_asked(const json_t *words, const json_t *asked);
bool plans_asked_is_same(const json_t *a, const json_t *b);
/** Whether an object of the first atlas is by itself what the needle is to reach (@p kind) or to avoid. */
bool plans_asks(const struct viewer *viewer, conus_constraint_kind kind, uint32_t object);
/** Whether an object of the drawn atlas is, or is below, a structure of this kind. */
bool plans_is_in(const struct viewer *viewer, conus_constraint_kind kind, uint32_t object);

/** How the first of these structures is called: "Thalamus_L, Putamen_L"; NULL without one. */
const char *plans_name(struct viewer *viewer, conus_constraint_kind kind);

/** Whether there is a plan. */
bool plans_is_on(const struct viewer *viewer);
/** The verdict of the constraints on the first tool as it is now. Costs nothing where it has not changed. */
const struct plan_verdict *plans_verdict(struct viewer *viewer);
/** That in one line. A tracked tool that is held is elsewhere than its device, which the line then says. */
void plans_line(char out[PLAN_LINE], struct viewer *viewer, bool with_leeway);

/** Whether the first tool is a needle that the answer is about: that it reaches, or is clear of, something. */
bool plans_has_needle(struct viewer *viewer);
/** Keeps that needle in the list of pins, by its verdict, with both ends. */
void plans_keep(struct viewer *viewer);

enum { PLAN_NUMBER = 32 };
/** How lists and sentences print a leeway or clearance: never better than it is, so rounded down; "-" where there is
 * none. */
const char *plans_number(char out[PLAN_NUMBER], double value);

/** Asks for the list, and takes it once it is there. To be called whenever something may have changed. */
void plans_step(struct viewer *viewer);
/** The list, or why there is none: NULL, and @p why says so; without a file of candidates what to do in the window. */
const struct plan_list *plans_list(const struct viewer *viewer, const char **why);
/** Whether the list is still to come, or to come anew. */
bool plans_is_behind(const struct viewer *viewer);
/** Index of the row where the first tool is; SIZE_MAX = none. */
size_t plans_at(const struct viewer *viewer);
/** Moves the first tool to a row and holds it there; the cuts go through its tip. False: it was said why not. */
bool plans_go(struct viewer *viewer, size_t row);

/* Finds objects under the mouse and at places. */

/** The first hit of the ray from @p origin along @p direction in what the 3-D picture shows, if it is less than @p
 * limit mm away (INFINITY = anywhere). Pathways count from their threshold on. Where the context lets too little light
 * through to see anything behind, it is hit, and @p object is 0. False: no hit. */
bool viewer_pick(uint32_t *object, double contact[3], struct viewer *viewer, const double origin[3],
                 const double direction[3], double limit);
/** The first hit of such a ray in what a 3-D picture of one atlas would show, whatever its context hides, and how many
 * mm it is away; 0 and INFINITY = no hit. */
uint32_t view_atlas_pick(double *depth, struct view_atlas *view, const double origin[3], const double direction[3]);
/** The distance along such a ray to the first object that is not hidden, mm; INFINITY = there is none. */
double view_atlas_depth(struct view_atlas *view, const double origin[3], const double direction[3]);
/** The object whose voxel or closed surface holds a place in one atlas, as its cuts would name it; 0 = none. */
uint32_t view_atlas_at(struct view_atlas *view, const double place[3]);
/** The largest value of pathway @p object within a voxel of @p place; NaN of an area. */
double view_atlas_value(struct view_atlas *view, uint32_t object, const double place[3]);

/* Draws outlines around objects, in pictures of sRGB and opacity, [height width 4], top row first. */

enum { OUTLINE_DASH = 8 /**< Pixels that a dash is long, and the gap behind it. */ };

/** A good place for the object's name: the middle of the upper edge of its outline. */
struct outline_top {
    bool is_there; /**< Something was outlined. */
    uint32_t x, y;
};

/** What has an outline; the later ones lie over the others. */
enum outline { OUTLINE_AVOIDED = 0, OUTLINE_TARGET /**< Of a plan. */, OUTLINE_CHOSEN, OUTLINE_COUNT };

struct outline_look {
    uint8_t rgb[3];
    double fill; /**< Opacity of the inside. */
};
extern const struct outline_look outline_looks[OUTLINE_COUNT];

/** The objects that have it, [objects + 1], to be freed; NULL: none has, or no memory. */
bool *outline_wanted(struct viewer *viewer, enum outline which);

/** The name of an object that has it; NULL: @p which is not of a plan. */
const char *outline_name(struct viewer *viewer, enum outline which);

/** How far outline_smooth() may reach, at most 48 pixels, so that no square so wide that stands alone is lost: in the
 * middle it is more than half of what is within reach, 2 floor(square)^2 > (2 reach + 1)^2. */
uint32_t outline_reach(double square);

/** Takes the stairs off a shape, @p mask, [height width] of 0 and 1: each pixel becomes what most are that are up to
 * @p reach beside it. @p level gets how many they are, of 255, of 1 beside it at least: the edge is at a half, but
 * around what is too thin for that. Unchanged without memory. */
void outline_smooth(uint8_t *mask, uint8_t *level, uint32_t width, uint32_t height, uint32_t reach);

/** Draws a line inside the edge of @p mask, [height width] of 0 and 1, and a dark one outside; none at the picture's
 * border. All else of a mask that is filled becomes so. */
void outline_draw(uint8_t *rgba, struct outline_top *top, const uint8_t *mask, uint32_t width, uint32_t height,
                  const struct outline_look *look);

/** Makes dashes of the outline that was drawn of a mask of this @p level, where @p hidden, [height width], is 1. */
void outline_dash(uint8_t *rgba, const uint8_t *level, const uint8_t *hidden, uint32_t width, uint32_t height);

/** Takes the stairs off the lines that were drawn of a mask of this @p level, as far as dashes left them: pixels are
 * covered in part. Unchanged without memory. */
void outline_soften(uint8_t *rgba, const uint8_t *level, uint32_t width, uint32_t height,
                    const struct outline_look *look);

/** Draws a wider outline, of two pixels, around the @p wanted ones of @p objects, [height width], over @p rgba; none
 * without memory. */
void outline_cut(uint8_t *rgba, struct outline_top *top, const uint32_t *objects, uint32_t width, uint32_t height,
                 const bool *wanted, const struct outline_look *look);

#endif
