/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

__extension__ typedef unsigned __int128 wide;

enum { DIGITS = 9, LIMIT = 1000000000 };

/* printf follows the locale; numbers in files do not. */
static void point_for_comma(char *text)
{
    char *comma = strchr(text, ',');
    if (comma) {
        *comma = '.';
    }
}

size_t text_whole(char out[TEXT_NUMBER_SIZE], uint64_t value)
{
    char reversed[TEXT_NUMBER_SIZE];
    size_t length = 0;
    do {
        reversed[length++] = (char)('0' + value % 10);
        value /= 10;
    } while (value);
    for (size_t i = 0; i < length; i++) {
        out[i] = reversed[length - 1 - i];
    }
    out[length] = '\0';
    return length;
}

static const uint64_t ten_to[] = {1,        10,        100,        1000,        10000,        100000,       1000000,
                                  10000000, 100000000, 1000000000, 10000000000, 100000000000, 1000000000000};

/* value * 10^power to the nearest whole number, a tie to the even one. Exact: 53 bits times 10^12 fit into 128. For
 * values from 2^-14 to below 2^30. */
static uint64_t scale(double value, int power)
{
    uint64_t bits; /* IEEE 754 binary64: value = significand 2^(exponent - 1075) */
    memcpy(&bits, &value, sizeof bits);
    uint64_t significand = (bits & 0xfffffffffffff) | 0x10000000000000;
    unsigned shift = 1075 - (unsigned)(bits >> 52);
    wide product = (wide)significand * ten_to[power];
    wide unit = (wide)1 << shift;
    wide rest = product & (unit - 1);
    uint64_t whole = (uint64_t)(product >> shift);
    return whole + (rest > unit / 2 || (rest == unit / 2 && whole % 2));
}

/* What %.9g gives, without its needless generality, for values from 1.01e-4 to below 999999999. */
static size_t write_fixed(char *out, double value)
{
    static const double powers[] = {1e-4, 1e-3, 1e-2, 1e-1, 1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};
    int decade = 12; /* powers[decade] <= value, up to the rounding of the powers */
    while (decade > 0 && value < powers[decade]) {
        decade--;
    }
    int decimals = DIGITS - 1 - (decade - 4);
    uint64_t digits = scale(value, decimals);
    if (digits >= LIMIT && decimals > 0) {
        digits = scale(value, --decimals);
    }
    for (; decimals > 0 && digits % 10 == 0; decimals--) {
        digits /= 10;
    }
    size_t length = text_whole(out, digits / ten_to[decimals]);
    if (decimals > 0) {
        uint64_t fraction = digits % ten_to[decimals];
        out[length] = '.';
        for (int i = decimals; i > 0; i--) {
            out[length + (size_t)i] = (char)('0' + fraction % 10);
            fraction /= 10;
        }
        length += (size_t)decimals + 1;
    }
    out[length] = '\0';
    return length;
}

size_t text_number_length(char out[TEXT_NUMBER_SIZE], double value)
{
    double magnitude = fabs(value);
    bool whole = magnitude < 0x1p53 && value == floor(value);
    size_t sign = value < 0;
    out[0] = '-';
    if (whole) {
        return sign + text_whole(out + sign, (uint64_t)magnitude);
    }
    if (magnitude > 1.01e-4 && magnitude < 999999999) {
        return sign + write_fixed(out + sign, magnitude);
    }
    int length = snprintf(out, TEXT_NUMBER_SIZE, "%.9g", value);
    point_for_comma(out);
    return (size_t)length;
}

char *text_number(char out[TEXT_NUMBER_SIZE], double value)
{
    text_number_length(out, value);
    return out;
}

char *text_time(char out[TEXT_NUMBER_SIZE], double value)
{
    if (value == floor(value)) {
        return text_number(out, value);
    }
    snprintf(out, TEXT_NUMBER_SIZE, "%.*g", TEXT_TIME_DIGITS, value);
    point_for_comma(out);
    return out;
}
