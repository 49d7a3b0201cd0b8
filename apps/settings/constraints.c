/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the constraints of a plan from the command line, and words them. */
#include "settings/settings.h"

#include "base/text.h"
#include "options/messages.h"
#include "options/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In the order of conus_constraint_kind, */
const struct option constraint_options[] = {
    {OPTION_VALUED("reach", struct constraint_settings, reach, "NAME,...[,KEY=VALUE]..."),
     .help = "the axis is in these areas, pathways or bundles, which are one structure; keys: length=MM (in all at "
             "least; default any at all), part=A:B (counting only what is A to B mm before the tip); or in place "
             "of a length tip (the far end is in it), crossed (also of a surface that is not closed), contacts=N (of "
             "--contacts in it at least) or probability=P (mean of the contacts, else along the axis), or of the "
             "cone or cylinder share=P, pierced=P, volume=MM3, fraction=P, streamlines=N (at least); may be repeated",
     .words = "target, hit", .common = true, .role = OPTION_ASKS},
    {OPTION_VALUED("avoid", struct constraint_settings, avoid, "NAME,...[,KEY=VALUE]"),
     .help = "the needle stays farther than margin=MM from these, 0 to 100 (default 0: it does not touch them); may be "
             "repeated; share=P, pierced=P in place of the margin: at most so much of the cone or cylinder",
     .words = "risk, vessels, clearance, safety", .common = true, .role = OPTION_ASKS},
    {OPTION_VALUED("length", struct constraint_settings, length, "MIN,MAX"), .help = "the needle is so long, mm",
     .role = OPTION_PLAIN, OPTION_FROM_TO(0, 1e9), .unit = "mm"},
    {OPTION_VALUED("lean", struct constraint_settings, lean, "X,Y,Z,MAX"),
     .help = "the axis and this direction enclose at most MAX degrees, as an arc or a manipulator allows; may be "
             "repeated",
     .words = "tilt, angle", .role = OPTION_ASKS},
    {OPTION_VALUED("apart", struct constraint_settings, apart, "FILE,MM"),
     .help = "the axis stays farther than MM from those of the poses in FILE, 0 to 100; may be repeated",
     .words = "conflict, electrodes", OPTION_READING(POSES)},
    {OPTION_VALUED("first", struct constraint_settings, first, "NAME,..."),
     .help = "the first object that the axis passes is one of these: a gyrus; may be repeated", .words = "entry",
     .role = OPTION_ASKS},
    {0},
};

/* and behind these. */
const struct option entry_options[] = {
    {OPTION_VALUED("entry-angle", struct constraint_settings, entry_angle, "MAX"),
     .help = "the axis and the inward normal of the surface at its entry enclose at most MAX degrees",
     OPTION_FROM_TO(0, 180), .words = "perpendicular, drill", .needs = "from|needles", .role = OPTION_PLAIN,
     .unit = "degrees"},
    {OPTION_VALUED("arc-window", struct constraint_settings, arc_window, "A0:A1,M0:M1"),
     .help =
         "the needle is at an arc angle of A0 to A1 degrees and a slider angle of M0 to M1 of a rig that turns about "
         "the right-left axis",
     .words = "rig, manipulator, reachable", .role = OPTION_ASKS, .unit = "degrees"},
    {0},
};

const struct option shank_options[] = {
    {OPTION_VALUED("shanks", struct constraint_settings, shanks, "X,Y;X,Y;..."),
     .help = "the device has several parallel needles: where they are beside its axis, along its x and y, mm; "
             "constraints are about any of them (--reach) or all, or what their key shank=any|all|N says",
     .words = "probe, multi-shank, parallel", .role = OPTION_ASKS},
    {0},
};

/* The kinds of keys, in the order of conus_constraint_kind; 0 = none. */
static const enum key_kind constraint_keys[] = {[CONUS_CONSTRAINT_REACH] = KEYS_REACH,
                                                [CONUS_CONSTRAINT_AVOID] = KEYS_AVOID,
                                                [CONUS_CONSTRAINT_APART] = KEYS_APART,
                                                [CONUS_CONSTRAINT_FIRST] = KEYS_FIRST};

