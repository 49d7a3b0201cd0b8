/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects vertices, faces and strips. */
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

struct polygon_corner {
    double at[3];
    uint32_t vertex;
    uint32_t previous, next; /* corners that are left */
    double measure;          /* of the ear here; 0 = none */
    size_t age;              /* when it was measured */
};

struct polygon {
    struct polygon_corner corners[POLYGON_LIMIT];
    size_t left;  /* corners */
    size_t ears;  /* corners with a measure */
    size_t clock; /* measurements so far */
    double normal[3];
};

/* Newell's normal, whose length is twice the area. */
static void find_normal(struct polygon *polygon)
{
    for (size_t i = 0; i < polygon->left; i++) {
        double a[3];
        double b[3];
        double cross[3];
        vec3_sub(a, polygon->corners[i].at, polygon->corners[0].at);
        vec3_sub(b, polygon->corners[polygon->corners[i].next].at, polygon->corners[0].at);
        vec3_cross(cross, a, b);
        vec3_add_scaled(polygon->normal, polygon->normal, 1, cross);
    }
    double length = vec3_length(polygon->normal);
    for (int k = 0; length > 0 && k < 3; k++) {
        polygon->normal[k] /= length;
    }
}

static void measure_ear(struct polygon *polygon, size_t i)
{
    struct polygon_corner *corner = &polygon->corners[i];
    double a[3];
    double b[3];
    double c[3];
    double cross[3];
    vec3_sub(a, corner->at, polygon->corners[corner->previous].at);
    vec3_sub(b, polygon->corners[corner->next].at, corner->at);
    vec3_sub(c, polygon->corners[corner->previous].at, polygon->corners[corner->next].at);
    vec3_cross(cross, a, b);
    double area = vec3_dot(cross, polygon->normal);
    double perimeter = vec3_length(a) + vec3_length(b) + vec3_length(c);
    polygon->ears -= corner->measure > 0;
    corner->measure = area > 0 ? perimeter * perimeter / area : 0;
    corner->age = polygon->clock++;
    polygon->ears += corner->measure > 0;
}

static void setup_polygon(struct polygon *out, const struct foreign_mesh *mesh, const uint32_t *vertices, size_t count)
{
    out->left = count;
    out->ears = 0;
    out->clock = 0;
    memset(out->normal, 0, sizeof out->normal);
    for (size_t i = 0; i < count; i++) {
        struct polygon_corner *corner = &out->corners[i];
        corner->vertex = vertices[i];
        corner->previous = (uint32_t)(i ? i - 1 : count - 1);
        corner->next = (uint32_t)(i + 1 < count ? i + 1 : 0);
        corner->measure = 0;
        for (int k = 0; k < 3; k++) {
            corner->at[k] = (double)mesh->positions[3 * (size_t)vertices[i] + (size_t)k];
        }
    }
    find_normal(out);
    for (size_t i = 0; i < count; i++) {
        measure_ear(out, i);
    }
}

/* The corner with the best ear; `count` if there is none. */
static size_t best_ear(const struct polygon *polygon, size_t count)
{
    size_t best = count;
    for (size_t i = 0; i < count; i++) {
        const struct polygon_corner *corner = &polygon->corners[i];
        const struct polygon_corner *other = best < count ? &polygon->corners[best] : NULL;
        if (corner->measure > 0 && (!other || corner->measure < other->measure ||
                                    (!(corner->measure > other->measure) && corner->age < other->age))) {
            best = i;
        }
    }
    return best;
}

/* On the inner side of the line from a to b, or on it. */
static bool foreign_is_inside(const struct polygon *polygon, const double a[3], const double b[3], const double p[3])
{
    double along[3];
    double to[3];
    double cross[3];
    vec3_sub(along, b, a);
    vec3_sub(to, p, a);
    vec3_cross(cross, along, to);
    return vec3_dot(cross, polygon->normal) >= 0;
}

