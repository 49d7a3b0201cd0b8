/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes and ends a conus_grid. */
#include "atlas/grid.h"

#include "atlas/space.h"
#include "base/memory.h"

#include <string.h>

conus_status grid_create(conus_grid **out, const conus_volume_info *info, conus_number number, const char *description)
{
    static const size_t sizes[] = {
        [CONUS_NUMBER_UINT8] = 1, [CONUS_NUMBER_UINT16] = 2, [CONUS_NUMBER_UINT32] = 4, [CONUS_NUMBER_FLOAT32] = 4};
    conus_grid *grid = memory_zeroed(1, sizeof *grid);
    if (!grid) {
        return CONUS_ERROR_MEMORY;
    }
    conus_grid_view *view = &grid->view;
    memcpy(view->dim, info->dim, sizeof view->dim);
    memcpy(view->world_from_voxel, info->world_from_voxel, sizeof view->world_from_voxel);
    view->space_code = info->space_code || space_is_guess(info) ? info->space_code : SPACE_ALIGNED;
    view->number = number;
    view->count = info->dim[0] * info->dim[1] * info->dim[2];
    view->description = memory_text(description, strlen(description));
    grid->size = sizes[number];
    view->data = grid->data = memory_zeroed(view->count, grid->size);
    if (!view->description || !grid->data) {
        conus_grid_destroy(grid);
        return CONUS_ERROR_MEMORY;
    }
    *out = grid;
    return CONUS_OK;
}

conus_grid_view conus_grid_data(const conus_grid *grid)
{
    return grid ? grid->view : (conus_grid_view){.description = ""};
}

void conus_grid_destroy(conus_grid *grid)
{
    if (grid) {
        memory_free((void *)grid->view.description);
        memory_free(grid->data);
        memory_free(grid);
    }
}
