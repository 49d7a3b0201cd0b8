/* SPDX-License-Identifier: BSD-3-Clause */
/* The cache of meshes: a kept mesh is found; a damaged one, and one that others can write, is not read. */
#include "base/cache/cache_folder.h"
#include "base/memory.h"
#include "loaders/child/mesh_cache.h"
#include "test.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static struct notes noted; /* notes of the last search */

static void key_of(char key[MESH_CACHE_KEY_SIZE], const char *recipe)
{
    struct buffer bytes = {0};
    buffer_text(&bytes, recipe);
    mesh_cache_key(key, &bytes);
    buffer_finish(&bytes);
}

static conus_status keep(const char *recipe, const char *content, size_t size, uint64_t limit)
{
    char key[MESH_CACHE_KEY_SIZE];
    struct buffer bytes = {0};
    key_of(key, recipe);
    buffer_append(&bytes, content, size);
    conus_status status = buffer_status(&bytes);
    status = status ? status : mesh_cache_keep_within(key, &bytes, limit);
    buffer_finish(&bytes);
    return status;
}

/* Whether the entry of `recipe` exists and holds `content`. */
static bool holds(const char *recipe, const char *content)
{
    char key[MESH_CACHE_KEY_SIZE];
    struct bytes found = {0};
    key_of(key, recipe);
    notes_finish(&noted);
    assert_ok(mesh_cache_find(&found, key, &noted));
    bool same = found.data && found.size == strlen(content) && memcmp(found.data, content, found.size) == 0;
    bytes_finish(&found);
    return same;
}

static char *entry_path(const char *recipe)
{
    static char path[8192];
    char key[MESH_CACHE_KEY_SIZE];
    struct buffer folder = {0};
    key_of(key, recipe);
    assert_ok(cache_folder_path(&folder));
    snprintf(path, sizeof path, "%s/%s.mesh", folder.data, key);
    buffer_finish(&folder);
    return path;
}

static void what_is_kept_is_found(void **state)
{
    (void)state;
    assert_false(holds("a", "content"));
    assert_ok(keep("a", "content", 7, MESH_CACHE_LIMIT));
    assert_true(holds("a", "content"));
    assert_false(holds("b", "content"));
    assert_ok(keep("a", "other", 5, MESH_CACHE_LIMIT));
    assert_true(holds("a", "other"));
    assert_ok(keep("nothing", "", 0, MESH_CACHE_LIMIT));
    assert_true(holds("nothing", ""));
}

static void damaged_entries_are_ignored_and_rewritten(void **state)
{
    (void)state;
    struct bytes entry;
    assert_ok(keep("d", "content", 7, MESH_CACHE_LIMIT));
    char *path = entry_path("d");
    assert_ok(file_read(&entry, path, 1000));
    for (size_t i = 0; i < entry.size; i++) {
        entry.data[i] ^= 0x10;
        assert_ok(file_write_soon(path, entry.data, entry.size));
        assert_false(holds("d", "content"));
        entry.data[i] ^= 0x10;
        assert_ok(file_write_soon(path, entry.data, i));
        assert_false(holds("d", "content"));
    }
    assert_ok(keep("d", "content", 7, MESH_CACHE_LIMIT));
    assert_true(holds("d", "content"));
    bytes_finish(&entry);
}

static void age(const char *recipe, time_t seconds)
{
    const struct timespec times[2] = {{.tv_sec = seconds}, {.tv_sec = seconds}};
    assert_int_equal(utimensat(AT_FDCWD, entry_path(recipe), times, 0), 0);
}

