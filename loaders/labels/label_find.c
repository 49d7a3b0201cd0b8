/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a volume's label table is: inside the file, then beside it (docs/formats.md has the order). */
#include "loaders/labels/label_find.h"

#include "atlas/labels/label_voxels.h"
#include "atlas/labels/labels.h"
#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/file_trace.h"
#include "base/files/folder.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/labels/fsl_find.h"
#include "loaders/labels/label_cells.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_format.h"
#include "loaders/labels/label_search.h"
#include "loaders/labels/label_use.h"
#include "loaders/labels/label_words.h"

#include <stdlib.h>
#include <string.h>

/* Volumes of the whole brain, whose labels include pairs of the anatomical segmentation, and of small structures, whose
 * labels are all from FINE on. Neither ever has label 1. */
enum kind { FOREIGN, WHOLE, PARTS };
enum { FINE = 170, COARSE = 100, PAIRS_NEEDED = 2 };

static bool has_entity(struct text stem, const char *entity)
{
    struct text part;
    for (bool more = true; text_field(&stem, '_', &more, &part);) {
        if (text_equal(part, entity)) {
            return true;
        }
    }
    return false;
}

static enum kind kind_of_volume(const struct label_search *search)
{
    const char *name = path_base(search->volume->info->path);
    const struct text stem = {name, volume_stem_length(name)};
    static const char whole[] = "aseg/aseg.auto/aseg.auto_noCCseg/aseg.presurf/aseg.presurf.hypos/aparc+aseg/"
                                "aparc.a2009s+aseg/aparc.DKTatlas+aseg/aparc.DKTatlas+aseg.deep/"
                                "aparc.DKTatlas40+aseg/wmparc/ribbon";
    static const char *const parts[] = {"brainstemSsLabels",  "ThalamicNuclei",   "lh.hippoAmygLabels",
                                        "rh.hippoAmygLabels", "lh.hippoSfLabels", "rh.hippoSfLabels"};
    if (text_is_one_of(stem, whole, true)) {
        return WHOLE;
    }
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (text_starts(stem, parts[i])) {
            return PARTS;
        }
    }
    bool derived = has_entity(stem, "desc-aseg") || has_entity(stem, "desc-aparcaseg"); /* fMRIPrep's */
    return derived && has_entity(stem, "dseg") ? WHOLE : FOREIGN;
}

/* Voxels of the labels below COARSE, and the sum of their places from left to right, mm. */
struct census {
    size_t count[COARSE];
    double right[COARSE];
    uint32_t lowest; /* label but 0; 0 if there is none */
};

static void count_labels(struct census *out, const struct label_use *use)
{
    const conus_volume_info *info = use->info;
    size_t count = info->dim[0] * info->dim[1] * info->dim[2];
    *out = (struct census){.lowest = 0};
    for (size_t at = 0; at < count; at++) {
        uint32_t label = label_voxels_at(use->voxels, at);
        out->lowest = label && (!out->lowest || label < out->lowest) ? label : out->lowest;
        if (label && label < COARSE) {
            size_t row = at / info->dim[0];
            size_t plane = row / info->dim[1];
            const double voxel[3] = {(double)(at % info->dim[0]), (double)(row % info->dim[1]), (double)plane};
            double world[3];
            mat4_point(world, info->world_from_voxel, voxel);
            out->count[label]++;
            out->right[label] += world[0];
        }
    }
}

/* Whether two pairs of areas or more are there, each with the left one on the left. */
static bool pairs_agree(const struct census *census)
{
    static const int pairs[][2] = {{2, 41},  {3, 42},  {4, 43},  {10, 49}, {11, 50}, {12, 51},
                                   {13, 52}, {17, 53}, {18, 54}, {26, 58}, {28, 60}};
    int found = 0;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        int left = pairs[i][0];
        int right = pairs[i][1];
        double lefts = (double)census->count[left];
        double rights = (double)census->count[right];
        if (lefts > 0 && rights > 0) {
            found++;
            if (!(census->right[left] / lefts < census->right[right] / rights)) {
                return false;
            }
        }
    }
    return found >= PAIRS_NEEDED;
}

