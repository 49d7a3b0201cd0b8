/* SPDX-License-Identifier: BSD-3-Clause */
/* Where cones begin, and whether they can hold anything of the atlas. */
#include "selection/study/study.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"
#include "selection/selection.h"

#include <string.h>

/* How much farther a border is than it should be, so that rounding never says that a cone misses what it touches. */
static const double margin = 1e-9;

/* Poses whose coordinates are all within this of 0 may be in metres. */
static const double tiny_mm = 1;

/* Whether the ray along the device's axis hits the box, grown by `more`. */
static bool axis_hits(const double m[16], const double low[3], const double high[3], double more)
{
    double from = 0;
    double to = INFINITY;
    for (int a = 0; a < 3; a++) {
        double first = low[a] - more - m[12 + a];
        double last = high[a] + more - m[12 + a];
        double step = -m[8 + a];
        if (step == 0 && (first > 0 || last < 0)) {
            return false;
        }
        if (step != 0) {
            from = fmax(from, fmin(first / step, last / step));
            to = fmin(to, fmax(first / step, last / step));
        }
    }
    return from <= to;
}

/* Tangent of the angle to the axis, squared, of a point in the device's frame (z forward). */
static double square_slope(const double p[3])
{
    return p[2] > 0 ? (p[0] * p[0] + p[1] * p[1]) / (p[2] * p[2]) : INFINITY;
}

/* The least along an edge: at an end, or where it is stationary, which is at one place, as in Eq. 13. */
static double edge_slope(const double a[3], const double b[3])
{
    const double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double square = a[0] * a[0] + a[1] * a[1];
    double mixed = a[0] * e[0] + a[1] * e[1];
    double t = (square * e[2] - mixed * a[2]) / ((e[0] * e[0] + e[1] * e[1]) * a[2] - mixed * e[2]);
    double least = fmin(square_slope(a), square_slope(b));
    if (t > 0 && t < 1) {
        const double p[3] = {a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]};
        least = fmin(least, square_slope(p));
    }
    return least;
}

static void place_corner(double out[3], const double m[16], const double low[3], const double high[3], unsigned corner)
{
    double v[3];
    for (unsigned a = 0; a < 3; a++) {
        v[a] = (corner >> a & 1 ? high[a] : low[a]) - m[12 + a];
    }
    out[0] = vec3_dot(m, v);
    out[1] = vec3_dot(m + 4, v);
    out[2] = -vec3_dot(m + 8, v);
}

/* Where the axis misses the box, what is nearest to it in angle is on an edge. */
static double least_square_slope(const double m[16], const double low[3], const double high[3])
{
    double least = INFINITY;
    for (unsigned corner = 0; corner < 8; corner++) {
        for (unsigned a = 0; a < 3; a++) {
            if (!(corner >> a & 1)) {
                double from[3];
                double to[3];
                place_corner(from, m, low, high, corner);
                place_corner(to, m, low, high, corner | 1U << a);
                least = fmin(least, edge_slope(from, to));
            }
        }
    }
    return least;
}

bool pose_check_past(const struct cone *cone, const double low[3], const double high[3])
{
    const double *m = cone->pose.world_from_device;
    double around = cone->aperture == CONUS_APERTURE_SQUARE ? sqrt(2) : 1;
    if (axis_hits(m, low, high, cone->radius * around * (1 + margin))) {
        return false;
    }
    double slope = cone_slope(cone) * around * (1 + margin);
    return cone->radius > 0 || least_square_slope(m, low, high) > slope * slope;
}

static uint32_t object_at(const conus_atlas *atlas, const double point[3])
{
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        size_t voxel;
        if (volume->info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(volume) &&
            volume_find_voxel(&voxel, volume, point) && volume_object(volume, voxel)) {
            return volume_object(volume, voxel);
        }
    }
    return 0;
}

/* The closed surface in which something begins; NULL for an object of another kind. */
static const struct mesh *closed_mesh(const conus_atlas *atlas, uint32_t object)
{
    const struct mesh *mesh = object == VOLUME_BLOCKER ? NULL : atlas_object_mesh(atlas, object);
    return mesh && mesh->shape.closed ? mesh : NULL;
}

/* Whether the point is in the box around a closed surface: in few it is, and only then a ray says more. */
static bool may_be_enclosed(const conus_atlas *atlas, const double point[3])
{
    bool found = false;
    for (uint32_t object = 1; atlas->mesh_count && object <= atlas->object_count && !found; object++) {
        const struct mesh *mesh = closed_mesh(atlas, object);
        found = mesh;
        for (int a = 0; a < 3 && found; a++) {
            found = point[a] >= mesh->shape.low[a] && point[a] <= mesh->shape.high[a];
        }
    }
    return found;
}

