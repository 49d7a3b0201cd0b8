/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses MAT-files of either level: the variables, then their parts, each where the array around it is parsed. */
#include "base/formats/matlab.h"

#include "base/byte_order.h"
#include "base/formats/packed.h"
#include "base/memory.h"

#include <stdio.h>

enum { HEADER = 128, TAG = 8, SMALL = 4, DEPTH_LIMIT = 32, DIMENSION_LIMIT = 32 };

/* Types of elements. */
enum {
    INT8 = 1,
    UINT8,
    INT16,
    UINT16,
    INT32,
    UINT32,
    SINGLE,
    DOUBLE = 9,
    INT64 = 12,
    UINT64,
    MATRIX,
    COMPRESSED,
    UTF8,
    UTF16,
    TYPES
};

/* Bytes of a value; 0 where a type is no value that is read. */
static const uint8_t value_size[TYPES] = {
    [INT8] = 1,   [UINT8] = 1,  [INT16] = 2, [UINT16] = 2, [INT32] = 4, [UINT32] = 4,
    [SINGLE] = 4, [DOUBLE] = 8, [INT64] = 8, [UINT64] = 8, [UTF8] = 1,  [UTF16] = 2};

struct element {
    uint32_t type;
    struct text bytes;
};

static const uint8_t *at(struct text text)
{
    return (const uint8_t *)text.data;
}

static struct text rest_of(struct text text, size_t used)
{
    return (struct text){text.data + used, text.size - used};
}

/* MATLAB of 2008 wrote 7.0. */
static bool is_level_7(struct text text)
{
    return text_starts(text, "MATLAB 7.3 MAT-file") || text_starts(text, "MATLAB 7.0 MAT-file");
}

bool matlab_is(struct text text)
{
    return text_starts(text, "MATLAB 5.0 MAT-file") || is_level_7(text);
}

/* Takes an element off: a tag of eight bytes and its data, padded to a multiple of eight unless they are packed; or
 * both in eight bytes. */
static struct element take_element(struct job *job, struct text *rest, bool swapped)
{
    const struct element none = {.bytes = {"", 0}};
    if (rest->size < TAG) {
        job_bad(job, "cut off: %zu bytes where an element begins, %d are needed", rest->size, TAG);
        return none;
    }
    uint32_t type = order_u32(at(*rest), swapped);
    uint32_t size = order_u32(at(*rest) + SMALL, swapped);
    bool is_small = type >> 16;
    size = is_small ? type >> 16 : size;
    size_t left = is_small ? SMALL : rest->size - TAG;
    if (size > left) {
        job_bad(job, "an element of %u bytes, where there are %zu", size, left);
        return none;
    }
    const struct element out = {is_small ? type & 0xffff : type, {rest->data + (is_small ? SMALL : TAG), size}};
    size_t padded = type == COMPRESSED ? size : ((size_t)size + 7) & ~(size_t)7;
    *rest = rest_of(*rest, is_small ? TAG : TAG + (padded < left ? padded : left));
    return out;
}

/* Some programs write dimensions as UINT32, and names as UTF8; the bytes are the same. */
static struct text take_typed(struct job *job, struct text *rest, bool swapped, uint32_t type, const char *what)
{
    const struct element element = take_element(job, rest, swapped);
    if (element.type != type && !(type == INT32 && element.type == UINT32) && !(type == INT8 && element.type == UTF8)) {
        job_bad(job, "%s: an element of type %u, %u is needed", what, element.type, type);
    }
    return job_ok(job) ? element.bytes : (struct text){"", 0};
}

static void use_memory(struct job *job, struct matlab *matlab, uint64_t bytes)
{
    if (bytes > matlab->limit - matlab->used) {
        job_fail(job, CONUS_ERROR_MEMORY,
                 "MATLAB's file needs more than the %llu bytes that are allowed; see --max-memory",
                 (unsigned long long)matlab->limit);
    } else {
        matlab->used += bytes;
    }
}

