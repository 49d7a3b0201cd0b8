/* SPDX-License-Identifier: BSD-3-Clause */
/* Options that add files to an open atlas, and the numbers of objects while files are added and removed. */
#include "viewer/session/session.h"

#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void an_option_is_a_kind_and_a_file(void **state)
{
    static const struct {
        const char *word;
        enum addition kind;
        const char *path;
    } cases[] = {{"--streamlines=/a.trk", ADD_STREAMLINES, "/a.trk"},
                 {"--streamlines=/a.trk,radius=1,name=S,moves", ADD_STREAMLINES, "/a.trk"},
                 {"--streamlines=/a, b,moves.trk", ADD_STREAMLINES, "/a, b,moves.trk"},
                 {"--pathway=/p.nii,volume=3,band=1:2:x", ADD_PATHWAY, "/p.nii"},
                 {"--pathway=/p,moves", ADD_PATHWAY, "/p,moves"},
                 {"--context=/t.nii,volume=1", ADD_CONTEXT, "/t.nii"},
                 {"--context-opacity=0.5", ADDITION_COUNT, ""},
                 {"--streamlines", ADDITION_COUNT, ""},
                 {"-pathway=a", ADDITION_COUNT, ""},
                 {"", ADDITION_COUNT, ""}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *value = NULL;
        char path[SYSTEM_PATH] = "";
        enum addition kind = addition_of(&value, cases[i].word);
        assert_int_equal(kind, cases[i].kind);
        assert_non_null(value);
        assert_true(kind == ADDITION_COUNT || addition_path(path, kind, value));
        assert_string_equal(path, cases[i].path);
    }
}

static char *dump(json_t *words)
{
    char *text = json_dumps(words, JSON_COMPACT);
    json_decref(words);
    return text;
}

static void assert_words(json_t *words, const char *wanted)
{
    char *text = dump(words);
    assert_string_equal(text, wanted);
    free(text);
}

static void a_volume_takes_the_place_of_another_as_context(void **state)
{
    json_t *words = json_pack("[s, s, s]", "--labels=/l", "--context=/a.nii", "--streamlines=/s.trk,name=x");
    (void)state;
    assert_words(additions_with(words, ADD_CONTEXT, "/b.nii"),
                 "[\"--labels=/l\",\"--streamlines=/s.trk,name=x\",\"--context=/b.nii\"]");
    assert_words(additions_with(words, ADD_STREAMLINES, "/s.trk"),
                 "[\"--labels=/l\",\"--context=/a.nii\",\"--streamlines=/s.trk,name=x\",\"--streamlines=/s.trk\"]");
    assert_words(additions_without(words, 1), "[\"--labels=/l\",\"--streamlines=/s.trk,name=x\"]");
    assert_int_equal(additions_index(words, "s.trk"), 2);
    assert_int_equal(additions_index(words, "/a.nii"), 1);
    assert_int_equal(additions_index(words, "/l"), 3);
    assert_null(additions_with(words, ADD_CONTEXT, "\xff"));
    json_decref(words);
    /* removing the last surface removes the opacity of surfaces, too */
    words = json_pack("[s, s]", "--context-opacity=0.5", "--streamlines=/s.trk");
    assert_words(additions_without(words, 1), "[]");
    json_decref(words);
}

enum { OWN = 5, FILES = 6 };

/* An added file of the model: its name, its number of objects, and how often its options were changed. */
struct file {
    int name, count, version;
};

struct model {
    struct file files[FILES];
    int count;
};

/* The tag of an object: an area's number, or file and ordinal of an added one. Areas come first, then files in
 * order. */
static int tag_of(const struct model *model, int number)
{
    if (number <= OWN) {
        return number;
    }
    number -= OWN;
    for (int i = 0; i < model->count; i++) {
        if (number <= model->files[i].count) {
            return 100 * (model->files[i].name + 1) + number;
        }
        number -= model->files[i].count;
    }
    return 0;
}

static int objects_of(const struct model *model)
{
    int count = OWN;
    for (int i = 0; i < model->count; i++) {
        count += model->files[i].count;
    }
    return count;
}

static json_t *opened_of(const struct model *model)
{
    json_t *added = json_array();
    int next = OWN;
    for (int i = 0; i < model->count; i++) {
        const struct file *file = &model->files[i];
        json_t *numbers = json_array();
        for (int k = 0; k < file->count; k++) {
            json_array_append_new(numbers, json_integer(++next));
        }
        json_array_append_new(added,
                              json_pack("{s: o, s: o, s: o, s: o}", "option",
                                        json_sprintf("--streamlines=/%d.trk,radius=%d", file->name, file->version),
                                        "path", json_sprintf("/%d.trk", file->name), "sha256",
                                        json_sprintf("%064d", file->name), "objects", numbers));
    }
    return json_pack("{s: o}", "added", added);
}

