/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines, text and legends on pictures. */
#include "render/draw/draw.h"
#include "render/image/image.h"
#include "test.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

static const float WHITE[4] = {1, 1, 1, 1};

static struct font *make_font(void)
{
    struct font *font = NULL;
    assert_ok(font_create(&font));
    return font;
}

static conus_image *make_image(uint32_t width, uint32_t height)
{
    conus_image *image = NULL;
    assert_ok(image_create_listed(&image, width, height));
    return image;
}

/* Sum of the opacities once the list is painted: a shape's area in pixels. */
static double inked(conus_image *image)
{
    if (image->list) {
        assert_ok(image_paint(image));
    }
    const float *opacity = conus_image_floats(image, "A");
    double sum = 0;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        sum += (double)opacity[i];
    }
    return sum;
}

static void shapes_cover_their_area(void **state)
{
    (void)state;
    double corners[3][2] = {{10, 10}, {40, 10}, {10, 30}};
    const struct {
        double from[2], to[2], width, area, tolerance;
    } lines[] = {{{30.3, 20.7}, {30.3, 20.7}, 30, acos(-1) * 225, 1}, /* a disc */
                 {{10, 10.5}, {50, 40.5}, 3, 150 + acos(-1) * 2.25, 1.5}};
    for (size_t i = 0; i < 2; i++) {
        conus_image *image = make_image(64, 48);
        draw_line(image->list, lines[i].from, lines[i].to, lines[i].width, WHITE);
        assert_near(inked(image), lines[i].area, lines[i].tolerance);
        conus_image_destroy(image);
    }
    conus_image *image = make_image(64, 48);
    draw_box(image->list, &(struct draw_box){10, 10, 30, 20}, 0, WHITE);
    draw_frame(image->list, &(struct draw_box){40, 10, 60, 30}, 0, 2, WHITE);
    assert_near(inked(image), 200 + 400 - 256, 1e-4);
    conus_image_destroy(image);
    image = make_image(64, 48);
    draw_item(image->list, &(struct draw_item){.kind = DRAW_AREA, .points = corners, .count = 3, .rgba = {1, 1, 1, 1}});
    assert_near(inked(image), 300, 1);
    conus_image_destroy(image);
    image = make_image(64, 48); /* as long as its sides: what a corner adds outside lacks inside */
    draw_item(image->list,
              &(struct draw_item){.kind = DRAW_LOOP, .points = corners, .count = 3, .width = 1, .rgba = {1, 1, 1, 1}});
    assert_near(inked(image), 50 + hypot(30, 20), 1.5);
    conus_image_destroy(image);
}

static void shapes_are_cut_off_at_the_border(void **state)
{
    (void)state;
    conus_image *image = make_image(16, 16);
    draw_line(image->list, (double[]){0, 0}, (double[]){0, 0}, 16, WHITE);
    draw_line(image->list, (double[]){-1e9, 12}, (double[]){1e9, 12}, 2, WHITE);
    draw_box(image->list, &(struct draw_box){20, -40, 30, -20}, 3, WHITE);
    draw_line(image->list, (double[]){NAN, 0}, (double[]){NAN, 0}, 16, WHITE);
    assert_near(inked(image), acos(-1) * 16 + 32, 1);
    conus_image_destroy(image);
}

/* Premultiplied over: half-transparent red over opaque linear grey, and half over nothing. */
static void colours_are_laid_over(void **state)
{
    (void)state;
    conus_image *image = make_image(2, 1);
    struct image_rgba planes = image_rgba(image);
    float colour[4];
    draw_colour(colour, (const uint8_t[]){255, 0, 0}, 0.5F);
    draw_box(image->list, &(struct draw_box){0, 0, 1, 1}, 0, (const float[]){0.2F, 0.2F, 0.2F, 1});
    draw_box(image->list, &(struct draw_box){0, 0, 1.5, 1}, 0, colour);
    assert_ok(image_paint(image));
    assert_near(planes.plane[0][0], 0.6, 1e-6);
    assert_near(planes.plane[1][0], 0.1, 1e-6);
    assert_near(planes.plane[3][0], 1, 1e-6);
    assert_near(planes.plane[0][1], 0.25, 0.5 / 255); /* half of the pixel, which is not half of 255 */
    assert_near(planes.plane[3][1], 0.25, 0.5 / 255);
    conus_image_destroy(image);
}

