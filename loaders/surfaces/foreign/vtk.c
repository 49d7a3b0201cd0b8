/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses VTK's legacy format: polygons and strips of triangles; for who wants them lines, and numbers of points and
 * lines. */
#include "base/byte_order.h"
#include "base/formats/base64.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"
#include "loaders/surfaces/foreign/words.h"

#include <assert.h>
#include <string.h>

struct vtk {
    struct words words;
    struct foreign_mesh *mesh;
    bool is_text;
    bool has_offsets; /* Version 5: cells are offsets and corners. */
    bool has_points;
    enum { VTK_OF_NOTHING, VTK_OF_POINTS, VTK_OF_CELLS } place; /* Whose numbers are read. */
};

struct vtk_type {
    const char *name;
    size_t bits;
    enum { VTK_INTEGER, VTK_UNSIGNED, VTK_REAL } kind;
};

/* vtkIdType is written as int. */
static const struct vtk_type types[] = {
    {"float", 32, VTK_REAL},
    {"double", 64, VTK_REAL},
    {"bit", 1, VTK_UNSIGNED},
    {"char", 8, VTK_INTEGER},
    {"signed_char", 8, VTK_INTEGER},
    {"unsigned_char", 8, VTK_UNSIGNED},
    {"short", 16, VTK_INTEGER},
    {"unsigned_short", 16, VTK_UNSIGNED},
    {"int", 32, VTK_INTEGER},
    {"unsigned_int", 32, VTK_UNSIGNED},
    {"long", 64, VTK_INTEGER},
    {"unsigned_long", 64, VTK_UNSIGNED},
    {"vtkidtype", 32, VTK_INTEGER},
    {"vtktypeint64", 64, VTK_INTEGER},
    {"vtktypeuint64", 64, VTK_UNSIGNED},
};

/* Takes the name of a type. */
static conus_status vtk_need_type(const struct vtk_type **out, struct vtk *vtk)
{
    struct text word;
    bool there = words_next(&vtk->words, &word);
    for (size_t i = 0; there && i < sizeof types / sizeof types[0]; i++) {
        if (text_equal_ignoring_case(word, types[i].name)) {
            *out = &types[i];
            return CONUS_OK;
        }
    }
    conus_status status = words_fail(&vtk->words, word, "a type of numbers");
    assert(status);
    return status;
}

/* Binary numbers begin behind the line, those of text behind white space. */
static conus_status vtk_end_line(struct vtk *vtk)
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

static int64_t vtk_whole_at(const uint8_t *data, const struct vtk_type *type)
{
    return order_whole(data, type->bits / 8, type->kind == VTK_INTEGER, BIG_ENDIAN_IS_SWAPPED);
}

static conus_status vtk_fail_cut_off(const char *what)
{
    return fail(CONUS_ERROR_DATA, "%s: the file is cut off", what);
}

/* The next whole number, of `what`. */
static conus_status vtk_next_whole(int64_t *out, struct vtk *vtk, const struct vtk_type *type, const char *what)
{
    if (vtk->is_text) {
        return words_whole(out, &vtk->words, INT64_MIN, what);
    }
    const uint8_t *data = words_bytes(&vtk->words, type->bits / 8);
    *out = data ? vtk_whole_at(data, type) : 0;
    return data ? CONUS_OK : vtk_fail_cut_off(what);
}

/* The next number, rounded once. A coordinate (VTK_OF_NOTHING) is finite where it is text. */
static conus_status vtk_next_number(float *out, struct vtk *vtk, const struct vtk_type *type, const char *what)
{
    if (vtk->is_text) {
        return vtk->place == VTK_OF_NOTHING ? words_float(out, &vtk->words, "a coordinate")
                                            : words_any_float(out, &vtk->words, "a number");
    }
    const uint8_t *data = words_bytes(&vtk->words, type->bits / 8);
    if (!data) {
        return vtk_fail_cut_off(what);
    }
    *out = type->kind != VTK_REAL ? (float)vtk_whole_at(data, type)
                                  : (float)order_real(data, type->bits / 8, BIG_ENDIAN_IS_SWAPPED);
    return CONUS_OK;
}

