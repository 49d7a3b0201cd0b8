/* SPDX-License-Identifier: BSD-3-Clause */
/* How much of a weight falls on each object of a region (Eq. 33): cells of voxels, rays in surfaces, streamlines. */
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/measure/measure.h"
#include "selection/measure/parts.h"

#include <string.h>

/* Gauss's two points between 0 and 1. */
static const double gauss_two[2] = {0.21132486540518712, 0.78867513459481288};

enum { MOST_PARTS = 8, ABOVE_PARTS = 4, MOST_PIECES = 4096 };

/* A weight in a region, whose frame is (right, up, axis) from its origin. */
struct field {
    const conus_weight *weight;
    const struct region *region;
    const conus_atlas *atlas;
    const struct gathering *gathering;
    struct doses *doses;
    double level; /* of the second time; NaN the first time */
};

static void in_frame(double out[3], const struct region *region, const double v[3])
{
    if (region->shape == REGION_BALL) {
        memcpy(out, v, 3 * sizeof *v);
        return;
    }
    const double p[] = {vec3_dot(v, region->right), vec3_dot(v, region->up), vec3_dot(v, region->axis)};
    memcpy(out, p, sizeof p);
}

/* The angle, offset or distance of a place in the frame. */
static double x_of(const struct field *field, const double v[3])
{
    const double square = v[0] * v[0] + v[1] * v[1];
    switch (field->weight->facts.by) {
    case WEIGHT_BY_ANGLE:
        return degrees_from_radians(atan2(sqrt(square), v[2]));
    case WEIGHT_BY_OFFSET:
        return sqrt(square);
    case WEIGHT_BY_DISTANCE:
        return sqrt(square + v[2] * v[2]);
    default:
        return 0;
    }
}

static double value_at(const struct field *field, const double v[3])
{
    return weight_value(field->weight, x_of(field, v), v[2]);
}

static struct dose *dose_of(struct doses *doses, uint32_t number)
{
    struct dose *dose = &doses->of[number];
    if (!dose->touched) {
        *dose = (struct dose){.touched = true, .largest = -1, .last_pixel = UINT32_MAX};
        doses->touched[doses->touched_count++] = number;
    }
    return dose;
}

static uint32_t group_of(const struct field *field, uint32_t number)
{
    return field->gathering->group ? field->gathering->group[number] : number;
}

/* The shortest length in which W changes at a depth. */
static double finest_at(const struct field *field, double z)
{
    return fmin(weight_finest(field->weight, fmax(z, 0)), field->weight->finest[1]);
}

/* The voxels of one volume. */
struct cells {
    const struct field *field;
    double origin[3], step[3][3]; /* voxel 0 and edges in the frame */
    double longest;               /* of the edges, mm */
    double reach;                 /* from a centre to the farthest corner along the axis */
};

static struct cells cells_of(const struct field *field, const struct volume *volume)
{
    const double *m = volume->info.world_from_voxel;
    struct cells cells = {.field = field};
    double v[3];
    vec3_sub(v, m + 12, field->region->origin);
    in_frame(cells.origin, field->region, v);
    for (size_t a = 0; a < 3; a++) {
        in_frame(cells.step[a], field->region, m + 4 * a);
        cells.longest = fmax(cells.longest, vec3_length(cells.step[a]));
        cells.reach += fabs(cells.step[a][2]) / 2;
    }
    return cells;
}

/* out + parts of the edges. */
static void move_by(double out[3], const struct cells *cells, const double from[3], const double parts[3])
{
    for (size_t i = 0; i < 3; i++) {
        out[i] = from[i] + parts[0] * cells->step[0][i] + parts[1] * cells->step[1][i] + parts[2] * cells->step[2][i];
    }
}

/* Into how many parts along each edge a cell is cut; 0: its centre is enough. */
static size_t parts_of(const struct cells *cells, const double centre[3])
{
    const double finest = finest_at(cells->field, centre[2]);
    const bool is_tip = cells->field->weight->facts.begins && fabs(centre[2]) < cells->reach;
    size_t parts = 1;
    if (cells->longest <= finest / 8 && !is_tip) {
        return 0;
    }
    while (parts < MOST_PARTS && (is_tip || cells->longest > finest * (double)parts)) {
        parts *= 2;
    }
    return parts;
}

