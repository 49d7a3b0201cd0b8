/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the tables in a text by the gaps in their lines, and cuts them where a column ends. */
#include "options/options.h"

#include "base/system/system.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GAP = 2, NAMES_SIZE = 512 };

/* Bytes of the line at `text`, without its end. */
static size_t length_of(const char *text)
{
    return strcspn(text, "\n");
}

static const char *next_line(const char *text)
{
    text += length_of(text);
    return *text ? text + 1 : text;
}

static bool begins_letter(char byte)
{
    return ((unsigned char)byte & 0xc0) != 0x80;
}

/* Bytes before column `column` of a line of `length` bytes; all of them where it is shorter. */
static size_t bytes_before(const char *line, size_t length, size_t column)
{
    size_t i = 0;
    for (size_t letters = 0; i < length; i++) {
        letters += begins_letter(line[i]);
        if (letters > column) {
            break;
        }
    }
    return i;
}

static size_t columns_of(const char *line, size_t length)
{
    size_t columns = 0;
    for (size_t i = 0; i < length; i++) {
        columns += begins_letter(line[i]);
    }
    return columns;
}

/* The next words of a line from byte `from` on, with single spaces between them: *begin to *end. False at its end. */
static bool next_words(size_t *begin, size_t *end, const char *line, size_t length, size_t from)
{
    while (from < length && line[from] == ' ') {
        from++;
    }
    *begin = from;
    while (from < length && (line[from] != ' ' || (from + 1 < length && line[from + 1] != ' '))) {
        from++;
    }
    *end = from;
    return *end > *begin;
}

/* Entries of a line: words with gaps between them. */
static size_t entries_of(const char *line)
{
    size_t count = 0;
    size_t begin;
    for (size_t end = 0; next_words(&begin, &end, line, length_of(line), end);) {
        count++;
    }
    return count;
}

/* Whether no line from `text` to `end` has anything in the two columns from `column` on. */
static bool is_gap(const char *text, const char *end, size_t column)
{
    for (; text < end; text = next_line(text)) {
        size_t length = length_of(text);
        size_t at = bytes_before(text, length, column);
        for (size_t i = at; i < at + GAP && i < length; i++) {
            if (text[i] != ' ') {
                return false;
            }
        }
    }
    return true;
}

static size_t widest(const char *text, const char *end)
{
    size_t width = 0;
    for (; text < end; text = next_line(text)) {
        size_t columns = columns_of(text, length_of(text));
        width = columns > width ? columns : width;
    }
    return width;
}

/* Where to cut the table so that it has at most `width` columns; as wide as it is where no column ends before. Numbers
 * end where their header does; words begin there, and end before the next one begins. */
static size_t find_cut(const char *text, const char *end, size_t width)
{
    size_t all = widest(text, end);
    size_t cut = all;
    size_t begin;
    size_t last = 0;
    bool is_first = true; /* a number, which alone says nothing */
    bool is_ended = true; /* the column of the words before */
    while (all > width && next_words(&begin, &last, text, length_of(text), last)) {
        size_t before = is_ended ? 0 : columns_of(text, begin) - GAP;
        size_t column = columns_of(text, last);
        cut = before && before <= width && is_gap(text, end, before) ? before : cut;
        is_ended = is_first || is_gap(text, end, column);
        cut = is_ended && !is_first && column <= width ? column : cut;
        is_first = false;
    }
    return cut;
}

/* Adds the header's entries behind the cut: ", nearest, off axis". Returns their number. */
static size_t name_rest(char names[NAMES_SIZE], const char *header, size_t cut)
{
    size_t count = 0;
    size_t begin;
    size_t end = 0;
    names[0] = '\0';
    while (next_words(&begin, &end, header, length_of(header), end)) {
        if (columns_of(header, end) > cut) {
            size_t used = strlen(names);
            snprintf(names + used, NAMES_SIZE - used, "%s%.*s", count++ ? ", " : "", (int)(end - begin),
                     header + begin);
        }
    }
    return count;
}

static void put_table(FILE *out, const char *text, const char *end, size_t cut, bool bold)
{
    for (const char *line = text; line < end; line = next_line(line)) {
        size_t length = length_of(line);
        size_t kept = bytes_before(line, length, cut);
        while (kept < length && kept > 0 && line[kept - 1] == ' ') {
            kept--;
        }
        bool is_header = bold && line == text;
        fprintf(out, "%s%.*s%s\n", is_header ? "\033[1m" : "", (int)kept, line, is_header ? "\033[0m" : "");
    }
}

char *table_fit(const char *text, size_t width, bool bold, const char *whole)
{
    struct system_text fitted;
    size_t count = 0;
    char names[NAMES_SIZE] = "";
    FILE *out = system_text_open(&fitted);
    if (!out) {
        return NULL;
    }
    while (*text) {
        if (entries_of(text) > GAP) {
            const char *end = text;
            while (*end && entries_of(end) > GAP - 1) {
                end = next_line(end);
            }
            size_t cut = width ? find_cut(text, end, width) : widest(text, end);
            count = count ? count : name_rest(names, text, cut);
            put_table(out, text, end, cut, bold);
            text = end;
        } else {
            fprintf(out, "%.*s\n", (int)length_of(text), text);
            text = next_line(text);
        }
    }
    if (count) {
        fprintf(out, "%zu column%s left out: %s; %s\n", count, count > 1 ? "s" : "", names, whole);
    }
    return system_text_close(&fitted);
}

enum { WIDTH_LIMIT = 100000 };

size_t terminal_width(int descriptor)
{
    unsigned known = system_columns(descriptor);
    if (known || !system_is_terminal(descriptor)) {
        return known;
    }
    const char *columns = system_variable("COLUMNS");
    long width = columns ? strtol(columns, NULL, 10) : 0;
    return width > 0 && width < WIDTH_LIMIT ? (size_t)width : 0;
}

bool terminal_has_colour(int descriptor)
{
    const char *none = system_variable("NO_COLOR"); /* no-color.org: any text but the empty one */
    const char *term = system_variable("TERM");
    return system_is_terminal(descriptor) && !(none && *none) && term && *term && strcmp(term, "dumb") != 0;
}
