/* SPDX-License-Identifier: BSD-3-Clause */
/* Loading one atlas or several as the options say, and cancelling a load. */
#include "conus/own.h"
#include "options/messages.h"
#include "settings/settings.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct patience {
    size_t calls, allowed;
};

static bool hear(void *user, const char *path, size_t done, size_t total)
{
    struct patience *patience = user;
    assert_true(path[0] && done < total);
    return patience->calls++ < patience->allowed;
}

/* The scene has 11 surfaces, a pathway and a context; --pathway twice makes two more calls of the callback. A call that
 * cancels is the last one, and nothing is printed. */
static void a_cancelled_load_calls_back_no_more(void **state)
{
    enum { FILES = 11 + 1 + 1 + 2 };
    const char *folder = test_scratch("brain");
    char path[4096], pathway[4096];
    const char *pathways[] = {pathway, pathway};
    (void)state;
    assert_ok(conus_phantom_write("brain", folder, NULL));
    snprintf(path, sizeof path, "%s/brain.atlas.json", folder);
    snprintf(pathway, sizeof pathway, "%s/brain-pathway.nii.gz,name=another", folder);
    FILE *said = tmpfile(); /* in place of stderr while the atlas is loaded, so that failures of the test are seen */
    int own = dup(STDERR_FILENO);
    assert_non_null(said);
    for (size_t allowed = 0; allowed <= FILES; allowed++) {
        struct patience patience = {.allowed = allowed};
        struct atlas_settings settings = {
            .pathways = {.items = pathways, .count = 2}, .progress = hear, .progress_user = &patience};
        conus_atlas *atlas = NULL;
        dup2(fileno(said), STDERR_FILENO);
        int code = atlas_input_load(&atlas, path, &settings);
        dup2(own, STDERR_FILENO);
        assert_int_equal(code, allowed < FILES ? EXIT_DATA : EXIT_DONE);
        assert_int_equal(patience.calls, allowed < FILES ? allowed + 1 : FILES);
        assert_int_equal(atlas != NULL, allowed == FILES);
        conus_atlas_destroy(atlas);
    }
    assert_int_equal(lseek(fileno(said), 0, SEEK_END), 0);
    close(own);
    fclose(said);
}

static conus_atlas *load_bundle(struct tract_shelf *shelf, const char *atlas, const char *bundle, int wanted)
{
    const struct atlas_settings settings = {.streamlines = {.items = &bundle, .count = 1}, .shelf = shelf};
    conus_atlas *out = NULL;
    messages_hold(true);
    assert_int_equal(atlas_input_load(&out, atlas, &settings), wanted);
    messages_hold(false);
    return out;
}

/* The file is cut, so what is found again was not read again. What was asked for is kept until something else is. */
static void a_tractogram_is_read_once(void **state)
{
    (void)state;
    const char *folder = test_scratch("shelf");
    struct tract_shelf shelf = {0};
    char path[4096], bundle[4096], other[4200];
    assert_ok(conus_phantom_write("bundle", folder, NULL));
    assert_ok(conus_phantom_write("sphere", folder, NULL));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", folder);
    snprintf(bundle, sizeof bundle, "%s/bundle.tck", folder);
    snprintf(other, sizeof other, "%s,space=lps", bundle);
    tract_shelf_begin(&shelf, false);
    conus_atlas *first = load_bundle(&shelf, path, bundle, EXIT_DONE);
    assert_int_equal(truncate(bundle, 40), 0);
    tract_shelf_begin(&shelf, true);
    conus_atlas *again = load_bundle(&shelf, path, bundle, EXIT_DONE);
    load_bundle(&shelf, path, other, EXIT_DATA);
    conus_tractogram_info info[2] = {CONUS_TRACTOGRAM_INFO_INIT, CONUS_TRACTOGRAM_INFO_INIT};
    assert_ok(conus_atlas_tractogram(&info[0], first, 0));
    assert_ok(conus_atlas_tractogram(&info[1], again, 0));
    assert_int_equal(info[0].points, info[1].points);
    assert_string_equal(info[0].path, info[1].path);
    conus_atlas_destroy(first);
    tract_shelf_drop(&shelf);
    assert_int_equal(shelf.count, 1);
    conus_atlas_destroy(again);
    tract_shelf_begin(&shelf, false);
    load_bundle(&shelf, path, bundle, EXIT_DATA);
    tract_shelf_drop(&shelf);
    assert_int_equal(shelf.count, 0);
    tract_shelf_finish(&shelf);
}

