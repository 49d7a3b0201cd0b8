/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows that names of places give in place of coordinates: which column has them, and where each is. */
#include "base/memory.h"
#include "base/status.h"
#include "conus/atlas.h"
#include "conus/pose.h"
#include "poses/rows/columns.h"
#include "poses/rows/columns_head.h"
#include "poses/rows/pose_row.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 2 * POSE_ID_LIMIT, COMPARED = 500 };

/* The text of a cell, without quotation marks around it and doubled ones in it, and a side behind it. */
static void set_text(char out[NAME_SIZE], const struct kept_text *cell, const char *side)
{
    const size_t size = kept_text_put(out, NAME_SIZE - strlen(side) - 1, cell);
    snprintf(out + size, NAME_SIZE - size, "%s", side);
}

/* Whether an area's name or abbreviation is this number. */
static bool is_called_number(const conus_atlas *atlas, const char *number)
{
    const conus_object *area;
    bool is_one = false;
    for (uint32_t i = 1; !is_one && (area = conus_atlas_object(atlas, i)); i++) {
        is_one = strcmp(area->name, number) == 0 || strcmp(area->abbreviation, number) == 0;
    }
    return is_one;
}

/* Whether a cell names a place, or several: a position, an area. Else the message says why not. */
static bool is_name(struct head *head, struct text cell, bool may_be_number)
{
    const conus_atlas *atlas = head->options->atlas;
    char text[NAME_SIZE];
    struct place_words words = {.form = PLACE_NUMBERS};
    double number;
    uint32_t object;
    set_text(text, &(struct kept_text){cell, false}, "");
    if (cell.size > POSE_ID_LIMIT || place_read(&words, cell) || words.form != PLACE_NAME || position_find(cell) ||
        !atlas) {
        return cell.size <= POSE_ID_LIMIT && words.form != PLACE_NUMBERS && (atlas || position_find(words.name));
    }
    conus_status status = conus_atlas_find(&object, atlas, text);
    if (status == CONUS_ERROR_MEMORY) {
        (void)JOB_CALL(head->job, status);
    }
    bool is_one = status != CONUS_ERROR_ARGUMENT || strncmp(conus_message(), "no ", 3) != 0; /* it may be several */
    return is_one && (!text_to_double(cell, &number) ||
                      (may_be_number && (status == CONUS_ERROR_ARGUMENT || is_called_number(atlas, text))));
}

static struct text without_marks(struct text line)
{
    line = table_trim(line);
    bool is_quoted = line.size > 1 && line.data[0] == '"' && line.data[line.size - 1] == '"';
    return is_quoted ? (struct text){line.data + 1, line.size - 2} : line;
}

/* A name in each line, perhaps below a word for them all: by it numbers may be names, which alone are none, for three
 * are no three areas. */
static bool are_lines(size_t *head_lines, struct head *head, const char *words)
{
    static const char plurals[] = "names/labels/channels/electrodes/position/positions";
    const struct text word = head->words.place;
    struct text rest = head->text;
    struct text line;
    size_t number = 0;
    size_t lines = 0;
    size_t names = 0;
    size_t header = 0;
    while (lines < COMPARED && table_next_line(&rest, &line, &number)) {
        double value;
        line = without_marks(line);
        bool is_header = !lines && !header &&
                         (word.size ? text_compare(line, word) == 0
                                    : text_is_one_of(line, words, false) || text_is_one_of(line, plurals, false)) &&
                         !is_name(head, line, false);
        if (!header && text_to_double(line, &value)) {
            return false;
        }
        names += !is_header && is_name(head, line, header);
        header = is_header ? number : header;
        lines += !is_header;
    }
    *head_lines = header;
    return word.size ? header > 0 : names && 2 * names >= lines;
}

/* Whether half of the cells of a column below the header are names, which numbers are only if it is called so; the
 * first of its cells. */
static bool has_names(struct text *first, struct head *head, size_t column, bool is_called_so)
{
    struct text rest = head->text;
    struct text text;
    struct table_line line;
    size_t cells = 0;
    size_t names = 0;
    *first = (struct text){"", 0};
    for (size_t number = 0; cells < COMPARED && table_next_line(&rest, &text, &number);) {
        bool fits = number > head->out->head_lines && table_split(&line, &head->out->table, text);
        const struct text cell = fits && column < line.count ? line.cells[column] : (struct text){"", 0};
        if (!columns_is_absent(cell)) {
            *first = first->size ? *first : cell;
            cells++;
            names += is_name(head, cell, is_called_so);
        }
    }
    return names && 2 * names >= cells;
}

/* Whether most rows have three numbers beside their names, whatever stands between: coordinates, perhaps. */
static bool has_numbers_beside(const struct head *head)
{
    struct text rest = head->text;
    struct text text;
    struct table_line line;
    size_t rows = 0;
    size_t found = 0;
    for (size_t number = 0; rows < COMPARED && table_next_line(&rest, &text, &number);) {
        size_t numbers = 0;
        bool fits = number > head->out->head_lines && table_split(&line, &head->out->table, text);
        for (size_t i = 0; fits && i < line.count; i++) {
            const struct text cell = i + 1 == head->out->place ? text_from("") : line.cells[i];
            for (size_t k = 0; k < cell.size; k++) {
                const unsigned char before = k ? (unsigned char)cell.data[k - 1] : ' ';
                numbers += isdigit((unsigned char)cell.data[k]) && !isalnum(before) && before != '.';
            }
        }
        rows += fits;
        found += numbers >= 3;
    }
    return 2 * found > rows;
}

