/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the table of formats, and the readers of label tables for what it does not know. */
#include "loaders/refuse.h"

#include "loaders/labels/label_format.h"
#include "sources/source.h"

const struct format *format_nearest(const struct file_head *head)
{
    static const struct format table = {.words = "a label table", .way = "give it as --labels"};
    const struct format *format = format_find(head, 0);
    return format && format->certainty != KIND_CERTAIN && head->start.size && label_format_of(head->start) ? &table
                                                                                                           : format;
}

conus_status file_refuse(const char *path, const struct bytes *stored, const char *needed)
{
    struct source source;
    conus_status status = source_of(&source, path, stored);
    status = status ? status : format_refuse(format_nearest(&source.head), stored, needed);
    source_close(&source);
    return status;
}
