/* SPDX-License-Identifier: BSD-3-Clause */
/* conus phantom: writes synthetic atlases. */
#include "cli/commands.h"
#include "conus/own.h"
#include "options/messages.h"
#include "settings/settings.h"

#include <string.h>

struct phantom_settings {
    struct common_settings common;
    const char *output;
    uint32_t size;
    double spacing[3];
    double oblique; /* degrees */
    const char *flip;
};

static const struct option own_options[] = {
    {OPTION_VALUED("output", struct phantom_settings, output, "DIR"), .letter = 'o',
     .help = "folder for the files, KIND.nii.gz and so on; made if missing", .required = true, .words = "save, export",
     .common = true, OPTION_WRITING(FOLDER)},
    {OPTION_VALUED("size", struct phantom_settings, size, "N"), .help = "voxels along the longest edge, 16 to 512",
     .standard = "64", OPTION_FROM_TO(16, 512), .common = true},
    {OPTION_VALUED("spacing", struct phantom_settings, spacing, "X,Y,Z"), .help = "edge lengths of a voxel, mm",
     .standard = "1,1,1", OPTION_FROM_TO(0.001, 1000), .common = true, .unit = "mm"},
    {OPTION_DEGREES("oblique", struct phantom_settings, oblique),
     .help = "turn the grid by this angle about (1,1,1); the shapes stay where they are", OPTION_FROM_TO(-180, 180)},
    {OPTION_VALUED("flip", struct phantom_settings, flip, "AXES"),
     .help = "letters of x, y, z: voxel indices grow towards left, posterior, inferior there", .role = OPTION_ASKS},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct phantom_settings, common)},
    {0},
};

static const char *phantom_name(const void *list, size_t index)
{
    (void)list;
    const conus_phantom_info *phantom = conus_phantom(index);
    return phantom ? phantom->name : NULL;
}

static bool check_kind(const char *kind)
{
    const char *name;
    for (size_t i = 0; (name = phantom_name(NULL, i)); i++) {
        if (strcmp(name, kind) == 0) {
            return true;
        }
    }
    const char *near = closest_name(kind, phantom_name, NULL);
    if (near) {
        print_error_line("unknown phantom \"%s\"; did you mean %s?", kind, near);
    } else {
        print_error_line("unknown phantom \"%s\"; conus phantom --help lists them", kind);
    }
    return false;
}

static bool read_flip(bool flip[3], const char *axes)
{
    static const char known[] = "xyz";
    for (const char *c = axes; *c; c++) {
        const char *axis = strchr(known, *c);
        if (!axis || flip[axis - known]) {
            return refuse("--flip: \"%s\" is not letters of x, y, z, each at most once", axes);
        }
        flip[axis - known] = true;
    }
    return true;
}

static int run_phantom(const void *given, const struct arguments *arguments)
{
    const struct phantom_settings *settings = given;
    conus_phantom_options phantom = {.size = settings->size, .oblique = settings->oblique};
    memcpy(phantom.spacing, settings->spacing, sizeof phantom.spacing);
    if (!check_kind(arguments->operands[0]) || (settings->flip && !read_flip(phantom.flip, settings->flip))) {
        return EXIT_USAGE;
    }
    return print_status(conus_phantom_write(arguments->operands[0], settings->output, &phantom));
}

static void list_kinds(FILE *out)
{
    const conus_phantom_info *phantom;
    fputs("Kinds\n", out);
    for (size_t i = 0; (phantom = conus_phantom(i)); i++) {
        fprintf(out, "  %-26s  %s\n", phantom->name, phantom->description);
    }
}

const struct command cmd_phantom = {
    .name = "phantom",
    .summary = "write a synthetic atlas whose answers are known in closed form",
    .operands = {"KIND"},
    .form = "-o DIR",
    .description =
        "Writes an atlas of simple shapes, its label table and a description of the shapes in mm, from which\n"
        "every answer follows. KIND brain is a scene of surfaces, a pathway and a context with their manifest,\n"
        "brain.atlas.json; KIND bundle is a tractogram with its manifest, bundle.atlas.json. Both take none of\n"
        "the options of the grid.",
    .examples = "  conus phantom sphere -o phantoms\n"
                "  conus phantom torus -o phantoms --size 128 --spacing 1,1,2 --oblique 30 --flip x\n",
    .groups = groups,
    .settings_size = sizeof(struct phantom_settings),
    .more_help = list_kinds,
    .run = run_phantom,
};
