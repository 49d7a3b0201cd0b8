/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the surface under the mouse. */
#include "viewer/tools/tools.h"

#include "base/geometry/math3.h"
#include "conus/own.h"
#include "viewer/model/viewer.h"

#include <math.h>

/* The skin's grey value, as a fraction from black to white in the cuts: the air around a head is darker. */
static const double skin_part = 0.2;
static const double before_mm = 40;
static const double fine = 0.01; /* the accuracy of the skin's depth, in steps */

/* A ray through the context. */
struct ray {
    const struct view_atlas *view;
    size_t context;
    const double *from, *direction;
    double skin; /* its grey value */
    double step; /* mm: a voxel */
};

static bool is_inside(const struct ray *ray, double depth)
{
    double at[3];
    vec3_add_scaled(at, ray->from, depth, ray->direction);
    return conus_atlas_value(ray->view->atlas, ray->context, at) >= ray->skin; /* NaN, outside of it, is not */
}

/* Finds the skin between both depths, by bisection. */
static double find_skin(const struct ray *ray, double outside, double inside)
{
    while (inside - outside > fine * ray->step) {
        double middle = (outside + inside) / 2;
        *(is_inside(ray, middle) ? &inside : &outside) = middle;
    }
    return inside;
}

/* A single voxel of noise is brighter than air, too, but for less than two voxels along any ray. */
static bool is_skin(const struct ray *ray, double depth)
{
    return is_inside(ray, depth) && is_inside(ray, depth + ray->step) && is_inside(ray, depth + 2 * ray->step);
}

/* The depth of the context's surface between @p least and @p most, mm; INFINITY without one. */
static double depth_of_context(const struct viewer *viewer, const double from[3], const double direction[3],
                               double least, double most)
{
    const struct view_atlas *view = viewer->drawn;
    const double black = view->found_grey[0];
    if (!(view->found_grey[1] > black)) { /* none, or one of a single value, which has no surface */
        return INFINITY;
    }
    size_t context = view_atlas_context(view);
    const double *voxel = conus_atlas_volume(view->atlas, context)->spacing;
    const struct ray ray = {.view = view,
                            .context = context,
                            .from = from,
                            .direction = direction,
                            .skin = black + skin_part * (view->found_grey[1] - black),
                            .step = fmax(voxel[0], fmax(voxel[1], voxel[2]))};
    for (unsigned step = 0; least + ray.step * step < most; step++) {
        double depth = least + ray.step * step;
        if (is_skin(&ray, depth)) {
            return find_skin(&ray, fmax(depth - ray.step, 0), depth);
        }
    }
    return INFINITY;
}

double point_depth(struct viewer *viewer, const double from[3], const double direction[3])
{
    double nearest = INFINITY;
    double far = 2 * viewer->radius;
    double offset[3];
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        nearest = fmin(nearest, view_atlas_depth(&viewer->atlases[i], from, direction));
    }
    vec3_sub(offset, from, viewer->centre);
    const double across = vec3_length(offset);
    nearest = fmin(nearest, conus_atlas_context_depth(viewer->drawn->atlas, from, direction));
    double least = fmax(across - far, 0);
    return fmin(nearest, depth_of_context(viewer, from, direction, least, fmin(nearest, across + far)));
}

double point_before(const struct viewer *viewer)
{
    return fmin(before_mm, viewer->radius / 2);
}

enum starts point_start(const struct viewer *viewer)
{
    const bool has_end = viewer->cone.options.range[1] > 0;
    return viewer->cone.start == START_BEFORE && has_end ? START_SURFACE : viewer->cone.start;
}

bool point_find(conus_pose *out, struct viewer *viewer, const double eye[3], const double direction[3])
{
    const enum starts start = point_start(viewer);
    double depth = start == START_EYE ? 0 : point_depth(viewer, eye, direction);
    double apex[3];
    depth = start == START_BEFORE ? fmax(depth - point_before(viewer), 0) : depth;
    vec3_add_scaled(apex, eye, depth, direction);
    return isfinite(depth) && !conus_pose_along(out, apex, direction, NULL);
}
