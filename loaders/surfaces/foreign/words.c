/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes words, numbers and bytes off a mesh file. */
#include "loaders/surfaces/foreign/words.h"

#include <math.h>
#include <string.h>

enum { SHOWN = 60 };

static void skip_bytes(struct words *words, size_t count)
{
    words->rest.data += count;
    words->rest.size -= count;
}

static bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

bool words_line(struct words *words, struct text *line)
{
    bool there = text_line(&words->rest, line);
    words->line += there;
    return there;
}

static void skip_space(struct words *words)
{
    struct text *rest = &words->rest;
    struct text remark;
    while (rest->size && (is_space(*rest->data) || (words->comment && *rest->data == words->comment))) {
        if (*rest->data == '\n' || *rest->data == '\r' || !is_space(*rest->data)) {
            (void)words_line(words, &remark);
        } else {
            skip_bytes(words, 1);
        }
    }
}

bool words_next(struct words *words, struct text *word)
{
    skip_space(words);
    size_t length = 0;
    while (length < words->rest.size && !is_space(words->rest.data[length])) {
        length++;
    }
    *word = (struct text){words->rest.data, length};
    if (length) {
        skip_bytes(words, length);
    }
    return length > 0;
}

bool words_peek(const struct words *words, struct text *word)
{
    struct words copy = *words;
    return words_next(&copy, word);
}

bool words_take(struct words *words, const char *wanted)
{
    struct words copy = *words;
    struct text word;
    bool there = words_next(&copy, &word) && text_equal_ignoring_case(word, wanted);
    *words = there ? copy : *words;
    return there;
}

conus_status words_fail(const struct words *words, struct text found, const char *what)
{
    return found.size
               ? fail(CONUS_ERROR_DATA, "line %zu: \"%.*s\", needed is %s", words->line, TEXT_SHOW(found, SHOWN), what)
               : fail(CONUS_ERROR_DATA, "line %zu: the file ends, needed is %s", words->line, what);
}

conus_status words_number(double *out, struct words *words, const char *what)
{
    struct text word;
    double value;
    if (!words_next(words, &word) || !text_to_double(word, &value) || !isfinite(value)) {
        return words_fail(words, word, what);
    }
    *out = value;
    return CONUS_OK;
}

conus_status words_any_float(float *out, struct words *words, const char *what)
{
    struct text word;
    return words_next(words, &word) && text_to_float(word, out) ? CONUS_OK : words_fail(words, word, what);
}

conus_status words_float(float *out, struct words *words, const char *what)
{
    struct text word;
    float value;
    if (!words_next(words, &word) || !text_to_float(word, &value) || !isfinite(value)) {
        return words_fail(words, word, what);
    }
    *out = value;
    return CONUS_OK;
}

conus_status words_whole(int64_t *out, struct words *words, int64_t least, const char *what)
{
    struct text word;
    int64_t value;
    if (!words_next(words, &word) || !text_to_int(word, &value) || value < least) {
        return words_fail(words, word, what);
    }
    *out = value;
    return CONUS_OK;
}

conus_status words_count(size_t *out, struct words *words, size_t least, const char *what)
{
    int64_t count = 0;
    conus_status status = words_whole(&count, words, 0, what);
    if (!status && (uint64_t)count > words->rest.size / least + 1) { /* the last one needs no separator */
        status = fail(CONUS_ERROR_DATA, "%s: %lld, more than the %zu bytes that follow can hold", what,
                      (long long)count, words->rest.size);
    }
    if (!status) {
        *out = (size_t)count;
    }
    return status;
}

const uint8_t *words_bytes(struct words *words, size_t size)
{
    const uint8_t *bytes = (const uint8_t *)words->rest.data;
    if (size > words->rest.size) {
        return NULL;
    }
    if (size) {
        skip_bytes(words, size);
    }
    return bytes;
}

conus_status words_end(struct words *words, const char *what)
{
    struct text word;
    return words_next(words, &word)
               ? fail(CONUS_ERROR_DATA, "line %zu: \"%.*s\" behind %s", words->line, TEXT_SHOW(word, SHOWN), what)
               : CONUS_OK;
}
