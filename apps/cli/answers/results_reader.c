/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a TSV or CSV result and finds its rows by their keys. */
#include "cli/answers/answers.h"

#include "base/order.h"
#include "options/messages.h"
#include "options/output.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const key_names[RESULTS_KEYS] = {"query",       "kind",  "index", "atlas",        "i",
                                                    "j",           "k",     "order", "bundle_index", "end_a_index",
                                                    "end_b_index", "end_a", "end_b", "row"};
enum { INDEX_KEY = 2, NEEDED_KEYS = 3, ATLAS_KEY = 3, COLUMN_LIMIT = 1000 };

const char *results_cell(const struct results *results, size_t row, size_t column)
{
    return results->cells[(row + 1) * results->columns + column];
}

bool results_column(const struct results *results, const char *name, size_t *column)
{
    for (size_t c = 0; c < results->columns; c++) {
        if (strcmp(results->cells[c], name) == 0) {
            *column = c;
            return true;
        }
    }
    return false;
}

void results_finish(struct results *results)
{
    free(results->bytes);
    free(results->cells);
    free(results->order);
    *results = (struct results){0};
}

static int compare_rows(const struct results *a, size_t row, const struct results *b, size_t other)
{
    int order = 0;
    for (size_t i = 0; i < RESULTS_KEYS && order == 0; i++) {
        if (a->keys[i] && b->keys[i]) {
            order = strcmp(a->keys[i][(row + 1) * a->columns], b->keys[i][(other + 1) * b->columns]);
        } else if (i == ATLAS_KEY && (a->keys[i] || b->keys[i])) {
            order = a->keys[i] ? 1 : -1;
        }
    }
    return order;
}

static int by_key(const void *a, const void *b, void *results)
{
    return compare_rows(results, *(const size_t *)a, results, *(const size_t *)b);
}

bool results_find(const struct results *results, const struct results *other, size_t row, size_t *found)
{
    size_t low = 0;
    size_t high = results->rows;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        int order = compare_rows(results, results->order[middle], other, row);
        if (order == 0) {
            *found = results->order[middle];
            return true;
        }
        low = order < 0 ? middle + 1 : low;
        high = order < 0 ? high : middle;
    }
    return false;
}

static int no_memory(const char *path)
{
    return print_data_error("%s: not enough memory", path);
}

static size_t count_of(const char *text, size_t size, char wanted)
{
    size_t count = 0;
    for (size_t i = 0; i < size; i++) {
        count += text[i] == wanted;
    }
    return count;
}

/* Ends every line with LF, so that the rest need not know about CR and a missing last one. */
static size_t tidy_lines(char *text, size_t size)
{
    size_t kept = 0;
    for (size_t i = 0; i < size; i++) {
        if (text[i] != '\r') {
            text[kept++] = text[i];
        }
    }
    if (kept && text[kept - 1] != '\n') {
        text[kept++] = '\n';
    }
    text[kept] = '\0';
    return kept;
}

/* Takes the quotation marks off a cell (RFC 4180). Gives what follows the cell; NULL if it is not closed. */
static char *unquote(char *cell)
{
    char *to = cell;
    for (char *from = cell + 1; *from; from++) {
        if (*from == '"' && *++from != '"') { /* a mark that is not doubled is the last */
            *to = '\0';
            return from;
        }
        *to++ = *from;
    }
    return NULL;
}

/* Ends the cell that begins here; *next is the one behind it, NULL if it is the line's last. False where its quotation
 * marks are wrong. */
static bool end_cell(char **next, char *cell, char separator)
{
    bool quoted = separator == ',' && *cell == '"';
    const char stops[] = {separator, '\0'};
    char *end = quoted ? unquote(cell) : cell + strcspn(cell, stops);
    if (!end || (*end && *end != separator)) {
        return false;
    }
    *next = *end ? end + 1 : NULL;
    if (!quoted) {
        *end = '\0';
    }
    return true;
}

/* Cuts one line, of `length` bytes with its LF, into cells. */
static int cut_line(struct results *results, const char *path, char *line, size_t length, size_t number)
{
    const char **cells = results->cells + (number - 1) * results->columns;
    size_t fields = 0;
    line[length - 1] = '\0';
    for (char *next; line; line = next) {
        if (!end_cell(&next, line, results->separator)) {
            return print_data_error("%s:%zu: a quotation mark inside a field, or one that is not closed", path, number);
        }
        if (fields < results->columns) {
            cells[fields] = line;
        }
        fields++;
    }
    if (fields != results->columns) {
        return print_data_error("%s:%zu: %zu fields, the header has %zu", path, number, fields, results->columns);
    }
    return EXIT_DONE;
}

