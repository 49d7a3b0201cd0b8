/* SPDX-License-Identifier: BSD-3-Clause */
/* Prints what a careful user should know about atlases, and about where cones lie and point. */
#include "settings/settings.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"

#include <inttypes.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LISTED = 8, LIST_SIZE = 512, SLOW_MS = 1000 };

/* Ends a note about a pathway whose threshold it names. */
static const char threshold_mark[] = "; threshold ";

/* The part of a note behind "pathway NAME: "; NULL if the note is about something else. */
static const char *said_of_pathway(const conus_atlas *atlas, const char *note)
{
    static const char start[] = "pathway ";
    for (size_t k = 1; strncmp(note, start, strlen(start)) == 0 && k <= conus_atlas_object_count(atlas); k++) {
        const conus_object *object = conus_atlas_object(atlas, k);
        const char *behind = note + strlen(start);
        size_t length = strlen(object->name);
        if (object->kind == CONUS_KIND_PATHWAY && strncmp(behind, object->name, length) == 0 &&
            strncmp(behind + length, ": ", 2) == 0) {
            return behind + length + 2;
        }
    }
    return NULL;
}

/* The threshold that it ends with, or its end. */
static const char *threshold_in(const char *words)
{
    const char *mark = strstr(words, threshold_mark);
    return mark ? mark + strlen(threshold_mark) : words + strlen(words);
}

/* Whether both notes are equal apart from their thresholds. */
static bool is_same(const char *a, const char *b)
{
    size_t length = (size_t)(threshold_in(a) - a);
    return length == (size_t)(threshold_in(b) - b) && strncmp(a, b, length) == 0;
}

/* How many of the notes before `end` say the same as words[i], with its threshold if `exactly`. */
static size_t count_same(const char *const *words, size_t end, size_t i, bool exactly)
{
    size_t count = 0;
    for (size_t k = 0; k < end; k++) {
        count += words[k] && (exactly ? strcmp(words[k], words[i]) == 0 : is_same(words[k], words[i]));
    }
    return count;
}

/* One note for all that say the same as the first of them, words[i]. */
static void say_shared(const char *of, const char *const *words, size_t count, size_t i, conus_severity severity,
                       bool quiet)
{
    char list[LIST_SIZE] = "";
    size_t size = 0;
    size_t values = 0;
    for (size_t k = i; k < count; k++) {
        if (words[k] && is_same(words[k], words[i]) && !count_same(words, k, k, true) && values++ < LISTED) {
            int more = snprintf(list + size, sizeof list - size, "%s%s", size ? ", " : "", threshold_in(words[k]));
            size = more > 0 && size + (size_t)more < sizeof list ? size + (size_t)more : size;
        }
    }
    int common = (int)(threshold_in(words[i]) - words[i]);
    size_t pathways = count_same(words, count, i, false);
    if (values == 1) {
        say_note(severity, quiet, "%s%zu pathways: %s", of, pathways, words[i]);
    } else if (values <= LISTED) {
        say_note(severity, quiet, "%s%zu pathways: %.*ss %s", of, pathways, common - 1, words[i], list);
    } else {
        say_note(severity, quiet, "%s%zu pathways: %.*ss %s and %zu more (conus info says which)", of, pathways,
                 common - 1, words[i], list, values - LISTED);
    }
}

/* `of` begins each note: "NAME: ", or nothing. */
static void say_notes(const conus_atlas *atlas, const char *of, bool quiet)
{
    size_t count = conus_atlas_note_count(atlas);
    const char **words = calloc(count + 1, sizeof *words); /* without memory each is said by itself */
    for (size_t i = 0; words && i < count; i++) {
        words[i] = said_of_pathway(atlas, conus_atlas_note(atlas, i));
    }
    for (size_t i = 0; i < count; i++) {
        if (!words || !words[i] || count_same(words, count, i, false) == 1) {
            say_note(conus_atlas_note_severity(atlas, i), quiet, "%s%s", of, conus_atlas_note(atlas, i));
        } else if (!count_same(words, i, i, false)) {
            say_shared(of, words, count, i, conus_atlas_note_severity(atlas, i), quiet);
        }
    }
    free((void *)words);
}

void atlas_notes_say(const conus_atlas *atlas, const struct common_settings *settings)
{
    say_notes(atlas, "", settings->quiet);
}

