/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's volumes away from FreeSurfer's colour table. Many atlases have labels 1, 2, 3, ..., to all of which that
 * table gives a name: so the volume's name must be one of FreeSurfer's, and its labels must lie as FreeSurfer's do. */
#include "loaders/labels/label_freesurfer.h"

#include "base/files/file.h"
#include "base/files/file_trace.h"
#include "base/files/folder.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/labels/label_search.h"

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

static enum kind kind_of(struct text stem)
{
    static const char *const whole[] = {
        "aseg",
        "aseg.auto",
        "aseg.auto_noCCseg",
        "aseg.presurf",
        "aparc+aseg",
        "aparc.a2009s+aseg",
        "aparc.DKTatlas+aseg",
        "aparc.DKTatlas40+aseg",
        "wmparc",
        "ribbon",
        "aseg.presurf.hypos",
        "aparc.DKTatlas+aseg.deep",
    };
    static const char *const parts[] = {"brainstemSsLabels",  "ThalamicNuclei",   "lh.hippoAmygLabels",
                                        "rh.hippoAmygLabels", "lh.hippoSfLabels", "rh.hippoSfLabels"};
    for (size_t i = 0; i < sizeof whole / sizeof whole[0]; i++) {
        if (text_equal(stem, whole[i])) {
            return WHOLE;
        }
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

static void count_voxel(struct census *census, const conus_volume_info *info, size_t at, uint32_t label)
{
    size_t row = at / info->dim[0];
    size_t plane = row / info->dim[1];
    const double voxel[3] = {(double)(at % info->dim[0]), (double)(row % info->dim[1]), (double)plane};
    double world[3];
    mat4_point(world, info->world_from_voxel, voxel);
    census->count[label]++;
    census->right[label] += world[0];
}

static void count_labels(struct census *out, const struct label_use *use)
{
    const conus_volume_info *info = use->info;
    size_t count = info->dim[0] * info->dim[1] * info->dim[2];
    *out = (struct census){.lowest = 0};
    for (size_t at = 0; at < count; at++) {
        uint32_t label = label_voxels_at(use->voxels, at);
        out->lowest = label && (!out->lowest || label < out->lowest) ? label : out->lowest;
        if (label && label < COARSE) {
            count_voxel(out, info, at, label);
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
static conus_status find_table(struct buffer *out, const char *folder)
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

static conus_status take_table(bool *taken, struct label_search *search, const struct label_table *table,
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

static conus_status try_table(struct label_search *search, enum kind kind, const char *path)
{
    if (!numbers_agree(&search->use, kind)) {
        return notes_warn(
            search->notes,
            "%s: its name is one of FreeSurfer's, but its labels do not lie as FreeSurfer's do: %s is not "
            "taken; --labels uses it all the same",
            path_base(search->volume->info->path), path);
    }
    search->judge = take_table;
    conus_status status = label_search_file(search, path);
    search->judge = NULL;
    return status;
}

static enum kind kind_of_volume(const struct label_search *search)
{
    const char *name = path_base(search->volume->info->path);
    return kind_of((struct text){name, volume_stem_length(name)});
}

conus_status label_judge_freesurfer(bool *taken, struct label_search *search, const struct label_table *table,
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

conus_status label_search_freesurfer(struct label_search *search, const char *folder)
{
    enum kind kind = kind_of_volume(search);
    struct buffer path = {0};
    if (kind == FOREIGN || !search->use.voxels) {
        return CONUS_OK;
    }
    conus_status status = find_table(&path, folder);
    status = status || !path.size ? status : try_table(search, kind, path.data);
    buffer_finish(&path);
    return status;
}
