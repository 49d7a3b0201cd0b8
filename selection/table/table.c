/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes tables of the rows of studies, and gives what they hold. */
#include "selection/table/table.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/name_set.h"

#include <stdatomic.h>
#include <string.h>

struct conus_table {
    atomic_size_t holders;
    size_t row_count, column_count;
    conus_column *columns; /* [column_count] Their arrays and words are owned. */
    uint32_t *objects;     /* [row_count] */
    struct table_question asked;
    const struct table_fields *fields;
    conus_frame frame;
    struct {
        const char *name;
        conus_table *table; /* Held. */
    } parts[TABLE_PART_LIMIT];
    size_t part_count;
};

/* The rows that become a table. */
struct made_of {
    const struct table_source *source;
    const char *rows;
    size_t size, count;
};

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

static struct cell field_cell(const struct table_field *field, const struct made_of *of, size_t index)
{
    const char *row = of->rows + index * of->size;
    return field->get ? field->get(of->source, row, index)
                      : cell_at(field->type, row + field->offset, of->source->atlas, of->source->frame);
}

/* Infinities are kept: only where cell_at() has the unit of files, n/a stands for both. */
static double field_number(const struct table_field *field, const struct made_of *of, size_t index)
{
    const double *at = (const double *)(const void *)(of->rows + index * of->size + field->offset);
    bool is_plain = !field->get && field->type == COLUMN_NUMBER;
    struct cell cell = is_plain ? no_cell() : field_cell(field, of, index);
    return is_plain ? *at : cell.type == CELL_NUMBER ? cell.number : NAN;
}

