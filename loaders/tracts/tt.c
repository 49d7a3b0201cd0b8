/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads DSI Studio's streamlines, variable by variable. */
#include "loaders/tracts/tract_formats.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/tracts/tract_build.h"

#include <stdio.h>

enum { HEADER_SIZE = 20, NAME_LIMIT = 64, RECORD_SIZE = 16, STEPS = 32 };

static const bool is_swapped = !BIG_ENDIAN_IS_SWAPPED; /* DSI Studio writes little-endian */

/* A variable of level 4: its header, then the name, then the numbers. */
struct variable {
    char name[NAME_LIMIT + 1];
    uint32_t type;  /* 0, 10, ... 50 */
    uint64_t count; /* numbers */
    size_t size;    /* bytes of each */
};

struct tt {
    struct byte_stream *stream;
    struct tract_build build;
    double world[16]; /* from voxels */
    bool has_world;
    float *clusters; /* [cluster_count] a number of each streamline; owned */
    size_t cluster_count;
    unsigned tracks; /* variables that had streamlines */
};

static conus_status tt_need(struct tt *tt, size_t size, const char *what)
{
    conus_status status = byte_stream_need(tt->stream, size);
    return status || tt->stream->size >= size ? status : fail(CONUS_ERROR_DATA, "%s: the file is cut off", what);
}

/* Bytes of a number; 0 for an unknown type. */
static size_t size_of_type(uint32_t type)
{
    static const size_t sizes[] = {8, 4, 4, 2, 2, 1}; /* double, float, int, short, unsigned short, byte */
    return type % 10 == 0 && type / 10 < sizeof sizes / sizeof sizes[0] ? sizes[type / 10] : 0;
}

static double tt_number_at(const uint8_t *data, uint32_t type)
{
    size_t size = size_of_type(type);
    bool is_signed = type == 20 || type == 30; /* int and short */
    return type <= 10 ? order_real(data, size, is_swapped) : (double)order_whole(data, size, is_signed, is_swapped);
}

static conus_status read_variable(struct variable *out, struct tt *tt)
{
    conus_status status = tt_need(tt, HEADER_SIZE, "variable");
    const uint8_t *data = tt->stream->data;
    if (status) {
        return status;
    }
    uint32_t length = order_u32(data + 16, is_swapped);
    out->type = order_u32(data, is_swapped);
    out->count = (uint64_t)order_u32(data + 4, is_swapped) * order_u32(data + 8, is_swapped);
    out->size = size_of_type(out->type);
    uint32_t imaginary = order_u32(data + 12, is_swapped);
    byte_stream_skip(tt->stream, HEADER_SIZE);
    if (length < 1 || length > NAME_LIMIT) {
        return fail(CONUS_ERROR_DATA, "variable: a name of %u bytes, allowed are 1 to %d", length, NAME_LIMIT);
    }
    status = tt_need(tt, length, "variable");
    if (status) {
        return status;
    }
    if (tt->stream->data[length - 1] || memchr(tt->stream->data, 0, length - 1)) {
        return fail(CONUS_ERROR_DATA, "variable: its name does not end with its %u bytes", length);
    }
    memcpy(out->name, tt->stream->data, length);
    byte_stream_skip(tt->stream, length);
    if (!out->size || imaginary) {
        return fail(CONUS_ERROR_DATA, "%s: of type %u, real numbers of the types 0, 10, 20, 30, 40 or 50 are needed",
                    out->name, out->type);
    }
    uint64_t most = byte_stream_most(tt->stream);
    return out->count <= most / out->size
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s: %llu numbers, the file has room for %llu", out->name,
                      (unsigned long long)out->count, (unsigned long long)(most / out->size));
}

static conus_status skip_variable(struct tt *tt, const struct variable *variable)
{
    conus_status status = CONUS_OK;
    for (uint64_t left = variable->count * variable->size; !status && left;) {
        status = tt_need(tt, 1, variable->name);
        size_t size = tt->stream->size < left ? tt->stream->size : (size_t)left;
        byte_stream_skip(tt->stream, status ? 0 : size);
        left -= size;
    }
    return status;
}

