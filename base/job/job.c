/* SPDX-License-Identifier: BSD-3-Clause */
/* What a piece of work owns: its error with places, notes, attempts, memory. */
#include "base/job/job.h"

#include "base/memory.h"
#include "base/path.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum {
    CHUNK = 1 << 16, /* Bytes of a block of the arena, */
    SMALL = 1 << 13, /* and of the largest thing in it. */
    ALIGNMENT = 16
};

#if defined(__SANITIZE_ADDRESS__)
#define JOB_APART true /* A block for each thing: the sanitizer is blind inside one. */
#elif defined(__has_feature)
#define JOB_APART __has_feature(address_sanitizer)
#else
#define JOB_APART false
#endif

/* Begins the message with the places, each with ": " behind it; gives their length. */
static size_t write_places(struct job *job)
{
    size_t used = 0;
    job->message[0] = '\0';
    for (size_t i = 0; i < job->depth; i++) {
        struct job_place *place = &job->places[i];
        const size_t end = strlen(place->word);
        const bool is_counted = end && place->word[end - 1] == ' ';
        char *to = job->message + used;
        snprintf(to, sizeof job->message - used,
                 place->index == JOB_ALONE ? "%s: "
                 : is_counted              ? "%s%zu: "
                                           : "%s[%zu]: ",
                 place->word, place->index);
        text_make_plain(to, "");
        place->end = used += strlen(to);
    }
    return used;
}

void job_fail(struct job *job, conus_status status, const char *format, ...)
{
    if (job->status) {
        return;
    }
    job->status = status;
    size_t used = write_places(job);
    va_list args;
    va_start(args, format);
    vsnprintf(job->message + used, sizeof job->message - used, format, args);
    va_end(args);
    text_make_plain(job->message + used, "");
}

/* The sink gets the notes that it has not had, unless an attempt may still be dropped. */
static void tell_sink(struct job *job)
{
    for (size_t i = 0; job->sink && !job->attempts && i < job->notes.count; i++) {
        struct note_mark *mark = &job->notes.marks[i];
        if (!mark->is_passed && job->sink->log) {
            job->sink->log(job->sink->user, &(const conus_note){mark->severity, job->sink->path, job->notes.lines[i]});
        }
        mark->is_passed = true;
    }
}

void job_report(struct job *job, const char *path, size_t files)
{
    if (job_step(job) && job->progress && !job->progress(job->progress_user, path, job->done, job->total)) {
        job_fail(job, CONUS_ERROR_CANCELLED, "%s: cancelled before it was read", path);
    }
    job->done += files;
}

bool job_took(struct job *job, conus_status status)
{
    if (status) {
        job_fail(job, status, "%s", conus_message());
    }
    tell_sink(job);
    return !status;
}

size_t job_in(struct job *job, const char *word, size_t index)
{
    if (!word) {
        return job->depth;
    }
    assert(job->depth < JOB_PLACES);
    job->places[job->depth] = (struct job_place){.word = word, .index = index};
    return job->depth++;
}

void job_out(struct job *job, size_t mark)
{
    job->depth = mark;
}

void job_at(struct job *job, const char *word, size_t index)
{
    assert(job->depth);
    job->places[job->depth - 1] = (struct job_place){.word = word, .index = index};
}

void job_put(struct job *job, conus_severity severity, const char *format, ...)
{
    char text[512];
    if (!job_step(job)) {
        return;
    }
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    job_took(job, notes_put(&job->notes, severity, "%s", text));
}

struct attempt job_try(struct job *job)
{
    job->attempts++;
    return (struct attempt){job->notes.count, job->files.count, job->depth, !job_ok(job)};
}

/* Forgets notes and files of the attempt. */
static void cut_attempt(struct job *job, const struct attempt *attempt)
{
    notes_cut(&job->notes, attempt->notes);
    file_sums_cut(&job->files, attempt->files);
}

/* Forgets the attempt, whose places go, and its error, unless that stays. */
static const char *drop_attempt(struct job *job, const struct attempt *attempt)
{
    bool stays = (job->status == CONUS_ERROR_MEMORY && !job->is_limit) || job->status == CONUS_ERROR_CANCELLED;
    if (attempt->is_void || stays) {
        return "";
    }
    const bool had = job->status != CONUS_OK;
    size_t around = attempt->depth ? job->places[attempt->depth - 1].end : 0;
    cut_attempt(job, attempt);
    job->depth = attempt->depth;
    job->status = CONUS_OK;
    job->is_limit = false;
    return had ? job_format(job, "%s", job->message + around) : "";
}

const char *attempt_end(struct job *job, const struct attempt *attempt, enum attempt_end how)
{
    job->attempts--;
    if (how == ATTEMPT_DROP || (how == ATTEMPT_TRY && !job_ok(job))) {
        return drop_attempt(job, attempt);
    }
    if (how == ATTEMPT_SILENT) {
        cut_attempt(job, attempt);
    }
    tell_sink(job);
    return NULL;
}

static void finish_notes(void *notes)
{
    notes_finish(notes);
}