static void what_was_not_used_for_longest_leaves_first(void **state)
{
    (void)state;
    enum { SIZE = 1000, HEAD = 24 };
    static const char content[SIZE];
    assert_ok(keep("make room", "", 0, HEAD)); /* all others leave */
    unlink(entry_path("make room"));
    assert_ok(keep("one", content, SIZE, MESH_CACHE_LIMIT));
    assert_ok(keep("two", content, SIZE, MESH_CACHE_LIMIT));
    assert_ok(keep("three", content, SIZE, MESH_CACHE_LIMIT));
    age("one", 1000);
    age("two", 2000);
    age("three", 3000);
    assert_false(holds("one", "x")); /* reading counts as a use */
    assert_ok(keep("four", content, SIZE, 3 * (SIZE + HEAD)));
    assert_int_equal(access(entry_path("one"), F_OK), 0);
    assert_int_equal(access(entry_path("two"), F_OK), -1);
    assert_int_equal(access(entry_path("three"), F_OK), 0);
    assert_int_equal(access(entry_path("four"), F_OK), 0);
    assert_ok(keep("too large", content, SIZE, SIZE));
    assert_int_equal(access(entry_path("too large"), F_OK), -1);
    assert_int_equal(access(entry_path("one"), F_OK), 0);
}

/* Starts a process that writes `content` again and again. */
static pid_t start_writer(const char *content, size_t size, int times)
{
    pid_t pid = fork();
    for (int n = 0; pid == 0 && n < times; n++) {
        if (keep("shared", content, size, MESH_CACHE_LIMIT)) {
            _exit(1);
        }
    }
    if (pid == 0) {
        _exit(0);
    }
    return pid;
}

/* Two writers and a reader: the reader sees one of the two contents, or none, never a mixture. */
static void processes_do_not_disturb_each_other(void **state)
{
    (void)state;
    enum { SIZE = 300000, TIMES = 60 };
    char *contents[2];
    pid_t pids[2];
    for (int i = 0; i < 2; i++) {
        contents[i] = memory_zeroed(SIZE + 1, 1);
        memset(contents[i], 'a' + i, SIZE);
    }
    for (int i = 0; i < 2; i++) {
        pids[i] = start_writer(contents[i], SIZE, TIMES);
    }
    size_t mixtures = 0;
    for (int n = 0; n < TIMES; n++) {
        char key[MESH_CACHE_KEY_SIZE];
        struct bytes found = {0};
        key_of(key, "shared");
        assert_ok(mesh_cache_find(&found, key, &noted));
        mixtures += found.data && (found.size != SIZE || memcmp(found.data, contents[found.data[0] == 'b'], SIZE) != 0);
        bytes_finish(&found);
    }
    for (int i = 0; i < 2; i++) {
        int how;
        assert_int_equal(waitpid(pids[i], &how, 0), pids[i]);
        assert_int_equal(how, 0);
        memory_free(contents[i]);
    }
    assert_int_equal(mixtures, 0);
}

static void without_a_folder_nothing_is_kept(void **state)
{
    (void)state;
    char *cache = strdup(getenv("XDG_CACHE_HOME"));
    static const char *const folders[] = {"relative", "/proc/none", "/dev/null"};
    for (size_t i = 0; i < 3; i++) {
        setenv("XDG_CACHE_HOME", folders[i], 1);
        unsetenv("HOME");
        assert_ok(keep("x", "content", 7, MESH_CACHE_LIMIT));
        assert_false(holds("x", "content"));
    }
    char home[8192];
    snprintf(home, sizeof home, "%s/home", cache);
    unsetenv("XDG_CACHE_HOME");
    setenv("HOME", home, 1);
    assert_ok(keep("x", "content", 7, MESH_CACHE_LIMIT));
    assert_true(holds("x", "content"));
    assert_non_null(strstr(entry_path("x"), "/home/.cache/conus/"));
    setenv("XDG_CACHE_HOME", cache, 1);
    free(cache);
}

static bool is_noted(const char *path)
{
    return noted.count == 1 && strncmp(noted.lines[0], path, strlen(path)) == 0 && strstr(noted.lines[0], "not used");
}

static char *folder_path(void)
{
    char *path = entry_path("trusted");
    *strrchr(path, '/') = '\0';
    return path;
}

