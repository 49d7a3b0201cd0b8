/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file arrays.h
 * Atlases from memory: voxels, labels, surfaces and scalar maps that a program already has.
 */
#ifndef CONUS_PUBLIC_ARRAYS_H
#define CONUS_PUBLIC_ARRAYS_H

#include <conus/atlas.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The type of a number in an array. */
typedef enum conus_scalar {
    CONUS_SCALAR_UINT8 = 1, /**< uint8_t */
    CONUS_SCALAR_INT8,      /**< int8_t */
    CONUS_SCALAR_UINT16,    /**< uint16_t */
    CONUS_SCALAR_INT16,     /**< int16_t */
    CONUS_SCALAR_UINT32,    /**< uint32_t */
    CONUS_SCALAR_INT32,     /**< int32_t */
    CONUS_SCALAR_UINT64,    /**< uint64_t */
    CONUS_SCALAR_INT64,     /**< int64_t */
    CONUS_SCALAR_FLOAT32,   /**< float */
    CONUS_SCALAR_FLOAT64    /**< double */
} conus_scalar;

/** A volume in memory. Everything is needed that is not called optional. */
typedef struct conus_voxels {
    size_t struct_size;          /**< Its size, as #CONUS_VOXELS_INIT sets it; 0 = that of this version. */
    const void *data;            /**< Voxel (0, 0, 0). Only read, and only during the call. */
    conus_scalar type;           /**< Type of each voxel. Voxels need no alignment. */
    bool swapped;                /**< They have the other byte order than this machine. */
    size_t dim[3];               /**< Voxels along i, j, k; each at least 1. */
    ptrdiff_t stride[3];         /**< Bytes from a voxel to the next along i, j, k; may be negative. All 0 = i fastest,
                                    without gaps. */
    double world_from_voxel[16]; /**< Column-major; maps voxel indices (centres at whole numbers) to world mm. */
    int space_code;              /**< Optional: NIfTI's code of the space that it maps to, 4 for MNI 152. */
    const char *name;            /**< Optional: stands for a path in messages and reports; NULL = "array". */
} conus_voxels;

/** No voxels, and the size of the struct that the caller was compiled with. */
#define CONUS_VOXELS_INIT CONUS_INIT_(conus_voxels)

/** A row of a label table: an area and its name. */
typedef struct conus_label {
    uint32_t number;          /**< The atlas's own label of the area; not 0, which is background. */
    const char *name;         /**< UTF-8; NULL = it is called by its number. */
    const char *abbreviation; /**< UTF-8; NULL = none. */
    char hemisphere;          /**< 'L', 'R', 'B' (both), or 0 = unknown. */
    bool has_rgb;             /**< It has the colour @p rgb; else one of the palette. */
    uint8_t rgb[3];           /**< sRGB. */
    uint32_t parent;          /**< Label of the area that contains it in the area tree; 0 = none. */
} conus_label;

/** How conus_atlas_create() takes voxels. */
typedef struct conus_create_options {
    size_t struct_size; /**< Its size, as #CONUS_CREATE_OPTIONS_INIT sets it; 0 = that of this version. */
    bool labels_anyway; /**< Each value is a label, even where the values look like the grey values of an image. */
    conus_log log;      /**< As conus_load_options.log; the path is conus_voxels.name. */
    void *log_user;     /**< Passed to @p log. */
} conus_create_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CREATE_OPTIONS_INIT CONUS_INIT_(conus_create_options)

/**
 * Makes an atlas of labelled voxels, as conus_atlas_load() does of a file. Areas are the labels that voxels have, and
 * those that have a name. Add surfaces, then scalar maps and a context, before a selector is made.
 * @param[out] out The atlas; end it with conus_atlas_destroy().
 * @param voxels Whole numbers from 0 (background) to 4294967295, copied; NULL = an atlas without voxels, for surfaces.
 * @param labels [label_count] Up to 1048576, in any order, copied; of several with one number the first counts.
 *     NULL = none.
 * @param label_count How many.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a type, dimension, label or hemisphere out of its range, and for labels
 * without voxels; #CONUS_ERROR_DATA for a voxel that is no label, a matrix that has no inverse or another last row
 * than 0 0 0 1, and for voxels that look like an image unless labels_anyway is set.
 */
CONUS_CHECKED conus_status conus_atlas_create(conus_atlas **out, const conus_voxels *voxels, const conus_label *labels,
                                              size_t label_count, const conus_create_options *options);

/** Adds an area that is a surface.
 * @param atlas The atlas, without pathways yet; unchanged on failure.
 * @param area Its number is that of no other area, its parent 0 or that of an area that is there.
 * @param positions [3 vertex_count] x, y, z of each vertex, world mm; copied.
 * @param vertex_count How many vertices.
 * @param triangles [3 triangle_count] Indices of vertices, counter-clockwise from outside; copied.
 * @param triangle_count How many triangles; at least 1.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a label as above and once there is a pathway; #CONUS_ERROR_DATA for an
 * index out of range, or a coordinate that is not finite or beyond 1e9 mm. */
CONUS_CHECKED conus_status conus_atlas_add_surface(conus_atlas *atlas, const conus_label *area, const float *positions,
                                                   size_t vertex_count, const uint32_t *triangles,
                                                   size_t triangle_count);

/** Adds scalar voxels as a pathway, as conus_atlas_add_pathway() does of a file.
 * @param atlas The atlas; unchanged on failure.
 * @param voxels Copied. Values that are not finite count as 0, and a note says how many.
 * @param options Its name counts before that of @p voxels; NULL = defaults. max_memory has no meaning.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a type, a dimension or a threshold out of its range; #CONUS_ERROR_DATA
 * for voxels without a value above 0 and a matrix that has no inverse or another last row than 0 0 0 1. */
CONUS_CHECKED conus_status conus_atlas_add_pathway_voxels(conus_atlas *atlas, const conus_voxels *voxels,
                                                          const conus_pathway_options *options);

/** Sets scalar voxels as the context, as conus_atlas_set_context() does with a file.
 * @param atlas The atlas; unchanged on failure.
 * @param voxels As for conus_atlas_add_pathway_voxels().
 * @param options NULL = defaults. max_memory has no meaning.
 * @return #CONUS_OK; as conus_atlas_add_pathway_voxels(). */
CONUS_CHECKED conus_status conus_atlas_set_context_voxels(conus_atlas *atlas, const conus_voxels *voxels,
                                                          const conus_context_options *options);

#ifdef __cplusplus
}
#endif

#endif
