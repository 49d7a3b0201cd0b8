/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Streamlines: a capsule around a segment, the tree of their runs, and the tractogram. */
#ifndef CONUS_ATLAS_TRACTS_TRACTOGRAM_H
#define CONUS_ATLAS_TRACTS_TRACTOGRAM_H

#include "base/files/file.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The ray and the capsule of Eq. 18: all points that are no farther than a radius from a segment. */

/** Where the line through @p origin along @p direction (unit length) enters the capsule round the segment from @p a to
 * @p b and where it leaves it, mm from the origin; negative values are behind it. False (@p out untouched) where the
 * line misses it. A segment of one point is a ball. The radius is above 0. The same bits on every processor. */
bool capsule_interval(double out[2], const double origin[3], const double direction[3], const double a[3],
                      const double b[3], double radius);

/* A tree of boxes around runs of streamlines' segments. A leaf has runs of neighbouring streamlines side by side,
 * with ends in bytes, so that a search reads it at once and few points. The tree is small beside the points
 * (streamlines of 100 points have 4.4 bytes of it a point, or 2.7 if points are halves), flat, and the same for the
 * same points, so it can be packed and mapped. tract_node.h has its layout. */

/** Segments of a run at most, and points from one mark to the next. */
enum { TRACT_RUN = 7, TRACT_MARK = 64 };

/** Neighbouring segments of a streamline, between the points `point` and `point + segments`. Runs that follow each
 * other share a point. A streamline of one point is a run of no segment. */
struct tract_run {
    uint64_t point;
    uint32_t streamline;
    uint32_t segments; /**< 0 to TRACT_RUN */
};

struct tract_leaf;
struct tract_node;
struct tractogram;

/** A zeroed one is empty. */
struct tract_tree {
    struct tract_node *nodes;
    size_t node_count;
    struct tract_leaf *leaves;
    size_t run_count;
    double *lengths; /**< [streamline_count] mm, of the streamlines. */
    uint32_t *marks; /**< [tract_mark_count()] Streamline of every TRACT_MARK-th point, from the first one on. */
};

/** Frees what it has. */
void tract_tree_finish(struct tract_tree *tree);

/** How many leaves have @p run_count runs. */
size_t tract_leaf_count(size_t run_count);

/** How many marks there are for @p point_count points. */
size_t tract_mark_count(uint64_t point_count);

/** Run @p number, below the tree's run_count, in the order of the leaves. */
struct tract_run tract_run_at(const struct tractogram *tractogram, size_t number);

/** How a box, its border included, lies to the region that is searched. */
enum tract_answer { TRACT_OUTSIDE, TRACT_PERHAPS, TRACT_INSIDE };
typedef enum tract_answer (*tract_box_test)(void *user, const double low[3], const double high[3]);

/** Receives a run whose box is not outside; @p inside: the test has said so for a box around it. */
typedef void (*tract_visit)(void *user, const struct tract_run *run, bool inside);

/** Calls @p visit for all runs of @p tractogram in boxes that @p test does not call outside, in the order of the
 * leaves. Boxes are those of the polylines, those of single runs a little larger; for capsules the test grows them by
 * the radius. */
void tract_tree_walk(const struct tractogram *tractogram, tract_box_test test, tract_visit visit, void *user);

/* A tractogram: the streamlines of one file in world mm, as every reader makes them. Objects of the atlas (bundles)
 * are all of its streamlines or groups of them; a streamline may be in several groups. */

/** mm: coordinates lie within it of 0. */
#define TRACT_COORDINATE_LIMIT 1e9

/** The default radius of streamlines, and the largest, mm. */
#define TRACT_RADIUS 0.5
#define TRACT_RADIUS_LIMIT 100.0

/** Named numbers in a file, for each point or streamline: FA, say. */
struct tract_scalar {
    char *name;          /**< Owned; UTF-8, one line.                                                              */
    bool per_point;      /**< Else per streamline.                                                                 */
    uint32_t components; /**< 1 or more numbers per point or streamline.                                           */
    float *values;       /**< [point_count or streamline_count][components]; owned. NaN = the file says so.        */
};

/** Streamlines that a file calls by one name. */
struct tract_group {
    char *name;        /**< Owned; UTF-8, one line. */
    uint32_t *members; /**< [count] Numbers of streamlines from 0, ascending, none twice; owned. */
    size_t count;
};

