/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares answers number by number. */
#include "same_answer.h"

#include "test.h"

#include <math.h>

static void assert_close_doubles(const double *a, const double *b, size_t count, double tolerance)
{
    for (size_t i = 0; i < count; i++) {
        if (!(a[i] == b[i] || (isnan(a[i]) && isnan(b[i])))) {
            assert_near(a[i], b[i], tolerance * (1 + fabs(b[i])));
        }
    }
}

void assert_same_doubles(const double *a, const double *b, size_t count)
{
    assert_close_doubles(a, b, count, 0);
}

void assert_same_result(const conus_result *a, const conus_result *b, double tolerance)
{
    const double mine[] = {a->score, a->share, a->centre_px, a->offset, a->distance, a->entry, a->exit, a->path};
    const double other[] = {b->score, b->share, b->centre_px, b->offset, b->distance, b->entry, b->exit, b->path};
    const double sums[] = {a->volume, a->fraction, a->cone_fraction, a->sum_value, a->mean_value, a->max_value};
    const double contact[] = {a->contact[0], a->contact[1], a->contact[2], a->contact_value};
    const double other_contact[] = {b->contact[0], b->contact[1], b->contact[2], b->contact_value};
    const double other_sums[] = {b->volume, b->fraction, b->cone_fraction, b->sum_value, b->mean_value, b->max_value};
    assert_int_equal(a->kind, b->kind);
    assert_int_equal(a->object, b->object);
    assert_int_equal(a->rank, b->rank);
    assert_int_equal(a->pixels, b->pixels);
    assert_int_equal(a->pierced, b->pierced);
    assert_int_equal(a->voxels, b->voxels);
    assert_same_doubles(mine, other, sizeof mine / sizeof mine[0]);
    assert_same_doubles(contact, other_contact, 4);
    assert_close_doubles(sums, other_sums, sizeof sums / sizeof sums[0], tolerance);
    assert_close_doubles(a->centroid, b->centroid, 3, tolerance);
    const double streamlines[] = {a->length, a->near[0], a->near[1], a->near[2], a->along};
    const double other_streamlines[] = {b->length, b->near[0], b->near[1], b->near[2], b->along};
    assert_int_equal(a->streamlines, b->streamlines);
    assert_int_equal(a->streamlines_total, b->streamlines_total);
    assert_same_doubles(streamlines, other_streamlines, 5);
}

static void assert_same_pixels(const conus_evidence *a, const conus_evidence *b)
{
    size_t pixels = a->object ? (size_t)a->resolution * a->resolution : 0;
    assert_int_equal(!a->object, !b->object);
    assert_int_equal(a->resolution, b->resolution);
    for (size_t p = 0; p < pixels; p++) {
        assert_int_equal(a->object[p], b->object[p]);
        assert_int_equal(a->voxel[p], b->voxel[p]);
    }
    assert_same_doubles(a->distance, b->distance, pixels);
}

void assert_same_answer(const conus_selection *a, const conus_selection *b, double tolerance)
{
    size_t count = 0;
    size_t other_count = 0;
    const conus_interval *intervals = conus_selection_intervals(&count, a);
    const conus_interval *others = conus_selection_intervals(&other_count, b);
    const conus_evidence mine = conus_selection_evidence(a);
    const conus_evidence theirs = conus_selection_evidence(b);
    assert_int_equal(conus_selection_count(a), conus_selection_count(b));
    for (size_t i = 0; i < conus_selection_count(a); i++) {
        assert_same_result(conus_selection_result(a, i), conus_selection_result(b, i), tolerance);
    }
    assert_same_pixels(&mine, &theirs);
    assert_int_equal(count, other_count);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(intervals[i].pixel, others[i].pixel);
        assert_int_equal(intervals[i].object, others[i].object);
        assert_int_equal(intervals[i].voxel, others[i].voxel);
        assert_same_doubles(&intervals[i].entry, &others[i].entry, 1);
        assert_same_doubles(&intervals[i].exit, &others[i].exit, 1);
    }
}
