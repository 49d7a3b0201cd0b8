/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Edges of a picture of few pixels, which is to be enlarged: without steps as large as a pixel. */
#ifndef CONUS_VIEWER_PICTURES_EDGES_H
#define CONUS_VIEWER_PICTURES_EDGES_H

#include <stdint.h>

/** Makes each pixel of @p rgba [height][width][4] at an edge the mean of those along the edge, whose direction is that
 * in which the colours around the pixel change least. Without memory it stays as it is. */
void edges_smooth(uint8_t *rgba, uint32_t width, uint32_t height);

#endif
