/* SPDX-License-Identifier: BSD-3-Clause */
/* Batches through the library: order, bytes that depend on the poses alone, errors, ends. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "scene.h"
#include "selection/report/report.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

enum { POSES = 400, BAD = 7 }; /* every BAD-th row is no pose */

struct fixture {
    conus_atlas *atlas;
    conus_selector *selector;
    const char *path;        /* of the poses */
    struct buffer reference; /* the rows, by conus_select() and a report */
};

/* The blocks that a sink receives, and its behaviour. */
struct received {
    struct buffer text;
    uint64_t poses, errors, blocks;
    uint64_t stop_after; /* blocks; 0 = never */
    bool is_of_fixture;  /* the poses are write_poses()'s, all from the first on */
};

static bool receive(void *user, const conus_batch_block *block)
{
    struct received *received = user;
    buffer_append(&received->text, block->text, block->size);
    received->poses += block->poses;
    received->errors += block->errors;
    if (received->is_of_fixture) { /* pose 0, BAD, 2 BAD and so on have no answer, and pose 0 is in line 2 */
        uint64_t first = (received->poses - block->poses + BAD - 1) / BAD * BAD;
        assert_int_equal(block->line, block->errors ? first + 2 : 0);
        assert_true(block->errors ? strstr(block->why, "\"ten\"") != NULL : !block->why);
    }
    received->blocks++;
    return received->blocks != received->stop_after;
}

static void write_poses(const char *path, const conus_atlas *atlas)
{
    struct buffer text = {0};
    uint64_t seed = 7;
    buffer_text(&text,
                "query_id\tm00\tm01\tm02\tm03\tm10\tm11\tm12\tm13\tm20\tm21\tm22\tm23\tm30\tm31\tm32\tm33\tangle\n");
    for (int i = 0; i < POSES; i++) {
        conus_pose pose = scene_generic_pose(&seed, atlas);
        buffer_format(&text, "pose %d", i);
        for (int k = 0; k < 16; k++) {
            buffer_format(&text, "\t%.17g", pose.world_from_device[4 * (k % 4) + k / 4]);
        }
        buffer_text(&text, i % BAD == 0 ? "\tten\n" : i % 2 ? "\t20\n" : "\t35\n");
    }
    assert_ok(buffer_status(&text));
    assert_ok(file_write(path, text.data, text.size));
    buffer_finish(&text);
}

/* Makes the rows in the way of conus query. */
static void make_reference(struct fixture *fixture)
{
    conus_pose_list *list = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_pose_list_load(&list, fixture->path, NULL));
    assert_ok(conus_report_create(&report, fixture->selector, &(conus_report_options){.format = "ndjson"}));
    for (size_t i = 0; i < conus_pose_list_count(list); i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i);
        conus_selection *selection = NULL;
        if (row->error) {
            assert_ok(conus_report_add_error(report, row->id, row->line, row->error));
        } else {
            assert_ok(conus_select(&selection, fixture->selector, &row->pose, row->angle));
            assert_ok(conus_report_add(report, row->id, selection));
        }
        conus_selection_destroy(selection);
    }
    assert_ok(conus_report_text(&text, &size, report));
    buffer_append(&fixture->reference, text, size);
    conus_report_destroy(report);
    conus_pose_list_destroy(list);
}

static int set_up(void **state)
{
    static struct fixture fixture;
    uint64_t seed = 3;
    fixture.atlas = scene_atlas(&seed, 24, 2);
    fixture.path = test_scratch("poses.tsv");
    write_poses(fixture.path, fixture.atlas);
    assert_ok(conus_selector_create(&fixture.selector, fixture.atlas, NULL));
    make_reference(&fixture);
    *state = &fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    buffer_finish(&fixture->reference);
    conus_selector_destroy(fixture->selector);
    conus_atlas_destroy(fixture->atlas);
    return 0;
}

static conus_batch *batch_of(struct fixture *fixture, uint32_t threads, uint32_t block)
{
    conus_batch *batch = NULL;
    const conus_batch_options options = {.threads = threads, .block = block, .report = {.format = "ndjson"}};
    assert_ok(conus_batch_create(&batch, fixture->selector, &options));
    assert_int_equal(conus_batch_threads(batch), threads);
    return batch;
}

