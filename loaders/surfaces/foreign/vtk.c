/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses VTK's legacy format: polygons and strips of triangles; lines and points are passed over. */
#include "loaders/surfaces/foreign/foreign.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/words.h"

#include <string.h>

struct vtk {
    struct words words;
    struct foreign_mesh *mesh;
    bool is_text;
    bool has_offsets; /* version 5: cells are offsets and corners */
    bool has_points;
};

struct vtk_type {
    const char *name;
    size_t bits;
    enum { INTEGER, UNSIGNED, REAL } kind;
};

/* vtkIdType is written as int. */
static const struct vtk_type types[] = {
    {"float", 32, REAL},
    {"double", 64, REAL},
    {"bit", 1, UNSIGNED},
    {"char", 8, INTEGER},
    {"signed_char", 8, INTEGER},
    {"unsigned_char", 8, UNSIGNED},
    {"short", 16, INTEGER},
    {"unsigned_short", 16, UNSIGNED},
    {"int", 32, INTEGER},
    {"unsigned_int", 32, UNSIGNED},
    {"long", 64, INTEGER},
    {"unsigned_long", 64, UNSIGNED},
    {"vtkidtype", 32, INTEGER},
    {"vtktypeint64", 64, INTEGER},
    {"vtktypeuint64", 64, UNSIGNED},
};

static conus_status need_type(const struct vtk_type **out, struct vtk *vtk)
{
    struct text word;
    bool there = words_next(&vtk->words, &word);
    for (size_t i = 0; there && i < sizeof types / sizeof types[0]; i++) {
        if (text_equal_ignoring_case(word, types[i].name)) {
            *out = &types[i];
            return CONUS_OK;
        }
    }
    return words_fail(&vtk->words, word, "a type of numbers");
}

/* Binary numbers begin behind the line, those of text behind white space. */
static conus_status end_line(struct vtk *vtk)
{
    struct text line = {0};
    if (vtk->is_text) {
        return CONUS_OK;
    }
    (void)words_line(&vtk->words, &line);
    if (text_trim(line).size) {
        vtk->words.line--;
        return words_fail(&vtk->words, text_trim(line), "the end of the line");
    }
    return CONUS_OK;
}

static int64_t whole_at(const uint8_t *data, const struct vtk_type *type)
{
    const bool swapped = BIG_ENDIAN_IS_SWAPPED;
    bool is_signed = type->kind == INTEGER;
    switch (type->bits) {
    case 8:
        return is_signed ? (int8_t)*data : *data;
    case 16:
        return is_signed ? order_i16(data, swapped) : order_u16(data, swapped);
    case 32:
        return is_signed ? (int64_t)order_i32(data, swapped) : (int64_t)order_u32(data, swapped);
    default:
        return order_i64(data, swapped);
    }
}

static conus_status fail_cut_off(const char *what)
{
    return fail(CONUS_ERROR_DATA, "%s: the file is cut off", what);
}

static conus_status next_whole(int64_t *out, struct vtk *vtk, const struct vtk_type *type, const char *what)
{
    if (vtk->is_text) {
        return words_whole(out, &vtk->words, INT64_MIN, what);
    }
    const uint8_t *data = words_bytes(&vtk->words, type->bits / 8);
    *out = data ? whole_at(data, type) : 0;
    return data ? CONUS_OK : fail_cut_off(what);
}

static conus_status next_coordinate(float *out, struct vtk *vtk, const struct vtk_type *type)
{
    if (vtk->is_text) {
        return words_float(out, &vtk->words, "a coordinate");
    }
    const uint8_t *data = words_bytes(&vtk->words, type->bits / 8);
    if (!data) {
        return fail_cut_off("POINTS");
    }
    *out = type->kind != REAL ? (float)whole_at(data, type)
           : type->bits == 32 ? order_f32(data, BIG_ENDIAN_IS_SWAPPED)
                              : (float)order_f64(data, BIG_ENDIAN_IS_SWAPPED);
    return CONUS_OK;
}

