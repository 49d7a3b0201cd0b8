/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads TRX: header.json first, then offsets, numbers and groups, then positions. */
#include "loaders/tracts/tract_formats.h"

#include "base/buffer.h"
#include "base/byte_order.h"
#include "base/files/file_sums.h"
#include "base/files/folder.h"
#include "base/formats/gzip.h"
#include "base/formats/json_text.h"
#include "base/formats/zip.h"
#include "base/memory.h"
#include "base/order.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct trx_files {
    struct bytes *archive; /* NULL of a folder. */
    struct zip zip;        /* The archive's files. */
    const char *folder;
    struct names names;    /* The folder's files: "header.json", "dps/weight.float32". */
    struct file_sums read; /* The folder's files that were opened. */
    uint64_t left;         /* Bytes of memory that may still be taken. */
};

/* Bytes of a file: the archive's own where it is not packed, else `owned`. */
struct trx_view {
    const uint8_t *data;
    size_t size;
    struct bytes owned;
};

/* Takes `size` bytes from what is left, for `what`. CONUS_ERROR_MEMORY. */
static conus_status trx_files_spend(struct trx_files *files, uint64_t size, const char *what)
{
    if (size > files->left) {
        return fail(CONUS_ERROR_MEMORY, "%s: %llu bytes, allowed are %llu more (--max-memory)", what,
                    (unsigned long long)size, (unsigned long long)files->left);
    }
    files->left -= size;
    return CONUS_OK;
}

/* The folders of a TRX's files, behind the one around them. */
static const char *const folders[] = {"", "dps/", "dpv/", "groups/"};

static bool is_folder_or_hidden(const char *name)
{
    bool found = name[0] == '.';
    for (size_t i = 1; i < sizeof folders / sizeof folders[0]; i++) {
        found = found || (strncmp(name, folders[i], strlen(name)) == 0 && strlen(name) + 1 == strlen(folders[i]));
    }
    return found;
}

/* The names in folder/in, which is "" or ends in '/'. CONUS_ERROR_UNSUPPORTED for NAMES_LIMIT files or more. */
static conus_status list_in(struct trx_files *out, const char *in)
{
    struct buffer path = {0};
    struct names names = {0};
    buffer_format(&path, "%s/%s", out->folder, in);
    conus_status status = buffer_status(&path);
    status = status ? status : names_list(&names, path.data, "");
    if (!status && names.count >= NAMES_LIMIT) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "%s: %d files or more, a TRX of so many is read as a zip archive only",
                      path.data, NAMES_LIMIT);
    }
    for (size_t i = 0; !status && i < names.count; i++) {
        if (!is_folder_or_hidden(names.names[i])) {
            path.size = 0;
            buffer_format(&path, "%s%s", in, names.names[i]);
            status = buffer_status(&path);
            status = status ? status : names_add(&out->names, path.data);
        }
    }
    names_finish(&names);
    buffer_finish(&path);
    return status;
}

static size_t trx_files_count(const struct trx_files *files)
{
    return files->folder ? files->names.count : files->zip.count;
}

static struct text trx_files_name(const struct trx_files *files, size_t index)
{
    return files->folder ? text_from(files->names.names[index]) : files->zip.entries[index].name;
}

/* Opens a file, verified; end it with trx_files_close(). CONUS_ERROR_MEMORY above what is left. */
static conus_status trx_files_open(struct trx_view *out, struct trx_files *files, size_t index)
{
    const struct zip_entry *entry = files->folder ? NULL : &files->zip.entries[index];
    struct bytes owned = {0};
    if (entry && !entry->is_packed) {
        *out = (struct trx_view){.data = files->zip.data + entry->at, .size = entry->stored};
        return zip_verify(&files->zip, entry);
    }
    conus_status status;
    if (entry) {
        status = zip_unpack(&owned, &files->zip, entry, files->left);
    } else {
        struct buffer path = {0};
        buffer_format(&path, "%s/%s", files->folder, files->names.names[index]);
        status = buffer_status(&path);
        status = status ? status : file_read_allowed(&owned, path.data, files->left);
        status = status ? status : file_sums_add(&files->read, path.data, &owned);
        buffer_finish(&path);
    }
    files->left -= owned.size;
    *out = (struct trx_view){owned.data, owned.size, owned};
    return status;
}

