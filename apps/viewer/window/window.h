/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The window: how it is laid out, its events, its textures, and what is asked in it. */
#ifndef CONUS_VIEWER_WINDOW_WINDOW_H
#define CONUS_VIEWER_WINDOW_WINDOW_H

#include "conus/own.h"
#include "figures/figure.h"
#include "viewer/model/additions.h"
#include "viewer/model/viewer.h"
#include "viewer/pictures/pictures.h"
#include "viewer/tools/tools.h"
#include "viewer/ui/ui.h"
#include "viewer/window/start.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The steps that undo goes through: texts of states, one after the other, and where among them the window is. */

enum { CHANGES_LIMIT = 100 };

/** All 0 is one without states. */
struct changes {
    char *states[CHANGES_LIMIT]; /**< [count] */
    size_t count, at;            /**< Where there are any, at < count. */
};

/** Takes @p state over as the newest, unless it is the one that is there now; what was taken back before it is gone.
 * The oldest goes where there are too many. */
void changes_add(struct changes *changes, char *state);
/** Takes @p state over in place of the one that is there now: between both nothing can be taken back. */
void changes_renew(struct changes *changes, char *state);
/** Whether changes_step() finds something there. */
bool changes_reach(const struct changes *changes, int by);
/** Goes back (by -1) or forth (1): the state there, borrowed until the next call; NULL = nothing is there. */
const char *changes_step(struct changes *changes, int by);
void changes_finish(struct changes *changes); /**< It is one without states then. */

/* What mouse and keyboard did, in its order. Several events may come between two frames, but in a frame the mouse is
 * at one place, and a key is down or not: so a frame takes only as many as it can tell apart. */

struct window;

/** Events that no frame has taken yet. */
struct events {
    struct ui_event *list; /**< [count], with room for more; the window frees it. */
    size_t count, room;
    double time;   /**< Of those that the frame took, by glfwGetTime(); it may be some frames ago. */
    unsigned rest; /**< Frames that take none: a line that a key opened has the keyboard after them only. */
};

/** To be called for an open window: from now on its events are noted. */
void events_hear(struct window *window);
/** Takes those of the next frame: moves of the mouse up to a press, the press alone, ... Returns whether there are
 * more. */
bool events_take(struct window *window);

/* Places for names in a pane: none lies on another, nor on what is reserved, and each object has one. */

enum { LABELS_LIMIT = 24 };

/** All 0 is a pane without names. */
struct labels {
    struct placed_name {
        struct ui_box box;
        uint32_t object; /**< 0 = it is reserved for something else. */
    } items[LABELS_LIMIT];
    size_t count;
    bool (*allows)(void *user, const struct ui_box *box, uint32_t object); /**< Whether an object's name may lie there,
                                                                               besides; NULL = anywhere. */
    void *user;                                                            /**< Its first argument. */
    float high; /**< Pixels: height of names on a picture without panels; 0 = that of all texts. */
};

/** No name may lie there. */
void labels_reserve(struct labels *labels, struct ui_box box);
/** Whether nothing lies there. */
bool labels_leave_free(const struct labels *labels, const struct ui_box *box);
bool labels_has(const struct labels *labels, uint32_t object);
/** Finds the place of a name so large in pixels, as near to @p at as it can be: beside it, or first @p above it. False:
 * the object has a name already, or there is no room. */
bool labels_place(struct ui_box *out, struct labels *labels, const struct ui_box *pane, const float at[2],
                  const float size[2], bool above, uint32_t object);

/* How the window is divided: panels left and right, each a narrow rail where it is folded, and between them the 3-D
 * pane beside a strip of the three cuts. */

enum { LAYOUT_RAIL = 48 /**< Pixels at scale 1: width of a rail. */ };

/** Whether a panel is folded to its rail: at first the left one is where the window is narrow. */
enum fold { FOLD_AS_AT_FIRST = 0, FOLD_CLOSED, FOLD_OPEN, FOLD_COUNT };

/** The widths that the user left; all 0 = as at first. */
struct layout {
    enum fold folds[2]; /**< Folds of the left and the right panel. */
    double panels[2]; /**< Widths of the left and the right panel, pixels where texts have scale 1; 0 = as at first. */
    double division[2]; /**< Parts of the middle's width and height, 0.1 to 0.9, of the 3-D pane and the first cut; 0 =
                           0.72, a third. */
};

