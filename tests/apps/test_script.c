/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of what scripts of the window cannot do, sessions that they cannot open among it: each is said with its line.
 */
#include "viewer/commands/commands.h"

#include "base/memory.h"
#include "conus/own.h"
#include "options/messages.h"
#include "session_words.h"
#include "test.h"
#include "viewer/session/session.h"

#include <fcntl.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char tree[] = "index\tname\tparent_id\n1\tOuter\t20\n300\tInner\t20\n20\tShell\t40\n"
                           "4000000001\tCore\t40\n40\tBall\tn/a\n";

static char folder[400];

static const char *beside(const char *name)
{
    static char path[4][600]; /* so that a few last */
    static unsigned turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

/* Balls with a tree of areas over them, which are a pathway, too, and a context unless there is none; and a cone. */
static void open_scene(struct window *out, struct viewer *viewer, bool has_context)
{
    conus_atlas *atlas = NULL;
    char *aim[] = {"aim", "60", "3", "2", "0", "0", "0"};
    snprintf(folder, sizeof folder, "%s", test_scratch("script"));
    const char *path = beside("nested.nii.gz");
    assert_ok(conus_phantom_write("nested", folder, &(conus_phantom_options){.size = 32}));
    assert_ok(conus_write_file(beside("tree.tsv"), tree, strlen(tree)));
    assert_ok(conus_atlas_load(&atlas, path, &(conus_load_options){.labels = beside("tree.tsv")}));
    assert_ok(conus_atlas_add_pathway(atlas, path, &(conus_pathway_options){.threshold = 0.5, .name = "Tract"}));
    assert_ok(has_context ? conus_atlas_set_context(atlas, path, NULL) : CONUS_OK);
    assert_ok(viewer_create(viewer, &(struct view_source){.atlas = atlas, .path = path}, 1, NULL, NULL, NULL));
    *out = (struct window){.viewer = viewer, .screen.enlarged = -1};
    assert_true(script_do(out, aim, 7));
}

/* What is printed while the script runs, which must fail; free() it. */
static char *said_by(struct window *window, const char *text, size_t size)
{
    struct script *script = NULL;
    int code = EXIT_DONE;
    char *said = calloc(1, 4096);
    assert_ok(conus_write_file(beside("script"), text, size));
    int kept = dup(STDERR_FILENO);
    int file = open(beside("said"), O_RDWR | O_CREAT | O_TRUNC, 0600);
    assert_true(said && dup2(file, STDERR_FILENO) >= 0);
    int loaded = script_load(&script, beside("script"));
    while (!loaded && !script_step(script, window, &code)) {
    }
    script_destroy(script);
    dup2(kept, STDERR_FILENO);
    assert_true(pread(file, said, 4095, 0) >= 0);
    close(file);
    close(kept);
    assert_int_equal(loaded, EXIT_DONE);
    assert_int_equal(code == EXIT_DATA, said[0] != 0);
    return said;
}

static void assert_said(struct window *window, const char *line, const char *text)
{
    char script[1000];
    snprintf(script, sizeof script, "\n%s\n", line);
    char *said = said_by(window, script, strlen(script));
    if (!strstr(said, text) || !strstr(said, "/script:2: ")) {
        fail_msg("%s: said %s, wanted %s", line, said, text);
    }
    free(said);
}

static void what_a_script_cannot_do_is_said_with_its_line(void **state)
{
    static const char *const cases[][2] = {
        {"dance", "script:2: unknown command \"dance\""},
        {"aim 1 2 3", "script:2: aim X Y Z TX TY TZ, or PLACE PLACE is needed"},
        {"aim Xyz 0,0,0", "script:2: aim X Y Z TX TY TZ, or PLACE PLACE is needed"},
        {"angle 180", "script:2: angle DEGREES is needed"},
        {"angle nan", "script:2: angle DEGREES is needed"},
        {"key ctrl", "script:2: key KEY is needed"},
        {"choose Nobody", "script:2: choose NAME is needed"},
        {"aim 1 2 3 4 5 6 7 8 9", "script:2: more than 8 words"},
        {"save", "script:2: save FILE.json is needed"},
        {"head 1 2 3", "script:2: head X Y Z, after screen, or lost is needed"},
        {"screen 0 0 0 0 0 0 1 1", "script:2: screen X Y Z TX TY TZ WIDTH HEIGHT is needed"},
        {"screen 0 0 0 1 0 0 0 1", "script:2: screen X Y Z TX TY TZ WIDTH HEIGHT is needed"},
        {"take-out more.tck", "script:2: take-out FILE that was added is needed"},
        {"side left", "script:2: side both|left|right, of an atlas that has sides is needed"},
        {"export none/hits.tsv", "none/hits.tsv: "},
        {"type a.nii", "script:2: type PATH, on the start page or where a file is chosen is needed"},
        {"ask --range=5,2", "--range"},
        {"ask --level 9", "the area tree has depths 1 to 3"},
        {"ask --level=Shel", "did you mean \"Shell\""},
        {"ask --layers=all --sampling=slices", "needs exact sampling"},
        {"ask --slices=3", "no effect without --sampling slices"},
        {"ask --score=centre+share", "no name of a score"},
        {"ask --score=unoccluded", "needs --layers all"},
        {"ask --angle=3", "--angle"},
        {"ask --segments=x", "for files, not for the window"},
        {"sweep 9 3 1", "from, to and by are needed"},
        {"sweep 1 2", "LOW HIGH STEP"},
        {"jitter 2 1 100", "power of two"},
        {"study x.tsv", "there is no cone to study"},
    };
    struct viewer viewer;
    struct window window;
    (void)state;
    open_scene(&window, &viewer, true);
    char *before = session_text(&window);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (strcmp(cases[i][0], "study x.tsv") == 0) {
            tool_clear(&viewer);
        }
        assert_said(&window, cases[i][0], cases[i][1]);
    }
    assert_true(script_do(&window, (char *[]){"aim", "60", "3", "2", "0", "0", "0"}, 7));
    char *after = session_text(&window);
    assert_string_equal(before, after);
    free(before);
    free(after);
    viewer_finish(&viewer);
}

