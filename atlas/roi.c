/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions of interest: voxels of a volume, tetrahedra of a mesh. */
#include "atlas/volume.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/text.h"
#include "conus/own.h"

#include <math.h>
#include <string.h>

/* Whether the volume or mesh has one value beside 0, as masks have. */
static bool is_mask(const conus_roi *roi, size_t count)
{
    float one = 0;
    for (size_t i = 0; i < count; i++) {
        float value = roi_value(roi, i);
        if (roi_value_belongs(value, 0) && value != one) {
            if (one != 0) {
                return false;
            }
            one = value;
        }
    }
    return true;
}

static void include_voxel(conus_roi *roi, size_t voxel)
{
    const size_t *dim = roi->volume.info.dim;
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    for (int a = 0; a < 3; a++) {
        roi->low[a] = !roi->voxels || at[a] < roi->low[a] ? at[a] : roi->low[a];
        roi->high[a] = !roi->voxels || at[a] > roi->high[a] ? at[a] : roi->high[a];
    }
    roi->voxels++;
}

/* Moves a tetrahedron up to those of the region. One that is flat has nothing in common with anything. */
static void include_tetrahedron(conus_roi *roi, size_t index)
{
    double mm3 = roi_tetrahedron_mm3((const double(*)[3])roi->nodes, &roi->tetrahedra[index]);
    if (mm3 > 0) {
        roi->mm3 += mm3;
        roi->tetrahedra[roi->voxels++] = roi->tetrahedra[index];
    }
}

/* Finds what of `count` voxels or tetrahedra belongs to the region. */
static conus_status mark(conus_roi *roi, size_t count)
{
    const conus_volume_info *info = &roi->volume.info;
    const char *each = roi->nodes ? "tetrahedron" : "voxel";
    char words[3][TEXT_NUMBER_SIZE];
    text_number(words[0], info->threshold);
    text_number(words[1], info->minimum);
    text_number(words[2], info->maximum);
    if (!isfinite(info->threshold)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: threshold %s, a finite number is needed", info->path, words[0]);
    }
    if (info->threshold == 0 && !is_mask(roi, count)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "%s: has values from %s to %s and is no mask%s: a threshold is needed, from which on a %s "
                    "belongs to the region (below 0: down from which)",
                    info->path, words[1], words[2],
                    info->minimum == 0 && info->maximum == 1 ? ", or was resampled (then take 0.5)" : "", each);
    }
    for (size_t i = 0; i < count; i++) {
        if (roi_value_belongs(roi_value(roi, i), info->threshold)) {
            if (roi->nodes) {
                include_tetrahedron(roi, i);
            } else {
                include_voxel(roi, i);
            }
        }
    }
    if (roi->voxels) {
        return CONUS_OK;
    }
    return info->threshold == 0 ? fail(CONUS_ERROR_DATA, "%s: no %s differs from 0", info->path, each)
                                : fail(CONUS_ERROR_ARGUMENT, "%s: threshold %s, but its values are from %s to %s",
                                       info->path, words[0], words[1], words[2]);
}

conus_status roi_create(conus_roi **out, const conus_volume_info *info, float *values)
{
    conus_roi *roi = memory_zeroed(1, sizeof *roi);
    conus_status status = roi ? volume_init(&roi->volume, info) : CONUS_ERROR_MEMORY;
    if (!status) {
        roi->volume.values = values;
        status = mark(roi, roi->volume.voxel_count);
    }
    if (status) {
        if (roi) {
            roi->volume.values = NULL; /* the caller's still */
        }
        conus_roi_destroy(roi);
        return status;
    }
    roi->mm3 = (double)roi->voxels * space_voxel_mm3(info);
    *out = roi;
    return CONUS_OK;
}

double roi_tetrahedron_mm3(const double (*nodes)[3], const struct tetrahedron *tetrahedron)
{
    const uint32_t *corners = tetrahedron->nodes;
    double edges[3][3];
    double cross[3];
    for (int k = 0; k < 3; k++) {
        vec3_sub(edges[k], nodes[corners[k + 1]], nodes[corners[0]]);
    }
    vec3_cross(cross, edges[0], edges[1]);
    return fabs(vec3_dot(cross, edges[2])) / 6;
}

void roi_middle(double out[3], const conus_roi *roi, size_t index)
{
    if (!roi->nodes) {
        grid_index(out, roi->volume.info.dim, index);
        mat4_point(out, roi->volume.info.world_from_voxel, out);
        return;
    }
    memset(out, 0, 3 * sizeof *out);
    for (int k = 0; k < 4; k++) {
        vec3_add_scaled(out, out, 0.25, roi->nodes[roi->tetrahedra[index].nodes[k]]);
    }
}

/* Places cells of 2 mm along the axes of the world round all tetrahedra; each is between the middles of cells. */
static conus_status place_grid(conus_volume_info *info, const struct roi_mesh *mesh)
{
    enum { EDGE = 2 };
    struct box3 box = box3_empty();
    double world[16] = {EDGE, [5] = EDGE, [10] = EDGE, [15] = 1};
    for (size_t i = 0; i < mesh->count; i++) {
        for (int k = 0; k < 4; k++) {
            box3_add(&box, mesh->nodes[mesh->tetrahedra[i].nodes[k]]);
        }
    }
    const double *low = box.low;
    const double *high = box.high;
    for (int a = 0; a < 3; a++) {
        if (!(fabs(low[a]) <= SPACE_FARTHEST && fabs(high[a]) <= SPACE_FARTHEST)) {
            return fail(CONUS_ERROR_DATA, "nodes: found from %g to %g mm, allowed are up to %g from the origin", low[a],
                        high[a], SPACE_FARTHEST);
        }
        world[12 + a] = low[a];
        info->dim[a] = (size_t)ceil((high[a] - low[a]) / EDGE) + 1;
    }
    return space_describe(info, world, "nodes");
}

conus_status roi_create_mesh(conus_roi **out, const conus_volume_info *info, const struct roi_mesh *mesh)
{
    conus_volume_info placed = *info;
    conus_roi *roi = memory_zeroed(1, sizeof *roi);
    conus_status status = roi ? place_grid(&placed, mesh) : CONUS_ERROR_MEMORY;
    placed.minimum = placed.maximum = NAN;
    for (size_t i = 0; i < mesh->count; i++) {
        placed.minimum = fmin(placed.minimum, (double)mesh->tetrahedra[i].value); /* of a NaN the other one */
        placed.maximum = fmax(placed.maximum, (double)mesh->tetrahedra[i].value);
    }
    status = status ? status : volume_init(&roi->volume, &placed);
    if (!status) {
        roi->nodes = mesh->nodes;
        roi->tetrahedra = mesh->tetrahedra;
        status = mark(roi, mesh->count);
    }
    if (status) {
        if (roi) {
            roi->nodes = NULL; /* the caller's still */
            roi->tetrahedra = NULL;
        }
        conus_roi_destroy(roi);
        return status;
    }
    for (int a = 0; a < 3; a++) {
        roi->high[a] = roi->volume.info.dim[a] - 1;
    }
    *out = roi;
    return CONUS_OK;
}

void conus_roi_destroy(conus_roi *roi)
{
    if (roi) {
        volume_finish(&roi->volume);
        memory_free(roi->nodes);
        memory_free(roi->tetrahedra);
        memory_free(roi);
    }
}

const conus_volume_info *conus_roi_volume(const conus_roi *roi)
{
    return &roi->volume.info;
}
