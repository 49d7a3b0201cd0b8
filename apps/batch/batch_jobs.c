/* SPDX-License-Identifier: BSD-3-Clause */
/* Answers one batch, or each row of a table of batches. */
#include "batch/batch_jobs.h"

#include "batch/batch_table.h"
#include "batch/batch_work.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdlib.h>

/* Of the exit codes of several batches the one that says most. */
static int worse(int a, int b)
{
    return a == EXIT_DONE || (a == EXIT_DIFFERENT && b != EXIT_DONE) ? b : a;
}

static bool is_signal(int code)
{
    return code >= 128;
}

static int answer_all(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                      void *user)
{
    struct batch_jobs jobs;
    struct shard shard;
    uint64_t first = 0;
    uint64_t count = 0;
    int code = batch_shard(&shard, settings);
    code = code ? code : batch_jobs_read(&jobs, settings->jobs);
    if (code) {
        return code;
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
        last = answer(user, &own, &aimed);
        code = worse(code, last);
    }
    batch_jobs_finish(&jobs);
    return is_signal(last) ? last : code;
}

static bool check_operands(const struct batch_settings *settings, const struct arguments *arguments)
{
    if (settings->jobs) {
        return (!arguments->operand_count || (print_error_line("ATLAS and --jobs exclude each other"), false)) &&
               options_exclude(arguments, "jobs", "poses") && options_exclude(arguments, "jobs", "output") &&
               options_exclude(arguments, "jobs", "segments");
    }
    if (!arguments->operand_count) {
        const char *program = arguments->command->program;
        print_error_line("ATLAS is missing; %s batch --help shows how", program ? program : "conus");
        return false;
    }
    return settings->poses || (print_error_line("--poses FILE is missing"), false);
}

/* rows.tsv and rows.csv have one sidecar, rows.json. */
static bool share_sidecar(const char *output, const char *segments)
{
    char *one = provenance_path(output);
    char *other = provenance_path(segments);
    bool shared = one && other && paths_equal(one, other);
    if (shared) {
        print_error_line("--output and --segments have one sidecar, %s; give them other names", one);
    }
    free(one);
    free(other);
    return shared;
}

/* Where there are both, rows and segments are two files of two runs over the same poses. */
static bool check_both(const struct batch_settings *settings)
{
    const char *segments = settings->axis.segments;
    if (output_is_stdout(settings->output) ? output_is_stdout(segments) : paths_equal(settings->output, segments)) {
        print_error_line("--output and --segments are the same file");
        return false;
    }
    if (!output_is_stdout(settings->output) && share_sidecar(settings->output, segments)) {
        return false;
    }
    if (work_is_pipe(settings->poses)) {
        print_error_line("--segments besides --output reads the poses once more: it needs a file of poses, not %s",
                         output_is_stdout(settings->poses) ? "standard input" : "a pipe");
        return false;
    }
    return true;
}

static int answer_outputs(const struct batch_settings *settings, const struct arguments *arguments,
                          batch_answer *answer, void *user)
{
    struct batch_settings own = *settings;
    int code = EXIT_DONE;
    if (!settings->axis.segments) {
        return answer(user, settings, arguments);
    }
    if (settings->output) {
        code = check_both(settings) ? answer(user, settings, arguments) : EXIT_USAGE;
        own.common.quiet = true; /* the notes are said */
    }
    own.of_segments = true;
    own.output = settings->axis.segments;
    return code == EXIT_DONE || code == EXIT_DIFFERENT ? worse(code, answer(user, &own, arguments)) : code;
}

int batch_jobs_answer(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                      void *user)
{
    if (!check_operands(settings, arguments)) {
        return EXIT_USAGE;
    }
    return settings->jobs ? answer_all(settings, arguments, answer, user)
                          : answer_outputs(settings, arguments, answer, user);
}
