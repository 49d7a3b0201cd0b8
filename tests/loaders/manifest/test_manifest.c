/* SPDX-License-Identifier: BSD-3-Clause */
/* The manifest's parser, and loading scenes. */
#include "base/files/file.h"
#include "builders/nifti_builder.h"
#include "conus/file.h"
#include "conus/phantom.h"
#include "loaders/manifest/manifest.h"
#include "loaders/volumes/volume_header.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

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
    struct manifest m;
    manifest_parse(&job, &m, text);
    return job_close(&job, NULL, NULL);
}

static void parcellations_are_kept_in_their_order(void **state)
{
    (void)state;
    struct job job = {0};
    struct manifest m;
    manifest_parse(&job, &m, text_from(several));
    assert_true(job_ok(&job));
    assert_int_equal(m.parcellations.count, 3);
    assert_false(m.single);
    assert_string_equal(m.parcellations.at[0].source.file, "lh.nii.gz");
    assert_int_equal(m.parcellations.at[0].hemisphere, 0);
    assert_int_equal(m.parcellations.at[1].hemisphere, 'R');
    assert_int_equal(m.parcellations.at[1].label_offset, 1000);
    assert_int_equal(m.parcellations.at[2].source.volume, 1);
    assert_string_equal(m.parcellations.at[2].labels, "wm.txt");
    assert_near(m.parcellations.at[2].source.resolution[2], 3, 0);
    assert_string_equal(m.parcellations.at[2].source.orientation, "asr");
    job_end(&job);
}

static void every_key_of_areas_is_kept(void **state)
{
    (void)state;
    struct job job = {0};
    struct manifest m;
    assert_true(manifest_is(text_from(whole)));
    manifest_parse(&job, &m, text_from(whole));
    assert_true(job_ok(&job));
    assert_true(m.allow_outside);
    assert_int_equal(m.parcellations.count, 1);
    assert_true(m.single);
    assert_string_equal(m.parcellations.at[0].source.file, "/data/aal.nii");
    assert_true(m.parcellations.at[0].source.chosen);
    assert_int_equal(m.parcellations.at[0].source.volume, 2);
    assert_string_equal(m.parcellations.at[0].labels, "../aal.txt");
    assert_int_equal(m.parcellations.at[0].label_offset, 3);
    assert_int_equal(m.parcellations.at[0].hemisphere, 'B');
    assert_int_equal(m.areas.count, 4);
    assert_string_equal(m.areas.at[0].file, "1.gii");
    assert_true(m.areas.at[1].has_label);
    assert_int_equal(m.areas.at[1].label.number, 7);
    assert_string_equal(m.areas.at[1].label.name, "B");
    assert_int_equal(m.areas.at[1].label.rgb[1], 11);
    assert_int_equal(m.areas.at[1].label.parent, 9);
    assert_int_equal(m.areas.at[1].label.hemisphere, 'R');
    assert_string_equal(m.areas.at[2].files, "lh/*.gii");
    assert_string_equal(m.areas.at[2].labels, "lh.tsv");
    assert_int_equal(m.areas.at[2].label_offset, 1000);
    assert_string_equal(m.areas.at[3].brainglobe, "mouse");
    assert_true(m.areas.at[3].all_structures);
    assert_near(m.areas.at[3].scale, 1, 0);
    assert_string_equal(m.areas.at[3].orientation, "ras");
    assert_int_equal(m.space, MESH_SPACE_LPS);
    assert_int_equal(m.prefer, MANIFEST_PREFER_AREAS);
    assert_int_equal(m.tree.count, 2);
    assert_string_equal(m.tree.at[0].name, "Nine");
    job_end(&job);
}

