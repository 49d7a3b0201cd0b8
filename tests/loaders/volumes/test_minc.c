/* SPDX-License-Identifier: BSD-3-Clause */
/* MINC 2 as conus-hdf5 gives it, against the closed form of its placement and its scales, and files with one wrong
 * value each. */
#include "loaders/volumes/parts.h"

#include "base/memory.h"
#include "builders/hdf5_builder.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A volume of 2 slices along y, each of 1 x 3 voxels; "" or 0 leaves a value as it is in `plain`. */
struct bent {
    const char *order; /* order of the image's dimensions */
    const char *limits_order;
    const char *missing; /* an object or attribute that is left out: "yspace", "yspace step" */
    const char *key;     /* an attribute of xspace */
    const char *words;   /* its text, */
    double numbers[3];   /* or its numbers, */
    size_t count;        /* so many */
    double range[2];
    double low[2], high[2];
    uint64_t high_count;
    uint32_t image_class;
};

static bool lacks(const struct bent *bent, const char *object, const char *attribute)
{
    char name[64];
    snprintf(name, sizeof name, "%s%s%s", object, *attribute ? " " : "", attribute);
    return bent->missing && strcmp(bent->missing, name) == 0;
}

static void put_attribute(struct hdf5_builder *builder, const struct bent *bent, const char *object, const char *name,
                          const double *values, size_t count)
{
    bool is_bent = bent->key && strcmp(object, "xspace") == 0 && strcmp(bent->key, name) == 0;
    if (!lacks(bent, object, name) && !is_bent) {
        hdf5_doubles(builder, HDF5_FRAME_ATTRIBUTE, name, values, count);
    }
}

static void put_dimension(struct hdf5_builder *builder, const struct bent *bent, const char *name, double start,
                          double step, const double cosines[3], double length)
{
    char path[64];
    static const char *const spacing = "regular__";
    snprintf(path, sizeof path, "/minc-2.0/dimensions/%s", name);
    hdf5_group(builder, path);
    put_attribute(builder, bent, name, "start", &start, 1);
    put_attribute(builder, bent, name, "step", &step, 1);
    put_attribute(builder, bent, name, "length", &length, 1);
    put_attribute(builder, bent, name, "direction_cosines", cosines, 3);
    if (strcmp(name, "xspace") != 0 || !bent->key) {
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "spacing", &spacing, 1);
    } else if (bent->words) {
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, bent->key, &bent->words, 1);
    } else {
        hdf5_doubles(builder, HDF5_FRAME_ATTRIBUTE, bent->key, bent->numbers, bent->count);
    }
}

static const int16_t stored[] = {0, 1, 2, 100, 50, 101};
static const double c = 0.8, s = 0.6;

/* Stored values 0 to 100 are 0 to 10 in slice 0 and 0 to 200 in slice 1; 101 is invalid. */
static void build(struct hdf5_builder *builder, const struct bent *bent)
{
    const double high[] = {bent->high_count ? bent->high[0] : 10, bent->high_count ? bent->high[1] : 200};
    const double range[] = {bent->range[1] != 0 ? bent->range[0] : 0, bent->range[1] != 0 ? bent->range[1] : 100};
    const char *order = bent->order ? bent->order : "yspace,zspace,xspace";
    const char *limits_order = bent->limits_order ? bent->limits_order : "yspace";
    hdf5_begin(builder);
    put_dimension(builder, bent, "xspace", 5, 2, (const double[]){c, s, 0}, 3);
    if (!lacks(bent, "yspace", "")) {
        put_dimension(builder, bent, "yspace", -7, -3, (const double[]){-s, c, 0}, 2);
    }
    put_dimension(builder, bent, "zspace", 11, 4, (const double[]){0, 0, 1}, 1);
    if (!lacks(bent, "image", "")) {
        const enum hdf5_class class = bent->image_class ? (enum hdf5_class)bent->image_class : HDF5_SIGNED;
        hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_OBJECT,
                                                 .class = class,
                                                 .size = class == HDF5_OTHER ? 0 : 2,
                                                 .rank = 3,
                                                 .dims = {2, 1, 3},
                                                 .address = 90,
                                                 .name = "/minc-2.0/image/0/image",
                                                 .data = class == HDF5_OTHER ? NULL : stored,
                                                 .data_size = class == HDF5_OTHER ? 0 : sizeof stored});
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "dimorder", &order, 1);
        put_attribute(builder, bent, "image", "valid_range", range, 2);
    }
    hdf5_doubles(builder, HDF5_FRAME_OBJECT, "/minc-2.0/image/0/image-min", bent->low, 2);
    hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "dimorder", &limits_order, 1);
    if (!lacks(bent, "image-max", "")) {
        hdf5_doubles(builder, HDF5_FRAME_OBJECT, "/minc-2.0/image/0/image-max", high,
                     bent->high_count ? (size_t)bent->high_count : 2);
    }
    hdf5_end(builder);
}

