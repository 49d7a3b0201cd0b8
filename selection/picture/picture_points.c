/* SPDX-License-Identifier: BSD-3-Clause */
/* Points in a picture: balls over the drawing, or over the cuts that come near them, with their names. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/text.h"
#include "render/colour/colour.h"
#include "selection/picture/picture.h"

#include <stdio.h>
#include <string.h>

enum { NAMED_LIMIT = 1000, TEXT_SIZE = 64 };

/* Radius of a ball that has none, mm. */
static const double RADIUS = 1;

/* The camera takes no notice of what is farther from the atlas's middle than so many of its radii. */
static const double FAR = 3;

/* Lengths in em: the least radius of a ball, its dark edge, a line, a name's letters, and from a ball to its name. */
static const double LEAST = 0.22;
static const double EDGE = 0.08;
static const double LINE = 0.16;
static const double LETTERS = 0.85;
static const double GAP = 0.25;

/* The dark inside of a ball that is a ring, as a part of its radius. */
static const double HOLE = 0.6;

/* How much of its colour a ball loses that lies a radius of the atlas behind its middle. */
static const double PALEST = 0.4;

/* A line that enters a cut is seen up to so many mm from it, as much of it as FAINT where it is beside the cut. */
static const double BESIDE = 25;
static const float FAINT = 0.35F;

/* A ball as it is drawn, pixels. */
struct ball {
    double at[2], radius, depth;
    double line[2][2];        /* its ends */
    double firm[2], whole[2]; /* parts of it, from 0 to 1, that are drawn: firm, and faint around these; 0, 0 = none */
    double pale;              /* 0 = it has its colour, 1 = that of paper */
    bool is_beside;           /* the cut shows its line alone */
    size_t index;
};

static double radius_of(const conus_drawn_point *point)
{
    return point->radius > 0 ? point->radius : RADIUS;
}

conus_status picture_points_check(const conus_view *view)
{
    for (size_t i = 0; i < view->point_count; i++) {
        const conus_drawn_point *point = view->points ? &view->points[i] : NULL;
        if (!point || view->probe_count || !vec3_is_finite(point->at) ||
            !(point->radius >= 0 && isfinite(point->radius))) {
            return fail(CONUS_ERROR_ARGUMENT,
                        "point %zu: a finite position and a radius from 0 on are needed, and no probes", i + 1);
        }
    }
    return CONUS_OK;
}

/* The number that a group's name is; NaN of "n/a" and of none. False where it is another text. */
static bool number_of(double *out, const struct picture_group *group)
{
    const struct text name = text_trim(text_from(group->name ? group->name : "n/a"));
    *out = NAN;
    return !name.size || text_equal_ignoring_case(name, "n/a") || text_equal_ignoring_case(name, "nan") ||
           (text_to_double(name, out) && isfinite(*out));
}

/* Gives groups that are numbers, more than have a colour each, those of a scale. */
static void colour_numbers(struct picture *picture)
{
    double range[2] = {NAN, NAN};
    double value;
    bool all = picture->group_count > PICTURE_RANKS;
    for (size_t g = 0; g < picture->group_count && all; g++) {
        all = number_of(&value, &picture->groups[g]);
        range[0] = fmin(range[0], value); /* not of NaN */
        range[1] = fmax(range[1], value);
    }
    for (size_t g = 0; g < picture->group_count && all && range[0] < range[1]; g++) {
        (void)number_of(&value, &picture->groups[g]);
        tube_scalar_colour(picture->groups[g].rgb, (value - range[0]) / (range[1] - range[0]));
        picture->has_unknown_group = picture->has_unknown_group || isnan(value);
    }
    picture->has_group_scale = all && range[0] < range[1];
    memcpy(picture->group_range, range, sizeof range);
}

