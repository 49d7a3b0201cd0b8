/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A source whose poses are put there, as those that the mouse finds on a surface. */
#ifndef CONUS_VIEWER_DEVICES_PUSHED_H
#define CONUS_VIEWER_DEVICES_PUSHED_H

#include "viewer/devices/source.h"

struct pushed {
    struct source source; /**< First: a pointer to it is one to this. */
    conus_pose pose;
    bool is_new;
};

void pushed_init(struct pushed *out);
/** The next answer is this pose. */
void pushed_put(struct pushed *pushed, const conus_pose *pose);

#endif
