/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a closed surface around all areas and the head in the context, in a smoothed grid of 0 outside and 1 inside. */
#include "atlas/fit/fit.h"
#include "atlas/space.h"
#include "base/memory.h"
#include "conus/atlas.h"

#include <string.h>

enum { CELLS = 96, BORDER = 3, SMOOTHINGS = 2 };

static const double DEFAULT_OPACITY = 0.12;

/* What the grid is at the surface. The smoothings have a standard deviation of a cube's edge, so that it lies 0.84 of
 * one outside the border, which is at a half: areas at the border do not show through. */
static const double LEVEL = 0.2;

/* Cubes whose middles are the grid's points. Up to the border all are outside. */
struct shell_grid {
    double start[3], edge; /* of the first middle; world mm */
    size_t dim[3], step[3], count;
    float *inside; /* [count] */
};

static conus_status init_grid(struct shell_grid *out, const double low[3], const double high[3])
{
    struct shell_grid grid = {.count = 1};
    grid.edge = fmax(fmax(high[0] - low[0], high[1] - low[1]), fmax(high[2] - low[2], 1e-6)) / CELLS;
    for (int a = 0; a < 3; a++) {
        grid.dim[a] = (size_t)ceil((high[a] - low[a]) / grid.edge) + 2 * BORDER;
        grid.start[a] = (low[a] + high[a] - grid.edge * (double)(grid.dim[a] - 1)) / 2;
        grid.step[a] = grid.count;
        grid.count *= grid.dim[a];
    }
    grid.inside = memory_zeroed(grid.count, sizeof *grid.inside);
    *out = grid;
    return grid.inside ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static void find_index(size_t out[3], const struct shell_grid *grid, size_t point)
{
    for (int a = 0; a < 3; a++) {
        out[a] = point / grid->step[a] % grid->dim[a];
    }
}

static void find_middle(double out[3], const struct shell_grid *grid, size_t point)
{
    size_t index[3];
    find_index(index, grid, point);
    for (int a = 0; a < 3; a++) {
        out[a] = grid->start[a] + grid->edge * (double)index[a];
    }
}

static bool is_in_area(const conus_atlas *atlas, const double at[3])
{
    for (size_t v = 0; v < atlas->volume_count; v++) {
        const struct volume *volume = &atlas->volumes[v];
        size_t voxel;
        if (volume->info.role == CONUS_ROLE_PARCELLATION && volume_find_voxel(&voxel, volume, at)) {
            const uint32_t object = volume_object(volume, voxel);
            if (object && object != VOLUME_BLOCKER) {
                return true;
            }
        }
    }
    return false;
}

/* Adds 2 to all points between the first and the last one, of those with an odd number, along a line. */
static void enclose_line(float *points, size_t count, size_t step)
{
    size_t from = 0;
    size_t to = count;
    while (from < to && fmodf(points[from * step], 2) == 0) {
        from++;
    }
    while (to > from && fmodf(points[(to - 1) * step], 2) == 0) {
        to--;
    }
    for (; from < to; from++) {
        points[from * step] += 2;
    }
}

/* What lies between areas along two of the axes is inside, too: gaps, sulci and what is below the cortex. */
static void enclose(struct shell_grid *grid)
{
    for (size_t point = 0; point < grid->count; point++) {
        size_t index[3];
        find_index(index, grid, point);
        for (int a = 0; a < 3; a++) {
            if (index[a] == 0) {
                enclose_line(grid->inside + point, grid->dim[a], grid->step[a]);
            }
        }
    }
    for (size_t point = 0; point < grid->count; point++) {
        grid->inside[point] = grid->inside[point] >= 4;
    }
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

static void smooth(struct shell_grid *grid)
{
    for (int a = 0; a < 3; a++) {
        for (size_t point = 0; point < grid->count; point++) {
            size_t index[3];
            find_index(index, grid, point);
            if (index[a] == 0) {
                smooth_line(grid->inside + point, grid->dim[a], grid->step[a]);
            }
        }
    }
}

static bool is_inside(const struct shell_grid *grid, size_t point)
{
    return (double)grid->inside[point] >= LEVEL;
}

/* In the middle of where the border crosses the edges of the cube of eight points from this one on. False where it does
 * not cross. */
static bool find_vertex(float out[3], const struct shell_grid *grid, size_t point)
{
    double sum[3] = {0};
    double crossings = 0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        const int c = (a + 2) % 3;
        for (int n = 0; n < 4; n++) {
            const size_t from = point + (n & 1 ? grid->step[b] : 0) + (n & 2 ? grid->step[c] : 0);
            const double low = (double)grid->inside[from];
            const double high = (double)grid->inside[from + grid->step[a]];
            if (is_inside(grid, from) != is_inside(grid, from + grid->step[a])) {
                sum[a] += (LEVEL - low) / (high - low);
                sum[b] += n & 1;
                sum[c] += n >> 1;
                crossings++;
            }
        }
    }
    double middle[3];
    find_middle(middle, grid, point);
    for (int a = 0; a < 3 && crossings > 0; a++) {
        out[a] = (float)(middle[a] + grid->edge * sum[a] / crossings);
    }
    return crossings > 0;
}

/* Around each edge that the border crosses a square of the vertices of the four cubes at it, as two triangles that face
 * outside. NULL counts only. */
static size_t find_triangles(uint32_t *triangles, const struct shell_grid *grid, const uint32_t *vertices)
{
    static const int corners[6] = {0, 1, 2, 0, 2, 3};
    size_t count = 0;
    for (size_t point = 0; point < grid->count; point++) {
        for (int a = 0; a < 3; a++) {
            const size_t b = grid->step[(a + 1) % 3];
            const size_t c = grid->step[(a + 2) % 3];
            const size_t cubes[4] = {point, point - b, point - b - c, point - c};
            const bool inside = is_inside(grid, point);
            if (point + grid->step[a] >= grid->count || inside == is_inside(grid, point + grid->step[a])) {
                continue;
            }
            for (int n = 0; n < 6 && triangles; n++) {
                triangles[3 * count + (size_t)n] = vertices[cubes[corners[inside ? n : 5 - n]]];
            }
            count += 2;
        }
    }
    return count;
}

/* The border of the grid is outside, so that each cube with a vertex is whole. */
static conus_status find_border(struct mesh *out, const struct shell_grid *grid)
{
    const size_t last = grid->step[0] + grid->step[1] + grid->step[2];
    uint32_t *vertices = memory_zeroed(grid->count, sizeof *vertices);
    uint32_t count = 0;
    float at[3];
    struct mesh mesh = {0};
    for (size_t point = 0; vertices && point + last < grid->count; point++) {
        vertices[point] = count;
        count += find_vertex(at, grid, point);
    }
    conus_status status = vertices ? mesh_init(&mesh, count, find_triangles(NULL, grid, vertices)) : CONUS_ERROR_MEMORY;
    for (size_t point = 0; !status && point + last < grid->count; point++) {
        if (find_vertex(at, grid, point)) {
            memcpy(mesh.positions + 3 * (size_t)vertices[point], at, sizeof at);
        }
    }
    if (!status) {
        find_triangles(mesh.triangles, grid, vertices);
        *out = mesh;
    }
    memory_free(vertices);
    return status;
}

static conus_status fill_grid(struct shell_grid *out, const conus_atlas *atlas)
{
    const struct volume *context = atlas_context(atlas);
    struct head head = {0};
    struct box3 box;
    conus_status status = conus_atlas_bounds(box.low, box.high, atlas);
    if (!status && context) {
        const struct box3 grid = space_grid_box(&context->info);
        box3_join(&box, grid.low, grid.high);
        status = head_make(&head, context);
    }
    status = status ? status : init_grid(out, box.low, box.high);
    for (size_t point = 0; !status && point < out->count; point++) {
        double at[3];
        bool in_head = false;
        find_middle(at, out, point);
        in_head = context && head_grid_has(&in_head, &head, at) && in_head;
        out->inside[point] = in_head || is_in_area(atlas, at) ? 1 : 0;
    }
    if (!status) {
        enclose(out);
    }
    head_finish(&head);
    return status;
}

conus_status conus_atlas_add_shell(conus_atlas *atlas, double opacity)
{
    struct shell_grid grid = {0};
    struct notes notes = {0}; /* of triangles without an area, which none needs to know of */
    struct context_surface surface = {.is_shell = true, .opacity = opacity != 0 ? opacity : DEFAULT_OPACITY};
    if (!(surface.opacity > 0 && surface.opacity <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "shell: opacity of %g; allowed is above 0 to 1", opacity);
    }
    conus_status status = fill_grid(&grid, atlas);
    for (int n = 0; n < SMOOTHINGS && !status; n++) {
        smooth(&grid);
    }
    status = status ? status : find_border(&surface.mesh, &grid);
    if (!status && !surface.mesh.triangle_count) {
        status = fail(CONUS_ERROR_ARGUMENT, "shell: there are no voxels of areas or of a head to be around");
    }
    status = status ? status : mesh_check(&surface.mesh, &notes);
    status = status ? status : atlas_add_context_surface(atlas, &surface);
    memory_free(grid.inside);
    notes_finish(&notes);
    mesh_finish(&surface.mesh);
    return status;
}
