/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells and entries of label tables, for all formats. */
#include "loaders/labels/label_cells.h"

#include "base/formats/base64.h"

#include <stdio.h>
#include <string.h>

enum { SHOWN = 60 };

conus_status label_cell_number(uint32_t *out, struct text cell, const char *where)
{
    uint64_t number;
    if (!text_to_uint(cell, UINT32_MAX, &number)) {
        return fail(CONUS_ERROR_DATA, "%s: label \"%.*s\", a whole number from 0 to 4294967295 is needed", where,
                    TEXT_SHOW(cell, SHOWN));
    }
    *out = (uint32_t)number;
    return CONUS_OK;
}

/* How many labels of the voxels the table names. */
static conus_status count_named(size_t *out, struct label_table *table, const struct label_voxels *voxels,
                                struct notes *silent)
{
    conus_status status = label_table_sort(table, silent);
    *out = 0;
    for (size_t i = 1; !status && i < voxels->label_count; i++) {
        const struct label *label = label_table_find(table, voxels->labels[i]);
        *out += voxels->counts[i] && label && label->name;
    }
    return status;
}

conus_status label_choose(size_t *best, label_trial *trial, void *user, size_t count, const struct label_voxels *voxels,
                          struct notes *notes)
{
    const size_t usual = *best;
    struct text names[2] = {{0}}; /* of the usual one, and of the best */
    size_t most = 0;
    for (size_t i = 0; i < count; i++) {
        struct label_table table = {0};
        struct notes silent = {0};
        struct text called = {0};
        size_t found = 0;
        conus_status status = trial(&table, &called, user, i, &silent);
        status = status ? status : count_named(&found, &table, voxels, &silent);
        label_table_finish(&table);
        notes_finish(&silent);
        if (status == CONUS_ERROR_MEMORY) {
            return status;
        }
        names[0] = i == usual ? called : names[0];
        if (!status && found > most) {
            most = found;
            *best = i;
            names[1] = called;
        }
    }
    return *best == usual ? CONUS_OK
                          : notes_warn(notes,
                                       "label table: \"%.*s\" is the label's number, which names more labels of the "
                                       "volume (%zu) than \"%.*s\"; FILE,label=COLUMN chooses",
                                       TEXT_SHOW(names[1], SHOWN), most, TEXT_SHOW(names[0], SHOWN));
}

conus_status label_cell_channel(uint8_t *out, struct text cell, const char *channel, const char *where)
{
    uint64_t value;
    if (!text_to_uint(cell, 255, &value)) {
        return fail(CONUS_ERROR_DATA, "%s: %s is \"%.*s\", a whole number from 0 to 255 is needed", where, channel,
                    TEXT_SHOW(cell, SHOWN));
    }
    *out = (uint8_t)value;
    return CONUS_OK;
}

conus_status label_cell_fraction(uint8_t *out, struct text cell, const char *channel, const char *where)
{
    double value;
    if (!text_to_double(cell, &value) || !(value >= 0 && value <= 1)) {
        return fail(CONUS_ERROR_DATA, "%s: %s is \"%.*s\", a number from 0 to 1 is needed", where, channel,
                    TEXT_SHOW(cell, SHOWN));
    }
    *out = (uint8_t)(value * 255 + 0.5);
    return CONUS_OK;
}

conus_status label_cell_rgb(struct label *label, const struct text cells[3],
                            conus_status (*parse_channel)(uint8_t *, struct text, const char *, const char *),
                            const char *where)
{
    static const char *const channels[] = {"red", "green", "blue"};
    conus_status status = CONUS_OK;
    for (int i = 0; !status && i < 3; i++) {
        status = parse_channel(&label->rgb[i], cells[i], channels[i], where);
    }
    label->has_rgb = !status;
    return status;
}

conus_status label_element(struct label *out, const struct xml_event *event)
{
    static const char *const channels[] = {"Red", "Green", "Blue"};
    const char *key = xml_attribute(event, "Key");
    key = key ? key : xml_attribute(event, "Index"); /* of old files */
    struct text cells[3] = {{0}};
    char where[32];
    snprintf(where, sizeof where, "line %zu", event->line);
    size_t given = 0;
    for (int i = 0; i < 3; i++) {
        const char *value = xml_attribute(event, channels[i]);
        cells[i] = text_from(value ? value : "");
        given += value != NULL;
    }
    struct label label = {0};
    conus_status status = label_cell_number(&label.number, text_from(key ? key : ""), where);
    status = status || !given ? status : label_cell_rgb(&label, cells, label_cell_fraction, where);
    if (!status) {
        *out = label;
    }
    return status;
}

conus_status label_entry_start(struct label_entry *entry, const struct xml_event *event)
{
    const char *key = xml_attribute(event, "Key");
    int64_t number;
    key = key ? key : xml_attribute(event, "Index");
    entry->negative = key && text_to_int(text_from(key), &number) && number < 0;
    entry->label = (struct label){0};
    return entry->negative ? CONUS_OK : label_element(&entry->label, event);
}

