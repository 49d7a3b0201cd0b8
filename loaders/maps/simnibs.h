/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Meshes with fields of SimNIBS in HDF5 (Msh.write_hdf5): tetrahedra with an electric field, say. */
#ifndef CONUS_LOADERS_MAPS_SIMNIBS_H
#define CONUS_LOADERS_MAPS_SIMNIBS_H

#include "atlas/roi.h"
#include "base/child/hdf5.h"
#include "base/job/job.h"
#include "sources/source.h"

/** The objects of a file that simnibs_find() needs. */
extern const char *const simnibs_wanted[];
enum { SIMNIBS_WANTED = 10 };

/** Whether @p hdf5 has a mesh with nodes and elements. */
bool simnibs_is(const struct hdf5 *hdf5);

/** The tetrahedra of the mesh in @p hdf5 that has the field of @p keys, and their values: of vectors their length.
 * Without a field it is |E|: magnE, normE (as SimNIBS 3 calls it), or the length of E. Only those of their
 * tissues, if it has some. Nodes are finite and within 10 m of the origin; values are as they are. The arrays are the
 * job's. CONUS_ERROR_ARGUMENT for a field or tissue that is not there. Notes name keys->path, errors do
 * not. */
struct roi_mesh simnibs_find(struct job *job, const struct hdf5 *hdf5, const struct source_keys *keys);

#endif
