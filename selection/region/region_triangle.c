/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles cut to a cone, a cylinder or a ball, and the flux through what is left. */
#include "selection/region/region.h"

#include "base/geometry/math3.h"

/* A triangle gains a corner at each of six planes at most. */
enum { CORNER_LIMIT = 10, AXES = 3 };

/* Part of the plane of a triangle, or of a plane across the axis. */
struct facet {
    const struct region_solid *solid;
    double normal[AXES]; /* any length; the plane is where normal . p = level */
    double level;
    double depth[2]; /* of its points, the least and the greatest */
};

struct polygon {
    double at[CORNER_LIMIT][AXES];
    size_t count;
};

void region_solid_init(struct region_solid *out, const struct region *region)
{
    *out = (struct region_solid){.region = region, .side = *region};
    const struct region own = {.up = {1, 0, 0}, .right = {0, 1, 0}, .axis = {0, 0, 1}}; /* right-handed */
    memcpy(out->side.origin, own.origin, sizeof own.origin);
    memcpy(out->side.right, own.right, sizeof own.right);
    memcpy(out->side.up, own.up, sizeof own.up);
    memcpy(out->side.axis, own.axis, sizeof own.axis);
    out->side.near = region->shape == REGION_CONE ? 0 : -INFINITY; /* the polygons are already cut, up to rounding */
    out->side.far = INFINITY;
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    double normal[AXES];
    vec3_cross(normal, b, c);
    return vec3_dot(a, normal);
}

