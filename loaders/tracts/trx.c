/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads TRX: header.json first, then offsets, numbers and groups, then positions. */
#include "loaders/tracts/tract_formats.h"

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/json_text.h"
#include "base/formats/packed.h"
#include "base/memory.h"
#include "base/order.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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
    struct job *job;
    struct tract_build *build; /* its max_memory: bytes that may still be taken */
    const char *folder;        /* NULL of an archive */
    LIST(char *) names;        /* the folder's files: "header.json", "dps/weight.float32" */
    struct bytes archive;
    struct zip zip; /* the archive's files */
    size_t group_capacity;
    size_t passed_over;       /* files that are not read */
    struct text passed_first; /* the first of them */
    bool has_group_values;
};

/* Bytes of a file: the archive's own where it is not packed. */
struct trx_view {
    const uint8_t *data;
    size_t size;
    uint8_t *block; /* of the job, in which they lie */
    bool is_own;    /* they are in no archive */
    struct job_mark before;
};

/* Takes `size` bytes from what is left, for `what`. CONUS_ERROR_MEMORY. */
static void spend(struct trx *trx, uint64_t size, const char *what)
{
    if (size > trx->build->max_memory) {
        job_fail(trx->job, CONUS_ERROR_MEMORY, "%s: %llu bytes, allowed are %llu more (--max-memory)", what,
                 (unsigned long long)size, (unsigned long long)trx->build->max_memory);
    }
    trx->build->max_memory -= job_ok(trx->job) ? size : 0;
}

