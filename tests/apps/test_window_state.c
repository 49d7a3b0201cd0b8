/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the state that the window keeps from one run to the next (its place, the size of its text, the files that
 * were opened last), and of its start page. */
#include "base/memory.h"
#include "viewer/ui/ui.h"
#include "viewer/window/start.h"
#include "viewer/window/window.h"

#include "conus/own.h"
#include "test.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Finds the path of a file of the window's state, in a folder of this run. */
static void find_state(char path[SYSTEM_PATH], const char *name)
{
    char here[512];
    assert_non_null(getcwd(here, sizeof here)); /* relative ones do not count */
    snprintf(path, SYSTEM_PATH, "%s/%s", here, test_scratch("state"));
    setenv("XDG_STATE_HOME", path, 1);
    snprintf(path, SYSTEM_PATH, "%s/%s/conus/%s", here, test_scratch("state"), name);
}

static void assert_same_place(const struct place *a, const struct place *b)
{
    const int found[] = {a->width, a->height, a->x, a->y, a->known};
    const int wanted[] = {b->width, b->height, b->x, b->y, b->known};
    assert_memory_equal(found, wanted, sizeof found);
    assert_near(a->zoom, b->zoom, 1e-12);
    for (size_t i = 0; i < 2; i++) {
        assert_near(a->layout.panels[i], b->layout.panels[i], 1e-12);
        assert_near(a->layout.division[i], b->layout.division[i], 1e-12);
        assert_int_equal(a->layout.folds[i], b->layout.folds[i]);
    }
}

static void the_window_finds_its_place_again(void **state)
{
    const struct place left = {.width = 900,
                               .height = 700,
                               .known = true,
                               .x = 11,
                               .y = -22,
                               .zoom = 1.25,
                               .layout = {.panels = {300, 0}, .division = {0.25, 0}, .folds = {FOLD_OPEN, 0}}};
    struct place found = {.width = 1, .height = 2};
    char path[SYSTEM_PATH];
    (void)state;
    find_state(path, "window.json");
    place_load(&found);
    assert_int_equal(found.width, 1);
    place_save(&left);
    place_load(&found);
    assert_same_place(&found, &left);
    place_save(&(struct place){.width = 1, .height = 700}); /* one that nobody could use */
    place_load(&found);
    assert_int_equal(found.width, 900);
    static const char *const bad[] = {"",
                                      "{}",
                                      "[1]",
                                      "{\"width\": 900, \"height\": 1e9, \"x\": 0, \"y\": 0}",
                                      "{\"width\": 99999, \"height\": 700, \"x\": 0, \"y\": 0}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"zoom\": 9}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"zoom\": \"1\"}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"panels\": [9, 0]}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"panels\": [300]}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"division\": [0, 1]}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"folds\": [0, 3]}",
                                      "{\"width\": \"900\", \"height\": 700, \"x\": 0, \"y\": 0}"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        found = (struct place){.width = 5};
        assert_ok(conus_write_file(path, bad[i], strlen(bad[i])));
        place_load(&found);
        assert_int_equal(found.width, 5);
        assert_false(found.known);
    }
}

