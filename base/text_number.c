/* SPDX-License-Identifier: BSD-3-Clause */
/* Formats numbers in decimal. */
#include "base/text.h"

#include <math.h>
#include <stdbool.h>
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
static uint64_t scale_exactly(double value, int power)
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

/* The decimal exponent of a value from 1e-4 to below 1e9, and 4: ten to it is at most the value, up to its rounding. */
static int decade_of(double value)
{
    static const double powers[] = {1e-4, 1e-3, 1e-2, 1e-1, 1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
    enum { LEAST = 1023 - 14, LOG_OF_2 = 1233, LOG_OF_LEAST = -878 }; /* 4096 times log10(2) and log10(2^-14 / 10^-4) */
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    int exponent = (int)(bits >> 52) - LEAST;
    int decade = (exponent * LOG_OF_2 + LOG_OF_LEAST) >> 12; /* that of the power of two below */
    return decade + (value >= powers[decade + 1]);
}

/* Nine digits, two at a time. */
static void write_digits(char out[DIGITS], uint64_t digits)
{
    static const char pairs[] =
        "00010203040506070809101112131415161718192021222324252627282930313233343536373839404142434"
        "44546474849505152535455565758596061626364656667686970717273747576777879808182838485868788"
        "8990919293949596979899";
    for (int i = DIGITS - 2; i > 0; i -= 2) {
        memcpy(out + i, pairs + 2 * (digits % 100), 2);
        digits /= 100;
    }
    out[0] = (char)('0' + digits);
}

/* The same as %.9g, faster, for values from 1.01e-4 to below 999999999. */
static size_t write_fixed(char *out, double value)
{
    int decimals = DIGITS - 1 - (decade_of(value) - 4);
    uint64_t digits = scale_exactly(value, decimals);
    if (digits >= LIMIT && decimals > 0) {
        digits = scale_exactly(value, --decimals);
    }
    char text[2 * DIGITS] = {0}; /* all copies have one size, so that they take no call */
    int length = DIGITS;
    write_digits(text, digits);
    for (; decimals > 0 && text[length - 1] == '0'; decimals--) {
        length--;
    }
    int whole = length - decimals;
    size_t size = 0;
    if (whole <= 0) {
        memcpy(out, "0.0000", 6);
        size = 2 + (size_t)-whole;
        whole = 0;
    } else {
        memcpy(out, text, DIGITS);
        size = (size_t)whole;
        out[size] = '.';
        size += decimals > 0;
    }
    memcpy(out + size, text + whole, DIGITS);
    size += (size_t)(length - whole);
    out[size] = '\0';
    return size;
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
