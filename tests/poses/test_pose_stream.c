/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses read block by block, from files and pipes. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "poses/pose_stream.h"
#include "poses/rows/columns.h"
#include "test.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char header[] = "query_id\tx\ty\tz\tdx\tdy\tdz\n";

static conus_pose_stream *parse(const char *text, const conus_pose_options *options)
{
    conus_pose_stream *stream = NULL;
    assert_ok(pose_stream_parse(&stream, text_from(text), options));
    return stream;
}

static conus_pose_row read_one(conus_pose_stream *stream)
{
    conus_pose_row row = {0};
    size_t count = 9;
    assert_ok(conus_pose_stream_read(&row, &count, stream, 1));
    assert_int_equal(count, 1);
    return row;
}

static void assert_ended(conus_pose_stream *stream)
{
    conus_pose_row row;
    size_t count = 9;
    assert_ok(conus_pose_stream_read(&row, &count, stream, 1));
    assert_int_equal(count, 0);
}

/* `rows` poses whose x is their number from 1, with comments and empty lines between. */
static const char *write_table(size_t rows, const char *ending)
{
    const char *path = test_scratch("poses.tsv");
    struct buffer text = {0};
    buffer_format(&text, "# a comment%s%.*s%s", ending, (int)(sizeof header - 2), header, ending);
    for (size_t i = 1; i <= rows; i++) {
        if (i % 10 == 0) {
            buffer_format(&text, "# %zu%s%s", i, ending, ending);
        }
        buffer_format(&text, "row %zu\t%zu\t0\t0\t0\t1\t0%s", i, i, ending);
    }
    assert_ok(buffer_status(&text));
    assert_ok(file_write(path, text.data, text.size));
    buffer_finish(&text);
    return path;
}

enum { ROWS = 30000 }; /* more than the reader's buffer holds */

/* Blocks of any size give every row once, in order. */
static void blocks_join_without_a_seam(void **state)
{
    (void)state;
    static const char *const endings[] = {"\n", "\r\n", "\r"};
    static const size_t capacities[] = {1, 7, 1000, 2 * ROWS};
    conus_pose_row *rows = calloc(2 * (size_t)ROWS, sizeof *rows);
    for (size_t k = 0; k < 12; k++) {
        conus_pose_stream *stream = NULL;
        const char *path = write_table(ROWS, endings[k % 3]);
        assert_ok(conus_pose_stream_open(&stream, path, NULL));
        size_t seen = 0;
        size_t count = 0;
        do {
            assert_ok(conus_pose_stream_read(rows, &count, stream, capacities[k / 3]));
            assert_true(count == capacities[k / 3] || seen + count == ROWS || count == 0);
            for (size_t i = 0; i < count; i++) {
                char id[32];
                snprintf(id, sizeof id, "row %zu", ++seen);
                assert_string_equal(rows[i].id, id);
                assert_null(rows[i].error);
                assert_int_equal(rows[i].pose.world_from_device[12], seen);
                assert_int_equal(rows[i].line, 2 + seen + seen / 10 * 2);
            }
        } while (count);
        assert_int_equal(seen, ROWS);
        conus_pose_stream_destroy(stream);
    }
    free(rows);
}

/* As a shard does: counts the rows, skips some, reads a few; the rest is as if all had been read. */
static void rows_can_be_passed_over(void **state)
{
    (void)state;
    uint64_t count = 0;
    conus_pose_stream *stream = NULL;
    assert_ok(conus_pose_stream_open(&stream, write_table(ROWS, "\r\n"), NULL));
    assert_ok(conus_pose_stream_count(&count, stream));
    assert_int_equal(count, ROWS);
    assert_ok(conus_pose_stream_skip(stream, 20000));
    conus_pose_row row = read_one(stream);
    assert_string_equal(row.id, "row 20001");
    assert_int_equal(row.line, 2 + 20001 + 4000);
    assert_ok(conus_pose_stream_count(&count, stream)); /* wherever it stands */
    assert_int_equal(count, ROWS);
    assert_string_equal(read_one(stream).id, "row 20002");
    assert_ok(conus_pose_stream_skip(stream, UINT64_MAX));
    assert_ended(stream);
    conus_pose_stream_destroy(stream);
}

