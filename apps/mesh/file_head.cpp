// SPDX-License-Identifier: BSD-3-Clause
// Finds out a mesh file's format and what its header promises, before a reader allocates.
#include "file_head.hpp"

#include "failure.hpp"

#include <cctype>
#include <cstring>
#include <sstream>

namespace
{

bool starts(const std::string &text, const char *prefix)
{
    return text.compare(0, std::strlen(prefix), prefix) == 0;
}

std::string ending_of(const std::string &path)
{
    const size_t dot = path.rfind('.');
    std::string ending = dot == std::string::npos ? "" : path.substr(dot + 1);
    for (char &c : ending) {
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return ending;
}

/* The lines of the file in which 3D Slicer states the space. */
std::string remarks_of(Format format, const std::string &head)
{
    std::istringstream lines(head);
    std::string remarks;
    std::string line;
    for (int n = 1; std::getline(lines, line); n++) {
        const bool ply_end = format == Format::Ply && starts(line, "end_header");
        if (ply_end || (format == Format::Vtk && n > 2) || (format == Format::Stl && n > 1)) {
            break;
        }
        if ((format == Format::Vtk && n == 2) || (format == Format::Ply && starts(line, "comment")) ||
            (format == Format::Obj && starts(line, "#")) || format == Format::Stl) {
            remarks += line.substr(0, format == Format::Stl ? 80 : std::string::npos) + "\n";
        }
    }
    return remarks;
}

} // namespace

Format format_of(const std::string &path, const std::string &head)
{
    const std::string ending = ending_of(path);
    if (head.empty()) {
        throw Failure("content: the file is empty");
    }
    if (starts(head, "\xff\xff\xfe")) {
        throw Failure("content: a FreeSurfer surface, which VTK does not read, whatever its name ends in");
    }
    if (starts(head, "# vtk DataFile")) {
        return Format::Vtk;
    }
    if (starts(head, "ply\n") || starts(head, "ply\r")) {
        return Format::Ply;
    }
    if (head.find("<VTKFile") != std::string::npos) {
        return Format::Vtp;
    }
    if (ending == "stl") {
        return Format::Stl;
    }
    if (ending != "obj") {
        throw Failure("content: neither VTK, VTP, PLY nor, by its name, STL or OBJ");
    }
    if (head.size() > 1 && std::strchr("PpLlMmFfXxQqTtBb", head[0]) && head[1] == ' ' && !starts(head, "f ") &&
        !starts(head, "l ") && !starts(head, "p ")) {
        throw Failure("content: an MNI object file, not Wavefront's OBJ");
    }
    return Format::Obj;
}

void check_stl_size(const std::string &head, uint64_t size)
{
    enum { HEADER = 84, TRIANGLE = 50 };
    const size_t first = head.find_first_not_of(" \t\r\n");
    const bool is_text = first != std::string::npos && head.compare(first, 5, "solid") == 0 &&
                         head.find('\0') == std::string::npos; /* VTK says where that ends too early */
    uint32_t count = 0;
    if (head.size() >= HEADER) {
        std::memcpy(&count, head.data() + HEADER - sizeof count, sizeof count);
    }
    if (!is_text && size != HEADER + TRIANGLE * static_cast<uint64_t>(count)) {
        throw Failure("content: " + std::to_string(size) + " bytes, a binary STL file of " + std::to_string(count) +
                      " triangles has " + std::to_string(HEADER + TRIANGLE * static_cast<uint64_t>(count)));
    }
}

void check_ply_counts(const std::string &head, uint64_t size)
{
    std::istringstream lines(head);
    for (std::string line; std::getline(lines, line) && !starts(line, "end_header");) {
        std::istringstream words(line);
        std::string word, name;
        uint64_t count = 0;
        if (!(words >> word) || word != "element") {
            continue;
        }
        if (!(words >> name >> count)) {
            throw Failure("header: \"" + line.substr(0, 60) + "\", an element has a name and a count");
        }
        if (count > size) {
            throw Failure("header: " + line.substr(0, 60) + ": more than the " + std::to_string(size) +
                          " bytes of the file can hold");
        }
    }
}

mesh_space space_in(const std::string &text)
{
    for (size_t at = 0; (at = text.find("SPACE", at)) != std::string::npos; at += 5) {
        const size_t value = text.find_first_not_of("= \t", at + 5);
        if (value == std::string::npos || value == at + 5) {
            continue;
        }
        if (text.compare(value, 3, "RAS") == 0) {
            return MESH_SPACE_RAS;
        }
        if (text.compare(value, 3, "LPS") == 0) {
            return MESH_SPACE_LPS;
        }
    }
    return MESH_SPACE_UNSTATED;
}

mesh_space stated_space(Format format, const std::string &head)
{
    return space_in(remarks_of(format, head));
}
