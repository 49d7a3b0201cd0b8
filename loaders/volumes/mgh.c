/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the MGH header. */
#include "loaders/volumes/mgh.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/geometry/math3.h"

#include <stdio.h>

static int read_int(const uint8_t *data, size_t offset)
{
    return order_i32(data + offset, BIG_ENDIAN_IS_SWAPPED);
}

static void mgh_read_floats(double *out, size_t count, const uint8_t *data)
{
    for (size_t i = 0; i < count; i++) {
        out[i] = (double)order_f32(data + 4 * i, BIG_ENDIAN_IS_SWAPPED);
    }
}

static conus_status read_dim(struct volume_header *header, const uint8_t *data)
{
    static const char *const names[4] = {"width", "height", "depth", "nframes"};
    int64_t dim[7] = {1, 1, 1, 1, 1, 1, 1};
    for (size_t i = 0; i < 4; i++) {
        dim[i] = read_int(data, 4 + 4 * i);
        if (dim[i] < 1) {
            return fail(CONUS_ERROR_DATA, "%s: found %lld, allowed is 1 or more", names[i], (long long)dim[i]);
        }
    }
    if (mgh_is_of_vertices(data, MGH_HEADER_SIZE)) {
        return fail(CONUS_ERROR_DATA,
                    "%lld x 1 x 1 values of the vertices of a surface, not a volume: labels of vertices are read from "
                    ".annot and .label.gii (--labels)",
                    (long long)dim[0]);
    }
    return volume_header_set_dim(header, dim);
}

/* world = Mdc diag(delta) (voxel - dim / 2) + c_ras; Mdc is stored by columns. Without a good RAS flag FreeSurfer takes
 * coronal slices of 1 mm: i towards the left, j down, k to the front. */
static conus_status read_placement(struct volume_header *header, const uint8_t *data, struct notes *notes)
{
    double delta[3] = {1, 1, 1};
    double columns[9] = {-1, 0, 0, 0, 0, -1, 0, 1, 0};
    double centre[3] = {0};
    bool good = order_i16(data + 28, BIG_ENDIAN_IS_SWAPPED) > 0;
    if (good) {
        mgh_read_floats(delta, 3, data + 30);
        mgh_read_floats(columns, 9, data + 42);
        mgh_read_floats(centre, 3, data + 78);
    } else if (notes_warn(
                   notes,
                   "goodRASFlag is not set: FreeSurfer's default directions (LIA), 1 mm voxels and a grid centred "
                   "on the origin were used")) {
        return CONUS_ERROR_MEMORY;
    }
    double world[16];
    mat4_identity(world);
    for (int i = 0; i < 3; i++) {
        if (!(delta[i] > 0) || !isfinite(delta[i])) {
            return fail(CONUS_ERROR_DATA, "spacing %c: found %g, allowed are finite numbers above 0", "xyz"[i],
                        delta[i]);
        }
        vec3_scale(world + 4 * i, columns + 3 * i, delta[i]);
    }
    double half[3] = {-(double)header->info.dim[0] / 2, -(double)header->info.dim[1] / 2,
                      -(double)header->info.dim[2] / 2};
    mat4_direction(half, world, half);
    vec3_add_scaled(world + 12, half, 1, centre);
    header->info.space_code = SPACE_SCANNER;
    return space_describe(&header->info, world, good ? "direction cosines and c_ras" : "none: FreeSurfer's default");
}

conus_status mgh_header_parse(struct volume_header *out, const uint8_t *data, size_t size, struct notes *notes)
{
    if (size < MGH_HEADER_SIZE) {
        return fail(CONUS_ERROR_DATA, "header: found %zu bytes, MGH needs %d", size, MGH_HEADER_SIZE);
    }
    if (read_int(data, 0) != 1) {
        return fail(CONUS_ERROR_DATA, "version: found %d, allowed is 1", read_int(data, 0));
    }
    struct volume_header header = {
        .swapped = BIG_ENDIAN_IS_SWAPPED, .footer = true, .header_size = MGH_HEADER_SIZE, .offset = MGH_HEADER_SIZE};
    header.info.slope = 1;
    snprintf(header.info.format, sizeof header.info.format, "MGH");
    static const int types[] = {VOLUME_UINT8, VOLUME_INT32, 0, VOLUME_FLOAT32, VOLUME_INT16};
    int type = read_int(data, 20);
    if (type < 0 || type >= (int)(sizeof types / sizeof types[0]) || !types[type]) {
        return fail(CONUS_ERROR_UNSUPPORTED, "type: found %d, allowed are 0 (uchar), 1 (int), 3 (float) and 4 (short)",
                    type);
    }
    conus_status status;
    if ((status = volume_header_set_datatype(&header, types[type])) || (status = read_dim(&header, data)) ||
        (status = read_placement(&header, data, notes))) {
        return status;
    }
    *out = header;
    return CONUS_OK;
}
