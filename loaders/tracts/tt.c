/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads DSI Studio's streamlines, variable by variable. */
#include "loaders/tracts/tract_formats.h"

#include "base/byte_order.h"
#include "base/formats/packed.h"
#include "base/geometry/math3.h"

#include <stdio.h>

enum { HEADER_SIZE = 20, NAME_LIMIT = 64, RECORD_SIZE = 16, STEPS = 32 };

static const bool is_swapped = !BIG_ENDIAN_IS_SWAPPED; /* DSI Studio writes little-endian */

/* A variable of level 4: its header, then the name, then the numbers. */
struct variable {
    char name[NAME_LIMIT + 1];
    uint32_t type;  /* 0, 10, ... 50 */
    uint64_t count; /* numbers */
    size_t size;    /* bytes of each */
};

struct tt {
    struct job *job;
    struct reader r;
    struct tract_build *build;
    double world[16]; /* from voxels */
    bool has_world;
    float *clusters; /* [cluster_count] a number of each streamline */
    size_t cluster_count;
    unsigned tracks; /* variables that had streamlines */
};

static bool tt_has(struct tt *tt, size_t size, const char *what)
{
    bool has = reader_has(&tt->r, size);
    if (!has) {
        job_bad(tt->job, "%s: the file is cut off", what);
    }
    return has;
}

/* The next bytes; NULL after a failure. */
static const uint8_t *tt_take(struct tt *tt, size_t size, const char *what)
{
    return tt_has(tt, size, what) ? reader_take(&tt->r, size) : NULL;
}

/* Bytes of a number; 0 for an unknown type. */
static size_t size_of_type(uint32_t type)
{
    static const size_t sizes[] = {8, 4, 4, 2, 2, 1}; /* double, float, int, short, unsigned short, byte */
    return type % 10 == 0 && type / 10 < sizeof sizes / sizeof sizes[0] ? sizes[type / 10] : 0;
}

static double tt_number_at(const uint8_t *data, uint32_t type)
{
    size_t size = size_of_type(type);
    bool is_signed = type == 20 || type == 30; /* int and short */
    return type <= 10 ? order_real(data, size, is_swapped) : (double)order_whole(data, size, is_signed, is_swapped);
}

static void read_variable(struct variable *out, struct tt *tt)
{
    const uint8_t *data = tt_take(tt, HEADER_SIZE, "variable");
    if (!data) {
        return;
    }
    const uint32_t length = order_u32(data + 16, is_swapped);
    const uint32_t imaginary = order_u32(data + 12, is_swapped);
    out->type = order_u32(data, is_swapped);
    out->count = (uint64_t)order_u32(data + 4, is_swapped) * order_u32(data + 8, is_swapped);
    out->size = size_of_type(out->type);
    if (length < 1 || length > NAME_LIMIT) {
        job_bad(tt->job, "variable: a name of %u bytes, allowed are 1 to %d", length, NAME_LIMIT);
    }
    const uint8_t *name = job_ok(tt->job) ? tt_take(tt, length, "variable") : NULL;
    if (!name) {
        return;
    }
    if (name[length - 1] || memchr(name, 0, length - 1)) {
        job_bad(tt->job, "variable: its name does not end with its %u bytes", length);
        return;
    }
    memcpy(out->name, name, length);
    const uint64_t most = out->size ? reader_most(&tt->r) / out->size : 0;
    if (!out->size || imaginary) {
        job_bad(tt->job, "%s: of type %u, real numbers of the types 0, 10, 20, 30, 40 or 50 are needed", out->name,
                out->type);
    } else if (out->count > most) {
        job_bad(tt->job, "%s: %llu numbers, the file has room for %llu", out->name, (unsigned long long)out->count,
                (unsigned long long)most);
    }
}

static void skip_variable(struct tt *tt, const struct variable *variable)
{
    size_t size = 1;
    for (uint64_t left = variable->count * variable->size; left && tt_has(tt, 1, variable->name); left -= size) {
        (void)reader_some(&tt->r, left, 1, &size);
    }
}

/* The file has the matrix row by row. */
static void read_world(struct tt *tt, const struct variable *variable)
{
    if (variable->count != 16 || variable->type > 10) {
        job_bad(tt->job, "trans_to_mni: %llu numbers of type %u, 16 of type 0 or 10 are needed",
                (unsigned long long)variable->count, variable->type);
        return;
    }
    const uint8_t *data = tt_take(tt, 16 * variable->size, variable->name);
    bool good = true;
    for (size_t i = 0; data && i < 16; i++) {
        double value = tt_number_at(data + i * variable->size, variable->type);
        tt->world[4 * (i % 4) + i / 4] = value;
        good = good && isfinite(value);
    }
    double inverse[16];
    if (!good || !mat4_settle_last_row(tt->world) || !mat4_invert_affine(inverse, tt->world)) {
        job_bad(tt->job, "trans_to_mni: found no affine, needed is one with an inverse, last row 0 0 0 1");
    }
    tt->has_world = true;
}

