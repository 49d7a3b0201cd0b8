/* SPDX-License-Identifier: BSD-3-Clause */
/* Chooses between qform, sform and the plain grid. */
#include "loaders/volumes/nifti_transform.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"

#include <stdio.h>

/* Quaternions are stored as floats: their squares may sum to a little more than 1. */
static const double QUATERN_ROUNDING = 1e-6;

static conus_status check_pixdim(const double pixdim[8])
{
    for (int i = 1; i < 4; i++) {
        if (!(pixdim[i] > 0) || !isfinite(pixdim[i])) {
            return fail(CONUS_ERROR_DATA, "pixdim[%d]: found %g, allowed are finite numbers above 0", i, pixdim[i]);
        }
    }
    return CONUS_OK;
}

/* METHOD 3. */
static void place_sform(double out[16], const double srow[12])
{
    mat4_identity(out);
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            out[4 * column + row] = srow[4 * row + column];
        }
    }
}

/* METHOD 1: nothing is known but sizes. FSL and nibabel take such grids as radiological (i grows towards the left) and
 * centred on the origin, and so does conus. */
static conus_status place_sizes(double out[16], const conus_volume_info *info, const double pixdim[8])
{
    conus_status status = check_pixdim(pixdim);
    mat4_identity(out);
    for (int i = 0; i < 3; i++) {
        double step = i == 0 ? -pixdim[1] : pixdim[i + 1];
        out[5 * i] = step;
        out[12 + i] = -step * ((double)info->dim[i] - 1) / 2;
    }
    return status;
}

/* The rotation of the quaternion (a, b, c, d), |.| = 1, columns scaled by `scale`. */
static void rotation_from(double out[16], double a, const double bcd[3], const double scale[3])
{
    double b = bcd[0];
    double c = bcd[1];
    double d = bcd[2];
    const double columns[9] = {
        a * a + b * b - c * c - d * d, 2 * (b * c + a * d),           2 * (b * d - a * c),
        2 * (b * c - a * d),           a * a + c * c - b * b - d * d, 2 * (c * d + a * b),
        2 * (b * d + a * c),           2 * (c * d - a * b),           a * a + d * d - b * b - c * c};
    for (int i = 0; i < 9; i++) {
        out[4 * (i / 3) + i % 3] = columns[i] * scale[i / 3];
    }
}

/* METHOD 2. */
static conus_status place_qform(double out[16], const struct nifti_placement *p)
{
    double qfac = p->pixdim[0];
    if (qfac < 0 ? qfac != -1 : !isfinite(qfac)) {
        return fail(CONUS_ERROR_DATA, "pixdim[0] (qfac): found %g, allowed are -1 and 1", qfac);
    }
    double squares = vec3_dot(p->quatern, p->quatern);
    if (!(squares <= 1 + QUATERN_ROUNDING)) {
        return fail(CONUS_ERROR_DATA,
                    "quatern_b, c, d: found %.9g, %.9g, %.9g, allowed are numbers whose squares sum to "
                    "at most 1",
                    p->quatern[0], p->quatern[1], p->quatern[2]);
    }
    double a = squares < 1 ? sqrt(1 - squares) : 0;
    double bcd[3];
    vec3_scale(bcd, p->quatern, squares > 1 ? 1 / sqrt(squares) : 1);
    const double scale[3] = {p->pixdim[1], p->pixdim[2], qfac < 0 ? -p->pixdim[3] : p->pixdim[3]};
    mat4_identity(out);
    rotation_from(out, a, bcd, scale);
    memcpy(out + 12, p->qoffset, sizeof p->qoffset);
    return check_pixdim(p->pixdim);
}

/* Largest distance in mm between where a and b put a corner of the grid. */
static double corner_distance(const conus_volume_info *info, const double a[16], const double b[16])
{
    double largest = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        double voxel[3];
        for (unsigned i = 0; i < 3; i++) {
            voxel[i] = corner >> i & 1 ? (double)info->dim[i] - 0.5 : -0.5;
        }
        double here[3];
        double there[3];
        mat4_point(here, a, voxel);
        mat4_point(there, b, voxel);
        vec3_sub(here, here, there);
        largest = fmax(largest, vec3_length(here));
    }
    return largest;
}

/* The sform is in use; says so where the qform would lead elsewhere. */
static conus_status note_other(const conus_volume_info *info, const struct nifti_placement *p, double mm,
                               const double used[16], struct notes *notes)
{
    double other[16];
    if (place_qform(other, p)) {
        return notes_warn(notes, "the qform (code %d) is not valid and was not used; the sform (code %d) was",
                          p->qform_code, p->sform_code);
    }
    double distance = mm * corner_distance(info, used, other);
    return distance <= 1
               ? CONUS_OK
               : notes_warn(notes,
                            "the sform (code %d, %s) and the qform (code %d, %s) put a corner of the grid %.4g mm "
                            "apart; the sform was used",
                            p->sform_code, space_code_name(p->sform_code), p->qform_code,
                            space_code_name(p->qform_code), distance);
}

/* Millimetres per unit of the header. */
static double unit_size(int units)
{
    static const double mm[8] = {1, 1000, 1, 0.001, 1, 1, 1, 1};
    return mm[units & 7];
}

static conus_status note_units(double mm, struct notes *notes)
{
    return mm == 1 ? CONUS_OK
                   : notes_add(notes, "xyzt_units says %s: positions were multiplied by %g to get millimetres",
                               mm > 1 ? "metres" : "micrometres", mm);
}

static conus_status choose_transform(double out[16], char *words, size_t size, const conus_volume_info *info,
                                     const struct nifti_placement *p)
{
    if (p->sform_code > 0) {
        snprintf(words, size, "sform, code %d (%s)", p->sform_code, space_code_name(p->sform_code));
        place_sform(out, p->srow);
        return CONUS_OK;
    }
    if (p->qform_code > 0) {
        snprintf(words, size, "qform, code %d (%s)", p->qform_code, space_code_name(p->qform_code));
        return place_qform(out, p);
    }
    snprintf(words, size, "none: voxel sizes only, grid centred on the origin, i towards the left");
    return place_sizes(out, info, p->pixdim);
}

static conus_status note_choice(const conus_volume_info *info, const struct nifti_placement *p, double mm,
                                const double used[16], struct notes *notes)
{
    if (p->sform_code > 0) {
        return p->qform_code > 0 ? note_other(info, p, mm, used, notes) : CONUS_OK;
    }
    return p->qform_code > 0
               ? CONUS_OK
               : notes_warn(notes, "neither sform nor qform is set: left and right, and the origin, are a "
                                   "guess (i towards the left, grid centred on the origin)");
}

conus_status nifti_place(conus_volume_info *info, const struct nifti_placement *placement, struct notes *notes)
{
    double world[16];
    char words[sizeof info->transform];
    conus_status status = choose_transform(world, words, sizeof words, info, placement);
    double mm = unit_size(placement->units);
    if (status || (status = note_choice(info, placement, mm, world, notes)) || (status = note_units(mm, notes))) {
        return status;
    }
    for (int i = 0; i < 16; i++) {
        world[i] *= i % 4 < 3 ? mm : 1;
    }
    info->space_code = placement->sform_code > 0   ? placement->sform_code
                       : placement->qform_code > 0 ? placement->qform_code
                                                   : 0;
    return space_describe(info, world, words);
}
