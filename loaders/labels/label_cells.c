/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells and entries of label tables, for all formats. */
#include "loaders/labels/label_format.h"

#include "base/formats/encoding.h"

#include <string.h>

enum { SHOWN = 60 };

bool label_cell_whole(struct text cell, uint64_t *number)
{
    size_t size = cell.size;
    while (size && cell.data[size - 1] == '0') {
        size--;
    }
    bool is_padded = size > 1 && size < cell.size && cell.data[size - 1] == '.';
    return text_to_uint(is_padded ? (struct text){cell.data, size - 1} : cell, UINT32_MAX, number);
}

uint32_t label_cell_number(struct job *job, struct text cell)
{
    uint64_t number = 0;
    if (!label_cell_whole(cell, &number)) {
        job_bad(job, "label \"%.*s\", a whole number from 0 to 4294967295 is needed", TEXT_SHOW(cell, SHOWN));
    }
    return (uint32_t)number;
}

static size_t count_named(struct job *job, struct label_table *table, const struct label_voxels *voxels)
{
    size_t count = 0;
    labels_sort(job, table);
    for (size_t i = 1; job_ok(job) && i < voxels->label_count; i++) {
        const struct label *label = label_table_find(table, voxels->labels[i]);
        count += voxels->counts[i] && label && label->name;
    }
    return count;
}

size_t label_choose(struct job *job, size_t usual, label_trial *trial, void *user, size_t count,
                    const struct label_voxels *voxels)
{
    struct text names[2] = {{0}}; /* of the usual one, and of the best */
    size_t best = usual;
    size_t most = 0;
    for (size_t i = 0; i < count && job_ok(job); i++) {
        const struct job_mark mark = job_mark(job);
        struct attempt attempt = job_try(job);
        struct label_table *table = labels_new(job);
        struct text called = trial(job, table, user, i);
        size_t found = count_named(job, table, voxels);
        (void)attempt_end(job, &attempt, ATTEMPT_DROP);
        job_release(job, mark);
        names[0] = i == usual ? called : names[0];
        if (found > most) {
            most = found;
            best = i;
            names[1] = called;
        }
    }
    if (best != usual) {
        job_warn(job,
                 "label table: \"%.*s\" is the label's number, which names more labels of the volume (%zu) than "
                 "\"%.*s\"; FILE,label=COLUMN chooses",
                 TEXT_SHOW(names[1], SHOWN), most, TEXT_SHOW(names[0], SHOWN));
    }
    return best;
}

uint8_t label_cell_channel(struct job *job, struct text cell, const char *channel)
{
    uint64_t value = 0;
    if (!text_to_uint(cell, 255, &value)) {
        job_bad(job, "%s is \"%.*s\", a whole number from 0 to 255 is needed", channel, TEXT_SHOW(cell, SHOWN));
    }
    return (uint8_t)value;
}

uint8_t label_cell_fraction(struct job *job, struct text cell, const char *channel)
{
    double value;
    if (!text_to_double(cell, &value) || !(value >= 0 && value <= 1)) {
        job_bad(job, "%s is \"%.*s\", a number from 0 to 1 is needed", channel, TEXT_SHOW(cell, SHOWN));
        return 0;
    }
    return (uint8_t)(value * 255 + 0.5);
}

void label_cell_rgb(struct job *job, struct label *label, const struct text cells[3], label_cell_part *part)
{
    static const char *const channels[] = {"red", "green", "blue"};
    for (int i = 0; i < 3; i++) {
        label->rgb[i] = part(job, cells[i], channels[i]);
    }
    label->has_rgb = true;
}

void label_colour(struct job *job, struct label *label, const struct text *cells, label_cell_part *part)
{
    struct attempt attempt = job_try(job);
    if (part) {
        label_cell_rgb(job, label, cells, part);
    } else {
        label_cell_colour(job, label->rgb, cells[0]);
    }
    label->bad_rgb = attempt_end(job, &attempt, ATTEMPT_TRY) != NULL;
    label->has_rgb = !label->bad_rgb;
}

static const char *key_of(const struct xml_event *event)
{
    const char *key = xml_attribute(event, "Key");
    return key ? key : xml_attribute(event, "Index"); /* of old files */
}

static void read_element(struct job *job, struct label *out, const struct xml_event *event)
{
    static const char *const channels[] = {"Red", "Green", "Blue"};
    const char *key = key_of(event);
    struct text cells[3];
    bool coloured = false;
    for (int i = 0; i < 3; i++) {
        const char *value = xml_attribute(event, channels[i]);
        cells[i] = text_from(value ? value : "");
        coloured = coloured || value;
    }
    *out = (struct label){.number = label_cell_number(job, text_from(key ? key : ""))};
    if (coloured) {
        label_colour(job, out, cells, label_cell_fraction);
    }
}

