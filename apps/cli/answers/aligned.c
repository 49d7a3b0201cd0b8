/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures the columns, then pads the cells. */
#include "cli/answers/aligned.h"

#include <string.h>

/* Characters on the screen: UTF-8 without continuation bytes. */
static int text_width(const char *text)
{
    int width = 0;
    for (; *text && *text != '\t' && *text != '\n'; text++) {
        width += ((unsigned char)*text & 0xc0) != 0x80;
    }
    return width;
}

/* Walks the cells of tab-separated lines. */
static const char *next_cell(const char *cell)
{
    cell += strcspn(cell, "\t\n");
    return *cell ? cell + 1 : cell;
}

/** How a column is shown in the table. */
struct layout {
    int width[ALIGNED_COLUMNS];
    bool shown[ALIGNED_COLUMNS]; /* some row has a value */
    size_t last;                 /* of those */
};

static struct layout measure_columns(const char *tsv, size_t columns)
{
    struct layout layout = {0};
    size_t cells = 0;
    for (const char *cell = tsv; *cell; cell = next_cell(cell)) {
        size_t c = cells % columns;
        int width = text_width(cell);
        layout.width[c] = width > layout.width[c] ? width : layout.width[c];
        layout.shown[c] = layout.shown[c] || (cells >= columns && strncmp(cell, "n/a", 3) != 0);
        layout.last = layout.shown[c] && c > layout.last ? c : layout.last;
        cells++;
    }
    return layout;
}

void aligned_put(FILE *out, const char *tsv, size_t columns, const bool right[])
{
    struct layout layout = measure_columns(tsv, columns);
    size_t cells = 0;
    for (const char *cell = tsv; *cell; cell = next_cell(cell)) {
        size_t c = cells++ % columns;
        if (layout.shown[c]) {
            int blank = layout.width[c] - text_width(cell);
            fprintf(out, "  %*s%.*s%*s", right[c] ? blank : 0, "", (int)strcspn(cell, "\t\n"), cell,
                    right[c] || c == layout.last ? 0 : blank, "");
        }
        fputs(c + 1 == columns ? "\n" : "", out);
    }
}
