/* SPDX-License-Identifier: BSD-3-Clause */
/* The shape of the chosen area, its shadow and its outline, without a window. */
#include "viewer/model/viewer.h"
#include "viewer/pictures/pictures.h"

#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static conus_atlas *load(const char *kind)
{
    conus_atlas *atlas = NULL;
    char path[600];
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch("phantom"));
    assert_ok(conus_phantom_write(kind, folder, NULL));
    snprintf(path, sizeof path, "%s/%s.nii.gz", folder, kind);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    return atlas;
}

static double from_middle(const double p[3])
{
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

/* Around a ball of 20 mm in voxels of 1 mm, which lie within half their diagonal, 0.87 mm, of its surface; a cell at
 * the surface has its middle inside, and a neighbour's, an edge away, outside. */
static void check_ball(const struct cells *cells, double radius)
{
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    assert_true(cells->count > 1000);
    assert_true(cells->edge < (2 * radius + 8) / 60); /* a cell of the first look, 1 mm, and a voxel to each side */
    for (size_t i = 0; i < cells->count; i++) {
        double r = from_middle(cells->middles[i]);
        assert_true(r <= radius + 0.87 && r >= radius - 0.87 - cells->edge * 1.01);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], cells->middles[i][a]);
            high[a] = fmax(high[a], cells->middles[i][a]);
        }
    }
    for (int a = 0; a < 3; a++) { /* all sides are there: faces of voxels are at the radius, a whole number */
        assert_true(low[a] >= -radius && low[a] <= -radius + cells->edge);
        assert_true(high[a] <= radius && high[a] >= radius - cells->edge);
    }
}

static void cells_lie_at_the_surface(void **state)
{
    conus_atlas *atlas = load("sphere");
    struct cells cells;
    (void)state;
    assert_ok(cells_find(&cells, atlas, (bool[]){false, true}));
    check_ball(&cells, 20);
    cells_finish(&cells);
    assert_ok(cells_find(&cells, atlas, (bool[]){false, false}));
    assert_int_equal(cells.count, 0);
    cells_finish(&cells);
    conus_atlas_destroy(atlas);
}

/* Balls of 24, 16 and 8 mm, one in the other: together they have the shape of the outermost; the outermost alone has a
 * hollow of 16 mm; hidden objects have no cells. */
static void several_areas_have_one_shape_and_hidden_ones_none(void **state)
{
    conus_atlas *atlas = load("nested");
    struct cells cells;
    size_t near = 0;
    (void)state;
    assert_ok(cells_find(&cells, atlas, (bool[]){false, true, true, true}));
    check_ball(&cells, 24);
    cells_finish(&cells);
    assert_ok(cells_find(&cells, atlas, (bool[]){false, true, false, false}));
    for (size_t i = 0; i < cells.count; i++) {
        double r = from_middle(cells.middles[i]);
        assert_true(r > 16 - 0.87);
        near += r < 16 + 0.87 + cells.edge;
    }
    assert_true(near > 1000);
    cells_finish(&cells);
    assert_ok(conus_atlas_set_hidden(atlas, (bool[]){false, false, false, true}));
    assert_ok(cells_find(&cells, atlas, (bool[]){false, false, false, true}));
    assert_int_equal(cells.count, 0);
    cells_finish(&cells);
    assert_ok(conus_atlas_set_hidden(atlas, (bool[]){false, true, true, true}));
    assert_ok(cells_find(&cells, atlas, (bool[]){false, true, false, true}));
    assert_int_equal(cells.count, 0);
    cells_finish(&cells);
    conus_atlas_destroy(atlas);
}

/* One voxel of 1 mm in a grid of 200: the first, coarse pass misses it, but the area's middle is tried, too. */
static void a_small_area_is_found(void **state)
{
    enum { SIDE = 200 };
    uint8_t *labels = calloc((size_t)SIDE * SIDE, SIDE);
    conus_atlas *atlas = NULL;
    struct cells cells;
    (void)state;
    assert_non_null(labels);
    labels[0] = labels[(size_t)SIDE * SIDE * SIDE - 1] = 1;
    labels[((size_t)101 * SIDE + 102) * SIDE + 103] = 2;
    const conus_voxels voxels = {.data = labels,
                                 .type = CONUS_SCALAR_UINT8,
                                 .dim = {SIDE, SIDE, SIDE},
                                 .world_from_voxel = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL));
    assert_ok(cells_find(&cells, atlas, (bool[]){false, false, true}));
    assert_true(cells.count > 0);
    for (size_t i = 0; i < cells.count; i++) {
        const double at[3] = {103, 102, 101};
        for (int a = 0; a < 3; a++) {
            assert_near(cells.middles[i][a], at[a], 0.5);
        }
    }
    cells_finish(&cells);
    conus_atlas_destroy(atlas);
    free(labels);
}

