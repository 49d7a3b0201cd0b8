/* SPDX-License-Identifier: BSD-3-Clause */
/* First hits that the device counts: bit by bit the results of the rays engine, whose pixels the CPU adds up. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "gl_pair.h"
#include "scene.h"
#include "selection/measure/measure.h"
#include "test.h"
#include "test_gl.h"

#include <math.h>
#include <string.h>

static const struct shape {
    const char *name;
    uint32_t resolution;
    double degrees; /* 0: cylinders */
    conus_aperture aperture;
} shapes[] = {
    {"the paper's", 16, 20, CONUS_APERTURE_CIRCLE},
    {"narrow", 16, 1, CONUS_APERTURE_CIRCLE},
    {"a square", 16, 90, CONUS_APERTURE_SQUARE},
    {"wide (Eq. 15)", 16, 150, CONUS_APERTURE_CIRCLE},
    {"a wide square", 12, 130, CONUS_APERTURE_SQUARE},
    {"a cylinder", 16, 0, CONUS_APERTURE_CIRCLE},
    {"one ray", 1, 10, CONUS_APERTURE_CIRCLE},
    {"rays along the axes", 15, 20, CONUS_APERTURE_CIRCLE},
    {"cylinders along them", 15, 0, CONUS_APERTURE_SQUARE},
    {"just two parts", 17, 30, CONUS_APERTURE_SQUARE},
    {"thirteen parts", 64, 40, CONUS_APERTURE_CIRCLE},
};

/* Counts with cones of several shapes, and as whatever objects are reported. */
struct counting {
    const conus_atlas *atlas;
    const uint32_t *group; /* NULL = each as itself */
    struct gl_pair pair;
    struct aperture aperture;
    struct tally tally;
    size_t results, merged; /* in all; with another object's pixels, too */
};

static struct statistics gather(struct counting *counting, const struct cone *cone, const struct evidence *evidence,
                                const struct hit_counts *counts)
{
    struct statistics statistics = {0};
    const struct gathering gathering = {.atlas = counting->atlas,
                                        .cone = cone,
                                        .aperture = &counting->aperture,
                                        .evidence = evidence,
                                        .counts = counts,
                                        .group = counting->group};
    assert_ok(statistics_gather(&statistics, &gathering, &counting->tally));
    return statistics;
}

/* Numbers are equal in every bit, or both none. */
static void assert_same_number(double a, double b)
{
    assert_true((isnan(a) && isnan(b)) || (a == b && signbit(a) == signbit(b)));
}

static void compare_results(const struct statistics *got, const struct statistics *wanted)
{
    assert_int_equal(got->count, wanted->count);
    for (size_t i = 0; i < got->count; i++) {
        const conus_result *a = &got->results[i];
        const conus_result *b = &wanted->results[i];
        assert_int_equal(a->object, b->object);
        assert_int_equal(a->pixels, b->pixels);
        const double numbers[][2] = {{a->share, b->share},           {a->distance, b->distance},
                                     {a->offset, b->offset},         {a->centre_px, b->centre_px},
                                     {a->contact[0], b->contact[0]}, {a->contact[1], b->contact[1]},
                                     {a->contact[2], b->contact[2]}, {a->contact_value, b->contact_value}};
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
            assert_same_number(numbers[k][0], numbers[k][1]);
        }
    }
}

static struct cone make_cone(uint64_t *random, const conus_atlas *atlas, const struct shape *shape)
{
    struct cone cone = {.pose = scene_pose(random, atlas),
                        .angle = radians_from_degrees(shape->degrees),
                        .resolution = shape->resolution,
                        .aperture = shape->aperture};
    cone.radius = shape->degrees > 0 ? 0 : test_random(random, 0.5, 8);
    return cone;
}

enum { CONES = 24 };