/** Pixels of a window. */
struct division {
    bool folded[2];      /**< Whether each panel is a rail. */
    float left, right;   /**< Widths of the panels. */
    float columns, rows; /**< Width and height of the middle. */
    float column, row;   /**< Width of the 3-D pane and height of the first cut. */
};

/** Divides a window so that the middle keeps a fifth of its width at least. */
struct division layout_divide(const struct layout *layout, float width, float height, float scale);

enum border { BORDER_LEFT, BORDER_RIGHT, BORDER_COLUMN, BORDER_ROW, BORDER_COUNT };

/** Moves a border to @p at, pixels from the window's left or upper edge. */
void layout_move(struct layout *layout, enum border border, float at, float width, float height, float scale);
/** Puts a border where it was at first. */
void layout_reset(struct layout *layout, enum border border);
/** Makes the 3-D pane wider by a step, or narrower (-1). */
void layout_widen_first(struct layout *layout, int steps);
/** Folds a panel (0 = left, 1 = right) to its rail, or opens it. */
void layout_fold(struct layout *layout, size_t side, bool fold);
/** Makes both panels wider by a step, or narrower (-1), of a window @p width pixels wide. */
void layout_widen_panels(struct layout *layout, int steps, float width, float scale);
bool layout_is_same(const struct layout *a, const struct layout *b);
/** Whether the numbers are ones that a layout can have. */
bool layout_is_fine(const struct layout *layout);

/* Where the window was and how large, from one run to the next: conus/window.json in $XDG_STATE_HOME, else in
 * ~/.local/state. */

struct place {
    int width, height;
    bool known; /**< x and y hold. */
    int x, y;
    struct layout layout;
    double zoom; /**< Zoom of texts and panels by the user: times the screen's scale; 0 = 1. */
};

enum { PLACE_LEAST_ZOOM = 50, PLACE_MOST_ZOOM = 400 /* per cent */ };

/** Makes it no larger than @p area, x, y, width and height of what a screen leaves free, and moves it there. */
void place_fit(struct place *place, const int area[4]);
/** How large texts shall be on a screen that is @p millimetres wide with so many @p pixels: @p content, as the desktop
 * says, where that is not 1; else by the density in steps of a quarter, from 1 at 96 pixels per inch, to 3. Densities
 * that no screen has, and widths that none says, count as 96. */
float place_scale(float content, int pixels, int millimetres);

/** Reads what was written; false, and @p out stays as it is, where that makes no sense. */
bool place_parse(struct place *out, const char *text, size_t size);
/** Reads the place into @p out, which stays as it is where no valid place is stored. */
void place_load(struct place *out);
/** Writes it; where that cannot be done the next window is as large as the first one. */
void place_save(const struct place *place);

/* The window, its textures, and how it is laid out: panels left and right, four panes between them, a status line.
 * What panels and panes draw is theirs (panes.h, panes.h); the state that a session keeps is the viewer's. */

/** Widgets need a few to answer: hovered, pressed, let go. */
enum { FRAMES_PER_EVENT = 3 };

enum { PANE_COUNT = 4, PANE_3D = 3 /**< After the planes. */, KEY_LIMIT = 32, TITLE_SIZE = 320 };

/** A flat pane as it was drawn last. */
struct cut_pane {
    struct texture texture;
    conus_cutter *cutter;  /**< NULL = none yet.                       */
    unsigned atlas_number; /**< The viewer's, when the cutter was made. */
    unsigned version;      /**< viewer_cut_version(), when it was drawn. */
    uint64_t answer_sum;   /**< tool_answer_sum(), then. */
    bool is_old;           /**< The answer was, then. */
    double centre[3];
    struct outline_top top; /**< Top of the chosen area. */
};

/** Areas over the 3-D picture: their outline, in dashes where something lies before it. */
struct shadow {
    struct cells cells;
    const struct view_atlas *of; /**< Whose cells they are, */
    uint32_t chosen;             /**< of which chosen object, */
    unsigned plan_number;        /**< of which plan, */
    unsigned atlas_number;       /**< and at which of the viewer's numbers. */
    struct texture texture;
    uint32_t width, height; /**< Size of the texture; 0 = it is to be drawn anew. */
    struct eye eye;         /**< That it shows. */
    struct outline_top top;
    bool has_middle; /**< Without cells, such as a surface that is not closed: its name is there. */
    double middle[3];
};

