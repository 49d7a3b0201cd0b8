/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options of `conus query`, and which of them go together. */
#ifndef CONUS_CLI_QUERY_SETTINGS_H
#define CONUS_CLI_QUERY_SETTINGS_H

#include "cli/answers/ends.h"
#include "cli/answers/mask.h"
#include "cli/answers/streamlines_out.h"
#include "cli/inquiry.h"
#include "settings/axis_options.h"

struct query_settings {
    struct inquiry_settings inquiry; /* first */
    const char *voxels;
    size_t voxels_of;
    const char *image, *deep;
    struct mask_settings mask;
    struct streamlines_out_settings streamlines;
    struct axis_settings axis;
    struct ends_settings ends;
    double point[3];
};

extern const struct option_group query_groups[]; /**< Of struct query_settings. */

/** Whether the options go together; prints an error if not. */
bool query_settings_check(const struct query_settings *settings, const struct arguments *arguments);

#endif
