/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses from a direction, a target, a matrix or a quaternion (Eq. 1, 2). */
#include "base/geometry/math3.h"
#include "base/status.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"

/* Below this, two directions count as parallel, and a length as zero beside the numbers that made it. */
static const double NEARLY_ZERO = 1e-9;

/* Eq. 2: from this cosine of its angle to "up" on, a direction has "forward" for it. */
static const double NEARLY_UP = 0.999;

/* So little is the square of a length off 1 that was divided by itself. */
static const double UNIT = 2e-15;

/* Numbers have three decimals at worst: products of columns are off by up to 0.0005 (|x| + |y| + |z|) each, that is
 * 0.0005 * 2 * sqrt(3) = 0.00173. */
static const double ROUNDED = 2e-3;

static conus_status check_direction(const double d[3], const char *what)
{
    if (!vec3_is_finite(d) || (d[0] == 0 && d[1] == 0 && d[2] == 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %g,%g,%g, allowed are finite numbers that are not all 0", what, d[0],
                    d[1], d[2]);
    }
    return CONUS_OK;
}

static conus_status check_point(const double p[3], const char *what)
{
    return vec3_is_finite(p)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "%s: %g,%g,%g, allowed are finite numbers", what, p[0], p[1], p[2]);
}

/* The direction may have any length: squares of numbers near 1 neither vanish nor overflow, and powers of two round
 * nothing. */
static void find_unit(double out[3], const double a[3])
{
    int exponent;
    frexp(fmax(fmax(fabs(a[0]), fabs(a[1])), fabs(a[2])), &exponent);
    for (int i = 0; i < 3; i++) {
        out[i] = ldexp(a[i], -exponent);
    }
    vec3_normalise(out, out);
}

bool pose_is_mirrored(const conus_pose *pose)
{
    return mat4_determinant3(pose->world_from_device) < 0;
}

void pose_mirror(conus_pose *pose)
{
    for (int a = 0; a < 3; a++) {
        pose->world_from_device[a] = 0 - pose->world_from_device[a]; /* makes no "-0" of 0 */
    }
}

/* Eq. 2: z = -d, x = normalise(up x z), y = z x x. */
static conus_status make_frame(conus_pose *out, const double origin[3], const double d[3], const double up[3])
{
    double x[3];
    double y[3];
    double z[3];
    double unit_up[3];
    vec3_scale(z, d, -1);
    find_unit(unit_up, up);
    vec3_cross(x, unit_up, z);
    if (vec3_length(x) < NEARLY_ZERO) {
        return fail(CONUS_ERROR_ARGUMENT, "up: %g,%g,%g is parallel to the direction, another vector is needed", up[0],
                    up[1], up[2]);
    }
    vec3_normalise(x, x);
    vec3_cross(y, z, x);
    *out = (conus_pose){
        {x[0], x[1], x[2], 0, y[0], y[1], y[2], 0, z[0], z[1], z[2], 0, origin[0], origin[1], origin[2], 1}};
    return CONUS_OK;
}

conus_status conus_pose_along(conus_pose *out, const double origin[3], const double direction[3], const double up[3])
{
    double d[3];
    conus_status status = check_point(origin, "origin");
    status = status ? status : check_direction(direction, "direction");
    status = status || !up ? status : check_direction(up, "up");
    if (status) {
        return status;
    }
    bool is_unit = fabs(vec3_dot(direction, direction) - 1) < UNIT; /* as an axis is that was written and read back */
    if (is_unit) {
        memcpy(d, direction, sizeof d);
    } else {
        find_unit(d, direction);
    }
    bool along_z = fabs(d[2]) > NEARLY_UP;
    const double fallback[3] = {0, along_z, !along_z};
    return make_frame(out, origin, d, up ? up : fallback);
}

bool pose_space_axes(double upward_forward[2][3], const conus_frame *frame)
{
    static const double world[2][3] = {{0, 0, 1}, {0, 1, 0}};
    const bool is_ccf = frame->space == CONUS_SPACE_CCF;
    const double *m = frame->world_from_space;
    memcpy(upward_forward, world, sizeof world);
    if (frame->space < CONUS_SPACE_CCF) {
        return false;
    }
    for (int a = 0; a < 3; a++) { /* of bregma AP and DV grow forward and upward, of CCF backward and downward */
        upward_forward[0][a] = is_ccf ? 0 - m[4 + a] : m[8 + a];
        upward_forward[1][a] = is_ccf ? 0 - m[a] : m[a];
    }
    find_unit(upward_forward[0], upward_forward[0]);
    find_unit(upward_forward[1], upward_forward[1]);
    return (mat4_determinant3(m) < 0) == is_ccf; /* AP, DV, ML of CCF are right-handed; AP, ML, DV are not */
}

