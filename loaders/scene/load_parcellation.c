/* SPDX-License-Identifier: BSD-3-Clause */
/* A parcellation: a labelled volume, or an FSL atlas XML that names some, and the table of its labels. */
#include "loaders/scene/scene.h"

#include "atlas/space.h"
#include "base/files/file.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "loaders/cifti/cifti.h"
#include "loaders/labels/labels.h"
#include "loaders/refuse.h"
#include "loaders/volumes/volumes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void set_range(conus_volume_info *info, const uint32_t *labels, size_t count)
{
    uint32_t least = UINT32_MAX;
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++) {
        least = labels[i] < least ? labels[i] : least;
        most = labels[i] > most ? labels[i] : most;
    }
    info->minimum = least;
    info->maximum = most;
}

/* Describes the volume of the file as a file without voxels. */
static void describe_cifti(struct job *job, struct volume_file *out, const struct cifti_file *file)
{
    const struct cifti *cifti = &file->choice->cifti;
    conus_volume_info *info = &out->info;
    out->path = job_give(job, (char *)file->path, strlen(file->path) + 1);
    out->datatype = cifti->datatype;
    out->max_memory = job->max_memory;
    *info = (conus_volume_info){
        .path = out->path, .volume = file->choice->map, .volume_count = cifti->maps.count, .slope = 1};
    snprintf(info->format, sizeof info->format, "CIFTI-2");
    snprintf(info->datatype, sizeof info->datatype, "%s", volume_datatype_name(cifti->datatype));
    memcpy(info->sha256, file->sha256, sizeof info->sha256);
    memcpy(info->dim, cifti->dim, sizeof info->dim);
    (void)JOB_CALL(job, space_describe(info, cifti->world_from_voxel, "the CIFTI file's volume"));
}

/* Takes voxels and table of the map that the file has chosen. CONUS_ERROR_DATA where the file has no voxels. */
static void take_cifti(struct job *job, struct parcellation *out, const struct cifti_file *file)
{
    const struct cifti_choice *choice = file->choice;
    const size_t *dim = choice->cifti.dim;
    const size_t count = dim[0] * dim[1] * dim[2];
    if (!cifti_choice_has_voxels(choice)) {
        job_bad(job,
                "%s: no voxels, its labels are of vertices only: \"vertex_labels\" in a manifest, or --labels, takes "
                "them",
                file->path);
    }
    describe_cifti(job, &out->file, file);
    uint32_t *labels = cifti_voxels(job, out->table, choice);
    if (!labels) {
        return;
    }
    if (!out->table->count) {
        job_bad(job, "%s: no voxel has a label but 0 in map %zu", file->path, choice->map);
    }
    set_range(&out->file.info, labels, count);
    (void)JOB_CALL(job, label_voxels_of(&out->labels, labels, count));
}

static void read_cifti(struct job *job, struct parcellation *out, const char *path)
{
    const struct job_mark mark = job_mark(job);
    const struct cifti_file *file = cifti_file_open(job, path);
    if (file) {
        take_cifti(job, out, file);
    }
    job_release(job, mark);
    out->source = job_format(job, "label table in %s", out->file.path ? out->file.path : path);
}

static void read_override(struct job *job, struct parcellation *part, const char *path)
{
    const char *format = "";
    const struct label_use use = {.info = &part->file.info, .voxels = &part->labels, .header = volume_header_read};
    part->table = labels_new(job);
    label_file_read(job, part->table, &format, path, &use);
    part->source = job_format(job, "%s in %s", format, path);
}

/* Opens `image` of the atlas and keeps it if its voxels are smaller than those of the image kept so far. */
static void consider_image(struct job *job, struct parcellation *part, const char *xml_path, const char *image)
{
    const char *path = fsl_image_find(job, xml_path, image);
    if (!path) {
        job_note(job, "image %s of the FSL atlas is not there", image);
        return;
    }
    struct volume_file file = {0};
    const struct attempt attempt = job_try(job);
    volume_load(job, &file, path, job->max_memory);
    if (job_ok(job) && part->file.path && space_voxel_mm3(&file.info) >= space_voxel_mm3(&part->file.info)) {
        (void)attempt_end(job, &attempt, ATTEMPT_DROP); /* with what was noted about it */
    } else {
        const struct volume_file other = part->file;
        part->file = file;
        file = other;
        attempt_end(job, &attempt, ATTEMPT_KEEP);
    }
    volume_file_finish(&file);
}

static void open_finest(struct job *job, struct parcellation *part, const struct fsl_atlas *atlas, const char *path)
{
    for (size_t i = 0; i < atlas->image_count && job_ok(job); i++) {
        if (atlas->images[i].image) {
            consider_image(job, part, path, atlas->images[i].image);
        }
    }
    if (!part->file.path) {
        job_bad(job, "%s: none of its %zu images is there (<imagefile> is relative to the XML)", path,
                atlas->image_count);
    } else if (atlas->image_count > 1) {
        const double *s = part->file.info.spacing;
        job_note(job, "of the %zu images of %s the finest is used: %s (%g x %g x %g mm)", atlas->image_count,
                 path_base(path), path_base(part->file.path), s[0], s[1], s[2]);
    }
}

/* Compares with the names that the volume has by itself: from elsewhere, or from a second XML. */
static void compare_with_volume(struct job *job, struct parcellation *part)
{
    struct label_table *table = labels_new(job);
    const struct attempt attempt = job_try(job);
    const char *source = volume_label_table(job, table, &part->file, &part->labels);
    const char *why = attempt_end(job, &attempt, ATTEMPT_DROP);
    if (why[0]) {
        job_note(job, "%s", why);
    } else {
        part->is_disputed = label_tables_note(job, part->table, part->source, table, source);
    }
}

