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
    const uint8_t *positions; /**< 12 bytes per vertex, unaligned. */
    const uint8_t *triangles; /**< 12 bytes per triangle, unaligned. */
    size_t size;              /**< Bytes of the whole frame. */
};

/** Gets the frames of a stream, the last one (MESH_FRAME_END) not among them. */
typedef conus_status (*mesh_frame_take)(void *user, const struct mesh_frame *frame);

/** A stream that comes piece by piece; zero at first but for the two. */
struct mesh_frames {
    mesh_frame_take take;
    void *user;
    bool begun, ended; /**< Its magic bytes, and the frame that counts the others, have come. */
    uint32_t count;
};

/** A child_take whose user is a struct mesh_frames. Ends early when `take` fails. */
conus_status mesh_frames_take(void *user, size_t *used, size_t *wanted, const uint8_t *data, size_t size);

/** A copy of the mesh in a frame, not yet checked (mesh_check()). */
conus_status mesh_from_frame(struct mesh *out, const struct mesh_frame *frame);

/** Appends a number as requests hold it. */
void mesh_append_u32(struct buffer *out, uint32_t value);

#endif
