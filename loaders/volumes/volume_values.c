/* SPDX-License-Identifier: BSD-3-Clause */
/* Stored voxels into labels and values. */
#include "loaders/volumes/volumes.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "base/tolerance.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = 1024 }; /* voxels converted at a time: small enough for the cache, big enough for vectors */

static size_t values_count_voxels(const struct volume_file *file)
{
    return file->info.dim[0] * file->info.dim[1] * file->info.dim[2]; /* checked when the header was read */
}

static bool is_scaled(const struct volume_file *file)
{
    return file->info.slope != 1 || file->info.intercept != 0;
}

/* Block decoders: `count` voxels from `in`, unscaled. */

/* Defines two functions per type: one for doubles, which hold every 32-bit type exactly; and one for labels, which
 * never pass through doubles, and which returns false if a voxel is no label. */
#define DEFINE_DECODERS(name, type, read, is_label)                                                                    \
    static void name##_doubles(double *out, const uint8_t *in, size_t count, bool swapped)                             \
    {                                                                                                                  \
        for (size_t i = 0; i < count; i++) {                                                                           \
            out[i] = (double)(type)read(in + i * sizeof(type), swapped);                                               \
        }                                                                                                              \
    }                                                                                                                  \
    static bool name##_labels(uint32_t *out, const uint8_t *in, size_t count, bool swapped)                            \
    {                                                                                                                  \
        bool fine = true;                                                                                              \
        for (size_t i = 0; i < count; i++) {                                                                           \
            type v = (type)read(in + i * sizeof(type), swapped);                                                       \
            bool good = is_label;                                                                                      \
            fine &= good;                                                                                              \
            out[i] = good ? (uint32_t)v : 0;                                                                           \
        }                                                                                                              \
        return fine;                                                                                                   \
    }

static uint8_t read_byte(const uint8_t *data, bool swapped)
{
    (void)swapped;
    return *data;
}

DEFINE_DECODERS(u8, uint8_t, read_byte, true)
DEFINE_DECODERS(i8, int8_t, read_byte, v >= 0)
DEFINE_DECODERS(u16, uint16_t, order_u16, true)
DEFINE_DECODERS(i16, int16_t, order_i16, v >= 0)
DEFINE_DECODERS(u32, uint32_t, order_u32, true)
DEFINE_DECODERS(i32, int32_t, order_i32, v >= 0)
DEFINE_DECODERS(u64, uint64_t, order_u64, v <= UINT32_MAX)
DEFINE_DECODERS(i64, int64_t, order_i64, v >= 0 && v <= UINT32_MAX)
DEFINE_DECODERS(f32, float, order_f32, v >= 0 && v < 0x1p32F && v == floorf(v))
DEFINE_DECODERS(f64, double, order_f64, v >= 0 && v < 0x1p32 && v == floor(v))

struct decoder {
    int datatype;
    void (*doubles)(double *out, const uint8_t *in, size_t count, bool swapped);
    bool (*labels)(uint32_t *out, const uint8_t *in, size_t count, bool swapped);
};

static const struct decoder decoders[] = {
    {VOLUME_UINT8, u8_doubles, u8_labels},     {VOLUME_INT8, i8_doubles, i8_labels},
    {VOLUME_UINT16, u16_doubles, u16_labels},  {VOLUME_INT16, i16_doubles, i16_labels},
    {VOLUME_UINT32, u32_doubles, u32_labels},  {VOLUME_INT32, i32_doubles, i32_labels},
    {VOLUME_UINT64, u64_doubles, u64_labels},  {VOLUME_INT64, i64_doubles, i64_labels},
    {VOLUME_FLOAT32, f32_doubles, f32_labels}, {VOLUME_FLOAT64, f64_doubles, f64_labels},
};

static const struct decoder *find_decoder(int datatype)
{
    size_t i = 0;
    while (decoders[i].datatype != datatype) { /* the header's reader has let through only these */
        i++;
    }
    return &decoders[i];
}

double volume_value_at(const uint8_t *data, int datatype, bool swapped)
{
    double value;
    find_decoder(datatype)->doubles(&value, data, 1, swapped);
    return value;
}