static void compare_cones(struct counting *counting, const struct cone cones[CONES])
{
    struct hit_counts counts[CONES] = {{0}};
    const struct cone *in[CONES];
    struct hit_counts *out[CONES];
    bool is_counted = false;
    for (size_t c = 0; c < CONES; c++) {
        in[c] = &cones[c];
        out[c] = &counts[c];
    }
    assert_ok(aperture_prepare(&counting->aperture, &cones[0]));
    assert_ok(counting->pair.gl->functions->count_many(counting->pair.gl, &is_counted, out, in, CONES,
                                                       &counting->aperture, counting->group));
    assert_true(is_counted);
    for (size_t c = 0; c < CONES; c++) {
        struct evidence evidence = gl_pair_trace(counting->pair.rays, &cones[c]);
        evidence_drop_blocked(&evidence);
        assert_ok(aperture_prepare(&counting->aperture, &cones[c]));
        struct statistics wanted = gather(counting, &cones[c], &evidence, NULL);
        struct statistics got = gather(counting, &cones[c], NULL, &counts[c]);
        compare_results(&got, &wanted);
        counting->results += got.count - 1; /* what hit nothing is always there */
        for (size_t i = 0; i < counts[c].count; i++) {
            const struct hit_count *row = &counts[c].rows[i];
            assert_int_equal(row->own, evidence.object[row->pixel]);
            assert_true(row->voxel == evidence.voxel[row->pixel] || !row->own);
            counting->merged += row->own != row->object;
        }
        statistics_finish(&wanted);
        statistics_finish(&got);
        evidence_finish(&evidence);
        memory_free(counts[c].rows);
    }
}

static void compare_shape(struct counting *counting, uint64_t *random, const struct shape *shape)
{
    struct cone cones[CONES];
    for (size_t c = 0; c < CONES; c++) {
        cones[c] = make_cone(random, counting->atlas, shape);
    }
    compare_cones(counting, cones);
}

static struct counting begin(const conus_atlas *atlas, const uint32_t *group)
{
    struct counting counting = {.atlas = atlas, .group = group, .pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT)};
    assert_ok(tally_prepare(&counting.tally, atlas->object_count));
    return counting;
}

static void end(struct counting *counting)
{
    gl_pair_destroy(&counting->pair);
    aperture_finish(&counting->aperture);
    tally_finish(&counting->tally);
}

/* Areas, pathways and what blocks, on grids that are oblique, flipped, sheared and never the same. */
static void all_shapes_have_the_bits_of_the_rays(void **state)
{
    (void)state;
    uint64_t random = 41;
    for (int round = 0; round < 6; round++) {
        conus_atlas *atlas = scene_atlas(&random, 24, round % 3);
        if (round % 2) {
            scene_add_blockers(atlas, &random, (size_t[]){9, 9, 9}, 0.05);
        }
        struct counting counting = begin(atlas, NULL);
        for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
            compare_shape(&counting, &random, &shapes[i]);
        }
        print_message("%zu results\n", counting.results);
        assert_true(counting.results > 100 && counting.merged == 0);
        end(&counting);
        conus_atlas_destroy(atlas);
    }
}

/* Each voxel of a cube is an object of its own. */
static conus_atlas *make_cube(void)
{
    enum { EDGE = 40 };
    static uint32_t labels[EDGE * EDGE * EDGE];
    const conus_volume_info grid = scene_plain_grid((size_t[]){EDGE, EDGE, EDGE}, NULL);
    for (uint32_t i = 0; i < EDGE * EDGE * EDGE; i++) {
        labels[i] = i + 1;
    }
    return scene_parcellation(&grid, labels);
}

/* A hundred objects are reported as the last of them. */
static void objects_are_counted_as_they_are_reported(void **state)
{
    (void)state;
    uint64_t random = 42;
    conus_atlas *atlas = make_cube();
    uint32_t *group = memory_raw(atlas->object_count + 1, sizeof *group);
    assert_non_null(group);
    for (size_t i = 0; i <= atlas->object_count; i++) {
        size_t last = (i + 99) / 100 * 100;
        group[i] = (uint32_t)(last < atlas->object_count ? last : atlas->object_count);
    }
    group[0] = 0;
    struct counting counting = begin(atlas, group);
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        compare_shape(&counting, &random, &shapes[i]);
    }
    assert_true(counting.merged > counting.results / 2);
    end(&counting);
    memory_free(group);
    conus_atlas_destroy(atlas);
}

/* Far more rows than there is room for at first, and as many objects in a part as it has rays. */
static void a_full_list_of_rows_grows(void **state)
{
    (void)state;
    uint64_t random = 43;
    conus_atlas *atlas = make_cube();
    struct counting counting = begin(atlas, NULL);
    compare_shape(&counting, &random, &shapes[2]);
    compare_shape(&counting, &random, &shapes[10]);
    assert_true(counting.results > 24 * 8 * 2); /* 8 rows of a part are reserved */
    end(&counting);
    conus_atlas_destroy(atlas);
}

