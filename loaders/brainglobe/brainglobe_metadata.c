/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads metadata.json, and derives the matrices of voxels and vertices. */
#include "loaders/brainglobe/brainglobe.h"

#include "base/formats/json_text.h"
#include "base/geometry/math3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { METADATA_LIMIT = 1 << 20 };

static const double micrometre = 0.001; /* in mm */

/* Reads a list of three finite numbers above 0; false if it is none. */
static bool read_three(double out[3], const json_t *list)
{
    bool good = json_is_array(list) && json_array_size(list) == 3;
    for (size_t i = 0; good && i < 3; i++) {
        out[i] = json_number_value(json_array_get(list, i));
        good = out[i] > 0 && isfinite(out[i]);
    }
    return good;
}

void brainglobe_metadata_parse(struct job *job, struct brainglobe_metadata *out, struct text text)
{
    struct brainglobe_metadata metadata = *out;
    const json_t *root = json_text_read(job, text);
    const json_t *orientation = json_object_get(root, "orientation");
    const json_t *resolution = json_object_get(root, "resolution");
    const json_t *shape = json_object_get(root, "shape");
    const json_t *name = json_object_get(root, "name");
    if (!json_is_object(root)) {
        job_bad(job, "not a JSON object");
    }
    if (json_is_string(orientation)) {
        snprintf(metadata.orientation, sizeof metadata.orientation, "%s", json_string_value(orientation));
    } else if (orientation) {
        job_bad(job, "orientation: a text of three letters is needed");
    }
    if (resolution && !read_three(metadata.resolution, resolution)) {
        job_bad(job, "resolution: three numbers above 0, in micrometres, are needed");
    }
    double voxels[3];
    bool good = shape && read_three(voxels, shape);
    for (size_t i = 0; good && i < 3; i++) {
        good = voxels[i] >= 1 && voxels[i] <= INT32_MAX && voxels[i] == floor(voxels[i]); /* 528.0 as well */
        metadata.shape[i] = good ? (uint64_t)voxels[i] : 0;
    }
    if (shape && !good) {
        job_bad(job, "shape: three whole numbers above 0 are needed");
    }
    /* "allen_mouse"; old files have the resolution behind it. Other names do no harm. */
    metadata.is_allen_mouse = json_is_string(name) && text_starts(text_from(json_string_value(name)), "allen_mouse");
    if (job_ok(job)) {
        *out = metadata;
    }
}

bool brainglobe_metadata_take(struct job *job, struct brainglobe_metadata *out, const char *path)
{
    const char *file = job_beside(job, path, "metadata.json");
    if (!job_has_file(job, file)) {
        return false;
    }
    const size_t place = job_in(job, file, JOB_ALONE);
    const struct bytes bytes = job_read(job, file, METADATA_LIMIT, "");
    brainglobe_metadata_parse(job, out, (struct text){(const char *)bytes.data, bytes.size});
    job_made_of(job, file, &bytes);
    job_out(job, place);
    return true;
}

/* Row and sign of the world axis that grows away from `corner`: BrainGlobe's letters name where an array axis starts.
 */
static bool read_corner(int *row, double *sign, char corner)
{
    static const char letters[] = "LRPAIS"; /* starts there: grows along +x, -x, +y, -y, +z, -z */
    const char *at = corner ? strchr(letters, corner >= 'a' ? corner - 'a' + 'A' : corner) : NULL;
    if (!at) {
        return false;
    }
    *row = (int)(at - letters) / 2;
    *sign = (at - letters) % 2 ? -1 : 1;
    return true;
}

conus_status brainglobe_axes(double world_from_axes[16], const char *orientation, const double scale[3])
{
    bool used[3] = {false, false, false};
    memset(world_from_axes, 0, 16 * sizeof *world_from_axes);
    world_from_axes[15] = 1;
    for (int axis = 0; axis < 3; axis++) {
        int row = 0;
        double sign = 0;
        if (strlen(orientation) != 3 || !read_corner(&row, &sign, orientation[axis]) || used[row]) {
            return fail(CONUS_ERROR_DATA,
                        "orientation: found \"%.8s\", one letter each of R or L, A or P, S or I is needed",
                        orientation);
        }
        used[row] = true;
        world_from_axes[4 * axis + row] = sign * scale[axis];
    }
    return CONUS_OK;
}

conus_status brainglobe_voxels(double world_from_voxel[16], const struct brainglobe_metadata *metadata)
{
    double axes[16];
    double scale[3];
    vec3_scale(scale, metadata->resolution, micrometre);
    conus_status status = brainglobe_axes(axes, metadata->orientation, scale);
    if (status) {
        return status;
    }
    mat4_identity(world_from_voxel);
    for (int axis = 0; axis < 3; axis++) { /* columns of a stack are axis 2, pages axis 0 */
        memcpy(world_from_voxel + 4 * (2 - axis), axes + 4 * axis, 3 * sizeof *axes);
        vec3_add_scaled(world_from_voxel + 12, world_from_voxel + 12, 0.5, axes + 4 * axis);
    }
    return CONUS_OK;
}
