/* SPDX-License-Identifier: BSD-3-Clause */
/* Letters of directions and the scale of a picture, and all of its text. */
#include "base/order.h"
#include "selection/picture/picture.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "conus/own.h"

#include <stdio.h>
#include <string.h>

enum { CELL_SIZE = 24 };

/* Of a corner of the drawing; else it is on the left, or above. */
enum { RIGHT = 1, BELOW = 2 };

/* The sine of 15 degrees: what an axis may lie off the picture's, and its letter is still at the edge. */
static const double ACROSS = 0.2588;

/* Lengths in em: half an axis of the cross, its letters around it, between it and what is beside it, and from a bar to
 * the drawing's side. */
static const double CROSS = 1.4;
static const double AROUND = 1.15;
static const double GAP = 0.6;
static const double EDGE = 1.5;

/* A cross that would take a larger part of the drawing's shorter side is left out. */
static const double CROSS_LIMIT = 0.45;

static const char letters[6][2] = {"L", "R", "P", "A", "I", "S"};

const char *picture_letter_of(const double axis[3])
{
    for (int a = 0; a < 3; a++) {
        if (axis[a] * axis[a] >= 1 - ACROSS * ACROSS) {
            return letters[2 * a + (axis[a] > 0)];
        }
    }
    return NULL;
}

bool picture_is_across(const struct picture *picture)
{
    const double *m = picture->camera.world_from_camera;
    return picture_letter_of(m) && picture_letter_of(m + 4);
}

/* The drawing under the patch shows through a little. */
void picture_lay_patch(struct draw_list *list, const struct picture *picture, const struct draw_box *box)
{
    const float grey = picture->ink[1] > 0.5F ? 0 : 1;
    if (!picture->rgba || picture_covered(picture, box) > 0) { /* of a sheet the pixels are not known */
        draw_box(list, box, 0.3 * picture->em, (const float[4]){grey, grey, grey, 0.7F});
    }
}

static void draw_edges(struct draw_list *list, const struct picture *picture)
{
    const double *m = picture->camera.world_from_camera;
    const struct camera_frame *frame = &picture->frame;
    double size = PICTURE_LETTER * picture->em;
    double centre[2] = {(frame->left + (double)frame->width - frame->right) / 2,
                        (frame->top + (double)frame->height - frame->bottom) / 2};
    for (int n = 0; n < 4; n++) {
        double axis[3];
        double near = 0.7 * size;
        double at[2] = {centre[0], centre[1]};
        at[n / 2] = n == 0   ? fmax(frame->left - near, near)
                    : n == 1 ? fmin(frame->width - frame->right + near, frame->width - near)
                    : n == 2 ? fmin(frame->height - frame->bottom + near, frame->height - near)
                             : fmax(frame->top - near, near);
        vec3_scale(axis, m + (n < 2 ? 0 : 4), n % 2 ? 1 : -1);
        const char *letter = picture_letter_of(axis);
        const double half = font_width(picture->font, size, letter) / 2;
        const double corner[2] = {at[0] - half, at[1] + 0.36 * size};
        picture_lay_patch(list, picture,
                          &(struct draw_box){at[0] - half, at[1] - 0.4 * size, at[0] + half, at[1] + 0.4 * size});
        draw_text(list, picture->font, corner, size, picture->ink, letter);
    }
}

/* Half an axis of the cross, to where it ends in the picture. */
struct direction {
    const char *letter;
    double x, y, flat; /* of a unit vector, in the picture; its length there */
    bool is_behind;
};

static struct draw_box letter_box(const struct picture *picture, const struct direction *direction,
                                  const double centre[2], double turn)
{
    const double size = picture->em;
    const double half = font_width(picture->font, size, direction->letter) / 2;
    const double out = 0.75 * size / direction->flat;
    const double x =
        centre[0] + CROSS * size * direction->x + out * (cos(turn) * direction->x - sin(turn) * direction->y);
    const double y =
        centre[1] + CROSS * size * direction->y + out * (sin(turn) * direction->x + cos(turn) * direction->y);
    return (struct draw_box){x - half, y - 0.4 * size, x + half, y + 0.4 * size};
}

