/* SPDX-License-Identifier: BSD-3-Clause */
/* Each atlas in a session: where it lies, hidden objects, thresholds and looks; and which of them is drawn. */
#include "viewer/model/additions.h"
#include "viewer/session/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

json_t *session_hidden(const struct view_atlas *view)
{
    json_t *hidden = json_array();
    for (uint32_t number = 1; number <= view->object_count; number++) {
        if (view->shown.hidden[number]) {
            json_array_append_new(hidden, json_integer(number));
        }
    }
    return hidden;
}

json_t *session_thresholds(const struct view_atlas *view)
{
    json_t *list = json_array();
    for (uint32_t number = 1; number <= view->object_count; number++) {
        const conus_volume_info *info = view_atlas_pathway(view, number);
        if (info) {
            json_array_append_new(list,
                                  json_pack("{s: s, s: f}", "pathway", conus_atlas_object(view->atlas, number)->name,
                                            "threshold", info->threshold));
        }
    }
    return list;
}

enum { PLACES = 10, AXES_END = 4 };

/* Where some points are in the atlas's own space, which is what --atlas-transform says: the origin, a step along each
 * axis, which tell affines apart, and what is 40 mm from the origin. */
static void find_place(double out[3 * PLACES], const struct view_atlas *view)
{
    for (int i = 0; i < PLACES; i++) {
        double point[3] = {i == 1, i == 2, i == 3};
        if (i >= AXES_END) {
            point[(i - AXES_END) / 2] = i % 2 ? 40 : -40;
        }
        conus_atlas_own_point(out + (ptrdiff_t)3 * i, view->atlas, point);
    }
}

/* Coordinates are null where a deformation field says nothing. */
json_t *session_place(const struct view_atlas *view)
{
    double place[3 * PLACES];
    json_t *list = json_array();
    find_place(place, view);
    for (int i = 0; i < 3 * PLACES; i++) {
        json_array_append_new(list, isfinite(place[i]) ? json_real(place[i]) : json_null());
    }
    return list;
}

/* Grey values are floats; the mouse can make a window of them that is wider than all of them. */
static const double grey_limit = 1e30;

json_t *session_look(const struct view_atlas *view)
{
    const char *streamlines = tract_colour_name(view->atlas, view->appearance.streamlines);
    const double *window = view->appearance.grey;
    json_t *opacities = json_array();
    json_t *haze = json_array();
    for (size_t number = 1; number <= view->appearance.object_count; number++) {
        if (!isnan(view->appearance.opacity[number])) {
            json_array_append_new(opacities, json_pack("[i, f]", (int)number, view->appearance.opacity[number]));
        }
        if (view->appearance.haze[number] != HAZE_NONE) {
            json_array_append_new(haze, json_pack("[i, s]", (int)number, haze_name(view->appearance.haze[number])));
        }
    }
    json_t *grey = window[0] != 0 || window[1] != 0 ? json_pack("[f, f]", window[0], window[1]) : json_null();
    json_t *appearance = json_pack("{s: o, s: o, s: f, s: o}", "grey", grey, "opacities", opacities,
                                   "opacity_of_the_rest", view->appearance.opacity[0], "pathways", haze);
    if (appearance && streamlines) {
        json_object_set_new(appearance, "streamline_colour", json_string(streamlines));
    }
    return appearance;
}

/* A pathway's or bundle's ordinal changes with the files beside it. */
static json_int_t label_of(const conus_object *object)
{
    return object->kind == CONUS_KIND_AREA ? (json_int_t)object->label : 0;
}

json_t *session_named(const struct viewer *viewer, size_t atlas)
{
    const struct view_atlas *view = &viewer->atlases[atlas];
    json_t *named = json_array();
    for (uint32_t number = 1; number <= view->object_count; number++) {
        const conus_object *object = conus_atlas_object(view->atlas, number);
        bool is = view->shown.hidden[number] || view->shown.chosen == number ||
                  !isnan(view->appearance.opacity[number]) || view->appearance.haze[number] != HAZE_NONE;
        for (size_t i = 0; i < viewer->pin_count; i++) {
            is = is || (viewer->pins[i].atlas == atlas && viewer->pins[i].object == number);
        }
        if (is) { /* a name that is not UTF-8 is left out */
            json_array_append_new(named, json_pack("[i, I, s]", (int)number, label_of(object), object->name));
        }
    }
    return named;
}