/** What the 3-D pane shows: what was found on it holds as long as this is the same. */
struct seen_view {
    const struct view_atlas *of;         /**< The drawn atlas, */
    unsigned atlas_number, scene_number; /**< the viewer's numbers, */
    struct eye eye;                      /**< seen from here, */
    double fade;                         /**< and with this fading of the context. */
};

enum { CONE_LINES = 256 };

/** A piece of a line of a cone in the 3-D pane, world mm. */
struct cone_line {
    double ends[2][3];
    bool dashed;
};

enum { POINTS_KEY = 32 };

/** The list of points over a pane. */
struct point_layer {
    struct texture texture;
    double key[POINTS_KEY]; /**< What it was drawn for. */
};

enum { SEEN_PLACES = 1024 };

/** What the 3-D pane shows at places of it, as far as it was asked for. */
struct seen_places {
    struct seen_view view;
    struct seen_place {
        bool is_known;
        int cell[2];
        uint32_t object; /**< 0 = none. */
    } places[SEEN_PLACES];
};

enum { HITS_NAMED = 3 /**< The best ones, in the 3-D pane. */ };

/** A tool's cone as the 3-D pane shows it. */
struct cone_sight {
    struct seen_view view;
    unsigned answer_number; /**< The tool's, */
    unsigned plan_number;   /**< and the plan's, whose extent it is. */
    struct extent extent;
    bool is_seen; /**< What follows was found for it. */
    struct cone_line lines[CONE_LINES];
    size_t line_count;
    struct extent turned;       /**< The extent, with the reach of its ball as it is drawn. */
    double clear;               /**< Depth up to which nothing hides the axis. */
    double ball[3];             /**< The place of its ball, */
    bool has_ball;              /**< which is drawn. */
    bool hides_ball;            /**< Something lies before that, */
    bool hides_hit[HITS_NAMED]; /**< or before the contact of the hit of that place in the answer. */
};

/** The object under the mouse. */
struct hover {
    uint32_t object; /**< In the drawn atlas; 0 = none. */
    bool has_place;
    double at[3];                /**< If it has a place. */
    double value;                /**< Value of a pathway there; NaN = an area. */
    bool by_ray;                 /**< Found in 3-D, along a ray: */
    double eye[3], direction[3]; /**< A unit vector. */
};

enum { FIGURE_NAME = 512 };

/** The form that asks which pane is saved as a figure, and under which name. */
struct figure_form {
    bool open, takes_keys; /**< It is shown; its name takes the keyboard in the next frame. */
    size_t pane;           /**< PANE_3D, or a plane. */
    char name[FIGURE_NAME];
    char replaced[FIGURE_NAME]; /**< The file that is there already, and may be replaced. */
    char saved[FIGURE_NAME];    /**< Path of the newest figure; "" = none. */
    char update[FIGURE_NAME + 32];
    bool failed;                /**< The update is an error. */
    unsigned frames;            /**< Frames until the file is written, or a preview drawn; 0 = none will be. */
    bool previews;              /**< A preview. */
    unsigned previewed_version; /**< The viewer's, of the newest preview, */
    size_t previewed_pane;      /**< and its pane. */
};

enum { ADDED_TEXT = SYSTEM_PATH };

/** The list of what was added to the atlas, and the line for one more. */
struct added_form {
    bool open, takes_keys; /**< As of the figure. */
    size_t kind;           /**< The kind of the typed file: an enum addition. */
    size_t changed;        /**< The word of window_words() that what is typed takes the place of, from 1; 0 = none. */
    char text[ADDED_TEXT]; /**< A file, and keys behind it. */
    bool is_set;           /**< The text is not what the line has. */
};

/** The effect of an opened atlas on the open one; a session always replaces it. */
enum opening { OPEN_ASKS = 0 /**< The user is asked. */, OPEN_ADDS, OPEN_REPLACES };

