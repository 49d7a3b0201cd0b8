/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads MRtrix's header, then its points block by block. */
#include "loaders/tracts/tract_formats.h"

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/packed.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "conus/streamlines.h"
#include "loaders/tracts/tracts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HEADER_LIMIT = 1 << 20 }; /* bytes in which a header ends */

/* Values of the header, in the block at hand; no data where they are missing. */
struct header {
    struct text type, file, count, space, unit;
    size_t size; /* bytes of the header */
};

struct tck {
    struct job *job;
    struct reader r;
    struct tract_build *build;
    const char *type;
    bool wide; /* numbers are doubles */
    bool has_count;
    uint64_t stated; /* streamlines */
    bool ended;      /* the end's marker was read */
};

/* Keeps the values of the keys that are used, in the lines between the first and END. A line without a colon goes on
 * with the value before it, and is not kept. */
static void take_lines(struct job *job, struct header *header, struct text block)
{
    const struct {
        const char *key;
        struct text *value;
    } keys[] = {{"datatype", &header->type}, {"file", &header->file}, {"count", &header->count},
                {"space", &header->space},   {"unit", &header->unit}, {"units", &header->unit}};
    struct text rest = block;
    struct text line;
    (void)text_line(&rest, &line);
    while (job_ok(job) && text_line(&rest, &line)) {
        if (text_equal(text_trim(line), "END") && rest.data > line.data + line.size) {
            header->size = (size_t)(rest.data - block.data);
            return;
        }
        bool colon = true;
        struct text key = {0};
        (void)text_field(&line, ':', &colon, &key);
        for (size_t i = 0; colon && i < sizeof keys / sizeof keys[0]; i++) {
            if (!text_equal_ignoring_case(text_trim(key), keys[i].key)) {
                continue;
            }
            if (keys[i].value->data) {
                job_bad(job, "%s: found twice, allowed is once", keys[i].key);
            }
            *keys[i].value = text_trim(line);
        }
    }
    job_bad(job, "header: found no line END in the first %zu bytes", block.size);
}

static void read_type(struct tck *tck, struct text type)
{
    static const struct type {
        const char *name;
        bool wide, big;
    } types[] = {
        {"Float32LE", false, false}, {"Float32BE", false, true}, {"Float64LE", true, false}, {"Float64BE", true, true}};
    const struct type *found = ROW_NAMED(types, type, false);
    if (!found) {
        job_bad(tck->job, "datatype: found \"%.*s\", allowed are Float32LE, Float32BE, Float64LE and Float64BE",
                TEXT_SHOW(type, 40));
        return;
    }
    tck->wide = found->wide;
    tck->r.swapped = found->big == BIG_ENDIAN_IS_SWAPPED;
    tck->type = found->name;
}

/* "file: . 620": in this file, from that byte on. */
static uint64_t read_offset(struct job *job, const struct header *header)
{
    struct text rest = header->file;
    struct text name = {0};
    struct text number = {0};
    uint64_t offset = 0;
    (void)text_word(&rest, &name);
    if (!text_equal(name, ".") || !text_word(&rest, &number) || !text_to_uint(number, UINT64_MAX, &offset) ||
        text_trim(rest).size) {
        job_bad(job, "file: found \"%.*s\", needed is \". OFFSET\"", TEXT_SHOW(header->file, 40));
    }
    if (offset < header->size) {
        job_bad(job, "file: found offset %llu, the header ends at %zu", (unsigned long long)offset, header->size);
    }
    return offset;
}

/* Whether a word is a code of axes other than RAS, a letter of each of LR, PA and IS, or one for voxels. */
static bool is_other_space(struct text word)
{
    static const char letters[] = "lrpais";
    unsigned found = 0;
    for (size_t i = 0; i < word.size; i++) {
        const char *at = strchr(letters, word.data[i] | 0x20);
        found |= at ? 1U << (at - letters) / 2 : 8;
    }
    return (word.size == 3 && found == 7 && !text_equal_ignoring_case(word, "ras")) ||
           text_is_one_of(word, "lpsmm/voxel/voxels/vox/voxmm/ijk", false);
}

