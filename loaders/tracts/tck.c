/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads MRtrix's header, then its points block by block. */
#include "loaders/tracts/tract_formats.h"

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/streamline_list.h"
#include "loaders/tracts/tract_build.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct tck {
    struct byte_stream *stream;
    struct tract_build build;
    struct text type, file, count; /* values of the header; no data where they are missing */
    char type_name[16];
    bool swapped, wide; /* of the numbers; wide: double */
    bool has_count;
    uint64_t offset, stated;
    bool ended; /* the end's marker was read */
};

/* Keeps the values of the keys that are used, in the lines between the first and END; @p end: how many bytes they take.
 * A line without a colon goes on with the value before it, and is not kept. */
static conus_status take_lines(struct tck *tck, size_t *end)
{
    const struct {
        const char *key;
        struct text *value;
    } keys[] = {{"datatype", &tck->type}, {"file", &tck->file}, {"count", &tck->count}};
    struct text rest = {(const char *)tck->stream->data, tck->stream->size};
    struct text line;
    (void)text_line(&rest, &line);
    while (text_line(&rest, &line)) {
        if (text_equal(text_trim(line), "END") && rest.data > line.data + line.size) {
            *end = (size_t)(rest.data - (const char *)tck->stream->data);
            return CONUS_OK;
        }
        bool colon = true;
        struct text key = {0};
        (void)text_field(&line, ':', &colon, &key);
        for (size_t i = 0; colon && i < sizeof keys / sizeof keys[0]; i++) {
            if (!text_equal_ignoring_case(text_trim(key), keys[i].key)) {
                continue;
            }
            if (keys[i].value->data) {
                return fail(CONUS_ERROR_DATA, "%s: found twice, allowed is once", keys[i].key);
            }
            *keys[i].value = text_trim(line);
        }
    }
    return fail(CONUS_ERROR_DATA, "header: found no line END in the first %zu bytes", tck->stream->size);
}

static conus_status read_type(struct tck *tck)
{
    static const struct {
        const char *name;
        bool wide, big;
    } types[] = {
        {"Float32LE", false, false}, {"Float32BE", false, true}, {"Float64LE", true, false}, {"Float64BE", true, true}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (text_equal_ignoring_case(tck->type, types[i].name)) {
            tck->wide = types[i].wide;
            tck->swapped = types[i].big == BIG_ENDIAN_IS_SWAPPED;
            snprintf(tck->type_name, sizeof tck->type_name, "%s", types[i].name);
            return CONUS_OK;
        }
    }
    return fail(CONUS_ERROR_DATA, "datatype: found \"%.*s\", allowed are Float32LE, Float32BE, Float64LE and Float64BE",
                TEXT_SHOW(tck->type, 40));
}

/* "file: . 620": in this file, from that byte on. */
static conus_status tck_read_file(struct tck *tck, size_t header_size)
{
    struct text rest = tck->file;
    struct text name = {0};
    struct text number = {0};
    (void)text_word(&rest, &name);
    if (!text_equal(name, ".") || !text_word(&rest, &number) || !text_to_uint(number, UINT64_MAX, &tck->offset) ||
        text_trim(rest).size) {
        return fail(CONUS_ERROR_DATA, "file: found \"%.*s\", needed is \". OFFSET\"", TEXT_SHOW(tck->file, 40));
    }
    if (tck->offset < header_size) {
        return fail(CONUS_ERROR_DATA, "file: found offset %llu, the header ends at %zu",
                    (unsigned long long)tck->offset, header_size);
    }
    return CONUS_OK;
}

/* Goes to the first point. */
static conus_status go_to_points(struct tck *tck)
{
    struct byte_stream *stream = tck->stream;
    conus_status status = CONUS_OK;
    while (!status && stream->position < tck->offset) {
        status = byte_stream_need(stream, 1);
        uint64_t left = tck->offset - stream->position;
        if (!status && !stream->size) {
            return fail(CONUS_ERROR_DATA, "file: found offset %llu, the file has %llu bytes",
                        (unsigned long long)tck->offset, (unsigned long long)stream->position);
        }
        byte_stream_skip(stream, status ? 0 : left < stream->size ? (size_t)left : stream->size);
    }
    return status;
}

