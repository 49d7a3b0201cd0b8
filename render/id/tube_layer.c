/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads the streamlines of an atlas and draws them for a camera. */
#include "render/id/tube_layer.h"

#include "atlas/bundles.h"
#include "base/buffer.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/context.h"
#include "render/gl/program.h"
#include "render/gl/shaders.h"

#include <string.h>

/* Dark blue, green, yellow: lighter from step to step, so that the order shows without hues, too. */
static const double ramp[TUBE_RAMP_STEPS + 1][3] = {
    {34, 46, 110}, {36, 104, 142}, {40, 156, 128}, {138, 204, 84}, {250, 230, 80}};

void tube_scalar_colour(uint8_t rgb[3], double part)
{
    if (isnan(part)) {
        memset(rgb, TUBE_UNKNOWN, 3);
        return;
    }
    double at = fmin(fmax(part, 0), 1) * TUBE_RAMP_STEPS;
    int step = at < TUBE_RAMP_STEPS ? (int)at : TUBE_RAMP_STEPS - 1;
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)(ramp[step][c] + (at - step) * (ramp[step + 1][c] - ramp[step][c]) + 0.5);
    }
}

void tube_direction_colour(uint8_t rgb[3], const double direction[3])
{
    double unit[3];
    if (!vec3_normalise(unit, direction)) {
        memset(rgb, TUBE_UNKNOWN, 3);
        return;
    }
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)(255 * fabs(unit[c]) + 0.5);
    }
}

static const struct tract_scalar *find_scalar(const struct tractogram *tractogram, const char *name)
{
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        if (tractogram->scalars[i].components == 1 && strcmp(tractogram->scalars[i].name, name) == 0) {
            return &tractogram->scalars[i];
        }
    }
    return NULL;
}

/* The range over all tractograms that have the number; false where none has, or no value is finite. */
static bool find_range(struct tube_colouring *out, const conus_atlas *atlas, const char *name)
{
    bool found = false;
    out->low = INFINITY;
    out->high = -INFINITY;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tract_scalar *scalar = find_scalar(&atlas->tractograms[i], name);
        size_t count =
            scalar ? (scalar->per_point ? atlas->tractograms[i].point_count : atlas->tractograms[i].streamline_count)
                   : 0;
        found = found || scalar;
        for (size_t v = 0; v < count; v++) {
            double value = (double)scalar->values[v];
            out->low = isfinite(value) ? fmin(out->low, value) : out->low;
            out->high = isfinite(value) ? fmax(out->high, value) : out->high;
        }
    }
    return found;
}

static conus_status fail_unknown(const conus_atlas *atlas, const char *name)
{
    struct buffer names = {0};
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tractogram *tractogram = &atlas->tractograms[i];
        for (size_t s = 0; s < tractogram->scalar_count; s++) {
            if (tractogram->scalars[s].components == 1) {
                buffer_format(&names, ", %s", tractogram->scalars[s].name);
            }
        }
    }
    conus_status status = buffer_status(&names);
    status = status ? status
                    : fail(CONUS_ERROR_ARGUMENT, "colour of streamlines: %s is none of bundle, direction%s", name,
                           names.data ? names.data : "");
    buffer_finish(&names);
    return status;
}

conus_status tube_colouring_choose(struct tube_colouring *out, const conus_atlas *atlas, const char *name)
{
    struct tube_colouring made = {0};
    if (name && !atlas->tractogram_count) {
        return fail(CONUS_ERROR_ARGUMENT, "colour of streamlines: the atlas has none");
    }
    if (name && strcmp(name, "direction") == 0) {
        made.by = TUBE_BY_DIRECTION;
    } else if (name && strcmp(name, "bundle") != 0) {
        if (!find_range(&made, atlas, name)) {
            return fail_unknown(atlas, name);
        }
        made.by = TUBE_BY_SCALAR;
        made.scalar = memory_text(name, strlen(name));
        if (!made.scalar) {
            return CONUS_ERROR_MEMORY;
        }
    }
    *out = made;
    return CONUS_OK;
}

void tube_colouring_finish(struct tube_colouring *colouring)
{
    memory_free(colouring->scalar);
    *colouring = (struct tube_colouring){0};
}

/* Where the number lies in its range; for a segment the mean of its ends. */
static double scalar_part(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                          uint64_t index)
{
    const struct tract_scalar *scalar = find_scalar(tractogram, colouring->scalar);
    if (!scalar) {
        return NAN;
    }
    uint64_t next = index + 1 < tractogram->first[number + 1] ? index + 1 : index;
    double value = scalar->per_point ? ((double)scalar->values[index] + (double)scalar->values[next]) / 2
                                     : (double)scalar->values[number];
    double span = colouring->high - colouring->low;
    return span > 0 || isnan(value) ? (value - colouring->low) / span : 0.5;
}

