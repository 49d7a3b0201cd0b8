/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a line of a table whose columns are known; makes an axis of two rows. */
#include "base/geometry/math3.h"
#include "base/order.h"
#include "base/status.h"
#include "conus/own.h"
#include "poses/rows/columns.h"
#include "poses/rows/columns_head.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>
#include <string.h>

double columns_space_mm(conus_space space)
{
    return space == CONUS_SPACE_CCF ? 0.001 : 1;
}

bool columns_is_absent(struct text cell)
{
    enum { LONGEST = sizeof "none" - 1 };
    return !cell.size || (cell.size <= LONGEST &&
                          (text_equal_ignoring_case(cell, "n/a") || text_is_one_of(cell, "NA/none/-/--", false)));
}

struct text columns_cell(const struct head *head, size_t row, size_t column)
{
    return column < head->rows[row].count ? head->rows[row].cells[column] : (struct text){"", 0};
}

bool columns_has_digit(struct text line)
{
    bool found = false;
    for (size_t i = 0; i < line.size && !found; i++) {
        found = line.data[i] >= '0' && line.data[i] <= '9';
    }
    return found;
}

/* Whether two words or more of a line are no numbers. */
static bool has_words(struct text text)
{
    struct text word;
    size_t words = 0;
    while (text_word(&text, &word)) {
        size_t letters = 0;
        for (size_t i = 0; i < word.size; i++) {
            letters += (word.data[i] | 0x20) >= 'a' && (word.data[i] | 0x20) <= 'z';
        }
        words += letters >= 2;
    }
    return words >= 2;
}

bool columns_is_sentence(const struct columns *columns, struct text text)
{
    struct table_line line;
    return columns->has_header && table_split(&line, &columns->table, text) && line.count < columns->count &&
           has_words(text);
}

uint64_t columns_sum(struct text text)
{
    uint64_t sum = UINT64_C(14695981039346656037); /* FNV-1a */
    text = text_trim(text);
    for (size_t i = 0; i < text.size; i++) {
        sum = (sum ^ (unsigned char)text.data[i]) * UINT64_C(1099511628211);
    }
    return sum;
}

/* Three numbers side by side, and at most one name before or behind them, which runs to the line's end; false with
 * a message. */
static bool read_point(double point[3], struct text *name, const struct table *table, struct text text)
{
    struct table_line line;
    if (!table_split(&line, table, text)) {
        return fail(CONUS_ERROR_DATA, "more than %d cells", TABLE_CELLS) == CONUS_OK;
    }
    double number;
    size_t first = 0;
    while (first < line.given && !(table_number(&number, table, line.cells[first]) && isfinite(number))) {
        first++;
    }
    first = first + 3 == line.given ? first : 0; /* a name in front has nothing behind */
    for (size_t i = 0; i < 3; i++) {
        struct text cell = first + i < line.count ? line.cells[first + i] : (struct text){"", 0};
        if (!table_number(&point[i], table, cell) || !isfinite(point[i])) {
            (void)pose_no_number((const char[]){"xyz"[i], '\0'}, cell);
            return false;
        }
    }
    size_t last = line.given - 1;
    *name = (struct text){"", 0};
    if (first > 0 && first + 3 == line.given) {
        const char *end = line.cells[first - 1].data + line.cells[first - 1].size;
        *name = (struct text){line.cells[0].data, (size_t)(end - line.cells[0].data)};
    } else if (line.given > 3) {
        *name = (struct text){line.cells[3].data,
                              (size_t)(line.cells[last].data + line.cells[last].size - line.cells[3].data)};
        if (table_number(&number, table, line.cells[3])) {
            (void)fail(CONUS_ERROR_DATA,
                       "a number after x y z: \"%.*s\", allowed is a name that does not begin with one",
                       POSE_QUOTE(line.cells[3]));
            return false;
        }
    }
    return true;
}

