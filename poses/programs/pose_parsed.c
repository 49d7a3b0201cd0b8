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

const struct matlab *pose_matlab(struct pose_reading *to, struct text text)
{
    if (!to->matlab) {
        to->matlab = matlab_read(to->job, text, pose_memory(to->options) - text.size);
    }
    return to->matlab;
}
