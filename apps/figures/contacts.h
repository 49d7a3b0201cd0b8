/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Rows of a list as points of a picture, among them contacts of electrodes, told by their names: LA1, LA2, ...
 */
#ifndef CONUS_FIGURES_CONTACTS_H
#define CONUS_FIGURES_CONTACTS_H

#include "conus/picture.h"
#include "conus/pose.h"

/** Gives contacts their electrodes as groups, "LA" to "LA12", "LA-12" and "LA 12", if all names, which are not NULL,
 * are those of contacts: a word and a number behind it, three or more for each word on average. Then @p grouped is
 * true, and contacts_ungroup() ends it. False without memory. */
bool contacts_group(bool *grouped, conus_drawn_point *points, size_t count);
void contacts_ungroup(conus_drawn_point *points, size_t count);

/** The ball of a row without an error, with a line to what it points at, if that is something. @p selector finds that,
 * and its range becomes the row's; of a point it is not used. @p radius is that of rows without one. What is in it is
 * the row's. */
conus_status contacts_place(conus_drawn_point *out, const conus_pose_row *row, double radius, conus_selector *selector);

#endif
