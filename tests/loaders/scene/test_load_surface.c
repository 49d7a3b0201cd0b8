/* SPDX-License-Identifier: BSD-3-Clause */
/* A surface as ATLAS. */
#include "base/memory.h"
#include "builders/gifti_builder.h"
#include "builders/nifti_builder.h"
#include "conus/atlas_info.h"
#include "conus/file.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

#define TABLE                                                                                                          \
    "<LabelTable><Label Key=\"0\">unknown</Label><Label Key=\"5\" Red=\"1\" Green=\"0\" Blue=\"0\">V1</Label>"         \
    "<Label Key=\"8\">nowhere</Label></LabelTable>"
#define SIDE "<MetaData><MD><Name>AnatomicalStructurePrimary</Name><Value>CortexLeft</Value></MD></MetaData>"

/* The tetrahedron, with `label_count` labels (5, 5, 3, ...) in the same file unless that is 0. */
static void make_surface(struct buffer *out, size_t label_count)
{
    static const double labels[5] = {5, 5, 5, 3, 3};
    gifti_begin(out, "", label_count ? 3 : 2);
    buffer_text(out, SIDE TABLE);
    gifti_append_tetrahedron(out, "ASCII", false, false);
    if (label_count) {
        gifti_append(out,
                     &(struct array_spec){.intent = "LABEL", .type = "INT32", .rows = label_count, .values = labels});
    }
    gifti_end(out);
}

static const char *write_surface(const char *name, size_t label_count)
{
    struct buffer bytes = {0};
    make_surface(&bytes, label_count);
    const char *path = write_packed(name, &bytes);
    buffer_finish(&bytes);
    return path;
}

static void a_surface_is_an_area(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, write_surface("lh.pial.surf.gii.gz", 0), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 1);
    const conus_object *area = conus_atlas_object(atlas, 1);
    assert_int_equal(area->kind, CONUS_KIND_AREA);
    assert_int_equal(area->label, 1);
    assert_string_equal(area->name, "lh.pial");
    assert_int_equal(area->hemisphere, 'L');
    assert_int_equal(area->triangles, 4);
    assert_near(area->volume_mm3, 1000. / 6, 1e-3);
    conus_atlas_destroy(atlas);
}

/* Vertex 3 has label 3. Three triangles have it as one vertex of three, so that no triangle has label 3. */
static void labels_inside_or_beside_cut_it(void **state)
{
    (void)state;
    for (int beside = 0; beside < 2; beside++) {
        conus_atlas *atlas = NULL;
        conus_load_options options = {0};
        char labels[256];
        snprintf(labels, sizeof labels, "%s", write_surface("labels.gii", 4));
        options.labels = beside ? labels : NULL;
        assert_ok(conus_atlas_load(&atlas, beside ? write_surface("plain.gii", 0) : labels, &options));
        assert_int_equal(conus_atlas_object_count(atlas), 1);
        const conus_object *area = conus_atlas_object(atlas, 1);
        assert_string_equal(area->name, "V1");
        assert_true(area->named);
        assert_int_equal(area->label, 5);
        assert_int_equal(area->rgb[0], 255);
        assert_int_equal(area->triangles, 4);
        bool told = false;
        for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
            told = told || strstr(conus_atlas_note(atlas, i), "names without a triangle: 1 (nowhere)");
        }
        assert_true(told);
        conus_atlas_destroy(atlas);
    }
}

/* A file that grows after the n-th close() from now on, between two readings; 0 = never. */
static char growing[256];
static size_t closes_left;

int __real_close(int descriptor);
int __wrap_close(int descriptor);

int __wrap_close(int descriptor)
{
    int closed = __real_close(descriptor);
    if (closes_left && --closes_left == 0) {
        FILE *file = fopen(growing, "a");
        assert_non_null(file);
        fputc('\n', file);
        assert_int_equal(fclose(file), 0);
    }
    return closed;
}

/* The checksum of the atlas must be that of the bytes from which it was made. */
static void a_surface_that_changes_is_an_error(void **state)
{
    (void)state;
    size_t noticed = 0;
    struct buffer bytes = {0};
    make_surface(&bytes, 0); /* not packed, so that a byte more at its end makes no other surface */
    for (size_t n = 1;; n++) {
        conus_atlas *atlas = NULL;
        snprintf(growing, sizeof growing, "%s", test_scratch("growing.gii"));
        assert_ok(conus_write_file(growing, bytes.data, bytes.size));
        closes_left = n;
        conus_status status = conus_atlas_load(&atlas, growing, NULL);
        bool done = closes_left > 0;
        closes_left = 0;
        conus_atlas_destroy(atlas);
        if (done) {
            assert_ok(status);
            break;
        }
        if (status) { /* otherwise the file grew while only its kind was detected, before any of it was kept */
            assert_fails(status, CONUS_ERROR_IO);
            assert_non_null(strstr(conus_message(), "growing.gii: changed while it was read"));
            noticed++;
        }
    }
    buffer_finish(&bytes);
    assert_true(noticed >= 2); /* it is read for its triangles, and for its checksum */
}

static void labels_must_fit(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, write_surface("more.gii", 5), NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "labels of 5 vertices, the surface"));
    const char *plain = write_surface("plain.gii", 0);
    const conus_load_options options = {.labels = plain};
    assert_fails(conus_atlas_load(&atlas, plain, &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "labels of 0 vertices"));
}

static conus_status attempt(void *data)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, data, NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    for (size_t count = 0; count < 5; count += 4) {
        char path[256];
        snprintf(path, sizeof path, "%s", write_surface("failing.gii", count));
        test_every_allocation(attempt, path);
        assert_true(test_every_primitive(attempt, path) > 5);
    }
}

static conus_status attempt_labels(void *labels)
{
    const conus_load_options options = {.labels = labels};
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, test_shared("meshes/fsaverage5/pial_left.gii.gz"), &options);
    conus_atlas_destroy(atlas);
    return status;
}

/* The usual case: a surface without labels, and FreeSurfer's annotation. */
static void fsaverage_by_its_annotation(void **state)
{
    (void)state;
    char annot[1024];
    conus_atlas *atlas = NULL;
    snprintf(annot, sizeof annot, "%s", test_shared("meshes/fsaverage5/lh.aparc.annot"));
    const conus_load_options options = {.labels = annot};
    assert_ok(conus_atlas_load(&atlas, test_shared("meshes/fsaverage5/pial_left.gii.gz"), &options));
    assert_int_equal(conus_atlas_object_count(atlas), 35);
    assert_string_equal(conus_atlas_object(atlas, 35)->name, "insula");
    assert_int_equal(conus_atlas_object(atlas, 35)->label, 35);
    conus_atlas_destroy(atlas);
    assert_true(test_every_primitive(attempt_labels, annot) > 5);
}

TEST_GROUP(load_surface)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_is_an_area),
        cmocka_unit_test(labels_inside_or_beside_cut_it),
        cmocka_unit_test(a_surface_that_changes_is_an_error),
        cmocka_unit_test(labels_must_fit),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(fsaverage_by_its_annotation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
