/* SPDX-License-Identifier: BSD-3-Clause */
/* Atlases from arrays: they equal those of files with the same numbers; values out of range are refused. */
#include "test.h"

#include "base/geometry/math3.h"
#include "conus/own.h"

#include <math.h>
#include <string.h>

enum { NX = 5, NY = 4, NZ = 3, COUNT = NX * NY * NZ };

/* Voxels of 2 mm whose first lies at (-4, -3, -2); x of the world grows with i. */
static const double placed[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -4, -3, -2, 1};

/* Label of a voxel: a plate of 7 at i = 2 behind a plate of 300 at i = 1, else background. */
static uint32_t label_at(size_t i)
{
    return i == 1 ? 300 : i == 2 ? 7 : 0;
}

/* The pattern as uint16, i fastest. */
static void fill_labels(uint16_t out[COUNT])
{
    for (size_t n = 0; n < COUNT; n++) {
        out[n] = (uint16_t)label_at(n % NX);
    }
}

static conus_voxels voxels_of(const void *data, conus_scalar type)
{
    conus_voxels voxels = CONUS_VOXELS_INIT;
    voxels.data = data;
    voxels.type = type;
    voxels.dim[0] = NX;
    voxels.dim[1] = NY;
    voxels.dim[2] = NZ;
    memcpy(voxels.world_from_voxel, placed, sizeof placed);
    return voxels;
}

/* Label of the first hit of a thin cone along +x through the middle; 0 = none. */
static uint32_t label_ahead(const conus_atlas *atlas, double x)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    assert_int_equal(conus_selector_create(&selector, atlas, NULL), CONUS_OK);
    assert_int_equal(conus_pose_along(&pose, (double[]){x, 0.1, 0.1}, (double[]){1, 0, 0}, NULL), CONUS_OK);
    assert_int_equal(conus_select(&selection, selector, &pose, degrees_from_radians(0.01)), CONUS_OK);
    const conus_result *best = conus_selection_result(selection, 0);
    uint32_t label = best->object ? conus_atlas_object(atlas, best->object)->label : 0;
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return label;
}

/* By the pattern: from x = -50 the plate of 300 comes first; from inside the plate of 7 that one; behind it nothing. */
static void check_plates(const conus_atlas *atlas)
{
    assert_int_equal(label_ahead(atlas, -50), 300);
    assert_int_equal(label_ahead(atlas, 0), 7);
    assert_int_equal(label_ahead(atlas, 2), 0);
}

static void plates_from_names(void **state)
{
    (void)state;
    uint16_t data[COUNT];
    const conus_label labels[] = {
        {.number = 300, .name = "Far", .abbreviation = "F", .hemisphere = 'R', .parent = 9},
        {.number = 7, .name = "Near", .has_rgb = true, .rgb = {1, 2, 3}},
        {.number = 9, .name = "Both"},
    };
    conus_atlas *atlas = NULL;
    fill_labels(data);
    conus_voxels voxels = voxels_of(data, CONUS_SCALAR_UINT16);
    voxels.name = "plates";
    voxels.space_code = 4;
    assert_int_equal(conus_atlas_create(&atlas, &voxels, labels, 3, NULL), CONUS_OK);
    assert_int_equal(conus_atlas_object_count(atlas), 3); /* 7, 9 and 300: by label */
    const conus_object *near = conus_atlas_object(atlas, 1), *far = conus_atlas_object(atlas, 3);
    assert_string_equal(near->name, "Near");
    assert_int_equal(near->voxels, NY * NZ);
    assert_true(near->volume_mm3 == 8.0 * NY * NZ); /* voxels of 2 x 2 x 2 mm */
    assert_int_equal(near->rgb[2], 3);
    assert_string_equal(far->abbreviation, "F");
    assert_int_equal(far->hemisphere, 'R');
    assert_int_equal(far->parent, 2);
    assert_string_equal(conus_atlas_volume(atlas, 0)->path, "plates");
    assert_string_equal(conus_atlas_volume(atlas, 0)->orientation, "RAS");
    assert_int_equal(conus_atlas_volume(atlas, 0)->space_code, 4);
    assert_non_null(strstr(conus_atlas_volume(atlas, 0)->transform, "code 4 (MNI 152)"));
    check_plates(atlas);
    conus_atlas_destroy(atlas);
}

#define STORE(type)                                                                                                    \
    do {                                                                                                               \
        const type number = (type)value;                                                                               \
        memcpy(at, &number, sizeof number);                                                                            \
    } while (0)

