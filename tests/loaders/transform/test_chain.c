/* SPDX-License-Identifier: BSD-3-Clause */
/* Composites of ITK and X5, in conus-hdf5's stream: closed forms, and refused files.
 * tests/oracles/compare_composites.py has random ones, in files. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/hdf5_builder.h"
#include "loaders/transform/transform.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define OBJECT HDF5_FRAME_OBJECT

static const char composite[] = "CompositeTransform_double_3_3";
static const char affine[] = "AffineTransform_double_3_3";
static const char field[] = "DisplacementFieldTransform_double_3_3";
static const char spline[] = "BSplineTransform_double_3_3";

static void add_text(struct hdf5_builder *builder, const char *path, const char *text)
{
    hdf5_strings(builder, OBJECT, path, &text, 1);
}

static void add_group(struct hdf5_builder *builder, int number, const char *type)
{
    char path[80];
    snprintf(path, sizeof path, "/TransformGroup/%d", number);
    hdf5_group(builder, path);
    snprintf(path, sizeof path, "/TransformGroup/%d/TransformType", number);
    add_text(builder, path, type);
}

static void add_numbers(struct hdf5_builder *builder, int number, const char *key, const double *numbers, size_t count)
{
    char path[80];
    snprintf(path, sizeof path, "/TransformGroup/%d/%s", number, key);
    hdf5_doubles(builder, OBJECT, path, numbers, count);
}

/* Adds a step with parameters; `old` spells it as ITK 4 did. */
static void add_step(struct hdf5_builder *builder, int number, const char *type, const double *numbers, size_t count,
                     const double *fixed, size_t fixed_count, bool old)
{
    add_group(builder, number, type);
    add_numbers(builder, number, old ? "TranformParameters" : "TransformParameters", numbers, count);
    add_numbers(builder, number, old ? "TranformFixedParameters" : "TransformFixedParameters", fixed, fixed_count);
}

static const double zero[3] = {0};
static const double doubled[12] = {2, 0, 0, 0, 2, 0, 0, 0, 2};
static const double shifted[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 2, 4}; /* in LPS: (-1, -2, 4) in RAS */

/* 2 x 2 x 2 nodes of a 10 mm grid from (0, 0, 0) on in LPS, turned by a quarter about z: i runs along +y, j along -x.
 * In RAS node (i, j, k) is at (10 j, -10 i, 10 k). Node (1, 0, 0) has the vector (-1, 0, 3), the others none. */
static const double turned[18] = {2, 2, 2, 0, 0, 0, 10, 10, 10, 0, -1, 0, 1, 0, 0, 0, 0, 1};
static const double vectors[24] = {0, 0, 0, 1, 0, 3};

static conus_status parse_with(struct transform_chain *chain, const struct hdf5_builder *builder, uint64_t max_memory)
{
    struct job job = {.max_memory = max_memory};
    chain_begin(chain);
    const struct hdf5 *hdf5 = hdf5_of_stream(&job, (struct text){builder->bytes.data, builder->bytes.size});
    (void)(x5_is(hdf5) ? x5_parse : itk_hdf5_parse)(&job, chain, hdf5);
    chain_end(&job, chain);
    if (!job_ok(&job)) {
        transform_chain_finish(chain);
    }
    return job_close(&job, NULL, NULL);
}

/* Ends the file, and asserts that its chain takes `from` to `to`. */
static void check_point(struct hdf5_builder *builder, const double from[3], const double to[3])
{
    struct transform_chain chain;
    double p[3] = {from[0], from[1], from[2]};
    hdf5_end(builder);
    assert_ok(parse_with(&chain, builder, 0));
    for (size_t i = chain.count; i-- > 0;) {
        assert_true(deformation_point(p, &chain.fields[i], p));
    }
    if (!chain.count) {
        mat4_point(p, chain.matrix, p);
    }
    for (int a = 0; a < 3; a++) {
        assert_near(p[a], to[a], 1e-12);
    }
    transform_chain_finish(&chain);
    buffer_finish(&builder->bytes);
}

static void begin(struct hdf5_builder *builder, const char *type)
{
    hdf5_begin(builder);
    hdf5_group(builder, "/");
    add_group(builder, 0, type);
}

/* The last group comes first: (1, 2, 3) + (-1, -2, 4) = (0, 0, 7), then doubled. */
static void points_go_through_the_last_group_first(void **state)
{
    (void)state;
    for (int old = 0; old < 2; old++) {
        struct hdf5_builder builder;
        begin(&builder, composite);
        add_step(&builder, 1, affine, doubled, 12, zero, 3, old);
        add_step(&builder, 2, affine, shifted, 12, zero, 3, old);
        check_point(&builder, (double[]){1, 2, 3}, (double[]){0, 0, 14});
    }
}