static void a_window_fits_its_screen(void **state)
{
    static const int area[4] = {100, 30, 1280, 770};
    static const struct {
        struct place before, after;
    } cases[] = {
        {{.width = 900, .height = 700, .x = 150, .y = 40}, {.width = 900, .height = 700, .x = 150, .y = 40}},
        {{.width = 1500, .height = 940, .x = 0, .y = 0}, {.width = 1280, .height = 770, .x = 100, .y = 30}},
        {{.width = 900, .height = 700, .x = 9000, .y = 50}, {.width = 900, .height = 700, .x = 480, .y = 50}},
        {{.width = 900, .height = 700, .x = -900, .y = 900}, {.width = 900, .height = 700, .x = 100, .y = 100}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct place place = cases[i].before;
        place_fit(&place, area);
        assert_same_place(&place, &cases[i].after);
    }
}

static void assert_divides(const struct layout *layout, float width, const float wanted[6])
{
    const struct division d = layout_divide(layout, width, 800, 1);
    const float found[] = {d.left, d.right, d.columns, d.rows, d.column, d.row};
    for (size_t i = 0; i < 6; i++) {
        assert_near(found[i], wanted[i], 0);
    }
}

/* The widths of panes at 1280 pixels: the left rail takes 48, the right panel three tenths, 384. 848 are left, of which
 * 3-D takes 0.72, 610, and the first cut a third of the height, 266 of 800. A panel that the user widens has two fifths
 * at most: 512 of 1280. */
static void panes_and_panels_are_as_the_user_left_them(void **state)
{
    struct layout layout = {.panels = {0}};
    (void)state;
    assert_divides(&layout, 1280, (const float[]){48, 384, 848, 800, 610, 266});
    layout_move(&layout, BORDER_LEFT, 300, 1280, 800, 1);
    layout_move(&layout, BORDER_RIGHT, 880, 1280, 800, 1); /* 400 wide; 580 are left for the columns */
    layout_move(&layout, BORDER_COLUMN, 300 + 145, 1280, 800, 1);
    layout_move(&layout, BORDER_ROW, 600, 1280, 800, 1);
    assert_divides(&layout, 1280, (const float[]){300, 400, 580, 800, 145, 600});
    assert_divides(&layout, 500, (const float[]){200, 200, 100, 800, 25, 600}); /* a panel has two fifths at most */
    assert_true(layout_is_fine(&layout));
    layout_reset(&layout, BORDER_COLUMN);
    layout_reset(&layout, BORDER_RIGHT);
    assert_divides(&layout, 1280, (const float[]){300, 384, 596, 800, 429, 600});
    layout_move(&layout, BORDER_LEFT, -50, 1280, 800, 1);
    layout_move(&layout, BORDER_RIGHT, 0, 1280, 800, 1);
    layout_move(&layout, BORDER_COLUMN, 0, 1280, 800, 1);
    layout_move(&layout, BORDER_ROW, 800, 1280, 800, 1);
    assert_divides(&layout, 1280, (const float[]){240, 512, 528, 800, 52, 720}); /* a tenth of 528, and nine of 800 */
    assert_true(layout_is_fine(&layout));
}

/* A panel is folded to a rail of 48 pixels at scale 1 and opened again, in windows of any width. */
static void panels_fold(void **state)
{
    struct layout layout = {.panels = {0}};
    (void)state;
    assert_divides(&layout, 2000, (const float[]){250, 480, 1270, 800, 914, 266}); /* it is wide: both are open */
    layout_fold(&layout, 0, true);
    layout_fold(&layout, 1, true);
    assert_divides(&layout, 2000, (const float[]){48, 48, 1904, 800, 1370, 266});
    layout_fold(&layout, 0, false);
    assert_divides(&layout, 1280, (const float[]){250, 48, 982, 800, 707, 266});
    assert_true(layout_is_fine(&layout));
    layout.folds[0] = FOLD_COUNT;
    assert_false(layout_is_fine(&layout));
}

/* A key moves the border of the middle by a twentieth, and that of each open panel by 20 pixels. */
static void keys_divide_the_window(void **state)
{
    struct layout layout = {.panels = {0}};
    (void)state;
    layout_widen_first(&layout, 1);
    assert_divides(&layout, 1280, (const float[]){48, 384, 848, 800, 652, 266}); /* 0.77 of 848 */
    layout_widen_panels(&layout, 1, 1280, 1);
    assert_divides(&layout, 1280, (const float[]){48, 404, 828, 800, 637, 266}); /* a rail stays */
    layout_widen_panels(&layout, -1, 1280, 1);
    assert_divides(&layout, 1280, (const float[]){48, 384, 848, 800, 652, 266});
    for (int i = 0; i < 20; i++) {
        layout_widen_first(&layout, -1);
    }
    assert_true(layout_is_fine(&layout));
}

/* Inches are 25.4 mm: 1920 pixels on 344 mm are 141.8 to the inch, 1.477 times 96; 3840 on 294 mm 331.8, 3.46 times;
 * 2560 on 597 mm 108.9, 1.13 times. */
static void texts_are_as_large_as_the_screen_is_dense(void **state)
{
    (void)state;
    assert_near(place_scale(1, 1920, 344), 1.25, 0);
    assert_near(place_scale(1, 3840, 294), 3, 0);
    assert_near(place_scale(1, 2560, 597), 1, 0);
    assert_near(place_scale(1, 1280, 1280), 1, 0); /* a wall */
    assert_near(place_scale(1, 1920, 0), 1, 0);    /* it does not say */
    assert_near(place_scale(1, 1920, 16), 1, 0);   /* 16 x 9 cm in cm, as some say */
    assert_near(place_scale(2, 1920, 600), 2, 0);  /* the desktop knows */
}

static const char three[] = "{\"conus_recent\": 1, \"atlases\": [\"/a\", \"/b/\\u001b.nii\", \"/c,volume=2\"]}";

/* A list is read only as it was written: a part of it, another form, and a path that is relative or too long are
 * refused. */
static void only_a_whole_list_is_read(void **state)
{
    static const char *const bad[] = {
        "[]",
        "{}",
        "{\"conus_recent\": 1}",
        "{\"conus_recent\": 2, \"atlases\": []}",
        "{\"conus_recent\": 1, \"atlases\": {}}",
        "{\"conus_recent\": 1, \"atlases\": [], \"more\": 1}",
        "{\"conus_recent\": 1, \"atlases\": [], \"atlases\": []}",
        "{\"conus_recent\": 1, \"atlases\": [\"a\"]}",
        "{\"conus_recent\": 1, \"atlases\": [\"/a\", \"\"]}",
        "{\"conus_recent\": 1, \"atlases\": [\"/a\", 5]}",
        "{\"conus_recent\": 1, \"atlases\": [\"/a\\u0000b\"]}",
        "{\"conus_recent\":1,\"atlases\":[\"/\",\"/\",\"/\",\"/\",\"/\",\"/\",\"/\",\"/\",\"/\"]}"};
    struct recent recent = {.count = 5};
    (void)state;
    for (size_t size = 0; size < strlen(three); size++) {
        assert_false(recent_parse(&recent, three, size));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(recent_parse(&recent, bad[i], strlen(bad[i])));
    }
    assert_int_equal(recent.count, 5);
    assert_true(recent_parse(&recent, three, strlen(three)));
    assert_int_equal(recent.count, 3);
    assert_string_equal(recent.paths[1], "/b/\x1b.nii");
    assert_string_equal(recent.paths[2], "/c,volume=2");
    for (int length = SYSTEM_PATH - 1; length <= SYSTEM_PATH; length++) { /* the longest, and one more */
        char text[SYSTEM_PATH + 64];
        int size = snprintf(text, sizeof text, "{\"conus_recent\": 1, \"atlases\": [\"/%0*d\"]}", length - 1, 0);
        assert_int_equal(recent_parse(&recent, text, (size_t)size), length < SYSTEM_PATH);
    }
}

static void the_last_opened_comes_first(void **state)
{
    struct recent recent;
    char path[SYSTEM_PATH];
    char here[SYSTEM_PATH];
    (void)state;
    find_state(path, "recent.json");
    recent_load(&recent);
    assert_int_equal(recent.count, 0);
    recent_add("/\xff"); /* no UTF-8 */
    recent_add("/folder//");
    recent_load(&recent);
    assert_int_equal(recent.count, 1);
    assert_string_equal(recent.paths[0], "/folder");
    for (int i = 1; i <= RECENT_LIMIT; i++) {
        snprintf(path, sizeof path, "/%d", i);
        recent_add(path);
    }
    recent_add("/3");
    recent_load(&recent);
    assert_int_equal(recent.count, RECENT_LIMIT); /* 3 8 7 6 5 4 2 1 */
    assert_string_equal(recent.paths[0], "/3");
    assert_string_equal(recent.paths[1], "/8");
    assert_string_equal(recent.paths[5], "/4");
    assert_string_equal(recent.paths[6], "/2");
    assert_string_equal(recent.paths[7], "/1");
    recent_add("./b.nii");
    recent_load(&recent);
    assert_non_null(getcwd(here, sizeof here));
    assert_memory_equal(recent.paths[0], here, strlen(here));
    assert_string_equal(recent.paths[0] + strlen(here), "/b.nii");
    assert_string_equal(recent.paths[7], "/2");
    find_state(path, "recent.json");
    assert_ok(conus_write_file(path, three, strlen(three) - 1)); /* damaged: it begins anew */
    recent_add("/a");
    recent_load(&recent);
    assert_int_equal(recent.count, 1);
}

/* The picture has 900 x 620 pixels, so each of the thumbnail's 400 x 300 is the mean of those that it touches of the
 * middle's 827 x 620, 2.07 a side: with red = x / 4 and green = y / 4 its first pixel has those at 36 to 38 and 0 to 2,
 * its last those at 860 to 862 and 617 to 619: red 9 and 215, green 0 and 154. */
static void a_picture_of_an_atlas_is_kept_by_its_name_and_size(void **state)
{
    static uint8_t rgba[620][900][4];
    static struct thumbnail kept;
    const struct painted picture = {.width = 900, .height = 620, .rgba = rgba[0][0]};
    char path[SYSTEM_PATH];
    char atlas[SYSTEM_PATH];
    size_t size;
    (void)state;
    for (size_t y = 0; y < 620; y++) {
        for (size_t x = 0; x < 900; x++) {
            memcpy(rgba[y][x], (const uint8_t[]){(uint8_t)(x / 4), (uint8_t)(y / 4), 7, 255}, 4);
        }
    }
    find_state(path, "pictures/pair.nii");
    snprintf(atlas, sizeof atlas, "%s", test_scratch("pair.nii"));
    assert_ok(conus_write_file(atlas, "atlas", 5));
    assert_false(thumbnail_load(&kept, atlas));
    thumbnail_keep(atlas, 116, &picture);
    assert_true(thumbnail_load(&kept, atlas));
    assert_int_equal(kept.areas, 116);
    assert_memory_equal(kept.rgba[0][0], ((const uint8_t[]){9, 0, 7, 255}), 4);
    assert_memory_equal(kept.rgba[THUMBNAIL_HEIGHT - 1][THUMBNAIL_WIDTH - 1], ((const uint8_t[]){215, 154, 7, 255}), 4);
    char *text = state_file_read(&size, "pictures/pair.nii", 1 << 20);
    assert_non_null(text);
    assert_int_equal(size, strlen("conus_picture 1 0000000000000005 00000074\n") + 4 * 400 * 300);
    assert_memory_equal(text, "conus_picture 1 0000000000000005 00000074\n", 42); /* 0x74 = 116 */
    for (size_t part = 0; part < size; part++) {
        assert_false(thumbnail_parse(&kept, 5, text, part));
    }
    for (size_t at = 0; at < 42; at++) { /* nothing but what is written so, which areas are, too, in small letters */
        char before = text[at];
        text[at] = at >= 33 && at < 41 ? 'A' : '!';
        assert_false(thumbnail_parse(&kept, 5, text, size));
        text[at] = before;
    }
    assert_false(thumbnail_parse(&kept, 6, text, size));
    assert_true(thumbnail_parse(&kept, 5, text, size));
    free(text);
    thumbnail_keep(atlas, 1, &(struct painted){.width = 95, .height = 150, .rgba = rgba[0][0]}); /* it is too small */
    assert_true(thumbnail_load(&kept, atlas));
    assert_int_equal(kept.areas, 116);
    assert_ok(conus_write_file(atlas, "another", 7));
    assert_false(thumbnail_load(&kept, atlas));
}

static void atlases_of_animals_say_so(void **state)
{
    (void)state;
    assert_non_null(strstr(installed_about("inia19-NeuroMaps"), "macaque"));
    assert_non_null(strstr(installed_about("D99_atlas_v2.0"), "macaque"));
    assert_non_null(strstr(installed_about("CCFv3_annotation"), "mouse"));
    assert_non_null(strstr(installed_about("aal"), "human"));
    assert_null(installed_about("ini"));
}

static void the_start_page_shows_no_escapes(void **state)
{
    struct start start = {.typed = "~/a~/b"};
    char words[SYSTEM_PATH];
    char path[SYSTEM_PATH];
    (void)state;
    find_state(path, "recent.json");
    assert_ok(conus_write_file(path, three, strlen(three)));
    setenv("XDG_DATA_DIRS", "relative:/none", 1);
    start_look(&start);
    assert_string_equal(start_path(&start, 1), "/b/\x1b.nii");
    assert_string_equal(start_words(words, &start, 1), " .nii");
    assert_string_equal(words, "/b/ .nii");
    assert_null(start_path(&start, 3));
    setenv("HOME", "/home/me", 1);
    assert_true(start_typed(path, &start));
    assert_string_equal(path, "/home/me/a~/b");
    memcpy(start.typed, "~a", 3);
    assert_true(start_typed(path, &start));
    assert_string_equal(path, "~a");
    start.typed[0] = '\0';
    assert_false(start_typed(path, &start));
    start_finish(&start);
}

/* The start page finds the atlases of $CONUS_ATLAS_PATH: nested, slabs and sphere, in this order, and no others. */
static void look_for_three(struct start *start)
{
    static const char *const kinds[] = {"nested", "slabs", "sphere"};
    char state[SYSTEM_PATH];
    char here[512];
    char folder[1200];
    find_state(state, "recent.json");
    remove(state);
    assert_non_null(getcwd(here, sizeof here));
    snprintf(folder, sizeof folder, "%s/%s", here, test_scratch("atlases"));
    for (size_t i = 0; i < 3; i++) {
        assert_ok(conus_phantom_write(kinds[i], folder, NULL));
    }
    setenv("CONUS_ATLAS_PATH", folder, 1);
    setenv("XDG_DATA_DIRS", "/none", 1);
    start_look(start);
    assert_true(conus_catalogue_count(start->catalogue) >= 3); /* own ones come first */
}

static void assert_opens(struct start *start, const char *typed, const char *wanted)
{
    char path[SYSTEM_PATH];
    snprintf(start->typed, sizeof start->typed, "%s", typed);
    assert_true(start_typed(path, start));
    assert_string_equal(path, wanted);
}

static void typed_words_find_an_installed_atlas(void **state)
{
    struct start start = {.on = true};
    (void)state;
    look_for_three(&start);
    assert_opens(&start, "sla", "slabs");
    assert_opens(&start, "OWN sph", "sphere");
    assert_opens(&start, "e", "nested"); /* the first of two */
    start_move(&start, 1);
    assert_opens(&start, "e", "sphere"); /* slabs has no e */
    start_move(&start, -1);
    start_move(&start, -1);
    assert_opens(&start, "e", "nested"); /* the first stays the first */
    assert_opens(&start, "own:slabs", "slabs");
    assert_opens(&start, "no such atlas", "no such atlas"); /* so that opening it reports the reason */
    assert_opens(&start, "./e", "./e");
    assert_opens(&start, "/e", "/e");
    start_finish(&start);
}

/* The two files of slabs are equal, those of nested differ. */
static void an_atlas_in_two_places_is_offered_once(void **state)
{
    struct start start = {.on = true};
    char here[512];
    char folders[2][1200];
    char both[2402];
    const conus_phantom_options smaller = {.size = 16};
    size_t twins = 0;
    (void)state;
    assert_non_null(getcwd(here, sizeof here));
    for (size_t i = 0; i < 2; i++) {
        snprintf(folders[i], sizeof folders[i], "%s/%s", here, test_scratch(i ? "second" : "first"));
        assert_ok(conus_phantom_write("slabs", folders[i], NULL));
        assert_ok(conus_phantom_write("nested", folders[i], i ? &smaller : NULL));
    }
    snprintf(both, sizeof both, "%s:%s", folders[0], folders[1]);
    setenv("CONUS_ATLAS_PATH", both, 1);
    setenv("XDG_DATA_DIRS", "/none", 1);
    start_look(&start);
    for (size_t i = 0; i < conus_catalogue_count(start.catalogue); i++) {
        const conus_installed *atlas = conus_catalogue_atlas(start.catalogue, i);
        bool is = installed_is_twin(start.catalogue, i);
        assert_true(!is || (strcmp(atlas->name, "slabs") == 0 && strstr(atlas->path, "second")));
        twins += is;
    }
    assert_int_equal(twins, 1);
    start_finish(&start);
}

/* What was opened before is not offered once more below, unless something is typed. */
static void an_installed_atlas_that_was_opened_is_listed_once(void **state)
{
    struct start start = {.on = true};
    (void)state;
    look_for_three(&start);
    recent_add(conus_catalogue_atlas(start.catalogue, 1)->path);
    start_look(&start);
    assert_ptr_equal(start_installed(&start, start_path(&start, 0)), conus_catalogue_atlas(start.catalogue, 1));
    assert_true(start_lists(&start, 0));
    assert_false(start_lists(&start, 1));
    start_move(&start, 1);
    start_move(&start, 1);
    assert_opens(&start, "", "sphere");
    assert_opens(&start, "sla", "slabs");
    assert_true(start_lists(&start, 1));
    start_finish(&start);
}

/* The source is written before the name where a file of that name is in the working folder. */
static void an_atlas_of_the_list_is_opened_and_no_file_of_its_name(void **state)
{
    struct start start = {.on = true};
    char words[SYSTEM_PATH];
    (void)state;
    look_for_three(&start);
    const conus_installed *slabs = conus_catalogue_atlas(start.catalogue, 1);
    assert_true(installed_words(words, start.catalogue, slabs));
    assert_string_equal(words, "slabs");
    assert_ok(conus_write_file("slabs", "", 0));
    assert_true(installed_words(words, start.catalogue, slabs));
    assert_string_equal(words, "own:slabs");
    assert_ok(conus_write_file("own:slabs", "", 0));
    assert_true(installed_words(words, start.catalogue, slabs));
    assert_string_equal(words, slabs->path);
    assert_opens(&start, "slabs", "slabs"); /* a typed name means the file */
    remove("slabs");
    remove("own:slabs");
    start_finish(&start);
}

/* A link puts one file into two places, beside which other files may lie. The name alone means the first place. */
static void a_link_to_an_atlas_is_opened_where_it_is(void **state)
{
    struct start start = {.on = true};
    char words[SYSTEM_PATH];
    char here[512];
    char data[1200];
    char link[1300];
    size_t links = 0;
    (void)state;
    look_for_three(&start);
    test_folder("data");
    test_folder("data/mricron");
    test_folder("data/mricron/templates");
    assert_non_null(getcwd(here, sizeof here));
    snprintf(data, sizeof data, "%s/%s", here, test_scratch("data"));
    snprintf(link, sizeof link, "%s/mricron/templates/slabs.nii.gz", data);
    assert_int_equal(symlink(conus_catalogue_atlas(start.catalogue, 1)->path, link), 0);
    setenv("XDG_DATA_HOME", data, 1);
    start_look(&start);
    for (size_t i = 0; i < conus_catalogue_count(start.catalogue); i++) {
        const conus_installed *atlas = conus_catalogue_atlas(start.catalogue, i);
        if (strcmp(atlas->name, "slabs") == 0) {
            assert_true(installed_words(words, start.catalogue, atlas));
            bool is_link = strcmp(atlas->path, link) == 0;
            assert_string_equal(words, is_link ? "mricron:slabs" : "slabs");
            links += is_link;
        }
    }
    assert_int_equal(links, 1);
    unsetenv("XDG_DATA_HOME");
    start_finish(&start);
}

static void the_arrows_choose_on_an_empty_line(void **state)
{
    struct start start = {.on = true};
    char path[SYSTEM_PATH];
    (void)state;
    look_for_three(&start);
    assert_false(start_typed(path, &start));
    start_move(&start, 1);
    assert_opens(&start, "", "nested");
    start_move(&start, 1);
    assert_opens(&start, "", "slabs");
    start_finish(&start);
    assert_false(start_typed(path, &start)); /* without a list */
}

static void without_an_atlas_a_phantom_is_the_sample(void **state)
{
    struct start start = {.on = true};
    char path[SYSTEM_PATH];
    char again[SYSTEM_PATH];
    (void)state;
    look_for_three(&start);
    assert_true(start.has_no_sample);
    assert_string_equal(start.found, "");
    assert_true(start_sample(path));
    assert_int_equal(access(path, R_OK), 0);
    assert_true(start_sample(again));
    assert_string_equal(again, path);
    start_finish(&start);
}

/* Answers of the desktop portal as gdbus prints them; it prints none if it fails. */
static void the_theme_is_the_desktops(void **state)
{
    static const struct {
        const char *answer;
        enum theme theme;
    } cases[] = {{"'(<<uint32 1>>,)'", THEME_DARK},
                 {"'(<<uint32 2>>,)'", THEME_LIGHT},
                 {"'(<<uint32 0>>,)'", THEME_LIGHT}, /* GNOME says this where it is light */
                 {"", THEME_DARK},
                 {"nonsense", THEME_DARK}};
    char path[SYSTEM_PATH];
    char script[SYSTEM_PATH];
    (void)state;
    const char *before = getenv("PATH");
    test_folder("desktop");
    snprintf(script, sizeof script, "%s", test_in("gdbus"));
    assert_non_null(realpath(test_in(""), path));
    char *both = NULL;
    assert_true(asprintf(&both, "%s:%s", path, before) > 0);
    char *kept = strdup(before);
    setenv("PATH", both, 1);
    setenv("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nowhere", 1);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[128];
        int size = snprintf(text, sizeof text, "#!/bin/sh\necho %s\n", cases[i].answer);
        assert_ok(conus_write_file(script, text, (size_t)size));
        assert_int_equal(chmod(script, 0755), 0);
        assert_int_equal(desktop_theme(), cases[i].theme);
    }
    unsetenv("DBUS_SESSION_BUS_ADDRESS");
    assert_int_equal(desktop_theme(), THEME_DARK); /* without a bus the portal is not asked */
    setenv("PATH", kept, 1);
    free(both);
    free(kept);
}

