/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks AFNI's headers, by a table of their attributes. */
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "loaders/volumes/text/text_volume.h"

#include <stdio.h>
#include <string.h>

enum { VOLUME_LIMIT = 1 << 20 };

/* An attribute: its numbers or its string, the job's. */
struct value {
    const char *name;
    bool is_there, is_string;
    struct text text;
    LIST(double) numbers;
};

/* The attributes that are used. */
struct header {
    struct value dimensions, rank, types, factors, byte_order, orient, origin, delta, matrix, label_table, atlas_table,
        titles, scene, template;
};

#define AT(member) offsetof(struct header, member)
static const struct {
    const char *name;
    size_t place;
} rows[] = {
    {"DATASET_DIMENSIONS", AT(dimensions)},
    {"DATASET_RANK", AT(rank)},
    {"BRICK_TYPES", AT(types)},
    {"BRICK_FLOAT_FACS", AT(factors)},
    {"BYTEORDER_STRING", AT(byte_order)},
    {"ORIENT_SPECIFIC", AT(orient)},
    {"ORIGIN", AT(origin)},
    {"DELTA", AT(delta)},
    {"IJK_TO_DICOM_REAL", AT(matrix)},
    {"VALUE_LABEL_DTABLE", AT(label_table)},
    {"ATLAS_LABEL_TABLE", AT(atlas_table)},
    {"BRICK_LABS", AT(titles)},
    {"SCENE_DATA", AT(scene)},
    {"TEMPLATE_SPACE", AT(template)},
};
enum { ROWS = sizeof rows / sizeof rows[0] };

static struct value *afni_value_of(struct header *header, size_t row)
{
    return (struct value *)(void *)((char *)header + rows[row].place);
}

/* The value of the next line, which must be "NAME = value"; the job's. */
static struct text read_assignment(struct reader *r, const char *name, size_t *lines)
{
    struct text line = {0};
    struct text word;
    bool there = header_line(r, &line, lines);
    struct text tail = line;
    bool right = there && text_word(&tail, &word) && text_equal(word, name) && text_starts(text_trim(tail), "=");
    if (!right) {
        job_bad(r->job, "header: found the line \"%.*s\", needed is \"%s = ...\"", HEADER_SHOW(line), name);
        return (struct text){0};
    }
    tail = text_trim(tail);
    tail = text_trim((struct text){tail.data + 1, tail.size - 1});
    return job_text(r->job, tail);
}

static void skip_space(struct reader *r)
{
    while (reader_has(r, 1) && !text_trim((struct text){(const char *)r->at, 1}).size) {
        r->at++;
    }
}

/* Exactly `count` bytes behind an apostrophe. */
static void read_string(struct reader *r, struct value *out, size_t count, struct text name)
{
    skip_space(r);
    if (!reader_has(r, 1 + count) || *r->at != '\'') {
        job_bad(r->job, "%.*s: found no string of %zu characters", HEADER_SHOW(name), count);
        return;
    }
    reader_skip(r, 1);
    out->text = reader_keep(r, count);
}

/* `count` numbers, over several lines. */
static void afni_read_numbers(struct reader *r, struct value *out, size_t count, struct text name)
{
    struct text word;
    double number;
    while (job_ok(r->job) && out->numbers.count < count) {
        if (!reader_word(r, &word) || !text_to_double(word, &number)) {
            job_bad(r->job, "%.*s: found %zu numbers, its count is %zu", HEADER_SHOW(name), out->numbers.count, count);
            return;
        }
        *LIST_ADD(r->job, &out->numbers) = number;
    }
}

static void read_attribute(struct reader *r, struct header *header, size_t *lines)
{
    struct job *job = r->job;
    struct job_mark mark = job_mark(job);
    bool is_used = false;
    uint64_t count = 0;
    struct text type = read_assignment(r, "type", lines);
    struct text name = read_assignment(r, "name", lines);
    struct text counted = read_assignment(r, "count", lines);
    if (!text_to_uint(counted, HEADER_TEXT_LIMIT, &count)) {
        job_bad(job, "%.*s: count: found \"%.*s\", allowed are whole numbers", HEADER_SHOW(name), HEADER_SHOW(counted));
    }
    struct value value = {.is_there = true, .is_string = text_equal(type, "string-attribute")};
    if (value.is_string) {
        read_string(r, &value, (size_t)count, name);
    } else if (text_equal(type, "integer-attribute") || text_equal(type, "float-attribute")) {
        afni_read_numbers(r, &value, (size_t)count, name);
    } else {
        job_bad(job, "%.*s: type: found \"%.*s\", allowed are string-, integer- and float-attribute", HEADER_SHOW(name),
                HEADER_SHOW(type));
    }
    for (size_t i = 0; i < ROWS; i++) {
        struct value *slot = afni_value_of(header, i);
        if (!text_equal_ignoring_case(name, rows[i].name)) {
            continue;
        }
        if (slot->is_there) {
            job_bad(job, "%.*s: found twice, allowed is once", HEADER_SHOW(name));
        }
        value.name = slot->name;
        *slot = value;
        is_used = true;
    }
    if (!is_used) {
        job_release(job, mark);
    }
}

