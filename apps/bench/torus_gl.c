/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene by OpenGL: the paper's pass, which draws everything, against the engines. */
#include "apps/bench/bench.h"
#include "apps/bench/edges.h"
#include "apps/bench/torus_scene.h"
#include "base/math3.h"
#include "base/memory.h"
#include "render/context.h"
#include "render/program.h"
#include "render/target.h"
#include "selection/evidence.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, TORI = 20000, CONES = 4, ANGLES = 2, WAYS = 3 };

/* The paper's pass: all tori, each in one instance, identifier and contact instead of colour, no culling. */
struct naive {
    struct gl_context *context;
    GLuint program, vertices, corner_buffer, index_buffer, place_buffer;
    GLint clip_from_world;
    struct target target;
    GLsizei index_count, count;
    float contacts[PIXELS][4];
};

static const char naive_vert[] = "layout(location = 0) in vec3 corner;\n"
                                 "layout(location = 1) in mat4 world_from_torus;\n"
                                 "uniform mat4 clip_from_world;\n"
                                 "out vec3 place;\n"
                                 "flat out uint number;\n"
                                 "void main()\n"
                                 "{\n"
                                 "    vec4 p = world_from_torus * vec4(corner, 1.0);\n"
                                 "    place = p.xyz;\n"
                                 "    number = uint(gl_InstanceID) + 1u;\n"
                                 "    gl_Position = clip_from_world * p;\n"
                                 "}\n";

static const char naive_frag[] = "in vec3 place;\n"
                                 "flat in uint number;\n"
                                 "layout(location = 0) out uint identifier;\n"
                                 "layout(location = 1) out vec4 contact;\n"
                                 "void main()\n"
                                 "{\n"
                                 "    identifier = number;\n"
                                 "    contact = vec4(place, 1.0);\n"
                                 "}\n";

/* ---- The naive pass ------------------------------------------------------------------------------------------- */

static conus_status upload_places(struct naive *naive, const struct torus_scene *scene)
{
    float(*places)[16] = memory_raw(scene->count, sizeof *places);
    if (!places) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < 16 * scene->count; i++) {
        places[i / 16][i % 16] = (float)scene->places[i / 16][i % 16];
    }
    glCreateBuffers(1, &naive->place_buffer);
    glNamedBufferStorage(naive->place_buffer, (GLsizeiptr)(scene->count * sizeof *places), places, 0);
    memory_free(places);
    return CONUS_OK;
}

static void make_vertices(struct naive *naive, const struct mesh *torus)
{
    glCreateBuffers(1, &naive->corner_buffer);
    glNamedBufferStorage(naive->corner_buffer, (GLsizeiptr)(12 * torus->vertex_count), torus->positions, 0);
    glCreateBuffers(1, &naive->index_buffer);
    glNamedBufferStorage(naive->index_buffer, (GLsizeiptr)(12 * torus->triangle_count), torus->triangles, 0);
    glCreateVertexArrays(1, &naive->vertices);
    glVertexArrayVertexBuffer(naive->vertices, 0, naive->corner_buffer, 0, 12);
    glVertexArrayVertexBuffer(naive->vertices, 1, naive->place_buffer, 0, 64);
    glVertexArrayElementBuffer(naive->vertices, naive->index_buffer);
    glVertexArrayBindingDivisor(naive->vertices, 1, 1);
    for (GLuint k = 0; k < 5; k++) {
        glEnableVertexArrayAttrib(naive->vertices, k);
        glVertexArrayAttribFormat(naive->vertices, k, k ? 4 : 3, GL_FLOAT, GL_FALSE, k ? 16 * (k - 1) : 0);
        glVertexArrayAttribBinding(naive->vertices, k, k ? 1 : 0);
    }
    naive->index_count = (GLsizei)(3 * torus->triangle_count);
}

