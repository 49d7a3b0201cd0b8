/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the paper's volume of a bonsai, or makes a similar one. */
#include "bench/support/bench.h"

#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <stdio.h>
#include <string.h>

static const char papers_sum[] = "288d2818cffb50d2e2c9e3b5b0a2520d09b0f5051bb63cca315f3fc7a894af80";

enum { VOXELS = BONSAI_EDGE * BONSAI_EDGE * BONSAI_EDGE };

/* Any format that a context may have. */
static conus_status read_context(uint8_t *voxels, const char *path)
{
    conus_atlas *atlas = NULL;
    conus_status status = atlas_create_empty(&atlas, "bonsai");
    status = status ? status : conus_atlas_set_context(atlas, path, NULL);
    const struct volume *volume = status ? NULL : atlas_context(atlas);
    if (volume && volume->voxel_count != VOXELS) {
        status = fail(CONUS_ERROR_DATA, "%s: %zu voxels, the paper's volume has %d", path, volume->voxel_count, VOXELS);
    }
    for (size_t i = 0; volume && !status && i < VOXELS; i++) {
        voxels[i] = (uint8_t)volume->values[i];
    }
    conus_atlas_destroy(atlas);
    return status;
}

static conus_status read_voxels(uint8_t *voxels, const char *path)
{
    struct bytes file = {0};
    conus_status status = file_read(&file, path, VOXELS);
    bool raw = !status && file.size == VOXELS;
    if (raw) {
        memcpy(voxels, file.data, VOXELS);
    }
    bytes_finish(&file);
    return status || raw ? status : read_context(voxels, path);
}

conus_status bonsai_read(struct bonsai *out, const char *path)
{
    char sum[65] = "";
    uint8_t *voxels = memory_raw(VOXELS, 1);
    conus_status status = voxels ? read_voxels(voxels, path) : CONUS_ERROR_MEMORY;
    if (!status) {
        file_sha256(sum, &(struct bytes){.data = voxels, .size = VOXELS});
        if (strcmp(sum, papers_sum) != 0) {
            status = fail(CONUS_ERROR_DATA, "%s: the voxels' SHA-256 is %s, the paper's volume has %s", path, sum,
                          papers_sum);
        }
    }
    if (status) {
        memory_free(voxels);
        return status;
    }
    *out = (struct bonsai){BONSAI_EDGE, voxels, true};
    return CONUS_OK;
}

/* Clouds of leaves: middle and radius, in parts of the edge. */
static const double clouds[][4] = {{0.24, 0.56, 0.62, 0.15},
                                   {0.76, 0.44, 0.66, 0.15},
                                   {0.46, 0.24, 0.75, 0.13},
                                   {0.60, 0.72, 0.80, 0.13},
                                   {0.56, 0.48, 0.78, 0.16}};

/* Leaves are grains of noise, in clouds that become thinner outwards. */
static double leaves(const double p[3], double noise)
{
    double nearest = 2;
    for (size_t i = 0; i < sizeof clouds / sizeof *clouds; i++) {
        double away[3];
        vec3_sub(away, p, clouds[i]);
        nearest = fmin(nearest, sqrt(vec3_dot(away, away)) / clouds[i][3]);
    }
    return nearest < 1 && noise > 0.35 + 0.5 * nearest ? 30 + 60 * noise : 0;
}

static double pot(const double p[3])
{
    double sideways = fmax(fabs(p[0] - 0.5), fabs(p[1] - 0.5));
    bool is_wall = sideways < 0.30 && p[2] > 0.05 && p[2] < 0.22 && (sideways > 0.27 || p[2] < 0.08);
    bool is_soil = sideways <= 0.27 && p[2] >= 0.08 && p[2] < 0.20;
    return is_wall ? 205 : is_soil ? 90 : 0;
}

/* A number from 0 to 1 for each grain of two voxels. */
static double grain(size_t i, size_t j, size_t k)
{
    uint64_t seed = (i / 2) | (uint64_t)(j / 2) << 20 | (uint64_t)(k / 2) << 40;
    return bench_random(&seed, 0, 1);
}

conus_status bonsai_make(struct bonsai *out, size_t edge)
{
    uint8_t *voxels = memory_raw(edge * edge * edge, 1);
    if (!voxels) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t v = 0; v < edge * edge * edge; v++) {
        const size_t at[3] = {v % edge, v / edge % edge, v / edge / edge};
        double p[3], noise = grain(at[0], at[1], at[2]);
        for (int a = 0; a < 3; a++) {
            p[a] = ((double)at[a] + 0.5) / (double)edge;
        }
        double density = fmax(pot(p), leaves(p, noise));
        voxels[v] = (uint8_t)fmax(density, 8 * noise);
    }
    *out = (struct bonsai){edge, voxels, false};
    return CONUS_OK;
}

void bonsai_finish(struct bonsai *bonsai)
{
    memory_free(bonsai->voxels);
    *bonsai = (struct bonsai){0};
}

void bonsai_info(conus_volume_info *out, const struct bonsai *bonsai, const double centre[3], double threshold)
{
    *out = (conus_volume_info){.role = threshold > 0 ? CONUS_ROLE_SCALAR : CONUS_ROLE_CONTEXT,
                               .path = "bonsai",
                               .minimum = 0,
                               .maximum = 255,
                               .slope = 1,
                               .threshold = threshold};
    mat4_identity(out->world_from_voxel);
    for (int a = 0; a < 3; a++) {
        out->dim[a] = bonsai->edge;
        out->spacing[a] = 1;
        out->world_from_voxel[12 + a] = centre[a] - 0.5 * (double)(bonsai->edge - 1);
    }
    snprintf(out->datatype, sizeof out->datatype, "uint8");
    snprintf(out->orientation, sizeof out->orientation, "RAS");
}

float *bonsai_values(const struct bonsai *bonsai)
{
    size_t count = bonsai->edge * bonsai->edge * bonsai->edge;
    float *values = memory_raw(count, sizeof *values);
    for (size_t i = 0; values && i < count; i++) {
        values[i] = bonsai->voxels[i];
    }
    return values;
}
