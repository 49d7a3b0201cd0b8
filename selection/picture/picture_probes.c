/* SPDX-License-Identifier: BSD-3-Clause */
/* Probes in a picture: their lines over the drawing, and beside it what each passes, as a strip by depth. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "selection/picture/picture.h"
#include "selection/study/study.h"

#include <stdio.h>
#include <string.h>

enum { TEXT_SIZE = 256, CELL_SIZE = 24 };

/* Lengths in em: around all strips, their width, from one to its names, between columns, of a line, of the heads, and
 * the least and the largest room for names. */
static const double MARGIN = 1;
static const double STRIP = 1.4;
static const double LEADER = 0.9;
static const double COLUMN_GAP = 1.3;
static const double LINE = 1.25;
static const double HEAD = 2.4;
static const double LEAST_NAMES = 3;
static const double TICK = 2.2;

/* The part of their size to which letters of names shrink before names are shortened. */
static const double SMALLEST = 0.6;

/* The part of the picture's width that strips take at most. */
static const double WIDEST = 0.5;

/* A line begins so far before the first area, and is drawn so far from the atlas's middle, as parts of its radius. */
static const double BEFORE = 0.3;
static const double NEAR = 1.6;

static const float OUTSIDE[4] = {LOOK_PROBE_OUTSIDE, 1};

struct picture_probes {
    double from, to;      /* depths that the strips show, mm */
    double left, numbers; /* of all strips; the width of the numbers at their left */
    double *names;        /* [probe_count] width of each one's names, pixels */
    bool is_short;        /* names are abbreviations */
    double letters;       /* of names, pixels per em */
};

/* What a probe passes: columns of its table. */
struct passed {
    size_t count;
    const uint32_t *objects; /* 0 = none */
    const double *entry, *exit;
    const double *entry_at[3], *exit_at[3];
};

static struct passed passed_by(const struct picture *picture, size_t index)
{
    static const char *const ends[2][3] = {{"entry_x", "entry_y", "entry_z"}, {"exit_x", "exit_y", "exit_z"}};
    const conus_table *table = picture->options.probes[index].segments;
    struct passed out = {.count = conus_table_rows(table),
                         .objects = conus_table_objects(table),
                         .entry = conus_table_numbers(table, "entry_mm"),
                         .exit = conus_table_numbers(table, "exit_mm")};
    for (int a = 0; a < 3; a++) {
        out.entry_at[a] = conus_table_numbers(table, ends[0][a]);
        out.exit_at[a] = conus_table_numbers(table, ends[1][a]);
    }
    return out;
}

/* From where a probe is in an object, or without one from where it begins, to where it ends, mm. Whether there is one.
 */
static bool span_of(double out[2], const struct passed *passed)
{
    out[0] = out[1] = passed->entry[0];
    bool found = false;
    for (size_t i = 0; i < passed->count; i++) {
        out[0] = passed->objects[i] && !found ? passed->entry[i] : out[0];
        out[1] = fmax(out[1], isfinite(passed->exit[i]) ? passed->exit[i] : passed->entry[i]);
        found = found || passed->objects[i];
    }
    return found;
}

static bool has_length(const struct passed *passed, size_t row)
{
    return isfinite(passed->exit[row]) && passed->exit[row] > passed->entry[row];
}

/* The point at a depth. */
static void point_at(double out[3], const struct passed *passed, double depth)
{
    size_t row = 0;
    for (size_t i = 0; i < passed->count; i++) { /* one with a length says the direction */
        row = has_length(passed, i) ? i : row;
    }
    double entry = passed->entry[row];
    double part = has_length(passed, row) ? (depth - entry) / (passed->exit[row] - entry) : 0;
    for (int a = 0; a < 3; a++) {
        double from = passed->entry_at[a][row];
        out[a] = from + (part != 0 ? part * (passed->exit_at[a][row] - from) : 0);
    }
}

