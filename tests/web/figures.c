/* SPDX-License-Identifier: BSD-3-Clause */
/* figures ATLAS SIDE: the times of this machine's conus, to compare with the page's. Its input has 7 doubles for each
 * question: origin, toward, angle. Prints microseconds for a cone by the plain kernel, and milliseconds for three cuts
 * of SIDE x SIDE pixels through the target, medians of all questions. Without questions it draws the three cuts of
 * README.md's question, as a page does that has just been opened. */
#include <conus/own.h>

#include "selection/engine/voxels/traverse.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The linker puts this in place of traverse_best_kernel(): it returns the kernel from which WebAssembly's is
 * compiled. */
const struct traverse_kernel *__wrap_traverse_best_kernel(void);
const struct traverse_kernel *__wrap_traverse_best_kernel(void)
{
    size_t i = 0;
    while (strcmp(traverse_kernel(i)->name, "sse2") != 0 && strcmp(traverse_kernel(i)->name, "vector") != 0) {
        i++;
    }
    return traverse_kernel(i);
}

static void need(conus_status status)
{
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
        exit(1);
    }
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static conus_selection *ask(conus_selector *selector, const double question[7])
{
    conus_pose pose;
    conus_selection *selection = NULL;
    need(conus_pose_toward(&pose, question, question + 3, NULL));
    need(conus_select(&selection, selector, &pose, question[6]));
    return selection;
}

static void draw(conus_cutter *const cutters[3], const double centre[3], uint32_t side,
                 const conus_selection *selection)
{
    static const int axes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < 3; i++) {
        conus_cut_view view = CONUS_CUT_VIEW_INIT;
        memcpy(view.centre, centre, sizeof view.centre);
        view.right[axes[i][0]] = 1;
        view.up[axes[i][1]] = 1;
        view.width = view.height = side;
        view.mm_per_pixel = 225.0 / side;
        view.fill = 0.55;
        view.selection = selection;
        need(conus_cutter_draw(cutters[i], &view));
    }
}

static int is_later(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    static const double first[7] = {-90, 20, 20, 0, -10, 10, 20};
    static double cones[100000], cuts[100000];
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_selector_options options = CONUS_SELECTOR_OPTIONS_INIT;
    conus_cutter *cutters[3];
    const uint32_t side = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 400;
    double question[7];
    size_t count = 0;
    need(conus_atlas_load(&atlas, argv[1], NULL));
    options.resolution = 16;
    need(conus_selector_create(&selector, atlas, &options));
    for (int i = 0; i < 3; i++) {
        need(conus_cutter_create(&cutters[i], atlas));
    }
    conus_selection *selection = ask(selector, first);
    draw(cutters, first + 3, side, selection);
    conus_selection_destroy(selection);
    for (; count < 100000 && fread(question, sizeof *question, 7, stdin) == 7; count++) {
        double begun = seconds();
        selection = ask(selector, question);
        double asked = seconds();
        draw(cutters, question + 3, side, selection);
        cuts[count] = seconds() - asked;
        cones[count] = asked - begun;
        conus_selection_destroy(selection);
    }
    if (count) {
        qsort(cones, count, sizeof *cones, is_later);
        qsort(cuts, count, sizeof *cuts, is_later);
        printf("%.3f %.4f\n", 1e6 * cones[count / 2], 1e3 * cuts[count / 2]);
    }
    return 0;
}