static void trx_files_close(struct trx_view *view, struct trx_files *files)
{
    files->left += view->owned.size;
    bytes_finish(&view->owned);
    *view = (struct trx_view){0};
}

/* Keeps the bytes of the last file that is read, instead of closing it: they begin at *at of `out`, which may be the
 * archive itself; that is empty then, and no other file is left. */
static void trx_files_keep(struct bytes *out, size_t *at, struct trx_view *view, struct trx_files *files)
{
    bool is_own = view->owned.data != NULL;
    *at = is_own ? 0 : (size_t)(view->data - files->archive->data);
    *out = is_own ? view->owned : *files->archive;
    if (!is_own) {
        *files->archive = (struct bytes){0};
        zip_finish(&files->zip);
    }
    *view = (struct trx_view){0};
}

enum { SCALAR_LIMIT = 4096, COMPONENT_LIMIT = 65536, SHOWN = 100 };

static const bool is_swapped = !BIG_ENDIAN_IS_SWAPPED; /* all arrays are little-endian */

struct type {
    const char *name;
    size_t size;
    enum { INTEGER, UNSIGNED, REAL } kind;
};

static const struct type types[] = {{"int8", 1, INTEGER},    {"int16", 2, INTEGER},   {"int32", 4, INTEGER},
                                    {"int64", 8, INTEGER},   {"uint8", 1, UNSIGNED},  {"uint16", 2, UNSIGNED},
                                    {"uint32", 4, UNSIGNED}, {"uint64", 8, UNSIGNED}, {"float16", 2, REAL},
                                    {"float32", 4, REAL},    {"float64", 8, REAL}};

/* A file's name, taken apart: folder/name.components.type. */
struct array {
    struct text name;
    uint32_t components;
    const struct type *type; /* NULL: none of the above */
};

struct trx {
    struct tractogram *out;
    struct trx_files files;
    struct notes *notes;
    size_t scalar_capacity, group_capacity;
    size_t passed_over;       /* files that are not read */
    struct text passed_first; /* the first of them */
    bool has_group_values;
};

/* Cuts the last part behind a '.' off @p name. */
static bool cut_part(struct text *name, struct text *part)
{
    const char *dot = text_last(*name, '.');
    if (!dot) {
        return false;
    }
    *part = (struct text){dot + 1, (size_t)(name->data + name->size - dot) - 1};
    name->size = (size_t)(dot - name->data);
    return true;
}

/* Parses "weight.3.float32", without a folder. False where the number of components is not valid. */
static bool read_name(struct array *out, struct text name)
{
    struct text part;
    uint64_t components = 1;
    *out = (struct array){.name = name, .components = 1};
    if (!cut_part(&out->name, &part)) {
        return true;
    }
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        out->type = text_equal(part, types[i].name) ? &types[i] : out->type;
    }
    struct text before = out->name;
    if (cut_part(&before, &part) && before.size && text_to_uint(part, UINT64_MAX, &components)) {
        out->name = before;
    }
    out->components = (uint32_t)components;
    return components >= 1 && components <= COMPONENT_LIMIT;
}

/* Whether @p name is in @p folder, "dps/" say; *rest is without it. */
static bool is_in(struct text *rest, struct text name, const char *folder)
{
    size_t length = strlen(folder);
    bool there = text_starts(name, folder);
    *rest = there ? (struct text){name.data + length, name.size - length} : *rest;
    return there;
}

/* The only file of the name that begins so, whatever its type; SIZE_MAX: there is none. */
static conus_status find_array(size_t *out, const struct trx *trx, const char *beginning)
{
    *out = SIZE_MAX;
    for (size_t i = 0; i < trx_files_count(&trx->files); i++) {
        if (text_starts(trx_files_name(&trx->files, i), beginning)) {
            if (*out != SIZE_MAX) {
                struct text name = trx_files_name(&trx->files, i);
                return fail(CONUS_ERROR_DATA, "%.*s: a second array of positions or offsets", TEXT_SHOW(name, SHOWN));
            }
            *out = i;
        }
    }
    return CONUS_OK;
}

static conus_status fail_size(struct text name, size_t size, uint64_t count, size_t each)
{
    return fail(CONUS_ERROR_DATA, "%.*s: %zu bytes, by header.json %llu times %zu are needed", TEXT_SHOW(name, SHOWN),
                size, (unsigned long long)count, each);
}

