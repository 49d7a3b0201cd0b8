/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Both engines for one atlas. */
#ifndef CONUS_TESTS_SUPPORT_GL_PAIR_H
#define CONUS_TESTS_SUPPORT_GL_PAIR_H

#include "selection/engine/layers.h"

struct gl_pair {
    const conus_atlas *atlas;
    struct engine *gl, *rays;
};

/** Makes both engines; the running test is skipped, saying why, where there is no GL. */
struct gl_pair gl_pair_create(const conus_atlas *atlas, conus_sampling sampling);
void gl_pair_destroy(struct gl_pair *pair);

/** What drivers have had to say so far, in lines. */
int gl_pair_messages(void);

/** All layers that an engine sees, sorted. End them with layers_finish(). */
struct layers gl_pair_pierce(struct engine *engine, const struct cone *cone);

/** Whether two pieces are equal in every number. */
bool gl_pair_same_piece(const conus_span *a, const conus_span *b);

#endif
