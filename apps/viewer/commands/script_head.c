/* SPDX-License-Identifier: BSD-3-Clause */
/* A tracked head by words. */
#include "viewer/commands/script_head.h"

#include "options/messages.h"
#include "viewer/commands/script_words.h"

#include <string.h>

static bool read_numbers(double *out, char *const *words, size_t count)
{
    bool fine = true;
    for (size_t i = 0; i < count && fine; i++) {
        fine = script_number(&out[i], words[i]);
    }
    return fine;
}

bool script_screen(struct viewer *viewer, char *const *arguments)
{
    double given[8];
    double away[3];
    struct head *head = &viewer->head;
    conus_pose screen;
    if (!read_numbers(given, arguments, 8) || !(given[6] > 0) || !(given[7] > 0)) {
        return false;
    }
    for (int a = 0; a < 3; a++) {
        away[a] = given[3 + a] - given[a];
    }
    conus_status status = conus_pose_along(&screen, given, away, NULL);
    if (status) {
        print_status(status);
        return false;
    }
    *head =
        (struct head){.named = head->named, .screen = screen, .size = {given[6], given[7]}, .number = head->number + 1};
    return true;
}

bool script_head(struct viewer *viewer, char *const *arguments, size_t count)
{
    double eye[3];
    struct head *head = &viewer->head;
    if (count == 1 && strcmp(arguments[0], "lost") == 0) {
        head_set_state(head, STATION_LOST);
        return true;
    }
    bool fine = head->size[0] > 0 && count == 3 && read_numbers(eye, arguments, 3);
    if (fine) {
        head->on = true;
        head_set_state(head, STATION_SEEN);
        head_move(head, eye, &head->screen);
    }
    return fine;
}