/** Files, or options, that are to be opened next. */
struct open_request {
    char **paths; /**< [count] Atlases, sessions, and what is to be added; 0 = none. */
    size_t count;
    enum opening how;
    const char *asked_of; /**< The file that the user is asked about, */
    bool may_be_added;    /**< and whether it can be added. */
    bool by_dialog;       /**< It is the dialog that asked, and says so where they cannot be opened. */
    bool is_needed;       /**< By a line of a script, which ends where they cannot be opened. */
    struct json_t *words; /**< Options with which the atlas that is open is to be opened again; NULL = none. */
    int step;             /**< By which undo goes then (session/session.h). */
};

/** The kinds of file that a user saves. */
enum saved_file { SAVE_SESSION = 0, SAVE_SAME_SESSION, SAVE_PICTURE, SAVE_RESULTS, SAVE_STUDY };

/** The files that are open, and those that are to be opened or saved next. */
struct window_files {
    struct open_request requested;
    struct open_request asked; /**< Those that the user is asked about: a question lies before all else. */
    struct loader *begun;      /**< Loads the requested files since before there was a window; NULL = none. */
    struct json_t *opened;     /**< The open ones as a session keeps them (model/additions.h); NULL = unknown. */
    struct json_t *lost;       /**< The session as it was read, "session", and "entries" of its added files that were
                                    not found, which stay in it when it is saved; NULL = none. */
    conus_hemispheres hemispheres;
    char *doubted;         /**< Options that were not taken, since bundles hardly are in the atlas's space: asked for
                                once more, they are; NULL = none. */
    char *session_waits;   /**< A session whose atlas was not found: the next atlas is its; NULL = none. */
    bool stops;            /**< The files that are being loaded are not wanted any more. */
    bool remembers;        /**< Opened and saved files are listed on the start page, also next time. */
    char *saves_as;        /**< The file that is to be written after the next frame; NULL = none. */
    enum saved_file saves; /**< What, then. */
    char *saved_last;      /**< The newest file that was saved where the user said; NULL = none. */
};

enum { PANEL_TABS = 8 };

/** What the panel of the answer shows below the question. */
struct panel_tabs {
    size_t shown;                 /**< The tab. */
    unsigned numbers[PANEL_TABS]; /**< What each was about when it was drawn last. */
};

/** How the window is divided, and how large its texts are. */
struct screen {
    int width, height; /**< Pixels. */
    float scale;       /**< Scale of texts and panels. */
    struct ui_box left, right, status, panes[PANE_COUNT];
    struct layout layout;
    int enlarged;   /**< The pane that fills the middle, or -1. */
    bool alone;     /**< The 3-D pane fills the whole screen, */
    bool bare;      /**< or the window: no panels, no cuts. */
    bool folded[2]; /**< The left and the right panel are rails. */
    struct panel_tabs tabs;
    struct place before; /**< Where the window was before that. */
    float next_scale;    /**< That the screen asks for; 0 = no other than before. */
    bool scale_given;    /**< By the user: the screen is not asked. */
    float screen_scale;  /**< The scale that the screen, or the user, asked for when the window was opened or moved. */
    double zoom;         /**< Times that, by keys. */
};

/** The panes' pictures of the viewer that is shown, and what they were drawn for. */
struct pictures {
    struct cut_pane cuts[PLANE_COUNT];
    struct texture painted, device_view;
    struct texture preview; /**< Of a figure; name 0 = none. */
    struct shadow shadows[OUTLINE_COUNT];
    struct point_layer points[PANE_COUNT];
    struct cone_sight cones[TOOL_COUNT];
    struct cone_sight cross; /**< Of the crosshair only its lines, */
    double crossed[3];       /**< for this place. */
    struct seen_places seen;
    const struct view_atlas *painted_of; /**< The atlas that painted shows. */
    struct eye eye;                      /**< The eye of the 3-D pane that the next picture shall have. */
    struct painting asked;               /**< The last request to the painter. */
    struct painting drawn;               /**< What `painted` shows, without the answer, */
    ui_colour around;                    /**< and its background. */
    struct eye shown; /**< The eye of the pane as it is seen: of `painted`, for the pane's size. What lies over the
                           picture is drawn by it, and the mouse points by it. */
    double painted_ms;
    bool is_kept;          /**< One was kept for the start page. */
    bool painted_fine;     /**< The picture is what was asked last, as fine as it gets. */
    unsigned noted_answer; /**< The newest answer that was looked at for moves of the cone. */
    unsigned noted_head;   /**< Likewise of the head's changes. */
    double moving_until;   /**< By clock_ms(): until then pictures shall be quick. */
    bool moving;           /**< The newest was asked for as one of these. */
    double
        late_at; /**< By clock_ms(): from then on `painted` says that it is of an answer from before; 0 = it is not. */
    bool says_late;
};

