/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The functions that the web page calls: an atlas, one question at a time, cuts, a view and surfaces of it. Strings
 * that are returned are JSON or a report's text, valid until the next call; {"error": "..."} is conus's own message.
 * Pixels are rows of RGBA, top row first. All lengths are mm, all angles degrees, all positions RAS mm.
 */
#include "atlas/nets/nets.h"
#include "base/look.h"
#include "options/messages.h"
#include "pages/pages.h"

#include <conus/own.h>
#include <emscripten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#pragma GCC diagnostic ignored "-Wmissing-prototypes" /* the page's JavaScript has no header to read */

enum step { STEP = 1, STEP_PRESSED = 2, STEP_BEGINS = 4 };
enum { SIDE_LIMIT = 512, COARSE_LIMIT = 128, REACH = 3 };

/* Of all pictures and the table; the page's choice, in its order. */
enum colours { COLOURS_OF_ANSWER, COLOURS_OF_FILE, COLOURS_SAFE };

static const double RADIANS = 3.14159265358979323846 / 180;
static const uint8_t neutral[3] = {LOOK_RGB(LOOK_NOT_HIT)};

struct asker {
    conus_selector *selector;
    conus_weight *weight; /* that it has */
};

/* The page has one atlas, hence one of each. */
static struct {
    conus_atlas *atlas;
    struct asker asker; /* of the question */
    struct viewer {
        struct asker asker;
        uint32_t side;
    } viewers[2];               /* of the 3-D view, all pixels' first hits: while it moves, and at rest */
    conus_cutter *cutters[3];   /* by the axis across: each keeps what it found in its plane */
    const conus_cutter *cut;    /* the last that drew */
    conus_selection *selection; /* the answer; NULL before the first */
    conus_selection *nothing;   /* in its place in cuts that have none: of a cone that hits nothing */
    struct asker follower;      /* of steps of a track, and */
    conus_tracker *tracker;     /* ranks with those before */
    enum colours colours;
    conus_report *report;
    struct page_question question; /* of which `selector` is, whatever angle and range, */
    char *rays;                    /* as a link has it; */
    char *words;                   /* its texts are in these */
    char *text;
    uint8_t rgba[4 * SIDE_LIMIT * SIDE_LIMIT];
    uint32_t objects[SIDE_LIMIT * SIDE_LIMIT];
    float distances[SIDE_LIMIT * SIDE_LIMIT];
    float light[SIDE_LIMIT * SIDE_LIMIT]; /* by which a surface's colour is multiplied; the sides of both are seen */
    double eye[7];                        /* as look() says */
    uint32_t seen;                        /* pixels a side from there; 0 = none */
    struct nets nets;                     /* until the page has them */
} page;

#ifdef __EMSCRIPTEN__ /* elsewhere memset() would call itself */
/* No packing (--wrap): only files that are written are packed, and a page writes none. */
struct libdeflate_compressor *__wrap_libdeflate_alloc_compressor(int level)
{
    (void)level;
    return NULL;
}

/* zlib's in its place: one table of 9 kB. */
uint32_t __wrap_libdeflate_crc32(uint32_t sum, const void *data, size_t size)
{
    return (uint32_t)crc32_z(sum, data, size);
}

/* The C library's own, which calloc() calls, stores words, in code that the browser has not optimised yet. */
EMSCRIPTEN_KEEPALIVE void *memset(void *to, int byte, size_t size)
{
    return __builtin_memset(to, byte, size); /* one instruction, for -mbulk-memory */
}

/* The C library's own clears memory, too, that was never used and is zero: 14 MB for AAL, each page of it asked of the
 * system. What was never used lies behind the break, which is never lowered. */
void *calloc(size_t count, size_t size)
{
    const uint8_t *unused = sbrk(0);
    uint8_t *memory = size && count > SIZE_MAX / size ? NULL : malloc(count * size);
    size_t used = memory && memory < unused ? (size_t)(unused - memory) : 0;
    return memory ? memset(memory, 0, used < count * size ? used : count * size) : NULL;
}
#endif

/* As text, and ends it. */
static const char *say(json_t *root)
{
    free(page.text);
    page.text = root ? json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(root);
    return page.text ? page.text : "{\"error\": \"no memory\"}";
}

