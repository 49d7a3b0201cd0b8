/* SPDX-License-Identifier: BSD-3-Clause */
/* Letters of directions and the scale of a picture, and all of its text. */
#include "selection/picture/picture.h"

#include "base/geometry/math3.h"
#include "render/flat/draw.h"

#include <stdio.h>
#include <string.h>

enum { CELL_SIZE = 24 };

/* The sine of 15 degrees: what an axis may lie off the picture's, and its letter is still at the edge. */
static const double ACROSS = 0.2588;

static const char letters[6][2] = {"L", "R", "P", "A", "I", "S"};

const char *picture_letter_of(const double axis[3])
{
    for (int a = 0; a < 3; a++) {
        if (axis[a] * axis[a] >= 1 - ACROSS * ACROSS) {
            return letters[2 * a + (axis[a] > 0)];
        }
    }
    return NULL;
}

/* Whether letters at the edges of the drawing say where it is seen from. */
static bool is_across(const struct picture *picture)
{
    const double *m = picture->camera.world_from_camera;
    return picture_letter_of(m) && picture_letter_of(m + 4);
}

static conus_status draw_edges(conus_image *image, const struct picture *picture)
{
    const double *m = picture->camera.world_from_camera;
    const struct camera_frame *frame = &picture->frame;
    double size = 1.5 * picture->em;
    double centre[2] = {(frame->left + (double)frame->width - frame->right) / 2,
                        (frame->top + (double)frame->height - frame->bottom) / 2};
    conus_status status = CONUS_OK;
    for (int n = 0; n < 4 && !status; n++) {
        double axis[3];
        double near = 0.7 * size;
        double at[2] = {centre[0], centre[1]};
        at[n / 2] = n == 0   ? fmax(frame->left - near, near)
                    : n == 1 ? fmin(frame->width - frame->right + near, frame->width - near)
                    : n == 2 ? frame->height - near
                             : near + frame->top - frame->bottom;
        vec3_scale(axis, m + (n < 2 ? 0 : 4), n % 2 ? 1 : -1);
        const char *letter = picture_letter_of(axis);
        const double corner[2] = {at[0] - font_width(picture->font, size, letter) / 2, at[1] + 0.36 * size};
        status = font_draw(picture->font, image, corner, size, picture->ink, letter);
    }
    return status;
}

/* Half an axis, from the middle of the cross towards `direction` (world). */
static conus_status draw_direction(conus_image *image, const struct picture *picture, const double direction[3],
                                   const char *letter)
{
    const double *m = picture->camera.world_from_camera;
    double size = picture->em;
    double length = 2.6 * size;
    const double centre[2] = {picture->drawing[0] - 1.9 * length, picture->drawing[1] - 1.8 * length};
    double x = vec3_dot(m, direction);
    double y = -vec3_dot(m + 4, direction);
    bool behind = vec3_dot(m + 8, direction) < 0;
    float rgba[4] = {picture->ink[0], picture->ink[1], picture->ink[2], behind ? 0.45F : 1}; /* no text */
    float letters_rgba[4] = {picture->ink[0], picture->ink[1], picture->ink[2], behind ? picture->dim : 1};
    const double end[2] = {centre[0] + length * x, centre[1] + length * y};
    double flat = sqrt(x * x + y * y);
    draw_line(image, centre, end, (behind ? 1.2 : 2.2) * picture->line, rgba);
    double out = flat > 0.15 ? 0.75 * size / flat : 0;
    const double corner[2] = {end[0] + out * x - font_width(picture->font, size, letter) / 2,
                              end[1] + out * y + 0.36 * size};
    return flat > 0.15 ? font_draw(picture->font, image, corner, size, letters_rgba, letter) : CONUS_OK;
}

static conus_status draw_directions(conus_image *image, const struct picture *picture)
{
    conus_status status = CONUS_OK;
    for (int n = 0; n < 6 && !status; n++) {
        double direction[3] = {0, 0, 0};
        direction[n / 2] = n % 2 ? 1 : -1;
        status = draw_direction(image, picture, direction, letters[n]);
    }
    return status;
}

conus_status picture_draw_bar(conus_image *image, const struct picture *picture, double pixels_per_mm, double beside)
{
    double size = picture->em;
    double limit = 0.14 * picture->drawing[0] / pixels_per_mm;
    double power = pow(10, floor(log10(limit)));
    double length = /* the largest of 1, 2, 5, 10, ... that is at most `limit` */
        limit >= 5 * power   ? 5 * power
        : limit >= 2 * power ? 2 * power
                             : power;
    char text[CELL_SIZE];
    snprintf(text, sizeof text, "%g mm", length);
    double right = picture->drawing[0] - beside * size;
    double left = right - length * pixels_per_mm;
    double base = picture->drawing[1] - 1.4 * size;
    double line = 2 * picture->line;
    draw_line(image, (double[]){left, base}, (double[]){right, base}, line, picture->ink);
    draw_line(image, (double[]){left, base - 0.3 * size}, (double[]){left, base + 0.3 * size}, line, picture->ink);
    draw_line(image, (double[]){right, base - 0.3 * size}, (double[]){right, base + 0.3 * size}, line, picture->ink);
    const double at[2] = {(left + right - font_width(picture->font, size, text)) / 2, base - 0.55 * size};
    return font_draw(picture->font, image, at, size, picture->ink, text);
}