bool columns_point(double point[3], struct text *name, const struct table *table, struct text line)
{
    static const enum table_separator others[] = {TABLE_SPACES, TABLE_COMMAS};
    bool found = read_point(point, name, table, line);
    for (size_t i = 0; !found && i < 2; i++) {
        struct table other = *table;
        other.separator = others[i];
        found = read_point(point, name, &other, line);
    }
    return found || read_point(point, name, table, line); /* for its message */
}

struct pose_space columns_space(const struct columns *columns)
{
    struct pose_space space = columns->said.space;
    space.brain = columns->moves ? POSE_BRAIN_MNI152 : space.brain;
    return space;
}

conus_status columns_hear_late(const struct columns *columns, struct text line, size_t number,
                               const conus_pose_options *options)
{
    struct space_words said = {0};
    struct text inside;
    bool is_comment = table_is_comment(&inside, line);
    if (number <= columns->heard_lines || options->any_space || columns->place ||
        !(is_comment || !columns_has_digit(line) || columns_is_sentence(columns, line))) {
        return CONUS_OK;
    }
    space_words_hear(&said, inside);
    bool is_other_brain = said.space.brain && said.space.brain != columns->said.space.brain;
    bool is_turned = (said.has_signs && options->space < CONUS_SPACE_CCF && said.signs != columns->space) ||
                     (said.may_be_lps && columns->space == CONUS_SPACE_RAS);
    bool is_scaled =
        said.mm > 0 && !columns->is_own_unit && said.mm != columns->scale * columns_space_mm(options->space);
    bool is_ordered = said.axes && options->space < CONUS_SPACE_CCF && columns_sum(inside) != columns->header_sum;
    return said.why || said.are_two || is_other_brain || is_turned || is_scaled || is_ordered
               ? fail(CONUS_ERROR_DATA,
                      "line %zu: \"%.*s\" says another space or unit of the positions than the first 64 KiB, by which "
                      "the rows above were read: move it above them; %s",
                      number, POSE_QUOTE(inside), space_any(options->space))
               : CONUS_OK;
}

enum columns_end columns_end_of(struct text cell)
{
    return text_is_one_of(cell, "entry/from/start", false)    ? END_ENTRY
           : text_is_one_of(cell, "target/to/tip/end", false) ? END_TARGET
                                                              : END_NONE;
}

void columns_refuse_short(struct job *job, size_t count, size_t axes, double longest)
{
    job_bad(job,
            "%zu of %zu axes from entry to target are shorter than %g mm: are they planned and reached positions, or "
            "two spaces? Keep one of the two, in the atlas's space, as x y z",
            count, axes, longest / 20);
}