/* Keys that are a measure in place of a REACH's length or an AVOID's margin. */
static const struct {
    enum source_key_id id;
    conus_measure measure;
} measures[] = {
    {KEY_LENGTH, CONUS_MEASURE_LENGTH},     {KEY_TIP, CONUS_MEASURE_TIP},
    {KEY_CROSSED, CONUS_MEASURE_CROSSED},   {KEY_CONTACTS, CONUS_MEASURE_CONTACTS},
    {KEY_SHARE, CONUS_MEASURE_SHARE},       {KEY_PROBABILITY, CONUS_MEASURE_PROBABILITY},
    {KEY_PIERCED, CONUS_MEASURE_PIERCED},   {KEY_VOLUME, CONUS_MEASURE_VOLUME},
    {KEY_FRACTION, CONUS_MEASURE_FRACTION}, {KEY_STREAMLINES, CONUS_MEASURE_STREAMLINES},
    {KEY_MARGIN, CONUS_MEASURE_LENGTH},
};

static bool read_shank(conus_constraint *out, const char *option, const char *text)
{
    uint64_t number = 0;
    bool is_word = strcmp(text, "any") == 0 || strcmp(text, "all") == 0;
    if (!is_word && !(count_parse(text, INT32_MAX, &number) && number)) {
        return refuse("--%s: shank=%s is neither any nor all nor a whole number above 0", option, text);
    }
    out->shank = number ? (int32_t)number : strcmp(text, "any") == 0 ? CONUS_SHANK_ANY : CONUS_SHANK_ALL;
    return true;
}

static bool read_keys(conus_constraint *out, char *text)
{
    const char *option = constraint_options[out->kind].name;
    struct source_keys keys;
    size_t count = 0;
    if (!option_cut_keys(&keys, option, text, constraint_keys[out->kind])) {
        return false;
    }
    for (size_t i = 0; i < sizeof measures / sizeof measures[0]; i++) {
        if (keys.given & KEY_BIT(measures[i].id)) {
            out->measure = measures[i].measure;
            out->limit = keys_value(&keys, measures[i].id)->numbers[0];
            count++;
        }
    }
    if (count > 1) {
        return refuse("--%s: %s has %zu measures, an option has one", option, text, count);
    }
    if (keys.given & KEY_BIT(KEY_PART)) {
        memcpy(out->part, keys_value(&keys, KEY_PART)->numbers, sizeof out->part);
    }
    return !(keys.given & KEY_BIT(KEY_SHANK)) || read_shank(out, option, keys_string(&keys, KEY_SHANK));
}

bool constraint_ends_in_name(const char *option, const char *names, const char *key, const char *means)
{
    double number;
    const char *last = strrchr(names, ',');
    last = last ? last + 1 + strspn(last + 1, " ") : "";
    bool begins_with_number = strspn(names, "0123456789") == strcspn(names, ",");
    return begins_with_number || !number_parse(last, &number) ||
           refuse("--%s: \"%s\" ends in a number: %s=%s %s, and an area's label behind a name stands in double quotes",
                  option, names, key, last, means);
}

/* NAMES with keys behind them. */
static bool read_structure(conus_constraint *out, char *text)
{
    const bool is_avoid = out->kind == CONUS_CONSTRAINT_AVOID;
    out->names = text;
    return read_keys(out, text) &&
           (out->kind == CONUS_CONSTRAINT_FIRST || constraint_ends_in_name(constraint_options[out->kind].name, text,
                                                                           is_avoid ? "margin" : "length", "is in mm"));
}

/* One number or two, which the parser has checked. */
static bool read_limits(conus_constraint *out, char *text)
{
    double range[2] = {0};
    numbers_parse(range, 2, text, ',');
    out->limit = range[0];
    out->most = range[1];
    return true;
}

static bool read_lean(conus_constraint *out, char *text)
{
    double numbers[4];
    if (numbers_parse(numbers, 4, text, ',') != 4) {
        print_error_line("--lean: \"%s\" is not four numbers X,Y,Z,MAX without spaces", text);
    } else if (!(numbers[3] >= 0 && numbers[3] <= 180)) {
        print_error_line("--lean: %g degrees, allowed are 0 to 180", numbers[3]);
    } else if (numbers[0] == 0 && numbers[1] == 0 && numbers[2] == 0) {
        print_error_line("--lean: the direction 0,0,0 has no length");
    } else {
        memcpy(out->direction, numbers, sizeof out->direction);
        out->limit = numbers[3];
        return true;
    }
    return false;
}

