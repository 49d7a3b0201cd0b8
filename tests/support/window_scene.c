/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a phantom in a window that is not drawn. */
#include "window_scene.h"

#include "conus/own.h"
#include "test.h"

#include <stdio.h>

void window_scene_open(struct window *out, struct viewer *viewer)
{
    window_scene_open_phantom(out, viewer, "nested");
}

void window_scene_open_phantom(struct window *out, struct viewer *viewer, const char *phantom)
{
    conus_atlas *atlas = NULL;
    char path[600];
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch("phantom"));
    assert_ok(conus_phantom_write(phantom, folder, NULL));
    snprintf(path, sizeof path, "%s/%s.nii.gz", folder, phantom);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_ok(viewer_create(viewer, &(struct view_source){.atlas = atlas, .path = path}, 1, NULL, NULL, NULL));
    *out = (struct window){.viewer = viewer, .screen.enlarged = -1};
}
