/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A folder of OME-Zarr as a volume: which array of it is meant, and where that lies. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_ZARR_H
#define CONUS_LOADERS_VOLUMES_VOLUME_ZARR_H

#include "loaders/volumes/volume_input.h"
#include "loaders/zarr/zarr.h"

/** The member own of a volume_input whose reader is zarr_reader. */
struct volume_zarr {
    const char *folder; /**< Of the array. */
    struct zarr_array array;
    char orientation[4]; /**< Where OME's metadata say that its axes start, "asr"; empty = they do not. */
};

#endif
