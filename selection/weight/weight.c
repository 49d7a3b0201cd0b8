/* SPDX-License-Identifier: BSD-3-Clause */
/* The forms of weights (Eq. 30): a row of a table each. */
#include "selection/weight/weight.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "sources/names.h"

#include <math.h>
#include <stdio.h>

static const double fwhm = 2.354820045030949; /* of a normal law, in standard deviations: 2 sqrt(2 ln 2) */

static double by_nothing(const conus_weight *weight, double x, double z)
{
    (void)weight;
    (void)x;
    (void)z;
    return 1;
}

/* The density of Eq. 14's tilt per solid angle, 1 on the axis. */
static double by_gauss(const conus_weight *weight, double degrees, double depth)
{
    (void)depth;
    double theta = radians_from_degrees(degrees);
    double z = degrees / weight->facts.sigma;
    double sine = degrees > 90 ? fmax(sin(theta), 1e-3) : sin(theta); /* straight back it is 0 but for rounding */
    return exp(-z * z / 2) * (theta > 0 ? theta / sine : 1);
}

/* d:w */
static double by_coil(const conus_weight *weight, double x, double z)
{
    const double across = x / weight->facts.numbers[1];
    return exp2(-z / weight->facts.numbers[0] - across * across);
}

/* f:l:a */
static double by_focus(const conus_weight *weight, double x, double z)
{
    const double *n = weight->facts.numbers;
    const double across = x / n[1];
    const double along = (z - n[0]) / n[2];
    return exp2(-4 * (across * across + along * along));
}

/* r:NA:S:K:n; how wide the light is there. */
static double fibre_width(const conus_weight *weight, double z)
{
    const double *n = weight->facts.numbers;
    return n[0] + z * tan(asin(n[1] / n[4]));
}

static double by_fibre(const conus_weight *weight, double x, double z)
{
    const double *n = weight->facts.numbers;
    const double width = fibre_width(weight, z);
    const double a = 1 + n[3] / n[2];
    const double b = sqrt(a * a - 1);
    const double thickness = b * n[2] * sqrt(x * x + z * z);
    const double across = x / width;
    return z < 0 ? 0
                 : n[0] * n[0] / (width * width) * exp(-2 * across * across) * b /
                       (a * sinh(thickness) + b * cosh(thickness));
}

/* Their own regions, and the shortest lengths in which they change. */

static void settle_nothing(conus_weight *weight)
{
    weight->finest[0] = weight->finest[1] = INFINITY;
}

static void settle_gauss(conus_weight *weight)
{
    weight->facts.sigma = weight->facts.numbers[0];
    weight->facts.own = 8 * weight->facts.sigma;
    weight->finest[0] = weight->facts.sigma;
    weight->finest[1] = INFINITY;
}

static void settle_coil(conus_weight *weight)
{
    const double *n = weight->facts.numbers;
    weight->facts.own = 3 * n[1];
    weight->facts.depth[1] = 9 * n[0];
    weight->finest[0] = 0.85 * n[1];
    weight->finest[1] = 1.44 * n[0];
}

static void settle_focus(conus_weight *weight)
{
    const double *n = weight->facts.numbers;
    weight->facts.own = 1.5 * n[1];
    weight->facts.depth[0] = fmax(n[0] - 1.5 * n[2], 0);
    weight->facts.depth[1] = n[0] + 1.5 * n[2];
    weight->finest[0] = n[1] / fwhm;
    weight->finest[1] = n[2] / fwhm;
}

/* To where W on the axis is 1/512; it falls with the depth. */
static void settle_fibre(conus_weight *weight)
{
    double low = 0;
    double high = weight->facts.numbers[0];
    while (by_fibre(weight, 0, high) > 1.0 / 512) {
        high *= 2;
    }
    for (int i = 0; i < 60; i++) {
        const double middle = (low + high) / 2;
        *(by_fibre(weight, 0, middle) > 1.0 / 512 ? &low : &high) = middle;
    }
    weight->facts.depth[1] = high;
    weight->facts.own = 1.77 * fibre_width(weight, high);
    weight->facts.begins = true;
    weight->finest[0] = weight->finest[1] = weight->facts.numbers[0] / 2;
}