/* Twelve groups: each is a shift by (-1, -2, 4), but 2, which doubles. From the last one on these are 9 shifts, the
 * doubling, and one shift. In alphabetical order 2 would come behind 11. */
static void groups_are_in_the_order_of_numbers(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    begin(&builder, composite);
    for (int i = 1; i < 12; i++) {
        add_step(&builder, i, affine, i == 2 ? doubled : shifted, 12, zero, 3, false);
    }
    check_point(&builder, zero, (double[]){-19, -38, 76});
}

/* Node (1, 0, 0) is at (0, -10, 0) in RAS. */
static void a_field_lies_where_its_direction_says(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    hdf5_begin(&builder);
    add_step(&builder, 0, field, vectors, 24, turned, 18, false);
    check_point(&builder, (double[]){0, -10, 0}, (double[]){-1, -10, 3});

    hdf5_begin(&builder); /* half as far, half the way */
    add_step(&builder, 0, field, vectors, 24, turned, 18, false);
    check_point(&builder, (double[]){0, -5, 0}, (double[]){-0.5, -5, 1.5});

    hdf5_begin(&builder); /* half a step beyond the nodes the vector is that of the border; there the grid ends */
    add_step(&builder, 0, field, vectors, 24, turned, 18, false);
    check_point(&builder, (double[]){0, -14.999, 0}, (double[]){-1, -14.999, 3});
    hdf5_begin(&builder);
    add_step(&builder, 0, field, vectors, 24, turned, 18, false);
    check_point(&builder, (double[]){0, -15, 0}, (double[]){0, -15, 0});
}

/* Outside of the field, points still go through the affines: (500, 0, 0) + (-1, -2, 4), doubled. */
static void affines_around_a_field_count_everywhere(void **state)
{
    (void)state;
    for (int outside = 0; outside < 2; outside++) {
        struct hdf5_builder builder;
        begin(&builder, composite);
        add_step(&builder, 1, affine, doubled, 12, zero, 3, false);
        add_step(&builder, 2, field, vectors, 24, turned, 18, false);
        add_step(&builder, 3, affine, shifted, 12, zero, 3, false);
        if (outside) {
            check_point(&builder, (double[]){500, 0, 0}, (double[]){998, -4, 8});
        } else { /* (1, -8, -4) + (-1, -2, 4) = (0, -10, 0) */
            check_point(&builder, (double[]){1, -8, -4}, (double[]){-2, -20, 6});
        }
    }
}

/* A second field, before the first. */
static void several_fields_are_gone_through(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    begin(&builder, composite);
    add_step(&builder, 1, field, vectors, 24, turned, 18, false);
    add_step(&builder, 2, "GaussianSmoothingOnUpdateDisplacementFieldTransform_double_3_3", vectors, 24, turned, 18,
             false);
    /* (0, -10, 0) to (-1, -10, 3); there the vector is 0.9 * 0.7 of that at the node, 0.3 of k, 0.1 outside along j,
     * where it is that of the border: 0.7 (-1, 0, 3) */
    check_point(&builder, (double[]){0, -10, 0}, (double[]){-1.7, -10, 5.1});
}

static void check_refused(struct hdf5_builder *builder, conus_status wanted, const char *part, uint64_t max_memory)
{
    struct transform_chain chain;
    hdf5_end(builder);
    assert_fails(parse_with(&chain, builder, max_memory), wanted);
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
    buffer_finish(&builder->bytes);
}

/* Between the second node and the last but one equal coefficients are the vector itself: here 1 mm along LPS y, in a
 * grid of 10 mm from (0, 0, 0) on. Points go by (-1, -2, 4), then through the spline, then are doubled. */
