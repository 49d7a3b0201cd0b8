/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses VTK's legacy format: lines, polygons and strips of triangles, and on request lines and numbers of points and
 * lines. */
#include "loaders/surfaces/foreign/foreign.h"

#include "base/formats/encoding.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/surfaces/foreign/parts.h"

#include <string.h>

struct vtk {
    struct scan scan;
    struct mesh_sink *sink;
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

/* Takes the name of a type. After a failure it is any. */
static const struct vtk_type *need_type(struct vtk *vtk)
{
    struct text word;
    (void)scan_word(&vtk->scan, &word);
    const struct vtk_type *type = ROW_NAMED(types, word, false);
    if (!type) {
        scan_refuse(&vtk->scan, word, "a type of numbers");
    }
    return type ? type : types;
}

/* Binary numbers begin behind the line, those of text behind white space. */
static void end_line(struct vtk *vtk)
{
    struct text line;
    if (!vtk->is_text && scan_line(&vtk->scan, &line) && text_trim(line).size) {
        vtk->scan.line--;
        scan_refuse(&vtk->scan, text_trim(line), "the end of the line");
    }
}

static int64_t whole_at(const uint8_t *data, const struct vtk_type *type)
{
    return order_whole(data, type->bits / 8, type->kind == VTK_INTEGER, BIG_ENDIAN_IS_SWAPPED);
}

static void fail_cut_off(struct vtk *vtk, const char *what)
{
    job_bad(vtk->sink->job, "%s: the file is cut off", what);
}

/* The next bytes of a binary file, of `what`; NULL after a failure. */
static const uint8_t *take_bytes(struct vtk *vtk, size_t size, const char *what)
{
    const uint8_t *data = scan_bytes(&vtk->scan, size);
    if (!data) {
        fail_cut_off(vtk, what);
    }
    return data;
}

static int64_t next_whole(struct vtk *vtk, const struct vtk_type *type, const char *what)
{
    if (vtk->is_text) {
        return scan_whole(&vtk->scan, INT64_MIN, what);
    }
    const uint8_t *data = take_bytes(vtk, type->bits / 8, what);
    return data ? whole_at(data, type) : 0;
}

/* The next number, rounded once. A coordinate (VTK_OF_NOTHING) is finite where it is text. */
static float next_number(struct vtk *vtk, const struct vtk_type *type, const char *what)
{
    if (vtk->is_text) {
        return vtk->place == VTK_OF_NOTHING ? scan_float(&vtk->scan, "a coordinate")
                                            : scan_any_float(&vtk->scan, "a number");
    }
    const uint8_t *data = take_bytes(vtk, type->bits / 8, what);
    return !data                    ? 0
           : type->kind != VTK_REAL ? (float)whole_at(data, type)
                                    : (float)order_real(data, type->bits / 8, BIG_ENDIAN_IS_SWAPPED);
}

static void skip_strings(struct vtk *vtk, size_t count)
{
    struct text line;
    if (!vtk->is_text) {
        job_refuse(vtk->sink->job, "FIELD: texts in a binary file");
    }
    (void)scan_line(&vtk->scan, &line); /* the rest of the array's own */
    for (size_t i = 0; i < count && job_ok(vtk->sink->job); i++) {
        if (!scan_line(&vtk->scan, &line)) {
            fail_cut_off(vtk, "FIELD");
        }
    }
}

static void skip_numbers(struct vtk *vtk, const struct vtk_type *type, size_t parts, size_t tuples)
{
    struct text word;
    size_t count;
    size_t bits;
    if (!memory_multiply(parts, tuples, &count) || !memory_multiply(count, type->bits, &bits)) {
        fail_cut_off(vtk, "FIELD");
    } else if (!vtk->is_text) {
        (void)take_bytes(vtk, bits / 8 + (bits % 8 > 0), "FIELD");
    } else {
        for (size_t i = 0; i < count && job_ok(vtk->sink->job); i++) {
            if (!scan_word(&vtk->scan, &word)) {
                fail_cut_off(vtk, "FIELD");
            }
        }
    }
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

/* Of the numbers of all cells the array keeps those of the lines. */
static void cut_to_lines(struct vtk *vtk, struct sink_array *array)
{
    const size_t *cells = vtk->sink->cells;
    const size_t lines = cells[CELL_LINE];
    const size_t all = cells[CELL_POINTS] + lines + cells[CELL_POLYGON] + cells[CELL_STRIP];
    if (array->count / array->components != all) {
        job_bad(vtk->sink->job, "%s: of %zu cells, there are %zu", array->name, array->count / array->components, all);
        return;
    }
    array->count = lines * array->components;
    if (array->count) {
        memmove(array->values, &array->values[cells[CELL_POINTS] * array->components],
                array->count * sizeof *array->values);
    }
}

static void keep_numbers(struct vtk *vtk, struct text name, const struct vtk_type *type, size_t parts, size_t tuples)
{
    enum { NAME_LIMIT = 1024 };
    struct job *job = vtk->sink->job;
    char decoded[NAME_LIMIT];
    size_t count = 0;
    size_t least = vtk->is_text ? 2 : type->bits / 8;
    bool fits = memory_multiply(parts, tuples, &count) && count <= scan_left(&vtk->scan) / least + 1;
    struct sink_array *array =
        sink_array(vtk->sink, decode_name(decoded, sizeof decoded, name), vtk->place == VTK_OF_POINTS, parts);
    if (!array) {
        return;
    }
    if (array->values || !fits) {
        job_bad(job, "%s: %s", array->name, fits ? "twice" : "the file is cut off");
        return;
    }
    float *values = sink_array_grow(vtk->sink, array, count);
    for (size_t i = 0; values && i < count && job_ok(job); i++) {
        values[i] = next_number(vtk, type, array->name);
    }
    if (vtk->place == VTK_OF_CELLS && job_ok(job)) {
        cut_to_lines(vtk, array);
    }
}

static void take_numbers(struct vtk *vtk, struct text name, const struct vtk_type *type, size_t parts, size_t tuples)
{
    if (vtk->place != VTK_OF_NOTHING && type->bits >= 8) {
        keep_numbers(vtk, name, type, parts, tuples);
    } else {
        skip_numbers(vtk, type, parts, tuples);
    }
}

static struct text need_name(struct vtk *vtk, const char *what)
{
    struct text name;
    if (!scan_word(&vtk->scan, &name)) {
        scan_refuse(&vtk->scan, name, what);
    }
    return name;
}

/* Name, numbers in a tuple, tuples, type. */
static void take_array(struct vtk *vtk)
{
    const struct text name = need_name(vtk, "the name of an array");
    const size_t parts = scan_count(&vtk->scan, 1, "FIELD");
    const size_t tuples = scan_count(&vtk->scan, 1, "FIELD");
    size_t count = 0;
    if (!memory_multiply(parts, tuples, &count)) {
        fail_cut_off(vtk, "FIELD");
    }
    bool strings = scan_take(&vtk->scan, "string");
    const struct vtk_type *type = strings ? NULL : need_type(vtk);
    end_line(vtk);
    if (!job_ok(vtk->sink->job)) {
        return;
    }
    if (strings) {
        skip_strings(vtk, count);
    } else {
        take_numbers(vtk, name, type, parts, tuples);
    }
}

static void skip_metadata(struct vtk *vtk)
{
    struct text line;
    bool there = scan_line(&vtk->scan, &line); /* what is left of its own */
    while (there && scan_line(&vtk->scan, &line) && text_trim(line).size) {
    }
}

/* Reads a field, behind its word. Arrays of points or cells are kept, others passed over. */
static void take_field(struct vtk *vtk)
{
    (void)need_name(vtk, "the name of a field");
    const size_t arrays = scan_count(&vtk->scan, 1, "FIELD");
    for (size_t i = 0; i < arrays && job_ok(vtk->sink->job); i++) {
        take_array(vtk);
        if (scan_take(&vtk->scan, "METADATA")) {
            skip_metadata(vtk);
        }
    }
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

static bool is_named(const struct attribute *attribute, const char *word)
{
    return strcmp(attribute->word, word) == 0;
}

/* The number of parts of SCALARS may be missing, then it is 1, and the name of a table of colours may follow. */
static size_t read_scalar_parts(struct vtk *vtk)
{
    struct scan ahead = vtk->scan;
    struct text word;
    int64_t count;
    bool given = scan_word(&ahead, &word) && ahead.line == vtk->scan.line && text_to_int(word, &count);
    vtk->scan = given ? ahead : vtk->scan;
    end_line(vtk);
    if (scan_take(&vtk->scan, "LOOKUP_TABLE")) {
        (void)need_name(vtk, "a name");
        end_line(vtk);
    }
    return !given ? 1 : count > 0 ? (size_t)count : 0;
}

/* `count` points or cells. The line behind the word has a name, a type, and in some files the number of parts, before
 * or behind the type. */
static void read_attribute(struct vtk *vtk, const struct attribute *attribute, size_t count)
{
    bool is_scalars = is_named(attribute, "SCALARS");
    bool is_colour = is_named(attribute, "COLOR_SCALARS");
    size_t parts = attribute->parts;
    const struct text name = need_name(vtk, "the name of an array");
    if (is_named(attribute, "LOOKUP_TABLE")) {
        const size_t colours = scan_count(&vtk->scan, 1, "LOOKUP_TABLE");
        end_line(vtk);
        skip_numbers(vtk, colour_type(vtk), 4, colours);
        return;
    }
    if (!parts && !is_scalars) {
        parts = (size_t)scan_whole(&vtk->scan, 1, attribute->word);
    }
    const struct vtk_type *type = is_colour ? colour_type(vtk) : need_type(vtk);
    if (is_scalars) {
        parts = read_scalar_parts(vtk);
    } else {
        end_line(vtk);
    }
    if (job_ok(vtk->sink->job)) {
        take_numbers(vtk, name, type, parts, count);
    }
}

/* The number of points or cells. The size of each array is compared with the file later. */
static size_t read_data_count(struct vtk *vtk)
{
    return (size_t)scan_whole(&vtk->scan, 0, "POINT_DATA or CELL_DATA");
}

/* Reads numbers of points and cells, from the count behind POINT_DATA or CELL_DATA to the end of the file. */
static void read_numbers(struct vtk *vtk)
{
    struct text word;
    size_t count = read_data_count(vtk);
    while (scan_word(&vtk->scan, &word)) {
        const struct attribute *attribute = ROW_NAMED(attributes, word, false);
        bool points = text_equal_ignoring_case(word, "POINT_DATA");
        if (attribute) {
            read_attribute(vtk, attribute, count);
        } else if (points || text_equal_ignoring_case(word, "CELL_DATA")) {
            vtk->place = points ? VTK_OF_POINTS : VTK_OF_CELLS;
            count = read_data_count(vtk);
        } else if (text_equal_ignoring_case(word, "FIELD")) {
            take_field(vtk);
        } else if (text_equal_ignoring_case(word, "METADATA")) {
            skip_metadata(vtk);
        } else {
            scan_refuse(&vtk->scan, word, "SCALARS, FIELD or another kind of numbers");
        }
    }
}

static void read_points(struct vtk *vtk)
{
    struct job *job = vtk->sink->job;
    if (vtk->has_points) {
        job_bad(job, "POINTS: twice");
    }
    vtk->has_points = true;
    const size_t count = scan_count(&vtk->scan, 3, "POINTS");
    const struct vtk_type *type = need_type(vtk);
    end_line(vtk);
    if (type->bits < 8) {
        job_refuse(job, "POINTS: of type bit");
        return;
    }
    size_t least = vtk->is_text ? 6 : 3 * type->bits / 8; /* in text a digit and a space each */
    if (count > scan_left(&vtk->scan) / least + 1) {
        job_bad(job, "POINTS: %zu, more than the %zu bytes that follow can hold", count, scan_left(&vtk->scan));
    }
    sink_expect(vtk->sink, count);
    for (size_t i = 0; i < count && job_ok(job); i++) {
        float position[3];
        for (int a = 0; a < 3; a++) {
            position[a] = next_number(vtk, type, "POINTS");
        }
        sink_vertex(vtk->sink, position);
    }
}

static void take_cell(struct vtk *vtk, int64_t count, const struct vtk_type *type, enum cell cell, const char *what)
{
    bool are_wanted = cell > CELL_LINE || (cell == CELL_LINE && vtk->sink->takes_lines);
    for (int64_t k = 0; k < count && job_ok(vtk->sink->job); k++) {
        const int64_t index = next_whole(vtk, type, what);
        if (are_wanted) {
            sink_corner(vtk->sink, index);
        }
    }
    sink_end(vtk->sink, cell);
}

/* `count` cells, each as the number of its corners and the corners; `size` numbers in all. */
static void read_counted(struct vtk *vtk, size_t count, size_t size, enum cell cell, const char *what)
{
    static const struct vtk_type number = {"int", 32, VTK_INTEGER};
    struct job *job = vtk->sink->job;
    end_line(vtk);
    for (size_t i = 0; i < count && job_ok(job); i++) {
        const int64_t corners = next_whole(vtk, &number, what);
        if (size == 0 || corners < 0 || (uint64_t)corners > size - 1) {
            job_bad(job, "%s: cell %zu has %lld corners, %zu numbers are left", what, i, (long long)corners, size);
            return;
        }
        take_cell(vtk, corners, &number, cell, what);
        size -= 1 + (size_t)corners;
    }
    if (size) {
        job_bad(job, "%s: %zu numbers more than its %zu cells have", what, size, count);
    }
}

static const struct vtk_type *begin_array(struct vtk *vtk, const char *name)
{
    scan_need(&vtk->scan, name, name);
    const struct vtk_type *type = need_type(vtk);
    if (type->bits < 8 || type->kind == VTK_REAL) {
        job_bad(vtk->sink->job, "%s: of type %s, a whole number is needed", name, type->name);
    }
    end_line(vtk);
    return type;
}

/* Version 5: `count` offsets, of which the first is 0 and the last `size`, then `size` corners. Both are read side by
 * side. */
static void read_offset_cells(struct vtk *vtk, size_t count, size_t size, enum cell cell, const char *what)
{
    struct job *job = vtk->sink->job;
    const struct vtk_type *offset_type = begin_array(vtk, "OFFSETS");
    struct vtk offsets = *vtk;
    int64_t offset = 0;
    for (size_t i = 0; i < count && job_ok(job); i++) { /* to where the corners begin */
        const int64_t next = next_whole(vtk, offset_type, "OFFSETS");
        if (next < offset || (uint64_t)next > size || (i == 0 && next) || (i + 1 == count && (uint64_t)next != size)) {
            job_bad(job, "OFFSETS: number %zu is %lld, they rise from 0 to %zu", i, (long long)next, size);
        }
        offset = next;
    }
    const struct vtk_type *corner_type = begin_array(vtk, "CONNECTIVITY");
    offset = 0;
    for (size_t i = 0; i < count && job_ok(job); i++) {
        const int64_t next = next_whole(&offsets, offset_type, "OFFSETS");
        if (i > 0) {
            take_cell(vtk, next - offset, corner_type, cell, what);
        }
        offset = next;
    }
}

static void read_cells(struct vtk *vtk, enum cell cell, const char *what)
{
    const size_t count = scan_count(&vtk->scan, 1, what);
    const size_t size = scan_count(&vtk->scan, 1, what);
    if (!vtk->has_offsets) {
        read_counted(vtk, count, size, cell, what);
    } else if (count) {
        read_offset_cells(vtk, count, size, cell, what);
    } else if (size) {
        job_bad(vtk->sink->job, "%s: %zu corners without a cell", what, size);
    }
}

/* False behind the last section. Numbers of points and cells, which reach to the end of the file, are read only where
 * lines are wanted. */
static bool read_section(struct vtk *vtk)
{
    static const struct section {
        const char *word;
        enum cell cell;
    } sections[] = {
        {"VERTICES", CELL_POINTS}, {"LINES", CELL_LINE}, {"POLYGONS", CELL_POLYGON}, {"TRIANGLE_STRIPS", CELL_STRIP}};
    struct text word;
    if (!scan_word(&vtk->scan, &word)) {
        return false;
    }
    const struct section *section = ROW_NAMED(sections, word, false);
    if (section) {
        read_cells(vtk, section->cell, section->word);
        return true;
    }
    bool points = text_equal_ignoring_case(word, "POINT_DATA");
    if (points || text_equal_ignoring_case(word, "CELL_DATA")) {
        vtk->place = points ? VTK_OF_POINTS : VTK_OF_CELLS;
        if (vtk->sink->takes_lines) {
            read_numbers(vtk);
        }
        return false;
    }
    if (text_equal_ignoring_case(word, "POINTS")) {
        read_points(vtk);
    } else if (text_equal_ignoring_case(word, "FIELD")) {
        take_field(vtk);
    } else if (text_equal_ignoring_case(word, "METADATA")) {
        skip_metadata(vtk);
    } else {
        scan_refuse(&vtk->scan, word, "POINTS, POLYGONS, TRIANGLE_STRIPS or another section");
    }
    return true;
}

static void read_header(struct vtk *vtk)
{
    static const char magic[] = "# vtk DataFile Version ";
    struct job *job = vtk->sink->job;
    struct text line;
    struct text word;
    double version = 0;
    bool there = scan_line(&vtk->scan, &line) && text_starts(line, magic);
    struct text number = there ? text_trim((struct text){line.data + sizeof magic - 1, line.size - (sizeof magic - 1)})
                               : (struct text){0};
    if (!text_to_double(number, &version) || !(version >= 1 && version < 6)) {
        job_refuse(job, "header: version \"%.*s\", allowed are 1.0 to 5.1", TEXT_SHOW(number, 60));
    }
    vtk->has_offsets = version >= 5;
    if (scan_line(&vtk->scan, &line)) {
        sink_said(vtk->sink, line);
    }
    vtk->is_text = scan_take(&vtk->scan, "ASCII");
    if (!vtk->is_text) {
        scan_need(&vtk->scan, "BINARY", "ASCII or BINARY");
    }
    if (scan_take(&vtk->scan, "FIELD")) {
        take_field(vtk);
    }
    scan_need(&vtk->scan, "DATASET", "DATASET");
    if (!scan_take(&vtk->scan, "POLYDATA")) {
        (void)scan_word(&vtk->scan, &word);
        job_refuse(job, "DATASET: found \"%.*s\", only POLYDATA is a surface or lines", TEXT_SHOW(word, 60));
    }
}

void vtk_parse(struct mesh_sink *sink, struct text file)
{
    struct vtk vtk = {.scan = scan_of(sink->job, file), .sink = sink};
    read_header(&vtk);
    while (read_section(&vtk)) {
    }
}
