/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A scene and its manifest: read, written, and made of the files of a folder. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh_space.h"
#include "base/files/file.h"
#include "base/job/job.h"
#include "conus/own.h"

/* What one scene is made of, and its JSON, the atlas manifest NAME.atlas.json (docs/formats.md, "Atlas manifest").
 * Reading that opens none of the files. Strict: what the tables do not know is an error, with the key's path
 * ("pathways[2].threshold"). */

enum {
    MANIFEST_VERSION = 1,
    MANIFEST_FEW = 64,   /**< The most entries of a list whose entries are all compared with each other: parcellations,
                            transforms. */
    MANIFEST_MANY = 4096 /**< Entries of a list of files: pathways, probabilities, streamlines, contexts. */
};

/** What an item is, which decides about the keys that it may have. */
enum item_kind {
    ITEM_PARCELLATION = 1 << 0,
    ITEM_AREA = 1 << 1,          /**< One surface. */
    ITEM_AREAS = 1 << 2,         /**< Those that match a pattern: * and ? in the last part of the path. */
    ITEM_MESHES = 1 << 3,        /**< Those of a BrainGlobe folder of structures.json and meshes/ID.obj. */
    ITEM_NODE = 1 << 4,          /**< A parent, or an area without a shape that groups others. */
    ITEM_PROBABILITIES = 1 << 5, /**< An area, or with names or fsl one for each volume of a 4-D file. */
    ITEM_PATHWAY = 1 << 6,       /**< Likewise, or one for each band. */
    ITEM_STREAMLINES = 1 << 7,   /**< A tractogram: one bundle, or its groups. */
    ITEM_TRANSFORM = 1 << 8,     /**< Of points from the space of poses to that of the areas. */
    ITEM_CONTEXT = 1 << 9,
    ITEM_SURFACES = ITEM_AREA | ITEM_AREAS | ITEM_MESHES,
    ITEM_LABELLED = ITEM_SURFACES | ITEM_PARCELLATION
};

/** A thing that is loaded: what all kinds have, flat. Zero is the default of each. */
struct scene_item {
    enum item_kind kind;
    const char *list;        /**< Its place in messages: the key; NULL: it has none, */
    size_t index;            /**< and the index of the entry there, or JOB_ALONE. */
    bool parts;              /**< Objects of the surface's file, or labels in it, are an area each. */
    bool noted;              /**< The notes about the file of labels have been given; in no JSON. */
    char *file;              /**< Or pattern, or folder; as written. NULL if fsl names the images. */
    size_t volume;           /**< 1 + that of a 4-D file. */
    double resolution[3];    /**< Micrometres along page, row, column of a TIFF stack; 0 = as metadata.json says. */
    char *orientation;       /**< Where the axes start, three letters; NULL = as metadata.json says. */
    unsigned all_structures; /**< Of a BrainGlobe folder: not only those that contain no other with a surface. */
    char *labels;            /**< The table; NULL: as conus_atlas_load() finds it. Of ITEM_AREAS: none. */
    uint32_t label_offset;   /**< Added to the labels of voxels, vertices, names of files, and of the table. */
    struct label label;  /**< number 0: the first in the file's name. Hemisphere and parent are those of all areas that
                            say none. */
    char *vertex_labels; /**< Labels of the surface's vertices, which cut it into areas; NULL if none. */
    char *fsl;           /**< An FSL atlas XML that names the volumes of the file, or of its own finest image. */
    LIST(char *) names;  /**< Of the volumes. */
    double threshold;    /**< 0 = the scene's, else the default. */
    double scale;        /**< The value that means "certainly"; 0 = as the values say. Of meshes: mm per unit. */
    LIST(conus_band) bands; /**< One pathway for each. */
    const char *unit;       /**< What its values are, for legends; NULL: as the header or the file's name says; in no
                               JSON. */
    double radius;          /**< mm; 0 = the default. */
    char *from;             /**< The images of FSL's matrices; NULL otherwise. */
    char *to;
    bool inverse; /**< It moves points of the areas to where poses are. */
    char *grid;   /**< For fields: a volume with the voxels of the moved areas; NULL = the field's. */
    conus_vectors vectors;
    conus_file_space space;
    size_t transform;    /**< Place in a list of ITK's transforms: 1 + its number; 0 = none is chosen. */
    char *transfer;      /**< A preset's name; NULL if none. */
    char *transfer_file; /**< Or a file. */
    double blocks;       /**< Threshold from which on it stops rays; 0 if it does not. */
    double opacity;      /**< A surface's; 0 = the default. */
    bool moves;          /**< It is moved with the areas. */
};

/** The Allen CCF: the world's origin is the corner where AP, DV and ML start. */
enum scene_ccf {
    SCENE_CCF_UNSTATED,
    SCENE_CCF_ASR, /**< At the anterior, superior and right sides. */
    SCENE_CCF_ASL  /**< At the anterior, superior and left sides.  */
};

/** Whether the surface or the voxels are the area where a label has both. */
enum scene_preference { SCENE_PREFER_NONE, SCENE_PREFER_AREAS, SCENE_PREFER_PARCELLATION };