static void every_key_of_pathways_transforms_and_context_is_kept(void **state)
{
    (void)state;
    struct job job = {0};
    struct manifest m;
    manifest_parse(&job, &m, text_from(whole));
    assert_true(job_ok(&job));
    assert_near(m.threshold, 0.3, 0);
    assert_int_equal(m.transforms.count, 2);
    assert_false(m.single_transform);
    assert_string_equal(m.transforms.at[0].file, "a.mat");
    assert_string_equal(m.transforms.at[0].from, "t1.nii");
    assert_string_equal(m.transforms.at[0].to, "../mni.nii");
    assert_true(m.transforms.at[0].inverse && !m.transforms.at[1].inverse);
    assert_string_equal(m.transforms.at[1].file, "b.tfm");
    assert_true(m.pathways.at[1].moves && !m.pathways.at[0].moves && m.contexts.at[0].moves);
    assert_int_equal(m.pathways.count, 5);
    assert_int_equal(m.pathways.at[4].bands.count, 3);
    assert_string_equal(m.pathways.at[4].bands.at[0].name, "Air");
    assert_true(m.pathways.at[4].bands.at[0].low == -INFINITY && m.pathways.at[4].bands.at[0].high == -200);
    assert_true(m.pathways.at[4].bands.at[1].low == -200 && m.pathways.at[4].bands.at[1].high == -50.5);
    assert_true(m.pathways.at[4].bands.at[2].low == 300 && m.pathways.at[4].bands.at[2].high == INFINITY);
    assert_string_equal(m.pathways.at[0].source.file, "fornix.nii.gz");
    assert_false(m.pathways.at[0].source.chosen);
    assert_string_equal(m.pathways.at[1].name, "Cingulum");
    assert_near(m.pathways.at[1].threshold, 12.5, 0);
    assert_int_equal(m.pathways.at[2].names.count, 2);
    assert_string_equal(m.pathways.at[2].names.at[1], "b");
    assert_string_equal(m.pathways.at[3].fsl, "JHU.xml");
    assert_string_equal(m.contexts.at[0].source.file, "t1.nii");
    assert_true(m.contexts.at[0].source.chosen && m.contexts.at[0].transfer_is_file);
    assert_string_equal(m.contexts.at[0].transfer, "t1.tf");
    assert_near(m.contexts.at[0].blocks, 80, 0);
    job_end(&job);
}

