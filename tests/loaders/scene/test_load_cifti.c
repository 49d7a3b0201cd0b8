/* SPDX-License-Identifier: BSD-3-Clause */
/* First manifests of a folder with a .dlabel.nii (cifti_builder.h); tests/corpus/cifti/ has it as ATLAS. */
#include "base/memory.h"
#include "builders/cifti_builder.h"
#include "builders/gifti_builder.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* conus_write_file() would wait for the disk, which takes long. */
static void write_file(const char *name, const void *data, size_t size)
{
    FILE *stream = fopen(test_in(name), "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(data, 1, size, stream), size);
    assert_int_equal(fclose(stream), 0);
}

static void write_buffer(const char *name, struct buffer *bytes)
{
    assert_ok(buffer_status(bytes));
    write_file(name, bytes->data, bytes->size);
    buffer_finish(bytes);
}

static void write_text(const char *name, const char *text)
{
    write_file(name, text, strlen(text));
}

static void write_labels(const char *name, const struct cifti_spec *spec)
{
    struct buffer bytes = {0};
    cifti_build(&bytes, spec);
    write_buffer(name, &bytes);
}

/* A tetrahedron with edges of `mm`, with 4 vertices or one more that no triangle has. Its metadata are structure, layer
 * and type, unless NULL. */
static void write_surface(const char *name, const char *structure, const char *layer, const char *type, double mm,
                          size_t vertices)
{
    static const char *const keys[] = {"AnatomicalStructurePrimary", "AnatomicalStructureSecondary", "GeometricType"};
    const char *const given[] = {structure, layer, type};
    struct buffer bytes = {0};
    double positions[15] = {0};
    for (size_t i = 0; i < 12; i++) {
        positions[i] = tetrahedron_vertices[i] * mm / 10;
    }
    positions[12] = mm / 4;
    gifti_begin(&bytes, "", 2);
    buffer_text(&bytes, "<MetaData>");
    for (size_t i = 0; i < 3; i++) {
        if (given[i]) {
            buffer_format(&bytes, "<MD><Name>%s</Name><Value>%s</Value></MD>", keys[i], given[i]);
        }
    }
    buffer_text(&bytes, "</MetaData>");
    gifti_append(&bytes, &(struct array_spec){.rows = vertices, .columns = 3, .values = positions});
    gifti_append(&bytes,
                 &(struct array_spec){
                     .intent = "TRIANGLE", .type = "INT32", .rows = 4, .columns = 3, .values = tetrahedron_triangles});
    gifti_end(&bytes);
    write_buffer(name, &bytes);
}

static void write_both(const char *folder)
{
    test_folder(folder);
    write_labels("x.dlabel.nii", &(struct cifti_spec){0});
    write_surface("l.surf.gii", "CortexLeft", NULL, NULL, 10, 4);
    write_surface("r.surf.gii", "CortexRight", NULL, NULL, 10, 4);
}

/* "label name hemisphere triangles; ..." of the areas; those of voxels have "v" and their number. */
static const char *areas_of(const conus_atlas *atlas)
{
    static char text[512];
    text[0] = '\0';
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%u %s %c %s%zu", i > 1 ? "; " : "", object->label, object->name,
                 object->hemisphere ? object->hemisphere : '-', object->voxels ? "v" : "",
                 object->voxels ? (size_t)object->voxels : (size_t)object->triangles);
    }
    return text;
}

static void assert_areas_with(const char *path, const conus_load_options *options, const char *areas)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, path, options));
    assert_string_equal(areas_of(atlas), areas);
    conus_atlas_destroy(atlas);
}

static void a_surface_must_say_what_it_is(void **state)
{
    (void)state;
    static const char obj[] = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\n";
    char labels[300];
    conus_atlas *atlas = NULL;
    write_both("labels");
    snprintf(labels, sizeof labels, "%s", test_in("x.dlabel.nii"));
    const conus_load_options options = {.labels = labels};
    write_text("lh.obj", obj);
    assert_fails(conus_atlas_load(&atlas, test_in("lh.obj"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "lh.obj does not say which structure it is (AnatomicalStructurePrimary)"));
}

static void a_first_manifest_of_a_folder(void **state)
{
    (void)state;
    write_both("folder");
    write_surface("l.inflated.surf.gii", "CortexLeft", NULL, "Inflated", 30, 4);
    assert_ok(conus_manifest_write(test_in("m.atlas.json"), NULL));
    assert_areas_with(test_in("m.atlas.json"), NULL, "7 Thalamus L v2; 5 A L 4; 10005 A R 2; 10008 B R 2");
    write_labels("y.dlabel.nii", &(struct cifti_spec){0});
    assert_ok(conus_manifest_write(test_in("n.atlas.json"), NULL)); /* it is unknown which one is used */
    assert_areas_with(test_in("n.atlas.json"), NULL, "1 l.inflated L 4; 2 l L 4; 3 r R 4");
}

/* A file of voxels alone needs no surface. A surface in a folder inside becomes an area, with a label above 8. */
static void a_first_manifest_of_voxels(void **state)
{
    (void)state;
    static const double values[18] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7, 0, 7, 0};
    test_folder("voxels");
    assert_int_equal(mkdir(test_in("more"), 0700), 0);
    write_labels("x.dlabel.nii", &(struct cifti_spec){.values = values});
    write_surface("more/target.surf.gii", "CortexLeft", NULL, NULL, 10, 4);
    assert_ok(conus_manifest_write(test_in("m.atlas.json"), NULL));
    assert_areas_with(test_in("m.atlas.json"), NULL, "7 Thalamus L v2; 10001 target L 4");
}

static void hear(void *user, const conus_note *note)
{
    buffer_format(user, "%s|", note->line);
}

/* Which of its maps would have been taken is said, too. */
static void a_refused_file_is_told_with_its_notes(void **state)
{
    (void)state;
    struct buffer heard = {0};
    test_folder("refused");
    write_labels("x.dlabel.nii", &(struct cifti_spec){0});
    write_surface("l.surf.gii", "CortexLeft", NULL, NULL, 10, 4);
    assert_ok(
        conus_manifest_write(test_in("m.atlas.json"), &(conus_manifest_options){.log = hear, .log_user = &heard}));
    assert_ok(buffer_status(&heard));
    assert_non_null(strstr(heard.data, "x.dlabel.nii: left out, since it does not load"));
    assert_non_null(strstr(heard.data, "x.dlabel.nii: 2 maps: number 0 (from 0) was used"));
    buffer_finish(&heard);
}

static conus_status attempt_manifest(void *data)
{
    conus_status status = conus_manifest_write(data, NULL);
    remove(data);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    char path[300];
    write_both("failing");
    snprintf(path, sizeof path, "%s", test_in("failing.atlas.json"));
    test_every_allocation(attempt_manifest, path);
}

TEST_GROUP(load_cifti)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_must_say_what_it_is), cmocka_unit_test(a_first_manifest_of_a_folder),
        cmocka_unit_test(a_first_manifest_of_voxels),    cmocka_unit_test(a_refused_file_is_told_with_its_notes),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