static void splines_are_steps(void **state)
{
    (void)state;
    static const double grid[18] = {4, 4, 4, 0, 0, 0, 10, 10, 10, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    double coefficients[3 * 64] = {0};
    struct hdf5_builder builder;
    for (size_t i = 64; i < 128; i++) {
        coefficients[i] = 1;
    }
    for (int outside = 0; outside < 2; outside++) {
        const double from[3] = {-14, -13, outside ? 41 : 11};
        const double to[3] = {-30, outside ? -30 : -32, outside ? 90 : 30};
        begin(&builder, composite);
        add_step(&builder, 1, affine, doubled, 12, zero, 3, false);
        add_step(&builder, 2, spline, coefficients, 192, grid, 18, outside);
        add_step(&builder, 3, affine, shifted, 12, zero, 3, false);
        check_point(&builder, from, to);
    }
}

static void refuse_step(const char *type, const double *numbers, size_t count, const double *fixed, size_t fixed_count,
                        conus_status wanted, const char *part)
{
    struct hdf5_builder builder;
    hdf5_begin(&builder);
    add_step(&builder, 0, type, numbers, count, fixed, fixed_count, false);
    check_refused(&builder, wanted, part, 0);
}

static void steps_that_lie_are_refused(void **state)
{
    (void)state;
    double fixed[18];
    double numbers[24] = {0};
    const conus_status data = CONUS_ERROR_DATA;
    const conus_status unsupported = CONUS_ERROR_UNSUPPORTED;
    refuse_step(affine, doubled, 11, zero, 3, data, "Parameters: 11 numbers");
    refuse_step(affine, numbers, 12, zero, 3, data, "singular");
    refuse_step(affine, vectors, 24, zero, 3, data, "Parameters: 24 numbers");
    refuse_step("AffineTransform_double_2_2", doubled, 6, zero, 2, unsupported, "AffineTransform_double_2_2");
    refuse_step(spline, numbers, 24, turned, 18, data, "4 or more nodes");
    refuse_step("Rigid3DPerspectiveTransform_double_3_3", numbers, 6, zero, 3, unsupported, "Rigid3DPerspective");
    refuse_step("TimeVaryingVelocityFieldTransform_double_3_3", numbers, 24, turned, 18, unsupported, "TimeVarying");
    refuse_step(field, vectors, 23, turned, 18, data, "23 numbers, a field of 2 x 2 x 2 nodes");
    refuse_step(field, vectors, 24, turned, 17, data, "FixedParameters: 17 numbers");
    const struct {
        size_t place;
        double value;
        const char *part;
    } cases[] = {
        {0, 2.5, "size 2.5"},           {0, -2, "size -2"},  {0, 1e300, "size 1e+300"},
        {0, 4294967295., "a field of"}, {6, 0, "spacing 0"}, {6, -10, "spacing -10"},
        {3, NAN, "18 finite"},          {10, 0, "singular"}, {12, INFINITY, "18 finite"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        memcpy(fixed, turned, sizeof fixed);
        fixed[cases[i].place] = cases[i].value;
        refuse_step(field, vectors, 24, fixed, 18, data, cases[i].part);
    }
    memcpy(fixed, turned, sizeof fixed);
    fixed[0] = 1;
    refuse_step(field, vectors, 12, fixed, 18, data, "size along i: found 1");
    memcpy(numbers, vectors, sizeof numbers);
    numbers[7] = NAN;
    refuse_step(field, numbers, 24, turned, 18, data, "number 7 is not finite");
}

static void files_that_are_no_chain_are_refused(void **state)
{
    (void)state;
    struct hdf5_builder builder;
    hdf5_begin(&builder);
    hdf5_group(&builder, "/");
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "without transforms in /TransformGroup", 0);

    begin(&builder, composite);
    check_refused(&builder, CONUS_ERROR_DATA, "a composite of nothing", 0);

    begin(&builder, composite);
    add_step(&builder, 2, affine, doubled, 12, zero, 3, false);
    check_refused(&builder, CONUS_ERROR_DATA, "found \"2\", the group 1 is needed", 0);

    begin(&builder, composite);
    add_group(&builder, 1, composite);
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "/TransformGroup/1: a composite within a composite", 0);

    hdf5_begin(&builder);
    add_step(&builder, 0, affine, doubled, 12, zero, 3, false);
    add_step(&builder, 1, affine, doubled, 12, zero, 3, false);
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "a list of 2", 0);

    hdf5_begin(&builder);
    hdf5_group(&builder, "/TransformGroup/0");
    check_refused(&builder, CONUS_ERROR_DATA, "/TransformGroup/0/TransformType: one text is needed", 0);

    begin(&builder, composite);
    hdf5_group(&builder, "/TransformGroup/x");
    check_refused(&builder, CONUS_ERROR_DATA, "found \"x\"", 0);

    hdf5_begin(&builder);
    add_step(&builder, 0, field, vectors, 24, turned, 18, false);
    check_refused(&builder, CONUS_ERROR_MEMORY, "a field of 8 vectors of 12 bytes each, allowed are 95", 95);
}

/* The attributes of an X5 group. */
static void describe(struct hdf5_builder *builder, const char *type, const char *kind, const char *form)
{
    hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "Type", &type, 1);
    hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "SubType", &kind, 1);
    hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "Representation", &form, 1);
}

