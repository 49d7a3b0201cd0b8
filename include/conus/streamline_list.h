/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file streamline_list.h
 * Which streamlines come into a cone, and files of them.
 */
#ifndef CONUS_PUBLIC_STREAMLINE_LIST_H
#define CONUS_PUBLIC_STREAMLINE_LIST_H

#include <conus/selection.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_streamline_list conus_streamline_list; /**< Streamlines of an atlas, each once. */

/**
 * Lists the streamlines that come into the cone, cylinder or ball of a selection (Eq. 19), with or without all layers.
 * @param[out] out The list; end it with conus_streamline_list_destroy().
 * @param selection Its atlas must outlive the list.
 * @param object Number of a bundle; 0 = of all bundles that are not hidden.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an object that is no bundle or is hidden, and for 0 where there is no
 * bundle.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_selection_streamlines(conus_streamline_list **out, const conus_selection *selection,
                                                       uint32_t object);

/** The content of a list. */
typedef struct conus_streamline_list_view {
    size_t count;               /**< How many streamlines. */
    const uint32_t *tractogram; /**< [count] Of which tractogram each one is, as conus_atlas_tractogram() counts them;
                                   ascending. */
    const uint32_t *number;     /**< [count] Which streamline of that it is, from 0; ascending within one. */
    uint64_t points;            /**< In all of them. */
} conus_streamline_list_view;

/**
 * Gives what is in a list.
 * @param list NULL has nothing.
 * @return Its pointers are borrowed from the list.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API conus_streamline_list_view conus_streamline_list_data(const conus_streamline_list *list);

/**
 * Copies the points of the streamlines, one after the other, whole streamlines: also what lies outside of the cone.
 * @param[out] points [points of all 3] x, y, z, world mm, as the atlas has them.
 * @param[out] first [count + 1] Where each streamline begins in @p points, and their end; NULL = not wanted.
 * @param list The list.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API void conus_streamline_list_points(float *points, uint64_t *first, const conus_streamline_list *list);

/**
 * Writes a tractogram of MRtrix (Float32LE), whole or not at all, the same bytes for the same streamlines.
 * @param list The list.
 * @param path Ends in .tck.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending; #CONUS_ERROR_IO where the system refuses.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_streamline_list_write(const conus_streamline_list *list, const char *path);

/**
 * Ends a list.
 * @param list NULL is allowed.
 * @threads One at a time for each @p list.
 * @since 0.1
 */
CONUS_API void conus_streamline_list_destroy(conus_streamline_list *list);

#ifdef __cplusplus
}
#endif

#endif