struct tractogram {
    char *path;              /**< As opened; owned. */
    char format[64];         /**< "TrackVis 2, gzip, big-endian". */
    bool states_mm;          /**< The file, or its format, says that points are world mm.                          */
    char sha256[65];         /**< The file's, in hexadecimal; empty for a TRX folder. */
    unsigned char space;     /**< conus_file_space: the axes of the file's numbers, as it says or its user. */
    struct file_sums files;  /**< None: they are the job's. It goes with the next change of PACK_FORMAT. */
    float *points;           /**< [3 point_count] x, y, z in world mm (RAS); owned. NULL where halves has them. */
    uint16_t *halves;        /**< The same in half precision (IEEE binary16), as the file has them; owned. */
    uint64_t point_count;    /**< Points of all streamlines together. */
    uint64_t *first;         /**< [streamline_count + 1] Streamline k has the points first[k] to first[k + 1] - 1, which
                                may be none or one; first[0] is 0, the last is point_count. Owned. */
    size_t streamline_count; /**< Below UINT32_MAX. */
    struct tract_scalar *scalars;
    size_t scalar_count;
    struct tract_group *groups; /**< Without a group all streamlines are one bundle. */
    size_t group_count;
    double radius;            /**< mm: a ray hits a streamline if it comes nearer than this (Eq. 18). */
    struct tract_tree tree;   /**< The tree of all segments; tractogram_grow_tree() makes it. */
    double low[3], high[3];   /**< Bounds of all points, world mm; tractogram_grow_tree() fills them in. */
    bool is_ready;            /**< bundles_ready() was there. */
    bool has_borrowed_points; /**< Points (or halves) and the tree's arrays are borrowed and read-only. */
    bool is_borrowed;         /**< The other arrays are borrowed, too. */
};

/** Frees what it owns; a zeroed one is fine. */
void tractogram_finish(struct tractogram *tractogram);

/** Turns points of LPS into RAS. They are its own. */
void tractogram_from_lps(struct tractogram *tractogram);

/** The value of a half (IEEE binary16). */
double tract_from_half(uint16_t half);

/** The streamline that has point @p index, below point_count. */
uint32_t tractogram_streamline_of(const struct tractogram *tractogram, uint64_t index);

/** Point @p index, world mm. */
static inline void tractogram_point(double out[3], const struct tractogram *tractogram, uint64_t index)
{
    for (uint64_t a = 0; a < 3; a++) {
        out[a] = tractogram->points ? (double)tractogram->points[3 * index + a]
                                    : tract_from_half(tractogram->halves[3 * index + a]);
    }
}

/** Whether all points of a tractogram from @p from to before @p to are within the limit. A threads_test. */
bool tract_points_are_within(const void *user, size_t from, size_t to);

/** How many streamlines of @p tractogram @p group has; all where that is NULL. */
static inline size_t tract_group_count(const struct tract_group *group, const struct tractogram *tractogram)
{
    return group ? group->count : tractogram->streamline_count;
}

/** The number of the streamline that is the group's @p i-th, from 0. */
static inline uint32_t tract_group_member(const struct tract_group *group, size_t i)
{
    return group ? group->members[i] : (uint32_t)i;
}

/** Whether @p streamline is in the group; all are where that is NULL. */
bool tract_group_has(const struct tract_group *group, uint32_t streamline);

/** Refuses tractograms that no engine may get: a coordinate that is not within TRACT_COORDINATE_LIMIT of 0 (infinity
 * and NaN too), a `first` that does not ascend from 0 to point_count, a member of a group out of range or order, too
 * many streamlines, a radius that is not above 0 and at most TRACT_RADIUS_LIMIT. Notes count streamlines of no point
 * and of one. CONUS_ERROR_DATA, and CONUS_ERROR_ARGUMENT for the radius. */
conus_status tractogram_check(const struct tractogram *tractogram, struct notes *notes);

/** CONUS_ERROR_DATA where a number of a tractogram with its tree, which comes from elsewhere, leads out of its arrays:
 * `first`, runs, nodes, members of groups. Does not check coordinates. */
conus_status tractogram_check_tree(const struct tractogram *tractogram);

/** Makes tree, low and high of a checked tractogram. Uses no more memory on the way than in the end.
 * CONUS_ERROR_MEMORY, and CONUS_ERROR_DATA for more than UINT32_MAX points. */
conus_status tractogram_grow_tree(struct tractogram *tractogram);

/** Length of streamline @p number, mm. */
double tractogram_length(const struct tractogram *tractogram, uint32_t number);

#endif
