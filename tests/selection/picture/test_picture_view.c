/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures of the view against golden ones. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "golden_picture.h"
#include "made_atlas.h"
#include "picture_scene.h"
#include "render/colour/colour.h"
#include "render/image/image.h"
#include "test.h"
#include "test_gl.h"
#include "value_maps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

struct fixture {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
    conus_renderer *renderer;
};

static double nothing(const double p[3])
{
    (void)p;
    return 0;
}

static double ball(const double p[3])
{
    return vec3_length(p) < 20;
}

/* Selects in `atlas` from the left with a cone of 20 degrees; skips the test if there is no GL. */
static struct fixture make_fixture(conus_atlas *atlas, const double origin[3])
{
    test_need_gl();
    struct fixture fixture = {.atlas = atlas};
    conus_pose pose;
    assert_ok(conus_selector_create(&fixture.selector, atlas, &(conus_selector_options){.resolution = 16}));
    assert_ok(conus_pose_toward(&pose, origin, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&fixture.selection, fixture.selector, &pose, 20));
    assert_ok(conus_renderer_create(&fixture.renderer, atlas, NULL));
    return fixture;
}

static struct fixture ball_fixture(void)
{
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, identity);
    return make_fixture(picture_atlas(&grid, ball, NULL, NULL), (double[]){-60, 0, 0});
}

static void finish(struct fixture *fixture)
{
    conus_renderer_destroy(fixture->renderer);
    conus_selection_destroy(fixture->selection);
    conus_selector_destroy(fixture->selector);
    conus_atlas_destroy(fixture->atlas);
}

static double difference(const conus_image *a, const conus_image *b)
{
    conus_image_difference result;
    assert_ok(conus_image_compare(&result, a, b, 0));
    return result.rms;
}

static conus_image *render(struct fixture *fixture, conus_view view)
{
    view.width = view.width ? view.width : 160;
    view.height = view.height ? view.height : 120;
    conus_image *image = NULL;
    assert_ok(conus_render(&image, fixture->renderer, &view));
    return image;
}

static void pictures_have_their_size_and_are_opaque(void **state)
{
    (void)state;
    struct fixture fixture = ball_fixture();
    conus_image *image = NULL;
    assert_ok(conus_render(&image, fixture.renderer, NULL));
    assert_int_equal(conus_image_width(image), 1400);
    assert_int_equal(conus_image_height(image), 1050);
    const float *alpha = conus_image_floats(image, "A");
    const float *red = conus_image_floats(image, "R");
    for (size_t i = 0; i < (size_t)1400 * 1050; i++) {
        assert_true(alpha[i] == 1 && red[i] >= 0 && red[i] < 2);
    }
    assert_non_null(image_find_attribute(image, "conus:worldFromCamera"));
    assert_string_equal(image_find_attribute(image, "conus:atlas")->text, "scene.nii");
    conus_image_destroy(image);
    assert_non_null(strstr(conus_renderer_device(fixture.renderer), " "));
    finish(&fixture);
}

static void options_show_in_the_picture(void **state)
{
    (void)state;
    struct fixture fixture = ball_fixture();
    conus_pose camera;
    assert_ok(conus_pose_toward(&camera, (double[]){-150, 0, 0}, (double[]){0, 0, 0}, NULL));
    conus_image *plain = render(&fixture, (conus_view){.no_legend = true, .camera = &camera});
    conus_image *cone =
        render(&fixture, (conus_view){.no_legend = true, .camera = &camera, .selection = fixture.selection});
    conus_image *letters =
        render(&fixture, (conus_view){.camera = &camera, .selection = fixture.selection, .legend = CONUS_LEGEND_NONE});
    conus_image *close =
        render(&fixture, (conus_view){.no_legend = true, .camera = &camera, .field_of_view = 0.3 * 180 / MATH3_PI});
    assert_true(difference(plain, cone) > 0);
    assert_true(difference(cone, letters) > 0);
    assert_true(difference(plain, close) > 0);
    conus_image_destroy(plain);
    conus_image_destroy(cone);
    conus_image_destroy(letters);
    conus_image_destroy(close);
    finish(&fixture);
}

