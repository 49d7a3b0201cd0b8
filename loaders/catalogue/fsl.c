/* SPDX-License-Identifier: BSD-3-Clause */
/* The images of an FSL atlas XML, by their resolution. */
#include "loaders/catalogue/catalogue.h"

#include "base/buffer.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "loaders/catalogue/volume_marks.h"
#include "loaders/labels/fsl_find.h"

#include <string.h>

/** A volume that is there. */
struct image {
    char *path;
    double spacing[3];
    struct catalogue_id id;
};

struct images {
    struct image *images; /* the finest first, once all are known */
    size_t count;
};

/* Bridge: to label tables on a job. */
static conus_status find_image(char **out, const char *xml_path, const char *written)
{
    struct job job = {0};
    char *path = fsl_image_find(&job, xml_path, written);
    *out = path ? job_give(&job, path, strlen(path) + 1) : NULL;
    return job_close(&job, NULL, NULL);
}

static double voxel_mm3(const struct image *image)
{
    return image->spacing[0] * image->spacing[1] * image->spacing[2];
}

/* Appends the volume that the XML calls `written`, unless it is there already or has no labels. */
static conus_status add_image(struct images *images, const char *xml_path, const char *written)
{
    struct image image = {0};
    struct stat info;
    bool labels = false;
    conus_status status = find_image(&image.path, xml_path, written);
    if (!status && image.path && stat(image.path, &info) == 0 && info.st_size) {
        image.id = catalogue_id_of(&info);
        status = volume_marks_find(&labels, image.spacing, image.path, true);
    }
    for (size_t i = 0; i < images->count; i++) {
        labels = labels && strcmp(images->images[i].path, image.path) != 0;
    }
    if (status || !labels) {
        memory_free(image.path);
        return status;
    }
    size_t at = images->count && voxel_mm3(&image) < voxel_mm3(&images->images[0]) ? 0 : images->count;
    if (at == 0 && images->count) {
        struct image other = images->images[0];
        images->images[0] = image;
        image = other;
    }
    images->images[images->count++] = image;
    return CONUS_OK;
}

static conus_status add_atlas(conus_catalogue *catalogue, const char *xml_path, const struct image *image, bool finest)
{
    const char *file = path_base(image->path);
    const char *xml = path_base(xml_path);
    struct buffer name = {0};
    char *alias = memory_text(file, volume_stem_length(file));
    buffer_append(&name, xml, strlen(xml) - strlen(".xml"));
    if (!finest) {
        buffer_format(&name, "-%gmm", image->spacing[0]);
    }
    struct catalogue_found found = {
        .name = name.data, .alias = alias, .kind = "volume", .path = image->path, .labels = xml_path, .id = image->id};
    memcpy(found.spacing, image->spacing, sizeof found.spacing);
    conus_status status = alias ? buffer_status(&name) : CONUS_ERROR_MEMORY;
    status = status ? status : catalogue_add(catalogue, &found);
    memory_free(alias);
    buffer_finish(&name);
    return status;
}

/* Whether one of the images with a volume for each label is there. */
static conus_status find_maps(bool *found, const struct fsl_atlas *atlas, const char *xml_path)
{
    conus_status status = CONUS_OK;
    *found = false;
    for (size_t i = 0; !status && !*found && !atlas->is_label && i < atlas->image_count; i++) {
        char *path = NULL;
        status = atlas->images[i].image ? find_image(&path, xml_path, atlas->images[i].image) : CONUS_OK;
        *found = path;
        memory_free(path);
    }
    return status;
}

/* The XML itself, whose labels are areas of probabilities. */
static conus_status add_maps(conus_catalogue *catalogue, const char *xml_path)
{
    const char *xml = path_base(xml_path);
    struct buffer name = {0};
    struct stat info;
    buffer_format(&name, "%.*s-prob", (int)(strlen(xml) - strlen(".xml")), xml);
    conus_status status = buffer_status(&name);
    if (!status && stat(xml_path, &info) == 0) {
        const struct catalogue_found found = {
            .name = name.data, .kind = "probabilities", .path = xml_path, .id = catalogue_id_of(&info)};
        status = catalogue_add(catalogue, &found);
    }
    buffer_finish(&name);
    return status;
}

static conus_status take_atlas(conus_catalogue *catalogue, const char *xml_path, const struct fsl_atlas *atlas)
{
    struct images images = {.images = memory_zeroed(atlas->image_count, sizeof(struct image))};
    bool maps = false;
    conus_status status = images.images ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < atlas->image_count; i++) {
        const struct fsl_image *image = &atlas->images[i];
        const char *written = atlas->is_label && image->image ? image->image : image->summary;
        status = written ? add_image(&images, xml_path, written) : CONUS_OK;
    }
    status = status ? status : find_maps(&maps, atlas, xml_path);
    for (size_t i = 0; !status && i < images.count; i++) {
        status = add_atlas(catalogue, xml_path, &images.images[i], i == 0);
    }
    if (!status && maps) {
        status = add_maps(catalogue, xml_path);
    } else if (!status && !images.count) {
        status = notes_add(&catalogue->notes, "%s: %s: none of the volumes that it names is there", catalogue->source,
                           xml_path);
    }
    for (size_t i = 0; i < images.count; i++) {
        memory_free(images.images[i].path);
    }
    memory_free(images.images);
    return status;
}

conus_status fsl_look(conus_catalogue *catalogue, const char *xml_path)
{
    struct bytes bytes = {0};
    struct job job = {0}; /* Bridge: to label tables on a job. */
    conus_status status = file_read(&bytes, xml_path, FSL_ATLAS_LIMIT);
    struct text text = text_from_bytes(bytes.data, bytes.size);
    bool is = !status && text_equal(xml_root(text), "atlas");
    const struct fsl_atlas *atlas = is ? fsl_atlas_parse(&job, text) : NULL;
    status = is ? job.status : status;
    if (is && !status) {
        status = take_atlas(catalogue, xml_path, atlas);
    } else if (status != CONUS_ERROR_MEMORY) {
        status = CONUS_OK;
    }
    job_end(&job);
    bytes_finish(&bytes);
    return status;
}
