/* SPDX-License-Identifier: BSD-3-Clause */
/* The words of a file's name that say which atlas it is. */
#include "loaders/labels/labels.h"

#include <string.h>

enum kind { NO_WORD, SMALL, CAPITAL, DIGIT };

static enum kind kind_of(char c)
{
    if (c >= '0' && c <= '9') {
        return DIGIT;
    }
    if (c >= 'A' && c <= 'Z') {
        return CAPITAL;
    }
    return (c >= 'a' && c <= 'z') || (c & 0x80) ? SMALL : NO_WORD;
}

/* Words that any table or volume may have. */
static const char neutral[] =
    "atl/atlas/atlases/color/colors/colortable/colour/colours/ctab/desc/dseg/hemi/index/indices/info/key/keys/l/label/"
    "labels/left/legend/lh/list/lookup/lut/name/names/nii/parc/parcellation/r/region/regions/rh/right/roi/rois/seg/"
    "segmentation/table";

/* The next word off `rest`; false if none is left. */
static bool next_word(struct text *rest, struct text *word)
{
    size_t start = 0;
    while (start < rest->size && kind_of(rest->data[start]) == NO_WORD) {
        start++;
    }
    size_t end = start;
    for (; end < rest->size; end++) {
        enum kind kind = kind_of(rest->data[end]);
        enum kind last = end > start ? kind_of(rest->data[end - 1]) : kind;
        if (kind == NO_WORD || (kind == DIGIT) != (last == DIGIT) || (kind == CAPITAL && last == SMALL)) {
            break;
        }
    }
    *word = (struct text){rest->data + start, end - start};
    *rest = (struct text){rest->data + end, rest->size - end};
    return word->size > 0;
}

static void add_word(struct label_words *words, struct text word)
{
    bool size = text_equal_ignoring_case(word, "mm") && words->count;
    const struct text *last = size ? &words->items[words->count - 1] : NULL;
    if (last && kind_of(last->data[0]) == DIGIT && last->data + last->size == word.data) {
        words->count--;
    } else if (!text_is_one_of(word, neutral, false)) {
        if (words->count < LABEL_WORDS) {
            words->items[words->count++] = word;
        } else {
            words->overflow = true;
        }
    }
}

void label_words_find(struct label_words *out, struct text stem)
{
    struct text entity;
    *out = (struct label_words){.count = 0};
    for (bool more = true; text_field(&stem, '_', &more, &entity);) {
        const char *dash = entity.size ? memchr(entity.data, '-', entity.size) : NULL;
        struct text key = {entity.data, dash ? (size_t)(dash - entity.data) : 0};
        bool place = text_is_one_of(key, "space/res/den/tpl", false);
        for (struct text word; !place && next_word(&entity, &word);) {
            add_word(out, word);
        }
    }
}

bool label_words_contain(const struct label_words *all, const struct label_words *part)
{
    for (size_t i = 0; i < part->count; i++) {
        const struct text word = part->items[i];
        bool has = false;
        for (size_t k = 0; !has && k < all->count; k++) {
            has = all->items[k].size == word.size && text_contains(all->items[k], word);
        }
        if (!has) {
            return false;
        }
    }
    return !all->overflow && !part->overflow;
}

bool label_words_equal(const struct label_words *a, const struct label_words *b)
{
    return label_words_contain(a, b) && label_words_contain(b, a);
}