static void store(uint8_t *at, conus_scalar type, uint32_t value)
{
    switch (type) {
    case CONUS_SCALAR_UINT8:
        STORE(uint8_t);
        break;
    case CONUS_SCALAR_INT8:
        STORE(int8_t);
        break;
    case CONUS_SCALAR_UINT16:
        STORE(uint16_t);
        break;
    case CONUS_SCALAR_INT16:
        STORE(int16_t);
        break;
    case CONUS_SCALAR_UINT32:
        STORE(uint32_t);
        break;
    case CONUS_SCALAR_INT32:
        STORE(int32_t);
        break;
    case CONUS_SCALAR_UINT64:
        STORE(uint64_t);
        break;
    case CONUS_SCALAR_INT64:
        STORE(int64_t);
        break;
    case CONUS_SCALAR_FLOAT32:
        STORE(float);
        break;
    case CONUS_SCALAR_FLOAT64:
        STORE(double);
        break;
    }
}

static const size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

/* The label that fits: 300 becomes 100 in a byte. */
static uint32_t fitting(conus_scalar type, uint32_t label)
{
    return sizes[type] == 1 && label == 300 ? 100 : label;
}

/* An array with its own strides, in a block of bytes that may be unaligned. */
struct layout {
    ptrdiff_t stride[3];
    size_t first; /* byte of voxel (0, 0, 0) */
};

static void reverse(uint8_t *bytes, size_t size)
{
    for (size_t b = 0; b < size / 2; b++) {
        uint8_t byte = bytes[b];
        bytes[b] = bytes[size - 1 - b];
        bytes[size - 1 - b] = byte;
    }
}

static void check_layout(conus_scalar type, const struct layout *layout, bool swapped)
{
    uint8_t block[8 * 2 * 7 * COUNT] = {0};
    conus_atlas *atlas = NULL;
    for (size_t n = 0; n < COUNT; n++) {
        ptrdiff_t i = (ptrdiff_t)(n % NX), j = (ptrdiff_t)(n / NX % NY), k = (ptrdiff_t)(n / NX / NY);
        uint8_t *at = block + layout->first + i * layout->stride[0] + j * layout->stride[1] + k * layout->stride[2];
        store(at, type, fitting(type, label_at((size_t)i)));
        if (swapped) {
            reverse(at, sizes[type]);
        }
    }
    conus_voxels voxels = voxels_of(block + layout->first, type);
    voxels.swapped = swapped;
    memcpy(voxels.stride, layout->stride, sizeof voxels.stride);
    assert_int_equal(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL), CONUS_OK);
    assert_int_equal(label_ahead(atlas, -50), fitting(type, 300));
    assert_int_equal(label_ahead(atlas, 0), 7);
    assert_int_equal(label_ahead(atlas, 2), 0);
    conus_atlas_destroy(atlas);
}

static void every_type_and_layout(void **state)
{
    (void)state;
    for (conus_scalar type = CONUS_SCALAR_UINT8; type <= CONUS_SCALAR_FLOAT64; type++) {
        ptrdiff_t s = (ptrdiff_t)sizes[type];
        const struct layout layouts[] = {
            {{s, s * NX, s * NX * NY}, 0},                          /* i fastest */
            {{s, s * NX, s * NX * NY}, 1},                          /* not aligned */
            {{s * NY * NZ, s * NZ, s}, 0},                          /* k fastest, as numpy has it */
            {{-s, -s * NX, -s * NX * NY}, (size_t)s * (COUNT - 1)}, /* backwards */
            {{2 * s, 2 * s * NX + s, 7 * s * NX * NY}, 0},          /* with gaps */
        };
        for (size_t n = 0; n < sizeof layouts / sizeof *layouts; n++) {
            check_layout(type, &layouts[n], false);
            check_layout(type, &layouts[n], true);
        }
    }
}

static void refuse(const conus_voxels *voxels, const conus_label *labels, size_t count, conus_status status,
                   const char *words)
{
    conus_atlas *atlas = NULL;
    assert_int_equal(conus_atlas_create(&atlas, voxels, labels, count, NULL), status);
    assert_null(atlas);
    assert_non_null(strstr(conus_message(), words));
}