/* The mean of W over a cell, a table held beyond its ends: Gauss's two points a side in each part. */
static double mean_of(const struct cells *cells, const double centre[3], size_t parts)
{
    const struct field *field = cells->field;
    const size_t count = 2 * parts;
    double sum = 0;
    double at[2 * MOST_PARTS];
    for (size_t i = 0; i < count; i++) {
        const size_t part = i / 2;
        at[i] = ((double)part + gauss_two[i % 2]) / (double)parts - 0.5;
    }
    for (size_t n = 0; n < count * count * count; n++) {
        double v[3];
        move_by(v, cells, centre, (const double[]){at[n % count], at[n / count % count], at[n / count / count]});
        sum += weight_held(field->weight, x_of(field, v), v[2]);
    }
    return sum / (double)(count * count * count);
}

static bool is_above(const struct cells *cells, const double centre[3], const double parts[3])
{
    double v[3];
    move_by(v, cells, centre, parts);
    return weight_held(cells->field->weight, x_of(cells->field, v), v[2]) >= cells->field->level;
}

/* The part of a cell where W is the level or more: of the middles of equal parts, where its corners or the fineness of
 * W leave a doubt. */
static double part_above(const struct cells *cells, const double centre[3], bool is_fine)
{
    const bool inside = is_above(cells, centre, (const double[]){0, 0, 0});
    bool differs = is_fine;
    size_t count = 0;
    for (unsigned n = 0; n < 8 && !differs; n++) {
        const double corner[] = {n & 1 ? 0.5 : -0.5, n & 2 ? 0.5 : -0.5, n & 4 ? 0.5 : -0.5};
        differs = is_above(cells, centre, corner) != inside;
    }
    for (size_t n = 0; n < ABOVE_PARTS * ABOVE_PARTS * ABOVE_PARTS && differs; n++) {
        const size_t i[] = {n % ABOVE_PARTS, n / ABOVE_PARTS % ABOVE_PARTS, n / ABOVE_PARTS / ABOVE_PARTS};
        double parts[3];
        for (size_t a = 0; a < 3; a++) {
            parts[a] = ((double)i[a] + 0.5) / ABOVE_PARTS - 0.5;
        }
        count += is_above(cells, centre, parts);
    }
    return differs ? (double)count / (ABOVE_PARTS * ABOVE_PARTS * ABOVE_PARTS) : inside;
}

void dose_note_largest(struct dose *dose, double value, const double world[3], size_t voxel)
{
    if (value > dose->largest || (value == dose->largest && voxel < dose->voxel)) {
        dose->largest = value;
        dose->voxel = voxel;
        memcpy(dose->at, world, sizeof dose->at);
    }
}

static void add_voxel(const struct cells *cells, const struct volume *volume, const size_t at[3], uint32_t object,
                      double value)
{
    const struct field *field = cells->field;
    struct dose *dose = dose_of(field->doses, object);
    const double index[] = {(double)at[0], (double)at[1], (double)at[2]};
    double centre[3];
    move_by(centre, cells, cells->origin, index);
    const double x = x_of(field, centre);
    const bool is_covered = weight_covers(field->weight, x, centre[2]);
    const size_t parts = is_covered ? parts_of(cells, centre) : 0;
    if (!isnan(field->level)) {
        dose->voxels_above += is_covered ? part_above(cells, centre, parts > 1) : 0;
        return;
    }
    const double there = weight_value(field->weight, x, centre[2]);
    const double mean = parts ? mean_of(cells, centre, parts) : there;
    dose->voxels += mean;
    dose->values += mean * value;
    if (there >= dose->largest) {
        double world[3];
        mat4_point(world, volume->info.world_from_voxel, index);
        dose_note_largest(dose, there, world, at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]));
    }
}

