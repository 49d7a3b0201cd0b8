/* SPDX-License-Identifier: BSD-3-Clause */
/* The handlers of SIGINT and SIGTERM. */
#include "options/interrupt.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t caught;
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
    static const int numbers[] = {SIGINT, SIGTERM};
    stopped = poses;
    struct sigaction action = {.sa_handler = keep, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        struct sigaction before;
        if (sigaction(numbers[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) {
            sigaction(numbers[i], &action, NULL);
        }
    }
}

int interrupt_signal(void)
{
    return caught;
}
