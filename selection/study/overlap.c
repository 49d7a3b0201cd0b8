/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds up the shares of a region's voxels or tetrahedra in each object (Eq. 16): each is cut along the borders of
 * voxels where they part objects, grid after grid. */
#include "selection/study/study.h"

#include "atlas/space.h"
#include "atlas/surface/mesh.h"
#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "selection/selection.h"

#include <string.h>

/* Which shares of a box or tetrahedron lie in which objects of an atlas's volumes. */

/* Called for each piece of a box that lies in the same objects throughout: `count` of them, which may repeat. */
typedef void (*shares_take)(void *user, const uint32_t *objects, size_t count, double share);

/* Volumes whose voxels lie at the same places. */
struct share_grid {
    double from_previous[16]; /* Index coordinates from those of the grid before; of the first from the box's. */
    size_t end;               /* End of its volumes in shares.volumes; they begin where those of the grid before end. */
    double dim[3];            /* The largest of its volumes. */
};

struct shares {
    const struct volume **volumes; /* [volume_count] Those that can be covered, grid by grid. */
    size_t volume_count;
    struct share_grid *grids; /* [grid_count] */
    size_t grid_count;
    struct convex_stack stack;
    uint32_t *objects; /* [object_count] What holds the piece under way; the caller may put some there before. */
    size_t object_count;
    shares_take take;
    void *user;
};

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

static void shares_finish(struct shares *shares)
{
    convex_finish(&shares->stack);
    memory_free(shares->volumes);
    memory_free(shares->grids);
    memory_free(shares->objects);
    *shares = (struct shares){0};
}

/* `world_from_box` places the boxes. Room is left for `more` objects beside those of volumes. */
static conus_status shares_init(struct shares *out, const conus_atlas *atlas, const double world_from_box[16],
                                size_t more)
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

/* Hands the pieces of a polyhedron of volume `share`, whose edges are on shares->stack, to shares->take; their shares
 * sum to it. */
static conus_status shares_of_convex(struct shares *shares, const struct convex *convex, double share)
{
    return finish_piece(shares, convex, 0, share);
}

/* The same of a box. */
static conus_status shares_of_box(struct shares *shares, const double low[3], const double high[3], double share)
{
    const struct convex box = convex_box(low, high);
    return shares_of_convex(shares, &box, share);
}

/* The sums of all voxels or tetrahedra. */

/* Lines through a voxel along each of its first two axes, on which it is found what is in several surfaces or in none.
 */
enum { LINES = 4, QUARTERS = 4 };

static const double LEAST = 1e-9; /* part of a voxel that is no rounding of the inside of a mesh */

/* The sums for one object, as it is reported; number 0 is for no object. */
struct tally_of_pieces {
    double volume; /* of which a voxel of the region has 1, a tetrahedron its mm³ */
    uint64_t last; /* piece, from 1, that was counted last: an object that is met twice there counts once */
    size_t peak;   /* voxel or tetrahedron, where has_peak */
    bool has_peak;
    bool meets;                /* bounds of two of its surfaces do */
    double by_lines[QUARTERS]; /* how much of the volume lines have decided, by every second of them along i and j */
};

/* A mesh on the line under way: its crossings, of which those up to the piece are behind. */
struct crossed {
    uint32_t object;
    const struct line_crossing *next, *end;
    int winding;
};

/* Whether the volume of a surface in the region is summed up by itself, and is in the sum of what it is reported as,
 * and in that of all objects. Of a surface in that of an area above it nothing is. */
struct measured {
    bool of_group, of_all;
    bool has_part; /* in the region */
    double off;    /* its volume by lines less that; of a surface that is not summed up its volume by lines */
};

struct counting {
    const conus_selector *selector;
    const conus_roi *roi;
    struct tally_of_pieces *tallies; /* [object_count + 1] */
    struct shares shares;
    struct mesh_lines lines;      /* along k, in voxels of the region times per_voxel, from the first line on */
    size_t per_voxel;             /* lines along i and along j: LINES, or 1 without surfaces */
    struct measured *is_measured; /* [object_count + 1] */
    unsigned quarter;             /* of the line under way */
    struct crossed *crossed;      /* [object_count] */
    size_t crossed_count;
    size_t voxel;       /* the one under way, or the tetrahedron */
    uint64_t piece;     /* likewise, from 1 */
    struct box3 bounds; /* of the region in the world, with a voxel more on each side */
};