static const char *say_words(const char *words)
{
    return say(json_pack("{s:s}", "error", words));
}

static const char *say_error(void)
{
    return say_words(conus_message());
}

static void forget_asker(struct asker *asker)
{
    conus_selector_destroy(asker->selector);
    conus_weight_destroy(asker->weight);
    *asker = (struct asker){0};
}

static void forget_question(void)
{
    conus_report_destroy(page.report);
    conus_selection_destroy(page.selection);
    conus_selection_destroy(page.nothing);
    forget_asker(&page.asker);
    page.report = NULL;
    page.selection = NULL;
    page.nothing = NULL;
}

static void forget_track(void)
{
    if (conus_selection_step(page.selection)) {
        forget_question();
    }
    conus_tracker_destroy(page.tracker);
    forget_asker(&page.follower);
    page.tracker = NULL;
}

/* And what else was made for the atlas as it was. */
static void forget_answers(void)
{
    forget_track();
    forget_question();
    for (size_t i = 0; i < 2; i++) {
        forget_asker(&page.viewers[i].asker);
    }
    page.seen = 0;
    for (size_t i = 0; i < 3; i++) {
        conus_cutter_destroy(page.cutters[i]);
        page.cutters[i] = NULL;
    }
    page.cut = NULL;
}

/* Those that are warnings, or all others. */
static json_t *notes_of(bool warn)
{
    json_t *notes = json_array();
    for (size_t i = 0; i < conus_atlas_note_count(page.atlas); i++) {
        if ((conus_atlas_note_severity(page.atlas, i) == CONUS_SEVERITY_WARNING) == warn) {
            json_array_append_new(notes, json_string(conus_atlas_note(page.atlas, i)));
        }
    }
    return notes;
}

/* Of the grey of the last image; NULL where there is none. */
static json_t *window_of_image(void)
{
    double window[2];
    for (size_t i = conus_atlas_volume_count(page.atlas); i-- > 0;) {
        if (conus_atlas_volume(page.atlas, i)->role == CONUS_ROLE_CONTEXT &&
            !conus_atlas_window(window, page.atlas, i)) {
            return json_pack("[ff]", window[0], window[1]);
        }
    }
    return NULL;
}

/* Whether an area has voxels of labels or a surface, or there is a bundle. */
static bool is_solid(void)
{
    const size_t count = conus_atlas_object_count(page.atlas);
    bool is = false;
    for (size_t i = 1; i <= count && !is; i++) {
        const conus_object *object = conus_atlas_object(page.atlas, i);
        is = object->triangles > 0 || object->kind == CONUS_KIND_BUNDLE ||
             (object->voxels > 0 && conus_atlas_volume(page.atlas, object->volume)->role == CONUS_ROLE_PARCELLATION);
    }
    return is;
}

/* name, sha256, source of the names, number of objects, box, whether there are surfaces for a headset, grey window,
 * identity, notes and warnings. */
static const char *describe_atlas(void)
{
    double low[3] = {0};
    double high[3] = {0};
    const conus_volume_info *first = conus_atlas_volume_count(page.atlas) ? conus_atlas_volume(page.atlas, 0) : NULL;
    const char *path = first && first->role != CONUS_ROLE_CONTEXT ? first->path
                       : conus_atlas_file_count(page.atlas)       ? conus_atlas_file(page.atlas, 0)
                                                                  : "";
    if (conus_atlas_bounds(low, high, page.atlas)) {
        return say_error();
    }
    char words[128];
    const conus_atlas_identity_view identity = conus_atlas_identity(page.atlas);
    const conus_atlas_facts *facts = identity.facts; /* which published atlas it is; NULL of another */
    if (facts) {
        snprintf(words, sizeof words, identity.is_verified ? "%s, %s, on %s" : "%s by its names; its voxels are others",
                 facts->name, facts->edition, facts->space);
    }
    const char *source = conus_atlas_label_source(page.atlas);
    const char *slash = strrchr(path, '/');
    return say(json_pack("{s:s, s:s, s:s, s:s, s:I, s:[fff], s:[fff], s:b, s:s, s:o*, s:s*, s:s*, s:o, s:o}", "name",
                         slash ? slash + 1 : path, "sha256", first ? first->sha256 : "", "transform",
                         first ? first->transform : "", "source", source ? source : "", "objects",
                         (json_int_t)conus_atlas_object_count(page.atlas), "low", low[0], low[1], low[2], "high",
                         high[0], high[1], high[2], "solid", is_solid(), "version", conus_version(), "window",
                         window_of_image(), "identity", facts ? words : NULL, "reference",
                         facts ? facts->reference : NULL, "notes", notes_of(false), "warnings", notes_of(true)));
}

