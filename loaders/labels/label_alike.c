/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables in a volume's folder whose name is like the volume's: labels_X.csv of atlas_X.nii.gz. The name must leave no
 * other volume in the folder that the table could be of, and the numbers must fit. */
#include "loaders/labels/label_alike.h"

#include "atlas/labels/label_voxels.h"
#include "atlas/labels/labels.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/label_bytes.h"
#include "loaders/labels/label_cells.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_search.h"
#include "loaders/labels/label_use.h"
#include "loaders/labels/label_words.h"

#include <string.h>

struct label_fit {
    size_t names;     /**< Of the table.                                                */
    size_t used;      /**< Of them, those whose number a voxel has.                     */
    uint32_t unnamed; /**< The first number of a voxel that has no name, in the order of the voxels; 0: all have one. */
    size_t strays;    /**< Voxels whose number has no name,                             */
    size_t voxels;    /**< of so many that have one other than 0.                       */
};

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

/* Compares table with the voxels of use, which has some. */
static conus_status label_fit_find(struct label_fit *out, const struct label_table *table, const struct label_use *use)
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

/* Whether it is good enough for a table that only its name connects with the volume: every number of a voxel has a
 * name, but for one in 100,000 voxels, nine in ten names have a voxel, and 0 is no area's. */
static bool label_fit_is_good(const struct label_fit *fit, const struct label_table *table)
{
    bool background = !table->zero || label_is_background(text_from(table->zero));
    return fit->strays <= fit->voxels / STRAYS && background && fit->used && 10 * fit->used >= 9 * fit->names;
}

#define TABLE_ENDINGS ".nii.txt/.nii.lut/.niml.lt/.txt/.tsv/.json/.label/.ctbl/.csv/.lut/.ctab"

enum {
    FOLDER_LIMIT = 4096, /* names that names_list() gives at most: one more could be another volume */
    TABLE_LIMIT = 16,    /* candidates that are read */
};

/* Length of the name without the ending of a table; 0 if it has none. */
static size_t table_stem_length(const char *name)
{
    size_t ending = path_ending_length(name, TABLE_ENDINGS);
    return ending ? strlen(name) - ending : 0;
}

/* Names that begin with a dot are of no one's making: macOS puts one beside every file of other file systems. */
static bool is_volume(const char *name)
{
    return name[0] != '.' && volume_stem_length(name) < strlen(name);
}

/* What the names in the folder leave open about one table. */
struct folder {
    const struct names *names;
    const char *folder;
    struct text stem; /* of the volume */
    struct label_words volume;
};

/* Whether another volume, of other words, could be the one that `table` is of. */
static bool is_of_another(const struct folder *folder, const struct label_words *table)
{
    bool exact = label_words_equal(&folder->volume, table);
    for (size_t i = 0; i < folder->names->count; i++) {
        const char *name = folder->names->names[i];
        struct text stem = {name, volume_stem_length(name)};
        bool own = stem.size == folder->stem.size && memcmp(name, folder->stem.data, stem.size) == 0;
        struct label_words words;
        if (!is_volume(name) || own) {
            continue;
        }
        label_words_find(&words, stem);
        bool same = label_words_equal(&words, &folder->volume);
        bool could = words.overflow || label_words_contain(&words, table);
        if (table->count ? could && !same && !exact : same || !exact) {
            return true; /* a table without words is of the only volume, or the only one without words */
        }
    }
    return false;
}

/* Whether no other file in the folder is a table of a known format. */
static conus_status is_only_table(bool *out, const struct folder *folder, const char *table, uint64_t max_memory)
{
    conus_status status = CONUS_OK;
    *out = true;
    for (size_t i = 0; !status && *out && i < folder->names->count; i++) {
        const char *name = folder->names->names[i];
        struct bytes bytes = {0};
        if (name[0] == '.' || !table_stem_length(name) || strcmp(name, table) == 0) {
            continue;
        }
        char *path = file_beside(folder->folder, name);
        status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (!status && file_exists(path)) { /* one that cannot be read may be a table */
            *out = !label_file_bytes(&bytes, path, max_memory) &&
                   !label_format_of(text_from_bytes(bytes.data, bytes.size));
        }
        bytes_finish(&bytes);
        memory_free(path);
    }
    return status;
}

