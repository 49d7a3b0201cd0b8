/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The readers of tract_file_read(). */
#ifndef CONUS_LOADERS_TRACTS_TRACT_FORMATS_H
#define CONUS_LOADERS_TRACTS_TRACT_FORMATS_H

#include "loaders/tracts/tracts.h"
#include "sources/source.h"

/** Reads a tractogram to its end. Fills in what a file says: format, points, streamlines, scalars and groups, which are
 * to be checked. */
typedef void tract_reader(struct job *job, struct source *source, struct tract_build *build);

/* TrackVis (.trk), version 1 to 3: a header of 1000 bytes, then each streamline as the number of its points, the
 * points with their scalars, and its properties. Points are in mm from the outer corner of the first voxel, along the
 * axes that voxel_order names; docs/spaces.md says how they come into the world. */
tract_reader trk_read;

/* MRtrix (.tck): lines "key: value" up to END, then points of three floats or doubles in world mm. A point of
 * three NaN ends a streamline, a point of three infinities the file. */
tract_reader tck_read;

/* DSI Studio (.tt.gz): a MAT-file of level 4 with the variables dimension, trans_to_mni, track and others. For
 * each streamline, track has the number of its coordinates, its first point in 1/32 of a voxel, and the steps to the
 * next points as bytes. trans_to_mni maps voxels, counted from the centre of the first one, to the world. */
tract_reader tt_read;

/* TRX (github.com/tee-ar-ex/trx-spec): a folder, or a zip archive, of header.json and arrays whose names say what they
 * are. Positions are world mm (RAS) already; those in half precision stay so, and those that are not packed in the
 * memory of the archive. The job has the files of a folder. */
tract_reader trx_read;

/* Polylines in VTK's legacy format (.vtk) and in its XML format (.vtp), which loaders/surfaces/foreign parses. A point
 * of several lines is a point of each. Coordinates are those of the file, in the space that it states. A file without
 * lines is refused. The file, unpacked, each of its arrays, and all arrays of the tractogram together, may have the
 * build's max_memory. */
tract_reader vtk_lines_read;

/** Reads the file @p path, which has one of these formats; true if it has lines and no polygons. */
bool vtk_lines_are_in(const char *path);

#endif
