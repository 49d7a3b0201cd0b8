/* SPDX-License-Identifier: BSD-3-Clause */
/* Prints the version of the library, and the best area of a cone into the atlas that is given. */
#include "conus/selection.h"
#include "conus/version.h"

#include <stdio.h>

int main(int count, char **words)
{
    const double origin[3] = {0, 0, 60}, target[3] = {0, 0, 0};
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    conus_status status = conus_pose_toward(&pose, origin, target, NULL);
    if (!status) {
        status = conus_atlas_load(&atlas, count > 1 ? words[1] : "", NULL);
    }
    if (!status) {
        status = conus_selector_create(&selector, atlas, NULL);
    }
    if (!status) {
        status = conus_select(&selection, selector, &pose, 40);
    }
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
    } else {
        printf("%s %s\n", conus_version(),
               conus_atlas_object(atlas, conus_selection_result(selection, 0)->object)->name);
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return status != CONUS_OK;
}
