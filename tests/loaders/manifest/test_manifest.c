/* SPDX-License-Identifier: BSD-3-Clause */
/* The manifest's keys, and progress of a load. Faults and scenes: tests/corpus/manifest/ and scene/. */
#include "conus/own.h"
#include "loaders/manifest/manifest.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char whole[] =
    "{\n"
    "  \"conus_atlas\": 1,\n"
    "  \"comment\": \"everything that the schema has\",\n"
    "  \"allow_outside\": true,\n"
    "  \"parcellation\": {\"file\": \"/data/aal.nii\", \"volume\": 2, \"labels\": \"../aal.txt\", "
    "\"label_offset\": 3, \"hemisphere\": \"B\", \"comment\": \"c\"},\n"
    "  \"areas\": [\"1.gii\", {\"file\": \"b.ply\", \"label\": 7, \"name\": \"B\", \"abbreviation\": \"b\", \"color\":"
    "    \"#0a0B0c\", \"parent\": 9, \"hemisphere\": \"R\", \"comment\": \"c\"},\n"
    "    {\"files\": \"lh/*.gii\", \"labels\": \"lh.tsv\", \"label_offset\": 1000, \"hemisphere\": \"L\"},\n"
    "    {\"brainglobe\": \"mouse\", \"structures\": \"all\", \"scale\": 1, \"orientation\": \"ras\"}],\n"
    "  \"space\": \"lps\", \"prefer\": \"areas\",\n"
    "  \"tree\": [{\"label\": 9, \"name\": \"Nine\"}, {\"label\": 7, \"parent\": 9}],\n"
    "  \"threshold\": 0.3,\n"
    "  \"transform\": [{\"file\": \"a.mat\", \"from\": \"t1.nii\", \"to\": \"../mni.nii\", \"inverse\": true, "
    "\"comment\": \"c\"}, \"b.tfm\"],\n"
    "  \"pathways\": [\"fornix.nii.gz\",\n"
    "    {\"file\": \"tracts.nii.gz\", \"volume\": 1, \"name\": \"Cingulum\", \"threshold\": 12.5, \"moves\": true, "
    "\"comment\": \"c\"},\n"
    "    {\"file\": \"four.nii\", \"names\": [\"a\", \"b\"]},\n"
    "    {\"fsl\": \"JHU.xml\", \"file\": \"JHU/prob.nii.gz\"},\n"
    "    {\"file\": \"ct.nii.gz\", \"bands\": [{\"name\": \"Air\", \"high\": -200},\n"
    "      {\"name\": \"Fat\", \"low\": -200, \"high\": -50.5, \"comment\": \"c\"}, {\"name\": \"Bone\", \"low\": "
    "300}]}],\n"
    "  \"context\": {\"file\": \"t1.nii\", \"volume\": 0, \"transfer\": {\"file\": \"t1.tf\"}, \"blocks\": 80, "
    "\"moves\": true}\n"
    "}\n";

static const char several[] =
    "{\"conus_atlas\": 1, \"parcellations\": [\"lh.nii.gz\", {\"file\": \"rh.nii.gz\", \"hemisphere\": \"R\", "
    "\"label_offset\": 1000}, {\"file\": \"wm.tiff\", \"volume\": 1, \"labels\": \"wm.txt\", \"resolution\": "
    "[1, 2, 3], \"orientation\": \"asr\", \"comment\": \"c\"}]}\n";

static conus_status parse(struct text text)
{
    struct job job = {0};
    struct scene m;
    scene_read(&job, &m, text);
    return job_close(&job, NULL, NULL);
}

/* Item `index` of the kinds. */
static const struct scene_item *at(const struct scene *scene, unsigned kinds, size_t index)
{
    const struct scene_item *item = scene_next(scene, kinds, NULL);
    while (item && index--) {
        item = scene_next(scene, kinds, item);
    }
    assert_non_null(item);
    return item;
}

