/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's annotations, in which every label of a vertex must be in the table; and its lists of vertices. */
#include "base/memory.h"
#include "loaders/surfaces/freesurfer_labels.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint32_t *labels = NULL;
    size_t count = 0;
    struct label_table table = {0};
    struct notes notes = {0};
    if (!freesurfer_annot_parse(&labels, &count, &table, data, size, &notes)) {
        for (size_t i = 0; i < count; i++) {
            if (labels[i] && !label_table_find(&table, labels[i])) {
                abort();
            }
        }
        memory_free(labels);
        label_table_finish(&table);
    }
    notes_finish(&notes);
    const struct text text = {(const char *)data, size};
    if (text_starts(text, "#!ascii label") && !freesurfer_label_parse(&labels, &count, text)) {
        if (!count || labels[count - 1] != 1) { /* the last one is in the list */
            abort();
        }
        memory_free(labels);
    }
    return 0;
}