/* A number of a form, between which it is. */
struct number {
    const char *name, *unit;
    double low, high;
    double otherwise; /* where fewer are given; 0 = it is needed */
};

static const struct form {
    const char *name;
    double (*value)(const conus_weight *weight, double x, double z);
    void (*settle)(conus_weight *weight);
    enum weight_by by;
    bool by_depth;
    struct number numbers[WEIGHT_NUMBERS];
} forms[] = {
    {"hard", by_nothing, settle_nothing, WEIGHT_BY_NOTHING, false, {{0}}},
    {"gauss", by_gauss, settle_gauss, WEIGHT_BY_ANGLE, false, {{"degrees", " degrees", 0.01, 20, 0}}},
    {"coil", by_coil, settle_coil, WEIGHT_BY_OFFSET, true, {{"d", " mm", 0.01, 1000, 0}, {"w", " mm", 0.01, 1000, 0}}},
    {"focus",
     by_focus,
     settle_focus,
     WEIGHT_BY_OFFSET,
     true,
     {{"f", " mm", 0, 1000, 0}, {"l", " mm", 0.01, 1000, 0}, {"a", " mm", 0.01, 1000, 0}}},
    {"fibre",
     by_fibre,
     settle_fibre,
     WEIGHT_BY_OFFSET,
     true,
     {{"r", " mm", 0.001, 10, 0},
      {"NA", "", 0.01, 2, 0},
      {"S", " per mm", 0.01, 1000, 7.37}, /* 473 nm in grey matter, Foutz 2012 as in cleo */
      {"K", " per mm", 0.0001, 1000, 0.125},
      {"n", "", 1, 3, 1.36}}},
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

/* How many numbers a form has, and how many of them are needed. */
static size_t count_numbers(const struct form *form, bool are_needed)
{
    size_t count = 0;
    while (count < WEIGHT_NUMBERS && form->numbers[count].name && !(are_needed && form->numbers[count].otherwise > 0)) {
        count++;
    }
    return count;
}

/* "coil=W: two numbers are needed, d:w" */
static conus_status fail_count(const struct form *form, struct text text)
{
    static const char *const words[] = {"no", "one number is", "2 numbers are", "3 numbers are"};
    char names[64] = "";
    size_t used = 0;
    const size_t needed = count_numbers(form, true);
    for (size_t i = 0; i < count_numbers(form, false); i++) {
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s%s", i == needed ? "[" : "", i ? ":" : "",
                                 form->numbers[i].name);
    }
    return fail(CONUS_ERROR_ARGUMENT, "%s=%.*s: %s needed, %s%s%s", form->name, TEXT_SHOW(text, 60), words[needed],
                names, needed < count_numbers(form, false) ? "]" : "",
                form->by == WEIGHT_BY_ANGLE ? ", or the name of a published error" : "");
}

/* All numbers, those that are needed, or none. */
static conus_status read_numbers(conus_weight *out, const struct form *form, struct text text)
{
    struct weight_facts *facts = &out->facts;
    struct text rest = text;
    struct text part;
    const size_t all = count_numbers(form, false);
    for (bool more = true; text_field(&rest, ':', &more, &part);) {
        if (facts->number_count == all || !text_to_double(part, &facts->numbers[facts->number_count])) {
            return fail_count(form, text);
        }
        const struct number *row = &form->numbers[facts->number_count];
        const double number = facts->numbers[facts->number_count++];
        if (!(number >= row->low && number <= row->high)) {
            return fail(CONUS_ERROR_ARGUMENT, "%s: %s%s%.*s is out of range, allowed is %g to %g%s", form->name,
                        all > 1 ? row->name : "", all > 1 ? " " : "", TEXT_SHOW(part, 60), row->low, row->high,
                        row->unit);
        }
    }
    if (facts->number_count != all && facts->number_count != count_numbers(form, true)) {
        return fail_count(form, text);
    }
    for (; facts->number_count < all; facts->number_count++) {
        facts->numbers[facts->number_count] = form->numbers[facts->number_count].otherwise;
    }
    return form->value == by_fibre && !(facts->numbers[1] < facts->numbers[4])
               ? fail(CONUS_ERROR_ARGUMENT, "fibre: NA %g is out of range, allowed is less than n, %g",
                      facts->numbers[1], facts->numbers[4])
               : CONUS_OK;
}

/* Numbers behind "gauss=", or the name of an error. */
static conus_status read_form_numbers(conus_weight *out, const struct form *form, struct text text)
{
    if (!form->numbers[0].name) {
        return text.data ? fail(CONUS_ERROR_ARGUMENT, "%s has no numbers", form->name) : CONUS_OK;
    }
    const bool is_word = text.size && (text.data[0] | ' ') >= 'a' && (text.data[0] | ' ') <= 'z' &&
                         !text_to_double(text, &out->facts.numbers[0]);
    if (!is_word || form->by != WEIGHT_BY_ANGLE) {
        return text.data ? read_numbers(out, form, text) : fail_count(form, text);
    }
    out->facts.number_count = 1;
    conus_status status = read_error(&out->facts.numbers[0], out, text);
    const struct number *row = &form->numbers[0];
    return !status && !(out->facts.numbers[0] >= row->low && out->facts.numbers[0] <= row->high)
               ? fail(CONUS_ERROR_ARGUMENT, "%s: %.*s is out of range, allowed is %g to %g%s", form->name,
                      TEXT_SHOW(text, 60), row->low, row->high, row->unit)
               : status;
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
        out->facts.by_depth = form->by_depth;
        out->value = form->value;
        const size_t size = equals ? head.size - name.size - 1 : 0;
        conus_status status = read_form_numbers(out, form, (struct text){equals ? equals + 1 : NULL, size});
        if (!status) {
            form->settle(out);
        }
        return status;
    }
    const bool is_word = text_has_only(name, "abcdefghijklmnopqrstuvwxyz");
    if (is_word) {
        return fail_unknown(name);
    }
    char *path = memory_text(head.data, head.size);
    conus_status status = path ? weight_read_table(out, path) : CONUS_ERROR_MEMORY;
    memory_free(path);
    return status;
}