static conus_pose_stream *poses_of(const struct fixture *fixture)
{
    conus_pose_stream *poses = NULL;
    assert_ok(conus_pose_stream_open(&poses, fixture->path, NULL));
    return poses;
}

static void check_text(const struct received *received, const char *wanted, size_t size)
{
    assert_int_equal(received->text.size, size);
    assert_memory_equal(received->text.data, wanted, size);
}

static void rows_do_not_depend_on_threads_or_blocks(void **state)
{
    struct fixture *fixture = *state;
    static const uint32_t settings[][2] = {{1, 1}, {1, 256}, {2, 1}, {2, 16}, {3, 100}, {8, 1}, {8, 50}, {5, 65536}};
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        struct received received = {.is_of_fixture = true};
        conus_batch *batch = batch_of(fixture, settings[i][0], settings[i][1]);
        conus_pose_stream *poses = poses_of(fixture);
        assert_ok(conus_batch_run(batch, poses, UINT64_MAX, receive, &received));
        assert_int_equal(received.poses, POSES);
        assert_int_equal(received.errors, (POSES + BAD - 1) / BAD);
        assert_int_equal(received.blocks, (POSES + settings[i][1] - 1) / settings[i][1]);
        check_text(&received, fixture->reference.data, fixture->reference.size);
        assert_ok(conus_batch_run(batch, poses, UINT64_MAX, receive, &received)); /* nothing is left */
        assert_int_equal(received.poses, POSES);
        buffer_finish(&received.text);
        conus_pose_stream_destroy(poses);
        conus_batch_destroy(batch);
    }
}

static void limits_take_the_poses_piece_by_piece(void **state)
{
    struct fixture *fixture = *state;
    for (uint32_t threads = 1; threads <= 4; threads++) {
        struct received received = {0};
        conus_batch *batch = batch_of(fixture, threads, 8);
        conus_pose_stream *poses = poses_of(fixture);
        for (uint64_t limit = 0; received.poses < POSES; limit += 8) {
            uint64_t before = received.poses;
            assert_ok(conus_batch_run(batch, poses, limit, receive, &received));
            assert_int_equal(received.poses - before, limit < POSES - before ? limit : POSES - before);
        }
        check_text(&received, fixture->reference.data, fixture->reference.size);
        buffer_finish(&received.text);
        conus_pose_stream_destroy(poses);
        conus_batch_destroy(batch);
    }
}

static void a_sink_ends_the_run_behind_a_whole_block(void **state)
{
    struct fixture *fixture = *state;
    for (uint32_t threads = 1; threads <= 4; threads++) {
        for (uint64_t stop_after = 1; stop_after < 20; stop_after += 6) {
            struct received received = {.stop_after = stop_after};
            conus_batch *batch = batch_of(fixture, threads, 10);
            conus_pose_stream *poses = poses_of(fixture);
            assert_fails(conus_batch_run(batch, poses, UINT64_MAX, receive, &received), CONUS_ERROR_CANCELLED);
            assert_int_equal(received.poses, 10 * stop_after);
            check_text(&received, fixture->reference.data, received.text.size);
            buffer_finish(&received.text);
            conus_pose_stream_destroy(poses);
            conus_batch_destroy(batch);
        }
    }
}

static void what_is_no_batch_is_refused(void **state)
{
    struct fixture *fixture = *state;
    conus_batch *batch = NULL;
    static const conus_batch_options wrong[] = {
        {.report = {.format = "table"}},
        {.report = {.format = "json"}},
        {.report = {.rows = "summaries"}},
        {.threads = 1025, .report = {.format = "tsv"}},
        {.block = 65537, .report = {.format = "tsv"}},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_fails(conus_batch_create(&batch, fixture->selector, &wrong[i]), CONUS_ERROR_ARGUMENT);
    }
    assert_null(batch);
    assert_int_equal(conus_batch_threads(NULL), 0);
    assert_string_equal(conus_batch_header(NULL), "");
    conus_batch_destroy(NULL);
}

