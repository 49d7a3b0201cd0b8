/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file atlas_info.h
 * The contents of an atlas: its objects, volumes and files, and the notes about them.
 */
#ifndef CONUS_PUBLIC_ATLAS_INFO_H
#define CONUS_PUBLIC_ATLAS_INFO_H

#include <conus/atlas.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Kind of an object or a result. */
typedef enum conus_kind {
    CONUS_KIND_AREA = 1,   /**< An area of a parcellation or of a probabilistic atlas, a mesh, or a group of areas. */
    CONUS_KIND_PATHWAY,    /**< A scalar volume from a threshold on, or in a band of values. */
    CONUS_KIND_UNASSIGNED, /**< Only of a result: the pixels that hit no object, or first a context that blocks. */
    CONUS_KIND_BUNDLE      /**< Streamlines of a tractogram: all of them, or a group. */
} conus_kind;

/** An area, a pathway or a bundle. */
typedef struct conus_object {
    conus_kind kind;          /**< #CONUS_KIND_AREA, #CONUS_KIND_PATHWAY or #CONUS_KIND_BUNDLE. */
    uint32_t label;           /**< The atlas's own number of the area; a pathway's or bundle's ordinal, from 1. */
    const char *name;         /**< UTF-8, one line. An area that no table names has its number here. */
    const char *abbreviation; /**< UTF-8; "" if the table gives none. */
    char hemisphere;          /**< 'L', 'R' or 'B' (both) where the table says so, else 0. */
    bool named;               /**< The table has a name for it. */
    uint8_t rgb[3];           /**< sRGB, from the table or else generated. */
    uint32_t parent;          /**< Number of the object that contains it in the area tree, 0 if none. */
    uint64_t voxels;          /**< Its own voxels, without those of its children. */
    double volume_mm3;        /**< The volume of these, mm^3. */
    uint64_t triangles;       /**< Triangles of its surface, where the area is a mesh (then voxels is 0). */
    bool closed;   /**< That surface bounds a solid. volume_mm3 is 0 if it does not, and if its parts overlap or face
                      different ways, so that its volume is not known. */
    bool is_band;  /**< A pathway that is a band of values; other pathways may be of the same volume. */
    size_t volume; /**< For an object with voxels: index of its volume, for conus_atlas_volume(); else 0. */
    double low;    /**< For these: the least value of its voxels, its threshold; -INFINITY = any. Else 0. */
    double high;   /**< For these: its voxels' values are below it; INFINITY = any. Else 0. */
    uint64_t streamlines; /**< For a bundle: the number of its streamlines; else 0. */
    uint64_t points;      /**< Points of these. */
    double length_mm;     /**< Total length of these, mm. */
    double radius;        /**< For a bundle: a ray hits a streamline that is nearer than this, mm (Eq. 18). Else 0. */
} conus_object;