/* @p count arrays more, side by side, that are still to be parsed. */
static void add_arrays(struct job *job, struct matlab *matlab, size_t count)
{
    size_t bytes = 0;
    if (!memory_multiply(count, sizeof *matlab->arrays, &bytes)) {
        job_fail(job, CONUS_ERROR_MEMORY, "too many arrays");
    }
    use_memory(job, matlab, bytes);
    if (matlab->capacity - matlab->count < count) {
        const size_t wanted = 2 * matlab->capacity + count;
        struct matlab_array *arrays = job_grow(job, matlab->arrays, wanted, sizeof *arrays);
        matlab->arrays = arrays ? arrays : matlab->arrays;
        matlab->capacity = arrays ? wanted : matlab->capacity;
    }
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        matlab->arrays[matlab->count++] = (struct matlab_array){0};
    }
}

static void take_flags(struct job *job, struct matlab_array *array, struct text *rest)
{
    const struct text flags = take_typed(job, rest, array->swapped, UINT32, "flags of an array");
    if (flags.size != 8) {
        job_bad(job, "flags of an array: %zu bytes, 8 are needed", flags.size);
        return;
    }
    enum { COMPLEX = 0x800 };
    uint32_t word = order_u32(at(flags), array->swapped);
    uint32_t kind = word & 0xff;
    bool is_read = kind == MATLAB_CELL || kind == MATLAB_STRUCT || kind == MATLAB_CHAR ||
                   (kind >= MATLAB_DOUBLE && kind <= MATLAB_UINT64);
    array->kind = is_read ? (enum matlab_class)kind : MATLAB_OTHER;
    array->is_complex = word & COMPLEX;
}

static void take_dimensions(struct job *job, struct matlab_array *array, struct text *rest)
{
    const struct text bytes = take_typed(job, rest, array->swapped, INT32, "dimensions of an array");
    if (bytes.size % 4 || bytes.size < 8 || bytes.size > (size_t)4 * DIMENSION_LIMIT) {
        job_bad(job, "dimensions of an array: %zu bytes, allowed are 2 to %d numbers of 4", bytes.size,
                DIMENSION_LIMIT);
    }
    array->count = 1;
    for (size_t i = 0; job_ok(job) && i < bytes.size / 4; i++) {
        int32_t length = order_i32(at(bytes) + 4 * i, array->swapped);
        if (length < 0 || !memory_multiply(array->count, (size_t)length, &array->count)) {
            job_bad(job, "dimensions of an array: %d is number %zu of them", length, i + 1);
        }
        array->rows = i == 0 ? (size_t)length : array->rows;
        array->columns = i == 1 ? (size_t)length : array->columns;
    }
}

/* Values of numbers: as many as the dimensions say. Of characters in UTF-8 there may be more bytes; and an empty text
 * may have any dimensions. */
static void take_values(struct job *job, struct matlab_array *array, struct text *rest)
{
    size_t bytes;
    const struct element element = take_element(job, rest, array->swapped);
    uint8_t size = element.type < TYPES ? value_size[element.type] : 0;
    if (!size || (array->kind != MATLAB_CHAR && element.type >= UTF8)) {
        job_bad(job, "%s has values of type %u", matlab_class_name(array).text, element.type);
    }
    bool fits = memory_multiply(array->count, size, &bytes) && bytes == element.bytes.size;
    bool is_free = array->kind == MATLAB_CHAR && (element.type == UTF8 || !element.bytes.size);
    if (!fits && !is_free) {
        job_bad(job, "%s of %zu values has %zu bytes, %u each are needed", matlab_class_name(array).text, array->count,
                element.bytes.size, size);
    }
    array->type = (uint8_t)element.type;
    array->bytes = element.bytes;
}

/* Parses each part, an element of its own with at least a tag, in turn. `names` are the names of a structure's fields.
 */
