/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes tables of the rows of studies, and gives what they hold. */
#include "selection/table/table.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

/* So many words of a column are compared one by one before others are looked up; so many texts are known by address. */
enum { FEW_WORDS = 16, KNOWN_TEXTS = 128 };

/* Batches make a table for each pose: the arrays of all columns lie behind it in one block. */
struct conus_table {
    atomic_size_t holders;
    size_t row_count, column_count;
    char *words;             /* The letters of all words; owned. */
    const uint32_t *objects; /* [row_count] */
    struct table_question asked;
    const struct table_fields *fields;
    conus_frame frame;
    struct {
        const char *name;
        conus_table *table; /* Held. */
    } parts[TABLE_PART_LIMIT];
    size_t part_count;
    conus_column columns[]; /* [column_count] */
};

/* The rows that become a table, and where its next arrays begin: of elements of 8 bytes, of 4 and of 1. */
struct made_of {
    const struct table_source *source;
    const char *rows;
    size_t size, count;
    char *eights, *fours, *ones;
};

/* The next array, with an element more than there are rows. */
static void *take(char **from, const struct made_of *of, size_t size)
{
    char *array = *from;
    *from += (of->count + 1) * size;
    return array;
}

struct cell table_kind(const struct table_source *source, const void *row, size_t index)
{
    (void)source;
    (void)index;
    return text_cell(atlas_kind_word(((const struct table_object *)row)->kind));
}

static const conus_object *object_of(const struct table_source *source, const void *row)
{
    return conus_atlas_object(source->atlas, ((const struct table_object *)row)->number);
}

struct cell table_index(const struct table_source *source, const void *row, size_t index)
{
    const conus_object *object = object_of(source, row);
    (void)index;
    return object ? integer_cell(object->label) : no_cell();
}

struct cell table_object_name(const struct table_source *source, const void *row, size_t index)
{
    const conus_object *object = object_of(source, row);
    (void)index;
    return text_cell(object ? object->name : "unassigned");
}

struct cell table_abbreviation(const struct table_source *source, const void *row, size_t index)
{
    const conus_object *object = object_of(source, row);
    (void)index;
    return object ? text_cell(object->abbreviation) : no_cell();
}

struct cell table_place(const struct table_source *source, const void *row, size_t index)
{
    (void)source;
    (void)row;
    return integer_cell(index + 1);
}

bool table_has_field(const conus_atlas *atlas, const struct table_field *field)
{
    return field->type < COLUMN_OWN_X || atlas->is_moved;
}

static conus_type type_of(const struct table_field *field)
{
    switch (field->type) {
    case COLUMN_NAME:
    case COLUMN_TEXT:
        return CONUS_TYPE_TEXT;
    case COLUMN_LABEL:
    case COLUMN_COUNT:
    case COLUMN_LARGE_COUNT:
    case COLUMN_RANK:
    case COLUMN_LARGE_RANK:
    case COLUMN_FLAG:
        return CONUS_TYPE_COUNT;
    default:
        return CONUS_TYPE_NUMBER;
    }
}

static struct cell field_cell(const struct table_field *field, const struct made_of *of, size_t index)
{
    const char *row = of->rows + index * of->size;
    return field->get ? field->get(of->source, row, index)
                      : cell_at(field->type, row + field->offset, of->source->atlas, of->source->frame);
}

/* Infinities are kept: only where cell_at() has the unit of files, n/a stands for both. */
static void fill_numbers(conus_column *column, const struct table_field *field, struct made_of *of)
{
    double *numbers = take(&of->eights, of, sizeof *numbers);
    const char *at = of->rows + field->offset;
    bool is_plain = !field->get && field->type == COLUMN_NUMBER;
    column->numbers = numbers;
    for (size_t i = 0; i < of->count && is_plain; i++, at += of->size) {
        numbers[i] = *(const double *)(const void *)at;
    }
    for (size_t i = 0; i < of->count && !is_plain; i++) {
        struct cell cell = field_cell(field, of, i);
        numbers[i] = cell.type == CELL_NUMBER ? cell.number : NAN;
    }
}

/* x, y and z of a point, whose fields are side by side. */
static void fill_points(conus_column *columns, const struct table_field *field, struct made_of *of)
{
    double *numbers[3];
    for (int a = 0; a < 3; a++) {
        columns[a].numbers = numbers[a] = take(&of->eights, of, sizeof **numbers);
    }
    const char *at = of->rows + field->offset;
    for (size_t i = 0; i < of->count; i++, at += of->size) {
        double point[3];
        cell_point(point, field->type, (const double *)(const void *)at, of->source->atlas, of->source->frame);
        for (int a = 0; a < 3; a++) {
            numbers[a][i] = isfinite(point[a]) ? point[a] : NAN;
        }
    }
}

