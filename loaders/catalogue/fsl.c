/* SPDX-License-Identifier: BSD-3-Clause */
/* The images of an FSL atlas XML, by their resolution. */
#include "loaders/catalogue/catalogue.h"

#include "base/formats/xml.h"
#include "conus/own.h"
#include "loaders/labels/labels.h"
#include "sources/names.h"

#include <string.h>

struct images {
    LIST(struct catalogue_item); /* the finest first, once all are known */
};

static double voxel_mm3(const struct catalogue_item *image)
{
    const double *edges = image->atlas.spacing;
    return edges[0] * edges[1] * edges[2];
}

/* Appends the volume that the XML calls `written`, unless it is there already or has no labels. */
static void add_image(struct job *job, struct images *images, const char *xml_path, const char *written)
{
    const char *path = fsl_image_find(job, xml_path, written);
    struct catalogue_item image = {.atlas = {.kind = "volume", .path = path, .labels = xml_path}};
    bool labels = path && volume_marks_find(job, image.atlas.spacing, path, true);
    for (size_t i = 0; i < images->count; i++) {
        labels = labels && strcmp(images->at[i].atlas.path, path) != 0;
    }
    if (labels) {
        bool finer = images->count && voxel_mm3(&image) < voxel_mm3(&images->at[0]);
        *LIST_ADD(job, images) = finer ? images->at[0] : image;
        if (finer) {
            images->at[0] = image;
        }
    }
}

/* Whether one of the images with a volume for each label is there. */
static bool has_maps(struct job *job, const struct fsl_atlas *atlas, const char *xml_path)
{
    bool found = false;
    for (size_t i = 0; !found && !atlas->is_label && i < atlas->image_count; i++) {
        found = atlas->images[i].image && fsl_image_find(job, xml_path, atlas->images[i].image);
    }
    return found;
}

static void take_atlas(struct job *job, conus_catalogue *catalogue, const char *xml_path, const struct fsl_atlas *atlas)
{
    const char *name = path_base(xml_path);
    const int length = (int)(strlen(name) - strlen(".xml"));
    struct images images = {0};
    for (size_t i = 0; i < atlas->image_count; i++) {
        const struct fsl_image *image = &atlas->images[i];
        const char *written = atlas->is_label && image->image ? image->image : image->summary;
        if (written) {
            add_image(job, &images, xml_path, written);
        }
    }
    bool maps = has_maps(job, atlas, xml_path);
    for (size_t i = 0; i < images.count; i++) {
        struct catalogue_item *image = &images.at[i];
        const char *file = path_base(image->atlas.path);
        image->alias = job_format(job, "%.*s", (int)volume_stem_length(file), file);
        image->atlas.name = i ? job_format(job, "%.*s-%gmm", length, name, image->atlas.spacing[0])
                              : job_format(job, "%.*s", length, name);
        catalogue_add(job, catalogue, image);
    }
    if (maps) { /* the XML itself, whose labels are areas of probabilities */
        const char *called = job_format(job, "%.*s-prob", length, name);
        catalogue_add(
            job, catalogue,
            &(const struct catalogue_item){.atlas = {.kind = "probabilities", .name = called, .path = xml_path}});
    } else if (!images.count && job_ok(job)) {
        job_note(&catalogue->job, "%s: %s: none of the volumes that it names is there", catalogue->source.name,
                 xml_path);
    }
}

void fsl_look(struct job *job, conus_catalogue *catalogue, const char *xml_path)
{
    struct attempt attempt = job_try(job);
    size_t place = job_in(job, xml_path, JOB_ALONE);
    struct bytes bytes = job_read(job, xml_path, FSL_ATLAS_LIMIT, "");
    job_out(job, place);
    struct text text = text_from_bytes(bytes.data, bytes.size);
    const struct fsl_atlas *atlas = text_equal(xml_root(text), "atlas") ? fsl_atlas_parse(job, text) : NULL;
    if (!attempt_end(job, &attempt, ATTEMPT_TRY) && atlas) {
        take_atlas(job, catalogue, xml_path, atlas);
    }
}
