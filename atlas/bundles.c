/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes bundles of a tractogram. */
#include "atlas/atlas.h"

#include "atlas/labels/labels.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

enum { FIRST_COLOUR = 2000 }; /* in the palette, away from areas and pathways */

/* Numbers of the streamlines that are in no group; all of them if there are no groups. */
static conus_status find_rest(struct tract_group *out, const struct tractogram *tractogram)
{
    bool *grouped = memory_zeroed(tractogram->streamline_count, sizeof *grouped);
    uint32_t *rest = memory_raw(tractogram->streamline_count, sizeof *rest);
    if (!grouped || !rest) {
        memory_free(grouped);
        memory_free(rest);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t g = 0; g < tractogram->group_count; g++) {
        for (size_t i = 0; i < tractogram->groups[g].count; i++) {
            grouped[tractogram->groups[g].members[i]] = true;
        }
    }
    for (uint32_t k = 0; k < tractogram->streamline_count; k++) {
        if (!grouped[k]) {
            rest[out->count++] = k;
        }
    }
    memory_free(grouped);
    out->members = rest;
    return CONUS_OK;
}

/* Appends these streamlines as the last group, which has no name yet, unless there are none. */
static conus_status group_rest(struct tractogram *tractogram)
{
    struct tract_group rest = {0};
    conus_status status = find_rest(&rest, tractogram);
    size_t count = tractogram->group_count + (rest.count > 0);
    rest.name = status ? NULL : memory_text("", 0);
    struct tract_group *groups = rest.name ? memory_resize(tractogram->groups, count, sizeof *groups) : NULL;
    if (!groups) {
        memory_free(rest.name);
        memory_free(rest.members);
        return status ? status : CONUS_ERROR_MEMORY;
    }
    tractogram->groups = groups;
    if (rest.count) {
        groups[tractogram->group_count++] = rest;
    } else {
        memory_free(rest.name);
        memory_free(rest.members);
    }
    return CONUS_OK;
}

conus_status bundles_ready(struct tractogram *tractogram)
{
    conus_status status = tractogram_grow_tree(tractogram);
    status = status || !tractogram->group_count ? status : group_rest(tractogram);
    tractogram->is_ready = !status;
    return status;
}

/* The group of the rest gets the tractogram's name. Gives how many groups are left, whose names are the file's. */
static conus_status name_rest(size_t *named, struct tractogram *tractogram, const char *name)
{
    struct tract_group *last = tractogram->group_count ? &tractogram->groups[tractogram->group_count - 1] : NULL;
    bool has_rest = last && !last->name[0];
    char *own = has_rest ? memory_text(name, strlen(name)) : NULL;
    if (has_rest && !own) {
        return CONUS_ERROR_MEMORY;
    }
    if (has_rest) {
        memory_free(last->name);
        last->name = own;
    }
    *named = tractogram->group_count - has_rest;
    return CONUS_OK;
}

const struct tractogram *atlas_bundle_tractogram(const conus_atlas *atlas, uint32_t number)
{
    struct object_place place = atlas->places[number - 1];
    return place.is_bundle ? &atlas->tractograms[place.index] : NULL;
}

const struct tract_group *atlas_bundle_group(const conus_atlas *atlas, uint32_t number)
{
    const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
    size_t group = atlas->places[number - 1].group;
    return tractogram && group != BUNDLE_OF_ALL ? &tractogram->groups[group] : NULL;
}

bool atlas_has_bundles(const conus_atlas *atlas)
{
    bool found = false;
    for (size_t i = atlas->area_count; i < atlas->object_count && !found; i++) {
        found = atlas->places[i].is_bundle && !atlas->places[i].is_hidden;
    }
    return found;
}

/* Counts the streamlines of a group, or all, and their length. */
static void measure_bundle(conus_object *bundle, const struct tractogram *tractogram, const struct tract_group *group)
{
    size_t count = tract_group_count(group, tractogram);
    bundle->streamlines = count;
    bundle->points = 0;
    bundle->length_mm = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t k = tract_group_member(group, i);
        bundle->points += tractogram->first[k + 1] - tractogram->first[k];
        bundle->length_mm += tractogram_length(tractogram, k);
    }
}

