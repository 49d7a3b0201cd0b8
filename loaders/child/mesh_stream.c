/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses the frames that conus-mesh writes. */
#include "loaders/child/mesh_stream.h"

#include "base/byte_order.h"
#include "base/memory.h"

enum { SWAPPED = !BIG_ENDIAN_IS_SWAPPED, CORNER_SIZE = 12 };

conus_status mesh_stream_begin(const uint8_t *data, size_t size)
{
    if (size < MESH_MAGIC_SIZE || memcmp(data, MESH_STREAM_MAGIC, MESH_MAGIC_SIZE) != 0) {
        return fail(CONUS_ERROR_DATA, "mesh stream: it does not begin with " MESH_STREAM_MAGIC);
    }
    return CONUS_OK;
}

conus_status mesh_frame_header(struct mesh_frame *out, const uint8_t *data)
{
    uint64_t vertices = order_u64(data + 16, SWAPPED);
    uint64_t triangles = order_u64(data + 24, SWAPPED);
    struct mesh_frame frame = {.kind = (enum mesh_frame_kind)order_u32(data, SWAPPED),
                               .id = order_u32(data + 4, SWAPPED),
                               .space = (enum mesh_space)order_u32(data + 8, SWAPPED),
                               .text = {.size = order_u32(data + 12, SWAPPED)}};
    bool is_mesh = frame.kind == MESH_FRAME_MESH || frame.kind == MESH_FRAME_CHECKED;
    if (frame.kind < MESH_FRAME_MESH || frame.kind > MESH_FRAME_CHECKED) {
        return fail(CONUS_ERROR_DATA, "mesh stream: frame of kind %d, allowed are 1 to 4", (int)frame.kind);
    }
    if (frame.space > (is_mesh ? MESH_SPACE_LPS : MESH_SPACE_UNSTATED)) {
        return fail(CONUS_ERROR_DATA, "mesh stream: space %d in a frame of kind %d", (int)frame.space, (int)frame.kind);
    }
    if (frame.text.size > (frame.kind == MESH_FRAME_END ? 0 : MESH_FRAME_TEXT_LIMIT)) {
        return fail(CONUS_ERROR_DATA, "mesh stream: %zu bytes of text in a frame of kind %d", frame.text.size,
                    (int)frame.kind);
    }
    uint64_t most = is_mesh ? UINT32_MAX : 0;
    if (vertices > most || triangles > most) {
        return fail(CONUS_ERROR_DATA, "mesh stream: %llu vertices and %llu triangles, allowed are %llu of each",
                    (unsigned long long)vertices, (unsigned long long)triangles, (unsigned long long)most);
    }
    frame.vertex_count = (size_t)vertices;
    frame.triangle_count = (size_t)triangles;
    frame.size = MESH_FRAME_HEADER_SIZE + frame.text.size + CORNER_SIZE * (frame.vertex_count + frame.triangle_count);
    *out = frame;
    return CONUS_OK;
}

conus_status mesh_frame_parse(struct mesh_frame *out, const uint8_t *data, size_t size)
{
    struct mesh_frame frame;
    if (size < MESH_FRAME_HEADER_SIZE) {
        return fail(CONUS_ERROR_DATA, "mesh stream: cut off after %zu bytes of a frame's header", size);
    }
    conus_status status = mesh_frame_header(&frame, data);
    if (!status && size < frame.size) {
        status = fail(CONUS_ERROR_DATA, "mesh stream: cut off after %zu of a frame's %zu bytes", size, frame.size);
    }
    if (status) {
        return status;
    }
    const uint8_t *body = data + MESH_FRAME_HEADER_SIZE;
    frame.bytes = data;
    frame.text.data = (const char *)body;
    frame.positions = body + frame.text.size;
    frame.triangles = frame.positions + CORNER_SIZE * frame.vertex_count;
    *out = frame;
    return CONUS_OK;
}

conus_status mesh_from_frame(struct mesh *out, const struct mesh_frame *frame)
{
    conus_status status = mesh_init(out, frame->vertex_count, frame->triangle_count);
    if (status) {
        return status;
    }
    for (size_t i = 0; i < 3 * frame->vertex_count; i++) {
        out->positions[i] = order_f32(frame->positions + 4 * i, SWAPPED);
    }
    for (size_t i = 0; i < 3 * frame->triangle_count; i++) {
        out->triangles[i] = order_u32(frame->triangles + 4 * i, SWAPPED);
    }
    return CONUS_OK;
}

conus_status mesh_take_frame(struct mesh *out, const struct mesh_frame *frame, const char *path, struct notes *notes,
                             struct buffer *stream)
{
    struct mesh mesh;
    size_t note_count = notes->count;
    conus_status status = mesh_from_frame(&mesh, frame);
    if (status) {
        return status;
    }
    mesh.path = memory_text(path, strlen(path));
    status = mesh.path ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        mesh.shape.closed = frame->kind == MESH_FRAME_CHECKED;
        status = mesh.shape.closed ? mesh_check_numbers(&mesh) : mesh_check(&mesh, notes);
    }
    if (status) {
        mesh_finish(&mesh);
        return status;
    }
    if (stream) {
        bool clean = notes->count == note_count; /* whole and closed: need not be checked again */
        uint8_t kind = clean ? MESH_FRAME_CHECKED : (uint8_t)frame->kind;
        buffer_append(stream, &kind, 1);
        buffer_append(stream, frame->bytes + 1, frame->size - 1);
    }
    *out = mesh;
    return CONUS_OK;
}

void mesh_stream_start(struct buffer *out)
{
    buffer_append(out, MESH_STREAM_MAGIC, MESH_MAGIC_SIZE);
}

void mesh_append_u32(struct buffer *out, uint32_t value)
{
    uint8_t bytes[4];
    order_put(bytes, value, sizeof bytes);
    buffer_append(out, bytes, sizeof bytes);
}

void mesh_stream_end(struct buffer *out, uint32_t count)
{
    static const uint8_t rest[MESH_FRAME_HEADER_SIZE - 8] = {0};
    mesh_append_u32(out, MESH_FRAME_END);
    mesh_append_u32(out, count);
    buffer_append(out, rest, sizeof rest);
}

conus_status mesh_stream_read(const uint8_t *data, size_t size, mesh_frame_take take, void *user)
{
    uint32_t count = 0;
    conus_status status = mesh_stream_begin(data, size);
    for (size_t at = MESH_MAGIC_SIZE; !status; count++) {
        struct mesh_frame frame;
        status = mesh_frame_parse(&frame, data + at, size - at);
        at += status ? 0 : frame.size;
        if (!status && frame.kind == MESH_FRAME_END) {
            bool whole = frame.id == count && at == size;
            return whole ? CONUS_OK : fail(CONUS_ERROR_DATA, "mesh stream: its end does not match its frames");
        }
        status = status ? status : take(user, &frame);
    }
    return status;
}