static bool read_apart(conus_constraint *out, char *text)
{
    if (!read_keys(out, text)) {
        return false;
    }
    char *comma = strrchr(text, ',');
    if (!comma || comma == text || !number_parse(comma + 1, &out->limit)) {
        return refuse("--apart: \"%s\" is not FILE,MM", text);
    }
    *comma = '\0';
    return (out->limit >= 0 && out->limit <= 100) || refuse("--apart: %g mm, allowed are 0 to 100", out->limit);
}

/* A0:A1,M0:M1, two constraints. */
static bool read_window(conus_constraint *out, char *text)
{
    double ends[4];
    char *comma = strchr(text, ',');
    const char *first = strchr(text, ':');
    bool is_fine = comma && first && first < comma && strrchr(text, ':') > comma;
    if (is_fine) {
        *comma = ':';
        is_fine = numbers_parse(ends, 4, text, ':') == 4;
        *comma = ',';
    }
    for (int i = 0; i < 2 && is_fine; i++) {
        out[i] = (conus_constraint){.struct_size = sizeof *out,
                                    .kind = i ? CONUS_CONSTRAINT_SLIDER : CONUS_CONSTRAINT_ARC,
                                    .limit = ends[2 * i],
                                    .most = ends[2 * i + 1]};
    }
    return is_fine || refuse("--arc-window: \"%s\" is not A0:A1,M0:M1, of the arc and of the slider angle", text);
}

/* In the order of the options, which is that of conus_constraint_kind. */
static bool (*const readers[])(conus_constraint *out, char *text) = {
    read_structure, read_structure, read_limits, read_lean, read_apart, read_structure, read_limits, read_window,
};
enum { READERS = sizeof readers / sizeof readers[0] };

/* The number of its kind, that of the first one of a window; READERS where it is no constraint. */
static size_t kind_of(const struct option *option)
{
    size_t kind = 0;
    while (constraint_options[kind].name && &constraint_options[kind] != option) {
        kind++;
    }
    for (size_t i = 0; !constraint_options[kind].name && entry_options[i].name; i++) {
        if (&entry_options[i] == option) {
            return kind + i;
        }
    }
    return constraint_options[kind].name ? kind : READERS;
}

bool constraints_are_given(const struct arguments *arguments)
{
    bool any = false;
    for (size_t i = 0; arguments && i < arguments->use_count; i++) {
        any = any || kind_of(arguments->uses[i].option) < READERS;
    }
    return any;
}

/* X,Y;X,Y... */
static int read_shanks(struct constraints *out, const char *text)
{
    size_t count = 1;
    for (const char *at = text; *at; at++) {
        count += *at == ';';
    }
    free(out->shanks);
    out->shank_count = count;
    out->shanks = calloc(count, 2 * sizeof *out->shanks);
    char *copy = strdup(text);
    int code = out->shanks && copy ? EXIT_DONE : print_no_memory();
    char *rest = copy;
    for (size_t i = 0; i < count && !code; i++) {
        const char *word = text_next(&rest, ";");
        code = numbers_parse(out->shanks + 2 * i, 2, word, ',') == 2
                   ? EXIT_DONE
                   : print_usage_error("--shanks: \"%s\" is not two numbers X,Y", word);
    }
    free(copy);
    return code;
}

int constraints_parse(struct constraints *out, const struct arguments *arguments)
{
    const size_t most = 2 * arguments->use_count + 1;
    *out = (struct constraints){.items = calloc(most, sizeof *out->items),
                                .texts = calloc(most, sizeof *out->texts),
                                .needles = calloc(most, sizeof *out->needles)};
    if (!out->items || !out->texts || !out->needles) {
        return print_no_memory();
    }
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        size_t kind = kind_of(use->option);
        int code = use->option == shank_options ? read_shanks(out, use->value) : EXIT_DONE;
        if (code) {
            return code;
        }
        if (kind < READERS) {
            char *text = out->texts[out->count] = strdup(use->value);
            conus_constraint *item = &out->items[out->count++];
            *item = (conus_constraint){.struct_size = sizeof *item, .kind = (conus_constraint_kind)kind};
            if (!text) {
                return print_no_memory();
            }
            if (!readers[kind](item, text)) {
                return EXIT_USAGE;
            }
            out->count += kind == CONUS_CONSTRAINT_ARC;
        }
    }
    return EXIT_DONE;
}