/* Runs `say` with stderr in a file, and returns its output; the caller frees it. */
static char *words_of(void (*say)(void *user), void *user)
{
    char *words = calloc(1, 4096);
    FILE *said = tmpfile();
    int own = dup(STDERR_FILENO);
    assert_true(said && words);
    dup2(fileno(said), STDERR_FILENO);
    say(user);
    dup2(own, STDERR_FILENO);
    close(own);
    rewind(said);
    assert_true(fread(words, 1, 4095, said) < 4095);
    fclose(said);
    return words;
}

struct loading {
    struct atlases atlases;
    const char *first;
    struct atlas_settings settings;
    struct common_settings common;
    int code;
};

static void load(void *user)
{
    struct loading *loading = user;
    loading->code = atlases_load(&loading->atlases, loading->first, &loading->settings, NULL);
}

static void say_spaces(void *user)
{
    struct loading *loading = user;
    atlases_say_spaces(&loading->atlases, &loading->common);
}

/* A volume of two voxels: area 1 at (x, 0, 0) and area 2 at (x, 1, 0), in a space of that NIfTI code. */
static const char *write_voxels(const char *name, double x, int code)
{
    const uint8_t areas[] = {1, 2};
    const char *path = test_in(name);
    conus_voxels voxels = CONUS_VOXELS_INIT;
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_selection *ball = NULL;
    conus_grid *grid = NULL;
    const conus_grid_options labels = {.content = CONUS_GRID_MAP_OF_LABELS};
    const double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1};
    voxels.data = areas;
    voxels.type = CONUS_SCALAR_UINT8;
    voxels.space_code = code;
    for (int i = 0; i < 3; i++) {
        voxels.dim[i] = i == 1 ? 2 : 1;
        voxels.stride[i] = 1;
    }
    memcpy(voxels.world_from_voxel, matrix, sizeof matrix);
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL));
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select_ball(&ball, selector, (double[]){x, 0, 0}, 2));
    assert_ok(conus_selection_grid(&grid, ball, &labels));
    assert_ok(conus_grid_write(grid, path));
    conus_grid_destroy(grid);
    conus_selection_destroy(ball);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return path;
}

/* An atlas is named after its file, without folder and ending, or after its folder. A name that is taken gets the next
 * free number: two files "one", one "one-2" and one more "one" are one, one-2, one-2-2 and one-3. */
static void atlases_have_different_names(void **state)
{
    static const char *const wanted[] = {"one", "one-2", "one-2-2", "brain.v2", "lh.x", "a b", "s", "one-3"};
    enum { COUNT = sizeof wanted / sizeof wanted[0] };
    const char *paths[COUNT];
    (void)state;
    test_folder("names");
    paths[0] = strdup(write_voxels("one.nii.gz", 0, 4));
    paths[1] = strdup(write_voxels("one.nii", 0, 4));
    paths[2] = strdup(write_voxels("one-2.nii", 0, 4));
    paths[3] = strdup(test_in("brain.v2/"));
    paths[4] = strdup(write_voxels("lh.x.nii", 0, 4));
    paths[5] = strdup(write_voxels("a\nb.nii", 0, 4));
    paths[6] = strdup(test_in("s.tif,resolution=25,orientation=asr"));
    paths[7] = strdup(test_in("one.mgz"));
    assert_int_equal(mkdir(paths[3], 0777), 0);
    struct loading loading = {.first = paths[0], .settings.more = {paths + 1, COUNT - 1}};
    assert_int_equal(atlases_name(&loading.atlases, loading.first, &loading.settings), EXIT_DONE);
    assert_int_equal(loading.atlases.count, COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        assert_string_equal(loading.atlases.items[i].name, wanted[i]);
    }
    atlases_finish(&loading.atlases);
    loading.settings.more.count = 2;
    load(&loading);
    assert_int_equal(loading.code, EXIT_DONE);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(conus_atlas_object_count(loading.atlases.items[i].atlas), 2);
    }
    atlases_finish(&loading.atlases);
    for (size_t i = 0; i < COUNT; i++) {
        free((void *)paths[i]);
    }
}

