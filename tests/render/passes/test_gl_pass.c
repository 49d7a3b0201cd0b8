/* SPDX-License-Identifier: BSD-3-Clause */
/* The ID pass by itself: identifiers, GL state, memory limits. */
#include "base/geometry/math3.h"
#include "render/colour/colour.h"
#include "render/passes/id_pass.h"
#include "test.h"
#include "test_gl.h"

#include <string.h>

enum { RAYS = 9, OBJECTS = 6 };

/* A row of voxels along x, each with its own object 1, 2, ...; rays come from above, one per voxel. */
static uint16_t row_objects[RAYS];
static const struct volume row = {.info = {.dim = {RAYS, 1, 1}}, .voxel_count = RAYS, .objects16 = row_objects};

static uint8_t row_codes[RAYS];
static const struct id_distances row_distances = {.codes = row_codes, .box = {{0}, {RAYS - 1, 0, 0}}};

/* Aims the pass. With sampling on planes there are `planes` of them from depth 10 on, 1 mm apart. */
static void aim_from_above(struct id_pass *pass, double height, conus_sampling sampling, double planes)
{
    struct id_ray *rays = id_pass_rays(pass);
    for (int i = 0; i < RAYS; i++) {
        rays[i] = (struct id_ray){.origin = {i, 0, height}, .direction = {0, 0, -1}};
        if (sampling == CONUS_SAMPLING_SLICES) {
            rays[i].planes.start = 9.5;
            rays[i].planes.spacing = 1;
            rays[i].planes.count = planes;
            rays[i].planes.per_depth = 1;
        } else {
            rays[i].inverse[0] = rays[i].inverse[1] = INFINITY;
            rays[i].inverse[2] = -1;
        }
    }
}

static struct id_pass *row_pass(conus_sampling sampling, const uint32_t *identifiers)
{
    for (int i = 0; i < RAYS; i++) {
        row_objects[i] = (uint16_t)(i % (OBJECTS + 1));
    }
    struct id_pass *pass = NULL;
    uint64_t memory = 1 << 20;
    assert_ok(id_pass_create(&pass, sampling, identifiers, OBJECTS + 1));
    for (int i = 0; i < RAYS; i++) {
        row_codes[i] = row_objects[i] == 0;
    }
    assert_ok(id_pass_add_volume(pass, &row, &row_distances, &memory));
    assert_ok(id_pass_add_volume(pass, &row, &row_distances, &memory));
    assert_true(memory < 1 << 20);
    return pass;
}

static const struct id_hit *trace_row(struct id_pass *pass, conus_sampling sampling, double height)
{
    const struct id_hit *hits;
    assert_ok(id_pass_begin(pass, RAYS));
    aim_from_above(pass, height, sampling, 1);
    assert_ok(id_pass_trace(pass, 0));
    assert_ok(id_pass_read(pass, &hits));
    return hits;
}

/* Identifiers stay integers throughout: no float, filter or blending would preserve these. 0 is invisible. */
static const uint32_t hard_identifiers[OBJECTS + 1] = {0, 7, 65537, 16777217, 0, 4000000001u, 4294967295u};

static void assert_row(const struct id_hit *hits, double distance)
{
    for (uint32_t i = 0; i < RAYS; i++) {
        uint32_t wanted = hard_identifiers[row_objects[i]];
        assert_int_equal(hits[i].identifier, wanted);
        assert_true(hits[i].distance == (wanted ? distance : INFINITY));
        if (wanted) {
            assert_int_equal(hits[i].cell[0], i);
            assert_int_equal(hits[i].cell[1] + hits[i].cell[2], 0);
        }
    }
}

/* Eq. 5, Eq. 6, Eq. 7: all programs, made from every combination of defines. */
static void identifiers_keep_every_bit(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    const conus_sampling samplings[] = {CONUS_SAMPLING_EXACT, CONUS_SAMPLING_SLICES};
    for (size_t i = 0; i < 2; i++) {
        struct id_pass *pass = row_pass(samplings[i], hard_identifiers);
        assert_row(trace_row(pass, samplings[i], 10), samplings[i] == CONUS_SAMPLING_EXACT ? 9.5 : 10);
        id_pass_destroy(pass);
    }
    id_pass_destroy(NULL);
    test_gl_leave(&gl);
}

