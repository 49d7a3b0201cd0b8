/* SPDX-License-Identifier: BSD-3-Clause */
/* Sites: points that are thinned out, and those of regions. */
#include "atlas/atlas.h"

#include "atlas/space.h"
#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <math.h>
#include <string.h>

static const double LEAST_SPACING = 1e-3; /* mm */

void conus_sites_destroy(conus_sites *sites)
{
    if (sites) {
        memory_free(sites->points);
        memory_free(sites->normals);
        memory_free(sites->sources);
        memory_free(sites->path);
        notes_finish(&sites->notes);
        memory_free(sites);
    }
}

conus_status sites_create(conus_sites **out, size_t capacity, bool has_normals)
{
    conus_sites *sites = memory_zeroed(1, sizeof *sites);
    if (!sites) {
        return CONUS_ERROR_MEMORY;
    }
    sites->capacity = capacity;
    sites->points = memory_raw(capacity, sizeof *sites->points);
    sites->sources = memory_raw(capacity, sizeof *sites->sources);
    sites->normals = has_normals ? memory_raw(capacity, sizeof *sites->normals) : NULL;
    bool whole = sites->points && sites->sources && (!has_normals || sites->normals);
    conus_status status = whole ? CONUS_OK : CONUS_ERROR_MEMORY;
    return GIVE(status, out, sites, conus_sites_destroy(sites));
}

conus_status sites_add(conus_sites *sites, const double point[3], const double *normal, uint64_t source)
{
    size_t capacity = sites->capacity;
    size_t points = capacity;
    size_t sources = capacity;
    if (!memory_reserve(&sites->points, &points, sites->count + 1, sizeof *sites->points) ||
        !memory_reserve(&sites->sources, &sources, sites->count + 1, sizeof *sites->sources) ||
        (normal && !memory_reserve(&sites->normals, &capacity, sites->count + 1, sizeof *sites->normals))) {
        return CONUS_ERROR_MEMORY;
    }
    sites->capacity = points;
    memcpy(sites->points[sites->count], point, sizeof *sites->points);
    if (normal) {
        memcpy(sites->normals[sites->count], normal, sizeof *sites->normals);
    }
    sites->sources[sites->count++] = source;
    return CONUS_OK;
}

void sites_filter(conus_sites *sites, bool (*is_kept)(const conus_sites *sites, size_t index, void *user), void *user)
{
    size_t kept = 0;
    for (size_t i = 0; i < sites->count; i++) {
        if (is_kept(sites, i, user)) {
            memmove(sites->points[kept], sites->points[i], sizeof *sites->points);
            if (sites->normals) {
                memmove(sites->normals[kept], sites->normals[i], sizeof *sites->normals);
            }
            sites->sources[kept++] = sites->sources[i];
        }
    }
    sites->count = kept;
}

conus_status conus_sites_create(conus_sites **out, const double *points, size_t count)
{
    conus_sites *sites = NULL;
    conus_status status = sites_create(&sites, count, false);
    for (size_t i = 0; i < count && !status; i++) {
        const double *p = points + 3 * i;
        status = vec3_is_finite(p) ? sites_add(sites, p, NULL, i)
                                   : fail(CONUS_ERROR_ARGUMENT, "point %zu: %g,%g,%g, allowed are finite numbers",
                                          i + 1, p[0], p[1], p[2]);
    }
    return GIVE(status, out, sites, conus_sites_destroy(sites));
}

/* Whether one of a voxel's faces leads out of the region. */
static bool is_at_border(const conus_roi *roi, const size_t at[3], size_t voxel)
{
    const size_t *dim = roi->volume.info.dim;
    const size_t steps[3] = {1, dim[0], dim[0] * dim[1]};
    for (int a = 0; a < 3; a++) {
        if (at[a] == 0 || at[a] + 1 == dim[a] || !roi_has(roi, voxel - steps[a]) || !roi_has(roi, voxel + steps[a])) {
            return true;
        }
    }
    return false;
}

conus_status conus_sites_of_roi(conus_sites **out, const conus_roi *roi)
{
    const size_t *dim = roi->volume.info.dim;
    conus_sites *sites = NULL;
    if (roi->nodes) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: tetrahedra of a mesh, needed are the voxels of a mask",
                    roi->volume.info.path);
    }
    conus_status status = sites_create(&sites, 0, false);
    if (!status) {
        sites->grid = space_grid(&roi->volume.info);
    }
    for (size_t voxel = 0; voxel < roi->volume.voxel_count && !status; voxel++) {
        const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
        if (roi_has(roi, voxel) && is_at_border(roi, at, voxel)) {
            const double index[3] = {(double)at[0], (double)at[1], (double)at[2]};
            double point[3];
            mat4_point(point, roi->volume.info.world_from_voxel, index);
            status = sites_add(sites, point, NULL, voxel);
        }
    }
    return GIVE(status, out, sites, conus_sites_destroy(sites));
}

struct inside_roi {
    const conus_roi *roi;
    bool inside;
};

