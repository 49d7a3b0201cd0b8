/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A region of interest: the voxels of a volume, or the tetrahedra of a mesh, whose value reaches a threshold. */
#ifndef CONUS_ATLAS_ROI_H
#define CONUS_ATLAS_ROI_H

#include "atlas/volume.h"
#include "base/tolerance.h"
#include "conus/study.h"

struct tetrahedron {
    uint32_t nodes[4]; /**< From 0. */
    float value;
};

struct conus_roi {
    struct volume volume;   /**< Without objects. Of tetrahedra it is a grid that they lie in, without values. */
    uint64_t voxels;        /**< How many voxels or tetrahedra the region has. */
    double mm3;             /**< Their volume. */
    size_t low[3], high[3]; /**< Bounds of the region in the grid, both ends in it. */
    double (*nodes)[3];     /**< World mm. NULL = it is a region of voxels. */
    struct tetrahedron *tetrahedra; /**< [voxels] Those of the region; the two are owned. */
};

/** Takes over @p values, scaled, one per voxel, on success; info->threshold says which of them count, as
 * conus_roi_options has it. Errors as of conus_roi_load(). */
conus_status roi_create(conus_roi **out, const conus_volume_info *info, float *values);

/** A mesh, all of it. */
struct roi_mesh {
    double (*nodes)[3]; /**< World mm. */
    size_t node_count;
    struct tetrahedron *tetrahedra; /**< Their nodes are there. */
    size_t count;                   /**< At least 1. */
};

/** The same of the tetrahedra of @p mesh, whose arrays it takes over on success. Of @p info only path, sum, format,
 * datatype and threshold are read. */
conus_status roi_create_mesh(conus_roi **out, const conus_volume_info *info, const struct roi_mesh *mesh);

/** mm³, never negative. */
double roi_tetrahedron_mm3(const double (*nodes)[3], const struct tetrahedron *tetrahedron);

/** Whether something of this value belongs to a region of this threshold, which it was perhaps written as. */
static inline bool roi_value_belongs(float value, double threshold)
{
    const float bound = (float)(threshold * (1 - TOLERANCE));
    return threshold > 0   ? value >= bound
           : threshold < 0 ? value <= bound
                           : value != 0 && value == value; /* NaN belongs to nothing */
}

static inline bool roi_has(const conus_roi *roi, size_t voxel)
{
    return roi_value_belongs(roi->volume.values[voxel], roi->volume.info.threshold);
}

/** The value of a voxel or tetrahedron. */
static inline float roi_value(const conus_roi *roi, size_t index)
{
    return roi->nodes ? roi->tetrahedra[index].value : roi->volume.values[index];
}

/** Its middle, world mm. */
void roi_middle(double out[3], const conus_roi *roi, size_t index);

#endif
