/* SPDX-License-Identifier: BSD-3-Clause */
/* Formats a NIfTI-1 file. */
#include "loaders/volumes/volumes.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <libdeflate.h>
#include <stdio.h>
#include <string.h>

enum { HEADER = 352, EDGE_LIMIT = 32767, GZIP_LEVEL = 6 };
enum { INTENT_NONE = 0, INTENT_LABEL = 1002, UNITS_MM = 2 };

struct datatype {
    uint32_t limit;
    size_t size;
    int code;
};

static const struct datatype datatypes[] = {[CONUS_NUMBER_UINT8] = {UINT8_MAX, 1, 2},
                                            [CONUS_NUMBER_UINT16] = {UINT16_MAX, 2, 512},
                                            [CONUS_NUMBER_UINT32] = {UINT32_MAX, 4, 768},
                                            [CONUS_NUMBER_FLOAT32] = {0, 4, 16}};

/* The values of the header. */
struct header_values {
    const size_t *dim;
    size_t volumes;   /* along the fourth axis; 0 = there is none */
    size_t extension; /* bytes between the header and the voxels */
    const double *world_from_voxel;
    int code; /* of the space */
    int intent;
    const struct datatype *type;
    const char *description;
};

static void check_grid(struct job *job, const struct header_values *values)
{
    for (int axis = 0; axis < 3; axis++) {
        if (values->dim[axis] < 1 || values->dim[axis] > EDGE_LIMIT) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "NIfTI-1: dim[%d]: %zu, allowed is 1 to %d", axis + 1,
                     values->dim[axis], EDGE_LIMIT);
        }
    }
    for (int i = 0; i < 16; i++) {
        if (!isfinite((float)values->world_from_voxel[i])) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "NIfTI-1: srow: %g, a finite float is needed",
                     values->world_from_voxel[i]);
        }
    }
}

/* Unit columns of the matrix's linear part, the third turned so that they are right-handed; *qfac says whether it was.
 * False where they are not perpendicular: no quaternion says that. */
static bool rotation_of(double r[3][3], double *qfac, const double m[16])
{
    for (int column = 0; column < 3; column++) {
        if (!vec3_normalise(r[column], m + 4 * column)) {
            return false;
        }
    }
    *qfac = mat4_determinant3(m) < 0 ? -1 : 1;
    vec3_scale(r[2], r[2], *qfac);
    return fabs(vec3_dot(r[0], r[1])) < 1e-5 && fabs(vec3_dot(r[1], r[2])) < 1e-5 && fabs(vec3_dot(r[2], r[0])) < 1e-5;
}

/* The unit quaternion w, x, y, z (w >= 0) of a rotation, from its largest component (Shepperd 1978). */
static void quaternion_of(double q[4], double r[3][3])
{
    double trace = r[0][0] + r[1][1] + r[2][2];
    double square[4] = {1 + trace, 1 + 2 * r[0][0] - trace, 1 + 2 * r[1][1] - trace, 1 + 2 * r[2][2] - trace};
    int best = 0;
    for (int i = 1; i < 4; i++) {
        best = square[i] > square[best] ? i : best;
    }
    double skew[3] = {r[1][2] - r[2][1], r[2][0] - r[0][2], r[0][1] - r[1][0]};
    double twice = sqrt(square[best]);
    q[best] = twice / 2;
    for (int i = 1; i < 4; i++) {
        if (best == 0) {
            q[i] = skew[i - 1] / (2 * twice);
        } else if (i != best) {
            q[i] = (r[best - 1][i - 1] + r[i - 1][best - 1]) / (2 * twice);
        }
    }
    if (best != 0) {
        q[0] = skew[best - 1] / (2 * twice);
    }
    double sign = q[0] < 0 ? -1 : 1;
    for (int i = 0; i < 4; i++) {
        q[i] *= sign;
    }
}