static bool numbers_agree(const struct label_use *use, enum kind kind)
{
    struct census census;
    count_labels(&census, use);
    return kind == PARTS ? census.lowest >= FINE : census.lowest > 1 && pairs_agree(&census);
}

/* The first table that is there: $FREESURFER_HOME's, or that above SUBJECTS/SUBJECT/mri/. */
static conus_status find_freesurfer_table(struct buffer *out, const char *folder)
{
    const char *home = file_trace_environment("FREESURFER_HOME");
    const char *roots[] = {home && home[0] ? home : NULL, home && home[0] ? home : NULL, folder};
    static const char *const below[] = {"/FreeSurferColorLUT.txt", "/luts/FreeSurferColorLUT.txt",
                                        "../../../FreeSurferColorLUT.txt"};
    for (size_t i = 0; i < 3; i++) {
        buffer_clear(out);
        if (roots[i]) {
            buffer_format(out, "%s%s", roots[i], below[i]);
        }
        if (buffer_status(out) || (out->size && file_exists(out->data))) {
            return buffer_status(out);
        }
    }
    buffer_clear(out);
    return CONUS_OK;
}

static conus_status take_freesurfer(bool *taken, struct label_search *search, const struct label_table *table,
                                    const char *path)
{
    (void)table;
    *taken = true;
    return notes_add(
        search->notes,
        "%s: its name is one of FreeSurfer's, and its labels lie as FreeSurfer's do: named by %s; --labels "
        "chooses another table",
        path_base(search->volume->info->path), path);
}

/* A label_judge of a FreeSurferColorLUT.txt in the volume's folder: FreeSurfer's own is taken only for volumes that
 * bear one of FreeSurfer's names or whose labels lie as FreeSurfer's do; any other is taken. */
static conus_status label_judge_freesurfer(bool *taken, struct label_search *search, const struct label_table *table,
                                           const char *path)
{
    const struct label *first = label_table_find(table, 1);
    bool own = first && first->name && strcmp(first->name, "Left-Cerebral-Exterior") == 0;
    *taken = !own || !search->use.voxels || kind_of_volume(search) != FOREIGN || numbers_agree(&search->use, WHOLE);
    return *taken ? CONUS_OK
                  : notes_warn(search->notes,
                               "%s is not taken for the label table: neither the name nor the labels of %s are "
                               "FreeSurfer's; --labels uses it all the same",
                               path_base(path), path_base(search->volume->info->path));
}

/* Tries FreeSurferColorLUT.txt of FREESURFER_HOME, or of the FreeSurfer whose subject the volume is, in folder, if
 * the volume's name is one of FreeSurfer's and its labels are where FreeSurfer's are. A note says which was taken. */
static conus_status label_search_freesurfer(struct label_search *search, const char *folder)
{
    enum kind kind = kind_of_volume(search);
    struct buffer path = {0};
    if (kind == FOREIGN || !search->use.voxels) {
        return CONUS_OK;
    }
    conus_status status = find_freesurfer_table(&path, folder);
    if (!status && path.size && !numbers_agree(&search->use, kind)) {
        status =
            notes_warn(search->notes,
                       "%s: its name is one of FreeSurfer's, but its labels do not lie as FreeSurfer's do: %s is not "
                       "taken; --labels uses it all the same",
                       path_base(search->volume->info->path), path.data);
    } else if (!status && path.size) {
        search->judge = take_freesurfer;
        status = label_search_file(search, path.data);
        search->judge = NULL;
    }
    buffer_finish(&path);
    return status;
}

struct label_fit {
    size_t names;     /**< Names in the table. */
    size_t used;      /**< Names whose number a voxel has. */
    uint32_t unnamed; /**< The first number of a voxel that has no name, in the order of the voxels; 0: all have one. */
    size_t strays;    /**< Voxels whose number has no name,                             */
    size_t voxels;    /**< of so many that have one other than 0.                       */
};

enum { STRAYS = 100000 }; /* of so many voxels one may be of a label without a name */

