/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of batches: every row that is read names three files, and no output twice. */
#include "batch/batch_jobs.h"
#include "quiet.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct batch_jobs jobs;
    char *text = malloc(size + 1);
    if (!text) {
        return 0;
    }
    memcpy(text, data, size);
    text[size] = '\0';
    FILE *kept = be_quiet();
    int code = batch_jobs_parse(&jobs, "fuzz", text, size);
    stderr = kept;
    if (code) {
        return 0;
    }
    for (size_t i = 0; i < jobs.count; i++) {
        const struct batch_job *job = &jobs.jobs[i];
        if (!*job->atlas || !*job->poses || !*job->output) {
            abort();
        }
        for (size_t k = 0; k < i; k++) {
            if (strcmp(jobs.jobs[k].output, job->output) == 0) {
                abort();
            }
        }
    }
    batch_jobs_finish(&jobs);
    return 0;
}
