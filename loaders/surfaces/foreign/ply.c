/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses PLY: a header that says what each element has, then the elements, as text or binary of either byte order. */
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/words.h"

#include <math.h>

enum { ELEMENT_LIMIT = 64, PROPERTY_LIMIT = 256 };

enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_INT64,
    PLY_UINT64,
    PLY_FLOAT32,
    PLY_FLOAT64,
    PLY_NONE
};

/* The purpose of a property. */
enum use { USE_X, USE_Y, USE_Z, USE_CORNERS, USE_NOTHING };

enum kind { KIND_VERTEX, KIND_FACE, KIND_OTHER };

struct property {
    enum ply_type type;
    enum ply_type count; /* of a list's length; PLY_NONE = it is no list */
    enum use use;
};

struct element {
    enum kind kind;
    size_t count;
    size_t first, properties; /* in the list of all */
};

struct ply {
    struct words words;
    struct foreign_mesh *mesh;
    bool is_text, swapped;
    struct element elements[ELEMENT_LIMIT];
    struct property properties[PROPERTY_LIMIT];
    size_t element_count, property_count;
};

static const struct {
    const char *name, *sized;
    size_t size;
} types[PLY_NONE] = {
    [PLY_INT8] = {"char", "int8", 1},        [PLY_UINT8] = {"uchar", "uint8", 1},
    [PLY_INT16] = {"short", "int16", 2},     [PLY_UINT16] = {"ushort", "uint16", 2},
    [PLY_INT32] = {"int", "int32", 4},       [PLY_UINT32] = {"uint", "uint32", 4},
    [PLY_INT64] = {"int64", "long", 8},      [PLY_UINT64] = {"uint64", "ulong", 8},
    [PLY_FLOAT32] = {"float", "float32", 4}, [PLY_FLOAT64] = {"double", "float64", 8},
};

static enum ply_type type_of(struct text word)
{
    enum ply_type type = PLY_INT8;
    while (type < PLY_NONE && !text_equal(word, types[type].name) && !text_equal(word, types[type].sized)) {
        type++;
    }
    return type;
}

static conus_status fail_header(const struct ply *ply, struct text line, const char *what)
{
    return fail(CONUS_ERROR_DATA, "line %zu: header: \"%.*s\", %s", ply->words.line - 1, TEXT_SHOW(line, 60), what);
}

static conus_status take_format(struct ply *ply, struct text rest, struct text line)
{
    struct text form;
    struct text version;
    if (!text_word(&rest, &form) || !text_word(&rest, &version) || !text_equal(version, "1.0")) {
        return fail_header(ply, line, "a format and version 1.0 are needed");
    }
    bool little = text_equal(form, "binary_little_endian");
    ply->is_text = text_equal(form, "ascii");
    ply->swapped = little != BIG_ENDIAN_IS_SWAPPED;
    return ply->is_text || little || text_equal(form, "binary_big_endian")
               ? CONUS_OK
               : fail_header(ply, line, "allowed are ascii, binary_little_endian, binary_big_endian");
}

static conus_status take_element(struct ply *ply, struct text rest, struct text line)
{
    struct text name;
    struct text number;
    uint64_t count;
    if (!text_word(&rest, &name) || !text_word(&rest, &number) || !text_to_uint(number, UINT64_MAX, &count)) {
        return fail_header(ply, line, "an element has a name and a count");
    }
    if (ply->element_count == ELEMENT_LIMIT) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: more than %d elements", ELEMENT_LIMIT);
    }
    if (count > ply->words.rest.size) { /* each has a byte or more */
        return fail(CONUS_ERROR_DATA, "header: %.*s: more than the %zu bytes that follow can hold", TEXT_SHOW(line, 60),
                    ply->words.rest.size);
    }
    ply->elements[ply->element_count++] = (struct element){.kind = text_equal(name, "vertex") ? KIND_VERTEX
                                                                   : text_equal(name, "face") ? KIND_FACE
                                                                                              : KIND_OTHER,
                                                           .count = (size_t)count,
                                                           .first = ply->property_count};
    return CONUS_OK;
}

static enum use use_of(enum kind kind, struct text name, bool is_list)
{
    if (kind == KIND_FACE) {
        bool corners = text_equal(name, "vertex_indices") || text_equal(name, "vertex_index");
        return is_list && corners ? USE_CORNERS : USE_NOTHING;
    }
    bool axis = kind == KIND_VERTEX && !is_list && name.size == 1 && name.data[0] >= 'x' && name.data[0] <= 'z';
    return axis ? (enum use)(USE_X + (name.data[0] - 'x')) : USE_NOTHING;
}

