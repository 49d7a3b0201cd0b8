/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads TrackVis's streamlines block by block. */
#include "loaders/tracts/trk.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "loaders/tracts/tract_build.h"
#include "loaders/tracts/trk_header.h"

#include <stdio.h>

struct trk {
    struct byte_stream *stream;
    struct trk_header header;
    struct tract_build build;
    size_t stride; /* bytes of a point with its scalars */
};

bool trk_is(const struct bytes *head, const char *path)
{
    static const char magic[] = "TRACK";
    (void)path;
    return head->size >= sizeof magic && memcmp(head->data, magic, sizeof magic - 1) == 0;
}

/* A name ends with its first NUL; one of several numbers has their count behind it, as "name\0003". */
static conus_status split_name(struct text *name, uint64_t *count, const uint8_t *field, const char *what)
{
    size_t length = strnlen((const char *)field, TRK_NAME_SIZE);
    size_t start = length < TRK_NAME_SIZE ? length + 1 : length;
    size_t end = start + strnlen((const char *)field + start, TRK_NAME_SIZE - start);
    const struct text digits = {(const char *)field + start, end - start};
    bool padded = true;
    for (size_t i = end; i < TRK_NAME_SIZE; i++) {
        padded = padded && !field[i];
    }
    *name = (struct text){(const char *)field, length};
    *count = 1;
    if (!padded || (digits.size && !(text_to_uint(digits, INT16_MAX, count) && *count))) {
        return fail(CONUS_ERROR_DATA, "%s: found other bytes after \"%.*s\", allowed is how many numbers it has", what,
                    (int)length, (const char *)field);
    }
    return CONUS_OK;
}

/* Adds the scalars that the header names; numbers without a name are called @p others, which is nibabel's word. */
static conus_status add_names(struct trk *trk, const struct trk_names *names, bool per_point)
{
    const char *what = per_point ? "scalar_name" : "property_name";
    uint64_t left = names->count;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && left && i < TRK_NAMES; i++) {
        struct text name = {0};
        uint64_t count = 0;
        const uint8_t *field = names->names + i * TRK_NAME_SIZE;
        status = field[0] ? split_name(&name, &count, field, what) : CONUS_OK;
        if (!status && count > left) {
            status = fail(CONUS_ERROR_DATA, "%s: the names have more numbers than the %u of %s", what, names->count,
                          per_point ? "n_scalars" : "n_properties");
        }
        if (!status && count) {
            status = tract_build_scalar(&trk->build, name, per_point, (uint32_t)count);
            left -= count;
        }
    }
    if (status || !left) {
        return status;
    }
    struct text others = text_from(per_point ? "scalars" : "properties");
    return tract_build_scalar(&trk->build, others, per_point, (uint32_t)left);
}

/* Brings @p size bytes to hand, or says of which streamline the file lacks them. */
static conus_status need(struct trk *trk, size_t size, const char *what)
{
    conus_status status = byte_stream_need(trk->stream, size);
    if (!status && trk->stream->size < size) {
        return fail(CONUS_ERROR_DATA, "streamline %zu (from 0): the file ends within its %s; n_count is %u",
                    trk->build.tractogram.streamline_count, what, trk->header.streamline_count);
    }
    return status;
}

static inline void place_points(float *out, const uint8_t *data, size_t count, size_t stride, const double world[16],
                                bool swapped)
{
    for (size_t i = 0; i < count; i++) {
        const uint8_t *at = data + i * stride;
        const double p[3] = {(double)order_f32(at, swapped), (double)order_f32(at + 4, swapped),
                             (double)order_f32(at + 8, swapped)};
        double q[3];
        mat4_point(q, world, p);
        for (size_t a = 0; a < 3; a++) {
            out[3 * i + a] = (float)q[a];
        }
    }
}

/* Copies the first @p components numbers of @p count rows, which are @p stride bytes apart. */
static void copy_numbers(float *out, uint32_t components, const uint8_t *data, size_t count, size_t stride,
                         bool swapped)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t c = 0; c < components; c++) {
            *out++ = order_f32(data + i * stride + 4 * c, swapped);
        }
    }
}

/* Takes the scalars of @p count points, or the properties of a streamline, from rows of @p stride bytes. */
static void take_scalars(struct trk *trk, const uint8_t *data, size_t count, size_t stride, bool per_point)
{
    struct tractogram *tractogram = &trk->build.tractogram;
    uint64_t from = per_point ? tractogram->point_count : tractogram->streamline_count;
    for (size_t s = 0; s < tractogram->scalar_count; s++) {
        const struct tract_scalar *scalar = &tractogram->scalars[s];
        if (scalar->per_point == per_point) {
            float *out = scalar->values + from * scalar->components;
            copy_numbers(out, scalar->components, data, count, stride, trk->header.swapped);
            data += 4 * (size_t)scalar->components;
        }
    }
}

