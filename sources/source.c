/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens files, and unpacks their first bytes. */
#include "sources/source.h"

#include "base/formats/packed.h"
#include "base/memory.h"

/* Unpacks the first bytes where they are packed; of damaged ones there are none. */
static conus_status look_at_head(struct source *source, const char *path)
{
    const struct bytes *stored = &source->stored;
    conus_status status = CONUS_OK;
    source->is_packed = gzip_is(stored->data, stored->size);
    if (source->is_packed) {
        status = gzip_head(&source->unpacked, stored->data, stored->size, HEAD_SIZE);
    }
    source->head = head_of(path, source->is_packed ? &source->unpacked : stored);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

static void close_source(void *source)
{
    source_close(source);
}

/* Looks at the head of a source whose file was opened. */
static struct source *begin_source(struct job *job, struct source *source)
{
    source->is_open = true;
    job_own(job, close_source, source);
    bool has_looked = JOB_CALL(job, file_read_here(&source->stored, &source->file, HEAD_SIZE, UINT64_MAX, "")) &&
                      JOB_CALL(job, look_at_head(source, source->file.path));
    return has_looked ? source : NULL;
}

void source_keys_read(struct job *job, struct source_keys *out, const char *text, enum key_kind kind)
{
    const size_t place = job_in(job, text, JOB_ALONE);
    if (!keys_read(out, text, kind)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s", out->why);
    }
    job_out(job, place);
    out->path = job_copy(job, (struct text){text, out->length});
}

void source_keys_refuse(struct job *job, const struct source_keys *keys, uint64_t allowed)
{
    char why[KEYS_WHY];
    if (!keys_fit(why, keys, allowed)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s", why);
    }
}

struct source *source_open(struct job *job, const char *path)
{
    struct source *source = job_new(job, struct source);
    bool is_open = source && JOB_CALL(job, file_open_here(&source->file, path));
    return is_open ? begin_source(job, source) : NULL;
}

struct source *source_of_memory(struct job *job, const char *path, struct text bytes)
{
    struct source *source = job_new(job, struct source);
    if (!source) {
        return NULL;
    }
    source->file.path = path;
    source->file.memory = (const uint8_t *)(bytes.size ? bytes.data : "");
    source->file.before.size = bytes.size;
    return begin_source(job, source);
}

struct reader source_reader(struct job *job, const struct source *source)
{
    return job_ok(job) ? reader_on(job, &source->file) : (struct reader){.job = job};
}

struct bytes source_whole(struct job *job, struct source *source)
{
    struct bytes stored = {0};
    const uint64_t limit = memory_limit(job->max_memory);
    if (!source || !JOB_CALL(job, file_read_here(&stored, &source->file, SIZE_MAX, limit, FILE_MAX_MEMORY))) {
        return (struct bytes){0};
    }
    bytes_finish(&source->whole);
    if (source->is_packed) {
        (void)JOB_CALL(job, gzip_unpack_all(&source->whole, stored.data, stored.size, limit));
        bytes_finish(&stored);
    } else {
        source->whole = stored;
    }
    return source->whole;
}

struct bytes source_bytes(struct job *job, struct source *source, uint64_t limit)
{
    if (!job_ok(job)) {
        return (struct bytes){0}; /* there may be no source */
    }
    const struct bytes bytes = job_read_open(job, &source->file, limit, FILE_MAX_MEMORY);
    threads_wait(&source->summing);
    if (job_ok(job)) {
        file_sha256(source->sha256, &bytes);
    }
    return bytes;
}

static bool is_unwanted(void *source)
{
    return ((struct source *)source)->stops;
}

/* Where a byte cannot be read there is no sum: the next reader tries again, and gets the reason. */
static void sum_bytes(void *user, size_t piece)
{
    struct source *source = user;
    (void)piece;
    (void)file_sha256_open(source->sha256, &source->file, is_unwanted, source);
}

void source_sum_ahead(struct source *source)
{
    enum { WORTH_THREAD = 1 << 17 };
    if (source && threads_for(source->file.before.size, WORTH_THREAD) > 1) {
        threads_start(&source->summing, sum_bytes, source, 0);
    }
}

const char *source_sum(struct job *job, struct source *source)
{
    if (!job_step(job)) {
        return job->nothing; /* there may be no source */
    }
    threads_wait(&source->summing);
    bool has_sum = source->sha256[0] || JOB_CALL(job, file_sha256_open(source->sha256, &source->file, NULL, NULL));
    return has_sum ? source->sha256 : job->nothing;
}

void source_made_of(struct job *job, struct source *source)
{
    const char *sha256 = source_sum(job, source);
    (void)JOB_CALL(job, file_sums_put(&job->files, source->file.path, sha256));
}

/* Opens a file; `out` is to be closed, also on failure. */
static conus_status open_file(struct source *out, const char *path)
{
    *out = (struct source){0};
    conus_status status = file_open(&out->file, path);
    out->is_open = !status;
    status = status ? status : file_read_open(&out->stored, &out->file, HEAD_SIZE, UINT64_MAX, "");
    return status ? status : look_at_head(out, path);
}

conus_status source_of(struct source *out, const char *path, const struct bytes *stored)
{
    *out = (struct source){.stored = {stored->data, stored->size < HEAD_SIZE ? stored->size : HEAD_SIZE}};
    conus_status status = look_at_head(out, path);
    out->stored = (struct bytes){0}; /* not its own */
    return status;
}

conus_status source_open_atlas(struct source *out, const char *path)
{
    struct source_keys keys;
    bool is_known = keys_read(&keys, path, KEYS_SCENE) && !(keys.given & ~KEY_BIT(KEY_MAP));
    char *plain = memory_text(path, keys.length);
    *out = (struct source){0};
    conus_status status = plain ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (is_known && plain && file_exists(plain)) {
        status = open_file(out, plain);
    }
    out->path = plain;
    if (status || (keys.count && source_scene(out) != FORMAT_CIFTI)) {
        source_close(out);
    }
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

char source_first(const struct source *source)
{
    return source->head.start.size && !source->is_packed ? source->head.start.data[0] : '\0';
}

enum format_id source_scene(const struct source *source)
{
    const struct format *format = source->is_open ? format_find(&source->head, ROLE_SCENE) : NULL;
    return format && (format->id == FORMAT_CIFTI || !source->is_packed) ? format->id : FORMAT_OTHER;
}

void source_close(struct source *source)
{
    if (!source) {
        return;
    }
    source->stops = true;
    threads_wait(&source->summing);
    if (source->is_open) {
        file_close(&source->file);
    }
    bytes_finish(&source->stored);
    bytes_finish(&source->unpacked);
    bytes_finish(&source->whole);
    memory_free(source->path);
    *source = (struct source){0};
}

conus_status source_find(const struct format **out, const char *path, unsigned roles)
{
    struct source source = {.head = {.path = path, .is_folder = file_is_folder(path)}};
    conus_status status = source.head.is_folder ? CONUS_OK : open_file(&source, path);
    *out = status ? NULL : format_find(&source.head, roles);
    source_close(&source);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

const struct format *source_format(struct job *job, const char *path, unsigned roles)
{
    const struct format *format = NULL;
    (void)JOB_CALL(job, source_find(&format, path, roles));
    return format;
}