struct notes *attempt_notes(struct job *job, const struct attempt *attempt)
{
    struct notes *aside = job_new(job, struct notes);
    if (!aside) {
        return NULL;
    }
    job_own(job, finish_notes, aside);
    for (size_t i = attempt->notes; i < job->notes.count; i++) {
        (void)JOB_CALL(job, notes_put(aside, job->notes.marks[i].severity, "%s", job->notes.lines[i]));
    }
    notes_cut(&job->notes, attempt->notes);
    return job_ok(job) ? aside : NULL;
}

static void end_block(const struct job_block *block)
{
    if (block->end) {
        block->end(block->data);
    } else {
        memory_free(block->data);
    }
}

void job_release(struct job *job, struct job_mark mark)
{
    while (job->block_count > mark.blocks) {
        end_block(&job->blocks[--job->block_count]);
    }
    job->chunk = mark.chunk;
    job->chunk_left = mark.chunk_left;
}

struct job_mark job_mark(const struct job *job)
{
    return (struct job_mark){job->block_count, job->chunk_left, job->chunk};
}

void job_end(struct job *job)
{
    assert(!job->attempts);
    job_release(job, (struct job_mark){0});
    memory_free(job->blocks);
    notes_finish(&job->notes);
    file_sums_finish(&job->files);
    *job = (struct job){0};
}

conus_status job_close(struct job *job, struct notes *notes, struct file_sums *files)
{
    if (notes && job->notes.count) {
        job_took(job, notes_move(notes, &job->notes));
    }
    if (files && job_ok(job)) {
        job_took(job, file_sums_move(files, &job->files));
    }
    conus_status status = job_ok(job) ? CONUS_OK : fail(job->status, "%s", job->message);
    job_end(job);
    return status;
}

static bool has_room(struct job *job)
{
    bool has = memory_reserve(&job->blocks, &job->block_capacity, job->block_count + 1, sizeof *job->blocks);
    return job_took(job, has ? CONUS_OK : CONUS_ERROR_MEMORY);
}

/* A block of its own. */
static void *add_block(struct job *job, size_t bytes, bool zeroed)
{
    if (!has_room(job)) {
        return NULL;
    }
    void *data = zeroed ? memory_zeroed(bytes, 1) : memory_raw(bytes, 1);
    if (job_need(job, data)) {
        job->blocks[job->block_count++] = (struct job_block){.data = data, .size = bytes};
    }
    return data;
}

/* The product of a size; false, and a failure, where it is no size of anything. */
static bool multiply(struct job *job, size_t count, size_t size, size_t *bytes)
{
    bool fits = memory_multiply(count, size, bytes) && *bytes <= SIZE_MAX / 2;
    if (!fits) {
        job_fail(job, CONUS_ERROR_MEMORY, "no memory for %zu elements of %zu bytes", count, size);
    }
    return fits;
}

