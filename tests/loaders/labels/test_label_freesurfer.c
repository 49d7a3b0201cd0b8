/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer's volumes away from their colour table, and other volumes with such names. */
#include "base/memory.h"
#include "builders/label_row.h"
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define TABLE                                                                                                          \
    "1 Left-Cerebral-Exterior 1 1 1 0\n2 Left-White 2 2 2 0\n3 Left-Cortex 3 3 3 0\n10 Left-Thalamus 4 4 4 0\n"        \
    "17 Left-Hippocampus 5 5 5 0\n41 Right-White 6 6 6 0\n42 Right-Cortex 7 7 7 0\n49 Right-Thalamus 8 8 8 0\n"        \
    "53 Right-Hippocampus 9 9 9 0\n174 Pons 1 1 1 0\n2001 ctx-rh-bankssts 1 1 1 0\n"

/* A volume of a row of voxels, `step` mm to the right of each other (to the left if negative), with these labels. */
static void write_labels(const char *name, int step, const int *labels, size_t count)
{
    struct nifti_builder file;
    const int64_t dim[3] = {(int64_t)count, 1, 1};
    nifti_begin(&file, 1, false, 4, dim);
    for (size_t i = 0; i < 12; i++) {
        nifti_set(&file, "srow", i, i == 0 ? step : i % 5 == 0 ? 1 : 0);
    }
    for (size_t i = 1; i < 4; i++) {
        nifti_set(&file, "pixdim", i, 1);
    }
    for (size_t i = 0; i < count; i++) {
        nifti_voxel(&file, labels[i]);
    }
    assert_ok(conus_write_file(test_in(name), file.bytes.data, file.bytes.size));
    buffer_finish(&file.bytes);
}

#define WRITE(name, step, ...)                                                                                         \
    write_labels(name, step, (const int[]){__VA_ARGS__}, sizeof((const int[]){__VA_ARGS__}) / sizeof(int))

static const char source[] = "FreeSurfer colour table in FreeSurferColorLUT.txt";
static const char own_source[] = "FreeSurfer's names, which conus has";

/* The folder is SUBJECTS/SUBJECT/mri/, and FreeSurfer elsewhere. */
static void begin(const char *name)
{
    char path[4096];
    test_folder(name);
    snprintf(path, sizeof path, "%s/home", test_in(""));
    assert_int_equal(mkdir(path, 0700), 0);
    row_text(test_in("home/FreeSurferColorLUT.txt"), TABLE);
    assert_int_equal(setenv("FREESURFER_HOME", path, 1), 0);
}

static void volumes_of_freesurfer_find_its_table(void **state)
{
    (void)state;
    static const char *const names[] = {"aseg.nii",   "aparc+aseg.nii", "aparc.a2009s+aseg.nii",
                                        "wmparc.nii", "ribbon.nii",     "sub-1_desc-aparcaseg_dseg.nii"};
    begin("found");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        WRITE(names[i], 1, 0, 2, 3, 17, 2001, 41, 42, 53);
        assert_row_of(names[i], "Left-Hippocampus", 17, source, "its labels lie as FreeSurfer's do: named by ");
        assert_row_of(names[i], "ctx-rh-bankssts", 2001, source, "home/FreeSurferColorLUT.txt; --labels chooses");
        WRITE(names[i], -1, 53, 42, 41, 2001, 17, 3, 2, 0); /* stored from right to left */
        assert_row_of(names[i], "Left-Hippocampus", 17, source, "its labels lie as");
    }
    WRITE("brainstemSsLabels.v12.nii", 1, 0, 174, 175);
    assert_row_of("brainstemSsLabels.v12.nii", "Pons", 174, source, "its labels lie as");
}

static void the_table_may_lie_in_other_places(void **state)
{
    (void)state;
    begin("places");
    WRITE("aseg.nii", 1, 0, 2, 3, 41, 42);
    assert_int_equal(mkdir(test_in("home/luts"), 0700), 0);
    assert_int_equal(rename(test_in("home/FreeSurferColorLUT.txt"), test_in("home/luts/FreeSurferColorLUT.txt")), 0);
    assert_row_of("aseg.nii", "Left-Cortex", 3, source, "home/luts/FreeSurferColorLUT.txt");
    unsetenv("FREESURFER_HOME");
    assert_row_of("aseg.nii", "Left-Cerebral-Cortex", 3, own_source, "FreeSurfer's names");
    WRITE("sclimbic.nii", 1, 0, 26, 821, 58, 822); /* of FreeSurfer 8 */
    assert_row_of("sclimbic.nii", "Left-Fornix", 821, own_source, "FreeSurfer's names");
    WRITE("vsinus.nii", 1, 0, 6111, 6115);
    assert_row_of("vsinus.nii", "Straight-Sinus", 6115, own_source, "FreeSurfer's names");
    WRITE("vsinus.nii", 1, 0, 26, 58); /* the accumbens alone is nobody's mark */
    assert_row_of("vsinus.nii", "26", 26, "none found", NULL);
    assert_int_equal(mkdir(test_in("subjects"), 0700), 0);
    assert_int_equal(mkdir(test_in("subjects/one"), 0700), 0);
    assert_int_equal(mkdir(test_in("subjects/one/mri"), 0700), 0);
    WRITE("subjects/one/mri/aseg.nii", 1, 0, 2, 3, 41, 42);
    row_text(test_in("FreeSurferColorLUT.txt"), TABLE);
    assert_row_of("subjects/one/mri/aseg.nii", "Left-Cortex", 3, source, "/../../../FreeSurferColorLUT.txt");
    row_text(test_in("subjects/one/mri/aseg.txt"), "3 Mine\n2 Other\n"); /* its own name counts more */
    assert_row_of("subjects/one/mri/aseg.nii", "Mine", 3, "MRIcron text in aseg.txt", NULL);
}