/* 65536 bytes without the end of the line, and 65537. */
static void lines_have_a_limit(void **state)
{
    struct viewer viewer;
    struct window window;
    char *text = malloc(2 * 65538);
    (void)state;
    open_scene(&window, &viewer, false);
    assert_non_null(text);
    int size = snprintf(text, 2 * 65538, "# %65534d\n# %65535d\n", 1, 2);
    char *said = said_by(&window, text, (size_t)size);
    assert_non_null(strstr(said, "script:2: more than 65536 bytes in a line"));
    free(said);
    free(text);
    viewer_finish(&viewer);
}

static void sessions_that_do_not_fit_are_refused(void **state)
{
    static const char *const cases[][3] = {
        {"thresholds", "[{\"pathway\": \"Fornix\", \"threshold\": 0.5}]",
         "thresholds: that of \"Tract\" is needed, not of \"Fornix\""},
        {"thresholds", "[{\"pathway\": \"Tract\", \"threshold\": -1}]", "thresholds: Tract: a number from 0 to "},
        {"thresholds", "[{\"pathway\": \"Tract\", \"threshold\": \"1\"}]", "thresholds: Tract: a number from 0 to "},
        {"thresholds", "[]", "thresholds: that of \"Tract\" is needed"},
        {"thresholds", "5", "thresholds: that of \"Tract\" is needed"},
        {"thresholds", "[{\"pathway\": \"Tract\", \"threshold\": 0.5}, {\"pathway\": \"Tract\", \"threshold\": 0.5}]",
         "thresholds: a list of 1, one for each pathway, is needed"},
        {"safe_colours", "1", "safe_colours: true or false is needed"},
        {"transfer", "[]", "transfer: 1 to 32 points are needed"},
        {"transfer", "[[0, 0, 0, 0, 1.5]]", "transfer: 1 to 32 points are needed"},
        {"transfer", "[[0, 0, 0, 0]]", "transfer: 1 to 32 points are needed"},
        {"transfer", "[[5, 0, 0, 0, 0], [4, 0, 0, 0, 0]]", "transfer: 1 to 32 points are needed"},
        {"chosen", "7", "chosen: 0 or the number of an area, 1 to 6, is needed"},
        {"chosen", "-1", "chosen: 0 or the number of an area, 1 to 6, is needed"},
        {"chosen", "\"2\"", "chosen: 0 or the number of an area, 1 to 6, is needed"},
        {"angle_deg", "1e9", "bad.json: angle_deg: a number from 0.01 to 179.99 is needed"},
        {"objects", "1", "of an atlas with 1 areas and pathways, this one has 6"},
        {"conus_session", "9", "\"conus_session\" is 9, and this conus reads 1: another version wrote it"},
    };
    struct viewer viewer;
    struct window window;
    char line[700];
    (void)state;
    for (int has_context = 1; has_context >= 0; has_context--) {
        open_scene(&window, &viewer, has_context);
        snprintf(line, sizeof line, "open %s", beside("bad.json"));
        char *before = session_text(&window);
        json_t *points = json_array();
        for (int i = 0; i < 33; i++) {
            json_array_append_new(points, json_pack("[i,i,i,i,i]", i, 0, 0, 0, 0));
        }
        const size_t count = has_context ? sizeof cases / sizeof cases[0] : 0;
        for (size_t i = 0; i <= count; i++) {
            json_t *root = json_loads(before, 0, NULL);
            json_object_set_new(root, "safe_colours",
                                json_true()); /* which must not be set before the fault is found */
            int wrong = i < count
                            ? json_object_set_new(root, cases[i][0], json_loads(cases[i][1], JSON_DECODE_ANY, NULL))
                            : json_object_set(root, "transfer", points);
            assert_int_equal(wrong | json_dump_file(root, beside("bad.json"), 0), 0);
            assert_said(&window, line,
                        i < count     ? cases[i][2]
                        : has_context ? "transfer: 1 to 32 points are needed"
                                      : "transfer: there is no context here, open it with --context");
            json_decref(root);
        }
        assert_ok(conus_write_file(beside("bad.json"), before, 200));
        assert_said(&window, line, "bad.json: line");
        assert_ok(conus_write_file(beside("bad.json"), "{}", 2));
        assert_said(&window, line, "bad.json: no session of conus view");
        snprintf(line, sizeof line, "open %s", beside("absent.json"));
        assert_said(&window, line, "absent.json: cannot open: No such file or directory");
        char *after = session_text(&window);
        assert_string_equal(before, after);
        free(before);
        free(after);
        json_decref(points);
        viewer_finish(&viewer);
    }
}

