/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Entries of label tables and their cells, for all formats. Where a cell stands ("line 7") is the job's place.
 */
#ifndef CONUS_LOADERS_LABELS_LABEL_CELLS_H
#define CONUS_LOADERS_LABELS_LABEL_CELLS_H

#include "base/formats/xml.h"
#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

/** An entry while it is read. */
struct label_row {
    struct label label;             /**< Without texts. */
    struct text name, abbreviation; /**< As they are written. */
    bool underscores;               /**< In the name, where spaces are meant. */
};

/** Appends the entry of @p row. Label 0 is background: only its name is kept (the first), with a note where its name
 * does not say so: a table that counts from 0 names every area wrongly. */
void labels_keep(struct job *job, struct label_table *table, const struct label_row *row);

/** Whether @p name says that what is called so is no area: "unknown", "Air", "*.*.*". */
bool label_is_background(struct text name);

/** Takes the first label out of @p table, whose numbers are those of volumes from 1, where that is volume 0 and is
 * called background; a note says so. Whether it did. */
bool label_drop_background(struct job *job, struct label_table *table);

/** Number and colour of Workbench's and GIFTI's <Label Key= Red= Green= Blue=>; its name is the element's text. */
void label_element(struct job *job, struct label *out, const struct xml_event *event);

/** A <Label> of GIFTI or CIFTI while it is open, whose number may be below 0. */
struct label_entry {
    struct label label;
    bool negative;
};

/** At its start tag, whose line is the caller's place. */
void label_entry_start(struct job *job, struct label_entry *entry, const struct xml_event *event);

/** At its end tag, with the name in between: appends it to @p table. 0 and what lies below stand for no area; a note
 * says so where the name does not. The entry is empty afterwards. */
void label_entry_end(struct job *job, struct label_entry *entry, struct label_table *table, struct text name);

/** Parses a table whose numbers stand in candidate @p number of several into @p out, and gives what that is called;
 * empty where there is no such one. */
typedef struct text label_trial(struct job *job, struct label_table *out, void *user, size_t number);

/** The candidate of @p count whose table names most labels of the voxels; of equal ones the first. One that cannot be
 * parsed names none. @p usual is the one that is taken without voxels, and where none names any; a note tells another.
 */
size_t label_choose(struct job *job, size_t usual, label_trial *trial, void *user, size_t count,
                    const struct label_voxels *voxels);

/** @name Values of cells; 0 and a failure where a cell has none @{ */
uint32_t label_cell_number(struct job *job, struct text cell);
/** Whether it is a whole number below 2^32, perhaps written as "17.0"; no failure. */
bool label_cell_whole(struct text cell, uint64_t *number);
typedef uint8_t label_cell_part(struct job *job, struct text cell, const char *channel);
label_cell_part label_cell_channel;  /**< From 0 to 255. */
label_cell_part label_cell_fraction; /**< From 0 to 1. */
/** Red, green, blue by @p part. */
void label_cell_rgb(struct job *job, struct label *label, const struct text cells[3], label_cell_part *part);
/** "#rrggbb", "rrggbb", "rgb(R,G,B)" or "rgba(R,G,B,A)". */
void label_cell_colour(struct job *job, uint8_t out[3], struct text cell);
/** The colour of a column that is called so, by label_cell_rgb(), or without @p part of one cell. What is none is
 * bad_rgb, no failure: a colour is not worth a table. */
void label_colour(struct job *job, struct label *label, const struct text *cells, label_cell_part *part);
/** 'L', 'R', 'B' from the usual words for them, 0 from any other. */
char label_hemisphere_of(struct text cell);
/** @} */

#endif
