/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tractograms in files. The format is detected from the first bytes, packed by gzip or not. */
#ifndef CONUS_LOADERS_TRACTS_TRACT_FILE_H
#define CONUS_LOADERS_TRACTS_TRACT_FILE_H

#include "atlas/tracts/tractogram.h"
#include "base/files/file.h"
#include "base/notes.h"
#include "conus/atlas.h"

/** Reads the tractogram @p path: of the format that its content has, checked by tractogram_check(), with the radius
 * TRACT_RADIUS, path and sum set, without a tree. @p max_memory: bytes that its arrays may take; 0 = 8 GiB. @p space
 * are the axes of its numbers, which count before those that the file states; refused where they contradict a header
 * that places the points. Errors carry the path:
 * CONUS_ERROR_IO, CONUS_ERROR_DATA for what is damaged, contradicts itself, or is no tractogram,
 * CONUS_ERROR_UNSUPPORTED, CONUS_ERROR_MEMORY. @p out is the caller's to tractogram_finish(), untouched on failure. */
conus_status tract_file_read(struct tractogram *out, const char *path, uint64_t max_memory, conus_file_space space,
                             struct notes *notes);

/** True where @p path begins like a tractogram that tract_file_read() reads; of zip archives those whose name ends in
 * .trx, of VTK's files those with lines and no polygons. False also where it cannot be read. */
bool tract_file_is(const char *path);

/** tract_file_read() for bytes in memory, for tests: the formats that are a stream of bytes. Sets no path. */
conus_status tract_file_parse(struct tractogram *out, const uint8_t *data, size_t size, uint64_t max_memory,
                              struct notes *notes);

#endif
