/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The page on which a file is chosen, to be opened or written: a path, and the folder that it is in. */
#ifndef CONUS_VIEWER_WINDOW_DIALOG_H
#define CONUS_VIEWER_WINDOW_DIALOG_H

#include "viewer/window/start.h"

#include "base/system/system.h"
#include <stdbool.h>
#include <stddef.h>

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

/** Whether a file's name ends as one that conus can open, or a session; those without an ending are told by nothing. */
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
