/* SPDX-License-Identifier: BSD-3-Clause */
/* The colours of the look: people with any colour vision tell the ranks of an answer apart, from each other and from
 * what else has a colour. Differences are CIEDE2000 (Sharma, Wu and Dalal 2005); the three kinds of colour blindness
 * are those of Machado, Oliveira and Fernandes (2009), of severity 1.0. */
#include "base/look.h"
#include "test.h"

#include <math.h>
#include <stdint.h>

#define DEGREES (180 / 3.14159265358979323846)

enum sight { NORMAL = 0, PROTAN, DEUTAN, TRITAN, SIGHTS };

/* Linear R, G, B as others see them: the published matrices. */
static const double seen_as[SIGHTS][3][3] = {
    [NORMAL] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    [PROTAN] = {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}},
    [DEUTAN] = {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}},
    [TRITAN] = {{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}},
};

static double linear_of(uint8_t byte)
{
    double value = byte / 255.0;
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

static double lightness_curve(double t)
{
    return t > 216 / 24389.0 ? cbrt(t) : (24389 / 27.0 * t + 16) / 116;
}

/* CIE L*, a*, b* under D65 of sRGB bytes. */
static void lab_of(double lab[3], const uint8_t bytes[3], enum sight sight)
{
    static const double xyz_from_rgb[3][3] = {
        {0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}};
    double rgb[3];
    double f[3];
    for (int c = 0; c < 3; c++) {
        const double *row = seen_as[sight][c];
        double seen = row[0] * linear_of(bytes[0]) + row[1] * linear_of(bytes[1]) + row[2] * linear_of(bytes[2]);
        rgb[c] = fmin(fmax(seen, 0), 1);
    }
    for (int k = 0; k < 3; k++) {
        const double *row = xyz_from_rgb[k];
        double white = row[0] + row[1] + row[2];
        f[k] = lightness_curve((row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]) / white);
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

static double hue_of(double a, double b)
{
    double hue = a == 0 && b == 0 ? 0 : atan2(b, a) * DEGREES;
    return hue < 0 ? hue + 360 : hue;
}

static double cosine(double degrees)
{
    return cos(degrees / DEGREES);
}

/* How much of a chroma counts twice: near 0 for greys, near 1 for full colours. */
static double fullness(double chroma)
{
    double power = pow(chroma, 7);
    return sqrt(power / (power + pow(25, 7)));
}

/* CIEDE2000, as Sharma, Wu and Dalal number its steps. */
static double difference_of(const double one[3], const double other[3])
{
    const double mean_chroma = (hypot(one[1], one[2]) + hypot(other[1], other[2])) / 2;
    const double stretch = 1 + 0.5 * (1 - fullness(mean_chroma));
    const double c1 = hypot(stretch * one[1], one[2]);
    const double c2 = hypot(stretch * other[1], other[2]);
    const double h1 = hue_of(stretch * one[1], one[2]);
    const double h2 = hue_of(stretch * other[1], other[2]);
    const bool is_grey = c1 * c2 == 0;
    double turn = is_grey ? 0 : h2 - h1;
    turn = turn > 180 ? turn - 360 : turn < -180 ? turn + 360 : turn;
    double hue = is_grey || fabs(h1 - h2) <= 180 ? h1 + h2 : h1 + h2 < 360 ? h1 + h2 + 360 : h1 + h2 - 360;
    hue = is_grey ? hue : hue / 2;
    const double lightness = (one[0] + other[0]) / 2;
    const double chroma = (c1 + c2) / 2;
    const double t =
        1 - 0.17 * cosine(hue - 30) + 0.24 * cosine(2 * hue) + 0.32 * cosine(3 * hue + 6) - 0.20 * cosine(4 * hue - 63);
    const double blue = 30 * exp(-(hue - 275) / 25 * ((hue - 275) / 25));
    const double off = (lightness - 50) * (lightness - 50);
    const double l = (other[0] - one[0]) / (1 + 0.015 * off / sqrt(20 + off));
    const double c = (c2 - c1) / (1 + 0.045 * chroma);
    const double h = 2 * sqrt(c1 * c2) * sin(turn / 2 / DEGREES) / (1 + 0.015 * chroma * t);
    return sqrt(l * l + c * c + h * h - sin(2 * blue / DEGREES) * 2 * fullness(chroma) * c * h);
}

static double seen_difference(const uint8_t one[3], const uint8_t other[3], enum sight sight)
{
    double labs[2][3];
    lab_of(labs[0], one, sight);
    lab_of(labs[1], other, sight);
    return difference_of(labs[0], labs[1]);
}

/* Pairs of the published test data, which reach each branch: hues on both sides of 0, greys, blues. */
static void differences_are_those_that_were_published(void **state)
{
    (void)state;
    static const struct {
        double one[3], other[3], difference;
    } pairs[] = {
        {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
        {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
        {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
        {{50, 0, 0}, {50, -1, 2}, 2.3669},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
        {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
        {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
        {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
        {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
        {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
        {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
        {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
        {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
        {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
        {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
        {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
        {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
        {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
        {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
        {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
        {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        assert_near(difference_of(pairs[i].one, pairs[i].other), pairs[i].difference, 5.1e-5);
        assert_near(difference_of(pairs[i].other, pairs[i].one), pairs[i].difference, 5.1e-5);
    }
}

/* White is (100, 0, 0), red by the definition of sRGB (53.24, 80.09, 67.20). Who sees no red or no green confuses a red
 * and a green, but not blue and yellow, and whoever sees no blue the other way round. A grey is the same to all. */
static void sights_are_those_of_people(void **state)
{
    (void)state;
    static const uint8_t white[3] = {255, 255, 255}, grey[3] = {118, 118, 118}, red[3] = {255, 0, 0};
    static const uint8_t green[3] = {0, 144, 0}, blue[3] = {0, 0, 255}, yellow[3] = {255, 255, 0};
    double lab[3];
    double other[3];
    lab_of(lab, white, NORMAL);
    assert_near(lab[0], 100, 1e-9);
    assert_near(hypot(lab[1], lab[2]), 0, 1e-9);
    lab_of(lab, red, NORMAL);
    assert_near(lab[0], 53.24, 0.01);
    assert_near(lab[1], 80.09, 0.01);
    assert_near(lab[2], 67.20, 0.01);
    lab_of(lab, grey, NORMAL);
    for (enum sight sight = PROTAN; sight < SIGHTS; sight++) {
        lab_of(other, grey, sight);
        assert_true(difference_of(lab, other) < 0.01);
        double kept = seen_difference(red, green, sight) / seen_difference(red, green, NORMAL);
        double others = seen_difference(blue, yellow, sight) / seen_difference(blue, yellow, NORMAL);
        assert_true(sight == TRITAN ? others < 0.6 * kept : kept < 0.6 * others);
    }
}

#define BYTES(colour) {LOOK_RGB(colour)},
static const uint8_t ranks[][3] = {LOOK_RANKS(BYTES)};
enum { RANKS = sizeof ranks / sizeof *ranks };

static void ranks_are_told_apart(void **state)
{
    (void)state;
    for (enum sight sight = NORMAL; sight < SIGHTS; sight++) {
        for (int a = 0; a < RANKS; a++) {
            for (int b = 0; b < a; b++) {
                double apart = seen_difference(ranks[a], ranks[b], sight);
                if (apart < (sight == NORMAL ? 20 : 12)) {
                    fail_msg("ranks %d and %d, sight %d: %.2f", b + 1, a + 1, (int)sight, apart);
                }
            }
        }
    }
}

/* The cone and the two greys also for those who see no red, green or blue; at least 12, as among the ranks. */
static void ranks_are_no_state(void **state)
{
    (void)state;
    static const struct {
        uint8_t rgb[3];
        bool in_every_sight;
    } others[] = {
        {{LOOK_RGB(LOOK_CONE)}, true},    {{LOOK_RGB(LOOK_NOT_HIT)}, true}, {{LOOK_RGB(LOOK_NOT_HIT_ON_WHITE)}, true},
        {{LOOK_RGB(LOOK_SECOND)}, false}, {{LOOK_RGB(LOOK_BROKEN)}, false}, {{LOOK_RGB(LOOK_HOLDS)}, false}};
    for (int a = 0; a < RANKS; a++) {
        for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
            for (enum sight sight = NORMAL; sight < SIGHTS; sight++) {
                double apart = seen_difference(ranks[a], others[i].rgb, sight);
                if (apart < (sight == NORMAL ? 15 : others[i].in_every_sight ? 12 : 0)) {
                    fail_msg("rank %d and other %zu, sight %d: %.2f", a + 1, i, (int)sight, apart);
                }
            }
        }
    }
}

/* Brown is a dark amber, so as a fill it is taken for the cone's light: no rank before the last is as near to its hue.
 */
static void the_hue_of_the_cone_comes_last(void **state)
{
    (void)state;
    static const uint8_t cone[3] = {LOOK_RGB(LOOK_CONE)};
    double away[RANKS];
    double lab[3];
    lab_of(lab, cone, NORMAL);
    const double hue = hue_of(lab[1], lab[2]);
    for (int a = 0; a < RANKS; a++) {
        lab_of(lab, ranks[a], NORMAL);
        away[a] = fabs(remainder(hue_of(lab[1], lab[2]) - hue, 360));
    }
    for (int a = 0; a < RANKS - 1; a++) {
        assert_true(away[a] > away[RANKS - 1]);
    }
}

static double luminance_of(const uint8_t rgb[3])
{
    return 0.2126 * linear_of(rgb[0]) + 0.7152 * linear_of(rgb[1]) + 0.0722 * linear_of(rgb[2]);
}

/* Chips, balls and fills are seen on white and on the lighter end of the dark background: WCAG 2.2, 1.4.11. */
static void ranks_are_seen_on_dark_and_white(void **state)
{
    (void)state;
    static const uint8_t dark[3] = {0x23, 0x27, 0x2E};
    for (int a = 0; a < RANKS; a++) {
        const double light = luminance_of(ranks[a]) + 0.05;
        assert_true(1.05 / light >= 3);
        assert_true(light / (luminance_of(dark) + 0.05) >= 3);
    }
}

/* Between areas, which are grey without a scan, and around them. */
static void outlines_are_seen(void **state)
{
    (void)state;
    static const uint8_t outline[3] = {LOOK_RGB(LOOK_OUTLINE)};
    static const uint8_t grounds[][3] = {BYTES(LOOK_NOT_HIT) BYTES(LOOK_WHITE) BYTES(LOOK_PANE_DARK) BYTES(LOOK_BLACK)};
    const double line = luminance_of(outline) + 0.05;
    for (size_t i = 0; i < sizeof grounds / sizeof *grounds; i++) {
        double ground = luminance_of(grounds[i]) + 0.05;
        assert_true(fmax(line / ground, ground / line) >= 3);
    }
}

/* In cuts they fill 45 % over what a scan shows there: still 10 apart on black, grey and white. */
static void fills_are_told_apart(void **state)
{
    (void)state;
    for (int under = 0; under <= 255; under += 51) {
        uint8_t filled[RANKS][3];
        for (int a = 0; a < RANKS; a++) {
            for (int c = 0; c < 3; c++) {
                filled[a][c] = (uint8_t)lround(0.45 * ranks[a][c] + 0.55 * under);
            }
            for (int b = 0; b < a; b++) {
                double apart = seen_difference(filled[a], filled[b], NORMAL);
                if (apart < 10) {
                    fail_msg("ranks %d and %d over %d: %.2f", b + 1, a + 1, under, apart);
                }
            }
        }
    }
}

TEST_GROUP(look)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(differences_are_those_that_were_published),
        cmocka_unit_test(sights_are_those_of_people),
        cmocka_unit_test(ranks_are_told_apart),
        cmocka_unit_test(ranks_are_no_state),
        cmocka_unit_test(the_hue_of_the_cone_comes_last),
        cmocka_unit_test(ranks_are_seen_on_dark_and_white),
        cmocka_unit_test(outlines_are_seen),
        cmocka_unit_test(fills_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
