/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds runs of voxels of one object, several labels at a time. */
#include "selection/measure/measure.h"

#include "base/memory.h"

#include <string.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

/* A run takes four bytes. */
enum { VOXELS_PER_RUN = 8, MOST_RUNS = 1 << 24 };

/* Compared at once. */
enum { LABELS = 16 };

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

#if defined(__SSE2__)
/* Which of LABELS labels differ from `object`: a bit for each. */
static unsigned other_labels(const uint16_t *labels, uint16_t object)
{
    const __m128i all = _mm_set1_epi16((short)object);
    __m128i low = _mm_cmpeq_epi16(_mm_loadu_si128((const __m128i *)labels), all);
    __m128i high = _mm_cmpeq_epi16(_mm_loadu_si128((const __m128i *)(labels + LABELS / 2)), all);
    return (unsigned)_mm_movemask_epi8(_mm_packs_epi16(low, high)) ^ 0xffff;
}
#endif

size_t label_run_length(const struct volume *volume, size_t first, size_t count)
{
    uint32_t object = volume_object(volume, first);
    size_t run = 0;
#if defined(__SSE2__)
    for (; volume->objects16 && run < count && first + run + LABELS <= volume->voxel_count; run += LABELS) {
        unsigned others = other_labels(volume->objects16 + first + run, (uint16_t)object);
        if (others) {
            return smaller(run + (size_t)__builtin_ctz(others), count);
        }
    }
#endif
    while (run < count && volume_object(volume, first + run) == object) {
        run = object ? run + 1 : volume_next(volume, first + run + 1) - first;
    }
    return smaller(run, count);
}

/* Where the voxels of a line along i are in rows along an axis. */
struct line {
    const uint16_t *objects; /* [count] */
    size_t count, first;     /* `first` of them begin their rows                        */
    ptrdiff_t before;        /* from a voxel to the one before it in its row            */
    size_t row, next_row;    /* of the line's first voxel, and by how much the next's is larger */
    uint16_t at, next;       /* the first voxel's index in its row, and by how much the next's is larger */
};

static struct line line_at(const struct label_runs *runs, const struct volume *volume, size_t j, size_t k)
{
    const size_t *dim = volume->info.dim;
    const size_t index[3] = {0, j, k};
    const size_t strides[3] = {1, dim[0], dim[0] * dim[1]};
    const int *axes = runs->axes;
    bool is_row = axes[0] == 0;
    return (struct line){.objects = volume->objects16 + dim[0] * (j + dim[1] * k),
                         .count = dim[0],
                         .first = is_row               ? 1
                                  : index[axes[0]] > 0 ? 0
                                                       : dim[0],
                         .before = -(ptrdiff_t)strides[axes[0]],
                         .row = index[axes[1]] + dim[axes[1]] * index[axes[2]],
                         .next_row = !is_row,
                         .at = (uint16_t)index[axes[0]],
                         .next = is_row};
}

/* Finds the first voxel, from number i on, whose object differs from that of the voxel before it in its row; the line's
 * count where there is none. */
static size_t next_start(const struct line *line, size_t i)
{
    const uint16_t *here = line->objects;
    uint64_t words[2] = {0, 0};
    for (; i >= line->first && i + 4 <= line->count && words[0] == words[1]; i += 4) {
        memcpy(&words[0], here + i, sizeof words[0]);
        memcpy(&words[1], here + i + line->before, sizeof words[1]);
    }
    i -= words[0] == words[1] ? 0 : 4;
    while (i < line->count && i >= line->first && here[i] == here[(ptrdiff_t)i + line->before]) {
        i++;
    }
    return i;
}

/* Counts the runs of each row of the line, into the next row's place. */
static void count_runs_of(struct label_runs *runs, const struct line *line)
{
    for (size_t i = next_start(line, 0); i < line->count; i = next_start(line, i + 1)) {
        runs->rows[line->row + i * line->next_row + 1]++;
    }
}