static bool foreign_is_same(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Whether no other corner is in the ear, as seen along the normal. Those in the places of its own corners are not. */
static bool is_empty(const struct polygon *polygon, size_t ear)
{
    const struct polygon_corner *tip = &polygon->corners[ear];
    const struct polygon_corner *before = &polygon->corners[tip->previous];
    const struct polygon_corner *after = &polygon->corners[tip->next];
    for (size_t i = after->next; i != tip->previous; i = polygon->corners[i].next) {
        const double *p = polygon->corners[i].at;
        bool same = foreign_is_same(p, tip->at) || foreign_is_same(p, before->at) || foreign_is_same(p, after->at);
        if (!same && foreign_is_inside(polygon, before->at, tip->at, p) &&
            foreign_is_inside(polygon, tip->at, after->at, p) && foreign_is_inside(polygon, after->at, before->at, p)) {
            return false;
        }
    }
    return true;
}

static conus_status take_ear(struct foreign_mesh *mesh, struct polygon *polygon, size_t ear)
{
    struct polygon_corner *tip = &polygon->corners[ear];
    struct polygon_corner *before = &polygon->corners[tip->previous];
    struct polygon_corner *after = &polygon->corners[tip->next];
    conus_status status = foreign_add_triangle(mesh, tip->vertex, after->vertex, before->vertex);
    before->next = tip->next;
    after->previous = tip->previous;
    polygon->ears -= tip->measure > 0;
    tip->measure = 0;
    polygon->left--;
    measure_ear(polygon, tip->previous);
    measure_ear(polygon, tip->next);
    return status;
}

/* Cuts a polygon of 4 corners or more into triangles and appends them. */
static conus_status polygon_cut(struct foreign_mesh *mesh, const uint32_t *corners, size_t count)
{
    struct polygon *polygon = memory_raw(1, sizeof *polygon);
    if (!polygon) {
        return CONUS_ERROR_MEMORY;
    }
    setup_polygon(polygon, mesh, corners, count);
    conus_status status = CONUS_OK;
    size_t first = 0;
    while (!status && polygon->left > 2) {
        size_t ear = best_ear(polygon, count);
        if (ear == count) {
            /* It crosses itself or has no area: triangles from one corner keep its edges where they are. */
            const struct polygon_corner *all = polygon->corners;
            for (size_t i = all[first].next; !status && all[i].next != first; i = all[i].next) {
                status = foreign_add_triangle(mesh, all[first].vertex, all[i].vertex, all[all[i].next].vertex);
            }
            break;
        }
        if (polygon->ears == polygon->left || is_empty(polygon, ear)) {
            first = polygon->corners[ear].next;
            status = take_ear(mesh, polygon, ear);
        } else {
            polygon->ears--;
            polygon->corners[ear].measure = 0; /* until one beside it goes */
        }
    }
    memory_free(polygon);
    return status;
}

void foreign_mesh_finish(struct foreign_mesh *mesh)
{
    memory_free(mesh->positions);
    memory_free(mesh->triangles);
    memory_free(mesh->face.indices);
    notes_finish(&mesh->notes);
    *mesh = (struct foreign_mesh){0};
}

static conus_status check_count(size_t count, const char *what)
{
    return count <= UINT32_MAX ? CONUS_OK : fail(CONUS_ERROR_DATA, "%zu %s, allowed are up to 4294967295", count, what);
}

conus_status foreign_reserve_vertices(struct foreign_mesh *mesh, size_t count)
{
    conus_status status = check_count(count, "vertices");
    if (!status && !memory_reserve(&mesh->positions, &mesh->vertex_capacity, count, 3 * sizeof *mesh->positions)) {
        status = CONUS_ERROR_MEMORY;
    }
    return status;
}

conus_status foreign_add_vertex(struct foreign_mesh *mesh, const float position[3])
{
    conus_status status = foreign_reserve_vertices(mesh, mesh->vertex_count + 1);
    if (!status) {
        memcpy(&mesh->positions[3 * mesh->vertex_count++], position, 3 * sizeof *position);
    }
    return status;
}

conus_status foreign_add_corner(struct foreign_mesh *mesh, int64_t index)
{
    struct corners *face = &mesh->face;
    if (index < 0 || (uint64_t)index >= mesh->vertex_count) {
        const char *what = foreign_cell_word(mesh);
        return mesh->vertex_count ? fail(CONUS_ERROR_DATA, "%s %zu: vertex index %lld, allowed are 0 to %zu", what,
                                         mesh->face_count, (long long)index, mesh->vertex_count - 1)
                                  : fail(CONUS_ERROR_DATA, "%s %zu: vertex index %lld, there are no vertices", what,
                                         mesh->face_count, (long long)index);
    }
    if (!memory_reserve(&face->indices, &face->capacity, face->count + 1, sizeof *face->indices)) {
        return CONUS_ERROR_MEMORY;
    }
    face->indices[face->count++] = (uint32_t)index;
    return CONUS_OK;
}

conus_status foreign_add_triangle(struct foreign_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t corners[3] = {a, b, c};
    conus_status status = check_count(mesh->triangle_count + 1, "triangles");
    if (!status && !memory_reserve(&mesh->triangles, &mesh->triangle_capacity, mesh->triangle_count + 1,
                                   3 * sizeof *mesh->triangles)) {
        status = CONUS_ERROR_MEMORY;
    }
    if (!status) {
        memcpy(&mesh->triangles[3 * mesh->triangle_count++], corners, sizeof corners);
    }
    return status;
}

/* Forgets the face: a line, or a point. */
static void drop_face(struct foreign_mesh *mesh)
{
    mesh->face.count = 0;
    mesh->face_count++;
}

conus_status foreign_end_polygon(struct foreign_mesh *mesh)
{
    const uint32_t *at = mesh->face.indices;
    size_t count = mesh->face.count;
    conus_status status = CONUS_OK;
    if (count > POLYGON_LIMIT) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s %zu: a polygon of %zu corners, allowed are up to %d",
                    foreign_cell_word(mesh), mesh->face_count, count, POLYGON_LIMIT);
    }
    if (count > 3) {
        status = polygon_cut(mesh, at, count);
    } else if (count > 0) {
        status = foreign_add_triangle(mesh, at[0], at[count > 1], at[count - 1]);
    }
    drop_face(mesh);
    return status;
}