/* Its first hit is where it begins, so it ends there: nothing of it is seen beside the area. */
static void a_cone_that_begins_in_an_area_is_not_drawn_through_it(void **state)
{
    (void)state;
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, identity);
    struct fixture fixture = make_fixture(picture_atlas(&grid, ball, NULL, NULL), (double[]){0, 0, 10});
    conus_pose camera;
    assert_ok(conus_pose_toward(&camera, (double[]){-150, 0, 0}, (double[]){0, 0, 0}, NULL));
    conus_image *plain = render(&fixture, (conus_view){.no_legend = true, .camera = &camera});
    conus_image *cone =
        render(&fixture, (conus_view){.no_legend = true, .camera = &camera, .selection = fixture.selection});
    const float *without = conus_image_floats(plain, "B");
    const float *with = conus_image_floats(cone, "B");
    size_t beside = 0;
    for (size_t p = 0; p < (size_t)160 * 120; p++) {
        bool is_background = without[p] == without[p - p % 160];
        assert_true(!is_background || with[p] == without[p]);
        beside += is_background;
    }
    assert_true(beside > 160 * 20 && beside < 160 * 110);
    conus_image_destroy(plain);
    conus_image_destroy(cone);
    finish(&fixture);
}

/* A faraway device, one inside an area, one that misses everything, and an atlas without areas. */
static void odd_scenes_are_pictures(void **state)
{
    (void)state;
    static const double origins[][3] = {{-5000, 10, 3}, {1, 2, 3}, {-60, 0, 0}};
    for (size_t i = 0; i < 3; i++) {
        conus_volume_info grid = picture_grid((size_t[]){40, 41, 42}, (double[]){1, 1, 1}, identity);
        struct fixture fixture = make_fixture(picture_atlas(&grid, i == 2 ? nothing : ball, NULL, NULL), origins[i]);
        conus_image *image = render(&fixture, (conus_view){.selection = fixture.selection});
        const float *green = conus_image_floats(image, "G");
        for (size_t p = 0; p < (size_t)160 * 120; p++) {
            assert_true(isfinite(green[p]));
        }
        conus_image_destroy(image);
        finish(&fixture);
    }
}