static void add_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    const struct cells *cells = user;
    const size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    const bool has_values = volume_is_scalar(volume);
    for (size_t i = 0; i < count; i++) {
        i = has_values ? volume_next(volume, first + i) - first : i;
        if (i < count) {
            const float value = has_values ? volume_value(volume, first + i) : 0;
            const uint32_t object = has_values ? volume_object_of(volume, value) : volume_object(volume, first + i);
            if (object) {
                add_voxel(cells, volume, (const size_t[]){at[0] + i, at[1], at[2]}, object, (double)value);
            }
        }
    }
}

/* The volumes whose voxels the census counts. */
static void add_volumes(const struct field *field)
{
    for (size_t i = 0; i < field->atlas->volume_count; i++) {
        const struct volume *volume = &field->atlas->volumes[i];
        struct cells cells = cells_of(field, volume);
        if (volume->info.role == CONUS_ROLE_PARCELLATION) {
            census_walk(field->region, volume, add_row, &cells);
        } else if (volume_is_scalar(volume) && volume_can_be_hit(volume)) {
            census_walk_box(field->region, volume, &volume->box, add_row, &cells);
        }
    }
}

/* A line in the frame, from + t along. */
struct line {
    double from[3], along[3];
};

static void line_at(double out[3], const struct line *line, double t)
{
    vec3_add_scaled(out, line->from, t, line->along);
}

static struct line line_between(const struct region *region, const double from[3], const double along[3])
{
    struct line line;
    double v[3];
    vec3_sub(v, from, region->origin);
    in_frame(line.from, region, v);
    in_frame(line.along, region, along);
    return line;
}

/* Where a piece from t to at most `end` ends: a part of the shortest length on, or at the next depth of a table. */
static double piece_end(const struct field *field, const struct line *line, double t, double end, double part)
{
    const conus_weight *weight = field->weight;
    double v[3];
    line_at(v, line, t);
    const double speed = vec3_length(line->along);
    const double step = fmax(part * finest_at(field, v[2]) / speed, (end - t) / MOST_PIECES);
    double next = fmin(t + step, end);
    for (size_t k = 0; weight->facts.by_depth && weight->at && line->along[2] > 0 && k < weight->counts[1]; k++) {
        const double at = (weight->at[weight->counts[0] + k] - line->from[2]) / line->along[2];
        next = at > t + 1e-9 * (1 + fabs(t)) && at < next ? at : next;
    }
    return end - next < 1e-12 * (1 + fabs(end)) ? end : next;
}

static void note_on_line(const struct field *field, struct dose *dose, const double v[3], double value)
{
    const struct region *region = field->region;
    double world[3];
    if (value > dose->largest) {
        memcpy(world, region->origin, sizeof world);
        if (region->shape == REGION_BALL) {
            vec3_add_scaled(world, world, 1, v);
        } else {
            vec3_add_scaled(world, world, v[0], region->right);
            vec3_add_scaled(world, world, v[1], region->up);
            vec3_add_scaled(world, world, v[2], region->axis);
        }
        dose_note_largest(dose, value, world, 0);
    }
}

/* Adds a part of a region where W has this value; the second time, whether it is above the level. */
static void add_part(const struct field *field, struct dose *dose, double part, double value)
{
    if (isnan(field->level)) {
        dose->rays += part;
        dose->on_rays += part * value;
    } else {
        dose->rays_above += value >= field->level ? part : 0;
    }
}

/* Adds what a ray passes of a surface from `from` to `to`, mm. */
static void add_piece(const struct field *field, struct dose *dose, const struct line *line, double weight, double from,
                      double to)
{
    const bool is_cone = field->region->shape == REGION_CONE;
    double end = from;
    while (end < to) {
        const double t = end;
        end = field->weight->facts.by_depth ? piece_end(field, line, t, to, 0.5) : to;
        for (size_t i = 0; i <= GAUSS_POINTS; i++) { /* and its end, where W may be the largest */
            double v[3];
            const double at = i < GAUSS_POINTS ? t + gauss_rule[i].at * (end - t) : t;
            line_at(v, line, at);
            const double value = value_at(field, v);
            const double part =
                i < GAUSS_POINTS ? weight * gauss_rule[i].weight * (end - t) * (is_cone ? at * at : 1) : 0;
            add_part(field, dose, part, value);
            if (isnan(field->level)) {
                note_on_line(field, dose, v, value);
            }
        }
    }
}

