/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON and MAT-files, parsed once: for the question of whose they are, and for their reader. */
#include "poses/programs/pose_programs.h"

json_t *pose_json(struct pose_reading *to, struct text text)
{
    if (!to->json || to->parsed.data != text.data) {
        to->parsed = text;
        to->json = json_text_read(to->job, text);
    }
    return job_ok(to->job) ? to->json : NULL;
}

static void finish_matlab(void *matlab)
{
    matlab_finish(matlab);
}

const struct matlab *pose_matlab(struct pose_reading *to, struct text text)
{
    static const struct matlab nothing = {0};
    struct matlab *matlab = to->matlab ? NULL : job_new(to->job, struct matlab);
    if (matlab && JOB_CALL(to->job, matlab_parse(matlab, text, pose_memory(to->options) - text.size))) {
        job_own(to->job, finish_matlab, matlab);
        to->matlab = matlab;
    }
    return job_ok(to->job) ? to->matlab : &nothing;
}
