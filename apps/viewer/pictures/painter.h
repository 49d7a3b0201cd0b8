/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The 3-D pictures, drawn by conus_render() on a thread with a GL context of its own, so that the window never waits
 * for them. While the view moves they are coarse and quick, as is the first one without a GPU; when it rests they
 * become fine. All functions are for one thread, the window's. */
#ifndef CONUS_VIEWER_PICTURES_PAINTER_H
#define CONUS_VIEWER_PICTURES_PAINTER_H

#include "viewer/pictures/answer.h"
#include "viewer/pictures/appearance.h"
#include "viewer/pictures/camera.h"

struct painter;

/** A picture to draw. */
struct painting {
    struct eye eye;
    uint32_t width, height;
    double fade;
    enum backdrop backdrop;
    bool is_dark;           /**< The theme, if it is that of the theme. */
    bool own_colours;       /**< As of conus_view. */
    uint32_t chosen;        /**< Object that is never pale; 0 = none. */
    struct answer *answer;  /**< What it hits stands out; its cone is not drawn. NULL = none. */
    bool is_old;            /**< The answer: what it hits is pale. */
    unsigned answer_number; /**< Two paintings of the same number have the same answer. */
    unsigned plan_number;   /**< Likewise of plans, with which there is an answer before there is a cone. */
    unsigned scene_number;  /**< Changes with hidden objects, the transfer function, opacities and the atlas. */
    bool moving;            /**< Another one will follow soon: be quick. */
};

/** Whether both would give the same picture, be it coarse or fine. */
bool painting_shows_same(const struct painting *a, const struct painting *b);

/** A drawn picture. */
struct painted {
    uint32_t width, height; /**< At most what was asked. */
    uint8_t *rgba;          /**< sRGB, top row first; to be freed with free(). */
    struct painting what;   /**< Without the answer. */
    double milliseconds;
    bool fine; /**< Nothing finer will come of the same painting. */
};

/** sRGB of an image, not premultiplied, to be freed with free(); NULL without memory. */
uint8_t *painted_bytes(const conus_image *image);

/** Starts the thread; @p transfer and @p log (called on that thread) as in conus_renderer_options, opacities and haze
 * as @p appearance says, which is copied. @p wake (NULL = none) is called there when there is something new: a picture,
 * an error, the device's name. False without memory or threads. */
bool painter_create(struct painter **out, const conus_atlas *atlas, const char *transfer,
                    const struct appearance *appearance, conus_log log, void (*wake)(void));
void painter_destroy(struct painter *painter);

/** Asks for a picture instead of what was asked before. */
void painter_ask(struct painter *painter, const struct painting *what);
/** Whether there was something new since the last time this was asked. */
bool painter_has_update(struct painter *painter);
/** The newest picture, once: false if there is none since the last one. */
bool painter_take(struct painter *painter, struct painted *out);
/** Waits until the thread does not read the atlas, which it does not do again before painter_resume(). */
void painter_hold(struct painter *painter);
/** The atlas may hide other objects now. */
void painter_resume(struct painter *painter);
/** Draws with the opacities of @p appearance from now on; false without memory. */
bool painter_set_opacity(struct painter *painter, const struct appearance *appearance);
/** Draws with another transfer function; false without memory. */
bool painter_set_transfer(struct painter *painter, const conus_transfer_point *points, size_t count);

/** The transfer function that is used, up to @p capacity points; 0 before it is known, or where there is no context. */
size_t painter_transfer(struct painter *painter, conus_transfer_point *points, size_t capacity);

/** Why nothing is drawn, in one line; false while all is well. */
bool painter_error(struct painter *painter, char *out, size_t size);
/** The device that draws; "" before it is known. */
void painter_device(struct painter *painter, char *out, size_t size);

#endif