/* With the context current. */
static conus_status fill(struct naive *naive, const struct torus_scene *scene)
{
    static const struct program_source source = {.vertex = {"naive.vert", naive_vert},
                                                 .fragment = {"naive.frag", naive_frag}};
    static const struct target_attachment attachments[] = {
        {"identifier", TARGET_UINT}, {"contact", TARGET_FLOAT4}, {"depth", TARGET_DEPTH}};
    conus_status status = program_create(&naive->program, &source);
    if (!status) {
        naive->clip_from_world = program_uniform(naive->program, "clip_from_world");
        naive->count = (GLsizei)scene->count;
        status = upload_places(naive, scene);
    }
    if (!status) {
        make_vertices(naive, &scene->torus);
        status = gl_check("tori");
    }
    return status ? status : target_init(&naive->target, TORUS_RESOLUTION, TORUS_RESOLUTION, attachments, 3);
}

static conus_status naive_init(struct naive *naive, const struct torus_scene *scene)
{
    struct gl_current previous;
    conus_status status = gl_context_create(&naive->context, NULL, NULL);
    status = status ? status : gl_context_use(naive->context, &previous);
    if (!status) {
        status = fill(naive, scene);
        gl_current_restore(&previous);
    }
    return status;
}

static void clip_matrix(float out[16], const struct cone *cone)
{
    const double near = 0.1;
    const double far = 1e4;
    double slope = tan(cone->angle / 2);
    double m[16] = {0};
    mat4_invert_affine(m, cone->pose.world_from_device);
    for (int column = 0; column < 4; column++) {
        const double *v = m + 4 * column;
        double w = column == 3;
        out[4 * column] = (float)(v[0] / slope);
        out[4 * column + 1] = (float)(v[1] / slope);
        out[4 * column + 2] = (float)(-v[2] * (far + near) / (far - near) - 2 * w * far * near / (far - near));
        out[4 * column + 3] = (float)-v[2];
    }
}

static conus_status naive_look(struct naive *naive, uint32_t *identifiers, const struct cone *cone)
{
    struct gl_current previous;
    float matrix[16];
    conus_status status = gl_context_use(naive->context, &previous);
    if (status) {
        return status;
    }
    clip_matrix(matrix, cone);
    target_clear(&naive->target);
    glUseProgram(naive->program);
    glUniformMatrix4fv(naive->clip_from_world, 1, GL_FALSE, matrix);
    glBindVertexArray(naive->vertices);
    glDrawElementsInstanced(GL_TRIANGLES, naive->index_count, GL_UNSIGNED_INT, NULL, naive->count);
    status = target_read(&naive->target, "identifier", identifiers);
    status = status ? status : target_read(&naive->target, "contact", naive->contacts);
    gl_current_restore(&previous);
    return status;
}

/* ---- The ways to look ------------------------------------------------------------------------------------------ */

struct way {
    const struct cone *cones;
    struct naive *naive;
    struct engine *engine; /* or the naive pass */
    struct evidence answers[CONES];
    conus_status status;
};

static void answer(void *data)
{
    struct way *way = data;
    for (int i = 0; i < CONES; i++) {
        conus_status status = way->engine ? way->engine->functions->look(way->engine, &way->answers[i], &way->cones[i])
                                          : naive_look(way->naive, way->answers[i].object, &way->cones[i]);
        way->status = status ? status : way->status;
    }
}

/* The same identifiers as the rays', but for pixels whose centre lies on an edge. */
static bool is_equal(const struct way *way, const struct way *rays, const char *name)
{
    struct bench_differences differences = {0};
    for (int i = 0; i < CONES; i++) {
        bench_compare_pixels(&differences, rays->engine, &way->cones[i], way->answers[i].object,
                             rays->answers[i].object);
    }
    return bench_differences_pass(&differences, name, (size_t)CONES * PIXELS) && !way->status;
}

/* ---- The scenario ---------------------------------------------------------------------------------------------- */

struct gl_round {
    struct torus_scene scene;
    conus_atlas *atlas;
    struct engine *gl, *rays;
    struct naive naive;
    struct cone cones[ANGLES][CONES];
    struct way ways[ANGLES][WAYS];
};

static const double angles[ANGLES] = {5, 20};

