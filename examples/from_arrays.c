/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas from numbers in memory, and two threads that ask it: what lies to the left, what to the right? */
#include <conus/conus.h>

#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { X = 40, Y = 30, Z = 30 };

struct question {
    conus_selector *selector;
    double direction[3];
    char answer[80];
};

/* Asks from the middle of the brain. */
static void *ask(void *data)
{
    struct question *question = data;
    const conus_result *best = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    conus_status status = conus_pose_along(&pose, (double[]){0, 0, 0}, question->direction, NULL);
    status = status ? status : conus_select(&selection, question->selector, &pose, 12);
    best = status ? NULL : conus_selection_result(selection, 0);
    snprintf(question->answer, sizeof question->answer, "area %u, first touched at x = %.1f mm",
             best ? best->object : 0, best ? best->contact[0] : 0);
    conus_selection_destroy(selection);
    return NULL;
}

/* Area 1 is a plate on the left, area 2 one on the right. Voxels have 2 mm; the middle of the array is the origin. */
static conus_status make_atlas(conus_atlas **out)
{
    static unsigned char labels[X][Y][Z]; /* k fastest */
    const double world_from_voxel[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -39, -29, -29, 1};
    const conus_label names[] = {{.number = 1, .name = "Left plate"}, {.number = 2, .name = "Right plate"}};
    conus_voxels voxels = CONUS_VOXELS_INIT;
    for (int i = 0; i < X; i++) {
        memset(labels[i], i < 10 ? 1 : i >= 30 ? 2 : 0, sizeof labels[i]);
    }
    voxels.data = labels;
    voxels.type = CONUS_SCALAR_UINT8;
    memcpy(voxels.dim, (size_t[]){X, Y, Z}, sizeof voxels.dim);
    memcpy(voxels.stride, (ptrdiff_t[]){Y * Z, Z, 1}, sizeof voxels.stride);
    memcpy(voxels.world_from_voxel, world_from_voxel, sizeof world_from_voxel);
    return conus_atlas_create(out, &voxels, names, 2, NULL);
}

int main(void)
{
    conus_atlas *atlas = NULL;
    struct question left = {.direction = {-1, 0, 0}}, right = {.direction = {1, 0, 0}};
    pthread_t thread;
    conus_status status = make_atlas(&atlas);
    status = status ? status : conus_selector_create(&left.selector, atlas, NULL);
    status = status ? status : conus_selector_share(&right.selector, left.selector);
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
    } else if (pthread_create(&thread, NULL, ask, &right) == 0) {
        ask(&left);
        pthread_join(thread, NULL);
        printf("left:  %s\nright: %s\n", left.answer, right.answer);
    }
    conus_selector_destroy(right.selector);
    conus_selector_destroy(left.selector);
    conus_atlas_destroy(atlas);
    return status != CONUS_OK;
}
