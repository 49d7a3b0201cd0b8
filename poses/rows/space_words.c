/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the words of spaces and units in sentences. */
#include "poses/rows/pose_row.h"

#include "base/geometry/math3.h"
#include "conus/atlas.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* How much a word says by itself. */
enum weight {
    STRONG,
    WEAK,     /* next to a word for positions */
    ALONE,    /* there, or where the sentence says nothing else */
    CAPITALS, /* the same, the latter only in capitals */
    LONE,     /* only the latter, or behind a word for positions */
    FRONT,    /* before one for a space, in a sentence without MNI: "patient space", not "coordinates of patient 3" */
    FROM,     /* behind from, to */
    ORIGIN,   /* there, or in a sentence with origin */
    AT        /* behind "origin at" */
};

enum { TOKENS = 64, SIGNS = 100, CELL_TOKENS = 4 };

static const char why_origin[] =
    "counted from a point that is not the atlas's origin; bring them to its space, for which a shift is not enough";
static const char why_bregma[] =
    "counted from bregma; --space bregma reads them as AP, ML, DV, and needs an atlas of the Allen CCF";
const char space_why_dura[] = "counted from a surface whose place is not known here: conus counts from bregma. Add the "
                              "surface's DV (the dura's, the skull's) to each, and call the column DV";
static const char why_code[] = "a code of axes"; /* space_words_why() says more */
const char space_why_voxels[] = "voxels, not mm: convert them to mm of the atlas's space";

static const struct row {
    const char *words; /* several of one row in one word: "ac pc" */
    enum weight weight;
    int brain; /* enum pose_brain or SIGNS */
    const char *name;
    const char *why; /* positions cannot be taken, whatever the atlas */
} rows[] = {
    {"mni305/fsaverage/mni 305", STRONG, POSE_BRAIN_MNI305, "MNI305", NULL},
    {"talairach/tal/tlrc/mni2tal", STRONG, POSE_BRAIN_TALAIRACH, "Talairach", NULL},
    {"tk/tkr/tkras/tkrras/tkreg/tkregras/surfaceras/surface ras", STRONG, POSE_BRAIN_OTHER, "tkRAS", NULL},
    {"d99/inia19/nmtv2/nmt v2/yerkes19/waxholm/whs", STRONG, POSE_BRAIN_ANIMAL, NULL, NULL},
    {"macaque/macaca/monkey/rhesus/marmoset/baboon/rat/ferret/pig", WEAK, POSE_BRAIN_ANIMAL, NULL, NULL},
    {"mouse/mus musculus", WEAK, POSE_BRAIN_MOUSE, NULL, NULL},
    {"radiological", STRONG, 0, NULL,
     "left and right may be exchanged: turn the sign of x if x > 0 is left, or type --space lps if y > 0 is the back, "
     "too"},
    {"mni/mni152/icbm/icbm152", STRONG, POSE_BRAIN_MNI152, "MNI 152", NULL},
    {"mcp/earbar/earbars/ear/ears/tragus/interaural/lambda/midcommissural/posterior commissure", ORIGIN, 0, NULL,
     why_origin},
    {"dura/pia/skull surface/skull/brain surface/cortical surface", ORIGIN, 0, NULL, space_why_dura},
    {"ear bar zero/earbar zero/interaural zero/ebz/interaural line", STRONG, 0, NULL, why_origin},
    {"ac/anterior commissure", FROM, 0, NULL, why_origin}, /* MNI's origin is often called so */
    {"bregma", FROM, 0, NULL, why_bregma},
    {"bregma", AT, 0, NULL, why_bregma},
    {"bregma", ALONE, 0, NULL, why_bregma},
    {"nasion/inion/vertex/preauricular/pc/corner/first voxel/center/centre", AT, 0, NULL, why_origin},
    {"mcp/midcommissural/interaural", WEAK, 0, NULL, why_origin},
    {"native/scanner/acpc/ac pc/dicom", ALONE, POSE_BRAIN_SUBJECT, NULL, NULL},
    {"leksell/crw/scs/ctf", ALONE, POSE_BRAIN_FRAME, NULL, NULL},
    {"individual/head/device", WEAK, POSE_BRAIN_SUBJECT, NULL, NULL},
    {"freesurfer/brainvoyager", WEAK, POSE_BRAIN_OTHER, NULL, NULL},
    {"t1/t1w/t2/t2w/ct/flair/mri/patient/patient s/subject/subject s/participant/frame", FRONT, POSE_BRAIN_SUBJECT,
     NULL, NULL},
    {"voxel/voxels/vox/ijk", ALONE, 0, NULL, space_why_voxels},
    {"matrix", WEAK, 0, NULL, space_why_voxels},
    {"array index/array indices/array coordinates/index coordinates/python indices/numpy indices/matlab indices/"
     "zero based/one based/0 based/1 based/zero indexed/one indexed/0 indexed/1 indexed",
     LONE, 0, NULL, space_why_voxels},
    {"ras/lps/dicom/itk", WEAK, SIGNS, NULL, NULL},
    {"rai/lpi/las/lai/rpi/rps/ral/lar", ALONE, 0, NULL, why_code},
    {"asr/ars/ari/ali/pri/psr/sra/srp/sla/slp/sar/ira/irp/ilp/iar/ial/lsa/lia/ria", CAPITALS, 0, NULL, why_code},
    {"ipr/ipl/spr/spl/asl/pir/pil/als/ail/prs/pls/pli/psl/sal/ila/rsa/rsp/lsp", WEAK, 0, NULL,
     why_code}, /* also names of areas, with or without a side, methods, diseases; lip, air and rip are words */
};