static void clear(float *away, size_t pixels)
{
    for (size_t pixel = 0; pixel < pixels; pixel++) {
        away[pixel] = INFINITY;
    }
}

/* Seen from D = 100 mm a ball of r = 20 mm is a disc about the picture's middle whose edge is asin(r / D) off the axis:
 * at tan of that, 0.2041, from the middle, of the 0.5 that are half of the picture's height. In 200 pixels: 40.8. */
static void a_ball_casts_a_disc(void **state)
{
    enum { WIDE = 300, HIGH = 200 };
    conus_atlas *atlas = load("sphere");
    struct eye eye = {.frustum = {-0.75, 0.75, -0.5, 0.5}};
    float *away = malloc((size_t)WIDE * HIGH * sizeof *away);
    struct cells cells;
    (void)state;
    assert_non_null(away);
    clear(away, (size_t)WIDE * HIGH);
    assert_ok(conus_pose_along(&eye.camera, (double[]){0, 100, 0}, (double[]){0, -1, 0}, NULL));
    assert_ok(cells_find(&cells, atlas, (bool[]){false, true}));
    cells_cast(away, WIDE, HIGH, &cells, &eye);
    double wanted = 200 * tan(asin(0.2));
    for (int y = 0; y < HIGH; y++) {
        for (int x = 0; x < WIDE; x++) {
            double r = hypot(x + 0.5 - WIDE / 2.0, y + 0.5 - HIGH / 2.0);
            if (fabs(r - wanted) > 3.5) { /* 0.87 mm of voxels and half a cell are 2.9 pixels at 80 mm, and one more */
                assert_int_equal(isfinite(away[y * WIDE + x]) != 0, r < wanted);
            }
        }
    }
    assert_near(away[HIGH / 2 * WIDE + WIDE / 2], 80, 0.87 + cells.edge); /* its nearest point, D - r */
    clear(away, (size_t)WIDE * HIGH);
    assert_ok(conus_pose_along(&eye.camera, (double[]){0, -100, 0}, (double[]){0, 1, 0}, NULL)); /* from behind, too */
    cells_cast(away, WIDE, HIGH, &cells, &eye);
    assert_near(away[HIGH / 2 * WIDE + WIDE / 2], 80, 0.87 + cells.edge);
    assert_ok(conus_pose_along(&eye.camera, (double[]){0, 100, 0}, (double[]){0, 1, 0}, NULL)); /* behind the eye */
    clear(away, (size_t)WIDE * HIGH);
    cells_cast(away, WIDE, HIGH, &cells, &eye);
    for (size_t pixel = 0; pixel < (size_t)WIDE * HIGH; pixel++) {
        assert_true(isinf(away[pixel]));
    }
    assert_ok(conus_pose_along(&eye.camera, (double[]){0, 0, 0}, (double[]){0, 1, 0}, NULL)); /* around it */
    cells_cast(away, WIDE, HIGH, &cells, &eye);
    for (size_t pixel = 0; pixel < (size_t)WIDE * HIGH; pixel++) {
        assert_true(isfinite(away[pixel]));
    }
    free(away);
    cells_finish(&cells);
    conus_atlas_destroy(atlas);
}

enum { SIDE = 160 };

/* What lies between four pixels, bilinear. */
static double between(const uint8_t *values, size_t stride, double x, double y)
{
    const int left = (int)floor(x - 0.5), top = (int)floor(y - 0.5);
    double sum = 0;
    for (int n = 0; n < 4; n++) {
        const int at[2] = {left + n % 2, top + n / 2};
        const double part = (1 - fabs(x - 0.5 - at[0])) * (1 - fabs(y - 0.5 - at[1]));
        sum += part * values[stride * (size_t)(at[1] * SIDE + at[0])];
    }
    return sum;
}

/* Along each ray from the middle of a disc the bright line's middle is 0.6 pixels, half its width, within the place
 * where the level is a half. Returns the largest error, pixels. */