static conus_status ways_init(struct gl_round *round)
{
    conus_status status = CONUS_OK;
    for (int k = 0; k < ANGLES * WAYS; k++) {
        struct way *way = &round->ways[k / WAYS][k % WAYS];
        struct engine *engines[WAYS] = {NULL, round->gl, round->rays};
        way->cones = round->cones[k / WAYS];
        way->naive = &round->naive;
        way->engine = engines[k % WAYS];
        for (int i = 0; i < CONES && !status; i++) {
            status = evidence_init(&way->answers[i], TORUS_RESOLUTION);
        }
    }
    return status;
}

static conus_status round_init(struct gl_round *round, const struct bench_options *options)
{
    conus_status status = torus_scene_init(&round->scene, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&round->atlas, &round->scene);
    status = status ? status : engine_gl_create(&round->gl, round->atlas, &(struct engine_options){0});
    status = status ? status : engine_rays_create(&round->rays, round->atlas, &(struct engine_options){0});
    status = status ? status : naive_init(&round->naive, &round->scene);
    for (int a = 0; a < ANGLES && !status; a++) {
        torus_scene_cones(round->cones[a], &round->scene, CONES, angles[a]);
    }
    return status ? status : ways_init(round);
}

static void naive_finish(struct naive *naive)
{
    struct gl_current previous;
    if (naive->context && !gl_context_use(naive->context, &previous)) {
        target_finish(&naive->target);
        gl_current_restore(&previous);
    }
    gl_context_destroy(naive->context); /* and what was made in it */
}

static void round_finish(struct gl_round *round)
{
    for (int k = 0; k < ANGLES * WAYS * CONES; k++) {
        evidence_finish(&round->ways[k / (WAYS * CONES)][k / CONES % WAYS].answers[k % CONES]);
    }
    naive_finish(&round->naive);
    engine_destroy(round->gl);
    engine_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    torus_scene_finish(&round->scene);
}

static conus_status measure(struct bench *bench, struct gl_round *round)
{
    static const char *const names[ANGLES][WAYS] = {
        {"20000 tori, all drawn, 5 degrees", "20000 tori, gl engine, 5 degrees", "20000 tori, rays engine, 5 degrees"},
        {"20000 tori, all drawn, 20 degrees", "20000 tori, gl engine, 20 degrees",
         "20000 tori, rays engine, 20 degrees"}};
    struct bench_variant variants[ANGLES][WAYS] = {0};
    conus_status status = CONUS_OK;
    for (int a = 0; a < ANGLES && !status; a++) {
        for (int w = WAYS; w-- > 0;) { /* the rays first, with which the others are compared */
            struct way *way = &round->ways[a][w];
            answer(way);
            variants[a][w] = (struct bench_variant){.name = names[a][w], .run = answer, .data = way};
            variants[a][w].equal = is_equal(way, &round->ways[a][WAYS - 1], names[a][w]);
        }
        status = bench_measure(bench, "torus", variants[a], WAYS, CONES, angles[a]);
    }
    status = status ? status : bench_ratio(bench, "naive_over_rays", &variants[0][0], &variants[0][2]);
    status = status ? status : bench_ratio(bench, "naive_over_gl", &variants[0][0], &variants[0][1]);
    return status ? status : bench_ratio(bench, "naive_over_gl_20deg", &variants[1][0], &variants[1][1]);
}

conus_status bench_torus_gl(struct bench *bench)
{
    static struct gl_round round;
    memset(&round, 0, sizeof round);
    setenv("LP_NUM_THREADS", "0", 0); /* Mesa's llvmpipe stays on this thread, whose time is taken */
    conus_status status = round_init(&round, &bench->options);
    if (status == CONUS_ERROR_GL) {
        status = bench_leave_out(bench, "torus by OpenGL");
        round_finish(&round);
        return status;
    }
    if (!status) {
        bench->one_thread = strstr(round.gl->name, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "%.60s; %.60s", round.gl->name, round.rays->name);
        status = measure(bench, &round);
    }
    round_finish(&round);
    return status;
}
