/* SPDX-License-Identifier: BSD-3-Clause */
/* The eye that a 3-D picture is seen by: projections, the orbit around the brain, a tracked head. */
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "viewer/pictures/pictures.h"

#include <math.h>
#include <string.h>

bool pose_is_same(const conus_pose *a, const conus_pose *b)
{
    bool same = true;
    for (int i = 0; i < 16; i++) {
        same = same && a->world_from_device[i] == b->world_from_device[i];
    }
    return same;
}

bool eye_is_same(const struct eye *a, const struct eye *b)
{
    bool same = pose_is_same(&a->camera, &b->camera);
    for (int i = 0; i < 4; i++) {
        same = same && a->frustum[i] == b->frustum[i];
    }
    return same;
}

void eye_fit(struct eye *eye, const double size[2])
{
    double *f = eye->frustum;
    double middle = (f[0] + f[1]) / 2;
    double half = (f[3] - f[2]) / 2 * size[0] / size[1];
    f[0] = middle - half;
    f[1] = middle + half;
}

void eye_of_orbit(struct eye *out, const struct orbit *orbit, const double size[2])
{
    double slope = tan(orbit->field_of_view / 2);
    *out = (struct eye){.frustum = {0, 0, -slope, slope}};
    orbit_camera(&out->camera, orbit);
    eye_fit(out, size);
}

bool eye_project(double out[2], const struct eye *eye, const double size[2], const double p[3])
{
    const double *m = eye->camera.world_from_device;
    const double *f = eye->frustum;
    double offset[3];
    vec3_sub(offset, p, m + 12);
    const double place[3] = {vec3_dot(offset, m), vec3_dot(offset, m + 4), vec3_dot(offset, m + 8)};
    if (!(place[2] < -0.01)) {
        return false;
    }
    out[0] = size[0] * (place[0] / -place[2] - f[0]) / (f[1] - f[0]);
    out[1] = size[1] * (f[3] - place[1] / -place[2]) / (f[3] - f[2]);
    return true;
}

void eye_ray(double direction[3], const struct eye *eye, const double size[2], const double at[2])
{
    const double *m = eye->camera.world_from_device;
    const double *f = eye->frustum;
    double right = f[0] + at[0] / size[0] * (f[1] - f[0]);
    double up = f[3] - at[1] / size[1] * (f[3] - f[2]);
    double scale = 1 / sqrt(right * right + up * up + 1);
    for (int a = 0; a < 3; a++) {
        direction[a] = scale * (right * m[a] + up * m[4 + a] - m[8 + a]);
    }
}

static const double steepest = 1.55;
static const double field_of_view = 0.5; /* of the pane's shorter side */

void orbit_look_at(struct orbit *orbit, const double centre[3], double radius)
{
    *orbit = (struct orbit){.azimuth = 0.9, .elevation = 0.35, .field_of_view = field_of_view};
    memcpy(orbit->centre, centre, sizeof orbit->centre);
    orbit->distance = 1.08 * radius / sin(orbit->field_of_view / 2);
}

void orbit_fit(struct orbit *orbit, const double size[2])
{
    double slope = tan(field_of_view / 2) * fmax(size[1] / size[0], 1);
    orbit->field_of_view = 2 * atan(slope);
}

void orbit_camera(conus_pose *out, const struct orbit *orbit)
{
    double *m = out->world_from_device;
    const double z[3] = {-sin(orbit->azimuth) * cos(orbit->elevation), cos(orbit->azimuth) * cos(orbit->elevation),
                         sin(orbit->elevation)}; /* from the centre towards the eye */
    const double x[3] = {-cos(orbit->azimuth), -sin(orbit->azimuth), 0};
    mat4_identity(m);
    memcpy(m, x, sizeof x);
    vec3_cross(m + 4, z, x);
    memcpy(m + 8, z, sizeof z);
    vec3_add_scaled(m + 12, orbit->centre, orbit->distance, z);
}

void orbit_look_from(struct orbit *orbit, double azimuth, double elevation)
{
    orbit->azimuth = azimuth;
    orbit->elevation = fmin(fmax(elevation, -steepest), steepest);
}

void orbit_turn(struct orbit *orbit, double right, double down, double height)
{
    double step = 3.5 / height;
    orbit->azimuth = remainder(orbit->azimuth + right * step, 2 * M_PI);
    orbit->elevation = fmin(fmax(orbit->elevation + down * step, -steepest), steepest);
}

void orbit_pan(struct orbit *orbit, double right, double down, double height)
{
    conus_pose camera;
    double scale =
        2 * orbit->distance * tan(orbit->field_of_view / 2) / height; /* mm per pixel in the centre's plane */
    orbit_camera(&camera, orbit);
    vec3_add_scaled(orbit->centre, orbit->centre, scale * down, camera.world_from_device + 4);
    vec3_add_scaled(orbit->centre, orbit->centre, -scale * right, camera.world_from_device);
}

void orbit_zoom(struct orbit *orbit, double clicks)
{
    orbit->distance = fmin(fmax(orbit->distance * pow(0.9, clicks), 1), 1e5);
}

void head_move(struct head *head, const double eye[3], const conus_pose *screen)
{
    conus_pose camera;
    double frustum[4];
    bool inside = conus_window_camera(&camera, frustum, screen, head->size, eye);
    bool moved = !head->known || !pose_is_same(&head->screen, screen);
    for (int a = 0; a < 3; a++) {
        moved = moved || head->eye[a] != eye[a];
    }
    head->number += inside != head->inside || (!inside && moved);
    head->inside = inside;
    if (!inside) {
        memcpy(head->eye, eye, sizeof head->eye);
        head->screen = *screen;
        head->known = true;
    }
}

void head_set_state(struct head *head, enum station_state state)
{
    head->number += head->state != state;
    head->state = state;
}

bool head_toggle(struct head *head)
{
    bool is_there = head->named || head->known;
    head->on = !head->on && is_there;
    head->number++;
    return is_there;
}

bool head_eye(struct eye *out, const struct head *head, const double part[4])
{
    conus_pose pane = head->screen;
    const double *m = head->screen.world_from_device;
    double size[2];
    for (int axis = 0; axis < 2; axis++) {
        double low = part[2 * axis];
        double high = part[2 * axis + 1];
        size[axis] = (high - low) * head->size[axis];
        vec3_add_scaled(pane.world_from_device + 12, pane.world_from_device + 12,
                        ((low + high) / 2 - 0.5) * head->size[axis], m + (ptrdiff_t)4 * axis);
    }
    return head->on && head->known && !conus_window_camera(&out->camera, out->frustum, &pane, size, head->eye);
}

const char *head_text(const struct head *head, bool *is_well)
{
    static const char *const troubles[] = {"no tracker", "no head yet", "head lost", "head silent"};
    static const char *const kept[] = {"no tracker: last view kept", "no head yet: last view kept",
                                       "head lost: last view kept", "head silent: last view kept"};
    *is_well = head->state == STATION_SEEN && !head->inside;
    if (!head->on) {
        return NULL;
    }
    if (head->state != STATION_SEEN) {
        return (head->known ? kept : troubles)[head->state];
    }
    return head->inside ? "eye not before the screen: last view kept" : "as the head sees it";
}
