/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF stacks: where they lie is stated, or stands in metadata.json beside them. */
#include "base/formats/packed.h"
#include "base/memory.h"
#include "loaders/tiff/tiff.h"
#include "loaders/volumes/parts.h"

#include <stdio.h>
#include <string.h>

/* The place of the stack: what the keys state, completed by metadata.json beside it, which then is the job's. */
static struct brainglobe_metadata find_place(struct job *job, const struct volume_input *v)
{
    bool found = false;
    const struct brainglobe_metadata *stated = &v->place;
    bool whole = stated->orientation[0] && stated->resolution[0] > 0;
    struct brainglobe_metadata place = {0};
    if (!whole) {
        found = brainglobe_metadata_take(job, &place, v->keys.path);
    }
    if (stated->orientation[0]) {
        memcpy(place.orientation, stated->orientation, sizeof place.orientation);
    }
    if (stated->resolution[0] > 0) {
        memcpy(place.resolution, stated->resolution, sizeof place.resolution);
    }
    bool sized = place.resolution[0] > 0;
    if (!sized || !place.orientation[0]) {
        const char *missing = sized                  ? "no orientation"
                              : place.orientation[0] ? "no resolution"
                                                     : "no resolution and no orientation";
        job_bad(job,
                "a TIFF stack does not say where it lies: %s %s beside it; give FILE,resolution=25,orientation=asr "
                "(micrometres; where page, row and column start)",
                missing, found ? "in metadata.json" : "is given, and there is no metadata.json");
    }
    return place;
}

static void check_shape(struct job *job, const size_t found[3], const uint64_t shape[3])
{
    if (shape[0] && (shape[0] != found[2] || shape[1] != found[1] || shape[2] != found[0])) {
        job_bad(job,
                "shape: metadata.json says %llu x %llu x %llu, the stack has %zu pages of %zu rows and %zu columns",
                (unsigned long long)shape[0], (unsigned long long)shape[1], (unsigned long long)shape[2], found[2],
                found[1], found[0]);
    }
}

/* The bytes of the file are not needed any more; they may be as many as the voxels. */
static void drop_bytes(struct job *job, struct tiff *tiff)
{
    memory_free(job_give(job, (uint8_t *)tiff->file.data, tiff->file.size));
    tiff->file.data = NULL;
}

enum { PIECE = 1 << 22 };

/* Pages that are unpacked together. */
static size_t pages_of_piece(const struct tiff *tiff)
{
    return smaller_of(PIECE / tiff->page_bytes + 1, tiff->pages.count);
}

static void tiff_read(struct job *job, struct volume_input *v, size_t first, size_t count,
                      const struct voxel_sink *sink)
{
    struct tiff *tiff = v->own;
    const size_t each = v->header.info.dim[0] * v->header.info.dim[1];
    const size_t most = pages_of_piece(tiff);
    uint8_t *pages = job_raw(job, most, tiff->page_bytes);
    (void)first;
    (void)count; /* one volume */
    for (size_t page = 0, size; pages && job_ok(job) && page < tiff->pages.count; page += size) {
        size = smaller_of(most, tiff->pages.count - page);
        tiff_unpack(job, pages, tiff, page, size);
        if (job_ok(job)) {
            sink->take(job, sink->user, page * each, pages, size * each);
        }
    }
    drop_bytes(job, tiff);
}

static void tiff_open(struct job *job, struct volume_input *v)
{
    struct tiff *tiff = job_new(job, struct tiff);
    if (v->source->is_packed) {
        job_refuse(job, "content: TIFF packed with gzip: unpack it");
    }
    const struct bytes bytes = volume_bytes(job, v, v->source);
    if (!bytes.data) {
        return;
    }
    tiff_parse(job, tiff, bytes.data, bytes.size);
    const struct brainglobe_metadata place = find_place(job, v);
    if (!job_ok(job)) { /* there may be no page */
        return;
    }
    const struct tiff_page *page = &tiff->pages.at[0];
    const int64_t dim[7] = {(int64_t)page->width, (int64_t)page->length, (int64_t)tiff->depth, 1, 1, 1, 1};
    const size_t found[3] = {page->width, page->length, tiff->depth};
    const int datatype = volume_datatype_of("uif"[page->format - TIFF_UNSIGNED], page -> bits / 8);
    double world[16];
    v->own = tiff;
    v->header.swapped = tiff->file.swapped;
    v->header.offset = v->run.skip = tiff->whole ? tiff->start : 0;
    v->run.has_footer = v->header.has_unit = true;
    v->read = tiff->whole ? NULL : tiff_read;
    v->gives_slabs = true;
    v->scratch = tiff->whole ? 0 : pages_of_piece(tiff) * tiff->page_bytes;
    snprintf(v->header.info.format, sizeof v->header.info.format, tiff->file.big ? "BigTIFF" : "TIFF");
    check_shape(job, found, place.shape);
    if (JOB_CALL(job, brainglobe_voxels(world, &place))) {
        volume_describe(job, v, datatype, dim, world, "resolution and orientation");
    }
    if (tiff->whole) {
        drop_bytes(job, tiff);
    }
}

const struct volume_reader tiff_reader = {KEY_BIT(KEY_RESOLUTION) | KEY_BIT(KEY_ORIENTATION), .is_whole = true,
                                          .open = tiff_open};
