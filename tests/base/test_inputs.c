/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of the files that a process has read, of which none is replaced. */
#include "base/files/file.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static void write_text(const char *path, const char *text)
{
    assert_ok(file_write_soon(path, text, strlen(text)));
}

static void make_folder(const char *name)
{
    test_folder(name);
    write_text(test_in("file"), "content");
    write_text(test_in("a.txt"), "a");
}

/* What a process does that asked for the list of its inputs; it goes on to have one. The number of the first line that
 * is not as it should be, 0 = none. */
#define CHECK(condition)                                                                                               \
    if (!(condition)) {                                                                                                \
        return __LINE__;                                                                                               \
    }
static int keep_inputs(void)
{
    char hard[SYSTEM_PATH];
    struct bytes bytes = {0};
    struct file_state before;
    snprintf(hard, sizeof hard, "%s", test_in("hard"));
    CHECK(link(test_in("file"), hard) == 0)
    CHECK(!conus_inputs_at(0) && !conus_inputs_find(test_in("file")))
    CHECK(file_read(&bytes, test_in("file"), 100) == CONUS_OK) /* nobody asked yet */
    bytes_finish(&bytes);
    CHECK(conus_inputs_keep() == CONUS_OK && !conus_inputs_at(0))
    CHECK(file_write(test_in("file"), "other", 5) == CONUS_OK)
    CHECK(file_state_find(&before, test_in("a.txt")) == CONUS_OK && file_exists(test_in("file")))
    CHECK(!conus_inputs_at(0)) /* to be asked about is not to be read */
    /* while a thread searches, it takes what it can use */
    CHECK(!inputs_search(true))
    CHECK(file_read(&bytes, test_in("a.txt"), 100) == CONUS_OK)
    bytes_finish(&bytes);
    CHECK(!conus_inputs_find(test_in("a.txt")))
    inputs_take(test_in("a.txt"));
    CHECK(inputs_search(false))
    CHECK(strcmp(conus_inputs_find(test_in("a.txt")), test_in("a.txt")) == 0)
    CHECK(file_read(&bytes, hard, 100) == CONUS_OK && file_exists(test_in("a.txt")))
    bytes_finish(&bytes);
    CHECK(strcmp(conus_inputs_at(1), hard) == 0 && !conus_inputs_at(2))
    /* by each name of the file, and none by which there is nothing */
    CHECK(file_write(hard, "x", 1) == CONUS_ERROR_ARGUMENT && strstr(conus_message(), "would overwrite the input"))
    CHECK(symlink("hard", test_in("soft")) == 0 && file_write(test_in("soft"), "x", 1) == CONUS_ERROR_ARGUMENT)
    CHECK(file_write_soon(test_in("../inputs/hard"), "x", 1) == CONUS_ERROR_ARGUMENT)
    CHECK(file_write(test_in("new"), "x", 1) == CONUS_OK && file_write(test_in("new"), "y", 1) == CONUS_OK)
    CHECK(truncate(test_in("new"), 3) == 0) /* by somebody else */
    conus_inputs_add(test_in("new"));
    conus_inputs_add(test_in("missing"));
    conus_inputs_add(NULL);
    CHECK(conus_write_file(test_in("new"), "z", 1) == CONUS_ERROR_ARGUMENT)
    CHECK(conus_write_file(test_in("missing"), "z", 1) == CONUS_OK && !conus_inputs_at(3))
    /* what it has made itself is no input, until somebody else changes it */
    CHECK(file_read(&bytes, test_in("missing"), 100) == CONUS_OK)
    bytes_finish(&bytes);
    CHECK(conus_write_file(test_in("missing"), "zz", 2) == CONUS_OK && !conus_inputs_at(3))
    CHECK(truncate(test_in("missing"), 7) == 0 && file_read(&bytes, test_in("missing"), 100) == CONUS_OK)
    bytes_finish(&bytes);
    CHECK(conus_write_file(test_in("missing"), "z", 1) == CONUS_ERROR_ARGUMENT)
    return 0;
}

static void no_input_of_a_process_is_replaced(void **state)
{
    (void)state;
    int status = -1;
    make_folder("inputs");
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        int line = keep_inputs();
        dprintf(STDERR_FILENO, line ? "line %d\n" : "", line);
        _exit(line != 0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

TEST_GROUP(inputs)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_input_of_a_process_is_replaced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
