/* SPDX-License-Identifier: BSD-3-Clause */
/* Left and right areas: words for sides in names, pairs, merging and splitting (Eq. 10). */
#include "atlas/areas/areas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* The name without its word for the side, "-" where it has none. */
static const char *common(const char *left, const char *right)
{
    static char text[128];
    struct buffer name = {0};
    hemispheres_common_name(&name, left, right);
    snprintf(text, sizeof text, "%s", name.data ? name.data : "-");
    buffer_finish(&name);
    return text;
}

static void names_of_pairs_have_a_common_part(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"Precentral_L", "Precentral_R", "Precentral"},
        {"Cerebelum_4_5_L", "Cerebelum_4_5_R", "Cerebelum_4_5"},
        {"Cingulum_(hippocampus)_L", "Cingulum_(hippocampus)_R", "Cingulum_(hippocampus)"},
        {"hippo-L", "hippo-R", "hippo"},
        {"Thalamus.L", "Thalamus.R", "Thalamus"},
        {"L_V1_ROI", "R_V1_ROI", "V1_ROI"},
        {"L", "R", ""},
        {"SFG_L_7_1", "SFG_R_7_1", "SFG_7_1"},
        {"Area hOc1 (V1, 17, CalcS) left", "Area hOc1 (V1, 17, CalcS) right", "Area hOc1 (V1, 17, CalcS)"},
        {"Arcuate_Anterior_Segment_Left", "Arcuate_Anterior_Segment_Right", "Arcuate_Anterior_Segment"},
        {"Left-Cerebral-White-Matter", "Right-Cerebral-White-Matter", "Cerebral-White-Matter"},
        {"Left Frontal Pole", "Right Frontal Pole", "Frontal Pole"},
        {"ctx-lh-insula", "ctx-rh-insula", "ctx-insula"},
        {"wm-lh-insula", "wm-rh-insula", "wm-insula"},
        {"ctx_lh_G_precuneus", "ctx_rh_G_precuneus", "ctx_G_precuneus"},
        {"lh.af", "rh.af", "af"},
        {"lh_PoC-PrC_0", "rh_PoC-PrC_0", "PoC-PrC_0"},
        {"LH_Vis_1", "RH_Vis_1", "Vis_1"},
        {"7Networks_LH_Vis_1", "7Networks_RH_Vis_1", "7Networks_Vis_1"},
        {"LH-Pulvinar", "RH-Pulvinar", "Pulvinar"},
        {"Cbm_Left_CrusI", "Cbm_Right_CrusI", "Cbm_CrusI"},
        {"left_CA2_3", "right_CA2_3", "CA2_3"},
        {"l_lingual_gyrus", "r_lingual_gyrus", "lingual_gyrus"},
        {"Thalamus, left", "Thalamus, right", "Thalamus"},
        {"Thalamus (L)", "Thalamus (R)", "Thalamus"},
        {"Area (IFG left)", "Area (IFG right)", "Area (IFG)"},
        {"Area [left, IFG]", "Area [right, IFG]", "Area [IFG]"},
        {"V1", "V1", "V1"},
        {"Pr\xc3\xa9"
         "central_L",
         "Pr\xc3\xa9"
         "central_R",
         "Pr\xc3\xa9"
         "central"},
        {"IPL_PFm_l", "IPL_PFm_r", "IPL_PFm"},
        {"12_l_b", "12_r_b", "-"}, /* small letters may be lateral and rostral */
        {"Left-Thalamus", "right-Thalamus", "-"},
        {"Lobule", "Robule", "-"},
        {"leftover", "rightover", "-"},
        {"Precentral_R", "Precentral_S", "-"},
        {"VPL", "VPR", "-"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_string_equal(common(cases[i][0], cases[i][1]), cases[i][2]);
    }
}

static const size_t dim[3] = {8, 2, 1}; /* x from -3.5 to 3.5 */
static const uint32_t labels[16] = {1, 1, 1, 2, 1, 2, 2, 2, 3, 3, 3, 3, 4, 4, 0, 0};

