/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options of programs that receive poses from a tracker by OpenIGTLink. */
#ifndef CONUS_SETTINGS_STATION_SETTINGS_H
#define CONUS_SETTINGS_STATION_SETTINGS_H

#include "link/station.h"
#include "options/options.h"

struct station_settings {
    const char *listen, *connect, *tool, *reference, *world_from_tracker;
    size_t axis; /* conus_axis */
    bool lps;
    double enlarged;
    const char *head, *screen_pose;
    double eye[3];
    uint32_t screen_mm[2];
    const char *second_tool, *second_listen, *second_connect, *second_world_from_tracker;
};

extern const struct option station_options_table[]; /**< station_settings */
extern const struct option screen_options_table[];  /**< station_settings, too: who looks at which screen */

extern const struct option second_options_table[]; /**< station_settings, too: a second tool that points */

/** Whether the options go together, and name addresses; prints an error if not. */
bool station_settings_check(const struct station_settings *settings, const struct arguments *arguments);

/** The same for a command with the screen's options, */
bool station_settings_check_screen(const struct station_settings *settings, const struct arguments *arguments);

/** and for one with the options of a second tool as well. */
bool station_settings_check_second(const struct station_settings *settings, const struct arguments *arguments);

/** Starts a station where --listen or --connect was given, else leaves *out NULL. Returns the exit code and prints an
 * error unless it is 0. */
int station_settings_start(struct station **out, const struct station_settings *settings);

/** Starts one that connects to @p address, HOST[:PORT], in place of that of --listen or --connect. Likewise. */
int station_settings_connect(struct station **out, const struct station_settings *settings, const char *address);

/** The same for --second-listen or --second-connect: the second tool's own station; without them both tools share the
 * first one. */
int station_settings_start_second(struct station **out, const struct station_settings *settings);

/** "waiting for a connection on port 18944", "Pointer is lost", ... */
void station_settings_text(char *out, size_t size, struct station *station, const struct station_update *update);

#endif
