/* SPDX-License-Identifier: BSD-3-Clause */
/* The positions of the 10-10 system: equal to the published table, and mirror images of each other as a head is. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "poses/rows/pose_row.h"
#include "test.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static void positions_are_found_by_any_name(void **state)
{
    (void)state;
    assert_string_equal(position_find(text_from("c3"))->name, "C3");
    assert_string_equal(position_find(text_from("T3"))->name, "T7");
    assert_string_equal(position_find(text_from("t6"))->name, "P8");
    assert_string_equal(position_find(text_from("NZ"))->name, "Nz");
    assert_null(position_find(text_from("C33")));
    assert_null(position_find(text_from("")));
    assert_null(position_at(79));
}

/* An odd number stands on the left and the next even one on its right; z is the middle. Heads are not symmetric to more
 * than 3 mm. Normals have the length 1 and look away from the middle of the head. */
static void positions_lie_as_on_a_head(void **state)
{
    (void)state;
    const struct position *p;
    for (size_t i = 0; (p = position_at(i)); i++) {
        size_t digits = strcspn(p->name, "0123456789");
        int number = (int)strtol(p->name + digits, NULL, 10);
        assert_true(number == 0 || (number % 2 == 1) == (p->point[0] < 0));
        if (number % 2 == 1) {
            char other[32];
            snprintf(other, sizeof other, "%.*s%d", (int)digits, p->name, number + 1);
            const struct position *q = position_find(text_from(other));
            const double mirrored[3] = {-q->point[0], q->point[1], q->point[2]};
            double apart[3];
            vec3_sub(apart, p->point, mirrored);
            assert_true(vec3_length(apart) < 3);
        }
        if (vec3_length(p->outward) > 0) {
            const double out[3] = {p->point[0], p->point[1] + 17, p->point[2] - 5};
            assert_near(vec3_length(p->outward), 1, 2e-3);
            assert_true(vec3_dot(p->outward, out) > 0.7 * vec3_length(out));
        }
    }
}

/* Every row of the published table, by its columns, as another reader has them. */
static void positions_are_the_published_ones(void **state)
{
    (void)state;
    struct bytes bytes = {0};
    assert_ok(file_read(&bytes, test_shared("published/positions.tsv"), 1 << 20));
    struct text rest = {(const char *)bytes.data, bytes.size};
    struct text line;
    size_t count = 0;
    while (text_line(&rest, &line)) {
        struct text fields[14];
        bool more = true;
        for (size_t i = 0; i < 14; i++) {
            assert_true(text_field(&line, '\t', &more, &fields[i]));
        }
        if (!text_equal(fields[3], "ui-10-10")) {
            continue;
        }
        const struct position *p = position_at(count++);
        assert_true(text_equal(fields[0], p->name));
        assert_true(p->also ? text_equal(fields[1], p->also) : text_equal(fields[1], "n/a"));
        for (size_t a = 0; a < 3; a++) {
            double value;
            assert_true(text_to_double(fields[4 + a], &value) && value == p->point[a]);
            assert_true(text_to_double(fields[11 + a], &value) ? value == p->outward[a] : p->outward[a] == 0);
        }
    }
    assert_null(position_at(count));
    bytes_finish(&bytes);
}

TEST_GROUP(positions)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_are_found_by_any_name),
        cmocka_unit_test(positions_lie_as_on_a_head),
        cmocka_unit_test(positions_are_the_published_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
