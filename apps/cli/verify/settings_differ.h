/* SPDX-License-Identifier: BSD-3-Clause */
/** @file In what two sidecars differ that should say the same. */
#ifndef CONUS_CLI_VERIFY_SETTINGS_DIFFER_H
#define CONUS_CLI_VERIFY_SETTINGS_DIFFER_H

#include "options/options.h"

#include <jansson.h>
#include <stdbool.h>

/** How the second of two sidecars came about. Zeroed: in the same place, by the same version and engine. */
struct sidecar_terms {
    const struct arguments *arguments; /**< The recorded command line, which names the outputs; NULL = unknown. */
    const char *root;  /**< What stands before absolute paths that were found elsewhere; NULL = none did. */
    bool other_engine; /**< It was answered by another engine than the recorded one. */
    bool older;        /**< Another version of conus wrote the first one. */
};

/** Compares every value of the sidecar @p recorded with the one of @p again, the sidecar of the same answer made anew:
 * *out is "Settings.resolution is 16 there, and 32 when it is answered again", of the first that differs, or NULL where
 * none does; the caller frees it. Keys that others added beside those of conus do not count, nor do what
 * docs/commands.md lists under `conus verify`. False without memory. */
bool sidecars_differ(char **out, const json_t *recorded, const json_t *again, const struct sidecar_terms *terms);

#endif
