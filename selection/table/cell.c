/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a value of a row, by its type. */
#include "selection/table/table.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"

#include <string.h>

void cell_point(double out[3], enum column_type type, const double world[3], const conus_atlas *atlas,
                const conus_frame *frame)
{
    memcpy(out, world, 3 * sizeof *out);
    if (type >= COLUMN_OWN_X && frame->space < CONUS_SPACE_CCF) { /* which is the atlas's own */
        conus_atlas_own_point(out, atlas, out);
    }
    conus_frame_from_world(out, frame, out);
}

struct cell cell_at(enum column_type type, const void *place, const conus_atlas *atlas, const conus_frame *frame)
{
    const uint32_t *count = place;
    const double *numbers = place;
    double point[3];
    switch (type) {
    case COLUMN_RANK:
        return *count ? integer_cell(*count) : no_cell();
    case COLUMN_LARGE_RANK:
        return *(const uint64_t *)place ? integer_cell(*(const uint64_t *)place) : no_cell();
    case COLUMN_FLAG:
        return integer_cell(*(const bool *)place);
    case COLUMN_COUNT:
        return integer_cell(*count);
    case COLUMN_LARGE_COUNT:
        return integer_cell(*(const uint64_t *)place);
    case COLUMN_TEXT:
        return text_cell(*(const char *const *)place);
    case COLUMN_TIME:
        return isfinite(*numbers) ? (struct cell){.type = CELL_TIME, .number = *numbers} : no_cell();
    case COLUMN_X:
    case COLUMN_Y:
    case COLUMN_Z:
    case COLUMN_OWN_X:
    case COLUMN_OWN_Y:
    case COLUMN_OWN_Z:
        cell_point(point, type, numbers, atlas, frame);
        return number_cell(point[(type - COLUMN_X) % 3]);
    default:
        return number_cell(*numbers);
    }
}
