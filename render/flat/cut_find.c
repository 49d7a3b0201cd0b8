/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds what a cut shows: grey values, objects, and the lines where surfaces meet the plane. */
#include "atlas/volume_sample.h"
#include "base/geometry/math3.h"
#include "render/flat/cut.h"

#include <string.h>

void cut_walk_init(struct cut_walk *out, const struct cut_place *place, const double index_from_world[16])
{
    double corner[3];
    double right[3];
    double down[3];
    vec3_scale(right, place->right, place->mm_per_pixel);
    vec3_scale(down, place->up, -place->mm_per_pixel);
    vec3_add_scaled(corner, place->centre, 0.5 - 0.5 * place->width, right);
    vec3_add_scaled(corner, corner, 0.5 - 0.5 * place->height, down);
    mat4_point(out->start, index_from_world, corner);
    mat4_direction(out->right, index_from_world, right);
    mat4_direction(out->down, index_from_world, down);
}

/* The pixels of one row that lie in the grid: `count` from column `first` on. */
struct stretch {
    double start[3]; /* of column 0 */
    uint32_t first, count;
};

static void point_at(double out[3], const struct stretch *stretch, const struct cut_walk *walk, uint32_t column)
{
    vec3_add_scaled(out, stretch->start, column, walk->right);
}

static bool column_is_in(const struct volume *volume, const struct stretch *stretch, const struct cut_walk *walk,
                         uint32_t column)
{
    double p[3];
    point_at(p, stretch, walk, column);
    const size_t *dim = volume->info.dim;
    return p[0] >= -0.5 && p[0] < (double)dim[0] - 0.5 && p[1] >= -0.5 && p[1] < (double)dim[1] - 0.5 && p[2] >= -0.5 &&
           p[2] < (double)dim[2] - 0.5;
}

/* The grid is convex, so its columns are one stretch; the bounds are found a column too wide, for rounding. */
static void find_stretch(struct stretch *out, const struct volume *volume, const struct cut_walk *walk, uint32_t row,
                         uint32_t width)
{
    double low = 0;
    double high = (double)width - 1;
    vec3_add_scaled(out->start, walk->start, row, walk->down);
    for (int a = 0; a < 3; a++) {
        if (walk->right[a] != 0) {
            double from = (-0.5 - out->start[a]) / walk->right[a];
            double to = ((double)volume->info.dim[a] - 0.5 - out->start[a]) / walk->right[a];
            low = fmax(low, floor(fmin(from, to)) - 1);
            high = fmin(high, ceil(fmax(from, to)) + 1);
        }
    }
    out->first = out->count = 0;
    if (low <= high) {
        uint32_t first = (uint32_t)low;
        uint32_t end = (uint32_t)high + 1;
        while (first < end && !column_is_in(volume, out, walk, first)) {
            first++;
        }
        while (first < end && !column_is_in(volume, out, walk, end - 1)) {
            end--;
        }
        out->first = first;
        out->count = end - first;
    }
}

void cut_find_grey(struct cut *cut, const struct cut_view *view)
{
    const struct volume *volume = atlas_context(cut->atlas);
    uint32_t width = view->place.width;
    double scale = 255 / (view->window[1] - view->window[0]);
    struct cut_walk walk;
    memset(cut->grey, 0, (size_t)width * view->place.height);
    if (!volume) {
        return;
    }
    cut_walk_init(&walk, &view->place, volume->voxel_from_world);
    for (uint32_t row = 0; row < view->place.height; row++) {
        struct stretch stretch;
        find_stretch(&stretch, volume, &walk, row, width);
        for (uint32_t column = stretch.first; column < stretch.first + stretch.count; column++) {
            double p[3];
            point_at(p, &stretch, &walk, column);
            double grey = (volume_trilinear(volume, p) - view->window[0]) * scale;
            cut->grey[(size_t)width * row + column] = grey > 0 ? (uint8_t)(grey < 255 ? grey : 255) : 0;
        }
    }
}

/* Whether the object found so far at the pixel lies above the voxel: of labels the first one, of probabilities the most
 * probable one. Else later volumes lie over earlier ones. */
static bool is_covered(const conus_atlas *atlas, const struct volume *volume, size_t voxel, uint32_t object,
                       const double p[3])
{
    if (volume->info.role == CONUS_ROLE_PARCELLATION) {
        return object != 0;
    }
    if (volume->info.role != CONUS_ROLE_PROBABILITY || !object || object > atlas->area_count ||
        !atlas_object_is_scalar(atlas, object)) {
        return false;
    }
    double world[3];
    mat4_point(world, volume->info.world_from_voxel, p);
    return atlas_probability(atlas, object, world) >= volume->values[voxel];
}

