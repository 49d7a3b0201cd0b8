/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The catalogue while it is filled, and the limits of the search. What a search needs is its job's, which ends
 * with each place; what is found is the catalogue's. */
#ifndef CONUS_LOADERS_CATALOGUE_CATALOGUE_H
#define CONUS_LOADERS_CATALOGUE_CATALOGUE_H

#include "base/job/job.h"
#include "conus/own.h"

enum {
    CATALOGUE_ATLASES = 4096, /**< At most so many atlases of one source; the others are left out, with a note. So are
                                 as many images, without one. */
    CATALOGUE_ENTRIES = 20000 /**< Files and folders that are looked at for one source. */
};

/** Which file or folder it is. */
struct catalogue_id {
    uint64_t device, inode;
};

struct catalogue_item {
    conus_installed atlas;
    const char *alias;      /**< Another name, or NULL. */
    struct catalogue_id id; /**< Of atlas.path, once it is added. */
    bool is_image;          /**< A volume that counts as no labels. */
};

/** The source that is looked at. */
struct catalogue_source {
    const char *name;
    size_t first, first_image;         /**< Its first items. */
    size_t seen;                       /**< Files and folders so far. */
    bool full;                         /**< A limit is reached, as a note says. */
    LIST(struct catalogue_id) folders; /**< That were listed, each once: no link leads around in circles. */
};

typedef LIST(struct catalogue_item) catalogue_items;

struct conus_catalogue {
    struct job job; /**< Owns all texts and lists, and has the notes. */
    struct note_sink sink;
    catalogue_items items;  /**< Atlases. */
    catalogue_items images; /**< Volumes beside them, for conus_catalogue_find_image(). */
    LIST(conus_catalogue_place) places;
    struct catalogue_source source;
};

/** Adds a copy of an atlas, or image, whose path is there, with names made plain, unless the source has this file by
 * this name already. */
void catalogue_add(struct job *job, conus_catalogue *catalogue, const struct catalogue_item *found);

enum catalogue_kind { CATALOGUE_NOTHING, CATALOGUE_FILE, CATALOGUE_FOLDER };

/** What is at @p path; an empty file is nothing: TemplateFlow has them until it fetches them. */
enum catalogue_kind catalogue_at(const char *path);

/** The entries of the folder, sorted, without hidden ones. None of a folder that was listed before or is not there, and
 * none, with a note, of one that cannot be read or is beyond a limit. */
struct names catalogue_list(struct job *job, conus_catalogue *catalogue, const char *folder);

/** "folder/name". */
const char *catalogue_join(struct job *job, const char *folder, const char *name);

/** How a folder is looked through. */
struct folder_rule {
    size_t depth;                /**< Levels of folders below that are looked at. */
    const char *const *patterns; /**< For names of labelled volumes, NULL at the end; NULL: volume_marks.c decides. */
    const char *cut;             /**< Ending of a name without the file's that is no part of it; NULL = none. */
    bool subjects;               /**< It holds subjects of FreeSurfer. */
    bool versions;               /**< It holds atlases of BrainGlobe's third release. */
};

/** Adds the labelled volumes, manifests, FSL atlases and BrainGlobe folders in a folder and in those below it, and all
 * other volumes as images. */
void folder_look(struct job *job, conus_catalogue *catalogue, const char *folder, const struct folder_rule *rule);

/** Adds the atlases of BrainGlobe's third release in @p folder: of each the newest version by its name, and the others
 * with "_v1.1" behind it, by which the newest is known, too. */
void brainglobe_look(struct job *job, conus_catalogue *catalogue, const char *folder);

/** Adds, of each subject in @p folder, the segmentations in mri/ ("bert.aseg", with FreeSurfer's table of labels if
 * there is one) and the annotations in label/ on the pial surface of their side ("bert.lh.aparc"), or the white one.
 * Nothing is opened. */
void freesurfer_look(struct job *job, conus_catalogue *catalogue, const char *folder);

/** Adds the labelled volumes that an FSL atlas XML names, if they are there: the finest under the XML's name, others
 * with "-2mm" behind it, all with the XML as their label table. An XML of another kind, or damaged, is passed over; one
 * without such a volume is a note. */
void fsl_look(struct job *job, conus_catalogue *catalogue, const char *xml_path);

/* Whether a volume holds labels, by its name, its header and what lies beside it. No voxel is read. */

/** Whether the ending of @p name is that of a volume (of a pair, of the header). */
bool volume_marks_is_volume(const char *name);

/** Whether @p name fits one of @p patterns, NULL at the end, and @p how as for text_matches(). */
bool volume_marks_fit(const char *name, const char *const *patterns, unsigned how);

/** Decides whether the one volume in the file @p path counts as labels, and sets @p spacing to its voxels' edge lengths
 * in mm. A volume of a @p known name does. Others need a mark: NIfTI's intent "label", a label table inside, one beside
 * it that bears its name, or a name as label volumes have. A file that cannot be read is no atlas. */
bool volume_marks_find(struct job *job, double spacing[3], const char *path, bool known);

#endif