/* Texts twice as large: three tenths of 1280 pixels are 192 of theirs, too few for a name. Beside a rail the panel of
 * hits has 240 of theirs, 480, which is three eighths of the window, and not more: in one that is a pixel narrower it
 * has its three tenths, as beside the open list of areas, which has a quarter. At scale 1.5, where three tenths are
 * 256, nothing changes. */
static void the_panel_of_hits_has_room_for_names_where_texts_are_large(void **state)
{
    const struct layout folded = {.panels = {0}};
    const struct layout open = {.folds = {FOLD_OPEN}};
    (void)state;
    assert_near(layout_divide(&folded, 1280, 800, 2).right, 480, 0);
    assert_near(layout_divide(&folded, 1280, 800, 1.5F).right, 384, 0);
    assert_near(layout_divide(&folded, 1920, 1080, 2).right, 576, 0);
    assert_near(layout_divide(&folded, 1279, 800, 2).right, 383, 0);
    assert_near(layout_divide(&open, 1280, 800, 2).left, 320, 0);
    assert_near(layout_divide(&open, 1280, 800, 2).right, 384, 0);
}

TEST_GROUP(window_state)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_window_finds_its_place_again),
        cmocka_unit_test(a_window_fits_its_screen),
        cmocka_unit_test(panes_and_panels_are_as_the_user_left_them),
        cmocka_unit_test(the_panel_of_hits_has_room_for_names_where_texts_are_large),
        cmocka_unit_test(panels_fold),
        cmocka_unit_test(keys_divide_the_window),
        cmocka_unit_test(texts_are_as_large_as_the_screen_is_dense),
        cmocka_unit_test(only_a_whole_list_is_read),
        cmocka_unit_test(the_last_opened_comes_first),
        cmocka_unit_test(a_picture_of_an_atlas_is_kept_by_its_name_and_size),
        cmocka_unit_test(atlases_of_animals_say_so),
        cmocka_unit_test(the_start_page_shows_no_escapes),
        cmocka_unit_test(typed_words_find_an_installed_atlas),
        cmocka_unit_test(an_atlas_in_two_places_is_offered_once),
        cmocka_unit_test(an_installed_atlas_that_was_opened_is_listed_once),
        cmocka_unit_test(an_atlas_of_the_list_is_opened_and_no_file_of_its_name),
        cmocka_unit_test(a_link_to_an_atlas_is_opened_where_it_is),
        cmocka_unit_test(the_arrows_choose_on_an_empty_line),
        cmocka_unit_test(without_an_atlas_a_phantom_is_the_sample),
        cmocka_unit_test(the_theme_is_the_desktops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