/* Takes the points that are at hand, at most @p count, and one or more. */
static conus_status take_points(struct trk *trk, size_t count, size_t *taken)
{
    struct tractogram *tractogram = &trk->build.tractogram;
    conus_status status = need(trk, trk->stride, "points");
    *taken = trk->stream->size / trk->stride < count ? trk->stream->size / trk->stride : count;
    status = status ? status : tract_build_points(&trk->build, *taken);
    if (!status) {
        const uint8_t *data = trk->stream->data;
        float *out = tractogram->points + 3 * tractogram->point_count;
        if (trk->header.swapped) {
            place_points(out, data, *taken, trk->stride, trk->header.world, true);
        } else {
            place_points(out, data, *taken, trk->stride, trk->header.world, false);
        }
        take_scalars(trk, data + 12, *taken, trk->stride, true);
        tractogram->point_count += *taken;
        byte_stream_skip(trk->stream, *taken * trk->stride);
    }
    return status;
}

/* The streamline that begins at hand, with the number of its points. */
static conus_status take_streamline(struct trk *trk)
{
    conus_status status = need(trk, 4, "number of points");
    int32_t count = status ? 0 : order_i32(trk->stream->data, trk->header.swapped);
    size_t properties = 4 * (size_t)trk->header.properties.count;
    if (status) {
        return status;
    }
    byte_stream_skip(trk->stream, 4);
    uint64_t most = byte_stream_most(trk->stream) / trk->stride;
    if (count < 0 || (uint64_t)count > most) {
        return fail(CONUS_ERROR_DATA, "streamline %zu (from 0): found %d points, the file has room for 0 to %llu",
                    trk->build.tractogram.streamline_count, count, (unsigned long long)most);
    }
    for (size_t left = (size_t)count, taken = 0; !status && left; left -= taken) {
        status = take_points(trk, left, &taken);
    }
    status = status ? status : need(trk, properties, "properties");
    status = status ? status : tract_build_streamline(&trk->build);
    if (!status) {
        take_scalars(trk, trk->stream->data, 1, properties, false);
        byte_stream_skip(trk->stream, properties);
        tract_build_end_streamline(&trk->build);
    }
    return status;
}

/* Room for what a file that is not packed has: all bytes that are no counts and properties are points. */
static conus_status expect(struct trk *trk)
{
    uint64_t stated = trk->header.streamline_count;
    uint64_t bytes = byte_stream_most(trk->stream);
    uint64_t each = 4 + 4 * (uint64_t)trk->header.properties.count;
    if (stated > bytes / each) {
        return fail(CONUS_ERROR_DATA, "n_count: found %llu, the file has room for %llu at most",
                    (unsigned long long)stated, (unsigned long long)(bytes / each));
    }
    if (trk->stream->is_packed) {
        return tract_build_expect(&trk->build, 0, 0);
    }
    return tract_build_expect(&trk->build, (bytes - stated * each) / trk->stride, stated);
}

static conus_status take_all(struct trk *trk)
{
    const struct tractogram *tractogram = &trk->build.tractogram;
    uint32_t stated = trk->header.streamline_count;
    conus_status status = expect(trk);
    bool ends = false;
    while (!status && !ends && (!stated || tractogram->streamline_count < stated)) {
        status = byte_stream_need(trk->stream, 1);
        ends = !status && !stated && !trk->stream->size; /* 0 is no count: as many as there are */
        status = status || ends ? status : take_streamline(trk);
    }
    status = status ? status : byte_stream_need(trk->stream, 1);
    if (!status && trk->stream->size) {
        status = fail(CONUS_ERROR_DATA, "n_count: found %u, the file goes on after that many streamlines", stated);
    }
    return status;
}

static conus_status take_header(struct trk *trk, struct notes *notes)
{
    uint8_t header[TRK_HEADER_SIZE];
    conus_status status = byte_stream_need(trk->stream, TRK_HEADER_SIZE);
    if (!status && trk->stream->size < TRK_HEADER_SIZE) {
        return fail(CONUS_ERROR_DATA, "header: found %zu bytes, needed are %d", trk->stream->size, TRK_HEADER_SIZE);
    }
    if (!status) {
        memcpy(header, trk->stream->data, TRK_HEADER_SIZE);
        byte_stream_skip(trk->stream, TRK_HEADER_SIZE);
        status = trk_header_parse(&trk->header, header, notes);
    }
    trk->stride = 4 * (3 + (size_t)trk->header.scalars.count);
    status = status ? status : add_names(trk, &trk->header.scalars, true);
    return status ? status : add_names(trk, &trk->header.properties, false);
}

conus_status trk_read(struct tractogram *out, struct byte_stream *stream, uint64_t max_memory, struct notes *notes)
{
    struct trk trk = {.stream = stream, .build.max_memory = max_memory};
    conus_status status = take_header(&trk, notes);
    status = status ? status : take_all(&trk);
    if (!status && !trk.header.streamline_count && trk.build.tractogram.streamline_count) {
        status = notes_add(notes, "n_count: not stated, the file has %zu", trk.build.tractogram.streamline_count);
    }
    bool big = trk.header.swapped == BIG_ENDIAN_IS_SWAPPED;
    snprintf(trk.build.tractogram.format, sizeof trk.build.tractogram.format, "TrackVis %d%s%s", trk.header.version,
             stream->is_packed ? ", gzip" : "", big ? ", big-endian" : "");
    trk.build.tractogram.states_mm = trk.header.has_matrix;
    status = status ? status : tract_build_take(out, &trk.build);
    tract_build_finish(&trk.build);
    return status;
}
