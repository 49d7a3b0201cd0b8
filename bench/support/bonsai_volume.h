/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The volume of the paper's second experiment, or a similar one. */
#ifndef CONUS_BENCH_SUPPORT_BONSAI_VOLUME_H
#define CONUS_BENCH_SUPPORT_BONSAI_VOLUME_H

#include "atlas/atlas.h"

/** Grey value at which wood, leaves and pot begin: below it are air and noise. */
enum { BONSAI_EDGE = 256, BONSAI_AIR = 28 };

struct bonsai {
    size_t edge; /**< Voxels along each axis, each a mm wide. */
    uint8_t *voxels;
    bool is_papers; /**< The bytes that everyone has, by their SHA-256; else a stand-in. */
};

/** Reads the 256^3 bytes of the paper's volume from a file of just these, or of any format that a context may have.
 * CONUS_ERROR_DATA, naming both checksums, if the bytes are others. */
conus_status bonsai_read(struct bonsai *out, const char *path);

/** Makes a stand-in with @p edge voxels along each axis: a pot of soil, a trunk with branches, clouds of leaves. */
conus_status bonsai_make(struct bonsai *out, size_t edge);

void bonsai_finish(struct bonsai *bonsai);

/** A grid with its middle at @p centre: of a context, or of a pathway from @p threshold on if that is not 0. */
void bonsai_info(conus_volume_info *out, const struct bonsai *bonsai, const double centre[3], double threshold);

/** A copy of the values. NULL without memory. */
float *bonsai_values(const struct bonsai *bonsai);

#endif
