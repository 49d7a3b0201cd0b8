/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * cuts ATLAS [CONTEXT]: a cut of what a cone hits for each 16 doubles of its input: origin, toward, angle, right, up,
 * centre, width, height, mm_per_pixel, fill. Prints RGBA and objects of all pixels, as the machine has them.
 */
#include <conus/conus.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void need(conus_status status)
{
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
        exit(1);
    }
}

int main(int argc, char **argv)
{
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_cut_view view = CONUS_CUT_VIEW_INIT;
    conus_selector_options options = CONUS_SELECTOR_OPTIONS_INIT;
    double given[16];
    need(conus_atlas_load(&atlas, argv[1], NULL));
    if (argc > 2) {
        need(conus_atlas_set_context(atlas, argv[2], NULL));
    }
    view.no_cone = true; /* the page draws it over them */
    options.resolution = 16;
    need(conus_selector_create(&selector, atlas, &options));
    while (fread(given, sizeof *given, 16, stdin) == 16) {
        const int right = (int)given[7];
        const int up = (int)given[8];
        view.width = (uint32_t)given[12];
        view.height = (uint32_t)given[13];
        view.mm_per_pixel = given[14];
        view.fill = given[15];
        const size_t pixels = (size_t)view.width * view.height;
        uint8_t *rgba = malloc(4 * pixels);
        uint32_t *objects = malloc(4 * pixels);
        conus_pose pose;
        conus_selection *selection = NULL;
        need(conus_pose_toward(&pose, given, given + 3, NULL));
        need(conus_select(&selection, selector, &pose, given[6]));
        for (int a = 0; a < 3; a++) {
            view.centre[a] = given[9 + a];
            view.right[a] = a == right;
            view.up[a] = a == up;
        }
        view.selection = selection;
        need(conus_cut(rgba, objects, atlas, &view));
        fwrite(rgba, 4, pixels, stdout);
        fwrite(objects, 4, pixels, stdout);
        conus_selection_destroy(selection);
        free(rgba);
        free(objects);
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return 0;
}