static conus_status tck_take_header(struct tck *tck)
{
    size_t size = 0;
    conus_status status;
    if ((status = byte_stream_need(tck->stream, BYTE_STREAM_BLOCK)) || (status = take_lines(tck, &size)) ||
        (status = read_type(tck)) || (status = tck_read_file(tck, size))) {
        return status;
    }
    tck->has_count = tck->count.data;
    if (tck->has_count && !text_to_uint(tck->count, UINT64_MAX, &tck->stated)) {
        return fail(CONUS_ERROR_DATA, "count: found \"%.*s\", needed is a whole number", TEXT_SHOW(tck->count, 40));
    }
    tck->type = tck->file = tck->count = (struct text){0}; /* they were in the block */
    return go_to_points(tck);
}

/* Takes a triple that is no point: the end of a streamline or of the file. */
static conus_status take_marker(struct tck *tck, const double p[3])
{
    const struct tractogram *t = &tck->build.tractogram;
    if (isnan(p[0]) && isnan(p[1]) && isnan(p[2])) {
        conus_status status = tract_build_streamline(&tck->build);
        if (!status) {
            tract_build_end_streamline(&tck->build);
        }
        return status;
    }
    if (!isinf(p[0]) || !isinf(p[1]) || !isinf(p[2])) {
        char text[3][TEXT_NUMBER_SIZE];
        return fail(CONUS_ERROR_DATA,
                    "point %llu of streamline %zu (both from 0): found (%s, %s, %s); three NaN end a streamline, three "
                    "infinities the file",
                    (unsigned long long)(t->point_count - t->first[t->streamline_count]), t->streamline_count,
                    text_number(text[0], p[0]), text_number(text[1], p[1]), text_number(text[2], p[2]));
    }
    if (t->point_count != t->first[t->streamline_count]) {
        return fail(CONUS_ERROR_DATA, "streamline %zu (from 0): the end of the file comes before its own (NaN NaN NaN)",
                    t->streamline_count);
    }
    tck->ended = true;
    return CONUS_OK;
}

/* Takes @p count points and markers, for which there is room, up to the end's; @p taken: how many. */
static inline conus_status take_triples(struct tck *tck, size_t count, size_t *taken, bool wide, bool swapped)
{
    struct tractogram *t = &tck->build.tractogram;
    const uint8_t *at = tck->stream->data;
    const size_t size = wide ? 8 : 4;
    conus_status status = CONUS_OK;
    size_t i;
    for (i = 0; !status && !tck->ended && i < count; i++, at += 3 * size) {
        double p[3];
        for (size_t a = 0; a < 3; a++) {
            p[a] = wide ? order_f64(at + a * size, swapped) : (double)order_f32(at + a * size, swapped);
        }
        if (vec3_is_finite(p)) {
            float *out = t->points + 3 * t->point_count;
            out[0] = (float)p[0], out[1] = (float)p[1], out[2] = (float)p[2];
            t->point_count++;
        } else {
            status = take_marker(tck, p);
        }
    }
    *taken = i;
    return status;
}

static conus_status take_block(struct tck *tck)
{
    const size_t size = tck->wide ? 24 : 12;
    conus_status status = byte_stream_need(tck->stream, size);
    if (status) {
        return status;
    }
    size_t count = tck->stream->size / size;
    if (!count) {
        return fail(CONUS_ERROR_DATA,
                    "streamline %zu (from 0): the file ends without the marker of its end (inf inf inf)",
                    tck->build.tractogram.streamline_count);
    }
    status = tract_build_points(&tck->build, count);
    if (status) {
        return status;
    }
    size_t taken = 0;
    if (tck->wide) { /* constants: the compiler makes a loop for each */
        status =
            tck->swapped ? take_triples(tck, count, &taken, true, true) : take_triples(tck, count, &taken, true, false);
    } else {
        status = tck->swapped ? take_triples(tck, count, &taken, false, true)
                              : take_triples(tck, count, &taken, false, false);
    }
    byte_stream_skip(tck->stream, taken * size);
    return status;
}

