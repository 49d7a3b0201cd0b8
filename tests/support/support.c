/* SPDX-License-Identifier: BSD-3-Clause */
/* The helpers of test.h: tolerance, failing allocations, paths and random numbers. */
#include "test.h"

#include "base/job/job.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/extraction/parts.h"

#include <errno.h>
#include <ftw.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void test_near(double got, double wanted, double tolerance, const char *what, const char *file, int line)
{
    if (!(fabs(got - wanted) <= tolerance)) {
        print_error("%s = %.12g, wanted %.12g +- %g\n", what, got, wanted, tolerance);
        _fail(file, line);
    }
}

void test_status(conus_status got, conus_status wanted, const char *what, const char *file, int line)
{
    if (got != wanted) {
        print_error("%s gave %s (%s), wanted %s\n", what, conus_status_name(got), conus_message(),
                    conus_status_name(wanted));
        _fail(file, line);
    }
}

static atomic_long fail_at = -1; /* several threads may allocate */
static atomic_bool has_failed;
static atomic_size_t largest; /* 0 = any */

static bool must_fail(size_t size)
{
    if (largest && size > largest) {
        has_failed = true;
        return true;
    }
    long left = fail_at;
    while (left > 0) {
        if (atomic_compare_exchange_weak(&fail_at, &left, left - 1)) {
            return false;
        }
    }
    if (left < 0) {
        return false;
    }
    has_failed = true;
    return true;
}

/* The linker redirects the library's calls to these (--wrap). */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);

void *__wrap_malloc(size_t size)
{
    return must_fail(size) ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return must_fail(count * size) ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t size)
{
    return must_fail(size) ? NULL : __real_realloc(block, size);
}

void test_fail_allocation(long n)
{
    fail_at = n;
    has_failed = false;
}

static size_t primitives, failing_primitive; /* so far; 0 = none fails */
static conus_status primitive_fails_as;

bool __wrap_job_step(struct job *job);

/* In the place of base/job/job_step.c. */
bool __wrap_job_step(struct job *job)
{
    if (job_ok(job) && ++primitives == failing_primitive) {
        job_fail(job, primitive_fails_as, "primitive %zu fails", primitives);
    }
    return job_ok(job);
}

void test_fail_primitive(size_t k, conus_status as)
{
    primitives = 0;
    failing_primitive = k;
    primitive_fails_as = as;
}

size_t test_primitives(void)
{
    return primitives;
}

size_t test_every_primitive(conus_status (*attempt)(void *data), void *data)
{
    test_fail_primitive(0, CONUS_OK);
    assert_ok(attempt(data));
    size_t count = primitives;
    for (size_t k = 1; k <= count; k++) {
        test_fail_primitive(k, CONUS_ERROR_MEMORY);
        assert_fails(attempt(data), CONUS_ERROR_MEMORY);
        test_fail_primitive(k, CONUS_ERROR_DATA);
        conus_status status = attempt(data);
        if (status) { /* else an attempt went on */
            assert_fails(status, CONUS_ERROR_DATA);
        }
    }
    test_fail_primitive(0, CONUS_OK);
    return count;
}

void test_limit_allocations(size_t size)
{
    largest = size;
    has_failed = false;
}

bool test_allocation_failed(void)
{
    return has_failed;
}

/* Whether scripts/test --all or --long runs the test. */
static bool is_thorough(void)
{
    return getenv("CONUS_TEST_ALL") || getenv("CONUS_TEST_LONG");
}

size_t test_cases(size_t all)
{
    enum { SOME = 16, FEW = 128 };
    return getenv("CONUS_TEST_LONG") ? all : all / (getenv("CONUS_TEST_ALL") ? SOME : FEW);
}

bool test_takes(size_t number)
{
    enum { EACH = 4 };
    return is_thorough() || number % EACH == 0;
}

void test_every_allocation(conus_status (*attempt)(void *data), void *data)
{
    enum { LIMIT = 100000, FIRST = 32 };
    const long first = is_thorough() ? LIMIT : FIRST;
    for (long n = 0; n < LIMIT; n += 1 + n / first) {
        test_fail_allocation(n);
        conus_status status = attempt(data);
        bool failed = test_allocation_failed();
        test_fail_allocation(-1);
        if (!failed) {
            assert_ok(status);
            return;
        }
        if (status) {
            assert_fails(status, CONUS_ERROR_MEMORY);
        }
    }
    fail_msg("still failing after %d allocations", LIMIT);
}

static const char *existing(char *path, const char *what)
{
    if (access(path, R_OK)) {
        print_message("skipped: no %s (%s)\n", what, path);
        skip();
    }
    return path;
}

const char *test_mricron(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "/usr/share/mricron/templates/%s", name);
    return existing(path, "mricron-data");
}

const char *test_shared(const char *name)
{
    static char path[1024];
    const char *folder = getenv("CONUS_SHARED_DATA");
    snprintf(path, sizeof path, "%s/%s", folder ? folder : CONUS_SOURCE_DIR "/../shared/data", name);
    return existing(path, "shared data");
}

static char scratch[] = "scratch-XXXXXX";
static pid_t scratch_owner;
static bool scratch_stays;

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *walk)
{
    (void)info;
    (void)type;
    (void)walk;
    remove(path);
    return 0;
}

static void remove_scratch(void)
{
    enum { OPEN_FOLDERS = 8 };
    if (getpid() == scratch_owner && !scratch_stays) { /* not at the end of a child of the test's */
        nftw(scratch, remove_entry, OPEN_FOLDERS, FTW_DEPTH | FTW_PHYS);
    }
}

const char *test_scratch(const char *name)
{
    static char paths[4][256];
    static int turn;
    if (!scratch_owner) {
        assert_non_null(mkdtemp(scratch));
        scratch_owner = getpid();
        assert_int_equal(atexit(remove_scratch), 0);
    }
    char *path = paths[turn++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", scratch, name);
    return path;
}

void test_keep_scratch(void)
{
    scratch_stays = true;
}

static char folder[256];

void test_folder(const char *name)
{
    snprintf(folder, sizeof folder, "%s", test_scratch(name));
    assert_true(!mkdir(folder, 0777) || errno == EEXIST);
}

const char *test_in(const char *name)
{
    static char paths[4][512];
    static int turn;
    char *path = paths[turn++ % 4];
    snprintf(path, sizeof paths[0], "%s%s%s", folder, *name ? "/" : "", name);
    return path;
}

void test_need_conus_mesh(void)
{
    char *path = NULL;
    if (mesh_child_find(&path)) {
        print_message("skipped: %s\n", conus_message());
        skip();
    }
    memory_free(path);
}

bool test_has_note(const conus_atlas *atlas, const char *part)
{
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        if (strstr(conus_atlas_note(atlas, i), part)) {
            return true;
        }
    }
    return false;
}

double test_random(uint64_t *state, double low, double high)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return low + (high - low) * ((double)((z ^ z >> 31) >> 11) * 0x1p-53);
}

size_t test_trials(size_t n)
{
#ifdef __SANITIZE_ADDRESS__
    const bool is_whole = false;
#else
    const bool is_whole = is_thorough();
#endif
    return is_whole ? n : (n + 3) / 4;
}
