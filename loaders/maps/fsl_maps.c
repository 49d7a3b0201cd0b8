/* SPDX-License-Identifier: BSD-3-Clause */
/* FSL atlases with a volume per label: the XML, and which of its images is taken. */
#include "loaders/maps/maps.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "loaders/labels/label_format.h"
#include "loaders/labels/labels.h"

static double voxel_mm3(const struct volume_file *file)
{
    const double *s = file->info.spacing;
    return s[0] * s[1] * s[2];
}

/* Takes the image `path` if its voxels are smaller than those of the present one. The other one is closed. */
static void take_if_finer(struct job *job, struct fsl_maps *maps, const char *path, const conus_load_options *options)
{
    struct volume_file *file = volume_file_new(job);
    struct attempt attempt = job_try(job); /* its notes wait */
    if (file) {
        volume_load_series(job, file, path, options->max_memory);
    }
    const bool opened = job_ok(job);
    struct notes *notes = attempt_notes(job, &attempt);
    attempt_end(job, &attempt, ATTEMPT_KEEP);
    if (opened && (!maps->image || voxel_mm3(file) < voxel_mm3(maps->image))) {
        struct volume_file *coarser = maps->image;
        maps->image = file;
        maps->notes = notes;
        file = coarser;
    }
    if (file) {
        volume_file_finish(file);
    }
}

static void choose_image(struct job *job, struct fsl_maps *maps, const struct fsl_atlas *atlas, const char *xml,
                         const conus_load_options *options)
{
    for (size_t i = 0; job_ok(job) && i < atlas->image_count; i++) {
        const char *image = atlas->images[i].image;
        const char *path = image ? fsl_image_find(job, xml, image) : NULL;
        if (path) {
            take_if_finer(job, maps, path, options);
        }
    }
    if (job_ok(job) && !maps->image) {
        job_bad(job, "fsl: none of the %zu images of %s is there (<imagefile> is relative to the XML)",
                atlas->image_count, path_base(xml));
    }
}

/* NULL after a failure. */
static struct fsl_atlas *read_xml(struct job *job, conus_atlas *atlas, const char *xml)
{
    size_t place = job_in(job, xml, JOB_ALONE);
    const struct bytes bytes = job_read(job, xml, FSL_ATLAS_LIMIT, "");
    struct fsl_atlas *found = fsl_atlas_parse(job, text_from_bytes(bytes.data, bytes.size));
    job_out(job, place);
    if (found->is_label) {
        job_bad(job, "fsl: %s is of type Label, which has no volume per label: load it as parcellation", xml);
    }
    labels_sort(job, &found->labels);
    (void)JOB_CALL(job, atlas_add_file(atlas, xml, &bytes));
    return job_ok(job) ? found : NULL;
}

/* The atlas with which each other XML of the same volumes is compared. */
struct rival {
    const struct label_table *labels;
    const char *xml; /* without its folder */
};

static void compare_xml(struct job *job, void *user, struct fsl_atlas *atlas, const char *path,
                        const struct bytes *file)
{
    const struct rival *rival = user;
    struct attempt attempt = job_try(job);
    (void)file;
    labels_sort(job, &atlas->labels);
    attempt_end(job, &attempt, ATTEMPT_SILENT);
    label_tables_note(job, rival->labels, rival->xml, &atlas->labels, path_base(path));
}

/* Other XMLs, and a table beside the image, may call its volumes otherwise. */
static void compare_names(struct job *job, const struct rival *rival, const struct volume_file *image)
{
    const struct label_use use = {.info = &image->info};
    struct label_table *table = labels_new(job);
    fsl_atlas_each(job, image->path, FSL_VOLUMES, compare_xml, (void *)rival);
    struct attempt attempt = job_try(job);
    const char *from = label_volume_table(job, table, NULL, &use);
    attempt_end(job, &attempt, ATTEMPT_SILENT);
    if (from) {
        label_tables_note(job, rival->labels, rival->xml, table, from);
    }
}

struct fsl_maps fsl_maps_open(struct job *job, conus_atlas *atlas, const char *xml, const char *image,
                              const conus_load_options *options)
{
    static const struct label_table none = {0};
    struct fsl_maps maps = {.labels = &none};
    struct fsl_atlas *found = read_xml(job, atlas, xml);
    if (!found) {
        return maps;
    }
    if (image) {
        take_if_finer(job, &maps, image, options);
    } else {
        choose_image(job, &maps, found, xml, options);
    }
    const size_t labels = found->labels.count;
    maps.has_background = label_drop_background(job, &found->labels);
    if (!job_ok(job) || !maps.image) {
        return maps;
    }
    if (labels > maps.image->info.volume_count) {
        job_bad(job, "fsl: %s has %zu labels, %s has %zu volumes", path_base(xml), labels, path_base(maps.image->path),
                maps.image->info.volume_count);
    }
    compare_names(job, &(struct rival){&found->labels, path_base(xml)}, maps.image);
    atlas_take(job, atlas);
    maps.labels = job_ok(job) ? &found->labels : maps.labels;
    return maps;
}