enum { NAME_LIMIT = 1024 };

static conus_status skip_strings(struct vtk *vtk, size_t count)
{
    struct text line;
    if (!vtk->is_text) {
        return fail(CONUS_ERROR_UNSUPPORTED, "FIELD: texts in a binary file");
    }
    (void)words_line(&vtk->words, &line); /* the rest of the array's own */
    for (size_t i = 0; i < count; i++) {
        if (!words_line(&vtk->words, &line)) {
            return vtk_fail_cut_off("FIELD");
        }
    }
    return CONUS_OK;
}

static conus_status vtk_skip_numbers(struct vtk *vtk, const struct vtk_type *type, size_t count)
{
    struct text word;
    if (!vtk->is_text) {
        size_t bits = 0;
        bool fits = memory_multiply(count, type->bits, &bits) && words_bytes(&vtk->words, bits / 8 + (bits % 8 > 0));
        return fits ? CONUS_OK : vtk_fail_cut_off("FIELD");
    }
    for (size_t i = 0; i < count; i++) {
        if (!words_next(&vtk->words, &word)) {
            return vtk_fail_cut_off("FIELD");
        }
    }
    return CONUS_OK;
}

/* A name's spaces and such are written as "%20". */
static struct text decode_name(char *out, size_t size, struct text name)
{
    size_t length = 0;
    for (size_t i = 0; i < name.size && length < size; i++) {
        int high = i + 2 < name.size && name.data[i] == '%' ? base16_value(name.data[i + 1]) : -1;
        int low = high >= 0 ? base16_value(name.data[i + 2]) : -1;
        out[length++] = low >= 0 ? (char)(16 * high + low) : name.data[i];
        i += low >= 0 ? 2 : 0;
    }
    return (struct text){out, length};
}

/* Keeps the numbers that are next, `tuples` of `parts`; of those of all cells the lines'. */
static conus_status keep_numbers(struct vtk *vtk, struct text name, const struct vtk_type *type, size_t parts,
                                 size_t tuples)
{
    char decoded[NAME_LIMIT];
    struct foreign_array *array = NULL;
    size_t count = 0;
    size_t least = vtk->is_text ? 2 : type->bits / 8;
    bool fits = memory_multiply(parts, tuples, &count) && count <= vtk->words.rest.size / least + 1;
    struct foreign_lines *lines = vtk->mesh->lines;
    conus_status status = foreign_lines_array(&array, lines, decode_name(decoded, sizeof decoded, name),
                                              vtk->place == VTK_OF_POINTS, parts);
    if (status) {
        return status;
    }
    if (array->values || !fits) {
        return fail(CONUS_ERROR_DATA, "%s: %s", array->name, fits ? "twice" : "the file is cut off");
    }
    status = foreign_array_reserve(lines, array, count);
    for (size_t i = 0; !status && i < count; i++) {
        status = vtk_next_number(&array->values[i], vtk, type, array->name);
    }
    if (status) {
        return status;
    }
    array->count = count;
    if (vtk->place != VTK_OF_CELLS) {
        return CONUS_OK;
    }
    size_t cells = array->count / array->components;
    if (cells != lines->before + lines->count + lines->behind) {
        return fail(CONUS_ERROR_DATA, "%s: of %zu cells, there are %zu", array->name, cells,
                    lines->before + lines->count + lines->behind);
    }
    array->count = lines->count * array->components;
    if (array->count) {
        memmove(array->values, &array->values[lines->before * array->components], array->count * sizeof *array->values);
    }
    return CONUS_OK;
}