json_t *session_further(const struct viewer *viewer)
{
    json_t *list = json_array();
    bool fine = list;
    for (size_t i = 1; i < viewer->atlas_count && fine; i++) {
        const struct view_atlas *view = &viewer->atlases[i];
        fine = !json_array_append_new(list, json_pack("{s: s, s: i, s: o, s: o, s: i, s: o, s: o, s: o}", "atlas",
                                                      view->path, "objects", (int)view->object_count, "place",
                                                      session_place(view), "hidden", session_hidden(view), "chosen",
                                                      (int)view->shown.chosen, "thresholds", session_thresholds(view),
                                                      "look", session_look(view), "named", session_named(viewer, i)));
    }
    return words_or_none(list, fine);
}

static bool read_threshold(double *out, const json_t *entry, const char *wanted, const conus_volume_info *info,
                           char why[PROPERTY_REASON])
{
    const char *name = json_string_value(json_object_get(entry, "pathway"));
    const json_t *value = json_object_get(entry, "threshold");
    double low = fmin(info->minimum, info->threshold);
    double high = fmax(info->maximum, info->threshold);
    if (!name || strcmp(name, wanted) != 0) {
        return session_refuse(why, "thresholds: that of \"%s\" is needed, not of \"%s\"", wanted, name ? name : "");
    }
    *out = json_number_value(value);
    return (json_is_number(value) && *out >= low && *out <= high) ||
           session_refuse(why, "thresholds: %s: a number from %g to %g is needed", name, low, high);
}

/* Reads a threshold for each pathway, in the atlas's order. Fills [object_count + 1]. */
static bool read_thresholds(double *out, const struct view_atlas *view, const json_t *list, char why[PROPERTY_REASON])
{
    size_t count = 0;
    for (uint32_t number = 1; number <= view->object_count; number++) {
        const conus_volume_info *info = view_atlas_pathway(view, number);
        if (info && !read_threshold(&out[number], json_array_get(list, count++),
                                    conus_atlas_object(view->atlas, number)->name, info, why)) {
            return false;
        }
    }
    return (json_is_array(list) && json_array_size(list) == count) ||
           session_refuse(why, "thresholds: a list of %zu, one for each pathway, is needed", count);
}

/* Checks that the atlas lies where it lay. */
static bool check_place(const struct view_atlas *view, const json_t *list, char why[PROPERTY_REASON])
{
    double place[3 * PLACES];
    bool fits = json_array_size(list) == 3 * PLACES;
    find_place(place, view);
    for (size_t i = 0; fits && i < 3 * PLACES; i++) {
        const json_t *was = json_array_get(list, i);
        fits = isfinite(place[i]) ? json_is_number(was) && fabs(json_number_value(was) - place[i]) <= 1e-6
                                  : json_is_null(was);
    }
    return fits || session_refuse(why, "the atlas lay elsewhere: the same --atlas-transform, or transform in the "
                                       "manifest, is needed");
}

/* Checks that the numbers mean what they meant. */
static bool check_names(const struct view_atlas *view, const json_t *named, char why[PROPERTY_REASON])
{
    static const char other[] = "the file, or its label table, is another one";
    for (size_t i = 0; i < json_array_size(named); i++) {
        const json_t *entry = json_array_get(named, i);
        const json_int_t number = json_integer_value(json_array_get(entry, 0));
        const json_int_t label = json_integer_value(json_array_get(entry, 1));
        const char *name = json_string_value(json_array_get(entry, 2));
        const conus_object *object = number > 0 ? conus_atlas_object(view->atlas, (size_t)number) : NULL;
        if (!name || !object) {
            return session_refuse(why, "named: an object's number, its label and its name are needed");
        }
        if (strcmp(object->name, name) != 0) {
            return session_refuse(why, "number %d was \"%.80s\", here it is \"%.80s\": %s", (int)number, name,
                                  object->name, other);
        }
        if (label != label_of(object)) {
            return session_refuse(
                why, "\"%.80s\" had label %" JSON_INTEGER_FORMAT ", here it has %" JSON_INTEGER_FORMAT ": %s", name,
                label, label_of(object), other);
        }
    }
    return true;
}

static bool read_grey(struct appearance *out, const json_t *value, char why[PROPERTY_REASON])
{
    if (!value || json_is_null(value)) {
        return true;
    }
    double *grey = out->grey;
    bool fine = !json_unpack((json_t *)value, "[FF!]", &grey[0], &grey[1]) && grey[0] >= -grey_limit &&
                grey[1] <= grey_limit && grey[0] < grey[1];
    return fine || session_refuse(why, "grey: two numbers are needed, black less than white, or null");
}

