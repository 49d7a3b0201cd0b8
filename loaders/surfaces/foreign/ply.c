/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses PLY: a header that says what each element has, then the elements, as text or binary of either byte order. */
#include "loaders/surfaces/foreign/foreign.h"

#include "loaders/surfaces/foreign/parts.h"

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
    struct scan scan;
    struct mesh_sink *sink;
    bool is_text;
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

static void fail_header(struct ply *ply, struct text line, const char *what)
{
    job_bad(ply->sink->job, "line %zu: header: \"%.*s\", %s", ply->scan.line - 1, TEXT_SHOW(line, 60), what);
}

static void take_format(struct ply *ply, struct text rest, struct text line)
{
    struct text form;
    struct text version;
    if (!text_word(&rest, &form) || !text_word(&rest, &version) || !text_equal(version, "1.0")) {
        fail_header(ply, line, "a format and version 1.0 are needed");
        return;
    }
    bool little = text_equal(form, "binary_little_endian");
    ply->is_text = text_equal(form, "ascii");
    ply->scan.r.swapped = little != BIG_ENDIAN_IS_SWAPPED;
    if (!ply->is_text && !little && !text_equal(form, "binary_big_endian")) {
        fail_header(ply, line, "allowed are ascii, binary_little_endian, binary_big_endian");
    }
}

static void take_element(struct ply *ply, struct text rest, struct text line)
{
    struct job *job = ply->sink->job;
    struct text name;
    struct text number;
    uint64_t count;
    if (!text_word(&rest, &name) || !text_word(&rest, &number) || !text_to_uint(number, UINT64_MAX, &count)) {
        fail_header(ply, line, "an element has a name and a count");
    } else if (ply->element_count == ELEMENT_LIMIT) {
        job_refuse(job, "header: more than %d elements", ELEMENT_LIMIT);
    } else if (count > scan_left(&ply->scan)) { /* each has a byte or more */
        job_bad(job, "header: %.*s: more than the %zu bytes that follow can hold", TEXT_SHOW(line, 60),
                scan_left(&ply->scan));
    } else {
        ply->elements[ply->element_count++] = (struct element){.kind = text_equal(name, "vertex") ? KIND_VERTEX
                                                                       : text_equal(name, "face") ? KIND_FACE
                                                                                                  : KIND_OTHER,
                                                               .count = (size_t)count,
                                                               .first = ply->property_count};
    }
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

static void take_property(struct ply *ply, struct text rest, struct text line)
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
        fail_header(ply, line, "a property has a type (a list one of its length, too) and a name");
        return;
    }
    if (ply->property_count == PROPERTY_LIMIT) {
        job_refuse(ply->sink->job, "header: more than %d properties", PROPERTY_LIMIT);
        return;
    }
    struct element *element = &ply->elements[ply->element_count - 1];
    property.use = use_of(element->kind, name, is_list);
    ply->properties[ply->property_count++] = property;
    element->properties++;
}

