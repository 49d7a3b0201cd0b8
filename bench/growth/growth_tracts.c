/* SPDX-License-Identifier: BSD-3-Clause */
/* Cost against the number of streamlines: what the scenario streamlines measures, as a curve. */
#include "bench/growth/growth.h"

#include <stdio.h>
#include <string.h>

/* Takes over a run of the fastest kernel. */
static conus_status take(struct growth_curve *curve, json_t *run)
{
    char name[GROWTH_NAME];
    double x = json_number_value(json_object_get(run, "streamlines"));
    snprintf(name, sizeof name, "%s, %.10g", curve->name, x);
    int error = json_object_set_new(run, "scenario", json_string("growth"));
    error |= json_object_set_new(run, "variant", json_string(name));
    error |= json_object_set_new(run, "curve", json_string(curve->name));
    error |= json_object_set_new(run, "x", json_real(x));
    error |= json_array_append(curve->bench->runs, run);
    curve->x[curve->count] = x;
    curve->ms[curve->count++] = json_number_value(json_object_get(run, "median_ms"));
    curve->equal = curve->equal && json_is_true(json_object_get(run, "equal"));
    return error ? fail(CONUS_ERROR_MEMORY, "out of memory") : CONUS_OK;
}

/* The first run of each number of streamlines is that of the kernel that the machine picks. */
static conus_status take_all(struct growth_curve *curve, const json_t *runs)
{
    conus_status status = CONUS_OK;
    double last = 0;
    size_t index;
    json_t *run;
    json_array_foreach(runs, index, run)
    {
        double x = json_number_value(json_object_get(run, "streamlines"));
        if (!status && x > last && curve->count < GROWTH_POINTS) {
            status = take(curve, run);
            last = x;
        }
    }
    return status ? status : growth_end(curve);
}

conus_status growth_streamlines(struct bench *bench)
{
    enum { CONES = 8 };
    struct growth_curve curve = growth_begin(bench, "streamlines", bench->options.angle);
    struct bench own = {.options = bench->options,
                        .folder = bench->folder,
                        .runs = json_array(),
                        .ratios = json_object(),
                        .left_out = json_object()};
    own.options.poses = own.options.poses < CONES ? own.options.poses : CONES;
    conus_status status =
        own.runs && own.ratios && own.left_out ? bench_streamlines(&own) : fail(CONUS_ERROR_MEMORY, "out of memory");
    status = status ? status : take_all(&curve, own.runs);
    json_decref(own.runs);
    json_decref(own.ratios);
    json_decref(own.left_out);
    return status;
}