static conus_status take_property(struct ply *ply, struct text rest, struct text line)
{
    struct text word = {0};
    struct text name = {0};
    struct property property = {.type = PLY_NONE, .count = PLY_NONE};
    bool is_list = text_word(&rest, &word) && text_equal(word, "list");
    if (is_list && text_word(&rest, &word)) {
        property.count = type_of(word);
        word.size = 0;
        (void)text_word(&rest, &word);
    }
    property.type = type_of(word);
    bool bad_count = is_list && property.count >= PLY_FLOAT32;
    if (property.type == PLY_NONE || bad_count || !text_word(&rest, &name) || !ply->element_count) {
        return fail_header(ply, line, "a property has a type (a list one of its length, too) and a name");
    }
    if (ply->property_count == PROPERTY_LIMIT) {
        return fail(CONUS_ERROR_UNSUPPORTED, "header: more than %d properties", PROPERTY_LIMIT);
    }
    struct element *element = &ply->elements[ply->element_count - 1];
    property.use = use_of(element->kind, name, is_list);
    ply->properties[ply->property_count++] = property;
    element->properties++;
    return CONUS_OK;
}

static conus_status ply_take_line(struct ply *ply, struct text line, bool *done)
{
    struct text rest = line;
    struct text word = {0};
    (void)text_word(&rest, &word);
    *done = text_equal(word, "end_header");
    if (text_equal(word, "comment")) {
        ply->mesh->space = ply->mesh->space ? ply->mesh->space : foreign_space_in(rest);
        return CONUS_OK;
    }
    if (text_starts(line, "Created by ")) { /* Blender 2.47 leaves out "comment" */
        return CONUS_OK;
    }
    return text_equal(word, "format")              ? take_format(ply, rest, line)
           : text_equal(word, "element")           ? take_element(ply, rest, line)
           : text_equal(word, "property")          ? take_property(ply, rest, line)
           : text_equal(word, "obj_info") || *done ? CONUS_OK
                                                   : fail_header(ply, line, "not a word of PLY's header");
}

/* How often the element has a property for `use`. */
static size_t uses(const struct ply *ply, const struct element *element, enum use use)
{
    size_t count = 0;
    for (size_t i = 0; i < element->properties; i++) {
        count += ply->properties[element->first + i].use == use;
    }
    return count;
}

/* A byte or more for each property, in text with a space; an element without any takes none, but its line. */
static conus_status check_element(const struct ply *ply, const struct element *element)
{
    size_t least = ply->is_text && !element->properties ? 1 : 0;
    for (size_t i = 0; i < element->properties; i++) {
        const struct property *property = &ply->properties[element->first + i];
        least += ply->is_text ? 2 : types[property->count < PLY_NONE ? property->count : property->type].size;
    }
    if (element->kind == KIND_VERTEX &&
        (uses(ply, element, USE_X) != 1 || uses(ply, element, USE_Y) != 1 || uses(ply, element, USE_Z) != 1)) {
        return fail(CONUS_ERROR_DATA, "header: a vertex has x, y and z, once each, and they are no lists");
    }
    if (element->kind == KIND_FACE && uses(ply, element, USE_CORNERS) != 1) {
        return fail(CONUS_ERROR_DATA, "header: a face has one list vertex_indices");
    }
    if (least && element->count > ply->words.rest.size / least + 1) {
        return fail(CONUS_ERROR_DATA, "header: %zu elements of %zu bytes or more, %zu bytes follow", element->count,
                    least, ply->words.rest.size);
    }
    return CONUS_OK;
}

/* One element for the vertices, one for the faces, behind it. */
static conus_status ply_check_header(const struct ply *ply, bool has_format)
{
    size_t seen[KIND_OTHER] = {0};
    if (!has_format) {
        return fail(CONUS_ERROR_DATA, "header: no format");
    }
    for (size_t i = 0; i < ply->element_count; i++) {
        const struct element *element = &ply->elements[i];
        conus_status status = check_element(ply, element);
        if (status) {
            return status;
        }
        if (element->kind != KIND_OTHER && seen[element->kind]++) {
            return fail(CONUS_ERROR_DATA, "header: element %s twice", element->kind == KIND_FACE ? "face" : "vertex");
        }
        if (element->kind == KIND_FACE && !seen[KIND_VERTEX]) {
            return fail(CONUS_ERROR_UNSUPPORTED, "header: element face before element vertex");
        }
    }
    return seen[KIND_FACE] ? CONUS_OK : fail(CONUS_ERROR_DATA, "header: no element face: points, not a surface");
}

static conus_status ply_read_header(struct ply *ply)
{
    struct text line;
    bool done = false;
    bool has_format = false;
    conus_status status = CONUS_OK;
    if (!words_line(&ply->words, &line) || !text_equal(line, "ply")) {
        return fail(CONUS_ERROR_DATA, "header: a PLY file begins with a line \"ply\"");
    }
    while (!status && !done) {
        if (!words_line(&ply->words, &line)) {
            return fail(CONUS_ERROR_DATA, "line %zu: header: the file ends before end_header", ply->words.line);
        }
        has_format = has_format || text_starts(line, "format");
        status = ply_take_line(ply, line, &done);
    }
    return status ? status : ply_check_header(ply, has_format);
}

