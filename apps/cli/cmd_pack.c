/* SPDX-License-Identifier: BSD-3-Clause */
/* conus pack: writes an atlas as it is loaded to one file, which opens at once. */
#include "cli/commands.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <stdlib.h>

struct pack_settings {
    struct common_settings common;
    const char *output;
    bool force;
    struct atlas_settings atlas;
    struct context_choice context;
};

static const struct option own_options[] = {
    {OPTION_VALUED("output", struct pack_settings, output, "NAME.conus"), .letter = 'o', .help = "the file",
     .required = true, .endings = CONUS_PACK_ENDING, .words = "save, export, cache", .common = true,
     OPTION_WRITING(PACK)},
    {OPTION_NAMED("force", struct pack_settings, force), .help = "replace a file", .common = true,
     .role = OPTION_OF_RUN},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", atlas_options, offsetof(struct pack_settings, atlas)},
    {"", context_choice_options, offsetof(struct pack_settings, context)},
    {"", quiet_options, offsetof(struct pack_settings, common)},
    {0},
};

/* All that the process has read is what the pack is made of. */
static int save(const struct pack_settings *settings, const conus_atlas *atlas, const struct arguments *arguments)
{
    size_t count = 0;
    while (conus_inputs_at(count)) {
        count++;
    }
    const char **sources = calloc(count + 1, sizeof *sources);
    char *words = arguments_text(arguments);
    int code = sources && words ? EXIT_DONE : print_no_memory();
    for (size_t i = 0; sources && i < count; i++) {
        sources[i] = conus_inputs_at(i);
    }
    if (!code) {
        const conus_save_options options = {.words = words, .sources = sources, .source_count = count};
        code = print_status(conus_atlas_save(settings->output, atlas, &options));
    }
    free(words);
    free((void *)sources);
    return code;
}

static int run_pack(const void *given, const struct arguments *arguments)
{
    const struct pack_settings *settings = given;
    struct outputs outputs;
    conus_atlas *atlas = NULL;
    outputs_collect(&outputs, arguments);
    int code = outputs_spare_inputs(&outputs) ? outputs_check(&outputs, settings->force) : EXIT_USAGE;
    code = code ? code : atlas_input_load(&atlas, arguments->operands[0], &settings->atlas);
    code = code ? code : context_choice_load(atlas, &settings->context, &settings->atlas);
    code = code || outputs_spare_inputs(&outputs) ? code : EXIT_USAGE; /* of what was found by then, too */
    if (!code) {
        atlas_notes_say(atlas, &settings->common);
        code = save(settings, atlas, arguments);
    }
    conus_atlas_destroy(atlas);
    return code;
}

const struct command cmd_pack = {
    .name = "pack",
    .summary = "write an atlas to one file that opens at once",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "-o NAME.conus",
    .description =
        "Writes ATLAS, with what is added to it, as it is in memory: a pack. All commands take it as an ATLAS,\n"
        "with the same answers, and map it in place of reading, so that many processes share its memory. It is\n"
        "checked when it is opened, and a warning says if a file that it was packed from has changed since. It\n"
        "is for the own disk: it is larger than its sources, and for this kind of machine and of conus. What is\n"
        "asked of an atlas (--hemispheres, --only, --level) is given with the question.",
    .examples = "  conus pack aal -o aal.conus\n"
                "  conus query aal.conus --origin=-90,20,20 --toward=0,-10,10\n"
                "  conus pack my.atlas.json --streamlines whole-brain.tck -o my.conus\n",
    .groups = groups,
    .settings_size = sizeof(struct pack_settings),
    .run = run_pack,
};
