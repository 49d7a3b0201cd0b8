/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds runs of voxels of one object, several labels at a time. */
#include "selection/measure/label_runs.h"

#include "base/memory.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

/* A run takes four bytes. */
enum { VOXELS_PER_RUN = 8 };

/* Compared at once. */
enum { LABELS = 16, STARTS = 2 * LABELS };

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
        run++;
    }
    return smaller(run, count);
}

/* Gives the number of runs, and writes them where `out` has memory for them. */
static size_t list_runs(const struct label_runs *out, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    size_t count = 0;
    for (size_t row = 0; row < dim[1] * dim[2]; row++) {
        if (out) {
            out->rows[row] = (uint32_t)count;
        }
        for (size_t i = 0; i < dim[0]; count++) {
            if (out) {
                out->starts[count] = (uint16_t)i;
                out->objects[count] = volume->objects16[row * dim[0] + i];
            }
            i += label_run_length(volume, row * dim[0] + i, dim[0] - i);
        }
    }
    if (out) {
        out->rows[dim[1] * dim[2]] = (uint32_t)count;
    }
    return count;
}

void label_runs_init(struct label_runs *out, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    *out = (struct label_runs){0};
    if (!volume->objects16 || dim[0] > INT16_MAX) { /* indices are compared as signed ones */
        return;
    }
    size_t count = list_runs(NULL, volume);
    if (count > volume->voxel_count / VOXELS_PER_RUN || count > UINT32_MAX) {
        return;
    }
    out->rows = memory_raw(dim[1] * dim[2] + 1, sizeof *out->rows);
    out->starts = memory_zeroed(count + STARTS, sizeof *out->starts);
    out->objects = memory_raw(count, sizeof *out->objects);
    if (!out->rows || !out->starts || !out->objects) {
        label_runs_finish(out);
        return;
    }
    (void)list_runs(out, volume);
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

/* How many of `count` starts in ascending order are index i or before it, as far as STARTS show. Most rows have fewer
 * runs, so there is nothing for the processor to guess. */
static size_t count_starts(const uint16_t *starts, size_t count, size_t i)
{
    size_t before = (size_t)__builtin_ctzll(later_starts(starts, i) | later_starts(starts + LABELS, i) << LABELS |
                                            UINT64_C(1) << STARTS);
    return smaller(before, count); /* those past the end are of other rows */
}
#endif

/* The run that holds index i, of those from `run` on, before `end`. */
static uint32_t find_run(const struct label_runs *runs, size_t run, size_t end, size_t i)
{
#if defined(__SSE2__)
    size_t here = count_starts(runs->starts + run, end - run, i);
    for (run += here; here == STARTS && run < end; run += here) {
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
    out[1] = find_run(runs, runs->rows[row], runs->rows[row + 1], last);
}
