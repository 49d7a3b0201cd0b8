/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses caps of electrodes, which name no space: ASA's .elc, BESA's .sfp, EEGLAB's .ced, SimNIBS's .csv. They are
 * taken as MNI only where their names lie on the head of MNI 152 (Okamoto's published cap: at most 14.7 mm off, half of
 * it within 9.2). */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/positions.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double FARTHEST = 25, MEDIAN = 12;       /* mm, of names from their positions */
static const double HEAD_OF_CM = 30, HEAD_OF_M = 1.3; /* half of a head in mm lies farther from its middle */
enum { LEAST = 3 };                                   /* names that say something */

struct electrode {
    struct text name;
    double point[3];
    const struct position *known; /* NULL = its name is no position */
    size_t line;
};

struct cap {
    struct electrode *electrodes;
    size_t count, capacity;
    double scale; /* mm per unit; 0 = the file names none */
};

static const struct position *known_position(struct text name)
{
    static const char *const landmarks[][2] = {{"FidNz", "Nz"}, {"FidT9", "LPA"}, {"FidT10", "RPA"}, {"Nasion", "Nz"}};
    for (size_t i = 0; i < sizeof landmarks / sizeof landmarks[0]; i++) {
        name = text_equal_ignoring_case(name, landmarks[i][0]) ? text_from(landmarks[i][1]) : name;
    }
    return position_find(name);
}

/* Three numbers; a row without them is an error of the file, for a cap is asked as a whole. */
static conus_status add_electrode(struct cap *cap, struct text name, const struct text numbers[3], size_t line)
{
    if (!memory_reserve(&cap->electrodes, &cap->capacity, cap->count + 1, sizeof *cap->electrodes)) {
        return CONUS_ERROR_MEMORY;
    }
    struct electrode electrode = {.name = text_trim(name), .line = line};
    for (int i = 0; i < 3; i++) {
        if (!text_to_double(text_trim(numbers[i]), &electrode.point[i]) || !isfinite(electrode.point[i])) {
            return fail(CONUS_ERROR_DATA, "line %zu: %c: \"%.*s\" is no number", line, "xyz"[i],
                        POSE_QUOTE(numbers[i]));
        }
    }
    cap->electrodes[cap->count++] = electrode;
    return CONUS_OK;
}

static conus_status read_unit(struct cap *cap, struct text unit)
{
    cap->scale = text_equal(unit, "mm") ? 1 : text_equal(unit, "cm") ? 10 : text_equal(unit, "m") ? 1000 : 0;
    return cap->scale > 0 ? CONUS_OK
                          : fail(CONUS_ERROR_DATA, "UnitPosition \"%.*s\", allowed are mm, cm and m", POSE_QUOTE(unit));
}

/* "x y z" or "name : x y z". */
static conus_status read_position(struct cap *cap, struct text line, size_t number)
{
    const char *colon = memchr(line.data, ':', line.size);
    struct text name = {line.data, colon ? (size_t)(colon - line.data) : 0};
    struct text rest = {line.data + name.size + (colon != NULL), line.size - name.size - (colon != NULL)};
    struct text numbers[3] = {{"", 0}, {"", 0}, {"", 0}};
    for (int i = 0; i < 3; i++) {
        (void)text_word(&rest, &numbers[i]);
    }
    return add_electrode(cap, name, numbers, number);
}

/* Sections "Positions" and "Labels", whose names are in the order of the positions. */
static conus_status parse_elc(struct cap *cap, struct text text)
{
    enum { HEAD, POSITIONS, LABELS } part = HEAD;
    struct text line;
    size_t labels = 0;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        struct text rest = line;
        struct text word;
        if (!text_word(&rest, &word) || word.data[0] == '#') {
            continue;
        }
        bool is_key = text_is_one_of(word, "Positions/Labels/ReferenceLabel/UnitPosition", true) ||
                      text_starts(word, "Number") || text_starts(word, "HeadShape");
        if (text_equal(word, "UnitPosition")) {
            status = text_word(&rest, &word) ? read_unit(cap, word) : read_unit(cap, rest);
        } else if (is_key) {
            part = text_equal(word, "Positions") ? POSITIONS : text_equal(word, "Labels") ? LABELS : HEAD;
        } else if (part == POSITIONS) {
            status = read_position(cap, line, number);
        } else if (part == LABELS) {
            for (bool more = true; more; more = text_word(&rest, &word)) {
                if (labels < cap->count) {
                    cap->electrodes[labels].name = word;
                }
                labels++;
            }
        }
    }
    return status || labels == 0 || labels == cap->count
               ? status
               : fail(CONUS_ERROR_DATA, "%zu labels of %zu positions", labels, cap->count);
}

/* Rows with the name in field @p name and the position in three fields from @p first, each from 0; @p separator 0 is
 * white space. */
