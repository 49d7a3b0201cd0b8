/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads the atlas and its pathways, and finds out whether a file is one of them. */
#include "settings/atlas_input.h"

#include "common/messages.h"
#include "common/output.h"
#include "settings/atlas_name.h"
#include "settings/option_values.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/** One --pathway, taken apart. */
struct pathway {
    char *text;   /* what the others point into, and twice its size */
    char *path;   /* with ",volume=K" at its end, as the library wants it */
    char *name;   /* NULL if not given */
    char *volume; /* "volume=K", NULL if not given */
    double threshold;
};

static bool read_threshold(struct pathway *pathway, const char *value)
{
    if (!number_parse(value, &pathway->threshold) || pathway->threshold <= 0) {
        print_error_line("--pathway: threshold=%s is not a number above 0", value);
        return false;
    }
    return true;
}

static bool read_volume(struct pathway *pathway, char *key, const char *value)
{
    uint64_t index;
    if (!count_parse(value, UINT32_MAX, &index)) {
        print_error_line("--pathway: volume=%s is not a whole number from 0", value);
        return false;
    }
    pathway->volume = key;
    return true;
}

/* Reads "key=value", the text after a comma. */
static bool read_key(struct pathway *pathway, char *key)
{
    char *value = strchr(key, '=') + 1;
    if (strncmp(key, "threshold=", 10) == 0 && pathway->threshold == 0) {
        return read_threshold(pathway, value);
    }
    if (strncmp(key, "name=", 5) == 0 && !pathway->name) {
        pathway->name = value;
        return *value || (print_error_line("--pathway: name= is empty"), false);
    }
    if (strncmp(key, "volume=", 7) == 0 && !pathway->volume) {
        return read_volume(pathway, key, value);
    }
    print_error_line("--pathway: \"%s\" is none of threshold=T, name=S and volume=K, each at most once", key);
    return false;
}

/* Cuts keys off the end as long as there are some, since a file's name may have commas as well. */
static bool parse_pathway(struct pathway *pathway, const char *text)
{
    size_t size = strlen(text) + 1;
    pathway->text = calloc(2, size);
    if (!pathway->text) {
        print_error_line("--pathway: not enough memory");
        return false;
    }
    char *keys = memcpy(pathway->text, text, size);
    for (char *comma; (comma = strrchr(keys, ',')) && strchr(comma, '=');) {
        *comma = '\0';
        if (!read_key(pathway, comma + 1)) {
            return false;
        }
    }
    if (!*keys) {
        print_error_line("--pathway: \"%s\" names no file", text);
        return false;
    }
    pathway->path = pathway->text + size;
    snprintf(pathway->path, size, "%s%s%s", keys, pathway->volume ? "," : "", pathway->volume ? pathway->volume : "");
    return true;
}

static int add_pathway(conus_atlas *atlas, const char *text, uint64_t max_memory)
{
    struct pathway pathway = {0};
    int code = EXIT_USAGE;
    if (parse_pathway(&pathway, text)) {
        const conus_pathway_options options = {
            .threshold = pathway.threshold, .name = pathway.name, .max_memory = max_memory};
        conus_status status = conus_atlas_add_pathway(atlas, pathway.path, &options);
        code = status ? print_status(status) : EXIT_DONE;
    }
    free(pathway.text);
    return code;
}

/* The atlas's files and then those of the command line. */
struct progress {
    const struct atlas_settings *settings;
    size_t total; /* of the atlas, as was heard last */
    size_t more;
};

static bool hear_progress(void *user, const char *path, size_t done, size_t total)
{
    struct progress *progress = user;
    const struct atlas_settings *settings = progress->settings;
    progress->total = total;
    return !settings->progress || settings->progress(settings->progress_user, path, done, total + progress->more);
}

static int add_pathways(conus_atlas *atlas, const struct atlas_settings *settings, const struct progress *progress)
{
    int code = EXIT_DONE;
    for (size_t i = 0; !code && i < settings->pathways.count; i++) {
        const char *pathway = settings->pathways.items[i];
        bool goes_on = !settings->progress || settings->progress(settings->progress_user, pathway, progress->total + i,
                                                                 progress->total + progress->more);
        code = goes_on ? add_pathway(atlas, pathway, settings->max_memory) : EXIT_DATA;
    }
    return code;
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

static int load_named(conus_atlas **out, const struct atlas_name *name, const struct atlas_settings *settings)
{
    struct progress progress = {settings, 0, settings->pathways.count};
    const conus_load_options options = {.labels = atlas_name_labels(name, settings->labels),
                                        .labels_anyway = settings->labels_anyway,
                                        .max_memory = settings->max_memory,
                                        .progress = hear_progress,
                                        .progress_user = &progress};
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, name->path, &options);
    status = status ? status : conus_atlas_set_hemispheres(atlas, (conus_hemispheres)settings->hemispheres);
    if (status) {
        conus_atlas_destroy(atlas);
        return status == CONUS_ERROR_CANCELLED ? EXIT_DATA : print_status(status);
    }
    int code = add_pathways(atlas, settings, &progress);
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
    struct atlas_name name;
    int code = atlas_name_find(&name, path);
    code = code ? code : load_named(out, &name, settings);
    atlas_name_finish(&name);
    return code;
}

int settings_load_context(conus_atlas *atlas, const char *path, double blocks, const struct atlas_settings *settings)
{
    const conus_context_options options = {.block_threshold = blocks, .max_memory = settings->max_memory};
    conus_status status = path ? conus_atlas_set_context(atlas, path, &options) : CONUS_OK;
    return status ? print_status(status) : EXIT_DONE;
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

/* A surface that is not closed has no volume, nor has one whose parts overlap or face different ways. */
void settings_say_open(const conus_atlas *atlas, const struct engine_settings *engine,
                       const struct common_settings *settings)
{
    size_t surfaces = 0;
    size_t open = 0;
    size_t odd = 0;
    for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        surfaces += object->triangles > 0;
        open += object->triangles > 0 && !object->closed;
        odd += object->closed && object->volume_mm3 == 0;
    }
    if (odd && engine->layers == CONUS_LAYERS_ALL && !settings->quiet) {
        print_error_line(
            "note: %zu of %zu surfaces overlap themselves, or have parts that face inwards and are no cavities: there "
            "is no fraction",
            odd, surfaces);
    }
    if (open && engine->layers == CONUS_LAYERS_ALL && !settings->quiet) {
        print_error_line(
            "note: %zu of %zu surfaces are not closed: paths count only where a ray goes in and comes out, and "
            "there is no fraction",
            open, surfaces);
    }
}
