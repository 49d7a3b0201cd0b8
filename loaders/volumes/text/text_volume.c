/* SPDX-License-Identifier: BSD-3-Clause */
/* What a header of text says: its strings, and the labels in it. */
#include "loaders/volumes/text/text_volume.h"

#include "base/memory.h"

#include <string.h>

void text_volume_finish(struct text_volume *volume)
{
    if (!volume) {
        return;
    }
    for (size_t i = 0; i < volume->segment_count; i++) {
        label_finish(&volume->segments[i].label);
    }
    for (int64_t i = 0; volume->titles && i < volume->count; i++) {
        memory_free(volume->titles[i]);
    }
    memory_free(volume->segments);
    memory_free(volume->titles);
    memory_free(volume->slopes);
    memory_free(volume->labels);
    memory_free(volume->file);
    *volume = (struct text_volume){0};
}

static conus_status add_copy(struct label_table *table, const struct label *label)
{
    struct label *entry = label_table_add(table, label->number);
    if (!entry) {
        return CONUS_ERROR_MEMORY;
    }
    entry->has_rgb = label->has_rgb;
    memcpy(entry->rgb, label->rgb, sizeof entry->rgb);
    entry->name = label->name ? memory_text(label->name, strlen(label->name)) : NULL;
    return label->name && !entry->name ? CONUS_ERROR_MEMORY : CONUS_OK;
}

conus_status text_volume_labels(struct label_table *out, const struct text_volume *volume, size_t index,
                                struct notes *notes)
{
    struct label_table table = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < volume->segment_count; i++) {
        const struct text_segment *segment = &volume->segments[i];
        status = segment->volume == index ? add_copy(&table, &segment->label) : CONUS_OK;
    }
    status = status ? status : label_table_sort(&table, notes);
    if (status) {
        label_table_finish(&table);
    } else {
        *out = table;
    }
    return status;
}
