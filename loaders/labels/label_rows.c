/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables of rows with white space between the columns. Which of the formats it is follows from the types of the
 * columns in most rows; a row that then breaks the format is an error, never a reason to read it as something else. */
#include "loaders/labels/label_format.h"

#include "base/memory.h"
#include "loaders/labels/label_cells.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct row {
    size_t line; /* from 1 */
    struct text all;
    struct text first; /* word */
    struct text rest;  /* what follows it, trimmed */
};

struct reader {
    struct text rest;
    size_t line;
};

/* The next row that is neither blank nor a comment. */
static bool next_row(struct reader *reader, struct row *row)
{
    struct text line;
    while (text_line(&reader->rest, &line)) {
        reader->line++;
        struct text rest = line;
        if (text_word(&rest, &row->first) && row->first.data[0] != '#') {
            row->line = reader->line;
            row->all = text_trim(line);
            row->rest = text_trim(rest);
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
    return (i == word.size && digits && starts) || text_equal_ignoring_case(word, "nan") ||
           text_equal_ignoring_case(word, "inf") || text_equal_ignoring_case(word, "-inf");
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

/* How many rows have what shape. */
struct census {
    size_t rows, numbered, named, coded, coloured, with_alpha, mrtrix, fsleyes, itk_snap, number_last, pairs;
    size_t unnamed; /* of rows of a number that grows and numbers from 0 to 1 */
    uint64_t last;  /* such number */
    bool tabbed;    /* a tab behind every first word and no other: the name is all the rest */
};

static bool has_only_first_tab(const struct row *row)
{
    const char *tab = memchr(row->all.data, '\t', row->all.size);
    return tab == row->first.data + row->first.size && !memchr(row->rest.data, '\t', row->rest.size);
}

/* "1 0.5 0.25 0", or with a fourth number, an opacity, or the label's own number in the place of a name. */
static bool is_unnamed(const struct census *census, const struct row *row, uint64_t *number)
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

static struct census count_rows(struct text text)
{
    struct census census = {0};
    struct reader reader = {.rest = text};
    struct row row;
    while (next_row(&reader, &row)) {
        uint64_t number = 0;
        census.unnamed += is_unnamed(&census, &row, &number);
        census.last = number;
        struct shape s = shape_of(&row);
        bool five_numbers = s.numbered && s.words == 4 && s.lead == 4;
        census.tabbed = (census.tabbed || !census.rows) && has_only_first_tab(&row);
        census.pairs += census.rows % 2 == five_numbers; /* alternately a name and five numbers */
        census.rows++;
        census.numbered += s.numbered;
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
static conus_status words_differ(bool *out, struct text text, size_t rows, struct text (*take)(struct text *rest))
{
    struct word_of *words = memory_zeroed(rows, sizeof *words);
    if (!words) {
        return CONUS_ERROR_MEMORY;
    }
    struct reader reader = {.rest = text};
    struct row row;
    for (size_t i = 0; i < rows && next_row(&reader, &row); i++) {
        words[i] = (struct word_of){take(&row.rest), row.first};
    }
    qsort(words, rows, sizeof *words, compare_words);
    *out = true;
    for (size_t i = 1; i < rows; i++) {
        bool same = text_compare(words[i - 1].word, words[i].word) == 0;
        *out = *out && !(same && text_compare(words[i - 1].number, words[i].number) != 0);
    }
    memory_free(words);
    return CONUS_OK;
}

typedef conus_status parse_row(struct label *label, const struct row *row, const char *where, const void *data);

static conus_status keep_row(struct label_table *out, struct notes *notes, const struct row *row, struct text number,
                             parse_row *parse, const void *data)
{
    char where[32];
    struct label label = {0};
    snprintf(where, sizeof where, "line %zu", row->line);
    conus_status status = label_cell_number(&label.number, number, where);
    status = status ? status : parse(&label, row, where, data);
    return label_keep(out, &label, status, notes);
}

static conus_status parse_rows(struct label_table *out, struct text text, struct notes *notes, parse_row *parse,
                               const void *data)
{
    struct reader reader = {.rest = text};
    struct row row;
    conus_status status = CONUS_OK;
    while (!status && next_row(&reader, &row)) {
        status = keep_row(out, notes, &row, row.first, parse, data);
    }
    return status;
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

static conus_status parse_plain_row(struct label *label, const struct row *row, const char *where, const void *data)
{
    const bool *coded = data;
    struct text name = row->rest;
    if (*coded) {
        take_last_word(&name);
    }
    if (is_quoted(name)) {
        name = (struct text){name.data + 1, name.size - 2};
    }
    if (begins_as_colours(name)) {
        return fail(CONUS_ERROR_DATA, "%s: \"%.*s\": decimals are written with a point", where, TEXT_SHOW(name, 40));
    }
    return label_set_text(&label->name, name);
}

/* In a short list, "1 Area 17 / 2 Crus 1", numbers may differ and yet belong to the names. */
enum { CODED_ROWS = 8 };

/* "1 Precentral_L", "1<tab>Frontal Pole", "1 Precentral_L 2001". */
static conus_status parse_plain(struct label_table *out, struct text text, struct notes *notes)
{
    struct census census = count_rows(text);
    bool coded = census.coded == census.rows && census.rows >= CODED_ROWS && !census.tabbed;
    conus_status status = coded ? words_differ(&coded, text, census.rows, take_first_word) : CONUS_OK;
    status = !status && coded ? words_differ(&coded, text, census.rows, take_last_word) : status;
    return status ? status : parse_rows(out, text, notes, parse_plain_row, &coded);
}

struct colour_layout {
    size_t numbers;   /* after the name: 3 or 4 */
    bool two_names;   /* MRtrix: abbreviation and name */
    bool underscores; /* in names, where spaces are meant */
};

static conus_status parse_colour_row(struct label *label, const struct row *row, const char *where, const void *data)
{
    const struct colour_layout *layout = data;
    struct text name = row->rest;
    struct text cells[4] = {{0}};
    uint8_t opacity;
    if (shape_of(row).tail < layout->numbers) {
        return fail(CONUS_ERROR_DATA, "%s: %zu numbers after the name, %zu (%s) are needed as in the other lines",
                    where, shape_of(row).tail, layout->numbers, layout->numbers == 4 ? "R G B A" : "R G B");
    }
    for (size_t i = layout->numbers; i-- > 0;) {
        cells[i] = take_last_word(&name);
    }
    conus_status status = label_cell_rgb(label, cells, label_cell_channel, where);
    if (!status && layout->numbers == 4) {
        status = label_cell_channel(&opacity, cells[3], "opacity", where);
    }
    struct text abbreviation;
    if (!status && layout->two_names && text_word(&name, &abbreviation)) {
        status = label_set_text(&label->abbreviation, abbreviation);
    }
    status = status ? status : label_set_text(&label->name, name);
    for (char *c = label->name; !status && layout->underscores && c && *c; c++) {
        *c = *c == '_' ? ' ' : *c;
    }
    return status;
}

static conus_status parse_colours(struct label_table *out, struct text text, struct notes *notes, bool underscores)
{
    struct census census = count_rows(text);
    struct colour_layout layout = {.numbers = census.with_alpha ? 4 : 3, .underscores = underscores};
    return parse_rows(out, text, notes, parse_colour_row, &layout);
}

/* "1 Left-Hippocampus 220 216 20 0"; the opacity says nothing about visibility: it is 0 in FreeSurfer's own file. */
static conus_status parse_freesurfer(struct label_table *out, struct text text, struct notes *notes)
{
    return parse_colours(out, text, notes, false);
}

static conus_status parse_slicer(struct label_table *out, struct text text, struct notes *notes)
{
    return parse_colours(out, text, notes, true);
}

/* "1 L.HIPP Left-Hippocampus 220 216 20 255"; but where the second words repeat, they are a part of the name. */
static conus_status parse_mrtrix(struct label_table *out, struct text text, struct notes *notes)
{
    struct colour_layout layout = {.numbers = 4};
    conus_status status = words_differ(&layout.two_names, text, count_rows(text).rows, take_first_word);
    return status ? status : parse_rows(out, text, notes, parse_colour_row, &layout);
}

/* "1 0.5 0.25 0 Frontal Pole". */
static conus_status parse_fsleyes_row(struct label *label, const struct row *row, const char *where, const void *data)
{
    (void)data;
    struct text rest = row->rest;
    struct text cells[3] = {{0}};
    take_words(&rest, cells, 3);
    conus_status status = label_cell_rgb(label, cells, label_cell_fraction, where);
    return status ? status : label_set_text(&label->name, rest);
}

static conus_status parse_fsleyes(struct label_table *out, struct text text, struct notes *notes)
{
    return parse_rows(out, text, notes, parse_fsleyes_row, NULL);
}

/* A number and a colour. Text behind the colour is no name. */
static conus_status parse_unnamed_row(struct label *label, const struct row *row, const char *where, const void *data)
{
    (void)data;
    struct text rest = row->rest;
    struct text cells[3] = {{0}};
    take_words(&rest, cells, 3);
    return label_cell_rgb(label, cells, label_cell_fraction, where);
}

static conus_status parse_unnamed(struct label_table *out, struct text text, struct notes *notes)
{
    return parse_rows(out, text, notes, parse_unnamed_row, NULL);
}

/* `1 220 216 20 1.00 1 1 "Left hippocampus"`. */
static conus_status parse_itk_snap_row(struct label *label, const struct row *row, const char *where, const void *data)
{
    (void)data;
    struct text rest = row->rest;
    struct text cells[6] = {{0}};
    take_words(&rest, cells, 6);
    conus_status status = label_cell_rgb(label, cells, label_cell_channel, where);
    for (int i = 3; !status && i < 6; i++) { /* ITK-SNAP's own opacities are 0 to 1, those of others 0 to 255 */
        static const char *const what[] = {"opacity", "visibility", "mesh visibility"};
        double value;
        if (!(text_to_double(cells[i], &value) && value >= 0 && value <= 255)) {
            return fail(CONUS_ERROR_DATA, "%s: %s is not a number from 0 to 255", where, what[i - 3]);
        }
    }
    rest = text_trim(rest);
    if (!status && !is_quoted(rest)) {
        return fail(CONUS_ERROR_DATA, "%s: no name in quotation marks after IDX R G B A VIS MSH", where);
    }
    return status ? status : label_set_text(&label->name, (struct text){rest.data + 1, rest.size - 2});
}

static conus_status parse_itk_snap(struct label_table *out, struct text text, struct notes *notes)
{
    return parse_rows(out, text, notes, parse_itk_snap_row, NULL);
}

/* The name in "HIPL Hippocampus_L 4101" or "Hippocampus_L 4101", whose number was taken. */
static conus_status parse_names_row(struct label *label, const struct row *row, const char *where, const void *data)
{
    (void)where;
    (void)data;
    struct text rest = row->rest;
    struct text name = take_last_word(&rest);
    conus_status status = label_set_text(&label->name, name);
    return status ? status : label_set_text(&label->abbreviation, rest);
}

static conus_status parse_number_last(struct label_table *out, struct text text, struct notes *notes)
{
    struct reader reader = {.rest = text};
    struct row row;
    conus_status status = CONUS_OK;
    while (!status && next_row(&reader, &row)) {
        row.rest = row.all;
        struct text number = take_last_word(&row.rest);
        status = keep_row(out, notes, &row, number, parse_names_row, NULL);
    }
    return status;
}

/* "KEY R G B A"; the data is the text of the name. */
static conus_status parse_pair_row(struct label *label, const struct row *row, const char *where, const void *data)
{
    const struct text *name = data;
    struct text rest = row->rest;
    struct text cells[4] = {{0}};
    uint8_t opacity;
    take_words(&rest, cells, 4);
    conus_status status = label_cell_rgb(label, cells, label_cell_channel, where);
    status = status ? status : label_cell_channel(&opacity, cells[3], "opacity", where);
    return status ? status : label_set_text(&label->name, *name);
}

/* Workbench's text: a line with the name, a line "KEY R G B A". */
static conus_status parse_pairs(struct label_table *out, struct text text, struct notes *notes)
{
    struct reader reader = {.rest = text};
    struct row name;
    struct row numbers;
    conus_status status = CONUS_OK;
    while (!status && next_row(&reader, &name) && next_row(&reader, &numbers)) {
        status = keep_row(out, notes, &numbers, numbers.first, parse_pair_row, &name.all);
    }
    return status;
}

static bool says_slicer(struct text text)
{
    struct text line;
    return text_line(&text, &line) && line.size && line.data[0] == '#' && text_mentions(line, "Color table file");
}

const struct label_format label_format_colours = {"FSLeyes colours", parse_unnamed, NULL};

const struct label_format *label_format_of_rows(struct text text)
{
    static const struct label_format plain = {"MRIcron text", parse_plain, NULL};
    static const struct label_format freesurfer = {"FreeSurfer colour table", parse_freesurfer, NULL};
    static const struct label_format slicer = {"Slicer colour table", parse_slicer, NULL};
    static const struct label_format mrtrix = {"MRtrix or FreeSurfer colour table", parse_mrtrix, NULL};
    static const struct label_format fsleyes = {"FSLeyes colour table", parse_fsleyes, NULL};
    static const struct label_format itk_snap = {"ITK-SNAP labels", parse_itk_snap, NULL};
    static const struct label_format number_last = {"AAL text", parse_number_last, NULL};
    static const struct label_format pairs = {"Workbench label list", parse_pairs, NULL};
    struct census census = count_rows(text);
    size_t half = census.rows / 2;
    if (census.rows >= 2 && census.rows % 2 == 0 && census.pairs == census.rows) {
        return &pairs;
    }
    if (census.rows >= 2 && census.number_last == census.rows) {
        return &number_last;
    }
    if (census.rows >= 2 && census.unnamed == census.rows) {
        return &label_format_colours;
    }
    if (census.itk_snap > half) {
        return &itk_snap;
    }
    if (census.coloured > half) {
        return census.mrtrix == census.rows ? &mrtrix : says_slicer(text) ? &slicer : &freesurfer;
    }
    if (census.fsleyes > half) {
        return &fsleyes;
    }
    return census.named > half ? &plain : NULL;
}
