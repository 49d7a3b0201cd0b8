// SPDX-License-Identifier: BSD-3-Clause
/** @file What is looked for in an OBJ file before VTK reads it. Without VTK. */
#ifndef CONUS_MESH_OBJ_FILE_HPP
#define CONUS_MESH_OBJ_FILE_HPP

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/** The objects that have faces, in the order in which they come first, and the object of each face. What is before the
 * first object, or in none with a name, is an object "". Objects that have the same name are one. */
struct Objects {
    std::vector<std::string> names;
    std::vector<uint32_t> of_face;
};

/** Throws Failure where the content is no text, or a vertex is not three numbers: VTK's reader takes 0 where it finds
 * none. */
Objects parse_obj(std::string_view content);

#endif
