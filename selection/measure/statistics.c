/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds up pixels, intervals and voxels per object, and makes results of the sums. */
#include "selection/measure/measure.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"

#include <stdlib.h>
#include <string.h>

static const uint32_t NO_PIXEL = UINT32_MAX;

/* The sums of one object over its pixels and intervals so far. */
struct tallied {
    bool touched;
    uint32_t pixels;
    uint32_t pixel; /* of its contact so far */
    uint32_t own;   /* the object that this one hit, whatever it is reported as, */
    uint64_t voxel; /* and where */
    double weight;
    double soft, soft_squares; /* w W of its pixels, and squares of those at its outline */
    uint32_t square;           /* cone_square() of that pixel */
    double contact_distance;   /* and its distance */
    double nearest;
    uint32_t pierced;
    uint32_t last_pixel; /* the last pixel that pierced it, */
    double run_entry;    /* entry of its last run of intervals there without a gap, */
    double last_exit;    /* and the exit of that run */
    double entry, exit;
    double length; /* union of all its intervals, over all rays, without the last run */
    double volume; /* of its meshes, by rays                 */
    double solid;  /* of its surfaces in the region,         */
    bool is_solid; /* where that was counted                 */
    bool in_grid;  /* some of it is voxels,                  */
    uint64_t voxels;
    double mm3; /* volume of the voxels in the cone */
    double value, maximum;
    double moment[3];                     /* sum of position times weight; a weight is a number of voxels, or a value */
    double weight_in_grid;                /* sum of the weights */
    double point[3];                      /* the nearest point, where the question is what is near */
    double point_value;                   /* the value at the nearest point */
    const struct tract_part *streamlines; /* of a bundle, in the cone; NULL = none, or not counted */
    struct dose dose;                     /* of its voxels, mm^3 in place of their number */
};

/* The sums of the whole cone. */
struct totals {
    double weight; /* of its pixels       */
    double areas;  /* mm^3 of areas in it */
};

void statistics_finish(struct statistics *statistics)
{
    memory_free(statistics->results);
    *statistics = (struct statistics){0};
}

conus_status tally_prepare(struct tally *tally, size_t object_count)
{
    if (tally->objects && tally->object_count >= object_count) {
        return CONUS_OK;
    }
    struct tally larger = {.object_count = object_count};
    larger.objects = memory_zeroed(object_count + 1, sizeof *larger.objects);
    larger.touched = memory_raw(object_count + 1, sizeof *larger.touched);
    if (!larger.objects || !larger.touched) {
        tally_finish(&larger);
        return CONUS_ERROR_MEMORY;
    }
    tally_finish(tally);
    *tally = larger;
    return CONUS_OK;
}

void tally_finish(struct tally *tally)
{
    memory_free(tally->objects);
    memory_free(tally->touched);
    *tally = (struct tally){0};
}

static struct tallied *touch(struct tally *tally, uint32_t object)
{
    struct tallied *tallied = &tally->objects[object];
    if (!tallied->touched) {
        *tallied = (struct tallied){.touched = true,
                                    .square = UINT32_MAX,
                                    .last_pixel = NO_PIXEL,
                                    .entry = INFINITY,
                                    .nearest = INFINITY,
                                    .maximum = -INFINITY,
                                    .dose = {.largest = -1}};
        tally->touched[tally->touched_count++] = object;
    }
    return tallied;
}

static uint32_t group_of(const struct gathering *gathering, uint32_t object)
{
    return gathering->group ? gathering->group[object] : object;
}

/* Adds the pixels in the cone from number `first` on, while they hit the same object; gives the number behind them. The
 * contact is at the smallest r, of equal ones at the nearest (Eq. 11). */
static size_t add_run(struct tallied *object, const struct aperture *aperture, const struct evidence *evidence,
                      size_t first)
{
    const uint32_t *inside = aperture->inside;
    const double *distances = evidence->distance;
    uint32_t hit = evidence->object[inside[first]];
    uint32_t contact = object->pixel; /* what is added up is here, or it would go to memory and back each time */
    uint32_t square = object->square;
    double contact_distance = object->contact_distance;
    double nearest = object->nearest;
    double weight = object->weight;
    size_t k = first;
    do {
        uint32_t pixel = inside[k++];
        uint32_t s = aperture->square[pixel];
        double distance = distances[pixel];
        bool better = (s < square) | ((s == square) & (distance < contact_distance));
        contact = better ? pixel : contact;
        square = better ? s : square;
        contact_distance = better ? distance : contact_distance;
        nearest = distance < nearest ? distance : nearest;
        weight += aperture->weight[pixel];
    } while (k < aperture->rays.count && evidence->object[inside[k]] == hit);
    object->pixel = contact;
    object->square = square;
    object->contact_distance = contact_distance;
    object->nearest = nearest;
    object->weight = weight;
    object->pixels += (uint32_t)(k - first);
    return k;
}

