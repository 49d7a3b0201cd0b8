/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a head among grey values. */
#include "atlas/fit/head.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

enum { CLASSES = 256 };

/* The value of a cell: of its first voxel. */
static float value_of(const struct head *head, size_t cell)
{
    const size_t *dim = head->context->info.dim;
    const size_t i = cell % head->dim[0] * head->step[0];
    const size_t j = cell / head->dim[0] % head->dim[1] * head->step[1];
    const size_t k = cell / head->dim[0] / head->dim[1] * head->step[2];
    return head->context->values[i + dim[0] * (j + dim[1] * k)];
}

static size_t cell_count(const struct head *head)
{
    return head->dim[0] * head->dim[1] * head->dim[2];
}

/* The end of the class up to which there is background: there the variance between both sides is greatest. */
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

/* Values are finite: what was not has been made 0. */
static void find_threshold(struct head *head)
{
    uint64_t counts[CLASSES] = {0};
    const size_t count = cell_count(head);
    float low = INFINITY;
    float high = -INFINITY;
    for (size_t cell = 0; cell < count; cell++) {
        float value = value_of(head, cell);
        low = fminf(low, value);
        high = fmaxf(high, value);
    }
    double width = ((double)high - (double)low) / CLASSES;
    head->threshold = INFINITY; /* all are alike */
    for (size_t cell = 0; width > 0 && cell < count; cell++) {
        size_t class = (size_t)(((double)value_of(head, cell) - (double)low) / width);
        counts[class < CLASSES ? class : CLASSES - 1]++;
    }
    if (width > 0) {
        head->threshold = (double)low + width * (double)split_classes(counts);
    }
}

/* Adds 1 to all cells from the first to the last one of the head along a line. */
static void mark_line(uint8_t *marks, const struct head *head, size_t first, size_t stride, size_t count)
{
    size_t from = 0;
    size_t to = count;
    while (from < to && !((double)value_of(head, first + from * stride) >= head->threshold)) {
        from++;
    }
    while (to > from && !((double)value_of(head, first + (to - 1) * stride) >= head->threshold)) {
        to--;
    }
    for (; from < to; from++) {
        marks[first + from * stride]++;
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
    if (!head.inside) {
        return CONUS_ERROR_MEMORY;
    }
    find_threshold(&head);
    const size_t stride[3] = {1, head.dim[0], head.dim[0] * head.dim[1]};
    for (size_t a = 0; a < 3; a++) {
        const size_t b = (a + 1) % 3;
        const size_t c = (a + 2) % 3;
        for (size_t line = 0; line < head.dim[b] * head.dim[c]; line++) {
            size_t first = line % head.dim[b] * stride[b] + line / head.dim[b] * stride[c];
            mark_line(head.inside, &head, first, stride[a], head.dim[a]);
        }
    }
    for (size_t cell = 0; cell < cell_count(&head); cell++) {
        head.inside[cell] = head.inside[cell] >= 2;
    }
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
