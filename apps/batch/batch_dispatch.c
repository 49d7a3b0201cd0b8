/* SPDX-License-Identifier: BSD-3-Clause */
/* Dispatches a command line: one batch, each row of a table of batches, or several files of one batch. */
#include "batch/batch_dispatch.h"

#include "batch/batch_jobs.h"
#include "conus/file.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdlib.h>

enum { TABLE_LIMIT = 1 << 26 }; /* bytes */

/* The more serious of two exit codes. */
static int worse_code(int a, int b)
{
    return a == EXIT_DONE || (a == EXIT_DIFFERENT && b != EXIT_DONE) ? b : a;
}

static bool is_signal(int code)
{
    return code >= 128;
}

static int answer_table(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                        void *user)
{
    char *text = NULL;
    size_t size = 0;
    struct batch_jobs jobs;
    struct shard shard;
    uint64_t first = 0;
    uint64_t count = 0;
    int code = batch_shard(&shard, settings);
    code = code ? code : input_file_read(&text, &size, settings->jobs, INPUT_FILE_OR_PIPE, TABLE_LIMIT);
    code = code ? code : batch_jobs_parse(&jobs, settings->jobs, text, size);
    if (code) {
        return code;
    }
    conus_inputs_add(settings->jobs);
    for (uint64_t i = 0; i < jobs.count; i++) { /* what a batch writes is not read by a later one */
        conus_inputs_add(jobs.jobs[i].poses);
        conus_inputs_add(jobs.jobs[i].atlas);
    }
    int last = EXIT_DONE;
    shard_range(&first, &count, shard, jobs.count);
    for (uint64_t i = first; i < first + count && jobs.jobs && !is_signal(last); i++) {
        struct batch_settings own = *settings;
        struct arguments aimed = *arguments;
        own.poses = jobs.jobs[i].poses;
        own.output = jobs.jobs[i].output;
        own.shard = "0/1";
        aimed.operands[0] = jobs.jobs[i].atlas;
        warnings_forget();
        last = answer(user, &own, &aimed);
        code = worse_code(code, last);
    }
    batch_jobs_finish(&jobs);
    return is_signal(last) ? last : code;
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

static int answer_outputs(const struct batch_settings *settings, const struct arguments *arguments,
                          batch_answer *answer, void *user)
{
    struct batch_output outputs[1 + AXIS_FILES] = {{settings->output, NULL}};
    size_t count = settings->output != NULL;
    for (size_t i = 0; i < AXIS_FILES; i++) {
        if (settings->axis.files[i]) {
            outputs[count++] = (struct batch_output){settings->axis.files[i], &settings_axis_rows[i]};
        }
    }
    count = count ? count : 1; /* the answers, on standard output */
    int code = check_outputs_differ(outputs, count, settings->poses) ? EXIT_DONE : EXIT_USAGE;
    for (size_t i = 0; i < count && (code == EXIT_DONE || code == EXIT_DIFFERENT); i++) {
        struct batch_settings own = *settings;
        own.output = outputs[i].path;
        own.of_axis = outputs[i].kind;
        own.is_again = i > 0;
        own.common.quiet = settings->common.quiet || i > 0; /* the notes are said */
        code = worse_code(code, answer(user, &own, arguments));
    }
    return code;
}

int batch_dispatch(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                   void *user)
{
    if (settings->jobs && arguments->operand_count) {
        return print_usage_error("ATLAS and --jobs exclude each other");
    }
    if (settings->jobs) {
        return answer_table(settings, arguments, answer, user);
    }
    if (!arguments->operand_count) {
        const char *program = arguments->command->program;
        return print_usage_error("ATLAS is missing; %s batch --help shows how", program ? program : "conus");
    }
    if (!settings->poses) {
        return print_usage_error("--poses FILE is missing");
    }
    return answer_outputs(settings, arguments, answer, user);
}