/* The first `count` numbers, of which there may be more. */
static const double *afni_take_numbers(struct job *job, size_t count, const struct value *value)
{
    if (!value->is_there || value->is_string || value->numbers.count < count) {
        job_bad(job, "%s: %s, %zu numbers are needed", value->name,
                value->is_there ? "found fewer or a string" : "missing", count);
    }
    return job_ok(job) ? value->numbers.at : NULL;
}

static void afni_take_whole(struct job *job, int64_t *out, size_t count, const struct value *value, int64_t least,
                            int64_t most)
{
    const double *numbers = afni_take_numbers(job, count, value);
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        if (!(numbers[i] >= (double)least && numbers[i] <= (double)most && numbers[i] == floor(numbers[i]))) {
            job_bad(job, "%s: found %g, allowed are whole numbers from %lld to %lld", value->name, numbers[i],
                    (long long)least, (long long)most);
            return;
        }
        out[i] = (int64_t)numbers[i];
    }
}

/* A string without the '~' that stands for its end. */
static struct text string_of(const struct value *value)
{
    struct text text = value->text;
    while (text.size && (text.data[text.size - 1] == '~' || text.data[text.size - 1] == '\0')) {
        text.size--;
    }
    return value->is_string ? text : (struct text){0};
}

static void read_sizes(struct job *job, struct text_volume *out, const struct header *header)
{
    int64_t rank[2] = {0};
    afni_take_whole(job, out->dim, 3, &header->dimensions, 1, INT32_MAX);
    afni_take_whole(job, rank, 2, &header->rank, 1, VOLUME_LIMIT);
    if (rank[0] != 3) {
        job_refuse(job, "DATASET_RANK: found %lld, allowed is 3", (long long)rank[0]);
    }
    out->count = rank[1];
}

static void read_type(struct job *job, struct text_volume *out, const struct header *header)
{
    static const struct text_type types[] = {{'u', 1}, {'i', 2}, {'i', 4}, {'f', 4}, {'f', 8}};
    const double *codes = afni_take_numbers(job, (size_t)out->count, &header->types);
    for (size_t i = 0; job_ok(job) && i < (size_t)out->count; i++) {
        if (codes[i] != 0 && codes[i] != 1 && codes[i] != 2 && codes[i] != 3 && codes[i] != 4) {
            job_refuse(job, "BRICK_TYPES: found %g, allowed are 0 (byte), 1 (short), 2 (int), 3 (float) and 4 (double)",
                       codes[i]);
        } else if (codes[i] != codes[0]) {
            job_refuse(job, "BRICK_TYPES: found %g and %g, allowed is one type", codes[0], codes[i]);
        }
    }
    if (!job_ok(job)) {
        return;
    }
    out->type = types[(size_t)codes[0]];
    struct text order = string_of(&header->byte_order);
    out->big_endian = text_equal(order, "MSB_FIRST");
    if (!out->big_endian && !text_equal(order, "LSB_FIRST") && (order.data || out->type.size > 1)) {
        job_bad(job, "BYTEORDER_STRING: found \"%.*s\", allowed are LSB_FIRST and MSB_FIRST", HEADER_SHOW(order));
    }
}

/* 0 means: not scaled. */
static void read_factors(struct job *job, struct text_volume *out, const struct header *header)
{
    size_t count = (size_t)out->count;
    if (!header->factors.is_there) {
        return;
    }
    const double *factors = afni_take_numbers(job, count, &header->factors);
    out->slopes = job_array(job, &count, sizeof *out->slopes);
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        if (!isfinite(factors[i])) {
            job_bad(job, "BRICK_FLOAT_FACS: found %g, allowed are finite numbers", factors[i]);
        }
        out->slopes[i] = factors[i] == 0 ? 1 : factors[i];
    }
}

/* ORIENT_SPECIFIC, ORIGIN and DELTA: axes along those of DICOM, LPS. Codes: R to L, L to R, P to A, A to P, I to S, S
 * to I; a step towards R, A or I is negative. */
