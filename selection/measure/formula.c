/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses the formula of a score into a program for a stack, and evaluates it. */
#include "selection/measure/score.h"

#include "base/text.h"

#include <assert.h>
#include <math.h>
#include <string.h>

struct parser {
    struct formula *formula;
    const char *at; /* what is read next, in formula->text */
    formula_name name_at;
    const void *names;
    size_t depth;
};

static bool is_name_byte(char c, bool first)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (!first && c >= '0' && c <= '9');
}

static void skip_blanks(struct parser *parser)
{
    parser->at += strspn(parser->at, " \t");
}

/* Takes one of the bytes in `wanted`; 0 if another one is next. */
static char take_mark(struct parser *parser, const char *wanted)
{
    skip_blanks(parser);
    return *parser->at && strchr(wanted, *parser->at) ? *parser->at++ : '\0';
}

static void emit(struct parser *parser, struct formula_step step)
{
    parser->formula->steps[parser->formula->count++] = step; /* each has a byte of the text to itself */
}

static conus_status expected(const struct parser *parser, const char *what)
{
    size_t column = (size_t)(parser->at - parser->formula->text) + 1;
    unsigned char found = (unsigned char)*parser->at;
    if (!found) {
        return fail(CONUS_ERROR_ARGUMENT, "column %zu: the formula ends, expected is %s", column, what);
    }
    return found > ' ' && found < 0x7f
               ? fail(CONUS_ERROR_ARGUMENT, "column %zu: '%c', expected is %s", column, found, what)
               : fail(CONUS_ERROR_ARGUMENT, "column %zu: byte 0x%02x, expected is %s", column, found, what);
}

static conus_status fail_unknown(const struct parser *parser, struct text word)
{
    const char *name;
    const char *closest = NULL;
    char known[256] = "";
    /* At most this many replaced, missing or extra letters per name make it a slip of the finger. */
    size_t least = (word.size + 1) / 3 + 1;
    int shown = (int)(word.size < 40 ? word.size : 40);
    for (size_t i = 0; (name = parser->name_at(parser->names, i)); i++) {
        size_t distance = text_distance(word, text_from(name));
        closest = distance < least ? name : closest;
        least = distance < least ? distance : least;
        strncat(known, i ? ", " : "", sizeof known - strlen(known) - 1);
        strncat(known, name, sizeof known - strlen(known) - 1);
    }
    return closest ? fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is unknown; did you mean %s?", shown, word.data, closest)
                   : fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is unknown, allowed are %s", shown, word.data, known);
}

static conus_status parse_name(struct parser *parser)
{
    struct text word = {parser->at, 0};
    const char *name;
    while (is_name_byte(word.data[word.size], word.size == 0)) {
        word.size++;
    }
    for (size_t i = 0; (name = parser->name_at(parser->names, i)); i++) {
        if (text_equal(word, name)) {
            parser->at += word.size;
            emit(parser, (struct formula_step){.kind = FORMULA_NAME, .name = i});
            return CONUS_OK;
        }
    }
    return fail_unknown(parser, word);
}

static size_t count_digits(const char *text)
{
    return strspn(text, "0123456789");
}

/* Length of the decimal number at `text`. */
static size_t number_length(const char *text)
{
    size_t length = count_digits(text);
    if (text[length] == '.') {
        length += 1 + count_digits(text + length + 1);
    }
    if (text[length] == 'e' || text[length] == 'E') {
        size_t sign = text[length + 1] == '-' || text[length + 1] == '+';
        size_t exponent = count_digits(text + length + 1 + sign);
        length += exponent ? 1 + sign + exponent : 0;
    }
    return length;
}

static conus_status parse_number(struct parser *parser)
{
    struct formula_step step = {.kind = FORMULA_NUMBER};
    struct text digits = {parser->at, number_length(parser->at)};
    if (!text_to_double(digits, &step.number) || !isfinite(step.number)) {
        return expected(parser, "a number of at most 63 digits that a double holds");
    }
    parser->at += digits.size;
    emit(parser, step);
    return CONUS_OK;
}

static conus_status parse_sum(struct parser *parser);

static conus_status parse_group(struct parser *parser)
{
    if (++parser->depth > FORMULA_DEPTH_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "more than %d parentheses inside each other", FORMULA_DEPTH_LIMIT);
    }
    conus_status status = parse_sum(parser);
    if (!status && !take_mark(parser, ")")) {
        status = expected(parser, "an operator or ')'");
    }
    parser->depth--;
    return status;
}