/* A row without a name gets its number as name, also behind skipped rows. */
static void numbers_count_all_rows(void **state)
{
    (void)state;
    conus_pose_stream *stream = parse("x,y,z,dx,dy,dz\n0,0,0,0,1,0\nbad 7\n\n1,0,0,0,1,0\n2,0,0,0,1,0\n", NULL);
    uint64_t count = 0;
    assert_ok(conus_pose_stream_skip(stream, 1));
    assert_string_equal(read_one(stream).id, "2");
    assert_ok(conus_pose_stream_skip(stream, 1));
    assert_string_equal(read_one(stream).id, "4");
    assert_ok(conus_pose_stream_count(&count, stream));
    assert_int_equal(count, 4);
    conus_pose_stream_destroy(stream);
}

/* Lines of a pipe are answered as they come: the stream waits for no line before it is asked for. */
static void pipes_are_read_as_they_fill(void **state)
{
    (void)state;
    int ends[2];
    char path[64];
    uint64_t count = 0;
    conus_pose_stream *stream = NULL;
    assert_int_equal(pipe(ends), 0);
    snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
    const char first[] = "query_id\tx\ty\tz\tdx\tdy\tdz\nfirst\t1\t2\t3\t0\t1\t0\nsec";
    assert_true(system_write(ends[1], first, sizeof first - 1));
    assert_ok(conus_pose_stream_open(&stream, path, NULL));
    assert_string_equal(read_one(stream).id, "first");
    assert_fails(conus_pose_stream_count(&count, stream), CONUS_ERROR_UNSUPPORTED);
    const char second[] = "ond\t1\t2\t3\t0\t1\t0"; /* no line feed at the end */
    assert_true(system_write(ends[1], second, sizeof second - 1));
    close(ends[1]);
    assert_string_equal(read_one(stream).id, "second");
    assert_ended(stream);
    conus_pose_stream_destroy(stream);
    close(ends[0]);
}

static void *stop_soon(void *stream)
{
    nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    conus_pose_stream_stop(stream);
    return NULL;
}

/* A stop ends the wait for a silent pipe, and half a line is no row. A file never waits. */
static void pipes_can_be_stopped(void **state)
{
    (void)state;
    for (int early = 0; early < 2; early++) {
        int ends[2];
        char path[64];
        pthread_t thread;
        conus_pose_stream *stream = NULL;
        const char text[] = "query_id\tx\ty\tz\tdx\tdy\tdz\nfirst\t1\t2\t3\t0\t1\t0\nsecond\t1\t2\t3\t0\t1\t0";
        assert_int_equal(pipe(ends), 0);
        snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
        assert_true(system_write(ends[1], text, sizeof text - 1));
        assert_ok(conus_pose_stream_open(&stream, path, NULL));
        assert_true(conus_pose_stream_facts(stream).is_live);
        if (early) {
            conus_pose_stream_stop(stream);
        } else {
            assert_int_equal(pthread_create(&thread, NULL, stop_soon, stream), 0);
        }
        assert_string_equal(read_one(stream).id, "first");
        assert_ended(stream);
        assert_int_equal(early ? 0 : pthread_join(thread, NULL), 0);
        conus_pose_stream_destroy(stream);
        close(ends[0]);
        close(ends[1]);
    }
    conus_pose_stream *stream = parse("x,y,z,dx,dy,dz\n0,0,0,0,1,0\n", NULL);
    assert_false(conus_pose_stream_facts(stream).is_live);
    conus_pose_stream_stop(stream);
    assert_string_equal(read_one(stream).id, "1");
    conus_pose_stream_destroy(stream);
}

/* The lines are the same however the text is cut into pieces. */
static void cuts_do_not_matter(void **state)
{
    (void)state;
    static const char text[] = "a\r\n\r\nb\rc\n\nd\r";
    static const char *const wanted[] = {"a", "", "b", "c", "", "d"};
    for (size_t cut = 0; cut < sizeof text; cut++) {
        int ends[2];
        assert_int_equal(pipe(ends), 0);
        struct pose_lines lines;
        assert_ok(pose_lines_init(&lines, ends[0], false, 0));
        assert_true(system_write(ends[1], text, cut));
        assert_ok(cut ? pose_lines_fill(&lines, cut, false) : CONUS_OK);
        assert_true(system_write(ends[1], text + cut, sizeof text - 1 - cut));
        close(ends[1]);
        struct pose_line line;
        bool found = true;
        for (size_t i = 0; i < 6; i++) {
            assert_ok(pose_lines_next(&lines, &line, &found));
            assert_true(found);
            assert_true(text_equal(line.text, wanted[i]));
            assert_int_equal(line.number, i + 1);
        }
        assert_ok(pose_lines_next(&lines, &line, &found));
        assert_false(found);
        pose_lines_finish(&lines);
        close(ends[0]);
    }
}

