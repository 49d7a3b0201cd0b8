/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/pose_list.h"

#include "base/file.h"
#include "base/math3.h"
#include "base/memory.h"
#include "selection/cone.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_COLUMNS = 64, MATRIX_NUMBERS = 16, FILE_LIMIT = 1 << 30 };

/* The columns that a row may have; m00..m33 are row-major. */
enum column {
    X,
    Y,
    Z,
    TX,
    TY,
    TZ,
    DX,
    DY,
    DZ,
    QW,
    QX,
    QY,
    QZ,
    M00,
    M33 = M00 + 15,
    UX,
    UY,
    UZ,
    ANGLE,
    TIME,
    ID,
    COLUMNS
};

static const char *const names[COLUMNS] = {"x",   "y",   "z",   "tx",  "ty",  "tz",    "dx",     "dy",      "dz",
                                           "qw",  "qx",  "qy",  "qz",  "m00", "m01",   "m02",    "m03",     "m10",
                                           "m11", "m12", "m13", "m20", "m21", "m22",   "m23",    "m30",     "m31",
                                           "m32", "m33", "ux",  "uy",  "uz",  "angle", "time_s", "query_id"};

struct header {
    char separator;
    enum column of_field[MAX_COLUMNS];
    size_t field_count;
    bool has[COLUMNS];
};

void conus_pose_list_destroy(conus_pose_list *list)
{
    if (!list) {
        return;
    }
    for (size_t i = 0; i < list->count; i++) {
        memory_free((char *)list->rows[i].id);
        memory_free((char *)list->rows[i].error);
    }
    memory_free(list->rows);
    memory_free(list);
}

static conus_status append_row(conus_pose_list *list, const conus_pose_row *row, struct text id, const char *error)
{
    if (list->count == list->capacity) {
        size_t capacity = list->capacity ? 2 * list->capacity : 16;
        conus_pose_row *rows = memory_resize(list->rows, capacity, sizeof *rows);
        if (!rows) {
            return CONUS_ERROR_MEMORY;
        }
        list->rows = rows;
        list->capacity = capacity;
    }
    conus_pose_row copy = *row;
    char ordinal[24];
    snprintf(ordinal, sizeof ordinal, "%zu", list->count + 1);
    id = id.size ? id : text_from(ordinal);
    copy.id = memory_text(id.data, id.size);
    copy.error = error ? memory_text(error, text_from(error).size) : NULL;
    if (!copy.id || (error && !copy.error)) {
        memory_free((char *)copy.id);
        return CONUS_ERROR_MEMORY;
    }
    list->rows[list->count++] = copy;
    return CONUS_OK;
}

static bool has_all(const struct header *header, enum column first, size_t count)
{
    bool all = true;
    for (size_t i = 0; i < count; i++) {
        all = all && header->has[first + i];
    }
    return all;
}

static bool has_any(const struct header *header, enum column first, size_t count)
{
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        any = any || header->has[first + i];
    }
    return any;
}

/* One way of saying where the device looks, and only one, each with all its columns. */
static conus_status check_header(const struct header *header)
{
    static const struct {
        enum column first;
        size_t count;
        const char *names;
    } groups[] = {{TX, 3, "tx ty tz"}, {DX, 3, "dx dy dz"}, {QW, 4, "qw qx qy qz"}, {M00, 16, "m00...m33"}};
    size_t directions = 0;
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; i++) {
        bool some = has_any(header, groups[i].first, groups[i].count);
        if (some && !has_all(header, groups[i].first, groups[i].count)) {
            return fail(CONUS_ERROR_DATA, "header: only some of the columns %s", groups[i].names);
        }
        directions += some;
    }
    if (directions != 1) {
        return fail(CONUS_ERROR_DATA,
                    "header: %zu ways of giving the direction, exactly one of tx ty tz, dx dy dz, qw "
                    "qx qy qz, m00...m33 is needed",
                    directions);
    }
    if (header->has[M00] ? has_any(header, X, 3) : !has_all(header, X, 3)) {
        return fail(CONUS_ERROR_DATA, "header: x y z are needed, and only, without m00...m33");
    }
    bool up_fits = header->has[TX] || header->has[DX];
    if (has_any(header, UX, 3) && !(has_all(header, UX, 3) && up_fits)) {
        return fail(CONUS_ERROR_DATA, "header: ux uy uz go together, with tx ty tz or dx dy dz");
    }
    return CONUS_OK;
}

