/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of scores, and the ranking by a formula over them. */
#include "selection/measure/score.h"

#include "base/geometry/math3.h"
#include "base/order.h"
#include "conus/own.h"

#define MM_PER_M 1000.0

/* Weights of MRTK3's FuzzyGazeInteractor, of metres and of degrees. */
#define MRTK_DISTANCE_WEIGHT 0.25
#define MRTK_ANGLE_WEIGHT 1.0

static double clamp(double value)
{
    return fmin(1, fmax(0, value));
}

static double by_share(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return result->share;
}

/* r of the pixel closest to the centre. */
static double radius_of(const conus_result *result, const struct cone *cone)
{
    return 2 * result->centre_px / cone->resolution;
}

/* The result's offset, radians. */
static double off_axis(const conus_result *result, const struct cone *cone)
{
    return cone_off_axis(cone, radius_of(result, cone));
}

static double by_centre(const conus_result *result, const struct score_view *view)
{
    const struct cone *cone = view->cone;
    return !result->pixels    ? 0
           : cone->radius > 0 ? 1 - radius_of(result, cone)
                              : 1 - off_axis(result, cone) / (cone->angle / 2);
}

static double by_distance(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return -result->distance;
}

static const struct memory *memory_of(const conus_result *result, const struct score_view *view)
{
    return view->history ? history_find(view->history, result->object) : NULL;
}

static double by_time(const conus_result *result, const struct score_view *view)
{
    const struct memory *memory = memory_of(result, view);
    return memory ? history_time(view->history, memory) : 0;
}

static double by_stability(const conus_result *result, const struct score_view *view)
{
    const struct memory *memory = memory_of(result, view);
    return memory ? history_stability(view->history, memory) : 0;
}

static double by_nearness(const conus_result *result, const struct score_view *view)
{
    double length = view->far - view->near;
    return !result->pixels ? 0 : length > 0 ? clamp(1 - (result->distance - view->near) / length) : 1;
}

static double by_visibility(const conus_result *result, const struct score_view *view)
{
    return (double)result->pixels / view->cone_pixels;
}

static double by_proximity(const conus_result *result, const struct score_view *view)
{
    return result->pixels ? clamp(1 - radius_of(result, view->cone)) : 0;
}

static double by_unoccluded(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return result->pierced ? clamp((double)result->pixels / result->pierced) : 0;
}

static double by_streamlines(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return result->streamlines_total ? (double)result->streamlines / (double)result->streamlines_total : 0;
}

static double by_intenselect(const conus_result *result, const struct score_view *view)
{
    const struct memory *memory = memory_of(result, view);
    return memory ? memory->intent : 0;
}

static double by_intenselect_plus(const conus_result *result, const struct score_view *view)
{
    const struct memory *memory = memory_of(result, view);
    return memory ? memory->plus : 0;
}

/* From the apex to the contact, m. */
static double contact_distance(const conus_result *result, const struct cone *cone)
{
    double way[3];
    vec3_sub(way, result->contact, cone->pose.world_from_device + 12);
    return vec3_length(way) / MM_PER_M;
}

static double by_mrtk(const conus_result *result, const struct score_view *view)
{
    return -(MRTK_DISTANCE_WEIGHT * contact_distance(result, view->cone) + MRTK_ANGLE_WEIGHT * result->offset);
}

static double by_smallest(const conus_result *result, const struct score_view *view)
{
    double part = (double)result->pixels / view->cone_pixels;
    return !result->pixels || view->on_border[result->object] ? part : 2 - part;
}

static double by_weight(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return result->weight;
}

static double by_posterior(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return result->posterior;
}

static double by_dose(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return result->dose;
}

static double by_dose_share(const conus_result *result, const struct score_view *view)
{
    (void)view;
    return result->dose_share;
}

static const struct score scores[] = {
    {{.name = "share", .description = "part of the cone's solid angle, 0 to 1"}, .value = by_share},
    {{.name = "centre", .description = "closeness to the axis: 1 on it, 0 on the cone's surface, linear in the angle"},
     .value = by_centre},
    {{.name = "distance", .description = "nearness to the apex: minus the distance in mm"}, .value = by_distance},
    {{.name = "time",
      .description = "SenseShapes: part of the last seconds that it was in the cone, 0 to 1",
      .needs_history = true},
     .value = by_time,
     .history = HISTORY_WINDOW},
    {{.name = "stability",
      .description = "SenseShapes: 1 if it neither entered nor left lately, 0 if it did 20 times a second",
      .needs_history = true},
     .value = by_stability,
     .history = HISTORY_WINDOW},
    {{.name = "nearness", .description = "SenseShapes' distance: 1 where the atlas begins, 0 where it ends"},
     .value = by_nearness,
     .needs_box = true},
    {{.name = "visibility", .description = "SenseShapes: part of the cone's pixels, 0 to 1"}, .value = by_visibility},
    {{.name = "proximity", .description = "SenseShapes' centre proximity: 1 in the buffer's centre, 0 at its rim"},
     .value = by_proximity},
    {{.name = "unoccluded", .description = "part of its pixels that nothing hides, 0 to 1", .needs_layers = true},
     .value = by_unoccluded},
    {{.name = "streamlines",
      .description = "part of a bundle's streamlines that come into the cone, 0 to 1",
      .needs_layers = true},
     .value = by_streamlines},
    {{.name = "intenselect",
      .description = "IntenSelect: closeness to the axis, filtered in time",
      .needs_history = true},
     .value = by_intenselect,
     .history = HISTORY_INTENT},
    {{.name = "intenselect_plus",
      .description = "IntenSelect+: the same, growing faster than it decays",
      .needs_history = true},
     .value = by_intenselect_plus,
     .history = HISTORY_PLUS},
    {{.name = "mrtk", .description = "MRTK's mixture: minus (a quarter of the metres plus the degrees off the axis)"},
     .value = by_mrtk},
    {{.name = "smallest", .description = "fewest pixels first of what does not touch the rim, then most pixels"},
     .value = by_smallest,
     .needs_border = true},
    {{.name = "weight", .description = "part of the weights of all rays, 0 to 1", .needs_weight = true},
     .value = by_weight,
     .needs_rays = true},
    {{.name = "posterior",
      .description = "probability that it is meant, by its weight and a prior",
      .needs_weight = true},
     .value = by_posterior,
     .needs_rays = true,
     .needs_posterior = true},
    {{.name = "dose",
      .description = "integral of the weight over its part in the cone",
      .needs_layers = true,
      .needs_weight = true},
     .value = by_dose},
    {{.name = "dose_share",
      .description = "the same as a part of that of the whole cone, 0 to 1",
      .needs_layers = true,
      .needs_weight = true},
     .value = by_dose_share},
};