static void optional_columns_are_read(void **state)
{
    (void)state;
    conus_pose_stream *stream = parse("x,y,z,dx,dy,dz,angle,time_s,trigger,error_deg,error_mm\n"
                                      "0,0,0,0,1,0,20,1.5,1,2.5,0\n"
                                      "0,0,0,0,1,0,n/a,n/a,n/a,n/a,\n"
                                      "0,0,0,0,1,0,20,1,true,-1,1\n"
                                      "0,0,0,0,1,0,20,1,perhaps,1,1\n"
                                      "0,0,0,0,1,0,0,1,False,1,1\n",
                                      NULL);
    conus_pose_row row = read_one(stream);
    assert_near(row.angle, 20, 0);
    assert_near(row.time_s, 1.5, 0);
    assert_true(row.trigger);
    assert_near(row.error_deg, 2.5, 0);
    assert_near(row.error_mm, 0, 0);
    row = read_one(stream);
    assert_null(row.error);
    assert_true(row.angle == 0 && isnan(row.time_s) && !row.trigger && isnan(row.error_deg) && isnan(row.error_mm));
    assert_non_null(strstr(read_one(stream).error, "column error_deg: -1"));
    assert_non_null(strstr(read_one(stream).error, "column trigger: \"perhaps\""));
    assert_non_null(strstr(read_one(stream).error, "angle"));
    conus_pose_stream_destroy(stream);
    stream = parse("x,y,z,dx,dy,dz\n0,0,0,0,1,0\n", NULL);
    row = read_one(stream);
    assert_true(row.angle == 0 && isnan(row.time_s) && !row.trigger && isnan(row.error_deg) && isnan(row.error_mm));
    conus_pose_stream_destroy(stream);
}

static void check_range(conus_pose_stream *stream, double near, double far)
{
    conus_pose_row row = read_one(stream);
    assert_null(row.error);
    assert_true(row.range[0] == near || (isnan(near) && isnan(row.range[0])));
    assert_true(row.range[1] == far || (isnan(far) && isnan(row.range[1])));
}

/* Ranges are in mm in every space, also in one of micrometres. Whether a near alone is allowed depends on the other
 * rows' ranges. */
static void ranges_are_read(void **state)
{
    (void)state;
    static const char *const bad[][2] = {
        {"30,20", "range: 30 to 20 mm, allowed is NEAR from 0 on and FAR beyond it"},
        {"20,20", "range: 20 to 20 mm"},
        {"-1,20", "range: -1 to 20 mm"},
        {"0,0", "range: 0 to 0 mm"},
        {"n/a,-3", "range: 0 to -3 mm"},
        {"nan,20", "column Near: \"nan\" is not a finite number"},
        {"0,inf", "column far: \"inf\" is not a finite number"},
        {"x,20", "column Near: \"x\" is not a finite number"},
    };
    const conus_pose_options ccf = {
        .space = CONUS_SPACE_CCF,
        .frame = &(conus_frame){.space = CONUS_SPACE_CCF,
                                .world_from_space = {0.001, 0, 0, 0, 0, 0.001, 0, 0, 0, 0, 0.001, 0, 0, 0, 0, 1}}};
    char text[1024] = "far,x,y,z,dx,dy,dz,Near\n";
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        const char *comma = strchr(bad[i][0], ',');
        size_t size = strlen(text);
        snprintf(text + size, sizeof text - size, "%s,0,0,0,0,1,0,%.*s\n", comma + 1, (int)(comma - bad[i][0]),
                 bad[i][0]);
    }
    conus_pose_stream *stream = parse(text, NULL);
    assert_true(conus_pose_stream_facts(stream).has_ranges);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_non_null(strstr(read_one(stream).error, bad[i][1]));
    }
    conus_pose_stream_destroy(stream);
    stream = parse(
        "x,y,z,dx,dy,dz,near,far\n5e3,0,0,0,1,0,2.5,40\n5e3,0,0,0,1,0,,N/A\n5e3,0,0,0,1,0,n/a,1e-3\n5e3,0,0,0,1,0,7,\n",
        &ccf);
    check_range(stream, 2.5, 40);
    check_range(stream, NAN, NAN);
    check_range(stream, NAN, 1e-3);
    check_range(stream, 7, NAN);
    conus_pose_stream_destroy(stream);
    stream = parse("x,y,z,dx,dy,dz,far\n0,0,0,0,1,0,40\n", NULL);
    assert_true(conus_pose_stream_facts(stream).has_ranges);
    check_range(stream, NAN, 40);
    conus_pose_stream_destroy(stream);
    stream = parse("x,y,z,dx,dy,dz\n0,0,0,0,1,0\n", NULL);
    assert_false(conus_pose_stream_facts(stream).has_ranges);
    check_range(stream, NAN, NAN);
    conus_pose_stream_destroy(stream);
    stream = parse("1 2 3\n", NULL);
    assert_false(conus_pose_stream_facts(stream).has_ranges);
    check_range(stream, NAN, NAN);
    conus_pose_stream_destroy(stream);
}