static conus_status vtk_take_numbers(struct vtk *vtk, struct text name, const struct vtk_type *type, size_t parts,
                                     size_t tuples)
{
    size_t count = 0;
    if (vtk->place != VTK_OF_NOTHING && type->bits >= 8) {
        return keep_numbers(vtk, name, type, parts, tuples);
    }
    return memory_multiply(parts, tuples, &count) ? vtk_skip_numbers(vtk, type, count) : vtk_fail_cut_off("FIELD");
}

/* Name, numbers in a tuple, tuples, type. */
static conus_status take_array(struct vtk *vtk)
{
    const struct vtk_type *type = NULL;
    struct text name;
    size_t parts = 0;
    size_t tuples = 0;
    size_t count = 0;
    if (!words_next(&vtk->words, &name)) {
        return words_fail(&vtk->words, name, "the name of an array");
    }
    conus_status status;
    if ((status = words_count(&parts, &vtk->words, 1, "FIELD")) ||
        (status = words_count(&tuples, &vtk->words, 1, "FIELD"))) {
        return status;
    }
    if (!memory_multiply(parts, tuples, &count)) {
        return vtk_fail_cut_off("FIELD");
    }
    bool strings = words_take(&vtk->words, "string");
    if ((!strings && (status = vtk_need_type(&type, vtk))) || (status = vtk_end_line(vtk))) {
        return status;
    }
    assert(strings || type);
    return strings ? skip_strings(vtk, count) : vtk_take_numbers(vtk, name, type, parts, tuples);
}

static conus_status vtk_skip_metadata(struct vtk *vtk)
{
    struct text line = {0};
    bool there = words_line(&vtk->words, &line); /* what is left of its own */
    while (there && words_line(&vtk->words, &line) && text_trim(line).size) {
    }
    return CONUS_OK;
}

/* Reads a field, behind its word. Arrays of points or cells are kept, others passed over. */
static conus_status vtk_take_field(struct vtk *vtk)
{
    struct text name;
    size_t arrays = 0;
    if (!words_next(&vtk->words, &name)) {
        return words_fail(&vtk->words, name, "the name of a field");
    }
    conus_status status = words_count(&arrays, &vtk->words, 1, "FIELD");
    for (size_t i = 0; !status && i < arrays; i++) {
        status = take_array(vtk);
        if (!status && words_take(&vtk->words, "METADATA")) {
            status = vtk_skip_metadata(vtk);
        }
    }
    return status;
}

/* The type of colours: text has numbers from 0 to 1, and binary files bytes. */
static const struct vtk_type *colour_type(const struct vtk *vtk)
{
    static const struct vtk_type number = {"float", 32, VTK_REAL};
    static const struct vtk_type byte = {"unsigned_char", 8, VTK_UNSIGNED};
    return vtk->is_text ? &number : &byte;
}

/* Attributes, each begun by a word of its own. */
static const struct attribute {
    const char *word;
    size_t parts; /* numbers of a point or cell; 0: the file says it */
} attributes[] = {{"SCALARS", 0},      {"COLOR_SCALARS", 0}, {"TEXTURE_COORDINATES", 0},
                  {"VECTORS", 3},      {"NORMALS", 3},       {"TENSORS", 9},
                  {"TENSORS6", 6},     {"GLOBAL_IDS", 1},    {"EDGE_FLAGS", 1},
                  {"PEDIGREE_IDS", 1}, {"LOOKUP_TABLE", 4}};

static bool vtk_is_named(const struct attribute *attribute, const char *word)
{
    return strcmp(attribute->word, word) == 0;
}

