/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables that a job makes. */
#include "loaders/labels/labels_on_job.h"

#include <string.h>

static void finish_table(void *table)
{
    label_table_finish(table);
}

struct label_table *labels_new(struct job *job)
{
    struct label_table *table = job_new(job, struct label_table);
    if (!table) {
        return memset(job->spare, 0, sizeof *table);
    }
    job_own(job, finish_table, table);
    return table;
}

struct label *labels_add(struct job *job, struct label_table *table, uint32_t number)
{
    struct label *label = job_step(job) ? label_table_add(table, number) : NULL;
    if (!label && job_ok(job)) {
        job_took(job, CONUS_ERROR_MEMORY);
    }
    return label ? label : memset(job->spare, 0, sizeof *label);
}

void labels_set(struct job *job, char **field, struct text text)
{
    (void)JOB_CALL(job, label_set_text(field, text));
}

void labels_sort(struct job *job, struct label_table *table)
{
    (void)JOB_CALL(job, label_table_sort(table, &job->notes));
}
