/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Loads ATLAS and those of --atlas, or looks at files, on a thread of its own, while the window is open. */
#ifndef CONUS_VIEWER_OPENING_LOADER_H
#define CONUS_VIEWER_OPENING_LOADER_H

#include "settings/atlases.h"

enum { LOADER_WHY = 512 };

struct loader;

struct loading {
    const char *path; /**< Path or name of the first atlas. */
    const struct atlas_settings *settings;
    const struct context_choice *context; /**< Without files the first atlas's own. Another atlas that has none of its
                                             own gets the same. */
    bool again;                           /**< The files are those that are open: tractograms stay as they are. */
    bool (*may_be)(const char *path);     /**< Asked first, on that thread: false = nothing is loaded, nor said why.
                                             NULL = it is. */
    void (*task)(void *user);             /**< Called in place of loading, with user; NULL = it loads. */
    void *user;
};

/** How far it is. */
struct loader_progress {
    char file[96]; /**< That is read now; "" before the first.      */
    double part;   /**< The part of the files that is read, 0 to 1; 0 while there is one. */
};

/** False without memory or threads. Strings of @p request must outlive the loader. */
bool loader_start(struct loader **out, const struct loading *request);
void loader_ask(struct loader *loader, struct loader_progress *out);
bool loader_done(struct loader *loader);
const char *loader_path(const struct loader *loader);
/** Cancels the loader: it ends after the file that it is reading. */
void loader_cancel(struct loader *loader);
/** Waits, and ends the loader. @p out is the caller's. False where there is no atlas: unless the loader was cancelled,
 * stderr says why, and @p why repeats it. True where it looked at files and was not cancelled. */
bool loader_finish(struct loader *loader, struct atlases *out, char why[LOADER_WHY]);

#endif
