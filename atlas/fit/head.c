/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the head among grey values, or in closed surfaces. */
#include "atlas/fit/fit.h"

#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

enum { CLASSES = 256 };

static size_t cell_count(const struct head *head)
{
    return head->dim[0] * head->dim[1] * head->dim[2];
}

/* The values of all cells, each that of its first voxel; NULL without memory. */
static float *cell_values(const struct head *head)
{
    const size_t *dim = head->context->info.dim;
    float *values = memory_raw(cell_count(head), sizeof *values);
    float *out = values;
    for (size_t k = 0; values && k < dim[2]; k += head->step[2]) {
        for (size_t j = 0; j < dim[1]; j += head->step[1]) {
            const float *row = head->context->values + dim[0] * (j + dim[1] * k);
            for (size_t i = 0; i < dim[0]; i += head->step[0]) {
                *out++ = row[i];
            }
        }
    }
    return values;
}

/* The end of the background class: the threshold with the largest variance between the classes. */
static size_t split_classes(const uint64_t counts[CLASSES])
{
    double total = 0;
    double sum = 0;
    double below = 0;
    double sum_below = 0;
    double most = -1;
    size_t best = 0;
    for (size_t c = 0; c < CLASSES; c++) {
        total += (double)counts[c];
        sum += (double)counts[c] * (double)c;
    }
    for (size_t c = 0; c + 1 < CLASSES; c++) {
        below += (double)counts[c];
        sum_below += (double)counts[c] * (double)c;
        double difference = sum * below / total - sum_below;
        double variance = difference * difference / (below * (total - below));
        if (below > 0 && below < total && variance > most) {
            most = variance;
            best = c;
        }
    }
    return best + 1;
}

/* Values are finite: others became 0. */
static double find_threshold(const float *values, size_t count)
{
    uint64_t counts[CLASSES] = {0};
    float low = INFINITY;
    float high = -INFINITY;
    for (size_t cell = 0; cell < count; cell++) {
        low = values[cell] < low ? values[cell] : low;
        high = values[cell] > high ? values[cell] : high;
    }
    double width = ((double)high - (double)low) / CLASSES;
    for (size_t cell = 0; width > 0 && cell < count; cell++) {
        size_t class = (size_t)(((double)values[cell] - (double)low) / width);
        counts[class < CLASSES ? class : CLASSES - 1]++;
    }
    return width > 0 ? (double)low + width * (double)split_classes(counts) : INFINITY; /* all are alike */
}

/* Adds 1 to all cells between the first and the last one of the head along a line that begins at `values`. */
static void mark_line(uint8_t *marks, const float *values, double threshold, size_t stride, size_t count)
{
    size_t from = 0;
    size_t to = count;
    while (from < to && !((double)values[from * stride] >= threshold)) {
        from++;
    }
    while (to > from && !((double)values[(to - 1) * stride] >= threshold)) {
        to--;
    }
    for (; from < to; from++) {
        marks[from * stride]++;
    }
}

void enclose(uint8_t *marks, const float *values, double threshold, const size_t dim[3])
{
    const size_t stride[3] = {1, dim[0], dim[0] * dim[1]};
    for (size_t a = 0; a < 3; a++) {
        const size_t b = (a + 1) % 3;
        const size_t c = (a + 2) % 3;
        for (size_t line = 0; line < dim[b] * dim[c]; line++) {
            size_t first = line % dim[b] * stride[b] + line / dim[b] * stride[c];
            mark_line(marks + first, values + first, threshold, stride[a], dim[a]);
        }
    }
    for (size_t cell = 0; cell < stride[2] * dim[2]; cell++) {
        marks[cell] = marks[cell] >= 2;
    }
}

conus_status head_make(struct head *out, const struct volume *context)
{
    struct head head = {.context = context};
    for (int a = 0; a < 3; a++) {
        head.step[a] = (context->info.dim[a] + HEAD_CELLS - 1) / HEAD_CELLS;
        head.dim[a] = (context->info.dim[a] + head.step[a] - 1) / head.step[a];
    }
    head.inside = memory_zeroed(cell_count(&head), sizeof *head.inside);
    float *values = head.inside ? cell_values(&head) : NULL;
    if (!values) {
        head_finish(&head);
        return CONUS_ERROR_MEMORY;
    }
    head.threshold = find_threshold(values, cell_count(&head));
    enclose(head.inside, values, head.threshold, head.dim);
    memory_free(values);
    *out = head;
    return CONUS_OK;
}

