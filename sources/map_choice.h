/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One map of a file with several: FILE,map=K and FILE,map=NAME. */
#ifndef CONUS_SOURCES_MAP_CHOICE_H
#define CONUS_SOURCES_MAP_CHOICE_H

#include "base/notes.h"
#include "base/text.h"

/** Which of @p count maps called @p names (NULL entries have no name) @p wanted is: a number from 0, which is not
 * compared with the count, or a name. The first if it is empty; where there are others, a note names them. @p kind is
 * what the maps are, in words. CONUS_ERROR_ARGUMENT for a name that none or several have. */
conus_status map_choice_make(size_t *out, const char *const *names, size_t count, struct text wanted, const char *kind,
                             struct notes *notes);

#endif