static void take_parts(struct job *job, struct matlab *matlab, size_t index, struct text *rest, struct text names)
{
    struct matlab_array array = matlab->arrays[index];
    size_t name_size = array.fields ? names.size / array.fields : 0;
    size_t count = array.count;
    bool fits = array.kind == MATLAB_CELL || memory_multiply(array.count, array.fields, &count);
    if (!fits || count > rest->size / TAG) {
        job_bad(job, "%s of %zu elements in %zu bytes", matlab_class_name(&array).text, array.count, rest->size);
    }
    if (array.depth == DEPTH_LIMIT) {
        job_bad(job, "arrays in arrays, more than %d deep", DEPTH_LIMIT);
    }
    if (!job_ok(job)) {
        return;
    }
    matlab->arrays[index].parts = matlab->count;
    add_arrays(job, matlab, count);
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        struct matlab_array part = {.depth = (uint8_t)(array.depth + 1), .swapped = array.swapped};
        part.bytes = take_typed(job, rest, array.swapped, MATRIX, "a part of an array");
        part.name = (struct text){names.data + (name_size ? i % array.fields * name_size : 0), name_size};
        part.name.size = strnlen(part.name.data, name_size);
        matlab->arrays[matlab->count - count + i] = part;
    }
}

/* The names of fields, each in as many bytes, ended by a zero. */
static struct text take_field_names(struct job *job, struct matlab_array *array, struct text *rest)
{
    const struct text length = take_typed(job, rest, array->swapped, INT32, "length of names of fields");
    const int32_t size = length.size == 4 ? order_i32(at(length), array->swapped) : 0;
    const struct text names = take_typed(job, rest, array->swapped, INT8, "names of fields");
    if (size < 1 || names.size % (size_t)size) {
        job_bad(job, "names of fields: %zu bytes, of %d each", names.size, size);
    }
    array->fields = size > 0 && job_ok(job) ? names.size / (size_t)size : 0;
    return names;
}

/* An array is parsed from its bytes, which are then its values. */
static void parse_array(struct job *job, struct matlab *matlab, size_t index)
{
    struct matlab_array *array = &matlab->arrays[index];
    struct text rest = array->bytes;
    struct text names = {"", 0};
    array->bytes = names;
    array->name = array->depth ? array->name : names;
    if (!rest.size) {
        return; /* MATLAB_EMPTY */
    }
    take_flags(job, array, &rest);
    if (array->kind == MATLAB_OTHER) { /* of which nothing else is known */
        return;
    }
    take_dimensions(job, array, &rest);
    const struct text name = take_typed(job, &rest, array->swapped, INT8, "name of an array");
    array->name = array->depth ? array->name : name;
    if (array->kind == MATLAB_STRUCT) {
        names = take_field_names(job, array, &rest);
    }
    if (array->kind == MATLAB_CELL || array->kind == MATLAB_STRUCT) {
        take_parts(job, matlab, index, &rest, names);
    } else {
        take_values(job, array, &rest);
    }
}

/* Whether numbers are in the other byte order. */
static bool check_header(struct job *job, struct text text)
{
    if (text.size < HEADER) {
        job_bad(job, "MATLAB's header: %zu bytes, %d are needed", text.size, HEADER);
        return false;
    }
    const uint8_t *end = at(text) + HEADER - 4; /* version and byte order, two bytes each */
    bool is_big = end[2] == 'M' && end[3] == 'I';
    if (!is_big && !(end[2] == 'I' && end[3] == 'M')) {
        job_bad(job, "MATLAB's header: byte order %02x %02x, allowed are IM and MI", end[2], end[3]);
    }
    bool swapped = is_big == BIG_ENDIAN_IS_SWAPPED;
    uint16_t version = order_u16(end, swapped);
    uint16_t wanted = is_level_7(text) ? 0x200 : 0x100;
    if (version != wanted) {
        job_bad(job, "MATLAB's header: version %#x, allowed is %#x", version, wanted);
    }
    return swapped;
}

/* The array that is packed in `packed`. */
static struct element unpack(struct job *job, struct matlab *matlab, struct text packed, bool swapped)
{
    struct bytes bytes = {0};
    if (JOB_CALL(job, gzip_unpack_zlib(&bytes, at(packed), packed.size, matlab->limit - matlab->used))) {
        uint8_t *less = memory_resize(bytes.data, bytes.size, 1); /* it was unpacked into more than it takes */
        bytes.data = less ? less : bytes.data;
        job_adopt(job, bytes.data);
    }
    struct text inner = {(const char *)bytes.data, job_ok(job) ? bytes.size : 0};
    use_memory(job, matlab, inner.size);
    const struct element element = take_element(job, &inner, swapped);
    if (inner.size) {
        job_bad(job, "%zu bytes behind the packed array", inner.size);
    }
    return element;
}