static void begin_x5(struct hdf5_builder *builder, double version)
{
    static const char *const format[] = {"X5"};
    hdf5_begin(builder);
    hdf5_group(builder, "/");
    hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "Format", format, 1);
    hdf5_doubles(builder, HDF5_FRAME_ATTRIBUTE, "Version", &version, 1);
}

static const double shift4[16] = {1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 4, 0, 0, 0, 1};
static const double double4[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1};

static void add_linear(struct hdf5_builder *builder, int number, const double *matrix)
{
    char path[40];
    snprintf(path, sizeof path, "/TransformGroup/%d", number);
    hdf5_group(builder, path);
    describe(builder, "linear", "affine", "matrix");
    add_numbers(builder, number, "Transform", matrix, 16);
}

/* Adds the nodes of a grid of 10 mm, [i, j, k, 3]: in C's order the last number of a field belongs to (1, 1, 1), the
 * three numbers from 3 on to (0, 0, 1), which is at (0, 0, 10). */
static void add_dense(struct hdf5_builder *builder, int number, const char *form, const double *numbers)
{
    static const double mapping[16] = {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 1};
    char path[60];
    snprintf(path, sizeof path, "/TransformGroup/%d", number);
    hdf5_group(builder, path);
    describe(builder, "nonlinear", "densefield", form);
    add_numbers(builder, number, "Domain/Mapping", mapping, 16);
    snprintf(path, sizeof path, "/TransformGroup/%d/Transform", number);
    hdf5_frame(builder,
               (struct built_value){OBJECT, HDF5_FLOAT, 8, 4, {2, 2, 2, 3}, 5, path, numbers, 24 * sizeof *numbers});
}

static void x5_is_ras_and_goes_through_the_first_first(void **state)
{
    (void)state;
    static const char *const order[] = {"1/0"};
    struct hdf5_builder builder;
    begin_x5(&builder, 1);
    add_linear(&builder, 0, double4);
    check_point(&builder, (double[]){1, 2, 3}, (double[]){2, 4, 6});

    begin_x5(&builder, 1);
    add_linear(&builder, 0, double4);
    add_linear(&builder, 1, shift4);
    hdf5_strings(&builder, OBJECT, "/TransformChain/0", order, 1);
    check_point(&builder, (double[]){1, 2, 3}, (double[]){4, 8, 14});
}

/* numpy writes a matrix of whole numbers as such. */
static void x5_matrices_may_be_of_whole_numbers(void **state)
{
    (void)state;
    static const int64_t matrix[16] = {0, -1, 0, 5, 1, 0, 0, 0, 0, 0, 1, -7, 0, 0, 0, 1};
    struct hdf5_builder builder;
    begin_x5(&builder, 1);
    hdf5_group(&builder, "/TransformGroup/0");
    describe(&builder, "linear", "affine", "matrix");
    hdf5_frame(&builder,
               (struct built_value){
                   OBJECT, HDF5_SIGNED, 8, 2, {4, 4}, 5, "/TransformGroup/0/Transform", matrix, sizeof matrix});
    check_point(&builder, (double[]){1, 2, 3}, (double[]){3, 1, -4});
}

static void x5_fields_have_the_last_axis_fastest(void **state)
{
    (void)state;
    static const double ways[24] = {0, 0, 0, 1, -2, 4};
    double places[24];
    struct hdf5_builder builder;
    begin_x5(&builder, 1);
    add_dense(&builder, 0, "displacements", ways);
    check_point(&builder, (double[]){0, 0, 10}, (double[]){1, -2, 14});
    begin_x5(&builder, 1);
    add_dense(&builder, 0, "displacements", ways);
    check_point(&builder, (double[]){10, 0, 0}, (double[]){10, 0, 0});
    for (size_t i = 0; i < 24; i++) {
        size_t node = i / 3;
        size_t axis = i % 3;
        places[i] = 100 * (double)(node >> (2 - axis) & 1) + (double)axis; /* 100 times the indices, + (0, 1, 2) */
    }
    begin_x5(&builder, 1);
    add_dense(&builder, 0, "deformations", places);
    check_point(&builder, (double[]){5, 10, 2}, (double[]){50, 101, 22});
}

