/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a file block by block, through zlib where it is packed. */
#include "base/formats/byte_stream.h"

#include "base/files/inputs.h"
#include "base/formats/gzip.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"
#include "base/threads.h"

#include <assert.h>
#include <errno.h>
#include <nettle/sha2.h>
#include <string.h>
#include <zlib.h>

enum { STORED_BLOCK = 1 << 18, MAGIC_SIZE = 3, INFLATE_RATIO = 1032 /* a match of 258 bytes takes at least 2 bits */ };

struct byte_source {
    int descriptor; /* -1: `memory` has the bytes */
    struct file_state before;
    const uint8_t *memory;
    uint64_t stored_left; /* bytes that were not read yet */
    struct sha256_ctx sum;
    uint8_t *window; /* unpacked bytes; stream->data is in it */
    uint8_t *other;  /* another one, of what is not packed: its bytes are summed up while the next ones are read */
    size_t capacity;
    struct thread_piece summing; /* of the `fresh_size` bytes at `fresh` */
    const uint8_t *fresh;
    size_t fresh_size;
    z_stream z;
    bool inflates;   /* z is to be ended */
    bool ended;      /* after the last member of gzip */
    uint8_t *stored; /* [STORED_BLOCK] of gzip: what zlib is fed with */
};

/* Reads as many stored bytes as there are, at most `most`, which are yet to be summed up. */
static conus_status read_unsummed(struct byte_source *source, uint8_t *out, size_t most)
{
    size_t size = smaller_of(most, source->stored_left);
    for (size_t got = 0; got < size;) {
        ptrdiff_t n = (ptrdiff_t)(size - got);
        if (source->descriptor < 0) {
            memcpy(out, source->memory, size);
            source->memory += size;
        } else {
            n = system_read(source->descriptor, out + got, size - got);
        }
        if (n == 0 || (n < 0 && errno != EINTR)) {
            return fail(CONUS_ERROR_IO, "%s", n ? text_error(errno) : FILE_CHANGED);
        }
        got += n > 0 ? (size_t)n : 0;
    }
    source->stored_left -= size;
    return CONUS_OK;
}

static conus_status read_stored(struct byte_source *source, uint8_t *out, size_t most)
{
    size_t size = smaller_of(most, source->stored_left);
    conus_status status = read_unsummed(source, out, most);
    sha256_update(&source->sum, status ? 0 : size, out);
    return status;
}

static void sum_fresh(void *user, size_t piece)
{
    struct byte_source *source = user;
    (void)piece;
    sha256_update(&source->sum, source->fresh_size, source->fresh);
}

/* Reads into the other window, which becomes the window, behind what is kept. Its sum is made while the caller looks at
 * the bytes, and while the next ones are read. */
static conus_status read_ahead(struct byte_source *source, const struct byte_stream *stream, size_t size)
{
    enum { WORTH_THREAD = 1 << 17 };
    uint8_t *window = source->other;
    source->other = source->window;
    source->window = window;
    memcpy(window, stream->data, stream->size);
    conus_status status = read_unsummed(source, window + stream->size, size);
    threads_wait(&source->summing);
    if (!status) {
        source->fresh = window + stream->size;
        source->fresh_size = size;
        if (threads_for(size, WORTH_THREAD) > 1) {
            threads_start(&source->summing, sum_fresh, source, 0);
        } else {
            sum_fresh(source, 0);
        }
    }
    return status;
}

/* Fills the packed bytes up, those that zlib has not seen first. */
static conus_status feed_input(struct byte_source *source)
{
    size_t kept = source->z.avail_in;
    if (kept) {
        memmove(source->stored, source->z.next_in, kept);
    }
    size_t more = smaller_of(STORED_BLOCK - kept, source->stored_left);
    conus_status status = read_stored(source, source->stored + kept, more);
    source->z.next_in = source->stored;
    source->z.avail_in = (uInt)(kept + (status ? 0 : more));
    return status;
}

/* Only zeros may follow the last member. */
static conus_status check_padding(struct byte_source *source)
{
    conus_status status = CONUS_OK;
    while (!status && (source->z.avail_in || source->stored_left)) {
        for (uInt i = 0; i < source->z.avail_in; i++) {
            if (source->z.next_in[i]) {
                return fail(CONUS_ERROR_DATA, "gzip: %llu bytes after the end of the packed data, allowed are zeros",
                            (unsigned long long)(source->z.avail_in + source->stored_left));
            }
        }
        source->z.avail_in = 0;
        status = feed_input(source);
    }
    return status;
}

static conus_status next_member(struct byte_source *source)
{
    conus_status status = source->z.avail_in < MAGIC_SIZE ? feed_input(source) : CONUS_OK;
    if (!status && gzip_is(source->z.next_in, source->z.avail_in)) {
        return inflateReset(&source->z) == Z_OK ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
    }
    source->ended = true;
    return status ? status : check_padding(source);
}