/* Surfaces, by the union of their intervals on each ray. */
static void add_surfaces(const struct field *field)
{
    const struct gathering *gathering = field->gathering;
    const struct cone *cone = gathering->cone;
    for (size_t s = 0; s < gathering->layers->count; s++) {
        const conus_interval *interval = &gathering->layers->intervals[s];
        if (!gathering->aperture->in_cone[interval->pixel] || !atlas_object_mesh(field->atlas, interval->object)) {
            continue;
        }
        struct dose *dose = dose_of(field->doses, group_of(field, interval->object));
        const bool is_next = dose->last_pixel != interval->pixel || interval->entry > dose->last_exit;
        const double from = is_next ? interval->entry : dose->last_exit;
        dose->last_pixel = interval->pixel;
        dose->last_exit = fmax(from, interval->exit);
        if (interval->exit > from) {
            double origin[3];
            double ray[3];
            const uint32_t i = interval->pixel % cone->resolution;
            const uint32_t j = interval->pixel / cone->resolution;
            cone_origin(origin, cone, i, j);
            cone_ray(ray, cone, i, j);
            const struct line line = line_between(field->region, origin, ray);
            add_piece(field, dose, &line, gathering->aperture->weight[interval->pixel], from, interval->exit);
        }
    }
}

/* Surfaces in a ball: of the volume in shells between distances, which is exact, each counts by the weight there. */
static void add_solids(const struct field *field)
{
    enum { SHELLS = 256 };
    const struct solids *solids = field->gathering->solids;
    for (size_t s = 0; s < solids->count; s++) {
        const struct solid *solid = &solids->solids[s];
        const struct mesh_shape *shape = &solid->mesh->shape;
        struct dose *dose = region_box(field->region, shape->low, shape->high) == TRACT_OUTSIDE
                                ? NULL
                                : dose_of(field->doses, group_of(field, solid->object));
        double before = 0;
        for (size_t i = 1; i <= SHELLS && dose; i++) {
            struct region ball;
            struct region_solid cut;
            const double radius = field->region->radius * (double)i / SHELLS;
            const double inner = field->region->radius * (double)(i - 1) / SHELLS;
            region_ball(&ball, field->region->origin, radius);
            region_solid_init(&cut, &ball);
            const double volume = solid_volume(solid, &cut);
            const double shell = fmax(volume - before, 0);
            const double middle = cbrt((inner * inner * inner + radius * radius * radius) / 2);
            const double value = weight_value(field->weight, middle, 0);
            before = volume;
            add_part(field, dose, shell, value);
            if (isnan(field->level) && shell > 0 && value > dose->largest) {
                dose_note_largest(dose, value, (const double[]){NAN, NAN, NAN}, 0);
            }
        }
    }
}

/* The streamlines of one tractogram. */
struct lines {
    const struct field *field;
    const struct tractogram *tractogram;
    const struct tract_owners *owners;
};

/* Whose streamline a run is of: gives the next bundle that is shown from *i on; NULL where there is no more. */
static struct dose *next_owner(const struct lines *lines, uint32_t streamline, uint64_t *i)
{
    const struct tract_owners *owners = lines->owners;
    const uint64_t end = owners->all ? 1 : owners->first[streamline + 1];
    while (*i < end) {
        const uint32_t number = owners->all ? owners->all : owners->bundles[*i];
        (*i)++;
        if (!lines->field->atlas->places[number - 1].is_hidden) {
            return dose_of(lines->field->doses, number);
        }
    }
    return NULL;
}