/* For the depth of the middle of what shows. */
static conus_status draw_scale(conus_image *image, const struct picture *picture)
{
    double x, y, depth;
    if (!camera_project(&x, &y, &depth, &picture->camera, &picture->frame, picture->centre)) {
        return CONUS_OK;
    }
    double pixels_per_mm = picture->drawing[0] / (2 * depth * picture->camera.slope[0]);
    return picture_draw_bar(image, picture, pixels_per_mm, is_across(picture) ? 1.5 : 10.5);
}

/* Where the pathway's value is largest, world mm. */
static void find_peak(double out[3], const conus_atlas *atlas, uint32_t number)
{
    const struct volume *volume = atlas_object_volume(atlas, number);
    const size_t *dim = volume->info.dim;
    double most = -INFINITY;
    size_t best = 0;
    for (size_t v = volume_next(volume, 0); v < volume->voxel_count; v = volume_next(volume, v + 1)) {
        double value = volume_object(volume, v) == number ? (double)volume_value(volume, v) : -INFINITY;
        best = value > most ? v : best;
        most = fmax(most, value);
    }
    const size_t index[3] = {best % dim[0], best / dim[0] % dim[1], best / dim[0] / dim[1]};
    const double voxel[3] = {(double)index[0], (double)index[1], (double)index[2]};
    mat4_point(out, volume->info.world_from_voxel, voxel);
}

/* Black or white, whichever has the higher contrast to it. */
static float ink_on(const float rgba[4])
{
    return 0.2126F * rgba[0] + 0.7152F * rgba[1] + 0.0722F * rgba[2] > 0.179F ? 0 : 1;
}

/* The number of each pathway that the legend names by one, on a disc of its colour; beside one that is there. */
static conus_status draw_tags(conus_image *image, const struct picture *picture)
{
    enum { TAGS = 64 };
    double places[TAGS][2];
    size_t count = 0;
    const double radius = 0.75 * picture->em;
    conus_status status = CONUS_OK;
    for (uint32_t number = 1; number <= picture->atlas->object_count && count < TAGS && !status; number++) {
        size_t tag = picture_tag(picture, number);
        double peak[3];
        double *at = places[count];
        double depth;
        if (!tag) {
            continue;
        }
        find_peak(peak, picture->atlas, number);
        if (!camera_project(&at[0], &at[1], &depth, &picture->camera, &picture->frame, peak)) {
            continue;
        }
        for (size_t i = 0; i < count; i++) {
            bool is_free = hypot(at[0] - places[i][0], at[1] - places[i][1]) > 2.2 * radius;
            at[0] += is_free ? 0 : 2.4 * radius;
            i = is_free ? i : (size_t)-1; /* and again from the first one */
        }
        count++;
        float colour[4];
        draw_colour(colour, picture->atlas->objects[number - 1].rgb, 1);
        const float grey = ink_on(colour);
        const float ink[4] = {grey, grey, grey, 1};
        const struct draw_box disc = {at[0] - radius, at[1] - radius, at[0] + radius, at[1] + radius};
        char text[CELL_SIZE];
        snprintf(text, sizeof text, "%zu", tag);
        const double corner[2] = {at[0] - font_width(picture->font, picture->em, text) / 2, at[1] + 0.36 * picture->em};
        draw_box(image, &disc, radius, colour);
        draw_frame(image, &disc, radius, fmax(1, 0.1 * picture->em), ink);
        status = font_draw(picture->font, image, corner, picture->em, ink, text);
    }
    return status;
}

conus_status picture_annotate(conus_image *image, const struct picture *picture)
{
    conus_status status = picture->legend ? draw_tags(image, picture) : CONUS_OK;
    status = status || !picture->legend ? status : picture_legend_draw(image, picture);
    if (!status) {
        status = is_across(picture) ? draw_edges(image, picture) : draw_directions(image, picture);
    }
    return status ? status : draw_scale(image, picture);
}

conus_status picture_annotate_cut(conus_image *image, struct picture *picture, double mm_per_pixel)
{
    conus_status status = picture->legend ? picture_legend_draw(image, picture) : CONUS_OK;
    memcpy(picture->ink, (const float[]){0.83F, 0.83F, 0.86F, 1}, sizeof picture->ink); /* on black, mostly */
    if (!status && is_across(picture)) {
        status = draw_edges(image, picture);
    }
    return status ? status : picture_draw_bar(image, picture, 1 / mm_per_pixel, 1.5);
}
