/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A tractogram that grows while a reader learns how large it is. Its arrays together never take more than is allowed,
 * and what a header claims is never allocated before the file has it. */
#ifndef CONUS_LOADERS_TRACTS_TRACT_BUILD_H
#define CONUS_LOADERS_TRACTS_TRACT_BUILD_H

#include "atlas/tracts/tractogram.h"
#include "base/job/job.h"

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