static float trx_number_at(const uint8_t *data, const struct type *type)
{
    if (type->kind == REAL) {
        return type->size == 2 ? (float)tract_from_half(order_u16(data, is_swapped))
                               : (float)order_real(data, type->size, is_swapped);
    }
    int64_t whole = order_whole(data, type->size, type->kind == INTEGER, is_swapped);
    return type->kind == INTEGER ? (float)whole : (float)(uint64_t)whole;
}

static conus_status read_count(uint64_t *out, const json_t *root, const char *name)
{
    const json_t *value = json_object_get(root, name);
    if (!json_is_integer(value) || json_integer_value(value) < 0) {
        return fail(CONUS_ERROR_DATA, "%s: %s, a whole number, 0 or more, is needed", name,
                    value ? "it is no such number" : "not given");
    }
    *out = (uint64_t)json_integer_value(value);
    return CONUS_OK;
}

/* A list of @p count finite numbers, or of lists of @p inner of them; NULL is fine, since positions need none. */
static bool is_table(const json_t *list, size_t count, size_t inner)
{
    bool good = !list || (json_is_array(list) && json_array_size(list) == count);
    for (size_t i = 0; list && good && i < count; i++) {
        const json_t *value = json_array_get(list, i);
        good = inner ? json_is_array(value) && is_table(value, inner, 0)
                     : json_is_number(value) && isfinite(json_number_value(value));
    }
    return good;
}

static conus_status read_header_text(struct trx *trx, struct text text)
{
    json_t *root = NULL;
    uint64_t streamlines = 0;
    conus_status status = json_text_load(&root, text);
    if (!status && !json_is_object(root)) {
        status = fail(CONUS_ERROR_DATA, "not a JSON object");
    }
    status = status ? status : read_count(&streamlines, root, "NB_STREAMLINES");
    status = status ? status : read_count(&trx->out->point_count, root, "NB_VERTICES");
    if (!status && streamlines >= UINT32_MAX) {
        status = fail(CONUS_ERROR_DATA, "NB_STREAMLINES: %llu, allowed are %u", (unsigned long long)streamlines,
                      UINT32_MAX - 1);
    }
    if (!status && !is_table(json_object_get(root, "VOXEL_TO_RASMM"), 4, 4)) {
        status = fail(CONUS_ERROR_DATA, "VOXEL_TO_RASMM: 4 lists of 4 numbers are needed");
    }
    if (!status && !is_table(json_object_get(root, "DIMENSIONS"), 3, 0)) {
        status = fail(CONUS_ERROR_DATA, "DIMENSIONS: 3 numbers are needed");
    }
    json_decref(root);
    trx->out->streamline_count = status ? 0 : (size_t)streamlines;
    return status;
}

static conus_status trx_read_header(struct trx *trx)
{
    for (size_t i = 0; i < trx_files_count(&trx->files); i++) {
        if (text_equal(trx_files_name(&trx->files, i), "header.json")) {
            struct trx_view view;
            conus_status status = trx_files_open(&view, &trx->files, i);
            status = status ? status : read_header_text(trx, (struct text){(const char *)view.data, view.size});
            trx_files_close(&view, &trx->files);
            return status ? fail_in(status, "header.json") : CONUS_OK;
        }
    }
    return fail(CONUS_ERROR_DATA, "header.json: missing, so this is no TRX");
}

/* Where each streamline begins; a last one, behind all points, may be there. */
static conus_status fill_offsets(struct trx *trx, const struct trx_view *view, size_t size, struct text name)
{
    struct tractogram *out = trx->out;
    size_t count = out->streamline_count;
    size_t given = view->size / size;
    if (view->size != count * size && view->size != (count + 1) * size) {
        return fail_size(name, view->size, count, size);
    }
    conus_status status = trx_files_spend(&trx->files, (count + 1) * sizeof(uint64_t), "offsets");
    if (status) {
        return status;
    }
    out->first = memory_zeroed(count + 1, sizeof *out->first);
    if (!out->first) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i <= count; i++) {
        const uint8_t *data = i < given ? view->data + i * size : NULL;
        uint64_t last = i ? out->first[i - 1] : 0;
        out->first[i] = !data       ? out->point_count
                        : size == 4 ? order_u32(data, is_swapped)
                                    : order_u64(data, is_swapped);
        if (out->first[i] < last || out->first[i] > out->point_count || (i == 0 && out->first[i]) ||
            (i == count && out->first[i] != out->point_count)) {
            return fail(CONUS_ERROR_DATA, "%.*s: number %zu (from 0) is %llu, they rise from 0 to NB_VERTICES, %llu",
                        TEXT_SHOW(name, SHOWN), i, (unsigned long long)out->first[i],
                        (unsigned long long)out->point_count);
        }
    }
    return CONUS_OK;
}