static uint32_t own_colour(const uint8_t rgb[3])
{
    return TUBE_OWN_COLOUR | rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16;
}

uint32_t tube_colour(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                     uint64_t index, uint32_t object)
{
    uint8_t rgb[3];
    if (colouring->by == TUBE_BY_BUNDLE) {
        return object;
    }
    if (colouring->by == TUBE_BY_SCALAR) {
        tube_scalar_colour(rgb, scalar_part(colouring, tractogram, number, index));
        return own_colour(rgb);
    }
    double from[3], along[3];
    tractogram_point(from, tractogram, index);
    memset(along, 0, sizeof along);
    for (uint64_t next = index + 1; vec3_dot(along, along) == 0 && next < tractogram->first[number + 1]; next++) {
        tractogram_point(along, tractogram, next); /* a point may be there twice */
        vec3_sub(along, along, from);
    }
    tube_direction_colour(rgb, along);
    return own_colour(rgb);
}

#define TUBE_BALL 0x20000000U /* as in tube.vert.glsl */

/* Streamlines are taken in TURNS turns, a prime, so that no order of a file repeats with them. Each turn begins
 * SECTION, a golden section of them, behind the one before. */
enum { TURNS = 67, SECTION = 41 };

/* Instances that are drawn before the listener may cancel. */
enum { PIECE = 50000 };

/* The instances of a tractogram: one for each point that is drawn, those of a draft first. */
struct range {
    GLint first;
    GLsizei count, draft;
    float radius;
};

struct tube_layer {
    const conus_atlas *atlas;
    GLuint program, vertices, points, paints;
    GLint eye, camera_from_world, world_from_camera, shift, size, radius;
    struct range *ranges; /* [range_count] of the atlas's tractograms */
    size_t range_count;
    size_t step;    /* every step-th streamline is drawn */
    uint64_t *kept; /* [point_count] Points that are drawn, of one tractogram after the other. */
    size_t point_count;
};

/* Many files have a point every tenth of a millimetre. Points are left out where the straight line past them stays
 * within FLATNESS radii and is no longer than LONGEST radii: the form and the colours do not suffer. */
static const double FLATNESS = 0.04;
static const double LONGEST = 4;

/* Whether all points between `from` and `to` are that near to the line between them. */
static bool is_straight(const struct tractogram *tractogram, uint64_t from, uint64_t to)
{
    double a[3];
    double step[3];
    const double radius = tractogram->radius;
    tractogram_point(a, tractogram, from);
    tractogram_point(step, tractogram, to);
    vec3_sub(step, step, a);
    double square = vec3_dot(step, step);
    bool fine = square <= LONGEST * LONGEST * radius * radius;
    for (uint64_t i = from + 1; i < to && fine; i++) {
        double p[3];
        tractogram_point(p, tractogram, i);
        vec3_sub(p, p, a);
        double s = square > 0 ? fmin(fmax(vec3_dot(p, step) / square, 0), 1) : 0;
        vec3_add_scaled(p, p, -s, step);
        fine = vec3_dot(p, p) <= FLATNESS * FLATNESS * radius * radius;
    }
    return fine;
}

/* Appends the drawn points of streamline `k` to layer->kept. */
static conus_status keep_streamline(struct tube_layer *layer, size_t *capacity, const struct tractogram *tractogram,
                                    size_t k)
{
    uint64_t end = tractogram->first[k + 1];
    for (uint64_t at = tractogram->first[k], next; at < end; at = next) {
        if (!memory_reserve(&layer->kept, capacity, layer->point_count + 1, sizeof *layer->kept)) {
            return CONUS_ERROR_MEMORY;
        }
        layer->kept[layer->point_count++] = at;
        next = at + 1;
        while (next < end - 1 && is_straight(tractogram, at, next + 1)) {
            next++;
        }
    }
    return CONUS_OK;
}

/* Keeps points of every step-th streamline, in TURNS rounds that take every TURNS-th of them. So the first points,
 * however many, come from everywhere in the file. A draft has the same fraction of each tractogram. CONUS_ERROR_MEMORY.
 */