static void add_pixels(struct tally *tally, const struct gathering *gathering)
{
    const struct evidence *evidence = gathering->evidence;
    const struct aperture *aperture = gathering->aperture;
    for (size_t k = 0; k < aperture->rays.count;) {
        uint32_t hit = evidence->object[aperture->inside[k]];
        k = add_run(touch(tally, group_of(gathering, hit)), aperture, evidence, k);
    }
    for (size_t i = 0; i < tally->touched_count; i++) {
        struct tallied *object = &tally->objects[tally->touched[i]];
        object->own = evidence->object[object->pixel];
        object->voxel = evidence->voxel[object->pixel];
    }
}

/* The pixels left and right of, below and above one; itself in place of those that are not in the cone. */
static inline void find_beside(uint32_t out[4], uint32_t pixel, uint32_t n, unsigned sides)
{
    out[0] = pixel - (sides & 1);
    out[1] = pixel + (sides >> 1 & 1);
    out[2] = pixel - n * (sides >> 2 & 1);
    out[3] = pixel + n * (sides >> 3 & 1);
}

/* Adds the square of a pixel's weight to its object and each other one beside it, if there is one. */
static void add_outline(struct tally *tally, const struct gathering *gathering, const uint32_t pixels[5], double weight)
{
    uint32_t met[5];
    size_t count = 0;
    for (size_t k = 0; k < 5; k++) {
        const uint32_t object = group_of(gathering, gathering->evidence->object[pixels[k]]);
        size_t at = 0;
        while (at < count && met[at] != object) {
            at++;
        }
        met[at] = object;
        count += at == count;
    }
    for (size_t k = 0; k < count && count > 1; k++) {
        tally->objects[met[k]].soft_squares += weight * weight;
    }
}

/* Adds the weights of pixels, and their squares for all objects at whose outline a pixel is (Eq. 31). */
static void add_soft(struct tally *tally, const struct gathering *gathering)
{
    const struct aperture *aperture = gathering->aperture;
    const struct soft *soft = gathering->soft;
    const uint32_t *objects = gathering->evidence->object;
    for (size_t k = 0; k < aperture->rays.count;) {
        const uint32_t hit = objects[aperture->inside[k]];
        struct tallied *object = &tally->objects[group_of(gathering, hit)];
        double sum = object->soft; /* in a register, as in add_run() */
        do {
            const uint32_t pixel = aperture->inside[k++];
            uint32_t pixels[5] = {[4] = pixel};
            find_beside(pixels, pixel, soft->resolution, soft->sides[pixel]);
            sum += soft->pixels[pixel];
            if ((objects[pixels[0]] != hit) | (objects[pixels[1]] != hit) | (objects[pixels[2]] != hit) |
                (objects[pixels[3]] != hit)) {
                add_outline(tally, gathering, pixels, soft->pixels[pixel]);
            }
        } while (k < aperture->rays.count && objects[aperture->inside[k]] == hit);
        object->soft = sum;
    }
}

/* Between two distances on rays from one point the volume grows with their cubes, on parallel ones with themselves. */
static double volume_between(const struct cone *cone, double from, double to)
{
    return cone->radius > 0 ? to - from : (to * to * to - from * from * from) / 3;
}

/* Intervals of a pixel come by entry, so each adds to their union what reaches beyond the last exit. A run is added in
 * one piece when it ends: so its length has the same bits however it is cut into objects that are reported as one.
 * There is no branch where rays go in and out of an object unpredictably. */
static void add_interval(struct tallied *object, const conus_interval *interval, const struct cone *cone, double weight)
{
    bool is_next_pixel = object->last_pixel != interval->pixel;
    bool is_next_run = is_next_pixel | (interval->entry > object->last_exit);
    const double *begins[] = {&object->run_entry, &interval->entry};
    const double *reaches[] = {&object->last_exit, &interval->entry};
    double last_exit = *reaches[is_next_run];
    object->length += is_next_run * (object->last_exit - object->run_entry);
    object->run_entry = *begins[is_next_run];
    object->pierced += is_next_pixel;
    object->last_pixel = interval->pixel;
    object->entry = interval->entry < object->entry ? interval->entry : object->entry; /* quicker than fmin() */
    object->exit = interval->exit > object->exit ? interval->exit : object->exit;
    object->last_exit = interval->exit > last_exit ? interval->exit : last_exit;
    if (weight > 0 && interval->exit > last_exit) {
        object->volume += weight * volume_between(cone, last_exit, interval->exit);
    }
}