static const struct {
    const char *names;
    double mm;     /* SPACE_UNIT_REFUSED: known, and not taken */
    bool is_short; /* a word of other things, too: only in brackets, or behind in, unit */
} units[] = {
    {"mm/millimetre/millimetres/millimeter/millimeters", 1, false},
    {"um/\xc2\xb5m/\xce\xbcm/micron/microns/micrometre/micrometres/micrometer/micrometers", 0.001, false},
    {"cm/centimetre/centimetres/centimeter/centimeters", 10, true},
    {"m/metre/metres/meter/meters", 1000, true},
    {"inch/inches/px/pixel/pixels", SPACE_UNIT_REFUSED, false},
    {"in/ft/feet", SPACE_UNIT_REFUSED, true},
};

enum { UNITS = sizeof units / sizeof units[0] };

const char space_why_unit[] = "a unit that is not taken; convert to mm, um, cm or m";

double space_unit_mm(struct text name)
{
    for (size_t i = 0; i < UNITS; i++) {
        if (text_is_one_of(name, units[i].names, false)) {
            return units[i].mm;
        }
    }
    return 0;
}

/* BIDS, appendix on coordinate systems; names that laboratories give to a subject's own; those of FreeSurfer's
 * surfaces, which count from the middle of the voxels, not as the scanner does. */
static const struct {
    const char *prefix; /* of the name, or of what is behind its last "_" (sub-01_T1w); in any case */
    enum pose_brain brain;
} brains[] = {
    {"MNI152", POSE_BRAIN_MNI152},      {"Talairach", POSE_BRAIN_TALAIRACH},
    {"MNI305", POSE_BRAIN_MNI305},      {"MNIColin27", POSE_BRAIN_COLIN27},
    {"fsaverage", POSE_BRAIN_MNI305},   {"fsLR", POSE_BRAIN_TEMPLATE},
    {"ICBM452", POSE_BRAIN_TEMPLATE},   {"IXI549", POSE_BRAIN_TEMPLATE},
    {"NIHPD", POSE_BRAIN_TEMPLATE},     {"OASIS30", POSE_BRAIN_TEMPLATE},
    {"UNCInfant", POSE_BRAIN_TEMPLATE}, {"ScanRAS", POSE_BRAIN_SUBJECT},
    {"scanner", POSE_BRAIN_SUBJECT},    {"individual", POSE_BRAIN_SUBJECT},
    {"ACPC", POSE_BRAIN_SUBJECT},       {"fsnative", POSE_BRAIN_SUBJECT},
    {"native", POSE_BRAIN_SUBJECT},     {"subject", POSE_BRAIN_SUBJECT},
    {"patient", POSE_BRAIN_SUBJECT},    {"anat", POSE_BRAIN_SUBJECT},
    {"orig", POSE_BRAIN_SUBJECT},       {"T1", POSE_BRAIN_SUBJECT},
    {"T2", POSE_BRAIN_SUBJECT},         {"FLAIR", POSE_BRAIN_SUBJECT},
    {"CT", POSE_BRAIN_SUBJECT},         {"tk", POSE_BRAIN_OTHER},
    {"surface", POSE_BRAIN_OTHER},      {"FreeSurfer", POSE_BRAIN_OTHER},
    {"D99", POSE_BRAIN_ANIMAL},         {"NMT", POSE_BRAIN_ANIMAL},
    {"INIA19", POSE_BRAIN_ANIMAL},      {"Yerkes19", POSE_BRAIN_ANIMAL},
    {"MBM", POSE_BRAIN_ANIMAL},         {"WHS", POSE_BRAIN_ANIMAL},
    {"Fischer344", POSE_BRAIN_ANIMAL},  {"MouseIn", POSE_BRAIN_MOUSE},
    {"n/a", POSE_BRAIN_OTHER},
};

enum pose_brain space_brain_named(struct text name)
{
    for (size_t i = 0; i < sizeof brains / sizeof brains[0]; i++) {
        size_t length = strlen(brains[i].prefix);
        if (name.size >= length && strncasecmp(name.data, brains[i].prefix, length) == 0) {
            return brains[i].brain;
        }
    }
    const char *last = text_last(name, '_');
    size_t skipped = last ? (size_t)(last + 1 - name.data) : 0;
    return last ? space_brain_named((struct text){last + 1, name.size - skipped}) : POSE_BRAIN_UNKNOWN;
}

struct sentence {
    const char *begin;
    struct text tokens[TOKENS];
    size_t count;
    const char *end;
    bool is_whole;   /* its line says nothing else */
    bool is_of_axes; /* it says which columns are which, and nothing else: each word is of the positions */
};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || (unsigned char)c >= 0x80;
}

static bool is_upper(struct text token)
{
    size_t i = 0;
    while (i < token.size && token.data[i] >= 'A' && token.data[i] <= 'Z') {
        i++;
    }
    return i == token.size;
}

static bool token_is(const struct sentence *sentence, size_t index, const char *words)
{
    return index < sentence->count && text_is_one_of(sentence->tokens[index], words, false);
}

/* How many of the tokens before this one, and from it on, are nothing but the words. */
static size_t run_before(const struct sentence *sentence, size_t index, const char *words)
{
    size_t count = 0;
    while (count < index && token_is(sentence, index - count - 1, words)) {
        count++;
    }
    return count;
}

static size_t run_from(const struct sentence *sentence, size_t index, const char *words)
{
    size_t count = 0;
    while (token_is(sentence, index + count, words)) {
        count++;
    }
    return count;
}

/* How many tokens from this one on are one of the words, of which some are several tokens; 0: they are none. */
static size_t token_phrase(const struct sentence *sentence, size_t index, const char *words)
{
    struct text rest = text_from(words);
    struct text phrase;
    struct text word;
    size_t found = 0;
    for (bool more = true; !found && text_field(&rest, '/', &more, &phrase);) {
        size_t count = 0;
        bool fits = index < sentence->count && (*phrase.data | 0x20) == (*sentence->tokens[index].data | 0x20);
        while (fits && text_word(&phrase, &word)) {
            const size_t at = index + count++;
            fits = at < sentence->count && word.size == sentence->tokens[at].size &&
                   text_contains(sentence->tokens[at], word);
        }
        found = fits ? count : 0;
    }
    return found;
}