/* False for the last line. */
static bool take_line(struct ply *ply, struct text line)
{
    struct text rest = line;
    struct text word = {0};
    (void)text_word(&rest, &word);
    if (text_equal(word, "comment")) {
        sink_said(ply->sink, rest);
    } else if (text_equal(word, "format")) {
        take_format(ply, rest, line);
    } else if (text_equal(word, "element")) {
        take_element(ply, rest, line);
    } else if (text_equal(word, "property")) {
        take_property(ply, rest, line);
    } else if (text_equal(word, "end_header")) {
        return false;
    } else if (!text_equal(word, "obj_info") && !text_starts(line, "Created by ")) { /* Blender 2.47 lacks "comment" */
        fail_header(ply, line, "not a word of PLY's header");
    }
    return true;
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
static void check_element(const struct ply *ply, const struct element *element)
{
    struct job *job = ply->sink->job;
    size_t least = ply->is_text && !element->properties ? 1 : 0;
    for (size_t i = 0; i < element->properties; i++) {
        const struct property *property = &ply->properties[element->first + i];
        least += ply->is_text ? 2 : types[property->count < PLY_NONE ? property->count : property->type].size;
    }
    if (element->kind == KIND_VERTEX &&
        (uses(ply, element, USE_X) != 1 || uses(ply, element, USE_Y) != 1 || uses(ply, element, USE_Z) != 1)) {
        job_bad(job, "header: a vertex has x, y and z, once each, and they are no lists");
    }
    if (element->kind == KIND_FACE && uses(ply, element, USE_CORNERS) != 1) {
        job_bad(job, "header: a face has one list vertex_indices");
    }
    if (least && element->count > scan_left(&ply->scan) / least + 1) {
        job_bad(job, "header: %zu elements of %zu bytes or more, %zu bytes follow", element->count, least,
                scan_left(&ply->scan));
    }
}

/* One element for the vertices, one for the faces, behind it. */
static void check_header(const struct ply *ply, bool has_format)
{
    struct job *job = ply->sink->job;
    size_t seen[KIND_OTHER] = {0};
    if (!has_format) {
        job_bad(job, "header: no format");
    }
    for (size_t i = 0; i < ply->element_count; i++) {
        const struct element *element = &ply->elements[i];
        check_element(ply, element);
        if (element->kind != KIND_OTHER && seen[element->kind]++) {
            job_bad(job, "header: element %s twice", element->kind == KIND_FACE ? "face" : "vertex");
        }
        if (element->kind == KIND_FACE && !seen[KIND_VERTEX]) {
            job_refuse(job, "header: element face before element vertex");
        }
    }
    if (!seen[KIND_FACE]) {
        job_bad(job, "header: no element face: points, not a surface");
    }
}

static void read_header(struct ply *ply)
{
    struct job *job = ply->sink->job;
    struct text line;
    bool has_format = false;
    if (!scan_line(&ply->scan, &line) || !text_equal(line, "ply")) {
        job_bad(job, "header: a PLY file begins with a line \"ply\"");
    }
    do {
        if (!scan_line(&ply->scan, &line)) {
            job_bad(job, "line %zu: header: the file ends before end_header", ply->scan.line);
            return;
        }
        has_format = has_format || text_starts(line, "format");
    } while (take_line(ply, line));
    check_header(ply, has_format);
}

static void fail_cut_off(const struct ply *ply)
{
    job_bad(ply->sink->job, "content: the file is cut off behind %zu vertices and %zu faces", ply->sink->vertices.count,
            sink_cell(ply->sink));
}

/* The next word as a number; of a float, which is rounded once from the text, *rounded_once gets it. */
static double next_word(struct ply *ply, float *rounded_once)
{
    struct text word;
    double value = 0;
    if (!scan_word(&ply->scan, &word)) {
        fail_cut_off(ply);
    } else if (rounded_once && text_to_float(word, rounded_once)) {
        return 0;
    } else if (!text_to_double(word, &value)) {
        scan_refuse(&ply->scan, word, "a number");
    }
    if (rounded_once) {
        *rounded_once = (float)value;
    }
    return value;
}

static double next_number(struct ply *ply, enum ply_type type)
{
    if (ply->is_text) {
        return next_word(ply, NULL);
    }
    const size_t size = types[type].size;
    const bool swapped = ply->scan.r.swapped;
    const uint8_t *data = scan_bytes(&ply->scan, size);
    if (!data) {
        fail_cut_off(ply);
        return 0;
    }
    bool is_signed = type == PLY_INT8 || type == PLY_INT16 || type == PLY_INT32 || type == PLY_INT64;
    return type >= PLY_FLOAT32 ? order_real(data, size, swapped) : (double)order_whole(data, size, is_signed, swapped);
}

static float next_coordinate(struct ply *ply, enum ply_type type)
{
    float value;
    if (!ply->is_text) {
        return (float)next_number(ply, type);
    }
    (void)next_word(ply, &value);
    return value;
}

/* Whole numbers of 53 bits; others become -1, which is no vertex. */
static int64_t whole_of(double value)
{
    return fabs(value) < 0x1p53 && value == floor(value) ? (int64_t)value : -1;
}

static void take_list(struct ply *ply, const struct property *property)
{
    struct job *job = ply->sink->job;
    const double length = next_number(ply, property->count);
    const int64_t count = whole_of(length);
    const size_t least = ply->is_text ? 2 : types[property->type].size;
    if (count < 0 || (uint64_t)count > scan_left(&ply->scan) / least + 1) {
        job_bad(job, "face %zu: a list of %g numbers, %zu bytes follow", sink_cell(ply->sink), length,
                scan_left(&ply->scan));
    } else if (property->use == USE_NOTHING && !ply->is_text) {
        if (!scan_bytes(&ply->scan, (size_t)count * least)) {
            fail_cut_off(ply);
        }
        return;
    }
    for (int64_t i = 0; i < count && job_ok(job); i++) {
        const double value = next_number(ply, property->type);
        if (property->use == USE_CORNERS) {
            sink_corner(ply->sink, whole_of(value));
        }
    }
}

static void take_row(struct ply *ply, const struct element *element)
{
    float position[3] = {0};
    for (size_t i = 0; i < element->properties; i++) {
        const struct property *property = &ply->properties[element->first + i];
        if (property->count != PLY_NONE) {
            take_list(ply, property);
        } else if (property->use <= USE_Z) {
            position[property->use] = next_coordinate(ply, property->type);
        } else {
            (void)next_number(ply, property->type);
        }
    }
    if (element->kind == KIND_VERTEX) {
        sink_vertex(ply->sink, position);
    } else if (element->kind == KIND_FACE) {
        sink_end(ply->sink, CELL_POLYGON);
    }
}

void ply_parse(struct mesh_sink *sink, struct text file)
{
    struct job *job = sink->job;
    struct ply *ply = job_new(job, struct ply);
    if (!ply) {
        return;
    }
    ply->scan = scan_of(job, file);
    ply->sink = sink;
    read_header(ply);
    for (size_t i = 0; i < ply->element_count && job_ok(job); i++) {
        const struct element *element = &ply->elements[i];
        if (element->kind == KIND_VERTEX) {
            sink_expect(sink, element->count);
        }
        for (size_t row = 0; element->properties && row < element->count && job_ok(job); row++) {
            take_row(ply, element);
        }
    }
    if (!ply->is_text && scan_left(&ply->scan)) {
        job_bad(job, "content: %zu bytes behind the last element", scan_left(&ply->scan));
    }
    scan_end(&ply->scan, "the last element");
}
