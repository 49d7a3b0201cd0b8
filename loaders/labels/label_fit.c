/* SPDX-License-Identifier: BSD-3-Clause */
/* How well the numbers of a table match those of a volume. */
#include "loaders/labels/label_fit.h"

#include "atlas/labels/label_voxels.h"
#include "base/memory.h"
#include "loaders/labels/label_cells.h"

enum { STRAYS = 100000 }; /* of so many voxels one may be of a label without a name */

static bool has_name(const struct label_table *table, uint32_t number)
{
    const struct label *label = label_table_find(table, number);
    return label && label->name;
}

static conus_status count_strays(struct label_fit *fit, const struct label_table *table, const struct label_use *use)
{
    struct label_map counts = {0};
    conus_status status = label_voxels_tally(&counts, use->voxels);
    for (size_t i = 1; !status && i < use->voxels->label_count; i++) { /* the first is 0 */
        uint32_t number = use->voxels->labels[i];
        const uint64_t *count = label_map_at(&counts, number);
        status = count ? CONUS_OK : CONUS_ERROR_MEMORY;
        fit->voxels += count ? *count : 0;
        fit->strays += count && !has_name(table, number) ? *count : 0;
    }
    label_map_finish(&counts);
    return status;
}

conus_status label_fit_find(struct label_fit *out, const struct label_table *table, const struct label_use *use)
{
    struct label_fit fit = {0};
    bool *seen = memory_zeroed(table->count + 1, sizeof *seen);
    if (!seen) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 1; i < use->voxels->label_count; i++) {
        uint32_t number = use->voxels->labels[i];
        if (has_name(table, number)) {
            seen[label_table_find(table, number) - table->entries] = true;
        } else {
            fit.unnamed = fit.unnamed ? fit.unnamed : number;
        }
    }
    for (size_t i = 0; i < table->count; i++) {
        fit.names += table->entries[i].name != NULL;
        fit.used += seen[i];
    }
    memory_free(seen);
    conus_status status = fit.unnamed ? count_strays(&fit, table, use) : CONUS_OK;
    if (!status) {
        *out = fit;
    }
    return status;
}

bool label_fit_is_good(const struct label_fit *fit, const struct label_table *table)
{
    bool background = !table->zero || label_is_background(text_from(table->zero));
    return fit->strays <= fit->voxels / STRAYS && background && fit->used && 10 * fit->used >= 9 * fit->names;
}
