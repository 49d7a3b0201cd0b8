/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The keys behind the path of a volume: FILE,volume=K, FILE,level=K and FILE,resolution=R,orientation=ABC; of a
 * mesh with values: FILE,field=NAME,tissue=A:B. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_SELECTOR_H
#define CONUS_LOADERS_VOLUMES_VOLUME_SELECTOR_H

#include "base/status.h"
#include "base/text.h"
#include "loaders/brainglobe/brainglobe_metadata.h"

enum { TISSUE_LIMIT = 16 };

struct volume_selector {
    char *path;  /**< Owned; without what follows. */
    bool chosen; /**< volume says which. */
    uint64_t volume;
    bool leveled; /**< level says which. */
    uint64_t level;
    struct brainglobe_metadata place; /**< resolution and orientation, as far as they are given. */
    struct text field;                /**< In the text that was parsed; empty = none is given. */
    uint32_t tissues[TISSUE_LIMIT];
    size_t tissue_count;
};

/** Takes @p text apart. CONUS_ERROR_ARGUMENT with the key where a value is not allowed. */
conus_status volume_selector_parse(struct volume_selector *out, const char *text);
void volume_selector_finish(struct volume_selector *selector);

/** CONUS_ERROR_ARGUMENT where it says how @p path lies, a file of a format that says so itself. */
conus_status volume_selector_refuse_place(const struct volume_selector *selector, const char *path);

/** The same where it chooses a field or tissues of a file that is no mesh. */
conus_status volume_selector_refuse_field(const struct volume_selector *selector, const char *path);

/** The same where it chooses a level of one that has none. */
conus_status volume_selector_refuse_level(const struct volume_selector *selector, const char *path);

#endif
