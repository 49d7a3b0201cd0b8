/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the borders between objects in a grid of points: surface nets (Gibson 1998). */
#include "atlas/nets/parts.h"

#include "base/memory.h"

#include <math.h>

conus_status net_grid_init(struct net_grid *out, const double low[3], const double high[3], double edge)
{
    struct net_grid grid = {.count = 1, .edge = edge};
    for (int a = 0; a < 3; a++) {
        grid.dim[a] = (size_t)ceil((high[a] - low[a]) / grid.edge) + 2 * NET_BORDER;
        grid.start[a] = (low[a] + high[a] - grid.edge * (double)(grid.dim[a] - 1)) / 2;
        grid.step[a] = grid.count;
        grid.count *= grid.dim[a];
    }
    grid.objects = memory_zeroed(grid.count, sizeof *grid.objects);
    *out = grid;
    return grid.objects ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void net_grid_finish(struct net_grid *grid)
{
    memory_free(grid->objects);
    memory_free(grid->inside);
    *grid = (struct net_grid){0};
}

void net_grid_index(size_t out[3], const struct net_grid *grid, size_t point)
{
    for (int a = 0; a < 3; a++) {
        out[a] = point / grid->step[a] % grid->dim[a];
    }
}

void net_grid_middle(double out[3], const struct net_grid *grid, size_t point)
{
    size_t index[3];
    net_grid_index(index, grid, point);
    for (int a = 0; a < 3; a++) {
        out[a] = grid->start[a] + grid->edge * (double)index[a];
    }
}

uint32_t net_area_at(const conus_atlas *atlas, const double at[3])
{
    for (size_t v = 0; v < atlas->volume_count; v++) {
        const struct volume *volume = &atlas->volumes[v];
        size_t voxel;
        if (volume->info.role == CONUS_ROLE_PARCELLATION && volume_find_voxel(&voxel, volume, at)) {
            const uint32_t object = volume_object(volume, voxel);
            if (object && object != VOLUME_BLOCKER) {
                return object;
            }
        }
    }
    return 0;
}

/* Where the border crosses the edge between two points, as a part of it. */
static double find_crossing(const struct net_grid *grid, size_t from, size_t to)
{
    if (!grid->inside) {
        return 0.5;
    }
    const double low = (double)grid->inside[from];
    return (grid->level - low) / ((double)grid->inside[to] - low);
}

/* In the middle of where borders cross the edges of the cube of eight points from this one on. False where none does.
 */
static bool find_vertex(float out[3], const struct net_grid *grid, size_t point)
{
    double sum[3] = {0};
    double crossings = 0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        const int c = (a + 2) % 3;
        for (int n = 0; n < 4; n++) {
            const size_t from = point + (n & 1 ? grid->step[b] : 0) + (n & 2 ? grid->step[c] : 0);
            const size_t to = from + grid->step[a];
            if (grid->objects[from] != grid->objects[to]) {
                sum[a] += find_crossing(grid, from, to);
                sum[b] += n & 1;
                sum[c] += n >> 1;
                crossings++;
            }
        }
    }
    double middle[3];
    net_grid_middle(middle, grid, point);
    for (int a = 0; a < 3 && crossings > 0; a++) {
        out[a] = (float)(middle[a] + grid->edge * sum[a] / crossings);
    }
    return crossings > 0;
}

/* NULL counts only. */
static size_t find_squares(struct net_square *squares, const struct net_grid *grid, const uint32_t *vertices)
{
    size_t count = 0;
    for (size_t point = 0; point < grid->count; point++) {
        for (int a = 0; a < 3; a++) {
            const size_t b = grid->step[(a + 1) % 3];
            const size_t c = grid->step[(a + 2) % 3];
            const size_t next = point + grid->step[a];
            if (next >= grid->count || grid->objects[point] == grid->objects[next]) {
                continue;
            }
            if (squares) {
                squares[count] = (struct net_square){
                    {grid->objects[point], grid->objects[next]},
                    {vertices[point], vertices[point - b], vertices[point - b - c], vertices[point - c]}};
            }
            count++;
        }
    }
    return count;
}

conus_status net_find(struct net *out, const struct net_grid *grid)
{
    const size_t last = grid->step[0] + grid->step[1] + grid->step[2];
    uint32_t *numbers = memory_zeroed(grid->count, sizeof *numbers);
    struct net net = {0};
    float at[3];
    for (size_t point = 0; numbers && point + last < grid->count; point++) {
        numbers[point] = (uint32_t)net.vertex_count;
        net.vertex_count += find_vertex(at, grid, point);
    }
    net.square_count = numbers ? find_squares(NULL, grid, numbers) : 0;
    net.vertices = memory_raw(3 * net.vertex_count, sizeof *net.vertices);
    net.squares = memory_raw(net.square_count, sizeof *net.squares);
    const bool has_room = numbers && net.vertices && net.squares;
    for (size_t point = 0; has_room && point + last < grid->count; point++) {
        if (find_vertex(at, grid, point)) {
            memcpy(net.vertices + 3 * (size_t)numbers[point], at, sizeof at);
        }
    }
    if (has_room) {
        find_squares(net.squares, grid, numbers);
        *out = net;
    } else {
        net_finish(&net);
    }
    memory_free(numbers);
    return has_room ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void net_finish(struct net *net)
{
    memory_free(net->vertices);
    memory_free(net->squares);
    *net = (struct net){0};
}
