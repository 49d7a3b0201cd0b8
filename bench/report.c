/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the JSON of conus-bench: machine, settings, and whether each ratio keeps its bound. */
#include "bench/all.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "conus/own.h"
#include "render/gl/gl.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

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

/* "none: " and the reason, without OpenGL. */
static void find_gl(char *renderer, char *version, size_t size)
{
    struct gl_context *context = NULL;
    struct gl_current previous;
    conus_status status = gl_context_create(&context, NULL, NULL);
    status = status ? status : gl_context_use(context, &previous);
    if (status) {
        snprintf(renderer, size, "none: %s", conus_message());
        snprintf(version, size, "none");
    } else {
        snprintf(renderer, size, "%s", gl_context_renderer(context));
        snprintf(version, size, "%s", (const char *)glGetString(GL_VERSION));
        gl_current_restore(&previous);
    }
    gl_context_destroy(context);
}

static json_t *versions(void)
{
    char renderer[160], version[160];
    struct utsname system = {0};
    find_gl(renderer, version, sizeof renderer);
    uname(&system);
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:s}", "gl", version, "gl_renderer", renderer, "embree",
                     CONUS_BENCH_EMBREE, "vtk", CONUS_BENCH_VTK, "compiler", CONUS_BENCH_COMPILER, "build",
                     CONUS_BENCH_BUILD, "kernel", system.release);
}

double report_load(void)
{
    double load = (double)NAN;
    return getloadavg(&load, 1) == 1 ? load : (double)NAN;
}

/* JSON has no NAN. */
static json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static const struct hold {
    const char *key;
    bool at_most;
    double limit;
} holds[] = {
    {"naive_over_rays", false, 600},
    {"naive_over_gl", false, 44},
    {"naive_over_gl_20deg", false, 36},
    {"id_over_colour_gl", true, 0.003},
    {"rays_200k_over_1k", true, 1.8},
    {"vtkselector_over_rays", false, 500},
    {"vtkcelllocator_over_rays", false, 20},
    {"vtkfixed_over_skipping", false, 1.1},
    {"dda_over_simd", false, 22},
    {"layers_over_visible_aal", true, 12},
    {"layers_over_visible", true, 6},
    {"mesh_over_embree", true, 1.3},
    {"batch_over_trace", true, 1.15},
    {"batch_one_over_two_threads", false, 1.9},
    {"python_over_batch", false, 1},
    {"tracts_million_over_10k", true, 6},
    {"open_bytes_per_voxel", true, 3.1},
    {"query_packed_over_gunzip", true, 0.2},
    {"range_over_cone", true, 1.2},
    {"cylinder_over_cone", true, 2},
    {"cylinder_layers_over_cone_layers", true, 1.5},
    {"plan_over_no_pruning", true, 0.1},
    {"clearance_needle_ms", true, 1},
};

enum { HOLD_COUNT = sizeof holds / sizeof holds[0] };

static bool is_kept(const struct hold *hold, double value)
{
    return hold->at_most ? value <= hold->limit : value >= hold->limit;
}

/* {key: {at_least or at_most: limit, met: bool}} of the keys that were measured. */
static json_t *held(const json_t *ratios)
{
    json_t *all = json_object();
    for (size_t i = 0; i < HOLD_COUNT; i++) {
        const json_t *value = json_object_get(ratios, holds[i].key);
        if (value) {
            bool kept = json_is_number(value) && is_kept(&holds[i], json_number_value(value));
            json_object_set_new(
                all, holds[i].key,
                json_pack("{s:f, s:b}", holds[i].at_most ? "at_most" : "at_least", holds[i].limit, "met", kept));
        }
    }
    return all;
}

void report_print_holds(const json_t *root)
{
    const json_t *ratios = json_object_get(root, "ratios");
    for (size_t i = 0; i < HOLD_COUNT; i++) {
        const json_t *value = json_object_get(ratios, holds[i].key);
        const char *bound = holds[i].at_most ? "at most" : "at least";
        if (!value) {
            printf("%-30s not measured     (%s %g)\n", holds[i].key, bound, holds[i].limit);
        } else {
            double x = json_number_value(value);
            printf("%-30s %10.4g %-8s (%s %g)\n", holds[i].key, x, is_kept(&holds[i], x) ? "" : "NOT MET", bound,
                   holds[i].limit);
        }
    }
}

json_t *report_settings(const struct bench *bench, double seconds, double load)
{
    const struct bench_options *o = &bench->options;
    return json_pack("{s:s, s:s, s:f, s:I, s:I, s:I, s:f, s:s, s:s, s:s, s:f, s:o, s:o}", "atlas", o->atlas, "context",
                     o->context, "angle_deg", o->angle, "poses", (json_int_t)o->poses, "slices", (json_int_t)o->slices,
                     "repeats", (json_int_t)o->repeats, "seconds_per_measurement", o->seconds, "clock",
                     bench->one_thread ? "CPU time of one thread" : "wall", "driver", bench->driver, "note",
                     bench->note ? bench->note : "", "took_s", seconds, "load_start", json_number(load), "load_end",
                     json_number(report_load()));
}

json_t *report_create(const struct bench *bench, const json_t *scenarios, double load)
{
    char model[128], machine[192], when[32];
    time_t now = time(NULL);
    find_cpu_model(model, sizeof model);
    snprintf(machine, sizeof machine, "%s, %ld CPUs", model, sysconf(_SC_NPROCESSORS_ONLN));
    strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%SZ", gmtime(&now));
    json_t *settings =
        json_pack("{s:b, s:s, s:O}", "check", bench->options.check, "written", when, "scenarios", scenarios);
    return json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:O, s:O, s:o, s:O, s:I}", "version", conus_version(), "machine",
                     machine, "versions", versions(), "load_start", json_number(load), "load_end",
                     json_number(report_load()), "settings", settings, "runs", bench->runs, "ratios", bench->ratios,
                     "holds", held(bench->ratios), "left_out", bench->left_out, "crashed", (json_int_t)bench->crashed);
}

conus_status report_write(const json_t *root, const char *path)
{
    char *text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
    struct buffer buffer = {0};
    if (text) {
        buffer_format(&buffer, "%s\n", text);
    }
    conus_status status = text ? buffer_status(&buffer) : fail(CONUS_ERROR_MEMORY, "out of memory");
    status = status ? status : conus_write_file(path, buffer.data, buffer.size);
    buffer_finish(&buffer);
    free(text);
    return status;
}

size_t report_check(const json_t *root)
{
    size_t wrong = 0, index;
    const json_t *runs = json_object_get(root, "runs"), *run, *value;
    const char *key;
    json_array_foreach(runs, index, run)
    {
        if (!json_is_true(json_object_get(run, "equal")) && !json_is_true(json_object_get(run, "other_by_design"))) {
            fprintf(stderr, "check: %s, %s: the answers differ\n", json_string_value(json_object_get(run, "scenario")),
                    json_string_value(json_object_get(run, "variant")));
            wrong++;
        }
    }
    if (json_integer_value(json_object_get(root, "crashed"))) {
        fprintf(stderr, "check: a scenario crashed: see \"left_out\"\n");
        wrong++;
    }
    if (!json_array_size(runs)) {
        fprintf(stderr, "check: nothing was run\n");
        wrong++;
    }
    json_object_foreach(json_object_get(root, "ratios"), key, value)
    {
        if (json_is_null(value)) {
            fprintf(stderr, "check: %s is null\n", key);
            wrong++;
        }
    }
    return wrong;
}