/* The device looks along the axis of the option, and its frame stays a rotation. */
static void every_axis_looks_its_way(void **state)
{
    (void)state;
    const double quaternion[4] = {0.4, -0.3, 0.5, 0.7};
    conus_pose device;
    assert_ok(conus_pose_from_quaternion(&device, (double[]){1, 2, 3}, quaternion));
    for (conus_axis axis = CONUS_AXIS_OF_FORMAT; axis <= CONUS_AXIS_MINUS_Z; axis++) {
        const conus_pose_options options = {.axis = axis};
        conus_pose_stream *stream = parse("x,y,z,qw,qx,qy,qz\n1,2,3,0.4,-0.3,0.5,0.7\n", &options);
        const conus_pose_row row = read_one(stream);
        conus_axis looks = axis ? axis : CONUS_AXIS_MINUS_Z;
        const double *m = row.pose.world_from_device;
        const double *beam = device.world_from_device + 4 * ((looks - 1) / 2);
        double sign = looks % 2 ? 1 : -1;
        for (int i = 0; i < 3; i++) {
            assert_near(-m[8 + i], sign * beam[i], 1e-15);
            assert_near(m[12 + i], i + 1, 0);
        }
        assert_near(mat4_determinant3(m), 1, 1e-12);
        conus_pose again;
        assert_ok(conus_pose_from_matrix(&again, m));
        conus_pose_stream_destroy(stream);
    }
}