static conus_status pose_from_values(conus_pose_row *row, const struct columns *columns, double v[ROLE_NAME],
                                     const conus_pose_options *options)
{
    conus_pose *out = &row->pose;
    double m[16];
    double q[4] = {v[ROLE_QW], v[ROLE_QX], v[ROLE_QX + 1], v[ROLE_QX + 2]};
    for (int i = 0; i < 16; i++) {
        m[i] = v[ROLE_M00 + 4 * (i % 4) + i / 4];
    }
    double *x = v + ROLE_X;
    double *t = v + ROLE_TX;
    conus_space space = isnan(v[ROLE_SPACE]) ? columns->space : (conus_space)v[ROLE_SPACE];
    conus_frame own = *options->frame;
    conus_status status = space == options->space ? CONUS_OK : conus_frame_find(&own, NULL, space, NULL);
    const struct {
        double *at;
        bool is_there;
    } points[] = {{x, !columns->has[ROLE_M00]}, {t, columns->has[ROLE_TX]}, {v + ROLE_AIM, columns->has[ROLE_AIM]}};
    for (size_t i = 0; i < 3; i++) {
        double *p = points[i].at;
        const double scaled[3] = {columns->scale * p[0], columns->scale * p[1], columns->scale * p[2]};
        p[0] = scaled[columns->is_mlapdv];
        p[1] = scaled[!columns->is_mlapdv];
        p[2] = scaled[2];
        bool is_known = points[i].is_there && (i < 2 || isfinite(p[0] + p[1] + p[2]));
        status = status || !is_known ? status : conus_frame_to_world(p, &own, p);
        if (columns->moves) {
            space_move_from_mni305(p);
        }
    }
    if (status || columns->is_of_points) {
        return status ? status : pose_of_point(out, x);
    }
    bool is_tilted = columns->has[ROLE_TILT_ML] || columns->has[ROLE_TILT_AP];
    if (columns->has[ROLE_THETA]) {
        return pose_along_phi_theta(out, x, radians_from_degrees(v[ROLE_PHI]), radians_from_degrees(v[ROLE_THETA]),
                                    &own);
    }
    if (is_tilted || columns->is_straight) { /* 0 where there is no column */
        return pose_along_tilts(out, x, radians_from_degrees(v[ROLE_TILT_ML]), radians_from_degrees(v[ROLE_TILT_AP]),
                                &own);
    }
    conus_frame_direction_to_world(v + ROLE_DX, &own, v + ROLE_DX);
    conus_frame_direction_to_world(v + ROLE_UX, &own, v + ROLE_UX);
    if (space == CONUS_SPACE_LPS) { /* turning by pi about z takes a rotation's LPS form to its RAS form:
                                          (w, x, y, z) -> (-z, -y, x, w) */
        pose_flip_matrix(m);
        const double flipped[4] = {-q[3], -q[2], q[1], q[0]};
        memcpy(q, flipped, sizeof q);
    }
    const double *up = columns->has[ROLE_UX] ? v + ROLE_UX : NULL;
    bool is_turned = columns->has[ROLE_M00] || columns->has[ROLE_QW];
    status = columns->has[ROLE_M00]  ? conus_pose_from_matrix(out, m)
             : columns->has[ROLE_QW] ? conus_pose_from_quaternion(out, x, q)
             : columns->has[ROLE_TX] ? pose_row_toward(row, x, t, up)
                                     : conus_pose_along(out, x, v + ROLE_DX, up);
    if (!status) {
        conus_frame_turn_pose(out, &own, up || is_turned);
        pose_turn(out, options->axis);
    }
    return status;
}

static conus_status read_trigger(double *out, struct text cell)
{
    bool on = text_is_one_of(cell, "1/true", false);
    bool off = columns_is_absent(cell) || text_is_one_of(cell, "0/false", false);
    *out = on;
    return on || off ? CONUS_OK
                     : fail(CONUS_ERROR_DATA, "column trigger: \"%.*s\", allowed are 0, 1, true, false and n/a",
                            POSE_QUOTE(cell));
}

/* A space that --space has, or the brain of the table. A row in another brain's is not brought here. */
static conus_status read_space(double *out, const struct columns *columns, struct text cell, bool any_space)
{
    const char *what = columns->shown[ROLE_SPACE];
    const char *name;
    double own = NAN;
    struct space_words said;
    for (size_t i = 0; (name = conus_space_name(i)) && isnan(own); i++) {
        own = text_equal_ignoring_case(cell, name) ? (double)i : NAN;
    }
    bool is_heard = isnan(own) && space_words_hear_cell(&said, cell, false);
    if (is_heard && !any_space && said.why) {
        char why[SPACE_WHY];
        return fail(CONUS_ERROR_DATA, "column %s: \"%.*s\": %s", what, POSE_QUOTE(cell), space_words_why(why, &said));
    }
    bool is_named = columns->said.space.brain;
    if (is_heard && !any_space && is_named && said.space.brain && said.space.brain != columns->said.space.brain) {
        return fail(CONUS_ERROR_DATA,
                    "column %s: \"%.*s\", the table is in \"%s\"; all rows are in one brain, that of the atlas", what,
                    POSE_QUOTE(cell), columns->said.space.name);
    }
    own = is_heard && said.has_signs ? (double)said.signs : own;
    if (isnan(own)) {
        return (is_heard && is_named) || any_space || columns_is_absent(cell)
                   ? CONUS_OK
                   : fail(CONUS_ERROR_DATA,
                          "column %s: \"%.*s\", allowed are RAS, LPS, ccf, bregma and n/a; all rows are in one brain, "
                          "that of the atlas (--atlas-transform)",
                          what, POSE_QUOTE(cell));
    }
    if (!any_space && columns->grows && own == (columns->grows > 0 ? CONUS_SPACE_LPS : CONUS_SPACE_RAS)) {
        return fail(CONUS_ERROR_DATA, "column %s: \"%.*s\", and the header or a line above says %s: which is it?", what,
                    POSE_QUOTE(cell), columns->grows > 0 ? "RAS" : "LPS");
    }
    if (!isnan(*out) && *out != own) {
        return fail(CONUS_ERROR_DATA, "two columns of spaces: \"%.*s\" in one, %s in the other", POSE_QUOTE(cell),
                    conus_space_name((size_t)*out));
    }
    *out = own;
    return CONUS_OK;
}

