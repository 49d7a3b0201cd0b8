/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the words of spaces and units in sentences. */
#include "poses/rows/space_words.h"

#include "base/geometry/math3.h"
#include "conus/atlas_info.h"

#include <stdio.h>
#include <string.h>

/* How much a word says by itself. */
enum weight {
    STRONG,
    WEAK,  /* next to a word for positions */
    ORIGIN /* behind from, to */
};

enum { TOKENS = 64, MNI305 = 100, SIGNS };

static const struct row {
    const char *words;
    enum weight weight;
    int brain; /* enum pose_brain, MNI305 or SIGNS */
    const char *name;
    const char *why; /* positions cannot be taken, whatever the atlas */
} rows[] = {
    {"mni305/fsaverage", STRONG, MNI305, "MNI 305", NULL},
    {"talairach/tal/tlrc/mni2tal", STRONG, POSE_BRAIN_TALAIRACH, "Talairach", NULL},
    {"tk/tkr/tkras/tkrras/tkreg/tkregras/surfaceras", STRONG, POSE_BRAIN_OTHER, "tkRAS", NULL},
    {"radiological", STRONG, 0, NULL,
     "radiological: left and right may be exchanged; --space lps or ras says which they are"},
    {"mni/mni152/icbm/icbm152", STRONG, POSE_BRAIN_MNI152, "MNI 152", NULL},
    {"mcp/earbar/earbars/ear/interaural/lambda/dura/pia/midcommissural", ORIGIN, 0, NULL,
     "counted from a point (MCP, ear bars, lambda, dura) that the atlas does not know"},
    {"native/scanner/individual/acpc/head/device/leksell/crw/scs/ctf", WEAK, POSE_BRAIN_SUBJECT, NULL, NULL},
    {"voxel/voxels/vox/ijk/matrix", WEAK, 0, NULL,
     "voxels, which only the image that they were counted in places; mm are needed"},
    {"ras/lps", WEAK, SIGNS, NULL, NULL},
    {"rai/lpi/las/lai/rpi/rps/ral/lar/ipr/ipl/spr/spl/asr/asl/pir/pil", WEAK, 0, NULL,
     "a code of axes other than RAS and LPS, which is read in AFNI's own reports alone"},
};

/* mm each. */
static const struct {
    const char *names;
    double mm;
    bool is_short; /* a word of other things, too: only in brackets, or behind in, unit */
} units[] = {{"mm/millimetre/millimetres/millimeter/millimeters", 1, false},
             {"um/\xc2\xb5m/\xce\xbcm/micron/microns/micrometre/micrometres/micrometer/micrometers", 0.001, false},
             {"cm/centimetre/centimetres/centimeter/centimeters", 10, true},
             {"m/metre/metres/meter/meters", 1000, true}};

struct sentence {
    struct text tokens[TOKENS];
    size_t count;
};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || (unsigned char)c >= 0x80;
}

static bool token_is(const struct sentence *sentence, size_t index, const char *words)
{
    return index < sentence->count && text_is_one_of(sentence->tokens[index], words, false);
}

static bool is_context(const struct sentence *sentence, size_t index)
{
    return token_is(sentence, index, "coordinate/coordinates/coords/position/positions/space/system/frame/xyz") ||
           (token_is(sentence, index, "x") && token_is(sentence, index + 1, "y") &&
            token_is(sentence, index + 2, "z")) ||
           (token_is(sentence, index, "z") && index >= 2 && token_is(sentence, index - 1, "y")) ||
           (token_is(sentence, index, "dv") && index >= 2 && token_is(sentence, index - 1, "ml"));
}

/* Whether a word for positions is its neighbour, but for small words between. */
static bool has_context(const struct sentence *sentence, size_t index)
{
    static const char small[] = "in/the/are/is/of/unit/units/native/scanner";
    size_t before = index;
    size_t behind = index + 1;
    while (before && token_is(sentence, before - 1, small)) {
        before--;
    }
    while (token_is(sentence, behind, small)) {
        behind++;
    }
    return (before && is_context(sentence, before - 1)) || is_context(sentence, behind);
}

static void keep(struct space_words *words, struct text heard, const struct row *row)
{
    bool is_better = !words->heard[0] || (row->why && !words->why) ||
                     (words->space.brain == POSE_BRAIN_MNI152 && row->brain != POSE_BRAIN_MNI152);
    if (row->brain == SIGNS) {
        words->has_signs = true;
        words->signs = text_equal_ignoring_case(heard, "lps") ? CONUS_SPACE_LPS : CONUS_SPACE_RAS;
        return;
    }
    if (!is_better) {
        return;
    }
    snprintf(words->heard, sizeof words->heard, "%.*s", TEXT_SHOW(heard, sizeof words->heard - 1));
    words->why = row->why;
    words->is_mni305 = row->brain == MNI305;
    if (!row->why) {
        words->space = pose_space_named(row->name ? text_from(row->name) : heard,
                                        words->is_mni305 ? POSE_BRAIN_MNI152 : (enum pose_brain)row->brain);
    }
}

