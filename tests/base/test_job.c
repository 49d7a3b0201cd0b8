/* SPDX-License-Identifier: BSD-3-Clause */
/* Jobs: the first error and its places, attempts, notes and sinks, memory that is given away or released, and each
 * primitive failing. */
#include "base/job/job.h"

#include "base/memory.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

struct numbering {
    size_t *at;
    size_t count, capacity;
};

static void the_first_error_stays_with_its_places(void **state)
{
    (void)state;
    struct job job = {0};
    size_t file = job_in(&job, "a.json", JOB_ALONE);
    size_t list = job_in(&job, "areas", 3);
    job_at(&job, "areas", 4);
    job_in(&job, "line ", 7);
    job_bad(&job, "label: found %d", 0);
    job_out(&job, list);
    job_refuse(&job, "another");
    job_out(&job, file);
    assert_false(job_ok(&job));
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "a.json: areas[4]: line 7: label: found 0");
}

static void an_early_return_is_healed_by_the_mark(void **state)
{
    (void)state;
    struct job job = {0};
    size_t mark = job_in(&job, "a", JOB_ALONE);
    job_in(&job, "b", JOB_ALONE); /* and not left */
    job_out(&job, mark);
    job_fail(&job, CONUS_ERROR_IO, "here");
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_IO);
    assert_string_equal(conus_message(), "here");
}

static void after_a_failure_nothing_happens(void **state)
{
    (void)state;
    struct job job = {0};
    struct numbering list = {0};
    size_t *kept = LIST_ADD(&job, &list);
    *kept = 7;
    job_bad(&job, "wrong");
    size_t count = 5;
    assert_null(job_array(&job, &count, 4));
    assert_int_equal(count, 0);
    assert_null(job_raw(&job, 1, 1));
    assert_null(job_name(&job, text_from("name")));
    assert_string_equal(job_format(&job, "%d", 1), "");
    assert_string_equal(job_copy(&job, text_from("text")), "");
    *LIST_ADD(&job, &list) = 8; /* the spare one */
    assert_int_equal(list.count, 1);
    assert_int_equal(list.at[0], 7);
    assert_null(job_adopt(&job, memory_raw(1, 1))); /* freed: a sanitizer would tell */
    assert_null(job_read(&job, "/dev/null", 1, "").data);
    assert_false(job_has_file(&job, "/"));
    job_warn(&job, "unheard");
    assert_int_equal(job.notes.count, 0);
    job_end(&job);
}

static void a_list_keeps_its_elements_while_it_grows(void **state)
{
    (void)state;
    enum { MANY = 10000 };
    struct job job = {0};
    struct numbering list = {0};
    for (size_t i = 0; i < MANY; i++) {
        size_t *number = LIST_ADD(&job, &list);
        assert_int_equal(*number, 0);
        *number = i * i;
    }
    for (size_t i = 0; i < MANY; i++) {
        assert_int_equal(list.at[i], i * i);
    }
    assert_true(job_ok(&job));
    job_end(&job);
}

static void a_dropped_attempt_leaves_only_memory(void **state)
{
    (void)state;
    struct job job = {0};
    const struct bytes content = {(uint8_t *)"abc", 3};
    job_note(&job, "before");
    size_t mark = job_in(&job, "around", 1);
    struct attempt attempt = job_try(&job);
    job_in(&job, "table.tsv", JOB_ALONE);
    char *name = job_name(&job, text_from(" kept "));
    job_warn(&job, "inside");
    job_made_of(&job, "table.tsv", &content);
    job_bad(&job, "no table");
    const char *why = attempt_end(&job, &attempt, ATTEMPT_DROP);
    assert_string_equal(why, "table.tsv: no table");
    assert_true(job_ok(&job));
    assert_string_equal(name, "kept");
    assert_int_equal(job.notes.count, 1);
    assert_int_equal(job.files.count, 0);
    job_out(&job, mark);
    job_bad(&job, "after");
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "after");
}

static void hear(void *user, const conus_note *note)
{
    char *heard = user;
    size_t used = strlen(heard);
    snprintf(heard + used, 100 - used, "%s:%s;", note->path, note->line);
}

/* An element with a list of its own, as rows of files have. */
struct row {
    LIST(struct row) rows;
    int number;
};

