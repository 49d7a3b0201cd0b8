/* SPDX-License-Identifier: BSD-3-Clause */
/* Batches by the gl engine, which traces a block of cones at once: byte for byte those of the rays engine, whatever is
 * in a block. With meshes, at whose edges drivers differ, they are those of the gl engine one by one. */
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/selection.h"
#include "test.h"
#include "test_gl.h"
#include "tract_scene.h"

#include <stdio.h>
#include <string.h>

enum { POSES = 150 };

/* A selector of the gl engine, or skips the running test, saying why. */
static conus_selector *gl_selector(const conus_atlas *atlas, conus_selector_options options)
{
    conus_selector *selector = NULL;
    options.engine = CONUS_ENGINE_GL;
    options.log = gl_pair_log;
    assert_gl(conus_selector_create(&selector, atlas, &options));
    return selector;
}

/* Every seventh row is no pose, every eleventh has an invalid angle. With ranges every third row has its own, and
 * angles change from row to row; without, all cones have one shape. */
static const char *write_poses(uint64_t seed, const conus_atlas *atlas, bool cylinders, bool ranges)
{
    const char *path = test_scratch("poses.tsv");
    struct buffer text = {0};
    buffer_text(&text, "query_id\tm00\tm01\tm02\tm03\tm10\tm11\tm12\tm13\tm20\tm21\tm22\tm23\tm30\tm31\tm32\tm33");
    buffer_text(&text, cylinders ? "" : "\tangle");
    buffer_text(&text, ranges ? "\tnear\tfar\n" : "\n");
    for (int i = 0; i < POSES; i++) {
        conus_pose pose =
            atlas->volume_count ? scene_generic_pose(&seed, atlas) : mesh_scene_random_cone(&seed, 20).pose;
        buffer_format(&text, "pose %d", i);
        for (int k = 0; k < 16; k++) {
            buffer_format(&text, "\t%.17g", k == 5 && i % 7 == 3 ? NAN : pose.world_from_device[4 * (k % 4) + k / 4]);
        }
        if (!cylinders) {
            buffer_format(&text, "\t%d", i % 11 == 4 ? 500 : ranges ? 2 + i % 3 * 13 : 15);
        }
        if (ranges) {
            buffer_text(&text, i % 3 ? "\tn/a\tn/a" : i % 2 ? "\t0\t40" : "\t12\t60");
        }
        buffer_text(&text, "\n");
    }
    assert_ok(buffer_status(&text));
    assert_ok(file_write(path, text.data, text.size));
    buffer_finish(&text);
    return path;
}

struct rows {
    struct buffer text;
    uint64_t errors;
};

static bool append_block(void *user, const conus_batch_block *block)
{
    struct rows *rows = user;
    buffer_append(&rows->text, block->text, block->size);
    rows->errors += block->errors;
    return true;
}

static conus_status run_batch(struct rows *out, conus_selector *selector, const char *path, uint32_t block,
                              uint32_t threads)
{
    conus_batch *batch = NULL;
    conus_pose_stream *poses = NULL;
    const conus_batch_options options = {.threads = threads, .block = block, .report = {.format = "ndjson"}};
    buffer_clear(&out->text);
    out->errors = 0;
    conus_status status = conus_batch_create(&batch, selector, &options);
    status = status ? status : conus_pose_stream_open(&poses, path, NULL);
    status = status ? status : conus_batch_run(batch, poses, UINT64_MAX, append_block, out);
    conus_pose_stream_destroy(poses);
    conus_batch_destroy(batch);
    return status;
}

/* Blocks of two sizes give the rows of `reference`, the first by three threads, the second by one. */
static void assert_same_rows(conus_selector *selector, const char *path, const struct rows *reference,
                             const uint32_t sizes[2])
{
    for (size_t i = 0; i < 2; i++) {
        struct rows rows = {0};
        assert_ok(run_batch(&rows, selector, path, sizes[i], i ? 1 : 3));
        assert_int_equal(rows.errors, reference->errors);
        assert_int_equal(rows.text.size, reference->text.size);
        assert_memory_equal(rows.text.data, reference->text.data, rows.text.size);
        buffer_finish(&rows.text);
    }
}

static void compare_engines(const conus_atlas *atlas, const conus_selector_options *options, const char *path,
                            const uint32_t sizes[2])
{
    conus_selector *gl = gl_selector(atlas, *options);
    conus_selector *rays = NULL;
    struct rows reference = {0};
    assert_ok(conus_selector_create(&rays, atlas, options));
    assert_ok(run_batch(&reference, rays, path, 0, 1));
    assert_true(reference.errors > POSES / 10 && reference.errors < POSES / 3); /* those that are meant to be wrong */
    assert_true(reference.text.size > (size_t)POSES * 200);
    assert_same_rows(gl, path, &reference, sizes);
    buffer_finish(&reference.text);
    conus_selector_destroy(gl);
    conus_selector_destroy(rays);
}

