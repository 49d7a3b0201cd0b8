/* SPDX-License-Identifier: BSD-3-Clause */
/* The one list of endings, and that of the page, which is not of C and follows it. */
#include "sources/names.h"

#include "test.h"

#include <stdio.h>
#include <string.h>

static void the_longest_ending_counts(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        unsigned roles;
        const char *ending; /* by the formats' own descriptions */
    } names[] = {
        {"aal.nii.gz", ROLE_VOLUME, ".nii.gz"},
        {"aal.NII", ROLE_VOLUME, ".NII"},
        {"x.seg.nrrd", ROLE_VOLUME, ".seg.nrrd"},
        {"x+tlrc.BRIK.gz", ROLE_VOLUME, ".BRIK.gz"},
        {"x.gz", ROLES_ATLAS, ""},
        {".nii", ROLE_VOLUME, ""},
        {"x.dlabel.nii", ROLE_VOLUME, ".nii"},
        {"x.dlabel.nii", ROLES_ATLAS, ".dlabel.nii"},
        {"lh.pial", ROLES_ATLAS, ""},
        {"lh.surf.gii", ROLE_SURFACE, ".surf.gii"},
        {"lh.surf.gii", ROLE_VERTEX_LABELS, ".gii"},
        {"x.atlas.json", ROLES_ATLAS, ".atlas.json"},
        {"x.atlas.json", ROLE_POSES, ".json"},
        {"fibres.tt.gz", ROLE_TRACTS, ".tt.gz"},
        {"fibres.tt.gz", ROLE_VOLUME, ""},
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const size_t length = strlen(names[i].name);
        const size_t ending = ending_length(names[i].name, length, names[i].roles);
        assert_string_equal(names[i].name + length - ending, names[i].ending);
    }
    assert_int_equal(ending_length("aal.nii.gz,map=2", 10, ROLE_VOLUME), 7);
    assert_int_equal(stem_length("lh.pial.gz", 10, ROLE_SURFACE), 7);
    assert_int_equal(volume_stem_length("tables.txt.gz"), 13);
}

/* Labels of a folder of surfaces are numbers in this order: an atlas that is recorded keeps them. */
static void surfaces_come_in_their_order(void **state)
{
    (void)state;
    char all[256] = "";
    for (const char *ending = NULL; (ending = ending_next(ending, ROLE_SURFACE));) {
        const size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s ", ending);
    }
    assert_string_equal(all, ".surf.gii .gii .obj .ply .stl .off .mz3 .vtk .vtp ");
    assert_null(ending_next(NULL, ROLE_REGION));
}

/* Whether @p list, a line of a source, has the ending between quotes; *at is where. */
static bool has_ending(const char **at, const char *list, const char *ending)
{
    char quoted[32] = "\"";
    const size_t length = strlen(ending);
    for (size_t i = 0; i < length; i++) {
        quoted[i + 1] = (char)(ending[i] >= 'A' && ending[i] <= 'Z' ? ending[i] - 'A' + 'a' : ending[i]);
    }
    quoted[length + 1] = '"';
    *at = strstr(list, quoted);
    return *at;
}

/* What @p file, as far as it is looked at, has from @p start up to @p end. */
static const char *read_list(const char *file, const char *start, char end, char out[1024])
{
    char text[4096];
    FILE *in = fopen(file, "rb");
    assert_non_null(in);
    text[fread(text, 1, sizeof text - 1, in)] = '\0';
    fclose(in);
    const char *list = strstr(text, start);
    assert_non_null(list);
    snprintf(out, 1024, "%.*s", (int)strcspn(list, (char[]){end, '\0'}), list);
    return out;
}

static void the_page_has_them_too(void **state)
{
    (void)state;
    char list[1024];
    const char *before = read_list(CONUS_SOURCE_DIR "/apps/web/page/files.js", "const ATLASES = [", ']', list);
    for (const char *ending = NULL; (ending = ending_next(ending, ROLES_ATLAS | ROLE_TRACTS));) {
        const char *at;
        const bool lies_beside = !strcmp(ending, ".json") || !strcmp(ending, ".label") || !strcmp(ending, ".conus");
        assert_int_equal(has_ending(&at, list, ending), !lies_beside);
        assert_true(lies_beside || at > before); /* in the same order */
        before = lies_beside ? before : at;
    }
}

TEST_GROUP(endings)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_longest_ending_counts),
        cmocka_unit_test(surfaces_come_in_their_order),
        cmocka_unit_test(the_page_has_them_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
