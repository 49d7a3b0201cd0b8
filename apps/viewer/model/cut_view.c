/* SPDX-License-Identifier: BSD-3-Clause */
/* From the viewer's state to a cut. */
#include "viewer/model/cut_view.h"

#include <math.h>
#include <string.h>

/* It looks at the atlas's middle, but for the depth, which is the crosshair's. */
void cut_view(conus_cut_view *out, const struct viewer *viewer, enum plane plane, const double size[2])
{
    const double *grey = view_atlas_grey(viewer->drawn);
    *out =
        (conus_cut_view){.mm_per_pixel = 1.9 * viewer->radius / fmax(fmin(size[0], size[1]), 1) / viewer->magnification,
                         .width = (uint32_t)fmax(size[0], 1),
                         .height = (uint32_t)fmax(size[1], 1),
                         .fill = viewer->display.fill,
                         .no_outlines = viewer->display.no_outlines,
                         .window = {grey[0], grey[1]},
                         .selection = viewer_selection(viewer),
                         .chosen = viewer->drawn->shown.chosen};
    memcpy(out->centre, viewer->centre, sizeof out->centre);
    out->centre[2 - (int)plane] = viewer->crosshair[2 - (int)plane];
    viewer_plane(out->right, out->up, viewer, plane);
}
