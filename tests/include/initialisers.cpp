/* SPDX-License-Identifier: BSD-3-Clause */
/* The initialisers of options in C++, without a warning. */
#include <conus/own.h>

extern const conus_view initialised_view;
const conus_view initialised_view = CONUS_VIEW_INIT;
extern const conus_batch_options initialised_batch;
const conus_batch_options initialised_batch = CONUS_BATCH_OPTIONS_INIT;
extern const conus_voxels initialised_voxels;
const conus_voxels initialised_voxels = CONUS_VOXELS_INIT;
