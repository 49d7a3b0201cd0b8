/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of phantoms, and the drawing of their shapes on a grid. */
#include "atlas/phantom/phantom.h"

#include "atlas/labels/labels.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <stdio.h>
#include <string.h>

enum { SIZE_DEFAULT = 64, SIZE_MINIMUM = 16, SIZE_MAXIMUM = 512, EDGE_MINIMUM = 4 };

#define BALL(number, within, x, y, z, r)                                                                               \
    {                                                                                                                  \
        .kind = PHANTOM_BALL, .label = (number), .inside = (within), .centre = {x, y, z}, .radius = (r)                \
    }
#define BOX(number, x, y, z, hx, hy, hz)                                                                               \
    {                                                                                                                  \
        .kind = PHANTOM_BOX, .label = (number), .centre = {x, y, z}, .half = { hx, hy, hz }                            \
    }
/* A tube along 140 degrees of a circle in a plane of constant x, bent towards +z. */
#define ARCH(number, x, diameter)                                                                                      \
    {                                                                                                                  \
        .kind = PHANTOM_RING, .label = (number), .centre = {x, 0, -8}, .radius = 22, .tube = (diameter) / 2.0,         \
        .axis = 0, .from = 20 * MATH3_PI / 180, .to = 160 * MATH3_PI / 180                                             \
    }

/* Labels of one, two and four bytes: readers that keep labels in floats merge those above 2^24. */
static const struct phantom table[] = {
    {.info = {"sphere", "a ball of radius 20 mm around the origin"},
     .areas = {{1, "Sphere", "Sph"}},
     .area_count = 1,
     .shapes = {BALL(1, 0, 0, 0, 0, 20)},
     .shape_count = 1},
    {.info = {"nested", "concentric balls of radius 24, 16 and 8 mm, with labels of four bytes"},
     .areas = {{1, "Shell outer", "ShO"}, {300, "Shell inner", "ShI"}, {4000000001U, "Core", "Cor"}},
     .area_count = 3,
     .shapes = {BALL(1, 0, 0, 0, 0, 24), BALL(300, 1, 0, 0, 0, 16), BALL(4000000001U, 300, 0, 0, 0, 8)},
     .shape_count = 3},
    {.info = {"slabs", "two slabs, 6 mm thick and 12 mm apart, across the y axis"},
     .areas = {{1, "Slab anterior", "SlA"}, {300, "Slab posterior", "SlP"}},
     .area_count = 2,
     .shapes = {BOX(1, 0, 9, 0, 20, 3, 20), BOX(300, 0, -9, 0, 20, 3, 20)},
     .shape_count = 2},
    {.info = {"torus", "a torus around the z axis: circle of radius 18 mm, tube of radius 6 mm"},
     .areas = {{1, "Torus", "Tor"}},
     .area_count = 1,
     .shapes = {{.kind = PHANTOM_RING, .label = 1, .radius = 18, .tube = 6, .axis = 2, .to = 2 * MATH3_PI}},
     .shape_count = 1},
    {.info = {"u-shape", "a U that opens upwards, with a ball between its arms: inside its bounding box, not in it"},
     .areas = {{1, "U", "U"}, {2, "Ball", "Bal"}},
     .area_count = 2,
     .shapes = {BOX(1, 0, 0, -14, 22, 6, 4), BOX(1, -17, 0, 4, 5, 6, 14), BOX(1, 17, 0, 4, 5, 6, 14),
                BALL(2, 0, 0, 0, 6, 5)},
     .shape_count = 4},
    {.info = {"tubes", "six arched tubes, 1 to 6 mm in diameter"},
     .areas = {{1, "Tube 1 mm", "T1"},
               {2, "Tube 2 mm", "T2"},
               {3, "Tube 3 mm", "T3"},
               {4, "Tube 4 mm", "T4"},
               {5, "Tube 5 mm", "T5"},
               {6, "Tube 6 mm", "T6"}},
     .area_count = 6,
     .shapes = {ARCH(1, -19.5, 1), ARCH(2, -12, 2), ARCH(3, -5.5, 3), ARCH(4, 2, 4), ARCH(5, 9.5, 5), ARCH(6, 18, 6)},
     .shape_count = 6},
};