static int cut_lines(struct results *results, const char *path, size_t size)
{
    size_t lines = count_of(results->bytes, size, '\n');
    size_t header = strcspn(results->bytes, "\n");
    results->separator = memchr(results->bytes, '\t', header) ? '\t' : ',';
    results->columns = count_of(results->bytes, header, results->separator) + 1;
    results->rows = lines - 1;
    if (results->columns > COLUMN_LIMIT) {
        return print_data_error("%s: %zu columns, allowed are %d", path, results->columns, COLUMN_LIMIT);
    }
    if (results->columns > SIZE_MAX / sizeof *results->cells / lines) {
        return no_memory(path);
    }
    results->cells = calloc(lines * results->columns, sizeof *results->cells);
    if (!results->cells) {
        return no_memory(path);
    }
    int code = EXIT_DONE;
    char *line = results->bytes;
    for (size_t number = 1; !code && number <= lines; number++) {
        size_t length = strcspn(line, "\n") + 1;
        code = cut_line(results, path, line, length, number);
        line += length;
    }
    return code;
}

static int check_columns(struct results *results, const char *path)
{
    for (size_t c = 0; c < results->columns; c++) {
        size_t first = 0;
        if (results_column(results, results->cells[c], &first) && first != c) {
            return print_data_error("%s: column \"%s\" is there twice", path, results->cells[c]);
        }
    }
    for (size_t i = 0; i < RESULTS_KEYS; i++) {
        size_t column;
        bool other = (i == INDEX_KEY && results_column(results, "bundle_index", &column)) ||
                     (i > 0 && results_column(results, "feasible", &column)); /* of a plan */
        if (results_column(results, key_names[i], &column)) {
            results->keys[i] = &results->cells[column];
        } else if (i < NEEDED_KEYS && !other) {
            return print_data_error("%s: no column \"%s\": not a TSV or CSV result of conus", path, key_names[i]);
        }
    }
    return EXIT_DONE;
}

static int sort_rows(struct results *results, const char *path)
{
    results->order = calloc(results->rows + 1, sizeof *results->order);
    if (!results->order) {
        return no_memory(path);
    }
    for (size_t i = 0; i < results->rows; i++) {
        results->order[i] = i;
    }
    order_sort_by(results->order, results->rows, sizeof *results->order, by_key, results);
    for (size_t i = 1; i < results->rows; i++) {
        size_t row = results->order[i];
        if (compare_rows(results, row, results, results->order[i - 1]) == 0) {
            return print_data_error("%s:%zu: the same query, kind and index as another line", path, row + 2);
        }
    }
    return EXIT_DONE;
}

int results_parse(struct results *out, const char *path, const char *bytes, size_t size)
{
    struct results results = {.bytes = malloc(size + 2)};
    if (!results.bytes) {
        return no_memory(path);
    }
    memcpy(results.bytes, bytes, size);
    size = tidy_lines(results.bytes, size);
    const char *bad = size == 0                           ? "is empty, a TSV or CSV result of conus is needed"
                      : memchr(results.bytes, '\0', size) ? "a zero byte: not a TSV or CSV result of conus"
                      : results.bytes[0] == '{' || results.bytes[0] == '['
                          ? "looks like JSON; diff compares TSV and CSV results and pictures"
                          : NULL;
    int code = EXIT_DONE;
    if (bad) {
        code = print_data_error("%s: %s", path, bad);
    }
    code = code ? code : cut_lines(&results, path, size);
    code = code ? code : check_columns(&results, path);
    code = code ? code : sort_rows(&results, path);
    if (code) {
        results_finish(&results);
        return code;
    }
    *out = results;
    return EXIT_DONE;
}

int results_load(struct results *out, const char *path, uint64_t limit)
{
    char *bytes = NULL;
    size_t size = 0;
    int code = input_file_read(&bytes, &size, path, INPUT_FILE_OR_PIPE, limit);
    code = code ? code : results_parse(out, path, bytes, size);
    free(bytes);
    return code;
}