static void options_out_of_range_are_refused(void **state)
{
    (void)state;
    struct fixture fixture = ball_fixture();
    const conus_pose bad = {{1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    const conus_view views[] = {{.width = 16385},
                                {.height = 20000},
                                {.field_of_view = -1 * 180 / MATH3_PI},
                                {.field_of_view = NAN},
                                {.field_of_view = 3.2 * 180 / MATH3_PI},
                                {.slices = 65537},
                                {.camera = &bad}};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        conus_image *image = NULL;
        assert_fails(conus_render(&image, fixture.renderer, &views[i]), CONUS_ERROR_ARGUMENT);
        assert_null(image);
    }
    finish(&fixture);
}

static conus_status attempt(void *data)
{
    struct fixture *fixture = data;
    conus_image *image = NULL;
    const conus_view view = {.width = 64, .height = 48, .selection = fixture->selection};
    conus_status status = conus_render(&image, fixture->renderer, &view);
    assert_true((status == CONUS_OK) == (image != NULL));
    conus_image_destroy(image);
    return status;
}

static void allocations_may_fail(void **state)
{
    (void)state;
    struct fixture fixture = ball_fixture();
    test_every_allocation(attempt, &fixture);
    finish(&fixture);
}

static void a_phantom_looks_as_it_did(void **state)
{
    (void)state;
    const conus_phantom_options options = {.size = 48, .oblique = 0.3 * 180 / MATH3_PI};
    struct phantom_drawing drawing = {0};
    conus_atlas *atlas = NULL;
    assert_ok(phantom_draw(&drawing, "u-shape", &options));
    assert_ok(phantom_drawing_atlas(&atlas, &drawing));
    phantom_drawing_finish(&drawing);
    struct fixture fixture = make_fixture(atlas, (double[]){-50, 20, 30});
    conus_image *got = render(&fixture, (conus_view){.selection = fixture.selection, .no_legend = true});
    golden_check(got, "u-shape.png");
    conus_image_destroy(got);
    finish(&fixture);
}

/* A change of the light by two hundredths is noticed, up or down, wherever it is. */
static void a_change_of_brightness_is_seen(void **state)
{
    (void)state;
    conus_image *wanted = NULL;
    assert_ok(conus_image_load(&wanted, CONUS_SOURCE_DIR "/tests/golden/u-shape.png"));
    assert_near(golden_brightness(wanted, wanted), 0, 0);
    for (int part = 0; part < 4; part++) { /* all of it, the left half, the upper half, all but for red */
        conus_image *changed = NULL;
        assert_ok(conus_image_load(&changed, CONUS_SOURCE_DIR "/tests/golden/u-shape.png"));
        for (size_t i = 0; i < (size_t)changed->width * changed->height; i++) {
            bool here = part == 1   ? i % changed->width < changed->width / 2
                        : part == 2 ? i / changed->width < changed->height / 2
                                    : true;
            for (int c = part == 3; here && c < 3; c++) {
                image_rgba(changed).plane[c][i] *= part % 2 ? 0.98F : 1.02F;
            }
        }
        assert_near(golden_brightness(changed, wanted), 0.02, 1e-6);
        conus_image_destroy(changed);
    }
    conus_image_destroy(wanted);
}

static double two_halves(const double p[3])
{
    return vec3_length(p) < 20 ? (p[1] < 0 ? 1 : 2) : 0;
}

/* A picture of the atlas with the selection of a cone from the left. */
static conus_image *draw_level(conus_atlas *atlas, const char *level)
{
    const conus_selector_options options = {.level = level};
    struct fixture fixture = {.atlas = atlas};
    conus_image *image = NULL;
    conus_pose pose;
    assert_ok(conus_selector_create(&fixture.selector, atlas, &options));
    assert_ok(conus_pose_toward(&pose, (double[]){-60, 0, 0}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&fixture.selection, fixture.selector, &pose, 20));
    assert_ok(conus_renderer_create(&fixture.renderer, atlas, NULL));
    const conus_view view = {.width = 200, .height = 150, .selection = fixture.selection};
    assert_ok(conus_render(&image, fixture.renderer, &view));
    finish(&fixture);
    return image;
}

/* Areas that are reported as one have its colour and stand out together, as if their voxels had its label (Eq. 10). */
static void rolled_up_areas_look_like_one(void **state)
{
    (void)state;
    test_need_gl();
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, identity);
    conus_atlas *halves = picture_atlas(&grid, two_halves, NULL, NULL);
    halves->objects[1].parent = 1;
    conus_image *rolled = draw_level(halves, "1");
    conus_image *one = draw_level(picture_atlas(&grid, ball, NULL, NULL), NULL);
    conus_image *two = draw_level(picture_atlas(&grid, two_halves, NULL, NULL), NULL);
    conus_image_difference difference;
    assert_ok(conus_image_compare(&difference, rolled, one, 0));
    assert_int_equal(difference.differing, 0);
    assert_ok(conus_image_compare(&difference, rolled, two, 0));
    assert_true(difference.differing > 1000);
    conus_image_destroy(rolled);
    conus_image_destroy(one);
    conus_image_destroy(two);
}

/* Two balls, at x = -12 and 12. */
static double two_balls(const double p[3])
{
    return hypot(hypot(fabs(p[0]) - 12, p[1]), p[2]) < 8 ? p[0] < 0 ? 1 : 2 : 0;
}

