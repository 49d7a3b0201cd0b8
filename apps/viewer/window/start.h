/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The start page, the page on which a file is chosen, and what the window keeps from one run to the next. */
#ifndef CONUS_VIEWER_WINDOW_START_H
#define CONUS_VIEWER_WINDOW_START_H

#include "base/system/system.h"
#include "conus/own.h"
#include "viewer/pictures/pictures.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Small files that the window keeps from one run to the next, in $XDG_STATE_HOME/conus, else in
 * ~/.local/state/conus. */

/** The path of @p name in a folder that is made; false where there is no home, or it is too long. */
bool state_file_path(char path[SYSTEM_PATH], const char *name);
/** The bytes of the file @p name, to be freed; NULL where there is none, or it has more than @p limit. */
char *state_file_read(size_t *size, const char *name, size_t limit);
/** Writes it, whole or not at all; where that cannot be done the next run finds what the one before left. */
void state_file_write(const char *name, const char *text, size_t size);

/** The path that people type: ~ is the home folder. False where it is empty, or too long. */
bool typed_path(char path[SYSTEM_PATH], const char *text);

/* The atlases that were opened lately, newest first: conus/recent.json in $XDG_STATE_HOME, else in ~/.local/state:
 * {"conus_recent": 1, "atlases": ["/absolute/path", ...]}. */

enum { RECENT_LIMIT = 8 };

struct recent {
    char paths[RECENT_LIMIT]
              [SYSTEM_PATH]; /**< Absolute, and shorter than SYSTEM_PATH; whether they are there nobody asks. */
    size_t count;
};

/** Reads what was written, and nothing else; false, and @p out stays as it is, where it is not that. */
bool recent_parse(struct recent *out, const char *text, size_t size);
/** Reads the list into @p out, which is empty where no valid list is stored. */
void recent_load(struct recent *out);
/** Puts an atlas first and writes the file. Nothing happens where its absolute path is too long or no UTF-8. */
void recent_add(const char *path);

/* Pictures on the screen. */

struct texture {
    uint32_t name; /**< GL's name; 0 = none yet. */
    uint32_t width, height;
};

/** Puts bytes of sRGB, top row first, on a texture; @p smooth: where it has another size, pixels run into each other.
 */
void texture_set(struct texture *texture, const uint8_t *rgba, uint32_t width, uint32_t height, bool smooth);
/** Ends the picture on a texture. */
void texture_drop(struct texture *texture);

/* What the start page knows of an atlas that was open before: a picture, and how many areas it has. It is a file of
 * the window's state, pictures/NAME after the atlas's file: "conus_picture 1 BYTES AREAS\n" with the atlas's size
 * (16 hexadecimal digits), its areas (8 of them), and the pixels. */

enum { THUMBNAIL_WIDTH = 400, THUMBNAIL_HEIGHT = 300 };

struct thumbnail {
    uint32_t areas;
    uint8_t rgba[THUMBNAIL_HEIGHT][THUMBNAIL_WIDTH][4]; /**< sRGB, top row first. */
};

/** Reads what was kept of an atlas of so many bytes, and nothing else; false, and @p out stays as it is, where it is
 * not that. */
bool thumbnail_parse(struct thumbnail *out, uint64_t bytes, const char *text, size_t size);
/** Finds what was kept of an atlas of this name and size, wherever it was; false where nothing was. */
bool thumbnail_load(struct thumbnail *out, const char *path);
/** Keeps the middle of a picture of the atlas @p path, for the next time; where that cannot be, nothing is kept. */
void thumbnail_keep(const char *path, uint32_t areas, const struct painted *picture);

/* The offers of the start page: atlases that were opened lately, those that are installed, a sample, and a line for
 * a path or for words to search by. */

