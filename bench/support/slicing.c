/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws a volume as blended polygons. */
#include "bench/support/frame.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/colour/colour.h"

#include <math.h>
#include <string.h>

enum { SLICE_CORNERS = 6 };

struct slicing_vertex {
    float x, y, depth, plane; /* in camera space */
};

static const char slice_vertex[] = "layout(location = 0) in vec4 corner;\n"
                                   "layout(location = 0) flat out float slice;\n"
                                   "layout(location = 0) uniform vec2 slope;\n"
                                   "void main()\n"
                                   "{\n"
                                   "    slice = corner.w;\n"
                                   "    gl_Position = vec4(corner.xy / slope, 0.0, corner.z);\n"
                                   "}\n";

conus_status slicing_init(struct slicing *out, uint32_t slices)
{
    static const struct program_shader vertex = {"slices", slice_vertex};
    size_t size = (size_t)slices * SLICE_CORNERS * sizeof *out->polygons;
    *out = (struct slicing){.slices = slices};
    out->polygons = memory_zeroed((size_t)slices * SLICE_CORNERS, sizeof *out->polygons);
    if (!out->polygons) {
        return CONUS_ERROR_MEMORY;
    }
    glCreateBuffers(1, &out->buffer);
    glNamedBufferData(out->buffer, (GLsizeiptr)size, NULL, GL_STREAM_DRAW);
    glCreateVertexArrays(1, &out->vertices);
    glVertexArrayVertexBuffer(out->vertices, 0, out->buffer, 0, sizeof *out->polygons);
    glEnableVertexArrayAttrib(out->vertices, 0);
    glVertexArrayAttribFormat(out->vertices, 0, 4, GL_FLOAT, GL_FALSE, 0);
    return colour_program_create(&out->program, &vertex, COLOUR_SLICES, NULL, true);
}

void slicing_finish(struct slicing *slicing)
{
    if (slicing->polygons) { /* otherwise there may be no GL at all */
        glDeleteBuffers(1, &slicing->buffer);
        glDeleteVertexArrays(1, &slicing->vertices);
        glDeleteProgram(slicing->program);
    }
    memory_free(slicing->polygons);
    *slicing = (struct slicing){0};
}

/* Puts the points in order around their middle. */
static void sort_around(double (*points)[2], size_t count)
{
    double middle[2] = {0, 0};
    for (size_t i = 0; i < count; i++) {
        middle[0] += points[i][0] / (double)count;
        middle[1] += points[i][1] / (double)count;
    }
    for (size_t i = 1; i < count; i++) {
        for (size_t k = i; k > 0; k--) {
            double a = atan2(points[k - 1][1] - middle[1], points[k - 1][0] - middle[0]);
            double b = atan2(points[k][1] - middle[1], points[k][0] - middle[0]);
            if (a <= b) {
                break;
            }
            double swap[2] = {points[k][0], points[k][1]};
            memcpy(points[k], points[k - 1], sizeof swap);
            memcpy(points[k - 1], swap, sizeof swap);
        }
    }
}

/* Cuts the box at the depth of plane number `plane`: a convex polygon, its last corner repeated; all corners are zero
 * where the plane misses the box. */
static void cut_plane(struct slicing_vertex out[SLICE_CORNERS], const double corners[8][3], double depth,
                      uint32_t plane)
{
    double points[12][2];
    size_t count = 0;
    for (int n = 0; n < 8; n++) {
        for (int a = 0; a < 3; a++) {
            const double *p = corners[n];
            const double *q = corners[n | 1 << a];
            if (!(n >> a & 1) && (p[2] < depth) != (q[2] < depth)) {
                double part = (depth - p[2]) / (q[2] - p[2]);
                points[count][0] = p[0] + part * (q[0] - p[0]);
                points[count][1] = p[1] + part * (q[1] - p[1]);
                count++;
            }
        }
    }
    sort_around(points, count);
    for (size_t i = 0; i < SLICE_CORNERS; i++) {
        const double *corner = points[i < count ? i : count ? count - 1 : 0];
        out[i] = count ? (struct slicing_vertex){(float)corner[0], (float)corner[1], (float)depth, (float)plane}
                       : (struct slicing_vertex){0};
    }
}

/* Corners of the box around both volumes, along the axes of the areas' grid, or around the context alone, along its
 * own: to the right, up and ahead of the eye. Corner n differs from corner 0 along the axes whose bits are set in n. */
static void find_box(double out[8][3], const struct colour_pass *pass, const struct camera *camera)
{
    double low[3] = {0, 0, 0};
    double high[3] = {1, 1, 1};
    const struct colour_volume *context = &pass->context;
    const double *texture_from_world = pass->has_areas ? pass->areas.texture_from_world : context->texture_from_world;
    for (int n = 0; pass->has_areas && pass->may_have_context && n < 8; n++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = (n >> a & 1 ? (double)context->dim[a] : 0) - 0.5;
        }
        mat4_point(p, context->world_from_voxel, p);
        mat4_point(p, texture_from_world, p);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], p[a]);
            high[a] = fmax(high[a], p[a]);
        }
    }
    double world_from_texture[16] = {0};
    double camera_from_world[16] = {0};
    mat4_invert_affine(world_from_texture, texture_from_world);
    mat4_invert_affine(camera_from_world, camera->world_from_camera);
    for (int n = 0; n < 8; n++) {
        double *p = out[n];
        for (int a = 0; a < 3; a++) {
            p[a] = n >> a & 1 ? high[a] : low[a];
        }
        mat4_point(p, world_from_texture, p);
        mat4_point(p, camera_from_world, p);
        p[2] = -p[2];
    }
}

void slicing_draw(struct slicing *slicing, const struct colour_pass *pass, const struct colour_view *view)
{
    struct slices slices = colour_pass_slices(pass, view->camera, slicing->slices);
    double box[8][3];
    find_box(box, pass, view->camera);
    for (uint32_t n = 0; n < slices.count; n++) {
        uint32_t plane = slices.count - 1 - n;
        cut_plane(slicing->polygons + (size_t)n * SLICE_CORNERS, (const double(*)[3])box, slices_depth(&slices, plane),
                  plane);
    }
    colour_gl_prepare(pass, view);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glUseProgram(slicing->program);
    glUniform2f(0, (float)view->camera->slope[0], (float)view->camera->slope[1]);
    /* A new buffer each frame: the last frame may still be read. */
    glNamedBufferData(slicing->buffer,
                      (GLsizeiptr)((size_t)slicing->slices * SLICE_CORNERS * sizeof *slicing->polygons),
                      slicing->polygons, GL_STREAM_DRAW);
    glBindVertexArray(slicing->vertices);
    for (GLint n = 0; n < (GLint)slices.count; n++) {
        glDrawArrays(GL_TRIANGLE_FAN, n * SLICE_CORNERS, SLICE_CORNERS);
    }
    glDisable(GL_BLEND);
}
