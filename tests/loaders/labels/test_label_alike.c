/* SPDX-License-Identifier: BSD-3-Clause */
/* The words of a file's name, by which a table with another name than its volume's is found. */
#include "loaders/labels/labels.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static const char *words_of(const char *stem)
{
    static char text[256];
    struct label_words words;
    label_words_find(&words, text_from(stem));
    text[0] = '\0';
    for (size_t i = 0; i < words.count; i++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%.*s", i ? " " : "", (int)words.items[i].size,
                 words.items[i].data);
    }
    return text;
}

static void names_are_cut_into_words(void **state)
{
    (void)state;
    static const struct {
        const char *stem, *words;
    } names[] = {
        {"atl-Anatom", "Anatom"},
        {"atl-Anatom_space-MNI_dseg", "Anatom"},
        {"atl-Anatom_Space-MNI_RES-2_dseg", "Anatom"},
        {"labels_X", "X"},
        {"JulichBrainAtlas31_LH", "Julich Brain 31"},
        {"AAL3v1_2mm", "AAL 3 v 1"},
        {"Schaefer2018_100Parcels_7Networks_order", "Schaefer 2018 100 Parcels 7 Networks order"},
        {"tpl-MNI152NLin6Asym_res-01_atlas-HOCPAL_desc-th25_dseg", "HOCPAL th 25"},
        {"atlas labels", ""},
        {"", ""},
        {"mm", "mm"},
        {"12 mm", "12 mm"},
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_string_equal(words_of(names[i].stem), names[i].words);
    }
}

static void long_names_compare_with_none(void **state)
{
    (void)state;
    struct label_words words;
    struct label_words none = {.count = 0};
    char stem[3 * (LABEL_WORDS + 1) + 1] = "";
    for (size_t i = 0; i <= LABEL_WORDS; i++) {
        snprintf(stem + 3 * i, 4, "x%zu_", i % 10);
    }
    label_words_find(&words, text_from(stem));
    assert_true(words.overflow);
    assert_false(label_words_contain(&words, &none));
    assert_false(label_words_equal(&words, &words));
}

TEST_GROUP(label_alike)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_cut_into_words),
        cmocka_unit_test(long_names_compare_with_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