static bool names_label(const struct label_table *table, uint32_t number)
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
        fit->strays += count && !names_label(table, number) ? *count : 0;
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
        if (names_label(table, number)) {
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

/* Whether the table may be taken although only its name connects it with the volume. Then every label has a name, but
 * for one voxel in 100,000; nine of ten names have a voxel; and 0 is no area's. */
static bool label_fit_is_good(const struct label_fit *fit, const struct label_table *table)
{
    bool background = !table->zero || label_is_background(text_from(table->zero));
    return fit->strays <= fit->voxels / STRAYS && background && fit->used && 10 * fit->used >= 9 * fit->names;
}

#define TABLE_ENDINGS ".nii.txt/.nii.lut/.niml.lt/.txt/.tsv/.json/.label/.ctbl/.csv/.lut/.ctab"

enum { TABLE_LIMIT = 16 }; /* candidates that are read */

/* Length of the name without the ending of a table; 0 if it has none. */
static size_t table_stem_length(const char *name)
{
    size_t ending = path_ending_length(name, TABLE_ENDINGS);
    return ending ? strlen(name) - ending : 0;
}

/* Not a name that begins with a dot: macOS puts such a file beside each file on foreign file systems. */
static bool is_volume(const char *name)
{
    return name[0] != '.' && volume_stem_length(name) < strlen(name);
}

/* The folder of a volume, while tables with a similar name are looked for in it. */
struct folder {
    const struct names *names;
    const char *folder;
    struct text stem; /* of the volume */
    struct label_words volume;
};

/* Whether the table could belong to another volume, with other words in its name. */
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
            return true; /* a table without such words belongs to the only volume, or to the only one without words */
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

/* A label_judge of a table with a similar name: taken only if its numbers fit the voxels. */
static conus_status judge_similar_table(bool *taken, struct label_search *search, const struct label_table *table,
                                        const char *path)
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

/* Tries the file `name` beside `path`, which `judge`, unless NULL, must take. */
static conus_status search_named(struct label_search *search, const char *path, const char *name, label_judge judge)
{
    char *file = file_beside(path, name);
    search->judge = judge;
    conus_status status = file ? label_search_file(search, file) : CONUS_ERROR_MEMORY;
    search->judge = NULL;
    memory_free(file);
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
    return *tried ? search_named(search, folder->folder, name, judge_similar_table) : status;
}

/* Tries the tables in folder whose names have no word that the volume's lacks, unless they may belong to another
 * volume there, and whose numbers fit (label_fit_is_good()). A note says what was taken, or why not. */
static conus_status label_search_alike(struct label_search *search, const char *folder)
{
    const char *name = path_base(search->volume->info->path);
    struct names names = {0};
    struct folder here = {.names = &names, .folder = folder, .stem = {name, volume_stem_length(name)}};
    size_t tries = 0;
    conus_status status = search->use.voxels ? names_list(&names, folder, VOLUME_ENDINGS "/" TABLE_ENDINGS) : CONUS_OK;
    label_words_find(&here.volume, here.stem);
    /* of NAMES_LIMIT names one that is not listed could be another volume */
    for (size_t i = 0; !status && names.count < NAMES_LIMIT && tries < TABLE_LIMIT && i < names.count; i++) {
        bool tried;
        status = consider(&tried, search, &here, names.names[i]);
        tries += !status && tried;
    }
    names_finish(&names);
    return status;
}

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
    status = status || !best ? status : search_named(search, folder, best, NULL);
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

/* Tables for all volumes in the folder, which are read only where no other was found. */
static conus_status search_fixed(struct label_search *search)
{
    const char *path = search->volume->info->path;
    conus_status status = search_named(search, path, "structures.json", NULL);
    return status || search->found ? status
                                   : search_named(search, path, "FreeSurferColorLUT.txt", label_judge_freesurfer);
}

void label_volume_finish(struct label_volume *volume)
{
    label_table_finish(&volume->segments);
    notes_finish(&volume->notes);
    memory_free(volume->texts);
    *volume = (struct label_volume){0};
}

static conus_status search_inside(struct label_search *search)
{
    struct label_volume *volume = search->volume;
    const char *path = volume->info->path;
    conus_status status = CONUS_OK;
    if (volume->segments.count) {
        struct label_offer offer = {.path = path, .table = volume->segments, .notes = volume->notes};
        volume->segments = (struct label_table){0};
        volume->notes = (struct notes){0};
        buffer_format(&offer.source, "Slicer segments inside %s", path_base(path));
        status = label_search_offer(search, &offer);
    }
    for (size_t i = 0; !status && i < volume->count; i++) {
        status = label_search_bytes(search, path, NULL, volume->texts[i]);
    }
    return status;
}

static conus_status search_beside(struct label_search *search)
{
    static const char *const endings[] = {".nii.txt", ".txt",     ".tsv", ".json",    ".label",
                                          ".ctbl",    ".niml.lt", ".csv", ".nii.lut", ".lut"};
    const char *path = search->volume->info->path;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < sizeof endings / sizeof endings[0]; i++) {
        char *beside = path_with_ending(path, volume_stem_length(path), endings[i]);
        status = beside ? label_search_file(search, beside) : CONUS_ERROR_MEMORY;
        memory_free(beside);
    }
    return status;
}

