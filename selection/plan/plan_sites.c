/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds points of a structure that needles may point to, and whether a point is in a structure. */
#include "atlas/sites.h"
#include "atlas/space.h"
#include "atlas/surface/mesh_near.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/plan/plan_constraint.h"

#include <math.h>

static bool has_voxel(const struct plan_constraint *structure, const struct volume *volume, size_t voxel)
{
    return structure->has[volume_object(volume, voxel)] != 0;
}

static bool is_inside(const struct plan_constraint *structure, const double point[3])
{
    bool found = false;
    for (size_t i = 0; i < structure->part_count && !found; i++) {
        const struct plan_part *part = &structure->parts[i];
        size_t voxel;
        found = part->volume
                    ? volume_find_voxel(&voxel, part->volume, point) && has_voxel(structure, part->volume, voxel)
                    : part->mesh && part->mesh->shape.closed && fabs(mesh_winding(part->mesh, point)) > 0.5;
    }
    return found;
}

static void place_voxel(double out[3], const struct volume *volume, size_t voxel)
{
    const size_t *dim = volume->info.dim;
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    const double index[3] = {(double)at[0], (double)at[1], (double)at[2]};
    mat4_point(out, volume->info.world_from_voxel, index);
}

static conus_status add_voxels(conus_sites *sites, const struct plan_constraint *structure, const struct volume *volume)
{
    conus_status status = CONUS_OK;
    for (size_t voxel = volume_next(volume, 0); voxel < volume->voxel_count && !status;
         voxel = volume_next(volume, voxel + 1)) {
        double point[3];
        if (has_voxel(structure, volume, voxel)) {
            place_voxel(point, volume, voxel);
            status = sites_add(sites, point, NULL, voxel);
        }
    }
    return status;
}

/* mm from a voxel's centre to the nearest one around the structure, looked for in one cube of voxels round the next,
 * until none that is farther out can be nearer, or `enough` is not exceeded. */
static double find_depth(const struct plan_constraint *structure, const struct volume *volume, size_t voxel,
                         double enough, double apart)
{
    const double *m = volume->info.world_from_voxel;
    const ptrdiff_t dim[3] = {(ptrdiff_t)volume->info.dim[0], (ptrdiff_t)volume->info.dim[1],
                              (ptrdiff_t)volume->info.dim[2]};
    const ptrdiff_t at[3] = {(ptrdiff_t)voxel % dim[0], (ptrdiff_t)voxel / dim[0] % dim[1],
                             (ptrdiff_t)voxel / dim[0] / dim[1]};
    double least = INFINITY;
    for (ptrdiff_t r = 1; (double)r * apart < least && least > enough; r++) {
        for (ptrdiff_t z = -r; z <= r; z++) {
            for (ptrdiff_t y = -r; y <= r; y++) {
                bool is_wall = z == -r || z == r || y == -r || y == r;
                for (ptrdiff_t x = -r; x <= r; x += is_wall ? 1 : 2 * r) {
                    const ptrdiff_t p[3] = {at[0] + x, at[1] + y, at[2] + z};
                    bool is_beyond =
                        p[0] < 0 || p[1] < 0 || p[2] < 0 || p[0] >= dim[0] || p[1] >= dim[1] || p[2] >= dim[2];
                    if (is_beyond || !has_voxel(structure, volume, (size_t)(p[0] + dim[0] * (p[1] + dim[1] * p[2])))) {
                        const double step[3] = {(double)x, (double)y, (double)z};
                        double way[3];
                        mat4_direction(way, m, step);
                        least = fmin(least, vec3_length(way));
                    }
                }
            }
        }
    }
    return least;
}

/* A voxel's depth is at most a step more than that of its neighbour, so that most need not be looked at. */
static void find_deepest(double best[4], uint64_t *source, const struct plan_constraint *structure,
                         const struct volume *volume)
{
    static const double ROUNDING = 1e-9;
    double step = vec3_length(volume->info.world_from_voxel);
    double apart = INFINITY; /* mm between two planes of voxels at least */
    double bound = INFINITY;
    for (int a = 0; a < 3; a++) {
        const double *inverse = volume->voxel_from_world + a;
        apart = fmin(apart, 1 / sqrt(inverse[0] * inverse[0] + inverse[4] * inverse[4] + inverse[8] * inverse[8]));
    }
    for (size_t voxel = 0; voxel < volume->voxel_count; voxel++) {
        bound = voxel % volume->info.dim[0] ? bound + step : INFINITY;
        if (!has_voxel(structure, volume, voxel)) {
            bound = 0;
        } else if (bound > best[3] + ROUNDING) {
            bound = find_depth(structure, volume, voxel, best[3] + ROUNDING, apart);
            if (bound > best[3] + ROUNDING) {
                place_voxel(best, volume, voxel);
                best[3] = bound;
                *source = voxel;
            }
        }
    }
}