static void parcellations_are_kept_in_their_order(void **state)
{
    (void)state;
    struct job job = {0};
    struct scene m;
    scene_read(&job, &m, text_from(several));
    assert_true(job_ok(&job));
    assert_int_equal(scene_count(&m, ITEM_PARCELLATION), 3);
    assert_string_equal(at(&m, ITEM_PARCELLATION, 2)->list, "parcellations");
    assert_int_equal(at(&m, ITEM_PARCELLATION, 2)->index, 2);
    assert_string_equal(at(&m, ITEM_PARCELLATION, 0)->file, "lh.nii.gz");
    assert_int_equal(at(&m, ITEM_PARCELLATION, 0)->label.hemisphere, 0);
    assert_int_equal(at(&m, ITEM_PARCELLATION, 1)->label.hemisphere, 'R');
    assert_int_equal(at(&m, ITEM_PARCELLATION, 1)->label_offset, 1000);
    assert_int_equal(at(&m, ITEM_PARCELLATION, 2)->volume, 2);
    assert_string_equal(at(&m, ITEM_PARCELLATION, 2)->labels, "wm.txt");
    assert_near(at(&m, ITEM_PARCELLATION, 2)->resolution[2], 3, 0);
    assert_string_equal(at(&m, ITEM_PARCELLATION, 2)->orientation, "asr");
    job_end(&job);
}

static void every_key_of_areas_is_kept(void **state)
{
    (void)state;
    struct job job = {0};
    struct scene m;
    assert_true(manifest_is(text_from(whole)));
    scene_read(&job, &m, text_from(whole));
    assert_true(job_ok(&job));
    assert_true(m.allow_outside);
    assert_int_equal(scene_count(&m, ITEM_PARCELLATION), 1);
    assert_int_equal(at(&m, ITEM_PARCELLATION, 0)->index, JOB_ALONE);
    assert_string_equal(at(&m, ITEM_PARCELLATION, 0)->file, "/data/aal.nii");
    assert_int_equal(at(&m, ITEM_PARCELLATION, 0)->volume, 3);
    assert_string_equal(at(&m, ITEM_PARCELLATION, 0)->labels, "../aal.txt");
    assert_int_equal(at(&m, ITEM_PARCELLATION, 0)->label_offset, 3);
    assert_int_equal(at(&m, ITEM_PARCELLATION, 0)->label.hemisphere, 'B');
    assert_int_equal(scene_count(&m, ITEM_SURFACES), 4);
    assert_string_equal(at(&m, ITEM_SURFACES, 0)->file, "1.gii");
    assert_int_equal(at(&m, ITEM_SURFACES, 1)->label.number, 7);
    assert_string_equal(at(&m, ITEM_SURFACES, 1)->label.name, "B");
    assert_int_equal(at(&m, ITEM_SURFACES, 1)->label.rgb[1], 11);
    assert_int_equal(at(&m, ITEM_SURFACES, 1)->label.parent, 9);
    assert_int_equal(at(&m, ITEM_SURFACES, 1)->label.hemisphere, 'R');
    assert_string_equal(at(&m, ITEM_SURFACES, 2)->file, "lh/*.gii");
    assert_string_equal(at(&m, ITEM_SURFACES, 2)->labels, "lh.tsv");
    assert_int_equal(at(&m, ITEM_SURFACES, 2)->label_offset, 1000);
    assert_string_equal(at(&m, ITEM_SURFACES, 3)->file, "mouse");
    assert_true(at(&m, ITEM_SURFACES, 3)->all_structures);
    assert_near(at(&m, ITEM_SURFACES, 3)->scale, 1, 0);
    assert_string_equal(at(&m, ITEM_SURFACES, 3)->orientation, "ras");
    assert_int_equal(m.space, MESH_SPACE_LPS);
    assert_int_equal(m.prefer, SCENE_PREFER_AREAS);
    assert_int_equal(scene_count(&m, ITEM_NODE), 2);
    assert_string_equal(at(&m, ITEM_NODE, 0)->label.name, "Nine");
    job_end(&job);
}

