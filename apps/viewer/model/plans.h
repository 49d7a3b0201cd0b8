/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The plan of the window: constraints that the first tool is held against wherever it is, and the candidates of
 * a file, which are tried on a thread of their own. Its atlas is the first one. */
#ifndef CONUS_VIEWER_MODEL_PLANS_H
#define CONUS_VIEWER_MODEL_PLANS_H

#include "viewer/model/viewer.h"

#include <jansson.h>

/** Takes the constraints of @p arguments, if there are any. The tool then begins with this radius and ends at this
 * depth, mm; 0 = not given. @p poses has the candidates; NULL = none. The viewer's frame is set. Returns the exit code
 * and prints an error unless it is 0. */
int plans_open(struct viewer *viewer, const struct arguments *arguments, const char *poses, double depth,
               double radius);

/** Takes the constraints of @p arguments and the candidates of @p poses in place of those before; the tool stays as it
 * is. Likewise; where it fails, the plan does, too. */
int plans_change(struct viewer *viewer, const struct arguments *arguments, const char *poses);

/** The options, as words, that make the object of this name the target, which the needle is to reach; NULL = none. NULL
 * without memory, or where the name is not UTF-8. */
json_t *plans_target(const char *name);
/** @p words with the targets (--reach) of @p targets in place of their own; either may be NULL. NULL without memory. */
json_t *plans_put_targets(const json_t *words, const json_t *targets);
bool plans_targets_are_same(const json_t *a, const json_t *b);
/** Whether an object of the first atlas is by itself what the needle is to reach. */
bool plans_is_target(const struct viewer *viewer, uint32_t object);

/** The objects of the drawn atlas that are, or are below, what the needle is to reach (@p kind) or to avoid, [objects +
 * 1], to be freed; NULL: there are none, or no memory. */
bool *plans_structure(struct viewer *viewer, conus_constraint_kind kind);
/** How the first of these structures is called: "Thalamus_L, Putamen_L"; NULL without one. */
const char *plans_name(struct viewer *viewer, conus_constraint_kind kind);

/** Whether there is a plan. */
bool plans_is_on(const struct viewer *viewer);
/** The verdict of the constraints on the first tool as it is now. Costs nothing where it has not changed. */
const struct plan_verdict *plans_verdict(struct viewer *viewer);
/** That in one line. A tracked tool that is held is elsewhere than its device, which the line then says. */
void plans_line(char out[PLAN_LINE], struct viewer *viewer, bool with_leeway);

/** Whether the first tool is a needle that the answer is about: that it reaches, or is clear of, something. */
bool plans_has_needle(struct viewer *viewer);
/** Keeps that needle in the list of pins, by its verdict, with both ends. */
void plans_keep(struct viewer *viewer);

enum { PLAN_NUMBER = 32 };
/** How lists and sentences print a leeway or clearance: never better than it is, so rounded down; "-" where there is
 * none. */
const char *plans_number(char out[PLAN_NUMBER], double value);

/** Asks for the list, and takes it once it is there. To be called whenever something may have changed. */
void plans_step(struct viewer *viewer);
/** The list, or why there is none: NULL, and @p why says so, "" without a file of candidates. */
const struct plan_list *plans_list(const struct viewer *viewer, const char **why);
/** Whether the list is still to come, or to come anew. */
bool plans_is_behind(const struct viewer *viewer);
/** Index of the row where the first tool is; SIZE_MAX = none. */
size_t plans_at(const struct viewer *viewer);
/** Moves the first tool to a row and holds it there; the cuts go through its tip. False: it was said why not. */
bool plans_go(struct viewer *viewer, size_t row);

#endif
