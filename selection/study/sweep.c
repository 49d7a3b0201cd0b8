/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the angle at which each object is admitted, and sorts the objects by it. */
#include "selection/study/study.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/pose_row.h"
#include "selection/measure/measure.h"
#include "selection/selection.h"

/* The narrowest round cone about an axis that holds some of an object (Eq. 13): of a voxel's the angle of its centre,
 * of a surface's or streamline's that of its nearest point to the axis, exact but for rounding. */
struct admission {
    double slope;    /* Tangent of the half-angle; infinite where none has been found.               */
    double depth;    /* Along the axis, mm, of what is admitted first; of several such, the nearest. */
    double point[3]; /* Where that is, world.                                                        */
    bool is_surface; /* The point is a mesh's; else a voxel's centre or of a streamline.             */
};

/* World coordinates along the region's right, up and axis. */
static void to_device(double out[3], const struct region *region, const double point[3])
{
    double v[3];
    vec3_sub(v, point, region->origin);
    out[0] = vec3_dot(v, region->right);
    out[1] = vec3_dot(v, region->up);
    out[2] = vec3_dot(v, region->axis);
}

/* A point this near to the axis, as a part of its depth, counts as on it, for rounding. */
static const double ON_AXIS = 1e-12;

/* Tangent of the angle to the axis; infinite beside and behind the apex. */
static double slope_of(const double p[3])
{
    double across = sqrt(p[0] * p[0] + p[1] * p[1]);
    if (p[2] >= 0 && across <= ON_AXIS * p[2]) {
        return 0;
    }
    return p[2] > 0 ? across / p[2] : INFINITY;
}

static bool is_sooner(const struct admission *admission, double slope, double depth)
{
    return slope != admission->slope ? slope < admission->slope : isfinite(slope) && depth < admission->depth;
}

/* The user of admit_row(): admissions[as[k]] is lowered to what the voxels of object k in the region give. */
struct voxels {
    struct admission *admissions;
    const struct region *region;
    const uint32_t *as; /* NULL: each object is itself */
};

static void admit_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    const struct voxels *voxels = user;
    const size_t *dim = volume->info.dim;
    size_t first = at[0] + dim[0] * (at[1] + dim[1] * at[2]);
    for (size_t i = 0; i < count; i++) {
        uint32_t object = volume_object(volume, first + i);
        if (object == 0 || object == VOLUME_BLOCKER) {
            continue;
        }
        double world[3] = {(double)(at[0] + i), (double)at[1], (double)at[2]};
        double p[3];
        mat4_point(world, volume->info.world_from_voxel, world);
        to_device(p, voxels->region, world);
        struct admission *admission = &voxels->admissions[voxels->as ? voxels->as[object] : object];
        double slope = slope_of(p);
        if (is_sooner(admission, slope, p[2])) {
            admission->slope = slope;
            admission->depth = p[2];
            admission->is_surface = false;
            memcpy(admission->point, world, sizeof world);
        }
    }
}

enum { CORNERS = 5 }; /* a triangle cut by two planes */

struct polygon {
    double corners[CORNERS][3]; /* in the device's coordinates */
    size_t count;
};

static void append_corner(struct polygon *polygon, const double a[3], const double b[3], double t)
{
    double *corner = polygon->corners[polygon->count++];
    for (int i = 0; i < 3; i++) {
        corner[i] = a[i] + t * (b[i] - a[i]);
    }
}

/* Cuts `polygon` to where sign * (depth - limit) >= 0. */
static void cut(struct polygon *polygon, double sign, double limit)
{
    struct polygon rest = {.count = 0};
    for (size_t i = 0; i < polygon->count; i++) {
        const double *a = polygon->corners[i];
        const double *b = polygon->corners[(i + 1) % polygon->count];
        double at_a = sign * (a[2] - limit);
        double at_b = sign * (b[2] - limit);
        if (at_a >= 0) {
            append_corner(&rest, a, b, 0);
        }
        if ((at_a >= 0) != (at_b >= 0)) {
            append_corner(&rest, a, b, at_a / (at_a - at_b));
            rest.corners[rest.count - 1][2] = limit;
        }
    }
    *polygon = rest;
}

