/* SPDX-License-Identifier: BSD-3-Clause */
/* Describes a voxel grid: axes, codes, size of a voxel. */
#include "atlas/space.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/tolerance.h"

#include <stdio.h>
#include <string.h>

/* The most aligned pair (voxel axis, world axis) of those that are both still free. */
static void find_closest_pair(int *voxel, int *world, const double m[16], const bool voxel_done[3],
                              const bool world_done[3])
{
    double best = -1;
    for (int pair = 0; pair < 9; pair++) {
        int v = pair / 3;
        int w = pair % 3;
        double cosine = fabs(m[4 * v + w]) / vec3_length(m + 4 * v);
        if (!voxel_done[v] && !world_done[w] && cosine > best) {
            best = cosine;
            *voxel = v;
            *world = w;
        }
    }
}

/* The axes get distinct letters, as in nibabel's io_orientation for matrices without shear. */
static void name_axes(char orientation[4], const double m[16])
{
    static const char letters[2][4] = {"LPI", "RAS"};
    bool voxel_done[3] = {false};
    bool world_done[3] = {false};
    for (int pass = 0; pass < 3; pass++) {
        int v = 0;
        int w = 0;
        find_closest_pair(&v, &w, m, voxel_done, world_done);
        voxel_done[v] = world_done[w] = true;
        orientation[v] = letters[m[4 * v + w] > 0][w];
    }
    orientation[3] = '\0';
}

conus_status space_invert(double out[16], const double m[16], const char *words)
{
    double inverse[16];
    double edges = 1;
    if (!mat4_is_affine(m)) {
        return fail(CONUS_ERROR_DATA, "%s: the matrix has the last row %g %g %g %g, 0 0 0 1 is needed", words, m[3],
                    m[7], m[11], m[15]);
    }
    for (int axis = 0; axis < 3; axis++) {
        double step = hypot(hypot(m[4 * axis], m[4 * axis + 1]), m[4 * axis + 2]); /* squares may be 0, or infinite */
        edges *= step;
        if (step > 0 && !(step >= SPACE_LEAST_STEP && step <= SPACE_MOST_STEP)) {
            return fail(CONUS_ERROR_DATA, "%s: a step along axis %d is %g mm long, allowed are %g to %g", words, axis,
                        step, SPACE_LEAST_STEP, SPACE_MOST_STEP);
        }
    }
    if (!mat4_invert_affine(inverse, m) || !(fabs(mat4_determinant3(m)) >= SPACE_FLATTEST * edges)) {
        return fail(CONUS_ERROR_DATA, "%s: the matrix is singular or not finite, an invertible one is needed", words);
    }
    if (!(vec3_length(m + 12) <= SPACE_FARTHEST && vec3_length(inverse + 12) <= SPACE_FARTHEST_STEPS)) {
        return fail(CONUS_ERROR_DATA, "%s: it begins %g mm, %g steps, from the origin, allowed are up to %g mm, %g",
                    words, vec3_length(m + 12), vec3_length(inverse + 12), SPACE_FARTHEST, SPACE_FARTHEST_STEPS);
    }
    memcpy(out, inverse, sizeof inverse);
    return CONUS_OK;
}

conus_status space_describe(conus_volume_info *info, const double world_from_voxel[16], const char *transform)
{
    double inverse[16];
    conus_status status = space_invert(inverse, world_from_voxel, transform);
    if (status) {
        return status;
    }
    double reach = space_corner_distance(info->dim, world_from_voxel, (const double[16]){0});
    if (!(reach <= SPACE_FARTHEST)) {
        return fail(CONUS_ERROR_DATA, "%s: a corner of the grid is %g mm from the origin, allowed are up to %g",
                    transform, reach, SPACE_FARTHEST);
    }
    memcpy(info->world_from_voxel, world_from_voxel, sizeof info->world_from_voxel);
    snprintf(info->transform, sizeof info->transform, "%s", transform);
    for (int axis = 0; axis < 3; axis++) {
        info->spacing[axis] = vec3_length(world_from_voxel + 4 * axis);
    }
    name_axes(info->orientation, world_from_voxel);
    return CONUS_OK;
}

