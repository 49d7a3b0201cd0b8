/* SPDX-License-Identifier: BSD-3-Clause */
/* The process of conus-mesh, played by shell scripts: its limits, and the handling of its output and end. */
#include "base/files/file.h"
#include "base/memory.h"
#include "builders/mesh_builder.h"
#include "loaders/extraction/parts.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const struct child_limits limits = {.memory = UINT64_C(1) << 30, .seconds = 20, .wait = 100};

/* Makes $CONUS_MESH a shell script of these lines. */
static void play(const char *lines)
{
    struct buffer script = {0};
    const char *path = test_scratch("conus-mesh");
    buffer_format(&script, "#!/bin/sh\n%s\n", lines);
    assert_ok(file_write_soon(path, script.data, script.size));
    assert_int_equal(chmod(path, 0700), 0);
    setenv("CONUS_MESH", path, 1);
    buffer_finish(&script);
}

/* Makes it a script that writes these bytes and ends with 0. */
static void play_bytes(const struct buffer *bytes)
{
    char line[300];
    const char *path = test_scratch("stream");
    assert_ok(file_write_soon(path, bytes->data, bytes->size));
    snprintf(line, sizeof line, "cat '%s'", path);
    play(line);
}

static conus_status count_frame(void *user, const struct mesh_frame *frame)
{
    (void)frame;
    (*(size_t *)user)++;
    return CONUS_OK;
}

static conus_status run(size_t *frames, const struct child_limits *allowed)
{
    struct mesh_child_request request = {.voxels = "voxels", .size = 6};
    buffer_text(&request.head, "request and ");
    conus_status status = buffer_status(&request.head);
    *frames = 0;
    status = status ? status : mesh_child_run(&request, allowed, count_frame, frames);
    buffer_finish(&request.head);
    return status;
}

static void check_no_process_is_left(void)
{
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}

static void fails_within(const struct child_limits *allowed, const char *lines, const char *part)
{
    size_t frames;
    play(lines);
    assert_fails(run(&frames, allowed), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
    check_no_process_is_left();
}

static void fails_with(const char *lines, const char *part)
{
    fails_within(&limits, lines, part);
}

static void has_no_end(const char *lines, const char *part)
{
    const struct child_limits short_limits = {.memory = UINT64_C(1) << 30, .seconds = 1, .wait = 2};
    fails_within(&short_limits, lines, part);
}

static void build(struct buffer *out, uint32_t count)
{
    build_start(out);
    for (uint32_t i = 0; i < count; i++) {
        build_tetrahedron(out, i, MESH_SPACE_RAS, 2);
    }
    build_end(out, count);
}

static void frames_come_one_by_one(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    size_t frames;
    build(&bytes, 20000); /* 2.5 MB: more than a pipe and one reading hold */
    play_bytes(&bytes);
    assert_ok(run(&frames, &limits));
    assert_int_equal(frames, 20000);
    check_no_process_is_left();
    buffer_finish(&bytes);
}

static void the_request_comes_whole(void **state)
{
    (void)state;
    fails_with("echo \"got: $(cat \"$1\"), $(cat | wc -c) bytes on stdin\" >&2; exit 7",
               "got: request and voxels, 0 bytes on stdin (exit code 7)");
}

static void bad_ends_are_one_line(void **state)
{
    (void)state;
    fails_with("kill -SEGV $$", "VTK crashed (signal 11, Segmentation fault)");
    fails_with("kill -ABRT $$", "VTK crashed (signal 6, Aborted)");
    fails_with("echo garbage, which is longer than a frame", "it does not begin with CONUSMS1");
    has_no_end("exec >&- 2>&-; exec sleep 30", "no end after 2 seconds");
    fails_with("printf CONUS", "its output is cut off or too long");
    fails_with(":", "its output is cut off or too long");
    fails_with("printf CONUSMS1", "its output is cut off or too long");
    fails_with("echo first >&2; echo second >&2; exit 3", "conus-mesh: first (exit code 3)");
    has_no_end("exec sleep 60", "no end after 2 seconds");
    has_no_end("while :; do :; done", "no end after "); /* 1 second of work, or 2 of waiting on a busy machine */
    fails_with("yes | head -c 100000 >&2; exit 1", "conus-mesh: y (exit code 1)");
}

static void every_prefix_of_a_stream_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    size_t frames;
    build(&bytes, 1);
    for (size_t size = 0; size < bytes.size; size += size < 12 || size > bytes.size - 12 ? 1 : 19) {
        const struct buffer prefix = {.data = bytes.data, .size = size};
        play_bytes(&prefix);
        assert_fails(run(&frames, &limits), CONUS_ERROR_DATA);
    }
    buffer_text(&bytes, "x");
    play_bytes(&bytes);
    assert_fails(run(&frames, &limits), CONUS_ERROR_DATA);
    check_no_process_is_left();
    buffer_finish(&bytes);
}