static void what_is_refused_has_a_place_of_its_own(void **state)
{
    (void)state;
    struct job job = {0};
    LIST(struct row) rows = {0};
    struct attempt attempt = job_try(&job);
    job_bad(&job, "no row");
    struct row *outer = LIST_ADD(&job, &rows);
    struct row *inner = LIST_ADD(&job, &outer->rows);
    inner->number = -1; /* which is no part of the outer one, nor of its list */
    inner->rows.at = inner;
    assert_null(outer->rows.at);
    assert_int_equal(outer->number, 0);
    assert_int_equal(outer->rows.count + rows.count, 0);
    assert_string_equal(attempt_end(&job, &attempt, ATTEMPT_TRY), "no row");
    outer = LIST_ADD(&job, &rows);
    job_bad(&job, "again");
    assert_int_equal(LIST_ADD(&job, &rows)->number, 0);
    assert_int_equal(inner->number, -1); /* what was given stays */
    assert_int_equal(rows.count, 1);
    job_end(&job);
}

static void a_silent_attempt_leaves_its_error_only(void **state)
{
    (void)state;
    for (int fails = 0; fails < 2; fails++) {
        char heard[100] = "";
        struct note_sink sink = {hear, heard, "p"};
        struct job job = {.sink = &sink};
        const struct bytes content = {(uint8_t *)"abc", 3};
        struct attempt attempt = job_try(&job);
        job_note(&job, "inside");
        job_made_of(&job, "a", &content);
        if (fails) {
            job_bad(&job, "wrong");
        }
        assert_null(attempt_end(&job, &attempt, ATTEMPT_SILENT));
        assert_int_equal(job.notes.count + job.files.count, 0);
        assert_string_equal(heard, "");
        assert_int_equal(job_close(&job, NULL, NULL), fails ? CONUS_ERROR_DATA : CONUS_OK);
    }
}

static bool count_files(void *user, const char *path, size_t done, size_t total)
{
    snprintf(user, 100, "%s %zu/%zu", path, done, total);
    return done < 2;
}

static void a_job_reports_and_is_cancelled(void **state)
{
    (void)state;
    char said[100] = "";
    struct job job = {.progress = count_files, .progress_user = said, .total = 3};
    job_report(&job, "a", 2);
    assert_string_equal(said, "a 0/3");
    assert_true(job_ok(&job));
    job_report(&job, "b", 1);
    assert_string_equal(said, "b 2/3");
    job_report(&job, "c", 1); /* nobody hears of it */
    assert_string_equal(said, "b 2/3");
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_CANCELLED);
    assert_string_equal(conus_message(), "b: cancelled before it was read");
}

static void a_kept_attempt_is_a_part_of_what_is_around(void **state)
{
    (void)state;
    struct job job = {0};
    struct notes notes = {0};
    struct file_sums files = {0};
    const struct bytes content = {(uint8_t *)"abc", 3};
    struct attempt attempt = job_try(&job);
    job_note(&job, "inside");
    job_made_of(&job, "a", &content);
    assert_null(attempt_end(&job, &attempt, ATTEMPT_TRY));
    attempt = job_try(&job);
    job_note(&job, "gone");
    assert_string_equal(attempt_end(&job, &attempt, ATTEMPT_DROP), ""); /* without an error, too */
    assert_ok(job_close(&job, &notes, &files));
    assert_int_equal(notes.count, 1);
    assert_string_equal(notes.lines[0], "inside");
    assert_int_equal(files.count, 1);
    /* SHA-256 of "abc": FIPS 180-4, example 1. */
    assert_string_equal(files.items[0].sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    notes_finish(&notes);
    file_sums_finish(&files);
}

static void errors_of_memory_and_cancelling_end_attempts_too(void **state)
{
    (void)state;
    const conus_status kinds[] = {CONUS_ERROR_MEMORY, CONUS_ERROR_CANCELLED};
    for (size_t i = 0; i < 2; i++) {
        struct job job = {0};
        struct attempt outer = job_try(&job);
        struct attempt inner = job_try(&job);
        job_fail(&job, kinds[i], "no more");
        assert_string_equal(attempt_end(&job, &inner, ATTEMPT_DROP), "");
        assert_string_equal(attempt_end(&job, &outer, ATTEMPT_TRY), "");
        struct attempt late = job_try(&job);
        assert_string_equal(attempt_end(&job, &late, ATTEMPT_DROP), "");
        assert_fails(job_close(&job, NULL, NULL), kinds[i]);
    }
}

static void a_file_above_a_limit_is_no_want_of_memory(void **state)
{
    (void)state;
    struct job job = {0};
    const char *path = test_scratch("large");
    assert_ok(file_write(path, "0123456789", 10));
    struct attempt attempt = job_try(&job);
    assert_null(job_read(&job, path, 9, "").data);
    assert_int_equal(job.status, CONUS_ERROR_MEMORY);
    assert_string_equal(attempt_end(&job, &attempt, ATTEMPT_TRY), "file of 10 bytes, allowed are 9");
    assert_true(job_ok(&job));
    attempt = job_try(&job);
    job_fail(&job, CONUS_ERROR_MEMORY, "no more");
    (void)attempt_end(&job, &attempt, ATTEMPT_DROP);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_MEMORY);
}

