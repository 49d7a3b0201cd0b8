/* SPDX-License-Identifier: BSD-3-Clause */
/* A flat cut: finds the grey values, objects, surfaces and streamlines at its pixels, keeps them for the next cut, and
 * draws them, with the cone over them. */
#include "render/flat/cut.h"

#include "atlas/atlas.h"
#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "render/draw/draw.h"

#include <string.h>

/* How a pixel steps through an index space: `start` of the top left pixel's centre, and per pixel. */
struct walk {
    double start[3], right[3], down[3];
};

static void walk_init(struct walk *out, const struct cut_place *place, const double index_from_world[16])
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

static void point_at(double out[3], const struct stretch *stretch, const struct walk *walk, uint32_t column)
{
    vec3_add_scaled(out, stretch->start, column, walk->right);
}

static bool column_is_in(const struct volume *volume, const struct stretch *stretch, const struct walk *walk,
                         uint32_t column)
{
    double p[3];
    point_at(p, stretch, walk, column);
    return volume_reaches(volume, p);
}

/* The grid is convex, so its columns are one stretch; the bounds are found a column too wide, for rounding. */
static void find_stretch(struct stretch *out, const struct volume *volume, const struct walk *walk, uint32_t row,
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
        } else if (!(out->start[a] >= -0.5 && out->start[a] < (double)volume->info.dim[a] - 0.5)) {
            high = -1;
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

/* Neighbours along axis @p a at a column of the row. */
static struct volume_neighbours neighbours_at(const struct volume *volume, const struct stretch *stretch,
                                              const struct walk *walk, int a, uint32_t column)
{
    const size_t *dim = volume->info.dim;
    const size_t steps[3] = {1, dim[0], dim[0] * dim[1]};
    return volume_find_neighbours(stretch->start[a] + column * walk->right[a], dim[a], steps[a]);
}

/* Voxels are read anew only where others are around the pixel. */
static void find_grey_in_row(uint8_t *grey, const struct cut_view *view, const struct volume *volume,
                             const struct stretch *stretch, const struct walk *walk)
{
    const double black = view->window[0];
    const double scale = 255 / (view->window[1] - black);
    struct volume_neighbours x = neighbours_at(volume, stretch, walk, 0, 0);
    struct volume_neighbours y = neighbours_at(volume, stretch, walk, 1, 0);
    struct volume_neighbours z = neighbours_at(volume, stretch, walk, 2, 0);
    struct volume_cell cell = {0};
    size_t last = SIZE_MAX;
    for (uint32_t column = stretch->first; column < stretch->first + stretch->count; column++) {
        x = walk->right[0] != 0 ? neighbours_at(volume, stretch, walk, 0, column) : x;
        y = walk->right[1] != 0 ? neighbours_at(volume, stretch, walk, 1, column) : y;
        z = walk->right[2] != 0 ? neighbours_at(volume, stretch, walk, 2, column) : z;
        if (x.low + y.low + z.low != last) {
            last = x.low + y.low + z.low;
            volume_read_cell(&cell, volume, &x, &y, &z);
        }
        const double level = (volume_in_cell(&cell, x.part, y.part, z.part) - black) * scale;
        grey[column] = level > 0 ? (uint8_t)(level < 255 ? level : 255) : 0;
    }
}

static void find_grey(struct cut *cut, const struct cut_view *view)
{
    const struct volume *volume = atlas_context(cut->atlas);
    uint32_t width = view->place.width;
    struct walk walk;
    memset(cut->grey, 0, (size_t)width * view->place.height);
    if (!volume) {
        return;
    }
    walk_init(&walk, &view->place, volume->voxel_from_world);
    for (uint32_t row = 0; row < view->place.height; row++) {
        struct stretch stretch;
        find_stretch(&stretch, volume, &walk, row, width);
        find_grey_in_row(cut->grey + (size_t)width * row, view, volume, &stretch, &walk);
    }
}

/* Whether the object found so far at a column lies above the voxel: of labels the first one, of probabilities the most
 * probable one. Else later volumes lie over earlier ones. */
static bool is_covered(const conus_atlas *atlas, const struct volume *volume, size_t voxel, uint32_t object,
                       const struct stretch *stretch, const struct walk *walk, uint32_t column)
{
    if (volume->info.role == CONUS_ROLE_PARCELLATION) {
        return object != 0;
    }
    if (volume->info.role != CONUS_ROLE_PROBABILITY || !object || object > atlas->area_count ||
        !atlas_object_is_scalar(atlas, object)) {
        return false;
    }
    double p[3];
    double world[3];
    point_at(p, stretch, walk, column);
    mat4_point(world, volume->info.world_from_voxel, p);
    return atlas_probability(atlas, object, world) >= volume_value(volume, voxel);
}

static uint32_t object_of(const struct volume *volume, size_t voxel)
{
    uint32_t object = volume_object(volume, voxel);
    return object == VOLUME_BLOCKER ? 0 : object;
}

/* Voxels wider than so many pixels have smooth borders. */
static const double WIDE = 1.5;

/* The voxels whose centres a place lies between, along the axes that change in the plane; along others the nearest one.
 * Those beyond the grid's border are those at it. */
struct cell {
    int axes[3], count;  /* no axes: nothing is smooth */
    ptrdiff_t low[3];    /* indices of the first one, from -1 on */
    uint32_t objects[8]; /* number n is the upper one along axes[k] where bit k of n is set */
    size_t ahead;        /* to a voxel that the row comes to later, which is prefetched; backwards it wraps around */
    bool is_mixed;
};

/* floor() of what is above -1; to signed numbers is quicker. */
static ptrdiff_t index_below(double at)
{
    return (ptrdiff_t)(at + 1) - 1;
}

static void cell_init(struct cell *out, const struct walk *walk, const double start[3])
{
    const bool is_smooth = fmin(vec3_length(walk->right), vec3_length(walk->down)) * WIDE < 1;
    out->count = 0;
    out->ahead = 0;
    out->is_mixed = false;
    for (int a = 0; a < 3; a++) {
        if (is_smooth && (walk->right[a] != 0 || walk->down[a] != 0)) {
            out->axes[out->count++] = a;
        }
        out->low[a] = walk->right[a] != 0 ? PTRDIFF_MAX : index_below(start[a]);
    }
}

/* `nearest` is the nearest voxel, at p. */
static void find_cell(struct cell *cell, const struct volume *volume, size_t nearest, const double p[3])
{
    const size_t *dim = volume->info.dim;
    const size_t steps[3] = {1, dim[0], dim[0] * dim[1]};
    size_t voxels[8] = {nearest};
    for (int k = 0; k < cell->count; k++) {
        const int a = cell->axes[k];
        const size_t index = (size_t)(ptrdiff_t)(p[a] + 0.5);
        const bool is_low = (ptrdiff_t)index == cell->low[a]; /* the nearest one is the lower one */
        const size_t low = is_low || index == 0 ? 0 : steps[a];
        const size_t high = is_low && index + 1 < dim[a] ? steps[a] : 0;
        for (int n = 0; n < 1 << k; n++) {
            voxels[n | 1 << k] = voxels[n] + high;
            voxels[n] -= low;
        }
    }
    uint32_t others = 0;
    for (int n = 0; n < 1 << cell->count; n++) {
        if (voxels[n] + cell->ahead < volume->voxel_count) {
            volume_fetch(volume, voxels[n] + cell->ahead);
        }
        cell->objects[n] = object_of(volume, voxels[n]);
        others |= cell->objects[n] ^ cell->objects[0];
    }
    cell->is_mixed = others;
}

/* The object with the largest sum of linear weights; of equal ones that of the nearest voxel. `axes` is
 * cell->count: a number that the compiler knows makes it quicker. */
static inline uint32_t heaviest_object(const struct cell *cell, int axes, const double p[3], uint32_t nearest)
{
    static const double tie = 1e-9;
    const int count = 1 << axes;
    double weights[8] = {1};
    double most = 0;
    for (int k = 0; k < axes; k++) {
        const double part = p[cell->axes[k]] - (double)cell->low[cell->axes[k]];
        for (int n = 0; n < 1 << k; n++) {
            weights[n | 1 << k] = weights[n] * part;
            weights[n] *= 1 - part;
        }
    }
    for (int n = 0; n < count; n++) {
        most += cell->objects[n] == nearest ? weights[n] : 0;
    }
    uint32_t heaviest = nearest;
    for (int n = 0; n < count && most < 0.5; n++) { /* none is heavier than a half */
        double sum = 0;
        for (int m = 0; m < count; m++) {
            sum += cell->objects[m] == cell->objects[n] ? weights[m] : 0;
        }
        if (sum > most + tie) {
            most = sum;
            heaviest = cell->objects[n];
        }
    }
    return heaviest;
}

static void find_in_row(struct cut *cut, size_t at, const struct volume *volume, const struct stretch *stretch,
                        const struct walk *walk)
{
    const size_t *dim = volume->info.dim;
    const size_t steps[3] = {1, dim[0], dim[0] * dim[1]};
    enum { AHEAD = 12 };
    double p[3];
    struct cell cell;
    memcpy(p, stretch->start, sizeof p);
    cell_init(&cell, walk, p);
    size_t row = 0; /* the voxel's number, without the indices that change along the row: mostly one does */
    int changing[3];
    int count = 0;
    for (int a = 0; a < 3; a++) {
        if (walk->right[a] != 0) {
            changing[count++] = a;
            cell.ahead = walk->right[a] > 0 ? AHEAD * steps[a] : 0 - AHEAD * steps[a];
        } else {
            row += steps[a] * (size_t)(ptrdiff_t)(stretch->start[a] + 0.5); /* to signed numbers is quicker */
        }
    }
    size_t last = SIZE_MAX;
    uint32_t object = 0;
    for (uint32_t column = stretch->first; column < stretch->first + stretch->count; column++) {
        size_t voxel = row;
        bool is_other = false;
        for (int n = 0; n < count; n++) {
            int a = changing[n];
            p[a] = stretch->start[a] + column * walk->right[a];
            voxel += steps[a] * (size_t)(ptrdiff_t)(p[a] + 0.5);
            const ptrdiff_t low = index_below(p[a]);
            is_other = is_other || low != cell.low[a];
            cell.low[a] = low;
        }
        if (is_other && cell.count) {
            find_cell(&cell, volume, voxel, p);
        }
        if (voxel != last) {
            if (!cell.count && voxel + cell.ahead < volume->voxel_count) {
                volume_fetch(volume, voxel + cell.ahead);
            }
            object = object_of(volume, voxel);
            last = voxel;
        }
        const uint32_t seen = !cell.is_mixed    ? object
                              : cell.count == 2 ? heaviest_object(&cell, 2, p, object)
                                                : heaviest_object(&cell, 3, p, object);
        if (!object && !seen) {
            continue;
        }
        uint32_t *const to = cut->objects + at + column;
        uint32_t *const shown = cut->shown + at + column;
        const bool is_alike = seen == object && *shown == *to; /* as it mostly is */
        if (object && !is_covered(cut->atlas, volume, voxel, *to, stretch, walk, column)) {
            *to = object;
        }
        if (is_alike) {
            *shown = *to;
        } else if (seen && !is_covered(cut->atlas, volume, voxel, *shown, stretch, walk, column)) {
            *shown = seen;
        }
    }
}

static void find_in_volume(struct cut *cut, const struct cut_view *view, const struct volume *volume)
{
    struct walk walk;
    walk_init(&walk, &view->place, volume->voxel_from_world);
    for (uint32_t row = 0; row < view->place.height; row++) {
        struct stretch stretch;
        find_stretch(&stretch, volume, &walk, row, view->place.width);
        if (stretch.count) {
            find_in_row(cut, (size_t)view->place.width * row, volume, &stretch, &walk);
        }
    }
}

/* The plane in pixels right of and below the picture's top left corner, and mm before it. */
struct pane {
    double origin[3];
    double right[3], down[3], forward[3];
    uint32_t width, height;
};

static void mark_line(uint32_t *contours, const struct pane *pane, const double from[2], const double to[2],
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
static bool passes_plane(const struct pane *pane, const struct mesh_shape *shape)
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
        uint32_t *shown = cut->shown + cut->of.width * row;
        int32_t winding = 0;
        for (size_t column = turned->low[0]; column < cut->of.width && (column <= turned->high[0] || winding);
             column++) {
            winding += turns[column];
            turns[column] = 0;
            objects[column] = winding ? object : objects[column];
            shown[column] = winding ? object : shown[column];
        }
    }
}