/* The line behind the word: name, type, and in some files the number of parts, before or behind the type. */
static conus_status read_attribute_line(const struct vtk_type **type, size_t *parts, struct vtk *vtk,
                                        const struct attribute *attribute)
{
    bool is_scalars = vtk_is_named(attribute, "SCALARS");
    bool is_colour = vtk_is_named(attribute, "COLOR_SCALARS");
    struct text word;
    int64_t count = (int64_t)attribute->parts;
    conus_status status;
    if ((!attribute->parts && !is_scalars && (status = words_whole(&count, &vtk->words, 1, attribute->word))) ||
        (!is_colour && (status = vtk_need_type(type, vtk)))) {
        return status;
    }
    if (is_scalars) {
        struct words ahead = vtk->words;
        size_t line = ahead.line;
        bool given = words_next(&ahead, &word) && ahead.line == line && text_to_int(word, &count);
        count = given ? count : 1;
        vtk->words = given ? ahead : vtk->words;
    }
    *parts = (size_t)(count > 0 ? count : 0);
    *type = is_colour ? colour_type(vtk) : *type;
    status = vtk_end_line(vtk);
    if (status || !is_scalars || !words_take(&vtk->words, "LOOKUP_TABLE")) {
        return status;
    }
    return words_next(&vtk->words, &word) ? vtk_end_line(vtk) : words_fail(&vtk->words, word, "a name");
}

/* `count` points or cells. */
static conus_status read_attribute(struct vtk *vtk, const struct attribute *attribute, size_t count)
{
    const struct vtk_type *type = NULL;
    struct text name;
    size_t parts = 0;
    if (!words_next(&vtk->words, &name)) {
        return words_fail(&vtk->words, name, "the name of an array");
    }
    if (vtk_is_named(attribute, "LOOKUP_TABLE")) {
        size_t colours = 0;
        conus_status status;
        if ((status = words_count(&colours, &vtk->words, 1, "LOOKUP_TABLE")) || (status = vtk_end_line(vtk))) {
            return status;
        }
        return vtk_skip_numbers(vtk, colour_type(vtk), 4 * colours);
    }
    conus_status status = read_attribute_line(&type, &parts, vtk, attribute);
    return status ? status : vtk_take_numbers(vtk, name, type, parts, count);
}

/* The number of points or cells. The size of each array is compared with the file later. */
static conus_status read_data_count(size_t *out, struct vtk *vtk)
{
    int64_t count = 0;
    conus_status status = words_whole(&count, &vtk->words, 0, "POINT_DATA or CELL_DATA");
    *out = (size_t)count;
    return status;
}

/* Reads numbers of points and cells, from the count behind POINT_DATA or CELL_DATA to the end of the file. */
static conus_status vtk_read_numbers(struct vtk *vtk)
{
    struct text word;
    size_t count = 0;
    conus_status status = read_data_count(&count, vtk);
    while (!status && words_next(&vtk->words, &word)) {
        const struct attribute *attribute = NULL;
        for (size_t i = 0; i < sizeof attributes / sizeof attributes[0]; i++) {
            attribute = text_equal_ignoring_case(word, attributes[i].word) ? &attributes[i] : attribute;
        }
        bool points = text_equal_ignoring_case(word, "POINT_DATA");
        if (attribute) {
            status = read_attribute(vtk, attribute, count);
        } else if (points || text_equal_ignoring_case(word, "CELL_DATA")) {
            vtk->place = points ? VTK_OF_POINTS : VTK_OF_CELLS;
            status = read_data_count(&count, vtk);
        } else if (text_equal_ignoring_case(word, "FIELD")) {
            status = vtk_take_field(vtk);
        } else {
            status = text_equal_ignoring_case(word, "METADATA")
                         ? vtk_skip_metadata(vtk)
                         : words_fail(&vtk->words, word, "SCALARS, FIELD or another kind of numbers");
        }
    }
    return status;
}