/* Opens an atlas in place of that which is open; after an error that stays. */
EMSCRIPTEN_KEEPALIVE const char *web_open(const char *path)
{
    conus_atlas *atlas = NULL;
    if (conus_atlas_load(&atlas, path, NULL)) {
        return say_error();
    }
    forget_answers();
    conus_atlas_destroy(page.atlas);
    page.atlas = atlas;
    return describe_atlas();
}

EMSCRIPTEN_KEEPALIVE const char *web_add_context(const char *path)
{
    forget_answers();
    return conus_atlas_set_context(page.atlas, path, NULL) ? say_error() : describe_atlas();
}

EMSCRIPTEN_KEEPALIVE void web_use_colours(enum colours colours)
{
    page.colours = colours;
    (colours == COLOURS_SAFE ? conus_atlas_use_safe_colours : conus_atlas_use_own_colours)(page.atlas);
    forget_answers();
}

/* [[name, red, green, blue, side], ...] of the objects from 1 on: the name with the word that tells it from others of
 * the same name, L or R, or "" where that is not known or contradicts the place. */
EMSCRIPTEN_KEEPALIVE const char *web_objects(void)
{
    const size_t count = conus_atlas_object_count(page.atlas);
    const bool exchanged = conus_atlas_exchanged(page.atlas);
    char *sides = malloc(count + 1);
    const char **prefixes = malloc((count + 1) * sizeof *prefixes);
    const bool are_known =
        sides && prefixes && !conus_atlas_sides(sides, page.atlas) && !conus_atlas_prefixes(prefixes, page.atlas);
    json_t *objects = are_known ? json_array() : NULL;
    for (size_t i = 1; objects && i <= count; i++) {
        const conus_object *object = conus_atlas_object(page.atlas, i);
        json_array_append_new(
            objects, json_pack("[oiiis#]", json_sprintf("%s%s%s", prefixes[i], *prefixes[i] ? " " : "", object->name),
                               object->rgb[0], object->rgb[1], object->rgb[2], &sides[i], !exchanged && sides[i]));
    }
    free(sides);
    free(prefixes);
    return say(objects);
}

/* What a page asks, as rows of options: [{"name": "angle", "type": "number", ...}, ...] (conus help --json). */
EMSCRIPTEN_KEEPALIVE const char *web_form(void)
{
    return say(pages_options(&page_question_form));
}

/* `score` is that of steps; NULL = the question's. */
static conus_status prepare_asker(struct asker *asker, const struct page_question *question, const char *score)
{
    conus_selector_options options;
    conus_status status = asker->selector ? CONUS_OK : page_question_selector(&options, &asker->weight, question);
    if (status || asker->selector) {
        return status;
    }
    options.score = score ? score : options.score;
    status = conus_selector_create(&asker->selector, page.atlas, &options);
    if (status) {
        forget_asker(asker);
    }
    return status;
}

/* mm along the cone's axis to the deepest hit; 0 where nothing is hit first. */
static double find_depth(const conus_pose *pose)
{
    const conus_evidence evidence = conus_selection_evidence(page.selection);
    double depth = 0;
    for (size_t pixel = 0; pixel < (size_t)evidence.resolution * evidence.resolution; pixel++) {
        double at[3];
        double along = 0;
        conus_selection_position(at, page.selection, pixel);
        for (int a = 0; a < 3; a++) {
            along -= (at[a] - pose->world_from_device[12 + a]) * pose->world_from_device[8 + a];
        }
        depth = evidence.in_cone[pixel] && along > depth ? along : depth; /* NaN where nothing is hit */
    }
    return depth;
}

/* The colour of a hit by its place in the answer and its share, as in pictures; returns its place among the colours. */
static size_t colour_hit(uint8_t rgb[3], uint32_t object)
{
    const size_t rank = conus_selection_rank(page.selection, object);
    look_ranked(rgb, rank, conus_selection_weight(page.selection, object), LOOK_NOT_HIT);
    return rank;
}

