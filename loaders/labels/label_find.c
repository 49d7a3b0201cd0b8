/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a volume's label table is: inside the file, then beside it (docs/formats.md has the order). */
#include "loaders/labels/labels.h"

#include "atlas/labels/labels.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/path.h"
#include "base/system/system.h"
#include "loaders/labels/label_format.h"
#include "sources/names.h"

#include <stdlib.h>
#include <string.h>

/* Volumes of the whole brain, whose labels include pairs of the anatomical segmentation, and of small structures, whose
 * labels are all from FINE on, but for the accumbens in sclimbic. Neither ever has label 1. */
enum kind { FOREIGN, WHOLE, PARTS };
enum { FINE = 170, COARSE = 100, PAIRS_NEEDED = 2, LEFT_ACCUMBENS = 26, RIGHT_ACCUMBENS = 58 };

static struct text stem_of(const char *path)
{
    const char *name = path_base(path);
    return (struct text){name, volume_stem_length(name)};
}

static bool has_entity(struct text stem, struct text entity)
{
    struct text part;
    for (bool more = true; text_field(&stem, '_', &more, &part);) {
        if (text_compare(part, entity) == 0) {
            return true;
        }
    }
    return false;
}

static enum kind kind_of_volume(const struct label_search *search)
{
    const struct text stem = stem_of(search->volume->info->path);
    static const char whole[] = "aseg/aseg.auto/aseg.auto_noCCseg/aseg.presurf/aseg.presurf.hypos/aparc+aseg/"
                                "aparc.a2009s+aseg/aparc.DKTatlas+aseg/aparc.DKTatlas+aseg.deep/"
                                "aparc.DKTatlas40+aseg/wmparc/ribbon";
    static const char parts[] = "brainstemSsLabels/ThalamicNuclei/lh.hippoAmygLabels/rh.hippoAmygLabels/"
                                "lh.hippoSfLabels/rh.hippoSfLabels/hypothalamic_subunits_seg/arousalNetworkLabels/"
                                "sclimbic/vsinus/mca-dura";
    if (text_is_one_of(stem, whole, true)) {
        return WHOLE;
    }
    struct text rest = text_from(parts);
    struct text part;
    for (bool more = true; text_field(&rest, '/', &more, &part);) {
        if (stem.size >= part.size && memcmp(stem.data, part.data, part.size) == 0) {
            return PARTS;
        }
    }
    bool derived = has_entity(stem, text_from("desc-aseg")) || has_entity(stem, text_from("desc-aparcaseg"));
    return derived && has_entity(stem, text_from("dseg")) ? WHOLE : FOREIGN; /* fMRIPrep's */
}

/* Voxels of the labels below COARSE, and the sum of their places from left to right, mm. */
struct census {
    size_t count[COARSE];
    double right[COARSE];
    uint32_t lowest; /* label but 0 and the accumbens's; 0 if there is none */
};