static conus_status colour_beside(struct label_search *search)
{
    static const char *const endings[] = {".nii.lut", ".lut"};
    const char *path = search->volume->info->path;
    bool coloured = label_table_has_colours(&search->table);
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && !coloured && i < sizeof endings / sizeof endings[0]; i++) {
        char *lut = path_with_ending(path, volume_stem_length(path), endings[i]);
        status = lut ? label_file_colours(&search->table, &coloured, lut, &search->read) : CONUS_ERROR_MEMORY;
        if (!status && coloured) {
            buffer_format(&search->source, ", colours in %s", path_base(lut));
            status = buffer_status(&search->source);
        }
        memory_free(lut);
    }
    return status;
}

static conus_status settle_search(struct label_search *search)
{
    if (search->found) {
        return search->first_error.size ? notes_warn(search->notes, "%s: passed over", search->first_error.data)
                                        : CONUS_OK;
    }
    if (search->first_error.size) {
        return fail(CONUS_ERROR_DATA, "%s", search->first_error.data);
    }
    const char *name = path_base(search->volume->info->path);
    buffer_text(&search->source, "none found");
    int stem = (int)volume_stem_length(name);
    conus_status status = notes_warn(
        search->notes,
        "no label table found: areas are called by their numbers (looked inside %s; beside it for %.*s.nii.txt, "
        ".txt, .tsv, .json, .label, .ctbl, .niml.lt, .csv, .lut; in its folder for an inherited dseg.tsv, an "
        "atlas XML of FSL or SPM, a table with a similar name, structures.json, FreeSurferColorLUT.txt)",
        name, stem, name);
    for (uint32_t number = 1; !status && number < 256; number++) { /* without names, for colours to go to */
        status = label_table_add(&search->table, number) ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    return status;
}

conus_status label_table_of_volume(struct label_table *out, char **source, struct label_volume *volume,
                                   const struct label_voxels *voxels, struct file_sums *read, struct notes *notes)
{
    struct label_search search = {
        .volume = volume,
        .use = {.info = volume->info, .voxels = voxels, .max_memory = volume->max_memory, .header = volume->header},
        .notes = notes};
    bool before = file_trace_search(true);
    conus_status status = search_inside(&search);
    status = status ? status : search_beside(&search);
    char *folder = path_folder(volume->info->path); /* which may have a table under a name of its own */
    status = status || folder ? status : CONUS_ERROR_MEMORY;
    status = status || search.found ? status : search_inherited(&search, folder);
    status = status ? status : fsl_atlas_each(volume->info->path, FSL_LABELS, offer_atlas, &search);
    status = status || search.found || search.first_error.size ? status : label_search_alike(&search, folder);
    status = status || search.found ? status : search_fixed(&search);
    status = status || search.found ? status : label_search_freesurfer(&search, folder);
    memory_free(folder);
    status = status ? status : settle_search(&search);
    status = status ? status : colour_beside(&search);
    file_trace_search(before);
    status = status || !read ? status : file_sums_move(read, &search.read);
    char *words = status ? NULL : memory_text(search.source.data, search.source.size);
    if (!words) {
        label_search_finish(&search);
        return status ? status : CONUS_ERROR_MEMORY;
    }
    if (!search.found && !label_table_has_colours(&search.table)) {
        label_table_finish(&search.table);
    }
    *source = words;
    *out = search.table;
    search.table = (struct label_table){0};
    label_search_finish(&search);
    return CONUS_OK;
}