static void every_key_of_pathways_transforms_and_context_is_kept(void **state)
{
    (void)state;
    struct job job = {0};
    struct scene m;
    scene_read(&job, &m, text_from(whole));
    assert_true(job_ok(&job));
    assert_near(m.threshold, 0.3, 0);
    assert_int_equal(scene_count(&m, ITEM_TRANSFORM), 2);
    assert_int_equal(at(&m, ITEM_TRANSFORM, 1)->index, 1);
    assert_string_equal(at(&m, ITEM_TRANSFORM, 0)->file, "a.mat");
    assert_string_equal(at(&m, ITEM_TRANSFORM, 0)->from, "t1.nii");
    assert_string_equal(at(&m, ITEM_TRANSFORM, 0)->to, "../mni.nii");
    assert_true(at(&m, ITEM_TRANSFORM, 0)->inverse && !at(&m, ITEM_TRANSFORM, 1)->inverse);
    assert_string_equal(at(&m, ITEM_TRANSFORM, 1)->file, "b.tfm");
    assert_true(at(&m, ITEM_PATHWAY, 1)->moves && !at(&m, ITEM_PATHWAY, 0)->moves && at(&m, ITEM_CONTEXT, 0)->moves);
    assert_int_equal(scene_count(&m, ITEM_PATHWAY), 5);
    assert_int_equal(at(&m, ITEM_PATHWAY, 4)->bands.count, 3);
    assert_string_equal(at(&m, ITEM_PATHWAY, 4)->bands.at[0].name, "Air");
    assert_true(at(&m, ITEM_PATHWAY, 4)->bands.at[0].low == -INFINITY &&
                at(&m, ITEM_PATHWAY, 4)->bands.at[0].high == -200);
    assert_true(at(&m, ITEM_PATHWAY, 4)->bands.at[1].low == -200 && at(&m, ITEM_PATHWAY, 4)->bands.at[1].high == -50.5);
    assert_true(at(&m, ITEM_PATHWAY, 4)->bands.at[2].low == 300 &&
                at(&m, ITEM_PATHWAY, 4)->bands.at[2].high == INFINITY);
    assert_string_equal(at(&m, ITEM_PATHWAY, 0)->file, "fornix.nii.gz");
    assert_int_equal(at(&m, ITEM_PATHWAY, 0)->volume, 0);
    assert_string_equal(at(&m, ITEM_PATHWAY, 1)->label.name, "Cingulum");
    assert_near(at(&m, ITEM_PATHWAY, 1)->threshold, 12.5, 0);
    assert_int_equal(at(&m, ITEM_PATHWAY, 2)->names.count, 2);
    assert_string_equal(at(&m, ITEM_PATHWAY, 2)->names.at[1], "b");
    assert_string_equal(at(&m, ITEM_PATHWAY, 3)->fsl, "JHU.xml");
    assert_string_equal(at(&m, ITEM_CONTEXT, 0)->file, "t1.nii");
    assert_int_equal(at(&m, ITEM_CONTEXT, 0)->volume, 1);
    assert_null(at(&m, ITEM_CONTEXT, 0)->transfer);
    assert_string_equal(at(&m, ITEM_CONTEXT, 0)->transfer_file, "t1.tf");
    assert_near(at(&m, ITEM_CONTEXT, 0)->blocks, 80, 0);
    job_end(&job);
}