/* `depth`, the objects that are hit, their places among the colours, and the colours. */
static const char *say_hits(double depth)
{
    json_t *lists[3] = {json_array(), json_array(), json_array()};
    for (size_t i = 0; i < conus_selection_count(page.selection); i++) {
        const uint32_t object = conus_selection_result(page.selection, i)->object;
        uint8_t rgb[3];
        if (object) {
            json_array_append_new(lists[1], json_integer((json_int_t)colour_hit(rgb, object)));
            json_array_append_new(lists[0], json_integer(object));
            json_array_append_new(lists[2], json_sprintf("#%02x%02x%02x", rgb[0], rgb[1], rgb[2]));
        }
    }
    return say(
        json_pack("{s:f, s:o, s:o, s:o}", "depth", depth, "hits", lists[0], "ranks", lists[1], "colours", lists[2]));
}

/* A selector is kept where only angle and range are others. Takes `words`, too. */
static void take_question(const struct page_question *question, char *words)
{
    char *rays = NULL;
    size_t size;
    FILE *out = open_memstream(&rays, &size);
    if (out) {
        page_question_put(out, question);
        fclose(out);
    }
    if (!rays || !page.rays || strcmp(rays, page.rays) != 0) {
        forget_question();
    }
    free(page.rays);
    free(page.words);
    page.rays = rays;
    page.words = words;
    page.question = *question;
}

/* A step of a track, the first one where it begins; its rows are those of conus track with --score intenselect_plus. A
 * step with another one's settings is asked with those of the first. */
static conus_status answer_step(const struct page_question *question, const conus_pose *pose, const double *range,
                                unsigned step, double time_s)
{
    if (step & STEP_BEGINS) {
        forget_track();
    }
    conus_status status = prepare_asker(&page.follower, question, "intenselect_plus");
    status = status || page.tracker ? status : conus_tracker_create(&page.tracker, page.follower.selector, NULL);
    status = status ? status : conus_selector_set_range(page.follower.selector, range);
    return status ? status
                  : conus_tracker_step(&page.selection, page.tracker, time_s, pose,
                                       page_question_angle(question, page.follower.weight), step & STEP_PRESSED);
}

/* Asks what is in a cone, as `settings` says: "angle=20&layers=all", of web_form(). {"depth": mm to the deepest hit, 0
 * where the cone has no end, "hits": numbers of the objects in the answer's order, "ranks": the place of each among the
 * colours, "colours": "#rrggbb" of each where colours are of the answer}, or {"error": ...}; web_rows() has the answer,
 * and pictures what it hits. `step` is 0 but for a step of a track, at a time: enum step. Neither has those of the
 * question before where this one is refused. */
EMSCRIPTEN_KEEPALIVE const char *web_ask(double x, double y, double z, double toward_x, double toward_y,
                                         double toward_z, const char *settings, unsigned step, double time_s)
{
    conus_pose pose;
    struct page_question question = {0};
    conus_selection_destroy(page.selection);
    page.selection = NULL;
    char *words = strdup(settings);
    messages_hold(true);
    const bool is_read = words && page_question_read(&question, words);
    messages_hold(false);
    if (!is_read) {
        free(words);
        return words ? say_words(error_line()) : say(NULL);
    }
    const double angle = question.angle;
    const double ends[2] = {question.selector.range[0], question.selector.range[1]};
    const double *range = ends[1] > 0 ? ends : NULL;
    question.selector.range[0] = question.selector.range[1] = 0;
    conus_status status =
        conus_pose_toward(&pose, (const double[]){x, y, z}, (const double[]){toward_x, toward_y, toward_z}, NULL);
    if (step) {
        status = status ? status : answer_step(&question, &pose, range, step, time_s);
        free(words);
    } else {
        question.angle = 0;
        take_question(&question, words);
        status = status ? status : prepare_asker(&page.asker, &question, NULL);
        question.angle = angle;
        status = status ? status : conus_selector_set_range(page.asker.selector, range);
        status = status ? status
                        : conus_select(&page.selection, page.asker.selector, &pose,
                                       page_question_angle(&question, page.asker.weight));
    }
    return status ? say_error() : say_hits(question.layers ? 0 : find_depth(&pose));
}

