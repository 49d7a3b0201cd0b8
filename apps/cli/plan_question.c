/* SPDX-License-Identifier: BSD-3-Clause */
/* The question of one needle: its options, how they are read, and what is said of its candidates. */
#include "base/system/system.h"
#include "base/text.h"
#include "cli/cmd_plan.h"
#include "options/messages.h"

#include <stdlib.h>
#include <string.h>

const struct option plan_pose_options[] = {
    {OPTION_VALUED("poses", struct request_settings, aim.pose, "FILE"),
     .help = "the candidates: poses of needles (docs/formats.md); - is standard input",
     .words = "input, trajectory, electrode, candidates", .common = true, .role = OPTION_READS_POSES,
     .holds = HOLDS_POSES},
    {0},
};

const struct option plan_needle_options[] = {
    {OPTION_VALUED("range", struct request_settings, engine.range.ends, "NEAR,FAR"),
     .help = "or both ends of the needle", OPTION_FROM_TO(0, 1e9), .unit = "mm"},
    {OPTION_MM("radius", struct request_settings, engine.radius), .help = "radius of the needle, mm",
     .otherwise = "its axis alone", OPTION_BETWEEN(0, 1e9), .words = "needle, diameter"},
    {0},
};

const struct option plan_contact_options[] = {
    {OPTION_VALUED("contacts", struct plan_settings, contacts, "COUNT,COLUMNS,PITCH,TIP"),
     .help =
         "contacts on the axis, which contacts=N and probability=P of --reach are about: COUNT of them, COLUMNS in "
         "a row, PITCH mm from row to row, the first TIP mm from the far end; or an electrode of DIXI Medical or PMT, "
         "D08-10AM say (docs/commands.md)",
     .words = "electrode, probe, DIXI, Microdeep, PMT", .role = OPTION_ASKS},
    {0},
};

const struct option part_options[] = {
    {OPTION_VALUED("part", struct needles_settings, parts, "RADIUS,H0:H1[,X,Y][,tip]"),
     .help =
         "a capsule that rides on the needle, as a bolt or a holder does: around the line from H0 to H1 mm "
         "outwards from the device's position, or from the tip, beside the axis by X and Y along the device's x and "
         "y; may be repeated",
     .words = "bolt, holder, headstage", .needs = "needles", .role = OPTION_ASKS},
    {0},
};

const struct option *const plan_question_options[] = {plan_pose_options,    candidate_options,  plan_needle_options,
                                                      part_options,         constraint_options, entry_options,
                                                      plan_contact_options, shank_options,      NULL};

/* "1,043,216" */
static void put_count(FILE *out, uint64_t count)
{
    char digits[24];
    int length = snprintf(digits, sizeof digits, "%llu", (unsigned long long)count);
    for (int i = 0; i < length; i++) {
        fprintf(out, "%s%c", i && (length - i) % 3 == 0 ? "," : "", digits[i]);
    }
}

/* How many candidates each constraint leaves, up to the first that leaves none. */
static void put_funnel(FILE *out, const conus_plan *plan, const char *const *asked)
{
    uint64_t left = conus_plan_left(plan, 0);
    put_count(out, left);
    fputs(left == 1 ? " candidate: " : " candidates: ", out);
    for (size_t i = 0; i < conus_plan_constraint_count(plan) && left; i++) {
        left = conus_plan_left(plan, i + 1);
        fputs(i ? "; " : "", out);
        if (left) {
            put_count(out, left);
        } else {
            fputs("none", out);
        }
        fprintf(out, "%s%s %s", i ? " of these" : "", left > 1 ? " have" : " has", asked[i]);
    }
}

