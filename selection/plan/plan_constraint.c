/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks constraints, and finds the shapes of their structures. */
#include "selection/plan/plan.h"

#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/text.h"
#include "selection/study/study.h"

#include <string.h>

static const double MARGIN_LIMIT = 100; /* mm */

/* Names of the kinds in messages, and the members that each kind uses. */
static const struct {
    const char *name;
    bool has_structure;
    unsigned measures; /* a bit for each */
} KINDS[] = {
    [CONUS_CONSTRAINT_REACH] = {"reach", true, (1U << (CONUS_MEASURE_STREAMLINES + 1)) - 1},
    [CONUS_CONSTRAINT_AVOID] = {"avoid", true,
                                1U << CONUS_MEASURE_LENGTH | 1U << CONUS_MEASURE_SHARE | 1U << CONUS_MEASURE_PIERCED},
    [CONUS_CONSTRAINT_LENGTH] = {"length", false, 1},
    [CONUS_CONSTRAINT_LEAN] = {"lean", false, 1},
    [CONUS_CONSTRAINT_APART] = {"apart", false, 1},
    [CONUS_CONSTRAINT_FIRST] = {"first", true, 1},
    [CONUS_CONSTRAINT_ENTRY_ANGLE] = {"entry-angle", false, 1},
    [CONUS_CONSTRAINT_ARC] = {"arc-window", false, 1},
    [CONUS_CONSTRAINT_SLIDER] = {"arc-window", false, 1},
};
enum { KIND_COUNT = sizeof KINDS / sizeof KINDS[0] };

struct naming {
    const conus_atlas *atlas;
    bool *named;
    struct buffer names; /* "Thalamus_L, Putamen_L" */
};

static void name_it(struct naming *naming, uint32_t object)
{
    buffer_text(&naming->names, naming->names.size ? ", " : "");
    buffer_text(&naming->names, naming->atlas->objects[object - 1].name);
    naming->named[object] = true;
}

static conus_status name_object(void *user, struct text name)
{
    struct naming *naming = user;
    uint32_t found[2];
    if (area_find_halves(found, naming->atlas, name)) {
        name_it(naming, found[0]);
        name_it(naming, found[1]);
        return CONUS_OK;
    }
    conus_status status = object_find(&found[0], naming->atlas, name);
    if (!status) {
        name_it(naming, found[0]);
    }
    return status;
}

/* Adds the object's shape, hidden or not, unless another object had it. */
static conus_status add_part(struct plan_constraint *constraint, const conus_atlas *atlas, uint32_t object)
{
    const struct object_place *place = &atlas->places[object - 1];
    struct plan_part part = {.object = object, .mesh = atlas_stored_mesh(atlas, object)};
    if (place->is_bundle) {
        part.tractogram = &atlas->tractograms[place->index];
        part.group = atlas_bundle_group(atlas, object);
    } else if (!part.mesh) {
        part.volume = atlas_object_volume(atlas, object);
    }
    for (size_t i = 0; part.volume && i < constraint->part_count; i++) {
        if (constraint->parts[i].volume == part.volume) {
            return CONUS_OK;
        }
    }
    struct plan_part *parts = memory_resize(constraint->parts, constraint->part_count + 1, sizeof *parts);
    if (!parts) {
        return CONUS_ERROR_MEMORY;
    }
    constraint->parts = parts;
    parts[constraint->part_count++] = part;
    return CONUS_OK;
}

/* Fills in what the named objects and those below them have. */
static conus_status fill_structure(struct plan_constraint *out, const conus_atlas *atlas, const bool *named,
                                   bool with_hidden)
{
    conus_status status = CONUS_OK;
    for (uint32_t number = 1; number <= atlas->object_count && !status; number++) {
        const conus_object *object = &atlas->objects[number - 1];
        bool has_shape = object->voxels || object->triangles || object->streamlines;
        uint32_t above = number; /* an area below a named one is named, too */
        while (above && !named[above]) {
            above = atlas->objects[above - 1].parent;
        }
        if (above && has_shape && (with_hidden || !atlas->places[number - 1].is_hidden)) {
            out->has[number] = number;
            status = add_part(out, atlas, number);
        }
    }
    return status;
}