/* Out of the arena, or a block. */
static void *take(struct job *job, size_t bytes, bool zeroed)
{
    if (bytes > SMALL || JOB_APART) {
        return add_block(job, bytes, zeroed);
    }
    bytes = bytes ? (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT : ALIGNMENT;
    if (bytes > job->chunk_left) {
        uint8_t *block = add_block(job, CHUNK, false);
        job->chunk = block ? block + ALIGNMENT : NULL; /* nothing begins where the block does: find_block() */
        job->chunk_left = block ? CHUNK - ALIGNMENT : 0;
    }
    uint8_t *data = job->chunk;
    if (data) {
        job->chunk += bytes;
        job->chunk_left -= bytes;
        memset(data, 0, zeroed ? bytes : 0);
    }
    return data;
}

static void *allocate(struct job *job, size_t count, size_t size, bool zeroed)
{
    size_t bytes;
    return job_step(job) && multiply(job, count, size, &bytes) ? take(job, bytes, zeroed) : NULL;
}

void *job_raw(struct job *job, size_t count, size_t size)
{
    return allocate(job, count, size, false);
}

void *job_zeroed(struct job *job, size_t count, size_t size)
{
    return allocate(job, count, size, true);
}

void *job_array(struct job *job, size_t *count, size_t size)
{
    void *array = allocate(job, *count, size, false);
    *count = array ? *count : 0;
    return array;
}

/* The block that begins at `data`; NULL where that lies in the arena. */
static struct job_block *find_block(const struct job *job, const void *data)
{
    for (size_t i = job->block_count; data && i-- > 0;) { /* the newest are asked for most */
        if (job->blocks[i].data == data) {
            return &job->blocks[i];
        }
    }
    return NULL;
}

void *job_grow(struct job *job, void *block, size_t count, size_t size)
{
    size_t bytes;
    struct job_block *known = find_block(job, block);
    assert(known || !block);
    if (!job_step(job) || !multiply(job, count, size, &bytes)) {
        return NULL;
    }
    if (!known) {
        return add_block(job, bytes, false);
    }
    void *data = memory_resize(known->data, bytes, 1);
    if (job_need(job, data)) {
        *known = (struct job_block){.data = data, .size = bytes};
    }
    return data;
}

void job_drop(struct job *job, void *block)
{
    struct job_block *known = find_block(job, block);
    if (known) {
        memory_free(known->data);
        *known = (struct job_block){0};
    }
}

void job_own(struct job *job, void (*end)(void *), void *thing)
{
    if (!job_step(job) || !has_room(job)) {
        end(thing);
        return;
    }
    job->blocks[job->block_count++] = (struct job_block){.data = thing, .end = end};
}

void *job_adopt(struct job *job, void *data)
{
    job_own(job, memory_free, data);
    return job_ok(job) ? data : NULL;
}

void *job_give(struct job *job, void *array, size_t size)
{
    struct job_block *block = find_block(job, array);
    if (!array || !job_step(job)) {
        return NULL;
    }
    void *given = block ? array : memory_copy(array, size, 1);
    job_need(job, given);
    if (block) {
        *block = (struct job_block){0};
    }
    return given;
}

char *job_format(struct job *job, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    char *text = length < 0 ? NULL : job_raw(job, (size_t)length + 1, 1);
    if (!text) {
        return job->nothing;
    }
    va_start(args, format);
    vsnprintf(text, (size_t)length + 1, format, args);
    va_end(args);
    return text;
}

char *job_copy(struct job *job, struct text text)
{
    char *copy = job_raw(job, text.size + 1, 1);
    if (!copy) {
        return job->nothing;
    }
    memcpy(copy, text.size ? text.data : "", text.size); /* what is empty may have no data */
    copy[text.size] = '\0';
    return copy;
}

struct text job_text(struct job *job, struct text text)
{
    const char *copy = job_copy(job, text);
    return (struct text){copy, job_ok(job) ? text.size : 0};
}

char *job_name(struct job *job, struct text text)
{
    text = text_trim(text);
    char *plain = text.size && job_step(job) ? text_to_utf8(text) : NULL;
    if (!plain) {
        job_took(job, text.size && job_ok(job) ? CONUS_ERROR_MEMORY : CONUS_OK);
        return NULL;
    }
    char *name = job_copy(job, text_from(plain));
    memory_free(plain);
    return job_ok(job) ? name : NULL;
}

void *job_spare(struct job *job, size_t size)
{
    assert(!job_ok(job) && size <= sizeof job->reserve);
    void *data = take(job, size, true);
    if (data) {
        return data;
    }
    const size_t at = size > sizeof job->reserve - job->reserve_used ? 0 : job->reserve_used;
    job->reserve_used = at + (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    return memset(job->reserve + at, 0, size);
}

void *list_add(struct job *job, void *array, size_t *count, size_t *capacity, size_t size)
{
    enum { FIRST = 8 };
    uint8_t *data;
    memcpy(&data, array, sizeof data); /* a pointer of another type is not read as one of this */
    if (job_step(job) && *count == *capacity) {
        size_t wanted = *capacity ? 2 * *capacity : FIRST;
        uint8_t *larger = job_grow(job, data, wanted, size);
        if (larger) {
            memcpy(array, &larger, sizeof larger);
            *capacity = wanted;
            data = larger;
        }
    }
    return job_ok(job) ? memset(data + (*count)++ * size, 0, size) : job_spare(job, size);
}

char *job_beside(struct job *job, const char *path, const char *name)
{
    return job_format(job, "%.*s%s", path_is_whole(name) ? 0 : (int)path_folder_length(path), path, name);
}

bool job_has_file(struct job *job, const char *path)
{
    return job_step(job) && file_exists(path);
}

struct names job_names(struct job *job, const char *folder, const char *ending)
{
    struct names found = {0};
    (void)JOB_CALL(job, names_list(&found, folder, ending));
    struct names names = {.count = found.count};
    names.names = job_array(job, &names.count, sizeof *names.names);
    for (size_t i = 0; i < names.count; i++) {
        names.names[i] = job_copy(job, text_from(found.names[i]));
    }
    names.count = job_ok(job) ? names.count : 0;
    names_finish(&found);
    return names;
}

struct bytes job_read_open(struct job *job, const struct open_file *file, uint64_t limit, const char *option)
{
    struct bytes bytes = {0};
    if (!job_step(job)) {
        return bytes;
    }
    if (JOB_CALL(job, file_read_here(&bytes, file, SIZE_MAX, limit, option)) && !job_adopt(job, bytes.data)) {
        bytes = (struct bytes){0};
    }
    job->is_limit = !job_ok(job) && file->before.size > limit;
    return bytes;
}

struct bytes job_read(struct job *job, const char *path, uint64_t limit, const char *option)
{
    struct open_file file;
    struct bytes bytes = {0};
    if (JOB_CALL(job, file_open_here(&file, path))) {
        bytes = job_read_open(job, &file, limit, option);
        file_close(&file);
    }
    return bytes;
}

void job_made_of(struct job *job, const char *path, const struct bytes *content)
{
    (void)JOB_CALL(job, file_sums_add(&job->files, path, content));
}
