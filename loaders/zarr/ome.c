/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads multiscales of OME-Zarr 0.1 to 0.6. */
#include "loaders/zarr/zarr.h"

#include "base/formats/json_text.h"
#include "base/order.h"
#include "base/path.h"

#include <math.h>
#include <string.h>

enum { SPACE = 3, LEVELS = 64, STEPS = 8 };

static const char *text_of(const json_t *value)
{
    const char *text = json_string_value(value);
    return text ? text : "";
}

/* Millimetres of a unit, 0 for an unknown one. */
static double find_unit(const char *name)
{
    static const struct unit {
        const char *name;
        double millimetres;
    } units[] = {{"micrometer", 1e-3}, {"millimeter", 1},  {"nanometer", 1e-6}, {"meter", 1e3},
                 {"centimeter", 10},   {"angstrom", 1e-7}, {"picometer", 1e-9}};
    const struct unit *unit = ROW_NAMED(units, text_from(name), true);
    return unit ? unit->millimetres : 0;
}

/* The letter of where the axis starts: RFC 4 says "anterior-to-posterior". */
static char find_start(const char *value)
{
    static const char ways[] = "anterior-to-posterior/posterior-to-anterior/superior-to-inferior/inferior-to-superior/"
                               "left-to-right/right-to-left";
    return text_is_one_of(text_from(value), ways, true) ? value[0] : '\0';
}

/* The name of a coordinate system that a transformation of 0.6 leads to, a text or an object, "" where there is none.
 */
static const char *name_output(const json_t *image)
{
    const json_t *dataset = json_array_get(json_object_get(image, "datasets"), 0);
    const json_t *first = json_array_get(json_object_get(dataset, "coordinateTransformations"), 0);
    const json_t *output = json_object_get(first, "output");
    return text_of(json_is_string(output) ? output : json_object_get(output, "name"));
}

/* The axes of an image: of 0.6, those of the coordinate system that its levels lead to, or else of the first. Drafts
 * have the systems beside the images, not in them. */
static const json_t *find_axes(const json_t *image, const json_t *systems)
{
    const json_t *system = json_array_get(systems, 0);
    for (size_t i = 0; i < json_array_size(systems); i++) {
        const json_t *other = json_array_get(systems, i);
        const char *name = text_of(json_object_get(other, "name"));
        system = name[0] && strcmp(name, name_output(image)) == 0 ? other : system;
    }
    return json_object_get(systems ? system : image, "axes");
}

/* Units in mm go to `units`, 0 where there is none. */
static void read_axes(struct job *job, struct ome *out, double units[SPACE], const json_t *axes)
{
    out->rank = json_array_size(axes);
    if (axes && (out->rank < SPACE || out->rank > ZARR_AXES)) {
        job_bad(job, "axes: found %zu, allowed are 3 to %d", out->rank, ZARR_AXES);
    }
    for (size_t i = 0; axes && job_ok(job) && i < SPACE; i++) {
        const json_t *axis = json_array_get(axes, out->rank - SPACE + i);
        const json_t *type = json_object_get(axis, "type");
        if (type && strcmp(text_of(type), "space") != 0) {
            job_refuse(job, "axes: the last three must be space, found \"%.*s\"", ZARR_NAME, text_of(type));
        }
        units[i] = find_unit(text_of(json_object_get(axis, "unit")));
        out->orientation[i] = find_start(text_of(json_object_get(json_object_get(axis, "orientation"), "value")));
    }
    if (strlen(out->orientation) != SPACE) {
        out->orientation[0] = '\0';
    }
}

/* Takes the last three of as many numbers as there are axes. */
static bool read_numbers(double out[SPACE], const json_t *list, size_t rank)
{
    size_t count = json_array_size(list);
    bool good = count >= SPACE && (!rank || count == rank);
    for (size_t i = 0; good && i < SPACE; i++) {
        const json_t *number = json_array_get(list, count - SPACE + i);
        out[i] = json_number_value(number);
        good = json_is_number(number) && isfinite(out[i]);
    }
    return good;
}

