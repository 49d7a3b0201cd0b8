/* SPDX-License-Identifier: BSD-3-Clause */
/* The order of poses: keys as they are printed, and a score by a formula of them. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/text.h"
#include "selection/plan/plan.h"
#include "selection/plan/together/together.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char DEFAULT_RANK[] = "leeway,-depth";

static void add_name(struct plan_order *order, const char *text, enum plan_quantity quantity, size_t constraint)
{
    struct plan_name *name = &order->names[order->name_count++];
    *name = (struct plan_name){.quantity = quantity, .constraint = constraint};
    snprintf(name->text, sizeof name->text, "%s", text);
}

/* The names that these constraints have something for. */
static conus_status find_names(struct plan_order *order, const struct plan_constraint *constraints, size_t count)
{
    order->names = memory_zeroed(2 * count + 7, sizeof *order->names);
    if (!order->names) {
        return CONUS_ERROR_MEMORY;
    }
    add_name(order, "leeway", PLAN_LEEWAY, 0);
    add_name(order, "slack", PLAN_SLACK, 0);
    add_name(order, "clearance", PLAN_CLEARANCE, 0);
    add_name(order, "depth", PLAN_DEPTH, 0);
    add_name(order, "entry_angle", PLAN_ENTRY_ANGLE, 0);
    add_name(order, "p_ok", PLAN_CHANCE, 0);
    size_t reaches = 0;
    bool has[CONUS_MEASURE_STREAMLINES + 1] = {false};
    for (size_t i = 0; i < count; i++) {
        const conus_constraint *asked = &constraints[i].asked;
        if (asked->kind != CONUS_CONSTRAINT_REACH) {
            continue;
        }
        char number[16] = "reach";
        if (reaches++) {
            snprintf(number, sizeof number, "reach%zu", reaches);
        }
        add_name(order, number, PLAN_VALUE, i);
        bool is_named = asked->measure == CONUS_MEASURE_SHARE || asked->measure == CONUS_MEASURE_VOLUME;
        if (is_named && !has[asked->measure]) {
            add_name(order, asked->measure == CONUS_MEASURE_SHARE ? "share" : "volume", PLAN_VALUE, i);
            has[asked->measure] = true;
        }
    }
    return CONUS_OK;
}

static const char *name_at(const void *names, size_t index)
{
    const struct plan_order *order = names;
    return index < order->name_count ? order->names[index].text : NULL;
}

/* [-]NAME[/STEP] */
static conus_status parse_key(struct plan_key *out, struct text word, const struct plan_order *order)
{
    struct text number;
    struct text rest = text_trim(word);
    bool has_step = true; /* behind the name */
    *out = (struct plan_key){.smaller = text_starts(rest, "-")};
    rest = (struct text){rest.data + out->smaller, rest.size - out->smaller};
    text_field(&rest, '/', &has_step, &word);
    number = text_trim(rest);
    if (has_step && !(text_to_double(number, &out->step) && out->step > 0 && isfinite(out->step))) {
        return fail(CONUS_ERROR_ARGUMENT, "step: \"%.*s\", allowed is more than 0", TEXT_SHOW(number, 40));
    }
    struct formula *formula = memory_raw(1, sizeof *formula);
    char *copy = memory_text(word.data, word.size);
    conus_status status = formula && copy ? formula_parse(formula, copy, name_at, order) : CONUS_ERROR_MEMORY;
    if (!status && (formula->count != 1 || formula->steps[0].kind != FORMULA_NAME)) {
        status = fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is no key", TEXT_SHOW(word, 40));
    }
    if (!status) {
        out->name = formula->steps[0].name;
    }
    memory_free(formula);
    memory_free(copy);
    return status;
}

static conus_status parse_keys(struct plan_order *order, const char *list)
{
    bool more = true;
    struct text rest = text_from(list);
    conus_status status = CONUS_OK;
    while (more && !status) {
        struct text word;
        struct plan_key *keys = memory_resize(order->rank, order->rank_count + 1, sizeof *keys);
        if (!keys) {
            return CONUS_ERROR_MEMORY;
        }
        order->rank = keys;
        text_field(&rest, ',', &more, &word);
        status = parse_key(&keys[order->rank_count++], word, order);
    }
    return status;
}

static bool uses(const struct plan_order *order, enum plan_quantity quantity)
{
    for (size_t i = 0; i < order->rank_count; i++) {
        if (order->names[order->rank[i].name].quantity == quantity) {
            return true;
        }
    }
    return false;
}

