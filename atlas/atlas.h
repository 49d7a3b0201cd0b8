/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlas as a whole, and how loaders and phantoms put one together. */
#ifndef CONUS_ATLAS_ATLAS_H
#define CONUS_ATLAS_ATLAS_H

#include "atlas/deformation/deformation.h"
#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "atlas/tracts/tractogram.h"
#include "atlas/volume.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/status.h"
#include "conus/image.h"
#include "conus/own.h"
#include "conus/plan.h"
#include "conus/space.h"

/** An object's place: which mesh, tractogram or volume of the atlas. An index beyond these means no shape. */
struct object_place {
    bool is_mesh;
    bool is_bundle; /**< The index is that of a tractogram. */
    bool is_hidden; /**< Hidden by conus_atlas_set_hidden(). */
    uint32_t named; /**< Its place, from 1, among those that conus_atlas_show() was told to show; 0 = not named. */
    size_t index;
    size_t group;       /**< A bundle's group of the tractogram, or BUNDLE_OF_ALL. */
    uint8_t own_rgb[3]; /**< The object's original colour while the atlas uses a palette. */
};

/** A surface around the areas, which rays do not hit. */
struct context_surface {
    struct mesh mesh; /**< Checked and measured. */
    double opacity;   /**< Above 0 to 1. */
    bool is_shell;    /**< Made around the atlas, so that it tells nothing of a head; not in cuts. */
    char hemisphere;  /**< 'L', 'R', 'B' where the file says so, else 0. */
    float *values;    /**< [vertices] Of its map, NaN = none; NULL without a map. Owned. */
    char *map_name;   /**< Name of the map's array; owned. */
    double low, high; /**< The range of its colours. */
};

/** The pack that an atlas was opened from: one block, whose texts are in it or in the mapping. */
struct pack_origin {
    conus_pack_info info;
    char sha256[65];
    struct pack_source {
        const char *path;
        conus_source_state state;
    } sources[]; /**< [info.source_count], and then its path. */
};

struct conus_atlas {
    struct volume *volumes; /**< Volumes of labels, one for each grid, then pathways and context as added. Pathways that
                               are bands of values share a volume. */
    size_t volume_count;
    struct mesh *meshes; /**< One per object that is a mesh.                                            */
    size_t mesh_count;
    struct tractogram *tractograms; /**< As added. */
    size_t tractogram_count;
    conus_object *objects;       /**< [object_count]; object number k is objects[k - 1]. Strings are owned.     */
    struct object_place *places; /**< [object_count]                                                            */
    size_t object_count;
    struct name_set taken; /**< Names of the first objects after the areas, as far as bundles searched them. */
    size_t area_count;     /**< The first so many objects are areas.                                   */
    uint32_t first_pair;   /**< Areas from this number on are pairs: each is the parent of a left and a right area
                              (atlas/areas/hemispheres.c). 0 = there are none. */
    conus_hemispheres hemispheres; /**< As conus_atlas_set_hemispheres() left them.                   */
    uint32_t half_step; /**< Labels of left halves are the area's label plus this, those of right ones plus twice this;
                             0 = no area is cut in halves. */
    bool has_other_colours;    /**< Of a palette or the safe ones; places[].own_rgb are those that objects had. */
    bool has_palette;          /**< Not of the safe ones, beside which a cone's answer is coloured by rank.     */
    bool is_moved;             /**< atlas_move() or atlas_warp() moved it.                             */
    bool is_mirrored;          /**< Only conus_atlas_exchange_sides() did: it lies where its files say. */
    double own_from_world[16]; /**< If so: from where the atlas is to where its files have it; with warps to their
                                    input. */
    struct warp *warps;        /**< Fields after own_from_world: points go through the last one first. */
    size_t warp_count;
    char *last_transform;    /**< The file that points go through after one that comes next; owned, NULL = none. */
    bool last_is_inverse;    /**< In the other direction than the file says. */
    conus_brain brain;       /**< Whose it is, as stated; 0 = by its files. */
    uint32_t identified;     /**< Where nothing else says whose: the published atlas whose voxels and names it has
                                (atlas/identity.c), from 1 on; 0 = none, or not looked for. */
    bool has_ccf;            /**< Its files say that it is the Allen CCF.                             */
    double own_from_ccf[16]; /**< If so: from AP, DV, ML in micrometres to where its files have it. */
    char *path;              /**< As the user gave it; NULL = the atlas was not loaded. */
    char *label_source;
    struct file_sums files; /**< Its source files other than those of its volumes: a manifest first.       */
    char *transfer; /**< Transfer function of the context: a preset's name or a file; NULL = the default.       */
    struct notes notes;
    size_t exchanged;   /**< Number of the note that left and right are exchanged, from 1 on; 0 = they are not. */
    bool lacks_context; /**< That of its manifest was left out (conus_load_options.without_context). */
    struct context_surface *context_surfaces; /**< [context_surface_count] */
    size_t context_surface_count;
    const void *mapped; /**< The file mapping that has its borrowed arrays, to be unmapped with the atlas; NULL = none.
                         */
    size_t mapped_size;
    struct pack_origin *pack; /**< Owned; NULL = none. */
};

