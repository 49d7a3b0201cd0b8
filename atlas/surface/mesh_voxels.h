/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The fraction of each voxel that is inside a closed mesh (Eq. 16). */
#ifndef CONUS_ATLAS_SURFACE_MESH_VOXELS_H
#define CONUS_ATLAS_SURFACE_MESH_VOXELS_H

#include "atlas/surface/mesh.h"

/** Voxels whose index coordinates are from `low` to `high`, both among them. */
struct voxel_box {
    size_t low[3], high[3];
    size_t count[3];
    double *inside; /**< [count[2]][count[1]][count[0]] Parts of a voxel. Owned by the caller, memory_free(). */
};

/** Measures the inside of @p mesh, which winds once around it (mesh_winds_once()), in the voxels from @p out->low to @p
 * out->high that its bounds meet: sets the box to these, and `inside`, NULL if there are none. Exact but for rounding:
 * by the divergence theorem a sum over the pieces of triangles in each voxel. CONUS_ERROR_MEMORY. */
conus_status mesh_voxels_measure(struct voxel_box *out, const struct mesh *mesh, const double voxel_from_mesh[16]);

#endif
