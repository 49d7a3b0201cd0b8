/* SPDX-License-Identifier: BSD-3-Clause */
/* The callback for notes of a load: each note comes once, when it is made, with its severity and the file that it is
 * about, also if the load fails afterwards. */
#include "atlas/atlas.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HEARD = 16 };

struct heard {
    size_t count;
    struct {
        conus_severity severity;
        char path[300];
        char line[512];
    } notes[HEARD];
};

static void hear(void *user, const conus_note *note)
{
    struct heard *heard = user;
    assert_true(heard->count < HEARD);
    heard->notes[heard->count].severity = note->severity;
    snprintf(heard->notes[heard->count].path, sizeof heard->notes[0].path, "%s", note->path ? note->path : "(none)");
    snprintf(heard->notes[heard->count].line, sizeof heard->notes[0].line, "%s", note->line);
    heard->count++;
}

struct wanted {
    conus_severity severity;
    const char *file; /* in the folder */
    const char *part; /* of the line */
};

/* Asserts that the wanted notes were heard, in that order. */
static void assert_heard(const struct heard *heard, const struct wanted *wanted, size_t count)
{
    for (size_t i = 0; i < heard->count; i++) {
        print_message("%d %s: %s\n", (int)heard->notes[i].severity, heard->notes[i].path, heard->notes[i].line);
    }
    assert_int_equal(heard->count, count);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(heard->notes[i].severity, wanted[i].severity);
        assert_string_equal(heard->notes[i].path, test_in(wanted[i].file));
        assert_non_null(strstr(heard->notes[i].line, wanted[i].part));
    }
}

/* Asserts that the atlas has the notes that were heard, each line as often. */
static void assert_kept(const struct heard *heard, const conus_atlas *atlas)
{
    assert_int_equal(conus_atlas_note_count(atlas), heard->count);
    for (size_t i = 0; i < heard->count; i++) {
        size_t said = 0, kept = 0;
        for (size_t k = 0; k < heard->count; k++) {
            said += strcmp(heard->notes[k].line, heard->notes[i].line) == 0;
            kept += strcmp(conus_atlas_note(atlas, k), heard->notes[i].line) == 0;
        }
        assert_int_equal(said, kept);
    }
}

static void write_text(const char *name, const char *text)
{
    assert_ok(conus_write_file(test_in(name), text, strlen(text)));
}

/* A volume of four voxels, and `more` bytes behind them; without a transform unless it is `placed`. */
static void write_volume(const char *name, int datatype, const double values[4], bool placed, size_t more)
{
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, datatype, (int64_t[]){4, 1, 1});
    if (!placed) {
        nifti_set(&builder, "sform_code", 0, 0);
    }
    for (int i = 0; i < 4 && values; i++) {
        nifti_voxel(&builder, values[i]);
    }
    buffer_append(&builder.bytes, "more bytes", more);
    assert_ok(buffer_status(&builder.bytes));
    assert_ok(conus_write_file(test_in(name), builder.bytes.data, builder.bytes.size));
    buffer_finish(&builder.bytes);
}

/* Writes a surface of one open triangle. */
static void write_triangle(const char *name)
{
    conus_atlas *atlas = NULL;
    const conus_mesh_options options = {.format = CONUS_MESH_GIFTI};
    const conus_label area = {.number = 1, .name = "Flat"};
    char from[300];
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    assert_ok(conus_atlas_add_surface(atlas, &area, (float[]){0, 0, 0, 9, 0, 0, 0, 9, 0}, 3, (uint32_t[]){0, 1, 2}, 1));
    assert_ok(conus_atlas_write_meshes(atlas, test_in(""), &options));
    conus_atlas_destroy(atlas);
    snprintf(from, sizeof from, "%s", test_in("1_Flat.gii"));
    assert_int_equal(rename(from, test_in(name)), 0);
}

enum { UINT8 = 2, FLOAT32 = 16 };

/* Writes files that give notes; returns how many. */
static int write_files(void **state)
{
    (void)state;
    static const double labels[4] = {1, 2, 2, 9}, chances[4] = {0, 0.25, 0.5, 1}, holed[4] = {3, NAN, 4, 5};
    test_folder("log");
    write_volume("v.nii", UINT8, labels, false, 5);
    write_text("v.txt", "1 A\n1 B\n5 E\n");
    write_volume("cut.nii", UINT8, NULL, false, 3);
    write_volume("p.nii", FLOAT32, chances, true, 0);
    write_volume("c.nii", FLOAT32, holed, true, 0);
    write_triangle("a.gii");
    write_triangle("b.gii");
    write_text("bad.gii", "<GIFTI Version=\"1.0\"></GIFTI>");
    return 0;
}