static conus_status read_points(struct vtk *vtk)
{
    const struct vtk_type *type = NULL;
    size_t count = 0;
    if (vtk->has_points) {
        return fail(CONUS_ERROR_DATA, "POINTS: twice");
    }
    conus_status status;
    if ((status = words_count(&count, &vtk->words, 3, "POINTS")) || (status = vtk_need_type(&type, vtk)) ||
        (status = vtk_end_line(vtk))) {
        return status;
    }
    if (type->bits < 8) {
        return fail(CONUS_ERROR_UNSUPPORTED, "POINTS: of type bit");
    }
    size_t least = vtk->is_text ? 6 : 3 * type->bits / 8; /* in text a digit and a space each */
    if (count > vtk->words.rest.size / least + 1) {
        return fail(CONUS_ERROR_DATA, "POINTS: %zu, more than the %zu bytes that follow can hold", count,
                    vtk->words.rest.size);
    }
    status = foreign_reserve_vertices(vtk->mesh, count);
    for (size_t i = 0; !status && i < count; i++) {
        float position[3] = {0};
        for (int a = 0; !status && a < 3; a++) {
            status = vtk_next_number(&position[a], vtk, type, "POINTS");
        }
        status = status ? status : foreign_add_vertex(vtk->mesh, position);
    }
    vtk->has_points = true;
    return status;
}

enum cells { CELLS_VERTICES, CELLS_LINES, CELLS_POLYGONS, CELLS_STRIPS };

static conus_status take_corners(struct vtk *vtk, int64_t count, const struct vtk_type *type, enum cells cells,
                                 const char *what)
{
    struct foreign_mesh *mesh = vtk->mesh;
    conus_status status = CONUS_OK;
    bool are_wanted = cells > CELLS_LINES || (cells == CELLS_LINES && mesh->lines); /* by the caller */
    for (int64_t k = 0; !status && k < count; k++) {
        int64_t index;
        status = vtk_next_whole(&index, vtk, type, what);
        if (!status && are_wanted) {
            status = foreign_add_corner(mesh, index);
        }
    }
    if (status) {
        return status;
    }
    if (mesh->lines) {
        mesh->lines->before += cells == CELLS_VERTICES;
        mesh->lines->behind += cells > CELLS_LINES;
    }
    return cells == CELLS_POLYGONS ? foreign_end_polygon(mesh)
           : cells == CELLS_STRIPS ? foreign_end_strip(mesh)
           : cells == CELLS_LINES  ? foreign_end_line(mesh)
                                   : CONUS_OK;
}

