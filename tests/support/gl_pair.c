/* SPDX-License-Identifier: BSD-3-Clause */
/* Both engines for one atlas, and comparisons of their answers. */
#include "gl_pair.h"

#include "base/geometry/math3.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/engine/engine.h"
#include "test.h"
#include "test_gl.h"

#include <string.h>

static int messages;

void gl_pair_log(void *user, const conus_note *note)
{
    (void)user;
    messages += note->severity >= CONUS_SEVERITY_WARNING;
    print_message("%s\n", note->line);
}

int gl_pair_messages(void)
{
    return messages;
}

static PFNGLCLIENTWAITSYNCPROC driver_wait;
static PFNGLFINISHPROC driver_finish;
static PFNGLGETNAMEDBUFFERSUBDATAPROC driver_read;
static int waits;

static GLenum GLAPIENTRY wait_and_count(GLsync fence, GLbitfield flags, GLuint64 limit)
{
    GLenum answer = driver_wait(fence, flags, limit);
    waits += answer != GL_TIMEOUT_EXPIRED; /* else it is not over */
    return answer;
}

static void GLAPIENTRY finish_and_count(void)
{
    waits++;
    driver_finish();
}

static void GLAPIENTRY read_and_count(GLuint buffer, GLintptr first, GLsizeiptr size, void *data)
{
    waits++;
    driver_read(buffer, first, size, data);
}

int gl_pair_waits(void)
{
    if (!driver_wait) {
        driver_wait = glClientWaitSync;
        driver_finish = glFinish;
        driver_read = glGetNamedBufferSubData;
        glClientWaitSync = wait_and_count;
        glFinish = finish_and_count;
        glGetNamedBufferSubData = read_and_count;
    }
    return waits;
}

void the_driver_was_silent(void **state)
{
    (void)state;
    assert_int_equal(messages, 0);
}

struct gl_pair gl_pair_create_slices(const conus_atlas *atlas, conus_sampling sampling, uint32_t slices,
                                     double fraction)
{
    const struct engine_options options = {
        .sampling = sampling, .slices = slices, .slice_fraction = fraction, .log = gl_pair_log};
    struct gl_pair pair = {.atlas = atlas};
    assert_gl(engine_gl_create(&pair.gl, atlas, &options));
    assert_memory_equal(pair.gl->name, "gl, ", 4);
    assert_ok(engine_rays_create(&pair.rays, atlas, &options));
    return pair;
}

struct gl_pair gl_pair_create(const conus_atlas *atlas, conus_sampling sampling)
{
    return gl_pair_create_slices(atlas, sampling, 0, 0);
}

void gl_pair_destroy(struct gl_pair *pair)
{
    engine_destroy(pair->gl);
    engine_destroy(pair->rays);
}

struct evidence gl_pair_trace(struct engine *engine, const struct cone *cone)
{
    struct evidence evidence;
    assert_ok(evidence_init(&evidence, cone->resolution));
    memset(evidence.object, 0xff, (size_t)cone->resolution * cone->resolution * sizeof *evidence.object);
    assert_ok(engine->functions->trace(engine, &evidence, cone));
    return evidence;
}

struct layers gl_pair_pierce(struct engine *engine, const struct cone *cone)
{
    struct layers layers = {0};
    assert_ok(engine->functions->pierce(engine, &layers, cone));
    assert_ok(layers_sort(&layers, (size_t)cone->resolution * cone->resolution));
    return layers;
}

void gl_pair_same_evidence(const struct evidence *got, const struct evidence *wanted)
{
    size_t different = 0;
    for (size_t i = 0; i < (size_t)wanted->resolution * wanted->resolution; i++) {
        bool same = got->object[i] == wanted->object[i] && got->voxel[i] == wanted->voxel[i] &&
                    got->distance[i] == wanted->distance[i];
        if (!same && ++different <= 3) {
            print_message("pixel %zu of %u x %u: object %u, voxel %llu, %.17g mm; wanted %u, %llu, %.17g\n", i,
                          got->resolution, got->resolution, got->object[i], (unsigned long long)got->voxel[i],
                          got->distance[i], wanted->object[i], (unsigned long long)wanted->voxel[i],
                          wanted->distance[i]);
        }
    }
    assert_int_equal(different, 0);
}

