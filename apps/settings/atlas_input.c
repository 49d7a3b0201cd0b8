/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads the atlas, its pathways and streamlines. */
#include "settings/settings.h"

#include "base/system/system.h"
#include "base/text.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"

#include "conus/own.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One --pathway, or several with bands of one file. */
struct pathway_option {
    char *text;                    /* The text that the others point into. */
    const char *given;             /* As it was given: borrowed. */
    char *path;                    /* With ",volume=K" and the like at its end, as the library takes it. */
    conus_band *bands;             /* Those of the options, in the order in which they were given. */
    conus_pathway_options options; /* Names point into texts. */
};

static bool add_bands(struct pathway_option *pathway, const conus_band *bands, size_t count)
{
    conus_band *all = realloc(pathway->bands, (pathway->options.band_count + count) * sizeof *all);
    if (!all) {
        return refuse("--pathway: not enough memory");
    }
    memcpy(all + pathway->options.band_count, bands, count * sizeof *bands);
    pathway->bands = all;
    pathway->options.bands = all;
    pathway->options.band_count += count;
    return true;
}

/* A number, or nothing for `open`. */
static bool read_end(double *out, const char *text, double open)
{
    *out = open;
    return !*text || number_parse(text, out);
}

/* "LOW:HIGH:NAME"; the name may have colons. */
static bool read_band(struct pathway_option *pathway, char *value)
{
    conus_band band = {0};
    char *high = strchr(value, ':');
    char *name = high ? strchr(high + 1, ':') : NULL;
    if (!name || !name[1]) {
        return refuse("--pathway: band=%s is not LOW:HIGH:NAME", value);
    }
    *high++ = '\0';
    *name++ = '\0';
    band.name = name;
    if (!read_end(&band.low, value, -INFINITY) || !read_end(&band.high, high, INFINITY)) {
        return refuse("--pathway: band=%s:%s:%s: LOW and HIGH are numbers, or nothing", value, high, name);
    }
    return add_bands(pathway, &band, 1);
}

/* Takes `text` apart; prints an error and returns false where that is no pathway. End `out` in either case. */
static bool pathway_option_parse(struct pathway_option *out, const char *text)
{
    size_t size = strlen(text) + 1;
    struct source_keys keys;
    *out = (struct pathway_option){.text = calloc(2, size), .given = text};
    if (!out->text) {
        return refuse("--pathway: not enough memory");
    }
    if (!option_cut_keys(&keys, "pathway", memcpy(out->text, text, size), KEYS_PATHWAY)) {
        return false;
    }
    out->path = out->text + size;
    keys_keep(out->path, out->text, &keys, KEYS_VOLUME);
    out->options = (conus_pathway_options){.threshold = keys_value(&keys, KEY_THRESHOLD)->numbers[0],
                                           .name = keys_string(&keys, KEY_NAME),
                                           .unit = keys_string(&keys, KEY_UNIT)};
    for (size_t i = 0; i < keys.count; i++) {
        const struct key_value *key = &keys.values[i];
        if (key->id == KEY_BAND && !read_band(out, out->text + (key->text.data - out->text))) {
            return false;
        }
    }
    const char *other = out->options.threshold > 0 ? "threshold" : out->options.name ? "name" : NULL;
    if (out->options.band_count && other) {
        return refuse("--pathway: band= and %s= exclude each other: a band has its own", other);
    }
    return true;
}

/* Of "ras" or "lps". */
static conus_file_space file_space_of(const struct source_keys *keys)
{
    const char *word = keys_string(keys, KEY_SPACE);
    return !word ? CONUS_FILE_SPACE_AS_STATED : *word == 'r' ? CONUS_FILE_SPACE_RAS : CONUS_FILE_SPACE_LPS;
}

struct streamlines_option {
    char *path; /* Its text, which is cut where the file's name ends. */
    bool moves; /* With the atlas. */
    conus_streamlines_options options;
};

/* Takes `text` apart; prints an error and returns false where that is no tractogram with its keys. End `out` in
 * either case. */
static bool streamlines_option_parse(struct streamlines_option *out, const char *text)
{
    struct source_keys keys;
    *out = (struct streamlines_option){.path = strdup(text)};
    if (!option_cut_keys(&keys, "streamlines", out->path, KEYS_STREAMLINES)) {
        return false;
    }
    out->moves = keys.given & KEY_BIT(KEY_MOVES);
    out->options = (conus_streamlines_options){.radius = keys_value(&keys, KEY_RADIUS)->numbers[0],
                                               .name = keys_string(&keys, KEY_NAME),
                                               .space = file_space_of(&keys)};
    return true;
}

