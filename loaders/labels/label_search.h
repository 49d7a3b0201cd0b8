/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The candidates for a volume's label table: which is used, and whether they contradict each other. */
#ifndef CONUS_LOADERS_LABELS_LABEL_SEARCH_H
#define CONUS_LOADERS_LABELS_LABEL_SEARCH_H

#include "base/files/file.h"
#include "loaders/labels/label_find.h"

struct label_search;

/** Says whether @p table, from the file @p path, may be offered; notes why. */
typedef bool label_judge(struct job *job, const struct label_search *search, const struct label_table *table,
                         const char *path);

struct label_search {
    const struct label_volume *volume;
    struct label_use use;
    struct label_table *table; /**< The job's. */
    const char *source;        /**< "MRIcron text in aal.nii.txt", of the table; NULL = none was found. */
    bool proved;               /**< The table's numbers are those of the volume. */
    size_t files;              /**< Files of the job that have nothing to do with the table. */
    label_judge *judge;        /**< Called before a table is offered that only its name connects with the volume: a file
                                  that is no table, or damaged, is passed over. NULL: not called. */
    const char *why;           /**< The error of the first candidate that was damaged: an error only if nothing else is
                                  found. NULL: none. */
};

/** A table that was read, and what was noted on the way. */
struct label_offer {
    struct label_table *table;
    struct notes notes;
    const char *source;
    bool proved;
    const char *path;         /**< The table's file. */
    const struct bytes *file; /**< Its bytes; NULL for a table inside the volume's file. */
};

/** Uses the table of @p offer if it is the first, or if only its numbers are proved and names have others. One that
 * contradicts the table in use is CONUS_ERROR_DATA, one that differs a note. Finishes the notes of @p offer. */
void label_search_offer(struct job *job, struct label_search *search, struct label_offer *offer);

/** Notes the labels that @p other, from @p other_source, names differently than @p used, from @p source, does; both
 * belong to one volume. Whether there are any. */
bool label_tables_note(struct job *job, const struct label_table *used, const char *source,
                       const struct label_table *other, const char *other_source);

/** Tries @p text, called @p path in messages, which is that of @p file or, where that is NULL, lies in the volume's. */
void label_search_text(struct job *job, struct label_search *search, const char *path, const struct bytes *file,
                       struct text text);

/** Tries the file @p path, if it exists. */
void label_search_file(struct job *job, struct label_search *search, const char *path);

#endif