/* Whether a token is a word of one of the phrases. */
static bool is_word_of(struct text token, const char *phrases)
{
    bool found = false;
    for (const char *at = phrases; !found && *at; at += strcspn(at, "/ "), at += *at != 0) {
        const struct text word = {at, strcspn(at, "/ ")};
        found = word.size == token.size && text_contains(word, token);
    }
    return found;
}

static bool is_context(const struct sentence *sentence, size_t index)
{
    return token_is(sentence, index, "coordinate/coordinates/coords/position/positions/space/system/frame/xyz") ||
           token_phrase(sentence, index, "x y z") || (index >= 2 && token_phrase(sentence, index - 1, "y z/ml dv"));
}

/* Words beside which voxels, RAS and LPS, or RPI, are those of positions, */
static const char of_voxels[] = "coord/coordsystem/coordinatesystem/coordsys/indices/index";
static const char of_signs[] = "coord/coordsystem/coordinatesystem/coordsys/convention/axes";
#define ORDERS "convention/axes/axis/axcodes/orientation/orient/order"
static const char of_codes[] = "coord/coordsystem/coordinatesystem/coordsys/" ORDERS;
static const char of_animals[] = "atlas/brain/template";

/* but the last two not where the sentence says one of an image: "image axes: LPS" is how its voxels lie. */
static const char of_images[] = "image/images/scan/scans/volume/volumes/voxel/voxels/grid/nifti/nii/mri/mr/ct/t1/t1w/"
                                "t2/t2w/flair/acquisition/acquired/resampled";

/* Whether one of these words is the neighbour of so many tokens, but for small words between. */
static bool is_next_to(const struct sentence *sentence, size_t index, size_t count, const char *words,
                       bool or_positions)
{
    static const char small[] = "in/the/are/is/of/unit/units/native/scanner/ras/lps/mni/mni152/not/g/t1/t1w";
    const size_t before = index - run_before(sentence, index, small);
    const size_t behind = index + count + run_from(sentence, index + count, small);
    return (before && token_is(sentence, before - 1, words)) || token_is(sentence, behind, words) ||
           (or_positions && ((before && is_context(sentence, before - 1)) || is_context(sentence, behind)));
}

/* The same of a word for positions, or one of these. */
static bool has_context(const struct sentence *sentence, size_t index, size_t count, const char *others)
{
    return is_next_to(sentence, index, count, others, true);
}

static void keep(struct space_words *words, struct text heard, const struct row *row)
{
    bool is_origin = row->why == why_origin || row->why == space_why_dura;
    bool may_be_own = words->why == why_bregma || words->why == why_code; /* of the space that was asked for */
    bool is_better = !words->heard[0] || (row->why && !words->why) || (is_origin && may_be_own) ||
                     (words->space.brain == POSE_BRAIN_MNI152 && row->brain != POSE_BRAIN_MNI152);
    if (row->brain == SIGNS) {
        conus_space signs = text_equal_ignoring_case(heard, "ras") ? CONUS_SPACE_RAS : CONUS_SPACE_LPS;
        if (words->has_signs && words->signs != signs) {
            words->why = "one in one place, the other in another, and only one is right";
            snprintf(words->heard, sizeof words->heard, "RAS, LPS");
        }
        words->has_signs = true;
        words->signs = signs;
        return;
    }
    words->says_mni = words->says_mni || row->brain == POSE_BRAIN_MNI152;
    if (!is_better) {
        return;
    }
    snprintf(words->heard, sizeof words->heard, "%.*s", TEXT_SHOW(heard, sizeof words->heard - 1));
    words->why = row->why;
    if (!row->why) {
        words->space = pose_space_named(row->name ? text_from(row->name) : heard, (enum pose_brain)row->brain);
    }
}

/* Whether a sentence is nothing but these words, and perhaps a unit. */
static bool is_alone(const struct sentence *sentence, const char *words)
{
    static const char small[] = "in/the/are/all/points/coordinates/positions/mm/cm/um/m";
    bool all = true;
    for (size_t i = 0; i < sentence->count; i++) {
        all = all && (token_is(sentence, i, small) || is_word_of(sentence->tokens[i], words));
    }
    return all;
}

/* Whether the word is the only one that its sentence says, as a row needs it. */
static bool is_said_alone(const struct sentence *sentence, const struct text token, const struct row *row)
{
    const bool is_one = row->brain == SIGNS || (sentence->is_whole && (row->weight == ALONE || row->weight == LONE ||
                                                                       (row->weight == CAPITALS && is_upper(token))));
    return is_one && is_alone(sentence, row->words);
}

/* Whether one of the phrases stands anywhere. */
static bool has_token(const struct sentence *sentence, const char *words)
{
    size_t i = 0;
    while (i < sentence->count && !token_phrase(sentence, i, words)) {
        i++;
    }
    return i < sentence->count;
}

/* Whether so many words stand behind "from the", "to the"; *origin: or behind "origin at the", "relative to the", which
 * is not of a signal, or before "is the origin". */
static bool is_behind_from(bool *origin, const struct sentence *sentence, size_t index, size_t count)
{
    static const char small[] = "the/a/from/to/surface/mid",
                      others[] = "at/in/is/was/as/lies/on/of/set/placed/located/defined/left/right/lower/upper/top/"
                                 "bottom/image/volume/grid/0/the/a",
                      behind[] = "is/was/as/the",
                      of_signals[] = "signal/power/frequency/potential/potentials/latency/amplitude/phase/voltage";
    const size_t before = index - run_before(sentence, index, others);
    const size_t after = index + count + run_from(sentence, index + count, behind);
    bool near = index && token_is(sentence, index - 1, "from/to");
    bool is_relative = before > 1 && token_phrase(sentence, before - 2, "relative to");
    *origin = (before && token_is(sentence, before - 1, "origin")) ||
              (is_relative && !has_token(sentence, of_signals)) ||
              (after > index + count && token_is(sentence, after, "origin"));
    return near || (index >= 2 && token_is(sentence, index - 1, small) && token_is(sentence, index - 2, "from/to"));
}

