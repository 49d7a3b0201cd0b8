/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The harness of the gl engine's tests: both engines for one atlas, their answers, and comparisons of these. */
#ifndef CONUS_TESTS_SUPPORT_GL_PAIR_H
#define CONUS_TESTS_SUPPORT_GL_PAIR_H

#include "selection/engine/engine.h"
#include "selection/evidence/evidence.h"

/** Counts of a test's comparisons; each test uses those that it needs. */
struct gl_counts {
    size_t compared;     /**< Pixels, or pairs of a pixel and an object.                  */
    size_t hits;         /**< Pixels that hit an object, or intervals.                    */
    size_t blocked;      /**< Those of them by a context volume that blocks.              */
    size_t at_edges;     /**< Compared ones that differ beside a triangle's edge.         */
    size_t other_object; /**< Those of them in which only one engine hits the object.     */
    size_t other_length; /**< Those of them in which the object has another length.       */
};

struct gl_pair {
    const conus_atlas *atlas;
    struct engine *gl, *rays;
    struct gl_counts counts;
};

/** Creates both engines. Without GL the running test is skipped, saying why. @p slices and
 * @p fraction of them count for CONUS_SAMPLING_SLICES only. */
struct gl_pair gl_pair_create_slices(const conus_atlas *atlas, conus_sampling sampling, uint32_t slices,
                                     double fraction);
struct gl_pair gl_pair_create(const conus_atlas *atlas, conus_sampling sampling);
void gl_pair_destroy(struct gl_pair *pair);

/** The log of the engines here: prints and counts the lines of drivers. Its user data is not used. */
void gl_pair_log(void *user, const conus_note *note);

/** Number of lines that drivers have logged so far. */
int gl_pair_messages(void);

/** How often the CPU has waited for the device, in this process, since the first call. */
int gl_pair_waits(void);

/** A test that runs last: asserts that no driver has logged anything. */
void the_driver_was_silent(void **state);

/** First hits of an engine. End it with evidence_finish(). */
struct evidence gl_pair_trace(struct engine *engine, const struct cone *cone);

/** All hits of an engine, sorted. End them with layers_finish(). */
struct layers gl_pair_pierce(struct engine *engine, const struct cone *cone);

/** Fails where the engines differ in object, voxel or, by a single bit, in distance; prints up to three such pixels.
 * Returns how many pixels hit. */
size_t gl_pair_same_hits(const struct gl_pair *pair, const struct cone *cone);
void gl_pair_same_evidence(const struct evidence *got, const struct evidence *wanted);

/** Whether two intervals are equal in every number. */
bool gl_pair_same_interval(const conus_interval *a, const conus_interval *b);

/** The comparison that a test makes for a cone. */
typedef void (*gl_comparison)(struct gl_pair *pair, const struct cone *cone);

/** Compares along @p poses random cones round a scene of @p size mm, every @p cylinder -th a cylinder (0: none). */
void gl_pair_compare_poses(struct gl_counts *counts, uint64_t *state, const conus_atlas *atlas, gl_comparison compare,
                           double size, int poses, int cylinder);

/** The same with ten cones in each of @p scenes scenes of triangles that are open, cut each other and themselves. */
void gl_pair_compare_triangles(struct gl_counts *counts, uint64_t *state, gl_comparison compare, int scenes,
                               int cylinder);

/** The same where voxels and triangles hide each other. */
void gl_pair_compare_mixed(struct gl_counts *counts, uint64_t *state, gl_comparison compare, int scenes);

/** Creates a gl engine, answers the cone and destroys the engine, with every allocation failing in turn. */
void gl_pair_every_allocation(const conus_atlas *atlas, const struct cone *cone, bool layers);

#endif
