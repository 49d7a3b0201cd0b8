/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses numbers in brackets: lists of points or matrices, as Python prints and stores them and MATLAB writes them;
 * JSON whose names or objects are points; and lines of "name: (x, y, z)". */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "base/formats/table.h"
#include "base/memory.h"
#include "conus/own.h"
#include "poses/rows/columns.h"
#include "poses/rows/pose_row.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

enum { MATRIX = 16, ROW = 4, KEYS = 64 };

static const struct text nameless = {"", 0};

/* What is read here becomes a table, so that columns.h judges and reads all of it alike: a header, then lines. */
static void sheet_header(struct buffer *sheet, const conus_pose_options *options, bool has_target)
{
    buffer_text(sheet, "name");
    for (size_t k = 0; k < 3; k++) {
        buffer_format(sheet, "\t%s",
                      options->space < CONUS_SPACE_CCF ? (const char *[]){"x", "y", "z"}[k]
                                                       : conus_space_axis(options->space, k));
    }
    buffer_text(sheet, has_target ? "\ttx\tty\ttz\n" : "\n");
}

/* Words in one line; of a cell in quotation marks, where there are any. */
static void sheet_words(struct buffer *sheet, struct text words, bool is_cell)
{
    const char *mark = is_cell && words.size ? "\"" : "";
    buffer_text(sheet, mark);
    for (size_t i = 0; i < words.size; i++) {
        bool is_plain = (unsigned char)words.data[i] >= ' ';
        buffer_append(sheet, is_plain ? words.data + i : " ", 1);
        buffer_text(sheet, words.data[i] == '"' ? mark : "");
    }
    buffer_text(sheet, mark);
}

/* A line of a name and so many numbers; without any it is no row. */
static void sheet_row(struct buffer *sheet, struct text name, const double *numbers, size_t count)
{
    sheet_words(sheet, name, true);
    for (size_t k = 0; k < count; k++) {
        buffer_format(sheet, "\t%.17g", numbers[k]);
    }
    buffer_text(sheet, count ? "\n" : "?\n");
}

static void sheet_comment(struct buffer *sheet, struct text words)
{
    buffer_text(sheet, "# ");
    sheet_words(sheet, words, false);
    buffer_text(sheet, "\n");
}

static void sheet_comments(struct buffer *sheet, struct text lines)
{
    struct text line;
    while (text_line(&lines, &line)) {
        sheet_comment(sheet, line);
    }
}

/* Reads the sheet, and ends it. Its second line is line 1. @p why: what is wrong with a line that is no row. */
static void sheet_read(const struct pose_reading *to, struct buffer *sheet, const char *why)
{
    struct job *job = to->job;
    struct columns columns = {0};
    conus_pose_options options = *to->options;
    bool is_short = false;
    struct text rest = {sheet->data, sheet->size};
    struct text line;
    size_t number = 0;
    size_t absent = 0;
    size_t first_absent = 0;
    options.keep_count = 0;
    options.format = NULL;
    (void)JOB_CALL(job, buffer_status(sheet));
    columns_plan(job, &columns, &is_short, rest, &options);
    columns_check_name(job, &columns, to->path, rest, &options, to->list->space.name[0]);
    if (job_ok(job) && !to->list->space.name[0]) {
        to->list->space = columns_space(&columns);
    }
    while (job_ok(job) && table_next_line(&rest, &line, &number)) {
        conus_pose_row row = pose_row_at(number - 1);
        struct pose_name name = {.text = {"", 0}};
        conus_status bad = CONUS_OK;
        if (number == 1) {
            continue;
        }
        enum columns_line kind = columns_read(&row, &name, &bad, &columns, line, number, &options);
        row.line = number - 1;
        first_absent = kind == LINE_ABSENT && !absent++ ? row.line : first_absent;
        if (kind != LINE_ABSENT) {
            pose_add(to, &row, name.text, kind != LINE_ROW ? why : bad ? conus_message() : NULL);
        }
    }
    if (absent && !to->list->count) {
        job_bad(job, "no poses: it has only %zu rows without coordinates (n/a)", absent);
    }
    pose_note_absent(job, absent, first_absent);
    buffer_finish(sheet);
}

