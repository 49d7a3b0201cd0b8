/* SPDX-License-Identifier: BSD-3-Clause */
/* conus diff: compares two results row by row, or two pictures. */
#include "base/system/system.h"
#include "cli/answers/answers.h"
#include "cli/commands.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
#include "settings/settings.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t DEFAULT_MEMORY = UINT64_C(4) << 30;

struct diff_settings {
    struct common_settings common;
    double tolerance;
    uint64_t max_memory;
};

static const struct option own_options[] = {
    {OPTION_VALUED("tolerance", struct diff_settings, tolerance, "T"),
     .help = "numbers that differ by T or less are the same; names and labels must be equal", .standard = "0",
     OPTION_FROM_TO(0, 1e30), .common = true},
    {OPTION_MEMORY(struct diff_settings, max_memory), .help = "largest table to read, like 512M or 2G",
     .standard = "4G"},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct diff_settings, common)},
    {0},
};

/* Cells of one row stand in one line. */
struct printing {
    FILE *out;
    size_t line; /* of the row whose cells are being printed; 0 = none */
};

static void print_difference(void *user, const struct difference *difference)
{
    struct printing *printing = user;
    bool is_cell = strcmp(difference->what, "changed") == 0;
    bool goes_on = is_cell && printing->line == difference->line;
    fputs(printing->line && !goes_on ? "\n" : "", printing->out);
    printing->line = is_cell ? difference->line : 0;
    if (is_cell) {
        fprintf(printing->out, goes_on ? "," : "changed   %s:", difference->where);
        fprintf(printing->out, " %s %s -> %s", difference->column, difference->before, difference->after);
    } else if (difference->column) {
        fprintf(printing->out, "column    %s is only in %s\n", difference->column, difference->where);
    } else {
        fprintf(printing->out, "%-8s  %s\n", difference->what, difference->where);
    }
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
        struct differences found = {0};
        struct system_text text;
        struct printing printing = {.out = system_text_open(&text)};
        if (printing.out) {
            tables_compare(&found, &first, &second, settings->tolerance, print_difference, &printing);
            fprintf(printing.out, "%s%zu rows the same, %zu changed, %zu removed, %zu added\n",
                    printing.line ? "\n" : "", found.same, found.changed, found.removed, found.added);
        }
        code = output_end(&text);
        bool differ = found.columns + found.changed + found.removed + found.added > 0;
        code = code ? code : differ ? EXIT_DIFFERENT : EXIT_DONE;
    }
    results_finish(&first);
    results_finish(&second);
    return code;
}

static int diff_pictures(const char *a, const char *b, double tolerance)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    int code = out ? pictures_compare(out, a, b, tolerance) : EXIT_DONE;
    if (out && code > EXIT_DIFFERENT) {
        system_text_close(&text);
        free(text.data);
        return code;
    }
    int written = output_end(&text);
    return written ? written : code;
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
    .holds = {HOLDS_ROWS, HOLDS_ROWS},
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