static void points_are_points(void **state)
{
    (void)state;
    conus_pose_stream *stream =
        parse("# MNI\n-40.5 -20 55 hand knob\n1,2,3\n\n 4\t5\t6\tSTN, left\n1 2\n1 2 3 4\n", NULL);
    static const double wanted[3][3] = {{-40.5, -20, 55}, {1, 2, 3}, {4, 5, 6}};
    static const char *const ids[] = {"hand knob", "2", "STN, left"};
    assert_string_equal(conus_pose_stream_facts(stream).format, "points");
    for (size_t k = 0; k < 3; k++) {
        conus_pose_row row = read_one(stream);
        assert_null(row.error);
        assert_true(row.is_point);
        assert_string_equal(row.id, ids[k]);
        for (int i = 0; i < 3; i++) {
            assert_near(row.pose.world_from_device[12 + i], wanted[k][i], 0);
        }
    }
    assert_non_null(strstr(read_one(stream).error, "z: \"\" is not a finite number"));
    assert_non_null(strstr(read_one(stream).error, "a number after x y z"));
    assert_ended(stream);
    conus_pose_stream_destroy(stream);
    stream = parse("1 2 3\n", &(conus_pose_options){.space = CONUS_SPACE_LPS});
    assert_near(read_one(stream).pose.world_from_device[12], -1, 0);
    conus_pose_stream_destroy(stream);
}

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        conus_pose_options options;
        const char *part;
    } cases[] = {
        {"x,y,z,dx,dy,dz\n0,0,0,0,1,0\n", {.axis = CONUS_AXIS_PLUS_X}, "no axis (+x)"},
        {"1 2 3\n", {.axis = CONUS_AXIS_MINUS_Y}, "no axis (-y)"},
        {"1 2 3 4\n5 6 7 8\n", {0}, "4 numbers in a line"},
        {"1 2 3\n", {.format = "matrix"}, "neither the 16"},
        {"1 2 3\n", {.format = "table"}, "header"},
        {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", {.max_memory = 20}, "more than 20 bytes"},
        {"\xff\xfe"
         "1\t2\t3\n",
         {0},
         "neither names of columns nor three numbers"},
        {"", {0}, "no poses"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_stream *stream = NULL;
        assert_true(pose_stream_parse(&stream, text_from(cases[i].text), &cases[i].options) != CONUS_OK);
        assert_null(stream);
        assert_non_null(strstr(conus_message(), cases[i].part));
    }
    conus_pose_stream *stream = NULL;
    const conus_pose_options wrong = {.axis = (conus_axis)7};
    assert_fails(pose_stream_parse(&stream, text_from("1 2 3"), &wrong), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_stream_open(&stream, "/", NULL), CONUS_ERROR_IO);
    assert_fails(conus_pose_stream_open(&stream, "/none/such", NULL), CONUS_ERROR_IO);
    stream = parse("1 2 3", NULL);
    conus_pose_row row;
    size_t count;
    assert_fails(conus_pose_stream_read(&row, &count, stream, 0), CONUS_ERROR_ARGUMENT);
    conus_pose_stream_destroy(stream);
}

static void long_lines_are_one_bad_row(void **state)
{
    (void)state;
    struct buffer text = {0};
    char *filler = malloc(1000000);
    memset(filler, '7', 1000000);
    buffer_text(&text, header);
    buffer_text(&text, "a\t0\t0\t0\t0\t1\t0\n");
    buffer_append(&text, filler, 1000000);
    buffer_text(&text, "\r\nb\t0\t0\t0\t0\t1\t0\n# ");
    buffer_append(&text, filler, 1000000);
    buffer_text(&text, "\nc\t0\t0\t0\t0\t1\t0\n");
    buffer_append(&text, filler, 1000000);
    assert_ok(buffer_status(&text));
    const char *path = test_scratch("long.tsv");
    assert_ok(file_write(path, text.data, text.size));
    conus_pose_stream *stream = NULL;
    uint64_t count = 0;
    assert_ok(conus_pose_stream_open(&stream, path, NULL));
    assert_string_equal(read_one(stream).id, "a");
    conus_pose_row row = read_one(stream);
    assert_string_equal(row.error, "a line of more than 65535 bytes");
    assert_string_equal(row.id, "2");
    assert_int_equal(row.line, 3);
    row = read_one(stream);
    assert_string_equal(row.id, "b");
    assert_int_equal(row.line, 4);
    row = read_one(stream);
    assert_string_equal(row.id, "c");
    assert_int_equal(row.line, 6);
    assert_string_equal(read_one(stream).error, "a line of more than 65535 bytes");
    assert_ended(stream);
    assert_ok(conus_pose_stream_count(&count, stream));
    assert_int_equal(count, 5);
    conus_pose_stream_destroy(stream);
    buffer_finish(&text);
    free(filler);
}

static conus_status read_through(void *data)
{
    conus_pose_stream *stream = NULL;
    conus_pose_row row;
    size_t count = 0;
    uint64_t all = 0;
    conus_status status = conus_pose_stream_open(&stream, data, NULL);
    do {
        status = status ? status : conus_pose_stream_read(&row, &count, stream, 1);
    } while (!status && count);
    status = status ? status : conus_pose_stream_count(&all, stream);
    conus_pose_stream_destroy(stream);
    return status;
}

/* The sum is that of the whole file, as file_sha256() computes it, wherever reading stands. */
static void what_is_read_has_its_sha256(void **state)
{
    (void)state;
    char wanted[65];
    char got[65];
    struct bytes bytes = {0};
    conus_pose_stream *stream = NULL;
    const char *path = write_table(ROWS, "\n");
    assert_ok(file_read(&bytes, path, UINT64_MAX));
    file_sha256(wanted, &bytes);
    bytes_finish(&bytes);
    static const uint64_t skipped[] = {0, 20000, UINT64_MAX};
    for (size_t i = 0; i < 3; i++) {
        uint64_t count = 0;
        assert_ok(conus_pose_stream_open(&stream, path, NULL));
        (void)read_one(stream);
        assert_ok(conus_pose_stream_count(&count, stream)); /* reads all of it, and is not in the sum */
        assert_ok(conus_pose_stream_skip(stream, skipped[i]));
        assert_ok(conus_pose_stream_sha256(got, stream));
        assert_string_equal(got, wanted);
        assert_ended(stream);
        assert_ok(conus_pose_stream_sha256(got, stream));
        assert_string_equal(got, wanted);
        conus_pose_stream_destroy(stream);
    }
    path = test_scratch("matrix.txt"); /* read whole; the sum is sha256sum's */
    assert_ok(file_write(path, "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n", 32));
    assert_ok(conus_pose_stream_open(&stream, path, NULL));
    assert_ok(conus_pose_stream_sha256(got, stream));
    assert_string_equal(got, "15f3b7bc6f6d08b8a543e64d0b93e33c3e5b07a7b62424991251a66343b8c4bd");
    assert_string_equal(conus_pose_stream_facts(stream).coordsystem_sha256, "");
    conus_pose_stream_destroy(stream);
    stream = parse("1 2 3", NULL);
    assert_fails(conus_pose_stream_sha256(got, stream), CONUS_ERROR_UNSUPPORTED);
    conus_pose_stream_destroy(stream);
}

static void a_file_that_changes_is_an_error(void **state)
{
    (void)state;
    uint64_t count = 0;
    char hash[65];
    conus_pose_stream *stream = NULL;
    const char *path = write_table(ROWS, "\n");
    assert_ok(conus_pose_stream_open(&stream, path, NULL));
    assert_string_equal(read_one(stream).id, "row 1");
    FILE *file = fopen(path, "a");
    assert_non_null(file);
    fputs("row more\t1\t0\t0\t0\t1\t0\n", file);
    assert_int_equal(fclose(file), 0);
    assert_fails(conus_pose_stream_count(&count, stream), CONUS_ERROR_IO);
    assert_fails(conus_pose_stream_skip(stream, UINT64_MAX), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "poses.tsv: changed while it was read"));
    assert_fails(conus_pose_stream_sha256(hash, stream), CONUS_ERROR_IO);
    conus_pose_stream_destroy(stream);
}