static const struct {
    const char *text, *message;
} refused[] = {
    {"{\"conus_atlas\": 2}", "conus_atlas: found 2, 1, the version of this format, is needed"},
    {"[]", "content: found a list, an object is needed"},
    {"{\"conus_atlas\": 1}",
     "nothing to select: parcellation, areas, probabilities, pathways or streamlines is needed"},
    {"{\"pathways\": [\"a\"]}", "conus_atlas is missing"},
    {"{\"conus_atlas\": 1,\n \"pathways\": [,]}", "line 2, column 15: unexpected token near ','"},
    {"{\"conus_atlas\": 1, \"conus_atlas\": 1}", "line 1, column 32: duplicate object key near '\"conus_atlas\"'"},
    {"{\"conus_atlas\": 1, \"pathway\": []}",
     "pathway: unknown key, allowed are conus_atlas, comment, "
     "references, allow_outside, parcellation, parcellations, areas, space, ccf, prefer, tree, "
     "probabilities, pathways, streamlines, threshold, transform, context"},
    {"{\"conus_atlas\": 1, \"parcellations\": []}",
     "nothing to select: parcellation, areas, probabilities, pathways or streamlines is needed"},
    {"{\"conus_atlas\": 1, \"parcellations\": \"a\"}", "parcellations: found \"a\", a list is needed"},
    {"{\"conus_atlas\": 1, \"parcellations\": [\"a\"], \"parcellation\": \"a\"}",
     "has parcellation and parcellations, one of them is allowed"},
    {"{\"conus_atlas\": 1, \"parcellations\": [{\"file\": \"a\", \"hemisphere\": \"l\"}]}",
     "parcellations[0].hemisphere: found \"l\", \"L\" or \"R\" or \"B\" is needed"},
    {"{\"conus_atlas\": 1, \"parcellations\": [\"a\", {\"labels\": \"b\"}]}", "parcellations[1].file is missing"},
    {"{\"conus_atlas\": 1, \"parcellations\": [{\"file\": \"a\", \"label_offset\": -1}]}",
     "parcellations[0].label_offset: found -1, a whole number from 0 to 4294967295 is needed"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"name\": \"a\"}]}", "areas[0]: file, files or brainglobe is missing"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"files\": \"a\", \"label\": 1}]}",
     "areas[0].label: unknown key, allowed are files, labels, label_offset, parent, hemisphere, comment"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"file\": \"a\", \"label\": 0}]}",
     "areas[0].label: found 0, a whole number from 1 to 4294967295 is needed"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"file\": \"a\", \"color\": \"red\"}]}",
     "areas[0].color: found \"red\", \"#rrggbb\" is needed"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"file\": \"a\", \"hemisphere\": \"left\"}]}",
     "areas[0].hemisphere: found \"left\", \"L\" or \"R\" or \"B\" is needed"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"file\": \"a\", \"vertex_labels\": \"b\", \"name\": \"x\"}]}",
     "areas[0]: has vertex_labels for several areas and label, name, abbreviation or color of one"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"file\": \"a\", \"label_offset\": 5}]}",
     "areas[0].label_offset: without vertex_labels, give label"},
    {"{\"conus_atlas\": 1, \"areas\": [{\"brainglobe\": \"../a\"}]}",
     "areas[0].brainglobe: found \"../a\", a path inside the manifest's folder (or \"allow_outside\": true) is "
     "needed"},
    {"{\"conus_atlas\": 1, \"space\": \"mni\"}", "space: found \"mni\", \"ras\" or \"lps\" is needed"},
    {"{\"conus_atlas\": 1, \"tree\": [{\"parent\": 4}]}", "tree[0].label is missing"},
    {"{\"conus_atlas\": 1, \"pathways\": \"a\"}", "pathways: found \"a\", a list is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [1.5]}", "pathways[0]: found 1.5, a path or an object is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"treshold\": 1}]}",
     "pathways[0].treshold: unknown key, allowed are file, volume, resolution, orientation, fsl, name, names, "
     "threshold, scale, bands, moves, comment"},
    {"{\"conus_atlas\": 1, \"pathways\": [\"a\", {\"name\": \"x\"}]}", "pathways[1]: file or fsl is missing"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"threshold\": -1}]}",
     "pathways[0].threshold: found -1, a number above 0 is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"threshold\": \"0.5\"}]}",
     "pathways[0].threshold: found \"0.5\", a number above 0 is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"names\": []}]}",
     "pathways[0].names: found a list, a list of names, one per volume, is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"names\": [\"x\", null]}]}",
     "pathways[0].names[1]: found null, a text of one line that is not empty is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"names\": [\"x\"], \"name\": \"y\"}]}",
     "pathways[0]: has name for one pathway and names for several, one of them is allowed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"fsl\": \"a\", \"volume\": 1}]}",
     "pathways[0]: has volume for one pathway and fsl for several, one of them is allowed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"bands\": []}]}",
     "pathways[0].bands: found a list, a list of bands is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"bands\": [{\"low\": 1}]}]}",
     "pathways[0].bands[0].name is missing"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"bands\": [{\"name\": \"A\", \"low\": \"1\"}]}]}",
     "pathways[0].bands[0].low: found \"1\", a number is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"bands\": [{\"name\": \"A\"}], \"threshold\": 1}]}",
     "pathways[0]: has bands and threshold, one of them is allowed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"a\", \"bands\": [{\"name\": \"A\"}], \"name\": \"B\"}]}",
     "pathways[0]: has bands and name, one of them is allowed"},
    {"{\"conus_atlas\": 1, \"parcellation\": {\"labels\": \"x\"}}", "parcellation.file is missing"},
    {"{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"a\", \"volume\": 0.5}}",
     "parcellation.volume: found 0.5, a whole number from 0 is needed"},
    {"{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"a\", \"resolution\": 25}}",
     "parcellation.resolution: found 25, a list of three numbers, in micrometres, is needed"},
    {"{\"conus_atlas\": 1, \"context\": {\"file\": \"a\", \"resolution\": [25, 25, 0]}}",
     "context.resolution[2]: found 0, a number above 0 is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [{\"fsl\": \"a\", \"resolution\": [25, 25, 25]}]}",
     "pathways[0]: has resolution for one pathway and fsl for several, one of them is allowed"},
    {"{\"conus_atlas\": 1, \"parcellation\": \"a\\nb\"}",
     "parcellation: found \"a?b\", a text of one line that is not empty is needed"},
    {"{\"conus_atlas\": 1, \"references\": 7}", "references: found 7, a text is needed"},
    {"{\"conus_atlas\": 1, \"references\": [\"A\", {}]}", "references[1]: found an object, a text is needed"},
    {"{\"conus_atlas\": 1, \"transform\": \"a\", \"pathways\": [\"b\"]}",
     "transform: there are no areas, and no pathway or streamlines say that they move"},
    {"{\"conus_atlas\": 1, \"transform\": 1}", "transform: found 1, a path, an object or a list of these is needed"},
    {"{\"conus_atlas\": 1, \"transform\": [1]}", "transform[0]: found 1, a path or an object is needed"},
    {"{\"conus_atlas\": 1, \"context\": null}", "context: found null, a path, an object or a list of these is needed"},
    {"{\"conus_atlas\": 1, \"context\": [null]}", "context[0]: found null, a path or an object is needed"},
    {"{\"conus_atlas\": 1, \"areas\": [true]}", "areas[0]: found true, a path or an object is needed"},
    {"{\"conus_atlas\": 1, \"parcellation\": []}", "parcellation: found a list, a path or an object is needed"},
    {"{\"conus_atlas\": 1, \"transform\": [\"a\", {\"inverse\": true}]}", "transform[1].file is missing"},
    {"{\"conus_atlas\": 1, \"transform\": {\"file\": \"a\", \"inverse\": 1}}",
     "transform.inverse: found 1, true or false is needed"},
    {"{\"conus_atlas\": 1, \"transform\": {\"file\": \"a\", \"from\": \"/b\"}}",
     "transform.from: found \"/b\", a path inside the manifest's folder (or \"allow_outside\": true) is needed"},
    {"{\"conus_atlas\": 1, \"pathways\": [\"a\", {\"file\": \"b\", \"moves\": true}]}",
     "pathways[1].moves: there is no transform that could move it"},
    {"{\"conus_atlas\": 1, \"parcellation\": \"a\", \"transform\": [], \"context\": {\"file\": \"b\", \"moves\": "
     "true}}",
     "context.moves: there is no transform that could move it"},
    {"{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"b\", \"moves\": true}]}",
     "probabilities[0].moves: is for pathways and the context, areas always move"},
    {"{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"b\", \"orientation\": \"asr\"}]}",
     "probabilities[0]: resolution and orientation are for pathways"},
    {"{\"conus_atlas\": 1, \"allow_outside\": \"yes\"}", "allow_outside: found \"yes\", true or false is needed"},
};

