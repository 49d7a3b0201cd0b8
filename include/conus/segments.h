/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file segments.h
 * The segments of a device's axis inside each object, and between them (Eq. 17).
 */
#ifndef CONUS_PUBLIC_SEGMENTS_H
#define CONUS_PUBLIC_SEGMENTS_H

#include <conus/selection.h>
#include <conus/table.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The contacts on a shank that is given by its axis: rows of them, from the tip on. */
typedef struct conus_contacts {
    uint32_t count;   /**< All of them, up to 65536; 0 = they are not known. */
    uint32_t columns; /**< How many a row has, from 1. */
    double pitch;     /**< mm from row to row. */
    double tip;       /**< mm from the tip to the first row. */
} conus_contacts;

/**
 * Follows the axis of a device through all objects, occluded or not. The selector's range and level hold; its radius,
 * resolution, engine and sampling do not matter: cells and triangles are found exactly, on the CPU. Rows are ordered by
 * entry, of equal ones by exit, then by object. Those of one object neither overlap nor touch. Those in no object fill
 * what is left of the range; without one, what is left up to the last exit, or to infinity where nothing is met. An
 * exit equals its entry where the axis crosses a surface that is not closed, and nothing says how far it is inside.
 * @param[out] out The columns of `conus query --segments` (docs/formats.md) but query; end it with
 * conus_table_destroy().
 * @param selector The selector. Where its engine is no exact one of rays, the first call makes one for it.
 * @param pose Apex and axis.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a pose that is not rigid.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_segments(conus_table **out, conus_selector *selector, const conus_pose *pose);

#ifdef __cplusplus
}
#endif

#endif
