/* SPDX-License-Identifier: BSD-3-Clause */
/* Hidden objects and thresholds of each atlas, and which of them is drawn: written, read and checked. */
#include "viewer/session/session_atlases.h"

#include "viewer/session/session.h"
#include "viewer/session/session_look.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

json_t *session_hidden(const struct view_atlas *on)
{
    json_t *hidden = json_array();
    for (uint32_t number = 1; number <= on->object_count; number++) {
        if (on->shown.hidden[number]) {
            json_array_append_new(hidden, json_integer(number));
        }
    }
    return hidden;
}

json_t *session_thresholds(const struct view_atlas *on)
{
    json_t *list = json_array();
    for (uint32_t number = 1; number <= on->object_count; number++) {
        const conus_volume_info *info = view_atlas_pathway(on, number);
        if (info) {
            json_array_append_new(list,
                                  json_pack("{s: s, s: f}", "pathway", conus_atlas_object(on->atlas, number)->name,
                                            "threshold", info->threshold));
        }
    }
    return list;
}

enum { PLACES = 10, OLD_PLACES = 4 };

/* Where some points are in the atlas's own space, which is what --atlas-transform says: the origin, a step along each
 * axis, and what is 40 mm from the origin. Older sessions have the first four, which tell affines apart. */
static void find_place(double out[3 * PLACES], const struct view_atlas *on)
{
    for (int i = 0; i < PLACES; i++) {
        double point[3] = {i == 1, i == 2, i == 3};
        if (i >= OLD_PLACES) {
            point[(i - OLD_PLACES) / 2] = i % 2 ? 40 : -40;
        }
        conus_atlas_own_point(out + (ptrdiff_t)3 * i, on->atlas, point);
    }
}

/* A number, or null where a deformation field says nothing. */
json_t *session_place(const struct view_atlas *on)
{
    double place[3 * PLACES];
    json_t *list = json_array();
    find_place(place, on);
    for (int i = 0; i < 3 * PLACES; i++) {
        json_array_append_new(list, isfinite(place[i]) ? json_real(place[i]) : json_null());
    }
    return list;
}

json_t *session_further(const struct viewer *viewer)
{
    json_t *list = json_array();
    bool fine = list;
    for (size_t i = 1; i < viewer->atlas_count && fine; i++) {
        const struct view_atlas *on = &viewer->atlases[i];
        fine = !json_array_append_new(list, json_pack("{s: s, s: i, s: o, s: o, s: o, s: o}", "atlas", on->path,
                                                      "objects", (int)on->object_count, "place", session_place(on),
                                                      "hidden", session_hidden(on), "thresholds",
                                                      session_thresholds(on), "look", session_look(on)));
    }
    if (!fine) {
        json_decref(list);
    }
    return fine ? list : NULL;
}

/* Fills [object_count + 1], zeroed. */
static bool read_hidden(bool *hidden, const json_t *root, size_t object_count, char why[SESSION_REASON])
{
    const json_t *list = json_object_get(root, "hidden");
    for (size_t i = 0; i < json_array_size(list); i++) {
        json_int_t number = json_integer_value(json_array_get(list, i));
        if (number < 1 || (uint64_t)number > object_count) {
            return session_refuse(why, "session: hidden: %lld, allowed is 1 to %zu", (long long)number, object_count);
        }
        hidden[number] = true;
    }
    return true;
}

static bool read_threshold(double *out, const json_t *entry, const char *wanted, const conus_volume_info *info,
                           char why[SESSION_REASON])
{
    const char *name = json_string_value(json_object_get(entry, "pathway"));
    const json_t *value = json_object_get(entry, "threshold");
    double low = fmin(info->minimum, info->threshold);
    double high = fmax(info->maximum, info->threshold);
    if (!name || strcmp(name, wanted) != 0) {
        return session_refuse(why, "session: thresholds: that of \"%s\" is needed, not of \"%s\"", wanted,
                              name ? name : "");
    }
    *out = json_number_value(value);
    return (json_is_number(value) && *out >= low && *out <= high) ||
           session_refuse(why, "session: thresholds: %s: a number from %g to %g is needed", name, low, high);
}

/* One for each pathway, in the atlas's order. Fills [object_count + 1]. */
static bool read_thresholds(double *out, const struct view_atlas *on, const json_t *list, char why[SESSION_REASON])
{
    size_t count = 0;
    for (uint32_t number = 1; number <= on->object_count; number++) {
        const conus_volume_info *info = view_atlas_pathway(on, number);
        if (info && !read_threshold(&out[number], json_array_get(list, count++),
                                    conus_atlas_object(on->atlas, number)->name, info, why)) {
            return false;
        }
    }
    return (json_is_array(list) && json_array_size(list) == count) ||
           session_refuse(why, "session: thresholds: a list of %zu, one for each pathway, is needed", count);
}