size_t gl_pair_same_hits(const struct gl_pair *pair, const struct cone *cone)
{
    struct evidence got = gl_pair_trace(pair->gl, cone);
    struct evidence wanted = gl_pair_trace(pair->rays, cone);
    size_t hits = 0;
    gl_pair_same_evidence(&got, &wanted);
    for (size_t i = 0; i < (size_t)cone->resolution * cone->resolution; i++) {
        hits += wanted.object[i] != 0;
    }
    evidence_finish(&got);
    evidence_finish(&wanted);
    return hits;
}

bool gl_pair_same_interval(const conus_interval *a, const conus_interval *b)
{
    return a->pixel == b->pixel && a->object == b->object && a->entry == b->entry && a->exit == b->exit &&
           a->voxel == b->voxel;
}

void gl_pair_compare_poses(struct gl_counts *counts, uint64_t *state, const conus_atlas *atlas, gl_comparison compare,
                           double size, int poses, int cylinder)
{
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    pair.counts = *counts;
    for (int pose = 1; pose <= poses; pose++) {
        struct cone cone = mesh_scene_random_cone(state, size);
        if (cylinder && pose % cylinder == 0) { /* Eq. 3: parallel rays */
            cone.angle = 0;
            cone.radius = size * test_random(state, 0.02, 0.4);
        }
        compare(&pair, &cone);
    }
    *counts = pair.counts;
    gl_pair_destroy(&pair);
}

void gl_pair_compare_triangles(struct gl_counts *counts, uint64_t *state, gl_comparison compare, int scenes,
                               int cylinder)
{
    for (int scene = 0; scene < scenes; scene++) {
        conus_atlas *atlas = mesh_scene_atlas();
        double size = pow(10, test_random(state, 0, 3));
        for (int k = 0; k < 1 + scene % 6; k++) {
            size_t triangles = 1 + (size_t)test_random(state, 0, scene % 5 ? 60 : 2000);
            struct mesh soup = mesh_scene_soup(state, triangles, size, size * test_random(state, 0.05, 0.6));
            mesh_scene_add(atlas, &soup);
        }
        gl_pair_compare_poses(counts, state, atlas, compare, size, 10, cylinder);
        conus_atlas_destroy(atlas);
    }
}

void gl_pair_compare_mixed(struct gl_counts *counts, uint64_t *state, gl_comparison compare, int scenes)
{
    for (int scene = 0; scene < scenes; scene++) {
        conus_atlas *atlas = scene_atlas(state, 20, 0);
        mesh_scene_add_soups(atlas, state);
        struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
        pair.counts = *counts;
        for (int pose = 0; pose < 10; pose++) {
            struct cone cone = {.pose = scene_pose(state, atlas), .resolution = 16};
            cone.angle = radians_from_degrees(test_random(state, 1, 90));
            compare(&pair, &cone);
        }
        *counts = pair.counts;
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
}

struct attempt {
    const conus_atlas *atlas;
    const struct cone *cone;
    bool layers;
};

static conus_status create_answer_destroy(void *data)
{
    const struct attempt *attempt = data;
    const struct engine_options options = {0};
    struct engine *engine = NULL;
    struct evidence evidence;
    struct layers layers = {0};
    conus_status status = evidence_init(&evidence, attempt->cone->resolution);
    if (status) {
        return status;
    }
    status = engine_gl_create(&engine, attempt->atlas, &options);
    if (!status) {
        status = attempt->layers ? engine->functions->pierce(engine, &layers, attempt->cone)
                                 : engine->functions->trace(engine, &evidence, attempt->cone);
    }
    engine_destroy(engine);
    layers_finish(&layers);
    evidence_finish(&evidence);
    return status;
}

void gl_pair_every_allocation(const conus_atlas *atlas, const struct cone *cone, bool layers)
{
    struct attempt attempt = {atlas, cone, layers};
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT); /* or skips */
    gl_pair_destroy(&pair);
    test_every_allocation(create_answer_destroy, &attempt);
}
