/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The labelled volumes that an FSL atlas XML names. */
#ifndef CONUS_LOADERS_CATALOGUE_FSL_H
#define CONUS_LOADERS_CATALOGUE_FSL_H

#include "loaders/catalogue/catalogue.h"

/** Adds those that are there: the finest under the XML's name, others with "-2mm" behind it, all with the XML as their
 * label table. An XML of another kind, or damaged, is passed over; one without such a volume is a note. */
conus_status fsl_look(conus_catalogue *catalogue, const char *xml_path);

#endif