/* --hide is for the first atlas alone: the box of that one begins where area 2 does, at y = 0.5 mm. A single atlas has
 * no name. */
static void some_options_are_of_the_first_atlas(void **state)
{
    const char *hidden = "1";
    (void)state;
    test_folder("names");
    const char *path = write_voxels("one.nii", 0, 4);
    struct loading loading = {.first = path, .settings = {.hide = {&hidden, 1}, .more = {&path, 1}}};
    double box[2][3];
    load(&loading);
    assert_int_equal(loading.code, EXIT_DONE);
    assert_ok(conus_atlas_bounds(box[0], box[1], loading.atlases.items[0].atlas));
    assert_near(box[0][1], 0.5, 1e-12);
    assert_ok(conus_atlas_bounds(box[0], box[1], loading.atlases.items[1].atlas));
    assert_near(box[0][1], -0.5, 1e-12);
    atlases_finish(&loading.atlases);
    loading.settings.more.count = 0;
    load(&loading);
    assert_int_equal(loading.atlases.count, 1);
    assert_null(loading.atlases.items[0].name);
    atlases_finish(&loading.atlases);
}

/* A missing file, and areas without left and right, which cannot be merged: the message names the file. */
static void errors_name_the_atlas(void **state)
{
    (void)state;
    test_folder("names");
    const char *path = write_voxels("one.nii", 0, 4);
    const char *absent = test_in("absent.nii");
    struct loading loading = {.first = path, .settings = {.more = {&absent, 1}}};
    char *words = words_of(load, &loading);
    assert_int_equal(loading.code, EXIT_DATA);
    assert_non_null(strstr(words, absent));
    free(words);
    atlases_finish(&loading.atlases);
    loading.settings = (struct atlas_settings){.hemispheres = CONUS_HEMISPHERES_MERGED, .more = {&path, 1}};
    words = words_of(load, &loading);
    assert_int_equal(loading.code, EXIT_DATA);
    assert_non_null(strstr(words, path));
    free(words);
    atlases_finish(&loading.atlases);
}

/* Codes of NIfTI: 1 scanner, 2 aligned to another, 3 Talairach, 4 MNI 152. A voxel reaches 0.5 mm from its centre. */
static void notes_say_which_atlases_do_not_belong_together(void **state)
{
    static const struct {
        double x;
        int code;
        const char *note; /* NULL = none */
        bool warns;
    } cases[] = {{0, 4, NULL, false},
                 {0.9, 4, NULL, false},
                 {1.1, 4, "do not overlap", true},
                 {0, 2, NULL, false},
                 {0, 0, NULL, false},
                 {9, 2, "do not overlap", true},
                 {0, 1, "scanner", false},
                 {9, 3, "one (MNI 152) and other (Talairach) are different brains", true}};
    (void)state;
    test_folder("names");
    char *first = strdup(write_voxels("one.nii", 0, 4));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *other = write_voxels("other.nii", cases[i].x, cases[i].code);
        struct loading loading = {.first = first, .settings.more = {&other, 1}};
        load(&loading);
        assert_int_equal(loading.code, EXIT_DONE);
        const char *start = cases[i].warns ? "warning: one " : "note: one ";
        warnings_forget(0);
        char *words = words_of(say_spaces, &loading);
        assert_true(cases[i].note ? strstr(words, cases[i].note) && strstr(words, start) : !*words);
        free(words);
        words = words_of(say_spaces, &loading);
        assert_int_equal(*words != '\0', cases[i].note && !cases[i].warns); /* a warning is said once */
        free(words);
        assert_int_equal(warning_line(0) != NULL, cases[i].warns);
        assert_null(warning_line(1));
        warnings_forget(0);
        loading.common.quiet = true;
        words = words_of(say_spaces, &loading);
        assert_int_equal(*words != '\0', cases[i].warns);
        free(words);
        atlases_finish(&loading.atlases);
    }
    free(first);
}

TEST_GROUP(atlas_input)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_cancelled_load_calls_back_no_more),
                                       cmocka_unit_test(a_tractogram_is_read_once),
                                       cmocka_unit_test(atlases_have_different_names),
                                       cmocka_unit_test(some_options_are_of_the_first_atlas),
                                       cmocka_unit_test(errors_name_the_atlas),
                                       cmocka_unit_test(notes_say_which_atlases_do_not_belong_together)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