/* `count` cells, each as the number of its corners and the corners; `size` numbers in all. */
static conus_status read_counted(struct vtk *vtk, size_t count, size_t size, enum cells cells, const char *what)
{
    static const struct vtk_type number = {"int", 32, VTK_INTEGER};
    conus_status status = vtk_end_line(vtk);
    for (size_t i = 0; !status && i < count; i++) {
        int64_t corners;
        status = vtk_next_whole(&corners, vtk, &number, what);
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
    conus_status status = CONUS_OK;
    if (!words_next(&vtk->words, &word) || !text_equal_ignoring_case(word, name)) {
        status = words_fail(&vtk->words, word, name);
        assert(status);
        return status;
    }
    status = vtk_need_type(type, vtk);
    if (status) {
        return status;
    }
    if ((*type)->bits < 8 || (*type)->kind == VTK_REAL) {
        return fail(CONUS_ERROR_DATA, "%s: of type %s, a whole number is needed", name, (*type)->name);
    }
    return vtk_end_line(vtk);
}

/* Version 5: `count` offsets, of which the first is 0 and the last `size`, then `size` corners. Both are read side by
 * side. */
static conus_status read_offset_cells(struct vtk *vtk, size_t count, size_t size, enum cells cells, const char *what)
{
    const struct vtk_type *offset_type = NULL;
    const struct vtk_type *corner_type = NULL;
    int64_t offset = 0;
    conus_status status = begin_array(&offset_type, vtk, "OFFSETS");
    struct vtk offsets = *vtk;
    for (size_t i = 0; !status && i < count; i++) { /* to where the corners begin */
        int64_t next;
        status = vtk_next_whole(&next, vtk, offset_type, "OFFSETS");
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
        status = vtk_next_whole(&next, &offsets, offset_type, "OFFSETS");
        if (!status && i > 0) {
            status = take_corners(vtk, next - offset, corner_type, cells, what);
        }
        offset = status ? 0 : next;
    }
    return status;
}

static conus_status vtk_read_cells(struct vtk *vtk, enum cells cells, const char *what)
{
    size_t count = 0;
    size_t size = 0;
    conus_status status;
    if ((status = words_count(&count, &vtk->words, 1, what)) || (status = words_count(&size, &vtk->words, 1, what))) {
        return status;
    }
    return !vtk->has_offsets ? read_counted(vtk, count, size, cells, what)
           : count           ? read_offset_cells(vtk, count, size, cells, what)
           : size            ? fail(CONUS_ERROR_DATA, "%s: %zu corners without a cell", what, size)
                             : CONUS_OK;
}

/* Numbers of points and cells, which reach to the end of the file, are read only where lines are wanted. */
static conus_status read_section(struct vtk *vtk, bool *done)
{
    static const struct {
        const char *word;
        enum cells cells;
    } sections[] = {{"VERTICES", CELLS_VERTICES},
                    {"LINES", CELLS_LINES},
                    {"POLYGONS", CELLS_POLYGONS},
                    {"TRIANGLE_STRIPS", CELLS_STRIPS}};
    struct text word;
    vtk->place = words_take(&vtk->words, "POINT_DATA")  ? VTK_OF_POINTS
                 : words_take(&vtk->words, "CELL_DATA") ? VTK_OF_CELLS
                                                        : VTK_OF_NOTHING;
    *done = vtk->place != VTK_OF_NOTHING;
    if (*done) {
        return vtk->mesh->lines ? vtk_read_numbers(vtk) : CONUS_OK;
    }
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
        if (words_take(&vtk->words, sections[i].word)) {
            return vtk_read_cells(vtk, sections[i].cells, sections[i].word);
        }
    }
    if (words_take(&vtk->words, "POINTS")) {
        return read_points(vtk);
    }
    if (words_take(&vtk->words, "FIELD")) {
        return vtk_take_field(vtk);
    }
    if (words_take(&vtk->words, "METADATA")) {
        return vtk_skip_metadata(vtk);
    }
    *done = !words_next(&vtk->words, &word);
    return *done ? CONUS_OK : words_fail(&vtk->words, word, "POINTS, POLYGONS, TRIANGLE_STRIPS or another section");
}

static conus_status vtk_read_header(struct vtk *vtk)
{
    static const char magic[] = "# vtk DataFile Version ";
    struct text line = {0};
    double version = 0;
    bool there = words_line(&vtk->words, &line) && text_starts(line, magic);
    struct text number = there ? text_trim((struct text){line.data + sizeof magic - 1, line.size - (sizeof magic - 1)})
                               : (struct text){0};
    if (!text_to_double(number, &version) || !(version >= 1 && version < 6)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: version \"%.*s\", allowed are 1.0 to 5.1", TEXT_SHOW(number, 60));
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
    struct text word;
    conus_status status;
    if (words_take(&vtk->words, "FIELD") && (status = vtk_take_field(vtk))) {
        return status;
    }
    if (!words_next(&vtk->words, &word) || !text_equal_ignoring_case(word, "DATASET")) {
        return words_fail(&vtk->words, word, "DATASET");
    }
    if (!words_take(&vtk->words, "POLYDATA")) {
        (void)words_next(&vtk->words, &word);
        return fail(CONUS_ERROR_UNSUPPORTED, "DATASET: found \"%.*s\", only POLYDATA is a surface or lines",
                    TEXT_SHOW(word, 60));
    }
    return CONUS_OK;
}

conus_status vtk_parse(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    struct vtk vtk = {.words = {.rest = {(const char *)data, size}, .line = 1}, .mesh = out};
    bool done = false;
    conus_status status = vtk_read_header(&vtk);
    while (!status && !done) {
        status = read_section(&vtk, &done);
    }
    return status;
}
