/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Label tables (atlas/labels/labels.h) that a job makes. Table and texts are the job's until the table is moved
 * out of it: `*out = *table; *table = (struct label_table){0};` gives them to who calls label_table_finish(). */
#ifndef CONUS_LOADERS_LABELS_LABELS_ON_JOB_H
#define CONUS_LOADERS_LABELS_LABELS_ON_JOB_H

#include "atlas/labels/labels.h"
#include "base/job/job.h"

/** An empty table; after a failure one that is none of the job's. */
struct label_table *labels_new(struct job *job);

/** The job finishes @p table when it ends. */
void labels_own(struct job *job, struct label_table *table);

/** As label_table_add(); after a failure a spare entry. */
struct label *labels_add(struct job *job, struct label_table *table, uint32_t number);

/** As label_set_text(). */
void labels_set(struct job *job, char **field, struct text text);

/** As label_table_sort(), with notes of the job. */
void labels_sort(struct job *job, struct label_table *table);

/** Gives all that @p table has to the empty @p out, unless the job has failed. */
void labels_move(struct job *job, struct label_table *out, struct label_table *table);

/** encoding_decode() of @p text into the job's memory. */
void labels_decode(struct job *job, struct text *text);

/** Makes the job's notes @p notes and gives those of before: so a table is read with notes of its own. */
struct notes label_notes_swap(struct job *job, struct notes notes);

#endif