struct scene {
    bool allow_outside; /**< Paths may leave the manifest's folder. */
    LIST(struct scene_item)
    items;                 /**< Those of a kind are in their order: parcellations by priority, transforms as
                              points go through them. */
    enum mesh_space space; /**< The space of the surfaces' coordinates; unstated = as each file says. */
    char *image;           /**< Or a volume, in whose own mm they are, as FSL counts them; then `space` is RAS. */
    conus_brain brain;     /**< Whose the scene is, where poses are; 0 = unsaid. */
    enum scene_ccf ccf;
    enum scene_preference prefer;
    double threshold; /**< For pathways that give none; 0 = the default. */
};

/** The first item of @p kinds behind @p item, or of all where that is NULL; NULL if there is none. */
struct scene_item *scene_next(const struct scene *scene, unsigned kinds, const struct scene_item *item);
size_t scene_count(const struct scene *scene, unsigned kinds);

/** Adds @p item, at the end of its list. */
struct scene_item *scene_add(struct job *job, struct scene *scene, const struct scene_item *item);

/** True where @p text looks like a manifest: a JSON object with the key "conus_atlas". */
bool manifest_is(struct text text);

/** Reads the manifest @p text. All that the scene has is the job's. CONUS_ERROR_DATA with the key, or line and column
 * where it is no JSON. */
void scene_read(struct job *job, struct scene *out, struct text text);

/** Writes it as a manifest. */
struct text scene_write(struct job *job, const struct scene *scene);

/** How many files there are besides surfaces and label tables. Volumes of one file count each: they are unpacked one by
 * one. */
size_t scene_file_count(const struct scene *scene);

/* A manifest in the making: items are appended, if they load. It is a job's. */

struct manifest_draft {
    const char *folder; /**< With '/' at its end. */
    const conus_manifest_options *options;
    LIST(const char *) used; /**< Images that an FSL atlas names, from the folder and without ending. */
    struct scene scene;
    uint32_t label_offset; /**< Added to the labels of the next group of surfaces. */
    /** Loads a manifest, to try an item. NULL: every item is taken, and one that does not load is the reader's error.
     */
    conus_status (*load)(const struct manifest_draft *draft, struct text text);
};

/** The first item of @p kinds with the file @p name, or NULL. */
const struct scene_item *manifest_draft_find(const struct manifest_draft *draft, unsigned kinds, const char *name);

/** Gives a line to options->log. */
__attribute__((format(printf, 3, 4))) void manifest_draft_log(struct job *job, const struct manifest_draft *draft,
                                                              const char *format, ...);

/** Logs that @p name is left out, and @p why it does not load. */
void manifest_draft_leave_out(struct job *job, const struct manifest_draft *draft, const char *name, const char *why);

/** Tries whether @p items are a manifest of their own. NULL if they are, else the reason. */
const char *manifest_draft_try(struct job *job, const struct manifest_draft *draft, const struct scene_item *items,
                               size_t count);

/** Appends @p item if it loads; logs that @p name, unless NULL, is left out if not. Whether it loads. */
bool manifest_draft_take(struct job *job, struct manifest_draft *draft, const struct scene_item *item,
                         const char *name);

/* The likely role of each file of a folder in a scene: guesses for a first manifest. */

enum volume_use { VOLUME_LABELS, VOLUME_PATHWAY, VOLUME_SERIES, VOLUME_CONTEXT };

struct volume_guess {
    enum volume_use use;
    size_t count;      /**< Volumes in the file.              */
    const char *words; /**< The reason of the guess; static. */
};

/** Reads the volume @p path and guesses its role. Several volumes are pathways. Values that grey_judge_file() takes for
 * labels are labels, if a table names them or several values lie in pieces. Of other volumes those that are mostly zero
 * are pathways, all others the context. All values 0 are CONUS_ERROR_DATA. */
void volume_guess_make(struct job *job, struct volume_guess *out, const char *path);

/** Whether the names of volumes @p left and @p right differ only in the word for their side: x_LH.nii.gz and
 * x_RH.nii.gz, lh.x.mgz and rh.x.mgz. */
bool volume_names_are_halves(struct job *job, const char *left, const char *right);

/** Whether labels follow from the names of surfaces: each holds a number, and no two the same first one; or none does.
 */
bool surface_names_give_labels(const struct names *names);

/* Entries of a manifest for the surfaces in a folder, or for the files of BrainGlobe. */

enum { MANIFEST_LABEL_STEP = 10000 }; /**< Between the labels of two groups of surfaces. */

#define BRAINGLOBE_ANNOTATION "annotation.tiff"
#define BRAINGLOBE_REFERENCE "reference.tiff"

/** Whether annotation.tiff and structures.json lie in @p folder, which ends in '/'. */
bool brainglobe_has_voxels(struct job *job, const char *folder);

/** The folder, ending in '/', of the atlas that the folder @p path is the meshes of ("atlas/meshes" of "atlas"); NULL
 * if it is that of none. */
const char *brainglobe_of_meshes(struct job *job, const char *path);

/** Adds the surfaces in the folder @p name of the draft's ("" for that itself), or the BrainGlobe atlas that it is. */
void manifest_surfaces_add(struct job *job, struct manifest_draft *draft, const char *name);

/** The scene of the surfaces in @p folder (ending in '/'), or of the BrainGlobe atlas that it is: of its voxels, or of
 * its @p meshes where they are wanted or there is nothing else. */
void scene_of_folder(struct job *job, struct scene *out, const char *folder, bool meshes);

#endif
