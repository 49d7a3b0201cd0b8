/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The option --streamlines, taken apart. */
#ifndef CONUS_SETTINGS_STREAMLINES_OPTION_H
#define CONUS_SETTINGS_STREAMLINES_OPTION_H

#include <conus/conus.h>

/** One --streamlines. End it with streamlines_option_finish(). */
struct streamlines_option {
    char *path;    /**< Its text, which is cut where the file's name ends. */
    char *name;    /**< NULL if not given. */
    double radius; /**< mm; 0 if not given. */
    bool moves;    /**< With the atlas. */
};

/** Takes @p text apart; prints an error and returns false where that is no tractogram with its keys. End @p out in
 * either case. */
bool streamlines_option_parse(struct streamlines_option *out, const char *text);
void streamlines_option_finish(struct streamlines_option *option);

#endif
