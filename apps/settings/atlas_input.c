/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads the atlas, its pathways and streamlines. */
#include "settings/atlas_input.h"

#include "base/system/system.h"
#include "base/text.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
#include "settings/settings.h"
#include "settings/tract_shelf.h"

#include "conus/streamlines.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One --pathway, or several with bands of one file. */
struct pathway_option {
    char *text;              /* The text that the others point into. */
    const char *given;       /* As it was given: borrowed. */
    char *path;              /* With ",volume=K" at its end, as the library wants it. */
    const char *name, *unit; /* NULL if not given. */
    char *volume;            /* "volume=K", NULL if not given. */
    double threshold;        /* 0 if not given. */
    conus_band *bands;       /* [band_count], in the order in which they were given; names point into texts. */
    size_t band_count;
};

static bool add_bands(struct pathway_option *pathway, const conus_band *bands, size_t count)
{
    conus_band *all = realloc(pathway->bands, (pathway->band_count + count) * sizeof *all);
    if (!all) {
        return refuse("--pathway: not enough memory");
    }
    memcpy(all + pathway->band_count, bands, count * sizeof *bands);
    pathway->bands = all;
    pathway->band_count += count;
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

/* Takes "NAME=VALUE" unless there is such a value already; false where it is no such key. */
static bool take_text(const char **out, const char *key, const char *name)
{
    bool is_it = !*out && strncmp(key, name, strlen(name)) == 0;
    *out = is_it ? key + strlen(name) : *out;
    return is_it;
}

/* Reads "key=value", the text after a comma. */
static bool read_key(struct pathway_option *pathway, char *key)
{
    char *value = strchr(key, '=') + 1;
    if (strncmp(key, "threshold=", 10) == 0 && pathway->threshold == 0) {
        return (number_parse(value, &pathway->threshold) && pathway->threshold > 0) ||
               refuse("--pathway: threshold=%s is not a number above 0", value);
    }
    if (take_text(&pathway->name, key, "name=") || take_text(&pathway->unit, key, "unit=")) {
        return *value || refuse("--pathway: %s is empty", key);
    }
    if (strncmp(key, "volume=", 7) == 0 && !pathway->volume) {
        uint64_t index;
        pathway->volume = key;
        return count_parse(value, UINT32_MAX, &index) ||
               refuse("--pathway: volume=%s is not a whole number from 0", value);
    }
    if (strncmp(key, "band=", 5) == 0) {
        return read_band(pathway, value);
    }
    return refuse("--pathway: \"%s\" is none of threshold=T, name=S, unit=S and volume=K, each at most once, and "
                  "band=LOW:HIGH:NAME",
                  key);
}

/* Takes `text` apart; prints an error and returns false where that is no pathway. End `out` in either case. Cuts
 * keys off the end as long as there are some, since a file's name may have commas as well. */
static bool pathway_option_parse(struct pathway_option *out, const char *text)
{
    static const char *const names[] = {",threshold=", ",name=", ",unit=", ",volume=", ",band=", NULL};
    size_t size = strlen(text) + 1;
    *out = (struct pathway_option){.text = calloc(2, size), .given = text};
    if (!out->text) {
        return refuse("--pathway: not enough memory");
    }
    char *keys = memcpy(out->text, text, size);
    for (char *comma; (comma = strrchr(keys, ',')) && strchr(comma, '=');) {
        *comma = '\0';
        if (!read_key(out, comma + 1)) {
            return false;
        }
    }
    if (!*keys) {
        return refuse("--pathway: \"%s\" names no file", text);
    }
    if (key_left_in_file("pathway", keys, names)) {
        return false;
    }
    out->path = out->text + size;
    snprintf(out->path, size, "%s%s%s", keys, out->volume ? "," : "", out->volume ? out->volume : "");
    for (size_t i = 0, count = out->band_count; i < count / 2; i++) { /* keys were read from the last to the first */
        conus_band first = out->bands[i];
        out->bands[i] = out->bands[count - 1 - i];
        out->bands[count - 1 - i] = first;
    }
    const char *other = out->threshold > 0 ? "threshold" : out->name ? "name" : NULL;
    if (out->band_count && other) {
        return refuse("--pathway: band= and %s= exclude each other: a band has its own", other);
    }
    return true;
}

/* "ras" or "lps". */
static bool file_space_parse(conus_file_space *out, const char *text)
{
    *out = strcmp(text, "ras") == 0   ? CONUS_FILE_SPACE_RAS
           : strcmp(text, "lps") == 0 ? CONUS_FILE_SPACE_LPS
                                      : CONUS_FILE_SPACE_AS_STATED;
    return *out != CONUS_FILE_SPACE_AS_STATED;
}

struct streamlines_option {
    char *path;       /* Its text, which is cut where the file's name ends. */
    const char *name; /* NULL if not given. */
    double radius;    /* mm; 0 if not given. */
    bool moves;       /* With the atlas. */
    conus_file_space space;
};

/* Reads "key=value" or "moves", the text after a comma. */
static bool streamlines_read_key(struct streamlines_option *out, char *key)
{
    if (strncmp(key, "radius=", 7) == 0 && out->radius == 0) {
        return (number_parse(key + 7, &out->radius) && out->radius > 0) ||
               refuse("--streamlines: radius=%s is not a number above 0", key + 7);
    }
    if (take_text(&out->name, key, "name=")) {
        return *out->name || refuse("--streamlines: name= is empty");
    }
    if (strcmp(key, "moves") == 0 && !out->moves) {
        return out->moves = true;
    }
    if (strncmp(key, "space=", 6) == 0 && !out->space) {
        return file_space_parse(&out->space, key + 6) ||
               refuse("--streamlines: space=%s, allowed are ras and lps", key + 6);
    }
    return refuse("--streamlines: \"%s\" is none of radius=R, name=S, space=S and moves, each at most once", key);
}

/* Takes `text` apart; prints an error and returns false where that is no tractogram with its keys. End `out` in
 * either case. Cuts keys off the end as long as there are some, since a file's name may have commas as well. */
static bool streamlines_option_parse(struct streamlines_option *out, const char *text)
{
    static const char *const keys[] = {",radius=", ",name=", ",space=", NULL};
    *out = (struct streamlines_option){.path = strdup(text)};
    if (!out->path) {
        return refuse("--streamlines: not enough memory");
    }
    for (char *comma; (comma = strrchr(out->path, ',')) && (strchr(comma, '=') || strcmp(comma, ",moves") == 0);) {
        *comma = '\0';
        if (!streamlines_read_key(out, comma + 1)) {
            return false;
        }
    }
    if (!*out->path) {
        print_error_line("--streamlines: \"%s\" names no file", text);
    }
    return *out->path && !key_left_in_file("streamlines", out->path, keys);
}

/* The parts of "FILE[,from=IMAGE,to=IMAGE][,inverse][,relative|absolute][,space=ras|lps][,grid=IMAGE][,transform=K]",
 * which is cut at its commas. */
struct transform_option {
    char *path;
    conus_transform_options options;
};

/* Takes a key, the text after a comma. False where it is no key: then it is a part of the file's name. */
static bool transform_take_key(struct transform_option *out, const char *key)
{
    if (strcmp(key, "inverse") == 0 && !out->options.inverse) {
        return out->options.inverse = true;
    }
    if ((strcmp(key, "relative") == 0 || strcmp(key, "absolute") == 0) && !out->options.vectors) {
        out->options.vectors = key[0] == 'r' ? CONUS_VECTORS_RELATIVE : CONUS_VECTORS_ABSOLUTE;
        return true;
    }
    if (strncmp(key, "space=", 6) == 0 && !out->options.space) {
        return file_space_parse(&out->options.space, key + 6);
    }
    if (strncmp(key, "transform=", 10) == 0 && !out->options.transform) {
        double number;
        bool is_number =
            number_parse(key + 10, &number) && number >= 0 && number < UINT32_MAX && number == floor(number);
        out->options.transform = is_number ? (size_t)number + 1 : 0;
        return is_number;
    }
    return take_text(&out->options.grid, key, "grid=") || take_text(&out->options.from, key, "from=") ||
           take_text(&out->options.to, key, "to=");
}

static bool is_empty(const char *text)
{
    return text && !*text;
}

/* A field and what it resamples may take `max_memory`, 0 = the default. */
static int transform_apply(conus_atlas *atlas, const char *given, uint64_t max_memory)
{
    char *text = strdup(given);
    struct transform_option option = {.path = text};
    if (!text) {
        return print_no_memory();
    }
    /* Keys are cut off the end as long as there are some, since a file's name may have commas as well. */
    for (char *comma; (comma = strrchr(text, ',')) && transform_take_key(&option, comma + 1);) {
        *comma = '\0';
    }
    option.options.max_memory = max_memory;
    bool empty = is_empty(option.path) || is_empty(option.options.from) || is_empty(option.options.to) ||
                 is_empty(option.options.grid);
    const char *space = strstr(option.path, ",space=");
    int code =
        empty   ? print_usage_error("--atlas-transform: \"%s\" names no file, or no image", given)
        : space ? print_usage_error("--atlas-transform: \"%s\", allowed are space=ras and space=lps, once", space + 1)
                : EXIT_DONE;
    code = code ? code : print_status(conus_atlas_transform(atlas, option.path, &option.options));
    free(text);
    return code;
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
        bool joined = false;
        if (!pathway_option_parse(&pathways[i], texts->items[i])) {
            return SIZE_MAX;
        }
        for (size_t k = 0; k < i && !joined; k++) {
            struct pathway_option *first = &pathways[k];
            joined = first->band_count && pathways[i].band_count && strcmp(first->path, pathways[i].path) == 0;
            if (joined && !add_bands(first, pathways[i].bands, pathways[i].band_count)) {
                return SIZE_MAX;
            }
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
        const struct pathway_option *pathway = &pathways[i];
        if (!pathway->given) {
            continue;
        }
        if (!begin_file(progress, pathway->given)) {
            return EXIT_DATA;
        }
        const conus_pathway_options options = {.threshold = pathway->threshold,
                                               .name = pathway->name,
                                               .unit = pathway->unit,
                                               .max_memory = settings->max_memory,
                                               .bands = pathway->bands,
                                               .band_count = pathway->band_count};
        code = print_status(conus_atlas_add_pathway(atlas, pathway->path, &options));
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
            const conus_streamlines_options own = {.radius = options[i].radius,
                                                   .name = options[i].name,
                                                   .space = options[i].space,
                                                   .max_memory = settings->max_memory};
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
    const char *key = strstr(text, ",template=");
    char *name = key ? text_copy(text, (size_t)(key - text)) : NULL;
    conus_status status = conus_catalogue_create(&out->catalogue, NULL);
    status = status ? status : find(&out->atlas, out->catalogue, name ? name : text);
    free(name);
    if (status) {
        return print_status(status);
    }
    if (key && asprintf(&out->owned, "%s%s", out->atlas->path, key) < 0) {
        out->owned = NULL;
        return print_no_memory();
    }
    out->path = key ? out->owned : out->atlas->path;
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

/* Takes "array=NAME" or "range=A:B". */
static bool read_map_key(conus_context_map_options *out, char *key)
{
    char *high = strchr(key, ':');
    if (strcmp(key, "array=") != 0 && take_text(&out->array, key, "array=")) {
        return true;
    }
    if (strncmp(key, "range=", 6) == 0 && high && out->range[0] == 0 && out->range[1] == 0) {
        *high = '\0';
        bool is_fine = number_parse(key + 6, &out->range[0]) && number_parse(high + 1, &out->range[1]) &&
                       out->range[0] < out->range[1];
        return is_fine || refuse("--map: range=%s:%s are not two numbers, the second larger", key + 6, high + 1);
    }
    return refuse("--map: \"%s\" is none of array=NAME and range=A:B, each at most once", key);
}

/* Cuts keys off the end as long as there are some, since a file's name may have commas as well. */
static int load_map(conus_atlas *atlas, const struct context_choice *choice, const struct atlas_settings *settings)
{
    conus_context_map_options options = {.opacity = choice->opacity, .max_memory = settings->max_memory};
    char *text = choice->map ? strdup(choice->map) : NULL;
    int code = text || !choice->map ? EXIT_DONE : print_no_memory();
    for (char *comma; text && !code && (comma = strrchr(text, ',')) && strchr(comma, '=');) {
        *comma = '\0';
        code = read_map_key(&options, comma + 1) ? EXIT_DONE : EXIT_USAGE;
    }
    if (text && !code && !options.array) {
        code = print_usage_error("--map: %s: which array? FILE,array=NAME", text);
    }
    conus_status status = text && !code ? conus_atlas_set_context_map(atlas, text, &options) : CONUS_OK;
    free(text);
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
    return code ? code : load_map(atlas, choice, settings);
}
