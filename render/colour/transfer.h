/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Colour and opacity of a grey value: piecewise linear between points (Eq. 8), from a preset or a small text file
 * (docs/formats.md, "Transfer functions"). */
#ifndef CONUS_RENDER_COLOUR_TRANSFER_H
#define CONUS_RENDER_COLOUR_TRANSFER_H

#include "atlas/volume.h"
#include "conus/picture.h"

#include <math.h>

enum { TRANSFER_POINT_LIMIT = 4096 };

struct transfer {
    conus_transfer_point *points; /**< [count], at least 1; values never fall. Two equal values are a step. Values are
                                       fractions of the volume's window where the function is relative. */
    size_t count;
    bool relative; /**< Values are fractions of the volume's window: 0 its low, 1 its high end. */
};

/** Parses the text of a transfer function. @p out is the caller's to finish. */
conus_status transfer_parse(struct transfer *out, const uint8_t *data, size_t size);

/** The preset called @p name, else the file of that path. @p out is the caller's to finish. */
conus_status transfer_load(struct transfer *out, const char *name);

/** Copies points of grey values; CONUS_ERROR_ARGUMENT unless they are 1 to TRANSFER_POINT_LIMIT, with values that never
 * fall, and colours and opacities in 0..1. */
conus_status transfer_copy(struct transfer *out, const conus_transfer_point *points, size_t count);

void transfer_finish(struct transfer *transfer);

/** sRGB and opacity at @p value, clamped at both ends (Eq. 8). */
void transfer_at(double rgba[4], const struct transfer *transfer, double value);

/** Extinction per mm of an opacity per mm (Eq. 8); 1 is taken as 1 - 2^-24. */
static inline double transfer_extinction(double opacity)
{
    return -log2(1 - fmin(opacity, 1 - 0x1p-24));
}

/** The grey values that span @p volume's contrast: from its minimum to the 99.5th percentile of the values above it, so
 * that a few bright voxels do not darken the rest. high > low, always. */
conus_status transfer_window(double *low, double *high, const struct volume *volume);

/** The values over which @p transfer changes: from its first to its last point. high > low, always. */
void transfer_span(double *low, double *high, const struct transfer *transfer);

/** Fills @p count entries, evenly spaced over the span from first to last point, with linear R, G, B and the
 * extinction per mm. */
void transfer_table(float *rgbe, size_t count, const struct transfer *transfer);

#endif
