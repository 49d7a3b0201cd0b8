/* SPDX-License-Identifier: BSD-3-Clause */
/* The thread that draws 3-D pictures: coarse, full, smooth. */
#include "viewer/pictures/pictures.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/progress.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* While the view moves a picture shall take no longer; and no coarser than that many pixels of the pane per pixel. */
static const double quick_ms = 60;
/* Assumed time of a driver without a GPU before it has drawn anything: so the first picture is a quick one, too. */
static const double software_ms_per_pixel = 0.0015;
/* Pictures shall not hold up the window, where both share processors: above 0, "nicer" than it. */
static const int niceness = 2;
enum { COARSEST = 5, LEVELS = 4096, TRANSFER_POINTS = 64 };

/* How fine pictures of one painting become, one after the other. */
enum stage { STAGE_NONE = 0, STAGE_COARSE, STAGE_FULL, STAGE_SMOOTH };

/* Changes of the scene that are not drawn yet. */
struct scene_update {
    bool hidden;                  /* the atlas hides other objects */
    conus_transfer_point *points; /* of another transfer function; NULL = none */
    size_t point_count;
    double *opacity; /* as in struct look; NULL = none */
};

struct painter {
    pthread_t thread;
    pthread_mutex_t lock; /* guards what follows */
    pthread_cond_t wake;
    bool stop;
    struct painting asked;
    bool is_new;    /* asked has not been begun */
    bool is_busy;   /* reads the atlas */
    unsigned holds; /* the window is about to change the atlas, or does: do not begin to read it */
    struct scene_update update;
    pthread_cond_t rest; /* is_busy ended */
    struct painted done;
    char texts[PAINTER_TEXTS][PAINTER_TEXT];
    bool has_update;
    bool is_covered;                            /* the context, by areas that are shown */
    conus_transfer_point used[TRANSFER_POINTS]; /* the transfer function in use */
    size_t used_count;

    /* the thread's own */
    bool knows_cover; /* is_covered is of the areas that are shown now */
    const conus_atlas *atlas;
    char *transfer;
    double *opacity;
    conus_pathway_transfer *pathways;
    size_t pathway_count;
    const char *streamline_colour; /* the atlas's, or static */
    conus_log log;
    void (*wake_window)(void);
    double ms_per_pixel;
};

bool painting_shows_same(const struct painting *a, const struct painting *b)
{
    return a->width == b->width && a->height == b->height && a->fade == b->fade &&
           a->leaves_context == b->leaves_context && a->own_colours == b->own_colours && a->is_old == b->is_old &&
           a->backdrop == b->backdrop && a->is_dark == b->is_dark && a->chosen == b->chosen &&
           a->answer_number == b->answer_number && a->plan_number == b->plan_number &&
           a->scene_number == b->scene_number && eye_is_same(&a->eye, &b->eye);
}

/* Tells the window that something changed. To be called with the lock held, which it releases. */
static void wake_window(struct painter *painter)
{
    painter->has_update = true;
    pthread_mutex_unlock(&painter->lock);
    if (painter->wake_window) {
        painter->wake_window();
    }
}

static void put_text(struct painter *painter, enum painter_text which, const char *text)
{
    pthread_mutex_lock(&painter->lock);
    snprintf(painter->texts[which], PAINTER_TEXT, "%s", text);
    wake_window(painter);
}

static void note_error(struct painter *painter)
{
    put_text(painter, PAINTER_ERROR, conus_message());
}

/* Keeps the newest note for the window. */
static void keep_note(void *user, const conus_note *note)
{
    struct painter *painter = user;
    put_text(painter, PAINTER_NOTE, note->line);
    painter->log(NULL, note);
}

uint8_t *painted_bytes(const conus_image *image)
{
    static const char *const channels[] = {"R", "G", "B"};
    const size_t pixels = (size_t)conus_image_width(image) * conus_image_height(image);
    const float *alpha = conus_image_floats(image, "A");
    uint8_t *rgba = calloc(pixels, 4);
    uint8_t bytes[LEVELS]; /* sRGB of linear light */
    for (int i = 0; i < LEVELS; i++) {
        double linear = (double)i / (LEVELS - 1);
        double srgb = linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
        bytes[i] = (uint8_t)(255 * srgb + 0.5);
    }
    for (size_t c = 0; rgba && c < 3; c++) {
        const float *plane = conus_image_floats(image, channels[c]);
        for (size_t p = 0; p < pixels; p++) {
            if (alpha[p] > 0) {
                float level = fminf(fmaxf(plane[p] / alpha[p], 0), 1) * (LEVELS - 1);
                rgba[4 * p + c] = bytes[(size_t)(level + 0.5F)];
                rgba[4 * p + 3] = (uint8_t)(255 * fminf(alpha[p], 1) + 0.5F);
            }
        }
    }
    return rgba;
}

