/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the table of formats, and the readers of label tables for what it does not know. */
#include "loaders/refuse.h"

#include "base/formats/packed.h"
#include "loaders/labels/label_format.h"

const struct format *format_nearest(const struct file_head *head)
{
    static const struct format table = {.words = "a label table", .way = "give it as --labels"};
    const struct format *format = format_find(head, 0);
    return format && format->certainty != KIND_CERTAIN && head->start.size && label_format_of(head->start) ? &table
                                                                                                           : format;
}

void file_refuse(struct job *job, const char *path, const struct bytes *stored, const char *needed)
{
    struct source source = {0};
    if (JOB_CALL(job, source_of(&source, path, stored))) {
        (void)JOB_CALL(job, format_refuse(format_nearest(&source.head), stored, needed));
    }
    source_close(&source);
}

void source_refuse(struct job *job, const struct source *source, const char *needed)
{
    const struct bytes *stored = &source->stored;
    if (source->is_packed && !source->head.bytes.size) {
        struct bytes head = {0};
        (void)JOB_CALL(job, gzip_head(&head, stored->data, stored->size, HEAD_SIZE)); /* what is wrong with it */
        bytes_finish(&head);
        job_bad(job, "content: the file unpacks to nothing: it is empty or cut off; needed is %s", needed);
    }
    (void)JOB_CALL(job, format_refuse(format_nearest(&source->head), stored, needed));
}