/** What shows an answer in words, in each frame anew. */
enum shown_place { SHOWN_LIST = 0, SHOWN_LABELS, SHOWN_STATUS, SHOWN_PLACES };

/** The viewer's numbers of what a place shows. */
struct shown_numbers {
    bool is_there; /**< The frame has the place. */
    unsigned answer, plan, scene, second;
};

/** The state of the newest frame: versions that it shows, mouse and keys in it. */
struct frame_state {
    struct shown_numbers shows[SHOWN_PLACES];
    unsigned frames_wanted;             /**< To be drawn still, whatever changes. */
    unsigned shown_version, shown_said; /**< The viewer's. */
    unsigned shown_head, shown_second;  /**< Likewise. */
    double ms;                          /**< That it took. */
    struct hover hover;
    struct labels labels; /**< Labels of the 3-D pane. */
    struct hover pressed; /**< What was under the mouse when its left button was pressed on the 3-D pane, */
    const struct view_atlas *pressed_of; /**< of which atlas; NULL = it is not pressed there. */
    enum tool_number turns_cone;         /**< The mouse turns the cone of this tool; TOOL_COUNT = none. */
    struct extent turned_about;          /**< That it had when the mouse took its ball. */
    float turned[2];                     /**< The place, from there on, that the view was turned to. */
    bool points_again; /**< The mouse pointed while the picture was one from before: it does again in that which comes.
                        */
    bool searches;     /**< The line that searches areas takes the keyboard. */
    int navigated;     /**< The panel that keys go to, from 1: areas, hits; 0 = none. */
    bool navigates_anew;                /**< From the next frame on. */
    uint32_t listed;                    /**< The object that the list of areas was scrolled to last. */
    const struct view_atlas *listed_of; /**< In the list of this atlas. */
    char title[TITLE_SIZE];             /**< As title_write() gave it last; "" = none yet. */
    unsigned sent_answer;               /**< The answer that was sent to the station last. */
    double watched;                     /**< When the atlas's files were looked at last, by clock_ms(). */
};

/** The states that undo goes through, and the session's file. */
struct history {
    struct changes changes;             /**< The states that session/session.h notes. */
    unsigned noted_version, noted_said; /**< The viewer's, when undo looked at it last. */
    unsigned noted_second;              /**< The second tool's. */
    struct layout noted_layout;
    char *session_path;  /**< The session that was opened or saved last; NULL = none. */
    struct json_t *kept; /**< What it keeps that was made by hand, as session/session.c compares it; NULL = nothing. */
};

void window_history_finish(struct history *history);

/** Pages that lie over the panes while they are open. */
struct forms {
    struct figure_form figure;
    struct added_form added;
    bool show_help, searches_help; /**< Its line takes the keyboard in the next frame. */
    char help_search[64];
    const char *closing_loses; /**< Static; whether it may close is asked, before all else, since that is lost; NULL =
                                    it is not. */
    bool closes;               /**< The answer. */
};

struct window {
    /* for the life of the window */
    void *handle;                                          /**< GLFWwindow */
    bool (*press)(struct window *window, const char *key); /**< Does what a key does; NULL while an atlas is loaded. */
    void (*wake)(void);                                    /**< Makes the window's loop look again, from any thread. */
    struct window_files files;
    struct inputs inputs;
    struct screen screen;
    struct start start;
    struct dialog dialog; /**< In place of the start page and all panels, while it is on. */
    struct sheet sheet;   /**< For figures. */
    struct times times;
    struct events events;

    /* as long as the viewer is shown: window_show() begins anew */
    struct viewer *viewer; /**< NULL = there is no atlas. */
    struct pictures pictures;
    struct frame_state frame;
    struct history history;
    struct forms forms;
};

struct window_options {
    struct place place;
    double scale;     /**< Scale of texts and panels; 0 = the screen's. */
    enum theme theme; /**< Theme of panels and widgets. */
    bool hidden;      /**< The window is not to be seen.                */
    bool fits_screen; /**< It is made as large as the screen at most, and put there. */
};

