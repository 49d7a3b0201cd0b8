/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses the MZ3 of Surf Ice and NiiVue, once it is unpacked: little-endian, a header of 16 bytes and what it skips,
 * faces, vertices, colours and values of vertices. */
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "base/byte_order.h"

/* NAMES: the bytes that the header skips are a table of names for the values. */
enum { HEADER = 16, FACES = 1, VERTICES = 2, COLOURS = 4, VALUES = 8, WIDE_VALUES = 16, NAMES = 64 };
enum { KNOWN = FACES | VERTICES | COLOURS | VALUES | WIDE_VALUES | NAMES };

struct mz3 {
    uint32_t attributes, faces, vertices, skipped;
};

static const bool swapped = !BIG_ENDIAN_IS_SWAPPED;

/* Values of vertices may be many for each, one layer after the other. */
static conus_status mz3_read_header(struct mz3 *out, const uint8_t *data, size_t size)
{
    if (size < HEADER || data[0] != 'M' || data[1] != 'Z') {
        return fail(CONUS_ERROR_DATA, "content: %zu bytes, an MZ3 file has a header of %d that begins with MZ", size,
                    HEADER);
    }
    *out = (struct mz3){order_u16(data + 2, swapped), order_u32(data + 4, swapped), order_u32(data + 8, swapped),
                        order_u32(data + 12, swapped)};
    if (out->attributes & ~(uint32_t)KNOWN) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: attributes %u, known are the bits of %d", out->attributes, KNOWN);
    }
    if (!(out->attributes & FACES) || !(out->attributes & VERTICES)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: an MZ3 file without %s, a surface is needed",
                    out->attributes & VERTICES ? "faces" : "vertices");
    }
    const uint64_t vertices = out->vertices;
    const uint64_t colours = out->attributes & COLOURS ? 4U : 0U;
    const uint64_t layer =
        vertices * ((out->attributes & VALUES ? 4U : 0U) + (out->attributes & WIDE_VALUES ? 8U : 0U));
    const uint64_t needed = HEADER + (uint64_t)out->skipped + 12 * (uint64_t)out->faces + (12 + colours) * vertices;
    if (size < needed + layer) {
        return fail(CONUS_ERROR_DATA, "content: %zu bytes, %u faces and %u vertices need %llu", size, out->faces,
                    out->vertices, (unsigned long long)(needed + layer));
    }
    if (layer ? (size - needed) % layer : size - needed) {
        return fail(CONUS_ERROR_DATA, "content: %llu bytes behind the last vertex's",
                    (unsigned long long)(layer ? (size - needed) % layer : size - needed));
    }
    return CONUS_OK;
}

conus_status mz3_parse(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    struct mz3 mz3 = {0};
    conus_status status = mz3_read_header(&mz3, data, size);
    if (status) {
        return status;
    }
    const uint8_t *faces = data + HEADER + mz3.skipped;
    const uint8_t *vertices = faces + 12 * (size_t)mz3.faces;
    status = foreign_reserve_vertices(out, mz3.vertices);
    for (size_t i = 0; !status && i < mz3.vertices; i++) {
        float position[3];
        for (size_t a = 0; a < 3; a++) {
            position[a] = order_f32(vertices + 12 * i + 4 * a, swapped);
        }
        status = foreign_add_vertex(out, position);
    }
    for (size_t i = 0; !status && i < mz3.faces; i++) {
        for (size_t k = 0; !status && k < 3; k++) {
            status = foreign_add_corner(out, order_i32(faces + 12 * i + 4 * k, swapped));
        }
        status = status ? status : foreign_end_polygon(out);
    }
    return status;
}