/* Marks the lines in which the plane cuts the triangles, and fills a closed surface. Surfaces around the areas have no
 * inside here. */
static void find_surface(struct cut *cut, const struct cut_view *view, const struct pane *pane, const struct mesh *mesh,
                         uint32_t object)
{
    struct turned turned = {{SIZE_MAX, SIZE_MAX}, {0, 0}};
    if (!passes_plane(pane, &mesh->shape)) {
        return;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double ends[2][2] = {{0}};
        if (cut_triangle(ends, pane, mesh, mesh->triangles + 3 * t)) {
            mark_line(cut->contours, pane, ends[0], ends[1], object);
            if (view->line) {
                view->line(view->line_user, ends[0], ends[1], object);
            }
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
        const struct context_surface *surface = &cut->atlas->context_surfaces[i];
        if (!surface->is_shell) { /* areas and context tell more in a cut */
            find_surface(cut, view, &pane, &surface->mesh, CUT_AROUND);
        }
    }
    for (size_t i = 0; i < cut->surface_count; i++) {
        find_surface(cut, view, &pane, atlas_object_mesh(cut->atlas, cut->surfaces[i]), cut->surfaces[i]);
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

static bool is_near_segment(const double a[3], const double step[3], double x, double y, double radius)
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
            const size_t at = (size_t)cut->of.width * row + column;
            uint32_t *pixel = &cut->objects[at];
            bool is_free = !*pixel || object < *pixel || !cut->atlas->places[*pixel - 1].is_bundle;
            if (is_free && is_near_segment(a, step, column, row, radius)) {
                *pixel = cut->shown[at] = object;
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
        double world[3];
        double ends[2][3];
        for (uint32_t n = 0; n < 2; n++) {
            tractogram_point(world, frame->tractogram, run->point + k + (k < run->segments ? n : 0));
            for (int a = 0; a < 3; a++) {
                ends[n][a] = along(frame, a, world);
            }
        }
        draw_segment(frame, ends[0], ends[1], object);
    }
}

static void find_streamlines(struct cut *cut, const struct cut_view *view)
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

static void find_objects(struct cut *cut, const struct cut_view *view)
{
    const size_t size = (size_t)view->place.width * view->place.height * sizeof *cut->objects;
    memset(cut->objects, 0, size);
    memset(cut->shown, 0, size);
    find_volumes(cut, view, CONUS_ROLE_PARCELLATION);
    if (cut->contours) {
        find_surfaces(cut, view);
    }
    find_volumes(cut, view, CONUS_ROLE_PROBABILITY);
    find_volumes(cut, view, CONUS_ROLE_SCALAR);
    find_streamlines(cut, view);
}

static void blend(uint8_t *pixel, const uint8_t rgb[3], double opacity)
{
    for (int c = 0; c < 3; c++) {
        pixel[c] = (uint8_t)(pixel[c] + (rgb[c] - pixel[c]) * opacity + 0.5);
    }
}

enum { TILE = 8 };

static const uint8_t cone_rgb[3] = {LOOK_RGB(LOOK_CONE)};
static const double tint = 0.12;
static const double half_line = 1.3; /* pixels from the wall to where its line has faded */

struct cone_drawing {
    uint8_t *rgba;
    uint8_t tinted[256][3]; /* of a pixel's red, green and blue */
    const struct cut_place *place;
    const struct cut_cone *cone;
    struct walk walk; /* in the world */
    double secant;
};

/* Pixels from the cone's wall, negative inside: it changes by at most 1 per pixel. */
static double distance_to_wall(const struct cone_drawing *drawing, double column, double row)
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

/* A tile that is all inside or all outside needs one look only. */
static void draw_tile(const struct cone_drawing *drawing, uint32_t left, uint32_t top)
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
            double opacity = tint;
            if (!inside) {
                double outside = distance_to_wall(drawing, column, row);
                double line = drawing->cone->no_line ? 0 : 0.9 * fmin(fmax(half_line - fabs(outside), 0), 1);
                opacity = fmax(line, outside < 0 ? tint : 0);
            }
            const size_t at = (size_t)drawing->place->width * row + column;
            uint8_t *pixel = drawing->rgba + 4 * at;
            const uint32_t *areas = drawing->cone->areas;
            if (opacity == tint && areas && (areas[at] || !pixel[3])) {
                continue;
            }
            if (opacity == tint) {
                for (int c = 0; c < 3; c++) {
                    pixel[c] = drawing->tinted[pixel[c]][c];
                }
            } else if (opacity > 0) {
                blend(pixel, cone_rgb, opacity);
            }
        }
    }
}

