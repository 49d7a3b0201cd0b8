/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The names of a .hdr and its .img, either of which may be packed. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_PAIR_H
#define CONUS_LOADERS_VOLUMES_VOLUME_PAIR_H

#include <stdbool.h>
#include <stddef.h>

/** True where @p path ends in ".ext" or ".ext.gz", whatever the case; *at is where "ext" stands. */
bool volume_pair_has(const char *path, const char *ext, size_t *at);

/** Path of the other half of a pair: @p path with the ending at @p at replaced by @p ext ("hdr" or "img"), in capitals
 * if this half's is; packed like this half if there is such a file, else not. NULL without memory; memory_free() it. */
char *volume_pair_other(const char *path, size_t at, const char *ext);

#endif
