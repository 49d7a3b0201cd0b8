/* SPDX-License-Identifier: BSD-3-Clause */
/* The streamlines that the plane passes: pixels whose centre is no farther from one than its radius. */
#include "atlas/bundles.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/flat/cut.h"

/* Minimum thickness, so that no line falls between pixel centres. */
static const double LEAST_RADIUS = 0.75; /* pixels */

/* World to pixels: across, down and through the plane, from the middle of the top left pixel. */
struct frame {
    double axes[3][3], start[3];
    double radius; /* pixels */
    struct cut *cut;
    const struct tractogram *tractogram;
    const uint32_t *objects; /* [streamline_count] 0 = not shown */
};

static double along(const struct frame *frame, int axis, const double world[3])
{
    return vec3_dot(frame->axes[axis], world) + frame->start[axis];
}

/* Whether tubes in the box may be visible. */
static enum tract_answer test_box(void *user, const double low[3], const double high[3])
{
    const struct frame *frame = user;
    const double limit[3] = {frame->cut->of.width - 1.0, frame->cut->of.height - 1.0, 0};
    double middle[3];
    double half[3];
    vec3_sub(half, high, low);
    vec3_scale(half, half, 0.5);
    vec3_add_scaled(middle, low, 1, half);
    for (int a = 0; a < 3; a++) {
        double at = along(frame, a, middle);
        double reach = frame->radius + 1e-6;
        for (int k = 0; k < 3; k++) {
            reach += fabs(frame->axes[a][k]) * half[k];
        }
        if (at + reach < 0 || at - reach > limit[a]) {
            return TRACT_OUTSIDE;
        }
    }
    return TRACT_PERHAPS;
}

/* The part of a segment that is near the plane, by s from 0 to 1; false where none is. */
static bool clip_to_plane(double part[2], double from, double to, double radius)
{
    double step = to - from;
    part[0] = 0;
    part[1] = 1;
    if (step != 0) {
        double first = (-radius - from) / step;
        double last = (radius - from) / step;
        part[0] = fmax(fmin(first, last), 0);
        part[1] = fmin(fmax(first, last), 1);
    }
    return part[0] <= part[1] && fabs(from + part[0] * step) <= radius * (1 + 1e-9);
}

static bool is_near(const double a[3], const double step[3], double x, double y, double radius)
{
    const double p[3] = {x - a[0], y - a[1], -a[2]};
    double square = vec3_dot(step, step);
    double s = square > 0 ? fmin(fmax(vec3_dot(p, step) / square, 0), 1) : 0;
    double away[3];
    vec3_add_scaled(away, p, -s, step);
    return vec3_dot(away, away) <= radius * radius;
}

/* The first pixel from `at` on and the last up to it, of `count`. */
static uint32_t first_pixel(double at)
{
    return at > 0 ? (uint32_t)ceil(at) : 0;
}

static uint32_t end_pixel(double at, uint32_t count)
{
    return at < 0 ? 0 : at >= count - 1 ? count : (uint32_t)at + 1;
}

/* Where several bundles meet in a pixel, the lowest number has it, whatever the order. */
static void draw_segment(const struct frame *frame, const double a[3], const double b[3], uint32_t object)
{
    struct cut *cut = frame->cut;
    const double radius = frame->radius;
    double step[3];
    double part[2];
    vec3_sub(step, b, a);
    if (!clip_to_plane(part, a[2], b[2], radius)) {
        return;
    }
    double ends[2][2];
    for (int k = 0; k < 2; k++) {
        ends[0][k] = fmin(a[k] + part[0] * step[k], a[k] + part[1] * step[k]) - radius;
        ends[1][k] = fmax(a[k] + part[0] * step[k], a[k] + part[1] * step[k]) + radius;
    }
    const uint32_t bottom = end_pixel(ends[1][1], cut->of.height);
    const uint32_t right = end_pixel(ends[1][0], cut->of.width);
    for (uint32_t row = first_pixel(ends[0][1]); row < bottom; row++) {
        for (uint32_t column = first_pixel(ends[0][0]); column < right; column++) {
            uint32_t *pixel = &cut->objects[(size_t)cut->of.width * row + column];
            bool is_free = !*pixel || object < *pixel || !cut->atlas->places[*pixel - 1].is_bundle;
            if (is_free && is_near(a, step, column, row, radius)) {
                *pixel = object;
            }
        }
    }
}

static void draw_run(void *user, const struct tract_run *run, bool inside)
{
    (void)inside;
    const struct frame *frame = user;
    uint32_t object = frame->objects[run->streamline];
    for (uint32_t k = 0; object && (k < run->segments || k == 0); k++) {
        double world[2][3];
        double ends[2][3];
        tractogram_point(world[0], frame->tractogram, run->point + k);
        tractogram_point(world[1], frame->tractogram, run->point + (k < run->segments ? k + 1 : k));
        for (int n = 0; n < 2; n++) {
            for (int a = 0; a < 3; a++) {
                ends[n][a] = along(frame, a, world[n]);
            }
        }
        draw_segment(frame, ends[0], ends[1], object);
    }
}

conus_status cut_list_streamlines(struct cut *cut)
{
    const conus_atlas *atlas = cut->atlas;
    cut->streamlines = memory_zeroed(atlas->tractogram_count, sizeof *cut->streamlines);
    conus_status status = cut->streamlines ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < atlas->tractogram_count && !status; i++) {
        const struct tractogram *tractogram = &atlas->tractograms[i];
        cut->streamlines[i] = memory_zeroed(tractogram->streamline_count, sizeof **cut->streamlines);
        if (cut->streamlines[i]) {
            bundles_find_objects(cut->streamlines[i], atlas, tractogram);
        } else {
            status = CONUS_ERROR_MEMORY;
        }
    }
    return status;
}

void cut_find_streamlines(struct cut *cut, const struct cut_view *view)
{
    for (size_t i = 0; i < cut->atlas->tractogram_count; i++) {
        const struct tractogram *tractogram = &cut->atlas->tractograms[i];
        struct frame frame = {.radius = fmax(tractogram->radius / view->place.mm_per_pixel, LEAST_RADIUS),
                              .cut = cut,
                              .tractogram = tractogram,
                              .objects = cut->streamlines[i]};
        vec3_scale(frame.axes[0], view->place.right, 1 / view->place.mm_per_pixel);
        vec3_scale(frame.axes[1], view->place.up, -1 / view->place.mm_per_pixel);
        vec3_cross(frame.axes[2], view->place.right, view->place.up);
        vec3_scale(frame.axes[2], frame.axes[2], 1 / view->place.mm_per_pixel);
        const double middle[3] = {0.5 * view->place.width - 0.5, 0.5 * view->place.height - 0.5, 0};
        for (int a = 0; a < 3; a++) {
            frame.start[a] = middle[a] - vec3_dot(frame.axes[a], view->place.centre);
        }
        tract_tree_walk(tractogram, test_box, draw_run, &frame);
    }
}
