/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's linear transforms (.lta): a matrix from source to destination, between their voxels or in RAS mm. */
#include "loaders/transform/transform_formats.h"

#include "base/geometry/math3.h"

enum { VOXEL_TO_VOXEL = 0, RAS_TO_RAS = 1 };

/* The geometry of one of the two images. */
struct lta_volume {
    bool valid, has_valid, has_size, has_voxel, has_axis[3], has_centre;
    double size[3], voxel[3], axis[3][3], centre[3];
};

bool lta_is(struct text text)
{
    struct text line;
    while (text_line(&text, &line)) {
        line = text_trim(line);
        if (line.size && line.data[0] != '#') {
            return text_starts(line, "type") && text_mentions(line, "=");
        }
    }
    return false;
}

/* "KEY = a b c # comment"; false for another line. */
static bool take_key(struct text *values, struct text line, const char *key)
{
    struct text word;
    struct text rest = line;
    if (!text_word(&rest, &word) || !text_equal(word, key) || !text_word(&rest, &word) || !text_equal(word, "=")) {
        return false;
    }
    *values = rest;
    for (size_t i = 0; i < values->size; i++) {
        values->size = values->data[i] == '#' ? i : values->size;
    }
    return true;
}

static conus_status take_numbers(double *out, size_t count, struct text values, const char *key)
{
    struct text word;
    for (size_t i = 0; i < count; i++) {
        if (!text_word(&values, &word) || !text_to_double(word, &out[i]) || !isfinite(out[i])) {
            return fail(CONUS_ERROR_DATA, "%s: %zu finite numbers are needed", key, count);
        }
    }
    return text_word(&values, &word) ? fail(CONUS_ERROR_DATA, "%s: more than %zu numbers", key, count) : CONUS_OK;
}

/* The next line that is no comment, without white space around it. */
static bool take_line(struct text *rest, struct text *line)
{
    while (text_line(rest, line)) {
        *line = text_trim(*line);
        if (line->size && line->data[0] != '#') {
            return true;
        }
    }
    return false;
}

static conus_status take_volume_line(struct lta_volume *out, struct text line)
{
    static const char *const axes[] = {"xras", "yras", "zras"};
    struct text values;
    double valid;
    conus_status status;
    if (take_key(&values, line, "valid")) {
        status = take_numbers(&valid, 1, values, "valid");
        out->has_valid = true;
        out->valid = !status && valid == 1;
        return status;
    }
    if (take_key(&values, line, "volume")) {
        out->has_size = true;
        return take_numbers(out->size, 3, values, "volume");
    }
    if (take_key(&values, line, "voxelsize")) {
        out->has_voxel = true;
        return take_numbers(out->voxel, 3, values, "voxelsize");
    }
    if (take_key(&values, line, "cras")) {
        out->has_centre = true;
        return take_numbers(out->centre, 3, values, "cras");
    }
    for (int a = 0; a < 3; a++) {
        if (take_key(&values, line, axes[a])) {
            out->has_axis[a] = true;
            return take_numbers(out->axis[a], 3, values, axes[a]);
        }
    }
    return CONUS_OK; /* the image's name, and what later versions say */
}

/* cras is the middle of the voxels: of 256 of them voxel 128's. */
static conus_status world_from_voxel(double out[16], const struct lta_volume *volume, const char *which)
{
    bool whole = volume->valid && volume->has_size && volume->has_voxel && volume->has_axis[0] && volume->has_axis[1] &&
                 volume->has_axis[2] && volume->has_centre;
    if (!whole) {
        return fail(CONUS_ERROR_DATA, "%s volume info: not valid or not whole, but the matrix is between voxels",
                    which);
    }
    mat4_identity(out);
    double middle[3];
    for (int a = 0; a < 3; a++) {
        middle[a] = volume->size[a] / 2;
        vec3_scale(out + 4 * a, volume->axis[a], volume->voxel[a]);
    }
    mat4_direction(middle, out, middle);
    vec3_sub(out + 12, volume->centre, middle);
    return CONUS_OK;
}

static conus_status between_voxels(double out[16], const struct lta_volume volumes[2])
{
    double from[16];
    double to[16];
    double voxel_from_world[16];
    conus_status status = world_from_voxel(from, &volumes[0], "src");
    status = status ? status : world_from_voxel(to, &volumes[1], "dst");
    if (!status && !mat4_invert_affine(voxel_from_world, from)) {
        status = fail(CONUS_ERROR_DATA, "src volume info: its matrix is singular");
    }
    if (!status) {
        mat4_multiply(out, to, out);
        mat4_multiply(out, out, voxel_from_world);
    }
    return status;
}

static conus_status take_head(double *type, struct text *rest)
{
    struct text line;
    struct text values;
    double count = -1;
    double shape[3] = {0};
    conus_status status = CONUS_OK;
    *type = -1;
    while (!status && take_line(rest, &line)) {
        if (take_key(&values, line, "type")) {
            status = take_numbers(type, 1, values, "type");
        } else if (take_key(&values, line, "nxforms")) {
            status = take_numbers(&count, 1, values, "nxforms");
        } else if (line.data[0] >= '0' && line.data[0] <= '9') {
            status = take_numbers(shape, 3, line, "shape of the matrix");
            break;
        }
    }
    if (!status && *type != VOXEL_TO_VOXEL && *type != RAS_TO_RAS) {
        return fail(CONUS_ERROR_UNSUPPORTED, "type: %g, 0 (between voxels) and 1 (RAS to RAS) are read", *type);
    }
    if (!status && (count != 1 || shape[0] != 1 || shape[1] != 4 || shape[2] != 4)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "nxforms: one matrix of 4 x 4 is read");
    }
    return status;
}

conus_status lta_parse(double out[16], struct text text)
{
    struct lta_volume volumes[2] = {0};
    struct lta_volume *at = NULL;
    struct text line;
    double m[16];
    double type;
    conus_status status = take_head(&type, &text);
    status = status ? status : matrix_rows_parse(m, &text, 4, "matrix");
    status = status ? status : matrix_settle(m, "matrix");
    while (!status && take_line(&text, &line)) {
        if (text_starts(line, "src volume info") || text_starts(line, "dst volume info")) {
            at = &volumes[line.data[0] == 'd'];
        } else if (at) {
            status = take_volume_line(at, line);
        }
    }
    if (!status && type == VOXEL_TO_VOXEL) {
        status = between_voxels(m, volumes);
    }
    if (!status) {
        memcpy(out, m, sizeof m);
    }
    return status;
}
