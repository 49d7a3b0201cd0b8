/* SPDX-License-Identifier: BSD-3-Clause */
/* Small tables of named columns: weights by angle or offset, priors of objects. */
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

/* Finds the columns in the header, which has no others. */
static void read_header(struct job *job, struct named_cells *cells, struct text header)
{
    cells->table.separator = separator_of(header);
    named_cells_find(job, cells, header);
    for (size_t i = 0; i < cells->line.given; i++) {
        size_t k = 0;
        while (k < cells->count && cells->at[k] != i) {
            k++;
        }
        if (k == cells->count) {
            char known[128] = "";
            size_t used = 0;
            for (k = 0; k < cells->count; k++) {
                used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", k ? ", " : "", cells->names[k]);
            }
            job_bad(job, "column \"%.*s\" is unknown, allowed are %s", TEXT_SHOW(cells->line.cells[i], 40), known);
        }
    }
}

/* "# unit: V/m"; false where it is too long, no UTF-8 or not the one before. */
static bool read_unit(char unit[32], struct text line)
{
    static const char key[] = "unit:";
    line = text_trim(line);
    while (line.size && (*line.data == '#' || *line.data == ' ')) {
        line = (struct text){line.data + 1, line.size - 1};
    }
    if (!text_starts(line, key)) {
        return true;
    }
    line = text_trim((struct text){line.data + sizeof key - 1, line.size - (sizeof key - 1)});
    if (line.size > 31 || !text_is_utf8(line) || (unit[0] && !text_equal(line, unit))) {
        return false;
    }
    (void)snprintf(unit, 32, "%.*s", (int)line.size, line.data);
    return true;
}

static bool find_unit(char unit[32], struct text all)
{
    struct text line;
    bool is_one = true;
    for (bool more = true; is_one && text_field(&all, '\n', &more, &line);) {
        is_one = !line.size || *line.data != '#' || read_unit(unit, line);
    }
    return is_one;
}

conus_status rows_read(const char *path, const char *const *names, size_t count, rows_take *take, void *user,
                       char unit[32])
{
    struct job job = {0};
    (void)job_in(&job, path, JOB_ALONE);
    const struct bytes bytes = job_read(&job, path, size_limit, "");
    struct text rest = text_from_bytes(bytes.data, bytes.size);
    struct named_cells *cells = job_new(&job, struct named_cells);
    struct text line;
    bool has_header = false;
    if (unit && job_ok(&job) && !find_unit(unit, rest)) {
        job_bad(&job, "unit: it has more than 31 bytes, is no UTF-8, or differs from one before");
    }
    (void)job_in(&job, "line ", 0);
    for (size_t number = 0; job_ok(&job) && table_next_line(&rest, &line, &number); has_header = true) {
        job_at(&job, "line ", number);
        if (has_header) {
            named_cells_split(&job, cells, line);
            take(&job, cells, user);
        } else {
            cells->names = names;
            cells->count = count;
            read_header(&job, cells, line);
        }
    }
    return job_close(&job, NULL, NULL);
}