/* "left|right" of every pair, with commas between. */
static const char *pairs_of(const struct area_row *rows)
{
    static char text[512];
    conus_atlas *atlas = NULL;
    uint32_t *right_of = NULL;
    text[0] = '\0';
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(hemispheres_pair(&right_of, atlas));
    for (uint32_t left = 1; left <= atlas->area_count; left++) {
        size_t used = strlen(text);
        if (right_of[left]) {
            snprintf(text + used, sizeof text - used, "%s%u|%u", used ? "," : "", atlas->objects[left - 1].label,
                     atlas->objects[right_of[left] - 1].label);
        }
    }
    memory_free(right_of);
    conus_atlas_destroy(atlas);
    return text;
}

static void pairs_are_sure_or_none(void **state)
{
    (void)state;
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A_L", 0, NULL, 0}, {2, "A_R", 0, NULL, 0}, {0}}),
                        "1|2");
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A_R", 0, NULL, 0}, {2, "A_L", 0, NULL, 0}, {0}}),
                        "2|1");
    /* by the table's column, in either order */
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A", 0, NULL, 'R'}, {2, "A", 0, NULL, 'L'}, {0}}),
                        "2|1");
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A", 0, NULL, 'L'}, {2, "A", 0, NULL, 0}, {0}}), "");
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A", 0, NULL, 'L'}, {2, "A", 0, NULL, 'L'}, {0}}), "");
    /* a name that occurs twice */
    assert_string_equal(pairs_of((const struct area_row[]){
                            {1, "A_L", 0, NULL, 0}, {2, "A_R", 0, NULL, 0}, {3, "A_R", 0, NULL, 0}, {0}}),
                        "");
    /* the table contradicts the name */
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A_L", 0, NULL, 'R'}, {2, "A_R", 0, NULL, 0}, {0}}), "");
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A_L", 0, NULL, 0}, {2, "A_R", 0, NULL, 'B'}, {0}}), "");
    /* two words for sides: either could be the one */
    assert_string_equal(pairs_of((const struct area_row[]){
                            {1, "L_A_L", 0, NULL, 0}, {2, "R_A_L", 0, NULL, 0}, {3, "L_A_R", 0, NULL, 0}, {0}}),
                        "");
    assert_string_equal(pairs_of((const struct area_row[]){{1, "L_A_L", 0, NULL, 0}, {2, "R_A_L", 0, NULL, 0}, {0}}),
                        "1|2");
}

static void pairs_have_the_same_place_in_the_tree(void **state)
{
    (void)state;
    assert_string_equal(pairs_of((const struct area_row[]){
                            {1, "A_L", 9, NULL, 0}, {2, "A_R", 9, NULL, 0}, {9, "Top", 0, NULL, 0}, {0}}),
                        "1|2");
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A_L", 8, NULL, 0},
                                                           {2, "A_R", 9, NULL, 0},
                                                           {8, "Left side", 0, NULL, 0},
                                                           {9, "Right side", 0, NULL, 0},
                                                           {0}}),
                        "1|2,8|9");
    assert_string_equal(
        pairs_of((const struct area_row[]){
            {1, "A_L", 8, NULL, 0}, {2, "A_R", 9, NULL, 0}, {8, "Top", 0, NULL, 0}, {9, "Bottom", 0, NULL, 0}, {0}}),
        "");
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A_L", 2, NULL, 0}, {2, "A_R", 0, NULL, 0}, {0}}), "");
    /* the parents' pair fails further up */
    assert_string_equal(pairs_of((const struct area_row[]){{1, "A_L", 3, NULL, 0},
                                                           {2, "A_R", 4, NULL, 0},
                                                           {3, "B_L", 8, NULL, 0},
                                                           {4, "B_R", 0, NULL, 0},
                                                           {8, "Top", 0, NULL, 0},
                                                           {0}}),
                        "");
}

/* The name under which each voxel is reported, with bars between. */
static const char *reported(const conus_atlas *atlas, const char *spec)
{
    static char text[1024];
    struct level *level = NULL;
    text[0] = '\0';
    assert_ok(level_create(&level, atlas, spec));
    for (size_t i = 0; i < atlas->volumes[0].voxel_count; i++) {
        const conus_object *area = conus_atlas_object(atlas, level_group(level)[volume_object(&atlas->volumes[0], i)]);
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%s", i ? "|" : "", area ? area->name : "-");
    }
    size_t last = conus_atlas_object_count(atlas);
    if (conus_atlas_object(atlas, last)->kind == CONUS_KIND_PATHWAY) {
        assert_int_equal(level_group(level)[last], last);
    }
    level_destroy(level);
    return text;
}

