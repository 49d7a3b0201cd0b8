/* SPDX-License-Identifier: BSD-3-Clause */
/* The catalogue as a library: every failing allocation, limits, names. tests/cli/atlases.bats has the programs'
 * folders.
 */
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "loaders/catalogue/catalogue.h"
#include "test.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const variables[] = {"CONUS_ATLAS_PATH",    "FSLDIR",          "SUBJECTS_DIR",   "FREESURFER_HOME",
                                        "TEMPLATEFLOW_HOME",   "XDG_DATA_HOME",   "XDG_CACHE_HOME", "AFNI_ATLAS_PATH",
                                        "AFNI_SUPP_ATLAS_DIR", "AFNI_PLUGINPATH", "SPM_DIR",        "NILEARN_DATA",
                                        "NILEARN_SHARED_DATA", "MRICROGL_DIR"};

static void write_text(const char *name, const char *text)
{
    assert_ok(conus_write_file(test_in(name), text, strlen(text)));
}

/* A volume of 2 x 3 x 4 mm with the labels 0 to 7. */
static void write_volume(const char *name, int intent)
{
    struct nifti_builder file;
    nifti_begin(&file, 1, false, 2, (const int64_t[]){2, 2, 2});
    nifti_set(&file, "intent_code", 0, intent);
    for (int i = 0; i < 8; i++) {
        nifti_voxel(&file, i);
    }
    assert_ok(conus_write_file(test_in(name), file.bytes.data, file.bytes.size));
    buffer_finish(&file.bytes);
}

/* Makes an empty folder the only place for atlases and the home. */
static void use_folder(const char *name)
{
    test_folder(name);
    for (size_t i = 0; i < sizeof variables / sizeof variables[0]; i++) {
        unsetenv(variables[i]);
    }
    setenv("XDG_DATA_DIRS", test_in("none"), 1);
    setenv("HOME", test_in(""), 1);
    setenv("PATH", "", 1);
    setenv("CONUS_ATLAS_PATH", test_in(""), 1);
}

static conus_catalogue *look(void)
{
    conus_catalogue *catalogue = NULL;
    assert_ok(conus_catalogue_create(&catalogue, NULL));
    return catalogue;
}

static void knows_sizes_and_kinds(void **state)
{
    (void)state;
    use_folder("kinds");
    write_volume("a.nii", 1002);
    write_volume("image.nii", 0);
    write_text("image.json", "{}"); /* BIDS has one beside each image: it says nothing of labels */
    write_text("all.atlas.json", "{}");
    conus_catalogue *catalogue = look();
    assert_int_equal(conus_catalogue_count(catalogue), 2);
    const conus_installed *volume = conus_catalogue_atlas(catalogue, 0);
    const conus_installed *scene = conus_catalogue_atlas(catalogue, 1);
    assert_string_equal(volume->name, "a");
    assert_string_equal(volume->source, "own");
    assert_string_equal(volume->kind, "volume");
    assert_string_equal(scene->name, "all");
    assert_string_equal(scene->kind, "scene");
    for (int i = 0; i < 3; i++) {
        assert_near(volume->spacing[i], 2 + i, 0);
        assert_near(scene->spacing[i], 0, 0);
    }
    assert_null(volume->labels);
    assert_null(conus_catalogue_atlas(catalogue, 2));
    conus_catalogue_destroy(catalogue);
}

static void counts_nothing_of_null(void **state)
{
    (void)state;
    assert_int_equal(conus_catalogue_count(NULL), 0);
    assert_int_equal(conus_catalogue_place_count(NULL), 0);
    assert_int_equal(conus_catalogue_note_count(NULL), 0);
    assert_null(conus_catalogue_note(NULL, 0));
    assert_null(conus_catalogue_place_at(NULL, 0));
    conus_catalogue_destroy(NULL);
    assert_fails(conus_catalogue_create(NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_catalogue_find(NULL, NULL, NULL), CONUS_ERROR_ARGUMENT);
}

static void paths_are_no_names(void **state)
{
    (void)state;
    use_folder("paths");
    write_volume("a.nii", 0);
    assert_true(conus_atlas_is_path(test_in("a.nii")));
    assert_true(conus_atlas_is_path("none/at/all"));
    assert_true(conus_atlas_is_path("."));
    assert_false(conus_atlas_is_path("aal"));
    assert_false(conus_atlas_is_path(""));
    assert_false(conus_atlas_is_path("a.nii"));
    char before[PATH_MAX];
    assert_non_null(getcwd(before, sizeof before));
    assert_int_equal(chdir(test_in("")), 0);
    assert_true(conus_atlas_is_path("a.nii"));
    assert_true(conus_atlas_is_path("a.nii,volume=3"));
    assert_true(conus_atlas_is_path("a.nii,map=a, b"));
    assert_true(conus_atlas_is_path("a.nii,resolution=25,orientation=asr"));
    assert_true(conus_atlas_is_path("a.nii,orientation=asr,resolution=25"));
    assert_true(conus_atlas_is_path("a.nii,other=3")); /* the file is meant, and its reader refuses the key */
    assert_false(conus_atlas_is_path("b.nii,volume=3"));
    assert_int_equal(chdir(before), 0);
}

/* The rule of names: an exact name comes before similar ones, and only separators between words make no difference. */
static void names_may_be_written_otherwise(void **state)
{
    (void)state;
    use_folder("names");
    static const char *const files[] = {"One-Two_3.nii", "onetwo3.nii", "Other.nii"};
    for (size_t i = 0; i < 3; i++) {
        write_volume(files[i], 1002);
    }
    static const struct {
        const char *text, *name; /* NULL: not the name of one atlas */
        conus_status status;
    } cases[] = {
        {"One-Two_3", "One-Two_3", CONUS_OK}, {"own:One-Two_3", "One-Two_3", CONUS_OK},
        {"onetwo3", "onetwo3", CONUS_OK},     {"one.two.3", NULL, CONUS_ERROR_ARGUMENT},
        {"other", "Other", CONUS_OK},         {"OWN:o t h e r", "Other", CONUS_OK},
        {"others", NULL, CONUS_ERROR_IO},     {"mricron:Other", NULL, CONUS_ERROR_IO},
        {"own:", NULL, CONUS_ERROR_IO},       {":Other", NULL, CONUS_ERROR_IO},
    };
    conus_catalogue *catalogue = look();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const conus_installed *found = NULL;
        assert_int_equal(conus_catalogue_find(&found, catalogue, cases[i].text), cases[i].status);
        assert_true(cases[i].name ? strcmp(found->name, cases[i].name) == 0 : found == NULL);
    }
    const conus_installed *found = NULL;
    assert_fails(conus_catalogue_find(&found, catalogue, "othr"), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "did you mean Other?"));
    conus_catalogue_destroy(catalogue);
}

