/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Cells of tables, by the names of their columns: a test fails where there is no such column of the type. */
#ifndef CONUS_TESTS_TABLES_H
#define CONUS_TESTS_TABLES_H

#include "conus/table.h"
#include "test.h"

#include <math.h>
#include <stdio.h>

static inline double table_number_at(const conus_table *table, const char *column, size_t row)
{
    assert_non_null(conus_table_numbers(table, column));
    assert_true(row < conus_table_rows(table));
    return conus_table_numbers(table, column)[row];
}

static inline int64_t table_count_at(const conus_table *table, const char *column, size_t row)
{
    assert_non_null(conus_table_counts(table, column));
    assert_true(row < conus_table_rows(table));
    return conus_table_counts(table, column)[row];
}

/** NULL where it is n/a. */
static inline const char *table_text_at(const conus_table *table, const char *column, size_t row)
{
    assert_non_null(conus_table_texts(table, column));
    assert_true(row < conus_table_rows(table));
    return conus_table_texts(table, column)[row];
}

/** The point in the columns @p prefix x, y and z. */
static inline void table_point_at(double out[3], const conus_table *table, const char *prefix, size_t row)
{
    for (int axis = 0; axis < 3; axis++) {
        char name[64];
        snprintf(name, sizeof name, "%s%c", prefix, "xyz"[axis]);
        out[axis] = table_number_at(table, name, row);
    }
}

/** The first row about an object, or as many as there are rows. */
static inline size_t table_row_of(const conus_table *table, uint32_t object)
{
    size_t row = 0;
    while (row < conus_table_rows(table) && conus_table_objects(table)[row] != object) {
        row++;
    }
    return row;
}

/** Asserts that both have the same columns and cells, NaN equal to NaN, but for words that nobody uses. */
static inline void assert_same_tables(const conus_table *a, const conus_table *b)
{
    assert_int_equal(conus_table_rows(a), conus_table_rows(b));
    for (size_t i = 0; conus_table_column(a, i) || conus_table_column(b, i); i++) {
        const conus_column *x = conus_table_column(a, i);
        const conus_column *y = conus_table_column(b, i);
        assert_true(x && y);
        assert_string_equal(x->name, y->name);
        assert_string_equal(x->unit, y->unit);
        assert_int_equal(x->type, y->type);
        for (size_t row = 0; row < conus_table_rows(a); row++) {
            bool both = x->type != CONUS_TYPE_TEXT || !x->texts[row] == !y->texts[row];
            assert_true(both);
            if (x->type == CONUS_TYPE_TEXT && x->texts[row]) {
                assert_string_equal(x->texts[row], y->texts[row]);
            } else if (x->type == CONUS_TYPE_COUNT) {
                assert_int_equal(x->counts[row], y->counts[row]);
                assert_int_equal(x->missing && x->missing[row], y->missing && y->missing[row]);
            } else if (x->type == CONUS_TYPE_NUMBER) {
                assert_true(x->numbers[row] == y->numbers[row] || (isnan(x->numbers[row]) && isnan(y->numbers[row])));
            }
        }
    }
}

#endif