/* Adds a file, removes one, or changes the options of one, which puts it at the end. */
static void step(struct model *model, uint64_t *seed)
{
    int at = (int)test_random(seed, 0, FILES);
    struct file file = {at, 1 + at % 3, 1};
    int i = 0;
    while (i < model->count && model->files[i].name != at) {
        i++;
    }
    if (i < model->count) {
        bool changes = test_random(seed, 0, 1) < 0.4;
        file.version = model->files[i].version + 1;
        model->count--;
        memmove(&model->files[i], &model->files[i + 1], (size_t)(model->count - i) * sizeof *model->files);
        if (!changes) {
            return;
        }
    }
    model->files[model->count++] = file;
}

/* A session of `then` in which a random half of the objects is hidden and has an opacity; `chosen` marks these by their
 * tags. */
static json_t *session_of(const struct model *then, bool chosen[100 * (FILES + 1) + 4], uint64_t *seed)
{
    json_t *hidden = json_array();
    json_t *opacities = json_array();
    for (int number = 1; number <= objects_of(then); number++) {
        int tag = tag_of(then, number);
        chosen[tag] = test_random(seed, 0, 1) < 0.5;
        if (chosen[tag]) {
            json_array_append_new(hidden, json_integer(number));
            json_array_append_new(opacities, json_pack("[i, f]", number, tag / 1000.0));
        }
    }
    const int one = 1 + (int)test_random(seed, 0, objects_of(then));
    return json_pack("{s: o, s: i, s: o, s: i, s: {s: o}}", "opened", opened_of(then), "objects", objects_of(then),
                     "hidden", hidden, "chosen", one, "look", "opacities", opacities);
}

/* Asserts that the fitted session names the chosen objects that are still there, and no others. @p one: tag of the one
 * that the session calls the chosen one. */
static void assert_fits(const json_t *root, const struct model *now, const bool *chosen, const bool *was, int one)
{
    const int number_of_one = (int)json_integer_value(json_object_get(root, "chosen"));
    bool is_there = false;
    const json_t *hidden = json_object_get(root, "hidden");
    const json_t *opacities = json_object_get(json_object_get(root, "look"), "opacities");
    size_t wanted = 0;
    for (int number = 1; number <= objects_of(now); number++) {
        int tag = tag_of(now, number);
        wanted += was[tag] && chosen[tag];
        is_there = is_there || tag == one;
    }
    assert_int_equal(json_integer_value(json_object_get(root, "objects")), objects_of(now));
    assert_int_equal(number_of_one ? tag_of(now, number_of_one) : 0, is_there ? one : 0);
    assert_int_equal(json_array_size(hidden), wanted);
    assert_int_equal(json_array_size(opacities), wanted);
    for (size_t i = 0; i < wanted; i++) {
        const json_t *pair = json_array_get(opacities, i);
        int tag = tag_of(now, (int)json_integer_value(json_array_get(hidden, i)));
        assert_true(tag && was[tag] && chosen[tag]);
        assert_int_equal(tag_of(now, (int)json_integer_value(json_array_get(pair, 0))), tag);
        assert_near(json_real_value(json_array_get(pair, 1)), tag / 1000.0, 0);
    }
}

static void numbers_go_with_their_files(void **state)
{
    enum { STEPS = 10000, TAGS = 100 * (FILES + 1) + 4 };
    struct model now = {.count = 0};
    uint64_t seed = 41;
    (void)state;
    for (int i = 0; i < STEPS; i++) {
        struct model then = now;
        bool chosen[TAGS] = {false};
        bool was[TAGS] = {false};
        for (int steps = 1 + (int)test_random(&seed, 0, 3); steps > 0; steps--) {
            step(&now, &seed);
        }
        for (int number = 1; number <= objects_of(&then); number++) {
            was[tag_of(&then, number)] = true;
        }
        json_t *root = session_of(&then, chosen, &seed);
        const int one = tag_of(&then, (int)json_integer_value(json_object_get(root, "chosen")));
        struct view_atlas atlas = {.object_count = (size_t)objects_of(&now)};
        struct viewer viewer = {.atlases = &atlas, .atlas_count = 1};
        struct window window = {.viewer = &viewer, .files.opened = opened_of(&now)};
        session_fit(root, &window);
        assert_fits(root, &now, chosen, was, one);
        json_decref(window.files.opened);
        json_decref(root);
    }
}

