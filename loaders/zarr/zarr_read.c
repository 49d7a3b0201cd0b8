/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the chunks of an array, one after the other. */
#include "base/byte_order.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/zarr/zarr.h"

#include <errno.h>
#include <math.h>
#include <nettle/sha2.h>
#include <string.h>

enum { SPACE = 3, PIECE = 1 << 20, FILES = 1 << 22 /* some seconds, where hardly any is there */ };

/* An entry of the index of a shard: where a chunk lies; both are all ones where it has the fill value. */
struct entry {
    uint64_t from, size;
};

struct reading {
    struct job *job;
    const struct zarr_array *array;
    const char *folder;
    uint64_t limit;
    size_t size[SPACE], chunk[SPACE]; /* voxels of all and of a chunk, along the axes of space */
    size_t each[SPACE];               /* chunks of a file */
    size_t files[SPACE];
    size_t step[SPACE];      /* from number to number in an unpacked chunk, */
    size_t start;            /* from the number where the volume begins */
    size_t ahead[ZARR_AXES]; /* the volume's place along the axes ahead of space */
    size_t entries, first;   /* of a shard's index: all, and the volume's first */
    struct zarr_unpacker *unpacker;
    uint8_t *room; /* for a chunk's numbers, */
    uint8_t *line; /* for a row of them that are copied together, */
    uint8_t *fill; /* and one of fill values; NULL = they are zeros */
    zarr_take *take;
    void *user;
    struct bytes stored;
    struct buffer path;
    size_t key; /* where it begins in the path */
    struct sha256_ctx sum;
    struct zarr_found found;
};

/* Copies a row of numbers that lie `step` apart; a step of 0 repeats one. */
static void copy_row(uint8_t *out, const uint8_t *from, size_t count, size_t step, size_t size)
{
    if (step == 1) {
        memcpy(out, from, count * size);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        memcpy(out + i * size, from + i * step * size, size);
    }
}

/* Finds the volume along the axes ahead of space, the last of which is the fastest, and in what is stored. */
static void find_volume(struct reading *reading, uint64_t volume)
{
    const struct zarr_array *array = reading->array;
    size_t ahead = array->rank - SPACE;
    size_t step = 1;
    for (size_t i = ahead; i-- > 0; volume /= array->shape[i]) {
        reading->ahead[i] = (size_t)(volume % array->shape[i]);
    }
    for (size_t i = array->rank; i-- > 0; step *= (size_t)array->chunk[array->chain.order[i]]) {
        size_t axis = array->chain.order[i];
        if (axis >= ahead) {
            reading->step[axis - ahead] = step;
        } else {
            reading->start += reading->ahead[axis] % (size_t)array->chunk[axis] * step;
        }
    }
    reading->entries = 1;
    for (size_t i = 0; i < array->rank; i++) {
        size_t chunks = (size_t)(array->file_chunk[i] / array->chunk[i]);
        size_t at = i < ahead ? reading->ahead[i] % (size_t)array->file_chunk[i] / (size_t)array->chunk[i] : 0;
        reading->entries *= chunks;
        reading->first = reading->first * chunks + at;
    }
}

