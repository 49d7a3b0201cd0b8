/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether a result is what its sources give: the record of how it was made, and what differs. */
#ifndef CONUS_CLI_VERIFY_VERIFY_H
#define CONUS_CLI_VERIFY_VERIFY_H

#include "options/options.h"
#include "options/output.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The record of how a result was made, in its sidecar or in its JSON. Untrusted input. */

enum { COMMAND_WORDS = 4096 };

struct command_line {
    char *text;   /**< The text that the words point into. */
    char **words; /**< [count], and NULL behind them. */
    size_t count;
};

/** Cuts @p text into words as arguments_text() writes them: bare, or in single quotes. All other shell syntax is
 * refused. Returns NULL, or the reason as a static text; @p out is empty then. Free it by command_line_finish(). */
const char *command_line_parse(struct command_line *out, const char *text);
void command_line_finish(struct command_line *line);

enum { RECORD_FILES = 100000, RECORD_LIMIT = 1 << 26 /* bytes of a sidecar */ };

/** A file that was read or written. Its texts are those of the record. */
struct recorded_file {
    const char *path;   /**< NULL = standard output. */
    const char *sha256; /**< 64 digits; NULL = not recorded. */
    const char *option; /**< "output", ... of a file that was written; else NULL. */
    int64_t bytes;      /**< -1 = not recorded. */
    int64_t crc32;      /**< A batch's rows have it in place of a SHA-256; -1 = not recorded. */
};

struct record {
    json_t *root;
    const char *version;
    struct command_line line;
    struct recorded_file *inputs, *outputs; /**< Each path of an input is there once. */
    size_t input_count, output_count;
    bool is_sealed; /**< It has a checksum, */
    bool is_intact; /**< which fits. */
};

/** Reads a sidecar of @p size bytes. Returns NULL, or says why this is no sidecar; that text lasts until the thread's
 * next call. @p out is the caller's to record_finish() in both cases. */
const char *record_parse(struct record *out, const char *text, size_t size);
/** The same of the file @p path. Returns the exit code and prints an error unless it is 0. */
int record_read(struct record *out, const char *path);
void record_finish(struct record *record);

/** Path that the record's atlas @p index was loaded from, of several in their order; NULL if it does not say. */
const char *record_atlas(const struct record *record, size_t index);

/** Path of the context of the record's atlas, of several the first's; NULL if it has none. */
const char *record_context(const struct record *record);

/* Whether a result is what its sources give, and if not, why. */

enum file_state {
    FILE_SAME,     /**< Where it was, with its checksum. */
    FILE_MOVED,    /**< Elsewhere, with its checksum. */
    FILE_UNSUMMED, /**< A folder. Its checksum is that of the chunks that were read, which only a new answer tells. */
    FILE_CHANGED,  /**< A file of its name is there, with another checksum. */
    FILE_MISSING,
};

struct found_file {
    char *path; /**< Whole; NULL where it is missing. */
    enum file_state state;
    bool is_folder;
    bool is_replaced; /**< Where it was, a file of its name has another checksum. */
};

/** The folder in which conus ran: that in which @p actual has the relative path @p recorded, else "", this one. NULL
 * without memory. The caller frees it. */
char *recorded_folder(const char *recorded, const char *actual);

/** Finds @p file: by its path from the folder @p ran, else by less and less of it, down to its name, else as any file
 * in there with its bytes and checksum; else likewise in @p told, unless that is NULL. False, after an error message,
 * without memory. @p out->path is the caller's to free(). */
bool file_find(struct found_file *out, const struct recorded_file *file, const char *ran, const char *told);

/** The sidecar of @p result: itself, if it is JSON that says how it was made, or the one beside it. NULL if there is
 * none, or without memory. The caller frees it. */
char *sidecar_find(const char *result);

/** A recorded question that is asked again. Zeroed, there is none. */
struct replay {
    const struct record *record;
    const struct found_file *found; /**< [record->input_count] All of them are there. */
    const struct command *command;
    struct arguments arguments; /**< As recorded. */
    void *settings;
    uint64_t max_memory;
    struct stage stage;
    bool is_moved; /**< A whole path is no longer where it was: all of them lead into the stage. */
    char why[512]; /**< The reason of a failure. */
};

/** Takes the recorded command line apart by @p commands, a list that ends with NULL: it must be of one of those that
 * answer questions, and one that can be asked again. False, with out->why, where it is not. @p out is the caller's to
 * replay_finish() in any case. */
bool replay_check(struct replay *out, const struct command *const *commands);

/** Asks it, in this process: its words read links to what was found, and no other file, and write into the stage.
 * False, with replay->why, where there is no answer. */
bool replay_run(struct replay *replay);
void replay_finish(struct replay *replay);

/** Compares every value of the recorded sidecar with the one of @p again, the sidecar of the same answer made anew:
 * *out is "Settings.resolution is 16 there, and 32 when it is answered again", of the first that differs, or NULL where
 * none does; the caller frees it. Keys that others added beside those of conus do not count, nor do what
 * docs/commands.md lists under `conus verify`. False without memory. */
bool sidecars_differ(char **out, const json_t *again, const struct replay *replay);

struct verify_settings {
    const char *sidecar; /**< NULL = beside the result. */
    const char *folder;  /**< Where files are, too; NULL = only where conus ran, as the result's path tells. */
    uint64_t max_memory; /**< 0 = the default. */
};

enum verdict_kind {
    VERDICT_IDENTICAL,
    VERDICT_DIFFERENT,
    VERDICT_NONE, /**< It could not be answered again. */
};

/** Writes the verdict about @p result, or its JSON; of VERDICT_NONE, if that is no JSON, says why on stderr. @p
 * commands is a list that ends with NULL. Returns the exit code. */
int verify_result(const char *result, const struct verify_settings *settings, const struct command *const *commands,
                  bool is_json);

#endif
