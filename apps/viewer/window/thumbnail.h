/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the start page knows of an atlas that was open before: a picture, and how many areas it has. It is
 * a file of the window's state, pictures/NAME after the atlas's file: "conus_picture 1 BYTES AREAS\n" with the atlas's
 * size (16 hexadecimal digits), its areas (8 of them), and the pixels. */
#ifndef CONUS_VIEWER_WINDOW_THUMBNAIL_H
#define CONUS_VIEWER_WINDOW_THUMBNAIL_H

#include "viewer/pictures/painter.h"

enum { THUMBNAIL_WIDTH = 400, THUMBNAIL_HEIGHT = 300 };

struct thumbnail {
    uint32_t areas;
    uint8_t rgba[THUMBNAIL_HEIGHT][THUMBNAIL_WIDTH][4]; /**< sRGB, top row first. */
};

/** Reads what was kept of an atlas of so many bytes, and nothing else; false, and @p out stays as it is, where it is
 * not that. */
bool thumbnail_parse(struct thumbnail *out, uint64_t bytes, const char *text, size_t size);
/** Finds what was kept of an atlas of this name and size, wherever it was; false where nothing was. */
bool thumbnail_load(struct thumbnail *out, const char *path);
/** Keeps the middle of a picture of the atlas @p path, for the next time; where that cannot be, nothing is kept. */
void thumbnail_keep(const char *path, uint32_t areas, const struct painted *picture);

#endif
