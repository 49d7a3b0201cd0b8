/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens files, and unpacks their first bytes. */
#include "sources/source.h"

#include "base/formats/gzip.h"
#include "base/memory.h"
#include "sources/map_choice.h"

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

struct source *source_open(struct job *job, const char *path)
{
    struct source *source = job_new(job, struct source);
    if (!source || !JOB_CALL(job, file_open_here(&source->file, path))) {
        return NULL;
    }
    source->is_open = true;
    job_own(job, close_source, source);
    bool has_looked = JOB_CALL(job, file_read_here(&source->stored, &source->file, HEAD_SIZE, UINT64_MAX, "")) &&
                      JOB_CALL(job, look_at_head(source, path));
    return has_looked ? source : NULL;
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

void source_made_of(struct job *job, const struct source *source)
{
    (void)JOB_CALL(job, file_sums_add_open(&job->files, &source->file));
}

conus_status source_look(struct source *out, const char *path)
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
    struct text map = {0};
    char *plain = NULL;
    *out = (struct source){0};
    conus_status status = map_choice_split(&plain, &map, path);
    if (!status && file_exists(plain)) {
        status = source_look(out, plain);
    }
    out->path = plain;
    if (status || (map.size && source_scene(out) != FORMAT_CIFTI)) {
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
    conus_status status = source.head.is_folder ? CONUS_OK : source_look(&source, path);
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
