/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads --cuts: planes through a point, planes at places, and mosaics. */
#include "cli/cmd_render.h"

#include "options/messages.h"
#include "settings/settings.h"

#include "conus/own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AXIAL, CORONAL, SAGITTAL, PLANES, WORD_SIZE = 64, CUT_LIMIT = 400, MOSAIC = 12 };

#define DEFAULT_FILL 0.6

/* A contact is on the face of a voxel, where rounding would choose between the area and what is before it. */
static const double INTO = 0.001; /* mm */

/* To the right and up; perpendicular to axis 2 - plane. */
static const char *const names[PLANES] = {"axial", "coronal", "sagittal"};
static const double axes[PLANES][2][3] = {{{1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 0, 1}}, {{0, 1, 0}, {0, 0, 1}}};

const struct option cut_options[] = {
    {OPTION_VALUED("cuts", struct cut_settings, cuts, "PLANES"),
     .help = "flat cuts on one sheet, such as axial,coronal,sagittal through the best hit's middle, or axial:-10,0,10 "
             "at these places, or mosaic:N, N axial cuts (default 12); 3d among them adds the view in space",
     .words = "slices, mosaic, montage, sections", .role = OPTION_ASKS},
    {OPTION_VALUED("at", struct cut_settings, at, PLACE_VALUE), .help = "the place through which cuts go",
     .otherwise = "the best hit's middle, where most points are, the only pathway's middle, or the atlas's",
     .role = OPTION_ASKS, .flags = OPTION_IS_PLACE, .needs = "cuts"},
    {OPTION_VALUED("fill", struct cut_settings, fill, "A"), .help = "opacity of areas in cuts, 0 (outlines only) to 1",
     .standard = OPTION_DIGITS(DEFAULT_FILL), OPTION_FROM_TO(0, 1), .needs = "cuts"},
    {OPTION_NAMED("radiological", struct cut_settings, radiological),
     .help = "show the head's left on the right of axial and coronal cuts", .words = "flip, convention",
     .needs = "cuts"},
    {0},
};

/* One word of --cuts. */
struct cut_word {
    int plane;      /* PLANES = the view in space */
    size_t mosaic;  /* so many, 0 = one */
    bool has_place; /* at this coordinate */
    double place;
};

/* The word up to the next comma, and what follows it; false where it is too long. */
static bool next_word(char word[WORD_SIZE], const char **rest)
{
    size_t length = strcspn(*rest, ",");
    if (length >= WORD_SIZE) {
        return false;
    }
    memcpy(word, *rest, length);
    word[length] = '\0';
    *rest += length + ((*rest)[length] == ',');
    return true;
}

static bool read_mosaic(struct cut_word *out, const char *number)
{
    uint64_t count = MOSAIC;
    out->plane = AXIAL;
    if (*number && !(number[0] == ':' && count_parse(number + 1, UINT32_MAX, &count))) {
        return refuse("--cuts: \"mosaic%s\"; wanted is mosaic or mosaic:N", number);
    }
    if (count < 1 || count > CUT_LIMIT) {
        return refuse("--cuts: mosaic%s; allowed is 1 to %d", number, CUT_LIMIT);
    }
    out->mosaic = (size_t)count;
    return true;
}

/* `before` is the word in front of it: NULL = this is the first. */
static bool read_word(struct cut_word *out, const char *word, const struct cut_word *before)
{
    *out = (struct cut_word){.plane = PLANES};
    if (strcmp(word, "3d") == 0) {
        return true;
    }
    if (strncmp(word, "mosaic", 6) == 0 && (word[6] == ':' || word[6] == '\0')) {
        return read_mosaic(out, word + 6);
    }
    for (int p = 0; p < PLANES; p++) {
        size_t length = strlen(names[p]);
        if (strncmp(word, names[p], length) == 0 && (word[length] == ':' || word[length] == '\0')) {
            out->plane = p;
            out->has_place = word[length] == ':';
            if (out->has_place && !number_parse(word + length + 1, &out->place)) {
                return refuse("--cuts: \"%s\"; wanted is %s or %s:NUMBER", word, names[p], names[p]);
            }
            return true;
        }
    }
    if (number_parse(word, &out->place)) { /* one more place of the plane in front of it */
        if (before && before->has_place) {
            out->plane = before->plane;
            return out->has_place = true;
        }
        return refuse("--cuts: \"%s\" does not follow a plane with a place, such as axial:0", word);
    }
    return refuse("--cuts: \"%s\"; allowed are axial, coronal and sagittal, each with or without :NUMBER, mosaic[:N] "
                  "and 3d",
                  word);
}

