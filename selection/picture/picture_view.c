/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_render(): the picture of the atlas from a camera, with the cone in it. */
#include "selection/picture/picture.h"

#include "base/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/text.h"
#include "render/image/image.h"

#include <stdio.h>

enum { DEFAULT_WIDTH = 1400, DEFAULT_HEIGHT = 1050, SIDE_LIMIT = 16384, SLICE_LIMIT = 65536 };

static bool has_frustum(const conus_view *view)
{
    const double *f = view->frustum;
    return f[0] != 0 || f[1] != 0 || f[2] != 0 || f[3] != 0;
}

static conus_status check_frustum(const conus_view *view)
{
    const double *f = view->frustum;
    if (!has_frustum(view)) {
        return CONUS_OK;
    }
    if (!view->camera || view->field_of_view != 0) {
        return fail(CONUS_ERROR_ARGUMENT, "frustum: needs a camera, and no field of view");
    }
    for (int k = 0; k < 4; k += 2) {
        if (!(f[k] < f[k + 1] && f[k] >= -PICTURE_FRUSTUM_LIMIT && f[k + 1] <= PICTURE_FRUSTUM_LIMIT)) {
            return fail(CONUS_ERROR_ARGUMENT, "frustum: %g,%g,%g,%g; allowed is left < right, lower < upper, -%d to %d",
                        f[0], f[1], f[2], f[3], PICTURE_FRUSTUM_LIMIT, PICTURE_FRUSTUM_LIMIT);
        }
    }
    return CONUS_OK;
}

static conus_status fill_options(conus_view *out, const conus_view *view)
{
    conus_view options = *options_of(conus_view, view);
    conus_status status = check_frustum(&options);
    if (status) {
        return status;
    }
    options.width = options.width ? options.width : DEFAULT_WIDTH;
    options.height = options.height ? options.height : DEFAULT_HEIGHT;
    if (options.field_of_view == 0) {
        options.field_of_view = radians_from_degrees(30);
    }
    if (options.width > SIDE_LIMIT || options.height > SIDE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "picture of %u x %u pixels; allowed is 1 to %d", options.width,
                    options.height, SIDE_LIMIT);
    }
    if (!(options.field_of_view > 0 && options.field_of_view < MATH3_PI)) {
        return fail(CONUS_ERROR_ARGUMENT, "field of view of %g degrees; allowed is more than 0 and less than 180",
                    degrees_from_radians(options.field_of_view));
    }
    if (!(options.fade >= 0 && options.fade <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "fade of %g; allowed is 0 to 1", options.fade);
    }
    if (options.slices > SLICE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "%u slices; allowed is 1 to %d", options.slices, SLICE_LIMIT);
    }
    if (options.selection && options.selection->region.shape == REGION_BALL) {
        return fail(CONUS_ERROR_ARGUMENT, "selection: a ball, a cone or a cylinder is needed");
    }
    *out = options;
    return CONUS_OK;
}

static void find_ball(struct picture *picture, const struct colour_pass *pass)
{
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < pass->content_count; i++) {
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], pass->content[i][a]);
            high[a] = fmax(high[a], pass->content[i][a]);
        }
    }
    for (int a = 0; a < 3; a++) {
        picture->centre[a] = (low[a] + high[a]) / 2;
    }
    for (size_t i = 0; i < pass->content_count; i++) {
        double offset[3];
        vec3_sub(offset, pass->content[i], picture->centre);
        picture->radius = fmax(picture->radius, vec3_length(offset));
    }
}

/* ---- The cone ------------------------------------------------------------------------------------------------- */

static void cone_axis(double out[3], const struct cone *cone)
{
    vec3_scale(out, cone->pose.world_from_device + 8, -1);
}

/* To just behind the farthest contact, or through everything where nothing was hit. */
static double cone_length(const struct picture *picture, const conus_selection *selection)
{
    const double *apex = selection->cone.pose.world_from_device + 12;
    double axis[3], offset[3];
    double length = 0;
    if (cone_has_range(&selection->cone)) {
        return selection->cone.range[1];
    }
    cone_axis(axis, &selection->cone);
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels) {
            vec3_sub(offset, result->contact, apex);
            length = fmax(length, vec3_dot(offset, axis));
        }
    }
    if (length > 0) {
        return length + 0.05 * picture->radius;
    }
    vec3_sub(offset, picture->centre, apex);
    return fmax(vec3_dot(offset, axis), 0) + picture->radius;
}

static void add_marker(struct picture *picture, const double centre[3], double radius, const uint8_t rgb[3])
{
    if (picture->view.marker_count < COLOUR_MARKER_LIMIT) {
        struct colour_marker *marker = &picture->markers[picture->view.marker_count++];
        memcpy(marker->centre, centre, sizeof marker->centre);
        memcpy(marker->rgb, rgb, sizeof marker->rgb);
        marker->radius = radius;
    }
}

