/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses the MZ3 of Surf Ice and NiiVue, once it is unpacked: little-endian, a header of 16 bytes and what it skips,
 * faces, vertices, colours and values of vertices. */
#include "loaders/surfaces/foreign/foreign.h"

#include "base/job/job.h"

/* NAMES: the bytes that the header skips are a table of names for the values. */
enum { HEADER = 16, FACES = 1, VERTICES = 2, COLOURS = 4, VALUES = 8, WIDE_VALUES = 16, NAMES = 64 };
enum { KNOWN = FACES | VERTICES | COLOURS | VALUES | WIDE_VALUES | NAMES };

struct mz3 {
    uint32_t attributes, faces, vertices, skipped;
};

/* Values of vertices may be many for each, one layer after the other. */
static void check_header(struct job *job, const struct mz3 *mz3, size_t size)
{
    if (mz3->attributes & ~(uint32_t)KNOWN) {
        job_refuse(job, "header: attributes %u, known are the bits of %d", mz3->attributes, KNOWN);
    }
    if (!(mz3->attributes & FACES) || !(mz3->attributes & VERTICES)) {
        job_refuse(job, "header: an MZ3 file without %s, a surface is needed",
                   mz3->attributes & VERTICES ? "faces" : "vertices");
    }
    const uint64_t vertices = mz3->vertices;
    const uint64_t colours = mz3->attributes & COLOURS ? 4U : 0U;
    const uint64_t layer =
        vertices * ((mz3->attributes & VALUES ? 4U : 0U) + (mz3->attributes & WIDE_VALUES ? 8U : 0U));
    const uint64_t needed = HEADER + (uint64_t)mz3->skipped + 12 * (uint64_t)mz3->faces + (12 + colours) * vertices;
    if (size < needed + layer) {
        job_bad(job, "content: %zu bytes, %u faces and %u vertices need %llu", size, mz3->faces, mz3->vertices,
                (unsigned long long)(needed + layer));
    } else if (layer ? (size - needed) % layer : size - needed) {
        job_bad(job, "content: %llu bytes behind the last vertex's",
                (unsigned long long)(layer ? (size - needed) % layer : size - needed));
    }
}

void mz3_parse(struct mesh_sink *sink, struct text file)
{
    struct job *job = sink->job;
    struct reader r = reader_of(job, file);
    r.swapped = !BIG_ENDIAN_IS_SWAPPED;
    if (file.size < HEADER || !text_starts(file, "MZ")) {
        job_bad(job, "content: %zu bytes, an MZ3 file has a header of %d that begins with MZ", file.size, HEADER);
    }
    reader_skip(&r, 2);
    struct mz3 mz3 = {.attributes = reader_u16(&r)};
    mz3.faces = reader_u32(&r);
    mz3.vertices = reader_u32(&r);
    mz3.skipped = reader_u32(&r);
    check_header(job, &mz3, file.size);
    reader_skip(&r, mz3.skipped);
    struct reader faces = r; /* the vertices are behind them, and are needed first */
    reader_skip(&r, 12 * (uint64_t)mz3.faces);
    sink_expect(sink, mz3.vertices);
    const uint8_t *data;
    for (size_t i = 0; i < mz3.vertices && (data = reader_take(&r, 12)); i++) {
        const float position[3] = {order_f32(data, r.swapped), order_f32(data + 4, r.swapped),
                                   order_f32(data + 8, r.swapped)};
        sink_vertex(sink, position);
    }
    for (size_t i = 0; i < mz3.faces && (data = reader_take(&faces, 12)); i++) {
        for (size_t k = 0; k < 3; k++) {
            sink_corner(sink, order_i32(data + 4 * k, r.swapped));
        }
        sink_end(sink, CELL_POLYGON);
    }
}
