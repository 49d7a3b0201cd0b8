/* SPDX-License-Identifier: BSD-3-Clause */
/* How well the numbers of a table match those of a volume. */
#include "loaders/labels/label_fit.h"

#include "base/memory.h"
#include "loaders/tables/label_cells.h"

conus_status label_fit_find(struct label_fit *out, const struct label_table *table, const struct label_use *use)
{
    struct label_fit fit = {.complete = true};
    bool *seen = memory_zeroed(table->count + 1, sizeof *seen);
    if (!seen) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 1; fit.complete && i < use->voxels->label_count; i++) { /* the first is 0 */
        uint32_t number = use->voxels->labels[i];
        const struct label *label = label_table_find(table, number);
        fit.complete = label && label->name;
        if (fit.complete) {
            seen[label - table->entries] = true;
        } else {
            fit.unnamed = number;
        }
    }
    for (size_t i = 0; i < table->count; i++) {
        fit.names += table->entries[i].name != NULL;
        fit.used += seen[i];
    }
    memory_free(seen);
    *out = fit;
    return CONUS_OK;
}

bool label_fit_is_good(const struct label_fit *fit, const struct label_table *table)
{
    bool background = !table->zero || label_is_background(text_from(table->zero));
    return fit->complete && background && fit->used && 10 * fit->used >= 9 * fit->names;
}