static void put_header(uint8_t *header, const struct header_values *values)
{
    const double *m = values->world_from_voxel;
    order_put(header, 348, 4);
    order_put(header + 40, values->volumes ? 4 : 3, 2);
    for (int axis = 0; axis < 7; axis++) {
        size_t along = axis < 3 ? values->dim[axis] : axis == 3 && values->volumes ? values->volumes : 1;
        order_put(header + 42 + 2 * axis, (uint32_t)along, 2);
        order_put_f32(header + 80 + 4 * axis, (float)(axis < 3 ? vec3_length(m + 4 * axis) : 1));
    }
    order_put(header + 68, (uint32_t)values->intent, 2);
    order_put(header + 70, (uint32_t)values->type->code, 2);
    order_put(header + 72, (uint32_t)values->type->size * 8, 2);
    order_put_f32(header + 76, 1);
    order_put_f32(header + 108, (float)(HEADER + values->extension));
    order_put_f32(header + 112, 1);
    header[123] = UNITS_MM;
    snprintf((char *)header + 148, 80, "%s", values->description);
    double r[3][3];
    double q[4];
    double qfac;
    if (rotation_of(r, &qfac, m)) {
        quaternion_of(q, r);
        order_put_f32(header + 76, (float)qfac);
        order_put(header + 252, (uint32_t)values->code, 2);
        for (int i = 0; i < 3; i++) {
            order_put_f32(header + 256 + 4 * i, (float)q[i + 1]);
            order_put_f32(header + 268 + 4 * i, (float)m[12 + i]);
        }
    }
    order_put(header + 254, (uint32_t)values->code, 2);
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            order_put_f32(header + 280 + 16 * row + 4 * column, (float)m[4 * column + row]);
        }
    }
    memcpy(header + 344, "n+1", 4);
}

/* A file of a checked grid with its header, and zeros for voxels. */
static struct bytes start_file(struct job *job, const struct header_values *values)
{
    const size_t volumes = values->volumes ? values->volumes : 1;
    const size_t *dim = values->dim;
    struct bytes file = {0};
    bool fits = memory_multiply(dim[0] * dim[1] * dim[2], volumes * values->type->size, &file.size);
    file.size += HEADER + values->extension;
    file.data = job_zeroed(job, fits ? file.size : SIZE_MAX, 1);
    if (!file.data) {
        return (struct bytes){0};
    }
    put_header(file.data, values);
    return file;
}

static struct bytes format_numbers(struct job *job, const conus_volume_info *info, const uint32_t *labels, int intent,
                                   int code)
{
    struct header_values values = {.dim = info->dim,
                                   .world_from_voxel = info->world_from_voxel,
                                   .code = code,
                                   .intent = intent,
                                   .type = datatypes,
                                   .description = "conus " CONUS_VERSION};
    uint32_t most = 0;
    check_grid(job, &values);
    const size_t count = job_ok(job) ? info->dim[0] * info->dim[1] * info->dim[2] : 0;
    for (size_t i = 0; i < count; i++) {
        most = labels[i] > most ? labels[i] : most;
    }
    while (most > values.type->limit) {
        values.type++;
    }
    const size_t size = values.type->size;
    const struct bytes file = start_file(job, &values);
    for (size_t i = 0; file.data && i < count; i++) {
        order_put(file.data + HEADER + i * size, labels[i], size);
    }
    return file;
}

struct bytes nifti_format_labels(struct job *job, const conus_volume_info *info, const uint32_t *labels, int code)
{
    return format_numbers(job, info, labels, INTENT_LABEL, code);
}

struct bytes nifti_format_values(struct job *job, const conus_volume_info *info, const uint32_t *values, int code)
{
    return format_numbers(job, info, values, INTENT_NONE, code);
}

struct bytes gzip_format(struct job *job, const void *data, size_t size)
{
    struct libdeflate_compressor *packer = libdeflate_alloc_compressor(GZIP_LEVEL);
    size_t bound = packer ? libdeflate_gzip_compress_bound(packer, size) : 0;
    struct bytes packed = {.data = packer ? job_raw(job, bound, 1) : NULL};
    if (packed.data) {
        packed.size = libdeflate_gzip_compress(packer, data, size, packed.data, bound);
    }
    libdeflate_free_compressor(packer);
    if (!packed.size) {
        job_fail(job, CONUS_ERROR_MEMORY, "gzip: no memory to pack %zu bytes", size);
    }
    return packed;
}

