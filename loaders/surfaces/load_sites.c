/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_sites_load(): vertices of a surface with their normals, and which of them have labels. */
#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/surfaces/surfaces.h"
#include "sources/names.h"

#include <string.h>

/* Adds the area of each triangle, as a vector, to its corners, and gives the signed volume, times 6. */
static double add_areas(double (*areas)[3], const uint32_t *first, const struct mesh *mesh)
{
    double volume = 0;
    double from[3]; /* measured from a near point, for precision */
    for (int a = 0; a < 3; a++) {
        from[a] = (double)mesh->positions[a];
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double corners[3][3];
        double sides[2][3];
        double area[3];
        mesh_corners(corners, mesh, t);
        vec3_sub(sides[0], corners[1], corners[0]);
        vec3_sub(sides[1], corners[2], corners[0]);
        vec3_cross(area, sides[0], sides[1]);
        for (size_t k = 0; k < 9; k++) {
            areas[first[mesh->triangles[3 * t + k / 3]]][k % 3] += area[k % 3];
        }
        vec3_sub(corners[0], corners[0], from);
        volume += vec3_dot(corners[0], area);
    }
    return volume;
}

static void add_vertices(struct job *job, conus_sites *sites, const struct mesh *mesh, bool flip)
{
    double(*areas)[3] = job_zeroed(job, mesh->vertex_count, sizeof *areas);
    uint32_t *first = job_raw(job, mesh->vertex_count, sizeof *first);
    if (!JOB_CALL(job, mesh_find_first(first, mesh))) {
        return;
    }
    bool is_inward = add_areas(areas, first, mesh) < 0 && mesh->shape.closed;
    for (size_t i = 0; i < mesh->vertex_count && job_ok(job); i++) {
        double normal[3];
        const double point[3] = {(double)mesh->positions[3 * i], (double)mesh->positions[3 * i + 1],
                                 (double)mesh->positions[3 * i + 2]};
        if (vec3_normalise(normal, areas[first[i]])) {
            vec3_scale(normal, normal, is_inward != flip ? -1 : 1);
            (void)JOB_CALL(job, sites_add(sites, point, normal, i));
        }
    }
    if (!mesh->shape.closed) {
        (void)JOB_CALL(job, notes_add(&sites->notes,
                                      "%s: the surface is not closed: its normals are as its triangles are wound",
                                      mesh->path));
    }
}

conus_status conus_sites_load(conus_sites **out, const char *path, bool flip)
{
    struct job job = {0};
    struct mesh mesh = {0};
    conus_sites *sites = NULL;
    surface_read(&job, &mesh, NULL, path, &(const struct mesh_file_options){.external = true});
    if (JOB_CALL(&job, sites_create(&sites, mesh.vertex_count, true))) {
        sites->path = memory_text(path, strlen(path));
        sites->vertex_count = mesh.vertex_count;
        if (job_need(&job, sites->path)) {
            add_vertices(&job, sites, &mesh, flip);
        }
    }
    mesh_finish(&mesh);
    conus_status status = job_close(&job, NULL, NULL); /* its notes are about the shape: only the normals count here */
    if (status) {
        conus_sites_destroy(sites);
        return status;
    }
    *out = sites;
    return CONUS_OK;
}

bool conus_path_is_vertex_labels(const char *path)
{
    return ending_length(path, keys_file_length(path, KEYS_VERTICES), ROLE_VERTEX_LABELS);
}

struct labelling {
    const uint32_t *labels;
    bool labelled;
};

static bool has_label(const conus_sites *sites, size_t index, void *user)
{
    const struct labelling *asked = user;
    return (asked->labels[sites->sources[index]] != 0) == asked->labelled;
}

conus_status conus_sites_keep_labelled(conus_sites *sites, const char *path, bool labelled)
{
    struct job job = {0};
    struct vertex_labels labels = {0};
    if (!sites->vertex_count) {
        job_fail(&job, CONUS_ERROR_ARGUMENT, "%s: labels of vertices, but the points belong to no surface", path);
    }
    surface_labels_read(&job, &labels, path,
                        &(const struct mesh_file_options){.external = true, .surface = sites->path});
    vertex_labels_extend(&job, &labels, sites->vertex_count);
    if (labels.count != sites->vertex_count) {
        job_bad(&job, "%s: labels of %zu vertices, %s has %zu: they must be as many", path, labels.count, sites->path,
                sites->vertex_count);
    }
    if (job_ok(&job)) {
        sites_filter(sites, has_label, &(struct labelling){labels.labels, labelled});
    }
    vertex_labels_finish(&labels);
    return job_close(&job, NULL, NULL);
}
