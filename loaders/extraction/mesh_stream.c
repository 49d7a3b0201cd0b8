/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses the frames that conus-mesh writes. */
#include "loaders/extraction/parts.h"

#include "base/byte_order.h"
#include "base/memory.h"

enum { SWAPPED = !BIG_ENDIAN_IS_SWAPPED, CORNER_SIZE = 12 };

static conus_status check_magic(const uint8_t *data, size_t size)
{
    if (size < MESH_MAGIC_SIZE || memcmp(data, MESH_STREAM_MAGIC, MESH_MAGIC_SIZE) != 0) {
        return fail(CONUS_ERROR_DATA, "mesh stream: it does not begin with " MESH_STREAM_MAGIC);
    }
    return CONUS_OK;
}

/* Reads the header of a frame, MESH_FRAME_HEADER_SIZE bytes: all but the pointers. */
static conus_status parse_header(struct mesh_frame *out, const uint8_t *data)
{
    uint64_t vertices = order_u64(data + 16, SWAPPED);
    uint64_t triangles = order_u64(data + 24, SWAPPED);
    struct mesh_frame frame = {.kind = (enum mesh_frame_kind)order_u32(data, SWAPPED),
                               .id = order_u32(data + 4, SWAPPED),
                               .space = (enum mesh_space)order_u32(data + 8, SWAPPED),
                               .text = {.size = order_u32(data + 12, SWAPPED)}};
    bool is_mesh = frame.kind == MESH_FRAME_MESH;
    if (frame.kind < MESH_FRAME_MESH || frame.kind > MESH_FRAME_END) {
        return fail(CONUS_ERROR_DATA, "mesh stream: frame of kind %d, allowed are 1 to 3", (int)frame.kind);
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

/* How many bytes from the start of `data` make the next whole thing, as far as that is known yet. */
static conus_status find_wanted(size_t *wanted, const struct mesh_frames *frames, const uint8_t *data, size_t size)
{
    struct mesh_frame frame;
    *wanted = frames->begun ? MESH_FRAME_HEADER_SIZE : MESH_MAGIC_SIZE;
    if (!frames->begun || size < *wanted) {
        return CONUS_OK;
    }
    conus_status status = parse_header(&frame, data);
    *wanted = status ? *wanted : frame.size;
    return status;
}

/* Gives the whole frame at `data` on. */
static conus_status take_frame(struct mesh_frames *frames, const uint8_t *data)
{
    struct mesh_frame frame;
    conus_status status = parse_header(&frame, data);
    if (status) {
        return status;
    }
    frame.text.data = (const char *)data + MESH_FRAME_HEADER_SIZE;
    frame.positions = data + MESH_FRAME_HEADER_SIZE + frame.text.size;
    frame.triangles = frame.positions + CORNER_SIZE * frame.vertex_count;
    if (frames->ended || (frame.kind == MESH_FRAME_END && frame.id != frames->count)) {
        return fail(CONUS_ERROR_DATA, "mesh stream: its end does not match its frames");
    }
    frames->ended = frame.kind == MESH_FRAME_END;
    frames->count++;
    return frames->ended ? CONUS_OK : frames->take(frames->user, &frame);
}

conus_status mesh_frames_take(void *user, size_t *used, size_t *wanted, const uint8_t *data, size_t size)
{
    struct mesh_frames *frames = user;
    conus_status status;
    while (!(status = find_wanted(wanted, frames, data + *used, size - *used)) && size - *used >= *wanted) {
        status = frames->begun ? take_frame(frames, data + *used) : check_magic(data + *used, size - *used);
        if (status) {
            return status;
        }
        frames->begun = true;
        *used += *wanted;
    }
    return status;
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

void mesh_append_u32(struct buffer *out, uint32_t value)
{
    uint8_t bytes[4];
    order_put(bytes, value, sizeof bytes);
    buffer_append(out, bytes, sizeof bytes);
}
