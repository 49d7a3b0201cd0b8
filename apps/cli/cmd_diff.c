/* SPDX-License-Identifier: BSD-3-Clause */
/* conus diff: compares two results row by row, or two pictures. */
#include "base/system/system.h"
#include "cli/answers/results_reader.h"
#include "cli/commands.h"
#include "conus/image.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
#include "settings/settings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t DEFAULT_MEMORY = UINT64_C(4) << 30;

struct diff_settings {
    struct common_settings common;
    double tolerance;
    uint64_t max_memory;
};

static const struct option own_options[] = {
    {.name = "tolerance",
     OPTION_AT(struct diff_settings, tolerance),
     .value = "T",
     .help = "numbers that differ by T or less are the same (default 0); names and labels must be equal",
     OPTION_FROM_TO(0, 1e30),
     .common = true},
    {.name = "max-memory",
     .type = OPTION_BYTES,
     .offset = offsetof(struct diff_settings, max_memory),
     .value = "SIZE",
     .help = "largest table to read, like 512M or 2G (default 4G)"},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct diff_settings, common)},
    {0},
};

/** A comparison of two tables: columns come in a's order. */
struct comparison {
    const struct results *a, *b;
    double tolerance;
    FILE *out;
    size_t same, changed, removed, added, columns;
};

static void put_columns(struct comparison *diff, const struct results *of, const struct results *in, const char *where)
{
    for (size_t c = 0; c < of->columns; c++) {
        size_t column;
        if (!results_column(in, of->cells[c], &column)) {
            fprintf(diff->out, "column    %s is only in %s\n", of->cells[c], where);
            diff->columns++;
        }
    }
}

static const char *cell_named(const struct results *results, size_t row, const char *name)
{
    size_t column;
    return results_column(results, name, &column) ? results_cell(results, row, column) : NULL;
}

static void put_row(struct comparison *diff, const char *what, const struct results *results, size_t row)
{
    static const char *const more[] = {"name", "pathway", "i", "j", "k", "bundle", "end_a", "end_b"};
    const char *atlas = cell_named(results, row, "atlas");
    const char *index = cell_named(results, row, "index");
    const char *number = cell_named(results, row, "row");
    fprintf(diff->out, "%-8s  query %s%s%s%s%s: %s %s", what, cell_named(results, row, "query"), number ? ", row " : "",
            number ? number : "", atlas ? ", " : "", atlas ? atlas : "", cell_named(results, row, "kind"),
            index ? index : cell_named(results, row, "bundle_index"));
    for (size_t i = 0; i < sizeof more / sizeof more[0]; i++) {
        const char *cell = cell_named(results, row, more[i]);
        fprintf(diff->out, "%s%s", cell ? " " : "", cell ? cell : "");
    }
}

/* Compares row of a with its fellow in b, and writes what differs. */
static void compare_rows(struct comparison *diff, size_t row, size_t other)
{
    bool changed = false;
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
        if (!changed) {
            put_row(diff, "changed", diff->a, row);
        }
        fprintf(diff->out, "%s %s %s -> %s", changed ? "," : ":", name, one, two);
        changed = true;
    }
    fputs(changed ? "\n" : "", diff->out);
    diff->changed += changed;
    diff->same += !changed;
}

static void compare_tables(struct comparison *diff)
{
    size_t other;
    put_columns(diff, diff->a, diff->b, "the first");
    put_columns(diff, diff->b, diff->a, "the second");
    for (size_t row = 0; row < diff->a->rows; row++) {
        if (results_find(diff->b, diff->a, row, &other)) {
            compare_rows(diff, row, other);
        } else {
            put_row(diff, "removed", diff->a, row);
            fputc('\n', diff->out);
            diff->removed++;
        }
    }
    for (size_t row = 0; row < diff->b->rows; row++) {
        if (!results_find(diff->a, diff->b, row, &other)) {
            put_row(diff, "added", diff->b, row);
            fputc('\n', diff->out);
            diff->added++;
        }
    }
    fprintf(diff->out, "%zu rows the same, %zu changed, %zu removed, %zu added\n", diff->same, diff->changed,
            diff->removed, diff->added);
}

static int diff_tables(const char *a, const char *b, const struct diff_settings *settings)
{
    uint64_t limit = settings->max_memory ? settings->max_memory : DEFAULT_MEMORY;
    struct results first = {0};
    struct results second = {0};
    int code = results_load(&first, a, limit);
    code = code ? code : results_load(&second, b, limit);
    /* The columns by which rows belong together: one lists objects, say, and the other connections. */
    static const char *const kinds[] = {"index", "i", "order", "bundle_index"};
    for (size_t i = 0; !code && i < sizeof kinds / sizeof kinds[0]; i++) {
        size_t column;
        if (results_column(&first, kinds[i], &column) != results_column(&second, kinds[i], &column)) {
            code = print_usage_error("%s and %s are lists of different things: one has a column \"%s\", the other has "
                                     "none",
                                     a, b, kinds[i]);
        }
    }
    if (!code) {
        struct comparison diff = {.a = &first, .b = &second, .tolerance = settings->tolerance};
        struct system_text text;
        diff.out = system_text_open(&text);
        if (diff.out) {
            compare_tables(&diff);
        }
        code = output_end(&text);
        bool differ = diff.columns + diff.changed + diff.removed + diff.added > 0;
        code = code ? code : differ ? EXIT_DIFFERENT : EXIT_DONE;
    }
    results_finish(&first);
    results_finish(&second);
    return code;
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

static int diff_pictures(const char *a, const char *b, double tolerance)
{
    conus_image *first = NULL;
    conus_image *second = NULL;
    conus_status status = conus_image_load(&first, a);
    status = status ? status : conus_image_load(&second, b);
    int code = print_status(status);
    if (!code) {
        struct system_text text;
        FILE *out = system_text_open(&text);
        code = out ? put_pictures(out, first, second, tolerance) : EXIT_DONE;
        int written = output_end(&text);
        code = written ? written : code;
    }
    conus_image_destroy(first);
    conus_image_destroy(second);
    return code;
}

static int run_diff(const void *given, const struct arguments *arguments)
{
    const struct diff_settings *settings = given;
    const char *a = arguments->operands[0];
    const char *b = arguments->operands[1];
    if (path_is_picture(a) != path_is_picture(b)) {
        return print_usage_error("%s is a picture and %s is not: two of a kind are needed", path_is_picture(a) ? a : b,
                                 path_is_picture(a) ? b : a);
    }
    return path_is_picture(a) ? diff_pictures(a, b, settings->tolerance) : diff_tables(a, b, settings);
}

const struct command cmd_diff = {
    .name = "diff",
    .summary = "compare two results or two pictures",
    .operands = {"A", "B"},
    .description =
        "Compares two TSV or CSV results row by row, matched by query, atlas, kind and index, and names\n"
        "what was added, removed or changed; or two pictures, .exr or .png, channel by channel. Exit code 0: the\n"
        "same, 1: different.",
    .examples = "  conus diff rays.tsv gl.tsv --tolerance 1e-4\n"
                "  conus diff today.exr yesterday.exr\n",
    .groups = groups,
    .settings_size = sizeof(struct diff_settings),
    .run = run_diff,
};
