// SPDX-License-Identifier: BSD-3-Clause
/** @file What the first bytes of a mesh file say, before VTK reads it. Without VTK. */
#ifndef CONUS_MESH_FILE_HEAD_HPP
#define CONUS_MESH_FILE_HEAD_HPP

#include "loaders/child/mesh_protocol.h"

#include <cstdint>
#include <string>

enum class Format { Vtk, Vtp, Ply, Stl, Obj };

/** The content decides where a format has a signature, the name for STL and OBJ. Throws Failure where neither tells. */
Format format_of(const std::string &path, const std::string &head);

/** VTK's STL reader takes of a binary file what is there, whatever its count says: throws Failure unless a file of
 * @p size bytes has as many triangles as it says. */
void check_stl_size(const std::string &head, uint64_t size);

/** VTK's PLY reader believes the counts, and a loop over 2e9 vertices that are not there takes minutes: throws Failure
 * where a file of @p size bytes cannot have so many. */
void check_ply_counts(const std::string &head, uint64_t size);

/** The value behind "SPACE" in @p text. */
mesh_space space_in(const std::string &text);

/** The same of the lines in which 3D Slicer states the space; a VTP file has a field instead. */
mesh_space stated_space(Format format, const std::string &head);

#endif