static bool is_real(const struct volume_file *file)
{
    return file->datatype == VOLUME_FLOAT32 || file->datatype == VOLUME_FLOAT64;
}

/* False where some value, scaled if the file has a scale, and rounded within its slack, is no label. */
static bool block_labels(uint32_t *out, const struct decoder *decoder, const struct volume_file *file,
                         const uint8_t *in, size_t count)
{
    bool fine = !is_scaled(file) && decoder->labels(out, in, count, file->swapped);
    if (fine || (!is_scaled(file) && !is_real(file))) {
        return fine;
    }
    double values[BLOCK];
    const double offset = fabs(file->info.intercept);
    decoder->doubles(values, in, count, file->swapped);
    fine = true;
    for (size_t i = 0; i < count; i++) {
        double product = values[i] * file->info.slope;
        double v = product + file->info.intercept;
        v = tolerance_whole(v, fabs(product) > offset ? fabs(product) : offset);
        v = fabs(v - rint(v)) <= file->label_slack ? rint(v) : v;
        bool good = v >= 0 && v < 0x1p32 && v == floor(v);
        fine &= good;
        out[i] = good ? (uint32_t)v : 0;
    }
    return fine;
}

/* Keeps the first voxel that is no label. */
static void keep_bad(struct label_reader *reader, size_t voxel, const uint8_t *bytes)
{
    if (!reader->is_bad || voxel < reader->bad_voxel) {
        reader->is_bad = true;
        reader->bad_voxel = voxel;
        memcpy(reader->bad_bytes, bytes, volume_datatype_size(reader->file->datatype));
    }
}

/* Decodes voxels, the first of which is `from`. */
static void code_labels(struct job *job, struct label_reader *reader, const uint8_t *voxels, size_t from, size_t count)
{
    const struct volume_file *file = reader->file;
    const struct decoder *decoder = find_decoder(file->datatype);
    size_t size = volume_datatype_size(file->datatype);
    if (file->datatype == VOLUME_UINT32 && !file->swapped && !is_scaled(file) && (uintptr_t)voxels % size == 0) {
        (void)JOB_CALL(job, label_coder_put(&reader->coder, from, (const void *)voxels, count)); /* as they are */
        return;
    }
    for (size_t at = 0; job_ok(job) && at < count; at += BLOCK) {
        uint32_t labels[BLOCK];
        size_t block = count - at < BLOCK ? count - at : BLOCK;
        if (!block_labels(labels, decoder, file, voxels + at * size, block)) {
            while (block_labels(labels, decoder, file, voxels + at * size, 1)) { /* the first one that is no label */
                at++;
            }
            keep_bad(reader, from + at, voxels + at * size);
            return;
        }
        (void)JOB_CALL(job, label_coder_put(&reader->coder, from + at, labels, block));
    }
}

void label_reader_begin(struct job *job, struct label_reader *reader, const struct volume_file *file,
                        const struct bytes *memory)
{
    *reader = (struct label_reader){.file = file};
    if (!job_step(job)) {
        memory_free(memory->data);
        return;
    }
    const size_t count = values_count_voxels(file);
    const conus_status status = label_coder_init(&reader->coder, count, file->max_memory, memory->data, memory->size);
    (void)JOB_CALL(job, status);
}

void label_reader_take(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count)
{
    code_labels(job, user, voxels, first, count);
}