/* Adds the centres of a part's voxels, or that of its inside, each times its volume; the weight is sum[3]. */
static void add_part(double sum[4], const struct plan_constraint *structure, const struct plan_part *part)
{
    if (part->volume) {
        double one = fabs(mat4_determinant3(part->volume->info.world_from_voxel));
        for (size_t voxel = 0; voxel < part->volume->voxel_count; voxel++) {
            double point[3];
            if (has_voxel(structure, part->volume, voxel)) {
                place_voxel(point, part->volume, voxel);
                for (int a = 0; a < 4; a++) {
                    sum[a] += one * (a < 3 ? point[a] : 1);
                }
            }
        }
    } else if (part->mesh && part->mesh->shape.closed) {
        double volume = fabs(part->mesh->shape.volume_mm3);
        for (int a = 0; a < 4; a++) {
            sum[a] += volume * (a < 3 ? part->mesh->shape.centroid[a] : 1);
        }
    }
}

static conus_status find_sites(conus_sites *sites, const struct plan_constraint *structure, conus_sites_kind kind)
{
    double found[4] = {0}; /* a point, and its weight or depth */
    uint64_t source = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < structure->part_count && !status; i++) {
        const struct plan_part *part = &structure->parts[i];
        if (kind == CONUS_SITES_CENTROID) {
            add_part(found, structure, part);
        } else if (part->volume && kind == CONUS_SITES_VOXELS) {
            status = add_voxels(sites, structure, part->volume);
        } else if (part->volume) {
            find_deepest(found, &source, structure, part->volume);
        }
    }
    if (structure->part_count == 1 && structure->parts->volume && kind != CONUS_SITES_CENTROID) {
        sites->grid = space_grid(&structure->parts->volume->info);
    }
    if (kind == CONUS_SITES_CENTROID && found[3] > 0) {
        vec3_scale(found, found, 1 / found[3]);
    }
    if (!status && kind != CONUS_SITES_VOXELS && found[3] > 0) {
        status = sites_add(sites, found, NULL, source);
    }
    if (!status && !sites->count) {
        return fail(CONUS_ERROR_ARGUMENT, "%s has no voxels%s", structure->name,
                    kind == CONUS_SITES_CENTROID ? " and no closed surface" : "");
    }
    return status || kind != CONUS_SITES_CENTROID || is_inside(structure, found)
               ? status
               : notes_warn(&sites->notes, "the centroid of %s, %.2f, %.2f, %.2f, is not in it", structure->name,
                            found[0], found[1], found[2]);
}

conus_status conus_sites_find(conus_sites **out, const conus_selector *selector, const char *names,
                              conus_sites_kind kind)
{
    struct plan_constraint structure = {0};
    conus_sites *sites = NULL;
    conus_status status = (unsigned)kind <= CONUS_SITES_VOXELS
                              ? plan_structure_find(&structure, selector->atlas, names)
                              : fail(CONUS_ERROR_ARGUMENT, "kind of sites: %d is unknown", (int)kind);
    status = status ? status : sites_create(&sites, 0, false);
    status = status ? status : find_sites(sites, &structure, kind);
    plan_constraint_finish(&structure);
    if (status) {
        conus_sites_destroy(sites);
        return status;
    }
    *out = sites;
    return CONUS_OK;
}

struct naming {
    const struct plan_constraint *structure;
    bool inside;
};

static bool is_named(const conus_sites *sites, size_t index, void *user)
{
    const struct naming *asked = user;
    return is_inside(asked->structure, sites->points[index]) == asked->inside;
}

conus_status conus_sites_keep_named(conus_sites *sites, const conus_selector *selector, const char *names, bool inside)
{
    struct plan_constraint structure = {0};
    conus_status status = plan_structure_find(&structure, selector->atlas, names);
    if (!status) {
        sites_filter(sites, is_named, &(struct naming){&structure, inside});
    }
    plan_constraint_finish(&structure);
    return status;
}
