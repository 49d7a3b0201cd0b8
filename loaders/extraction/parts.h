/* SPDX-License-Identifier: BSD-3-Clause */
/** @file conus-mesh as a child, and the stream that it writes. */
#ifndef CONUS_LOADERS_EXTRACTION_PARTS_H
#define CONUS_LOADERS_EXTRACTION_PARTS_H

#include "atlas/surface/mesh.h"
#include "base/child/child.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/extraction/mesh_protocol.h"

/* The stream of meshes that conus-mesh writes (loaders/extraction/mesh_protocol.h), read strictly. */

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

/* Runs conus-mesh, the program that links VTK, as a child (base/child/child.h). */

/** A request: @p head, then @p size bytes at @p voxels (NULL if there are none). */
struct mesh_child_request {
    struct buffer head;
    const void *voxels;
    size_t size;
};

/** The path of conus-mesh, as child_find() has it; the environment's variable is CONUS_MESH. */
conus_status mesh_child_find(char **path);

/** Runs conus-mesh on @p request and gives each frame that it writes to @p take at once, except the end. Fails with the
 * status of @p take, or with one line about how the program failed: a crash, too much memory or time, its message on
 * stderr, a damaged stream. Whatever it returns, no process is left. */
conus_status mesh_child_run(const struct mesh_child_request *request, const struct child_limits *limits,
                            mesh_frame_take take, void *user);

#endif