/* Puts down the line's runs; rows[] becomes one past the row's last so far. */
static void write_runs_of(struct label_runs *runs, const struct line *line)
{
    for (size_t i = next_start(line, 0); i < line->count; i = next_start(line, i + 1)) {
        uint32_t run = runs->rows[line->row + i * line->next_row]++;
        runs->starts[run] = (uint16_t)(line->at + i * line->next);
        runs->objects[run] = line->objects[i];
    }
}

static void for_lines(struct label_runs *runs, const struct volume *volume,
                      void (*take)(struct label_runs *runs, const struct line *line))
{
    for (size_t k = 0; k < volume->info.dim[2]; k++) {
        for (size_t j = 0; j < volume->info.dim[1]; j++) {
            struct line line = line_at(runs, volume, j, k);
            take(runs, &line);
        }
    }
}

void label_runs_init(struct label_runs *out, const struct volume *volume, int axis)
{
    const size_t *dim = volume->info.dim;
    *out = (struct label_runs){.axes = {axis, axis == 0, axis == 2 ? 1 : 2}};
    size_t row_count = dim[out->axes[1]] * dim[out->axes[2]];
    if (!volume->objects16 || dim[axis] > INT16_MAX) { /* indices are compared as signed ones */
        return;
    }
    out->rows = memory_zeroed(row_count + 1, sizeof *out->rows);
    if (!out->rows) {
        return;
    }
    for_lines(out, volume, count_runs_of);
    /* Each place behind a row has the row's number of runs; from here on, the index where the next row's runs begin. */
    size_t count = 0;
    for (size_t row = 1; row <= row_count; row++) {
        count += out->rows[row];
        out->rows[row] = (uint32_t)count;
    }
    bool is_small = count <= smaller(volume->voxel_count / VOXELS_PER_RUN, MOST_RUNS);
    out->starts = is_small ? memory_zeroed(count + LABELS, sizeof *out->starts) : NULL;
    out->objects = is_small ? memory_raw(count, sizeof *out->objects) : NULL;
    if (!out->starts || !out->objects) {
        label_runs_finish(out);
        return;
    }
    for_lines(out, volume, write_runs_of);
    memmove(out->rows + 1, out->rows, row_count * sizeof *out->rows);
    out->rows[0] = 0;
}

void label_runs_finish(struct label_runs *runs)
{
    memory_free(runs->rows);
    memory_free(runs->starts);
    memory_free(runs->objects);
    *runs = (struct label_runs){0};
}

#if defined(__SSE2__)
/* Which of LABELS starts lie behind index i: a bit for each. */
static unsigned later_starts(const uint16_t *starts, size_t i)
{
    const __m128i here = _mm_set1_epi16((short)i);
    __m128i low = _mm_cmpgt_epi16(_mm_loadu_si128((const __m128i *)starts), here);
    __m128i high = _mm_cmpgt_epi16(_mm_loadu_si128((const __m128i *)(starts + LABELS / 2)), here);
    return (unsigned)_mm_movemask_epi8(_mm_packs_epi16(low, high));
}

/* How many of `count` starts in ascending order are index i or before it, as far as LABELS show. Most rows have fewer
 * runs, so there is nothing for the processor to guess. */
static size_t count_starts(const uint16_t *starts, size_t count, size_t i)
{
    size_t before = (size_t)__builtin_ctz(later_starts(starts, i) | 1U << LABELS);
    return smaller(before, count); /* voxels past the end belong to other rows */
}
#endif

/* The run that holds index i, of those from `run` on, before `end`. */
static uint32_t find_run(const struct label_runs *runs, size_t run, size_t end, size_t i)
{
#if defined(__SSE2__)
    size_t here = count_starts(runs->starts + run, end - run, i);
    for (run += here; here == LABELS && run < end; run += here) {
        here = count_starts(runs->starts + run, end - run, i);
    }
#else
    while (run < end && runs->starts[run] <= i) {
        run++;
    }
#endif
    return (uint32_t)run - 1;
}

void label_runs_between(uint32_t out[2], const struct label_runs *runs, size_t row, size_t first, size_t last)
{
    out[0] = find_run(runs, runs->rows[row], runs->rows[row + 1], first);
    out[1] = find_run(runs, out[0], runs->rows[row + 1], last);
}