/* The poses that break one constraint alone, by the least, each on a line. */
static void put_misses(FILE *out, const conus_plan *plan, const char *const *asked, double radius)
{
    size_t count = 0;
    for (size_t i = 0; i < conus_plan_constraint_count(plan); i++) {
        const conus_planned *miss = conus_plan_miss(plan, i);
        const conus_constraint *constraint = conus_plan_constraint(plan, i);
        if (miss) {
            bool is_clearance = constraint->kind == CONUS_CONSTRAINT_AVOID && !constraint->measure;
            double value = miss->verdicts[i].value - (is_clearance ? radius : 0);
            fprintf(out, "\n%s breaks only one of them, %s: it has %.4g", miss->id, asked[i], value);
            count++;
        }
    }
    fputs(count ? "" : "\nevery candidate breaks more than one of them", out);
}

/* Says the lines of a text, each as a message. */
static void say_lines(struct system_text *text)
{
    for (char *rest = system_text_close(text), *line; (line = text_next(&rest, "\n"));) {
        print_error_line("%s", line);
    }
    free(text->data);
}

int plan_say_funnel(const conus_plan *plan, double radius)
{
    struct system_text text;
    conus_table *constraints = NULL;
    conus_status status = conus_plan_list(&constraints, plan, "constraints");
    FILE *out = status ? NULL : system_text_open(&text);
    if (out) {
        const char *const *asked = conus_table_texts(constraints, "asked");
        put_funnel(out, plan, asked);
        if (!conus_plan_left(plan, conus_plan_constraint_count(plan))) {
            put_misses(out, plan, asked, radius);
        }
        say_lines(&text);
    }
    conus_table_destroy(constraints);
    return print_status(status);
}

int plan_check_candidates(bool *failed, const conus_plan *plan, const struct plan_settings *settings,
                          const struct candidates *candidates)
{
    const conus_plan_faults faults = conus_plan_rejected(plan);
    const char *from = candidates->from.path;
    const char *path = from ? from : pose_settings_file_name(settings->request.aim.pose);
    uint64_t tried = conus_plan_left(plan, 0);
    uint64_t rows = tried + faults.count;
    if (!tried && !faults.count) {
        return print_usage_error("%s: no candidate: no poses in it", path);
    }
    if (!tried) {
        return print_usage_error("%s: no candidate: %s %zu: %s", path, from ? "number" : "line", faults.line,
                                 faults.why);
    }
    if (faults.count && !(from && settings->request.common.quiet)) {
        print_error_line("%s%s: %llu of %llu %s are no candidates, the first %s %zu: %s", from ? "note: " : "", path,
                         (unsigned long long)faults.count, (unsigned long long)rows, from ? "poses" : "rows",
                         from ? "is number" : "in line", faults.line, faults.why);
    }
    *failed = *failed || (faults.count && !from);
    return EXIT_DONE;
}

conus_selector_options plan_engine(const struct plan_settings *settings, const struct constraints *constraints)
{
    conus_selector_options engine = settings_engine(&settings->request.engine, NULL, &settings->request.common);
    engine.engine = CONUS_ENGINE_RAYS;
    engine.layers =
        constraints_last_measure(constraints) > CONUS_MEASURE_SHARE ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE;
    return engine;
}

double plan_far(const struct plan_settings *settings, const struct candidates *candidates)
{
    return candidates->far > 0 ? candidates->far : settings->request.engine.range.ends[1];
}

int plan_parse(struct constraints *constraints, struct candidates *candidates, const struct plan_settings *settings,
               const struct arguments *arguments)
{
    int code = constraints_parse(constraints, arguments);
    code = code ? code : candidates_parse(candidates, &settings->candidates, arguments);
    if (!code && !constraints->count) {
        code = print_usage_error("no constraint given: --reach NAME,... or --avoid NAME,...");
    }
    code = code ? code : constraints_take_contacts(constraints, settings->contacts, settings->needles.covers.count);
    const struct option *of_cone = option_with(arguments, OPTION_OF_CONE | OPTION_OF_RAYS);
    if (!code && of_cone && constraints_last_measure(constraints) < CONUS_MEASURE_SHARE) {
        code = print_usage_error("--%s has no effect without a measure of the cone, such as share=P", of_cone->name);
    }
    return code || settings_check_shape(&settings->request.aim, &settings->request.engine, arguments) ? code
                                                                                                      : EXIT_USAGE;
}
