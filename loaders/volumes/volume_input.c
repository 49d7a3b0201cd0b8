/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a file or folder as a volume. */
#include "loaders/volumes/volumes.h"

#include "base/memory.h"
#include "loaders/refuse.h"
#include "loaders/volumes/parts.h"

#define READER_OF(id, name, endings) [FORMAT_##id] = &name##_reader,
static const struct volume_reader *const readers[] = {VOLUME_FORMATS(READER_OF, )};

/* What is not read in pieces is held as a whole. */
static void check_size(struct job *job, const struct volume_input *v)
{
    const uint64_t limit = memory_limit(job->max_memory);
    const uint64_t size = v->voxels ? v->voxels->file.before.size : 0;
    if (!v->is_header_only && size > limit && !volume_is_in_pieces(v)) {
        job_fail(job, CONUS_ERROR_MEMORY, "file of %llu bytes, allowed are %llu" FILE_MAX_MEMORY,
                 (unsigned long long)size, (unsigned long long)limit);
    }
}

/* The row of what is at the path, which is opened unless it is a folder of voxels. */
static const struct format *find_format(struct job *job, struct volume_input *v, const struct source *opened)
{
    const char *path = v->keys.path;
    const struct format *folder = !opened && file_is_folder(path) ? source_format(job, path, ROLE_VOLUME) : NULL;
    if (!folder) {
        v->source = v->voxels = opened ? opened : source_open(job, path);
    }
    return v->source && job_ok(job) ? format_find(&v->source->head, ROLE_VOLUME) : folder;
}

static void open_input(struct job *job, struct volume_input *v, const struct volume_wish *wish)
{
    const struct format *format = find_format(job, v, wish->source);
    const bool is_packed = v->source && v->source->is_packed;
    if (!job_ok(job)) {
        return;
    }
    v->format = format ? format->id : FORMAT_OTHER;
    v->reader = readers[v->format];
    source_keys_refuse(job, &v->keys, (v->reader ? v->reader->keys : 0) | KEY_BIT(KEY_VOLUME));
    if (!v->reader || (wish->is_peek && v->reader->is_whole)) {
        source_refuse(job, v->source, v->needed);
        return;
    }
    v->encoding = is_packed ? ", gzip" : "";
    v->run.packing = is_packed ? RUN_GZIP : RUN_PLAIN;
    check_size(job, v);
    if (job_ok(job)) {
        v->reader->open(job, v);
    }
}

/* Takes the text apart, and what it says of the place. */
static void read_keys(struct job *job, struct volume_input *v, const char *given)
{
    source_keys_read(job, &v->keys, given, KEYS_VOLUME);
    const struct key_value *resolution = keys_value(&v->keys, KEY_RESOLUTION);
    const struct text orientation = keys_value(&v->keys, KEY_ORIENTATION)->text;
    struct brainglobe_metadata *place = &v->place;
    for (size_t axis = 0; resolution->count && axis < 3; axis++) {
        place->resolution[axis] = resolution->numbers[resolution->count > 1 ? axis : 0];
    }
    if (orientation.size) {
        double matrix[16];
        const double scale[3] = {1, 1, 1};
        const size_t mark = job_in(job, given, JOB_ALONE);
        snprintf(place->orientation, sizeof place->orientation, "%.*s", (int)orientation.size, orientation.data);
        if (job_ok(job) && brainglobe_axes(matrix, place->orientation, scale)) {
            (void)JOB_CALL(job, CONUS_ERROR_ARGUMENT); /* with its message */
        }
        job_out(job, mark);
    }
}

struct volume_input *volume_open(struct job *job, const char *given, const struct volume_wish *wish)
{
    static const char volume[] = "a volume (" VOLUME_NAMES " or OME-Zarr)";
    struct volume_input *v = job_new(job, struct volume_input);
    if (!v) {
        return NULL;
    }
    *v = (struct volume_input){
        .header.info.slope = 1, .needed = wish->needed ? wish->needed : volume, .is_header_only = wish->is_header_only};
    sha256_init(&v->sum);
    read_keys(job, v, given);
    v->path = v->keys.path;
    v->place = wish->place ? *wish->place : v->place;
    const size_t place = job_in(job, v->path, JOB_ALONE);
    source_keys_refuse(job, &v->keys, ~(KEY_BIT(KEY_FIELD) | KEY_BIT(KEY_TISSUE)));
    if (job_ok(job)) {
        open_input(job, v, wish);
    }
    if (v->voxels != v->source) {
        check_size(job, v);
    }
    job_at(job, v->keys.path, JOB_ALONE);
    volume_header_settle(job, &v->header);
    job_out(job, place);
    return job_ok(job) ? v : NULL;
}

/* Bytes that may be held besides those before the voxels. */
static uint64_t room_of(const struct job *job, const struct volume_input *v)
{
    const uint64_t limit = memory_limit(job->max_memory);
    const uint64_t before = v->header.offset + v->scratch;
    return before < limit ? limit - before : 0;
}

bool volume_fits_series(const struct job *job, const struct volume_input *v)
{
    return v->source && v->header.info.volume_count <= room_of(job, v) / v->header.volume_size;
}

void volume_number_check(struct job *job, const struct volume_input *v)
{
    const uint64_t number = (uint64_t)keys_value(&v->keys, KEY_VOLUME)->numbers[0];
    const size_t count = v->header.info.volume_count;
    if (number >= count) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "volume: found %llu, allowed are 0 to %zu", (unsigned long long)number,
                 count - 1);
    }
}

void volume_choose(struct job *job, struct volume_input *v, bool is_series, bool is_held)
{
    struct volume_header *header = &v->header;
    const bool is_chosen = v->keys.given & KEY_BIT(KEY_VOLUME);
    const size_t count = header->info.volume_count;
    const uint64_t limit = memory_limit(job->max_memory);
    const uint64_t held = is_held ? header->volume_size : 0; /* else labels count what they take */
    const size_t place = job_in(job, v->keys.path, JOB_ALONE);
    if (!is_series && count > 1 && !is_chosen) {
        job_fail(
            job, CONUS_ERROR_ARGUMENT,
            "volume: the file has %zu, choose one by adding \",volume=K\", K from 0 to %zu; with a table that names "
            "each (--labels) all are an atlas of probabilities",
            count, count - 1);
    } else if (!is_series) {
        volume_number_check(job, v);
    }
    if (job_ok(job) && (header->offset + v->scratch > limit || held > room_of(job, v))) {
        job_fail(job, CONUS_ERROR_MEMORY,
                 "dim: %zu x %zu x %zu voxels of %s take %zu bytes unpacked, allowed are %llu (--max-memory)",
                 header->info.dim[0], header->info.dim[1], header->info.dim[2], header->info.datatype,
                 header->volume_size, (unsigned long long)limit);
    }
    header->info.volume = is_series || !job_ok(job) ? 0 : (size_t)keys_value(&v->keys, KEY_VOLUME)->numbers[0];
    if (v->reader->around && job_ok(job)) {
        v->reader->around(job, v);
    }
    job_out(job, place);
}