static void pairs_are_reported_as_one(void **state)
{
    (void)state;
    static const struct area_row rows[] = {
        {1, "A_L", 0, "alL", 0}, {2, "A_R", 0, "alR", 0}, {3, "B_L", 0, NULL, 0}, {4, "Middle", 0, NULL, 0}, {0}};
    conus_atlas *atlas = NULL;
    struct level *level = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(area_rows_add_pathway(atlas, "CST"));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_AS_IS));
    assert_int_equal(conus_atlas_object_count(atlas), 5);
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED));
    assert_int_equal(conus_atlas_object_count(atlas), 6);
    const conus_object *pair = conus_atlas_object(atlas, 5);
    assert_string_equal(pair->name, "A");
    assert_string_equal(pair->abbreviation, "al");
    assert_int_equal(pair->label, 31);
    assert_int_equal(pair->hemisphere, 'B');
    assert_int_equal(pair->voxels, 0);
    assert_memory_equal(pair->rgb, conus_atlas_object(atlas, 1)->rgb, 3);
    assert_int_equal(conus_atlas_object(atlas, 1)->parent, 5);
    assert_int_equal(conus_atlas_object(atlas, 2)->parent, 5);
    assert_int_equal(conus_atlas_object(atlas, 3)->parent, 0);
    assert_string_equal(conus_atlas_object(atlas, 6)->name, "CST");
    assert_int_equal(conus_atlas_object(atlas, 6)->label, 1);
    assert_int_equal(volume_object(&atlas->volumes[1], 7), 6);
    assert_string_equal(reported(atlas, NULL), "A|A|A|A|A|A|A|A|B_L|B_L|B_L|B_L|Middle|Middle|-|-");
    assert_true(test_has_note(
        atlas, "hemispheres: 1 pairs are reported as one area each; without a counterpart: 2 (B_L, Middle)"));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_ARGUMENT);
    assert_fails(level_create(&level, atlas, "1"), CONUS_ERROR_ARGUMENT); /* still no tree */
    assert_non_null(strstr(conus_message(), "no area tree"));
    conus_atlas_destroy(atlas);
}

/* Sides with their own subtrees: 8 and 9 are a pair, A_L and A_R below them, and Spot lies only on the left. */
static const struct area_row sided[] = {
    {1, "A_L", 8, NULL, 0}, {2, "A_R", 9, NULL, 0},       {3, "Spot", 8, NULL, 0},       {4, "Middle", 7, NULL, 0},
    {7, "All", 0, NULL, 0}, {8, "Left side", 7, NULL, 0}, {9, "Right side", 7, NULL, 0}, {0, NULL, 0, NULL, 0}};

static void merging_composes_with_a_level(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct level *level = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, sided));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED));
    assert_string_equal(reported(atlas, NULL), "A|A|A|A|A|A|A|A|Spot|Spot|Spot|Spot|Middle|Middle|-|-");
    assert_string_equal(reported(atlas, "3"), reported(atlas, NULL)); /* All, side, A: a pair has one depth */
    assert_string_equal(reported(atlas, "2"),
                        "side|side|side|side|side|side|side|side|side|side|side|side|Middle|Middle|-|-");
    assert_string_equal(reported(atlas, "1"), "All|All|All|All|All|All|All|All|All|All|All|All|All|All|-|-");
    assert_string_equal(reported(atlas, "side"), reported(atlas, "2"));
    assert_string_equal(reported(atlas, "A,All"), "A|A|A|A|A|A|A|A|All|All|All|All|All|All|-|-");
    assert_fails(level_create(&level, atlas, "4"), CONUS_ERROR_ARGUMENT);
    assert_fails(level_create(&level, atlas, "A_L"), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "\"A_L\" is merged with the other side into \"A\", label 31"));
    const uint32_t side = area_rows_number(atlas, "side");
    assert_int_equal(conus_atlas_object(atlas, area_rows_number(atlas, "A"))->parent, side);
    conus_atlas_destroy(atlas);
}