/* Points of the format are in RAS mm. A name of a brain ("MNI152NLin6Asym", "scanner") says nothing else. */
static void check_said(struct job *job, const struct header *header)
{
    struct text rest = header->space;
    struct text word;
    bool is_other = false;
    while (text_token(&rest, &word)) {
        is_other = is_other || is_other_space(word);
    }
    bool is_mm = !header->unit.size || text_is_one_of(header->unit, TEXT_MM, false);
    if (is_other || !is_mm) {
        const struct text said = is_other ? header->space : header->unit;
        job_bad(job, "%s: found \"%.*s\", and MRtrix has points in RAS mm: one of them is wrong",
                is_other ? "space" : "units", TEXT_SHOW(said, 40));
    }
}

static void tck_take_header(struct tck *tck)
{
    struct header header = {0};
    (void)reader_has(&tck->r, HEADER_LIMIT);
    const struct text at_hand = {(const char *)tck->r.at, smaller_of((uint64_t)(tck->r.end - tck->r.at), HEADER_LIMIT)};
    take_lines(tck->job, &header, at_hand);
    check_said(tck->job, &header);
    read_type(tck, header.type);
    const uint64_t offset = read_offset(tck->job, &header);
    tck->has_count = header.count.data;
    if (tck->has_count && !text_to_uint(header.count, UINT64_MAX, &tck->stated)) {
        job_bad(tck->job, "count: found \"%.*s\", needed is a whole number", TEXT_SHOW(header.count, 40));
    }
    size_t size = 1;
    for (uint64_t left = offset; job_ok(tck->job) && left && size; left -= size) {
        (void)reader_some(&tck->r, left, 1, &size);
    }
    if (!size) {
        job_bad(tck->job, "file: found offset %llu, the file has %llu bytes", (unsigned long long)offset,
                (unsigned long long)reader_at(&tck->r));
    }
}

/* Takes a triple that is no point: the end of a streamline or of the file. */
static void take_marker(struct tck *tck, const double p[3])
{
    const struct tractogram *t = &tck->build->tractogram;
    if (isnan(p[0]) && isnan(p[1]) && isnan(p[2])) {
        if (tract_build_streamline(tck->build)) {
            tract_build_end_streamline(tck->build);
        }
        return;
    }
    const uint64_t count = t->point_count - t->first[t->streamline_count];
    if (!isinf(p[0]) || !isinf(p[1]) || !isinf(p[2])) {
        char text[3][TEXT_NUMBER_SIZE];
        job_bad(tck->job,
                "point %llu of streamline %zu (both from 0): found (%s, %s, %s); three NaN end a streamline, three "
                "infinities the file",
                (unsigned long long)count, t->streamline_count, text_number(text[0], p[0]), text_number(text[1], p[1]),
                text_number(text[2], p[2]));
    } else if (count) {
        job_bad(tck->job, "streamline %zu (from 0): the end of the file comes before its own (NaN NaN NaN)",
                t->streamline_count);
    }
    tck->ended = true;
}

/* Takes @p count points and markers, for which there is room, up to the end's, or to a failure. */
static inline void take_triples(struct tck *tck, size_t count, bool wide, bool swapped)
{
    struct tractogram *t = &tck->build->tractogram;
    const uint8_t *at = tck->r.at;
    const size_t size = wide ? 8 : 4;
    for (size_t i = 0; i < count && !tck->ended; i++, at += 3 * size) {
        double p[3];
        for (size_t a = 0; a < 3; a++) {
            p[a] = wide ? order_f64(at + a * size, swapped) : (double)order_f32(at + a * size, swapped);
        }
        if (vec3_is_finite(p)) {
            float *out = t->points + 3 * t->point_count;
            out[0] = (float)p[0], out[1] = (float)p[1], out[2] = (float)p[2];
            t->point_count++;
        } else {
            take_marker(tck, p);
            tck->ended = tck->ended || !job_ok(tck->job);
        }
    }
    tck->r.at = at;
}