enum { TABLE_SIZE = sizeof table / sizeof table[0] };

/* Not drawn but made by atlas/phantom/phantom_brain.c and loaders/phantom. */
static const conus_phantom_info made[] = {
    {"brain", "eleven packed surfaces (234,444 triangles), a context and a curved pathway, with their manifest"},
    {"bundle", "144 streamlines round the z axis, straight lines and helices, with their manifest"},
};

enum { MADE_COUNT = sizeof made / sizeof made[0] };

const struct phantom *phantom_entry(size_t index)
{
    return index < TABLE_SIZE ? &table[index] : NULL;
}

const conus_phantom_info *conus_phantom(size_t index)
{
    return index < TABLE_SIZE ? &table[index].info : index - TABLE_SIZE < MADE_COUNT ? &made[index - TABLE_SIZE] : NULL;
}

static bool ring_is_whole(const struct phantom_shape *ring)
{
    return ring->to - ring->from >= 2 * MATH3_PI;
}

/* Squared distance from `p` (relative to the centre) to the ring's centre line. */
static double ring_distance2(const struct phantom_shape *ring, const double p[3])
{
    double a = p[(ring->axis + 1) % 3];
    double b = p[(ring->axis + 2) % 3];
    double h = p[ring->axis];
    double turn = fmod(atan2(b, a) - ring->from + 4 * MATH3_PI, 2 * MATH3_PI);
    if (ring_is_whole(ring) || turn <= ring->to - ring->from) {
        double off = hypot(a, b) - ring->radius;
        return off * off + h * h;
    }
    double nearest = INFINITY;
    const double ends[2] = {ring->from, ring->to};
    for (int i = 0; i < 2; i++) {
        double da = a - ring->radius * cos(ends[i]);
        double db = b - ring->radius * sin(ends[i]);
        nearest = fmin(nearest, da * da + db * db + h * h);
    }
    return nearest;
}

bool phantom_shape_has(const struct phantom_shape *shape, const double point[3])
{
    double p[3];
    vec3_sub(p, point, shape->centre);
    switch (shape->kind) {
    case PHANTOM_BALL:
        return vec3_dot(p, p) <= shape->radius * shape->radius;
    case PHANTOM_BOX:
        return fabs(p[0]) <= shape->half[0] && fabs(p[1]) <= shape->half[1] && fabs(p[2]) <= shape->half[2];
    case PHANTOM_RING:
        return ring_distance2(shape, p) <= shape->tube * shape->tube;
    }
    return false;
}

static double ball_volume(double radius)
{
    return 4.0 / 3 * MATH3_PI * radius * radius * radius;
}

double phantom_shape_volume(const struct phantom_shape *shape)
{
    switch (shape->kind) {
    case PHANTOM_BALL:
        return ball_volume(shape->radius);
    case PHANTOM_BOX:
        return 8 * shape->half[0] * shape->half[1] * shape->half[2];
    case PHANTOM_RING: /* Pappus, and two round ends for an arc */
        return MATH3_PI * shape->tube * shape->tube * shape->radius * (shape->to - shape->from) +
               (ring_is_whole(shape) ? 0 : ball_volume(shape->tube));
    }
    return 0;
}

double phantom_area_volume(const struct phantom_drawing *drawing, uint32_t label)
{
    double volume = 0;
    for (size_t i = 0; i < drawing->phantom->shape_count; i++) {
        const struct phantom_shape *shape = &drawing->shapes[i];
        volume += shape->label == label ? phantom_shape_volume(shape) : 0;
        volume -= shape->inside == label ? phantom_shape_volume(shape) : 0;
    }
    return volume;
}

