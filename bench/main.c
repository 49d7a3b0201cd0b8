/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-bench: the table of scenarios, the command line and the exit code. */
#include "base/text.h"
#include "bench/all.h"
#include "bench/support/bench.h"
#include "conus/own.h"

#include <ftw.h>
#include <getopt.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEFAULT_ATLAS "/usr/share/mricron/templates/aal.nii.gz"
#define DEFAULT_CONTEXT "/usr/share/mricron/templates/ch2bet.nii.gz"

enum { EXIT_CHECK = 1, EXIT_USAGE = 2, EXIT_DATA = 3 };
enum { DEFAULT_POSES = 64, DEFAULT_SLICES = 362, DEFAULT_REPEATS = 9 };
enum { CHECK_POSES = 4, CHECK_SLICES = 45, CHECK_REPEATS = 1, CHECK_EDGE = 32 /* of the phantom */ };

/* The last three numbers are used when all scenarios are run: poses, rounds, and seconds for one measurement. */
static const struct bench_scenario scenarios[] = {
    {"volume", "256 rays through a labelled volume: plain traversal against the rays engine", bench_volume, 64, 31, 10},
    {"batch", "poses as text in, rows as text out, on one thread and two, against plain traversal", bench_batch, 4000,
     9, 20},
    {"batch_mesh", "the same batch on surfaces that conus mesh makes of the areas", bench_batch_mesh, 1000, 5, 15},
    {"batch_layers", "the same batch with all layers: intervals ray by ray and in packets, and first hits",
     bench_batch_layers, 1000, 5, 15},
    {"clearance", "how far needles stay from areas: cell by cell, and by the search", bench_clearance, 16, 5, 15},
    {"plan", "which needles reach an area and avoid four: with pruning and without", bench_plan, 10000, 3, 20},
    {"together", "four needles planned together, against lists of all that hold", bench_together, 20000, 3, 40},
    {"python", "select_many() of the Python package against conus batch, the same poses", bench_python, 100000, 5, 40},
    {"torus", "256 rays into 1,000 to 200,000 tori, one at a time or in packets; the paper's pass", bench_torus, 64, 9,
     12},
    {"torus_frame", "frames of 1,000 to 200,000 tori, without and with a selection in each, as the paper has it",
     bench_torus_frame, 1, 5, 15},
    {"layers", "256 rays into 20,000 tori: first hits and all hits", bench_layers, 16, 5, 20},
    {"streamlines", "256 rays into 1,000 to 1,000,000 streamlines, by each kernel of the search", bench_streamlines, 4,
     5, 15},
#if CONUS_PEERS
    {"peers_mesh", "256 rays into 20,000 tori: VTK's selector, locators and picker against the rays engine",
     bench_peers_mesh, 4, 5, 40},
    {"peers_pick", "one pick in 2.4 million triangles: VTK's pickers, locators and selector against a ray and a cone",
     bench_peers_pick, 16, 3, 30},
    {"peers_colour", "a picture of a volume: VTK's volume mappers against the colour pass", bench_peers_colour, 1, 3,
     20},
#endif
    {"bonsai", "frames of 1 to 45 volumes of 256^3 bytes, without and with a selection in each, as the paper has it",
     bench_bonsai, 1, 3, 20},
    {"accuracy", "how wrong slices are: labels and thin tubes, over cones' angles", bench_accuracy, 64, 5, 2},
    {"startup", "loading an atlas, from files and from a pack, making selectors, and the whole of conus query",
     bench_startup, 1, 15, 15},
    {"open", "the atlas enlarged three times along each axis: conus query on it, and its memory per voxel", bench_open,
     1, 3, 15},
    {"growth", "how the cost grows with objects, angle and voxels", bench_growth, 64, 3, 10},
};

enum { SCENARIO_COUNT = sizeof scenarios / sizeof scenarios[0] };