static void cone_drawing_init(struct cone_drawing *out, const struct cut_place *place, const struct cut_cone *cone)
{
    double identity[16];
    *out = (struct cone_drawing){.place = place, .cone = cone, .secant = sqrt(1 + cone->slope * cone->slope)};
    mat4_identity(identity);
    walk_init(&out->walk, place, identity);
}

double cut_cone_distance(const struct cut_place *place, const struct cut_cone *cone, double column, double row)
{
    struct cone_drawing drawing;
    cone_drawing_init(&drawing, place, cone);
    return distance_to_wall(&drawing, column, row);
}

void cut_draw_cone(uint8_t *rgba, const struct cut_place *place, const struct cut_cone *cone)
{
    struct cone_drawing drawing;
    cone_drawing_init(&drawing, place, cone);
    drawing.rgba = rgba;
    for (int level = 0; level < 256; level++) {
        memset(drawing.tinted[level], level, 3);
        blend(drawing.tinted[level], cone_rgb, tint);
    }
    for (uint32_t top = 0; top < place->height; top += TILE) {
        for (uint32_t left = 0; left < place->width; left += TILE) {
            draw_tile(&drawing, left, top);
        }
    }
}

enum {
    HATCH = 6,
    PALE = 40,
    OUTLINE = 2,                   /* in place of an opacity: opaque */
    GROUND = LOOK_CUT_GROUND % 256 /* a grey, where no image is: on it colours are as on their chips */
};

