/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which atlas XML of FSL or SPM names a volume, and where the images are that an XML names. */
#ifndef CONUS_LOADERS_LABELS_FSL_FIND_H
#define CONUS_LOADERS_LABELS_FSL_FIND_H

#include "base/files/file.h"
#include "loaders/labels/fsl_atlas.h"

enum fsl_use {
    FSL_LABELS, /**< The volume holds labels: a summary image, or an image of type Label. */
    FSL_VOLUMES /**< It holds one volume per label; volume k is label k + 1.              */
};

/** Called with an atlas XML, its path and its bytes; it may take what the atlas has. */
typedef void fsl_visit(struct job *job, void *user, struct fsl_atlas *atlas, const char *path,
                       const struct bytes *file);

/** Visits every atlas XML, in the folder of @p volume_path and in the one above, that names this volume for that use,
 * by name, those first whose own name the volume's begins with; for FSL_LABELS also SPM's that is called as the volume
 * is and names no other image that is there. One that is damaged is passed over. */
void fsl_atlas_each(struct job *job, const char *volume_path, enum fsl_use use, fsl_visit *visit, void *user);

/** Path of @p image as the FSL atlas @p xml_path writes it: from the XML's folder, mostly without ending; NULL if there
 * is no such file. */
char *fsl_image_find(struct job *job, const char *xml_path, const char *image);

#endif