static const struct wanted of_volume[] = {
    {CONUS_SEVERITY_WARNING, "v.nii", "neither sform nor qform is set"},
    {CONUS_SEVERITY_NOTE, "v.nii", "5 bytes after the last voxel were ignored"},
    {CONUS_SEVERITY_WARNING, "v.nii", "label 1 is named twice"},
    {CONUS_SEVERITY_WARNING, "v.nii", "does not name: 2 (2, 9)"},
    {CONUS_SEVERITY_NOTE, "v.nii", "without a voxel: 1 (5)"},
};

enum { OF_VOLUME = sizeof of_volume / sizeof of_volume[0] };

static void a_volume(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    const conus_load_options options = {.log = hear, .log_user = &heard};
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), &options));
    assert_heard(&heard, of_volume, OF_VOLUME);
    assert_kept(&heard, atlas);
    /* The callback is used during the load only. */
    assert_null(atlas->notes.sink);
    assert_ok(conus_atlas_add_pathway(atlas, test_in("p.nii"), NULL));
    assert_int_equal(heard.count, OF_VOLUME);
    assert_int_equal(conus_atlas_note_count(atlas), OF_VOLUME + 1);
    conus_atlas_destroy(atlas);
}

static void a_load_that_fails(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    conus_load_options options = {.log = hear, .log_user = &heard, .labels = "no-such-table.txt"};
    assert_fails(conus_atlas_load(&atlas, test_in("v.nii"), &options), CONUS_ERROR_IO);
    assert_heard(&heard, of_volume, 2);
    assert_non_null(strstr(conus_message(), "no-such-table.txt"));

    heard.count = 0;
    options.labels = NULL; /* the header is noted before its voxels are missed */
    assert_fails(conus_atlas_load(&atlas, test_in("cut.nii"), &options), CONUS_ERROR_DATA);
    assert_heard(&heard, &(const struct wanted){CONUS_SEVERITY_WARNING, "cut.nii", "neither sform nor qform"}, 1);
    assert_non_null(strstr(conus_message(), "the file has "));
    assert_null(atlas);
}

static conus_status load_manifest(conus_atlas **atlas, const char *keys, conus_log log, void *user)
{
    struct buffer text = {0};
    const conus_load_options options = {.log = log, .log_user = user};
    buffer_format(&text, "{\"conus_atlas\": 1, %s}", keys);
    assert_ok(buffer_status(&text));
    assert_ok(conus_write_file(test_in("s.atlas.json"), text.data, text.size));
    buffer_finish(&text);
    return conus_atlas_load(atlas, test_in("s.atlas.json"), &options);
}

static const char scene[] = "\"parcellation\": \"v.nii\", \"areas\": [{\"file\": \"a.gii\", \"label\": 20},"
                            "{\"file\": \"b.gii\", \"label\": 21}], \"pathways\": [{\"file\": \"p.nii\", \"name\":"
                            "\"P\"}], \"context\": \"c.nii\"";

static const struct wanted behind_volume[] = {
    {CONUS_SEVERITY_NOTE, "a.gii", "2 surfaces (a.gii, b.gii): the surface does not say in which space it is"},
    {CONUS_SEVERITY_NOTE, "a.gii", "2 surfaces (a.gii, b.gii): the surface is not closed"},
    {CONUS_SEVERITY_NOTE, "p.nii", "pathway P: values up to 1, taken as probabilities"},
    {CONUS_SEVERITY_NOTE, "c.nii", "1 voxels are not finite numbers"},
    {CONUS_SEVERITY_WARNING, "c.nii", "lies beside the box around the areas"},
};

enum { OF_SCENE = OF_VOLUME + sizeof behind_volume / sizeof behind_volume[0] };

static void a_scene_names_the_file_of_each_note(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    struct wanted wanted[OF_SCENE];
    memcpy(wanted, of_volume, sizeof of_volume);
    memcpy(wanted + OF_VOLUME, behind_volume, sizeof behind_volume);
    assert_ok(load_manifest(&atlas, scene, hear, &heard));
    assert_heard(&heard, wanted, OF_SCENE);
    assert_kept(&heard, atlas);
    conus_atlas_destroy(atlas);
}