struct opened {
    struct job job;
    struct volume_input v;
};

/* The job's status is how it went. */
static void open_built(struct opened *out, const struct hdf5_builder *builder)
{
    *out = (struct opened){.v.header.info.slope = 1};
    const struct text stream = {job_adopt(&out->job, memory_copy(builder->bytes.data, builder->bytes.size, 1)),
                                builder->bytes.size};
    if (job_need(&out->job, stream.data)) {
        minc_from_hdf5(&out->job, &out->v, hdf5_of_stream(&out->job, stream));
    }
}

static void open_ok(struct opened *out, const struct hdf5_builder *builder)
{
    open_built(out, builder);
    assert_int_equal(out->job.status, CONUS_OK);
}

struct gathered {
    uint8_t bytes[64];
    size_t size, each;
};

static void gather(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count)
{
    struct gathered *gathered = user;
    assert_int_equal(job->status, CONUS_OK);
    assert_int_equal(first * gathered->each, gathered->size);
    assert_true(count * gathered->each <= sizeof gathered->bytes - gathered->size);
    memcpy(gathered->bytes + gathered->size, voxels, count * gathered->each);
    gathered->size += count * gathered->each;
}

static void read_all(struct gathered *out, struct opened *opened)
{
    *out = (struct gathered){.each = volume_datatype_size(opened->v.header.datatype)};
    opened->v.read(&opened->job, &opened->v, 0, 1, &(struct voxel_sink){gather, out});
    assert_int_equal(opened->job.status, CONUS_OK);
}

/* i is x, j is z, k is y: the order in which the image has them. The start counts along the cosines. */
static void place_and_scales(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct opened opened;
    struct gathered gathered;
    build(&builder, &(struct bent){0});
    open_ok(&opened, &builder);
    const double wanted[16] = {2 * c,         2 * s,         0,  0, 0, 0, 4, 0, 3 * s, -3 * c, 0, 0,
                               5 * c + 7 * s, 5 * s - 7 * c, 11, 1};
    for (size_t i = 0; i < 16; i++) {
        assert_near(opened.v.header.info.world_from_voxel[i], wanted[i], 1e-12);
    }
    assert_int_equal(opened.v.header.info.dim[0], 3);
    assert_int_equal(opened.v.header.info.dim[1], 1);
    assert_int_equal(opened.v.header.info.dim[2], 2);
    assert_int_equal(opened.v.header.datatype, VOLUME_FLOAT64);
    assert_int_equal(opened.v.header.info.volume_count, 1);
    read_all(&gathered, &opened);
    double values[6];
    assert_int_equal(gathered.size, sizeof values);
    memcpy(values, gathered.bytes, sizeof values);
    static const double real[] = {0, 0.1, 0.2, 200, 100};
    for (size_t i = 0; i < 5; i++) {
        assert_near(values[i], real[i], 1e-12);
    }
    assert_true(isnan(values[5]));
    job_end(&opened.job);
    buffer_finish(&builder.bytes);
}

/* Voxels are not converted if the scale is the identity and every stored value is valid. */
static void plain_voxels(void **state)
{
    (void)state;
    const struct bent plain = {
        .missing = "image valid_range", .low = {-32768, -32768}, .high = {32767, 32767}, .high_count = 2};
    struct hdf5_builder builder;
    struct opened opened;
    struct gathered gathered;
    build(&builder, &plain);
    open_ok(&opened, &builder);
    assert_int_equal(opened.v.header.datatype, VOLUME_INT16);
    read_all(&gathered, &opened);
    assert_int_equal(gathered.size, sizeof stored);
    assert_memory_equal(gathered.bytes, stored, sizeof stored);
    job_end(&opened.job);
    buffer_finish(&builder.bytes);
}

/* A scale that is the identity does not make all stored values valid. */
static void plain_scale_of_a_part(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct opened opened;
    struct gathered gathered;
    build(&builder, &(struct bent){.high = {100, 100}, .high_count = 2});
    open_ok(&opened, &builder);
    read_all(&gathered, &opened);
    double values[6];
    assert_int_equal(gathered.size, sizeof values);
    memcpy(values, gathered.bytes, sizeof values);
    assert_near(values[3], 100, 0);
    assert_true(isnan(values[5]));
    job_end(&opened.job);
    buffer_finish(&builder.bytes);
}

/* A slice of one value has an empty range of real values, whatever is stored. */
static void constant_slices(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    struct opened opened;
    struct gathered gathered;
    build(&builder, &(struct bent){.high = {0, 200}, .high_count = 2});
    open_ok(&opened, &builder);
    read_all(&gathered, &opened);
    double values[6];
    memcpy(values, gathered.bytes, sizeof values);
    assert_near(values[1], 0, 0);
    assert_near(values[3], 200, 1e-12);
    job_end(&opened.job);
    buffer_finish(&builder.bytes);
}