/* "0.5", "50%", "50%area" */
static conus_status read_above(struct weight_facts *facts, struct text text)
{
    const char *percent = memchr(text.data, '%', text.size);
    const size_t size = percent ? (size_t)(percent - text.data) : text.size;
    const struct text unit = {text.data + size, text.size - size};
    const bool of_areas = text_equal(unit, "%area");
    double level = 0;
    if (!text_to_double((struct text){text.data, size}, &level) || !(level > 0 && isfinite(level)) ||
        (unit.size && !of_areas && !text_equal(unit, "%")) || (unit.size && level > 100)) {
        return fail(
            CONUS_ERROR_ARGUMENT,
            "above: \"%.*s\", allowed is a weight above 0, or P%% (of the largest in the region) or P%%area (of "
            "the largest in areas) with P up to 100",
            TEXT_SHOW(text, 60));
    }
    facts->above = of_areas ? ABOVE_AREAS : unit.size ? ABOVE_LARGEST : ABOVE_LEVEL;
    facts->level = unit.size ? level / 100 : level;
    facts->has_above = true;
    return CONUS_OK;
}

static conus_status read_text(conus_weight *out, const char *text)
{
    struct source_keys keys;
    if (!keys_read(&keys, text, KEYS_WEIGHT)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s", keys.why);
    }
    out->facts.level = 0.5;
    conus_status status = read_form(out, (struct text){text, keys.length});
    if (!status && (keys.given & KEY_BIT(KEY_ABOVE))) {
        status = read_above(&out->facts, keys_value(&keys, KEY_ABOVE)->text);
    }
    if (!status && (keys.given & KEY_BIT(KEY_BIAS))) {
        memcpy(out->facts.bias, keys_value(&keys, KEY_BIAS)->numbers, sizeof out->facts.bias);
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
    return weight->facts.by == WEIGHT_BY_OFFSET || weight->facts.by == WEIGHT_BY_DISTANCE ? weight->facts.own : NAN;
}

double conus_weight_sigma(const conus_weight *weight)
{
    return weight->facts.sigma;
}

double conus_weight_finest(const conus_weight *weight)
{
    return fmin(weight->facts.by == WEIGHT_BY_ANGLE ? INFINITY : weight->finest[0], weight->finest[1]);
}

const char *conus_weight_region(const conus_weight *weight)
{
    static const char *const names[] = {[WEIGHT_BY_NOTHING] = "any",
                                        [WEIGHT_BY_ANGLE] = "cone",
                                        [WEIGHT_BY_OFFSET] = "cylinder",
                                        [WEIGHT_BY_DISTANCE] = "ball"};
    return names[weight->facts.by];
}

bool conus_weight_needs_layers(const conus_weight *weight)
{
    return weight->facts.by_depth;
}

bool conus_weight_range(double out[2], const conus_weight *weight)
{
    memcpy(out, weight->facts.depth, 2 * sizeof *out);
    return weight->facts.depth[1] > 0;
}

double weight_held(const conus_weight *weight, double x, double z)
{
    if (!weight->at) {
        return weight_value(weight, x, z);
    }
    const double *depth = weight->at + weight->counts[0];
    return weight_value(weight, fmin(x, depth[-1]), fmin(fmax(z, depth[0]), depth[weight->counts[1] - 1]));
}

bool weight_covers(const conus_weight *weight, double x, double z)
{
    if (!weight->at) {
        return true;
    }
    const double *depth = weight->at + weight->counts[0];
    return x <= depth[-1] && (!weight->facts.by_depth || (z >= depth[0] && z <= depth[weight->counts[1] - 1]));
}

conus_status weight_check_region(const conus_selector_options *options, bool is_ball)
{
    const conus_weight *weight = options->weight;
    const enum weight_by by = weight ? weight->facts.by : WEIGHT_BY_NOTHING;
    if (is_ball && (by == WEIGHT_BY_ANGLE || by == WEIGHT_BY_OFFSET)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "weight: %s has an axis, which a point has not; hard and tables by distance_mm have none",
                    weight->facts.form);
    }
    if (weight && weight->facts.has_above && !is_ball && !options->layers) {
        return fail(CONUS_ERROR_ARGUMENT, "weight: above has no effect without doses, which need all layers");
    }
    return !is_ball && by == WEIGHT_BY_DISTANCE
               ? fail(CONUS_ERROR_ARGUMENT, "weight: distance_mm is from a point, and this pose makes a %s",
                      options->radius > 0 ? "cylinder" : "cone")
               : CONUS_OK;
}