static void admit_point(struct admission *admission, const struct region *region, const double p[3])
{
    double slope = slope_of(p);
    if (is_sooner(admission, slope, p[2])) {
        admission->slope = slope;
        admission->depth = p[2];
        admission->is_surface = true;
        memcpy(admission->point, region->origin, 3 * sizeof *admission->point);
        vec3_add_scaled(admission->point, admission->point, p[0], region->right);
        vec3_add_scaled(admission->point, admission->point, p[1], region->up);
        vec3_add_scaled(admission->point, admission->point, p[2], region->axis);
    }
}

/* Tries the ends of an edge, and the place between them where the tangent is stationary: there is one, since it is
 * linear there. */
static void admit_edge(struct admission *admission, const struct region *region, const double a[3], const double b[3])
{
    const double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double square = a[0] * a[0] + a[1] * a[1];
    double mixed = a[0] * e[0] + a[1] * e[1];
    double t = (square * e[2] - mixed * a[2]) / ((e[0] * e[0] + e[1] * e[1]) * a[2] - mixed * e[2]);
    admit_point(admission, region, a);
    if (t > 0 && t < 1) {
        const double p[3] = {a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]};
        admit_point(admission, region, p);
    }
}

/* On which side of the line from a to b the axis is, seen along it. From b to a it is the other one even where the axis
 * meets the line, so that it passes exactly one of two triangles that share an edge. */
static bool is_left(const double a[3], const double b[3])
{
    double cross = a[0] * b[1] - b[0] * a[1];
    return cross != 0 ? cross > 0 : a[1] != b[1] ? a[1] > b[1] : a[0] > b[0];
}

/* Whether the axis's line passes the triangle, at which depth, and from which side. */
static bool hits_axis(double *depth, bool *faces, const struct polygon *triangle)
{
    const double(*p)[3] = triangle->corners;
    bool left = is_left(p[0], p[1]);
    if (is_left(p[1], p[2]) != left || is_left(p[2], p[0]) != left) {
        return false;
    }
    *faces = left;
    double weight[3];
    double sum = 0;
    double total = 0;
    for (int i = 0; i < 3; i++) { /* the areas opposite the corners */
        const double *a = p[(i + 1) % 3];
        const double *b = p[(i + 2) % 3];
        weight[i] = a[0] * b[1] - b[0] * a[1];
        sum += weight[i] * p[i][2];
        total += weight[i];
    }
    *depth = total != 0 ? sum / total : p[0][2];
    return true;
}

static void admit_outline(struct admission *admission, const struct region *region, struct polygon *polygon)
{
    cut(polygon, 1, region->near);
    if (isfinite(region->far)) {
        cut(polygon, -1, region->far);
    }
    for (size_t i = 0; i < polygon->count; i++) {
        admit_edge(admission, region, polygon->corners[i], polygon->corners[(i + 1) % polygon->count]);
    }
}

/* Lowers the admission to what the mesh gives, as far as it lies in the depths of the region. `closed`: what is inside
 * belongs to it. */
static void admission_of_mesh(struct admission *admission, const struct region *region, const struct mesh *mesh,
                              bool closed)
{
    int64_t inside = 0; /* how often the axis is, where the region begins: its ways out from there, less its ways in */
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        struct polygon polygon;
        double depth;
        bool faces;
        double corners[3][3];
        mesh_corners(corners, mesh, i);
        polygon.count = 3;
        for (int k = 0; k < 3; k++) {
            to_device(polygon.corners[k], region, corners[k]);
        }
        if (hits_axis(&depth, &faces, &polygon)) {
            if (depth >= region->near && depth <= region->far) {
                admit_point(admission, region, (const double[]){0, 0, depth});
            }
            inside += depth > region->near ? (faces ? 1 : -1) : 0;
        }
        admit_outline(admission, region, &polygon);
    }
    if (closed && inside != 0) {
        admit_point(admission, region, (const double[]){0, 0, region->near});
    }
}

