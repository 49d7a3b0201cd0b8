/* SPDX-License-Identifier: BSD-3-Clause */
/* The handlers of SIGINT and SIGTERM. */
#include "options/progress.h"

#include "base/system/system.h"

static _Atomic int caught;
static conus_pose_stream *_Atomic stopped;

static void keep(int number)
{
    conus_pose_stream *poses = stopped;
    caught = number;
    if (poses) {
        conus_pose_stream_stop(poses);
    }
}

void interrupt_release(void)
{
    stopped = NULL;
}

void interrupt_catch(conus_pose_stream *poses)
{
    stopped = poses;
    system_interrupt(keep);
}

int interrupt_signal(void)
{
    return caught;
}
