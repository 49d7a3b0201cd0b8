/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file conus.h
 * All public headers. Load an atlas, aim a cone at it from a pose with six degrees of freedom, and read off the areas
 * and pathways in the cone, with shares and contact positions:
 *
 *     conus_atlas *atlas = NULL;
 *     conus_selector *selector = NULL;
 *     conus_selection *selection = NULL;
 *     conus_pose pose;
 *     conus_status status = conus_atlas_load(&atlas, "aal.nii.gz", NULL);
 *     if (!status) status = conus_selector_create(&selector, atlas, NULL);
 *     if (!status) status = conus_pose_toward(&pose, (double[]){-90, 20, 20}, (double[]){0, -10, 10}, NULL);
 *     if (!status) status = conus_select(&selection, selector, &pose, 20);
 *     for (size_t i = 0; i < conus_selection_count(selection); i++) ...
 *     if (status) fprintf(stderr, "%s\n", conus_message());
 *     conus_selection_destroy(selection); conus_selector_destroy(selector); conus_atlas_destroy(atlas);
 *
 * These conventions hold for every function; exceptions are stated where they occur. docs/api.md has the reasons.
 *
 *  - Space: world is right-handed RAS+: +x right, +y anterior, +z superior, in mm. Angles are in degrees.
 *  - Matrices: column-major double[16], column vectors, last row 0 0 0 1. `a_from_b` maps b coordinates to a.
 *  - Errors: a function that can fail returns conus_status. On failure its outputs are untouched, and conus_message()
 *    says in one line what was found and what is allowed. Every such function may also return #CONUS_ERROR_MEMORY.
 *  - Ownership: `conus_x **out` is the caller's: end it with conus_x_destroy(), which accepts NULL. A returned
 *    `const T *` is borrowed: it lives as long as the object that it came from.
 *  - Options: a zeroed struct is the default; NULL means the same.
 *  - Counting: accessors of a NULL object count 0. Indices count from 0. Objects of an atlas have numbers from 1; 0 is
 *    "nothing".
 *  - Shapes: [n m] is n rows of m numbers each, one row after the other.
 *  - Threads: any thread may call any function. An object that a function takes as `T *` is used by one thread at a
 *    time; one that it takes as `const T *` by any number of threads, while none changes it. One thread at a time uses
 *    selectors, trackers, streams of poses, counts of poses and reports, in every function; only the thread that made
 *    a renderer uses it. The paragraph "Threads" of a function says where it is otherwise.
 *  - Since: all is there since version 0.1, where a description says no other.
 */
#ifndef CONUS_PUBLIC_CONUS_H
#define CONUS_PUBLIC_CONUS_H

#include <conus/arrays.h>
#include <conus/atlas.h>
#include <conus/image.h>
#include <conus/picture.h>
#include <conus/plan.h>
#include <conus/pose.h>
#include <conus/report.h>
#include <conus/selection.h>
#include <conus/space.h>
#include <conus/status.h>
#include <conus/streamlines.h>
#include <conus/study.h>
#include <conus/table.h>
#include <conus/version.h>

#endif