bool picture_probe_ends(double ends[2][3], const struct picture *picture, size_t index)
{
    const struct passed passed = passed_by(picture, index);
    double span[2], along[3], offset[3];
    span_of(span, &passed);
    span[0] = fmax(passed.entry[0], span[0] - BEFORE * picture->radius);
    point_at(ends[0], &passed, span[0]);
    point_at(ends[1], &passed, span[1]);
    vec3_sub(along, ends[1], ends[0]);
    vec3_sub(offset, picture->centre, ends[0]);
    const double length = vec3_length(along);
    const double middle = length > 0 ? vec3_dot(along, offset) / length : 0;
    const double away = vec3_dot(offset, offset) - middle * middle;
    const double half = sqrt(fmax(NEAR * NEAR * picture->radius * picture->radius - away, 0));
    if (half == 0 || middle + half < 0 || middle - half > length) {
        return false;
    }
    point_at(ends[0], &passed, span[0] + fmax(middle - half, 0));
    point_at(ends[1], &passed, span[0] + fmin(middle + half, length));
    return true;
}

conus_status picture_probes_check(const conus_view *view)
{
    conus_frame world;
    conus_status status = conus_frame_find(&world, NULL, CONUS_SPACE_RAS, NULL);
    for (size_t i = 0; i < view->probe_count && !status; i++) {
        const conus_table *segments = view->probes ? view->probes[i].segments : NULL;
        if (view->selection || !conus_table_rows(segments) || !table_is_of(segments, &segment_fields)) {
            status = fail(CONUS_ERROR_ARGUMENT, "probe %zu: segments are needed, and no selection", i + 1);
        } else if (!table_fits(segments, &world)) {
            status = fail(CONUS_ERROR_ARGUMENT,
                          "probe %zu: its segments are not in world mm, of a selector of that frame", i + 1);
        }
    }
    return status;
}

uint8_t *picture_probe_emphasis(const struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    uint8_t *emphasis = memory_zeroed(atlas->object_count + 1, sizeof *emphasis);
    for (size_t i = 0; emphasis && i < picture->options.probe_count; i++) {
        const struct passed passed = passed_by(picture, i);
        for (size_t k = 0; k < passed.count; k++) {
            uint32_t object = passed.objects[k];
            for (uint32_t number = 1; object && number <= atlas->object_count; number++) {
                emphasis[number] = atlas_is_below(atlas, number, object) ? EMPHASIS_FULL : emphasis[number];
            }
        }
    }
    return emphasis;
}

static const char *name_of(char out[PICTURE_TEXT], const struct picture *picture, uint32_t number)
{
    const conus_object *object = &picture->atlas->objects[number - 1];
    return picture->probes->is_short && object->abbreviation[0] ? object->abbreviation
                                                                : picture_name(out, picture, number);
}

/* Finds the width of the names of each probe's areas, at most `limit`, and gives their sum. */
static double measure_names(const struct picture *picture, double limit)
{
    const struct picture_probes *probes = picture->probes;
    double sum = 0;
    for (size_t n = 0; n < picture->options.probe_count; n++) {
        const struct passed passed = passed_by(picture, n);
        double widest = LEAST_NAMES * probes->letters;
        for (size_t i = 0; i < passed.count; i++) {
            uint32_t number = passed.objects[i];
            char text[PICTURE_TEXT];
            const char *name = number ? name_of(text, picture, number) : "";
            widest = fmax(widest, font_width(picture->font, probes->letters, name));
        }
        probes->names[n] = fmin(widest, limit);
        sum += probes->names[n];
    }
    return sum;
}

void picture_probes_finish(struct picture *picture)
{
    if (picture->probes) {
        memory_free(picture->probes->names);
        memory_free(picture->probes);
        picture->probes = NULL;
    }
}

/* Names are whole where they fit, else abbreviations; where these do not fit either, they are smaller, then shortened.
 */
conus_status picture_probes_init(struct picture *picture)
{
    const size_t count = picture->options.probe_count;
    const double em = picture->em;
    struct picture_probes *out = picture->probes = memory_zeroed(1, sizeof *out);
    if (!out || !(out->names = memory_zeroed(count, sizeof *out->names))) {
        return CONUS_ERROR_MEMORY;
    }
    out->letters = em;
    out->numbers = font_width(picture->font, em, "00.0") + 0.8 * em;
    const double limit = WIDEST * picture->options.width;
    const double fixed = MARGIN * em + out->numbers + (STRIP + LEADER + COLUMN_GAP) * em * (double)count;
    double total = INFINITY;
    for (int pass = 0; pass < 2 && total > limit; pass++) {
        out->is_short = pass;
        total = fixed + measure_names(picture, INFINITY);
    }
    if (total > limit) {
        double each = (limit - fixed) / (double)count;
        if (each < LEAST_NAMES * em) {
            return fail(CONUS_ERROR_ARGUMENT, "%u pixels are too few for the strips of %zu probes",
                        picture->options.width, count);
        }
        double part = fmax(SMALLEST, fmin((limit - fixed) / (total - fixed), 1));
        out->letters = part * em;
        total = fixed + measure_names(picture, part > SMALLEST ? INFINITY : each); /* letters have some sizes only */
    }
    out->from = INFINITY;
    out->to = -INFINITY;
    for (int pass = 0; pass < 2 && out->to < out->from; pass++) { /* first those that pass something, else all */
        for (size_t i = 0; i < count; i++) {
            const struct passed passed = passed_by(picture, i);
            double span[2];
            if (span_of(span, &passed) || pass) {
                out->from = fmin(out->from, span[0]);
                out->to = fmax(out->to, span[1]);
            }
        }
    }
    picture->drawing[0] -= (uint32_t)ceil(total);
    out->left = picture->drawing[0];
    return CONUS_OK;
}