/* Lines of surfaces around the areas: a grey that is visible on the context's black and white. */
static const uint8_t around_rgb[3] = {LOOK_RGB(LOOK_AROUND)};

static double size_of(const conus_atlas *atlas, uint32_t number)
{
    return fabs(atlas_object_mesh(atlas, number)->shape.volume_mm3);
}

/* A line on any grey has a contrast (WCAG 2.2) of 3, and some more for what bytes round: it is darker, or lighter where
 * black would not do. */
static void find_seen(uint8_t levels[256])
{
    static const double contrast = 3.2, glare = 0.05;
    for (int grey = 0; grey < 256; grey++) {
        double under = linear_from_srgb(grey / 255.0) + glare;
        double level = (under / contrast >= glare ? under / contrast : under * contrast) - glare;
        levels[grey] = (uint8_t)lrint(255 * srgb_from_linear(level));
    }
}

conus_status cut_init(struct cut *out, const conus_atlas *atlas)
{
    struct cut cut = {.atlas = atlas,
                      .surfaces = memory_zeroed(atlas->object_count + 1, sizeof *cut.surfaces),
                      .streamlines = memory_zeroed(atlas->tractogram_count, sizeof *cut.streamlines)};
    bool is_whole = cut.surfaces && cut.streamlines;
    find_seen(cut.seen_on);
    for (size_t i = 0; i < atlas->tractogram_count && is_whole; i++) {
        const struct tractogram *tractogram = &atlas->tractograms[i];
        cut.streamlines[i] = memory_zeroed(tractogram->streamline_count, sizeof **cut.streamlines);
        is_whole = cut.streamlines[i];
        if (is_whole) {
            bundles_find_objects(cut.streamlines[i], atlas, tractogram);
        }
    }
    if (!is_whole) {
        cut_finish(&cut);
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        if (!atlas_object_mesh(atlas, number)) {
            continue;
        }
        size_t at = cut.surface_count++;
        for (; at > 0 && size_of(atlas, cut.surfaces[at - 1]) < size_of(atlas, number); at--) {
            cut.surfaces[at] = cut.surfaces[at - 1];
        }
        cut.surfaces[at] = number;
    }
    *out = cut;
    return CONUS_OK;
}