static conus_status read_offsets(struct trx *trx)
{
    size_t index;
    struct trx_view view = {0};
    conus_status status = find_array(&index, trx, "offsets.");
    if (status) {
        return status;
    }
    if (index == SIZE_MAX) {
        return trx->out->streamline_count ? fail(CONUS_ERROR_DATA, "offsets: missing; offsets.uint64 is needed")
                                          : fill_offsets(trx, &view, sizeof(uint64_t), text_from("offsets"));
    }
    struct text name = trx_files_name(&trx->files, index);
    bool is_short = text_equal(name, "offsets.uint32");
    if (!is_short && !text_equal(name, "offsets.uint64")) {
        return fail(CONUS_ERROR_DATA, "%.*s: offsets.uint64 or offsets.uint32 is needed", TEXT_SHOW(name, SHOWN));
    }
    status = trx_files_open(&view, &trx->files, index);
    status = status ? status : fill_offsets(trx, &view, is_short ? sizeof(uint32_t) : sizeof(uint64_t), name);
    trx_files_close(&view, &trx->files);
    return status;
}

static void pass_over(struct trx *trx, struct text name)
{
    trx->passed_first = trx->passed_over ? trx->passed_first : name;
    trx->passed_over++;
}

static conus_status fill_scalar(struct trx *trx, struct tract_scalar *scalar, const struct array *array, size_t index)
{
    struct trx_view view;
    struct text name = trx_files_name(&trx->files, index);
    uint64_t things = scalar->per_point ? trx->out->point_count : trx->out->streamline_count;
    size_t each = array->type->size * array->components;
    conus_status status = trx_files_open(&view, &trx->files, index);
    if (!status && (view.size % each || view.size / each != things)) {
        status = fail_size(name, view.size, things, each);
    }
    size_t count = status ? 0 : view.size / array->type->size;
    status = status ? status : trx_files_spend(&trx->files, (uint64_t)count * sizeof(float), "numbers");
    scalar->values = status ? NULL : memory_raw(count, sizeof(float));
    for (size_t i = 0; scalar->values && i < count; i++) {
        scalar->values[i] = trx_number_at(view.data + i * array->type->size, array->type);
    }
    trx_files_close(&view, &trx->files);
    return status || scalar->values ? status : CONUS_ERROR_MEMORY;
}

/* @p rest is the name without its folder. */
static conus_status read_scalar(struct trx *trx, struct text rest, size_t index, bool per_point)
{
    struct tractogram *out = trx->out;
    struct array array;
    struct text name = trx_files_name(&trx->files, index);
    bool good = read_name(&array, rest);
    if (!array.type) {
        pass_over(trx, name);
        return CONUS_OK;
    }
    if (!good || !array.name.size || out->scalar_count >= SCALAR_LIMIT) {
        return fail(CONUS_ERROR_DATA, "%.*s: a name, 1 to %d numbers each, and %d such arrays are allowed",
                    TEXT_SHOW(name, SHOWN), COMPONENT_LIMIT, SCALAR_LIMIT);
    }
    struct tract_scalar scalar = {text_to_utf8(array.name), per_point, array.components, NULL};
    bool grown = scalar.name &&
                 memory_reserve(&out->scalars, &trx->scalar_capacity, out->scalar_count + 1, sizeof *out->scalars);
    conus_status status = grown ? fill_scalar(trx, &scalar, &array, index) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(scalar.name);
        return status;
    }
    out->scalars[out->scalar_count++] = scalar;
    return CONUS_OK;
}