/* Every label of each volume has a name in FreeSurfer's table, but no volume is FreeSurfer's. */
static void what_is_not_freesurfers_keeps_its_numbers(void **state)
{
    (void)state;
    static const char *const names[] = {"HCPMMP1.nii",        "myaseg.nii", "aseg_mouse.nii", "lh.ribbon.nii",
                                        "desc-aseg_mask.nii", "aparc.nii",  "seg.nii"};
    begin("friends");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) { /* in FreeSurfer's order, but of another name */
        WRITE(names[i], 1, 0, 2, 3, 17, 41, 42, 53);
        assert_row_of(names[i], "17", 17, "none found", NULL);
    }
    static const char note[] = "but its labels do not lie as FreeSurfer's do";
    WRITE("aseg.nii", 1, 0, 1, 2, 3, 10, 17, 41, 42, 49, 53); /* counts from 1 */
    assert_row_of("aseg.nii", "17", 17, "none found", note);
    WRITE("aseg.nii", 1, 0, 41, 3, 17, 2, 42, 53); /* 2 is right of 41 */
    assert_row_of("aseg.nii", "17", 17, "none found", note);
    WRITE("aseg.nii", 1, 0, 2, 41, 17, 10); /* one pair only */
    assert_row_of("aseg.nii", "17", 17, "none found", note);
    WRITE("aseg.nii", 1, 0, 2001, 2002); /* AAL's codes */
    assert_row_of("aseg.nii", "2001", 2001, "none found", note);
    WRITE("ThalamicNuclei.nii", 1, 0, 2, 174);
    assert_row_of("ThalamicNuclei.nii", "174", 174, "none found", note);
}

/* The real table, with labels of a made-up volume, in the places where it is installed. */
static void the_real_table_is_found(void **state)
{
    (void)state;
    char home[4096];
    snprintf(home, sizeof home, "%s", test_shared("labels/freesurfer/FreeSurferColorLUT.txt"));
    *strrchr(home, '/') = '\0';
    test_folder("real");
    WRITE("aparc+aseg.nii", 1, 0, 2, 17, 1001, 2001, 41, 53);
    assert_int_equal(setenv("FREESURFER_HOME", home, 1), 0);
    assert_row_of("aparc+aseg.nii", "ctx-lh-bankssts", 1001, source, "named by");
    assert_row_of("aparc+aseg.nii", "Right-Hippocampus", 53, source, "named by");
    unsetenv("FREESURFER_HOME");
}

/* A row of all labels of the real table, with it and without: where conus has a name, it and the colour are those. */
static void names_without_a_table_are_those_of_the_real_one(void **state)
{
    (void)state;
    enum { LABELS_MOST = 4096 };
    static int labels[LABELS_MOST];
    char home[4096];
    char line[512];
    conus_atlas *atlases[2] = {NULL, NULL};
    size_t count = 1;
    size_t named = 0;
    snprintf(home, sizeof home, "%s", test_shared("labels/freesurfer/FreeSurferColorLUT.txt"));
    FILE *table = fopen(home, "r");
    assert_non_null(table);
    while (fgets(line, sizeof line, table)) {
        long label = strtol(line, NULL, 10);
        for (int i = 0; label > 1 && count < LABELS_MOST && i < 2; i++) { /* areas have neighbours */
            labels[count++] = (int)label;
        }
    }
    fclose(table);
    *strrchr(home, '/') = '\0';
    test_folder("own");
    write_labels("wmparc.nii", 1, labels, count);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(i ? setenv("FREESURFER_HOME", home, 1) : unsetenv("FREESURFER_HOME"), 0);
        assert_ok(conus_atlas_load(&atlases[i], test_in("wmparc.nii"), NULL));
    }
    for (size_t i = 1; i <= conus_atlas_object_count(atlases[0]); i++) {
        const conus_object *own = conus_atlas_object(atlases[0], i);
        for (size_t k = 1; own->named && k <= conus_atlas_object_count(atlases[1]); k++) {
            const conus_object *real = conus_atlas_object(atlases[1], k);
            if (real->label == own->label) {
                assert_string_equal(own->name, real->name);
                assert_memory_equal(own->rgb, real->rgb, sizeof own->rgb);
                named++;
            }
        }
    }
    assert_int_equal(named, 834); /* all but label 1, which no volume of FreeSurfer has */
    conus_atlas_destroy(atlases[0]);
    conus_atlas_destroy(atlases[1]);
    unsetenv("FREESURFER_HOME");
}

static conus_status load(void *data)
{
    (void)data;
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, test_in("aseg.nii"), NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    begin("memory");
    WRITE("aseg.nii", 1, 0, 2, 3, 41, 42);
    test_every_allocation(load, NULL);
    WRITE("aseg.nii", 1, 0, 1, 3, 41, 42);
    test_every_allocation(load, NULL);
    unsetenv("FREESURFER_HOME");
    WRITE("aseg.nii", 1, 0, 2, 3, 41, 42);
    test_every_allocation(load, NULL);
}

TEST_GROUP(label_freesurfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_of_freesurfer_find_its_table),
        cmocka_unit_test(the_table_may_lie_in_other_places),
        cmocka_unit_test(what_is_not_freesurfers_keeps_its_numbers),
        cmocka_unit_test(the_real_table_is_found),
        cmocka_unit_test(names_without_a_table_are_those_of_the_real_one),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