/* Fills [CUT_LIMIT + 1] words and gives their number; 0, with a message, where one is unknown. */
static size_t read_words(struct cut_word *out, const char *text)
{
    size_t count = 0;
    size_t cuts = 0;
    bool has_space = false;
    const char *rest = text;
    do {
        char word[WORD_SIZE];
        if (!next_word(word, &rest)) {
            print_error_line("--cuts: \"%.40s...\" is no plane", rest);
            return 0;
        }
        if (!read_word(&out[count], word, count ? &out[count - 1] : NULL)) {
            return 0;
        }
        bool is_space = out[count].plane == PLANES;
        if (is_space && has_space) {
            print_error_line("--cuts: 3d stands there twice");
            return 0;
        }
        has_space = has_space || is_space;
        cuts += is_space ? 0 : out[count].mosaic ? out[count].mosaic : 1;
        count++;
        if (cuts > CUT_LIMIT) {
            print_error_line("--cuts: more than %d cuts", CUT_LIMIT);
            return 0;
        }
    } while (*rest || (rest != text && rest[-1] == ','));
    return count;
}

/* How many words there are of each sort. */
struct cut_tally {
    size_t words, through, places, space;
};

static struct cut_tally tally_words(const char *text)
{
    struct cut_word words[CUT_LIMIT + 1];
    struct cut_tally out = {.words = read_words(words, text)};
    for (size_t i = 0; i < out.words; i++) {
        out.space += words[i].plane == PLANES;
        out.places += words[i].has_place;
        out.through += words[i].plane != PLANES && !words[i].has_place && !words[i].mosaic;
    }
    return out;
}

bool render_cuts_need_space(const struct cut_settings *settings)
{
    return !settings->cuts || tally_words(settings->cuts).space;
}

bool render_cuts_have_places(const struct cut_settings *settings, const struct arguments *arguments)
{
    return option_given(arguments, "at") || (settings->cuts && tally_words(settings->cuts).places);
}

bool render_cuts_check(const struct cut_settings *settings, const struct arguments *arguments)
{
    static const char *const of_space[] = {
        "view",    "camera",          "camera-origin", "field-of-view",     "frustum", "transfer",
        "opacity", "context-opacity", "map",           "streamline-colour", "frames",  "unselected",
        "shell"};
    if (!settings->cuts) {
        return true;
    }
    struct cut_tally tally = tally_words(settings->cuts);
    if (!tally.words) {
        return false;
    }
    if (tally.words == tally.space) {
        return refuse("--cuts: 3d alone is the picture without --cuts");
    }
    for (size_t i = 0; i < sizeof of_space / sizeof of_space[0] && !tally.space; i++) {
        if (option_given(arguments, of_space[i])) {
            return refuse("--%s has no effect on cuts: --cuts 3d,... adds the view in space", of_space[i]);
        }
    }
    if (option_given(arguments, "at") && !tally.through) {
        return refuse("--at has no effect: every cut of --cuts has a place");
    }
    return true;
}

conus_cut_view render_cuts_look(const struct cut_settings *settings, const struct arguments *arguments)
{
    return (conus_cut_view){.fill = option_given(arguments, "fill") ? settings->fill : DEFAULT_FILL};
}

/* The sheet's planes in the making. */
struct cut_finder {
    const struct cut_settings *settings;
    const conus_frame *frame;
    double low[3], high[3]; /* the box around the atlas, world mm */
    double through[3];      /* world */
    conus_cut_plane *planes;
    size_t count;
};

