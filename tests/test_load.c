/* SPDX-License-Identifier: BSD-3-Clause */
#include "conus/conus.h"
#include "test.h"

#include <string.h>

static bool has_note(const conus_atlas *atlas, const char *part)
{
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        if (strstr(conus_atlas_note(atlas, i), part)) {
            return true;
        }
    }
    return false;
}

static void the_aal_atlas_has_its_names_and_colours(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 116);
    const conus_object *first = conus_atlas_object(atlas, 1);
    assert_string_equal(first->name, "Precentral_L");
    assert_int_equal(first->rgb[0], 204);
    assert_string_equal(conus_atlas_label_source(atlas), "MRIcron text in aal.nii.txt, colours in aal.nii.lut");
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    assert_int_equal(info->role, CONUS_PARCELLATION);
    assert_int_equal(strlen(info->sha256), 64);
    conus_atlas_destroy(atlas);
}

/* Each labelled volume of mricron: areas, and where their names come from. */
static void every_mricron_atlas_finds_its_table(void **state)
{
    (void)state;
    static const struct {
        const char *name, *source, *first;
        size_t areas;
    } atlases[] = {
        {"AICHAmc.nii.gz", "MRIcron text in AICHAmc.nii.txt, colours in AICHAmc.nii.lut", "G_Frontal_Sup-1", 192},
        {"HarvardOxford-cort-maxprob-thr0-1mm.nii.gz", "MRIcron text inside HarvardOxford-cort-maxprob-thr0-1mm.nii.gz",
         "Frontal Pole", 48},
        {"JHU-WhiteMatter-labels-1mm.nii.gz",
         "MRIcron text in JHU-WhiteMatter-labels-1mm.nii.txt, colours in JHU-WhiteMatter-labels-1mm.nii.lut",
         "Middle_cerebellar_peduncle", 48},
        {"brodmann.nii.gz", "none found, colours in brodmann.nii.lut", "1", 41},
        {"inia19-NeuroMaps.nii.gz", "MRIcron text inside inia19-NeuroMaps.nii.gz", "l_occipital_gyrus_(macaque)", 0},
        {"jhu189.nii.gz", "MRIcron text inside jhu189.nii.gz", "SFG_L", 189},
        {"natbrainlab.nii.gz", "MRIcron text inside natbrainlab.nii.gz", "Anterior_Commissure_Left", 0},
    };
    for (size_t i = 0; i < sizeof atlases / sizeof atlases[0]; i++) {
        conus_atlas *atlas = NULL;
        assert_ok(conus_atlas_load(&atlas, test_mricron(atlases[i].name), NULL));
        assert_string_equal(conus_atlas_label_source(atlas), atlases[i].source);
        assert_string_equal(conus_atlas_object(atlas, 1)->name, atlases[i].first);
        assert_true(!atlases[i].areas || conus_atlas_object_count(atlas) == atlases[i].areas);
        conus_atlas_destroy(atlas);
    }
}

static void an_atlas_without_names_is_called_by_numbers(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("brodmann.nii.gz"), NULL));
    const conus_object *area = conus_atlas_object(atlas, 1);
    assert_false(area->named);
    assert_int_equal(area->label, 1);
    assert_int_equal(area->rgb[0], 203);
    assert_true(has_note(atlas, "no label table found"));
    assert_false(has_note(atlas, "does not name"));
    conus_atlas_destroy(atlas);
}

static void arguments_are_checked(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, NULL, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_load(NULL, "x", NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_load(&atlas, "no-such-file.nii", NULL), CONUS_ERROR_IO);
    assert_null(atlas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_aal_atlas_has_its_names_and_colours),
        cmocka_unit_test(every_mricron_atlas_finds_its_table),
        cmocka_unit_test(an_atlas_without_names_is_called_by_numbers),
        cmocka_unit_test(arguments_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
