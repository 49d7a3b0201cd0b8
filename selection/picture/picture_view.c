/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_render(): the picture of the atlas from a camera, with the cone in it. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/text.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "render/image/image.h"
#include "selection/measure/measure.h"
#include "selection/picture/picture.h"

#include <stdio.h>
#include <string.h>

enum {
    DEFAULT_WIDTH = 1400,
    DEFAULT_HEIGHT = 1050,
    SIDE_LIMIT = 16384,
    SLICE_LIMIT = 65536,
    DPI_LIMIT = 100000,
    BALL_POINTS = 6,
    AROUND = 24, /* a cone's axis */
    WALL_POINTS = 2 * AROUND
};

/* Opacity of what is not hit, where it would hide a hit. */
static const double GLASS = 0.1;

/* Radius of the ball at the apex, as a part of the atlas's. */
static const double DEVICE = 0.022;

void picture_finish(struct picture *picture)
{
    picture_legend_finish(picture);
    picture_probes_finish(picture);
    font_destroy(picture->font);
    memory_free(picture->key);
    memory_free(picture->sides);
    memory_free((void *)picture->prefixes);
    memory_free(picture->groups);
    memory_free(picture->group_of);
    memory_free(picture->emphasis);
    memory_free(picture->ranks);
    memory_free(picture->rgb);
    memory_free(picture->line_rgb);
    memory_free(picture->opacity);
    memory_free(picture->areas);
    memory_free(picture->seen);
    conus_selection_destroy(picture->sight);
    memory_free(picture->names);
    memory_free(picture->rgba);
}

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

conus_status picture_check_sheet(const conus_view *view)
{
    if (view->side > CONUS_SIDE_ACROSS_CONE || view->legend > CONUS_LEGEND_NONE ||
        view->background > CONUS_BACKGROUND_TRANSPARENT) {
        return fail(CONUS_ERROR_ARGUMENT, "side %d, legend %d, background %d; allowed are at most %d, %d, %d",
                    (int)view->side, (int)view->legend, (int)view->background, CONUS_SIDE_ACROSS_CONE,
                    CONUS_LEGEND_NONE, CONUS_BACKGROUND_TRANSPARENT);
    }
    if (view->side && view->camera) {
        return fail(CONUS_ERROR_ARGUMENT, "side: there is a camera");
    }
    if (!(view->dpi >= 0 && view->dpi <= DPI_LIMIT)) {
        return fail(CONUS_ERROR_ARGUMENT, "%g dpi; allowed is 0 to %d", view->dpi, DPI_LIMIT);
    }
    return CONUS_OK;
}

static conus_status check_opacity(const conus_view *view, const conus_atlas *atlas)
{
    if (!(view->pale >= 0 && view->pale <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "opacity of %g; allowed is 0 to 1", view->pale);
    }
    for (size_t n = 1; view->opacity && n <= atlas->object_count; n++) {
        if (view->opacity[n] < 0 || view->opacity[n] > 1) {
            return fail(CONUS_ERROR_ARGUMENT, "opacity of %g of %s; allowed is 0 to 1", view->opacity[n],
                        atlas->objects[n - 1].name);
        }
    }
    return CONUS_OK;
}

static conus_status check_marks(const conus_view *view, const conus_atlas *atlas)
{
    for (size_t i = 0; i < view->mark_count; i++) {
        if (view->marks[i].object > atlas->object_count) {
            return fail(CONUS_ERROR_ARGUMENT, "mark of object %u; there are %zu objects", view->marks[i].object,
                        atlas->object_count);
        }
    }
    return CONUS_OK;
}

static conus_status fill_options(conus_view *out, const conus_view *view, const conus_atlas *atlas)
{
    conus_view options = *options_of(conus_view, view);
    conus_status status = check_frustum(&options);
    status = status ? status : picture_check_sheet(&options);
    status = status ? status : check_opacity(&options, atlas);
    status = status ? status : check_marks(&options, atlas);
    status = status ? status : picture_probes_check(&options);
    status = status ? status : picture_points_check(&options);
    if (status) {
        return status;
    }
    options.width = options.width ? options.width : DEFAULT_WIDTH;
    options.height = options.height ? options.height : DEFAULT_HEIGHT;
    if (options.field_of_view == 0) {
        options.field_of_view = 30;
    }
    if (options.width > SIDE_LIMIT || options.height > SIDE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "picture of %u x %u pixels; allowed is 1 to %d", options.width,
                    options.height, SIDE_LIMIT);
    }
    if (!(options.field_of_view > 0 && options.field_of_view < 180)) {
        return fail(CONUS_ERROR_ARGUMENT, "field of view of %g degrees; allowed is more than 0 and less than 180",
                    options.field_of_view);
    }
    if (!(options.fade >= 0 && options.fade <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "fade of %g; allowed is 0 to 1", options.fade);
    }
    if (options.slices > SLICE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "%u slices; allowed is 1 to %d", options.slices, SLICE_LIMIT);
    }
    if (options.selection && options.selection->region.shape == REGION_BALL &&
        !(options.no_cone && (options.no_legend || options.legend == CONUS_LEGEND_NONE))) {
        return fail(CONUS_ERROR_ARGUMENT, "selection: a ball, which has no cone and no legend; with these a cone or a "
                                          "cylinder is needed");
    }
    *out = options;
    return CONUS_OK;
}

