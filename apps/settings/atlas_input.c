/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads the atlas, its pathways and streamlines, and finds out whether a file is one of them. */
#include "settings/atlas_input.h"

#include "options/messages.h"
#include "options/output.h"
#include "settings/atlas_name.h"
#include "settings/pathway_option.h"
#include "settings/streamlines_option.h"
#include "settings/transform_option.h"

#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int add_pathway(conus_atlas *atlas, const struct pathway_option *pathway, const struct atlas_settings *settings)
{
    const conus_pathway_options options = {.threshold = pathway->threshold,
                                           .name = pathway->name,
                                           .max_memory = settings->max_memory,
                                           .bands = pathway->bands,
                                           .band_count = pathway->band_count,
                                           .cache = !settings->no_cache};
    conus_status status = conus_atlas_add_pathway(atlas, pathway->path, &options);
    return status ? print_status(status) : EXIT_DONE;
}

/* The atlas's files and then those of the command line. */
struct progress {
    const struct atlas_settings *settings;
    size_t total; /* of the atlas, as was heard last */
    size_t more;
    size_t done; /* of those */
};

/* Tells that the file `path` of the command line is next. False if that ends it. */
static bool begin_file(struct progress *progress, const char *path)
{
    const struct atlas_settings *settings = progress->settings;
    size_t done = progress->total + progress->done++;
    return !settings->progress ||
           settings->progress(settings->progress_user, path, done, progress->total + progress->more);
}

static bool hear_progress(void *user, const char *path, size_t done, size_t total)
{
    struct progress *progress = user;
    const struct atlas_settings *settings = progress->settings;
    progress->total = total;
    return !settings->progress || settings->progress(settings->progress_user, path, done, total + progress->more);
}

/* Bands of one file are joined where the first of them stands, so that it is read once. Gives how many pathways are
 * left, SIZE_MAX after an error. */
static size_t parse_pathways(struct pathway_option *pathways, const struct option_list *texts)
{
    size_t count = 0;
    for (size_t i = 0; i < texts->count; i++) {
        int joined = 0;
        if (!pathway_option_parse(&pathways[i], texts->items[i])) {
            return SIZE_MAX;
        }
        for (size_t k = 0; k < i && !joined; k++) {
            joined = pathway_option_join(&pathways[k], &pathways[i]);
        }
        if (joined < 0) {
            return SIZE_MAX;
        }
        pathways[i].given = joined ? NULL : pathways[i].given;
        pathways[i].band_count = joined ? 0 : pathways[i].band_count;
        count += !joined;
    }
    return count;
}

static int add_pathways(conus_atlas *atlas, const struct pathway_option *pathways, struct progress *progress)
{
    const struct atlas_settings *settings = progress->settings;
    int code = EXIT_DONE;
    for (size_t i = 0; !code && i < settings->pathways.count; i++) {
        if (pathways[i].given) {
            bool goes_on = begin_file(progress, pathways[i].given);
            code = goes_on ? add_pathway(atlas, &pathways[i], settings) : EXIT_DATA;
        }
    }
    return code;
}

static int add_tractogram(conus_atlas *atlas, const struct streamlines_option *option, uint64_t max_memory)
{
    const conus_streamlines_options options = {
        .radius = option->radius, .name = option->name, .max_memory = max_memory};
    conus_status status = conus_atlas_add_streamlines(atlas, option->path, &options);
    return status ? print_status(status) : EXIT_DONE;
}

/* Those that move, or those that do not. */
static int add_streamlines(conus_atlas *atlas, const struct streamlines_option *options, bool moves,
                           struct progress *progress)
{
    const struct atlas_settings *settings = progress->settings;
    int code = EXIT_DONE;
    for (size_t i = 0; !code && i < settings->streamlines.count; i++) {
        if (options[i].moves == moves) {
            bool goes_on = begin_file(progress, options[i].path);
            code = goes_on ? add_tractogram(atlas, &options[i], settings->max_memory) : EXIT_DATA;
        }
    }
    return code;
}

/* What the command line adds to the atlas. */
struct additions {
    struct pathway_option *pathways;        /* as many as there are options */
    struct streamlines_option *streamlines; /* the same */
    size_t files;
};

static void additions_finish(struct additions *additions, const struct atlas_settings *settings)
{
    for (size_t i = 0; additions->pathways && i < settings->pathways.count; i++) {
        pathway_option_finish(&additions->pathways[i]);
    }
    for (size_t i = 0; additions->streamlines && i < settings->streamlines.count; i++) {
        streamlines_option_finish(&additions->streamlines[i]);
    }
    free(additions->pathways);
    free(additions->streamlines);
}