/* Around the end of its line, so that it lies on no other letter. */
static struct draw_box place_letter(const struct picture *picture, const struct direction *direction,
                                    const double centre[2], const struct draw_box *others, size_t count)
{
    enum { TURNS = 12 };
    for (int n = 0; n < 2 * TURNS; n++) {
        const int turn = n % 2 ? (n + 1) / 2 : -(n / 2);
        const struct draw_box box = letter_box(picture, direction, centre, turn * MATH3_PI / TURNS);
        const struct draw_box wide = {box.left - 0.2 * picture->em, box.top - 0.1 * picture->em,
                                      box.right + 0.2 * picture->em, box.bottom + 0.1 * picture->em};
        bool is_free = true;
        for (size_t i = 0; i < count; i++) {
            is_free = is_free && !picture_overlaps(&wide, &others[i]);
        }
        if (is_free) {
            return box;
        }
    }
    return letter_box(picture, direction, centre, 0);
}

static int compare_flat(const void *a, const void *b)
{
    double one = ((const struct direction *)a)->flat;
    double other = ((const struct direction *)b)->flat;
    return (one < other) - (one > other);
}

/* Letters of the longest lines first: they lie at their ends. */
static void draw_directions(struct draw_list *list, const struct picture *picture, const struct draw_box *box)
{
    const double *m = picture->camera.world_from_camera;
    const double centre[2] = {(box->left + box->right) / 2, (box->top + box->bottom) / 2};
    const double length = CROSS * picture->em;
    struct direction directions[6];
    struct draw_box boxes[6];
    for (int n = 0; n < 6; n++) {
        const double sign = n % 2 ? 1 : -1;
        const double x = sign * m[n / 2];
        const double y = -sign * m[4 + n / 2];
        directions[n] = (struct direction){letters[n], x, y, hypot(x, y), sign * m[8 + n / 2] < 0};
    }
    order_sort(directions, 6, sizeof *directions, compare_flat);
    for (size_t n = 0; n < 6; n++) {
        const struct direction *direction = &directions[n];
        const float ink[4] = {picture->ink[0], picture->ink[1], picture->ink[2],
                              direction->is_behind ? picture->dim : 1};
        const double end[2] = {centre[0] + length * direction->x, centre[1] + length * direction->y};
        draw_line(list, centre, end, (direction->is_behind ? 1.2 : 2.2) * picture->line, ink);
        if (direction->flat > 0.15) {
            boxes[n] = place_letter(picture, direction, centre, boxes, n);
            const double corner[2] = {boxes[n].left, boxes[n].top + 0.76 * picture->em};
            draw_text(list, picture->font, corner, picture->em, ink, direction->letter);
        }
    }
}

/* A scale bar: as long as so many mm, its words above its middle. */
struct bar {
    struct draw_box box; /* with the words */
    double left, right, base;
    char text[CELL_SIZE];
};

static void measure_bar(struct bar *out, const struct picture *picture, double pixels_per_mm, double beside,
                        unsigned corner)
{
    double size = picture->em;
    double limit = 0.14 * picture->drawing[0] / pixels_per_mm;
    double power = pow(10, floor(log10(limit)));
    double length = /* the largest of 1, 2, 5, 10, ... that is at most `limit` */
        limit >= 5 * power   ? 5 * power
        : limit >= 2 * power ? 2 * power
                             : power;
    snprintf(out->text, sizeof out->text, "%g mm", length);
    double half = fmax(length * pixels_per_mm, font_width(picture->font, size, out->text)) / 2;
    double edge = beside * size + half;
    double middle = corner & RIGHT ? picture->drawing[0] - edge : edge;
    out->base = corner & BELOW ? picture->drawing[1] - 1.4 * size : 2.4 * size;
    out->left = middle - length * pixels_per_mm / 2;
    out->right = middle + length * pixels_per_mm / 2;
    out->box = (struct draw_box){middle - half, out->base - 1.4 * size, middle + half, out->base + 0.4 * size};
}

static void draw_bar(struct draw_list *list, const struct picture *picture, const struct bar *bar)
{
    double size = picture->em;
    double line = 2 * picture->line;
    const double base = bar->base;
    for (int end = 0; end < 2; end++) {
        double x = end ? bar->right : bar->left;
        draw_line(list, (double[]){x, base - 0.3 * size}, (double[]){x, base + 0.3 * size}, line, picture->ink);
    }
    draw_line(list, (double[]){bar->left, base}, (double[]){bar->right, base}, line, picture->ink);
    const double at[2] = {(bar->left + bar->right - font_width(picture->font, size, bar->text)) / 2,
                          base - 0.55 * size};
    draw_text(list, picture->font, at, size, picture->ink, bar->text);
}

