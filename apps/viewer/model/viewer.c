/* SPDX-License-Identifier: BSD-3-Clause */
/* The viewer: creation, the cone, confirmed results, crosshair. */
#include "viewer/model/viewer.h"

#include "link/clock.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double default_angle = 10;

void viewer_say(struct viewer *viewer, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(viewer->message, sizeof viewer->message, format, arguments);
    va_end(arguments);
    viewer->said++;
}

/* ---- Creation --------------------------------------------------------------------------------------------------- */

static void find_ball(struct viewer *viewer)
{
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    if (conus_atlas_bounds(low, high, viewer->atlas)) {
        memset(low, 0, sizeof low);
        memset(high, 0, sizeof high);
    }
    double square = 0;
    for (int a = 0; a < 3; a++) {
        viewer->centre[a] = (low[a] + high[a]) / 2;
        square += (high[a] - low[a]) * (high[a] - low[a]) / 4;
    }
    viewer->radius = fmax(0.72 * sqrt(square), 1); /* brains are round: corners of their boxes are empty */
}

size_t viewer_context(const struct viewer *viewer)
{
    size_t i = 0;
    while (i < conus_atlas_volume_count(viewer->atlas) &&
           conus_atlas_volume(viewer->atlas, i)->role != CONUS_ROLE_CONTEXT) {
        i++;
    }
    return i;
}

/* Once, and not for every cut. */
static void find_window(struct viewer *viewer)
{
    size_t context = viewer_context(viewer);
    if (context < conus_atlas_volume_count(viewer->atlas) &&
        conus_atlas_window(viewer->display.window, viewer->atlas, context)) {
        viewer->display.window[0] = viewer->display.window[1] = 0;
    }
}

conus_status viewer_create(struct viewer *out, conus_atlas *atlas, const char *path, const char *transfer,
                           conus_log log, void (*wake)(void))
{
    struct viewer viewer = {.atlas = atlas,
                            .atlas_path = strdup(path),
                            .transfer = transfer,
                            .cone = {.angle = default_angle},
                            .wake = wake};
    viewer.object_count = conus_atlas_object_count(atlas);
    bool has_shown = shown_init(&viewer.shown, atlas);
    viewer.display.fill = 0.45;
    viewer.cone.options.log = log;
    viewer.watch = watch_create(atlas);
    find_ball(&viewer);
    find_window(&viewer);
    viewer.magnification = 1;
    memcpy(viewer.crosshair, viewer.centre, sizeof viewer.crosshair);
    orbit_look_at(&viewer.orbit, viewer.centre, viewer.radius);
    if (!has_shown || !viewer.atlas_path || !painter_create(&viewer.painter, atlas, transfer, log, wake)) {
        watch_destroy(viewer.watch);
        shown_finish(&viewer.shown);
        free(viewer.atlas_path);
        return CONUS_ERROR_MEMORY;
    }
    *out = viewer;
    return CONUS_OK;
}

void viewer_finish(struct viewer *viewer)
{
    painter_destroy(viewer->painter);
    answer_drop(viewer->cone.answer);
    conus_selector_destroy(viewer->cone.selector);
    conus_selector_destroy(viewer->picker);
    shown_finish(&viewer->shown);
    watch_destroy(viewer->watch);
    free(viewer->atlas_path);
    conus_atlas_destroy(viewer->atlas);
    *viewer = (struct viewer){0};
}

/* ---- The cone --------------------------------------------------------------------------------------------------- */

const conus_selection *viewer_selection(const struct viewer *viewer)
{
    return answer_selection(viewer->cone.answer);
}

static conus_status make_selector(struct viewer *viewer)
{
    return viewer->cone.selector ? CONUS_OK
                                 : conus_selector_create(&viewer->cone.selector, viewer->atlas, &viewer->cone.options);
}

static void select_now(struct viewer *viewer)
{
    conus_selection *selection = NULL;
    double angle = viewer->cone.options.radius > 0 ? 0 : viewer->cone.angle * M_PI / 180;
    conus_status status = make_selector(viewer);
    double begun = clock_ms();
    status = status ? status : conus_select(&selection, viewer->cone.selector, &viewer->cone.pose, angle);
    viewer->cone.select_ms = clock_ms() - begun;
    struct answer *answer = status ? NULL : answer_create(selection);
    if (!answer) {
        conus_selection_destroy(selection);
        viewer_say(viewer, "%s", status ? conus_message() : "not enough memory");
        return;
    }
    answer_drop(viewer->cone.answer);
    viewer->cone.answer = answer;
    viewer->cone.answer_number++;
    viewer->version++;
}

