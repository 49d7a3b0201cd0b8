/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables with a header row: BIDS dseg.tsv, Slicer's CSV, and others. The names of the columns decide what they
 * mean; unknown columns are allowed. And CSV without one, number and name in front. */
#include "loaders/labels/label_format.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/labels/label_cells.h"

#include <stdio.h>
#include <stdlib.h>
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
    RIVAL,      /* a second column that could be the index, */
    NAME_RIVAL, /* or the name */
    COLUMN_COUNT
};
enum { NO_COLUMN = -1, SYNONYM_COUNT = 7, FIELD_LIMIT = 1024 };

/* The names that a column may have, the preferred one first. */
static const char *const names[COLUMN_COUNT][SYNONYM_COUNT] = {
    [INDEX] = {"index", "LabelValue", "annotation_value", "id", "key", "ROIid", "label"},
    [NAME] = {"name", "region", "structure", "ROIname", "label"},
    [ABBREVIATION] = {"abbreviation", "acronym", "abbr", "ROIabbr"},
    [COLOUR] = {"color", "colour", "color_hex_triplet", "hex"},
    [RED] = {"Color_R", "red", "r"},
    [GREEN] = {"Color_G", "green", "g"},
    [BLUE] = {"Color_B", "blue", "b"},
    [HEMISPHERE] = {"hemisphere", "hemi"},
    [PARENT] = {"parent_structure_id", "parent_id"},
    [IDENTIFIER] = {"identifier"},
    [PARENT_IDENTIFIER] = {"parent_identifier"},
};

struct header {
    char separator;
    int at[COLUMN_COUNT]; /* field of each column, or NO_COLUMN */
    int count;
    const char *twice; /* a column that two fields claim, or NULL */
    bool disputed[2];  /* a rival of the index, or of the name, has been noted */
    bool by_value;     /* the index is called value */
    struct candidate {
        int at;
        struct text name;
    } indices[SYNONYM_COUNT + 1]; /* fields that could be the index, the preferred one first; "value" is the last */
};

/* The next line that is neither empty nor a comment; of an empty row spreadsheets write the separators. Below a header
 * with colours in front, "#ff0000" begins a row. */
static bool next_row(struct text *rest, size_t *number, struct text *line, const struct header *header)
{
    bool has_comments = !header || header->at[COLOUR] != 0;
    while (text_line(rest, line)) {
        ++*number;
        struct text trimmed = text_trim(*line);
        if (!text_has_only(trimmed, ",;\t ") && !(has_comments && trimmed.data[0] == '#')) {
            return true;
        }
    }
    return false;
}

static bool next_line(struct text *rest, size_t *number, struct text *line)
{
    return next_row(rest, number, line, NULL);
}

static void match_column(struct header *header, int ranks[COLUMN_COUNT], struct text field, int at)
{
    for (int column = 0; column < COLUMN_COUNT; column++) {
        for (int rank = 0; rank < SYNONYM_COUNT && names[column][rank]; rank++) {
            bool named = text_equal_ignoring_case(field, names[column][rank]);
            header->twice = named && rank == ranks[column] ? names[column][rank] : header->twice;
            if (named && column <= NAME) {
                header->at[RIVAL + column] = rank < ranks[column] ? header->at[column] : at;
            }
            if (named && column == INDEX && !header->indices[rank].name.size) {
                header->indices[rank] = (struct candidate){at, field};
            }
            if (named && rank < ranks[column]) {
                ranks[column] = rank;
                header->at[column] = at;
            }
        }
    }
}

static char separator_of(struct text line)
{
    return memchr(line.data, '\t', line.size) ? '\t' : memchr(line.data, ',', line.size) ? ',' : ';';
}