/* Angle about the axis from a to b, which are not on opposite sides of it. */
static double angle_between(const double a[3], const double b[3])
{
    return arc_tangent(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
}

/* The flux through a triangle in the region: the volume between it and the apex, or the plane at the depth near. */
static double flux(const struct region_solid *solid, const double a[3], const double b[3], const double c[3])
{
    if (solid->region->shape == REGION_CONE) {
        return determinant(a, b, c) / 6;
    }
    double across = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    return across / 2 * ((a[2] + b[2] + c[2]) / 3 - solid->region->near);
}

static double flux_of_fan(const struct region_solid *solid, const struct polygon *polygon)
{
    double sum = 0;
    for (size_t k = 2; k < polygon->count; k++) {
        sum += flux(solid, polygon->at[0], polygon->at[k - 1], polygon->at[k]);
    }
    return sum;
}

/* The point of the facet on the region's side at an angle about the axis. The depth of a thin triangle's plane is not
 * known well, so it is held within that of the triangle. */
static void find_on_side(double out[3], const struct facet *facet, double angle)
{
    const struct region *side = &facet->solid->side;
    double x;
    double y;
    sine_cosine(&y, &x, angle);
    double across = facet->normal[0] * x + facet->normal[1] * y;
    double depth = side->shape == REGION_CONE ? facet->level / (facet->normal[2] + side->slope * across)
                                              : (facet->level - side->radius * across) / facet->normal[2];
    depth = depth > facet->depth[0] ? fmin(depth, facet->depth[1]) : facet->depth[0];
    double radius = side->shape == REGION_CONE ? side->slope * depth : side->radius;
    out[0] = radius * x;
    out[1] = radius * y;
    out[2] = depth;
}

/* Whether the depth changes along an arc so much that a few points do not show it. */
static bool is_long(const struct facet *facet, double angle, double sweep)
{
    static const double longest = 0.125;
    static const double shortest = 1e-3;
    static const double ratio = 1.1;
    double begin[AXES];
    double end[AXES];
    if (fabs(sweep) > longest || fabs(sweep) < shortest) {
        return fabs(sweep) > longest;
    }
    find_on_side(begin, facet, angle);
    find_on_side(end, facet, angle + sweep);
    return facet->solid->region->shape == REGION_CONE &&
           fmax(begin[2], end[2]) > ratio * fmin(begin[2], end[2]) + 1e-9 * facet->depth[1];
}

/* The flux between an arc on the region's side and the point `from` of the facet: Gauss's rule of five points. */
static double flux_of_arc(const struct facet *facet, const double from[3], double angle, double sweep)
{
    static const double place[] = {0, 0.53846931010568309, -0.53846931010568309, 0.90617984593866399,
                                   -0.90617984593866399};
    static const double weight[] = {128.0 / 225, 0.47862867049936647, 0.47862867049936647, 0.23692688505618909,
                                    0.23692688505618909};
    const struct region_solid *solid = facet->solid;
    double sum = 0;
    while (sweep != 0) {
        double step = sweep;
        while (is_long(facet, angle, step)) {
            step /= 2;
        }
        for (size_t k = 0; k < sizeof place / sizeof place[0]; k++) {
            double p[AXES];
            find_on_side(p, facet, angle + step / 2 * (1 + place[k]));
            const double onward[AXES] = {-p[1], p[0], 0}; /* per radian; what it has along p adds nothing */
            double rate = solid->region->shape == REGION_CONE
                              ? determinant(from, p, onward) / 6
                              : ((p[0] - from[0]) * onward[1] - (p[1] - from[1]) * onward[0]) / 2 *
                                    ((from[2] + 2 * p[2]) / 3 - solid->region->near);
            sum += weight[k] * step / 2 * rate;
        }
        angle += step;
        sweep -= step;
    }
    return sum;
}

/* From a point where the polygon leaves the region to where it comes in again, having gone `sweep` about the axis. */
static double flux_of_turn(const struct facet *facet, const double from[3], const double left[3], const double back[3],
                           double sweep)
{
    static const double none = 1e-12;
    return fabs(sweep) < none ? flux(facet->solid, from, left, back)
                              : flux_of_arc(facet, from, arc_tangent(left[1], left[0]), sweep);
}

/* Through what a round side leaves of a polygon in front of the apex. Its border goes along the polygon's where that is
 * inside, and else along the side, as far about the axis as the polygon goes outside. */
static double flux_in_round(const struct facet *facet, const struct polygon *polygon)
{
    double first[AXES];
    double left[AXES];
    double begun = 0; /* the sweep before `first` */
    double sweep = 0;
    double sum = 0;
    bool found = false;
    for (size_t k = 0; k < polygon->count; k++) {
        const double *a = polygon->at[k];
        const double *b = polygon->at[(k + 1) % polygon->count];
        double s[2] = {0, 1};
        double along[AXES];
        double entry[AXES];
        vec3_sub(along, b, a);
        if (!region_line(s, &facet->solid->side, a, along)) {
            sweep += angle_between(a, b);
            continue;
        }
        vec3_add_scaled(entry, a, s[0], along);
        sweep += angle_between(a, entry);
        if (found) {
            sum += flux_of_turn(facet, first, left, entry, sweep);
        } else {
            memcpy(first, entry, sizeof first);
            begun = sweep;
            found = true;
        }
        vec3_add_scaled(left, a, s[1], along);
        sum += flux(facet->solid, first, entry, left);
        sweep = angle_between(left, b);
    }
    if (found) {
        return sum + flux_of_turn(facet, first, left, first, sweep + begun);
    }
    return fabs(sweep) > MATH3_PI ? flux_of_arc(facet, polygon->at[0], 0, copysign(2 * MATH3_PI, sweep)) : 0;
}

/* Cuts the polygon to plane . p + offset >= 0. Where that makes an edge on the plane, gives it, as it runs round what
 * is left. Two polygons that share an edge are cut at the same point of it. */
static bool cut(struct polygon *polygon, double edge[2][3], const double plane[3], double offset)
{
    struct polygon kept = {.count = 0};
    bool made = false;
    for (size_t k = 0; k < polygon->count; k++) {
        const double *a = polygon->at[k];
        const double *b = polygon->at[(k + 1) % polygon->count];
        double above[2] = {vec3_dot(plane, a) + offset, vec3_dot(plane, b) + offset};
        if (above[0] >= 0) {
            memcpy(kept.at[kept.count++], a, sizeof kept.at[0]);
        }
        if ((above[0] >= 0) != (above[1] >= 0)) {
            bool leaves = above[0] >= 0;
            double along[AXES];
            vec3_sub(along, leaves ? b : a, leaves ? a : b);
            double *place = edge[leaves ? 0 : 1];
            vec3_add_scaled(place, leaves ? a : b, above[!leaves] / (above[!leaves] - above[leaves]), along);
            memcpy(kept.at[kept.count++], place, sizeof kept.at[0]);
            made = true;
        }
    }
    *polygon = kept;
    return made;
}

static double flux_in_square(const struct facet *facet, const struct polygon *polygon)
{
    const struct region *side = &facet->solid->side;
    struct polygon left = *polygon;
    double edge[2][AXES];
    for (int k = 0; k < 4; k++) {
        double plane[AXES] = {0, 0, side->sine};
        plane[k / 2] = k % 2 ? side->cosine : -side->cosine;
        (void)cut(&left, edge, plane, side->radius);
    }
    return flux_of_fan(facet->solid, &left);
}

static double flux_inside(struct facet *facet, const struct polygon *polygon)
{
    const struct region *side = &facet->solid->side;
    bool whole = true;
    facet->depth[0] = INFINITY;
    facet->depth[1] = -INFINITY;
    for (size_t k = 0; k < polygon->count; k++) {
        whole = whole && region_has(side, polygon->at[k]);
        facet->depth[0] = polygon->at[k][2] < facet->depth[0] ? polygon->at[k][2] : facet->depth[0];
        facet->depth[1] = polygon->at[k][2] > facet->depth[1] ? polygon->at[k][2] : facet->depth[1];
    }
    return whole || !polygon->count ? flux_of_fan(facet->solid, polygon)
           : side->square           ? flux_in_square(facet, polygon)
                                    : flux_in_round(facet, polygon);
}

/* Cuts the polygon to one side of the plane at a depth, `sign` 1 beyond it, and gives the flux through what the cut
 * adds to the border there: the triangle between the axis and the new edge, the other way round. */
static double close_at(const struct region_solid *solid, struct polygon *polygon, double depth, double sign)
{
    double edge[2][AXES];
    bool is_begin = sign > 0 && (solid->region->shape == REGION_CYLINDER || depth == 0); /* where the field is 0 */
    if (!cut(polygon, edge, (double[]){0, 0, sign}, -sign * depth) || is_begin) {
        return 0;
    }
    struct facet facet = {.solid = solid, .normal = {0, 0, 1}, .level = depth};
    struct polygon lid = {.at = {{0, 0, depth}}, .count = 3};
    memcpy(lid.at[1], edge[1], sizeof lid.at[0]);
    memcpy(lid.at[2], edge[0], sizeof lid.at[0]);
    return flux_inside(&facet, &lid);
}

/* Signed solid angle of a triangle from the origin (van Oosterom and Strackee 1983). */
static double solid_angle(const double p[3], const double q[3], const double r[3])
{
    double a = vec3_length(p);
    double b = vec3_length(q);
    double c = vec3_length(r);
    return 2 *
           arc_tangent(determinant(p, q, r), a * b * c + vec3_dot(p, q) * c + vec3_dot(q, r) * a + vec3_dot(r, p) * b);
}

/* The field is p / 3 in the ball, and beyond falls with the square of the distance. So the part of a triangle in the
 * ball counts as in a cone, and the part beyond with its solid angle. In the triangle's plane the ball is a disk about
 * the foot. */
static double flux_of_ball(const struct region_solid *solid, double p[3][3])
{
    double radius = solid->region->radius;
    double beyond = radius * radius * radius / 3;
    double volume = determinant(p[0], p[1], p[2]);
    double normal[AXES];
    double edges[2][AXES];
    double foot[AXES];
    vec3_sub(edges[0], p[1], p[0]);
    vec3_sub(edges[1], p[2], p[0]);
    vec3_cross(normal, edges[0], edges[1]);
    double size = vec3_length(normal);
    double height = volume / size;
    if (!(size > 0) || volume == 0) {
        return 0; /* the centre lies in its plane */
    }
    double sum = beyond * solid_angle(p[0], p[1], p[2]);
    vec3_scale(foot, normal, height / size);
    vec3_scale(normal, normal, 1 / size);
    double disk = (radius - height) * (radius + height);                                      /* its radius squared */
    double sector = height * disk / 6 - beyond * copysign(1 - fabs(height) / radius, height); /* per radian */
    for (int k = 0; k < 3 && disk > 0; k++) {
        double s[2] = {0, 1};
        double along[AXES];
        double ends[4][AXES]; /* from the foot: corner, entry, exit, corner */
        vec3_sub(along, p[(k + 1) % 3], p[k]);
        bool found = region_line(s, solid->region, p[k], along);
        vec3_sub(ends[0], p[k], foot);
        vec3_sub(ends[3], p[(k + 1) % 3], foot);
        vec3_add_scaled(ends[1], ends[0], s[0], along);
        vec3_add_scaled(ends[2], ends[0], s[1], along);
        for (int part = 0; part < 3; part++) {
            const double *a = ends[found ? part : 0];
            const double *b = ends[found ? part + 1 : 3];
            if (found && part == 1) {
                double in[2][AXES];
                vec3_add_scaled(in[0], a, 1, foot);
                vec3_add_scaled(in[1], b, 1, foot);
                sum += determinant(foot, in[0], in[1]) / 6 - beyond * solid_angle(foot, in[0], in[1]);
            } else if (found || part == 0) {
                sum += sector * arc_tangent(determinant(normal, a, b), vec3_dot(a, b));
            }
        }
    }
    return sum;
}

/* Whether the triangle is surely beside the region's side, as most are that come here. */
static bool is_beside(const struct region *side, double p[3][3])
{
    double middle[AXES];
    double reach = 0;
    for (int a = 0; a < AXES; a++) {
        middle[a] = (p[0][a] + p[1][a] + p[2][a]) / 3;
    }
    double x = fabs(middle[0]);
    double y = fabs(middle[1]);
    double across = !side->square ? sqrt(x * x + y * y) : x > y ? x : y;
    double beyond = across * side->cosine - middle[2] * side->sine - side->radius;
    for (int k = 0; k < 3; k++) {
        double to[AXES];
        vec3_sub(to, p[k], middle);
        double square = vec3_dot(to, to);
        reach = square > reach ? square : reach;
    }
    return beyond > 0 && beyond * beyond > 1.001 * reach;
}

double region_triangle(const struct region_solid *solid, double corners[3][3])
{
    const struct region *region = solid->region;
    struct facet facet = {.solid = solid, .depth = {INFINITY, -INFINITY}};
    struct polygon polygon = {.count = 3};
    double edges[2][AXES];
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double v[AXES];
        vec3_sub(v, corners[k], region->origin);
        double seen[AXES] = {vec3_dot(v, region->up), vec3_dot(v, region->right), vec3_dot(v, region->axis)};
        memcpy(polygon.at[k], region->shape == REGION_BALL ? v : seen, sizeof v);
        facet.depth[0] = seen[2] < facet.depth[0] ? seen[2] : facet.depth[0];
        facet.depth[1] = seen[2] > facet.depth[1] ? seen[2] : facet.depth[1];
    }
    if (region->shape == REGION_BALL) {
        return flux_of_ball(solid, polygon.at);
    }
    bool is_cut[2] = {facet.depth[0]<region->near, facet.depth[1]> region->far};
    bool outside = facet.depth[1] < region->near || facet.depth[0] > region->far || is_beside(&solid->side, polygon.at);
    if (outside && !is_cut[0] && !is_cut[1]) {
        return 0;
    }
    vec3_sub(edges[0], polygon.at[1], polygon.at[0]);
    vec3_sub(edges[1], polygon.at[2], polygon.at[0]);
    vec3_cross(facet.normal, edges[0], edges[1]);
    facet.level = vec3_dot(facet.normal, polygon.at[0]);
    sum += is_cut[0] ? close_at(solid, &polygon, region->near, 1) : 0;
    sum += is_cut[1] ? close_at(solid, &polygon, region->far, -1) : 0;
    return outside ? sum : sum + flux_inside(&facet, &polygon);
}
