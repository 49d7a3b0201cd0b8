/* SPDX-License-Identifier: BSD-3-Clause */
#include "atlas/space.h"

#include "base/math3.h"

#include <stdio.h>
#include <string.h>

/* The axes get distinct letters: the most aligned pair of (voxel axis, world axis) is named first, as in nibabel's
 * io_orientation for matrices without shear. */
static void name_axes(char orientation[4], const double m[16])
{
    static const char letters[2][4] = {"LPI", "RAS"};
    bool voxel_done[3] = {false};
    bool world_done[3] = {false};
    for (int pass = 0; pass < 3; pass++) {
        int best_v = 0;
        int best_w = 0;
        double best = -1;
        for (int v = 0; v < 3; v++) {
            double length = vec3_length(m + 4 * v);
            for (int w = 0; w < 3; w++) {
                double cosine = fabs(m[4 * v + w]) / length;
                if (!voxel_done[v] && !world_done[w] && cosine > best) {
                    best = cosine;
                    best_v = v;
                    best_w = w;
                }
            }
        }
        voxel_done[best_v] = world_done[best_w] = true;
        orientation[best_v] = letters[m[4 * best_v + best_w] > 0][best_w];
    }
    orientation[3] = '\0';
}

conus_status space_describe(conus_volume_info *info, const double world_from_voxel[16], const char *transform)
{
    double inverse[16];
    if (!mat4_invert_affine(inverse, world_from_voxel)) {
        return fail(CONUS_ERROR_DATA, "%s: the matrix is singular or not finite, an invertible one is needed",
                    transform);
    }
    memcpy(info->world_from_voxel, world_from_voxel, sizeof info->world_from_voxel);
    snprintf(info->transform, sizeof info->transform, "%s", transform);
    for (int axis = 0; axis < 3; axis++) {
        info->spacing[axis] = vec3_length(world_from_voxel + 4 * axis);
    }
    name_axes(info->orientation, world_from_voxel);
    return CONUS_OK;
}

const char *space_code_name(int code)
{
    static const char *const names[] = {"unknown",   "scanner", "aligned to another",
                                        "Talairach", "MNI 152", "other template"};
    return code >= 0 && code < (int)(sizeof names / sizeof names[0]) ? names[code] : "unknown";
}