/* One variable, packed or not: its bytes as an array that is still to be parsed. */
static void take_variable(struct job *job, struct matlab *matlab, size_t index, struct text *rest, bool swapped)
{
    struct element element = take_element(job, rest, swapped);
    if (element.type == COMPRESSED) {
        element = unpack(job, matlab, element.bytes, swapped);
    }
    if (element.type != MATRIX) {
        job_bad(job, "an element of type %u, an array (%d) is needed", element.type, MATRIX);
    }
    matlab->arrays[index].swapped = swapped;
    matlab->arrays[index].bytes = element.bytes;
}

static void parse_level_5(struct job *job, struct matlab *matlab, struct text text, bool swapped)
{
    struct text rest = rest_of(text, HEADER);
    size_t count = 0; /* of elements, which are all variables */
    for (struct text ahead = rest; job_ok(job) && ahead.size; count++) {
        (void)take_element(job, &ahead, swapped);
    }
    matlab->variables = count;
    add_arrays(job, matlab, count);
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        char where[64];
        snprintf(where, sizeof where, "variable %zu of MATLAB's file", i + 1);
        const size_t place = job_in(job, where, JOB_ALONE);
        take_variable(job, matlab, i, &rest, swapped);
        job_out(job, place);
    }
    const size_t place = job_in(job, "MATLAB's file", JOB_ALONE);
    for (size_t i = 0; job_ok(job) && i < matlab->count; i++) { /* it grows on the way */
        parse_array(job, matlab, i);
    }
    job_out(job, place);
}

/* Level 7.3: arrays are HDF5's datasets and groups, which say in attributes what they are. */

static void fail_object(struct job *job, const struct hdf5_object *object, const char *what)
{
    job_bad(job, "%.*s: %s", TEXT_SHOW(object->value.name, 200U), what);
}

/* Sets what the array is by the name of its class; another class is an object. */
static void take_class(struct matlab_array *array, const struct hdf5_object *object)
{
    static const char *const classes[] = {[MATLAB_CELL] = "cell",
                                          [MATLAB_STRUCT] = "struct",
                                          [MATLAB_CHAR] = "char",
                                          [MATLAB_DOUBLE] = "double",
                                          "single",
                                          "int8",
                                          "uint8",
                                          "int16",
                                          "uint16",
                                          "int32",
                                          "uint32",
                                          "int64",
                                          [MATLAB_UINT64] = "uint64"};
    const struct hdf5_value *name = hdf5_attribute(object, "MATLAB_class");
    bool is_named = name && name->class == HDF5_STRING && name->count == 1;
    array->kind = MATLAB_OTHER;
    array->bytes = is_named ? hdf5_string(name, 0) : text_from("without a class");
    for (size_t i = 0; i < sizeof classes / sizeof classes[0]; i++) {
        array->kind = classes[i] && text_equal(array->bytes, classes[i]) ? (enum matlab_class)i : array->kind;
    }
    array->kind = text_equal(array->bytes, "logical") ? MATLAB_DOUBLE : array->kind;
    /* A group of numbers is a sparse array. */
    bool is_sparse = array->kind != MATLAB_STRUCT && object->value.class == HDF5_GROUP;
    array->kind = is_sparse ? MATLAB_OTHER : array->kind;
}

/* The dataset of an empty array holds its dimensions. */
static void take_empty(struct job *job, struct matlab_array *array, const struct hdf5_object *object)
{
    const struct hdf5_value *value = &object->value;
    bool fine = hdf5_is_number(value) && value->class != HDF5_FLOAT && value->count >= 2;
    bool is_empty = false;
    for (size_t i = 0; fine && i < value->count; i++) {
        int64_t length = hdf5_whole(value, i);
        fine = length >= 0;
        is_empty = is_empty || length == 0;
        array->rows = i == 0 ? (size_t)length : array->rows;
        array->columns = i == 1 ? (size_t)length : array->columns;
    }
    if (!fine || !is_empty) {
        fail_object(job, object, "MATLAB_empty, but its values are not the dimensions of none");
    }
}

