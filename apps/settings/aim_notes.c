/* SPDX-License-Identifier: BSD-3-Clause */
/* Notes about devices inside areas and cones that miss the atlas, with the likely mistake. */
#include "settings/aim_notes.h"

#include "common/messages.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/* In what other way a pose may have been meant. */
struct reading {
    double place, axes; /* Factors of x and y of the position, and of the axes. */
    double scale;       /* Of the position. */
    bool reversed;      /* It looks the other way. */
    const char *words;
};

static const struct reading readings[] = {
    {.place = -1, .axes = -1, .scale = 1, .words = "with x and y negated (LPS for RAS)"},
    {.place = 1, .axes = 1, .scale = 1, .reversed = true, .words = "looking the other way"},
    {.place = -1, .axes = 1, .scale = 1, .words = "with x and y of its position negated (LPS for RAS)"},
    {.place = 1, .axes = 1, .scale = 1000, .words = "with its position times 1000 (metres for mm)"},
    {.place = -1, .axes = -1, .scale = 1000, .words = "with x and y negated (LPS for RAS) and times 1000 (metres)"},
    {.place = 1, .axes = 1, .scale = 0.001, .words = "with its position divided by 1000 (micrometres for mm)"},
    {.place = -1, .axes = -1, .scale = 0.001, .words = "with x and y negated (LPS for RAS) and divided by 1000"},
};

enum { READINGS = sizeof readings / sizeof readings[0] };

/* Metres of a device beside a head are below 1, micrometres above this. */
static const double micrometres = 5000;

/* Whether the pose's numbers may have been of that unit. */
static bool is_likely(const conus_pose *pose, double scale, bool tiny)
{
    double largest = 0;
    for (int axis = 0; axis < 3; axis++) {
        largest = fmax(largest, fabs(pose->world_from_device[12 + axis]));
    }
    return scale == 1 ? !tiny : scale > 1 ? tiny : largest > micrometres;
}

static conus_pose read_as(const conus_pose *pose, const struct reading *reading)
{
    conus_pose out = *pose;
    double *m = out.world_from_device;
    for (int column = 0; column < 3; column++) {
        double back = reading->reversed && column != 1 ? -1 : 1; /* half a turn about the device's y */
        m[4 * column] *= reading->axes * back;
        m[4 * column + 1] *= reading->axes * back;
        m[4 * column + 2] *= back;
    }
    m[12] *= reading->place * reading->scale;
    m[13] *= reading->place * reading->scale;
    m[14] *= reading->scale;
    return out;
}

/* What the pose hits first, from outside of it; NULL = nothing. */
static const char *first_hit(const conus_pose *pose, double angle, conus_selector *selector, const conus_atlas *atlas)
{
    conus_selection *selection = NULL;
    if (conus_select(&selection, selector, pose, angle)) {
        return NULL;
    }
    const conus_result *first = conus_selection_result(selection, 0);
    const conus_object *object =
        first && first->pixels && first->distance > 0 ? conus_atlas_object(atlas, first->object) : NULL;
    conus_selection_destroy(selection);
    return object ? object->name : NULL;
}

/* The first reading by which it hits something, behind "; "; "" if there is none. */
static const char *remedy(char out[256], const conus_oddity *oddity, bool tiny, conus_selector *selector,
                          const conus_atlas *atlas)
{
    out[0] = '\0';
    for (int i = 0; i < READINGS && !out[0]; i++) {
        const conus_pose pose = read_as(&oddity->pose, &readings[i]);
        bool likely = is_likely(&oddity->pose, readings[i].scale, tiny);
        const char *name = likely ? first_hit(&pose, oddity->angle, selector, atlas) : NULL;
        if (name) {
            snprintf(out, 256, "; %s it would hit %s first", readings[i].words, name);
        }
    }
    return out;
}

static void say_inside(const conus_astray *found, const conus_atlas *atlas, const char *file)
{
    const conus_oddity *inside = &found->inside;
    const char *name = conus_atlas_object(atlas, inside->object)->name;
    if (file) {
        print_error_line("note: %s: %" PRIu64 " of %" PRIu64 " devices lie inside an area, the first in line %" PRIu64
                         ", inside %s",
                         file, inside->count, found->poses, inside->first, name);
    } else {
        print_error_line("note: the device lies inside %s", name);
    }
}

static void say_away(const conus_astray *found, const char *file, const char *remedy)
{
    const conus_oddity *away = &found->away;
    const char *what = away->angle > 0 ? "cone" : "cylinder";
    if (file) {
        print_error_line("note: %s: %" PRIu64 " of %" PRIu64
                         " %ss point away from the atlas, the first in line %" PRIu64 "%s",
                         file, away->count, found->poses, what, away->first, remedy);
    } else {
        print_error_line("note: the %s points away from the atlas%s", what, remedy);
    }
}

static void say_tiny(const conus_astray *found, const char *file, const char *remedy)
{
    if (file) {
        print_error_line("note: %s: %" PRIu64 " of %" PRIu64
                         " devices lie within 1 mm of the world's origin, the first in line %" PRIu64 "%s",
                         file, found->tiny.count, found->poses, found->tiny.first, remedy);
    } else {
        print_error_line("note: the device lies within 1 mm of the world's origin%s", remedy);
    }
}

void aim_notes_say(const conus_astray *found, conus_selector *selector, const conus_atlas *atlas, const char *file,
                   const struct common_settings *settings)
{
    char words[256] = "";
    if (settings->quiet) {
        return;
    }
    if (found->tiny.count && *remedy(words, &found->tiny, true, selector, atlas)) {
        say_tiny(found, file, words);
        return; /* in metres, all else is otherwise, too */
    }
    if (found->inside.count) {
        say_inside(found, atlas, file);
    }
    if (found->away.count) {
        say_away(found, file, remedy(words, &found->away, false, selector, atlas));
    }
}

void aim_notes_of(const conus_pose *pose, double angle, conus_selector *selector, const conus_atlas *atlas,
                  const struct common_settings *settings)
{
    conus_aims *aims = NULL;
    if (settings->quiet || conus_aims_create(&aims, selector)) {
        return;
    }
    conus_aims_add(aims, 1, pose, angle);
    aim_notes_say(conus_aims_found(aims), selector, atlas, NULL, settings);
    conus_aims_destroy(aims);
}