static conus_status parse_factor(struct parser *parser)
{
    bool negative = false;
    while (take_mark(parser, "-")) {
        negative = !negative;
    }
    conus_status status = take_mark(parser, "(")                                             ? parse_group(parser)
                          : (*parser->at >= '0' && *parser->at <= '9') || *parser->at == '.' ? parse_number(parser)
                          : is_name_byte(*parser->at, true)                                  ? parse_name(parser)
                                                            : expected(parser, "a number, a name or '('");
    if (!status && negative) {
        emit(parser, (struct formula_step){.kind = FORMULA_NEGATE});
    }
    return status;
}

static double apply(enum formula_kind kind, double a, double b)
{
    switch (kind) {
    case FORMULA_ADD:
        return a + b;
    case FORMULA_SUBTRACT:
        return a - b;
    case FORMULA_MULTIPLY:
        return a * b;
    default:
        return b != 0 ? a / b : NAN;
    }
}

/* The value of steps [first, count); they are one operand. */
static double value_of(const struct formula *formula, size_t first, const double *values)
{
    double stack[FORMULA_LENGTH_LIMIT];
    size_t top = 0;
    for (size_t i = first; i < formula->count; i++) {
        const struct formula_step *step = &formula->steps[i];
        if (step->kind == FORMULA_NUMBER) {
            stack[top++] = step->number;
        } else if (step->kind == FORMULA_NAME) {
            stack[top++] = values[step->name];
        } else if (step->kind == FORMULA_NEGATE) {
            assert(top > 0);
            stack[top - 1] = 0 - stack[top - 1];
        } else {
            assert(top > 1);
            top--;
            stack[top - 1] = apply(step->kind, stack[top - 1], stack[top]);
        }
    }
    return top ? stack[0] : NAN;
}

/* A divisor that is 0 whatever the names mean is a mistake. */
static conus_status check_divisor(const struct formula *formula, size_t first)
{
    for (size_t i = first; i < formula->count; i++) {
        if (formula->steps[i].kind == FORMULA_NAME) {
            return CONUS_OK;
        }
    }
    double divisor = value_of(formula, first, NULL);
    return isfinite(divisor) && divisor != 0 ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "division by 0 for every object");
}

static conus_status parse_product(struct parser *parser)
{
    conus_status status = parse_factor(parser);
    char sign;
    while (!status && (sign = take_mark(parser, "*/"))) {
        size_t first = parser->formula->count;
        status = parse_factor(parser);
        if (!status && sign == '/') {
            status = check_divisor(parser->formula, first);
        }
        if (!status) {
            emit(parser, (struct formula_step){.kind = sign == '*' ? FORMULA_MULTIPLY : FORMULA_DIVIDE});
        }
    }
    return status;
}

static conus_status parse_sum(struct parser *parser)
{
    conus_status status = parse_product(parser);
    char sign;
    while (!status && (sign = take_mark(parser, "+-"))) {
        status = parse_product(parser);
        if (!status) {
            emit(parser, (struct formula_step){.kind = sign == '+' ? FORMULA_ADD : FORMULA_SUBTRACT});
        }
    }
    return status;
}

conus_status formula_parse(struct formula *out, const char *text, formula_name name_at, const void *names)
{
    size_t length = strlen(text);
    struct formula formula = {.count = 0};
    struct parser parser = {.formula = &formula, .at = formula.text, .name_at = name_at, .names = names};
    if (length > FORMULA_LENGTH_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "%zu bytes long, allowed are %d", length, FORMULA_LENGTH_LIMIT);
    }
    memcpy(formula.text, text, length + 1);
    conus_status status = parse_sum(&parser);
    skip_blanks(&parser);
    if (!status && *parser.at) {
        status = expected(&parser, "an operator or the end");
    }
    if (!status) {
        *out = formula;
    }
    return status;
}

double formula_value(const struct formula *formula, const double *values)
{
    double value = value_of(formula, 0, values);
    return isfinite(value) ? value : NAN;
}

bool formula_uses(const struct formula *formula, size_t index)
{
    for (size_t i = 0; i < formula->count; i++) {
        if (formula->steps[i].kind == FORMULA_NAME && formula->steps[i].name == index) {
            return true;
        }
    }
    return false;
}