conus_status picture_points_init(struct picture *picture)
{
    const size_t count = picture->options.point_count;
    picture->groups = memory_zeroed(count, sizeof *picture->groups);
    picture->group_of = memory_zeroed(count, sizeof *picture->group_of);
    if (!picture->groups || !picture->group_of) {
        return CONUS_ERROR_MEMORY;
    }
    static const uint8_t neutral[3] = {LOOK_RGB(LOOK_CHOSEN)};
    const bool is_ranked = picture_has_ranks(picture->options.selection, picture->options.own_colours);
    struct name_set names = {0};
    size_t nameless = SIZE_MAX; /* the group without a name */
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        const char *name = is_ranked ? NULL : picture->options.points[i].group; /* colours are those of the answer */
        const struct known_name *known = name ? name_set_find(&names, name) : NULL;
        size_t group = known ? known->value : name ? SIZE_MAX : nameless;
        if (group == SIZE_MAX) {
            group = picture->group_count++;
            picture->groups[group] = (struct picture_group){.name = name};
            look_ranked(picture->groups[group].rgb, group + 1, 1, LOOK_RANK_MORE); /* of all further ones the same */
            if (is_ranked) {
                memcpy(picture->groups[group].rgb, neutral, sizeof neutral);
            }
            nameless = name ? nameless : group;
            status = name ? name_set_add(&names, name, group) : CONUS_OK;
        }
        picture->groups[group].count++;
        picture->group_of[i] = (uint32_t)group;
    }
    name_set_finish(&names);
    if (!status && !is_ranked && picture->options.group_title) {
        colour_numbers(picture);
    }
    return status;
}

size_t picture_points_near(double (*out)[3], const struct picture *picture)
{
    size_t count = 0;
    for (size_t i = 0; i < picture->options.point_count; i++) {
        const conus_drawn_point *point = &picture->options.points[i];
        double offset[3];
        vec3_sub(offset, point->at, picture->centre);
        for (int n = 0; n < 6 && vec3_length(offset) <= FAR * picture->radius; n++) {
            memcpy(out[count], point->at, sizeof point->at);
            out[count++][n / 2] += (n % 2 ? 1 : -1) * radius_of(point);
        }
    }
    return count;
}

/* What lies behind the atlas's middle is the paler, the farther it is: who looks at a brain of glass sees on which side
 * a ball is. */
static double paleness(const struct picture *picture, double depth)
{
    double offset[3];
    const double *m = picture->camera.world_from_camera;
    vec3_sub(offset, picture->centre, m + 12);
    const double behind = depth + vec3_dot(offset, m + 8); /* the camera looks along -z */
    return PALEST * fmin(fmax(behind / picture->radius, 0), 1);
}

/* Where a ball of a picture in space is; false where it is behind the camera. */
static bool project(struct ball *out, const struct picture *picture, size_t index)
{
    const conus_drawn_point *point = &picture->options.points[index];
    double side[3], at[2], depth;
    vec3_add_scaled(side, point->at, radius_of(point), picture->camera.world_from_camera);
    *out = (struct ball){.index = index};
    if (!camera_project(&out->at[0], &out->at[1], &out->depth, &picture->camera, &picture->frame, point->at) ||
        !camera_project(&at[0], &at[1], &depth, &picture->camera, &picture->frame, side)) {
        return false;
    }
    out->radius = fmax(hypot(at[0] - out->at[0], at[1] - out->at[1]), LEAST * picture->em);
    out->pale = paleness(picture, out->depth);
    if (vec3_is_finite(point->end) &&
        camera_project(&at[0], &at[1], &depth, &picture->camera, &picture->frame, point->end)) {
        memcpy(out->line[0], out->at, sizeof out->at);
        memcpy(out->line[1], at, sizeof at);
        out->firm[1] = out->whole[1] = 1;
    }
    return true;
}

/* Leaves of the parts of a line those in which what is `from` at its begin and `to` at its end is from `low` to `high`;
 * where none is, the last does not lie behind the first. */
static void clip(double span[2], double from, double to, double low, double high)
{
    const double ends[2] = {(low - from) / (to - from), (high - from) / (to - from)};
    if (from != to) {
        span[0] = fmax(span[0], fmin(ends[0], ends[1]));
        span[1] = fmin(span[1], fmax(ends[0], ends[1]));
    } else if (from < low || from > high) {
        span[1] = span[0];
    }
}

/* A place of its line, exactly an end for 0 and 1. */
static void along_line(double out[2], const struct ball *ball, double part)
{
    for (int a = 0; a < 2; a++) {
        out[a] = (1 - part) * ball->line[0][a] + part * ball->line[1][a];
    }
}

static void put_in_plane(double out[2], double *away, const struct picture_plane *plane, const double at[3])
{
    double offset[3], normal[3];
    vec3_sub(offset, at, plane->centre);
    vec3_cross(normal, plane->right, plane->up);
    *away = vec3_dot(offset, normal);
    out[0] = plane->middle[0] + vec3_dot(plane->right, offset) * plane->pixels_per_mm;
    out[1] = plane->middle[1] - vec3_dot(plane->up, offset) * plane->pixels_per_mm;
}

