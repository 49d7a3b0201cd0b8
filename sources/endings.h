/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The endings of names: what a file may be given as, by its name alone. What it is its first bytes say
 * (source.h). Programs have it beside the library. */
#ifndef CONUS_SOURCES_ENDINGS_H
#define CONUS_SOURCES_ENDINGS_H

#include <stdbool.h>
#include <stddef.h>

/** What a file is given as. The same bytes may be another thing in each. */
enum role {
    ROLE_VOLUME = 1 << 0,
    ROLE_SURFACE = 1 << 1,
    ROLE_VERTEX_LABELS = 1 << 2, /**< Also surfaces, which may have none. */
    ROLE_TRACTS = 1 << 3,
    ROLE_TRANSFORM = 1 << 4,
    ROLE_SCENE = 1 << 5,  /**< An atlas that names other files, or has several parts. */
    ROLE_REGION = 1 << 6, /**< A mesh as a region of interest. */
    ROLE_POSES = 1 << 7, /**< Of formats without tables and lists, whose readers tell themselves apart. A format without
                            an id says in its words why such a file holds none. */
    ROLES_ATLAS = ROLE_VOLUME | ROLE_SURFACE | ROLE_VERTEX_LABELS | ROLE_SCENE
};

/** Length of the longest ending of the first @p length bytes of @p name that a file of one of @p roles may have, ".gz"
 * behind it with it; 0 = it has none. Case does not count, and something stands before it. */
size_t ending_length(const char *name, size_t length, unsigned roles);

/** Length of these bytes without that ending, or without ".gz" where there is none. */
size_t stem_length(const char *name, size_t length, unsigned roles);

/** Length of @p path without the ending of a volume (.nii.gz, .mgz, ...), if it has one. */
size_t volume_stem_length(const char *path);

/** The ending behind @p ending, one of @p roles, in the order in which folders are searched; the first behind NULL.
 * NULL behind the last. Each may have ".gz" behind it. */
const char *ending_next(const char *ending, unsigned roles);

#endif