static void text_has_a_width_that_adds_up(void **state)
{
    (void)state;
    struct font *font = make_font();
    double width = font_width(font, 20, "Hippocampus");
    assert_true(width > 60 && width < 200);
    assert_near(font_width(font, 40, "Hippocampus"), 2 * width, 1e-2);
    assert_near(font_width(font, 20, "HippocampusHippocampus"), 2 * width, 1e-6);
    assert_near(font_width(font, 20, ""), 0, 0);
    assert_near(font_width(font, 20, "\xff\xc3"), font_width(font, 20, "\xc3\xbf\xc3\x83"), 1e-6); /* Windows-1252 */
    assert_true(font_width(font, 20, "\xc2\xb5") > 0);
    font_destroy(font);
    font_destroy(NULL);
}

/* The ink lies at the requested place: above the baseline for letters without descender, within the text's width. */
static void text_is_drawn_in_its_place(void **state)
{
    (void)state;
    struct font *font = make_font();
    conus_image *image = make_image(200, 60);
    draw_text(image->list, font, (double[]){20.25, 40}, 24, WHITE, "HEx");
    const float *opacity = conus_image_floats(image, "A");
    double right = 20.25 + font_width(font, 24, "HEx");
    assert_true(inked(image) > 100);
    for (int y = 0; y < 60; y++) {
        for (int x = 0; x < 200; x++) {
            bool allowed = y >= 40 - 24 && y < 40 && x >= 19 && x <= right + 1;
            assert_true(allowed || opacity[y * 200 + x] == 0);
        }
    }
    conus_image_destroy(image);
    image = make_image(200, 60);
    draw_text(image->list, font, (double[]){-30, 5}, 24, WHITE, "cut off at the border on every side, gjpq");
    assert_true(inked(image) > 100);
    conus_image_destroy(image);
    font_destroy(font);
}

static void long_text_ends_in_an_ellipsis(void **state)
{
    (void)state;
    struct font *font = make_font();
    char out[64];
    const char *name = "Gyrus fron\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9 inferior, pars opercularis";
    font_shorten(out, sizeof out, font, 20, name, 1000);
    assert_string_equal(out, name);
    for (int limit = 0; limit < 400; limit += 7) {
        font_shorten(out, sizeof out, font, 20, name, limit);
        size_t length = strlen(out);
        assert_true(font_width(font, 20, out) <= limit);
        assert_true(length == 0 || strcmp(out, name) == 0 || strcmp(out + length - 3, "\xe2\x80\xa6") == 0);
        assert_null(strstr(out, "\xc3\xe2")); /* no half character */
    }
    char little[16];
    font_shorten(little, sizeof little, font, 20, name, 1000);
    assert_string_equal(little, "Gyrus fron\xc3\xa9\xe2\x80\xa6");
    font_destroy(font);
}

static const float INK[4] = {0, 0, 0, 1};

static void draw_legend(conus_image *image, struct font *font, const struct legend *legend)
{
    legend_draw(image->list, font, legend);
    assert_ok(image_paint(image));
}

static const struct legend_row ROWS[] = {
    {.rgb = {220, 90, 60}, .name = "Frontal_Inf_Oper_L", .detail = {"188 px", "90.4 %", "25.5 mm"}},
    {.rgb = {80, 170, 220}, .name = "Precentral_L", .detail = {"16 px", "7.7 %", "31.0 mm"}},
    {.rgb = {120, 200, 90}, .name = "Postcentral_L", .detail = {"4 px", "1.9 %", "35.8 mm"}},
    {.rgb = {150, 150, 150}, .plain = true, .name = "unassigned", .detail = {"0 px", "0.0 %", NULL}},
};

static const struct legend LEGEND = {.title = "Areas in the cone",
                                     .subtitle = {"20\xc2\xb0 from (\xe2\x88\x92"
                                                  "90, 20, 20) mm"},
                                     .header = {"pixels", "share", "distance"},
                                     .rows = ROWS,
                                     .count = 4,
                                     .ink = INK,
                                     .size = 14};

static bool has_colour(const conus_image *image, const uint8_t rgb[3])
{
    float wanted[4];
    draw_colour(wanted, rgb, 1);
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        struct image_rgba planes = image_rgba(image);
        if (fabsf(planes.plane[0][i] - wanted[0]) + fabsf(planes.plane[1][i] - wanted[1]) +
                fabsf(planes.plane[2][i] - wanted[2]) <
            1e-6F) {
            return true;
        }
    }
    return false;
}

