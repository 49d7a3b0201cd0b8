/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts which names contradict the side on which their points lie. */
#include "poses/rows/columns.h"

#include "base/status.h"

#include <stdio.h>
#include <string.h>

int sides_of_name(struct text name)
{
    static const char left[] = "left/l/lh/links/gauche", right[] = "right/r/rh/rechts/droite";
    int side = 0;
    for (size_t i = 0; i < name.size;) {
        size_t size = 0;
        while (i + size < name.size && !strchr(" _-.,()[]", name.data[i + size])) {
            size++;
        }
        const struct text word = {name.data + i, size};
        side = text_is_one_of(word, left, false) ? -1 : text_is_one_of(word, right, false) ? 1 : side;
        i += size + 1;
    }
    return side;
}

/* The letters of a contact's name: "LPH" of "LPH 1". They begin with two capitals, L or R the first. *ends: whether the
 * name ends with a number. */
static struct text letters_of(struct text name, bool *ends)
{
    static const char capitals[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", small[] = "abcdefghijklmnopqrstuvwxyz";
    size_t size = name.size;
    while (size && strchr("0123456789", name.data[size - 1])) {
        size--;
    }
    *ends = size < name.size;
    size -= size && strchr(" _-", name.data[size - 1]);
    bool fits =
        *ends && size >= 2 && size < SIDES_SHAFT_SIZE && strchr("LR", name.data[0]) && strchr(capitals, name.data[1]);
    for (size_t i = 2; i < size && fits; i++) {
        fits = strchr(capitals, name.data[i]) || strchr(small, name.data[i]);
    }
    return (struct text){name.data, fits ? size : 0};
}

static void count_shaft(struct sides *sides, struct text name, double x, double edge)
{
    bool ends;
    const struct text letters = letters_of(name, &ends);
    size_t i = 0;
    while (i < sides->shaft_count && !text_equal(letters, sides->shafts[i].letters)) {
        i++;
    }
    if (!letters.size || i == SIDES_SHAFTS) {
        sides->has_others = sides->has_others || ends;
        return;
    }
    struct shaft *shaft = &sides->shafts[i];
    if (i == sides->shaft_count) {
        sides->shaft_count++;
        memcpy(shaft->letters, letters.data, letters.size);
    }
    shaft->contacts++;
    shaft->wrong += letters.data[0] == 'L' ? x > edge : x < -edge;
}

void sides_count(struct sides *sides, int side, struct text name, double x, double edge)
{
    size_t *wrong = side < 0 ? &sides->left_on_right : &sides->right_on_left;
    if (side) {
        *(side < 0 ? &sides->left : &sides->right) += 1;
        *wrong += side < 0 ? x > edge : x < -edge;
    } else {
        count_shaft(sides, name, x, edge);
    }
}

conus_status sides_check(const struct sides *s, const char *why)
{
    bool is_wrong = (s->left && 2 * s->left_on_right >= s->left) || (s->right && 2 * s->right_on_left >= s->right);
    return !is_wrong || s->left + s->right < 2
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "sides: %zu of %zu rows called left lie on the right, %zu of %zu called right on the left; %s, "
                      "and ',sides=anyway' behind FILE takes them as they are",
                      s->left_on_right, s->left, s->right_on_left, s->right, why);
}

conus_status sides_warn_of_shafts(const struct sides *sides, struct notes *notes)
{
    char shown[4 * SIDES_SHAFT_SIZE] = "";
    size_t of_letter[2] = {0};
    size_t wrong = 0;
    for (size_t i = 0; i < sides->shaft_count; i++) {
        of_letter[sides->shafts[i].letters[0] == 'R']++;
    }
    bool are_all = !sides->has_others && sides->shaft_count >= (of_letter[0] && of_letter[1] ? 2 : 3);
    for (size_t i = 0; i < sides->shaft_count; i++) {
        const struct shaft *shaft = &sides->shafts[i];
        bool is_side = are_all;
        for (size_t k = 0; k < sides->shaft_count; k++) {
            const char *other = sides->shafts[k].letters;
            is_side = is_side || (other[0] != shaft->letters[0] && strcmp(other + 1, shaft->letters + 1) == 0);
        }
        if (is_side && shaft->contacts >= 3 && shaft->wrong == shaft->contacts && wrong++ < 3) {
            size_t used = strlen(shown);
            snprintf(shown + used, sizeof shown - used, "%s%s", used ? ", " : "", shaft->letters);
        }
    }
    return !wrong ? CONUS_OK
                  : notes_warn(notes,
                               "%zu of %zu electrodes lie on the other side than the first letter of their names says "
                               "(%s%s); is x mirrored? ',sides=anyway' behind FILE says that it is not",
                               wrong, sides->shaft_count, shown, wrong > 3 ? ", ..." : "");
}