/* A scene with every key: what is written is read as the same, and written as the same again. */
static void what_is_written_is_read_as_the_same(void **state)
{
    (void)state;
    static const char rest[] =
        "{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"p.nii\", \"volume\": 0, \"name\": \"P\", \"scale\": "
        "100}],"
        " \"template\": \"none\", \"ccf\": \"asl\", \"streamlines\": [{\"file\": \"s.trk\", \"name\": \"S\", "
        "\"radius\": 2,"
        " \"space\": \"lps\", \"moves\": true}], \"transform\": {\"file\": \"w.nii\", \"grid\": \"g.nii\", \"vectors\":"
        " \"absolute\", \"space\": \"ras\", \"transform\": 0}, \"context\": [{\"file\": \"a.nii\", \"transfer\": "
        "\"ct\"},"
        " {\"file\": \"a.obj\", \"opacity\": 0.5}]}";
    const char *texts[] = {whole, several, rest};
    const struct {
        const char *text;
        size_t count; /* in what is written of all */
    } keys[] = {{"\"file\"", 20},
                {"\"files\"", 1},
                {"\"brainglobe\"", 1},
                {"\"volume\"", 5},
                {"\"resolution\"", 1},
                {"\"orientation\"", 2},
                {"\"structures\"", 1},
                {"\"labels\"", 3},
                {"\"label\"", 3},
                {"\"label_offset\"", 3},
                {"\"parent\"", 2},
                {"\"fsl\"", 1},
                {"\"name\"", 8},
                {"\"abbreviation\"", 1},
                {"\"#0a0b0c\"", 1},
                {"\"hemisphere\"", 4},
                {"\"names\"", 1},
                {"\"threshold\"", 2},
                {"\"scale\"", 2},
                {"\"bands\"", 1},
                {"\"low\"", 2},
                {"\"high\"", 2},
                {"\"radius\"", 1},
                {"\"from\"", 1},
                {"\"to\"", 1},
                {"\"inverse\"", 1},
                {"\"grid\"", 1},
                {"\"vectors\"", 1},
                {"\"space\"", 3},
                {"\"transform\"", 3},
                {"\"transfer\"", 2},
                {"\"blocks\"", 1},
                {"\"opacity\"", 1},
                {"\"moves\"", 3},
                {"\"allow_outside\"", 1},
                {"\"parcellation\"", 1},
                {"\"parcellations\"", 1},
                {"\"template\"", 1},
                {"\"ccf\"", 1},
                {"\"prefer\"", 1},
                {"\"tree\"", 1},
                {"\"conus_atlas\"", 3}};
    size_t found[sizeof keys / sizeof keys[0]] = {0};
    for (size_t i = 0; i < 3; i++) {
        struct job job = {0};
        struct scene first;
        struct scene second;
        scene_read(&job, &first, text_from(texts[i]));
        const struct text written = scene_write(&job, &first);
        scene_read(&job, &second, written);
        const struct text again = scene_write(&job, &second);
        assert_string_equal(job.message, "");
        assert_string_equal(written.data, again.data);
        assert_int_equal(first.items.count, second.items.count);
        for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
            for (const char *c = written.data; (c = strstr(c, keys[k].text)); c++) {
                found[k]++;
            }
        }
        job_end(&job);
    }
    for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
        if (found[k] != keys[k].count) {
            fail_msg("%s: %zu, not %zu", keys[k].text, found[k], keys[k].count);
        }
    }
}

/* A name of Latin-1 cannot stand in JSON. */
static void names_that_are_no_utf8_are_not_written(void **state)
{
    (void)state;
    struct job job = {0};
    struct scene scene = {0};
    scene_add(&job, &scene, &(struct scene_item){.kind = ITEM_PARCELLATION, .file = "caf\xe9.nii"});
    (void)scene_write(&job, &scene);
    assert_int_equal(job.status, CONUS_ERROR_DATA);
    assert_non_null(strstr(job.message, "is no UTF-8"));
    job_end(&job);
}

/* The rest of the schema: tests/corpus/manifest. These two are not read as manifests elsewhere. */
static void what_is_no_manifest_is_refused(void **state)
{
    (void)state;
    assert_fails(parse(text_from("[]")), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "content: found a list, an object is needed");
    assert_fails(parse(text_from("{\"pathways\": [\"a\"]}")), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "conus_atlas is missing");
}

static const char *write_manifest(const char *text)
{
    const char *path = test_in("test.atlas.json");
    assert_ok(conus_write_file(path, text, strlen(text)));
    return path;
}

/* Two atlases of shapes; a labelled ball of ones serves as a pathway, too. */
static int write_volumes(void **state)
{
    (void)state;
    test_folder("scene");
    conus_status status = conus_phantom_write("slabs", test_in(""), &(conus_phantom_options){.size = 16});
    return status || conus_phantom_write("sphere", test_in(""), &(conus_phantom_options){.size = 16});
}

/* Calls of the progress callback during a load. */
struct heard {
    char files[16][64];
    size_t count, done, total;
    size_t cancel_at; /* files; 0 = never */
};

static bool hear(void *user, const char *path, size_t done, size_t total)
{
    struct heard *heard = user;
    assert_true(heard->count < 16);
    assert_true(done >= heard->done && done < total);
    snprintf(heard->files[heard->count++], sizeof heard->files[0], "%s", strrchr(path, '/') + 1);
    heard->done = done;
    heard->total = total;
    return heard->count != heard->cancel_at;
}