void conus_frame_turn_pose(conus_pose *pose, const conus_frame *frame, bool has_up)
{
    double axes[2][3];
    bool mirrored = pose_space_axes(axes, frame);
    double *m = pose->world_from_device;
    const double direction[3] = {0 - m[8], 0 - m[9], 0 - m[10]};
    if (frame->space >= CONUS_SPACE_CCF && !has_up) {
        bool along_up = fabs(vec3_dot(direction, axes[0])) > NEARLY_UP;
        (void)make_frame(pose, (const double[]){m[12], m[13], m[14]}, direction, axes[along_up]);
    }
    if (mirrored != pose_is_mirrored(pose)) {
        pose_mirror(pose);
    }
}

conus_status conus_pose_toward(conus_pose *out, const double origin[3], const double target[3], const double up[3])
{
    double d[3];
    conus_status status = check_point(origin, "origin");
    status = status ? status : check_point(target, "toward");
    if (status) {
        return status;
    }
    vec3_sub(d, target, origin);
    if (!(vec3_length(d) > NEARLY_ZERO)) {
        return fail(CONUS_ERROR_ARGUMENT, "toward: is the origin itself, another point is needed");
    }
    return conus_pose_along(out, origin, d, up);
}

void direction_from_anatomical(double out[3], const double d[3], const conus_frame *frame)
{
    const double as_given[3] = {d[0], d[1], d[2]};
    if (frame->space == CONUS_SPACE_CCF) {
        conus_frame_direction_to_world(out, frame, (const double[]){-d[1], -d[2], d[0]});
    } else if (frame->space == CONUS_SPACE_BREGMA) {
        conus_frame_direction_to_world(out, frame, (const double[]){d[1], d[0], d[2]});
    } else {
        memcpy(out, as_given, sizeof as_given);
    }
}

void direction_to_anatomical(double out[3], const double world[3], const conus_frame *frame)
{
    const double as_given[3] = {world[0], world[1], world[2]};
    double d[3];
    if (frame->space < CONUS_SPACE_CCF) {
        memcpy(out, as_given, sizeof as_given);
        return;
    }
    conus_frame_direction_from_world(d, frame, world);
    bool is_ccf = frame->space == CONUS_SPACE_CCF;
    out[0] = is_ccf ? d[2] : d[1];
    out[1] = is_ccf ? -d[0] : d[0];
    out[2] = is_ccf ? -d[1] : d[2];
}

/* At `origin`, along a direction in (right, anterior, up) as the space of `frame` has these. */
static conus_status make_anatomical(conus_pose *out, const double origin[3], const double d[3],
                                    const conus_frame *frame)
{
    double along[3];
    direction_from_anatomical(along, d, frame);
    conus_status status = conus_pose_along(out, origin, along, NULL);
    if (!status) {
        conus_frame_turn_pose(out, frame, false);
    }
    return status;
}

/* How far a position in the world is to the right of the midline, in the unit of the frame's space. */
static double right_of_midline(const double world[3], const conus_frame *frame)
{
    double p[3];
    if (frame->space < CONUS_SPACE_CCF) {
        return world[0];
    }
    conus_frame_from_world(p, frame, world);
    return frame->space == CONUS_SPACE_CCF ? p[2] - frame->bregma[2] : p[1];
}

conus_status pose_along_tilts(conus_pose *out, const double origin[3], double tilt_ml, double tilt_ap,
                              const conus_frame *frame)
{
    if (!(fabs(tilt_ml) < MATH3_PI / 2 && fabs(tilt_ap) < MATH3_PI / 2)) {
        return fail(CONUS_ERROR_ARGUMENT, "tilts: %g and %g degrees, allowed are those between -90 and 90",
                    degrees_from_radians(tilt_ml), degrees_from_radians(tilt_ap));
    }
    conus_status status = check_point(origin, "origin");
    double right = status ? 1 : right_of_midline(origin, frame);
    if (!status && fabs(right) < NEARLY_ZERO && tilt_ml != 0) {
        status = fail(CONUS_ERROR_ARGUMENT, "tilt_ml: %g degrees on the midline, from which both sides are lateral",
                      degrees_from_radians(tilt_ml));
    }
    const double d[3] = {tan(tilt_ml) * (right < 0 ? -1 : 1), tan(tilt_ap), -1};
    return status ? status : make_anatomical(out, origin, d, frame);
}

