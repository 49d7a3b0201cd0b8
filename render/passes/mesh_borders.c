/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the corners that areas share, gives each to one of them, and cuts triangles by that. */
#include "render/passes/shapes.h"

#include "base/memory.h"
#include "base/order.h"

#include <string.h>

/* A triangle of an area, a piece of one of another's. */
struct piece {
    uint32_t object;
    struct mesh_vertex corners[3];
};

struct borders {
    struct mesh_list *parts;
    const conus_atlas *atlas;
    struct shared {
        float position[3];
        uint32_t vertex;
    } * rows;
    size_t row_count;
    uint32_t *uses;   /* [vertex_count] triangles of the vertex */
    uint32_t *owners; /* [vertex_count] the object that has the vertex; 0 = no other shares it */
    uint32_t *places; /* [vertex_count] one vertex of those at one place */
    uint64_t *edges;  /* of triangles at borders: from place to place */
    size_t edge_count, edge_capacity;
    struct piece *pieces;
    size_t piece_count, piece_capacity;
};

static bool is_open(const struct borders *borders, size_t part)
{
    const struct mesh *mesh =
        part < borders->atlas->object_count ? atlas_stored_mesh(borders->atlas, (uint32_t)part + 1) : NULL;
    return mesh && !mesh->shape.closed;
}

static int compare_positions(const void *a, const void *b)
{
    const struct shared *one = a;
    const struct shared *other = b;
    int order = 0;
    for (int k = 0; !order && k < 3; k++) {
        order = compare_double((double)one->position[k], (double)other->position[k]);
    }
    return order;
}

/* Lists the vertices of open surfaces by their places; at one place they ascend by object. */
static conus_status list_vertices(struct borders *borders)
{
    const struct mesh_list *parts = borders->parts;
    borders->rows = memory_raw(parts->vertex_count, sizeof *borders->rows);
    borders->uses = memory_zeroed(parts->vertex_count, sizeof *borders->uses);
    borders->owners = memory_zeroed(parts->vertex_count, sizeof *borders->owners);
    borders->places = memory_raw(parts->vertex_count, sizeof *borders->places);
    if (!borders->rows || !borders->uses || !borders->owners || !borders->places) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < parts->part_count; i++) {
        const struct mesh_entry *part = &parts->parts[i];
        for (size_t k = part->first; k < part->first + part->count && is_open(borders, i); k++) {
            borders->uses[parts->indices[k]]++;
        }
    }
    for (uint32_t v = 0; v < parts->vertex_count; v++) {
        const float *position = parts->vertices[v].position;
        if (borders->uses[v]) {
            borders->rows[borders->row_count++] = (struct shared){{position[0], position[1], position[2]}, v};
        }
    }
    order_sort(borders->rows, borders->row_count, sizeof *borders->rows, compare_positions);
    return CONUS_OK;
}

/* Gives the vertices at one place, which several objects share, to one of these, and one normal. */
static void give_place(struct borders *borders, const struct shared *rows, size_t count)
{
    struct mesh_vertex *vertices = borders->parts->vertices;
    float normal[3] = {0};
    uint32_t owner = 0;
    uint32_t most = 0;
    uint32_t uses = 0;
    for (size_t i = 0; i < count; i++) {
        const struct mesh_vertex *vertex = &vertices[rows[i].vertex];
        bool is_same = i > 0 && vertex->object == vertices[rows[i - 1].vertex].object;
        uses = (is_same ? uses : 0) + borders->uses[rows[i].vertex];
        owner = uses > most ? vertex->object : owner;
        most = uses > most ? uses : most;
        for (int a = 0; a < 3; a++) {
            normal[a] += vertex->normal[a];
        }
    }
    for (size_t i = 0; i < count; i++) {
        borders->owners[rows[i].vertex] = owner;
        borders->places[rows[i].vertex] = rows->vertex;
        memcpy(vertices[rows[i].vertex].normal, normal, sizeof normal);
    }
}