/* Counts the same pixels for these cones; returns how often the CPU waits. */
static int wait_for_block(struct counting *counting, const struct cone *const *in, size_t count, size_t *rows)
{
    struct hit_counts counts[CONES] = {{0}};
    struct hit_counts *out[CONES];
    bool is_counted = false;
    for (size_t c = 0; c < count; c++) {
        out[c] = &counts[c];
    }
    const int before = gl_pair_waits();
    assert_ok(aperture_prepare(&counting->aperture, in[0]));
    assert_ok(counting->pair.gl->functions->count_many(counting->pair.gl, &is_counted, out, in, count,
                                                       &counting->aperture, NULL));
    assert_true(is_counted);
    *rows = 0;
    for (size_t c = 0; c < count; c++) {
        *rows += counts[c].count;
        memory_free(counts[c].rows);
    }
    return gl_pair_waits() - before;
}

/* The first block waits for how the driver rounds, too. One with more than 8 rows a part is counted again, and so wide
 * a cone in a cube in which each voxel is an object has over a hundred; from then on as many are read at once. One that
 * looks away from it has one row, and a block behind it is read in two steps: there is place for its rows. */
static void a_block_is_waited_for_once(void **state)
{
    (void)state;
    uint64_t random = 48;
    size_t rows;
    conus_atlas *atlas = make_cube();
    struct counting counting = begin(atlas, NULL);
    struct cone before = make_cone(&random, atlas, &shapes[2]);
    mat4_identity(before.pose.world_from_device);
    struct cone away = before;
    memcpy(before.pose.world_from_device + 12, (double[]){20, 20, 60}, 3 * sizeof(double));
    memcpy(away.pose.world_from_device + 12, (double[]){20, 20, -60}, 3 * sizeof(double));
    const struct {
        const struct cone *cones[3];
        size_t count;
        int waits;
    } blocks[] = {{{&away}, 1, 2},          {{&away, &away}, 2, 1}, {{&before}, 1, 2}, {{&before, &before}, 2, 1},
                  {{&before, &away}, 2, 1}, {{&away}, 1, 1},        {{&before}, 1, 2}, {{&before}, 1, 1}};
    for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) {
        int waits = wait_for_block(&counting, blocks[i].cones, blocks[i].count, &rows);
        print_message("block %zu: %zu rows, %d waits\n", i, rows, waits);
        assert_int_equal(waits, blocks[i].waits);
    }
    assert_true(rows > 100);
    end(&counting);
    conus_atlas_destroy(atlas);
}

/* Two pixels hit an object equally near, and equally far from the axis: |(26.5, 30.5) - (32, 32)| is that of
 * (36.5, 28.5), squared 32.5. They lie in two parts of the cone, and the later part has the lower pixel, which is the
 * contact. Pixel (i, j) sees voxel (i, j), whose face is at z = 0.5. */
static void of_pixels_that_are_as_near_the_lowest_is_the_contact(void **state)
{
    enum { EDGE = 64, FIRST = 30 * EDGE + 26, SECOND = 28 * EDGE + 36 };
    static uint32_t labels[EDGE * EDGE];
    (void)state;
    for (size_t i = 0; i < EDGE * EDGE; i++) {
        labels[i] = i == FIRST || i == SECOND ? 2 : 1;
    }
    const conus_volume_info grid = scene_plain_grid((size_t[]){EDGE, EDGE, 1}, NULL);
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    struct counting counting = begin(atlas, NULL);
    struct cone cone = {.resolution = EDGE, .radius = EDGE / 2.0};
    mat4_identity(cone.pose.world_from_device);
    cone.pose.world_from_device[12] = cone.pose.world_from_device[13] = (EDGE - 1) / 2.0;
    cone.pose.world_from_device[14] = 10;
    struct hit_counts counts = {0};
    bool is_counted = false;
    assert_ok(aperture_prepare(&counting.aperture, &cone));
    assert_ok(counting.pair.gl->functions->count_many(counting.pair.gl, &is_counted, (struct hit_counts *[]){&counts},
                                                      (const struct cone *[]){&cone}, 1, &counting.aperture, NULL));
    assert_true(is_counted);
    struct statistics got = gather(&counting, &cone, NULL, &counts);
    const conus_result *small = &got.results[1]; /* objects by number */
    assert_int_equal(small->object, 2);
    assert_int_equal(small->pixels, 2);
    assert_true(small->contact[0] == 36 && small->contact[1] == 28 && small->contact[2] == 0.5);
    statistics_finish(&got);
    memory_free(counts.rows);
    end(&counting);
    conus_atlas_destroy(atlas);
}

/* Cones of one block with angles of their own, which the device has or gets: block after block some come again. 64 x 64
 * pixels have 3,209 rays: with more than 326 such shapes the next block begins anew. */
