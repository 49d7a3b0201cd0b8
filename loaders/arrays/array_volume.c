/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens an array: checks it, and puts its voxels one after the other where they are not. */
#include "loaders/arrays/array_volume.h"

#include "atlas/space.h"
#include "base/memory.h"
#include "base/options.h"
#include "loaders/volumes/volume_header.h"

#include <stdio.h>
#include <string.h>

static const int datatypes[] = {
    [CONUS_SCALAR_UINT8] = VOLUME_UINT8,     [CONUS_SCALAR_INT8] = VOLUME_INT8,
    [CONUS_SCALAR_UINT16] = VOLUME_UINT16,   [CONUS_SCALAR_INT16] = VOLUME_INT16,
    [CONUS_SCALAR_UINT32] = VOLUME_UINT32,   [CONUS_SCALAR_INT32] = VOLUME_INT32,
    [CONUS_SCALAR_UINT64] = VOLUME_UINT64,   [CONUS_SCALAR_INT64] = VOLUME_INT64,
    [CONUS_SCALAR_FLOAT32] = VOLUME_FLOAT32, [CONUS_SCALAR_FLOAT64] = VOLUME_FLOAT64,
};

static conus_status check_shape(const conus_voxels *voxels)
{
    if (!voxels->data) {
        return fail(CONUS_ERROR_ARGUMENT, "data: NULL, voxels are needed");
    }
    if (voxels->type < CONUS_SCALAR_UINT8 || voxels->type > CONUS_SCALAR_FLOAT64) {
        return fail(CONUS_ERROR_ARGUMENT, "type: %d, allowed are CONUS_SCALAR_UINT8 (%d) to CONUS_SCALAR_FLOAT64 (%d)",
                    (int)voxels->type, CONUS_SCALAR_UINT8, CONUS_SCALAR_FLOAT64);
    }
    for (int axis = 0; axis < 3; axis++) {
        if (voxels->dim[axis] < 1 || voxels->dim[axis] > INT32_MAX) {
            return fail(CONUS_ERROR_ARGUMENT, "dim: %zu x %zu x %zu voxels, each is 1 to %d", voxels->dim[0],
                        voxels->dim[1], voxels->dim[2], INT32_MAX);
        }
    }
    return CONUS_OK;
}

static conus_status describe(struct volume_header *header, const conus_voxels *voxels)
{
    const int64_t dim[7] = {(int64_t)voxels->dim[0], (int64_t)voxels->dim[1], (int64_t)voxels->dim[2], 1, 1, 1, 1};
    header->info = (conus_volume_info){.slope = 1, .space_code = voxels->space_code};
    snprintf(header->info.format, sizeof header->info.format, "array");
    char words[sizeof header->info.transform] = "the caller's world_from_voxel";
    size_t used = strlen(words);
    if (voxels->space_code) { /* as of NIfTI: by these words a file of poses is matched */
        snprintf(words + used, sizeof words - used, ", code %d (%s)", voxels->space_code,
                 space_code_name(voxels->space_code));
    }
    conus_status status = volume_header_set_datatype(header, datatypes[voxels->type]);
    status = status ? status : volume_header_set_dim(header, dim);
    return status ? status : space_describe(&header->info, voxels->world_from_voxel, words);
}

/* The strides of voxels one after the other. */
static void set_dense_strides(ptrdiff_t out[3], const conus_voxels *voxels, size_t voxel_size)
{
    out[0] = (ptrdiff_t)voxel_size;
    out[1] = out[0] * (ptrdiff_t)voxels->dim[0];
    out[2] = out[1] * (ptrdiff_t)voxels->dim[1];
}

static bool is_dense(const conus_voxels *voxels, const ptrdiff_t dense[3])
{
    bool equal = true;
    for (int axis = 0; axis < 3; axis++) {
        equal = equal && (voxels->dim[axis] == 1 || voxels->stride[axis] == dense[axis]);
    }
    return equal || (!voxels->stride[0] && !voxels->stride[1] && !voxels->stride[2]);
}

static void copy_row(uint8_t *out, const uint8_t *in, ptrdiff_t stride, size_t count, size_t voxel_size)
{
    for (size_t i = 0; i < count; i++, out += voxel_size, in += stride) {
        memcpy(out, in, voxel_size);
    }
}

static void copy_voxels(uint8_t *out, const conus_voxels *voxels, size_t voxel_size)
{
    const uint8_t *data = voxels->data;
    for (size_t k = 0; k < voxels->dim[2]; k++) {
        for (size_t j = 0; j < voxels->dim[1]; j++, out += voxels->dim[0] * voxel_size) {
            const uint8_t *row = data + (ptrdiff_t)j * voxels->stride[1] + (ptrdiff_t)k * voxels->stride[2];
            copy_row(out, row, voxels->stride[0], voxels->dim[0], voxel_size);
        }
    }
}

static conus_status take_voxels(struct array_volume *array, const conus_voxels *voxels, size_t size)
{
    size_t voxel_size = volume_datatype_size(array->file.datatype);
    ptrdiff_t dense[3];
    set_dense_strides(dense, voxels, voxel_size);
    array->is_borrowed = is_dense(voxels, dense);
    array->file.voxels.size = size;
    if (array->is_borrowed) {
        array->file.voxels.data = (uint8_t *)voxels->data; /* only read */
        return CONUS_OK;
    }
    array->file.voxels.data = memory_raw(size, 1);
    if (!array->file.voxels.data) {
        return CONUS_ERROR_MEMORY;
    }
    copy_voxels(array->file.voxels.data, voxels, voxel_size);
    return CONUS_OK;
}

conus_status array_volume_open(struct array_volume *out, const conus_voxels *voxels)
{
    struct volume_header header = {0};
    struct array_volume array = {0};
    voxels = options_of(conus_voxels, voxels);
    const char *name = voxels->name ? voxels->name : "array";
    conus_status status = check_shape(voxels);
    status = status ? status : describe(&header, voxels);
    if (status) {
        return fail_in(status, name);
    }
    array.file.info = header.info;
    array.file.datatype = header.datatype;
    array.file.swapped = voxels->swapped;
    array.file.path = memory_text(name, strlen(name));
    array.file.info.path = array.file.path;
    status = array.file.path ? take_voxels(&array, voxels, header.volume_size) : CONUS_ERROR_MEMORY;
    if (status) {
        array_volume_finish(&array);
        return status;
    }
    file_sha256(array.file.info.sha256, &array.file.voxels);
    *out = array;
    return CONUS_OK;
}

void array_volume_finish(struct array_volume *array)
{
    if (array->is_borrowed) {
        array->file.voxels = (struct bytes){0};
    }
    volume_file_finish(&array->file);
    *array = (struct array_volume){0};
}
