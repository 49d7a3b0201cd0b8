/* SPDX-License-Identifier: BSD-3-Clause */
/* conus render: draws an atlas, with or without a cone, into a picture file. */
#include "cli/commands.h"
#include "common/messages.h"
#include "common/output.h"
#include "settings/aim_notes.h"
#include "settings/atlas_input.h"
#include "settings/atlas_notes.h"
#include "settings/pose_settings.h"

#include <string.h>

struct render_settings {
    struct atlas_settings atlas;
    struct aim_settings aim;
    struct pose_file_settings file;
    struct engine_settings engine;
    struct common_settings common;
    const char *output;
    uint32_t size[2];
    uint32_t slices;
    const char *camera;
    double camera_origin[3], camera_toward[3], camera_up[3];
    double field_of_view; /* degrees */
    double frustum[4];
    const char *context;
    const char *transfer;
    bool no_skipping, no_legend;
};

static const struct option picture_options[] = {
    {.name = "output",
     .letter = 'o',
     .type = OPTION_TEXT,
     .offset = offsetof(struct render_settings, output),
     .value = "FILE",
     .help = ".png, or .exr with linear light as float",
     .required = true},
    {.name = "size",
     .type = OPTION_SIZE,
     .offset = offsetof(struct render_settings, size),
     .value = "WxH",
     .help = "pixels, each 1 to 16384 (default 1400x1050)",
     .low = 1,
     .high = 16384},
    {.name = "camera",
     .type = OPTION_TEXT,
     .offset = offsetof(struct render_settings, camera),
     .value = "FILE",
     .help = "camera at the one pose in this file (docs/formats.md)"},
    {.name = "camera-origin",
     .type = OPTION_VECTOR,
     .offset = offsetof(struct render_settings, camera_origin),
     .value = "X,Y,Z",
     .help = "or position of the camera, mm (default: the whole atlas from the cone's side)"},
    {.name = "camera-toward",
     .type = OPTION_VECTOR,
     .offset = offsetof(struct render_settings, camera_toward),
     .value = "X,Y,Z",
     .help = "point at which the camera points, mm"},
    {.name = "camera-up",
     .type = OPTION_VECTOR,
     .offset = offsetof(struct render_settings, camera_up),
     .value = "X,Y,Z",
     .help = "up direction of the camera"},
    {.name = "field-of-view",
     .type = OPTION_NUMBER,
     .offset = offsetof(struct render_settings, field_of_view),
     .value = "DEGREES",
     .help = "angle from the lower to the upper edge, more than 0 and less than 180 (default 30)",
     .low = 0,
     .high = 180,
     .open = true},
    {.name = "frustum",
     .type = OPTION_EDGES,
     .offset = offsetof(struct render_settings, frustum),
     .value = "L,R,B,T",
     .help = "or edges of the camera's picture (left, right, bottom, top) at depth 1: off-axis, for a screen that "
             "the eye is not centred on",
     .low = -1000,
     .high = 1000},
    {.name = "slices",
     .type = OPTION_COUNT,
     .offset = offsetof(struct render_settings, slices),
     .value = "N",
     .help = "planes across the view at which the volumes are sampled (default sqrt(2) times the longest edge)",
     .low = 1,
     .high = 65536},
    {.name = "context",
     .type = OPTION_TEXT,
     .offset = offsetof(struct render_settings, context),
     .value = "FILE",
     .help = "scalar map to draw around the areas, such as a T1"},
    {.name = "transfer",
     .type = OPTION_TEXT,
     .offset = offsetof(struct render_settings, transfer),
     .value = "NAME|FILE",
     .help = "colours and opacities of the context by its values: a preset or a file (docs/formats.md)"},
    {.name = "no-legend",
     .type = OPTION_FLAG,
     .offset = offsetof(struct render_settings, no_legend),
     .help = "leave out the text"},
    {.name = "no-skipping",
     .type = OPTION_FLAG,
     .offset = offsetof(struct render_settings, no_skipping),
     .help = "sample empty space, too: the same picture, slower"},
    {0},
};

static const struct option_group groups[] = {
    {"Picture", picture_options, 0},
    {"Cone to draw", aim_options, offsetof(struct render_settings, aim)},
    {"", pose_file_options, offsetof(struct render_settings, file)},
    {"", angle_options, offsetof(struct render_settings, aim)},
    {"", shape_options, offsetof(struct render_settings, engine)},
    {"How rays are traced", engine_options, offsetof(struct render_settings, engine)},
    {"Atlas", atlas_options, offsetof(struct render_settings, atlas)},
    {"", shown_options, offsetof(struct render_settings, atlas)},
    {"", quiet_options, offsetof(struct render_settings, common)},
    {0},
};

/** A picture under way. */
struct picture {
    const struct render_settings *settings;
    const struct arguments *arguments;
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
    conus_renderer *renderer;
    conus_image *image;
    conus_pose camera;
    bool has_camera, has_cone;
};