static void add_intervals(struct tally *tally, const struct gathering *gathering)
{
    const struct layers *layers = gathering->layers;
    const struct aperture *aperture = gathering->aperture;
    const bool has_meshes = atlas_has_meshes(gathering->atlas);
    for (size_t s = 0; s < layers->count; s++) {
        const conus_interval *interval = &layers->intervals[s];
        if (aperture->in_cone[interval->pixel]) {
            bool mesh = has_meshes && atlas_object_mesh(gathering->atlas, interval->object);
            struct tallied *object = touch(tally, group_of(gathering, interval->object));
            object->in_grid = object->in_grid || atlas_object_volume(gathering->atlas, interval->object);
            add_interval(object, interval, gathering->cone, mesh ? aperture->weight[interval->pixel] : 0);
        }
    }
}

/* The doses of voxels of so many mm^3 each. */
static void add_dose(struct dose *to, const struct dose *from, double mm3)
{
    to->voxels += from->voxels * mm3;
    to->values += from->values * mm3;
    to->voxels_above += from->voxels_above * mm3;
    dose_note_largest(to, from->largest, from->at, from->voxel);
}

static void add_census(struct tally *tally, const struct gathering *gathering)
{
    const struct census *census = gathering->census;
    const struct volume *parcellation = atlas_parcellation(gathering->atlas);
    for (size_t i = 0; i < census->touched_count; i++) {
        uint32_t number = census->touched[i];
        struct tallied *to = touch(tally, group_of(gathering, number));
        const struct census_count *count = &census->counts[number];
        const struct volume *volume = atlas_object_volume(gathering->atlas, number);
        double weight = census_is_weighted(gathering->atlas, number) ? count->value : (double)count->voxels;
        double centroid[3];
        census_centroid(centroid, census, gathering->atlas, number);
        vec3_add_scaled(to->moment, to->moment, weight, centroid);
        to->weight_in_grid += weight;
        to->maximum = fmax(to->maximum, count->maximum);
        to->value += count->value;
        to->voxels += count->voxels;
        to->mm3 += (double)count->voxels * space_voxel_mm3(&volume->info);
        to->in_grid = true;
        if (gathering->doses) {
            add_dose(&to->dose, &gathering->doses->of[number], space_voxel_mm3(&volume->info));
        }
    }
    if (parcellation) {
        struct tallied *nothing = touch(tally, 0);
        nothing->in_grid = true;
        nothing->voxels += census->counts[0].voxels;
        nothing->mm3 += (double)census->counts[0].voxels * space_voxel_mm3(&parcellation->info);
    }
}

static void add_near(struct tally *tally, const struct gathering *gathering)
{
    const struct near *near = gathering->near;
    for (size_t i = 0; i < near->touched_count; i++) {
        const struct near_object *found = &near->objects[near->touched[i]];
        struct tallied *to = touch(tally, group_of(gathering, near->touched[i]));
        to->in_grid = to->in_grid || !atlas_object_mesh(gathering->atlas, near->touched[i]);
        if (found->distance < to->nearest) {
            to->nearest = found->distance;
            to->point_value = found->value;
            memcpy(to->point, found->point, sizeof to->point);
        }
    }
}

/* Bundles are reported as themselves. In a ball their nearest point is that of the streamlines in it. */
static void add_streamlines(struct tally *tally, const struct gathering *gathering)
{
    const struct tract_census *tracts = gathering->tracts;
    for (size_t i = 0; i < tracts->touched_count; i++) {
        const struct tract_part *part = &tracts->parts[tracts->touched[i]];
        struct tallied *to = touch(tally, group_of(gathering, tracts->touched[i]));
        to->streamlines = part;
        if (gathering->near) {
            to->nearest = sqrt(part->square);
            to->point_value = NAN;
            memcpy(to->point, part->near, sizeof to->point);
        }
    }
}

/* A surface has a result where some of its inside is in the region, though no ray may pass it. */
static void add_solids(struct tally *tally, const struct gathering *gathering)
{
    struct region_solid region;
    region_solid_init(&region, gathering->region);
    for (size_t i = 0; i < gathering->solids->count; i++) {
        const struct solid *solid = &gathering->solids->solids[i];
        uint32_t number = group_of(gathering, solid->object);
        double volume = solid_volume(solid, &region);
        if (volume != 0 || tally->objects[number].touched) {
            struct tallied *to = touch(tally, number);
            to->solid += volume;
            to->is_solid = true;
        }
    }
}