static void names_that_are_taken_are_spelled_out(void **state)
{
    (void)state;
    static const struct area_row rows[] = {{1, "A_L", 0, NULL, 0},     {2, "A_R", 0, NULL, 0},
                                           {3, "A", 0, NULL, 0},       {4, "B_L", 0, NULL, 0},
                                           {5, "B_R", 0, NULL, 0},     {6, "Left B", 0, NULL, 0},
                                           {7, "Right B", 0, NULL, 0}, {8, "L", 0, NULL, 0},
                                           {9, "R", 0, NULL, 0},       {0}};
    static const char *const wanted[] = {"A_L + A_R", "B_L + B_R", "Left B + Right B", "L + R"};
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED));
    assert_int_equal(conus_atlas_object_count(atlas), 13);
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(conus_atlas_object(atlas, 10 + i)->name, wanted[i]);
    }
    conus_atlas_destroy(atlas);
}

/* An area is told from one of its name by its side where the table gives both, and by its kind from a pathway. */
static void what_stands_before_a_name_tells_areas_apart(void **state)
{
    (void)state;
    static const struct area_row rows[] = {{1, "Insula", 0, NULL, 'L'}, {2, "Insula", 0, NULL, 'R'},
                                           {3, "Cuneus", 0, NULL, 'R'}, {4, "Lingual", 0, NULL, 'L'},
                                           {5, "Arc", 0, NULL, 'R'},    {6, "Arc", 0, NULL, 'L'},
                                           {7, "Pons", 0, NULL, 'B'},   {8, "Pons", 0, NULL, 'L'},
                                           {9, "Lingual", 0, NULL, 0},  {0}};
    static const char *const wanted[] = {"", "left", "right", "", "", "right area", "left area", "", "", "", "pathway"};
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(area_rows_add_pathway(atlas, "Arc"));
    const char *prefixes[11];
    assert_ok(conus_atlas_prefixes(prefixes, atlas));
    for (size_t number = 0; number < sizeof wanted / sizeof wanted[0]; number++) {
        assert_string_equal(prefixes[number], wanted[number]);
    }
    conus_atlas_destroy(atlas);
}

static const uint32_t row_labels[16] = {4, 4, 4, 4, 4, 6, 6, 6, 6, 6, 6, 5, 7, 0, 0, 8};

static void areas_of_both_sides_are_cut(void **state)
{
    (void)state;
    static const struct area_row rows[] = {{4, "Four", 100, "BA4", 0},     {6, "Six", 100, NULL, 'B'},
                                           {5, "Five_L", 100, NULL, 0},    {7, "Seven", 100, NULL, 0},
                                           {8, "Left-vessel", 0, NULL, 0}, {9, "Empty", 100, NULL, 0},
                                           {100, "Cortex", 0, "CTX", 0},   {0}};
    static const struct {
        const char *name;
        uint32_t label;
        const char *parent, *abbreviation;
        uint64_t voxels;
        char hemisphere;
    } wanted[] = {
        {"Five_L", 5, "Cortex left", "", 1, 0},
        {"Seven", 7, "Cortex right", "", 1, 0},
        {"Left-vessel", 8, NULL, "", 1, 0},
        {"Empty", 9, NULL, "", 0, 0},
        {"Four left", 1004, "Cortex left", "BA4_L", 4, 'L'},
        {"Six left", 1006, "Cortex left", "", 3, 'L'},
        {"Cortex left", 1100, NULL, "CTX_L", 0, 'L'},
        {"Four right", 2004, "Cortex right", "BA4_R", 1, 'R'},
        {"Six right", 2006, "Cortex right", "", 3, 'R'},
        {"Cortex right", 2100, NULL, "CTX_R", 0, 'R'},
    };
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, row_labels, rows));
    assert_ok(area_rows_add_pathway(atlas, "CST"));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
    assert_int_equal(conus_atlas_object_count(atlas), 11);
    for (size_t i = 0; i < 10; i++) {
        const conus_object *area = conus_atlas_object(atlas, i + 1);
        const conus_object *parent = conus_atlas_object(atlas, area->parent);
        assert_string_equal(area->name, wanted[i].name);
        assert_int_equal(area->label, wanted[i].label);
        assert_string_equal(area->abbreviation, wanted[i].abbreviation);
        assert_int_equal(area->voxels, wanted[i].voxels);
        assert_near(area->volume_mm3, (double)wanted[i].voxels, 1e-12);
        assert_int_equal(area->hemisphere, wanted[i].hemisphere);
        assert_string_equal(parent ? parent->name : "", wanted[i].parent ? wanted[i].parent : "");
    }
    assert_string_equal(reported(atlas, NULL),
                        "Four left|Four left|Four left|Four left|Four right|Six right|Six right|Six right|"
                        "Six left|Six left|Six left|Five_L|Seven|-|-|Left-vessel");
    assert_int_equal(volume_object(&atlas->volumes[1], 3), 11);
    assert_true(test_has_note(
        atlas, "hemispheres: 3 areas are cut in two at x = 0, which is taken as the midline: 8 voxels lie "
               "left of it, 6 on it or right"));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
}

