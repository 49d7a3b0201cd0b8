/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What `conus info --format json` writes. */
#ifndef CONUS_CLI_ANSWERS_INFO_JSON_H
#define CONUS_CLI_ANSWERS_INFO_JSON_H

#include <conus/conus.h>

#include <jansson.h>

/** The atlas as a JSON text with a final newline; NULL without memory. The caller frees it. @p installed: what its name
 * meant; NULL = it was a path. */
char *info_json(const conus_atlas *atlas, const conus_installed *installed);

/** An installed atlas as a JSON object; NULL without memory. */
json_t *info_json_installed(const conus_installed *atlas);

/** A text of any bytes; what is not UTF-8 is taken as ISO-8859-1, as in the library's reports. NULL without memory. */
json_t *info_json_bytes(const char *bytes);

#endif
