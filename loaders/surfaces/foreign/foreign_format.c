/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds out a mesh file's format, and the space that it states. */
#include "loaders/surfaces/foreign/foreign.h"

#include "base/files/folder.h"
#include "loaders/surfaces/foreign/mesh_foreign.h"

#include <stdio.h>
#include <string.h>

bool foreign_is_named(const char *path, const char *ending)
{
    char packed[16];
    snprintf(packed, sizeof packed, "%s.gz", ending);
    return path_ends_in(path, ending) || path_ends_in(path, packed);
}

enum foreign_format foreign_format_of(const char *path, struct text head)
{
    if (text_starts(head, "# vtk DataFile")) {
        return FOREIGN_VTK;
    }
    if (text_starts(head, "ply\n") || text_starts(head, "ply\r")) {
        return FOREIGN_PLY;
    }
    if (text_starts(head, "MZ") && !foreign_is_named(path, ".obj") && !foreign_is_named(path, ".stl")) {
        return FOREIGN_MZ3;
    }
    if (text_starts(text_trim(text_from_bytes((const uint8_t *)head.data, head.size)), "<") &&
        text_mentions(head, "<VTKFile")) {
        return FOREIGN_VTP;
    }
    return foreign_is_named(path, ".stl")   ? FOREIGN_STL
           : foreign_is_named(path, ".off") ? FOREIGN_OFF
           : foreign_is_named(path, ".obj") ? FOREIGN_OBJ
                                            : FOREIGN_NONE;
}

enum mesh_space foreign_space_in(struct text text)
{
    static const char word[] = "SPACE";
    enum { LENGTH = sizeof word - 1 };
    while (text_mentions(text, word)) {
        const char *at = memmem(text.data, text.size, word, LENGTH);
        text.size -= (size_t)(at + LENGTH - text.data);
        text.data = at + LENGTH;
        struct text value = text;
        while (value.size && strchr("= \t", *value.data) && *value.data) {
            value = (struct text){value.data + 1, value.size - 1};
        }
        if (value.size < text.size && text_starts(value, "RAS")) {
            return MESH_SPACE_RAS;
        }
        if (value.size < text.size && text_starts(value, "LPS")) {
            return MESH_SPACE_LPS;
        }
    }
    return MESH_SPACE_UNSTATED;
}
