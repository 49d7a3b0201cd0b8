/* SPDX-License-Identifier: BSD-3-Clause */
/* Whose brain an atlas is: stated, by its header, by its grid, by its voxels. */
#include "atlas/space.h"
#include "base/files/file.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* A grid along the axes: voxel axis `order[w]` runs along the world's w, backwards where `turned` has its bit. */
static conus_volume_info grid_of(const size_t dim[3], double spacing, const double low[3], const int order[3],
                                 int turned)
{
    conus_volume_info info = {0};
    info.world_from_voxel[15] = 1;
    for (int world = 0; world < 3; world++) {
        int voxel = order[world];
        bool back = turned >> world & 1;
        info.dim[voxel] = dim[world];
        info.world_from_voxel[4 * voxel + world] = back ? -spacing : spacing;
        info.world_from_voxel[12 + world] = low[world] + (back ? spacing * ((double)dim[world] - 1) : 0);
    }
    return info;
}

static const struct {
    size_t dim[3];
    double spacing, low[3];
    conus_brain brain;
    const char *words;
} grids[] = {
    {{182, 218, 182}, 1, {-91, -126, -72}, CONUS_BRAIN_MNI152, "MNI 152, earlier than NLin2009"},
    {{91, 109, 91}, 2, {-90, -126, -72}, CONUS_BRAIN_MNI152, "MNI 152, earlier than NLin2009"},
    {{193, 229, 193}, 1, {-96, -132, -78}, CONUS_BRAIN_MNI152, "MNI 152, NLin2009"},
    {{394, 466, 378}, 0.5, {-98, -134, -72}, CONUS_BRAIN_MNI152, "MNI 152, NLin2009"},
    {{121, 145, 121}, 1.5, {-90, -126, -72}, CONUS_BRAIN_MNI152, "MNI 152"},
    {{181, 217, 181}, 1, {-90, -125, -71}, CONUS_BRAIN_COLIN27, "Colin 27"},
    {{256, 256, 256}, 1, {-127, -145, -147}, CONUS_BRAIN_UNKNOWN, "unknown"},
    {{256, 256, 256}, 1, {-128, -127, -128}, CONUS_BRAIN_UNKNOWN, "unknown"}, /* FreeSurfer's: anybody's */
    {{260, 311, 260}, 0.7, {-91.3, -126, -72}, CONUS_BRAIN_MNI152, "MNI 152, earlier than NLin2009"},
    {{91, 109, 91}, 2, {-90.5, -126.5, -72.5}, CONUS_BRAIN_MNI152, "MNI 152, earlier than NLin2009"},
    {{362, 434, 362}, 0.5, {-90, -126, -72}, CONUS_BRAIN_UNKNOWN, "unknown"}, /* no file or text says whose */
};

static void a_grid_tells_in_every_order_and_direction(void **state)
{
    (void)state;
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (size_t i = 0; i < sizeof grids / sizeof grids[0]; i++) {
        for (int way = 0; way < 48; way++) {
            conus_volume_info info = grid_of(grids[i].dim, grids[i].spacing, grids[i].low, orders[way / 8], way % 8);
            conus_brain_view brain = conus_volume_brain(&info);
            assert_int_equal(brain.brain, grids[i].brain);
            assert_string_equal(brain.words, grids[i].words);
            assert_string_equal(brain.source, brain.brain ? "grid" : "");
        }
    }
}

