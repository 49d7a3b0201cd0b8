/* SPDX-License-Identifier: BSD-3-Clause */
/** @file OpenEXR's C++ library as the independent reader of images. Reasons of failures go to stderr. */
#ifndef CONUS_TESTS_SUPPORT_EXR_ORACLE_H
#define CONUS_TESTS_SUPPORT_EXR_ORACLE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The bits of a channel of type UINT or FLOAT of a flat file of this size, row by row; free() it. NULL where the file
 * is none, or of another size, or has no such channel. */
uint32_t *exr_flat_read(const char *path, const char *channel, uint32_t width, uint32_t height);

#ifdef __cplusplus
}
#endif

#endif