static conus_status check_options(conus_phantom_options *options)
{
    double *spacing = options->spacing;
    options->size = options->size ? options->size : SIZE_DEFAULT;
    if (options->size < SIZE_MINIMUM || options->size > SIZE_MAXIMUM) {
        return fail(CONUS_ERROR_ARGUMENT, "size: %u, allowed is %d to %d voxels", options->size, SIZE_MINIMUM,
                    SIZE_MAXIMUM);
    }
    if (spacing[0] == 0 && spacing[1] == 0 && spacing[2] == 0) {
        spacing[0] = spacing[1] = spacing[2] = 1;
    }
    double least = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    double most = fmax(spacing[0], fmax(spacing[1], spacing[2]));
    if (!vec3_is_finite(spacing) || !(least >= 1e-3) || !(most <= 1e3)) {
        return fail(CONUS_ERROR_ARGUMENT, "spacing: %g, %g, %g, allowed is 0.001 to 1000 mm", spacing[0], spacing[1],
                    spacing[2]);
    }
    if (options->size * least / most < EDGE_MINIMUM) {
        return fail(CONUS_ERROR_ARGUMENT, "spacing: %g mm with %g mm leaves less than %d voxels of %u along an edge",
                    most, least, EDGE_MINIMUM, options->size);
    }
    return isfinite(options->oblique)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "oblique: %g, a finite angle is needed", options->oblique);
}

/* Rotation about (1, 1, 1) (Rodrigues): circulant, so three numbers make it. */
static void rotate_about_diagonal(double m[16], double angle)
{
    double third = (1 - cos(angle)) / 3;
    double skew = sin(angle) / sqrt(3);
    mat4_identity(m);
    for (int column = 0; column < 3; column++) {
        m[4 * column + column] = cos(angle) + third;
        m[4 * column + (column + 1) % 3] = third + skew;
        m[4 * column + (column + 2) % 3] = third - skew;
    }
}

/* A grid over a cube of `edge` mm, its middle at the world's origin. */
static conus_status make_grid(conus_volume_info *out, const char *name, const conus_phantom_options *options,
                              double edge)
{
    conus_volume_info grid = {
        .role = CONUS_ROLE_PARCELLATION, .path = name, .volume_count = 1, .slope = 1, .space_code = SPACE_SCANNER};
    double m[16];
    double middle[3];
    rotate_about_diagonal(m, radians_from_degrees(options->oblique));
    for (int axis = 0; axis < 3; axis++) {
        grid.dim[axis] = (size_t)ceil(edge / options->spacing[axis] - 1e-9);
        middle[axis] = ((double)grid.dim[axis] - 1) / 2;
        vec3_scale(m + 4 * axis, m + 4 * axis, options->spacing[axis] * (options->flip[axis] ? -1 : 1));
    }
    mat4_direction(middle, m, middle);
    vec3_scale(m + 12, middle, -1);
    for (int i = 0; i < 16; i++) {
        m[i] = (double)(float)m[i] + 0.0; /* + 0: no negative zeros */
    }
    snprintf(grid.format, sizeof grid.format, "phantom");
    snprintf(grid.datatype, sizeof grid.datatype, "uint32");
    conus_status status = space_describe(&grid, m, "phantom");
    return GIVE(status, out, grid, 0);
}

