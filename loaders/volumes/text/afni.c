/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks AFNI's headers, by a table of their attributes. */
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/volumes/text/header_text.h"
#include "loaders/volumes/text/text_volume.h"

#include <stdio.h>
#include <string.h>

enum { VOLUME_LIMIT = 1 << 20 };

/* An attribute: the text of its numbers, or its string, and how many of them it says it has. */
struct value {
    const char *name;
    struct text text; /* data is NULL where it is missing */
    size_t count;
    bool is_string;
};

/* The attributes that are used. */
struct header {
    struct value dimensions, rank, types, factors, byte_order, orient, origin, delta, matrix, label_table, atlas_table,
        titles, scene, template;
    size_t volumes;
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

/* The value of the next line, which must be "NAME = value". */
static conus_status read_assignment(struct text *value, struct text *rest, const char *name, size_t *lines)
{
    struct text line = {0};
    struct text word;
    conus_status status = CONUS_OK;
    bool there = header_line(rest, &line, lines, &status);
    struct text tail = line;
    bool right = there && text_word(&tail, &word) && text_equal(word, name) && text_starts(text_trim(tail), "=");
    if (status || !right) {
        return status ? status
                      : fail(CONUS_ERROR_DATA, "header: found the line \"%.*s\", needed is \"%s = ...\"",
                             HEADER_SHOW(line), name);
    }
    tail = text_trim(tail);
    *value = text_trim((struct text){tail.data + 1, tail.size - 1});
    return CONUS_OK;
}

/* Exactly `count` bytes behind an apostrophe. */
static conus_status read_string(struct value *out, struct text *rest, size_t count, struct text name)
{
    *rest = text_trim(*rest);
    if (!rest->size || rest->data[0] != '\'' || rest->size - 1 < count) {
        return fail(CONUS_ERROR_DATA, "%.*s: found no string of %zu characters", HEADER_SHOW(name), count);
    }
    *out = (struct value){.text = {rest->data + 1, count}, .count = count, .is_string = true};
    *rest = (struct text){rest->data + 1 + count, rest->size - 1 - count};
    return CONUS_OK;
}

/* `count` numbers, over several lines. */
static conus_status afni_read_numbers(struct value *out, struct text *rest, size_t count, struct text name)
{
    struct text word;
    *out = (struct value){.text = {rest->data, 0}, .count = count};
    for (size_t i = 0; i < count; i++) {
        double number;
        if (!text_word(rest, &word) || !text_to_double(word, &number)) {
            return fail(CONUS_ERROR_DATA, "%.*s: found %zu numbers, its count is %zu", HEADER_SHOW(name), i, count);
        }
        out->text.size = (size_t)(word.data + word.size - out->text.data);
    }
    return CONUS_OK;
}

static conus_status read_attribute(struct header *header, struct text *rest, size_t *lines)
{
    struct text type;
    struct text name;
    struct text counted;
    struct value value;
    uint64_t count = 0;
    conus_status status = read_assignment(&type, rest, "type", lines);
    status = status ? status : read_assignment(&name, rest, "name", lines);
    status = status ? status : read_assignment(&counted, rest, "count", lines);
    if (!status && !text_to_uint(counted, HEADER_TEXT_LIMIT, &count)) {
        return fail(CONUS_ERROR_DATA, "%.*s: count: found \"%.*s\", allowed are whole numbers", HEADER_SHOW(name),
                    HEADER_SHOW(counted));
    }
    bool string = !status && text_equal(type, "string-attribute");
    if (!status && !string && !text_equal(type, "integer-attribute") && !text_equal(type, "float-attribute")) {
        return fail(CONUS_ERROR_DATA, "%.*s: type: found \"%.*s\", allowed are string-, integer- and float-attribute",
                    HEADER_SHOW(name), HEADER_SHOW(type));
    }
    if (!status) {
        status = (string ? read_string : afni_read_numbers)(&value, rest, (size_t)count, name);
    }
    for (size_t i = 0; !status && i < ROWS; i++) {
        if (text_equal_ignoring_case(name, rows[i].name)) {
            struct value *slot = afni_value_of(header, i);
            value.name = slot->name;
            status = header_once(&slot->text, value.text, name);
            *slot = status ? *slot : value;
        }
    }
    return status;
}

/* The first `count` numbers; more may follow. */
static conus_status afni_take_numbers(double *out, size_t count, const struct value *value)
{
    struct text rest = value->text;
    struct text word;
    if (!value->text.data || value->is_string || value->count < count) {
        return fail(CONUS_ERROR_DATA, "%s: %s, %zu numbers are needed", value->name,
                    value->text.data ? "found fewer or a string" : "missing", count);
    }
    for (size_t i = 0; i < count && text_word(&rest, &word); i++) {
        (void)text_to_double(word, &out[i]); /* it did so before */
    }
    return CONUS_OK;
}

static conus_status afni_take_whole(int64_t *out, size_t count, const struct value *value, int64_t least, int64_t most)
{
    double numbers[8] = {0};
    conus_status status = afni_take_numbers(numbers, count, value);
    for (size_t i = 0; !status && i < count; i++) {
        if (!(numbers[i] >= (double)least && numbers[i] <= (double)most && numbers[i] == floor(numbers[i]))) {
            return fail(CONUS_ERROR_DATA, "%s: found %g, allowed are whole numbers from %lld to %lld", value->name,
                        numbers[i], (long long)least, (long long)most);
        }
        out[i] = (int64_t)numbers[i];
    }
    return status;
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

static conus_status read_sizes(struct text_volume *out, struct header *header)
{
    int64_t rank[2] = {0};
    conus_status status = afni_take_whole(out->dim, 3, &header->dimensions, 1, INT32_MAX);
    status = status ? status : afni_take_whole(rank, 2, &header->rank, 1, VOLUME_LIMIT);
    if (!status && rank[0] != 3) {
        return fail(CONUS_ERROR_UNSUPPORTED, "DATASET_RANK: found %lld, allowed is 3", (long long)rank[0]);
    }
    out->count = rank[1];
    header->volumes = (size_t)rank[1];
    return status;
}

/* Type and byte order. */
static conus_status read_type(struct text_volume *out, const struct header *header)
{
    static const struct text_type types[] = {{'u', 1}, {'i', 2}, {'i', 4}, {'f', 4}, {'f', 8}};
    double *codes = memory_zeroed(header->volumes, sizeof *codes);
    conus_status status = codes ? afni_take_numbers(codes, header->volumes, &header->types) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < header->volumes; i++) {
        if (codes[i] != 0 && codes[i] != 1 && codes[i] != 2 && codes[i] != 3 && codes[i] != 4) {
            status = fail(CONUS_ERROR_UNSUPPORTED,
                          "BRICK_TYPES: found %g, allowed are 0 (byte), 1 (short), 2 (int), 3 (float) and 4 (double)",
                          codes[i]);
        } else if (codes[i] != codes[0]) {
            status =
                fail(CONUS_ERROR_UNSUPPORTED, "BRICK_TYPES: found %g and %g, allowed is one type", codes[0], codes[i]);
        }
    }
    if (!status) {
        out->type = types[(size_t)codes[0]];
    }
    memory_free(codes);
    if (status) {
        return status;
    }
    struct text order = string_of(&header->byte_order);
    out->big_endian = text_equal(order, "MSB_FIRST");
    return out->big_endian || text_equal(order, "LSB_FIRST") || (!order.data && out->type.size == 1)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "BYTEORDER_STRING: found \"%.*s\", allowed are LSB_FIRST and MSB_FIRST",
                      HEADER_SHOW(order));
}

