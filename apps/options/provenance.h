/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The facts in a sidecar by which `conus verify` can tell whether a result, its sources and the sidecar itself are
 * unchanged: sizes and SHA-256 of the files that were read and written, and a checksum of it all (docs/formats.md). */
#ifndef CONUS_OPTIONS_PROVENANCE_H
#define CONUS_OPTIONS_PROVENANCE_H

#include "conus/pose.h"
#include "conus/report.h"
#include "options/options.h"

#include <jansson.h>
#include <nettle/sha2.h>
#include <stdbool.h>
#include <stddef.h>

/** Limits of one answer. A query writes its answer and nine more files, with every option that names one. */
enum { PROVENANCE_INPUTS = 256, PROVENANCE_FILES = 12, SHA256_TEXT = 65 };

/** A file that was written, or is about to be. */
struct provenance_output {
    const char *option; /**< "output", "voxels", ... */
    const char *path;   /**< NULL = standard output. */
    const char *text;   /**< Its future content; NULL = the file is there and is read. */
    size_t size;        /**< Bytes of the text. */
};

/** The question by name: "Question" of a sidecar (docs/formats.md). */
struct question {
    const struct arguments *arguments; /**< NULL = it is not recorded. */
    const char *rows;                  /**< Kind of the rows: "answers", "segments", ... */
    const char *region;                /**< "cone", "cylinder", "ball", "axis", ... */
};

/** Facts about an answer that the library does not know. Zeroed, there are none. */
struct provenance {
    const char *inputs[PROVENANCE_INPUTS]; /**< Files that were read, besides those of the atlas; words may stand
                                             behind those of poses. */
    struct provenance_output outputs[PROVENANCE_FILES];
    size_t input_count, output_count;
    struct question question;
    bool is_table;                 /**< The answer is a table for people, which begins with the warnings. */
    const char *option;            /**< Whose file the answer goes to; NULL = "output". */
    const conus_pose_error *error; /**< That of the poses, where --jitter names one; else NULL. */
    const conus_pose_stream
        *poses; /**< Where steps came from, which are forgotten: it says whether they had angles. May be NULL. */
};

/** The path of the sidecar of @p output: "a.json" of "a.tsv" or "a.csv", else with ".json" behind it. NULL without
 * memory; the caller frees it. */
char *provenance_path(const char *output);

/** Adds a file that was read, once, unless it is NULL. Anything but a regular file is listed without a checksum. */
void provenance_add_input(struct provenance *provenance, const char *path);
/** Adds a file that was written; without @p text, a NULL path is none. */
void provenance_add_output(struct provenance *provenance, const char *option, const char *path, const char *text,
                           size_t size);

/** Adds the files that options of the command line name, but the answer, its sidecar and those that are not given. */
void provenance_add_outputs(struct provenance *provenance, const struct arguments *arguments);

/** Writes @p text, a JSON object of @p size bytes, to @p path: with "Inputs", "Outputs", the "bytes" of every file that
 * has a SHA-256, and the "Checksum". Of a report in JSON the rows stay as they are. Returns the exit code and prints an
 * error unless it is 0, as do all functions below that return an int. */
int provenance_write(const char *path, const char *text, size_t size, const struct provenance *provenance);

/** Writes the report's sidecar to @p sidecar, unless that is NULL, and then its text to @p path. @p provenance has what
 * was read besides the atlas, and the other outputs, which are there already. */
int answer_write(conus_report *report, const char *path, const char *sidecar, const struct provenance *provenance);
/** Writes a report in JSON, which is its own sidecar, whose rows come last. */
int answer_write_json(const char *path, const struct provenance *provenance, const char *text, size_t size);
/** Writes only the sidecar of an answer whose text, @p size bytes, is known; NULL = it went to standard output. */
int answer_write_sidecar(conus_report *report, const char *path, const char *sidecar,
                         const struct provenance *provenance, const char *text, size_t size);

/** Adds a file to "Inputs", which it makes if there is none; a NULL path only makes it. False without memory. */
bool provenance_put_input(json_t *root, const char *path);

/** Adds the thread's warnings to "Warnings", which there is only where there are some. False without memory. */
bool provenance_put_warnings(json_t *root);

/** The question as JSON, with all options that are a part of it. NULL without memory. */
json_t *question_json(const struct question *question);

/** Adds the "bytes" and the "Checksum" to an object. False without memory. */
bool provenance_seal(json_t *root);
/** The checksum of an object: of all that conus says in it about sources, settings and outputs. False without memory.
 */
bool provenance_checksum(char out[SHA256_TEXT], const json_t *root);

/** A text, a new reference: null of other bytes than UTF-8, which cannot be found again, and of NULL. */
json_t *json_from_text(const char *text);

/** Writes a JSON and a newline, and frees it. False where it is NULL, or without memory. */
bool json_put(FILE *out, json_t *root, size_t flags);

/** Whether the checksum covers this key, to which only conus adds. */
bool provenance_is_sealed(const char *key);

/** SHA-256 of bytes and of a file, in hexadecimal; of a pack the one that its head has, computed anew. */
void provenance_hash(char out[SHA256_TEXT], const char *text, size_t size);
int provenance_hash_file(char out[SHA256_TEXT], const char *path);
/** The end of a SHA-256 that was begun with sha256_init(). */
void provenance_hash_finish(char out[SHA256_TEXT], struct sha256_ctx *context);

/** Parses a report in JSON without its rows. Gives the object, which the caller ends with json_decref(). NULL where @p
 * text is none, with *error; without memory *error stays as it was. */
json_t *provenance_parse(const char *text, size_t size, json_error_t *error);
/** The same of a file of at most @p limit bytes; NULL, without a message, where it is none. */
json_t *provenance_load(const char *path, uint64_t limit);

/** Where the rows of a report in JSON begin, which come last; NULL if it has none. */
const char *provenance_json_rows(const char *text, size_t size);

#endif