/* Lowers the admission to what streamlines give, as lines without a radius: those of the group, or all if it is NULL.
 */
static void admission_of_bundle(struct admission *admission, const struct region *region,
                                const struct tractogram *tractogram, const struct tract_group *group)
{
    struct admission found = *admission;
    size_t count = tract_group_count(group, tractogram);
    for (size_t i = 0; i < count; i++) {
        const uint64_t *ends = &tractogram->first[tract_group_member(group, i)];
        for (uint64_t r = ends[0]; r < ends[1]; r++) {
            struct polygon segment = {.count = r + 1 < ends[1] ? 2 : 1};
            for (uint64_t k = 0; k < segment.count; k++) {
                double point[3];
                tractogram_point(point, tractogram, r + k);
                to_device(segment.corners[k], region, point);
            }
            if (segment.count == 2 || r == ends[0]) { /* the last point was the end of a segment, unless it is alone */
                admit_outline(&found, region, &segment);
            }
        }
    }
    found.is_surface = false;
    *admission = found;
}

/* The angle of the cone that is searched, so that the next object beyond the widest is found. */
static const double WIDEST = MATH3_PI * (1 - 1e-9);

/* Finds the admission of every object, under the object that it is reported as. */
static void search(struct admission *admissions, const conus_selector *selector, const struct cone *cone)
{
    const conus_atlas *atlas = selector->atlas;
    const uint32_t *group = level_group(selector->level);
    struct cone widest = *cone;
    struct region region;
    widest.angle = WIDEST;
    region_from_cone(&region, &widest);
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (volume_can_be_hit(&atlas->volumes[i])) {
            struct voxels voxels = {admissions, &region, group};
            census_walk(&region, &atlas->volumes[i], admit_row, &voxels);
        }
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            admission_of_mesh(&admissions[group ? group[number] : number], &region, mesh,
                              atlas->objects[number - 1].closed);
        }
        const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
        if (tractogram && !atlas->places[number - 1].is_hidden) {
            admission_of_bundle(&admissions[number], &region, tractogram, atlas_bundle_group(atlas, number));
        }
    }
}

/* When a growing cone admits an object (Eq. 13): a row of the table. */
struct row {
    struct table_object object;
    double angle;    /* full opening of the narrowest round cone that holds some of it, degrees; 0: the axis hits it */
    double margin;   /* further opening until the next object; NaN if there is none */
    double point[3]; /* what is admitted first, world */
    double distance; /* mm from the apex to there */
    bool is_surface; /* it is a mesh's; else a voxel's centre, or of a bundle a point of a streamline */
};

static struct cell half_angle(const struct table_source *source, const void *row, size_t index)
{
    (void)source;
    (void)index;
    return number_cell(((const struct row *)row)->angle / 2);
}

static struct cell measured(const struct table_source *source, const void *of, size_t index)
{
    const struct row *row = of;
    (void)source;
    (void)index;
    return text_cell(row->object.kind == CONUS_KIND_BUNDLE ? "streamline"
                     : row->is_surface                     ? "surface"
                                                           : "voxel centre");
}

static const struct table_field columns[] = {
    TABLE_IDENTITY,
    {"rank", NULL, "1 is admitted first", TABLE_COUNT_BY(table_place)},
    {"angle_deg", "degree", "full opening angle of the narrowest cone that holds some of it",
     TABLE_OF(NUMBER, struct row, angle)},
    {"half_angle_deg", "degree", "half of that: the angle to the axis", TABLE_NUMBER_BY(half_angle)},
    {"margin_deg", "degree", "by how much the cone must open further for the next one",
     TABLE_OF(NUMBER, struct row, margin)},
    {"distance_mm", "mm", "distance from the apex to what is admitted first", TABLE_OF(NUMBER, struct row, distance)},
    TABLE_XYZ("", "where that is", TABLE_OF, struct row, point),
    {"measured", NULL, "what that is: voxel centre, surface of a mesh or streamline; exact any way",
     TABLE_NAME_BY(measured)},
};