static void free_pixels(struct cut *cut)
{
    memory_free(cut->rgba);
    memory_free(cut->objects);
    memory_free(cut->shown);
    memory_free(cut->grey);
    memory_free(cut->contours);
    memory_free(cut->turns);
    cut->rgba = cut->grey = NULL;
    cut->turns = NULL;
    cut->objects = cut->shown = cut->contours = NULL;
    cut->pixel_capacity = 0;
}

void cut_finish(struct cut *cut)
{
    free_pixels(cut);
    for (size_t i = 0; cut->streamlines && i < cut->atlas->tractogram_count; i++) {
        memory_free(cut->streamlines[i]);
    }
    memory_free(cut->streamlines);
    memory_free(cut->surfaces);
    *cut = (struct cut){0};
}

static conus_status reserve_pixels(struct cut *cut, size_t pixels)
{
    if (pixels <= cut->pixel_capacity) {
        return CONUS_OK;
    }
    bool contours = cut->surface_count || cut->atlas->context_surface_count;
    free_pixels(cut);
    cut->has_grey = cut->has_objects = false;
    cut->rgba = memory_raw(pixels, 4);
    cut->objects = memory_raw(pixels, sizeof *cut->objects);
    cut->shown = memory_raw(pixels, sizeof *cut->shown);
    cut->grey = memory_raw(pixels, 1);
    cut->contours = contours ? memory_raw(pixels, sizeof *cut->contours) : NULL;
    cut->turns = contours ? memory_zeroed(pixels, sizeof *cut->turns) : NULL;
    if (!cut->rgba || !cut->objects || !cut->shown || !cut->grey || (contours && !(cut->contours && cut->turns))) {
        free_pixels(cut);
        return CONUS_ERROR_MEMORY;
    }
    cut->pixel_capacity = pixels;
    return CONUS_OK;
}

