/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's labels: lists of vertices, and the areas that they cut from a surface. */
#include "loaders/surfaces/freesurfer_labels.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "builders/gifti_builder.h"
#include "builders/label_row.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEAD "#!ascii label  , from subject bert vox2ras=TkReg\n"
static const char two[] = HEAD "2\n0  -1.5 2.0 3.25 0.0\n1  4 5 6 1e-3\n";

static void vertices_of_the_list_are_labelled(void **state)
{
    (void)state;
    uint32_t *labels = NULL;
    size_t count = 0;
    assert_true(freesurfer_label_is(text_from(two)));
    assert_ok(freesurfer_label_parse(&labels, &count, text_from(HEAD "3\n5 0 0 0 0\r\n2 0 0 0 0\n2 0 0 0 0")));
    static const uint32_t wanted[6] = {0, 0, 1, 0, 0, 1};
    assert_int_equal(count, 6);
    assert_memory_equal(labels, wanted, sizeof wanted);
    memory_free(labels);
}

static void broken_labels_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {HEAD, "line 2: the number of vertices, 1 to 16777216"},
        {HEAD "0\n", "line 2: the number"},
        {HEAD "x\n0 0 0 0 0\n", "line 2: the number"},
        {HEAD "2\n0 0 0 0 0\n", "line 4: a vertex"},
        {HEAD "1\n0 0 0 0 0\n1 0 0 0 0\n", "line 2: 1 vertices, but more lines follow"},
        {HEAD "1\n0 0 0 0\n", "line 3: a vertex"},
        {HEAD "1\n0 0 0 0 0 0\n", "line 3: a vertex"},
        {HEAD "1\n0 0 0 x 0\n", "line 3: a vertex"},
        {HEAD "1\n-1 0 0 0 0\n", "line 3: vertex -1: this label is of voxels"},
        {HEAD "1\n16777216 0 0 0 0\n", "line 3: a vertex, 0 to 16777215"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint32_t *labels = NULL;
        size_t count = 0;
        assert_fails(freesurfer_label_parse(&labels, &count, text_from(cases[i].text)), CONUS_ERROR_DATA);
        assert_null(labels);
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("\"%s\" does not say \"%s\"", conus_message(), cases[i].part);
        }
    }
}

/* Only the end of the last number may be missing. */
static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (size_t size = 0; size < strlen(two); size++) {
        uint32_t *labels = NULL;
        size_t count = 0;
        char *exact = malloc(size ? size : 1); /* so that a sanitizer notices one byte too many */
        assert_non_null(exact);
        memcpy(exact, two, size);
        conus_status status = freesurfer_label_parse(&labels, &count, (struct text){exact, size});
        assert_true(status == CONUS_ERROR_DATA || (!status && size >= strlen(two) - strlen("e-3\n")));
        memory_free(labels);
        free(exact);
    }
}

static conus_status parse_two(void *data)
{
    uint32_t *labels = NULL;
    size_t count = 0;
    conus_status status = freesurfer_label_parse(&labels, &count, text_from(data));
    memory_free(labels);
    return status;
}

static void write_tetrahedron(void)
{
    struct buffer bytes = {0};
    gifti_begin(&bytes, "", 2);
    gifti_append_tetrahedron(&bytes, "ASCII", false, false);
    gifti_end(&bytes);
    row_text(test_in("s.gii"), bytes.data);
    buffer_finish(&bytes);
}

static conus_status load_two(void *data)
{
    conus_atlas *atlas = NULL;
    const conus_load_options options = {.labels = data};
    conus_status status = conus_atlas_load(&atlas, test_in("s.gii"), &options);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    char labels[512];
    test_every_allocation(parse_two, (void *)two);
    test_folder("memory");
    write_tetrahedron();
    row_text(test_in("lh.V1.label"), two);
    snprintf(labels, sizeof labels, "%s", test_in("lh.V1.label"));
    test_every_allocation(load_two, labels);
}

static void assert_area(conus_atlas *atlas)
{
    assert_int_equal(conus_atlas_object_count(atlas), 1);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "V1_exvivo");
    assert_int_equal(conus_atlas_object(atlas, 1)->label, 1);
    assert_int_equal(conus_atlas_object(atlas, 1)->hemisphere, 'L');
    assert_int_equal(conus_atlas_object(atlas, 1)->triangles, 2);
    conus_atlas_destroy(atlas);
}

/* Two triangles of the tetrahedron have both vertices 0 and 1, so that most of their vertices are in the list. */
static void a_list_cuts_a_surface(void **state)
{
    (void)state;
    char labels[512];
    conus_atlas *atlas = NULL;
    const conus_load_options options = {.labels = labels};
    size_t shared = 0;
    for (size_t t = 0; t < 4; t++) {
        size_t corners = 0;
        for (size_t k = 0; k < 3; k++) {
            corners += tetrahedron_triangles[3 * t + k] < 2;
        }
        shared += corners == 2;
    }
    assert_int_equal(shared, 2);
    test_folder("list");
    write_tetrahedron();
    row_text(test_in("lh.V1_exvivo.label"), two);
    snprintf(labels, sizeof labels, "%s", test_in("lh.V1_exvivo.label"));
    assert_ok(conus_atlas_load(&atlas, test_in("s.gii"), &options));
    assert_area(atlas);
    row_text(test_in("m.atlas.json"), "{\"conus_atlas\": 1, \"areas\": [{\"file\": \"s.gii\", \"vertex_labels\": "
                                      "\"lh.V1_exvivo.label\"}]}");
    atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in("m.atlas.json"), NULL));
    assert_area(atlas);
    row_text(labels, HEAD "1\n4 0 0 0 0\n"); /* the surface has vertices 0 to 3 */
    atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, test_in("s.gii"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "labels of 5 vertices"));
}

static void volumes_say_what_it_is_for(void **state)
{
    (void)state;
    char labels[512];
    conus_atlas *atlas = NULL;
    const conus_load_options options = {.labels = labels};
    test_folder("volume");
    row_write("v.nii", 4, 1);
    row_text(test_in("lh.V1.label"), two);
    snprintf(labels, sizeof labels, "%s", test_in("lh.V1.label"));
    assert_fails(conus_atlas_load(&atlas, test_in("v.nii"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(),
                           "lh.V1.label: this is a FreeSurfer label of vertices: give it as --labels, and "
                           "its surface as ATLAS; needed is a label table"));
}

TEST_GROUP(freesurfer_label)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_of_the_list_are_labelled),
        cmocka_unit_test(broken_labels_are_refused),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(a_list_cuts_a_surface),
        cmocka_unit_test(volumes_say_what_it_is_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
