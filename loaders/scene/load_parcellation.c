/* SPDX-License-Identifier: BSD-3-Clause */
/* A parcellation: a labelled volume, or an FSL atlas XML that names some, and the table of its labels. */
#include "loaders/scene/load_parcellation.h"

#include "atlas/space.h"
#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "loaders/cifti/cifti_file.h"
#include "loaders/file_kind.h"
#include "loaders/labels/fsl_find.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_search.h"
#include "loaders/volumes/grey.h"
#include "loaders/volumes/volume_table.h"
#include "loaders/volumes/volume_values.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void set_range(conus_volume_info *info, const uint32_t *labels)
{
    size_t count = info->dim[0] * info->dim[1] * info->dim[2];
    uint32_t least = UINT32_MAX;
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++) {
        least = labels[i] < least ? labels[i] : least;
        most = labels[i] > most ? labels[i] : most;
    }
    info->minimum = least;
    info->maximum = most;
}

static conus_status cifti_describe(struct volume_file *out, const struct cifti_file *file, uint64_t max_memory)
{
    const struct cifti *cifti = &file->choice.cifti;
    conus_volume_info *info = &out->info;
    out->path = memory_text(file->path, strlen(file->path));
    out->datatype = cifti->datatype;
    out->max_memory = max_memory;
    *info = (conus_volume_info){
        .path = out->path, .volume = file->choice.map, .volume_count = cifti->map_count, .slope = 1};
    snprintf(info->format, sizeof info->format, "CIFTI-2");
    snprintf(info->datatype, sizeof info->datatype, "%s", volume_datatype_name(cifti->datatype));
    memcpy(info->sha256, file->sha256, sizeof info->sha256);
    memcpy(info->dim, cifti->dim, sizeof info->dim);
    return out->path ? space_describe(info, cifti->world_from_voxel, "the CIFTI file's volume") : CONUS_ERROR_MEMORY;
}

/* Reads the voxels of path, which may choose a map, into the members file (without voxels), labels, table and source of
 * out. `out` is the caller's to finish, also on failure. CONUS_ERROR_DATA where the file has no voxels. */
static conus_status cifti_parcellation_read(struct parcellation *out, const char *path, uint64_t max_memory)
{
    struct cifti_file file = {0};
    struct buffer source = {0};
    conus_status status = cifti_file_open(&file, path, max_memory, &out->notes);
    if (!status && !cifti_choice_has_voxels(&file.choice)) {
        status = fail(CONUS_ERROR_DATA,
                      "%s: no voxels, its labels are of vertices only: \"vertex_labels\" in a "
                      "manifest, or --labels, takes them",
                      file.path);
    }
    status = status ? status : cifti_describe(&out->file, &file, max_memory);
    uint32_t *labels = NULL;
    status = status ? status : cifti_choice_voxels(&labels, &out->table, &file.choice);
    if (!status && !out->table.count) {
        status = fail(CONUS_ERROR_DATA, "%s: no voxel has a label but 0 in map %zu", file.path, file.choice.map);
    }
    if (!status) {
        set_range(&out->file.info, labels);
        status = label_voxels_of(&out->labels, labels,
                                 file.choice.cifti.dim[0] * file.choice.cifti.dim[1] * file.choice.cifti.dim[2]);
    }
    memory_free(labels);
    if (!status) {
        buffer_format(&source, "label table in %s", file.path);
        status = buffer_status(&source);
        out->source = source.data;
    }
    cifti_file_finish(&file);
    return status;
}

void parcellation_finish(struct parcellation *parts)
{
    volume_file_finish(&parts->file);
    label_voxels_finish(&parts->labels);
    label_table_finish(&parts->table);
    memory_free(parts->source);
    file_sums_finish(&parts->read);
    notes_finish(&parts->notes);
}

static conus_status set_source(struct parcellation *parts, const char *format, const char *where)
{
    struct buffer source = {0};
    buffer_format(&source, "%s in %s", format, where);
    conus_status status = buffer_status(&source);
    if (status) {
        buffer_finish(&source);
        return status;
    }
    memory_free(parts->source);
    parts->source = source.data;
    return CONUS_OK;
}