static conus_status keep_points(struct tube_layer *layer)
{
    size_t capacity = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < layer->range_count && !status; i++) {
        const struct tractogram *tractogram = &layer->atlas->tractograms[i];
        size_t before = layer->point_count;
        for (size_t turn = 0; turn < TURNS; turn++) {
            size_t k = turn * SECTION % TURNS * layer->step;
            for (; k < tractogram->streamline_count && !status; k += TURNS * layer->step) {
                status = keep_streamline(layer, &capacity, tractogram, k);
            }
        }
        layer->ranges[i] = (struct range){.first = (GLint)before,
                                          .count = (GLsizei)(layer->point_count - before),
                                          .radius = (float)tractogram->radius};
    }
    double part = fmin(1, TUBE_DRAFT_LIMIT / fmax(1, (double)layer->point_count));
    for (size_t i = 0; i < layer->range_count; i++) {
        layer->ranges[i].draft = (GLsizei)ceil(part * layer->ranges[i].count);
    }
    return status;
}

/* The last point stands twice: each instance also reads the one behind its own. */
static void fill_points(float (*points)[3], const struct tube_layer *layer)
{
    for (size_t i = 0; i < layer->range_count; i++) {
        const struct range *range = &layer->ranges[i];
        for (size_t n = (size_t)range->first; n < (size_t)range->first + (size_t)range->count; n++) {
            double p[3];
            tractogram_point(p, &layer->atlas->tractograms[i], layer->kept[n]);
            for (int a = 0; a < 3; a++) {
                points[n][a] = points[n + 1][a] = (float)p[a];
            }
        }
    }
}

static conus_status upload(struct tube_layer *layer, uint64_t *memory_left)
{
    size_t count = layer->point_count;
    uint64_t size = (uint64_t)count * (3 * sizeof(float) + sizeof(uint32_t));
    if (size > *memory_left || count > INT32_MAX - 1) {
        return fail(CONUS_ERROR_MEMORY, "streamlines of %zu points: %llu bytes, allowed are %llu more", count,
                    (unsigned long long)size, (unsigned long long)*memory_left);
    }
    float(*points)[3] = memory_zeroed(count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    *memory_left -= size;
    fill_points(points, layer);
    glCreateBuffers(1, &layer->points);
    glNamedBufferStorage(layer->points, (GLsizeiptr)((count + 1) * sizeof *points), points, 0);
    glCreateBuffers(1, &layer->paints);
    glNamedBufferData(layer->paints, (GLsizeiptr)((count + 1) * sizeof(uint32_t)), NULL, GL_DYNAMIC_DRAW);
    memory_free(points);
    glCreateVertexArrays(1, &layer->vertices);
    glVertexArrayVertexBuffer(layer->vertices, 0, layer->points, 0, 3 * sizeof(float));
    glVertexArrayVertexBuffer(layer->vertices, 1, layer->points, 3 * sizeof(float), 3 * sizeof(float));
    glVertexArrayVertexBuffer(layer->vertices, 2, layer->paints, 0, sizeof(uint32_t));
    for (GLuint k = 0; k < 3; k++) {
        glEnableVertexArrayAttrib(layer->vertices, k);
        glVertexArrayAttribBinding(layer->vertices, k, k);
        glVertexArrayBindingDivisor(layer->vertices, k, 1);
    }
    glVertexArrayAttribFormat(layer->vertices, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribFormat(layer->vertices, 1, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribIFormat(layer->vertices, 2, 1, GL_UNSIGNED_INT, 0);
    return gl_check("streamlines");
}

static conus_status make_program(struct tube_layer *layer)
{
    const struct program_source source = {.vertex = {.file = "tube.vert.glsl", .text = shader_tube_vert},
                                          .fragment = {.file = "tube.frag.glsl", .text = shader_tube_frag}};
    conus_status status = program_create(&layer->program, &source);
    if (!status) {
        layer->eye = program_uniform(layer->program, "eye");
        layer->camera_from_world = program_uniform(layer->program, "camera_from_world");
        layer->world_from_camera = program_uniform(layer->program, "world_from_camera");
        layer->shift = program_uniform(layer->program, "shift");
        layer->size = program_uniform(layer->program, "size");
        layer->radius = program_uniform(layer->program, "radius");
    }
    return status;
}

conus_status tube_layer_create(struct tube_layer **out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct tube_layer *layer = memory_zeroed(1, sizeof *layer);
    if (!layer) {
        return CONUS_ERROR_MEMORY;
    }
    layer->atlas = atlas;
    layer->range_count = atlas->tractogram_count;
    layer->ranges = memory_zeroed(layer->range_count, sizeof *layer->ranges);
    uint64_t count = 0;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        count += atlas->tractograms[i].point_count;
    }
    layer->step = count / TUBE_POINT_LIMIT + 1;
    conus_status status = layer->ranges ? make_program(layer) : CONUS_ERROR_MEMORY;
    status = status ? status : keep_points(layer);
    status = status ? status : upload(layer, memory_left);
    status = status ? status : tube_layer_update(layer, atlas, &(const struct tube_colouring){0}, NULL);
    if (status) {
        tube_layer_destroy(layer);
        return status;
    }
    *out = layer;
    return CONUS_OK;
}

void tube_layer_destroy(struct tube_layer *layer)
{
    if (layer) {
        const GLuint buffers[] = {layer->points, layer->paints};
        glDeleteBuffers(2, buffers);
        glDeleteVertexArrays(1, &layer->vertices);
        glDeleteProgram(layer->program);
        memory_free(layer->kept);
        memory_free(layer->ranges);
        memory_free(layer);
    }
}

/* No tube begins at a streamline's last point; a streamline of one point is a ball. */
static conus_status paint_tractogram(uint32_t *paints, const struct tube_layer *layer, size_t index,
                                     const struct tube_colouring *colouring, const bool *is_pale)
{
    const struct tractogram *tractogram = &layer->atlas->tractograms[index];
    const struct range *range = &layer->ranges[index];
    uint32_t *objects = memory_zeroed(tractogram->streamline_count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    bundles_find_objects(objects, layer->atlas, tractogram);
    for (size_t n = (size_t)range->first; n < (size_t)range->first + (size_t)range->count; n++) {
        uint64_t at = layer->kept[n];
        uint32_t k = tractogram_streamline_of(tractogram, at);
        uint64_t last = tractogram->first[k + 1] - 1;
        uint32_t ball = tractogram->first[k] == last ? TUBE_BALL : 0;
        bool is_drawn = objects[k] && (at != last || ball);
        uint32_t paint = is_drawn ? ball | tube_colour(colouring, tractogram, k, at, objects[k]) : 0;
        paints[n] = paint && is_pale && is_pale[k] ? paint | TUBE_PALE : paint;
    }
    memory_free(objects);
    return CONUS_OK;
}

conus_status tube_layer_update(struct tube_layer *layer, const conus_atlas *atlas,
                               const struct tube_colouring *colouring, const bool *const *is_pale)
{
    uint32_t *paints = memory_zeroed(layer->point_count + 1, sizeof *paints);
    conus_status status = paints ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < atlas->tractogram_count && !status; i++) {
        status = paint_tractogram(paints, layer, i, colouring, is_pale ? is_pale[i] : NULL);
    }
    if (!status) {
        glNamedBufferSubData(layer->paints, 0, (GLsizeiptr)(layer->point_count * sizeof *paints), paints);
        status = gl_check("streamlines");
    }
    memory_free(paints);
    return status;
}

/* The inverse, by columns: from (x, y, 1) of the picture to the ray's place at depth 1. */
static void invert_rows(float out[9], const double rows[9])
{
    double columns[3][3];
    vec3_cross(columns[0], rows + 3, rows + 6);
    vec3_cross(columns[1], rows + 6, rows);
    vec3_cross(columns[2], rows, rows + 3);
    double determinant = vec3_dot(rows, columns[0]);
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++) {
            out[3 * k + a] = (float)(columns[k][a] / determinant);
        }
    }
}

