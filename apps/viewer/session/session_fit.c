/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers of objects then and now: those of each file that was added belong together, and so do all others. */
#include "viewer/session/session.h"

#include "options/output.h"
#include "viewer/model/additions.h"

#include <stdlib.h>
#include <string.h>

struct numbering {
    uint32_t *now; /* [then + 1] 0 = it is gone */
    size_t then, count;
};

static const json_t *added_of(const json_t *opened)
{
    return json_object_get(opened, "added");
}

static size_t count_objects(const json_t *added)
{
    size_t count = 0;
    for (size_t i = 0; i < json_array_size(added); i++) {
        count += json_array_size(json_object_get(json_array_get(added, i), "objects"));
    }
    return count;
}

/* Marks the added objects; false if a number is none of an object. */
static bool mark(bool *is_added, size_t count, const json_t *added)
{
    for (size_t i = 0; i < json_array_size(added); i++) {
        const json_t *objects = json_object_get(json_array_get(added, i), "objects");
        for (size_t k = 0; k < json_array_size(objects); k++) {
            json_int_t number = json_integer_value(json_array_get(objects, k));
            if (number < 1 || (uint64_t)number > count) {
                return false;
            }
            is_added[number] = true;
        }
    }
    return true;
}

/* Objects that were not added keep their order; false if there are more or fewer than then: it is another atlas. */
static bool match_own(struct numbering *numbers, const json_t *then, const json_t *now)
{
    bool *was_added = calloc(numbers->then + 1, sizeof *was_added);
    bool *is_added = calloc(numbers->count + 1, sizeof *is_added);
    bool fine = was_added && is_added && mark(was_added, numbers->then, then) && mark(is_added, numbers->count, now);
    size_t next = 1;
    for (size_t number = 1; number <= numbers->then && fine; number++) {
        while (!was_added[number] && next <= numbers->count && is_added[next]) {
            next++;
        }
        fine = was_added[number] || next <= numbers->count;
        numbers->now[number] = was_added[number] || !fine ? 0 : (uint32_t)next++;
    }
    while (fine && next <= numbers->count && is_added[next]) {
        next++;
    }
    fine = fine && next > numbers->count;
    free(was_added);
    free(is_added);
    return fine;
}

/* What the session calls the object; NULL = nothing. */
static json_t *named_of(const json_t *root, json_int_t number)
{
    const json_t *named = json_object_get(root, "named");
    json_t *entry = NULL;
    for (size_t i = 0; i < json_array_size(named) && !entry; i++) {
        json_t *one = json_array_get(named, i);
        entry = json_integer_value(json_array_get(one, 0)) == number ? one : NULL;
    }
    return entry;
}

/* The number now of an object of an added file. The same bytes have it, however the file is called now; of others it is
 * gone where that number has another name. */
static uint32_t number_of_added(const json_t *root, const struct view_atlas *view, json_int_t then, json_int_t now,
                                bool is_same)
{
    json_t *entry = named_of(root, then);
    const char *name = json_string_value(json_array_get(entry, 2));
    if (is_same) {
        json_array_clear(entry);
    }
    return is_same || !name || strcmp(name, conus_atlas_object(view->atlas, (size_t)now)->name) == 0 ? (uint32_t)now
                                                                                                     : 0;
}

/* Fills the map, to be freed; false without memory, or if it is another atlas. */
static bool find_numbers(struct numbering *out, const json_t *root, const struct view_atlas *view, const json_t *then,
                         const json_t *now)
{
    size_t *match = additions_match(then, now);
    out->now = calloc(out->then + 1, sizeof *out->now);
    bool fine = match && out->now && match_own(out, then, now);
    for (size_t i = 0; i < json_array_size(then) && fine; i++) {
        if (match[i] == SIZE_MAX) {
            continue;
        }
        const json_t *from = json_object_get(json_array_get(then, i), "objects");
        const json_t *to = json_object_get(json_array_get(now, match[i]), "objects");
        const bool is_same = addition_is_same(json_array_get(then, i), json_array_get(now, match[i]));
        size_t count = json_array_size(from) == json_array_size(to) ? json_array_size(from) : 0;
        for (size_t k = 0; k < count; k++) { /* those of a file keep their order */
            json_int_t number = json_integer_value(json_array_get(from, k));
            out->now[number] = number_of_added(root, view, number, json_integer_value(json_array_get(to, k)), is_same);
        }
    }
    free(match);
    return fine;
}