/* Tells a person who waited for files how to wait no more. */
static void say_slow(const struct atlases *atlases, bool quiet)
{
    const char *slow = NULL;
    for (size_t i = 0; i < atlases->count && !slow; i++) {
        slow = conus_atlas_pack_info(atlases->items[i].atlas) ? NULL : atlases->items[i].given;
    }
    if (slow && !quiet && atlases->opening_ms > SLOW_MS && system_is_terminal(STDERR_FILENO)) {
        print_error_line("note: opening took %.1f s; conus pack %s ... -o NAME.conus makes a file that opens at once",
                         atlases->opening_ms / 1e3, slow); /* which is not about any answer */
    }
}

void atlases_say_notes(const struct atlases *atlases, const struct common_settings *settings)
{
    for (size_t i = 0; i < atlases->count; i++) {
        char of[ATLAS_PREFIX_SIZE];
        say_notes(atlases->items[i].atlas, atlases_prefix(of, &atlases->items[i]), settings->quiet);
    }
    say_slow(atlases, settings->quiet);
}

/* A surface that is not closed has no volume, nor has one whose parts overlap or face different ways. */
static void say_open(const conus_atlas *atlas, const char *of)
{
    size_t surfaces = 0;
    size_t open = 0;
    size_t odd = 0;
    for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        surfaces += object->triangles > 0;
        open += object->triangles > 0 && !object->closed;
        odd += object->closed && object->volume_mm3 == 0;
    }
    say_note(CONUS_SEVERITY_NOTE, !odd,
             "%s%zu of %zu surfaces overlap themselves, or have parts that face inwards and are no cavities: "
             "there is no fraction",
             of, odd, surfaces);
    say_note(CONUS_SEVERITY_NOTE, !open,
             "%s%zu of %zu surfaces are not closed: paths count only where a ray goes in and comes out, and "
             "there is no fraction",
             of, open, surfaces);
}

void atlases_say_open(const struct atlases *atlases, const struct engine_settings *engine,
                      const struct common_settings *settings)
{
    bool said = engine->layers == CONUS_LAYERS_ALL && !settings->quiet;
    for (size_t i = 0; i < atlases->count && said; i++) {
        char of[ATLAS_PREFIX_SIZE];
        say_open(atlases->items[i].atlas, atlases_prefix(of, &atlases->items[i]));
    }
}

enum { LINE_SIZE = 1024, LINE_LIMIT = 4 };

/* Notes about the poses, for one atlas. */
struct lines {
    char at[LINE_LIMIT][LINE_SIZE];
    conus_severity severity[LINE_LIMIT];
    size_t count;
};

/* Says that so many of `all` in a file are `many`, and the first of them, or without a file what the one is. What holds
 * for more than half of them is no slip of some, and may warn. */
static void add_line(struct lines *lines, const char *file, const conus_pose_finding *odd, uint64_t all, bool may_warn,
                     const char *many, const char *one, const char *behind)
{
    char *line = lines->at[lines->count];
    lines->severity[lines->count++] = may_warn && 2 * odd->count > all ? CONUS_SEVERITY_WARNING : CONUS_SEVERITY_NOTE;
    if (file) {
        snprintf(line, LINE_SIZE, "%s: %" PRIu64 " of %" PRIu64 " %s, the first in line %" PRIu64 "%s", file,
                 odd->count, all, many, odd->first, behind);
    } else {
        snprintf(line, LINE_SIZE, "%s%s", one, behind);
    }
}

static void add_away(struct lines *out, const struct aimed *aimed, const char *file, const char *remedy)
{
    static const char *const words[][2] = {
        {"cylinders point away from the atlas", "the cylinder points away from the atlas"},
        {"cones point away from the atlas", "the cone points away from the atlas"},
        {"probes pass nothing of the atlas", "the probe passes nothing of the atlas"}};
    const conus_pose_finding *away = &aimed->found.away;
    const size_t i = aimed->is_of_probes ? 2 : away->angle > 0;
    add_line(out, file, away, aimed->found.poses, true, words[i][0], words[i][1], remedy);
}

/* Some points may well lie outside, as contacts beside a brain do: only more than a fifth is odd. */
static void add_apart(struct lines *out, const struct aimed *aimed, const char *file)
{
    static const char ask[] = "; are they in its space?";
    const conus_pose_findings *found = &aimed->found;
    if (file && 2 * found->far.count > found->points) {
        add_line(out, file, &found->far, found->points, true,
                 "points lie farther from the atlas than a quarter of its length", "", ask);
    } else if (file && 5 * found->apart.count > found->points) {
        add_line(out, file, &found->apart, found->points, false,
                 aimed->radius > 0 ? "points lie more than the radius outside of the atlas"
                                   : "points lie more than a quarter of its longest edge outside of the atlas",
                 "", ask);
    }
}