static void find_ball(struct picture *picture, const struct colour_pass *pass)
{
    struct box3 box = box3_empty();
    for (size_t i = 0; i < pass->content_count; i++) {
        box3_add(&box, pass->content[i]);
    }
    for (int a = 0; a < 3; a++) {
        picture->centre[a] = (box.low[a] + box.high[a]) / 2;
    }
    for (size_t i = 0; i < pass->content_count; i++) {
        double offset[3];
        vec3_sub(offset, pass->content[i], picture->centre);
        picture->radius = fmax(picture->radius, vec3_length(offset));
    }
}

static void cone_axis(double out[3], const struct cone *cone)
{
    vec3_scale(out, cone->pose.world_from_device + 8, -1);
}

/* To just behind the farthest contact, which may be the apex, or through everything where nothing was hit. */
static double cone_length(const struct picture *picture, const conus_selection *selection)
{
    const double length = picture_cone_depth(selection);
    double axis[3], offset[3];
    if (cone_has_range(&selection->cone)) {
        return selection->cone.range[1];
    }
    if (length > -INFINITY) {
        return length + 0.05 * picture->radius;
    }
    cone_axis(axis, &selection->cone);
    vec3_sub(offset, picture->centre, selection->cone.pose.world_from_device + 12);
    return fmax(vec3_dot(offset, axis), 0) + picture->radius;
}

/* To just behind the deepest first hit of all rays, which on an oblique surface lies behind the contact. */
static double cone_reach(const struct picture *picture, const conus_selection *selection)
{
    const uint32_t n = selection->cone.resolution;
    double deepest = -INFINITY;
    for (size_t p = 0; p < (size_t)n * n; p++) {
        if (selection->in_cone[p] && selection->evidence.object[p]) {
            const double per_depth = cone_per_depth(&selection->cone, (uint32_t)(p % n), (uint32_t)(p / n));
            deepest = fmax(deepest, selection->evidence.distance[p] / per_depth);
        }
    }
    return deepest > -INFINITY ? deepest + 0.05 * picture->radius : picture->view.cone_length;
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

static void add_cone(struct picture *picture)
{
    static const uint8_t device[3] = {LOOK_RGB(LOOK_APEX)};
    const conus_selection *selection = picture->options.selection;
    struct colour_view *view = &picture->view;
    if (!picture->options.no_cone) {
        view->world_from_cone = selection->cone.pose.world_from_device;
        add_marker(picture, view->world_from_cone + 12, DEVICE * picture->radius, device);
    }
    view->cone_slope = tan(selection->cone.angle / 2);
    view->cone_radius = selection->cone.radius;
    view->cone_start = selection->cone.range[0];
    view->cone_length = cone_length(picture, selection);
    view->cone_reach = cone_reach(picture, selection);
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels) {
            uint8_t rgb[3];
            picture_colour(rgb, picture, result->object);
            add_marker(picture, result->contact, 0.017 * picture->radius, rgb);
        }
    }
}

/* `letters`: there are some at the edges. */
static void set_frame(struct picture *picture, bool letters)
{
    uint32_t width = picture->drawing[0];
    uint32_t height = picture->drawing[1];
    uint32_t least = letters ? (uint32_t)lrint(2 * picture->em) : 0;
    uint32_t across = width / 28 > least ? width / 28 : least;
    uint32_t upward = height / 24 > least ? height / 24 : least;
    picture->frame = (struct camera_frame){.width = width, .height = height};
    if (2 * across < width && 2 * upward < height) { /* else it is too small for margins */
        picture->frame.left = picture->frame.right = across;
        picture->frame.top = picture->frame.bottom = upward;
    }
}

static const double forwards[][3] = {
    [CONUS_SIDE_LEFT] = {1, 0, 0}, [CONUS_SIDE_RIGHT] = {-1, 0, 0}, [CONUS_SIDE_FRONT] = {0, -1, 0},
    [CONUS_SIDE_BACK] = {0, 1, 0}, [CONUS_SIDE_TOP] = {0, 0, -1},   [CONUS_SIDE_BOTTOM] = {0, 0, 1}};

static double camera_distance(const struct picture *picture)
{
    return vec3_dot(picture->camera.world_from_camera + 8, picture->camera.world_from_camera + 12);
}

/* Points that a picture shows, and from where. */
struct shown_points {
    const double *xyz; /* [count * 3] */
    size_t count;
    const double *forward;
};

static void frame_all(struct picture *picture, const struct shown_points *points)
{
    camera_frame_points(&picture->camera, points->xyz, points->count, points->forward,
                        radians_from_degrees(picture->options.field_of_view), &picture->frame);
}

/* Finds a place for the camera from which all points are in the frame and none under the scale and the directions.
 * These get room below, on the right or both, whatever leaves the points largest; none where no way leaves them any. */
