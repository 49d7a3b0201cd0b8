/* SPDX-License-Identifier: BSD-3-Clause */
#include "render/cut.h"

#include "base/math3.h"
#include "base/memory.h"

#include <string.h>

enum { HATCH = 6, PALE = 40 };

static const uint8_t cone_rgb[3] = {255, 170, 40};

/* A picture in the making. */
struct cut {
    const conus_atlas *atlas;
    const struct cut_view *view;
    uint8_t *rgba;
    uint32_t *objects; /* [height * width] */
};

/* How a pixel steps through a volume's index space. */
struct walk {
    double start[3], right[3], down[3]; /* of the top left pixel's centre, and per pixel */
};

static void walk_init(struct walk *out, const struct cut_view *view, const double index_from_world[16])
{
    double corner[3];
    double right[3];
    double down[3];
    vec3_scale(right, view->right, view->mm_per_pixel);
    vec3_scale(down, view->up, -view->mm_per_pixel);
    vec3_add_scaled(corner, view->centre, 0.5 - 0.5 * view->width, right);
    vec3_add_scaled(corner, corner, 0.5 - 0.5 * view->height, down);
    mat4_point(out->start, index_from_world, corner);
    mat4_direction(out->right, index_from_world, right);
    mat4_direction(out->down, index_from_world, down);
}

static void walk_at(double out[3], const struct walk *walk, uint32_t column, uint32_t row)
{
    vec3_add_scaled(out, walk->start, column, walk->right);
    vec3_add_scaled(out, out, row, walk->down);
}

static void blend(uint8_t *pixel, const uint8_t rgb[3], double opacity)
{
    for (int c = 0; c < 3; c++) {
        pixel[c] = (uint8_t)(pixel[c] + (rgb[c] - pixel[c]) * opacity + 0.5);
    }
}

/* ---- The context --------------------------------------------------------------------------------------------- */

static double trilinear(const struct volume *volume, const double p[3])
{
    const size_t *dim = volume->info.dim;
    size_t low[3];
    double part[3];
    for (int a = 0; a < 3; a++) {
        double x = fmin(fmax(p[a], 0), (double)dim[a] - 1);
        low[a] = (size_t)x;
        low[a] -= low[a] > 0 && low[a] == dim[a] - 1;
        part[a] = x - (double)low[a];
    }
    double sum = 0;
    for (unsigned n = 0; n < 8; n++) {
        double weight = 1;
        size_t at[3];
        for (unsigned a = 0; a < 3; a++) {
            size_t step = n >> a & 1;
            weight *= step ? part[a] : 1 - part[a];
            at[a] = low[a] + step < dim[a] ? low[a] + step : dim[a] - 1;
        }
        if (weight > 0) {
            sum += weight * (double)volume->values[at[0] + dim[0] * (at[1] + dim[1] * at[2])];
        }
    }
    return sum;
}

static bool is_in_grid(const struct volume *volume, const double p[3])
{
    for (int a = 0; a < 3; a++) {
        if (!(p[a] >= -0.5 && p[a] < (double)volume->info.dim[a] - 0.5)) {
            return false;
        }
    }
    return true;
}

static void draw_context(const struct cut *cut, const struct volume *volume)
{
    const struct cut_view *view = cut->view;
    double scale = 255 / (view->window[1] - view->window[0]);
    struct walk walk;
    walk_init(&walk, view, volume->voxel_from_world);
    for (uint32_t row = 0; row < view->height; row++) {
        uint8_t *pixel = cut->rgba + (size_t)4 * view->width * row;
        for (uint32_t column = 0; column < view->width; column++, pixel += 4) {
            double p[3];
            walk_at(p, &walk, column, row);
            if (is_in_grid(volume, p)) {
                double grey = (trilinear(volume, p) - view->window[0]) * scale;
                memset(pixel, (int)fmin(fmax(grey, 0), 255), 3);
            }
        }
    }
}

/* ---- Areas and pathways ---------------------------------------------------------------------------------------- */

static bool is_hidden(const struct cut_view *view, uint32_t object)
{
    return view->hidden && view->hidden[object];
}