/* Unpacks up to `size` bytes; fewer only at the end. */
static conus_status inflate_some(struct byte_source *source, uint8_t *out, size_t size, uint64_t position, size_t *got)
{
    conus_status status = CONUS_OK;
    source->z.next_out = out;
    source->z.avail_out = (uInt)size;
    while (!status && !source->ended && source->z.avail_out) {
        status = source->z.avail_in ? CONUS_OK : feed_input(source);
        bool cut = !status && !source->z.avail_in;
        int code = status || cut ? Z_OK : inflate(&source->z, Z_NO_FLUSH);
        unsigned long long at = position + (size - source->z.avail_out);
        if (cut) {
            status = fail(CONUS_ERROR_DATA, "gzip: cut off after %llu unpacked bytes", at);
        } else if (code == Z_STREAM_END) {
            status = next_member(source);
        } else if (code == Z_MEM_ERROR) {
            status = fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
        } else if (code != Z_OK && code != Z_BUF_ERROR) {
            status = fail(CONUS_ERROR_DATA, "gzip: damaged near unpacked byte %llu (%s), an intact file is needed", at,
                          source->z.msg ? source->z.msg : "preset dictionary");
        }
    }
    *got = size - source->z.avail_out;
    return status;
}

conus_status byte_stream_need(struct byte_stream *stream, size_t count)
{
    assert(count <= BYTE_STREAM_BLOCK);
    struct byte_source *source = stream->source;
    if (stream->size >= count) {
        return CONUS_OK;
    }
    size_t room = source->capacity - stream->size;
    size_t got = smaller_of(room, source->stored_left);
    conus_status status;
    if (stream->is_packed) {
        memmove(source->window, stream->data, stream->size);
        status = inflate_some(source, source->window + stream->size, room, stream->position + stream->size, &got);
    } else {
        status = read_ahead(source, stream, got);
    }
    stream->data = source->window;
    stream->size += status ? 0 : got;
    return status;
}

uint64_t byte_stream_most(const struct byte_stream *stream)
{
    const struct byte_source *source = stream->source;
    uint64_t stored = source->stored_left + source->z.avail_in;
    uint64_t most;
    if (!stream->is_packed) {
        return stream->size + source->stored_left;
    }
    bool fits = !__builtin_mul_overflow(stored + 1, (uint64_t)INFLATE_RATIO, &most) &&
                !__builtin_add_overflow(most, (uint64_t)stream->size, &most);
    return fits ? most : UINT64_MAX;
}

conus_status byte_stream_sum(char out[65], struct byte_stream *stream)
{
    struct byte_source *source = stream->source;
    struct file_state now;
    if (source->descriptor >= 0 &&
        (!file_state_of(&now, source->descriptor) || !file_state_equal(&now, &source->before))) {
        return fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    threads_wait(&source->summing);
    file_sha256_end(out, &source->sum);
    return CONUS_OK;
}

void byte_stream_finish(struct byte_stream *stream)
{
    struct byte_source *source = stream->source;
    if (source) {
        threads_wait(&source->summing);
        if (source->inflates) {
            inflateEnd(&source->z);
        }
        if (source->descriptor >= 0) {
            close(source->descriptor);
        }
        memory_free(source->window);
        memory_free(source->other);
        memory_free(source->stored);
        memory_free(source);
    }
    *stream = (struct byte_stream){0};
}

/* Reads the first bytes of a new source, which say whether it is packed. */
static conus_status stream_start(struct byte_stream *stream)
{
    struct byte_source *source = stream->source;
    uint8_t magic[MAGIC_SIZE];
    size_t size = smaller_of(MAGIC_SIZE, source->stored_left);
    uint64_t stored = source->stored_left;
    sha256_init(&source->sum);
    conus_status status = read_stored(source, magic, size);
    stream->is_packed = !status && gzip_is(magic, size);
    source->capacity = stream->is_packed ? BYTE_STREAM_BLOCK : smaller_of(BYTE_STREAM_BLOCK, stored);
    source->window = status ? NULL : memory_raw(source->capacity, 1);
    if (!source->window) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    stream->data = source->window;
    if (!stream->is_packed) {
        source->other = memory_raw(source->capacity, 1);
        memcpy(source->window, magic, size);
        stream->size = size;
        return source->other ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    source->stored = memory_raw(STORED_BLOCK, 1);
    if (!source->stored) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(source->stored, magic, size);
    source->z.next_in = source->stored;
    source->z.avail_in = (uInt)size;
    source->inflates = inflateInit2(&source->z, 16 + MAX_WBITS) == Z_OK;
    return source->inflates ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "gzip: no memory to unpack");
}

static conus_status make(struct byte_stream *out, const struct byte_source *model)
{
    struct byte_stream stream = {.source = memory_copy(model, 1, sizeof *model)};
    conus_status status = stream.source ? stream_start(&stream) : CONUS_ERROR_MEMORY;
    if (status && stream.source) {
        stream.source->descriptor = -1; /* the caller's to close */
        byte_stream_finish(&stream);
    }
    *out = status ? *out : stream;
    return status;
}

conus_status byte_stream_of(struct byte_stream *out, const uint8_t *data, size_t size)
{
    return make(out, &(const struct byte_source){.descriptor = -1, .memory = data, .stored_left = size});
}

conus_status byte_stream_open(struct byte_stream *out, const char *path)
{
    struct system_stat info;
    struct byte_source source = {.descriptor = system_open(path, SYSTEM_READ | SYSTEM_AT_ONCE)};
    bool found = source.descriptor >= 0 && system_stat_open(&info, source.descriptor);
    conus_status status = found ? CONUS_OK : fail(CONUS_ERROR_IO, "cannot open: %s", text_error(errno));
    if (!status && info.kind != SYSTEM_FILE) {
        status = fail(CONUS_ERROR_IO, "cannot read: a regular file is needed");
    }
    if (!status) {
        inputs_read(path, &info);
        file_state_take(&source.before, &info);
        source.stored_left = source.before.size;
        status = make(out, &source);
    }
    if (status && source.descriptor >= 0) {
        close(source.descriptor);
    }
    return status;
}