/* A pathway below them, beside which areas are drawn only where the cone hits them. */
static conus_atlas *balls_beside_a_pathway(void)
{
    conus_volume_info grid = picture_grid((size_t[]){50, 50, 50}, (double[]){1, 1, 1}, identity);
    conus_atlas *atlas = picture_atlas(&grid, two_balls, NULL, NULL);
    conus_volume_info info = picture_grid((size_t[]){50, 50, 2}, (double[]){1, 1, 1}, identity);
    float *values = memory_zeroed(values_of(&info), sizeof *values);
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0.5;
    for (size_t v = 0; v < values_of(&info); v++) {
        values[v] = 1;
    }
    assert_ok(pathway_of_values(atlas, &info, values, "tract"));
    return atlas;
}

/* A draft of one answer after the picture of another: the areas beside a pathway are those of the draft's own. */
static void a_draft_has_the_areas_of_its_answer(void **state)
{
    (void)state;
    struct fixture left = make_fixture(balls_beside_a_pathway(), (double[]){-60, 0, 0});
    conus_selection *right = NULL;
    conus_pose pose;
    assert_ok(conus_pose_toward(&pose, (double[]){60, 0, 0}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&right, left.selector, &pose, 20));
    const conus_view whole = {.selection = left.selection, .no_legend = true};
    conus_view draft = {.selection = right, .no_legend = true, .draft = true, .side = CONUS_SIDE_FRONT};
    conus_image_destroy(render(&left, whole));
    conus_image *after_another = render(&left, draft);
    draft.draft = false;
    conus_image_destroy(render(&left, draft));
    draft.draft = true;
    conus_image *after_its_own = render(&left, draft);
    assert_true(difference(after_another, after_its_own) == 0);
    draft.selection = NULL; /* after Escape there is none */
    conus_image *of_none = render(&left, draft);
    assert_true(difference(of_none, after_its_own) > 0.01);
    conus_image_destroy(after_another);
    conus_image_destroy(after_its_own);
    conus_image_destroy(of_none);
    conus_selection_destroy(right);
    finish(&left);
}

static int one_of(uint64_t *random, int count)
{
    return (int)test_random(random, 0, count);
}

/* 500 changes at random, or a fourth of them, as a window has them: another answer or none, drafts, opacities, what is
 * hidden, the colours. Each picture is that of its own view, as a renderer draws it that has drawn nothing before: none
 * is late. */
static void no_picture_is_late(void **state)
{
    enum { CHANGES = 500, OPACITIES = 4 };
    static const double opacities[OPACITIES][4] = {
        {NAN, NAN, NAN, NAN}, {NAN, 0.5, NAN, NAN}, {NAN, NAN, 0, 0.3}, {NAN, 1, 1, 0}};
    static const bool hidden[][4] = {{false}, {false, true}, {false, false, true}, {false, false, false, true}};
    static const double origins[2][3] = {{-60, 0, 0}, {60, 0, 0}};
    const conus_renderer_options rays = {.engine = CONUS_ENGINE_RAYS};
    conus_atlas *atlas = balls_beside_a_pathway();
    conus_selector *selector = NULL;
    conus_selection *answers[3] = {NULL};
    conus_renderer *renderer = NULL;
    uint64_t random = 102;
    size_t late = 0;
    (void)state;
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.resolution = 16}));
    for (int i = 0; i < 2; i++) {
        conus_pose pose;
        assert_ok(conus_pose_toward(&pose, origins[i], (double[]){0, 0, 0}, NULL));
        assert_ok(conus_select(&answers[i], selector, &pose, 20));
    }
    assert_ok(conus_renderer_create(&renderer, atlas, &rays));
    conus_view view = {.width = 48, .height = 36, .no_legend = true};
    int hides = 0;
    for (size_t change = 0; change < test_trials(CHANGES); change++) {
        conus_image *shown = NULL;
        conus_image *own = NULL;
        conus_renderer *fresh = NULL;
        switch (one_of(&random, 8)) {
        case 0:
            view.draft = !view.draft;
            break;
        case 1:
            view.opacity = opacities[one_of(&random, OPACITIES)];
            break;
        case 2:
            hides = one_of(&random, 4);
            break;
        case 3:
            view.own_colours = !view.own_colours;
            break;
        case 4:
            view.no_pale = !view.no_pale;
            break;
        case 5:
            view.side = one_of(&random, 2) ? CONUS_SIDE_FRONT : CONUS_SIDE_LEFT;
            break;
        default:
            view.selection = answers[one_of(&random, 3)];
        }
        assert_ok(conus_atlas_set_hidden(atlas, hidden[hides]));
        assert_ok(conus_renderer_update(renderer));
        assert_ok(conus_renderer_create(&fresh, atlas, &rays));
        assert_ok(conus_render(&shown, renderer, &view));
        assert_ok(conus_render(&own, fresh, &view));
        late += difference(shown, own) > 0;
        conus_image_destroy(shown);
        conus_image_destroy(own);
        conus_renderer_destroy(fresh);
    }
    assert_int_equal(late, 0);
    conus_renderer_destroy(renderer);
    conus_selection_destroy(answers[0]);
    conus_selection_destroy(answers[1]);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* By OpenGL a smooth picture begins with the draft before it, where that shows the same: it is as one that has drawn
 * nothing before gives it, whether the draft was of this view (every second time) or of another. */
