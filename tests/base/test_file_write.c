/* SPDX-License-Identifier: BSD-3-Clause */
/* Files that are written whole or not at all, and their temporary names. */
#include "base/files/file.h"
#include "base/writer.h"
#include "test.h"

#include <dirent.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* The next so many random numbers are 7. */
static size_t sevens;

int __real_getentropy(void *out, size_t size);
int __wrap_getentropy(void *out, size_t size);

int __wrap_getentropy(void *out, size_t size)
{
    int failed = __real_getentropy(out, size);
    if (sevens) {
        sevens--;
        memcpy(out, &(uint32_t){7}, sizeof(uint32_t));
    }
    return failed;
}

/* Whether files without a name cannot be named, as on a system without /proc. */
static bool all_have_names;

int __real_access(const char *path, int how);
int __wrap_access(const char *path, int how);

int __wrap_access(const char *path, int how)
{
    return all_have_names && strncmp(path, "/proc/", 6) == 0 ? -1 : __real_access(path, how);
}

/* A temporary name that is taken is passed over, and its file stays. */
static void pass_over_a_taken_name(void)
{
    char left[300];
    char path[256];
    struct bytes bytes = {0};
    snprintf(path, sizeof path, "%s", test_scratch("taken.txt"));
    snprintf(left, sizeof left, "%s.00000007.part", path);
    assert_ok(file_write(left, "left", 4));
    assert_ok(file_write(path, "none", 4));
    sevens = 3;
    assert_ok(file_write(path, "one", 3));
    assert_int_equal(sevens, 0);
    assert_ok(file_read(&bytes, path, 100));
    assert_memory_equal(bytes.data, "one", 3);
    bytes_finish(&bytes);
    assert_fails(file_write_new(path, "two", 3), CONUS_ERROR_IO);
    assert_int_equal(unlink(path), 0);
    assert_ok(file_write_new(path, "two", 3));
    assert_int_equal(unlink(path), 0);
    assert_ok(file_read(&bytes, left, 100));
    assert_memory_equal(bytes.data, "left", 4);
    bytes_finish(&bytes);
    assert_int_equal(unlink(left), 0);
}

static void a_taken_name_is_passed_over(void **state)
{
    (void)state;
    pass_over_a_taken_name();
    all_have_names = true;
    pass_over_a_taken_name();
    all_have_names = false;
}

static size_t names_in(const char *folder)
{
    DIR *open = opendir(folder);
    size_t count = 0;
    while (readdir(open)) {
        count++;
    }
    closedir(open);
    return count - 2; /* "." and ".." */
}

/* A process that is killed while it writes leaves no partial file, and the old file stays. */
static void a_killed_writer_leaves_nothing(void **state)
{
    (void)state;
    static char much[1 << 16];
    struct bytes bytes = {0};
    char path[300];
    char folder[256];
    snprintf(folder, sizeof folder, "%s", test_scratch("killed"));
    assert_ok(file_make_folder(folder));
    snprintf(path, sizeof path, "%s/file", folder);
    for (size_t there = 0; there < 2; there++) {
        pid_t child = fork();
        if (child == 0) {
            const struct rlimit least = {4096, 4096}; /* SIGXFSZ ends it */
            setrlimit(RLIMIT_FSIZE, &least);
            _exit((int)file_write(path, much, sizeof much));
        }
        int ended = 0;
        assert_int_equal(waitpid(child, &ended, 0), child);
        assert_true(WIFSIGNALED(ended) && WTERMSIG(ended) == SIGXFSZ);
        assert_int_equal(names_in(folder), there);
        assert_ok(file_write(path, "kept", 4));
    }
    assert_ok(file_read(&bytes, path, 100));
    assert_memory_equal(bytes.data, "kept", 4);
    bytes_finish(&bytes);
}

static void write_in_parts(void)
{
    char folder[256];
    char path[300];
    char link[300];
    struct bytes bytes = {0};
    struct writer writer;
    snprintf(folder, sizeof folder, "%s", test_scratch(all_have_names ? "named" : "nameless"));
    assert_ok(file_make_folder(folder));
    snprintf(path, sizeof path, "%s/file", folder);
    snprintf(link, sizeof link, "%s/link", folder);
    for (size_t there = 0; there < 2; there++) {
        assert_ok(file_begin(&writer, path, 0));
        assert_ok(file_append(&writer, "dropped", 7));
        assert_int_equal(names_in(folder), there + (all_have_names ? 1 : 0));
        writer_drop(&writer);
        assert_int_equal(names_in(folder), there);
        assert_ok(file_begin(&writer, path, 0));
        assert_ok(file_append(&writer, "one, ", 5));
        assert_ok(file_append(&writer, there ? "two" : "new", 3));
        assert_ok(file_end(&writer));
        writer_drop(&writer);
        assert_ok(file_read(&bytes, path, 100));
        assert_int_equal(bytes.size, 8);
        assert_memory_equal(bytes.data, there ? "one, two" : "one, new", 8);
        bytes_finish(&bytes);
        assert_int_equal(names_in(folder), 1);
    }
    assert_int_equal(symlink("file", link), 0);
    assert_ok(file_begin(&writer, link, 0));
    assert_ok(file_end(&writer));
    writer_drop(&writer);
    assert_ok(file_read(&bytes, path, 100));
    assert_int_equal(bytes.size, 0);
    bytes_finish(&bytes);
    assert_int_equal(names_in(folder), 2);
    assert_fails(file_begin(&writer, folder, 0), CONUS_ERROR_IO);
    writer_drop(&writer);
    snprintf(path, sizeof path, "%s/none/file", folder);
    assert_fails(file_begin(&writer, path, 0), CONUS_ERROR_IO);
    writer_drop(&writer);
}

static void a_file_in_parts_is_whole_or_not_there(void **state)
{
    (void)state;
    write_in_parts();
    all_have_names = true;
    write_in_parts();
    all_have_names = false;
}

TEST_GROUP(file_write)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_taken_name_is_passed_over),
        cmocka_unit_test(a_killed_writer_leaves_nothing),
        cmocka_unit_test(a_file_in_parts_is_whole_or_not_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
