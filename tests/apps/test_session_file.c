/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of how a session describes its atlas and finds it again. */
#include "viewer/model/additions.h"

#include "conus/own.h"
#include "options/provenance.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char whole[] =
    "{\"conus_session\": 1, \"atlas\": \"a.nii\", \"opened\": {\"folder\": \"/f\", \"options\": "
    "[\"--labels=/l\"], \"sha256\": \"00\", \"bytes\": 5}}";

static bool reads(struct session_file *out, const char *text, size_t size)
{
    char path[600];
    snprintf(path, sizeof path, "%s.json", test_scratch("session"));
    assert_ok(conus_write_file(path, text, size));
    return session_file_read(out, path);
}

static void no_prefix_of_a_session_is_one(void **state)
{
    struct session_file file;
    (void)state;
    for (size_t size = 0; size < strlen(whole); size++) {
        assert_false(reads(&file, whole, size));
    }
    assert_true(reads(&file, whole, strlen(whole)));
    assert_string_equal(file.atlas, "a.nii");
    assert_string_equal(file.folder, "/f");
    assert_string_equal(file.sha256, "00");
    assert_int_equal(file.bytes, 5);
    assert_int_equal(json_array_size(file.options), 1);
    session_file_finish(&file);
}

/* Manifests and objects with values of other types are refused; a checksum and options may be missing. */
static void other_json_is_no_session(void **state)
{
    static const char *const bad[] = {"[]",
                                      "{}",
                                      "{\"conus_atlas\": 1}",
                                      "{\"conus_session\": \"1\", \"atlas\": \"a\"}",
                                      "{\"conus_session\": 1, \"atlas\": 5}",
                                      "{\"conus_session\": 1, \"atlas\": \"\"}",
                                      "{\"conus_session\": 1, \"atlas\": \"a\", \"atlas\": \"b\"}",
                                      "{\"conus_session\": 1, \"atlas\": \"a\"}",
                                      "{\"conus_session\": 1, \"atlas\": \"a\", \"opened\": 5}",
                                      "{\"conus_session\": 1, \"atlas\": \"a\", \"opened\": {\"options\": []}}"};
    static const char *const poor[] = {
        "{\"conus_session\": 1, \"atlas\": \"a\", \"opened\": {\"folder\": \"\"}}",
        "{\"conus_session\": 1, \"atlas\": \"a\", \"opened\": {\"folder\": \"\", \"options\": [5]}}"};
    struct session_file file;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(reads(&file, bad[i], strlen(bad[i])));
    }
    for (size_t i = 0; i < sizeof poor / sizeof poor[0]; i++) {
        assert_true(reads(&file, poor[i], strlen(poor[i])));
        assert_null(file.options);
        assert_string_equal(file.folder, "");
        assert_string_equal(file.sha256, "");
        session_file_finish(&file);
    }
    assert_false(session_file_read(&file, "/dev/null"));
    assert_false(session_file_read(&file, "/no/such.json"));
}

static void put(const char *folder, const char *name, const char *text)
{
    char path[1024];
    mkdir(folder, 0700);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_ok(conus_write_file(path, text, strlen(text)));
}

static void assert_found(const struct session_file *file, const char *session, const char *other, const char *wanted)
{
    char path[SYSTEM_PATH];
    bool found = session_file_find(path, file, session, &other, other != NULL);
    assert_int_equal(found, wanted != NULL);
    if (found) {
        assert_string_equal(path, wanted);
    }
}

/* The atlas is looked for at its old place, beside the session by name and then by its bytes, elsewhere by its bytes
 * alone. */
static void an_atlas_is_looked_for_in_this_order(void **state)
{
    char sum[SHA256_TEXT];
    char was[512];
    char moved[512];
    char paths[5][600];
    static const char *const names[5] = {"s.json", "a.nii", "b.nii", "c.nii", "a.nii"};
    (void)state;
    snprintf(was, sizeof was, "%s", test_scratch("was"));
    snprintf(moved, sizeof moved, "%s", test_scratch("moved"));
    for (size_t i = 0; i < 5; i++) {
        snprintf(paths[i], sizeof paths[i], "%s/%s", i < 4 ? moved : was, names[i]);
        remove(paths[i]);
    }
    provenance_hash(sum, "right", 5);
    struct session_file file = {.atlas = "a.nii", .folder = was, .sha256 = sum, .bytes = 5};
    put(moved, "c.nii", "wrong");
    assert_found(&file, paths[0], paths[3], NULL);
    put(moved, "b.nii", "right");
    assert_found(&file, "elsewhere/s.json", paths[2], paths[2]);
    assert_found(&file, paths[0], NULL, paths[2]);
    put(moved, "a.nii", "other");
    assert_found(&file, paths[0], NULL, paths[1]); /* by its name; its bytes are compared once it is open */
    put(was, "a.nii", "other");
    assert_found(&file, paths[0], NULL, paths[4]);
    /* beside another atlas only with its bytes, whatever it is called */
    char near[SYSTEM_PATH];
    char found[SYSTEM_PATH];
    snprintf(near, sizeof near, "%s/atlas.nii", was);
    assert_false(session_file_find_near(found, &file, near));
    snprintf(near, sizeof near, "%s/atlas.nii", moved);
    assert_true(session_file_find_near(found, &file, near));
    assert_string_equal(found, paths[2]);
    file.sha256 = ""; /* which are not known: by its name */
    assert_true(session_file_find_near(found, &file, near));
    assert_string_equal(found, paths[1]);
    file.sha256 = sum;
    file.atlas = "a.nii,volume=2";
    snprintf(paths[4], sizeof paths[4], "%s/a.nii,volume=2", was);
    assert_found(&file, paths[0], NULL, paths[4]);
}

TEST_GROUP(session_file)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_prefix_of_a_session_is_one),
        cmocka_unit_test(other_json_is_no_session),
        cmocka_unit_test(an_atlas_is_looked_for_in_this_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