static uint32_t group_of(const conus_selection *selection, uint32_t object)
{
    return selection->group ? selection->group[object] : object;
}

uint8_t *picture_emphasis(const conus_selection *selection, uint32_t chosen)
{
    size_t count = selection->atlas->object_count + 1;
    size_t pixels = (size_t)selection->cone.resolution * selection->cone.resolution;
    uint8_t *emphasis = memory_zeroed(count, sizeof *emphasis);
    for (size_t i = 0; emphasis && i < selection->layers.count; i++) {
        const conus_interval *interval = &selection->layers.intervals[i];
        if (selection->in_cone[interval->pixel]) {
            emphasis[group_of(selection, interval->object)] = EMPHASIS_HATCHED;
        }
    }
    for (size_t p = 0; emphasis && p < pixels; p++) {
        if (selection->in_cone[p]) {
            emphasis[group_of(selection, selection->evidence.object[p])] = EMPHASIS_FULL;
        }
    }
    for (uint32_t object = 1; emphasis && object < count; object++) {
        emphasis[object] = emphasis[group_of(selection, object)];
    }
    for (uint32_t object = 1; emphasis && chosen && object < count; object++) {
        if (emphasis[object] == EMPHASIS_PALE && atlas_is_below(selection->atlas, object, chosen)) {
            emphasis[object] = EMPHASIS_FULL;
        }
    }
    return emphasis;
}

static void add_cone(struct picture *picture)
{
    static const uint8_t device[3] = {60, 60, 66};
    const conus_selection *selection = picture->options.selection;
    struct colour_view *view = &picture->view;
    view->emphasis = picture->emphasis;
    view->group = selection->group;
    view->world_from_cone = selection->cone.pose.world_from_device;
    view->cone_slope = tan(selection->cone.angle / 2);
    view->cone_radius = selection->cone.radius;
    view->cone_start = selection->cone.range[0];
    view->cone_length = cone_length(picture, selection);
    add_marker(picture, view->world_from_cone + 12, 0.022 * picture->radius, device);
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels) {
            add_marker(picture, result->contact, 0.017 * picture->radius,
                       picture->atlas->objects[result->object - 1].rgb);
        }
    }
}

/* ---- The camera ----------------------------------------------------------------------------------------------- */

static void set_frame(struct picture *picture)
{
    uint32_t width = picture->options.width;
    uint32_t height = picture->options.height;
    bool legend = picture->options.selection && !picture->options.no_legend;
    picture->frame = (struct camera_frame){.width = width, .height = height};
    picture->frame.top = picture->frame.bottom = height / 24;
    picture->frame.right = width / 28;
    picture->frame.left = legend ? width / 4 : width / 28;
}

/* The apex, or where the cone comes near, so that a far device does not make the brain a dot. */
static void near_end(double out[3], const struct picture *picture)
{
    const struct cone *cone = &picture->options.selection->cone;
    double axis[3], offset[3];
    cone_axis(axis, cone);
    memcpy(out, cone->pose.world_from_device + 12, 3 * sizeof *out);
    vec3_sub(offset, picture->centre, out);
    double skip = vec3_dot(offset, axis) - 1.6 * picture->radius;
    if (skip > 0 && skip < picture->view.cone_length) {
        vec3_add_scaled(out, out, skip, axis);
    }
}

