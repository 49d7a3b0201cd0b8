/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of the window's state, row by row: sessions have each value, refusals say what is allowed, and keys and
   commands that docs/viewer.md names are there. */
#include "viewer/commands/commands.h"
#include "viewer/session/session.h"

#include "session_words.h"
#include "test.h"
#include "window_scene.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_enum(const struct property *property)
{
    return property->type == PROPERTY_NAME;
}

/* The row's value in a session. */
static json_t *find(json_t *root, const struct property *property)
{
    json_t *of = property->object ? json_object_get(root, property->object) : root;
    return json_object_get(of, property->name);
}

static void replace(json_t *root, const struct property *property, json_t *value)
{
    json_object_set_new(property->object ? json_object_get(root, property->object) : root, property->name, value);
}

/* Reads the session of the window as it is, with another value in that row. */
static bool opens_with(struct window *window, const struct property *property, json_t *value)
{
    char why[PROPERTY_REASON] = "";
    json_t *root = session_json(window);
    assert_non_null(root);
    replace(root, property, value);
    bool fine = session_read(window, root, "session", why);
    if (!fine) {
        assert_non_null(strstr(why, property->name));
        assert_non_null(strstr(why, " needed"));
    }
    json_decref(root);
    return fine;
}

static void enums_are_written_and_read_by_name(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    for (enum property_id id = 0; id < PROPERTY_COUNT; id++) {
        const struct property *property = &properties[id];
        for (int value = (int)property->low; is_enum(property) && value <= (int)property->high; value++) {
            double was = property_value(&window, id);
            if (property->names && !property->names[value - (int)property->low]) {
                assert_false(opens_with(&window, property, json_integer(value)));
                continue;
            }
            property_put(&window, property, (double[PROPERTY_NUMBERS]){value});
            json_t *root = session_json(&window);
            json_t *name = json_incref(find(root, property));
            assert_true(json_is_string(name));
            json_decref(root);
            property_put(&window, property, (double[PROPERTY_NUMBERS]){was});
            assert_true(opens_with(&window, property, name));
            assert_near(property_value(&window, id), value, 0);
            property_put(&window, property, (double[PROPERTY_NUMBERS]){was});
            assert_false(opens_with(&window, property, json_integer(value)));
            assert_false(opens_with(&window, property, json_real(value)));
            assert_near(property_value(&window, id), was, 0);
        }
    }
    viewer_finish(&viewer);
}

static void values_that_no_row_allows_are_refused(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    viewer.head = (struct head){.on = true, .known = true, .eye = {0, 0, 500}, .size = {500, 300}};
    for (int i = 0; i < 16; i += 5) {
        viewer.head.screen.world_from_device[i] = 1;
    }
    char *before = session_text(&window);
    for (enum property_id id = 0; id < PROPERTY_COUNT; id++) {
        const struct property *property = &properties[id];
        size_t count = property_count(property);
        json_t *list = json_array();
        for (size_t i = 0; i < count; i++) {
            json_array_append_new(list, json_real(property->high * 1.01 + 1));
        }
        assert_false(opens_with(&window, property, count > 1 ? json_incref(list) : json_real(property->high + 1)));
        assert_false(opens_with(&window, property, json_real(property->low - 1)));
        assert_false(is_enum(property) && opens_with(&window, property, json_real(0.5)));
        assert_false(opens_with(&window, property, json_string("nonsense")));
        assert_false(opens_with(&window, property, json_null()));
        assert_false(opens_with(&window, property, json_array()));
        json_decref(list);
    }
    char *after = session_text(&window);
    assert_string_equal(before, after);
    free(after);
    free(before);
    viewer_finish(&viewer);
}

/* A session without a value that is needed is refused; without any other value it is read. */
static void values_missing_from_a_session(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    for (enum property_id id = 0; id < PROPERTY_COUNT; id++) {
        const struct property *property = &properties[id];
        char why[PROPERTY_REASON] = "";
        json_t *root = session_json(&window);
        assert_true(find(root, property) || property->presence >= PROPERTY_ZERO);
        json_object_del(property->object ? json_object_get(root, property->object) : root, property->name);
        assert_int_equal(session_read(&window, root, "session", why), property->presence != PROPERTY_NEEDED);
        json_decref(root);
    }
    for (size_t count = 0; count < 30; count += count ? 1 : 12) { /* of the place: none, or too few numbers */
        char why[PROPERTY_REASON] = "";
        json_t *root = session_json(&window);
        for (size_t i = 30; i-- > count;) {
            json_array_remove(json_object_get(root, "place"), i);
        }
        assert_false(session_read(&window, root, "session", why));
        assert_non_null(strstr(why, "the atlas lay elsewhere"));
        json_decref(root);
    }
    for (int i = 0; i < 2; i++) {
        char why[PROPERTY_REASON] = "";
        json_t *root = session_json(&window);
        json_object_del(root, i ? "place" : "level");
        assert_false(session_read(&window, root, "session", why));
        json_decref(root);
    }
    viewer_finish(&viewer);
}