static conus_status read_points(struct vtk *vtk)
{
    const struct vtk_type *type = &types[0];
    size_t count = 0;
    conus_status status = vtk->has_points ? fail(CONUS_ERROR_DATA, "POINTS: twice") : CONUS_OK;
    status = status ? status : words_count(&count, &vtk->words, 3, "POINTS");
    status = status ? status : need_type(&type, vtk);
    status = status ? status : end_line(vtk);
    if (!status && type->bits < 8) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "POINTS: of type bit");
    }
    size_t least = status || vtk->is_text ? 6 : 3 * type->bits / 8; /* in text a digit and a space each */
    if (!status && count > vtk->words.rest.size / least + 1) {
        status = fail(CONUS_ERROR_DATA, "POINTS: %zu, more than the %zu bytes that follow can hold", count,
                      vtk->words.rest.size);
    }
    status = status ? status : foreign_reserve_vertices(vtk->mesh, count);
    for (size_t i = 0; !status && i < count; i++) {
        float position[3] = {0};
        for (int a = 0; !status && a < 3; a++) {
            status = next_coordinate(&position[a], vtk, type);
        }
        status = status ? status : foreign_add_vertex(vtk->mesh, position);
    }
    vtk->has_points = true;
    return status;
}

enum cells { CELLS_PASSED_OVER, CELLS_POLYGONS, CELLS_STRIPS };

static conus_status end_cell(struct foreign_mesh *mesh, enum cells cells)
{
    if (cells == CELLS_POLYGONS) {
        return foreign_end_polygon(mesh);
    }
    return cells == CELLS_STRIPS ? foreign_end_strip(mesh) : CONUS_OK;
}

static conus_status take_corners(struct vtk *vtk, int64_t count, const struct vtk_type *type, enum cells cells,
                                 const char *what)
{
    conus_status status = CONUS_OK;
    for (int64_t k = 0; !status && k < count; k++) {
        int64_t index;
        status = next_whole(&index, vtk, type, what);
        if (!status && cells != CELLS_PASSED_OVER) {
            status = foreign_add_corner(vtk->mesh, index);
        }
    }
    return status ? status : end_cell(vtk->mesh, cells);
}

/* `count` cells, each as the number of its corners and the corners; `size` numbers in all. */
static conus_status read_counted(struct vtk *vtk, size_t count, size_t size, enum cells cells, const char *what)
{
    static const struct vtk_type number = {"int", 32, INTEGER};
    conus_status status = end_line(vtk);
    for (size_t i = 0; !status && i < count; i++) {
        int64_t corners;
        status = next_whole(&corners, vtk, &number, what);
        if (!status && (size == 0 || corners < 0 || (uint64_t)corners > size - 1)) {
            status = fail(CONUS_ERROR_DATA, "%s: cell %zu has %lld corners, %zu numbers are left", what, i,
                          (long long)corners, size);
        }
        status = status ? status : take_corners(vtk, corners, &number, cells, what);
        size -= status ? 0 : 1 + (size_t)corners;
    }
    if (!status && size) {
        status = fail(CONUS_ERROR_DATA, "%s: %zu numbers more than its %zu cells have", what, size, count);
    }
    return status;
}

static conus_status begin_array(const struct vtk_type **type, struct vtk *vtk, const char *name)
{
    struct text word;
    if (!words_next(&vtk->words, &word) || !text_equal_ignoring_case(word, name)) {
        return words_fail(&vtk->words, word, name);
    }
    conus_status status = need_type(type, vtk);
    if (!status && ((*type)->bits < 8 || (*type)->kind == REAL)) {
        status = fail(CONUS_ERROR_DATA, "%s: of type %s, a whole number is needed", name, (*type)->name);
    }
    return status ? status : end_line(vtk);
}

/* Version 5: `count` offsets, of which the first is 0 and the last `size`, then `size` corners. Both are read side by
 * side. */