static void the_header_is_the_report_s(void **state)
{
    struct fixture *fixture = *state;
    conus_batch *batch = batch_of(fixture, 1, 0);
    const char *text = NULL;
    size_t size = 0;
    assert_string_equal(conus_batch_header(batch), "");
    assert_ok(conus_batch_sidecar(&text, &size, batch));
    assert_non_null(strstr(text, "\"offset_deg\""));
    conus_batch_destroy(batch);
    const conus_batch_options options = {.report = {.format = "tsv"}};
    assert_ok(conus_batch_create(&batch, fixture->selector, &options));
    assert_true(conus_batch_threads(batch) >= 1);
    assert_memory_equal(conus_batch_header(batch), "query\tkind\tindex\t", 17);
    conus_batch_destroy(batch);
}

/* There is one row per pose, whatever the threads: the first of the full rows. */
static void summaries_are_the_best_of_each(void **state)
{
    struct fixture *fixture = *state;
    struct buffer first = {0};
    for (uint32_t threads = 1; threads <= 3; threads++) {
        const conus_batch_options options = {
            .threads = threads, .block = 9, .report = {.rows = "summaries", .format = "tsv"}};
        struct received received = {0};
        conus_batch *batch = NULL;
        conus_pose_stream *poses = poses_of(fixture);
        size_t lines = 0;
        assert_ok(conus_batch_create(&batch, fixture->selector, &options));
        assert_non_null(strstr(conus_batch_header(batch), "\trunner_up\trunner_up_index\trunner_up_share\tmargin\t"));
        assert_ok(conus_batch_run(batch, poses, UINT64_MAX, receive, &received));
        for (const char *at = received.text.data; (at = strchr(at, '\n')); at++) {
            lines++;
        }
        assert_int_equal(lines, POSES);
        if (!first.size) {
            buffer_append(&first, received.text.data, received.text.size);
        }
        check_text(&received, first.data, first.size);
        buffer_finish(&received.text);
        conus_pose_stream_destroy(poses);
        conus_batch_destroy(batch);
    }
    buffer_finish(&first);
}

enum { ATLASES = 3 };

static const char *const names[ATLASES] = {"one", "two", "three"};

/* Atlases besides the fixture's. */
struct others {
    conus_atlas *atlases[ATLASES - 1];
    conus_selector *selectors[ATLASES - 1];
};

static struct others create_others(void)
{
    struct others others;
    uint64_t seed = 21;
    for (size_t i = 0; i < ATLASES - 1; i++) {
        others.atlases[i] = scene_atlas(&seed, 16, 0);
        assert_ok(conus_selector_create(&others.selectors[i], others.atlases[i], NULL));
    }
    return others;
}

static void destroy_others(struct others *others)
{
    for (size_t i = 0; i < ATLASES - 1; i++) {
        conus_selector_destroy(others->selectors[i]);
        conus_atlas_destroy(others->atlases[i]);
    }
}

static conus_status make_joined(conus_batch **out, const struct fixture *fixture, const struct others *others,
                                uint32_t threads, uint32_t block)
{
    const conus_batch_options options = {
        .threads = threads, .block = block, .report = {.format = "ndjson", .atlas = names[0]}};
    conus_status status = conus_batch_create(out, fixture->selector, &options);
    for (size_t i = 1; i < ATLASES && !status; i++) {
        status = conus_batch_add(*out, others->selectors[i - 1], names[i]);
    }
    return status;
}

/* The rows of each pose alone. */
struct rows_of_poses {
    struct buffer text;
    size_t ends[POSES];
    size_t count;
};

static bool keep_end(void *user, const conus_batch_block *block)
{
    struct rows_of_poses *rows = user;
    buffer_append(&rows->text, block->text, block->size);
    rows->ends[rows->count++] = rows->text.size;
    return true;
}

static void answer_each_pose(struct rows_of_poses *out, conus_selector *selector, const struct fixture *fixture)
{
    const conus_batch_options options = {.threads = 1, .block = 1, .report = {.format = "ndjson"}};
    conus_batch *batch = NULL;
    conus_pose_stream *poses = poses_of(fixture);
    assert_ok(conus_batch_create(&batch, selector, &options));
    assert_ok(conus_batch_run(batch, poses, UINT64_MAX, keep_end, out));
    assert_int_equal(out->count, POSES);
    conus_pose_stream_destroy(poses);
    conus_batch_destroy(batch);
}

/* For each pose the rows of a batch on each atlas alone, with the atlas's name behind the first comma; no id has a
 * comma. */
