/* SPDX-License-Identifier: BSD-3-Clause */
/* The forms of weights (Eq. 30): a row of a table each, and tables of files. */
#include "selection/weight/weight.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "conus/own.h"
#include "sources/keys.h"

#include <math.h>
#include <stdio.h>

static const double most_weight = 1e100; /* so that sums stay finite */
enum { ROW_LIMIT = 1000000 };

static double by_nothing(const conus_weight *weight, double x)
{
    (void)weight;
    (void)x;
    return 1;
}

/* The density of Eq. 14's tilt per solid angle, 1 on the axis. */
static double by_gauss(const conus_weight *weight, double degrees)
{
    double theta = radians_from_degrees(degrees);
    double z = degrees / weight->facts.sigma;
    return exp(-z * z / 2) * (theta > 0 ? theta / sin(theta) : 1);
}

/* Linear between rows; below the first as there, behind the last 0. */
static double by_table(const conus_weight *weight, double x)
{
    size_t low = 0;
    size_t high = weight->facts.rows - 1;
    if (x <= weight->at[0] || x > weight->at[high]) {
        return x <= weight->at[0] ? weight->values[0] : 0;
    }
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *(weight->at[middle] < x ? &low : &high) = middle;
    }
    double part = (x - weight->at[low]) / (weight->at[high] - weight->at[low]);
    return weight->values[low] + part * (weight->values[high] - weight->values[low]);
}

static const struct form {
    const char *name;
    double (*value)(const conus_weight *weight, double x);
    enum weight_by by;
    const char *number; /* NULL = it has none */
    double low, high;   /* between which that is */
    double own;         /* the opening of its own region, in units of the number */
} forms[] = {
    {"hard", by_nothing, WEIGHT_BY_NOTHING, NULL, 0, 0, 0},
    {"gauss", by_gauss, WEIGHT_BY_ANGLE, "degrees", 0.01, 20, 8},
};

static const struct form *find_form(struct text name)
{
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        if (text_equal(name, forms[i].name)) {
            return &forms[i];
        }
    }
    return NULL;
}

static conus_status fail_unknown(struct text name)
{
    char known[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        used += (size_t)snprintf(known + used, sizeof known - used, "%s, ", forms[i].name);
    }
    return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is unknown, allowed are %sor a file", TEXT_SHOW(name, 60), known);
}

/* The tilt of a published error. */
static conus_status read_error(double *tilt, conus_weight *out, struct text text)
{
    conus_pose_error error = {0};
    char *name = memory_text(text.data, text.size);
    conus_status status = name ? conus_pose_error_find(&error, name) : CONUS_ERROR_MEMORY;
    memory_free(name);
    if (!status && !(error.shift == 0 && error.entry == 0)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "%s is an error of places, too, and all rays begin in one; conus sweep "
                    "--jitter and conus plan --jitter take it",
                    error.name);
    }
    *tilt = error.tilt_deg;
    out->facts.error = error;
    return status;
}

/* A number behind "gauss=", or the name of an error. */
static conus_status read_number(conus_weight *out, const struct form *form, struct text text)
{
    double number = 0;
    if (!form->number) {
        return text.data ? fail(CONUS_ERROR_ARGUMENT, "%s has no numbers", form->name) : CONUS_OK;
    }
    const bool is_number = text.data && text_to_double(text, &number);
    const bool is_word = text.size && (text.data[0] | ' ') >= 'a' && (text.data[0] | ' ') <= 'z';
    if (!is_number && !is_word) {
        return fail(CONUS_ERROR_ARGUMENT, "%s=%.*s: one number is needed, %s, or the name of a published error",
                    form->name, TEXT_SHOW(text, 60), form->number);
    }
    conus_status status = is_number ? CONUS_OK : read_error(&number, out, text);
    if (status) {
        return status;
    }
    if (!(number >= form->low && number <= form->high)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %.*s is out of range, allowed is %g to %g %s", form->name,
                    TEXT_SHOW(text, 60), form->low, form->high, form->number);
    }
    out->facts.sigma = number;
    out->facts.own = form->own * number;
    return CONUS_OK;
}