static void reading_init(struct reading *reading, uint64_t volume)
{
    struct job *job = reading->job;
    static const uint8_t zeros[sizeof reading->array->fill] = {0};
    const struct zarr_array *array = reading->array;
    size_t ahead = array->rank - SPACE;
    size_t line = (size_t)array->chunk[array->rank - 1] * array->size;
    size_t bytes = array->chunk_bytes + ZARR_AROUND + 2 * line;
    size_t index = sizeof(struct entry);
    find_volume(reading, volume);
    for (size_t i = 0; i < SPACE; i++) {
        size_t file = (size_t)array->file_chunk[ahead + i];
        reading->size[i] = (size_t)array->shape[ahead + i];
        reading->chunk[i] = (size_t)array->chunk[ahead + i];
        reading->each[i] = file / reading->chunk[i];
        reading->files[i] = (reading->size[i] + file - 1) / file;
    }
    reading->found.wanted = (uint64_t)reading->files[0] * reading->files[1] * reading->files[2];
    bool fits = memory_multiply(index, array->sharded ? reading->entries : 0, &index) && index <= reading->limit;
    double data = (double)array->size;
    double chunks = (double)array->chunk_bytes;
    for (size_t i = 0; i < array->rank; i++) {
        data *= (double)array->shape[i];
        chunks *= ceil((double)array->shape[i] / (double)array->chunk[i]);
    }
    if (!memory_chunks_fit(chunks, data)) {
        job_bad(job, "chunk_shape: chunks of %zu bytes, %.0f in all, far larger than the array of %.0f",
                array->chunk_bytes, chunks, data);
    }
    if (reading->found.wanted > FILES) {
        job_bad(job, "chunk_shape: %llu files of chunks, allowed are %d", (unsigned long long)reading->found.wanted,
                FILES);
    }
    if (!fits || bytes > reading->limit - index) {
        job_fail(job, CONUS_ERROR_MEMORY,
                 "chunk_shape: a chunk takes more memory than the %llu bytes allowed (--max-memory)",
                 (unsigned long long)reading->limit);
    }
    sha256_init(&reading->sum);
    reading->room = job_ok(job) ? memory_raw(array->chunk_bytes + ZARR_AROUND, 1) : NULL;
    reading->line = job_ok(job) ? memory_raw(line, 1) : NULL;
    if (memcmp(array->fill, zeros, array->size) != 0 && job_need(job, reading->room) && job_need(job, reading->line)) {
        reading->fill = memory_raw(line, 1);
        if (job_need(job, reading->fill)) {
            copy_row(reading->fill, array->fill, (size_t)array->chunk[array->rank - 1], 0, array->size);
        }
    }
    if (job_need(job, reading->room) && job_need(job, reading->line)) {
        reading->unpacker = zarr_unpacker_new(job);
    }
}

static void reading_finish(struct reading *reading)
{
    bytes_finish(&reading->stored);
    memory_free(reading->room);
    memory_free(reading->line);
    memory_free(reading->fill);
    buffer_finish(&reading->path);
}

/* Makes the path of the file of chunks at `at`, counted in files along space. */
static void find_path(struct reading *reading, const size_t at[SPACE])
{
    const struct zarr_array *array = reading->array;
    struct buffer *path = &reading->path;
    buffer_clear(path);
    buffer_format(path, "%s/", reading->folder);
    reading->key = path->size;
    buffer_text(path, array->prefixed ? "c" : "");
    for (size_t i = 0; i < array->rank; i++) {
        size_t number =
            i + SPACE < array->rank ? reading->ahead[i] / (size_t)array->file_chunk[i] : at[i + SPACE - array->rank];
        if (i || array->prefixed) {
            buffer_append(path, &array->separator, 1);
        }
        buffer_whole(path, number);
    }
    (void)JOB_CALL(reading->job, buffer_status(path));
}

/* Errors are those of the file of chunks from here on. */
static size_t enter_file(const struct reading *reading)
{
    return job_in(reading->job, reading->path.data, JOB_ALONE);
}

/* Opens the file of chunks; false where there is none. One that may not be looked at is an error. */
static bool open_chunk(struct open_file *out, struct reading *reading)
{
    const size_t place = enter_file(reading);
    errno = 0;
    const bool is_there = file_exists(reading->path.data) || (errno != ENOENT && errno != ENOTDIR);
    const bool is_open = is_there && JOB_CALL(reading->job, file_open_here(out, reading->path.data));
    if (!is_there && !reading->array->has_fill) {
        job_bad(reading->job, "is not there, and fill_value does not say what it holds");
    }
    job_out(reading->job, place);
    return is_open;
}

/* Adds the line of a file whose own sum is `hex`. */
static void add_line(struct reading *reading, const char hex[65])
{
    const char *key = reading->path.data + reading->key;
    sha256_update(&reading->sum, 64, (const uint8_t *)hex);
    sha256_update(&reading->sum, 2, (const uint8_t *)"  ");
    sha256_update(&reading->sum, strlen(key), (const uint8_t *)key);
    sha256_update(&reading->sum, 1, (const uint8_t *)"\n");
    reading->found.files++;
}

/* Gives the sink the voxels of the chunk at `at`, counted in chunks along space, row by row along the last axis: those
 * that were unpacked, or else the fill value. */