static void frame_points(struct picture *picture, const struct shown_points *points)
{
    enum { BELOW = 1, RIGHT = 2, STEPS = 12 };
    double key[2];
    set_frame(picture, false);
    frame_all(picture, points); /* which decides whether there are letters at the edges */
    set_frame(picture, picture->font && picture_is_across(picture));
    frame_all(picture, points);
    if (!picture->font || picture_key_is_free(key, picture, points->xyz, points->count)) {
        return;
    }
    const struct camera_frame whole = picture->frame;
    const struct camera plain = picture->camera;
    struct camera_frame best = whole;
    double nearest = INFINITY;
    for (int way = BELOW; way <= (BELOW | RIGHT); way++) {
        bool is_free = false;
        for (int step = 1; step <= STEPS && !is_free; step++) {
            struct camera_frame *frame = &picture->frame;
            *frame = whole;
            frame->bottom += way & BELOW ? (uint32_t)(key[1] * step / STEPS) : 0;
            frame->right += way & RIGHT ? (uint32_t)(key[0] * step / STEPS) : 0;
            if (frame->left + frame->right >= frame->width || frame->top + frame->bottom >= frame->height) {
                break;
            }
            frame_all(picture, points);
            is_free = picture_key_is_free(key, picture, points->xyz, points->count);
            if (is_free && camera_distance(picture) < nearest) {
                nearest = camera_distance(picture);
                best = *frame;
            }
        }
    }
    picture->frame = best;
    picture->camera = plain;
    if (nearest < INFINITY) {
        frame_all(picture, points);
    }
}

/* On the walls of the cone that is drawn, from so many mm on. */
static void add_walls(double points[WALL_POINTS][3], const struct colour_view *view, double skip)
{
    const double *m = view->world_from_cone;
    const double start = fmax(view->cone_start, skip);
    for (int n = 0; n < WALL_POINTS; n++) {
        double along = n < AROUND ? start : view->cone_length;
        double turn = radians_from_degrees(360.0 / AROUND * (n % AROUND));
        double away = view->cone_radius + along * view->cone_slope;
        vec3_add_scaled(points[n], m + 12, -along, m + 8);
        vec3_add_scaled(points[n], points[n], away * cos(turn), m);
        vec3_add_scaled(points[n], points[n], away * sin(turn), m + 4);
    }
}

/* The best first hit; NULL = nothing is hit. */
static const conus_result *best_hit(const conus_selection *selection)
{
    const conus_result *best = NULL;
    for (size_t i = 0; i < conus_selection_count(selection) && !best; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        best = result->object && result->pixels ? result : NULL;
    }
    return best;
}

/* What part the cone's first hits, by their shares, have of what an eye sees around the contact that looks at it along
 * `forward`. */
static conus_status see_contact(double *out, const struct picture *picture, conus_selector *selector,
                                const conus_result *hit, const double forward[3])
{
    static const double around = 0.4; /* the radius of all that shows */
    const conus_selection *cone = picture->options.selection;
    const double away = 4 * picture->radius;
    conus_selection *seen = NULL;
    conus_pose eye;
    double from[3];
    vec3_add_scaled(from, hit->contact, -away, forward);
    conus_status status = conus_pose_toward(&eye, from, hit->contact, NULL);
    status = status
                 ? status
                 : conus_select(&seen, selector, &eye, degrees_from_radians(2 * atan(around * picture->radius / away)));
    *out = 0;
    for (size_t i = 0; i < conus_selection_count(seen); i++) {
        const conus_result *result = conus_selection_result(seen, i);
        for (size_t k = 0; k < conus_selection_count(cone); k++) {
            const conus_result *other = conus_selection_result(cone, k);
            bool is_hit = other->object && other->object == result->object && other->pixels;
            *out += is_hit ? result->share * other->share : 0;
        }
    }
    conus_selection_destroy(seen);
    return status;
}

/* The direction 60 degrees off the cone's axis from which its best hit is seen best, where that is equal the most
 * upright one: a little from above; 45 or 35 degrees off it where that shows clearly more. */
static conus_status look_from_beside(double out[3], const struct picture *picture)
{
    enum { TURNS = 24, RAYS_ACROSS = 24, ANGLES = 3 };
    static const double degrees[ANGLES] = {60, 45, 35};
    static const double clearly = 1.15;
    static const double upright = 0.05; /* as much as that part of what is seen */
    const conus_selection *selection = picture->options.selection;
    const double *m = selection->cone.pose.world_from_device;
    const conus_result *hit = best_hit(selection);
    conus_selector_options rays = CONUS_SELECTOR_OPTIONS_INIT;
    conus_selector *selector = NULL;
    double best = -INFINITY;
    double least = -INFINITY;
    rays.resolution = RAYS_ACROSS;
    conus_status status = hit ? conus_selector_create(&selector, picture->atlas, &rays) : CONUS_OK;
    for (int n = 0; n < ANGLES * TURNS && !status; n++) {
        const double off = radians_from_degrees(degrees[n / TURNS]);
        const double turn = radians_from_degrees(360.0 / TURNS * (n % TURNS));
        const bool is_first = n % TURNS == 0; /* of this angle */
        double forward[3], across[3];
        double seen = 0;
        vec3_scale(across, m, cos(turn));
        vec3_add_scaled(across, across, sin(turn), m + 4);
        vec3_scale(forward, m + 8, -cos(off));
        vec3_add_scaled(forward, forward, sin(off), across);
        status = hit ? see_contact(&seen, picture, selector, hit, forward) : CONUS_OK;
        const double score = seen + upright * cos(asin(fmin(fmax(-forward[2], -1), 1)) - radians_from_degrees(15));
        least = is_first && n ? clearly * best : least;
        if (score > fmax(best, least) + 1e-6) {
            best = score;
            memcpy(out, forward, sizeof forward);
        }
    }
    conus_selector_destroy(selector);
    return status;
}

/* The direction at right angles to the cone's axis that looks down by 25 degrees, or by as nearly as much as there is;
 * of several the most usual one. */
