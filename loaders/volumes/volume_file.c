/* SPDX-License-Identifier: BSD-3-Clause */
/* A volume whose voxels are held, or given to a reader of labels. */
#include "loaders/volumes/volumes.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/volumes/parts.h"
#include "loaders/volumes/text/text_volume.h"

#include <stdio.h>
#include <string.h>

struct volume_opened {
    struct job job;
    struct volume_input *v;
};

static void choose(struct volume_file *file, size_t volume)
{
    const struct text_volume *text = file->text;
    file->info.volume = volume;
    file->title = text && text->titles ? text->titles[volume] : NULL;
    file->info.slope = text && text->slopes ? text->slopes[volume] : file->info.slope;
}

/* All but the voxels. */
static void describe(struct job *job, struct volume_file *file, const struct volume_input *v)
{
    const bool is_big = v->header.swapped == BIG_ENDIAN_IS_SWAPPED;
    file->info = v->header.info;
    file->datatype = v->header.datatype;
    file->swapped = v->header.swapped;
    file->label_slack = v->header.label_slack;
    file->intent_code = v->header.intent_code;
    file->extensions = v->extensions;
    file->extension_count = v->extension_count;
    file->embedded = v->embedded;
    file->text = v->text;
    file->max_memory = memory_limit(job->max_memory);
    file->path = (char *)v->path;
    file->info.path = v->path;
    snprintf(file->info.format, sizeof file->info.format, "%.16s%s%s%s", v->header.info.format,
             v->header.pair ? " pair" : "", v->encoding, is_big ? ", big-endian" : ", little-endian");
    choose(file, v->header.info.volume);
}

/* Reads the chosen volume, or all of them, into memory that is the file's. */
static void hold_voxels(struct job *job, struct volume_file *file, struct volume_input *v, bool is_all)
{
    const size_t count = is_all ? v->header.info.volume_count : 1;
    struct bytes voxels = volume_keep(job, v, is_all ? 0 : file->info.volume, count);
    voxels.data = job_give(job, voxels.data, voxels.size);
    if (job_ok(job)) {
        file->series = is_all ? voxels : (struct bytes){0};
        file->voxels = (struct bytes){voxels.data, v->header.volume_size};
    }
}

/* Reads voxels where that is wanted: labels, unless they are NULL, get them in pieces if they can come so. */
static void take_voxels(struct job *job, struct volume_file *file, struct volume_input *v, bool is_all,
                        struct label_reader *labels)
{
    if (!labels || !volume_has_slabs(v)) {
        hold_voxels(job, file, v, is_all);
    } else {
        const size_t place = job_in(job, v->voxels ? v->voxels->file.path : v->path, JOB_ALONE);
        label_reader_begin(job, labels, file, &(struct bytes){0});
        job_out(job, place);
        volume_give(job, v, file->info.volume, &(struct voxel_sink){label_reader_take, labels});
    }
    memcpy(file->info.sha256, v->header.info.sha256, sizeof file->info.sha256);
}

/* Ends what was done on the job of the file, for the job: its notes bear the path, also where it failed. */
static conus_status end_opening(struct job *job, const struct job *own, const char *path)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < own->notes.count; i++) {
        status = notes_put(&job->notes, own->notes.marks[i].severity, "%s: %s", path, own->notes.lines[i]);
    }
    return job_ok(own) ? status : fail(own->status, "%s", own->message);
}

/* How a volume is opened. */
struct opening {
    struct volume_wish wish;
    uint64_t max_memory;
    bool is_series;
    struct label_reader *labels; /* gets the labels, unless the voxels are held; NULL: they are */
};

static void open_volume(struct job *job, struct volume_file *out, const char *path, const struct opening *opening)
{
    struct volume_file file = {.opened = job_step(job) ? memory_zeroed(1, sizeof *file.opened) : NULL};
    if (!job_need(job, file.opened)) {
        return;
    }
    struct job *own = &file.opened->job;
    own->max_memory = opening->max_memory;
    struct volume_input *v = volume_open(own, path, &opening->wish);
    if (v) {
        const bool is_held = !opening->labels || !volume_has_slabs(v);
        path = v->path;
        file.opened->v = v;
        volume_choose(own, v, opening->is_series, is_held);
        describe(own, &file, v);
        take_voxels(own, &file, v, opening->is_series && volume_fits_series(own, v), opening->labels);
    }
    (void)JOB_CALL(own, file_sums_move(&file.read, &own->files));
    if (JOB_CALL(job, end_opening(job, own, path))) {
        notes_finish(&own->notes);
        *out = file;
    } else {
        volume_file_finish(&file);
    }
}