conus_status tube_layer_draw(const struct tube_layer *layer, const struct tube_layer_view *view)
{
    static const GLuint strip = 4;
    conus_status status = CONUS_OK;
    float inverse[9];
    invert_rows(inverse, view->camera_from_world);
    glUseProgram(layer->program);
    glUniform3dv(layer->eye, 1, view->eye);
    glUniformMatrix3dv(layer->camera_from_world, 1, GL_TRUE, view->camera_from_world);
    glUniformMatrix3fv(layer->world_from_camera, 1, GL_FALSE, inverse);
    glUniform2fv(layer->shift, 1, view->shift);
    glUniform2f(layer->size, (float)view->width, (float)view->height);
    glBindVertexArray(layer->vertices);
    for (size_t i = 0; i < layer->range_count && !status; i++) {
        const struct range *range = &layer->ranges[i];
        glUniform1f(layer->radius, fmaxf(range->radius, (float)view->draft / 2));
        GLsizei count = view->draft > 0 ? range->draft : range->count;
        GLsizei most = view->listener.progress ? PIECE : count;
        for (GLsizei done = 0; done < count && !status; done += most) {
            GLsizei piece = count - done < most ? count - done : most;
            glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, strip, piece, (GLuint)(range->first + done));
            status = gl_tell(&view->listener, (size_t)done + (size_t)piece, (size_t)count);
        }
    }
    return status;
}
