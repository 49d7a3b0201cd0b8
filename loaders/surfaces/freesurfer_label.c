/* SPDX-License-Identifier: BSD-3-Clause */
/* "#!ascii label", a count, and so many lines "vertex x y z value". */
#include "loaders/surfaces/freesurfer_label.h"

#include "base/memory.h"

static const char magic[] = "#!ascii label";

enum { VERTEX_LIMIT = 1 << 24 }; /* more than any cortex has; each takes 4 bytes */

bool freesurfer_label_is(struct text text)
{
    return text_starts(text, magic);
}

/* The vertex that the next line names: a number that is followed by four. */
static conus_status next_vertex(uint64_t *out, struct text *rest, size_t line)
{
    struct text row;
    struct text word;
    double number = 0;
    size_t words = 0;
    bool good = text_line(rest, &row);
    bool has_vertex = good && text_word(&row, &word) && text_to_uint(word, VERTEX_LIMIT - 1, out);
    if (good && !has_vertex && text_to_double(word, &number) && number == -1) {
        return fail(CONUS_ERROR_DATA, "line %zu: vertex -1: this label is of voxels, not of a surface's vertices",
                    line);
    }
    while (has_vertex && text_word(&row, &word)) {
        good = good && text_to_double(word, &number);
        words++;
    }
    return has_vertex && good && words == 4
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "line %zu: a vertex, 0 to %d, and four numbers are needed", line,
                      VERTEX_LIMIT - 1);
}

static conus_status read_count(uint64_t *out, struct text *rest)
{
    struct text line = {0};
    bool good = text_line(rest, &line); /* what the file is */
    good = good && text_line(rest, &line) && text_to_uint(text_trim(line), VERTEX_LIMIT, out);
    return good && *out ? CONUS_OK
                        : fail(CONUS_ERROR_DATA, "line 2: the number of vertices, 1 to %d, is needed", VERTEX_LIMIT);
}

conus_status freesurfer_label_parse(uint32_t **labels, size_t *count, struct text text)
{
    struct text rest = text;
    struct text again;
    uint64_t rows = 0;
    uint64_t vertex = 0;
    uint64_t last = 0;
    conus_status status = read_count(&rows, &rest);
    again = rest;
    for (uint64_t i = 0; !status && i < rows; i++) {
        status = next_vertex(&vertex, &rest, (size_t)i + 3);
        last = vertex > last ? vertex : last;
    }
    if (!status && text_trim(rest).size) {
        status = fail(CONUS_ERROR_DATA, "line 2: %llu vertices, but more lines follow", (unsigned long long)rows);
    }
    uint32_t *out = status ? NULL : memory_zeroed((size_t)last + 1, sizeof *out);
    if (!out) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    for (uint64_t i = 0; !status && i < rows; i++) {
        status = next_vertex(&vertex, &again, 0);
        out[vertex] = 1;
    }
    *labels = out;
    *count = (size_t)last + 1;
    return CONUS_OK;
}
