/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures the columns, then pads the cells. */
#include "cli/answers/answers.h"

#include "base/system/system.h"
#include "options/messages.h"

#include <stdlib.h>
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

static void put_columns(FILE *out, const char *tsv, size_t columns, const bool right[])
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

bool aligned_put(FILE *out, bool put(FILE *out, const void *what), const void *what, size_t columns, const bool right[])
{
    struct system_text tsv;
    bool whole = system_text_open(&tsv) && put(tsv.stream, what);
    whole = system_text_close(&tsv) && whole;
    if (whole) {
        put_columns(out, tsv.data, columns, right);
    }
    free(tsv.data);
    return whole;
}

bool aligned_put_cell(FILE *out, const char *text)
{
    char *plain = text ? strdup(text) : NULL;
    const bool whole = plain || !text;
    if (plain) {
        make_plain_line(plain);
    }
    fputs(plain && *plain ? plain : "n/a", out);
    free(plain);
    return whole;
}