static double error_of_line(const uint8_t *rgba, const uint8_t *level)
{
    double most = 0;
    for (int ray = 0; ray < 360; ray++) {
        const double along[2] = {cos(ray * 0.017453292519943295), sin(ray * 0.017453292519943295)};
        double edge = 0;
        double sum = 0;
        double weights = 0;
        for (int step = 800; step < 1200; step++) {
            const double r = step / 20.0;
            const double x = 80 + r * along[0], y = 80 + r * along[1];
            const double bright = between(rgba, 4, x, y) * between(rgba + 3, 4, x, y);
            edge = between(level, 1, x, y) >= 127.5 ? r : edge;
            sum += r * bright;
            weights += bright;
        }
        assert_true(weights > 0);
        most = fmax(most, fabs(sum / weights - (edge - 0.6)));
    }
    return most;
}

/* The line of whole pixels has stairs, the soft one is off by less than `most` pixels. */
static void check_soft_line(const uint8_t *mask, const uint8_t *level, double most)
{
    static uint8_t rgba[4 * SIDE * SIDE];
    struct outline_top top;
    memset(rgba, 0, sizeof rgba);
    outline_draw(rgba, &top, mask, SIDE, SIDE, &outline_looks[OUTLINE_CHOSEN]);
    const double stairs = error_of_line(rgba, level);
    outline_soften(rgba, level, SIDE, SIDE, &outline_looks[OUTLINE_CHOSEN]);
    const double soft = error_of_line(rgba, level);
    assert_true(stairs > 0.5);
    assert_true(soft < most);
}

/* A disc of squares of 6 pixels on a lattice of 4 has no corners afterwards. One square alone stays, and a line of
 * squares. */
static void squares_have_no_stairs(void **state)
{
    enum { EDGE = 4, REACH = 3 };
    uint8_t level[SIDE * SIDE];
    uint8_t mask[SIDE * SIDE] = {0};
    uint8_t thin[SIDE * SIDE] = {0};
    (void)state;
    for (int cell = 0; cell < SIDE * SIDE / EDGE / EDGE; cell++) {
        const int at[2] = {cell % (SIDE / EDGE) * EDGE - 1, cell / (SIDE / EDGE) * EDGE - 1};
        const bool is_inside = hypot(at[0] + 3 - 80, at[1] + 3 - 80) < 50;
        const bool is_thin = at[1] == 39 || (at[0] == 79 && at[1] == 119);
        for (int n = 0; n < 36; n++) {
            const int x = at[0] + n % 6;
            const int y = at[1] + n / 6;
            if (x >= 0 && y >= 0 && x < SIDE && y < SIDE) {
                mask[y * SIDE + x] |= is_inside;
                thin[y * SIDE + x] |= is_thin;
            }
        }
    }
    outline_smooth(mask, level, SIDE, SIDE, REACH);
    check_soft_line(mask, level, 0.35);
    outline_smooth(thin, level, SIDE, SIDE, REACH);
    outline_smooth(mask, level, SIDE, SIDE, 0); /* which leaves the shape as it is */
    check_soft_line(mask, level, 0.45);
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            const double r = hypot(x + 0.5 - 80, y + 0.5 - 80);
            if (fabs(r - 51) > 1.6) { /* squares reach 1 beyond their cells; their corners 1.84 from there */
                assert_int_equal(mask[y * SIDE + x], r < 51);
            }
        }
    }
    outline_smooth(thin, level, SIDE, SIDE, 0);
    assert_true(thin[42 * SIDE + 80] && thin[122 * SIDE + 82] && !thin[60 * SIDE + 80]);
}

/* Cells alone, a near one and one four times as far: of each some pixel is left, however large they are. */
static void no_cell_alone_is_lost(void **state)
{
    enum { WIDE = 300, HIGH = 200, PIXELS = WIDE * HIGH };
    static float away[PIXELS];
    static uint8_t mask[PIXELS], level[PIXELS];
    double middles[2][3] = {{-15, 0, 0}, {60, -300, 0}};
    struct eye eye = {.frustum = {-0.75, 0.75, -0.5, 0.5}};
    (void)state;
    assert_ok(conus_pose_along(&eye.camera, (double[]){0, 100, 0}, (double[]){0, -1, 0}, NULL));
    for (int eighths = 16; eighths < 200; eighths++) {
        const double edge = eighths / 8.0;
        const struct cells cells = {.middles = middles, .count = 2, .edge = edge};
        clear(away, PIXELS);
        const double square = cells_cast(away, WIDE, HIGH, &cells, &eye);
        assert_true(square > 0);
        for (size_t pixel = 0; pixel < PIXELS; pixel++) {
            mask[pixel] = isfinite(away[pixel]) != 0;
        }
        outline_smooth(mask, level, WIDE, HIGH, outline_reach(square));
        bool found[2] = {false};
        for (size_t pixel = 0; pixel < PIXELS; pixel++) {
            found[pixel % WIDE < WIDE / 2] |= mask[pixel];
        }
        if (!found[0] || !found[1]) {
            fail_msg("cells of %g mm, squares of %g pixels: %d %d", edge, square, found[0], found[1]);
        }
    }
}

