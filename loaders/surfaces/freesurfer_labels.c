/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses FreeSurfer's labels of vertices: annotations, and labels as text ("#!ascii label", a count, and so many lines
 * "vertex x y z value"). */
#include "loaders/surfaces/freesurfer_labels.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/labels/label_cells.h"

#include <stdlib.h>

enum { NEW_TABLE = -2, ENTRY_LIMIT = 1 << 20, NOTES_LIMIT = 8 };

/* An entry of the colour table. */
struct entry {
    uint32_t colour; /* packed: red + 256 green + 65536 blue */
    uint32_t number;
    struct text name;
};

struct annot {
    const uint8_t *data; /* what is left to read */
    size_t size;
    const uint8_t *vertices; /* [count] pairs of vertex and colour */
    size_t count;
    struct entry *entries; /* sorted by colour, then number */
    size_t entry_count;
    struct notes *notes;
};

static conus_status annot_take_int(struct annot *annot, const char *field, int32_t low, int32_t high, int32_t *out)
{
    if (annot->size < 4) {
        return fail(CONUS_ERROR_DATA, "%s: the file ends before it", field);
    }
    int32_t value = order_i32(annot->data, BIG_ENDIAN_IS_SWAPPED);
    if (value < low || value > high) {
        return fail(CONUS_ERROR_DATA, "%s: found %d, allowed are %d to %d", field, value, low, high);
    }
    annot->data += 4;
    annot->size -= 4;
    *out = value;
    return CONUS_OK;
}

/* A length, and so many bytes with a NUL at their end. */
static conus_status take_text(struct annot *annot, const char *field, struct text *out)
{
    int32_t length = 0;
    conus_status status = annot_take_int(annot, field, 0, INT32_MAX, &length);
    if (status) {
        return status;
    }
    if ((size_t)length > annot->size) {
        return fail(CONUS_ERROR_DATA, "%s: %d bytes long, %zu are left", field, length, annot->size);
    }
    *out = (struct text){(const char *)annot->data, strnlen((const char *)annot->data, (size_t)length)};
    annot->data += length;
    annot->size -= (size_t)length;
    return CONUS_OK;
}

static conus_status take_vertices(struct annot *annot)
{
    int32_t count = 0;
    conus_status status = annot_take_int(annot, "number of vertices", 1, INT32_MAX, &count);
    if (status) {
        return status;
    }
    if ((uint64_t)count > annot->size / 8) {
        return fail(CONUS_ERROR_DATA, "number of vertices: found %d, the file has %zu bytes for them, 8 each", count,
                    annot->size);
    }
    annot->vertices = annot->data;
    annot->count = (size_t)count;
    annot->data += 8 * annot->count;
    annot->size -= 8 * annot->count;
    return CONUS_OK;
}

static conus_status take_entries(struct annot *annot, bool numbered, int32_t count)
{
    annot->entries = memory_raw((size_t)count, sizeof *annot->entries);
    if (!annot->entries) {
        return CONUS_ERROR_MEMORY;
    }
    for (int32_t i = 0; i < count; i++) {
        struct text name = {0};
        int32_t number = i;
        int32_t rgbt[4] = {0};
        conus_status status =
            numbered ? annot_take_int(annot, "colour table: number", 0, INT32_MAX - 1, &number) : CONUS_OK;
        status = status ? status : take_text(annot, "colour table: name", &name);
        for (int k = 0; !status && k < 4; k++) {
            status = annot_take_int(annot, "colour table: colour", 0, 255, &rgbt[k]);
        }
        if (status) {
            return status;
        }
        uint32_t colour = (uint32_t)rgbt[0] | (uint32_t)rgbt[1] << 8 | (uint32_t)rgbt[2] << 16;
        annot->entries[annot->entry_count++] = (struct entry){colour, (uint32_t)number, name};
    }
    return CONUS_OK;
}

/* Old: the number of entries, where the table is from, the entries. New: -2, a bound of the numbers, where it is from,
 * the number of entries, the entries with their numbers. */
