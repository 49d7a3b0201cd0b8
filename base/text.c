/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes text apart: lines, fields, words, numbers; compares and cleans it. */
#include "base/text.h"

#include "base/order.h"
#include "base/system/system.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { NUMBER_LIMIT = 63, DISTANCE_LIMIT = 255 };

/* Splits rest at `length` bytes and drops `ending` more. */
static struct text take_bytes(struct text *rest, size_t length, size_t ending)
{
    struct text taken = {rest->data, length};
    rest->data += length + ending;
    rest->size -= length + ending;
    return taken;
}

bool text_line(struct text *rest, struct text *line)
{
    if (!rest->size) {
        return false;
    }
    size_t length = 0;
    while (length < rest->size && rest->data[length] != '\n' && rest->data[length] != '\r') {
        length++;
    }
    size_t ending = length < rest->size;
    if (length + 1 < rest->size && rest->data[length] == '\r' && rest->data[length + 1] == '\n') {
        ending = 2;
    }
    *line = take_bytes(rest, length, ending);
    return true;
}

bool text_field(struct text *rest, char separator, bool *more, struct text *field)
{
    if (!*more) {
        return false;
    }
    const char *end = rest->size ? memchr(rest->data, separator, rest->size) : NULL;
    *more = end != NULL;
    *field = take_bytes(rest, end ? (size_t)(end - rest->data) : rest->size, end != NULL);
    return true;
}

/* Bytes before the closing mark of a text, behind its opening one; text.size if there is none. */
static size_t quoted_length(struct text text)
{
    size_t end = 0;
    while (end < text.size && (text.data[end] != '"' || (end + 1 < text.size && text.data[end + 1] == '"'))) {
        end += text.data[end] == '"' ? 2 : 1;
    }
    return end < text.size ? end : text.size;
}

bool text_quoted_field(struct text *rest, char separator, bool *more, struct text *field, enum text_quotes *quotes)
{
    struct text ahead = *rest;
    while (ahead.size && *ahead.data == ' ') {
        ahead = (struct text){ahead.data + 1, ahead.size - 1};
    }
    *quotes = TEXT_PLAIN;
    if (!*more || !ahead.size || *ahead.data != '"') {
        bool taken = text_field(rest, separator, more, field);
        *field = taken ? text_trim(*field) : *field;
        return taken;
    }
    ahead = (struct text){ahead.data + 1, ahead.size - 1};
    size_t length = quoted_length(ahead);
    bool closed = length < ahead.size;
    *field = (struct text){ahead.data, length};
    *rest = (struct text){ahead.data + length + closed, ahead.size - length - closed};
    struct text behind;
    (void)text_field(rest, separator, more, &behind);
    *quotes = !closed ? TEXT_UNCLOSED : text_trim(behind).size ? TEXT_FOLLOWED : TEXT_QUOTED;
    return true;
}

static bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

bool text_word(struct text *rest, struct text *word)
{
    while (rest->size && is_space(*rest->data)) {
        take_bytes(rest, 1, 0);
    }
    size_t length = 0;
    while (length < rest->size && !is_space(rest->data[length])) {
        length++;
    }
    *word = length ? take_bytes(rest, length, 0) : *rest; /* of nothing there may be no pointer, either */
    return length > 0;
}

size_t text_blank(struct text text)
{
    const unsigned char *u = (const unsigned char *)text.data;
    if (!text.size || u[0] == ' ' || (u[0] >= '\t' && u[0] <= '\r')) {
        return text.size > 0;
    }
    if (text_starts(text, "\xc2\xa0")) {
        return 2;
    }
    return text_starts(text, "\xe2\x80") && text.size > 2 && ((u[2] >= 0x80 && u[2] <= 0x8a) || u[2] == 0xaf) ? 3 : 0;
}

size_t text_minus(struct text text)
{
    char sign;
    size_t size = text_sign(&sign, text);
    return sign == '-' ? size : 0;
}

size_t text_digits(struct text text, size_t from)
{
    size_t end = from;
    while (end < text.size && text.data[end] >= '0' && text.data[end] <= '9') {
        end++;
    }
    return end - from;
}