static void print_help(void)
{
    puts("usage: conus-bench SCENARIO|all [options]\n\nscenarios:");
    for (size_t i = 0; i < SCENARIO_COUNT; i++) {
        printf("  %-12s %s\n", scenarios[i].name, scenarios[i].description);
    }
    puts("  all          one after the other, each in a process of its own, with numbers that fit into half an hour\n"
         "\noptions:\n"
         "  --atlas FILE   labelled volume, or a manifest (default " DEFAULT_ATLAS ")\n"
         "  --context FILE volume around the areas in pictures (default " DEFAULT_CONTEXT ")\n"
         "  --bonsai FILE  the paper's volume, 256^3 bytes, raw or in a file of any format (else a stand-in is made)\n"
         "  --slices N     planes of a picture (default 362)\n"
         "  --angle A      full opening angle in degrees (default 5)\n"
         "  --poses N      cones per round (default 64; all: its own)\n"
         "  --repeats N    rounds in which every variant runs once (default 9; all: its own)\n"
         "  --seconds S    begin no further round once a measurement has taken S seconds (all: its own)\n"
         "  --check        small sizes: exit code 1 unless all answers are equal; the times have no meaning\n"
         "  --json FILE    write everything measured");
}

struct arguments {
    struct bench_options options;
    const struct bench_scenario *scenario;
    const char *json;
    bool all, help;
};

/* Where an option's value goes: a text, a count from 1 to 1,000,000, a number above 0 and below `limit`, or a flag. */
static const struct taken {
    const char *name;
    enum { TEXT, COUNT, NUMBER, FLAG } kind;
    size_t offset; /* in struct arguments */
    double limit;
} takes[] = {{"atlas", TEXT, offsetof(struct arguments, options.atlas), 0},
             {"context", TEXT, offsetof(struct arguments, options.context), 0},
             {"bonsai", TEXT, offsetof(struct arguments, options.bonsai), 0},
             {"json", TEXT, offsetof(struct arguments, json), 0},
             {"slices", COUNT, offsetof(struct arguments, options.slices), 0},
             {"poses", COUNT, offsetof(struct arguments, options.poses), 0},
             {"repeats", COUNT, offsetof(struct arguments, options.repeats), 0},
             {"angle", NUMBER, offsetof(struct arguments, options.angle), 180},
             {"seconds", NUMBER, offsetof(struct arguments, options.seconds), 1e6},
             {"check", FLAG, offsetof(struct arguments, options.check), 0},
             {"help", FLAG, offsetof(struct arguments, help), 0}};
enum { TAKES = sizeof takes / sizeof takes[0] };

static conus_status take_value(struct arguments *out, const struct taken *option, const char *value)
{
    void *place = (char *)out + option->offset;
    uint64_t count;
    double number;
    switch (option->kind) {
    case TEXT:
        *(const char **)place = value;
        return CONUS_OK;
    case FLAG:
        *(bool *)place = true;
        return CONUS_OK;
    case COUNT:
        if (!text_to_uint(text_from(value), 1000000, &count) || count == 0) {
            return fail(CONUS_ERROR_ARGUMENT, "--%s: '%s', allowed is 1 to 1000000", option->name, value);
        }
        *(size_t *)place = (size_t)count;
        return CONUS_OK;
    default:
        if (!text_to_double(text_from(value), &number) || !(number > 0 && number < option->limit)) {
            return fail(CONUS_ERROR_ARGUMENT, "--%s: '%s', allowed is more than 0 and less than %g", option->name,
                        value, option->limit);
        }
        *(double *)place = number;
        return CONUS_OK;
    }
}

static conus_status parse_arguments(struct arguments *out, int argc, char **argv)
{
    struct option table[TAKES + 1] = {{0}};
    for (int i = 0; i < TAKES; i++) {
        table[i] = (struct option){takes[i].name, takes[i].kind == FLAG ? no_argument : required_argument, NULL, i + 1};
    }
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "h", table, NULL)) != -1;) {
        if (option == '?') {
            return fail(CONUS_ERROR_ARGUMENT, "unknown option, or one without its value; see conus-bench --help");
        }
        conus_status status = take_value(out, &takes[option == 'h' ? TAKES - 1 : option - 1], optarg);
        if (status) {
            return status;
        }
    }
    if (out->help) {
        return CONUS_OK;
    }
    if (optind + 1 != argc) {
        return fail(CONUS_ERROR_ARGUMENT, "name one scenario, or all; see conus-bench --help");
    }
    out->all = strcmp(argv[optind], "all") == 0;
    for (size_t i = 0; i < SCENARIO_COUNT; i++) {
        out->scenario = strcmp(argv[optind], scenarios[i].name) ? out->scenario : &scenarios[i];
    }
    return out->all || out->scenario
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "unknown scenario '%s'; see conus-bench --help", argv[optind]);
}