static conus_status take_table(struct annot *annot)
{
    int32_t there = 0;
    int32_t first = 0;
    struct text origin;
    int32_t bound = 0;
    conus_status status = annot_take_int(annot, "colour table: flag", 0, 1, &there);
    if (status) {
        return status;
    }
    if (!there) {
        return fail(CONUS_ERROR_UNSUPPORTED, "colour table: there is none, and without it areas have no names");
    }
    status = annot_take_int(annot, "colour table: size or version", NEW_TABLE, ENTRY_LIMIT, &first);
    if (status) {
        return status;
    }
    if (first == 0 || first == -1) {
        return fail(CONUS_ERROR_DATA, "colour table: size or version: found %d, allowed are 1 or more, and -2", first);
    }
    bool numbered = first == NEW_TABLE;
    int32_t count = first;
    if ((numbered && (status = annot_take_int(annot, "colour table: bound", 0, INT32_MAX, &bound))) ||
        (status = take_text(annot, "colour table: origin", &origin)) ||
        (numbered && (status = annot_take_int(annot, "colour table: size", 1, ENTRY_LIMIT, &count)))) {
        return status;
    }
    return take_entries(annot, numbered, count);
}

static int compare_entries(const void *a, const void *b)
{
    const struct entry *x = a;
    const struct entry *y = b;
    int order = compare_unsigned(x->colour, y->colour);
    return order ? order : compare_unsigned(x->number, y->number);
}

/* Notes the entries that the packed colours cannot tell apart. */
static conus_status note_colours(const struct annot *annot)
{
    conus_status status = CONUS_OK;
    size_t collisions = 0;
    for (size_t i = 0; !status && i < annot->entry_count; i++) {
        const struct entry *entry = &annot->entries[i];
        const struct entry *before = i ? entry - 1 : NULL;
        int length = (int)(entry->name.size < 80 ? entry->name.size : 80);
        if (!entry->colour && !label_is_background(entry->name)) {
            status =
                notes_add(annot->notes, "\"%.*s\" is black, which stands for unlabelled vertices, too: it has none",
                          length, entry->name.data);
        } else if (before && before->colour == entry->colour && entry->colour && collisions++ < NOTES_LIMIT) {
            status = notes_warn(annot->notes,
                                "\"%.*s\" has the colour of \"%.*s\", by which vertices name their area: all are taken "
                                "for the latter's",
                                length, entry->name.data, TEXT_SHOW(before->name, 80));
        }
    }
    return status || collisions <= NOTES_LIMIT
               ? status
               : notes_warn(annot->notes, "%zu areas in all share the colour of another", collisions);
}

/* Entry 0 cannot be label 0, which is no area. */
static conus_status move_entry_0(struct annot *annot)
{
    uint32_t next = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < annot->entry_count; i++) {
        next = annot->entries[i].number >= next ? annot->entries[i].number + 1 : next;
    }
    for (size_t i = 0; !status && i < annot->entry_count; i++) {
        struct entry *entry = &annot->entries[i];
        if (entry->number == 0 && entry->colour && !label_is_background(entry->name)) {
            entry->number = next++;
            status = notes_add(annot->notes, "entry 0 of the colour table, \"%.*s\", has label %u, since 0 is no area",
                               TEXT_SHOW(entry->name, 80), entry->number);
        }
    }
    return status;
}

static int compare_colour(const void *key, const void *item)
{
    return compare_unsigned(*(const uint32_t *)key, ((const struct entry *)item)->colour);
}

/* The first entry of a colour. */
static const struct entry *find_entry(const struct annot *annot, uint32_t colour)
{
    const struct entry *entry =
        bsearch(&colour, annot->entries, annot->entry_count, sizeof *annot->entries, compare_colour);
    while (entry && entry > annot->entries && entry[-1].colour == colour) {
        entry--;
    }
    return entry;
}

static conus_status annot_fill_labels(uint32_t *labels, const struct annot *annot)
{
    static const uint32_t UNSEEN = UINT32_MAX;
    size_t strangers = 0;
    memset(labels, 0xff, annot->count * sizeof *labels);
    for (size_t i = 0; i < annot->count; i++) {
        uint32_t vertex = order_u32(annot->vertices + 8 * i, BIG_ENDIAN_IS_SWAPPED);
        uint32_t colour = order_u32(annot->vertices + 8 * i + 4, BIG_ENDIAN_IS_SWAPPED) & 0xffffff; /* no opacity */
        if (vertex >= annot->count || labels[vertex] != UNSEEN) {
            return fail(CONUS_ERROR_DATA, "pair %zu: vertex %d%s, allowed are 0 to %zu, each once", i, (int)vertex,
                        vertex < annot->count ? " again" : "", annot->count - 1);
        }
        const struct entry *entry = colour ? find_entry(annot, colour) : NULL;
        labels[vertex] = entry ? entry->number : 0;
        strangers += colour && !entry;
    }
    return strangers ? notes_add(annot->notes,
                                 "%zu vertices have colours that the colour table lacks, and belong to no "
                                 "area",
                                 strangers)
                     : CONUS_OK;
}

