/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the header of a TrackVis file, and makes the matrix into the world of it. */
#include "loaders/tracts/trk_header.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/text.h"

#include <stdio.h>

/* Offsets of fields (www.trackvis.org, "Track File (.trk) Format"). */
enum {
    DIM = 6,
    VOXEL_SIZE = 12,
    SCALAR_COUNT = 36,
    SCALAR_NAMES = 38,
    PROPERTY_COUNT = 238,
    PROPERTY_NAMES = 240,
    VOX_TO_RAS = 440,
    VOXEL_ORDER = 948,
    STREAMLINE_COUNT = 988,
    VERSION = 992,
    HEADER_SIZE = 996
};

struct order {
    char letters[5]; /* "LPS" */
    int axis[3];     /* of the world, 0 to 2, along which an axis of voxels runs */
    int sign[3];
};

/* How much the length of 1 mm may change on its way into the world. */
static const double length_tolerance = 0.01;

static double read_float(const uint8_t *data, bool swapped)
{
    return (double)order_f32(data, swapped);
}

static conus_status check_version(struct trk_header *header, const uint8_t *data)
{
    int32_t size = order_i32(data + HEADER_SIZE, false);
    header->swapped = size != TRK_HEADER_SIZE;
    if (header->swapped && order_i32(data + HEADER_SIZE, true) != TRK_HEADER_SIZE) {
        return fail(CONUS_ERROR_DATA, "hdr_size: found %d, needed is %d in either byte order", size, TRK_HEADER_SIZE);
    }
    header->version = order_i32(data + VERSION, header->swapped);
    if (header->version < 1 || header->version > 2) {
        return fail(CONUS_ERROR_UNSUPPORTED, "version: found %d, allowed are 1 and 2", header->version);
    }
    int32_t count = order_i32(data + STREAMLINE_COUNT, header->swapped);
    header->streamline_count = (uint32_t)count;
    return count >= 0 ? CONUS_OK
                      : fail(CONUS_ERROR_DATA, "n_count: found %d, allowed are 0 (not stated) and more", count);
}

static conus_status read_names(struct trk_names *out, const char *field, int16_t count, const uint8_t *names)
{
    *out = (struct trk_names){(uint32_t)count, names};
    return count >= 0 ? CONUS_OK : fail(CONUS_ERROR_DATA, "%s: found %d, allowed are 0 and more", field, count);
}

/* Which axis of the world a letter means, in any case, and which way; 3 if none. */
static int axis_of_letter(char letter, int *sign)
{
    static const char letters[] = "LRPAIS";
    char upper = (char)(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
    const char *at = upper ? strchr(letters, upper) : NULL;
    ptrdiff_t place = at ? at - letters : 6;
    *sign = place & 1 ? 1 : -1;
    return (int)(place / 2);
}

/* The three letters of voxel_order. */
static conus_status read_order(struct order *out, const uint8_t *field, struct notes *notes)
{
    unsigned found = 0;
    snprintf(out->letters, sizeof out->letters, "%.4s", field[0] ? (const char *)field : "LPS");
    for (size_t i = 0; i < 3; i++) {
        out->axis[i] = axis_of_letter(out->letters[i], &out->sign[i]);
        found |= 1U << out->axis[i];
    }
    if (strlen(out->letters) != 3 || found != 7) {
        text_make_plain(out->letters, "");
        return fail(CONUS_ERROR_DATA, "voxel_order: found \"%s\", needed is one letter of each of LR, PA and IS",
                    out->letters);
    }
    return field[0] ? CONUS_OK : notes_warn(notes, "voxel_order: not stated, taken as LPS, TrackVis's own");
}

/* The rotation, or reflection, that is nearest to @p m, whose columns have length 1: Newton's iteration for the polar
 * decomposition, which squares the error each time. False where there is none. */
static bool nearest_rotation(double m[16])
{
    for (int round = 0; round < 100; round++) {
        double inverse[16];
        double change = 0;
        if (!mat4_invert_affine(inverse, m)) {
            return false;
        }
        for (int column = 0; column < 3; column++) {
            for (int row = 0; row < 3; row++) {
                double mean = 0.5 * (m[4 * column + row] + inverse[4 * row + column]);
                change = fmax(change, fabs(mean - m[4 * column + row]));
                m[4 * column + row] = mean;
            }
        }
        if (change < 1e-14) {
            return true;
        }
    }
    return true;
}

/* Along which axis of the world each axis of voxels runs: that of its largest part which no axis before has. */
static bool order_of_matrix(struct order *out, const double matrix[16])
{
    static const char letters[] = "LRPAIS";
    double m[16];
    bool taken[3] = {false};
    mat4_identity(m);
    for (int i = 0; i < 3; i++) {
        if (!vec3_normalise(m + 4 * i, matrix + 4 * i)) {
            return false;
        }
    }
    if (!nearest_rotation(m)) {
        return false;
    }
    *out = (struct order){0};
    for (int i = 0; i < 3; i++) {
        int best = taken[0] ? taken[1] ? 2 : 1 : 0;
        for (int axis = best + 1; axis < 3; axis++) {
            best = !taken[axis] && fabs(m[4 * i + axis]) > fabs(m[4 * i + best]) ? axis : best;
        }
        taken[best] = true;
        out->axis[i] = best;
        out->sign[i] = m[4 * i + best] < 0 ? -1 : 1;
        out->letters[i] = letters[2 * best + (out->sign[i] > 0)];
    }
    return true;
}

/* The matrix vox_to_ras, column-major; false where it is not recorded. */
static bool read_matrix(double out[16], const struct trk_header *header, const uint8_t *data)
{
    for (size_t row = 0; row < 4; row++) {
        for (size_t column = 0; column < 4; column++) {
            out[4 * column + row] = read_float(data + VOX_TO_RAS + 16 * row + 4 * column, header->swapped);
        }
    }
    bool recorded = header->version >= 2 && (out[15] < 0 || out[15] > 0 || isnan(out[15]));
    if (!recorded) {
        mat4_identity(out);
    }
    return recorded;
}

static conus_status check_matrix(double matrix[16])
{
    if (!mat4_settle_last_row(matrix)) {
        return fail(CONUS_ERROR_DATA, "vox_to_ras: last row %.9g %.9g %.9g %.9g, 0 0 0 1 is needed", matrix[3],
                    matrix[7], matrix[11], matrix[15]);
    }
    double inverse[16];
    return mat4_invert_affine(inverse, matrix)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "vox_to_ras: is singular or not finite, needed is a matrix with an inverse");
}

