/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The option --pathway, taken apart. */
#ifndef CONUS_SETTINGS_PATHWAY_OPTION_H
#define CONUS_SETTINGS_PATHWAY_OPTION_H

#include <conus/conus.h>

/** One --pathway, or several with bands of one file. End it with pathway_option_finish(). */
struct pathway_option {
    char *text;        /**< What the others point into. */
    const char *given; /**< As it was given: borrowed. */
    char *path;        /**< With ",volume=K" at its end, as the library wants it. */
    char *name;        /**< NULL if not given. */
    char *volume;      /**< "volume=K", NULL if not given. */
    double threshold;  /**< 0 if not given. */
    conus_band *bands; /**< [band_count], in the order in which they were given; names point into texts. */
    size_t band_count;
};

/** Takes @p text apart; prints an error and returns false where that is no pathway. End @p out in either case. */
bool pathway_option_parse(struct pathway_option *out, const char *text);

/** Adds the bands of @p more, whose text must outlive @p option, if both have bands of one file. Returns 1 if so, 0 if
 * not, and -1 without memory, which is printed. */
int pathway_option_join(struct pathway_option *option, const struct pathway_option *more);

void pathway_option_finish(struct pathway_option *option);

#endif
