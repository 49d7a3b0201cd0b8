/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens, resumes and finishes the output of a batch, and says how a broken one can be resumed. */
#include "batch/batch_output.h"

#include "options/messages.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool has_size(const char *path, uint64_t size)
{
    struct stat info;
    return stat(path, &info) == 0 && (uint64_t)info.st_size == size;
}

/* Whether an earlier run has written all of it; takes over what it counted. */
static bool is_complete(struct batch_file *file, const struct work *work)
{
    struct batch_record record;
    if (batch_file_is_begun(work->output) || access(work->output, F_OK) || access(work->sidecar, F_OK) ||
        batch_record_read(&record, work->sidecar) || strcmp(record.fingerprint, work->fingerprint) != 0 ||
        record.shard.index != work->shard.index || record.shard.count != work->shard.count ||
        !has_size(work->output, record.bytes)) {
        return false;
    }
    file->poses = record.poses;
    file->errors = record.errors;
    file->is_finished = true;
    return true;
}

int batch_output_open(struct batch_file *out, struct work *work)
{
    char fingerprint[160];
    *out = (struct batch_file){.rows = -1, .log = -1};
    int code = work_identify(work);
    if (code || (work->settings->resume && is_complete(out, work))) {
        return code;
    }
    code = batch_file_is_begun(work->output) ? EXIT_DONE : work_check_output(work);
    if (code) {
        return code;
    }
    snprintf(fingerprint, sizeof fingerprint, "%s %" PRIu64 "/%" PRIu64, work->fingerprint, work->shard.index,
             work->shard.count);
    return batch_file_open(out, work->output, fingerprint, conus_batch_header(work->batch),
                           work->settings->force    ? BATCH_FORCE
                           : work->settings->resume ? BATCH_RESUME
                                                    : BATCH_ANEW);
}

int batch_output_finish(struct batch_file *file, struct work *work)
{
    struct batch_record record = {.poses = file->poses, .errors = file->errors, .bytes = file->size, .crc = file->crc};
    int code = work_write_sidecar(work, &record);
    return code ? code : batch_file_finish(file);
}

/* The command line that resumes this batch; NULL without memory. */
static char *command_to_resume(const struct arguments *arguments)
{
    struct arguments changed = *arguments;
    char **words = calloc((size_t)arguments->count + 1, sizeof *words);
    char *text = NULL;
    changed.words = words;
    changed.count = 0;
    for (int i = 0; i < arguments->count && words; i++) {
        if (strcmp(arguments->words[i], "--force") != 0 && strcmp(arguments->words[i], "--resume") != 0) {
            words[changed.count++] = arguments->words[i];
        }
    }
    if (words) {
        static char resume[] = "--resume";
        words[changed.count++] = resume;
        text = arguments_text(&changed);
    }
    free(words);
    return text;
}

int batch_output_interrupted(const struct work *work, uint64_t poses, int signal)
{
    char *command = work->output && !work->piped ? command_to_resume(work->arguments) : NULL;
    print_error_line("interrupted after %" PRIu64 " poses%s%s", poses, command ? "; continue with: " : "",
                     command ? command : "");
    free(command);
    return 128 + signal;
}