static int remove_entry(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)about;
    (void)kind;
    (void)where;
    return remove(path);
}

/* Fills in missing options. In a check the atlas and its context are a small phantom in the bench's folder. */
static conus_status fill_in(struct bench *bench, char *phantom, size_t size)
{
    struct bench_options *options = &bench->options;
    bool check = options->check;
    snprintf(phantom, size, "%s/u-shape.nii.gz", bench->folder);
    options->poses = options->poses ? options->poses : check ? CHECK_POSES : DEFAULT_POSES;
    options->slices = options->slices ? options->slices : check ? CHECK_SLICES : DEFAULT_SLICES;
    options->repeats = options->repeats ? options->repeats : check ? CHECK_REPEATS : DEFAULT_REPEATS;
    conus_status status = CONUS_OK;
    if (check) {
        status = conus_phantom_write("u-shape", bench->folder, &(conus_phantom_options){.size = CHECK_EDGE});
    }
    options->atlas = options->atlas ? options->atlas : check ? phantom : DEFAULT_ATLAS;
    options->context = options->context ? options->context : check ? phantom : DEFAULT_CONTEXT;
    return status;
}

static int run_benchmark(const struct arguments *arguments)
{
    char folder[] = "/tmp/conus-bench.XXXXXX";
    char phantom[64];
    double load = report_load();
    if (!mkdtemp(folder)) {
        fprintf(stderr, "conus-bench: no folder in /tmp\n");
        return EXIT_DATA;
    }
    struct bench bench = {.options = arguments->options,
                          .folder = folder,
                          .runs = json_array(),
                          .ratios = json_object(),
                          .left_out = json_object()};
    json_t *settings = json_object();
    conus_status status = bench.runs && bench.ratios && bench.left_out && settings
                              ? fill_in(&bench, phantom, sizeof phantom)
                              : fail(CONUS_ERROR_MEMORY, "out of memory");
    double start = bench_wall();
    if (!status && arguments->all) {
        status = bench_all(&bench, settings, scenarios, SCENARIO_COUNT);
    } else if (!status) {
        status = arguments->scenario->run(&bench);
        json_t *own = status ? NULL : report_settings(&bench, bench_wall() - start, load);
        int error = !status && json_object_set_new(settings, arguments->scenario->name, own);
        status = error ? fail(CONUS_ERROR_MEMORY, "out of memory") : status;
    }
    json_t *root = status ? NULL : report_create(&bench, settings, load);
    status = status || root ? status : fail(CONUS_ERROR_MEMORY, "out of memory");
    if (!status && arguments->all && !bench.options.check) {
        report_print_holds(root);
    }
    status = status || !arguments->json ? status : report_write(root, arguments->json);
    if (status) {
        fprintf(stderr, "conus-bench: %s\n", conus_message());
    }
    int code = status ? EXIT_DATA : bench.options.check && report_check(root) ? EXIT_CHECK : EXIT_SUCCESS;
    json_decref(root);
    json_decref(settings);
    json_decref(bench.runs);
    json_decref(bench.ratios);
    json_decref(bench.left_out);
    nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
    return code;
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    struct arguments arguments = {.options = {.angle = 5}};
    conus_status status = parse_arguments(&arguments, argc, argv);
    if (status) {
        fprintf(stderr, "conus-bench: %s\n", conus_message());
        return EXIT_USAGE;
    }
    if (arguments.help) {
        print_help();
        return EXIT_SUCCESS;
    }
    return run_benchmark(&arguments);
}