/* A field and what it resamples may take `max_memory`, 0 = the default. */
static int transform_apply(conus_atlas *atlas, const char *given, uint64_t max_memory)
{
    struct source_keys keys;
    char *path = strdup(given);
    conus_status status = CONUS_OK;
    int code = option_cut_keys(&keys, "atlas-transform", path, KEYS_TRANSFORM) ? EXIT_DONE : EXIT_USAGE;
    const bool is_relative = !code && keys.given & KEY_BIT(KEY_RELATIVE);
    const bool is_absolute = !code && keys.given & KEY_BIT(KEY_ABSOLUTE);
    if (is_relative && is_absolute) {
        code = print_usage_error("--atlas-transform: relative and absolute exclude each other");
    }
    if (!code) {
        const struct key_value *number = keys_value(&keys, KEY_TRANSFORM);
        const conus_transform_options options = {.inverse = keys.given & KEY_BIT(KEY_INVERSE),
                                                 .vectors = is_relative   ? CONUS_VECTORS_RELATIVE
                                                            : is_absolute ? CONUS_VECTORS_ABSOLUTE
                                                                          : CONUS_VECTORS_AS_STATED,
                                                 .space = file_space_of(&keys),
                                                 .grid = keys_string(&keys, KEY_GRID),
                                                 .from = keys_string(&keys, KEY_FROM),
                                                 .to = keys_string(&keys, KEY_TO),
                                                 .transform = number->count ? (size_t)number->numbers[0] + 1 : 0,
                                                 .max_memory = max_memory};
        status = conus_atlas_transform(atlas, path, &options);
    }
    free(path);
    return status ? print_status(status) : code;
}

/* The atlas's files and then those of the command line. */
struct progress {
    const struct atlas_settings *settings;
    size_t total; /* of the atlas, as last reported */
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
        bool joined = false;
        if (!pathway_option_parse(&pathways[i], texts->items[i])) {
            return SIZE_MAX;
        }
        for (size_t k = 0; k < i && !joined; k++) {
            struct pathway_option *first = &pathways[k];
            const size_t bands = pathways[i].options.band_count;
            joined = first->options.band_count && bands && strcmp(first->path, pathways[i].path) == 0;
            if (joined && !add_bands(first, pathways[i].bands, bands)) {
                return SIZE_MAX;
            }
        }
        pathways[i].given = joined ? NULL : pathways[i].given;
        pathways[i].options.band_count *= !joined;
        count += !joined;
    }
    return count;
}

static int add_pathways(conus_atlas *atlas, const struct pathway_option *pathways, struct progress *progress)
{
    const struct atlas_settings *settings = progress->settings;
    int code = EXIT_DONE;
    for (size_t i = 0; !code && i < settings->pathways.count; i++) {
        if (!pathways[i].given) {
            continue;
        }
        if (!begin_file(progress, pathways[i].given)) {
            return EXIT_DATA;
        }
        conus_pathway_options own = pathways[i].options;
        own.max_memory = settings->max_memory;
        code = print_status(conus_atlas_add_pathway(atlas, pathways[i].path, &own));
    }
    return code;
}

/* Adds the tractograms that --atlas-transform moves, or those that it does not. */
static int add_streamlines(conus_atlas *atlas, const struct streamlines_option *options, bool moves,
                           struct progress *progress)
{
    const struct atlas_settings *settings = progress->settings;
    int code = EXIT_DONE;
    for (size_t i = 0; !code && i < settings->streamlines.count; i++) {
        if (options[i].moves == moves) {
            conus_streamlines_options own = options[i].options;
            own.max_memory = settings->max_memory;
            struct tract_shelf *shelf = settings->shelf;
            const conus_tractogram *kept = NULL;
            if (!(shelf && tract_shelf_has(shelf, options[i].path, own.space)) &&
                !begin_file(progress, options[i].path)) {
                return EXIT_DATA;
            }
            conus_status status = shelf ? tract_shelf_find(&kept, shelf, options[i].path, &own)
                                        : conus_atlas_add_streamlines(atlas, options[i].path, &own);
            status = status || !shelf ? status : conus_atlas_add_tractogram(atlas, kept, &own);
            code = print_status(status);
        }
    }
    return code;
}

/* The command line's additions to an atlas. */
struct additions {
    struct pathway_option *pathways;        /* [settings->pathways.count] */
    struct streamlines_option *streamlines; /* [settings->streamlines.count] */
    size_t files;
};