static void cones_of_a_block_have_their_angles(void **state)
{
    (void)state;
    uint64_t random = 47;
    conus_atlas *atlas = scene_atlas(&random, 24, 1);
    struct counting counting = begin(atlas, NULL);
    static const struct {
        uint32_t resolution;
        size_t blocks;
    } rounds[] = {{16, 4}, {64, 16}, {15, 2}};
    size_t angles = 0;
    for (size_t r = 0; r < sizeof rounds / sizeof rounds[0]; r++) {
        for (size_t block = 0; block < rounds[r].blocks; block++) {
            struct cone cones[CONES];
            for (size_t c = 0; c < CONES; c++) {
                const struct shape shape = {.resolution = rounds[r].resolution,
                                            .degrees = (double)(c % 12 ? ++angles : c + 1) * 160 / 1024};
                cones[c] = make_cone(&random, atlas, &shape);
            }
            compare_cones(&counting, cones);
        }
    }
    assert_true(counting.results > 100 && angles < 1024);
    end(&counting);
    conus_atlas_destroy(atlas);
}

static PFNGLCOPYNAMEDBUFFERSUBDATAPROC driver_copy;

/* A driver that rounds the inverse of one number the other way. */
static void GLAPIENTRY copy_with_an_error(GLuint from, GLuint to, GLintptr first, GLintptr at, GLsizeiptr size)
{
    double value;
    const GLintptr place = first + 1234 * (GLintptr)sizeof value;
    if (size == 4096 * sizeof value) {
        glGetNamedBufferSubData(from, place, sizeof value, &value);
        value = nextafter(value, 0);
        glNamedBufferSubData(from, place, sizeof value, &value);
    }
    driver_copy(from, to, first, at, size);
}

/* Then the CPU makes the rays, and the pixels have the same bits. */
static void a_driver_that_rounds_otherwise_counts_nothing(void **state)
{
    size_t hits = 0;
    (void)state;
    uint64_t random = 44;
    conus_atlas *atlas = scene_atlas(&random, 24, 1);
    struct counting counting = begin(atlas, NULL);
    struct cone cone = make_cone(&random, atlas, &shapes[0]);
    struct hit_counts counts = {0};
    bool is_counted = true;
    assert_ok(aperture_prepare(&counting.aperture, &cone));
    driver_copy = glCopyNamedBufferSubData;
    glCopyNamedBufferSubData = copy_with_an_error;
    for (int again = 0; again < 2; again++) {
        conus_status status =
            counting.pair.gl->functions->count_many(counting.pair.gl, &is_counted, (struct hit_counts *[]){&counts},
                                                    (const struct cone *[]){&cone}, 1, &counting.aperture, NULL);
        assert_ok(status);
        assert_false(is_counted);
        assert_int_equal(counts.count, 0);
    }
    glCopyNamedBufferSubData = driver_copy;
    for (int k = 0; k < 44; k++) {
        const struct cone other = make_cone(&random, atlas, &shapes[k % 11]);
        hits += gl_pair_same_hits(&counting.pair, &other);
    }
    assert_true(hits > 3000);
    end(&counting);
    conus_atlas_destroy(atlas);
}

static conus_status create_count_destroy(void *user)
{
    const conus_atlas *atlas = user;
    uint64_t random = 45;
    struct engine *engine = NULL;
    struct aperture aperture = {0};
    struct hit_counts counts = {0};
    struct cone cone = make_cone(&random, atlas, &shapes[10]);
    bool is_counted = false;
    conus_status status = engine_gl_create(&engine, atlas, &(struct engine_options){0});
    status = status ? status : aperture_prepare(&aperture, &cone);
    status = status ? status
                    : engine->functions->count_many(engine, &is_counted, (struct hit_counts *[]){&counts},
                                                    (const struct cone *[]){&cone}, 1, &aperture, NULL);
    engine_destroy(engine);
    aperture_finish(&aperture);
    memory_free(counts.rows);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    uint64_t random = 46;
    conus_atlas *atlas = scene_atlas(&random, 12, 1);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT); /* or skips */
    gl_pair_destroy(&pair);
    test_every_allocation(create_count_destroy, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(gl_count)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_shapes_have_the_bits_of_the_rays),
        cmocka_unit_test(cones_of_a_block_have_their_angles),
        cmocka_unit_test(objects_are_counted_as_they_are_reported),
        cmocka_unit_test(a_full_list_of_rows_grows),
        cmocka_unit_test(a_block_is_waited_for_once),
        cmocka_unit_test(of_pixels_that_are_as_near_the_lowest_is_the_contact),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(the_driver_was_silent),
        cmocka_unit_test(a_driver_that_rounds_otherwise_counts_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
