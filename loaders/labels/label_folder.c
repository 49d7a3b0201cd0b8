/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables in a volume's folder that do not bear its name: an inherited BIDS dseg.tsv, an atlas XML that names the
 * volume, tables with a similar name, and those that BrainGlobe and FreeSurfer call by fixed names. */
#include "loaders/labels/label_folder.h"

#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/fsl_find.h"
#include "loaders/labels/fsl_number.h"
#include "loaders/labels/label_alike.h"
#include "loaders/labels/label_freesurfer.h"
#include "loaders/labels/label_search.h"

#include <string.h>

/* Whether every entity ("res-01", "dseg") of the table's name is one of the volume's: then BIDS lets it inherit. */
static bool name_inherits(struct text table, struct text volume, size_t *entities)
{
    struct text entity;
    *entities = 0;
    for (bool more = true; text_field(&table, '_', &more, &entity); ++*entities) {
        struct text rest = volume;
        struct text other;
        bool found = false;
        for (bool left = true; !found && text_field(&rest, '_', &left, &other);) {
            found = other.size == entity.size && memcmp(other.data, entity.data, entity.size) == 0;
        }
        if (!found) {
            return false;
        }
    }
    return true;
}

static conus_status search_inherited(struct label_search *search, const char *folder)
{
    const char *path = path_base(search->volume->info->path);
    struct text volume = {path, volume_stem_length(path)};
    struct names names = {0};
    const char *best = NULL;
    size_t most = 0;
    conus_status status = names_list(&names, folder, "dseg.tsv");
    for (size_t i = 0; i < names.count; i++) {
        size_t entities;
        struct text table = {names.names[i], strlen(names.names[i]) - strlen(".tsv")};
        if (name_inherits(table, volume, &entities) && entities > most) {
            most = entities;
            best = names.names[i];
        }
    }
    char *found = !status && best ? file_beside(folder, best) : NULL;
    status = !status && best ? (found ? label_search_file(search, found) : CONUS_ERROR_MEMORY) : status;
    memory_free(found);
    names_finish(&names);
    return status;
}

static conus_status offer_atlas(void *user, struct fsl_atlas *atlas, const char *path, const struct bytes *file)
{
    struct label_search *search = user;
    struct label_offer offer = {.path = path, .file = file};
    struct label_use use = search->use;
    use.path = path;
    conus_status status = fsl_atlas_number(atlas, &use, &offer.notes);
    if (status || !atlas->labels.count) {
        notes_finish(&offer.notes);
        return status;
    }
    buffer_format(&offer.source, "%s atlas XML in %s", atlas->is_spm ? "SPM" : "FSL", path_base(path));
    offer.proved = atlas->proved;
    offer.table = atlas->labels;
    atlas->labels = (struct label_table){0};
    return label_search_offer(search, &offer);
}

/* Of all volumes in the folder: asked only where nothing else is. */
static conus_status search_fixed(struct label_search *search)
{
    static const char *const names[] = {"structures.json", "FreeSurferColorLUT.txt"};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && !search->found && i < 2; i++) {
        char *path = file_beside(search->volume->info->path, names[i]);
        search->judge = i == 1 ? label_judge_freesurfer : NULL;
        status = path ? label_search_file(search, path) : CONUS_ERROR_MEMORY;
        search->judge = NULL;
        memory_free(path);
    }
    return status;
}

conus_status label_search_folder(struct label_search *search)
{
    char *folder = path_folder(search->volume->info->path);
    conus_status status = folder ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status || search->found ? status : search_inherited(search, folder);
    status = status ? status : fsl_atlas_each(search->volume->info->path, FSL_LABELS, offer_atlas, search);
    status = status || search->found || search->first_error.size ? status : label_search_alike(search, folder);
    status = status || search->found ? status : search_fixed(search);
    status = status || search->found ? status : label_search_freesurfer(search, folder);
    memory_free(folder);
    return status;
}
