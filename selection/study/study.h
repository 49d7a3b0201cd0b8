/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The answers of studies from inside, for reports and batches, and what tests ask of their parts. */
#ifndef CONUS_SELECTION_STUDY_STUDY_H
#define CONUS_SELECTION_STUDY_STUDY_H

#include "conus/selection.h"
#include "conus/study.h"
#include "selection/selection.h"
#include "selection/table/table.h"

/* Columns of the tables of studies. */
extern const struct table_fields sweep_fields, jitter_fields, overlap_fields, clusters_fields, segment_fields,
    clearance_fields, calibration_fields, reliability_fields, position_fields;

/* jitter.c: errors of the pose (Eq. 14). */
/** Errors have five dimensions; samples are counted in so many sets, one after the other. */
enum { JITTER_DIMENSIONS = 5, JITTER_SETS = 16 };

/** Standard normal errors of sample @p index: tilts about the device's x and y, shifts along x, y and z. */
void jitter_sample(double out[JITTER_DIMENSIONS], uint32_t index);

/** Fills in the defaults, and refuses what is out of its range. */
conus_status jitter_check(conus_jitter_options *options);

/** The pose with these errors, times the options' standard deviations. */
void jitter_pose(conus_pose *out, const conus_pose *pose, const conus_jitter_options *options,
                 const double errors[JITTER_DIMENSIONS]);

/** Likewise of a needle that ends at *far, mm, which errors of its depth change. */
void jitter_needle(conus_pose *out, double *far, const conus_pose *pose, const conus_jitter_options *options,
                   const double errors[JITTER_DIMENSIONS]);

/* overlap.c: what a region of interest covers (Eq. 16). */
/** How much of an object: a row of the table. Number 0 is for the part of the region in no object. */
struct coverage {
    struct table_object object;
    double volume;       /**< Volume of the part that is in both, mm^3. */
    double fraction;     /**< That part of the object, up to 1; NaN for that in none, and of an unknown volume. */
    double roi_fraction; /**< That part of the region. */
    double peak;         /**< The region's value farthest from 0 there, on the threshold's side; of a mask its value. */
    double peak_point[3]; /**< Middle of the voxel or tetrahedron that has it, world; of several the first. */
    double volume_error;  /**< An estimate of how far the volume is off, mm^3, where lines decide; 0 = exact. */
};

/** Help of the column of errors. */
#define COVERAGE_ERROR                                                                                                 \
    "an estimate of how far the volume is off, where lines decide what is in several surfaces; 0 where it is exact"

/** Finds the coverages of a region, in the order of the table. *out is the caller's to free, also on failure,
 * CONUS_ERROR_MEMORY. */
conus_status overlap_find(struct coverage **out, size_t *count, const conus_selector *selector, const conus_roi *roi);

/** Makes a table of rows about a region, as table_create(). */
conus_status overlap_table(conus_table **out, const conus_selector *selector, const struct table_fields *fields,
                           const conus_roi *roi, const void *rows, size_t size, size_t count);

/* segments.c: what an axis passes (Eq. 17). */
/* mm: what an axis meets for less, rounding makes of a ray that only touches. */
#define AXIS_TOUCH 1e-9

/** Refuses contacts that cannot be; a count of 0 is none. */
conus_status contacts_check(const conus_contacts *contacts);

/** Appends all intervals of the axis of @p pose in objects, from the apex on, and sorts @p out by entry. Those that
 * begin beyond @p far, mm, may be missing, and others may end there; 0 = none is. */
conus_status axis_follow(struct layers *out, conus_selector *selector, const conus_pose *pose, double far);

/** Cuts an interval of an axis at the range, whose end is infinite where it is 0; false where nothing is left of it. */
bool axis_clip(conus_interval *interval, const conus_atlas *atlas, const double range[2]);

/* pose_check.c: where cones begin and whether they point at the atlas at all: geometry, before any ray is traced. */
struct conus_pose_check {
    const conus_selector *selector;
    double low[3], high[3]; /**< Around all areas and pathways. */
    bool has_box;
    conus_pose_findings found;
};

/** Sets up a zeroed one for the atlas and options of @p selector, which must outlive it. */
void pose_check_init(struct conus_pose_check *out, const conus_selector *selector);

/** Adds what @p from has found to @p aims. */
void pose_check_merge(conus_pose_findings *aims, const conus_pose_findings *from);

/** Whether the cone or cylinder surely hits nothing of the box from @p low to @p high. A pyramid or prism counts as
 * the cone or cylinder around it. */
bool pose_check_past(const struct cone *cone, const double low[3], const double high[3]);

/* tracker.c */
/** The tracker's options with defaults filled in. */
const conus_tracker_options *tracker_options(const conus_tracker *tracker);

struct position;
struct position_way;

/** A position on a scalp. CONUS_ERROR_ARGUMENT for one below its ring of 10 %, where there is no rule. */
conus_status position_on_scalp(struct position *out, const conus_scalp *scalp, const struct position *position);

/** The end of a way on a scalp, as a position with the name of its start. Where the text is no way, its start is NULL,
 * and @p out stays. CONUS_ERROR_ARGUMENT for a way where @p scalp is NULL, and as position_way_read(),
 * position_on_scalp() and scalp_walk(). */
conus_status position_way_find(struct position *out, struct position_way *way, const conus_scalp *scalp,
                               struct text text);

/* quantiles.c */
/** The 97.5 % quantile of the standard normal distribution. */
#define NORMAL_975 1.959963984540054

/** The value below which @p part, 0 to 1, of chi squared with @p degrees, from 1, of freedom lies. */
double quantile_chi_squared(double part, size_t degrees);

/** The same of Student's t, for @p part from 0.5 on and an even number of degrees of freedom. */
double quantile_t(double part, size_t degrees);

#endif