/* The file has the matrix row by row. */
static conus_status read_world(struct tt *tt, const struct variable *variable)
{
    if (variable->count != 16 || variable->type > 10) {
        return fail(CONUS_ERROR_DATA, "trans_to_mni: %llu numbers of type %u, 16 of type 0 or 10 are needed",
                    (unsigned long long)variable->count, variable->type);
    }
    conus_status status = tt_need(tt, 16 * variable->size, variable->name);
    if (status) {
        return status;
    }
    bool good = true;
    for (size_t i = 0; i < 16; i++) {
        double value = tt_number_at(tt->stream->data + i * variable->size, variable->type);
        tt->world[4 * (i % 4) + i / 4] = value;
        good = good && isfinite(value);
    }
    double inverse[16];
    if (!good || !mat4_settle_last_row(tt->world) || !mat4_invert_affine(inverse, tt->world)) {
        return fail(CONUS_ERROR_DATA, "trans_to_mni: found no affine, needed is one with an inverse, last row 0 0 0 1");
    }
    byte_stream_skip(tt->stream, 16 * variable->size);
    tt->has_world = true;
    return CONUS_OK;
}

static conus_status read_clusters(struct tt *tt, const struct variable *variable)
{
    if (tt->clusters || tt->tracks) {
        return fail(CONUS_ERROR_DATA, "cluster: twice, or behind track");
    }
    if (variable->count > tt->build.max_memory / sizeof *tt->clusters) {
        return fail(CONUS_ERROR_MEMORY, "cluster: %llu numbers, allowed are %llu bytes (--max-memory)",
                    (unsigned long long)variable->count, (unsigned long long)tt->build.max_memory);
    }
    tt->build.max_memory -= variable->count * sizeof *tt->clusters;
    tt->clusters = memory_raw((size_t)variable->count, sizeof *tt->clusters);
    conus_status status = tt->clusters ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (uint64_t i = 0; !status && i < variable->count; i++) {
        status = tt_need(tt, variable->size, variable->name);
        if (!status) {
            tt->clusters[tt->cluster_count++] = (float)tt_number_at(tt->stream->data, variable->type);
            byte_stream_skip(tt->stream, variable->size);
        }
    }
    return status || !variable->count ? status : tract_build_scalar(&tt->build, text_from(variable->name), false, 1);
}

static void add_point(struct tt *tt, const int64_t at[3])
{
    struct tractogram *tractogram = &tt->build.tractogram;
    float *out = tractogram->points + 3 * tractogram->point_count++;
    const double voxel[3] = {(double)at[0] / STEPS, (double)at[1] / STEPS, (double)at[2] / STEPS};
    double world[3];
    mat4_point(world, tt->world, voxel);
    for (int a = 0; a < 3; a++) {
        out[a] = (float)world[a];
    }
}

/* The points after the first, each a step of three bytes from the one before. */
static conus_status take_steps(struct tt *tt, int64_t at[3], size_t count)
{
    conus_status status = CONUS_OK;
    while (!status && count) {
        status = tt_need(tt, 3, "track");
        size_t some = tt->stream->size / 3 < count ? tt->stream->size / 3 : count;
        status = status ? status : tract_build_points(&tt->build, some);
        for (size_t i = 0; !status && i < some; i++) {
            for (size_t a = 0; a < 3; a++) {
                at[a] += (int8_t)tt->stream->data[3 * i + a];
            }
            add_point(tt, at);
        }
        byte_stream_skip(tt->stream, status ? 0 : 3 * some);
        count -= some;
    }
    return status;
}

