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