/* The unit of all rows is one. */
static conus_status read_unit(const struct columns *columns, struct text cell, const conus_pose_options *options)
{
    double mm = space_unit_mm(cell);
    return columns_is_absent(cell) || columns->is_own_unit ||
                   (mm > 0 && mm == columns->scale * columns_space_mm(options->space))
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "column %s: \"%.*s\", the table is in another unit", columns->shown[ROLE_UNIT],
                      POSE_QUOTE(cell));
}

static conus_status read_value(double *out, const struct columns *columns, enum column_role role, struct text cell)
{
    if ((role >= ROLE_ANGLE || (role >= ROLE_AIM && role < ROLE_DX)) && columns_is_absent(cell)) {
        *out = NAN;
        return CONUS_OK;
    }
    if (!table_number(out, &columns->table, cell) || !isfinite(*out)) {
        char what[16 + COLUMN_NAME_SIZE];
        double plain;
        snprintf(what, sizeof what, "column %s", columns->shown[role]);
        return columns->table.comma == TABLE_COMMA_DECIMAL && text_to_double(cell, &plain) && isfinite(plain)
                   ? fail(CONUS_ERROR_DATA,
                          "%s: \"%.*s\": a point before three digits where commas are decimal: "
                          "thousands, or %g?",
                          what, POSE_QUOTE(cell), plain)
                   : pose_no_number(what, cell);
    }
    *out *= columns->factor[role] > 0 ? columns->factor[role] : 1;
    bool is_error = role == ROLE_ERROR_DEG || role == ROLE_ERROR_MM;
    return is_error && *out < 0
               ? fail(CONUS_ERROR_DATA, "column %s: %g, allowed are 0 and more", columns->shown[role], *out)
               : CONUS_OK;
}

/* A name without its doubled marks; both halves of one in two columns, as in "LA" and "1", or "LA" and "LA1". */
static void set_name(struct pose_name *name, struct text line, struct text cell, struct text contact)
{
    double number;
    bool is_quoted = cell.size && cell.data > line.data && cell.data[-1] == '"';
    bool begins = cell.size && contact.size >= cell.size && memcmp(contact.data, cell.data, cell.size) == 0;
    if (contact.size && begins && !text_to_double(contact, &number)) {
        cell = contact;
        contact.size = 0;
    }
    name->text = cell;
    if (!is_quoted && !contact.size) {
        return;
    }
    size_t size = kept_text_put(name->own, sizeof name->own, &(struct kept_text){cell, is_quoted});
    size += kept_text_put(name->own + size, sizeof name->own - size, &(struct kept_text){contact, false});
    name->text = (struct text){name->own, size};
}

static conus_status check_quotes(const struct table_line *line)
{
    return !line->spoilt.data ? CONUS_OK
           : line->is_unclosed
               ? fail(CONUS_ERROR_DATA, "a quotation mark that is not closed in its line: \"%.*s",
                      POSE_QUOTE(line->spoilt))
               : fail(CONUS_ERROR_DATA, "a quotation mark inside a field: %.*s", POSE_QUOTE(line->spoilt));
}

/* Only texts may be missing at the end of a row, and only empty cells be there in excess. */
static bool has_right_count(const struct columns *columns, const struct table_line *line)
{
    bool fits = line->given <= columns->count;
    for (size_t i = line->count; fits && i < columns->count; i++) {
        fits = columns->role_of[i] >= ROLE_NAME;
    }
    return fits && (line->count >= columns->count || line->count > 1);
}

