/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses the header row and the rows of a table, plain points and plain matrices. */
#include "poses/pose_table.h"

#include "base/buffer.h"
#include "base/geometry/math3.h"
#include "base/notes.h"
#include "base/status.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>
#include <string.h>

enum { MATRIX_NUMBERS = 16 };

/* The columns that a row may have; m00..m33 are row-major. */
enum column {
    X,
    Y,
    Z,
    TX,
    TY,
    TZ,
    DX,
    DY,
    DZ,
    QW,
    QX,
    QY,
    QZ,
    M00,
    M33 = M00 + 15,
    UX,
    UY,
    UZ,
    ANGLE,
    TIME,
    TRIGGER,
    ERROR_DEG,
    ERROR_MM,
    NEAR,
    FAR,
    SPACE,
    ID,
    COLUMNS
};

_Static_assert((int)COLUMNS == POSE_COLUMNS, "one flag per column");

static const char *const names[COLUMNS] = {
    "x",      "y",       "z",         "tx",       "ty",   "tz",  "dx",    "dy",      "dz",  "qw",  "qx",
    "qy",     "qz",      "m00",       "m01",      "m02",  "m03", "m10",   "m11",     "m12", "m13", "m20",
    "m21",    "m22",     "m23",       "m30",      "m31",  "m32", "m33",   "ux",      "uy",  "uz",  "angle",
    "time_s", "trigger", "error_deg", "error_mm", "near", "far", "space", "query_id"};

/* A header being read. */
struct header {
    conus_space space;
    struct pose_table table;
    int id_rank; /* of the column that names the rows; 0 = none yet */
    size_t id_field;
};

static bool has_all(const struct pose_table *table, enum column first, size_t count)
{
    bool all = true;
    for (size_t i = 0; i < count; i++) {
        all = all && table->has[first + i];
    }
    return all;
}

static bool has_any(const struct pose_table *table, enum column first, size_t count)
{
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        any = any || table->has[first + i];
    }
    return any;
}

/* One way of saying where the device points, and only one, each with all its columns. */
static conus_status check_header(const struct pose_table *table)
{
    static const struct {
        enum column first;
        size_t count;
        const char *names;
    } groups[] = {{TX, 3, "tx ty tz"}, {DX, 3, "dx dy dz"}, {QW, 4, "qw qx qy qz"}, {M00, 16, "m00...m33"}};
    size_t directions = 0;
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; i++) {
        bool some = has_any(table, groups[i].first, groups[i].count);
        if (some && !has_all(table, groups[i].first, groups[i].count)) {
            return fail(CONUS_ERROR_DATA, "header: only some of the columns %s", groups[i].names);
        }
        directions += some;
    }
    if (directions != 1) {
        return fail(CONUS_ERROR_DATA,
                    "header: %s; needed are x y z and either tx ty tz (a target), dx dy dz or qw qx qy qz, or m00...m33"
                    " alone%s",
                    directions ? "several directions" : "no direction",
                    directions ? "" : "; points are lines of x y z and a name without a header");
    }
    if (table->has[M00] ? has_any(table, X, 3) : !has_all(table, X, 3)) {
        return fail(CONUS_ERROR_DATA, "header: x y z are needed, and only, without m00...m33");
    }
    bool up_fits = table->has[TX] || table->has[DX];
    if (has_any(table, UX, 3) && !(has_all(table, UX, 3) && up_fits)) {
        return fail(CONUS_ERROR_DATA, "header: ux uy uz go together, with tx ty tz or dx dy dz");
    }
    return CONUS_OK;
}

/* In a space whose axes have names a column may have them, in any order: ap, tap of a target, dap of a direction, uap.
 */
static enum column column_named(struct text field, conus_space space)
{
    static const struct {
        const char *prefix;
        enum column first;
    } groups[] = {{"", X}, {"t", TX}, {"d", DX}, {"u", UX}};
    for (size_t i = 0; space >= CONUS_SPACE_CCF && i < sizeof groups / sizeof groups[0]; i++) {
        for (size_t axis = 0; axis < 3; axis++) {
            char name[8];
            snprintf(name, sizeof name, "%s%s", groups[i].prefix, conus_space_axis(space, axis));
            if (text_equal_ignoring_case(field, name)) {
                return groups[i].first + (enum column)axis;
            }
        }
    }
    enum column column = 0;
    while (column < COLUMNS && !text_equal_ignoring_case(field, names[column])) {
        column++;
    }
    return column;
}

