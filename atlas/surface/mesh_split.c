/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts a mesh by the labels of its vertices. */
#include "atlas/surface/mesh.h"

#include "base/memory.h"
#include "base/order.h"

#include <string.h>

struct labelled {
    uint32_t label;
    uint32_t triangle;
};

/* State that the parts share while they are made. */
struct splitting {
    const struct mesh *mesh;
    struct labelled *triangles; /* sorted; [count] */
    size_t count;
    uint32_t *place; /* [vertex_count] of a vertex in the part that is being made */
};

void mesh_parts_finish(struct mesh_parts *parts)
{
    for (size_t i = 0; i < parts->count; i++) {
        mesh_finish(&parts->parts[i].mesh);
    }
    memory_free(parts->parts);
    *parts = (struct mesh_parts){0};
}

struct mesh_part *mesh_parts_find(const struct mesh_parts *parts, uint32_t label)
{
    size_t low = 0;
    size_t high = parts->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        bool below = parts->parts[middle].label < label;
        low = below ? middle + 1 : low;
        high = below ? high : middle;
    }
    return low < parts->count && parts->parts[low].label == label ? &parts->parts[low] : NULL;
}

static int compare_labelled(const void *a, const void *b)
{
    return compare_unsigned(((const struct labelled *)a)->label, ((const struct labelled *)b)->label);
}

static conus_status gather_triangles(struct splitting *work, const uint32_t *labels, struct notes *notes)
{
    const struct mesh *mesh = work->mesh;
    size_t left_out = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *corners = mesh->triangles + 3 * i;
        uint32_t a = labels[corners[0]];
        uint32_t b = labels[corners[1]];
        uint32_t label = b == labels[corners[2]] ? b : a;
        if (label) {
            work->triangles[work->count++] = (struct labelled){label, (uint32_t)i};
        }
        left_out += !label;
    }
    if (!work->count) {
        return fail(CONUS_ERROR_DATA, "none of %zu triangles is labelled", mesh->triangle_count);
    }
    order_sort(work->triangles, work->count, sizeof *work->triangles, compare_labelled);
    return left_out ? notes_add(notes, "%s: %zu of %zu triangles have no label and were left out",
                                mesh->path ? mesh->path : "mesh", left_out, mesh->triangle_count)
                    : CONUS_OK;
}

/* Gives the vertices of a part their places in it, and returns their number. Start with all of them UINT32_MAX. */
static size_t number_vertices(struct splitting *work, const struct labelled *triangles, size_t count, bool forget)
{
    size_t vertices = 0;
    for (size_t i = 0; i < 3 * count; i++) {
        uint32_t *place = &work->place[work->mesh->triangles[3 * (size_t)triangles[i / 3].triangle + i % 3]];
        if (forget) {
            *place = UINT32_MAX;
        } else if (*place == UINT32_MAX) {
            *place = (uint32_t)vertices++;
        }
    }
    return vertices;
}

static conus_status make_part(struct mesh_part *out, struct splitting *work, const struct labelled *triangles,
                              size_t count)
{
    struct mesh part = {0};
    const char *path = work->mesh->path;
    conus_status status = mesh_init(&part, number_vertices(work, triangles, count, false), count);
    if (!status && path) {
        part.path = memory_text(path, strlen(path));
        status = part.path ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (!status) {
        for (size_t i = 0; i < 3 * part.triangle_count; i++) {
            uint32_t vertex = work->mesh->triangles[3 * (size_t)triangles[i / 3].triangle + i % 3];
            uint32_t place = work->place[vertex];
            part.triangles[i] = place;
            memcpy(part.positions + 3 * (size_t)place, work->mesh->positions + 3 * (size_t)vertex,
                   3 * sizeof *part.positions);
        }
        *out = (struct mesh_part){triangles->label, part};
        part = (struct mesh){0};
    }
    number_vertices(work, triangles, count, true);
    mesh_finish(&part);
    return status;
}

/* The number of triangles from `triangles` on that have the same label. */
static size_t run_length(const struct labelled *triangles, size_t left)
{
    size_t length = 1;
    while (length < left && triangles[length].label == triangles[0].label) {
        length++;
    }
    return length;
}

static conus_status make_parts(struct mesh_parts *out, struct splitting *work)
{
    conus_status status = CONUS_OK;
    size_t capacity = 0;
    for (size_t i = 0; i < work->count; i += run_length(work->triangles + i, work->count - i)) {
        capacity++;
    }
    out->parts = memory_zeroed(capacity, sizeof *out->parts);
    if (!out->parts) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; !status && i < work->count;) {
        size_t length = run_length(work->triangles + i, work->count - i);
        status = make_part(&out->parts[out->count], work, work->triangles + i, length);
        out->count += !status;
        i += length;
    }
    return status;
}

conus_status mesh_split(struct mesh_parts *out, const struct mesh *mesh, const uint32_t *labels, struct notes *notes)
{
    struct splitting work = {.mesh = mesh};
    struct mesh_parts parts = {0};
    work.triangles = memory_raw(mesh->triangle_count, sizeof *work.triangles);
    work.place = memory_raw(mesh->vertex_count, sizeof *work.place);
    conus_status status = work.triangles && work.place ? gather_triangles(&work, labels, notes) : CONUS_ERROR_MEMORY;
    if (!status) {
        memset(work.place, 0xff, mesh->vertex_count * sizeof *work.place);
        status = make_parts(&parts, &work);
    }
    memory_free(work.triangles);
    memory_free(work.place);
    return GIVE(status, out, parts, mesh_parts_finish(&parts));
}
