/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines from arrays. */
#include "base/memory.h"
#include "base/options.h"
#include "base/text.h"
#include "conus/streamlines.h"
#include "loaders/maps/maps.h"
#include "loaders/scene/scene.h"
#include "loaders/tracts/tracts.h"

#include <stdio.h>
#include <string.h>

static void check_arrays(struct job *job, const conus_polylines *polylines)
{
    if (polylines->type != CONUS_SCALAR_FLOAT32 && polylines->type != CONUS_SCALAR_FLOAT64) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "type: %d, allowed are CONUS_SCALAR_FLOAT32 (%d) and CONUS_SCALAR_FLOAT64 (%d)", (int)polylines->type,
                 CONUS_SCALAR_FLOAT32, CONUS_SCALAR_FLOAT64);
    }
    const char *missing = polylines->point_count && !polylines->points     ? "points"
                          : !polylines->first                              ? "first"
                          : polylines->scalar_count && !polylines->scalars ? "scalars"
                                                                           : NULL;
    if (missing) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: NULL", missing);
    }
    if (polylines->streamline_count >= UINT32_MAX) {
        job_bad(job, "streamlines: found %zu, allowed are %u", polylines->streamline_count, UINT32_MAX - 1);
    }
}

static void copy_scalar(struct tract_build *build, const conus_tract_scalar *given)
{
    struct tractogram *t = &build->tractogram;
    size_t count = given->per_point ? t->point_count : t->streamline_count;
    if (!given->name || !given->components || (count && !given->values)) {
        job_fail(build->job, CONUS_ERROR_ARGUMENT, "scalar %zu: a name, 1 or more components and values are needed",
                 t->scalar_count);
        return;
    }
    tract_build_scalar(build, text_from(given->name), given->per_point, given->components);
    if (job_ok(build->job)) {
        const void *values = given->values ? (const void *)given->values : "";
        struct tract_scalar *scalar = &t->scalars[t->scalar_count - 1];
        count = memory_multiply(count, given->components, &count) ? count : SIZE_MAX;
        scalar->values = memory_copy(values, count, sizeof *scalar->values);
        job_need(build->job, scalar->values);
    }
}

static void copy_points(struct job *job, struct tractogram *out, const conus_polylines *polylines)
{
    const bool is_narrow = polylines->type == CONUS_SCALAR_FLOAT32;
    const void *points = polylines->points ? polylines->points : "";
    const size_t size = 3 * sizeof *out->points;
    out->points =
        is_narrow ? memory_copy(points, polylines->point_count, size) : memory_raw(polylines->point_count, size);
    const size_t count = job_need(job, out->points) && !is_narrow ? 3 * polylines->point_count : 0;
    for (size_t i = 0; i < count; i++) {
        out->points[i] = (float)((const double *)points)[i];
    }
}

static void copy_polylines(struct tract_build *build, const conus_polylines *polylines)
{
    const char *name = polylines->name ? polylines->name : "array";
    struct tractogram *out = &build->tractogram;
    struct job *job = build->job;
    if (!job_step(job)) {
        return;
    }
    out->point_count = polylines->point_count;
    out->streamline_count = polylines->streamline_count;
    snprintf(out->format, sizeof out->format, "array");
    out->path = memory_text(name, strlen(name));
    job_need(job, out->path);
    out->first = memory_copy(polylines->first, polylines->streamline_count + 1, sizeof *out->first);
    job_need(job, out->first);
    copy_points(job, out, polylines);
    const char *at = (const char *)polylines->scalars;
    for (size_t i = 0; i < polylines->scalar_count && job_ok(job); i++) {
        size_t size = polylines->scalars->struct_size;
        copy_scalar(build, options_of(conus_tract_scalar, at));
        at += size ? size : sizeof(conus_tract_scalar);
    }
}

conus_status conus_atlas_add_polylines(conus_atlas *atlas, const conus_polylines *polylines,
                                       const conus_streamlines_options *options)
{
    if (!atlas || !polylines) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_polylines: an atlas and streamlines are needed");
    }
    polylines = options_of(conus_polylines, polylines);
    options = options_of(conus_streamlines_options, options);
    const struct note_sink sink = {options->log, options->log_user, polylines->name ? polylines->name : "array"};
    struct notes notes = {.sink = &sink};
    struct job job = {.sink = &sink};
    struct tract_build build = {.job = &job};
    struct tractogram *tractogram = &build.tractogram;
    const struct atlas_mark mark = atlas_mark(atlas);
    size_t place = job_in(&job, sink.path, JOB_ALONE);
    check_arrays(&job, polylines);
    copy_polylines(&build, polylines);
    job_out(&job, place);
    tractogram->radius = streamlines_radius(&job, options->radius, sink.path);
    if (job_ok(&job) && options->space == CONUS_FILE_SPACE_LPS) {
        tractogram_from_lps(tractogram);
    }
    job_in(&job, sink.path, JOB_ALONE);
    (void)JOB_CALL(&job, tractogram_check(tractogram, &notes));
    job_out(&job, place);
    streamlines_add(&job, atlas, tractogram, options->name, &notes);
    tractogram_finish(tractogram);
    notes_finish(&notes);
    return atlas_close(&job, atlas, mark);
}