static conus_status parse_rows(struct cap *cap, struct text text, char separator, size_t name, size_t first)
{
    struct text line;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        struct text numbers[3] = {{"", 0}, {"", 0}, {"", 0}};
        struct text called = {"", 0};
        struct text field;
        bool more = text_trim(line).size > 0;
        bool is_row = more;
        for (size_t at = 0; separator ? text_field(&line, separator, &more, &field) : text_word(&line, &field); at++) {
            called = at == name ? field : called;
            if (at >= first && at < first + 3) {
                numbers[at - first] = field;
            }
        }
        status = is_row ? add_electrode(cap, called, numbers, number) : CONUS_OK;
    }
    return status;
}

enum kind { NO_CAP, ELC, SFP, CED, SIMNIBS };

static enum kind kind_of(struct text line)
{
    struct text rest = line;
    struct text word = {"", 0};
    double number;
    (void)text_word(&rest, &word);
    if (text_starts(line, "# ASA electrode file") ||
        text_is_one_of(word, "ReferenceLabel/UnitPosition/NumberPositions=", true)) {
        return ELC;
    }
    if (text_is_one_of(word, "FidNz/FidT9/FidT10", true)) {
        return SFP;
    }
    if (text_starts(line, "Number\tlabels\ttheta\tradius\tX\tY\tZ")) {
        return CED;
    }
    rest = line;
    bool more = true;
    bool is_kind =
        text_field(&rest, ',', &more, &word) && text_is_one_of(word, "Electrode/ReferenceElectrode/Fiducial", true);
    return is_kind && text_field(&rest, ',', &more, &word) && text_to_double(word, &number) ? SIMNIBS : NO_CAP;
}

bool pose_cap_line(struct text line)
{
    return kind_of(line) != NO_CAP;
}

static int compare_doubles(const void *a, const void *b)
{
    return compare_double(*(const double *)a, *(const double *)b);
}

/* Ways to hold the axes: a cap's point, so held, is RAS. */
static const struct way {
    const char *words;
    double m[9]; /* row by row */
} ways[] = {
    {"another head, or one that lies elsewhere", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
    {"a head with x to the nose and y to the left (CTF, EEGLAB, Brainstorm)", {0, -1, 0, 1, 0, 0, 0, 0, 1}},
    {"a head in LPS (x to the left, y to the back)", {-1, 0, 0, 0, -1, 0, 0, 0, 1}},
    {"a head with left and right exchanged", {-1, 0, 0, 0, 1, 0, 0, 0, 1}},
};

enum { WAYS = sizeof ways / sizeof ways[0] };

static void hold(double out[3], const struct way *way, const double p[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = vec3_dot(way->m + 3 * i, p);
    }
}

/* How far the known names lie from their positions. */
struct fit {
    double median, farthest;
    const struct electrode *worst;
};

/* @p middle, @p place and @p size: what is taken off the cap, the middle of the positions, and how much the cap is
 * enlarged; @p apart has room for all. */
static struct fit find_fit(double *apart, const struct cap *cap, const struct way *way, const double middle[3],
                           const double place[3], double size)
{
    struct fit fit = {0};
    size_t count = 0;
    for (size_t i = 0; i < cap->count; i++) {
        const struct electrode *electrode = &cap->electrodes[i];
        double p[3];
        if (electrode->known) {
            vec3_sub(p, electrode->point, middle);
            hold(p, way, (const double[]){p[0], p[1], p[2]});
            vec3_scale(p, p, size);
            vec3_add_scaled(p, p, 1, place);
            vec3_sub(p, p, electrode->known->point);
            apart[count] = vec3_length(p);
            fit.worst = !count || apart[count] > fit.farthest ? electrode : fit.worst;
            fit.farthest = fmax(fit.farthest, apart[count++]);
        }
    }
    order_sort(apart, count, sizeof *apart, compare_doubles);
    fit.median = count ? apart[count / 2] : 0;
    return fit;
}

/* The middle of the known electrodes, and that of their positions, and how much larger those are. */
static double find_middles(double middle[3], double place[3], const struct cap *cap, size_t known)
{
    double sizes[2] = {0, 0};
    for (int a = 0; a < 3; a++) {
        middle[a] = place[a] = 0;
        for (size_t i = 0; i < cap->count; i++) {
            const struct electrode *electrode = &cap->electrodes[i];
            middle[a] += electrode->known ? electrode->point[a] / (double)known : 0;
            place[a] += electrode->known ? electrode->known->point[a] / (double)known : 0;
        }
    }
    for (size_t i = 0; i < cap->count; i++) {
        const struct electrode *electrode = &cap->electrodes[i];
        double p[3];
        vec3_sub(p, electrode->point, middle);
        sizes[0] += electrode->known ? vec3_dot(p, p) : 0;
        vec3_sub(p, electrode->known ? electrode->known->point : place, place);
        sizes[1] += vec3_dot(p, p);
    }
    return sizes[0] > 0 ? sqrt(sizes[1] / sizes[0]) : 1;
}

/* Half of the distances of all electrodes from their middle are below this. */
static double find_radius(double *apart, const struct cap *cap)
{
    double middle[3] = {0};
    for (size_t i = 0; i < cap->count; i++) {
        for (int a = 0; a < 3; a++) {
            middle[a] += cap->electrodes[i].point[a] / (double)cap->count;
        }
    }
    for (size_t i = 0; i < cap->count; i++) {
        double p[3];
        vec3_sub(p, cap->electrodes[i].point, middle);
        apart[i] = vec3_length(p);
    }
    order_sort(apart, cap->count, sizeof *apart, compare_doubles);
    return cap->count ? apart[cap->count / 2] : 0;
}

static conus_status check_fit(struct notes *notes, double *apart, const struct cap *cap, size_t known)
{
    static const double zero[3];
    struct fit fit = find_fit(apart, cap, &ways[0], zero, zero, 1);
    bool fits = fit.farthest <= FARTHEST && fit.median <= MEDIAN;
    struct fit mirrored = find_fit(apart, cap, &ways[WAYS - 1], zero, zero, 1);
    if (fits && mirrored.farthest <= FARTHEST && mirrored.median <= MEDIAN) {
        return fail(CONUS_ERROR_DATA,
                    "a cap that names no space: all %zu names of the 10-10 system lie near the "
                    "midline, so that left and right cannot be told apart",
                    known);
    }
    if (fits) {
        return notes_add(
            notes,
            "a cap that names no space; taken as MNI 152, for its %zu names of the 10-10 system lie within "
            "%.0f mm of their positions on that head, half of them within %.0f mm",
            known, fit.farthest, fit.median);
    }
    double middle[3];
    double place[3];
    double size = find_middles(middle, place, cap, known);
    size_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < WAYS; i++) {
        double median = find_fit(apart, cap, &ways[i], middle, place, size).median;
        best = median < least ? i : best;
        least = fmin(least, median);
    }
    return fail(CONUS_ERROR_DATA,
                "a cap that names no space, and does not lie on the head of MNI 152: %.*s is %.0f mm from where it is "
                "there, half of %zu known names are more than %.0f mm off (allowed are %g and %g); it looks like %s; "
                "bring it to MNI in the program that wrote it, or give the atlas's own positions as name,x,y,z",
                POSE_QUOTE(fit.worst->name), fit.farthest, known, fit.median, FARTHEST, MEDIAN, ways[best].words);
}