static conus_status read_override(struct parcellation *parts, const char *path)
{
    const char *format = NULL;
    struct label_table table = {0};
    const struct label_use use = {.info = &parts->file.info,
                                  .voxels = &parts->labels,
                                  .header = volume_file_header,
                                  .max_memory = parts->file.max_memory};
    struct job job = {0}; /* Bridge: to label tables on a job. */
    label_file_read(&job, &table, &format, path, &use);
    conus_status status = job_close(&job, &parts->notes, &parts->read);
    status = status ? status : set_source(parts, format, path);
    if (status) {
        label_table_finish(&table);
        return status;
    }
    label_table_finish(&parts->table);
    parts->table = table;
    return CONUS_OK;
}

/* Opens `image` of the atlas and keeps it if its voxels are smaller than those of the image kept so far. */
static conus_status consider_image(struct parcellation *parts, const char *xml_path, const char *image,
                                   uint64_t max_memory)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    struct job job = {0}; /* Bridge: to label tables on a job. */
    const char *path = fsl_image_find(&job, xml_path, image);
    conus_status status = job.status;
    if (!status && !path) {
        status = notes_warn(&parts->notes, "image %s of the FSL atlas is not there", image);
    } else if (!status) {
        status = volume_file_open(&file, path, max_memory, &notes);
    }
    bool taken =
        !status && path && (!parts->file.path || space_voxel_mm3(&file.info) < space_voxel_mm3(&parts->file.info));
    if (taken) {
        struct volume_file other = parts->file;
        parts->file = file;
        file = other;
    }
    if (taken || status) {
        conus_status moved = notes_move(&parts->notes, &notes);
        status = status ? status : moved;
    }
    job_end(&job);
    volume_file_finish(&file);
    notes_finish(&notes);
    return status;
}

static conus_status open_finest(struct parcellation *parts, const struct fsl_atlas *atlas, const char *path,
                                uint64_t max_memory)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < atlas->image_count; i++) {
        const char *image = atlas->images[i].image;
        status = image ? consider_image(parts, path, image, max_memory) : CONUS_OK;
    }
    if (!status && !parts->file.path) {
        return fail(CONUS_ERROR_DATA, "%s: none of its %zu images is there (<imagefile> is relative to the XML)", path,
                    atlas->image_count);
    }
    if (!status && atlas->image_count > 1) {
        const double *s = parts->file.info.spacing;
        status = notes_add(&parts->notes, "of the %zu images of %s the finest is used: %s (%g x %g x %g mm)",
                           atlas->image_count, path_base(path), path_base(parts->file.path), s[0], s[1], s[2]);
    }
    return status;
}

/* Compares with the names that the volume has by itself: from elsewhere, or from a second XML. */
static conus_status compare_with_volume(struct parcellation *parts)
{
    struct label_table table = {0};
    char *source = NULL;
    struct notes silent = {0};
    conus_status status = volume_label_table(&table, &source, &parts->file, &parts->labels, NULL, &silent);
    if (status && status != CONUS_ERROR_MEMORY) {
        status = notes_warn(&parts->notes, "%s", conus_message());
    } else if (!status) {
        struct job job = {0}; /* Bridge: to label tables on a job. */
        parts->is_disputed = label_tables_note(&job, &parts->table, parts->source, &table, source);
        status = job_close(&job, &parts->notes, NULL);
    }
    label_table_finish(&table);
    memory_free(source);
    notes_finish(&silent);
    return status;
}

static conus_status load_fsl(struct parcellation *parts, const char *path, struct text text, uint64_t max_memory)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    size_t place = job_in(&job, path, JOB_ALONE);
    struct fsl_atlas *atlas = fsl_atlas_parse(&job, text);
    job_out(&job, place);
    if (!job_ok(&job)) {
        return job_close(&job, NULL, NULL);
    }
    conus_status status = CONUS_OK;
    if (!atlas->is_label) {
        status = fail(CONUS_ERROR_UNSUPPORTED,
                      "%s: an FSL atlas of type %s, Label is needed; \"probabilities\" of a manifest takes it, or it "
                      "is ATLAS itself",
                      path, atlas->type);
    }
    status = status ? status : open_finest(parts, atlas, path, max_memory);
    status = status ? status : volume_file_take_labels(&parts->labels, &parts->file);
    if (!status) {
        const struct label_use use = {.info = &parts->file.info,
                                      .voxels = &parts->labels,
                                      .header = volume_file_header,
                                      .path = path,
                                      .max_memory = max_memory};
        fsl_atlas_number(&job, atlas, &use);
        status = job.status;
    }
    status = status ? status : set_source(parts, atlas->is_spm ? "SPM atlas XML" : "FSL atlas XML", path_base(path));
    if (!status) {
        status = notes_move(&parts->notes, &job.notes);
    }
    if (!status) {
        parts->table = atlas->labels;
        atlas->labels = (struct label_table){0};
        status = compare_with_volume(parts);
    }
    job_end(&job);
    return status;
}

