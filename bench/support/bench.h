/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * conus-bench: scenarios in a table, and what they share: interleaved timing, statistics, JSON. A scenario may use the
 * library's internals. Every ratio stands on variants that ran side by side in one process and gave equal answers. */
#ifndef CONUS_BENCH_SUPPORT_BENCH_H
#define CONUS_BENCH_SUPPORT_BENCH_H

#include "atlas/atlas.h"

#include <jansson.h>

struct bench_options {
    const char *atlas;   /**< Path.                                       */
    const char *context; /**< Path of the context volume, for pictures.   */
    const char *bonsai;  /**< Path of the paper's volume; NULL = a stand-in for it is made. */
    double angle;        /**< Full opening, degrees.                      */
    size_t poses;
    size_t slices;  /**< Planes of the colour pass.               */
    size_t repeats; /**< Rounds in which every variant runs once. */
    double seconds; /**< No measurement begins another round when it has taken so long; 0 = never mind. */
    bool check;     /**< Everything small: only equality of answers counts. */
};

/** Rays along a side of all cones of scenarios that a ratio is held of: that of the paper, whatever the default is. */
enum { BENCH_RESOLUTION = 16 };

/** Everything measured, as it goes into the JSON. */
struct bench {
    struct bench_options options;
    const char *folder; /**< For files that a scenario makes; removed in the end. */
    json_t *runs;
    json_t *ratios;
    json_t *left_out; /**< {what: why} for everything that could not be run. */
    size_t crashed;   /**< Scenarios among these whose process ended without a word. */
    char driver[512]; /**< Engine or GL renderer in use.                                              */
    const char *note; /**< A fact that a reader of the figures must know; NULL = none. A literal. */
    bool one_thread;  /**< Set by a scenario whose variants all run on the calling thread: then its CPU
                           time is taken, which other programs on the machine hardly disturb.        */
};

/** Something to time. */
struct bench_variant {
    const char *name;
    void (*run)(void *data);
    void *data;
    void (*prepare)(void *data);      /**< Before each run, and not timed; may be NULL.                    */
    size_t per;                       /**< Queries in a run; 0 = as many as the others.                    */
    bool equal;                       /**< Its answers equal the first variant's.                          */
    bool other_by_design;             /**< It answers something else (slices, say): no failure.            */
    json_t *more;                     /**< Object of further keys for its run; taken over. May be NULL.    */
    double median_ms, min_ms, p90_ms; /**< Out: one run / `per`.                                           */
    double cold_ms; /**< Out: the median of first runs, behind the other variants; NAN if the first run is the one that
                       counts. */
};

/** Times the variants in turn, options.repeats times or as long as options.seconds allows, and adds them to the runs.
 * The timed run follows another one of its own variant, as in a batch that goes on: of short runs the median of three
 * counts, of a run that takes longer than caches matter the first. Times are those of one run divided by @p per
 * (queries in a run, say); @p angle_deg is 0 without a cone. */
conus_status bench_measure(struct bench *bench, const char *scenario, struct bench_variant *variants, size_t count,
                           size_t per, double angle_deg);

/** Adds ratio @p key = @p above / @p below, by medians; null with the reason if their answers differ. */
conus_status bench_ratio(struct bench *bench, const char *key, const struct bench_variant *above,
                         const struct bench_variant *below);
/** Adds a number that is no ratio; null with the reason if @p equal is false. */
conus_status bench_value(struct bench *bench, const char *key, double value, bool equal);

/** Notes that @p what is left out, because of conus_message(). */
conus_status bench_leave_out(struct bench *bench, const char *what);

/** Keeps Mesa's llvmpipe on the calling thread, whose time is taken. Call it before anything draws. */
void bench_draw_on_this_thread(void);

/** Seconds of the wall clock. */
double bench_wall(void);

/** Seconds of processor time, of all threads of this process. */
double bench_cpu(void);

/** Resident memory of this process, bytes, without freed memory where the C library gives that back; 0 if the system
 * does not tell. */
double bench_resident(void);

