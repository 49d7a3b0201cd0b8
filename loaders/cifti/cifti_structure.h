/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The brain structures of CIFTI-2, and what GIFTI calls them. */
#ifndef CONUS_LOADERS_CIFTI_CIFTI_STRUCTURE_H
#define CONUS_LOADERS_CIFTI_CIFTI_STRUCTURE_H

struct cifti_structure {
    const char *word; /**< In CIFTI: "CIFTI_STRUCTURE_CORTEX_LEFT".              */
    const char *name; /**< In GIFTI's AnatomicalStructurePrimary: "CortexLeft".  */
    char side;        /**< 'L', 'R' or 0.                                        */
};

/** The structure called @p word in CIFTI ("CIFTI_STRUCTURE_CORTEX_LEFT"), or NULL. Static: equal ones are the same. */
const struct cifti_structure *cifti_structure_find(const char *word);

#endif