static bool is_update(const struct scene_update *update)
{
    return update->hidden || update->points || update->opacity;
}

/* A picture that is being drawn. */
struct drawing {
    struct painter *painter;
    const struct painting *what;
};

/* Asked between its pieces: whether nobody has asked for another one meanwhile, nor is about to change the scene. */
static bool is_wanted(void *user, size_t done, size_t total)
{
    const struct drawing *drawing = user;
    struct painter *painter = drawing->painter;
    (void)done, (void)total;
    pthread_mutex_lock(&painter->lock);
    bool other = painter->is_new && !painting_shows_same(&painter->asked, drawing->what);
    bool wanted = !painter->stop && !painter->holds && !is_update(&painter->update) && !other;
    pthread_mutex_unlock(&painter->lock);
    return wanted;
}

/* Whether areas cover the context. After areas were hidden or shown, that looks through the image once. */
static bool finds_cover(struct painter *painter)
{
    if (!painter->knows_cover) {
        bool is_covered = false;
        const bool fails = conus_context_is_covered(&is_covered, painter->atlas); /* of one grey */
        pthread_mutex_lock(&painter->lock);
        painter->is_covered = !fails && is_covered;
        pthread_mutex_unlock(&painter->lock);
        painter->knows_cover = true;
    }
    return painter->is_covered;
}

/* Returns the stage that is reached: the one before where the picture is not wanted any more. A coarse one is drawn to
 * its end, or else a view that moves would have none. */
static enum stage paint(struct painter *painter, conus_renderer *renderer, const struct painting *what,
                        enum stage stage)
{
    struct drawing drawing = {painter, what};
    double pixels = (double)what->width * what->height;
    double wanted = sqrt(painter->ms_per_pixel * pixels / quick_ms);
    /* Pixels of the pane per pixel of the picture. */
    double coarse = stage == STAGE_COARSE ? fmin(fmax(wanted, 1), COARSEST) : 1;
    conus_image *image = NULL;
    const double *f = what->eye.frustum;
    conus_view view = {.width = (uint32_t)fmax(what->width / coarse, 1),
                       .height = (uint32_t)fmax(what->height / coarse, 1),
                       .frustum = {f[0], f[1], f[2], f[3]},
                       .camera = &what->eye.camera,
                       .selection = answer_selection(what->answer),
                       .no_cone = true, /* pane_cone.c has it */
                       .chosen = what->chosen,
                       .no_legend = true,
                       .own_colours = what->own_colours,
                       .draft = stage != STAGE_SMOOTH,
                       .fade = what->leaves_context && finds_cover(painter) ? 1 : what->fade,
                       .opacity = painter->opacity,
                       .pale = painter->opacity[0],
                       .progress = stage == STAGE_COARSE ? NULL : is_wanted,
                       .progress_user = &drawing};
    backdrop_set(&view, what->backdrop, what->is_dark);
    double begun = clock_ms();
    conus_status status = conus_render(&image, renderer, &view);
    if (status == CONUS_ERROR_CANCELLED) {
        return stage - 1;
    }
    if (status) {
        note_error(painter);
        return STAGE_SMOOTH;
    }
    struct painted picture = {.width = view.width, .height = view.height, .what = *what, .fine = stage == STAGE_SMOOTH};
    picture.rgba = painted_bytes(image);
    bool is_full = view.width == what->width && view.height == what->height;
    if (picture.rgba && !is_full) { /* the window enlarges it */
        edges_smooth(picture.rgba, view.width, view.height);
    }
    if (picture.rgba && what->is_old) {
        answer_pale(picture.rgba, (size_t)view.width * view.height);
    }
    picture.what.answer = NULL;
    picture.milliseconds = clock_ms() - begun;
    conus_image_destroy(image);
    if (stage != STAGE_SMOOTH) {
        painter->ms_per_pixel = picture.milliseconds / ((double)view.width * view.height);
    }
    if (picture.rgba) {
        pthread_mutex_lock(&painter->lock);
        free(painter->done.rgba);
        painter->done = picture;
        wake_window(painter);
    }
    return stage == STAGE_COARSE && is_full ? STAGE_FULL : stage;
}

