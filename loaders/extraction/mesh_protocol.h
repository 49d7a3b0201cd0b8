/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The protocol between conus and conus-mesh: a request in, a stream of meshes out. Included by C and C++. All numbers
 * are little-endian and without padding; f32 and f64 are IEEE 754.
 *
 * Request, all in one file:
 *
 *     char[8] "CONUSRQ1", u32 kind (enum mesh_request_kind), u32 count
 *     surfaces: u32 dim[3], u32 bytes of a voxel (2 or 4), u32 smoothing iterations, u32 0, f64 pass band,
 *               f64 reduction, f64 world_from_voxel[16] (column-major), u32 label[count],
 *               voxels: an unsigned number each, i fastest: 0 = none, k = the area of label[k - 1]
 *
 * Stream: char[8] "CONUSMS1", then frames of 32 bytes and what follows each:
 *
 *     u32 kind (enum mesh_frame_kind), u32 id, u32 space (enum mesh_space), u32 text bytes, u64 vertices,
 *     u64 triangles, then the text, f32[3 vertices] positions, u32[3 triangles] vertex indices
 *
 * A mesh's id is its label, in the order of the request; areas without voxels have no frame. Its space is RAS. A
 * failure has only text: what is wrong. The last frame is MESH_FRAME_END, its id the number of frames before it. */
#ifndef CONUS_LOADERS_EXTRACTION_MESH_PROTOCOL_H
#define CONUS_LOADERS_EXTRACTION_MESH_PROTOCOL_H

#include "atlas/surface/mesh_space.h"

#define MESH_REQUEST_MAGIC "CONUSRQ1"
#define MESH_STREAM_MAGIC "CONUSMS1"

enum { MESH_MAGIC_SIZE = 8, MESH_FRAME_HEADER_SIZE = 32, MESH_FRAME_TEXT_LIMIT = 4096 };

enum mesh_request_kind { MESH_REQUEST_SURFACES = 1 };

enum mesh_frame_kind { MESH_FRAME_MESH = 1, MESH_FRAME_FAILURE = 2, MESH_FRAME_END = 3 };

#endif