/* A name from before the cut means both halves. */
static void a_level_keeps_the_sides_apart(void **state)
{
    (void)state;
    static const struct area_row rows[] = {
        {4, "Four", 7, "BA4", 0}, {6, "Six", 7, "BA6", 0}, {5, "Five_L", 7, NULL, 0}, {7, "Cortex", 0, "CTX", 0}, {0}};
    static const char *const specs[] = {"1", "Cortex", "cortex", "CTX", "\"7\"", "Cortex left,CTX_R", "17,27"};
    conus_atlas *atlas = NULL;
    struct level *level = NULL;
    char text[512];
    assert_ok(area_rows_atlas(&atlas, dim, row_labels, rows));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        snprintf(text, sizeof text, "%s", reported(atlas, specs[i]));
        assert_non_null(strstr(text, "Cortex left|Cortex left|Cortex left|Cortex left|Cortex right|Cortex right"));
        assert_string_equal(text, reported(atlas, "Cortex"));
    }
    uint32_t number;
    assert_fails(level_create(&level, atlas, "Cortx"), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_find(&number, atlas, "cortex"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(),
                        "\"cortex\" is cut in two: \"Cortex left\", label 17, and \"Cortex right\", label 27");
    assert_ok(conus_atlas_find(&number, atlas, "Cortex left"));
    assert_int_equal(conus_atlas_object(atlas, number)->label, 17);
    assert_fails(level_create(&level, atlas, "Cor"), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
}

/* An odd number of voxels has one in the middle, at x = 0, which counts as right; also after a turn and a move by 35
 * mm, whatever the rounding. */
static void the_middle_is_right(void **state)
{
    (void)state;
    static const struct area_row rows[] = {{1, "A", 0, NULL, 0}, {0}};
    static const uint32_t five[5] = {1, 1, 1, 1, 1};
    for (int turn = 0; turn < 10; turn++) {
        const double c = cos(turn * MATH3_PI / 5);
        const double s = sin(turn * MATH3_PI / 5);
        conus_atlas *atlas = NULL;
        assert_ok(area_rows_atlas(&atlas, (const size_t[3]){5, 1, 1}, five, rows));
        if (turn) {
            assert_ok(conus_atlas_move(atlas, (double[16]){c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 35.1, 1, 2, 1}));
        }
        assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
        assert_string_equal(reported(atlas, NULL), "A left|A left|A right|A right|A right");
        conus_atlas_destroy(atlas);
    }
}

/* Merging undoes a split. */
static void merging_undoes_splitting(void **state)
{
    (void)state;
    static const struct area_row rows[] = {{1, "A", 7, "a", 0},  {2, "B", 7, "b", 0}, {3, "C", 0, NULL, 0},
                                           {4, "D", 0, NULL, 0}, {7, "T", 0, "t", 0}, {0}};
    conus_atlas *plain = NULL;
    conus_atlas *atlas = NULL;
    char wanted[1024];
    assert_ok(area_rows_atlas(&plain, dim, labels, rows));
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
    snprintf(wanted, sizeof wanted, "%s", reported(plain, NULL));
    assert_string_not_equal(reported(atlas, NULL), wanted);
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED));
    assert_string_equal(reported(atlas, NULL), wanted);
    snprintf(wanted, sizeof wanted, "%s", reported(plain, "1"));
    assert_string_equal(reported(atlas, "1"), wanted);
    assert_string_equal(reported(atlas, "t"), wanted);
    conus_atlas_destroy(plain);
    conus_atlas_destroy(atlas);
}

static void refuse(const uint32_t *voxels, const struct area_row *rows, conus_hemispheres how, const char *message)
{
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, voxels, rows));
    assert_fails(conus_atlas_set_hemispheres(atlas, how), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), message));
    conus_atlas_destroy(atlas);
}