static void read_clusters(struct tt *tt, const struct variable *variable)
{
    size_t count = (size_t)variable->count;
    if (tt->clusters || tt->tracks) {
        job_bad(tt->job, "cluster: twice, or behind track");
    } else if (variable->count > tt->build->max_memory / sizeof *tt->clusters) {
        job_fail(tt->job, CONUS_ERROR_MEMORY, "cluster: %llu numbers, allowed are %llu bytes (--max-memory)",
                 (unsigned long long)variable->count, (unsigned long long)tt->build->max_memory);
    }
    tt->clusters = job_array(tt->job, &count, sizeof *tt->clusters);
    tt->build->max_memory -= count * sizeof *tt->clusters;
    while (tt->cluster_count < count) {
        const uint8_t *data = tt_take(tt, variable->size, variable->name);
        if (!data) {
            return;
        }
        tt->clusters[tt->cluster_count++] = (float)tt_number_at(data, variable->type);
    }
    if (count) {
        tract_build_scalar(tt->build, text_from(variable->name), false, 1);
    }
}

static void add_point(struct tt *tt, const int64_t at[3])
{
    struct tractogram *tractogram = &tt->build->tractogram;
    float *out = tractogram->points + 3 * tractogram->point_count++;
    const double voxel[3] = {(double)at[0] / STEPS, (double)at[1] / STEPS, (double)at[2] / STEPS};
    double world[3];
    mat4_point(world, tt->world, voxel);
    for (int a = 0; a < 3; a++) {
        out[a] = (float)world[a];
    }
}

/* The points after the first, each a step of three bytes from the one before. */
static void take_steps(struct tt *tt, int64_t at[3], size_t count)
{
    size_t some = 0;
    for (; count && tt_has(tt, 3, "track"); count -= some) {
        const uint8_t *data = tt->r.at;
        some = smaller_of((size_t)(tt->r.end - data) / 3, count);
        if (!tract_build_points(tt->build, some)) {
            return;
        }
        for (size_t i = 0; i < some; i++) {
            for (size_t a = 0; a < 3; a++) {
                at[a] += (int8_t)data[3 * i + a];
            }
            add_point(tt, at);
        }
        tt->r.at += 3 * some;
    }
}

/* Reads one streamline, whose variable has `left` more bytes; gives how many are left then. */
static uint64_t tt_take_streamline(struct tt *tt, uint64_t left)
{
    int64_t at[3];
    struct tract_build *build = tt->build;
    const size_t number = build->tractogram.streamline_count;
    if (left < RECORD_SIZE) {
        job_bad(tt->job, "track: ends within streamline %zu", number);
    }
    const uint8_t *data = tt_take(tt, RECORD_SIZE, "track");
    if (!data) {
        return 0;
    }
    left -= RECORD_SIZE;
    const uint32_t count = order_u32(data, is_swapped);
    if (count < 3 || count % 3 || count - 3 > left) {
        job_bad(tt->job, "track: streamline %zu (from 0) has %u coordinates, needed are 3 of each point, %llu at most",
                number, count, (unsigned long long)(left + 3));
    }
    for (size_t a = 0; a < 3; a++) {
        at[a] = order_i32(data + 4 + 4 * a, is_swapped);
    }
    if (!tract_build_points(build, 1)) {
        return 0;
    }
    add_point(tt, at);
    take_steps(tt, at, count / 3 - 1);
    if (tt->cluster_count && number >= tt->cluster_count) {
        job_bad(tt->job, "cluster: %zu numbers, there are more streamlines", tt->cluster_count);
    }
    if (!tract_build_streamline(build)) {
        return 0;
    }
    if (tt->cluster_count) {
        build->tractogram.scalars[0].values[number] = tt->clusters[number];
    }
    tract_build_end_streamline(build);
    return left - (count - 3);
}

/* "track", then "track1", "track2" and so on. */
static void read_tracks(struct tt *tt, const struct variable *variable)
{
    char wanted[NAME_LIMIT];
    snprintf(wanted, sizeof wanted, tt->tracks ? "track%u" : "track", tt->tracks);
    if (strcmp(variable->name, wanted) != 0 || variable->size != 1) {
        job_bad(tt->job, "%s: of %zu bytes each, needed is %s of bytes", variable->name, variable->size, wanted);
    }
    if (!tt->has_world) {
        job_bad(tt->job, "trans_to_mni: missing before %s, nothing says where the streamlines are", wanted);
    }
    tt->tracks++;
    for (uint64_t left = variable->count; job_ok(tt->job) && left;) {
        left = tt_take_streamline(tt, left);
    }
}

void tt_read(struct job *job, struct source *source, struct tract_build *build)
{
    struct tt tt = {.job = job, .r = source_reader(job, source), .build = build};
    struct tractogram *t = &build->tractogram;
    while (reader_has(&tt.r, 1)) {
        struct variable variable = {0};
        read_variable(&variable, &tt);
        if (!job_ok(job)) {
            return;
        }
        (strcmp(variable.name, "trans_to_mni") == 0 ? read_world
         : strcmp(variable.name, "cluster") == 0    ? read_clusters
         : strncmp(variable.name, "track", 5) == 0  ? read_tracks
                                                    : skip_variable)(&tt, &variable);
    }
    if (!tt.tracks) {
        job_bad(job, "track: missing, so this is no tractogram of DSI Studio");
    } else if (tt.cluster_count && tt.cluster_count != t->streamline_count) {
        job_bad(job, "cluster: %zu numbers, there are %zu streamlines", tt.cluster_count, t->streamline_count);
    }
    job_note(job, "trans_to_mni was used; the file does not say into which space it leads");
    tract_build_end(build);
    snprintf(t->format, sizeof t->format, "DSI Studio%s", source->is_packed ? ", gzip" : "");
}
