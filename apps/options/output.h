/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where results go: stdout, or files that appear whole or not at all. */
#ifndef CONUS_OPTIONS_OUTPUT_H
#define CONUS_OPTIONS_OUTPUT_H

#include "conus/report.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/** Whether @p path means stdout: NULL or "-". */
bool output_is_stdout(const char *path);

/** Whether the folder of @p path is there (@p how 0) or can be written to (SYSTEM_WRITE). Returns the exit code and
 * prints an error unless it is 0. */
int output_check_folder(const char *path, unsigned how);

/** Writes to the file @p path, or to stdout. Returns the exit code and prints an error unless it is 0. */
int output_write(const char *path, const char *text, size_t size);

/** The same of tables for people: on a terminal they fit it, and their headers are bold. */
int output_write_table(const char *path, const char *text, size_t size);

/** Has @p put write a text about @p what, makes it plain, then writes it to stdout in one piece: nothing comes out of a
 * failure. Returns the exit code likewise. */
int output_put(bool put(FILE *out, const void *what), const void *what);

struct system_text;

/** Closes a text, makes it plain, writes it to stdout and frees it. Returns the exit code likewise. */
int output_end(struct system_text *text);

/** Flushes stdout: a full disk or a closed pipe is an error, not silence. Gives @p code if all is well
 * or something was wrong before. */
int output_finish(int code);

/** Whether a file that is renamed to @p path replaces nothing but a file, no device, pipe, folder or link. Returns the
 * exit code and prints an error unless it is 0. */
int output_check_file(const char *path);

/** Whether @p path is stdout or there already and no file: a device, a pipe. */
bool output_is_no_file(const char *path);

/** Finds the format by the ending of @p path: .txt is a table. False if the ending names none. */
bool output_format(conus_format *out, const char *path);

/** Whether a format is another program's. */
bool format_is_foreign(conus_format format);

/** Whether a format is for probes: it lists the areas along their shanks or at their channels. */
bool format_is_of_probe(conus_format format);

/** The part of @p path behind its last slash; all of it where nothing follows that slash. */
const char *path_name(const char *path);

/** Whether @p path ends in .exr or .png. */
bool path_is_picture(const char *path);

/** Where a path leads. Equal ones are one regular file, be it there already or not yet. */
struct path_place {
    uint64_t device, inode; /**< The file's, else those of the folder that it would be in, else 0. */
    const char *name;       /**< "" of a file, else its name in that folder, else all of the path; within the path. */
};

/** False where @p path leads to a device, a pipe or a folder; its place is the path then. */
bool path_find_place(struct path_place *out, const char *path);

/** As strcmp(): an order in which equal places are neighbours. */
int path_place_order(const struct path_place *a, const struct path_place *b);

/** Whether both paths lead to one regular file, be it there already or not yet. */
bool paths_equal(const char *a, const char *b);

#endif