/* Adds the part s of a segment; W may be the largest at the ends of steps. */
static void add_segment(const struct field *field, struct dose *dose, double ends[2][3], const double s[2])
{
    double along[3];
    vec3_sub(along, ends[1], ends[0]);
    const struct line line = line_between(field->region, ends[0], along);
    const double length = vec3_length(along);
    double v[3];
    double end = s[0];
    while (end < s[1] && length > 0) {
        const double t = end;
        end = piece_end(field, &line, t, s[1], 0.25);
        for (size_t i = 0; i < GAUSS_POINTS; i++) {
            const double part = gauss_rule[i].weight * (end - t) * length;
            line_at(v, &line, t + gauss_rule[i].at * (end - t));
            dose->rays += part;
            dose->on_rays += part * value_at(field, v);
        }
        line_at(v, &line, t);
        note_on_line(field, dose, v, value_at(field, v));
    }
    line_at(v, &line, s[1]);
    note_on_line(field, dose, v, value_at(field, v));
}

static void add_run(void *user, const struct tract_run *run, const struct tract_part *part)
{
    const struct lines *lines = user;
    const struct field *field = lines->field;
    struct dose run_dose = {.largest = -1};
    double points[TRACT_RUN + 1][3];
    bool inside[TRACT_RUN + 1];
    (void)part;
    for (uint32_t i = 0; i <= run->segments; i++) {
        tractogram_point(points[i], lines->tractogram, run->point + i);
        inside[i] = region_has(field->region, points[i]);
    }
    for (uint32_t i = 0; i < run->segments || i == 0; i++) { /* one point is a segment of no length */
        const uint32_t next = i < run->segments ? i + 1 : i;
        double ends[2][3];
        double s[2];
        memcpy(ends[0], points[i], sizeof ends[0]);
        memcpy(ends[1], points[next], sizeof ends[1]);
        if (region_segment(s, field->region, ends, (const bool[]){inside[i], inside[next]})) {
            add_segment(field, &run_dose, ends, s);
        }
    }
    uint32_t *seen = &field->doses->seen[lines->owners->before + run->streamline];
    const bool is_first = run_dose.largest >= field->level && *seen != field->doses->region;
    *seen = is_first ? field->doses->region : *seen;
    uint64_t i = lines->owners->all ? 0 : lines->owners->first[run->streamline];
    for (struct dose *dose; (dose = next_owner(lines, run->streamline, &i));) {
        if (isnan(field->level)) {
            dose->rays += run_dose.rays;
            dose->on_rays += run_dose.on_rays;
            dose_note_largest(dose, run_dose.largest, run_dose.at, (size_t)run->point);
        } else {
            dose->lines_above += is_first;
        }
    }
}

static void add_streamlines(const struct field *field)
{
    const struct tract_index *index = field->gathering->tract_index;
    if (++field->doses->region == 0) { /* after 2^32 of them */
        memset(field->doses->seen, 0, index->streamline_count * sizeof *field->doses->seen);
        field->doses->region = 1;
    }
    for (size_t i = 0; i < index->tractogram_count; i++) {
        struct lines lines = {field, &field->atlas->tractograms[i], &index->of[i]};
        tract_census_walk(lines.tractogram, field->region, add_run, &lines);
    }
}

static void add_all(const struct field *field)
{
    const struct gathering *gathering = field->gathering;
    for (size_t i = 0; i < field->doses->touched_count; i++) {
        field->doses->of[field->doses->touched[i]].last_pixel = UINT32_MAX;
    }
    add_volumes(field);
    if (gathering->layers && atlas_has_meshes(field->atlas)) {
        add_surfaces(field);
    }
    if (field->region->shape == REGION_BALL) {
        add_solids(field);
    }
    if (gathering->tracts) {
        add_streamlines(field);
    }
}

/* The largest W in any area; -1 where there is none. */
static double largest_of_areas(const struct doses *doses, const conus_atlas *atlas)
{
    double largest = -1;
    for (size_t i = 0; i < doses->touched_count; i++) {
        const uint32_t number = doses->touched[i];
        largest = number <= atlas->area_count ? fmax(largest, doses->of[number].largest) : largest;
    }
    return largest;
}

