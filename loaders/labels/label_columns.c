/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables with a header row: BIDS dseg.tsv, Slicer's CSV, and others. The names of the columns decide what they
 * mean; unknown columns are allowed. And CSV without one, number and name in front. */
#include "loaders/labels/label_format.h"

#include "base/order.h"
#include "loaders/labels/label_cells.h"

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

/* The cells of a row that have a meaning; empty where there are none. */
struct cells {
    struct text at[COLUMN_COUNT];
    int count;   /* of all */
    bool closed; /* all quotation marks */
};

static struct cells read_cells(const struct header *header, struct text line)
{
    struct cells cells = {.closed = true};
    enum text_quotes quotes;
    struct text field;
    for (bool more = true; text_quoted_field(&line, header->separator, &more, &field, &quotes); cells.count++) {
        cells.closed = cells.closed && quotes != TEXT_UNCLOSED;
        bool absent = text_equal(field, "n/a");
        for (int column = 0; column < COLUMN_COUNT; column++) {
            if (header->at[column] == cells.count && !absent) {
                cells.at[column] = field;
            }
        }
    }
    return cells;
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

static void fill_row(struct job *job, struct label_row *row, const struct text cells[COLUMN_COUNT], size_t line)
{
    struct label *label = &row->label;
    const struct text hemisphere = cells[HEMISPHERE];
    label->number = label_cell_number(job, cells[INDEX]);
    if (cells[COLOUR].size) {
        label->has_rgb = true;
        label_cell_colour(job, label->rgb, cells[COLOUR]);
    } else if (cells[RED].size || cells[GREEN].size || cells[BLUE].size) {
        label_cell_rgb(job, label, &cells[RED], label_cell_channel);
    }
    label->hemisphere = label_hemisphere_of(hemisphere);
    if (hemisphere.size && !label->hemisphere) {
        job_warn(job, "label table, line %zu: hemisphere \"%.*s\" is none of L, R, B: taken as not given", line,
                 TEXT_SHOW(hemisphere, 40));
    }
    const struct text parent = cells[cells[PARENT].size ? PARENT : PARENT_IDENTIFIER];
    label->parent = parent.size ? label_cell_number(job, parent) : 0;
    label->has_parent = label->parent != 0;
    row->name = undouble(job, cells[NAME]);
    row->abbreviation = undouble(job, cells[ABBREVIATION]);
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

/* Two columns may have names, of which one is used; and "index label name" may count rows in one column and give the
 * voxels' value in the other. */
static void note_rivals(struct job *job, struct header *header, const struct text cells[COLUMN_COUNT], size_t line)
{
    const struct text name = cells[NAME];
    const struct text rival = cells[NAME_RIVAL];
    uint64_t number = 0;
    uint64_t other;
    if (!header->disputed[0] && text_to_uint(cells[INDEX], UINT32_MAX, &number) &&
        text_to_uint(cells[RIVAL], UINT32_MAX, &other) && other != number) {
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
                 "used, by the order name, region, structure, ROIname, label; FILE,name=COLUMN chooses",
                 line, TEXT_SHOW(name, 40), TEXT_SHOW(rival, 40), TEXT_SHOW(name, 40));
    }
}

/* The number of a label by what the table identifies it with. */
struct identifier {
    uint32_t identifier, number;
    size_t row;
};

struct identifiers {
    struct identifier *at;
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
static void sort_identifiers(struct job *job, struct identifiers *identifiers)
{
    struct identifier *list = identifiers->at;
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
    if (doubtful) {
        job_warn(job,
                 "label table: several rows have the identifier %u: as a parent it means the first of them, label %u",
                 doubtful->identifier, doubtful->number);
    }
}

/* Makes parents, which are identifiers, numbers of labels. An identifier that no row has is no parent. */
static void find_parents(struct job *job, struct label_table *table, size_t first, struct identifiers *identifiers)
{
    sort_identifiers(job, identifiers);
    for (size_t i = first; i < table->count; i++) {
        struct label *label = &table->entries[i];
        const struct identifier wanted = {.identifier = label->parent};
        const struct identifier *found =
            !label->has_parent || !identifiers->count
                ? NULL
                : bsearch(&wanted, identifiers->at, identifiers->count, sizeof *identifiers->at, compare_identifiers);
        if (label->has_parent && !found) {
            job_warn(job, "label table: %s has the parent_identifier %u, which no row has: no parent",
                     label->name ? label->name : "a row", label->parent);
        }
        label->parent = found ? found->number : 0;
        label->has_parent = label->parent != 0;
    }
}

/* Parses the rows below the header, which is line `number`. */
static void parse_below(struct job *job, struct label_table *out, struct header *header, struct text text,
                        size_t number)
{
    struct text line;
    struct identifiers identifiers = {0};
    size_t first = out->count;
    bool is_identified = header->at[IDENTIFIER] != NO_COLUMN && header->at[PARENT_IDENTIFIER] != NO_COLUMN &&
                         header->at[PARENT] == NO_COLUMN;
    while (job_ok(job) && next_row(&text, &number, &line, header)) {
        struct label_row row = {0};
        const struct cells cells = read_cells(header, line);
        size_t place = job_in(job, "line ", number);
        if (!cells.closed) {
            job_bad(job, "a quotation mark is not closed");
        } else if (cells.count > header->count) {
            job_bad(job, "%d columns, the header has %d", cells.count, header->count);
        }
        fill_row(job, &row, cells.at, number);
        note_rivals(job, header, cells.at, number);
        if (is_identified) {
            size_t at = identifiers.count;
            *LIST_ADD(job, &identifiers) =
                (struct identifier){label_cell_number(job, cells.at[IDENTIFIER]), row.label.number, at};
        }
        job_out(job, place);
        labels_keep(job, out, &row);
    }
    if (is_identified) {
        find_parents(job, out, first, &identifiers);
    }
}

/* "Nr", "Bezeichnung", ...: at most as many as a message has place for; *count of all. */
static const char *list_columns(struct job *job, size_t *count, struct text line, char separator)
{
    enum { SHOWN = 12, WIDTH = 40 };
    struct text field;
    enum text_quotes quotes;
    const char *list = "";
    *count = 0;
    for (bool more = true; text_quoted_field(&line, separator, &more, &field, &quotes); ++*count) {
        if (*count < SHOWN) {
            list = job_format(job, "%s%s\"%.*s\"", list, *count ? ", " : "", TEXT_SHOW(field, WIDTH));
        }
    }
    return *count > SHOWN ? job_format(job, "%s, ...", list) : list;
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

static struct text try_index(struct job *job, struct label_table *out, void *user, size_t candidate)
{
    const struct trial *trial = user;
    struct header tried = *trial->header;
    const struct candidate *index = &tried.indices[candidate];
    tried.at[INDEX] = index->at;
    if (index->name.size && index->at != tried.at[NAME]) {
        parse_below(job, out, &tried, trial->below, trial->number);
    }
    return index->name;
}

/* Takes of several columns that could be the number the one that fits the voxels. */
static void choose_index(struct job *job, struct header *header, struct text below, size_t number,
                         const struct label_voxels *voxels)
{
    size_t usual = 0;
    while (usual < SYNONYM_COUNT &&
           (!header->indices[usual].name.size || header->indices[usual].at != header->at[INDEX])) {
        usual++;
    }
    size_t best =
        label_choose(job, usual, try_index, &(struct trial){header, below, number}, SYNONYM_COUNT + 1, voxels);
    if (best != usual) {
        header->at[INDEX] = header->indices[best].at;
        header->at[RIVAL] = NO_COLUMN;
    }
}

static void parse_table(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    const bool is_chosen = use->columns[0].size || use->columns[1].size;
    struct header header;
    struct text line;
    size_t number = 0;
    size_t count;
    if (!next_line(&text, &number, &line)) {
        job_bad(job, "no header row that could name columns");
        return;
    }
    (void)read_header_row(&header, line, is_chosen ? best_separator(line) : separator_of(line));
    size_t place = job_in(job, "line ", number);
    for (int column = INDEX; column <= NAME; column++) {
        struct text wanted = use->columns[column];
        header.at[column] = wanted.size ? find_column(line, header.separator, wanted) : header.at[column];
        header.at[RIVAL + column] = wanted.size ? NO_COLUMN : header.at[RIVAL + column];
        wanted = wanted.size ? wanted : text_from(names[column][0]);
        if (header.at[column] == NO_COLUMN) {
            job_bad(job, "no column is called \"%.*s\", there are %s", (int)wanted.size, wanted.data,
                    list_columns(job, &count, line, header.separator));
        }
    }
    if (header.twice && !is_chosen) {
        job_bad(job, "two columns are called %s", header.twice);
    }
    job_out(job, place);
    if (job_ok(job) && use->voxels && !use->columns[INDEX].size) {
        choose_index(job, &header, text, number, use->voxels);
    }
    parse_below(job, out, &header, text, number);
}

void label_columns_refuse(struct job *job, struct text text)
{
    struct text line;
    size_t number = 0;
    size_t count;
    if (!text_is_readable(text) || !next_line(&text, &number, &line) || strchr("<{[", line.data[0])) {
        return;
    }
    const char *columns = list_columns(job, &count, line, best_separator(line));
    if (count > 1) {
        job_bad(job,
                "not a label table of a known format: its columns are %s; needed are a label (index, LabelValue, "
                "annotation_value, id, key, ROIid, label) and a name (name, region, structure, ROIname, label), or "
                "FILE,label=COLUMN,name=COLUMN",
                columns);
    }
}

/* Whether most rows have a whole number in the column of the number, and words in that of the name. */
static bool counts_by_value(const struct header *header, struct text text)
{
    struct text line;
    size_t number = 0;
    size_t rows = 0;
    size_t good = 0;
    while (next_row(&text, &number, &line, header)) {
        const struct cells cells = read_cells(header, line);
        rows++;
        good += cells.closed && cells.count <= header->count && is_whole(cells.at[INDEX]) && is_word(cells.at[NAME]);
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

static int compare_names(const void *a, const void *b)
{
    return strcmp((*(const struct label *const *)a)->name, (*(const struct label *const *)b)->name);
}

/* Fails where two numbers have one name; it is asked where another column has words, too, and may have the name. */
static void check_names_differ(struct job *job, const struct label_table *table)
{
    size_t count = table->count;
    const struct label **labels = job_array(job, &count, sizeof(struct label *));
    if (!count) {
        return;
    }
    count = 0;
    for (size_t i = 0; i < table->count; i++) {
        labels[count] = &table->entries[i];
        count += table->entries[i].name != NULL;
    }
    qsort(labels, count, sizeof(struct label *), compare_names);
    for (size_t i = 1; i < count; i++) {
        if (labels[i - 1]->number != labels[i]->number && compare_names(&labels[i - 1], &labels[i]) == 0) {
            job_bad(job,
                    "labels %u and %u are both \"%s\" in column 2, and other columns have words, too: a header row "
                    "(index,name) must say which is the name",
                    labels[i - 1]->number, labels[i]->number, labels[i]->name);
        }
    }
}

static void parse_bare(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    char separator = bare_separator(text);
    struct text line;
    size_t number = 0;
    size_t columns = 0;
    bool more_words = false;
    (void)use;
    while (job_ok(job) && next_line(&text, &number, &line)) {
        const struct bare bare = read_bare(line, separator);
        columns = columns ? columns : bare.columns;
        more_words = more_words || bare.more_words;
        size_t place = job_in(job, "line ", number);
        if (!bare.closed) {
            job_bad(job, "a quotation mark is not closed");
        } else if (bare.columns != columns) {
            job_bad(job, "%zu columns, the first line has %zu", bare.columns, columns);
        }
        const struct label_row row = {.label = {.number = label_cell_number(job, bare.cells[0])},
                                      .name = undouble(job, bare.cells[1])};
        job_out(job, place);
        labels_keep(job, out, &row);
    }
    if (more_words) {
        check_names_differ(job, out);
    }
}

bool label_columns_look(struct label_text *about)
{
    struct header header;
    struct text line;
    struct text rest = about->text;
    size_t number = 0;
    about->has_header = next_line(&rest, &number, &line) && read_header_row(&header, line, separator_of(line));
    if (!about->has_header) {
        return is_bare(about->text);
    }
    about->separator = header.separator;
    about->is_slicer = text_mentions(line, "LabelValue");
    return !header.by_value || counts_by_value(&header, rest);
}

static bool is_bids(const struct label_text *text)
{
    return text->has_header && text->separator == '\t';
}

static bool is_slicer(const struct label_text *text)
{
    return text->has_header && text->is_slicer;
}

static bool is_csv(const struct label_text *text)
{
    return text->has_header;
}

static bool is_without_header(const struct label_text *text)
{
    return !text->has_header;
}

const struct label_format label_format_chosen = {.name = "label table", .parse = parse_table};
const struct label_format label_format_bids = {"BIDS label table", LABEL_COLUMNS, is_bids, parse_table, ".tsv"};
const struct label_format label_format_slicer_csv = {"Slicer colour table", LABEL_COLUMNS, is_slicer, parse_table,
                                                     NULL};
const struct label_format label_format_csv = {"CSV label table", LABEL_COLUMNS, is_csv, parse_table, ".csv"};
const struct label_format label_format_bare = {"CSV without a header", LABEL_COLUMNS, is_without_header, parse_bare,
                                               NULL};