/* MATLAB's first dimension is HDF5's last. */
static void take_dims(struct job *job, struct matlab_array *array, const struct hdf5_object *object)
{
    const struct hdf5_value *value = &object->value;
    if (value->rank < 2) {
        fail_object(job, object, "less than two dimensions");
        return;
    }
    array->rows = (size_t)value->dims[value->rank - 1];
    array->columns = (size_t)value->dims[value->rank - 2];
    array->count = value->count;
}

static void take_numbers(struct job *job, struct matlab_array *array, const struct hdf5_object *object)
{
    static const uint8_t types[][4] = {
        {0, 0, SINGLE, DOUBLE}, {INT8, INT16, INT32, INT64}, {UINT8, UINT16, UINT32, UINT64}};
    const struct hdf5_value *value = &object->value;
    bool is_text = array->kind == MATLAB_CHAR;
    if (value->class == HDF5_OTHER && !is_text) { /* pairs of real and imaginary parts */
        array->is_complex = true;
    } else if (!hdf5_is_number(value) || (is_text && (value->class != HDF5_UNSIGNED || value->size > 2))) {
        fail_object(job, object,
                    is_text ? "an array of characters must be of unsigned numbers of 1 or 2 bytes"
                            : "an array of numbers must be of numbers");
    } else {
        array->type = types[value->class - HDF5_FLOAT][__builtin_ctzll(value->size)];
        array->bytes = (struct text){(const char *)value->data, value->count * value->size};
    }
}

/* Room for parts. */
static void add_parts(struct job *job, struct matlab *matlab, size_t index, size_t count, size_t each)
{
    const struct matlab_array array = matlab->arrays[index];
    size_t all = 0;
    if (array.depth == DEPTH_LIMIT) {
        fail_object(job, array.object, "arrays in arrays, more than 32 deep");
    }
    if (!memory_multiply(count, each, &all) || all > matlab->most - matlab->count) {
        fail_object(job, array.object, "arrays that are parts of several");
        return;
    }
    matlab->arrays[index].parts = matlab->count;
    add_arrays(job, matlab, all);
}

/* Part `at` is where reference `index` of `references` leads to; the null reference is an empty array. */
static void take_part(struct job *job, struct matlab *matlab, size_t at, const struct hdf5_object *references,
                      size_t index, const struct matlab_array *part)
{
    uint64_t address = (uint64_t)hdf5_whole(&references->value, index);
    matlab->arrays[at] = *part;
    matlab->arrays[at].object = address ? hdf5_find_address(matlab->hdf5, address) : NULL;
    if (address && !matlab->arrays[at].object) {
        fail_object(job, references, "a reference that leads nowhere");
    }
}

static void take_cells(struct job *job, struct matlab *matlab, size_t index)
{
    const struct matlab_array cell = matlab->arrays[index];
    const struct matlab_array part = {.depth = (uint8_t)(cell.depth + 1), .name = {"", 0}};
    if (cell.object->value.class != HDF5_REFERENCE) {
        fail_object(job, cell.object, "a cell array must be of references");
    }
    add_parts(job, matlab, index, cell.count, 1);
    for (size_t i = 0; job_ok(job) && i < cell.count; i++) {
        take_part(job, matlab, matlab->arrays[index].parts + i, cell.object, i, &part);
    }
}

/* Whether the field of a structure is that of several: references, which are no cell array. */
static bool is_field_of_several(const struct hdf5_object *field)
{
    return field->value.class == HDF5_REFERENCE && !hdf5_attribute(field, "MATLAB_class");
}

/* Counts the fields of a group, which must be alike: those of one structure, or of as many structures each. Whether it
 * is of several. */
