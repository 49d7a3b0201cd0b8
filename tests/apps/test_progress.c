/* SPDX-License-Identifier: BSD-3-Clause */
/* Progress in a log: a line every five minutes, with the time that is left. The clock is not waited for: the fields
 * that hold its times are set back. */
#include "options/progress.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Takes the lines of two updates and of the end from standard error, which is redirected to a file. */
static void take_lines(char out[512], struct progress *progress, double ago_ms, uint64_t done, uint64_t errors)
{
    const char *path = test_scratch("said");
    assert_non_null(freopen(path, "w", stderr));
    progress->started -= ago_ms;
    progress->shown -= ago_ms;
    progress_update(progress, done, errors);
    progress_update(progress, done, errors); /* at once again: nothing */
    progress_finish(progress, done, errors);
    fflush(stderr);
    FILE *file = fopen(path, "r");
    out[fread(out, 1, 511, file)] = '\0';
    fclose(file);
}

static void assert_said(enum progress_kind kind, bool quiet, double ago_ms, uint64_t total, const char *wanted)
{
    char said[512];
    struct progress progress;
    assert_non_null(freopen(test_scratch("before"), "w", stderr)); /* no terminal when it begins */
    progress_start(&progress, kind, quiet, "poses", total);
    assert_false(progress_is_shown(&progress)); /* so that nobody counts for it */
    take_lines(said, &progress, ago_ms, 100, 3);
    if (strncmp(said, wanted, strlen(wanted)) != 0 || (*wanted == '\0' && *said)) {
        fail_msg("said \"%s\", wanted \"%s\"", said, wanted);
    }
}

/* 100 poses in 1000 s are one in 10 s; 900 more take 9000 s, 2.5 h. */
static void a_log_gets_a_line_now_and_then(void **state)
{
    (void)state;
    assert_said(PROGRESS_AUTO, false, 1e6, 1000, "conus: 100 of 1000 poses, 0.1/s, 10 %, 2.5 h left, 3 errors\n");
    assert_said(PROGRESS_AUTO, false, 1e6, 160, "conus: 100 of 160 poses, 0.1/s, 62 %, 10 min left, 3 errors\n");
    assert_said(PROGRESS_AUTO, false, 1e6, 110, "conus: 100 of 110 poses, 0.1/s, 91 %, 100 s left, 3 errors\n");
    assert_said(PROGRESS_AUTO, false, 1e6, 0, "conus: 100 poses, 0.1/s, 3 errors\n");
    assert_said(PROGRESS_AUTO, false, 299e3, 1000, "");
    assert_said(PROGRESS_AUTO, true, 1e6, 1000, "");
    assert_said(PROGRESS_NONE, false, 1e6, 1000, "");
}

TEST_GROUP(progress)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_log_gets_a_line_now_and_then),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
