/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws the cone in a cut: the inside slightly tinted, the wall as a line. */
#include "base/geometry/math3.h"
#include "render/flat/cut.h"

enum { TILE = 16 };

static const uint8_t cone_rgb[3] = {255, 170, 40};
static const double tint = 0.12;
static const double half_line = 1.3; /* pixels from the wall to where its line has faded */

struct drawing {
    uint8_t *rgba;
    const struct cut_place *place;
    const struct cut_cone *cone;
    struct cut_walk walk; /* in the world */
    double secant;
};

/* Pixels from the cone's wall, negative inside: it changes by at most 1 per pixel. */
static double distance_to_wall(const struct drawing *drawing, double column, double row)
{
    const struct cut_cone *cone = drawing->cone;
    const double *m = cone->world_from_cone;
    double offset[3];
    vec3_sub(offset, drawing->walk.start, m + 12);
    vec3_add_scaled(offset, offset, row, drawing->walk.down);
    vec3_add_scaled(offset, offset, column, drawing->walk.right);
    double depth = -vec3_dot(offset, m + 8);
    vec3_add_scaled(offset, offset, depth, m + 8);
    double wall = (vec3_length(offset) - cone->radius - depth * cone->slope) / drawing->secant;
    double before = cone->near - depth;
    double behind = depth - cone->far;
    double end = before > behind ? before : behind;
    return (wall > end ? wall : end) / drawing->place->mm_per_pixel;
}

static uint8_t *pixel_at(const struct drawing *drawing, uint32_t column, uint32_t row)
{
    return drawing->rgba + 4 * ((size_t)drawing->place->width * row + column);
}

/* A tile that is all inside or all outside needs one look only. */
static void draw_tile(const struct drawing *drawing, uint32_t left, uint32_t top)
{
    static const double reach = 0.7072 * TILE;
    uint32_t right = left + TILE < drawing->place->width ? left + TILE : drawing->place->width;
    uint32_t bottom = top + TILE < drawing->place->height ? top + TILE : drawing->place->height;
    double wall = distance_to_wall(drawing, left + TILE / 2.0, top + TILE / 2.0);
    if (wall > reach + half_line) {
        return;
    }
    bool inside = wall < -reach - half_line;
    for (uint32_t row = top; row < bottom; row++) {
        for (uint32_t column = left; column < right; column++) {
            if (inside) {
                cut_blend(pixel_at(drawing, column, row), cone_rgb, tint);
            } else {
                double outside = distance_to_wall(drawing, column, row);
                double line = 0.9 * fmin(fmax(half_line - fabs(outside), 0), 1);
                double opacity = fmax(line, outside < 0 ? tint : 0);
                if (opacity > 0) {
                    cut_blend(pixel_at(drawing, column, row), cone_rgb, opacity);
                }
            }
        }
    }
}

void cut_draw_cone(uint8_t *rgba, const struct cut_place *place, const struct cut_cone *cone)
{
    double identity[16];
    struct drawing drawing = {
        .rgba = rgba, .place = place, .cone = cone, .secant = sqrt(1 + cone->slope * cone->slope)};
    mat4_identity(identity);
    cut_walk_init(&drawing.walk, place, identity);
    for (uint32_t top = 0; top < place->height; top += TILE) {
        for (uint32_t left = 0; left < place->width; left += TILE) {
            draw_tile(&drawing, left, top);
        }
    }
}