static void what_is_out_of_range(void **state)
{
    (void)state;
    uint16_t data[COUNT];
    double numbers[COUNT] = {0};
    fill_labels(data);
    const conus_voxels good = voxels_of(data, CONUS_SCALAR_UINT16);
    conus_voxels bad = good;
    bad.data = NULL;
    refuse(&bad, NULL, 0, CONUS_ERROR_ARGUMENT, "data: NULL");
    /* One more than the table holds; only the count is read. */
    refuse(&good, &(conus_label){.number = 1}, ((size_t)1 << 20) + 1, CONUS_ERROR_ARGUMENT, "labels: 1048577");
    bad = good;
    bad.type = 0;
    refuse(&bad, NULL, 0, CONUS_ERROR_ARGUMENT, "type: 0");
    bad.type = 11;
    refuse(&bad, NULL, 0, CONUS_ERROR_ARGUMENT, "type: 11");
    bad = good;
    bad.dim[1] = 0;
    refuse(&bad, NULL, 0, CONUS_ERROR_ARGUMENT, "5 x 0 x 3");
    bad.dim[1] = (size_t)1 << 40;
    refuse(&bad, NULL, 0, CONUS_ERROR_ARGUMENT, "each is 1 to");
    bad = good;
    memset(bad.world_from_voxel, 0, sizeof bad.world_from_voxel);
    refuse(&bad, NULL, 0, CONUS_ERROR_DATA, "world_from_voxel");
    bad = good;
    bad.world_from_voxel[12] = NAN;
    refuse(&bad, NULL, 0, CONUS_ERROR_DATA, "not finite");
    bad = good;
    bad.world_from_voxel[0] = 1e-310;
    refuse(&bad, NULL, 0, CONUS_ERROR_DATA, "a step along axis 0 is");
    float singles[COUNT] = {[7] = 182305696};
    bad = voxels_of(singles, CONUS_SCALAR_FLOAT32);
    refuse(&bad, (conus_label[]){{.number = 182305693, .name = "VISp1"}}, 1, CONUS_ERROR_DATA,
           "array: the label 182305693, \"VISp1\", is 182305696 as float32");
    bad = voxels_of(numbers, CONUS_SCALAR_FLOAT64);
    bad.name = "mine";
    numbers[1 + NX * (2 + NY * 1)] = 1.5;
    refuse(&bad, NULL, 0, CONUS_ERROR_DATA, "mine: voxel (1, 2, 1): found 1.5");
    numbers[1 + NX * (2 + NY * 1)] = NAN;
    refuse(&bad, NULL, 0, CONUS_ERROR_DATA, "mine: voxel (1, 2, 1): found nan");
    refuse(&good, (conus_label[]){{.name = "nobody"}}, 1, CONUS_ERROR_ARGUMENT, "0 is background");
    refuse(&good, (conus_label[]){{.number = 7, .hemisphere = 'X'}}, 1, CONUS_ERROR_ARGUMENT, "hemisphere of label 7");
    refuse(&good, NULL, 1, CONUS_ERROR_ARGUMENT, "labels: NULL");
    refuse(NULL, (conus_label[]){{.number = 7}}, 1, CONUS_ERROR_ARGUMENT, "labels without voxels");
}

/* A ramp with noise, which the loader of files takes for an image; labels_anyway accepts it. */
static void an_image_is_no_atlas(void **state)
{
    (void)state;
    enum { EDGE = 24 };
    static uint16_t grey[EDGE * EDGE * EDGE];
    conus_atlas *atlas = NULL;
    unsigned seed = 1;
    for (size_t n = 0; n < sizeof grey / sizeof *grey; n++) {
        seed = seed * 1103515245 + 12345;
        grey[n] = (uint16_t)(100 + 20 * (n % EDGE) + 3 * (n / EDGE % EDGE) + (seed >> 16) % 16);
    }
    conus_voxels voxels = voxels_of(grey, CONUS_SCALAR_UINT16);
    voxels.dim[0] = voxels.dim[1] = voxels.dim[2] = EDGE;
    refuse(&voxels, NULL, 0, CONUS_ERROR_DATA, "looks like an image");
    const conus_create_options anyway = {.labels_anyway = true};
    assert_int_equal(conus_atlas_create(&atlas, &voxels, NULL, 0, &anyway), CONUS_OK);
    conus_atlas_destroy(atlas);
}

/* A tetrahedron with corners at the origin and 6 mm along each axis: 36 mm^3. */
static const float corners[12] = {0, 0, 0, 6, 0, 0, 0, 6, 0, 0, 0, 6};
static const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