static bool parse_streamlines(struct streamlines_option *out, const char *text, const struct atlas_settings *settings)
{
    if (!streamlines_option_parse(out, text)) {
        return false;
    }
    if (out->moves && !settings->transforms.count) {
        print_error_line("--streamlines %s: there is no --atlas-transform that could move it", text);
        return false;
    }
    return true;
}

/* Gives the exit code; `out` is the caller's to additions_finish() in any case. */
static int additions_parse(struct additions *out, const struct atlas_settings *settings)
{
    size_t count = settings->streamlines.count;
    out->pathways = calloc(settings->pathways.count + 1, sizeof *out->pathways);
    out->streamlines = calloc(count + 1, sizeof *out->streamlines);
    if (!out->pathways || !out->streamlines) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    size_t files = parse_pathways(out->pathways, &settings->pathways);
    bool parsed = files != SIZE_MAX;
    for (size_t i = 0; i < count && parsed; i++) {
        parsed = parse_streamlines(&out->streamlines[i], settings->streamlines.items[i], settings);
    }
    out->files = files + count;
    return parsed ? EXIT_DONE : EXIT_USAGE;
}

/* The option's lists as one; NULL if it was not given, or without memory. */
static char *join_lists(const struct option_list *lists)
{
    char *joined = NULL;
    size_t size = 0;
    FILE *out = lists->count ? open_memstream(&joined, &size) : NULL;
    for (size_t i = 0; out && i < lists->count; i++) {
        fprintf(out, "%s%s", i ? "," : "", lists->items[i]);
    }
    if (out) {
        fclose(out);
    }
    return joined;
}

static int show_objects(conus_atlas *atlas, const struct atlas_settings *settings)
{
    char *only = join_lists(&settings->only);
    char *hide = join_lists(&settings->hide);
    bool failed = (settings->only.count && !only) || (settings->hide.count && !hide);
    conus_status status = failed ? CONUS_ERROR_MEMORY : conus_atlas_show(atlas, only, hide);
    free(only);
    free(hide);
    if (failed) {
        print_error_line("not enough memory");
    }
    return failed ? EXIT_DATA : status ? print_status(status) : EXIT_DONE;
}

/* Where there are several atlases, an error says which of them has no such hemispheres. */
static int set_hemispheres(conus_atlas *atlas, const char *path, const struct atlas_settings *settings)
{
    conus_status status = conus_atlas_set_hemispheres(atlas, (conus_hemispheres)settings->hemispheres);
    if (status && settings->more.count) {
        print_error_line("%s: %s", path, conus_message());
        return exit_code_of(status);
    }
    return status ? print_status(status) : EXIT_DONE;
}

bool atlas_input_is_image(const char *why)
{
    return strstr(why, "--context draws");
}

static int say_no_atlas(conus_status status, const struct atlas_settings *settings)
{
    bool is_fine = settings->image_is_fine && atlas_input_is_image(conus_message());
    if (is_fine) {
        messages_hold(true);
    }
    int code = print_status(status);
    if (is_fine) {
        messages_hold(false);
    }
    return code;
}

static int load_named(conus_atlas **out, const struct atlas_name *name, const struct additions *additions,
                      struct progress progress)
{
    const struct atlas_settings *settings = progress.settings;
    const conus_load_options options = {.labels = atlas_name_labels(name, settings->labels),
                                        .labels_anyway = settings->labels_anyway,
                                        .max_memory = settings->max_memory,
                                        .progress = hear_progress,
                                        .progress_user = &progress,
                                        .probability = settings->probability,
                                        .cache = !settings->no_cache};
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, name->path, &options);
    if (status) {
        return status == CONUS_ERROR_CANCELLED ? EXIT_DATA : say_no_atlas(status, settings);
    }
    int code = set_hemispheres(atlas, name->path, settings);
    code = code ? code : add_streamlines(atlas, additions->streamlines, true, &progress);
    code = code ? code : transform_options_apply(atlas, &settings->transforms, settings->max_memory);
    code = code ? code : add_pathways(atlas, additions->pathways, &progress);
    code = code ? code : add_streamlines(atlas, additions->streamlines, false, &progress);
    code = code || !(settings->only.count + settings->hide.count) ? code : show_objects(atlas, settings);
    if (code) {
        conus_atlas_destroy(atlas);
        return code;
    }
    *out = atlas;
    return EXIT_DONE;
}

