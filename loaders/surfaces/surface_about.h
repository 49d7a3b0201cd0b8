/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a GIFTI surface says about itself, without reading its arrays. */
#ifndef CONUS_LOADERS_SURFACES_SURFACE_ABOUT_H
#define CONUS_LOADERS_SURFACES_SURFACE_ABOUT_H

#include "base/status.h"

#include <stddef.h>

struct surface_about {
    char *structure;      /**< AnatomicalStructurePrimary: "CortexLeft"; NULL if none; owned, like the others.   */
    char *layer;          /**< AnatomicalStructureSecondary: "MidThickness".                                     */
    char *geometric_type; /**< GeometricType: "Anatomical".                                                      */
    size_t vertices;      /**< Of its first POINTSET; 0 where it has none, and is no surface.                    */
};

void surface_about_finish(struct surface_about *about);

/** Reads the file @p path, plain or gzip. All 0 for one that is no GIFTI. Errors carry the path. */
conus_status surface_about_read(struct surface_about *out, const char *path, uint64_t max_memory);

#endif
