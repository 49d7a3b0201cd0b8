/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Mesh files of other programs: OBJ, PLY, STL, OFF, MZ3, legacy VTK and VTP, each plain or gzip. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_MESH_FOREIGN_H
#define CONUS_LOADERS_SURFACES_FOREIGN_MESH_FOREIGN_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh_space.h"
#include "atlas/surface/mesh_split.h"

struct mesh_foreign_options {
    enum mesh_space space; /**< Overrides the space that the files state; MESH_SPACE_UNSTATED = as they state. */
    uint64_t max_memory;   /**< Bytes, for each file, packed and unpacked, and each array in it; 0 = 8 GiB. */
};

/* Bridge: both run a job of their own, for the scene, which gives its job when it is on one itself. */

/** Reads @p count files into @p out[count], in world mm, checked by mesh_check(), path set: all of them, or none.
 * Polygons and strips become triangles; LPS coordinates, RAS. @p notes gets what mesh_check() finds, and how many files
 * do not state their space, which is then RAS. An error names the file. */
conus_status mesh_foreign_read(struct mesh *out, const char *const *paths, size_t count,
                               const struct mesh_foreign_options *options, struct notes *notes);

/** Reads the file @p path into @p parts: one per object ("o NAME") of an OBJ that has several, numbered from 1 in the
 * order in which they come first, else the whole surface as part 1. @p names, which is empty, gets an entry per part,
 * without a name where the file gives none. Otherwise like mesh_foreign_read(). */
conus_status mesh_foreign_objects(struct mesh_parts *parts, struct label_table *names, const char *path,
                                  const struct mesh_foreign_options *options, struct notes *notes);

#endif
