/* SPDX-License-Identifier: BSD-3-Clause */
/* Decides what separates the cells of a table, takes lines to pieces, and reads numbers. */
#include "base/formats/table.h"

#include <math.h>

static const char marks[TABLE_SEPARATORS] = {'\t', ';', '|', ',', ' ', ' '};

static struct text behind(struct text text, size_t size)
{
    return (struct text){text.data + size, text.size - size};
}

static bool is_visible(char c)
{
    return c > ' ' && !(c & 0x80);
}

struct text table_trim(struct text text)
{
    if (text.size && is_visible(text.data[0]) && is_visible(text.data[text.size - 1])) { /* as most cells */
        return text;
    }
    text = text_trim(text);
    while (text.size && (unsigned char)text.data[0] >= 0x80 && text_blank(text)) {
        text = text_trim(behind(text, text_blank(text)));
    }
    for (size_t size = 2; size <= 3 && text.size >= size && (unsigned char)text.data[text.size - 1] >= 0x80;) {
        bool is_blank = text_blank(behind(text, text.size - size)) == size; /* of the last character */
        text.size -= is_blank ? size : 0;
        text = is_blank ? text_trim(text) : text;
        size = is_blank ? 2 : size + 1;
    }
    return text;
}

bool table_is_comment(struct text *inside, struct text line)
{
    *inside = line;
    if (line.size && is_visible(line.data[0]) && !strchr("#%/", line.data[0])) {
        return false; /* most lines */
    }
    struct text rest = text_trim(line);
    bool is_one = rest.size && (rest.data[0] == '#' || rest.data[0] == '%');
    if (!is_one && !text_starts(rest, "//")) {
        return false;
    }
    size_t begin = (size_t)(rest.data - line.data);
    while (begin < line.size && strchr("#%/ ", line.data[begin])) {
        begin++;
    }
    *inside = behind(line, begin); /* tabs at the end are cells */
    return true;
}

static bool is_separator_line(struct text line, char *mark)
{
    bool is = line.size == sizeof "sep=;" - 1 && text_equal_ignoring_case((struct text){line.data, 4}, "sep=");
    *mark = is ? line.data[4] : 0;
    return is;
}

bool table_is_blank(struct text line)
{
    char mark;
    line = table_trim(line);
    return text_has_only(line, ",;|\t -=_+:*~") || is_separator_line(line, &mark);
}

bool table_next_line(struct text *rest, struct text *line, size_t *number)
{
    struct text inside;
    bool found = false;
    while (!found && text_line(rest, line)) {
        found = !table_is_blank(*line) && !table_is_comment(&inside, *line);
        *(number ? number : &(size_t){0}) += 1;
    }
    return found;
}

/* Takes the next cell between runs of white space, of two blanks or more. */
static bool next_apart(struct text *rest, struct text *cell)
{
    *rest = text_trim(*rest);
    size_t size = 0;
    while (size < rest->size && rest->data[size] != '\t' &&
           !(rest->data[size] == ' ' && size + 1 < rest->size && strchr(" \t", rest->data[size + 1]))) {
        size++;
    }
    *cell = text_trim((struct text){rest->data, size});
    *rest = behind(*rest, size);
    return size > 0;
}

/* text_word() that no-break and thin spaces end, too. */
static bool next_word(struct text *rest, struct text *word)
{
    struct text whole = *rest = table_trim(*rest);
    bool found = text_word(rest, word);
    for (size_t i = 1; i < word->size; i++) {
        if ((unsigned char)word->data[i] >= 0x80 && text_blank(behind(*word, i))) {
            *word = (struct text){word->data, i};
            *rest = behind(whole, i);
        }
    }
    return found;
}

static bool next_cell(struct text *rest, bool *more, struct text *cell, enum text_quotes *quotes,
                      const struct table *table)
{
    *quotes = TEXT_PLAIN;
    if (table->separator == TABLE_BLANKS) {
        return next_apart(rest, cell);
    }
    char mark = marks[table->separator];
    if (table->separator == TABLE_SPACES) {
        *rest = text_trim(*rest);
        if (!rest->size || rest->data[0] != '"' || table->quotes_are_plain) {
            return next_word(rest, cell);
        }
        bool goes_on = true;
        return text_quoted_field(rest, mark, &goes_on, cell, quotes);
    }
    bool found = table->quotes_are_plain ? text_field(rest, mark, more, cell)
                                         : text_quoted_field(rest, mark, more, cell, quotes);
    return found;
}