static void fill_counts(conus_column *column, const struct table_field *field, struct made_of *of)
{
    int64_t *counts = take(&of->eights, of, sizeof *counts);
    bool *missing = take(&of->ones, of, sizeof *missing);
    column->counts = counts;
    for (size_t i = 0; i < of->count; i++) {
        struct cell cell = field_cell(field, of, i);
        missing[i] = cell.type == CELL_NONE;
        column->missing = missing[i] ? missing : column->missing;
        counts[i] = (int64_t)cell.integer;
    }
}

/* The code of a text, which is added to the words of the column if it is a new one. */
static conus_status find_code(uint32_t *code, const char **words, size_t *count, struct name_set *known,
                              const char *text)
{
    size_t few = *count < FEW_WORDS ? *count : FEW_WORDS;
    size_t place = 1;
    while (place < few && strcmp(words[place], text) != 0) {
        place++;
    }
    const struct known_name *found = place < few ? NULL : name_set_find(known, text); /* of those behind the few */
    *code = (uint32_t)(place < few ? place : found ? found->value : *count);
    if (*code < *count) {
        return CONUS_OK;
    }
    words[(*count)++] = text;
    return *count > FEW_WORDS ? name_set_add(known, text, *code) : CONUS_OK;
}

static conus_status fill_texts(conus_column *column, const struct table_field *field, struct made_of *of)
{
    uint32_t *codes = take(&of->fours, of, sizeof *codes);
    const char **words = take(&of->eights, of, sizeof *words);
    column->texts = take(&of->eights, of, sizeof *column->texts);
    column->codes = codes;
    column->words = words;
    column->word_count = 1;
    words[0] = NULL;
    const char *met[KNOWN_TEXTS] = {NULL}; /* and where in codes: rows repeat the atlas's names */
    size_t met_at[KNOWN_TEXTS];
    struct name_set known = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < of->count && !status; i++) {
        const char *text = field_cell(field, of, i).text;
        const uintptr_t address = (uintptr_t)text;
        const size_t slot = (address >> 3 ^ address >> 10) % KNOWN_TEXTS;
        if (!text || met[slot] == text) {
            codes[i] = text ? codes[met_at[slot]] : 0;
            continue;
        }
        status = find_code(&codes[i], words, &column->word_count, &known, text);
        met[slot] = text;
        met_at[slot] = i;
    }
    name_set_finish(&known);
    return status;
}

/* Fills a column, or the three of a point. */
static conus_status fill_columns(conus_column *columns, const struct table_field *fields, size_t count,
                                 struct made_of *of)
{
    for (size_t i = 0; i < count; i++) {
        const char *unit = count == 3 ? conus_space_unit(of->source->frame->space) : fields[i].unit;
        columns[i] = (conus_column){.name = fields[i].name, .unit = unit ? unit : "", .help = fields[i].help};
        columns[i].type = type_of(&fields[i]);
    }
    assert(count == 1 || (fields[2].type == fields->type + 2 && fields[2].offset == fields->offset));
    if (columns->type == CONUS_TYPE_TEXT) {
        return fill_texts(columns, fields, of);
    }
    (columns->type == CONUS_TYPE_COUNT ? fill_counts : count == 3 ? fill_points : fill_numbers)(columns, fields, of);
    return CONUS_OK;
}

