/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Citations: the works to cite, and the paragraph and the entries about them. */
#ifndef CONUS_CLI_CITE_CITATION_H
#define CONUS_CLI_CITE_CITATION_H

#include "conus/atlas.h"
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

/** Adds the reference of the published atlas that @p atlas is, if conus knows it. */
void references_identify(struct references *out, const conus_atlas *atlas);
void references_finish(struct references *references);

/** An atlas that was asked. */
struct cited_atlas {
    char *name;         /**< As in rows, or the file's without its ending; to be freed. */
    const char *file;   /**< Name of its file or folder. */
    const char *sha256; /**< The file's; NULL of several files. */
    struct references references;
    bool is_here; /**< Its files were found as they were, and read for references. */
};

/** The name of a file without its ending: "aal" of "aal.nii.gz". NULL without memory; the caller frees it. */
char *cited_stem(const char *path);

/** Describes the atlas that was loaded as @p given, which is the installed one of a name (NULL = it is a path), at @p
 * path. Returns the exit code and prints an error unless it is 0; @p out is
 * the caller's in any case. */
int cited_atlas_find(struct cited_atlas *out, const char *given, const char *installed, const char *path,
                     const conus_atlas *atlas);

struct citation {
    const json_t *sidecar;       /**< NULL of an atlas alone. */
    const char *version;         /**< The version of conus. */
    struct cited_atlas *atlases; /**< [atlas_count] */
    size_t atlas_count;
    json_t *facts, *atlases_asked; /**< Of citation_is_known(). */
};

/** Gathers the facts of the sidecar. Whether there are sentences for its question. */
bool citation_is_known(struct citation *citation);

/** Whether a result is of no atlas. */
bool citation_has_no_atlas(const struct citation *citation);
/** Whether the method has a part in the answer: it has none where no rays were traced. */
bool citation_has_rays(const struct citation *citation);

/** "name" or "source" of the published error of the poses; NULL where there is none. */
const char *citation_error(const struct citation *citation, const char *key);

/** Frees all but the sidecar. */
void citation_finish(struct citation *citation);

/** Writes the paragraph in lines, and the references. Returns the exit code and prints an error unless it is 0. */
int citation_text(FILE *out, const struct citation *citation);

/** Writes the paragraph, which has the warnings of the sidecar; one line. */
void citation_methods(FILE *out, const struct citation *citation);
/** Writes them as BibTeX. */
void citation_bibtex(FILE *out, const struct citation *citation);

#endif
