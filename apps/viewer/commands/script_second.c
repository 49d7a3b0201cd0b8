/* SPDX-License-Identifier: BSD-3-Clause */
/* What a script does with the second tool. */
#include "viewer/commands/script_second.h"

#include "options/messages.h"
#include "viewer/commands/script_words.h"

#include <string.h>

enum { WORDS = 7 };

const char script_second_arguments[] = "on|off|hold|confirm, aim X Y Z TX TY TZ, angle DEGREES, pointer "
                                       "mouse|wand|tracker|spacemouse|gamepad, results FILE.tsv";

static bool aim(struct window *window, const double given[6])
{
    struct viewer *viewer = window->viewer;
    double from[3];
    double to[3];
    conus_pose pose;
    bool fine = viewer_to_world(from, viewer, given) && viewer_to_world(to, viewer, given + 3);
    for (int a = 0; fine && a < 3; a++) {
        to[a] -= from[a];
    }
    conus_status status = fine ? conus_pose_along(&pose, from, to, NULL) : CONUS_ERROR_ARGUMENT;
    if (status) {
        print_status(status);
    } else {
        tool_aim(window->viewer, SECOND_TOOL, &pose);
    }
    return !status;
}

static bool set_angle(struct window *window, double angle)
{
    bool fine = angle > 0 && angle < 180;
    if (fine) {
        window->viewer->tools[SECOND_TOOL].angle = angle;
        tool_changed(window->viewer, SECOND_TOOL);
    }
    return fine;
}

static bool set_pointer(struct window *window, const char *name)
{
    for (int i = 0; i < POINTER_COUNT; i++) {
        if (i != POINT_BY_REPLAY && strcmp(pointer_names[i], name) == 0) {
            tool_choose(window->viewer, SECOND_TOOL, (enum pointer)i);
            return true;
        }
    }
    return false;
}

static bool write_results(struct window *window, const char *path)
{
    tool_update_second(window->viewer);
    conus_status status = viewer_write_results(window->viewer, SECOND_TOOL, path);
    if (status) {
        print_status(status);
    }
    return !status;
}

static bool do_word(struct window *window, const char *word)
{
    if (strcmp(word, "on") == 0 || strcmp(word, "off") == 0) {
        tool_use_second(window->viewer, word[1] == 'n');
    } else if (strcmp(word, "hold") == 0) {
        tool_hold(window->viewer, SECOND_TOOL);
    } else if (strcmp(word, "confirm") == 0) {
        tool_confirm(window->viewer, SECOND_TOOL);
    } else {
        return false;
    }
    return true;
}

bool script_second(struct window *window, const char *const *words, size_t count)
{
    double given[WORDS];
    size_t numbers = 0;
    while (numbers + 1 < count && script_number(&given[numbers], words[1 + numbers])) {
        numbers++;
    }
    if (count == 1) {
        return do_word(window, words[0]);
    }
    if (strcmp(words[0], "aim") == 0) {
        return numbers == 6 && aim(window, given);
    }
    if (strcmp(words[0], "angle") == 0) {
        return count == 2 && numbers == 1 && set_angle(window, given[0]);
    }
    if (strcmp(words[0], "pointer") == 0) {
        return count == 2 && set_pointer(window, words[1]);
    }
    return count == 2 && strcmp(words[0], "results") == 0 && write_results(window, words[1]);
}
