/* SPDX-License-Identifier: BSD-3-Clause */
/* Cameras from poses, from a frustum and around points; projection of points. */
#include "render/gl/camera.h"

#include "base/geometry/math3.h"

/* The field of view spans the picture's height; pixels are square. */
static void set_slopes(struct camera *camera, double field_of_view, uint32_t width, uint32_t height)
{
    camera->slope[1] = tan(field_of_view / 2);
    camera->slope[0] = camera->slope[1] * width / height;
    camera->middle[0] = camera->middle[1] = 0;
}

void camera_from_pose(struct camera *out, const conus_pose *pose, double field_of_view, uint32_t width, uint32_t height)
{
    memcpy(out->world_from_camera, pose->world_from_device, sizeof out->world_from_camera);
    set_slopes(out, field_of_view, width, height);
}

void camera_from_frustum(struct camera *out, const conus_pose *pose, const double frustum[4])
{
    memcpy(out->world_from_camera, pose->world_from_device, sizeof out->world_from_camera);
    for (int axis = 0; axis < 2; axis++) {
        out->slope[axis] = (frustum[2 * axis + 1] - frustum[2 * axis]) / 2;
        out->middle[axis] = (frustum[2 * axis + 1] + frustum[2 * axis]) / 2;
    }
}

/* The points along one axis, moved along the frustum's two planes of that axis to the depth 0. */
struct extent {
    double low, high;
    double low_slope, high_slope; /* of the planes: at depth z before the eye they are z slope off the axis */
};

static struct extent extent_along(const double *axis, const double *z, const double slopes[2], const double *points,
                                  size_t count)
{
    struct extent extent = {INFINITY, -INFINITY, slopes[0], slopes[1]};
    for (size_t i = 0; i < count; i++) {
        double a = vec3_dot(axis, points + 3 * i);
        double depth = vec3_dot(z, points + 3 * i);
        extent.low = fmin(extent.low, a + depth * slopes[0]);
        extent.high = fmax(extent.high, a + depth * slopes[1]);
    }
    return extent;
}

/* Where the eye lies along the axis, D before the depth 0, lies between high - D high_slope and low - D low_slope. */
static double nearest(const struct extent *extent)
{
    return (extent->high - extent->low) / (extent->high_slope - extent->low_slope);
}

static double middle(const struct extent *extent, double distance)
{
    return (extent->high + extent->low - distance * (extent->high_slope + extent->low_slope)) / 2;
}

void camera_frame_points(struct camera *out, const double *points, size_t count, const double forward[3],
                         double field_of_view, const struct camera_frame *frame)
{
    double *m = out->world_from_camera;
    double *x = m, *y = m + 4, *z = m + 8; /* z up in the picture, or y where it looks along z */
    mat4_identity(m);
    vec3_scale(z, forward, -1 / vec3_length(forward));
    const double up[3] = {0, fabs(z[2]) > 0.999, fabs(z[2]) <= 0.999};
    vec3_cross(x, up, z);
    vec3_normalise(x, x);
    vec3_cross(y, z, x);
    set_slopes(out, field_of_view, frame->width, frame->height);
    double h[2] = {(frame->left * 2.0 / frame->width - 1) * out->slope[0],
                   (1 - frame->right * 2.0 / frame->width) * out->slope[0]};
    double v[2] = {(frame->bottom * 2.0 / frame->height - 1) * out->slope[1],
                   (1 - frame->top * 2.0 / frame->height) * out->slope[1]};
    struct extent across = extent_along(x, z, h, points, count);
    struct extent upward = extent_along(y, z, v, points, count);
    double distance = fmax(nearest(&across), nearest(&upward));
    double eye[3];
    vec3_scale(eye, z, distance);
    vec3_add_scaled(eye, eye, middle(&across, distance), x);
    vec3_add_scaled(eye, eye, middle(&upward, distance), y);
    memcpy(m + 12, eye, sizeof eye);
}

void camera_default_forward(double out[3])
{
    memcpy(out, (double[]){0.62, -0.65, -0.38}, 3 * sizeof *out);
}

/* How close a direction comes to looking from the left, right, front or back. */
static double canonical(const double forward[3])
{
    return fmax(fabs(forward[0]), fabs(forward[1])) / vec3_length(forward);
}

void camera_cone_forward(double out[3], const double axis[3])
{
    const double superior[3] = {0, 0, 1};
    double unit[3], side[3], left[3], right[3];
    vec3_scale(unit, axis, 1 / vec3_length(axis));
    vec3_cross(side, unit, superior);
    if (vec3_length(side) < 0.05 || !vec3_normalise(side, side)) {
        memcpy(side, (double[]){0, -1, 0}, sizeof side);
    }
    double lean = tan(radians_from_degrees(35));
    vec3_add_scaled(left, unit, lean, side);
    vec3_add_scaled(right, unit, -lean, side);
    bool is_left = canonical(left) > canonical(right) + 1e-6 ||
                   (canonical(left) > canonical(right) - 1e-6 && left[1] < right[1]); /* a tie: from the front */
    vec3_add_scaled(out, is_left ? left : right, -0.3, superior);
}

bool camera_project(double *x, double *y, double *depth, const struct camera *camera, const struct camera_frame *frame,
                    const double p[3])
{
    const double *m = camera->world_from_camera;
    double v[3];
    vec3_sub(v, p, m + 12);
    double z = -vec3_dot(m + 8, v);
    if (!(z > 0)) {
        return false;
    }
    *x = ((vec3_dot(m, v) - z * camera->middle[0]) / (z * camera->slope[0]) + 1) / 2 * frame->width;
    *y = (1 - (vec3_dot(m + 4, v) - z * camera->middle[1]) / (z * camera->slope[1])) / 2 * frame->height;
    *depth = z;
    return true;
}
