/* SPDX-License-Identifier: BSD-3-Clause */
/* A .dlabel.nii as ATLAS, in manifests, and as labels of a surface. The file and its labels: cifti_builder.h. */
#include "base/buffer.h"
#include "builders/cifti_builder.h"
#include "builders/gifti_builder.h"
#include "builders/nifti_builder.h"
#include "conus/manifest.h"
#include "loaders/volumes/volume_header.h"
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

static void assert_refused(const char *path, const char *message)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, path, NULL);
    if (!status || !strstr(conus_message(), message)) {
        fail_msg("wanted \"%s\", found \"%s\"", message, status ? conus_message() : "an atlas");
    }
    assert_null(strchr(conus_message(), '\n'));
}

/* On the left all vertices but 3 have label 5, so all four triangles are area 5. On the right, with labels 5 5 8 8,
 * triangles (0 2 1) and (0 1 3) have two vertices of label 5, the others two of 8. Label 5 is on both sides. */
static void surfaces_and_voxels_are_one_atlas(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    write_both("both");
    assert_ok(conus_atlas_load(&atlas, test_in("x.dlabel.nii"), NULL));
    assert_string_equal(areas_of(atlas), "7 Thalamus L v2; 5 A L 4; 10005 A R 2; 10008 B R 2");
    assert_true(test_has_note(atlas, "x.dlabel.nii: map 0: labels of CortexLeft are on l.surf.gii (of no known kind)"));
    assert_true(test_has_note(atlas, "labels of CortexRight are raised by 10000, since others have them, too"));
    assert_true(test_has_note(atlas, "2 maps: number 0 (from 0) was used, \"one\""));
    static const uint8_t red[3] = {255, 0, 0}; /* colour of A in the file's table */
    assert_memory_equal(conus_atlas_object(atlas, 2)->rgb, red, 3);
    assert_memory_equal(conus_atlas_object(atlas, 3)->rgb, red, 3);
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    assert_string_equal(info->format, "CIFTI-2");
    assert_int_equal(info->dim[1], 3);
    assert_near(info->world_from_voxel[12], 90, 0);
    assert_int_equal(info->volume, 0);
    assert_int_equal(info->volume_count, 2);
    assert_near(info->minimum, 0, 0);
    assert_near(info->maximum, 7, 0);
    conus_atlas_destroy(atlas);
}

/* Map two has label 8 on the left, where map one does not have it, and nothing else: the right needs no surface. */
static void a_map_is_chosen(void **state)
{
    (void)state;
    char path[300];
    conus_atlas *atlas = NULL;
    test_folder("map");
    write_labels("x.dlabel.nii", &(struct cifti_spec){0});
    write_surface("l.gii", "CortexLeft", NULL, NULL, 10, 4);
    for (int named = 0; named < 2; named++) {
        snprintf(path, sizeof path, "%s,map=%s", test_in("x.dlabel.nii"), named ? "two" : "1");
        assert_ok(conus_atlas_load(&atlas, path, NULL));
        assert_string_equal(areas_of(atlas), "8 B L 4");
        assert_true(test_has_note(atlas, "no label in this map for voxels, left out"));
        assert_true(test_has_note(atlas, "no label in this map for CortexRight, left out"));
        assert_false(test_has_note(atlas, "was used"));
        conus_atlas_destroy(atlas);
    }
    snprintf(path, sizeof path, "%s,map=three", test_in("x.dlabel.nii"));
    assert_refused(path, "x.dlabel.nii: map: 0 maps are called \"three\", one is needed of 0 \"one\", 1 \"two\"");
    const double nothing[CIFTI_GRAYORDINATES * CIFTI_MAPS] = {0};
    write_labels("x.dlabel.nii", &(struct cifti_spec){.values = nothing});
    assert_refused(test_in("x.dlabel.nii"), "x.dlabel.nii: map 0, \"one\", has no label but 0");
}

static void pack_file(const char *name, const char *packed)
{
    struct buffer bytes = {0};
    char content[8192];
    FILE *stream = fopen(test_in(name), "rb");
    assert_non_null(stream);
    size_t size = fread(content, 1, sizeof content, stream);
    assert_true(size > 0 && size < sizeof content);
    assert_int_equal(fclose(stream), 0);
    append_gzip(&bytes, content, size);
    write_buffer(packed, &bytes);
    assert_int_equal(remove(test_in(name)), 0);
}

