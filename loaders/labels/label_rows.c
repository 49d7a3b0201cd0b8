/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables of rows with white space between the columns. Which of the formats it is follows from the types of the
 * columns in most rows; a row that then breaks the format is an error, never a reason to read it as something else. */
#include "loaders/labels/label_format.h"

#include "base/order.h"

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

/* Takes the first word off `rest`, empty where there is none. */
static struct text take_word(struct text *rest)
{
    struct text word = {0};
    text_word(rest, &word);
    return word;
}

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

/* Skips a row of column names, which has no digits: two rows that begin with a number follow (of Workbench's pairs the
 * second of them is a name). */
static bool skip_heading(struct text *text, struct row *row)
{
    struct row rows[3] = {{0}};
    struct text rest[3];
    struct text after = *text;
    bool good = true;
    for (int i = 0; good && i < 3; i++) {
        rows[i].line = i ? rows[i - 1].line : 0;
        good = next_row(&after, &rows[i]) && looks_numeric(rows[i].first) == (i > 0);
        rest[i] = after;
    }
    for (size_t i = 0; good && i < rows[0].all.size; i++) {
        good = !(rows[0].all.data[i] >= '0' && rows[0].all.data[i] <= '9');
    }
    if (good && rows[0].rest.size) {
        *row = rows[0];
        *text = rest[0];
    }
    return good && rows[0].rest.size;
}

static bool has_only_first_tab(const struct row *row)
{
    const char *tab = memchr(row->all.data, '\t', row->all.size);
    return tab == row->first.data + row->first.size && !memchr(row->rest.data, '\t', row->rest.size);
}

/* "1 0.5 0.25 0", or with a fourth number, an opacity, or the label's own number in the place of a name. The number is
 * larger than `last`, that of the row before, unless it is the first. */
static bool is_unnamed(const struct row *row, uint64_t *last)
{
    struct text rest = row->rest;
    struct text word;
    size_t words = 0;
    uint64_t number = 0;
    bool good = text_to_uint(row->first, UINT32_MAX, &number) && (*last == UINT64_MAX || number > *last);
    for (; good && text_word(&rest, &word); words++) {
        double value;
        bool own = words == 3 && text_compare(word, row->first) == 0;
        good = own || (text_to_double(word, &value) && value >= 0 && value <= 1);
    }
    *last = number;
    return good && (words == 3 || words == 4);
}

static bool ends_in_own_number(const struct row *row)
{
    struct text rest = row->rest;
    return text_compare(take_last_word(&rest), row->first) == 0;
}

