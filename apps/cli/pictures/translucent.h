/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options of conus render about what lets light through: opacities of areas, and pathways as haze. */
#ifndef CONUS_CLI_PICTURES_TRANSLUCENT_H
#define CONUS_CLI_PICTURES_TRANSLUCENT_H

#include "options/options.h"

#include <conus/conus.h>

struct translucent_settings {
    struct option_list opacity, pathways;
};

extern const struct option translucent_options[];

/** What they mean for one atlas. */
struct translucent {
    double *opacity; /**< For conus_view; NULL = none. */
    double pale;
    conus_pathway_transfer *pathways; /**< For the renderer; [pathway_count]. */
    size_t pathway_count;
};

/** Whether every opacity is one; prints an error if not. */
bool translucent_check(const struct translucent_settings *settings);

/** Finds the areas and pathways. Returns the exit code and prints an error unless it is 0; @p out is the caller's to
 * translucent_finish() in any case, before the settings end. */
int translucent_find(struct translucent *out, const conus_atlas *atlas, const struct translucent_settings *settings);
void translucent_finish(struct translucent *translucent);

#endif