static void put_joined_rows(struct buffer *out, const struct rows_of_poses rows[ATLASES])
{
    for (size_t pose = 0; pose < POSES; pose++) {
        for (size_t i = 0; i < ATLASES; i++) {
            const char *at = rows[i].text.data + (pose ? rows[i].ends[pose - 1] : 0);
            const char *end = rows[i].text.data + rows[i].ends[pose];
            while (at < end) {
                const char *comma = strchr(at, ',');
                const char *next = strchr(at, '\n') + 1;
                buffer_format(out, "%.*s,\"atlas\":\"%s\"%.*s", (int)(comma - at), at, names[i], (int)(next - comma),
                              comma);
                at = next;
            }
        }
    }
}

static void rows_of_several_atlases_are_those_of_each(void **state)
{
    struct fixture *fixture = *state;
    static const uint32_t settings[][2] = {{1, 1}, {1, 256}, {2, 7}, {4, 50}};
    struct others others = create_others();
    static struct rows_of_poses rows[ATLASES];
    struct buffer wanted = {0};
    for (size_t i = 0; i < ATLASES; i++) {
        answer_each_pose(&rows[i], i ? others.selectors[i - 1] : fixture->selector, fixture);
    }
    put_joined_rows(&wanted, rows);
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        struct received received = {0};
        conus_batch *batch = NULL;
        conus_pose_stream *poses = poses_of(fixture);
        assert_ok(make_joined(&batch, fixture, &others, settings[i][0], settings[i][1]));
        assert_ok(conus_batch_run(batch, poses, UINT64_MAX, receive, &received));
        assert_int_equal(received.poses, POSES);
        assert_int_equal(received.errors, (POSES + BAD - 1) / BAD); /* not once for each atlas */
        check_text(&received, wanted.data, wanted.size);
        for (size_t k = 0; k < ATLASES; k++) {
            assert_int_equal(conus_batch_findings(batch, k).poses, POSES - received.errors);
        }
        assert_int_equal(conus_batch_findings(batch, ATLASES).poses, 0);
        buffer_finish(&received.text);
        conus_pose_stream_destroy(poses);
        conus_batch_destroy(batch);
    }
    for (size_t i = 0; i < ATLASES; i++) {
        buffer_finish(&rows[i].text);
    }
    buffer_finish(&wanted);
    destroy_others(&others);
}