conus_status plan_structure_find(struct plan_constraint *out, const conus_atlas *atlas, const char *names,
                                 bool with_hidden)
{
    struct naming naming = {atlas, memory_zeroed(atlas->object_count + 1, sizeof *naming.named), {0}};
    out->has = memory_zeroed(atlas->object_count + 1, sizeof *out->has);
    conus_status status = naming.named && out->has ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : area_list_read(text_from(names), name_object, NULL, &naming);
    status = status ? status : fill_structure(out, atlas, naming.named, with_hidden);
    out->name = status || buffer_status(&naming.names) ? NULL : text_to_utf8(text_from(naming.names.data));
    status = status || out->name ? status : CONUS_ERROR_MEMORY;
    out->named = naming.named;
    buffer_finish(&naming.names);
    return status || out->part_count ? status
                                     : fail(CONUS_ERROR_ARGUMENT, "%.200s has no voxel, surface or streamline%s", names,
                                            with_hidden ? "" : " that is shown");
}

conus_status plan_structure_of(struct plan_constraint *out, const conus_atlas *atlas, uint32_t number)
{
    const char *name = atlas->objects[number - 1].name;
    bool *named = memory_zeroed(atlas->object_count + 1, sizeof *named);
    out->has = memory_zeroed(atlas->object_count + 1, sizeof *out->has);
    out->name = memory_text(name, strlen(name));
    conus_status status = named && out->has && out->name ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        named[number] = true;
        status = fill_structure(out, atlas, named, true);
    }
    memory_free(named);
    return status;
}

/* As what the structure is reported in a cone, which must be nothing else. */
static conus_status find_reported(struct plan_constraint *out, const conus_selector *selector)
{
    const conus_atlas *atlas = selector->atlas;
    const uint32_t *group = level_group(selector->level);
    out->reported = memory_zeroed(atlas->object_count + 1, sizeof *out->reported);
    if (!out->reported) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        if (out->has[number]) {
            out->reported[group ? group[number] : number] = true;
        }
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const conus_object *object = &atlas->objects[number - 1];
        bool has_shape = object->voxels || object->triangles || object->streamlines;
        if (group && out->reported[group[number]] && !out->has[number] && has_shape &&
            !atlas->places[number - 1].is_hidden) {
            return fail(CONUS_ERROR_ARGUMENT, "%.80s, which is not named, is reported as %.80s like others that are",
                        object->name, atlas->objects[group[number] - 1].name);
        }
    }
    return CONUS_OK;
}

static conus_status check_measure(const conus_selector *selector, const conus_constraint *asked)
{
    bool needs_layers = asked->measure > CONUS_MEASURE_SHARE;
    bool is_part = asked->measure == CONUS_MEASURE_SHARE || asked->measure == CONUS_MEASURE_PIERCED ||
                   asked->measure == CONUS_MEASURE_FRACTION || asked->measure == CONUS_MEASURE_PROBABILITY;
    if (needs_layers && selector->options.layers != CONUS_LAYERS_ALL) {
        return fail(CONUS_ERROR_ARGUMENT, "measure: it needs all layers");
    }
    bool has_contacts = asked->measure == CONUS_MEASURE_CONTACTS || asked->measure == CONUS_MEASURE_PROBABILITY;
    if (asked->contacts.count ? !has_contacts : asked->measure == CONUS_MEASURE_CONTACTS) {
        return fail(CONUS_ERROR_ARGUMENT, "contacts: %s", has_contacts ? "they are not known" : "the measure has none");
    }
    conus_status status = contacts_check(&asked->contacts);
    if (status) {
        return status;
    }
    return is_part && asked->limit > 1 ? fail(CONUS_ERROR_ARGUMENT, "%g, allowed is 0 to 1", asked->limit) : CONUS_OK;
}