/* An entry that others can write is not read. Files of another owner can only be made by root. */
static void what_others_can_write_is_not_read(void **state)
{
    (void)state;
    static const struct {
        mode_t mode;
        bool trusted;
    } modes[] = {{0600, true}, {0644, true}, {0620, false}, {0602, false}, {0666, false}};
    assert_ok(keep("trusted", "content", 7, MESH_CACHE_LIMIT));
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        assert_int_equal(chmod(entry_path("trusted"), modes[i].mode), 0);
        assert_int_equal(holds("trusted", "content"), modes[i].trusted);
        assert_true(modes[i].trusted ? noted.count == 0 : is_noted(entry_path("trusted")));
        chmod(entry_path("trusted"), 0600);
        assert_int_equal(chmod(folder_path(), modes[i].mode | 0700), 0);
        assert_int_equal(holds("trusted", "content"), modes[i].trusted);
        assert_true(modes[i].trusted ? noted.count == 0 : is_noted(folder_path()));
        chmod(folder_path(), 0700);
    }
    if (geteuid() == 0) {
        assert_int_equal(chown(entry_path("trusted"), 65534, (gid_t)-1), 0);
        assert_false(holds("trusted", "content"));
        assert_int_equal(chown(entry_path("trusted"), 0, (gid_t)-1), 0);
        assert_true(holds("trusted", "content"));
        assert_int_equal(chown(folder_path(), 65534, (gid_t)-1), 0);
        assert_false(holds("trusted", "content"));
        assert_int_equal(chown(folder_path(), 0, (gid_t)-1), 0);
    }
    assert_true(holds("trusted", "content"));
}

static void links_and_pipes_are_not_read(void **state)
{
    (void)state;
    char *elsewhere = strdup(entry_path("elsewhere"));
    assert_ok(keep("trusted", "content", 7, MESH_CACHE_LIMIT));
    assert_int_equal(rename(entry_path("trusted"), elsewhere), 0);
    assert_int_equal(symlink(elsewhere, entry_path("trusted")), 0);
    assert_false(holds("trusted", "content"));
    assert_true(is_noted(entry_path("trusted")));
    unlink(entry_path("trusted"));
    assert_int_equal(mkfifo(entry_path("trusted"), 0600), 0);
    assert_false(holds("trusted", "content"));
    unlink(entry_path("trusted"));
    unlink(elsewhere);
    free(elsewhere);
}

/* Nothing is written to a folder in which others could exchange it. */
static void nothing_is_kept_where_others_can_write(void **state)
{
    (void)state;
    assert_int_equal(chmod(folder_path(), 0770), 0);
    assert_ok(keep("not kept", "content", 7, MESH_CACHE_LIMIT));
    assert_int_equal(chmod(folder_path(), 0700), 0);
    assert_int_equal(access(entry_path("not kept"), F_OK), -1);
}

static conus_status attempt(void *data)
{
    char key[MESH_CACHE_KEY_SIZE];
    struct bytes found = {0};
    (void)data;
    conus_status status = keep("again", "content", 7, MESH_CACHE_LIMIT);
    key_of(key, "again");
    status = status ? status : mesh_cache_find(&found, key, &noted);
    bytes_finish(&found);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    test_every_allocation(attempt, NULL);
}

TEST_GROUP(mesh_cache)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_kept_is_found),
        cmocka_unit_test(damaged_entries_are_ignored_and_rewritten),
        cmocka_unit_test(what_was_not_used_for_longest_leaves_first),
        cmocka_unit_test(processes_do_not_disturb_each_other),
        cmocka_unit_test(without_a_folder_nothing_is_kept),
        cmocka_unit_test(what_others_can_write_is_not_read),
        cmocka_unit_test(links_and_pipes_are_not_read),
        cmocka_unit_test(nothing_is_kept_where_others_can_write),
        cmocka_unit_test(every_failing_allocation),
    };
    umask(022);
    test_own_cache();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