static void take_block(struct tck *tck)
{
    const size_t size = tck->wide ? 24 : 12;
    if (!reader_has(&tck->r, size)) {
        job_bad(tck->job, "streamline %zu (from 0): the file ends without the marker of its end (inf inf inf)",
                tck->build->tractogram.streamline_count);
        return;
    }
    const size_t count = (size_t)(tck->r.end - tck->r.at) / size;
    const bool swapped = tck->r.swapped;
    if (!tract_build_points(tck->build, count)) {
        return;
    }
    if (tck->wide) { /* constants: the compiler makes a loop for each */
        swapped ? take_triples(tck, count, true, true) : take_triples(tck, count, true, false);
    } else {
        swapped ? take_triples(tck, count, false, true) : take_triples(tck, count, false, false);
    }
}

void tck_read(struct job *job, struct source *source, struct tract_build *build)
{
    struct tck tck = {.job = job, .r = source_reader(job, source), .build = build, .type = ""};
    struct tractogram *t = &build->tractogram;
    tck_take_header(&tck);
    tract_build_expect(build, source->is_packed ? 0 : reader_most(&tck.r) / (tck.wide ? 24 : 12), 0);
    while (job_ok(job) && !tck.ended) {
        take_block(&tck);
    }
    if (reader_has(&tck.r, 1)) {
        job_bad(job, "content: the file goes on after the marker of its end (inf inf inf)");
    }
    if (tck.has_count && tck.stated != t->streamline_count) { /* of an interrupted program; MRtrix does not trust it */
        job_note(job, "count: the header says %llu, the file has %zu streamlines and its end; all of them are used",
                 (unsigned long long)tck.stated, t->streamline_count);
    }
    tract_build_end(build);
    snprintf(t->format, sizeof t->format, "MRtrix %s%s", tck.type, source->is_packed ? ", gzip" : "");
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

/* The bytes of a file with the streamlines of `list`, Float32LE. */
static struct bytes tck_format(struct job *job, const conus_streamline_list *list)
{
    static const float end_of_one[3] = {NAN, NAN, NAN};
    static const float end_of_all[3] = {INFINITY, INFINITY, INFINITY};
    const conus_streamline_list_view view = conus_streamline_list_data(list);
    char header[HEADER_SIZE];
    const size_t begin = format_header(header, view.count);
    const size_t lines = view.points + view.count + 1;
    float *points = job_raw(job, view.points, POINT);
    uint64_t *first = job_raw(job, view.count + 1, sizeof *first);
    struct bytes out = {job_raw(job, lines + (begin + POINT - 1) / POINT, POINT), begin + lines * POINT};
    if (job_ok(job)) {
        uint8_t *at = out.data + begin;
        conus_streamline_list_points(points, first, list);
        memcpy(out.data, header, begin);
        for (size_t i = 0; i < view.count; i++) {
            for (uint64_t p = first[i]; p < first[i + 1]; p++) {
                at = put_point(at, points + 3 * p);
            }
            at = put_point(at, end_of_one);
        }
        (void)put_point(at, end_of_all);
    }
    return out;
}

conus_status conus_streamline_list_write(const conus_streamline_list *list, const char *path)
{
    struct job job = {0};
    if (!path_ends_in(path, ".tck")) {
        job_fail(&job, CONUS_ERROR_ARGUMENT, "%s: the name of a tractogram that is written ends in .tck", path);
    }
    const struct bytes file = tck_format(&job, list);
    (void)JOB_CALL(&job, file_write(path, file.data, file.size));
    return job_close(&job, NULL, NULL);
}
