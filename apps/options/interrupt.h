/* SPDX-License-Identifier: BSD-3-Clause */
/** @file SIGINT and SIGTERM, kept until a long piece of work comes to a place where it can end. */
#ifndef CONUS_OPTIONS_INTERRUPT_H
#define CONUS_OPTIONS_INTERRUPT_H

#include "conus/pose.h"

/** From here on the first of each is kept, and stops @p poses, so that nothing waits for a silent pipe; the second one
 * ends the program. One that is ignored stays so. */
void interrupt_catch(conus_pose_stream *poses);

/** The poses are left alone from here on: to be called before they are destroyed. */
void interrupt_release(void);

/** The signal that was caught last; 0 if there was none. */
int interrupt_signal(void);

#endif