/* Areas and pathways on three grids, some of them hidden, and cones with all options. */
static void blocks_of_cones_give_the_rows_of_the_rays(void **state)
{
    (void)state;
    uint64_t random = 61;
    conus_atlas *atlas = scene_atlas(&random, 24, 2);
    scene_add_blockers(atlas, &random, (size_t[]){9, 9, 9}, 0.05);
    static const conus_selector_options settings[] = {
        {.resolution = 16},
        {.resolution = 5, .aperture = CONUS_APERTURE_SQUARE, .sampling = CONUS_SAMPLING_SLICES, .slices = 120},
        {.resolution = 9, .layers = CONUS_LAYERS_ALL},
        {.resolution = 12, .range = {5, 25}},
        {.resolution = 8, .radius = 3},
        {.resolution = 50, .score = "distance"}, /* some hundred cones are too many at once */
        {.resolution = 16, .score = "smallest"},
    };
    static const uint32_t sizes[2][2] = {{7, 65536}, {1, 64}}; /* some blocks have a few cones, some nearly all */
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        bool ranged = i % 2 == 0 && settings[i].sampling == CONUS_SAMPLING_EXACT;
        compare_engines(atlas, &settings[i], write_poses(7 + i, atlas, settings[i].radius > 0, ranged), sizes[i % 2]);
    }
    conus_atlas_destroy(atlas);
}

static void a_real_atlas_gives_the_same_rows(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    compare_engines(atlas, &(conus_selector_options){0}, write_poses(3, atlas, false, false),
                    (const uint32_t[]){1, 65536});
    conus_atlas_destroy(atlas);
}

static void add_streamlines(conus_atlas *atlas, uint64_t *random)
{
    enum { STREAMLINES = 20, POINTS = 12 };
    struct tract_builder builder;
    tract_begin(&builder);
    for (int s = 0; s < STREAMLINES; s++) {
        double at[3] = {test_random(random, -12, 12), test_random(random, -12, 12), test_random(random, -12, 12)};
        for (int i = 0; i < POINTS; i++) {
            at[i % 3] += test_random(random, -2, 2);
            tract_add_point(&builder, at);
        }
        tract_end_streamline(&builder);
    }
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "walks"));
}

/* Three soups of triangles, a ball, and voxels and streamlines among them. */
static conus_atlas *mixed_atlas(uint64_t *random)
{
    conus_atlas *atlas = scene_atlas(random, 20, 0);
    struct mesh ball = mesh_scene_sphere((double[]){4, 0, 0}, 9, 40, 60);
    mesh_scene_add_soups(atlas, random);
    mesh_scene_add(atlas, &ball);
    add_streamlines(atlas, random);
    return atlas;
}

static void blocks_do_not_move_the_edges_of_meshes(void **state)
{
    (void)state;
    uint64_t random = 62;
    conus_atlas *atlas = mixed_atlas(&random);
    const char *path = write_poses(5, atlas, false, true);
    static const conus_selector_options settings[] = {{0}, {.resolution = 50}, {.layers = CONUS_LAYERS_ALL}};
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        conus_selector *selector = gl_selector(atlas, settings[i]);
        struct rows reference = {0};
        assert_ok(run_batch(&reference, selector, path, 1, 1));
        assert_same_rows(selector, path, &reference, (const uint32_t[]){7, 65536});
        buffer_finish(&reference.text);
        conus_selector_destroy(selector);
    }
    conus_atlas_destroy(atlas);
}

/* Equal surfaces, of which a pixel lists more than it can hold, and so many that they do not fit into the buffer at
 * once. What does is waited for once. */