/** Labels of voxels. */
struct labelled_volume {
    const conus_volume_info *info;
    struct label_voxels *labels; /**< As many as @p info says; emptied, since the atlas takes over their memory. */
    bool is_joined;              /**< The labels come from several files, of which info->path is the first. */
};

/** Makes an atlas of @p count labelled volumes, no two of which have a label in common; 0 is background. Areas are the
 * labels present and those that @p table (sorted) names. They are numbered densely by label, volume by volume, those
 * without voxels with the first. Of equally near areas the earlier volume's comes first. @p notes are moved into the
 * atlas, which adds its own: labels without names, names without voxels, parents that are missing or cyclic (such links
 * are dropped). The atlas's notes get the sink of @p notes. */
conus_status atlas_create_of(conus_atlas **out, struct labelled_volume *volumes, size_t count,
                             const struct label_table *table, const char *label_source, struct notes *notes);

/** Appends @p volume, which is taken over on success. */
conus_status atlas_append_volume(conus_atlas *atlas, struct volume *volume);

/** Removes the objects after the first @p count. */
void atlas_cut_objects(conus_atlas *atlas, size_t count);

/** An atlas without volumes or objects, for areas that are meshes. */
conus_status atlas_create_empty(conus_atlas **out, const char *label_source);

/** CONUS_ERROR_ARGUMENT, about the area @p area, once there is a pathway: areas come before pathways. */
conus_status atlas_check_order(const conus_atlas *atlas, const conus_object *area);

/** Appends a copy of @p object, which lies at @p place. */
conus_status atlas_append_object(conus_atlas *atlas, const conus_object *object, struct object_place place);

/** Appends the area @p area with its surface @p mesh (checked; taken over on success); its triangles and volume are
 * filled in. Areas come before pathways: CONUS_ERROR_ARGUMENT once there is a pathway. */
conus_status atlas_add_mesh(conus_atlas *atlas, const conus_object *area, struct mesh *mesh);

/** Appends an area without a shape, which groups others in the area tree. Otherwise like atlas_add_mesh(). */
conus_status atlas_add_group(conus_atlas *atlas, const conus_object *area);

/** Exchanges the areas of @p atlas for those of @p areas, an atlas with nothing else. Pathways stay, with other
 * numbers. Voxels of the parcellation are left as they are. On success @p areas has the old ones. */
conus_status atlas_exchange_areas(conus_atlas *atlas, conus_atlas *areas);

/** Whether area @p number is reported as its parent, because it is one of a pair. */
static inline bool atlas_is_paired(const conus_atlas *atlas, uint32_t number)
{
    return atlas->first_pair && number < atlas->first_pair && atlas->objects[number - 1].parent >= atlas->first_pair;
}

/** Adds a scalar volume as a pathway of the voxels with values >= info->threshold. @p map is
 * taken over on success. */
conus_status atlas_add_pathway(conus_atlas *atlas, const conus_volume_info *info, struct value_map *map,
                               const char *name);

/** Adds a volume of probabilities, from 0 to 1, as the area @p area of the voxels with values >= info->threshold;
 * otherwise like atlas_add_pathway(). Areas may overlap. They come before pathways: CONUS_ERROR_ARGUMENT once there is
 * a pathway. */
conus_status atlas_add_probabilistic_area(conus_atlas *atlas, const conus_volume_info *info, struct value_map *map,
                                          const conus_object *area);

/** Adds a scalar volume as one pathway for each of @p bands (Eq. 6), in their order. Bands do not overlap, and each
 * holds some float; the ends of the first and last may be infinite. @p map as above. */
