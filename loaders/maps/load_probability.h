/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas of probabilistic atlases: one volume of probabilities each. */
#ifndef CONUS_LOADERS_MAPS_LOAD_PROBABILITY_H
#define CONUS_LOADERS_MAPS_LOAD_PROBABILITY_H

#include "loaders/maps/atlas_on_job.h"

/** How a file says how probable something is. */
struct probability_scale {
    double value;      /**< The value that means "certainly"; 0: the largest value of each volume, which is a mask. */
    const char *words; /**< "percent", for notes. */
};

/** The scale of @p file, opened as a series. It is @p stated unless that is 0; else value_scale_of() of all volumes,
 * but for masks, which have any value. Strays below 0 or above the scale are warned of. CONUS_ERROR_DATA for others
 * (value_spread_strays()), and where there is no usual scale. */
struct probability_scale probability_scale_of(struct job *job, struct volume_file *file, double stated);

/** Adds volume @p volume of @p file, divided by @p scale, as the area @p label, of the voxels with probabilities from
 * @p threshold on. The atlas gets the job's notes, too. */
void probability_add(struct job *job, conus_atlas *atlas, struct volume_file *file, size_t volume,
                     const struct label *label, const struct probability_scale *scale, double threshold);

#endif
