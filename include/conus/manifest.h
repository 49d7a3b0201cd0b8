/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file manifest.h
 * A manifest joins parcellations, surfaces, pathways and a context into one atlas.
 */
#ifndef CONUS_PUBLIC_MANIFEST_H
#define CONUS_PUBLIC_MANIFEST_H

#include <conus/status.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How conus_manifest_write() reads. */
typedef struct conus_manifest_options {
    size_t struct_size;  /**< Its size, as #CONUS_MANIFEST_OPTIONS_INIT sets it; 0 = that of this version. */
    uint64_t max_memory; /**< Largest file, in bytes; 0 = 8 GiB. */
    conus_log log;       /**< Receives as what each file was taken, a line each; NULL = silent. */
    void *log_user;      /**< Passed to @p log. */
} conus_manifest_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_MANIFEST_OPTIONS_INIT CONUS_INIT_(conus_manifest_options)

/**
 * Writes a first manifest (docs/formats.md) of what lies in the folder of @p path and the folders in it: volumes, FSL
 * atlases, surfaces, BrainGlobe folders. It guesses what a volume is for. A file that is there is never replaced.
 * @param path NAME.atlas.json.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO where the system refuses, or the file is there; #CONUS_ERROR_DATA where the folder
 * holds nothing for a manifest.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_manifest_write(const char *path, const conus_manifest_options *options);

#ifdef __cplusplus
}
#endif

#endif
