/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The narrowest round cone about an axis that holds some of an object (Eq. 13): of a voxel's the angle of its centre,
 * of a surface's or streamline's that of its nearest point to the axis, exact but for rounding. */
#ifndef CONUS_SELECTION_STUDY_ADMISSION_H
#define CONUS_SELECTION_STUDY_ADMISSION_H

#include "atlas/atlas.h"
#include "selection/region/region.h"

struct admission {
    double slope;    /**< Tangent of the half-angle; infinite where none has been found.               */
    double depth;    /**< Along the axis, mm, of what is admitted first; of several such, the nearest. */
    double point[3]; /**< And where it is, world.                                                      */
    bool is_surface; /**< It is a mesh's; else a voxel's centre or of a streamline.                    */
};

/** Lowers @p admissions[as[k]] for each object k of @p volume to what its voxels in @p region give. @p as may be NULL:
 * then each object is itself. */
void admission_of_volume(struct admission *admissions, const struct region *region, const struct volume *volume,
                         const uint32_t *as);

/** Lowers @p admission to what @p mesh gives, as far as it lies in the depths of @p region, a cone. @p closed: what is
 * inside belongs to it. */
void admission_of_mesh(struct admission *admission, const struct region *region, const struct mesh *mesh, bool closed);

/** The same of @p tractogram's streamlines, lines without a radius: those of @p group, or all if it is NULL. */
void admission_of_bundle(struct admission *admission, const struct region *region, const struct tractogram *tractogram,
                         const struct tract_group *group);

#endif