/** To be called before window_open(). False: there is no display, and it was said why. */
bool window_find_display(void);
/** Opens a window. False: it was said why, and nothing is open. */
bool window_open(struct window *out, const struct window_options *options);
/** Shows what @p viewer holds (NULL = the start page), with nothing left of the one before. */
void window_show(struct window *window, struct viewer *viewer);
/** Asks for another atlas, a session, or something to be added to what is open, in place of what was asked before. */
void window_request_file(struct window *window, const char *path);
/** Whether something is asked for. */
bool window_has_request(const struct window *window);
void open_request_finish(struct open_request *request);
/** Asks for the atlas without what word @p index of window_words() added to it (SIZE_MAX = with all), and with a
 * context, pathway, tractogram or atlas; @p value is that of the command line's option, NULL = nothing. */
void window_change(struct window *window, size_t index, enum addition kind, const char *value);
/** The options with which the atlas was opened, an array of texts; NULL where they are not known, and it was said. */
const struct json_t *window_words(struct window *window);
/** Asks for the atlas with other hemispheres, or says that it has them. */
void window_request_hemispheres(struct window *window, conus_hemispheres how);
/** Asks for a plan as plans_ask() words it. */
void window_request_asked(struct window *window, conus_constraint_kind kind, const char *name, bool asks);
/** Asks for the hemispheres and what the plan asks of other options, for which undo goes @p step. */
void window_request_options(struct window *window, const struct json_t *options, int step);
/** Connects to the tracker whose address was typed, and says so. False: it was said why not. */
bool window_connect(struct window *window);
/** Asks for what was typed on the start page, if anything was. */
void window_request_typed(struct window *window);
/** Asks for the sample of the start page, if that is the phantom. */
void window_request_sample(struct window *window);
/** Lets the user choose a file to open, or one to save the session in; without an atlas there is no session. */
void window_show_dialog(struct window *window, enum dialog_purpose purpose);
/** Lets the user choose where something else is saved, with a name proposed in the folder of the last such file. */
void window_show_saving(struct window *window, enum saved_file what, const char *name, const char *ending);
/** Does what the dialog is for, if a file is chosen there. */
void window_use_dialog(struct window *window);
/** Opens the folder that the dialog lists. */
void window_use_folder(struct window *window);
/** Shows the start page, which says what would be lost with the atlas that is open. */
void window_go_to_start(struct window *window);
/** Takes several files: an atlas or a session, and files to add to it, in any order. */
void window_request_files(struct window *window, size_t count, const char *const *paths);
/** Asks the user how @p request, which it takes over, is to be opened. */
void window_ask(struct window *window, struct open_request *request);
/** The user's answer, OPEN_ASKS = not at all. */
void window_answer(struct window *window, enum opening how);
/** The answer to whether it may close. */
void window_answer_closing(struct window *window, bool closes);
/** Whether the user is asked something before all else. */
bool window_asks(const struct window *window);
/** Says one line where it is seen: on the start page, or in the status line. */
void window_say(struct window *window, const char *text);
/** Where it is now. */
void window_place(const struct window *window, struct place *out);
void window_close(struct window *window);
/** Makes texts and panels larger by so many steps, a tenth each, or smaller; 0 = as large as they were at first. */
void window_zoom(struct window *window, int steps);
/** Sets how large the desktop has texts on the screen that the window came to. */
void window_rescale(struct window *window, float content);
/** Ends the message of the status line: the user does the next thing, after which it may be true no more. */
void window_forget_message(struct window *window);
/** Presses a key: a character as typed ("?"), or "escape", "f1", "ctrl+shift+s", ... False if it means nothing. */
bool window_press(struct window *window, const char *key);
/** Lays everything out for the window's size now. */
void window_lay_out(struct window *window);
/** The same for its width and height as they stand there. */
void screen_divide(struct screen *screen);

/** Lets the pane under the mouse, or else that in 3-D, fill the middle, or all come back. */
void window_maximise(struct window *window);
/** Whether there is the 3-D pane alone, without panels. */
bool screen_is_bare(const struct screen *screen);
/** Whether a pane is on the window and large enough to be drawn. */
bool screen_shows_pane(const struct screen *screen, int pane);

/** Where a point (world mm) is in the 3-D pane, pixels of the window; false behind the eye. */
bool window_point(float out[2], const struct window *window, const double world[3]);