/* Copies the words of all columns, which were borrowed until now, into one block. */
static conus_status own_words(conus_table *table)
{
    size_t size = 0;
    for (size_t i = 0; i < table->column_count; i++) {
        for (size_t k = 1; k < table->columns[i].word_count; k++) {
            size += strlen(table->columns[i].words[k]) + 1;
        }
    }
    char *end = table->words = memory_raw(size, 1);
    for (size_t i = 0; i < table->column_count && end; i++) {
        const conus_column *column = &table->columns[i];
        const char **words = (const char **)column->words;
        const char **texts = (const char **)column->texts;
        for (size_t k = 1; k < column->word_count; k++) {
            size_t length = strlen(words[k]) + 1;
            words[k] = memcpy(end, words[k], length);
            end += length;
        }
        for (size_t k = 0; k < table->row_count && texts; k++) {
            texts[k] = words[column->codes[k]];
        }
    }
    return end ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* A table without rows and columns, and with room for the arrays of all. */
static conus_table *make_table(const struct table_fields *fields, struct made_of *of)
{
    const size_t head = sizeof(conus_table) + fields->count * sizeof(conus_column);
    size_t eights = 0;
    size_t fours = 1; /* the objects */
    size_t ones = 0;
    size_t size;
    for (size_t i = 0; i < fields->count; i++) {
        conus_type type = type_of(&fields->at[i]);
        eights += type == CONUS_TYPE_TEXT ? 2 : 1;
        fours += type == CONUS_TYPE_TEXT;
        ones += type == CONUS_TYPE_COUNT;
    }
    bool fits = memory_multiply(of->count + 1, 8 * eights + 4 * fours + ones, &size) && size < SIZE_MAX - head;
    conus_table *table = memory_raw(fits ? head + size : SIZE_MAX, 1);
    if (table) {
        memset(table, 0, sizeof *table);
        atomic_init(&table->holders, 1);
        of->eights = (char *)table + head;
        of->fours = of->eights + 8 * eights * (of->count + 1);
        of->ones = of->fours + 4 * fours * (of->count + 1);
    }
    return table;
}

static conus_status fill(conus_table *table, const struct table_fields *fields, struct made_of *of)
{
    conus_status status = CONUS_OK;
    table->row_count = of->count;
    for (size_t i = 0, count; i < fields->count && !status; i += count) {
        count = column_is_place(fields->at[i].type) ? 3 : 1;
        if (table_has_field(of->source->atlas, &fields->at[i])) {
            status = fill_columns(&table->columns[table->column_count], &fields->at[i], count, of);
            table->column_count += count;
        }
    }
    uint32_t *objects = status ? NULL : take(&of->fours, of, sizeof *objects);
    for (size_t i = 0; i < of->count && objects; i++) {
        objects[i] = ((const struct table_object *)(const void *)(of->rows + i * of->size))->number;
    }
    table->objects = objects;
    return status ? status : own_words(table);
}

conus_status table_create(conus_table **out, const struct table_source *source, const struct table_fields *fields,
                          const struct table_question *asked, const void *rows, size_t size, size_t count)
{
    struct made_of of = {.source = source, .rows = rows, .size = size, .count = count};
    conus_table *table = make_table(fields, &of);
    if (!table) {
        memory_free(asked->region.path);
        return CONUS_ERROR_MEMORY;
    }
    table->asked = *asked;
    table->fields = fields;
    table->frame = *source->frame;
    conus_status status = fill(table, fields, &of);
    if (status) {
        conus_table_destroy(table);
        return status;
    }
    *out = table;
    return CONUS_OK;
}

conus_status table_of_rows(conus_table **out, const conus_atlas *atlas, const struct table_fields *fields, void *rows,
                           size_t size, size_t count)
{
    conus_frame world = {.space = CONUS_SPACE_RAS};
    mat4_identity(world.world_from_space);
    conus_status status = rows ? table_create(out, &(struct table_source){atlas, &world}, fields,
                                              &(struct table_question){0}, rows, size, count)
                               : CONUS_ERROR_MEMORY;
    memory_free(rows);
    return status;
}

void table_add_part(conus_table *table, const char *name, conus_table *part)
{
    table->parts[table->part_count].name = name;
    table->parts[table->part_count].table = part;
    table->part_count++;
}

conus_table *table_hold(conus_table *table)
{
    atomic_fetch_add_explicit(&table->holders, 1, memory_order_relaxed);
    return table;
}

void conus_table_destroy(conus_table *table)
{
    if (!table || atomic_fetch_sub_explicit(&table->holders, 1, memory_order_acq_rel) > 1) {
        return;
    }
    memory_free(table->words);
    memory_free(table->asked.region.path);
    for (size_t i = 0; i < table->part_count; i++) {
        conus_table_destroy(table->parts[i].table);
    }
    memory_free(table);
}

bool table_is_of(const conus_table *table, const struct table_fields *fields)
{
    return table->fields == fields;
}

bool table_fits(const conus_table *table, const conus_frame *frame)
{
    bool has_places = false;
    for (size_t i = 0; i < table->fields->count && !has_places; i++) {
        has_places = column_is_place(table->fields->at[i].type);
    }
    return !has_places ||
           (table->frame.space == frame->space && mat4_is_same(table->frame.world_from_space, frame->world_from_space));
}

const struct table_question *table_question(const conus_table *table)
{
    return &table->asked;
}

const conus_column *table_columns(const conus_table *table)
{
    return table->columns;
}

size_t conus_table_rows(const conus_table *table)
{
    return table ? table->row_count : 0;
}

const conus_column *conus_table_column(const conus_table *table, size_t index)
{
    return table && index < table->column_count ? &table->columns[index] : NULL;
}

const conus_column *conus_table_find(const conus_table *table, const char *name)
{
    for (size_t i = 0; table && i < table->column_count; i++) {
        if (strcmp(table->columns[i].name, name) == 0) {
            return &table->columns[i];
        }
    }
    return NULL;
}

const double *conus_table_numbers(const conus_table *table, const char *column)
{
    const conus_column *found = conus_table_find(table, column);
    return found ? found->numbers : NULL;
}

const int64_t *conus_table_counts(const conus_table *table, const char *column)
{
    const conus_column *found = conus_table_find(table, column);
    return found ? found->counts : NULL;
}

const char *const *conus_table_texts(const conus_table *table, const char *column)
{
    const conus_column *found = conus_table_find(table, column);
    return found ? found->texts : NULL;
}

const uint32_t *conus_table_objects(const conus_table *table)
{
    return table ? table->objects : NULL;
}

const conus_table *conus_table_part(const conus_table *table, const char *part)
{
    for (size_t i = 0; table && i < table->part_count; i++) {
        if (strcmp(table->parts[i].name, part) == 0) {
            return table->parts[i].table;
        }
    }
    return NULL;
}