/* Compares the pixels with `wanted`: 1 = bright, 2 = dark, . = unchanged. */
static void check_lines(const uint8_t *rgba, const char *wanted)
{
    for (size_t pixel = 0; wanted[pixel]; pixel++) {
        const uint8_t *colour = rgba + 4 * pixel;
        char is = colour[0] == 255 ? '1' : colour[0] == 0 ? '2' : '.';
        if (is != wanted[pixel]) {
            fail_msg("pixel %zu is %c, wanted %c", pixel, is, wanted[pixel]);
        }
    }
}

static void an_outline_is_bright_within_and_dark_beside(void **state)
{
    static const char shape[] = "........"
                                "..###..."
                                "..####.."
                                "..###..."
                                "........"
                                "........"
                                "......##"; /* the picture's border is no edge */
    static const char thin[] = "..222..."
                               ".21112.."
                               ".21..12."
                               ".21112.."
                               "..222..."
                               "......22"
                               ".....211";
    static const char wide[] = ".21112.."
                               "2111112."
                               "211..112"
                               "2111112."
                               ".2111222"
                               "..222211"
                               "....2111";
    enum { WIDE = 8, HIGH = 7, PIXELS = WIDE * HIGH };
    uint8_t mask[PIXELS];
    uint32_t objects[PIXELS];
    uint8_t rgba[4 * PIXELS];
    struct outline_top top;
    (void)state;
    memset(rgba, 100, sizeof rgba);
    for (size_t pixel = 0; pixel < PIXELS; pixel++) {
        mask[pixel] = shape[pixel] == '#';
        objects[pixel] = mask[pixel] ? 1 + pixel % 2 : pixel % 3 ? 0 : 3;
    }
    uint8_t copy[sizeof rgba];
    memcpy(copy, rgba, sizeof copy);
    outline_cut(copy, &top, objects, WIDE, HIGH, (bool[]){false, true, true, false}, &outline_looks[OUTLINE_CHOSEN]);
    check_lines(copy, wide);
    assert_true(top.is_there);
    assert_int_equal(top.x, 3);
    assert_int_equal(top.y, 1);
    outline_draw(rgba, &top, mask, WIDE, HIGH, &outline_looks[OUTLINE_CHOSEN]);
    check_lines(rgba, thin);
    assert_int_equal(top.x, 3);
    /* what is filled by 0.7 has 0.7 of that opacity within the line, in a cut 0.7 of its colour and 0.3 of what was */
    const struct outline_look full = {{255, 0, 0}, 0.7};
    uint8_t square[4 * 25] = {0};
    uint8_t inner[25] = {0};
    uint32_t number[25];
    for (int pixel = 0; pixel < 25; pixel++) {
        inner[pixel] = pixel % 5 % 4 && pixel / 5 % 4;
    }
    outline_draw(square, &top, inner, 5, 5, &full);
    assert_int_equal(square[4 * 12 + 3], 179); /* 178.5 */
    assert_int_equal(square[4 * 6 + 3], 255);
    assert_int_equal(square[4 * 1], 0);
    memset(square, 100, sizeof square);
    for (int pixel = 0; pixel < 25; pixel++) {
        number[pixel] = 1;
    }
    outline_cut(square, &top, number, 5, 5, (bool[]){false, true}, &full);
    assert_int_equal(square[4 * 12], 209); /* 208.5 */
    assert_int_equal(square[4 * 12 + 1], 30);
    assert_int_equal(square[4 * 12 + 3], 100);
    memset(mask, 0, sizeof mask);
    outline_draw(rgba, &top, mask, WIDE, HIGH, &outline_looks[OUTLINE_CHOSEN]);
    assert_false(top.is_there);
}