/* What is drawn of `volume` at a point of its index space; 0 = nothing. */
static uint32_t shown_at(const struct cut_view *view, const struct volume *volume, const double p[3])
{
    const size_t *dim = volume->info.dim;
    if (!is_in_grid(volume, p)) {
        return 0;
    }
    size_t i = (size_t)(p[0] + 0.5);
    size_t j = (size_t)(p[1] + 0.5);
    size_t k = (size_t)(p[2] + 0.5);
    uint32_t object = volume_object(volume, i + dim[0] * (j + dim[1] * k));
    return object == VOLUME_BLOCKER || is_hidden(view, object) ? 0 : object;
}

/* Notes which object of `volume` each pixel is in; later volumes lie over earlier ones. */
static void find_objects(const struct cut *cut, const struct volume *volume)
{
    const struct cut_view *view = cut->view;
    struct walk walk;
    walk_init(&walk, view, volume->voxel_from_world);
    for (uint32_t row = 0; row < view->height; row++) {
        for (uint32_t column = 0; column < view->width; column++) {
            double p[3];
            walk_at(p, &walk, column, row);
            uint32_t object = shown_at(view, volume, p);
            uint32_t *at = &cut->objects[(size_t)view->width * row + column];
            *at = object ? object : *at;
        }
    }
}

static double opacity_of(const struct cut_view *view, uint32_t object, uint32_t column, uint32_t row)
{
    switch (view->emphasis ? view->emphasis[object] : EMPHASIS_FULL) {
    case EMPHASIS_FULL:
        return view->fill;
    case EMPHASIS_HATCHED:
        return (column + row) % HATCH < HATCH / 3 ? fmin(1.6 * view->fill, 1) : 0.35 * view->fill;
    default:
        return view->fill * PALE / 100;
    }
}

/* An area's outline is its own pixels that have another neighbour to the right, or below. */
static bool is_outline(const struct cut *cut, uint32_t column, uint32_t row)
{
    const struct cut_view *view = cut->view;
    const uint32_t *at = cut->objects + (size_t)view->width * row + column;
    return (column > 0 && at[-1] != *at) || (column + 1 < view->width && at[1] != *at) ||
           (row > 0 && *(at - view->width) != *at) || (row + 1 < view->height && at[view->width] != *at);
}

static void draw_objects(const struct cut *cut)
{
    const struct cut_view *view = cut->view;
    for (uint32_t row = 0; row < view->height; row++) {
        for (uint32_t column = 0; column < view->width; column++) {
            size_t at = (size_t)view->width * row + column;
            uint32_t object = cut->objects[at];
            if (object) {
                bool edge = !view->no_outlines && is_outline(cut, column, row);
                double opacity = opacity_of(view, object, column, row);
                blend(cut->rgba + 4 * at, cut->atlas->objects[object - 1].rgb, edge ? 1 : opacity);
            }
        }
    }
}

/* ---- Meshes: the lines in which the plane cuts their triangles ------------------------------------------------- */

static void draw_line(const struct cut *cut, const double from[2], const double to[2], const uint8_t rgb[3])
{
    const struct cut_view *view = cut->view;
    double length = fmax(fabs(to[0] - from[0]), fabs(to[1] - from[1]));
    unsigned steps = (unsigned)fmin(ceil(length), 4.0 * (view->width + view->height)) + 1;
    for (unsigned s = 0; s <= steps; s++) {
        double x = from[0] + (to[0] - from[0]) * s / steps;
        double y = from[1] + (to[1] - from[1]) * s / steps;
        if (x >= 0 && y >= 0 && x < view->width && y < view->height) {
            size_t at = (size_t)view->width * (size_t)y + (size_t)x;
            memcpy(cut->rgba + 4 * at, rgb, 3);
        }
    }
}

/* A point in the pane: pixels right of and below its top left corner, and mm before it. */
static void to_pane(double out[3], const struct cut_view *view, const float position[3])
{
    double offset[3];
    double forward[3];
    for (int a = 0; a < 3; a++) {
        offset[a] = (double)position[a] - view->centre[a];
    }
    vec3_cross(forward, view->right, view->up);
    out[0] = vec3_dot(offset, view->right) / view->mm_per_pixel + 0.5 * view->width;
    out[1] = 0.5 * view->height - vec3_dot(offset, view->up) / view->mm_per_pixel;
    out[2] = vec3_dot(offset, forward);
}