void label_reader_end(struct job *job, struct label_voxels *out, struct label_reader *reader, struct volume_file *file)
{
    if (!job_step(job)) {
        return;
    }
    if (!reader->is_bad) {
        label_coder_end(out, &reader->coder);
        file->info.minimum = reader->coder.minimum;
        file->info.maximum = reader->coder.maximum;
        return;
    }
    char words[128]; /* as a person would write it: integers whole, however big; scaled ones with their scale */
    const uint8_t *voxel = reader->bad_bytes;
    double value = volume_value_at(voxel, file->datatype, file->swapped);
    if (is_scaled(file)) {
        snprintf(words, sizeof words, "%.12g (stored %.12g, scale %.9g, offset %.9g)",
                 value * file->info.slope + file->info.intercept, value, file->info.slope, file->info.intercept);
    } else if (file->datatype == VOLUME_UINT64) {
        snprintf(words, sizeof words, "%llu", (unsigned long long)order_u64(voxel, file->swapped));
    } else if (file->datatype == VOLUME_INT64) {
        snprintf(words, sizeof words, "%lld", (long long)order_i64(voxel, file->swapped));
    } else {
        snprintf(words, sizeof words, "%.17g", value);
    }
    const size_t *dim = file->info.dim;
    size_t row = reader->bad_voxel / dim[0];
    job_bad(job,
            "%s: voxel (%zu, %zu, %zu): found %s, allowed labels are whole numbers from 0 to 4294967295; --context "
            "draws an image, --pathway selects what is bright in it, 'conus overlap ATLAS MAP' lists the areas under a "
            "map",
            file->path, reader->bad_voxel % dim[0], row % dim[1], row / dim[1], words);
}

void label_reader_finish(struct label_reader *reader)
{
    label_coder_finish(&reader->coder);
}

/* `memory` becomes the labels'. */
static void read_labels(struct job *job, struct label_voxels *out, struct volume_file *file, const uint8_t *voxels,
                        const struct bytes *memory)
{
    struct label_reader reader;
    const size_t place = job_in(job, file->path ? file->path : "", JOB_ALONE);
    label_reader_begin(job, &reader, file, memory);
    if (job_ok(job)) {
        code_labels(job, &reader, voxels, 0, values_count_voxels(file));
    }
    job_out(job, place);
    label_reader_end(job, out, &reader, file);
    label_reader_finish(&reader);
}

void volume_labels(struct job *job, struct label_voxels *out, struct volume_file *file)
{
    read_labels(job, out, file, file->voxels.data, &(struct bytes){0});
}

void volume_take_labels(struct job *job, struct label_voxels *out, struct volume_file *file)
{
    struct bytes voxels = file->voxels;
    bool in_place = volume_datatype_size(file->datatype) >= sizeof(uint16_t) && !file->series.data;
    file->voxels = (struct bytes){0};
    read_labels(job, out, file, voxels.data, in_place ? &voxels : &(struct bytes){0});
    if (!in_place) {
        bytes_finish(file->series.data ? &file->series : &voxels);
    }
    file->series = (struct bytes){0};
}

/* Scales a block into `out`; returns how many values are not finite (and become `instead`). */
static size_t block_values(float *out, const double *values, size_t count, double instead, conus_volume_info *info)
{
    size_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        double v = values[i] * info->slope + info->intercept;
        bool good = fabs(v) <= (double)FLT_MAX;
        bad += !good;
        v = good ? v : instead;
        info->minimum = v < info->minimum ? v : info->minimum;
        info->maximum = v > info->maximum ? v : info->maximum;
        out[i] = (float)v;
    }
    return bad;
}

static void note_bad(struct job *job, const struct volume_file *file, size_t bad, double instead)
{
    if (bad) {
        job_note(job, "%s: %zu voxels are not finite numbers (or beyond float32) and %s", file->path, bad,
                 isnan(instead) ? "belong to nothing" : "count as 0");
    }
}

/* Values of which some are to be finite, if the others are NaN. */
static void check_finite(struct job *job, const struct volume_file *file, double instead)
{
    if (isnan(instead) && !(file->info.minimum <= file->info.maximum)) {
        job_bad(job, "%s: no voxel has a finite value", file->path);
    }
}

static float *read_values(struct job *job, struct volume_file *file, double instead)
{
    if (!job_step(job)) { /* there may be no file */
        return NULL;
    }
    const struct decoder *decoder = find_decoder(file->datatype);
    size_t count = values_count_voxels(file);
    size_t size = volume_datatype_size(file->datatype);
    float *values = memory_raw(count, sizeof *values);
    if (!job_need(job, values)) {
        return NULL;
    }
    size_t bad = 0;
    file->info.minimum = INFINITY;
    file->info.maximum = -INFINITY;
    for (size_t at = 0; at < count; at += BLOCK) {
        double stored[BLOCK];
        size_t block = count - at < BLOCK ? count - at : BLOCK;
        decoder->doubles(stored, file->voxels.data + at * size, block, file->swapped);
        bad += block_values(values + at, stored, block, instead, &file->info);
    }
    note_bad(job, file, bad, instead);
    check_finite(job, file, instead);
    if (job_ok(job)) {
        return values;
    }
    memory_free(values);
    return NULL;
}

