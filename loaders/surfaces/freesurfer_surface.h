/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * FreeSurfer's surfaces (lh.pial), big-endian. docs/formats.md lists the fields, docs/spaces.md says how their
 * coordinates get into the world. */
#ifndef CONUS_LOADERS_SURFACES_FREESURFER_SURFACE_H
#define CONUS_LOADERS_SURFACES_FREESURFER_SURFACE_H

#include "atlas/surface/mesh.h"
#include "base/job/reader.h"

/** Reads a surface of triangles into world mm, not yet checked by mesh_check(). @p out, empty, is the caller's to
 * finish, also after a failure. @p as_stored: coordinates are taken as they are. Surfaces of quadrangles are
 * CONUS_ERROR_UNSUPPORTED. */
void freesurfer_surface_read(struct reader *r, struct mesh *out, bool as_stored);

/** world_from_surface for the volume with the axes' world directions @p axes (i, j, k, one after the other) and
 * c_ras @p centre: Norig inv(Torig), in which the volume's size cancels out. False (out untouched) where the axes are
 * no rotation, with or without a mirror. */
bool freesurfer_world_from_surface(double out[16], const double axes[9], const double centre[3]);

#endif