/* Whether the point and the middle of some tetrahedron lie on one side of each of its faces. */
static bool is_in_tetrahedra(const conus_roi *roi, const double point[3])
{
    bool inside = false;
    for (size_t i = 0; !inside && i < roi->voxels; i++) {
        const uint32_t *corners = roi->tetrahedra[i].nodes;
        inside = true;
        for (int k = 0; inside && k < 4; k++) {
            const double *base = roi->nodes[corners[k]];
            double b[3];
            double c[3];
            double normal[3];
            double across[3];
            double to[3];
            vec3_sub(b, roi->nodes[corners[(k + 1) % 4]], base);
            vec3_sub(c, roi->nodes[corners[(k + 2) % 4]], base);
            vec3_sub(across, roi->nodes[corners[(k + 3) % 4]], base);
            vec3_sub(to, point, base);
            vec3_cross(normal, b, c);
            inside = vec3_dot(normal, to) * vec3_dot(normal, across) >= 0;
        }
    }
    return inside;
}

static bool is_in_roi(const conus_sites *sites, size_t index, void *user)
{
    const struct inside_roi *asked = user;
    size_t voxel = 0;
    bool inside = volume_find_voxel(&voxel, &asked->roi->volume, sites->points[index]) &&
                  (asked->roi->nodes ? is_in_tetrahedra(asked->roi, sites->points[index]) : roi_has(asked->roi, voxel));
    return inside == asked->inside;
}

void conus_sites_keep_roi(conus_sites *sites, const conus_roi *roi, bool inside)
{
    sites_filter(sites, is_in_roi, &(struct inside_roi){roi, inside});
}

conus_status site_cubes_init(struct site_cubes *out, double edge, size_t capacity)
{
    struct site_cubes cubes = {.edge = edge, .mask = 1};
    while (cubes.mask < capacity) {
        cubes.mask = 2 * cubes.mask + 1;
    }
    cubes.first = memory_zeroed(cubes.mask + 1, sizeof *cubes.first);
    cubes.next = memory_raw(capacity, sizeof *cubes.next);
    conus_status status = cubes.first && cubes.next ? CONUS_OK : CONUS_ERROR_MEMORY;
    return GIVE(status, out, cubes, site_cubes_finish(&cubes));
}

void site_cubes_finish(struct site_cubes *cubes)
{
    memory_free(cubes->first);
    memory_free(cubes->next);
    *cubes = (struct site_cubes){0};
}

/* The bucket of the cube that is `off` cubes from that of a point. */
static size_t bucket_of(const struct site_cubes *cubes, const double point[3], const int off[3])
{
    uint64_t hash = 0;
    for (int a = 0; a < 3; a++) {
        hash = (hash ^ (uint64_t)(int64_t)(floor(point[a] / cubes->edge) + off[a])) * UINT64_C(0x9e3779b97f4a7c15);
        hash ^= hash >> 29;
    }
    return (size_t)hash & cubes->mask;
}

void site_cubes_add(struct site_cubes *cubes, const double point[3])
{
    size_t *first = &cubes->first[bucket_of(cubes, point, (const int[3]){0})];
    cubes->next[cubes->count++] = *first;
    *first = cubes->count;
}

size_t site_cubes_nearest(const struct site_cubes *cubes, const conus_sites *sites, const double point[3])
{
    size_t found = SIZE_MAX;
    double least = cubes->edge;
    for (int near = 0; near < 27; near++) {
        const int off[3] = {near % 3 - 1, near / 3 % 3 - 1, near / 9 - 1};
        for (size_t i = cubes->first[bucket_of(cubes, point, off)]; i; i = cubes->next[i - 1]) {
            double way[3];
            vec3_sub(way, point, sites->points[i - 1]);
            double length = vec3_length(way);
            if (length < least || (length == least && found != SIZE_MAX && i - 1 < found)) {
                least = length;
                found = i - 1;
            }
        }
    }
    return found;
}

static bool is_spaced(const conus_sites *sites, size_t index, void *user)
{
    struct site_cubes *cubes = user;
    bool is = site_cubes_nearest(cubes, sites, sites->points[index]) == SIZE_MAX;
    if (is) {
        site_cubes_add(cubes, sites->points[index]);
    }
    return is;
}

conus_status conus_sites_space(conus_sites *sites, double spacing)
{
    if (!(spacing >= LEAST_SPACING && isfinite(spacing))) {
        return fail(CONUS_ERROR_ARGUMENT, "spacing: %g mm, allowed is %g or more", spacing, LEAST_SPACING);
    }
    struct site_cubes cubes = {0};
    conus_status status = site_cubes_init(&cubes, spacing, sites->count);
    if (!status) {
        sites_filter(sites, is_spaced, &cubes);
    }
    site_cubes_finish(&cubes);
    return status;
}

size_t conus_sites_count(const conus_sites *sites)
{
    return sites ? sites->count : 0;
}

const double *conus_sites_points(const conus_sites *sites)
{
    return sites ? sites->points[0] : NULL;
}

const double *conus_sites_normals(const conus_sites *sites)
{
    return sites && sites->normals ? sites->normals[0] : NULL;
}

bool conus_sites_have_voxels(const conus_sites *sites)
{
    return sites && sites->grid.count > 0;
}

uint64_t conus_sites_source(const conus_sites *sites, size_t index)
{
    return index < conus_sites_count(sites) ? sites->sources[index] : UINT64_MAX;
}

const char *conus_sites_note(const conus_sites *sites, size_t index)
{
    return index < sites->notes.count ? sites->notes.lines[index] : NULL;
}

conus_severity conus_sites_note_severity(const conus_sites *sites, size_t index)
{
    return notes_severity(&sites->notes, index);
}
