/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A list of points and poses, such as contacts, optodes or coils: all are balls over the pictures, and one is
 * chosen, which the first tool then asks about. */
#ifndef CONUS_VIEWER_MODEL_POINTS_H
#define CONUS_VIEWER_MODEL_POINTS_H

#include "conus/picture.h"
#include "conus/pose.h"

struct atlases;
struct common_settings;
struct viewer;

enum { POINT_LIMIT = 10000 /* rows */ };

struct point_list {
    conus_pose_list *poses;    /**< NULL = none. */
    conus_drawn_point *points; /**< [count] Of rows without an error. */
    uint32_t *rows;            /**< [count] Their numbers from 1. */
    size_t count;
    bool has_electrodes; /**< The groups are the points' own. */
    unsigned number;     /**< Of lists that are not the same. */
};

/** Loads the list @p path, of positions in @p frame, for @p atlases, whose space it must share. Returns the exit code
 * and prints an error unless it is 0; then *out is unchanged. */
int points_load(struct point_list *out, const char *path, const struct atlases *atlases, const conus_frame *frame,
                double radius, const struct common_settings *common, uint64_t max_memory);
void points_finish(struct point_list *list);
/** Puts @p list, which it takes over, in the place of the viewer's; what was chosen there is chosen no more, and the
 * mouse points again. */
void points_use(struct viewer *viewer, struct point_list *list);
/** The point of the chosen row; NULL = none. */
const conus_drawn_point *points_chosen(const struct viewer *viewer);

#endif
