/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes, clears and ends the evidence. */
#include "selection/evidence/evidence.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

conus_status evidence_init(struct evidence *out, uint32_t resolution)
{
    size_t pixels = (size_t)resolution * resolution;
    struct evidence evidence = {.resolution = resolution};
    evidence.distance =
        memory_raw(pixels, sizeof *evidence.distance + sizeof *evidence.voxel + sizeof *evidence.object);
    if (!evidence.distance) {
        return CONUS_ERROR_MEMORY;
    }
    evidence.voxel = (uint64_t *)(void *)(evidence.distance + pixels);
    evidence.object = (uint32_t *)(void *)(evidence.voxel + pixels);
    evidence_clear(&evidence);
    *out = evidence;
    return CONUS_OK;
}

void evidence_finish(struct evidence *evidence)
{
    memory_free(evidence->distance);
    *evidence = (struct evidence){0};
}

void evidence_clear(struct evidence *evidence)
{
    size_t pixels = (size_t)evidence->resolution * evidence->resolution;
    memset(evidence->object, 0, pixels * sizeof *evidence->object);
    memset(evidence->voxel, 0xff, pixels * sizeof *evidence->voxel); /* EVIDENCE_NO_VOXEL */
    for (size_t i = 0; i < pixels; i++) {
        evidence->distance[i] = INFINITY;
    }
}

void evidence_clear_pixel(struct evidence *evidence, size_t pixel)
{
    evidence->object[pixel] = 0;
    evidence->distance[pixel] = INFINITY;
    evidence->voxel[pixel] = EVIDENCE_NO_VOXEL;
}

void evidence_drop_blocked(struct evidence *evidence)
{
    size_t pixels = (size_t)evidence->resolution * evidence->resolution;
    uint32_t any = 0;
    for (size_t i = 0; i < pixels; i++) { /* without a branch, since mostly there are none */
        any |= evidence->object[i] == VOLUME_BLOCKER ? 1 : 0;
    }
    for (size_t i = 0; i < pixels && any; i++) {
        if (evidence->object[i] == VOLUME_BLOCKER) {
            evidence_clear_pixel(evidence, i);
        }
    }
}

void evidence_position(double out[3], const struct evidence *evidence, const struct cone *cone, uint32_t i, uint32_t j)
{
    size_t pixel = (size_t)j * evidence->resolution + i;
    if (evidence->object[pixel]) {
        cone_point(out, cone, i, j, evidence->distance[pixel]);
    } else {
        out[0] = out[1] = out[2] = NAN;
    }
}
