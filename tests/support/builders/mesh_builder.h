/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Streams as conus-mesh writes them, made by hand. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_MESH_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_MESH_BUILDER_H

#include "base/memory.h"
#include "loaders/extraction/mesh_protocol.h"

#include <stdint.h>

struct built_frame {
    uint32_t kind, id, space;
    const char *text; /**< NULL = none. */
    uint64_t vertices, triangles;
};

/** Appends a frame's header and text; bytes of text are not escaped. */
void build_header(struct buffer *out, struct built_frame frame);

/** Appends the frame of a tetrahedron with the corners (0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size). */
void build_tetrahedron(struct buffer *out, uint32_t id, uint32_t space, float size);

/** Appends the beginning of a stream, and its end behind @p count frames. */
void build_start(struct buffer *out);
void build_end(struct buffer *out, uint32_t count);

#endif