static conus_status add_column(struct header *header, struct text field)
{
    enum column column = 0;
    while (column < COLUMNS && !text_equal_ignoring_case(text_trim(field), names[column])) {
        column++;
    }
    if (column == COLUMNS) {
        return fail(CONUS_ERROR_DATA,
                    "header: column \"%.*s\" is not known (x y z, tx ty tz, dx dy dz, qw qx qy qz, "
                    "m00...m33, ux uy uz, angle, time_s, query_id)",
                    (int)(field.size < 40 ? field.size : 40), field.data);
    }
    if (header->has[column] || header->field_count == MAX_COLUMNS) {
        return fail(CONUS_ERROR_DATA, "header: column \"%s\" twice", names[column]);
    }
    header->has[column] = true;
    header->of_field[header->field_count++] = column;
    return CONUS_OK;
}

static conus_status read_header(struct header *out, struct text line)
{
    struct header header = {.separator = memchr(line.data, '\t', line.size) ? '\t' : ','};
    struct text field;
    for (bool more = true; text_field(&line, header.separator, &more, &field);) {
        conus_status status = add_column(&header, field);
        if (status) {
            return status;
        }
    }
    conus_status status = check_header(&header);
    *out = status ? *out : header;
    return status;
}

/* LPS to RAS and back: x and y change sign. */
static void flip_point(double p[3])
{
    p[0] = 0 - p[0];
    p[1] = 0 - p[1];
}

static void flip_matrix(double m[16])
{
    for (int column = 0; column < 4; column++) {
        flip_point(m + 4 * column);
    }
}

static conus_status pose_from_values(conus_pose *out, const struct header *header, double v[COLUMNS], bool lps)
{
    double m[16];
    double q[4] = {v[QW], v[QX], v[QY], v[QZ]};
    for (int i = 0; i < 16; i++) {
        m[i] = v[M00 + 4 * (i % 4) + i / 4];
    }
    if (lps) { /* turning by pi about z takes a rotation's LPS form to its RAS form: (w, x, y, z) -> (-z, -y, x, w) */
        flip_point(v + X);
        flip_point(v + TX);
        flip_point(v + DX);
        flip_point(v + UX);
        flip_matrix(m);
        const double turned[4] = {-v[QZ], -v[QY], v[QX], v[QW]};
        memcpy(q, turned, sizeof q);
    }
    const double *up = header->has[UX] ? v + UX : NULL;
    return header->has[M00]  ? conus_pose_from_matrix(out, m)
           : header->has[QW] ? conus_pose_from_quaternion(out, v + X, q)
           : header->has[TX] ? conus_pose_toward(out, v + X, v + TX, up)
                             : conus_pose_along(out, v + X, v + DX, up);
}

static conus_status read_value(double *out, enum column column, struct text field)
{
    if (!text_to_double(field, out) || !isfinite(*out)) {
        return fail(CONUS_ERROR_DATA, "column %s: \"%.*s\" is not a finite number", names[column],
                    (int)(field.size < 40 ? field.size : 40), field.data);
    }
    return CONUS_OK;
}

static conus_status read_values(double values[COLUMNS], struct text *id, const struct header *header, struct text line)
{
    struct text field;
    size_t count = 0;
    for (bool more = true; text_field(&line, header->separator, &more, &field); count++) {
        enum column column = count < header->field_count ? header->of_field[count] : COLUMNS;
        field = text_trim(field);
        if (column == ID) {
            *id = field;
        } else if (column < COLUMNS) {
            conus_status status = read_value(&values[column], column, field);
            if (status) {
                return status;
            }
        }
    }
    return count == header->field_count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%zu fields, the header has %zu", count, header->field_count);
}