/**
 * Counts the objects. Areas come first: those of each volume of labels, then those that are meshes, each ordered by
 * label, then those that only group others, then those of a probabilistic atlas. Pathways and bundles follow in the
 * order in which they were added.
 * @param atlas NULL counts 0.
 * @return How many objects there are; their numbers are 1 to this.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API size_t conus_atlas_object_count(const conus_atlas *atlas);

/**
 * Gives object @p number.
 * @param atlas The atlas.
 * @param number 1 to conus_atlas_object_count().
 * @return NULL for another number. Borrowed until the atlas is changed or ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const conus_object *conus_atlas_object(const conus_atlas *atlas, size_t number);

/**
 * Gives the depth of an area in the tree, as levels count it.
 * @param atlas The atlas.
 * @param number Number of the object.
 * @return 1 for roots; a merged area has the depth of its pair; 0 for a pathway or bundle.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API uint32_t conus_atlas_depth(const conus_atlas *atlas, size_t number);

/**
 * Gives the word that tells an object from others of the same name. No two pathways and bundles share a name, but an
 * area may share one with them, and so may a left and a right area whose table says which is which. Tables, legends and
 * lists say it where it is needed: "bundle Arc", "left insula".
 * @param[out] prefixes [number of objects + 1], by number: "area", "pathway", "bundle", "left", "right", "left area" or
 *             "right area", and "" where no name is shared, and for 0. The texts are static. Untouched on failure.
 * @param atlas The atlas.
 * @return #CONUS_OK, or #CONUS_ERROR_MEMORY.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API conus_status conus_atlas_prefixes(const char **prefixes, const conus_atlas *atlas);

/**
 * Finds the pathway or bundle called @p name, or else the one area with that name, abbreviation or label.
 * @param[out] out Its number.
 * @param atlas The atlas.
 * @param name What to find.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT if there is none, with the closest one in the message, and if there are
 * several.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_find(uint32_t *out, const conus_atlas *atlas, const char *name);

/** Role of a volume. */
typedef enum conus_role {
    CONUS_ROLE_PARCELLATION = 1, /**< Its values are labels of areas. */
    CONUS_ROLE_SCALAR,           /**< Its values make a pathway, or several. */
    CONUS_ROLE_CONTEXT,          /**< It is drawn around the areas. */
    CONUS_ROLE_PROBABILITY       /**< Its values, from 0 to 1, make an area of a probabilistic atlas. */
} conus_role;

/** A volume of an atlas. */
typedef struct conus_volume_info {
    conus_role role;     /**< Its role. */
    const char *path;    /**< Path of the voxels, or of a header of text, as opened: bytes, not always UTF-8. */
    char sha256[65];     /**< SHA-256 of that file, in hexadecimal; of a header of text with its voxels behind it. */
    char format[48];     /**< "NIfTI-1, gzip, big-endian". */
    char datatype[16];   /**< "uint8", "float64". */
    size_t dim[3];       /**< Voxels along i, j, k. */
    size_t volume;       /**< Which volume of a 4-D file, from 0. */
    size_t volume_count; /**< How many volumes the file has. */
    double world_from_voxel[16]; /**< Maps voxel indices (centres at whole numbers) to world mm. */
    double spacing[3];           /**< Edge lengths of a voxel in mm. */
    char orientation[4];         /**< Towards which i, j, k grow: "RAS", "LPI". */
    char transform[96];          /**< Where world_from_voxel comes from: "sform, code 4 (MNI 152)". */
    int space_code;              /**< NIfTI's code of the space that it maps to, 4 for MNI 152; 0 if unknown. */
    double slope;                /**< Slope of the stored values; 1 if unscaled. */
    double intercept;            /**< Intercept of the stored values; 0 if unscaled. */
    double minimum;              /**< Least of the scaled values. */
    double maximum;              /**< Largest of the scaled values. */
    double threshold; /**< Threshold of a pathway that is no band, of an area of a probabilistic atlas, or of a context
                         that blocks; else 0. */
    char unit[24];    /**< What the values of a map are, in UTF-8: "z", "probability", "% signal change", as
                         conus_pathway_options.unit, the header's intent or the file's name says; "" = not known. */
} conus_volume_info;

/**
 * Counts the volumes. Those of labels come first, one for each grid; pathways and the context follow.
 * @param atlas NULL counts 0.
 * @return How many volumes there are.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API size_t conus_atlas_volume_count(const conus_atlas *atlas);

/**
 * Gives volume @p index.
 * @param atlas The atlas.
 * @param index From 0.
 * @return NULL past the last. Borrowed until the atlas is changed or ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const conus_volume_info *conus_atlas_volume(const conus_atlas *atlas, size_t index);

/** A surface that conus_atlas_set_context() has put around the areas. */
typedef struct conus_context_surface {
    size_t struct_size; /**< Its size, as #CONUS_CONTEXT_SURFACE_INIT sets it; 0 = that of this version. */
    const char *path;   /**< UTF-8 where the file system has it so. Borrowed until the atlas ends. */
    size_t vertices;    /**< In the file. */
    size_t triangles;   /**< Those without area are left out. */
    bool closed;        /**< Every edge is of two triangles: it has an inside. */
    char hemisphere;    /**< 'L', 'R', 'B', or 0 where the file does not say. */
    double opacity;     /**< Above 0 to 1. */
    double low[3];      /**< Lowest x, y, z of its vertices, world mm. */
    double high[3];     /**< The highest. */
} conus_context_surface;