static conus_status fill_table(struct label_table *table, const struct annot *annot)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    for (size_t i = 0; job_ok(&job) && i < annot->entry_count; i++) {
        const struct entry *entry = &annot->entries[i];
        if (entry->number) {
            struct label_row row = {.label = {.number = entry->number, .has_rgb = true}, .name = entry->name};
            for (int c = 0; c < 3; c++) {
                row.label.rgb[c] = (uint8_t)(entry->colour >> 8 * c);
            }
            labels_keep(&job, table, &row);
        }
    }
    labels_sort(&job, table);
    return job_close(&job, annot->notes, NULL);
}

conus_status freesurfer_annot_parse(uint32_t **labels, size_t *count, struct label_table *table, const uint8_t *data,
                                    size_t size, struct notes *notes)
{
    struct annot annot = {.data = data, .size = size, .notes = notes};
    struct label_table entries = {0};
    uint32_t *out = NULL;
    conus_status status = take_vertices(&annot);
    status = status ? status : take_table(&annot);
    if (!status) {
        order_sort(annot.entries, annot.entry_count, sizeof *annot.entries, compare_entries);
        out = memory_raw(annot.count, sizeof *out);
        status = out ? note_colours(&annot) : CONUS_ERROR_MEMORY;
    }
    status = status ? status : move_entry_0(&annot);
    status = status ? status : annot_fill_labels(out, &annot);
    status = status ? status : fill_table(&entries, &annot);
    memory_free(annot.entries);
    if (status) {
        memory_free(out);
        label_table_finish(&entries);
        return status;
    }
    *labels = out;
    *count = annot.count;
    *table = entries;
    return CONUS_OK;
}

enum { VERTEX_LIMIT = 1 << 24 }; /* more than any cortex has; each takes 4 bytes */

/* The vertex that the next line names: a number that is followed by four. */
static conus_status next_vertex(uint64_t *out, struct text *rest, size_t line)
{
    struct text row;
    struct text word;
    double number = 0;
    size_t words = 0;
    bool good = text_line(rest, &row);
    bool has_vertex = good && text_word(&row, &word) && text_to_uint(word, VERTEX_LIMIT - 1, out);
    if (good && !has_vertex && text_to_double(word, &number) && number == -1) {
        return fail(CONUS_ERROR_DATA, "line %zu: vertex -1: this label is of voxels, not of a surface's vertices",
                    line);
    }
    while (has_vertex && text_word(&row, &word)) {
        good = good && text_to_double(word, &number);
        words++;
    }
    return has_vertex && good && words == 4
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "line %zu: a vertex, 0 to %d, and four numbers are needed", line,
                      VERTEX_LIMIT - 1);
}

conus_status freesurfer_label_parse(uint32_t **labels, size_t *count, struct text text)
{
    struct text rest = text;
    struct text line;
    uint64_t rows = 0;
    uint64_t vertex = 0;
    uint64_t last = 0;
    bool good = text_line(&rest, &line); /* what the file is */
    if (!good || !text_line(&rest, &line) || !text_to_uint(text_trim(line), VERTEX_LIMIT, &rows) || !rows) {
        return fail(CONUS_ERROR_DATA, "line 2: the number of vertices, 1 to %d, is needed", VERTEX_LIMIT);
    }
    struct text again = rest;
    for (uint64_t i = 0; i < rows; i++) {
        conus_status status = next_vertex(&vertex, &rest, (size_t)i + 3);
        if (status) {
            return status;
        }
        last = vertex > last ? vertex : last;
    }
    if (text_trim(rest).size) {
        return fail(CONUS_ERROR_DATA, "line 2: %llu vertices, but more lines follow", (unsigned long long)rows);
    }
    uint32_t *out = memory_zeroed((size_t)last + 1, sizeof *out);
    if (!out) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint64_t i = 0; i < rows; i++) {
        (void)next_vertex(&vertex, &again, 0); /* it was good before */
        out[vertex] = 1;
    }
    *labels = out;
    *count = (size_t)last + 1;
    return CONUS_OK;
}
