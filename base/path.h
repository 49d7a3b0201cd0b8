/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The parts of a path. Nothing else takes paths apart. A '/' here is any separator of the system, and "C:" a
 * drive where there are such (base/system/system.h). */
#ifndef CONUS_BASE_PATH_H
#define CONUS_BASE_PATH_H

#include <stdbool.h>
#include <stddef.h>

/** Whether no folder may stand before @p path: it begins at a root or with a drive, "C:a" too, which is in whatever
 * folder that drive has been left at. False for NULL. */
bool path_is_whole(const char *path);

/** Whether @p path has no folder. */
bool path_is_name(const char *path);

/** The part of @p path behind its folder; "" where it ends in a '/'. */
const char *path_base(const char *path);

/** What is called @p title in the file @p path, as lists and sentences call it. A number, perhaps of a side, would say
 * nothing alone: before it stands the file's name without folder and endings, "Brodmann 9", unless that is long. Gives
 * @p title, or @p out, which is cut to @p size bytes. */
const char *path_title(char *out, size_t size, const char *title, const char *path);

/** Length of the folder that @p path begins with, with its '/'; 0 = none. */
size_t path_folder_length(const char *path);

/** Length of the first @p length bytes of @p path without the name that they end with: "a/b/" of "a/b/c". */
size_t path_length_above(const char *path, size_t length);

/** Length of the first @p length bytes of @p path without a '/' at their end, but for the root's. */
size_t path_plain_length(const char *path, size_t length);

/** What stands between the first @p length bytes of @p folder and a name in it: '/', or nothing where they end in one
 * or are none. */
const char *path_joint(const char *folder, size_t length);

/** Ends @p path at its last folder, without the '/', and gives the place of that NUL. NULL where it has no folder. */
char *path_cut(char *path);

/** Takes the next part off *rest, up to a '/' or the end. False when nothing is left. */
bool path_part(const char **rest, const char **part, size_t *size);

/** Calls @p take with each folder above @p path that has @p from bytes or more ("a", "a/b" of "a/b/c"), from the
 * highest on, while it returns true; false where it did not. @p path is cut meanwhile, and whole again at the end. */
bool path_each_folder(char *path, size_t from, bool (*take)(void *user, const char *folder), void *user);

/** Whether @p path, longer than @p ending, ends in it; upper and lower case are the same. */
bool path_ends_in(const char *path, const char *ending);

/** Length of the first of @p endings, with '/' between them, in which @p path ends as in path_ends_in(); 0 = none. */
size_t path_ending_length(const char *path, const char *endings);
/** Likewise of the first @p length bytes of @p path. */
size_t path_ending_within(const char *path, size_t length, const char *endings);

#endif
