/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses FreeSurfer's labels of vertices: annotations, and labels as text ("#!ascii label", a count, and so many lines
 * "vertex x y z value"). */
#include "loaders/surfaces/parts.h"

#include "base/order.h"
#include "loaders/labels/label_format.h"

#include <stdlib.h>
#include <string.h>

enum { NEW_TABLE = -2, ENTRY_LIMIT = 1 << 20, NOTES_LIMIT = 8, SHOWN = 80 };

/* An entry of the colour table. */
struct entry {
    uint32_t colour; /* packed: red + 256 green + 65536 blue */
    uint32_t number;
    struct text name;
};

/* Sorted by colour, then number. */
struct colours {
    LIST(struct entry) entries;
};

static int32_t read_int(struct reader *r, const char *field, int32_t low, int32_t high)
{
    if (!reader_has(r, 4)) {
        job_bad(r->job, "%s: the file ends before it", field);
    }
    const int32_t value = (int32_t)reader_u32(r);
    if (value < low || value > high) {
        job_bad(r->job, "%s: found %d, allowed are %d to %d", field, value, low, high);
        return 0;
    }
    return value;
}

/* A length, and so many bytes with a NUL at their end. */
static struct text read_text(struct reader *r, const char *field)
{
    const size_t length = (size_t)read_int(r, field, 0, INT32_MAX);
    if (length > reader_most(r)) {
        job_bad(r->job, "%s: %zu bytes long, %llu are left", field, length, (unsigned long long)reader_most(r));
    }
    const struct text text = reader_keep(r, length);
    return (struct text){text.data, strnlen(text.data, text.size)};
}

/* Pairs of a vertex and its colour: gives the colours by vertex, without opacity. */
static uint32_t *read_vertices(struct reader *r, size_t *count)
{
    static const uint32_t UNSEEN = UINT32_MAX;
    struct job *job = r->job;
    *count = (size_t)read_int(r, "number of vertices", 1, INT32_MAX);
    if (*count > reader_most(r) / 8) {
        job_bad(job, "number of vertices: found %zu, the file has %llu bytes for them, 8 each", *count,
                (unsigned long long)reader_most(r));
    }
    uint32_t *colours = job_array(job, count, sizeof *colours);
    for (size_t i = 0; i < *count; i++) {
        colours[i] = UNSEEN;
    }
    size_t size = 1;
    for (size_t i = 0; i < *count && size && job_ok(job);) {
        const uint8_t *data = reader_some(r, 8 * (uint64_t)(*count - i), 8, &size);
        for (size_t k = 0; k < size && job_ok(job); k += 8, i++) {
            const uint32_t vertex = order_u32(data + k, r->swapped);
            if (vertex >= *count || colours[vertex] != UNSEEN) {
                job_bad(job, "pair %zu: vertex %d%s, allowed are 0 to %zu, each once", i, (int)vertex,
                        vertex < *count ? " again" : "", *count - 1);
            } else {
                colours[vertex] = order_u32(data + k + 4, r->swapped) & 0xffffff;
            }
        }
    }
    if (!size) {
        job_bad(job, "cut off at byte %llu, within the colours of its vertices", (unsigned long long)reader_at(r));
    }
    return colours;
}

static void read_entries(struct reader *r, struct colours *colours, bool numbered, int32_t count)
{
    for (int32_t i = 0; i < count && job_ok(r->job); i++) {
        const int32_t number = numbered ? read_int(r, "colour table: number", 0, INT32_MAX - 1) : i;
        const struct text name = read_text(r, "colour table: name");
        uint32_t rgbt[4];
        for (int k = 0; k < 4; k++) {
            rgbt[k] = (uint32_t)read_int(r, "colour table: colour", 0, 255);
        }
        *LIST_ADD(r->job, &colours->entries) =
            (struct entry){rgbt[0] | rgbt[1] << 8 | rgbt[2] << 16, (uint32_t)number, name};
    }
}

/* Old: the number of entries, where the table is from, the entries. New: -2, a bound of the numbers, where it is from,
 * the number of entries, the entries with their numbers. */
static void read_table(struct reader *r, struct colours *colours)
{
    struct job *job = r->job;
    if (!read_int(r, "colour table: flag", 0, 1)) {
        job_refuse(job, "colour table: there is none, and without it areas have no names");
    }
    int32_t count = read_int(r, "colour table: size or version", NEW_TABLE, ENTRY_LIMIT);
    const bool numbered = count == NEW_TABLE;
    if (count == 0 || count == -1) {
        job_bad(job, "colour table: size or version: found %d, allowed are 1 or more, and -2", count);
    }
    if (numbered) {
        (void)read_int(r, "colour table: bound", 0, INT32_MAX);
    }
    (void)read_text(r, "colour table: origin");
    if (numbered) {
        count = read_int(r, "colour table: size", 1, ENTRY_LIMIT);
    }
    read_entries(r, colours, numbered, count);
}

static int compare_entries(const void *a, const void *b)
{
    const struct entry *x = a;
    const struct entry *y = b;
    int order = compare_unsigned(x->colour, y->colour);
    return order ? order : compare_unsigned(x->number, y->number);
}

static void note_colours(struct job *job, const struct colours *colours)
{
    size_t collisions = 0;
    for (size_t i = 0; i < colours->entries.count; i++) {
        const struct entry *entry = &colours->entries.at[i];
        const struct entry *before = i ? entry - 1 : NULL;
        if (!entry->colour && !label_is_background(entry->name)) {
            job_note(job, "\"%.*s\" is black, which stands for unlabelled vertices, too: it has none",
                     TEXT_SHOW(entry->name, SHOWN));
        } else if (before && before->colour == entry->colour && entry->colour && collisions++ < NOTES_LIMIT) {
            job_warn(job,
                     "\"%.*s\" has the colour of \"%.*s\", by which vertices name their area: all are taken for the "
                     "latter's",
                     TEXT_SHOW(entry->name, SHOWN), TEXT_SHOW(before->name, SHOWN));
        }
    }
    if (collisions > NOTES_LIMIT) {
        job_warn(job, "%zu areas in all share the colour of another", collisions);
    }
}