static const struct mesh *closed_mesh(const conus_atlas *atlas, uint32_t number)
{
    return atlas->objects[number - 1].closed ? atlas_object_mesh(atlas, number) : NULL;
}

static void find_bounds(struct counting *counting)
{
    const conus_roi *roi = counting->roi;
    struct box3 voxels;
    for (int a = 0; a < 3; a++) {
        voxels.low[a] = (double)roi->low[a] - 1.5;
        voxels.high[a] = (double)roi->high[a] + 1.5;
    }
    counting->bounds = box3_image(&voxels, roi->volume.info.world_from_voxel);
}

/* A closed mesh that may have something in the region; else NULL. Regions are small where they are clusters. */
static const struct mesh *near_mesh(const struct counting *counting, uint32_t number)
{
    const struct mesh *mesh = closed_mesh(counting->selector->atlas, number);
    for (int a = 0; mesh && a < 3; a++) {
        bool is_near = mesh->shape.low[a] <= counting->bounds.high[a] && mesh->shape.high[a] >= counting->bounds.low[a];
        mesh = is_near ? mesh : NULL;
    }
    return mesh;
}

static conus_status cross_meshes(struct counting *counting)
{
    const conus_atlas *atlas = counting->selector->atlas;
    double frame[16];
    conus_status status = CONUS_OK;
    counting->per_voxel = 1;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        counting->per_voxel = closed_mesh(atlas, number) ? LINES : counting->per_voxel;
    }
    /* `frame`: from world mm to numbers of lines, from the first one in the region's bounds on, and voxels along k */
    const conus_roi *roi = counting->roi;
    double per_voxel = (double)counting->per_voxel;
    double lines_from_voxel[16] = {[10] = 1, [15] = 1};
    for (int a = 0; a < 2; a++) {
        lines_from_voxel[5 * a] = per_voxel;
        lines_from_voxel[12 + a] = (0.5 - (double)roi->low[a]) * per_voxel - 0.5;
    }
    mat4_multiply(frame, lines_from_voxel, roi->volume.voxel_from_world);
    for (int a = 0; a < 2; a++) {
        counting->lines.step[a] = 1;
        counting->lines.count[a] = (counting->roi->high[a] - counting->roi->low[a] + 1) * counting->per_voxel;
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = near_mesh(counting, number);
        size_t count = mesh ? mesh->triangle_count : 0;
        for (size_t i = 0; !status && i < count; i++) {
            status = mesh_lines_cross(&counting->lines, number, mesh, i, frame);
        }
    }
    mesh_lines_sort(&counting->lines);
    return status;
}