static void what_the_schema_does_not_know_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        assert_fails(parse(text_from(refused[i].text)), CONUS_ERROR_DATA);
        assert_string_equal(conus_message(), refused[i].message);
    }
}

static conus_status parse_with_path(const char *path, bool allow)
{
    char text[256];
    snprintf(text, sizeof text, "{\"conus_atlas\": 1, \"parcellation\": \"%s\"%s}", path,
             allow ? ", \"allow_outside\": true" : "");
    return parse(text_from(text));
}

static void paths_stay_in_the_folder_unless_allowed(void **state)
{
    (void)state;
    static const char *const inside[] = {"a", "a/b", "./a", "a/../b", "a/b/../../c", "..a/b", "a//b"};
    static const char *const outside[] = {"/a", "../a", "a/../../b", "./../a", "..", "a/../..", "//a"};
    for (size_t i = 0; i < sizeof inside / sizeof inside[0]; i++) {
        assert_ok(parse_with_path(inside[i], false));
    }
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        assert_fails(parse_with_path(outside[i], false), CONUS_ERROR_DATA);
        assert_ok(parse_with_path(outside[i], true));
    }
    assert_fails(parse_with_path("../a", false), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "parcellation: found \"../a\", a path inside the manifest's folder (or "
                                         "\"allow_outside\": true) is needed");
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        const char *text = i ? several : whole;
        for (size_t size = 0; size < strlen(text) - 2; size++) {
            assert_fails(parse((struct text){text, size}), CONUS_ERROR_DATA);
        }
    }
}

static conus_status parse_text(void *data)
{
    return parse(text_from(data));
}