/* Reads the header row; false if `line` is none: it must name a number and a name. */
static bool read_header_row(struct header *header, struct text line, char separator)
{
    int ranks[COLUMN_COUNT];
    *header = (struct header){.separator = separator};
    for (int column = 0; column < COLUMN_COUNT; column++) {
        header->at[column] = NO_COLUMN;
        ranks[column] = SYNONYM_COUNT;
    }
    struct text field;
    struct text first = {0};
    enum text_quotes quotes;
    for (bool more = true; text_quoted_field(&line, header->separator, &more, &field, &quotes);) {
        first = header->count ? first : field;
        if (header->count < FIELD_LIMIT) {
            if (text_equal_ignoring_case(field, "value")) {
                header->indices[SYNONYM_COUNT] = (struct candidate){header->count, field};
            }
            match_column(header, ranks, field, header->count++);
        }
    }
    /* "value,label": a value may be a measurement, so it is the number only in front and without a better one; whether
     * the rows agree, counts_by_value() tells */
    int *index = &header->at[INDEX];
    if (text_equal_ignoring_case(first, "value") && (*index == NO_COLUMN || *index == header->at[NAME])) {
        *index = 0;
        header->at[RIVAL] = NO_COLUMN;
        header->by_value = true;
    }
    return header->at[INDEX] != NO_COLUMN && header->at[NAME] != NO_COLUMN && header->at[INDEX] != header->at[NAME];
}

/* The cells of one row that have a meaning; empty where there are none. */
static conus_status read_cells(struct text cells[COLUMN_COUNT], const struct header *header, struct text line,
                               const char *where)
{
    bool more = true;
    bool closed = true;
    enum text_quotes quotes;
    struct text field;
    int count = 0;
    for (; text_quoted_field(&line, header->separator, &more, &field, &quotes); count++) {
        closed = closed && quotes != TEXT_UNCLOSED;
        bool absent = text_equal(field, "n/a");
        for (int column = 0; column < COLUMN_COUNT; column++) {
            if (header->at[column] == count && !absent) {
                cells[column] = field;
            }
        }
    }
    if (!closed) {
        return fail(CONUS_ERROR_DATA, "%s: a quotation mark is not closed", where);
    }
    if (count > header->count) {
        return fail(CONUS_ERROR_DATA, "%s: %d columns, the header has %d", where, count, header->count);
    }
    return CONUS_OK;
}

static conus_status set_cell(char **field, struct text cell)
{
    conus_status status = label_set_text(field, cell);
    char *to = *field;
    for (const char *from = to; !status && from && *from; from++) {
        *to++ = *from;
        from += from[0] == '"' && from[1] == '"'; /* marks are doubled inside marks */
    }
    if (to) {
        *to = '\0';
    }
    return status;
}

static conus_status fill_label(struct label *label, const struct text cells[COLUMN_COUNT], const char *where,
                               struct notes *notes)
{
    const struct text hemisphere = cells[HEMISPHERE];
    conus_status status = label_cell_number(&label->number, cells[INDEX], where);
    if (!status && cells[COLOUR].size) {
        label->has_rgb = true;
        status = label_cell_colour(label->rgb, cells[COLOUR], where);
    } else if (!status && (cells[RED].size || cells[GREEN].size || cells[BLUE].size)) {
        status = label_cell_rgb(label, &cells[RED], label_cell_channel, where);
    }
    label->hemisphere = label_hemisphere_of(hemisphere);
    if (!status && hemisphere.size && !label->hemisphere) {
        status = notes_warn(notes, "label table, %s: hemisphere \"%.*s\" is none of L, R, B: taken as not given", where,
                            TEXT_SHOW(hemisphere, 40));
    }
    const struct text parent = cells[cells[PARENT].size ? PARENT : PARENT_IDENTIFIER];
    if (!status && parent.size) {
        status = label_cell_number(&label->parent, parent, where);
        label->has_parent = label->parent != 0;
    }
    status = status ? status : set_cell(&label->name, cells[NAME]);
    return status ? status : set_cell(&label->abbreviation, cells[ABBREVIATION]);
}

static bool is_whole(struct text cell)
{
    uint64_t number;
    return text_to_uint(cell, UINT32_MAX, &number);
}

static bool is_word(struct text cell)
{
    double number;
    return cell.size && !text_equal(cell, "n/a") && !text_to_double(cell, &number);
}