conus_status label_entry_end(struct label_entry *entry, struct label_table *table, struct text name,
                             struct notes *notes)
{
    struct label *label = &entry->label;
    conus_status status = label_set_text(&label->name, name);
    bool no_area = !label->number || entry->negative;
    if (!status && no_area && label->name && !label_is_background(text_from(label->name))) {
        status = notes_add(notes, "label %s is called \"%s\"; its vertices belong to no area",
                           entry->negative ? "below 0" : "0", label->name);
    }
    if (status || no_area) {
        label_finish(label);
    } else {
        status = label_keep(table, label, CONUS_OK, notes);
    }
    *entry = (struct label_entry){0};
    return status;
}

/* "rgba(255,0,0,1)" or "rgb(255,0,0)": the opacity says nothing about an area. */
static conus_status read_function(uint8_t out[3], struct text cell, const char *where)
{
    static const char *const channels[] = {"red", "green", "blue"};
    const char *open = memchr(cell.data, '(', cell.size);
    struct text rest = {open + 1, (size_t)(cell.data + cell.size - 1 - (open + 1))};
    struct text field;
    size_t count = 0;
    conus_status status = CONUS_OK;
    for (bool more = true; !status && text_field(&rest, ',', &more, &field); count++) {
        status = count < 3 ? label_cell_channel(&out[count], text_trim(field), channels[count], where) : CONUS_OK;
    }
    return status || count == 3 || count == 4
               ? status
               : fail(CONUS_ERROR_DATA, "%s: colour \"%.*s\", rgb(R,G,B) or rgba(R,G,B,A) is needed", where,
                      TEXT_SHOW(cell, SHOWN));
}

conus_status label_cell_colour(uint8_t out[3], struct text cell, const char *where)
{
    if ((text_starts(cell, "rgb(") || text_starts(cell, "rgba(")) && cell.data[cell.size - 1] == ')') {
        return read_function(out, cell, where);
    }
    size_t start = cell.size == 7 && cell.data[0] == '#';
    bool fine = cell.size - start == 6;
    for (size_t i = 0; fine && i < 3; i++) {
        int high = base16_value(cell.data[start + 2 * i]);
        int low = base16_value(cell.data[start + 2 * i + 1]);
        fine = high >= 0 && low >= 0;
        out[i] = fine ? (uint8_t)(16 * high + low) : 0;
    }
    return fine ? CONUS_OK
                : fail(CONUS_ERROR_DATA, "%s: colour \"%.*s\", #rrggbb in hexadecimal, or rgba(R,G,B,A), is needed",
                       where, TEXT_SHOW(cell, SHOWN));
}

char label_hemisphere_of(struct text cell)
{
    return text_is_one_of(cell, "L/left/lh", false)          ? 'L'
           : text_is_one_of(cell, "R/right/rh", false)       ? 'R'
           : text_is_one_of(cell, "B/both/bilateral", false) ? 'B'
                                                             : 0;
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c & 0x80);
}

static bool has_number(struct text name)
{
    for (size_t i = 0; i < name.size; i++) {
        if (name.data[i] >= '1' && name.data[i] <= '9') {
            return true;
        }
    }
    return false;
}

/* The next run of letters off `rest`; bytes of other alphabets are letters. False if none is left. */
static bool next_letters(struct text *rest, struct text *word)
{
    size_t start = 0;
    while (start < rest->size && !is_letter(rest->data[start])) {
        start++;
    }
    size_t end = start;
    while (end < rest->size && is_letter(rest->data[end])) {
        end++;
    }
    *word = (struct text){rest->data + start, end - start};
    *rest = (struct text){rest->data + end, rest->size - end};
    return word->size > 0;
}

/* A name is that of no area if its first word says that nothing is there, or if it has neither a word nor a number. */
bool label_is_background(struct text name)
{
    static const char absent[] = "air/background/bg/clear/empty/exterior/na/nan/nil/no/non/none/not/null/nothing/"
                                 "outside/unassigned/unclassified/undefined/unknown/unlabeled/unlabelled/unnamed/"
                                 "unsegmented/unspecified/void";
    struct text word;
    struct text rest = name;
    if (!next_letters(&rest, &word)) {
        return !has_number(name);
    }
    return text_is_one_of(word, absent, false) || text_equal_ignoring_case(name, "n/a");
}

conus_status label_keep(struct label_table *table, struct label *label, conus_status status, struct notes *notes)
{
    if (!status && label->number) {
        struct label *entry = label_table_add(table, label->number);
        if (entry) {
            *entry = *label;
            return CONUS_OK;
        }
        status = CONUS_ERROR_MEMORY;
    } else if (!status && label->name) {
        if (!label_is_background(text_from(label->name))) {
            status = notes_warn(notes,
                                "the label table calls label 0 \"%s\", but 0 is background: if the table counts from 0 "
                                "and the volume from 1, all names are off by one",
                                label->name);
        }
        if (!table->zero) {
            table->zero = label->name;
            label->name = NULL;
        }
    }
    label_finish(label);
    return status;
}

conus_status label_drop_background(bool *dropped, struct label_table *table, struct notes *notes)
{
    struct label *first = table->entries;
    *dropped = table->count && first->number == 1 && first->name && label_is_background(text_from(first->name));
    if (!*dropped) {
        return CONUS_OK;
    }
    conus_status status = notes_add(notes, "volume 0 is left out: it is called %s", first->name);
    label_finish(first);
    memmove(first, first + 1, --table->count * sizeof *first);
    return status;
}