static void surfaces(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_int_equal(conus_atlas_create(&atlas, NULL, NULL, 0, NULL), CONUS_OK);
    assert_int_equal(conus_atlas_object_count(atlas), 0);
    const conus_label area = {.number = 5, .name = "Corner"};
    assert_int_equal(conus_atlas_add_surface(atlas, &area, corners, 4, faces, 4), CONUS_OK);
    const conus_object *object = conus_atlas_object(atlas, 1);
    assert_string_equal(object->name, "Corner");
    assert_true(object->closed);
    assert_true(fabs(object->volume_mm3 - 36) < 1e-9);
    assert_int_equal(label_ahead(atlas, -50), 5);
    assert_int_equal(conus_atlas_add_surface(atlas, &area, corners, 4, faces, 4), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "5 is that of another area"));
    const conus_label orphan = {.number = 6, .parent = 99};
    assert_int_equal(conus_atlas_add_surface(atlas, &orphan, corners, 4, faces, 4), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "no area has the number 99"));
    const conus_label child = {.number = 6, .name = "Part", .parent = 5};
    assert_int_equal(conus_atlas_add_surface(atlas, &child, corners, 3, faces, 4), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "Part"));
    assert_int_equal(conus_atlas_add_surface(atlas, &child, NULL, 4, faces, 4), CONUS_ERROR_ARGUMENT);
    assert_int_equal(conus_atlas_add_surface(atlas, &child, corners, 4, faces, 0), CONUS_ERROR_DATA);
    const float beyond[12] = {NAN};
    assert_int_equal(conus_atlas_add_surface(atlas, &child, beyond, 4, faces, 4), CONUS_ERROR_DATA);
    assert_int_equal(conus_atlas_object_count(atlas), 1);
    assert_int_equal(conus_atlas_note_count(atlas), 0);
    assert_int_equal(conus_atlas_add_surface(atlas, &child, corners, 4, faces, 4), CONUS_OK);
    assert_int_equal(conus_atlas_object(atlas, 2)->parent, 1);
    assert_int_equal(conus_atlas_add_surface(atlas, &(conus_label){.number = 8}, corners, 4, faces, 3), CONUS_OK);
    assert_false(conus_atlas_object(atlas, 3)->closed);
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "8");
    conus_atlas_destroy(atlas);
}

/* Area k lies in area k - 1; the 65th has 64 areas above it. */
static void surfaces_lie_no_deeper_than_allowed(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_int_equal(conus_atlas_create(&atlas, NULL, NULL, 0, NULL), CONUS_OK);
    for (uint32_t k = 1; k <= 66; k++) {
        const conus_label area = {.number = k, .name = "Part", .parent = k - 1};
        conus_status status = conus_atlas_add_surface(atlas, &area, corners, 4, faces, 4);
        assert_int_equal(status, k <= 65 ? CONUS_OK : CONUS_ERROR_ARGUMENT);
    }
    assert_non_null(strstr(conus_message(), "number 65 has 64 areas above it, and no more are allowed"));
    conus_atlas_destroy(atlas);
}

static void scalar_maps(void **state)
{
    (void)state;
    float map[COUNT];
    conus_atlas *atlas = NULL;
    for (size_t n = 0; n < COUNT; n++) {
        map[n] = n % NX == 3 ? 0.8F : 0.1F;
    }
    conus_voxels voxels = voxels_of(map, CONUS_SCALAR_FLOAT32);
    voxels.name = "tract";
    assert_int_equal(conus_atlas_create(&atlas, NULL, NULL, 0, NULL), CONUS_OK);
    assert_int_equal(conus_atlas_add_pathway_voxels(atlas, &voxels, NULL), CONUS_OK);
    const conus_object *object = conus_atlas_object(atlas, 1);
    assert_int_equal(object->kind, CONUS_KIND_PATHWAY);
    assert_string_equal(object->name, "tract");
    assert_int_equal(object->voxels, NY * NZ); /* 0.8 is above a quarter of 1 */
    const conus_pathway_options low = {.threshold = 0.05, .name = "all"};
    assert_int_equal(conus_atlas_add_pathway_voxels(atlas, &voxels, &low), CONUS_OK);
    assert_int_equal(conus_atlas_object(atlas, 2)->voxels, COUNT);
    assert_string_equal(conus_atlas_object(atlas, 2)->name, "all");
    const conus_pathway_options high = {.threshold = 0.9};
    size_t notes = conus_atlas_note_count(atlas);
    assert_int_equal(conus_atlas_add_pathway_voxels(atlas, &voxels, &high), CONUS_ERROR_ARGUMENT);
    assert_int_equal(conus_atlas_object_count(atlas), 2);
    assert_int_equal(conus_atlas_note_count(atlas), notes);
    assert_int_equal(conus_atlas_set_context_voxels(atlas, &voxels, NULL), CONUS_OK);
    assert_int_equal(conus_atlas_volume_count(atlas), 3);
    /* The middle of voxel (3, 1, 1). */
    assert_true(fabs(conus_atlas_value(atlas, 2, (double[]){2, -1, 0}) - 0.8) < 1e-6);
    const conus_context_options block = {.block_threshold = 2};
    assert_int_equal(conus_atlas_set_context_voxels(atlas, &voxels, &block), CONUS_ERROR_ARGUMENT);
    assert_int_equal(conus_atlas_add_surface(atlas, &(conus_label){.number = 1}, corners, 4, faces, 4),
                     CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "before pathways"));
    conus_atlas_destroy(atlas);
}