static conus_status read_sizes(double out[3], const struct trk_header *header, const uint8_t *data)
{
    char text[TEXT_NUMBER_SIZE];
    for (size_t i = 0; i < 3; i++) {
        out[i] = read_float(data + VOXEL_SIZE + 4 * i, header->swapped);
        if (!(out[i] > 0) || !isfinite(out[i])) {
            return fail(CONUS_ERROR_DATA, "voxel_size: found %s of axis %zu, allowed is above 0 mm",
                        text_number(text, out[i]), i);
        }
    }
    return CONUS_OK;
}

/* out = voxel indices of the matrix from those of the header: axes that run the other way are turned round. */
static conus_status turn_axes(double out[16], const struct trk_header *header, const struct order *file,
                              const struct order *matrix, const uint8_t *data, struct notes *notes)
{
    bool any = false;
    mat4_identity(out);
    for (size_t i = 0; i < 3; i++) {
        int16_t dim = order_i16(data + DIM + 2 * i, header->swapped);
        if (file->axis[i] != matrix->axis[i]) {
            return fail(CONUS_ERROR_UNSUPPORTED,
                        "voxel_order: found %s, vox_to_ras has %s; an axis may run the other way, not elsewhere",
                        file->letters, matrix->letters);
        }
        bool turned = file->sign[i] != matrix->sign[i];
        if (turned && dim < 1) {
            return fail(CONUS_ERROR_DATA,
                        "dim: found %d of axis %zu, which voxel_order %s turns; allowed are 1 and more", dim, i,
                        file->letters);
        }
        out[5 * i] = turned ? -1 : 1;
        out[12 + i] = turned ? dim - 1 : 0;
        any = any || turned;
    }
    return !any ? CONUS_OK
                : notes_add(notes, "voxel_order: %s, vox_to_ras has %s: the axes that differ are turned round",
                            file->letters, matrix->letters);
}

/* 1 mm in the file has to be 1 mm in the world. */
static conus_status check_lengths(const struct trk_header *header, const double sizes[3], bool recorded)
{
    for (int i = 0; i < 3; i++) {
        char text[2][TEXT_NUMBER_SIZE];
        double length = vec3_length(header->world + 4 * i);
        if (!(fabs(length - 1) <= length_tolerance)) {
            text_number(text[0], sizes[i]);
            text_number(text[1], sizes[i] * length);
            return recorded
                       ? fail(CONUS_ERROR_DATA,
                              "voxel_size: found %s mm of axis %d, vox_to_ras has %s; needed is the same", text[0], i,
                              text[1])
                       : fail(CONUS_ERROR_DATA,
                              "vox_to_ras: not recorded, and voxel_size is %s mm of axis %d; without the matrix only "
                              "1 mm is allowed",
                              text[0], i);
        }
    }
    return CONUS_OK;
}

/* The way of docs/spaces.md: mm to voxels, corner to centre, axes as in the matrix, the matrix. */
static conus_status make_world(struct trk_header *header, const uint8_t *data, struct notes *notes)
{
    struct order file;
    struct order matrix;
    double sizes[3];
    double voxel[16];
    double turn[16];
    const bool recorded = header->has_matrix = read_matrix(header->world, header, data);
    conus_status status = recorded ? check_matrix(header->world)
                                   : notes_warn(notes, "vox_to_ras: not recorded, taken as the identity: nothing says "
                                                       "where in the world the streamlines are");
    status = status ? status : read_sizes(sizes, header, data);
    status = status ? status : read_order(&file, data + VOXEL_ORDER, notes);
    if (!status && !order_of_matrix(&matrix, header->world)) {
        status = fail(CONUS_ERROR_DATA, "vox_to_ras: has no axes, needed is a matrix with an inverse");
    }
    status = status ? status : turn_axes(turn, header, &file, &matrix, data, notes);
    if (status) {
        return status;
    }
    mat4_identity(voxel);
    for (int i = 0; i < 3; i++) {
        voxel[5 * i] = 1 / sizes[i];
        voxel[12 + i] = -0.5;
    }
    mat4_multiply(turn, turn, voxel);
    mat4_multiply(header->world, header->world, turn);
    return check_lengths(header, sizes, recorded);
}

conus_status trk_header_parse(struct trk_header *out, const uint8_t *data, struct notes *notes)
{
    struct trk_header header = {0};
    conus_status status = check_version(&header, data);
    status = status ? status
                    : read_names(&header.scalars, "n_scalars", order_i16(data + SCALAR_COUNT, header.swapped),
                                 data + SCALAR_NAMES);
    status = status ? status
                    : read_names(&header.properties, "n_properties", order_i16(data + PROPERTY_COUNT, header.swapped),
                                 data + PROPERTY_NAMES);
    status = status ? status : make_world(&header, data, notes);
    *out = status ? *out : header;
    return status;
}
