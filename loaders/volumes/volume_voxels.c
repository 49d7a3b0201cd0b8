/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads voxels: kept, or in pieces. */
#include "loaders/volumes/parts.h"

#include "atlas/space.h"
#include "base/formats/packed.h"
#include "base/memory.h"
#include "sources/source.h"

#include <string.h>

enum { LARGE = 1 << 24 }; /* bytes; what is larger is not held twice */

void volume_describe(struct job *job, struct volume_input *v, int datatype, const int64_t dim[7],
                     const double world_from_voxel[16], const char *words)
{
    volume_header_set_datatype(job, &v->header, datatype);
    volume_header_set_dim(job, &v->header, dim);
    (void)JOB_CALL(job, space_describe(&v->header.info, world_from_voxel, words));
}

const struct source *volume_beside(struct job *job, const char *path)
{
    job_at(job, path, JOB_ALONE);
    return source_open(job, path);
}

bool volume_is_in_pieces(const struct volume_input *v)
{
    return v->run.packing == RUN_PLAIN && v->reader->is_partial && v->voxels == v->source &&
           v->voxels->file.before.size > LARGE;
}

bool volume_has_slabs(const struct volume_input *v)
{
    const bool is_wide = volume_datatype_size(v->header.datatype) > sizeof(uint16_t);
    return v->read
               ? v->gives_slabs
               : v->header.volume_size > LARGE && (volume_is_in_pieces(v) || (v->run.packing != RUN_PLAIN && is_wide));
}

/* Where voxels go that are kept. */
struct kept {
    uint8_t *data;
    size_t size; /* of a voxel */
};

static void keep(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count)
{
    const struct kept *kept = user;
    (void)job;
    memcpy(kept->data + first * kept->size, voxels, count * kept->size);
}

/* The same into zeros: memory that gets nothing else is never touched, and the system need not have it. */
static void keep_sparse(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count)
{
    static const uint8_t zeros[512];
    const struct kept *kept = user;
    (void)job;
    for (size_t at = 0; at < count * kept->size; at += sizeof zeros) {
        const size_t size = smaller_of(count * kept->size - at, sizeof zeros);
        if (memcmp(voxels + at, zeros, size) != 0) {
            memcpy(kept->data + first * kept->size + at, voxels + at, size);
        }
    }
}

/* A run of bytes that is read: all volumes of it, or one. */
struct run_reading {
    struct job *job;
    struct volume_input *v;
    const struct voxel_sink *sink; /* NULL: they are kept */
    uint64_t from, count, total;   /* bytes, as of struct gzip_range */
    size_t done;                   /* voxels */
};

/* A gzip_sink. */
static conus_status give(void *user, const uint8_t *data, size_t size)
{
    struct run_reading *r = user;
    const size_t count = size / volume_datatype_size(r->v->header.datatype);
    r->sink->take(r->job, r->sink->user, r->done, data, count);
    r->done += count;
    return r->job->status;
}

/* Says what stands behind the voxels; of NIfTI that may be voxels, where an extension was taken for them. */
static void note_rest(const struct run_reading *r, uint64_t extra, size_t junk)
{
    const struct volume_input *v = r->v;
    const size_t flag = v->header.header_size; /* whether extensions follow the header */
    const struct text head = v->source->head.bytes;
    if (extra >= NIFTI_EXTENSION_LEAST && v->format == FORMAT_NIFTI && !v->header.pair && head.size > flag &&
        head.data[flag] && v->header.offset < flag + 4 + NIFTI_EXTENSION_LEAST) {
        job_bad(r->job,
                "vox_offset: found %llu, but an extension begins there, as byte %zu says, and %llu bytes stand after "
                "the last voxel: the voxels begin behind the extension",
                (unsigned long long)v->header.offset, flag, (unsigned long long)extra);
    }
    if (extra && !v->run.has_footer) {
        job_note(r->job, "%llu bytes after the last voxel were ignored", (unsigned long long)extra);
    }
    if (junk) {
        job_note(r->job, "%zu bytes after the end of the gzip data were ignored", junk);
    }
}

static bool is_summed(const struct volume_input *v)
{
    return v->header.info.sha256[0];
}

/* Reads the stretch [at, end) of the file, for its sum if that is not known: into `to`, or piece by piece. */
static void read_stretch(struct run_reading *r, uint64_t at, uint64_t end, uint8_t *to, bool is_given)
{
    struct volume_input *v = r->v;
    const struct job_mark mark = job_mark(r->job);
    uint8_t *piece = to || at >= end ? to : job_raw(r->job, GZIP_SLAB, 1);
    while (piece && at < end && job_ok(r->job)) {
        const size_t size = smaller_of(GZIP_SLAB, end - at);
        if (JOB_CALL(r->job, file_part_here(piece, &v->voxels->file, at, size)) && !is_summed(v)) {
            sha256_update(&v->sum, size, piece);
        }
        if (is_given && job_ok(r->job)) {
            (void)give(r, piece, size);
        }
        piece += to ? size : 0;
        at += size;
    }
    job_release(r->job, mark);
}