static void picture_finish(struct picture *picture)
{
    conus_image_destroy(picture->image);
    conus_renderer_destroy(picture->renderer);
    conus_selection_destroy(picture->selection);
    conus_selector_destroy(picture->selector);
    conus_atlas_destroy(picture->atlas);
}

static bool has_camera(const struct arguments *arguments)
{
    return option_given(arguments, "camera") || option_given(arguments, "camera-origin");
}

/* Options about the cone mean nothing without one. */
static bool check_cone(const struct render_settings *settings, const struct arguments *arguments)
{
    static const char *const of_cone[] = {"angle",          "space",  "resolution", "aperture", "engine",
                                          "layers",         "range",  "sampling",   "score",    "level",
                                          "slice-fraction", "radius", NULL};
    if (!settings_check_aim(arguments, false) || !settings_check_score(&settings->engine, false) ||
        !settings_check_shape(&settings->aim, &settings->engine, arguments)) {
        return false;
    }
    bool cone = option_given(arguments, "origin") || option_given(arguments, "pose");
    if (!cone && settings->atlas.hemispheres == CONUS_HEMISPHERES_MERGED) {
        print_error_line("--hemispheres merged has no effect without a cone: --origin or --pose");
        return false;
    }
    for (size_t i = 0; !cone && of_cone[i]; i++) {
        bool used = has_camera(arguments) && strcmp(of_cone[i], "space") == 0;
        if (option_given(arguments, of_cone[i]) && !used) {
            print_error_line("--%s has no effect without a cone: --origin or --pose", of_cone[i]);
            return false;
        }
    }
    return settings_check_slices(&settings->engine, arguments, "slice-fraction");
}

static bool check_frustum(const struct arguments *arguments)
{
    if (option_given(arguments, "frustum") && !has_camera(arguments)) {
        print_error_line("--frustum has no effect without a camera: --camera-origin or --camera");
        return false;
    }
    return true;
}

static bool check_camera(const struct arguments *arguments)
{
    return option_needs(arguments, "camera-toward", "camera-origin") &&
           option_needs(arguments, "camera-origin", "camera-toward") &&
           option_needs(arguments, "camera-up", "camera-origin") &&
           options_exclude(arguments, "camera", "camera-origin") &&
           options_exclude(arguments, "frustum", "field-of-view") && check_frustum(arguments);
}

static bool check_picture(const struct render_settings *settings, const struct arguments *arguments)
{
    return path_check_ending("output", settings->output, ".png", ".exr") && check_cone(settings, arguments) &&
           check_camera(arguments) && settings_check_pose_file(arguments, "pose", "camera") &&
           option_needs(arguments, "transfer", "context");
}

/* Reads the file's one pose. */
static int load_pose(conus_pose_row *out, const struct picture *picture, const char *path)
{
    const struct render_settings *settings = picture->settings;
    conus_pose_list *list = NULL;
    const conus_pose_options options =
        settings_pose_options(&settings->file, settings->aim.space, settings->atlas.max_memory);
    conus_status status = conus_pose_list_load(&list, path, &options);
    if (status) {
        return print_status(status);
    }
    size_t count = conus_pose_list_count(list);
    const conus_pose_row *row = conus_pose_list_row(list, 0);
    struct named_atlas atlas = {.atlas = picture->atlas};
    int code = settings_match_poses(list, path, &(struct atlases){&atlas, 1}, &settings->file, &settings->common);
    if (code) {
        conus_pose_list_destroy(list);
        return code;
    }
    if (count != 1) {
        code = print_usage_error("%s has %zu poses, a picture takes one", path, count);
    } else if (row->error || row->is_point) {
        print_error_line("%s:%zu: %s", path, row->line, row->error ? row->error : POINT_HAS_NO_DIRECTION);
        code = EXIT_DATA;
    } else {
        *out = *row;
    }
    conus_pose_list_destroy(list);
    return code;
}

static int find_camera(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    conus_pose_row row = {0};
    int code = EXIT_DONE;
    if (settings->camera) {
        code = load_pose(&row, picture, settings->camera);
        picture->camera = row.pose;
    } else if (option_given(picture->arguments, "camera-origin")) {
        code = settings_pose_toward(&picture->camera, settings->camera_origin, settings->camera_toward,
                                    option_given(picture->arguments, "camera-up") ? settings->camera_up : NULL,
                                    settings->aim.space);
    } else {
        return EXIT_DONE;
    }
    picture->has_camera = true;
    return code;
}