/* Its margin of 1.2 em begins at its place. A row of what is no object has no chip. */
static void a_legend_begins_at_its_place(void **state)
{
    (void)state;
    struct font *font = make_font();
    conus_image *image = make_image(1000, 750);
    struct legend legend = LEGEND;
    legend.at[0] = 500;
    legend.at[1] = 300;
    draw_legend(image, font, &legend);
    const float *opacity = conus_image_floats(image, "A");
    double first[2] = {1000, 750};
    for (size_t i = 0; i < (size_t)1000 * 750; i++) {
        first[0] = opacity[i] > 0 ? fmin(first[0], (double)(i % 1000)) : first[0];
        first[1] = opacity[i] > 0 ? fmin(first[1], floor((double)i / 1000)) : first[1];
    }
    assert_near(first[0], 500 + 1.2 * 14, 2);
    assert_near(first[1], 300 + 1.2 * 14 + 0.45 * 14, 4); /* and what is above letters in a line */
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(has_colour(image, ROWS[i].rgb), !ROWS[i].plain);
    }
    conus_image_destroy(image);
    font_destroy(font);
}

/* Letters have the ink; those of a row of no object and of a heading 0.87 of it. Black ones on white are not to be
 * seen in channels, so they are white on nothing here. */
static void plain_rows_and_headings_are_dim(void **state)
{
    (void)state;
    struct font *font = make_font();
    for (int dim = 0; dim < 3; dim++) {
        conus_image *image = make_image(1000, 750);
        const struct legend_row row = {.plain = dim == 1, .heading = dim == 2, .name = "HHHH"};
        float most = 0;
        draw_legend(image, font, &(struct legend){.rows = &row, .count = 1, .size = 40, .ink = WHITE});
        for (size_t i = 0; i < (size_t)1000 * 750; i++) {
            most = fmaxf(most, image_rgba(image).plane[3][i] * (image_rgba(image).plane[0][i] > 0));
        }
        assert_near((double)most, dim ? 0.87 : 1, 0.01);
        conus_image_destroy(image);
    }
    font_destroy(font);
}

/* A chip of 0.78 of 100 pixels has stripes of 22 pixels in every 45, along its diagonal from the upper left. Black ones
 * are 0.3 between them (0.16 of their colour and 0.3): 0.15 on average, but for what is no whole stripe. */
static void stripes_go_down_to_the_right(void **state)
{
    (void)state;
    enum { LEFT = 120, SIDE = 78, WIDTH = 600 }; /* a margin of 1.2 em */
    struct font *font = make_font();
    conus_image *image = make_image(WIDTH, WIDTH);
    const struct legend_row row = {.striped = true, .name = ""};
    double sum = 0;
    draw_legend(image, font, &(struct legend){.rows = &row, .count = 1, .size = 100, .ink = WHITE});
    const float *red = image_rgba(image).plane[0];
    size_t top = LEFT; /* of the row, in which the chip begins farther down */
    while (top < WIDTH - SIDE && red[top * WIDTH + LEFT + SIDE / 2] == red[(top + 1) * WIDTH + LEFT + SIDE / 2]) {
        top++;
    }
    for (size_t y = top + 20; y < top + 50; y++) {
        for (size_t x = LEFT + 1; x < LEFT + SIDE - 1; x++) {
            sum += (double)red[y * WIDTH + x];
            assert_true(x < LEFT + 10 || fabsf(red[y * WIDTH + x] - red[(y - 5) * WIDTH + x - 5]) < 0.01F);
        }
    }
    assert_near(sum / (30 * (SIDE - 2)), 0.15, 0.05);
    conus_image_destroy(image);
    font_destroy(font);
}

static void legend_fits_into_any_image(void **state)
{
    (void)state;
    struct font *font = make_font();
    struct legend_row rows[200];
    for (size_t i = 0; i < 200; i++) {
        rows[i] = ROWS[i % 4];
        rows[i].name = i % 5 ? "Anterior part of the superior longitudinal fasciculus, with a very long name" : "x";
    }
    struct legend legend = LEGEND;
    legend.rows = rows;
    for (size_t count = 0; count <= 200; count += 40) {
        legend.columns = count % 3;
        for (uint32_t side = 1; side < 700; side = side * 3 / 2 + 1) {
            conus_image *image = make_image(side, 1 + 700 / side);
            legend.count = count;
            draw_legend(image, font, &legend);
            conus_image_destroy(image);
            image = make_image(1 + 700 / side, side);
            draw_legend(image, font, &legend);
            conus_image_destroy(image);
        }
        conus_image *image = make_image(800, 600);
        draw_legend(image, font, &legend);
        const float *opacity = conus_image_floats(image, "A");
        for (size_t y = 0; y < 600; y++) {
            for (size_t x = 0; x < 800; x++) {
                bool inside = x >= 16 && x < 800 - 16 && y >= 16 && y < 600 - 16; /* 1.2 times 14 pixels */
                assert_true(inside || opacity[y * 800 + x] == 0);
            }
        }
        conus_image_destroy(image);
    }
    font_destroy(font);
}

