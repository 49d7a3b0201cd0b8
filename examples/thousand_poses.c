/* SPDX-License-Identifier: BSD-3-Clause */
/* How far is the first area from each of 1,000 places around the head, mm? One line a pose. C99 and C++17. */
#include <conus/conus.h>

#include <math.h>
#include <stdio.h>

static bool print(void *file, const conus_answers *answers)
{
    for (size_t i = 0; i < answers->poses; i++) { /* a pose's first result is the best; what meets nothing has NaN */
        double mm = answers->status[i] ? NAN : answers->results[answers->starts[i]].distance; /* an error: no results */
        fprintf((FILE *)file, "%.2f\n", mm);
    }
    return true;
}

int main(int argc, char **argv)
{
    static double origins[1000][3], directions[1000][3];
    conus_pose_array poses = CONUS_POSE_ARRAY_INIT;
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    for (int i = 0; i < 1000; i++) { /* on a circle, towards its middle */
        directions[i][0] = -(origins[i][0] = 100 * cos(i * 6.283185307179586 / 1000));
        directions[i][1] = -(origins[i][1] = 100 * sin(i * 6.283185307179586 / 1000));
    }
    poses.count = 1000, poses.origin = origins[0], poses.direction = directions[0];
    conus_status status = conus_atlas_load(&atlas, argc > 1 ? argv[1] : "data-samples/u-shape.nii.gz", NULL);
    status = status ? status : conus_selector_create(&selector, atlas, NULL);
    status = status ? status : conus_select_many(NULL, selector, &poses, NULL, print, stdout);
    fprintf(stderr, "%s%s", status ? conus_message() : "", status ? "\n" : "");
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return status ? 1 : 0;
}
