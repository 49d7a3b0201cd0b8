/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Mesh files of other programs: OBJ, PLY, STL, OFF, MZ3, legacy VTK and VTP, each plain or gzip. They are at
 * most job->max_memory bytes large, packed and unpacked, as is each array in them. An error names the file. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_MESH_FOREIGN_H
#define CONUS_LOADERS_SURFACES_FOREIGN_MESH_FOREIGN_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh_space.h"
#include "atlas/surface/mesh_split.h"
#include "base/job/job.h"

/** Reads @p count files into @p out[count], in world mm, checked by mesh_check(), path set: all of them, which are the
 * caller's to finish, or none. Polygons and strips become triangles; LPS coordinates, RAS. Notes say what mesh_check()
 * finds; one says how many files do not state their space, which is then RAS; @p space overrides what they state. */
void mesh_foreign_files(struct job *job, struct mesh *out, const char *const *paths, size_t count,
                        enum mesh_space space);

/** Reads the file @p path into @p parts: one per object ("o NAME") of an OBJ that has several, numbered from 1 in the
 * order in which they come first, else the whole surface as part 1. @p names, which is empty, gets an entry per part,
 * without a name where the file gives none. Otherwise like mesh_foreign_files(). */
void mesh_foreign_objects(struct job *job, struct mesh_parts *parts, struct label_table *names, const char *path,
                          enum mesh_space space);

#endif
