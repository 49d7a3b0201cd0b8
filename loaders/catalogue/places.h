/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The table of places in which atlases are looked for. */
#ifndef CONUS_LOADERS_CATALOGUE_PLACES_H
#define CONUS_LOADERS_CATALOGUE_PLACES_H

#include "loaders/catalogue/catalogue.h"

/** Looks in all of them, in their order. */
conus_status places_look(conus_catalogue *catalogue);

#endif