static conus_status fill_numbers(conus_column *column, const struct table_field *field, const struct made_of *of)
{
    double *numbers = memory_raw(of->count, sizeof *numbers);
    column->numbers = numbers;
    for (size_t i = 0; numbers && i < of->count; i++) {
        numbers[i] = field_number(field, of, i);
    }
    return numbers ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status fill_counts(conus_column *column, const struct table_field *field, const struct made_of *of)
{
    int64_t *counts = memory_zeroed(of->count, sizeof *counts);
    bool *missing = memory_zeroed(of->count, sizeof *missing);
    size_t missing_count = 0;
    column->counts = counts;
    for (size_t i = 0; counts && missing && i < of->count; i++) {
        struct cell cell = field_cell(field, of, i);
        missing[i] = cell.type == CELL_NONE;
        missing_count += missing[i];
        counts[i] = (int64_t)cell.integer;
    }
    bool is_whole = counts && missing;
    column->missing = missing;
    if (is_whole && !missing_count) {
        memory_free(missing);
        column->missing = NULL;
    }
    return is_whole ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* The code of a text, which is added to the words of the column if it is a new one. */
static conus_status find_code(uint32_t *code, const char **words, size_t *count, struct name_set *known,
                              const char *text)
{
    const struct known_name *found = name_set_find(known, text);
    *code = found ? (uint32_t)found->value : (uint32_t)*count;
    if (found) {
        return CONUS_OK;
    }
    words[(*count)++] = text;
    return name_set_add(known, text, *code);
}

/* Copies the words behind the first into one block, which the second points to. */
static conus_status own_words(const char **words, size_t count)
{
    size_t size = 0;
    for (size_t i = 1; i < count; i++) {
        size += strlen(words[i]) + 1;
    }
    char *block = memory_raw(size, 1);
    char *end = block;
    for (size_t i = 1; i < count && block; i++) {
        size_t length = strlen(words[i]) + 1;
        words[i] = memcpy(end, words[i], length);
        end += length;
    }
    if (count == 1) {
        memory_free(block);
    }
    return block ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status fill_texts(conus_column *column, const struct table_field *field, const struct made_of *of)
{
    uint32_t *codes = memory_zeroed(of->count, sizeof *codes);
    const char **words = memory_zeroed(of->count + 1, sizeof *words);
    const char **texts = memory_zeroed(of->count, sizeof *texts);
    struct name_set known = {0};
    size_t count = 1;
    conus_status status = codes && words && texts ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < of->count && !status; i++) {
        struct cell cell = field_cell(field, of, i);
        status = cell.text ? find_code(&codes[i], words, &count, &known, cell.text) : CONUS_OK;
    }
    name_set_finish(&known);
    status = status ? status : own_words(words, count);
    for (size_t i = 0; i < of->count && !status; i++) {
        texts[i] = words[codes[i]];
    }
    column->codes = codes;
    column->words = words;
    column->texts = texts;
    column->word_count = status ? 0 : count; /* until then they are borrowed */
    return status;
}

static conus_status fill_column(conus_column *column, const struct table_field *field, const struct made_of *of)
{
    const char *unit = column_is_place(field->type) ? conus_space_unit(of->source->frame->space) : field->unit;
    *column = (conus_column){.name = field->name, .unit = unit ? unit : "", .help = field->help};
    switch (field->type) {
    case COLUMN_NAME:
    case COLUMN_TEXT:
        column->type = CONUS_TYPE_TEXT;
        return fill_texts(column, field, of);
    case COLUMN_LABEL:
    case COLUMN_COUNT:
    case COLUMN_LARGE_COUNT:
    case COLUMN_RANK:
        column->type = CONUS_TYPE_COUNT;
        return fill_counts(column, field, of);
    default:
        column->type = CONUS_TYPE_NUMBER;
        return fill_numbers(column, field, of);
    }
}

static conus_status fill(conus_table *table, const struct table_fields *fields, const struct made_of *of)
{
    table->row_count = of->count;
    table->columns = memory_zeroed(fields->count, sizeof *table->columns);
    table->objects = memory_raw(of->count, sizeof *table->objects);
    conus_status status = table->columns && table->objects ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < fields->count && !status; i++) {
        if (table_has_field(of->source->atlas, &fields->at[i])) {
            status = fill_column(&table->columns[table->column_count++], &fields->at[i], of);
        }
    }
    for (size_t i = 0; i < of->count && !status; i++) {
        table->objects[i] = ((const struct table_object *)(const void *)(of->rows + i * of->size))->number;
    }
    return status;
}

conus_status table_create(conus_table **out, const struct table_source *source, const struct table_fields *fields,
                          const struct table_question *asked, const void *rows, size_t size, size_t count)
{
    const struct made_of of = {source, rows, size, count};
    conus_table *table = memory_zeroed(1, sizeof *table);
    if (!table) {
        memory_free(asked->region.path);
        return CONUS_ERROR_MEMORY;
    }
    atomic_init(&table->holders, 1);
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

static void finish_column(const conus_column *column)
{
    memory_free((void *)column->numbers);
    memory_free((void *)column->counts);
    memory_free((void *)column->missing);
    memory_free((void *)column->codes);
    memory_free((void *)column->texts);
    if (column->word_count > 1) {
        memory_free((void *)column->words[1]);
    }
    memory_free((void *)column->words);
}

void conus_table_destroy(conus_table *table)
{
    if (!table || atomic_fetch_sub_explicit(&table->holders, 1, memory_order_acq_rel) > 1) {
        return;
    }
    for (size_t i = 0; i < table->column_count; i++) {
        finish_column(&table->columns[i]);
    }
    memory_free(table->columns);
    memory_free(table->objects);
    memory_free(table->asked.region.path);
    for (size_t i = 0; i < table->part_count; i++) {
        conus_table_destroy(table->parts[i].table);
    }
    memory_free(table);
}

bool table_is_of(const conus_table *table, const struct table_fields *fields, const conus_frame *frame)
{
    return table->fields == fields && table->frame.space == frame->space &&
           mat4_is_same(table->frame.world_from_space, frame->world_from_space);
}

const struct table_question *table_question(const conus_table *table)
{
    return &table->asked;
}

struct cell table_cell(const conus_table *table, size_t column, size_t row)
{
    const conus_column *of = &table->columns[column];
    switch (of->type) {
    case CONUS_TYPE_TEXT:
        return text_cell(of->texts[row]);
    case CONUS_TYPE_COUNT:
        return of->missing && of->missing[row] ? no_cell() : integer_cell((uint64_t)of->counts[row]);
    default:
        return number_cell(of->numbers[row]);
    }
}

size_t conus_table_rows(const conus_table *table)
{
    return table ? table->row_count : 0;
}

size_t conus_table_columns(const conus_table *table)
{
    return table ? table->column_count : 0;
}

const conus_column *conus_table_column(const conus_table *table, size_t index)
{
    return index < conus_table_columns(table) ? &table->columns[index] : NULL;
}

const conus_column *conus_table_find(const conus_table *table, const char *name)
{
    size_t index = 0;
    while (index < conus_table_columns(table) && strcmp(table->columns[index].name, name) != 0) {
        index++;
    }
    return conus_table_column(table, index);
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
