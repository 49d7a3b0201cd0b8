/* SPDX-License-Identifier: BSD-3-Clause */
/* Which number a label of an FSL atlas XML has in a volume of labels: its index, or that plus one. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "loaders/labels/label_format.h"
#include "loaders/labels/labels.h"

#include <math.h>

/* How many points of labels lie in the volume, in voxels that hold the label's index, and that plus one. */
struct fit {
    size_t inside, index, next;
    size_t best, worst; /* of the last two */
};

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
    fit.best = fit.index > fit.next ? fit.index : fit.next;
    fit.worst = fit.index > fit.next ? fit.next : fit.index;
    return fit;
}

/* The matrix from the voxels of the first image that is there to those of the volume; false if there is none. */
static bool from_first_image(double voxel_from_point[16], struct job *job, const struct fsl_atlas *atlas,
                             const struct label_use *use)
{
    conus_volume_info first;
    double voxel_from_world[16];
    const struct fsl_image *image = atlas->images;
    const char *path = NULL;
    if (use->path && use->header && atlas->image_count) {
        path = image->summary ? fsl_image_find(job, use->path, image->summary) : NULL;
        path = path || !image->image ? path : fsl_image_find(job, use->path, image->image);
    }
    if (!path) {
        return false;
    }
    const struct attempt attempt = job_try(job); /* a damaged one says nothing */
    use->header(job, &first, path);
    if (attempt_end(job, &attempt, ATTEMPT_TRY) || !job_ok(job) ||
        !mat4_invert_affine(voxel_from_world, use->info->world_from_voxel)) {
        return false;
    }
    mat4_multiply(voxel_from_point, voxel_from_world, first.world_from_voxel);
    return true;
}

static struct fit find_fit(struct job *job, const struct fsl_atlas *atlas, const struct label_use *use)
{
    double voxel_from_point[16];
    mat4_identity(voxel_from_point);
    struct fit own = count_fits(atlas, use, voxel_from_point);
    bool found = from_first_image(voxel_from_point, job, atlas, use);
    struct fit fit = found ? count_fits(atlas, use, voxel_from_point) : own;
    return fit.best > own.best ? fit : own;
}

/* Whether the points decide: two or more fit, at least half of them, and over four times as many as fit the other way.
 */
static bool fit_decides(struct fit fit)
{
    return fit.best >= 2 && 2 * fit.best >= fit.inside && fit.best > 4 * fit.worst;
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

static void note_choice(struct job *job, const struct fsl_atlas *atlas, const struct label_use *use, struct fit fit,
                        bool by_index)
{
    const char *name = use->path ? path_base(use->path) : "FSL atlas XML";
    const char *taken = by_index ? "index" : "index + 1";
    if (atlas->proved) {
        job_note(job,
                 "%s: %s of a label is its number in the volume: so say x y z of %zu of %zu labels, although its type "
                 "is %s",
                 name, taken, fit.best, fit.inside, atlas->type);
    } else {
        job_warn(job,
                 "%s: %s of a label is taken for its number in the volume, since index 0 is background, although its "
                 "type is %s",
                 name, taken, atlas->type);
    }
}

/* Numbers the labels by index instead of index + 1; index 0 is dropped, without a note if the points prove that it is
 * no area. */
static void take_indices(struct job *job, struct fsl_atlas *atlas)
{
    struct label_table *next = labels_new(job);
    for (size_t i = 0; i < atlas->labels.count; i++) {
        const struct label *label = &atlas->labels.entries[i];
        struct label_row row = {.label = {.number = label->number - 1},
                                .name = text_from(label->name ? label->name : ""),
                                .abbreviation = text_from(label->abbreviation ? label->abbreviation : "")};
        if (row.label.number || !atlas->proved) {
            labels_keep(job, next, &row);
        }
    }
    if (job_ok(job)) {
        struct label_table before = atlas->labels;
        atlas->labels = *next;
        *next = before;
    }
}

void fsl_atlas_number(struct job *job, struct fsl_atlas *atlas, const struct label_use *use)
{
    struct fit fit = {0};
    if (!job_ok(job)) {
        return;
    }
    if (use->voxels) {
        fit = find_fit(job, atlas, use);
    }
    atlas->proved = fit_decides(fit);
    bool by_index = atlas->proved ? fit.index > fit.next : atlas->is_label || first_is_background(atlas);
    if (by_index != atlas->is_label) {
        note_choice(job, atlas, use, fit, by_index);
    }
    if (by_index) {
        take_indices(job, atlas);
    }
    labels_sort(job, &atlas->labels);
}

void label_parse_fsl(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    struct fsl_atlas *atlas = fsl_atlas_parse(job, text);
    fsl_atlas_number(job, atlas, use);
    labels_move(job, out, &atlas->labels);
}
