/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Weights of rays: how much each direction counts (Eq. 30), and the prior of what is meant (Eq. 32). */
#ifndef CONUS_SELECTION_WEIGHT_WEIGHT_H
#define CONUS_SELECTION_WEIGHT_WEIGHT_H

#include "base/text.h"
#include "conus/selection.h"
#include "conus/study.h"
#include "poses/rows/columns.h"
#include "selection/cone/cone.h"

/** What a weight depends on. */
enum weight_by { WEIGHT_BY_NOTHING, WEIGHT_BY_ANGLE, WEIGHT_BY_OFFSET };

/** What of a weight reports have. */
struct weight_facts {
    const char *form;       /**< "hard", "gauss" or "table". */
    enum weight_by by;      /**< Degrees off the axis, or mm. */
    double sigma;           /**< Of gauss, degrees; 0 of another. */
    conus_pose_error error; /**< Of gauss, by whose name it was given; else its name is NULL. */
    double bias[2];         /**< To the right and up, degrees. */
    double own;  /**< Opening in degrees, or radius in mm, of the region outside of which it is 0; 0 = none. */
    size_t rows; /**< Of a table. */
};

struct conus_weight {
    struct weight_facts facts;
    double (*value)(const conus_weight *weight, double x);
    double *at, *values; /**< [rows] Ascending. */
};

/** Turns the frame of a device that points off by the bias to where what is meant lies. */
void weight_turn(conus_pose *pose, const conus_weight *weight);

/** w W of each pixel (Eq. 31), kept from one query to the next. A zeroed one is ready. */
struct soft {
    uint32_t resolution;
    conus_aperture shape;
    double angle;
    double *pixels; /**< [n*n] In units of 2^-32 of a power of two, above 16 x 16 pixels, so sums are exact. */
    uint8_t *sides; /**< [n*n] Which pixels beside it are in the cone, too: left 1, right 2, below 4, above 8. */
    double total;   /**< Sum over the pixels in the cone, in the pixels' order. */
};

/** Makes it that of a cone, whose aperture is prepared. That takes time only where the last one had another shape. */
conus_status soft_prepare(struct soft *soft, const conus_weight *weight, const struct aperture *aperture,
                          const struct cone *cone);
void soft_finish(struct soft *soft);

/** What is meant, before the pose is known. */
struct prior {
    bool by_size;  /**< Each direction is meant as often, not each object. */
    bool of_file;  /**< `times` is that of a file. */
    double power;  /**< The exponent of likelihoods. */
    double *times; /**< [object_count + 1] How many times as often as others each object is meant; NULL = once. */
};

/** Reads equal|size|FILE[,power=G]; NULL is equal. @p group: as what each object is reported; NULL = itself. */
conus_status prior_read(struct prior *out, const char *text, const conus_atlas *atlas, const uint32_t *group);
void prior_finish(struct prior *prior);

/** Whether something is reported as @p object, and not as another one at this level, or as areas below it in the area
 * tree. */
bool prior_has_row(const conus_atlas *atlas, const uint32_t *group, uint32_t object);

/** Sets the posterior of the results of a cone, in which weights are set. */
void prior_apply(conus_result *results, size_t count, const struct prior *prior, const struct cone *cone);

/* Small tables of named columns. */

/** Takes a row of a table. */
typedef void rows_take(struct job *job, const struct named_cells *cells, void *user);

/** Reads a file of at most 64 MiB: a header with some of @p count column names, and no others, and rows. */
conus_status rows_read(const char *path, const char *const *names, size_t count, rows_take *take, void *user);

#endif
