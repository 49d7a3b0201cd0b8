/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports on made-up results, so that every value in the text can be worked out by hand. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "selection/report/report.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Areas without a shape: only their names, labels and colours are written. */
enum { A = 1, B, C, D };

static conus_atlas *make_areas(void)
{
    static const conus_object areas[] = {
        {.kind = CONUS_KIND_AREA, .label = 10, .named = true, .name = "Alpha", .abbreviation = "", .rgb = {1, 2, 3}},
        {.kind = CONUS_KIND_AREA,
         .label = 20,
         .named = true,
         .name = "Beta (b)",
         .abbreviation = "",
         .rgb = {255, 0, 16}},
        {.kind = CONUS_KIND_AREA, .label = 30, .named = true, .name = "Gamma", .abbreviation = "G,1", .rgb = {4, 5, 6}},
        {.kind = CONUS_KIND_AREA,
         .label = 40,
         .named = true,
         .name = "Delta, \"d\"",
         .abbreviation = "D",
         .rgb = {7, 8, 9}},
    };
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "made up"));
    for (size_t i = 0; i < sizeof areas / sizeof areas[0]; i++) {
        assert_ok(atlas_add_group(atlas, &areas[i]));
    }
    return atlas;
}

struct made {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_report *report;
};

static struct made make(const conus_report_options *options, conus_layers layers)
{
    struct made made = {.atlas = make_areas()};
    assert_ok(conus_selector_create(&made.selector, made.atlas, &(conus_selector_options){.layers = layers}));
    assert_ok(conus_report_create(&made.report, made.selector, options));
    return made;
}

static void finish(struct made *made)
{
    conus_report_destroy(made->report);
    conus_selector_destroy(made->selector);
    conus_atlas_destroy(made->atlas);
}

static conus_result result_of(uint32_t object, double score, double share, double distance)
{
    return (conus_result){.kind = object ? CONUS_KIND_AREA : CONUS_KIND_UNASSIGNED,
                          .object = object,
                          .score = object ? score : NAN,
                          .share = share,
                          .distance = distance,
                          .contact = {NAN, NAN, NAN},
                          .centroid = {1.5, -2.5, 3.5}};
}

/* Adds a query at a position, with a ball unless `ball` is 0. */
static void add(struct made *made, const char *id, const double at[3], double ball, const conus_result *results,
                size_t count)
{
    struct report_row *rows = NULL;
    struct report_query query = {.asked.ball = ball};
    query.asked.cone.pose = (conus_pose){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, at[0], at[1], at[2], 1}};
    assert_ok(report_append(&rows, made->report, id, &query, count));
    for (size_t i = 0; i < count; i++) {
        rows[i].query = made->report->query_count - 1;
        rows[i].result = results[i];
    }
}

static void assert_text(struct made *made, const char *wanted)
{
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_text(&text, &size, made->report));
    assert_string_equal(text, wanted);
}

static const double nowhere[3] = {0, 0, 0};

/* The margin is the difference of the scores, 0.75 - 0.25, and not the runner-up's share, 0.125. */
static void summaries_tell_by_how_much(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.rows = "summaries", .format = "tsv"}, CONUS_LAYERS_VISIBLE);
    const conus_result three[] = {result_of(B, 0.75, 0.5, 12), result_of(A, 0.25, 0.125, 8),
                                  result_of(0, 0, 0.375, NAN)};
    add(&made, "two hit", nowhere, 0, three, 3);
    add(&made, "one hit", nowhere, 0, (const conus_result[]){three[1], three[2]}, 2);
    add(&made, "none hit", nowhere, 0, &three[2], 1);
    assert_ok(conus_report_add_error(made.report, "lost", 7, "is no pose"));
    assert_text(&made, "query\tkind\tindex\tname\tshare\tscore\tdistance_mm\trunner_up\trunner_up_index\t"
                       "runner_up_share\tmargin\tunassigned_share\terror\n"
                       "two hit\tarea\t20\tBeta (b)\t0.5\t0.75\t12\tAlpha\t10\t0.125\t0.5\t0.375\tn/a\n"
                       "one hit\tarea\t10\tAlpha\t0.125\t0.25\t8\tn/a\tn/a\tn/a\tn/a\t0.375\tn/a\n"
                       "none hit\tunassigned\tn/a\tunassigned\t0.375\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\t0.375\tn/a\n"
                       "lost\terror\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tline 7: is no pose\n");
    finish(&made);
}