/* Sorts the members where they are not, and leaves each once. */
static conus_status fill_group(struct trx *trx, struct tract_group *group, size_t index)
{
    struct trx_view view;
    struct text name = trx_files_name(&trx->files, index);
    conus_status status = trx_files_open(&view, &trx->files, index);
    if (!status && view.size % sizeof(uint32_t)) {
        status = fail(CONUS_ERROR_DATA, "%.*s: %zu bytes, each number has 4", TEXT_SHOW(name, SHOWN), view.size);
    }
    status = status ? status : trx_files_spend(&trx->files, view.size, "groups");
    group->count = view.size / sizeof(uint32_t);
    group->members = status ? NULL : memory_raw(group->count, sizeof(uint32_t));
    for (size_t i = 0; group->members && i < group->count; i++) {
        group->members[i] = order_u32(view.data + i * sizeof(uint32_t), is_swapped);
    }
    trx_files_close(&view, &trx->files);
    if (status || !group->members) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    bool ascends = true;
    for (size_t i = 1; i < group->count; i++) {
        ascends = ascends && group->members[i - 1] < group->members[i];
    }
    size_t count = ascends ? group->count : u32_sort_unique(group->members, group->count);
    size_t less = group->count - count;
    group->count = count;
    return less ? notes_add(trx->notes, "group '%s': %zu of its streamlines are there twice, taken once", group->name,
                            less)
                : CONUS_OK;
}

static conus_status read_group(struct trx *trx, struct text rest, size_t index)
{
    struct tractogram *out = trx->out;
    struct text name = trx_files_name(&trx->files, index);
    struct text type = {0};
    if (!cut_part(&rest, &type) || !rest.size || !text_equal(type, "uint32")) {
        return fail(CONUS_ERROR_DATA, "%.*s: a group is NAME.uint32", TEXT_SHOW(name, SHOWN));
    }
    struct tract_group group = {.name = text_to_utf8(rest)};
    bool grown =
        group.name && memory_reserve(&out->groups, &trx->group_capacity, out->group_count + 1, sizeof *out->groups);
    conus_status status = grown ? fill_group(trx, &group, index) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(group.name);
        memory_free(group.members);
        return status;
    }
    out->groups[out->group_count++] = group;
    return CONUS_OK;
}

static conus_status read_others(struct trx *trx)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < trx_files_count(&trx->files); i++) {
        struct text name = trx_files_name(&trx->files, i);
        struct text rest;
        if (is_in(&rest, name, "dps/") || is_in(&rest, name, "dpv/")) {
            status = read_scalar(trx, rest, i, name.data[2] == 'v');
        } else if (is_in(&rest, name, "groups/")) {
            status = read_group(trx, rest, i);
        } else if (text_starts(name, "dpg/") || text_equal(name, "dpg")) {
            trx->has_group_values = true;
        } else if (!text_starts(name, "offsets.") && !text_starts(name, "positions.") &&
                   !text_equal(name, "header.json")) {
            pass_over(trx, name);
        }
    }
    if (!status && trx->has_group_values) {
        status = notes_add(trx->notes, "dpg: values of groups are not read");
    }
    if (!status && trx->passed_over) {
        status = notes_add(trx->notes, "%.*s: no array that is read; there are %zu such files",
                           TEXT_SHOW(trx->passed_first, SHOWN), trx->passed_over);
    }
    return status;
}

/* Moves the numbers to the front of @p bytes, which become the tractogram's. Each is written before or where it was, so
 * that none is lost. */
static void settle_positions(struct tractogram *out, struct bytes *bytes, size_t at, const struct type *type)
{
    size_t count = (size_t)out->point_count * 3;
    size_t size = type->size == 2 ? sizeof(uint16_t) : sizeof(float);
    const uint8_t *from = bytes->data + at;
    if (!is_swapped && type->size == size) {
        memmove(bytes->data, from, count * size);
    } else if (type->size == 2) {
        for (size_t i = 0; i < count; i++) {
            ((uint16_t *)bytes->data)[i] = order_u16(from + 2 * i, is_swapped);
        }
    } else {
        for (size_t i = 0; i < count; i++) {
            ((float *)bytes->data)[i] = trx_number_at(from + i * type->size, type);
        }
    }
    void *less = memory_resize(bytes->data, count, size);
    void *numbers = less ? less : bytes->data;
    out->halves = type->size == 2 ? numbers : NULL;
    out->points = type->size == 2 ? NULL : numbers;
    *bytes = (struct bytes){0};
}