void head_finish(struct head *head)
{
    memory_free(head->inside);
    *head = (struct head){0};
}

bool head_grid_has(bool *in_head, const struct head *head, const double point[3])
{
    size_t voxel;
    const size_t *dim = head->context->info.dim;
    if (!volume_find_voxel(&voxel, head->context, point)) {
        return false;
    }
    const size_t i = voxel % dim[0] / head->step[0];
    const size_t j = voxel / dim[0] % dim[1] / head->step[1];
    const size_t k = voxel / dim[0] / dim[1] / head->step[2];
    *in_head = head->inside[i + head->dim[0] * (j + head->dim[1] * k)];
    return true;
}

static bool is_around_head(const struct context_surface *surface)
{
    return surface->mesh.shape.closed && !surface->is_shell;
}

/* Around the closed surfaces; false where there is none. */
static bool find_box(struct box3 *out, const conus_atlas *atlas)
{
    bool found = false;
    *out = box3_empty();
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        const struct mesh_shape *shape = &atlas->context_surfaces[i].mesh.shape;
        if (is_around_head(&atlas->context_surfaces[i])) {
            box3_join(out, shape->low, shape->high);
            found = true;
        }
    }
    return found;
}

static conus_status fill_surface(struct volume *volume, const struct mesh *mesh)
{
    struct mesh_lines lines = {.start = {0, 0}, .step = {1, 1}, .count = {volume->info.dim[0], volume->info.dim[1]}};
    conus_status status = CONUS_OK;
    for (size_t t = 0; !status && t < mesh->triangle_count; t++) {
        status = mesh_lines_cross(&lines, 0, mesh, t, volume->voxel_from_world);
    }
    if (!status) {
        mesh_lines_sort(&lines);
        /* A line is inside where the surface winds around it. */
        const size_t *dim = volume->info.dim;
        int32_t winding = 0;
        for (size_t i = 0; i + 1 < lines.crossing_count; i++) {
            const struct line_crossing *in = &lines.crossings[i];
            const struct line_crossing *out = in + 1;
            winding = in->line == out->line ? winding + in->side : 0;
            const double last = winding ? fmin(floor(out->z), (double)dim[2] - 1) : -1;
            for (size_t k = (size_t)fmax(ceil(in->z), 0); (double)k <= last; k++) {
                volume->values[in->line + dim[0] * dim[1] * k] = 1;
            }
        }
    }
    mesh_lines_finish(&lines);
    return status;
}

conus_status surface_head_make(struct volume *out, const conus_atlas *atlas)
{
    struct box3 box;
    struct volume volume = {0};
    if (!find_box(&box, atlas)) {
        *out = volume;
        return CONUS_OK;
    }
    conus_volume_info info = {.role = CONUS_ROLE_CONTEXT, .maximum = 1};
    double sides[3];
    vec3_sub(sides, box.high, box.low);
    double edge = fmax(sides[0], fmax(sides[1], sides[2])) / SURFACE_HEAD_CELLS;
    mat4_identity(info.world_from_voxel);
    for (int a = 0; a < 3; a++) {
        info.dim[a] = (size_t)ceil(sides[a] / edge) + 2;
        info.spacing[a] = edge;
        info.world_from_voxel[5 * a] = edge;
        info.world_from_voxel[12 + a] = box.low[a] - edge / 2;
    }
    conus_status status = volume_init(&volume, &info);
    volume.values = status ? NULL : memory_zeroed(volume.voxel_count, sizeof *volume.values);
    status = status || volume.values ? status : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < atlas->context_surface_count; i++) {
        const struct context_surface *surface = &atlas->context_surfaces[i];
        status = is_around_head(surface) ? fill_surface(&volume, &surface->mesh) : CONUS_OK;
    }
    return GIVE(status, out, volume, volume_finish(&volume));
}
