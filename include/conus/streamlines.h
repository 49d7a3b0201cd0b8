/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file streamlines.h
 * Streamlines as bundles of an atlas, what an atlas has of tractograms, and which streamlines come into a cone.
 */
#ifndef CONUS_PUBLIC_STREAMLINES_H
#define CONUS_PUBLIC_STREAMLINES_H

#include <conus/arrays.h>
#include <conus/selection.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @name Bundles
 * @{ */

/** How conus_atlas_add_streamlines() and conus_atlas_add_polylines() take streamlines. */
typedef struct conus_streamlines_options {
    size_t struct_size; /**< Its size, as #CONUS_STREAMLINES_OPTIONS_INIT sets it; 0 = that of this version. */
    double radius;      /**< A ray hits what is nearer than this to a streamline (Eq. 18), mm, up to 100; 0 = 0.5. */
    const char *name;   /**< Name of the bundle; where the file has groups, of the streamlines that are in none, and the
                           start of a group's name if another object has that. NULL = the file's name without its
                           ending. */
    uint64_t max_memory;    /**< Bytes that points, scalars and groups of a file may take; 0 = 8 GiB. */
    conus_log log;          /**< As conus_load_options.log. */
    void *log_user;         /**< Passed to @p log. */
    conus_file_space space; /**< The axes of the coordinates, which count before those that a file states; TrackVis's
                               and DSI Studio's headers place them, in RAS. From memory they are RAS unless this says
                               LPS. */
} conus_streamlines_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_STREAMLINES_OPTIONS_INIT CONUS_INIT_(conus_streamlines_options)

/** Adds the streamlines of a tractogram as a selectable bundle, or as one for each group of the file, and one for those
 * in no group. The content of the file decides about its format; docs/formats.md has the formats. Streamlines lie where
 * the file has them: a transform moves what was added before. A note says where they hardly lie in the atlas's space,
 * and where they lay better before the atlas was moved.
 * @param atlas The atlas; unchanged on failure.
 * @param path The tractogram.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO or #CONUS_ERROR_DATA where the file cannot be read, is damaged, or has a
 * coordinate beyond 1e9 mm; #CONUS_ERROR_UNSUPPORTED for a valid file beyond this library; #CONUS_ERROR_MEMORY above
 * max_memory; #CONUS_ERROR_ARGUMENT for a radius out of its range, for the name of another bundle or pathway, and for
 * LPS where the header places the points. */
CONUS_CHECKED conus_status conus_atlas_add_streamlines(conus_atlas *atlas, const char *path,
                                                       const conus_streamlines_options *options);

/** Numbers that streamlines have, by name: FA, say. */
typedef struct conus_tract_scalar {
    size_t struct_size;  /**< Its size, as #CONUS_TRACT_SCALAR_INIT sets it; 0 = that of this version. */
    const char *name;    /**< UTF-8, one line. */
    bool per_point;      /**< Else per streamline. */
    uint32_t components; /**< 1 or more numbers per point or streamline. */
    const float *values; /**< [points or streamlines, components]; NaN = not known. */
} conus_tract_scalar;

/** The size of the struct that the caller was compiled with. */
#define CONUS_TRACT_SCALAR_INIT CONUS_INIT_(conus_tract_scalar)

/** Streamlines in memory. */
typedef struct conus_polylines {
    size_t struct_size;      /**< Its size, as #CONUS_POLYLINES_INIT sets it; 0 = that of this version. */
    const void *points;      /**< [point_count 3] x, y, z, world mm, aligned as its type is; copied. */
    conus_scalar type;       /**< #CONUS_SCALAR_FLOAT32 or #CONUS_SCALAR_FLOAT64; kept as float. */
    uint64_t point_count;    /**< In all streamlines together. */
    const uint64_t *first;   /**< [streamline_count + 1] Streamline k has the points first[k] to first[k + 1] - 1: from
                                0, ascending, the last is point_count. Copied. */
    size_t streamline_count; /**< How many. */
    const conus_tract_scalar *scalars; /**< [scalar_count], struct_size set; copied. */
    size_t scalar_count;               /**< 0 = none. */
    const char *name;                  /**< Stands for a path in messages and reports; NULL = "array". */
} conus_polylines;

/** None, and the size of the struct that the caller was compiled with. */
#define CONUS_POLYLINES_INIT CONUS_INIT_(conus_polylines)

/** Adds streamlines from memory as a bundle, as conus_atlas_add_streamlines() does of a file.
 * @param atlas The atlas; unchanged on failure.
 * @param polylines The streamlines.
 * @param options Its name counts before that of @p polylines; NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a type or radius out of its range, for a scalar without name, components
 * or values, and for the name of another bundle or pathway; #CONUS_ERROR_DATA for a coordinate beyond 1e9 mm and a @p
 * first that does not ascend. */
CONUS_CHECKED conus_status conus_atlas_add_polylines(conus_atlas *atlas, const conus_polylines *polylines,
                                                     const conus_streamlines_options *options);

/** Gives numbers that a tractogram has of its points or streamlines.
 * @param[in,out] out Its struct_size is read; unchanged on failure. Name and values are borrowed until the atlas is
 * changed or ends.
 * @param atlas The atlas.
 * @param index Of the tractogram.
 * @param scalar From 0, in the order of the file.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT past the last. */
CONUS_CHECKED conus_status conus_atlas_tractogram_scalar(conus_tract_scalar *out, const conus_atlas *atlas,
                                                         size_t index, size_t scalar);
/** @} */

/** @name Streamlines in a cone
 * @{ */

typedef struct conus_streamline_list conus_streamline_list; /**< Streamlines of an atlas, each once. */

/** Lists the streamlines that come into the cone, cylinder or ball of a selection (Eq. 19), with or without all layers.
 * @param[out] out The list; end it with conus_streamline_list_destroy().
 * @param selection Its atlas must outlive the list.
 * @param object Number of a bundle; 0 = of all bundles that are not hidden.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an object that is no bundle or is hidden, and for 0 where there is no
 * bundle. */
CONUS_CHECKED conus_status conus_selection_streamlines(conus_streamline_list **out, const conus_selection *selection,
                                                       uint32_t object);

/** The content of a list. */
typedef struct conus_streamline_list_view {
    size_t count;               /**< How many streamlines. */
    const uint32_t *tractogram; /**< [count] Of which tractogram each one is, from 0: the rows of conus_atlas_list(),
                                   "tractograms"; ascending. */
    const uint32_t *number;     /**< [count] Which streamline of that it is, from 0; ascending within one. */
    uint64_t points;            /**< In all of them. */
} conus_streamline_list_view;

/** Gives what is in a list.
 * @param list NULL has nothing.
 * @return Its pointers are borrowed from the list. */
CONUS_API conus_streamline_list_view conus_streamline_list_data(const conus_streamline_list *list);

/** Copies the points of the streamlines, one after the other, whole streamlines: also what lies outside of the cone.
 * @param[out] points [points of all 3] x, y, z, world mm, as the atlas has them.
 * @param[out] first [count + 1] Where each streamline begins in @p points, and their end; NULL = not wanted.
 * @param list The list. */
CONUS_API void conus_streamline_list_points(float *points, uint64_t *first, const conus_streamline_list *list);

/** Writes a tractogram of MRtrix (Float32LE), whole or not at all, the same bytes for the same streamlines.
 * @param list The list.
 * @param path Ends in .tck.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending; #CONUS_ERROR_IO where the system refuses. */
CONUS_CHECKED conus_status conus_streamline_list_write(const conus_streamline_list *list, const char *path);

/** Ends a list.
 * @param list NULL is allowed. */
CONUS_API void conus_streamline_list_destroy(conus_streamline_list *list);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