/* A table on the way: rows of angle and weight. */
struct rows {
    double (*at)[2];
    size_t count, capacity;
    enum weight_by by;
};

enum { ANGLE, OFFSET, WEIGHT };
static const char *const columns[] = {"angle_deg", "offset_mm", "weight"};

static void take_row(struct job *job, const struct named_cells *cells, void *user)
{
    struct rows *rows = user;
    double row[2] = {0};
    const bool by_angle = named_cells_has(cells, ANGLE);
    const size_t place = by_angle ? ANGLE : OFFSET;
    if (!named_cells_has(cells, WEIGHT) || by_angle == named_cells_has(cells, OFFSET)) {
        job_bad(job, "columns angle_deg or offset_mm, and weight, are needed");
        return;
    }
    named_cells_numbers(job, &row[0], cells, place, 1);
    named_cells_numbers(job, &row[1], cells, WEIGHT, 1);
    if (!(row[1] >= 0 && row[1] <= most_weight)) {
        job_bad(job, "weight: %g is out of range, allowed is 0 to %g", row[1], most_weight);
    }
    if (!(row[0] >= 0 && (!by_angle || row[0] < 90))) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: %g is out of range, allowed is 0 %s", columns[place], row[0],
                 by_angle ? "to less than 90" : "or more");
    }
    if (rows->count == ROW_LIMIT) {
        job_bad(job, "more than %d rows", ROW_LIMIT);
    }
    rows->by = by_angle ? WEIGHT_BY_ANGLE : WEIGHT_BY_OFFSET;
    bool has_room = job_ok(job) && memory_reserve(&rows->at, &rows->capacity, rows->count + 1, sizeof *rows->at);
    if (job_need(job, has_room ? rows->at : NULL)) {
        memcpy(rows->at[rows->count++], row, sizeof row);
    }
}

static int by_first(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

static conus_status fill_table(conus_weight *out, const struct rows *rows, const char *path)
{
    if (rows->count < 2) {
        return fail(CONUS_ERROR_DATA, "%s: %zu rows, at least two are needed", path, rows->count);
    }
    order_sort(rows->at, rows->count, sizeof *rows->at, by_first);
    out->at = memory_raw(rows->count, sizeof *out->at);
    out->values = memory_raw(rows->count, sizeof *out->values);
    if (!out->at || !out->values) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < rows->count; i++) {
        if (i && rows->at[i][0] == rows->at[i - 1][0]) {
            return fail(CONUS_ERROR_DATA, "%s: %s %g is there twice", path,
                        columns[rows->by == WEIGHT_BY_ANGLE ? ANGLE : OFFSET], rows->at[i][0]);
        }
        out->at[i] = rows->at[i][0];
        out->values[i] = rows->at[i][1];
    }
    const double last = out->at[rows->count - 1];
    out->facts.form = "table";
    out->facts.rows = rows->count;
    out->facts.by = rows->by;
    out->facts.own = rows->by == WEIGHT_BY_ANGLE ? 2 * last : last;
    out->value = by_table;
    return CONUS_OK;
}

static conus_status read_table(conus_weight *out, const char *path)
{
    struct rows rows = {0};
    conus_status status = rows_read(path, columns, 3, take_row, &rows);
    status = status ? status : fill_table(out, &rows, path);
    memory_free(rows.at);
    return status;
}

