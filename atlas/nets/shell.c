/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a closed surface around all areas and the head in the context, in a smoothed grid of 0 outside and 1 inside. */
#include "atlas/fit/fit.h"
#include "atlas/nets/parts.h"
#include "atlas/space.h"
#include "base/memory.h"
#include "conus/atlas.h"

#include <string.h>

enum { CELLS = 96, SMOOTHINGS = 2 };

static const double DEFAULT_OPACITY = 0.12;

/* What the grid is at the surface. The smoothings have a standard deviation of a cube's edge, so that it lies 0.84 of
 * one outside the border, which is at a half: areas at the border do not show through. */
static const double LEVEL = 0.2;

/* What lies between areas along two of the axes is inside, too: gaps, sulci and what is below the cortex. */
static conus_status enclose_all(struct net_grid *grid)
{
    uint8_t *marks = memory_zeroed(grid->count, sizeof *marks);
    if (!marks) {
        return CONUS_ERROR_MEMORY;
    }
    enclose(marks, grid->inside, 1, grid->dim);
    for (size_t point = 0; point < grid->count; point++) {
        grid->inside[point] = marks[point];
    }
    memory_free(marks);
    return CONUS_OK;
}

/* Along one axis by weights of 1, 2, 1; those at the ends stay. */
static void smooth_line(float *points, size_t count, size_t step)
{
    float before = points[0];
    for (size_t i = 1; i + 1 < count; i++) {
        const float is = points[i * step];
        points[i * step] = (before + 2 * is + points[(i + 1) * step]) / 4;
        before = is;
    }
}

static void smooth(struct net_grid *grid)
{
    for (int a = 0; a < 3; a++) {
        for (size_t point = 0; point < grid->count; point++) {
            size_t index[3];
            net_grid_index(index, grid, point);
            if (index[a] == 0) {
                smooth_line(grid->inside + point, grid->dim[a], grid->step[a]);
            }
        }
    }
}

/* Two triangles of each square, which face outside. */
static conus_status find_border(struct mesh *out, const struct net_grid *grid)
{
    static const int corners[6] = {0, 1, 2, 0, 2, 3};
    struct net net = {0};
    struct mesh mesh = {0};
    conus_status status = net_find(&net, grid);
    status = status ? status : mesh_init(&mesh, net.vertex_count, 2 * net.square_count);
    for (size_t i = 0; !status && i < 6 * net.square_count; i++) {
        const struct net_square *square = &net.squares[i / 6];
        mesh.triangles[i] = square->corners[corners[square->objects[0] ? i % 6 : 5 - i % 6]];
    }
    if (!status) {
        memcpy(mesh.positions, net.vertices, 3 * net.vertex_count * sizeof *net.vertices);
        *out = mesh;
    }
    net_finish(&net);
    return status;
}

static conus_status fill_grid(struct net_grid *out, const conus_atlas *atlas)
{
    const struct volume *context = atlas_context(atlas);
    struct head head = {0};
    struct box3 box = box3_empty();
    conus_status status = conus_atlas_bounds(box.low, box.high, atlas);
    if (!status && context) {
        const struct box3 grid = space_grid_box(&context->info);
        box3_join(&box, grid.low, grid.high);
        status = head_make(&head, context);
    }
    const double longest = fmax(fmax(box.high[0] - box.low[0], box.high[1] - box.low[1]), box.high[2] - box.low[2]);
    status = status ? status : net_grid_init(out, box.low, box.high, fmax(longest, 1e-6) / CELLS);
    if (!status) {
        out->inside = memory_zeroed(out->count, sizeof *out->inside);
        status = out->inside ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    for (size_t point = 0; !status && point < out->count; point++) {
        double at[3];
        bool in_head = false;
        net_grid_middle(at, out, point);
        in_head = context && head_grid_has(&in_head, &head, at) && in_head;
        out->inside[point] = in_head || net_area_at(atlas, at) ? 1 : 0;
    }
    head_finish(&head);
    return status ? status : enclose_all(out);
}

conus_status conus_atlas_add_shell(conus_atlas *atlas, double opacity)
{
    struct net_grid grid = {0};
    struct notes notes = {0}; /* of triangles without an area, which none needs to know of */
    struct context_surface surface = {.is_shell = true, .opacity = opacity != 0 ? opacity : DEFAULT_OPACITY};
    if (!(surface.opacity > 0 && surface.opacity <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "shell: opacity of %g; allowed is above 0 to 1", opacity);
    }
    conus_status status = fill_grid(&grid, atlas);
    for (int n = 0; n < SMOOTHINGS && !status; n++) {
        smooth(&grid);
    }
    grid.level = LEVEL;
    for (size_t point = 0; !status && point < grid.count; point++) {
        grid.objects[point] = (double)grid.inside[point] >= LEVEL;
    }
    status = status ? status : find_border(&surface.mesh, &grid);
    if (!status && !surface.mesh.triangle_count) {
        status = fail(CONUS_ERROR_ARGUMENT, "shell: there are no voxels of areas or of a head to be around");
    }
    status = status ? status : mesh_check(&surface.mesh, &notes);
    status = status ? status : atlas_add_context_surface(atlas, &surface);
    net_grid_finish(&grid);
    notes_finish(&notes);
    mesh_finish(&surface.mesh);
    return status;
}
