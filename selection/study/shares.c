/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts polyhedra along the borders of voxels where they part objects, grid after grid. */
#include "selection/study/shares.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

static const double ROUNDING = 1e-4; /* of a voxel's edge: headers hold it in single precision */

/* Cells of a grid, both ends among them. */
struct cells {
    long low[3], high[3];
};

static bool counts(const struct volume *volume)
{
    return volume->info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(volume);
}

static bool same_grid(const struct volume *a, const struct volume *b)
{
    return mat4_is_same(a->voxel_from_world, b->voxel_from_world);
}

/* Appends a grid of all volumes from `first` on that lie as that one does, unless an earlier one did. */
static void add_grid(struct shares *shares, const conus_atlas *atlas, size_t first, const double world_from_box[16])
{
    const struct volume *volume = &atlas->volumes[first];
    size_t begin = shares->volume_count;
    for (size_t i = 0; i < begin; i++) {
        if (same_grid(shares->volumes[i], volume)) {
            return;
        }
    }
    struct share_grid *grid = &shares->grids[shares->grid_count++];
    const double *before = begin ? shares->volumes[begin - 1]->info.world_from_voxel : world_from_box;
    mat4_multiply(grid->from_previous, volume->voxel_from_world, before);
    for (size_t i = first; i < atlas->volume_count; i++) {
        const struct volume *other = &atlas->volumes[i];
        if (counts(other) && same_grid(other, volume)) {
            shares->volumes[shares->volume_count++] = other;
            for (int a = 0; a < 3; a++) {
                grid->dim[a] = fmax(grid->dim[a], (double)other->info.dim[a]);
            }
        }
    }
    grid->end = shares->volume_count;
}

conus_status shares_init(struct shares *out, const conus_atlas *atlas, const double world_from_box[16], size_t more)
{
    struct shares shares = {.volumes = memory_zeroed(atlas->volume_count + 1, sizeof(void *)),
                            .grids = memory_zeroed(atlas->volume_count + 1, sizeof *shares.grids),
                            .objects = memory_raw(atlas->volume_count + more + 1, sizeof *shares.objects)};
    if (!shares.volumes || !shares.grids || !shares.objects) {
        shares_finish(&shares);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (counts(&atlas->volumes[i])) {
            add_grid(&shares, atlas, i, world_from_box);
        }
    }
    *out = shares;
    return CONUS_OK;
}

void shares_finish(struct shares *shares)
{
    convex_finish(&shares->stack);
    memory_free(shares->volumes);
    memory_free(shares->grids);
    memory_free(shares->objects);
    *shares = (struct shares){0};
}

/* The cells that a piece is in; what reaches into one by rounding only is not. All cells outside are as the nearest. */
static struct cells find_cells(const struct convex *piece, const struct share_grid *grid)
{
    struct cells cells;
    for (int a = 0; a < 3; a++) {
        double low = fmin(fmax(floor(piece->low[a] + 0.5 + ROUNDING), -1), grid->dim[a]);
        double high = fmin(fmax(ceil(piece->high[a] - 0.5 - ROUNDING), low), grid->dim[a]);
        cells.low[a] = (long)low;
        cells.high[a] = (long)high;
    }
    return cells;
}

static uint32_t object_in(const struct volume *volume, long i, long j, long k)
{
    const size_t *dim = volume->info.dim;
    bool inside = i >= 0 && j >= 0 && k >= 0 && (size_t)i < dim[0] && (size_t)j < dim[1] && (size_t)k < dim[2];
    return inside ? volume_object(volume, (size_t)i + dim[0] * ((size_t)j + dim[1] * (size_t)k)) : 0;
}

static bool is_uniform(const struct volume *volume, const struct cells *cells, uint32_t object)
{
    bool uniform = true;
    for (long k = cells->low[2]; uniform && k <= cells->high[2]; k++) {
        for (long j = cells->low[1]; uniform && j <= cells->high[1]; j++) {
            for (long i = cells->low[0]; uniform && i <= cells->high[0]; i++) {
                uniform = object_in(volume, i, j, k) == object;
            }
        }
    }
    return uniform;
}

static conus_status share_piece(struct shares *shares, const struct convex *piece, size_t grid, double share);

/* Goes on with the next grid, or ends, where the piece is in the same objects of this one throughout. */
static conus_status finish_piece(struct shares *shares, const struct convex *piece, size_t grid, double share)
{
    struct convex moved;
    if (grid == shares->grid_count) {
        shares->take(shares->user, shares->objects, shares->object_count, share);
        return CONUS_OK;
    }
    size_t count = shares->stack.count;
    conus_status status = convex_move(&moved, &shares->stack, piece, shares->grids[grid].from_previous)
                              ? share_piece(shares, &moved, grid, share)
                              : CONUS_ERROR_MEMORY;
    shares->stack.count = count;
    return status;
}

/* Cuts a piece in two between the cells along the axis that has most of them. */
static conus_status cut_piece(struct shares *shares, const struct convex *piece, size_t grid, double share,
                              const struct cells *cells)
{
    conus_status status = CONUS_OK;
    double rest = share;
    int axis = 0;
    for (int a = 1; a < 3; a++) {
        axis = cells->high[a] - cells->low[a] > cells->high[axis] - cells->low[axis] ? a : axis;
    }
    long middle = cells->low[axis] + (cells->high[axis] - cells->low[axis]) / 2;
    double at = (double)middle + 0.5;
    for (int side = 0; !status && side < 2; side++) {
        struct convex part;
        size_t count = shares->stack.count;
        status = convex_cut(&part, &shares->stack, piece, axis, at, side != 0) ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (!status) {
            double of_part = side ? rest : share * fmin(part.volume / piece->volume, 1);
            rest -= of_part;
            status = of_part > 0 ? share_piece(shares, &part, grid, of_part) : CONUS_OK;
        }
        shares->stack.count = count;
    }
    return status;
}

static conus_status share_piece(struct shares *shares, const struct convex *piece, size_t grid, double share)
{
    struct cells cells = find_cells(piece, &shares->grids[grid]);
    size_t before = shares->object_count;
    conus_status status = CONUS_OK;
    bool uniform = true;
    for (size_t i = grid ? shares->grids[grid - 1].end : 0; uniform && i < shares->grids[grid].end; i++) {
        uint32_t object = object_in(shares->volumes[i], cells.low[0], cells.low[1], cells.low[2]);
        uniform = is_uniform(shares->volumes[i], &cells, object);
        if (object) {
            shares->objects[shares->object_count++] = object;
        }
    }
    if (uniform) {
        status = finish_piece(shares, piece, grid + 1, share);
    }
    shares->object_count = before;
    return uniform ? status : cut_piece(shares, piece, grid, share, &cells);
}

conus_status shares_of_box(struct shares *shares, const double low[3], const double high[3], double share)
{
    const struct convex box = convex_box(low, high);
    return shares_of_convex(shares, &box, share);
}

conus_status shares_of_convex(struct shares *shares, const struct convex *convex, double share)
{
    return finish_piece(shares, convex, 0, share);
}