static bool is_inside(const struct draw_box *box, const double at[2])
{
    return at[0] >= box->left && at[0] <= box->right && at[1] >= box->top && at[1] <= box->bottom;
}

/* Where a ball is in a cut: as large as the cut makes it, but not smaller than others; false where neither it nor its
 * line comes near enough. A line alone has its name where it is nearest to the cut. */
static bool cut_ball(struct ball *out, const struct picture *picture, const struct picture_plane *plane, size_t index)
{
    const conus_drawn_point *point = &picture->options.points[index];
    const struct draw_box *box = &plane->box;
    const double radius = radius_of(point);
    const double slab = fmax(radius, CONUS_POINT_NEAR_CUT);
    double away[2];
    *out = (struct ball){.index = index};
    put_in_plane(out->at, &away[0], plane, point->at);
    out->depth = fabs(away[0]);
    out->radius = fmax(sqrt(fmax(radius * radius - away[0] * away[0], 0)) * plane->pixels_per_mm, LEAST * picture->em);
    out->is_beside = out->depth > slab || !is_inside(box, out->at);
    if (vec3_is_finite(point->end)) {
        double(*line)[2] = out->line;
        memcpy(line[0], out->at, sizeof out->at);
        put_in_plane(line[1], &away[1], plane, point->end);
        out->whole[1] = 1;
        clip(out->whole, line[0][0], line[1][0], box->left, box->right);
        clip(out->whole, line[0][1], line[1][1], box->top, box->bottom);
        memcpy(out->firm, out->whole, sizeof out->firm);
        clip(out->firm, away[0], away[1], -slab, slab);
        clip(out->whole, away[0], away[1], -BESIDE, BESIDE);
    }
    const bool has_line = out->firm[1] > out->firm[0];
    if (out->is_beside && has_line) {
        const double crossing = away[0] != away[1] ? away[0] / (away[0] - away[1]) : 0;
        const double nearest = fmin(fmax(crossing, out->firm[0]), out->firm[1]);
        along_line(out->at, out, nearest);
        out->radius = fmax(1.5, LINE * picture->em) / 2;
        out->depth = fabs(away[0] + nearest * (away[1] - away[0]));
    }
    return has_line || !out->is_beside;
}

/* A colour that has become so pale. */
static void blend(float out[4], const float rgba[4], const struct picture *picture, double pale)
{
    const float paper = picture->ink[1] > 0.5F ? 0.02F : 0.8F;
    for (int c = 0; c < 3; c++) {
        out[c] = rgba[c] + (float)pale * (paper - rgba[c]);
    }
    out[3] = rgba[3];
}

static void draw_disc(struct draw_list *list, const double at[2], double radius, const float rgba[4])
{
    draw_line(list, at, at, 2 * radius, rgba);
}

static void draw_part(struct draw_list *list, const struct ball *ball, const double span[2], double width,
                      const float rgba[4])
{
    double from[2], to[2];
    along_line(from, ball, span[0]);
    along_line(to, ball, span[1]);
    draw_line(list, from, to, width, rgba);
}

static void draw_ball(struct draw_list *list, const struct picture *picture, const struct ball *ball)
{
    const double edge = fmax(1, EDGE * picture->em);
    const double line = fmax(1.5, LINE * picture->em);
    float colour[4], casing[4];
    draw_colour(colour, picture->groups[picture->group_of[ball->index]].rgb, 1);
    blend(colour, colour, picture, picture->has_group_scale ? 0 : ball->pale); /* a scale's colours say numbers */
    blend(casing, PICTURE_CASING, picture, ball->pale);
    if (ball->whole[0] < ball->firm[0] || ball->whole[1] > ball->firm[1]) {
        const float faint[4] = {colour[0], colour[1], colour[2], FAINT};
        draw_part(list, ball, ball->whole, line / 2, faint);
    }
    if (ball->firm[1] > ball->firm[0]) {
        draw_part(list, ball, ball->firm, line + 2 * edge, casing);
        draw_part(list, ball, ball->firm, line, colour);
    }
    if (ball->is_beside) {
        return;
    }
    draw_disc(list, ball->at, ball->radius + edge, casing);
    draw_disc(list, ball->at, ball->radius, colour);
    if (picture->options.points[ball->index].hollow) {
        draw_disc(list, ball->at, HOLE * ball->radius, casing);
    }
}

