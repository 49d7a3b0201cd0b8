/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file pack.h
 * Packs: a loaded atlas in one file, which opens at once. conus_atlas_load() opens it like any other atlas.
 */
#ifndef CONUS_PUBLIC_PACK_H
#define CONUS_PUBLIC_PACK_H

#include <conus/atlas.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The ending of a pack's name. */
#define CONUS_PACK_ENDING ".conus"

/** How conus_atlas_save() writes. */
typedef struct conus_save_options {
    size_t struct_size;         /**< Its size, as #CONUS_SAVE_OPTIONS_INIT sets it; 0 = that of this version. */
    const char *words;          /**< How it is packed again, for people: a command line. NULL = not known. */
    const char *const *sources; /**< [source_count] Files that were read, in addition to those that the atlas knows,
                                     which lacks the voxels of a header of text. */
    size_t source_count;        /**< How many. */
} conus_save_options;

/** The size of the struct that the caller was compiled with. */
#define CONUS_SAVE_OPTIONS_INIT CONUS_INIT_(conus_save_options)

/**
 * Writes a loaded atlas as it is to one file, whole or not at all. The file is for this machine's kind and this
 * format's builds (docs/formats.md); it has the SHA-256 of each source, and says at its opening which have changed.
 * @param path Ends in ".conus". What is there is replaced.
 * @param atlas The atlas; not one that was opened from a pack.
 * @param options NULL for all defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending, or an atlas of a pack; #CONUS_ERROR_IO where the file
 * cannot be written, or a source is no longer as it was read.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_save(const char *path, const conus_atlas *atlas,
                                            const conus_save_options *options);

/** What a pack says of itself. */
typedef struct conus_pack_info {
    const char *path;    /**< As it was opened. */
    const char *sha256;  /**< Of all behind its head, as the head has it, in hexadecimal. */
    const char *words;   /**< How it is packed again; "" = not known. */
    const char *version; /**< The version of conus that packed it. */
    uint64_t size;       /**< Bytes. */
    size_t source_count; /**< How many files it was packed from. */
} conus_pack_info;

/**
 * Gives the pack that an atlas was opened from.
 * @param atlas NULL has none.
 * @return NULL where it was not. Borrowed until the atlas ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const conus_pack_info *conus_atlas_pack_info(const conus_atlas *atlas);

/** What has become of a source since. */
typedef enum conus_source_state {
    CONUS_SOURCE_SAME = 0, /**< Its size and time, or its bytes, are the same. */
    CONUS_SOURCE_CHANGED,  /**< Its bytes are others. */
    CONUS_SOURCE_MISSING   /**< There is no such file. */
} conus_source_state;

/**
 * Gives source @p index of the pack, as it was when the pack was opened.
 * @param[out] state What has become of it; unchanged where there is none. May be NULL.
 * @param atlas The atlas.
 * @param index From 0.
 * @return Its path, as it was read; NULL past the last. Borrowed until the atlas ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const char *conus_atlas_pack_source(conus_source_state *state, const conus_atlas *atlas, size_t index);

#ifdef __cplusplus
}
#endif

#endif
