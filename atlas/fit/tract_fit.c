/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares the points of streamlines with the box around the areas, and with the grid of their voxels. */
#include "atlas/fit/fit.h"

#include "base/geometry/math3.h"
#include "conus/own.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct extent {
    struct box3 box;     /* of all points */
    uint64_t inside;     /* how many are in the areas' box */
    uint64_t before;     /* how many are where that was before the areas were moved */
    uint64_t as_indices; /* how many would be there, if their coordinates were indices of voxels */
};

static bool is_within(const double p[3], const struct box3 *box)
{
    const double *low = box->low;
    const double *high = box->high;
    return p[0] >= low[0] && p[1] >= low[1] && p[2] >= low[2] && p[0] <= high[0] && p[1] <= high[1] && p[2] <= high[2];
}

/* The boxes of the areas now and before a move; the same without one. */
struct boxes {
    struct box3 now, own;
};

/* The box of a moved atlas in the space of its files. A field has no box, so a lattice of points stands for it. */
static void find_own_lattice(struct boxes *boxes, const conus_atlas *atlas)
{
    enum { STEPS = 8 };
    boxes->own = box3_empty();
    for (int i = 0; i < (STEPS + 1) * (STEPS + 1) * (STEPS + 1); i++) {
        const int at[3] = {i % (STEPS + 1), i / (STEPS + 1) % (STEPS + 1), i / (STEPS + 1) / (STEPS + 1)};
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = boxes->now.low[a] + (boxes->now.high[a] - boxes->now.low[a]) * at[a] / STEPS;
        }
        conus_atlas_own_point(p, atlas, p);
        box3_add(&boxes->own, p);
    }
}

/* False where there are no areas. */
static bool find_boxes(struct boxes *boxes, const conus_atlas *atlas)
{
    double here[16];
    mat4_identity(here);
    if (!atlas_area_bounds(boxes->now.low, boxes->now.high, atlas, here)) {
        return false;
    }
    if (conus_atlas_is_warped(atlas)) {
        find_own_lattice(boxes, atlas);
    } else {
        (void)atlas_area_bounds(boxes->own.low, boxes->own.high, atlas,
                                atlas->is_moved ? atlas->own_from_world : here); /* there are areas */
    }
    return true;
}

/* Adds a point; `voxels` is the grid whose indices they may be, or NULL. */
static void add_point(struct extent *extent, const struct tractogram *tractogram, uint64_t index,
                      const struct boxes *boxes, const struct volume *voxels)
{
    double p[3];
    tractogram_point(p, tractogram, index);
    box3_add(&extent->box, p);
    extent->inside += is_within(p, &boxes->now);
    extent->before += is_within(p, &boxes->own);
    if (voxels) {
        mat4_point(p, voxels->info.world_from_voxel, p);
        extent->as_indices += is_within(p, &boxes->now);
    }
}

/* Whether a sample of many points shows that tract_fit_note() has nothing to say about where they are: it is farther
 * from all limits there than ten times what chance does. Points of a mapped tractogram may be on the disk, so as few
 * pages as may be are read. Points that may be voxels' indices are counted. */
static bool sample_fits(struct extent *sample, const struct tractogram *tractogram, const struct boxes *boxes)
{
    enum { SAMPLE = 4096, MANY = 16 * SAMPLE };
    const uint64_t golden = 0x9e3779b97f4a7c15U; /* multiples of it, modulo 2^64, lie evenly */
    if (!tractogram->is_ready || !tractogram->states_mm || tractogram->point_count < MANY) {
        return false;
    }
    *sample = (struct extent){.box = box3_empty()};
    for (uint64_t i = 0; i < SAMPLE; i++) {
        uint64_t index = (uint64_t)((double)(i * golden >> 11) * 0x1p-53 * (double)tractogram->point_count);
        add_point(sample, tractogram, index, boxes, NULL);
    }
    memcpy(sample->box.low, tractogram->low, sizeof sample->box.low);
    memcpy(sample->box.high, tractogram->high, sizeof sample->box.high);
    return sample->inside >= SAMPLE / 5 * 3 && sample->before < sample->inside + SAMPLE / 100;
}

/* If they are indices, all are in the grid, at least as many come to the areas then, and the areas reach below 0 mm,
 * where no index is. A bundle of the right front in mm is not brought to the areas by that. */
static bool looks_like_indices(const struct extent *extent, const size_t dim[3], const double areas_low[3])
{
    bool below = false;
    bool within = true;
    for (int a = 0; a < 3; a++) {
        below = below || areas_low[a] < 0;
        within = within && extent->box.low[a] >= 0 && extent->box.high[a] <= (double)dim[a];
    }
    return below && within && extent->as_indices && extent->as_indices >= extent->inside;
}

conus_status tract_fit_note(struct notes *notes, const conus_atlas *atlas, const struct tractogram *tractogram,
                            const char *name)
{
    struct boxes boxes;
    if (!tractogram->point_count || !find_boxes(&boxes, atlas)) {
        return CONUS_OK;
    }
    const double all = (double)tractogram->point_count;
    const struct volume *voxels = atlas_parcellation_count(atlas) ? &atlas->volumes[0] : NULL;
    struct extent extent;
    bool fits = sample_fits(&extent, tractogram, &boxes);
    if (!fits) {
        extent = (struct extent){.box = box3_empty()};
        for (uint64_t i = 0; i < tractogram->point_count; i++) {
            add_point(&extent, tractogram, i, &boxes, voxels);
        }
    }
    char words[300];
    bool said;
    const struct box3 areas = fit_box_of_areas(atlas, true, true);
    snprintf(words, sizeof words, "bundle %s", name);
    conus_status status = fit_note_size(&said, notes, words, &extent.box, &areas);
    if (status || said || fits) {
        return status;
    }
    if (voxels && !tractogram->states_mm && looks_like_indices(&extent, voxels->info.dim, boxes.now.low)) {
        const size_t *dim = voxels->info.dim;
        return notes_warn(notes,
                          "bundle %s: all coordinates are from 0 to the %zu x %zu x %zu voxels of the atlas, and areas "
                          "reach below 0 mm: are they voxel indices, not mm?",
                          name, dim[0], dim[1], dim[2]);
    }
    /* Near the edge a few points are always elsewhere, and a larger box has more: a twentieth of all is clear. */
    if ((double)extent.before - (double)extent.inside >= all / 20) {
        return notes_warn(notes,
                          "bundle %s: %.3g %% of its points are in the box around the areas, %.3g %% were before these "
                          "were moved: if it is in the atlas's space, let it move, too (,moves behind the file)",
                          name, 100 * (double)extent.inside / all, 100 * (double)extent.before / all);
    }
    if (!extent.inside) {
        return notes_warn(notes, "bundle %s: none of %llu points is in the box around the areas: is it in their space?",
                          name, (unsigned long long)tractogram->point_count);
    }
    return 2 * extent.inside >= tractogram->point_count
               ? CONUS_OK
               : notes_warn(notes,
                            "bundle %s: %.3g %% of its points are in the box around the areas: is it in their space?",
                            name, 100 * (double)extent.inside / all);
}
