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

/** A volume as it was read. */
struct probability_map {
    conus_volume_info info;
    struct value_map map;
};

/** The volumes of a file, read one after the other. */
struct probability_maps {
    struct volume_file *file;        /**< Opened as a series. */
    struct probability_map *volumes; /**< [count] Those that are kept, else zeros. */
    size_t count;
    struct value_spread spread; /**< Over all that were read, */
    bool masks;                 /**< and whether each has 0 and one other value. */
};

/** None is read yet. The job's; NULL after a failure. @p file must live as long as volumes are read and added. */
struct probability_maps *probability_maps_new(struct job *job, struct volume_file *file);

/** Reads volume @p volume; keeps it only if @p kept. */
void probability_maps_read(struct job *job, struct probability_maps *maps, size_t volume, bool kept);

/** The scale of the file, of which all volumes were read. It is @p stated unless that is 0; else value_scale_of() of
 * all volumes, but for masks, which have any value. Strays below 0 or above the scale are warned of. CONUS_ERROR_DATA
 * for others (value_spread_strays()), and where there is no usual scale. */
struct probability_scale probability_scale_of(struct job *job, const struct probability_maps *maps, double stated);

/** Adds volume @p volume, which was kept and no longer is, divided by @p scale, as the area @p label, of the voxels
 * with probabilities from @p threshold on. The atlas gets the job's notes, too. */
void probability_add(struct job *job, conus_atlas *atlas, struct probability_maps *maps, size_t volume,
                     const struct label *label, const struct probability_scale *scale, double threshold);

#endif