void viewer_aim(struct viewer *viewer, const conus_pose *pose)
{
    viewer->cone.pose = *pose;
    viewer->cone.has_pose = true;
    select_now(viewer);
}

void viewer_aim_along(struct viewer *viewer, const double origin[3], const double direction[3])
{
    conus_pose pose;
    if (conus_pose_along(&pose, origin, direction, NULL)) {
        viewer_say(viewer, "%s", conus_message());
    } else {
        viewer_aim(viewer, &pose);
    }
}

void viewer_place(struct viewer *viewer)
{
    static const double in_front = 1.6; /* radii from the middle, towards the face (+y) */
    const double *c = viewer->centre;
    if (!viewer->cone.has_pose) {
        viewer_aim_along(viewer, (double[]){c[0], c[1] + in_front * viewer->radius, c[2]}, (double[]){0, -1, 0});
    }
}

void viewer_reselect(struct viewer *viewer)
{
    conus_selector_destroy(viewer->cone.selector);
    viewer->cone.selector = NULL;
    viewer->version++;
    if (viewer->cone.has_pose) {
        select_now(viewer);
    }
}

static double distance_between(const double a[3], const double b[3])
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        square += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(square);
}

void viewer_pin(struct viewer *viewer, uint32_t object, double share, double distance, const double contact[3])
{
    if (viewer->pin_count == PIN_LIMIT) {
        memmove(viewer->pins, viewer->pins + 1, (PIN_LIMIT - 1) * sizeof *viewer->pins);
        viewer->pin_count--;
    }
    const struct pin *last = viewer->pin_count ? &viewer->pins[viewer->pin_count - 1] : NULL;
    struct pin pin = {.object = object, .share = share, .distance = distance};
    snprintf(pin.name, sizeof pin.name, "%s", conus_atlas_object(viewer->atlas, object)->name);
    memcpy(pin.contact, contact, sizeof pin.contact);
    pin.apart = last ? distance_between(last->contact, pin.contact) : NAN;
    viewer->pins[viewer->pin_count++] = pin;
}

void viewer_confirm(struct viewer *viewer)
{
    const conus_result *best = conus_selection_result(viewer_selection(viewer), 0);
    if (!best || !best->object) {
        viewer_say(viewer, "nothing in the cone to confirm");
        return;
    }
    viewer_pin(viewer, best->object, best->share, best->distance, best->contact);
    viewer_say(viewer, "confirmed: %s, %.1f mm from the device", viewer->pins[viewer->pin_count - 1].name,
               best->distance);
}

char *viewer_pins_text(const struct viewer *viewer)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) {
        return NULL;
    }
    fputs("name\tshare\tdistance_mm\tcontact_x\tcontact_y\tcontact_z\tapart_mm\n", out);
    for (size_t i = 0; i < viewer->pin_count; i++) {
        const struct pin *pin = &viewer->pins[i];
        fprintf(out, "%s\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t", pin->name, pin->share, pin->distance, pin->contact[0],
                pin->contact[1], pin->contact[2]);
        fprintf(out, isnan(pin->apart) ? "n/a\n" : "%.9g\n", pin->apart);
    }
    fclose(out);
    return text;
}

/* Of what was selected; the report is the caller's to destroy, also on failure. */
static conus_status make_report(conus_report **report, struct viewer *viewer, const char **text, size_t *size)
{
    const conus_report_options options = {.format = CONUS_FORMAT_TSV};
    conus_status status = make_selector(viewer);
    status = status ? status : conus_report_create(report, viewer->cone.selector, &options);
    status = status || !viewer->cone.answer ? status : conus_report_add(*report, "1", viewer_selection(viewer));
    return status ? status : conus_report_text(text, size, *report);
}

char *viewer_results_text(struct viewer *viewer)
{
    conus_report *report = NULL;
    const char *text;
    size_t size;
    char *copy = make_report(&report, viewer, &text, &size) ? NULL : strdup(text);
    conus_report_destroy(report);
    return copy;
}

conus_status viewer_write_results(struct viewer *viewer, const char *path)
{
    conus_report *report = NULL;
    const char *text;
    size_t size;
    conus_status status = make_report(&report, viewer, &text, &size);
    status = status ? status : conus_write_file(path, text, size);
    conus_report_destroy(report);
    return status;
}