static conus_status judge(bool *taken, struct label_search *search, const struct label_table *table, const char *path)
{
    struct label_fit fit;
    const char *name = path_base(path);
    const char *volume = path_base(search->volume->info->path);
    conus_status status = label_fit_find(&fit, table, &search->use);
    *taken = !status && label_fit_is_good(&fit, table);
    if (status) {
        return status;
    }
    if (!*taken && fit.unnamed) {
        return notes_warn(search->notes,
                          "%s is not taken for the label table: it has no name for label %u (of %zu voxels %zu have no "
                          "name); --labels %s uses it all the same",
                          name, fit.unnamed, fit.voxels, fit.strays, name);
    }
    if (!*taken) {
        return notes_warn(
            search->notes,
            "%s is not taken for the label table: of its %zu names %zu have voxels%s; --labels %s uses it "
            "all the same",
            name, fit.names, fit.used,
            table->zero && !label_is_background(text_from(table->zero)) ? ", and it calls 0 an area" : "", name);
    }
    if (search->found) {
        return notes_add(search->notes, "%s fits the labels, too: --labels chooses it", name);
    }
    if (fit.unnamed) {
        status = notes_warn(search->notes, "label %u has no name in %s: of %zu voxels %zu have none", fit.unnamed, name,
                            fit.voxels, fit.strays);
    }
    return status
               ? status
               : notes_add(
                     search->notes,
                     "%s is taken for the label table of %s by its name: %s labels have a name in it, and %zu of its "
                     "%zu names have voxels; --labels chooses another",
                     name, volume, fit.unnamed ? "nearly all" : "all", fit.used, fit.names);
}

static conus_status try_table(struct label_search *search, const struct folder *folder, const char *name)
{
    char *path = file_beside(folder->folder, name);
    search->judge = judge;
    conus_status status = path ? label_search_file(search, path) : CONUS_ERROR_MEMORY;
    search->judge = NULL;
    memory_free(path);
    return status;
}

static conus_status consider(bool *tried, struct label_search *search, const struct folder *folder, const char *name)
{
    struct text stem = {name, table_stem_length(name)};
    struct label_words words;
    bool only = true;
    *tried = false;
    label_words_find(&words, stem);
    bool same = stem.size == folder->stem.size && memcmp(name, folder->stem.data, stem.size) == 0; /* X.tsv was tried */
    if (name[0] == '.' || !stem.size || same || !label_words_contain(&folder->volume, &words)) {
        return CONUS_OK;
    }
    bool other = is_of_another(folder, &words);
    conus_status status = words.count || other ? CONUS_OK : is_only_table(&only, folder, name, search->use.max_memory);
    *tried = !status && only && !other;
    return status || !*tried ? status : try_table(search, folder, name);
}

conus_status label_search_alike(struct label_search *search, const char *folder)
{
    const char *name = path_base(search->volume->info->path);
    struct names names = {0};
    struct folder here = {.names = &names, .folder = folder, .stem = {name, volume_stem_length(name)}};
    size_t tries = 0;
    conus_status status = search->use.voxels ? names_list(&names, folder, VOLUME_ENDINGS "/" TABLE_ENDINGS) : CONUS_OK;
    label_words_find(&here.volume, here.stem);
    for (size_t i = 0; !status && names.count < FOLDER_LIMIT && tries < TABLE_LIMIT && i < names.count; i++) {
        bool tried;
        status = consider(&tried, search, &here, names.names[i]);
        tries += !status && tried;
    }
    names_finish(&names);
    return status;
}