conus_status pose_along_phi_theta(conus_pose *out, const double origin[3], double phi, double theta,
                                  const conus_frame *frame)
{
    if (!isfinite(phi) || !isfinite(theta)) {
        return fail(CONUS_ERROR_ARGUMENT, "phi and theta: %g and %g degrees, finite numbers are needed",
                    degrees_from_radians(phi), degrees_from_radians(theta));
    }
    const double d[3] = {-sin(theta) * cos(phi), -sin(theta) * sin(phi), -cos(theta)};
    return make_anatomical(out, origin, d, frame);
}

/* Gram-Schmidt on the columns, z first: the beam's axis is kept as given. */
static void make_rigid(double out[16], const double m[16])
{
    double x[3];
    double y[3];
    double z[3];
    vec3_scale(z, m + 8, 1 / vec3_length(m + 8));
    vec3_cross(x, m + 4, z);
    vec3_normalise(x, x);
    vec3_cross(y, z, x);
    const double rigid[16] = {x[0], x[1], x[2], 0, y[0], y[1], y[2], 0, z[0], z[1], z[2], 0, m[12], m[13], m[14], 1};
    memcpy(out, rigid, sizeof rigid);
}

conus_status pose_settle(conus_pose *out, const double world_from_device[16])
{
    double m[16];
    memcpy(m, world_from_device, sizeof m);
    for (int i = 0; i < 16; i++) {
        if (!isfinite(m[i])) {
            return fail(CONUS_ERROR_ARGUMENT, "pose matrix: %g in row %d, column %d, allowed are finite numbers", m[i],
                        i % 4 + 1, i / 4 + 1);
        }
    }
    if (!mat4_settle_last_row(m)) {
        return fail(CONUS_ERROR_ARGUMENT, "pose matrix: last row %.9g %.9g %.9g %.9g, allowed is 0 0 0 1", m[3], m[7],
                    m[11], m[15]);
    }
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b <= a; b++) {
            const double product = vec3_dot(m + 4 * a, m + 4 * b);
            if (fabs(product - (a == b)) > ROUNDED) {
                return a == b ? fail(CONUS_ERROR_ARGUMENT,
                                     "pose matrix: column %d is %g long, not 1 within %g; a rigid matrix (rotation and "
                                     "position) is needed",
                                     a + 1, sqrt(product), ROUNDED / 2)
                              : fail(CONUS_ERROR_ARGUMENT,
                                     "pose matrix: columns %d and %d are not at a right angle within %g; a rigid "
                                     "matrix (rotation and position) is needed",
                                     b + 1, a + 1, ROUNDED);
            }
        }
    }
    bool mirrored = mat4_determinant3(m) < 0;
    make_rigid(out->world_from_device, m);
    if (mirrored) {
        pose_mirror(out);
    }
    return CONUS_OK;
}

conus_status pose_settle_in(conus_pose *out, const double world_from_device[16], const conus_frame *frame)
{
    conus_pose pose;
    conus_status status = pose_settle(&pose, world_from_device);
    if (!status && pose_is_mirrored(&pose) && !(frame && pose_space_axes((double[2][3]){{0}}, frame))) {
        status = fail(CONUS_ERROR_ARGUMENT, "pose matrix: left-handed (determinant -1), a rotation is needed");
    }
    *out = status ? *out : pose;
    return status;
}

conus_status conus_pose_from_matrix(conus_pose *out, const double world_from_device[16])
{
    return pose_settle_in(out, world_from_device, NULL);
}

conus_status conus_pose_from_quaternion(conus_pose *out, const double origin[3], const double wxyz[4])
{
    double length = sqrt(wxyz[0] * wxyz[0] + vec3_dot(wxyz + 1, wxyz + 1));
    conus_status status = check_point(origin, "origin");
    if (status) {
        return status;
    }
    if (!(length > NEARLY_ZERO) || !isfinite(length)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "quaternion: %g,%g,%g,%g, allowed are finite numbers of a length from 1e-9 to 1e154", wxyz[0],
                    wxyz[1], wxyz[2], wxyz[3]);
    }
    double w = wxyz[0] / length;
    double x = wxyz[1] / length;
    double y = wxyz[2] / length;
    double z = wxyz[3] / length;
    const double m[4][4] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0},
                            {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0},
                            {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0},
                            {origin[0], origin[1], origin[2], 1}};
    memcpy(out->world_from_device, m, sizeof m);
    return CONUS_OK;
}