static conus_status check_cap(struct notes *notes, struct cap *cap)
{
    size_t known = 0;
    for (size_t i = 0; i < cap->count; i++) {
        cap->electrodes[i].known = known_position(cap->electrodes[i].name);
        known += cap->electrodes[i].known != NULL;
    }
    if (known < LEAST) {
        return fail(CONUS_ERROR_DATA,
                    "a cap that names no space: %zu of its %zu names are landmarks or positions of the 10-10 system; "
                    "%d are needed to see whether it lies on the head of MNI 152",
                    known, cap->count, LEAST);
    }
    double *apart = memory_raw(cap->count, sizeof *apart);
    if (!apart) {
        return CONUS_ERROR_MEMORY;
    }
    double radius = find_radius(apart, cap);
    conus_status status = CONUS_OK;
    if (cap->scale == 0 && radius <= HEAD_OF_CM) {
        status = fail(CONUS_ERROR_DATA,
                      "a cap without a unit: half of its positions lie within %.3g of their middle, so these are %s, "
                      "and mm are needed",
                      radius, radius > HEAD_OF_M ? "centimetres" : "metres, or a sphere of radius 1");
    }
    for (size_t i = 0; i < cap->count && cap->scale > 0; i++) {
        vec3_scale(cap->electrodes[i].point, cap->electrodes[i].point, cap->scale);
    }
    status = status ? status : check_fit(notes, apart, cap, known);
    memory_free(apart);
    return status;
}

conus_status pose_cap_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    enum { NAME = 1, X = 4, SIMNIBS_NAME = 4 };
    struct cap cap = {0};
    if (options->axis != CONUS_AXIS_OF_FORMAT) {
        return fail(CONUS_ERROR_DATA, "electrodes have no axes, so that no axis (%s) can be chosen",
                    pose_axis_name(options->axis));
    }
    struct text rest = text;
    struct text line = {"", 0};
    while (text_line(&rest, &line) && !text_trim(line).size) {
    }
    enum kind kind = kind_of(line);
    conus_status status = pose_note_space(&list->notes, options, false);
    status = status            ? status
             : kind == ELC     ? parse_elc(&cap, text)
             : kind == CED     ? parse_rows(&cap, rest, '\t', NAME, X)
             : kind == SIMNIBS ? parse_rows(&cap, text, ',', SIMNIBS_NAME, 1)
                               : parse_rows(&cap, text, 0, 0, 1);
    status = status ? status : check_cap(&list->notes, &cap);
    list->space = pose_space_named(text_from("a cap on the head of MNI 152"), POSE_BRAIN_MNI152);
    for (size_t i = 0; !status && i < cap.count; i++) {
        conus_pose_row row = pose_row_at(cap.electrodes[i].line);
        row.is_point = true;
        conus_status bad = pose_of_point(&row.pose, cap.electrodes[i].point);
        status = pose_list_add(list, &row, cap.electrodes[i].name, bad ? conus_message() : NULL);
    }
    memory_free(cap.electrodes);
    return status;
}