/** What an atlas of that name is, and of which animal; NULL = it is not known. */
const char *installed_about(const char *name);
/** Whether one before atlas @p index is the same in another place: lists leave it out. */
bool installed_is_twin(const conus_catalogue *catalogue, size_t index);
/** The words that open the atlas: its name, "source:name", or where both mean others its path,
 * which is shorter than SYSTEM_PATH; false where it is not. */
bool installed_words(char out[SYSTEM_PATH], const conus_catalogue *catalogue, const conus_installed *atlas);

enum { START_WHY = 512 };

/** What is known of an atlas that was open before. */
struct known_atlas {
    bool is_looked_for;
    uint32_t areas;         /**< 0 = not known. */
    struct texture picture; /**< Name 0 = there is none. */
};

struct start {
    bool on;         /**< The window shows the page: always, while there is no atlas. */
    bool takes_keys; /**< From the next frame on what is typed goes into the path. */
    bool is_set;     /**< The line has to take over what is typed below, which a letter began. */
    char typed[SYSTEM_PATH];
    char why[START_WHY]; /**< Why the last one was not opened, plain; "" = there is nothing to say. */
    struct recent recent;
    char
        found[SYSTEM_PATH]; /**< The sample, Debian's AAL atlas, if it is there and not among the recent ones; or "". */
    bool has_no_sample;     /**< That atlas is not installed: a phantom is the sample. */
    conus_catalogue *catalogue;  /**< The installed atlases; NULL = not looked for. */
    struct known_atlas *known;   /**< What start_known() found, first that of the paths; NULL = no memory. */
    struct viewer *painted;      /**< Draws the picture of path `paints`; NULL = no picture is drawn. */
    size_t paints;               /**< Past the paths: none was asked for yet. */
    size_t picked;               /**< Index of the installed atlas that Enter opens; past the last = none. */
    bool scrolls;                /**< The list is to scroll to it. */
    char picked_by[SYSTEM_PATH]; /**< The text when it was picked. */
};

/** Fills the lists anew; to be ended by start_finish(). */
void start_look(struct start *start);
void start_finish(struct start *start);
/** Path @p index of the lists, the recent ones first; NULL past the last. */
const char *start_path(const struct start *start, size_t index);
/** What is known of path @p index of the lists, or of the installed atlas with this index; all 0 = nothing. */
struct known_atlas start_known(struct start *start, size_t index, bool is_installed);
/** Index of the first path of the lists that has a picture, which where none has is being drawn of the sample, and is
 * there some frames later: @p wake is called then. With @p keeps that is kept for the next time. SIZE_MAX = none will
 * have one. */
size_t start_pictured(struct start *start, void (*wake)(void), bool keeps);
/** Ends what draws that picture, as where the page goes away. */
void start_stop(struct start *start);
/** The installed atlas that is the file @p path; NULL = none. */
const conus_installed *start_installed(const struct start *start, const char *path);
/** Whether the list of installed atlases has this one: what is typed fits, or nothing is typed and it stands in no
 * other list. */
bool start_lists(struct start *start, size_t index);
/** Path @p index without what may not be shown, and where its last name begins in it. */
const char *start_words(char words[SYSTEM_PATH], const struct start *start, size_t index);
/** The search among installed atlases: the typed text, or "" if that is a path. */
const char *start_words_typed(const struct start *start);
/** Index of the installed atlas that is marked, which what was typed finds or the arrow keys chose; past the last =
 * none, as where nothing was typed or it is a path. */
size_t start_picked(struct start *start);
/** Marks the next installed atlas, by 1 below, by -1 above. */
void start_move(struct start *start, int by);
/** The path that Enter opens: the one that was typed, where ~ is the home folder, or the atlas that is marked; false
 * where there is none, or it is too long. */
bool start_typed(char path[SYSTEM_PATH], struct start *start);
/** The path of the phantom that is the sample, which is written where it is missing; false with conus_message(). */
bool start_sample(char path[SYSTEM_PATH]);

/* The page on which a file is chosen, to be opened or written: a path, and the folder that it is in. */

enum { FOLDER_LIMIT = 100000 /* entries; more are left out */ };