conus_status viewer_write_picture(const struct viewer *viewer, const struct sight *sight, const char *path,
                                  uint32_t width, uint32_t height)
{
    conus_renderer *renderer = NULL;
    conus_image *image = NULL;
    struct sight fitted = *sight;
    sight_fit(&fitted, (double[]){width, height});
    const double *f = fitted.frustum;
    const conus_renderer_options options = {.transfer = viewer->transfer};
    const conus_view view = {.width = width,
                             .height = height,
                             .frustum = {f[0], f[1], f[2], f[3]},
                             .camera = &fitted.camera,
                             .selection = viewer_selection(viewer),
                             .chosen = viewer->shown.chosen,
                             .fade = viewer->display.fade};
    conus_status status = conus_renderer_create(&renderer, viewer->atlas, &options);
    const struct transfer_editor *editor = &viewer->transfer_editor;
    if (!status && editor->edited) {
        status = conus_renderer_set_transfer(renderer, editor->points, editor->count);
    }
    status = status ? status : conus_render(&image, renderer, &view);
    status = status ? status : conus_image_write(image, path);
    conus_image_destroy(image);
    conus_renderer_destroy(renderer);
    return status;
}

void viewer_rest_selectors(struct viewer *viewer)
{
    conus_selector_destroy(viewer->cone.selector);
    conus_selector_destroy(viewer->picker);
    viewer->cone.selector = viewer->picker = NULL;
    viewer->atlas_number++;
}

/* ---- The crosshair ---------------------------------------------------------------------------------------------- */

void viewer_cross(struct viewer *viewer, const double at[3])
{
    static const double farthest = 1.5; /* radii from the middle, along each axis */
    for (int a = 0; a < 3; a++) {
        double most = farthest * viewer->radius;
        viewer->crosshair[a] = viewer->centre[a] + fmin(fmax(at[a] - viewer->centre[a], -most), most);
    }
    viewer->version++;
}

/* Solves world_from_voxel v = at by Cramer's rule. */
static bool find_voxel(double voxel[3], const double m[16], const double at[3])
{
    double d[3];
    double minors[3][3];
    for (int a = 0; a < 3; a++) {
        d[a] = at[a] - m[12 + a];
    }
    for (int c = 0; c < 3; c++) {
        const double *p = m + 4 * ((c + 1) % 3);
        const double *q = m + 4 * ((c + 2) % 3);
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3;
            int e = (a + 2) % 3;
            minors[c][a] = p[b] * q[e] - p[e] * q[b];
        }
    }
    double determinant = m[0] * minors[0][0] + m[1] * minors[0][1] + m[2] * minors[0][2];
    for (int c = 0; c < 3 && determinant != 0; c++) {
        voxel[c] = (d[0] * minors[c][0] + d[1] * minors[c][1] + d[2] * minors[c][2]) / determinant;
    }
    return determinant != 0;
}

bool viewer_voxel(long voxel[3], const struct viewer *viewer, const double at[3])
{
    double exact[3];
    const conus_volume_info *info = conus_atlas_volume(viewer->atlas, 0); /* the parcellation is the first */
    bool inside = info && find_voxel(exact, info->world_from_voxel, at);
    for (int a = 0; a < 3 && inside; a++) {
        double cell = floor(exact[a] + 0.5);
        inside = cell >= 0 && cell < (double)info->dim[a];
        voxel[a] = inside ? (long)cell : 0;
    }
    return inside;
}

void viewer_choose(struct viewer *viewer, uint32_t object)
{
    double middle[3];
    viewer->shown.chosen = object;
    viewer->version++;
    if (object && !conus_atlas_centre(middle, viewer->atlas, object)) {
        viewer_cross(viewer, middle);
    }
}

void viewer_colour(uint8_t rgb[3], const struct viewer *viewer, uint32_t object)
{
    const conus_object *info = conus_atlas_object(viewer->atlas, object);
    memcpy(rgb, info ? info->rgb : (const uint8_t[]){130, 132, 138}, 3);
}

void viewer_plane(double right[3], double up[3], const struct viewer *viewer, enum plane plane)
{
    static const double axes[PLANE_COUNT][2][3] = {
        {{1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 0, 1}}, {{0, 1, 0}, {0, 0, 1}}};
    memcpy(right, axes[plane][0], 3 * sizeof *right);
    memcpy(up, axes[plane][1], 3 * sizeof *up);
    if (viewer->display.radiological && plane != SAGITTAL) {
        right[0] = -right[0];
    }
}
