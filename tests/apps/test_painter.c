/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures of a moving view: drawn with fewer pixels, and yet without steps at edges; and when a late one says so. */
#include "viewer/pictures/pictures.h"
#include "viewer/window/window.h"

#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PANE = 600, DISC = 100 };

/* The error of an edge that is known to a whole pixel only is up to half a pixel, and 1 / sqrt(12) in the root mean
 * square. */
static const double rough = 0.2887, smooth = 0.8 * 0.2887;

/* Green at a place of the pane when a picture of `size` x `size` pixels is drawn as a texture with linear filtering. */
static double green_at(const uint8_t *rgba, long size, long column, long row)
{
    double place[2] = {((double)column + 0.5) * (double)size / PANE - 0.5,
                       ((double)row + 0.5) * (double)size / PANE - 0.5};
    double sum = 0;
    for (int n = 0; n < 4; n++) {
        long at[2];
        double weight = 1;
        for (int a = 0; a < 2; a++) {
            long first = (long)floor(place[a]);
            bool second = n >> a & 1;
            double part = place[a] - (double)first;
            weight *= second ? part : 1 - part;
            at[a] = first + second < 0 ? 0 : first + second < size ? first + second : size - 1;
        }
        sum += weight * rgba[4 * (at[1] * size + at[0]) + 1];
    }
    return sum;
}

/* Position, in pixels of the pane, at which a row that begins dark has half of the light that it has 16 pixels inside
 * the edge. */
static double edge_of(const uint8_t *rgba, long size, long row)
{
    long column = 0;
    while (column < PANE - 16 && green_at(rgba, size, column, row) < 20) {
        column++;
    }
    double half = green_at(rgba, size, column + 16, row) / 2;
    while (column > 0 && green_at(rgba, size, column, row) >= half) {
        column--;
    }
    while (green_at(rgba, size, column + 1, row) < half) {
        column++;
    }
    double before = green_at(rgba, size, column, row);
    return (double)column + (half - before) / (green_at(rgba, size, column + 1, row) - before);
}

/* A disc whose pixels are light where their centres are in it. */
static void draw_disc(uint8_t rgba[4 * DISC * DISC], double radius)
{
    memset(rgba, 0, (size_t)4 * DISC * DISC);
    for (size_t i = 0; i < (size_t)DISC * DISC; i++) {
        size_t row = i / DISC;
        double x = (double)(i % DISC) + 0.5 - 50.23;
        double y = (double)row + 0.5 - 49.69;
        memset(rgba + 4 * i, hypot(x, y) < radius ? 200 : 0, 3);
        rgba[4 * i + 3] = 255;
    }
}

/* Error of the disc's left edge (root mean square), pixels of the picture. */
static double disc_error(const uint8_t *rgba, double radius)
{
    const double enlarged = (double)PANE / DISC;
    double squares = 0;
    size_t count = 0;
    for (long row = 0; row < PANE; row++) {
        double y = ((double)row + 0.5) / enlarged - 49.69;
        if (fabs(y) < 0.9 * radius) {
            double edge = (edge_of(rgba, DISC, row) + 0.5) / enlarged;
            double error = edge - (50.23 - sqrt(radius * radius - y * y));
            squares += error * error;
            count++;
        }
    }
    return sqrt(squares / (double)count);
}

static void edges_have_no_steps(void **state)
{
    static uint8_t rgba[4 * DISC * DISC];
    (void)state;
    for (int n = 0; n < 4; n++) {
        double radius = 21.3 + 5.9 * n;
        draw_disc(rgba, radius);
        assert_near(disc_error(rgba, radius), rough, 0.2 * rough);
        edges_smooth(rgba, DISC, DISC);
        assert_true(disc_error(rgba, radius) < smooth);
    }
}

/* The mean along an edge is the pixel itself where all pixels along the edge are the same. */
static void straight_edges_and_planes_stay(void **state)
{
    enum { SIDE = 16 };
    uint8_t before[4 * SIDE * SIDE];
    uint8_t after[sizeof before];
    (void)state;
    for (int turn = 0; turn < 3; turn++) {
        for (size_t i = 0; i < sizeof before; i++) {
            size_t place = turn == 0 ? i / 4 % SIDE : i / 4 / SIDE;
            before[i] = (uint8_t)(turn == 2 ? 10 * (i % 4) : place < 7 ? 30 * (i % 4) : 200);
        }
        memcpy(after, before, sizeof after);
        edges_smooth(after, SIDE, SIDE);
        assert_memory_equal(after, before, sizeof after);
    }
    edges_smooth(after, 1, 1);
    assert_memory_equal(after, before, sizeof after);
}

/* The next picture that is new; with @p fine the next one at full resolution. */
static struct painted next_picture(struct painter *painter, bool fine)
{
    struct painted picture = {0};
    char error[PAINTER_TEXT];
    while (!picture.rgba || picture.fine < fine) {
        free(picture.rgba);
        picture.rgba = NULL;
        assert_false(painter_text(error, painter, PAINTER_ERROR));
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
        painter_take(painter, &picture);
    }
    return picture;
}