/* *.surf.gii.gz is preferred to *.gii.gz; each file is read once. */
static void packed_files_are_found(void **state)
{
    (void)state;
    static const char *const surfaces[][2] = {{"l.surf.gii.gz", "r.surf.gii.gz"}, {"l.gii.gz", "r.gii.gz"}};
    for (size_t i = 0; i < 2; i++) {
        write_both(i ? "packed_gii" : "packed_surf");
        pack_file("x.dlabel.nii", "x.dlabel.nii.gz");
        pack_file("l.surf.gii", surfaces[i][0]);
        pack_file("r.surf.gii", surfaces[i][1]);
        assert_areas_with(test_in("x.dlabel.nii.gz"), NULL, "7 Thalamus L v2; 5 A L 4; 10005 A R 2; 10008 B R 2");
    }
}

static size_t count_notes(const conus_atlas *atlas, const char *part)
{
    size_t count = 0;
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        count += strstr(conus_atlas_note(atlas, i), part) != NULL;
    }
    return count;
}

/* Label 0 of map one is called "Sulcus", and one vertex has -1. Both are noted once, though the file is read for each
 * of the surfaces and for the voxels; map two has no such notes. */
static void notes_of_the_file_are_given_once(void **state)
{
    (void)state;
    static const double values[18] = {5, 5, 5, 5, 5, 5, 8, 8, -1, 8, 8, 8, 8, 8, 7, 7, 7, 7};
    char path[300];
    write_both("once");
    write_labels("x.dlabel.nii", &(struct cifti_spec){.find = "unknown", .replace = "Sulcus", .values = values});
    for (int map = 0; map < 2; map++) {
        conus_atlas *atlas = NULL;
        snprintf(path, sizeof path, "%s,map=%d", test_in("x.dlabel.nii"), map);
        assert_ok(conus_atlas_load(&atlas, path, NULL));
        assert_int_equal(count_notes(atlas, "label 0 is called \"Sulcus\""), !map);
        assert_int_equal(count_notes(atlas, "1 vertices or voxels have labels below 0"), !map);
        conus_atlas_destroy(atlas);
    }
}

/* Labels 5, 8 and 7 are each in one structure only, and stay. */
static void labels_of_one_structure_stay(void **state)
{
    (void)state;
    static const double values[18] = {5, 0, 5, 0, 5, 0, 8, 0, 8, 0, 8, 0, 8, 0, 7, 0, 7, 0};
    write_both("apart");
    write_labels("x.dlabel.nii", &(struct cifti_spec){.values = values});
    assert_areas_with(test_in("x.dlabel.nii"), NULL, "7 Thalamus L v2; 5 A L 4; 8 B R 4");
}

/* Label 5 is on voxels and on both sides: the voxels keep it, the left becomes 10005, and the right 20005, since 10005
 * is taken. */
static void labels_of_all_structures_are_three_areas(void **state)
{
    (void)state;
    static const double values[18] = {5, 0, 5, 0, 5, 0, 5, 0, 5, 0, 5, 0, 5, 0, 5, 0, 5, 0};
    write_both("same");
    write_labels("x.dlabel.nii", &(struct cifti_spec){.values = values});
    assert_areas_with(test_in("x.dlabel.nii"), NULL, "5 A L v2; 10005 A L 4; 20005 A R 4");
}

/* The step above 4294967290 is 4294970000. */
static void labels_may_be_too_large_to_be_raised(void **state)
{
    (void)state;
    static const double values[18] = {4294967290, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4294967290, 0, 0, 0};
    write_both("large");
    write_labels("x.dlabel.nii", &(struct cifti_spec){.find = "Key=\"7\"",
                                                      .replace = "Key=\"4294967290\"",
                                                      .values = values,
                                                      .datatype = VOLUME_FLOAT64});
    assert_refused(test_in("x.dlabel.nii"), "x.dlabel.nii: label 4294967290 of a structure, raised by 4294970000 since "
                                            "others have its labels, is above 4294967295");
}

/* The best kind of surface is used, by the file's own metadata first, otherwise by its name. Edges of 10 mm: 1000/6
 * mm^3. */
