/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's annotations, in which every label of a vertex must be in the table; and its lists of vertices. */
#include "loaders/surfaces/parts.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct text text = {(const char *)data, size};
    size_t count;
    struct job job = {0};
    struct label_table *table = labels_new(&job);
    struct reader r = reader_of(&job, text);
    const uint32_t *labels = freesurfer_annot_read(&r, table, &count);
    for (size_t i = 0; labels && i < count; i++) {
        if (labels[i] && !label_table_find(table, labels[i])) {
            abort();
        }
    }
    job_end(&job);
    labels = text_starts(text, "#!ascii label") ? freesurfer_label_read(&job, text, &count) : NULL;
    if (labels && (!count || labels[count - 1] != 1)) { /* the last one is in the list */
        abort();
    }
    job_end(&job);
    return 0;
}