/* Checks that the structure has streamlines, or lies wholly in maps of probabilities, where the constraint measures
 * these. */
static conus_status check_parts(const struct plan_constraint *constraint, conus_measure measure)
{
    bool has_streamlines = false;
    for (size_t i = 0; i < constraint->part_count; i++) {
        const struct volume *volume = constraint->parts[i].volume;
        has_streamlines = has_streamlines || constraint->parts[i].tractogram;
        if (measure == CONUS_MEASURE_PROBABILITY &&
            (!volume || !volume_has_values(volume) ||
             (volume->info.role == CONUS_ROLE_SCALAR && !(volume->info.threshold > 0 && volume->info.maximum <= 1)))) {
            return fail(CONUS_ERROR_ARGUMENT,
                        "%.200s has no probabilities, as areas and pathways of maps from 0 to 1 have",
                        constraint->name);
        }
    }
    return measure == CONUS_MEASURE_STREAMLINES && !has_streamlines
               ? fail(CONUS_ERROR_ARGUMENT, "%.200s has no streamlines, which bundles have", constraint->name)
               : CONUS_OK;
}

static bool is_finite(const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(numbers[i])) {
            return false;
        }
    }
    return true;
}

/* A window of angles of a rig. */
static conus_status check_window(const conus_constraint *asked)
{
    static const double TURN = 360;
    return !(fabs(asked->limit) <= TURN && fabs(asked->most) <= TURN && asked->most >= asked->limit &&
             asked->most - asked->limit <= TURN)
               ? fail(CONUS_ERROR_ARGUMENT,
                      "%s angle: %g to %g degrees, allowed are -360 to 360, the lower one first, up to a turn apart",
                      asked->kind == CONUS_CONSTRAINT_ARC ? "arc" : "slider", asked->limit, asked->most)
           : fabs(asked->pitch) <= TURN / 2
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "pitch: %g degrees, allowed are -180 to 180", asked->pitch);
}

static conus_status check_numbers(const conus_constraint *asked)
{
    if (asked->kind >= CONUS_CONSTRAINT_ARC) {
        return check_window(asked);
    }
    if (!isfinite(asked->limit) || asked->limit < 0) {
        return fail(CONUS_ERROR_ARGUMENT, "%g, allowed is 0 or more", asked->limit);
    }
    switch (asked->kind) {
    case CONUS_CONSTRAINT_REACH:
        if (asked->limit != 0 && (asked->measure == CONUS_MEASURE_TIP || asked->measure == CONUS_MEASURE_CROSSED)) {
            return fail(CONUS_ERROR_ARGUMENT, "%g, but the tip or a crossing has no limit", asked->limit);
        }
        if (asked->part[0] == 0 && asked->part[1] == 0) {
            return CONUS_OK;
        }
        return asked->measure == CONUS_MEASURE_LENGTH && asked->part[0] >= 0 && asked->part[1] > asked->part[0] &&
                       isfinite(asked->part[1])
                   ? CONUS_OK
                   : fail(CONUS_ERROR_ARGUMENT,
                          "part: %g to %g mm, allowed is A from 0 on and B beyond it, of a length", asked->part[0],
                          asked->part[1]);
    case CONUS_CONSTRAINT_AVOID:
        return asked->limit <= MARGIN_LIMIT
                   ? CONUS_OK
                   : fail(CONUS_ERROR_ARGUMENT, "margin: %g mm, allowed is 0 to %g", asked->limit, MARGIN_LIMIT);
    case CONUS_CONSTRAINT_LENGTH:
        return asked->most >= asked->limit
                   ? CONUS_OK
                   : fail(CONUS_ERROR_ARGUMENT, "%g to %g mm, allowed is MAX from MIN on", asked->limit, asked->most);
    case CONUS_CONSTRAINT_LEAN: {
        double unit[3];
        return asked->limit <= 180 && vec3_is_finite(asked->direction) && vec3_normalise(unit, asked->direction)
                   ? CONUS_OK
                   : fail(CONUS_ERROR_ARGUMENT, "allowed are a direction of any length but 0, and 0 to 180 degrees");
    }
    case CONUS_CONSTRAINT_ENTRY_ANGLE:
        return asked->limit <= 180 ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "allowed are 0 to 180 degrees");
    case CONUS_CONSTRAINT_APART:
        return asked->needle_count && asked->needles && is_finite(asked->needles, 6 * asked->needle_count)
                   ? CONUS_OK
                   : fail(CONUS_ERROR_ARGUMENT, "needles: at least one, with finite ends");
    default:
        return CONUS_OK;
    }
}