/* Spaces, which JSON allows anywhere: as many as are read, then one more. */
static void large_sessions_are_not_read(void **state)
{
    enum { MOST = 64 << 20 };
    struct viewer viewer;
    struct window window;
    char line[700];
    char *spaces = malloc(MOST + 1);
    (void)state;
    open_scene(&window, &viewer, false);
    assert_non_null(spaces);
    memset(spaces, ' ', MOST + 1);
    snprintf(line, sizeof line, "open %s", beside("large.json"));
    assert_ok(conus_write_file(beside("large.json"), spaces, MOST));
    assert_said(&window, line, "large.json: line");
    assert_ok(conus_write_file(beside("large.json"), spaces, MOST + 1));
    assert_said(&window, line, "large.json: more than the 67108864 bytes that are read");
    unlink(beside("large.json"));
    free(spaces);
    viewer_finish(&viewer);
}

static void words_for_an_atlas_need_one(void **state)
{
    static const char *const lines[] = {"aim 1 2 3 4 5 6", "save one.json", "open one.json", "picture one.png 10 10",
                                        "results one.tsv"};
    struct window window = {.screen.enlarged = -1};
    (void)state;
    snprintf(folder, sizeof folder, "%s", test_scratch("alone"));
    mkdir(folder, 0700);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        char wanted[100];
        snprintf(wanted, sizeof wanted, "script:2: %.*s needs an atlas, and none is open", (int)strcspn(lines[i], " "),
                 lines[i]);
        assert_said(&window, lines[i], wanted);
    }
}

TEST_GROUP(script)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_script_cannot_do_is_said_with_its_line),
        cmocka_unit_test(words_for_an_atlas_need_one),
        cmocka_unit_test(lines_have_a_limit),
        cmocka_unit_test(sessions_that_do_not_fit_are_refused),
        cmocka_unit_test(large_sessions_are_not_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