static conus_status add_column(struct header *header, struct text field)
{
    struct pose_table *table = &header->table;
    double number;
    bool is_index = !field.size && !table->field_count; /* as pandas writes a table's index */
    if ((!field.size && !is_index) || text_to_double(field, &number)) {
        return fail(CONUS_ERROR_DATA,
                    "header: \"%.*s\" is no name of a column, but the first line of a table has names",
                    POSE_QUOTE(field));
    }
    if (table->field_count == POSE_COLUMN_LIMIT) {
        return fail(CONUS_ERROR_DATA, "header: more than %d columns", POSE_COLUMN_LIMIT);
    }
    enum column column = column_named(field, header->space);
    static const char *const ids[] = {"name", "id", "query_id"}; /* name the rows, the last one best */
    int rank = 3;
    while (rank && !text_equal_ignoring_case(field, ids[rank - 1])) {
        rank--;
    }
    if ((column < COLUMNS && column != ID && table->has[column]) || (rank && rank == header->id_rank)) {
        field = column < COLUMNS ? text_from(names[column]) : field;
        return fail(CONUS_ERROR_DATA, "header: column \"%.*s\" twice", POSE_QUOTE(field));
    }
    /* The name of the rows is in the field that names them best; a worse one is passed over. */
    if (rank > header->id_rank) {
        if (header->id_rank) {
            table->of_field[header->id_field] = COLUMNS;
        }
        header->id_rank = rank;
        header->id_field = table->field_count;
        column = ID;
    } else if (column == ID) {
        column = COLUMNS;
    }
    if (column < COLUMNS) {
        table->has[column] = true;
    }
    table->of_field[table->field_count++] = (uint8_t)column;
    return CONUS_OK;
}

/* Whether a field is a name with a word before or behind it: orign_x, angle_deg, "angle (deg)". */
static bool is_name_with_word(struct text field, const char *name)
{
    const size_t size = strlen(name);
    if (field.size <= size + 1) {
        return false;
    }
    bool starts = text_equal_ignoring_case((struct text){field.data, size}, name);
    bool ends = text_equal_ignoring_case((struct text){field.data + field.size - size, size}, name);
    return (starts && strchr("_ ([.-", field.data[size])) || (ends && field.data[field.size - size - 1] == '_');
}

/* The known column that was perhaps meant: it is not there, and little is to be changed, or it stands beside a word.
 * NULL if there is none. */
static const char *column_meant(const struct pose_table *table, struct text field)
{
    const char *meant = NULL;
    size_t least = (field.size + 1) / 3;
    for (enum column column = 0; column < COLUMNS; column++) {
        size_t distance = text_distance(field, text_from(names[column]));
        bool beside = is_name_with_word(field, names[column]);
        if (!table->has[column] && field.size && (beside || (distance <= least && distance < strlen(names[column])))) {
            meant = names[column];
            least = beside ? 0 : distance;
        }
    }
    return meant;
}

/* Lists the columns, with suggestions for unknown ones; or the unknown ones only. */
static conus_status list_columns(struct buffer *out, const struct pose_table *table, struct text line, bool known)
{
    enum { SHOWN = 20 };
    struct text field;
    enum text_quotes quotes;
    size_t count = 0;
    size_t index = 0;
    for (bool more = true; text_quoted_field(&line, table->separator, &more, &field, &quotes); index++) {
        bool is_known = table->of_field[index] != COLUMNS;
        if ((is_known && !known) || count++ >= SHOWN) {
            continue;
        }
        const char *meant = is_known ? NULL : column_meant(table, field);
        buffer_format(out, "%s\"%.*s\"", count > 1 ? ", " : "", POSE_QUOTE(field));
        if (meant) {
            buffer_format(out, " (did you mean %s?)", meant);
        }
    }
    if (count > SHOWN) {
        buffer_format(out, " and %zu more", count - SHOWN);
    }
    return buffer_status(out);
}

