/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The header of every test: cmocka, comparison with a tolerance, the n-th failing allocation, real data. */
#ifndef CONUS_TESTS_SUPPORT_TEST_H
#define CONUS_TESTS_SUPPORT_TEST_H

#ifdef NDEBUG
#error "tests are built without NDEBUG: they exercise the library's asserts"
#endif

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "conus/atlas.h"

#undef fail /* cmocka's; ours sets a message. Use fail_msg() to fail a test. */
#undef fail_msg
#define fail_msg(...) (print_error(__VA_ARGS__), print_error("\n"), _fail(__FILE__, __LINE__))

/** The head of the function that runs the tests of test_NAME.c, as the test NAME of CTest. */
#define TEST_GROUP(name)                                                                                               \
    int test_group_##name(void);                                                                                       \
    int test_group_##name(void)

/** Runs what follows for each of these words. */
#define FOR_WORDS(word, ...)                                                                                           \
    for (const char *const *word##_at = (const char *const[]){__VA_ARGS__, NULL}, *word; (word = *word##_at);          \
         word##_at++)

/** Fails unless |got - wanted| <= tolerance (NaN never passes). */
#define assert_near(got, wanted, tolerance)                                                                            \
    test_near((double)(got), (double)(wanted), (double)(tolerance), #got, __FILE__, __LINE__)
void test_near(double got, double wanted, double tolerance, const char *what, const char *file, int line);

/** Fails unless the status is CONUS_OK, showing the message. */
#define assert_ok(status) test_status((status), CONUS_OK, #status, __FILE__, __LINE__)
/** Fails unless the status is @p wanted. */
#define assert_fails(status, wanted) test_status((status), (wanted), #status, __FILE__, __LINE__)
void test_status(conus_status got, conus_status wanted, const char *what, const char *file, int line);

/** Makes the @p n-th allocation from now on (0 = the next) and all later ones fail; a negative n ends it. */
void test_fail_allocation(long n);
/** True when an allocation was made to fail since the last test_fail_allocation(). */
bool test_allocation_failed(void);

/** Makes every allocation of more than @p size bytes fail from now on; 0 ends it. */
void test_limit_allocations(size_t size);

/** Runs @p attempt with the n-th allocation failing for n = 0, 1, 2, ... until it succeeds without a failure; without
 * CONUS_TEST_ALL (scripts/test --all) behind the 32nd for fewer and fewer. Each time it must return CONUS_ERROR_MEMORY,
 * or CONUS_OK if it can do without. @p attempt cleans up after itself. */
void test_every_allocation(conus_status (*attempt)(void *data), void *data);

/** How many of @p all cases a test tries: all in scripts/test --long (CONUS_TEST_LONG), a 16th in scripts/test --all
 * (CONUS_TEST_ALL), else a 128th; always the same ones. */
size_t test_cases(size_t all);
/** Whether a test takes the case @p number: each in scripts/test --all, else every fourth. */
bool test_takes(size_t number);

/** Makes the @p k-th primitive of jobs (base/job/job.h) from now on fail as @p as; 0 = none. */
void test_fail_primitive(size_t k, conus_status as);
/** Primitives since the last test_fail_primitive(). */
size_t test_primitives(void);

/** Runs @p attempt, which must succeed, and then with the k-th primitive of its jobs (base/job/job.h) failing, for
 * every k: for want of memory it must return CONUS_ERROR_MEMORY, and by bad data CONUS_ERROR_DATA, or CONUS_OK where
 * something else did instead. Gives the number of primitives. */
size_t test_every_primitive(conus_status (*attempt)(void *data), void *data);

/** Path of @p name under Debian's mricron templates; skips the test, saying why, where it is absent. Static buffer. */
const char *test_mricron(const char *name);
/** Path of @p name in the shared data (CONUS_SHARED_DATA, else ../shared/data beside the source); skips likewise. */
const char *test_shared(const char *name);
/** Path for a file @p name in a fresh folder of this run of the test program, which goes at its end. Static buffers,
 * four in turn. */
const char *test_scratch(const char *name);
/** Keeps that folder, so that a failure can be looked into. */
void test_keep_scratch(void);

/** Makes the folder test_scratch(@p name), unless it is there; test_in() means it from now on. */
void test_folder(const char *name);
/** Path of @p name in that folder, "" for the folder itself. Static buffers, four in turn. */
const char *test_in(const char *name);

/** Skips the running test, saying why, where there is no program conus-mesh. */
void test_need_conus_mesh(void);

/** Whether a note of the atlas contains @p part. */
bool test_has_note(const conus_atlas *atlas, const char *part);

/** A deterministic generator (SplitMix64), so that random tests repeat. Uniform in [low, high). */
double test_random(uint64_t *state, double low, double high);

/** How many of @p n random trials a test makes: all of them in scripts/test --all (CONUS_TEST_ALL), else a fourth; so,
 * too, in a build with AddressSanitizer. That one is slow and needs every path once; the full number is for comparing
 * results, in the build without it. */
size_t test_trials(size_t n);

#endif