static void a_mesh_beyond_the_memory_is_refused_before_it_comes(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    size_t frames;
    build_start(&bytes);
    build_header(&bytes, (struct built_frame){MESH_FRAME_MESH, 0, 0, NULL, UINT32_MAX, UINT32_MAX});
    play_bytes(&bytes);
    assert_fails(run(&frames, &limits), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "an answer of 103079215112 bytes, allowed are 1073741824"));
    check_no_process_is_left();
    buffer_finish(&bytes);
}

static void limits_hold_the_process(void **state)
{
    (void)state;
    fails_with("ulimit -v >&2; exit 1", "conus-mesh: 1048576 (exit code 1)");
    fails_with("ulimit -t >&2; exit 1", "conus-mesh: 20 (exit code 1)");
}

/* A child that the system kills because memory is short is not reported as too slow. */
static void a_killed_program_is_told_from_a_slow_one(void **state)
{
    (void)state;
    size_t frames;
    play("kill -KILL $$");
    assert_fails(run(&frames, &limits), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "no memory left"));
    assert_null(strstr(conus_message(), "seconds"));
    check_no_process_is_left();
}

/* The process can write to no file and gain no rights, and has none of this process's other open files. */
static void the_process_is_confined(void **state)
{
    (void)state;
    int open_here = dup2(STDERR_FILENO, 77); /* without FD_CLOEXEC */
    assert_int_equal(open_here, 77);
    fails_with("ulimit -f >&2; exit 1", "conus-mesh: 0 (exit code 1)");
    fails_with("grep NoNewPrivs /proc/self/status | tr -cd 0-9 >&2; exit 1", "conus-mesh: 1 (exit code 1)");
    fails_with("[ -e /proc/self/fd/77 ] && echo open >&2 || echo shut >&2; exit 1", "conus-mesh: shut (exit code 1)");
    close(open_here);
}

static void a_program_that_cannot_start_is_said_so(void **state)
{
    (void)state;
    size_t frames;
    const char *path = test_scratch("conus-mesh");
    assert_ok(file_write_soon(path, "#!/nowhere/sh\n", 14));
    assert_int_equal(chmod(path, 0700), 0);
    setenv("CONUS_MESH", path, 1);
    assert_fails(run(&frames, &limits), CONUS_ERROR_IO);
    assert_string_equal(conus_message(), "conus-mesh: cannot start: No such file or directory");
    check_no_process_is_left();
}

static void it_is_looked_for(void **state)
{
    (void)state;
    char *path = NULL;
    char folder[4096];
    play(":");
    assert_ok(mesh_child_find(&path));
    assert_string_equal(path, getenv("CONUS_MESH"));
    memory_free(path);

    setenv("CONUS_MESH", "/nowhere/conus-mesh", 1);
    assert_fails(mesh_child_find(&path), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "/nowhere/conus-mesh"));

    unsetenv("CONUS_MESH");
    snprintf(folder, sizeof folder, "/nowhere::%s", test_scratch(""));
    setenv("PATH", folder, 1);
    assert_ok(mesh_child_find(&path));
    assert_non_null(strstr(path, test_scratch("")));
    memory_free(path);

    setenv("PATH", "", 1);
    assert_fails(mesh_child_find(&path), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "the program conus-mesh is not installed (Debian package conus-mesh)"));
    setenv("PATH", "/bin:/usr/bin", 1);
}

static conus_status attempt(void *data)
{
    size_t frames;
    conus_status status = run(&frames, &limits);
    (void)data;
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    build(&bytes, 2);
    play_bytes(&bytes);
    test_every_allocation(attempt, NULL);
    check_no_process_is_left();
    buffer_finish(&bytes);
}

TEST_GROUP(mesh_child)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_one_by_one),
        cmocka_unit_test(the_request_comes_whole),
        cmocka_unit_test(bad_ends_are_one_line),
        cmocka_unit_test(every_prefix_of_a_stream_is_refused),
        cmocka_unit_test(a_mesh_beyond_the_memory_is_refused_before_it_comes),
        cmocka_unit_test(limits_hold_the_process),
        cmocka_unit_test(a_killed_program_is_told_from_a_slow_one),
        cmocka_unit_test(the_process_is_confined),
        cmocka_unit_test(a_program_that_cannot_start_is_said_so),
        cmocka_unit_test(it_is_looked_for),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
