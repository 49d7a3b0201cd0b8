/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables by other programs; tests/corpus/labels/ has small ones of each format. */
#include "base/files/file.h"
#include "loaders/labels/label_format.h"
#include "loaders/labels/labels.h"
#include "test.h"

/* Number of labels, first and last name of tables by other programs. */
static void real_tables_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *path, *format;
        size_t count;
        const char *first, *last;
    } files[] = {
        {"labels/bids/tpl-MNI152NLin2009cAsym_atlas-4S_scale-156_res-01_dseg.tsv", "BIDS label table", 156, "LH_Vis_1",
         "Cerebellar_Region10"},
        {"labels/bids/tpl-MNI152NLin6Asym_atlas-HOCPAL_dseg.tsv", "BIDS label table", 51, "Right Frontal Pole",
         "Right Occipital Pole"},
        {"labels/brainglobe/ccf25.structures.json", "BrainGlobe structures", 840,
         "Tuberomammillary nucleus, ventral part", NULL},
        {"labels/freesurfer/FreeSurferColorLUT.txt", "FreeSurfer colour table", 0, "Left-Cerebral-Exterior",
         "wm_rh_S_temporal_transverse"},
        {"labels/fsleyes-lut/harvard-oxford-cortical.lut", "FSLeyes colour table", 48, "Frontal Pole",
         "Occipital Pole"},
        {"labels/itksnap/MRIcrop-seg.label", "ITK-SNAP labels", 0, "vent-lat", "arteries"},
        {"labelvol/bigbrain-subcort/bigbrain.json", "NiiVue labels", 22, "Left-red-nucleus", "Right-amygdala"},
        {"labelvol/julich31/Julich.json", "NiiVue labels", 207, "Area 3b (PostCG)", "Area TeI (STG)"},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        struct job job = {0};
        struct label_table table = {0};
        const char *format = NULL;
        label_file_read(&job, &table, &format, test_shared(files[i].path), NULL);
        assert_ok(job_close(&job, NULL, NULL));
        assert_string_equal(format, files[i].format);
        assert_true(!files[i].count || files[i].count == table.count);
        assert_string_equal(table.entries[0].name, files[i].first);
        if (files[i].last) {
            assert_string_equal(table.entries[table.count - 1].name, files[i].last);
        }
        label_table_finish(&table);
    }
}

static void a_lut_beside_an_override_colours_it(void **state)
{
    (void)state;
    struct job job = {0};
    struct label_table table = {0};
    const char *format = NULL;
    label_file_read(&job, &table, &format, test_mricron("aal.nii.txt"), NULL);
    assert_ok(job_close(&job, NULL, NULL));
    assert_int_equal(table.count, 116);
    assert_string_equal(table.entries[115].name, "Vermis_10");
    assert_true(table.entries[0].has_rgb);
    assert_int_equal(table.entries[0].rgb[0], 204);
    label_table_finish(&table);
}

static void fsl_atlases_name_their_images(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        bool is_label;
        size_t images, labels;
        const char *image, *summary, *first;
    } files[] = {
        {"prob/fsl/atlases/JHU-labels.xml", true, 2, 48, "/JHU/JHU-ICBM-labels-1mm", "/JHU/JHU-ICBM-labels-1mm",
         "Middle cerebellar peduncle"},
        {"prob/fsl/atlases/JHU-tracts.xml", false, 2, 20, "/JHU/JHU-ICBM-tracts-prob-1mm",
         "/JHU/JHU-ICBM-tracts-maxprob-thr25-1mm", "Anterior thalamic radiation L"},
        {"prob/fsl/atlases/Thalamus.xml", false, 2, 7, "/Thalamus/Thalamus-prob-1mm",
         "/Thalamus/Thalamus-maxprob-thr25-1mm", "Primary motor"},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        struct bytes bytes = {0};
        struct job job = {0};
        assert_ok(file_read(&bytes, test_shared(files[i].path), 1 << 20));
        struct fsl_atlas *atlas = fsl_atlas_parse(&job, text_from_bytes(bytes.data, bytes.size));
        fsl_atlas_number(&job, atlas, &(struct label_use){0});
        assert_true(job_ok(&job));
        assert_int_equal(atlas->is_label, files[i].is_label);
        assert_int_equal(atlas->image_count, files[i].images);
        assert_int_equal(atlas->labels.count, files[i].labels);
        assert_string_equal(atlas->images[0].image, files[i].image);
        assert_string_equal(atlas->images[0].summary, files[i].summary);
        assert_int_equal(atlas->labels.entries[0].number, 1);
        assert_string_equal(atlas->labels.entries[0].name, files[i].first);
        job_end(&job);
        bytes_finish(&bytes);
    }
}

TEST_GROUP(labels)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(real_tables_are_read),
        cmocka_unit_test(a_lut_beside_an_override_colours_it),
        cmocka_unit_test(fsl_atlases_name_their_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
