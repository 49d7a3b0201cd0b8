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
    fsl_atlas_finish(&maps->atlas);
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
        char *path = NULL;
        const char *image = maps->atlas.images[i].image;
        status = image ? fsl_image_find(&path, xml, image) : CONUS_OK;
        status = !status && path ? take_if_finer(maps, atlas, path, options) : status;
        memory_free(path);
    }
    if (!status && !maps->image.path) {
        return fail(CONUS_ERROR_DATA, "fsl: none of the %zu images of %s is there (<imagefile> is relative to the XML)",
                    maps->atlas.image_count, path_base(xml));
    }
    return status;
}

static conus_status read_xml(struct fsl_maps *maps, conus_atlas *atlas, const char *xml)
{
    struct bytes bytes = {0};
    conus_status status = file_read(&bytes, xml, FSL_ATLAS_LIMIT);
    if (!status) {
        status = fsl_atlas_parse(&maps->atlas, text_from_bytes(bytes.data, bytes.size));
        status = status ? fail_in(status, xml) : CONUS_OK;
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
    struct notes *notes;
};

static conus_status compare_with_rival(void *user, struct fsl_atlas *atlas, const char *path, const struct bytes *file)
{
    const struct rival *rival = user;
    struct notes silent = {0};
    bool differ;
    (void)file;
    conus_status status = label_table_sort(&atlas->labels, &silent);
    status = status ? status
                    : label_tables_note(&differ, &rival->maps->atlas.labels, rival->xml, &atlas->labels,
                                        path_base(path), rival->notes);
    notes_finish(&silent);
    return status;
}

/* Other XMLs, and a table beside the image, may call its volumes otherwise. */
static conus_status compare_map_names(struct fsl_maps *maps, const char *xml, uint64_t max_memory, struct notes *notes)
{
    struct rival rival = {maps, path_base(xml), notes};
    struct label_table table = {0};
    struct buffer from = {0};
    struct notes silent = {0};
    const struct label_use use = {.info = &maps->image.info, .max_memory = max_memory};
    bool differ;
    conus_status status = fsl_atlas_each(maps->image.path, FSL_VOLUMES, compare_with_rival, &rival);
    status = status ? status : label_volume_table(&table, &from, NULL, &use, &silent);
    if (!status && table.count) {
        status = label_tables_note(&differ, &maps->atlas.labels, rival.xml, &table, from.data, notes);
    }
    label_table_finish(&table);
    buffer_finish(&from);
    notes_finish(&silent);
    return status;
}

conus_status fsl_maps_open(struct fsl_maps *out, conus_atlas *atlas, const char *xml, const char *image,
                           const conus_load_options *options)
{
    struct fsl_maps maps = {0};
    conus_status status = read_xml(&maps, atlas, xml);
    if (!status) {
        status = image ? take_if_finer(&maps, atlas, image, options) : choose_image(&maps, atlas, xml, options);
    }
    const size_t labels = maps.atlas.labels.count;
    status = status ? status : label_drop_background(&maps.has_background, &maps.atlas.labels, &atlas->notes);
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
