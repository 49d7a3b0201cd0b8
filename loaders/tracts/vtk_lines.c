/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes streamlines of the lines of VTK's files. */
#include "loaders/tracts/tract_formats.h"

#include "base/formats/packed.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/foreign.h"
#include "sources/source.h"

#include <stdio.h>
#include <string.h>

bool vtk_lines_are_in(const char *path)
{
    struct bytes bytes = {0};
    bool are = !gzip_read(&bytes, path, memory_limit(0)) && format_is_lines(&bytes);
    bytes_finish(&bytes);
    return are;
}

/* A sink that keeps lines, and counts polygons. */
struct line_build {
    struct mesh_sink sink; /* The first member. Its corners are those of all lines. */
    LIST(size_t) ends;     /* Of lines. */
    bool has_surface;
    uint64_t left; /* bytes of memory that may still be taken */
    bool in_order; /* corner k is vertex k, so that nothing need be gathered */
};

static void end_cell(struct mesh_sink *sink, enum cell cell)
{
    struct line_build *build = (struct line_build *)sink;
    const size_t count = sink->corners.count - sink->first;
    if (cell == CELL_LINE) {
        *LIST_ADD(sink->job, &build->ends) = sink->corners.count;
        sink->first = sink->corners.count;
    } else {
        build->has_surface |= (cell == CELL_POLYGON && count > 0) || (cell == CELL_STRIP && count > 2);
        sink->corners.count = sink->first;
    }
}

/* Gives numbers of vertices away as numbers of the corners of lines. */
static float *give_numbers(struct line_build *build, float *values, size_t components)
{
    struct job *job = build->sink.job;
    const size_t count = build->sink.corners.count;
    const uint32_t *corners = build->sink.corners.at;
    size_t numbers = 0;
    size_t size = 0;
    if (build->in_order) {
        return job_give(job, values, count * components * sizeof *values);
    }
    if (!memory_multiply(count, components, &numbers) || !memory_multiply(numbers, sizeof *values, &size) ||
        size > build->left) {
        job_fail(job, CONUS_ERROR_MEMORY, "streamlines: %zu times %zu numbers take more than is allowed (--max-memory)",
                 count, components);
        return NULL;
    }
    build->left -= size;
    float *out = job_raw(job, numbers, sizeof *out);
    for (size_t k = 0; out && k < count; k++) {
        memcpy(&out[k * components], &values[corners[k] * components], components * sizeof *values);
    }
    return job_give(job, out, size);
}

static void give_scalar(struct tractogram *out, struct line_build *build, struct sink_array *array)
{
    struct job *job = build->sink.job;
    const size_t things = array->per_point ? build->sink.vertices.count : build->ends.count;
    if (array->count / array->components != things) {
        job_bad(job, "%s: %zu numbers, %zu times %u are needed", array->name, array->count, things, array->components);
        return;
    }
    struct tract_scalar *scalar = &out->scalars[out->scalar_count++];
    *scalar = (struct tract_scalar){NULL, array->per_point, array->components, NULL};
    scalar->values = array->per_point ? give_numbers(build, array->values, array->components)
                                      : job_give(job, array->values, array->count * sizeof *array->values);
    scalar->name = job_give(job, array->name, strlen(array->name) + 1);
}

static void give_lines(struct tractogram *out, struct line_build *build)
{
    struct job *job = build->sink.job;
    const size_t corners = build->sink.corners.count;
    const size_t lines = build->ends.count;
    build->in_order = corners == build->sink.vertices.count;
    for (size_t k = 0; build->in_order && k < corners; k++) {
        build->in_order = build->sink.corners.at[k] == k;
    }
    if (!lines && build->has_surface) {
        job_bad(job, "a surface and no lines, streamlines are needed");
    }
    out->points = give_numbers(build, corners ? build->sink.vertices.at->at : NULL, 3);
    out->first = job_step(job) ? memory_zeroed(lines + 1, sizeof *out->first) : NULL;
    out->scalars = job_step(job) ? memory_zeroed(build->sink.arrays.count, sizeof *out->scalars) : NULL;
    if (!job_need(job, out->first) || !job_need(job, out->scalars)) {
        return;
    }
    out->point_count = corners;
    out->space = (unsigned char)build->sink.space;
    for (size_t i = 0; i < lines; i++) {
        out->first[i + 1] = build->ends.at[i];
    }
    out->streamline_count = lines;
    for (size_t i = 0; i < build->sink.arrays.count && job_ok(job); i++) {
        give_scalar(out, build, &build->sink.arrays.at[i]);
    }
    const size_t polygons = build->sink.cells[CELL_POLYGON] + build->sink.cells[CELL_STRIP];
    if (polygons) {
        job_note(job, "%zu polygons are not read", polygons);
    }
}

void vtk_lines_read(struct job *job, struct source *source, struct tract_build *build)
{
    const struct bytes bytes = source_whole(job, source);
    const struct format *format = format_find(&source->head, ROLE_TRACTS);
    const bool is_legacy = format && format->id == FORMAT_VTK;
    struct line_build lines = {
        .sink = {.job = job, .end = end_cell, .takes_lines = true, .max_memory = build->max_memory},
        .left = build->max_memory};
    (is_legacy ? vtk_parse : vtp_parse)(&lines.sink, (struct text){(const char *)bytes.data, bytes.size});
    give_lines(&build->tractogram, &lines);
    snprintf(build->tractogram.format, sizeof build->tractogram.format, is_legacy ? "VTK" : "VTP");
}