/* The smallest closed surface around the apex: one that the axis is inside of from 0 on (Eq. 10). */
static uint32_t object_around(const conus_selector *selector, const struct cone *cone)
{
    const conus_atlas *atlas = selector->atlas;
    struct engine *engine = selector->engine;
    struct layers layers = {0};
    uint32_t found = 0;
    double least = INFINITY;
    if (selector->options.sampling != CONUS_SAMPLING_EXACT ||
        !may_be_enclosed(atlas, cone->pose.world_from_device + 12) ||
        engine->functions->pierce(engine, &layers, cone)) {
        layers_finish(&layers);
        return 0;
    }
    for (size_t i = 0; i < layers.count; i++) {
        const conus_interval *interval = &layers.intervals[i];
        const struct mesh *mesh =
            interval->entry == 0 && interval->exit > 0 ? closed_mesh(atlas, interval->object) : NULL;
        if (mesh && fabs(mesh->shape.volume_mm3) < least) {
            least = fabs(mesh->shape.volume_mm3);
            found = interval->object;
        }
    }
    layers_finish(&layers);
    return found;
}

void pose_check_init(struct conus_pose_check *out, const conus_selector *selector)
{
    *out = (struct conus_pose_check){.selector = selector, .has_box = selector->has_box};
    memcpy(out->low, selector->box[0], sizeof out->low);
    memcpy(out->high, selector->box[1], sizeof out->high);
    out->has_box = out->has_box || conus_atlas_bounds(out->low, out->high, selector->atlas) == CONUS_OK;
}

conus_status conus_pose_check_create(conus_pose_check **out, const conus_selector *selector)
{
    conus_pose_check *check = memory_zeroed(1, sizeof *check);
    if (!check) {
        return CONUS_ERROR_MEMORY;
    }
    pose_check_init(check, selector);
    *out = check;
    return CONUS_OK;
}

void conus_pose_check_destroy(conus_pose_check *check)
{
    memory_free(check);
}

static void count(conus_pose_finding *finding, uint64_t number, const struct cone *cone, uint32_t object)
{
    if (!finding->count || number < finding->first) {
        *finding = (conus_pose_finding){finding->count, number, object, cone->pose, cone->degrees};
    }
    finding->count++;
}

void conus_pose_check_add(conus_pose_check *check, uint64_t number, const conus_pose *pose, double angle)
{
    const conus_selector_options *options = &check->selector->options;
    struct cone cone = {.degrees = angle,
                        .angle = radians_from_degrees(angle),
                        .resolution = 1,
                        .aperture = options->aperture,
                        .radius = options->radius};
    const double *apex = cone.pose.world_from_device + 12;
    if (!check->has_box || pose_settle(&cone.pose, pose->world_from_device) || cone_check(&cone)) {
        return;
    }
    check->found.poses++;
    uint32_t object = cone.radius > 0 ? 0 : object_at(check->selector->atlas, apex); /* a needle begins inside */
    object = object || cone.radius > 0 ? object : object_around(check->selector, &cone);
    if (object) {
        count(&check->found.inside, number, &cone, object);
    } else if (pose_check_past(&cone, check->low, check->high)) {
        count(&check->found.away, number, &cone, 0);
    }
    if (fabs(apex[0]) < tiny_mm && fabs(apex[1]) < tiny_mm && fabs(apex[2]) < tiny_mm && vec3_length(apex) > 0) {
        count(&check->found.tiny, number, &cone, 0);
    }
}

void conus_pose_check_add_point(conus_pose_check *check, uint64_t number, const double point[3], double radius)
{
    struct cone ball = {0};
    double gap[3];
    if (!check->has_box || !vec3_is_finite(point)) {
        return;
    }
    mat4_identity(ball.pose.world_from_device);
    for (int i = 0; i < 3; i++) {
        ball.pose.world_from_device[12 + i] = point[i];
        gap[i] = fmax(0, fmax(check->low[i] - point[i], point[i] - check->high[i]));
    }
    check->found.points++;
    double longest =
        fmax(check->high[0] - check->low[0], fmax(check->high[1] - check->low[1], check->high[2] - check->low[2]));
    if (vec3_length(gap) > longest / 4) {
        count(&check->found.far, number, &ball, 0);
    }
    if (radius > 0 && vec3_length(gap) > radius * (1 + margin)) {
        count(&check->found.apart, number, &ball, 0);
    }
}

const conus_pose_findings *conus_pose_check_found(const conus_pose_check *check)
{
    return &check->found;
}

static void merge(conus_pose_finding *finding, const conus_pose_finding *from)
{
    uint64_t sum = finding->count + from->count;
    if (from->count && (!finding->count || from->first < finding->first)) {
        *finding = *from;
    }
    finding->count = sum;
}

void pose_check_merge(conus_pose_findings *check, const conus_pose_findings *from)
{
    check->poses += from->poses;
    merge(&check->inside, &from->inside);
    merge(&check->away, &from->away);
    merge(&check->tiny, &from->tiny);
    check->points += from->points;
    merge(&check->far, &from->far);
    merge(&check->apart, &from->apart);
}
