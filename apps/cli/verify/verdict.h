/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether a result is what its sources give, and if not, why. */
#ifndef CONUS_CLI_VERIFY_VERDICT_H
#define CONUS_CLI_VERIFY_VERDICT_H

#include "cli/verify/differ.h"
#include "cli/verify/replay.h"

struct verdict_settings {
    const char *sidecar; /**< NULL = beside the result. */
    struct option_list folders;
    size_t engine;
    const char *engine_name; /**< NULL = as recorded. */
    uint64_t max_memory;     /**< 0 = the default. */
};

enum verdict_kind {
    VERDICT_IDENTICAL,
    VERDICT_DIFFERENT,
    VERDICT_NONE, /**< It could not be answered again. */
};

enum { VERDICT_LINES = 32 };

/** Up to VERDICT_LINES texts; `more` counts those that did not fit. */
struct lines {
    char *items[VERDICT_LINES];
    size_t count, more;
};

struct verdict {
    enum verdict_kind kind;
    const char *result; /**< As given. */
    char *sidecar;      /**< Its path; the result's own path where the result has it inside. */
    bool compared;      /**< There are rows, or pixels, to compare, */
    bool same;          /**< and they are the same. */
    struct lines why;   /**< Differences from the record. */
    struct lines notes; /**< Facts that do not matter, or could not be checked. */
    struct differences differences;
    struct record record;
    struct found_file *found; /**< [record.input_count] */
};

/** Finds it; @p commands is a list that ends with NULL. Returns the exit code of a mistake in the settings, with an
 * error message, else 0. @p out is the caller's to verdict_finish() in any case. */
int verdict_find(struct verdict *out, const char *result, const struct verdict_settings *settings,
                 const struct command *const *commands);
void verdict_finish(struct verdict *verdict);

/** The verdict for people and as JSON; NULL without memory. The caller frees it. */
char *verdict_text(const struct verdict *verdict);
char *verdict_json(const struct verdict *verdict);
/** Prints why the result could not be verified. */
void verdict_print_error(const struct verdict *verdict);

/** The sidecar of @p result: itself, if it is JSON that says how it was made, or the one beside it. NULL if there is
 * none, or without memory. The caller frees it. */
char *sidecar_find(const char *result);

#endif
