/* SPDX-License-Identifier: BSD-3-Clause */
/* First manifests of folders with FreeSurfer's surfaces, which have no ending, and annotations beside them. */
#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static void write_buffer(const char *name, struct buffer *bytes)
{
    assert_ok(buffer_status(bytes));
    assert_ok(conus_write_file(test_in(name), bytes->data, bytes->size));
    buffer_finish(bytes);
}

/* A tetrahedron at x mm. */
static void write_surface(const char *name, double x)
{
    static const double vertices[12] = {0, 0, 0, 10, 0, 0, 0, 20, 0, 0, 0, 30};
    static const int triangles[12] = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};
    struct buffer bytes = {0};
    buffer_append(&bytes, "\xff\xff\xfe\n\n", 5);
    append_ordered(&bytes, 4, 4, true);
    append_ordered(&bytes, 4, 4, true);
    for (size_t i = 0; i < 12; i++) {
        append_float(&bytes, vertices[i] + (i % 3 ? 0 : x), true);
    }
    for (size_t i = 0; i < 12; i++) {
        append_ordered(&bytes, (uint64_t)triangles[i], 4, true);
    }
    write_buffer(name, &bytes);
}

/* An annotation of `count` vertices, all of which are `area`, entry 1 of its table. */
static void write_annotation(const char *name, size_t count, const char *area)
{
    struct buffer bytes = {0};
    append_ordered(&bytes, count, 4, true);
    for (size_t i = 0; i < count; i++) {
        append_ordered(&bytes, i, 4, true);
        append_ordered(&bytes, 10 + 256 * 20 + 65536 * 30, 4, true);
    }
    append_ordered(&bytes, 1, 4, true);              /* a table follows */
    append_ordered(&bytes, UINT32_MAX - 1, 4, true); /* version -2 */
    append_ordered(&bytes, 2, 4, true);              /* indices below 2 */
    append_ordered(&bytes, 2, 4, true);
    buffer_append(&bytes, "x", 2);
    append_ordered(&bytes, 1, 4, true); /* one entry */
    append_ordered(&bytes, 1, 4, true);
    append_ordered(&bytes, strlen(area) + 1, 4, true);
    buffer_append(&bytes, area, strlen(area) + 1);
    append_ordered(&bytes, 10, 4, true);
    append_ordered(&bytes, 20, 4, true);
    append_ordered(&bytes, 30, 4, true);
    append_ordered(&bytes, 0, 4, true);
    write_buffer(name, &bytes);
}

/* "label name hemisphere; ..." of the areas of the atlas. */
static const char *areas_of(const conus_atlas *atlas)
{
    static char text[512];
    text[0] = '\0';
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%u %s %c", i > 1 ? "; " : "", object->label, object->name,
                 object->hemisphere ? object->hemisphere : '-');
    }
    return text;
}

static void assert_areas(const char *path, const char *areas)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in(path), NULL));
    assert_string_equal(areas_of(atlas), areas);
    conus_atlas_destroy(atlas);
}

static void write_hemispheres(const char *folder)
{
    static const char *const names[] = {"lh.pial", "rh.pial", "lh.white", "rh.white", "lh.inflated", "rh.sphere"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s%s", folder, names[i]);
        write_surface(name, names[i][0] == 'l' ? -20 : 20);
    }
}

static void an_annotation_of_another_surface_is_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("size");
    write_hemispheres("");
    write_annotation("lh.aparc.annot", 5, "alpha");
    assert_fails(conus_atlas_load(&atlas, test_in(""), NULL), CONUS_ERROR_DATA);
    assert_null(atlas);
    assert_ok(conus_manifest_write(test_in("s.atlas.json"), NULL)); /* left out, and the surface is one area */
    assert_areas("s.atlas.json", "1 lh.pial -; 2 rh.pial -");
}

static void a_manifest_of_a_subject_takes_its_annotations(void **state)
{
    (void)state;
    test_folder("subject");
    assert_int_equal(mkdir(test_in("surf"), 0700), 0);
    assert_int_equal(mkdir(test_in("label"), 0700), 0);
    write_hemispheres("surf/");
    write_annotation("label/lh.aparc.annot", 4, "alpha");
    write_annotation("label/rh.aparc.annot", 4, "beta");
    write_annotation("label/lh.aparc.a2009s.annot", 4, "gamma");
    assert_ok(conus_manifest_write(test_in("s.atlas.json"), NULL));
    assert_areas("s.atlas.json", "1 alpha L; 10001 beta R");
}

TEST_GROUP(manifest_freesurfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_annotation_of_another_surface_is_refused),
        cmocka_unit_test(a_manifest_of_a_subject_takes_its_annotations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