static conus_status ply_fail_cut_off(const struct ply *ply)
{
    return fail(CONUS_ERROR_DATA, "content: the file is cut off behind %zu vertices and %zu faces",
                ply->mesh->vertex_count, ply->mesh->face_count);
}

static conus_status next_number(double *out, struct ply *ply, enum ply_type type)
{
    if (ply->is_text) {
        struct text word;
        if (words_next(&ply->words, &word) && text_to_double(word, out)) {
            return CONUS_OK;
        }
        return word.size ? words_fail(&ply->words, word, "a number") : ply_fail_cut_off(ply);
    }
    size_t size = types[type].size;
    const uint8_t *data = words_bytes(&ply->words, size);
    if (!data) {
        return ply_fail_cut_off(ply);
    }
    bool is_signed = type == PLY_INT8 || type == PLY_INT16 || type == PLY_INT32 || type == PLY_INT64;
    *out = type >= PLY_FLOAT32 ? order_real(data, size, ply->swapped)
                               : (double)order_whole(data, size, is_signed, ply->swapped);
    return CONUS_OK;
}

/* The text of a coordinate is rounded once. */
static conus_status next_coordinate(float *out, struct ply *ply, enum ply_type type)
{
    struct text word;
    if (ply->is_text && words_peek(&ply->words, &word) && text_to_float(word, out)) {
        return words_next(&ply->words, &word) ? CONUS_OK : ply_fail_cut_off(ply);
    }
    double value = 0;
    conus_status status = next_number(&value, ply, type);
    *out = (float)value;
    return status;
}

/* Whole numbers of 53 bits; others become -1, which is no vertex. */
static int64_t whole_of(double value)
{
    return fabs(value) < 0x1p53 && value == floor(value) ? (int64_t)value : -1;
}

static conus_status take_list(struct ply *ply, const struct property *property)
{
    double length = 0;
    conus_status status = next_number(&length, ply, property->count);
    if (status) {
        return status;
    }
    int64_t count = whole_of(length);
    size_t least = ply->is_text ? 2 : types[property->type].size;
    if (count < 0 || (uint64_t)count > ply->words.rest.size / least + 1) {
        return fail(CONUS_ERROR_DATA, "face %zu: a list of %g numbers, %zu bytes follow", ply->mesh->face_count, length,
                    ply->words.rest.size);
    }
    if (property->use == USE_NOTHING && !ply->is_text) {
        return words_bytes(&ply->words, (size_t)count * least) ? CONUS_OK : ply_fail_cut_off(ply);
    }
    for (int64_t i = 0; !status && i < count; i++) {
        double value = 0;
        status = next_number(&value, ply, property->type);
        if (!status && property->use == USE_CORNERS) {
            status = foreign_add_corner(ply->mesh, whole_of(value));
        }
    }
    return status;
}

static conus_status take_row(struct ply *ply, const struct element *element)
{
    float position[3] = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < element->properties; i++) {
        const struct property *property = &ply->properties[element->first + i];
        double value;
        status = property->count != PLY_NONE ? take_list(ply, property)
                 : property->use <= USE_Z    ? next_coordinate(&position[property->use], ply, property->type)
                                             : next_number(&value, ply, property->type);
    }
    if (status) {
        return status;
    }
    return element->kind == KIND_VERTEX ? foreign_add_vertex(ply->mesh, position)
           : element->kind == KIND_FACE ? foreign_end_polygon(ply->mesh)
                                        : CONUS_OK;
}

conus_status ply_parse(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    struct ply *ply = memory_zeroed(1, sizeof *ply);
    if (!ply) {
        return CONUS_ERROR_MEMORY;
    }
    ply->words = (struct words){.rest = {(const char *)data, size}, .line = 1};
    ply->mesh = out;
    conus_status status = ply_read_header(ply);
    for (size_t i = 0; !status && i < ply->element_count; i++) {
        const struct element *element = &ply->elements[i];
        if (element->kind == KIND_VERTEX) {
            status = foreign_reserve_vertices(ply->mesh, element->count);
        }
        for (size_t row = 0; !status && element->properties && row < element->count; row++) {
            status = take_row(ply, element);
        }
    }
    if (!status) {
        status = ply->is_text || !ply->words.rest.size
                     ? words_end(&ply->words, "the last element")
                     : fail(CONUS_ERROR_DATA, "content: %zu bytes behind the last element", ply->words.rest.size);
    }
    memory_free(ply);
    return status;
}
