/* SPDX-License-Identifier: BSD-3-Clause */
/* What --atlas-transform did to the atlas. */
#include "cli/answers/info_place.h"

#include <math.h>

/* False where there is nothing to show. */
static bool find_place(conus_placement *out, const conus_atlas *atlas)
{
    *out = (conus_placement)CONUS_PLACEMENT_INIT;
    return !conus_atlas_placement(out, atlas) && out->is_moved;
}

void info_drop_rounding(double *numbers, size_t count, double scale)
{
    for (size_t i = 0; i < count; i++) {
        scale = fmax(scale, fabs(numbers[i]));
    }
    for (size_t i = 0; i < count; i++) {
        numbers[i] = fabs(numbers[i]) <= 1e-7 * scale ? 0 : numbers[i];
    }
}

/* Without the sign of what is shown as 0.0. */
static double tenths(double value)
{
    return fabs(value) < 0.05 ? 0 : value;
}

static void put_box(FILE *out, const char *what, const double low[3], const double high[3])
{
    fprintf(out, "  %s x %.1f to %.1f, y %.1f to %.1f, z %.1f to %.1f mm\n", what, tenths(low[0]), tenths(high[0]),
            tenths(low[1]), tenths(high[1]), tenths(low[2]), tenths(high[2]));
}

void info_put_reach(FILE *out, const double low[3], const double high[3])
{
    double ends[6];
    for (size_t a = 0; a < 6; a++) {
        ends[a] = a % 2 ? high[a / 2] : low[a / 2];
    }
    info_drop_rounding(ends, 6, 0);
    fprintf(out, "  reaches      x %.6g to %.6g, y %.6g to %.6g, z %.6g to %.6g mm\n", ends[0], ends[1], ends[2],
            ends[3], ends[4], ends[5]);
}

static bool has_context_volume(const conus_atlas *atlas)
{
    bool found = false;
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        found = found || conus_atlas_volume(atlas, i)->role == CONUS_ROLE_CONTEXT;
    }
    return found;
}

static void put_context(FILE *out, const conus_atlas *atlas, const conus_placement *place)
{
    bool is_volume = has_context_volume(atlas);
    fprintf(out, "  in context   %.1f %% of its voxels in the %s", 100 * place->in_grid,
            is_volume ? "grid" : "box around the closed surfaces");
    if (!is_volume) {
        fprintf(out, ", %.1f %% in the head (in them, and what they enclose)", 100 * place->in_head);
    } else if (isfinite(place->head_threshold)) {
        fprintf(out, ", %.1f %% in the head (values from %.4g on, and what they enclose)", 100 * place->in_head,
                place->head_threshold);
    }
    fputc('\n', out);
}

void info_place_put(FILE *out, const conus_atlas *atlas)
{
    conus_placement place;
    if (!find_place(&place, atlas)) {
        return;
    }
    fputs("\nMoved\n", out);
    if (!place.is_warped) {
        fprintf(out, "  volume       1 mm^3 of the atlas is %.4g mm^3 here\n", place.growth);
        fprintf(out, "  sides        left and right are %s\n", place.mirrors ? "exchanged" : "kept");
    }
    fprintf(out, "  centre       %.1f, %.1f, %.1f mm, %.1f mm from where its files have it\n", tenths(place.centre[0]),
            tenths(place.centre[1]), tenths(place.centre[2]), place.distance_mm);
    if (!place.is_warped) {
        put_box(out, "areas were  ", place.own_low, place.own_high);
    }
    put_box(out, "areas are   ", place.low, place.high);
    if (place.has_context) {
        put_context(out, atlas, &place);
    }
}

static json_t *point(const double p[3])
{
    return isfinite(p[0] + p[1] + p[2]) ? json_pack("[f,f,f]", p[0], p[1], p[2]) : json_null();
}

static json_t *in_context(const conus_placement *place)
{
    bool known = isfinite(place->head_threshold);
    return json_pack("{s:f,s:o,s:o}", "in_grid", place->in_grid, "in_head",
                     known ? json_real(place->in_head) : json_null(), "head_threshold",
                     known ? json_real(place->head_threshold) : json_null());
}

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *matrix(const conus_placement *place)
{
    const double *m = place->atlas_from_world;
    json_t *rows = place->is_warped ? NULL : json_array();
    for (size_t i = 0; rows && i < 4; i++) {
        json_array_append_new(rows, json_pack("[f,f,f,f]", m[i], m[4 + i], m[8 + i], m[12 + i]));
    }
    return rows ? rows : json_null();
}

json_t *info_place_json(const conus_atlas *atlas)
{
    conus_placement place;
    if (!find_place(&place, atlas)) {
        return json_null();
    }
    return json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "atlas_from_world", matrix(&place), "growth",
                     number(place.growth), "mirrors", place.is_warped ? json_null() : json_boolean(place.mirrors),
                     "centre", point(place.centre), "distance_mm", number(place.distance_mm), "own_low",
                     point(place.own_low), "own_high", point(place.own_high), "low", point(place.low), "high",
                     point(place.high), "context", place.has_context ? in_context(&place) : json_null());
}
