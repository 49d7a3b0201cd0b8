/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Mesh files of other programs: OBJ, PLY, STL, OFF, MZ3, legacy VTK and VTP, each plain or gzip. They are at
 * most job->max_memory bytes large, packed and unpacked, as is each array in them. An error names the file. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_MESH_FOREIGN_H
#define CONUS_LOADERS_SURFACES_FOREIGN_MESH_FOREIGN_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh_space.h"
#include "atlas/surface/mesh_split.h"
#include "base/job/job.h"

/** Reads the file @p path, in world mm, checked by mesh_check(), path set: @p out is the caller's to finish, and
 * untouched by a failure. Polygons and strips become triangles; LPS coordinates, RAS. Notes say what mesh_check()
 * finds, and that the file does not state its space, which is then RAS; @p space overrides what it states. */
void mesh_foreign_file(struct job *job, struct mesh *out, const char *path, enum mesh_space space);

/** Reads the file @p path into @p parts: one per object ("o NAME") of an OBJ that has several, numbered from 1 in the
 * order in which they come first, else the whole surface as part 1. @p names, which is empty, gets an entry per part,
 * without a name where the file gives none. Otherwise like mesh_foreign_file(). */
void mesh_foreign_objects(struct job *job, struct mesh_parts *parts, struct label_table *names, const char *path,
                          enum mesh_space space);

struct mesh_foreign_options {
    enum mesh_space space; /**< Overrides the space that the files state; MESH_SPACE_UNSTATED = as they state. */
    uint64_t max_memory;   /**< Of the job. */
};

/** Reads @p count files into @p out[count], all of them, or none; one note says how many do not state their space.
 * Bridge: load_areas.c, whose notes wait beside its job, until the scene is one loop. */
conus_status mesh_foreign_read(struct mesh *out, const char *const *paths, size_t count,
                               const struct mesh_foreign_options *options, struct notes *notes);

#endif
