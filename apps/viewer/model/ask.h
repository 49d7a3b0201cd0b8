/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options of conus query that say how the cone asks, as words. */
#ifndef CONUS_VIEWER_MODEL_ASK_H
#define CONUS_VIEWER_MODEL_ASK_H

#include "viewer/model/viewer.h"

/** Asks as conus query does with the @p words behind the first: --layers, --range, --radius, --level, --score, --order,
 * --resolution,
 * --aperture, --engine, --sampling, --slices, --slice-fraction. What they leave out is the default. False: it was said
 * why not, on stderr, and all stays as it was. */
bool ask_words(struct viewer *viewer, char **words, int count);

#endif