static conus_status write_report(const char *format)
{
    const bool is_step = conus_selection_step(page.selection);
    const conus_report_options options = {.format = format, .tracker = is_step ? page.tracker : NULL};
    conus_report_destroy(page.report);
    page.report = NULL;
    conus_status status = conus_report_create(&page.report, (is_step ? page.follower : page.asker).selector, &options);
    return status ? status : conus_report_add(page.report, "1", page.selection);
}

/* The rows of the answer, in a format of conus_format_at(). */
EMSCRIPTEN_KEEPALIVE const char *web_rows(int format)
{
    const char *text = NULL;
    size_t size = 0;
    bool failed = !page.selection || write_report(conus_format_at((size_t)format)->name) ||
                  conus_report_text(&text, &size, page.report);
    return failed ? say_error() : text;
}

/* The sidecar of the answer: columns, units, files with their SHA-256, settings, version. */
EMSCRIPTEN_KEEPALIVE const char *web_sidecar(void)
{
    const char *text = NULL;
    size_t size = 0;
    bool failed = !page.selection || write_report("tsv") || conus_report_sidecar(&text, &size, page.report);
    return failed ? say_error() : text;
}

/* Of a cone that leaves from beside the atlas: no line of it is near a cut. */
static conus_status select_nothing(void)
{
    static const double far_away[3] = {1e5, 1e5, 1e5};
    static const double farther[3] = {2e5, 2e5, 2e5};
    conus_pose pose;
    if (page.nothing) {
        return CONUS_OK;
    }
    conus_status status = prepare_asker(&page.asker, &page.question, NULL);
    status = status ? status : conus_pose_toward(&pose, far_away, farther, NULL);
    return status ? status : conus_select(&page.nothing, page.asker.selector, &pose, 1);
}

/* Draws a cut, without the cone: right and up are unit vectors along axes of the world, each a digit of "xyz" as 0 to
 * 2. The objects of its pixels are web_part(6). NULL after an error. */
EMSCRIPTEN_KEEPALIVE const uint8_t *web_cut(int right, int up, double x, double y, double z, uint32_t width,
                                            uint32_t height, double mm_per_pixel, double fill, double black,
                                            double white)
{
    conus_cut_view view = CONUS_CUT_VIEW_INIT;
    view.centre[0] = x;
    view.centre[1] = y;
    view.centre[2] = z;
    view.right[right] = 1;
    view.up[up] = 1;
    view.width = width;
    view.height = height;
    view.mm_per_pixel = mm_per_pixel;
    view.fill = fill;
    view.window[0] = black;
    view.window[1] = white;
    view.own_colours = page.colours == COLOURS_OF_FILE;
    view.no_cone = true;
    conus_cutter **cutter = &page.cutters[3 - right - up];
    bool failed = (!page.selection && !view.own_colours && select_nothing()) || /* else all have their own */
                  (!*cutter && conus_cutter_create(cutter, page.atlas));
    view.selection = page.selection || view.own_colours ? page.selection : page.nothing;
    failed = failed || conus_cutter_draw(*cutter, &view);
    page.cut = *cutter;
    return failed ? NULL : conus_cutter_rgba(*cutter);
}

/* The mean distance of the pixels around one that show the same surface: voxels have corners, brains do not. */
static double smooth_distance(const conus_evidence *evidence, int x, int y, double step)
{
    const int side = (int)evidence->resolution;
    const double here = evidence->distance[y * side + x];
    double sum = 0;
    int count = 0;
    for (int v = y < REACH ? 0 : y - REACH; v <= y + REACH && v < side; v++) {
        for (int u = x < REACH ? 0 : x - REACH; u <= x + REACH && u < side; u++) {
            double there = evidence->distance[v * side + u];
            if (fabs(there - here) <= step) {
                sum += there;
                count++;
            }
        }
    }
    return sum / count;
}

static double at_or(const float *distances, int from, int to, double step)
{
    return fabs(distances[to] - distances[from]) <= step ? distances[to] : distances[from];
}

/* Lambert's cosine of a light at the eye, from the slopes of the distances. `pixel` is a pixel's width at 1 mm. */
static double shade(int x, int y, int side, double pixel, double step)
{
    const int here = y * side + x;
    const float *d = page.distances;
    double scale = 2 * d[here] * pixel;
    double across = at_or(d, here, x + 1 < side ? here + 1 : here, step) - at_or(d, here, x ? here - 1 : here, step);
    double down =
        at_or(d, here, y + 1 < side ? here + side : here, step) - at_or(d, here, y ? here - side : here, step);
    return 1 / sqrt(1 + (across * across + down * down) / (scale * scale));
}