static double find_level(const struct doses *doses, const struct field *field)
{
    const struct weight_facts *facts = &field->weight->facts;
    const double areas = largest_of_areas(doses, field->atlas);
    const double unit = facts->above == ABOVE_LEVEL     ? 1
                        : facts->above == ABOVE_LARGEST ? dose_largest(field->weight, field->region)
                                                        : areas;
    return areas >= 0 && unit > 0 ? facts->level * unit : NAN;
}

static bool is_same_shape(const struct region *a, const struct region *b)
{
    return a->shape == b->shape && a->square == b->square && a->slope == b->slope && a->radius == b->radius &&
           a->near == b->near && a->far == b->far;
}

/* Integrals over the whole region, which many regions of a run share. */
static void measure_whole(struct doses *doses, const struct field *field)
{
    const bool is_measured =
        is_same_shape(&doses->measured, field->region) && doses->measured.radius + doses->measured.far > 0;
    if (!is_measured) {
        doses->whole = dose_whole(field->weight, field->region, NAN);
        doses->measured_level = NAN;
    }
    if (isnan(doses->level)) {
        doses->whole_above = NAN;
        doses->measured_level = NAN;
    } else if (doses->level != doses->measured_level) {
        doses->whole_above = dose_whole(field->weight, field->region, doses->level);
        doses->measured_level = doses->level;
    }
    doses->measured = *field->region;
}

conus_status doses_prepare(struct doses *doses, const conus_atlas *atlas, const struct tract_index *index)
{
    if (!doses->of) {
        doses->of = memory_zeroed(atlas->object_count + 1, sizeof *doses->of);
        doses->touched = memory_raw(atlas->object_count + 1, sizeof *doses->touched);
    }
    if (index && !doses->seen) {
        doses->seen = memory_zeroed(index->streamline_count + 1, sizeof *doses->seen);
    }
    return doses->of && doses->touched && (doses->seen || !index) ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void doses_finish(struct doses *doses)
{
    memory_free(doses->of);
    memory_free(doses->touched);
    memory_free(doses->seen);
    *doses = (struct doses){0};
}

void doses_take(struct doses *doses, const struct gathering *gathering)
{
    struct field field = {.weight = gathering->weight,
                          .region = gathering->region,
                          .atlas = gathering->atlas,
                          .gathering = gathering,
                          .doses = doses,
                          .level = NAN};
    for (size_t i = 0; i < doses->touched_count; i++) {
        doses->of[doses->touched[i]].touched = false;
    }
    doses->touched_count = 0;
    add_all(&field);
    doses->level = field.level = find_level(doses, &field);
    if (!isnan(field.level)) {
        add_all(&field);
    }
    measure_whole(doses, &field);
}

void doses_share(conus_result *results, size_t count, const struct doses *doses, const conus_atlas *atlas)
{
    double sums[2] = {0};
    for (size_t i = 0; i < count; i++) {
        const bool is_area = results[i].object && results[i].object <= atlas->area_count;
        sums[0] += is_area && !isnan(results[i].dose) ? results[i].dose : 0;
        sums[1] += is_area && !isnan(results[i].above) ? results[i].above : 0;
    }
    const double wholes[] = {fmax(doses->whole, sums[0]),
                             isnan(doses->level) ? NAN : fmax(doses->whole_above, sums[1])};
    for (size_t i = 0; i < count; i++) {
        conus_result *result = &results[i];
        const bool has_part = wholes[0] > 0 && isfinite(wholes[0]) && result->kind != CONUS_KIND_BUNDLE;
        const bool has_above = wholes[1] > 0 && isfinite(wholes[1]) && result->kind != CONUS_KIND_BUNDLE;
        if (!result->object) {
            result->dose = isfinite(wholes[0]) ? wholes[0] - sums[0] : NAN;
            result->above = isfinite(wholes[1]) ? wholes[1] - sums[1] : NAN;
        }
        result->dose_share = has_part ? result->dose / wholes[0] : NAN;
        result->above_share = has_above ? result->above / wholes[1] : NAN;
    }
}
