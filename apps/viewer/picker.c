/* SPDX-License-Identifier: BSD-3-Clause */
/* What is under the mouse: single rays and small balls, by a selector of their own. */
#include "viewer/viewer.h"

#include <math.h>

static const double ray_angle = 1e-3; /* the one pixel's ray is the axis, whatever it is */

static conus_status make_picker(struct viewer *viewer)
{
    const conus_selector_options options = {.resolution = 1, .layers = CONUS_ALL_LAYERS};
    return viewer->picker ? CONUS_OK : conus_selector_create(&viewer->picker, viewer->atlas, &options);
}

uint32_t viewer_pick(double contact[3], struct viewer *viewer, const double origin[3], const double direction[3])
{
    conus_pose pose;
    conus_selection *selection = NULL;
    size_t count = 0;
    uint32_t object = 0;
    conus_status status = make_picker(viewer);
    status = status ? status : conus_pose_along(&pose, origin, direction, NULL);
    status = status ? status : conus_select(&selection, viewer->picker, &pose, ray_angle);
    const conus_span *spans = status ? NULL : conus_selection_spans(selection, &count);
    for (size_t i = 0; i < count && !object; i++) {
        object = viewer->hidden[spans[i].object] ? 0 : spans[i].object;
        for (int a = 0; a < 3 && object; a++) {
            contact[a] = origin[a] - spans[i].entry * pose.world_from_device[8 + a];
        }
    }
    conus_selection_destroy(selection);
    return object;
}

/* Half the diagonal of the pathway's voxels: a ball of it has the centre of one in it, wherever it is. */
static double reach_of(const conus_atlas *atlas, uint32_t ordinal)
{
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        const conus_volume_info *info = conus_atlas_volume(atlas, i);
        if (info->role == CONUS_SCALAR && --ordinal == 0) {
            const double *s = info->spacing;
            return 0.51 * sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        }
    }
    return 1;
}

double viewer_value(struct viewer *viewer, uint32_t object, const double place[3])
{
    const conus_object *info = conus_atlas_object(viewer->atlas, object);
    conus_selection *selection = NULL;
    double value = NAN;
    if (!info || info->kind != CONUS_PATHWAY || make_picker(viewer) ||
        conus_select_ball(&selection, viewer->picker, place, reach_of(viewer->atlas, info->label))) {
        return NAN;
    }
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        value = result->object == object && result->voxels ? result->max_value : value;
    }
    conus_selection_destroy(selection);
    return value;
}