struct text pose_brackets_behind_comments(struct text text)
{
    struct text rest = text;
    struct text line;
    struct text inside;
    while (text_line(&rest, &line) && (!text_trim(line).size || table_is_comment(&inside, line))) {
        text = rest;
    }
    return text_trim(text);
}

/* Behind "NAME =" and white space, the first bracket; an empty text where there is none. */
static struct text opened(struct text text)
{
    static const char name[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    struct text rest = pose_brackets_behind_comments(text);
    const char *equals = rest.size ? memchr(rest.data, '=', rest.size) : NULL;
    struct text before = {rest.data, equals ? (size_t)(equals - rest.data) : 0};
    if (equals && text_has_only(text_trim(before), name)) {
        rest = text_trim((struct text){equals + 1, rest.size - before.size - 1});
    }
    return rest.size && rest.data[0] == '[' ? rest : (struct text){"", 0};
}

static bool begins_in_brackets(struct text text)
{
    struct text rest = opened(text);
    while (rest.size && memchr("[ \t\r\n", rest.data[0], 5)) {
        rest = (struct text){rest.data + 1, rest.size - 1};
    }
    return rest.size && memchr("+-.0123456789", rest.data[0], 13);
}

struct reading {
    struct job *job;
    const struct pose_reading *to;
    double numbers[MATRIX];
    size_t count, width; /* numbers of this row; of each, 0 = not known yet */
    size_t rows;
    conus_space space; /* of matrices, */
    const char *why_no_matrix;
    struct buffer sheet; /* of points */
    struct buffer comments;
};

/* Three numbers are a point; four rows of four a matrix. */
static void end_row(struct reading *reading)
{
    size_t width = reading->width == ROW ? reading->count - ROW * (reading->rows % ROW) : reading->count;
    if (width == 0) { /* brackets around rows */
        return;
    }
    if ((width != 3 && width != ROW) || (reading->width && width != reading->width)) {
        job_bad(reading->job, "row %zu in brackets has %zu numbers; points have three, matrices four rows of four",
                reading->rows + 1, width);
        return;
    }
    reading->width = width;
    reading->rows++;
    if (width == 3) {
        sheet_row(&reading->sheet, nameless, reading->numbers, 3);
        reading->count = 0;
    } else if (reading->rows % ROW == 0) {
        conus_pose_row row = pose_row_at(reading->rows / ROW);
        double m[MATRIX];
        for (size_t i = 0; i < MATRIX; i++) {
            m[i] = reading->numbers[4 * (i % 4) + i / 4];
        }
        conus_status bad = pose_of_matrix(&row.pose, m, reading->space == CONUS_SPACE_LPS, reading->to->options->axis);
        pose_add(reading->to, &row, text_from(""), bad ? conus_message() : NULL);
        reading->count = 0;
    }
}

static void add_number(struct reading *reading, struct text word)
{
    double number;
    if (text_find(word, "...")) {
        job_bad(reading->job, "\"...\" in brackets: what was printed is not all of it; save it as a file "
                              "(numpy.savetxt, writematrix)");
    } else if (!text_to_double(word, &number) || !isfinite(number)) {
        job_bad(reading->job, "\"%.*s\" in brackets is no number", POSE_QUOTE(word));
    } else if (reading->count == MATRIX) {
        job_bad(reading->job,
                "a row in brackets of more than 16 numbers; points have three, matrices four rows of four");
    } else {
        reading->numbers[reading->count++] = number;
    }
}

/* A row ends at its own bracket, or in the only one at a semicolon or the line's end. */
static void parse_numbers(struct reading *reading, struct text text)
{
    static const char marks[] = "[] \t\r\n,;";
    size_t depth = 0;
    for (size_t at = 0; job_ok(reading->job) && at < text.size;) {
        const char c = text.data[at];
        size_t size = 0;
        if (c == '#' || c == '%') { /* to the line's end; read by hear_around() */
            while (at < text.size && text.data[at] != '\n') {
                at++;
            }
            continue;
        }
        while (at + size < text.size && !memchr(marks, text.data[at + size], sizeof marks - 1)) {
            size++;
        }
        const struct text word = {text.data + at, size};
        if (size && depth) {
            add_number(reading, word);
        } else if (size) {
            job_bad(reading->job, "\"%.*s\" behind the brackets: write one list, [x y z; x y z]", POSE_QUOTE(word));
        } else if (c == ']' && !depth) {
            job_bad(reading->job, "a bracket ] that was not opened");
        } else if (c == ']' || (depth == 1 && (c == ';' || c == '\n'))) {
            end_row(reading);
        }
        depth = c == '[' ? depth + 1 : c == ']' && depth ? depth - 1 : depth;
        at += size ? size : 1;
    }
    if (depth || reading->count) {
        job_bad(reading->job, depth ? "a bracket [ that is not closed" : "the last matrix is not whole");
    }
}

/* Takes the comments of a text in brackets, and the words of the name that it gives them: "tal = [", "pts_lps = [". */
static void find_comments(struct buffer *comments, struct text text, struct text numbers)
{
    struct text name = {text.data, (size_t)(numbers.data - text.data)};
    struct text line;
    while (text_line(&text, &line)) {
        const char *mark = NULL;
        for (size_t i = 0; i < line.size && !mark; i++) {
            mark = memchr("#%", line.data[i], 2) || text_starts((struct text){line.data + i, line.size - i}, "//")
                       ? line.data + i
                       : NULL;
        }
        if (mark) {
            sheet_comment(comments, (struct text){mark + 1, (size_t)(line.data + line.size - mark) - 1});
        }
    }
    name = pose_brackets_behind_comments(name);
    sheet_comment(comments, name);
    for (size_t i = 0, size; i < name.size; i += size + 1) {
        size = 0;
        while (i + size < name.size && !memchr("_ =0123456789\t\r\n", name.data[i + size], 16)) {
            size++;
        }
        const struct text word = {name.data + i, size};
        if (text_is_one_of(word, "ras/lps/vox/voxel/voxels/ijk/native/scanner/tal/mni/cm/mm/um", false)) {
            buffer_format(comments, "# coordinates in %.*s\n", (int)word.size, word.data);
        }
    }
}

/* What is said of matrices, which cannot be brought to another unit. */
static void hear_of_matrices(struct reading *reading, struct text comments)
{
    const conus_pose_options *options = reading->to->options;
    struct space_words said = {0};
    struct text line;
    while (!options->any_space && text_line(&comments, &line)) {
        space_words_hear(&said, line);
    }
    if (options->columns || (options->unit > 0 && options->unit != 1)) {
        reading->why_no_matrix = "matrices in brackets are in mm: no words behind FILE or other unit fit them";
    } else if (said.why || said.are_two || (said.mm > 0 && said.mm != 1)) {
        reading->why_no_matrix =
            job_format(reading->job, "matrices in brackets that are said to be \"%s\": RAS or LPS mm are needed",
                       said.heard[0] ? said.heard : "in another unit than mm");
    }
    reading->to->list->space = said.space;
    reading->space = said.has_signs ? said.signs : options->space;
}

static void parse_list(const struct pose_reading *to, struct text text)
{
    struct reading reading = {.job = to->job, .to = to};
    struct text numbers = opened(text);
    find_comments(&reading.comments, text, numbers);
    sheet_header(&reading.sheet, to->options, false);
    if (JOB_CALL(to->job, buffer_status(&reading.comments))) {
        hear_of_matrices(&reading, (struct text){reading.comments.data, reading.comments.size});
    }
    parse_numbers(&reading, numbers);
    if (reading.width == 3) {
        to->list->space = (struct pose_space){0};
        buffer_append(&reading.sheet, reading.comments.data, reading.comments.size);
        sheet_read(to, &reading.sheet, "three numbers are needed");
    } else if (reading.why_no_matrix) {
        job_bad(to->job, "%s", reading.why_no_matrix);
    }
    buffer_finish(&reading.sheet);
    buffer_finish(&reading.comments);
}

/* Three numbers, with commas, semicolons or white space between them. */
static bool read_three(double point[3], struct text inside)
{
    const struct table plain = {0};
    const char mark = memchr(inside.data, ';', inside.size) ? ';' : memchr(inside.data, ',', inside.size) ? ',' : 0;
    struct text word;
    size_t count = 0;
    bool fine = true;
    for (bool more = true; fine && (mark ? text_field(&inside, mark, &more, &word) : text_word(&inside, &word));
         count++) {
        size_t k = count < 3 ? count : 2;
        fine = count < 3 && table_number(&point[k], &plain, table_trim(word)) && isfinite(point[k]);
    }
    return fine && count == 3;
}

/* "(x, y, z)" at the begin of @p rest, which is what is behind it then. */
static bool take_triple(double point[3], struct text *rest)
{
    const char *end = rest->size && rest->data[0] == '(' ? memchr(rest->data, ')', rest->size) : NULL;
    struct text inside = end ? (struct text){rest->data + 1, (size_t)(end - rest->data) - 1} : (struct text){"", 0};
    *rest = end ? table_trim((struct text){end + 1, rest->size - (size_t)(end + 1 - rest->data)}) : *rest;
    return end && read_three(point, inside);
}

/* A line "name: (x, y, z)", "(x, y, z) name" or "(x, y, z) -> (x, y, z)", from entry to target. */
struct spoken {
    struct text name;
    double numbers[6];
    size_t count; /* of them: 3, or 6 with a target */
};

static bool read_spoken(struct spoken *out, struct text line)
{
    const char *open = memchr(line.data, '(', line.size);
    const size_t skipped = open ? (size_t)(open - line.data) : line.size;
    struct text before = table_trim((struct text){line.data, open ? skipped : 0});
    struct text rest = {line.data + skipped, line.size - skipped};
    *out = (struct spoken){.name = nameless, .count = 3};
    if (!take_triple(out->numbers, &rest)) {
        return false;
    }
    const size_t arrow = text_starts(rest, "->") ? 2 : text_starts(rest, "\xe2\x86\x92") ? 3 : 0;
    if (arrow) {
        rest = table_trim((struct text){rest.data + arrow, rest.size - arrow});
        out->count = take_triple(out->numbers + 3, &rest) ? 6 : 3;
    }
    bool is_mark = before.size && memchr(":=", before.data[before.size - 1], 2);
    before.size -= is_mark;
    before = table_trim(before);
    double number;
    struct text first = rest;
    struct text word = {"", 0};
    (void)text_word(&first, &word);
    bool is_name = rest.size && !text_to_double(word, &number) && !memchr(rest.data, '(', rest.size) &&
                   !memchr(",;\t", rest.data[0], 3);
    out->name = before.size ? before : rest;
    return (!arrow || out->count == 6) && (!rest.size || (!before.size && is_name)) &&
           (!before.size || !memchr(before.data, '"', before.size));
}

static bool is_spoken(struct text text)
{
    struct text line;
    struct spoken spoken;
    return table_next_line(&text, &line, NULL) && read_spoken(&spoken, line);
}

bool pose_brackets_are_rows(struct text text)
{
    return begins_in_brackets(text) || is_spoken(text);
}

/* A table with the three coordinates in one cell: "(-42, -20, 50)". */
struct cells {
    struct table table;
    size_t at, name; /* columns of the positions and of the names, SIZE_MAX = no names */
    size_t count;    /* columns that could be the positions */
    struct text called;
    size_t headers; /* lines of it */
};

static bool cell_point(double point[3], struct text cell)
{
    bool is_open = cell.size > 1 && memchr("([", cell.data[0], 2) && memchr(")]", cell.data[cell.size - 1], 2);
    return read_three(point, is_open ? (struct text){cell.data + 1, cell.size - 2} : cell);
}

static bool is_called_coordinates(struct text name)
{
    return text_contains(name, text_from("coord")) || text_contains(name, text_from("x, y, z")) ||
           text_contains(name, text_from("x,y,z"));
}

/* Looks at the header, of one line or two (SPM), and the first row: the row has fewer than three bare numbers, unless
 * the header calls the column coordinates. */
static bool find_cells(struct cells *out, struct text head)
{
    enum { HEADERS = 2 };
    struct table_line names;
    struct table_line row;
    struct text rest = head;
    struct text line;
    struct text above = {"", 0};
    struct table_line first;
    bool has_both = table_next_line(&rest, &above, NULL);
    const struct text top = above;
    for (size_t header = 0; has_both && header < HEADERS; header++, above = line) {
        has_both = table_next_line(&rest, &line, NULL);
        for (enum table_separator mark = TABLE_TABS; has_both && mark <= TABLE_COMMAS; mark++) {
            *out = (struct cells){.table.separator = mark, .at = SIZE_MAX, .name = SIZE_MAX, .headers = header + 1};
            bool fits = table_split(&names, &out->table, above) && table_split(&row, &out->table, line) &&
                        names.count == row.count && row.count > 1;
            bool is_bare = fits && table_numbers(&row) < 3;
            for (size_t i = 0; fits && i < row.count; i++) {
                double point[3];
                double number;
                bool is_called = is_called_coordinates(names.cells[i]);
                if (cell_point(point, row.cells[i]) && !cell_point(point, names.cells[i]) && (is_bare || is_called)) {
                    out->at = i;
                    out->called = names.cells[i];
                    out->count++;
                } else if (out->name == SIZE_MAX && row.cells[i].size && !text_to_double(row.cells[i], &number)) {
                    out->name = i;
                }
            }
            /* The second line is one more header where it says so, or the first is a title, else a row. */
            if (out->count && header && !is_called_coordinates(out->called) && table_split(&first, &out->table, top) &&
                first.count == row.count) {
                out->called = first.cells[out->at];
                out->headers = 1;
            }
            if (out->count) {
                return true;
            }
        }
    }
    return false;
}

bool pose_brackets_in_cells(struct text head)
{
    struct cells cells;
    return find_cells(&cells, head);
}

static bool read_cells(struct spoken *out, const struct cells *cells, struct text line)
{
    struct table_line row;
    bool fits = table_split(&row, &cells->table, line) && cells->at < row.count;
    *out = (struct spoken){.name = nameless, .count = 3};
    out->name = fits && cells->name < row.count ? row.cells[cells->name] : nameless;
    return fits && cell_point(out->numbers, row.cells[cells->at]);
}

/* Whether a name says another order than x, y, z: "(z y x)", "zyx". */
static bool is_other_order(struct text name)
{
    char letters[4] = "";
    size_t count = 0;
    for (size_t i = 0; i < name.size; i++) {
        size_t size = 0;
        while (i + size < name.size && isalpha((unsigned char)name.data[i + size])) {
            size++;
        }
        bool is_one = (size == 1 || size == 3) && text_has_only((struct text){name.data + i, size}, "xyzXYZ");
        for (size_t k = 0; is_one && k < size && count < 3; k++) {
            letters[count++] = (char)tolower((unsigned char)name.data[i + k]);
        }
        i += size;
    }
    return count == 3 && strcmp(letters, "xyz") != 0;
}

/* Lines that are spoken, or, of a table, have a cell of three numbers. */
static void parse_lines(const struct pose_reading *to, struct text text)
{
    struct buffer sheet = {0};
    struct cells cells;
    struct spoken spoken;
    struct text line;
    struct text inside;
    struct text rest = text;
    const bool is_table = !is_spoken(text);
    bool has_target = false;
    if (is_table && (!find_cells(&cells, text) || cells.count != 1)) {
        job_bad(to->job, "several columns with three numbers in a cell: which are the positions? Take the others out");
        return;
    }
    if (is_table && is_other_order(cells.called)) {
        job_bad(to->job, "column \"%.*s\": another order than x, y, z: put them into columns of their own",
                POSE_QUOTE(cells.called));
    }
    while (!is_table && !has_target && table_next_line(&rest, &line, NULL)) {
        has_target = read_spoken(&spoken, line) && spoken.count == 6;
    }
    sheet_header(&sheet, to->options, has_target);
    for (size_t above = is_table ? cells.headers : 0; text_line(&text, &line);) {
        bool is_blank = table_is_blank(line);
        bool is_comment = table_is_comment(&inside, line);
        if (is_comment || (!is_blank && above)) {
            above -= !is_blank && !is_comment;
            sheet_comment(&sheet, inside);
        } else if (is_blank) {
            buffer_text(&sheet, "\n");
        } else {
            bool is_row = is_table ? read_cells(&spoken, &cells, line) : read_spoken(&spoken, line);
            sheet_row(&sheet, is_row ? spoken.name : nameless, spoken.numbers, is_row ? spoken.count : 0);
        }
    }
    sheet_read(to, &sheet,
               is_table ? "no cell of three numbers"
                        : "not as the first line: (x, y, z) and a name, or (x, y, z) -> (x, y, z)");
}

enum pose_brackets pose_brackets_json(json_t *root)
{
    bool all = json_object_size(root) > 0;
    double point[3];
    const char *key;
    json_t *value;
    if (text_equal(json_text_of(json_object_get(root, "data_type")), "fs_pointset")) {
        return BRACKETS_FREEVIEW;
    }
    json_object_foreach(root, key, value)
    {
        all = all && json_numbers(point, 3, value);
    }
    return all ? BRACKETS_NAMES : BRACKETS_NONE;
}

static void set_freeview_space(const struct pose_reading *to, const json_t *root)
{
    struct text system = json_text_of(json_object_get(root, "vox2ras"));
    bool is_scanner = text_equal(system, "scanner_ras");
    to->list->space = is_scanner ? pose_space_named(text_from("FreeSurfer scanner RAS"), POSE_BRAIN_SUBJECT)
                                 : pose_space_named(text_from("FreeSurfer tkRAS"), POSE_BRAIN_OTHER);
    if (!is_scanner && !text_equal(system, "tkreg")) {
        job_bad(to->job, "vox2ras \"%.*s\", allowed are scanner_ras and tkreg", POSE_QUOTE(system));
    }
}

/* The names of objects' values, in the order in which they come first. */
struct keys {
    const char *at[KEYS];
    size_t count;
};

static bool is_unit(const char *key)
{
    return text_is_one_of(text_from(key), "unit/units", false);
}

static void find_keys(struct job *job, struct keys *keys, json_t *object)
{
    const char *key;
    json_t *value;
    json_object_foreach(object, key, value)
    {
        size_t i = 0;
        while (i < keys->count && strcmp(keys->at[i], key) != 0) {
            i++;
        }
        if (i < keys->count || is_unit(key) || (json_is_object(value) && strcmp(key, "coordinates") == 0)) {
            continue;
        }
        if (i == KEYS) {
            job_bad(job, "objects with more than %d keys", KEYS);
            return;
        }
        keys->at[keys->count++] = key;
    }
}

static void hear_unit_key(struct job *job, struct buffer *comments, json_t *object)
{
    const char *key;
    json_t *value;
    json_object_foreach(object, key, value)
    {
        struct text unit = json_text_of(value);
        struct space_words said = {0};
        if (!is_unit(key)) {
            continue;
        }
        space_words_hear_of(&said, unit);
        if (!(said.mm > 0) || said.are_two) {
            job_bad(job, "\"%s\" is \"%.*s\", allowed are mm, um, cm and m", key, POSE_QUOTE(unit));
        }
        buffer_format(comments, "# unit %.*s\n", (int)unit.size, unit.data);
    }
}

static void sheet_value(struct buffer *sheet, const json_t *value)
{
    if (json_is_integer(value)) {
        buffer_format(sheet, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    } else if (json_is_real(value)) {
        buffer_format(sheet, "%.17g", json_real_value(value));
    } else if (json_is_boolean(value)) {
        buffer_text(sheet, json_is_true(value) ? "1" : "0");
    } else if (json_is_string(value)) {
        sheet_words(sheet, json_text_of(value), true);
    } else if (value && !json_is_null(value)) {
        buffer_text(sheet, "list");
    }
}

/* [{"name": "M1", "x": 1, "y": 2, "z": 3}]: each is a row, its keys are columns, those of "coordinates" among them. */
static void parse_objects(const struct pose_reading *to, json_t *objects, bool is_freeview, struct text above)
{
    struct job *job = to->job;
    struct keys keys = {0};
    struct buffer sheet = {0};
    struct buffer comments = {0};
    sheet_comments(&comments, above);
    for (size_t i = 0; job_ok(job) && i < json_array_size(objects); i++) {
        json_t *object = json_array_get(objects, i);
        json_t *inner = json_object_get(object, "coordinates");
        find_keys(job, &keys, inner);
        hear_unit_key(job, &comments, inner);
        if (!is_freeview || !inner) {
            find_keys(job, &keys, object);
        }
        if (!is_freeview) {
            hear_unit_key(job, &comments, object);
        }
    }
    for (size_t k = 0; k < keys.count; k++) {
        buffer_text(&sheet, k ? "\t" : "");
        sheet_words(&sheet, text_from(keys.at[k]), true);
    }
    buffer_text(&sheet, "\n");
    for (size_t i = 0; job_ok(job) && i < json_array_size(objects); i++) {
        json_t *object = json_array_get(objects, i);
        json_t *inner = json_object_get(object, "coordinates");
        size_t empty = sheet.size;
        for (size_t k = 0; k < keys.count; k++) {
            const json_t *value = json_object_get(inner, keys.at[k]);
            buffer_text(&sheet, k ? "\t" : "");
            sheet_value(&sheet, value ? value : json_object_get(object, keys.at[k]));
        }
        buffer_text(&sheet, sheet.size == empty + keys.count - 1 || !keys.count ? "?\n" : "\n");
    }
    buffer_append(&sheet, comments.data, comments.size);
    if (json_array_size(objects) && JOB_CALL(job, buffer_status(&comments))) {
        sheet_read(to, &sheet, "the numbers x, y and z are needed");
    }
    buffer_finish(&sheet);
    buffer_finish(&comments);
}

/* {"M1": [1, 2, 3]} */
static void parse_map(const struct pose_reading *to, json_t *root, struct text above)
{
    struct buffer sheet = {0};
    const char *key;
    json_t *value;
    sheet_header(&sheet, to->options, false);
    json_object_foreach(root, key, value)
    {
        double point[3] = {0};
        bool is_row = json_numbers(point, 3, value);
        if (text_is_one_of(text_from(key), "x/y/z", false)) { /* of three points, by columns */
            job_bad(to->job, "the names x, y and z: a table on its side; save it by rows (orient=\"records\")");
        }
        sheet_row(&sheet, is_row ? text_from(key) : nameless, point, is_row ? 3 : 0);
    }
    sheet_comments(&sheet, above);
    sheet_read(to, &sheet, "three numbers are needed");
}

void pose_brackets_parse(struct pose_reading *to, struct text text)
{
    if (begins_in_brackets(text)) {
        parse_list(to, text);
        return;
    }
    if (is_spoken(text) || pose_brackets_in_cells(text)) {
        parse_lines(to, text);
        return;
    }
    const struct text json = pose_brackets_behind_comments(text);
    const struct text above = {text.data, (size_t)(json.data - text.data)};
    json_t *root = pose_json(to, json);
    if (pose_brackets_json(root) == BRACKETS_FREEVIEW) {
        set_freeview_space(to, root);
        parse_objects(to, json_object_get(root, "points"), true, above);
    } else if (json_is_object(root)) {
        parse_map(to, root, above);
    } else {
        parse_objects(to, root, false, above);
    }
}