void label_element(struct job *job, struct label *out, const struct xml_event *event)
{
    size_t place = job_in(job, "line ", event->line);
    read_element(job, out, event);
    job_out(job, place);
}

void label_entry_start(struct job *job, struct label_entry *entry, const struct xml_event *event)
{
    const char *key = key_of(event);
    int64_t number;
    *entry = (struct label_entry){.negative = key && text_to_int(text_from(key), &number) && number < 0};
    if (!entry->negative) {
        read_element(job, &entry->label, event);
    }
}

void label_entry_end(struct job *job, struct label_entry *entry, struct label_table *table, struct text text)
{
    const char *name = job_name(job, text);
    bool no_area = !entry->label.number || entry->negative;
    if (!no_area) {
        labels_keep(job, table, &(struct label_row){.label = entry->label, .name = text});
    } else if (name && !label_is_background(text_from(name))) {
        job_note(job, "label %s is called \"%s\"; its vertices belong to no area", entry->negative ? "below 0" : "0",
                 name);
    }
    *entry = (struct label_entry){0};
}

/* "rgba(255,0,0,1)" or "rgb(255,0,0)": the opacity says nothing about an area. */
static void read_function(struct job *job, uint8_t out[3], struct text cell)
{
    static const char *const channels[] = {"red", "green", "blue"};
    const char *open = memchr(cell.data, '(', cell.size);
    struct text rest = {open + 1, (size_t)(cell.data + cell.size - 1 - (open + 1))};
    struct text field;
    size_t count = 0;
    for (bool more = true; text_field(&rest, ',', &more, &field); count++) {
        if (count < 3) {
            out[count] = label_cell_channel(job, text_trim(field), channels[count]);
        }
    }
    if (count != 3 && count != 4) {
        job_bad(job, "colour \"%.*s\", rgb(R,G,B) or rgba(R,G,B,A) is needed", TEXT_SHOW(cell, SHOWN));
    }
}

void label_cell_colour(struct job *job, uint8_t out[3], struct text cell)
{
    if ((text_starts(cell, "rgb(") || text_starts(cell, "rgba(")) && cell.data[cell.size - 1] == ')') {
        read_function(job, out, cell);
        return;
    }
    size_t start = cell.size == 7 && cell.data[0] == '#';
    uint32_t value = 0;
    /* spreadsheets leave zeros in front away, as of a number: "19399" */
    bool fine = cell.size - start == 6 || (cell.size && cell.size < 6 && text_has_only(cell, "0123456789"));
    for (size_t i = start; fine && i < cell.size; i++) {
        fine = base16_value(cell.data[i]) >= 0;
        value = 16 * value + (fine ? (uint32_t)base16_value(cell.data[i]) : 0);
    }
    for (int i = 0; fine && i < 3; i++) {
        out[i] = (uint8_t)(value >> (16 - 8 * i));
    }
    if (!fine) {
        job_bad(job, "colour \"%.*s\", #rrggbb in hexadecimal, or rgba(R,G,B,A), is needed", TEXT_SHOW(cell, SHOWN));
    }
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

static void make_spaces(char *name, const struct label_row *row)
{
    for (; row->underscores && name && *name; name++) {
        *name = *name == '_' ? ' ' : *name;
    }
}

void labels_keep(struct job *job, struct label_table *table, const struct label_row *row)
{
    if (row->label.number) {
        struct label *label = labels_add(job, table, row->label.number);
        *label = row->label;
        labels_set(job, &label->name, row->name);
        make_spaces(label->name, row);
        labels_set(job, &label->abbreviation, row->abbreviation);
        return;
    }
    char *name = job_name(job, row->name);
    make_spaces(name, row);
    if (name && !label_is_background(text_from(name))) {
        job_warn(job,
                 "the label table calls label 0 \"%s\", but 0 is background: if the table counts from 0 and the volume "
                 "from 1, all names are off by one",
                 name);
    }
    if (name && !table->zero) {
        labels_set(job, &table->zero, row->name);
        make_spaces(table->zero, row);
    }
}

bool label_drop_background(struct job *job, struct label_table *table)
{
    struct label *first = table->entries;
    bool is_background =
        table->count && first->number == 1 && first->name && label_is_background(text_from(first->name));
    if (is_background && job_ok(job)) {
        job_note(job, "volume 0 is left out: it is called %s", first->name);
        label_finish(first);
        memmove(first, first + 1, --table->count * sizeof *first);
    }
    return is_background;
}
