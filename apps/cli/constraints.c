/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the constraints of a plan from the command line, and words them. */
#include "cli/constraints.h"

#include "options/messages.h"
#include "options/output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(member) offsetof(struct constraint_settings, member)

const struct option constraint_options[] = {
    {.name = "reach",
     .type = OPTION_LIST,
     .offset = FIELD(reach),
     .value = "NAME,...[,KEY=VALUE]...",
     .help = "the axis is in these areas, pathways or bundles, which are one structure; keys: length=MM (in all at "
             "least; default any at all), part=A:B (counting only what is A to B mm before the tip); or in place "
             "of a length tip (the far end is in it) or crossed (also of a surface that is not closed); may be "
             "repeated",
     .words = "target, hit",
     .common = true,
     .role = OPTION_ASKS},
    {.name = "avoid",
     .type = OPTION_LIST,
     .offset = FIELD(avoid),
     .value = "NAME,...[,margin=MM]",
     .help = "the needle stays farther than MM from these, 0 to 100 (default 0: it does not touch them); may be "
             "repeated",
     .words = "risk, vessels, clearance, safety",
     .common = true,
     .role = OPTION_ASKS},
    {.name = "length",
     .type = OPTION_RANGE,
     .offset = FIELD(length),
     .value = "MIN,MAX",
     .help = "the needle is so long, mm",
     .role = OPTION_PLAIN,
     .low = 0,
     .high = 1e9},
    {.name = "lean",
     .type = OPTION_LIST,
     .offset = FIELD(lean),
     .value = "X,Y,Z,MAX",
     .help = "the axis and this direction enclose at most MAX degrees, as an arc or a manipulator allows; may be "
             "repeated",
     .words = "tilt, angle",
     .role = OPTION_ASKS},
    {.name = "apart",
     .type = OPTION_LIST,
     .offset = FIELD(apart),
     .value = "FILE,MM",
     .help = "the axis stays farther than MM from those of the poses in FILE, 0 to 100; may be repeated",
     .words = "conflict, electrodes",
     .role = OPTION_READS},
    {.name = "first",
     .type = OPTION_LIST,
     .offset = FIELD(first),
     .value = "NAME,...",
     .help = "the first object that the axis passes is one of these: a gyrus; may be repeated",
     .words = "entry",
     .role = OPTION_ASKS},
    {0},
};

/* A key behind the names of an option, in place of the length or margin. */
static const struct key {
    const char *option, *name;
    conus_measure measure;
    double high; /* of its number, from 0; 0 = it has none */
} keys[] = {
    {"reach", "length", CONUS_MEASURE_LENGTH, 1e9},
    {"reach", "tip", CONUS_MEASURE_TIP, 0},
    {"reach", "crossed", CONUS_MEASURE_CROSSED, 0},
    {"avoid", "margin", CONUS_MEASURE_LENGTH, 100},
};

enum { KEYS = sizeof keys / sizeof keys[0] };

/* Keys of an option, for closest_name(); "part" comes last. */
static const char *key_name(const void *option, size_t index)
{
    size_t seen = 0;
    for (size_t i = 0; i < KEYS; i++) {
        if (strcmp(keys[i].option, option) == 0 && seen++ == index) {
            return keys[i].name;
        }
    }
    return seen == index && strcmp(option, "reach") == 0 ? "part" : NULL;
}

static bool refuse_key(const char *option, char *key)
{
    key[strcspn(key, "=")] = '\0';
    const char *near = closest_name(key, key_name, option);
    print_error_line("--%s: there is no key \"%s\"%s%s%s", option, key, near ? "; did you mean " : "", near ? near : "",
                     near ? "?" : "");
    return false;
}

/* "A:B", the second the larger. */
static bool read_part(conus_constraint *out, const char *value)
{
    char first[64];
    const char *colon = strchr(value, ':');
    size_t length = colon ? (size_t)(colon - value) : sizeof first;
    double part[2] = {NAN, NAN};
    if (length < sizeof first) {
        memcpy(first, value, length);
        first[length] = '\0';
    }
    if (length >= sizeof first || !number_parse(first, &part[0]) || !number_parse(colon + 1, &part[1]) ||
        !(part[0] >= 0 && part[0] < part[1])) {
        print_error_line("--reach: part=%s is not A:B with numbers from 0, the lower one first", value);
        return false;
    }
    memcpy(out->part, part, sizeof part);
    return true;
}