static struct bytes nifti_format_grid(struct job *job, const conus_grid *grid)
{
    const conus_grid_view *view = &grid->view;
    const uint8_t *data = grid->data;
    const struct header_values values = {.dim = view->dim,
                                         .world_from_voxel = view->world_from_voxel,
                                         .code = view->space_code <= INT16_MAX ? view->space_code : SPACE_ALIGNED,
                                         .intent = grid->labels ? INTENT_LABEL : INTENT_NONE,
                                         .type = &datatypes[view->number],
                                         .description = view->description};
    check_grid(job, &values);
    const struct bytes file = start_file(job, &values);
    for (size_t i = 0; file.data && i < view->count; i++) {
        order_put(file.data + HEADER + i * grid->size,
                  (uint32_t)order_whole(data + i * grid->size, grid->size, false, false), grid->size);
    }
    return file;
}

struct bytes nifti_format_maps(struct job *job, const conus_grid_view *grid, const conus_vertex_map *maps, size_t count,
                               const uint64_t *voxels, size_t site_count)
{
    enum { COMMENT = 6, ALIGNED_TO = 16, BEFORE = 8 };
    struct buffer names = {0};
    for (size_t k = 0; k < count; k++) {
        buffer_format(&names, "%s%s", k ? "\n" : "", maps[k].name);
    }
    const struct header_values values = {.dim = grid->dim,
                                         .volumes = count,
                                         .extension = (BEFORE + names.size + ALIGNED_TO - 1) / ALIGNED_TO * ALIGNED_TO,
                                         .world_from_voxel = grid->world_from_voxel,
                                         .code = grid->space_code <= INT16_MAX ? grid->space_code : SPACE_ALIGNED,
                                         .type = &datatypes[CONUS_NUMBER_FLOAT32],
                                         .description = "conus " CONUS_VERSION ": maps of a plan"};
    (void)JOB_CALL(job, buffer_status(&names));
    check_grid(job, &values);
    const struct bytes file = start_file(job, &values);
    if (file.data) {
        uint8_t *extension = file.data + HEADER;
        uint8_t *data = extension + values.extension;
        extension[-4] = 1; /* there is one */
        order_put(extension, (uint32_t)values.extension, 4);
        order_put(extension + 4, COMMENT, 4);
        memcpy(extension + BEFORE, names.data ? names.data : "", names.size);
        for (size_t i = 0; i < count * grid->count; i++) {
            order_put_f32(data + 4 * i, NAN);
        }
        for (size_t i = 0; i < count * site_count; i++) {
            size_t k = i / site_count;
            order_put_f32(data + 4 * (k * grid->count + voxels[i % site_count]), maps[k].values[i % site_count]);
        }
    }
    buffer_finish(&names);
    return file;
}

void nifti_write(struct job *job, const char *path, const struct bytes *file)
{
    const struct bytes content = path_ends_in(path, ".gz") ? gzip_format(job, file->data, file->size) : *file;
    (void)JOB_CALL(job, file_write(path, content.data, content.size));
}

bool nifti_is_name(const char *path)
{
    return path_ends_in(path, ".nii") || path_ends_in(path, ".nii.gz");
}

conus_status conus_grid_write(const conus_grid *grid, const char *path)
{
    struct job job = {0};
    if (!nifti_is_name(path)) {
        job_fail(&job, CONUS_ERROR_ARGUMENT, "%s: a volume's name ends in .nii or .nii.gz", path);
    }
    const size_t place = job_in(&job, path, JOB_ALONE);
    const struct bytes file = nifti_format_grid(&job, grid);
    job_out(&job, place);
    nifti_write(&job, path, &file);
    return job_close(&job, NULL, NULL);
}