/* A form by its name, or the path of a table; "gauss" before "=". */
static conus_status read_form(conus_weight *out, struct text head)
{
    const char *equals = memchr(head.data, '=', head.size);
    const struct text name = {head.data, equals ? (size_t)(equals - head.data) : head.size};
    const struct form *form = find_form(name);
    if (form) {
        out->facts.form = form->name;
        out->facts.by = form->by;
        out->value = form->value;
        const size_t size = equals ? head.size - name.size - 1 : 0;
        return read_number(out, form, (struct text){equals ? equals + 1 : NULL, size});
    }
    const bool is_word = text_has_only(name, "abcdefghijklmnopqrstuvwxyz");
    if (is_word) {
        return fail_unknown(name);
    }
    char *path = memory_text(head.data, head.size);
    conus_status status = path ? read_table(out, path) : CONUS_ERROR_MEMORY;
    memory_free(path);
    return status;
}

static conus_status read_text(conus_weight *out, const char *text)
{
    struct source_keys keys;
    if (!keys_read(&keys, text, KEYS_WEIGHT)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s", keys.why);
    }
    conus_status status = read_form(out, (struct text){text, keys.length});
    if (!status && keys.given) { /* bias, the only one */
        memcpy(out->facts.bias, keys.values[0].numbers, sizeof out->facts.bias);
        return out->facts.by == WEIGHT_BY_ANGLE
                   ? CONUS_OK
                   : fail(CONUS_ERROR_ARGUMENT, "bias: only gauss and a table by angle_deg have one");
    }
    return status;
}

conus_status conus_weight_create(conus_weight **out, const char *text)
{
    conus_weight *weight = memory_zeroed(1, sizeof *weight);
    conus_status status = weight ? read_text(weight, text) : CONUS_ERROR_MEMORY;
    if (status) {
        conus_weight_destroy(weight);
        return status;
    }
    *out = weight;
    return CONUS_OK;
}

void conus_weight_destroy(conus_weight *weight)
{
    if (weight) {
        memory_free(weight->at);
        memory_free(weight->values);
        memory_free(weight);
    }
}

double conus_weight_angle(const conus_weight *weight)
{
    return weight->facts.by == WEIGHT_BY_ANGLE ? weight->facts.own : NAN;
}

double conus_weight_radius(const conus_weight *weight)
{
    return weight->facts.by == WEIGHT_BY_OFFSET ? weight->facts.own : NAN;
}

double conus_weight_sigma(const conus_weight *weight)
{
    return weight->facts.sigma;
}

double conus_weight_at(const conus_weight *weight, double x)
{
    return weight->value(weight, x);
}

double conus_weight_largest(const conus_weight *weight, double x)
{
    double largest = weight->value(weight, 0); /* others fall from there */
    for (size_t i = 0; i < weight->facts.rows && weight->at[i] <= x; i++) {
        largest = fmax(largest, weight->values[i]);
    }
    return fmax(largest, weight->value(weight, x));
}

size_t conus_weight_path_length(const char *text)
{
    const size_t length = keys_file_length(text, KEYS_WEIGHT | KEYS_PRIOR);
    const char *equals = memchr(text, '=', length);
    const struct text name = {text, equals ? (size_t)(equals - text) : length};
    return text_has_only(name, "abcdefghijklmnopqrstuvwxyz") ? 0 : length;
}

void weight_turn(conus_pose *pose, const conus_weight *weight)
{
    if (!weight || (weight->facts.bias[0] == 0 && weight->facts.bias[1] == 0)) {
        return;
    }
    const double *bias = weight->facts.bias;
    const double degrees = hypot(bias[0], bias[1]);
    double *m = pose->world_from_device;
    const double hand = mat4_determinant3(m) < 0 ? -1 : 1; /* in a world that is a mirror image the other one */
    double axis[3];                                        /* X y - Y x, about which -z turns towards -(X x + Y y) */
    vec3_scale(axis, m + 4, hand * bias[0] / degrees);
    vec3_add_scaled(axis, axis, -hand * bias[1] / degrees, m);
    for (int column = 0; column < 3; column++) {
        vec3_turn(m + 4 * column, m + 4 * column, axis, radians_from_degrees(degrees));
    }
}