static conus_status read_values(double values[ROLE_NAME], struct pose_name *name, const struct columns *columns,
                                const struct table_line *line, struct text text, const conus_pose_options *options)
{
    struct text names[2] = {{"", 0}, {"", 0}};
    conus_status status = check_quotes(line);
    if (!status && !has_right_count(columns, line)) {
        status = fail(CONUS_ERROR_DATA, "%zu fields, the header has %zu", line->count, columns->count);
    }
    for (size_t i = 0; i < columns->count && i < line->count; i++) {
        enum column_role role = columns->role_of[i];
        struct text cell = line->cells[i];
        if (role == ROLE_NAME || role == ROLE_CONTACT) {
            names[role - ROLE_NAME] = cell;
        } else if (role < ROLE_NAME && !status) {
            status = role == ROLE_TRIGGER ? read_trigger(&values[role], cell)
                     : role == ROLE_SPACE ? read_space(&values[role], columns, cell, options->any_space)
                     : role == ROLE_UNIT  ? read_unit(columns, cell, options)
                                          : read_value(&values[role], columns, role, cell);
        }
    }
    if (!status && !names[0].size && names[1].size) {
        status = fail(CONUS_ERROR_DATA, "column %s: \"\" beside \"%.*s\": merged cells? write it in each row",
                      columns->shown[ROLE_NAME], POSE_QUOTE(names[1]));
    }
    if (!line->spoilt.data) { /* a row with an error keeps its name */
        set_name(name, text, names[0], names[1]);
    }
    return status;
}

static conus_status read_row(conus_pose_row *row, struct pose_name *name, const struct columns *columns,
                             const struct table_line *line, struct text text, const conus_pose_options *options)
{
    double values[ROLE_NAME] = {[ROLE_TIME] = NAN, [ROLE_ERROR_DEG] = NAN, [ROLE_ERROR_MM] = NAN, [ROLE_NEAR] = NAN,
                                [ROLE_FAR] = NAN,  [ROLE_SPACE] = NAN,     [ROLE_DEPTH] = NAN,    [ROLE_RADIUS] = NAN};
    conus_status status = read_values(values, name, columns, line, text, options);
    /* A row may have other signs than the table, but not another space's axes and units. */
    double space = values[ROLE_SPACE];
    bool is_turned = space < CONUS_SPACE_CCF && options->space < CONUS_SPACE_CCF;
    if (!status && !isnan(space) && !is_turned && space != (double)options->space) {
        status =
            fail(CONUS_ERROR_DATA, "column space: \"%s\", the table is read in %s: each space needs a table of its own",
                 conus_space_name((size_t)space), conus_space_name((size_t)options->space));
    }
    status = status || columns->place ? status : pose_from_values(row, columns, values, options);
    double angle = values[ROLE_ANGLE];
    if (!status && columns->has[ROLE_ANGLE] && !isnan(angle) && !columns->is_of_points) {
        row->angle = angle == 0 ? row->angle : angle;
        status = angle == 0
                     ? fail(CONUS_ERROR_DATA, "angle: 0 degrees, allowed is more than 0 and less than 180, or n/a "
                                              "for none")
                     : pose_check_angle(row->angle);
    } else if (!status && columns->is_of_points && columns->has[ROLE_ANGLE] && angle != 0) {
        status = fail(CONUS_ERROR_DATA, "angle: %g degrees of a point, which has no direction", angle);
    }
    if (!status && !isnan(values[ROLE_FAR])) { /* what near alone may be depends on the range of those without */
        status = pose_check_range((double[]){isnan(values[ROLE_NEAR]) ? 0 : values[ROLE_NEAR], values[ROLE_FAR]});
    }
    row->is_point = columns->is_of_points;
    row->range[0] = values[ROLE_NEAR];
    row->range[1] = values[ROLE_FAR];
    row->radius = values[ROLE_RADIUS];
    for (enum column_role role = ROLE_DEPTH; role <= ROLE_RADIUS && !status; role++) {
        const double length = columns->has[role] ? values[role] : NAN; /* mm */
        if (length < 0 || (length == 0 && role == ROLE_DEPTH)) {
            status = fail(CONUS_ERROR_DATA, "column %s: %g mm, allowed is %s0", columns->shown[role], length,
                          role == ROLE_DEPTH ? "more than " : "from ");
        } else if (options->longest > 0 && length > options->longest) {
            status = fail(CONUS_ERROR_DATA, "column %s: %g mm, the atlas has %.3g: is it in um? Then type %s,%s=um",
                          columns->shown[role], length, options->longest, columns->file,
                          role == ROLE_DEPTH ? "depth" : "radius");
        }
    }
    if (columns->has[ROLE_DEPTH] && isfinite(values[ROLE_DEPTH])) {
        row->range[0] = isnan(row->range[0]) ? 0 : row->range[0];
        row->range[1] = values[ROLE_DEPTH];
    }
    if (!status && columns->ends_at_target && isnan(row->range[1])) {
        double way[3];
        vec3_sub(way, values + ROLE_TX, values + ROLE_X); /* of the world by now; pose_row_end() says where it begins */
        row->range[1] = vec3_length(way);
    }
    row->time_s = values[ROLE_TIME];
    row->trigger = values[ROLE_TRIGGER] != 0;
    for (int a = 0; a < 3; a++) {
        row->aim[a] = columns->has[ROLE_AIM] ? values[ROLE_AIM + a] : NAN;
    }
    row->error_deg = values[ROLE_ERROR_DEG];
    row->error_mm = values[ROLE_ERROR_MM];
    return status;
}