/* The object's number now; 0 = it is gone, or the value is no number of an object. */
static uint32_t number_now(const struct numbering *numbers, const json_t *value)
{
    json_int_t number = json_integer_value(value);
    return number >= 1 && (uint64_t)number <= numbers->then ? numbers->now[number] : 0;
}

/* Renumbers a list of objects, or of pairs [object, value], and removes objects that are gone. */
static void fit_list(json_t *list, bool has_pairs, const struct numbering *numbers)
{
    for (size_t i = json_array_size(list); i-- > 0;) {
        json_t *entry = json_array_get(list, i);
        uint32_t number = number_now(numbers, has_pairs ? json_array_get(entry, 0) : entry);
        if (number) {
            json_array_set_new(has_pairs ? entry : list, has_pairs ? 0 : i, json_integer(number));
        } else {
            json_array_remove(list, i);
        }
    }
}

/* Renumbers pins; those in other atlases stay. A pin of an object that is gone keeps its name, or else is removed. */
static void fit_pins(json_t *list, const struct numbering *numbers)
{
    for (size_t i = json_array_size(list); i-- > 0;) {
        json_t *pin = json_array_get(list, i);
        bool has_number = json_integer_value(json_object_get(pin, "object")) != 0;
        if (json_integer_value(json_object_get(pin, "atlas")) > 1 || !has_number) {
            continue;
        }
        uint32_t number = number_now(numbers, json_object_get(pin, "object"));
        if (number || json_object_get(pin, "name")) {
            json_object_set_new(pin, "object", json_integer(number));
        } else {
            json_array_remove(list, i);
        }
    }
}

/* The last threshold of a list that is of the same pathway; NULL = none is. */
static json_t *find_threshold(const json_t *list, const json_t *entry)
{
    json_t *found = NULL;
    for (size_t i = 0; i < json_array_size(list); i++) {
        json_t *one = json_array_get(list, i);
        found = json_equal(json_object_get(one, "pathway"), json_object_get(entry, "pathway")) ? one : found;
    }
    return found;
}

/* The thresholds of the pathways now, with the session's value where it has one by that name. */
static json_t *fit_thresholds(const json_t *then, const struct view_atlas *view)
{
    json_t *now = session_thresholds(view);
    for (size_t i = 0; i < json_array_size(now); i++) {
        json_t *entry = find_threshold(then, json_array_get(now, i));
        (void)(entry && json_array_set(now, i, entry));
    }
    return now;
}

static void fit_objects(json_t *root, const struct numbering *numbers, const struct view_atlas *view)
{
    json_t *thresholds = json_object_get(root, "thresholds");
    json_t *appearance = json_object_get(root, "look");
    const json_t *chosen = json_object_get(root, "chosen");
    json_object_set_new(root, "objects", json_integer((json_int_t)numbers->count));
    fit_list(json_object_get(root, "hidden"), false, numbers);
    fit_list(json_object_get(root, "named"), true, numbers);
    if (chosen) { /* else it stays */
        json_object_set_new(root, "chosen", json_integer(number_now(numbers, chosen)));
    }
    fit_pins(json_object_get(root, "confirmed"), numbers);
    fit_list(json_object_get(appearance, "opacities"), true, numbers);
    fit_list(json_object_get(appearance, "pathways"), true, numbers);
    const char *colour = json_string_value(json_object_get(appearance, "streamline_colour"));
    if (colour && tract_colour_find(view->atlas, colour) == TRACT_COLOUR_LIMIT) { /* it went with the streamlines */
        json_object_del(appearance, "streamline_colour");
    }
    if (thresholds) {
        json_object_set_new(root, "thresholds", fit_thresholds(thresholds, view));
    }
}

/* Figures could have their legend inside the drawing. */
static void fit_legend(json_t *root)
{
    json_t *figure = json_object_get(root, "figure");
    const char *where = json_string_value(json_object_get(figure, "legend"));
    if (where && strcmp(where, "inside") == 0) {
        json_object_set_new(figure, "legend", json_string("auto"));
    }
}

static bool is_context(const json_t *entry)
{
    return word_value(json_text(entry, "option"), addition_names[ADD_CONTEXT]);
}

static size_t count_contexts(const json_t *added)
{
    size_t count = 0;
    for (size_t i = 0; i < json_array_size(added); i++) {
        count += is_context(json_array_get(added, i));
    }
    return count;
}

