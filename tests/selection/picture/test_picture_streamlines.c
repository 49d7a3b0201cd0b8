/* SPDX-License-Identifier: BSD-3-Clause */
/* In a picture with a cone the streamlines in the cone stand out; without a cone all do. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/picture.h"
#include "render/image/image.h"
#include "test.h"
#include "test_gl.h"
#include "tract_scene.h"

#include <string.h>

enum { SIZE = 120 };

/* Two along z, of one bundle: at y = -15 and at y = 15, where the upper ends lie `aside`. */
static conus_atlas *two_streamlines(double radius, float aside)
{
    const float points[] = {0, -15, -20, 0, -15 + aside, 20, 0, 15, -20, 0, 15 + aside, 20};
    static const uint64_t first[] = {0, 2, 4};
    struct tractogram made = tract_of("two", points, first, 2, radius);
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &made, "two"));
    memcpy(atlas->objects[0].rgb, (const uint8_t[]){255, 0, 0}, 3);
    return atlas;
}

/* How much more red than blue light the half of the picture has: a full tube gives much, a pale one little. */
static double redness(const conus_image *image, bool right)
{
    const struct image_rgba planes = image_rgba(image);
    double sum = 0;
    for (size_t i = 0; i < (size_t)SIZE * SIZE; i++) {
        if ((i % SIZE >= SIZE / 2) == right) {
            sum += (double)planes.plane[0][i] - (double)planes.plane[2][i];
        }
    }
    return sum;
}

/* From the right of the head, so that anterior, +y, is on the right of the picture. The cone is made transparent, since
 * only streamlines may be red. */
static void draw(double out[2], conus_renderer *renderer, const conus_selection *selection)
{
    conus_image *image = NULL;
    const conus_view view = {.width = SIZE,
                             .height = SIZE,
                             .selection = selection,
                             .side = CONUS_SIDE_RIGHT,
                             .legend = CONUS_LEGEND_NONE,
                             .background = CONUS_BACKGROUND_TRANSPARENT};
    assert_ok(conus_render(&image, renderer, &view));
    out[0] = redness(image, false);
    out[1] = redness(image, true);
    conus_image_destroy(image);
}

static void those_in_the_cone_stand_out(void **state)
{
    (void)state;
    test_need_gl();
    conus_atlas *atlas = two_streamlines(3, 0);
    conus_renderer *renderer = NULL;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    double without[2];
    double with[2];
    assert_ok(conus_renderer_create(&renderer, atlas, NULL));
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_pose_toward(&pose, (double[]){-30, 15, 0}, (double[]){0, 15, 0}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 6));
    draw(without, renderer, NULL);
    draw(with, renderer, selection);
    assert_near(without[0], without[1], 0.1 * without[0]);
    assert_true(with[0] < 0.5 * with[1]);
    draw(with, renderer, NULL); /* and are as before */
    assert_true(with[0] == without[0] && with[1] == without[1]);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

/* Lines of a fortieth of a pixel: in a draft, too, each row has a pixel of each line. */
static void a_draft_has_lines_without_gaps(void **state)
{
    (void)state;
    test_need_gl();
    conus_atlas *atlas = two_streamlines(0.005, 6);
    conus_renderer *renderer = NULL;
    conus_image *image = NULL;
    size_t filled = 0;
    assert_ok(conus_renderer_create(&renderer, atlas, NULL));
    const conus_view view = {.width = SIZE,
                             .height = SIZE,
                             .side = CONUS_SIDE_RIGHT,
                             .no_legend = true,
                             .draft = true,
                             .background = CONUS_BACKGROUND_TRANSPARENT};
    assert_ok(conus_render(&image, renderer, &view));
    const float *alpha = image_rgba(image).plane[3];
    for (size_t half = 0; half < (size_t)2 * SIZE; half++) {
        size_t count = 0;
        for (size_t i = 0; i < SIZE / 2; i++) {
            count += alpha[half * SIZE / 2 + i] > 0;
        }
        bool is_inside = half / 2 >= SIZE / 4 && half / 2 < SIZE * 3 / 4;
        filled += is_inside && count > 0;
        assert_true(count <= 3);
    }
    assert_int_equal(filled, SIZE); /* both of half of the rows */
    conus_image_destroy(image);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(picture_streamlines)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(those_in_the_cone_stand_out),
        cmocka_unit_test(a_draft_has_lines_without_gaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
