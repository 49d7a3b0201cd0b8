/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes a place apart, as people write it. */
#include "base/formats/table.h"
#include "poses/rows/pose_row.h"

enum { SHOWN = 80 };

conus_status place_fail_numbers(const struct place_words *words)
{
    const struct numbers *numbers = &words->numbers;
    return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\": \"%.*s\" %s", TEXT_SHOW(words->name, SHOWN),
                TEXT_SHOW(numbers->at, SHOWN), numbers->why);
}

conus_status place_read(struct place_words *out, struct text text)
{
    static const struct {
        const char *prefix;
        enum place_form form;
    } forms[] = {{"centroid:", PLACE_CENTROID}, {"near:", PLACE_NEAR}, {"index:", PLACE_LABEL}, {"1020:", PLACE_CAP}};
    struct place_words words = {.form = PLACE_NAME, .name = table_trim(text)};
    for (size_t i = 0; i < sizeof forms / sizeof forms[0] && words.form == PLACE_NAME; i++) {
        size_t size = strlen(forms[i].prefix);
        if (words.name.size >= size &&
            text_equal_ignoring_case((struct text){words.name.data, size}, forms[i].prefix)) {
            words.form = forms[i].form;
            words.name = table_trim((struct text){words.name.data + size, words.name.size - size});
        }
    }
    if (!words.name.size) {
        return fail(CONUS_ERROR_ARGUMENT, "the place is empty; three numbers, an area or a position are needed");
    }
    if (!text_is_readable(words.name)) {
        return fail(CONUS_ERROR_ARGUMENT, "the place is no text");
    }
    if (words.form == PLACE_NAME && numbers_read(&words.numbers, words.name) == NUMBERS_FOUND) {
        words.form = PLACE_NUMBERS;
    }
    if (words.form == PLACE_LABEL && !text_to_uint(words.name, UINT32_MAX, &words.label)) {
        return fail(CONUS_ERROR_ARGUMENT, "index:%.*s: a label is needed, a whole number",
                    TEXT_SHOW(words.name, SHOWN));
    }
    *out = words;
    return CONUS_OK;
}