static conus_status place_camera(struct picture *picture, const struct colour_pass *pass)
{
    const conus_view *options = &picture->options;
    set_frame(picture);
    if (options->camera) {
        conus_pose pose;
        conus_status status = conus_pose_from_matrix(&pose, options->camera->world_from_device);
        if (!status && has_frustum(options)) {
            camera_from_frustum(&picture->camera, &pose, options->frustum);
        } else if (!status) {
            camera_from_pose(&picture->camera, &pose, options->field_of_view, options->width, options->height);
        }
        return status ? fail_in(status, "camera") : CONUS_OK;
    }
    double forward[3];
    camera_default_forward(forward);
    double(*points)[3] = memory_raw(pass->content_count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(points, pass->content, pass->content_count * sizeof *points);
    size_t count = pass->content_count;
    if (options->selection) {
        double axis[3];
        cone_axis(axis, &options->selection->cone);
        camera_cone_forward(forward, axis);
        near_end(points[count++], picture);
    }
    camera_frame_points(&picture->camera, points[0], count, forward, options->field_of_view, &picture->frame);
    memory_free(points);
    return CONUS_OK;
}

/* ---- Pixels --------------------------------------------------------------------------------------------------- */

/* Lays the drawing over a light background, top row first. */
static void lay_over_background(conus_image *image, const float *rgba)
{
    struct image_rgba to = image_rgba(image);
    for (uint32_t row = 0; row < image->height; row++) {
        const float *from = rgba + (size_t)4 * image->width * (image->height - 1 - row);
        float part = (float)row / (float)image->height;
        for (uint32_t column = 0; column < image->width; column++) {
            size_t at = (size_t)image->width * row + column;
            const float *pixel = from + (size_t)4 * column;
            for (int c = 0; c < 3; c++) {
                to.plane[c][at] = pixel[c] + (1 - pixel[3]) * (0.90F - 0.22F * part);
            }
            to.plane[3][at] = 1;
        }
    }
}

/* Text where there is a font, and else a word about it in the log. */
static conus_status annotate(conus_image *image, const struct picture *picture, const conus_renderer *renderer)
{
    conus_status status = picture->options.no_legend ? CONUS_OK : picture_annotate(image, picture);
    if (status == CONUS_ERROR_UNSUPPORTED) {
        if (renderer->log) {
            const conus_note note = {.severity = CONUS_SEVERITY_WARNING, .line = conus_message()};
            renderer->log(renderer->log_user, &note);
        }
        status = CONUS_OK;
    }
    return status;
}

static conus_status add_cone_attributes(conus_image *image, const struct cone *cone)
{
    char angle[TEXT_NUMBER_SIZE];
    text_number(angle, degrees_from_radians(cone->angle));
    conus_status status = image_add_text(image, "conus:angleDegrees", angle);
    return status ? status : image_add_matrix(image, "conus:worldFromDevice", cone->pose.world_from_device);
}

static conus_status add_lens(conus_image *image, const conus_view *options)
{
    char number[4][TEXT_NUMBER_SIZE];
    char text[4 * TEXT_NUMBER_SIZE];
    if (!has_frustum(options)) {
        text_number(text, degrees_from_radians(options->field_of_view));
        return image_add_text(image, "conus:fieldOfViewDegrees", text);
    }
    for (int k = 0; k < 4; k++) {
        text_number(number[k], options->frustum[k]);
    }
    snprintf(text, sizeof text, "%s,%s,%s,%s", number[0], number[1], number[2], number[3]);
    return image_add_text(image, "conus:frustum", text);
}

static conus_status add_attributes(conus_image *image, const struct picture *picture, const conus_renderer *renderer)
{
    conus_status status = image_add_text(image, "conus:version", CONUS_VERSION);
    status = status ? status : image_add_text(image, "conus:space", "RAS mm");
    status = status ? status : image_add_text(image, "conus:device", conus_renderer_device(renderer));
    status = status ? status : add_lens(image, &picture->options);
    status = status ? status : image_add_matrix(image, "conus:worldFromCamera", picture->camera.world_from_camera);
    status = status ? status : picture_add_volumes(image, picture->atlas, true);
    return status || !picture->options.selection ? status
                                                 : add_cone_attributes(image, &picture->options.selection->cone);
}

static conus_status make_image(conus_image **out, const struct picture *picture, const conus_renderer *renderer)
{
    conus_image *image = NULL;
    conus_status status = image_create_rgba(&image, picture->options.width, picture->options.height);
    if (!status) {
        lay_over_background(image, picture->rgba);
        status = annotate(image, picture, renderer);
    }
    status = status ? status : add_attributes(image, picture, renderer);
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

static conus_status draw(struct picture *picture, conus_renderer *renderer)
{
    struct colour_view *view = &picture->view;
    view->camera = &picture->camera;
    view->width = picture->options.width;
    view->height = picture->options.height;
    view->slices = picture->options.slices;
    view->no_skipping = picture->options.no_skipping;
    view->fade = picture->options.fade;
    view->line_width = 0.012 * picture->radius;
    view->markers = picture->markers;
    picture->rgba = memory_raw((size_t)view->width * view->height, 4 * sizeof *picture->rgba);
    return picture->rgba ? renderer_draw(picture->rgba, renderer, view, !picture->options.draft) : CONUS_ERROR_MEMORY;
}

conus_status conus_render(conus_image **out, conus_renderer *renderer, const conus_view *view)
{
    struct picture picture = {.atlas = renderer->atlas};
    conus_status status = fill_options(&picture.options, view);
    if (status) {
        return status;
    }
    if (picture.options.selection) {
        picture.emphasis = picture_emphasis(picture.options.selection, picture.options.chosen);
        status = picture.emphasis ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (!status && !picture.options.draft) {
        status = renderer_include(renderer, picture.emphasis);
    }
    if (!status) {
        find_ball(&picture, &renderer->colour);
    }
    if (!status && picture.options.selection) {
        add_cone(&picture);
    }
    status = status ? status : place_camera(&picture, &renderer->colour);
    status = status ? status : draw(&picture, renderer);
    status = status ? status : make_image(out, &picture, renderer);
    memory_free(picture.emphasis);
    memory_free(picture.rgba);
    return status;
}