conus_status atlas_add_bands(conus_atlas *atlas, const conus_volume_info *info, struct value_map *map,
                             const conus_band *bands, size_t count);

/** Sets the context volume, replacing an earlier one. Voxels with values >= info->threshold stop rays, unless that is
 * 0. @p values is taken over on success. */
conus_status atlas_set_context(conus_atlas *atlas, const conus_volume_info *info, float *values);

/** Appends a surface around the areas. Its mesh, which is checked, is measured, and taken over on success. */
conus_status atlas_add_context_surface(conus_atlas *atlas, struct context_surface *surface);

/** The one surface around the areas that has a map; NULL if there is none. */
const struct context_surface *atlas_mapped_surface(const conus_atlas *atlas);

/** Removes the surfaces around the areas after the first @p count. */
void atlas_cut_context_surfaces(conus_atlas *atlas, size_t count);

/** Hands @p atlas out, or after a failure destroys it. Returns @p status. */
conus_status atlas_give(conus_atlas **out, conus_atlas *atlas, conus_status status);

/** Records that the atlas comes from the file @p path with these bytes. A path is recorded once. */
conus_status atlas_add_file(conus_atlas *atlas, const char *path, const struct bytes *content);

/** Reads the file @p path again and records it like atlas_add_file(). CONUS_ERROR_IO if it is not as it was @p before,
 * when somebody else read it. */
conus_status atlas_note_file(conus_atlas *atlas, const char *path, const struct file_state *before);

/** Looks for the published atlas whose voxels and names @p atlas has. */
void atlas_identify(conus_atlas *atlas);
/** Whose brain a published atlas is; @p identified of 0 and of none is unknown. */
conus_brain_view identity_brain(uint32_t identified);

/** Marks the atlas as moved: whose brain it was says no longer where it lies, unless it is one person's own. */
void atlas_note_move(conus_atlas *atlas);

/** The context volume, or NULL. */
const struct volume *atlas_context(const conus_atlas *atlas);

/** The file or folder by which people know the atlas: as the user gave it; for an atlas that was not loaded that of the
 * first parcellation, else the manifest, else the first mesh. */
const char *atlas_path(const conus_atlas *atlas);

/** How many volumes of labels there are; they are the first ones. */
size_t atlas_parcellation_count(const conus_atlas *atlas);

/** The only volume of labels; NULL if there is none, or several, which lie on different grids. */
const struct volume *atlas_parcellation(const conus_atlas *atlas);

/** Whether object @p number has a volume of its own with a value per voxel: a pathway, or an area of probabilities. */
bool atlas_object_is_scalar(const conus_atlas *atlas, uint32_t number);

/** Whether there are areas of probabilities, which may overlap. */
bool atlas_has_probabilities(const conus_atlas *atlas);

/** The probability of the area @p number at a world point; NAN outside its volume. */
float atlas_probability(const conus_atlas *atlas, uint32_t number, const double point[3]);

/** The volume of object @p number, hidden or not; NULL if it is a mesh or has no shape. */
const struct volume *atlas_object_volume(const conus_atlas *atlas, uint32_t number);

/** The only volume with voxels of object @p number or of areas below it in the area tree, hidden or not; NULL if there
 * is none, or several. */
const struct volume *atlas_only_volume(const conus_atlas *atlas, uint32_t number);

/** The mesh of object @p number; NULL if it lies in a volume, has no shape, or is hidden. */
const struct mesh *atlas_object_mesh(const conus_atlas *atlas, uint32_t number);

/** The same, also of a hidden object. */
const struct mesh *atlas_stored_mesh(const conus_atlas *atlas, uint32_t number);

/** Whether there is a mesh that is not hidden. */
bool atlas_has_meshes(const conus_atlas *atlas);

/** Whether the voxels of @p volume belong to areas that are not all hidden. */
static inline bool atlas_volume_has_areas(const struct volume *volume)
{
    return (volume->info.role == CONUS_ROLE_PARCELLATION || volume->info.role == CONUS_ROLE_PROBABILITY) &&
           volume_can_be_hit(volume);
}

/** The box around the areas that are not hidden, in the space that @p from_world maps to. False if there are none. */
bool atlas_area_bounds(double low[3], double high[3], const conus_atlas *atlas, const double from_world[16]);

/** Whether something is hidden. */
bool atlas_has_hidden(const conus_atlas *atlas);