/* A ball before black, while the view turns and when it rests. */
static void a_moving_view_has_no_steps(void **state)
{
    struct orbit orbit;
    struct appearance appearance;
    struct painter *painter = NULL;
    conus_atlas *atlas = NULL;
    double squares = 0;
    size_t count = 0;
    (void)state;
    test_folder("phantom");
    assert_ok(conus_phantom_write("sphere", test_in(""), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("sphere.nii.gz"), NULL));
    assert_true(appearance_init(&appearance, 1));
    assert_true(painter_create(&painter, atlas, NULL, &appearance, NULL, NULL));
    orbit_look_at(&orbit, (double[]){0, 0, 0}, 25);
    struct painting what = {.width = PANE, .height = PANE, .backdrop = BACKDROP_BLACK, .moving = true};
    eye_of_orbit(&what.eye, &orbit, (double[]){PANE, PANE});
    painter_ask(painter, &what);
    struct painted moving = next_picture(painter, false);
    what.moving = false;
    painter_ask(painter, &what);
    struct painted still = next_picture(painter, true);
    assert_int_equal(still.width, PANE);
    double pixel = (double)PANE / moving.width; /* of the picture, on the pane */
    for (long row = PANE / 2 - 200; row < PANE / 2 + 200; row++) {
        double error = edge_of(moving.rgba, moving.width, row) - edge_of(still.rgba, PANE, row);
        squares += error * error;
        count++;
    }
    double error = sqrt(squares / (double)count) / pixel;
    free(moving.rgba);
    free(still.rgba);
    painter_destroy(painter);
    appearance_finish(&appearance);
    conus_atlas_destroy(atlas);
    if (pixel > 1) {                 /* else a GPU draws it whole */
        assert_near(pixel, 3, 1e-9); /* sqrt(0.0015 ms * 600 * 600 / 60 ms) */
        assert_true(error < smooth);
    }
}

static void count_note(void *user, const conus_note *note)
{
    (void)user, (void)note;
}

/* A driver that has too old an OpenGL: the rays draw, and the thread notes that. */
static void the_window_hears_what_the_thread_notes(void **state)
{
    struct appearance appearance;
    struct painter *painter = NULL;
    conus_atlas *atlas = NULL;
    char note[PAINTER_TEXT];
    (void)state;
    test_folder("phantom");
    assert_ok(conus_phantom_write("sphere", test_in(""), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("sphere.nii.gz"), NULL));
    assert_true(appearance_init(&appearance, 1));
    setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
    assert_true(painter_create(&painter, atlas, NULL, &appearance, count_note, NULL));
    while (!painter_text(note, painter, PAINTER_DEVICE)) {
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    unsetenv("MESA_GL_VERSION_OVERRIDE");
    if (strstr(note, "rays") || strstr(note, "CPU")) { /* another driver than Mesa's has no such override */
        assert_true(painter_text(note, painter, PAINTER_NOTE));
        assert_non_null(strstr(note, "no OpenGL 4.5 core context"));
    }
    assert_false(painter_text(note, painter, PAINTER_ERROR));
    painter_destroy(painter);
    appearance_finish(&appearance);
    conus_atlas_destroy(atlas);
}

/* A picture of another answer, plan or scene than was asked for says so once that has lasted, also while ever newer
 * ones are asked for; one that comes, even if it is late again, has its own time. Where there is none nothing is late.
 */
static void a_late_picture_says_so(void **state)
{
    static const size_t numbers[] = {offsetof(struct painting, answer_number), offsetof(struct painting, plan_number),
                                     offsetof(struct painting, scene_number)};
    (void)state;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct pictures pictures = {.painted.name = 1};
        unsigned *asked = (unsigned *)(void *)((char *)&pictures.asked + numbers[i]);
        unsigned *drawn = (unsigned *)(void *)((char *)&pictures.drawn + numbers[i]);
        pictures_note_late(&pictures, 1000);
        assert_true(pictures.late_at == 0 && !pictures.says_late);
        for (int now = 2000; now < 2000 + PICTURE_LATE_MS; now += 50) {
            ++*asked;
            pictures_note_late(&pictures, now);
            assert_false(pictures.says_late);
        }
        pictures_note_late(&pictures, 2000 + PICTURE_LATE_MS);
        assert_true(pictures.says_late);
        *drawn = *asked - 1; /* one of an answer before comes */
        pictures.late_at = 0;
        pictures_note_late(&pictures, 3000);
        assert_false(pictures.says_late);
        pictures_note_late(&pictures, 3000 + PICTURE_LATE_MS);
        assert_true(pictures.says_late);
        *drawn = *asked;
        pictures_note_late(&pictures, 3001 + PICTURE_LATE_MS);
        assert_true(pictures.late_at == 0 && !pictures.says_late);
        ++*asked;
        pictures.painted.name = 0;
        pictures_note_late(&pictures, 4000);
        pictures_note_late(&pictures, 5000);
        assert_false(pictures.says_late);
    }
}

TEST_GROUP(painter)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_have_no_steps),
        cmocka_unit_test(straight_edges_and_planes_stay),
        cmocka_unit_test(a_moving_view_has_no_steps),
        cmocka_unit_test(a_late_picture_says_so),
        cmocka_unit_test(the_window_hears_what_the_thread_notes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