/* Finds the shanks that the constraint is about. What all shanks share is asked of the first. */
static conus_status find_shanks(struct plan_constraint *out, const conus_constraint *asked, size_t shank_count)
{
    bool is_same = asked->kind == CONUS_CONSTRAINT_LENGTH || asked->kind == CONUS_CONSTRAINT_LEAN ||
                   asked->kind >= CONUS_CONSTRAINT_ENTRY_ANGLE;
    if (asked->shank < CONUS_SHANK_ALL || (asked->shank > 0 && (size_t)asked->shank > shank_count)) {
        return shank_count == 1
                   ? fail(CONUS_ERROR_ARGUMENT, "shank: %d, but the device has one shank", (int)asked->shank)
                   : fail(CONUS_ERROR_ARGUMENT, "shank: %d, allowed are any, all and 1 to %zu", (int)asked->shank,
                          shank_count);
    }
    bool is_one = asked->shank > 0 && !is_same;
    out->shanks[0] = is_one ? (size_t)asked->shank - 1 : 0;
    out->shanks[1] = is_one || is_same ? out->shanks[0] + 1 : shank_count;
    out->any_shank = out->shanks[1] - out->shanks[0] > 1 &&
                     (asked->shank == CONUS_SHANK_ANY || (!asked->shank && asked->kind == CONUS_CONSTRAINT_REACH));
    return CONUS_OK;
}