static void cut_triangle(const struct cut *cut, const struct mesh *mesh, size_t triangle, const uint8_t rgb[3])
{
    double corner[3][3];
    double ends[3][2];
    int found = 0;
    for (size_t k = 0; k < 3; k++) {
        to_pane(corner[k], cut->view, mesh->positions + 3 * (size_t)mesh->triangles[3 * triangle + k]);
    }
    for (int k = 0; k < 3; k++) {
        const double *a = corner[k];
        const double *b = corner[(k + 1) % 3];
        if ((a[2] < 0) != (b[2] < 0)) {
            double s = a[2] / (a[2] - b[2]);
            ends[found][0] = a[0] + s * (b[0] - a[0]);
            ends[found++][1] = a[1] + s * (b[1] - a[1]);
        }
    }
    if (found == 2) {
        draw_line(cut, ends[0], ends[1], rgb);
    }
}

static void draw_meshes(const struct cut *cut)
{
    for (uint32_t number = 1; number <= cut->atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(cut->atlas, number);
        for (size_t t = 0; mesh && !is_hidden(cut->view, number) && t < mesh->triangle_count; t++) {
            cut_triangle(cut, mesh, t, cut->atlas->objects[number - 1].rgb);
        }
    }
}

/* ---- The cone -------------------------------------------------------------------------------------------------- */

/* mm from the cone's wall, negative inside; INFINITY beyond its ends. `slack` mm are allowed there. */
static double distance_to_wall(const struct cut_cone *cone, const double world[3], double slack)
{
    const double *m = cone->world_from_cone;
    double offset[3];
    double beside[3];
    vec3_sub(offset, world, m + 12);
    double depth = -vec3_dot(offset, m + 8);
    vec3_add_scaled(beside, offset, depth, m + 8);
    if (depth < cone->near - slack || depth > cone->far + slack) {
        return INFINITY;
    }
    double wall = (vec3_length(beside) - cone->radius - depth * cone->slope) / sqrt(1 + cone->slope * cone->slope);
    return fmax(wall, fmax(cone->near - depth, depth - cone->far));
}

static void draw_cone(const struct cut *cut)
{
    const struct cut_view *view = cut->view;
    double identity[16];
    struct walk walk;
    mat4_identity(identity);
    walk_init(&walk, view, identity);
    for (uint32_t row = 0; row < view->height; row++) {
        for (uint32_t column = 0; column < view->width; column++) {
            double world[3];
            walk_at(world, &walk, column, row);
            double wall = distance_to_wall(view->cone, world, view->mm_per_pixel) / view->mm_per_pixel;
            double line = fmin(fmax(1.3 - fabs(wall), 0), 1);
            double opacity = fmax(0.9 * line, wall < 0 ? 0.12 : 0);
            if (opacity > 0) {
                blend(cut->rgba + 4 * ((size_t)view->width * row + column), cone_rgb, opacity);
            }
        }
    }
}

conus_status cut_draw(uint8_t *rgba, uint32_t *objects, const conus_atlas *atlas, const struct cut_view *view)
{
    size_t pixels = (size_t)view->width * view->height;
    struct cut cut = {atlas, view, rgba, objects ? objects : memory_raw(pixels, sizeof *objects)};
    if (!cut.objects) {
        return CONUS_ERROR_MEMORY;
    }
    memset(cut.objects, 0, pixels * sizeof *cut.objects);
    for (size_t p = 0; p < pixels; p++) {
        memcpy(rgba + 4 * p, (uint8_t[]){0, 0, 0, 255}, 4);
    }
    if (atlas_context(atlas)) {
        draw_context(&cut, atlas_context(atlas));
    }
    for (size_t v = 0; v < atlas->volume_count; v++) {
        if (atlas->volumes[v].info.role != CONUS_CONTEXT) {
            find_objects(&cut, &atlas->volumes[v]);
        }
    }
    draw_objects(&cut);
    draw_meshes(&cut);
    if (view->cone) {
        draw_cone(&cut);
    }
    if (!objects) {
        memory_free(cut.objects);
    }
    return CONUS_OK;
}
