/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which poses of a file conus render draws, and the file that each picture goes to. */
#ifndef CONUS_CLI_PICTURES_RENDER_ROWS_H
#define CONUS_CLI_PICTURES_RENDER_ROWS_H

#include <conus/conus.h>

#include <stdbool.h>

/** Which rows: all, unless one of these is set. */
struct row_choice {
    uint32_t number; /**< From 1; 0 = not given. */
    const char *id;  /**< Every row of that name; NULL = not given. */
};

struct drawn_row {
    const conus_pose_row *row; /**< Perhaps one with an error, which has no picture. */
    char *path;
};

struct drawn_rows {
    const char *file; /**< What messages call the file of poses. */
    struct drawn_row *items;
    size_t count;
};

/** Whether every {word} in the name @p pattern is one that stands for a part of a row; prints an error if not. */
bool render_pattern_check(const char *pattern);

/** Whether there is any such word in it. */
bool render_pattern_varies(const char *pattern);

/** Chooses rows of @p list, which must outlive @p out, and names their pictures by @p pattern: {query} is the row's
 * name without what a file's name must not have, {row} its number. No two pictures have one name. Returns the exit code
 * and prints an error unless it is 0; @p out is the caller's to render_rows_finish() in any case. */
int render_rows_choose(struct drawn_rows *out, const conus_pose_list *list, const struct row_choice *choice,
                       const char *pattern);
void render_rows_finish(struct drawn_rows *rows);

#endif