/* A grid that is off by half a voxel, by a voxel more, by a per cent or by a turn is no template's. */
static void a_grid_nearby_does_not_tell(void **state)
{
    (void)state;
    static const int order[3] = {0, 1, 2};
    for (int axis = 0; axis < 3; axis++) {
        conus_volume_info info = grid_of(grids[0].dim, 1, grids[0].low, order, 1);
        info.world_from_voxel[12 + axis] += 0.5;
        assert_int_equal(conus_volume_brain(&info).brain, CONUS_BRAIN_UNKNOWN);
        info = grid_of(grids[0].dim, 1, grids[0].low, order, 0);
        info.dim[axis]++;
        assert_int_equal(conus_volume_brain(&info).brain, CONUS_BRAIN_UNKNOWN);
        info = grid_of(grids[0].dim, 1, grids[0].low, order, 0);
        info.world_from_voxel[5 * axis] *= 1.01;
        assert_int_equal(conus_volume_brain(&info).brain, CONUS_BRAIN_UNKNOWN);
        info = grid_of(grids[0].dim, 1, grids[0].low, order, 0);
        info.world_from_voxel[4 * axis + (axis + 1) % 3] = 0.01;
        assert_int_equal(conus_volume_brain(&info).brain, CONUS_BRAIN_UNKNOWN);
    }
}

static void the_header_comes_before_the_grid(void **state)
{
    (void)state;
    static const int order[3] = {0, 1, 2};
    static const struct {
        size_t grid;
        int code;
        conus_brain brain;
        const char *edition, *source;
    } cases[] = {{0, 0, CONUS_BRAIN_MNI152, "earlier", "grid"},
                 {0, 1, CONUS_BRAIN_MNI152, "earlier", "grid"},
                 {0, 2, CONUS_BRAIN_MNI152, "earlier", "grid"},
                 {0, 3, CONUS_BRAIN_TALAIRACH, "", "header"},
                 {0, 4, CONUS_BRAIN_MNI152, "earlier", "header"},
                 {0, 5, CONUS_BRAIN_TEMPLATE, "", "header"},
                 {2, 4, CONUS_BRAIN_MNI152, "NLin2009", "header"},
                 {5, 4, CONUS_BRAIN_COLIN27, "", "grid"}, /* AAL */
                 {5, 3, CONUS_BRAIN_TALAIRACH, "", "header"},
                 {7, 4, CONUS_BRAIN_MNI152, "", "header"},
                 {7, 1, CONUS_BRAIN_UNKNOWN, "", ""},
                 {7, 6, CONUS_BRAIN_UNKNOWN, "", ""}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_volume_info info =
            grid_of(grids[cases[i].grid].dim, grids[cases[i].grid].spacing, grids[cases[i].grid].low, order, 0);
        info.space_code = cases[i].code;
        conus_brain_view brain = conus_volume_brain(&info);
        assert_int_equal(brain.brain, cases[i].brain);
        assert_string_equal(brain.edition, cases[i].edition);
        assert_string_equal(brain.source, cases[i].source);
    }
}

/* A statement comes before the header; a move makes it void, unless the brain is one person's own. */
static void what_is_stated_holds_until_the_atlas_is_moved(void **state)
{
    (void)state;
    static const double shift[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1};
    static const struct {
        const char *word;
        conus_brain brain, moved;
    } cases[] = {{"", CONUS_BRAIN_UNKNOWN, CONUS_BRAIN_UNKNOWN},
                 {",template=mni152", CONUS_BRAIN_MNI152, CONUS_BRAIN_UNKNOWN},
                 {",template=colin27", CONUS_BRAIN_COLIN27, CONUS_BRAIN_UNKNOWN},
                 {",template=mni305", CONUS_BRAIN_MNI305, CONUS_BRAIN_UNKNOWN},
                 {",template=none", CONUS_BRAIN_OWN, CONUS_BRAIN_OWN},
                 {",template=none,volume=0", CONUS_BRAIN_OWN, CONUS_BRAIN_OWN},
                 {",volume=0,template=none", CONUS_BRAIN_OWN, CONUS_BRAIN_OWN}};
    static const char *const wrong[] = {",template=", ",template=MNI", ",template=talairach"};
    char path[4096];
    conus_atlas *atlas = NULL;
    assert_ok(conus_phantom_write("sphere", test_scratch("brain"), &(conus_phantom_options){.size = 16}));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        snprintf(path, sizeof path, "%s/sphere.nii.gz%s", test_scratch("brain"), cases[i].word);
        assert_ok(conus_atlas_load(&atlas, path, NULL));
        assert_int_equal(conus_atlas_brain(atlas).brain, cases[i].brain);
        assert_false(conus_atlas_brain(atlas).is_moved);
        assert_ok(conus_atlas_move(atlas, shift));
        assert_int_equal(conus_atlas_brain(atlas).brain, cases[i].moved);
        assert_true(conus_atlas_brain(atlas).is_moved);
        conus_atlas_destroy(atlas);
        atlas = NULL;
    }
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        snprintf(path, sizeof path, "%s/sphere.nii.gz%s", test_scratch("brain"), wrong[i]);
        assert_fails(conus_atlas_load(&atlas, path, NULL), CONUS_ERROR_ARGUMENT);
        assert_null(atlas);
    }
}

