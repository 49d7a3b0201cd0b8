/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files of the programs: those that are read and those that are written, and whether they may be. */
#ifndef CONUS_OPTIONS_OUTPUT_H
#define CONUS_OPTIONS_OUTPUT_H

#include "conus/own.h"
#include "options/options.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Where results go: stdout, or files that appear whole or not at all. */

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

/** Writes @p size bytes of text as HTML has them, in tags, too. */
void html_put(FILE *out, const char *text, size_t size);

/** Writes the bytes of the file @p path in base64. Returns the exit code likewise. */
int base64_put(FILE *out, const char *path);

/** Flushes stdout: a full disk or a closed pipe is an error, not silence. Gives @p code if all is well
 * or something was wrong before. */
int output_finish(int code);

/** Whether a file that is renamed to @p path replaces nothing but a file, no device, pipe, folder or link. Returns the
 * exit code and prints an error unless it is 0. */
int output_check_file(const char *path);

/** Whether @p path is stdout or there already and no file: a device, a pipe. */
bool output_is_no_file(const char *path);

/** Finds the format by the ending of @p path: .txt is a table. False if the ending names none. */
bool output_format(const char **out, const char *path);

/** Whether a format, of answers or of poses, is called so. NULL, of answers, is "table". */
bool format_is(const char *format, const char *name);

/** What is known of a format of answers. */
const conus_format_info *format_of(const char *name);

/** The part of @p path behind its last slash; all of it where nothing follows that slash. */
const char *path_name(const char *path);

/** Whether @p path ends in .exr or .png. */
bool path_is_picture(const char *path);

/** Whether both paths lead to one regular file, be it there already or not yet. */
bool paths_equal(const char *a, const char *b);

/* The files that a command line writes, and whether they may be: no file replaces another one unless --force is
 * given. */

/** A file that is written. */
struct output {
    char what[64]; /**< "--output" or "the .json beside --output", for messages. */
    const char *path;
    bool is_sidecar; /**< It is beside another one. */
};

enum { OUTPUT_LIMIT = 16 };

struct outputs {
    struct output items[OUTPUT_LIMIT];
    size_t count;
};

/** Whether the value of --sidecar says that there is none. */
bool sidecar_is_none(const char *given);

/** Lists the files that options of the command line name: the answer, the sidecar, those that belong to it, and rows.
 * Their paths are the command line's. */
void outputs_collect(struct outputs *out, const struct arguments *arguments);
/** Has the process keep the list of all that it reads, and adds the files that the command line names. Returns the exit
 * code and prints an error unless it is 0. */
int outputs_begin(const struct arguments *arguments);
/** Adds the sidecar beside the file of @p option; no path (NULL) is fine. */
void outputs_add_sidecar(struct outputs *out, const char *option, const char *path);

/** Whether all are different files; prints an error if not. */
bool outputs_differ(const struct outputs *outputs);

/** Whether none would take the place of a file that the command line names as an input, or that was read by now, also
 * by a link to it (conus_inputs_find()); prints an error if one would. */
bool outputs_spare_inputs(const struct outputs *outputs);
/** The same of one file that @p what names, "--output". */
bool output_spares_inputs(const char *what, const char *path);

/** Whether they can be written: their folders are there, and no file is where one goes; with @p force only a sidecar
 * may be where a sidecar goes, and @p force without a file is an error. Devices, pipes and what is open already
 * (/dev/stdout) are written to, not replaced. Returns the exit code and prints an error unless it is 0. */
int outputs_check(const struct outputs *outputs, bool force);

/** Whether a sidecar may be written to @p path, with --force: nothing is there, or a sidecar. Likewise. */
int outputs_check_sidecar(const char *path);

/** Whether a sidecar can hold a path or a word of the command line: what has control characters, or bytes that are no
 * UTF-8, could not be found again. Likewise. */
int outputs_check_name(const char *name);

/* Reading files that somebody names, of any kind and size, without waiting or growing for ever. */

/** Opens a regular file; NULL, after an error message, for all else. */
FILE *input_file_open(const char *path);

enum input_kind { INPUT_FILE, INPUT_FILE_OR_PIPE };

/** Reads @p path, at most @p limit bytes; a NUL stands behind them. @p text is the caller's to free(). Returns the exit
 * code and prints an error unless it is 0. */
int input_file_read(char **text, size_t *size, const char *path, enum input_kind kind, uint64_t limit);

/** Whether a file of poses, with the words behind it, is standard input; and whether it is that or a pipe, and so can
 * be read but once. */
bool poses_are_stdin(const char *path);
bool poses_are_no_file(const char *path);

/* A new folder that only the user can read, in which files stand where somebody else's paths name them: by links, or
 * by copies where the system has no links. */

struct stage {
    char *folder; /**< In $TMPDIR or /tmp, "conus-NAME-" and six letters. */
    char *cwd;    /**< Where relative paths begin: in it, as deep as was asked for. */
    int levels;
};

/** Makes its folder and nothing in it. Relative paths may have fewer than @p levels "..", or none where it is 0. False,
 * after an error message, where that fails; @p out is the caller's to stage_end() in any case. */
bool stage_begin(struct stage *out, const char *name, int levels);

/** Makes a link to @p target, a whole path, by the name @p path, or where the system has none a copy, and the folders
 * before it. False, after an error message, where that fails. */
bool stage_link(const struct stage *stage, const char *path, const char *target);

/** The word @p given, whose paths are somebody else's, with the stage's folder before each whole one: "from=/a". NULL
 * without memory; the caller frees it. */
char *stage_word(const struct stage *stage, const char *given);

/** Takes the stage's folder from the whole paths in @p text, wherever they stand: stage_word()'s are as given. */
void stage_leave(char *text, const char *folder);

/** A new path, in a folder of its own in the stage, for the output of @p option with the name @p name. NULL where it
 * cannot be made; the caller frees it. */
char *stage_output(const struct stage *stage, const char *option, const char *name);
/** The file that was written there, other than one in ".json" beside another; NULL if there is none, likewise. */
char *stage_find_output(const struct stage *stage, const char *option);

/** Copies a file to a new one. False, with errno, where that fails; what is there already stays. */
bool file_copy(const char *from, const char *to);

/** Removes it, with all that is in it, unless @p stays. */
void stage_end(struct stage *stage, bool stays);

#endif