void picture_draw_bar(struct draw_list *list, const struct picture *picture, double pixels_per_mm)
{
    struct bar bar;
    measure_bar(&bar, picture, pixels_per_mm, EDGE, RIGHT | BELOW);
    if (picture->rgba) {
        picture_lay_patch(list, picture, &bar.box);
    }
    draw_bar(list, picture, &bar);
}

/* Draws the scale bar, for the depth of the middle of the scene, and the cross of directions, in a corner of the
 * drawing. */
struct key {
    bool has_bar, has_cross;
    struct bar bar;
    struct draw_box cross;
};

static void measure_key(struct key *out, const struct picture *picture, unsigned corner)
{
    const double size = picture->em;
    const double side = 2 * (CROSS + AROUND) * size;
    const double left = corner & RIGHT ? picture->drawing[0] - GAP * size - side : GAP * size;
    const double top = corner & BELOW ? picture->drawing[1] - GAP * size - side : GAP * size;
    double x, y, depth;
    out->has_bar = camera_project(&x, &y, &depth, &picture->camera, &picture->frame, picture->centre);
    const double least = fmin(picture->drawing[0], picture->drawing[1]);
    out->has_cross = !picture_is_across(picture) && side + 2 * GAP * size <= CROSS_LIMIT * least;
    out->cross = (struct draw_box){left, top, left + side, top + side};
    if (out->has_bar) {
        double beside = out->has_cross ? side / size + 2 * GAP : EDGE;
        measure_bar(&out->bar, picture, picture->drawing[0] / (2 * depth * picture->camera.slope[0]), beside, corner);
    }
}

bool picture_overlaps(const struct draw_box *a, const struct draw_box *b)
{
    return a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom;
}

/* Whether none of the points, world mm, lies in the box as the picture's camera sees them. */
static bool is_free(const struct picture *picture, const struct draw_box *box, const double *points, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        double x, y, depth;
        if (camera_project(&x, &y, &depth, &picture->camera, &picture->frame, points + 3 * i) &&
            picture_overlaps(&(struct draw_box){x - 1, y - 1, x + 1, y + 1}, box)) {
            return false;
        }
    }
    return true;
}

bool picture_key_is_free(double size[2], const struct picture *picture, const double *points, size_t count)
{
    struct key key;
    measure_key(&key, picture, RIGHT | BELOW);
    const double side = key.cross.right - key.cross.left + 2 * GAP * picture->em;
    size[0] = key.has_cross ? side : key.has_bar ? picture->drawing[0] - key.bar.box.left : 0;
    size[1] = key.has_cross ? side : key.has_bar ? picture->drawing[1] - key.bar.box.top : 0;
    return (!key.has_cross || is_free(picture, &key.cross, points, count)) &&
           (!key.has_bar || is_free(picture, &key.bar.box, points, count));
}

/* In the lower right corner; where something is there, as a given camera may have it, in the one where it hides least.
 */
static struct key choose_key(const struct picture *picture)
{
    static const unsigned corners[] = {RIGHT | BELOW, BELOW, RIGHT, 0};
    struct key key = {0};
    double least = INFINITY;
    for (size_t i = 0; i < sizeof corners / sizeof *corners && least > 0; i++) {
        struct key other;
        measure_key(&other, picture, corners[i]);
        double hidden = other.has_cross ? picture_covered(picture, &other.cross) : 0;
        hidden += other.has_bar ? picture_covered(picture, &other.bar.box) : 0;
        if (hidden < least) {
            least = hidden;
            key = other;
        }
    }
    return key;
}

void picture_key_boxes(struct draw_box out[2], const struct picture *picture)
{
    const struct key key = choose_key(picture);
    out[0] = key.has_cross ? key.cross : (struct draw_box){0};
    out[1] = key.has_bar ? key.bar.box : (struct draw_box){0};
}

static void draw_key(struct draw_list *list, const struct picture *picture)
{
    const struct key key = choose_key(picture);
    if (key.has_cross) {
        picture_lay_patch(list, picture, &key.cross);
        draw_directions(list, picture, &key.cross);
    }
    if (key.has_bar) {
        picture_lay_patch(list, picture, &key.bar.box);
        draw_bar(list, picture, &key.bar);
    }
}