static void a_smooth_picture_takes_no_other_draft(void **state)
{
    enum { CHANGES = 24 };
    static const double opacity[4] = {NAN, 0.5, 1, NAN};
    static const bool hidden[2][4] = {{false}, {false, true}};
    const conus_renderer_options gl = {.engine = CONUS_ENGINE_GL};
    conus_atlas *atlas = balls_beside_a_pathway();
    conus_renderer *renderer = NULL;
    uint64_t random = 7;
    int hides = 0;
    (void)state;
    test_need_gl();
    assert_ok(conus_renderer_create(&renderer, atlas, &gl));
    conus_view view = {.width = 48, .height = 36, .no_legend = true};
    for (int change = 0; change < CHANGES; change++) {
        conus_image *images[3] = {NULL};
        conus_renderer *fresh = NULL;
        view.draft = true;
        assert_ok(conus_render(&images[0], renderer, &view));
        switch (change % 2 ? one_of(&random, 5) : 5) {
        case 0:
            view.opacity = view.opacity ? NULL : opacity;
            break;
        case 1:
            hides = !hides;
            assert_ok(conus_atlas_set_hidden(atlas, hidden[hides]));
            assert_ok(conus_renderer_update(renderer));
            break;
        case 2:
            view.side = view.side == CONUS_SIDE_LEFT ? CONUS_SIDE_FRONT : CONUS_SIDE_LEFT;
            break;
        case 3:
            view.width = view.width == 48 ? 50 : 48;
            break;
        case 4:
            view.own_colours = !view.own_colours;
            break;
        default:
            break;
        }
        view.draft = false;
        assert_ok(conus_renderer_create(&fresh, atlas, &gl));
        assert_ok(conus_render(&images[1], renderer, &view));
        assert_ok(conus_render(&images[2], fresh, &view));
        assert_true(difference(images[1], images[2]) == 0);
        for (int i = 0; i < 3; i++) {
            conus_image_destroy(images[i]);
        }
        conus_renderer_destroy(fresh);
    }
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(picture_view)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rolled_up_areas_look_like_one),
        cmocka_unit_test(a_draft_has_the_areas_of_its_answer),
        cmocka_unit_test(no_picture_is_late),
        cmocka_unit_test(a_smooth_picture_takes_no_other_draft),
        cmocka_unit_test(pictures_have_their_size_and_are_opaque),
        cmocka_unit_test(a_cone_that_begins_in_an_area_is_not_drawn_through_it),
        cmocka_unit_test(options_show_in_the_picture),
        cmocka_unit_test(odd_scenes_are_pictures),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(allocations_may_fail),
        cmocka_unit_test(a_phantom_looks_as_it_did),
        cmocka_unit_test(a_change_of_brightness_is_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