static struct draw_box box_of(const struct ball *ball)
{
    return (struct draw_box){ball->at[0] - ball->radius, ball->at[1] - ball->radius, ball->at[0] + ball->radius,
                             ball->at[1] + ball->radius};
}

static bool is_free(const struct draw_box *box, const struct draw_box *taken, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (picture_overlaps(box, &taken[i])) {
            return false;
        }
    }
    return true;
}

/* Whether the line of a ball passes a box. */
static bool passes(const struct ball *ball, const struct draw_box *box)
{
    double span[2] = {ball->whole[0], ball->whole[1]};
    clip(span, ball->line[0][0], ball->line[1][0], box->left, box->right);
    clip(span, ball->line[0][1], ball->line[1][1], box->top, box->bottom);
    return span[1] > span[0];
}

/* Finds a place for a name around its ball that is free of all that is `taken`, one beside its line first; false where
 * there is none. */
static bool place_name(struct draw_box *out, const struct ball *ball, const double size[2], double gap,
                       const struct draw_box *limit, const struct draw_box *taken, size_t count)
{
    static const double sides[][2] = {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {1, 1}, {-1, -1}, {-1, 1}};
    const size_t side_count = sizeof sides / sizeof *sides;
    for (size_t n = 0; n < 2 * side_count; n++) {
        const double *side = sides[n % side_count];
        const double away = (side[0] != 0 && side[1] != 0 ? 0.75 : 1) * (ball->radius + gap);
        const double middle[2] = {ball->at[0] + side[0] * (away + size[0] / 2),
                                  ball->at[1] + side[1] * (away + size[1] / 2)};
        *out = (struct draw_box){middle[0] - size[0] / 2, middle[1] - size[1] / 2, middle[0] + size[0] / 2,
                                 middle[1] + size[1] / 2};
        if (out->left >= limit->left && out->right <= limit->right && out->top >= limit->top &&
            out->bottom <= limit->bottom && is_free(out, taken, count) && (n >= side_count || !passes(ball, out))) {
            return true;
        }
    }
    return false;
}

/* Writes into the lower left corner, in a line of its own, that something is not there. */
static void say_missing(struct draw_list *list, const struct picture *picture, const struct draw_box *limit, int line,
                        size_t missing, size_t count, const char *what)
{
    char text[TEXT_SIZE];
    const double letters = LETTERS * picture->em;
    const bool is_wanted = missing && !picture->options.draft;
    const double at[2] = {limit->left + GAP * picture->em,
                          limit->bottom - 2 * GAP * picture->em - 1.3 * letters * line};
    if (is_wanted) {
        snprintf(text, sizeof text, "%zu of %zu %s", missing, count, what);
        const double right = at[0] + font_width(picture->font, letters, text);
        picture_lay_patch(list, picture,
                          &(struct draw_box){at[0], at[1] - 0.8 * letters, right, at[1] + 0.2 * letters});
        draw_text(list, picture->font, at, letters, picture->ink, text);
    }
}

/* Whether the point is the first or last of its group in the list: the name of an electrode's end tells the others. */
static bool is_group_end(const struct picture *picture, size_t index)
{
    const uint32_t *group_of = picture->group_of;
    return index == 0 || index + 1 == picture->options.point_count || group_of[index - 1] != group_of[index] ||
           group_of[index + 1] != group_of[index];
}

/* Names of a higher rank have a place first: that of the one point, those of ends, and all others. */
static size_t name_rank(const struct picture *picture, size_t index)
{
    return index + 1 == picture->first_named ? 2 : is_group_end(picture, index);
}

/* Writes names, those of a higher rank and of the nearest balls first, each where it hides neither a ball nor
 * another name, and how many have no such place. `taken` has room for a box for each name behind the first ones. */