/* The coordinate of the space that changes most along the plane's normal. */
static size_t axis_of(const struct cut_finder *finder, int plane)
{
    const double *m = finder->frame->world_from_space;
    size_t world = 2 - (size_t)plane;
    size_t best = 0;
    for (size_t a = 1; a < 3; a++) {
        best = fabs(m[4 * a + world]) > fabs(m[4 * best + world]) ? a : best;
    }
    return best;
}

static void add_plane(struct cut_finder *finder, int plane, const double at[3])
{
    conus_cut_plane *out = &finder->planes[finder->count++];
    memcpy(out->at, at, sizeof out->at);
    memcpy(out->right, axes[plane][0], sizeof out->right);
    memcpy(out->up, axes[plane][1], sizeof out->up);
    out->right[0] = finder->settings->radiological ? -out->right[0] : out->right[0];
}

/* Where the atlas begins and ends along an axis of the space, through its middle. */
static void range_of(double range[2], const struct cut_finder *finder, int plane)
{
    size_t axis = axis_of(finder, plane);
    for (int end = 0; end < 2; end++) {
        double at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = (finder->low[a] + finder->high[a]) / 2;
        }
        at[2 - plane] = end ? finder->high[2 - plane] : finder->low[2 - plane];
        conus_frame_from_world(at, finder->frame, at);
        range[end] = at[axis];
    }
    if (range[0] > range[1]) {
        double first = range[0];
        range[0] = range[1];
        range[1] = first;
    }
}

static int check_place(const struct cut_finder *finder, int plane, double place, const char *option)
{
    double range[2];
    conus_space space = finder->frame->space;
    range_of(range, finder, plane);
    return place >= range[0] && place <= range[1]
               ? EXIT_DONE
               : print_usage_error("--%s: %s = %g %s is outside of the atlas, which is from %.5g to %.5g", option,
                                   conus_space_axis(space, axis_of(finder, plane)), place, conus_space_unit(space),
                                   range[0], range[1]);
}

static int add_place(struct cut_finder *finder, int plane, double place)
{
    double at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = (finder->low[a] + finder->high[a]) / 2;
    }
    int code = check_place(finder, plane, place, "cuts");
    if (code) {
        return code;
    }
    conus_frame_from_world(at, finder->frame, at);
    at[axis_of(finder, plane)] = place;
    if (conus_frame_to_world(at, finder->frame, at)) {
        return print_usage_error("--cuts: %s", conus_message());
    }
    add_plane(finder, plane, at);
    return EXIT_DONE;
}

/* In equal steps about the atlas's middle, which are as many layers of it; of a whole number, at whole ones, where
 * these cover nine tenths of it and stay in it. */
static int add_mosaic(struct cut_finder *finder, int plane, size_t count)
{
    double range[2];
    range_of(range, finder, plane);
    const double size = range[1] - range[0];
    const double layer = size / (double)count;
    const double steps = (double)count - 1;
    const double whole = steps * rint(layer) <= size - 1 ? rint(layer) : floor(layer);
    const bool is_whole = layer >= 2 && whole * (double)count >= 0.9 * size;
    const double step = is_whole ? whole : layer;
    const double first = (range[0] + range[1] - steps * step) / 2;
    const double digit = is_whole ? 1 : layer >= 1 ? 10 : 1000; /* all places have as many */
    int code = EXIT_DONE;
    for (size_t i = 0; i < count && !code; i++) {
        code = add_place(finder, plane, rint(digit * (first + (double)i * step)) / digit);
    }
    return code;
}

/* The middle of what a ray passes of the object; false where that is not known, as of an open surface. */
static bool find_middle(double out[3], conus_selector *selector, const conus_pose *ray, uint32_t object)
{
    static const char *const ends[2][3] = {{"entry_x", "entry_y", "entry_z"}, {"exit_x", "exit_y", "exit_z"}};
    conus_table *segments = NULL;
    bool found = false;
    const size_t count = conus_segments(&segments, selector, ray) ? 0 : conus_table_rows(segments);
    for (size_t i = 0; i < count && !found; i++) {
        found = conus_table_objects(segments)[i] == object && isfinite(conus_table_numbers(segments, "exit_mm")[i]);
        for (int a = 0; a < 3 && found; a++) {
            out[a] = (conus_table_numbers(segments, ends[0][a])[i] + conus_table_numbers(segments, ends[1][a])[i]) / 2;
        }
    }
    conus_table_destroy(segments);
    return found;
}