static void the_kind_of_surface_is_chosen(void **state)
{
    (void)state;
    static const struct {
        const char *name, *layer, *type, *kind;
    } steps[] = {
        {"a_other.surf.gii", NULL, "Reconstruction", "a_other.surf.gii (of no known kind)"},
        {"b.smoothwm.surf.gii", NULL, NULL, "b.smoothwm.surf.gii (smoothwm)"},
        {"c.white.surf.gii", NULL, "Anatomical", "c.white.surf.gii (white)"},
        {"z.surf.gii", "Pial", NULL, "z.surf.gii (pial)"},
        {"d.white.MidThickness.surf.gii", NULL, NULL, "d.white.MidThickness.surf.gii (midthickness)"},
    };
    test_folder("kinds");
    write_labels("x.dlabel.nii", &(struct cifti_spec){0});
    write_surface("r.surf.gii", "CortexRight", NULL, NULL, 10, 4);
    write_surface("0.midthickness.very_inflated.surf.gii", "CortexLeft", NULL, NULL, 10, 4);
    write_surface("1.midthickness.surf.gii", "CortexLeft", "MidThickness", "Flat", 10, 4);
    write_surface("2.midthickness.surf.gii", "CortexLeft", "MidThickness", NULL, 10, 5);
    write_surface("3.midthickness.gii", "CortexLeft", "MidThickness", NULL, 10, 4);
    write_surface("4.midthickness.surf.gii", NULL, "MidThickness", NULL, 10, 4);
    assert_refused(
        test_in("x.dlabel.nii"),
        "x.dlabel.nii: no surface of CortexLeft with 4 vertices beside it: looked for is *.surf.gii or *.gii "
        "with AnatomicalStructurePrimary CortexLeft that is not inflated, a sphere or flat; there is "
        "0.midthickness.very_inflated.surf.gii (CortexLeft, 4 vertices, not anatomical), "
        "1.midthickness.surf.gii (CortexLeft, 4 vertices, not anatomical), 2.midthickness.surf.gii "
        "(CortexLeft, 5 vertices, midthickness), 4.midthickness.surf.gii (of no structure, 4 vertices, "
        "midthickness), ...");
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        conus_atlas *atlas = NULL;
        char note[100];
        write_surface(steps[i].name, "CortexLeft", steps[i].layer, steps[i].type, 10, 4);
        assert_ok(conus_atlas_load(&atlas, test_in("x.dlabel.nii"), NULL));
        snprintf(note, sizeof note, "labels of CortexLeft are on %s", steps[i].kind);
        assert_true(test_has_note(atlas, note));
        conus_atlas_destroy(atlas);
    }
    write_surface("e.midthickness.surf.gii", "CortexLeft", NULL, NULL, 10, 4);
    assert_refused(test_in("x.dlabel.nii"),
                   "surfaces of CortexLeft: d.white.MidThickness.surf.gii and e.midthickness.surf.gii are both "
                   "midthickness and have 4 vertices; a manifest can say which");
}

static void no_surface_is_an_error(void **state)
{
    (void)state;
    test_folder("none");
    write_labels("x.dlabel.nii", &(struct cifti_spec){0});
    assert_refused(test_in("x.dlabel.nii"), "no surface of CortexLeft with 4 vertices beside it");
    assert_non_null(strstr(conus_message(), "; there is no surface"));
    conus_atlas *atlas = NULL;
    const conus_load_options options = {.labels = "table.txt"};
    assert_fails(conus_atlas_load(&atlas, test_in("x.dlabel.nii"), &options), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "names its labels itself"));
}