static void what_is_no_x5_is_refused(void **state)
{
    (void)state;
    static const char *const beyond[] = {"0/1"};
    static const char *const words[] = {"one"};
    static const double ways[24] = {0};
    struct hdf5_builder builder;
    begin_x5(&builder, 2);
    add_linear(&builder, 0, double4);
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "Version: found 2 of X5", 0);
    begin_x5(&builder, 1);
    add_linear(&builder, 0, ways);
    check_refused(&builder, CONUS_ERROR_DATA, "Transform: no affine matrix", 0);
    begin_x5(&builder, 1);
    hdf5_group(&builder, "/TransformGroup/0");
    describe(&builder, "linear", "affine", "matrix");
    hdf5_strings(&builder, OBJECT, "/TransformGroup/0/Transform", words, 1);
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "Transform: 1 values, one matrix of 4 x 4 numbers is read", 0);
    begin_x5(&builder, 1);
    add_dense(&builder, 0, "coefficients", ways);
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "Representation coefficients", 0);
    begin_x5(&builder, 1);
    add_linear(&builder, 0, double4);
    add_linear(&builder, 1, double4);
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "2 transforms, and no /TransformChain", 0);
    for (int i = 0; i < 2; i++) {
        begin_x5(&builder, 1);
        add_linear(&builder, 0, double4);
        hdf5_strings(&builder, OBJECT, "/TransformChain/0", i ? words : beyond, 1);
        check_refused(&builder, CONUS_ERROR_DATA, i ? "\"one\"" : "\"1\"", 0);
    }
    begin_x5(&builder, 1);
    add_linear(&builder, 0, double4);
    hdf5_strings(&builder, OBJECT, "/TransformChain/0", beyond, 1);
    hdf5_strings(&builder, OBJECT, "/TransformChain/1", beyond, 1);
    check_refused(&builder, CONUS_ERROR_UNSUPPORTED, "several chains", 0);
}

static conus_status attempt(void *data)
{
    struct transform_chain chain;
    conus_status status = parse_with(&chain, data, 0);
    if (!status) {
        transform_chain_finish(&chain);
    }
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    static const double fine[24] = {0.1}; /* no float */
    static const char *const order[] = {"0/1"};
    struct hdf5_builder builder;
    begin(&builder, composite);
    add_step(&builder, 1, field, fine, 24, turned, 18, false);
    add_step(&builder, 2, affine, shifted, 12, zero, 3, false);
    add_step(&builder, 3, field, vectors, 24, turned, 18, false);
    hdf5_end(&builder);
    test_every_allocation(attempt, &builder);
    buffer_finish(&builder.bytes);

    begin_x5(&builder, 1);
    add_dense(&builder, 0, "displacements", fine);
    add_linear(&builder, 1, shift4);
    hdf5_strings(&builder, OBJECT, "/TransformChain/0", order, 1);
    hdf5_end(&builder);
    test_every_allocation(attempt, &builder);
    buffer_finish(&builder.bytes);
}

static void names_say_which_way_points_go(void **state)
{
    (void)state;
    static const struct {
        const char *path, *from, *to;
    } cases[] = {
        {"a/sub-01_from-T1w_to-MNI152NLin2009cAsym_mode-image_xfm.h5", "MNI152NLin2009cAsym", "T1w"},
        {"sub-01_from-MNI152NLin6Asym_to-T1w_mode-image_xfm.h5", "T1w", "MNI152NLin6Asym"},
        {"from-T1w_to-scanner_mode-points_xfm.txt", "T1w", "scanner"},
        {"from-T1w_to-MNI_mode-image.h5", NULL, NULL},
        {"sub-01_to-MNI_xfm.h5", NULL, NULL},
        {"a_from-T1w_to-MNI_xfm.h5/o_Composite.h5", NULL, NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct text from;
        struct text to;
        assert_int_equal(transform_name_points(&from, &to, cases[i].path), cases[i].from != NULL);
        assert_true(!cases[i].from || (text_equal(from, cases[i].from) && text_equal(to, cases[i].to)));
    }
}

TEST_GROUP(chain)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_go_through_the_last_group_first),
        cmocka_unit_test(groups_are_in_the_order_of_numbers),
        cmocka_unit_test(a_field_lies_where_its_direction_says),
        cmocka_unit_test(affines_around_a_field_count_everywhere),
        cmocka_unit_test(several_fields_are_gone_through),
        cmocka_unit_test(splines_are_steps),
        cmocka_unit_test(steps_that_lie_are_refused),
        cmocka_unit_test(files_that_are_no_chain_are_refused),
        cmocka_unit_test(x5_is_ras_and_goes_through_the_first_first),
        cmocka_unit_test(x5_matrices_may_be_of_whole_numbers),
        cmocka_unit_test(x5_fields_have_the_last_axis_fastest),
        cmocka_unit_test(what_is_no_x5_is_refused),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(names_say_which_way_points_go),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