/* The window draws a frame of it, but not beside the first picture, which comes with it where one is asked for. */
static void note_transfer(struct painter *painter, const conus_renderer *renderer)
{
    size_t count;
    const conus_transfer_point *points = conus_renderer_transfer(&count, renderer);
    count = count < TRANSFER_POINTS ? count : 0; /* a long table is not for editing by hand */
    pthread_mutex_lock(&painter->lock);
    if (!painter->used_count) { /* else another one was set meanwhile */
        memcpy(painter->used, points ? points : painter->used, count * sizeof *points);
        painter->used_count = count;
    }
    if (painter->is_new) {
        pthread_mutex_unlock(&painter->lock);
    } else {
        wake_window(painter);
    }
}

/* Frees the changes that were not drawn. */
static void forget_update(struct scene_update *update)
{
    free(update->points);
    free(update->opacity);
    *update = (struct scene_update){0};
}

static void apply_update(struct painter *painter, conus_renderer *renderer, struct scene_update *update)
{
    conus_status status = update->hidden ? conus_renderer_update(renderer) : CONUS_OK;
    if (!status && update->points) {
        status = conus_renderer_set_transfer(renderer, update->points, update->point_count);
    }
    if (status) {
        note_error(painter);
    }
    painter->knows_cover = painter->knows_cover && !update->hidden;
    if (update->opacity) {
        free(painter->opacity);
        painter->opacity = update->opacity;
        update->opacity = NULL;
    }
    forget_update(update);
}

/* Notes that the atlas is not read any more. To be called with the lock held. */
static void end_reading(struct painter *painter)
{
    painter->is_busy = false;
    pthread_cond_signal(&painter->rest);
}

/* Waits for something to do; what is there is moved out. False: stop. */
static bool wait_for_work(struct painter *painter, struct painting *what, enum stage *stage,
                          struct scene_update *update)
{
    pthread_mutex_lock(&painter->lock);
    end_reading(painter);
    bool idle = *stage == STAGE_SMOOTH || *stage == STAGE_NONE || what->moving;
    while (!painter->stop && (painter->holds || (idle && !painter->is_new && !is_update(&painter->update)))) {
        pthread_cond_wait(&painter->wake, &painter->lock);
    }
    bool rests = painter->is_new && !is_update(&painter->update) &&
                 painting_shows_same(&painter->asked, what); /* what was drawn so far holds: continue, finer */
    bool changed = (painter->is_new || is_update(&painter->update)) && !rests;
    if (painter->is_new) {
        answer_drop(what->answer);
        *what = painter->asked;
        painter->asked.answer = NULL;
        painter->is_new = false;
    }
    if (changed) {
        *stage = STAGE_NONE;
    }
    *update = painter->update;
    painter->update = (struct scene_update){0};
    bool continues = !painter->stop;
    painter->is_busy = continues;
    pthread_mutex_unlock(&painter->lock);
    return continues;
}

static void paint_all(struct painter *painter, conus_renderer *renderer)
{
    struct painting what = {0};
    enum stage stage = STAGE_NONE;
    struct scene_update update;
    while (wait_for_work(painter, &what, &stage, &update)) {
        apply_update(painter, renderer, &update);
        if (what.width && what.height) {
            stage = paint(painter, renderer, &what, stage + 1);
        }
    }
    forget_update(&update);
    answer_drop(what.answer);
}

static void *run(void *user)
{
    struct painter *painter = user;
    conus_renderer *renderer = NULL;
    const conus_renderer_options options = {.transfer = painter->transfer,
                                            .log = painter->log ? keep_note : NULL,
                                            .log_user = painter,
                                            .pathways = painter->pathways,
                                            .pathway_count = painter->pathway_count,
                                            .streamline_colour = painter->streamline_colour};
    system_step_back(niceness); /* this thread, and those it starts */
    if (conus_renderer_create(&renderer, painter->atlas, &options)) {
        note_error(painter);
        pthread_mutex_lock(&painter->lock);
        end_reading(painter);
        pthread_mutex_unlock(&painter->lock);
        return NULL;
    }
    const char *device = conus_renderer_device(renderer);
    bool is_software = strstr(device, "llvmpipe") || strstr(device, "softpipe");
    pthread_mutex_lock(&painter->lock);
    snprintf(painter->texts[PAINTER_DEVICE], PAINTER_TEXT, "%s", device);
    pthread_mutex_unlock(&painter->lock);
    painter->ms_per_pixel = is_software ? software_ms_per_pixel : 0;
    note_transfer(painter, renderer);
    paint_all(painter, renderer);
    conus_renderer_destroy(renderer);
    return NULL;
}

static double *copy_opacity(const struct appearance *appearance)
{
    double *copy = malloc((appearance->object_count + 1) * sizeof *copy);
    if (copy) {
        memcpy(copy, appearance->opacity, (appearance->object_count + 1) * sizeof *copy);
    }
    return copy;
}

