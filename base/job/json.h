/* SPDX-License-Identifier: BSD-3-Clause */
/** @file JSON that a job reads. */
#ifndef CONUS_BASE_JOB_JSON_H
#define CONUS_BASE_JOB_JSON_H

#include "base/formats/json_text.h"
#include "base/job/job.h"

/** As json_text_load(). The value is the job's; NULL, which has nothing, after a failure. */
json_t *job_json(struct job *job, struct text text);

#endif
