/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A mesh as the bytes of a file: GIFTI, VTP, OBJ, PLY, STL (docs/formats.md). All state that they are in RAS. */
#ifndef CONUS_LOADERS_SURFACES_MESH_FORMAT_H
#define CONUS_LOADERS_SURFACES_MESH_FORMAT_H

#include "atlas/surface/mesh.h"
#include "base/buffer.h"
#include "conus/own.h"

/** Facts about a mesh that its file states. */
struct mesh_title {
    uint32_t label;
    const char *name; /**< UTF-8. */
    uint8_t rgb[3];
    const char *space; /**< A NIFTI_XFORM_ word, for GIFTI. */
};

/** A format's ending, without the dot; NULL for none that there is. */
const char *mesh_format_ending(conus_mesh_format format);

/** Appends the file of @p mesh, checked by mesh_check(). */
conus_status mesh_format(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title,
                         conus_mesh_format format);

/** Appends a pair of GIFTI's MetaData, escaped. */
void gifti_append_pair(struct buffer *out, const char *name, const char *value);

#endif
