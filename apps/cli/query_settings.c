/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of conus query's options, and the checks of what stands together. */
#include "cli/query_settings.h"

#include "options/messages.h"
#include "options/output.h"

static const char *const voxel_kinds[] = {"pathways", "all", NULL};

static const struct option point_options[] = {
    {.name = "point",
     .type = OPTION_VECTOR,
     .offset = offsetof(struct query_settings, point),
     .value = "X,Y,Z",
     .help = "instead of a cone, what is at this point, mm, and within --radius MM of it, or as far as the nearest "
             "neighbour",
     .words = "coordinate, whereami"},
    {0},
};

static const struct option output_options[] = {
    {.name = "voxels",
     .type = OPTION_TEXT,
     .offset = offsetof(struct query_settings, voxels),
     .value = "FILE.tsv",
     .help = "write the voxels hit first, or with --layers all or --point those in the cone or ball and the points of "
             "streamlines there, with indices, positions and values"},
    {.name = "voxels-of",
     .type = OPTION_CHOICE,
     .offset = offsetof(struct query_settings, voxels_of),
     .value = "KIND",
     .help = "whose voxels:",
     .choices = voxel_kinds},
    {.name = "image",
     .type = OPTION_TEXT,
     .offset = offsetof(struct query_settings, image),
     .value = "FILE",
     .help = "write the image seen from the device: .exr with id, X, Y, Z, t per pixel, or .png in the areas' colours",
     .words = "figure, picture"},
    {.name = "deep",
     .type = OPTION_TEXT,
     .offset = offsetof(struct query_settings, deep),
     .value = "FILE.exr",
     .help = "with --layers all: write every interval of every ray inside an object, as a deep image with names"},
    {0},
};

const struct option_group query_groups[] = {
    INQUIRY_AIM_GROUPS,
    {"", point_options, 0},
    INQUIRY_ENGINE_GROUPS,
    INQUIRY_ATLAS_GROUPS,
    INQUIRY_MORE_ATLASES,
    {"What is written", query_format_options, INQUIRY_FIELD(answer)},
    {"", answer_output_options, INQUIRY_FIELD(answer)},
    {"", axis_options, offsetof(struct query_settings, axis)},
    {"", endpoints_options, offsetof(struct query_settings, ends)},
    {"", connectivity_options, offsetof(struct query_settings, ends)},
    {"", output_options, 0},
    {"", mask_options, offsetof(struct query_settings, mask)},
    {"", streamlines_out_options, offsetof(struct query_settings, streamlines)},
    {"", quiet_options, INQUIRY_FIELD(common)},
    {0},
};

static bool check_outputs(const struct query_settings *settings, const struct arguments *arguments)
{
    static const char *const of_one_atlas[] = {"image", "deep", "mask", "streamlines-out"};
    conus_format format;
    if (settings->voxels && output_format(&format, settings->voxels) && format != CONUS_FORMAT_TSV &&
        format != CONUS_FORMAT_TABLE) {
        print_error_line("--voxels: %s ends as what it will not be: TSV is written", settings->voxels);
        return false;
    }
    for (size_t i = 0; i < sizeof of_one_atlas / sizeof of_one_atlas[0]; i++) {
        if (!options_exclude(arguments, "atlas", of_one_atlas[i])) {
            return false;
        }
    }
    if (!option_needs(arguments, "voxels-of", "voxels")) {
        return false;
    }
    if (!path_check_ending("image", settings->image, ".exr", ".png") ||
        !path_check_ending("deep", settings->deep, ".exr", NULL) ||
        !path_check_ending("streamlines-out", settings->streamlines.path, ".tck", NULL)) {
        return false;
    }
    if (settings->deep && settings->inquiry.engine.layers != CONUS_LAYERS_ALL) {
        print_error_line("--deep needs --layers all");
        return false;
    }
    return ends_check(&settings->ends, arguments) && mask_check(&settings->mask, arguments);
}

/* A point has a radius or none, and nothing that is only of cones. */
static bool check_point(const struct arguments *arguments)
{
    static const char *const of_cones[] = {"origin",   "toward", "direction",      "up",       "pose",
                                           "angle",    "layers", "range",          "engine",   "resolution",
                                           "aperture", "score",  "slices",         "sampling", "context",
                                           "image",    "deep",   "slice-fraction", "segments"};
    for (size_t i = 0; i < sizeof of_cones / sizeof of_cones[0]; i++) {
        if (!options_exclude(arguments, "point", of_cones[i])) {
            return false;
        }
    }
    return true;
}

bool query_settings_check(const struct query_settings *settings, const struct arguments *arguments)
{
    if (option_given(arguments, "point")) {
        return check_point(arguments) && settings_check_space(arguments, &settings->inquiry.aim.space) &&
               check_outputs(settings, arguments);
    }
    return inquiry_check(&settings->inquiry, arguments, false) && settings_check_aim(arguments, true) &&
           settings_check_pose_file(arguments, "pose", NULL) && check_outputs(settings, arguments);
}