static bool is_heard(const struct sentence *sentence, size_t index, const struct row *row, bool of_coordinates)
{
    const size_t count = token_phrase(sentence, index, row->words);
    if (!count) {
        return false;
    }
    if (row->brain == POSE_BRAIN_TALAIRACH ||
        row->brain == POSE_BRAIN_MNI305) { /* brought to MNI, or a program's labels */
        bool is_from = index && token_is(sentence, index - 1, "from") && has_token(sentence, "mni/mni152") &&
                       has_token(sentence, "converted/transformed/brought");
        return !is_from && !has_token(sentence, "label/labels/daemon/to mni/to mni152");
    }
    if (row->weight >= FROM) {
        bool at_origin;
        const bool near = is_behind_from(&at_origin, sentence, index, count);
        return row->weight == AT ? at_origin : near || (row->weight == ORIGIN && has_token(sentence, "origin"));
    }
    if (row->weight == FRONT) { /* headers and cells have lists of their own */
        bool is_before = token_is(sentence, index + count, "space/coordinates/coordinate/coords/system/frame") &&
                         sentence->tokens[index + count].data[-1] != '_'; /* of the name of a file */
        return !of_coordinates && !has_token(sentence, "mni/mni152/icbm/icbm152") &&
               (is_before || (index && token_is(sentence, index - 1, "space")) ||
                (index > 1 && token_phrase(sentence, index - 2, "coord frame"))); /* MNE's */
    }
    bool is_animal = row->brain == POSE_BRAIN_ANIMAL || row->brain == POSE_BRAIN_MOUSE;
    const char *others = is_animal                        ? of_animals
                         : row->why == space_why_voxels   ? of_voxels
                         : has_token(sentence, of_images) ? ""
                         : row->brain == SIGNS            ? of_signs
                         : row->why == why_code           ? of_codes
                                                          : "";
    return row->weight == STRONG || of_coordinates || sentence->is_of_axes ||
           (row->weight != LONE && has_context(sentence, index, count, others)) ||
           is_said_alone(sentence, sentence->tokens[index], row);
}

static void hear_unit(struct space_words *words, const struct sentence *sentence, size_t index, bool in_brackets,
                      bool of_coordinates)
{
    const struct text token = sentence->tokens[index];
    bool is_or = index >= 2 && token_is(sentence, index - 1, "or") && space_unit_mm(sentence->tokens[index - 2]) != 0;
    bool is_said = is_or || (index && token_is(sentence, index - 1, "in/unit/units"));
    const size_t before = index >= 3 && token_is(sentence, index - 2, "are/is") ? index - 3 : index - 2;
    bool of_all = index >= 2 && token_is(sentence, before, "all/values/numbers/everything"); /* "all values in cm" */
    bool is_small = token_is(sentence, index, "in") && !in_brackets && !(of_coordinates && sentence->count == 1);
    for (size_t i = 0; i < UNITS && !is_small; i++) {
        bool is_all = sentence->is_whole && (token.size > 1 || is_said) && is_alone(sentence, units[i].names);
        bool fits = text_is_one_of(token, units[i].names, false) &&
                    (of_coordinates || sentence->is_of_axes || is_all ||
                     ((is_said || in_brackets || !units[i].is_short) &&
                      (is_or || has_context(sentence, index, 1, "") || (is_said && of_all) ||
                       token_is(sentence, index - !!index, "unit/units"))));
        if (fits && units[i].mm == SPACE_UNIT_REFUSED) {
            words->why = space_why_unit;
            snprintf(words->heard, sizeof words->heard, "%.*s", TEXT_SHOW(token, sizeof words->heard - 1));
        } else if (fits) {
            words->are_two = words->are_two || (words->mm > 0 && words->mm != units[i].mm);
            words->mm = units[i].mm;
        }
    }
}

static struct sentence take_apart(struct text text)
{
    struct sentence sentence = {.begin = text.data, .end = text.data + text.size};
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
    return sentence;
}

/* What stands beside the names of axes in a line that says which columns are which, */
static const char beside_axes[] =
    "the/of/all/are/is/as/and/to/in/on/from/each/row/rows/line/lines/file/column/columns/col/cols/field/fields/format/"
    "header/axis/axes/order/ordered/convention/direction/directions/orientation/coordinate/coordinates/coord/coords/"
    "position/positions/pos/point/points/location/locations/loc/unit/units/value/values/data/space/system/frame/image/"
    "standard/template/positive/increasing/increases/toward/towards/based/index/indices/zero/one/first/second/third/"
    "peak/max/centroid/center/centre/0/1/2/3/152/305/2009c";

/* other columns, and what is said of the sides of some: "left hemisphere: x negative". */
static const char other_words[] =
    "name/names/label/labels/id/nr/no/roi/region/area/contact/electrode/channel/site/radius/angle/depth/dx/dy/dz/tx/ty/"
    "tz/entry/target/hemisphere/hemispheres/side/sign/signs/was/were/has/have/been/pointing/grows/grow/negative";

static const char turned[] = "flip/flipped/mirrored/inverted/negated/reversed/swapped";