static void every_failing_step_is_reported(void **state)
{
    (void)state;
    test_every_allocation(parse_text, (void *)whole);
    test_every_allocation(parse_text, (void *)several);
    /* One to have the text read, one for each text and list in it, and those of words that stand behind others. */
    assert_in_range(test_every_primitive(parse_text, (void *)whole), 40, 80);
    assert_in_range(test_every_primitive(parse_text, (void *)several), 8, 20);
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

static void a_scene_is_loaded_in_one_piece(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    const char *path =
        write_manifest("\xef\xbb\xbf \n{\"conus_atlas\": 1, \"parcellation\": \"slabs.nii.gz\", \"threshold\": 0.5,"
                       "\"pathways\": [{\"file\": \"sphere.nii.gz\", \"name\": \"Ball\"}, \"sphere.nii.gz\"],"
                       "\"context\": {\"file\": \"sphere.nii.gz\", \"transfer\": \"grey\", \"blocks\": 0.5}}");
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Slab anterior");
    assert_int_equal(conus_atlas_object(atlas, 3)->kind, CONUS_KIND_PATHWAY);
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "Ball");
    assert_int_equal(conus_atlas_object(atlas, 3)->label, 1);
    assert_string_equal(conus_atlas_object(atlas, 4)->name, "sphere");
    assert_int_equal(conus_atlas_volume_count(atlas), 4);
    assert_near(conus_atlas_volume(atlas, 1)->threshold, 0.5, 0);
    assert_int_equal(conus_atlas_volume(atlas, 3)->role, CONUS_ROLE_CONTEXT);
    assert_near(conus_atlas_volume(atlas, 3)->threshold, 0.5, 0);
    conus_atlas_destroy(atlas);
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

static void labels_of_the_command_line_come_first(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    static const char table[] = "1 One\n300 Three hundred\n";
    static const char other[] = "1 Uno\n300 Trecento\n";
    assert_ok(conus_write_file(test_in("names.txt"), table, strlen(table)));
    assert_ok(conus_write_file(test_in("other.txt"), other, strlen(other)));
    const char *path = write_manifest("{\"conus_atlas\": 1, \"parcellation\": {\"file\": \"slabs.nii.gz\", "
                                      "\"labels\": \"names.txt\"}}");
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "One");
    conus_atlas_destroy(atlas);
    assert_ok(conus_atlas_load(&atlas, path, &(conus_load_options){.labels = test_in("other.txt")}));
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "Uno");
    conus_atlas_destroy(atlas);
    path = write_manifest("{\"conus_atlas\": 1, \"pathways\": [\"sphere.nii.gz\"]}");
    assert_fails(conus_atlas_load(&atlas, path, &(conus_load_options){.labels = test_in("other.txt")}),
                 CONUS_ERROR_ARGUMENT);
}

static void a_failure_names_manifest_and_key(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
        conus_status status;
    } cases[] = {
        {"{\"conus_atlas\": 1, \"parcellation\": \"no.nii\"}", "test.atlas.json: parcellation: ", CONUS_ERROR_IO},
        {"{\"conus_atlas\": 1, \"pathways\": [\"sphere.nii.gz\", \"no.nii\"]}",
         "test.atlas.json: pathways[1]: ", CONUS_ERROR_IO},
        {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"sphere.nii.gz\", \"threshold\": 2}]}",
         "test.atlas.json: pathways[0]: ", CONUS_ERROR_DATA},
        {"{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"sphere.nii.gz\", \"names\": [\"a\", \"b\"]}]}",
         "names: has 2 entries, sphere.nii.gz has 1 volumes: they must be as many", CONUS_ERROR_DATA},
        {"{\"conus_atlas\": 1, \"pathways\": [{\"fsl\": \"no.xml\"}]}",
         "test.atlas.json: pathways[0]: ", CONUS_ERROR_IO},
        {"{\"conus_atlas\": 1, \"pathways\": [\"sphere.nii.gz\"], \"context\": \"no.nii\"}",
         "test.atlas.json: context: ", CONUS_ERROR_IO},
        {"{\"conus_atlas\": 1, \"pathways\": [\"sphere.nii.gz\"], \"context\": {\"file\": \"sphere.nii.gz\", "
         "\"transfer\": {\"file\": \"no.tf\"}}}",
         "context: transfer.file: ", CONUS_ERROR_IO},
        {"{\"conus_atlas\": 1, \"parcellation\": \"test.atlas.json\"}",
         "test.atlas.json: parcellation: ", CONUS_ERROR_DATA},
        {"{\"conus_atlas\": true}", "test.atlas.json: conus_atlas: found true", CONUS_ERROR_DATA},
        {"{\"areas\": 1}", "this is JSON of another kind; needed is a labelled volume", CONUS_ERROR_DATA},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_atlas *atlas = NULL;
        assert_fails(conus_atlas_load(&atlas, write_manifest(cases[i].text), NULL), cases[i].status);
        assert_non_null(strstr(conus_message(), cases[i].part));
        assert_null(atlas);
    }
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

