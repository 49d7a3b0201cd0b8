/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Who hears of the pieces of a picture. Needs no GL. */
#ifndef CONUS_RENDER_GL_LISTENER_H
#define CONUS_RENDER_GL_LISTENER_H

#include "base/status.h"

/** Receives progress and may cancel a picture between its pieces; `progress` may be NULL. */
struct picture_listener {
    conus_progress progress;
    void *user;
};

/** Reports piece @p done of @p total. CONUS_ERROR_CANCELLED if the listener wants no more. */
static inline conus_status listener_tell(const struct picture_listener *listener, size_t done, size_t total)
{
    return !listener->progress || listener->progress(listener->user, done, total)
               ? CONUS_OK
               : fail(CONUS_ERROR_CANCELLED, "the picture was cancelled");
}

#endif