static bool is_without_position(const struct columns *columns, const struct table_line *line)
{
    size_t absent = 0;
    bool is_there = line->count < columns->count;
    for (size_t i = 0; !is_there && i < columns->count; i++) {
        double value = NAN; /* of SPSS, 999 or 9999 is nothing */
        bool is_coordinate = columns->role_of[i] < ROLE_X + 3;
        bool is_number = is_coordinate && table_number(&value, &columns->table, line->cells[i]) && !isnan(value);
        is_there =
            is_coordinate && !columns_is_absent(line->cells[i]) &&
            !(is_number ? fabs(value) == 999 || fabs(value) == 9999 : text_equal_ignoring_case(line->cells[i], "nan"));
        absent += is_coordinate;
    }
    return !is_there && absent == 3;
}

/* A line of a table that has no digit. Three cells of words, with blanks between them only where they are as many
 * as a row's, are another header. */
static enum columns_line kind_of_words(const struct columns *columns, const struct table_line *line, struct text text)
{
    bool is_apart = columns->table.separator != TABLE_SPACES || line->given == columns->count;
    return columns_sum(text) == columns->header_sum ? LINE_AGAIN
           : line->given >= 3 && is_apart           ? LINE_OTHER
                                                    : LINE_WORDS;
}

static struct kept_text keep_cell(struct text cell, struct text line)
{
    return (struct kept_text){cell, cell.size && cell.data > line.data && cell.data[-1] == '"'};
}

static enum columns_line read_table_line(conus_pose_row *row, struct pose_name *name, conus_status *bad,
                                         const struct columns *columns, struct text text,
                                         const conus_pose_options *options)
{
    struct table_line line;
    bool fits = table_split(&line, &columns->table, text);
    const size_t place = columns->place - 1;
    const bool has_place = fits && columns->place && place < line.count && !line.spoilt.data;
    if ((fits && columns->has[ROLE_X] && is_without_position(columns, &line)) ||
        (has_place && columns_is_absent(line.cells[place]))) {
        return LINE_ABSENT;
    }
    if (has_place ? columns_sum(text) == columns->header_sum : !columns_has_digit(text)) {
        return kind_of_words(columns, &line, text);
    }
    for (size_t i = 0; i < columns->count && i < line.count; i++) {
        if (columns->role_of[i] == ROLE_NAME && text_is_one_of(line.cells[i], "mean/sd/total", false)) {
            return LINE_CLOSING;
        }
    }
    for (size_t i = 0; row && i < columns->kept_count; i++) {
        bool is_there = fits && columns->kept[i] < line.count && !line.spoilt.data;
        name->kept[i] = keep_cell(is_there ? line.cells[columns->kept[i]] : (struct text){NULL, 0}, text);
    }
    if (row && has_place) {
        name->place = keep_cell(line.cells[place], text);
        name->side = columns->place_side && columns->place_side <= line.count ? line.cells[columns->place_side - 1]
                                                                              : text_from("");
    }
    if (row) {
        *bad = fits ? read_row(row, name, columns, &line, text, options)
                    : fail(CONUS_ERROR_DATA, "more than %d fields", TABLE_CELLS);
    }
    return LINE_ROW;
}