static void the_sink_hears_what_was_kept_in_order(void **state)
{
    (void)state;
    char heard[100] = "";
    struct note_sink sink = {hear, heard, "p"};
    struct job job = {.sink = &sink};
    struct notes notes = {0};
    job_note(&job, "a");
    assert_string_equal(heard, "p:a;");
    struct attempt outer = job_try(&job);
    job_note(&job, "b");
    struct attempt inner = job_try(&job);
    job_note(&job, "c");
    (void)attempt_end(&job, &inner, ATTEMPT_DROP);
    job_note(&job, "d");
    assert_string_equal(heard, "p:a;");
    attempt_end(&job, &outer, ATTEMPT_KEEP);
    assert_string_equal(heard, "p:a;p:b;p:d;");
    (void)JOB_CALL(&job, notes_add(&job.notes, "e")); /* a function that reports a status */
    assert_string_equal(heard, "p:a;p:b;p:d;p:e;");
    notes.sink = &sink;
    assert_ok(job_close(&job, &notes, NULL)); /* not again */
    assert_string_equal(heard, "p:a;p:b;p:d;p:e;");
    assert_int_equal(notes.count, 4);
    notes_finish(&notes);
}

static void what_is_given_outlives_the_job(void **state)
{
    (void)state;
    struct job job = {0};
    char *small = job_copy(&job, text_from("small")); /* in the arena */
    uint8_t *large = job_zeroed(&job, 100000, 1);     /* a block of its own */
    small = job_give(&job, small, sizeof "small");
    large = job_give(&job, large, 100000);
    job_end(&job);
    assert_string_equal(small, "small");
    assert_int_equal(large[99999], 0);
    memory_free(small);
    memory_free(large);
}

/* The first small thing begins where the arena's block does, or nearly. */
static void one_block_ends_early(void **state)
{
    (void)state;
    struct job job = {0};
    char *first = job_copy(&job, text_from("first"));
    char *other = job_copy(&job, text_from("other"));
    uint8_t *large = job_raw(&job, 1 << 16, 1);
    job_drop(&job, first);
    job_drop(&job, large);
    job_drop(&job, NULL);
    job_drop(&job, job.nothing);
    large = job_zeroed(&job, 1 << 16, 1);
    assert_non_null(large);
    assert_string_equal(other, "other");
    first = job_give(&job, job_copy(&job, text_from("given")), sizeof "given");
    job_end(&job);
    assert_string_equal(first, "given");
    memory_free(first);
}

static void count_end(void *user)
{
    ++*(int *)user;
}

static void what_is_owned_is_ended_once(void **state)
{
    (void)state;
    int ends = 0;
    struct job job = {0};
    job_own(&job, count_end, &ends);
    struct job_mark mark = job_mark(&job);
    job_own(&job, count_end, &ends);
    job_release(&job, mark);
    assert_int_equal(ends, 1);
    job_bad(&job, "wrong");
    job_own(&job, count_end, &ends); /* at once */
    assert_int_equal(ends, 2);
    job_end(&job);
    assert_int_equal(ends, 3);
}

static void released_memory_is_used_again(void **state)
{
    (void)state;
    struct job job = {0};
    (void)job_raw(&job, 10, 1);
    struct job_mark mark = job_mark(&job);
    for (int i = 0; i < 1000; i++) {
        memset(job_raw(&job, 1000, 1), i, 1000);
        job_release(&job, mark);
    }
    assert_int_equal(job.block_count, mark.blocks);
    job_end(&job);
}