/* Entry 0 cannot be label 0, which is no area. */
static void move_entry_0(struct job *job, struct colours *colours)
{
    uint32_t next = 0;
    for (size_t i = 0; i < colours->entries.count; i++) {
        const uint32_t number = colours->entries.at[i].number;
        next = number >= next ? number + 1 : next;
    }
    for (size_t i = 0; i < colours->entries.count; i++) {
        struct entry *entry = &colours->entries.at[i];
        if (entry->number == 0 && entry->colour && !label_is_background(entry->name)) {
            entry->number = next++;
            job_note(job, "entry 0 of the colour table, \"%.*s\", has label %u, since 0 is no area",
                     TEXT_SHOW(entry->name, SHOWN), entry->number);
        }
    }
}

static int compare_colour(const void *key, const void *item)
{
    return compare_unsigned(*(const uint32_t *)key, ((const struct entry *)item)->colour);
}

static const struct entry *find_entry(const struct colours *colours, uint32_t colour)
{
    const struct entry *first = colours->entries.at;
    const struct entry *entry = bsearch(&colour, first, colours->entries.count, sizeof *first, compare_colour);
    while (entry && entry > first && entry[-1].colour == colour) {
        entry--;
    }
    return entry;
}

static void find_labels(struct job *job, uint32_t *labels, size_t count, const struct colours *colours)
{
    size_t strangers = 0;
    for (size_t i = 0; i < count; i++) {
        const struct entry *entry = labels[i] ? find_entry(colours, labels[i]) : NULL;
        strangers += labels[i] && !entry;
        labels[i] = entry ? entry->number : 0;
    }
    if (strangers) {
        job_note(job, "%zu vertices have colours that the colour table lacks, and belong to no area", strangers);
    }
}

static void fill_table(struct job *job, struct label_table *table, const struct colours *colours)
{
    for (size_t i = 0; i < colours->entries.count; i++) {
        const struct entry *entry = &colours->entries.at[i];
        if (entry->number) {
            struct label_row row = {.label = {.number = entry->number, .has_rgb = true}, .name = entry->name};
            for (int c = 0; c < 3; c++) {
                row.label.rgb[c] = (uint8_t)(entry->colour >> 8 * c);
            }
            labels_keep(job, table, &row);
        }
    }
    labels_sort(job, table);
}

uint32_t *freesurfer_annot_read(struct reader *r, struct label_table *table, size_t *count)
{
    struct colours colours = {0};
    r->swapped = BIG_ENDIAN_IS_SWAPPED;
    uint32_t *labels = read_vertices(r, count);
    read_table(r, &colours);
    if (!job_ok(r->job)) {
        *count = 0;
        return NULL;
    }
    order_sort(colours.entries.at, colours.entries.count, sizeof *colours.entries.at, compare_entries);
    note_colours(r->job, &colours);
    move_entry_0(r->job, &colours);
    find_labels(r->job, labels, *count, &colours);
    fill_table(r->job, table, &colours);
    return job_ok(r->job) ? labels : NULL;
}

enum { VERTEX_LIMIT = 1 << 24 }; /* more than any cortex has; each takes 4 bytes */

/* The vertex that the next line names: a number that is followed by four. */
static uint32_t next_vertex(struct job *job, struct text *rest, size_t line)
{
    struct text row;
    struct text word;
    uint64_t vertex = 0;
    double number = 0;
    size_t words = 0;
    bool good = text_line(rest, &row);
    bool has_vertex = good && text_word(&row, &word) && text_to_uint(word, VERTEX_LIMIT - 1, &vertex);
    if (good && !has_vertex && text_to_double(word, &number) && number == -1) {
        job_bad(job, "line %zu: vertex -1: this label is of voxels, not of a surface's vertices", line);
    }
    while (has_vertex && text_word(&row, &word)) {
        good = good && text_to_double(word, &number);
        words++;
    }
    if (!has_vertex || !good || words != 4) {
        job_bad(job, "line %zu: a vertex, 0 to %d, and four numbers are needed", line, VERTEX_LIMIT - 1);
    }
    return (uint32_t)vertex;
}

uint32_t *freesurfer_label_read(struct job *job, struct text text, size_t *count)
{
    LIST(uint32_t) vertices = {0};
    struct text line;
    uint64_t rows = 0;
    size_t last = 0;
    bool good = text_line(&text, &line); /* what the file is */
    if (!good || !text_line(&text, &line) || !text_to_uint(text_trim(line), VERTEX_LIMIT, &rows) || !rows) {
        job_bad(job, "line 2: the number of vertices, 1 to %d, is needed", VERTEX_LIMIT);
    }
    for (size_t i = 0; i < rows && job_ok(job); i++) {
        const uint32_t vertex = next_vertex(job, &text, i + 3);
        last = vertex > last ? vertex : last;
        *LIST_ADD(job, &vertices) = vertex;
    }
    if (text_trim(text).size) {
        job_bad(job, "line 2: %llu vertices, but more lines follow", (unsigned long long)rows);
    }
    *count = last + 1;
    uint32_t *labels = job_zeroed(job, *count, sizeof *labels);
    for (size_t i = 0; labels && i < vertices.count; i++) {
        labels[vertices.at[i]] = 1;
    }
    *count = labels ? *count : 0;
    return labels;
}
