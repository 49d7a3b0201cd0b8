/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures the box around positions, and says where it is as small as a head's in metres. */
#include "poses/rows/pose_extent.h"

#include "base/geometry/math3.h"

#include <string.h>

static const double OF_ORIGIN = 1;
static const double OF_EACH_OTHER = 0.2;
enum { LEAST = 3 }; /* positions that say something by lying near each other */

void pose_extent_add(struct pose_extent *extent, const conus_pose_row *row)
{
    const double *p = row->pose.world_from_device + 12;
    if (row->error) {
        return;
    }
    for (int a = 0; a < 3; a++) {
        extent->low[a] = extent->count ? fmin(extent->low[a], p[a]) : p[a];
        extent->high[a] = extent->count ? fmax(extent->high[a], p[a]) : p[a];
    }
    extent->farthest = fmax(extent->farthest, vec3_length(p));
    extent->count++;
}

conus_status pose_extent_note(struct notes *notes, const struct pose_extent *extent, const char *source)
{
    double side = 0;
    for (int a = 0; a < 3; a++) {
        side = fmax(side, extent->high[a] - extent->low[a]);
    }
    bool near_origin = extent->farthest > 0 && extent->farthest <= OF_ORIGIN;
    bool near_each_other = extent->count >= LEAST && side > 0 && side <= OF_EACH_OTHER;
    const char *slash = strrchr(source, '/');
    source = slash ? slash + 1 : source;
    return near_origin || near_each_other
               ? notes_warn(notes, "all positions lie within %s, as if they were in metres; they are taken as mm%s%s%s",
                            near_origin ? "1 mm of the origin" : "0.2 mm of each other", source[0] ? ", as " : "",
                            source, source[0] ? " says" : "")
               : CONUS_OK;
}