static conus_status read_bare(conus_pose_row *row, struct pose_name *name, const struct columns *columns,
                              struct text line, const conus_pose_options *options)
{
    double values[ROLE_NAME] = {[ROLE_SPACE] = NAN};
    row->is_point = true;
    if (columns->place) {
        struct table_line cell;
        bool is_one = table_split(&cell, &(struct table){.separator = TABLE_TABS}, line);
        name->text = is_one ? cell.cells[0] : line;
        name->place = (struct kept_text){name->text, name->text.data > line.data && name->text.data[-1] == '"'};
        name->side = text_from("");
        return is_one && cell.count == 1 ? check_quotes(&cell) : fail(CONUS_ERROR_DATA, "more than one name");
    }
    return columns_point(values + ROLE_X, &name->text, &columns->table, line)
               ? pose_from_values(row, columns, values, options)
               : CONUS_ERROR_DATA;
}

enum columns_line columns_read(conus_pose_row *row, struct pose_name *name, conus_status *bad,
                               const struct columns *columns, struct text line, size_t number,
                               const conus_pose_options *options)
{
    struct text inside;
    if (number <= columns->head_lines || table_is_blank(line) || table_is_comment(&inside, line)) {
        return LINE_NOTHING;
    }
    bool is_text = !memchr(line.data, '\0', line.size) && text_is_utf8(line);
    if (!is_text && row) {
        *bad = fail(CONUS_ERROR_DATA, memchr(line.data, '\0', line.size) ? "a zero byte: not text" : "not UTF-8 text");
    }
    if (!is_text) {
        return LINE_ROW;
    }
    if (columns->has_header) {
        return read_table_line(row, name, bad, columns, line, options);
    }
    if (!columns_has_digit(line) && !columns->place) {
        return LINE_WORDS;
    }
    struct table_line cells;
    if (!columns->place && number < columns->table.first && has_words(line) &&
        table_split(&cells, &columns->table, line) && table_numbers(&cells) < 2) { /* words, and one number at most */
        return LINE_TITLE;
    }
    if (row) {
        *bad = read_bare(row, name, columns, line, options);
    }
    return LINE_ROW;
}

bool columns_plain_matrix(conus_pose_row *row, conus_status *bad, struct text text, const conus_pose_options *options)
{
    const struct columns columns = {.has = {[ROLE_M00] = true}, .space = options->space, .scale = 1};
    double values[ROLE_NAME] = {[ROLE_SPACE] = NAN};
    struct text line;
    struct text word;
    size_t count = 0;
    size_t lines = 0;
    bool is_one = true; /* in one line, or in four of four */
    while (text_line(&text, &line)) {
        lines += text_trim(line).size > 0;
        while (text_word(&line, &word)) {
            if (count == MATRIX_NUMBERS || !text_to_double(word, &values[ROLE_M00 + count])) {
                return false;
            }
            count++;
        }
        is_one = is_one && (count == 4 * lines || lines == 1);
    }
    if (count != MATRIX_NUMBERS || !is_one) { /* two rows of a tracker's eight numbers are none */
        return false;
    }
    *bad = pose_from_values(row, &columns, values, options);
    return true;
}

