/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines from arrays. */
#include "base/memory.h"
#include "base/options.h"
#include "base/text.h"
#include "conus/streamlines.h"
#include "loaders/maps/atlas_on_job.h"
#include "loaders/scene/load_streamlines.h"

#include <stdio.h>
#include <string.h>

static conus_status check_arrays(const conus_polylines *polylines)
{
    if (polylines->type != CONUS_SCALAR_FLOAT32 && polylines->type != CONUS_SCALAR_FLOAT64) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "type: %d, allowed are CONUS_SCALAR_FLOAT32 (%d) and CONUS_SCALAR_FLOAT64 (%d)",
                    (int)polylines->type, CONUS_SCALAR_FLOAT32, CONUS_SCALAR_FLOAT64);
    }
    const char *missing = polylines->point_count && !polylines->points     ? "points"
                          : !polylines->first                              ? "first"
                          : polylines->scalar_count && !polylines->scalars ? "scalars"
                                                                           : NULL;
    if (missing) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: NULL", missing);
    }
    return polylines->streamline_count < UINT32_MAX ? CONUS_OK
                                                    : fail(CONUS_ERROR_DATA, "streamlines: found %zu, allowed are %u",
                                                           polylines->streamline_count, UINT32_MAX - 1);
}

static conus_status copy_points(struct tractogram *out, const conus_polylines *polylines)
{
    size_t numbers;
    if (!memory_multiply(3, polylines->point_count, &numbers)) {
        return CONUS_ERROR_MEMORY;
    }
    out->points = memory_raw(numbers, sizeof *out->points);
    if (!out->points) {
        return CONUS_ERROR_MEMORY;
    }
    if (polylines->type == CONUS_SCALAR_FLOAT32) {
        memcpy(out->points, polylines->points ? polylines->points : "", numbers * sizeof *out->points);
    }
    for (size_t i = 0; i < numbers && polylines->type == CONUS_SCALAR_FLOAT64; i++) {
        out->points[i] = (float)((const double *)polylines->points)[i];
    }
    return CONUS_OK;
}

static conus_status copy_scalar(struct tractogram *out, const conus_tract_scalar *given)
{
    size_t count = given->per_point ? out->point_count : out->streamline_count;
    if (!given->name || !given->components || (count && !given->values)) {
        return fail(CONUS_ERROR_ARGUMENT, "scalar %zu: a name, 1 or more components and values are needed",
                    out->scalar_count);
    }
    struct tract_scalar scalar = {.per_point = given->per_point, .components = given->components};
    scalar.name = text_to_utf8(text_from(given->name));
    scalar.values = memory_multiply(count, given->components, &count) ? memory_raw(count, sizeof(float)) : NULL;
    if (!scalar.name || !scalar.values) {
        memory_free(scalar.name);
        memory_free(scalar.values);
        return CONUS_ERROR_MEMORY;
    }
    memcpy(scalar.values, given->values ? (const void *)given->values : "", count * sizeof *scalar.values);
    out->scalars[out->scalar_count++] = scalar;
    return CONUS_OK;
}

static conus_status copy_polylines(struct tractogram *out, const conus_polylines *polylines)
{
    const char *name = polylines->name ? polylines->name : "array";
    out->point_count = polylines->point_count;
    out->streamline_count = polylines->streamline_count;
    out->path = memory_text(name, strlen(name));
    out->first = memory_copy(polylines->first, polylines->streamline_count + 1, sizeof *out->first);
    snprintf(out->format, sizeof out->format, "array");
    conus_status status = out->path && out->first ? copy_points(out, polylines) : CONUS_ERROR_MEMORY;
    if (status || !polylines->scalar_count) {
        return status;
    }
    out->scalars = memory_zeroed(polylines->scalar_count, sizeof *out->scalars);
    status = out->scalars ? CONUS_OK : CONUS_ERROR_MEMORY;
    const char *at = (const char *)polylines->scalars;
    for (size_t i = 0; i < polylines->scalar_count && !status; i++) {
        const conus_tract_scalar *given = options_of(conus_tract_scalar, at);
        size_t size = polylines->scalars->struct_size;
        status = copy_scalar(out, given);
        at += size ? size : sizeof *given;
    }
    return status;
}

conus_status conus_atlas_add_polylines(conus_atlas *atlas, const conus_polylines *polylines,
                                       const conus_streamlines_options *options)
{
    struct tractogram tractogram = {0};
    if (!atlas || !polylines) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_polylines: an atlas and streamlines are needed");
    }
    polylines = options_of(conus_polylines, polylines);
    options = options_of(conus_streamlines_options, options);
    const struct note_sink sink = {options->log, options->log_user, polylines->name ? polylines->name : "array"};
    struct notes notes = {.sink = &sink};
    conus_status status = check_arrays(polylines);
    status = status ? status : copy_polylines(&tractogram, polylines);
    struct job job = {.sink = &sink};
    const struct atlas_mark mark = atlas_mark(atlas);
    size_t place = job_in(&job, sink.path, JOB_ALONE);
    (void)JOB_CALL(&job, status);
    job_out(&job, place);
    tractogram.radius = streamlines_radius(&job, options->radius, sink.path);
    if (job_ok(&job) && options->space == CONUS_FILE_SPACE_LPS) {
        tractogram_from_lps(&tractogram);
    }
    job_in(&job, sink.path, JOB_ALONE);
    (void)JOB_CALL(&job, tractogram_check(&tractogram, &notes));
    job_out(&job, place);
    streamlines_add(&job, atlas, &tractogram, options->name, &notes);
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    return atlas_close(&job, atlas, mark);
}
