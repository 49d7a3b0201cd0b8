/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Lists of areas as people write them: names, abbreviations or labels, separated by commas. */
#ifndef CONUS_ATLAS_AREAS_AREA_LIST_H
#define CONUS_ATLAS_AREAS_AREA_LIST_H

#include "base/files/file.h"
#include "base/status.h"
#include "base/text.h"

/** Takes the next entry of a list, which is not empty. */
typedef conus_status (*area_list_take)(void *user, struct text name);

/** Receives each file that a list names, before its entries. */
typedef conus_status (*area_list_file)(void *user, const char *path, const struct bytes *content);

/** Passes each entry of @p list to @p take, up to the first that it refuses. A name with a comma stands in double
 * quotes; @FILE stands for the entries of a file, one per line, in which "#" begins a comment. @p file may be NULL. */
conus_status area_list_read(struct text list, area_list_take take, area_list_file file, void *user);

#endif
