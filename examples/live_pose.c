/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses that come one by one on standard input, as a table whose header names the columns (docs/formats.md): what does
 * the cone of each hit, how far away, and how long did the answer take? One selector answers them all. A cone opens by
 * 10 degrees where there is no column "angle":
 *
 *     printf 'x\ty\tz\ttx\tty\ttz\n-90\t20\t20\t0\t-10\t10\n' | live_pose aal.nii.gz
 */
#define _POSIX_C_SOURCE 199309L

#include <conus/conus.h>

#include <stdio.h>
#include <time.h>

static const double default_angle = 10;

static double now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static void print_answer(const conus_atlas *atlas, const conus_selection *selection, double took_ms)
{
    const conus_result *best = conus_selection_result(selection, 0);
    const conus_object *object = conus_atlas_object(atlas, best->object);
    if (object) {
        printf("%s at %.1f mm, %.3f ms\n", object->name, best->distance, took_ms);
    } else {
        printf("nothing, %.3f ms\n", took_ms);
    }
    fflush(stdout); /* whoever reads waits for it */
}

/* A row that is no pose has no answer, and the next one is awaited. */
static void answer(conus_selector *selector, const conus_atlas *atlas, const conus_pose_row *row)
{
    conus_selection *selection = NULL;
    if (row->error || row->is_point) {
        fprintf(stderr, "line %zu: %s\n", row->line, row->error ? row->error : "a point has no direction");
        return;
    }
    double begun_ms = now_ms();
    conus_status status = conus_select(&selection, selector, &row->pose, row->angle > 0 ? row->angle : default_angle);
    double took_ms = now_ms() - begun_ms;
    if (status) {
        fprintf(stderr, "line %zu: %s\n", row->line, conus_message());
    } else {
        print_answer(atlas, selection, took_ms);
    }
    conus_selection_destroy(selection);
}

int main(int argc, char **argv)
{
    const char *path = argc > 1 ? argv[1] : "data-samples/u-shape.nii.gz";
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_pose_stream *poses = NULL;
    conus_pose_row row;
    size_t count = 1;

    conus_status status = conus_atlas_load(&atlas, path, NULL);
    status = status ? status : conus_selector_create(&selector, atlas, NULL);
    status = status ? status : conus_pose_stream_open(&poses, "-", NULL);
    while (!status && count) { /* one at a time, as they come */
        status = conus_pose_stream_read(&row, &count, poses, 1);
        if (!status && count) {
            answer(selector, atlas, &row);
        }
    }
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
    }
    conus_pose_stream_destroy(poses);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return status ? 1 : 0;
}
