/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What `conus info --format tree` writes. */
#ifndef CONUS_CLI_ANSWERS_INFO_TREE_H
#define CONUS_CLI_ANSWERS_INFO_TREE_H

#include <conus/conus.h>

#include <stdio.h>

/** Writes the areas as a tree: children below their parent, by label, with depth and number of areas below. False
 * without memory. */
bool info_tree(FILE *out, const conus_atlas *atlas);

/** Depth of the deepest area, roots having 1; 0 without areas. */
size_t info_tree_depth(const conus_atlas *atlas);

#endif
