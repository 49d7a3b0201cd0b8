/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables of rows with white space between the columns. Which of the formats it is follows from the types of the
 * columns in most rows; a row that then breaks the format is an error, never a reason to read it as something else. */
#include "loaders/labels/label_format.h"

#include "loaders/labels/label_cells.h"

#include <stdlib.h>
#include <string.h>

struct row {
    size_t line;       /* from 1 */
    struct text all;   /* trimmed */
    struct text first; /* word */
    struct text rest;  /* what follows it, trimmed */
};

/* Takes the next row that is neither blank nor a comment off `text`; row->line is that of the last one. */
static bool next_row(struct text *text, struct row *row)
{
    struct text line;
    while (text_line(text, &line)) {
        row->line++;
        row->all = text_trim(line);
        if (text_word(&line, &row->first) && row->first.data[0] != '#') {
            row->rest = text_trim(line);
            return true;
        }
    }
    return false;
}

/* Takes the last word off `rest`. */
static struct text take_last_word(struct text *rest)
{
    size_t start = rest->size;
    while (start && !strchr(" \t\v\f", rest->data[start - 1])) {
        start--;
    }
    struct text word = {rest->data + start, rest->size - start};
    rest->size = start;
    *rest = text_trim(*rest);
    return word;
}

/* Written like a number, though perhaps not one that the column allows: 3.5, -1, 1e9, nan. */
static bool looks_numeric(struct text word)
{
    bool digits = false;
    size_t i = 0;
    for (; i < word.size && strchr("0123456789+-.eE", word.data[i]) && word.data[i]; i++) {
        digits = digits || (word.data[i] >= '0' && word.data[i] <= '9');
    }
    bool starts = word.size && word.data[0] != 'e' && word.data[0] != 'E';
    return (i == word.size && digits && starts) || text_is_one_of(word, "nan/inf/-inf", false);
}

/* The words after the first: how many, and how many numbers they start and end with. A row's name needs at least one
 * word, so the numbers at the end are fewer than the words. */
struct shape {
    size_t words, lead, tail;
    bool quoted; /* a quotation mark follows the numbers at the start */
    bool numbered;
};

static struct shape shape_of(const struct row *row)
{
    struct shape shape = {.numbered = looks_numeric(row->first)};
    struct text rest = row->rest;
    struct text word;
    while (text_word(&rest, &word)) {
        bool numeric = looks_numeric(word);
        shape.quoted = shape.quoted || (shape.lead == shape.words && word.data[0] == '"');
        shape.lead += numeric && shape.lead == shape.words;
        shape.tail = numeric ? shape.tail + 1 : 0;
        shape.words++;
    }
    shape.tail = shape.words && shape.tail == shape.words ? shape.words - 1 : shape.tail;
    return shape;
}

static bool has_only_first_tab(const struct row *row)
{
    const char *tab = memchr(row->all.data, '\t', row->all.size);
    return tab == row->first.data + row->first.size && !memchr(row->rest.data, '\t', row->rest.size);
}

/* "1 0.5 0.25 0", or with a fourth number, an opacity, or the label's own number in the place of a name. */
static bool is_unnamed(const struct label_census *census, const struct row *row, uint64_t *number)
{
    struct text rest = row->rest;
    struct text word;
    size_t words = 0;
    bool good = text_to_uint(row->first, UINT32_MAX, number) && (!census->rows || *number > census->last);
    for (; good && text_word(&rest, &word); words++) {
        double value;
        bool own = words == 3 && text_compare(word, row->first) == 0;
        good = own || (text_to_double(word, &value) && value >= 0 && value <= 1);
    }
    return good && (words == 3 || words == 4);
}

struct label_census label_rows_count(struct text text)
{
    struct label_census census = {0};
    for (struct row row = {0}; next_row(&text, &row);) {
        uint64_t number = 0;
        census.unnamed += is_unnamed(&census, &row, &number);
        census.last = number;
        struct shape s = shape_of(&row);
        bool five_numbers = s.numbered && s.words == 4 && s.lead == 4;
        census.tabbed = (census.tabbed || !census.rows) && has_only_first_tab(&row);
        census.pairs += census.rows % 2 == five_numbers; /* alternately a name and five numbers */
        census.rows++;
        census.named += s.numbered && s.lead < s.words;
        census.coded += s.numbered && s.words == 2 && s.lead == 0 && s.tail == 1;
        census.coloured += s.numbered && s.tail >= 3;
        census.with_alpha += s.numbered && s.tail >= 4;
        census.mrtrix += s.numbered && s.words == 6 && s.lead == 0 && s.tail == 4;
        census.fsleyes += s.numbered && s.lead >= 3 && s.lead < s.words;
        census.itk_snap += s.numbered && s.lead == 6 && s.quoted;
        census.number_last +=
            !s.numbered && ((s.words == 1 && s.lead == 1) || (s.words == 2 && s.lead == 0 && s.tail == 1));
    }
    return census;
}

