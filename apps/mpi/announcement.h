/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The batch that rank 0 announces to the other ranks. */
#ifndef CONUS_MPI_ANNOUNCEMENT_H
#define CONUS_MPI_ANNOUNCEMENT_H

#include <stdbool.h>

struct announcement {
    const char *atlas, *poses, *output, *shard;
    const char *rows; /**< "segments"; NULL = answers. */
};

/** On rank 0; NULL = there is nothing more to answer. */
void announcement_send(const struct announcement *announcement);

/** On the others, which wait for it: false when there is nothing more to answer. The strings are the caller's to
 * announcement_finish(). */
bool announcement_receive(struct announcement *out);
void announcement_finish(struct announcement *announcement);

#endif