static void progress_is_reported_file_by_file(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct heard heard = {.count = 0};
    const conus_load_options options = {.progress = hear, .progress_user = &heard};
    const char *path =
        write_manifest("{\"conus_atlas\": 1, \"parcellation\": \"slabs.nii.gz\","
                       "\"pathways\": [{\"file\": \"sphere.nii.gz\", \"name\": \"Ball\"}, \"sphere.nii.gz\"],"
                       "\"context\": \"slabs.nii.gz\"}");
    assert_ok(conus_atlas_load(&atlas, path, &options));
    assert_int_equal(heard.count, 4);
    assert_int_equal(heard.total, 4);
    assert_int_equal(heard.done, 3);
    assert_string_equal(heard.files[0], "slabs.nii.gz");
    assert_string_equal(heard.files[1], "sphere.nii.gz");
    conus_atlas_destroy(atlas);
    heard = (struct heard){.count = 0};
    assert_ok(conus_atlas_load(&atlas, test_in("sphere.nii.gz"), &options));
    assert_int_equal(heard.count, 1);
    assert_int_equal(heard.total, 1);
    conus_atlas_destroy(atlas);
    heard = (struct heard){.count = 0};
    assert_ok(conus_phantom_write("brain", test_in("brain"), NULL));
    assert_ok(
        conus_atlas_load(&atlas, test_in("brain/brain.atlas.json"), &options)); /* surfaces, a pathway, a context */
    assert_int_equal(heard.count, 13);
    assert_int_equal(heard.done + 1, heard.total);
    conus_atlas_destroy(atlas);
}

/* A load can be cancelled before each file: a parcellation, surfaces, a pathway, a context. The output stays
 * untouched. */
static void a_load_can_be_cancelled_at_each_file(void **state)
{
    (void)state;
    assert_ok(conus_phantom_write("brain", test_in("brain"), NULL));
    for (size_t at = 1; at <= 13; at++) {
        conus_atlas *atlas = NULL;
        struct heard heard = {.cancel_at = at};
        const conus_load_options options = {.progress = hear, .progress_user = &heard};
        assert_fails(conus_atlas_load(&atlas, test_in("brain/brain.atlas.json"), &options), CONUS_ERROR_CANCELLED);
        assert_null(atlas);
        assert_int_equal(heard.count, at);
        assert_non_null(strstr(conus_message(), heard.files[at - 1]));
    }
    conus_atlas *atlas = NULL;
    struct heard heard = {.cancel_at = 1};
    const conus_load_options options = {.progress = hear, .progress_user = &heard};
    assert_fails(conus_atlas_load(&atlas, test_in("sphere.nii.gz"), &options), CONUS_ERROR_CANCELLED);
    assert_null(atlas);
}

/* FSL's thalamic connectivity: seven volumes of percent. */
static void an_fsl_atlas_gives_one_pathway_per_label(void **state)
{
    (void)state;
    char text[1024];
    conus_atlas *atlas = NULL;
    const char *xml = test_shared("prob/fsl/atlases/Thalamus.xml");
    snprintf(text, sizeof text, "{\"conus_atlas\": 1, \"allow_outside\": true, \"pathways\": [{\"fsl\": \"%s\"}]}",
             xml);
    assert_ok(conus_atlas_load(&atlas, write_manifest(text), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 7);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Primary motor");
    assert_string_equal(conus_atlas_object(atlas, 7)->name, "Temporal");
    assert_near(conus_atlas_volume(atlas, 6)->threshold, 25, 0);
    assert_int_equal(conus_atlas_volume(atlas, 6)->volume, 6);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(manifest)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_of_areas_is_kept),
        cmocka_unit_test(every_key_of_pathways_transforms_and_context_is_kept),
        cmocka_unit_test(parcellations_are_kept_in_their_order),
        cmocka_unit_test(what_is_written_is_read_as_the_same),
        cmocka_unit_test(names_that_are_no_utf8_are_not_written),
        cmocka_unit_test(what_is_no_manifest_is_refused),
        cmocka_unit_test(progress_is_reported_file_by_file),
        cmocka_unit_test(a_load_can_be_cancelled_at_each_file),
        cmocka_unit_test(an_fsl_atlas_gives_one_pathway_per_label),
    };
    return cmocka_run_group_tests(tests, write_volumes, NULL);
}
