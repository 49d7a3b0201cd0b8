/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What `conus info --format json` writes. */
#ifndef CONUS_CLI_ANSWERS_INFO_JSON_H
#define CONUS_CLI_ANSWERS_INFO_JSON_H

#include <conus/conus.h>

/** The atlas as a JSON text with a final newline; NULL without memory. The caller frees it. */
char *info_json(const conus_atlas *atlas);

#endif
