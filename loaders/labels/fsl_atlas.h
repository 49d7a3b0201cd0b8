/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FSL's atlas specification: one XML that names images (in several resolutions) and their labels. */
#ifndef CONUS_LOADERS_LABELS_FSL_ATLAS_H
#define CONUS_LOADERS_LABELS_FSL_ATLAS_H

#include "atlas/labels.h"
#include "loaders/labels/label_use.h"

/** Paths as written: relative to the XML's folder although they begin with '/', and without ending. */
struct fsl_image {
    char *image;   /**< Type Label: labels; else one volume per label. */
    char *summary; /**< Type Label: the same; else labels.             */
};

/** The x y z of a label: a voxel of the first image. */
struct fsl_point {
    bool given;
    double at[3];
};

struct fsl_atlas {
    char *type;    /**< As written.                                                                 */
    bool is_label; /**< Type Label: index should be the voxel value. Else the number of a volume.   */
    struct fsl_image *images;
    size_t image_count;
    struct label_table labels; /**< By index + 1, as in the file, until fsl_atlas_number().         */
    struct fsl_point *points;  /**< Of labels.entries, until fsl_atlas_number().                    */
    bool proved;               /**< fsl_atlas_number() found the x y z of the labels in the volume. */
};

/** Parses the bytes of an atlas XML. */
conus_status fsl_atlas_parse(struct fsl_atlas *out, struct text text);
void fsl_atlas_finish(struct fsl_atlas *atlas);

/** Gives the labels the numbers that they have in a volume of labels, and sorts them: index or index + 1, as their
 * points say if @p use has a volume, else as the type says (docs/formats.md). @p use->path is the XML's. */
conus_status fsl_atlas_number(struct fsl_atlas *atlas, const struct label_use *use, struct notes *notes);

enum fsl_use {
    FSL_LABELS, /**< The volume holds labels: a summary image, or an image of type Label. */
    FSL_VOLUMES /**< It holds one volume per label; volume k is label k + 1.              */
};

/** What is done with an atlas XML, whose path is @p path and whose bytes are @p file; it may take what the atlas has.
 */
typedef conus_status (*fsl_visit)(void *user, struct fsl_atlas *atlas, const char *path, const struct bytes *file);

/** Visits every atlas XML, in the folder of @p volume_path and in the one above, that names this volume for that use,
 * by name. */
conus_status fsl_atlas_each(const char *volume_path, enum fsl_use use, fsl_visit visit, void *user);

/** Path of @p image as the FSL atlas @p xml_path writes it: from the XML's folder, mostly without ending; NULL in *out
 * if there is no such file, else the caller's to memory_free(). */
conus_status fsl_image_find(char **out, const char *xml_path, const char *image);

#endif
