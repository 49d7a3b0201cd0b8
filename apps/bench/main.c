/* SPDX-License-Identifier: BSD-3-Clause */
#include "apps/bench/bench.h"
#include "base/buffer.h"
#include "base/file.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEFAULT_ATLAS "/usr/share/mricron/templates/aal.nii.gz"
#define DEFAULT_CONTEXT "/usr/share/mricron/templates/ch2bet.nii.gz"

enum { EXIT_USAGE = 2, EXIT_DATA = 3, DEFAULT_POSES = 64, DEFAULT_SLICES = 362, DEFAULT_REPEATS = 9 };

static const struct bench_scenario scenarios[] = {
    {"census", "the voxels in cones of 5, 20 and 60 degrees: every one asked against the walk over rows", bench_census},
    {"batch", "poses as text in, rows as text out, on one thread and two, against plain traversal", bench_batch},
    {"colour", "a picture: blended slices against ray casting without and with skipping", bench_colour},
    {"hand", "a trembling hand: how often --poses trials select the area that was meant", bench_hand},
    {"volume", "256 rays through a labelled volume: plain traversal against the rays engine", bench_volume},
    {"mesh", "256 rays at an atlas's surfaces (--atlas MANIFEST), one at a time or in packets", bench_mesh},
    {"torus", "256 rays into 1,000 to 200,000 tori, one at a time or in packets", bench_torus},
    {"gl_layers", "256 rays into 20,000 tori by OpenGL: what is visible and all layers", bench_gl_layers},
    {"layers", "256 rays into 20,000 tori: what is visible and all layers, the engine alone and whole queries",
     bench_layers},
};

enum { SCENARIO_COUNT = sizeof scenarios / sizeof scenarios[0] };

static void print_help(void)
{
    puts("usage: conus-bench SCENARIO [options]\n\nscenarios:");
    for (size_t i = 0; i < SCENARIO_COUNT; i++) {
        printf("  %-10s %s\n", scenarios[i].name, scenarios[i].description);
    }
    puts("\noptions:\n"
         "  --atlas FILE   labelled volume, or a manifest (default " DEFAULT_ATLAS ")\n"
         "  --context FILE volume around the areas in pictures (default " DEFAULT_CONTEXT ")\n"
         "  --slices N     planes of a picture (default 362)\n"
         "  --angle A      full opening angle in degrees (default 5)\n"
         "  --poses N      cones per round (default 64)\n"
         "  --repeats N    rounds in which every variant runs once (default 9)\n"
         "  --record FILE  write the poses of the hand, for conus track\n"
         "  --json FILE    write everything measured");
}

static conus_status parse_count(const char *option, const char *value, size_t *out)
{
    uint64_t number;
    if (!text_to_uint(text_from(value), 1000000, &number) || number == 0) {
        return fail(CONUS_ERROR_ARGUMENT, "--%s: '%s', allowed is 1 to 1000000", option, value);
    }
    *out = (size_t)number;
    return CONUS_OK;
}

static conus_status parse_angle(const char *value, double *out)
{
    double angle;
    if (!text_to_double(text_from(value), &angle) || !(angle > 0 && angle < 180)) {
        return fail(CONUS_ERROR_ARGUMENT, "--angle: '%s', allowed is more than 0 and less than 180", value);
    }
    *out = angle;
    return CONUS_OK;
}

struct arguments {
    struct bench_options options;
    const struct bench_scenario *scenario;
    const char *json;
    bool help;
};

static conus_status parse_option(struct arguments *out, int option)
{
    switch (option) {
    case 'a':
        out->options.atlas = optarg;
        return CONUS_OK;
    case 'c':
        out->options.context = optarg;
        return CONUS_OK;
    case 's':
        return parse_count("slices", optarg, &out->options.slices);
    case 'g':
        return parse_angle(optarg, &out->options.angle);
    case 'p':
        return parse_count("poses", optarg, &out->options.poses);
    case 'r':
        return parse_count("repeats", optarg, &out->options.repeats);
    case 'o':
        out->options.record = optarg;
        return CONUS_OK;
    case 'j':
        out->json = optarg;
        return CONUS_OK;
    case 'h':
        out->help = true;
        return CONUS_OK;
    default:
        return fail(CONUS_ERROR_ARGUMENT, "unknown option, or one without its value; see conus-bench --help");
    }
}