static bool is_in_score(const struct plan_order *order, enum plan_quantity quantity)
{
    for (size_t i = 0; order->score && i < order->name_count; i++) {
        if (order->names[i].quantity == quantity && formula_uses(order->score, i)) {
            return true;
        }
    }
    return false;
}

conus_status plan_order_init(struct plan_order *out, const struct plan_constraint *constraints, size_t count,
                             const conus_plan_options *options)
{
    conus_status status = find_names(out, constraints, count);
    if (!status && options->score) {
        out->score = memory_raw(1, sizeof *out->score);
        status = out->score ? formula_parse(out->score, options->score, name_at, out) : CONUS_ERROR_MEMORY;
        status = status == CONUS_ERROR_ARGUMENT ? fail_in(status, "score") : status;
        if (!status) {
            add_name(out, "score", PLAN_SCORE, 0);
        }
    }
    if (!status) {
        status = parse_keys(out, options->rank ? options->rank : DEFAULT_RANK);
        status = status == CONUS_ERROR_ARGUMENT ? fail_in(status, "rank") : status;
    }
    if (status) {
        return status;
    }
    bool has_chance = is_in_score(out, PLAN_CHANCE);
    out->needs_chance = uses(out, PLAN_CHANCE) || has_chance;
    out->needs_leeway = out->needs_chance || uses(out, PLAN_LEEWAY) || is_in_score(out, PLAN_LEEWAY);
    for (bool is_sure = true; is_sure && out->sure_count < out->rank_count; out->sure_count += is_sure) {
        enum plan_quantity quantity = out->names[out->rank[out->sure_count].name].quantity;
        is_sure = quantity != PLAN_CHANCE && (quantity != PLAN_SCORE || !has_chance);
    }
    return out->needs_chance && !options->jitter
               ? fail(CONUS_ERROR_ARGUMENT, "p_ok: without errors of the poses (jitter) there is none")
               : CONUS_OK;
}

void plan_order_finish(struct plan_order *order)
{
    memory_free(order->names);
    memory_free(order->rank);
    memory_free(order->score);
}

static double value_of(const struct plan_name *name, const conus_planned *pose)
{
    static const size_t at[] = {[PLAN_LEEWAY] = offsetof(conus_planned, leeway),
                                [PLAN_SLACK] = offsetof(conus_planned, slack),
                                [PLAN_CLEARANCE] = offsetof(conus_planned, clearance),
                                [PLAN_CHANCE] = offsetof(conus_planned, p_ok),
                                [PLAN_DEPTH] = offsetof(conus_planned, far),
                                [PLAN_ENTRY_ANGLE] = offsetof(conus_planned, entry_angle),
                                [PLAN_SCORE] = offsetof(conus_planned, score)};
    return name->quantity == PLAN_VALUE ? pose->verdicts[name->constraint].value
                                        : *(const double *)((const char *)pose + at[name->quantity]);
}

/* As printed, so that the order agrees with the text. */
static double compared(const struct plan_key *key, double value)
{
    char text[TEXT_NUMBER_SIZE];
    double printed = NAN;
    if (isnan(value) || !text_to_double(text_from(text_number(text, value)), &printed)) {
        return -INFINITY;
    }
    printed = key->step > 0 ? floor(printed / key->step) : printed;
    return key->smaller ? -printed : printed;
}

/* Without a leeway it is 0. */
static double in_nanometres(const struct plan_key *key, double value)
{
    double whole = isnan(value) ? 0 : (double)nanometres(value);
    return key->smaller ? -whole : whole;
}

void plan_order_keys(double *rank, conus_planned *pose, const struct plan_order *order)
{
    pose->score = NAN;
    if (order->score) {
        double values[FORMULA_LENGTH_LIMIT];
        for (size_t i = 0; i < order->name_count; i++) {
            values[i] = value_of(&order->names[i], pose);
        }
        pose->score = formula_value(order->score, values);
    }
    for (size_t i = 0; rank && i < order->rank_count; i++) {
        const struct plan_key *key = &order->rank[i];
        double value = value_of(&order->names[key->name], pose);
        rank[i] = order->in_nanometres ? in_nanometres(key, value) : compared(key, value);
    }
}

int plan_keys_compare(const double *a, const double *b, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (a[i] != b[i]) {
            return a[i] > b[i] ? 1 : -1;
        }
    }
    return 0;
}