struct text text_trim(struct text text)
{
    while (text.size && is_space(text.data[0])) {
        take_bytes(&text, 1, 0);
    }
    while (text.size && is_space(text.data[text.size - 1])) {
        text.size--;
    }
    return text;
}

bool text_equal(struct text text, const char *string)
{
    return text.size == strlen(string) && memcmp(text.data, string, text.size) == 0;
}

bool text_equal_ignoring_case(struct text text, const char *string)
{
    return text.size == strlen(string) && strncasecmp(text.data, string, text.size) == 0;
}

bool text_is_one_of(struct text text, const char *words, bool exact)
{
    struct text rest = text_from(words);
    struct text word;
    for (bool more = true; text_field(&rest, '/', &more, &word);) {
        if (word.size == text.size && (exact ? strncmp : strncasecmp)(word.data, text.data, word.size) == 0) {
            return true;
        }
    }
    return false;
}

struct text text_from_bytes(const uint8_t *data, size_t size)
{
    struct text text = {(const char *)data, size};
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0) {
        text = (struct text){text.data + 3, text.size - 3};
    }
    while (text.size && (!text.data[text.size - 1] || is_space(text.data[text.size - 1]))) {
        text.size--;
    }
    return text;
}

bool text_mentions(struct text text, const char *part)
{
    return text.size && text_find(text, part);
}

int text_compare(struct text a, struct text b)
{
    size_t size = a.size < b.size ? a.size : b.size;
    int order = size ? memcmp(a.data, b.data, size) : 0;
    return order ? order : compare_unsigned(a.size, b.size);
}

bool text_is_readable(struct text text)
{
    for (size_t i = 0; i < text.size; i++) {
        unsigned char c = (unsigned char)text.data[i];
        if (c < 0x20 && !(c >= '\t' && c <= '\r')) {
            return false;
        }
    }
    return text.size > 0;
}

bool text_starts(struct text text, const char *prefix)
{
    size_t size = strlen(prefix);
    return text.size >= size && memcmp(text.data, prefix, size) == 0;
}

bool text_token(struct text *rest, struct text *token)
{
    const char *end = rest->data + rest->size;
    const char *from = rest->data;
    while (from < end && !isalnum((unsigned char)*from) && !(*from & 0x80)) {
        from++;
    }
    const char *to = from;
    while (to < end && (isalnum((unsigned char)*to) || *to & 0x80)) {
        to++;
    }
    *token = (struct text){from, (size_t)(to - from)};
    *rest = (struct text){to, (size_t)(end - to)};
    return to > from;
}

bool text_statement(struct text *rest, const char *words, bool sign, struct text *value)
{
    struct text word = {rest->data, 0};
    for (; text_token(rest, value); word = *value) {
        const char *behind = word.data + word.size;
        const struct text gap = {behind, (size_t)(value->data - behind)};
        if (gap.size && text_has_only(gap, "=: \t\"'([{") && (!sign || !text_has_only(gap, " \t\"'([{")) &&
            text_is_one_of(word, words, false)) {
            *rest = (struct text){value->data, value->size + rest->size};
            return true;
        }
    }
    return false;
}

bool text_has_only(struct text text, const char *these)
{
    size_t i = 0;
    while (i < text.size && text.data[i] && strchr(these, text.data[i])) {
        i++;
    }
    return i == text.size;
}

static unsigned char lower_case(char c)
{
    return (unsigned char)(c >= 'A' && c <= 'Z' ? c + ('a' - 'A') : c);
}

/* Levenshtein 1966, row by row. */
size_t text_distance(struct text a, struct text b)
{
    size_t row[DISTANCE_LIMIT + 1];
    if (a.size > DISTANCE_LIMIT || b.size > DISTANCE_LIMIT) {
        return SIZE_MAX;
    }
    for (size_t j = 0; j <= b.size; j++) {
        row[j] = j;
    }
    for (size_t i = 0; i < a.size; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < b.size; j++) {
            size_t replaced = diagonal + (lower_case(a.data[i]) != lower_case(b.data[j]));
            size_t shifted = 1 + (row[j] < row[j + 1] ? row[j] : row[j + 1]);
            diagonal = row[j + 1];
            row[j + 1] = replaced < shifted ? replaced : shifted;
        }
    }
    return row[b.size];
}