/** A deterministic generator (SplitMix64); uniform in [low, high). */
double bench_random(uint64_t *state, double low, double high);

/** @p full, or in a check the fiftieth part of it: how many objects, say. */
size_t bench_size(const struct bench_options *options, size_t full);

/** Loads the atlas at @p path, which must have labelled voxels. */
conus_status bench_load_labels(conus_atlas **out, const char *path);

/** b of y = a x^b through @p count points by least squares in the logarithms; all x and y are above 0. NAN unless there
 * are two different x. */
double bench_exponent(const double *x, const double *y, size_t count);

struct bench_scenario {
    const char *name, *description;
    conus_status (*run)(struct bench *bench);
    size_t poses, repeats; /**< When all are run; 0 = the default. */
    double seconds;        /**< likewise, of one measurement       */
};

conus_status bench_batch(struct bench *bench);
conus_status bench_batch_mesh(struct bench *bench);   /**< On surfaces made of the atlas. */
conus_status bench_batch_layers(struct bench *bench); /**< All layers.                    */
conus_status bench_python(struct bench *bench);
conus_status bench_accuracy(struct bench *bench);
conus_status bench_bonsai(struct bench *bench);
conus_status bench_clearance(struct bench *bench);
conus_status bench_growth(struct bench *bench);
conus_status bench_layers(struct bench *bench);
conus_status bench_volume(struct bench *bench);
conus_status bench_open(struct bench *bench);
conus_status bench_plan(struct bench *bench);
conus_status bench_together(struct bench *bench);
conus_status bench_startup(struct bench *bench);
conus_status bench_streamlines(struct bench *bench);
conus_status bench_torus(struct bench *bench);
conus_status bench_torus_frame(struct bench *bench);
/* Comparisons with VTK; in a build without VTK they are left out. */
conus_status bench_peers_mesh(struct bench *bench);
conus_status bench_peers_pick(struct bench *bench);
conus_status bench_peers_colour(struct bench *bench);

/* The volume of the paper's second experiment, or a similar one. */

/** Grey value at which wood, leaves and pot begin: below it are air and noise. */
enum { BONSAI_EDGE = 256, BONSAI_AIR = 28 };

struct bonsai {
    size_t edge; /**< Voxels along each axis, each a mm wide. */
    uint8_t *voxels;
    bool is_papers; /**< The bytes that everyone has, by their SHA-256; else a stand-in. */
};

/** Reads the 256^3 bytes of the paper's volume from a file of just these, or of any format that a context may have.
 * CONUS_ERROR_DATA, naming both checksums, if the bytes are others. */
conus_status bonsai_read(struct bonsai *out, const char *path);

/** Makes a stand-in with @p edge voxels along each axis: a pot of soil, a trunk with branches, clouds of leaves. */
conus_status bonsai_make(struct bonsai *out, size_t edge);

void bonsai_finish(struct bonsai *bonsai);

/** A grid with its middle at @p centre: of a context, or of a pathway from @p threshold on if that is not 0. */
void bonsai_info(conus_volume_info *out, const struct bonsai *bonsai, const double centre[3], double threshold);

/** A copy of the values. NULL without memory. */
float *bonsai_values(const struct bonsai *bonsai);

/* The programs of conus, run as separate processes, and poses for them. */

/** The folder of conus-bench itself, without a slash at its end; "." if the system does not say. */
void program_folder(char *out, size_t size);

/** Path of @p program: the value of the environment variable @p given, else beside conus-bench, else where the build
 * puts it. CONUS_ERROR_ARGUMENT if there is none. */
conus_status program_find(char *out, size_t size, const char *program, const char *given);

/** Runs @p arguments, the first of which is the path, without its output. CONUS_ERROR_ARGUMENT if it fails. */
conus_status program_run(char *const arguments[]);

/** Writes a table of @p count random poses round a grid to @p path: x y z tx ty tz, seen under @p angle_deg. */
conus_status program_write_poses(const char *path, size_t count, const conus_volume_info *info, double angle_deg);

#endif