static void find_in_volume(struct cut *cut, const struct cut_view *view, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    struct cut_walk walk;
    cut_walk_init(&walk, &view->place, volume->voxel_from_world);
    for (uint32_t row = 0; row < view->place.height; row++) {
        uint32_t *to = cut->objects + (size_t)view->place.width * row;
        struct stretch stretch;
        find_stretch(&stretch, volume, &walk, row, view->place.width);
        for (uint32_t column = stretch.first; column < stretch.first + stretch.count; column++) {
            double p[3];
            point_at(p, &stretch, &walk, column);
            size_t i = (size_t)(p[0] + 0.5);
            size_t j = (size_t)(p[1] + 0.5);
            size_t k = (size_t)(p[2] + 0.5);
            size_t voxel = i + dim[0] * (j + dim[1] * k);
            uint32_t object = volume_object(volume, voxel);
            bool shown = object && object != VOLUME_BLOCKER;
            if (shown && !is_covered(cut->atlas, volume, voxel, to[column], p)) {
                to[column] = object;
            }
        }
    }
}

/* The plane in pixels right of and below the picture's top left corner, and mm before it. */
struct pane {
    double origin[3];
    double right[3], down[3], forward[3];
    uint32_t width, height;
};

static void draw_line(uint32_t *contours, const struct pane *pane, const double from[2], const double to[2],
                      uint32_t object)
{
    double length = fmax(fabs(to[0] - from[0]), fabs(to[1] - from[1]));
    unsigned steps = (unsigned)fmin(ceil(length), 4.0 * (pane->width + pane->height)) + 1;
    for (unsigned s = 0; s <= steps; s++) {
        double x = from[0] + (to[0] - from[0]) * s / steps;
        double y = from[1] + (to[1] - from[1]) * s / steps;
        if (x >= 0 && y >= 0 && x < pane->width && y < pane->height) {
            contours[(size_t)pane->width * (size_t)y + (size_t)x] = object;
        }
    }
}

/* Where `turns` are not 0. */
struct turned {
    size_t low[2], high[2]; /* column, row */
};

/* Where the line passes the middle of a row, the winding changes by one for everything to the right. */
static void turn_rows(struct turned *turned, struct cut *cut, const struct pane *pane, const double from[2],
                      const double to[2])
{
    double top = fmax(ceil(fmin(from[1], to[1]) - 0.5), 0);
    double bottom = fmin(floor(fmax(from[1], to[1]) - 0.5), (double)pane->height - 1);
    for (long row = (long)top; row <= (long)bottom; row++) {
        double y = (double)row + 0.5;
        int turn = (from[1] <= y) - (to[1] <= y);
        if (!turn) {
            continue;
        }
        double x = from[0] + (to[0] - from[0]) * ((y - from[1]) / (to[1] - from[1]));
        double column = fmax(ceil(x - 0.5), 0);
        if (column < pane->width) {
            cut->turns[(size_t)pane->width * (size_t)row + (size_t)column] += turn;
            const size_t at[2] = {(size_t)column, (size_t)row};
            for (int a = 0; a < 2; a++) {
                turned->low[a] = at[a] < turned->low[a] ? at[a] : turned->low[a];
                turned->high[a] = at[a] > turned->high[a] ? at[a] : turned->high[a];
            }
        }
    }
}

/* A fixed order of two vertices, the same in all triangles. */
static bool is_first(const float a[3], const float b[3])
{
    return a[0] != b[0] ? a[0] < b[0] : a[1] != b[1] ? a[1] < b[1] : a[2] < b[2];
}

/* The first end is where the triangle's outline comes through the plane, the second where it goes back. Edges are taken
 * in the order of their vertices, so that triangles that share an edge share the end. */