/* Numbers without an exponent whose digits fit into a double: then both they and the power of ten that divides them are
 * exact, and the one division rounds as it should (W. D. Clinger, How to read floating point numbers accurately, 1990).
 * False for all others, numbers or not. */
static bool read_short_decimal(struct text text, double *out)
{
    static const double powers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    enum { DIGITS = 15 };
    uint64_t digits = 0;
    const size_t first = text.data[0] == '-' || text.data[0] == '+';
    size_t point = text.size;
    for (size_t i = first; i < text.size; i++) {
        const unsigned digit = (unsigned char)text.data[i] - (unsigned)'0';
        if (digit <= 9) {
            digits = 10 * digits + digit; /* of too many it is not asked */
        } else if (text.data[i] == '.' && point == text.size) {
            point = i;
        } else {
            return false;
        }
    }
    const bool has_point = point < text.size;
    const size_t count = text.size - first - has_point;
    if (!count || count > DIGITS) {
        return false;
    }
    double value = (double)digits / powers[has_point ? text.size - point - 1 : 0];
    *out = text.data[0] == '-' ? -value : value;
    return true;
}

/* Copies the text with a final NUL; false if it is clearly no decimal number. */
static bool copy_number(char copy[NUMBER_LIMIT + 1], struct text text)
{
    if (!text.size || text.size > NUMBER_LIMIT || !strchr("0123456789+-.INin", text.data[0]) ||
        memchr(text.data, 'x', text.size) || memchr(text.data, 'X', text.size)) {
        return false;
    }
    memcpy(copy, text.data, text.size);
    copy[text.size] = '\0';
    return true;
}

/* Reads one of the two by the rules of the C locale, whatever the process's locale is. */
static bool read_number(double *wide, float *narrow, const char *number, size_t size)
{
    char *end;
    double value = wide ? system_to_double(number, &end) : (double)system_to_float(number, &end);
    if (end != number + size) {
        return false;
    }
    if (wide) {
        *wide = value;
    } else {
        *narrow = (float)value;
    }
    return true;
}

bool text_to_double(struct text text, double *out)
{
    char copy[NUMBER_LIMIT + 1];
    double value;
    if (text.size && read_short_decimal(text, &value)) {
        *out = value;
        return true;
    }
    return copy_number(copy, text) && read_number(out, NULL, copy, text.size);
}

bool text_to_float(struct text text, float *out)
{
    enum { BELOW_FLOAT = 29 }; /* bits that a double has more */
    char copy[NUMBER_LIMIT + 1];
    double value;
    uint64_t bits;
    if (!text_to_double(text, &value)) {
        return false;
    }
    memcpy(&bits, &value, sizeof bits);
    *out = (float)value;
    bool is_between = (bits & ((UINT64_C(1) << BELOW_FLOAT) - 1)) == UINT64_C(1) << (BELOW_FLOAT - 1);
    bool is_small = fabs(value) > 0 && fabs(value) < (double)FLT_MIN; /* a float has fewer bits there */
    if (is_between || is_small) { /* the double may have been rounded to the middle between two floats */
        return copy_number(copy, text) && read_number(NULL, out, copy, text.size);
    }
    return true;
}

bool text_to_uint(struct text text, uint64_t limit, uint64_t *out)
{
    uint64_t value = 0;
    if (!text.size || text.size > NUMBER_LIMIT) {
        return false;
    }
    for (size_t i = 0; i < text.size; i++) {
        char c = text.data[i];
        if (c < '0' || c > '9' || __builtin_mul_overflow(value, 10U, &value) ||
            __builtin_add_overflow(value, (uint64_t)(c - '0'), &value)) {
            return false;
        }
    }
    if (value > limit) {
        return false;
    }
    *out = value;
    return true;
}

bool text_to_int(struct text text, int64_t *out)
{
    bool negative = text.size && text.data[0] == '-';
    uint64_t value;
    if (text.size > NUMBER_LIMIT) {
        return false;
    }
    if (text.size && (text.data[0] == '-' || text.data[0] == '+')) {
        take_bytes(&text, 1, 0);
    }
    if (!text_to_uint(text, INT64_MAX, &value)) {
        return false;
    }
    *out = negative ? -(int64_t)value : (int64_t)value;
    return true;
}
