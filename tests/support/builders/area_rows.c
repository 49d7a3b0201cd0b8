/* SPDX-License-Identifier: BSD-3-Clause */
/* Small atlases with an area tree. */
#include "builders/area_rows.h"

#include "atlas/areas/areas.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "made_atlas.h"
#include "value_maps.h"

#include <string.h>

static conus_status add_row(struct label_table *table, const struct area_row *row)
{
    struct label *label = label_table_add(table, row->label);
    if (!label) {
        return CONUS_ERROR_MEMORY;
    }
    label->hemisphere = row->hemisphere;
    label->has_parent = row->parent != 0;
    label->parent = row->parent;
    conus_status status = label_set_text(&label->name, text_from(row->name));
    return status || !row->abbreviation ? status : label_set_text(&label->abbreviation, text_from(row->abbreviation));
}

static conus_status describe(conus_volume_info *info, const size_t dim[3])
{
    double m[16];
    *info = (conus_volume_info){.role = CONUS_ROLE_PARCELLATION, .path = "rows", .slope = 1};
    mat4_identity(m);
    for (size_t axis = 0; axis < 3; axis++) {
        info->dim[axis] = dim[axis];
        m[12 + axis] = -((double)dim[axis] - 1) / 2;
    }
    return space_describe(info, m, "test");
}

conus_status area_rows_atlas(conus_atlas **out, const size_t dim[3], const uint32_t *labels,
                             const struct area_row *rows)
{
    conus_volume_info info;
    struct label_table table = {0};
    struct notes notes = {0};
    conus_status status = describe(&info, dim);
    for (; !status && rows->label; rows++) {
        status = add_row(&table, rows);
    }
    status = status ? status : label_table_sort(&table, &notes);
    status = status ? status : atlas_create(out, &info, labels, &table, "rows", &notes);
    label_table_finish(&table);
    notes_finish(&notes);
    return status;
}

conus_status area_rows_pairs(conus_atlas **out, bool exchanged)
{
    static const struct area_row rows[] = {{1, "A_L", 0, NULL, 0},
                                           {2, "A_R", 0, NULL, 0},
                                           {3, "B_L", 0, NULL, 0},
                                           {4, "B_R", 0, NULL, 0},
                                           {5, "C_L", 0, NULL, 0},
                                           {6, "C_R", 0, NULL, 0},
                                           {0}};
    static const uint32_t labels[2][9] = {{1, 0, 2, 3, 0, 4, 5, 0, 6}, {2, 0, 1, 4, 0, 3, 6, 0, 5}};
    conus_status status = area_rows_atlas(out, (const size_t[]){3, 3, 1}, labels[exchanged], rows);
    return status ? status : conflicting_sides_note(*out);
}

uint32_t area_rows_number(const conus_atlas *atlas, const char *name)
{
    for (uint32_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        if (strcmp(conus_atlas_object(atlas, number)->name, name) == 0) {
            return number;
        }
    }
    return 0;
}

conus_status area_rows_add_pathway(conus_atlas *atlas, const char *name)
{
    conus_volume_info info = atlas->volumes[0].info;
    size_t count = atlas->volumes[0].voxel_count;
    float *values = memory_zeroed(count, sizeof *values);
    if (!values) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        values[i] = 1;
    }
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0.5;
    memcpy(info.unit, "probability", sizeof "probability");
    conus_status status = pathway_of_values(atlas, &info, values, name);
    memory_free(status ? values : NULL);
    return status;
}