/** The size of the struct that the caller was compiled with. */
#define CONUS_CONTEXT_SURFACE_INIT CONUS_INIT_(conus_context_surface)

/**
 * Counts the surfaces around the areas.
 * @param atlas NULL counts 0.
 * @return How many conus_atlas_set_context() has added.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API size_t conus_atlas_context_surface_count(const conus_atlas *atlas);

/**
 * Tells about a surface around the areas.
 * @param[in,out] out Its struct_size is read; unchanged on failure.
 * @param atlas The atlas.
 * @param index From 0, in the order in which they were added.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT past the last.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_context_surface(conus_context_surface *out, const conus_atlas *atlas,
                                                       size_t index);

/**
 * Finds where a ray first meets a surface around the areas, from either side. Looks at every triangle.
 * @param atlas The atlas.
 * @param origin World mm.
 * @param direction Of any length but 0.
 * @return How far that is from @p origin, in units of the length of @p direction; INFINITY where it meets none.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API double conus_atlas_context_depth(const conus_atlas *atlas, const double origin[3], const double direction[3]);

/**
 * Finds where a world point is in the atlas's own space, that of its files.
 * @param[out] out mm; the point itself, unless the atlas was moved (conus_atlas_transform()); NaN where a deformation
 * field has moved it and says nothing of the point. May be @p point.
 * @param atlas The atlas.
 * @param point World mm.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API void conus_atlas_own_point(double out[3], const conus_atlas *atlas, const double point[3]);

/** Whose brain an atlas is. */
typedef enum conus_brain {
    CONUS_BRAIN_UNKNOWN = 0, /**< Nothing says. */
    CONUS_BRAIN_OWN,         /**< One person's own, in the space of that person's scan. */
    CONUS_BRAIN_MNI152,      /**< The MNI's average of 152 people, of any edition. */
    CONUS_BRAIN_COLIN27,     /**< One person's, averaged over 27 scans and brought to the MNI's space. */
    CONUS_BRAIN_MNI305,      /**< The MNI's average of 305 people, as fsaverage has it. */
    CONUS_BRAIN_TALAIRACH,   /**< That of Talairach and Tournoux. */
    CONUS_BRAIN_TEMPLATE     /**< Another template, also of an animal. */
} conus_brain;

/** Whose brain an atlas is, and how that is known. */
typedef struct conus_brain_view {
    conus_brain brain;   /**< Whose. */
    const char *edition; /**< Of MNI 152: "NLin2009", or "earlier" for those before it; "" = not known. Static. */
    const char *source;  /**< "stated", "header", "grid", "CCF"; "" of an unknown one. Static. */
    const char *words;   /**< "MNI 152, NLin2009", "Colin 27", "one person's own". Static. */
    bool is_moved;       /**< A transform has moved it since: it lies in another space, which is unknown unless
                            stated. */
} conus_brain_view;

/**
 * Tells whose brain an atlas is: what is stated (",template=" of conus_atlas_load(), "template" of a manifest), else
 * what the header of its first volume says (NIfTI's codes 3, 4 and 5), else what its grid says, which also tells Colin
 * 27 and editions of MNI 152 from each other. FreeSurfer's grid of 256^3 mm is anybody's. An atlas that was moved since
 * is unknown, but one person's own stays so.
 * @param atlas The atlas.
 * @return The brain. Its texts are static.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API conus_brain_view conus_atlas_brain(const conus_atlas *atlas);

/**
 * Tells the same of a volume alone, by its header and its grid.
 * @param info The volume.
 * @return The brain. Its texts are static.
 * @threads Any.
 * @since 0.1
 */
CONUS_API conus_brain_view conus_volume_brain(const conus_volume_info *info);