static void look_across(double out[3], const struct picture *picture)
{
    enum { TURNS = 360 };
    static const double usual = 0.001; /* as much as that part of the elevation */
    const double *m = picture->options.selection->cone.pose.world_from_device;
    double wanted[3];
    double best = -INFINITY;
    camera_default_forward(wanted);
    for (int n = 0; n < TURNS; n++) {
        const double turn = radians_from_degrees(360.0 / TURNS * n);
        double forward[3];
        vec3_scale(forward, m, cos(turn));
        vec3_add_scaled(forward, forward, sin(turn), m + 4);
        const double down = asin(fmin(fmax(-forward[2], -1), 1));
        const double score = cos(down - radians_from_degrees(25)) + usual * vec3_dot(forward, wanted);
        if (score > best + 1e-9) {
            best = score;
            memcpy(out, forward, sizeof forward);
        }
    }
}

/* Finds from which side a camera looks that is not given. */
static conus_status choose_side(struct picture *picture)
{
    const conus_view *options = &picture->options;
    camera_default_forward(picture->forward);
    if (options->side && options->side < CONUS_SIDE_BESIDE_CONE) {
        memcpy(picture->forward, forwards[options->side], sizeof picture->forward);
    } else if (options->selection && options->side == CONUS_SIDE_BESIDE_CONE) {
        return look_from_beside(picture->forward, picture);
    } else if (options->selection && options->side == CONUS_SIDE_ACROSS_CONE) {
        look_across(picture->forward, picture);
    } else if (options->selection) {
        double axis[3];
        cone_axis(axis, &options->selection->cone);
        camera_cone_forward(picture->forward, axis);
    }
    return CONUS_OK;
}