/* Every second triangle of a strip is turned around. */
conus_status foreign_end_strip(struct foreign_mesh *mesh)
{
    const uint32_t *at = mesh->face.indices;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i + 2 < mesh->face.count; i++) {
        status = foreign_add_triangle(mesh, at[i + i % 2], at[i + 1 - i % 2], at[i + 2]);
    }
    drop_face(mesh);
    return status;
}

conus_status foreign_mesh_take(struct mesh *out, struct foreign_mesh *mesh)
{
    struct mesh taken = {0};
    conus_status status = CONUS_OK;
    if (!mesh->triangle_count) {
        return fail(CONUS_ERROR_DATA, "no triangle with an area: no ray can hit it");
    }
    float *positions = memory_resize(mesh->positions, mesh->vertex_count, 3 * sizeof *positions); /* smaller */
    mesh->positions = positions ? positions : mesh->positions;
    uint32_t *triangles = memory_resize(mesh->triangles, mesh->triangle_count, 3 * sizeof *triangles);
    mesh->triangles = triangles ? triangles : mesh->triangles;
    status = positions && triangles ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        taken.vertex_count = mesh->vertex_count;
        taken.triangle_count = mesh->triangle_count;
        taken.positions = mesh->positions;
        taken.triangles = mesh->triangles;
        mesh->positions = NULL;
        mesh->triangles = NULL;
        *out = taken;
    }
    return status;
}

void foreign_lines_finish(struct foreign_lines *lines)
{
    for (size_t i = 0; i < lines->array_count; i++) {
        memory_free(lines->arrays[i].name);
        memory_free(lines->arrays[i].values);
    }
    memory_free(lines->arrays);
    memory_free(lines->corners.indices);
    memory_free(lines->ends);
    *lines = (struct foreign_lines){0};
}

