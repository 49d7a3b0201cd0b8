/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables that a job makes. */
#include "loaders/labels/labels.h"

#include "base/formats/encoding.h"

#include <string.h>

static void finish_table(void *table)
{
    label_table_finish(table);
}

void labels_own(struct job *job, struct label_table *table)
{
    job_own(job, finish_table, table);
}

struct label_table *labels_new(struct job *job)
{
    struct label_table *table = job_new(job, struct label_table);
    if (!table) {
        return job_spare(job, sizeof *table);
    }
    labels_own(job, table);
    return table;
}

struct label *labels_add(struct job *job, struct label_table *table, uint32_t number)
{
    struct label *label = job_step(job) ? label_table_add(table, number) : NULL;
    return job_need(job, label) ? label : job_spare(job, sizeof *label);
}

void labels_set(struct job *job, char **field, struct text text)
{
    (void)JOB_CALL(job, label_set_text(field, text));
}

void labels_sort(struct job *job, struct label_table *table)
{
    (void)JOB_CALL(job, label_table_sort(table, &job->notes));
}

void labels_move(struct job *job, struct label_table *out, struct label_table *table)
{
    if (job_ok(job)) {
        *out = *table;
        *table = (struct label_table){0};
    }
}

struct notes label_notes_swap(struct job *job, struct notes notes)
{
    struct notes before = job->notes;
    job->notes = notes;
    return before;
}

void labels_decode(struct job *job, struct text *text)
{
    char *owned = NULL;
    if (JOB_CALL(job, encoding_decode(&owned, text, &job->notes)) && owned) {
        job_adopt(job, owned);
    }
}