/* 60 rows, of which 40 do not fit into 300 pixels: a line of letters of 11 pixels takes 1.45 times as many, so that
 * there are at most 18. The tail, three coloured rows below a heading, is shown all the same. A heading has no chip. */
static void a_key_is_shown_below_too_many_rows(void **state)
{
    (void)state;
    static const struct legend_row key[] = {{.rgb = {1, 2, 3}, .heading = true, .name = "Key"},
                                            {.rgb = {255, 0, 0}, .name = "first"},
                                            {.rgb = {0, 255, 0}, .name = "second"},
                                            {.rgb = {0, 0, 255}, .name = "third"}};
    struct font *font = make_font();
    struct legend_row rows[64];
    for (size_t i = 0; i < 64; i++) {
        rows[i] = i < 60 ? (struct legend_row){.rgb = {200, 200, (uint8_t)i}, .name = "row"} : key[i - 60];
    }
    for (size_t tail = 0; tail <= 4; tail += 4) {
        conus_image *image = make_image(400, 300);
        draw_legend(image, font, &(struct legend){.rows = rows, .count = 64, .tail = tail, .size = 11, .ink = INK});
        assert_true(has_colour(image, rows[0].rgb) && !has_colour(image, rows[20].rgb));
        assert_true(has_colour(image, rows[13].rgb) == (tail == 0));
        assert_false(has_colour(image, key[0].rgb));
        for (size_t i = 1; i < 4; i++) {
            assert_true(has_colour(image, key[i].rgb) == (tail > 0));
        }
        conus_image_destroy(image);
    }
    /* without the heading all rows of the tail have a chip: the first of them is shown, too */
    conus_image *image = make_image(400, 300);
    rows[60].heading = false;
    rows[60].rgb[0] = 255;
    rows[60].rgb[2] = 255;
    draw_legend(image, font, &(struct legend){.rows = rows, .count = 64, .tail = 4, .size = 11, .ink = INK});
    for (size_t i = 60; i < 64; i++) {
        assert_true(has_colour(image, rows[i].rgb));
    }
    conus_image_destroy(image);
    font_destroy(font);
}

/* A bar of five marks stays one in as many columns as there may be, with a row before it or alone. */
static void a_bar_never_breaks(void **state)
{
    static const char *const marks[] = {"8.4", "7.1", "5.8", "4.4", "3.1"};
    static const uint8_t ramp[LEGEND_BAR][3] = {{0}};
    struct font *font = make_font();
    struct legend_row rows[7] = {{.name = "act"}, {.name = "by z", .heading = true}};
    (void)state;
    for (size_t i = 0; i < 5; i++) {
        rows[2 + i] = (struct legend_row){.name = marks[i], .mark = true, .bar = i ? ramp : NULL};
    }
    for (size_t columns = 1; columns <= 4; columns++) {
        for (size_t first = 0; first <= 2; first += 2) {
            conus_image *image = make_image(600, 300);
            double size[2];
            double left = NAN;
            size_t seen = 0;
            struct legend legend = {.rows = rows + first, .count = 7 - first, .tail = first ? 0 : 6, .ink = INK};
            legend.columns = columns;
            legend_fit(size, &legend, font, (const double[]){600, 300}, 14, 12);
            legend_draw(image->list, font, &legend);
            for (size_t i = 0; i < image->list->count; i++) {
                const struct draw_item *item = &image->list->items[i];
                if (item->kind == DRAW_TEXT && isdigit(item->text[0])) {
                    left = seen++ ? left : item->points[0][0];
                    assert_near(item->points[0][0], left, 1e-9);
                }
            }
            assert_int_equal(seen, 5);
            conus_image_destroy(image);
        }
    }
    font_destroy(font);
}