/* A column that is missing may be one that is misspelt; what is passed over without need is said once. */
static conus_status note_ignored(struct notes *notes, const struct pose_table *table, struct text line,
                                 conus_status status)
{
    char reason[320];
    struct buffer list = {0};
    snprintf(reason, sizeof reason, "%s", status ? conus_message() : "");
    conus_status listed = list_columns(&list, table, line, status != CONUS_OK);
    if (!listed && list.size && status) {
        bool is_mouse = text_contains((struct text){list.data, list.size},
                                      text_from("\"ap\"")); /* which the spaces of the CCF know */
        status = fail(status, "%s; columns found: %s%s", reason, list.data,
                      is_mouse ? "; ap, dv and ml are read in space ccf or bregma" : "");
    } else if (!listed && list.size) {
        status = notes_add(notes, "columns passed over: %s", list.data);
    }
    buffer_finish(&list);
    return listed ? listed : status;
}

/* In a table with commas a mark in the middle is what is left of a field that goes on from line to line. */
static conus_status check_quotes(const struct pose_table *table, struct text field, enum text_quotes quotes)
{
    if (quotes == TEXT_UNCLOSED) {
        return fail(CONUS_ERROR_DATA, "a quotation mark that is not closed in its line: \"%.*s", POSE_QUOTE(field));
    }
    bool stray = quotes == TEXT_PLAIN && table->separator != '\t' && field.size && memchr(field.data, '"', field.size);
    return !stray && quotes != TEXT_FOLLOWED
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "a quotation mark inside a field: %.*s", POSE_QUOTE(field));
}

conus_status pose_table_header(struct pose_table *out, struct notes *notes, struct text line,
                               const conus_pose_options *options)
{
    struct header header = {.space = options->space,
                            .table.separator = memchr(line.data, '\t', line.size)  ? '\t'
                                               : memchr(line.data, ',', line.size) ? ','
                                                                                   : ';'};
    struct pose_table *table = &header.table;
    const struct text whole = line;
    struct text field;
    enum text_quotes quotes;
    conus_status status = text_is_utf8(line) ? CONUS_OK : fail(CONUS_ERROR_DATA, "header: not UTF-8 text");
    if (!status && !memchr(line.data, table->separator, line.size)) {
        status = fail(CONUS_ERROR_DATA, "header: \"%.*s\": no tab, comma or semicolon is between names of columns",
                      POSE_QUOTE(line));
    }
    for (bool more = true; !status && text_quoted_field(&line, table->separator, &more, &field, &quotes);) {
        status = check_quotes(table, field, quotes);
        status = status ? status : add_column(&header, field);
    }
    if (!status) {
        status = note_ignored(notes, table, whole, check_header(table));
    }
    bool turns = table->has[QW] || table->has[M00];
    if (!status && options->axis != CONUS_AXIS_OF_FORMAT && !turns) {
        status = fail(CONUS_ERROR_DATA,
                      "header: it gives a direction, so that no axis (%s) is to be chosen; "
                      "qw qx qy qz or m00...m33 have axes",
                      pose_axis_name(options->axis));
    }
    /* The names of rotations' columns are of axes that space ccf and bregma do not have. */
    if (!status && options->space >= CONUS_SPACE_CCF && turns) {
        status = fail(CONUS_ERROR_DATA,
                      "header: rotations (qw qx qy qz or m00...m33) are not read in space %s; tx ty tz or dx dy dz are",
                      conus_space_name((size_t)options->space));
    }
    table->has_times = table->has[TIME];
    table->has_ids = table->has[ID];
    table->has_angles = table->has[ANGLE];
    table->has_ranges = table->has[NEAR] || table->has[FAR];
    *out = status ? *out : *table;
    return status;
}

static conus_status pose_from_values(conus_pose *out, const struct pose_table *table, double v[COLUMNS],
                                     const conus_pose_options *options)
{
    double m[16];
    double q[4] = {v[QW], v[QX], v[QY], v[QZ]};
    for (int i = 0; i < 16; i++) {
        m[i] = v[M00 + 4 * (i % 4) + i / 4];
    }
    conus_space space = isnan(v[SPACE]) ? options->space : (conus_space)v[SPACE];
    conus_frame own = *options->frame;
    conus_status status = space == options->space ? CONUS_OK : conus_frame_find(&own, NULL, space, NULL);
    status = status || table->has[M00] ? status : conus_frame_to_world(v + X, &own, v + X);
    status = status || !table->has[TX] ? status : conus_frame_to_world(v + TX, &own, v + TX);
    if (status) {
        return status;
    }
    conus_frame_direction_to_world(v + DX, &own, v + DX);
    conus_frame_direction_to_world(v + UX, &own, v + UX);
    if (space == CONUS_SPACE_LPS) { /* turning by pi about z takes a rotation's LPS form to its RAS form:
                                          (w, x, y, z) -> (-z, -y, x, w) */
        pose_flip_matrix(m);
        const double turned[4] = {-v[QZ], -v[QY], v[QX], v[QW]};
        memcpy(q, turned, sizeof q);
    }
    const double *up = table->has[UX] ? v + UX : NULL;
    status = table->has[M00]  ? conus_pose_from_matrix(out, m)
             : table->has[QW] ? conus_pose_from_quaternion(out, v + X, q)
             : table->has[TX] ? conus_pose_toward(out, v + X, v + TX, up)
                              : conus_pose_along(out, v + X, v + DX, up);
    if (!status) {
        conus_frame_turn_pose(out, &own, up || table->has[M00] || table->has[QW]);
        pose_turn(out, options->axis);
    }
    return status;
}