static void impossible_hemispheres_are_refused(void **state)
{
    (void)state;
    static const struct area_row both[] = {{1, "A", 0, NULL, 0}, {2, "B", 0, NULL, 0}, {0}};
    static const struct area_row right[] = {{1, "A", 0, NULL, 0}, {0}};
    static const struct area_row huge[] = {{1, "A", 0, NULL, 0}, {1000000000, "B", 0, NULL, 0}, {0}};
    static const struct area_row pair[] = {{3, "A_L", 0, NULL, 0}, {4, "A_R", 0, NULL, 0}, {0}};
    static const uint32_t on_right[16] = {0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1};
    static const uint32_t paired[16] = {3, 3, 3, 3, 4, 4, 4, 4, 0};
    refuse(labels, both, CONUS_HEMISPHERES_MERGED,
           "hemispheres: merged: no two of its 4 areas are left and right of one");
    refuse(on_right, right, CONUS_HEMISPHERES_SPLIT,
           "hemispheres: split: all voxels lie at x >= 0, so x = 0 is not the midline of this atlas");
    refuse(paired, pair, CONUS_HEMISPHERES_SPLIT, "hemispheres: split: each of the 2 areas is left or right already");
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, huge));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "label 1000000000"));
    conus_atlas_destroy(atlas);
    assert_ok(atlas_create_empty(&atlas, "nothing"));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_DATA);
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED), CONUS_ERROR_DATA);
    conus_atlas_destroy(atlas);
}

static void surfaces_are_not_cut(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    struct mesh mesh = {.vertex_count = 3, .triangle_count = 1};
    const conus_object area = {.label = 1, .name = "A", .abbreviation = ""};
    mesh.positions = memory_zeroed(3, 3 * sizeof *mesh.positions);
    mesh.triangles = memory_zeroed(1, 3 * sizeof *mesh.triangles);
    assert_true(mesh.positions && mesh.triangles);
    mesh.positions[3] = mesh.positions[7] = 1;
    mesh.triangles[1] = 1;
    mesh.triangles[2] = 2;
    assert_ok(atlas_create_empty(&atlas, "one"));
    assert_ok(atlas_add_mesh(atlas, &area, &mesh));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_UNSUPPORTED);
    assert_string_equal(conus_message(), "hemispheres: split: 1 areas are surfaces, only areas of voxels can be cut");
    conus_atlas_destroy(atlas);
}

/* With more than 65535 objects the masks of pathways become wide, and the parcellation. */
static void many_areas_need_wider_numbers(void **state)
{
    (void)state;
    enum { MANY = 40000 };
    static uint32_t many[2 * MANY];
    static struct area_row none[1];
    conus_atlas *atlas = NULL;
    for (size_t i = 0; i < 2 * MANY; i++) {
        many[i] = 1 + (uint32_t)(i < MANY ? i : 2 * MANY - 1 - i); /* mirrored at x = 0 */
    }
    assert_ok(area_rows_atlas(&atlas, (const size_t[3]){2 * MANY, 1, 1}, many, none));
    assert_ok(area_rows_add_pathway(atlas, "CST"));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
    assert_int_equal(conus_atlas_object_count(atlas), 2 * MANY + 1);
    assert_int_equal(volume_object(&atlas->volumes[1], 5), 2 * MANY + 1);
    assert_int_equal(volume_object(&atlas->volumes[0], 7), 8);
    assert_int_equal(volume_object(&atlas->volumes[0], 2 * MANY - 1), MANY + 1);
    assert_string_equal(conus_atlas_object(atlas, 8)->name, "8 left");
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED));
    assert_int_equal(conus_atlas_object_count(atlas), 3 * MANY + 1);
    assert_int_equal(volume_object(&atlas->volumes[1], 5), 3 * MANY + 1);
    conus_atlas_destroy(atlas);
}

static conus_status change(void *how)
{
    conus_atlas *atlas = NULL;
    conus_status status = area_rows_atlas(&atlas, dim, labels, sided);
    status = status ? status : area_rows_add_pathway(atlas, "CST");
    size_t objects = conus_atlas_object_count(atlas);
    size_t notes = conus_atlas_note_count(atlas);
    if (!status) {
        status = conus_atlas_set_hemispheres(atlas, *(const conus_hemispheres *)how);
        bool same = conus_atlas_object_count(atlas) == objects && conus_atlas_note_count(atlas) == notes;
        assert_true(status ? same : !same);
    }
    conus_atlas_destroy(atlas);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    conus_hemispheres hows[] = {CONUS_HEMISPHERES_SPLIT, CONUS_HEMISPHERES_MERGED};
    test_every_allocation(change, &hows[0]);
    test_every_allocation(change, &hows[1]);
}