/* Blending, dithering, scissors, masks and other state that another user of the context has left on change nothing. */
static void state_left_behind_changes_nothing(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    struct id_pass *pass = row_pass(CONUS_SAMPLING_EXACT, hard_identifiers);
    static const GLenum left_on[] = {GL_BLEND,        GL_DITHER,     GL_CULL_FACE,         GL_MULTISAMPLE,
                                     GL_SCISSOR_TEST, GL_DEPTH_TEST, GL_RASTERIZER_DISCARD};
    for (size_t i = 0; i < sizeof left_on / sizeof left_on[0]; i++) {
        glEnable(left_on[i]);
    }
    glCullFace(GL_FRONT_AND_BACK);
    glScissor(0, 0, 1, 1);
    glBlendFunc(GL_ZERO, GL_ONE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glDepthFunc(GL_NEVER);
    assert_row(trace_row(pass, CONUS_SAMPLING_EXACT, 10), 9.5);
    id_pass_destroy(pass);
    test_gl_leave(&gl);
}

/* Hits of an earlier trace do not remain in the buffers, which may grow. */
static void traces_start_from_nothing(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    struct id_pass *pass = row_pass(CONUS_SAMPLING_EXACT, hard_identifiers);
    assert_int_equal(trace_row(pass, CONUS_SAMPLING_EXACT, 10)[1].identifier, 7);
    const struct id_hit *hits = trace_row(pass, CONUS_SAMPLING_EXACT, -10); /* looking away */
    for (int i = 0; i < RAYS; i++) {
        assert_int_equal(hits[i].identifier, 0);
    }
    assert_ok(id_pass_begin(pass, 100000));
    assert_row(trace_row(pass, CONUS_SAMPLING_EXACT, 10), 9.5);
    id_pass_destroy(pass);
    test_gl_leave(&gl);
}

/* The second of two volumes is nearer, farther, or as near. */
static void the_nearer_volume_stays(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    struct id_pass *pass = row_pass(CONUS_SAMPLING_EXACT, hard_identifiers);
    const double second[] = {4, 30, 10};
    for (int i = 0; i < 3; i++) {
        const struct id_hit *hits;
        assert_ok(id_pass_begin(pass, RAYS));
        aim_from_above(pass, 10, CONUS_SAMPLING_EXACT, 0);
        assert_ok(id_pass_trace(pass, 0));
        aim_from_above(pass, second[i], CONUS_SAMPLING_EXACT, 0);
        assert_ok(id_pass_trace(pass, 1));
        assert_ok(id_pass_read(pass, &hits));
        assert_row(hits, fmin(10, second[i]) - 0.5);
    }
    id_pass_destroy(pass);
    test_gl_leave(&gl);
}

/* A volume behind the eye has no planes. */
static void rays_without_planes_hit_nothing(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    struct id_pass *pass = row_pass(CONUS_SAMPLING_SLICES, hard_identifiers);
    const struct id_hit *hits;
    assert_ok(id_pass_begin(pass, RAYS));
    aim_from_above(pass, 10, CONUS_SAMPLING_SLICES, 0);
    assert_ok(id_pass_trace(pass, 0));
    assert_ok(id_pass_read(pass, &hits));
    for (int i = 0; i < RAYS; i++) {
        assert_int_equal(hits[i].identifier, 0);
    }
    aim_from_above(pass, 10, CONUS_SAMPLING_SLICES, 3);
    assert_ok(id_pass_trace(pass, 1));
    assert_ok(id_pass_read(pass, &hits));
    assert_row(hits, 10);
    id_pass_destroy(pass);
    test_gl_leave(&gl);
}

static void textures_beyond_the_allowed_memory_are_refused(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    struct id_pass *pass = NULL;
    uint64_t memory = sizeof row_objects; /* none is left for the codes */
    assert_ok(id_pass_create(&pass, CONUS_SAMPLING_EXACT, hard_identifiers, OBJECTS + 1));
    assert_fails(id_pass_add_volume(pass, &row, &row_distances, &memory), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "allowed memory"));
    id_pass_destroy(pass);
    test_gl_leave(&gl);
}

/* Distance from `brick` to the nearest occupied one, by trying all. */
static size_t brute_distance(const struct bricks *bricks, const bool *occupied, const size_t brick[3])
{
    size_t least = UINT8_MAX;
    for (size_t b = 0; b < bricks->dim[0] * bricks->dim[1] * bricks->dim[2]; b++) {
        size_t at[3] = {b % bricks->dim[0], b / bricks->dim[0] % bricks->dim[1], b / bricks->dim[0] / bricks->dim[1]};
        size_t distance = 0;
        for (int a = 0; a < 3; a++) {
            size_t apart = at[a] > brick[a] ? at[a] - brick[a] : brick[a] - at[a];
            distance = apart > distance ? apart : distance;
        }
        least = occupied[b] && distance < least ? distance : least;
    }
    return least;
}

static void brick_at(size_t out[3], const struct bricks *bricks, size_t b)
{
    out[0] = b % bricks->dim[0];
    out[1] = b / bricks->dim[0] % bricks->dim[1];
    out[2] = b / bricks->dim[0] / bricks->dim[1];
}

static void bricks_know_their_distance(void **state)
{
    (void)state;
    uint64_t random = 3;
    for (int round = 0; round < 30; round++) {
        uint8_t distance[10 * 10 * 10];
        bool occupied[10 * 10 * 10] = {false};
        struct bricks bricks = {.distance = distance};
        size_t count = 1;
        size_t at[3];
        for (int a = 0; a < 3; a++) {
            bricks.dim[a] = 1 + (size_t)test_random(&random, 0, 10);
            count *= bricks.dim[a];
        }
        for (int n = round % 6; n > 0; n--) {
            occupied[(size_t)test_random(&random, 0, (double)count)] = true;
        }
        for (size_t b = 0; b < count; b++) {
            distance[b] = occupied[b] ? 0 : UINT8_MAX;
        }
        bricks_spread(&bricks);
        for (size_t b = 0; b < count; b++) {
            brick_at(at, &bricks, b);
            assert_int_equal(distance[b], brute_distance(&bricks, occupied, at));
        }
    }
}

TEST_GROUP(gl_pass)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identifiers_keep_every_bit),
        cmocka_unit_test(state_left_behind_changes_nothing),
        cmocka_unit_test(traces_start_from_nothing),
        cmocka_unit_test(the_nearer_volume_stays),
        cmocka_unit_test(rays_without_planes_hit_nothing),
        cmocka_unit_test(textures_beyond_the_allowed_memory_are_refused),
        cmocka_unit_test(bricks_know_their_distance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
