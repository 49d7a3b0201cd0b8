/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file image.h
 * Pictures as named channels of pixels, made, written and compared; the voxels in a selection as a volume.
 */
#ifndef CONUS_PUBLIC_IMAGE_H
#define CONUS_PUBLIC_IMAGE_H

#include <conus/selection.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @name Images
 * @{ */

typedef struct conus_image conus_image; /**< Named float and uint32 channels of one picture. */

/** Makes an image of the device's pixels: channels id (uint32: the atlas's own label), object (uint32), X, Y, Z, t
 * (float, world mm), top row first as in every image, with atlas and pose as attributes. Where a pixel has no hit, id
 * and object are 0, X, Y, Z are NaN and t is infinity. A PNG of it is magnified, in the areas' colours, with a legend.
 * @param[out] out The image; end it with conus_image_destroy().
 * @param selection The selection. Its atlas must still be there.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a ball, which has no pixels. */
CONUS_CHECKED conus_status conus_selection_image(conus_image **out, const conus_selection *selection);

/** Gives the width.
 * @param image The image.
 * @return Pixels. */
CONUS_API uint32_t conus_image_width(const conus_image *image);

/** Gives the height.
 * @param image The image.
 * @return Pixels. */
CONUS_API uint32_t conus_image_height(const conus_image *image);

/** Names channel @p index.
 * @param image The image.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the image. */
CONUS_API const char *conus_image_channel(const conus_image *image, size_t index);

/** Gives the pixels of a float channel.
 * @param image The image.
 * @param channel Its name.
 * @return [height width], top row first; NULL if there is none of that name and type. Borrowed from the image. */
CONUS_API const float *conus_image_floats(const conus_image *image, const char *channel);

/** Gives the pixels of a uint32 channel.
 * @param image The image.
 * @param channel Its name.
 * @return [height width], top row first; NULL if there is none of that name and type. Borrowed from the image. */
CONUS_API const uint32_t *conus_image_uints(const conus_image *image, const char *channel);

/** Writes an image: .exr all channels, .png 8-bit sRGB of R, G, B and A (A not premultiplied); a picture with
 * conus_view.shapes as .svg or .pdf, with the pixels as an image inside, text as text, and a size by the dpi (a 96th
 * inch a pixel without).
 * @param image The image.
 * @param path The ending decides the format.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending; #CONUS_ERROR_IO where the system refuses;
 * #CONUS_ERROR_UNSUPPORTED for .pdf where cairo cannot be loaded. */
CONUS_CHECKED conus_status conus_image_write(const conus_image *image, const char *path);

/** Makes the bytes that conus_image_write() would write.
 * @param[out] data [size] Borrowed until the next call on the image.
 * @param[out] size Bytes.
 * @param image The image.
 * @param format "exr", "png", "svg" or "pdf", as of conus_image_write().
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another format. */
CONUS_CHECKED conus_status conus_image_encode(const uint8_t **data, size_t *size, conus_image *image,
                                              const char *format);

/** Ends an image.
 * @param image NULL is allowed. */
CONUS_API void conus_image_destroy(conus_image *image);
/** @} */

/** @name Masks
 * The voxels in a selection as a volume: masks and maps on the grid of the atlas.
 * @{ */

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

/** Makes a grid of the voxels with their centre in a selection's cone, cylinder or ball (Eq. 10), occluded or not, on
 * the grid of the parcellation, of several that of the object, or else of the pathway.
 * @param[out] out The grid; end it with conus_grid_destroy().
 * @param selection The selection. Its atlas must still be there.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where there is no such grid or object. */
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

/** Gives the content of the grid.
 * @param grid The grid.
 * @return Its pointers are borrowed from the grid. */
CONUS_API conus_grid_view conus_grid_data(const conus_grid *grid);

/** Writes NIfTI-1, whole or not at all, the same bytes for the same grid.
 * @param grid The grid.
 * @param path Ends in .nii or .nii.gz.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending; #CONUS_ERROR_IO where the system refuses. */
CONUS_CHECKED conus_status conus_grid_write(const conus_grid *grid, const char *path);

/** Ends a grid.
 * @param grid NULL is allowed. */
CONUS_API void conus_grid_destroy(conus_grid *grid);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
