/* SPDX-License-Identifier: BSD-3-Clause */
/* Paths taken apart. What is wanted is written by hand. */
#include "base/files/file.h"
#include "base/memory.h"
#include "base/path.h"
#include "test.h"

#include <string.h>

static void paths_are_folder_and_name(void **state)
{
    (void)state;
    static const struct {
        const char *path, *folder, *base;
        size_t plain;
        bool is_whole, is_name;
        const char *joint;
    } rows[] = {{"", "", "", 0, false, true, ""},           {"a", "", "a", 1, false, true, "/"},
                {"a/", "a/", "", 1, false, false, ""},      {"/", "/", "", 1, true, false, ""},
                {"/a", "/", "a", 2, true, false, "/"},      {"a/b.nii", "a/", "b.nii", 7, false, false, "/"},
                {"/a/b/", "/a/b/", "", 4, true, false, ""}, {"//", "//", "", 1, true, false, ""},
                {"a//b", "a//", "b", 4, false, false, "/"}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const char *path = rows[i].path;
        size_t length = strlen(path);
        assert_int_equal(path_folder_length(path), strlen(rows[i].folder));
        assert_string_equal(path_base(path), rows[i].base);
        assert_int_equal(path_plain_length(path, length), rows[i].plain);
        assert_int_equal(path_is_whole(path), rows[i].is_whole);
        assert_int_equal(path_is_name(path), rows[i].is_name);
        assert_string_equal(path_joint(path, length), rows[i].joint);
        char *folder = path_folder(path);
        assert_string_equal(folder, rows[i].folder[0] ? rows[i].folder : "./");
        memory_free(folder);
    }
    assert_false(path_is_whole(NULL));
    assert_int_equal(path_length_above("a/b/c", 3), 2);
}

static void numbers_have_the_name_of_their_file(void **state)
{
    (void)state;
    static const struct {
        const char *title, *path, *wanted;
    } rows[] = {{"6", "maps/brodmann.nii.gz", "Brodmann 6"},
                {"6 left", "brodmann", "Brodmann 6 left"},
                {"6 right", "/a.b/areas.v2.nii", "Areas 6 right"},
                {"Insula", "brodmann.nii.gz", "Insula"},
                {"6 above", "brodmann.nii.gz", "6 above"},
                {"6a", "brodmann.nii.gz", "6a"},
                {"", "brodmann.nii.gz", ""},
                {"6", "", "6"},
                {"6", "maps/.hidden", "6"},
                {"6", "forty-bytes-forty-bytes-forty-bytes-40by.nii", "Forty-bytes-forty-bytes-forty-bytes-40by 6"},
                {"6", "forty-bytes-forty-bytes-forty-bytes-40byt.nii", "6"}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char out[60];
        assert_string_equal(path_title(out, sizeof out, rows[i].title, rows[i].path), rows[i].wanted);
    }
    char cut[8];
    assert_string_equal(path_title(cut, sizeof cut, "6", "brodmann.nii.gz"), "Brodman");
}

/* Appends the folder and a space to the text; stops behind "stop". */
static bool note_folder(void *user, const char *folder)
{
    char *text = user;
    strncat(text, folder, 20);
    strncat(text, " ", 2);
    return strcmp(folder, "stop") != 0;
}

static void folders_come_from_the_highest_on(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        size_t from;
        const char *folders;
        bool whole;
    } rows[] = {{"/a/b/c", 1, "/a /a/b ", true},
                {"/a/b/c", 3, "/a/b ", true},
                {"a", 1, "", true},
                {"a/b/", 0, "a a/b ", true},
                {"stop/b/c", 0, "stop ", false}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char path[16];
        char folders[64] = "";
        memcpy(path, rows[i].path, strlen(rows[i].path) + 1);
        assert_int_equal(path_each_folder(path, rows[i].from, note_folder, folders), rows[i].whole);
        assert_string_equal(folders, rows[i].folders);
        assert_string_equal(path, rows[i].path);
    }
    char path[] = "/a/b";
    char *cut = path_cut(path);
    assert_string_equal(path, "/a");
    *cut = '/';
    assert_string_equal(path, "/a/b");
    char name[] = "a";
    assert_null(path_cut(name));
}

static void parts_come_one_by_one(void **state)
{
    (void)state;
    static const char *const wanted[] = {"", "a", "", ".."};
    const char *rest = "/a//../";
    const char *part;
    size_t size;
    for (size_t i = 0; i < 4; i++) {
        assert_true(path_part(&rest, &part, &size));
        assert_int_equal(size, strlen(wanted[i]));
        assert_memory_equal(part, wanted[i], size);
    }
    assert_false(path_part(&rest, &part, &size));
}

TEST_GROUP(path)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_are_folder_and_name),
        cmocka_unit_test(numbers_have_the_name_of_their_file),
        cmocka_unit_test(folders_come_from_the_highest_on),
        cmocka_unit_test(parts_come_one_by_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