int settings_load_atlas(conus_atlas **out, const char *path, const struct atlas_settings *settings)
{
    struct atlas_name name = {0};
    struct additions additions = {0};
    int code = additions_parse(&additions, settings);
    code = code ? code : atlas_name_find(&name, path);
    code = code ? code : load_named(out, &name, &additions, (struct progress){settings, 0, additions.files, 0});
    atlas_name_finish(&name);
    additions_finish(&additions, settings);
    return code;
}

int settings_load_context(conus_atlas *atlas, const char *path, double blocks, const struct atlas_settings *settings)
{
    const conus_context_options options = {
        .block_threshold = blocks, .max_memory = settings->max_memory, .cache = !settings->no_cache};
    conus_status status = path ? conus_atlas_set_context(atlas, path, &options) : CONUS_OK;
    return status ? print_status(status) : EXIT_DONE;
}

/* One volume, and an opacity only with surfaces. */
static int check_choice(const struct context_choice *choice)
{
    const char *volume = NULL;
    size_t surfaces = 0;
    for (size_t i = 0; i < choice->files.count; i++) {
        const char *path = choice->files.items[i];
        if (conus_context_is_surface(path)) {
            surfaces++;
        } else if (volume) {
            return print_usage_error("--context: %s and %s are no surfaces, one volume is allowed", volume, path);
        } else {
            volume = path;
        }
    }
    if (choice->opacity != 0 && !choice->files.count) {
        return print_usage_error("--context-opacity has no effect without --context");
    }
    return choice->opacity == 0 || surfaces
               ? EXIT_DONE
               : print_usage_error("--context-opacity has no effect: %s is no surface (--transfer is of volumes)",
                                   volume);
}

bool context_choice_has_volume(const struct context_choice *choice)
{
    bool found = false;
    for (size_t i = 0; i < choice->files.count; i++) {
        found = found || !conus_context_is_surface(choice->files.items[i]);
    }
    return found;
}

int context_choice_load(conus_atlas *atlas, const struct context_choice *choice, const struct atlas_settings *settings)
{
    int code = check_choice(choice);
    for (size_t i = 0; i < choice->files.count && !code; i++) {
        const char *path = choice->files.items[i];
        const conus_context_options options = {.opacity = conus_context_is_surface(path) ? choice->opacity : 0,
                                               .max_memory = settings->max_memory,
                                               .cache = !settings->no_cache};
        conus_status status = conus_atlas_set_context(atlas, path, &options);
        code = status ? print_status(status) : EXIT_DONE;
    }
    return code;
}

/* Whether `path` is the file that the atlas's label source names ("BIDS label table in aal.tsv, colours in aal.lut"),
 * which lies beside the voxels. */
static bool is_label_table(const conus_atlas *atlas, const char *path)
{
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    const char *voxels = info ? info->path : "";
    const char *slash = strrchr(voxels, '/');
    const char *own_slash = strrchr(path, '/');
    const char *name = own_slash ? own_slash + 1 : path;
    const char *source = conus_atlas_label_source(atlas);
    const char *named = strstr(source, name);
    char beside[PATH_MAX];
    if (!info || !named || named == source || named[-1] != ' ') {
        return false;
    }
    snprintf(beside, sizeof beside, "%.*s%s", slash ? (int)(slash - voxels + 1) : 0, voxels, name);
    return paths_equal(beside, path);
}

const char *settings_input(const conus_atlas *atlas, const struct input *inputs, const char *path)
{
    static const char *const roles[] = {[CONUS_ROLE_PARCELLATION] = "the atlas",
                                        [CONUS_ROLE_SCALAR] = "a pathway",
                                        [CONUS_ROLE_CONTEXT] = "the context",
                                        [CONUS_ROLE_PROBABILITY] = "the atlas"};
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        const conus_volume_info *info = conus_atlas_volume(atlas, i);
        if (paths_equal(info->path, path)) {
            return roles[info->role];
        }
    }
    for (size_t i = 0; i < conus_atlas_tractogram_count(atlas); i++) {
        conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
        if (!conus_atlas_tractogram(&info, atlas, i) && paths_equal(info.path, path)) {
            return "a tractogram";
        }
    }
    for (; inputs->what; inputs++) {
        if (inputs->path && paths_equal(inputs->path, path)) {
            return inputs->what;
        }
    }
    for (size_t i = 0; i < conus_atlas_file_count(atlas); i++) {
        if (paths_equal(conus_atlas_file(atlas, i), path)) {
            return is_label_table(atlas, path) ? "the label table" : "the atlas's file";
        }
    }
    return NULL;
}