/* Carries the level on by one transformation. */
static void apply_one(struct job *job, struct ome_level *level, const json_t *step, size_t rank)
{
    const char *type = text_of(json_object_get(step, "type"));
    bool is_scale = strcmp(type, "scale") == 0;
    double numbers[SPACE];
    if (strcmp(type, "identity") == 0) {
        return;
    }
    if (!is_scale && strcmp(type, "translation") != 0) {
        job_refuse(job, "coordinateTransformations: found \"%.*s\", allowed are scale and translation", ZARR_NAME,
                   type);
    } else if (!read_numbers(numbers, json_object_get(step, type), rank)) {
        job_bad(job, "coordinateTransformations: %s: a number for each axis is needed", type);
    }
    for (size_t i = 0; job_ok(job) && i < SPACE; i++) {
        level->scale[i] *= is_scale ? numbers[i] : 1;
        level->translation[i] = is_scale ? level->translation[i] * numbers[i] : level->translation[i] + numbers[i];
        if (is_scale && !(numbers[i] > 0)) {
            job_bad(job, "coordinateTransformations: scale: found %g, above 0 is needed", numbers[i]);
        }
    }
}

static void apply_all(struct job *job, struct ome_level *level, const json_t *list, size_t rank)
{
    const json_t *first = json_array_get(list, 0);
    bool is_sequence = json_array_size(list) == 1 && strcmp(text_of(json_object_get(first, "type")), "sequence") == 0;
    const json_t *steps = is_sequence ? json_object_get(first, "transformations") : list;
    if (json_array_size(steps) > STEPS) {
        job_bad(job, "coordinateTransformations: found %zu, allowed are %d", json_array_size(steps), STEPS);
    }
    for (size_t i = 0; job_ok(job) && i < json_array_size(steps); i++) {
        apply_one(job, level, json_array_get(steps, i), rank);
    }
}

/* Whether the path is that of a folder below. */
static bool is_below(const char *path)
{
    struct text part;
    bool good = !path_is_whole(path) && path_base(path)[0];
    while (good && path_part(&path, &part.data, &part.size)) {
        good = part.size && !text_equal(part, ".") && !text_equal(part, "..");
    }
    return good;
}

/* Reads a level; `common` are the transformations of the image, NULL if it has none. */
static void read_level(struct job *job, struct ome *out, const json_t *dataset, const json_t *common,
                       const double units[SPACE])
{
    struct ome_level level = {.scale = {1, 1, 1}};
    const char *path = text_of(json_object_get(dataset, "path"));
    const json_t *own = json_object_get(dataset, "coordinateTransformations");
    if (!is_below(path)) {
        job_bad(job, "datasets: path: found \"%.*s\", a folder below is needed", ZARR_NAME, path);
    }
    apply_all(job, &level, own, out->rank);
    apply_all(job, &level, common, out->rank);
    for (size_t i = 0; i < SPACE; i++) {
        level.scale[i] *= json_array_size(own) || json_array_size(common) ? units[i] : 0;
        level.translation[i] *= units[i];
    }
    level.path = job_copy(job, text_from(path));
    if (job_ok(job)) {
        out->levels[out->count++] = level;
    }
}

static void read_image(struct job *job, struct ome *out, const json_t *attributes)
{
    const json_t *image = json_array_get(json_object_get(attributes, "multiscales"), 0);
    const json_t *datasets = json_object_get(image, "datasets");
    const json_t *inside = json_object_get(image, "coordinateSystems");
    const json_t *systems = inside ? inside : json_object_get(attributes, "coordinateSystems");
    /* those of an image lead on from its axes since 0.6 */
    const json_t *common = systems ? NULL : json_object_get(image, "coordinateTransformations");
    double units[SPACE] = {0};
    size_t count = json_array_size(datasets);
    if (!count || count > LEVELS) {
        job_bad(job, "multiscales: found %zu levels, allowed are 1 to %d", count, LEVELS);
    }
    read_axes(job, out, units, find_axes(image, systems));
    out->levels = job_zeroed(job, count, sizeof *out->levels);
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        read_level(job, out, json_array_get(datasets, i), common, units);
    }
}

void ome_parse(struct job *job, struct ome *out, struct text text)
{
    json_t *root = NULL;
    *out = (struct ome){0};
    if (JOB_CALL(job, json_text_load(&root, text))) {
        const json_t *attributes = json_object_get(root, "attributes");
        read_image(job, out, attributes ? json_object_get(attributes, "ome") : root);
    }
    json_decref(root);
    *out = job_ok(job) ? *out : (struct ome){0};
}
