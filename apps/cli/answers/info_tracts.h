/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The tractograms of an atlas, as `conus info` shows them. */
#ifndef CONUS_CLI_ANSWERS_INFO_TRACTS_H
#define CONUS_CLI_ANSWERS_INFO_TRACTS_H

#include <conus/conus.h>

#include <jansson.h>
#include <stdio.h>

/** A paragraph for people about each, with an empty line before it. */
void info_tracts_put(FILE *out, const conus_atlas *atlas);

/** The same as a JSON array; NULL without memory. */
json_t *info_tracts_json(const conus_atlas *atlas);

#endif
