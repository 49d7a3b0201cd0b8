/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file segments.h
 * The segments of a device's axis inside each object, and between them (Eq. 17).
 */
#ifndef CONUS_PUBLIC_SEGMENTS_H
#define CONUS_PUBLIC_SEGMENTS_H

#include <conus/selection.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_segments conus_segments; /**< The segments of an axis, in order of depth. */

/** The contacts on a shank that is given by its axis: rows of them, from the tip on. */
typedef struct conus_contacts {
    uint32_t count;   /**< All of them, up to 65536; 0 = they are not known. */
    uint32_t columns; /**< How many a row has, from 1. */
    double pitch;     /**< mm from row to row. */
    double tip;       /**< mm from the tip to the first row. */
} conus_contacts;

/** A stretch of the axis, from its entry to before its exit (Eq. 17). */
typedef struct conus_segment {
    conus_kind kind;    /**< Kind of the object that it is in; #CONUS_KIND_UNASSIGNED: in none. */
    uint32_t object;    /**< Number in the atlas, as it is reported (level); 0 for #CONUS_KIND_UNASSIGNED. */
    double entry;       /**< mm from the apex. */
    double exit;        /**< mm from the apex; infinity where the axis has no end and meets nothing. Equal to entry
                           where the axis crosses a surface that is not closed, and nothing says how far it is inside. */
    double entry_at[3]; /**< World position of the entry, mm. */
    double exit_at[3];  /**< World position of the exit, mm; NaN where there is none. */
} conus_segment;

/**
 * Follows the axis of a device through all objects, occluded or not. The selector's range and level hold; its radius,
 * resolution, engine and sampling do not matter: cells and triangles are found exactly, on the CPU.
 * @param[out] out The segments; end it with conus_segments_destroy().
 * @param selector The selector. Where its engine is no exact one of rays, the first call makes one for it.
 * @param pose Apex and axis.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a pose that is not rigid.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_segments_create(conus_segments **out, conus_selector *selector,
                                                 const conus_pose *pose);

/**
 * Ends what conus_segments_create() made.
 * @param segments NULL is allowed.
 * @threads One at a time for each @p segments.
 * @since 0.1
 */
CONUS_API void conus_segments_destroy(conus_segments *segments);

/**
 * Counts the segments. They are ordered by entry, of equal ones by exit, then by object. Those of one object neither
 * overlap nor touch. Those in no object fill what is left of the range; without one, what is left up to the last exit.
 * @param segments NULL counts 0.
 * @return How many segments there are; else at least 1.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_segments_count(const conus_segments *segments);

/**
 * Gives segment @p index.
 * @param segments The segments.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the segments.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_segment *conus_segments_segment(const conus_segments *segments, size_t index);

#ifdef __cplusplus
}
#endif

#endif