static conus_status read_row(conus_pose_row *row, struct text *id, const struct header *header, struct text line,
                             bool lps)
{
    double values[COLUMNS] = {0};
    conus_status status = text_is_utf8(line) ? CONUS_OK : fail(CONUS_ERROR_DATA, "not UTF-8 text");
    status = status ? status : read_values(values, id, header, line);
    status = status ? status : pose_from_values(&row->pose, header, values, lps);
    if (!status && header->has[ANGLE]) {
        struct cone cone = {.angle = radians_from_degrees(values[ANGLE]), .resolution = 1};
        status = cone_check(&cone);
        row->angle = cone.angle;
    }
    return status;
}

static bool is_blank(struct text line)
{
    struct text trimmed = text_trim(line);
    return !trimmed.size || trimmed.data[0] == '#';
}

static conus_status read_table(conus_pose_list *list, struct text rest, bool lps)
{
    struct header header = {0};
    struct text line;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&rest, &line); number++) {
        if (is_blank(line)) {
            continue;
        }
        if (!header.field_count) {
            status = read_header(&header, line);
            continue;
        }
        conus_pose_row row = {.line = number};
        struct text id = {"", 0};
        conus_status bad = read_row(&row, &id, &header, line, lps);
        status = append_row(list, &row, id, bad ? conus_message() : NULL);
    }
    return status;
}

/* True when the text is nothing but 16 numbers: then `values` are those of a row-major matrix. */
static bool read_plain_matrix(double values[COLUMNS], struct text rest)
{
    struct text word;
    size_t count = 0;
    while (text_word(&rest, &word)) {
        if (count == MATRIX_NUMBERS || !text_to_double(word, &values[M00 + count])) {
            return false;
        }
        count++;
    }
    return count == MATRIX_NUMBERS;
}

static conus_status parse_into(conus_pose_list *list, struct text text, bool lps)
{
    double values[COLUMNS] = {0};
    if (text.size && memchr(text.data, '\0', text.size)) {
        return fail(CONUS_ERROR_DATA, "a zero byte: not a text of poses");
    }
    if (read_plain_matrix(values, text)) {
        const struct header matrix = {.has[M00] = true};
        conus_pose_row row = {.line = 1};
        conus_status bad = pose_from_values(&row.pose, &matrix, values, lps);
        return append_row(list, &row, text_from(""), bad ? conus_message() : NULL);
    }
    conus_status status = read_table(list, text, lps);
    if (!status && !list->count) {
        status = fail(CONUS_ERROR_DATA, "no poses: a header line and one line per pose, or a 4 x 4 matrix, is needed");
    }
    return status;
}

conus_status pose_list_parse(conus_pose_list **out, struct text text, conus_space space)
{
    conus_pose_list *list = memory_zeroed(1, sizeof *list);
    if (!list) {
        return CONUS_ERROR_MEMORY;
    }
    if (text_starts(text, "\xef\xbb\xbf")) { /* byte order mark */
        text.data += 3;
        text.size -= 3;
    }
    conus_status status = parse_into(list, text, space == CONUS_LPS);
    if (status) {
        conus_pose_list_destroy(list);
        return status;
    }
    *out = list;
    return CONUS_OK;
}

conus_status conus_pose_list_load(conus_pose_list **out, const char *path, conus_space space)
{
    struct bytes bytes = {0};
    conus_status status = file_read(&bytes, path, FILE_LIMIT);
    if (!status) {
        status = pose_list_parse(out, (struct text){(const char *)bytes.data, bytes.size}, space);
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    bytes_finish(&bytes);
    return status;
}

size_t conus_pose_list_count(const conus_pose_list *list)
{
    return list ? list->count : 0;
}

const conus_pose_row *conus_pose_list_row(const conus_pose_list *list, size_t index)
{
    return list && index < list->count ? &list->rows[index] : NULL;
}