struct label_census label_rows_count(struct text text)
{
    struct label_census census = {0};
    uint64_t last = UINT64_MAX;
    struct row row = {0};
    (void)skip_heading(&text, &row);
    for (; next_row(&text, &row); census.rows++) {
        struct shape s = shape_of(&row);
        bool five_numbers = s.numbered && s.words == 4 && s.lead == 4;
        const bool has[SHAPES] = {
            [SHAPE_PAIRS] = census.rows % 2 == five_numbers,
            [SHAPE_NUMBER_LAST] =
                !s.numbered && ((s.words == 1 && s.lead == 1) || (s.words == 2 && s.lead == 0 && s.tail == 1)),
            [SHAPE_UNNAMED] = is_unnamed(&row, &last),
            [SHAPE_ITK_SNAP] = s.numbered && s.lead == 6 && s.quoted,
            [SHAPE_MRTRIX] = s.numbered && s.words >= 6 && s.lead == 0 && s.tail == s.words - 2,
            [SHAPE_COLOURED] = s.numbered && s.tail >= 3,
            [SHAPE_FSLEYES] = s.numbered && s.lead >= 3 && s.lead < s.words,
            [SHAPE_NAMED] = s.numbered && s.lead < s.words,
        };
        for (int i = 0; i < SHAPES; i++) {
            census.of[i] += has[i];
        }
        census.tabbed = (census.tabbed || !census.rows) && has_only_first_tab(&row);
        census.coded += s.numbered && s.words == 2 && s.lead == 0 && s.tail == 1;
        census.own += s.numbered && s.words == 2 && s.lead == 0 && s.tail == 1 && ends_in_own_number(&row);
        census.with_alpha = census.with_alpha || (s.numbered && s.tail >= 4);
    }
    if (census.rows < 2) { /* one row says too little of these */
        census.of[SHAPE_NUMBER_LAST] = census.of[SHAPE_UNNAMED] = 0;
    }
    census.of[SHAPE_PAIRS] *= census.rows % 2 == 0;
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

/* What stands behind the number: a word, all up to a tab, or all but the numbers at the end. */
enum part { FIRST_WORD, LAST_WORD, COLUMN, NAME };

static struct text part_of(const struct row *row, enum part part)
{
    struct text rest = row->rest;
    bool more = true;
    struct text column = rest;
    if (part == COLUMN && text_field(&rest, '\t', &more, &column)) {
        return text_trim(column);
    }
    for (size_t tail = part == NAME ? shape_of(row).tail : 0; tail--;) {
        take_last_word(&rest);
    }
    return part == NAME ? rest : part == LAST_WORD ? take_last_word(&rest) : take_word(&rest);
}

/* Whether that part differs wherever the numbers do, and so can be a name or a code by itself: "1 Area 17 / 2 Area 18"
 * has names of two words, "1 Precentral_L 2001 / 2 Precentral_R 2002" of one. */
static bool words_differ(struct job *job, struct text text, size_t rows, enum part part)
{
    const struct job_mark mark = job_mark(job);
    struct word_of *words = job_array(job, &rows, sizeof *words);
    struct row row = {0};
    bool differ = true;
    for (size_t i = 0; i < rows && next_row(&text, &row); i++) {
        words[i].number = row.first;
        words[i].word = part_of(&row, part);
    }
    order_sort(words, rows, sizeof *words, compare_words);
    for (size_t i = 1; i < rows; i++) {
        bool same = text_compare(words[i - 1].word, words[i].word) == 0;
        differ = differ && !(same && text_compare(words[i - 1].number, words[i].number) != 0);
    }
    job_release(job, mark);
    return differ;
}

/* Whether numbers behind R G B A are a further column, as of FreeSurfer 8 (the tissue), and not the ends of names, to
 * which the opacity belongs then: without them names differ, and opacities do not. Fails where both could be. */
static bool has_further_numbers(struct job *job, struct text text, size_t rows)
{
    const struct text all = text;
    struct text longer = {0};
    struct text last[2] = {{0}}; /* the fourth number, and the last one of the row before */
    bool is_one[2] = {true, true};
    for (struct row row = {0}; next_row(&text, &row);) {
        struct text rest = row.rest;
        const size_t tail = shape_of(&row).tail;
        struct text now[2] = {take_last_word(&rest)};
        now[1] = now[0];
        for (size_t i = 4; i < tail; i++) {
            now[0] = take_last_word(&rest);
        }
        for (int i = 0; tail >= 4 && i < 2; i++) {
            is_one[i] = is_one[i] && (!last[i].size || text_compare(last[i], now[i]) == 0);
            last[i] = now[i];
        }
        longer = tail > 4 && !longer.size ? row.all : longer;
    }
    bool further = longer.size && is_one[0] && words_differ(job, all, rows, NAME);
    if (further && is_one[1] && text_is_one_of(last[1], "0/1/255", true)) {
        job_bad(job,
                "\"%.*s\": is a number behind R G B A, or does the name end in one? Leave it out, or join it with '_'",
                TEXT_SHOW(longer, 60));
    } else if (further) {
        job_note(job, "label table: numbers behind R G B A are passed over: \"%.*s\"", TEXT_SHOW(longer, 60));
    }
    return further;
}

/* Whether behind the name of each row stand numbers in columns of their own, with tabs between: "1<tab>Pons<tab>3512".
 */
static bool has_columns_of_numbers(struct job *job, struct text text, size_t rows)
{
    const struct text all = text;
    bool has = true;
    for (struct row row = {0}; has && next_row(&text, &row);) {
        struct text rest = row.rest;
        struct text column;
        bool more = true;
        has = text_field(&rest, '\t', &more, &column) && more;
        while (has && text_field(&rest, '\t', &more, &column)) {
            has = looks_numeric(text_trim(column));
        }
    }
    return has && words_differ(job, all, rows, COLUMN);
}

/* The text in quotation marks; in a plain list also in two apostrophes, if they are the only ones. */
static struct text unquote(struct text text, bool is_plain)
{
    const char mark = text.size >= 2 ? text.data[0] : 0;
    const struct text inner = mark ? (struct text){text.data + 1, text.size - 2} : text;
    const bool is_mark = mark == '"' || (mark == '\'' && is_plain && !memchr(inner.data, mark, inner.size));
    return is_mark && text.data[text.size - 1] == mark ? inner : text;
}

/* Whether a '#' with white space around it is in the name, and no number behind it: what follows may be a comment. */
static bool has_comment(struct text name)
{
    struct text word;
    bool has = false;
    while (!has && text_word(&name, &word)) {
        has = text_equal(word, "#") && text_word(&name, &word) && !looks_numeric(word);
    }
    return has;
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

/* Whether a mark stands before the name: "= Frontal Pole". */
static bool begins_with_mark(struct text name)
{
    struct text word;
    return text_word(&name, &word) && text_is_one_of(word, "=/:/|/-/->/=>", true) && text_word(&name, &word);
}

/* The numbers before or behind the name. The opacity says nothing about visibility: it is 0 in FreeSurfer's own file.
 */
static void read_numbers(struct job *job, struct label_row *out, const struct text *cells, size_t count,
                         const struct label_rows *rows)
{
    static const char *const what[] = {"opacity", "visibility", "mesh visibility"};
    if (count) {
        label_cell_rgb(job, &out->label, cells, rows->fractions ? label_cell_fraction : label_cell_channel);
    }
    if (count == 4) {
        (void)label_cell_channel(job, cells[3], what[0]);
    }
    for (size_t i = 3; count > 4 && i < count; i++) { /* ITK-SNAP's own opacities are 0 to 1, of others 0 to 255 */
        double value;
        if (!(text_to_double(cells[i], &value) && value >= 0 && value <= 255)) {
            job_bad(job, "%s is not a number from 0 to 255", what[i - 3]);
        }
    }
}

/* Fills all but the number of an entry from what stands beside that. */
static void read_row(struct job *job, struct label_row *out, const struct row *row, const struct label_rows *rows,
                     size_t tail)
{
    struct text cells[6] = {{0}};
    struct text rest = row->rest;
    size_t found = tail ? shape_of(row).tail : 0;
    if (found < tail) {
        job_bad(job, "%zu numbers after the name, %zu (%s) are needed as in the other lines", found, tail,
                tail == 4 ? "R G B A" : "R G B");
    }
    for (size_t i = tail; rows->further && i < found; i++) {
        take_last_word(&rest);
    }
    for (size_t i = 0; i < tail + rows->lead; i++) {
        cells[tail ? tail - 1 - i : i] = tail ? take_last_word(&rest) : take_word(&rest);
    }
    read_numbers(job, out, cells, tail + rows->lead, rows);
    out->underscores = rows->underscores;
    if (rows->two_names && !text_starts(rest, "\"")) {
        out->abbreviation = take_word(&rest);
    } else if (rows->number_last) {
        struct text name = take_last_word(&rest);
        out->abbreviation = rest;
        rest = name;
    } else if (rows->columns) {
        rest = part_of(row, COLUMN);
    } else if (rows->coded || (rows->own && shape_of(row).words == 2 && ends_in_own_number(row))) {
        take_last_word(&rest);
    }
    rest = text_trim(rest);
    out->name = unquote(rest, rows->is_plain);
    if (!rows->quoted && out->name.size == rest.size &&
        text_starts(rest, "\"") != (rest.size && rest.data[rest.size - 1] == '"')) {
        job_bad(job, "a quotation mark is not closed");
    } else if (rows->quoted && out->name.size == rest.size) {
        job_bad(job, "no name in quotation marks after IDX R G B A VIS MSH");
    } else if (rows->is_plain && begins_as_colours(out->name)) {
        job_bad(job, "\"%.*s\": decimals are written with a point", TEXT_SHOW(out->name, 40));
    } else if (rows->is_plain && has_comment(out->name)) {
        job_bad(job, "\"%.*s\": is what follows '#' a comment, or part of the name? Leave it out, or the spaces",
                TEXT_SHOW(out->name, 60));
    } else if (rows->is_plain && begins_with_mark(out->name)) {
        job_bad(job, "\"%.*s\": what stands between number and name is no part of the name: leave it out",
                TEXT_SHOW(out->name, 40));
    }
}

/* In a short list, "1 Area 17 / 2 Crus 1", numbers may differ and yet belong to the names; of rows that end in their
 * own number, "113 Vermis_1_2 113" among "1 Precentral_L", three are enough. */
enum { CODED_ROWS = 8, OWN_ROWS = 3 };

/* Whether all names, of two at least, end in a colour that is one word: "Caudate #ff8000", "Caudate 255,128,0"; not
 * "S1 3,1,2" and "Broca 44,45,47", of which none has a fraction or three digits. */
static bool end_in_colours(struct text text)
{
    size_t rows = 0;
    bool all = true;
    bool has_colour = false;
    for (struct row row = {0}; all && next_row(&text, &row); rows++) {
        struct text rest = row.rest;
        const struct text word = take_last_word(&rest);
        size_t commas = 0;
        size_t digits = 0;
        for (size_t i = 0; i < word.size; i++) {
            commas += word.data[i] == ',';
            digits = strchr("0123456789", word.data[i]) ? digits + 1 : 0;
            has_colour = has_colour || digits == 3 || strchr("#.", word.data[i]);
        }
        all = rest.size && (commas == 2 ? text_has_only(word, "0123456789.,()")
                                        : text_starts(word, "#") && word.size == 7 &&
                                              text_has_only(word, "#0123456789abcdefABCDEF"));
    }
    return all && has_colour && rows > 1;
}

/* Whether most names have three numbers or more between words: "Caudate 1 2 3 255 hidden", colours that end no row. */
static bool have_numbers_inside(struct text text)
{
    size_t rows = 0;
    size_t count = 0;
    for (struct row row = {0}; next_row(&text, &row); rows++) {
        struct text rest = row.rest;
        size_t run = 0;
        bool inside = false;
        for (struct text word; text_word(&rest, &word);) {
            inside = inside || (run >= 3 && !looks_numeric(word));
            run = looks_numeric(word) ? run + 1 : 0;
        }
        count += inside;
    }
    return 2 * count > rows;
}

void label_rows_parse(struct job *job, struct label_table *out, struct text text, const struct label_rows *format)
{
    const struct label_census census = label_rows_count(text);
    const size_t count = census.rows;
    struct label_rows rows = *format;
    size_t tail = rows.colours_last ? census.with_alpha ? 4 : 3 : 0;
    struct row row = {0};
    if (skip_heading(&text, &row)) {
        job_note(job, "label table: line %zu is taken for the names of the columns: \"%.*s\"", row.line,
                 TEXT_SHOW(row.all, 60));
    }
    rows.coded = rows.is_plain && census.coded == count && count >= CODED_ROWS && !census.tabbed &&
                 words_differ(job, text, count, FIRST_WORD) && words_differ(job, text, count, LAST_WORD);
    rows.own = rows.is_plain && !rows.coded && census.own >= OWN_ROWS && census.own == census.coded &&
               words_differ(job, text, count, NAME);
    rows.columns = rows.is_plain && !rows.coded && !rows.own && has_columns_of_numbers(job, text, count);
    rows.two_names = rows.two_names && words_differ(job, text, count, FIRST_WORD);
    if (rows.is_plain && count > 1 && have_numbers_inside(text)) {
        job_bad(job, "names have three numbers or more before their last word: colours stand behind names, and "
                     "nothing behind them");
    }
    if (rows.is_plain && end_in_colours(text)) {
        job_bad(job, "colours behind names are one word: R G B, or a header row, is needed");
    }
    rows.further = tail == 4 && has_further_numbers(job, text, count);
    if (rows.columns) {
        job_note(job, "label table: numbers in columns behind the name are passed over");
    }
    if (rows.own) {
        job_note(job, "label table: %zu of %zu rows have the label's number behind the name, too: it is left out",
                 census.own, count);
    }
    while (job_ok(job) && next_row(&text, &row)) {
        struct label_row entry = {0};
        const struct text above = row.all;
        if (rows.name_above && !next_row(&text, &row)) {
            break;
        }
        size_t place = job_in(job, "line ", row.line);
        row.rest = rows.number_last ? row.all : row.rest;
        entry.label.number = label_cell_number(job, rows.number_last ? take_last_word(&row.rest) : row.first);
        read_row(job, &entry, &row, &rows, tail);
        entry.name = rows.name_above ? above : rows.unnamed ? (struct text){0} : entry.name;
        job_out(job, place);
        labels_keep(job, out, &entry);
    }
}

bool label_rows_are(const struct label_text *text, const struct label_rows *rows)
{
    const size_t count = text->census->of[rows->shape];
    struct text rest = text->text;
    struct text line;
    bool says = !rows->says || (text_line(&rest, &line) && text_starts(line, "#") && text_mentions(line, rows->says));
    return says && (rows->everywhere ? count && count == text->census->rows : count > text->census->rows / 2);
}