/* `count` elements of `size` bytes that become the tractogram's; NULL after a failure. */
static void *take_array(struct trx *trx, size_t count, size_t size, const char *what)
{
    spend(trx, (uint64_t)count * size, what);
    void *array = job_step(trx->job) ? memory_raw(count, size) : NULL;
    return job_need(trx->job, array) ? array : NULL;
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

/* Lists folder/in, which is "" or ends in '/'. CONUS_ERROR_UNSUPPORTED for NAMES_LIMIT files or more. */
static void list_in(struct trx *trx, const char *in)
{
    const char *path = job_format(trx->job, "%s/%s", trx->folder, in);
    const struct names names = job_names(trx->job, path, "");
    if (names.count >= NAMES_LIMIT) {
        job_refuse(trx->job, "%s: %d files or more, a TRX of so many is read as a zip archive only", path, NAMES_LIMIT);
    }
    for (size_t i = 0; job_ok(trx->job) && i < names.count; i++) {
        if (!is_folder_or_hidden(names.names[i])) {
            *LIST_ADD(trx->job, &trx->names) = job_format(trx->job, "%s%s", in, names.names[i]);
        }
    }
}

static size_t file_count(const struct trx *trx)
{
    return trx->folder ? trx->names.count : trx->zip.count;
}

static struct text name_of(const struct trx *trx, size_t index)
{
    return trx->folder ? text_from(trx->names.at[index]) : trx->zip.entries[index].name;
}

/* Opens a file, verified; end it with trx_close(). CONUS_ERROR_MEMORY above what is left. */
static struct trx_view trx_open(struct trx *trx, size_t index)
{
    struct job *job = trx->job;
    const struct job_mark before = job_mark(job);
    const struct zip_entry *entry = trx->folder ? NULL : &trx->zip.entries[index];
    struct bytes own;
    if (entry && !entry->is_packed) {
        zip_verify(job, &trx->zip, entry);
        return (struct trx_view){trx->zip.data + entry->at, entry->stored, trx->archive.data, false, before};
    }
    if (entry) {
        own = zip_unpack(job, &trx->zip, entry, trx->build->max_memory);
    } else {
        const char *path = job_format(job, "%s/%s", trx->folder, trx->names.at[index]);
        const size_t place = job_in(job, path, JOB_ALONE);
        own = job_read(job, path, trx->build->max_memory, FILE_MAX_MEMORY);
        job_made_of(job, path, &own);
        job_out(job, place);
    }
    trx->build->max_memory -= own.size;
    return (struct trx_view){own.data, own.size, own.data, true, before};
}

static void trx_close(struct trx *trx, const struct trx_view *view)
{
    trx->build->max_memory += view->is_own ? view->size : 0;
    job_release(trx->job, view->before);
}

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
    out->type = ROW_NAMED(types, part, true);
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
static size_t find_array(const struct trx *trx, const char *beginning)
{
    size_t found = SIZE_MAX;
    for (size_t i = 0; i < file_count(trx); i++) {
        if (!text_starts(name_of(trx, i), beginning)) {
            continue;
        }
        if (found != SIZE_MAX) {
            job_bad(trx->job, "%.*s: a second array of positions or offsets", TEXT_SHOW(name_of(trx, i), SHOWN));
        }
        found = i;
    }
    return found;
}

static void refuse_size(struct job *job, struct text name, size_t size, uint64_t count, size_t each)
{
    job_bad(job, "%.*s: %zu bytes, by header.json %llu times %zu are needed", TEXT_SHOW(name, SHOWN), size,
            (unsigned long long)count, each);
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

static uint64_t read_count(struct job *job, const json_t *root, const char *name)
{
    const json_t *value = json_object_get(root, name);
    if (!json_is_integer(value) || json_integer_value(value) < 0) {
        job_bad(job, "%s: %s, a whole number, 0 or more, is needed", name,
                value ? "it is no such number" : "not given");
    }
    return (uint64_t)json_integer_value(value);
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

static void read_header_text(struct trx *trx, struct text text)
{
    json_t *root = NULL;
    struct job *job = trx->job;
    if (JOB_CALL(job, json_text_load(&root, text)) && !json_is_object(root)) {
        job_bad(job, "not a JSON object");
    }
    const uint64_t streamlines = read_count(job, root, "NB_STREAMLINES");
    const uint64_t points = read_count(job, root, "NB_VERTICES");
    if (streamlines >= UINT32_MAX) {
        job_bad(job, "NB_STREAMLINES: %llu, allowed are %u", (unsigned long long)streamlines, UINT32_MAX - 1);
    }
    if (!is_table(json_object_get(root, "VOXEL_TO_RASMM"), 4, 4)) {
        job_bad(job, "VOXEL_TO_RASMM: 4 lists of 4 numbers are needed");
    }
    if (!is_table(json_object_get(root, "DIMENSIONS"), 3, 0)) {
        job_bad(job, "DIMENSIONS: 3 numbers are needed");
    }
    json_decref(root);
    if (job_ok(job)) {
        trx->build->tractogram.streamline_count = (size_t)streamlines;
        trx->build->tractogram.point_count = points;
    }
}

static void trx_read_header(struct trx *trx)
{
    for (size_t i = 0; i < file_count(trx); i++) {
        if (text_equal(name_of(trx, i), "header.json")) {
            const size_t place = job_in(trx->job, "header.json", JOB_ALONE);
            const struct trx_view view = trx_open(trx, i);
            read_header_text(trx, (struct text){(const char *)view.data, view.size});
            trx_close(trx, &view);
            job_out(trx->job, place);
            return;
        }
    }
    job_bad(trx->job, "header.json: missing, so this is no TRX");
}

/* Where each streamline begins; a last one, behind all points, may be there. */
static void fill_offsets(struct trx *trx, const struct trx_view *view, size_t size, struct text name)
{
    struct tractogram *t = &trx->build->tractogram;
    const size_t count = t->streamline_count;
    const size_t given = view->size / size;
    if (view->size != count * size && view->size != (count + 1) * size) {
        refuse_size(trx->job, name, view->size, count, size);
    }
    t->first = take_array(trx, count + 1, sizeof *t->first, "offsets");
    for (size_t i = 0; job_ok(trx->job) && i <= count; i++) {
        const uint8_t *data = i < given ? view->data + i * size : NULL;
        const uint64_t last = i ? t->first[i - 1] : 0;
        const uint64_t at = !data       ? t->point_count
                            : size == 4 ? order_u32(data, is_swapped)
                                        : order_u64(data, is_swapped);
        t->first[i] = at;
        if (at < last || at > t->point_count || (i == 0 && at) || (i == count && at != t->point_count)) {
            job_bad(trx->job, "%.*s: number %zu (from 0) is %llu, they rise from 0 to NB_VERTICES, %llu",
                    TEXT_SHOW(name, SHOWN), i, (unsigned long long)at, (unsigned long long)t->point_count);
        }
    }
}

static void read_offsets(struct trx *trx)
{
    const size_t index = find_array(trx, "offsets.");
    if (index == SIZE_MAX) {
        if (trx->build->tractogram.streamline_count) {
            job_bad(trx->job, "offsets: missing; offsets.uint64 is needed");
        }
        fill_offsets(trx, &(struct trx_view){0}, sizeof(uint64_t), text_from("offsets"));
        return;
    }
    const struct text name = name_of(trx, index);
    const bool is_short = text_equal(name, "offsets.uint32");
    if (!is_short && !text_equal(name, "offsets.uint64")) {
        job_bad(trx->job, "%.*s: offsets.uint64 or offsets.uint32 is needed", TEXT_SHOW(name, SHOWN));
    }
    const struct trx_view view = trx_open(trx, index);
    fill_offsets(trx, &view, is_short ? sizeof(uint32_t) : sizeof(uint64_t), name);
    trx_close(trx, &view);
}

static void pass_over(struct trx *trx, struct text name)
{
    trx->passed_first = trx->passed_over ? trx->passed_first : name;
    trx->passed_over++;
}

/* @p rest is the name without its folder. */
static void read_scalar(struct trx *trx, struct text rest, size_t index, bool per_point)
{
    struct tractogram *t = &trx->build->tractogram;
    struct array array;
    const struct text name = name_of(trx, index);
    const bool good = read_name(&array, rest);
    if (!array.type) {
        pass_over(trx, name);
        return;
    }
    if (!good || !array.name.size || t->scalar_count >= SCALAR_LIMIT) {
        job_bad(trx->job, "%.*s: a name, 1 to %d numbers each, and %d such arrays are allowed", TEXT_SHOW(name, SHOWN),
                COMPONENT_LIMIT, SCALAR_LIMIT);
        return;
    }
    const uint64_t things = per_point ? t->point_count : t->streamline_count;
    const size_t each = array.type->size * array.components;
    const struct trx_view view = trx_open(trx, index);
    if (view.size % each || view.size / each != things) {
        refuse_size(trx->job, name, view.size, things, each);
    }
    const size_t count = view.size / array.type->size;
    tract_build_scalar(trx->build, array.name, per_point, array.components);
    float *values = take_array(trx, count, sizeof *values, "numbers");
    for (size_t i = 0; values && i < count; i++) {
        values[i] = trx_number_at(view.data + i * array.type->size, array.type);
    }
    trx_close(trx, &view);
    if (values) {
        t->scalars[t->scalar_count - 1].values = values;
    }
}

/* Sorts the members where they are not, and leaves each once. */
static void settle_group(struct job *job, struct tract_group *group)
{
    bool ascends = true;
    for (size_t i = 1; i < group->count; i++) {
        ascends = ascends && group->members[i - 1] < group->members[i];
    }
    const size_t count = ascends ? group->count : u32_sort_unique(group->members, group->count);
    if (count < group->count) {
        job_note(job, "group '%s': %zu of its streamlines are there twice, taken once", group->name,
                 group->count - count);
    }
    group->count = count;
}

/* A new group, all 0 but for its name; NULL after a failure. */
static struct tract_group *add_group(struct trx *trx, struct text name)
{
    struct tractogram *t = &trx->build->tractogram;
    char *words = job_step(trx->job) ? text_to_utf8(name) : NULL;
    if (!job_need(trx->job, words)) {
        return NULL;
    }
    if (!memory_reserve(&t->groups, &trx->group_capacity, t->group_count + 1, sizeof *t->groups)) {
        memory_free(words);
        job_need(trx->job, NULL);
        return NULL;
    }
    t->groups[t->group_count] = (struct tract_group){.name = words};
    return &t->groups[t->group_count++];
}

static void read_group(struct trx *trx, struct text rest, size_t index)
{
    const struct text name = name_of(trx, index);
    struct text type = {0};
    if (!cut_part(&rest, &type) || !rest.size || !text_equal(type, "uint32")) {
        job_bad(trx->job, "%.*s: a group is NAME.uint32", TEXT_SHOW(name, SHOWN));
    }
    struct tract_group *group = add_group(trx, rest);
    if (!group) {
        return;
    }
    const struct trx_view view = trx_open(trx, index);
    if (view.size % sizeof(uint32_t)) {
        job_bad(trx->job, "%.*s: %zu bytes, each number has 4", TEXT_SHOW(name, SHOWN), view.size);
    }
    const size_t count = view.size / sizeof(uint32_t);
    group->members = take_array(trx, count, sizeof *group->members, "groups");
    for (size_t i = 0; group->members && i < count; i++) {
        group->members[i] = order_u32(view.data + i * sizeof(uint32_t), is_swapped);
    }
    trx_close(trx, &view);
    group->count = group->members ? count : 0;
    settle_group(trx->job, group);
}

static void read_others(struct trx *trx)
{
    for (size_t i = 0; job_ok(trx->job) && i < file_count(trx); i++) {
        struct text name = name_of(trx, i);
        struct text rest;
        if (is_in(&rest, name, "dps/") || is_in(&rest, name, "dpv/")) {
            read_scalar(trx, rest, i, name.data[2] == 'v');
        } else if (is_in(&rest, name, "groups/")) {
            read_group(trx, rest, i);
        } else if (text_starts(name, "dpg/") || text_equal(name, "dpg")) {
            trx->has_group_values = true;
        } else if (!text_starts(name, "offsets.") && !text_starts(name, "positions.") &&
                   !text_equal(name, "header.json")) {
            pass_over(trx, name);
        }
    }
    if (trx->has_group_values) {
        job_note(trx->job, "dpg: values of groups are not read");
    }
    if (trx->passed_over) {
        job_note(trx->job, "%.*s: no array that is read; there are %zu such files", TEXT_SHOW(trx->passed_first, SHOWN),
                 trx->passed_over);
    }
}

/* The numbers from byte `at` on move to the front of `data`, which becomes the tractogram's. Each is written before or
 * where it was, so that none is lost. */
static void settle_positions(struct tractogram *out, uint8_t *data, size_t at, const struct type *type)
{
    size_t count = (size_t)out->point_count * 3;
    size_t size = type->size == 2 ? sizeof(uint16_t) : sizeof(float);
    const uint8_t *from = data + at;
    if (!is_swapped && type->size == size) {
        memmove(data, from, count * size);
    } else if (type->size == 2) {
        for (size_t i = 0; i < count; i++) {
            ((uint16_t *)data)[i] = order_u16(from + 2 * i, is_swapped);
        }
    } else {
        for (size_t i = 0; i < count; i++) {
            ((float *)data)[i] = trx_number_at(from + i * type->size, type);
        }
    }
    void *less = memory_resize(data, count, size);
    void *numbers = less ? less : data;
    out->halves = type->size == 2 ? numbers : NULL;
    out->points = type->size == 2 ? NULL : numbers;
}

static void read_positions(struct trx *trx)
{
    static const char needed[] = "positions.3.float16, .float32 or .float64 is needed";
    struct tractogram *t = &trx->build->tractogram;
    struct array array;
    const size_t index = find_array(trx, "positions.");
    if (index == SIZE_MAX) {
        if (t->point_count) {
            job_bad(trx->job, "positions: missing; %s", needed);
        }
        return;
    }
    const struct text name = name_of(trx, index);
    const bool good = read_name(&array, name) && text_equal(array.name, "positions") && array.components == 3;
    if (!good || !array.type || array.type->kind != REAL) {
        job_bad(trx->job, "%.*s: %s", TEXT_SHOW(name, SHOWN), needed);
        return;
    }
    const bool is_packed = !trx->folder && trx->zip.entries[index].is_packed;
    snprintf(t->format, sizeof t->format, "TRX, %s, %s",
             trx->folder ? "folder"
             : is_packed ? "packed zip"
                         : "zip",
             array.type->name);
    const size_t each = 3 * array.type->size;
    const struct trx_view view = trx_open(trx, index);
    if (view.size % each || view.size / each != t->point_count) {
        refuse_size(trx->job, name, view.size, t->point_count, each);
    }
    const size_t at = job_ok(trx->job) ? (size_t)(view.data - view.block) : 0;
    uint8_t *block = job_give(trx->job, view.block, at + view.size); /* no other file is read behind this one */
    if (block) {
        settle_positions(t, block, at, array.type);
    }
}

void trx_read(struct job *job, struct source *source, struct tract_build *build)
{
    struct trx trx = {.job = job, .build = build, .folder = source->head.is_folder ? source->file.path : NULL};
    for (size_t i = 0; trx.folder && i < sizeof folders / sizeof folders[0]; i++) {
        list_in(&trx, folders[i]);
    }
    if (source->is_packed) { /* a zip has its table at the end, behind all of that */
        job_refuse(job, "a TRX inside gzip: a TRX is packed itself; unpack the gzip");
    }
    if (!trx.folder) {
        trx.archive = source_bytes(job, source, memory_limit(job->max_memory));
        spend(&trx, trx.archive.size, "archive");
        trx.zip = job_ok(job) ? zip_parse(job, trx.archive.data, trx.archive.size) : trx.zip;
    }
    snprintf(build->tractogram.format, sizeof build->tractogram.format, "TRX, %s", trx.folder ? "folder" : "zip");
    trx_read_header(&trx);
    if (!job_ok(job)) {
        return;
    }
    read_offsets(&trx);
    read_others(&trx);
    if (job_ok(job)) {
        read_positions(&trx);
    }
}