enum { SCORE_COUNT = sizeof scores / sizeof scores[0] };

const conus_score_info *conus_score(size_t index)
{
    return index < SCORE_COUNT ? &scores[index].info : NULL;
}

static const char *name_at(const void *names, size_t index)
{
    (void)names;
    return index < SCORE_COUNT ? scores[index].info.name : NULL;
}

conus_status ranking_parse(struct ranking *out, const char *text)
{
    struct ranking ranking = {.needs_border = false};
    conus_status status = formula_parse(&ranking.formula, text ? text : scores[0].info.name, name_at, NULL);
    if (status) {
        return fail_in(status, "score");
    }
    for (size_t i = 0; i < SCORE_COUNT; i++) {
        if (formula_uses(&ranking.formula, i)) {
            ranking.info.needs_history = ranking.info.needs_history || scores[i].info.needs_history;
            ranking.info.needs_layers = ranking.info.needs_layers || scores[i].info.needs_layers;
            ranking.info.needs_weight = ranking.info.needs_weight || scores[i].info.needs_weight;
            ranking.needs_rays = ranking.needs_rays || scores[i].needs_rays;
            ranking.needs_posterior = ranking.needs_posterior || scores[i].needs_posterior;
            ranking.uses |= UINT32_C(1) << i;
            ranking.history |= scores[i].history;
            ranking.needs_border = ranking.needs_border || scores[i].needs_border;
            ranking.needs_box = ranking.needs_box || scores[i].needs_box;
        }
    }
    *out = ranking;
    return CONUS_OK;
}

conus_status conus_score_parse(conus_score_info *out, const char *score)
{
    struct ranking ranking;
    conus_status status = ranking_parse(&ranking, score);
    if (!status) {
        *out = ranking.info;
        out->name = score ? score : scores[0].info.name;
        out->description = "";
    }
    return status;
}

double score_contribution(const conus_result *result, const struct cone *cone, double exponent)
{
    if (!result->pixels) {
        return 0;
    }
    if (cone->radius > 0) {
        return clamp(1 - radius_of(result, cone));
    }
    double offset = off_axis(result, cone);
    double depth = contact_distance(result, cone) * cos(offset); /* d_proj; d_perp = d_proj tan(offset) */
    double angle = atan(tan(offset) * pow(depth, 1 - exponent));
    return clamp(1 - angle / (cone->angle / 2));
}

/* The larger first; what is no number, last. */
static int falling(double x, double y)
{
    if (isnan(x) || isnan(y)) {
        return (isnan(x) != 0) - (isnan(y) != 0); /* C promises no more than "not 0" */
    }
    return (x < y) - (x > y);
}

static int compare(const void *a, const void *b)
{
    const conus_result *x = a;
    const conus_result *y = b;
    int order = falling(x->score, y->score);
    order = order ? order : falling(x->share, y->share);
    order = order ? order : falling(-x->distance, -y->distance);
    order = order ? order : falling(-x->entry, -y->entry);
    return order ? order : (x->object > y->object) - (x->object < y->object);
}

void score_rank(struct statistics *statistics, const struct ranking *ranking, const struct score_view *view)
{
    size_t ranked = statistics->count;
    bool has_unassigned = ranked && !statistics->results[ranked - 1].object; /* not about a point among meshes */
    ranked -= has_unassigned;
    for (size_t i = 0; i < ranked; i++) {
        double values[SCORE_COUNT];
        for (size_t k = 0; k < SCORE_COUNT; k++) {
            values[k] = ranking->uses >> k & 1 ? scores[k].value(&statistics->results[i], view) : NAN;
        }
        statistics->results[i].score = formula_value(&ranking->formula, values);
    }
    order_sort(statistics->results, ranked, sizeof *statistics->results, compare);
    for (size_t i = 0; i < ranked; i++) {
        statistics->results[i].rank = (uint32_t)i + 1;
    }
}
