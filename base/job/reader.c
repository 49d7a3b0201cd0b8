/* SPDX-License-Identifier: BSD-3-Clause */
/* Bytes out of memory, files and gzip, block by block. */
#include "base/job/job.h"

#include "base/byte_order.h"
#include "base/memory.h"

#include <string.h>
#include <zlib.h>

#if defined(__SANITIZE_ADDRESS__)
enum { BLOCK = 64, FIRST = 64, BLOCKS_MOVE = 1 };
#else
enum { BLOCK = 1 << 20, FIRST = 1 << 12, BLOCKS_MOVE = 0 }; /* many read a header only */
#endif
enum {
    MAGIC = 3, /* Bytes that gzip_is() looks at. */
    LINE_LIMIT = 1 << 24,
    INFLATE_RATIO = 1032 /* Bytes that deflate makes of one, at most. */
};

/* What a reader takes its blocks from: a file, and what gzip packs in it. */
struct reader_source {
    struct open_file file;
    uint64_t file_at;      /* bytes of the file that were read */
    bool is_packed, ended; /* ended: there is no more */
    z_stream z;
    uint8_t *packed; /* [BLOCK] bytes of the file that zlib works through; owned, as the window is, since memory of the
                        job may be released between two reads */
    uint8_t *window; /* [capacity] the block at hand */
    size_t capacity;
};

static void close_source(void *user)
{
    struct reader_source *source = user;
    if (source->is_packed) {
        (void)inflateEnd(&source->z);
    }
    memory_free(source->packed);
    memory_free(source->window);
}

/* The next bytes of the file as it is stored, at most `space`; 0 at its end. */
static size_t read_stored(struct job *job, struct reader_source *source, uint8_t *to, size_t space)
{
    size_t size = smaller_of(source->file.before.size - source->file_at, space);
    if (!size || !JOB_CALL(job, file_part_here(to, &source->file, source->file_at, size))) {
        return 0;
    }
    source->file_at += size;
    return size;
}

/* Only zeros may follow the last member. */
static void check_padding(struct job *job, struct reader_source *source)
{
    z_stream *z = &source->z;
    do {
        for (uInt i = 0; i < z->avail_in; i++) {
            if (z->next_in[i]) {
                job_bad(job, "gzip: %llu bytes after the end of the packed data, allowed are zeros",
                        (unsigned long long)(z->avail_in + source->file.before.size - source->file_at));
                return;
            }
        }
        z->next_in = source->packed;
        z->avail_in = (uInt)read_stored(job, source, source->packed, BLOCK);
    } while (z->avail_in);
}

/* Whether another member of gzip follows the one that has ended. */
static bool next_member(struct job *job, struct reader_source *source)
{
    z_stream *z = &source->z;
    if (z->avail_in < MAGIC) { /* its first bytes may lie in two blocks */
        memmove(source->packed, z->next_in, z->avail_in);
        z->next_in = source->packed;
        z->avail_in += (uInt)read_stored(job, source, source->packed + z->avail_in, BLOCK - z->avail_in);
    }
    return gzip_is(z->next_in, z->avail_in) && inflateReset(z) == Z_OK;
}