/* "bundle" or "pathway": the kind of the object that has the name already; NULL = none. */
static conus_status find_taken(const char **by, conus_atlas *atlas, const char *name)
{
    conus_status status = CONUS_OK;
    while (!status && atlas->taken.count < atlas->object_count - atlas->area_count) {
        size_t i = atlas->area_count + atlas->taken.count;
        status = name_set_add(&atlas->taken, atlas->objects[i].name, i);
    }
    const struct known_name *found = status ? NULL : name_set_find(&atlas->taken, name);
    *by = !found ? NULL : atlas->places[found->value].is_bundle ? "bundle" : "pathway";
    return status;
}

/* A group whose name is taken also gets its tractogram's name. */
static conus_status settle_group_name(conus_atlas *atlas, struct tractogram *tractogram, size_t group, const char *name)
{
    struct buffer text = {0};
    char **own = &tractogram->groups[group].name;
    const char *other;
    conus_status status = find_taken(&other, atlas, *own);
    if (status || !other) {
        return status;
    }
    buffer_format(&text, "%s %s", name, *own);
    status = buffer_status(&text);
    char *longer = status ? NULL : memory_text(text.data, strlen(text.data));
    status = status || longer ? status : CONUS_ERROR_MEMORY;
    status = status ? status
                    : notes_add(&atlas->notes, "%s: group %s: the bundle is called %s, since another %s has that name",
                                tractogram->path, *own, longer, other);
    if (longer) {
        memory_free(*own);
        *own = longer;
    }
    buffer_finish(&text);
    return status;
}

/* A bundle of the tractogram that is appended next. */
static conus_status append_bundle(conus_atlas *atlas, const struct tractogram *tractogram, const char *name,
                                  size_t group)
{
    size_t last = atlas->object_count; /* bundle */
    while (last > atlas->area_count && !atlas->places[last - 1].is_bundle) {
        last--;
    }
    conus_object bundle = {.kind = CONUS_KIND_BUNDLE,
                           .label = last > atlas->area_count ? atlas->objects[last - 1].label + 1 : 1,
                           .name = name,
                           .abbreviation = "",
                           .named = true,
                           .radius = tractogram->radius};
    const struct object_place place = {.is_bundle = true, .index = atlas->tractogram_count, .group = group};
    palette_colour(bundle.rgb, FIRST_COLOUR + bundle.label);
    measure_bundle(&bundle, tractogram, group == BUNDLE_OF_ALL ? NULL : &tractogram->groups[group]);
    const char *other;
    conus_status status = find_taken(&other, atlas, name);
    if (!status && other) {
        status = fail(CONUS_ERROR_ARGUMENT, "%s: bundle %s: another %s has that name; name= gives it one of its own",
                      tractogram->path, name, other);
    }
    return status ? status : atlas_append_object(atlas, &bundle, place);
}

static conus_status append_tractogram(conus_atlas *atlas, struct tractogram *tractogram)
{
    struct tractogram *all = memory_resize(atlas->tractograms, atlas->tractogram_count + 1, sizeof *all);
    if (!all) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->tractograms = all;
    all[atlas->tractogram_count++] = *tractogram;
    *tractogram = (struct tractogram){0};
    return CONUS_OK;
}

conus_status atlas_add_tractogram(conus_atlas *atlas, struct tractogram *tractogram, const char *name)
{
    size_t before = atlas->object_count;
    size_t note_count = atlas->notes.count;
    size_t group_count = 0; /* without the rest */
    conus_status status = tractogram->is_ready ? CONUS_OK : bundles_ready(tractogram);
    status = status ? status : name_rest(&group_count, tractogram, name);
    if (!status && !tractogram->group_count) {
        status = append_bundle(atlas, tractogram, name, BUNDLE_OF_ALL);
    }
    for (size_t g = 0; g < tractogram->group_count && !status; g++) {
        status = g < group_count ? settle_group_name(atlas, tractogram, g, name) : CONUS_OK;
        status = status ? status : append_bundle(atlas, tractogram, tractogram->groups[g].name, g);
    }
    status = status ? status : append_tractogram(atlas, tractogram);
    if (status) {
        atlas_cut_objects(atlas, before);
        notes_cut(&atlas->notes, note_count);
    }
    return status;
}