static void many_cones_are_what_they_are_alone(void **state)
{
    (void)state;
    enum { COUNT = 80, EDGE = 64 };
    uint64_t random = 63;
    conus_atlas *atlas = mesh_scene_atlas();
    for (int i = 0; i < 12; i++) {
        struct mesh sphere = mesh_scene_sphere((double[]){0, 0, 0}, 10, 8, 16);
        mesh_scene_add(atlas, &sphere);
    }
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    static struct evidence together[COUNT];
    static struct cone cones[COUNT];
    struct evidence *out[COUNT];
    const struct cone *in[COUNT];
    size_t hits = 0;
    for (int i = 0; i < COUNT; i++) {
        cones[i] = mesh_scene_random_cone(&random, 20);
        cones[i].resolution = EDGE;
        in[i] = &cones[i];
        out[i] = &together[i];
        assert_ok(evidence_init(&together[i], EDGE));
    }
    const int before = gl_pair_waits();
    assert_ok(pair.gl->functions->trace_many(pair.gl, out, in, COUNT));
    assert_int_equal(gl_pair_waits() - before, 4); /* with too little room in a pixel, then by 32 cones, which fit */
    assert_ok(pair.gl->functions->trace_many(pair.gl, out, in, 32));
    assert_int_equal(gl_pair_waits() - before, 5);
    for (int i = 0; i < COUNT; i++) {
        struct evidence alone = gl_pair_trace(pair.gl, &cones[i]);
        gl_pair_same_evidence(&together[i], &alone);
        for (size_t pixel = 0; pixel < (size_t)EDGE * EDGE; pixel++) {
            hits += alone.object[pixel] != 0;
        }
        evidence_finish(&alone);
        evidence_finish(&together[i]);
    }
    assert_true(hits > (size_t)EDGE * EDGE * COUNT / 10);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* A cone is a workgroup, of which OpenGL promises 65,535 along an axis, however few pixels it has. */
static void as_many_cones_as_workgroups_are_traced_at_once(void **state)
{
    (void)state;
    static const uint32_t edges[] = {1, 2, 64, 1024};
    uint64_t random = 66;
    conus_atlas *atlas = scene_atlas(&random, 6, 0);
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
        conus_selector *selector = gl_selector(atlas, (conus_selector_options){.resolution = edges[i]});
        assert_in_range(selections_at_once(selector), edges[i] <= 64 ? 2 : 1, 65535);
        conus_selector_destroy(selector);
    }
    conus_atlas_destroy(atlas);
}

/* Pixels that are not wanted have no object, and the wanted ones are the same as among all. */
static void compare_wanted(uint64_t *random, const conus_atlas *atlas)
{
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    for (int round = 0; round < 20; round++) {
        struct cone cone = scene_cone(random, atlas);
        static bool wanted[64 * 64];
        struct evidence all = gl_pair_trace(pair.gl, &cone);
        for (size_t i = 0; i < (size_t)cone.resolution * cone.resolution; i++) {
            wanted[i] = round && test_random(random, 0, 1) < 0.5; /* or none */
            if (!wanted[i]) {
                all.object[i] = 0;
                all.distance[i] = INFINITY;
                all.voxel[i] = EVIDENCE_NO_VOXEL;
            }
        }
        cone.tracing.wanted = wanted;
        struct evidence some = gl_pair_trace(pair.gl, &cone);
        gl_pair_same_evidence(&some, &all);
        evidence_finish(&all);
        evidence_finish(&some);
    }
    gl_pair_destroy(&pair);
}

static void only_wanted_pixels_are_traced(void **state)
{
    (void)state;
    uint64_t random = 64;
    conus_atlas *voxels = scene_atlas(&random, 30, 1);
    conus_atlas *mixed = mixed_atlas(&random);
    compare_wanted(&random, voxels);
    compare_wanted(&random, mixed);
    conus_atlas_destroy(voxels);
    conus_atlas_destroy(mixed);
}

struct trial {
    conus_selector *selector;
    const char *path;
    struct rows wanted;
};

static conus_status run_again(void *data)
{
    struct trial *attempt = data;
    struct rows rows = {0};
    conus_status status = run_batch(&rows, attempt->selector, attempt->path, 40, 1);
    if (!status) {
        assert_int_equal(rows.text.size, attempt->wanted.text.size);
        assert_memory_equal(rows.text.data, attempt->wanted.text.data, rows.text.size);
    }
    buffer_finish(&rows.text);
    return status;
}

/* After any failure the next run of the same selector gives the usual answers. */
static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    uint64_t random = 65;
    conus_atlas *atlas = mixed_atlas(&random);
    struct trial attempt = {.path = write_poses(9, atlas, false, true)};
    conus_selector *another = gl_selector(atlas, (conus_selector_options){.resolution = 4});
    attempt.selector = gl_selector(atlas, (conus_selector_options){.resolution = 4});
    assert_ok(run_batch(&attempt.wanted, another, attempt.path, 40, 1));
    test_every_allocation(run_again, &attempt);
    buffer_finish(&attempt.wanted.text);
    conus_selector_destroy(attempt.selector);
    conus_selector_destroy(another);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(gl_batch)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_of_cones_give_the_rows_of_the_rays),
        cmocka_unit_test(a_real_atlas_gives_the_same_rows),
        cmocka_unit_test(blocks_do_not_move_the_edges_of_meshes),
        cmocka_unit_test(many_cones_are_what_they_are_alone),
        cmocka_unit_test(as_many_cones_as_workgroups_are_traced_at_once),
        cmocka_unit_test(only_wanted_pixels_are_traced),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