static conus_status place_camera(struct picture *picture, const struct colour_pass *pass)
{
    const conus_view *options = &picture->options;
    if (options->camera) {
        conus_pose pose;
        conus_status status = conus_pose_from_matrix(&pose, options->camera->world_from_device);
        if (!status && has_frustum(options)) {
            camera_from_frustum(&picture->camera, &pose, options->frustum);
        } else if (!status) {
            camera_from_pose(&picture->camera, &pose, radians_from_degrees(options->field_of_view), picture->drawing[0],
                             picture->drawing[1]);
        }
        set_frame(picture, false);
        return status ? fail_in(status, "camera") : CONUS_OK;
    }
    const bool is_beside =
        options->selection && (options->side == CONUS_SIDE_BESIDE_CONE ||
                               options->side == CONUS_SIDE_ACROSS_CONE); /* all of the cone is seen */
    double(*points)[3] = memory_raw(pass->content_count + 2 * options->probe_count +
                                        BALL_POINTS * (options->point_count + 1) + WALL_POINTS,
                                    sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(points, pass->content, pass->content_count * sizeof *points);
    size_t count = pass->content_count;
    for (size_t i = 0; i < options->probe_count; i++) {
        count += picture_probe_ends(points + count, picture, i) ? 2 : 0;
    }
    count += picture_points_near(points + count, picture);
    if (options->selection) {
        /* The apex, or where the cone comes near, so that a far device does not make the brain a dot. */
        double *near = points[count];
        const struct cone *cone = &picture->options.selection->cone;
        double axis[3], offset[3];
        cone_axis(axis, cone);
        memcpy(near, cone->pose.world_from_device + 12, 3 * sizeof *near);
        vec3_sub(offset, picture->centre, near);
        double skip = vec3_dot(offset, axis) - (is_beside ? 3.2 : 1.6) * picture->radius;
        skip = skip > 0 && skip < picture->view.cone_length ? skip : 0;
        vec3_add_scaled(near, near, skip, axis);
        const double middle[3] = {near[0], near[1], near[2]};
        for (int n = 0; n < BALL_POINTS; n++) { /* with the ball that is drawn there */
            memcpy(points[count], middle, sizeof middle);
            points[count++][n / 2] += (n % 2 ? 1 : -1) * DEVICE * picture->radius;
        }
        if (is_beside) {
            add_walls(points + count, &picture->view, skip);
            count += WALL_POINTS;
        }
    }
    frame_points(picture, &(struct shown_points){points[0], count, picture->forward});
    memory_free(points);
    return CONUS_OK;
}

/* Linear light, premultiplied, and opacity of the background, `part` of the way down. */
static void find_background(float out[4], const conus_view *options, float part)
{
    bool transparent = options->background == CONUS_BACKGROUND_TRANSPARENT;
    for (int c = 0; c < 3; c++) {
        out[c] = options->background == CONUS_BACKGROUND_LIGHT ? LOOK_PICTURE_TOP - LOOK_PICTURE_DARKER * part
                 : transparent                                 ? 0
                               : (float)linear_from_srgb(options->background_rgb[c] / 255.0);
    }
    out[3] = transparent ? 0 : 1;
}

void picture_lay_background(conus_image *image, const conus_view *options)
{
    const struct image_rgba to = image_rgba(image);
    for (uint32_t row = 0; row < image->height; row++) {
        float under[4];
        find_background(under, options, (float)row / (float)image->height);
        for (uint32_t column = 0; column < image->width; column++) {
            image_lay(&to, (size_t)image->width * row + column, under);
        }
    }
}

/* Lays the drawing over the background, top row first. */
static void lay_over_background(conus_image *image, const struct picture *picture)
{
    const struct image_rgba to = image_rgba(image);
    const uint32_t *drawing = picture->drawing;
    const float *pixel = picture->rgba;
    picture_lay_background(image, &picture->options);
    for (uint32_t row = drawing[1]; row-- > 0;) {
        for (uint32_t column = 0; column < drawing[0]; column++, pixel += 4) {
            image_lay(&to, (size_t)image->width * row + column, pixel);
        }
    }
}

/* Where there is no font, a word about it in the log, and no text. */
static conus_status find_font(struct picture *picture, conus_log log, void *log_user)
{
    conus_status status = picture->options.no_legend ? CONUS_OK : font_create(&picture->font);
    if (status == CONUS_ERROR_UNSUPPORTED) {
        if (log) {
            const conus_note note = {.severity = CONUS_SEVERITY_WARNING, .line = conus_message()};
            log(log_user, &note);
        }
        status = CONUS_OK;
    }
    return status;
}

/* Luminance of linear light. */
static double light_of(const float rgb[3])
{
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

/* That of the darker end; what is transparent is taken for paper. */
static double background_light(const conus_view *options)
{
    float top[4];
    float bottom[4];
    find_background(top, options, 0);
    find_background(bottom, options, 1);
    return top[3] > 0 ? fmin(light_of(top), light_of(bottom)) : 1;
}

bool picture_is_dark(const conus_view *options)
{
    static const double even =
        0.1791; /* black and white have the same contrast to it: 1.05 / (L + 0.05) = (L + 0.05) / 0.05 */
    return background_light(options) < even;
}

/* Dark letters, or light ones on what is dark; black or white where these would have less than CONTRAST. What is
 * transparent is taken for white. */
static void choose_ink(struct picture *picture)
{
    double light = background_light(&picture->options);
    bool is_dark = picture_is_dark(&picture->options);
    float soft = is_dark ? LOOK_PICTURE_INK_ON_DARK : LOOK_PICTURE_INK_ON_LIGHT;
    double dark[2] = {is_dark ? light : (double)soft, is_dark ? (double)soft : light};
    bool fits = (dark[1] + 0.05) / (dark[0] + 0.05) >= PICTURE_CONTRAST;
    for (int c = 0; c < 3; c++) {
        picture->ink[c] = fits ? soft : is_dark ? 1 : 0;
    }
    picture->ink[3] = 1;
    float dim = PICTURE_DIM;
    double mixed = (double)picture->ink[0] * (double)dim + light * (1 - (double)dim);
    double contrast = (fmax(mixed, light) + 0.05) / (fmin(mixed, light) + 0.05);
    picture->dim = contrast >= PICTURE_CONTRAST ? dim : 1;
}

conus_status picture_prepare_sheet(struct picture *picture, uint64_t max_memory, conus_log log, void *log_user)
{
    const conus_view *options = &picture->options;
    uint64_t bytes = UINT64_C(32) * options->width * options->height; /* as drawn, and laid over the background */
    if (bytes > max_memory) {
        return fail(CONUS_ERROR_MEMORY, "picture of %u x %u pixels: %llu bytes, allowed are %llu", options->width,
                    options->height, (unsigned long long)bytes, (unsigned long long)max_memory);
    }
    picture->drawing[0] = options->width;
    picture->drawing[1] = picture->sheet_height = options->height;
    picture->em = options->dpi > 0
                      ? LOOK_FIGURE_POINTS / 72 * options->dpi
                      : fmax(LOOK_FIGURE_LEAST, fmin(options->width, options->height) / (double)LOOK_FIGURE_PART);
    picture->line = options->dpi > 0 ? 0.5 / 72 * options->dpi : 1;
    choose_ink(picture);
    conus_status status = find_font(picture, log, log_user);
    if (status || !picture->font) {
        return status;
    }
    const size_t count = picture->atlas->object_count + 1;
    picture->sides = memory_zeroed(count, 1);
    picture->prefixes = memory_zeroed(count, sizeof *picture->prefixes);
    status =
        picture->sides && picture->prefixes ? conus_atlas_sides(picture->sides, picture->atlas) : CONUS_ERROR_MEMORY;
    status = status ? status : conus_atlas_prefixes(picture->prefixes, picture->atlas);
    if (!status && options->probe_count) {
        status = picture_probes_init(picture);
    }
    status = status || options->draft ? status : picture_names_init(picture);
    return status || options->draft ? status : picture_legend_init(picture);
}

static conus_status add_lens(conus_image *image, const conus_view *options)
{
    char number[4][TEXT_NUMBER_SIZE];
    char text[4 * TEXT_NUMBER_SIZE];
    if (!has_frustum(options)) {
        text_number(text, options->field_of_view);
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
    status = status ? status : picture_add_key(image, picture);
    if (!status && picture->options.selection) {
        const struct cone *cone = &picture->options.selection->cone;
        char angle[TEXT_NUMBER_SIZE];
        status = image_add_text(image, "conus:angleDegrees", text_number(angle, cone->degrees));
        status = status ? status : image_add_matrix(image, "conus:worldFromDevice", cone->pose.world_from_device);
    }
    return status;
}

static conus_status make_image(conus_image **out, const struct picture *picture, const conus_renderer *renderer)
{
    conus_image *image = NULL;
    conus_status status = image_create_listed(&image, picture->options.width, picture->sheet_height);
    if (!status) {
        image->dpi = picture->options.dpi;
        lay_over_background(image, picture);
    }
    if (!status && picture->options.probe_count) {
        status = picture_probes_draw(image->list, picture);
    }
    if (!status && picture->options.point_count) {
        status = picture_points_draw(image->list, picture);
    }
    if (!status) {
        picture_draw_marks(image->list, picture);
    }
    if (!status && picture->font) {
        picture_annotate(image->list, picture);
    }
    status = status || picture->options.shapes ? status : image_paint(image);
    status = status ? status : add_attributes(image, picture, renderer);
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

/* The width of a pixel at the depth of the middle of the scene, at least 1 mm away; mm. */
static double pixel_mm(const struct picture *picture)
{
    double offset[3];
    const double *m = picture->camera.world_from_camera;
    vec3_sub(offset, m + 12, picture->centre);
    return 2 * picture->camera.slope[0] * fmax(vec3_dot(m + 8, offset), 1) / picture->drawing[0];
}

/* Whether the pixel is in the drawing, and more than half of it is drawn. */
static bool is_drawn(const struct picture *picture, long x, long y)
{
    const long size[2] = {(long)picture->drawing[0], (long)picture->drawing[1]};
    bool is_in = x >= 0 && y >= 0 && x < size[0] && y < size[1];
    return is_in && picture->rgba[4 * (size[0] * y + x) + 3] > 0.5F;
}

/* Makes `nearest`, of each pixel, the distance to a pixel at x, y, if it is in reach. */
static void reach_from(float *nearest, const struct picture *picture, long x, long y)
{
    const long steps = (long)ceil(picture->line);
    for (long down = -steps; down <= steps; down++) {
        for (long across = -steps; across <= steps; across++) {
            if (is_drawn(picture, x + across, y + down)) {
                float *to = &nearest[(long)picture->drawing[0] * (y + down) + x + across];
                *to = fminf(*to, (float)hypot((double)across, (double)down));
            }
        }
    }
}

/* Draws a line of the picture's thinnest width into the pixels that are drawn, along those that are not. */
static conus_status draw_silhouette(struct picture *picture)
{
    static const uint8_t edge[3] = {LOOK_RGB(LOOK_GLASS_EDGE)};
    const size_t pixels = (size_t)picture->drawing[0] * picture->drawing[1];
    const float reach = (float)picture->line;
    float *nearest = memory_raw(pixels, sizeof *nearest); /* pixel that is not drawn */
    float ink[4];
    if (!nearest) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < pixels; i++) {
        nearest[i] = reach + 1;
    }
    for (long y = 0; y < (long)picture->drawing[1]; y++) {
        for (long x = 0; x < (long)picture->drawing[0]; x++) {
            if (!is_drawn(picture, x, y) && (is_drawn(picture, x - 1, y) || is_drawn(picture, x + 1, y) ||
                                             is_drawn(picture, x, y - 1) || is_drawn(picture, x, y + 1))) {
                reach_from(nearest, picture, x, y);
            }
        }
    }
    draw_colour(ink, edge, 1);
    for (size_t i = 0; i < pixels; i++) {
        float *pixel = &picture->rgba[4 * i];
        const float part = 0.85F * fminf(fmaxf(reach + 0.5F - nearest[i], 0), 1) * pixel[3];
        for (int c = 0; c < 3; c++) {
            pixel[c] += part * (ink[c] - pixel[c]);
        }
    }
    memory_free(nearest);
    return CONUS_OK;
}

static conus_status draw(struct picture *picture, conus_renderer *renderer)
{
    struct colour_view *view = &picture->view;
    view->camera = &picture->camera;
    view->width = picture->drawing[0];
    view->height = picture->drawing[1];
    view->slices = picture->options.slices;
    view->draft = picture->options.draft ? pixel_mm(picture) : 0;
    view->listener = (struct picture_listener){picture->options.progress, picture->options.progress_user};
    view->fade = picture->options.fade;
    view->opacity = picture->opacity;
    view->emphasis = picture->emphasis;
    view->rgb = (const uint8_t(*)[3])picture->rgb;
    view->pale_rgb = picture->options.has_unselected                ? picture->options.unselected_rgb
                     : picture->rgb && !picture->atlas->has_palette ? picture->rgb[0]
                                                                    : NULL;
    view->line_width = fmax(0.012 * picture->radius, view->draft);
    view->markers = picture->markers;
    picture->rgba = memory_raw((size_t)view->width * view->height, 4 * sizeof *picture->rgba);
    conus_status status =
        picture->rgba ? renderer_draw(picture->rgba, renderer, view, !picture->options.draft) : CONUS_ERROR_MEMORY;
    return status || !picture->options.print ? status : draw_silhouette(picture);
}

static double opacity_of(const struct picture *picture, size_t number)
{
    const conus_view *options = &picture->options;
    bool pale = picture->emphasis ? picture->emphasis[number] == EMPHASIS_PALE : !picture_stands_out(picture, number);
    double given = options->opacity ? options->opacity[number] : NAN;
    return !isnan(given) ? given : pale && options->no_pale ? 0 : pale && options->pale > 0 ? options->pale : 1;
}

/* Chooses the areas that are drawn beside pathways: those that stand out, those with an opacity, and all that do not
 * hide pathways. */
static uint8_t area_of(const struct picture *picture, size_t number)
{
    const conus_view *options = &picture->options;
    double opacity = opacity_of(picture, number);
    bool stands_out = picture->emphasis && picture->emphasis[number] != EMPHASIS_PALE;
    bool is_given = picture_stands_out(picture, number) || (options->opacity && !isnan(options->opacity[number]));
    return opacity <= 0             ? PATHWAYS_AREA_LEFT_OUT /* so that pathways are lit by their own borders */
           : opacity < 1            ? PATHWAYS_AREA_UNDER
           : stands_out || is_given ? PATHWAYS_AREA_OVER
                                    : PATHWAYS_AREA_LEFT_OUT;
}

static void mark_run(void *user, const struct tract_run *run, const struct tract_part *part)
{
    (void)part;
    bool *is_pale = user;
    is_pale[run->streamline] = false;
}

/* One after the other, [streamline_count] of each tractogram, in one block. */
static conus_status find_pale(bool **block, const bool **is_pale, const conus_atlas *atlas, const struct region *region)
{
    size_t count = 0;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        count += atlas->tractograms[i].streamline_count;
    }
    bool *next = *block = memory_raw(count, sizeof **block);
    if (!next) {
        return CONUS_ERROR_MEMORY;
    }
    memset(next, true, count);
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        tract_census_walk(&atlas->tractograms[i], region, mark_run, next);
        is_pale[i] = next;
        next += atlas->tractograms[i].streamline_count;
    }
    return CONUS_OK;
}

/* Lets the renderer draw palely the streamlines that do not come into the cone of the selection (Eq. 19); NULL = none.
 */
static conus_status mark_streamlines(conus_renderer *renderer, const conus_selection *selection)
{
    const conus_atlas *atlas = renderer->atlas;
    if (!atlas->tractogram_count) {
        return CONUS_OK;
    }
    bool *block = NULL;
    const bool **is_pale = memory_zeroed(atlas->tractogram_count, sizeof(void *));
    conus_status status = is_pale ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && selection) {
        status = find_pale(&block, is_pale, atlas, &selection->region);
    }
    status = status ? status : renderer_paint_streamlines(renderer, is_pale);
    memory_free(is_pale);
    memory_free(block);
    return status;
}

