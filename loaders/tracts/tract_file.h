/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tractograms in files. The format is detected from the first bytes, packed by gzip or not. */
#ifndef CONUS_LOADERS_TRACTS_TRACT_FILE_H
#define CONUS_LOADERS_TRACTS_TRACT_FILE_H

#include "atlas/tracts/tractogram.h"
#include "base/job/job.h"
#include "conus/atlas.h"

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

#endif