conus_status foreign_end_line(struct foreign_mesh *mesh)
{
    struct foreign_lines *lines = mesh->lines;
    const struct corners *face = &mesh->face;
    if (lines) {
        struct corners *all = &lines->corners;
        if (!memory_reserve(&all->indices, &all->capacity, all->count + face->count, sizeof *all->indices) ||
            !memory_reserve(&lines->ends, &lines->capacity, lines->count + 1, sizeof *lines->ends)) {
            return CONUS_ERROR_MEMORY;
        }
        if (face->count) {
            memcpy(&all->indices[all->count], face->indices, face->count * sizeof *face->indices);
        }
        all->count += face->count;
        lines->ends[lines->count++] = all->count;
    }
    drop_face(mesh);
    return CONUS_OK;
}

conus_status foreign_lines_array(struct foreign_array **out, struct foreign_lines *lines, struct text name,
                                 bool per_point, uint64_t components)
{
    char *words = text_to_utf8(name);
    if (!words) {
        return CONUS_ERROR_MEMORY;
    }
    struct foreign_array *found = NULL;
    for (size_t i = 0; i < lines->array_count; i++) {
        struct foreign_array *array = &lines->arrays[i];
        found = !found && array->per_point == per_point && strcmp(array->name, words) == 0 ? array : found;
    }
    bool fits = components >= 1 && components <= FOREIGN_COMPONENT_LIMIT && (!found || found->components == components);
    conus_status status = CONUS_OK;
    if (!fits) {
        status = fail(CONUS_ERROR_DATA, "%s: %llu numbers for each point or cell, allowed are 1 to %d, the same in all",
                      words, (unsigned long long)components, FOREIGN_COMPONENT_LIMIT);
    } else if (!found && lines->array_count >= FOREIGN_ARRAY_LIMIT) {
        status = fail(CONUS_ERROR_DATA, "%s: allowed are up to %d arrays", words, FOREIGN_ARRAY_LIMIT);
    } else if (!found &&
               !memory_reserve(&lines->arrays, &lines->array_capacity, lines->array_count + 1, sizeof *lines->arrays)) {
        status = CONUS_ERROR_MEMORY;
    } else if (!found) {
        found = &lines->arrays[lines->array_count++];
        *found = (struct foreign_array){.name = words, .per_point = per_point, .components = (uint32_t)components};
        words = NULL; /* the array has it */
    }
    memory_free(words);
    *out = found;
    return status;
}

conus_status foreign_array_reserve(struct foreign_lines *lines, struct foreign_array *array, size_t more)
{
    if (more > lines->max_memory / sizeof *array->values) {
        return fail(CONUS_ERROR_MEMORY, "%s: %zu numbers, allowed are %llu bytes more (--max-memory)", array->name,
                    more, (unsigned long long)lines->max_memory);
    }
    lines->max_memory -= more * sizeof *array->values;
    return memory_reserve(&array->values, &array->capacity, array->count + more, sizeof *array->values)
               ? CONUS_OK
               : CONUS_ERROR_MEMORY;
}

enum mesh_space foreign_space_in(struct text text)
{
    enum { WORD = sizeof "SPACE" - 1, VALUE = sizeof "LPS" - 1 };
    for (size_t i = 0; i + WORD < text.size; i++) {
        size_t at = i + WORD;
        if (strncasecmp(text.data + i, "SPACE", WORD) != 0 || (i && isalnum((unsigned char)text.data[i - 1]))) {
            continue;
        }
        while (at < text.size && memchr("= \t", text.data[at], 3)) {
            at++;
        }
        const struct text value = {text.data + at, text.size - at < VALUE ? text.size - at : VALUE};
        bool ends = text.size - at <= VALUE || !isalnum((unsigned char)text.data[at + VALUE]);
        if (at > i + WORD && ends && text_is_one_of(value, "RAS/LPS", false)) {
            return text_equal_ignoring_case(value, "RAS") ? MESH_SPACE_RAS : MESH_SPACE_LPS;
        }
    }
    return MESH_SPACE_UNSTATED;
}