/* One more manifest than a source may have. */
static void a_source_has_a_limit(void **state)
{
    (void)state;
    use_folder("limit");
    char name[64];
    for (int folder = 0; folder < 2; folder++) {
        snprintf(name, sizeof name, "limit/%d", folder);
        test_folder(name);
        for (int i = 0; i <= CATALOGUE_ATLASES / 2; i++) {
            snprintf(name, sizeof name, "s%d.atlas.json", i);
            FILE *file = fopen(test_in(name), "w"); /* conus_write_file() waits for the disk, 4098 times */
            assert_non_null(file);
            assert_true(fputs("{}", file) >= 0 && fclose(file) == 0);
        }
    }
    conus_catalogue *catalogue = look();
    assert_int_equal(conus_catalogue_count(catalogue), CATALOGUE_ATLASES);
    assert_int_equal(conus_catalogue_note_count(catalogue), 1);
    assert_string_equal(conus_catalogue_note(catalogue, 0), "own: more than 4096 atlases: the rest is left out");
    conus_catalogue_destroy(catalogue);
}

static void hear(void *user, const conus_note *note)
{
    assert_non_null(strstr(note->line, "none of the volumes"));
    ++*(int *)user;
}

static void notes_are_heard(void **state)
{
    (void)state;
    use_folder("notes");
    write_text("Gone.xml",
               "<atlas><header><type>Label</type><images><imagefile>/x</imagefile></images></header></atlas>");
    int heard = 0;
    conus_catalogue *catalogue = NULL;
    const conus_catalogue_options options = {.log = hear, .log_user = &heard};
    assert_ok(conus_catalogue_create(&catalogue, &options));
    assert_int_equal(heard, 1);
    assert_int_equal(conus_catalogue_note_count(catalogue), 1);
    conus_catalogue_destroy(catalogue);
}

/* Every kind of atlas, every kind of place. */
static conus_status look_and_find(void *data)
{
    conus_catalogue *catalogue = NULL;
    const conus_installed *found = NULL;
    (void)data;
    conus_status status = conus_catalogue_create(&catalogue, NULL);
    status = status ? status : conus_catalogue_find(&found, catalogue, "own:a");
    if (!status) {
        conus_status twice = conus_catalogue_find(&found, catalogue, "aparc");
        conus_status none = conus_catalogue_find(&found, catalogue, "nothing");
        status = twice == CONUS_ERROR_MEMORY || twice == CONUS_ERROR_DATA ? twice
                 : none == CONUS_ERROR_IO                                 ? CONUS_OK
                                                                          : none;
    }
    conus_catalogue_destroy(catalogue);
    return status;
}

static void survives_every_failing_step(void **state)
{
    (void)state;
    use_folder("memory");
    write_volume("a.nii", 1002);
    write_volume("b.nii", 0);
    write_text("b.txt", "1 x\n");
    write_text("scene.atlas.json", "{}");
    write_text("one.xml",
               "<atlas><header><type>Label</type><images><imagefile>/a</imagefile></images></header></atlas>");
    test_folder("memory/globe_v1.0");
    write_text("structures.json", "[]");
    test_folder("memory/globe_v1.0/meshes");
    test_folder("memory/subject");
    test_folder("memory/subject/mri");
    write_volume("aseg.mgz", 0);
    test_folder("memory/subject/surf");
    write_text("lh.white", "x");
    test_folder("memory/subject/label");
    write_text("lh.aparc.annot", "x");
    test_folder("memory");
    write_text("FreeSurferColorLUT.txt", "1 x 0 0 0 0\n");
    setenv("SUBJECTS_DIR", test_in(""), 1);
    setenv("FREESURFER_HOME", test_in(""), 1);
    conus_catalogue *catalogue = look();
    /* own: one, which is a, too; b, scene, globe_v1.0, aseg. freesurfer: subject.aseg, subject.lh.aparc. */
    assert_int_equal(conus_catalogue_count(catalogue), 7);
    conus_catalogue_destroy(catalogue);
    test_every_allocation(look_and_find, NULL);
    assert_true(test_every_primitive(look_and_find, NULL) > 100);
}

TEST_GROUP(catalogue)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knows_sizes_and_kinds),       cmocka_unit_test(counts_nothing_of_null),
        cmocka_unit_test(paths_are_no_names),          cmocka_unit_test(names_may_be_written_otherwise),
        cmocka_unit_test(a_source_has_a_limit),        cmocka_unit_test(notes_are_heard),
        cmocka_unit_test(survives_every_failing_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