/* A square of 16 pixels, its right half hidden: lines that lie are dashed along x, those that stand along y. */
static void an_outline_is_dashed_where_it_is_hidden(void **state)
{
    enum { WIDE = 20, PIXELS = WIDE * WIDE, LOW = 2, HIGH = 18, MIDDLE = 10 };
    uint8_t mask[PIXELS] = {0};
    uint8_t hidden[PIXELS] = {0};
    uint8_t whole[4 * PIXELS] = {0};
    uint8_t dashed[4 * PIXELS];
    struct outline_top top;
    (void)state;
    for (int pixel = 0; pixel < PIXELS; pixel++) {
        int x = pixel % WIDE;
        int y = pixel / WIDE;
        mask[pixel] = x >= LOW && x < HIGH && y >= LOW && y < HIGH;
        hidden[pixel] = x >= MIDDLE;
    }
    outline_draw(whole, &top, mask, WIDE, WIDE, &outline_looks[OUTLINE_CHOSEN]);
    memcpy(dashed, whole, sizeof whole);
    outline_dash(dashed, mask, hidden, WIDE, WIDE);
    for (int pixel = 0; pixel < PIXELS; pixel++) {
        int x = pixel % WIDE;
        int y = pixel / WIDE;
        bool lies = (y <= LOW || y >= HIGH - 1) && x >= LOW && x < HIGH;
        bool stays = x < MIDDLE || (lies ? x : y) / OUTLINE_DASH % 2 == 0;
        assert_int_equal(dashed[4 * pixel + 3], stays ? whole[4 * pixel + 3] : 0);
    }
}

/* Around a hidden disc there is a gap after every dash, once the line is soft, too. Dashes are counted along that axis
 * along which the line goes more, which changes at 45 degrees, where a dash may go on as another: here no run is longer
 * than 20 pixels. By the edges of pixels, of which those of a diagonal alternate, one had 24. */
static void a_hidden_line_has_gaps_in_all_directions(void **state)
{
    enum { REACH = 9, STEPS = 3600 };
    static const double least = 0.5, radius = 60, middle = 0.5 * SIDE;
    static uint8_t mask[SIDE * SIDE], level[SIDE * SIDE], hidden[SIDE * SIDE], rgba[4 * SIDE * SIDE];
    const double step = radius * 6.283185307179586 / STEPS; /* pixels */
    struct outline_top top;
    double run = 0, longest[2] = {0, 0}; /* of gaps, of dashes */
    bool was = false;
    (void)state;
    for (int pixel = 0; pixel < SIDE * SIDE; pixel++) {
        const int row = pixel / SIDE;
        mask[pixel] = hypot(pixel % SIDE + 0.5 - middle, row + 0.5 - middle) < radius;
        hidden[pixel] = 1;
    }
    outline_smooth(mask, level, SIDE, SIDE, REACH);
    outline_draw(rgba, &top, mask, SIDE, SIDE, &outline_looks[OUTLINE_CHOSEN]);
    outline_dash(rgba, level, hidden, SIDE, SIDE);
    outline_soften(rgba, level, SIDE, SIDE, &outline_looks[OUTLINE_CHOSEN]);
    for (int n = 0; n < 2 * STEPS; n++) { /* twice around: the first dash, too, is whole then */
        const double angle = n * 6.283185307179586 / STEPS;
        const double at[2] = {middle + (radius - 0.6) * cos(angle), middle + (radius - 0.6) * sin(angle)};
        const bool is = between(rgba + 3, 4, at[0], at[1]) > least * 255;
        run = is == was ? run + step : 0;
        was = is;
        longest[is] = fmax(longest[is], run);
    }
    assert_in_range((int)longest[0], OUTLINE_DASH / 2, 2 * OUTLINE_DASH);
    assert_in_range((int)longest[1], OUTLINE_DASH, 19);
}

TEST_GROUP(chosen)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_lie_at_the_surface),
        cmocka_unit_test(several_areas_have_one_shape_and_hidden_ones_none),
        cmocka_unit_test(a_small_area_is_found),
        cmocka_unit_test(a_ball_casts_a_disc),
        cmocka_unit_test(squares_have_no_stairs),
        cmocka_unit_test(no_cell_alone_is_lost),
        cmocka_unit_test(an_outline_is_bright_within_and_dark_beside),
        cmocka_unit_test(an_outline_is_dashed_where_it_is_hidden),
        cmocka_unit_test(a_hidden_line_has_gaps_in_all_directions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