static void sizes_that_do_not_multiply_are_refused(void **state)
{
    (void)state;
    struct job job = {0};
    assert_null(job_raw(&job, SIZE_MAX / 2, 4));
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_MEMORY);
}

static void files_say_what_is_wrong_without_their_path(void **state)
{
    (void)state;
    struct job job = {0};
    size_t mark = job_in(&job, "/", JOB_ALONE);
    assert_null(job_read(&job, "/", 10, "").data);
    job_out(&job, mark);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_IO);
    assert_string_equal(conus_message(),
                        "/: cannot read: is a folder, a regular file is needed: name those in it one by one");
}

static void names_of_a_folder_are_sorted(void **state)
{
    (void)state;
    struct job job = {0};
    test_folder("names");
    assert_ok(conus_write_file(test_in("b.x"), "", 0));
    assert_ok(conus_write_file(test_in("a.x"), "", 0));
    assert_ok(conus_write_file(test_in("c.y"), "", 0));
    struct names names = job_names(&job, test_in(""), ".x");
    assert_int_equal(names.count, 2);
    assert_string_equal(names.names[0], "a.x");
    assert_string_equal(names.names[1], "b.x");
    assert_int_equal(job_names(&job, test_in("none"), "").count, 0);
    job_bad(&job, "wrong");
    assert_int_equal(job_names(&job, test_in(""), ".x").count, 0);
    job_end(&job);
}

/* A piece of work that uses every primitive, and goes on after an attempt. */
static conus_status work(void *data)
{
    (void)data;
    struct job job = {0};
    struct notes notes = {0};
    struct file_sums files = {0};
    struct numbering list = {0};
    const struct bytes content = {(uint8_t *)"abc", 3};
    for (int i = 0; i < 20 && job_ok(&job); i++) {
        *LIST_ADD(&job, &list) = 1;
    }
    struct attempt attempt = job_try(&job);
    size_t count = 70000;
    uint8_t *array = job_array(&job, &count, 1);
    memset(array ? array : job.reserve, 1, array ? count : 1);
    job_note(&job, "%s", job_name(&job, text_from("a name")) ? "named" : "not");
    (void)attempt_notes(&job, &attempt);
    *LIST_ADD(&job, &list) = 2;
    *LIST_ADD(&job, &list) = 3;
    const char *why = attempt_end(&job, &attempt, ATTEMPT_TRY);
    if (why) {
        job_warn(&job, "%s: passed over", why);
    }
    job_made_of(&job, job_copy(&job, text_from("path")), &content);
    job_own(&job, memory_free, memory_raw(8, 1));
    memory_free(job_give(&job, job_adopt(&job, memory_raw(8, 1)), 8));
    conus_status status = job_close(&job, &notes, &files);
    notes_finish(&notes);
    file_sums_finish(&files);
    return status;
}

static void every_failing_primitive(void **state)
{
    (void)state;
    assert_in_range(test_every_primitive(work, NULL), 25, 60);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    test_every_allocation(work, NULL);
}

TEST_GROUP(job)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_error_stays_with_its_places),
        cmocka_unit_test(an_early_return_is_healed_by_the_mark),
        cmocka_unit_test(after_a_failure_nothing_happens),
        cmocka_unit_test(a_list_keeps_its_elements_while_it_grows),
        cmocka_unit_test(what_is_refused_has_a_place_of_its_own),
        cmocka_unit_test(a_silent_attempt_leaves_its_error_only),
        cmocka_unit_test(a_job_reports_and_is_cancelled),
        cmocka_unit_test(a_dropped_attempt_leaves_only_memory),
        cmocka_unit_test(a_kept_attempt_is_a_part_of_what_is_around),
        cmocka_unit_test(errors_of_memory_and_cancelling_end_attempts_too),
        cmocka_unit_test(a_file_above_a_limit_is_no_want_of_memory),
        cmocka_unit_test(the_sink_hears_what_was_kept_in_order),
        cmocka_unit_test(what_is_given_outlives_the_job),
        cmocka_unit_test(what_is_owned_is_ended_once),
        cmocka_unit_test(released_memory_is_used_again),
        cmocka_unit_test(sizes_that_do_not_multiply_are_refused),
        cmocka_unit_test(files_say_what_is_wrong_without_their_path),
        cmocka_unit_test(names_of_a_folder_are_sorted),
        cmocka_unit_test(one_block_ends_early),
        cmocka_unit_test(every_failing_primitive),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
