/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes all devices ready. */
#include "viewer/devices/devices.h"

void devices_init(struct devices *out)
{
    *out = (struct devices){0};
    tracker_init(&out->trackers[0]);
    tracker_init(&out->trackers[1]);
    pushed_init(&out->mouse);
    spacemouse_init(&out->spacemouse);
    gamepad_init(&out->gamepad, gamepad_read);
}

void devices_finish(struct devices *devices)
{
    spacemouse_finish(&devices->spacemouse);
}
