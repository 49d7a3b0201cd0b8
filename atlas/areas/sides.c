/* SPDX-License-Identifier: BSD-3-Clause */
/* Left and right: words for the side in names, pairs of areas, the side of each area, and sides that look swapped. */
#include "atlas/areas/areas.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <string.h>

static const struct {
    const char *left, *right;
    bool outer; /* only at a name's ends; elsewhere a small letter often means something else */
} pairs[] = {
    {"L", "R", false},   {"left", "right", false}, {"Left", "Right", false}, {"LEFT", "RIGHT", false},
    {"lh", "rh", false}, {"LH", "RH", false},      {"l", "r", true},
};

static bool is_word_character(char c)
{
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (unsigned char)c >= 0x80;
}

/* The run of word characters that starts at `from` or later. */
static struct text next_word(struct text name, size_t from)
{
    while (from < name.size && !is_word_character(name.data[from])) {
        from++;
    }
    size_t end = from;
    while (end < name.size && is_word_character(name.data[end])) {
        end++;
    }
    return (struct text){name.data + from, end - from};
}

bool side_word_find(struct side_word *out, struct text name, size_t from)
{
    struct text word;
    for (; (word = next_word(name, from)).size; from = out->start + out->size) {
        *out = (struct side_word){.start = (size_t)(word.data - name.data), .size = word.size};
        for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
            bool left = text_equal(word, pairs[i].left);
            if ((left || text_equal(word, pairs[i].right)) &&
                (!pairs[i].outer || !out->start || out->start + out->size == name.size)) {
                out->side = left ? 'L' : 'R';
                out->opposite = left ? pairs[i].right : pairs[i].left;
                return true;
            }
        }
    }
    return false;
}

/* Whether the word has more than one letter, so that it hardly means anything else. */
static bool side_word_is_long(const struct side_word *word)
{
    return word->size > 1;
}

void side_word_swap(struct buffer *out, struct text name, const struct side_word *word)
{
    size_t end = word->start + word->size;
    buffer_append(out, name.data, word->start);
    buffer_text(out, word->opposite);
    buffer_append(out, name.data + end, name.size - end);
}

static bool is_joining(char c)
{
    return c && strchr(" _-.,:;/", c);
}

/* Appends name without the word, its brackets and what joins it to the rest: "Precentral", "Thalamus", "ctx-
 * insula". May append nothing. */
static void side_word_drop(struct buffer *out, struct text name, const struct side_word *word)
{
    size_t start = word->start;
    size_t end = start + word->size;
    static const char brackets[] = "()[]";
    const char *open = start && end < name.size ? strchr(brackets, name.data[start - 1]) : NULL;
    if (open && *open && open[1] == name.data[end]) {
        start--;
        end++;
    }
    size_t next = end;
    while (next < name.size && is_joining(name.data[next])) {
        next++;
    }
    while (next == end && start && is_joining(name.data[start - 1])) { /* no separator connects it to the next part */
        start--;
    }
    buffer_append(out, name.data, start);
    buffer_append(out, name.data + next, name.size - next);
}

enum { LARGEST_LABEL = 999999999 };

/** Areas by name. */
struct name_index {
    const conus_object **areas; /* [count], sorted by name */
    size_t count;
};

struct pairing {
    const conus_atlas *atlas;
    struct name_index index;
    uint32_t *right_of; /* [area_count + 1] of left areas */
    uint32_t *claims;   /* [area_count + 1] how many left areas claim it as their right one */
};

