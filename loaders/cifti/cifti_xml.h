/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The XML of a .dlabel.nii: maps with their tables, and brain models. */
#ifndef CONUS_LOADERS_CIFTI_CIFTI_XML_H
#define CONUS_LOADERS_CIFTI_CIFTI_XML_H

#include "loaders/cifti/cifti.h"

/** Parses the document @p text of a matrix of @p maps maps and out->count grayordinates. Fills maps, models and volume
 * of @p out, which is the caller's to finish, also on failure. Errors name the line. */
conus_status cifti_xml_parse(struct cifti *out, struct text text, size_t maps, uint64_t max_memory);

#endif
