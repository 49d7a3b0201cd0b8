/* SPDX-License-Identifier: BSD-3-Clause */
/* Names of the volumes of a 4-D file from a table beside it. The number of the first volume is never guessed. */
#include "base/buffer.h"
#include "builders/label_row.h"
#include "builders/nifti_builder.h"
#include "conus/file.h"
#include "conus/manifest.h"
#include "loaders/labels/label_volumes.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { VOLUMES = 3 };

static const conus_volume_info *info_of(size_t volume)
{
    static conus_volume_info info;
    static char path[4096];
    snprintf(path, sizeof path, "%s", test_in("p.nii.gz"));
    info = (conus_volume_info){.path = path, .volume = volume, .volume_count = VOLUMES};
    return &info;
}

/* The names of the volumes with '/' between them, "-" where there is none; the last note in `note`. */
static const char *names_beside(const char *file, const char *text, char note[512])
{
    static char all[256];
    row_text(test_in(file), text);
    all[0] = note[0] = '\0';
    for (size_t volume = 0; volume < VOLUMES; volume++) {
        struct job job = {0};
        const char *from;
        const char *name = label_volume_name(&job, &from, info_of(volume));
        assert_true(job_ok(&job));
        assert_int_equal(job.files.count, 0);
        assert_true(!from || strcmp(from, file) == 0);
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", volume ? "/" : "", name ? name : "-");
        snprintf(note, 512, "%s", job.notes.count ? job.notes.lines[job.notes.count - 1] : "");
        job_end(&job);
    }
    unlink(test_in(file));
    return all;
}

static void numbers_say_which_volume_it_is(void **state)
{
    (void)state;
    static const struct {
        const char *file, *text, *names;
    } cases[] = {
        {"p.txt", "1 AF\n2 CST\n3 UF\n", "AF/CST/UF"},
        {"p.txt", "0 AF\n1 CST\n2 UF\n", "AF/CST/UF"},
        {"p.txt", "3 UF\n1 AF\n2 CST\n", "AF/CST/UF"},
        {"p.txt", "0 Background\n1 AF\n2 CST\n3 UF\n", "AF/CST/UF"},
        {"p.txt", "0 Background\n1 CSF\n2 GM\n", "Background/CSF/GM"},
        {"p.txt", "AF\nCST\n\nUF left\n", "AF/CST/UF left"},
        {"p.nii.txt", "# tracts\nAF\nCST\nUF\n", "AF/CST/UF"},
        {"p.tsv", "index\tname\n0\tAF\n1\tCST\n2\tUF\n", "AF/CST/UF"},
        {"p.csv", "1,AF\n2,CST\n3,UF\n", "AF/CST/UF"},
        {"p.json", "{\"0\": \"AF\", \"1\": \"CST\", \"2\": \"UF\"}", "AF/CST/UF"},
    };
    char note[512];
    test_folder("numbers");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_string_equal(names_beside(cases[i].file, cases[i].text, note), cases[i].names);
        assert_string_equal(note, "");
    }
}

static void what_does_not_decide_names_nothing(void **state)
{
    (void)state;
    static const char *const refused[] = {
        "1 AF\n2 CST\n",               /* too few: from 0 or from 1? */
        "1 AF\n2 CST\n4 UF\n",         /* a gap */
        "2 AF\n3 CST\n4 UF\n",         /* numbers from 2 on */
        "0 AF\n1 CST\n2 UF\n3 SLF\n",  /* 0 is no background: one too many */
        "1 AF\n2 CST\n3 UF\n4 SLF\n",  /* one too many */
        "1 AF\n2 AF\n3 UF\n",          /* one name twice */
        "1 AF\n1 SLF\n2 CST\n3 UF\n",  /* one number twice */
        "0 AF\n0 SLF\n1 CST\n2 UF\n",  /* likewise */
        "1 AF\n2 CST\n3\n",            /* one without a name */
        "Tract 1\nTract 2\nTract 3\n", /* is "Tract" the name? */
    };
    static const char *const silent[] = {
        "AF\nCST\n", "AF\nCST\nUF\nSLF\n", "AF\n2\nUF\n", "0.5\n0.25\n1\n", "{\"TR\": 1}", "<a>\nb\nc\n", ""};
    char note[512];
    test_folder("open");
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        assert_string_equal(names_beside("p.txt", refused[i], note), "-/-/-");
        assert_string_equal(note, "p.txt is not used for the names of the volumes: needed is another name for each "
                                  "number from 0 to 2, or from 1 to 3");
    }
    for (size_t i = 0; i < sizeof silent / sizeof silent[0]; i++) {
        assert_string_equal(names_beside("p.txt", silent[i], note), "-/-/-");
        assert_string_equal(note, "");
    }
    assert_string_equal(names_beside("p.txt", "1 AF\n2.5 CST\n3 UF\n", note), "-/-/-");
    assert_non_null(strstr(note, "p.txt: passed over: MRIcron text: line 2: label \"2.5\""));
    assert_string_equal(names_beside("q.txt", "1 AF\n2 CST\n3 UF\n", note), "-/-/-"); /* the table is of another file */
}

