/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The surface of a structure among the GIFTI files of a folder (docs/formats.md, "CIFTI"). */
#ifndef CONUS_LOADERS_SURFACES_SURFACE_FIND_H
#define CONUS_LOADERS_SURFACES_SURFACE_FIND_H

#include "base/job/job.h"

/** Facts that a GIFTI surface states about itself; its arrays are not read. The texts are the job's. */
struct surface_about {
    char *structure;      /**< AnatomicalStructurePrimary: "CortexLeft"; NULL if none.           */
    char *layer;          /**< AnatomicalStructureSecondary: "MidThickness".                     */
    char *geometric_type; /**< GeometricType: "Anatomical".                                      */
    size_t vertices;      /**< Vertices of its first POINTSET; 0 = none, so it is no surface.    */
};

/** Those of the file @p path, plain or gzip. All 0 for one that is no GIFTI, and after a failure. */
struct surface_about surface_about_of(struct job *job, const char *path);

struct surface_item {
    const char *name; /**< In the folder. */
    struct surface_about about;
    unsigned rank; /**< Rank of its kind; 0 is the best. */
};

/** GIFTI surfaces, sorted by name: those called *.surf.gii, or else *.gii, each plain or packed (.gz). */
struct surface_list {
    LIST(struct surface_item) items;
};

/** Lists those in @p folder, which ends in '/'. A file that cannot be read is none. */
struct surface_list surface_list_make(struct job *job, const char *folder);

/** The surface of @p structure ("CortexLeft") with @p vertices vertices, of the best kind that is there:
 * midthickness, pial, white, smoothwm, then any other that is not inflated, spherical or flat. *kind says which, in
 * words (static). CONUS_ERROR_DATA, with what is there instead, where there is none, or several are as good. NULL after
 * a failure. */
const struct surface_item *surface_list_find(struct job *job, const char **kind, const struct surface_list *list,
                                             const char *structure, size_t vertices);

#endif