static bool is_absent(struct text field)
{
    return !field.size || text_equal_ignoring_case(field, "n/a");
}

static conus_status read_trigger(double *out, struct text field)
{
    bool on = text_equal(field, "1") || text_equal_ignoring_case(field, "true");
    bool off = is_absent(field) || text_equal(field, "0") || text_equal_ignoring_case(field, "false");
    *out = on;
    return on || off ? CONUS_OK
                     : fail(CONUS_ERROR_DATA, "column trigger: \"%.*s\", allowed are 0, 1, true, false and n/a",
                            POSE_QUOTE(field));
}

static conus_status read_value(double *out, enum column column, struct text field)
{
    if (column >= ANGLE && is_absent(field)) { /* what a row can do without */
        *out = NAN;
        return CONUS_OK;
    }
    if (!text_to_double(field, out) || !isfinite(*out)) {
        char what[32];
        snprintf(what, sizeof what, "column %s", names[column]);
        return pose_no_number(what, field);
    }
    bool is_error = column == ERROR_DEG || column == ERROR_MM;
    return is_error && *out < 0 ? fail(CONUS_ERROR_DATA, "column %s: %g, allowed are 0 and more", names[column], *out)
                                : CONUS_OK;
}

/* A name without its doubled marks. */
static struct text name_in(char out[POSE_NAME_SIZE], struct text field)
{
    size_t size = 0;
    for (size_t i = 0; i < field.size && size < POSE_NAME_SIZE; i++) {
        out[size++] = field.data[i];
        i += field.data[i] == '"'; /* and the one behind it */
    }
    return (struct text){out, size};
}

/* One of the spaces that --space has. A row in another brain's is not brought here. */
static conus_status read_space(double *out, struct text field)
{
    const char *name;
    *out = NAN;
    for (size_t i = 0; (name = conus_space_name(i)) && isnan(*out); i++) {
        *out = text_equal_ignoring_case(field, name) ? (double)i : NAN;
    }
    return !isnan(*out) || is_absent(field)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "column space: \"%.*s\", allowed are RAS, LPS, ccf, bregma and n/a; all rows are in one brain, "
                      "that of the atlas (--atlas-transform)",
                      POSE_QUOTE(field));
}

static conus_status read_values(double values[COLUMNS], struct pose_name *name, const struct pose_table *table,
                                struct text line)
{
    struct text field;
    enum text_quotes quotes;
    size_t count = 0;
    conus_status status = CONUS_OK;
    for (bool more = true; text_quoted_field(&line, table->separator, &more, &field, &quotes); count++) {
        status = status ? status : check_quotes(table, field, quotes);
        enum column column = count < table->field_count ? table->of_field[count] : COLUMNS;
        if (status || column == COLUMNS) {
            continue;
        }
        if (column == ID) {
            name->text = quotes == TEXT_QUOTED ? name_in(name->own, field) : field;
        } else {
            status = column == TRIGGER ? read_trigger(&values[TRIGGER], field)
                     : column == SPACE ? read_space(&values[SPACE], field)
                                       : read_value(&values[column], column, field);
        }
    }
    return count == table->field_count || status
               ? status
               : fail(CONUS_ERROR_DATA, "%zu fields, the header has %zu", count, table->field_count);
}

static conus_status check_text(struct text line)
{
    if (memchr(line.data, '\0', line.size)) {
        return fail(CONUS_ERROR_DATA, "a zero byte: not text");
    }
    return text_is_utf8(line) ? CONUS_OK : fail(CONUS_ERROR_DATA, "not UTF-8 text");
}

