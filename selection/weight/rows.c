/* SPDX-License-Identifier: BSD-3-Clause */
/* Small tables of named columns: weights by angle or offset, priors of objects. */
#include "base/files/file.h"
#include "base/formats/table.h"
#include "base/memory.h"
#include "selection/weight/weight.h"

#include <stdio.h>

static const uint64_t size_limit = UINT64_C(1) << 26;

/* What separates the cells: the first of these that the header has, else white space. */
static enum table_separator separator_of(struct text header)
{
    return memchr(header.data, '\t', header.size)  ? TABLE_TABS
           : memchr(header.data, ';', header.size) ? TABLE_SEMICOLONS
           : memchr(header.data, ',', header.size) ? TABLE_COMMAS
                                                   : TABLE_SPACES;
}

/* Which cell of a row each name has, SIZE_MAX = none; and how many cells rows have. */
static conus_status read_header(size_t places[ROW_CELLS], size_t *width, const struct row_reader *reader,
                                const struct table_line *line)
{
    char known[256] = "";
    size_t used = 0;
    for (size_t k = 0; k < reader->count; k++) {
        places[k] = SIZE_MAX;
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", k ? ", " : "", reader->names[k]);
    }
    *width = line->given;
    for (size_t i = 0; i < line->given; i++) {
        size_t k = 0;
        while (k < reader->count && !text_equal_ignoring_case(line->cells[i], reader->names[k])) {
            k++;
        }
        if (k == reader->count) {
            return fail(CONUS_ERROR_DATA, "column \"%.*s\" is unknown, allowed are %s", TEXT_SHOW(line->cells[i], 40),
                        known);
        }
        if (places[k] < SIZE_MAX) {
            return fail(CONUS_ERROR_DATA, "column %s is there twice", reader->names[k]);
        }
        places[k] = i;
    }
    return CONUS_OK;
}

static conus_status read_lines(struct text rest, size_t *number, const struct row_reader *reader)
{
    struct table table = {.separator = TABLE_SPACES};
    size_t places[ROW_CELLS];
    size_t width = 0;
    struct table_line *line = memory_raw(1, sizeof *line);
    struct text text;
    bool has_header = false;
    conus_status status = line ? CONUS_OK : CONUS_ERROR_MEMORY;
    while (!status && table_next_line(&rest, &text, number)) {
        table.separator = has_header ? table.separator : separator_of(text);
        struct text cells[ROW_CELLS] = {{NULL, 0}};
        if (!table_split(line, &table, text)) {
            status = fail(CONUS_ERROR_DATA, "more than %d cells", TABLE_CELLS);
        } else if (!has_header) {
            status = read_header(places, &width, reader, line);
            has_header = true;
        } else if (line->given > width) { /* 0,5 where commas separate, say */
            status = fail(CONUS_ERROR_DATA, "%zu cells, the header has %zu", line->given, width);
        } else {
            for (size_t k = 0; k < reader->count; k++) {
                bool is_there = places[k] < line->count;
                cells[k] = is_there ? line->cells[places[k]] : places[k] < SIZE_MAX ? (struct text){"", 0} : cells[k];
            }
            status = reader->take(reader->user, cells);
        }
    }
    memory_free(line);
    return status;
}

conus_status rows_read(const char *path, const struct row_reader *reader)
{
    struct bytes bytes = {0};
    size_t number = 0;
    conus_status status = file_read(&bytes, path, size_limit);
    if (status) {
        return status;
    }
    status = read_lines(text_from_bytes(bytes.data, bytes.size), &number, reader);
    bytes_finish(&bytes);
    if (status == CONUS_ERROR_DATA || status == CONUS_ERROR_ARGUMENT) {
        char why[256];
        snprintf(why, sizeof why, "%s", conus_message());
        return fail(status, "%s:%zu: %s", path, number, why);
    }
    return status;
}