static void read_fsl(struct job *job, struct parcellation *part, const char *path, struct text text)
{
    const size_t mark = job_in(job, path, JOB_ALONE);
    struct fsl_atlas *atlas = fsl_atlas_parse(job, text);
    job_out(job, mark);
    if (job_ok(job) && !atlas->is_label) {
        job_refuse(job,
                   "%s: an FSL atlas of type %s, Label is needed; \"probabilities\" of a manifest takes it, or it is "
                   "ATLAS itself",
                   path, atlas->type);
    }
    open_finest(job, part, atlas, path);
    if (job_ok(job)) {
        volume_take_labels(job, &part->labels, &part->file);
    }
    const struct label_use use = {
        .info = &part->file.info, .voxels = &part->labels, .header = volume_header_read, .path = path};
    fsl_atlas_number(job, atlas, &use);
    const size_t place = job_in(job, path, JOB_ALONE);
    label_check_zero(job, &atlas->labels, use.voxels);
    job_out(job, place);
    part->source = job_format(job, "%s in %s", atlas->is_spm ? "SPM atlas XML" : "FSL atlas XML", path_base(path));
    if (job_ok(job)) {
        part->table = &atlas->labels;
        compare_with_volume(job, part);
    }
}

static void read_markup(struct job *job, struct parcellation *part, const struct open_file *file, const char *needed)
{
    const char *path = file->path;
    struct bytes bytes = {0};
    if (!JOB_CALL(job, file_read_open(&bytes, file, SIZE_MAX, FSL_ATLAS_LIMIT, ""))) {
        return;
    }
    const struct text text = text_from_bytes(bytes.data, bytes.size);
    if (!text_equal(xml_root(text), "atlas")) {
        const size_t mark = job_in(job, path, JOB_ALONE);
        file_refuse(job, path, &bytes, needed);
        job_out(job, mark);
    }
    read_fsl(job, part, path, text);
    job_made_of(job, path, &bytes);
    (void)JOB_CALL(job, file_sums_move(&job->files, &part->file.read));
    bytes_finish(&bytes);
}

void parcellation_check_grey(struct job *job, const struct volume_file *file, const struct label_voxels *labels,
                             const struct label_table *table, bool stated, bool anyway)
{
    const conus_volume_info *info = &file->info;
    if (file->datatype == VOLUME_FLOAT32) {
        const double end = info->intercept + TOLERANCE_SINGLE_END * fabs(info->slope);
        (void)JOB_CALL(
            job, label_table_check_singles(table, labels->labels, labels->label_count, end, file->path, &job->notes));
    }
    const struct grey_result result = grey_judge_file(job, file, labels, table, stated);
    if (!result.grey) {
        return;
    }
    const double equal = 100 * result.equal;
    if (anyway) {
        job_warn(job,
                 "%s: looks like an image, not like labels (%.0f %% of its neighbouring voxels are equal): its grey "
                 "values are listed as areas",
                 path_base(file->path), equal);
    } else {
        job_bad(job,
                "%s: looks like an image, not like labels: %.0f %% of its neighbouring voxels are equal, of areas %.0f "
                "%% would be; an atlas is needed ('conus atlases' lists those that are installed), --context draws an "
                "image, --pathway selects what is bright in it, --labels-anyway takes every value as a label",
                file->path, equal, 100 * result.needed);
    }
}

static void read_volume(struct job *job, struct parcellation *out, const struct source *source, const char *path,
                        const conus_load_options *options, const char *needed)
{
    volume_load_labels(job, &out->file, &out->labels, path, source->is_open ? source : NULL, options, needed);
    (void)JOB_CALL(job, file_sums_move(&job->files, &out->file.read));
    if (!options->labels && job_ok(job)) {
        out->source = volume_label_table(job, out->table, &out->file, &out->labels);
    }
}

static void end_parcellation(void *thing)
{
    struct parcellation *part = thing;
    volume_file_finish(&part->file);
    label_voxels_finish(&part->labels);
    label_map_finish(&part->voxels);
}

void parcellation_read_opened(struct job *job, struct parcellation *out, const struct source *source, const char *path,
                              const conus_load_options *options, const char *needed)
{
    const bool is_cifti = source_scene(source) == FORMAT_CIFTI;
    const bool is_markup = source_first(source) == '<';
    job_own(job, end_parcellation, out);
    out->table = labels_new(job);
    if (is_cifti) {
        read_cifti(job, out, path);
    } else if (is_markup) { /* which names its labels */
        read_markup(job, out, &source->file, needed);
    } else {
        read_volume(job, out, source, path, options, needed);
    }
    out->file.info.role = CONUS_ROLE_PARCELLATION;
    if (options->labels) {
        read_override(job, out, options->labels);
    }
    if (!is_cifti) {
        parcellation_check_grey(job, &out->file, &out->labels, out->table, is_markup, options->labels_anyway);
    }
}

void parcellation_read(struct job *job, struct parcellation *out, const char *path, const conus_load_options *options,
                       const char *needed)
{
    struct source source = {0};
    if (JOB_CALL(job, source_open_atlas(&source, path))) {
        parcellation_read_opened(job, out, &source, path, options, needed);
    }
    source_close(&source);
}