/** Which files are listed. Folders are always. */
enum folder_filter { FOLDER_OPENABLE, FOLDER_SESSIONS, FOLDER_ALL };

struct folder_entry {
    char *name;
    bool is_folder;
};

/** All 0 = not read. */
struct folder {
    char path[SYSTEM_PATH]; /**< As it was read; "" = none. */
    enum folder_filter filter;
    struct folder_entry *entries; /**< [count] Folders first, each kind by name, in which case does not count. */
    size_t count;
    bool failed;  /**< It cannot be read, or there is no memory; then count is 0. */
    bool missing; /**< It failed since there is no such folder. */
};

/** Reads the folder @p path in place of the one before. Names that begin with a dot are left out. */
void folder_read(struct folder *folder, const char *path, enum folder_filter filter);
void folder_finish(struct folder *folder);

/** Whether a file's name ends as one that conus can open, or a session; those without an ending can be anything. */
bool folder_can_open(const char *name);
/** Whether @p text is in @p name; upper and lower case are the same. */
bool folder_fits(const char *name, const char *text);

enum { DIALOG_PLACES = 10, DIALOG_WHY = 512 };
enum dialog_purpose { DIALOG_OPEN, DIALOG_SAVE };

/** All 0 = never shown. */
struct dialog {
    bool on;
    enum dialog_purpose purpose;
    char text[SYSTEM_PATH]; /**< The typed text: up to its last '/' the folder that is listed, then a part of a name. */
    bool is_set;            /**< The text is not what the line has: it is to take it over, */
    size_t selected;        /**< and to select it from this byte on, so that what is typed next takes its place. */
    char prefilled[SYSTEM_PATH];   /**< The folder that was put there, with its '/'; "" = the user was there. */
    const char *ending;            /**< Ending of the file to be written; NULL = ".json", a session. */
    bool takes_keys;               /**< From the next frame on what is typed goes into the line. */
    bool all;                      /**< Lists all files. */
    size_t marked;                 /**< Entry of the folder; past the last = none. */
    bool scrolls;                  /**< The list is to scroll to what is marked. */
    bool sure;                     /**< To write over the file that is there. */
    char why[DIALOG_WHY];          /**< An error, or ""; plain. */
    char text_before[SYSTEM_PATH]; /**< When marked and sure were set. */
    struct folder folder;
    char places[DIALOG_PLACES][SYSTEM_PATH]; /**< Folders to go to. */
    size_t place_count;
};

/** Shows it, with the text @p path, or where that is NULL with the folder of what was opened last, else with the one
 * where conus was started. */
void dialog_show(struct dialog *dialog, enum dialog_purpose purpose, const char *path, const struct start *start);
void dialog_finish(struct dialog *dialog);
/** Puts a text into the line. */
void dialog_set(struct dialog *dialog, const char *text);
/** Shows it as it was left, with why its file could not be opened; what is typed then takes the place of its path. */
void dialog_complain(struct dialog *dialog, const char *why);
/** Reads the folder that the text is in, unless it was read; to be called before its entries are looked at. */
void dialog_look(struct dialog *dialog);
/** Whether entry @p index of the folder fits the part of a name. */
bool dialog_fits(const struct dialog *dialog, size_t index);
/** Marks the next entry that fits, by 1 below, by -1 above. */
void dialog_move(struct dialog *dialog, int by);
/** Goes to the folder around the one that is listed. */
void dialog_leave(struct dialog *dialog);
/** Takes entry @p index: a folder is listed, a file is the text. */
void dialog_take(struct dialog *dialog, size_t index);
/** Does what Enter does: true, and the path, for a file; lists a folder. Asks first before a file is written over. */
bool dialog_enter(char path[SYSTEM_PATH], struct dialog *dialog);
/** The folder that is listed, without a '/' at its end but for the root. */
void dialog_here(char path[SYSTEM_PATH], const struct dialog *dialog);

#endif
