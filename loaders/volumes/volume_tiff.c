/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF stacks: where they lie is stated, or stands in metadata.json beside them. */
#include "base/memory.h"
#include "loaders/tiff/tiff.h"
#include "loaders/volumes/volume_voxels.h"

#include <stdio.h>
#include <string.h>

/* The place of the stack: what the keys state, completed by metadata.json beside it, which then is the job's. */
static struct brainglobe_metadata find_place(struct job *job, const struct volume_selector *keys)
{
    bool found = false;
    const struct brainglobe_metadata *stated = &keys->place;
    bool whole = stated->orientation[0] && stated->resolution[0] > 0;
    struct brainglobe_metadata place = {0};
    if (!whole) {
        (void)JOB_CALL(job, brainglobe_metadata_read(&place, &found, keys->path, &job->files));
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

static void tiff_read(struct job *job, struct volume_input *v, size_t first, size_t count,
                      const struct voxel_sink *sink)
{
    struct bytes voxels = {0};
    (void)first;
    if (JOB_CALL(job, tiff_unpack(&voxels, v->own)) && job_adopt(job, voxels.data)) {
        sink->take(job, sink->user, 0, voxels.data,
                   count * v->header.volume_size / volume_datatype_size(v->header.datatype));
    }
}

static void end_tiff(void *tiff)
{
    tiff_finish(tiff);
}

static void tiff_open(struct job *job, struct volume_input *v)
{
    struct tiff *tiff = job_new(job, struct tiff);
    if (v->source->is_packed) {
        job_refuse(job, "content: TIFF packed with gzip: unpack it");
    }
    const struct bytes bytes = volume_bytes(job, v, v->source);
    if (!tiff || !JOB_CALL(job, tiff_parse(tiff, bytes.data, bytes.size))) {
        return;
    }
    job_own(job, end_tiff, tiff);
    const struct brainglobe_metadata place = find_place(job, &v->keys);
    if (!job_ok(job)) { /* there may be no page any more */
        return;
    }
    const struct tiff_page *page = &tiff->pages[0];
    const int64_t dim[7] = {(int64_t)page->width, (int64_t)page->length, (int64_t)tiff->depth, 1, 1, 1, 1};
    double world[16];
    const size_t found[3] = {page->width, page->length, tiff->depth};
    v->own = tiff;
    v->header.swapped = tiff->file.swapped;
    v->header.offset = v->run.skip = tiff->whole ? tiff->start : 0;
    v->run.has_footer = v->header.has_unit = true;
    v->read = tiff->whole ? NULL : tiff_read;
    snprintf(v->header.info.format, sizeof v->header.info.format, tiff->file.big ? "BigTIFF" : "TIFF");
    check_shape(job, found, place.shape);
    if (JOB_CALL(job, brainglobe_voxels(world, &place))) {
        volume_describe(job, v, volume_datatype_of("uif"[page->format - TIFF_UNSIGNED], page -> bits / 8), dim, world,
                        "resolution and orientation");
    }
}

const struct volume_reader tiff_reader = {FORMAT_TIFF, VOLUME_KEY(KEY_RESOLUTION) | VOLUME_KEY(KEY_ORIENTATION),
                                          .is_whole = true, .open = tiff_open};
