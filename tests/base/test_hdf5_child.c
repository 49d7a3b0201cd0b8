/* SPDX-License-Identifier: BSD-3-Clause */
/* The process of conus-hdf5, played by shell scripts: its request, and the handling of its answer.
 * tests/loaders/child/test_mesh_child.c has what all children have in common. */
#include "base/child/hdf5.h"
#include "builders/hdf5_builder.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

/* Makes $CONUS_HDF5 a shell script of these lines. */
static void play(const char *lines)
{
    struct buffer script = {0};
    const char *path = test_scratch("conus-hdf5");
    buffer_format(&script, "#!/bin/sh\n%s\n", lines);
    assert_ok(file_write_soon(path, script.data, script.size));
    assert_int_equal(chmod(path, 0700), 0);
    setenv("CONUS_HDF5", path, 1);
    buffer_finish(&script);
}

/* Makes it a script that writes an answer with the group /a. */
static void play_answer(void)
{
    char line[300];
    struct hdf5_builder builder;
    const char *path = test_scratch("stream");
    hdf5_begin(&builder);
    hdf5_group(&builder, "/a");
    hdf5_end(&builder);
    assert_ok(file_write_soon(path, builder.bytes.data, builder.bytes.size));
    snprintf(line, sizeof line, "cat '%s'", path);
    play(line);
    buffer_finish(&builder.bytes);
}

static conus_status read_file(struct hdf5 **out, uint64_t max_memory)
{
    static const char *const wanted[] = {"/a/*/b", "/c d/**"};
    struct open_file file;
    const char *path = test_scratch("input.h5");
    conus_status status = file_exists(path) ? CONUS_OK : file_write_soon(path, "content", 7);
    status = status ? status : file_open(&file, path);
    if (!status) {
        status = hdf5_read(out, &file, wanted, 2, max_memory);
        file_close(&file);
    }
    return status;
}

static void fails_with(uint64_t max_memory, conus_status wanted, const char *part)
{
    struct hdf5 *hdf5 = NULL;
    assert_fails(read_file(&hdf5, max_memory), wanted);
    assert_null(hdf5);
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}

static void it_gets_the_file_a_limit_and_patterns(void **state)
{
    (void)state;
    play("echo \"$# $1 $2 $3 $(cat <&3) $(cat | wc -c)\" >&2; exit 7");
    fails_with(12345, CONUS_ERROR_DATA, "input.h5: conus-hdf5: 3 12345 /a/*/b /c d/** content 0 (exit code 7)");
    fails_with(0, CONUS_ERROR_DATA, "3 8589934592 /a/*/b");
}

static void its_answer_is_read(void **state)
{
    (void)state;
    struct hdf5 *hdf5;
    play_answer();
    assert_ok(read_file(&hdf5, 0));
    assert_int_equal(hdf5_count(hdf5), 1);
    hdf5_destroy(hdf5);
}

static void bad_ends_are_one_line(void **state)
{
    (void)state;
    play("kill -SEGV $$");
    fails_with(0, CONUS_ERROR_DATA, "input.h5: conus-hdf5: HDF5 crashed (signal 11, Segmentation fault)");
    play(":");
    fails_with(0, CONUS_ERROR_DATA, "input.h5: HDF5 stream: it does not begin with CONUSH51");
    play("head -c 3000000 /dev/zero");
    fails_with(1 << 20, CONUS_ERROR_MEMORY, ", allowed are 1048576 (--max-memory)");
    setenv("CONUS_HDF5", "/nowhere/conus-hdf5", 1);
    fails_with(0, CONUS_ERROR_UNSUPPORTED, "conus-hdf5 is needed (Debian package conus-hdf5)");
}

static conus_status attempt(void *data)
{
    struct hdf5 *hdf5 = NULL;
    conus_status status = read_file(&hdf5, 0);
    (void)data;
    hdf5_destroy(hdf5);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    play_answer();
    test_every_allocation(attempt, NULL);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}

TEST_GROUP(hdf5_child)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_gets_the_file_a_limit_and_patterns),
        cmocka_unit_test(its_answer_is_read),
        cmocka_unit_test(bad_ends_are_one_line),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