static void colour_of(float out[4], const struct picture *picture, uint32_t object)
{
    memcpy(out, OUTSIDE, 4 * sizeof *out);
    if (object) {
        draw_colour(out, picture->atlas->objects[object - 1].rgb, 1);
    }
}

static bool project(double at[2], const struct picture *picture, const double point[3])
{
    double depth;
    return camera_project(&at[0], &at[1], &depth, &picture->camera, &picture->frame, point);
}

/* A row's point, of three columns. */
static bool project_row(double at[2], const struct picture *picture, const double *const columns[3], size_t row)
{
    return project(at, picture, (const double[]){columns[0][row], columns[1][row], columns[2][row]});
}

/* The ends of a probe's line in the picture; whether it is before the camera. */
static bool project_ends(double from[2], double to[2], const struct picture *picture, size_t index)
{
    double ends[2][3];
    return picture_probe_ends(ends, picture, index) && project(from, picture, ends[0]) && project(to, picture, ends[1]);
}

/* A line, without what of it lies right of the drawing. */
static void draw_in_drawing(struct draw_list *list, const struct picture *picture, double from[2], double to[2],
                            double width, const float rgba[4])
{
    const double limit = picture->drawing[0] - width / 2;
    double *out = from[0] > to[0] ? from : to;
    const double *in = out == from ? to : from;
    if (out[0] > limit && in[0] < limit) {
        out[1] = in[1] + (out[1] - in[1]) * (limit - in[0]) / (out[0] - in[0]);
        out[0] = limit;
    }
    if (in[0] < limit) {
        draw_line(list, from, to, width, rgba);
    }
}

/* Draws a probe in the colours of what it passes, over all that lies before it. */
static void draw_line_of(struct draw_list *list, const struct picture *picture, size_t index)
{
    const struct passed passed = passed_by(picture, index);
    const double width = 0.3 * picture->em;
    double from[2], to[2];
    if (!project_ends(from, to, picture, index)) {
        return;
    }
    draw_in_drawing(list, picture, from, to, width + fmax(2, 0.14 * picture->em), PICTURE_CASING);
    for (int pass = 0; pass < 2; pass++) { /* first what is in no object, all along */
        for (size_t i = 0; i < (pass ? passed.count : 1); i++) {
            float colour[4];
            colour_of(colour, picture, pass ? passed.objects[i] : 0);
            bool is_seen = pass && passed.objects[i] && isfinite(passed.exit[i]);
            bool has_ends = is_seen && project_row(from, picture, passed.entry_at, i) &&
                            project_row(to, picture, passed.exit_at, i);
            if (!pass || has_ends) {
                draw_in_drawing(list, picture, from, to, width, colour);
            }
        }
    }
}

/* Its name beyond its near end, or left or right of its line where the scale or the directions are beyond;
 * farther where another name is. */