/* mm^3 of surfaces in the cone, measured by their triangles. Where these enclose no known volume, it comes from the
 * rays; `total` is the weight of all of them. */
static double surface_of(const struct tallied *object, const struct gathering *gathering, double total)
{
    double from_rays = object->volume > 0 ? object->volume / total * cone_cross_section(gathering->cone) : 0;
    return object->is_solid ? object->solid : from_rays;
}

/* mm^3 in the cone: voxels are counted. */
static double volume_of(const struct tallied *object, const struct gathering *gathering, double total)
{
    return object->mm3 + surface_of(object, gathering, total);
}

/* What is no voxel, mm^3 or mm, has the mean of W on its rays or along its streamlines; without a ray it is not known.
 */
static void describe_dose(conus_result *result, const struct tallied *object, const struct gathering *gathering,
                          double total)
{
    static const struct dose none = {.largest = -1};
    const struct doses *doses = gathering->doses;
    const struct dose *passed = doses->of[result->object].touched ? &doses->of[result->object] : &none;
    const bool is_bundle = object->streamlines;
    const double extent = is_bundle ? result->length : surface_of(object, gathering, total);
    const double part = extent != 0 ? extent / passed->rays : 0;
    const bool is_known = extent == 0 || passed->rays > 0;
    struct dose sum = object->dose;
    dose_note_largest(&sum, passed->largest, passed->at, passed->voxel);
    result->dose = is_known ? sum.voxels + passed->on_rays * part : NAN;
    result->above = !is_known || isnan(doses->level) ? NAN
                    : is_bundle                      ? passed->lines_above
                                                     : sum.voxels_above + passed->rays_above * part;
    const double whole = is_bundle ? extent : result->volume;
    result->mean_weight = whole > 0 ? result->dose / whole : NAN;
    if (sum.largest >= 0) {
        result->max_weight = sum.largest;
        memcpy(result->max_at, sum.at, sizeof result->max_at);
    }
    if (atlas_object_is_scalar(gathering->atlas, result->object)) {
        result->value_dose = sum.values;
    }
}

/* A fraction that only rounding has made more than 1 is 1. */
static double fraction_of(double volume, double whole)
{
    static const double rounding = 1e-9;
    double fraction = whole > 0 ? volume / whole : NAN;
    return fraction > 1 && fraction < 1 + rounding ? 1 : fraction;
}

static void describe_layers(conus_result *result, const struct tallied *object, const struct gathering *gathering,
                            const struct totals *totals)
{
    bool pathway = result->object > gathering->atlas->area_count;
    result->pierced = object->pierced;
    if (object->pierced) {
        result->entry = object->entry;
        result->exit = object->exit;
        result->path = (object->length + (object->last_exit - object->run_entry)) / object->pierced;
    }
    if (object->in_grid || object->is_solid || object->volume > 0) {
        result->volume = volume_of(object, gathering, totals->weight);
    }
    if (result->object && result->volume >= 0) {
        result->fraction = fraction_of(result->volume, gathering->whole[result->object]);
        result->cone_fraction = pathway || totals->areas == 0 ? NAN : result->volume / totals->areas;
    }
}

conus_result statistics_empty_result(uint32_t number)
{
    conus_result result = {.object = number, .score = NAN, .centre_px = NAN, .offset = NAN, .distance = NAN};
    result.contact[0] = result.contact[1] = result.contact[2] = NAN;
    result.entry = result.exit = result.path = NAN;
    result.volume = result.fraction = result.cone_fraction = NAN;
    result.sum_value = result.mean_value = result.max_value = NAN;
    result.centroid[0] = result.centroid[1] = result.centroid[2] = NAN;
    result.contact_value = NAN;
    result.weight = result.weight_error = result.posterior = NAN;
    result.dose = result.dose_share = result.mean_weight = result.max_weight = NAN;
    result.max_at[0] = result.max_at[1] = result.max_at[2] = NAN;
    result.above = result.above_share = result.value_dose = NAN;
    result.length = result.near[0] = result.near[1] = result.near[2] = result.along = NAN;
    return result;
}

/* The value where the object is hit first. It is that of the voxel that the engine found: the contact lies between two
 * voxels, so its position does not say which. */
