/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Words and numbers of a mesh file's text, one after the other, and bytes of its binary part. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_WORDS_H
#define CONUS_LOADERS_SURFACES_FOREIGN_WORDS_H

#include "base/status.h"
#include "base/text.h"

/** The rest of the file. */
struct words {
    struct text rest;
    size_t line;  /**< Line of the next byte, from 1; lines end in LF, CRLF or CR. */
    char comment; /**< Begins a remark, to the end of the line; 0 = none does.     */
};

/** The next word; false where there is none. */
bool words_next(struct words *words, struct text *word);

/** The next word without taking it. */
bool words_peek(const struct words *words, struct text *word);

/** The rest of the line, without its ending; false at the end of the file. */
bool words_line(struct words *words, struct text *line);

/** True where the next word is @p wanted, whatever its case; it is taken then. */
bool words_take(struct words *words, const char *wanted);

/** A finite number. CONUS_ERROR_DATA with the line, and @p what it was to be. */
conus_status words_number(double *out, struct words *words, const char *what);

/** The same, rounded once. */
conus_status words_float(float *out, struct words *words, const char *what);

/** The same, or "nan" or "inf". */
conus_status words_any_float(float *out, struct words *words, const char *what);

/** A whole number that is not below @p least. */
conus_status words_whole(int64_t *out, struct words *words, int64_t least, const char *what);

/** A count of things that take @p least bytes or more each: never more than fit in the bytes left. */
conus_status words_count(size_t *out, struct words *words, size_t least, const char *what);

/** Takes @p size bytes; NULL where fewer are left. */
const uint8_t *words_bytes(struct words *words, size_t size);

/** CONUS_ERROR_DATA where more than white space (and remarks) is left behind @p what. */
conus_status words_end(struct words *words, const char *what);

/** Fails with the line: "line 3: "abc", needed is @p what". */
conus_status words_fail(const struct words *words, struct text found, const char *what);

#endif
