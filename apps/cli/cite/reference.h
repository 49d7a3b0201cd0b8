/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the files of an atlas say that should be cited. */
#ifndef CONUS_CLI_CITE_REFERENCE_H
#define CONUS_CLI_CITE_REFERENCE_H

#include <stddef.h>

enum { REFERENCES = 16, REFERENCE_SIZE = 2000 /* bytes of one, the rest is cut */ };

/** Texts of one line each, UTF-8. */
struct references {
    char *items[REFERENCES];
    size_t count;
    char *source; /**< Path of the file that has them; NULL if there is none. */
};

/** Reads what the manifest at @p path says, or BrainGlobe's metadata.json of the folder or stack @p path, or the BIDS
 * descriptions of a file whose name has tpl- or atlas-, in its folder or the nearest of four above. @p out is the
 * caller's to references_finish(). */
void references_find(struct references *out, const char *path);
void references_finish(struct references *references);

#endif