/* An object's number in an entry of a list; 0 = none that is allowed. */
static size_t number_of(const json_t *entry, const struct appearance *appearance)
{
    json_int_t number = json_integer_value(json_array_get(entry, 0));
    bool fine = json_array_size(entry) == 2 && number >= 1 && (uint64_t)number <= appearance->object_count;
    return fine ? (size_t)number : 0;
}

static bool read_opacities(struct appearance *out, const json_t *list, char why[PROPERTY_REASON])
{
    bool fine = !list || json_is_array(list);
    for (size_t i = 0; fine && i < json_array_size(list); i++) {
        const json_t *entry = json_array_get(list, i);
        const json_t *opacity = json_array_get(entry, 1);
        size_t number = number_of(entry, out);
        fine = number && json_is_number(opacity) && json_number_value(opacity) >= 0 && json_number_value(opacity) <= 1;
        out->opacity[fine ? number : 0] = json_number_value(opacity);
    }
    return fine || session_refuse(why,
                                  "opacities: a list of pairs is needed, each a number from 1 to %zu and an "
                                  "opacity from 0 to 1",
                                  out->object_count);
}

static bool read_haze(struct appearance *out, const struct view_atlas *view, const json_t *list,
                      char why[PROPERTY_REASON])
{
    bool fine = !list || json_is_array(list);
    for (size_t i = 0; fine && i < json_array_size(list); i++) {
        const json_t *entry = json_array_get(list, i);
        const char *name = json_string_value(json_array_get(entry, 1));
        size_t number = number_of(entry, out);
        size_t haze = name ? haze_find(name) : HAZE_LIMIT;
        fine = number && haze < HAZE_LIMIT && conus_atlas_object(view->atlas, number)->kind == CONUS_KIND_PATHWAY;
        out->haze[fine ? number : 0] = (uint8_t)(fine ? haze : HAZE_NONE);
    }
    return fine || session_refuse(why, "pathways: a list of pairs is needed, each a pathway's number and "
                                       "\"solid\", \"own\" or the name of a preset");
}

static bool read_streamlines(struct appearance *out, const struct view_atlas *view, const json_t *value,
                             char why[PROPERTY_REASON])
{
    const char *name = json_string_value(value);
    size_t colour = name ? tract_colour_find(view->atlas, name) : TRACT_COLOUR_LIMIT;
    if (!value) {
        return true;
    }
    if (colour == TRACT_COLOUR_LIMIT) {
        return session_refuse(why, "streamline_colour: \"bundle\", \"direction\" or the name of a number that the "
                                   "streamlines have is needed");
    }
    appearance_colour_streamlines(out, view->atlas, colour);
    return true;
}

static bool read_look(struct appearance *out, const struct view_atlas *view, const json_t *entry,
                      char why[PROPERTY_REASON])
{
    struct appearance appearance;
    if (!appearance_init(&appearance, view->object_count)) {
        return session_refuse(why, "not enough memory");
    }
    const json_t *rest = json_object_get(entry, "opacity_of_the_rest");
    bool fine = (json_is_object(entry) || session_refuse(why, "look: an object is needed")) &&
                read_grey(&appearance, json_object_get(entry, "grey"), why) &&
                read_opacities(&appearance, json_object_get(entry, "opacities"), why) &&
                ((!rest || (json_number_value(rest) > 0 && json_number_value(rest) <= 1)) ||
                 session_refuse(why, "opacity_of_the_rest: a number above 0 and up to 1 is needed")) &&
                read_haze(&appearance, view, json_object_get(entry, "pathways"), why) &&
                read_streamlines(&appearance, view, json_object_get(entry, "streamline_colour"), why);
    if (fine) {
        appearance.opacity[0] = rest ? json_number_value(rest) : 1;
        *out = appearance;
    } else {
        appearance_finish(&appearance);
    }
    return fine;
}

