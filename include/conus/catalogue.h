/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file catalogue.h
 * The atlases that are installed on this computer, by name. docs/commands.md says in which folders they are looked for.
 */
#ifndef CONUS_PUBLIC_CATALOGUE_H
#define CONUS_PUBLIC_CATALOGUE_H

#include <conus/status.h>

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_catalogue conus_catalogue; /**< The atlases found, and the places searched. */

/** How conus_catalogue_create() looks. */
typedef struct conus_catalogue_options {
    size_t struct_size; /**< Its size, as #CONUS_CATALOGUE_OPTIONS_INIT sets it; 0 = that of this version. */
    conus_log log;      /**< Receives the notes of conus_catalogue_note(); NULL = no callback. */
    void *log_user;     /**< Passed to @p log. */
} conus_catalogue_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CATALOGUE_OPTIONS_INIT CONUS_INIT_(conus_catalogue_options)

/**
 * Looks for atlases in the folders that the environment names: $CONUS_ATLAS_PATH, and where mricron, FSL, FreeSurfer,
 * BrainGlobe, TemplateFlow, AFNI, SPM, CAT12, nilearn and MRIcroGL keep theirs. Reads names, the headers of volumes and
 * the XMLs of FSL atlases, no voxel. A folder that cannot be read, or that holds more than is looked at, is a note.
 * @param[out] out The catalogue; end it with conus_catalogue_destroy().
 * @param options NULL = defaults.
 * @return #CONUS_OK, also where nothing is found.
 * @threads Any, while none changes the environment.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_catalogue_create(conus_catalogue **out, const conus_catalogue_options *options);

/**
 * Ends a catalogue.
 * @param catalogue NULL is allowed.
 * @threads One at a time for each @p catalogue.
 * @since 0.1
 */
CONUS_API void conus_catalogue_destroy(conus_catalogue *catalogue);

/** An atlas that is installed. */
typedef struct conus_installed {
    const char *name;   /**< "aal". UTF-8, one line, without '/'. Not always the only one of that name. */
    const char *source; /**< Whose folder it is in: "mricron", "fsl"; "own" for $CONUS_ATLAS_PATH. */
    const char *kind;   /**< "volume", "probabilities" (an FSL atlas), "surface", "surfaces" (a folder), "scene" (a
                           manifest) or "pack". */
    const char *path;   /**< For conus_atlas_load(). Bytes, not always UTF-8. */
    const char *labels; /**< For conus_load_options.labels; NULL = conus_atlas_load() finds the labels. */
    double spacing[3];  /**< Edge lengths of a voxel, mm; 0 where they are not known. */
} conus_installed;

/**
 * Counts the atlases.
 * @param catalogue NULL counts 0.
 * @return How many there are.
 * @threads Any.
 * @since 0.1
 */
CONUS_API size_t conus_catalogue_count(const conus_catalogue *catalogue);

/**
 * Gives atlas @p index. Those of one source stand together; $CONUS_ATLAS_PATH comes first.
 * @param catalogue The catalogue.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the catalogue.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const conus_installed *conus_catalogue_atlas(const conus_catalogue *catalogue, size_t index);

/**
 * Finds the one atlas that is called @p name, or "source:name". If there is none, upper and lower case are taken for
 * the same, and so are names that differ only in '-', '_', '.', '+' and spaces.
 * @param[out] out Borrowed from the catalogue.
 * @param catalogue The catalogue.
 * @param name What to find.
 * @return #CONUS_OK; #CONUS_ERROR_IO if there is none, with the closest names in the message; #CONUS_ERROR_ARGUMENT,
 * with the candidates in the message, if several files have that name.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_catalogue_find(const conus_installed **out, const conus_catalogue *catalogue,
                                                const char *name);

/**
 * Finds the one image that is called @p name, as conus_catalogue_find() finds an atlas: a volume in the folders of the
 * catalogue that counts as no labels, such as mricron's ch2 or FSL's MNI152_T1_1mm.
 * @param[out] out Borrowed from the catalogue; without labels.
 * @param catalogue The catalogue.
 * @param name What to find: the file's name without its ending.
 * @return As conus_catalogue_find().
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_catalogue_find_image(const conus_installed **out, const conus_catalogue *catalogue,
                                                      const char *name);

/**
 * Says whether what a user gave as an atlas or image is a path, which then is no name: it has a '/', or there is such a
 * file or folder, also where ",volume=K", ",map=K" and the like stand behind it.
 * @param text What the user gave.
 * @return Whether it is a path for conus_atlas_load(). If not, ask conus_catalogue_find().
 * @threads Any.
 * @since 0.1
 */
CONUS_API bool conus_atlas_is_path(const char *text);

/** A folder in which atlases are looked for. */
typedef struct conus_catalogue_place {
    const char *source; /**< As conus_installed.source. */
    const char *rule;   /**< How it is named: "$FSLDIR/data/atlases". */
    const char *path;   /**< The folder; "" where the environment does not say which. */
    bool there;         /**< There is such a folder. */
} conus_catalogue_place;

/**
 * Counts the places in which was looked, there or not.
 * @param catalogue NULL counts 0.
 * @return How many there are.
 * @threads Any.
 * @since 0.1
 */
CONUS_API size_t conus_catalogue_place_count(const conus_catalogue *catalogue);

/**
 * Gives place @p index, in the order in which they were looked at.
 * @param catalogue The catalogue.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the catalogue.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const conus_catalogue_place *conus_catalogue_place_at(const conus_catalogue *catalogue, size_t index);

/**
 * Counts the notes about what was left out.
 * @param catalogue NULL counts 0.
 * @return How many there are.
 * @threads Any.
 * @since 0.1
 */
CONUS_API size_t conus_catalogue_note_count(const conus_catalogue *catalogue);

/**
 * Gives note @p index.
 * @param catalogue The catalogue.
 * @param index From 0.
 * @return One line; NULL past the last. Borrowed from the catalogue.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const char *conus_catalogue_note(const conus_catalogue *catalogue, size_t index);

#ifdef __cplusplus
}
#endif

#endif
