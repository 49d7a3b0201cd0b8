/* SPDX-License-Identifier: BSD-3-Clause */
/* What GNU's C library has for text, and others have not, and parts in per cent. It needs nothing else of conus, so
 * that programs have it, too. */
#include "base/text.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

const char *text_share(char out[TEXT_SHARE_SIZE], double share, int digits)
{
    const double least = digits ? 0.1 : 1;
    const double percent = 100 * share;
    bool is_less = percent > 0 && percent < least / 2;
    snprintf(out, TEXT_SHARE_SIZE, "%s%.*f", is_less ? "<" : "", digits, is_less ? least : percent);
    return out;
}

const char *text_find(struct text text, const char *part)
{
    size_t size = strlen(part);
    if (!size || size > text.size) {
        return size ? NULL : text.data;
    }
    const char *last = text.data + text.size - size; /* where it may begin */
    for (const char *at = text.data; at <= last && (at = memchr(at, part[0], (size_t)(last - at) + 1)); at++) {
        if (memcmp(at, part, size) == 0) {
            return at;
        }
    }
    return NULL;
}

bool text_contains(struct text text, struct text part)
{
    for (size_t i = 0; part.size <= text.size && i <= text.size - part.size; i++) {
        if (strncasecmp(text.data + i, part.data, part.size) == 0) {
            return true;
        }
    }
    return false;
}

const char *text_last(struct text text, char c)
{
    while (text.size && text.data[text.size - 1] != c) {
        text.size--;
    }
    return text.size ? text.data + text.size - 1 : NULL;
}

char *text_next(char **rest, const char *separators)
{
    char *word = *rest;
    char *end = word ? strpbrk(word, separators) : NULL;
    *rest = end ? end + 1 : NULL;
    if (end) {
        *end = '\0';
    }
    return word;
}

char *text_copy(const char *text, size_t most)
{
    size_t length = strnlen(text, most);
    char *copy = malloc(length + 1);
    if (copy) {
        memcpy(copy, text, length);
        copy[length] = '\0';
    }
    return copy;
}

/* Whether the class whose name is at `*at`, behind "[:", has the byte; moves `*at` behind ":]". */
static bool class_has(const char **at, unsigned char c)
{
    static const struct {
        const char *name;
        int (*has)(int c);
    } classes[] = {{"alnum:]", isalnum}, {"alpha:]", isalpha}, {"blank:]", isblank}, {"cntrl:]", iscntrl},
                   {"digit:]", isdigit}, {"graph:]", isgraph}, {"lower:]", islower}, {"print:]", isprint},
                   {"punct:]", ispunct}, {"space:]", isspace}, {"upper:]", isupper}, {"xdigit:]", isxdigit}};
    for (size_t i = 0; i < sizeof classes / sizeof classes[0]; i++) {
        if (strncmp(*at, classes[i].name, strlen(classes[i].name)) == 0) {
            *at += strlen(classes[i].name);
            return c < 0x80 && classes[i].has(c);
        }
    }
    return false;
}

static unsigned char fold(char c, bool any_case)
{
    return (unsigned char)(any_case && c >= 'A' && c <= 'Z' ? c + ('a' - 'A') : c);
}

/* Whether the set behind a '[' has the byte. Returns what is behind its ']'; NULL where it has none. */
static const char *match_set(bool *out, const char *at, unsigned char c, bool any_case)
{
    bool none_of = *at == '!' || *at == '^';
    bool has = false;
    at += none_of;
    for (bool first = true; first || *at != ']'; first = false) {
        if (at[0] == '[' && at[1] == ':') {
            at += 2;
            has = class_has(&at, c) || has;
            continue;
        }
        at += *at == '\\';
        unsigned char from = fold(*at, any_case);
        unsigned char to = from;
        at += *at != '\0';
        if (at[0] == '-' && at[1] && at[1] != ']') {
            at += at[1] == '\\' ? 2 : 1;
            to = fold(*at, any_case);
            at += *at != '\0';
        }
        if (!*at) {
            return NULL;
        }
        has = has || (from <= c && c <= to);
    }
    *out = has != none_of;
    return at + 1;
}

/* What is behind the part of the pattern, no '*', that the byte matches; NULL where it does not. */
static const char *match_byte(const char *pattern, char byte, bool any_case)
{
    unsigned char c = fold(byte, any_case);
    bool has = false;
    const char *end = *pattern == '[' ? match_set(&has, pattern + 1, c, any_case) : NULL;
    if (!byte || *pattern == '?') {
        return byte ? pattern + 1 : NULL;
    }
    if (end) {
        return has ? end : NULL;
    }
    pattern += *pattern == '\\';
    return *pattern && fold(*pattern, any_case) == c ? pattern + 1 : NULL;
}

bool text_matches(const char *name, const char *pattern, unsigned how)
{
    const char *star = NULL; /* behind the last '*' */
    const char *from = NULL; /* what it leaves */
    if ((how & TEXT_NO_DOT) && *name == '.' && pattern[*pattern == '\\'] != '.') {
        return false;
    }
    while (*name || *pattern) {
        const char *behind = match_byte(pattern, *name, how & TEXT_ANY_CASE);
        if (*pattern == '*') {
            star = ++pattern;
            from = name;
        } else if (behind) {
            pattern = behind;
            name++;
        } else if (star && *name) {
            pattern = star;
            name = ++from;
        } else {
            return false;
        }
    }
    return true;
}

const char *text_error(int error)
{
    static const struct {
        int error;
        const char *words;
    } known[] = {{EIO, "Input/output error"},
                 {EBUSY, "Device or resource busy"},
                 {ENOMEM, "Cannot allocate memory"},
                 {ENAMETOOLONG, "File name too long"},
                 {ELOOP, "Too many levels of symbolic links"},
                 {EILSEQ, "Invalid or incomplete multibyte or wide character"},
                 {ENOENT, "No such file or directory"},
                 {EEXIST, "File exists"},
                 {EACCES, "Permission denied"},
                 {EPERM, "Operation not permitted"},
                 {EISDIR, "Is a directory"},
                 {ENOTDIR, "Not a directory"},
                 {ENOTEMPTY, "Directory not empty"},
                 {EINVAL, "Invalid argument"},
                 {EBADF, "Bad file descriptor"},
                 {EMFILE, "Too many open files"},
                 {EFBIG, "File too large"},
                 {ENOSPC, "No space left on device"},
                 {ESPIPE, "Illegal seek"},
                 {EROFS, "Read-only file system"},
                 {EPIPE, "Broken pipe"},
                 {ENOSYS, "Function not implemented"},
                 {EAGAIN, "Resource temporarily unavailable"}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (known[i].error == error) {
            return known[i].words;
        }
    }
    return strerror(error);
}