static conus_status read_offset_cells(struct vtk *vtk, size_t count, size_t size, enum cells cells, const char *what)
{
    const struct vtk_type *offset_type = &types[0];
    const struct vtk_type *corner_type = &types[0];
    int64_t offset = 0;
    conus_status status = begin_array(&offset_type, vtk, "OFFSETS");
    struct vtk offsets = *vtk;
    for (size_t i = 0; !status && i < count; i++) { /* to where the corners begin */
        int64_t next;
        status = next_whole(&next, vtk, offset_type, "OFFSETS");
        if (!status && (next < offset || (uint64_t)next > size || (i == 0 && next) ||
                        (i + 1 == count && (uint64_t)next != size))) {
            status = fail(CONUS_ERROR_DATA, "OFFSETS: number %zu is %lld, they rise from 0 to %zu", i, (long long)next,
                          size);
        }
        offset = status ? 0 : next;
    }
    status = status ? status : begin_array(&corner_type, vtk, "CONNECTIVITY");
    offset = 0;
    for (size_t i = 0; !status && i < count; i++) {
        int64_t next;
        status = next_whole(&next, &offsets, offset_type, "OFFSETS");
        if (!status && i > 0) {
            status = take_corners(vtk, next - offset, corner_type, cells, what);
        }
        offset = status ? 0 : next;
    }
    return status;
}

static conus_status read_cells(struct vtk *vtk, enum cells cells, const char *what)
{
    size_t count = 0;
    size_t size = 0;
    conus_status status = words_count(&count, &vtk->words, 1, what);
    status = status ? status : words_count(&size, &vtk->words, 1, what);
    if (status || !vtk->has_offsets) {
        return status ? status : read_counted(vtk, count, size, cells, what);
    }
    return count  ? read_offset_cells(vtk, count, size, cells, what)
           : size ? fail(CONUS_ERROR_DATA, "%s: %zu corners without a cell", what, size)
                  : CONUS_OK;
}

static conus_status skip_strings(struct vtk *vtk, size_t count)
{
    struct text line;
    if (!vtk->is_text) {
        return fail(CONUS_ERROR_UNSUPPORTED, "FIELD: texts in a binary file");
    }
    (void)words_line(&vtk->words, &line); /* the rest of the array's own */
    for (size_t i = 0; i < count; i++) {
        if (!words_line(&vtk->words, &line)) {
            return fail_cut_off("FIELD");
        }
    }
    return CONUS_OK;
}

static conus_status skip_numbers(struct vtk *vtk, const struct vtk_type *type, size_t count)
{
    struct text word;
    if (!vtk->is_text) {
        size_t bits = 0;
        bool fits = memory_multiply(count, type->bits, &bits) && words_bytes(&vtk->words, bits / 8 + (bits % 8 > 0));
        return fits ? CONUS_OK : fail_cut_off("FIELD");
    }
    for (size_t i = 0; i < count; i++) {
        if (!words_next(&vtk->words, &word)) {
            return fail_cut_off("FIELD");
        }
    }
    return CONUS_OK;
}

/* Name, numbers in a tuple, tuples, type. */
static conus_status skip_array(struct vtk *vtk)
{
    const struct vtk_type *type = &types[0];
    struct text name;
    size_t parts = 0;
    size_t tuples = 0;
    size_t count = 0;
    if (!words_next(&vtk->words, &name)) {
        return words_fail(&vtk->words, name, "the name of an array");
    }
    conus_status status = words_count(&parts, &vtk->words, 1, "FIELD");
    status = status ? status : words_count(&tuples, &vtk->words, 1, "FIELD");
    if (!status && !memory_multiply(parts, tuples, &count)) {
        status = fail_cut_off("FIELD");
    }
    bool strings = !status && words_take(&vtk->words, "string");
    status = status || strings ? status : need_type(&type, vtk);
    status = status ? status : end_line(vtk);
    return status ? status : strings ? skip_strings(vtk, count) : skip_numbers(vtk, type, count);
}

static conus_status skip_metadata(struct vtk *vtk)
{
    struct text line = {0};
    bool there = words_line(&vtk->words, &line); /* what is left of its own */
    while (there && words_line(&vtk->words, &line) && text_trim(line).size) {
    }
    return CONUS_OK;
}

