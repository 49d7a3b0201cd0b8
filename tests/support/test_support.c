/* SPDX-License-Identifier: BSD-3-Clause */
/* The scratch folders of test runs stay apart and are removed at the end. */
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

struct run {
    pid_t child;
    int notified; /* its folder, */
    int go;       /* and it ends when this closes */
};

/* Another run of this program: makes files, reports its folder, and waits. It calls no assertion: they are the
 * parent's. */
static void run_child(int notify, int go)
{
    char path[256] = {0};
    char byte;
    snprintf(path, sizeof path, "%s", test_scratch(""));
    bool made = !mkdir(test_scratch("sub"), 0777) && !mkdir(test_scratch("sub/below"), 0777) &&
                !conus_write_file(test_scratch("sub/below/a.txt"), "a", 1) && !symlink("nowhere", test_scratch("link"));
    bool sent = write(notify, path, sizeof path) == sizeof path && read(go, &byte, 1) == 0;
    exit(made && sent ? 0 : 1);
}

static struct run start_run(void)
{
    int notify[2];
    int go[2];
    assert_int_equal(pipe(notify), 0);
    assert_int_equal(pipe(go), 0);
    fflush(NULL);
    struct run run = {.child = fork(), .notified = notify[0], .go = go[1]};
    if (run.child == 0) {
        close(go[1]);
        run_child(notify[1], go[0]);
    }
    assert_true(run.child > 0);
    close(notify[1]);
    close(go[0]);
    return run;
}

static void end_run(const struct run *run)
{
    int code;
    close(run->go);
    close(run->notified);
    assert_int_equal(waitpid(run->child, &code, 0), run->child);
    assert_int_equal(code, 0);
}

/* Two runs at the same time: each has its own folder, which is removed with all that is in it. The first run that makes
 * one here is a child, so that they do not share the parent's. */
static void a_run_has_a_folder_of_its_own(void **state)
{
    (void)state;
    char paths[2][256];
    struct run first = start_run();
    assert_int_equal(read(first.notified, paths[0], sizeof paths[0]), sizeof paths[0]);
    assert_int_equal(access(paths[0], F_OK), 0);
    struct run second = start_run();
    assert_int_equal(read(second.notified, paths[1], sizeof paths[1]), sizeof paths[1]);
    assert_string_not_equal(paths[0], paths[1]);
    end_run(&second);
    assert_int_equal(access(paths[1], F_OK), -1);
    assert_int_equal(access(paths[0], F_OK), 0);
    end_run(&first);
    assert_int_equal(access(paths[0], F_OK), -1);
}

/* A child of a test that ends by exit() leaves the folder to its parent. */
static void a_child_leaves_the_folder(void **state)
{
    (void)state;
    test_folder("kept");
    assert_int_equal(access(test_in(""), F_OK), 0);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        exit(0);
    }
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_int_equal(access(test_in(""), F_OK), 0);
    test_folder("kept"); /* it exists already */
}

TEST_GROUP(support)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_has_a_folder_of_its_own),
        cmocka_unit_test(a_child_leaves_the_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
