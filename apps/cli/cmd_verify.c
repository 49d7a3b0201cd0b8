/* SPDX-License-Identifier: BSD-3-Clause */
/* conus verify: answers a result again from its sidecar, and says whether it is the same, or why not. */
#include "cli/commands.h"
#include "cli/verify/verify.h"
#include "settings/settings.h"

struct verify_choices {
    struct common_settings common;
    struct verify_settings verify;
    size_t format;
};

static const char *const formats[] = {"table", "json", NULL};

static const struct option own_options[] = {
    {OPTION_VALUED("sidecar", struct verify_choices, verify.sidecar, "FILE.json"),
     .help = "the sidecar of RESULT, if it is not beside it", .common = true, OPTION_READING(SIDECAR)},
    {OPTION_VALUED("folder", struct verify_choices, verify.folder, "FOLDER"),
     .help = "look here, too, for files that moved or have another name, by their SHA-256; they are looked for in the "
             "folder that conus ran in, as the path of RESULT tells, else in this one",
     .common = true, OPTION_READING(FOLDER)},
    {OPTION_VALUED("format", struct verify_choices, format, "FORMAT"),
     .help = "what is written: lines for people, or everything for programs:", .choices = formats},
    {OPTION_MEMORY(struct verify_choices, verify.max_memory),
     .help = "largest file to read, like 512M or 8G, whatever the sidecar asks for", .standard = "4G"},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct verify_choices, common)},
    {0},
};

static int run_verify(const void *given, const struct arguments *arguments)
{
    const struct verify_choices *settings = given;
    return verify_result(arguments->operands[0], &settings->verify, arguments->family, settings->format);
}

const struct command cmd_verify = {
    .name = "verify",
    .summary = "answer a result again from its sidecar and compare",
    .operands = {"RESULT"},
    .holds = {HOLDS_ROWS},
    .description =
        "RESULT is what query, batch, sweep, track, overlap, connect, plan, calibrate or positions wrote, with its\n"
        ".json beside it. Checks the SHA-256 of all that was read, answers again in a folder of its own, and\n"
        "compares. Exit code 0: identical, 1: something differs, and which row and why, 3: it cannot be answered\n"
        "again, and why.",
    .examples = "  conus verify answers.tsv\n"
                "  conus verify answers.tsv --folder /data/study\n",
    .groups = groups,
    .settings_size = sizeof(struct verify_choices),
    .run = run_verify,
};