static void write_names(struct draw_list *list, const struct picture *picture, const struct ball *balls, size_t count,
                        const struct draw_box *limit, struct draw_box *taken, size_t taken_count)
{
    const double letters = LETTERS * picture->em;
    size_t wanted = 0;
    size_t written = 0;
    for (size_t n = 3 * count; n-- > 0;) { /* all for each rank; the farthest ball is the first */
        const struct ball *ball = &balls[n % count];
        const char *name = picture->options.points[ball->index].name;
        if (!name || !name[0] || name_rank(picture, ball->index) != n / count) {
            continue;
        }
        const double size[2] = {font_width(picture->font, letters, name), 0.95 * letters};
        struct draw_box *box = &taken[taken_count];
        if (wanted++ < NAMED_LIMIT && place_name(box, ball, size, GAP * picture->em, limit, taken, taken_count)) {
            picture_lay_patch(list, picture, box);
            draw_text(list, picture->font, (double[]){box->left, box->bottom - 0.14 * letters}, letters, picture->ink,
                      name);
            taken_count++;
            written++;
        }
    }
    say_missing(list, picture, limit, 0, wanted - written, wanted, "names have no room");
}

static int compare_depths(const void *a, const void *b)
{
    return compare_double(((const struct ball *)b)->depth, ((const struct ball *)a)->depth);
}

/* Draws balls, the farthest first, and their names, all within a box; names keep clear of `keys`. */
static conus_status draw_balls(struct draw_list *list, const struct picture *picture, struct ball *balls, size_t count,
                               const struct draw_box *limit, const struct draw_box keys[2])
{
    struct draw_box *taken = memory_zeroed(2 * count + 2, sizeof *taken);
    if (!taken) {
        return CONUS_ERROR_MEMORY;
    }
    order_sort(balls, count, sizeof *balls, compare_depths);
    for (size_t i = 0; i < count; i++) {
        draw_ball(list, picture, &balls[i]);
        taken[i] = box_of(&balls[i]);
    }
    if (picture->font) {
        taken[count] = keys[0];
        taken[count + 1] = keys[1];
        write_names(list, picture, balls, count, limit, taken, count + 2);
    }
    memory_free(taken);
    return CONUS_OK;
}

conus_status picture_points_draw(struct draw_list *list, const struct picture *picture)
{
    const struct draw_box limit = {0, 0, picture->drawing[0], picture->drawing[1]};
    struct draw_box keys[2] = {0};
    struct ball *balls = memory_zeroed(picture->options.point_count, sizeof *balls);
    size_t count = 0;
    if (!balls) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < picture->options.point_count; i++) {
        struct ball *ball = &balls[count];
        count += project(ball, picture, i) && is_inside(&limit, ball->at);
        if (!is_inside(&limit, ball->line[1])) {
            ball->firm[1] = ball->whole[1] = 0;
        }
    }
    if (picture->font && picture->rgba) {
        const size_t all = picture->options.point_count;
        picture_key_boxes(keys, picture);
        say_missing(list, picture, &limit, 1, all - count, all, "points are outside of the picture");
    }
    conus_status status = draw_balls(list, picture, balls, count, &limit, keys);
    memory_free(balls);
    return status;
}

conus_status picture_points_cut(struct draw_list *list, const struct picture *picture,
                                const struct picture_plane *plane, bool *shown)
{
    static const struct draw_box none[2];
    struct ball *balls = memory_zeroed(picture->options.point_count, sizeof *balls);
    size_t count = 0;
    if (!balls) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < picture->options.point_count; i++) {
        const bool is_shown = cut_ball(&balls[count], picture, plane, i);
        count += is_shown;
        shown[i] = shown[i] || is_shown;
    }
    conus_status status = draw_balls(list, picture, balls, count, &plane->box, none);
    memory_free(balls);
    return status;
}

conus_status picture_points_cut_whole(struct draw_list *list, const struct picture *picture, const conus_cut_view *view,
                                      bool *shown)
{
    const double size[2] = {picture->drawing[0], picture->drawing[1]};
    double axes[2][3];
    cut_view_axes(axes[0], axes[1], view);
    const struct picture_plane plane = {.centre = view->centre,
                                        .right = axes[0],
                                        .up = axes[1],
                                        .pixels_per_mm = 1 / view->mm_per_pixel,
                                        .middle = {size[0] / 2, size[1] / 2},
                                        .box = {0, 0, size[0], size[1]}};
    return picture_points_cut(list, picture, &plane, shown);
}

void picture_points_count(struct draw_list *list, const struct picture *picture, const bool *shown)
{
    const struct draw_box limit = {0, 0, picture->drawing[0], picture->drawing[1]};
    const size_t count = picture->options.point_count;
    size_t missing = 0;
    for (size_t i = 0; i < count; i++) {
        missing += !shown[i];
    }
    if (picture->font) {
        say_missing(list, picture, &limit, 0, missing, count, "points are in no cut");
    }
}