static double value_at_contact(const struct tallied *object, const struct gathering *gathering)
{
    const struct volume *volume = atlas_object_volume(gathering->atlas, object->own);
    return volume && volume_has_values(volume) ? (double)volume_value(volume, object->voxel) : NAN;
}

static conus_result describe(uint32_t number, const struct tallied *object, const struct gathering *gathering,
                             const struct totals *totals)
{
    const struct cone *cone = gathering->cone;
    const bool has_values = number && atlas_object_is_scalar(gathering->atlas, number);
    const bool is_bundle = number && gathering->atlas->places[number - 1].is_bundle;
    conus_result result = statistics_empty_result(number);
    result.pixels = object->pixels;
    result.share = object->weight / totals->weight;
    if (gathering->soft && gathering->soft->total > 0) {
        result.weight = object->soft / gathering->soft->total;
        result.weight_error = sqrt(object->soft_squares / 12) / gathering->soft->total;
    }
    if (number && object->pixels) {
        result.centre_px = sqrt(object->square) / 2;
        result.offset = degrees_from_radians(cone_off_axis(cone, cone_radius_of(object->square, cone->resolution)));
        result.distance = object->nearest;
        cone_point(result.contact, cone, object->pixel % cone->resolution, object->pixel / cone->resolution,
                   object->contact_distance);
        result.contact_value = has_values ? value_at_contact(object, gathering) : NAN;
    }
    if (number && gathering->near) {
        result.distance = object->nearest;
        memcpy(result.contact, object->point, sizeof result.contact);
        result.contact_value = has_values ? object->point_value : NAN;
    }
    if (gathering->census) {
        describe_layers(&result, object, gathering, totals);
        result.voxels = object->voxels;
        if (object->weight_in_grid > 0) {
            vec3_scale(result.centroid, object->moment, 1 / object->weight_in_grid);
        }
        if (has_values) {
            result.sum_value = object->value;
        }
        if (has_values && object->voxels) {
            result.mean_value = object->value / (double)object->voxels;
            result.max_value = object->maximum;
        }
    }
    if (is_bundle) {
        result.streamlines_total = gathering->atlas->objects[number - 1].streamlines;
    }
    if (is_bundle && gathering->tracts) {
        result.length = object->streamlines ? tract_part_length(object->streamlines) : 0;
        if (object->streamlines) {
            result.streamlines = object->streamlines->streamlines;
            memcpy(result.near, object->streamlines->near, sizeof result.near);
            result.along =
                tract_index_along(gathering->tract_index, gathering->atlas, result.object, object->streamlines);
        }
    }
    if (gathering->doses && number && (!isnan(result.volume) || object->streamlines)) {
        describe_dose(&result, object, gathering, totals->weight);
    }
    return result;
}

static int by_number(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a - 1; /* what hit nothing is the last */
    uint32_t y = *(const uint32_t *)b - 1;
    return (x > y) - (x < y);
}

conus_status statistics_gather(struct statistics *out, const struct gathering *gathering, struct tally *tally)
{
    struct totals totals = {.weight = gathering->aperture ? gathering->aperture->total_weight : 0};
    if (gathering->aperture) {
        touch(tally, 0);
        add_pixels(tally, gathering);
    }
    if (gathering->aperture && gathering->soft) {
        add_soft(tally, gathering);
    }
    if (gathering->aperture && gathering->layers) {
        add_intervals(tally, gathering);
    }
    if (gathering->near) {
        add_near(tally, gathering);
    }
    if (gathering->tracts) {
        add_streamlines(tally, gathering);
    }
    if (gathering->census) {
        add_census(tally, gathering);
    }
    if (gathering->solids) {
        add_solids(tally, gathering);
    }
    if (gathering->census) {
        for (size_t i = 0; i < tally->touched_count; i++) {
            uint32_t number = tally->touched[i];
            if (number && number <= gathering->atlas->area_count) {
                totals.areas += volume_of(&tally->objects[number], gathering, totals.weight);
            }
        }
    }
    size_t count = tally->touched_count;
    conus_result *results = memory_raw(count, sizeof *results);
    if (results) {
        order_sort(tally->touched, count, sizeof *tally->touched, by_number);
        for (size_t i = 0; i < count; i++) {
            uint32_t number = tally->touched[i];
            results[i] = describe(number, &tally->objects[number], gathering, &totals);
        }
        *out = (struct statistics){results, count};
    }
    for (size_t i = 0; i < count; i++) {
        tally->objects[tally->touched[i]].touched = false;
    }
    tally->touched_count = 0;
    return results ? CONUS_OK : CONUS_ERROR_MEMORY;
}
