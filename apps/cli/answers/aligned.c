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

void aligned_put(FILE *out, const char *tsv, size_t columns, const bool right[])
{
    int widths[ALIGNED_COLUMNS] = {0};
    bool shown[ALIGNED_COLUMNS] = {false}; /* some row has a value */
    size_t last = 0;                       /* of those */
    size_t cells = 0;
    for (const char *cell = tsv; *cell; cell = next_cell(cell)) {
        size_t c = cells % columns;
        int width = text_width(cell);
        widths[c] = width > widths[c] ? width : widths[c];
        shown[c] = shown[c] || (cells >= columns && strncmp(cell, "n/a", 3) != 0);
        last = shown[c] && c > last ? c : last;
        cells++;
    }
    cells = 0;
    for (const char *cell = tsv; *cell; cell = next_cell(cell)) {
        size_t c = cells++ % columns;
        if (shown[c]) {
            int blank = widths[c] - text_width(cell);
            fprintf(out, "  %*s%.*s%*s", right[c] ? blank : 0, "", (int)strcspn(cell, "\t\n"), cell,
                    right[c] || c == last ? 0 : blank, "");
        }
        fputs(c + 1 == columns ? "\n" : "", out);
    }
}
