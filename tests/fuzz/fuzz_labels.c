/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a label table whose format is detected from its content. The labels that are read must be in order. */
#include "loaders/labels/label_format.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const struct label_table *table)
{
    for (size_t i = 0; i < table->count; i++) {
        const struct label *label = &table->entries[i];
        bool ordered = label->number > (i ? table->entries[i - 1].number : 0);
        if (!ordered || (label->name && !text_is_utf8(text_from(label->name))) ||
            label_table_find(table, label->number) != label) {
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct label_table table = {0};
    struct job job = {0};
    const char *format = NULL;
    static const struct label_use use;
    label_bytes_parse(&job, &table, &format, &(struct bytes){(uint8_t *)data, size}, &use);
    conus_status status = job_close(&job, NULL, NULL);
    if (status ? table.count || format : !table.count || !format) {
        abort();
    }
    check(&table);
    label_table_finish(&table);
    return 0;
}