/* Where the pathway's value is largest, world mm. */
static void find_peak(double out[3], const conus_atlas *atlas, uint32_t number)
{
    const struct volume *volume = atlas_object_volume(atlas, number);
    double most = -INFINITY;
    size_t best = 0;
    for (size_t v = volume_next(volume, 0); v < volume->voxel_count; v = volume_next(volume, v + 1)) {
        double value = volume_object(volume, v) == number ? (double)volume_value(volume, v) : -INFINITY;
        best = value > most ? v : best;
        most = fmax(most, value);
    }
    grid_index(out, volume->info.dim, best);
    mat4_point(out, volume->info.world_from_voxel, out);
}

/* Where the cone comes to the object first; the middle of one that it does not hit. */
static void find_contact(double out[3], const struct picture *picture, uint32_t number)
{
    const conus_selection *selection = picture->options.selection;
    if (conus_atlas_centre(out, picture->atlas, number)) {
        memcpy(out, picture->centre, sizeof picture->centre); /* it has no voxels and no surface */
    }
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object == number && result->pixels) {
            memcpy(out, result->contact, sizeof result->contact);
        }
    }
}

/* Moves a disc to the free place in the drawing that is nearest to where it belongs. */
static void place_disc(double at[2], const struct picture *picture, double radius, const double (*others)[2],
                       size_t count)
{
    enum { RINGS = 24, TURNS = 6 };
    const double wanted[2] = {at[0], at[1]};
    for (int ring = 0; ring < RINGS; ring++) {
        for (int n = 0; n < (ring ? TURNS * ring : 1); n++) {
            const double turn = 2 * MATH3_PI * n / (TURNS * fmax(ring, 1));
            at[0] = wanted[0] + 2.4 * radius * ring * cos(turn);
            at[1] = wanted[1] + 2.4 * radius * ring * sin(turn);
            bool is_free = at[0] >= radius && at[0] <= picture->drawing[0] - radius && at[1] >= radius &&
                           at[1] <= picture->drawing[1] - radius;
            for (size_t i = 0; i < count && is_free; i++) {
                is_free = hypot(at[0] - others[i][0], at[1] - others[i][1]) > 2.2 * radius;
            }
            if (is_free) {
                return;
            }
        }
    }
}

void picture_draw_tag(struct draw_list *list, const struct picture *picture, uint32_t number, const double at[2])
{
    const double radius = PICTURE_TAG * picture->em;
    const struct draw_box disc = {at[0] - radius, at[1] - radius, at[0] + radius, at[1] + radius};
    float colour[4], ink[4];
    uint8_t rgb[3];
    char text[CELL_SIZE];
    picture_colour(rgb, picture, number);
    draw_colour(colour, rgb, 1);
    picture_ink_on(ink, picture, number);
    snprintf(text, sizeof text, "%zu", picture_tag(picture, number));
    const double corner[2] = {at[0] - font_width(picture->font, picture->em, text) / 2, at[1] + 0.36 * picture->em};
    draw_box(list, &disc, radius, colour);
    draw_frame(list, &disc, radius, fmax(1, 0.1 * picture->em), ink);
    draw_text(list, picture->font, corner, picture->em, ink, text);
}

/* The number of each pathway that the legend names by one, on a disc of its colour; where there are several, beside the
 * others, with a line to where it belongs. */
static void draw_tags(struct draw_list *list, const struct picture *picture)
{
    enum { TAGS = 64 };
    double places[TAGS][2];
    size_t count = 0;
    const double radius = PICTURE_TAG * picture->em;
    for (uint32_t number = 1; number <= picture->atlas->object_count && count < TAGS; number++) {
        double peak[3];
        double from[2];
        double *at = places[count];
        double depth;
        if (!picture_tag(picture, number)) {
            continue;
        }
        if (picture->ranks && picture->ranks[number]) {
            find_contact(peak, picture, number);
        } else {
            find_peak(peak, picture->atlas, number);
        }
        if (!camera_project(&from[0], &from[1], &depth, &picture->camera, &picture->frame, peak)) {
            continue;
        }
        memcpy(at, from, sizeof from);
        place_disc(at, picture, radius, (const double(*)[2])places, count);
        count++;
        if (hypot(at[0] - from[0], at[1] - from[1]) > radius) {
            draw_line(list, from, at, picture->line, picture->ink);
        }
        picture_draw_tag(list, picture, number, at);
    }
}

/* Light on dark is seen on everything. */
static const float measured_under[4] = {LOOK_MEASURED_UNDER, 0.85F};
static const float measured_light[4] = {LOOK_MEASURED, 1};

