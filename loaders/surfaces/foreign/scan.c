/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes words, numbers and bytes off a mesh file. */
#include "loaders/surfaces/foreign/parts.h"

#include <math.h>

enum { SHOWN = 60 };

static bool is_space(uint8_t c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

bool scan_line(struct scan *scan, struct text *line)
{
    struct text rest = {(const char *)scan->r.at, job_step(scan->r.job) ? scan_left(scan) : 0};
    bool there = text_line(&rest, line);
    if (!there) {
        *line = (struct text){"", 0};
        return false;
    }
    scan->r.at = (const uint8_t *)rest.data;
    scan->line++;
    return true;
}

static void skip_space(struct scan *scan)
{
    const uint8_t *at = scan->r.at;
    const uint8_t *end = scan->r.end;
    while (at < end && (is_space(*at) || (scan->comment && *at == (uint8_t)scan->comment))) {
        bool ends = *at == '\n' || *at == '\r';
        if (!ends && is_space(*at)) {
            at++;
            continue;
        }
        while (at < end && *at != '\n' && *at != '\r') { /* a remark */
            at++;
        }
        at += end - at >= 2 && at[0] == '\r' && at[1] == '\n' ? 2 : at < end;
        scan->line++;
    }
    scan->r.at = at;
}

bool scan_word(struct scan *scan, struct text *word)
{
    *word = (struct text){"", 0};
    if (!job_step(scan->r.job)) {
        return false;
    }
    skip_space(scan);
    const uint8_t *from = scan->r.at;
    const uint8_t *to = from;
    while (to < scan->r.end && !is_space(*to)) {
        to++;
    }
    *word = (struct text){(const char *)from, (size_t)(to - from)};
    scan->r.at = to;
    return to > from;
}

bool scan_peek(const struct scan *scan, struct text *word)
{
    struct scan copy = *scan;
    return scan_word(&copy, word);
}

bool scan_take(struct scan *scan, const char *wanted)
{
    struct scan copy = *scan;
    struct text word;
    bool there = scan_word(&copy, &word) && text_equal_ignoring_case(word, wanted);
    *scan = there ? copy : *scan;
    return there;
}

void scan_refuse(struct scan *scan, struct text found, const char *what)
{
    if (found.size) {
        job_bad(scan->r.job, "line %zu: \"%.*s\", needed is %s", scan->line, TEXT_SHOW(found, SHOWN), what);
    } else {
        job_bad(scan->r.job, "line %zu: the file ends, needed is %s", scan->line, what);
    }
}

void scan_need(struct scan *scan, const char *wanted, const char *what)
{
    struct text word;
    if (!scan_word(scan, &word) || !text_equal_ignoring_case(word, wanted)) {
        scan_refuse(scan, word, what);
    }
}

float scan_any_float(struct scan *scan, const char *what)
{
    struct text word;
    float value;
    if (!scan_word(scan, &word) || !text_to_float(word, &value)) {
        scan_refuse(scan, word, what);
        return 0;
    }
    return value;
}

float scan_float(struct scan *scan, const char *what)
{
    struct text word;
    float value;
    if (!scan_word(scan, &word) || !text_to_float(word, &value) || !isfinite(value)) {
        scan_refuse(scan, word, what);
        return 0;
    }
    return value;
}

int64_t scan_whole(struct scan *scan, int64_t least, const char *what)
{
    struct text word;
    int64_t value;
    if (!scan_word(scan, &word) || !text_to_int(word, &value) || value < least) {
        scan_refuse(scan, word, what);
        return 0;
    }
    return value;
}

size_t scan_count(struct scan *scan, size_t least, const char *what)
{
    int64_t count = scan_whole(scan, 0, what);
    if ((uint64_t)count > scan_left(scan) / least + 1) { /* the last one needs no separator */
        job_bad(scan->r.job, "%s: %lld, more than the %zu bytes that follow can hold", what, (long long)count,
                scan_left(scan));
        return 0;
    }
    return (size_t)count;
}

void scan_end(struct scan *scan, const char *what)
{
    struct text word;
    if (scan_word(scan, &word)) {
        job_bad(scan->r.job, "line %zu: \"%.*s\" behind %s", scan->line, TEXT_SHOW(word, SHOWN), what);
    }
}
