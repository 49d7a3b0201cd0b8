/* SPDX-License-Identifier: BSD-3-Clause */
/** @file In what two sidecars differ that should say the same. */
#ifndef CONUS_CLI_VERIFY_SETTINGS_DIFFER_H
#define CONUS_CLI_VERIFY_SETTINGS_DIFFER_H

#include <jansson.h>

/** "Settings.resolution is 16 there, and 32 when it is answered again": the first difference in space, settings,
 * queries and atlases of @p recorded and @p again; where files lie, their notes and the instructions of the processor
 * do not count. NULL if there is none, or without memory. The caller frees it. */
char *settings_difference(const json_t *recorded, const json_t *again);

#endif
