/* SPDX-License-Identifier: BSD-3-Clause */
/* What is meant, of what is hit first: the posterior of a hand's aim (Eq. 32). */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "selection/weight/weight.h"
#include "sources/names.h"

#include <math.h>
#include <stdio.h>

/* A file of a prior on the way. */
struct priors {
    struct prior *out;
    const conus_atlas *atlas;
    const uint32_t *group;
    bool *is_given; /* [object_count + 1] */
    size_t rows;
};

enum { NAME, INDEX, PRIOR };

/* The object that a name means, or the number in a column "index" of rows: an area's label comes first. */
static uint32_t find_object(struct job *job, const struct named_cells *cells, const conus_atlas *atlas)
{
    uint64_t label;
    uint32_t found = 1;
    if (!named_cells_has(cells, INDEX)) {
        const char *name = job_copy(job, named_cell(cells, NAME));
        conus_status status = job_ok(job) ? conus_atlas_find(&found, atlas, name) : CONUS_OK;
        (void)JOB_CALL(job, status == CONUS_ERROR_ARGUMENT ? CONUS_ERROR_DATA : status);
        return found;
    }
    const struct text number = named_cell(cells, INDEX);
    const conus_object *object = text_to_uint(number, UINT32_MAX, &label) ? conus_atlas_object(atlas, 1) : NULL;
    while (object && object->label != label) {
        object = conus_atlas_object(atlas, ++found);
    }
    if (!object) {
        job_bad(job, "index: nothing has the number %.*s", TEXT_SHOW(number, 40));
    }
    return found;
}

bool prior_has_row(const conus_atlas *atlas, const uint32_t *group, uint32_t object)
{
    bool is_parent = false;
    bool has_row = false;
    for (uint32_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *other = conus_atlas_object(atlas, i);
        const bool has_shape = other->voxels > 0 || other->triangles > 0;
        is_parent = is_parent || other->parent == object;
        has_row = has_row || (has_shape && (group ? group[i] : i) == object);
    }
    return (!group || group[object] == object) && (!is_parent || has_row);
}

static void take_row(struct job *job, const struct named_cells *cells, void *user)
{
    struct priors *priors = user;
    double times = 0;
    if (!named_cells_has(cells, PRIOR) || named_cells_has(cells, NAME) == named_cells_has(cells, INDEX)) {
        job_bad(job, "columns name or index, and prior, are needed");
        return;
    }
    named_cells_numbers(job, &times, cells, PRIOR, 1);
    if (times < 0) {
        job_bad(job, "prior: %g is out of range, allowed is 0 or more", times);
    }
    const uint32_t object = find_object(job, cells, priors->atlas);
    if (!job_ok(job)) {
        return;
    }
    const char *name = conus_atlas_object(priors->atlas, object)->name;
    if (!prior_has_row(priors->atlas, priors->group, object)) {
        job_bad(job, "%.60s has no row of its own at this level", name);
    } else if (priors->is_given[object]) {
        job_bad(job, "%.60s is there twice", name);
    }
    priors->is_given[object] = true;
    priors->rows++;
    priors->out->times[object] = times;
}

static conus_status read_file(struct prior *out, const char *path, const conus_atlas *atlas, const uint32_t *group)
{
    static const char *const names[] = {"name", "index", "prior"};
    const size_t count = conus_atlas_object_count(atlas) + 1;
    struct priors priors = {out, atlas, group, memory_zeroed(count, sizeof *priors.is_given), 0};
    out->of_file = true;
    out->times = memory_raw(count, sizeof *out->times);
    conus_status status = out->times && priors.is_given ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        out->times[i] = 1;
    }
    status = status ? status : rows_read(path, names, 3, take_row, &priors, NULL);
    memory_free(priors.is_given);
    return status || priors.rows ? status : fail(CONUS_ERROR_DATA, "%s: no rows, at least one is needed", path);
}

conus_status prior_read(struct prior *out, const char *text, const conus_atlas *atlas, const uint32_t *group)
{
    const char *given = text ? text : "equal";
    struct source_keys keys;
    if (!keys_read(&keys, given, KEYS_PRIOR)) {
        return fail(CONUS_ERROR_ARGUMENT, "prior: %s", keys.why);
    }
    const struct text head = {given, keys.length};
    struct prior prior = {.power = keys.given ? keys.values[0].numbers[0] : 1, .by_size = text_equal(head, "size")};
    conus_status status = CONUS_OK;
    if (!prior.by_size && !text_equal(head, "equal")) {
        char *path = conus_weight_path_length(given) ? memory_text(head.data, head.size) : NULL;
        status = path ? read_file(&prior, path, atlas, group)
                 : conus_weight_path_length(given)
                     ? CONUS_ERROR_MEMORY
                     : fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is unknown, allowed are equal, size, or a file",
                            TEXT_SHOW(head, 60));
        memory_free(path);
    }
    if (status) {
        prior_finish(&prior);
        return status == CONUS_ERROR_MEMORY ? status : fail_in(status, "prior");
    }
    *out = prior;
    return CONUS_OK;
}

void prior_finish(struct prior *prior)
{
    memory_free(prior->times);
    *prior = (struct prior){0};
}

/* p weight / (solid angle + a square degree), or by size p weight. */
static double likelihood(const conus_result *result, const struct prior *prior, double aperture)
{
    const double square_degree = radians_from_degrees(1) * radians_from_degrees(1);
    const double times = prior->times ? prior->times[result->object] : 1;
    return times * result->weight / (prior->by_size ? 1 : (result->share * aperture + square_degree) / square_degree);
}

void prior_apply(conus_result *results, size_t count, const struct prior *prior, const struct cone *cone)
{
    const double aperture = cone_cross_section(cone);
    double largest = 0;
    double sum = 0;
    for (size_t i = 0; i < count && cone->radius == 0; i++) {
        if (results[i].object && results[i].pixels) {
            largest =
                fmax(largest, likelihood(&results[i], prior, aperture)); /* of no weight NaN, which is passed over */
        }
    }
    for (size_t i = 0; i < count && largest > 0; i++) {
        if (results[i].object && results[i].pixels) {
            results[i].posterior = pow(likelihood(&results[i], prior, aperture) / largest, prior->power);
            sum += results[i].posterior;
        }
    }
    for (size_t i = 0; i < count && largest > 0; i++) {
        results[i].posterior /= sum;
    }
}
