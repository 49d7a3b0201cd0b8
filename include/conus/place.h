/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file place.h
 * Points as people say them: numbers, areas, positions of a cap.
 */
#ifndef CONUS_PUBLIC_PLACE_H
#define CONUS_PUBLIC_PLACE_H

#include <conus/atlas.h>
#include <conus/pose_file.h>
#include <conus/space.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What a place is. */
typedef enum conus_place_kind {
    CONUS_PLACE_NUMBERS = 0, /**< Three numbers. */
    CONUS_PLACE_INNER,       /**< The inner point of an area: #CONUS_SITES_DEEPEST. */
    CONUS_PLACE_CENTROID,    /**< The centroid of an area, which lies in it. */
    CONUS_PLACE_NEAR,        /**< The point of an area that is nearest to another place. */
    CONUS_PLACE_POSITION     /**< A position of the 10-10 system, on the scalp of MNI 152. */
} conus_place_kind;

/** A point, and how its words were understood. */
typedef struct conus_place {
    conus_place_kind kind; /**< Which kind. */
    double point[3];       /**< World mm. */
    uint32_t object;       /**< Number of the area or pathway; 0 = none. */
    double depth;          /**< #CONUS_PLACE_INNER: mm from the point to what is not the area; else NaN. */
    const char *name;      /**< Name of the area, borrowed from the atlas, or of the position, static; else "". */
    double outward[3];     /**< #CONUS_PLACE_POSITION: the direction away from the head, world, of length 1; all 0 where
                              it is not known, and of other kinds. */
    bool is_also_named;    /**< The words also name something else: numbers an area, an area a position. */
    bool is_doubtful;      /**< They say MNI, and it is not known whether the atlas lies there. */
} conus_place;

/** How conus_place_find() reads. */
typedef struct conus_place_options {
    size_t struct_size;       /**< Its size, as #CONUS_PLACE_OPTIONS_INIT sets it; 0 = that of this version. */
    const conus_frame *frame; /**< Space and unit of numbers; NULL = the world. */
    const double *other;      /**< [3] World mm: the place to which near:AREA is nearest; NULL = there is none. */
    bool has_axis;            /**< There is another end, so that messages may advise near:AREA. */
} conus_place_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_PLACE_OPTIONS_INIT CONUS_INIT_(conus_place_options)

/** Bytes of conus_place_text(), whose declaration has the number: Python reads declarations, and no macros. */
#define CONUS_PLACE_TEXT 512

/**
 * Finds the point that a text means:
 *
 *  - three numbers as people paste them, in the space of the frame: "-42,-20,50", "(-42 -20 50)", "42L 20P 50S";
 *  - an area or pathway, as conus_atlas_find() finds it, or as "index:17" by its label: its inner point, whether it is
 *    hidden or not. An area of which 20 % or more lie on each side, and whose name says none, has none, unless it is
 *    nearer to the midline than half its depth in an atlas some of whose areas have a side;
 *  - "centroid:AREA": its centroid, if that lies in it;
 *  - "near:AREA": the centre of its voxel, or the point of its surface, that is nearest to another place;
 *  - a position of the 10-10 system, "C3", where the atlas is known to lie in MNI 152 or Colin 27 and none of its areas
 *    is called so, or "1020:C3" where its brain is not known.
 * @param[out] out The point.
 * @param atlas Where it is, as it lies in the world now.
 * @param text UTF-8.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a text that means nothing or several things, with these and the words
 * that choose; #CONUS_ERROR_DATA for numbers that conus_frame_to_world() refuses; #CONUS_ERROR_MEMORY.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_place_find(conus_place *out, const conus_atlas *atlas, const char *text,
                                            const conus_place_options *options);

/**
 * Tells whether a text is near:AREA, so that another place has to be found before.
 * @param text The text.
 * @return True if it is.
 * @threads Any.
 * @since 0.1
 */
CONUS_API bool conus_place_is_near(const char *text);

/**
 * Says how a place was understood: "Hippocampus_L: (-27.0, -13.0, -15.0), 6.0 mm inside".
 * @param[out] out [#CONUS_PLACE_TEXT] The text, without a line's end, cut where it is too long.
 * @param place The place.
 * @param frame Space and unit of the numbers; NULL = the world.
 * @threads Any.
 * @since 0.1
 */
CONUS_API void conus_place_text(char out[512], const conus_place *place, const conus_frame *frame);

/** Points whose names say where they are, and how far from there they lie. */
typedef struct conus_name_gap {
    size_t named;       /**< How many. */
    double median;      /**< mm; of an even number the greater of the two in the middle. 0 where there are none. */
    size_t farthest;    /**< Index of the row that is farthest, */
    double farthest_mm; /**< and how far it is. */
    bool is_far;        /**< The median is over 15 mm for areas, or 40 mm for positions: another space or unit, other
                           axes or sides. */
} conus_name_gap;

/** What the names of a list of points say. */
typedef struct conus_name_check {
    conus_name_gap areas;     /**< Names of areas and pathways: mm to them, 0 inside. */
    conus_name_gap positions; /**< Names of positions of the 10-10 system: mm to these. */
} conus_name_check;

/**
 * Compares where the points of a list lie with what their names say. Names count where three points or more, and at
 * least half of them, have those of areas (four fifths, with two words for the rows of the head, those of positions),
 * so that contacts "A1" of a shaft are no areas. A number is no name. Positions are compared where the atlas is known
 * to lie in MNI 152 or Colin 27.
 * @param[out] out What was found; all 0 where names say nothing.
 * @param atlas Where they are, as it lies in the world now.
 * @param list Its first 64 rows are looked at; rows with a direction are not.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_places_check(conus_name_check *out, const conus_atlas *atlas,
                                              const conus_pose_list *list);

#ifdef __cplusplus
}
#endif

#endif