/* Names of axes: to the right, front and top, and to which side of these; 0: of neither. */
static const struct {
    const char *words;
    int axis, side;
    bool is_spelled; /* also a word of areas: "left posterior superior" */
    const char *exact;
} axes[] = {
    {"r", 0, 1, false, ""},
    {"l", 0, -1, false, ""},
    {"a", 1, 1, false, ""},
    {"p", 1, -1, false, ""},
    {"s", 2, 1, false, ""},
    {"i", 2, -1, false, ""},
    {"right", 0, 1, true, ""},
    {"left", 0, -1, true, ""},
    {"anterior/front", 1, 1, true, ""},
    {"posterior/back", 1, -1, true, ""},
    {"superior/up/top", 2, 1, true, ""},
    {"inferior/down/bottom", 2, -1, true, ""},
    {"lr/rl/ml/lm/lat", 0, 0, false, ""},
    {"lateral/medial/mediolateral", 0, 0, true, ""},
    {"ap/pa", 1, 0, false, ""},
    {"rostral/caudal/anteroposterior", 1, 0, true, ""},
    {"si/dv/vd/vert", 2, 0, false, "IS"},
    {"dorsal/ventral/vertical/dorsoventral", 2, 0, true, ""},
};

enum { AXES = sizeof axes / sizeof axes[0] };

/* Whether a token is a word of spaces or units, or one that stands beside these. */
static bool is_beside(struct text token)
{
    bool is_one = text_is_one_of(token, beside_axes, false) || space_unit_mm(token) != 0;
    for (size_t r = 0; r < sizeof rows / sizeof rows[0] && !is_one; r++) {
        is_one = rows[r].weight != LONE && rows[r].weight != AT && is_word_of(token, rows[r].words);
    }
    return is_one;
}

bool space_words_are_beside(struct text text)
{
    const struct sentence sentence = take_apart(text);
    bool all = sentence.count > 0;
    for (size_t i = 0; i < sentence.count; i++) {
        all = all && is_beside(sentence.tokens[i]);
    }
    return all;
}

enum { NAMED = 3 };

/* What a sentence says of axes. */
struct named_axes {
    int axis[NAMED], side[NAMED]; /* in its order; two names of one axis beside each other are of no side */
    int letter[NAMED];            /* 0: x */
    size_t count, letters;        /* count may be more */
    size_t words;                 /* that name axes */
    size_t units, minuses;        /* minuses: letters behind one */
    size_t defined;               /* letters: "L, left; R, right; A, anterior; P, posterior" */
    bool of_voxels;
    bool is_spelled;
    bool is_turned;   /* "x flipped" */
    bool is_negative; /* "left is negative", "x < 0: left", "-x is left" */
    bool is_positive; /* "left is positive", "left +" */
    bool is_alone;    /* one axis or two: "x is left", or what turns some */
    bool has_other;   /* other_words, or what turns axes */
    bool are_odd;     /* three, and not of three axes: "order: A P S" */
    bool are_words;   /* of the closed list, all of them */
};

static bool has_all(const int values[NAMED], size_t count)
{
    int seen = 0;
    for (size_t i = 0; i < count && i < NAMED; i++) {
        seen |= 1 << values[i];
    }
    return seen == 7;
}

static void add_axis(struct named_axes *out, int axis, int side, bool is_spelled, bool is_end)
{
    const size_t last = out->count - 1;
    if (out->count && last < NAMED && out->axis[last] == axis) {
        out->side[last] = is_end ? side : 0; /* "right to left", "right-left" */
    } else if (out->count++ < NAMED) {
        out->axis[last + 1] = axis;
        out->side[last + 1] = side;
    }
    out->is_spelled = out->is_spelled || is_spelled;
    out->words++;
}

static void add_letter(struct named_axes *out, int letter)
{
    bool is_new = out->letters < NAMED;
    for (size_t i = 0; i < out->letters; i++) {
        is_new = is_new && out->letter[i] != letter;
    }
    if (is_new) {
        out->letter[out->letters++] = letter;
    }
}

/* "zyx". */
static bool is_letters(struct text token)
{
    int seen = 0;
    for (size_t i = 0; i < token.size && token.size == NAMED; i++) {
        const int letter = (token.data[i] | 0x20) - 'x';
        seen |= letter >= 0 && letter < NAMED ? 1 << letter : 8;
    }
    return seen == 7;
}

/* "-x", not "left-x". */
static bool has_minus(const struct sentence *sentence, size_t index)
{
    const struct text token = sentence->tokens[index];
    const char *begin = index ? sentence->tokens[index - 1].data + sentence->tokens[index - 1].size : sentence->begin;
    return token.data > begin && token.data[-1] == '-' && (token.data - 1 > begin || !index);
}

/* The row of axes that a word names; AXES: none. */
static size_t axis_named(struct text token)
{
    size_t k = 0;
    while (k < AXES && !(text_is_one_of(token, axes[k].words, false) || text_is_one_of(token, axes[k].exact, true))) {
        k++;
    }
    return k;
}

/* "L, left": the name of an axis behind its letter. */
static bool is_definition(size_t letter, size_t name)
{
    return letter < AXES && axes[name].is_spelled && !axes[letter].is_spelled && axes[name].side &&
           axes[name].axis == axes[letter].axis && axes[name].side == axes[letter].side;
}

/* "x flipped", not "flipped: no". */
static bool turns(const struct sentence *sentence, size_t index)
{
    return token_is(sentence, index, turned) && !token_is(sentence, index + 1, "no/none/false/0");
}

/* What a word says of the sides and signs of the others. */
static void add_sign(struct named_axes *out, const struct sentence *sentence, size_t index)
{
    const struct text token = sentence->tokens[index];
    const char *end = index + 1 < sentence->count ? sentence->tokens[index + 1].data : sentence->end;
    const size_t gap = (size_t)(end - token.data);
    out->is_turned = out->is_turned || turns(sentence, index);
    out->is_negative = out->is_negative || token_is(sentence, index, "negative") || memchr(token.data, '<', gap);
    out->is_positive = out->is_positive || token_is(sentence, index, "positive") || memchr(token.data, '+', gap) ||
                       memchr(token.data, '>', gap);
}