/* Three volumes without an sform, which is noted; volume t has t + 1 voxels of 1. */
static void write_four(void)
{
    struct nifti_builder b;
    nifti_begin(&b, 1, false, VOLUME_UINT8, (const int64_t[]){3, 2, 2});
    nifti_set(&b, "dim", 0, 4);
    nifti_set(&b, "dim", 4, 3);
    nifti_set(&b, "sform_code", 0, 0);
    for (size_t v = 0; v < 36; v++) {
        nifti_voxel(&b, v % 12 <= v / 12);
    }
    write_packed("scene/four.nii.gz", &b.bytes);
    buffer_finish(&b.bytes);
}

static const char *const series_manifests[] = {
    "{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"four.nii.gz\", \"names\": [\"a\", \"b\", \"c\"]}]}",
    "{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"four.nii.gz\", \"volume\": 0, \"name\": \"a\"}, "
    "{\"file\": \"four.nii.gz\", \"volume\": 1, \"name\": \"b\"}, "
    "{\"file\": \"four.nii.gz\", \"volume\": 2, \"name\": \"c\"}]}"};

static void volumes_of_one_file_are_pathways_of_their_own(void **state)
{
    (void)state;
    write_four();
    for (size_t i = 0; i < 2; i++) {
        conus_atlas *atlas = NULL;
        size_t told = 0;
        assert_ok(conus_atlas_load(&atlas, write_manifest(series_manifests[i]), NULL));
        assert_int_equal(conus_atlas_object_count(atlas), 3);
        for (size_t k = 0; k < 3; k++) {
            assert_int_equal(conus_atlas_object(atlas, k + 1)->name[0], 'a' + k);
            assert_int_equal(conus_atlas_object(atlas, k + 1)->voxels, k + 1);
            assert_int_equal(conus_atlas_volume(atlas, k)->volume, k);
        }
        for (size_t k = 0; k < conus_atlas_note_count(atlas); k++) {
            told += strstr(conus_atlas_note(atlas, k), "four.nii.gz: ") != NULL;
        }
        assert_int_equal(told, 1); /* once, not for each volume */
        conus_atlas_destroy(atlas);
    }
    conus_atlas *atlas = NULL;
    const char *beyond =
        write_manifest("{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"four.nii.gz\", \"volume\": 2}, "
                       "{\"file\": \"four.nii.gz\", \"volume\": 3}]}");
    assert_fails(conus_atlas_load(&atlas, beyond, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "pathways[1]: "));
    assert_non_null(strstr(conus_message(), "volume: found 3, allowed are 0 to 2"));
}

static conus_status load_scene(void *data)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, data, NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation_of_a_scene_is_reported(void **state)
{
    (void)state;
    const char *path = write_manifest("{\"conus_atlas\": 1, \"parcellation\": \"slabs.nii.gz\", \"threshold\": 0.5,"
                                      "\"pathways\": [{\"file\": \"sphere.nii.gz\", \"names\": [\"Ball\"]}],"
                                      "\"context\": {\"file\": \"sphere.nii.gz\", \"transfer\": \"grey\"}}");
    test_every_allocation(load_scene, (void *)path);
    assert_true(test_every_primitive(load_scene, (void *)path) > 5);
    write_four();
    for (size_t i = 0; i < 2; i++) {
        test_every_allocation(load_scene, (void *)write_manifest(series_manifests[i]));
        assert_true(test_every_primitive(load_scene, (void *)write_manifest(series_manifests[i])) > 5);
    }
}

TEST_GROUP(manifest)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_of_areas_is_kept),
        cmocka_unit_test(every_key_of_pathways_transforms_and_context_is_kept),
        cmocka_unit_test(parcellations_are_kept_in_their_order),
        cmocka_unit_test(what_the_schema_does_not_know_is_refused),
        cmocka_unit_test(paths_stay_in_the_folder_unless_allowed),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_step_is_reported),
        cmocka_unit_test(a_scene_is_loaded_in_one_piece),
        cmocka_unit_test(progress_is_reported_file_by_file),
        cmocka_unit_test(a_load_can_be_cancelled_at_each_file),
        cmocka_unit_test(labels_of_the_command_line_come_first),
        cmocka_unit_test(a_failure_names_manifest_and_key),
        cmocka_unit_test(volumes_of_one_file_are_pathways_of_their_own),
        cmocka_unit_test(an_fsl_atlas_gives_one_pathway_per_label),
        cmocka_unit_test(every_failing_allocation_of_a_scene_is_reported),
    };
    return cmocka_run_group_tests(tests, write_volumes, NULL);
}