/* Reads the entry of one atlas. */
static bool read_atlas(struct session_atlases *out, size_t index, const struct view_atlas *view, const json_t *entry,
                       char why[PROPERTY_REASON])
{
    const json_t *list = json_object_get(entry, "thresholds");
    const json_t *appearance = json_object_get(entry, "look");
    json_int_t objects = json_integer_value(json_object_get(entry, "objects"));
    if ((size_t)objects != view->object_count) {
        return session_refuse(why, "of an atlas with %lld areas and pathways, %s has %zu", (long long)objects,
                              index ? view->name : "this one", view->object_count);
    }
    if (!check_place(view, json_object_get(entry, "place"), why) ||
        !check_names(view, json_object_get(entry, "named"), why)) {
        return false;
    }
    struct session_atlas *atlas = &out->atlases[index];
    atlas->hidden = calloc(view->object_count + 1, sizeof *atlas->hidden);
    out->thresholds[index] = list ? calloc(view->object_count + 1, sizeof *out->thresholds[index]) : NULL;
    if (!atlas->hidden || (list && !out->thresholds[index])) {
        return session_refuse(why, "not enough memory");
    }
    const json_t *chosen = json_object_get(entry, "chosen");
    json_int_t number = chosen ? json_integer_value(chosen) : view->shown.chosen;
    if ((chosen && !json_is_integer(chosen)) || number < 0 || (uint64_t)number > view->object_count) {
        return session_refuse(why, "chosen: 0 or the number of an area, 1 to %zu, is needed", view->object_count);
    }
    atlas->chosen = (uint32_t)number;
    const json_t *hidden = json_object_get(entry, "hidden");
    for (size_t i = 0; i < json_array_size(hidden); i++) {
        number = json_integer_value(json_array_get(hidden, i));
        if (number < 1 || (uint64_t)number > view->object_count) {
            return session_refuse(why, "hidden: %lld, allowed is 1 to %zu", (long long)number, view->object_count);
        }
        atlas->hidden[number] = true;
    }
    return (!list || read_thresholds(out->thresholds[index], view, list, why)) &&
           (!appearance || read_look(&atlas->look, view, appearance, why));
}

static bool read_further(struct session_atlases *out, const struct viewer *viewer, const json_t *list,
                         char why[PROPERTY_REASON])
{
    bool fine = json_is_array(list) && json_array_size(list) == viewer->atlas_count - 1;
    if (!fine) {
        return session_refuse(why, "further_atlases: a list of %zu is needed, one for each --atlas",
                              viewer->atlas_count - 1);
    }
    for (size_t i = 1; i < viewer->atlas_count && fine; i++) {
        fine = read_atlas(out, i, &viewer->atlases[i], json_array_get(list, i - 1), why);
    }
    return fine;
}

bool session_atlases_read(struct session_atlases *out, const struct viewer *viewer, const json_t *root,
                          char why[PROPERTY_REASON])
{
    const json_t *further = json_object_get(root, "further_atlases");
    const json_t *drawn = json_object_get(root, "drawn");
    *out = (struct session_atlases){.atlases = calloc(viewer->atlas_count, sizeof *out->atlases),
                                    .thresholds = calloc(viewer->atlas_count, sizeof *out->thresholds),
                                    .count = viewer->atlas_count,
                                    .drawn = (size_t)(viewer->drawn - viewer->atlases)};
    if (!out->atlases || !out->thresholds) {
        return session_refuse(why, "not enough memory");
    }
    if (!read_atlas(out, 0, viewer->atlases, root, why) || (further && !read_further(out, viewer, further, why))) {
        return false;
    }
    if (!drawn) {
        return true;
    }
    json_int_t number = json_integer_value(drawn);
    bool fine = number >= 1 && (uint64_t)number <= viewer->atlas_count;
    out->drawn = fine ? (size_t)number - 1 : 0;
    return fine || session_refuse(why, "drawn: a number from 1 to %zu is needed", viewer->atlas_count);
}

void session_atlases_show(struct session_atlases *from, struct viewer *viewer)
{
    for (size_t i = 0; i < from->count; i++) {
        struct session_atlas *atlas = &from->atlases[i];
        if (atlas->hidden) {
            viewer_set_hidden(viewer, &viewer->atlases[i], atlas->hidden);
            atlas->hidden = NULL;
            viewer->atlases[i].shown.chosen = atlas->chosen;
        }
        if (atlas->look.object_count) {
            viewer_set_look(viewer, &viewer->atlases[i], &atlas->look);
        }
    }
}

void session_atlases_finish(struct session_atlases *from)
{
    for (size_t i = 0; i < from->count && from->atlases && from->thresholds; i++) {
        free(from->atlases[i].hidden);
        free(from->thresholds[i]);
        appearance_finish(&from->atlases[i].look);
    }
    free(from->atlases);
    free(from->thresholds);
}