static void what_is_refused(void **state)
{
    (void)state;
    static const struct {
        struct bent bent;
        conus_status status;
        const char *part;
    } cases[] = {
        {{.missing = "image"}, CONUS_ERROR_DATA, "HDF5, but no volume of MINC"},
        {{.image_class = HDF5_OTHER}, CONUS_ERROR_UNSUPPORTED, "one number for each voxel"},
        {{.order = "zspace,xspace"}, CONUS_ERROR_DATA, "zspace: length: found 1, the image has 2"},
        {{.order = "yspace,zspace"}, CONUS_ERROR_DATA, "found 2 names for 3 dimensions"},
        {{.order = "yspace,zspace,xspace,time"}, CONUS_ERROR_UNSUPPORTED, "found time of 0"},
        {{.order = "yspace,zspace,yspace"}, CONUS_ERROR_DATA, "yspace: needed is one of"},
        {{.order = "yspace,zspace,vector_dimension"}, CONUS_ERROR_UNSUPPORTED, "found vector_dimension of 3"},
        {{.order = "time,zspace,xspace"}, CONUS_ERROR_UNSUPPORTED, "found time of 2"},
        {{.missing = "yspace"}, CONUS_ERROR_DATA, "yspace: needed is one of"},
        {{.missing = "yspace step"}, CONUS_ERROR_DATA, "yspace: start and step"},
        {{.missing = "yspace start"}, CONUS_ERROR_DATA, "yspace: start and step"},
        {{.key = "start", .numbers = {1, 2}, .count = 2}, CONUS_ERROR_DATA, "xspace: start and step"},
        {{.key = "start", .words = "1"}, CONUS_ERROR_DATA, "xspace: start and step"},
        {{.key = "step", .numbers = {NAN}, .count = 1}, CONUS_ERROR_DATA, "xspace: start and step"},
        {{.key = "step", .numbers = {0}, .count = 1}, CONUS_ERROR_DATA, "start, step and direction_cosines"},
        {{.key = "length", .numbers = {4}, .count = 1}, CONUS_ERROR_DATA, "xspace: length: found 4, the image has 3"},
        {{.key = "direction_cosines", .numbers = {1, 1, 0}, .count = 3}, CONUS_ERROR_DATA, "xspace: direction_cosines"},
        {{.key = "direction_cosines", .numbers = {1, 0}, .count = 2}, CONUS_ERROR_DATA, "xspace: direction_cosines"},
        {{.key = "direction_cosines", .numbers = {0, 0, 1}, .count = 3}, CONUS_ERROR_DATA, "direction_cosines"},
        {{.key = "spacing", .words = "irregular"}, CONUS_ERROR_UNSUPPORTED, "spacing: found \"irregular\""},
        {{.key = "units", .words = "m"}, CONUS_ERROR_UNSUPPORTED, "units: found \"m\", allowed is \"mm\""},
        {{.key = "alignment", .words = "start_"}, CONUS_ERROR_UNSUPPORTED, "alignment: found \"start_\""},
        {{.range = {0, 40000}}, CONUS_ERROR_DATA, "valid_range: two numbers from -32768 to 32767"},
        {{.range = {3, 2}}, CONUS_ERROR_DATA, "valid_range: two numbers"},
        {{.range = {NAN, 2}}, CONUS_ERROR_DATA, "valid_range: two numbers"},
        {{.range = {3, 3}}, CONUS_ERROR_DATA, "slice 0: image-min 0 and image-max 10 are no scale of 3 to 3"},
        {{.high = {INFINITY, 1}, .high_count = 2}, CONUS_ERROR_DATA, "slice 0: image-min 0 and image-max inf"},
        {{.high_count = 1}, CONUS_ERROR_DATA, "image-min and image-max: found 2 and 1 numbers"},
        {{.limits_order = "zspace"}, CONUS_ERROR_DATA, "image-min: a number is needed"},
        {{.missing = "image-max"}, CONUS_ERROR_DATA, "image-max: a number is needed"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct hdf5_builder builder;
        struct opened opened;
        build(&builder, &cases[i].bent);
        open_built(&opened, &builder);
        test_status(job_close(&opened.job, NULL, NULL), cases[i].status, cases[i].part, __FILE__, __LINE__);
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("case %zu: \"%s\" does not say \"%s\"", i, conus_message(), cases[i].part);
        }
        buffer_finish(&builder.bytes);
    }
}

static conus_status read_built(void *builder)
{
    struct opened opened;
    open_built(&opened, builder);
    return job_close(&opened.job, NULL, NULL);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    build(&builder, &(struct bent){0});
    test_every_allocation(read_built, &builder);
    buffer_finish(&builder.bytes);
}

TEST_GROUP(minc)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(place_and_scales),      cmocka_unit_test(plain_voxels),
        cmocka_unit_test(plain_scale_of_a_part), cmocka_unit_test(constant_slices),
        cmocka_unit_test(what_is_refused),       cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