/* By name, the entry (trigger false) before its target. */
static int compare_names(const void *left, const void *right)
{
    const conus_pose_row *a = left;
    const conus_pose_row *b = right;
    int order = strcmp(a->id, b->id);
    return order ? order : (a->trigger > b->trigger) - (a->trigger < b->trigger);
}

/* Pairs of two, by the entry. */
static int compare_lines(const void *left, const void *right)
{
    return compare_unsigned(((const conus_pose_row *)left)->line, ((const conus_pose_row *)right)->line);
}

/* Adds the row that a line is to `ends`; one with an error goes to the list at once. */
static void add_line(const struct pose_reading *ends, const struct pose_reading *to, const struct columns *columns,
                     struct text line, size_t number)
{
    struct job *job = to->job;
    struct table_line cells;
    struct pose_name name = {.text = {"", 0}};
    conus_pose_row row = pose_row_at(number);
    conus_status bad = CONUS_OK;
    enum columns_line kind = columns_read(&row, &name, &bad, columns, line, number, to->options);
    if (kind != LINE_ROW) {
        (void)JOB_CALL(job, columns_hear_late(columns, line, number, to->options));
        return;
    }
    if (bad) {
        pose_add(to, &row, name.text, conus_message());
        return;
    }
    bool fits = table_split(&cells, &columns->table, line) && columns->pairs <= cells.count;
    struct text word = fits ? cells.cells[columns->pairs - 1] : (struct text){"", 0};
    row.trigger = columns_end_of(word) == END_TARGET;
    if (columns_end_of(word) == END_NONE) {
        job_bad(job, "line %zu: \"%.*s\", wanted is entry or target, as above", number, POSE_QUOTE(word));
    }
    pose_add(ends, &row, name.text, NULL);
}

/* Each name has an entry and a target, and they are not the same place in two spaces. */
static void check_pairs(struct job *job, const conus_pose_list *ends, double longest)
{
    size_t near = 0;
    for (size_t i = 0; i < ends->count; i += 2) {
        const conus_pose_row *end = &ends->rows[i];
        double way[3];
        bool fits = i + 1 < ends->count && strcmp(end[0].id, end[1].id) == 0 && !end[0].trigger && end[1].trigger;
        fits = fits && (i + 2 == ends->count || strcmp(end[1].id, end[2].id) != 0);
        if (!fits) {
            job_bad(job,
                    "line %zu: \"%.60s\" has not one entry and one target: rows of an axis have one name, and no "
                    "other axis has it",
                    end->line, end->id);
            return;
        }
        vec3_sub(way, end[1].pose.world_from_device + 12, end[0].pose.world_from_device + 12);
        near += vec3_length(way) < longest / 20;
    }
    if (ends->count && 4 * near >= ends->count) {
        columns_refuse_short(job, near, ends->count / 2, longest);
    }
}

void pairs_parse(const struct pose_reading *to, const struct columns *columns, struct text text)
{
    struct job *job = to->job;
    conus_pose_list ends = {0};
    const struct pose_reading of_ends = {.job = job, .list = &ends, .options = to->options};
    struct text line;
    for (size_t number = 1; job_ok(job) && text_line(&text, &line); number++) {
        add_line(&of_ends, to, columns, line, number);
    }
    order_sort(ends.rows, ends.count, sizeof *ends.rows, compare_names);
    if (job_ok(job)) {
        check_pairs(job, &ends, to->options->longest);
    }
    order_sort(ends.rows, job_ok(job) ? ends.count / 2 : 0, 2 * sizeof *ends.rows, compare_lines);
    for (size_t i = 0; job_ok(job) && i < ends.count; i += 2) {
        const conus_pose_row *end = &ends.rows[i];
        conus_pose_row row = pose_row_at(end->line);
        conus_status bad =
            pose_row_toward(&row, end[0].pose.world_from_device + 12, end[1].pose.world_from_device + 12, NULL);
        row.range[1] = row.target_mm;
        pose_add(to, &row, text_from(end->id), bad ? conus_message() : NULL);
    }
    pose_list_finish(&ends);
}