bool table_split(struct table_line *out, const struct table *table, struct text line)
{
    struct text cell;
    enum text_quotes quotes;
    out->count = out->given = 0;
    out->spoilt = (struct text){0};
    if (table->separator == TABLE_PIPES) {
        line = text_trim(line);
        line = line.size && line.data[0] == '|' ? behind(line, 1) : line;
        line.size -= line.size && line.data[line.size - 1] == '|';
    }
    bool has_text = table->separator == TABLE_TABS || table->separator == TABLE_BLANKS ||
                    table->separator == TABLE_SPACES || table->quotes_are_plain; /* with a mark in its middle */
    for (bool more = true; next_cell(&line, &more, &cell, &quotes, table);) {
        if (out->count == TABLE_CELLS) {
            return false;
        }
        cell = table_trim(cell);
        bool is_stray = quotes == TEXT_FOLLOWED ||
                        (quotes == TEXT_PLAIN && !has_text && cell.size && memchr(cell.data, '"', cell.size));
        if (!out->spoilt.data && (is_stray || quotes == TEXT_UNCLOSED)) {
            out->spoilt = cell;
            out->is_unclosed = quotes == TEXT_UNCLOSED;
        }
        out->cells[out->count++] = cell;
        out->given = cell.size ? out->count : out->given;
    }
    return true;
}

/* How many bytes are a whole number in groups of three digits with points between, two groups or more: "42.000". */
static size_t grouped_by_points(struct text cell)
{
    size_t minus = text_minus(cell);
    size_t sign = minus ? minus : text_starts(cell, "+");
    size_t first = text_digits(cell, sign);
    size_t at = sign + first;
    while (first >= 1 && first <= 3 && at < cell.size && cell.data[at] == '.' && text_digits(cell, at + 1) == 3) {
        at += 4;
    }
    return at > sign + first && cell.data[sign] != '0' ? at : 0;
}

/* What the commas of a cell that is a number by them say of themselves; TABLE_COMMA_UNKNOWN without one or of others.
 */
static enum table_comma comma_of(struct text cell)
{
    size_t points = grouped_by_points(cell);
    if (points && points < cell.size && cell.data[points] == ',') {
        return text_digits(cell, points + 1) && points + 1 + text_digits(cell, points + 1) == cell.size
                   ? TABLE_COMMA_DECIMAL
                   : TABLE_COMMA_UNKNOWN;
    }
    size_t minus = text_minus(cell);
    cell = behind(cell, minus ? minus : text_starts(cell, "+"));
    const char *comma = cell.size ? memchr(cell.data, ',', cell.size) : NULL;
    size_t first = text_digits(cell, 0);
    if (!comma || cell.data + first != comma) {
        return TABLE_COMMA_UNKNOWN;
    }
    size_t groups = 0;
    size_t at = first;
    while (at < cell.size && cell.data[at] == ',' && text_digits(cell, at + 1) == 3) {
        at += 4;
        groups++;
    }
    bool is_grouped = groups && first >= 1 && first <= 3 && !(first == 1 && cell.data[0] == '0');
    bool has_point = at < cell.size && cell.data[at] == '.' && at + 1 + text_digits(cell, at + 1) == cell.size;
    if (is_grouped && (at == cell.size || has_point)) {
        return groups > 1 || has_point ? TABLE_COMMA_THOUSANDS : TABLE_COMMA_UNCLEAR;
    }
    size_t decimals = text_digits(cell, first + 1);
    at = first + 1 + decimals;
    bool has_exponent = at < cell.size && (cell.data[at] == 'e' || cell.data[at] == 'E');
    return decimals && (at == cell.size || has_exponent) ? TABLE_COMMA_DECIMAL : TABLE_COMMA_UNKNOWN;
}

/* Reads a number that has something else than text_to_double() knows. */
static bool read_odd_number(double *out, const struct table *table, struct text cell)
{
    char copy[64];
    size_t size = 0;
    size_t minus = text_minus(cell);
    if (minus && (text_digits(cell, minus) || (minus < cell.size && strchr(".,", cell.data[minus])))) {
        copy[size++] = '-';
        cell = behind(cell, minus);
    }
    bool has_comma = cell.size && memchr(cell.data, ',', cell.size);
    bool is_decimal = table->comma == TABLE_COMMA_DECIMAL;
    enum table_comma own = has_comma ? comma_of(cell) : TABLE_COMMA_UNKNOWN;
    bool fits = !has_comma || (is_decimal ? own == TABLE_COMMA_DECIMAL || own == TABLE_COMMA_UNCLEAR
                                          : table->comma == TABLE_COMMA_THOUSANDS &&
                                                (own == TABLE_COMMA_THOUSANDS || own == TABLE_COMMA_UNCLEAR));
    if (!fits || cell.size + size > sizeof copy) {
        return false;
    }
    for (size_t i = 0; i < cell.size; i++) {
        bool is_group = is_decimal && has_comma && cell.data[i] == '.' && grouped_by_points(cell) > i;
        if ((cell.data[i] != ',' || is_decimal) && !is_group) {
            copy[size++] = (char)(cell.data[i] == ',' ? '.' : cell.data[i]);
        }
    }
    return text_to_double((struct text){copy, size}, out);
}

