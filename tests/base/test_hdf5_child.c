/* SPDX-License-Identifier: BSD-3-Clause */
/* The process of conus-hdf5, played by shell scripts: its request, and the handling of its answer.
 * tests/loaders/extraction/test_mesh_child.c has what all children have in common. */
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

/* Counts the objects of the answer. */
static conus_status read_file(size_t *count, uint64_t max_memory)
{
    static const char *const wanted[] = {"/a/*/b", "/c d/**"};
    struct open_file file;
    struct job job = {.max_memory = max_memory};
    const char *path = test_scratch("input.h5");
    job_took(&job, file_exists(path) ? CONUS_OK : file_write_soon(path, "content", 7));
    if (JOB_CALL(&job, file_open(&file, path))) {
        job_in(&job, path, JOB_ALONE);
        *count = hdf5_count(hdf5_open(&job, &file, wanted, 2));
        file_close(&file);
    }
    return job_close(&job, NULL, NULL);
}

static void fails_with(uint64_t max_memory, conus_status wanted, const char *part)
{
    size_t count;
    assert_fails(read_file(&count, max_memory), wanted);
    assert_int_equal(count, 0);
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
    size_t count;
    play_answer();
    assert_ok(read_file(&count, 0));
    assert_int_equal(count, 1);
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
    size_t count;
    (void)data;
    return read_file(&count, 0);
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
