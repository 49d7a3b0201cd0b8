/* SPDX-License-Identifier: BSD-3-Clause */
/** @file OpenEXR's C++ library as the independent reader of images, flat and deep, and encoder of manifests. Reasons of
 * failures go to stderr. */
#ifndef CONUS_TESTS_SUPPORT_EXR_ORACLE_H
#define CONUS_TESTS_SUPPORT_EXR_ORACLE_H

#include "render/image/id_manifest.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The bits of a channel of type UINT or FLOAT of a flat file of this size, row by row; free() it. NULL where the file
 * is none, or of another size, or has no such channel. */
uint32_t *exr_flat_read(const char *path, const char *channel, uint32_t width, uint32_t height);

struct exr_deep; /* a deep file that was read */

struct exr_deep *exr_deep_read(const char *path); /**< NULL where it is none. */
void exr_deep_close(struct exr_deep *deep);

uint32_t exr_deep_side(const struct exr_deep *deep, int axis); /**< Pixels along x (0) or y (1). */
uint32_t exr_deep_count(const struct exr_deep *deep, uint32_t x, uint32_t y);
/** Sample @p s of a pixel in a channel of type UINT, or FLOAT; dies where there is no such channel. */
uint32_t exr_deep_uint(const struct exr_deep *deep, const char *channel, uint32_t x, uint32_t y, uint32_t s);
float exr_deep_float(const struct exr_deep *deep, const char *channel, uint32_t x, uint32_t y, uint32_t s);

/** A string, or whole-number attribute; NULL or -1 where there is none. */
const char *exr_deep_text(const struct exr_deep *deep, const char *attribute);
int exr_deep_number(const struct exr_deep *deep, const char *attribute);

/** Number of entries of the manifest for a channel, and the text of a component for an id; NULL = none. */
size_t exr_deep_names(const struct exr_deep *deep, const char *channel);
const char *exr_deep_name(const struct exr_deep *deep, const char *channel, uint32_t id, const char *component);

/** The value of the attribute `idManifest` that OpenEXR writes for these groups; free() it. */
uint8_t *exr_manifest(size_t *size, const struct id_manifest_group *groups, size_t group_count);

#ifdef __cplusplus
}
#endif

#endif