/* Two columns may have names, of which one is used. */
static conus_status note_rival_name(struct header *header, const struct text cells[COLUMN_COUNT], const char *where,
                                    struct notes *notes)
{
    struct text name = cells[NAME];
    struct text rival = cells[NAME_RIVAL];
    bool same = name.size == rival.size && name.size && memcmp(name.data, rival.data, name.size) == 0;
    if (header->disputed[1] || same || !is_word(name) || !is_word(rival)) {
        return CONUS_OK;
    }
    header->disputed[1] = true;
    return notes_add(notes,
                     "label table, %s: two columns could be the label's name, \"%.*s\" and \"%.*s\": \"%.*s\" is used, "
                     "by the order name, region, structure, ROIname, label; FILE,name=COLUMN chooses",
                     where, TEXT_SHOW(name, 40), TEXT_SHOW(rival, 40), TEXT_SHOW(name, 40));
}

/* "index label name" may count rows in one column and give the voxels' value in the other. */
static conus_status note_rival_column(struct header *header, uint32_t number, struct text rival, const char *where,
                                      struct notes *notes)
{
    uint64_t other;
    if (header->disputed[0] || !text_to_uint(rival, UINT32_MAX, &other) || other == number) {
        return CONUS_OK;
    }
    header->disputed[0] = true;
    return notes_warn(notes,
                      "label table, %s: two columns could be the label's number, %u and %llu: %u is used, by the order "
                      "index, LabelValue, annotation_value, id, key, label",
                      where, number, (unsigned long long)other, number);
}

/* The numbers of labels by what the table identifies them with. */
struct identifiers {
    struct identifier {
        uint32_t identifier, number;
        size_t row;
    } * list;
    size_t count, capacity;
};

static int compare_identifiers(const void *a, const void *b)
{
    return compare_u32(&((const struct identifier *)a)->identifier, &((const struct identifier *)b)->identifier);
}

static int compare_rows(const void *a, const void *b)
{
    const struct identifier *one = a;
    const struct identifier *other = b;
    int order = compare_identifiers(one, other);
    return order ? order : (one->row > other->row) - (one->row < other->row);
}

/* Sorts; of rows with one identifier the first counts. */
static conus_status sort_identifiers(struct identifiers *identifiers, struct notes *notes)
{
    struct identifier *list = identifiers->list;
    const struct identifier *doubtful = NULL;
    size_t kept = 0;
    if (identifiers->count) {
        qsort(list, identifiers->count, sizeof *list, compare_rows);
    }
    for (size_t i = 0; i < identifiers->count; i++) {
        if (!kept || list[kept - 1].identifier != list[i].identifier) {
            list[kept++] = list[i];
        } else if (list[kept - 1].number != list[i].number) {
            doubtful = &list[kept - 1];
        }
    }
    identifiers->count = kept;
    return doubtful ? notes_warn(notes,
                                 "label table: several rows have the identifier %u: as a parent it means the first of "
                                 "them, label %u",
                                 doubtful->identifier, doubtful->number)
                    : CONUS_OK;
}

static conus_status keep_identifier(struct identifiers *identifiers, struct text cell, uint32_t number,
                                    const char *where)
{
    uint32_t identifier;
    conus_status status = label_cell_number(&identifier, cell, where);
    if (!status && !memory_reserve(&identifiers->list, &identifiers->capacity, identifiers->count + 1,
                                   sizeof *identifiers->list)) {
        status = CONUS_ERROR_MEMORY;
    }
    if (!status) {
        identifiers->list[identifiers->count] = (struct identifier){identifier, number, identifiers->count};
        identifiers->count++;
    }
    return status;
}