static bool has_other_context(const json_t *then, const json_t *now)
{
    size_t *match = additions_match(then, now);
    bool other = count_contexts(then) != count_contexts(now);
    for (size_t i = 0; i < json_array_size(then) && match; i++) {
        other = other || (is_context(json_array_get(then, i)) && match[i] == SIZE_MAX);
    }
    free(match);
    return other;
}

/* Behind --labels= among the options; "" = there is none. */
static const char *labels_of(const json_t *opened)
{
    const json_t *options = json_object_get(opened, "options");
    const char *found = "";
    for (size_t i = 0; i < json_array_size(options); i++) {
        const char *value = word_value(json_string_value(json_array_get(options, i)), "labels");
        found = value ? value : found;
    }
    return found;
}

/* Who opens a session with another label table says that its areas have other names: their labels stay to be checked.
 */
static void fit_names(json_t *root, const struct window *window)
{
    const json_t *named = json_object_get(root, "named");
    const char *labels = labels_of(window->files.opened);
    const bool is_said = *labels && strcmp(labels, labels_of(json_object_get(root, "opened"))) != 0;
    for (size_t i = 0; i < json_array_size(named) && is_said; i++) {
        json_t *entry = json_array_get(named, i);
        const json_int_t number = json_integer_value(json_array_get(entry, 0));
        const conus_object *object =
            number > 0 ? conus_atlas_object(window->viewer->atlases[0].atlas, (size_t)number) : NULL;
        if (object) {
            json_array_set_new(entry, 2, json_string(object->name));
        }
    }
}

void session_fit(json_t *root, const struct window *window)
{
    fit_names(root, window);
    const json_t *then = added_of(json_object_get(root, "opened"));
    const json_t *now = added_of(window->files.opened);
    fit_legend(root);
    const bool is_sure = !json_object_get(root, "named"); /* of a folder no sum is known */
    if (!then || !now || (json_equal(then, now) && is_sure)) {
        return;
    }
    const struct view_atlas *view = window->viewer->atlases;
    size_t added = count_objects(now);
    size_t own = added < view->object_count ? view->object_count - added : 0;
    struct numbering numbers = {.then = own + count_objects(then), .count = view->object_count};
    json_int_t objects = json_integer_value(json_object_get(root, "objects"));
    if ((uint64_t)objects == numbers.then && find_numbers(&numbers, root, view, then, now)) {
        fit_objects(root, &numbers, view);
    }
    if (has_other_context(then, now)) {
        const json_t *further = json_object_get(root, "further_atlases"); /* whose colours mean nothing here */
        json_object_del(root, "transfer");
        json_object_del(root, "preset");
        json_object_del(json_object_get(root, "look"), "grey");
        for (size_t i = 0; i < json_array_size(further); i++) {
            json_object_del(json_object_get(json_array_get(further, i), "look"), "grey");
        }
    }
    free(numbers.now);
}

/* Gives the objects of a file that is not there the next numbers. */
static void number_lost(json_t *entry, struct numbering *numbers)
{
    json_t *objects = json_object_get(entry, "objects");
    for (size_t i = json_array_size(objects); i-- > 0;) { /* other values are no numbers of objects */
        json_int_t number = json_integer_value(json_array_get(objects, i));
        if (number < 1 || (uint64_t)number > numbers->then) {
            json_array_remove(objects, i);
        }
    }
    for (size_t i = 0; i < json_array_size(objects); i++) {
        uint32_t *now = &numbers->now[json_integer_value(json_array_get(objects, i))];
        *now = (uint32_t)++numbers->count;
        json_array_set_new(objects, i, json_integer(*now));
    }
}

/* Appends what a list of the session says of the objects that have a number now. */
static void keep_list(json_t *list, const json_t *then, bool has_pairs, const struct numbering *numbers)
{
    json_t *kept = json_deep_copy(then);
    fit_list(kept, has_pairs, numbers);
    json_array_extend(list, kept);
    json_decref(kept);
}

/* Appends thresholds of pathways that are not there, which are found again by name. */
static void keep_thresholds(json_t *list, const json_t *then)
{
    json_t *there = json_copy(list);
    for (size_t i = 0; i < json_array_size(then); i++) {
        json_t *entry = json_array_get(then, i);
        (void)(find_threshold(there, entry) || json_array_append(list, entry));
    }
    json_decref(there);
}