/* What each kind of value may be, by hand. */
static void refusals_say_what_is_allowed(void **state)
{
    static const struct {
        enum property_id id;
        const char *said;
    } cases[] = {
        {PROPERTY_ANGLE, "session: angle_deg: a number from 0.01 to 179.99 is needed"},
        {PROPERTY_LAYERS, "session: layers: visible or all is needed"},
        {PROPERTY_START, "session: start: surface, before or eye is needed"},
        {PROPERTY_ONE_RAY, "session: one_ray: true or false is needed"},
        {PROPERTY_CROSSHAIR, "session: crosshair: 3 numbers from -1000000 to 1000000 are needed"},
        {PROPERTY_SECOND_ANGLE, "session: second: angle_deg: a number from 0.01 to 179.99 is needed"},
    };
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char why[PROPERTY_REASON] = "";
        json_t *root = session_json(&window);
        replace(root, &properties[cases[i].id], json_object());
        assert_false(session_read(&window, root, "session", why));
        assert_string_equal(why, cases[i].said);
        json_decref(root);
    }
    viewer_finish(&viewer);
}

/* docs/viewer.md */
static char document[1 << 18];

static void read_document(void)
{
    FILE *file = fopen(CONUS_SOURCE_DIR "/docs/viewer.md", "r");
    assert_non_null(file);
    size_t size = fread(document, 1, sizeof document - 1, file);
    fclose(file);
    assert_in_range(size, 1, sizeof document - 2);
    document[size] = '\0';
}

static bool is_shown_for_a_key(const char *name)
{
    const struct key *key;
    char shown[KEY_LIMIT];
    for (size_t i = 0; (key = keys_row(i)); i++) {
        if (strcmp(keys_shown(shown, key), name) == 0) {
            return true;
        }
    }
    return false;
}

/* Pieces of code before the section about scripts that are one character, or begin as names of keys do. */
static void the_document_names_keys_that_are_there(void **state)
{
    size_t count = 0;
    bool fine = true;
    (void)state;
    read_document();
    const char *end = strstr(document, "\n## Scripts\n");
    assert_non_null(end);
    for (const char *at = document; (at = strchr(at, '`')) && at < end;) {
        char name[64];
        size_t length = strcspn(++at, "`");
        bool is_key = length == 1 || strncmp(at, "Ctrl", 4) == 0 || (at[0] == 'F' && strchr("123456789", at[1])) ||
                      (length > 2 && at[1] == ' ' && at[0] >= 'A' && at[0] <= 'Z');
        snprintf(name, sizeof name, "%.*s", (int)length, at);
        at += length + (at[length] == '`');
        count += is_key;
        if (is_key && !is_shown_for_a_key(name)) {
            print_error("docs/viewer.md: no key is called %s\n", name);
            fine = false;
        }
    }
    assert_true(fine);
    assert_in_range(count, 40, 200);
}

/* The section about scripts has each command at the beginning of a piece of code, and no other command. */
static void the_document_lists_the_commands_of_scripts(void **state)
{
    const char *arguments;
    const char *name;
    bool fine = true;
    (void)state;
    read_document();
    const char *section = strstr(document, "\n## Scripts\n");
    assert_non_null(section);
    for (size_t i = 0; (name = script_command_name(&arguments, i)); i++) {
        char code[2][64];
        snprintf(code[0], sizeof code[0], "`%s ", name);
        snprintf(code[1], sizeof code[1], "`%s`", name);
        if (!strstr(section, code[0]) && !strstr(section, code[1])) {
            print_error("docs/viewer.md lacks the command %s\n", name);
            fine = false;
        }
    }
    for (const char *at = section; (at = strstr(at, "\n* `")); at++) {
        char said[64] = "";
        size_t i = 0;
        snprintf(said, sizeof said, "%.*s", (int)strspn(at + 4, "abcdefghijklmnopqrstuvwxyz-"), at + 4);
        while ((name = script_command_name(&arguments, i)) && strcmp(name, said) != 0) {
            i++;
        }
        if (!name) {
            print_error("docs/viewer.md: no command is called %s\n", said);
            fine = false;
        }
    }
    assert_true(fine);
}

static void tips_name_the_keys_of_the_table(void **state)
{
    char tip[KEYS_TIP];
    (void)state;
    assert_string_equal(keys_tip(tip, PROPERTY_ANGLE), "full opening angle of the cone, degrees; + and - change it");
    assert_string_equal(keys_tip(tip, PROPERTY_RADIOLOGICAL),
                        "the head's left on the right of the cuts; Ctrl+R changes it");
    assert_string_equal(keys_tip(tip, PROPERTY_FILL), "opacity of the areas in the cuts, 0 to 1");
    for (enum property_id id = 0; id < PROPERTY_COUNT; id++) {
        assert_in_range(strlen(keys_tip(tip, id)), 1, KEYS_TIP - 2);
    }
}

TEST_GROUP(properties)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(enums_are_written_and_read_by_name),
        cmocka_unit_test(values_that_no_row_allows_are_refused),
        cmocka_unit_test(values_missing_from_a_session),
        cmocka_unit_test(refusals_say_what_is_allowed),
        cmocka_unit_test(the_document_names_keys_that_are_there),
        cmocka_unit_test(the_document_lists_the_commands_of_scripts),
        cmocka_unit_test(tips_name_the_keys_of_the_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
