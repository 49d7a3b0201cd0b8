/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares tables row by row and pictures pixel by pixel. */
#include "cli/answers/answers.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/** A comparison of two tables: columns come in a's order. */
struct comparison {
    const struct results *a, *b;
    double tolerance;
    difference_taker *take;
    void *user;
    struct differences count;
};

static void report(struct comparison *diff, const char *what, size_t row, const char *where, const char *column,
                   const char *before, const char *after)
{
    diff->take(diff->user, &(struct difference){what, row + 2, where, column, before, after});
}

static void tell_columns(struct comparison *diff, const struct results *of, const struct results *in, const char *where)
{
    for (size_t c = 0; c < of->columns; c++) {
        size_t column;
        if (!results_column(in, of->cells[c], &column)) {
            diff->take(diff->user, &(struct difference){"column", 1, where, of->cells[c], NULL, NULL});
            diff->count.columns++;
        }
    }
}

static const char *cell_named(const struct results *results, size_t row, const char *name)
{
    size_t column;
    return results_column(results, name, &column) ? results_cell(results, row, column) : NULL;
}

/* Writes a cell behind before, unless there is none or it says no more than the row's kind. */
static void write_cell(FILE *out, const char *before, const char *cell, const char *kind)
{
    if (cell && strcmp(cell, "n/a") != 0 && strcmp(cell, kind) != 0) {
        fprintf(out, "%s%s", before, cell);
    }
}

/* "query 1, row 2, aal: area 3 Core"; NULL without memory. */
static char *row_name(const struct results *results, size_t row)
{
    static const char *const more[] = {"name", "pathway", "i", "j", "k", "bundle", "end_a", "end_b"};
    const char *kind = cell_named(results, row, "kind");
    const char *index = cell_named(results, row, "index");
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (out) {
        fprintf(out, "query %s", cell_named(results, row, "query"));
        write_cell(out, ", row ", cell_named(results, row, "row"), kind);
        write_cell(out, ", ", cell_named(results, row, "atlas"), kind);
        fprintf(out, ": %s", kind);
        write_cell(out, " ", index ? index : cell_named(results, row, "bundle_index"), kind);
    }
    for (size_t i = 0; out && i < sizeof more / sizeof more[0]; i++) {
        write_cell(out, " ", cell_named(results, row, more[i]), kind);
    }
    return system_text_close(&text);
}

/* Compares row of a with its fellow in b, and tells what differs. */
static void compare_rows(struct comparison *diff, size_t row, size_t other)
{
    char *where = NULL;
    for (size_t c = 0; c < diff->a->columns; c++) {
        const char *name = diff->a->cells[c];
        const char *one = results_cell(diff->a, row, c);
        const char *two = cell_named(diff->b, other, name);
        double x;
        double y;
        if (!two || strcmp(one, two) == 0) {
            continue;
        }
        if (conus_column_is_number(name) && number_parse(one, &x) && number_parse(two, &y) &&
            fabs(x - y) <= diff->tolerance) { /* a name is no number, even if it looks like one: "1e1" is not "10" */
            continue;
        }
        diff->count.changed += !where;
        where = where ? where : row_name(diff->a, row);
        report(diff, "changed", row, where ? where : "", name, one, two);
    }
    diff->count.same += !where;
    free(where);
}

static void tell_row(struct comparison *diff, const char *what, const struct results *of, size_t row)
{
    char *where = row_name(of, row);
    report(diff, what, row, where ? where : "", NULL, NULL, NULL);
    free(where);
}

void tables_compare(struct differences *out, const struct results *a, const struct results *b, double tolerance,
                    difference_taker *take, void *user)
{
    struct comparison diff = {.a = a, .b = b, .tolerance = tolerance, .take = take, .user = user};
    size_t other;
    tell_columns(&diff, a, b, "the first");
    tell_columns(&diff, b, a, "the second");
    for (size_t row = 0; row < a->rows; row++) {
        if (results_find(b, a, row, &other)) {
            compare_rows(&diff, row, other);
        } else {
            tell_row(&diff, "removed", a, row);
            diff.count.removed++;
        }
    }
    for (size_t row = 0; row < b->rows; row++) {
        if (!results_find(a, b, row, &other)) {
            tell_row(&diff, "added", b, row);
            diff.count.added++;
        }
    }
    *out = diff.count;
}

static size_t put_channels(FILE *out, const conus_image *of, const conus_image *in, const char *where)
{
    size_t count = 0;
    const char *channel;
    for (size_t i = 0; (channel = conus_image_channel(of, i)); i++) {
        const char *fellow;
        size_t k = 0;
        while ((fellow = conus_image_channel(in, k)) && strcmp(fellow, channel) != 0) {
            k++;
        }
        if (!fellow) {
            fprintf(out, "channel %s is only in %s\n", channel, where);
            count++;
        }
    }
    return count;
}

/* Gives EXIT_DONE for the same picture, EXIT_DIFFERENT for another. */
static int put_pictures(FILE *out, const conus_image *a, const conus_image *b, double tolerance)
{
    conus_image_difference found;
    uint32_t size[] = {conus_image_width(a), conus_image_height(a), conus_image_width(b), conus_image_height(b)};
    if (size[0] != size[2] || size[1] != size[3]) {
        fprintf(out, "the first is %u x %u pixels, the second %u x %u\n", size[0], size[1], size[2], size[3]);
        return EXIT_DIFFERENT;
    }
    size_t lonely = put_channels(out, a, b, "the first");
    lonely += put_channels(out, b, a, "the second");
    if (lonely) {
        return EXIT_DIFFERENT;
    }
    conus_status status = conus_image_compare(&found, a, b, tolerance);
    if (status) {
        return print_status(status);
    }
    fprintf(out, "%llu of %llu pixels differ", (unsigned long long)found.differing, (unsigned long long)found.pixels);
    if (*found.channel) {
        fprintf(out, " by more than %.9g; the largest difference is %.9g, of channel %s at (%u, %u); rms %.9g",
                tolerance, found.max_difference, found.channel, found.x, found.y, found.rms);
    }
    fputc('\n', out);
    return found.differing ? EXIT_DIFFERENT : EXIT_DONE;
}

int pictures_compare(FILE *out, const char *a, const char *b, double tolerance)
{
    conus_image *first = NULL;
    conus_image *second = NULL;
    conus_status status = conus_image_load(&first, a);
    status = status ? status : conus_image_load(&second, b);
    int code = print_status(status);
    code = code ? code : put_pictures(out, first, second, tolerance);
    conus_image_destroy(first);
    conus_image_destroy(second);
    return code;
}