/* Reads "key=value" or "key", the text after a comma. */
static bool read_key(conus_constraint *out, bool *has_measure, const char *option, char *text)
{
    const char *equals = strchr(text, '=');
    size_t length = strcspn(text, "=");
    if (strcmp(option, "reach") == 0 && length == 4 && strncmp(text, "part", 4) == 0 && equals && out->part[1] == 0) {
        return read_part(out, equals + 1);
    }
    const struct key *key = keys;
    while (key < keys + KEYS && !(strcmp(key->option, option) == 0 && strlen(key->name) == length &&
                                  strncmp(key->name, text, length) == 0)) {
        key++;
    }
    if (key == keys + KEYS) {
        return refuse_key(option, text);
    }
    bool has_number = key->high > 0;
    if (*has_measure || has_number != (equals != NULL)) {
        print_error_line(*has_measure ? "--%s: \"%s\" is one measure too many, an option has one"
                         : has_number ? "--%s: \"%s\" has no number behind it"
                                      : "--%s: \"%s\" has a number behind it",
                         option, text);
        return false;
    }
    *has_measure = true;
    out->measure = key->measure;
    if (has_number && !(number_parse(equals + 1, &out->limit) && out->limit >= 0 && out->limit <= key->high)) {
        print_error_line("--%s: %s is not a number from 0 to %g", option, text, key->high);
        return false;
    }
    return true;
}

/* Whether the last piece of `text`, from its comma on, is a key and no name. */
static bool is_key(const char *comma, const char *option)
{
    return strchr(comma, '=') ||
           (strcmp(option, "reach") == 0 && (strcmp(comma, ",tip") == 0 || strcmp(comma, ",crossed") == 0));
}

/* NAMES with keys behind them, which are cut off from the end. */
static bool read_structure(conus_constraint *out, char *text, const char *option)
{
    static const char *const names[] = {",length=", ",part=", ",margin=", NULL};
    bool has_measure = false;
    for (char *comma; (comma = strrchr(text, ',')) && is_key(comma, option);) {
        *comma = '\0';
        if (!read_key(out, &has_measure, option, comma + 1)) {
            return false;
        }
    }
    char shown[16];
    snprintf(shown, sizeof shown, "--%s", option);
    if (!*text || strchr(text, '=') == text) {
        print_error_line("--%s: there is no name of a structure", option);
        return false;
    }
    out->names = text;
    return !key_left_in_file(shown, text, names);
}

/* Cuts the number behind the last comma off. */
static bool cut_number(double *out, char *text)
{
    char *comma = strrchr(text, ',');
    if (!comma || !number_parse(comma + 1, out)) {
        return false;
    }
    *comma = '\0';
    return true;
}

static bool read_lean(conus_constraint *out, char *text)
{
    double degrees = 0;
    char given[128];
    snprintf(given, sizeof given, "%s", text);
    bool is_vector = cut_number(&degrees, text) && cut_number(&out->direction[2], text) &&
                     cut_number(&out->direction[1], text) && number_parse(text, &out->direction[0]);
    out->limit = radians(degrees);
    if (!is_vector) {
        print_error_line("--lean: \"%s\" is not four numbers X,Y,Z,MAX without spaces", given);
    } else if (!(degrees >= 0 && degrees <= 180)) {
        print_error_line("--lean: %g degrees, allowed are 0 to 180", degrees);
    } else if (out->direction[0] == 0 && out->direction[1] == 0 && out->direction[2] == 0) {
        print_error_line("--lean: the direction 0,0,0 has no length");
        is_vector = false;
    }
    return is_vector && degrees >= 0 && degrees <= 180;
}

static bool read_apart(conus_constraint *out, char *text)
{
    if (!cut_number(&out->limit, text) || !*text) {
        print_error_line("--apart: \"%s\" is not FILE,MM", text);
        return false;
    }
    return (out->limit >= 0 && out->limit <= 100) ||
           (print_error_line("--apart: %g mm, allowed are 0 to 100", out->limit), false);
}

