/* SPDX-License-Identifier: BSD-3-Clause */
/* conus mesh: writes a surface mesh of each area. */
#include "base/system/system.h"
#include "cli/commands.h"
#include "conus/own.h"
#include "options/messages.h"
#include "settings/settings.h"

struct mesh_settings {
    struct common_settings common;
    const char *output;
    struct atlas_settings atlas;
    uint32_t smooth;
    double pass_band;
    double decimate;
    size_t format; /* conus_mesh_format */
};

static const char *const formats[] = {"gii", "vtp", "obj", "ply", "stl", NULL};

static const struct option own_options[] = {
    {OPTION_VALUED("output", struct mesh_settings, output, "DIR"), .letter = 'o',
     .help = "folder for the files, LABEL_Name.gii and so on; made if missing", .required = true,
     .words = "save, export", .common = true, OPTION_WRITING(FOLDER)},
    {OPTION_VALUED("smooth", struct mesh_settings, smooth, "N"),
     .help = "iterations of windowed-sinc smoothing, 0 to 1000; 0 leaves the voxels' steps", .standard = "5",
     OPTION_FROM_TO(0, 1000), .common = true},
    {OPTION_VALUED("pass-band", struct mesh_settings, pass_band, "B"),
     .help = "pass band of the smoothing, 0.001 to 2; less is smoother", .standard = "0.7", OPTION_FROM_TO(0.001, 2)},
    {OPTION_VALUED("decimate", struct mesh_settings, decimate, "R"),
     .help = "remove this part of the triangles, 0 to 0.99", .standard = "0", OPTION_FROM_TO(0, 0.99),
     .words = "simplify", .common = true},
    {OPTION_VALUED("format", struct mesh_settings, format, "FORMAT"),
     .help = "format of the files; gii is GIFTI:", .choices = formats, .words = "STL, OBJ, 3-D print", .common = true},
    {OPTION_VALUED("labels", struct mesh_settings, atlas.labels, "FILE[,label=COLUMN,name=COLUMN]"),
     .help = "label table; replaces the one found beside or inside the atlas; columns of a header row that are not "
             "called as usual are given by their names",
     OPTION_READING(LABELS)},
    {OPTION_NAMED("labels-anyway", struct mesh_settings, atlas.labels_anyway),
     .help = "treat every value as a label, even if the volume looks like an image"},
    {OPTION_VALUED("atlas-transform", struct mesh_settings, atlas.transforms, "FILE[,from=IMAGE,to=IMAGE][,inverse]"),
     .help = "surfaces where the atlas lies after it was brought to the poses, as conus query does; may be repeated",
     OPTION_READING(TRANSFORM)},
    {OPTION_MEMORY(struct mesh_settings, atlas.max_memory),
     .help = "largest file or volume to accept, and memory of conus-mesh", .standard = "8G"},
    {OPTION_NAMED("quiet", struct mesh_settings, common.quiet), .letter = 'q',
     .help = "print only errors and warnings on stderr, no notes and no progress", .role = OPTION_OF_RUN},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct mesh_settings, common)},
    {0},
};

static bool show_progress(void *user, size_t done, size_t total)
{
    (void)user;
    fprintf(stderr, "\r%zu of %zu meshes%s", done, total, done == total ? "\n" : "");
    fflush(stderr);
    return true;
}

static int run_mesh(const void *given, const struct arguments *arguments)
{
    const struct mesh_settings *settings = given;
    const conus_mesh_options options = {
        .format = (conus_mesh_format)settings->format,
        .smooth = settings->smooth,
        .no_smoothing = option_given(arguments, "smooth") && settings->smooth == 0,
        .pass_band = settings->pass_band,
        .decimate = settings->decimate,
        .max_memory = settings->atlas.max_memory,
        .progress = !settings->common.quiet && system_is_terminal(STDERR_FILENO) ? show_progress : NULL,
        .log = settings->common.quiet ? log_note_quiet : log_note,
    };
    if (options.no_smoothing && option_given(arguments, "pass-band")) {
        return print_usage_error("--pass-band has no effect with --smooth 0");
    }
    struct atlas_settings areas = settings->atlas;
    areas.answers = true;
    conus_atlas *atlas = NULL;
    int code = atlas_input_load(&atlas, arguments->operands[0], &areas);
    if (!code) {
        atlas_notes_say(atlas, &settings->common);
        code = print_status(conus_atlas_write_meshes(atlas, settings->output, &options));
    }
    conus_atlas_destroy(atlas);
    return code;
}

const struct command cmd_mesh = {
    .name = "mesh",
    .summary = "write a surface mesh of each area",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "-o DIR",
    .description =
        "Writes one closed triangle mesh per area, in world mm, named LABEL_Name. Runs conus-mesh, which is\n"
        "built where VTK is.",
    .examples = "  conus mesh aal.nii.gz -o aal-meshes\n"
                "  conus mesh aal.nii.gz -o print --format stl --smooth 20 --pass-band 0.1 --decimate 0.8\n",
    .groups = groups,
    .settings_size = sizeof(struct mesh_settings),
    .run = run_mesh,
};
