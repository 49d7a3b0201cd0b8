/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds where a tool's axis comes into what is shown and leaves it, and turns the tool about there. */
#include "viewer/tools/tools.h"

#include "base/geometry/math3.h"

#include <math.h>

static double between(double out[3], const double from[3], const double to[3])
{
    vec3_sub(out, to, from);
    return vec3_length(out);
}

static double depth_of(const conus_selection *selection, size_t pixel, const double apex[3], const double axis[3])
{
    double at[3];
    double offset[3];
    conus_selection_position(at, selection, pixel);
    between(offset, apex, at);
    return fmax(vec3_dot(offset, axis), 0);
}

/* The depths along the axis of the first hits that are nearest to the apex and farthest from it; negative without one.
 */
static void find_hits(double out[2], const conus_selection *selection, const double apex[3], const double axis[3])
{
    conus_evidence evidence = conus_selection_evidence(selection);
    size_t pixels = (size_t)evidence.resolution * evidence.resolution;
    size_t ends[2] = {pixels, pixels};
    for (size_t p = 0; p < pixels; p++) {
        if (evidence.in_cone[p] && evidence.object[p]) {
            bool is_first = ends[0] == pixels;
            ends[0] = is_first || evidence.distance[p] < evidence.distance[ends[0]] ? p : ends[0];
            ends[1] = is_first || evidence.distance[p] > evidence.distance[ends[1]] ? p : ends[1];
        }
    }
    for (int e = 0; e < 2; e++) {
        out[e] = ends[e] < pixels ? depth_of(selection, ends[e], apex, axis) : -1;
    }
}

/* The depth along the axis at which a ray of the cone leaves the last object that it passes; negative without one. */
static double find_deepest(const conus_selection *selection, const double apex[3], const double axis[3])
{
    size_t count;
    const conus_interval *intervals = conus_selection_intervals(&count, selection);
    const conus_evidence evidence = conus_selection_evidence(selection);
    double deepest = -1;
    for (size_t i = 0; i < count; i++) {
        const size_t pixel = intervals[i].pixel;
        const double first = (double)evidence.distance[pixel];
        if (evidence.in_cone[pixel]) {
            double slant = first > 0 ? depth_of(selection, pixel, apex, axis) / first : 1;
            deepest = fmax(deepest, slant * intervals[i].exit);
        }
    }
    return deepest;
}

void extent_find(struct extent *out, struct viewer *viewer, enum tool_number number)
{
    conus_selector_options options;
    const conus_selection *selection = view_atlas_selection(viewer->drawn, number);
    const double *m = viewer->tools[number].pose.world_from_device;
    const double *apex = m + 12;
    const double axis[3] = {-m[8], -m[9], -m[10]};
    double middle[3];
    double before[3];
    double behind[3];
    viewer_query(&options, viewer, number, 0);
    double whole = between(middle, apex, viewer->centre) + viewer->radius;
    double nearest = vec3_dot(middle, axis);
    vec3_add_scaled(before, apex, nearest - viewer->radius, axis);
    vec3_add_scaled(behind, apex, nearest + viewer->radius, axis);
    double enters = nearest - viewer->radius + point_depth(viewer, before, axis);
    double leaves = nearest + viewer->radius - point_depth(viewer, behind, m + 8);
    bool meets = isfinite(enters);
    vec3_add_scaled(out->entry, apex, meets ? enters : nearest, axis);
    out->reach = point_before(viewer) + (meets ? 0 : viewer->radius);
    out->near = options.range[1] > 0 ? options.range[0] : 0;
    out->end = options.range[1] > 0 ? options.range[1] : leaves > 0 ? leaves : whole;
    double hits[2] = {-1, -1};
    if (selection) {
        find_hits(hits, selection, apex, axis);
        if (options.layers == CONUS_LAYERS_ALL && !(options.range[1] > 0)) {
            out->end = fmax(out->end, find_deepest(selection, apex, axis));
        }
    }
    out->first = hits[0] < 0 ? out->end : hits[0];
    out->solid = options.layers != CONUS_LAYERS_ALL ? hits[1] : -1;
    out->solid = out->solid < 0 ? out->end : fmin(fmax(out->solid, out->near), out->end);
}

void extent_ball(double out[3], const struct extent *extent, const conus_pose *pose)
{
    vec3_add_scaled(out, extent->entry, extent->reach, pose->world_from_device + 8);
}

void extent_turn(struct viewer *viewer, enum tool_number number, const struct extent *extent, const double eye[3],
                 const double direction[3])
{
    const conus_pose *pose = &viewer->tools[number].pose;
    const double *apex = pose->world_from_device + 12;
    double ball[3];
    double at[3];
    double offset[3];
    double origin[3];
    const double axis[3] = {-pose->world_from_device[8], -pose->world_from_device[9], -pose->world_from_device[10]};
    extent_ball(ball, extent, pose);
    between(offset, apex, extent->entry);
    double depth = vec3_dot(offset, axis); /* of the entry */
    between(offset, eye, extent->entry);
    double nearest = vec3_dot(offset, direction); /* along the ray, to the entry */
    double inside = extent->reach * extent->reach - (vec3_dot(offset, offset) - nearest * nearest);
    between(offset, eye, ball);
    double half = inside > 0 ? sqrt(inside) : 0;
    vec3_add_scaled(at, eye, nearest + (vec3_dot(offset, direction) < nearest ? -half : half), direction);
    double size = between(offset, at, extent->entry);
    if (size > 0) {
        vec3_add_scaled(origin, extent->entry, -depth / size, offset);
        tool_aim_along(viewer, number, origin, offset);
    }
}
