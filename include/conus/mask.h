/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file mask.h
 * The voxels in a selection as a volume: masks and maps on the atlas's grid.
 */
#ifndef CONUS_PUBLIC_MASK_H
#define CONUS_PUBLIC_MASK_H

#include <conus/selection.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_grid conus_grid; /**< Numbers on an atlas's voxel grid, to be written. */

/** The meaning of the numbers on a grid. */
typedef enum conus_grid_content {
    CONUS_GRID_MASK_OF_AREAS = 0, /**< 1 in every area's voxels in the region. */
    CONUS_GRID_MASK_OF_REGION,    /**< 1 in all voxels in the region, background too. */
    CONUS_GRID_MAP_OF_LABELS,     /**< The labels of the areas that these voxels are reported as. */
    CONUS_GRID_MAP_OF_VALUES      /**< A pathway's values in the region, on the pathway's grid. */
} conus_grid_content;

/** How conus_selection_grid() fills a grid. */
typedef struct conus_grid_options {
    size_t struct_size;         /**< Its size, as #CONUS_GRID_OPTIONS_INIT sets it; 0 = that of this version. */
    conus_grid_content content; /**< The meaning of the numbers. */
    uint32_t object; /**< Only this object and those below it in the area tree; 0 = all. A map of values needs a pathway
                        here, unless there is only one; a mask of one is made with it, too. Of the region it only
                        chooses the grid, and must be a pathway, or an area where areas lie on several grids. */
} conus_grid_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_GRID_OPTIONS_INIT CONUS_INIT_(conus_grid_options)

/**
 * Makes a grid of the voxels with their centre in a selection's cone, cylinder or ball (Eq. 10), occluded or not, on
 * the grid of the parcellation, of several that of the object, or else of the pathway.
 * @param[out] out The grid; end it with conus_grid_destroy().
 * @param selection The selection. Its atlas must still be there.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where there is no such grid or object.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_selection_grid(conus_grid **out, const conus_selection *selection,
                                                const conus_grid_options *options);

/** The type of the numbers on a grid. */
typedef enum conus_number {
    CONUS_NUMBER_UINT8 = 0, /**< uint8_t. */
    CONUS_NUMBER_UINT16,    /**< uint16_t. */
    CONUS_NUMBER_UINT32,    /**< uint32_t. */
    CONUS_NUMBER_FLOAT32    /**< float. */
} conus_number;

/** Content of a grid. */
typedef struct conus_grid_view {
    size_t dim[3];               /**< Voxels along i, j, k. */
    double world_from_voxel[16]; /**< Maps voxel indices to world mm. */
    int space_code;              /**< NIfTI's, as the atlas's; where that is unknown 2 (aligned), or 0 where the
                                      grid lies where readers guess it. */
    conus_number number;         /**< Type of the numbers. */
    const void *data;            /**< [count] numbers, i fastest; 0 outside of the selection. */
    uint64_t count;              /**< dim0*dim1*dim2. */
    const char *description;     /**< One line. */
} conus_grid_view;

/**
 * Gives the content of the grid.
 * @param grid The grid.
 * @return Its pointers are borrowed from the grid.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API conus_grid_view conus_grid_data(const conus_grid *grid);

/**
 * Writes NIfTI-1, whole or not at all, the same bytes for the same grid.
 * @param grid The grid.
 * @param path Ends in .nii or .nii.gz.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending; #CONUS_ERROR_IO where the system refuses.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_grid_write(const conus_grid *grid, const char *path);

/**
 * Ends a grid.
 * @param grid NULL is allowed.
 * @threads One at a time for each @p grid.
 * @since 0.1
 */
CONUS_API void conus_grid_destroy(conus_grid *grid);

#ifdef __cplusplus
}
#endif

#endif
