/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The keys behind the path of a volume: FILE,volume=K, FILE,level=K and FILE,resolution=R,orientation=ABC; of a
 * mesh with values: FILE,field=NAME,tissue=A:B. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_SELECTOR_H
#define CONUS_LOADERS_VOLUMES_VOLUME_SELECTOR_H

#include "base/job/job.h"
#include "loaders/brainglobe/brainglobe_metadata.h"

/** The keys, in the order in which a refusal names one. */
enum volume_key { KEY_FIELD, KEY_TISSUE, KEY_LEVEL, KEY_ORIENTATION, KEY_RESOLUTION, KEY_VOLUME, VOLUME_KEYS };
#define VOLUME_KEY(key) (1U << (key))

enum { TISSUE_LIMIT = 16 };

struct volume_selector {
    char *path;     /**< Without what follows; the job's. */
    unsigned given; /**< VOLUME_KEY() of each. */
    uint64_t volume, level;
    struct brainglobe_metadata place; /**< resolution and orientation, as far as they are given. */
    struct text field;                /**< In the text that was parsed; empty = none is given. */
    uint32_t tissues[TISSUE_LIMIT];
    size_t tissue_count;
};

/** Takes @p text apart. CONUS_ERROR_ARGUMENT with the key where a value is not allowed. */
void volume_selector_read(struct job *job, struct volume_selector *out, const char *text);

/** CONUS_ERROR_ARGUMENT where a key is given that is not @p allowed (of VOLUME_KEY()). */
void volume_selector_refuse(struct job *job, const struct volume_selector *selector, unsigned allowed);

#endif
