/* SPDX-License-Identifier: BSD-3-Clause */
/* Answers one batch, or each row of a table of batches. */
#include "batch/batch_jobs.h"

#include "batch/batch_table.h"
#include "common/messages.h"

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
               options_exclude(arguments, "jobs", "poses") && options_exclude(arguments, "jobs", "output");
    }
    if (!arguments->operand_count) {
        const char *program = arguments->command->program;
        print_error_line("ATLAS is missing; %s batch --help shows how", program ? program : "conus");
        return false;
    }
    return settings->poses || (print_error_line("--poses FILE is missing"), false);
}

int batch_jobs_answer(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                      void *user)
{
    if (!check_operands(settings, arguments)) {
        return EXIT_USAGE;
    }
    return settings->jobs ? answer_all(settings, arguments, answer, user) : answer(user, settings, arguments);
}
