/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares texts line by line, and lines of tables cell by cell. */
#include "cli/verify/rows_differ.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN = 80 /* bytes of a line without cells */ };

/* A part of a text; NULL behind its end. */
struct piece {
    const char *at;
    size_t size;
};

static struct piece next_line(const char **at, const char *end)
{
    const char *from = *at;
    if (from == end) {
        return (struct piece){0};
    }
    const char *stop = memchr(from, '\n', (size_t)(end - from));
    *at = stop ? stop + 1 : end;
    return (struct piece){from, (size_t)((stop ? stop : end) - from)};
}

/* The line ends count: a last line without one is another line. */
static bool equal(struct piece a, struct piece b)
{
    return a.at && b.at && a.size == b.size && memcmp(a.at, b.at, a.size) == 0;
}

/* The separator behind the cell; one of a CSV may have commas in quotation marks. NULL at the line's end. */
static const char *cell_end(const char *at, const char *end, char separator)
{
    bool quoted = false;
    for (; at < end && (quoted || *at != separator); at++) {
        quoted = quoted != (separator == ',' && *at == '"');
    }
    return at < end ? at : NULL;
}

static struct piece cell(struct piece line, char separator, size_t index)
{
    const char *end = line.at + line.size;
    const char *at = line.at;
    for (;; index--) {
        const char *stop = cell_end(at, end, separator);
        if (!index) {
            return (struct piece){at, (size_t)((stop ? stop : end) - at)};
        }
        if (!stop) {
            return (struct piece){0};
        }
        at = stop + 1;
    }
}

static char *text_of(struct piece piece, size_t limit)
{
    return piece.at ? strndup(piece.at, piece.size < limit ? piece.size : limit) : NULL;
}

/* Appends the cell of the column `name`, if there is one that says something. */
static void put_cell(FILE *out, struct piece header, struct piece line, char separator, const char *name,
                     const char *before)
{
    struct piece column;
    for (size_t i = 0; (column = cell(header, separator, i)).at; i++) {
        struct piece found = cell(line, separator, i);
        if (column.size == strlen(name) && memcmp(column.at, name, column.size) == 0 && found.at) {
            fprintf(out, "%s%.*s", before, (int)found.size, found.at);
        }
    }
}

/* Names the row and the first cell that differs. False where there is none of its own. */
static bool find_cell(struct difference *out, struct piece header, struct piece a, struct piece b, char separator)
{
    size_t size = 0;
    size_t i = 0;
    struct piece column;
    struct piece one = {0};
    struct piece other = {0};
    for (; (column = cell(header, separator, i)).at; i++) {
        one = cell(a, separator, i);
        other = cell(b, separator, i);
        if (!equal(one, other)) {
            break;
        }
    }
    if (!column.at || !one.at || !other.at) {
        return false;
    }
    FILE *where = open_memstream(&out->where, &size);
    if (where) {
        put_cell(where, header, a, separator, "query", "query ");
        put_cell(where, header, a, separator, "atlas", ", ");
        put_cell(where, header, a, separator, "name", ", ");
        fprintf(where, ": %.*s", (int)column.size, column.at);
    }
    if (where && fclose(where)) {
        return false;
    }
    out->before = text_of(one, one.size);
    out->after = text_of(other, other.size);
    return where && out->before && out->after;
}

static bool list(struct differences *out, struct piece header, struct piece a, struct piece b, size_t line)
{
    char separator = header.at && memchr(header.at, '\t', header.size) ? '\t' : ',';
    bool is_table = header.at && memchr(header.at, separator, header.size) && header.at[0] != '{';
    struct difference *item = &out->items[out->listed++];
    item->line = line;
    if (is_table && a.at && b.at && find_cell(item, header, a, b, separator)) {
        return true;
    }
    free(item->where);
    free(item->before);
    free(item->after);
    item->where = strdup("");
    item->before = text_of(a, SHOWN);
    item->after = text_of(b, SHOWN);
    return item->where && (!a.at || item->before) && (!b.at || item->after);
}

static size_t count_of(struct piece line, char wanted)
{
    size_t count = 0;
    for (size_t i = 0; i < line.size; i++) {
        count += line.at[i] == wanted;
    }
    return count;
}

/* Else they are no headers of one table. */
static bool have_as_many_cells(struct piece a, struct piece b)
{
    return count_of(a, '\t') == count_of(b, '\t') && count_of(a, ',') == count_of(b, ',');
}

bool differences_find(struct differences *out, const char *before, size_t before_size, const char *after,
                      size_t after_size, size_t first_line)
{
    const char *a_at = before;
    const char *b_at = after;
    struct piece header = {0};
    bool whole = true;
    *out = (struct differences){0};
    for (size_t line = first_line; whole; line++) {
        struct piece a = next_line(&a_at, before + before_size);
        struct piece b = next_line(&b_at, after + after_size);
        if (!a.at && !b.at) {
            break;
        }
        if (out->lines++ == 0) {
            header = have_as_many_cells(a, b) ? b : header;
        }
        if (!equal(a, b)) {
            out->count++;
            whole = out->listed == DIFFERENCES || list(out, header, a, b, line);
        }
    }
    bool same = before_size == after_size && memcmp(before, after, before_size) == 0;
    if (whole && !same && !out->count) { /* the last line has no end in one of them */
        static const char *const ends[] = {"no line end", "a line end"};
        out->count = 1;
        out->listed = 1;
        out->items[0] = (struct difference){.line = first_line + out->lines - 1,
                                            .where = strdup(""),
                                            .before = strdup(ends[before_size > after_size]),
                                            .after = strdup(ends[after_size > before_size])};
        whole = out->items[0].where && out->items[0].before && out->items[0].after;
    }
    return whole;
}

void differences_finish(struct differences *differences)
{
    for (size_t i = 0; i < differences->listed; i++) {
        free(differences->items[i].where);
        free(differences->items[i].before);
        free(differences->items[i].after);
    }
    *differences = (struct differences){0};
}
