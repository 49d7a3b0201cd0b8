/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a region of interest covers, from inside (Eq. 16). */
#ifndef CONUS_SELECTION_STUDY_OVERLAP_H
#define CONUS_SELECTION_STUDY_OVERLAP_H

#include "conus/conus.h"

struct conus_overlap {
    conus_coverage *rows;
    size_t count;
    char *path; /**< Of the region's volume; owned. */
    char sha256[65];
    size_t volume;     /**< Of a 4-D file, from 0.          */
    double threshold;  /**< 0 of a mask.                    */
    double volume_mm3; /**< Of the region.                  */
};

#endif