/* A last row of 0 0 1 1 is a perspective, 0 0 0 2 a scale: neither may be taken for 0 0 0 1, wherever a matrix is
 * given. */
static void matrices_are_affine(void **state)
{
    (void)state;
    static const struct {
        size_t at;
        double value;
        const char *said;
    } cases[] = {{11, 1, "last row 0 0 1 1"}, {15, 2, "last row 0 0 0 2"}, {3, NAN, "last row nan 0 0 1"}};
    uint16_t data[COUNT];
    conus_atlas *atlas = NULL;
    conus_atlas *none = NULL;
    conus_roi *roi = NULL;
    fill_labels(data);
    conus_voxels voxels = voxels_of(data, CONUS_SCALAR_UINT16);
    assert_int_equal(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL), CONUS_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        conus_voxels bent = voxels;
        bent.world_from_voxel[cases[i].at] = cases[i].value;
        assert_int_equal(conus_atlas_create(&none, &bent, NULL, 0, NULL), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), cases[i].said));
        assert_int_equal(conus_roi_create(&roi, &bent, NULL), CONUS_ERROR_DATA);
        assert_int_equal(conus_atlas_add_pathway_voxels(atlas, &bent, NULL), CONUS_ERROR_DATA);
        assert_int_equal(conus_atlas_set_context_voxels(atlas, &bent, NULL), CONUS_ERROR_DATA);
        assert_int_equal(conus_atlas_move(atlas, bent.world_from_voxel), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), cases[i].said));
    }
    assert_null(none);
    assert_null(roi);
    check_plates(atlas);
    conus_atlas_destroy(atlas);
}

/* Makes everything above at once. */
static conus_status make_all(void *data_unused)
{
    (void)data_unused;
    uint16_t data[COUNT];
    float map[COUNT];
    conus_atlas *atlas = NULL;
    const conus_label labels[] = {{.number = 300, .name = "Far", .abbreviation = "F", .parent = 7}};
    fill_labels(data);
    for (size_t n = 0; n < COUNT; n++) {
        map[n] = n % 2 ? 1 : NAN;
    }
    conus_voxels voxels = voxels_of(data, CONUS_SCALAR_UINT16), values = voxels_of(map, CONUS_SCALAR_FLOAT32);
    voxels.stride[0] = values.stride[0] = 0; /* one row again and again: not as they are in memory */
    voxels.stride[1] = 2;
    values.stride[1] = 4;
    conus_status status = conus_atlas_create(&atlas, &voxels, labels, 1, NULL);
    status = status ? status
                    : conus_atlas_add_surface(atlas, &(conus_label){.number = 11, .name = "S"}, corners, 4, faces, 3);
    status = status ? status : conus_atlas_add_pathway_voxels(atlas, &values, NULL);
    status = status ? status : conus_atlas_set_context_voxels(atlas, &values, NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    test_every_allocation(make_all, NULL);
    assert_true(test_every_primitive(make_all, NULL) > 5);
}

TEST_GROUP(arrays)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plates_from_names),
        cmocka_unit_test(every_type_and_layout),
        cmocka_unit_test(what_is_out_of_range),
        cmocka_unit_test(an_image_is_no_atlas),
        cmocka_unit_test(surfaces),
        cmocka_unit_test(surfaces_lie_no_deeper_than_allowed),
        cmocka_unit_test(scalar_maps),
        cmocka_unit_test(matrices_are_affine),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
