/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the size and place of contexts, streamlines and surfaces against those of the areas. */
#include "atlas/fit/box_fit.h"

#include "base/geometry/math3.h"

#include <math.h>

static const double unit_ratio = 250; /* between 1000, of um to mm, and the ratio of a head to an area */

static void add_corner(struct fit_box *box, const double p[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = fmin(box->low[a], p[a]);
        box->high[a] = fmax(box->high[a], p[a]);
    }
}

static struct fit_box empty_box(void)
{
    return (struct fit_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

struct fit_box fit_box_of_grid(const conus_volume_info *info)
{
    struct fit_box box = empty_box();
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = (corner >> a & 1 ? (double)info->dim[a] : 0) - 0.5;
        }
        mat4_point(p, info->world_from_voxel, p);
        add_corner(&box, p);
    }
    return box;
}

struct fit_box fit_box_of_areas(const conus_atlas *atlas, bool volumes, bool surfaces)
{
    struct fit_box box = empty_box();
    for (size_t i = 0; volumes && i < atlas->volume_count; i++) {
        if (atlas_volume_has_areas(&atlas->volumes[i])) {
            const struct fit_box grid = fit_box_of_grid(&atlas->volumes[i].info);
            add_corner(&box, grid.low);
            add_corner(&box, grid.high);
        }
    }
    for (uint32_t number = 1; surfaces && number <= atlas->area_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            add_corner(&box, mesh->shape.low);
            add_corner(&box, mesh->shape.high);
        }
    }
    return box;
}

static double longest_side(const struct fit_box *box)
{
    return fmax(box->high[0] - box->low[0], fmax(box->high[1] - box->low[1], box->high[2] - box->low[2]));
}

conus_status fit_note_size(bool *said, struct notes *notes, const char *words, const struct fit_box *box,
                           const struct fit_box *areas)
{
    double own = longest_side(box);
    double other = longest_side(areas);
    bool larger = own >= unit_ratio * other;
    *said = own > 0 && other > 0 && (larger || other >= unit_ratio * own);
    return !*said ? CONUS_OK
                  : notes_warn(notes, "%s: %.4g mm long, beside areas of %.4g mm: is one of the two in %s, not mm?",
                               words, own, other, larger ? "micrometres" : "metres");
}

conus_status fit_note_context(struct notes *notes, const conus_atlas *atlas, const char *words,
                              const struct fit_box *box)
{
    bool said;
    bool apart = false;
    const struct fit_box areas = fit_box_of_areas(atlas, true, true);
    conus_status status = fit_note_size(&said, notes, words, box, &areas);
    for (int a = 0; a < 3; a++) {
        apart = apart || box->low[a] > areas.high[a] || box->high[a] < areas.low[a];
    }
    bool empty = areas.low[0] > areas.high[0];
    return status || said || !apart || empty || atlas->is_moved
               ? status
               : notes_warn(notes, "%s: lies beside the box around the areas: is it in their space?", words);
}
