/* SPDX-License-Identifier: BSD-3-Clause */
/* conus batch: answers many poses with several threads. */
#include "cli/batch/batch.h"
#include "cli/commands.h"

static int run_batch(const void *given, const struct arguments *arguments)
{
    struct batch_settings settings = *(const struct batch_settings *)given;
    int code = settings_weight(&settings.aim, &settings.engine, arguments);
    code = code ? code : batch_dispatch(&settings, arguments);
    settings_weight_finish(&settings.engine);
    return code;
}

const struct command cmd_batch = {
    .name = "batch",
    .summary = "answer many poses, on one machine or many",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "--poses FILE",
    .description =
        "Answers every pose as conus query does, many at a time, in memory that does not grow with their\n"
        "number. The rows come in the order of the poses and are the same, byte for byte, for any number of\n"
        "threads or parts. A pose that has no answer gets a row of kind \"error\" that says why, and the\n"
        "exit code is 1 at the end.",
    .examples = "  conus batch aal.nii.gz --poses poses.tsv -o rows.tsv\n"
                "  conus batch aal.nii.gz --poses poses.tsv --shard 3/16 -o rows.tsv\n"
                "  conus batch aal.nii.gz --poses poses.tsv --shard all/16 -o rows.tsv\n",
    .see_also = "  conus verify    answers a result again, and compares\n",
    .answers = true,
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
    .run = run_batch,
};
