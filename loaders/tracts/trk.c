/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads TrackVis's streamlines block by block. */
#include "loaders/tracts/tract_formats.h"

#include "base/byte_order.h"
#include "base/formats/packed.h"
#include "base/geometry/math3.h"
#include "base/text.h"

#include <stdio.h>

enum { TRK_HEADER_SIZE = 1000, TRK_NAMES = 10, TRK_NAME_SIZE = 20 };

/* Names of scalars or properties. */
struct trk_names {
    uint32_t count;       /* Numbers per point or per streamline. */
    const uint8_t *names; /* [TRK_NAMES][TRK_NAME_SIZE], in the header. */
};

struct trk_header {
    bool swapped;
    int32_t version;             /* 1 to 3 */
    uint32_t streamline_count;   /* 0 = not stated. */
    struct trk_names scalars;    /* Per point. */
    struct trk_names properties; /* Per streamline. */
    bool has_matrix;             /* The header says where the world is. */
    double world[16];            /* World mm from the coordinates of the file. */
};

/* Offsets of fields (www.trackvis.org, "Track File (.trk) Format"). */
enum {
    DIM = 6,
    VOXEL_SIZE = 12,
    SCALAR_COUNT = 36,
    SCALAR_NAMES = 38,
    PROPERTY_COUNT = 238,
    PROPERTY_NAMES = 240,
    VOX_TO_RAS = 440,
    VOXEL_ORDER = 948,
    STREAMLINE_COUNT = 988,
    VERSION = 992,
    HEADER_SIZE = 996
};

struct order {
    char letters[5]; /* "LPS" */
    int axis[3];     /* of the world, 0 to 2, along which an axis of voxels runs */
    int sign[3];
};

/* How much the length of 1 mm may change on its way into the world. */
static const double length_tolerance = 0.01;

static struct trk_names read_names(struct job *job, const char *field, int16_t count, const uint8_t *names)
{
    if (count < 0) {
        job_bad(job, "%s: found %d, allowed are 0 and more", field, count);
    }
    return (struct trk_names){(uint32_t)count, names};
}

