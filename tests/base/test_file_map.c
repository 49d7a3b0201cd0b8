/* SPDX-License-Identifier: BSD-3-Clause */
/* Files that change while they are mapped. */
#include "base/files/file_map.h"
#include "base/threads.h"
#include "test.h"

#include <setjmp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { PIECES = 8, SIZE = 64 << 10 };

/* A file of SIZE ones, mapped. */
static uint8_t *map_ones(const char *path, struct file_state *before)
{
    static uint8_t ones[SIZE];
    memset(ones, 1, sizeof ones);
    assert_ok(file_write(path, ones, sizeof ones));
    assert_ok(file_state_find(before, path));
    uint8_t *mapped = file_map(path, before);
    assert_non_null(mapped);
    assert_memory_equal(mapped, ones, sizeof ones);
    return mapped;
}

static void only_what_is_unchanged_is_mapped(void **state)
{
    (void)state;
    struct file_state before;
    const char *path = test_scratch("map.bin");
    uint8_t *mapped = map_ones(path, &before);
    file_guard_begin(mapped, SIZE);
    assert_ok(file_guard_end(path, &before));
    munmap(mapped, SIZE);
    before.times[1]++;
    assert_null(file_map(path, &before));
    assert_null(file_map(test_scratch("none.bin"), &before));
}

struct sums {
    const uint8_t *mapped;
    unsigned of[PIECES];
};

/* From the last byte to the first, so that holes grow. */
static void sum_piece(void *user, size_t piece)
{
    struct sums *sums = user;
    for (size_t i = threads_begin(piece + 1, PIECES, SIZE, 1); i-- > threads_begin(piece, PIECES, SIZE, 1);) {
        sums->of[piece] += sums->mapped[i];
    }
}

static unsigned sum_all(const uint8_t *mapped)
{
    struct sums sums = {.mapped = mapped};
    unsigned sum = 0;
    threads_run(sum_piece, &sums, PIECES);
    for (size_t i = 0; i < PIECES; i++) {
        sum += sums.of[i];
    }
    return sum;
}

static void what_is_cut_off_is_zeros_and_an_error(void **state)
{
    (void)state;
    struct sigaction handlers[2];
    static const unsigned sizes[] = {SIZE - 1, 40000, 1, 0};
    const char *path = test_scratch("cut.bin");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct file_state before;
        uint8_t *mapped = map_ones(path, &before);
        sigset_t all;
        sigset_t masks[2];
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, NULL); /* as where signals are for another thread */
        pthread_sigmask(SIG_SETMASK, NULL, &masks[0]);
        sigaction(SIGBUS, NULL, &handlers[0]);
        file_guard_begin(mapped, SIZE);
        assert_int_equal(truncate(path, (off_t)sizes[i]), 0);
        assert_int_equal(sum_all(mapped), sizes[i]);
        assert_fails(file_guard_end(path, &before), CONUS_ERROR_IO);
        assert_non_null(strstr(conus_message(), "cut.bin: " FILE_CHANGED));
        sigaction(SIGBUS, NULL, &handlers[1]);
        pthread_sigmask(SIG_SETMASK, NULL, &masks[1]);
        assert_true(handlers[0].sa_sigaction == handlers[1].sa_sigaction);
        assert_int_equal(sigismember(&masks[1], SIGBUS), 1);
        sigemptyset(&all);
        pthread_sigmask(SIG_SETMASK, &all, NULL);
        munmap(mapped, SIZE);
    }
}

/* Pages that lie behind the end of an unchanged file stand for a disk that cannot be read. */
static void what_cannot_be_read_is_an_error(void **state)
{
    (void)state;
    struct file_state before;
    struct open_file file;
    const char *path = test_scratch("short.bin");
    munmap(map_ones(path, &before), SIZE);
    assert_ok(file_open(&file, path));
    uint8_t *mapped = mmap(NULL, (size_t)2 * SIZE, PROT_READ, MAP_SHARED, file.descriptor, 0);
    assert_ptr_not_equal(mapped, MAP_FAILED);
    file_guard_begin(mapped, (size_t)2 * SIZE);
    assert_int_equal(sum_all(mapped), SIZE);
    assert_ok(file_guard_end(path, &before));
    file_guard_begin(mapped, (size_t)2 * SIZE);
    assert_int_equal(sum_all(mapped + SIZE), 0);
    assert_fails(file_guard_end(path, &before), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "short.bin: cannot be read to its end"));
    munmap(mapped, (size_t)2 * SIZE);
    file_close(&file);
}

static sigjmp_buf out_of_fault;

static void leave(int number)
{
    siglongjmp(out_of_fault, number);
}

static void faults_elsewhere_are_those_of_others(void **state)
{
    (void)state;
    struct sigaction action = {.sa_handler = leave};
    struct sigaction before_all;
    struct file_state before[2];
    const char *name = test_scratch("other.bin");
    char other[4096];
    snprintf(other, sizeof other, "%s", name);
    uint8_t *volatile unguarded = map_ones(other, &before[0]);
    const char *path = test_scratch("guarded.bin");
    uint8_t *guarded = map_ones(path, &before[1]);
    sigaction(SIGBUS, &action, &before_all);
    file_guard_begin(guarded, SIZE);
    assert_int_equal(truncate(other, 0), 0);
    volatile unsigned read = 0;
    int number = sigsetjmp(out_of_fault, 1);
    if (!number) {
        read = 1U + *(volatile uint8_t *)unguarded;
    }
    assert_int_equal(number, SIGBUS);
    assert_int_equal(read, 0);
    assert_ok(file_guard_end(path, &before[1]));
    sigaction(SIGBUS, &before_all, NULL);
    munmap(unguarded, SIZE);
    munmap(guarded, SIZE);
}

TEST_GROUP(file_map)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_what_is_unchanged_is_mapped),
        cmocka_unit_test(what_is_cut_off_is_zeros_and_an_error),
        cmocka_unit_test(what_cannot_be_read_is_an_error),
        cmocka_unit_test(faults_elsewhere_are_those_of_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