/* 0 means: not scaled. */
static conus_status read_factors(struct text_volume *out, const struct header *header)
{
    if (!header->factors.text.data) {
        return CONUS_OK;
    }
    out->slopes = memory_zeroed(header->volumes, sizeof *out->slopes);
    conus_status status =
        out->slopes ? afni_take_numbers(out->slopes, header->volumes, &header->factors) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < header->volumes; i++) {
        if (!isfinite(out->slopes[i])) {
            return fail(CONUS_ERROR_DATA, "BRICK_FLOAT_FACS: found %g, allowed are finite numbers", out->slopes[i]);
        }
        out->slopes[i] = out->slopes[i] == 0 ? 1 : out->slopes[i];
    }
    return status;
}

/* ORIENT_SPECIFIC, ORIGIN and DELTA: axes along those of DICOM, LPS. Codes: R to L, L to R, P to A, A to P, I to S, S
 * to I; a step towards R, A or I is negative. */
static conus_status read_plumb(double lps[16], const struct header *header)
{
    static const double signs[6] = {1, -1, -1, 1, 1, -1};
    int64_t codes[3];
    double origin[3];
    double delta[3];
    conus_status status = afni_take_whole(codes, 3, &header->orient, 0, 5);
    status = status ? status : afni_take_numbers(origin, 3, &header->origin);
    status = status ? status : afni_take_numbers(delta, 3, &header->delta);
    if (status) {
        return status;
    }
    memset(lps, 0, 16 * sizeof *lps);
    lps[15] = 1;
    for (size_t i = 0; i < 3; i++) {
        size_t world = (size_t)codes[i] / 2;
        if (!(delta[i] * signs[codes[i]] > 0)) {
            return fail(CONUS_ERROR_DATA, "DELTA: found %g, ORIENT_SPECIFIC %lld needs a step of the other sign",
                        delta[i], (long long)codes[i]);
        }
        lps[4 * i + world] = delta[i];
        lps[12 + world] = origin[i];
    }
    return CONUS_OK;
}