/* The next unpacked bytes, at most `space`; 0 at the end. */
static size_t read_packed(struct job *job, struct reader_source *source, uint8_t *to, size_t space)
{
    z_stream *z = &source->z;
    z->next_out = to;
    z->avail_out = (uInt)space;
    while (z->avail_out && !source->ended && job_ok(job)) {
        if (!z->avail_in) {
            z->next_in = source->packed;
            z->avail_in = (uInt)read_stored(job, source, source->packed, source->file_at ? BLOCK : FIRST);
        }
        int code = z->avail_in ? inflate(z, Z_NO_FLUSH) : Z_BUF_ERROR;
        if (code == Z_STREAM_END) {
            source->ended = !next_member(job, source);
            if (source->ended) {
                check_padding(job, source);
            }
        } else if (code == Z_BUF_ERROR) {
            source->ended = true;
            job_bad(job, "gzip: cut off, an intact file is needed");
        } else if (code == Z_MEM_ERROR) {
            job_fail(job, CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
        } else if (code != Z_OK) {
            job_bad(job, "gzip: damaged (%s), an intact file is needed", z->msg ? z->msg : "preset dictionary");
        }
    }
    return job_ok(job) ? space - z->avail_out : 0;
}

static void begin_unpacking(struct job *job, struct reader_source *source)
{
    enum { GZIP = 16 + MAX_WBITS };
    source->packed = job_step(job) ? memory_raw(BLOCK, 1) : NULL;
    if (!job_need(job, source->packed)) {
        return;
    }
    source->is_packed = inflateInit2(&source->z, GZIP) == Z_OK;
    if (!source->is_packed) {
        job_fail(job, CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
    }
}

struct reader reader_on(struct job *job, const struct open_file *file)
{
    struct reader r = {.job = job};
    struct reader_source *source = job_new(job, struct reader_source);
    uint8_t head[MAGIC];
    if (!source) {
        return r;
    }
    source->file = *file;
    job_own(job, close_source, source);
    size_t size = read_stored(job, source, head, MAGIC);
    source->file_at = 0;
    if (gzip_is(head, size)) {
        begin_unpacking(job, source);
    }
    r.source = job_ok(job) ? source : NULL;
    return r;
}

struct reader reader_of(struct job *job, struct text text)
{
    const uint8_t *data = (const uint8_t *)(text.size ? text.data : "");
    return (struct reader){.job = job, .at = data, .end = data + text.size, .end_offset = text.size};
}

uint64_t reader_at(const struct reader *r)
{
    return r->end_offset - (job_ok(r->job) ? (uint64_t)(r->end - r->at) : 0);
}

/* A window with room for `count` bytes, beginning with the `left` bytes that are at hand; NULL on failure. */
static uint8_t *move_window(struct reader *r, size_t left, size_t count)
{
    struct reader_source *source = r->source;
    bool is_first_full = source->window && source->capacity < BLOCK && r->end_offset >= source->capacity;
    bool moves = !source->window || source->capacity < count || is_first_full || BLOCKS_MOVE;
    size_t capacity = moves ? count + (source->window ? BLOCK : FIRST) : source->capacity;
    uint8_t *window = moves ? memory_raw(capacity, 1) : source->window;
    if (!window) {
        job_need(r->job, window);
        return NULL;
    }
    if (left) {
        memmove(window, r->at, left);
    }
    if (window != source->window) {
        memory_free(source->window);
    }
    source->window = window;
    source->capacity = capacity;
    r->at = window;
    r->end = window + left;
    return window;
}

bool reader_has_more(struct reader *r, size_t count)
{
    struct reader_source *source = r->source;
    size_t left = (size_t)(r->end - r->at);
    while (left < count && source && !source->ended && job_step(r->job)) {
        uint8_t *window = move_window(r, left, (size_t)smaller_of(reader_most(r), count));
        if (!window) {
            break;
        }
        size_t got =
            (source->is_packed ? read_packed : read_stored)(r->job, source, window + left, source->capacity - left);
        source->ended = source->ended || !got;
        left += got;
        r->end += got;
        r->end_offset += got;
    }
    return left >= count && job_ok(r->job);
}

const uint8_t *reader_take(struct reader *r, size_t count)
{
    if (!reader_has(r, count)) {
        job_bad(r->job, "cut off at byte %llu, where %zu more are needed", (unsigned long long)reader_at(r), count);
        return NULL;
    }
    r->at += count;
    return job_step(r->job) ? r->at - count : NULL;
}

const uint8_t *reader_some(struct reader *r, uint64_t most, size_t each, size_t *size)
{
    *size = 0;
    if (most < each || !reader_has(r, each)) {
        return NULL;
    }
    *size = smaller_of((uint64_t)(r->end - r->at), most) / each * each;
    r->at += *size;
    return r->at - *size;
}

struct text reader_keep(struct reader *r, size_t count)
{
    const uint8_t *data = reader_take(r, count);
    return job_text(r->job, (struct text){(const char *)data, data ? count : 0});
}

void reader_skip(struct reader *r, uint64_t count)
{
    size_t size = 1;
    while (count && size) {
        reader_some(r, count, 1, &size);
        count -= size;
    }
    if (count) {
        job_bad(r->job, "cut off at byte %llu, where %llu more are needed", (unsigned long long)reader_at(r),
                (unsigned long long)count);
    }
}

uint64_t reader_most(const struct reader *r)
{
    const struct reader_source *source = r->source;
    const uint64_t at_hand = (uint64_t)(r->end - r->at);
    if (!job_ok(r->job)) {
        return 0;
    }
    if (!source || source->ended) {
        return at_hand;
    }
    uint64_t stored = source->file.before.size - source->file_at;
    return at_hand + (source->is_packed ? (stored + source->z.avail_in + 1) * INFLATE_RATIO : stored);
}

bool reader_line(struct reader *r, struct text *line)
{
    size_t length = 0;
    *line = (struct text){"", 0};
    while (reader_has(r, length + 1) && r->at[length] != '\n') {
        if (++length > LINE_LIMIT) {
            job_bad(r->job, "found a line of more than %d bytes", LINE_LIMIT);
        }
    }
    bool ended = reader_has(r, length + 1);
    if (!job_ok(r->job) || (!ended && !length)) {
        return false;
    }
    const char *data = (const char *)r->at;
    r->at += length + ended;
    bool returns = length && data[length - 1] == '\r';
    *line = (struct text){data, length - returns};
    return job_step(r->job);
}

static bool is_space(uint8_t c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

bool reader_word(struct reader *r, struct text *word)
{
    size_t length = 0;
    *word = (struct text){"", 0};
    while (reader_has(r, 1) && is_space(*r->at)) {
        r->at++;
    }
    while (reader_has(r, length + 1) && !is_space(r->at[length])) {
        if (++length > LINE_LIMIT) {
            job_bad(r->job, "found a word of more than %d bytes", LINE_LIMIT);
        }
    }
    if (!job_step(r->job) || !length) {
        return false;
    }
    *word = (struct text){(const char *)r->at, length};
    r->at += length;
    return true;
}
