/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tractograms for tests, and an atlas of four streamlines. Their memory is freed by the owner. */
#ifndef CONUS_TESTS_SUPPORT_TRACT_SCENE_H
#define CONUS_TESTS_SUPPORT_TRACT_SCENE_H

#include "atlas/atlas.h"
#include "base/memory.h"

/** A tractogram in the making; `made` belongs to the caller. */
struct tract_builder {
    struct tractogram made;
    size_t point_capacity, first_capacity;
};

/** A tractogram of copies: points first[k] to first[k + 1] - 1 are streamline k. */
struct tractogram tract_of(const char *path, const float *points, const uint64_t *first, size_t streamlines,
                           double radius);

void tract_begin(struct tract_builder *builder);
void tract_add_point(struct tract_builder *builder, const double point[3]);
/** Ends a streamline, which has the points since the last one. */
void tract_end_streamline(struct tract_builder *builder);
void tract_add_group(struct tractogram *to, const char *name, const uint32_t *members, size_t count);

/** Streamlines 0 to 2 run along x at z = 30 and y = 0, 3 and 100, from -50 to 50; but 1 from 70 to -30. Streamline 3
 * has four points, is the longest, runs along x, too, and is far away. Object 1, "near", is 0, 1 and 3; object 2,
 * "far", is 2. */
conus_atlas *tract_lines_atlas(void);

/** Reads a tractogram from a file; tract_file_read() on a job. */
conus_status tract_read(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes);

/** The same of the bytes of a file. */
conus_status tract_parse(struct tractogram *out, const struct buffer *bytes, uint64_t max_memory, struct notes *notes);

#endif