/* Makes parents, which are identifiers, numbers of labels. An identifier that no row has is no parent. */
static conus_status find_parents(struct label_table *table, size_t first, struct identifiers *identifiers,
                                 struct notes *notes)
{
    conus_status status = sort_identifiers(identifiers, notes);
    for (size_t i = first; !status && i < table->count; i++) {
        struct label *label = &table->entries[i];
        const struct identifier wanted = {.identifier = label->parent};
        const struct identifier *found = !label->has_parent || !identifiers->count
                                             ? NULL
                                             : bsearch(&wanted, identifiers->list, identifiers->count,
                                                       sizeof *identifiers->list, compare_identifiers);
        if (label->has_parent && !found) {
            status = notes_warn(notes, "label table: %s has the parent_identifier %u, which no row has: no parent",
                                label->name ? label->name : "a row", label->parent);
        }
        label->parent = found ? found->number : 0;
        label->has_parent = label->parent != 0;
    }
    return status;
}

/* Parses the rows below the header, which is line `number`. */
static conus_status parse_below(struct label_table *out, struct header *header, struct text text, size_t number,
                                struct notes *notes)
{
    struct text line;
    struct identifiers identifiers = {0};
    size_t first = out->count;
    bool is_identified = header->at[IDENTIFIER] != NO_COLUMN && header->at[PARENT_IDENTIFIER] != NO_COLUMN &&
                         header->at[PARENT] == NO_COLUMN;
    conus_status status = CONUS_OK;
    while (!status && next_row(&text, &number, &line, header)) {
        char where[32];
        struct text cells[COLUMN_COUNT] = {{0}};
        struct label label = {0};
        snprintf(where, sizeof where, "line %zu", number);
        status = read_cells(cells, header, line, where);
        status = status ? status : fill_label(&label, cells, where, notes);
        status = status ? status : note_rival_column(header, label.number, cells[RIVAL], where, notes);
        status = status ? status : note_rival_name(header, cells, where, notes);
        if (!status && is_identified) {
            status = keep_identifier(&identifiers, cells[IDENTIFIER], label.number, where);
        }
        status = label_keep(out, &label, status, notes);
    }
    status = status || !is_identified ? status : find_parents(out, first, &identifiers, notes);
    memory_free(identifiers.list);
    return status;
}

/* "Nr", "Bezeichnung", ...: at most as many as a message has place for. */
static size_t list_columns(struct buffer *out, struct text line, char separator)
{
    enum { SHOWN = 12, WIDTH = 40 };
    struct text field;
    enum text_quotes quotes;
    size_t count = 0;
    for (bool more = true; text_quoted_field(&line, separator, &more, &field, &quotes); count++) {
        if (count < SHOWN) {
            buffer_format(out, "%s\"%.*s\"", count ? ", " : "", TEXT_SHOW(field, WIDTH));
        }
    }
    buffer_text(out, count > SHOWN ? ", ..." : "");
    return count;
}

static conus_status refuse_column(struct text line, const struct header *header, struct text column, size_t number)
{
    struct buffer columns = {0};
    (void)list_columns(&columns, line, header->separator);
    conus_status status = buffer_status(&columns);
    status = status ? status
                    : fail(CONUS_ERROR_DATA, "line %zu: no column is called \"%.*s\", there are %s", number,
                           (int)column.size, column.data, columns.data);
    buffer_finish(&columns);
    return status;
}

/* The separator with which `line` has the most fields. */
static char best_separator(struct text line)
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

/* Which field of `line` is called `column`; NO_COLUMN if none is. */
static int find_column(struct text line, char separator, struct text column)
{
    struct text field;
    enum text_quotes quotes;
    int at = 0;
    for (bool more = true; text_quoted_field(&line, separator, &more, &field, &quotes); at++) {
        bool same = field.size == column.size && column.size && memcmp(field.data, column.data, field.size) == 0;
        if (same && at < FIELD_LIMIT) {
            return at;
        }
    }
    return NO_COLUMN;
}

/* A table's rows, and its header with other columns for the number. */
struct trial {
    const struct header *header;
    struct text below;
    size_t number; /* of the header's line */
};

static conus_status try_index(struct label_table *out, struct text *called, void *user, size_t candidate,
                              struct notes *notes)
{
    const struct trial *trial = user;
    struct header tried = *trial->header;
    *called = tried.indices[candidate].name;
    tried.at[INDEX] = tried.indices[candidate].at;
    return !called->size || tried.at[INDEX] == tried.at[NAME]
               ? CONUS_OK
               : parse_below(out, &tried, trial->below, trial->number, notes);
}

