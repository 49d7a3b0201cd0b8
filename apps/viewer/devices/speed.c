/* SPDX-License-Identifier: BSD-3-Clause */
/* How fast devices move a tool. */
#include "viewer/devices/devices.h"

#include <math.h>

double devices_speed(const struct devices *devices)
{
    return source_speed(&devices->gamepad.source);
}

void devices_set_speed(struct devices *devices, double speed)
{
    double bounded = fmin(fmax(speed, SOURCE_LEAST_SPEED), SOURCE_MOST_SPEED);
    devices->gamepad.source.speed = devices->spacemouse.source.speed = bounded;
}
