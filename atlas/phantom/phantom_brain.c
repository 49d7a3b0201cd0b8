/* SPDX-License-Identifier: BSD-3-Clause */
/* The shapes of the brain phantom, their triangles and the values of its volumes. */
#include "atlas/phantom/phantom.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"

#include <stdio.h>

static const double middle[3] = {0, -18, 10};        /* of the brain, world mm */
static const double areas_reach[3] = {50, 64, 46};   /* semi-axes of the ellipsoid that the areas fill */
static const double brain_reach[3] = {66, 82, 58};   /* ... and of the context */
static const double shear = 4;                       /* mm */
static const double waves = 2 * MATH3_PI / 32;       /* per mm */
static const double arc_radius = 49;                 /* mm */
static const double arc_from = -10 * MATH3_PI / 180; /* from +x towards +z */

/* Triangles of a surface of n meridians and r rings between two poles: 2 n r. */
struct lattice {
    size_t meridians, rings;
};
static const struct lattice common = {117, 91};
static const struct lattice last = {128, 84}; /* 10 * 117 * 91 + 128 * 84 = 234444 / 2 */

static const struct phantom_brain_area areas[PHANTOM_BRAIN_AREAS] = {
    {"Anterior left", "AntL", 'L', {-20, 42, 4}},
    {"Anterior right", "AntR", 'R', {20, 42, 4}},
    {"Superior left", "SupL", 'L', {-21, 4, 26}},
    {"Superior right", "SupR", 'R', {21, 4, 26}},
    {"Posterior left", "PosL", 'L', {-20, -42, 6}},
    {"Posterior right", "PosR", 'R', {20, -42, 6}},
    {"Lateral left", "LatL", 'L', {-34, 8, -8}},
    {"Lateral right", "LatR", 'R', {34, 8, -8}},
    {"Inferior left", "InfL", 'L', {-16, -14, -26}},
    {"Inferior right", "InfR", 'R', {16, -14, -26}},
    {"Core", "Cor", 'B', {0, 2, 0}},
};

const struct phantom_brain_area *phantom_brain_area(size_t index)
{
    return &areas[index];
}

static void bend_point(double world[3], const double straight[3])
{
    double x = straight[0] + shear * sin(waves * straight[1]);
    double y = straight[1] + shear * sin(waves * straight[2]);
    double z = straight[2] + shear * sin(waves * x);
    vec3_add_scaled(world, middle, 1, (double[]){x, y, z});
}

void phantom_brain_straighten(double straight[3], const double world[3])
{
    double p[3];
    vec3_sub(p, world, middle);
    straight[2] = p[2] - shear * sin(waves * p[0]);
    straight[1] = p[1] - shear * sin(waves * straight[2]);
    straight[0] = p[0] - shear * sin(waves * straight[1]);
}

/* Distance from `seed` to the ellipsoid of the areas along the unit vector d. */
static double distance_to_rim(const double seed[3], const double d[3])
{
    double a = 0;
    double b = 0;
    double c = -1;
    for (int i = 0; i < 3; i++) {
        double s = seed[i] / areas_reach[i];
        double u = d[i] / areas_reach[i];
        a += u * u;
        b += s * u;
        c += s * s;
    }
    return (sqrt(b * b - a * c) - b) / a;
}

/* The radius of area `index` in direction d: a smooth minimum of the distances to the rim and to the planes half-way
 * to the other seeds, never more than the least of them, with furrows. */
static double radius_towards(size_t index, const double d[3])
{
    enum { SHARPNESS = 16 };
    const double *seed = areas[index].seed;
    double sum = pow(distance_to_rim(seed, d), -SHARPNESS);
    for (size_t i = 0; i < PHANTOM_BRAIN_AREAS; i++) {
        double between[3];
        vec3_sub(between, areas[i].seed, seed);
        double along = vec3_dot(between, d);
        sum += along > 0 ? pow(2 * along / vec3_dot(between, between), SHARPNESS) : 0;
    }
    double furrow = 0.5 + 0.5 * sin(9 * d[0]) * sin(9 * d[1] + 1) * sin(9 * d[2] + 2);
    return (0.985 - 0.08 * furrow * furrow) * pow(sum, -1.0 / SHARPNESS);
}

static void place_vertex(float *out, size_t index, double polar, double azimuth)
{
    double d[3] = {sin(polar) * cos(azimuth), sin(polar) * sin(azimuth), cos(polar)};
    double p[3];
    vec3_add_scaled(p, areas[index].seed, radius_towards(index, d), d);
    bend_point(p, p);
    for (int i = 0; i < 3; i++) {
        out[i] = (float)p[i];
    }
}

static uint32_t *put_triangle(uint32_t *at, size_t a, size_t b, size_t c)
{
    at[0] = (uint32_t)a;
    at[1] = (uint32_t)b;
    at[2] = (uint32_t)c;
    return at + 3;
}

