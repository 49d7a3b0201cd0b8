/* SPDX-License-Identifier: BSD-3-Clause */
/* Notes about devices inside areas and cones that miss the atlas, with the likely mistake. */
#include "settings/aim_notes.h"

#include "common/messages.h"

#include <inttypes.h>
#include <stdio.h>

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

/* Behind "; ", or "". */
static const char *put_reading(char out[256], const conus_reading *reading, const conus_atlas *atlas)
{
    out[0] = '\0';
    if (reading->object) {
        snprintf(out, 256, "; %s it would hit %s first", reading->words,
                 conus_atlas_object(atlas, reading->object)->name);
    }
    return out;
}

void aim_notes_say(const conus_astray *found, conus_selector *selector, const conus_atlas *atlas, const char *file,
                   const struct common_settings *settings)
{
    char words[256];
    conus_reading reading = {0};
    if (settings->quiet || conus_aims_reading(&reading, found, selector)) {
        return;
    }
    put_reading(words, &reading, atlas);
    if (reading.of_tiny) {
        say_tiny(found, file, words);
        return; /* in metres, all else is otherwise, too */
    }
    if (found->inside.count) {
        say_inside(found, atlas, file);
    }
    if (found->away.count) {
        say_away(found, file, words);
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
