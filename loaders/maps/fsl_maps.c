/* SPDX-License-Identifier: BSD-3-Clause */
/* FSL atlases with a volume per label: the XML, and which of its images is taken. */
#include "loaders/maps/fsl_maps.h"

#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/fsl_find.h"
#include "loaders/labels/label_cells.h"
#include "loaders/labels/label_search.h"
#include "loaders/labels/label_volumes.h"

void fsl_maps_finish(struct fsl_maps *maps)
{
    label_table_finish(&maps->atlas.labels);
    volume_file_finish(&maps->image);
    notes_finish(&maps->notes);
}

static double voxel_mm3(const struct volume_file *file)
{
    const double *s = file->info.spacing;
    return s[0] * s[1] * s[2];
}

/* Takes the image `path` if its voxels are smaller than those of the present one. */
static conus_status take_if_finer(struct fsl_maps *maps, conus_atlas *atlas, const char *path,
                                  const conus_load_options *options)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    conus_status status = volume_file_open_series(&file, path, options, &notes);
    if (!status && (!maps->image.path || voxel_mm3(&file) < voxel_mm3(&maps->image))) {
        volume_file_finish(&maps->image);
        notes_finish(&maps->notes);
        maps->image = file;
        maps->notes = notes;
        return CONUS_OK;
    }
    if (status) {
        (void)notes_move(&atlas->notes, &notes);
    }
    volume_file_finish(&file);
    notes_finish(&notes);
    return status;
}

static conus_status choose_image(struct fsl_maps *maps, conus_atlas *atlas, const char *xml,
                                 const conus_load_options *options)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < maps->atlas.image_count; i++) {
        struct job job = {0}; /* Bridge: to label tables on a job. */
        const char *image = maps->atlas.images[i].image;
        const char *path = image ? fsl_image_find(&job, xml, image) : NULL;
        if (path) {
            (void)JOB_CALL(&job, take_if_finer(maps, atlas, path, options));
        }
        status = job_close(&job, NULL, NULL);
    }
    if (!status && !maps->image.path) {
        return fail(CONUS_ERROR_DATA, "fsl: none of the %zu images of %s is there (<imagefile> is relative to the XML)",
                    maps->atlas.image_count, path_base(xml));
    }
    return status;
}

static conus_status read_xml(struct fsl_maps *maps, struct job *job, conus_atlas *atlas, const char *xml)
{
    struct bytes bytes = {0};
    conus_status status = file_read(&bytes, xml, FSL_ATLAS_LIMIT);
    if (!status) {
        size_t place = job_in(job, xml, JOB_ALONE);
        struct fsl_atlas *parsed = fsl_atlas_parse(job, text_from_bytes(bytes.data, bytes.size));
        job_out(job, place);
        maps->atlas = *parsed;
        parsed->labels = (struct label_table){0};
        status = job_ok(job) ? CONUS_OK : fail(job->status, "%s", job->message);
    }
    if (!status && maps->atlas.is_label) {
        status = fail(CONUS_ERROR_DATA,
                      "fsl: %s is of type Label, which has no volume per label: load it as parcellation", xml);
    }
    status = status ? status : label_table_sort(&maps->atlas.labels, &atlas->notes);
    status = status ? status : atlas_add_file(atlas, xml, &bytes);
    bytes_finish(&bytes);
    return status;
}

/* The atlas with which each other XML of the same volumes is compared. */
struct rival {
    const struct fsl_maps *maps;
    const char *xml; /* without its folder */
};

static void compare_with_rival(struct job *job, void *user, struct fsl_atlas *atlas, const char *path,
                               const struct bytes *file)
{
    const struct rival *rival = user;
    struct notes silent = {0};
    (void)file;
    (void)JOB_CALL(job, label_table_sort(&atlas->labels, &silent));
    notes_finish(&silent);
    label_tables_note(job, &rival->maps->atlas.labels, rival->xml, &atlas->labels, path_base(path));
}

/* Other XMLs, and a table beside the image, may call its volumes otherwise. */
static conus_status compare_map_names(struct fsl_maps *maps, const char *xml, uint64_t max_memory, struct notes *notes)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    struct rival rival = {maps, path_base(xml)};
    struct label_table *table = labels_new(&job);
    const struct label_use use = {.info = &maps->image.info, .max_memory = max_memory};
    fsl_atlas_each(&job, maps->image.path, FSL_VOLUMES, compare_with_rival, &rival);
    struct notes outside = label_notes_swap(&job, (struct notes){0});
    const char *from = label_volume_table(&job, table, NULL, &use);
    struct notes silent = label_notes_swap(&job, outside);
    notes_finish(&silent);
    if (from) {
        label_tables_note(&job, &maps->atlas.labels, rival.xml, table, from);
    }
    return job_close(&job, notes, NULL);
}

conus_status fsl_maps_open(struct fsl_maps *out, conus_atlas *atlas, const char *xml, const char *image,
                           const conus_load_options *options)
{
    struct fsl_maps maps = {0};
    struct job job = {0}; /* Bridge: to label tables on a job. */
    conus_status status = read_xml(&maps, &job, atlas, xml);
    if (!status) {
        status = image ? take_if_finer(&maps, atlas, image, options) : choose_image(&maps, atlas, xml, options);
    }
    const size_t labels = maps.atlas.labels.count;
    if (!status) {
        maps.has_background = label_drop_background(&job, &maps.atlas.labels);
    }
    conus_status ended = job_close(&job, &atlas->notes, NULL);
    status = status ? status : ended;
    if (!status && labels > maps.image.info.volume_count) {
        status = fail(CONUS_ERROR_DATA, "fsl: %s has %zu labels, %s has %zu volumes", path_base(xml), labels,
                      path_base(maps.image.path), maps.image.info.volume_count);
    }
    status = status ? status : compare_map_names(&maps, xml, options->max_memory, &atlas->notes);
    if (status) {
        fsl_maps_finish(&maps);
        return status;
    }
    *out = maps;
    return CONUS_OK;
}
