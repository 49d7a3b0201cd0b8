/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * cuts ATLAS [CONTEXT]: a cut with a cone for each line of its input, 17 numbers: origin, toward, angle, right, up,
 * centre, width, height, mm_per_pixel, fill, chosen. Prints RGBA and objects of all pixels, as the machine has them.
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
    double o[3];
    double t[3];
    double angle = 0;
    int right = 0;
    int up = 0;
    need(conus_atlas_load(&atlas, argv[1], NULL));
    if (argc > 2) {
        need(conus_atlas_set_context(atlas, argv[2], NULL));
    }
    options.resolution = 16;
    need(conus_selector_create(&selector, atlas, &options));
    while (scanf("%lf %lf %lf %lf %lf %lf %lf %d %d %lf %lf %lf %u %u %lf %lf %u", &o[0], &o[1], &o[2], &t[0], &t[1],
                 &t[2], &angle, &right, &up, &view.centre[0], &view.centre[1], &view.centre[2], &view.width,
                 &view.height, &view.mm_per_pixel, &view.fill, &view.chosen) == 17) {
        const size_t pixels = (size_t)view.width * view.height;
        uint8_t *rgba = malloc(4 * pixels);
        uint32_t *objects = malloc(4 * pixels);
        conus_pose pose;
        conus_selection *selection = NULL;
        need(conus_pose_toward(&pose, o, t, NULL));
        need(conus_select(&selection, selector, &pose, angle * 3.14159265358979323846 / 180));
        for (int a = 0; a < 3; a++) {
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