static void free_painter(struct painter *painter)
{
    forget_update(&painter->update);
    free(painter->done.rgba);
    free(painter->opacity);
    free(painter->pathways);
    free(painter->transfer);
    free(painter);
}

bool painter_create(struct painter **out, const conus_atlas *atlas, const char *transfer,
                    const struct appearance *appearance, conus_log log, void (*wake)(void))
{
    struct painter *painter = calloc(1, sizeof *painter);
    if (!painter) {
        return false;
    }
    painter->atlas = atlas;
    painter->log = log;
    painter->wake_window = wake;
    painter->is_busy = true; /* until there is a renderer */
    painter->transfer = transfer ? strdup(transfer) : NULL;
    painter->streamline_colour = appearance_streamline_colour(appearance, atlas);
    painter->opacity = copy_opacity(appearance);
    painter->pathways = calloc(appearance->object_count + 1, sizeof *painter->pathways);
    bool fine = (painter->transfer || !transfer) && painter->opacity && painter->pathways;
    painter->pathway_count = fine ? appearance_pathways(painter->pathways, appearance) : 0;
    pthread_mutex_init(&painter->lock, NULL);
    pthread_cond_init(&painter->wake, NULL);
    pthread_cond_init(&painter->rest, NULL);
    if (!fine || pthread_create(&painter->thread, NULL, run, painter)) {
        free_painter(painter);
        return false;
    }
    *out = painter;
    return true;
}

void painter_destroy(struct painter *painter)
{
    if (!painter) {
        return;
    }
    pthread_mutex_lock(&painter->lock);
    painter->stop = true;
    pthread_cond_signal(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    pthread_join(painter->thread, NULL);
    pthread_cond_destroy(&painter->wake);
    pthread_cond_destroy(&painter->rest);
    pthread_mutex_destroy(&painter->lock);
    answer_drop(painter->asked.answer);
    free_painter(painter);
}

void painter_ask(struct painter *painter, const struct painting *what)
{
    pthread_mutex_lock(&painter->lock);
    answer_drop(painter->asked.answer);
    painter->asked = *what;
    painter->asked.answer = answer_keep(what->answer);
    painter->is_new = true;
    pthread_cond_signal(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
}

bool painter_has_update(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    bool update = painter->has_update;
    painter->has_update = false;
    pthread_mutex_unlock(&painter->lock);
    return update;
}

bool painter_take(struct painter *painter, struct painted *out)
{
    pthread_mutex_lock(&painter->lock);
    *out = painter->done;
    painter->done = (struct painted){0};
    pthread_mutex_unlock(&painter->lock);
    return out->rgba;
}

void painter_hold(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->holds++;
    while (painter->is_busy) {
        pthread_cond_wait(&painter->rest, &painter->lock);
    }
    pthread_mutex_unlock(&painter->lock);
}

void painter_resume(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->holds--;
    painter->update.hidden = true;
    pthread_cond_signal(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
}

bool painter_set_opacity(struct painter *painter, const struct appearance *appearance)
{
    double *copy = copy_opacity(appearance);
    if (!copy) {
        return false;
    }
    pthread_mutex_lock(&painter->lock);
    free(painter->update.opacity);
    painter->update.opacity = copy;
    pthread_cond_signal(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    return true;
}

bool painter_set_transfer(struct painter *painter, const conus_transfer_point *points, size_t count)
{
    conus_transfer_point *copy = malloc(count * sizeof *copy);
    if (!copy) {
        return false;
    }
    memcpy(copy, points, count * sizeof *copy);
    pthread_mutex_lock(&painter->lock);
    free(painter->update.points);
    painter->update.points = copy;
    painter->update.point_count = count;
    painter->used_count = count < TRANSFER_POINTS ? count : 0;
    memcpy(painter->used, points, painter->used_count * sizeof *points);
    pthread_cond_signal(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    return true;
}

size_t painter_transfer(struct painter *painter, conus_transfer_point *points, size_t capacity)
{
    pthread_mutex_lock(&painter->lock);
    size_t count = painter->used_count < capacity ? painter->used_count : capacity;
    memcpy(points, painter->used, count * sizeof *points);
    pthread_mutex_unlock(&painter->lock);
    return count;
}

bool painter_finds_cover(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    const bool is_covered = painter->is_covered;
    pthread_mutex_unlock(&painter->lock);
    return is_covered;
}

bool painter_text(char out[PAINTER_TEXT], struct painter *painter, enum painter_text which)
{
    pthread_mutex_lock(&painter->lock);
    memcpy(out, painter->texts[which], PAINTER_TEXT);
    pthread_mutex_unlock(&painter->lock);
    return out[0];
}