/** How far apart two brains are. */
typedef enum conus_brain_gap {
    CONUS_BRAIN_GAP_NONE = 0, /**< None that is known. */
    CONUS_BRAIN_GAP_SMALL,    /**< MNI 152 and Colin 27, which half of the field takes for one. */
    CONUS_BRAIN_GAP_SOME_MM,  /**< Other editions of MNI 152, NLin2009 and an earlier one, and other templates. */
    CONUS_BRAIN_GAP_OTHER     /**< Another brain. */
} conus_brain_gap;

/**
 * Compares two brains.
 * @param a One.
 * @param b The other.
 * @return #CONUS_BRAIN_GAP_NONE also where one is unknown, and of one person's own and another own one.
 * @threads Any.
 * @since 0.1
 */
CONUS_API conus_brain_gap conus_brain_compare(conus_brain_view a, conus_brain_view b);

/** Where the areas of an atlas lie: those that are not hidden, of voxels, or else of surfaces. */
typedef struct conus_placement {
    size_t struct_size; /**< Its size, as #CONUS_PLACEMENT_INIT sets it; 0 = that of this version. */
    bool is_moved;      /**< By conus_atlas_transform(), conus_atlas_move() or a manifest's "transform". */
    bool mirrors;       /**< Left and right are exchanged. */
    bool has_context;   /**< There is a context, and the last three are known: its volume, or else closed surfaces. */
    bool is_warped;     /**< By a deformation field: the matrix, growth and own box are NAN, mirrors is false. */
    double atlas_from_world[16]; /**< From where it lies to its own space, that of its files. */
    double growth;               /**< Volume here of 1 mm^3 in its own space, mm^3. */
    double own_low[3];           /**< Lowest x, y, z of the box around it in its own space, mm. */
    double own_high[3];          /**< The highest. */
    double low[3];               /**< Lowest x, y, z of the box around it here, world mm. */
    double high[3];              /**< The highest. */
    double centre[3];            /**< The mean of its voxels' centres, or of its vertices; world mm. */
    double distance_mm;          /**< How far that is from where it is in its own space. */
    double head_threshold; /**< Values of the context from this one on are the head's, with what they enclose along two
                              axes of its grid; by Otsu's method. INFINITY where all are alike. For surfaces it is
                              between 0, outside, and 1, inside. */
    double in_grid;        /**< Part of the voxels whose centre is in the grid of the context, or in the box around its
                              surfaces, 0 to 1. */
    double in_head;        /**< The same, in the head. */
} conus_placement;

/** The size of the struct that the caller was compiled with. */
#define CONUS_PLACEMENT_INIT CONUS_INIT_(conus_placement)