static void write_line_name(struct draw_list *list, const struct picture *picture, struct draw_box *boxes, size_t index)
{
    const double em = picture->em;
    const char *name = picture->options.probes[index].name;
    double from[2], to[2];
    if (!name || !name[0] || !project_ends(from, to, picture, index)) {
        return;
    }
    const double width = font_width(picture->font, em, name);
    const double length = fmax(hypot(from[0] - to[0], from[1] - to[1]), 1e-9);
    const double beyond[2] = {em * (from[0] - to[0]) / length - width / 2, em * (from[1] - to[1]) / length};
    const double away = from[1] > to[1] ? 1 : -1;
    const double places[3][2] = {{beyond[0], beyond[1]}, {-em - width, -0.7 * away * em}, {0.6 * em, -0.7 * away * em}};
    struct draw_box key[2];
    struct draw_box box;
    picture_key_boxes(key, picture);
    bool is_free = false;
    for (int n = 0; n <= 3 && !is_free; n++) { /* where none is free, beyond it all the same */
        const double *place = places[n % 3];
        box.left = fmin(fmax(from[0] + place[0], 0), picture->drawing[0] - width);
        box.top = fmin(fmax(from[1] + place[1] - 0.5 * em, 0), picture->drawing[1] - em);
        box.right = box.left + width;
        box.bottom = box.top + em;
        const struct draw_box wide = {box.left - 0.3 * em, box.top - 0.3 * em, box.right + 0.3 * em,
                                      box.bottom + 0.3 * em};
        is_free = !picture_overlaps(&wide, &key[0]) && !picture_overlaps(&wide, &key[1]);
    }
    for (size_t i = 0; i < index; i++) {
        const struct draw_box wide = {boxes[i].left - 0.4 * em, boxes[i].top, boxes[i].right + 0.4 * em,
                                      boxes[i].bottom};
        if (picture_overlaps(&box, &wide)) {
            box.top = boxes[i].top + 1.1 * away * em;
            box.bottom = box.top + em;
            i = (size_t)-1; /* and again from the first one */
        }
    }
    boxes[index] = box;
    picture_lay_patch(list, picture, &box);
    draw_text(list, picture->font, (double[]){box.left, box.top + 0.84 * em}, em, picture->ink, name);
}

/* A strip's name beside it. */
struct beside {
    uint32_t object;
    double length, wanted, y; /* mm; middle of the segment and of the name, pixels */
};

/* Where the strips are. */
struct scale {
    double top, bottom, pixels_per_mm;
};

static double y_of(const struct scale *scale, const struct picture *picture, double depth)
{
    return scale->top + (depth - picture->probes->from) * scale->pixels_per_mm;
}

/* The names of the longest segments, as many as there is room for, each as near to its segment as the others let it.
 * Returns how many. */
static size_t place_labels(struct beside *labels, size_t count, const struct scale *scale, double line)
{
    const size_t capacity = (size_t)fmax(floor((scale->bottom - scale->top) / line), 0);
    while (count > capacity) {
        size_t shortest = 0;
        for (size_t i = 1; i < count; i++) {
            shortest = labels[i].length < labels[shortest].length ? i : shortest;
        }
        memmove(labels + shortest, labels + shortest + 1, (--count - shortest) * sizeof *labels);
    }
    double least = scale->top + line / 2;
    for (size_t i = 0; i < count; i++) {
        labels[i].y = fmax(labels[i].wanted, least);
        least = labels[i].y + line;
    }
    double most = scale->bottom - line / 2;
    for (size_t i = count; i-- > 0;) {
        labels[i].y = fmin(labels[i].y, most);
        most = labels[i].y - line;
    }
    return count;
}

static conus_status write_labels(struct draw_list *list, const struct picture *picture, const struct scale *scale,
                                 double left, size_t index)
{
    const struct passed passed = passed_by(picture, index);
    const double em = picture->em;
    const double letters = picture->probes->letters;
    const float faint[4] = {picture->ink[0], picture->ink[1], picture->ink[2], 0.5F};
    size_t count = 0;
    struct beside *labels = memory_zeroed(passed.count, sizeof *labels);
    if (!labels) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < passed.count; i++) {
        if (passed.objects[i]) {
            labels[count++] = (struct beside){.object = passed.objects[i],
                                              .length = passed.exit[i] - passed.entry[i],
                                              .wanted = y_of(scale, picture, (passed.entry[i] + passed.exit[i]) / 2)};
        }
    }
    count = place_labels(labels, count, scale, LINE * letters);
    for (size_t i = 0; i < count; i++) {
        char name[TEXT_SIZE], whole[PICTURE_TEXT];
        double x = left + (STRIP + LEADER) * em;
        font_shorten(name, sizeof name, picture->font, letters, name_of(whole, picture, labels[i].object),
                     picture->probes->names[index] + 0.01);
        draw_line(list, (double[]){left + STRIP * em, labels[i].wanted}, (double[]){x - 0.25 * em, labels[i].y},
                  picture->line, faint);
        draw_text(list, picture->font, (double[]){x, labels[i].y + 0.36 * letters}, letters, picture->ink, name);
    }
    memory_free(labels);
    return CONUS_OK;
}