/* Finds the part of a line, 0 to 1 from end to end, that is less than `limit` away from a plane. */
static bool find_near(double part[2], const double away[2], double limit)
{
    double rise = away[1] - away[0];
    double cross[2] = {(-limit - away[0]) / rise, (limit - away[0]) / rise};
    part[0] = rise != 0 ? fmax(fmin(cross[0], cross[1]), 0) : 0;
    part[1] = rise != 0 ? fmin(fmax(cross[0], cross[1]), 1) : 1;
    return rise != 0 ? part[0] < part[1] : fabs(away[0]) <= limit;
}

static void draw_part(struct draw_list *list, double ends[2][2], const double part[2], double width,
                      const float rgba[4])
{
    double at[2][2];
    for (int n = 0; n < 4; n++) {
        at[n / 2][n % 2] = ends[0][n % 2] + part[n / 2] * (ends[1][n % 2] - ends[0][n % 2]);
    }
    draw_line(list, at[0], at[1], width, rgba);
}

void picture_draw_measured(struct draw_list *list, const struct picture *picture, double ends[2][2],
                           const double away[2])
{
    static const double faded = 25; /* mm from a cut, as in the window */
    const float *const dark = measured_under;
    const float *const light = measured_light;
    const double *places = picture->options.measured;
    const double size = picture->em;
    double offset[3];
    char text[CELL_SIZE];
    for (int n = 0; n < 4; n++) {
        double at = ends[n / 2][n % 2];
        if (!(at >= 0 && at <= picture->drawing[n % 2])) {
            return;
        }
    }
    double firm[2];
    double faint[2];
    const conus_volume_info *volume = conus_atlas_volume(picture->atlas, 0);
    const double slice = volume ? fmax(fmax(volume->spacing[0], volume->spacing[1]), volume->spacing[2]) : 1;
    bool is_in = find_near(firm, away, slice / 2);
    bool is_whole = is_in && firm[0] <= 0 && firm[1] >= 1;
    if (!is_whole && find_near(faint, away, faded)) {
        draw_part(list, ends, faint, picture->line, (const float[]){LOOK_MEASURED, 0.4F});
    }
    if (!is_in) {
        return;
    }
    vec3_sub(offset, places + 3, places);
    snprintf(text, sizeof text, "%.2f mm%s", vec3_length(offset), is_whole ? "" : " in 3-D");
    for (int layer = 0; layer < 2; layer++) {
        const float *rgba = layer ? light : dark;
        draw_part(list, ends, firm, (layer ? 2 : 4) * picture->line, rgba);
        for (int n = 0; n < 2; n++) {
            if (firm[n] == n) {
                draw_line(list, ends[n], ends[n], (layer ? 6 : 8) * picture->line, rgba);
            }
        }
    }
    const double middle[2] = {(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2};
    double half = font_width(picture->font, size, text) / 2;
    const struct draw_box box = {middle[0] - half - 0.4 * size, middle[1] - 0.75 * size, middle[0] + half + 0.4 * size,
                                 middle[1] + 0.75 * size};
    draw_box(list, &box, 0.3 * size, dark);
    draw_text(list, picture->font, (const double[]){middle[0] - half, middle[1] + 0.36 * size}, size, light, text);
}

static void draw_measured(struct draw_list *list, const struct picture *picture)
{
    double ends[2][2];
    double depth;
    for (int n = 0; n < 2; n++) {
        if (!camera_project(&ends[n][0], &ends[n][1], &depth, &picture->camera, &picture->frame,
                            picture->options.measured + 3 * n)) {
            return;
        }
    }
    picture_draw_measured(list, picture, ends, (const double[]){0, 0});
}

/* A line with an edge, so that it is seen on everything; dashed from `phase` on, which goes on. */
static void draw_cased(struct draw_list *list, double ends[2][2], double unit, double *phase, const float rgba[4])
{
    static const double dash = 6, gap = 5;
    const double length = hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
    const double period = (dash + gap) * unit;
    if (!phase) {
        draw_line(list, ends[0], ends[1], 4 * unit, measured_under);
        draw_line(list, ends[0], ends[1], 2 * unit, rgba);
        return;
    }
    const int count = length > 0 && length < 1e5 ? (int)ceil((*phase + length) / period) : 0;
    for (int i = 0; i < count; i++) {
        const double at = i * period - *phase;
        const double part[2] = {fmax(at, 0) / length, fmin(at + dash * unit, length) / length};
        if (part[0] < part[1]) {
            draw_part(list, ends, part, 4 * unit, measured_under);
            draw_part(list, ends, part, 2 * unit, rgba);
        }
    }
    *phase = fmod(*phase + length, period);
}

/* Writes a name beside its place, where it lies on none of the `count` boxes; false where there is no room. */
static bool draw_name(struct draw_list *list, const struct picture *picture, const char *name, const double at[2],
                      struct draw_box *boxes, size_t count)
{
    static const double ways[][2] = {{1, -1}, {-1, -1}, {1, 1}, {-1, 1}, {1, -3}, {-1, -3}, {1, 3}, {-1, 3}};
    const double size = picture->em;
    const double wide = font_width(picture->font, size, name) + 0.8 * size;
    const double high = 1.5 * size;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        const double left = at[0] + size * ways[i][0] - (ways[i][0] < 0 ? wide : 0);
        const double top = at[1] + size * ways[i][1] - high / 2;
        const struct draw_box box = {left, top, left + wide, top + high};
        bool is_free = left >= 0 && top >= 0 && box.right <= picture->drawing[0] && box.bottom <= picture->drawing[1];
        for (size_t k = 0; k < count && is_free; k++) {
            is_free = box.right < boxes[k].left || box.left > boxes[k].right || box.bottom < boxes[k].top ||
                      box.top > boxes[k].bottom;
        }
        if (is_free) {
            const double end[2] = {ways[i][0] < 0 ? box.right : box.left, (top + box.bottom) / 2};
            draw_line(list, at, end, picture->line, measured_light);
            draw_box(list, &box, 0.3 * size, measured_under);
            draw_text(list, picture->font, (const double[]){left + 0.4 * size, end[1] + 0.36 * size}, size,
                      measured_light, name);
            boxes[count] = box;
            return true;
        }
    }
    return false;
}

