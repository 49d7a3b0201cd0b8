/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The space of a surface's stored coordinates. */
#ifndef CONUS_ATLAS_SURFACE_MESH_SPACE_H
#define CONUS_ATLAS_SURFACE_MESH_SPACE_H

/** How a user states it, for notes that one was assumed. */
#define MESH_SPACE_WAY "; ',space=lps' behind FILE says LPS, as AFNI writes it, ',space=IMAGE' the mm of FSL's IMAGE"

/** The space of a mesh file, as the file says (3D Slicer's "SPACE=RAS" or "SPACE=LPS") or the user. */
enum mesh_space { MESH_SPACE_UNSTATED = 0, MESH_SPACE_RAS = 1, MESH_SPACE_LPS = 2 };

#endif