/* Gives the exit code; `out` is the caller's to additions_finish() in any case. */
static int additions_parse(struct additions *out, const struct atlas_settings *settings)
{
    size_t count = settings->streamlines.count;
    out->pathways = calloc(settings->pathways.count + 1, sizeof *out->pathways);
    out->streamlines = calloc(count + 1, sizeof *out->streamlines);
    if (!out->pathways || !out->streamlines) {
        return print_no_memory();
    }
    size_t files = parse_pathways(out->pathways, &settings->pathways);
    bool parsed = files != SIZE_MAX;
    for (size_t i = 0; i < count && parsed; i++) {
        const char *text = settings->streamlines.items[i];
        parsed = streamlines_option_parse(&out->streamlines[i], text);
        if (parsed && out->streamlines[i].moves && !settings->transforms.count) {
            print_error_line("--streamlines %s: there is no --atlas-transform that could move it", text);
            parsed = false;
        }
    }
    out->files = files + count;
    return parsed ? EXIT_DONE : EXIT_USAGE;
}

static void additions_finish(struct additions *additions, const struct atlas_settings *settings)
{
    for (size_t i = 0; additions->pathways && i < settings->pathways.count; i++) {
        free(additions->pathways[i].bands);
        free(additions->pathways[i].text);
    }
    for (size_t i = 0; additions->streamlines && i < settings->streamlines.count; i++) {
        free(additions->streamlines[i].path);
    }
    free(additions->pathways);
    free(additions->streamlines);
}

/* The option's lists as one; NULL if it was not given, or without memory. */
static char *join_lists(const struct option_list *lists)
{
    struct system_text joined;
    FILE *out = lists->count ? system_text_open(&joined) : NULL;
    for (size_t i = 0; out && i < lists->count; i++) {
        fprintf(out, "%s%s", i ? "," : "", lists->items[i]);
    }
    return lists->count ? system_text_close(&joined) : NULL;
}

static bool is_bundle(const conus_atlas *atlas, size_t number)
{
    return conus_atlas_object(atlas, number)->kind == CONUS_KIND_BUNDLE;
}

/* Shows objects where bundles are what is asked about: a list to keep that names none of them is about areas, and all
 * bundles stay but those of `hide`. */
static conus_status show_with_bundles(conus_atlas *atlas, const char *only, const char *hide)
{
    size_t count = conus_atlas_object_count(atlas);
    bool *hidden = calloc(count + 1, sizeof *hidden);
    bool names_bundle = false;
    conus_status status = hidden ? conus_atlas_show(atlas, only, NULL) : CONUS_ERROR_MEMORY;
    for (size_t number = 1; !status && number <= count; number++) {
        names_bundle = names_bundle || (is_bundle(atlas, number) && !conus_atlas_is_hidden(atlas, number));
    }
    status = status || names_bundle ? status : conus_atlas_show(atlas, NULL, hide);
    for (size_t number = 1; !status && number <= count; number++) {
        hidden[number] = conus_atlas_is_hidden(atlas, number);
    }
    status = status ? status : conus_atlas_show(atlas, only, hide);
    for (size_t number = 1; !status && number <= count; number++) {
        hidden[number] =
            is_bundle(atlas, number) && !names_bundle ? hidden[number] : conus_atlas_is_hidden(atlas, number);
    }
    status = status ? status : conus_atlas_set_hidden(atlas, hidden);
    free(hidden);
    return status;
}

static int show_objects(conus_atlas *atlas, const struct atlas_settings *settings)
{
    char *only = join_lists(&settings->only);
    char *hide = join_lists(&settings->hide);
    bool failed = (settings->only.count && !only) || (settings->hide.count && !hide);
    conus_status status = failed                           ? CONUS_ERROR_MEMORY
                          : only && settings->asks_bundles ? show_with_bundles(atlas, only, hide)
                                                           : conus_atlas_show(atlas, only, hide);
    free(only);
    free(hide);
    return failed ? print_no_memory() : print_status(status);
}

bool atlas_input_is_image(const char *why)
{
    return strstr(why, "--context draws");
}

typedef conus_status (*catalogue_search)(const conus_installed **out, const conus_catalogue *catalogue,
                                         const char *name);

static int find_named(struct atlas_name *out, const char *text, bool is_path, catalogue_search find)
{
    *out = (struct atlas_name){.path = text};
    if (is_path) {
        return EXIT_DONE;
    }
    const char *key = text + keys_file_length(text, KEYS_ATLAS);
    char *name = text_copy(text, (size_t)(key - text));
    if (!name) {
        return print_no_memory();
    }
    conus_status status = conus_catalogue_create(&out->catalogue, NULL);
    status = status ? status : find(&out->atlas, out->catalogue, name);
    free(name);
    if (status) {
        return print_status(status);
    }
    if (*key && asprintf(&out->owned, "%s%s", out->atlas->path, key) < 0) {
        out->owned = NULL;
        return print_no_memory();
    }
    out->path = *key ? out->owned : out->atlas->path;
    return EXIT_DONE;
}