/**
 * Tells where an atlas lies, where it lay in its own space, and which part of it is in the head that its context shows.
 * Parts and centre are those of 131072 voxels, or vertices, at most.
 * @param[in,out] out Its struct_size is read.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA where there are no areas; #CONUS_ERROR_MEMORY.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_placement(conus_placement *out, const conus_atlas *atlas);

/**
 * Returns whether a deformation field has moved the atlas, so that conus_atlas_own_point() is no affine.
 * @param atlas The atlas.
 * @return Whether one has.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API bool conus_atlas_is_warped(const conus_atlas *atlas);

/**
 * Counts the other files that an atlas is made of: a manifest, surfaces, labels of their vertices, lists of what is
 * shown, volumes of labels that are joined with another on its grid.
 * @param atlas NULL counts 0.
 * @return How many files there are.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API size_t conus_atlas_file_count(const conus_atlas *atlas);

/**
 * Gives the path of other file @p index.
 * @param atlas The atlas.
 * @param index From 0.
 * @return NULL past the last. Borrowed until the atlas is changed or ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const char *conus_atlas_file(const conus_atlas *atlas, size_t index);

/**
 * Finds the box around all voxels, triangles and streamlines that are not hidden.
 * @param[out] low Its lowest x, y, z, world mm.
 * @param[out] high Its highest x, y, z, world mm.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA if there are none.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_bounds(double low[3], double high[3], const conus_atlas *atlas);

/**
 * Finds the mean position of the voxels or triangles of an object and of those below it in the area tree, or of the
 * points of a bundle, hidden or not.
 * @param[out] out World mm.
 * @param atlas The atlas.
 * @param number Number of the object.
 * @return #CONUS_OK; #CONUS_ERROR_DATA if there are none.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_centre(double out[3], const conus_atlas *atlas, size_t number);

/**
 * Counts the voxels of a scalar or context volume by their value.
 * @param[out] counts [bins] How many voxels have values in each of @p bins equal parts of the range from minimum to
 * maximum.
 * @param bins How many parts.
 * @param atlas The atlas.
 * @param index The volume.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where there is no such volume.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_histogram(uint64_t *counts, size_t bins, const conus_atlas *atlas, size_t index);

/**
 * Interpolates a scalar or context volume at a world position, between the centres of its voxels.
 * @param atlas The atlas.
 * @param index The volume.
 * @param point World mm.
 * @return The scaled value; NaN outside the volume's cells, and where there is no such volume.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API double conus_atlas_value(const conus_atlas *atlas, size_t index, const double point[3]);

/**
 * Finds the grey values that span the contrast of a scalar or context volume, without a few extremes.
 * @param[out] window The grey values of black and of white.
 * @param atlas The atlas.
 * @param index The volume.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where there is no such volume.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_window(double window[2], const conus_atlas *atlas, size_t index);

/**
 * Gives the source of the names, in words.
 * @param atlas The atlas.
 * @return "ITK-SNAP labels in aal.label", "none found". Borrowed until the atlas is changed or ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const char *conus_atlas_label_source(const conus_atlas *atlas);

/**
 * Counts the notes that a careful user should know about this atlas: labels without names, a guessed space.
 * @param atlas NULL counts 0.
 * @return How many notes there are.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API size_t conus_atlas_note_count(const conus_atlas *atlas);

/**
 * Gives note @p index.
 * @param atlas The atlas.
 * @param index From 0.
 * @return One line; NULL past the last. Borrowed until the atlas is changed or ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const char *conus_atlas_note(const conus_atlas *atlas, size_t index);

/**
 * Tells how much note @p index matters. A warning says that an answer may name another place or another area than the
 * data mean.
 * @param atlas The atlas.
 * @param index From 0.
 * @return #CONUS_SEVERITY_NOTE also past the last.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API conus_severity conus_atlas_note_severity(const conus_atlas *atlas, size_t index);

/**
 * Gives the note that left and right are exchanged, of the names or of the places. Tell nobody a side of such an atlas:
 * names say one, places the other. conus_atlas_exchange_sides() mends one whose places are.
 * @param atlas The atlas.
 * @return The note: at least three pairs of a left and a right area, and three quarters of all, lie the other way
 * round. NULL where they do not. Borrowed until the atlas is changed or ends.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API const char *conus_atlas_exchanged(const conus_atlas *atlas);

/** By what a direction into the head was found. */
typedef enum conus_inward {
    CONUS_INWARD_SURFACE = 0, /**< Closed surfaces of the context. */
    CONUS_INWARD_IMAGE,       /**< The head in the context's image: from a threshold on by Otsu's method. */
    CONUS_INWARD_ATLAS        /**< The convex hull of what is shown of the atlas: the way to its nearest point. */
} conus_inward;

/**
 * Finds the direction straight into the head at a point on it: against the mean normal of the head's surface within 5
 * mm, weighted by area; where the context has none there, the way to the nearest point of the atlas's convex hull.
 * @param[out] out World, of length 1.
 * @param[out] from By what; NULL = not wanted.
 * @param atlas The atlas with its context.
 * @param point World mm.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a point in the hull and no surface near it, and for an atlas that was
 * loaded without its context; #CONUS_ERROR_MEMORY.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_inward(double out[3], conus_inward *from, const conus_atlas *atlas,
                                              const double point[3]);

#ifdef __cplusplus
}
#endif

#endif