static conus_status skip_field(struct vtk *vtk)
{
    struct text name;
    size_t arrays = 0;
    if (!words_next(&vtk->words, &name)) {
        return words_fail(&vtk->words, name, "the name of a field");
    }
    conus_status status = words_count(&arrays, &vtk->words, 1, "FIELD");
    for (size_t i = 0; !status && i < arrays; i++) {
        status = skip_array(vtk);
        if (!status && words_take(&vtk->words, "METADATA")) {
            status = skip_metadata(vtk);
        }
    }
    return status;
}

/* What belongs to points and cells, from there to the end, is not read. */
static conus_status read_section(struct vtk *vtk, bool *done)
{
    static const struct {
        const char *word;
        enum cells cells;
    } sections[] = {{"VERTICES", CELLS_PASSED_OVER},
                    {"LINES", CELLS_PASSED_OVER},
                    {"POLYGONS", CELLS_POLYGONS},
                    {"TRIANGLE_STRIPS", CELLS_STRIPS}};
    struct text word;
    *done = words_take(&vtk->words, "POINT_DATA") || words_take(&vtk->words, "CELL_DATA");
    if (*done) {
        return CONUS_OK;
    }
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
        if (words_take(&vtk->words, sections[i].word)) {
            return read_cells(vtk, sections[i].cells, sections[i].word);
        }
    }
    if (words_take(&vtk->words, "POINTS")) {
        return read_points(vtk);
    }
    if (words_take(&vtk->words, "FIELD")) {
        return skip_field(vtk);
    }
    if (words_take(&vtk->words, "METADATA")) {
        return skip_metadata(vtk);
    }
    *done = !words_next(&vtk->words, &word);
    return *done ? CONUS_OK : words_fail(&vtk->words, word, "POINTS, POLYGONS, TRIANGLE_STRIPS or another section");
}

static conus_status read_dataset(struct vtk *vtk)
{
    struct text word;
    conus_status status = CONUS_OK;
    if (words_take(&vtk->words, "FIELD")) {
        status = skip_field(vtk);
    }
    if (!status && (!words_next(&vtk->words, &word) || !text_equal_ignoring_case(word, "DATASET"))) {
        status = words_fail(&vtk->words, word, "DATASET");
    }
    if (!status && !words_take(&vtk->words, "POLYDATA")) {
        (void)words_next(&vtk->words, &word);
        status = fail(CONUS_ERROR_UNSUPPORTED, "DATASET: found \"%.*s\", only POLYDATA is a surface",
                      (int)(word.size < 60 ? word.size : 60), word.data);
    }
    return status;
}

static conus_status read_header(struct vtk *vtk)
{
    static const char magic[] = "# vtk DataFile Version ";
    struct text line = {0};
    double version = 0;
    bool there = words_line(&vtk->words, &line) && text_starts(line, magic);
    struct text number = there ? text_trim((struct text){line.data + sizeof magic - 1, line.size - (sizeof magic - 1)})
                               : (struct text){0};
    if (!text_to_double(number, &version) || !(version >= 1 && version < 6)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: version \"%.*s\", allowed are 1.0 to 5.1",
                    (int)(number.size < 60 ? number.size : 60), number.size ? number.data : "");
    }
    vtk->has_offsets = version >= 5;
    if (words_line(&vtk->words, &line)) {
        vtk->mesh->space = foreign_space_in(line);
    }
    vtk->is_text = words_take(&vtk->words, "ASCII");
    if (!vtk->is_text && !words_take(&vtk->words, "BINARY")) {
        (void)words_next(&vtk->words, &line);
        return words_fail(&vtk->words, line, "ASCII or BINARY");
    }
    return read_dataset(vtk);
}

conus_status vtk_parse(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    struct vtk vtk = {.words = {.rest = {(const char *)data, size}, .line = 1}, .mesh = out};
    bool done = false;
    conus_status status = read_header(&vtk);
    while (!status && !done) {
        status = read_section(&vtk, &done);
    }
    return status;
}
