/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Contexts from files. */
#ifndef CONUS_LOADERS_SCENE_LOAD_CONTEXT_H
#define CONUS_LOADERS_SCENE_LOAD_CONTEXT_H

#include "atlas/atlas.h"
#include "base/job/job.h"
#include "loaders/manifest/scene.h"

/** Sets the volume @p path, or adds the surface, as @p item says. The atlas may be changed after a failure. */
void context_load(struct job *job, conus_atlas *atlas, const char *path, bool is_surface,
                  const struct scene_item *item);

/** Whether context_load() would have nothing to note about the volume @p path, but of its voxels: by its header. */
bool context_is_plain(struct job *job, const conus_atlas *atlas, const char *path);

#endif
