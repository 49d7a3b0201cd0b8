/* SPDX-License-Identifier: BSD-3-Clause */
/* The numbers of a question that every program asks, and the web page, which has none of apps/settings. */
#include "conus/selection.h"
#include "options/options.h"

const struct option ray_options[] = {
    {OPTION_VALUED("resolution", conus_selector_options, resolution, "N"),
     .help = "trace N x N rays, one per pixel, N from 1 to 1024", .standard = OPTION_DIGITS(CONUS_RESOLUTION_DEFAULT),
     OPTION_FROM_TO(1, 1024), .words = "rays", .flags = OPTION_OF_RAYS},
    {0},
};
