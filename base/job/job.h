/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A piece of work: a load, a parse, a question. It owns what the work allocates, its first error with the place where
 * that happened, its notes, and the list of the files that its result is made of.
 *
 *     struct job job = {.sink = sink};
 *     struct table *table = job_new(&job, struct table);
 *     read_rows(&job, table, text);
 *     return job_close(&job, notes, NULL);
 *
 * A primitive is a function that takes a job, or a reader of one. After a failure every primitive does nothing: numbers
 * are 0, texts "", arrays NULL with a count of 0 that the same call sets, and LIST_ADD() gives a spare element that is
 * in no list, and no other's. A list itself stays as it was. So a straight line of calls needs no question in between.
 * Three things do: a loop over a count from a file asks job_ok(); a value that was refused, or may be 0 after a
 * failure, is no index, length or divisor, so return before; and a pointer that a primitive gives is not followed
 * unseen. One job is one thread's. */
#ifndef CONUS_BASE_JOB_JOB_H
#define CONUS_BASE_JOB_JOB_H

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#define JOB_ALONE SIZE_MAX /**< The index of a place that is no entry of a list. */

enum { JOB_PLACES = 16, JOB_MESSAGE = 1024, JOB_SPARE = 2048 };

struct job_place {
    const char *word; /**< A key or a path; borrowed. */
    size_t index;     /**< "word[index]", "word index" where the word ends with a space, or JOB_ALONE. */
    size_t end;       /**< Bytes of the message up to and with this place, once there is one. */
};

struct job_block {
    void *data; /**< NULL = given away. */
    size_t size;
    void (*end)(void *); /**< Instead of memory_free(). */
};

/** All 0 is a job that begins. */
struct job {
    conus_status status;
    bool is_limit; /**< The error is a file above the limit of job_read(). */
    char message[JOB_MESSAGE];
    const struct note_sink *sink; /**< Receives the notes, once no attempt is open; NULL = they wait for job_close(). */
    struct notes notes;
    struct file_sums files; /**< The files that the result is made of. */
    struct job_place places[JOB_PLACES];
    size_t depth;
    unsigned attempts; /**< Open ones. */
    struct job_block *blocks;
    size_t block_count, block_capacity;
    uint8_t *chunk; /**< The rest of the arena's last block. */
    size_t chunk_left;
    char nothing[1];     /**< "". */
    uint64_t max_memory; /**< Bytes of a file, and of a volume that is held; 0 = 8 GiB. */
    bool (*progress)(void *user, const char *path, size_t done, size_t total); /**< NULL = no callback. */
    void *progress_user;
    size_t done, total;                      /**< Files. */
    _Alignas(16) uint8_t reserve[JOB_SPARE]; /**< For spare elements where there is no memory. */
    size_t reserve_used;
};

/** Frees all that the job owns; it is all 0 then. */
void job_end(struct job *job);

/** Ends the job at the border to functions that report a status: its notes go to @p notes, its files to @p files, if
 * these are not NULL, and its error becomes the thread's message. */
conus_status job_close(struct job *job, struct notes *notes, struct file_sums *files);

static inline bool job_ok(const struct job *job)
{
    return !job->status;
}

/** Begins a primitive: false where it is to do nothing. */
bool job_step(struct job *job);

/** @p path is read now, and with it @p files of the total: calls progress, and fails where that cancels. */
void job_report(struct job *job, const char *path, size_t files);

/** @name Errors
 * The first one stays. The message is one line: "PLACE: PLACE: what was found, what is allowed". @{ */
void job_fail(struct job *job, conus_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));
#define job_bad(job, ...) job_fail(job, CONUS_ERROR_DATA, __VA_ARGS__)
#define job_refuse(job, ...) job_fail(job, CONUS_ERROR_UNSUPPORTED, __VA_ARGS__)

/** The bridge to functions that report a status: calls one, unless the job has failed, and takes its error, whose
 * message comes behind the places. True where all is well. */
#define JOB_CALL(job, call) (job_step(job) && job_took(job, call))
bool job_took(struct job *job, conus_status status);

/** False where @p memory, which a function without a status gave, is NULL: it found none. */
static inline bool job_need(struct job *job, const void *memory)
{
    return job_took(job, memory ? CONUS_OK : CONUS_ERROR_MEMORY) && memory;
}

/** Errors happen at @p word[@p index] from now on, within the places of before. job_out() goes back to where the mark
 * was made, whatever was entered and not left since. NULL enters no place. */
size_t job_in(struct job *job, const char *word, size_t index);
void job_out(struct job *job, size_t mark);
/** Changes the innermost place: to the next entry. */
void job_at(struct job *job, const char *word, size_t index);
/** @} */

/** @name Notes
 * They have no places. @{ */
void job_put(struct job *job, conus_severity severity, const char *format, ...) __attribute__((format(printf, 3, 4)));
#define job_note(job, ...) job_put(job, CONUS_SEVERITY_NOTE, __VA_ARGS__)
#define job_warn(job, ...) job_put(job, CONUS_SEVERITY_WARNING, __VA_ARGS__)
/** @} */

/** @name Attempts
 * Between job_try() and attempt_end(), errors, notes, places and files are the attempt's. Memory is the job's. What
 * lies outside may be read, but is changed only after the attempt was kept. Both stand in one function. An attempt that
 * begins after a failure does nothing. @{ */
