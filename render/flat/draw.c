/* SPDX-License-Identifier: BSD-3-Clause */
/* Every shape is a signed distance: the coverage of a pixel follows from the distance of its centre. */
#include "render/flat/draw.h"
#include "render/image/image_srgb.h"
#include "render/image/shapes.h"

#include <math.h>

struct shape {
    double (*distance)(const struct shape *shape, double x, double y); /* negative inside */
    double from[2], to[2];                                             /* of a line; left top, right bottom of a box */
    double radius;                                                     /* half width; rounding */
    double frame;                                                      /* width of the outline; 0 = filled */
};

void draw_colour(float rgba[4], const uint8_t rgb[3], float opacity)
{
    for (int c = 0; c < 3; c++) {
        rgba[c] = (float)linear_from_srgb(rgb[c] / 255.0);
    }
    rgba[3] = opacity;
}

void draw_over(const struct image_rgba *planes, size_t pixel, const float rgba[4], float coverage)
{
    float opacity = rgba[3] * coverage;
    for (int c = 0; c < 3; c++) {
        planes->plane[c][pixel] = rgba[c] * opacity + (1 - opacity) * planes->plane[c][pixel];
    }
    planes->plane[3][pixel] = opacity + (1 - opacity) * planes->plane[3][pixel];
}

/* First and one past the last pixel that a shape from `low` to `high` can touch. */
static void limit(long range[2], double low, double high, uint32_t size)
{
    range[0] = lrint(fmin(fmax(floor(low - 1), 0), size));
    range[1] = lrint(fmin(fmax(ceil(high + 1), 0), size));
}

static void fill_shape(conus_image *image, const struct shape *shape, const struct draw_box *bounds,
                       const float rgba[4])
{
    const struct image_rgba planes = image_rgba(image);
    if (!planes.plane[0] || !planes.plane[1] || !planes.plane[2] || !planes.plane[3]) {
        return;
    }
    long columns[2];
    long rows[2];
    limit(columns, bounds->left, bounds->right, image->width);
    limit(rows, bounds->top, bounds->bottom, image->height);
    for (long j = rows[0]; j < rows[1]; j++) {
        for (long i = columns[0]; i < columns[1]; i++) {
            double distance = shape->distance(shape, (double)i + 0.5, (double)j + 0.5);
            if (shape->frame > 0) {
                distance = fmax(distance, -distance - shape->frame);
            }
            double coverage = fmin(fmax(0.5 - distance, 0), 1);
            if (coverage > 0) {
                draw_over(&planes, (size_t)j * image->width + (size_t)i, rgba, (float)coverage);
            }
        }
    }
}

static double distance_to_line(const struct shape *shape, double x, double y)
{
    double along[2] = {shape->to[0] - shape->from[0], shape->to[1] - shape->from[1]};
    double offset[2] = {x - shape->from[0], y - shape->from[1]};
    double length2 = along[0] * along[0] + along[1] * along[1];
    double t = length2 > 0 ? (offset[0] * along[0] + offset[1] * along[1]) / length2 : 0;
    t = fmin(fmax(t, 0), 1);
    return hypot(offset[0] - t * along[0], offset[1] - t * along[1]) - shape->radius;
}

static double distance_to_box(const struct shape *shape, double x, double y)
{
    double dx = fmax(shape->from[0] - x, x - shape->to[0]) + shape->radius;
    double dy = fmax(shape->from[1] - y, y - shape->to[1]) + shape->radius;
    return hypot(fmax(dx, 0), fmax(dy, 0)) + fmin(fmax(dx, dy), 0) - shape->radius;
}

void draw_line(conus_image *image, const double from[2], const double to[2], double width, const float rgba[4])
{
    if (image->shapes) {
        shapes_add(image->shapes, &(struct image_shape){.kind = SHAPE_LINE,
                                                        .from = {from[0], from[1]},
                                                        .to = {to[0], to[1]},
                                                        .width = width,
                                                        .rgba = {rgba[0], rgba[1], rgba[2], rgba[3]}});
        return;
    }
    const struct shape shape = {distance_to_line, {from[0], from[1]}, {to[0], to[1]}, width / 2, 0};
    const struct draw_box bounds = {fmin(from[0], to[0]) - shape.radius, fmin(from[1], to[1]) - shape.radius,
                                    fmax(from[0], to[0]) + shape.radius, fmax(from[1], to[1]) + shape.radius};
    fill_shape(image, &shape, &bounds, rgba);
}

void draw_box(conus_image *image, const struct draw_box *box, double rounding, const float rgba[4])
{
    draw_frame(image, box, rounding, 0, rgba);
}

void draw_frame(conus_image *image, const struct draw_box *box, double rounding, double width, const float rgba[4])
{
    if (image->shapes) {
        shapes_add(image->shapes, &(struct image_shape){.kind = SHAPE_BOX,
                                                        .from = {box->left, box->top},
                                                        .to = {box->right, box->bottom},
                                                        .width = width,
                                                        .rounding = rounding,
                                                        .rgba = {rgba[0], rgba[1], rgba[2], rgba[3]}});
        return;
    }
    const struct shape shape = {distance_to_box, {box->left, box->top}, {box->right, box->bottom}, rounding, width};
    fill_shape(image, &shape, box, rgba);
}