/* How much of the sky a pixel sees, 0 to 1: what is nearer a few mm beside it hides some. */
static double see_sky(int x, int y, int side, double pixel)
{
    static const float around[8][2] = {{1, 0},  {0.7F, 0.7F},   {0, 1},  {-0.7F, 0.7F},
                                       {-1, 0}, {-0.7F, -0.7F}, {0, -1}, {0.7F, -0.7F}};
    static const float far[2] = {3, 8}; /* mm */
    const float here = page.distances[y * side + x];
    const float pixels = 1 / (here * (float)pixel); /* of a mm */
    float hidden = 0;
    for (int ring = 0; ring < 2; ring++) {
        for (int i = 0; i < 8; i++) {
            const int u = x + (int)(far[ring] * around[i][0] * pixels);
            const int v = y + (int)(far[ring] * around[i][1] * pixels);
            const bool is_inside = u >= 0 && v >= 0 && u < side && v < side;
            const float nearer = is_inside ? here - page.distances[v * side + u] : 0;
            hidden += nearer > 0 && nearer < 4 * far[ring] ? fminf(nearer / far[ring], 1) : 0;
        }
    }
    return 1 - hidden / 16;
}

/* Whether the surface ends at a pixel before something farther away, as a line of a pixel around the brain. */
static bool is_edge(int x, int y, int side, double step)
{
    const float *d = page.distances + y * side + x;
    return (x && d[-1] - *d > step) || (x + 1 < side && d[1] - *d > step) || (y && d[-side] - *d > step) ||
           (y + 1 < side && d[side] - *d > step);
}

struct paint {
    uint8_t rgb[3];
    bool is_behind; /* stripes */
};

/* sRGB of each object by number, to be freed: of what is hit by its place in the answer, or of the file; of all else a
 * neutral grey, or its own with much of that. NULL without memory. */
static struct paint *choose_paints(void)
{
    const size_t count = page.selection ? conus_selection_count(page.selection) : 0;
    struct paint *paints = calloc(conus_atlas_object_count(page.atlas) + 1, sizeof *paints);
    for (size_t i = 1; paints && i <= conus_atlas_object_count(page.atlas); i++) {
        const uint8_t *own = conus_atlas_object(page.atlas, i)->rgb;
        for (int c = 0; c < 3; c++) {
            paints[i].rgb[c] = page.colours == COLOURS_OF_ANSWER ? neutral[c]
                               : page.selection                  ? (uint8_t)((own[c] + 3 * neutral[c]) / 4)
                                                                 : own[c];
        }
    }
    for (size_t i = 0; paints && i < count; i++) {
        const conus_result *result = conus_selection_result(page.selection, i);
        struct paint hit = {.is_behind = !result->pixels};
        if (colour_hit(hit.rgb, result->object)) {
            if (page.colours == COLOURS_OF_FILE) {
                memcpy(hit.rgb, conus_atlas_object(page.atlas, result->object)->rgb, sizeof hit.rgb);
            }
            paints[result->object] = hit;
        }
    }
    return paints;
}

/* Finds what is seen from an eye: x, y, z, toward x, y, z, angle. What was found for the same one is kept, so that
 * another answer only paints it anew. */
