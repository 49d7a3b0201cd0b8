/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the table of formats, and the readers of label tables for what it does not know. */
#include "loaders/file_kind.h"

#include "base/text.h"
#include "loaders/labels/label_format.h"

const struct file_kind *file_kind_of(const char *path, const struct bytes *head)
{
    static const struct file_kind table = {.words = "a label table", .way = "give it as --labels"};
    const struct file_kind *kind = format_find(path, head);
    struct text text = text_trim(text_from_bytes(head->data, head->size));
    return kind && kind->certainty != KIND_CERTAIN && text.size && label_format_of(text) ? &table : kind;
}

conus_status file_kind_fail(const char *path, const struct bytes *stored, const char *needed)
{
    struct bytes head = {stored->data, stored->size < FILE_KIND_HEAD ? stored->size : FILE_KIND_HEAD};
    struct bytes unpacked = {0};
    if (format_unpack_head(&unpacked, stored)) {
        head = unpacked;
    }
    conus_status status = format_fail(file_kind_of(path, &head), stored, needed);
    bytes_finish(&unpacked);
    return status;
}