static bool count_fields(struct job *job, struct matlab_array *array, const struct hdf5 *hdf5)
{
    const struct hdf5_object *first = NULL;
    const struct hdf5_object *field;
    size_t at = 0;
    bool several = false;
    array->count = array->rows = array->columns = 1;
    array->fields = 0;
    for (; job_ok(job) && (field = hdf5_next_in(hdf5, &at, array->object->value.name)); array->fields++) {
        first = first ? first : field;
        several = is_field_of_several(first);
        bool alike = is_field_of_several(field) == several &&
                     (!several || (field->value.rank == first->value.rank &&
                                   memcmp(field->value.dims, first->value.dims, sizeof first->value.dims) == 0));
        if (!alike) {
            fail_object(job, field, "another number of structures than the fields beside it have");
        } else if (several) {
            take_dims(job, array, field);
        }
    }
    return several;
}

static void take_fields(struct job *job, struct matlab *matlab, size_t index)
{
    struct matlab_array structure = matlab->arrays[index];
    const struct hdf5_object *field;
    size_t at = 0;
    if (structure.object->value.class != HDF5_GROUP) {
        fail_object(job, structure.object, "a structure must be a group");
    }
    const bool several = count_fields(job, &structure, matlab->hdf5);
    matlab->arrays[index] = structure;
    add_parts(job, matlab, index, structure.count, structure.fields);
    size_t to = matlab->arrays[index].parts;
    for (; job_ok(job) && (field = hdf5_next_in(matlab->hdf5, &at, structure.object->value.name)); to++) {
        struct matlab_array part = {
            .depth = (uint8_t)(structure.depth + 1), .name = hdf5_last_name(field->value.name), .object = field};
        for (size_t i = 0; job_ok(job) && several && i < structure.count; i++) {
            take_part(job, matlab, to + i * structure.fields, field, i, &part);
        }
        if (!several) {
            matlab->arrays[to] = part;
        }
    }
}

static void fill_array(struct job *job, struct matlab *matlab, size_t index)
{
    struct matlab_array *array = &matlab->arrays[index];
    const struct hdf5_object *object = array->object;
    array->bytes = (struct text){"", 0};
    if (!object) {
        return; /* MATLAB_EMPTY */
    }
    const struct hdf5_value *empty = hdf5_attribute(object, "MATLAB_empty");
    array->swapped = BIG_ENDIAN_IS_SWAPPED != true;
    take_class(array, object);
    if (array->kind == MATLAB_OTHER) {
        return;
    }
    array->bytes = (struct text){"", 0};
    if (empty && hdf5_is_number(empty) && empty->count && hdf5_number(empty, 0) != 0) {
        take_empty(job, array, object);
    } else if (array->kind == MATLAB_STRUCT) {
        take_fields(job, matlab, index);
    } else {
        take_dims(job, array, object);
        if (array->kind == MATLAB_CELL) {
            take_cells(job, matlab, index);
        } else {
            take_numbers(job, array, object);
        }
    }
}

/* Lists the variables of the file: the members of its root, except MATLAB's own "#refs#" and "#subsystem#". */
static void add_variables(struct job *job, struct matlab *matlab)
{
    const struct hdf5_object *object;
    size_t at = 0;
    while (job_ok(job) && (object = hdf5_next_in(matlab->hdf5, &at, text_from("/")))) {
        struct text name = hdf5_last_name(object->value.name);
        if (name.data[0] != '#') {
            add_arrays(job, matlab, 1);
        }
        if (job_ok(job) && name.data[0] != '#') {
            matlab->arrays[matlab->variables++] = (struct matlab_array){.name = name, .object = object};
        }
    }
}

static void parse_level_7(struct job *job, struct matlab *matlab)
{
    const size_t place = job_in(job, "MATLAB's file", JOB_ALONE);
    for (size_t i = 0; job_ok(job) && i < hdf5_count(matlab->hdf5); i++) { /* what is there already */
        const struct hdf5_value *value = &hdf5_object(matlab->hdf5, i)->value;
        matlab->most += 1 + (value->class == HDF5_REFERENCE ? value->count : 0); /* each is a part of one */
        use_memory(job, matlab, value->name.size + value->count * value->size);
    }
    add_variables(job, matlab);
    for (size_t i = 0; job_ok(job) && i < matlab->count; i++) { /* it grows on the way */
        fill_array(job, matlab, i);
    }
    job_out(job, place);
}

