/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes atlases of labels in memory, and of drawn phantoms. */
#include "made_atlas.h"

#include "atlas/labels/labels.h"

conus_status atlas_create(conus_atlas **out, const conus_volume_info *info, const uint32_t *labels,
                          const struct label_table *table, const char *label_source, struct notes *notes)
{
    struct label_voxels voxels = {0};
    struct labelled_volume volume = {.info = info, .labels = &voxels};
    conus_status status = label_voxels_of(&voxels, labels, info->dim[0] * info->dim[1] * info->dim[2]);
    status = status ? status : atlas_create_of(out, &volume, 1, table, label_source, notes);
    label_voxels_finish(&voxels);
    return status;
}

static conus_status add_label(struct label_table *labels, const struct phantom_area *area, size_t index)
{
    struct label *label = label_table_add(labels, area->label);
    if (!label) {
        return CONUS_ERROR_MEMORY;
    }
    label->has_rgb = true;
    palette_colour(label->rgb, index);
    conus_status status = label_set_text(&label->name, text_from(area->name));
    return status ? status : label_set_text(&label->abbreviation, text_from(area->abbreviation));
}

conus_status phantom_drawing_atlas(conus_atlas **out, const struct phantom_drawing *drawing)
{
    struct label_table labels = {0};
    struct notes notes = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < drawing->phantom->area_count; i++) {
        status = add_label(&labels, &drawing->phantom->areas[i], i);
    }
    status = status ? status : label_table_sort(&labels, &notes);
    status = status ? status : atlas_create(out, &drawing->grid, drawing->labels, &labels, "phantom", &notes);
    notes_finish(&notes);
    label_table_finish(&labels);
    return status;
}
