/* SPDX-License-Identifier: BSD-3-Clause */
/* A trace records questions to the file system with their answers, and tells whether the answers would be the same
 * now. */
#include "base/files/file_trace.h"
#include "base/files/inputs.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "conus/file.h"
#include "test.h"

#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Asks one question of each kind, about test_in(). */
static void ask_everything(struct file_trace *trace)
{
    struct bytes bytes = {0};
    struct names names = {0};
    char real[SYSTEM_PATH];
    file_trace_begin(trace);
    assert_ok(file_read(&bytes, test_in("file"), 100));
    bytes_finish(&bytes);
    assert_true(file_exists(test_in("file")));
    assert_false(file_exists(test_in("missing")));
    assert_true(file_is_folder(test_in("")));
    assert_ok(names_list(&names, test_in(""), ".txt"));
    names_finish(&names);
    assert_true(file_trace_real_path(real, test_in("link")));
    assert_string_equal(file_trace_environment("CONUS_TEST_SET"), "value");
    assert_null(file_trace_environment("CONUS_TEST_UNSET"));
    file_trace_end(trace);
}

static void write_text(const char *path, const char *text)
{
    assert_ok(file_write_soon(path, text, strlen(text)));
}

static void make_folder(const char *name)
{
    test_folder(name);
    write_text(test_in("file"), "content");
    write_text(test_in("a.txt"), "a");
    unlink(test_in("link"));
    assert_int_equal(symlink("file", test_in("link")), 0);
    setenv("CONUS_TEST_SET", "value", 1);
    unsetenv("CONUS_TEST_UNSET");
}

static void every_question_is_kept_once(void **state)
{
    (void)state;
    struct file_trace trace;
    make_folder("once");
    ask_everything(&trace);
    assert_false(trace.broken);
    assert_int_equal(trace.count, 7); /* the file was asked for twice */
    assert_true(file_trace_holds(&trace));
    assert_non_null(file_trace_find(&trace, test_in("file")));
    assert_null(file_trace_find(&trace, test_in("missing")));
    assert_null(file_trace_find(&trace, test_in("a.txt"))); /* nobody asked for it */
    file_trace_finish(&trace);
}

static void change_content(void)
{
    struct stat info;
    assert_int_equal(stat(test_in("file"), &info), 0);
    write_text(test_in("file"), "CONTENT");
    const struct timespec times[2] = {info.st_atim, info.st_mtim};
    assert_int_equal(utimensat(AT_FDCWD, test_in("file"), times, 0), 0);
}

static void change_mode(void)
{
    assert_int_equal(chmod(test_in("file"), 0600), 0);
}

static void remove_file(void)
{
    assert_int_equal(unlink(test_in("file")), 0);
}

static void make_missing(void)
{
    write_text(test_in("missing"), "x");
}

static void make_missing_a_folder(void)
{
    assert_int_equal(mkdir(test_in("missing"), 0700), 0);
}

static void add_name(void)
{
    write_text(test_in("b.txt"), "b");
}

static void remove_name(void)
{
    assert_int_equal(unlink(test_in("a.txt")), 0);
}

static void turn_link(void)
{
    assert_int_equal(unlink(test_in("link")), 0);
    assert_int_equal(symlink("a.txt", test_in("link")), 0);
}

static void change_variable(void)
{
    setenv("CONUS_TEST_SET", "other", 1);
}

static void set_variable(void)
{
    setenv("CONUS_TEST_UNSET", "", 1);
}

static void exchange_folder(void)
{
    char other[600];
    snprintf(other, sizeof other, "%s-other", test_in(""));
    assert_int_equal(rename(test_in(""), other), 0);
    assert_int_equal(mkdir(test_in(""), 0700), 0);
    static const char *const names[] = {"file", "a.txt", "link"};
    for (size_t i = 0; i < 3; i++) { /* the very same files */
        char from[700];
        snprintf(from, sizeof from, "%s/%s", other, names[i]);
        assert_int_equal(rename(from, test_in(names[i])), 0);
    }
}