static void give_places(struct borders *borders)
{
    const struct mesh_vertex *vertices = borders->parts->vertices;
    const struct shared *rows = borders->rows;
    for (size_t first = 0, end; first < borders->row_count; first = end) {
        for (end = first + 1; end < borders->row_count && !compare_positions(&rows[first], &rows[end]); end++) {
        }
        if (vertices[rows[first].vertex].object != vertices[rows[end - 1].vertex].object) {
            give_place(borders, rows + first, end - first);
        }
    }
}

/* Whether two triangles pass an edge between shared corners the same way: then the areas lie over each other. */
static conus_status find_overlap(bool *out, struct borders *borders)
{
    const struct mesh_list *parts = borders->parts;
    for (size_t i = 0; i < parts->index_count; i++) {
        uint32_t from = parts->indices[i];
        uint32_t to = parts->indices[i % 3 < 2 ? i + 1 : i - 2];
        if (!borders->owners[from] || !borders->owners[to]) {
            continue;
        }
        if (!memory_reserve(&borders->edges, &borders->edge_capacity, borders->edge_count + 1,
                            sizeof *borders->edges)) {
            return CONUS_ERROR_MEMORY;
        }
        borders->edges[borders->edge_count++] = (uint64_t)borders->places[from] << 32 | borders->places[to];
    }
    order_sort(borders->edges, borders->edge_count, sizeof *borders->edges, compare_u64);
    *out = false;
    for (size_t i = 1; i < borders->edge_count; i++) {
        *out = *out || borders->edges[i] == borders->edges[i - 1];
    }
    return CONUS_OK;
}

/* A place between corners, by the weights of these. */
static struct mesh_vertex between(const struct mesh_vertex *const corners[3], const float weights[3])
{
    struct mesh_vertex out = {0};
    for (int a = 0; a < 3; a++) {
        for (int k = 0; k < 3; k++) {
            out.position[a] += weights[k] * corners[k]->position[a];
            out.normal[a] += weights[k] * corners[k]->normal[a];
        }
    }
    return out;
}

static conus_status add_piece(struct borders *borders, uint32_t object, const struct mesh_vertex *a,
                              const struct mesh_vertex *b, const struct mesh_vertex *c)
{
    if (!memory_reserve(&borders->pieces, &borders->piece_capacity, borders->piece_count + 1,
                        sizeof *borders->pieces)) {
        return CONUS_ERROR_MEMORY;
    }
    struct piece *piece = &borders->pieces[borders->piece_count++];
    *piece = (struct piece){object, {*a, *b, *c}};
    for (int k = 0; k < 3; k++) {
        piece->corners[k].object = object;
    }
    return CONUS_OK;
}

/* The objects that the corners of a triangle belong to. */
static void find_owners(uint32_t out[3], const struct borders *borders, const uint32_t *triangle)
{
    for (int k = 0; k < 3; k++) {
        uint32_t owner = borders->owners[triangle[k]];
        out[k] = owner ? owner : borders->parts->vertices[triangle[k]].object;
    }
}

static bool is_cut(const struct borders *borders, const uint32_t *triangle)
{
    uint32_t owners[3];
    find_owners(owners, borders, triangle);
    return owners[0] != owners[1] || owners[0] != owners[2];
}

static conus_status cut_triangle(struct borders *borders, const uint32_t *triangle)
{
    const struct mesh_vertex *corners[3];
    struct mesh_vertex middles[3]; /* of the edges from corner k on */
    uint32_t owners[3];
    find_owners(owners, borders, triangle);
    const uint32_t own = borders->parts->vertices[triangle[0]].object;
    const bool is_lost = owners[0] != own && owners[1] != own && owners[2] != own;
    for (int k = 0; k < 3; k++) {
        corners[k] = &borders->parts->vertices[triangle[k]];
        owners[k] = is_lost ? own : owners[k];
    }
    for (int k = 0; k < 3; k++) {
        float weights[3] = {0.5F, 0.5F, 0.5F};
        weights[(k + 2) % 3] = 0;
        middles[k] = between(corners, weights);
    }
    const struct mesh_vertex centre = between(corners, (const float[3]){1.0F / 3, 1.0F / 3, 1.0F / 3});
    const bool are_three = owners[0] != owners[1] && owners[1] != owners[2] && owners[2] != owners[0];
    conus_status status = CONUS_OK;
    for (int k = 0; !status && k < 3; k++) { /* the corners */
        status = add_piece(borders, owners[k], corners[k], &middles[k], &middles[(k + 2) % 3]);
    }
    for (int k = 0; !status && are_three && k < 3; k++) { /* from them to the centre */
        status = add_piece(borders, owners[k], &middles[(k + 2) % 3], &middles[k], &centre);
    }
    if (!status && !are_three) { /* what is between them belongs to the two that are alike */
        uint32_t object = owners[1] == owners[2] ? owners[1] : owners[0];
        status = add_piece(borders, object, &middles[0], &middles[1], &middles[2]);
    }
    return status;
}