/* A manifest states whose brain its scene is where poses are, so behind its own transform. */
static void a_manifest_states_it(void **state)
{
    (void)state;
    static const char *const keys[] = {"", ",\"template\":\"colin27\"",
                                       ",\"template\":\"mni152\",\"transform\":\"shift.txt\""};
    static const conus_brain brains[] = {CONUS_BRAIN_UNKNOWN, CONUS_BRAIN_COLIN27, CONUS_BRAIN_MNI152};
    static const char matrix[] = "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    char path[4096];
    char text[512];
    conus_atlas *atlas = NULL;
    assert_ok(conus_phantom_write("sphere", test_scratch("brain"), &(conus_phantom_options){.size = 16}));
    snprintf(path, sizeof path, "%s/shift.txt", test_scratch("brain"));
    assert_ok(file_write(path, matrix, strlen(matrix)));
    snprintf(path, sizeof path, "%s/scene.atlas.json", test_scratch("brain"));
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        snprintf(text, sizeof text, "{\"conus_atlas\":1,\"parcellation\":\"sphere.nii.gz\"%s}", keys[i]);
        assert_ok(file_write(path, text, strlen(text)));
        assert_ok(conus_atlas_load(&atlas, path, NULL));
        assert_int_equal(conus_atlas_brain(atlas).brain, brains[i]);
        conus_atlas_destroy(atlas);
        atlas = NULL;
    }
    snprintf(text, sizeof text, "{\"conus_atlas\":1,\"parcellation\":\"sphere.nii.gz\",\"template\":\"mni\"}");
    assert_ok(file_write(path, text, strlen(text)));
    assert_fails(conus_atlas_load(&atlas, path, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "template"));
}

static void real_atlases_are_known(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        const char *words;
    } cases[] = {
        {"aal.nii.gz", "Colin 27"},
        {"AICHAmc.nii.gz", "MNI 152, earlier than NLin2009"},
        {"HarvardOxford-cort-maxprob-thr0-1mm.nii.gz", "MNI 152, earlier than NLin2009"},
        {"JHU-WhiteMatter-labels-1mm.nii.gz", "MNI 152, earlier than NLin2009"},
        {"natbrainlab.nii.gz", "MNI 152"},
        {"inia19-NeuroMaps.nii.gz", "the macaque INIA19"}}; /* by its voxels: code 1 and a grid of no template */
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_atlas *atlas = NULL;
        assert_ok(conus_atlas_load(&atlas, test_mricron(cases[i].file), NULL));
        assert_string_equal(conus_atlas_brain(atlas).words, cases[i].words);
        conus_atlas_destroy(atlas);
    }
}

/* Code 4 and the grid of AAL say Colin 27, half of the field takes that for MNI 152; Harvard-Oxford is known by its
 * voxels behind code 1; a sphere by nothing. A pack of the atlas warns once, too. */