/* Reads one streamline, whose variable has `left` more bytes. */
static conus_status tt_take_streamline(struct tt *tt, uint64_t *left)
{
    int64_t at[3];
    size_t number = tt->build.tractogram.streamline_count;
    conus_status status = *left < RECORD_SIZE ? fail(CONUS_ERROR_DATA, "track: ends within streamline %zu", number)
                                              : tt_need(tt, RECORD_SIZE, "track");
    if (status) {
        return status;
    }
    uint32_t count = order_u32(tt->stream->data, is_swapped);
    if (count < 3 || count % 3 || count - 3 > *left - RECORD_SIZE) {
        return fail(CONUS_ERROR_DATA,
                    "track: streamline %zu (from 0) has %u coordinates, needed are 3 of each point, %llu at most",
                    number, count, (unsigned long long)(*left - RECORD_SIZE + 3));
    }
    for (size_t a = 0; a < 3; a++) {
        at[a] = order_i32(tt->stream->data + 4 + 4 * a, is_swapped);
    }
    byte_stream_skip(tt->stream, RECORD_SIZE);
    status = tract_build_points(&tt->build, 1);
    if (!status) {
        add_point(tt, at);
        status = take_steps(tt, at, count / 3 - 1);
    }
    *left -= RECORD_SIZE + count - 3;
    if (status) {
        return status;
    }
    if (tt->cluster_count && number >= tt->cluster_count) {
        return fail(CONUS_ERROR_DATA, "cluster: %zu numbers, there are more streamlines", tt->cluster_count);
    }
    status = tract_build_streamline(&tt->build);
    if (status) {
        return status;
    }
    if (tt->cluster_count) {
        tt->build.tractogram.scalars[0].values[number] = tt->clusters[number];
    }
    tract_build_end_streamline(&tt->build);
    return CONUS_OK;
}

/* "track", then "track1", "track2" and so on. */
static conus_status read_tracks(struct tt *tt, const struct variable *variable)
{
    char wanted[NAME_LIMIT];
    snprintf(wanted, sizeof wanted, tt->tracks ? "track%u" : "track", tt->tracks);
    if (strcmp(variable->name, wanted) != 0 || variable->size != 1) {
        return fail(CONUS_ERROR_DATA, "%s: of %zu bytes each, needed is %s of bytes", variable->name, variable->size,
                    wanted);
    }
    if (!tt->has_world) {
        return fail(CONUS_ERROR_DATA, "trans_to_mni: missing before %s, nothing says where the streamlines are",
                    wanted);
    }
    tt->tracks++;
    conus_status status = CONUS_OK;
    for (uint64_t left = variable->count; !status && left;) {
        status = tt_take_streamline(tt, &left);
    }
    return status;
}

static conus_status tt_take_all(struct tt *tt)
{
    conus_status status = byte_stream_need(tt->stream, 1);
    while (!status && tt->stream->size) {
        struct variable variable = {0};
        status = read_variable(&variable, tt);
        status = status                                       ? status
                 : strcmp(variable.name, "trans_to_mni") == 0 ? read_world(tt, &variable)
                 : strcmp(variable.name, "cluster") == 0      ? read_clusters(tt, &variable)
                 : strncmp(variable.name, "track", 5) == 0    ? read_tracks(tt, &variable)
                                                              : skip_variable(tt, &variable);
        status = status ? status : byte_stream_need(tt->stream, 1);
    }
    if (status) {
        return status;
    }
    if (!tt->tracks) {
        return fail(CONUS_ERROR_DATA, "track: missing, so this is no tractogram of DSI Studio");
    }
    size_t streamlines = tt->build.tractogram.streamline_count;
    return !tt->cluster_count || tt->cluster_count == streamlines
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "cluster: %zu numbers, there are %zu streamlines", tt->cluster_count,
                      streamlines);
}

conus_status tt_read(struct tractogram *out, struct byte_stream *stream, uint64_t max_memory, struct notes *notes)
{
    struct tt tt = {.stream = stream, .build = {.max_memory = max_memory}};
    conus_status status = tt_take_all(&tt);
    status =
        status ? status : notes_add(notes, "trans_to_mni was used; the file does not say into which space it leads");
    status = status ? status : tract_build_take(out, &tt.build);
    if (!status) {
        snprintf(out->format, sizeof out->format, "DSI Studio%s", stream->is_packed ? ", gzip" : "");
    }
    tract_build_finish(&tt.build);
    memory_free(tt.clusters);
    return status;
}
