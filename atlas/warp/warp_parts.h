/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The parts of atlas_warp(): what the atlas gets, made before anything is changed. */
#ifndef CONUS_ATLAS_WARP_WARP_PARTS_H
#define CONUS_ATLAS_WARP_WARP_PARTS_H

#include "atlas/warp/warp.h"

/** The way of points to the atlas's own space: first an affine, then the warps, the last one first. */
struct warp_way {
    double first[16];
    const struct warp *warps;
    size_t count;
};

/** Volumes on a new grid. */
struct warped_volumes {
    struct volume *items;    /**< [volume_count] Volumes that stay as they are have no voxels here. */
    uint64_t *voxels;        /**< [object_count + 1] How many each object has there.          */
    size_t sampled, outside; /**< Labelled voxels that were sampled, and how many of them are outside. */
};

/** Resamples the volumes that @p way warps. */
conus_status warped_volumes_init(struct warped_volumes *out, const conus_atlas *atlas, const struct warp_way *way,
                                 const struct warp_plan *plan);

/** Adds notes about objects that the new volumes lack. */
conus_status warped_volumes_note(const struct warped_volumes *volumes, conus_atlas *atlas, const char *words);

/** Puts them into the atlas; @p volumes gets the old ones. */
void warped_volumes_take(struct warped_volumes *volumes, conus_atlas *atlas);
void warped_volumes_finish(struct warped_volumes *volumes, size_t count);

/** Points that went back through the fields, and the triangles or streamlines that they make. */
struct warped_counts {
    uint64_t points, outside, lost;
    uint64_t wholes, cut; /**< All, and those left out. */
};

/** Surfaces in their new place. */
struct warped_meshes {
    struct mesh *items; /**< [mesh_count] */
    struct warped_counts counts;
};

/** Moves the surfaces back through @p count fields, the first one first. */
conus_status warped_meshes_init(struct warped_meshes *out, const conus_atlas *atlas, const struct deformation *fields,
                                size_t count, struct notes *notes);
void warped_meshes_finish(struct warped_meshes *meshes, size_t count);

/** Tractograms in their new place, for bundles_take(). */
struct warped_tracts {
    struct tractogram *items; /**< [tractogram_count] */
    struct warped_counts counts;
};

/** Moves streamlines likewise. CONUS_ERROR_DATA where nothing of a tractogram is left. */
conus_status warped_tracts_init(struct warped_tracts *out, const conus_atlas *atlas, const struct deformation *fields,
                                size_t count);
void warped_tracts_finish(struct warped_tracts *tracts, size_t count);

#endif