static conus_status draw_once(void *data)
{
    (void)data;
    struct font *font = NULL;
    conus_image *image = NULL;
    conus_status status = font_create(&font);
    status = status ? status : image_create_listed(&image, 400, 300);
    if (!status) {
        legend_draw(image->list, font, &LEGEND);
        status = image_paint(image);
    }
    conus_image_destroy(image);
    font_destroy(font);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    font_destroy(make_font());
    test_every_allocation(draw_once, NULL);
}

/* The measured size is what the drawing takes: with the size of letters found and at the place asked for, nothing lies
 * outside of it, and no name ends in an ellipsis, which would make the narrower picture differ from the wide one. */
static void a_legend_that_fits_is_whole(void **state)
{
    (void)state;
    static const struct legend_row rows[] = {
        {.name = "a name that is longer than most of them are", .detail = {"41.1 %", "37.2 mm"}},
        {.name = "short", .detail = {"1.0 %", "9.9 mm"}},
        {.name = "unassigned", .plain = true, .detail = {"0.0 %"}}};
    struct font *font = make_font();
    for (int width = 200; width <= 800; width += 300) {
        const double limit[2] = {width, 400};
        struct legend legend = {
            .title = "Title", .header = {"share"}, .rows = rows, .count = 3, .columns = 2, .at = {31, 17}, .ink = INK};
        double size[2];
        legend_fit(size, &legend, font, limit, 20, 2);
        assert_true(size[0] <= limit[0] && size[1] <= limit[1] && legend.size <= 20);
        assert_true(legend.size < 20 || width == 800);
        assert_int_equal(legend.columns, 1); /* two would have smaller letters */
        conus_image *narrow = make_image((uint32_t)ceil(31 + size[0]), (uint32_t)ceil(17 + size[1]));
        conus_image *wide = make_image(1600, 800);
        draw_legend(narrow, font, &legend);
        draw_legend(wide, font, &legend);
        assert_true(inked(narrow) > 50);
        assert_near(inked(narrow), inked(wide), 1e-3);
        conus_image_destroy(narrow);
        conus_image_destroy(wide);
    }
    font_destroy(font);
}

/* A text of the list; NULL = there is none. */
static const struct draw_item *find_text(const conus_image *image, const char *text)
{
    for (size_t i = 0; i < image->list->count; i++) {
        const struct draw_item *item = &image->list->items[i];
        if (item->kind == DRAW_TEXT && strcmp(item->text, text) == 0) {
            return item;
        }
    }
    return NULL;
}

/* Seven rows and a key of three lines in up to four columns: the rows go down each column, the key stays together, so
 * that columns of three lines are too few (three, three, one and the key) and four columns take three lines. In the
 * height of two lines and a half there are two of each: six rows, of which the fifth and sixth leave for a line that
 * counts what is left out, and the first line of the key. */
static void rows_go_down_columns(void **state)
{
    (void)state;
    static const struct legend_row rows[] = {
        {.name = "1"},   {.name = "2"},   {.name = "3"}, {.name = "4"},
        {.name = "5"},   {.name = "6"},   {.name = "7"}, {.name = "Key", .heading = true},
        {.name = "low"}, {.name = "high"}};
    static const size_t columns[] = {0, 0, 0, 1, 1, 1, 2, 3, 3, 3};
    static const size_t lines[] = {0, 1, 2, 0, 1, 2, 0, 0, 1, 2};
    struct font *font = make_font();
    struct legend legend = {.rows = rows, .count = 10, .tail = 3, .columns = 4, .ink = INK};
    double size[2];
    legend_fit(size, &legend, font, (const double[]){400, 400}, 10, 10);
    assert_int_equal(legend.columns, 4);
    assert_near(size[1], (3 * 1.45 + 2.4) * 10 + 1, 1e-9);
    conus_image *image = make_image(400, 400);
    legend_draw(image->list, font, &legend);
    const double *origin = find_text(image, "1")->points[0];
    const double step = find_text(image, "4")->points[0][0] - origin[0];
    assert_true(step > 22);
    for (size_t i = 0; i < 10; i++) {
        const struct draw_item *item = find_text(image, rows[i].name);
        const double indent = rows[i].heading ? -12.8 : 0; /* as wide as a chip and what is beside it */
        assert_near(item->points[0][0], origin[0] + (double)columns[i] * step + indent, 1e-9);
        assert_near(item->points[0][1], origin[1] + 14.5 * (double)lines[i], 1);
    }
    conus_image_destroy(image);
    image = make_image(400, (uint32_t)((2.5 * 1.45 + 2.4) * 10));
    legend_draw(image->list, font, &legend);
    assert_non_null(find_text(image, "and 3 others"));
    assert_true(find_text(image, "4") && !find_text(image, "5") && find_text(image, "high"));
    conus_image_destroy(image);
    font_destroy(font);
}