/* Whether the atlas lies where it lay. Sessions of before there were transforms do not say. */
static bool check_place(const struct view_atlas *on, const json_t *list, char why[SESSION_REASON])
{
    double place[3 * PLACES];
    size_t count = json_array_size(list);
    find_place(place, on);
    for (size_t i = 0; list && (i == 0 || i < count); i++) {
        const json_t *was = json_array_get(list, i);
        bool fits = (count == 3 * PLACES || count == 3 * OLD_PLACES) &&
                    (isfinite(place[i]) ? json_is_number(was) && fabs(json_number_value(was) - place[i]) <= 1e-6
                                        : json_is_null(was));
        if (!fits) {
            return session_refuse(why, "session: the atlas lay elsewhere: the same --atlas-transform, or "
                                       "transform in the manifest, is needed");
        }
    }
    return true;
}

/* What `entry` says of one atlas. */
static bool read_atlas(struct session_atlases *out, size_t index, const struct view_atlas *on, const json_t *entry,
                       char why[SESSION_REASON])
{
    const json_t *list = json_object_get(entry, "thresholds");
    const json_t *look = json_object_get(entry, "look");
    json_int_t objects = json_integer_value(json_object_get(entry, "objects"));
    if ((size_t)objects != on->object_count) {
        return session_refuse(why, "session: of an atlas with %lld areas and pathways, %s has %zu", (long long)objects,
                              index ? on->name : "this one", on->object_count);
    }
    if (!check_place(on, json_object_get(entry, "place"), why)) {
        return false;
    }
    out->hidden[index] = calloc(on->object_count + 1, sizeof *out->hidden[index]);
    out->thresholds[index] = list ? calloc(on->object_count + 1, sizeof *out->thresholds[index]) : NULL;
    if (!out->hidden[index] || (list && !out->thresholds[index])) {
        return session_refuse(why, "session: not enough memory");
    }
    return read_hidden(out->hidden[index], entry, on->object_count, why) &&
           (!list || read_thresholds(out->thresholds[index], on, list, why)) &&
           (!look || session_look_read(&out->looks[index], on, look, why));
}

static bool read_further(struct session_atlases *out, const struct viewer *viewer, const json_t *list,
                         char why[SESSION_REASON])
{
    bool fine = json_is_array(list) && json_array_size(list) == viewer->atlas_count - 1;
    if (!fine) {
        return session_refuse(why, "session: further_atlases: a list of %zu is needed, one for each --atlas",
                              viewer->atlas_count - 1);
    }
    for (size_t i = 1; i < viewer->atlas_count && fine; i++) {
        fine = read_atlas(out, i, &viewer->atlases[i], json_array_get(list, i - 1), why);
    }
    return fine;
}

static bool read_drawn(struct session_atlases *out, const struct viewer *viewer, const json_t *value,
                       char why[SESSION_REASON])
{
    json_int_t number = json_integer_value(value);
    bool fine = number >= 1 && (uint64_t)number <= viewer->atlas_count;
    out->drawn = fine ? (size_t)number - 1 : 0;
    return fine || session_refuse(why, "session: drawn: a number from 1 to %zu is needed", viewer->atlas_count);
}

bool session_atlases_read(struct session_atlases *out, const struct viewer *viewer, const json_t *root,
                          char why[SESSION_REASON])
{
    const json_t *further = json_object_get(root, "further_atlases");
    const json_t *drawn = json_object_get(root, "drawn");
    *out = (struct session_atlases){.hidden = calloc(viewer->atlas_count, sizeof *out->hidden),
                                    .thresholds = calloc(viewer->atlas_count, sizeof *out->thresholds),
                                    .looks = calloc(viewer->atlas_count, sizeof *out->looks),
                                    .count = viewer->atlas_count,
                                    .drawn = (size_t)(viewer->drawn - viewer->atlases)};
    if (!out->hidden || !out->thresholds || !out->looks) {
        return session_refuse(why, "session: not enough memory");
    }
    return read_atlas(out, 0, viewer->atlases, root, why) && (!further || read_further(out, viewer, further, why)) &&
           (!drawn || read_drawn(out, viewer, drawn, why));
}

void session_atlases_show(struct session_atlases *from, struct viewer *viewer)
{
    for (size_t i = 0; i < from->count; i++) {
        if (from->hidden[i]) {
            viewer_set_hidden(viewer, &viewer->atlases[i], from->hidden[i]);
            from->hidden[i] = NULL;
        }
        if (from->looks[i].object_count) {
            viewer_set_look(viewer, &viewer->atlases[i], &from->looks[i]);
        }
    }
}

void session_atlases_finish(struct session_atlases *from)
{
    for (size_t i = 0; i < from->count; i++) {
        if (from->hidden) {
            free(from->hidden[i]);
        }
        if (from->thresholds) {
            free(from->thresholds[i]);
        }
        if (from->looks) {
            look_finish(&from->looks[i]);
        }
    }
    free(from->hidden);
    free(from->thresholds);
    free(from->looks);
}