static conus_status cut_triangles(struct borders *borders)
{
    const struct mesh_list *parts = borders->parts;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < parts->index_count; i += 3) {
        status = is_cut(borders, parts->indices + i) ? cut_triangle(borders, parts->indices + i) : CONUS_OK;
    }
    return status;
}

static int compare_pieces(const void *a, const void *b)
{
    return compare_unsigned(((const struct piece *)a)->object, ((const struct piece *)b)->object);
}

/* Leaves out the triangles that are cut, and puts the pieces behind the others of their objects. */
static void list_triangles(uint32_t *indices, struct borders *borders)
{
    struct mesh_list *parts = borders->parts;
    const struct piece *piece = borders->pieces;
    size_t count = 0;
    for (size_t i = 0; i < parts->part_count; i++) {
        struct mesh_entry *part = &parts->parts[i];
        const size_t first = count;
        for (size_t k = part->first; k < part->first + part->count; k += 3) {
            if (!is_cut(borders, parts->indices + k)) {
                memcpy(indices + count, parts->indices + k, 3 * sizeof *indices);
                count += 3;
            }
        }
        for (; piece < borders->pieces + borders->piece_count && piece->object == i + 1; piece++) {
            for (int k = 0; k < 3; k++) {
                indices[count++] = (uint32_t)parts->vertex_count;
                parts->vertices[parts->vertex_count++] = piece->corners[k];
            }
        }
        *part = (struct mesh_entry){.first = first, .count = count - first};
    }
    parts->index_count = count;
}

static conus_status put_together(struct borders *borders, uint64_t *memory_left)
{
    struct mesh_list *parts = borders->parts;
    const size_t added = 3 * borders->piece_count;
    const uint64_t size = added * (uint64_t)(sizeof *parts->vertices + sizeof *parts->indices);
    if (size > *memory_left || parts->vertex_count + added > INT32_MAX || parts->index_count + added > INT32_MAX) {
        return fail(CONUS_ERROR_MEMORY, "borders of %zu triangles: %llu bytes, allowed are %llu more",
                    borders->piece_count, (unsigned long long)size, (unsigned long long)*memory_left);
    }
    order_sort(borders->pieces, borders->piece_count, sizeof *borders->pieces, compare_pieces);
    struct mesh_vertex *vertices = memory_resize(parts->vertices, parts->vertex_count + added, sizeof *parts->vertices);
    parts->vertices = vertices ? vertices : parts->vertices;
    uint32_t *indices = memory_raw(parts->index_count + added, sizeof *indices);
    if (!vertices || !indices) {
        memory_free(indices);
        return CONUS_ERROR_MEMORY;
    }
    *memory_left -= size;
    list_triangles(indices, borders);
    memory_free(parts->indices);
    parts->indices = indices;
    return CONUS_OK;
}

conus_status mesh_borders_smooth(struct mesh_list *parts, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct borders borders = {.parts = parts, .atlas = atlas};
    bool overlap = false;
    conus_status status = list_vertices(&borders);
    if (!status) {
        give_places(&borders);
        status = find_overlap(&overlap, &borders);
    }
    status = status || overlap ? status : cut_triangles(&borders);
    if (!status && borders.piece_count) {
        status = put_together(&borders, memory_left);
    }
    memory_free(borders.rows);
    memory_free(borders.uses);
    memory_free(borders.owners);
    memory_free(borders.places);
    memory_free(borders.edges);
    memory_free(borders.pieces);
    return status;
}