static conus_status parse(struct arguments *out, int argc, char **argv)
{
    static const struct option table[] = {
        {"atlas", required_argument, NULL, 'a'},  {"context", required_argument, NULL, 'c'},
        {"slices", required_argument, NULL, 's'}, {"angle", required_argument, NULL, 'g'},
        {"poses", required_argument, NULL, 'p'},  {"repeats", required_argument, NULL, 'r'},
        {"record", required_argument, NULL, 'o'}, {"json", required_argument, NULL, 'j'},
        {"help", no_argument, NULL, 'h'},         {NULL, 0, NULL, 0}};
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "h", table, NULL)) != -1;) {
        conus_status status = parse_option(out, option);
        if (status) {
            return status;
        }
    }
    for (size_t i = 0; i < SCENARIO_COUNT && optind + 1 == argc; i++) {
        out->scenario = strcmp(argv[optind], scenarios[i].name) ? out->scenario : &scenarios[i];
    }
    return out->scenario || out->help ? CONUS_OK
                                      : fail(CONUS_ERROR_ARGUMENT, "name one scenario; see conus-bench --help");
}

/* The words behind the first "model name" of /proc/cpuinfo. */
static void find_cpu_model(char *out, size_t size)
{
    char line[512];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(out, size, "unknown CPU");
    while (file && fgets(line, sizeof line, file)) {
        char *colon = strchr(line, ':');
        if (colon && strncmp(line, "model name", strlen("model name")) == 0) {
            struct text model = text_trim(text_from(colon + 1));
            snprintf(out, size, "%.*s", (int)model.size, model.data);
            break;
        }
    }
    if (file) {
        fclose(file);
    }
}

static conus_status write_json(const struct bench *bench, const char *path)
{
    char model[128], machine[192];
    find_cpu_model(model, sizeof model);
    snprintf(machine, sizeof machine, "%s, %ld CPUs", model, sysconf(_SC_NPROCESSORS_ONLN));
    const struct bench_options *o = &bench->options;
    json_t *root = json_pack(
        "{s:s, s:s, s:s, s:{s:s, s:s, s:f, s:I, s:I, s:I, s:s}, s:O, s:O}", "version", conus_version(), "machine",
        machine, "driver", bench->driver, "settings", "atlas", o->atlas, "context", o->context, "angle_deg", o->angle,
        "poses", (json_int_t)o->poses, "slices", (json_int_t)o->slices, "repeats", (json_int_t)o->repeats, "clock",
        bench->one_thread ? "CPU time of one thread" : "wall", "runs", bench->runs, "ratios", bench->ratios);
    char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) : NULL;
    struct buffer buffer = {0};
    if (text) {
        buffer_format(&buffer, "%s\n", text);
    }
    conus_status status = text ? buffer_status(&buffer) : fail(CONUS_ERROR_MEMORY, "out of memory");
    status = status ? status : conus_write_file(path, buffer.data, buffer.size);
    buffer_finish(&buffer);
    free(text);
    json_decref(root);
    return status;
}

static conus_status run(const struct arguments *arguments)
{
    struct bench bench = {.options = arguments->options, .runs = json_array(), .ratios = json_object()};
    conus_status status =
        bench.runs && bench.ratios ? arguments->scenario->run(&bench) : fail(CONUS_ERROR_MEMORY, "out of memory");
    if (!status && arguments->json) {
        status = write_json(&bench, arguments->json);
    }
    json_decref(bench.runs);
    json_decref(bench.ratios);
    return status;
}

int main(int argc, char **argv)
{
    struct arguments arguments = {.options = {.atlas = DEFAULT_ATLAS,
                                              .context = DEFAULT_CONTEXT,
                                              .angle = 5,
                                              .poses = DEFAULT_POSES,
                                              .slices = DEFAULT_SLICES,
                                              .repeats = DEFAULT_REPEATS}};
    conus_status status = parse(&arguments, argc, argv);
    if (status) {
        fprintf(stderr, "conus-bench: %s\n", conus_message());
        return EXIT_USAGE;
    }
    if (arguments.help) {
        print_help();
        return EXIT_SUCCESS;
    }
    status = run(&arguments);
    if (status) {
        fprintf(stderr, "conus-bench: %s\n", conus_message());
        return EXIT_DATA;
    }
    return EXIT_SUCCESS;
}