/* The same cone with DV counted downward, as some stereotaxic frames do; the object that it would hit, 0 = none. */
static uint32_t hit_with_dv_down(const struct aimed *aimed)
{
    const double *m = aimed->found.away.pose.world_from_device;
    double from[3] = {m[12], m[13], m[14]};
    double along[3] = {-m[8], -m[9], -m[10]};
    conus_pose pose;
    conus_selection *selection = NULL;
    conus_frame_from_world(from, aimed->frame, from);
    conus_frame_direction_from_world(along, aimed->frame, along);
    from[2] = 0 - from[2];
    along[2] = 0 - along[2];
    conus_frame_direction_to_world(along, aimed->frame, along);
    uint32_t object = 0;
    if (!conus_frame_to_world(from, aimed->frame, from) && !conus_pose_along(&pose, from, along, NULL) &&
        !conus_select(&selection, aimed->selector, &pose, aimed->found.away.angle)) {
        object = conus_selection_result(selection, 0)->object;
    }
    conus_selection_destroy(selection);
    return object;
}

static void find_lines(struct lines *out, const struct aimed *aimed, const char *file)
{
    char words[256] = "";
    add_apart(out, aimed, file);
    if (aimed->frame->space >= CONUS_SPACE_CCF) { /* the readings are others than in people's spaces */
        bool is_bregma = aimed->frame->space == CONUS_SPACE_BREGMA;
        uint32_t object = is_bregma && aimed->found.away.count ? hit_with_dv_down(aimed) : 0;
        if (object) {
            snprintf(words, sizeof words, "; with DV counted downward it would hit %s first",
                     conus_atlas_object(aimed->atlas, object)->name);
        }
    } else {
        conus_pose_suggestion reading = {0};
        if (conus_pose_check_suggest(&reading, &aimed->found, aimed->selector)) {
            return;
        }
        if (reading.object) {
            snprintf(words, sizeof words, "; %s%s it would hit %s first", reading.words,
                     file && reading.is_reversed ? " (--axis, or the signs of dx dy dz)" : "",
                     conus_atlas_object(aimed->atlas, reading.object)->name);
        }
        if (reading.of_tiny) {
            add_line(out, file, &aimed->found.tiny, aimed->found.poses, true,
                     "devices lie within 1 mm of the world's origin",
                     "the device lies within 1 mm of the world's origin", words);
            return; /* in metres, all else is otherwise, too */
        }
    }
    const conus_pose_finding *inside = &aimed->found.inside;
    if (inside->count) {
        char where[LINE_SIZE];
        snprintf(where, sizeof where, "%s inside %s", file ? "," : "",
                 conus_atlas_object(aimed->atlas, inside->object)->name);
        add_line(out, file, inside, aimed->found.poses, false, "devices lie inside an area", "the device lies", where);
    }
    if (aimed->found.away.count) {
        add_away(out, aimed, file, words);
    }
}

static bool has_line(const struct lines *lines, const char *line)
{
    bool has = false;
    for (size_t i = 0; i < lines->count && !has; i++) {
        has = strcmp(lines->at[i], line) == 0;
    }
    return has;
}

/* The line of atlas `index`, unless an earlier one has said it. */
static void say_line(const struct lines *lines, const struct aimed *aimed, size_t count, size_t index, size_t which,
                     bool quiet)
{
    const char *line = lines[index].at[which];
    char names[LINE_SIZE] = "";
    size_t size = 0;
    size_t holders = 0;
    for (size_t k = 0; k < count; k++) {
        if (has_line(&lines[k], line)) {
            if (k < index) {
                return;
            }
            holders++;
            int more = snprintf(names + size, sizeof names - size, "%s%s", size ? ", " : "",
                                aimed[k].name ? aimed[k].name : "");
            size = more > 0 && size + (size_t)more < sizeof names ? size + (size_t)more : size;
        }
    }
    bool is_of_all = holders == count;
    say_note(lines[index].severity[which], quiet, "%s%s%s%s", line, is_of_all ? "" : " (", is_of_all ? "" : names,
             is_of_all ? "" : ")");
}

void aim_notes_say(const struct aimed *aimed, size_t count, const char *file, const struct common_settings *settings)
{
    struct lines *lines = calloc(count, sizeof *lines);
    for (size_t i = 0; lines && i < count; i++) {
        find_lines(&lines[i], &aimed[i], file);
    }
    for (size_t i = 0; lines && i < count; i++) {
        for (size_t k = 0; k < lines[i].count; k++) {
            say_line(lines, aimed, count, i, k, settings->quiet);
        }
    }
    free(lines);
}