/* Transform and space. IJK_TO_DICOM_REAL is the scanner's; the plumb axes are those that AFNI's own programs show
 * oblique data with. */
static conus_status afni_place(struct text_volume *out, const struct header *header, struct notes *notes)
{
    static const double tolerance = 1;
    double matrix[12] = {0};
    double plumb[16];
    bool real = header->matrix.text.data;
    bool has_plumb = !real || (header->orient.text.data && header->origin.text.data && header->delta.text.data);
    conus_status status = has_plumb ? read_plumb(plumb, header) : CONUS_OK;
    if (real && status) {
        has_plumb = false;
        status = notes_warn(notes, "IJK_TO_DICOM_REAL was used; %s", conus_message());
    }
    if (real && !status) {
        status = afni_take_numbers(matrix, 12, &header->matrix);
    }
    if (status) {
        return status;
    }
    double *lps = out->world_from_voxel;
    const size_t dim[3] = {(size_t)out->dim[0], (size_t)out->dim[1], (size_t)out->dim[2]};
    mat4_identity(lps);
    for (size_t i = 0; i < 12; i++) {
        size_t at = 4 * (i % 4) + i / 4;
        lps[at] = real ? matrix[i] : plumb[at];
    }
    double gap = !has_plumb ? 0 : space_corner_distance(dim, lps, plumb);
    header_turn_lps(out->world_from_voxel);
    snprintf(out->transform, sizeof out->transform, "%s",
             real ? "IJK_TO_DICOM_REAL" : "ORIENT_SPECIFIC, ORIGIN, DELTA");
    if (gap > tolerance && notes_warn(notes,
                                      "IJK_TO_DICOM_REAL was used; ORIENT_SPECIFIC, ORIGIN and DELTA, with which AFNI "
                                      "shows oblique data, put a corner of the grid %.1f mm away",
                                      gap)) {
        return CONUS_ERROR_MEMORY;
    }
    int64_t view = 0;
    struct text space = string_of(&header->template);
    bool mni = text_starts(space, "MNI");
    bool talairach = !space.data || text_starts(space, "TLRC") || text_starts(space, "TT");
    status = header->scene.text.data ? afni_take_whole(&view, 1, &header->scene, 0, INT32_MAX) : CONUS_OK;
    out->space_code = view == 0 ? 1 : view == 1 ? 2 : mni ? 4 : talairach ? 3 : 5; /* NIfTI's */
    return status;
}

/* Names of the volumes, each ended by '~', and the table of labels: the atlas's, which is the richer one, if there are
 * two. */
static conus_status read_names(struct text_volume *out, const struct header *header)
{
    struct text rest = string_of(&header->titles);
    struct text field;
    bool more = true;
    out->titles = rest.size ? memory_zeroed(header->volumes, sizeof *out->titles) : NULL;
    conus_status status = !rest.size || out->titles ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; out->titles && !status && i < header->volumes && text_field(&rest, '~', &more, &field); i++) {
        status = label_set_text(&out->titles[i], field);
    }
    if (status) {
        return status;
    }
    struct text table = string_of(&header->atlas_table);
    table = table.size ? table : string_of(&header->label_table);
    out->labels = table.size ? memory_text(table.data, table.size) : NULL;
    return table.size && !out->labels ? CONUS_ERROR_MEMORY : CONUS_OK;
}

conus_status afni_parse(struct text_volume *out, const uint8_t *data, size_t size, struct notes *notes)
{
    struct header header = {0};
    struct text rest = text_trim((struct text){(const char *)data, size});
    struct text_volume volume = {.format = "AFNI", .brik = true, .header_size = size};
    size_t lines = 0;
    conus_status status = size < HEADER_TEXT_LIMIT
                              ? CONUS_OK
                              : fail(CONUS_ERROR_DATA, "header: found %zu bytes or more, allowed are fewer", size);
    for (size_t i = 0; i < ROWS; i++) {
        afni_value_of(&header, i)->name = rows[i].name;
    }
    while (!status && rest.size) {
        status = read_attribute(&header, &rest, &lines);
        rest = text_trim(rest);
    }
    status = status ? status : read_sizes(&volume, &header);
    status = status ? status : read_type(&volume, &header);
    status = status ? status : read_factors(&volume, &header);
    status = status ? status : afni_place(&volume, &header, notes);
    status = status ? status : read_names(&volume, &header);
    if (status) {
        text_volume_finish(&volume);
    } else {
        *out = volume;
    }
    return status;
}
