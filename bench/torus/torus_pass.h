/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The torus scene as the paper draws it, every torus into a frame and into the device's buffer; and the engines
 * that are compared with it, all on one number of tori. */
#ifndef CONUS_BENCH_TORUS_TORUS_PASS_H
#define CONUS_BENCH_TORUS_TORUS_PASS_H

#include "bench/torus/torus_scene.h"
#include "selection/engine/engine.h"

struct torus_pass;

/** Draws a frame of @p size pixels, all tori in colour, lit per pixel, without culling, and does not wait for it. The
 * target is made anew when the size changes. */
conus_status torus_pass_frame(struct torus_pass *pass, const uint32_t size[2]);

/** Waits for all that has been drawn. */
conus_status torus_pass_wait(struct torus_pass *pass);

/** Part of the last frame that shows a torus. */
conus_status torus_pass_coverage(double *out, struct torus_pass *pass);

const char *torus_pass_device(const struct torus_pass *pass);

/** The ways to select from one number of tori. */
enum torus_way { TORUS_ALL_DRAWN, TORUS_GL, TORUS_RAYS, TORUS_WAYS };

struct torus_round {
    struct torus_scene scene;
    conus_atlas *atlas;     /**< NULL where the tori are too many for triangles of their own: then TORUS_RAYS has */
    struct mesh_rays *rays; /**< placed ones, and there is no TORUS_GL.                                          */
    struct torus_pass *pass;
    struct engine *engines[TORUS_WAYS];
};

/** CONUS_ERROR_GL where there is no OpenGL. End it with torus_round_finish() even if this fails. */
conus_status torus_round_init(struct torus_round *out, size_t count, bool placed);
void torus_round_finish(struct torus_round *round);

/** "20000 tori, gl engine" */
void torus_round_name(char *out, size_t size, const struct torus_round *round, enum torus_way way);

#endif