static conus_status load_markup(struct parcellation *parts, const struct open_file *file, uint64_t max_memory,
                                const char *needed)
{
    const char *path = file->path;
    struct bytes bytes = {0};
    conus_status status = file_read_open(&bytes, file, SIZE_MAX, FSL_ATLAS_LIMIT, "");
    struct text text = text_from_bytes(bytes.data, bytes.size);
    if (!status && !text_equal(xml_root(text), "atlas")) {
        status = fail_in(file_kind_fail(path, &bytes, needed), path);
    }
    status = status ? status : load_fsl(parts, path, text, max_memory);
    status = status ? status : file_sums_add(&parts->read, path, &bytes);
    bytes_finish(&bytes);
    return status;
}

conus_status parcellation_check_grey(const struct volume_file *file, const struct label_voxels *labels,
                                     const struct label_table *table, bool stated, bool anyway, struct notes *notes)
{
    struct grey_result result;
    const conus_volume_info *info = &file->info;
    conus_status status = CONUS_OK;
    if (file->datatype == VOLUME_FLOAT32) {
        double end = info->intercept + TOLERANCE_SINGLE_END * fabs(info->slope);
        status = label_table_check_singles(table, labels->labels, labels->label_count, end, file->path, notes);
    }
    status = status ? status : grey_judge_file(&result, file, labels, table, stated);
    if (status || !result.grey) {
        return status;
    }
    double equal = 100 * result.equal;
    double needed = 100 * result.needed;
    return anyway
               ? notes_warn(notes,
                            "%s: looks like an image, not like labels (%.0f %% of its neighbouring voxels are equal): "
                            "its grey values are listed as areas",
                            path_base(file->path), equal)
               : fail(
                     CONUS_ERROR_DATA,
                     "%s: looks like an image, not like labels: %.0f %% of its neighbouring voxels are equal, of areas "
                     "%.0f %% would be; an atlas is needed ('conus atlases' lists those that are installed), --context "
                     "draws an image, --pathway selects what is bright in it, --labels-anyway takes every value as a "
                     "label",
                     file->path, equal, needed);
}

conus_status parcellation_read_opened(struct parcellation *out, const struct probe *probe, const char *path,
                                      const conus_load_options *options, const char *needed)
{
    if (probe->reader == READER_CIFTI) {
        conus_status status = cifti_parcellation_read(out, path, options->max_memory);
        out->file.info.role = CONUS_ROLE_PARCELLATION;
        return status || !options->labels ? status : read_override(out, options->labels);
    }
    bool markup = probe->first == '<';
    conus_status status = markup ? load_markup(out, &probe->file, options->max_memory, needed)
                                 : volume_file_open_labels(&out->file, &out->labels, path, probe_file(probe), options,
                                                           needed, &out->notes);
    status = status ? status : file_sums_move(&out->read, &out->file.read);
    if (!status && options->labels) {
        status = read_override(out, options->labels);
    } else if (!status && !markup) { /* an XML has named them */
        status = volume_label_table(&out->table, &out->source, &out->file, &out->labels, &out->read, &out->notes);
    }
    out->file.info.role = CONUS_ROLE_PARCELLATION;
    return status ? status
                  : parcellation_check_grey(&out->file, &out->labels, &out->table, markup, options->labels_anyway,
                                            &out->notes);
}

conus_status parcellation_read(struct parcellation *out, const char *path, const conus_load_options *options,
                               const char *needed)
{
    struct probe probe;
    conus_status status = probe_open(&probe, path);
    status = status ? status : parcellation_read_opened(out, &probe, path, options, needed);
    probe_close(&probe);
    return status;
}

conus_status parcellation_atlas(conus_atlas **out, struct parcellation *parts)
{
    struct labelled_volume volume = {.info = &parts->file.info, .labels = &parts->labels};
    return atlas_create_of(out, &volume, 1, &parts->table, parts->source, &parts->notes);
}
