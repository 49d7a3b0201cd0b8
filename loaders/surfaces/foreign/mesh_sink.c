/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects vertices, corners and arrays. */
#include "loaders/surfaces/foreign/foreign.h"

#include <string.h>

void sink_expect(struct mesh_sink *sink, size_t count)
{
    if (count > UINT32_MAX) {
        job_bad(sink->job, "%zu vertices, allowed are up to 4294967295", count);
    }
    if (count > sink->vertices.capacity) {
        const size_t twice = 2 * sink->vertices.capacity;
        const size_t doubled = twice < UINT32_MAX ? twice : UINT32_MAX;
        const size_t wanted = count > doubled ? count : doubled;
        struct mesh_point *larger = job_grow(sink->job, sink->vertices.at, wanted, sizeof *larger);
        sink->vertices.at = larger ? larger : sink->vertices.at;
        sink->vertices.capacity = larger ? wanted : sink->vertices.capacity;
    }
}

void sink_vertex_more(struct mesh_sink *sink, const float position[3])
{
    if (sink->vertices.count == sink->vertices.capacity || sink->vertices.count == UINT32_MAX) {
        sink_expect(sink, sink->vertices.count + 1);
    }
    if (job_step(sink->job)) {
        memcpy(sink->vertices.at[sink->vertices.count++].at, position, sizeof sink->vertices.at->at);
    }
}

size_t sink_cell(const struct mesh_sink *sink)
{
    return sink->cells[CELL_LINE] + sink->cells[CELL_POLYGON] + sink->cells[CELL_STRIP];
}

void sink_corner_more(struct mesh_sink *sink, int64_t index)
{
    if (index < 0 || (uint64_t)index >= sink->vertices.count) {
        if (sink->vertices.count) {
            job_bad(sink->job, "%s %zu: vertex index %lld, allowed are 0 to %zu", sink_cell_word(sink), sink_cell(sink),
                    (long long)index, sink->vertices.count - 1);
        } else {
            job_bad(sink->job, "%s %zu: vertex index %lld, there are no vertices", sink_cell_word(sink),
                    sink_cell(sink), (long long)index);
        }
        return;
    }
    *LIST_ADD(sink->job, &sink->corners) = (uint32_t)index;
}

void sink_end(struct mesh_sink *sink, enum cell cell)
{
    if (job_step(sink->job)) {
        sink->end(sink, cell);
        sink->cells[cell]++;
    }
}

struct sink_array *sink_array(struct mesh_sink *sink, struct text name, bool per_point, uint64_t components)
{
    struct job *job = sink->job;
    struct sink_array *found = NULL;
    char *words = job_adopt(job, job_step(job) ? text_to_utf8(name) : NULL);
    if (!job_need(job, words)) {
        return NULL;
    }
    for (size_t i = 0; i < sink->arrays.count && !found; i++) {
        struct sink_array *array = &sink->arrays.at[i];
        found = array->per_point == per_point && strcmp(array->name, words) == 0 ? array : NULL;
    }
    if (components < 1 || components > SINK_COMPONENT_LIMIT || (found && found->components != components)) {
        job_bad(job, "%s: %llu numbers for each point or cell, allowed are 1 to %d, the same in all", words,
                (unsigned long long)components, SINK_COMPONENT_LIMIT);
    } else if (!found && sink->arrays.count >= SINK_ARRAY_LIMIT) {
        job_bad(job, "%s: allowed are up to %d arrays", words, SINK_ARRAY_LIMIT);
    } else if (!found) {
        found = LIST_ADD(job, &sink->arrays);
        *found = (struct sink_array){.name = words, .per_point = per_point, .components = (uint32_t)components};
    }
    return job_ok(job) ? found : NULL;
}

float *sink_array_grow(struct mesh_sink *sink, struct sink_array *array, size_t more)
{
    if (more > sink->max_memory / sizeof *array->values) {
        job_fail(sink->job, CONUS_ERROR_MEMORY, "%s: %zu numbers, allowed are %llu bytes more (--max-memory)",
                 array->name, more, (unsigned long long)sink->max_memory);
        return NULL;
    }
    sink->max_memory -= more * sizeof *array->values;
    if (array->count + more > array->capacity) {
        size_t wanted = array->count + more > 2 * array->capacity ? array->count + more : 2 * array->capacity;
        float *larger = job_grow(sink->job, array->values, wanted, sizeof *larger);
        if (!larger) {
            return NULL;
        }
        array->values = larger;
        array->capacity = wanted;
    }
    array->count += more;
    return array->values ? array->values + array->count - more : NULL; /* of none */
}

void sink_said(struct mesh_sink *sink, struct text text)
{
    struct text value;
    for (struct text rest = text; text_statement(&rest, "space/system/coordinates/orientation", false, &value);) {
        const enum mesh_space space = text_equal_ignoring_case(value, "RAS")   ? MESH_SPACE_RAS
                                      : text_equal_ignoring_case(value, "LPS") ? MESH_SPACE_LPS
                                                                               : MESH_SPACE_UNSTATED;
        if (space && sink->space && space != sink->space) {
            job_bad(sink->job, "\"%.*s\": RAS and LPS are both stated, one of them is needed", TEXT_SHOW(text, 60));
        }
        sink->space = space ? space : sink->space;
    }
    for (struct text rest = text; text_statement(&rest, "unit/units", true, &value);) {
        if (!text_is_one_of(value, TEXT_MM, false)) {
            job_bad(sink->job,
                    "\"%.*s\": the unit is stated as %.*s, and coordinates are read as mm: one of them is wrong",
                    TEXT_SHOW(text_trim(text), 60), TEXT_SHOW(value, 20));
        }
    }
}
