/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Lists of hits in files, as conus query -o writes them. */
#ifndef CONUS_VIEWER_MODEL_EXPORT_H
#define CONUS_VIEWER_MODEL_EXPORT_H

#include "viewer/model/viewer.h"

enum { EXPORT_WHY = 256 };

/** Writes what was selected in all atlases to @p path, in the format of its ending, and its sidecar beside it. False:
 * @p why says why not, in one line. */
bool export_results(struct viewer *viewer, const char *path, char why[EXPORT_WHY]);

#endif
