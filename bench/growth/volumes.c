/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes labelled volumes plane by plane, so that nothing is in memory but what the atlas keeps. */
#include "bench/growth/volumes.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

/* What the voxels of a volume are made of. */
struct recipe {
    conus_volume_info info;
    uint32_t (*label)(const struct recipe *recipe, size_t i, size_t j, size_t k);
    const conus_atlas *atlas;    /* to enlarge */
    const struct volume *volume; /* its parcellation */
    double times;
    size_t edge, blocks;
};

static conus_status fill(struct label_voxels *out, const struct recipe *recipe)
{
    const size_t *dim = recipe->info.dim;
    struct label_coder coder;
    uint32_t *plane = memory_raw(dim[0] * dim[1], sizeof *plane);
    conus_status status = plane ? label_coder_init(&coder, dim[0] * dim[1] * dim[2], 0, NULL, 0) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(plane);
        return status;
    }
    for (size_t k = 0; k < dim[2] && !status; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            for (size_t i = 0; i < dim[0]; i++) {
                plane[i + dim[0] * j] = recipe->label(recipe, i, j, k);
            }
        }
        status = label_coder_add(&coder, plane, dim[0] * dim[1]);
    }
    if (!status) {
        label_coder_end(out, &coder);
    }
    label_coder_finish(&coder);
    memory_free(plane);
    return status;
}

static conus_status make(conus_atlas **out, const struct recipe *recipe)
{
    struct label_voxels labels = {0};
    struct label_table table = {0};
    struct notes notes = {0};
    conus_status status = fill(&labels, recipe);
    struct labelled_volume volume = {.info = &recipe->info, .labels = &labels};
    status = status ? status : atlas_create_of(out, &volume, 1, &table, "made for conus-bench", &notes);
    label_voxels_finish(&labels);
    notes_finish(&notes);
    return status;
}

static uint32_t enlarged_label(const struct recipe *recipe, size_t i, size_t j, size_t k)
{
    const size_t *dim = recipe->volume->info.dim;
    const size_t fine[3] = {i, j, k};
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = (size_t)(((double)fine[a] + 0.5) * (double)dim[a] / (double)recipe->info.dim[a]);
    }
    uint32_t number = volume_object(recipe->volume, at[0] + dim[0] * (at[1] + dim[1] * at[2]));
    return number ? recipe->atlas->objects[number - 1].label : 0;
}

conus_status volumes_enlarge(conus_atlas **out, const conus_atlas *atlas, double times)
{
    struct recipe recipe = {.label = enlarged_label, .atlas = atlas, .volume = atlas_parcellation(atlas)};
    recipe.info = recipe.volume->info;
    double *m = recipe.info.world_from_voxel;
    const double *coarse = recipe.volume->info.world_from_voxel;
    for (int a = 0; a < 3; a++) {
        size_t dim = recipe.volume->info.dim[a];
        recipe.info.dim[a] = (size_t)fmax(1, round((double)dim * times));
        double step = (double)dim / (double)recipe.info.dim[a];
        for (int r = 0; r < 3; r++) { /* the corner of the grid stays where it is */
            m[4 * a + r] = coarse[4 * a + r] * step;
            m[12 + r] += coarse[4 * a + r] * (step - 1) / 2;
        }
    }
    return make(out, &recipe);
}

static uint32_t block_label(const struct recipe *recipe, size_t i, size_t j, size_t k)
{
    size_t block = recipe->edge / recipe->blocks;
    double middle = (double)(recipe->edge - 1) / 2;
    double x = (double)i - middle;
    double y = (double)j - middle;
    double z = (double)k - middle;
    bool inside = x * x + y * y + z * z <= middle * middle;
    size_t number = i / block + recipe->blocks * (j / block + recipe->blocks * (k / block));
    return inside ? (uint32_t)number + 1 : 0;
}

conus_status volumes_blocks(conus_atlas **out, size_t edge, size_t blocks)
{
    double corner = -(double)(edge - 1) / 2;
    struct recipe recipe = {.label = block_label, .edge = edge, .blocks = blocks};
    recipe.info = (conus_volume_info){.role = CONUS_ROLE_PARCELLATION, .path = "blocks", .dim = {edge, edge, edge}};
    const double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, corner, corner, corner, 1};
    memcpy(recipe.info.world_from_voxel, m, sizeof m);
    return make(out, &recipe);
}