conus_status pose_table_row(conus_pose_row *row, struct pose_name *name, const struct pose_table *table,
                            struct text line, const conus_pose_options *options)
{
    double values[COLUMNS] = {
        [TIME] = NAN, [ERROR_DEG] = NAN, [ERROR_MM] = NAN, [NEAR] = NAN, [FAR] = NAN, [SPACE] = NAN};
    conus_status status = check_text(line);
    status = status ? status : read_values(values, name, table, line);
    /* A row may have other signs than the table, but not another space's axes and units. */
    double space = values[SPACE];
    bool is_turned = space < CONUS_SPACE_CCF && options->space < CONUS_SPACE_CCF;
    if (!status && !isnan(space) && !is_turned && space != (double)options->space) {
        status =
            fail(CONUS_ERROR_DATA, "column space: \"%s\", the table is read in %s: each space needs a table of its own",
                 conus_space_name((size_t)space), conus_space_name((size_t)options->space));
    }
    status = status ? status : pose_from_values(&row->pose, table, values, options);
    if (!status && table->has[ANGLE] && !isnan(values[ANGLE])) {
        row->angle = values[ANGLE] == 0 ? row->angle : radians_from_degrees(values[ANGLE]);
        status = values[ANGLE] == 0 ? fail(CONUS_ERROR_DATA, "angle: 0 degrees, allowed is more than 0 and less than "
                                                             "180, or n/a for none")
                                    : pose_check_angle(row->angle);
    }
    if (!status && !isnan(values[FAR])) { /* what near alone may be depends on the range of those without */
        status = pose_check_range((double[]){isnan(values[NEAR]) ? 0 : values[NEAR], values[FAR]});
    }
    row->range[0] = values[NEAR];
    row->range[1] = values[FAR];
    row->time_s = values[TIME];
    row->trigger = values[TRIGGER] != 0;
    row->error_deg = values[ERROR_DEG];
    row->error_mm = values[ERROR_MM];
    return status;
}

static struct text next_field(struct text *rest, bool commas)
{
    struct text field = {"", 0};
    bool more = true;
    (void)(commas ? text_field(rest, ',', &more, &field) : text_word(rest, &field));
    return text_trim(field);
}

/* Three numbers and the rest of the line; false with a message. */
static bool read_point(double point[3], struct text *name, struct text line)
{
    struct text rest = line;
    struct text word = next_field(&rest, false);
    bool commas = word.size && memchr(word.data, ',', word.size);
    for (int i = 0; i < 3; i++) {
        word = next_field(&line, commas);
        if (!text_to_double(word, &point[i]) || !isfinite(point[i])) {
            (void)pose_no_number((const char[]){"xyz"[i], '\0'}, word);
            return false;
        }
    }
    *name = text_trim(line);
    rest = *name;
    word = next_field(&rest, commas);
    double number;
    if (text_to_double(word, &number)) {
        (void)fail(CONUS_ERROR_DATA, "a number after x y z: \"%.*s\", allowed is a name that does not begin with one",
                   POSE_QUOTE(word));
        return false;
    }
    return true;
}

bool pose_is_point(struct text line)
{
    double point[3];
    struct text name;
    return read_point(point, &name, line);
}

conus_status pose_point_row(conus_pose_row *row, struct pose_name *name, struct text line,
                            const conus_pose_options *options)
{
    double point[3];
    conus_status status = check_text(line);
    if (status || !read_point(point, &name->text, line)) {
        return CONUS_ERROR_DATA;
    }
    status = conus_frame_to_world(point, options->frame, point);
    row->is_point = true;
    return status ? status : pose_of_point(&row->pose, point);
}

bool pose_plain_matrix(conus_pose_row *row, conus_status *bad, struct text text, const conus_pose_options *options)
{
    const struct pose_table table = {.has[M00] = true};
    double values[COLUMNS] = {[SPACE] = NAN};
    struct text word;
    size_t count = 0;
    while (text_word(&text, &word)) {
        if (count == MATRIX_NUMBERS || !text_to_double(word, &values[M00 + count])) {
            return false;
        }
        count++;
    }
    if (count != MATRIX_NUMBERS) {
        return false;
    }
    *bad = pose_from_values(&row->pose, &table, values, options);
    return true;
}
