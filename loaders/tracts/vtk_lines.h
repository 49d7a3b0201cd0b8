/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Polylines in VTK's legacy format (.vtk) and in its XML format (.vtp), which loaders/surfaces/foreign parses.
 */
#ifndef CONUS_LOADERS_TRACTS_VTK_LINES_H
#define CONUS_LOADERS_TRACTS_VTK_LINES_H

#include "atlas/tracts/tractogram.h"
#include "base/files/file.h"

/** True where @p head, the first bytes of a file, unpacked, is of one of these formats: of a surface, too. */
bool vtk_lines_is(const struct bytes *head, const char *path);

/** True where the file @p path, of one of these formats, has lines and no polygons; it is read for it. */
bool vtk_lines_are_in(const char *path);

/** Reads the file @p path, packed by gzip or not: format, sum, points, first and scalars, which are to be checked. A
 * point of several lines is a point of each. Coordinates are RAS unless the file says that they are LPS; a note says so
 * where the file does not. CONUS_ERROR_DATA also for a file without lines. The file, unpacked, and each of its arrays,
 * and all arrays of the tractogram together, may have @p max_memory bytes. */
conus_status vtk_lines_read(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes);

/** The same of the bytes of a file, unpacked, without a sum. */
conus_status vtk_lines_parse(struct tractogram *out, const struct bytes *bytes, uint64_t max_memory,
                             struct notes *notes);

#endif