/* Adds a word that names no axis; false where it is not among those that stand beside these. */
static bool add_other(struct named_axes *out, const struct sentence *sentence, size_t index)
{
    const struct text token = sentence->tokens[index];
    const bool is_other = turns(sentence, index) || text_is_one_of(token, other_words, false);
    out->has_other = out->has_other || is_other;
    return is_other || is_beside(token) || (out->of_voxels && text_is_one_of(token, "j/k/slice", false));
}

/* Adds a word; `before` is the axis that the one before names, and becomes this one's. */
static bool add_word(struct named_axes *out, const struct sentence *sentence, size_t index, size_t *before)
{
    const struct text token = sentence->tokens[index];
    const size_t k = axis_named(token);
    const size_t last = *before;
    *before = k;
    add_sign(out, sentence, index);
    out->units += space_unit_mm(token) != 0;
    if (k < AXES) {
        out->defined += is_definition(last, k);
        add_axis(out, axes[k].axis, axes[k].side, axes[k].is_spelled, index && token_is(sentence, index - 1, "to"));
    } else if (text_is_one_of(token, "x/y/z", false) || is_letters(token)) {
        const bool is_minus = token.size == 1 && has_minus(sentence, index);
        out->is_negative = out->is_negative || is_minus;
        out->minuses += is_minus;
        for (size_t j = 0; j < token.size; j++) {
            add_letter(out, (token.data[j] | 0x20) - 'x');
        }
    } else {
        return add_other(out, sentence, index);
    }
    return true;
}

/* Whether a sentence says which columns are which, and nothing else, in a closed list of words: "columns: AP LAT VERT
 * (mm)". */
static bool find_axes(struct named_axes *out, const struct sentence *sentence)
{
    bool all = true;
    size_t before = AXES;
    *out = (struct named_axes){.of_voxels = has_token(sentence, "i/row") && has_token(sentence, "j/col/column") &&
                                            has_token(sentence, "k/slice")};
    for (size_t i = 0; i < sentence->count && all; i++) {
        all = add_word(out, sentence, i, &before);
    }
    /* "all points mirrored to the left hemisphere" lie there */
    out->is_turned = out->is_turned && !(out->count == 1 && !out->letters && has_token(sentence, "to/onto"));
    const bool are_letters = out->letters == NAMED;
    out->is_turned = out->is_turned || (are_letters && !out->count && out->minuses); /* "-x, -y, z" */
    bool are_named = has_all(out->axis, out->count) && (are_letters || !out->is_spelled || !out->has_other) &&
                     out->defined <= NAMED; /* more are a legend */
    const bool has_sign =
        (out->is_positive || out->is_negative) && !has_token(sentence, "peak/max");     /* not of an effect */
    bool is_side = out->axis[0] == 0 && has_sign && (out->letters || out->side[0] < 0); /* "L +", not "r < 0" */
    bool is_few = (out->is_spelled || is_side) && out->count && out->count < NAMED;
    out->are_odd = out->words == NAMED && out->count > 1 && !has_all(out->axis, out->count) && !out->letters &&
                   (!out->is_spelled || has_token(sentence, "order/ordered"));
    out->are_words = all;
    out->is_alone = out->is_turned || (is_few && (out->letters == out->count || (out->count == 1 && has_sign)));
    return all && (out->is_alone || out->of_voxels || out->are_odd || are_letters || are_named || out->units >= NAMED);
}

/* "x is left, y is posterior", "left is positive": the sign of one axis, or of two. */
static void keep_signs(struct space_words *words, const struct named_axes *named)
{
    bool is_turned = named->is_turned;
    for (size_t i = 0; i < named->count && i < NAMED; i++) {
        const int side = named->is_negative ? -named->side[i] : named->side[i];
        bool is_other = named->letters && named->letter[i] != named->axis[i];
        is_turned = is_turned || is_other || (side < 0 && named->axis[i] == 2);
        words->may_be_lps = words->may_be_lps || (side < 0 && named->axis[i] < 2);
    }
    words->axes = is_turned ? SPACE_AXES_TURNED : words->axes;
}

/* The sentence from token `first` on to a comma, "and", or an axis in brackets: "x (left positive)". */
static struct sentence take_clause(const struct sentence *all, size_t first)
{
    const struct text *before = first ? &all->tokens[first - 1] : NULL;
    struct sentence clause = {.begin = before ? before->data + before->size : all->begin, .end = all->end};
    bool is_end = false;
    for (size_t i = first; i < all->count && !is_end; i++) {
        const struct text token = all->tokens[i];
        const char *next = i + 1 < all->count ? all->tokens[i + 1].data : all->end;
        clause.tokens[clause.count++] = token;
        const size_t gap = (size_t)(next - token.data);
        const bool is_sign = i > first && token_is(all, i, "positive/negative") &&
                             (axis_named(all->tokens[i - 1]) < AXES || token_is(all, i - 1, "is/are"));
        const bool before_axis = i + 1 < all->count && axis_named(all->tokens[i + 1]) < AXES;
        is_end = memchr(token.data, ',', gap) || token_is(all, i + 1, "and") || (is_sign && before_axis) ||
                 (before_axis && memchr(token.data, '(', gap));
        clause.end = next;
    }
    return clause;
}

/* "left is positive, right is negative": clauses that name one axis each at most, and some of them its sign. */
static bool hear_clauses(struct space_words *words, const struct sentence *sentence)
{
    struct space_words own = *words;
    bool all = true;
    bool is_signed = false;
    for (size_t i = 0; i < sentence->count && all; i += token_is(sentence, i, "and")) {
        const struct sentence clause = take_clause(sentence, i);
        struct named_axes named;
        const bool is_one = find_axes(&named, &clause) && named.is_alone;
        all = named.are_words && named.count <= 1;
        if (is_one && all) {
            keep_signs(&own, &named);
            is_signed = true;
        }
        i += clause.count;
    }
    *words = all ? own : *words;
    return all && is_signed;
}