static bool cut_triangle(double ends[2][2], const struct pane *pane, const struct mesh *mesh, const uint32_t *triangle)
{
    const float *position[3];
    double corner[3][3];
    double depth[3];
    for (int k = 0; k < 3; k++) {
        position[k] = mesh->positions + 3 * (size_t)triangle[k];
        for (int a = 0; a < 3; a++) {
            corner[k][a] = (double)position[k][a] - pane->origin[a];
        }
        depth[k] = vec3_dot(corner[k], pane->forward);
    }
    if ((depth[0] < 0) == (depth[1] < 0) && (depth[0] < 0) == (depth[2] < 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        int next = (k + 1) % 3;
        int a = is_first(position[k], position[next]) ? k : next;
        int b = a == k ? next : k;
        if ((depth[a] < 0) != (depth[b] < 0)) {
            double *end = ends[depth[next] < 0];
            double at[3], apart[3];
            vec3_sub(apart, corner[b], corner[a]);
            vec3_add_scaled(at, corner[a], depth[a] / (depth[a] - depth[b]), apart);
            end[0] = vec3_dot(at, pane->right) + 0.5 * pane->width;
            end[1] = vec3_dot(at, pane->down) + 0.5 * pane->height;
        }
    }
    return true;
}

/* Whether the plane passes the surface's box. */
static bool is_near(const struct pane *pane, const struct mesh_shape *shape)
{
    double middle = 0;
    double reach = 0;
    for (int a = 0; a < 3; a++) {
        middle += pane->forward[a] * ((shape->low[a] + shape->high[a]) / 2 - pane->origin[a]);
        reach += fabs(pane->forward[a]) * (shape->high[a] - shape->low[a]) / 2;
    }
    return fabs(middle) <= reach * (1 + 1e-9) + 1e-9;
}

/* Fills where the winding is not 0, and clears the changes. */
static void fill_rows(struct cut *cut, const struct turned *turned, uint32_t object)
{
    for (size_t row = turned->low[1]; row <= turned->high[1] && row < cut->of.height; row++) {
        int32_t *turns = cut->turns + cut->of.width * row;
        uint32_t *objects = cut->objects + cut->of.width * row;
        int32_t winding = 0;
        for (size_t column = turned->low[0]; column < cut->of.width && (column <= turned->high[0] || winding);
             column++) {
            winding += turns[column];
            turns[column] = 0;
            objects[column] = winding ? object : objects[column];
        }
    }
}

/* Draws the lines in which the plane cuts the triangles, and fills a closed surface. Surfaces around the areas have no
 * inside here. */
static void find_surface(struct cut *cut, const struct pane *pane, const struct mesh *mesh, uint32_t object)
{
    struct turned turned = {{SIZE_MAX, SIZE_MAX}, {0, 0}};
    if (!is_near(pane, &mesh->shape)) {
        return;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double ends[2][2] = {{0}};
        if (cut_triangle(ends, pane, mesh, mesh->triangles + 3 * t)) {
            draw_line(cut->contours, pane, ends[0], ends[1], object);
            if (mesh->shape.closed && object != CUT_AROUND) {
                turn_rows(&turned, cut, pane, ends[0], ends[1]);
            }
        }
    }
    fill_rows(cut, &turned, object);
}

static void find_surfaces(struct cut *cut, const struct cut_view *view)
{
    struct pane pane = {.width = view->place.width, .height = view->place.height};
    memcpy(pane.origin, view->place.centre, sizeof pane.origin);
    vec3_scale(pane.right, view->place.right, 1 / view->place.mm_per_pixel);
    vec3_scale(pane.down, view->place.up, -1 / view->place.mm_per_pixel);
    vec3_cross(pane.forward, view->place.right, view->place.up);
    memset(cut->contours, 0, (size_t)pane.width * pane.height * sizeof *cut->contours);
    for (size_t i = 0; i < cut->atlas->context_surface_count; i++) {
        find_surface(cut, &pane, &cut->atlas->context_surfaces[i].mesh, CUT_AROUND);
    }
    for (size_t i = 0; i < cut->surface_count; i++) {
        find_surface(cut, &pane, atlas_object_mesh(cut->atlas, cut->surfaces[i]), cut->surfaces[i]);
    }
}

static void find_volumes(struct cut *cut, const struct cut_view *view, conus_role role)
{
    for (size_t v = 0; v < cut->atlas->volume_count; v++) {
        if (cut->atlas->volumes[v].info.role == role && volume_can_be_hit(&cut->atlas->volumes[v])) {
            find_in_volume(cut, view, &cut->atlas->volumes[v]);
        }
    }
}

void cut_find_objects(struct cut *cut, const struct cut_view *view)
{
    memset(cut->objects, 0, (size_t)view->place.width * view->place.height * sizeof *cut->objects);
    find_volumes(cut, view, CONUS_ROLE_PARCELLATION);
    if (cut->contours) {
        find_surfaces(cut, view);
    }
    find_volumes(cut, view, CONUS_ROLE_PROBABILITY);
    find_volumes(cut, view, CONUS_ROLE_SCALAR);
    cut_find_streamlines(cut, view);
}
