/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON that a job ends. */
#include "base/job/json.h"

static void drop_root(void *root)
{
    json_decref(root);
}

json_t *job_json(struct job *job, struct text text)
{
    json_t *root = NULL;
    if (JOB_CALL(job, json_text_load(&root, text))) {
        job_own(job, drop_root, root);
    }
    return job_ok(job) ? root : NULL;
}