static conus_status parse_table(struct label_table *out, struct text text, const struct label_use *use,
                                struct notes *notes)
{
    const bool is_chosen = use->columns[0].size || use->columns[1].size;
    struct header header;
    struct text line;
    size_t number = 0;
    if (!next_line(&text, &number, &line)) {
        return fail(CONUS_ERROR_DATA, "no header row that could name columns");
    }
    (void)read_header_row(&header, line, is_chosen ? best_separator(line) : separator_of(line));
    for (int column = INDEX; column <= NAME; column++) {
        const struct text wanted = use->columns[column];
        header.at[column] = wanted.size ? find_column(line, header.separator, wanted) : header.at[column];
        header.at[RIVAL + column] = wanted.size ? NO_COLUMN : header.at[RIVAL + column];
        if (header.at[column] == NO_COLUMN) {
            return refuse_column(line, &header, wanted.size ? wanted : text_from(names[column][0]), number);
        }
    }
    if (header.twice && !is_chosen) {
        return fail(CONUS_ERROR_DATA, "line %zu: two columns are called %s", number, header.twice);
    }
    conus_status status = CONUS_OK;
    if (use->voxels && !use->columns[INDEX].size) { /* of several columns that could be the number the one that fits */
        size_t best = 0;
        while (best < SYNONYM_COUNT &&
               (!header.indices[best].name.size || header.indices[best].at != header.at[INDEX])) {
            best++;
        }
        const size_t usual = best;
        status = label_choose(&best, try_index, &(struct trial){&header, text, number}, SYNONYM_COUNT + 1, use->voxels,
                              notes);
        if (best != usual) {
            header.at[INDEX] = header.indices[best].at;
            header.at[RIVAL] = NO_COLUMN;
        }
    }
    return status ? status : parse_below(out, &header, text, number, notes);
}

const struct label_format label_format_chosen = {"label table", NULL, parse_table};

conus_status label_columns_refuse(struct text text)
{
    struct text line;
    struct buffer columns = {0};
    size_t number = 0;
    if (!text_is_readable(text) || !next_line(&text, &number, &line) || strchr("<{[", line.data[0])) {
        return CONUS_OK;
    }
    size_t count = list_columns(&columns, line, best_separator(line));
    conus_status status = buffer_status(&columns);
    if (!status && count > 1) {
        status =
            fail(CONUS_ERROR_DATA,
                 "not a label table of a known format: its columns are %s; needed are a label (index, LabelValue, "
                 "annotation_value, id, key, ROIid, label) and a name (name, region, structure, ROIname, label), or "
                 "FILE,label=COLUMN,name=COLUMN",
                 columns.data);
    }
    buffer_finish(&columns);
    return status;
}

/* Whether most rows have a whole number in the column of the number, and words in that of the name. */
static bool counts_by_value(const struct header *header, struct text text)
{
    struct text line;
    size_t number = 0;
    size_t rows = 0;
    size_t good = 0;
    while (next_row(&text, &number, &line, header)) {
        struct text cells[COLUMN_COUNT] = {{0}};
        rows++;
        good += !read_cells(cells, header, line, "") && is_whole(cells[INDEX]) && is_word(cells[NAME]);
    }
    return 2 * good > rows;
}

/* A row without a header: number and name; whether another column has words. */
struct bare {
    struct text cells[2];
    size_t columns;
    bool more_words;
    bool closed;
};

static struct bare read_bare(struct text line, char separator)
{
    struct bare row = {.closed = true};
    struct text field;
    enum text_quotes quotes;
    for (bool more = true; text_quoted_field(&line, separator, &more, &field, &quotes); row.columns++) {
        row.closed = row.closed && quotes != TEXT_UNCLOSED;
        if (row.columns < 2) {
            row.cells[row.columns] = field;
        } else {
            row.more_words = row.more_words || is_word(field);
        }
    }
    return row;
}