/* The opacity by emphasis, between stripes and on them; OUTLINE on an area's outline: its own pixels that have a
 * different neighbour beside, above or below. */
static double opacity_at(const struct cut *cut, const struct cut_view *view, const double opacities[3][2],
                         uint32_t column, uint32_t row)
{
    uint32_t width = cut->of.width;
    const uint32_t *at = cut->shown + (size_t)width * row + column;
    if (!view->no_outlines && ((column > 0 && at[-1] != *at) || (column + 1 < width && at[1] != *at) ||
                               (row > 0 && *(at - width) != *at) || (row + 1 < cut->of.height && at[width] != *at))) {
        return OUTLINE;
    }
    return opacities[view->emphasis ? view->emphasis[*at] : EMPHASIS_FULL][(column + row) % HATCH < HATCH / 3];
}

/* sRGB of an object in one of the two tables of a view. */
static const uint8_t *colour_of(const struct cut *cut, const uint8_t (*rgb)[3], uint32_t object)
{
    return rgb ? rgb[object] : cut->atlas->objects[object - 1].rgb;
}

static void draw_row(const struct cut *cut, const struct cut_view *view, const double opacities[3][2], uint32_t row)
{
    size_t at = (size_t)cut->of.width * row;
    uint8_t blended[4] = {0}; /* the last such pixel, which the next one mostly equals, and what it was made of */
    uint8_t grey = 0;
    uint32_t of = 0;
    double by = 0;
    const bool has_bare = view->rgb && view->emphasis && !cut->atlas->has_palette && atlas_context(cut->atlas);
    for (uint32_t column = 0; column < cut->of.width; column++, at++) {
        uint8_t *pixel = cut->rgba + 4 * at;
        uint32_t object = cut->shown[at];
        uint32_t contour = cut->contours && !view->line ? cut->contours[at] : 0;
        memset(pixel, cut->grey[at], 3);
        pixel[3] = 255;
        if (contour == CUT_AROUND) {
            memcpy(pixel, around_rgb, 3);
        } else if (contour) {
            memcpy(pixel, colour_of(cut, view->line_rgb, contour), 3);
        } else if (object) {
            double opacity = opacity_at(cut, view, opacities, column, row);
            if (opacity == 0) { /* most of a brain: it is the grey already */
                continue;
            }
            if (object != of || opacity != by || cut->grey[at] != grey) {
                memset(pixel, cut->grey[at] == 0 && view->fill > 0 ? GROUND : cut->grey[at], 3);
                if (has_bare && opacity == OUTLINE && view->emphasis[object] == EMPHASIS_PALE) {
                    memset(pixel, cut->seen_on[cut->grey[at]], 3);
                } else {
                    blend(pixel, colour_of(cut, opacity == OUTLINE ? view->line_rgb : view->rgb, object),
                          fmin(opacity, 1));
                }
                memcpy(blended, pixel, sizeof blended);
                of = object;
                by = opacity;
                grey = cut->grey[at];
            }
            memcpy(pixel, blended, sizeof blended);
        }
    }
}