double weight_finest(const conus_weight *weight, double z)
{
    return weight->facts.by == WEIGHT_BY_ANGLE ? z * tan(radians_from_degrees(weight->finest[0])) : weight->finest[0];
}

double conus_weight_at(const conus_weight *weight, double x, double z)
{
    return weight_value(weight, x, z);
}

/* The largest W at a depth from the axis to x: that of forms falls from there. */
static double largest_at(const conus_weight *weight, double x, double z)
{
    double largest = fmax(weight_value(weight, 0, z), weight_value(weight, x, z));
    for (size_t i = 0; weight->at && i < weight->counts[0] && weight->at[i] <= x; i++) {
        largest = fmax(largest, weight_value(weight, weight->at[i], z));
    }
    return largest;
}

double weight_largest(const conus_weight *weight, const double rim[2], const double range[2])
{
    const double peak = weight->value == by_focus ? weight->facts.numbers[0] : 0; /* of forms, along the axis */
    const double ends[] = {fmin(fmax(peak, range[0]), range[1]), range[1]};
    double largest = 0;
    for (size_t k = 0; k < 2 && (k == 0 || weight->at); k++) {
        largest = fmax(largest, largest_at(weight, rim[1] > 0 ? rim[0] + rim[1] * ends[k] : rim[0], ends[k]));
    }
    for (size_t k = 0; weight->at && k < weight->counts[1]; k++) {
        const double z = weight->at[weight->counts[0] + k];
        if (z >= range[0] && z <= range[1]) {
            largest = fmax(largest, largest_at(weight, rim[0] + rim[1] * z, z));
        }
    }
    return largest;
}

double conus_weight_largest(const conus_weight *weight, double x, const double range[2])
{
    const double all[] = {0, INFINITY};
    return weight_largest(weight, (const double[]){x, 0}, range[1] > 0 ? range : all);
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
