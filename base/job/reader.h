/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The one reader: of bytes in memory, of a file, or of what gzip packs in a file; block by block, so that no file is
 * held twice. No read passes the end.
 *
 *     struct reader r = reader_on(job, &file);
 *     struct text line;
 *     while (reader_line(&r, &line)) {
 *
 * A text or pointer that it gives is good until the next call that reads: who keeps it copies it into the job. Builds
 * with AddressSanitizer read blocks of 64 bytes, each elsewhere, so that a text kept without a copy is found. After a
 * failure of the job nothing is left and the position is the end: a loop over what is left stops. */
#ifndef CONUS_BASE_JOB_READER_H
#define CONUS_BASE_JOB_READER_H

#include "base/byte_order.h"
#include "base/job/job.h"

struct reader_source;

struct reader {
    struct job *job;
    const uint8_t *at, *end;      /**< Bytes at hand. */
    uint64_t end_offset;          /**< Position of `end`, unpacked. */
    bool swapped;                 /**< Numbers are not in this machine's byte order. */
    struct reader_source *source; /**< Where more comes from; NULL = nowhere. */
};

/** Reads an open file, which outlives the reader, unpacked where gzip packs it: all members, behind which only zeros
 * may follow. The path is a place, which the caller enters before. */
struct reader reader_on(struct job *job, const struct open_file *file);

/** Reads @p text, which must outlive the reader. */
struct reader reader_of(struct job *job, struct text text);

/** Bytes before the position. */
uint64_t reader_at(const struct reader *r);

/** How many bytes can be left at most; exact of what is not packed. */
uint64_t reader_most(const struct reader *r);

/** Whether @p count bytes are left; they are at hand then, from r->at on. */
bool reader_has_more(struct reader *r, size_t count);
static inline bool reader_has(struct reader *r, size_t count)
{
    return (size_t)(r->end - r->at) >= count ? job_ok(r->job) : reader_has_more(r, count);
}

/** The next @p count bytes; NULL and a failure where there are fewer. */
const uint8_t *reader_take(struct reader *r, size_t count);

/** The next 1 to @p most bytes, as many as are at hand, in whole things of @p each bytes, and their *size; NULL where
 * no whole thing is left. */
const uint8_t *reader_some(struct reader *r, uint64_t most, size_t each, size_t *size);

/** A copy of the next @p count bytes in the job's memory; empty after a failure. */
struct text reader_keep(struct reader *r, size_t count);

/** Passes over @p count bytes; a failure where there are fewer. */
void reader_skip(struct reader *r, uint64_t count);

/** @name Numbers; 0 and a failure at the end @{ */
static inline uint16_t reader_u16(struct reader *r)
{
    const uint8_t *data = reader_take(r, sizeof(uint16_t));
    return data ? order_u16(data, r->swapped) : 0;
}
static inline uint32_t reader_u32(struct reader *r)
{
    const uint8_t *data = reader_take(r, sizeof(uint32_t));
    return data ? order_u32(data, r->swapped) : 0;
}
static inline double reader_f32(struct reader *r)
{
    const uint8_t *data = reader_take(r, sizeof(float));
    return data ? (double)order_f32(data, r->swapped) : 0;
}
static inline double reader_f64(struct reader *r)
{
    const uint8_t *data = reader_take(r, sizeof(double));
    return data ? order_f64(data, r->swapped) : 0;
}
/** @} */

/** The next line, without its LF and a CR before that; false at the end. A line of more than 16 MiB is a failure. */
bool reader_line(struct reader *r, struct text *line);

/** The next run without white space; false where only white space is left. */
bool reader_word(struct reader *r, struct text *word);

#endif