static void every_prefix_is_read_or_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"AF\nCST\nUF left\n", "0 AF\n1 CST\n2 UF\n", "{\"1\": \"AF\", \"2\": \"CST\"}"};
    char note[512];
    char text[64];
    test_folder("prefix");
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        for (size_t size = 0; size < strlen(texts[i]); size++) {
            snprintf(text, sizeof text, "%.*s", (int)size, texts[i]);
            (void)names_beside("p.txt", text, note); /* asserts that it is no error */
        }
    }
}

/* Three volumes of two voxels, 50 and 100. */
static void write_volumes(void)
{
    struct nifti_builder file;
    nifti_begin(&file, 1, false, 2, (const int64_t[3]){2, 1, 1});
    nifti_set(&file, "dim", 0, 4);
    nifti_set(&file, "dim", 4, VOLUMES);
    for (int i = 0; i < 2 * VOLUMES; i++) {
        nifti_voxel(&file, 50 + 50 * (i % 2));
    }
    assert_ok(conus_write_file(test_in("p.nii"), file.bytes.data, file.bytes.size));
    buffer_finish(&file.bytes);
}

static conus_status add_second(void *data)
{
    conus_atlas *atlas = NULL;
    const conus_pathway_options options = {.threshold = 1};
    char path[4096];
    snprintf(path, sizeof path, "%s,volume=1", test_in("p.nii"));
    conus_status status = conus_atlas_load(&atlas, test_in("v.nii"), NULL);
    status = status ? status : conus_atlas_add_pathway(atlas, path, &options);
    if (!status) {
        snprintf(data, 64, "%s", conus_atlas_object(atlas, conus_atlas_object_count(atlas))->name);
    }
    conus_atlas_destroy(atlas);
    return status;
}

static void a_manifest_has_these_names(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    test_folder("written");
    write_volumes();
    row_text(test_in("p.txt"), "AF\nCST\nUF\n");
    assert_ok(conus_manifest_write(test_in("s.atlas.json"), NULL));
    assert_ok(conus_atlas_load(&atlas, test_in("s.atlas.json"), NULL));
    assert_int_equal(conus_atlas_object_count(atlas), VOLUMES);
    assert_string_equal(conus_atlas_object(atlas, 1)->name, "AF");
    assert_string_equal(conus_atlas_object(atlas, 3)->name, "UF");
    conus_atlas_destroy(atlas);
}

static void pathways_bear_these_names(void **state)
{
    (void)state;
    char name[64];
    test_folder("pathways");
    row_write("v.nii", 3, 1, NULL);
    write_volumes();
    assert_ok(add_second(name));
    assert_string_equal(name, "p,volume=1");
    row_text(test_in("p.txt"), "0 AF\n1 CST\n2 UF\n");
    assert_ok(add_second(name));
    assert_string_equal(name, "CST");
    test_every_allocation(add_second, name);
    row_text(test_in("a.xml"), "<atlas><type>Probabilistic</type><images><imagefile>/p</imagefile></images>"
                               "<label index=\"1\">cst</label></atlas>");
    assert_ok(add_second(name)); /* both say so */
    assert_string_equal(name, "cst");
    row_text(test_in("p.txt"), "0 UF\n1 AF\n2 CST\n");
    assert_fails(add_second(name), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "volume 1 is \"cst\" in a.xml, \"AF\" in p.txt; name it"));
}

TEST_GROUP(label_volumes)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_say_which_volume_it_is),  cmocka_unit_test(what_does_not_decide_names_nothing),
        cmocka_unit_test(every_prefix_is_read_or_refused), cmocka_unit_test(a_manifest_has_these_names),
        cmocka_unit_test(pathways_bear_these_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