static void a_statement_that_the_files_deny_is_warned_of(void **state)
{
    (void)state;
    static const struct {
        const char *file, *word, *warning;
    } cases[] = {
        {"aal.nii.gz", "none", "',template=none' says one person's own, but its files say Colin 27"},
        {"aal.nii.gz", "mni305", "',template=mni305' says MNI 305, but its files say Colin 27"},
        {"aal.nii.gz", "mni152", NULL},
        {"aal.nii.gz", "colin27", NULL},
        {"HarvardOxford-cort-maxprob-thr0-1mm.nii.gz", "none", "but its voxels are those of MNI 152"},
        {"HarvardOxford-cort-maxprob-thr0-1mm.nii.gz", "mni152", NULL},
        {"inia19-NeuroMaps.nii.gz", "mni152", "but its voxels are those of the macaque INIA19"},
        {NULL, "none", NULL},
    };
    char path[4096];
    char packed[4096];
    snprintf(packed, sizeof packed, "%s/stated.conus", test_scratch("brain"));
    assert_ok(conus_phantom_write("sphere", test_scratch("brain"), &(conus_phantom_options){.size = 16}));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (cases[i].file) {
            snprintf(path, sizeof path, "%s,template=%s", test_mricron(cases[i].file), cases[i].word);
        } else {
            snprintf(path, sizeof path, "%s/sphere.nii.gz,template=%s", test_scratch("brain"), cases[i].word);
        }
        for (int pass = 0; pass < 2; pass++) {
            conus_atlas *atlas = NULL;
            size_t warnings = 0;
            assert_ok(conus_atlas_load(&atlas, pass ? packed : path, NULL));
            for (size_t k = 0; k < conus_atlas_note_count(atlas); k++) {
                if (strstr(conus_atlas_note(atlas, k), ",template=")) {
                    assert_int_equal(conus_atlas_note_severity(atlas, k), CONUS_SEVERITY_WARNING);
                    assert_non_null(strstr(conus_atlas_note(atlas, k), cases[i].warning));
                    warnings++;
                }
            }
            assert_int_equal(warnings, cases[i].warning != NULL);
            assert_ok(pass ? CONUS_OK : conus_atlas_save(packed, atlas, NULL));
            conus_atlas_destroy(atlas);
        }
    }
}

/* The macaque's is no brain of MNI's, and no one person's; beside another template it may be the same. */
static void voxels_tell_an_animal_from_people(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("inia19-NeuroMaps.nii.gz"), NULL));
    const conus_brain_view ape = conus_atlas_brain(atlas);
    assert_int_equal(ape.brain, CONUS_BRAIN_TEMPLATE);
    assert_string_equal(ape.source, "voxels");
    for (conus_brain brain = CONUS_BRAIN_OWN; brain < CONUS_BRAIN_TEMPLATE; brain++) {
        const conus_brain_view other = {.brain = brain, .edition = "", .source = "header"};
        assert_int_equal(conus_brain_compare(ape, other), CONUS_BRAIN_GAP_OTHER);
        assert_int_equal(conus_brain_compare(other, ape), CONUS_BRAIN_GAP_OTHER);
    }
    const conus_brain_view template = {.brain = CONUS_BRAIN_TEMPLATE, .edition = "", .source = "header"};
    const conus_brain_view mouse = {.brain = CONUS_BRAIN_TEMPLATE, .edition = "", .source = "CCF"};
    assert_int_equal(conus_brain_compare(ape, template), CONUS_BRAIN_GAP_SOME_MM);
    const conus_brain_view named = {.brain = CONUS_BRAIN_TEMPLATE, .edition = "", .source = ""}; /* fsLR, UNCInfant */
    assert_int_equal(conus_brain_compare(named, ape), CONUS_BRAIN_GAP_OTHER);
    assert_int_equal(conus_brain_compare(ape, mouse), CONUS_BRAIN_GAP_OTHER);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(brain)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_grid_tells_in_every_order_and_direction),
        cmocka_unit_test(a_grid_nearby_does_not_tell),
        cmocka_unit_test(the_header_comes_before_the_grid),
        cmocka_unit_test(what_is_stated_holds_until_the_atlas_is_moved),
        cmocka_unit_test(a_manifest_states_it),
        cmocka_unit_test(real_atlases_are_known),
        cmocka_unit_test(a_statement_that_the_files_deny_is_warned_of),
        cmocka_unit_test(voxels_tell_an_animal_from_people),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