static bool read_constraint(conus_constraint *out, const char *option, char *text)
{
    *out = (conus_constraint){.struct_size = sizeof *out};
    if (strcmp(option, "reach") == 0 || strcmp(option, "avoid") == 0 || strcmp(option, "first") == 0) {
        out->kind = option[0] == 'r'   ? CONUS_CONSTRAINT_REACH
                    : option[0] == 'a' ? CONUS_CONSTRAINT_AVOID
                                       : CONUS_CONSTRAINT_FIRST;
        return read_structure(out, text, option);
    }
    if (strcmp(option, "length") == 0) { /* which the parser has checked */
        out->kind = CONUS_CONSTRAINT_LENGTH;
        return cut_number(&out->most, text) && number_parse(text, &out->limit);
    }
    out->kind = strcmp(option, "lean") == 0 ? CONUS_CONSTRAINT_LEAN : CONUS_CONSTRAINT_APART;
    return out->kind == CONUS_CONSTRAINT_LEAN ? read_lean(out, text) : read_apart(out, text);
}

static bool is_constraint(const struct option *option)
{
    for (const struct option *at = constraint_options; at->name; at++) {
        if (at == option) {
            return true;
        }
    }
    return false;
}

int constraints_parse(struct constraints *out, const struct arguments *arguments)
{
    *out = (struct constraints){.items = calloc(arguments->use_count + 1, sizeof *out->items),
                                .texts = calloc(arguments->use_count + 1, sizeof *out->texts),
                                .needles = calloc(arguments->use_count + 1, sizeof *out->needles)};
    if (!out->items || !out->texts || !out->needles) {
        return print_no_memory();
    }
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        if (is_constraint(use->option)) {
            char *text = out->texts[out->count] = strdup(use->value);
            if (!text) {
                return print_no_memory();
            }
            if (!read_constraint(&out->items[out->count++], use->option->name, text)) {
                return EXIT_USAGE;
            }
        }
    }
    return out->count ? EXIT_DONE : print_usage_error("no constraint given: --reach NAME,... or --avoid NAME,...");
}

void constraints_finish(struct constraints *constraints)
{
    for (size_t i = 0; i < constraints->count; i++) {
        free(constraints->texts[i]);
        free(constraints->needles[i]);
    }
    free(constraints->items);
    free((void *)constraints->texts);
    free((void *)constraints->needles);
    *constraints = (struct constraints){0};
}

/* The ends of the axes of all poses in the file. */
static int load_needles(double **out, conus_constraint *constraint, const char *path, const conus_pose_options *options,
                        double far)
{
    conus_pose_list *poses = NULL;
    conus_status status = conus_pose_list_load(&poses, path, options);
    if (status) {
        return print_status(status);
    }
    size_t count = conus_pose_list_count(poses);
    double(*ends)[6] = calloc(count + 1, sizeof *ends);
    int code = ends ? EXIT_DONE : print_no_memory();
    for (size_t i = 0; ends && i < count && !code; i++) {
        const conus_pose_row *row = conus_pose_list_row(poses, i);
        const char *why = settings_row_error(row);
        double range[2] = {isfinite(row->range[0]) ? row->range[0] : 0, isfinite(row->range[1]) ? row->range[1] : far};
        if (!why && !(range[1] > 0)) {
            why = "no far end: neither a column far nor --depth";
        }
        if (why) {
            print_error_line("--apart: %s:%zu: %s", path, row->line, why);
            code = EXIT_DATA;
        }
        const double *m = row->pose.world_from_device;
        for (int k = 0; k < 6 && !code; k++) {
            ends[i][k] = m[12 + k % 3] - range[k / 3] * m[8 + k % 3];
        }
    }
    if (!code && !count) {
        print_error_line("--apart: %s: no poses in it", path);
        code = EXIT_DATA;
    }
    conus_pose_list_destroy(poses);
    *out = (double *)ends;
    constraint->needles = *out;
    constraint->needle_count = count;
    return code;
}

int constraints_place(struct constraints *constraints, const conus_frame *frame,
                      const struct pose_file_settings *settings, double far)
{
    const conus_pose_options options = settings_pose_options(settings, frame, 0);
    int code = EXIT_DONE;
    for (size_t i = 0; i < constraints->count && !code; i++) {
        conus_constraint *constraint = &constraints->items[i];
        if (constraint->kind == CONUS_CONSTRAINT_LEAN) {
            conus_frame_direction_to_world(constraint->direction, frame, constraint->direction);
        } else if (constraint->kind == CONUS_CONSTRAINT_APART) {
            code = load_needles(&constraints->needles[i], constraint, constraints->texts[i], &options, far);
        }
    }
    return code;
}
