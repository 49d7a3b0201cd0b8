/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Entries of label tables and their cells, for all formats. */
#ifndef CONUS_LOADERS_LABELS_LABEL_CELLS_H
#define CONUS_LOADERS_LABELS_LABEL_CELLS_H

#include "atlas/labels/label_voxels.h"
#include "atlas/labels/labels.h"
#include "base/formats/xml.h"

/** Appends @p label, if filling it gave @p status CONUS_OK; else returns @p status. Its strings are taken over in any
 * case. Label 0 is background: only its name is kept (the first), with a note where its name does not say so: a table
 * that counts from 0 names every area wrongly. */
conus_status label_keep(struct label_table *table, struct label *label, conus_status status, struct notes *notes);

/** Whether @p name says that what is called so is no area: "unknown", "Air", "*.*.*". */
bool label_is_background(struct text name);

/** Takes the first label out of @p table, whose numbers are those of volumes from 1, where that is volume 0 and is
 * called background; a note says so. */
conus_status label_drop_background(bool *dropped, struct label_table *table, struct notes *notes);

/** Number and colour of Workbench's and GIFTI's <Label Key= Red= Green= Blue=>; its name is the element's text. */
conus_status label_element(struct label *out, const struct xml_event *event);

/** A <Label> of GIFTI or CIFTI while it is open, whose number may be below 0. */
struct label_entry {
    struct label label;
    bool negative;
};

/** At its start tag. */
conus_status label_entry_start(struct label_entry *entry, const struct xml_event *event);

/** At its end tag, with the name in between: appends it to @p table. 0 and what lies below stand for no area; a note
 * says so where the name does not. The entry is empty afterwards, on failure, too. */
conus_status label_entry_end(struct label_entry *entry, struct label_table *table, struct text name,
                             struct notes *notes);

/** Parses a table whose numbers stand in candidate @p number of several, @p called so; none where there is no such one.
 */
typedef conus_status label_trial(struct label_table *out, struct text *called, void *user, size_t number,
                                 struct notes *notes);

/** The candidate of @p count whose table names most labels of the voxels; of equal ones the first. One that cannot be
 * parsed names none. *best is the one that is taken without voxels, and where none names any; a note tells another. */
conus_status label_choose(size_t *best, label_trial *trial, void *user, size_t count, const struct label_voxels *voxels,
                          struct notes *notes);

/** Values of cells. @p where ("line 7", "entry 3") starts the message. */
conus_status label_cell_number(uint32_t *out, struct text cell, const char *where);
conus_status label_cell_channel(uint8_t *out, struct text cell, const char *channel, const char *where);
conus_status label_cell_fraction(uint8_t *out, struct text cell, const char *channel, const char *where);
/** "#rrggbb", "rrggbb", "rgb(R,G,B)" or "rgba(R,G,B,A)". */
conus_status label_cell_colour(uint8_t out[3], struct text cell, const char *where);
/** 'L', 'R', 'B' from the usual words for them, 0 from any other. */
char label_hemisphere_of(struct text cell);
/** Red, green, blue by @p parse_channel (one of the two above). */
conus_status label_cell_rgb(struct label *label, const struct text cells[3],
                            conus_status (*parse_channel)(uint8_t *, struct text, const char *, const char *),
                            const char *where);

#endif
