/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The candidates for a volume's label table: which is used, and whether they contradict each other. */
#ifndef CONUS_LOADERS_LABELS_LABEL_SEARCH_H
#define CONUS_LOADERS_LABELS_LABEL_SEARCH_H

#include "atlas/labels/labels.h"
#include "base/buffer.h"
#include "loaders/labels/label_find.h"

struct label_search;

/** Says whether @p table, from the file @p path, may be offered; notes why. */
typedef conus_status (*label_judge)(bool *taken, struct label_search *search, const struct label_table *table,
                                    const char *path);

struct label_search {
    struct label_volume *volume;
    struct label_use use; /**< path: of the table that is being read.                 */
    struct notes *notes;
    struct label_table table;
    bool found;            /**< table is filled; later ones are only compared with it. */
    bool proved;           /**< ... and its numbers are those of the volume.           */
    struct file_sums read; /**< The files that the table was read from. */
    struct buffer source;  /**< "MRIcron text in aal.nii.txt".                         */
    label_judge judge; /**< Called before a table is offered that only its name connects with the volume: a file that is
                          no table, or damaged, is passed over. NULL: not called. */
    struct buffer first_error; /**< The first candidate that was damaged: an error only if nothing else is found. */
};

void label_search_finish(struct label_search *search);

/** A table that was read, and what was noted on the way. */
struct label_offer {
    struct label_table table;
    struct notes notes;
    struct buffer source;
    bool proved;
    const char *path;         /**< The table's file. */
    const struct bytes *file; /**< Its bytes; NULL for a table inside the volume's file. */
};

/** Uses the table of @p offer if it is the first, or if only its numbers are proved and names have others. One that
 * contradicts the table in use is CONUS_ERROR_DATA, one that differs a note. Finishes @p offer. */
conus_status label_search_offer(struct label_search *search, struct label_offer *offer);

/** Notes the labels that @p other, from @p other_source, names differently than @p used, from @p source, does; both
 * belong to one volume. */
conus_status label_tables_note(bool *differ, const struct label_table *used, const char *source,
                               const struct label_table *other, const char *other_source, struct notes *notes);

/** Tries @p text, called @p path in messages, which is that of @p file or, where that is NULL, lies in the volume's. */
conus_status label_search_bytes(struct label_search *search, const char *path, const struct bytes *file,
                                struct text text);

/** Tries the file @p path, if it exists. */
conus_status label_search_file(struct label_search *search, const char *path);

#endif
