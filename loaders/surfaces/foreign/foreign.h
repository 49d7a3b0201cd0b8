/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The parsers of mesh files of other programs. Each takes the whole file, unpacked, which must outlive the sink, and
 * is a primitive of the sink's job. CONUS_ERROR_DATA for a file that contradicts itself or is cut off,
 * CONUS_ERROR_UNSUPPORTED for a valid one that is not read. All vertices come in the file's order, then cells in
 * theirs; positions as stored. What was passed over is noted. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_H
#define CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_H

#include "loaders/surfaces/foreign/mesh_sink.h"

typedef void mesh_parser(struct mesh_sink *sink, struct text file);

/** Wavefront OBJ, with its objects. */
mesh_parser obj_parse;

/** PLY, ASCII or binary of either byte order. */
mesh_parser ply_parse;

/** STL, ASCII or binary. Corners at equal positions are one vertex, the first of them. */
mesh_parser stl_parse;

/** OFF, COFF, NOFF, STOFF and their mixtures, as text. */
mesh_parser off_parse;

/** MZ3 (Surf Ice, NiiVue), unpacked. */
mesh_parser mz3_parse;

/** Legacy VTK, POLYDATA, to version 5.1. */
mesh_parser vtk_parse;

/** VTP. An array may have the job's max_memory bytes, unpacked. */
mesh_parser vtp_parse;

#endif
