/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds points of a structure that needles may point to, and keeps those that are in one. */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "selection/plan/plan.h"

static conus_status add_voxels(conus_sites *sites, const struct plan_constraint *structure, const struct volume *volume)
{
    conus_status status = CONUS_OK;
    for (size_t voxel = volume_next(volume, 0); voxel < volume->voxel_count && !status;
         voxel = volume_next(volume, voxel + 1)) {
        double point[3];
        if (structure->has[volume_object(volume, voxel)]) {
            grid_index(point, volume->info.dim, voxel);
            mat4_point(point, volume->info.world_from_voxel, point);
            status = sites_add(sites, point, NULL, voxel);
        }
    }
    return status;
}

struct inner_check {
    const struct plan_constraint *structure;
    const struct inner_point *inner;
    const conus_atlas *atlas;
};

/* An area that was cut in two is refused by its name. */
static conus_status check_side(void *user, struct text name)
{
    const struct inner_check *check = user;
    uint32_t object = 0;
    conus_status status = object_find(&object, check->atlas, name);
    return status ? status : plan_check_sides(check->structure, check->inner, check->atlas, object);
}

static conus_status find_sites(conus_sites *sites, const struct plan_constraint *structure, const conus_atlas *atlas,
                               const char *names, conus_sites_kind kind)
{
    struct inner_point inner = {0};
    double centroid[4] = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < structure->part_count && !status && kind == CONUS_SITES_VOXELS; i++) {
        const struct volume *volume = structure->parts[i].volume;
        status = volume ? add_voxels(sites, structure, volume) : CONUS_OK;
    }
    if (kind != CONUS_SITES_VOXELS) {
        plan_centroid(centroid, structure);
    }
    if (structure->part_count == 1 && structure->parts->volume && kind != CONUS_SITES_CENTROID) {
        sites->grid = space_grid(&structure->parts->volume->info);
    }
    if (kind == CONUS_SITES_CENTROID && centroid[3] > 0) {
        status = sites_add(sites, centroid, NULL, 0);
    } else if (kind == CONUS_SITES_DEEPEST) {
        status = plan_deepest(&inner, structure, centroid);
        status = status || inner.depth == 0 ? status
                                            : area_list_read(text_from(names), check_side, NULL,
                                                             &(struct inner_check){structure, &inner, atlas});
        status = status || inner.depth == 0 ? status : sites_add(sites, inner.at, NULL, inner.source);
    }
    if (!status && !sites->count) {
        return fail(CONUS_ERROR_ARGUMENT, "%s has no voxels%s", structure->name,
                    kind == CONUS_SITES_VOXELS ? "" : " and no closed surface");
    }
    return status || kind != CONUS_SITES_CENTROID || plan_is_inside(structure, centroid)
               ? status
               : notes_warn(&sites->notes, "the centroid of %s, %.2f, %.2f, %.2f, is not in it", structure->name,
                            centroid[0], centroid[1], centroid[2]);
}

conus_status conus_sites_find(conus_sites **out, const conus_selector *selector, const char *names,
                              conus_sites_kind kind)
{
    struct plan_constraint structure = {0};
    conus_sites *sites = NULL;
    conus_status status = (unsigned)kind <= CONUS_SITES_VOXELS
                              ? plan_structure_find(&structure, selector->atlas, names, kind != CONUS_SITES_VOXELS)
                              : fail(CONUS_ERROR_ARGUMENT, "kind of sites: %d is unknown", (int)kind);
    status = status ? status : sites_create(&sites, 0, false);
    status = status ? status : find_sites(sites, &structure, selector->atlas, names, kind);
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
    return plan_is_inside(asked->structure, sites->points[index]) == asked->inside;
}

conus_status conus_sites_keep_named(conus_sites *sites, const conus_selector *selector, const char *names, bool inside)
{
    struct plan_constraint structure = {0};
    conus_status status = plan_structure_find(&structure, selector->atlas, names, false);
    if (!status) {
        sites_filter(sites, is_named, &(struct naming){&structure, inside});
    }
    plan_constraint_finish(&structure);
    return status;
}