struct word_of {
    struct text word;
    struct text number; /* of the row it stands in */
};

static int compare_words(const void *a, const void *b)
{
    const struct word_of *x = a;
    const struct word_of *y = b;
    int order = text_compare(x->word, y->word);
    return order ? order : text_compare(x->number, y->number);
}

static void take_words(struct text *rest, struct text *words, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        text_word(rest, &words[i]);
    }
}

static struct text take_first_word(struct text *rest)
{
    struct text word;
    take_words(rest, &word, 1);
    return word;
}

/* Whether a word that `take` finds behind the number differs wherever the numbers do, and so can be a name or a code by
 * itself: "1 Area 17 / 2 Area 18" has names of two words, "1 Precentral_L 2001 / 2 Precentral_R 2002" of one. */
static bool words_differ(struct job *job, struct text text, size_t rows, struct text (*take)(struct text *rest))
{
    const struct job_mark mark = job_mark(job);
    struct word_of *words = job_array(job, &rows, sizeof *words);
    struct row row = {0};
    bool differ = true;
    for (size_t i = 0; i < rows && next_row(&text, &row); i++) {
        words[i] = (struct word_of){take(&row.rest), row.first};
    }
    if (rows) {
        qsort(words, rows, sizeof *words, compare_words);
    }
    for (size_t i = 1; i < rows; i++) {
        bool same = text_compare(words[i - 1].word, words[i].word) == 0;
        differ = differ && !(same && text_compare(words[i - 1].number, words[i].number) != 0);
    }
    job_release(job, mark);
    return differ;
}

/* What a format needs to know to parse a row. */
struct layout {
    bool coded;         /* MRIcron: a code behind the name */
    size_t numbers;     /* of colours after the name: 3 or 4 */
    bool two_names;     /* MRtrix: abbreviation and name */
    bool underscores;   /* in names, where spaces are meant */
    struct text before; /* what the row before says */
};

/* Fills all but the number of a row's entry. */
typedef void parse_row(struct job *job, struct label_row *out, const struct row *row, const struct layout *layout);

static void keep_row(struct job *job, struct label_table *out, const struct row *row, struct text number,
                     parse_row *parse, const struct layout *layout)
{
    struct label_row entry = {0};
    size_t place = job_in(job, "line ", row->line);
    entry.label.number = label_cell_number(job, number);
    parse(job, &entry, row, layout);
    job_out(job, place);
    labels_keep(job, out, &entry);
}

static void parse_rows(struct job *job, struct label_table *out, struct text text, parse_row *parse,
                       const struct layout *layout)
{
    for (struct row row = {0}; job_ok(job) && next_row(&text, &row);) {
        keep_row(job, out, &row, row.first, parse, layout);
    }
}

static bool is_quoted(struct text text)
{
    return text.size >= 2 && text.data[0] == '"' && text.data[text.size - 1] == '"';
}

/* Whether a name begins as FSLeyes's three colours do, with decimal commas: "0,1 0,93 1 Frontal Pole". */
static bool begins_as_colours(struct text name)
{
    struct text word;
    int numbers = 0;
    bool comma = false;
    while (numbers < 3 && text_word(&name, &word) && text_has_only(word, "0123456789,")) {
        comma = comma || text_mentions(word, ",");
        numbers++;
    }
    return comma && numbers == 3;
}

static struct text unquote(struct text text)
{
    return (struct text){text.data + 1, text.size - 2};
}

static void parse_plain_row(struct job *job, struct label_row *out, const struct row *row, const struct layout *layout)
{
    out->name = row->rest;
    if (layout->coded) {
        take_last_word(&out->name);
    }
    out->name = is_quoted(out->name) ? unquote(out->name) : out->name;
    if (begins_as_colours(out->name)) {
        job_bad(job, "\"%.*s\": decimals are written with a point", TEXT_SHOW(out->name, 40));
    }
}

