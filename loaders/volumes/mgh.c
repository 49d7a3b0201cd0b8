/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the MGH header. */
#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "loaders/volumes/parts.h"
#include "sources/source.h"

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

static void read_dim(struct job *job, struct volume_header *header, const uint8_t *data)
{
    static const char *const names[4] = {"width", "height", "depth", "nframes"};
    int64_t dim[7] = {1, 1, 1, 1, 1, 1, 1};
    for (size_t i = 0; i < 4; i++) {
        dim[i] = read_int(data, 4 + 4 * i);
        if (dim[i] < 1) {
            job_bad(job, "%s: found %lld, allowed is 1 or more", names[i], (long long)dim[i]);
        }
    }
    if (mgh_is_of_vertices(data, MGH_HEADER_SIZE)) {
        job_bad(job,
                "%lld x 1 x 1 values of the vertices of a surface, not a volume: labels of vertices are read from "
                ".annot and .label.gii (--labels)",
                (long long)dim[0]);
    }
    volume_header_set_dim(job, header, dim);
}

/* world = Mdc diag(delta) (voxel - dim / 2) + c_ras; Mdc is stored by columns. Without a good RAS flag FreeSurfer takes
 * coronal slices of 1 mm: i towards the left, j down, k to the front. */
static void read_placement(struct job *job, struct volume_header *header, const uint8_t *data)
{
    double delta[3] = {1, 1, 1};
    double columns[9] = {-1, 0, 0, 0, 0, -1, 0, 1, 0};
    double centre[3] = {0};
    bool good = order_i16(data + 28, BIG_ENDIAN_IS_SWAPPED) > 0;
    if (good) {
        mgh_read_floats(delta, 3, data + 30);
        mgh_read_floats(columns, 9, data + 42);
        mgh_read_floats(centre, 3, data + 78);
    } else {
        job_warn(job, "goodRASFlag is not set: FreeSurfer's default directions (LIA), 1 mm voxels and a grid centred "
                      "on the origin were used");
    }
    double world[16];
    mat4_identity(world);
    for (int i = 0; i < 3; i++) {
        if (!(delta[i] > 0) || !isfinite(delta[i])) {
            job_bad(job, "spacing %c: found %g, allowed are finite numbers above 0", "xyz"[i], delta[i]);
        }
        vec3_scale(world + 4 * i, columns + 3 * i, delta[i]);
    }
    double half[3] = {-(double)header->info.dim[0] / 2, -(double)header->info.dim[1] / 2,
                      -(double)header->info.dim[2] / 2};
    mat4_direction(half, world, half);
    vec3_add_scaled(world + 12, half, 1, centre);
    header->info.space_code = SPACE_SCANNER;
    (void)JOB_CALL(
        job, space_describe(&header->info, world, good ? "direction cosines and c_ras" : "none: FreeSurfer's default"));
}

static void mgh_open(struct job *job, struct volume_input *v)
{
    static const int types[] = {VOLUME_UINT8, VOLUME_INT32, 0, VOLUME_FLOAT32, VOLUME_INT16};
    const struct text head = v->source->head.bytes;
    const uint8_t *data = (const uint8_t *)head.data;
    if (head.size < MGH_HEADER_SIZE) {
        job_bad(job, "header: found %zu bytes, MGH needs %d", head.size, MGH_HEADER_SIZE);
        return;
    }
    v->header = (struct volume_header){
        .swapped = BIG_ENDIAN_IS_SWAPPED, .header_size = MGH_HEADER_SIZE, .offset = MGH_HEADER_SIZE, .info.slope = 1};
    v->run.skip = MGH_HEADER_SIZE;
    v->run.has_footer = true;
    snprintf(v->header.info.format, sizeof v->header.info.format, "MGH");
    const int type = read_int(data, 20);
    if (type < 0 || type >= (int)(sizeof types / sizeof types[0]) || !types[type]) {
        job_refuse(job, "type: found %d, allowed are 0 (uchar), 1 (int), 3 (float) and 4 (short)", type);
        return;
    }
    volume_header_set_datatype(job, &v->header, types[type]);
    read_dim(job, &v->header, data);
    read_placement(job, &v->header, data);
}

const struct volume_reader mgh_reader = {.is_partial = true, .open = mgh_open};