/* Nearest first; of equal distances the better rank; without a distance last. The list is not in the order of ranks. */
static void afni_lists_all_by_distance(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.format = "afni"}, CONUS_LAYERS_VISIBLE);
    const conus_result five[] = {result_of(A, 0.9, 0.4, 5), result_of(B, 0.8, 0.3, 5), result_of(C, 0.7, 0.2, 2.25),
                                 result_of(D, 0.6, 0.1, NAN), result_of(0, 0, 0, NAN)};
    add(&made, "1", (const double[]){-12.4, 7.6, -0.4}, 0, five, 5);
    add(&made, "2", nowhere, 0, &five[4], 1);
    static const char *const wanted[] = {"+++++++ nearby Atlas structures +++++++\n\n",
                                         " -12 mm [L],   8 mm [A],  -0 mm [I]",
                                         "atlas          \t2.2\tGamma                           \t---\t30 \n"
                                         "atlas          \t5.0\tAlpha                           \t---\t10 \n"
                                         "atlas          \t5.0\tBeta (b)                        \t---\t20 \n"
                                         "atlas          \t---\tDelta, \"d\"                      \t---\t40 \n\n",
                                         "***** Not near any region stored in databases *****\n\n"};
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_text(&text, &size, made.report));
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        text = strstr(text, wanted[i]);
        if (!text) {
            fail_msg("not in the text, or not in this order: %s", wanted[i]);
        }
        text += strlen(wanted[i]);
    }
    assert_string_equal(text, "");
    finish(&made);
}

/* Adds a contact along +z, in micrometres from the first. */
static void add_contact(struct made *made, const char *id, double micrometres, uint32_t object)
{
    const conus_result results[] = {result_of(object, 1, 0.75, 0), result_of(0, 0, 0.25, NAN)};
    const double at[3] = {4, 5, 6 + micrometres / 1000};
    add(made, id, at, 0.5, object ? results : &results[1], object ? 2 : 1);
}

/* Borders are halfway: (20 + 50) / 2 = 35, (50 + 90) / 2 = 70; the second shank begins at its own first contact. */
static void areas_border_halfway_between_contacts(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.format = "spikeglx"}, CONUS_LAYERS_VISIBLE);
    add_contact(&made, "p1", 0, A);
    add_contact(&made, "p2", 20, A);
    add_contact(&made, "p3", 50, 0);
    add_contact(&made, "p4", 90, B);
    assert_ok(conus_report_add_error(made.report, "p5", 1, "is no pose"));
    add_contact(&made, "p6", 100, B);
    add_contact(&made, "q1", 1000, C);
    add_contact(&made, "q2", 1200, C);
    assert_text(&made, "[0,0](0,35,1,2,3,Alpha)(70,100,255,0,16,Beta  b )\n[0,1](0,200,4,5,6,G 1)\n");
    finish(&made);
}

/* Contacts that go back: the borders 30, (60 - 20) / 2 = 20 and (-20 + 80) / 2 = 30 become 30, 30, 30, so that none
 * goes back. */
static void borders_never_go_back(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.format = "spikeglx"}, CONUS_LAYERS_VISIBLE);
    add_contact(&made, "1", 0, A);
    add_contact(&made, "2", 60, B);
    add_contact(&made, "3", -20, C);
    add_contact(&made, "4", 80, D);
    assert_text(&made, "[0,0](0,30,1,2,3,Alpha)(30,30,255,0,16,Beta  b )(30,30,4,5,6,G 1)(30,80,7,8,9,D)\n");
    finish(&made);
}

static void channels_count_from_0_and_skip_nothing(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.format = "open-ephys"}, CONUS_LAYERS_VISIBLE);
    add_contact(&made, "p1", 0, A);
    add_contact(&made, "p2", 20, A);
    add_contact(&made, "p3", 40, 0);
    assert_ok(conus_report_add_error(made.report, "p4", 1, "is no pose"));
    add_contact(&made, "p5", 60, B);
    assert_text(&made, "0-1,Alpha,010203;4-4,Beta  b ,FF0010\n");
    finish(&made);
}

/* Each trajectory would be a separate shank, all of whose areas lie from 0 to 0. */
static void what_is_no_probe_is_refused(void **state)
{
    (void)state;
    static const char *const formats[] = {"spikeglx", "open-ephys"};
    const conus_result hit = result_of(A, 1, 1, 3);
    const char *text = NULL;
    size_t size = 0;
    for (size_t i = 0; i < 2; i++) {
        struct made made = make(&(conus_report_options){.format = formats[i]}, CONUS_LAYERS_VISIBLE);
        add_contact(&made, "p1", 0, A);
        add(&made, "p2", nowhere, 0, &hit, 1);
        assert_fails(conus_report_text(&text, &size, made.report), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), "\"p2\" has a direction"));
        finish(&made);
    }
    struct made made = make(&(conus_report_options){.format = "spikeglx"}, CONUS_LAYERS_VISIBLE);
    add_contact(&made, "p1", 0, A);
    add_contact(&made, "p2", 10, A);
    add_contact(&made, "left", 20, B);
    add_contact(&made, "right", 30, B);
    assert_fails(conus_report_text(&text, &size, made.report), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "the shank of contact \"left\" has no length"));
    finish(&made);
}

