/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Numbers as text, shortest and independent of the process's locale. */
#ifndef CONUS_BASE_TEXT_NUMBER_H
#define CONUS_BASE_TEXT_NUMBER_H

#include <stddef.h>
#include <stdint.h>

enum { TEXT_NUMBER_SIZE = 32 };

/** @p value with up to 9 digits and no needless zeros, whole numbers below 2^53 with all of theirs; else "nan", "inf"
 * or "-inf". Never the locale's decimal comma, never "-0". Returns @p out. */
char *text_number(char out[TEXT_NUMBER_SIZE], double value);

/** The same in memory that lives as long as the block in which this stands. */
#define NUMBER_TEXT(value) text_number((char[TEXT_NUMBER_SIZE]){0}, value)

/** The same, and gives the text's length. */
size_t text_number_length(char out[TEXT_NUMBER_SIZE], double value);

/** @p value in decimal; gives the text's length. */
size_t text_whole(char out[TEXT_NUMBER_SIZE], uint64_t value);

enum { TEXT_TIME_DIGITS = 15 };

/** As text_number() with up to TEXT_TIME_DIGITS digits: a hundred-thousandth of a calendar's seconds. */
char *text_time(char out[TEXT_NUMBER_SIZE], double value);

#endif