static int find_cone(struct picture *picture, conus_pose *pose, double *angle)
{
    const struct aim_settings *aim = &picture->settings->aim;
    *angle = settings_angle(aim, &picture->settings->engine);
    if (!aim->pose) {
        return settings_pose(pose, aim, picture->arguments);
    }
    conus_pose_row row = {0};
    int code = load_pose(&row, picture, aim->pose);
    if (code) {
        return code;
    }
    if (row.angle != 0 && aim->angle != 0) {
        return print_usage_error("--angle has no effect: the pose in %s has its own", aim->pose);
    }
    *pose = row.pose;
    *angle = row.angle != 0 ? row.angle : *angle;
    return EXIT_DONE;
}

static int load_atlas(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    int code = settings_load_atlas(&picture->atlas, picture->arguments->operands[0], &settings->atlas);
    code = code ? code : settings_load_context(picture->atlas, settings->context, 0, &settings->atlas);
    if (code) {
        return code;
    }
    const struct input inputs[] = {{"the atlas", picture->arguments->operands[0]},
                                   {"the label table", settings->atlas.labels},
                                   {"the file of poses", settings->aim.pose},
                                   {"the camera's pose", settings->camera},
                                   {"the transfer function", settings->transfer},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {0}};
    const char *input = settings_input(picture->atlas, inputs, settings->output);
    return input ? print_usage_error("--output would overwrite %s %s", input, settings->output) : EXIT_DONE;
}

static int aim_cone(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    conus_pose pose;
    double angle;
    int code = find_cone(picture, &pose, &angle);
    if (code) {
        return code;
    }
    struct engine_settings engine = settings->engine;
    engine.slices = engine.sampling == CONUS_SAMPLING_SLICES ? settings->slices : 0;
    const conus_selector_options options = settings_engine(&engine, &settings->common);
    conus_status status = conus_selector_create(&picture->selector, picture->atlas, &options);
    if (!status) {
        status = conus_select(&picture->selection, picture->selector, &pose, angle);
    }
    if (status) {
        return print_status(status);
    }
    aim_notes_of(&pose, angle, picture->selector, picture->atlas, &settings->common);
    return EXIT_DONE;
}

static int draw_picture(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    const conus_renderer_options options = {.transfer = settings->transfer,
                                            .max_memory = settings->atlas.max_memory,
                                            .log = settings->common.verbose ? log_line : NULL};
    conus_status status = conus_renderer_create(&picture->renderer, picture->atlas, &options);
    if (status) {
        return print_status(status);
    }
    if (settings->common.verbose) {
        print_error_line("OpenGL: %s", conus_renderer_device(picture->renderer));
    }
    const double *f = settings->frustum;
    const conus_view view = {.width = settings->size[0],
                             .height = settings->size[1],
                             .slices = settings->slices,
                             .field_of_view = radians(settings->field_of_view),
                             .frustum = {f[0], f[1], f[2], f[3]},
                             .camera = picture->has_camera ? &picture->camera : NULL,
                             .selection = picture->selection,
                             .no_skipping = settings->no_skipping,
                             .no_legend = settings->no_legend};
    status = conus_render(&picture->image, picture->renderer, &view);
    if (!status) {
        status = conus_image_write(picture->image, settings->output);
    }
    return status ? print_status(status) : EXIT_DONE;
}

static int run_render(const void *given, const struct arguments *arguments)
{
    const struct render_settings *settings = given;
    if (!check_picture(settings, arguments)) {
        return EXIT_USAGE;
    }
    struct picture picture = {.settings = settings, .arguments = arguments};
    picture.has_cone = settings->aim.pose || option_given(arguments, "origin");
    int code = find_camera(&picture);
    if (!code) {
        code = load_atlas(&picture);
    }
    if (!code && picture.has_cone) {
        code = aim_cone(&picture);
    }
    if (!code) {
        code = draw_picture(&picture);
    }
    if (!code) {
        settings_say_notes(picture.atlas, &settings->common);
    }
    picture_finish(&picture);
    return code;
}

static void list_transfers(FILE *out)
{
    const char *preset;
    fputs("Presets of --transfer:", out);
    for (size_t i = 0; (preset = conus_transfer_preset(i)); i++) {
        fprintf(out, " %s", preset);
    }
    fputs("\n\n", out);
    help_scores(out);
}

const struct command cmd_render = {
    .name = "render",
    .summary = "draw the atlas, a cone in it and the cone's first hits",
    .operands = {"ATLAS"},
    .form = "-o FILE",
    .description = "Draws the areas and pathways, the context volume around them, and a cone with its axis, contacts\n"
                   "and a legend of its first hits. Needs OpenGL 4.5, in hardware or software.",
    .examples = "  conus render aal.nii.gz -o aal.png --context ch2bet.nii.gz\n"
                "  conus render aal.nii.gz -o cone.png --origin -90,20,20 --toward 0,-10,10 --angle 20\n"
                "  conus render aal.nii.gz -o top.exr --camera-origin 0,0,500 --camera-toward 0,0,0\n",
    .groups = groups,
    .settings_size = sizeof(struct render_settings),
    .more_help = list_transfers,
    .run = run_render,
};