static conus_status find_opacities(struct picture *picture)
{
    size_t count = picture->atlas->object_count;
    bool translucent = false;
    memory_free(picture->areas);
    picture->opacity = memory_raw(count + 1, sizeof *picture->opacity);
    picture->areas = memory_zeroed(count + 1, sizeof *picture->areas);
    if (!picture->opacity || !picture->areas) {
        return CONUS_ERROR_MEMORY;
    }
    picture->opacity[0] = 1;
    for (size_t n = 1; n <= count; n++) {
        picture->opacity[n] = (float)opacity_of(picture, n);
        translucent = translucent || picture->opacity[n] < 1;
        picture->areas[n] = n <= picture->atlas->area_count ? area_of(picture, n) : PATHWAYS_AREA_LEFT_OUT;
    }
    if (!translucent) {
        memory_free(picture->opacity);
        picture->opacity = NULL;
    }
    return CONUS_OK;
}

static bool has_bundles(const conus_atlas *atlas)
{
    bool found = false;
    for (size_t n = atlas->area_count; n < atlas->object_count && !found; n++) {
        found = atlas->places[n].is_bundle && !atlas->places[n].is_hidden;
    }
    return found;
}

/* Finds what the camera sees, but where something is translucent other than as haze; beside pathways only where there
 * is no cone, and beside bundles, of which rays meet too many streamlines, not at all. Needs no legend: one changes the
 * camera's distance alone. */
