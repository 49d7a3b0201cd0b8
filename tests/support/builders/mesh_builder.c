/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds streams of conus-mesh. */
#include "builders/mesh_builder.h"

#include <stdint.h>
#include <string.h>

static void append_number(struct buffer *out, uint64_t value, int size)
{
    for (int i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(value >> 8 * i);
        buffer_append(out, &byte, 1);
    }
}

void build_header(struct buffer *out, struct built_frame frame)
{
    append_number(out, frame.kind, 4);
    append_number(out, frame.id, 4);
    append_number(out, frame.space, 4);
    append_number(out, frame.text ? strlen(frame.text) : 0, 4);
    append_number(out, frame.vertices, 8);
    append_number(out, frame.triangles, 8);
    buffer_text(out, frame.text ? frame.text : "");
}

void build_tetrahedron(struct buffer *out, uint32_t id, uint32_t space, float size)
{
    static const uint8_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    build_header(out, (struct built_frame){MESH_FRAME_MESH, id, space, NULL, 4, 4});
    for (int i = 0; i < 12; i++) {
        float value = i / 3 && i / 3 - 1 == i % 3 ? size : 0;
        uint32_t bits;
        memcpy(&bits, &value, sizeof bits);
        append_number(out, bits, 4);
    }
    for (int i = 0; i < 12; i++) {
        append_number(out, triangles[i], 4);
    }
}

void build_start(struct buffer *out)
{
    buffer_append(out, MESH_STREAM_MAGIC, MESH_MAGIC_SIZE);
}

void build_end(struct buffer *out, uint32_t count)
{
    build_header(out, (struct built_frame){.kind = MESH_FRAME_END, .id = count});
}
