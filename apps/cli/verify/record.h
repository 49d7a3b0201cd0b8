/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The record of how a result was made, in its sidecar or in its JSON. Untrusted input. */
#ifndef CONUS_CLI_VERIFY_RECORD_H
#define CONUS_CLI_VERIFY_RECORD_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
void record_finish(struct record *record);

/** Whether @p text is a version of conus: digits and dots. */
bool record_is_version(const char *text);

/** Path that the record's atlas @p index was loaded from, of several in their order; NULL if it does not say. */
const char *record_atlas(const struct record *record, size_t index);

/** Path of the context of the record's atlas, of several the first's; NULL if it has none. */
const char *record_context(const struct record *record);

#endif
