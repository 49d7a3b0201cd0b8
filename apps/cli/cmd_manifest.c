/* SPDX-License-Identifier: BSD-3-Clause */
/* conus manifest: writes the first manifest of a folder. */
#include "base/path.h"
#include "base/system/system.h"
#include "cli/commands.h"
#include "conus/own.h"
#include "options/messages.h"
#include "settings/settings.h"

#include <stdlib.h>
#include <string.h>

struct manifest_settings {
    struct common_settings common;
    const char *name;
    uint64_t max_memory;
};

static const struct option own_options[] = {
    {OPTION_VALUED("name", struct manifest_settings, name, "NAME"), .help = "write DIR/NAME.atlas.json",
     .otherwise = "the folder's name", .words = "save", .common = true, .role = OPTION_ASKS},
    {OPTION_MEMORY(struct manifest_settings, max_memory), .help = "largest file or volume to read, like 512M or 2G",
     .standard = "8G"},
    {OPTION_NAMED("quiet", struct manifest_settings, common.quiet), .letter = 'q',
     .help = "do not print each file's role on stderr", .role = OPTION_OF_RUN},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct manifest_settings, common)},
    {0},
};

static int write_manifest(const char *folder, const char *name, const struct manifest_settings *settings)
{
    const conus_manifest_options options = {.max_memory = settings->max_memory,
                                            .log = settings->common.quiet ? log_note_quiet : log_note};
    char *path = NULL;
    if (asprintf(&path, "%s%s%s.atlas.json", folder, path_joint(folder, strlen(folder)), name) < 0) {
        return print_no_memory();
    }
    conus_status status = conus_manifest_write(path, &options);
    int code = print_status(status);
    if (!status) {
        if (system_is_terminal(STDOUT_FILENO)) { /* a script takes the name as it is */
            conus_plain_text(path);
        }
        printf("%s\n", path);
    }
    free(path);
    return code;
}

static int run_manifest(const void *given, const struct arguments *arguments)
{
    const struct manifest_settings *settings = given;
    const char *folder = arguments->operands[0];
    if (settings->name && (!path_is_name(settings->name) || !settings->name[0])) {
        return print_usage_error("--name: \"%s\", a name without / is needed", settings->name);
    }
    if (settings->name) {
        return write_manifest(folder, settings->name, settings);
    }
    char full[SYSTEM_PATH];
    if (!system_real_path(full, folder)) {
        return print_data_error("%s: there is no such folder", folder);
    }
    const char *own = path_base(full);
    return write_manifest(folder, own[0] ? own : "atlas", settings);
}

const struct command cmd_manifest = {
    .name = "manifest",
    .summary = "write a first manifest of the volumes and surfaces in a folder",
    .operands = {"DIR"},
    .holds = {HOLDS_FOLDER},
    .description =
        "Reads the volumes, FSL atlases, surfaces and BrainGlobe folders in DIR, and the surfaces in the\n"
        "folders in it, and writes a manifest that joins them: DIR/NAME.atlas.json, an ATLAS for all other\n"
        "commands. Guesses the role of each file and prints it; correct it in the manifest. conus info checks\n"
        "the result. An existing manifest is never replaced.",
    .examples = "  conus manifest my-atlas\n"
                "  conus info my-atlas/my-atlas.atlas.json\n",
    .groups = groups,
    .settings_size = sizeof(struct manifest_settings),
    .run = run_manifest,
};