/* In a short list, "1 Area 17 / 2 Crus 1", numbers may differ and yet belong to the names. */
enum { CODED_ROWS = 8 };

/* "1 Precentral_L", "1<tab>Frontal Pole", "1 Precentral_L 2001". */
static void parse_plain(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    const struct label_census census = label_rows_count(text);
    struct layout layout = {.coded = census.coded == census.rows && census.rows >= CODED_ROWS && !census.tabbed};
    (void)use;
    layout.coded = layout.coded && words_differ(job, text, census.rows, take_first_word) &&
                   words_differ(job, text, census.rows, take_last_word);
    parse_rows(job, out, text, parse_plain_row, &layout);
}

/* The opacity says nothing about visibility: it is 0 in FreeSurfer's own file. */
static void check_opacity(struct job *job, struct text cell)
{
    (void)label_cell_channel(job, cell, "opacity");
}

static void parse_colour_row(struct job *job, struct label_row *out, const struct row *row, const struct layout *layout)
{
    struct text cells[4] = {{0}};
    size_t numbers = shape_of(row).tail;
    if (numbers < layout->numbers) {
        job_bad(job, "%zu numbers after the name, %zu (%s) are needed as in the other lines", numbers, layout->numbers,
                layout->numbers == 4 ? "R G B A" : "R G B");
    }
    out->name = row->rest;
    for (size_t i = layout->numbers; i-- > 0;) {
        cells[i] = take_last_word(&out->name);
    }
    label_cell_rgb(job, &out->label, cells, label_cell_channel);
    if (layout->numbers == 4) {
        check_opacity(job, cells[3]);
    }
    if (layout->two_names) {
        text_word(&out->name, &out->abbreviation);
    }
    out->underscores = layout->underscores;
}

static void parse_colours(struct job *job, struct label_table *out, struct text text, bool underscores)
{
    const struct layout layout = {.numbers = label_rows_count(text).with_alpha ? 4 : 3, .underscores = underscores};
    parse_rows(job, out, text, parse_colour_row, &layout);
}

/* "1 Left-Hippocampus 220 216 20 0". */
static void parse_freesurfer(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    parse_colours(job, out, text, false);
}

static void parse_slicer(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    parse_colours(job, out, text, true);
}

/* "1 L.HIPP Left-Hippocampus 220 216 20 255"; but where the second words repeat, they are a part of the name. */
static void parse_mrtrix(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    struct layout layout = {.numbers = 4};
    (void)use;
    layout.two_names = words_differ(job, text, label_rows_count(text).rows, take_first_word);
    parse_rows(job, out, text, parse_colour_row, &layout);
}

/* "1 0.5 0.25 0 Frontal Pole". */
static void parse_fsleyes_row(struct job *job, struct label_row *out, const struct row *row,
                              const struct layout *layout)
{
    struct text cells[3] = {{0}};
    (void)layout;
    out->name = row->rest;
    take_words(&out->name, cells, 3);
    label_cell_rgb(job, &out->label, cells, label_cell_fraction);
}

static void parse_fsleyes(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    parse_rows(job, out, text, parse_fsleyes_row, NULL);
}

/* A number and a colour. Text behind the colour is no name. */
static void parse_unnamed_row(struct job *job, struct label_row *out, const struct row *row,
                              const struct layout *layout)
{
    parse_fsleyes_row(job, out, row, layout);
    out->name = (struct text){0};
}

static void parse_unnamed(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    parse_rows(job, out, text, parse_unnamed_row, NULL);
}

/* `1 220 216 20 1.00 1 1 "Left hippocampus"`. */
static void parse_itk_snap_row(struct job *job, struct label_row *out, const struct row *row,
                               const struct layout *layout)
{
    struct text rest = row->rest;
    struct text cells[6] = {{0}};
    (void)layout;
    take_words(&rest, cells, 6);
    label_cell_rgb(job, &out->label, cells, label_cell_channel);
    for (int i = 3; i < 6; i++) { /* ITK-SNAP's own opacities are 0 to 1, those of others 0 to 255 */
        static const char *const what[] = {"opacity", "visibility", "mesh visibility"};
        double value;
        if (!(text_to_double(cells[i], &value) && value >= 0 && value <= 255)) {
            job_bad(job, "%s is not a number from 0 to 255", what[i - 3]);
        }
    }
    rest = text_trim(rest);
    if (!is_quoted(rest)) {
        job_bad(job, "no name in quotation marks after IDX R G B A VIS MSH");
        return;
    }
    out->name = unquote(rest);
}

