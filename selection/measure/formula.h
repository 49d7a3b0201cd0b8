/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Formulas over named values: numbers, names, + - * /, a minus in front, parentheses. Parsed once into a program for
 * a stack; ASCII only, whatever the locale. Knows nothing of what the names mean. */
#ifndef CONUS_SELECTION_MEASURE_FORMULA_H
#define CONUS_SELECTION_MEASURE_FORMULA_H

#include "base/status.h"

enum { FORMULA_LENGTH_LIMIT = 256, FORMULA_DEPTH_LIMIT = 16 };

enum formula_kind {
    FORMULA_NUMBER,
    FORMULA_NAME,
    FORMULA_NEGATE,
    FORMULA_ADD,
    FORMULA_SUBTRACT,
    FORMULA_MULTIPLY,
    FORMULA_DIVIDE
};

struct formula_step {
    enum formula_kind kind;
    size_t name;   /**< For FORMULA_NAME: its index.   */
    double number; /**< For FORMULA_NUMBER.            */
};

struct formula {
    struct formula_step steps[FORMULA_LENGTH_LIMIT]; /**< In the order of a stack: operands first. */
    size_t count;
    char text[FORMULA_LENGTH_LIMIT + 1]; /**< As it was given. */
};

/** Name @p index that a formula may use; NULL past the last. */
typedef const char *(*formula_name)(const void *names, size_t index);

/** Parses @p text (at most FORMULA_LENGTH_LIMIT bytes, FORMULA_DEPTH_LIMIT parentheses deep), whose names are those of
 * @p name_at; CONUS_ERROR_ARGUMENT says what is wrong where, and of an unknown name the closest known one. Dividing by
 * a constant that is 0 is an error. */
conus_status formula_parse(struct formula *out, const char *text, formula_name name_at, const void *names);

/** The value of the formula, that of name @p index being values[index]. NaN where it has none: a name in it is NaN, a
 * divisor is 0, the result is no finite number. */
double formula_value(const struct formula *formula, const double *values);

/** Whether the formula uses name @p index. */
bool formula_uses(const struct formula *formula, size_t index);

#endif
