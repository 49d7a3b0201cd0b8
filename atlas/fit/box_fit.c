/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the size and place of contexts, streamlines and surfaces against those of the areas. */
#include "atlas/fit/fit.h"

#include "atlas/space.h"

#include <math.h>

static const double unit_ratio = 250; /* between 1000, of um to mm, and the ratio of a head to an area */

struct box3 fit_box_of_areas(const conus_atlas *atlas, bool volumes, bool surfaces)
{
    struct box3 box = box3_empty();
    for (size_t i = 0; volumes && i < atlas->volume_count; i++) {
        if (atlas_volume_has_areas(&atlas->volumes[i])) {
            const struct box3 grid = space_grid_box(&atlas->volumes[i].info);
            box3_join(&box, grid.low, grid.high);
        }
    }
    for (uint32_t number = 1; surfaces && number <= atlas->area_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            box3_join(&box, mesh->shape.low, mesh->shape.high);
        }
    }
    return box;
}

static double longest_side(const struct box3 *box)
{
    return fmax(box->high[0] - box->low[0], fmax(box->high[1] - box->low[1], box->high[2] - box->low[2]));
}

conus_status fit_note_size(bool *said, struct notes *notes, const char *words, const struct box3 *box,
                           const struct box3 *areas)
{
    double own = longest_side(box);
    double other = longest_side(areas);
    bool larger = own >= unit_ratio * other;
    *said = own > 0 && other > 0 && (larger || other >= unit_ratio * own);
    return !*said ? CONUS_OK
                  : notes_warn(notes, "%s: %.4g mm long, beside areas of %.4g mm: is one of the two in %s, not mm?",
                               words, own, other, larger ? "micrometres" : "metres");
}

conus_status fit_note_context(struct notes *notes, const conus_atlas *atlas, const char *words, const struct box3 *box)
{
    bool said;
    bool apart = false;
    const struct box3 areas = fit_box_of_areas(atlas, true, true);
    conus_status status = fit_note_size(&said, notes, words, box, &areas);
    for (int a = 0; a < 3; a++) {
        apart = apart || box->low[a] > areas.high[a] || box->high[a] < areas.low[a];
    }
    bool empty = areas.low[0] > areas.high[0];
    return status || said || !apart || empty || atlas->is_moved
               ? status
               : notes_warn(notes, "%s: lies beside the box around the areas: is it in their space?", words);
}