const struct table_fields sweep_fields = {columns, sizeof columns / sizeof *columns};

static int compare(const void *a, const void *b)
{
    const struct row *x = a;
    const struct row *y = b;
    int order = compare_double(x->angle, y->angle);
    order = order ? order : compare_double(x->distance, y->distance);
    return order ? order : compare_unsigned(x->object.number, y->object.number);
}

static struct row describe(const struct admission *admission, const conus_atlas *atlas, const struct cone *cone,
                           uint32_t number)
{
    struct row row = {.object = {conus_atlas_object(atlas, number)->kind, number},
                      .angle = 2 * atan(admission->slope),
                      .is_surface = admission->is_surface,
                      .margin = NAN};
    double v[3];
    vec3_sub(v, admission->point, cone->pose.world_from_device + 12);
    row.distance = vec3_length(v);
    memcpy(row.point, admission->point, sizeof row.point);
    return row;
}

/* Keeps what the widest cone admits, in the order of its angles, and the margin to the first that it does not. Angles
 * are radians until they are ordered. */
static size_t list_rows(struct row *rows, const struct admission *admissions, const conus_atlas *atlas,
                        const struct cone *cone)
{
    size_t count = 0;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        if (isfinite(admissions[number].slope)) {
            rows[count++] = describe(&admissions[number], atlas, cone, number);
        }
    }
    order_sort(rows, count, sizeof *rows, compare);
    for (size_t i = 0; i + 1 < count; i++) {
        rows[i].margin = rows[i + 1].angle - rows[i].angle;
    }
    while (count > 0 && rows[count - 1].angle > cone->angle) {
        count--;
    }
    for (size_t i = 0; i < count; i++) {
        rows[i].angle = degrees_from_radians(rows[i].angle);
        rows[i].margin = degrees_from_radians(rows[i].margin);
    }
    return count;
}

static conus_status sweep_cone(conus_table **out, const conus_selector *selector, const struct cone *cone)
{
    size_t count = selector->atlas->object_count;
    struct admission *admissions = memory_zeroed(count + 1, sizeof *admissions);
    struct row *rows = memory_raw(count, sizeof *rows);
    conus_status status = admissions && rows ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        for (size_t i = 0; i <= count; i++) {
            admissions[i].slope = INFINITY;
        }
        search(admissions, selector, cone);
        count = list_rows(rows, admissions, selector->atlas, cone);
        status = table_create(out, &(struct table_source){selector->atlas, &selector->frame}, &sweep_fields,
                              &(struct table_question){.cone = *cone}, rows, sizeof *rows, count);
    }
    memory_free(admissions);
    memory_free(rows);
    return status;
}

conus_status conus_sweep(conus_table **out, const conus_selector *selector, const conus_pose *pose, double widest)
{
    const conus_selector_options *options = &selector->options;
    struct cone cone = {.degrees = widest,
                        .angle = radians_from_degrees(widest),
                        .resolution = options->resolution,
                        .range = {selector->range[0], selector->range[1]}};
    if (selector->options.radius > 0) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm, but a cylinder has no angle to sweep",
                    selector->options.radius);
    }
    if (selector->options.aperture == CONUS_APERTURE_SQUARE) {
        return fail(CONUS_ERROR_ARGUMENT, "aperture: square, but a sweep over the angle is of round cones");
    }
    conus_status status = pose_settle(&cone.pose, pose->world_from_device);
    weight_turn(&cone.pose, selector->options.weight);
    status = status ? status : cone_check(&cone);
    return status ? status : sweep_cone(out, selector, &cone);
}