static conus_status fill(struct plan_constraint *out, const conus_selector *selector, const conus_constraint *asked)
{
    if ((unsigned)asked->measure > CONUS_MEASURE_STREAMLINES || !(KINDS[asked->kind].measures >> asked->measure & 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "measure: %d is no measure of this kind of constraint", (int)asked->measure);
    }
    conus_status status = check_numbers(asked);
    status = status ? status : check_measure(selector, asked);
    if (!status && KINDS[asked->kind].has_structure) {
        status = asked->names ? plan_structure_find(out, selector->atlas, asked->names, false)
                              : fail(CONUS_ERROR_ARGUMENT, "names of its structure are missing");
    }
    if (!status && plan_is_of_cone(asked->measure)) {
        status = find_reported(out, selector);
    }
    status = status ? status : check_parts(out, asked->measure);
    out->asked = *asked;
    out->asked.names = NULL;
    out->asked.needles = NULL;
    out->has_leeway = plan_is_clearance(out) || asked->kind == CONUS_CONSTRAINT_APART;
    bool may_have = asked->kind == CONUS_CONSTRAINT_REACH &&
                    (asked->measure <= CONUS_MEASURE_CROSSED || asked->measure == CONUS_MEASURE_CONTACTS);
    for (size_t i = 0; i < out->part_count && may_have; i++) {
        const struct mesh *mesh = out->parts[i].mesh;
        out->has_leeway = out->has_leeway || !mesh || mesh->shape.closed;
    }
    if (!status && asked->kind == CONUS_CONSTRAINT_LEAN) {
        vec3_normalise(out->asked.direction, asked->direction);
    }
    if (!status && asked->kind == CONUS_CONSTRAINT_APART) {
        out->asked.needles = memory_copy(asked->needles, 6 * asked->needle_count, sizeof *asked->needles);
        status = out->asked.needles ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    return status;
}

conus_status plan_constraint_init(struct plan_constraint *out, const conus_selector *selector,
                                  const conus_constraint *asked, size_t shank_count)
{
    if ((unsigned)asked->kind >= KIND_COUNT) {
        return fail(CONUS_ERROR_ARGUMENT, "constraint: kind %d is unknown", (int)asked->kind);
    }
    conus_status status = fill(out, selector, asked);
    status = status ? status : find_shanks(out, asked, shank_count);
    return status == CONUS_ERROR_ARGUMENT ? fail_in(status, KINDS[asked->kind].name) : status;
}

void plan_constraint_finish(struct plan_constraint *constraint)
{
    memory_free(constraint->name);
    memory_free(constraint->has);
    memory_free(constraint->named);
    memory_free(constraint->reported);
    for (size_t i = 0; i < constraint->part_count; i++) {
        plan_map_destroy(constraint->parts[i].map);
    }
    memory_free(constraint->parts);
    memory_free((void *)constraint->asked.needles);
}

conus_status plan_constraint_map(struct plan_constraint *constraint, const conus_selector *selector)
{
    bool outside = constraint->asked.kind == CONUS_CONSTRAINT_REACH;
    conus_status status = CONUS_OK;
    for (size_t i = 0; constraint->has_leeway && i < constraint->part_count && !status; i++) {
        struct plan_part *part = &constraint->parts[i];
        status = part->volume ? plan_map_create(&part->map, selector->clearance_index, selector->atlas, part->volume,
                                                constraint->has, outside)
                              : CONUS_OK;
    }
    return status;
}

/* Whether all objects of `inner` are in `outer`. */
static bool is_within(const uint32_t *inner, const uint32_t *outer, const conus_atlas *atlas)
{
    for (size_t i = 1; i <= atlas->object_count; i++) {
        if (inner[i] && !outer[i]) {
            return false;
        }
    }
    return true;
}

static bool is_same(const struct plan_constraint *a, const struct plan_constraint *b, const conus_atlas *atlas)
{
    bool is_alike = a->asked.kind == b->asked.kind && a->asked.measure == b->asked.measure &&
                    a->asked.shank == b->asked.shank && a->asked.part[0] == b->asked.part[0] &&
                    a->asked.part[1] == b->asked.part[1];
    return is_alike && (a->asked.kind == CONUS_CONSTRAINT_LENGTH || a->asked.kind >= CONUS_CONSTRAINT_ENTRY_ANGLE ||
                        (a->has && is_within(a->has, b->has, atlas) && is_within(b->has, a->has, atlas)));
}

/* Whether some shank must satisfy both constraints. */
static bool share_shank(const struct plan_constraint *a, const struct plan_constraint *b)
{
    size_t first = a->shanks[0] > b->shanks[0] ? a->shanks[0] : b->shanks[0];
    size_t end = a->shanks[1] < b->shanks[1] ? a->shanks[1] : b->shanks[1];
    const struct plan_constraint *any = a->any_shank ? a : b->any_shank ? b : NULL;
    size_t needed = any ? any->shanks[1] - any->shanks[0] : 1;
    return !(a->any_shank && b->any_shank) && end >= first + needed;
}

conus_status plan_constraints_check(const struct plan_constraint *constraints, size_t count, const conus_atlas *atlas)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < count; j++) {
            const struct plan_constraint *a = &constraints[i];
            const struct plan_constraint *b = &constraints[j];
            if (i < j && is_same(a, b, atlas)) {
                return fail(CONUS_ERROR_ARGUMENT, "%s: constraints %zu and %zu are about the same",
                            KINDS[a->asked.kind].name, i + 1, j + 1);
            }
            if (a->asked.kind == CONUS_CONSTRAINT_REACH && plan_is_clearance(b) && share_shank(a, b) &&
                is_within(a->has, b->has, atlas)) {
                return fail(CONUS_ERROR_ARGUMENT, "constraint %zu avoids all that constraint %zu reaches", j + 1,
                            i + 1);
            }
        }
    }
    return CONUS_OK;
}
