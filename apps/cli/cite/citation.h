/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Citations: the works to cite, and the paragraph and the entries about them. */
#ifndef CONUS_CLI_CITE_CITATION_H
#define CONUS_CLI_CITE_CITATION_H

#include "options/provenance.h"

#include <jansson.h>
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

/** An atlas that was asked. */
struct cited_atlas {
    char *name;         /**< As in rows, or the file's without its ending; to be freed. */
    const char *file;   /**< Name of its file or folder. */
    const char *sha256; /**< The file's; NULL of several files. */
    struct references references;
    bool is_here; /**< Its files were found as they were, and read for references. */
};

struct citation {
    const json_t *sidecar;       /**< NULL of an atlas alone. */
    const char *version;         /**< The version of conus. */
    struct cited_atlas *atlases; /**< [atlas_count] */
    size_t atlas_count;
    json_t *facts, *atlases_asked; /**< Of citation_is_known(); the caller releases them. */
};

/** The method that conus implements, as README.md has it. */
extern const char citation_method[];

/** Gathers the facts of the sidecar. Whether there are sentences for its question. */
bool citation_is_known(struct citation *citation);

/** Whether the method has a part in the answer: it has none where no rays were traced. */
bool citation_has_rays(const struct citation *citation);

/** Writes the paragraph, which has the warnings of the sidecar; one line. */
void citation_methods(FILE *out, const struct citation *citation);
/** Writes the references, a line each. */
void citation_list(FILE *out, const struct citation *citation);
/** Writes them as BibTeX. */
void citation_bibtex(FILE *out, const struct citation *citation);

#endif
