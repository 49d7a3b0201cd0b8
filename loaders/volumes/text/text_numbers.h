/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Voxels that are written as text: decimal numbers, or hexadecimal digits. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_TEXT_NUMBERS_H
#define CONUS_LOADERS_VOLUMES_TEXT_TEXT_NUMBERS_H

#include "base/formats/gzip.h"
#include "base/text.h"
#include "loaders/volumes/text/text_volume.h"

/** Reads numbers of @p type, with white space between them, into bytes in this machine's order; keeps those of
 * @p range. range->total / type.size numbers must be there; a further one is an error. */
conus_status text_numbers_read(struct bytes *out, struct gzip_range *range, struct text text, struct text_type type);

/** Reads bytes of two hexadecimal digits, with white space anywhere; as above. */
conus_status text_hex_read(struct bytes *out, struct gzip_range *range, struct text text);

#endif
