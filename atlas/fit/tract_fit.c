/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares the points of streamlines with the box around the areas, and with the grid of their voxels. */
#include "atlas/fit/tract_fit.h"

#include "base/math3.h"

#include <math.h>

struct extent {
    double low[3], high[3]; /* of all points */
    uint64_t inside;        /* how many are in the box */
    uint64_t as_indices;    /* how many would be there, if their coordinates were indices of voxels */
};

static bool is_within(const double p[3], const double low[3], const double high[3])
{
    return p[0] >= low[0] && p[1] >= low[1] && p[2] >= low[2] && p[0] <= high[0] && p[1] <= high[1] && p[2] <= high[2];
}

static struct extent measure(const struct tractogram *tractogram, const double low[3], const double high[3],
                             const double world_from_voxel[16])
{
    struct extent extent = {.low = {INFINITY, INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint64_t i = 0; i < tractogram->point_count; i++) {
        double p[3];
        tractogram_point(p, tractogram, i);
        for (int a = 0; a < 3; a++) {
            extent.low[a] = fmin(extent.low[a], p[a]);
            extent.high[a] = fmax(extent.high[a], p[a]);
        }
        extent.inside += is_within(p, low, high);
        mat4_point(p, world_from_voxel, p);
        extent.as_indices += is_within(p, low, high);
    }
    return extent;
}

/* All are in the grid if they are indices, as many of them at least come to the areas then, and these reach below 0 mm,
 * where no index is. A bundle of the right front in mm is not brought to the areas by that. */
static bool looks_like_indices(const struct extent *extent, const size_t dim[3], const double areas_low[3])
{
    bool below = false;
    bool within = true;
    for (int a = 0; a < 3; a++) {
        below = below || areas_low[a] < 0;
        within = within && extent->low[a] >= 0 && extent->high[a] <= (double)dim[a];
    }
    return below && within && extent->as_indices && extent->as_indices >= extent->inside;
}

conus_status tract_fit_note(struct notes *notes, const conus_atlas *atlas, const struct tractogram *tractogram,
                            const char *name)
{
    double low[3];
    double high[3];
    double world[16];
    mat4_identity(world);
    if (!tractogram->point_count || !atlas_area_bounds(low, high, atlas, world)) {
        return CONUS_OK;
    }
    const struct volume *voxels = atlas_parcellation_count(atlas) ? &atlas->volumes[0] : NULL;
    const struct extent extent = measure(tractogram, low, high, voxels ? voxels->info.world_from_voxel : world);
    if (voxels && looks_like_indices(&extent, voxels->info.dim, low)) {
        const size_t *dim = voxels->info.dim;
        return notes_warn(notes,
                          "bundle %s: all coordinates are from 0 to the %zu x %zu x %zu voxels of the atlas, and areas "
                          "reach below 0 mm: are they voxel indices, not mm?",
                          name, dim[0], dim[1], dim[2]);
    }
    if (!extent.inside) {
        return notes_warn(notes, "bundle %s: none of %llu points is in the box around the areas: is it in their space?",
                          name, (unsigned long long)tractogram->point_count);
    }
    return 2 * extent.inside >= tractogram->point_count
               ? CONUS_OK
               : notes_warn(notes,
                            "bundle %s: %.3g %% of its points are in the box around the areas: is it in their space?",
                            name, 100 * (double)extent.inside / (double)tractogram->point_count);
}