void volume_load(struct job *job, struct volume_file *out, const char *path, uint64_t max_memory)
{
    open_volume(job, out, path, &(struct opening){.max_memory = max_memory});
}

void volume_load_labels(struct job *job, struct volume_file *out, struct label_voxels *labels, const char *path,
                        const struct source *opened, const conus_load_options *options, const char *needed)
{
    struct label_reader reader = {0};
    struct volume_file file = {0};
    const struct opening opening = {
        .wish = {.needed = needed, .source = opened}, .max_memory = options->max_memory, .labels = &reader};
    open_volume(job, &file, path, &opening);
    if (file.voxels.data) {
        volume_take_labels(job, labels, &file);
    } else {
        reader.file = &file;
        label_reader_end(job, labels, &reader, &file);
    }
    label_reader_finish(&reader);
    if (job_ok(job)) {
        *out = file;
    } else {
        volume_file_finish(&file);
    }
}

void volume_load_series(struct job *job, struct volume_file *out, const char *path, uint64_t max_memory)
{
    open_volume(job, out, path, &(struct opening){.max_memory = max_memory, .is_series = true});
}

void volume_select(struct job *job, struct volume_file *file, size_t volume)
{
    size_t count = file->info.volume_count;
    if (volume >= count) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: volume: found %zu, allowed are 0 to %zu", file->path, volume,
                 count - 1);
    } else if (volume != file->info.volume && !file->series.data) {
        struct volume_file other = *file;
        struct job again = {.max_memory = file->max_memory}; /* whose notes were given when the file was opened */
        other.info.volume = volume;
        hold_voxels(&again, &other, file->opened->v, false);
        const conus_status status = job_close(&again, NULL, NULL);
        if (JOB_CALL(job, status)) {
            bytes_finish(&file->voxels);
            file->voxels = other.voxels;
            const struct volume_header *header = &file->opened->v->header; /* of chunks the sum is the volume's */
            memcpy(file->info.sha256, header->info.sha256, sizeof file->info.sha256);
        } else if (!status) {
            bytes_finish(&other.voxels);
        }
    }
    if (!job_ok(job)) {
        return;
    }
    if (file->series.data) {
        file->voxels.data = file->series.data + volume * file->voxels.size;
    }
    choose(file, volume);
}

void volume_file_finish(struct volume_file *file)
{
    if (file->opened) {
        job_end(&file->opened->job);
        memory_free(file->opened);
    } else {
        memory_free(file->path);
    }
    file_sums_finish(&file->read);
    bytes_finish(file->series.data ? &file->series : &file->voxels);
    *file = (struct volume_file){0};
}

/* The header of what is at the path, and its notes; nothing of it stays in memory. */
static void read_header(struct job *job, conus_volume_info *out, const char *path, bool is_header_only)
{
    const struct job_mark mark = job_mark(job);
    struct volume_input *v = volume_open(job, path, &(struct volume_wish){.is_header_only = is_header_only});
    if (v && !is_header_only) {
        volume_choose(job, v, false, true);
    } else if (v) {
        const size_t place = job_in(job, v->keys.path, JOB_ALONE);
        volume_number_check(job, v);
        job_out(job, place);
    }
    *out = v ? v->header.info : (conus_volume_info){0};
    out->path = NULL;
    job_release(job, mark);
}

void volume_grid_read(struct job *job, conus_volume_info *out, const char *path)
{
    read_header(job, out, path, false);
}

void volume_header_read(struct job *job, conus_volume_info *out, const char *path)
{
    const struct attempt attempt = job_try(job);
    read_header(job, out, path, true);
    attempt_end(job, &attempt, ATTEMPT_SILENT);
}