conus_status cut_draw(struct cut *cut, const struct cut_view *view)
{
    const bool is_neutral = view->rgb && !cut->atlas->has_palette;
    double pale = is_neutral ? !atlas_context(cut->atlas) && view->fill > 0 : view->fill * PALE / 100;
    const double opacities[3][2] = {[EMPHASIS_PALE] = {pale, pale},
                                    [EMPHASIS_FULL] = {view->fill, view->fill},
                                    [EMPHASIS_HATCHED] = {0.35 * view->fill, fmin(1.6 * view->fill, 1)}};
    conus_status status = reserve_pixels(cut, (size_t)view->place.width * view->place.height);
    if (status) {
        return status;
    }
    bool same = cut->of.width == view->place.width && cut->of.height == view->place.height &&
                cut->of.mm_per_pixel == view->place.mm_per_pixel;
    for (int i = 0; i < 3; i++) {
        same = same && cut->of.centre[i] == view->place.centre[i] && cut->of.right[i] == view->place.right[i] &&
               cut->of.up[i] == view->place.up[i];
    }
    bool same_window = cut->window[0] == view->window[0] && cut->window[1] == view->window[1];
    cut->of = view->place;
    memcpy(cut->window, view->window, sizeof cut->window);
    if (!cut->has_grey || !same || !same_window) {
        find_grey(cut, view);
    }
    if (!cut->has_objects || !same || view->line) {
        find_objects(cut, view);
    }
    cut->has_grey = cut->has_objects = true;
    for (uint32_t row = 0; row < view->place.height; row++) {
        draw_row(cut, view, opacities, row);
    }
    if (view->cone) {
        cut_draw_cone(cut->rgba, &view->place, view->cone);
    }
    return CONUS_OK;
}
