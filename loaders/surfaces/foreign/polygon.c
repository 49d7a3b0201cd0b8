/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts a polygon into triangles by taking ears off, the one with the best shape first: that of the least squared
 * perimeter over area. Of equally good ones the one that has been so for longest goes first. So does VTK, which gives
 * the same triangles of the same corners; without this order a polygon that is not flat would become another surface.
 */
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

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

/* What has no ear crosses itself or has no area: triangles from one corner, so that its edges stay where they are. */
static conus_status fan_out(struct foreign_mesh *mesh, const struct polygon *polygon, size_t first)
{
    const struct polygon_corner *corners = polygon->corners;
    conus_status status = CONUS_OK;
    for (size_t i = corners[first].next; !status && corners[i].next != first; i = corners[i].next) {
        status = foreign_add_triangle(mesh, corners[first].vertex, corners[i].vertex, corners[corners[i].next].vertex);
    }
    return status;
}

static conus_status cut(struct foreign_mesh *mesh, struct polygon *polygon, size_t count)
{
    conus_status status = CONUS_OK;
    size_t first = 0;
    while (!status && polygon->left > 2) {
        size_t ear = best_ear(polygon, count);
        if (ear == count) {
            return fan_out(mesh, polygon, first);
        }
        if (polygon->ears == polygon->left || is_empty(polygon, ear)) {
            first = polygon->corners[ear].next;
            status = take_ear(mesh, polygon, ear);
        } else {
            polygon->ears--;
            polygon->corners[ear].measure = 0; /* until one beside it goes */
        }
    }
    return status;
}

conus_status polygon_cut(struct foreign_mesh *mesh, const uint32_t *corners, size_t count)
{
    struct polygon *polygon = memory_raw(1, sizeof *polygon);
    if (!polygon) {
        return CONUS_ERROR_MEMORY;
    }
    setup_polygon(polygon, mesh, corners, count);
    conus_status status = cut(mesh, polygon, count);
    memory_free(polygon);
    return status;
}