int atlas_name_find(struct atlas_name *out, const char *text)
{
    return find_named(out, text, conus_atlas_is_path(text), conus_catalogue_find);
}

int context_name_find(struct atlas_name *out, const char *text)
{
    return find_named(out, text, conus_context_is_surface(text) || conus_atlas_is_path(text),
                      conus_catalogue_find_image);
}

void atlas_name_finish(struct atlas_name *name)
{
    conus_catalogue_destroy(name->catalogue);
    free(name->owned);
    *name = (struct atlas_name){0};
}

const char *atlas_name_labels(const struct atlas_name *name, const char *given)
{
    return given || !name->atlas ? given : name->atlas->labels;
}

static int choose_hemispheres(conus_atlas *atlas, const char *path, const struct atlas_settings *settings)
{
    conus_status status = conus_atlas_set_hemispheres(atlas, (conus_hemispheres)settings->hemispheres);
    if (status && settings->more.count) { /* names the atlas without such hemispheres */
        print_error_line("%s: %s", path, conus_message());
        return exit_code_of(status);
    }
    return print_status(status);
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
                                        .without_context = settings->answers && !settings->transforms.count};
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, name->path, &options);
    if (status == CONUS_ERROR_CANCELLED) {
        return EXIT_DATA;
    }
    if (status && settings->image_is_fine && atlas_input_is_image(conus_message())) {
        messages_hold(true);
        int code = print_status(status);
        messages_hold(false);
        return code;
    }
    int code = print_status(status ? status : settings->sides ? conus_atlas_exchange_sides(atlas) : CONUS_OK);
    code = code ? code : choose_hemispheres(atlas, name->path, settings);
    code = code ? code : add_streamlines(atlas, additions->streamlines, true, &progress);
    /* Points go through the first transform first; the atlas goes back through the last one first. */
    for (size_t i = settings->transforms.count; i > 0 && !code; i--) {
        code = transform_apply(atlas, settings->transforms.items[i - 1], settings->max_memory);
    }
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

int atlas_input_load(conus_atlas **out, const char *path, const struct atlas_settings *settings)
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

static int set_context(conus_atlas *atlas, const char *given, const conus_context_options *options)
{
    struct atlas_name name;
    int code = context_name_find(&name, given);
    conus_status status = code ? CONUS_OK : conus_atlas_set_context(atlas, name.path, options);
    code = code ? code : print_status(status);
    atlas_name_finish(&name);
    return code;
}

int atlas_input_load_context(conus_atlas *atlas, const char *path, double blocks, const struct atlas_settings *settings)
{
    const conus_context_options options = {.block_threshold = blocks, .max_memory = settings->max_memory};
    return path ? set_context(atlas, path, &options) : EXIT_DONE;
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
               : print_usage_error("--context-opacity has no effect: %s is no surface (--transfer is for volumes)",
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

static int load_map(conus_atlas *atlas, const struct context_choice *choice, const struct atlas_settings *settings)
{
    struct source_keys keys;
    char *path = strdup(choice->map);
    conus_status status = CONUS_OK;
    int code = option_cut_keys(&keys, "map", path, KEYS_MAP) ? EXIT_DONE : EXIT_USAGE;
    if (!code && !(keys.given & KEY_BIT(KEY_ARRAY))) {
        code = print_usage_error("--map: %s: which array? FILE,array=NAME", path);
    }
    if (!code) {
        const double *range = keys_value(&keys, KEY_RANGE)->numbers;
        const conus_context_map_options options = {.array = keys_string(&keys, KEY_ARRAY),
                                                   .range = {range[0], range[1]},
                                                   .opacity = choice->opacity,
                                                   .max_memory = settings->max_memory};
        status = conus_atlas_set_context_map(atlas, path, &options);
    }
    free(path);
    return status ? print_status(status) : code;
}

int context_choice_load(conus_atlas *atlas, const struct context_choice *choice, const struct atlas_settings *settings)
{
    int code = check_choice(choice);
    for (size_t i = 0; i < choice->files.count && !code; i++) {
        const char *path = choice->files.items[i];
        const conus_context_options options = {.opacity = conus_context_is_surface(path) ? choice->opacity : 0,
                                               .max_memory = settings->max_memory};
        code = set_context(atlas, path, &options);
    }
    return code || !choice->map ? code : load_map(atlas, choice, settings);
}
