/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The folders and files of a folder, as a dialog lists them. */
#ifndef CONUS_VIEWER_WINDOW_FOLDER_H
#define CONUS_VIEWER_WINDOW_FOLDER_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

enum { FOLDER_LIMIT = 100000 /* entries; more are left out */ };

/** Which files are listed. Folders are always. */
enum folder_filter { FOLDER_OPENABLE, FOLDER_SESSIONS, FOLDER_ALL };

struct folder_entry {
    char *name;
    bool is_folder;
};

/** All 0 is one that was not read. */
struct folder {
    char path[PATH_MAX]; /**< As it was read; "" = none. */
    enum folder_filter filter;
    struct folder_entry *entries; /**< [count] Folders first, each kind by name, in which case does not count. */
    size_t count;
    bool failed; /**< It cannot be read, or there is no memory; then count is 0. */
};

/** Reads the folder @p path in place of the one before. Names that begin with a dot are left out. */
void folder_read(struct folder *folder, const char *path, enum folder_filter filter);
void folder_finish(struct folder *folder);

/** Whether a file's name ends as one that conus can open, or a session; those without an ending are told by nothing. */
bool folder_can_open(const char *name);
/** Whether @p text is in @p name; upper and lower case are the same. */
bool folder_fits(const char *name, const char *text);

#endif
