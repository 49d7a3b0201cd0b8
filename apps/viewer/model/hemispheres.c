/* SPDX-License-Identifier: BSD-3-Clause */
/* Hides the areas of a side; finds and exchanges the option --hemispheres. */
#include "viewer/model/viewer.h"

#include "settings/settings.h"
#include "viewer/model/additions.h"

#include <stdlib.h>
#include <string.h>

const char *const side_names[SIDE_COUNT] = {"both", "left", "right"};

static const char letters[SIDE_COUNT] = {0, 'L', 'R'};

/* Counts the areas of a side, or only those that are shown. */
static size_t count(const struct view_atlas *view, enum side side, bool shown_only)
{
    size_t found = 0;
    for (size_t number = 1; number <= view->object_count; number++) {
        found += view->sides[number] == letters[side] && !(shown_only && view->shown.hidden[number]);
    }
    return found;
}

static enum side find_sides(const struct view_atlas *view, bool shown_only)
{
    bool left = count(view, SIDE_LEFT, shown_only);
    bool right = count(view, SIDE_RIGHT, shown_only);
    return left && right ? SIDE_BOTH : left ? SIDE_LEFT : right ? SIDE_RIGHT : SIDE_COUNT;
}

enum side side_known(const struct viewer *viewer)
{
    return find_sides(viewer->drawn, false);
}

enum side side_shown(const struct viewer *viewer)
{
    return find_sides(viewer->drawn, true);
}

const char *const side_missing[SIDE_COUNT + 1] = {
    [SIDE_LEFT] = "no right areas", [SIDE_RIGHT] = "no left areas", [SIDE_COUNT] = "no left or right areas"};

void side_show(struct viewer *viewer, enum side side)
{
    struct view_atlas *view = viewer->drawn;
    if (side_known(viewer) != SIDE_BOTH) {
        viewer_say(viewer, "%s are known; F8 splits areas", side_missing[side_known(viewer)]);
        return;
    }
    bool *hidden = malloc((view->object_count + 1) * sizeof *hidden);
    if (!hidden) {
        viewer_say(viewer, "not enough memory");
        return;
    }
    memcpy(hidden, view->shown.hidden, (view->object_count + 1) * sizeof *hidden);
    for (enum side one = SIDE_LEFT; one <= SIDE_RIGHT; one++) {
        bool is_other = side != SIDE_BOTH && side != one;
        if (is_other || !count(view, one, true)) {
            for (size_t number = 1; number <= view->object_count; number++) {
                hidden[number] = view->sides[number] == letters[one] ? is_other : hidden[number];
            }
        }
    }
    viewer_set_hidden(viewer, view, hidden);
}

void side_show_next(struct viewer *viewer)
{
    static const char *const says[SIDE_COUNT] = {"both sides are shown", "only the left side is shown",
                                                 "only the right side is shown"};
    enum side now = side_shown(viewer);
    enum side next = now == SIDE_COUNT ? SIDE_BOTH : (enum side)((now + 1) % SIDE_COUNT);
    unsigned said = viewer->said;
    side_show(viewer, next);
    if (viewer->said == said) {
        viewer_say(viewer, "%s", says[next]);
    }
}

const char *const hemispheres_meanings[HEMISPHERES_COUNT] = {"areas as in the file", "split left and right",
                                                             "left and right as one"};

static const char option[] = "hemispheres";

static const char *value_of(const json_t *word)
{
    return word_value(json_string_value(word), option);
}

conus_hemispheres hemispheres_of_words(const json_t *words)
{
    conus_hemispheres how = CONUS_HEMISPHERES_AS_IS;
    for (size_t i = 0; i < json_array_size(words); i++) {
        const char *value = value_of(json_array_get(words, i));
        for (size_t k = 0; value && settings_hemispheres[k]; k++) {
            how = strcmp(value, settings_hemispheres[k]) == 0 ? (conus_hemispheres)k : how;
        }
    }
    return how;
}

json_t *hemispheres_put_in_words(const json_t *given, conus_hemispheres how)
{
    json_t *words = json_copy((json_t *)given);
    for (size_t i = json_array_size(words); i-- > 0;) {
        if (value_of(json_array_get(words, i))) {
            json_array_remove(words, i);
        }
    }
    if (how && json_array_append_new(words, json_sprintf("--%s=%s", option, settings_hemispheres[how]))) {
        json_decref(words);
        words = NULL;
    }
    return words;
}