conus_status phantom_brain_mesh(struct mesh *out, size_t index)
{
    struct mesh mesh = {0};
    const struct lattice *lattice = index + 1 < PHANTOM_BRAIN_AREAS ? &common : &last;
    size_t vertices = lattice->meridians * lattice->rings + 2;
    conus_status status = mesh_init(&mesh, vertices, 2 * lattice->meridians * lattice->rings);
    if (status) {
        return status;
    }
    size_t vertex = 0;
    place_vertex(mesh.positions, index, 0, 0);
    for (size_t ring = 1; ring <= lattice->rings; ring++) {
        for (size_t m = 0; m < lattice->meridians; m++) {
            place_vertex(mesh.positions + 3 * ++vertex, index, MATH3_PI * (double)ring / (double)(lattice->rings + 1),
                         2 * MATH3_PI * (double)m / (double)lattice->meridians);
        }
    }
    place_vertex(mesh.positions + 3 * ++vertex, index, MATH3_PI, 0);
    uint32_t *at = mesh.triangles;
    size_t n = lattice->meridians;
    size_t lower = mesh.vertex_count - 1;
    for (size_t m = 0; m < n; m++) {
        size_t next = (m + 1) % n;
        at = put_triangle(at, 0, 1 + m, 1 + next);
        for (size_t ring = 0; ring + 1 < lattice->rings; ring++) {
            size_t above = 1 + ring * n;
            size_t below = above + n;
            at = put_triangle(at, above + m, below + m, below + next);
            at = put_triangle(at, above + m, below + next, above + next);
        }
        at = put_triangle(at, lower, lower - n + next, lower - n + m);
    }
    *out = mesh;
    return CONUS_OK;
}

conus_status phantom_brain_grid(conus_volume_info *out)
{
    conus_volume_info grid = {
        .role = CONUS_ROLE_SCALAR, .path = "brain", .dim = {151, 188, 154}, .volume_count = 1, .slope = 1};
    double world_from_voxel[16];
    mat4_identity(world_from_voxel);
    for (int i = 0; i < 3; i++) {
        world_from_voxel[12 + i] = middle[i] - ((double)grid.dim[i] - 1) / 2;
    }
    snprintf(grid.format, sizeof grid.format, "phantom");
    snprintf(grid.datatype, sizeof grid.datatype, "uint16");
    conus_status status = space_describe(&grid, world_from_voxel, "phantom");
    return GIVE(status, out, grid, 0);
}

/* 0 below `from`, 1 above `to`, smooth between. */
static double ramp_between(double value, double from, double to)
{
    double t = fmin(fmax((value - from) / (to - from), 0), 1);
    return t * t * (3 - 2 * t);
}

static double ellipsoid_distance(const double p[3], double x, double y, double z)
{
    return sqrt(p[0] * p[0] / (x * x) + p[1] * p[1] / (y * y) + p[2] * p[2] / (z * z));
}

uint16_t phantom_brain_context(const double world[3])
{
    double p[3];
    phantom_brain_straighten(p, world);
    double depth = ellipsoid_distance(p, brain_reach[0], brain_reach[1], brain_reach[2]);
    if (depth > 1.1) {
        return 0;
    }
    double fold = 0.05 * sin(p[0] / 4) * sin(p[1] / 5) * sin(p[2] / 4);
    double rim = ramp_between(depth + fold, 0.98, 1.02);
    double cortex = ramp_between(depth + fold, 0.86, 0.9);
    double side[3] = {fabs(p[0]) - 8, p[1], p[2] - 8};
    double chamber = 1 - ramp_between(ellipsoid_distance(side, 5, 24, 7), 0.9, 1.1);
    double inside = 46000 - 14000 * cortex - 36000 * chamber;
    return (uint16_t)lround((1 - rim) * inside);
}

/* Squared distance from p (relative to the middle) to the arc. */
static double arc_distance2(const double p[3])
{
    double turn = atan2(p[2], p[0]);
    double lowest = arc_from;
    turn = turn < -MATH3_PI / 2 ? turn + 2 * MATH3_PI : turn; /* the arc is open below */
    double at = fmin(fmax(turn, lowest), MATH3_PI - lowest);
    double off[3] = {p[0] - arc_radius * cos(at), p[1], p[2] - arc_radius * sin(at)};
    return vec3_dot(off, off);
}

uint16_t phantom_brain_pathway(const double world[3])
{
    double p[3];
    vec3_sub(p, world, middle);
    if (fabs(p[1]) > 3 * PHANTOM_BRAIN_TUBE) {
        return 0;
    }
    double tubes = arc_distance2(p) / (PHANTOM_BRAIN_TUBE * PHANTOM_BRAIN_TUBE);
    /* Voxels 12.5 mm2 from the arc are half way between two values, and the last bit of the C library's cosine is not
     * to decide. No rounding reaches 1e-9, and every other voxel is 7e-6 from a half, or more. */
    return (uint16_t)lround(UINT16_MAX * exp2(-2 * tubes) + 1e-9);
}