static conus_status find_seen(struct picture *picture, const struct colour_pass *pass)
{
    const conus_view *options = &picture->options;
    const conus_atlas *atlas = picture->atlas;
    const bool leaves_out = pathways_first(atlas) || pathways_shown(atlas);
    const bool counts = options->selection
                            ? !leaves_out
                            : picture_lists_all(picture) || (picture->hazy->transfers && !options->probe_count);
    if (!counts || options->draft || picture->opacity || has_bundles(atlas) || has_frustum(options)) {
        return CONUS_OK;
    }
    picture->drawing[0] = options->width;
    picture->drawing[1] = options->height;
    conus_status status = place_camera(picture, pass);
    return status ? status : picture_see(picture);
}

/* Makes what is not hit glass where the camera sees nothing of a hit, unless somebody chose the camera, opacities, or
 * colours that tell less of what is hit. */
static conus_status reveal_hits(struct picture *picture)
{
    const conus_view *options = &picture->options;
    bool is_hidden = false;
    for (size_t i = 0; i < conus_selection_count(options->selection) && !is_hidden; i++) {
        const conus_result *result = conus_selection_result(options->selection, i);
        is_hidden = result->object && (result->pixels || result->pierced) && picture_is_hidden(picture, result->object);
    }
    if (!is_hidden || !picture->ranks || options->camera || options->opacity || options->pale > 0) {
        return CONUS_OK;
    }
    picture->options.pale = GLASS;
    memory_free(picture->seen);
    picture->seen = NULL;
    return find_opacities(picture);
}

/* Leaves out a context of which opaque areas would leave shreds. */
static conus_status leave_context(struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    bool is_covered = false;
    bool may_be =
        picture->options.no_covered_context && !picture->opacity && !pathways_first(atlas) && !pathways_shown(atlas);
    conus_status status = may_be ? conus_context_is_covered(&is_covered, atlas) : CONUS_OK;
    picture->options.fade = is_covered ? 1 : picture->options.fade;
    return status;
}