static void keep_axes(struct space_words *words, const struct named_axes *named)
{
    const int *side = named->side;
    const bool are_letters = named->letters == NAMED;
    const bool are_named = has_all(named->axis, named->count);
    const bool in_order = !are_letters || (named->letter[0] == 0 && named->letter[1] == 1);
    const bool fit = are_named && in_order && named->count == NAMED && named->axis[0] == 0 && named->axis[1] == 1;
    const bool is_ras = fit && side[0] > 0 && side[1] > 0 && side[2] > 0;
    const bool is_lps = fit && side[0] < 0 && side[1] < 0 && side[2] > 0;
    const bool are_plain = are_letters && (are_named ? fit && side[0] >= 0 && side[1] >= 0 && side[2] >= 0 : in_order);
    if (named->is_alone) {
        keep_signs(words, named);
    } else if (named->of_voxels) {
        words->axes = SPACE_AXES_VOXELS;
    } else if (is_ras || (is_lps && (are_letters || !named->is_spelled))) {
        keep(words, text_from(is_ras ? "RAS" : "LPS"), &(struct row){.brain = SIGNS});
    } else if (named->are_odd) {
        words->axes = SPACE_AXES_ORDERED; /* in none that a space has */
        memset(words->order, 0, sizeof words->order);
    } else if (!are_plain && (are_named || are_letters)) {
        const int *order = are_named ? named->axis : named->letter;
        words->axes = SPACE_AXES_ORDERED;
        memcpy(words->order, order, sizeof words->order);
    }
}

bool space_words_are_axes(struct text text)
{
    const struct sentence sentence = take_apart(text);
    struct named_axes named;
    return find_axes(&named, &sentence) && !named.has_other;
}

/* Whether a sentence denies a word: "non-MNI", "rather than MNI", "not in MNI space", "MNI coordinates are not there",
 * up to a comma or the like; not "MNI coordinates not corrected". */
static bool is_denied(const struct sentence *sentence, size_t index)
{
    static const char others[] = "corrected/significant/smoothed/thresholded/shown/listed/included/reported/"
                                 "labelled/labeled/named/used/edit/final/change";
    enum { BEFORE = 6, BEHIND = 3 };
    bool found = (index && token_is(sentence, index - 1, "no/non/kein/keine/than/without/ohne")) ||
                 (index > 1 && token_phrase(sentence, index - 2, "instead of"));
    for (size_t i = 0; i < sentence->count && !found; i++) {
        const char *from = sentence->tokens[i < index ? i : index].data;
        const char *to = sentence->tokens[i < index ? index : i].data;
        bool is_near = i < index ? index - i <= BEFORE : i - index <= BEHIND;
        bool is_other = token_is(sentence, i + 1, others);
        for (const char *at = from; at < to; at++) {
            is_other = is_other || strchr(",:!?", *at);
        }
        found = is_near && !is_other && token_is(sentence, i, "not/cannot/nicht/never/neither/nor/isn/aren/wasn/weren");
    }
    return found;
}

/* Whether a token is next to a word for the order of axes, which are not those of an image. */
static bool is_of_order(const struct sentence *sentence, size_t index)
{
    return is_next_to(sentence, index, 1, ORDERS, false) && !has_token(sentence, of_images);
}

static void hear_sentence(struct space_words *words, struct text text, bool of_coordinates, bool is_whole)
{
    struct sentence sentence = take_apart(text);
    struct space_words denied = {0};
    sentence.is_whole = is_whole;
    struct named_axes named;
    sentence.is_of_axes = find_axes(&named, &sentence);
    if (hear_clauses(words, &sentence) && named.is_negative) {
        memset(named.side, 0, sizeof named.side); /* the clauses say of which side it is the sign */
    }
    if (sentence.is_of_axes) {
        keep_axes(words, &named);
    }
    static const char two_axes[] = "aps/asp/pas/psa"; /* also places: "PSA coordinates" */
    for (size_t i = 0; i < sentence.count; i++) {
        struct text token = sentence.tokens[i];
        struct space_words *out = is_denied(&sentence, i) ? &denied : words;
        const char *before = token.data > text.data ? token.data - 1 : " ";
        for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
            if (is_heard(&sentence, i, &rows[r], of_coordinates)) {
                const struct text last = sentence.tokens[i + token_phrase(&sentence, i, rows[r].words) - 1];
                keep(out, (struct text){token.data, (size_t)(last.data + last.size - token.data)}, &rows[r]);
            } else if (rows[r].brain == SIGNS && text_equal_ignoring_case(token, "lps") &&
                       (is_upper(token) || is_of_order(&sentence, i))) {
                out->may_be_lps = true;
            }
        }
        if (text_is_one_of(token, two_axes, false) && is_of_order(&sentence, i)) {
            keep(out, token, &(struct row){.why = why_code});
        }
        hear_unit(out, &sentence, i, *before == '(' || *before == '[', of_coordinates);
    }
    bool are_signs = (denied.has_signs || denied.may_be_lps) && !words->has_signs; /* "RAS, not LPS" says which */
    if (denied.heard[0] || are_signs || (denied.mm > 0 && !(words->mm > 0))) {
        words->why = "write there what they are, not what they are not";
        snprintf(words->heard, sizeof words->heard, "%.*s", TEXT_SHOW(text_trim(text), sizeof words->heard - 1));
    }
}

void space_words_hear(struct space_words *words, struct text line)
{
    const char *begin = line.data;
    const bool are_axes = space_words_are_axes(line); /* "AP;LAT;VERT" is one sentence */
    while (line.size) {
        size_t size = are_axes ? line.size : 0;
        while (size < line.size && !(line.data[size] == ';' ||
                                     (line.data[size] == '.' && size + 1 < line.size && line.data[size + 1] == ' '))) {
            size++;
        }
        hear_sentence(words, (struct text){line.data, size}, false, line.data == begin && size == line.size);
        size += size < line.size;
        line = (struct text){line.data + size, line.size - size};
    }
}

