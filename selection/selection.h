/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The selector and its answers, from inside. */
#ifndef CONUS_SELECTION_SELECTION_H
#define CONUS_SELECTION_SELECTION_H

#include "selection/evidence.h"
#include "selection/score.h"

struct conus_selector {
    const conus_atlas *atlas;
    conus_selector_options options; /**< Defaults filled in; strings are not kept (score is looked up). */
    const struct score *score;
    struct engine *engine;
    struct tally tally; /**< Prepared for the atlas's objects. */
    struct census census;
    double *whole; /**< [object_count + 1] Volumes of the objects, mm^3; with all layers. */
};

struct conus_selection {
    const conus_atlas *atlas; /**< Must outlive the selection. */
    conus_sampling sampling;
    char engine[96];
    struct cone cone;
    struct region region; /**< Where voxels are counted: the cone, or a ball. */
    struct evidence evidence;
    bool has_layers;
    struct layers layers; /**< Sorted, if has_layers. */
    bool *in_cone;        /**< [n*n] */
    struct statistics statistics;
};

#endif