/* Each column is as wide as its own names: a chip, what is beside it, and the longest; 2.2 em lie between columns, 1.2
 * on either side. In a width of one pixel less there is one column fewer. */
static void columns_are_as_wide_as_their_names(void **state)
{
    (void)state;
    static const struct legend_row rows[] = {{.name = "a name as wide as three of the others, or wider"},
                                             {.name = "b"},
                                             {.name = "column"},
                                             {.name = "c"},
                                             {.name = "third"},
                                             {.name = "d"}};
    struct font *font = make_font();
    double left[4] = {12}; /* of each column */
    for (size_t n = 0; n < 3; n++) {
        left[n + 1] = left[n] + (0.78 + 0.5 + 2.2) * 10 + font_width(font, 10, rows[2 * n].name);
    }
    const double whole = left[3] - 22 + 12 + 1;
    for (int less = 0; less < 2; less++) {
        struct legend legend = {.rows = rows, .count = 6, .columns = 3, .ink = INK};
        double size[2];
        legend_fit(size, &legend, font, (const double[]){whole - less, 400}, 10, 10);
        assert_int_equal(legend.columns, 3 - less);
        assert_true(less || fabs(size[0] - whole) < 1e-9);
        conus_image *image = make_image((uint32_t)ceil(whole), 100);
        legend_draw(image->list, font, &legend);
        for (size_t i = 0; i < 6; i++) {
            const struct draw_item *item = find_text(image, rows[i].name);
            assert_non_null(item);
            if (less == 0) {
                assert_near(item->points[0][0], left[i / 2] + 12.8, 1e-9);
            }
        }
        conus_image_destroy(image);
    }
    font_destroy(font);
}

/* Sixteen rows in the height of three lines: the more columns the more rows, and the columns that are chosen are as
 * wide as what is shown in them, not as the long name that is left out. */
static void what_is_left_out_takes_no_width(void **state)
{
    (void)state;
    struct legend_row rows[16];
    struct font *font = make_font();
    for (size_t i = 0; i < 16; i++) {
        rows[i] = (struct legend_row){.name = i < 15 ? "row" : "a name that has no place, and is longer than any row"};
    }
    const double width = 4 * (12.8 + font_width(font, 10, "row")) + 3 * 22 + 24 + 1;
    const double more = font_width(font, 10, "and 5 others") - font_width(font, 10, "row");
    const double limit[2] = {width + more, (3.1 * 1.45 + 2.4) * 10};
    struct legend legend = {.rows = rows, .count = 16, .columns = 16, .ink = INK};
    double size[2];
    legend_fit(size, &legend, font, limit, 10, 10);
    assert_int_equal(legend.columns, 4);
    assert_near(size[0], limit[0], 1e-9);
    assert_near(size[1], (4 * 1.45 + 2.4) * 10 + 1, 1e-9); /* what all would take */
    conus_image *image = make_image((uint32_t)ceil(limit[0]), (uint32_t)ceil(limit[1]));
    legend_draw(image->list, font, &legend);
    assert_non_null(find_text(image, "and 5 others"));
    conus_image_destroy(image);
    font_destroy(font);
}

TEST_GROUP(legend)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_cover_their_area),
        cmocka_unit_test(shapes_are_cut_off_at_the_border),
        cmocka_unit_test(colours_are_laid_over),
        cmocka_unit_test(text_has_a_width_that_adds_up),
        cmocka_unit_test(text_is_drawn_in_its_place),
        cmocka_unit_test(long_text_ends_in_an_ellipsis),
        cmocka_unit_test(a_legend_begins_at_its_place),
        cmocka_unit_test(plain_rows_and_headings_are_dim),
        cmocka_unit_test(stripes_go_down_to_the_right),
        cmocka_unit_test(legend_fits_into_any_image),
        cmocka_unit_test(a_key_is_shown_below_too_many_rows),
        cmocka_unit_test(a_bar_never_breaks),
        cmocka_unit_test(every_failing_allocation_is_survived),
        cmocka_unit_test(a_legend_that_fits_is_whole),
        cmocka_unit_test(rows_go_down_columns),
        cmocka_unit_test(columns_are_as_wide_as_their_names),
        cmocka_unit_test(what_is_left_out_takes_no_width),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