void picture_draw_marks(struct draw_list *list, const struct picture *picture)
{
    enum { NAMES = 16 };
    struct draw_box boxes[NAMES];
    size_t names = 0;
    double phase = 0;
    const double unit = picture->em / 14;
    for (size_t i = 0; i < picture->options.mark_count; i++) {
        const conus_drawn_point *mark = &picture->options.marks[i];
        double ends[2][2];
        double depth;
        float rgba[4];
        bool is_seen = true;
        for (int e = 0; e < 2 && is_seen; e++) {
            is_seen = camera_project(&ends[e][0], &ends[e][1], &depth, &picture->camera, &picture->frame,
                                     e ? mark->end : mark->at);
        }
        draw_colour(rgba, mark->rgb, 1);
        if (is_seen && (mark->name || mark->object)) {
            char text[PICTURE_TEXT];
            const bool is_drawn = picture->font && names < NAMES;
            const char *name = is_drawn && mark->object ? picture_name(text, picture, mark->object) : mark->name;
            names += is_drawn && draw_name(list, picture, name, ends[0], boxes, names);
        } else if (is_seen && mark->radius > 0) {
            draw_line(list, ends[0], ends[0], 2 * (mark->radius + 1) * unit, measured_under);
            draw_line(list, ends[0], ends[0], 2 * mark->radius * unit, rgba);
        } else if (is_seen) {
            draw_cased(list, ends, unit, mark->dashed ? &phase : NULL, rgba);
        }
    }
}

void picture_annotate(struct draw_list *list, const struct picture *picture)
{
    if (picture->names) {
        picture_names_draw(list, picture);
    } else if (picture->legend || picture->options.legend_rows) {
        draw_tags(list, picture);
    }
    if (picture->legend) {
        picture_legend_draw(list, picture);
    }
    if (picture_is_across(picture)) {
        draw_edges(list, picture);
    }
    draw_key(list, picture);
    if (picture->options.measured) {
        draw_measured(list, picture);
    }
}

void picture_annotate_cut(struct draw_list *list, struct picture *picture, double mm_per_pixel)
{
    if (picture->legend) {
        picture_legend_draw(list, picture);
    }
    memcpy(picture->ink, (const float[]){LOOK_PICTURE_INK, 1}, sizeof picture->ink); /* on black, mostly */
    if (picture_is_across(picture)) {
        draw_edges(list, picture);
    }
    picture_draw_bar(list, picture, 1 / mm_per_pixel);
}