struct attempt {
    size_t notes, files, depth;
    bool is_void; /**< The job had failed before. */
};
struct attempt job_try(struct job *job);

enum attempt_end {
    ATTEMPT_KEEP,   /**< Notes, files and an error become those of what is around it. */
    ATTEMPT_SILENT, /**< An error does; notes and files are forgotten. */
    ATTEMPT_DROP,   /**< All is forgotten, but for an error of memory or of cancelling. That a file is larger than
                       job_read() may read is none of memory. */
    ATTEMPT_TRY     /**< Kept if all is well, else dropped. */
};
/** Ends it. NULL where it was kept; else the message of its error without the places around the attempt, "" where there
 * was none, or where it stays. */
const char *attempt_end(struct job *job, const struct attempt *attempt, enum attempt_end how);

/** Takes the notes of an open attempt out of the job, which keeps them for notes_move(): no sink gets them before.
 * After a failure NULL, and they stay. */
struct notes *attempt_notes(struct job *job, const struct attempt *attempt);
/** @} */

/** @name Memory
 * It lives as long as the job. @{ */
void *job_raw(struct job *job, size_t count, size_t size);
void *job_zeroed(struct job *job, size_t count, size_t size);
#define job_new(job, type) ((type *)job_zeroed(job, 1, sizeof(type)))
/** *count elements, not zeroed; *count becomes 0 where that fails. */
void *job_array(struct job *job, size_t *count, size_t size);
/** A larger block with the elements of @p block, which came from this function or is NULL. NULL, and @p block as it
 * was, on failure. */
void *job_grow(struct job *job, void *block, size_t count, size_t size);
/** Frees a block of these functions before the job ends, unless it is small. Not after job_release() of it. */
void job_drop(struct job *job, void *block);
/** Takes over @p data of memory_raw() and its kind; NULL, and the data is freed, after a failure. */
void *job_adopt(struct job *job, void *data);
/** Calls end(thing) when the job ends; at once after a failure. */
void job_own(struct job *job, void (*end)(void *), void *thing);
/** Gives @p array of @p size bytes to the caller, to memory_free(). What lies in the arena is copied. */
void *job_give(struct job *job, void *array, size_t size);

/** Frees what was allocated since the mark was made, except older blocks that have grown. */
struct job_mark {
    size_t blocks, chunk_left;
    uint8_t *chunk;
};
struct job_mark job_mark(const struct job *job);
void job_release(struct job *job, struct job_mark mark);

/** Texts, never NULL. */
char *job_format(struct job *job, const char *format, ...) __attribute__((format(printf, 2, 3)));
char *job_copy(struct job *job, struct text text);
/** The same with its size, which is 0 after a failure. */
struct text job_text(struct job *job, struct text text);
/** A name for results, trimmed, as text_to_utf8() makes it; NULL where nothing is left. */
char *job_name(struct job *job, struct text text);
/** @} */

/** @name Lists
 * A list that grows is a pointer, a count and a capacity, all 0 at first. @{ */
#define LIST(type)                                                                                                     \
    struct {                                                                                                           \
        type *at;                                                                                                      \
        size_t count, capacity;                                                                                        \
    }
/** A new element, all 0, at the end of the list; after a failure job_spare(). Keep this pointer: after a failure there
 * is none at count - 1. It is valid until the next call. */
#define LIST_ADD(job, list)                                                                                            \
    ((__typeof__((list)->at))list_add(job, &(list)->at, &(list)->count, &(list)->capacity, sizeof *(list)->at))
/** @p array points to the pointer to the elements. */
void *list_add(struct job *job, void *array, size_t *count, size_t *capacity, size_t size);
/** @p size bytes, all 0, of a failed job: something to write to that is nothing else's. Of the reserve where there is
 * no memory, which begins again when it is used up: at most JOB_SPARE. */
void *job_spare(struct job *job, size_t size);
/** @} */

/** @name Files @{ */
/** The path file_beside() of @p path and @p name. */
char *job_beside(struct job *job, const char *path, const char *name);
bool job_has_file(struct job *job, const char *path);
/** As names_list(); none after a failure. */
struct names job_names(struct job *job, const char *folder, const char *ending);
/** The bytes of a file that may not be larger than @p limit; @p option as for file_read_open(). The path is a place,
 * which the caller enters before: messages of openers do not name it. */
struct bytes job_read(struct job *job, const char *path, uint64_t limit, const char *option);
struct bytes job_read_open(struct job *job, const struct open_file *file, uint64_t limit, const char *option);
/** The result is made of @p content, the bytes of @p path. */
void job_made_of(struct job *job, const char *path, const struct bytes *content);
/** @} */

/* The one reader: of bytes in memory, of a file, or of what gzip packs in a file; block by block, so that no file is
 * held twice. No read passes the end.
 *
 *     struct reader r = reader_on(job, &file);
 *     struct text line;
 *     while (reader_line(&r, &line)) {
 *
 * A text or pointer that it gives is good until the next call that reads: who keeps it copies it into the job. Builds
 * with AddressSanitizer read blocks of 64 bytes, each elsewhere, so that a text kept without a copy is found. After a
 * failure of the job nothing is left and the position is the end: a loop over what is left stops. */

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