void columns_find_places(struct head *head, const char *words)
{
    struct columns *out = head->out;
    const struct text word = head->words.place;
    size_t header;
    size_t found = COLUMN_NONE;
    struct text none = {"", 0}; /* a cell of a column of names that are none */
    if (!head->row_count && !(word.size && out->has_header) && are_lines(&header, head, words)) {
        out->head_lines = header;
        out->place = 1;
        out->has_header = false;
        head->faults.size = 0;
        return;
    }
    for (size_t i = 0; out->has_header && i < head->line.given; i++) {
        struct text first;
        const struct text name = head->line.cells[i];
        if (strstr(head->names[i], "hemi") || strcmp(head->names[i], "side") == 0) {
            out->place_side = i + 1;
            continue;
        }
        const bool is_called_so = text_is_one_of(name, words, false);
        bool is_it =
            word.size ? word.size == name.size && text_contains(name, word) : has_names(&first, head, i, is_called_so);
        FAULT_IF(is_it && found != COLUMN_NONE, head,
                 "columns \"%.*s\" and \"%.*s\" name places: type '%s,place=COLUMN' with the one that is meant",
                 POSE_QUOTE(head->line.cells[found]), POSE_QUOTE(name), out->file);
        none = is_it || word.size || none.size || !is_called_so ? none : first;
        out->place = is_it ? found == COLUMN_NONE ? i + 1 : 0 : out->place;
        found = is_it ? i : found;
    }
    FAULT_IF(word.size && found == COLUMN_NONE, head, "column \"%.*s\" is not there", POSE_QUOTE(word));
    if (found == COLUMN_NONE && none.size && !head->row_count && head->options->atlas && !is_name(head, none, true)) {
        FAULT(head, "%s", conus_message());
    }
    if (out->place && !word.size && (head->row_count || has_numbers_beside(head))) {
        FAULT(head, "%sto ask at the areas of these names instead, type '%s,place=%.*s'",
              head->row_count ? "" : "if the numbers are coordinates, put x, y and z into columns of their own; ",
              out->file, POSE_QUOTE(head->line.cells[out->place - 1]));
        out->place = 0;
    }
}

/* Without an atlas, which would have areas. */
static conus_status find_position(conus_place *out, const char *text)
{
    struct place_words words;
    const struct position *position = place_read(&words, text_from(text)) ? NULL : position_find(words.name);
    if (!position) {
        return fail(CONUS_ERROR_DATA, "\"%.60s\" is no position of a cap, and no atlas says what else it is", text);
    }
    *out = (conus_place){.kind = CONUS_PLACE_POSITION};
    memcpy(out->point, position->point, sizeof out->point);
    memcpy(out->outward, position->outward, sizeof out->outward);
    return CONUS_OK;
}

/* Finds a name, and keeps its point. */
static conus_status find(struct named_rows *known, const char *text, size_t line, const conus_pose_options *options,
                         struct notes *notes)
{
    conus_place place;
    double number;
    uint32_t object;
    if (options->atlas && text_to_double(text_from(text), &number) && !is_called_number(options->atlas, text) &&
        !conus_atlas_find(&object, options->atlas, text)) {
        return fail(CONUS_ERROR_DATA, "\"%.60s\" is a number: index:%.60s is the area with this label", text, text);
    }
    conus_status status =
        options->atlas ? options->find_place(&place, options->atlas, text,
                                             &(conus_place_options){.frame = options->frame, .scalp = options->scalp})
                       : find_position(&place, text);
    if (!status && place.kind == CONUS_PLACE_NUMBERS) {
        return fail(CONUS_ERROR_DATA, "\"%.60s\" beside names: coordinates need columns, x y z, of their own", text);
    }
    if (!status && place.is_also_named) {
        status = notes_add(notes, "line %zu: \"%.60s\" is the area; a position of a cap is called so, too (1020:)",
                           line, text);
    }
    if (status || !memory_reserve(&known->items, &known->capacity, known->names.count + 1, sizeof *known->items)) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    struct named_row *item = &known->items[known->names.count];
    for (int a = 0; a < 3; a++) {
        item->point[a] = place.point[a];
        item->outward[a] = place.kind == CONUS_PLACE_POSITION ? place.outward[a] : NAN;
    }
    item->name = memory_text(text, strlen(text));
    status = item->name ? name_set_add(&known->names, item->name, known->names.count) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(item->name);
    }
    return status;
}

conus_status named_rows_find(conus_pose_row *row, struct named_rows *known, const struct pose_name *name,
                             const conus_pose_options *options, struct notes *notes)
{
    char text[NAME_SIZE];
    struct place_words words;
    const struct text cell = name->place.text;
    const int own = sides_of_name(cell);
    const int stated = sides_of_name(name->side);
    bool has_side = own || !stated || place_read(&words, cell) || words.form > PLACE_NEAR || position_find(words.name);
    set_text(text, &name->place, has_side ? "" : stated < 0 ? " left" : " right");
    const struct known_name *found = name_set_find(&known->names, text);
    conus_status status = found ? CONUS_OK : find(known, text, row->line, options, notes);
    if (status) {
        return status;
    }
    const struct named_row *item = &known->items[found ? found->value : known->names.count - 1];
    bool is_beyond = options->space < CONUS_SPACE_CCF && item->point[0] * stated < -options->longest / 36;
    if (stated && (is_beyond || own == -stated)) {
        return fail(CONUS_ERROR_DATA, "\"%.60s\" is on the other side than \"%.*s\"", text, POSE_QUOTE(name->side));
    }
    memcpy(row->normal, item->outward, sizeof row->normal);
    return pose_of_point(&row->pose, item->point);
}

void named_rows_finish(struct named_rows *known)
{
    for (size_t i = 0; i < known->names.count; i++) {
        memory_free(known->items[i].name);
    }
    memory_free(known->items);
    name_set_finish(&known->names);
}