static conus_status take_positions(struct trx *trx, size_t index, const struct type *type)
{
    struct trx_view view;
    struct bytes bytes = {0};
    size_t at = 0;
    size_t each = 3 * type->size;
    conus_status status = trx_files_open(&view, &trx->files, index);
    if (!status && (view.size % each || view.size / each != trx->out->point_count)) {
        status = fail_size(trx_files_name(&trx->files, index), view.size, trx->out->point_count, each);
    }
    if (status) {
        trx_files_close(&view, &trx->files);
        return status;
    }
    trx_files_keep(&bytes, &at, &view, &trx->files);
    settle_positions(trx->out, &bytes, at, type);
    return CONUS_OK;
}

static conus_status read_positions(struct trx *trx)
{
    static const char needed[] = "positions.3.float16, .float32 or .float64 is needed";
    size_t index;
    struct array array;
    conus_status status = find_array(&index, trx, "positions.");
    if (status) {
        return status;
    }
    if (index == SIZE_MAX) {
        return trx->out->point_count ? fail(CONUS_ERROR_DATA, "positions: missing; %s", needed) : CONUS_OK;
    }
    struct text name = trx_files_name(&trx->files, index);
    bool good = read_name(&array, name) && text_equal(array.name, "positions") && array.components == 3;
    if (!good || !array.type || array.type->kind != REAL) {
        return fail(CONUS_ERROR_DATA, "%.*s: %s", TEXT_SHOW(name, SHOWN), needed);
    }
    bool is_packed = trx->files.archive && trx->files.zip.entries[index].is_packed;
    snprintf(trx->out->format, sizeof trx->out->format, "TRX, %s, %s",
             !trx->files.archive ? "folder"
             : is_packed         ? "packed zip"
                                 : "zip",
             array.type->name);
    return take_positions(trx, index, array.type);
}

/* Reads what `files` of @p trx lists, unless that has failed, and ends them. */
static conus_status finish_reading(struct tractogram *out, struct trx *trx, conus_status status)
{
    struct tractogram built = {0};
    trx->out = &built;
    status = status ? status : trx_read_header(trx);
    snprintf(built.format, sizeof built.format, "TRX, %s", trx->files.archive ? "zip" : "folder");
    status = status ? status : read_offsets(trx);
    status = status ? status : read_others(trx);
    status = status ? status : read_positions(trx);
    status = status ? status : file_sums_move(&built.files, &trx->files.read);
    zip_finish(&trx->files.zip);
    names_finish(&trx->files.names);
    file_sums_finish(&trx->files.read);
    if (status) {
        tractogram_finish(&built);
        return status;
    }
    *out = built;
    return CONUS_OK;
}

conus_status trx_parse(struct tractogram *out, struct bytes *archive, uint64_t max_memory, struct notes *notes)
{
    struct trx trx = {.notes = notes, .files = {.archive = archive, .left = max_memory}};
    conus_status status = trx_files_spend(&trx.files, archive->size, "archive");
    status = status ? status : zip_parse(&trx.files.zip, archive->data, archive->size);
    return finish_reading(out, &trx, status);
}

bool trx_is_named(const char *path)
{
    return file_is_folder(path) || path_ends_in(path, ".trx");
}

conus_status trx_read(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes)
{
    if (file_is_folder(path)) {
        struct trx trx = {.notes = notes, .files = {.folder = path, .left = max_memory}};
        conus_status status = CONUS_OK;
        for (size_t i = 0; !status && i < sizeof folders / sizeof folders[0]; i++) {
            status = list_in(&trx.files, folders[i]);
        }
        status = finish_reading(out, &trx, status);
        return status ? fail_in(status, path) : CONUS_OK;
    }
    struct bytes archive = {0};
    char sum[sizeof out->sha256];
    conus_status status = file_read_allowed(&archive, path, max_memory);
    if (!status && gzip_is(archive.data, archive.size)) { /* a zip has its table at the end, behind all of that */
        status = fail(CONUS_ERROR_UNSUPPORTED, "%s: a TRX inside gzip: a TRX is packed itself; unpack the gzip", path);
    }
    if (!status) {
        file_sha256(sum, &archive);
        status = trx_parse(out, &archive, max_memory, notes);
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    if (!status) {
        memcpy(out->sha256, sum, sizeof sum);
    }
    bytes_finish(&archive);
    return status;
}
