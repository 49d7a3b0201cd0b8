/* SPDX-License-Identifier: BSD-3-Clause */
/* conus verify: answers a result again from its sidecar, and says whether it is the same, or why not. */
#include "cli/commands.h"
#include "cli/verify/verdict.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <stdlib.h>
#include <string.h>

struct verify_settings {
    struct common_settings common;
    struct verdict_settings verdict;
    size_t format;
};

static const char *const formats[] = {"table", "json", NULL};
static const char *const engines[] = {"rays", "gl", NULL};

#define FIELD(member) OPTION_AT(struct verify_settings, member)

static const struct option own_options[] = {
    {.name = "sidecar",
     FIELD(verdict.sidecar),
     .value = "FILE.json",
     .help = "the sidecar of RESULT, if it is not beside it",
     .common = true},
    {.name = "search",
     FIELD(verdict.folders),
     .value = "FOLDER",
     .help = "look here, and in the folders below, for files that are no longer where they were, by size and SHA-256; "
             "may be repeated",
     .common = true},
    {.name = "engine",
     FIELD(verdict.engine),
     .value = "NAME",
     .help = "answer with this engine in place of the one that was asked for:",
     .choices = engines},
    {.name = "format",
     FIELD(format),
     .value = "FORMAT",
     .help = "what is written: lines for people (the default), or everything for programs:",
     .choices = formats},
    {.name = "max-memory",
     .type = OPTION_BYTES,
     .offset = offsetof(struct verify_settings, verdict.max_memory),
     .value = "SIZE",
     .help = "largest RESULT to read, like 512M or 2G (default 4G)"},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct verify_settings, common)},
    {0},
};

/* A result that could not be compared is an error, but not in JSON. */
static int run_verify(const void *given, const struct arguments *arguments)
{
    static const int codes[] = {
        [VERDICT_IDENTICAL] = EXIT_DONE, [VERDICT_DIFFERENT] = EXIT_DIFFERENT, [VERDICT_NONE] = EXIT_DATA};
    const struct verify_settings *settings = given;
    struct verdict_settings own = settings->verdict;
    struct verdict verdict;
    own.engine_name = option_given(arguments, "engine") ? engines[own.engine] : NULL;
    int code = verdict_find(&verdict, arguments->operands[0], &own, arguments->family);
    if (!code && verdict.kind == VERDICT_NONE && !settings->format) {
        verdict_print_error(&verdict);
    } else if (!code) {
        char *text = settings->format ? verdict_json(&verdict) : verdict_text(&verdict);
        code = text ? output_write(NULL, text, strlen(text)) : print_no_memory();
        free(text);
    }
    code = code ? code : codes[verdict.kind];
    verdict_finish(&verdict);
    return code;
}

const struct command cmd_verify = {
    .name = "verify",
    .summary = "answer a result again from its sidecar and compare",
    .operands = {"RESULT"},
    .description =
        "RESULT is what query, batch, sweep, track or overlap wrote, with its .json beside it. Checks the\n"
        "SHA-256 of all that was read, answers again in a folder of its own, and compares byte for byte. Exit code\n"
        "0: identical, 1: something differs, and which row and why, 3: it cannot be answered again, and why.",
    .examples = "  conus verify answers.tsv\n"
                "  conus verify answers.tsv --search ~/atlases --search /data/study\n",
    .groups = groups,
    .settings_size = sizeof(struct verify_settings),
    .run = run_verify,
};
