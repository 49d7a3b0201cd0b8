/* SPDX-License-Identifier: BSD-3-Clause */
/* How the cost grows with objects, angle and voxels. */
#include "bench/growth/growth.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { CHECK_SIZES = 3 };

struct growth_curve growth_begin(struct bench *bench, const char *name, double angle_deg)
{
    return (struct growth_curve){.bench = bench, .name = name, .angle_deg = angle_deg, .equal = true};
}

size_t growth_sizes(const struct bench *bench, size_t count)
{
    return bench->options.check && count > CHECK_SIZES ? CHECK_SIZES : count;
}

void growth_name(char name[GROWTH_NAME], const struct growth_curve *curve, double x, struct bench_variant *variant)
{
    snprintf(name, GROWTH_NAME, "%s, %.10g", curve->name, x);
    variant->name = name;
    variant->more = json_pack("{s:s, s:f}", "curve", curve->name, "x", x);
}

void growth_take(struct growth_curve *curve, double x, const struct bench_variant *variant)
{
    assert(curve->count < GROWTH_POINTS);
    curve->x[curve->count] = x;
    curve->ms[curve->count++] = variant->median_ms;
    curve->equal = curve->equal && variant->equal;
}

conus_status growth_add(struct growth_curve *curve, const double *x, struct bench_variant *variants, size_t count,
                        size_t per)
{
    char names[GROWTH_POINTS][GROWTH_NAME];
    assert(count <= GROWTH_POINTS);
    for (size_t i = 0; i < count; i++) {
        growth_name(names[i], curve, x[i], &variants[i]);
    }
    conus_status status = bench_measure(curve->bench, "growth", variants, count, per, curve->angle_deg);
    for (size_t i = 0; i < count && !status; i++) {
        growth_take(curve, x[i], &variants[i]);
    }
    return status;
}

/* Whether the run belongs to the curve. */
static bool is_of(const json_t *run, const struct growth_curve *curve)
{
    const char *name = json_string_value(json_object_get(run, "curve"));
    return name && strcmp(name, curve->name) == 0;
}

conus_status growth_end(struct growth_curve *curve)
{
    char key[64];
    size_t point = 0;
    size_t index;
    json_t *run;
    json_array_foreach(curve->bench->runs, index, run)
    {
        if (is_of(run, curve) && point++ > 0) {
            double slope = bench_exponent(curve->x + point - 2, curve->ms + point - 2, 2);
            if (json_object_set_new(run, "slope", json_real(slope))) {
                return fail(CONUS_ERROR_MEMORY, "out of memory");
            }
        }
    }
    snprintf(key, sizeof key, "growth_%s", curve->name);
    return bench_value(curve->bench, key, bench_exponent(curve->x, curve->ms, curve->count), curve->equal);
}

conus_status bench_growth(struct bench *bench)
{
    conus_status (*const curves[])(struct bench *) = {growth_objects, growth_torus_angle, growth_voxels};
    conus_status status = CONUS_OK;
    bench->one_thread = true;
    for (size_t i = 0; i < sizeof curves / sizeof *curves && !status; i++) {
        status = curves[i](bench);
    }
    return status;
}