/** Begins a panel in the middle of the window, in front of the others: of that size at scale 1, where it fits. */
void window_panel(const struct window *window, const char *title, float width, float height);
/** Clears the window to the colour of panels. */
void window_clear(const struct window *window);
/** Whether the next frame will show something else than the newest. */
bool window_needs_frame(struct window *window);
/** Seconds after which it may, though nothing happens: 0 = at once, INFINITY = never. */
double window_idle_s(const struct window *window);
enum { PICTURE_LATE_MS = 400 /**< From when on a picture of an answer from before says so. */ };

/** Notes since when, by clock_ms(), the 3-D picture is of another answer, plan or scene than was asked for, and whether
 * that has lasted so long that it is said. */
void pictures_note_late(struct pictures *pictures, double now);

/** Notes that a place shows what the viewer holds now. */
void window_note_shown(struct window *window, enum shown_place place);
/** Whether nothing is left to do before the next event: no frame, no finer picture of what was asked for. */
bool window_rests(const struct window *window);
/** Whether all pictures are as fine as they get, and show what the viewer holds. */
bool window_is_settled(const struct window *window);
/** Writes the window's contents as a PNG. */
conus_status window_write(const struct window *window, const char *path);

enum copied { COPY_RESULTS = 0, COPY_PINS, COPY_STUDY };
/** Puts a table on the clipboard. */
void window_copy(struct window *window, enum copied what);

/** Lets the 3-D pane fill the screen that the window is on, without panels, or brings the window back. */
void window_fill_screen(struct window *window, bool fill);

/** The eye of the 3-D pane now: its own, or that of a tracked head through its part of the screen. */
void window_eye(const struct window *window, struct eye *out);
/** Takes over what the 3-D pane shows now. False: it was that already. */
bool window_sees_anew(struct seen_view *view, const struct window *window);

/** "conus"; with an atlas "conus - aal.nii.gz [session.json] - Hippocampus_L (held)": its file, the session's if there
 * is one, and the best hit in the drawn atlas (hit, held, or old answer) or else the chosen area
 * (chosen). */
void title_write(char out[TITLE_SIZE], const struct window *window);
/** Gives the window its title, where that is another one than before. */
void title_update(struct window *window);

/* The question what is to be saved as a figure, and its answer. */

/** "3d", or a plane's name; [PANE_COUNT], by pane. */
extern const char *const figure_panes[PANE_COUNT];

/** Asks, with a name that is free: of the enlarged pane, or of the 3-D one. */
void figure_form_open(struct window *window);
/** Takes the answer: the file is written some frames later, so that the window can say so before. A file that is there
 * is replaced only when this is called again for it. A name without .png, .exr, .svg or .pdf gets .png,
 * but that of a picture of another kind is refused. */
void figure_form_save(struct window *window);
/** Draws what would be saved, small, some frames later. */
void figure_form_preview(struct window *window);
/** The preview, where all is as it was then; NULL = there is none. */
const struct texture *figure_form_previewed(const struct window *window);
/** Once in each frame, after it was drawn. */
void figure_form_step(struct window *window);
/** Puts the path of the newest figure on the clipboard, as text. */
void figure_form_copy(struct window *window);

enum { FIGURE_REASON = 512 };

/** The options of conus render that the window's sheet and background mean. */
void figure_of_window(struct figure_settings *out, const struct window *window);

/** Draws @p pane (PANE_3D, or a plane) with the look, the cone and the place that it has now, and writes it. In 3-D a
 * shape other than the pane's shows more or less to the left and right. False where that fails, and @p why says it. */
bool figure_write(const struct window *window, size_t pane, const struct figure_settings *settings, const char *path,
                  char why[FIGURE_REASON]);

/* The names of what is under the mouse. */

enum { HOVER_TEXT = 1024 };

/** Name and, of a pathway, value of what is under the mouse; "" = nothing. Of several atlases "ATLAS: NAME" of each,
 * and @p between in the gaps; where the mouse is nowhere, of what is at the crosshair. In an atlas that is not drawn it
 * is what would be under the mouse if it were; in 3-D with how much deeper or nearer that is than in the drawn one. */
void hover_text(char out[HOVER_TEXT], const struct window *window, const char *between);
/** Shows hover_text() as the tip of the widget before, where the mouse is on it. */
void hover_tip(const struct window *window);

#endif