static void every_change_is_found(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        void (*change)(void);
    } changes[] = {{"content", change_content},       {"mode", change_mode},
                   {"removed", remove_file},          {"appears", make_missing},
                   {"folder", make_missing_a_folder}, {"name", add_name},
                   {"no-name", remove_name},          {"link", turn_link},
                   {"variable", change_variable},     {"set", set_variable},
                   {"exchanged", exchange_folder}};
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        struct file_trace trace;
        make_folder(changes[i].name);
        ask_everything(&trace);
        assert_true(file_trace_holds(&trace));
        changes[i].change();
        if (file_trace_holds(&trace)) {
            fail_msg("%s: is not found", changes[i].name);
        }
        file_trace_finish(&trace);
    }
}

/* Names that were never asked for, and other changes of the folder. */
static void unasked_files_do_not_count(void **state)
{
    (void)state;
    struct file_trace trace;
    make_folder("others");
    ask_everything(&trace);
    write_text(test_in("c.tsv"), "c");
    write_text(test_in("a.txt"), "another content");
    assert_true(file_trace_holds(&trace));
    file_trace_finish(&trace);
}

static void two_answers_break_a_trace(void **state)
{
    (void)state;
    struct file_trace trace;
    make_folder("broken");
    file_trace_begin(&trace);
    assert_false(file_exists(test_in("missing")));
    make_missing();
    assert_true(file_exists(test_in("missing")));
    file_trace_end(&trace);
    assert_true(trace.broken);
    assert_false(file_trace_is_settled(&trace));
    assert_false(file_trace_holds(&trace));
    file_trace_finish(&trace);
}

/* A file that cannot be read now, but can the next time, has the same state both times. */
static void a_file_that_could_not_be_read_breaks_a_trace(void **state)
{
    (void)state;
    enum { SIZE = 100000 };
    static char text[SIZE];
    struct file_trace trace;
    struct bytes bytes = {0};
    make_folder("failed");
    memset(text, 'x', SIZE);
    assert_ok(file_write_soon(test_in("file"), text, SIZE));
    file_trace_begin(&trace);
    test_limit_allocations(SIZE / 2);
    conus_status status = file_read(&bytes, test_in("file"), SIZE);
    test_limit_allocations(0);
    file_trace_end(&trace);
    assert_fails(status, CONUS_ERROR_MEMORY);
    assert_true(trace.broken);
    assert_false(file_trace_is_settled(&trace));
    file_trace_finish(&trace);
}

/* The clock of the test's files is this machine's on the file systems of the list, where 2 s of rest are enough. */
static void only_files_at_rest_are_settled(void **state)
{
    (void)state;
    struct file_trace trace;
    make_folder("rest");
    ask_everything(&trace);
    assert_false(file_trace_is_settled(&trace));
    trace.begun.tv_sec += TRACE_REST_ELSEWHERE_SECONDS + 2;
    assert_true(file_trace_is_settled(&trace));
    trace.begun.tv_sec -= 2 * TRACE_REST_ELSEWHERE_SECONDS; /* files from the future */
    assert_false(file_trace_is_settled(&trace));
    file_trace_finish(&trace);
    file_trace_begin(&trace); /* a time set back does not help */
    const struct timespec times[2] = {{.tv_sec = 1000}, {.tv_sec = 1000}};
    assert_int_equal(utimensat(AT_FDCWD, test_in("file"), times, 0), 0);
    assert_true(file_exists(test_in("file")));
    file_trace_end(&trace);
    assert_false(file_trace_is_settled(&trace));
    file_trace_finish(&trace);
}

static void devices_are_never_the_same(void **state)
{
    (void)state;
    struct file_trace trace;
    file_trace_begin(&trace);
    assert_false(file_exists("/dev/null"));
    file_trace_end(&trace);
    assert_false(file_trace_is_settled(&trace));
    assert_false(file_trace_holds(&trace));
    file_trace_finish(&trace);
}

