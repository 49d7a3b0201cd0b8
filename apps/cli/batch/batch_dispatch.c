/* SPDX-License-Identifier: BSD-3-Clause */
/* Dispatches a command line: one batch, and each of its files. */
#include "cli/batch/batch.h"

#include "cli/batch/parts.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdlib.h>

/* The more serious of two exit codes. */
static int worse_code(int a, int b)
{
    return a == EXIT_DONE || (a == EXIT_DIFFERENT && b != EXIT_DONE) ? b : a;
}

/* An output file of one batch, and the kind of its rows; NULL = answers. */
struct batch_output {
    const char *path;
    const struct rows_kind *kind;
};

static const char *option_of(const struct batch_output *output)
{
    return output->kind ? output->kind->option : "output";
}

/* Whether they are two files with two sidecars: rows.tsv and rows.csv have one, rows.json. */
static bool outputs_differ_from(const struct batch_output *one, const struct batch_output *other)
{
    if (output_is_stdout(one->path) ? output_is_stdout(other->path) : paths_equal(one->path, other->path)) {
        return refuse("--%s and --%s are the same file", option_of(one), option_of(other));
    }
    if (output_is_stdout(one->path) || output_is_stdout(other->path)) {
        return true;
    }
    char *sidecar = provenance_path(one->path);
    char *its = provenance_path(other->path);
    bool shared = sidecar && its && paths_equal(sidecar, its);
    if (shared) {
        print_error_line("--%s and --%s have one sidecar, %s; give them other names", option_of(one), option_of(other),
                         sidecar);
    }
    free(sidecar);
    free(its);
    return !shared;
}

/* Checks several outputs: each one is a run of its own over the same poses. */
static bool check_outputs_differ(const struct batch_output *outputs, size_t count, const char *poses)
{
    for (size_t i = 1; i < count; i++) {
        for (size_t k = 0; k < i; k++) {
            if (!outputs_differ_from(&outputs[k], &outputs[i])) {
                return false;
            }
        }
    }
    if (count > 1 && poses_are_no_file(poses)) {
        return refuse("--%s besides --%s reads the poses once more: it needs a file of poses, not %s",
                      option_of(&outputs[1]), option_of(&outputs[0]),
                      poses_are_stdin(poses) ? "standard input" : "a pipe");
    }
    return true;
}

int batch_dispatch(const struct batch_settings *settings, const struct arguments *arguments)
{
    struct batch_output outputs[1 + ROWS_KINDS] = {{settings->output, NULL}};
    size_t count = settings->output != NULL;
    for (size_t i = 0; i < ROWS_KINDS; i++) {
        const char *path = option_text(arguments, rows_kinds[i].option);
        if (path) {
            outputs[count++] = (struct batch_output){path, &rows_kinds[i]};
        }
    }
    count = count ? count : 1; /* the answers, on standard output */
    struct shard part = {0, 1, false};
    int code = check_outputs_differ(outputs, count, settings->poses) ? EXIT_DONE : EXIT_USAGE;
    code = code ? code : shard_read(&part, settings->shard, settings->common.quiet);
    for (size_t i = 0; i < count && (code == EXIT_DONE || code == EXIT_DIFFERENT); i++) {
        struct batch_settings own = *settings;
        own.output = outputs[i].path;
        own.of_axis = outputs[i].kind;
        own.part = part;
        own.is_again = i > 0;
        own.common.quiet = settings->common.quiet || i > 0; /* the notes are said */
        code = worse_code(code, batch_answer(&own, arguments));
    }
    return code;
}
