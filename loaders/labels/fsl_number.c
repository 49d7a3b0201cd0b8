/* SPDX-License-Identifier: BSD-3-Clause */
/* Which number a label of an FSL atlas XML has in a volume of labels: its index, or that plus one. */
#include "base/files/folder.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/labels/fsl_find.h"
#include "loaders/labels/label_cells.h"

#include <math.h>

/* How many points of labels lie in the volume, in voxels that hold the label's index, and that plus one. */
struct fit {
    size_t inside, index, next;
};

static size_t best_of(struct fit fit)
{
    return fit.index > fit.next ? fit.index : fit.next;
}

static size_t worst_of(struct fit fit)
{
    return fit.index > fit.next ? fit.next : fit.index;
}

static bool voxel_at(size_t *voxel, const conus_volume_info *info, const double at[3])
{
    double index[3];
    for (int i = 0; i < 3; i++) {
        index[i] = floor(at[i] + 0.5);
        if (!(index[i] >= 0 && index[i] < (double)info->dim[i])) {
            return false;
        }
    }
    *voxel = (size_t)index[0] + info->dim[0] * ((size_t)index[1] + info->dim[1] * (size_t)index[2]);
    return true;
}

/* The points are voxels of a grid from which `voxel_from_point` leads to the volume's. */
static struct fit count_fits(const struct fsl_atlas *atlas, const struct label_use *use,
                             const double voxel_from_point[16])
{
    struct fit fit = {0};
    for (size_t i = 0; i < atlas->labels.count; i++) {
        double at[3];
        size_t voxel;
        uint32_t next = atlas->labels.entries[i].number;
        mat4_point(at, voxel_from_point, atlas->points[i].at);
        if (atlas->points[i].given && voxel_at(&voxel, use->info, at)) {
            uint32_t label = label_voxels_at(use->voxels, voxel);
            fit.inside++;
            fit.next += label == next;
            fit.index += label && label == next - 1;
        }
    }
    return fit;
}

/* The matrix from the voxels of the first image that is there to those of the volume. */
static conus_status from_first_image(double voxel_from_point[16], bool *found, const struct fsl_atlas *atlas,
                                     const struct label_use *use)
{
    char *path = NULL;
    conus_volume_info first;
    const struct fsl_image *image = atlas->images;
    conus_status status = CONUS_OK;
    *found = false;
    if (use->path && use->header && atlas->image_count) {
        status = image->summary ? fsl_image_find(&path, use->path, image->summary) : CONUS_OK;
        status = status || path || !image->image ? status : fsl_image_find(&path, use->path, image->image);
    }
    if (path && !use->header(&first, path)) { /* a damaged one says nothing */
        double voxel_from_world[16];
        *found = mat4_invert_affine(voxel_from_world, use->info->world_from_voxel);
        if (*found) {
            mat4_multiply(voxel_from_point, voxel_from_world, first.world_from_voxel);
        }
    }
    memory_free(path);
    return status;
}

static conus_status find_fit(struct fit *out, const struct fsl_atlas *atlas, const struct label_use *use)
{
    double own[16];
    double from_first[16];
    bool found;
    mat4_identity(own);
    *out = count_fits(atlas, use, own);
    conus_status status = from_first_image(from_first, &found, atlas, use);
    if (!status && found) {
        struct fit fit = count_fits(atlas, use, from_first);
        *out = best_of(fit) > best_of(*out) ? fit : *out;
    }
    return status;
}

/* Whether the points decide: two or more fit, at least half of them, and over four times as many as fit the other way.
 */
static bool fit_decides(struct fit fit)
{
    return best_of(fit) >= 2 && 2 * best_of(fit) >= fit.inside && best_of(fit) > 4 * worst_of(fit);
}

static bool first_is_background(const struct fsl_atlas *atlas)
{
    for (size_t i = 0; i < atlas->labels.count; i++) {
        const struct label *label = &atlas->labels.entries[i];
        if (label->number == 1) {
            return label->name && label_is_background(text_from(label->name));
        }
    }
    return false;
}

static conus_status note_choice(const struct fsl_atlas *atlas, const struct label_use *use, struct fit fit,
                                bool by_index, struct notes *notes)
{
    const char *name = use->path ? path_base(use->path) : "FSL atlas XML";
    const char *taken = by_index ? "index" : "index + 1";
    if (atlas->proved) {
        return notes_add(notes,
                         "%s: %s of a label is its number in the volume: so say x y z of %zu of %zu labels, although "
                         "its type is %s",
                         name, taken, best_of(fit), fit.inside, atlas->type);
    }
    return notes_warn(notes,
                      "%s: %s of a label is taken for its number in the volume, since index 0 is background, although "
                      "its type is %s",
                      name, taken, atlas->type);
}

/* Numbers the labels by index instead of index + 1; index 0 is dropped, without a note if the points prove that it is
 * no area. */
static conus_status take_indices(struct fsl_atlas *atlas, struct notes *notes)
{
    struct label_table next = atlas->labels;
    struct notes silent = {0};
    conus_status status = CONUS_OK;
    atlas->labels = (struct label_table){0};
    for (size_t i = 0; i < next.count; i++) {
        struct label label = next.entries[i];
        next.entries[i] = (struct label){0};
        label.number--;
        status = label_keep(&atlas->labels, &label, status, atlas->proved ? &silent : notes);
    }
    notes_finish(&silent);
    label_table_finish(&next);
    return status;
}

conus_status fsl_atlas_number(struct fsl_atlas *atlas, const struct label_use *use, struct notes *notes)
{
    struct fit fit = {0};
    conus_status status = use->voxels ? find_fit(&fit, atlas, use) : CONUS_OK;
    atlas->proved = fit_decides(fit);
    bool by_index = atlas->proved ? fit.index > fit.next : atlas->is_label || first_is_background(atlas);
    if (!status && by_index != atlas->is_label) {
        status = note_choice(atlas, use, fit, by_index, notes);
    }
    status = status || !by_index ? status : take_indices(atlas, notes);
    memory_free(atlas->points);
    atlas->points = NULL;
    return status ? status : label_table_sort(&atlas->labels, notes);
}