static void parse_itk_snap(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    parse_rows(job, out, text, parse_itk_snap_row, NULL);
}

/* The name in "HIPL Hippocampus_L 4101" or "Hippocampus_L 4101", whose number was taken off. */
static void parse_names_row(struct job *job, struct label_row *out, const struct row *row, const struct layout *layout)
{
    (void)job;
    (void)layout;
    out->abbreviation = row->rest;
    out->name = take_last_word(&out->abbreviation);
}

static void parse_aal(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    for (struct row row = {0}; job_ok(job) && next_row(&text, &row);) {
        row.rest = row.all;
        struct text number = take_last_word(&row.rest);
        keep_row(job, out, &row, number, parse_names_row, NULL);
    }
}

/* "KEY R G B A", below a line with the name. */
static void parse_pair_row(struct job *job, struct label_row *out, const struct row *row, const struct layout *layout)
{
    struct text rest = row->rest;
    struct text cells[4] = {{0}};
    take_words(&rest, cells, 4);
    label_cell_rgb(job, &out->label, cells, label_cell_channel);
    check_opacity(job, cells[3]);
    out->name = layout->before;
}

/* Workbench's text: a line with the name, a line "KEY R G B A". */
static void parse_pairs(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    for (struct row row = {0}; job_ok(job) && next_row(&text, &row);) {
        const struct layout layout = {.before = row.all};
        if (next_row(&text, &row)) {
            keep_row(job, out, &row, row.first, parse_pair_row, &layout);
        }
    }
}

static bool is_pairs(const struct label_text *text)
{
    return text->census->rows >= 2 && text->census->rows % 2 == 0 && text->census->pairs == text->census->rows;
}

static bool is_aal(const struct label_text *text)
{
    return text->census->rows >= 2 && text->census->number_last == text->census->rows;
}

static bool is_unnamed_list(const struct label_text *text)
{
    return text->census->rows >= 2 && text->census->unnamed == text->census->rows;
}

static bool has_most(const struct label_text *text, size_t rows)
{
    return rows > text->census->rows / 2;
}

static bool is_itk_snap(const struct label_text *text)
{
    return has_most(text, text->census->itk_snap);
}

static bool is_freesurfer(const struct label_text *text)
{
    return has_most(text, text->census->coloured);
}

static bool is_mrtrix(const struct label_text *text)
{
    return is_freesurfer(text) && text->census->mrtrix == text->census->rows;
}

static bool is_slicer(const struct label_text *text)
{
    struct text rest = text->text;
    struct text line;
    return is_freesurfer(text) && text_line(&rest, &line) && line.size && line.data[0] == '#' &&
           text_mentions(line, "Color table file");
}

static bool is_fsleyes(const struct label_text *text)
{
    return has_most(text, text->census->fsleyes);
}

static bool is_plain(const struct label_text *text)
{
    return has_most(text, text->census->named);
}

const struct label_format label_format_pairs = {"Workbench label list", LABEL_ROWS, is_pairs, parse_pairs, NULL};
const struct label_format label_format_aal = {"AAL text", LABEL_ROWS, is_aal, parse_aal, ".nii.txt/.txt"};
const struct label_format label_format_colours = {"FSLeyes colours", LABEL_ROWS, is_unnamed_list, parse_unnamed, NULL};
const struct label_format label_format_itk_snap = {"ITK-SNAP labels", LABEL_ROWS, is_itk_snap, parse_itk_snap,
                                                   ".label"};
const struct label_format label_format_mrtrix = {"MRtrix or FreeSurfer colour table", LABEL_ROWS, is_mrtrix,
                                                 parse_mrtrix, NULL};
const struct label_format label_format_slicer = {"Slicer colour table", LABEL_ROWS, is_slicer, parse_slicer, ".ctbl"};
const struct label_format label_format_freesurfer = {"FreeSurfer colour table", LABEL_ROWS, is_freesurfer,
                                                     parse_freesurfer, NULL};
const struct label_format label_format_fsleyes = {"FSLeyes colour table", LABEL_ROWS, is_fsleyes, parse_fsleyes,
                                                  ".nii.lut/.lut"};
const struct label_format label_format_plain = {"MRIcron text", LABEL_ROWS, is_plain, parse_plain, NULL};