static void as_labels_of_a_surface(void **state)
{
    (void)state;
    static const char obj[] = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\n";
    char labels[300];
    conus_atlas *atlas = NULL;
    write_both("labels");
    snprintf(labels, sizeof labels, "%s", test_in("x.dlabel.nii"));
    conus_load_options options = {.labels = labels};
    assert_areas_with(test_in("r.surf.gii"), &options, "5 A R 2; 8 B R 2");
    write_surface("small.surf.gii", "CortexRight", NULL, NULL, 10, 5);
    assert_fails(conus_atlas_load(&atlas, test_in("small.surf.gii"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "x.dlabel.nii: labels of 4 vertices of CortexRight, small.surf.gii has 5"));
    write_surface("cerebellum.surf.gii", "Cerebellum", NULL, NULL, 10, 4);
    assert_fails(conus_atlas_load(&atlas, test_in("cerebellum.surf.gii"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(),
                           "labels of Cerebellum, which cerebellum.surf.gii is, are not there: the file "
                           "has those of CortexLeft, CortexRight"));
    write_text("lh.obj", obj);
    assert_fails(conus_atlas_load(&atlas, test_in("lh.obj"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "lh.obj does not say which structure it is (AnatomicalStructurePrimary)"));
}

/* The structure is that of the surface's metadata, or of "hemisphere"; voxels come from the parcellation. */
static void in_a_manifest(void **state)
{
    (void)state;
    static const char obj[] = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\n";
    write_both("manifest");
    write_text("lh.obj", obj);
    write_text("m.atlas.json",
               "{\"conus_atlas\": 1, \"parcellation\": \"x.dlabel.nii,map=one\", \"areas\": [{\"file\": "
               "\"r.surf.gii\", \"vertex_labels\": \"x.dlabel.nii,map=0\", \"label_offset\": 100}, "
               "{\"file\": \"lh.obj\", \"vertex_labels\": \"x.dlabel.nii,map=two\", \"hemisphere\": "
               "\"L\"}]}");
    assert_areas_with(test_in("m.atlas.json"), NULL, "7 Thalamus L v2; 8 B L 4; 105 A R 2; 108 B R 2");
    write_text("m.atlas.json", "{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"x.dlabel.nii,map=1\"}}");
    assert_refused(test_in("m.atlas.json"), "x.dlabel.nii: no voxel has a label but 0 in map 1");
    write_text("m.atlas.json", "{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"x.dlabel.nii\", \"volume\": 0}}");
    assert_refused(test_in("m.atlas.json"), "intent_code: found 3007, a CIFTI matrix of labels");
    const struct cifti_spec cortex = {.find = "<BrainModel IndexOffset=\"7\" IndexCount=\"2\" "
                                              "ModelType=\"CIFTI_MODEL_TYPE_VOXELS\" "
                                              "BrainStructure=\"CIFTI_STRUCTURE_THALAMUS_LEFT\"><VoxelIndicesIJK>0 0 "
                                              "0\n1 2 1</VoxelIndicesIJK>",
                                      .replace = "<BrainModel IndexOffset=\"7\" IndexCount=\"2\" "
                                                 "ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" "
                                                 "BrainStructure=\"CIFTI_STRUCTURE_CEREBELLUM\" "
                                                 "SurfaceNumberOfVertices=\"4\"><VertexIndices>0 3</VertexIndices>"};
    write_labels("x.dlabel.nii", &cortex);
    write_text("m.atlas.json", "{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"x.dlabel.nii\"}}");
    assert_refused(test_in("m.atlas.json"), "x.dlabel.nii: no voxels, its labels are of vertices only");
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

static conus_status attempt(void *data)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, data, NULL);
    conus_atlas_destroy(atlas);
    return status;
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
    snprintf(path, sizeof path, "%s", test_in("x.dlabel.nii"));
    test_every_allocation(attempt, path);
    assert_true(test_every_primitive(attempt, path) > 5);
    snprintf(path, sizeof path, "%s", test_in("failing.atlas.json"));
    test_every_allocation(attempt_manifest, path);
    assert_true(test_every_primitive(attempt_manifest, path) > 5);
}

TEST_GROUP(load_cifti)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_and_voxels_are_one_atlas),
        cmocka_unit_test(a_map_is_chosen),
        cmocka_unit_test(packed_files_are_found),
        cmocka_unit_test(notes_of_the_file_are_given_once),
        cmocka_unit_test(labels_of_one_structure_stay),
        cmocka_unit_test(labels_of_all_structures_are_three_areas),
        cmocka_unit_test(labels_may_be_too_large_to_be_raised),
        cmocka_unit_test(the_kind_of_surface_is_chosen),
        cmocka_unit_test(no_surface_is_an_error),
        cmocka_unit_test(as_labels_of_a_surface),
        cmocka_unit_test(in_a_manifest),
        cmocka_unit_test(a_first_manifest_of_a_folder),
        cmocka_unit_test(a_first_manifest_of_voxels),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
