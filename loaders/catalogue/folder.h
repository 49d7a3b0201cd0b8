/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlases in a folder and in those below it. */
#ifndef CONUS_LOADERS_CATALOGUE_FOLDER_H
#define CONUS_LOADERS_CATALOGUE_FOLDER_H

#include "loaders/catalogue/catalogue.h"

/** How a place is looked through. */
struct folder_rule {
    size_t depth;                /**< Of the folders below that are looked at. */
    const char *const *patterns; /**< Of the names of labelled volumes, up to NULL; NULL: volume_marks.h finds out. */
    const char *cut;             /**< Ending of a name without the file's that is no part of it; NULL = none. */
    bool subjects;               /**< It holds subjects of FreeSurfer: freesurfer.h. */
};

/** Adds the labelled volumes, manifests, FSL atlases and BrainGlobe folders. */
conus_status folder_look(conus_catalogue *catalogue, const char *folder, const struct folder_rule *rule);

#endif
