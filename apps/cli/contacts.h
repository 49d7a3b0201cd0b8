/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Contacts of electrodes among the points of a picture, told by their names: LA1, LA2, ... */
#ifndef CONUS_CLI_CONTACTS_H
#define CONUS_CLI_CONTACTS_H

#include "conus/picture.h"

/** Finds out whether all names, which are not NULL, are those of contacts: a word and a number behind it, three or more
 * for each word on average. False without memory. */
bool contacts_are_all(bool *out, const conus_drawn_point *points, size_t count);

/** Gives contacts their electrodes as groups: "LA" to "LA12", "LA-12" and "LA 12". False without memory. In either case
 * contacts_ungroup() ends it. */
bool contacts_group(conus_drawn_point *points, size_t count);
void contacts_ungroup(conus_drawn_point *points, size_t count);

#endif
