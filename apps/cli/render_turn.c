/* SPDX-License-Identifier: BSD-3-Clause */
/* Frames of a turntable: the camera goes around the atlas in equal steps. */
#include "cli/cmd_render.h"

#include "base/system/system.h"
#include "options/messages.h"

#include "conus/atlas.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double RADIANS = 0.017453292519943295; /* of a degree */
#define FULL_TURN 360

/* Where the first camera is, degrees above the horizon, and how much room is around the ball. */
static const double ABOVE = 15;
static const double ROOM = 1.1;

/* Half the field of view that is the default, and how much of the picture is filled where it is fitted. */
static const double UPWARD_DEGREES = 15;
static const double FILLED = 0.92;

const struct option turn_options[] = {
    {OPTION_VALUED("frames", struct turn_settings, frames, "N"),
     .help = "a turntable: so many pictures, the camera going around the atlas; {frame} in --output stands for the "
             "number of each",
     OPTION_FROM_TO(1, 9999), .words = "turntable, animation, movie, rotate, spin", .excludes = "view,frustum"},
    {OPTION_DEGREES("turn", struct turn_settings, degrees),
     .help = "how far it goes in all frames, positive from the front over the left to the back",
     .standard = OPTION_DIGITS(FULL_TURN), OPTION_FROM_TO(-3600, 3600), .needs = "frames"},
    {0},
};

bool turn_check(const struct turn_settings *settings, const char *output, const struct arguments *arguments)
{
    bool has_word = strstr(output, TURN_FRAME);
    if (option_given(arguments, "turn") && settings->degrees == 0) {
        return refuse("--turn: 0 turns nothing, other angles are allowed");
    }
    if (settings->frames && !has_word) {
        print_error_line("--output: " TURN_FRAME " is missing, as in turn-" TURN_FRAME ".png");
    } else if (!settings->frames && has_word) {
        print_error_line("--output: " TURN_FRAME " stands for the pictures of a turntable, --frames N");
    }
    return has_word == (settings->frames > 0);
}

/* From in front, at the distance at which the ball fits between the nearer edges. */
static conus_status find_start(conus_pose *out, const double centre[3], double radius, const conus_view *view)
{
    static const double up[3] = {0, 0, 1};
    double upward = RADIANS * (view->field_of_view > 0 ? view->field_of_view / 2 : UPWARD_DEGREES);
    double aspect = view->width && view->height ? (double)view->width / view->height : 1;
    double across = atan(tan(upward) * aspect);
    double distance = ROOM * radius / sin(fmin(upward, across));
    const double origin[3] = {centre[0], centre[1] + distance * cos(ABOVE * RADIANS),
                              centre[2] + distance * sin(ABOVE * RADIANS)};
    return conus_pose_toward(out, origin, centre, up);
}

conus_status turn_camera(conus_pose *out, const struct turn_settings *settings, uint32_t frame, const conus_pose *start,
                         const conus_atlas *atlas, const conus_view *view)
{
    double low[3], high[3], centre[3], radius = 0;
    conus_pose first;
    conus_status status = conus_atlas_bounds(low, high, atlas);
    if (status) {
        return status;
    }
    for (int a = 0; a < 3; a++) {
        centre[a] = (low[a] + high[a]) / 2;
        radius = hypot(radius, (high[a] - low[a]) / 2);
    }
    status = start ? CONUS_OK : find_start(&first, centre, radius, view);
    first = start ? *start : first;
    if (status) {
        return status;
    }
    double degrees = (settings->degrees != 0 ? settings->degrees : FULL_TURN) * frame / settings->frames;
    double c = cos(degrees * RADIANS);
    double s = sin(degrees * RADIANS);
    double turned[16];
    for (int column = 0; column < 4; column++) {
        const double *m = first.world_from_device + 4 * column;
        bool is_place = column == 3;
        double x = m[0] - (is_place ? centre[0] : 0);
        double y = m[1] - (is_place ? centre[1] : 0);
        turned[4 * column] = c * x - s * y + (is_place ? centre[0] : 0);
        turned[4 * column + 1] = s * x + c * y + (is_place ? centre[1] : 0);
        turned[4 * column + 2] = m[2];
        turned[4 * column + 3] = m[3];
    }
    return conus_pose_from_matrix(out, turned);
}

/* The farthest pixel in which there is something, from the middle, as a part of the way to the picture's edge: across
 * of a width that is narrower by `room`, and upward. */
static double reach_of(const conus_image *image, double room)
{
    const uint32_t width = conus_image_width(image);
    const uint32_t height = conus_image_height(image);
    const float *opacity = conus_image_floats(image, "A");
    double reach = 0;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++, opacity++) {
            const double across = (fabs(2.0 * x + 1 - width) + 1) / (room * width);
            const double upward = (fabs(2.0 * y + 1 - height) + 1) / height;
            reach = *opacity > 0 ? fmax(reach, fmax(across, upward)) : reach;
        }
    }
    return reach;
}

conus_status turn_fit(double *field_of_view, const conus_atlas *atlas, conus_renderer *renderer, const conus_view *view,
                      double room)
{
    enum { SIDES = 16, ACROSS = 160, UPWARD = 120 };
    static const struct turn_settings around = {.frames = SIDES};
    const double width = view->width ? view->width : ACROSS;
    const double height = view->height ? view->height : UPWARD;
    const double scale = ACROSS / fmax(width, height);
    double reach = 0;
    conus_status status = CONUS_OK;
    conus_view rough = *view;
    rough.width = (uint32_t)fmax(rint(scale * width), 1);
    rough.height = (uint32_t)fmax(rint(scale * height), 1);
    rough.dpi = 0;
    rough.no_legend = rough.draft = true;
    rough.print = rough.shapes = false;
    rough.background = CONUS_BACKGROUND_TRANSPARENT;
    rough.side = CONUS_SIDE_OF_CONE;
    for (uint32_t frame = 0; frame < SIDES && !status; frame++) {
        conus_image *image = NULL;
        conus_pose camera;
        status = turn_camera(&camera, &around, frame, NULL, atlas, view);
        rough.camera = &camera;
        status = status ? status : conus_render(&image, renderer, &rough);
        reach = status ? reach : fmax(reach, reach_of(image, room));
        conus_image_destroy(image);
    }
    *field_of_view = reach > 0 ? 2 * atan(tan(UPWARD_DEGREES * RADIANS) * reach / FILLED) / RADIANS : 0;
    return status;
}

char *turn_path(const char *pattern, const struct turn_settings *settings, uint32_t frame)
{
    struct system_text path;
    int digits = snprintf(NULL, 0, "%" PRIu32, settings->frames);
    FILE *out = system_text_open(&path);
    for (const char *c = pattern; out && *c;) {
        if (strncmp(c, TURN_FRAME, strlen(TURN_FRAME)) == 0) {
            fprintf(out, "%0*" PRIu32, digits, frame + 1);
            c += strlen(TURN_FRAME);
        } else {
            fputc(*c++, out);
        }
    }
    return system_text_close(&path);
}