/* The three letters of voxel_order, of either case. */
static struct order read_order(struct job *job, const uint8_t *field)
{
    struct order order = {0};
    static const char letters[] = "LRPAIS";
    unsigned found = 0;
    snprintf(order.letters, sizeof order.letters, "%.4s", field[0] ? (const char *)field : "LPS");
    for (size_t i = 0; i < 3; i++) {
        char letter = order.letters[i];
        char upper = (char)(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
        const char *at = upper ? strchr(letters, upper) : NULL;
        ptrdiff_t place = at ? at - letters : 6; /* axis 3: none */
        order.axis[i] = (int)(place / 2);
        order.sign[i] = place & 1 ? 1 : -1;
        found |= 1U << order.axis[i];
    }
    if (strlen(order.letters) != 3 || found != 7) {
        text_make_plain(order.letters, "");
        job_bad(job, "voxel_order: found \"%s\", needed is one letter of each of LR, PA and IS", order.letters);
    } else if (!field[0]) {
        job_note(job, "voxel_order: not stated, taken as LPS, TrackVis's own");
    }
    return order;
}

/* The rotation, or reflection, that is nearest to @p m, whose columns have length 1: Newton's iteration for the polar
 * decomposition, which squares the error each time. False where there is none. */
static bool nearest_rotation(double m[16])
{
    for (int round = 0; round < 100; round++) {
        double inverse[16];
        double change = 0;
        if (!mat4_invert_affine(inverse, m)) {
            return false;
        }
        for (int column = 0; column < 3; column++) {
            for (int row = 0; row < 3; row++) {
                double mean = 0.5 * (m[4 * column + row] + inverse[4 * row + column]);
                change = fmax(change, fabs(mean - m[4 * column + row]));
                m[4 * column + row] = mean;
            }
        }
        if (change < 1e-14) {
            return true;
        }
    }
    return true;
}

/* Finds the axis of the world along which each axis of voxels runs: that of its largest part, among those not taken
 * yet. */
static bool order_of_matrix(struct order *out, const double matrix[16])
{
    static const char letters[] = "LRPAIS";
    double m[16];
    bool taken[3] = {false};
    mat4_identity(m);
    for (int i = 0; i < 3; i++) {
        if (!vec3_normalise(m + 4 * i, matrix + 4 * i)) {
            return false;
        }
    }
    if (!nearest_rotation(m)) {
        return false;
    }
    *out = (struct order){0};
    for (int i = 0; i < 3; i++) {
        int best = taken[0] ? taken[1] ? 2 : 1 : 0;
        for (int axis = best + 1; axis < 3; axis++) {
            best = !taken[axis] && fabs(m[4 * i + axis]) > fabs(m[4 * i + best]) ? axis : best;
        }
        taken[best] = true;
        out->axis[i] = best;
        out->sign[i] = m[4 * i + best] < 0 ? -1 : 1;
        out->letters[i] = letters[2 * best + (out->sign[i] > 0)];
    }
    return true;
}

/* The matrix vox_to_ras, column-major; false where it is not recorded. */
static bool trk_read_matrix(double out[16], const struct trk_header *header, const uint8_t *data)
{
    for (size_t row = 0; row < 4; row++) {
        for (size_t column = 0; column < 4; column++) {
            out[4 * column + row] = (double)order_f32(data + VOX_TO_RAS + 16 * row + 4 * column, header->swapped);
        }
    }
    bool recorded = header->version >= 2 && (out[15] < 0 || out[15] > 0 || isnan(out[15]));
    if (!recorded) {
        mat4_identity(out);
    }
    return recorded;
}

static void read_sizes(struct job *job, double out[3], const struct trk_header *header, const uint8_t *data)
{
    for (size_t i = 0; i < 3; i++) {
        out[i] = (double)order_f32(data + VOXEL_SIZE + 4 * i, header->swapped);
        if (!(out[i] > 0) || !isfinite(out[i])) {
            job_bad(job, "voxel_size: found %s of axis %zu, allowed is above 0 mm", NUMBER_TEXT(out[i]), i);
        }
    }
}

/* out = voxel indices of the matrix from those of the header: axes that run the other way are turned round. */
static void turn_axes(struct job *job, double out[16], const struct trk_header *header, const struct order *file,
                      const struct order *matrix, const uint8_t *data)
{
    bool any = false;
    mat4_identity(out);
    for (size_t i = 0; i < 3; i++) {
        int16_t dim = order_i16(data + DIM + 2 * i, header->swapped);
        bool turned = file->sign[i] != matrix->sign[i];
        if (file->axis[i] != matrix->axis[i]) {
            job_refuse(job, "voxel_order: found %s, vox_to_ras has %s; an axis may run the other way, not elsewhere",
                       file->letters, matrix->letters);
        } else if (turned && dim < 1) {
            job_bad(job, "dim: found %d of axis %zu, which voxel_order %s turns; allowed are 1 and more", dim, i,
                    file->letters);
        }
        out[5 * i] = turned ? -1 : 1;
        out[12 + i] = turned ? dim - 1 : 0;
        any = any || turned;
    }
    if (any) {
        job_note(job, "voxel_order: %s, vox_to_ras has %s: the axes that differ are turned round", file->letters,
                 matrix->letters);
    }
}

/* 1 mm in the file has to be 1 mm in the world. */
static void check_lengths(struct job *job, const struct trk_header *header, const double sizes[3])
{
    for (int i = 0; i < 3; i++) {
        double length = vec3_length(header->world + 4 * i);
        if (!(fabs(length - 1) <= length_tolerance)) {
            const char *size = NUMBER_TEXT(sizes[i]);
            if (header->has_matrix) {
                job_bad(job, "voxel_size: found %s mm of axis %d, vox_to_ras has %s; needed is the same", size, i,
                        NUMBER_TEXT(sizes[i] * length));
            }
            job_bad(job,
                    "vox_to_ras: not recorded, and voxel_size is %s mm of axis %d; without the matrix only 1 mm is "
                    "allowed",
                    size, i);
        }
    }
}

/* The way of docs/spaces.md: mm to voxels, corner to centre, axes as in the matrix, the matrix. */
static void make_world(struct job *job, struct trk_header *header, const uint8_t *data)
{
    struct order matrix;
    double sizes[3];
    double voxel[16];
    double turn[16];
    double inverse[16];
    double *world = header->world;
    header->has_matrix = trk_read_matrix(world, header, data);
    if (!header->has_matrix) {
        job_warn(job,
                 "vox_to_ras: not recorded, taken as the identity: nothing says where in the world the streamlines "
                 "are");
    } else if (!mat4_settle_last_row(world)) {
        job_bad(job, "vox_to_ras: last row %.9g %.9g %.9g %.9g, 0 0 0 1 is needed", world[3], world[7], world[11],
                world[15]);
    } else if (!mat4_invert_affine(inverse, world)) {
        job_bad(job, "vox_to_ras: is singular or not finite, needed is a matrix with an inverse");
    }
    read_sizes(job, sizes, header, data);
    const struct order file = read_order(job, data + VOXEL_ORDER);
    if (!job_ok(job)) {
        return; /* sizes may be 0 */
    }
    if (!order_of_matrix(&matrix, world)) {
        job_bad(job, "vox_to_ras: has no axes, needed is a matrix with an inverse");
        return;
    }
    turn_axes(job, turn, header, &file, &matrix, data);
    mat4_identity(voxel);
    for (int i = 0; i < 3; i++) {
        voxel[5 * i] = 1 / sizes[i];
        voxel[12 + i] = -0.5;
    }
    mat4_multiply(turn, turn, voxel);
    mat4_multiply(world, world, turn);
    check_lengths(job, header, sizes);
}

/* Parses the TRK_HEADER_SIZE bytes at `data`, in which its names stay. CONUS_ERROR_DATA, CONUS_ERROR_UNSUPPORTED. */
static struct trk_header trk_header_parse(struct job *job, const uint8_t *data)
{
    int32_t size = order_i32(data + HEADER_SIZE, false);
    const bool swapped = size != TRK_HEADER_SIZE;
    if (swapped && order_i32(data + HEADER_SIZE, true) != TRK_HEADER_SIZE) {
        job_bad(job, "hdr_size: found %d, needed is %d in either byte order", size, TRK_HEADER_SIZE);
    }
    int32_t count = order_i32(data + STREAMLINE_COUNT, swapped);
    struct trk_header header = {
        .swapped = swapped, .version = order_i32(data + VERSION, swapped), .streamline_count = (uint32_t)count};
    if (header.version < 1 || header.version > 3) { /* 3 is laid out as 2 */
        job_refuse(job, "version: found %d, allowed are 1 to 3", header.version);
    }
    if (count < 0) {
        job_bad(job, "n_count: found %d, allowed are 0 (not stated) and more", count);
    }
    header.scalars = read_names(job, "n_scalars", order_i16(data + SCALAR_COUNT, swapped), data + SCALAR_NAMES);
    header.properties =
        read_names(job, "n_properties", order_i16(data + PROPERTY_COUNT, swapped), data + PROPERTY_NAMES);
    make_world(job, &header, data);
    return header;
}

struct trk {
    struct job *job;
    struct reader r;
    struct trk_header header;
    struct tract_build *build;
    size_t stride; /* bytes of a point with its scalars */
};

/* A name ends with its first NUL; one of several numbers has their count behind it, as "name\0003". */
static struct text split_name(struct job *job, uint64_t *count, const uint8_t *field, const char *what)
{
    size_t length = strnlen((const char *)field, TRK_NAME_SIZE);
    size_t start = length < TRK_NAME_SIZE ? length + 1 : length;
    size_t end = start + strnlen((const char *)field + start, TRK_NAME_SIZE - start);
    const struct text digits = {(const char *)field + start, end - start};
    bool padded = true;
    for (size_t i = end; i < TRK_NAME_SIZE; i++) {
        padded = padded && !field[i];
    }
    *count = 1;
    if (!padded || (digits.size && !(text_to_uint(digits, INT16_MAX, count) && *count))) {
        job_bad(job, "%s: found other bytes after \"%.*s\", allowed is how many numbers it has", what, (int)length,
                (const char *)field);
    }
    return (struct text){(const char *)field, length};
}

/* Adds the scalars that the header names; numbers without a name are called @p others, which is nibabel's word. */
static void add_names(struct trk *trk, const struct trk_names *names, bool per_point)
{
    const char *what = per_point ? "scalar_name" : "property_name";
    uint64_t left = names->count;
    for (size_t i = 0; job_ok(trk->job) && left && i < TRK_NAMES; i++) {
        uint64_t count = 0;
        const uint8_t *field = names->names + i * TRK_NAME_SIZE;
        if (!field[0]) {
            continue;
        }
        const struct text name = split_name(trk->job, &count, field, what);
        if (count > left) {
            job_bad(trk->job, "%s: the names have more numbers than the %u of %s", what, names->count,
                    per_point ? "n_scalars" : "n_properties");
        }
        tract_build_scalar(trk->build, name, per_point, (uint32_t)count);
        left -= count;
    }
    if (left) {
        struct text others = text_from(per_point ? "scalars" : "properties");
        tract_build_scalar(trk->build, others, per_point, (uint32_t)left);
    }
}

/* Brings @p size bytes to hand; where the file lacks them, the message names the streamline. */
static bool trk_has(struct trk *trk, size_t size, const char *what)
{
    bool has = reader_has(&trk->r, size);
    if (!has) {
        job_bad(trk->job, "streamline %zu (from 0): the file ends within its %s; n_count is %u",
                trk->build->tractogram.streamline_count, what, trk->header.streamline_count);
    }
    return has;
}

static inline void place_points(float *out, const uint8_t *data, size_t count, size_t stride, const double world[16],
                                bool swapped)
{
    for (size_t i = 0; i < count; i++) {
        const uint8_t *at = data + i * stride;
        const double p[3] = {(double)order_f32(at, swapped), (double)order_f32(at + 4, swapped),
                             (double)order_f32(at + 8, swapped)};
        double q[3];
        mat4_point(q, world, p);
        for (size_t a = 0; a < 3; a++) {
            out[3 * i + a] = (float)q[a];
        }
    }
}

/* Takes the scalars of @p count points, or the properties of a streamline, from rows of @p stride bytes. */
static void take_scalars(struct trk *trk, const uint8_t *data, size_t count, size_t stride, bool per_point)
{
    struct tractogram *tractogram = &trk->build->tractogram;
    uint64_t from = per_point ? tractogram->point_count : tractogram->streamline_count;
    for (size_t s = 0; s < tractogram->scalar_count; s++) {
        const struct tract_scalar *scalar = &tractogram->scalars[s];
        if (scalar->per_point != per_point) {
            continue;
        }
        float *out = scalar->values + from * scalar->components;
        for (size_t i = 0; i < count; i++) {
            for (size_t c = 0; c < scalar->components; c++) {
                *out++ = order_f32(data + i * stride + 4 * c, trk->header.swapped);
            }
        }
        data += 4 * (size_t)scalar->components;
    }
}

/* Takes the points that are at hand, at most @p count, and one or more; gives how many, 0 after a failure. */
static size_t take_points(struct trk *trk, size_t count)
{
    struct tractogram *tractogram = &trk->build->tractogram;
    if (!trk_has(trk, trk->stride, "points")) {
        return 0;
    }
    const uint8_t *data = trk->r.at;
    const size_t taken = smaller_of((size_t)(trk->r.end - data) / trk->stride, count);
    if (!tract_build_points(trk->build, taken)) {
        return 0;
    }
    float *out = tractogram->points + 3 * tractogram->point_count;
    if (trk->header.swapped) {
        place_points(out, data, taken, trk->stride, trk->header.world, true);
    } else {
        place_points(out, data, taken, trk->stride, trk->header.world, false);
    }
    take_scalars(trk, data + 12, taken, trk->stride, true);
    tractogram->point_count += taken;
    trk->r.at += taken * trk->stride;
    return taken;
}

/* The streamline that begins at hand, with the number of its points. */
static void trk_take_streamline(struct trk *trk)
{
    struct tract_build *build = trk->build;
    if (!trk_has(trk, 4, "number of points")) {
        return;
    }
    int32_t count = order_i32(trk->r.at, trk->header.swapped);
    const size_t properties = 4 * (size_t)trk->header.properties.count;
    trk->r.at += 4;
    uint64_t most = reader_most(&trk->r) / trk->stride;
    if (count < 0 || (uint64_t)count > most) {
        job_bad(trk->job, "streamline %zu (from 0): found %d points, the file has room for 0 to %llu",
                build->tractogram.streamline_count, count, (unsigned long long)most);
        return;
    }
    size_t taken = 1;
    for (size_t left = (size_t)count; left && taken; left -= taken) {
        taken = take_points(trk, left);
    }
    if (taken && trk_has(trk, properties, "properties") && tract_build_streamline(build)) {
        take_scalars(trk, trk->r.at, 1, properties, false);
        trk->r.at += properties;
        tract_build_end_streamline(build);
    }
}

static void trk_take_all(struct trk *trk, bool is_packed)
{
    const struct tractogram *tractogram = &trk->build->tractogram;
    const uint32_t stated = trk->header.streamline_count;
    const uint64_t bytes = reader_most(&trk->r);
    const uint64_t each = 4 + 4 * (uint64_t)trk->header.properties.count;
    if (stated > bytes / each) {
        job_bad(trk->job, "n_count: found %llu, the file has room for %llu at most", (unsigned long long)stated,
                (unsigned long long)(bytes / each));
        return;
    }
    if (!is_packed) { /* all bytes that are no counts and properties are points */
        tract_build_expect(trk->build, (bytes - stated * each) / trk->stride, stated);
    }
    while (stated ? job_ok(trk->job) && tractogram->streamline_count < stated : reader_has(&trk->r, 1)) {
        trk_take_streamline(trk); /* 0 means unknown: the stream's end ends it */
    }
    if (reader_has(&trk->r, 1)) {
        job_bad(trk->job, "n_count: found %u, the file goes on after that many streamlines", stated);
    }
}

/* False after a failure. */
static bool trk_take_header(struct trk *trk)
{
    if (!reader_has(&trk->r, TRK_HEADER_SIZE)) {
        job_bad(trk->job, "header: found %zu bytes, needed are %d", (size_t)(trk->r.end - trk->r.at), TRK_HEADER_SIZE);
        return false;
    }
    trk->header = trk_header_parse(trk->job, trk->r.at);
    trk->r.at += TRK_HEADER_SIZE;
    trk->stride = 4 * (3 + (size_t)trk->header.scalars.count);
    add_names(trk, &trk->header.scalars, true);
    add_names(trk, &trk->header.properties, false);
    return job_ok(trk->job);
}

void trk_read(struct job *job, struct source *source, struct tract_build *build)
{
    struct trk trk = {.job = job, .r = source_reader(job, source), .build = build};
    struct tractogram *t = &build->tractogram;
    if (!trk_take_header(&trk)) {
        return;
    }
    trk_take_all(&trk, source->is_packed);
    if (!trk.header.streamline_count && t->streamline_count) {
        job_note(job, "n_count: not stated, the file has %zu", t->streamline_count);
    }
    tract_build_end(build);
    bool big = trk.header.swapped == BIG_ENDIAN_IS_SWAPPED;
    snprintf(t->format, sizeof t->format, "TrackVis %d%s%s", trk.header.version, source->is_packed ? ", gzip" : "",
             big ? ", big-endian" : "");
    t->states_mm = trk.header.has_matrix;
}
