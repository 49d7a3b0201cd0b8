/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A needle, a part of a line, and how far it is from boxes and segments (Eq. 21). */
#ifndef CONUS_BASE_GEOMETRY_NEEDLE_H
#define CONUS_BASE_GEOMETRY_NEEDLE_H

/** Its points are origin + t direction, near <= t <= far; both are finite. */
struct needle {
    double origin[3];    /**< mm           */
    double direction[3]; /**< A unit vector. */
    double near, far;    /**< mm             */
};

/** The point of the needle's line at @p depth. */
void needle_point(double out[3], const struct needle *needle, double depth);

/** A needle as boxes along the axes of another frame see it. The axes count as perpendicular. */
struct needle_frame {
    double at[3];     /**< The origin, in the frame's units.                                               */
    double step[3];   /**< Steps per mm along the needle. 0 below 1e-12 of a mm: the needle is along the others. */
    double per[3];    /**< 1 / step; 0 where that is 0.                                                    */
    double square[3]; /**< (step scale)^2.                                                                 */
    double scale[3];  /**< mm per unit.                                                                    */
    double near, far;
};

/** @p frame_from_world NULL: the world. */
void needle_frame_init(struct needle_frame *out, const struct needle *needle, const double frame_from_world[16]);

/** Distance in mm from the box between the corners @p low and @p high. @p depth receives the least depth at which the
 * needle is so near: 0 and where it comes in, if it does. */
double needle_box(double *depth, const struct needle_frame *frame, const double low[3], const double high[3]);

/** Distance from the segment from @p a to @p b, which may be one point. @p depth receives the least depth at which the
 * needle is so near, @p point the segment's point there. */
double needle_segment(double *depth, double point[3], const struct needle *needle, const double a[3],
                      const double b[3]);

#endif