float *volume_values(struct job *job, struct volume_file *file)
{
    return read_values(job, file, 0);
}

float *volume_values_or_nan(struct job *job, struct volume_file *file)
{
    return read_values(job, file, NAN);
}

/* The source of a map's codes. */
struct mapping {
    struct volume_file *file;
    const struct decoder *decoder;
    size_t width;
    double instead;
    size_t bad, bad_background; /* voxels that are not finite, and whether the background is not */
    size_t done;                /* voxels of runs that are kept */
    size_t most;                /* highest code, but of floats */
};

/* A value_coder. */
static void code_run(void *user, void *codes, const uint8_t *stored, size_t count)
{
    struct mapping *mapping = user;
    double numbers[VALUE_RUN];
    float values[VALUE_RUN];
    mapping->decoder->doubles(numbers, stored, count, mapping->file->swapped);
    size_t bad = block_values(values, numbers, count, mapping->instead, &mapping->file->info);
    *(mapping->done ? &mapping->bad : &mapping->bad_background) += bad;
    mapping->done += count;
    for (size_t i = 0; i < count && mapping->width < sizeof *values; i++) {
        size_t code = mapping->width == 1 ? stored[i] : order_u16(stored + 2 * i, mapping->file->swapped);
        if (mapping->width == 1) {
            ((uint8_t *)codes)[i] = (uint8_t)code;
        } else {
            ((uint16_t *)codes)[i] = (uint16_t)code;
        }
        mapping->most = code > mapping->most ? code : mapping->most;
    }
    if (mapping->width == sizeof *values) {
        memcpy(codes, values, count * sizeof *values);
    }
}

/* The value of each code up to the highest. */
static void make_table(struct job *job, struct value_map *map, const struct mapping *mapping)
{
    conus_volume_info info = mapping->file->info; /* its range comes from the voxels, not from the table */
    map->table_count = mapping->most + 1;
    map->table = memory_raw(map->table_count, sizeof *map->table);
    const size_t count = job_need(job, map->table) ? map->table_count : 0;
    for (size_t code = 0; code < count; code++) {
        const uint8_t narrow = (uint8_t)code;
        const uint16_t wide = (uint16_t)code;
        double number;
        mapping->decoder->doubles(&number, map->width == 1 ? &narrow : (const uint8_t *)&wide, 1, false);
        block_values(&map->table[code], &number, 1, mapping->instead, &info);
    }
}

static void read_map(struct job *job, struct value_map *out, struct volume_file *file, double instead)
{
    struct value_map map = {0};
    if (!job_step(job)) { /* there may be no file */
        return;
    }
    size_t size = volume_datatype_size(file->datatype);
    size_t count = values_count_voxels(file);
    size_t width = size < sizeof(float) ? size : sizeof(float);
    struct mapping mapping = {
        .file = file, .decoder = find_decoder(file->datatype), .width = width, .instead = instead};
    file->info.minimum = INFINITY;
    file->info.maximum = -INFINITY;
    if (JOB_CALL(job, value_map_init(&map, file->voxels.data, size, count, width, code_run, &mapping)) &&
        width < sizeof(float)) {
        make_table(job, &map, &mapping);
    }
    note_bad(job, file, mapping.bad + mapping.bad_background * (count + 1 - mapping.done), instead);
    check_finite(job, file, instead);
    if (job_ok(job)) {
        *out = map;
    } else {
        value_map_finish(&map);
    }
}

void volume_map(struct job *job, struct value_map *out, struct volume_file *file)
{
    read_map(job, out, file, 0);
}

void volume_map_or_nan(struct job *job, struct value_map *out, struct volume_file *file)
{
    read_map(job, out, file, NAN);
}