static void bytes_give_the_same_trace(void **state)
{
    (void)state;
    struct file_trace trace;
    struct file_trace parsed;
    struct buffer bytes = {0};
    struct buffer again = {0};
    size_t whole = 0;
    make_folder("bytes");
    ask_everything(&trace);
    file_trace_write(&bytes, &trace);
    for (size_t size = 0; size < bytes.size; size++) { /* between two items there is a shorter trace */
        uint8_t *prefix = memory_copy(bytes.data, size, 1);
        if (file_trace_parse(&parsed, prefix, size)) {
            whole++;
            assert_true(parsed.count < trace.count);
            file_trace_finish(&parsed);
        }
        memory_free(prefix);
    }
    assert_int_equal(whole, trace.count);
    assert_true(file_trace_parse(&parsed, (const uint8_t *)bytes.data, bytes.size));
    file_trace_write(&again, &parsed);
    assert_int_equal(again.size, bytes.size);
    assert_memory_equal(again.data, bytes.data, bytes.size);
    assert_true(file_trace_holds(&parsed));
    file_trace_finish(&parsed);
    file_trace_finish(&trace);
    buffer_finish(&bytes);
    buffer_finish(&again);
}

static conus_status attempt(void *data)
{
    struct file_trace trace;
    struct file_trace parsed = {0};
    struct buffer bytes = {0};
    (void)data;
    file_trace_begin(&trace);
    (void)file_exists("missing");
    (void)file_trace_environment("CONUS_TEST_SET");
    file_trace_end(&trace);
    bool broken = trace.broken;
    file_trace_write(&bytes, &trace);
    broken = broken || bytes.failed || !file_trace_parse(&parsed, (const uint8_t *)bytes.data, bytes.size);
    file_trace_finish(&trace);
    file_trace_finish(&parsed);
    buffer_finish(&bytes);
    return broken ? CONUS_ERROR_MEMORY : CONUS_OK;
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
    struct buffer packed = {0};
    struct file_trace trace;
    struct file_trace kept;
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
    file_trace_take(test_in("a.txt"));
    CHECK(inputs_search(false))
    CHECK(strcmp(conus_inputs_find(test_in("a.txt")), test_in("a.txt")) == 0)
    /* a trace that is kept has its inputs, and no other file */
    file_trace_begin(&trace);
    CHECK(file_read(&bytes, hard, 100) == CONUS_OK && file_exists(test_in("a.txt")))
    bytes_finish(&bytes);
    file_trace_end(&trace);
    file_trace_write(&packed, &trace);
    file_trace_finish(&trace);
    CHECK(strcmp(conus_inputs_at(1), hard) == 0 && !conus_inputs_at(2))
    CHECK(file_trace_parse(&kept, (const uint8_t *)packed.data, packed.size))
    file_trace_tell(&kept);
    file_trace_finish(&kept);
    buffer_finish(&packed);
    CHECK(strcmp(conus_inputs_at(2), hard) == 0 && !conus_inputs_at(3))
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
    CHECK(conus_write_file(test_in("missing"), "z", 1) == CONUS_OK && !conus_inputs_at(4))
    /* what it has made itself is no input, until somebody else changes it */
    CHECK(file_read(&bytes, test_in("missing"), 100) == CONUS_OK)
    bytes_finish(&bytes);
    CHECK(conus_write_file(test_in("missing"), "zz", 2) == CONUS_OK && !conus_inputs_at(4))
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

static void every_failing_allocation(void **state)
{
    (void)state;
    test_every_allocation(attempt, NULL);
}

TEST_GROUP(file_trace)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_question_is_kept_once),
        cmocka_unit_test(every_change_is_found),
        cmocka_unit_test(unasked_files_do_not_count),
        cmocka_unit_test(two_answers_break_a_trace),
        cmocka_unit_test(a_file_that_could_not_be_read_breaks_a_trace),
        cmocka_unit_test(only_files_at_rest_are_settled),
        cmocka_unit_test(devices_are_never_the_same),
        cmocka_unit_test(bytes_give_the_same_trace),
        cmocka_unit_test(no_input_of_a_process_is_replaced),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