bool table_number(double *out, const struct table *table, struct text cell)
{
    const bool is_decimal = table->comma == TABLE_COMMA_DECIMAL;
    if (!is_decimal && text_to_double(cell, out)) {
        return true;
    }
    const struct text own = table_trim(cell);
    bool is_unclear = is_decimal && own.size && grouped_by_points(own) == own.size;
    return !is_unclear && ((is_decimal && text_to_double(cell, out)) || read_odd_number(out, table, own));
}

/* Whether a cell is a number whatever a comma is. */
static bool is_number(struct text cell)
{
    double number;
    enum table_comma comma = cell.size && memchr(cell.data, ',', cell.size) ? comma_of(cell) : TABLE_COMMA_UNKNOWN;
    const struct table any = {.comma = comma == TABLE_COMMA_UNCLEAR ? TABLE_COMMA_DECIMAL : comma};
    return table_number(&number, &any, cell) && isfinite(number);
}

size_t table_numbers(const struct table_line *line)
{
    size_t count = 0;
    for (size_t i = 0; i < line->count; i++) {
        count += is_number(line->cells[i]);
    }
    return count;
}

/* Whether the numbers of a line show by themselves what a comma is. */
static enum table_comma join(enum table_comma a, enum table_comma b)
{
    if (a == TABLE_COMMA_UNKNOWN || b == TABLE_COMMA_UNKNOWN || a == b) {
        return a == TABLE_COMMA_UNKNOWN ? b : a;
    }
    return a == TABLE_COMMA_UNCLEAR   ? b
           : b == TABLE_COMMA_UNCLEAR ? a
                                      : TABLE_COMMA_UNCLEAR; /* they contradict each other */
}

void table_add_comma(struct table *table, struct text cell)
{
    if (cell.size && memchr(cell.data, ',', cell.size) && is_number(cell)) {
        table->comma = join(table->comma, comma_of(cell));
    }
}

enum { NUMBERS = 3 }; /* of a row, at least */

/* How many lines have the most frequent number of cells, with three numbers among them; perhaps fewer once it is sure
 * that no more than `most` have. Takes from `left`, of which there are at least as many, the lines that were read. */
static size_t count_rows(struct table *table, struct text head, size_t *left, size_t most)
{
    uint16_t rows[TABLE_CELLS + 1] = {0};
    struct table_line line;
    struct text text;
    table->cells = table->first = 0;
    for (; rows[table->cells] + *left > most && table_next_line(&head, &text, NULL); --*left) {
        if (table_split(&line, table, text) && table_numbers(&line) >= NUMBERS &&
            ++rows[line.count] > rows[table->cells]) {
            table->cells = line.count;
        }
    }
    return rows[table->cells];
}

/* The first row, and what a comma is. Of contradicting numbers one thing is known, and nothing decides any more. */
static void look_at_rows(struct table *table, struct text head)
{
    struct table_line line;
    struct text text;
    bool has_decimal = false;
    bool has_thousands = false;
    const bool has_commas = head.size && memchr(head.data, ',', head.size);
    size_t number = 0;
    while (table->cells && (has_commas || !table->first) && table_next_line(&head, &text, &number)) {
        if (!table_split(&line, table, text) || table_numbers(&line) < NUMBERS) {
            continue;
        }
        table->first = table->first || line.count != table->cells ? table->first : number;
        for (size_t i = 0; i < line.count; i++) {
            enum table_comma comma = is_number(line.cells[i]) ? comma_of(line.cells[i]) : TABLE_COMMA_UNKNOWN;
            table_add_comma(table, line.cells[i]);
            has_decimal = has_decimal || comma == TABLE_COMMA_DECIMAL;
            has_thousands = has_thousands || comma == TABLE_COMMA_THOUSANDS;
        }
    }
    table->comma = has_decimal && has_thousands ? TABLE_COMMA_UNCLEAR : table->comma;
}

void table_decide(struct table *out, struct text head)
{
    struct table best = {.separator = TABLE_TABS};
    struct text line;
    struct text rest = head;
    size_t lines = head.size; /* at most */
    size_t most = 0;
    char mark = 0;
    bool is_said = text_line(&rest, &line) && is_separator_line(text_trim(line), &mark);
    for (enum table_separator separator = 0; separator < TABLE_SEPARATORS; separator++) {
        struct table table = {.separator = separator, .quotes_are_plain = out->quotes_are_plain};
        if (is_said && (marks[separator] != mark || separator == TABLE_BLANKS)) {
            continue;
        }
        bool is_one_cell = separator < TABLE_BLANKS && lines && !memchr(head.data, marks[separator], head.size);
        size_t left = lines;
        size_t rows = is_one_cell ? 0 : count_rows(&table, head, &left, most);
        lines -= is_one_cell || most ? 0 : left;
        if (rows > most || (is_said && !most)) {
            best = table;
            most = rows;
        }
    }
    look_at_rows(&best, head);
    *out = best;
}