/** Appends what is hidden, the same text for the same objects: "areas 1-4,7; pathways 2", by label and ordinal. Nothing
 * if nothing is hidden. */
void atlas_list_hidden(struct buffer *out, const conus_atlas *atlas);

/** Appends it for people: "only Hippocampus_L", "all but A, B and 3 more"; nothing if nothing is hidden. */
void atlas_describe_shown(struct buffer *out, const conus_atlas *atlas);

/** "area", "pathway" or "bundle"; "unassigned" for everything else. */
const char *atlas_kind_word(conus_kind kind);

/** Whether @p number is @p ancestor or below it in the area tree. */
bool atlas_is_below(const conus_atlas *atlas, uint32_t number, uint32_t ancestor);

enum { ATLAS_DEPTH_LIMIT = 64 }; /**< Limit of areas above an area, so that each walk up the tree is short. */

/** CONUS_ERROR_DATA if an area lies below itself, or has more than ATLAS_DEPTH_LIMIT areas above it. */
conus_status atlas_check_tree(const conus_atlas *atlas);

/** The first @p count objects by their names, to memory_free(); NULL without memory. */
const conus_object **atlas_by_name(const conus_atlas *atlas, size_t count);

/* Bundles: objects of an atlas that are streamlines, made from a tractogram. */

/** object_place.group of a bundle of all streamlines of its tractogram. */
#define BUNDLE_OF_ALL SIZE_MAX

/** Grows the tree of the checked @p tractogram. If it has groups, and some streamlines are in none, appends a group of
 * these, without a name. On failure it may have its tree. */
conus_status bundles_ready(struct tractogram *tractogram);

/** Makes the checked @p tractogram ready, unless it is, and appends it to @p atlas, with one bundle called @p name for
 * all of its streamlines. If it has groups: one bundle for each, by the group's name, and one called @p name for the
 * streamlines in no group. On success the tractogram is taken over; on failure it may have its tree and that group, and
 * the atlas is unchanged. CONUS_ERROR_ARGUMENT if a pathway or bundle has one of these names. */
conus_status atlas_add_tractogram(conus_atlas *atlas, struct tractogram *tractogram, const char *name);

/** The tractogram of object @p number, hidden or not; NULL if it is no bundle. */
const struct tractogram *atlas_bundle_tractogram(const conus_atlas *atlas, uint32_t number);

/** The group of streamlines of its tractogram that the bundle @p number is; NULL = all. */
const struct tract_group *atlas_bundle_group(const conus_atlas *atlas, uint32_t number);

/** Whether there is a bundle that is not hidden. */
bool atlas_has_bundles(const conus_atlas *atlas);

/** The object as which each streamline of @p tractogram, one of the atlas's, is shown: the first bundle that has it and
 * is not hidden. @p objects [streamline_count] is all 0 before, and stays so where there is none. */
void bundles_find_objects(uint32_t *objects, const conus_atlas *atlas, const struct tractogram *tractogram);

/** Gives @p atlas the surfaces [mesh_count] in their new place, which are measured, and its objects what follows from
 * them. @p moved gets the old ones, to be freed. */
void meshes_take(conus_atlas *atlas, struct mesh *moved);

/** Moves all points of @p atlas's tractograms by @p world_from_atlas: new tractograms in @p out, [tractogram_count],
 * with points, point_count, tree and bounds only. CONUS_ERROR_DATA if a point leaves TRACT_COORDINATE_LIMIT;
 * CONUS_ERROR_MEMORY. On failure @p out has nothing to free. */
conus_status bundles_move(struct tractogram *out, const conus_atlas *atlas, const double world_from_atlas[16]);

/** Gives @p atlas those points and trees, or a whole tractogram where @p moved has its `first`, with as many groups as
 * before; and measures its bundles anew. @p moved gets the old ones, to be freed. */
void bundles_take(conus_atlas *atlas, struct tractogram *moved);

/* The Allen CCF's place in an atlas (include/conus/space.h has the spaces). */

/** The size of the CCF's grid along AP, DV and ML, micrometres: 528 x 320 x 456 voxels of 25. */
extern const double frame_ccf_size[3];

/** Whether a grid of these sizes, micrometres along AP, DV and ML, is the CCF's. */
bool frame_is_ccf_size(const double size[3]);

