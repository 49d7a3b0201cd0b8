/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FSL's atlas specification: one XML that names images (in several resolutions) and their labels. */
#ifndef CONUS_LOADERS_FSL_ATLAS_H
#define CONUS_LOADERS_FSL_ATLAS_H

#include "atlas/labels.h"

/** Paths as written: relative to the XML's folder although they begin with '/', and without ending. */
struct fsl_image {
    char *image;   /**< Type Label: labels; else one volume per label. */
    char *summary; /**< Type Label: the same; else labels.             */
};

struct fsl_atlas {
    char *type;    /**< As written.                                                       */
    bool is_label; /**< Type Label: index = voxel value. Else index = number of a volume. */
    struct fsl_image *images;
    size_t image_count;
    struct label_table
        labels; /**< By voxel value of the label images: index, or index + 1 if not is_label. Unsorted. */
};

/** Parses the bytes of an atlas XML. */
conus_status fsl_atlas_parse(struct fsl_atlas *out, struct text text, struct notes *notes);
void fsl_atlas_finish(struct fsl_atlas *atlas);

enum fsl_use {
    FSL_LABELS, /**< The volume holds labels: a summary image, or an image of type Label. */
    FSL_VOLUMES /**< It holds one volume per label; volume k is label k + 1.             */
};

/** Finds the atlas XML, in the folder of @p volume_path or the one above, that names this volume for that use, its
 * labels sorted. *path is the XML's, the caller's to memory_free(), or NULL (and @p out empty) if there is none. */
conus_status fsl_atlas_find(struct fsl_atlas *out, char **path, const char *volume_path, enum fsl_use use,
                            struct notes *notes);

#endif