static void give_chunk(const struct reading *reading, const size_t at[SPACE], bool there)
{
    const size_t size = reading->array->size;
    const size_t *step = reading->step;
    size_t first[SPACE], count[SPACE];
    for (size_t i = 0; i < SPACE; i++) {
        first[i] = at[i] * reading->chunk[i];
        count[i] = smaller_of(reading->chunk[i], reading->size[i] - first[i]);
    }
    for (size_t row = there || reading->fill ? 0 : SIZE_MAX; job_ok(reading->job) && row < count[0] * count[1]; row++) {
        size_t z = row / count[1];
        size_t y = row % count[1];
        const uint8_t *from =
            there ? reading->room + (reading->start + z * step[0] + y * step[1]) * size : reading->fill;
        if (there && step[2] != 1) {
            copy_row(reading->line, from, count[2], step[2], size);
            from = reading->line;
        }
        size_t voxel = ((first[0] + z) * reading->size[1] + first[1] + y) * reading->size[2] + first[2];
        reading->take(reading->job, reading->user, voxel, from, count[2]);
    }
}

/* Unpacks the stored bytes of the chunk at `at`, and gives its voxels. */
static void take_chunk(const struct reading *reading, const size_t at[SPACE])
{
    const struct zarr_array *array = reading->array;
    const size_t place = enter_file(reading);
    zarr_unpack(reading->job, reading->room, reading->unpacker, &array->chain, reading->stored, array->chunk_bytes);
    job_out(reading->job, place);
    give_chunk(reading, at, true);
}

static void read_chunk(struct reading *reading, const struct open_file *file, const size_t at[SPACE])
{
    char hex[65];
    const size_t place = enter_file(reading);
    bytes_finish(&reading->stored);
    (void)JOB_CALL(reading->job, file_read_here(&reading->stored, file, SIZE_MAX, reading->limit, FILE_MAX_MEMORY));
    job_out(reading->job, place);
    if (job_ok(reading->job)) {
        file_sha256(hex, &reading->stored);
        add_line(reading, hex);
        take_chunk(reading, at);
    }
}

/* Reads a part of the file into `stored`. */
static void read_part(struct reading *reading, const struct open_file *file, uint64_t from, size_t size)
{
    const size_t place = enter_file(reading);
    bytes_finish(&reading->stored);
    reading->stored.data = job_ok(reading->job) ? memory_raw(size, 1) : NULL;
    reading->stored.size = size;
    if (job_need(reading->job, reading->stored.data)) {
        (void)JOB_CALL(reading->job, file_part_here(reading->stored.data, file, from, size));
    }
    job_out(reading->job, place);
}

/* A shard is too large to be held: it is summed up piece by piece. */
static void sum_shard(struct reading *reading, const struct open_file *file)
{
    struct sha256_ctx sum;
    char hex[65];
    sha256_init(&sum);
    for (uint64_t at = 0; job_ok(reading->job) && at < file->before.size; at += PIECE) {
        size_t size = smaller_of(PIECE, file->before.size - at);
        read_part(reading, file, at, size);
        sha256_update(&sum, job_ok(reading->job) ? size : 0, reading->stored.data);
    }
    file_sha256_end(hex, &sum);
    if (job_ok(reading->job)) {
        add_line(reading, hex);
    }
}

static int compare_entries(const void *a, const void *b)
{
    return compare_unsigned(((const struct entry *)a)->from, ((const struct entry *)b)->from);
}

static void refuse_entry(struct job *job, const struct entry *entry)
{
    job_bad(job,
            "index of the shard: a chunk of %llu bytes from byte %llu on lies outside of the file, or over another or "
            "the index",
            (unsigned long long)entry->size, (unsigned long long)entry->from);
}

/* Checks that all `count` entries lie in the file of `whole` bytes, and neither in the index, `own`, nor in each other.
 */
static void check_index(struct job *job, const struct entry *entries, size_t count, uint64_t whole,
                        const struct entry *own)
{
    struct entry *sorted = job_ok(job) ? memory_raw(count + 1, sizeof *sorted) : NULL;
    size_t there = 0;
    if (!job_need(job, sorted)) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const struct entry *entry = &entries[i];
        if (entry->from == UINT64_MAX && entry->size == UINT64_MAX) {
            continue;
        }
        if (entry->from > whole || entry->size > whole - entry->from) {
            refuse_entry(job, entry);
        }
        sorted[there++] = *entry;
    }
    sorted[there++] = *own;
    order_sort(sorted, there, sizeof *sorted, compare_entries);
    for (size_t i = 1; job_ok(job) && i < there; i++) {
        if (sorted[i - 1].from + sorted[i - 1].size > sorted[i].from) {
            refuse_entry(job, &sorted[i - 1]);
        }
    }
    memory_free(sorted);
}