/* The middle of the object on the ray through the contact: from a cone's apex, or in a tube along the axis, which is
 * the ray to take where it passes the object. Else the contact. */
static void find_hit(double out[3], conus_selector *selector, const conus_result *hit, const conus_pose *pose,
                     bool is_tube)
{
    const double *m = pose->world_from_device;
    conus_pose ray = *pose;
    double *from = ray.world_from_device + 12;
    bool found = is_tube && find_middle(out, selector, pose, hit->object);
    if (!found && is_tube) {
        double along = 0;
        for (int a = 0; a < 3; a++) {
            along += (hit->contact[a] - m[12 + a]) * m[8 + a];
        }
        for (int a = 0; a < 3; a++) {
            from[a] = hit->contact[a] - along * m[8 + a];
        }
    }
    const bool has_ray = is_tube || !conus_pose_toward(&ray, m + 12, hit->contact, NULL);
    found = found || (has_ray && find_middle(out, selector, &ray, hit->object));
    for (int a = 0; a < 3 && !found; a++) {
        out[a] = hit->contact[a] - INTO * m[8 + a];
    }
}

/* The middle of the only pathway, as of a lesion; else `out` stays. */
static void find_pathway(double out[3], const conus_atlas *atlas)
{
    size_t count = 0;
    size_t only = 0;
    for (size_t k = 1; k <= conus_atlas_object_count(atlas); k++) {
        const bool is = conus_atlas_object(atlas, k)->kind == CONUS_KIND_PATHWAY;
        count += is;
        only = is ? k : only;
    }
    double centre[3];
    if (count == 1 && !conus_atlas_centre(centre, atlas, only)) {
        memcpy(out, centre, sizeof centre);
    }
}

/* --at, the middle of the best hit, without a pose that of the only pathway, or that of the atlas. */
static int find_point(struct cut_finder *finder, const double *given, const conus_atlas *atlas,
                      conus_selector *selector, const conus_selection *selection, const conus_pose *pose, bool is_tube)
{
    for (int a = 0; a < 3; a++) {
        finder->through[a] = (finder->low[a] + finder->high[a]) / 2;
    }
    if (given) {
        double at[3];
        int code = EXIT_DONE;
        memcpy(finder->through, given, sizeof finder->through);
        conus_frame_from_world(at, finder->frame, given);
        for (int p = 0; p < PLANES && !code; p++) {
            code = check_place(finder, p, at[axis_of(finder, p)], "at");
        }
        return code;
    }
    if (!selection) {
        find_pathway(finder->through, atlas);
    }
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels) {
            find_hit(finder->through, selector, result, pose, is_tube);
            return EXIT_DONE;
        }
    }
    return EXIT_DONE;
}

int render_cuts_find(conus_cut_plane **planes, size_t *count, const struct cut_settings *settings, const double *at,
                     const conus_atlas *atlas, const conus_frame *frame, conus_selector *selector,
                     const conus_selection *selection, const conus_pose *pose, bool is_tube)
{
    struct cut_finder finder = {.settings = settings, .frame = frame};
    struct cut_word words[CUT_LIMIT + 1];
    size_t word_count = read_words(words, settings->cuts);
    conus_status status = conus_atlas_bounds(finder.low, finder.high, atlas);
    finder.planes = *planes = calloc(CUT_LIMIT, sizeof **planes);
    if (status || !finder.planes) {
        return status ? print_status(status) : print_no_memory();
    }
    int code = find_point(&finder, at, atlas, selector, selection, pose, is_tube);
    for (size_t i = 0; i < word_count && !code; i++) {
        const struct cut_word *word = &words[i];
        if (word->plane == PLANES) {
            continue;
        }
        if (word->mosaic) {
            code = add_mosaic(&finder, word->plane, word->mosaic);
        } else if (word->has_place) {
            code = add_place(&finder, word->plane, word->place);
        } else {
            add_plane(&finder, word->plane, finder.through);
        }
    }
    *count = finder.count;
    return code;
}