void space_words_hear_of(struct space_words *words, struct text word)
{
    hear_sentence(words, word, true, true);
}

void space_words_hear_name(struct space_words *words, struct text name)
{
    const struct sentence sentence = take_apart(name);
    const size_t extension = memchr(name.data, '.', name.size) != NULL;
    const size_t last = sentence.count > extension ? sentence.count - extension - 1 : 0;
    hear_sentence(words, name, false, false);
    const bool is_somebody = last && token_is(&sentence, last - 1, "sub/ses/subject/patient"); /* "sub-ARI" */
    bool is_code = false;
    for (size_t r = 0; last && !is_somebody && r < sizeof rows / sizeof rows[0]; r++) {
        bool counts = rows[r].weight == ALONE || (rows[r].weight == CAPITALS && is_upper(sentence.tokens[last]));
        is_code = is_code || (rows[r].why == why_code && counts && token_is(&sentence, last, rows[r].words) &&
                              !has_token(&sentence, "image/images"));
    }
    if (is_code || token_is(&sentence, last, "vox/voxels/ijk")) {
        keep(words, sentence.tokens[last], &(struct row){.why = is_code ? why_code : space_why_voxels});
    }
    words->why = words->why == why_code || words->why == space_why_voxels ? words->why : NULL;
    for (size_t i = 0; i < sentence.count; i++) {
        words->may_be_lps = words->may_be_lps || token_is(&sentence, i, "lps");
        if (!words->heard[0] && token_is(&sentence, i, "native/acpc/scanner/leksell")) {
            words->space = pose_space_named(sentence.tokens[i],
                                            token_is(&sentence, i, "leksell") ? POSE_BRAIN_FRAME : POSE_BRAIN_SUBJECT);
        }
    }
}

/* Whether a cell is words of spaces alone: each is one, or a small one beside it. */
static bool is_of_space(struct text cell, bool strong)
{
    static const char small[] =
        "space/coordinate/coordinates/system/standard/template/brain/152/305/in/the/mm/ras/lps/not/non";
    const struct sentence sentence = take_apart(cell);
    bool all = sentence.count > 0 && sentence.count <= CELL_TOKENS;
    for (size_t i = 0; i < sentence.count && all;) {
        size_t count = token_is(&sentence, i, small);
        for (size_t r = 0; r < sizeof rows / sizeof rows[0] && !count; r++) {
            bool counts = strong ? rows[r].weight == STRONG && !rows[r].why : rows[r].weight != FRONT;
            count = counts ? token_phrase(&sentence, i, rows[r].words) : 0;
        }
        all = count > 0;
        i += count;
    }
    return all;
}

bool space_words_hear_cell(struct space_words *words, struct text cell, bool strong)
{
    *words = (struct space_words){0};
    if (is_of_space(cell, strong)) {
        hear_sentence(words, cell, true, true);
    } else if (!strong && !text_equal_ignoring_case(cell, "n/a") && space_brain_named(cell)) { /* as BIDS calls it */
        words->space = pose_space_named(cell, space_brain_named(cell));
        snprintf(words->heard, sizeof words->heard, "%.*s", TEXT_SHOW(cell, sizeof words->heard - 1));
    }
    return words->space.brain || words->why || words->has_signs;
}

const char *space_words_why(char out[SPACE_WHY], const struct space_words *words)
{
    static const char letters[] = "RLAPSI";
    char ends[3][3] = {"?", "?", "?"};   /* x y z in RAS, where the letters say where axes end, */
    char begins[3][3] = {"?", "?", "?"}; /* and where they say where these begin */
    for (size_t k = 0; k < 3 && words->why == why_code && words->heard[k]; k++) {
        const char *at = strchr(letters, words->heard[k] & ~0x20);
        const size_t place = at ? (size_t)(at - letters) : 0;
        snprintf(ends[place / 2], sizeof *ends, "%s%c", place % 2 ? "-" : "", "xyz"[k]);
        snprintf(begins[place / 2], sizeof *begins, "%s%c", place % 2 ? "" : "-", "xyz"[k]);
    }
    const bool is_whole = ends[0][0] != '?' && ends[1][0] != '?' && ends[2][0] != '?';
    const bool is_lps = text_equal_ignoring_case(text_from(words->heard), "rai");
    const bool is_ras = text_equal_ignoring_case(text_from(words->heard), "lpi");
    if (words->why != why_code || !is_whole) {
        return words->why == why_code ? "a code of two axes, where three are needed" : words->why;
    }
    snprintf(
        out, SPACE_WHY,
        "AFNI says where axes begin, so that a point is (%s, %s, %s) in RAS%s; others say where they end, so that it "
        "is (%s, %s, %s): turn the columns, and write RAS",
        begins[0], begins[1], begins[2],
        is_lps   ? ", which --space lps takes"
        : is_ras ? ", which --any-space takes"
                 : "",
        ends[0], ends[1], ends[2]);
    return out;
}

const char *space_any(conus_space space)
{
    static const char *const ways[] = {
        [CONUS_SPACE_RAS] = "only if they are RAS mm of the atlas (x right, y front, z top), type --any-space",
        [CONUS_SPACE_LPS] = "only if they are LPS mm of the atlas (x left, y back, z top), type --any-space",
        [CONUS_SPACE_CCF] = "only if they are CCF (AP, DV, ML), type --any-space",
        [CONUS_SPACE_BREGMA] = "only if they are from bregma (AP, ML, DV), type --any-space",
    };
    return ways[space];
}

bool space_moves(const struct pose_space *space, const conus_pose_options *options)
{
    return space->brain == POSE_BRAIN_MNI305 && !space->is_of_path && !options->of_mni305 && !options->any_space;
}

void space_note_move(struct job *job, const struct pose_space *space)
{
    job_note(job, "positions in MNI 305 (\"%s\"), moved to MNI 152 by FreeSurfer's matrix", space->name);
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