/* The separator, ',' or ';', behind the number that a row begins with; 0 if it begins otherwise. */
static char bare_separator(struct text text)
{
    struct text line;
    size_t number = 0;
    if (!next_line(&text, &number, &line)) {
        return 0;
    }
    static const char separators[] = {',', ';'};
    for (size_t i = 0; i < sizeof separators; i++) {
        struct bare row = read_bare(line, separators[i]);
        if (row.columns > 1 && is_whole(row.cells[0])) {
            return separators[i];
        }
    }
    return 0;
}

static bool is_bare(struct text text)
{
    char separator = bare_separator(text);
    struct text line;
    size_t number = 0;
    size_t rows = 0;
    size_t good = 0;
    while (separator && next_line(&text, &number, &line)) {
        struct bare row = read_bare(line, separator);
        rows++;
        good += is_whole(row.cells[0]) && is_word(row.cells[1]);
    }
    return 2 * good > rows;
}

static int compare_column_names(const void *a, const void *b)
{
    const struct label *const *x = a;
    const struct label *const *y = b;
    return strcmp((*x)->name, (*y)->name);
}

/* Fails where two numbers have one name; it is asked where another column has words, too, and may have the name. */
static conus_status check_names_differ(const struct label_table *table)
{
    const struct label **labels = memory_raw(table->count, sizeof(struct label *));
    size_t count = 0;
    if (!labels) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < table->count; i++) {
        labels[count] = &table->entries[i];
        count += table->entries[i].name != NULL;
    }
    qsort(labels, count, sizeof(struct label *), compare_column_names);
    conus_status status = CONUS_OK;
    for (size_t i = 1; !status && i < count; i++) {
        if (labels[i - 1]->number != labels[i]->number && compare_column_names(&labels[i - 1], &labels[i]) == 0) {
            status = fail(CONUS_ERROR_DATA,
                          "labels %u and %u are both \"%s\" in column 2, and other columns have words, too: a header "
                          "row (index,name) must say which is the name",
                          labels[i - 1]->number, labels[i]->number, labels[i]->name);
        }
    }
    memory_free(labels);
    return status;
}

static conus_status parse_bare(struct label_table *out, struct text text, struct notes *notes)
{
    char separator = bare_separator(text);
    struct text line;
    size_t number = 0;
    size_t columns = 0;
    bool more_words = false;
    conus_status status = CONUS_OK;
    while (!status && next_line(&text, &number, &line)) {
        char where[32];
        struct label label = {0};
        struct bare row = read_bare(line, separator);
        snprintf(where, sizeof where, "line %zu", number);
        columns = columns ? columns : row.columns;
        more_words = more_words || row.more_words;
        if (!row.closed) {
            return fail(CONUS_ERROR_DATA, "%s: a quotation mark is not closed", where);
        }
        if (row.columns != columns) {
            return fail(CONUS_ERROR_DATA, "%s: %zu columns, the first line has %zu", where, row.columns, columns);
        }
        status = label_cell_number(&label.number, row.cells[0], where);
        status = status ? status : set_cell(&label.name, row.cells[1]);
        status = label_keep(out, &label, status, notes);
    }
    return status || !more_words ? status : check_names_differ(out);
}

const struct label_format *label_format_of_columns(struct text text)
{
    static const struct label_format tsv = {"BIDS label table", NULL, parse_table};
    static const struct label_format slicer = {"Slicer colour table", NULL, parse_table};
    static const struct label_format csv = {"CSV label table", NULL, parse_table};
    static const struct label_format bare = {"CSV without a header", parse_bare, NULL};
    struct header header;
    struct text line;
    struct text rest = text;
    size_t number = 0;
    if (!next_line(&rest, &number, &line) || !read_header_row(&header, line, separator_of(line))) {
        return is_bare(text) ? &bare : NULL;
    }
    if (header.by_value && !counts_by_value(&header, rest)) {
        return NULL;
    }
    bool is_slicer = text_mentions(line, "LabelValue");
    return header.separator == '\t' ? &tsv : is_slicer ? &slicer : &csv;
}