static conus_status look(uint32_t side, const double eye[7])
{
    static const double up[3] = {0, 0, 1};
    const double step = 6; /* mm: farther apart are two surfaces */
    const double pixel = 2 * tan(eye[6] * RADIANS / 2) / side;
    const int n = (int)side;
    conus_pose pose;
    conus_selection *selection = NULL;
    struct viewer *viewer = &page.viewers[side > COARSE_LIMIT];
    bool is_seen = page.seen == side;
    for (size_t i = 0; i < 7; i++) {
        is_seen = is_seen && page.eye[i] == eye[i];
    }
    if (is_seen) {
        return CONUS_OK;
    }
    page.seen = 0;
    if (viewer->side != side) {
        forget_asker(&viewer->asker);
    }
    viewer->side = side;
    conus_status status = prepare_asker(&viewer->asker, &(struct page_question){.selector.resolution = side}, NULL);
    status = status ? status : conus_pose_toward(&pose, eye, eye + 3, up);
    status = status ? status : conus_select(&selection, viewer->asker.selector, &pose, eye[6]);
    if (status) {
        return status;
    }
    const conus_evidence evidence = conus_selection_evidence(selection);
    for (int p = 0; p < n * n; p++) {
        int from = (n - 1 - p / n) * n + p % n; /* the device's row 0 is at the bottom */
        page.objects[p] = evidence.object[from];
        page.distances[p] =
            isfinite(evidence.distance[from]) ? (float)smooth_distance(&evidence, from % n, from / n, step) : INFINITY;
    }
    for (int p = 0; p < n * n; p++) {
        if (page.objects[p]) {
            double light = 0.45 + 0.55 * shade(p % n, p / n, n, pixel, step) * see_sky(p % n, p / n, n, pixel);
            page.light[p] = (float)(light * (is_edge(p % n, p / n, n, step) ? 0.4 : 1));
        }
    }
    conus_selection_destroy(selection);
    memcpy(page.eye, eye, sizeof page.eye);
    page.seen = side;
    return CONUS_OK;
}

/* Draws what is seen from a point: first hits of side x side rays, so that each pixel's object is exact. What the
 * question hits has colour, all else is a neutral grey. Its pixels have web_part(7) and (8).
 * NULL after an error. */
EMSCRIPTEN_KEEPALIVE const uint8_t *web_view(uint32_t side, double x, double y, double z, double toward_x,
                                             double toward_y, double toward_z, double angle, uint32_t chosen)
{
    const double eye[7] = {x, y, z, toward_x, toward_y, toward_z, angle};
    struct paint *paints = side > SIDE_LIMIT || look(side, eye) ? NULL : choose_paints();
    if (!paints) {
        return NULL;
    }
    for (uint32_t p = 0; p < side * side; p++) {
        const uint32_t object = page.objects[p];
        const struct paint *paint = &paints[object];
        const bool is_stripe = paint->is_behind && (p % side + p / side) * 64 / side % 2;
        const float light = page.light[p] * (chosen && chosen != object ? 0.4F : 1);
        uint8_t *out = page.rgba + 4 * (size_t)p;
        for (int c = 0; c < 3; c++) {
            out[c] = object ? (uint8_t)((is_stripe ? neutral : paint->rgb)[c] * light) : 0;
        }
        out[3] = object ? 255 : 0;
    }
    free(paints);
    return page.rgba;
}

/* Makes the surfaces of all areas, for a headset. {"sizes": bytes of each of web_part(0) to (5), "closed": whether
 * each surface is}, or {"error": ...}. web_mesh_end() frees them. */
EMSCRIPTEN_KEEPALIVE const char *web_mesh(uint32_t cells)
{
    const struct nets *nets = &page.nets;
    if (nets_make(&page.nets, page.atlas, cells)) {
        return say_error();
    }
    const size_t sizes[] = {12 * nets->vertex_count, 4 * nets->vertex_count,
                            2 * nets->vertex_count,  4 * nets->corner_count,
                            4 * nets->outer_count,   4 * (conus_atlas_object_count(page.atlas) + 2)};
    json_t *list = json_array();
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        json_array_append_new(list, json_integer((json_int_t)sizes[i]));
    }
    return say(json_pack("{s:o, s:b}", "sizes", list, "closed", nets->is_closed));
}

/* Of surfaces positions, normals, objects, corners, outer, first, as struct nets says; of each pixel the object in the
 * last cut, and in the view the object and the distance. */
EMSCRIPTEN_KEEPALIVE const void *web_part(int part)
{
    const struct nets *nets = &page.nets;
    return (const void *[]){nets->positions,
                            nets->normals,
                            nets->objects,
                            nets->corners,
                            nets->outer,
                            nets->first,
                            page.cut ? conus_cutter_objects(page.cut) : NULL,
                            page.objects,
                            page.distances}[part];
}

EMSCRIPTEN_KEEPALIVE void web_mesh_end(void)
{
    nets_finish(&page.nets);
}

EMSCRIPTEN_KEEPALIVE const char *web_error(void)
{
    return say_error();
}