static conus_atlas *load(const char *name, conus_hemispheres how)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron(name), NULL));
    assert_ok(conus_atlas_set_hemispheres(atlas, how));
    return atlas;
}

static size_t pair_count(const conus_atlas *atlas)
{
    return atlas->area_count + 1 - atlas->first_pair;
}

static void real_atlases_are_merged(void **state)
{
    (void)state;
    static const struct {
        const char *file, *pair;
        size_t pairs, areas;
    } cases[] = {{"aal.nii.gz", "Precentral", 54, 116},
                 {"natbrainlab.nii.gz", "Cingulum", 16, 32},
                 {"jhu189.nii.gz", "SFG", 94, 189},
                 {"JHU-WhiteMatter-labels-1mm.nii.gz", "Cingulum_(hippocampus)", 21, 48},
                 {"inia19-NeuroMaps.nii.gz", "lingual_gyrus", 502, 1004}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_atlas *atlas = load(cases[i].file, CONUS_HEMISPHERES_MERGED);
        assert_true(area_rows_number(atlas, cases[i].pair) >= atlas->first_pair);
        assert_int_equal(pair_count(atlas), cases[i].pairs);
        assert_int_equal(atlas->first_pair, cases[i].areas + 1);
        conus_atlas_destroy(atlas);
    }
}

/* A table with all of FreeSurfer's conventions. */
static void freesurfer_has_pairs(void **state)
{
    (void)state;
    static const char *const pairs[] = {"ctx-insula", "wm-insula", "af",
                                        "IPL_PFm",    "Cbm_CrusI", "Cerebral-White-Matter"};
    char table[512];
    snprintf(table, sizeof table, "%s", test_shared("labels/freesurfer/FreeSurferColorLUT.txt"));
    const conus_load_options options = {.labels = table};
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("brodmann.nii.gz"), &options));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED));
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        if (area_rows_number(atlas, pairs[i]) < atlas->first_pair) {
            fail_msg("no pair %s", pairs[i]);
        }
    }
    assert_true(area_rows_number(atlas, "Left-Amygdala + Right-Amygdala") != 0); /* Amygdala exists, too */
    conus_atlas_destroy(atlas);
}

static void brodmann_is_split(void **state)
{
    (void)state;
    conus_atlas *plain = load("brodmann.nii.gz", CONUS_HEMISPHERES_AS_IS);
    conus_atlas *atlas = load("brodmann.nii.gz", CONUS_HEMISPHERES_SPLIT);
    assert_int_equal(plain->area_count, 41);
    assert_int_equal(atlas->area_count, 82);
    for (uint32_t number = 1; number <= 41; number++) {
        const conus_object *left = conus_atlas_object(atlas, number);
        const conus_object *right = conus_atlas_object(atlas, 41 + number);
        const conus_object *whole = conus_atlas_object(plain, number);
        assert_int_equal(left->voxels + right->voxels, whole->voxels);
        assert_int_equal(left->label, 100 + whole->label);
        assert_int_equal(right->label, 200 + whole->label);
        assert_true(left->voxels && right->voxels);
    }
    conus_atlas_destroy(plain);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(hemispheres)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_pairs_have_a_common_part),
        cmocka_unit_test(pairs_are_sure_or_none),
        cmocka_unit_test(pairs_have_the_same_place_in_the_tree),
        cmocka_unit_test(pairs_are_reported_as_one),
        cmocka_unit_test(merging_composes_with_a_level),
        cmocka_unit_test(names_that_are_taken_are_spelled_out),
        cmocka_unit_test(what_stands_before_a_name_tells_areas_apart),
        cmocka_unit_test(areas_of_both_sides_are_cut),
        cmocka_unit_test(a_level_keeps_the_sides_apart),
        cmocka_unit_test(the_middle_is_right),
        cmocka_unit_test(merging_undoes_splitting),
        cmocka_unit_test(impossible_hemispheres_are_refused),
        cmocka_unit_test(surfaces_are_not_cut),
        cmocka_unit_test(many_areas_need_wider_numbers),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(real_atlases_are_merged),
        cmocka_unit_test(freesurfer_has_pairs),
        cmocka_unit_test(brodmann_is_split),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
