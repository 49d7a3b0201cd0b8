/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a value of a row, by its type. */
#include "selection/table/cell.h"

#include "atlas/placement.h"
#include "base/geometry/math3.h"

#include <string.h>

struct cell cell_at(enum column_type type, const void *place, const conus_atlas *atlas, const conus_frame *frame)
{
    const uint32_t *count = place;
    const double *numbers = place;
    double point[3];
    switch (type) {
    case COLUMN_RANK:
        return *count ? integer_cell(*count) : no_cell();
    case COLUMN_COUNT:
        return integer_cell(*count);
    case COLUMN_LARGE_COUNT:
        return integer_cell(*(const uint64_t *)place);
    case COLUMN_TEXT:
        return text_cell(*(const char *const *)place);
    case COLUMN_ANGLE:
        return number_cell(degrees_from_radians(*numbers));
    case COLUMN_TIME:
        return isfinite(*numbers) ? (struct cell){.type = CELL_TIME, .number = *numbers} : no_cell();
    case COLUMN_X:
    case COLUMN_Y:
    case COLUMN_Z:
        memcpy(point, numbers, sizeof point);
        conus_frame_from_world(point, frame, point);
        return number_cell(point[type - COLUMN_X]);
    case COLUMN_OWN_X:
    case COLUMN_OWN_Y:
    case COLUMN_OWN_Z:
        memcpy(point, numbers, sizeof point);
        if (frame->space < CONUS_SPACE_CCF) { /* which is the atlas's own */
            conus_atlas_own_point(point, atlas, point);
        }
        conus_frame_from_world(point, frame, point);
        return number_cell(point[type - COLUMN_OWN_X]);
    default:
        return number_cell(*numbers);
    }
}
