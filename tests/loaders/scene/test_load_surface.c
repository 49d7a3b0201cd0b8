/* SPDX-License-Identifier: BSD-3-Clause */
/* A surface as ATLAS that changes while it is read; tests/corpus/gifti/ has others. */
#include "builders/gifti_builder.h"
#include "conus/own.h"
#include "loaders/surfaces/surfaces.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

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
    gifti_append_tetrahedron(out, "ASCII");
    if (label_count) {
        gifti_append(out,
                     &(struct array_spec){.intent = "LABEL", .type = "INT32", .rows = label_count, .values = labels});
    }
    gifti_end(out);
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
}

/* A side is what a file states, or else what its name does; "B" and nothing go with either. */
static void sides_that_two_files_state_are_compared(void **state)
{
    (void)state;
    static const struct {
        char surface_side;
        const char *surface;
        char labels_side;
        const char *labels;
        bool fits;
    } cases[] = {{'L', "a.gii", 'L', "b.gii", true},
                 {'L', "a.gii", 'R', "b.gii", false},
                 {'B', "a.gii", 'R', "b.gii", true},
                 {0, "lh.pial", 0, "lh.aparc.annot", true},
                 {0, "lh.pial", 0, "rh.aparc.annot", false},
                 {0, "rh/pial", 0, "lh.aparc.annot", true},
                 {0, "/rh.x/lh.pial.gz", 'R', "b.gii", false},
                 {'R', "lh.pial", 0, "rh.aparc.annot", true}, /* what is stated holds */
                 {0, "s.L.midthickness.surf.gii", 0, "s.R.aparc.label.gii", false},
                 {0, "tpl-fsLR_hemi-L_sphere.surf.gii", 0, "x_hemi-R_dseg.label.gii", false},
                 {0, "MOTOR.L1.gii", 0, "x_hemi-R_dseg.label.gii", true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct job job = {0};
        mesh_file_match_sides(&job, cases[i].surface_side, cases[i].surface, cases[i].labels_side, cases[i].labels);
        conus_status status = job_close(&job, NULL, NULL);
        if ((status == CONUS_OK) != cases[i].fits) {
            fail_msg("%s, %s: %d", cases[i].surface, cases[i].labels, (int)status);
        }
    }
    char annot[1024];
    char link[1024];
    conus_atlas *atlas = NULL;
    snprintf(annot, sizeof annot, "%s", test_shared("meshes/fsaverage5/lh.aparc.annot"));
    snprintf(link, sizeof link, "%s", test_scratch("rh.aparc.annot"));
    assert_int_equal(symlink(annot, link), 0);
    const conus_load_options options = {.labels = link};
    conus_status status = conus_atlas_load(&atlas, test_shared("meshes/fsaverage5/pial_left.gii.gz"), &options);
    assert_fails(status, CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "rh.aparc.annot: labels of the right side, the surface "));
    assert_null(atlas);
}

TEST_GROUP(load_surface)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_that_changes_is_an_error),
        cmocka_unit_test(fsaverage_by_its_annotation),
        cmocka_unit_test(sides_that_two_files_state_are_compared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
