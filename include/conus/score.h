/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file score.h
 * The rankings that a selector knows (Eq. 12).
 */
#ifndef CONUS_PUBLIC_SCORE_H
#define CONUS_PUBLIC_SCORE_H

#include <conus/status.h>

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A ranking. */
typedef struct conus_score_info {
    const char *name;        /**< For conus_selector_options.score. */
    const char *description; /**< One line. */
    bool needs_history;      /**< Only a conus_tracker has it. */
    bool needs_layers;       /**< Only with CONUS_LAYERS_ALL. */
} conus_score_info;

/**
 * Gives entry @p index of the table of rankings.
 * @param index From 0.
 * @return NULL past the last. Static.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const conus_score_info *conus_score(size_t index);

/**
 * Gives what a ranking needs: a name, or a formula of names, numbers, + - * /, a minus in front and parentheses, as
 * "0.5*share + 0.5*centre". Where a name has no value, or a divisor is 0, the formula has none: such objects rank last.
 * @param[out] out Its name is @p score, "share" for NULL, and is borrowed from the caller.
 * @param score NULL = "share".
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a wrong formula; the message says what is wrong with it.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_score_parse(conus_score_info *out, const char *score);

#ifdef __cplusplus
}
#endif

#endif
