/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs the edges of a mesh: a closed one passes each as often in either direction. Counts how often it winds. */
#include "atlas/surface/mesh.h"

#include "base/memory.h"
#include "base/order.h"

#include <string.h>

static bool are_equal(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static uint64_t hash_of(const float position[3])
{
    uint64_t hash = 0;
    for (int a = 0; a < 3; a++) {
        float number = position[a] + 0.0F; /* -0 is 0 */
        uint32_t bits;
        memcpy(&bits, &number, sizeof bits);
        hash = (hash ^ bits) * UINT64_C(0x9E3779B97F4A7C15);
        hash ^= hash >> 32;
    }
    return hash;
}

/* A hash table of the first vertex at each position, at most half full. */
conus_status mesh_find_first(uint32_t *first, const struct mesh *mesh)
{
    size_t places = 16;
    while (places < 2 * mesh->vertex_count) {
        places *= 2;
    }
    uint32_t *table = memory_raw(places, sizeof *table);
    if (!table) {
        return CONUS_ERROR_MEMORY;
    }
    memset(table, 0xFF, places * sizeof *table);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *position = &mesh->positions[3 * v];
        size_t at = (size_t)hash_of(position) & (places - 1);
        while (table[at] != UINT32_MAX && !are_equal(&mesh->positions[3 * (size_t)table[at]], position)) {
            at = (at + 1) & (places - 1);
        }
        table[at] = table[at] != UINT32_MAX ? table[at] : (uint32_t)v;
        first[v] = table[at];
    }
    memory_free(table);
    return CONUS_OK;
}

/* The edges of a mesh, by their lower vertex: the higher one, and whether the triangle passes the edge downwards. */
struct edges {
    uint32_t *start; /* [vertex_count + 1] of each vertex's part of items */
    uint64_t *items; /* [3 triangle_count] 2 higher vertex + downwards    */
};

/* False for an edge from a vertex to itself. */
static bool edge_of(uint32_t *low, uint64_t *item, const struct mesh *mesh, const uint32_t *first, size_t corner)
{
    uint32_t from = mesh->triangles[corner];
    uint32_t to = mesh->triangles[corner % 3 == 2 ? corner - 2 : corner + 1];
    from = first ? first[from] : from;
    to = first ? first[to] : to;
    *low = from < to ? from : to;
    *item = from < to ? 2 * (uint64_t)to : 2 * (uint64_t)from + 1;
    return from != to;
}

/* Counting sort. start[v + 1] first counts, then is where vertex v's next item goes, and in the end where they end. */
static void gather_edges(struct edges *edges, const struct mesh *mesh, const uint32_t *first)
{
    size_t count = 3 * mesh->triangle_count;
    uint32_t *next = edges->start + 1;
    uint32_t low;
    uint64_t item;
    uint32_t sum = 0;
    memset(edges->start, 0, (mesh->vertex_count + 1) * sizeof *edges->start);
    for (size_t i = 0; i < count; i++) {
        if (edge_of(&low, &item, mesh, first, i)) {
            next[low]++;
        }
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t here = next[v];
        next[v] = sum;
        sum += here;
    }
    for (size_t i = 0; i < count; i++) {
        if (edge_of(&low, &item, mesh, first, i)) {
            edges->items[next[low]++] = item;
        }
    }
}

static void sort_items(uint64_t *items, size_t count)
{
    enum { FEW = 24 };
    if (count > FEW) {
        order_sort(items, count, sizeof *items, compare_u64);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint64_t item = items[i];
        size_t at = i;
        for (; at && items[at - 1] > item; at--) {
            items[at] = items[at - 1];
        }
        items[at] = item;
    }
}

/* Whether each edge is passed as often upwards as downwards. */
static bool are_balanced(uint64_t *items, size_t count)
{
    int64_t ups = 0; /* less downs, of one edge */
    sort_items(items, count);
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && ups != 0 && items[i] / 2 != items[i - 1] / 2) {
            return false;
        }
        ups += items[i] % 2 ? -1 : 1;
    }
    return ups == 0;
}

static bool find_balance(struct edges *edges, const struct mesh *mesh, const uint32_t *first)
{
    bool balanced = true;
    gather_edges(edges, mesh, first);
    for (size_t v = 0; balanced && v < mesh->vertex_count; v++) {
        balanced = are_balanced(edges->items + edges->start[v], edges->start[v + 1] - edges->start[v]);
    }
    return balanced;
}

/* Tries the vertices as they are, and then with those at equal positions as one. */
conus_status mesh_is_closed(bool *out, const struct mesh *mesh)
{
    struct edges edges = {.start = memory_raw(mesh->vertex_count + 1, sizeof *edges.start),
                          .items = memory_raw(3 * mesh->triangle_count, sizeof *edges.items)};
    uint32_t *first = NULL;
    bool can_tell = mesh->triangle_count <= UINT32_MAX / 3; /* else there are more edges than can be told apart */
    conus_status status = edges.start && edges.items ? CONUS_OK : CONUS_ERROR_MEMORY;
    bool closed = !status && can_tell && find_balance(&edges, mesh, NULL);
    if (!status && can_tell && !closed) {
        first = memory_raw(mesh->vertex_count, sizeof *first);
        status = first ? mesh_find_first(first, mesh) : CONUS_ERROR_MEMORY;
        closed = !status && find_balance(&edges, mesh, first);
    }
    memory_free(first);
    memory_free(edges.start);
    memory_free(edges.items);
    return GIVE(status, out, closed, 0);
}

enum { LINES = 64, PAIR_LIMIT = 1 << 26 };

conus_status mesh_winds_once(bool *out, const struct mesh *mesh, const struct mesh_shape *shape)
{
    static const double tolerance = 1e-2;
    struct mesh_lines lines = {0};
    double inside = 0;
    double wrong = 0;
    conus_status status = CONUS_OK;
    /* Lines do not pass the middles of their cells, since vertices of many meshes are at round numbers. */
    static const double off_middle[2] = {0.4878911, 0.5127683};
    for (int a = 0; a < 2; a++) {
        lines.count[a] = LINES;
        lines.step[a] = (shape->high[a] - shape->low[a]) / LINES;
        lines.start[a] = shape->low[a] + off_middle[a] * lines.step[a];
    }
    for (size_t i = 0; !status && lines.pairs <= PAIR_LIMIT && i < mesh->triangle_count; i++) {
        status = mesh_lines_cross(&lines, 0, mesh, i, NULL);
    }
    if (!status) {
        mesh_lines_sort(&lines);
        const int facing = shape->volume_mm3 < 0 ? -1 : 1;
        int winding = 0;
        for (size_t i = 0; i + 1 < lines.crossing_count; i++) {
            const struct line_crossing *here = &lines.crossings[i];
            bool ends = here[1].line != here->line;
            winding = ends ? 0 : winding + here->side;
            if (winding != 0) {
                inside += here[1].z - here->z;
                wrong += winding != facing ? here[1].z - here->z : 0;
            }
        }
        *out = lines.pairs <= PAIR_LIMIT && wrong <= tolerance * inside;
    }
    mesh_lines_finish(&lines);
    return status;
}
