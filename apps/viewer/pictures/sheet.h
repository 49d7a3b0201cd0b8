/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The sheet of the figures that the window saves: what of conus render's options is the window's. */
#ifndef CONUS_VIEWER_PICTURES_SHEET_H
#define CONUS_VIEWER_PICTURES_SHEET_H

#include "conus/picture.h"

enum { SHEET_SIDE_LIMIT = 16384, SHEET_MM_LIMIT = 10000, SHEET_DPI_LIMIT = 10000, SHEET_DPI_LEAST = 10 };

struct sheet {
    bool in_mm;         /**< The size is that on paper. */
    uint32_t pixels[2]; /**< Width and height, 1 to SHEET_SIDE_LIMIT; */
    double mm[2];       /**< or 1 to SHEET_MM_LIMIT. Zeros = what conus render takes by itself. */
    double dpi;         /**< SHEET_DPI_LEAST to SHEET_DPI_LIMIT; 0 = not said, and 300 where the size is in mm. */
    conus_legend legend;
    bool no_text; /**< No legend, and no letters. */
};

/** As conus render has it by itself. */
void sheet_init(struct sheet *out);
bool sheet_is_same(const struct sheet *a, const struct sheet *b);

#endif
