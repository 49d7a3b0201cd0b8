/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for the connection to a tracking station where none was written, as on Windows. */
#include "link/station.h"

#include <stdio.h>

bool station_start(struct station **out, const struct station_options *options, char *why, size_t size)
{
    (void)out;
    (void)options;
    snprintf(why, size, "tracker: this conus cannot connect to one; conus on Linux can");
    return false;
}

void station_stop(struct station *station)
{
    (void)station;
}

void station_on_pose(struct station *station, void (*call)(void))
{
    (void)station;
    (void)call;
}

void station_ask(struct station *station, struct station_update *out)
{
    (void)station;
    *out = (struct station_update){0};
}

bool station_wait(struct station *station, uint64_t after, double seconds, struct station_update *out)
{
    (void)after;
    (void)seconds;
    station_ask(station, out);
    return false;
}

const char *station_host(const struct station *station)
{
    (void)station;
    return NULL;
}

void station_send(struct station *station, const char *json, const struct igtl_point *points, size_t count)
{
    (void)station;
    (void)json;
    (void)points;
    (void)count;
}

uint16_t station_port(struct station *station)
{
    (void)station;
    return 0;
}