/* Whether a sentence is nothing but RAS or LPS, and perhaps a unit. */
static bool is_alone(const struct sentence *sentence)
{
    bool all = true;
    for (size_t i = 0; i < sentence->count; i++) {
        all = all && token_is(sentence, i, "ras/lps/in/all/points/mm/cm/um/m");
    }
    return all;
}

static bool is_heard(const struct sentence *sentence, size_t index, const struct row *row, bool of_coordinates)
{
    static const char small[] = "the/a/from/to/surface/mid";
    if (!token_is(sentence, index, row->words)) {
        return false;
    }
    if (row->brain == POSE_BRAIN_TALAIRACH) { /* brought to MNI, or a program's labels */
        bool is_other = false;
        for (size_t i = 0; i < sentence->count; i++) {
            is_other = is_other || token_is(sentence, i, "label/labels/daemon") ||
                       (token_is(sentence, i, "to") && token_is(sentence, i + 1, "mni/mni152"));
        }
        return !is_other;
    }
    if (row->weight == ORIGIN) {
        bool near = index && token_is(sentence, index - 1, "from/to");
        return near || (index >= 2 && token_is(sentence, index - 1, small) && token_is(sentence, index - 2, "from/to"));
    }
    return row->weight == STRONG || of_coordinates || has_context(sentence, index) ||
           (row->brain == SIGNS && is_alone(sentence));
}

static void hear_unit(struct space_words *words, const struct sentence *sentence, size_t index, bool in_brackets,
                      bool of_coordinates)
{
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        bool is_said = index && token_is(sentence, index - 1, "in/unit/units");
        bool fits =
            token_is(sentence, index, units[i].names) &&
            (of_coordinates || ((is_said || in_brackets || !units[i].is_short) &&
                                (has_context(sentence, index) || token_is(sentence, index - !!index, "unit/units"))));
        if (fits) {
            words->are_two = words->are_two || (words->mm > 0 && words->mm != units[i].mm);
            words->mm = units[i].mm;
        }
    }
}

static void hear_sentence(struct space_words *words, struct text text, bool of_coordinates)
{
    struct sentence sentence = {0};
    for (size_t i = 0; i < text.size && sentence.count < TOKENS;) {
        size_t size = 0;
        while (i + size < text.size && is_letter(text.data[i + size])) {
            size++;
        }
        if (size) {
            sentence.tokens[sentence.count++] = (struct text){text.data + i, size};
        }
        i += size + !size;
    }
    for (size_t i = 0; i < sentence.count; i++) {
        struct text token = sentence.tokens[i];
        const char *before = token.data > text.data ? token.data - 1 : " ";
        for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
            if (is_heard(&sentence, i, &rows[r], of_coordinates)) {
                keep(words, token, &rows[r]);
            }
        }
        if (token_is(&sentence, i, "surface") && token_is(&sentence, i + 1, "ras")) {
            keep(words, (struct text){token.data, token.size}, &rows[2]);
        }
        if (token_is(&sentence, i, "mni") && token_is(&sentence, i + 1, "305")) {
            words->heard[0] = '\0';
            keep(words, token, &rows[0]);
        }
        hear_unit(words, &sentence, i, *before == '(' || *before == '[', of_coordinates);
    }
}

void space_words_hear(struct space_words *words, struct text line)
{
    while (line.size) {
        size_t size = 0;
        while (size < line.size && !(line.data[size] == ';' ||
                                     (line.data[size] == '.' && size + 1 < line.size && line.data[size + 1] == ' '))) {
            size++;
        }
        hear_sentence(words, (struct text){line.data, size}, false);
        size += size < line.size;
        line = (struct text){line.data + size, line.size - size};
    }
}

void space_words_hear_of(struct space_words *words, struct text word)
{
    hear_sentence(words, word, true);
}

const char space_why_tkras[] =
    "FreeSurfer's tkRAS, which counts from the middle of the voxels of an image that is not in the file: save scanner "
    "RAS (Freeview has both); --any-space takes the positions as they are, for an atlas in tkRAS";

bool space_stays_in_mni305(const conus_pose_options *options)
{
    return options->atlas && conus_atlas_brain(options->atlas).brain == CONUS_BRAIN_MNI305;
}

void space_move_from_mni305(double p[3])
{
    static const double matrix[3][4] = {
        {0.9975, -0.0073, 0.0176, -0.0429}, {0.0146, 1.0009, -0.0024, 1.5496}, {-0.0130, -0.0093, 0.9971, 1.1840}};
    const double from[3] = {p[0], p[1], p[2]};
    for (int i = 0; i < 3; i++) {
        p[i] = vec3_dot(matrix[i], from) + matrix[i][3];
    }
}