/* The image has two pathways, but its own note is given once. */
static void an_fsl_atlas(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    const struct wanted wanted[] = {
        {CONUS_SEVERITY_WARNING, "f.nii", "neither sform nor qform is set"},
        {CONUS_SEVERITY_NOTE, "f.nii", "pathway One: 0 and one other value, taken as a mask"},
        {CONUS_SEVERITY_NOTE, "f.nii", "pathway Two: 0 and one other value, taken as a mask"},
        {CONUS_SEVERITY_NOTE, "f.nii", "pathways of f.xml: 2, from f.nii"},
    };
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, FLOAT32, (int64_t[]){2, 1, 1});
    nifti_set(&builder, "sform_code", 0, 0);
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, 2);
    for (int i = 0; i < 4; i++) {
        nifti_voxel(&builder, i % 2);
    }
    assert_ok(conus_write_file(test_in("f.nii"), builder.bytes.data, builder.bytes.size));
    buffer_finish(&builder.bytes);
    write_text("f.xml", "<atlas><header><type>Probabilistic</type><images><imagefile>/f</imagefile></images></header>"
                        "<data><label index=\"0\">One</label><label index=\"1\">Two</label></data></atlas>");
    assert_ok(load_manifest(&atlas, "\"pathways\": [{\"fsl\": \"f.xml\"}]", hear, &heard));
    assert_heard(&heard, wanted, 4);
    assert_kept(&heard, atlas);
    conus_atlas_destroy(atlas);
}

static void a_scene_that_fails(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    const struct wanted of_surface[] = {
        {CONUS_SEVERITY_NOTE, "a.gii", "a.gii: the surface does not say in which space it is"},
        {CONUS_SEVERITY_NOTE, "a.gii", "a.gii: the surface is not closed"},
    };
    assert_fails(
        load_manifest(&atlas, "\"areas\": [{\"file\": \"a.gii\", \"label\": 1}, {\"file\": \"bad.gii\", \"label\": 2}]",
                      hear, &heard),
        CONUS_ERROR_DATA);
    assert_heard(&heard, of_surface, 2);

    heard.count = 0;
    assert_fails(
        load_manifest(&atlas, "\"parcellation\": \"v.nii\", \"pathways\": [{\"file\": \"none.nii\"}]", hear, &heard),
        CONUS_ERROR_IO);
    assert_heard(&heard, of_volume, OF_VOLUME);
    assert_null(atlas);
}

static void pathways_and_contexts(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    const conus_pathway_options pathway = {.log = hear, .log_user = &heard};
    const conus_context_options context = {.log = hear, .log_user = &heard};
    const struct wanted holed = {CONUS_SEVERITY_NOTE, "c.nii", "1 voxels are not finite numbers"};
    const struct wanted scaled = {CONUS_SEVERITY_NOTE, "p.nii", "pathway p: values up to 1, taken as probabilities"};
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    assert_ok(conus_atlas_set_context(atlas, test_in("c.nii"), &context));
    assert_heard(&heard, &holed, 1);
    heard.count = 0; /* its values are below the default threshold, which is an error */
    assert_fails(conus_atlas_add_pathway(atlas, test_in("c.nii"), &pathway), CONUS_ERROR_DATA);
    assert_heard(&heard, &holed, 1);
    heard.count = 0;
    assert_ok(conus_atlas_add_pathway(atlas, test_in("p.nii"), &pathway));
    assert_heard(&heard, &scaled, 1);
    assert_int_equal(conus_atlas_note_count(atlas), 2);
    conus_atlas_destroy(atlas);
}

static void arrays(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    static const uint8_t labels[4] = {1, 2, 2, 9};
    static const float values[4] = {NAN, 1, 0, 0};
    const conus_label names[] = {{.number = 1, .name = "A"}, {.number = 2, .name = "B"}};
    const conus_create_options options = {.log = hear, .log_user = &heard};
    const conus_pathway_options pathway = {.threshold = 0.5, .log = hear, .log_user = &heard};
    conus_voxels voxels = {.data = labels, .type = CONUS_SCALAR_UINT8, .dim = {4, 1, 1}, .name = "mine"};
    for (int i = 0; i < 16; i += 5) {
        voxels.world_from_voxel[i] = 1;
    }
    assert_ok(conus_atlas_create(&atlas, &voxels, names, 2, &options));
    assert_null(atlas->notes.sink);
    assert_int_equal(heard.count, 1);
    assert_string_equal(heard.notes[0].path, "mine");
    assert_non_null(strstr(heard.notes[0].line, "does not name: 1 (9)"));
    voxels.data = values;
    voxels.type = CONUS_SCALAR_FLOAT32;
    voxels.name = NULL;
    assert_ok(conus_atlas_add_pathway_voxels(atlas, &voxels, &pathway));
    assert_int_equal(heard.count, 2);
    assert_string_equal(heard.notes[1].path, "array");
    assert_non_null(strstr(heard.notes[1].line, "1 voxels are not finite numbers"));
    assert_kept(&heard, atlas);
    conus_atlas_destroy(atlas);
}