/** Declares an atlas that was not moved to be the Allen CCF, whose corner, where AP, DV and ML start, is the world's
 * origin: AP grows backward, DV downward; ML grows to the left if @p from_right, as in BrainGlobe, else to the right,
 * as at the Allen Institute. CONUS_ERROR_DATA if the first volume's grid is the CCF's at another place. */
conus_status frame_set_ccf(conus_atlas *atlas, bool from_right);

/** The plane between an atlas's left and right. */
struct midline {
    bool is_ccf;              /**< It is that of the Allen CCF, and right is where ML grows; else x = 0.           */
    bool is_turned;           /**< There x grows to the left of it, as in a folder of BrainGlobe: left by x is right
                                   by ML.                                                                        */
    bool is_unknown;          /**< Nothing says where it is: x = 0 is an edge of the areas' grid, and the brain is none
                                   that conus knows.                                                             */
    double side_from_own[16]; /**< From where the atlas's files have it (conus_atlas_own_point()) to mm, of which the
                                   first number is how far a point lies to the right of the plane.               */
};

/** ML of the CCF's midline, micrometres: the middle of its grid. */
#define FRAME_CCF_MIDDLE 5700

/** A centre of a voxel on the midline is right, in spite of this rounding of moving it there, mm. */
#define FRAME_MIDLINE_ROUNDING 1e-6

/** Finds the midline: x = 0 of the atlas's own space, or that of the CCF wherever its corner is. */
void frame_midline(struct midline *out, const conus_atlas *atlas);

/** Keeps where the CCF is in an atlas whose grid says it, before the voxels move to another grid. */
void frame_keep_ccf(conus_atlas *atlas);

/** The frame of options that have one, or else a space that needs no atlas. CONUS_ERROR_ARGUMENT where its space is
 * none, or needs one. */
conus_status frame_of_options(conus_frame *out, const conus_frame *given, conus_space space);

/* The atlas in another space: all of it moved by an affine. */

enum { PLACEMENT_WORDS = sizeof((conus_volume_info *)0)->transform };

/** The words of @p info's transform and @p how (", moved", ", warped") behind them, unless they have it. */
void placement_words(char out[PLACEMENT_WORDS], const conus_volume_info *info, const char *how);

/** Moves volumes and surfaces by the inverse of @p atlas_from_world, which maps a point of the new space to one of the
 * atlas. @p words name the transform in one line. Unchanged on failure: CONUS_ERROR_DATA for a matrix that cannot be
 * inverted or takes a vertex beyond 1e9 mm; CONUS_ERROR_MEMORY. */
conus_status atlas_move(conus_atlas *atlas, const double atlas_from_world[16], const char *words);

/* Points where needles may enter, or to which they may point (conus/plan.h). */

struct conus_sites {
    double (*points)[3];
    double (*normals)[3]; /**< NULL = there are none. */
    uint64_t *sources;
    size_t count, capacity;
    size_t vertex_count;  /**< Vertices of their surface; 0 = there is none. */
    conus_grid_view grid; /**< Grid of the one volume whose voxels they are, without data; else its count is 0. */
    char *path;           /**< Its file. */
    struct notes notes;
};

/** Sites without a point, with capacity for @p capacity of them. */
conus_status sites_create(conus_sites **out, size_t capacity, bool has_normals);

/** Appends one; @p normal is NULL without normals. */
conus_status sites_add(conus_sites *sites, const double point[3], const double *normal, uint64_t source);

/** Sites by the cube in which they are: those in a bucket are linked. */
struct site_cubes {
    double edge;   /**< mm */
    size_t *first; /**< [mask + 1] Number of a site from 1, 0 = none. */
    size_t *next;  /**< [count] Likewise, of each. */
    size_t mask;
    size_t count; /**< So many are in it, the first ones. */
};

/** For up to @p capacity sites. */
conus_status site_cubes_init(struct site_cubes *out, double edge, size_t capacity);
void site_cubes_finish(struct site_cubes *cubes);

/** Adds the next site, which is at @p point. */
void site_cubes_add(struct site_cubes *cubes, const double point[3]);

/** Index of the nearest site that is nearer than the edge, the first of equally near ones; SIZE_MAX = there is none. */
size_t site_cubes_nearest(const struct site_cubes *cubes, const conus_sites *sites, const double point[3]);

/** Keeps the sites for which @p is_kept is true. */
void sites_filter(conus_sites *sites, bool (*is_kept)(const conus_sites *sites, size_t index, void *user), void *user);

#endif