/* All of a plain file once, for its sum; afterwards the run alone. */
static struct bytes read_plain(struct run_reading *r)
{
    struct volume_input *v = r->v;
    const uint64_t size = v->voxels->file.before.size;
    const uint64_t from = v->run.begin + r->from;
    const bool is_first = !is_summed(v);
    if (size < v->run.begin + r->total) {
        job_bad(r->job, "voxels: the file has %llu bytes, the header asks for %llu", (unsigned long long)size,
                (unsigned long long)(v->run.begin + r->total));
    }
    uint8_t *kept = r->sink ? NULL : job_raw(r->job, r->count, 1);
    read_stretch(r, is_first ? 0 : from, from, NULL, false);
    if (kept || r->sink) {
        read_stretch(r, from, from + r->count, kept, r->sink);
    }
    read_stretch(r, from + r->count, is_first ? size : 0, NULL, false);
    if (is_first && job_ok(r->job)) {
        file_sha256_end(v->header.info.sha256, &v->sum);
    }
    if (job_ok(r->job)) {
        note_rest(r, size - v->run.begin - r->total, 0);
    }
    return (struct bytes){kept, kept ? r->count : 0};
}

struct bytes volume_bytes(struct job *job, struct volume_input *v, const struct source *source)
{
    struct bytes bytes = {0};
    const uint64_t limit = memory_limit(job->max_memory);
    if (!source || !JOB_CALL(job, file_read_here(&bytes, &source->file, SIZE_MAX, limit, FILE_MAX_MEMORY)) ||
        !job_adopt(job, bytes.data)) {
        return (struct bytes){0};
    }
    if (!is_summed(v)) {
        sha256_update(&v->sum, bytes.size, bytes.data);
    }
    if (!is_summed(v) && source == v->voxels) {
        file_sha256_end(v->header.info.sha256, &v->sum);
    }
    return bytes;
}

/* Unpacks the stored bytes `data`, which are all but those of `left` that the header says are not the run's. */
static struct bytes unpack(struct run_reading *r, const uint8_t *data, size_t size, size_t left)
{
    struct bytes out = {0};
    struct gzip_range range = {.from = r->from,
                               .count = (size_t)r->count,
                               .total = r->total,
                               .user = r,
                               .sink = r->sink ? give : NULL,
                               .zlib = r->v->run.packing == RUN_ZLIB && !gzip_is(data, size)};
    if (!range.zlib && !gzip_is(data, size)) {
        job_bad(r->job, "encoding: found gzip in the header, but the voxels are not packed so");
        return out;
    }
    const conus_status status = gzip_unpack(&out, &range, data, size);
    if (status == CONUS_ERROR_DATA && size < left && job_ok(r->job)) {
        job_bad(r->job, "CompressedDataSize: found %zu, the file has %zu bytes of voxels: %s", size, left,
                conus_message());
    }
    if (!status && out.data && !job_adopt(r->job, out.data)) {
        return (struct bytes){0};
    }
    if (JOB_CALL(r->job, status)) {
        note_rest(r, range.extra, range.junk);
    }
    return job_ok(r->job) ? out : (struct bytes){0};
}

static struct bytes read_packed(struct run_reading *r)
{
    const struct voxel_run *run = &r->v->run;
    struct bytes out = {0};
    const struct bytes bytes = volume_bytes(r->job, r->v, r->v->voxels);
    const size_t left = bytes.size - smaller_of(run->begin, bytes.size);
    if (run->packed_size > left) {
        job_bad(r->job, "CompressedDataSize: found %llu, the file has %zu bytes of voxels",
                (unsigned long long)run->packed_size, left);
    }
    if (job_ok(r->job)) {
        out = unpack(r, bytes.data + bytes.size - left, run->packed_size ? (size_t)run->packed_size : left, left);
    }
    memory_free(job_give(r->job, bytes.data, bytes.size)); /* as soon as it can be: this is as large as the file */
    return out;
}

static struct bytes read_run(struct run_reading *r, size_t first, size_t count)
{
    const struct volume_header *header = &r->v->header;
    r->from = r->v->run.skip + first * header->volume_size;
    r->count = count * header->volume_size;
    r->total = r->v->run.skip + header->info.volume_count * header->volume_size;
    return (r->v->run.packing == RUN_PLAIN ? read_plain : read_packed)(r);
}

struct bytes volume_run(struct job *job, struct volume_input *v, size_t first, size_t count)
{
    return read_run(&(struct run_reading){.job = job, .v = v}, first, count);
}

static void give_all(struct job *job, struct volume_input *v, size_t first, size_t count, const struct voxel_sink *sink)
{
    if (v->read) {
        v->read(job, v, first, count, sink);
    } else {
        (void)read_run(&(struct run_reading){.job = job, .v = v, .sink = sink}, first, count);
    }
}

/* The errors' file. */
static size_t enter_voxels(struct job *job, const struct volume_input *v)
{
    return job_in(job, v->voxels ? v->voxels->file.path : v->keys.path, JOB_ALONE);
}

struct bytes volume_keep(struct job *job, struct volume_input *v, size_t first, size_t count)
{
    const size_t place = enter_voxels(job, v);
    const size_t size = count * v->header.volume_size;
    const bool is_sparse = !v->read && count > 1 && v->run.packing != RUN_PLAIN; /* maps of probabilities hold little */
    struct bytes out = {0};
    if (!v->read && !is_sparse) {
        out = volume_run(job, v, first, count);
    } else if (job_step(job)) {
        struct kept kept = {is_sparse ? memory_sparse(size) : memory_zeroed(size, 1),
                            volume_datatype_size(v->header.datatype)};
        const struct voxel_sink sink = {is_sparse ? keep_sparse : keep, &kept};
        if (job_need(job, kept.data) && job_adopt(job, kept.data)) {
            give_all(job, v, first, count, &sink);
            out = (struct bytes){kept.data, size};
        }
    }
    job_out(job, place);
    return job_ok(job) ? out : (struct bytes){0};
}

void volume_give(struct job *job, struct volume_input *v, size_t volume, const struct voxel_sink *sink)
{
    const size_t place = enter_voxels(job, v);
    give_all(job, v, volume, 1, sink);
    job_out(job, place);
}