static void count_labels(struct census *out, const struct label_use *use)
{
    const conus_volume_info *info = use->info;
    size_t count = info->dim[0] * info->dim[1] * info->dim[2];
    *out = (struct census){.lowest = 0};
    for (size_t at = 0; at < count; at++) {
        uint32_t label = label_voxels_at(use->voxels, at);
        bool counts = label && label != LEFT_ACCUMBENS && label != RIGHT_ACCUMBENS;
        out->lowest = counts && (!out->lowest || label < out->lowest) ? label : out->lowest;
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

/* The first table that is there: $FREESURFER_HOME's, or that above SUBJECTS/SUBJECT/mri/; NULL if none is. */
static const char *find_freesurfer_table(struct job *job, const char *folder)
{
    static const char *const below[] = {"/FreeSurferColorLUT.txt", "/luts/FreeSurferColorLUT.txt",
                                        "../../../FreeSurferColorLUT.txt"};
    const char *home = system_variable("FREESURFER_HOME");
    for (size_t i = home && home[0] ? 0 : 2; i < 3; i++) {
        const char *path = job_format(job, "%s%s", i < 2 ? home : folder, below[i]);
        if (job_has_file(job, path)) {
            return path;
        }
    }
    return NULL;
}

static bool take_freesurfer(struct job *job, const struct label_search *search, const struct label_table *table,
                            const char *path)
{
    (void)table;
    job_note(job,
             "%s: its name is one of FreeSurfer's, and its labels lie as FreeSurfer's do: named by %s; --labels "
             "chooses another table",
             path_base(search->volume->info->path), path);
    return true;
}

/* A label_judge of a FreeSurferColorLUT.txt in the volume's folder: FreeSurfer's own is taken only for volumes that
 * bear one of FreeSurfer's names or whose labels lie as FreeSurfer's do; any other is taken. */
static bool judge_freesurfer(struct job *job, const struct label_search *search, const struct label_table *table,
                             const char *path)
{
    const struct label *first = label_table_find(table, 1);
    bool own = first && first->name && strcmp(first->name, "Left-Cerebral-Exterior") == 0;
    bool taken = !own || !search->use.voxels || kind_of_volume(search) != FOREIGN || numbers_agree(&search->use, WHOLE);
    if (!taken) {
        job_note(job,
                 "%s is not taken for the label table: neither the name nor the labels of %s are FreeSurfer's; "
                 "--labels uses it all the same",
                 path_base(path), path_base(search->volume->info->path));
    }
    return taken;
}

static void search_judged(struct job *job, struct label_search *search, const char *path, label_judge *judge)
{
    search->judge = judge;
    label_search_file(job, search, path);
    search->judge = NULL;
}

/* Tries FreeSurferColorLUT.txt of FREESURFER_HOME, or of the FreeSurfer whose subject the volume is, in folder, or the
 * names that conus has, if the volume's name is one of FreeSurfer's and its labels are where FreeSurfer's are. A note
 * says which was taken. */
static void search_freesurfer(struct job *job, struct label_search *search, const char *folder)
{
    enum kind kind = kind_of_volume(search);
    const char *path = kind != FOREIGN && search->use.voxels ? find_freesurfer_table(job, folder) : NULL;
    bool agree = kind != FOREIGN && search->use.voxels && numbers_agree(&search->use, kind);
    struct label_offer offer = {.table = labels_new(job), .path = search->volume->info->path};
    if (agree && !path) {
        freesurfer_names_add(job, offer.table, search->use.voxels);
        labels_sort(job, offer.table);
    }
    if (offer.table->count) {
        offer.source = "FreeSurfer's names, which conus has";
        label_search_offer(job, search, &offer);
        (void)take_freesurfer(job, search, offer.table, offer.source);
    } else if (agree && path) {
        search_judged(job, search, path, take_freesurfer);
    } else if (path) {
        job_note(job,
                 "%s: its name is one of FreeSurfer's, but its labels do not lie as FreeSurfer's do: %s is not taken; "
                 "--labels uses it all the same",
                 path_base(search->volume->info->path), path);
    }
}

struct fit {
    size_t names;     /* Names in the table. */
    size_t used;      /* Names whose number a voxel has. */
    uint32_t unnamed; /* The first number of a voxel that has no name, in the order of the voxels; 0: all have one. */
    size_t strays;    /* Voxels whose number has no name, */
    size_t voxels;    /* of so many that have one other than 0. */
};

enum { STRAYS = 100000 }; /* of so many voxels one may be of a label without a name */

static const struct label *find_named(const struct label_table *table, uint32_t number)
{
    const struct label *label = label_table_find(table, number);
    return label && label->name ? label : NULL;
}

static void finish_counts(void *counts)
{
    label_map_finish(counts);
}

static void count_strays(struct job *job, struct fit *fit, const struct label_table *table,
                         const struct label_voxels *voxels)
{
    struct label_map *counts = job_new(job, struct label_map);
    if (counts) {
        job_own(job, finish_counts, counts);
    }
    if (!JOB_CALL(job, label_voxels_tally(counts, voxels))) {
        return;
    }
    for (size_t i = 1; i < voxels->label_count; i++) { /* the first is 0 */
        const uint64_t *count = label_map_at(counts, voxels->labels[i]);
        job_need(job, count);
        fit->voxels += count ? *count : 0;
        fit->strays += count && !find_named(table, voxels->labels[i]) ? *count : 0;
    }
}

static struct fit find_fit(struct job *job, const struct label_table *table, const struct label_voxels *voxels)
{
    struct fit fit = {0};
    bool *seen = job_zeroed(job, table->count, sizeof *seen);
    for (size_t i = 1; seen && i < voxels->label_count; i++) {
        const struct label *label = find_named(table, voxels->labels[i]);
        if (label) {
            seen[label - table->entries] = true;
        } else {
            fit.unnamed = fit.unnamed ? fit.unnamed : voxels->labels[i];
        }
    }
    for (size_t i = 0; seen && i < table->count; i++) {
        fit.names += table->entries[i].name != NULL;
        fit.used += seen[i];
    }
    if (fit.unnamed) {
        count_strays(job, &fit, table, voxels);
    }
    return fit;
}

/* A label_judge of a table with a similar name, which alone connects it with the volume. It is taken if every label has
 * a name, but for one voxel in 100,000; nine of ten names have a voxel; and 0 is no area's. */
static bool judge_similar(struct job *job, const struct label_search *search, const struct label_table *table,
                          const char *path)
{
    const struct fit fit = find_fit(job, table, search->use.voxels);
    const char *name = path_base(path);
    bool background = !table->zero || label_is_background(text_from(table->zero));
    bool taken = fit.strays <= fit.voxels / STRAYS && background && fit.used && 10 * fit.used >= 9 * fit.names;
    if (!taken && fit.unnamed) {
        job_note(job,
                 "%s is not taken for the label table: it has no name for label %u (of %zu voxels %zu have no name); "
                 "--labels %s uses it all the same",
                 name, fit.unnamed, fit.voxels, fit.strays, name);
    } else if (!taken) {
        job_note(job,
                 "%s is not taken for the label table: of its %zu names %zu have voxels%s; --labels %s uses it all the "
                 "same",
                 name, fit.names, fit.used, background ? "" : ", and it calls 0 an area", name);
    } else if (search->source) {
        job_note(job, "%s fits the labels, too: --labels chooses it", name);
    } else {
        if (fit.unnamed) {
            job_warn(job, "label %u has no name in %s: of %zu voxels %zu have none", fit.unnamed, name, fit.voxels,
                     fit.strays);
        }
        job_note(job,
                 "%s is taken for the label table of %s by its name: %s labels have a name in it, and %zu of its %zu "
                 "names have voxels; --labels chooses another",
                 name, path_base(search->volume->info->path), fit.unnamed ? "nearly all" : "all", fit.used, fit.names);
    }
    return taken;
}

/* A label_judge of a structures.json, which BrainGlobe puts beside the volume annotation.* for all volumes of a folder.
 * For another volume, which nothing connects with it, every label needs a name, as of a table with a similar name. */
static bool judge_structures(struct job *job, const struct label_search *search, const struct label_table *table,
                             const char *path)
{
    const struct text stem = stem_of(search->volume->info->path);
    if (text_starts(stem, "annotation")) {
        return true;
    }
    const struct fit fit = search->use.voxels ? find_fit(job, table, search->use.voxels) : (struct fit){.strays = 1};
    bool taken = kind_of_volume(search) == FOREIGN && fit.strays <= fit.voxels / STRAYS;
    if (!taken) {
        job_note(job,
                 "%s is not taken for the label table: BrainGlobe's is that of annotation.*, and not every label of %s "
                 "has a name in it; --labels %s uses it all the same",
                 path_base(path), path_base(search->volume->info->path), path_base(path));
    }
    return taken;
}

enum { TABLE_LIMIT = 16 }; /* candidates that are read */

/* A folder, while tables with a name similar to the volume's are looked for in it. */
struct folder {
    struct names names;
    const char *path;
    const char *endings; /* of tables */
    struct text stem;    /* of the volume */
    struct label_words words;
};

static bool is_stem(const struct folder *folder, struct text stem)
{
    return text_compare(stem, folder->stem) == 0;
}

/* The name without the ending of a table; empty if it has none. */
static struct text table_stem(const struct folder *folder, const char *name)
{
    size_t ending = path_ending_length(name, folder->endings);
    return (struct text){name, ending ? strlen(name) - ending : 0};
}

/* Whether the table could belong to another volume, with other words in its name. */
static bool is_of_another(const struct folder *folder, const struct label_words *table)
{
    bool exact = label_words_equal(&folder->words, table);
    for (size_t i = 0; i < folder->names.count; i++) {
        const char *name = folder->names.names[i];
        struct text stem = stem_of(name);
        struct label_words words;
        /* macOS puts a file with a dot in front beside each file on foreign file systems */
        if (name[0] == '.' || !name[stem.size] || is_stem(folder, stem)) {
            continue;
        }
        label_words_find(&words, stem);
        bool same = label_words_equal(&words, &folder->words);
        bool could = words.overflow || label_words_contain(&words, table);
        if (table->count ? could && !same && !exact : same || !exact) {
            return true; /* a table without such words belongs to the only volume, or to the only one without words */
        }
    }
    return false;
}

/* Whether the file may be a table of a known format, as is one that cannot be read. */
static bool may_be_table(struct job *job, const char *path)
{
    const struct job_mark mark = job_mark(job);
    struct attempt attempt = job_try(job);
    struct bytes bytes = label_file_bytes(job, path);
    bool may = !job_ok(job) || label_format_of(text_from_bytes(bytes.data, bytes.size));
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    job_release(job, mark);
    return may;
}

/* Whether no other file in the folder is a table of a known format. */
static bool is_only_table(struct job *job, const struct folder *folder, const char *table)
{
    bool only = true;
    for (size_t i = 0; only && i < folder->names.count; i++) {
        const char *name = folder->names.names[i];
        if (name[0] != '.' && table_stem(folder, name).size && strcmp(name, table) != 0) {
            const char *path = job_beside(job, folder->path, name);
            only = !job_has_file(job, path) || !may_be_table(job, path);
        }
    }
    return only;
}

/* Whether the table's name has no word that the volume's lacks, and it cannot belong to another volume there. */
static bool is_similar(struct job *job, const struct folder *folder, const char *name)
{
    struct text stem = table_stem(folder, name);
    struct label_words words;
    label_words_find(&words, stem);
    if (name[0] == '.' || !stem.size || is_stem(folder, stem) || /* X.tsv was tried */
        !label_words_contain(&folder->words, &words) || is_of_another(folder, &words)) {
        return false;
    }
    return words.count || is_only_table(job, folder, name);
}

/* Tries the tables in the folder with similar names, whose numbers must fit. A note says what was taken, or why not. */
static void search_alike(struct job *job, struct label_search *search, const char *path)
{
    const char *endings = job_format(job, "%s/.ctab", label_endings(job, false));
    const char *all = endings; /* and of volumes */
    struct folder folder = {.path = path, .endings = endings, .stem = stem_of(search->volume->info->path)};
    size_t tries = 0;
    label_words_find(&folder.words, folder.stem);
    if (search->use.voxels) {
        for (const char *ending = NULL; (ending = ending_next(ending, ROLE_VOLUME));) {
            all = job_format(job, "%s/%s/%s.gz", all, ending, ending);
        }
        folder.names = job_names(job, path, all);
    }
    /* of NAMES_LIMIT names one that is not listed could be another volume */
    for (size_t i = 0; folder.names.count < NAMES_LIMIT && tries < TABLE_LIMIT && i < folder.names.count; i++) {
        if (is_similar(job, &folder, folder.names.names[i])) {
            search_judged(job, search, job_beside(job, path, folder.names.names[i]), judge_similar);
            tries++;
        }
    }
}

/* How many entities ("res-01", "dseg") the table's name has, if each is one of the volume's: then BIDS lets it inherit;
 * else 0. */
static size_t count_inherited(struct text table, struct text volume)
{
    struct text entity;
    size_t count = 0;
    for (bool more = true; text_field(&table, '_', &more, &entity); count++) {
        if (!has_entity(volume, entity)) {
            return 0;
        }
    }
    return count;
}

static void search_inherited(struct job *job, struct label_search *search, const char *folder)
{
    const struct text volume = stem_of(search->volume->info->path);
    const struct names names = job_names(job, folder, "dseg.tsv");
    const char *best = NULL;
    size_t most = 0;
    for (size_t i = 0; i < names.count; i++) {
        size_t count = count_inherited((struct text){names.names[i], strlen(names.names[i]) - strlen(".tsv")}, volume);
        best = count > most ? names.names[i] : best;
        most = count > most ? count : most;
    }
    if (best) {
        label_search_file(job, search, job_beside(job, folder, best));
    }
}

/* A fsl_visit. */
static void offer_atlas(struct job *job, void *user, struct fsl_atlas *atlas, const char *path,
                        const struct bytes *file)
{
    struct label_search *search = user;
    struct label_offer offer = {.table = &atlas->labels, .path = path, .file = file};
    struct label_use use = search->use;
    use.path = path;
    struct notes outside = label_notes_swap(job, (struct notes){0});
    fsl_atlas_number(job, atlas, &use);
    offer.notes = label_notes_swap(job, outside);
    offer.proved = atlas->proved;
    offer.source = job_format(job, "%s atlas XML in %s", atlas->is_spm ? "SPM" : "FSL", path_base(path));
    if (job_ok(job) && atlas->labels.count) {
        label_search_offer(job, search, &offer);
    }
    notes_finish(&offer.notes);
}

static void search_inside(struct job *job, struct label_search *search)
{
    const struct label_volume *volume = search->volume;
    const char *path = volume->info->path;
    if (volume->segments && volume->segments->count) {
        struct label_offer offer = {.table = volume->segments, .path = path};
        offer.source = job_format(job, "Slicer segments inside %s", path_base(path));
        label_search_offer(job, search, &offer);
    }
    for (size_t i = 0; i < volume->count; i++) {
        label_search_text(job, search, path, NULL, volume->texts[i]);
    }
}

static void search_beside(struct job *job, struct label_search *search)
{
    const char *path = search->volume->info->path;
    struct text rest = text_from(label_endings(job, false));
    struct text ending;
    for (bool more = true; text_field(&rest, '/', &more, &ending);) {
        label_search_file(
            job, search,
            job_format(job, "%.*s%.*s", (int)volume_stem_length(path), path, (int)ending.size, ending.data));
    }
}

/* What a file of the volume's format is looked through for; NULL: nothing. */
static const char *tables_inside(const char *format)
{
    static const char *const known[][2] = {
        {"NIfTI", "the tables of Workbench and AFNI in its extensions, and text before the voxels"},
        {"NRRD", "the segments of 3D Slicer"},
        {"AFNI", "VALUE_LABEL_DTABLE and ATLAS_LABEL_TABLE"},
        {"Zarr", "OME's image-label"}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (text_starts(text_from(format), known[i][0])) {
            return known[i][1];
        }
    }
    return NULL;
}

/* Notes what was passed over; fails where that was all, and damaged. */
static void settle_search(struct job *job, struct label_search *search)
{
    if (search->source && search->why) {
        job_note(job, "%s: passed over", search->why);
    } else if (search->why) {
        job_bad(job, "%s", search->why);
    } else if (!search->source) {
        const char *name = path_base(search->volume->info->path);
        const char *inside = tables_inside(search->volume->info->format);
        struct text rest = text_from(label_endings(job, false));
        const char *endings = "";
        struct text ending;
        for (bool more = true; text_field(&rest, '/', &more, &ending);) {
            if (!endings[0] || !text_starts(ending, ".nii.")) { /* X.nii.lut goes without saying */
                endings = job_format(job, "%s%s%.*s", endings, endings[0] ? ", " : "", (int)ending.size, ending.data);
            }
        }
        const char *where =
            inside ? job_format(job, "inside %s for %s; beside it", name, inside) : job_format(job, "beside %s", name);
        job_note(job,
                 "no label table found: areas are called by their numbers (looked %s for %.*s%s; in its folder for an "
                 "inherited dseg.tsv, an atlas XML of FSL or SPM, a table with a similar name, structures.json, "
                 "FreeSurferColorLUT.txt)",
                 where, (int)volume_stem_length(name), name, endings);
    }
}

/* Takes the colours beside the volume where the table has none; without a table they go to numbers without names. */
static void colour_beside(struct job *job, struct label_search *search)
{
    const char *path = search->volume->info->path;
    bool coloured = label_table_has_colours(search->table);
    for (uint32_t number = 1; !search->source && number < 256; number++) {
        labels_add(job, search->table, number);
    }
    search->source = search->source ? search->source : "none found";
    struct text rest = text_from(label_endings(job, true));
    struct text ending;
    for (bool more = true; !coloured && text_field(&rest, '/', &more, &ending);) {
        const char *lut =
            job_format(job, "%.*s%.*s", (int)volume_stem_length(path), path, (int)ending.size, ending.data);
        coloured = label_file_colours(job, search->table, lut);
        if (coloured) {
            search->source = job_format(job, "%s, colours in %s", search->source, path_base(lut));
        }
    }
}

static void search_all(struct job *job, struct label_search *search)
{
    const char *path = search->volume->info->path;
    const char *folder = !path_is_name(path) ? job_beside(job, path, "") : "./";
    search_inside(job, search);
    search_beside(job, search);
    if (!search->source) {
        search_inherited(job, search, folder);
    }
    const char *before = search->source;
    fsl_atlas_each(job, path, FSL_LABELS, offer_atlas, search);
    if (search->source != before && !search->proved) {
        const size_t place = job_in(job, search->source, JOB_ALONE);
        label_check_zero(job, search->table, search->use.voxels);
        job_out(job, place);
    }
    if (!search->source && !search->why) {
        search_alike(job, search, folder);
    }
    if (!search->source) { /* of all volumes in the folder */
        search_judged(job, search, job_beside(job, path, "structures.json"), judge_structures);
    }
    if (!search->source) {
        search_judged(job, search, job_beside(job, path, "FreeSurferColorLUT.txt"), judge_freesurfer);
    }
    if (!search->source) {
        search_freesurfer(job, search, folder);
    }
    settle_search(job, search);
}

void label_table_of_volume(struct job *job, struct label_table *out, const char **source,
                           const struct label_volume *volume, const struct label_voxels *voxels)
{
    struct label_search search = {.volume = volume,
                                  .use = {.info = volume->info, .voxels = voxels, .header = volume->header},
                                  .table = labels_new(job),
                                  .files = job->files.count};
    struct attempt attempt = job_try(job); /* so that a table's notes are kept only where it is used */
    bool before = inputs_search(true);
    search_all(job, &search);
    bool found = search.source != NULL;
    if (job_ok(job)) {
        colour_beside(job, &search);
    }
    inputs_search(before);
    attempt_end(job, &attempt, ATTEMPT_KEEP);
    if (job_ok(job)) {
        *source = search.source;
    }
    if (found || label_table_has_colours(search.table)) {
        labels_move(job, out, search.table);
    }
}