static conus_status index_names(struct name_index *out, const conus_atlas *atlas)
{
    *out = (struct name_index){atlas_by_name(atlas, atlas->area_count), atlas->area_count};
    return out->areas ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* The first of the areas called `name`, and how many there are. */
static size_t find_name(size_t *first, const struct name_index *index, const char *name)
{
    size_t low = 0;
    size_t high = index->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (strcmp(index->areas[middle]->name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    *first = low;
    while (high < index->count && strcmp(index->areas[high]->name, name) == 0) {
        high++;
    }
    return high - low;
}

static uint32_t number_of(const conus_atlas *atlas, const conus_object *area)
{
    return (uint32_t)(area - atlas->objects) + 1;
}

static bool may_be(const conus_object *area, char side)
{
    return !area->hemisphere || area->hemisphere == side;
}

/* Pairs by a word for the side in the name. Where several words lead to an area, no pair is made. */
static conus_status pair_by_word(struct pairing *pairing, uint32_t left)
{
    struct text name = text_from(pairing->atlas->objects[left - 1].name);
    struct side_word word;
    size_t found = 0;
    conus_status status = CONUS_OK;
    for (size_t from = 0; !status && side_word_find(&word, name, from); from = word.start + word.size) {
        struct buffer swapped = {0};
        if (word.side == 'L') {
            side_word_swap(&swapped, name, &word);
            status = buffer_status(&swapped);
        }
        if (!status && word.side == 'L') {
            size_t first = 0;
            if (find_name(&first, &pairing->index, swapped.data) == 1 && may_be(pairing->index.areas[first], 'R')) {
                pairing->right_of[left] = number_of(pairing->atlas, pairing->index.areas[first]);
                ++found;
            }
        }
        buffer_finish(&swapped);
    }
    pairing->right_of[left] = found == 1 ? pairing->right_of[left] : 0;
    return status;
}

static conus_status propose_pairs(struct pairing *pairing)
{
    conus_status status = CONUS_OK;
    const struct name_index *index = &pairing->index;
    for (size_t first = 0, count; !status && first < index->count; first += count) {
        size_t same;
        const conus_object *area = index->areas[first];
        count = find_name(&same, index, area->name);
        if (count == 2) {
            const conus_object *a = pairing->index.areas[first];
            const conus_object *b = pairing->index.areas[first + 1];
            const conus_object *left = a->hemisphere == 'L' ? a : b;
            const conus_object *right = a->hemisphere == 'L' ? b : a;
            if (left->hemisphere == 'L' && right->hemisphere == 'R') {
                pairing->right_of[number_of(pairing->atlas, left)] = number_of(pairing->atlas, right);
            }
        } else if (count == 1 && may_be(area, 'L')) {
            status = pair_by_word(pairing, number_of(pairing->atlas, area));
        }
    }
    return status;
}

/* Whether their parents are the same area, or a pair whose parents are, and so on. */
static bool have_same_place(const struct pairing *pairing, uint32_t left, uint32_t right)
{
    const conus_object *objects = pairing->atlas->objects;
    do {
        left = objects[left - 1].parent;
        right = objects[right - 1].parent;
    } while (left != right && left && right && pairing->right_of[left] == right);
    return left == right;
}

static conus_status check_places(struct pairing *pairing)
{
    size_t count = pairing->atlas->area_count;
    bool *kept = memory_zeroed(count + 1, sizeof *kept);
    if (!kept) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t left = 1; left <= count; left++) {
        uint32_t right = pairing->right_of[left];
        kept[left] = right && have_same_place(pairing, left, right);
    }
    for (uint32_t left = 1; left <= count; left++) {
        pairing->right_of[left] = kept[left] ? pairing->right_of[left] : 0;
    }
    memory_free(kept);
    return CONUS_OK;
}

conus_status hemispheres_pair(uint32_t **out, const conus_atlas *atlas)
{
    struct pairing pairing = {.atlas = atlas};
    pairing.right_of = memory_zeroed(atlas->area_count + 1, sizeof *pairing.right_of);
    pairing.claims = memory_zeroed(atlas->area_count + 1, sizeof *pairing.claims);
    conus_status status = pairing.right_of && pairing.claims ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : index_names(&pairing.index, atlas);
    status = status ? status : propose_pairs(&pairing);
    if (!status) {
        /* Keeps proposals whose two areas occur in no other. */
        size_t count = pairing.atlas->area_count;
        uint32_t *right_of = pairing.right_of;
        for (uint32_t left = 1; left <= count; left++) {
            pairing.claims[right_of[left]]++;
            pairing.claims[left] += right_of[left] != 0;
        }
        for (uint32_t left = 1; left <= count; left++) {
            uint32_t right = right_of[left];
            if (right && (pairing.claims[right] > 1 || pairing.claims[left] > 1)) {
                right_of[left] = 0;
            }
        }
        status = check_places(&pairing);
    }
    memory_free(pairing.index.areas);
    memory_free(pairing.claims);
    return GIVE(status, out, pairing.right_of, memory_free(pairing.right_of));
}

conus_status hemispheres_label_step(uint32_t *out, const conus_atlas *atlas)
{
    uint32_t largest = 0;
    uint32_t step = 1;
    for (size_t i = 0; i < atlas->area_count; i++) {
        largest = atlas->objects[i].label > largest ? atlas->objects[i].label : largest;
    }
    if (largest > LARGEST_LABEL) {
        return fail(CONUS_ERROR_UNSUPPORTED, "label %u is too large to number new areas, allowed are labels up to %d",
                    largest, LARGEST_LABEL);
    }
    while (step <= largest) {
        step *= 10;
    }
    *out = step;
    return CONUS_OK;
}

void hemispheres_common_name(struct buffer *out, const char *left, const char *right)
{
    struct text name = text_from(left);
    struct side_word word;
    if (strcmp(left, right) == 0) {
        buffer_text(out, left);
        return;
    }
    for (size_t from = 0; side_word_find(&word, name, from); from = word.start + word.size) {
        struct buffer swapped = {0};
        side_word_swap(&swapped, name, &word);
        bool found = swapped.data && strcmp(swapped.data, right) == 0;
        out->failed = out->failed || swapped.failed;
        buffer_finish(&swapped);
        if (found) {
            side_word_drop(out, name, &word);
            return;
        }
    }
}

/* The side in a name like "Left-vessel". Single letters mean nothing without a counterpart. */
static char side_of_name(const char *name)
{
    struct side_word word;
    for (size_t from = 0; side_word_find(&word, text_from(name), from); from = word.start + word.size) {
        if (side_word_is_long(&word)) {
            return word.side;
        }
    }
    return 0;
}

conus_status area_sides_find(char *out, const conus_atlas *atlas)
{
    uint32_t *right_of = NULL;
    conus_status status = hemispheres_pair(&right_of, atlas);
    for (uint32_t number = 1; !status && number <= atlas->area_count; number++) {
        const conus_object *area = &atlas->objects[number - 1];
        out[number] = area->hemisphere ? area->hemisphere : side_of_name(area->name);
    }
    for (uint32_t number = 1; !status && number <= atlas->area_count; number++) {
        if (right_of[number]) {
            out[number] = 'L';
            out[right_of[number]] = 'R';
        }
    }
    memory_free(right_of);
    return status;
}

conus_status conus_atlas_sides(char *sides, const conus_atlas *atlas)
{
    char *own = memory_zeroed(atlas->area_count + 1, 1);
    conus_status status = own ? area_sides_find(own, atlas) : CONUS_ERROR_MEMORY;
    if (!status) {
        memset(sides, 0, atlas->object_count + 1);
    }
    for (uint32_t number = 1; !status && number <= atlas->area_count; number++) {
        uint32_t at = number; /* or the nearest area above it that has a side of its own */
        while (at && !own[at]) {
            at = atlas->objects[at - 1].parent;
        }
        sides[number] = (char)(own[at] == 'B' ? 0 : own[at]);
    }
    memory_free(own);
    return status;
}

/* The mean of half a million voxels is near enough, and takes a millisecond. */
enum { VOXELS = 1 << 19, LEAST_PAIRS = 3 };

/* Mean x of an area's voxels and vertices. */
struct mean_x {
    double sum, weight;
};

static void add_x(struct mean_x *mean, double x)
{
    mean->sum += x;
    mean->weight++;
}

static void add_voxels(struct mean_x *means, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    const double *m = volume->info.world_from_voxel;
    size_t step = 1;
    while (volume->voxel_count / step / step > VOXELS) {
        step++;
    }
    for (size_t k = 0; k < dim[2]; k += step) {
        for (size_t j = 0; j < dim[1]; j += step) {
            const size_t first = dim[0] * (j + dim[1] * k);
            const double x = m[4] * (double)j + m[8] * (double)k + m[12];
            for (size_t i = 0; i < dim[0]; i++) {
                uint32_t object = volume_object(volume, first + i);
                if (object) {
                    add_x(&means[object], x + m[0] * (double)i);
                }
            }
        }
    }
}

/* As if the atlas were mirrored about *middle, unless that is NULL. */
static conus_status compare(conus_atlas *atlas, const struct mean_x *means, const uint32_t *right_of,
                            const double *middle)
{
    const double turn = middle ? -1 : 1;
    const double from = middle ? 2 * *middle : 0;
    size_t pair_count = 0;
    size_t swapped = 0;
    uint32_t example = 0;
    for (uint32_t left = 1; left <= atlas->area_count; left++) {
        const struct mean_x *l = &means[left];
        const struct mean_x *r = &means[right_of[left]];
        if (right_of[left] && l->weight > 0 && r->weight > 0) {
            bool wrong = turn * l->sum / l->weight > turn * r->sum / r->weight;
            pair_count++;
            swapped += wrong;
            example = wrong && !example ? left : example;
        }
    }
    if (pair_count < LEAST_PAIRS || 4 * swapped < 3 * pair_count) {
        return CONUS_OK;
    }
    atlas->exchanged = atlas->notes.count + 1;
    return notes_warn(
        &atlas->notes,
        "%zu of %zu pairs of a left and a right area lie the other way round, %s (x %.1f mm) to the right "
        "of %s (%.1f mm): %s",
        swapped, pair_count, atlas->objects[example - 1].name, from + turn * means[example].sum / means[example].weight,
        atlas->objects[right_of[example] - 1].name,
        from + turn * means[right_of[example]].sum / means[right_of[example]].weight,
        middle ? "the exchange of sides made them so; they are right without it"
               : "names or positions have left and right exchanged; --sides exchanged mirrors the atlas");
}

static conus_status note_swapped(conus_atlas *atlas, const double *middle)
{
    uint32_t *right_of = NULL;
    conus_status status = hemispheres_pair(&right_of, atlas);
    bool has_pair = false;
    for (size_t number = 1; !status && number <= atlas->area_count; number++) {
        has_pair = has_pair || right_of[number];
    }
    if (status || !has_pair) {
        memory_free(right_of);
        return status;
    }
    struct mean_x *means = memory_zeroed((size_t)atlas->object_count + 1, sizeof *means);
    status = means ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        for (size_t i = 0; i < atlas->volume_count; i++) {
            if (atlas_volume_has_areas(&atlas->volumes[i])) {
                add_voxels(means, &atlas->volumes[i]);
            }
        }
        for (uint32_t number = 1; number <= atlas->area_count; number++) {
            const struct mesh *mesh = atlas_object_mesh(atlas, number);
            for (size_t i = 0; mesh && i < mesh->vertex_count; i++) {
                add_x(&means[number], (double)mesh->positions[3 * i]);
            }
        }
        status = compare(atlas, means, right_of, middle);
    }
    memory_free(means);
    memory_free(right_of);
    return status;
}

/* Whether a word in its name gives `area` the side that its table does not: a long word, or a letter whose counterpart
 * is the name of another area. */
static conus_status is_contradicted(bool *out, const struct name_index *index, const conus_object *area)
{
    struct text name = text_from(area->name);
    struct side_word word;
    bool is_other = false;
    conus_status status = CONUS_OK;
    for (size_t from = 0; !status && side_word_find(&word, name, from); from = word.start + word.size) {
        if (word.side == area->hemisphere) {
            is_other = false;
            break;
        }
        struct buffer swapped = {0};
        size_t first;
        side_word_swap(&swapped, name, &word);
        status = buffer_status(&swapped);
        is_other = !status && (is_other || side_word_is_long(&word) || find_name(&first, index, swapped.data));
        buffer_finish(&swapped);
    }
    *out = is_other;
    return status;
}

/* Warns of areas whose table says another side than their name. */
static conus_status note_contradicted(conus_atlas *atlas)
{
    struct name_index index;
    conus_status status = index_names(&index, atlas);
    size_t stated = 0, contradicted = 0;
    const conus_object *example = NULL;
    for (size_t i = 0; !status && i < atlas->area_count; i++) {
        const conus_object *area = &atlas->objects[i];
        bool is_other = false;
        if (area->hemisphere == 'L' || area->hemisphere == 'R') {
            status = is_contradicted(&is_other, &index, area);
            stated++;
        }
        contradicted += is_other;
        example = is_other && !example ? area : example;
    }
    memory_free(index.areas);
    return status || !example
               ? status
               : notes_warn(&atlas->notes,
                            "the label table gives %zu of %zu areas another side than their name, first %s, which it "
                            "calls %s: one of both is wrong; answers have the table's side",
                            contradicted, stated, example->name, example->hemisphere == 'L' ? "left" : "right");
}

conus_status conflicting_sides_note(conus_atlas *atlas)
{
    conus_status status = note_contradicted(atlas);
    return status ? status : note_swapped(atlas, NULL);
}

/* Takes out the note that left and right are exchanged, number `exchanged`, 0 = there is none. */
static void drop_note(conus_atlas *atlas, size_t exchanged)
{
    struct notes *notes = &atlas->notes;
    if (exchanged) {
        size_t at = exchanged - 1;
        memory_free(notes->lines[at]);
        memmove(notes->lines + at, notes->lines + at + 1, (notes->count - at - 1) * sizeof *notes->lines);
        memmove(notes->marks + at, notes->marks + at + 1, (notes->count - at - 1) * sizeof *notes->marks);
        notes->count--;
        atlas->exchanged -= atlas->exchanged > at;
    }
}

conus_status conus_atlas_exchange_sides(conus_atlas *atlas)
{
    const bool stays_known = !atlas->is_moved || atlas->is_mirrored; /* mirrored twice, it lies where it did */
    const conus_brain brain = atlas->brain;
    const struct note_sink *sink = atlas->notes.sink;
    double mirror[16];
    double middle[3] = {0};
    if (atlas->volume_count) {
        const conus_volume_info *info = &atlas->volumes[0].info;
        for (int axis = 0; axis < 3; axis++) {
            middle[axis] = ((double)info->dim[axis] - 1) / 2;
        }
        mat4_point(middle, info->world_from_voxel, middle);
    }
    mat4_identity(mirror);
    mirror[0] = -1;
    mirror[12] = 2 * middle[0];
    int *codes = memory_zeroed(atlas->volume_count, sizeof *codes);
    if (!codes) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < atlas->volume_count; i++) {
        codes[i] = atlas->volumes[i].info.space_code;
    }
    /* What can fail comes before the mirror, which is the last. */
    const size_t before = atlas->exchanged;
    size_t count = atlas->notes.count;
    atlas->notes.sink = NULL; /* until it is done; and of what the mirror itself would say */
    atlas->exchanged = 0;
    conus_status status =
        notes_add(&atlas->notes, "left and right of its places were exchanged, about x = %.4g mm", middle[0]);
    status = status ? status : note_swapped(atlas, middle);
    size_t own = atlas->notes.count;
    status = status ? status : atlas_move(atlas, mirror, "the exchange of sides");
    notes_cut(&atlas->notes, status ? count : own);
    atlas->notes.sink = sink;
    if (status) {
        atlas->exchanged = before;
    } else {
        drop_note(atlas, before);
        notes_tell(&atlas->notes);
        atlas->is_mirrored = stays_known;
        atlas->brain = brain;
        for (size_t i = 0; i < atlas->volume_count; i++) {
            atlas->volumes[i].info.space_code = codes[i];
        }
    }
    memory_free(codes);
    return status;
}

const char *conus_atlas_exchanged(const conus_atlas *atlas)
{
    return atlas->exchanged ? conus_atlas_note(atlas, atlas->exchanged - 1) : NULL;
}
