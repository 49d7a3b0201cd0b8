/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where two texts that should be the same differ: line, column, and what stands there. */
#ifndef CONUS_CLI_VERIFY_ROWS_DIFFER_H
#define CONUS_CLI_VERIFY_ROWS_DIFFER_H

#include "options/options.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

enum { DIFFERENCES = 10 /* listed of all */ };

struct difference {
    size_t line;  /**< From 1, of the first text; the second's where the first has ended. */
    char *where;  /**< "query 1, Sphere: share" of a table, else ""; */
    char *before; /**< what stands there in the first text; NULL = it has ended, */
    char *after;  /**< and in the second, likewise. */
};

struct differences {
    struct difference items[DIFFERENCES];
    size_t listed, count, lines; /**< Differences in items, all differences, lines of the longer text. */
};

/** Compares two texts line by line. In a table of tabs or commas that has a header the first cell that differs is
 * named. @p first_line: the number of the texts' first line. False without memory; @p out is the caller's to
 * differences_finish() in any case. */
bool differences_find(struct differences *out, const char *before, size_t before_size, const char *after,
                      size_t after_size, size_t first_line);
void differences_finish(struct differences *differences);

/** How the second of two sidecars came about. Zeroed: in the same place, by the same version and engine. */
struct sidecar_terms {
    const struct arguments *arguments; /**< The recorded command line, which names the outputs; NULL = unknown. */
    const char *folder; /**< Of the stage, where absolute paths were found elsewhere; NULL = none were. */
    bool other_engine;  /**< It was answered by another engine than the recorded one. */
    bool older;         /**< Another version of conus wrote the first one. */
};

/** Compares every value of the sidecar @p recorded with the one of @p again, the sidecar of the same answer made anew:
 * *out is "Settings.resolution is 16 there, and 32 when it is answered again", of the first that differs, or NULL where
 * none does; the caller frees it. Keys that others added beside those of conus do not count, nor do what
 * docs/commands.md lists under `conus verify`. False without memory. */
bool sidecars_differ(char **out, const json_t *recorded, const json_t *again, const struct sidecar_terms *terms);

#endif
