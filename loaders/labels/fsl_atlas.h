/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FSL's atlas specification: one XML that names images (in several resolutions) and their labels. And SPM's,
 * which CAT12 has, too: the same outermost elements, but index and name of a label are elements of their own. */
#ifndef CONUS_LOADERS_LABELS_FSL_ATLAS_H
#define CONUS_LOADERS_LABELS_FSL_ATLAS_H

#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

enum { FSL_ATLAS_LIMIT = 4 << 20 }; /**< Bytes of an atlas XML. */

/** Paths as written: relative to the XML's folder although they begin with '/', and without ending. NULL = none. */
struct fsl_image {
    const char *image;   /**< Type Label: labels; else one volume per label. */
    const char *summary; /**< Type Label: the same; else labels. */
};

/** The x y z of a label: a voxel of the first image. */
struct fsl_point {
    bool given;
    double at[3];
};

struct fsl_atlas {
    const char *type; /**< As written. */
    bool is_label;    /**< Type Label: index should be the voxel value. Else the number of a volume. */
    bool is_spm;      /**< SPM's or CAT12's: index is the voxel value, always. */
    bool proved;      /**< fsl_atlas_number() found the x y z of the labels in the volume. */
    struct fsl_image *images;
    size_t image_count, image_capacity;
    struct label_table labels; /**< By index + 1, as in the file, until fsl_atlas_number(). */
    struct fsl_point *points;  /**< [point_count], of the labels until fsl_atlas_number(). */
    size_t point_count, point_capacity;
};

/** Parses the bytes of an atlas XML. All of it is the job's; after a failure an atlas without anything. */
struct fsl_atlas *fsl_atlas_parse(struct job *job, struct text text);

/** Gives the labels the numbers that they have in a volume of labels, and sorts them: index or index + 1, as their
 * points say if @p use has a volume, else as the type says (docs/formats.md). @p use->path is the XML's. */
void fsl_atlas_number(struct job *job, struct fsl_atlas *atlas, const struct label_use *use);

#endif