/* Whether a file of the session is still to be found: it was not opened since, nor another context in its place. */
static bool is_still_lost(const json_t *entry, size_t match, const json_t *added)
{
    bool still = match == SIZE_MAX;
    for (size_t i = 0; i < json_array_size(added) && addition_is_volume_context(entry); i++) {
        still = still && !addition_is_volume_context(json_array_get(added, i));
    }
    return still;
}

/* Gives a look the grey values that it had in the cuts of a context that is not there, unless it has others now. */
static void keep_grey(json_t *look, const json_t *then)
{
    json_t *grey = json_object_get(then, "grey");
    if (grey && json_is_null(json_object_get(look, "grey"))) {
        json_object_set(look, "grey", grey);
    }
}

/* Likewise what a session says of that context: its colours, and the grey values of each atlas's cuts. */
static void keep_context(json_t *root, const json_t *then)
{
    static const char *const colours[] = {"transfer", "preset"};
    const json_t *further = json_object_get(root, "further_atlases");
    const json_t *further_then = json_object_get(then, "further_atlases");
    for (size_t i = 0; i < sizeof colours / sizeof colours[0]; i++) {
        json_object_set(root, colours[i], json_object_get(then, colours[i]));
    }
    keep_grey(json_object_get(root, "look"), json_object_get(then, "look"));
    for (size_t i = 0; i < json_array_size(further); i++) {
        const json_t *now = json_array_get(further, i);
        for (size_t k = 0; k < json_array_size(further_then); k++) {
            const json_t *was = json_array_get(further_then, k);
            if (strcmp(path_name(json_text(now, "atlas")), path_name(json_text(was, "atlas"))) == 0) {
                keep_grey(json_object_get(now, "look"), json_object_get(was, "look"));
            }
        }
    }
}

bool session_keep_lost(json_t *root, const struct window *window)
{
    const json_t *entries = json_object_get(window->files.lost, "entries");
    const json_t *then = json_object_get(window->files.lost, "session");
    json_t *opened = json_object_get(root, "opened");
    json_t *added = json_object_get(opened, "added");
    json_t *look = json_object_get(root, "look");
    const json_t *look_then = json_object_get(then, "look");
    size_t count = json_array_size(entries);
    json_int_t objects = json_integer_value(json_object_get(then, "objects"));
    struct numbering numbers = {.then = objects > 0 ? (size_t)objects : 0,
                                .count = (size_t)json_integer_value(json_object_get(root, "objects"))};
    if (!count || !added) {
        return true;
    }
    size_t *match = additions_match(entries, added);
    bool has_context = count_contexts(added) > 0;
    bool fine = match && (numbers.now = calloc(numbers.then + 1, sizeof *numbers.now));
    json_t *now = fine ? json_copy(added) : NULL;
    for (size_t i = 0; i < count && fine; i++) {
        const json_t *entry = json_array_get(entries, i);
        if (!is_still_lost(entry, match[i], now)) {
            continue;
        }
        json_t *kept = json_deep_copy(entry);
        number_lost(kept, &numbers);
        json_object_set_new(kept, "lost", json_true());
        fine = !json_array_append_new(added, kept) &&
               !json_array_append(json_object_get(opened, "options"), json_object_get(entry, "option"));
        if (is_context(entry) && !has_context) {
            keep_context(root, then);
        }
    }
    if (fine) {
        json_object_set_new(root, "objects", json_integer((json_int_t)numbers.count));
        keep_list(json_object_get(root, "hidden"), json_object_get(then, "hidden"), false, &numbers);
        keep_list(json_object_get(root, "named"), json_object_get(then, "named"), true, &numbers);
        uint32_t chosen = number_now(&numbers, json_object_get(then, "chosen"));
        if (chosen && json_integer_value(json_object_get(root, "chosen")) == 0) {
            json_object_set_new(root, "chosen", json_integer(chosen));
        }
        keep_list(json_object_get(look, "opacities"), json_object_get(look_then, "opacities"), true, &numbers);
        keep_list(json_object_get(look, "pathways"), json_object_get(look_then, "pathways"), true, &numbers);
        keep_thresholds(json_object_get(root, "thresholds"), json_object_get(then, "thresholds"));
    }
    json_decref(now);
    free(numbers.now);
    free(match);
    return fine;
}
