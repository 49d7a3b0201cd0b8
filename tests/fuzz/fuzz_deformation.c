/* SPDX-License-Identifier: BSD-3-Clause */
/* Deformation fields: headers of their files, and small fields of arbitrary numbers. A point found on the way back goes
 * to the wanted place. */
#include "atlas/deformation/deformation.h"
#include "base/geometry/math3.h"
#include "loaders/transform/transform.h"
#include "loaders/volumes/volumes.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void read_header(const uint8_t *data, size_t size)
{
    struct field_header header;
    struct job job = {0};
    field_header_parse(&job, &header, (struct text){(const char *)data, size});
    for (int n = 0; job_ok(&job) && n < 18; n++) {
        struct job asked = {0};
        (void)field_header_kind(&asked, &header, n % 2, (conus_vectors)(n / 2 % 3), (conus_file_space)(n / 6));
        if (job_ok(&asked) && !(header.dim[1] > 1 && header.dim[2] > 1 && header.dim[3] > 1)) {
            abort();
        }
        job_end(&asked);
    }
    job_end(&job);
}

/* Takes two points through the field and back. */
static void go_there_and_back(const struct deformation *field)
{
    for (int n = 0; n < 2; n++) {
        const double p[3] = {0.3 + n, 0.6, 0.2};
        double there[3];
        double back[3];
        double again[3];
        struct deformation_facts facts;
        if (deformation_facts_find(&facts, field) || facts.folds > facts.cells || facts.unstated > facts.nodes) {
            abort();
        }
        if (!deformation_point(there, field, p) || deformation_find(back, field, there) != DEFORMATION_FOUND) {
            continue; /* a field of arbitrary numbers promises nothing else */
        }
        double miss[3];
        if (!deformation_point(again, field, back)) {
            abort();
        }
        vec3_sub(miss, again, there);
        if (!(vec3_length(miss) <= 1e-5 * (1 + vec3_length(there)))) {
            abort();
        }
    }
}

/* Three bytes of size, one of kind, then bytes as numbers of an eighth of a mm; -128 means no value. */
static void make_field(const uint8_t *data, size_t size)
{
    float vectors[3 * 64] = {0};
    struct deformation field = {.vectors = vectors, .is_borrowed = true};
    size_t nodes = 1;
    for (int a = 0; a < 3; a++) {
        field.dim[a] = 2 + data[a] % 3;
        nodes *= field.dim[a];
    }
    mat4_identity(field.world_from_voxel);
    mat4_identity(field.voxel_from_world);
    mat4_identity(field.linear);
    field.stays_outside = data[3] & 1;
    mat4_identity(field.base);
    if (data[3] & 2) {
        memset(field.base, 0, sizeof field.base);
        field.base[15] = 1;
    }
    for (size_t i = 0; i < 3 * nodes && i + 4 < size; i++) {
        int8_t number = (int8_t)data[i + 4];
        vectors[i] = number == INT8_MIN ? NAN : (float)number / 8;
    }
    if (!deformation_measure(&field)) {
        go_there_and_back(&field);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (nifti_is(data, size)) {
        read_header(data, size);
    } else if (size >= 4) {
        make_field(data, size);
    }
    return 0;
}