/* Refused: the first atlas has no name, a name is taken, the resolution differs. The batch is then unchanged. */
static void an_atlas_that_does_not_fit_is_not_added(void **state)
{
    struct fixture *fixture = *state;
    struct others others = create_others();
    conus_batch *batch = batch_of(fixture, 2, 9);
    conus_batch *joined = NULL;
    conus_selector *fine = NULL;
    struct received received = {0};
    conus_pose_stream *poses = poses_of(fixture);
    assert_fails(conus_batch_add(batch, others.selectors[0], "two"), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_batch_run(batch, poses, UINT64_MAX, receive, &received));
    check_text(&received, fixture->reference.data, fixture->reference.size);
    assert_ok(make_joined(&joined, fixture, &others, 2, 9));
    assert_ok(conus_selector_create(&fine, others.atlases[0], &(conus_selector_options){.resolution = 17}));
    assert_fails(conus_batch_add(joined, others.selectors[0], names[1]), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_batch_add(joined, others.selectors[0], NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_batch_add(joined, fine, "four"), CONUS_ERROR_ARGUMENT);
    conus_selector_destroy(fine);
    buffer_finish(&received.text);
    conus_pose_stream_destroy(poses);
    conus_batch_destroy(joined);
    conus_batch_destroy(batch);
    destroy_others(&others);
}

struct joined_attempt {
    const struct fixture *fixture;
    const struct others *others;
};

static conus_status run_joined(void *data)
{
    const struct joined_attempt *attempt = data;
    struct received received = {0};
    conus_batch *batch = NULL;
    conus_pose_stream *poses = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = make_joined(&batch, attempt->fixture, attempt->others, 1, 4);
    status = status ? status : conus_pose_stream_open(&poses, attempt->fixture->path, NULL);
    status = status ? status : conus_batch_run(batch, poses, 8, receive, &received);
    status = status ? status : conus_batch_sidecar(&text, &size, batch);
    buffer_finish(&received.text);
    conus_pose_stream_destroy(poses);
    conus_batch_destroy(batch);
    return status;
}

static void every_failing_allocation_is_clean_with_several_atlases(void **state)
{
    struct others others = create_others();
    struct joined_attempt attempt = {*state, &others};
    test_every_allocation(run_joined, &attempt);
    destroy_others(&others);
}

static conus_status run_once(void *data)
{
    struct fixture *fixture = data;
    struct received received = {0};
    conus_batch *batch = NULL;
    conus_pose_stream *poses = NULL;
    const char *text = NULL;
    size_t size = 0;
    const conus_batch_options options = {.threads = 1, .block = 16, .report = {.format = "tsv"}};
    conus_status status = conus_batch_create(&batch, fixture->selector, &options);
    status = status ? status : conus_pose_stream_open(&poses, fixture->path, NULL);
    status = status ? status : conus_batch_run(batch, poses, 20, receive, &received);
    status = status ? status : conus_batch_sidecar(&text, &size, batch);
    buffer_finish(&received.text);
    conus_pose_stream_destroy(poses);
    conus_batch_destroy(batch);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    test_every_allocation(run_once, *state);
}

/* A failure in the middle comes after all blocks before it, with its message, whichever thread failed. */
static void a_failure_ends_the_run(void **state)
{
    struct fixture *fixture = *state;
    for (long n = 5; n < 400; n += 13) {
        struct received received = {0};
        conus_batch *batch = batch_of(fixture, 3, 10);
        conus_pose_stream *poses = poses_of(fixture);
        buffer_append(&received.text, fixture->reference.data, fixture->reference.size); /* capacity enough */
        buffer_clear(&received.text);
        test_fail_allocation(n);
        conus_status status = conus_batch_run(batch, poses, UINT64_MAX, receive, &received);
        bool failed = test_allocation_failed();
        test_fail_allocation(-1);
        assert_true(failed);
        assert_fails(status, CONUS_ERROR_MEMORY);
        assert_true(received.poses < POSES && received.poses % 10 == 0);
        check_text(&received, fixture->reference.data, received.text.size);
        buffer_finish(&received.text);
        conus_pose_stream_destroy(poses);
        conus_batch_destroy(batch);
    }
}

static void as_many_columns_are_kept_as_the_report_has(void **state)
{
    struct fixture *fixture = *state;
    static const char *const columns[] = {"m00", "m01", "m02"};
    for (size_t kept = 0; kept <= 3; kept++) {
        for (size_t marked = 0; marked <= 3; marked++) {
            const conus_row_marks marks = {.names = columns, .count = marked};
            const conus_batch_options options = {.threads = 1, .report = {.format = "ndjson", .marks = &marks}};
            struct received received = {0};
            conus_batch *batch = NULL;
            conus_pose_stream *poses = NULL;
            assert_ok(conus_batch_create(&batch, fixture->selector, &options));
            assert_ok(conus_pose_stream_open(&poses, fixture->path,
                                             &(conus_pose_options){.keep = columns, .keep_count = kept}));
            conus_status status = conus_batch_run(batch, poses, UINT64_MAX, receive, &received);
            assert_int_equal(status, kept == marked ? CONUS_OK : CONUS_ERROR_ARGUMENT);
            assert_int_equal(received.poses, kept == marked ? POSES : 0);
            assert_non_null(kept == marked ? "" : strstr(conus_message(), "keep: "));
            buffer_finish(&received.text);
            conus_pose_stream_destroy(poses);
            conus_batch_destroy(batch);
        }
    }
}

TEST_GROUP(batch)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_do_not_depend_on_threads_or_blocks),
        cmocka_unit_test(limits_take_the_poses_piece_by_piece),
        cmocka_unit_test(a_sink_ends_the_run_behind_a_whole_block),
        cmocka_unit_test(what_is_no_batch_is_refused),
        cmocka_unit_test(the_header_is_the_report_s),
        cmocka_unit_test(summaries_are_the_best_of_each),
        cmocka_unit_test(rows_of_several_atlases_are_those_of_each),
        cmocka_unit_test(an_atlas_that_does_not_fit_is_not_added),
        cmocka_unit_test(every_failing_allocation_is_clean_with_several_atlases),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(a_failure_ends_the_run),
        cmocka_unit_test(as_many_columns_are_kept_as_the_report_has),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