/* The index of the shard, the caller's to memory_free(); NULL after a failure. */
static struct entry *read_index(struct reading *reading, const struct open_file *file)
{
    struct job *job = reading->job;
    const struct zarr_array *array = reading->array;
    uint64_t whole = file->before.size;
    size_t count = reading->entries;
    size_t plain = count * sizeof(struct entry);
    size_t size = plain + array->index.count * sizeof(uint32_t);
    const struct entry own = {array->index_first ? 0 : whole - size, size};
    if (size > whole) {
        job_bad(job, "%s: %llu bytes, its index alone takes %zu", reading->path.data, (unsigned long long)whole, size);
        return NULL;
    }
    read_part(reading, file, own.from, size);
    struct entry *entries = job_ok(job) ? memory_raw(plain + ZARR_AROUND, 1) : NULL;
    const size_t place = enter_file(reading);
    if (job_need(job, entries)) {
        zarr_unpack(job, (uint8_t *)entries, reading->unpacker, &array->index,
                    (struct bytes){reading->stored.data, size}, plain);
    }
    if (job_ok(job)) {
        for (size_t i = 0; i < count; i++) {
            entries[i].from = order_u64((uint8_t *)&entries[i].from, array->index.swapped);
            entries[i].size = order_u64((uint8_t *)&entries[i].size, array->index.swapped);
        }
        check_index(job, entries, count, whole, &own);
    }
    job_out(job, place);
    return entries;
}

/* The chunks of the file at `at`, counted in files along space: those of its index, NULL where there is no file. */
static void give_chunks(struct reading *reading, const struct open_file *file, const struct entry *entries,
                        const size_t at[SPACE])
{
    const size_t *each = reading->each;
    for (size_t i = 0; job_ok(reading->job) && i < each[0] * each[1] * each[2]; i++) {
        const size_t chunk[SPACE] = {at[0] * each[0] + i / each[2] / each[1], at[1] * each[1] + i / each[2] % each[1],
                                     at[2] * each[2] + i % each[2]};
        bool inside = true;
        for (size_t axis = 0; axis < SPACE; axis++) {
            inside = inside && chunk[axis] * reading->chunk[axis] < reading->size[axis];
        }
        const struct entry *entry = entries ? &entries[reading->first + i] : NULL;
        if (inside && entry && entry->from != UINT64_MAX) {
            read_part(reading, file, entry->from, (size_t)entry->size);
            take_chunk(reading, chunk);
        } else if (inside) {
            give_chunk(reading, chunk, false);
        }
    }
}

static void read_shard(struct reading *reading, const struct open_file *file, const size_t at[SPACE])
{
    sum_shard(reading, file);
    struct entry *entries = read_index(reading, file);
    give_chunks(reading, file, entries, at);
    memory_free(entries);
}

static void read_file(struct reading *reading, const size_t at[SPACE])
{
    struct open_file file = {.descriptor = -1};
    find_path(reading, at);
    if (!job_ok(reading->job)) {
        return;
    }
    if (!open_chunk(&file, reading)) {
        give_chunks(reading, NULL, NULL, at);
        return;
    }
    (reading->array->sharded ? read_shard : read_chunk)(reading, &file, at);
    file_close(&file);
}

struct zarr_found zarr_read(struct job *job, const struct zarr_array *array, const char *folder, uint64_t volume,
                            zarr_take *take, void *user)
{
    struct reading reading = {.job = job,
                              .array = array,
                              .folder = folder,
                              .limit = memory_limit(job->max_memory),
                              .take = take,
                              .user = user};
    reading_init(&reading, volume);
    for (uint64_t i = 0; job_ok(job) && i < reading.found.wanted; i++) {
        const size_t at[SPACE] = {i / reading.files[2] / reading.files[1], i / reading.files[2] % reading.files[1],
                                  i % reading.files[2]};
        read_file(&reading, at);
    }
    if (!reading.found.files) {
        job_bad(job, "%s: no chunk of this array is there: it was not downloaded", folder);
    }
    file_sha256_end(reading.found.sha256, &reading.sum);
    reading_finish(&reading);
    return reading.found;
}