/* 2048 bytes a pose (pose_check_count()): a list of three poses needs 6144, one more is refused before it is kept, with
 * the file's name. A stream of rows counts none. */
static void a_list_is_counted(void **state)
{
    (void)state;
    const char *const rows[] = {"query_id\tx\ty\tz\tdx\tdy\tdz\na\t0\t0\t0\t0\t0\t1\nb\t0\t0\t0\t0\t0\t1\n"
                                "c\t0\t0\t0\t0\t0\t1\n",
                                "1 2 3\n4 5 6\n7 8 9\n", "name\tx\ty\tz\nA1\t1\t2\t3\nA2\t4\t5\t6\nA3\t7\t8\t9\n"};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        conus_pose_options options = {.max_memory = 3 * 2048, .format = i == 2 ? "electrodes" : "auto"};
        conus_pose_list *list = NULL;
        assert_ok(pose_list_parse(&list, text_from(rows[i]), &options));
        assert_int_equal(conus_pose_list_count(list), 3);
        conus_pose_list_destroy(list);
        options.max_memory--;
        assert_int_equal(pose_list_parse(&list, text_from(rows[i]), &options), CONUS_ERROR_MEMORY);
        assert_non_null(strstr(conus_message(), "more than 2 poses, which take 2048 bytes each"));
        assert_non_null(strstr(conus_message(), "(--max-memory)"));
    }
    conus_pose_stream *stream = parse(rows[0], &(conus_pose_options){.max_memory = 1});
    for (int i = 0; i < 3; i++) {
        assert_null(read_one(stream).error);
    }
    assert_ended(stream);
    conus_pose_stream_destroy(stream);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    const char *path = test_scratch("small.tsv");
    const char text[] = "x,y,z,dx,dy,dz,near,far\n0,0,0,0,1,0,1,2\n0,0,0,0,1,0,2,1\nbad 7\n";
    assert_ok(file_write(path, text, sizeof text - 1));
    char copy[4096];
    snprintf(copy, sizeof copy, "%s", path);
    test_every_allocation(read_through, copy);
}

TEST_GROUP(pose_stream)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_join_without_a_seam),
        cmocka_unit_test(rows_can_be_passed_over),
        cmocka_unit_test(numbers_count_all_rows),
        cmocka_unit_test(pipes_are_read_as_they_fill),
        cmocka_unit_test(pipes_can_be_stopped),
        cmocka_unit_test(cuts_do_not_matter),
        cmocka_unit_test(optional_columns_are_read),
        cmocka_unit_test(every_axis_looks_its_way),
        cmocka_unit_test(points_are_points),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(what_is_read_has_its_sha256),
        cmocka_unit_test(a_file_that_changes_is_an_error),
        cmocka_unit_test(ranges_are_read),
        cmocka_unit_test(long_lines_are_one_bad_row),
        cmocka_unit_test(a_list_is_counted),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
