/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The catalogue while it is filled, and the limits of the search. */
#ifndef CONUS_LOADERS_CATALOGUE_CATALOGUE_H
#define CONUS_LOADERS_CATALOGUE_CATALOGUE_H

#include "base/files/folder.h"
#include "base/notes.h"
#include "conus/catalogue.h"

#include <stdint.h>
#include <sys/stat.h>

enum {
    CATALOGUE_ATLASES = 4096, /**< At most so many atlases of one source; the others are left out, with a note. */
    CATALOGUE_ENTRIES = 20000 /**< Files and folders that are looked at for one source. */
};

/** Which file or folder it is. */
struct catalogue_id {
    uint64_t device, inode;
};

struct catalogue_item {
    conus_installed atlas; /**< All texts but source and kind are owned. */
    char *alias;           /**< Another name, or NULL. */
    struct catalogue_id id;
};

struct conus_catalogue {
    struct catalogue_item *items;
    size_t count, capacity;
    conus_catalogue_place *places; /**< The paths are owned. */
    size_t place_count, place_capacity;
    struct notes notes;
    struct note_sink sink; /**< Gets the notes. */

    /* The source that is looked at now. */
    const char *source;
    size_t first;                 /**< Its first item. */
    size_t seen;                  /**< Files and folders so far. */
    bool full;                    /**< A limit is reached, as a note says. */
    struct catalogue_id *folders; /**< That were listed, each once: no link leads around in circles. */
    size_t folder_count, folder_capacity;
};

/** An atlas that was found. */
struct catalogue_found {
    const char *name, *alias; /**< Bytes; made plain here. alias may be NULL. */
    const char *kind;         /**< Static. */
    const char *path, *labels;
    double spacing[3];
    struct catalogue_id id; /**< Identifies the file `path`. */
};

/** Adds a copy, unless the source has this file by this name already. */
conus_status catalogue_add(conus_catalogue *catalogue, const struct catalogue_found *found);

struct catalogue_id catalogue_id_of(const struct stat *info);

/** Lists the entries of the folder, sorted, without hidden ones. The list is empty for a folder that was listed before
 * or is not there; it is empty, with a note, for one that cannot be read or is beyond a limit. @p out is the caller's
 * to finish, also on failure. */
conus_status catalogue_list(struct names *out, conus_catalogue *catalogue, const char *folder);

/** "folder/name", the caller's to memory_free(); NULL without memory. */
char *catalogue_join(const char *folder, const char *name);

/** How a folder is looked through. */
struct folder_rule {
    size_t depth;                /**< Levels of folders below that are looked at. */
    const char *const *patterns; /**< For names of labelled volumes, NULL at the end; NULL: volume_marks.h decides. */
    const char *cut;             /**< Ending of a name without the file's that is no part of it; NULL = none. */
    bool subjects;               /**< It holds subjects of FreeSurfer. */
    bool versions;               /**< It holds atlases of BrainGlobe's third release. */
};

/** Adds the labelled volumes, manifests, FSL atlases and BrainGlobe folders in a folder and in those below it. */
conus_status folder_look(conus_catalogue *catalogue, const char *folder, const struct folder_rule *rule);

/** Adds the atlases of BrainGlobe's third release in @p folder: of each the newest version by its name, and the others
 * with "_v1.1" behind it, by which the newest is known, too. */
conus_status brainglobe_look(conus_catalogue *catalogue, const char *folder);

/** Adds, of each subject in @p folder, the segmentations in mri/ ("bert.aseg", with FreeSurfer's table of labels if
 * there is one) and the annotations in label/ on the pial surface of their side ("bert.lh.aparc"), or the white one.
 * Nothing is opened. */
conus_status freesurfer_look(conus_catalogue *catalogue, const char *folder);

/** Adds the labelled volumes that an FSL atlas XML names, if they are there: the finest under the XML's name, others
 * with "-2mm" behind it, all with the XML as their label table. An XML of another kind, or damaged, is passed over; one
 * without such a volume is a note. */
conus_status fsl_look(conus_catalogue *catalogue, const char *xml_path);

#endif
