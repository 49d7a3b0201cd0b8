/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The parsers of this folder, and which one a file is for. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_H
#define CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_H

#include "loaders/surfaces/foreign/foreign_mesh.h"

enum foreign_format {
    FOREIGN_NONE,
    FOREIGN_OBJ,
    FOREIGN_PLY,
    FOREIGN_STL,
    FOREIGN_OFF,
    FOREIGN_MZ3,
    FOREIGN_VTK,
    FOREIGN_VTP
};

/** Whether @p path ends in @p ending, or in that and ".gz". */
bool foreign_is_named(const char *path, const char *ending);

/** The format of the file @p path, of which @p head has the first bytes, unpacked. The content decides where a format
 * has a signature, the name for STL, OBJ and OFF. */
enum foreign_format foreign_format_of(const char *path, struct text head);

/** The value behind "SPACE" in @p text: 3D Slicer writes "SPACE=RAS" or "SPACE=LPS". */
enum mesh_space foreign_space_in(struct text text);

/** The objects of an OBJ that have faces, in the order in which they come first. */
struct obj_objects {
    struct text *names; /**< [count] Inside the file's bytes; "" for what is in none. Owned. */
    uint32_t *owners;   /**< [triangle_count] The object of each triangle; owned.             */
    size_t count;
};

void obj_objects_finish(struct obj_objects *objects);

/* Each parser takes the whole file, unpacked, and fills @p out, which is empty and the caller's to finish, also after a
 * failure. CONUS_ERROR_DATA for what contradicts itself or is cut off, CONUS_ERROR_UNSUPPORTED for what is fine but not
 * read. All vertices come in the file's order, triangles in that of the faces; positions as stored. */

/** Wavefront OBJ. @p objects may be NULL; statements "o" of the same name are one object. */
conus_status obj_parse(struct foreign_mesh *out, struct obj_objects *objects, const uint8_t *data, size_t size);

/** PLY, ASCII or binary of either byte order. */
conus_status ply_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** STL, ASCII or binary. Corners at equal positions are one vertex, the first of them. */
conus_status stl_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** OFF, COFF, NOFF, STOFF and their mixtures, as text. */
conus_status off_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** MZ3 (Surf Ice, NiiVue), unpacked. */
conus_status mz3_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** Legacy VTK, POLYDATA, to version 5.1. */
conus_status vtk_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** VTP. An array may have @p limit bytes, unpacked. */
conus_status vtp_parse(struct foreign_mesh *out, const uint8_t *data, size_t size, uint64_t limit);

#endif
