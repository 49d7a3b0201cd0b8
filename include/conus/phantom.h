/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file phantom.h
 * Synthetic atlases from which every answer follows in closed form.
 */
#ifndef CONUS_PUBLIC_PHANTOM_H
#define CONUS_PUBLIC_PHANTOM_H

#include <conus/status.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The grid of a phantom. */
typedef struct conus_phantom_options {
    size_t struct_size; /**< Its size, as #CONUS_PHANTOM_OPTIONS_INIT sets it; 0 = that of this version. */
    uint32_t size; /**< Voxels along the longest edge, 16 to 512; 0 = 64. Size times the smallest spacing is the cube
                      around the origin for which the shapes are made: 64 mm, or scaled. */
    double spacing[3]; /**< mm; zeros = 1, 1, 1. At least 4 voxels must fit along every edge. */
    double oblique;    /**< Turns the grid about (1, 1, 1) by this angle, radians. */
    bool flip[3];      /**< Lets i, j, k grow towards left, posterior, inferior. */
} conus_phantom_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_PHANTOM_OPTIONS_INIT CONUS_INIT_(conus_phantom_options)

/** A kind of phantom. */
typedef struct conus_phantom_info {
    const char *name;        /**< For conus_phantom_write(). */
    const char *description; /**< One line. */
} conus_phantom_info;

/**
 * Gives entry @p index of the table of phantoms.
 * @param index From 0.
 * @return NULL past the last. Static.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const conus_phantom_info *conus_phantom(size_t index);

/**
 * Writes a phantom: KIND.nii.gz, its label table KIND.tsv, and KIND.json with the shapes in world mm; of the kinds
 * brain and bundle, which take no options, other files (docs/formats.md).
 * @param kind A name of conus_phantom().
 * @param folder Made if missing.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another kind or an option out of its range; #CONUS_ERROR_IO where the
 * system refuses.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_phantom_write(const char *kind, const char *folder,
                                               const conus_phantom_options *options);

#ifdef __cplusplus
}
#endif

#endif
