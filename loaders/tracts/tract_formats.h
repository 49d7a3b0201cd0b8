/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of tract_file_read(). Each has a function that says of the first bytes @p head of a file,
 * unpacked, whether they are of this format (@p path may be NULL), and one that reads it. */
#ifndef CONUS_LOADERS_TRACTS_TRACT_FORMATS_H
#define CONUS_LOADERS_TRACTS_TRACT_FORMATS_H

#include "atlas/tracts/tractogram.h"
#include "base/files/file.h"
#include "base/formats/byte_stream.h"

/** Reads a tractogram to the end of @p stream. Fills in what a file says: format, points, streamlines, scalars and
 * groups. Messages are without the path. */
typedef conus_status tract_reader(struct tractogram *out, struct byte_stream *stream, uint64_t max_memory,
                                  struct notes *notes);

/* TrackVis (.trk), version 1 and 2: a header of 1000 bytes, then each streamline as the number of its points, the
 * points with their scalars, and its properties. Points are in mm from the outer corner of the first voxel, along the
 * axes that voxel_order names; docs/spaces.md says how they come into the world. */
bool trk_is(const struct bytes *head, const char *path);
tract_reader trk_read;

/* MRtrix (.tck): lines "key: value" up to END, then points of three floats or doubles in world mm, of which three times
 * NaN ends a streamline and three times infinity the file. */
bool tck_is(const struct bytes *head, const char *path);
tract_reader tck_read;

/* DSI Studio (.tt.gz): a MAT-file of level 4 with the variables dimension, trans_to_mni, track and others. Of each
 * streamline track has the number of its coordinates, its first point in 1/32 of a voxel, and the steps to the next
 * ones as bytes. trans_to_mni brings voxels, counted from the centre of the first one, into the world. */
bool tt_is(const struct bytes *head, const char *path);
tract_reader tt_read;

/* TRX (github.com/tee-ar-ex/trx-spec): a folder, or a zip archive, of header.json and arrays whose names say what they
 * are. Positions are world mm (RAS) already; those in half precision stay so. */

/** True of a zip archive, whatever it holds, by its first bytes @p head, and of a folder @p path (it may be NULL) with
 * header.json. */
bool trx_is(const struct bytes *head, const char *path);

/** True of a folder, and of a name that ends in .trx: of an archive that trx_is() knows from its first bytes only. */
bool trx_is_named(const char *path);

/** Reads the archive or folder @p path: format, sum, points or halves, first, scalars and groups, which are to be
 * checked. CONUS_ERROR_IO, CONUS_ERROR_DATA for what contradicts itself, CONUS_ERROR_UNSUPPORTED, CONUS_ERROR_MEMORY
 * above @p max_memory bytes, those of the archive included. Messages carry the path. */
conus_status trx_read(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes);

/** The same of an archive in memory, without sum and path. @p archive is the caller's to finish, and may be empty
 * afterwards: positions that are not packed stay where they are. */
conus_status trx_parse(struct tractogram *out, struct bytes *archive, uint64_t max_memory, struct notes *notes);

/* Polylines in VTK's legacy format (.vtk) and in its XML format (.vtp), which loaders/surfaces/foreign parses. */

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