static void read_plumb(struct job *job, double lps[16], const struct header *header)
{
    static const double signs[6] = {1, -1, -1, 1, 1, -1};
    int64_t codes[3] = {0};
    afni_take_whole(job, codes, 3, &header->orient, 0, 5);
    const double *origin = afni_take_numbers(job, 3, &header->origin);
    const double *delta = afni_take_numbers(job, 3, &header->delta);
    memset(lps, 0, 16 * sizeof *lps);
    lps[15] = 1;
    for (size_t i = 0; job_ok(job) && i < 3; i++) {
        size_t world = (size_t)codes[i] / 2;
        if (!(delta[i] * signs[codes[i]] > 0)) {
            job_bad(job, "DELTA: found %g, ORIENT_SPECIFIC %lld needs a step of the other sign", delta[i],
                    (long long)codes[i]);
        }
        lps[4 * i + world] = delta[i];
        lps[12 + world] = origin[i];
    }
}

/* The transform. IJK_TO_DICOM_REAL is the scanner's; the plumb axes are those that AFNI's own programs show oblique
 * data with. */
static void afni_place(struct job *job, struct text_volume *out, const struct header *header)
{
    static const double tolerance = 1;
    double plumb[16];
    double *lps = out->world_from_voxel;
    bool real = header->matrix.is_there;
    bool has_plumb = !real || (header->orient.is_there && header->origin.is_there && header->delta.is_there);
    mat4_identity(lps);
    snprintf(out->transform, sizeof out->transform, "%s",
             real ? "IJK_TO_DICOM_REAL" : "ORIENT_SPECIFIC, ORIGIN, DELTA");
    if (!real) {
        read_plumb(job, lps, header);
        header_turn_lps(lps);
        return;
    }
    if (has_plumb) {
        struct attempt attempt = job_try(job);
        read_plumb(job, plumb, header);
        const char *why = attempt_end(job, &attempt, ATTEMPT_TRY);
        has_plumb = !why;
        if (why) {
            job_note(job, "IJK_TO_DICOM_REAL was used; %s", why);
        }
    }
    const double *matrix = afni_take_numbers(job, 12, &header->matrix);
    for (size_t i = 0; job_ok(job) && i < 12; i++) {
        lps[4 * (i % 4) + i / 4] = matrix[i];
    }
    const size_t dim[3] = {(size_t)out->dim[0], (size_t)out->dim[1], (size_t)out->dim[2]};
    double gap = has_plumb ? space_corner_distance(dim, lps, plumb) : 0;
    header_turn_lps(lps);
    if (gap > tolerance) {
        job_note(
            job,
            "IJK_TO_DICOM_REAL was used; ORIENT_SPECIFIC, ORIGIN and DELTA, with which AFNI shows oblique data, put "
            "a corner of the grid %.1f mm away",
            gap);
    }
}

/* NIfTI's code of the space. */
static int read_space(struct job *job, const struct header *header)
{
    int64_t view = 0;
    struct text space = string_of(&header->template);
    bool mni = text_starts(space, "MNI");
    bool talairach = !space.data || text_starts(space, "TLRC") || text_starts(space, "TT");
    if (header->scene.is_there) {
        afni_take_whole(job, &view, 1, &header->scene, 0, INT32_MAX);
    }
    return view == 0 ? 1 : view == 1 ? 2 : mni ? 4 : talairach ? 3 : 5;
}

/* Names of the volumes, each ended by '~', and the table of labels: the atlas's, which is the richer one, if there are
 * two. */
static void read_names(struct job *job, struct text_volume *out, const struct header *header)
{
    struct text rest = string_of(&header->titles);
    struct text table = string_of(&header->atlas_table);
    struct text field;
    bool more = true;
    if (rest.size) {
        out->titles = job_zeroed(job, (size_t)out->count, sizeof *out->titles);
    }
    for (int64_t i = 0; out->titles && i < out->count && text_field(&rest, '~', &more, &field); i++) {
        out->titles[i] = job_name(job, field);
    }
    table = table.size ? table : string_of(&header->label_table);
    out->labels = table.size ? job_copy(job, table) : NULL;
}

void afni_parse(struct job *job, struct text_volume *out, struct reader r)
{
    struct header header = {0};
    size_t lines = 0;
    *out = (struct text_volume){.format = "AFNI", .brik = true};
    for (size_t i = 0; i < ROWS; i++) {
        afni_value_of(&header, i)->name = rows[i].name;
    }
    for (skip_space(&r); reader_has(&r, 1); skip_space(&r)) {
        read_attribute(&r, &header, &lines);
    }
    read_sizes(job, out, &header);
    read_type(job, out, &header);
    read_factors(job, out, &header);
    if (!job_ok(job)) {
        return;
    }
    afni_place(job, out, &header);
    out->space_code = read_space(job, &header);
    read_names(job, out, &header);
}
