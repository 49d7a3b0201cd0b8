/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts polygons and strips into triangles, and numbers objects. */
#include "loaders/surfaces/foreign/parts.h"

#include "base/geometry/math3.h"
#include "base/order.h"

#include <string.h>

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

static void setup_polygon(struct polygon *out, const struct mesh_sink *sink, const uint32_t *vertices, size_t count)
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
            corner->at[k] = (double)sink->vertices.at[vertices[i]].at[k];
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
static bool is_inside(const struct polygon *polygon, const double a[3], const double b[3], const double p[3])
{
    double along[3];
    double to[3];
    double cross[3];
    vec3_sub(along, b, a);
    vec3_sub(to, p, a);
    vec3_cross(cross, along, to);
    return vec3_dot(cross, polygon->normal) >= 0;
}

static bool is_same(const double a[3], const double b[3])
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
        bool same = is_same(p, tip->at) || is_same(p, before->at) || is_same(p, after->at);
        if (!same && is_inside(polygon, before->at, tip->at, p) && is_inside(polygon, tip->at, after->at, p) &&
            is_inside(polygon, after->at, before->at, p)) {
            return false;
        }
    }
    return true;
}

/* The vertices must be there. */
static void add_triangle(struct mesh_build *build, uint32_t a, uint32_t b, uint32_t c)
{
    struct job *job = build->sink.job;
    const struct mesh_triangle triangle = {{a, b, c}};
    if (build->triangles.count < build->triangles.capacity && job_ok(job)) {
        build->triangles.at[build->triangles.count++] = triangle;
    } else {
        *LIST_ADD(job, &build->triangles) = triangle;
    }
    if (build->triangles.count > UINT32_MAX) {
        job_bad(job, "%zu triangles, allowed are up to 4294967295", build->triangles.count);
    }
    if (build->sink.objects.count) {
        *LIST_ADD(job, &build->owners) = (uint32_t)build->sink.objects.count - 1;
    }
}

static void take_ear(struct mesh_build *build, struct polygon *polygon, size_t ear)
{
    struct polygon_corner *tip = &polygon->corners[ear];
    struct polygon_corner *before = &polygon->corners[tip->previous];
    struct polygon_corner *after = &polygon->corners[tip->next];
    add_triangle(build, tip->vertex, after->vertex, before->vertex);
    before->next = tip->next;
    after->previous = tip->previous;
    polygon->ears -= tip->measure > 0;
    tip->measure = 0;
    polygon->left--;
    measure_ear(polygon, tip->previous);
    measure_ear(polygon, tip->next);
}

/* Cuts a polygon of 4 corners or more into triangles and appends them. */
static void cut_polygon(struct mesh_build *build, const uint32_t *corners, size_t count)
{
    struct job *job = build->sink.job;
    struct polygon *polygon = build->polygon = build->polygon ? build->polygon : job_raw(job, 1, sizeof *polygon);
    if (!polygon) {
        return;
    }
    setup_polygon(polygon, &build->sink, corners, count);
    size_t first = 0;
    while (polygon->left > 2) {
        size_t ear = best_ear(polygon, count);
        if (ear == count) {
            /* It crosses itself or has no area: triangles from one corner keep its edges where they are. */
            const struct polygon_corner *all = polygon->corners;
            for (size_t i = all[first].next; all[i].next != first; i = all[i].next) {
                add_triangle(build, all[first].vertex, all[i].vertex, all[all[i].next].vertex);
            }
            break;
        }
        if (polygon->ears == polygon->left || is_empty(polygon, ear)) {
            first = polygon->corners[ear].next;
            take_ear(build, polygon, ear);
        } else {
            polygon->ears--;
            polygon->corners[ear].measure = 0; /* until one beside it goes */
        }
    }
}

static void end_cell(struct mesh_sink *sink, enum cell cell)
{
    struct mesh_build *build = (struct mesh_build *)sink;
    const uint32_t *at = sink->corners.at;
    const size_t count = sink->corners.count;
    if (cell == CELL_POLYGON && count > POLYGON_LIMIT) {
        job_refuse(sink->job, "%s %zu: a polygon of %zu corners, allowed are up to %d", sink_cell_word(sink),
                   sink_cell(sink), count, POLYGON_LIMIT);
    } else if (cell == CELL_POLYGON && count > 3) {
        cut_polygon(build, at, count);
    } else if (cell == CELL_POLYGON && count > 0) {
        add_triangle(build, at[0], at[count > 1], at[count - 1]);
    }
    for (size_t i = 0; cell == CELL_STRIP && i + 2 < count; i++) {
        add_triangle(build, at[i + i % 2], at[i + 1 - i % 2], at[i + 2]);
    }
    sink->corners.count = 0;
}

struct mesh_build mesh_build_of(struct job *job)
{
    return (struct mesh_build){.sink = {.job = job, .end = end_cell}};
}

/* The elements of a list, without room that is left, for the caller to memory_free(). */
static void *give(struct job *job, void *list, size_t count, size_t size)
{
    return job_give(job, job_grow(job, list, count, size), count * size);
}

void mesh_build_give(struct mesh *out, struct mesh_build *build)
{
    struct job *job = build->sink.job;
    const size_t vertices = build->sink.vertices.count;
    const size_t triangles = build->triangles.count;
    if (!triangles) {
        job_bad(job, "no triangle with an area: no ray can hit it");
    }
    out->positions = give(job, build->sink.vertices.at, vertices, sizeof *build->sink.vertices.at);
    out->triangles = give(job, build->triangles.at, triangles, sizeof *build->triangles.at);
    out->vertex_count = out->positions ? vertices : 0;
    out->triangle_count = out->triangles ? triangles : 0;
}

/* A statement "o"; of those with one name, the first one stands for all. */
struct object {
    struct text name;
    uint32_t place; /* in the file */
    uint32_t first; /* place of the first one of this name */
};

static int by_name(const void *a, const void *b)
{
    return text_compare(((const struct object *)a)->name, ((const struct object *)b)->name);
}

static int by_place(const void *a, const void *b)
{
    return compare_unsigned(((const struct object *)a)->place, ((const struct object *)b)->place);
}

struct mesh_objects mesh_build_objects(struct mesh_build *build)
{
    struct job *job = build->sink.job;
    size_t count = build->sink.objects.count;
    struct mesh_objects out = {job_raw(job, count, sizeof *out.names), 0};
    uint32_t *numbers = job_zeroed(job, count, sizeof *numbers); /* from 1, of the first of a name */
    struct object *objects = job_array(job, &count, sizeof *objects);
    for (size_t i = 0; i < count; i++) {
        objects[i] = (struct object){.name = build->sink.objects.at[i], .place = (uint32_t)i};
    }
    if (!count) {
        return out;
    }
    order_sort(objects, count, sizeof *objects, by_name);
    for (size_t i = 0; i < count; i++) {
        bool same = i > 0 && text_compare(objects[i].name, objects[i - 1].name) == 0;
        objects[i].first = same ? objects[i - 1].first : objects[i].place;
    }
    order_sort(objects, count, sizeof *objects, by_place);
    for (size_t i = 0; i < build->triangles.count; i++) {
        uint32_t first = objects[build->owners.at[i]].first;
        if (!numbers[first]) {
            out.names[out.count++] = objects[first].name;
            numbers[first] = (uint32_t)out.count;
        }
        build->owners.at[i] = numbers[first] - 1;
    }
    return out;
}
