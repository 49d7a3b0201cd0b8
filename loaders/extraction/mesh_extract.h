/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Surfaces of the areas of a labelled volume, made by conus-mesh. */
#ifndef CONUS_LOADERS_EXTRACTION_MESH_EXTRACT_H
#define CONUS_LOADERS_EXTRACTION_MESH_EXTRACT_H

#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "base/job/job.h"

/* These keep AAL nearest to its voxels; with more smoothing the corners of voxels are lost, too. */
enum { MESH_DEFAULT_SMOOTH = 5 };
#define MESH_DEFAULT_PASS_BAND 0.7

struct mesh_extract_options {
    uint32_t iterations; /**< Windowed-sinc smoothing; 0 = none. */
    double pass_band;    /**< Pass band of the smoothing, above 0 to 2; less is smoother. */
    double reduction;    /**< Fraction of the triangles that decimation removes, in [0, 1). */
    uint64_t max_memory; /**< Bytes, for conus-mesh and for one mesh. */
};

/** Gets the surface of area @p number of the atlas, checked (mesh_check()), in world mm. */
typedef void (*mesh_take)(struct job *job, void *user, uint32_t number, const struct mesh *mesh);

/** Gives @p take one surface for each area that has voxels in the atlas's parcellations, in their order. Notes are what
 * mesh_check() finds. Ends early when the job fails. Without a parcellation, nothing happens. */
void mesh_extract(struct job *job, const conus_atlas *atlas, const struct mesh_extract_options *options, mesh_take take,
                  void *user);

#endif
