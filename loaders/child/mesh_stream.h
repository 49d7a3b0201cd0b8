/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The stream of meshes that conus-mesh writes (loaders/child/mesh_protocol.h), read strictly. */
#ifndef CONUS_LOADERS_CHILD_MESH_STREAM_H
#define CONUS_LOADERS_CHILD_MESH_STREAM_H

#include "atlas/surface/mesh.h"
#include "base/buffer.h"
#include "base/text.h"
#include "loaders/child/mesh_protocol.h"

/** One frame inside bytes that someone else owns. */
struct mesh_frame {
    enum mesh_frame_kind kind;
    uint32_t id;
    enum mesh_space space;
    struct text text;
    size_t vertex_count, triangle_count;
    const uint8_t *bytes;     /**< The whole frame. */
    const uint8_t *positions; /**< 12 bytes per vertex, unaligned. */
    const uint8_t *triangles; /**< 12 bytes per triangle, unaligned. */
    size_t size;              /**< Bytes of the whole frame. */
};

/** Refuses what does not begin with a stream's magic bytes. */
conus_status mesh_stream_begin(const uint8_t *data, size_t size);

/** Reads the header of a frame, MESH_FRAME_HEADER_SIZE bytes at @p data: all but the pointers. */
conus_status mesh_frame_header(struct mesh_frame *out, const uint8_t *data);

/** Reads the frame at @p data; CONUS_ERROR_DATA where it is cut off or damaged. */
conus_status mesh_frame_parse(struct mesh_frame *out, const uint8_t *data, size_t size);

/** A copy of the mesh in a frame, not yet checked (mesh_check()). */
conus_status mesh_from_frame(struct mesh *out, const struct mesh_frame *frame);

/** Makes a frame's mesh, checked (mesh_check(), which speaks of it as @p path), and appends the frame to @p stream if
 * that is not NULL. */
conus_status mesh_take_frame(struct mesh *out, const struct mesh_frame *frame, const char *path, struct notes *notes,
                             struct buffer *stream);

/** Appends a number as requests and streams hold it. */
void mesh_append_u32(struct buffer *out, uint32_t value);

/** Makes @p out the beginning of a stream, to which frames are then appended. */
void mesh_stream_start(struct buffer *out);
/** Appends the end of a stream of @p count frames. */
void mesh_stream_end(struct buffer *out, uint32_t count);

/** Gets the frames of a stream, the last one (MESH_FRAME_END) not among them. */
typedef conus_status (*mesh_frame_take)(void *user, const struct mesh_frame *frame);

/** Reads a whole stream: every frame, one end that counts them, nothing behind it. Ends early when @p take fails. */
conus_status mesh_stream_read(const uint8_t *data, size_t size, mesh_frame_take take, void *user);

#endif