/* A session whose list of files contradicts itself is not changed; reading it fails later. */
static void what_a_session_says_of_files_is_not_trusted(void **state)
{
    static const char *const added[] = {
        "5",
        "[5]",
        "[{}]",
        "[{\"objects\": 5}]",
        "[{\"objects\": [0]}]",
        "[{\"option\": \"--streamlines=/0.trk\", \"objects\": [6]}]",
        "[{\"option\": \"--streamlines=/0.trk\", \"objects\": [9]}]",
        "[{\"option\": \"--streamlines=/0.trk\", \"path\": \"/0.trk/l\", \"objects\": [-1, 4294967297]}]",
        "[{\"option\": 5, \"path\": [], \"sha256\": {}, \"objects\": [1, 1, 1, 1, 1, 1]}]"};
    struct model model = {.files = {{0, 1, 1}}, .count = 1};
    struct view_atlas atlas = {.object_count = OWN + 1};
    struct viewer viewer = {.atlases = &atlas, .atlas_count = 1};
    struct window window = {.viewer = &viewer, .files.opened = opened_of(&model)};
    (void)state;
    for (size_t i = 0; i < sizeof added / sizeof added[0]; i++) {
        for (int objects = 0; objects <= 2 * OWN; objects++) {
            json_t *root = json_pack("{s: {s: o}, s: i, s: [i, i]}", "opened", "added",
                                     json_loads(added[i], JSON_DECODE_ANY, NULL), "objects", objects, "hidden", 1, 6);
            session_fit(root, &window);
            const json_t *hidden = json_object_get(root, "hidden");
            for (size_t k = 0; k < json_array_size(hidden); k++) {
                json_int_t number = json_integer_value(json_array_get(hidden, k));
                assert_true(number == 1 || number == 6);
            }
            json_decref(root);
        }
    }
    json_decref(window.files.opened);
}

/* JSON cannot hold such bytes, but the folder to which the session was moved may have them in its name. */
static void a_file_is_found_in_a_folder_that_is_no_utf8(void **state)
{
    char folder[512];
    char path[600];
    char missing[ADDITIONS_MISSING];
    json_t *words = json_pack("[s, s]", "--context=/gone/one.nii,volume=1", "--pathway=/gone/two.nii");
    json_t *described = json_pack("[{s: s}, {s: s}]", "option", "--context=/gone/one.nii,volume=1", "option",
                                  "--pathway=/gone/two.nii");
    (void)state;
    snprintf(folder, sizeof folder, "%s\xff", test_scratch("moved"));
    mkdir(folder, 0700);
    snprintf(path, sizeof path, "%s/one.nii", folder);
    assert_ok(conus_write_file(path, "1", 1));
    snprintf(path, sizeof path, "%s/s.json", folder);
    json_t *lost = json_array();
    json_t *found = additions_find(lost, words, described, path, NULL);
    additions_names(missing, lost);
    assert_int_equal(json_array_size(found), 1);
    snprintf(path, sizeof path, "--context=%s/one.nii,volume=1", folder);
    assert_string_equal(json_string_value(json_array_get(found, 0)), path);
    assert_string_equal(missing, "two.nii");
    json_decref(found);
    json_decref(lost);
    json_decref(described);
    json_decref(words);
}

/* Keys are put behind the file, changed and taken out; a comma in the file's own name is none of theirs. */
static void keys_stand_behind_the_file(void **state)
{
    static const struct {
        const char *before, *key, *text, *after;
    } changes[] = {
        {"b.trk", "radius", "2", "b.trk,radius=2"},
        {"b.trk,radius=2,moves", "radius", "1.5", "b.trk,radius=1.5,moves"},
        {"b.trk,radius=2,moves", "radius", NULL, "b.trk,moves"},
        {"b.trk,radius=2,moves", "moves", NULL, "b.trk,radius=2"},
        {"b.trk,radius=2", "moves", "", "b.trk,radius=2,moves"},
        {"b.trk,name=moves,space=lps", "moves", "", "b.trk,name=moves,space=lps,moves"},
        {"a,name.trk,name=X", "name", "Y", "a,name.trk,name=Y"},
        {"b.trk", "name", NULL, "b.trk"},
        {"b.trk,name=A", "name", "a text that the line has no room for", "b.trk,name=A"},
    };
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        char value[40];
        (void)state;
        snprintf(value, sizeof value, "%s", changes[i].before);
        addition_put_key(value, sizeof value, ADD_STREAMLINES, changes[i].key, changes[i].text);
        assert_string_equal(value, changes[i].after);
    }
}

TEST_GROUP(additions)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_stand_behind_the_file),
        cmocka_unit_test(an_option_is_a_kind_and_a_file),
        cmocka_unit_test(a_volume_takes_the_place_of_another_as_context),
        cmocka_unit_test(a_file_is_found_in_a_folder_that_is_no_utf8),
        cmocka_unit_test(numbers_go_with_their_files),
        cmocka_unit_test(what_a_session_says_of_files_is_not_trusted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
