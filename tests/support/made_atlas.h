/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Atlases made of one labelled volume, without files. */
#ifndef CONUS_TESTS_MADE_ATLAS_H
#define CONUS_TESTS_MADE_ATLAS_H

#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "atlas/phantom/phantom.h"

/** atlas_create_of() one volume: @p labels has one label per voxel of @p info. */
conus_status atlas_create(conus_atlas **out, const conus_volume_info *info, const uint32_t *labels,
                          const struct label_table *table, const char *label_source, struct notes *notes);

/** The atlas that one gets from loading the drawing's files. */
conus_status phantom_drawing_atlas(conus_atlas **out, const struct phantom_drawing *drawing);

#endif
