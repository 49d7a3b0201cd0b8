/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tractograms in files, and one that grows while it is read. */
#ifndef CONUS_LOADERS_TRACTS_TRACTS_H
#define CONUS_LOADERS_TRACTS_TRACTS_H

#include "atlas/tracts/tractogram.h"
#include "base/job/job.h"
#include "conus/atlas.h"

/* Tractograms in files. The format is detected from the first bytes, packed by gzip or not. */

/** Reads the tractogram @p path: of the format that its content has, checked by tractogram_check(), with the radius
 * TRACT_RADIUS, path and sum set, without a tree. Its arrays may take job->max_memory bytes. @p space are the axes of
 * its numbers, which count before those that the file states; refused where they contradict a header that places the
 * points. The path is a place of errors: CONUS_ERROR_IO, CONUS_ERROR_DATA for what is damaged, contradicts itself, or
 * is no tractogram, CONUS_ERROR_UNSUPPORTED, CONUS_ERROR_MEMORY. @p out is the caller's to tractogram_finish(),
 * untouched on failure. The job has the files of a folder. */
void tract_file_read(struct job *job, struct tractogram *out, const char *path, conus_file_space space);

/** The same of the bytes of a file, for tests: all formats but VTK's. Sets no path. */
void tract_file_parse(struct job *job, struct tractogram *out, struct text bytes);

/** True where @p path begins like a tractogram that tract_file_read() reads; of zip archives those whose name ends in
 * .trx, of VTK's files those with lines and no polygons. False also where it cannot be read. */
bool tract_file_is(const char *path);

/* A tractogram that grows while a reader learns how large it is. Its arrays together never take more than is
 * allowed, and what a header claims is never allocated before the file has it. */

/** An empty one is zero, except job and max_memory. The reader writes points, and the values of scalars, where there is
 * room for them, and counts them in tractogram.point_count. After a failure of the job nothing changes. */
struct tract_build {
    struct job *job;
    struct tractogram tractogram; /**< Its counts are those so far; points 3 point_count and so on. */
    uint64_t point_capacity;      /**< Points for which there is room; of all scalars of points, too. */
    uint64_t streamline_capacity;
    uint64_t max_memory; /**< Bytes that all arrays may take together. */
};

/** Adds a scalar, before any point, whose values are NULL. The name is kept as UTF-8. */
void tract_build_scalar(struct tract_build *build, struct text name, bool per_point, uint32_t components);

/** Makes room for what a reader expects, as far as it is allowed, so that nothing need grow. */
void tract_build_expect(struct tract_build *build, uint64_t points, uint64_t streamlines);

/** Room for @p more points behind those that are there; false after a failure. CONUS_ERROR_MEMORY, also above
 * max_memory. */
bool tract_build_points(struct tract_build *build, uint64_t more);

/** Room for one more streamline; false after a failure. CONUS_ERROR_DATA where there are too many. */
bool tract_build_streamline(struct tract_build *build);

/** Ends the streamline, for which there is room: it has the points since the last one. */
static inline void tract_build_end_streamline(struct tract_build *build)
{
    build->tractogram.first[++build->tractogram.streamline_count] = build->tractogram.point_count;
}

/** Gives back the room that is left. */
void tract_build_end(struct tract_build *build);

#endif
