/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of datatypes, and the checks of datatype and dimensions that all formats share. */
#include "loaders/volumes/volumes.h"

#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <stdio.h>

/* nifti1.h, nifti2.h: "the types of data"; size 0 = known, but not one real number. */
static const struct datatype {
    int code;
    const char *name;
    size_t size;
    char kind;
} datatypes[] = {
    {VOLUME_UINT8, "uint8", 1, 'u'},
    {VOLUME_INT8, "int8", 1, 'i'},
    {VOLUME_UINT16, "uint16", 2, 'u'},
    {VOLUME_INT16, "int16", 2, 'i'},
    {VOLUME_UINT32, "uint32", 4, 'u'},
    {VOLUME_INT32, "int32", 4, 'i'},
    {VOLUME_UINT64, "uint64", 8, 'u'},
    {VOLUME_INT64, "int64", 8, 'i'},
    {VOLUME_FLOAT32, "float32", 4, 'f'},
    {VOLUME_FLOAT64, "float64", 8, 'f'},
    {1, "binary (1 bit)", 0, 0},
    {32, "complex64", 0, 0},
    {128, "RGB24", 0, 0},
    {1536, "float128", 0, 0},
    {1792, "complex128", 0, 0},
    {2048, "complex256", 0, 0},
    {2304, "RGBA32", 0, 0},
};

static const struct datatype *find_datatype(int code)
{
    for (size_t i = 0; i < sizeof datatypes / sizeof datatypes[0]; i++) {
        if (datatypes[i].code == code) {
            return &datatypes[i];
        }
    }
    return NULL;
}

size_t volume_datatype_size(int code)
{
    const struct datatype *type = find_datatype(code);
    return type ? type->size : 0;
}

const char *volume_datatype_name(int code)
{
    const struct datatype *type = find_datatype(code);
    return type ? type->name : NULL;
}

int volume_datatype_of(char kind, size_t size)
{
    for (size_t i = 0; i < sizeof datatypes / sizeof datatypes[0]; i++) {
        if (datatypes[i].kind == kind && datatypes[i].size == size) {
            return datatypes[i].code;
        }
    }
    return 0;
}

void volume_header_set_datatype(struct job *job, struct volume_header *header, int code)
{
    static const char allowed[] = "allowed are int8 to uint64, float32 and float64";
    const struct datatype *type = find_datatype(code);
    if (!type) {
        job_bad(job, "datatype: found %d, %s", code, allowed);
    } else if (!type->size) {
        job_refuse(job, "datatype: found %d (%s), %s", code, type->name, allowed);
    } else {
        header->datatype = code;
        snprintf(header->info.datatype, sizeof header->info.datatype, "%s", type->name);
    }
}

void volume_header_set_dim(struct job *job, struct volume_header *header, const int64_t dim[7])
{
    size_t size = volume_datatype_size(header->datatype);
    size_t count = 1;
    size_t total;
    bool fits = true;
    for (int i = 0; i < 3; i++) {
        fits = fits && memory_multiply(size, (size_t)dim[i], &size);
    }
    for (int i = 3; i < 7; i++) {
        fits = fits && memory_multiply(count, (size_t)dim[i], &count);
    }
    if (!fits || !memory_multiply(size, count, &total) || total > INT64_MAX / 2) {
        job_bad(job,
                "dim: found %lld x %lld x %lld x %lld x %lld x %lld x %lld voxels of %s, "
                "allowed are as many as fit in 2^62 bytes",
                (long long)dim[0], (long long)dim[1], (long long)dim[2], (long long)dim[3], (long long)dim[4],
                (long long)dim[5], (long long)dim[6], header->info.datatype);
    }
    if (!job_ok(job)) {
        return;
    }
    for (int i = 0; i < 3; i++) {
        header->info.dim[i] = (size_t)dim[i];
    }
    header->info.volume_count = count;
    header->volume_size = size;
}

/* The Allen Institute's volumes count micrometres and call AP, DV and ML x, y and z: steps of 25, 0, 0 and so on. No
 * other brain is that large, and they are placed as they are meant: from the corner backward, downward and to the
 * right. False for others. */
static bool place_ccf(struct job *job, struct volume_header *header, const double size[3])
{
    const double *m = header->info.world_from_voxel;
    bool plain = !header->has_unit && m[12] == 0 && m[13] == 0 && m[14] == 0 && frame_is_ccf_size(size);
    for (size_t i = 0; i < 3; i++) {
        const double length = header->info.spacing[i];
        const double *step = m + 4 * i;
        plain = plain && (fabs(step[0]) == length || fabs(step[1]) == length || fabs(step[2]) == length);
    }
    if (!plain) {
        return false;
    }
    double steps[3];
    for (size_t i = 0; i < 3; i++) {
        steps[i] = header->info.spacing[i] / 1000;
    }
    const double world[16] = {
        0, -steps[0], 0, 0, 0, 0, -steps[1], 0, steps[2], 0, 0, 0, steps[2] / 2, -steps[0] / 2, -steps[1] / 2, 1};
    job_note(job,
             "%s: the grid is the Allen CCF's in micrometres, and is placed as that one: x = ML, y = -AP, z = -DV from "
             "its corner, in mm",
             header->info.transform);
    return JOB_CALL(job, space_describe(&header->info, world, "the Allen CCF's grid"));
}

/* Spheres of FreeSurfer and the HCP; more voxels in a row than 20000 are vertices, too. */
static bool is_of_vertices(const struct volume_header *header)
{
    static const size_t counts[] = {642, 2562, 10242};
    const size_t *dim = header->info.dim;
    bool is = dim[0] >= 20000;
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        is = is || dim[0] == counts[i];
    }
    return is && dim[1] == 1 && dim[2] == 1;
}

void volume_header_settle(struct job *job, struct volume_header *header)
{
    static const double most = 1000; /* a brain is not larger than a metre: the numbers mean something else, */
    static const double least = 0.3; /* and as few metres would be one */
    double size[3];
    double largest = 0;
    if (is_of_vertices(header)) {
        job_bad(job, "dim: found %zu x 1 x 1: this is values of the vertices of a surface", header->info.dim[0]);
    }
    for (size_t i = 0; i < 3; i++) {
        size[i] = header->info.spacing[i] * (double)header->info.dim[i];
        largest = fmax(largest, size[i]);
    }
    const bool is_small = largest < least && !header->has_unit;
    if (job_ok(job) && !place_ccf(job, header, size) && (largest > most || is_small)) {
        job_warn(job, "%s: the grid is %g mm long: are they %s? %s", header->info.transform, largest,
                 is_small ? "metres" : "micrometres",
                 header->has_unit ? "The unit that the file states was used"
                                  : "The file states no unit, so they were taken as millimetres");
    }
}
