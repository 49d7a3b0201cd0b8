/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses what a file in VTK's legacy format says of its points and cells. */
#include "base/memory.h"
#include "loaders/surfaces/foreign/vtk_stream.h"

#include <string.h>

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

static conus_status skip_numbers(struct vtk *vtk, const struct vtk_type *type, size_t count)
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

static int hex_value(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* A name's spaces and such are written as "%20". */
static struct text decode_name(char *out, size_t size, struct text name)
{
    size_t length = 0;
    for (size_t i = 0; i < name.size && length < size; i++) {
        int high = i + 2 < name.size && name.data[i] == '%' ? hex_value(name.data[i + 1]) : -1;
        int low = high >= 0 ? hex_value(name.data[i + 2]) : -1;
        out[length++] = low >= 0 ? (char)(16 * high + low) : name.data[i];
        i += low >= 0 ? 2 : 0;
    }
    return (struct text){out, length};
}

/* Keeps the numbers of lines of those of all cells. */
static conus_status cut_cells(struct foreign_array *array, const struct foreign_lines *lines)
{
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

/* Keeps the numbers that are next: `tuples` of `parts`. */
static conus_status keep_numbers(struct vtk *vtk, struct text name, const struct vtk_type *type, size_t parts,
                                 size_t tuples)
{
    char decoded[NAME_LIMIT];
    struct foreign_array *array = NULL;
    size_t count = 0;
    size_t least = vtk->is_text ? 2 : type->bits / 8;
    bool fits = memory_multiply(parts, tuples, &count) && count <= vtk->words.rest.size / least + 1;
    conus_status status = foreign_lines_array(&array, vtk->mesh->lines, decode_name(decoded, sizeof decoded, name),
                                              vtk->place == VTK_OF_POINTS, parts);
    if (!status && (array->values || !fits)) {
        status = fail(CONUS_ERROR_DATA, "%s: %s", array->name, fits ? "twice" : "the file is cut off");
    }
    status = status ? status : foreign_array_reserve(vtk->mesh->lines, array, count);
    for (size_t i = 0; !status && i < count; i++) {
        status = vtk_next_number(&array->values[i], vtk, type, array->name);
    }
    if (!status) {
        array->count = count;
        status = vtk->place == VTK_OF_CELLS ? cut_cells(array, vtk->mesh->lines) : CONUS_OK;
    }
    return status;
}

static conus_status take_numbers(struct vtk *vtk, struct text name, const struct vtk_type *type, size_t parts,
                                 size_t tuples)
{
    size_t count = 0;
    if (vtk->place != VTK_OF_NOTHING && type->bits >= 8) {
        return keep_numbers(vtk, name, type, parts, tuples);
    }
    return memory_multiply(parts, tuples, &count) ? skip_numbers(vtk, type, count) : vtk_fail_cut_off("FIELD");
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
    conus_status status = words_count(&parts, &vtk->words, 1, "FIELD");
    status = status ? status : words_count(&tuples, &vtk->words, 1, "FIELD");
    if (!status && !memory_multiply(parts, tuples, &count)) {
        status = vtk_fail_cut_off("FIELD");
    }
    bool strings = !status && words_take(&vtk->words, "string");
    status = status || strings ? status : vtk_need_type(&type, vtk);
    status = status ? status : vtk_end_line(vtk);
    return status ? status : strings ? skip_strings(vtk, count) : take_numbers(vtk, name, type, parts, tuples);
}

conus_status vtk_skip_metadata(struct vtk *vtk)
{
    struct text line = {0};
    bool there = words_line(&vtk->words, &line); /* what is left of its own */
    while (there && words_line(&vtk->words, &line) && text_trim(line).size) {
    }
    return CONUS_OK;
}

conus_status vtk_take_field(struct vtk *vtk)
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

/* Of colours: text has numbers from 0 to 1, and binary files bytes. */
static const struct vtk_type *colour_type(const struct vtk *vtk)
{
    static const struct vtk_type number = {"float", 32, VTK_REAL};
    static const struct vtk_type byte = {"unsigned_char", 8, VTK_UNSIGNED};
    return vtk->is_text ? &number : &byte;
}

/* What VTK knows by a word of its own. */
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

/* The line behind the word: name, type, and in some the number of parts, before or behind it. */
static conus_status read_attribute_line(const struct vtk_type **type, size_t *parts, struct vtk *vtk,
                                        const struct attribute *attribute)
{
    bool is_scalars = is_named(attribute, "SCALARS");
    bool is_colour = is_named(attribute, "COLOR_SCALARS");
    struct text word;
    int64_t count = (int64_t)attribute->parts;
    conus_status status = CONUS_OK;
    if (!attribute->parts && !is_scalars) {
        status = words_whole(&count, &vtk->words, 1, attribute->word);
    }
    if (!status && !is_colour) {
        status = vtk_need_type(type, vtk);
    }
    struct words ahead = vtk->words;
    if (!status && is_scalars) {
        size_t line = ahead.line;
        bool given = words_next(&ahead, &word) && ahead.line == line && text_to_int(word, &count);
        count = given ? count : 1;
        vtk->words = given ? ahead : vtk->words;
    }
    *parts = status ? 0 : (size_t)(count > 0 ? count : 0);
    *type = is_colour ? colour_type(vtk) : *type;
    status = status ? status : vtk_end_line(vtk);
    if (!status && is_scalars && words_take(&vtk->words, "LOOKUP_TABLE")) {
        status = words_next(&vtk->words, &word) ? vtk_end_line(vtk) : words_fail(&vtk->words, word, "a name");
    }
    return status;
}

static conus_status read_lookup_table(struct vtk *vtk, const struct vtk_type *type)
{
    size_t count = 0;
    conus_status status = words_count(&count, &vtk->words, 1, "LOOKUP_TABLE");
    status = status ? status : vtk_end_line(vtk);
    return status ? status : skip_numbers(vtk, type, 4 * count);
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
    if (is_named(attribute, "LOOKUP_TABLE")) {
        return read_lookup_table(vtk, colour_type(vtk));
    }
    conus_status status = read_attribute_line(&type, &parts, vtk, attribute);
    return status ? status : take_numbers(vtk, name, type, parts, count);
}

/* Of how many points or cells; what each array needs is compared with the file. */
static conus_status read_data_count(size_t *out, struct vtk *vtk)
{
    int64_t count = 0;
    conus_status status = words_whole(&count, &vtk->words, 0, "POINT_DATA or CELL_DATA");
    *out = (size_t)count;
    return status;
}

conus_status vtk_read_numbers(struct vtk *vtk)
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