static conus_status draw_strip(struct draw_list *list, const struct picture *picture, const struct scale *scale,
                               double left, size_t index)
{
    const conus_drawn_probe *probe = &picture->options.probes[index];
    const struct passed passed = passed_by(picture, index);
    const double em = picture->em;
    char head[TEXT_SIZE];
    double span[2];
    span_of(span, &passed);
    for (size_t i = 0; i <= passed.count; i++) {
        const bool is_row = i < passed.count; /* after the last all of it, from where the probe begins */
        const uint32_t object = is_row ? passed.objects[i] : 0;
        double entry = fmin(fmax(passed.entry[is_row ? i : 0], picture->probes->from), picture->probes->to);
        double exit = fmin(is_row ? passed.exit[i] : span[1], picture->probes->to);
        const struct draw_box box = {rint(left), y_of(scale, picture, entry), rint(left + STRIP * em),
                                     y_of(scale, picture, exit)};
        if (object) {
            float colour[4];
            colour_of(colour, picture, object);
            draw_box(list, &box, 0, colour);
        }
        if (exit > entry && (!is_row || object)) {
            draw_frame(list, &box, 0, picture->line, picture->ink);
        }
    }
    double room = (STRIP + LEADER + COLUMN_GAP / 2) * em + picture->probes->names[index];
    font_shorten(head, sizeof head, picture->font, em, probe->name ? probe->name : "", room);
    draw_text(list, picture->font, (double[]){left, MARGIN * em + 0.8 * em}, em, picture->ink, head);
    return write_labels(list, picture, scale, left, index);
}

/* Depths at the left: the closest of 1, 2, 5, 10, ... mm apart that leave room for their numbers. */
static void draw_depths(struct draw_list *list, const struct picture *picture, const struct scale *scale)
{
    static const double steps[] = {1, 2, 5};
    const struct picture_probes *probes = picture->probes;
    const double em = picture->em;
    const double right = probes->left + probes->numbers - 0.4 * em;
    const double least = TICK * em / scale->pixels_per_mm;
    const double power = pow(10, floor(log10(least)));
    double step = 10 * power;
    for (size_t i = sizeof steps / sizeof *steps; i-- > 0;) {
        step = steps[i] * power >= least ? steps[i] * power : step;
    }
    const char *unit = "mm";
    const double over[2] = {right - font_width(picture->font, em, unit) - 0.4 * em, MARGIN * em + 0.8 * em};
    draw_text(list, picture->font, over, em, picture->ink, unit);
    long last = (long)floor((probes->to + 1e-9) / step);
    for (long k = (long)ceil(probes->from / step - 1e-9); k <= last; k++) {
        char text[CELL_SIZE];
        double y = y_of(scale, picture, (double)k * step);
        snprintf(text, sizeof text, "%g", (double)k * step);
        draw_line(list, (double[]){right + 0.15 * em, y}, (double[]){right + 0.4 * em, y}, picture->line, picture->ink);
        const double at[2] = {right - font_width(picture->font, em, text), y + 0.36 * em};
        draw_text(list, picture->font, at, em, picture->ink, text);
    }
}

conus_status picture_probes_draw(struct draw_list *list, const struct picture *picture)
{
    const size_t count = picture->options.probe_count;
    struct scale scale = {.top = HEAD * picture->em + MARGIN * picture->em / 2,
                          .bottom = picture->drawing[1] - MARGIN * picture->em};
    struct draw_box *boxes = memory_zeroed(count, sizeof *boxes);
    conus_status status = boxes ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count; i++) {
        draw_line_of(list, picture, i);
    }
    for (size_t i = 0; i < count && picture->font && boxes; i++) {
        write_line_name(list, picture, boxes, i);
    }
    memory_free(boxes);
    if (status || !picture->probes || picture->probes->to <= picture->probes->from || scale.bottom <= scale.top) {
        return status;
    }
    scale.pixels_per_mm = (scale.bottom - scale.top) / (picture->probes->to - picture->probes->from);
    draw_depths(list, picture, &scale);
    double left = picture->probes->left + picture->probes->numbers;
    for (size_t i = 0; i < count && !status; i++) {
        status = draw_strip(list, picture, &scale, left, i);
        left += (STRIP + LEADER + COLUMN_GAP) * picture->em + picture->probes->names[i];
    }
    return status;
}