/* First crossing of line `line` or a later one. */
static size_t first_crossing(const struct mesh_lines *lines, size_t line)
{
    size_t first = 0;
    for (size_t end = lines->crossing_count; first < end;) {
        size_t middle = first + (end - first) / 2;
        if (lines->crossings[middle].line < line) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first;
}

/* Makes counting->crossed of the line's crossings. */
static void enter_line(struct counting *counting, size_t line)
{
    const struct mesh_lines *lines = &counting->lines;
    counting->quarter = (unsigned)(line % lines->count[0] % 2 + 2 * (line / lines->count[0] % 2));
    counting->crossed_count = 0;
    for (size_t i = first_crossing(lines, line); i < lines->crossing_count && lines->crossings[i].line == line; i++) {
        const struct line_crossing *crossing = &lines->crossings[i];
        struct crossed *last = &counting->crossed[counting->crossed_count ? counting->crossed_count - 1 : 0];
        if (!counting->crossed_count || last->object != crossing->object) {
            last = &counting->crossed[counting->crossed_count++];
            *last = (struct crossed){.object = crossing->object, .next = crossing};
        }
        last->end = crossing + 1;
    }
}

/* Passes the crossings up to `at` on the line and notes the meshes around what follows there. Returns where the next
 * crossing is, at most at `end`. */
static double pass_crossings(struct counting *counting, double at, double end)
{
    struct shares *shares = &counting->shares;
    shares->object_count = 0;
    for (size_t i = 0; i < counting->crossed_count; i++) {
        struct crossed *crossed = &counting->crossed[i];
        while (crossed->next < crossed->end && crossed->next->z <= at) {
            crossed->winding += crossed->next++->side;
        }
        end = crossed->next < crossed->end ? fmin(end, crossed->next->z) : end;
        if (crossed->winding) {
            shares->objects[shares->object_count++] = crossed->object;
        }
    }
    return end;
}

static void add_share(struct counting *counting, struct tally_of_pieces *tally, size_t voxel, double share)
{
    const conus_roi *roi = counting->roi;
    double sign = roi->volume.info.threshold < 0 ? -1 : 1;
    double more = sign * ((double)roi_value(roi, voxel) - (double)roi_value(roi, tally->peak));
    /* The peak is farthest from 0, and of several such voxels the first in the file. */
    if (!tally->has_peak || more > 0 || (more == 0 && voxel < tally->peak)) {
        tally->peak = voxel;
        tally->has_peak = true;
    }
    tally->volume += share;
}

/* What is measured by itself is in the sum already: of a piece in several objects of a group the rest is taken away. */
static void count_object(struct counting *counting, uint32_t object, bool is_in_mesh, double share)
{
    struct tally_of_pieces *tally = &counting->tallies[level_group(counting->selector->level)[object]];
    const bool is_measured = counting->is_measured[object].of_group;
    const bool is_exact = is_measured || !atlas_object_mesh(counting->selector->atlas, object);
    if (tally->last != counting->piece) {
        tally->last = counting->piece;
        if (!is_measured) {
            add_share(counting, tally, counting->voxel, share);
        }
        tally->by_lines[counting->quarter] += is_exact ? 0 : share;
    } else if (is_in_mesh && is_exact) {
        tally->volume -= is_measured ? share : 0;
        tally->by_lines[counting->quarter] -= share;
    }
}

/* Meshes are first among the objects. */
static void count_piece(void *user, const uint32_t *objects, size_t count, double share)
{
    struct counting *counting = user;
    struct tally_of_pieces *none = &counting->tallies[0];
    const bool is_in_mesh = count && atlas_object_mesh(counting->selector->atlas, objects[0]);
    const bool is_in_volume = count && !atlas_object_mesh(counting->selector->atlas, objects[count - 1]);
    size_t measured = 0;
    counting->piece++;
    for (size_t i = 0; i < count; i++) {
        count_object(counting, objects[i], is_in_mesh, share);
        measured += counting->is_measured[objects[i]].of_all;
        counting->is_measured[objects[i]].off += share;
    }
    if (count == 0) {
        add_share(counting, none, counting->voxel, share);
    } else if (is_in_mesh) {
        none->volume += (double)measured * share;
        none->by_lines[counting->quarter] += ((double)measured - !is_in_volume) * share;
    }
}

/* Counts what is of a voxel round line (i, j) of the region's bounds: a bar of it, cut where meshes cross the line. */
static conus_status count_bar(struct counting *counting, size_t i, size_t j, double k)
{
    const size_t *corner = counting->roi->low;
    double step = 1 / (double)counting->per_voxel;
    double low[3] = {(double)corner[0] - 0.5 + (double)i * step, (double)corner[1] - 0.5 + (double)j * step, k - 0.5};
    double high[3] = {low[0] + step, low[1] + step};
    conus_status status = CONUS_OK;
    while (!status && low[2] < k + 0.5) {
        high[2] = pass_crossings(counting, low[2], k + 0.5);
        status = shares_of_box(&counting->shares, low, high, step * step * (high[2] - low[2]));
        low[2] = high[2];
    }
    return status;
}

/* Counts what is round one line. */
static conus_status count_line(struct counting *counting, size_t i, size_t j)
{
    const conus_roi *roi = counting->roi;
    const size_t *dim = roi->volume.info.dim;
    size_t column = roi->low[0] + i / counting->per_voxel + dim[0] * (roi->low[1] + j / counting->per_voxel);
    conus_status status = CONUS_OK;
    enter_line(counting, i + counting->lines.count[0] * j);
    for (size_t k = roi->low[2]; !status && k <= roi->high[2]; k++) {
        counting->voxel = column + dim[0] * dim[1] * k;
        if (roi_has(roi, counting->voxel)) {
            status = count_bar(counting, i, j, (double)k);
        }
    }
    return status;
}

static conus_status count_lines(struct counting *counting)
{
    const size_t *count = counting->lines.count;
    conus_status status = CONUS_OK;
    for (size_t line = 0; !status && line < count[0] * count[1]; line++) {
        status = count_line(counting, line % count[0], line / count[0]);
    }
    return status;
}

/* The part of `piece` between two planes across the axis. False without memory. */
static bool cut_out(struct convex *out, struct convex_stack *stack, const struct convex *piece, int axis, double low,
                    double high)
{
    struct convex part = *piece;
    bool fits = low <= part.low[axis] || convex_cut(&part, stack, &part, axis, low, true);
    fits =
        fits && (!(part.volume > 0) || high >= part.high[axis] || convex_cut(&part, stack, &part, axis, high, false));
    *out = part;
    return fits;
}

/* Counts a piece of a tetrahedron by bars round lines, cut where meshes cross them. Axis 0 and 1 choose the bar, which
 * begins with line `line`; axis 2 runs along it. */
static conus_status count_piece_of_mesh(struct counting *counting, const struct convex *piece, int axis, size_t line,
                                        double share)
{
    struct shares *shares = &counting->shares;
    const struct mesh_lines *lines = &counting->lines;
    double step = 1 / (double)counting->per_voxel;
    double high = piece->low[axis];
    size_t stride = axis ? lines->count[0] : 1;
    size_t bar = axis < 2 ? (size_t)fmax(floor((high + 0.5) / step), 0) : 0;
    conus_status status = CONUS_OK;
    if (axis == 2) {
        enter_line(counting, line);
    }
    for (double low = high; !status && low < piece->high[axis]; low = high, bar++) {
        struct convex part;
        size_t count = shares->stack.count;
        high = axis < 2 ? fmax((double)(bar + 1) * step - 0.5, low) : pass_crossings(counting, low, piece->high[2]);
        status = cut_out(&part, &shares->stack, piece, axis, low, high) ? CONUS_OK : CONUS_ERROR_MEMORY;
        double of_part = !status && part.volume > 0 ? share * fmin(part.volume / piece->volume, 1) : 0;
        if (of_part > 0) {
            status = axis < 2 ? count_piece_of_mesh(counting, &part, axis + 1, line + stride * bar, of_part)
                              : shares_of_convex(shares, &part, of_part);
        }
        shares->stack.count = count;
    }
    return status;
}

static conus_status count_tetrahedra(struct counting *counting)
{
    const conus_roi *roi = counting->roi;
    struct shares *shares = &counting->shares;
    conus_status status = CONUS_OK;
    for (counting->voxel = 0; !status && counting->voxel < roi->voxels; counting->voxel++) {
        const struct tetrahedron *tetrahedron = &roi->tetrahedra[counting->voxel];
        struct convex piece;
        double corners[4][3];
        for (int k = 0; k < 4; k++) {
            mat4_point(corners[k], roi->volume.voxel_from_world, roi->nodes[tetrahedron->nodes[k]]);
        }
        double share = roi_tetrahedron_mm3((const double(*)[3])roi->nodes, tetrahedron);
        status =
            convex_tetrahedron(&piece, &shares->stack, (const double(*)[3])corners) ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (!status) {
            status = counting->per_voxel > 1 ? count_piece_of_mesh(counting, &piece, 0, 0, share)
                                             : shares_of_convex(shares, &piece, share);
        }
        shares->stack.count = 0;
    }
    return status;
}

/* Adds up the inside of a mesh in the region's voxels. */
static conus_status measure_mesh(struct counting *counting, uint32_t number, const struct mesh *mesh)
{
    struct tally_of_pieces *tally = &counting->tallies[level_group(counting->selector->level)[number]];
    struct measured *measured = &counting->is_measured[number];
    const conus_roi *roi = counting->roi;
    const size_t *dim = roi->volume.info.dim;
    struct voxel_box box = {.low = {roi->low[0], roi->low[1], roi->low[2]},
                            .high = {roi->high[0], roi->high[1], roi->high[2]}};
    conus_status status = mesh_voxels_measure(&box, mesh, roi->volume.voxel_from_world);
    size_t count = !status && box.inside ? box.count[0] * box.count[1] * box.count[2] : 0;
    for (size_t i = 0; i < count; i++) {
        size_t at[3] = {box.low[0] + i % box.count[0], box.low[1] + i / box.count[0] % box.count[1],
                        box.low[2] + i / box.count[0] / box.count[1]};
        size_t voxel = at[0] + dim[0] * (at[1] + dim[1] * at[2]);
        if (box.inside[i] > LEAST && roi_has(roi, voxel)) {
            add_share(counting, tally, voxel, box.inside[i]);
            counting->tallies[0].volume -= measured->of_all ? box.inside[i] : 0;
            measured->off -= box.inside[i];
            measured->has_part = true;
        }
    }
    memory_free(box.inside);
    return status;
}

static bool bounds_meet(const struct mesh *a, const struct mesh *b)
{
    bool meet = true;
    for (int i = 0; i < 3 && meet; i++) {
        meet = a->shape.low[i] < b->shape.high[i] && b->shape.low[i] < a->shape.high[i];
    }
    return meet;
}

/* Notes what surface `number` may have in common with one before it, which all lines may pass by. */
static void meet_meshes(struct counting *counting, uint32_t number)
{
    const conus_atlas *atlas = counting->selector->atlas;
    const uint32_t *groups = level_group(counting->selector->level);
    const struct measured *is_measured = counting->is_measured;
    for (uint32_t before = 1; before < number && is_measured[number].has_part; before++) {
        if (is_measured[before].has_part &&
            bounds_meet(atlas_object_mesh(atlas, before), atlas_object_mesh(atlas, number))) {
            counting->tallies[0].meets |= is_measured[before].of_all && is_measured[number].of_all;
            counting->tallies[groups[number]].meets |= groups[before] == groups[number];
        }
    }
}

/* Measures the surfaces that have a volume. */
static conus_status measure_meshes(struct counting *counting)
{
    const conus_atlas *atlas = counting->selector->atlas;
    conus_status status = CONUS_OK;
    for (uint32_t number = 1; !status && number <= atlas->object_count; number++) {
        const struct mesh *mesh = near_mesh(counting, number);
        if (mesh && mesh->shape.has_volume) {
            struct measured *measured = &counting->is_measured[number];
            measured->of_group = !selector_lies_in_mesh(counting->selector, number, false);
            measured->of_all = !selector_lies_in_mesh(counting->selector, number, true);
            status = measured->of_group ? measure_mesh(counting, number, mesh) : CONUS_OK;
            meet_meshes(counting, number);
        }
    }
    return status;
}

/* How far the volume may be off, mm^3: the standard error of the mean of the quarters, as if they were samples, which
 * is too large, as lines fill each other's gaps; but no less than the lines are off for a surface of the object that is
 * measured, and than a bar in a voxel, since of borders along the axes all quarters have as much. */
static double error_of(const struct counting *counting, uint32_t object, double unit)
{
    const struct tally_of_pieces *tally = &counting->tallies[object];
    const uint32_t *groups = level_group(counting->selector->level);
    double sum = 0;
    double squares = 0;
    double off = 0;
    bool is_apart = true; /* as far as lines tell */
    for (int i = 0; i < QUARTERS; i++) {
        sum += tally->by_lines[i];
        is_apart = is_apart && tally->by_lines[i] == 0;
    }
    if (is_apart && !tally->meets) {
        return 0;
    }
    for (uint32_t number = 1; number <= counting->selector->atlas->object_count; number++) {
        const struct measured *measured = &counting->is_measured[number];
        bool counts = object ? measured->of_group && groups[number] == object : measured->of_all;
        double more = counts ? fabs(measured->off) : 0;
        off = is_apart ? off + more : fmax(off, more);
    }
    for (int i = 0; i < QUARTERS; i++) {
        squares += (QUARTERS * tally->by_lines[i] - sum) * (QUARTERS * tally->by_lines[i] - sum);
    }
    double bar = fabs(mat4_determinant3(counting->roi->volume.info.world_from_voxel)) / (LINES * LINES);
    return fmax(unit * fmax(sqrt(squares / (QUARTERS * (QUARTERS - 1))), off), bar);
}

static struct coverage describe(const struct counting *counting, uint32_t object)
{
    const struct tally_of_pieces *tally = &counting->tallies[object];
    const conus_roi *roi = counting->roi;
    const double all = roi->nodes ? roi->mm3 : (double)roi->voxels;
    double part = tally->volume / all;
    double whole = object ? counting->selector->whole[object] / roi->mm3 : 0;
    part = whole > 0 ? fmin(part, whole) : part; /* bars round lines may be wider than a thin surface */
    struct coverage row = {
        .object = {object ? conus_atlas_object(counting->selector->atlas, object)->kind : CONUS_KIND_UNASSIGNED,
                   object},
        .volume = part * roi->mm3,
        .fraction = whole > 0 ? part / whole : NAN,
        .roi_fraction = part,
        .volume_error = error_of(counting, object, roi->mm3 / all),
        .peak = (double)roi_value(roi, tally->peak)};
    roi_middle(row.peak_point, roi, tally->peak);
    return row;
}

static int compare_rows(const void *a, const void *b)
{
    const struct coverage *x = a;
    const struct coverage *y = b;
    int order = !x->object.number - !y->object.number;
    order = order ? order : compare_double(y->volume, x->volume);
    return order ? order : compare_unsigned(x->object.number, y->object.number);
}

conus_status overlap_find(struct coverage **out, size_t *count, const conus_selector *selector, const conus_roi *roi)
{
    size_t objects = selector->atlas->object_count + 1;
    struct counting counting = {.selector = selector, .roi = roi};
    *count = 0;
    *out = memory_raw(objects, sizeof **out);
    counting.tallies = memory_zeroed(objects, sizeof *counting.tallies);
    counting.crossed = memory_raw(objects, sizeof *counting.crossed);
    counting.is_measured = memory_zeroed(objects, sizeof *counting.is_measured);
    bool fits = *out && counting.tallies && counting.crossed && counting.is_measured;
    conus_status status =
        fits ? shares_init(&counting.shares, selector->atlas, roi->volume.info.world_from_voxel, objects)
             : CONUS_ERROR_MEMORY;
    counting.shares.take = count_piece;
    counting.shares.user = &counting;
    find_bounds(&counting);
    status = status || roi->nodes ? status : measure_meshes(&counting);
    status = status ? status : cross_meshes(&counting);
    status = status ? status : roi->nodes ? count_tetrahedra(&counting) : count_lines(&counting);
    for (uint32_t object = 0; !status && object < objects; object++) {
        if (counting.tallies[object].has_peak && counting.tallies[object].volume > 0) {
            (*out)[(*count)++] = describe(&counting, object);
        }
    }
    if (!status) {
        order_sort(*out, *count, sizeof **out, compare_rows);
    }
    shares_finish(&counting.shares);
    mesh_lines_finish(&counting.lines);
    memory_free(counting.tallies);
    memory_free(counting.crossed);
    memory_free(counting.is_measured);
    return status;
}

static struct cell rank(const struct table_source *source, const void *row, size_t index)
{
    return ((const struct table_object *)row)->number ? table_place(source, row, index) : no_cell();
}

static const struct table_field columns[] = {
    TABLE_IDENTITY,
    {"rank", NULL, "1 has the largest volume", TABLE_COUNT_BY(rank)},
    {"volume_mm3", "mm^3", "volume of the part of it that is in the region", TABLE_OF(NUMBER, struct coverage, volume)},
    {"fraction", NULL, "that part of the area or pathway, 0 to 1", TABLE_OF(NUMBER, struct coverage, fraction)},
    {"region_fraction", NULL, "that part of the region, 0 to 1", TABLE_OF(NUMBER, struct coverage, roi_fraction)},
    {"peak", NULL, "the region's value farthest from 0 there", TABLE_OF(NUMBER, struct coverage, peak)},
    TABLE_XYZ("peak_", "centre of the voxel that has it", TABLE_OF, struct coverage, peak_point),
    {"volume_error_mm3", "mm^3", COVERAGE_ERROR, TABLE_OF(NUMBER, struct coverage, volume_error), .unless_zeros = true},
};

const struct table_fields overlap_fields = {columns, sizeof columns / sizeof *columns};

conus_status overlap_table(conus_table **out, const conus_selector *selector, const struct table_fields *fields,
                           const conus_roi *roi, const void *rows, size_t size, size_t count)
{
    const conus_volume_info *info = &roi->volume.info;
    struct table_question asked = {.region = {.path = memory_text(info->path, strlen(info->path)),
                                              .volume = info->volume,
                                              .threshold = info->threshold,
                                              .volume_mm3 = roi->mm3,
                                              .tetrahedra = roi->nodes ? roi->voxels : 0}};
    memcpy(asked.region.sha256, info->sha256, sizeof asked.region.sha256);
    return asked.region.path ? table_create(out, &(struct table_source){selector->atlas, &selector->frame}, fields,
                                            &asked, rows, size, count)
                             : CONUS_ERROR_MEMORY;
}

conus_status conus_overlap(conus_table **out, const conus_selector *selector, const conus_roi *roi)
{
    struct coverage *rows;
    size_t count;
    if (!out || !selector || !roi) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_overlap: a result, a selector and a region are needed");
    }
    conus_status status = overlap_find(&rows, &count, selector, roi);
    status = status ? status : overlap_table(out, selector, &overlap_fields, roi, rows, sizeof *rows, count);
    memory_free(rows);
    return status;
}