static conus_status tck_take_all(struct tck *tck)
{
    const size_t size = tck->wide ? 24 : 12;
    uint64_t most = tck->stream->is_packed ? 0 : byte_stream_most(tck->stream) / size;
    conus_status status = tract_build_expect(&tck->build, most, 0);
    while (!status && !tck->ended) {
        status = take_block(tck);
    }
    status = status ? status : byte_stream_need(tck->stream, 1);
    if (!status && tck->stream->size) {
        status = fail(CONUS_ERROR_DATA, "content: the file goes on after the marker of its end (inf inf inf)");
    }
    return status;
}

conus_status tck_read(struct tractogram *out, struct byte_stream *stream, uint64_t max_memory, struct notes *notes)
{
    struct tck tck = {.stream = stream, .build.max_memory = max_memory};
    conus_status status = tck_take_header(&tck);
    status = status ? status : tck_take_all(&tck);
    size_t found = tck.build.tractogram.streamline_count;
    if (!status && tck.has_count &&
        tck.stated != found) { /* as interrupted programs leave it; MRtrix does not trust it */
        status = notes_add(
            notes, "count: the header says %llu, the file has %zu streamlines and its end; all of them are used",
            (unsigned long long)tck.stated, found);
    }
    snprintf(tck.build.tractogram.format, sizeof tck.build.tractogram.format, "MRtrix %s%s", tck.type_name,
             stream->is_packed ? ", gzip" : "");
    status = status ? status : tract_build_take(out, &tck.build);
    tract_build_finish(&tck.build);
    return status;
}

enum { HEADER_SIZE = 128, POINT = 3 * sizeof(float) };

/* Gives the header's size, with what lies between it and the points, which begin at a multiple of 4. */
static size_t format_header(char out[HEADER_SIZE], size_t count)
{
    static const char form[] = "mrtrix tracks\ndatatype: Float32LE\ncount: %010zu\nfile: . %d\nEND\n";
    int size = snprintf(out, HEADER_SIZE, form, count, 99); /* 67 bytes: of two digits, too */
    int offset = (size + 3) / 4 * 4;
    memset(out, 0, HEADER_SIZE);
    (void)snprintf(out, HEADER_SIZE, form, count, offset);
    return (size_t)offset;
}

static uint8_t *put_point(uint8_t *at, const float point[3])
{
    for (int a = 0; a < 3; a++, at += sizeof *point) {
        order_put_f32(at, point[a]);
    }
    return at;
}

/* The bytes of a file with the streamlines of `list`, Float32LE. `out` is owned by the caller. */
static conus_status tck_format(struct bytes *out, const conus_streamline_list *list)
{
    const conus_streamline_list_view view = conus_streamline_list_data(list);
    char header[HEADER_SIZE];
    size_t begin = format_header(header, view.count);
    size_t lines = view.points + view.count + 1;
    float *points = memory_raw(view.points, POINT);
    uint64_t *first = memory_raw(view.count + 1, sizeof *first);
    uint8_t *data = points && first ? memory_raw(lines + (begin + POINT - 1) / POINT, POINT) : NULL;
    if (data) {
        static const float end_of_one[3] = {NAN, NAN, NAN};
        static const float end_of_all[3] = {INFINITY, INFINITY, INFINITY};
        uint8_t *at = data + begin;
        conus_streamline_list_points(points, first, list);
        memcpy(data, header, begin);
        for (size_t i = 0; i < view.count; i++) {
            for (uint64_t p = first[i]; p < first[i + 1]; p++) {
                at = put_point(at, points + 3 * p);
            }
            at = put_point(at, end_of_one);
        }
        (void)put_point(at, end_of_all);
        *out = (struct bytes){.data = data, .size = begin + lines * POINT};
    }
    memory_free(points);
    memory_free(first);
    return data ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status conus_streamline_list_write(const conus_streamline_list *list, const char *path)
{
    struct bytes file = {0};
    if (!path_ends_in(path, ".tck")) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the name of a tractogram that is written ends in .tck", path);
    }
    conus_status status = tck_format(&file, list);
    status = status ? status : file_write(path, file.data, file.size);
    bytes_finish(&file);
    return status;
}
