/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Loads the atlas on a thread of its own, while the window is open already. */
#ifndef CONUS_VIEWER_LOADER_H
#define CONUS_VIEWER_LOADER_H

#include "settings/settings.h"

enum { LOADER_WHY = 512 };

struct loader;

struct loading {
    const char *path;
    const struct atlas_settings *settings;
    const char *context; /**< NULL = the atlas's own. */
    void (*wake)(void);  /**< Called when it is done. */
};

/** How far it is. */
struct loader_progress {
    char file[96]; /**< That is read now; "" before the first.      */
    double part;   /**< Of the files: 0 to 1; 0 while there is one. */
};

/** False without memory or threads. Strings of @p what must outlive the loader. */
bool loader_start(struct loader **out, const struct loading *what);
void loader_ask(struct loader *loader, struct loader_progress *out);
bool loader_done(struct loader *loader);
/** Nobody wants the atlas any more: the file that is being read is the last one. */
void loader_cancel(struct loader *loader);
/** Waits, and ends the loader. NULL: there is no atlas, and unless it was cancelled it was said why on stderr, which
 * @p why repeats. */
conus_atlas *loader_finish(struct loader *loader, char why[LOADER_WHY]);

#endif