/* Voxels first[] to last[] - 1 hold every centre that may lie in `shape`. */
static void bound_voxels(size_t first[3], size_t last[3], const struct phantom_shape *shape,
                         const conus_volume_info *grid, const double voxel_from_world[16])
{
    double reach[3];
    double middle[3];
    /* Half the edges of a box around the shape's centre that holds it. */
    for (int axis = 0; axis < 3; axis++) {
        reach[axis] = shape->kind == PHANTOM_BOX ? shape->half[axis] : shape->tube;
        reach[axis] += shape->kind == PHANTOM_RING && axis == shape->axis ? 0 : shape->radius;
    }
    mat4_point(middle, voxel_from_world, shape->centre);
    for (int axis = 0; axis < 3; axis++) {
        double half = 1;
        for (int world = 0; world < 3; world++) {
            half += fabs(voxel_from_world[4 * world + axis]) * reach[world];
        }
        double limit = (double)grid->dim[axis];
        first[axis] = (size_t)fmin(fmax(floor(middle[axis] - half), 0), limit);
        last[axis] = (size_t)fmin(fmax(ceil(middle[axis] + half) + 1, 0), limit);
    }
}

static void paint_shape(uint32_t *labels, const struct phantom_shape *shape, const conus_volume_info *grid,
                        const double voxel_from_world[16])
{
    size_t first[3];
    size_t last[3];
    bound_voxels(first, last, shape, grid, voxel_from_world);
    for (size_t k = first[2]; k < last[2]; k++) {
        for (size_t j = first[1]; j < last[1]; j++) {
            uint32_t *row = labels + grid->dim[0] * (j + grid->dim[1] * k);
            for (size_t i = first[0]; i < last[0]; i++) {
                double centre[3];
                mat4_point(centre, grid->world_from_voxel, (double[]){(double)i, (double)j, (double)k});
                row[i] = phantom_shape_has(shape, centre) ? shape->label : row[i];
            }
        }
    }
}

static conus_status paint_shapes(struct phantom_drawing *drawing)
{
    const conus_volume_info *grid = &drawing->grid;
    double voxel_from_world[16];
    if (!mat4_invert_affine(voxel_from_world, grid->world_from_voxel)) {
        return fail(CONUS_ERROR_ARGUMENT, "phantom: singular grid");
    }
    drawing->labels = memory_zeroed(grid->dim[0] * grid->dim[1] * grid->dim[2], sizeof *drawing->labels);
    for (size_t i = 0; drawing->labels && i < drawing->phantom->shape_count; i++) {
        paint_shape(drawing->labels, &drawing->shapes[i], grid, voxel_from_world);
    }
    return drawing->labels ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status find_phantom(const struct phantom **out, const char *kind)
{
    char known[256] = "";
    for (size_t i = 0; i < TABLE_SIZE; i++) {
        if (kind && !strcmp(kind, table[i].info.name)) {
            *out = &table[i];
            return CONUS_OK;
        }
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", table[i].info.name);
    }
    return fail(CONUS_ERROR_ARGUMENT, "phantom: '%s', allowed are %s, brain, bundle", kind ? kind : "", known);
}

conus_status phantom_draw(struct phantom_drawing *out, const char *kind, const conus_phantom_options *options)
{
    struct phantom_drawing drawing = {0};
    conus_phantom_options used = options ? *options : (conus_phantom_options){0};
    conus_status status = find_phantom(&drawing.phantom, kind);
    status = status ? status : check_options(&used);
    if (status) {
        return status;
    }
    double edge = used.size * fmin(used.spacing[0], fmin(used.spacing[1], used.spacing[2]));
    for (size_t i = 0; i < drawing.phantom->shape_count; i++) {
        drawing.shapes[i] = drawing.phantom->shapes[i];
        double scale = edge / PHANTOM_EDGE;
        vec3_scale(drawing.shapes[i].centre, drawing.shapes[i].centre, scale);
        vec3_scale(drawing.shapes[i].half, drawing.shapes[i].half, scale);
        drawing.shapes[i].radius *= scale;
        drawing.shapes[i].tube *= scale;
    }
    status = make_grid(&drawing.grid, drawing.phantom->info.name, &used, edge);
    status = status ? status : paint_shapes(&drawing);
    return GIVE(status, out, drawing, 0);
}

void phantom_drawing_finish(struct phantom_drawing *drawing)
{
    memory_free(drawing->labels);
    *drawing = (struct phantom_drawing){0};
}
