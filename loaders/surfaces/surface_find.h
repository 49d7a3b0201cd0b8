/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The surface of a structure among the GIFTI files of a folder (docs/formats.md, "CIFTI"). */
#ifndef CONUS_LOADERS_SURFACES_SURFACE_FIND_H
#define CONUS_LOADERS_SURFACES_SURFACE_FIND_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/** Facts that a GIFTI surface states about itself; its arrays are not read. */
struct surface_about {
    char *structure;      /**< AnatomicalStructurePrimary: "CortexLeft"; NULL if none; owned, like the others.   */
    char *layer;          /**< AnatomicalStructureSecondary: "MidThickness".                                     */
    char *geometric_type; /**< GeometricType: "Anatomical".                                                      */
    size_t vertices;      /**< Vertices of its first POINTSET; 0 = none, so it is no surface. */
};

void surface_about_finish(struct surface_about *about);

/** Reads the file @p path, plain or gzip. All 0 for one that is no GIFTI. Errors carry the path. */
conus_status surface_about_read(struct surface_about *out, const char *path, uint64_t max_memory);

struct surface_item {
    char *name; /**< In the folder. */
    struct surface_about about;
    unsigned rank; /**< Rank of its kind; 0 is the best. */
};

/** GIFTI surfaces, sorted by name: those called *.surf.gii, or else *.gii, each plain or packed (.gz). */
struct surface_list {
    struct surface_item *items;
    size_t count;
};

void surface_list_finish(struct surface_list *list);

/** Lists those in @p folder, which ends in '/'. A file that cannot be read is none. */
conus_status surface_list_make(struct surface_list *out, const char *folder, uint64_t max_memory);

/** Finds the surface of @p structure ("CortexLeft") with @p vertices vertices, of the best kind that is there:
 * midthickness, pial, white, smoothwm, then any other that is not inflated, spherical or flat. *kind says which, in
 * words (static). CONUS_ERROR_DATA, with what is there instead, where there is none, or several are as good. */
conus_status surface_list_find(const struct surface_item **out, const char **kind, const struct surface_list *list,
                               const char *structure, size_t vertices);

#endif