void bundles_find_objects(uint32_t *objects, const conus_atlas *atlas, const struct tractogram *tractogram)
{
    for (uint32_t number = (uint32_t)atlas->object_count; number > atlas->area_count; number--) {
        const struct tractogram *own = atlas_bundle_tractogram(atlas, number);
        if (!own || own != tractogram || atlas->places[number - 1].is_hidden) {
            continue;
        }
        const struct tract_group *group = atlas_bundle_group(atlas, number);
        size_t count = tract_group_count(group, tractogram);
        for (size_t i = 0; i < count; i++) {
            objects[tract_group_member(group, i)] = number;
        }
    }
}

static conus_status move_points(struct tractogram *out, const struct tractogram *tractogram, const double matrix[16])
{
    float *points = memory_raw(tractogram->point_count, 3 * sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    out->points = points;
    for (uint64_t i = 0; i < tractogram->point_count; i++) {
        double p[3];
        tractogram_point(p, tractogram, i);
        mat4_point(p, matrix, p);
        for (int a = 0; a < 3; a++) {
            if (!(fabs(p[a]) <= TRACT_COORDINATE_LIMIT)) {
                return fail(CONUS_ERROR_DATA, "%s: a point is moved to more than %g mm from 0", tractogram->path,
                            TRACT_COORDINATE_LIMIT);
            }
            *points++ = (float)p[a];
        }
    }
    return CONUS_OK;
}

conus_status bundles_move(struct tractogram *out, const conus_atlas *atlas, const double world_from_atlas[16])
{
    size_t made = 0;
    conus_status status = CONUS_OK;
    while (made < atlas->tractogram_count && !status) {
        out[made] = (struct tractogram){.point_count = atlas->tractograms[made].point_count,
                                        .streamline_count = atlas->tractograms[made].streamline_count};
        status = move_points(&out[made], &atlas->tractograms[made], world_from_atlas);
        if (!status) {
            out[made].first = atlas->tractograms[made].first;
            status = tractogram_grow_tree(&out[made]);
            out[made].first = NULL;
        }
        made++;
    }
    for (size_t i = 0; i < made && status; i++) {
        tractogram_finish(&out[i]);
        out[i] = (struct tractogram){0};
    }
    return status;
}

void bundles_take(conus_atlas *atlas, struct tractogram *moved)
{
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        struct tractogram old = atlas->tractograms[i];
        if (moved[i].first) {
            atlas->tractograms[i] = moved[i];
            moved[i] = old;
        } else {
            struct tractogram held = atlas->tractograms[i];
            atlas->tractograms[i].points = moved[i].points;
            atlas->tractograms[i].halves = moved[i].halves;
            atlas->tractograms[i].tree = moved[i].tree;
            atlas->tractograms[i].has_borrowed_points = moved[i].has_borrowed_points;
            memcpy(atlas->tractograms[i].low, moved[i].low, sizeof atlas->tractograms[i].low);
            memcpy(atlas->tractograms[i].high, moved[i].high, sizeof atlas->tractograms[i].high);
            moved[i].points = held.points;
            moved[i].halves = held.halves;
            moved[i].tree = held.tree;
            moved[i].has_borrowed_points = held.has_borrowed_points;
        }
    }
    for (uint32_t number = (uint32_t)atlas->area_count + 1; number <= atlas->object_count; number++) {
        const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
        if (tractogram) {
            measure_bundle(&atlas->objects[number - 1], tractogram, atlas_bundle_group(atlas, number));
        }
    }
}