static void objects_of_one_file_say_it_once(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    const conus_load_options options = {.log = hear, .log_user = &heard};
    const struct wanted wanted[] = {
        {CONUS_SEVERITY_NOTE, "two.obj", "the surface is not closed"},
        {CONUS_SEVERITY_NOTE, "two.obj",
         "does not state its space; RAS was taken; ',space=lps' behind FILE says LPS, as AFNI writes it, "
         "',space=IMAGE' the mm of FSL's IMAGE"},
    };
    write_text("two.obj", "o A\nv 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\no B\nv 0 0 5\nv 9 0 5\nv 0 9 5\nf 4 5 6\n");
    assert_ok(conus_atlas_load(&atlas, test_in("two.obj"), &options));
    assert_int_equal(conus_atlas_object_count(atlas), 2);
    assert_heard(&heard, wanted, 2);
    assert_kept(&heard, atlas);
    conus_atlas_destroy(atlas);
}

/* An attached atlas has the notes of the packed one, and may get more. */
static void an_attached_atlas(void **state)
{
    (void)state;
    static _Alignas(64) unsigned char memory[1 << 16];
    conus_atlas *atlas = NULL, *attached = NULL;
    struct heard heard = {0};
    const conus_load_options options = {.log = hear, .log_user = &heard};
    const conus_pathway_options pathway = {.log = hear, .log_user = &heard};
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), &options));
    assert_true(conus_atlas_packed_size(atlas) <= sizeof memory);
    assert_ok(conus_atlas_pack(memory, sizeof memory, atlas));
    conus_atlas_destroy(atlas);
    assert_ok(conus_atlas_attach(&attached, memory, sizeof memory));
    assert_kept(&heard, attached);
    assert_ok(conus_atlas_add_pathway(attached, test_in("p.nii"), &pathway));
    assert_int_equal(heard.count, OF_VOLUME + 1);
    assert_kept(&heard, attached);
    conus_atlas_destroy(attached);
}

/* Without a callback notes are silent, and so they are for a caller with an older, smaller struct. */
static void without_a_callback(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    conus_load_options options = {.log_user = &heard};
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), &options));
    conus_atlas_destroy(atlas);
    options.log = hear;
    options.struct_size = offsetof(conus_load_options, log);
    assert_ok(conus_atlas_load(&atlas, test_in("v.nii"), &options));
    conus_atlas_destroy(atlas);
    assert_int_equal(heard.count, 0);
}

static conus_status load_scene(void *user)
{
    conus_atlas *atlas = NULL;
    struct heard *heard = user;
    heard->count = 0;
    const conus_load_options options = {.log = hear, .log_user = heard};
    conus_status status = conus_atlas_load(&atlas, test_in("s.atlas.json"), &options);
    assert_true(status || conus_atlas_note_count(atlas) == heard->count);
    conus_atlas_destroy(atlas);
    return status;
}

/* Notes that need all files to have been read are about the atlas that was asked for. */
static void notes_about_all_areas(void **state)
{
    (void)state;
    struct nifti_builder builder;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    const conus_load_options options = {.log = hear, .log_user = &heard};
    const struct wanted wanted[] = {{CONUS_SEVERITY_WARNING, "sides.nii", "3 of 3 pairs of a left and a right area"}};
    nifti_begin(&builder, 1, false, UINT8, (int64_t[]){6, 1, 1});
    for (int i = 1; i <= 6; i++) {
        nifti_voxel(&builder, i);
    }
    assert_ok(conus_write_file(test_in("sides.nii"), builder.bytes.data, builder.bytes.size));
    buffer_finish(&builder.bytes);
    write_text("sides.txt", "1 A_R\n2 B_R\n3 C_R\n4 A_L\n5 B_L\n6 C_L\n");
    assert_ok(conus_atlas_load(&atlas, test_in("sides.nii"), &options));
    assert_heard(&heard, wanted, 1);
    assert_kept(&heard, atlas);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {0};
    assert_ok(load_manifest(&atlas, scene, NULL, NULL));
    conus_atlas_destroy(atlas);
    test_every_allocation(load_scene, &heard);
    assert_true(test_every_primitive(load_scene, &heard) > 5);
    assert_int_equal(heard.count, OF_SCENE);
}

TEST_GROUP(load_log)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_volume),
        cmocka_unit_test(a_load_that_fails),
        cmocka_unit_test(a_scene_names_the_file_of_each_note),
        cmocka_unit_test(an_fsl_atlas),
        cmocka_unit_test(a_scene_that_fails),
        cmocka_unit_test(pathways_and_contexts),
        cmocka_unit_test(arrays),
        cmocka_unit_test(objects_of_one_file_say_it_once),
        cmocka_unit_test(an_attached_atlas),
        cmocka_unit_test(without_a_callback),
        cmocka_unit_test(notes_about_all_areas),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, write_files, NULL);
}