conus_status conus_render(conus_image **out, conus_renderer *renderer, const conus_view *view)
{
    struct picture picture = {
        .atlas = renderer->atlas, .hazy = &renderer->colour.hazy, .streamlines = &renderer->colour.streamlines};
    conus_status status = fill_options(&picture.options, view, renderer->atlas);
    if (status) {
        return status;
    }
    const bool has_ranks = picture_has_ranks(picture.options.selection, picture.options.own_colours);
    if (picture.options.selection || picture.options.probe_count || picture.options.point_count) {
        picture.emphasis = picture.options.selection
                               ? picture_emphasis(picture.options.selection, has_ranks ? 0 : picture.options.chosen)
                               : picture_probe_emphasis(&picture);
        status = picture.emphasis ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    picture_keep_listed(&picture);
    status = status || !picture.options.point_count ? status : picture_points_init(&picture);
    status = status ? status : find_opacities(&picture);
    status = status ? status : picture_rank(&picture, picture_is_dark(&picture.options));
    status = status ? status : renderer_include(renderer, picture.areas);
    status = status ? status : mark_streamlines(renderer, picture.options.selection);
    if (!status) {
        find_ball(&picture, &renderer->colour);
    }
    if (!status && picture.options.selection) {
        picture.view.group = picture.options.selection->group;
    }
    if (!status && picture.options.selection && picture.options.selection->region.shape != REGION_BALL) {
        add_cone(&picture);
    }
    status = status || picture.options.camera ? status : choose_side(&picture);
    status = status ? status : find_seen(&picture, &renderer->colour);
    status = status ? status : reveal_hits(&picture);
    status = status ? status : leave_context(&picture);
    status = status ? status : picture_prepare_sheet(&picture, renderer->max_memory, renderer->log, renderer->log_user);
    status = status ? status : place_camera(&picture, &renderer->colour);
    status = status ? status : draw(&picture, renderer);
    status = status ? status : make_image(out, &picture, renderer);
    picture_finish(&picture);
    return status;
}

conus_status conus_points_image(conus_image **out, const conus_atlas *atlas, const conus_view *view,
                                const conus_cut_view *cut, size_t chosen)
{
    struct picture picture = {.atlas = atlas, .first_named = chosen + 1};
    conus_image *image = NULL;
    double corners[2][3];
    conus_status status = fill_options(&picture.options, view, atlas);
    if (!status && (cut ? !(cut->mm_per_pixel > 0) : !picture.options.camera)) {
        status = fail(CONUS_ERROR_ARGUMENT, "points: a camera, or a cut of some mm per pixel, is needed");
    }
    status = status ? status : conus_atlas_bounds(corners[0], corners[1], atlas);
    if (status) {
        return status;
    }
    for (int a = 0; a < 3; a++) {
        picture.centre[a] = (corners[0][a] + corners[1][a]) / 2;
    }
    vec3_sub(corners[1], corners[1], picture.centre);
    picture.radius = vec3_length(corners[1]);
    picture.options.draft = true; /* no legend, and no word about what has no room */
    bool *shown = memory_zeroed(picture.options.point_count, sizeof *shown);
    status = shown ? picture_points_init(&picture) : CONUS_ERROR_MEMORY;
    status = status ? status : picture_prepare_sheet(&picture, memory_limit(0), NULL, NULL);
    status = status || cut ? status : place_camera(&picture, NULL);
    status = status ? status : image_create_listed(&image, picture.options.width, picture.sheet_height);
    if (!status) {
        status = cut ? picture_points_cut_whole(image->list, &picture, cut, shown)
                     : picture_points_draw(image->list, &picture);
    }
    status = status ? status : image_paint(image);
    memory_free(shown);
    picture_finish(&picture);
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

static conus_status check_window(const double size[2], const double eye[3])
{
    for (int a = 0; a < 2; a++) {
        if (!(size[a] > 0 && isfinite(size[a]))) {
            return fail(CONUS_ERROR_ARGUMENT, "size: %g x %g mm, allowed is more than 0", size[0], size[1]);
        }
    }
    return vec3_is_finite(eye)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "eye: %g,%g,%g, allowed are finite numbers", eye[0], eye[1], eye[2]);
}

conus_status conus_window_camera(conus_pose *camera, double frustum[4], const conus_pose *window, const double size[2],
                                 const double eye[3])
{
    conus_pose exact;
    double offset[3];
    double edges[4];
    conus_status status = check_window(size, eye);
    status = status ? status : conus_pose_from_matrix(&exact, window->world_from_device);
    if (status) {
        return fail_in(status, "window");
    }
    const double *m = exact.world_from_device;
    vec3_sub(offset, eye, m + 12);
    double before = vec3_dot(m + 8, offset); /* Eq. 1 */
    for (int k = 0; k < 4; k++) {
        edges[k] = ((k % 2 ? 0.5 : -0.5) * size[k / 2] - vec3_dot(m + 4 * (k / 2), offset)) / before;
        if (!(before > 0 && fabs(edges[k]) <= PICTURE_FRUSTUM_LIMIT)) {
            return fail(CONUS_ERROR_ARGUMENT, "eye: %g mm before the window, which is not far enough to see through it",
                        before);
        }
    }
    memcpy(exact.world_from_device + 12, eye, 3 * sizeof *eye);
    memcpy(frustum, edges, sizeof edges);
    *camera = exact;
    return CONUS_OK;
}