static struct matlab *new_matlab(struct job *job, uint64_t limit)
{
    struct matlab *matlab = job_new(job, struct matlab);
    matlab = matlab ? matlab : job_spare(job, sizeof *matlab);
    matlab->limit = limit;
    return matlab;
}

/* What was parsed; after a failure nothing. */
static const struct matlab *settle(struct job *job, const struct matlab *matlab)
{
    return job_ok(job) ? matlab : job_spare(job, sizeof *matlab);
}

const struct matlab *matlab_of_hdf5(struct job *job, const struct hdf5 *hdf5, uint64_t limit)
{
    struct matlab *matlab = new_matlab(job, limit);
    matlab->hdf5 = hdf5;
    parse_level_7(job, matlab);
    return settle(job, matlab);
}

const struct matlab *matlab_read(struct job *job, struct text text, uint64_t limit)
{
    static const char *const all[] = {"/**"};
    const bool swapped = check_header(job, text);
    if (job_ok(job) && is_level_7(text)) {
        return matlab_of_hdf5(job, hdf5_of_bytes(job, text, all, 1, limit ? limit : 1), limit);
    }
    struct matlab *matlab = new_matlab(job, limit);
    if (job_ok(job)) {
        parse_level_5(job, matlab, text, swapped);
    }
    return settle(job, matlab);
}

const struct matlab_array *matlab_variable(const struct matlab *matlab, const char *name)
{
    for (size_t i = 0; i < matlab->variables; i++) {
        if (text_equal(matlab->arrays[i].name, name)) {
            return &matlab->arrays[i];
        }
    }
    return NULL;
}

const struct matlab_array *matlab_field(const struct matlab *matlab, const struct matlab_array *array, size_t index,
                                        const char *name)
{
    bool has_any = array && array->kind == MATLAB_STRUCT && index < array->count;
    for (size_t i = 0; has_any && i < array->fields; i++) {
        const struct matlab_array *field = &matlab->arrays[array->parts + index * array->fields + i];
        if (text_equal(field->name, name)) {
            return field;
        }
    }
    return NULL;
}

bool matlab_is_real(const struct matlab_array *array)
{
    return array->kind >= MATLAB_DOUBLE && array->kind <= MATLAB_UINT64 && !array->is_complex;
}

double matlab_number(const struct matlab_array *array, size_t index)
{
    size_t size = value_size[array->type];
    const uint8_t *data = at(array->bytes) + index * size;
    if (array->type == SINGLE || array->type == DOUBLE) {
        return order_real(data, size, array->swapped);
    }
    bool is_signed = array->type == INT8 || array->type == INT16 || array->type == INT32 || array->type == INT64;
    int64_t whole = order_whole(data, size, is_signed, array->swapped);
    return is_signed ? (double)whole : (double)(uint64_t)whole;
}

struct text matlab_text(char *out, size_t size, const struct matlab_array *array)
{
    if (!array || array->kind != MATLAB_CHAR || array->rows != 1) {
        return (struct text){"", 0};
    }
    if (array->type == UTF16 || array->type == UINT16 || array->type == INT16) {
        return (struct text){out, text_from_utf16(out, size, array->bytes, array->swapped == BIG_ENDIAN_IS_SWAPPED)};
    }
    size_t used = value_size[array->type] != 1 ? 0 : array->bytes.size < size ? array->bytes.size : size;
    memcpy(out, array->bytes.data, used);
    return (struct text){out, used};
}

struct matlab_words matlab_class_name(const struct matlab_array *array)
{
    struct matlab_words words;
    const char *plain = array->kind == MATLAB_EMPTY    ? "an empty array"
                        : array->kind == MATLAB_CELL   ? "a cell array"
                        : array->kind == MATLAB_STRUCT ? "a structure"
                        : array->kind == MATLAB_CHAR   ? "an array of characters"
                        : array->kind == MATLAB_OTHER  ? "an object"
                        : array->is_complex            ? "an array of complex numbers"
                                                       : "an array of numbers";
    bool has_class = array->kind == MATLAB_OTHER && array->bytes.size;
    snprintf(words.text, sizeof words.text, has_class ? "%s (%.*s)" : "%s", plain, TEXT_SHOW(array->bytes, 40U));
    return words;
}
