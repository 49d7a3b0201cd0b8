/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses STL, text and binary, and joins the corners that are at one place. */
#include "loaders/surfaces/foreign/foreign.h"

#include "atlas/surface/mesh.h"
#include "loaders/surfaces/foreign/parts.h"

enum { HEADER = 80, COUNT = 4, TRIANGLE = 50, NORMAL = 12 };

/* The corners of all triangles. */
struct stl {
    struct scan scan;
    LIST(struct mesh_point) corners;
};

static void read_binary(struct stl *stl)
{
    struct reader *r = &stl->scan.r;
    const size_t size = scan_left(&stl->scan);
    if (size < HEADER + COUNT) {
        job_bad(r->job, "content: %zu bytes, a binary STL file has %d or more", size, HEADER + COUNT);
    }
    r->swapped = !BIG_ENDIAN_IS_SWAPPED;
    reader_skip(r, HEADER);
    const uint32_t count = reader_u32(r);
    const uint64_t needed = HEADER + COUNT + TRIANGLE * (uint64_t)count;
    if (size != needed) {
        job_bad(r->job, "content: %zu bytes, a binary STL file of %u triangles has %llu", size, count,
                (unsigned long long)needed);
        return;
    }
    stl->corners.capacity = 3 * (size_t)count;
    stl->corners.at = job_array(r->job, &stl->corners.capacity, sizeof *stl->corners.at);
    const uint8_t *data;
    while (stl->corners.count < stl->corners.capacity && (data = reader_take(r, TRIANGLE))) {
        for (size_t k = 0; k < 9; k++) {
            stl->corners.at[stl->corners.count + k / 3].at[k % 3] =
                order_f32(data + NORMAL + sizeof(float) * k, r->swapped);
        }
        stl->corners.count += 3;
    }
}

static void read_facet(struct stl *stl)
{
    struct scan *scan = &stl->scan;
    scan_need(scan, "normal", "normal");
    for (int a = 0; a < 3; a++) { /* it is not used: "nan" is a number, too */
        (void)scan_any_float(scan, "a normal of three numbers");
    }
    scan_need(scan, "outer", "outer");
    scan_need(scan, "loop", "loop");
    for (int k = 0; k < 3; k++) {
        struct mesh_point *corner = LIST_ADD(scan->r.job, &stl->corners);
        scan_need(scan, "vertex", "vertex");
        for (int a = 0; a < 3; a++) {
            corner->at[a] = scan_float(scan, "a vertex of three numbers");
        }
    }
    scan_need(scan, "endloop", "endloop");
    scan_need(scan, "endfacet", "endfacet");
}

static void read_solid(struct stl *stl)
{
    struct text name;
    scan_need(&stl->scan, "solid", "solid");
    (void)scan_line(&stl->scan, &name);
    while (scan_take(&stl->scan, "facet")) {
        read_facet(stl);
    }
    scan_need(&stl->scan, "endsolid", "facet or endsolid");
    (void)scan_line(&stl->scan, &name);
}

/* Corners at one place are one vertex, three in a row a triangle. */
static void give_triangles(struct mesh_sink *sink, const struct stl *stl)
{
    const size_t count = stl->corners.count;
    const struct mesh all = {.positions = count ? stl->corners.at->at : NULL, .vertex_count = count};
    if (count > UINT32_MAX) {
        job_bad(sink->job, "%zu corners, allowed are up to 4294967295", count);
    }
    uint32_t *numbers = job_raw(sink->job, count, sizeof *numbers);
    if (!numbers || !JOB_CALL(sink->job, mesh_find_first(numbers, &all))) {
        return;
    }
    for (size_t v = 0; v < count; v++) { /* of the first ones at their places, then of others */
        if (numbers[v] == v) {
            numbers[v] = (uint32_t)sink->vertices.count;
            sink_vertex(sink, stl->corners.at[v].at);
        } else {
            numbers[v] = numbers[numbers[v]];
        }
    }
    for (size_t v = 0; v < count && job_ok(sink->job); v++) {
        sink_corner(sink, numbers[v]);
        if (v % 3 == 2) {
            sink_end(sink, CELL_POLYGON);
        }
    }
}

void stl_parse(struct mesh_sink *sink, struct text file)
{
    struct stl stl = {.scan = scan_of(sink->job, file)};
    struct text header = {file.data, file.size < HEADER ? file.size : HEADER};
    struct text line = {0};
    struct text word;
    if (text_line(&header, &line)) {
        sink_said(sink, line);
    }
    /* Text begins with "solid". So may the header of a binary file, which has a 0 somewhere. */
    if (!text_starts(text_trim(file), "solid") || memchr(file.data, '\0', file.size)) {
        read_binary(&stl);
    } else {
        do {
            read_solid(&stl);
        } while (scan_peek(&stl.scan, &word));
    }
    give_triangles(sink, &stl);
}