static void a_contact_has_its_best_answer(void **state)
{
    (void)state;
    static const char table[] = "name\tx\ty\tz\tgroup\nA1\t0\t0\t0\tleft\nA2\tn/a\t0\t0\tleft\nA3\t1\t1\t1\n";
    struct made made = make(&(conus_report_options){.format = "bids", .electrodes = table}, CONUS_LAYERS_VISIBLE);
    const conus_result three[] = {result_of(C, 0.75, 0.5, 1.25), result_of(A, 0.25, 0.125, 8),
                                  result_of(0, 0, 0.375, NAN)};
    add(&made, "A1", nowhere, 2, three, 3);
    assert_ok(conus_report_add_error(made.report, "A2", 3, "x: not known"));
    add(&made, "A3", nowhere, 2, &three[2], 1);
    assert_text(&made, "name\tx\ty\tz\tgroup\tarea\tarea_index\tarea_share\tarea_distance_mm\trunner_up\t"
                       "runner_up_share\tarea_error\n"
                       "A1\t0\t0\t0\tleft\tGamma\t30\t0.5\t1.25\tAlpha\t0.125\tn/a\n"
                       "A2\tn/a\t0\t0\tleft\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tline 3: x: not known\n"
                       "A3\t1\t1\t1\tn/a\tunassigned\tn/a\t0.375\tn/a\tn/a\tn/a\tn/a\n");
    finish(&made);
}

/* The text in a column of the first row of a TSV. */
static void cell_of(char out[64], struct made *made, const char *name)
{
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_text(&text, &size, made->report));
    struct text rest = text_from(text);
    struct text header;
    struct text row;
    struct text field = {"", 0};
    struct text title = {"", 0};
    assert_true(text_line(&rest, &header) && text_line(&rest, &row));
    bool more = true;
    bool more_titles = true;
    while (!text_equal(title, name)) {
        assert_true(text_field(&header, '\t', &more_titles, &title) && text_field(&row, '\t', &more, &field));
    }
    snprintf(out, 64, "%.*s", (int)field.size, field.data);
}

/* x and y of LPS grow to the left and to the back: the signs of every position in a row change. */
static void lps_turns_every_position(void **state)
{
    (void)state;
    for (int lps = 0; lps < 2; lps++) {
        struct made made =
            make(&(conus_report_options){.format = "tsv", .space = lps ? CONUS_SPACE_LPS : CONUS_SPACE_RAS},
                 CONUS_LAYERS_ALL);
        conus_result result = result_of(A, 1, 1, 3);
        memcpy(result.contact, (const double[]){7.5, 8.5, 9.5}, sizeof result.contact);
        add(&made, "1", nowhere, 0, &result, 1);
        static const char *const names[] = {"contact_x",  "contact_y",  "contact_z",
                                            "centroid_x", "centroid_y", "centroid_z"};
        static const char *const wanted[][6] = {{"7.5", "8.5", "9.5", "1.5", "-2.5", "3.5"},
                                                {"-7.5", "-8.5", "9.5", "-1.5", "2.5", "3.5"}};
        for (size_t i = 0; i < 6; i++) {
            char cell[64];
            cell_of(cell, &made, names[i]);
            assert_string_equal(cell, wanted[lps][i]);
        }
        finish(&made);
    }
}

/* RFC 4180, rules 1, 5, 6 and 7. */
static void csv_quotes_what_needs_it(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.rows = "summaries", .format = "csv"}, CONUS_LAYERS_VISIBLE);
    const conus_result hit = result_of(D, 0.5, 1, 3);
    add(&made, "one, two", nowhere, 0, &hit, 1);
    add(&made, "=1+1", nowhere, 0, &hit, 1);
    add(&made, "\"", nowhere, 0, &hit, 1);
    assert_text(&made, "query,kind,index,name,share,score,distance_mm,runner_up,runner_up_index,runner_up_share,margin,"
                       "unassigned_share,error\r\n"
                       "\"one, two\",area,40,\"Delta, \"\"d\"\"\",1,0.5,3,n/a,n/a,n/a,n/a,n/a,n/a\r\n"
                       "=1+1,area,40,\"Delta, \"\"d\"\"\",1,0.5,3,n/a,n/a,n/a,n/a,n/a,n/a\r\n"
                       "\"\"\"\",area,40,\"Delta, \"\"d\"\"\",1,0.5,3,n/a,n/a,n/a,n/a,n/a,n/a\r\n");
    finish(&made);
}

TEST_GROUP(report_values)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(summaries_tell_by_how_much),
        cmocka_unit_test(afni_lists_all_by_distance),
        cmocka_unit_test(areas_border_halfway_between_contacts),
        cmocka_unit_test(borders_never_go_back),
        cmocka_unit_test(channels_count_from_0_and_skip_nothing),
        cmocka_unit_test(what_is_no_probe_is_refused),
        cmocka_unit_test(a_contact_has_its_best_answer),
        cmocka_unit_test(lps_turns_every_position),
        cmocka_unit_test(csv_quotes_what_needs_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