bool space_same_grid(const conus_volume_info *a, const conus_volume_info *b)
{
    static const double nothing[16];
    return memcmp(a->dim, b->dim, sizeof a->dim) == 0 &&
           space_corner_distance(a->dim, a->world_from_voxel, b->world_from_voxel) <=
               TOLERANCE * space_corner_distance(a->dim, a->world_from_voxel, nothing);
}

double space_voxel_mm3(const conus_volume_info *info)
{
    return fabs(mat4_determinant3(info->world_from_voxel));
}

bool space_is_guess(const conus_volume_info *info)
{
    bool same = true;
    for (int i = 0; i < 3; i++) {
        double step = i == 0 ? -info->spacing[i] : info->spacing[i];
        double guess[4] = {0};
        guess[i] = step;
        guess[3] = -step * ((double)info->dim[i] - 1) / 2;
        for (int column = 0; column < 4; column++) {
            double found = info->world_from_voxel[4 * column + i];
            same = same && fabs(found - guess[column]) <= 2 * TOLERANCE * info->spacing[i];
        }
    }
    return same;
}

const char *space_code_name(int code)
{
    static const char *const names[] = {"unknown",   "scanner", "aligned to another",
                                        "Talairach", "MNI 152", "other template"};
    return code >= 0 && code < (int)(sizeof names / sizeof names[0]) ? names[code] : "unknown";
}

conus_grid_view space_grid(const conus_volume_info *info)
{
    conus_grid_view view = {.count = info->dim[0] * info->dim[1] * info->dim[2]};
    memcpy(view.dim, info->dim, sizeof view.dim);
    memcpy(view.world_from_voxel, info->world_from_voxel, sizeof view.world_from_voxel);
    view.space_code = info->space_code || space_is_guess(info) ? info->space_code : SPACE_ALIGNED;
    return view;
}

conus_status grid_create(conus_grid **out, const conus_volume_info *info, conus_number number, const char *description)
{
    static const size_t sizes[] = {
        [CONUS_NUMBER_UINT8] = 1, [CONUS_NUMBER_UINT16] = 2, [CONUS_NUMBER_UINT32] = 4, [CONUS_NUMBER_FLOAT32] = 4};
    conus_grid *grid = memory_zeroed(1, sizeof *grid);
    if (!grid) {
        return CONUS_ERROR_MEMORY;
    }
    conus_grid_view *view = &grid->view;
    *view = space_grid(info);
    view->number = number;
    view->description = memory_text(description, strlen(description));
    grid->size = sizes[number];
    view->data = grid->data = memory_zeroed(view->count, grid->size);
    if (!view->description || !grid->data) {
        conus_grid_destroy(grid);
        return CONUS_ERROR_MEMORY;
    }
    *out = grid;
    return CONUS_OK;
}

conus_grid_view conus_grid_data(const conus_grid *grid)
{
    return grid ? grid->view : (conus_grid_view){.description = ""};
}

void conus_grid_destroy(conus_grid *grid)
{
    if (grid) {
        memory_free((void *)grid->view.description);
        memory_free(grid->data);
        memory_free(grid);
    }
}

double space_corner_distance(const size_t dim[3], const double a[16], const double b[16])
{
    double largest = 0;
    for (int corner = 0; corner < 8; corner++) {
        double voxel[3];
        double at[2][3];
        for (int i = 0; i < 3; i++) {
            voxel[i] = corner >> i & 1 ? (double)dim[i] - 0.5 : -0.5;
        }
        mat4_point(at[0], a, voxel);
        mat4_point(at[1], b, voxel);
        vec3_sub(at[0], at[0], at[1]);
        largest = fmax(largest, vec3_length(at[0]));
    }
    return largest;
}