int constraints_take_contacts(struct constraints *constraints, const char *text, bool are_used)
{
    conus_contacts contacts;
    int code = settings_contacts(&contacts, text);
    for (size_t i = 0; i < constraints->count && !code; i++) {
        conus_constraint *item = &constraints->items[i];
        if (item->measure == CONUS_MEASURE_CONTACTS && !text) {
            code = print_usage_error("--reach: contacts have no effect without --contacts COUNT,COLUMNS,PITCH,TIP");
        } else if (item->measure == CONUS_MEASURE_CONTACTS || item->measure == CONUS_MEASURE_PROBABILITY) {
            item->contacts = contacts;
            are_used = true;
        }
    }
    return code || are_used || !text
               ? code
               : print_usage_error(
                     "--contacts has no effect without --reach NAME,contacts=N or NAME,probability=P, or --cover");
}

conus_measure constraints_last_measure(const struct constraints *constraints)
{
    conus_measure last = CONUS_MEASURE_LENGTH;
    for (size_t i = 0; i < constraints->count; i++) {
        last = constraints->items[i].measure > last ? constraints->items[i].measure : last;
    }
    return last;
}

void constraints_finish(struct constraints *constraints)
{
    for (size_t i = 0; i < constraints->count; i++) {
        free(constraints->texts[i]);
        free(constraints->needles[i]);
    }
    free(constraints->items);
    free(constraints->shanks);
    free((void *)constraints->texts);
    free((void *)constraints->needles);
    *constraints = (struct constraints){0};
}

/* The ends of the axes of all poses in the file. */
static int load_needles(double **out, conus_constraint *constraint, const char *path, const struct pose_places *places,
                        double far)
{
    const struct pose_file_settings *settings = places->settings ? places->settings : &(struct pose_file_settings){0};
    const conus_pose_options options = pose_settings_options(settings, NULL, NULL, places->frame, NULL, 0);
    conus_pose_list *poses = NULL;
    conus_status status = conus_pose_list_load(&poses, path, &options);
    if (status) {
        return print_status(status);
    }
    int code = pose_settings_match_list(poses, path, places->atlases, places->settings, places->common);
    size_t count = conus_pose_list_count(poses);
    double(*ends)[6] = calloc(count + 1, sizeof *ends);
    code = code || ends ? code : print_no_memory();
    for (size_t i = 0; ends && i < count && !code; i++) {
        const conus_pose_row *row = conus_pose_list_row(poses, i);
        const char *why = pose_settings_row_error(row);
        double range[2] = {isfinite(row->range[0]) ? row->range[0] : 0, isfinite(row->range[1]) ? row->range[1] : far};
        if (!why && !(range[1] > 0)) {
            why = "no far end: neither a column far nor --depth";
        }
        if (why) {
            code = print_data_error("--apart: %s:%zu: %s", path, row->line, why);
        }
        const double *m = row->pose.world_from_device;
        for (int k = 0; k < 6 && !code; k++) {
            ends[i][k] = m[12 + k % 3] - range[k / 3] * m[8 + k % 3];
        }
    }
    if (!code && !count) {
        code = print_data_error("--apart: %s: no poses in it", path);
    }
    conus_pose_list_destroy(poses);
    *out = (double *)ends;
    constraint->needles = *out;
    constraint->needle_count = count;
    return code;
}

int constraints_place(struct constraints *constraints, const struct pose_places *places, double far)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < constraints->count && !code; i++) {
        conus_constraint *constraint = &constraints->items[i];
        if (constraint->kind == CONUS_CONSTRAINT_LEAN) {
            conus_frame_direction_to_world(constraint->direction, places->frame, constraint->direction);
        } else if (constraint->kind == CONUS_CONSTRAINT_APART) {
            code = load_needles(&constraints->needles[i], constraint, constraints->texts[i], places, far);
        }
    }
    return code;
}
