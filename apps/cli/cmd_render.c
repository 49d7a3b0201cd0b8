/* SPDX-License-Identifier: BSD-3-Clause */
/* conus render: draws an atlas, with or without a cone, into a picture file. */
#include "cli/cmd_render.h"
#include "base/order.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cli/commands.h"
#include "conus/own.h"
#include "figures/figure.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
#include "options/progress.h"
#include "settings/settings.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Which rows: all, unless one of these is set. */
struct row_choice {
    uint32_t number; /* From 1; 0 = not given. */
    const char *id;  /* Every row of that name; NULL = not given. */
};

struct drawn_row {
    const conus_pose_row *row; /* Perhaps one with an error, which has no picture. */
    char *path;
};

struct drawn_rows {
    const char *file; /* Name of the file of poses, for messages. */
    struct drawn_row *items;
    size_t count;
};

enum {
    NAME_LIMIT = 200, /* bytes of a row's name in that of a file */
    LEGEND_ROWS = 12  /* of objects */
};

/* Opacity of areas that no probe passes, and of those that a beam passes on its way. */
static const double FAINT = 0.12, PASSED = 0.5;

/* Opening, degrees, of the cone that says in what other space a probe would pass something. */
static const double NARROW = 0.06;

static const char QUERY[] = "{query}";
static const char ROW[] = "{row}";

static bool begins(const char *text, const char *word)
{
    return strncmp(text, word, strlen(word)) == 0;
}

/* Whether every {word} in the name `pattern` is one that stands for a part of a row; prints an error if not. */
static bool render_pattern_check(const char *pattern)
{
    for (const char *at = strchr(pattern, '{'); at; at = strchr(at + 1, '{')) {
        if (!begins(at, QUERY) && !begins(at, ROW) && !begins(at, TURN_FRAME)) {
            const char *end = strchr(at, '}');
            int length = end ? (int)(end - at + 1) : (int)strlen(at);
            return refuse("--output: \"%.*s\" stands for nothing, allowed are %s, %s and " TURN_FRAME, length, at,
                          QUERY, ROW);
        }
    }
    return true;
}

/* Whether the pattern has any such word. */
static bool render_pattern_varies(const char *pattern)
{
    return strstr(pattern, QUERY) || strstr(pattern, ROW);
}

/* Slashes, characters that some systems do not allow in a name, and a first dot become "_". */
static void write_safe(FILE *out, const char *id)
{
    size_t length = strnlen(id, NAME_LIMIT);
    while (length && id[length] && ((unsigned char)id[length] & 0xC0) == 0x80) { /* no half of a character of UTF-8 */
        length--;
    }
    for (size_t i = 0; i < length; i++) {
        bool unsafe = (unsigned char)id[i] < ' ' || id[i] == '\x7f' || strchr("/\\:*?\"<>|", id[i]) ||
                      (i == 0 && (id[i] == '.' || id[i] == '-'));
        fputc(unsafe ? '_' : id[i], out);
    }
    if (!length) {
        fputc('_', out);
    }
}

/* The name of one picture; NULL without memory. */
static char *format_path(const char *pattern, size_t number, const char *id)
{
    struct system_text path;
    FILE *out = system_text_open(&path);
    while (out && *pattern) {
        if (begins(pattern, QUERY)) {
            write_safe(out, id);
            pattern += strlen(QUERY);
        } else if (begins(pattern, ROW)) {
            fprintf(out, "%zu", number);
            pattern += strlen(ROW);
        } else {
            fputc(*pattern++, out);
        }
    }
    return system_text_close(&path);
}

static int compare_paths(const void *a, const void *b)
{
    const struct drawn_row *one = a;
    const struct drawn_row *other = b;
    return strcmp(one->path ? one->path : "", other->path ? other->path : "");
}

static int check_clashes(const struct drawn_rows *rows)
{
    struct drawn_row *sorted = calloc(rows->count + 1, sizeof *sorted);
    int code = EXIT_DONE;
    if (!sorted) {
        return print_no_memory();
    }
    for (size_t i = 0; i < rows->count; i++) {
        sorted[i] = rows->items[i];
    }
    order_sort(sorted, rows->count, sizeof *sorted, compare_paths);
    for (size_t i = 1; i < rows->count && !code; i++) {
        const char *path = sorted[i].path;
        if (path && sorted[i - 1].path && strcmp(path, sorted[i - 1].path) == 0) {
            code = print_usage_error("%s: the poses in lines %zu and %zu would both be drawn into %s; %s in --output's "
                                     "name tells them apart",
                                     rows->file, sorted[i - 1].row->line, sorted[i].row->line, path, ROW);
        }
    }
    free(sorted);
    return code;
}

static const char *name_at(const void *list, size_t index)
{
    const conus_pose_row *row = conus_pose_list_row(list, index);
    return row ? row->id : NULL;
}

static int check_count(const struct drawn_rows *rows, const conus_pose_list *list, const struct row_choice *choice,
                       const char *pattern)
{
    if (!rows->count && choice->number) {
        return print_usage_error("--row %" PRIu32 ": %s has %zu poses", choice->number, rows->file,
                                 conus_pose_list_count(list));
    }
    if (!rows->count && choice->id) {
        const char *close = NULL; /* the name that ends with "/" and the id, as target/M1 does with M1 */
        for (size_t i = 0; !close && i < conus_pose_list_count(list); i++) {
            const char *name = conus_pose_list_row(list, i)->id;
            const char *slash = strrchr(name, '/');
            close = slash && strcmp(slash + 1, choice->id) == 0 ? name : NULL;
        }
        close = close ? close : closest_name(choice->id, name_at, list);
        return print_usage_error("--query-id: %s has no pose \"%s\"%s%s%s", rows->file, choice->id,
                                 close ? ", did you mean \"" : "", close ? close : "", close ? "\"?" : "");
    }
    if (rows->count == 1 || render_pattern_varies(pattern)) {
        return EXIT_DONE;
    }
    return print_usage_error("%s has %zu poses, a picture takes one%s", rows->file, rows->count,
                             rows->count ? ": --output needs {query} or {row} in its name, or --row N or --query-id "
                                           "NAME chooses one"
                                         : "");
}

/* Chooses rows of `list`, which must outlive `out`, and names their pictures by `pattern`: {query} is the row's
 * name without what a file's name must not have, {row} its number. No two pictures have one name, but where all are
 * drawn `together`. Returns the exit code
 * and prints an error unless it is 0; what `out` holds is the caller's to free in any case. */
static int render_rows_choose(struct drawn_rows *out, const conus_pose_list *list, const struct row_choice *choice,
                              const char *pattern, bool together)
{
    size_t count = conus_pose_list_count(list);
    out->count = 0;
    out->items = calloc(count + 1, sizeof *out->items);
    if (!out->items) {
        return print_no_memory();
    }
    for (size_t i = 0; i < count; i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i);
        if ((!choice->number || choice->number == i + 1) && (!choice->id || strcmp(choice->id, row->id) == 0)) {
            struct drawn_row *drawn = &out->items[out->count++];
            drawn->row = row;
            drawn->path = row->error ? NULL : format_path(pattern, i + 1, row->id);
            if (!drawn->path && !row->error) {
                return print_no_memory();
            }
        }
    }
    int code = together && out->count ? EXIT_DONE : check_count(out, list, choice, pattern);
    return code || together ? code : check_clashes(out);
}

struct translucent_settings {
    struct option_list opacity, pathways, listed;
};

/* The opacities and colours for one atlas. */
struct translucent {
    double *opacity; /* For conus_view; NULL = none. */
    double pale;
    bool no_pale;
    bool *listed;                     /* For conus_view; NULL = none. */
    conus_pathway_transfer *pathways; /* For the renderer; [pathway_count]. */
    size_t pathway_count;
};

static const struct option translucent_options[] = {
    {OPTION_VALUED("opacity", struct translucent_settings, opacity, "[AREA=]A"),
     .help =
         "opacity, 0 to 1, of the surface of an area, by name, abbreviation or label, with all below it in the area "
         "tree; without AREA of all that the cone does not hit; may be repeated"},
    {OPTION_VALUED("pathway-transfer", struct translucent_settings, pathways, "[PATHWAY=]NAME|FILE"),
     .help =
         "draw pathways, or this one, as haze, by colours and opacities of their values: own (their colour), a preset "
         "of --transfer or a file; may be repeated",
     OPTION_READING(COLOURS)},
    {OPTION_VALUED("legend-area", struct translucent_settings, listed, "NAME"),
     .help = "an area, by name, abbreviation or label, with all below it in the area tree, or a pathway or bundle: it "
             "stands out, and has a row in the legend beside what the cone hits; may be repeated",
     .excludes = "no-legend"},
    {0},
};

/* Splits `text` behind its last "=": the name is allocated, NULL where there is none. False without memory. */
static bool split_value(char **name, const char **value, const char *text)
{
    const char *equals = strrchr(text, '=');
    *value = equals ? equals + 1 : text;
    *name = equals ? text_copy(text, (size_t)(equals - text)) : NULL;
    return !equals || *name;
}

static bool parse_opacity(double *out, const char *text)
{
    char *end = NULL;
    *out = strtod(text, &end);
    return end != text && *end == '\0' && *out >= 0 && *out <= 1;
}

/* Whether every opacity is one; prints an error if not. */
static bool translucent_check(const struct translucent_settings *settings)
{
    for (size_t i = 0; i < settings->opacity.count; i++) {
        const char *text = settings->opacity.items[i];
        const char *equals = strrchr(text, '=');
        double opacity;
        if (!parse_opacity(&opacity, equals ? equals + 1 : text)) {
            return refuse("--opacity: \"%s\"; wanted is AREA=A or A, A from 0 to 1", text);
        }
    }
    return true;
}

/* Whether it is `ancestor`, or below it in the area tree. */
static bool is_below(const conus_atlas *atlas, uint32_t number, uint32_t ancestor)
{
    while (number && number != ancestor) {
        number = conus_atlas_object(atlas, number)->parent;
    }
    return number == ancestor;
}

static int set_opacity(struct translucent *out, const conus_atlas *atlas, const char *name, double opacity)
{
    uint32_t found = 0;
    if (conus_atlas_find(&found, atlas, name)) {
        return print_usage_error("--opacity: %s", conus_message());
    }
    for (uint32_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        out->opacity[number] = is_below(atlas, number, found) ? opacity : out->opacity[number];
    }
    return EXIT_DONE;
}

static int find_listed(struct translucent *out, const conus_atlas *atlas, const struct option_list *texts)
{
    size_t count = conus_atlas_object_count(atlas);
    out->listed = texts->count ? calloc(count + 1, sizeof *out->listed) : NULL;
    if (texts->count && !out->listed) {
        return print_no_memory();
    }
    for (size_t i = 0; i < texts->count; i++) {
        uint32_t found = 0;
        if (conus_atlas_find(&found, atlas, texts->items[i])) {
            return print_usage_error("--legend-area: %s", conus_message());
        }
        for (uint32_t number = 1; number <= count; number++) {
            out->listed[number] = out->listed[number] || is_below(atlas, number, found);
        }
    }
    return EXIT_DONE;
}

/* All NaN; NULL without memory. */
static double *make_opacities(const conus_atlas *atlas)
{
    size_t count = conus_atlas_object_count(atlas) + 1;
    double *opacity = calloc(count, sizeof *opacity);
    for (size_t n = 0; opacity && n < count; n++) {
        opacity[n] = NAN;
    }
    return opacity;
}

static int find_opacities(struct translucent *out, const conus_atlas *atlas, const struct option_list *texts)
{
    int code = EXIT_DONE;
    out->opacity = texts->count ? make_opacities(atlas) : NULL;
    for (size_t i = 0; i < texts->count && !code; i++) {
        char *name = NULL;
        const char *value = NULL;
        double opacity = 0;
        bool done = out->opacity && split_value(&name, &value, texts->items[i]) && parse_opacity(&opacity, value);
        code = !done ? print_no_memory() : name ? set_opacity(out, atlas, name, opacity) : EXIT_DONE;
        out->pale = name ? out->pale : opacity;
        out->no_pale = name ? out->no_pale : opacity == 0;
        free(name);
    }
    return code;
}

static int find_pathway(conus_pathway_transfer *out, const conus_atlas *atlas, const char *text)
{
    char *name = NULL;
    const char *value = NULL;
    if (!split_value(&name, &value, text)) {
        return print_no_memory();
    }
    int code = EXIT_DONE;
    if (name && conus_atlas_find(&out->pathway, atlas, name)) {
        code = print_usage_error("--pathway-transfer: %s", conus_message());
    } else if (name && conus_atlas_object(atlas, out->pathway)->kind != CONUS_KIND_PATHWAY) {
        code = print_usage_error("--pathway-transfer: %s is no pathway", name);
    }
    out->transfer = value;
    free(name);
    return code;
}

/* Finds the areas and pathways. Returns the exit code and prints an error unless it is 0; what `out` holds is
 * the caller's to free in any case. */
static int translucent_find(struct translucent *out, const conus_atlas *atlas,
                            const struct translucent_settings *settings)
{
    const struct option_list *texts = &settings->pathways;
    *out = (struct translucent){0};
    int code = find_opacities(out, atlas, &settings->opacity);
    code = code ? code : find_listed(out, atlas, &settings->listed);
    out->pathways = code ? NULL : calloc(texts->count + 1, sizeof *out->pathways);
    if (!code && !out->pathways) {
        return print_no_memory();
    }
    for (size_t i = 0; i < texts->count && !code; i++) {
        code = find_pathway(&out->pathways[i], atlas, texts->items[i]);
        out->pathway_count++;
    }
    /* Refuses an opacity where no surface is drawn: it would have no effect. */
    for (size_t i = 0; i < out->pathway_count && !code; i++) {
        uint32_t pathway = out->pathways[i].pathway;
        if (pathway && out->opacity && !isnan(out->opacity[pathway])) {
            code = print_usage_error("--opacity has no effect on a pathway that --pathway-transfer draws as haze");
        }
    }
    return code;
}

struct render_settings {
    struct atlas_settings atlas;
    struct aim_settings aim;
    struct pose_file_settings file;
    struct engine_settings engine;
    struct common_settings common;
    const char *output;
    struct row_choice choice;
    struct figure_settings figure;
    struct translucent_settings translucent;
    uint32_t slices;
    const char *camera;
    const char *camera_origin, *camera_toward; /* places */
    double camera_up[3];
    double field_of_view; /* degrees */
    double frustum[4];
    struct context_choice context;
    const char *transfer;
    bool has_shell;
    struct cut_settings cuts;
    struct turn_settings turn;
    bool strips;
    const char *colour_by; /* a column of the file of poses */
    const char *caption;
};

static const struct option picture_options[] = {
    {OPTION_VALUED("output", struct render_settings, output, "FILE"), .letter = 'o',
     .help = ".png, .svg and .pdf with text as text, or .exr with linear light as float; of several poses one with "
             "{query} or {row} in its name is drawn for each, which stand for the pose's name and number; one without "
             "them shows all poses, and points, as balls",
     .required = true, .words = "save, export, figure, image", .common = true, .role = OPTION_WRITES_ANSWER,
     .endings = ".png .svg .pdf .exr", .holds = HOLDS_PICTURE},
    {OPTION_VALUED("caption", struct render_settings, caption, "FILE"),
     .help = "also write a text for the caption: what is shown, what each colour is with the atlas's own names and "
             "numbers, warnings, and the paragraph of conus cite",
     .words = "legend, methods, description", OPTION_WRITING(TEXT)},
    {OPTION_VALUED("camera", struct render_settings, camera, "FILE"),
     .help = "camera at the one pose in this file (docs/formats.md)", .words = "viewpoint", .excludes = "camera-origin",
     OPTION_READING(POSES)},
    {OPTION_VALUED("camera-origin", struct render_settings, camera_origin, PLACE_VALUE),
     .help = "or place of the camera", .otherwise = "as --view says", .role = OPTION_ASKS, .flags = OPTION_IS_PLACE,
     .needs = "camera-toward"},
    {OPTION_VALUED("camera-toward", struct render_settings, camera_toward, PLACE_VALUE),
     .help = "place at which the camera points", .role = OPTION_ASKS, .flags = OPTION_IS_PLACE,
     .needs = "camera-origin"},
    {OPTION_VALUED("camera-up", struct render_settings, camera_up, "X,Y,Z"), .help = "up direction of the camera",
     .needs = "camera-origin"},
    {OPTION_DEGREES("field-of-view", struct render_settings, field_of_view),
     .help = "angle from the lower to the upper edge, more than 0 and less than 180",
     .otherwise = "30; of a turntable as wide as what it shows", OPTION_BETWEEN(0, 180)},
    {OPTION_VALUED("frustum", struct render_settings, frustum, "L,R,B,T"),
     .help = "or edges of the camera's picture (left, right, bottom, top) at depth 1: off-axis, for a screen that "
             "the eye is not centred on",
     OPTION_FROM_TO(-1000, 1000), .excludes = "field-of-view"},
    {OPTION_VALUED("slices", struct render_settings, slices, "N"),
     .help = "planes across the view at which the volumes are sampled", .otherwise = "sqrt(2) times the longest edge",
     OPTION_FROM_TO(1, 65536)},
    {OPTION_VALUED("transfer", struct render_settings, transfer, "NAME|FILE"),
     .help = "colours and opacities of the context by its values: a preset or a file (docs/formats.md)",
     .needs = "context", OPTION_READING(COLOURS)},
    {OPTION_NAMED("shell", struct render_settings, has_shell),
     .help = "a glass shell around all areas and the head in the context volume, in place of this volume and of areas "
             "that are not hit, unless --transfer and --opacity say otherwise",
     .words = "glass brain, hull, outline, transparent"},
    {OPTION_VALUED("engine", struct render_settings, engine.engine, "NAME"),
     .help =
         "what draws in space: OpenGL, or rays on all processors, in the same look; also traces the cone's rays, with "
         "the same hits; auto is gl where there is a driver, else rays, and rays for hits:",
     .choices = settings_engines, .words = "GPU, CPU, software"},
    {0},
};

static const struct option row_options[] = {
    {OPTION_VALUED("poses", struct render_settings, aim.pose, "FILE"), .help = "the same as --pose",
     .role = OPTION_READS_POSES, .holds = HOLDS_POSES},
    {OPTION_VALUED("row", struct render_settings, choice.number, "N"), .help = "only the file's N-th pose, from 1",
     OPTION_FROM_TO(1, UINT32_MAX), .needs = "poses|pose", .excludes = "query-id"},
    {OPTION_VALUED("query-id", struct render_settings, choice.id, "NAME"),
     .help = "only the pose of that name (column query_id; of Brainsight target/M1, say)", .needs = "poses|pose"},
    {OPTION_NAMED("strips", struct render_settings, strips),
     .help = "all poses in one picture, as probes: a line for each, to the far end of --range, and beside the drawing "
             "its segments by depth, mm, with the names of areas; other areas are faint unless --opacity is given",
     .words = "probe, electrode, needle, segments, trajectory, neuropixels", .needs = "poses|pose|origin",
     .excludes = "angle,radius,cuts,legend,legend-rows,legend-area,no-legend"},
    {OPTION_VALUED("colour-by", struct render_settings, colour_by, "COLUMN"),
     .help = "balls of points have a colour for each text of this column of the table, with a row in the legend; more "
             "than six different numbers have a scale",
     .otherwise = "for each electrode, where names are those of contacts like LA1, LA2", .words = "color, group",
     .needs = "poses|pose", .excludes = "strips"},
    {0},
};

static const struct option_group groups[] = {
    {"Picture", picture_options, 0},
    {"", context_choice_options, offsetof(struct render_settings, context)},
    {"", map_options, offsetof(struct render_settings, context)},
    {"", figure_options, offsetof(struct render_settings, figure)},
    {"", turn_options, offsetof(struct render_settings, turn)},
    {"Flat cuts", cut_options, offsetof(struct render_settings, cuts)},
    {"Surfaces of areas and pathways", translucent_options, offsetof(struct render_settings, translucent)},
    {"Cone to draw", aim_options, offsetof(struct render_settings, aim)},
    {"", row_options, 0},
    {"", beam_options, offsetof(struct render_settings, aim)},
    {"", aperture_options, offsetof(struct render_settings, aim)},
    {"", pose_file_options, offsetof(struct render_settings, file)},
    {"", angle_options, offsetof(struct render_settings, aim)},
    {"", space_options, offsetof(struct render_settings, aim.space)},
    {"", shape_options, offsetof(struct render_settings, engine)},
    {"How rays are traced", ray_options, offsetof(struct render_settings, engine.numbers)},
    {"", pixel_options, offsetof(struct render_settings, engine)},
    {"", engine_options + 1, offsetof(struct render_settings, engine)}, /* --engine is above */
    {"Atlas", atlas_options, offsetof(struct render_settings, atlas)},
    {"", side_options, offsetof(struct render_settings, atlas)},
    {"", shown_options, offsetof(struct render_settings, atlas)},
    {"", quiet_options, offsetof(struct render_settings, common)},
    {0},
};

/** Pictures under way. */
struct picture {
    const struct render_settings *settings;
    const struct arguments *arguments;
    conus_atlas *atlas;
    conus_selector *selector;
    conus_renderer *renderer;
    conus_frame frame; /* of positions */
    conus_pose_check *aims;
    conus_pose_list *poses;
    struct drawn_rows rows; /* of them */
    struct translucent translucent;
    const conus_drawn_probe *probes; /* [probe_count] */
    size_t probe_count;
    const conus_drawn_point *points; /* [point_count] */
    size_t point_count;
    const char *title; /* the name of the pose that is drawn; NULL = it has none */
    bool has_points;   /* All rows are in one picture, as balls. */
    conus_pose camera;
    struct named_places places;
    conus_pose aim;    /* of --origin or --focus */
    double aim_target; /* how far its target is, mm; NaN = it has none */
    double cut_at[3];  /* of --at, world, else where points are */
    bool has_camera;
    bool has_cut_at;
    bool failed; /* Some poses have no picture. */
    struct caption caption;
};

static void picture_finish(struct picture *picture)
{
    conus_renderer_destroy(picture->renderer);
    conus_pose_check_destroy(picture->aims);
    conus_selector_destroy(picture->selector);
    conus_atlas_destroy(picture->atlas);
    free(picture->translucent.opacity);
    free(picture->translucent.listed);
    free(picture->translucent.pathways);
    for (size_t i = 0; i < picture->rows.count; i++) {
        free(picture->rows.items[i].path);
    }
    free(picture->rows.items);
    conus_pose_list_destroy(picture->poses);
    named_places_finish(&picture->places);
    caption_finish(&picture->caption);
}

static bool has_camera(const struct arguments *arguments)
{
    return option_given(arguments, "camera") || option_given(arguments, "camera-origin");
}

static bool has_option_pose(const struct arguments *arguments)
{
    return option_given(arguments, "origin") || option_given(arguments, "focus");
}

static bool has_file(const struct arguments *arguments)
{
    return option_given(arguments, "pose") || option_given(arguments, "poses");
}

/* Refuses options about the cone where no cone is drawn. */
static bool check_cone(const struct render_settings *settings, const struct arguments *arguments)
{
    static const char *const more[] = {"angle", "space", "range", "level", "radius", "unselected"};
    if (!settings_check_aim(arguments, false) || !settings_check_score(&settings->engine, false) ||
        !settings_check_shape(&settings->aim, &settings->engine, arguments)) {
        return false;
    }
    bool cone = has_option_pose(arguments) || has_file(arguments);
    if (settings->strips && option_with(arguments, OPTION_OF_RAYS)) {
        return refuse("--%s has no effect with --strips, which follow the axis",
                      option_with(arguments, OPTION_OF_RAYS)->name);
    }
    if (!cone && settings->atlas.hemispheres == CONUS_HEMISPHERES_MERGED) {
        return refuse("--hemispheres merged has no effect without a cone: --origin or --pose");
    }
    if (!cone && !render_cuts_need_space(&settings->cuts) && option_given(arguments, "engine")) {
        return refuse("--engine has no effect on cuts without a cone: --cuts 3d,... adds the view in space");
    }
    const struct option *of_rays = option_with(arguments, OPTION_OF_RAYS);
    const char *unused = of_rays ? of_rays->name : NULL;
    for (size_t i = 0; i < sizeof more / sizeof more[0] && !unused; i++) {
        bool has_places = has_camera(arguments) || render_cuts_have_places(&settings->cuts, arguments);
        bool used = has_places && strcmp(more[i], "space") == 0;
        unused = option_given(arguments, more[i]) && !used ? more[i] : NULL;
    }
    if (!cone && unused) {
        print_error_line("--%s has no effect without a cone: --origin or --pose", unused);
    }
    return cone || !unused;
}

static bool check_settings(const struct render_settings *settings, const struct arguments *arguments)
{
    if (!render_cuts_check(&settings->cuts, arguments) || !turn_check(&settings->turn, settings->output, arguments) ||
        !check_cone(settings, arguments)) {
        return false;
    }
    if (option_given(arguments, "slices") && settings->engine.sampling != CONUS_SAMPLING_SLICES &&
        !render_cuts_need_space(&settings->cuts)) {
        return refuse("--slices has no effect on cuts: --cuts 3d,... adds the view in space");
    }
    if (option_given(arguments, "frustum") && !has_camera(arguments)) {
        return refuse("--frustum has no effect without a camera: --camera-origin or --camera");
    }
    bool file = has_file(arguments);
    if ((!file || settings->strips) && render_pattern_varies(settings->output)) {
        return refuse("--output: {query} and {row} stand for poses of a file%s",
                      file ? ", --strips draws all in one picture" : ", --poses FILE");
    }
    if (settings->caption && render_pattern_varies(settings->output)) {
        return refuse("--caption: one file is for one picture, and {query} or {row} in --output's name make several");
    }
    if ((file && !render_pattern_check(settings->output)) || !figure_check(&settings->figure) ||
        !translucent_check(&settings->translucent)) {
        return false;
    }
    if (settings->transfer && !context_choice_has_volume(&settings->context)) {
        return refuse("--transfer has no effect: %s is a surface (--context-opacity)",
                      settings->context.files.items[0]);
    }
    return space_settings_check(arguments, &settings->aim.space);
}

static int load_poses(conus_pose_list **out, const struct picture *picture, const char *path)
{
    const struct render_settings *settings = picture->settings;
    conus_pose_options options =
        pose_settings_options(&settings->file, path == settings->aim.pose ? &settings->aim : NULL, &settings->engine,
                              &picture->frame, picture->atlas, settings->atlas.max_memory);
    options.keep = &settings->colour_by;
    options.keep_count = settings->colour_by && path == settings->aim.pose;
    conus_status status = conus_pose_list_load(out, path, &options);
    return status ? pose_settings_print_error(status, path, "pose", picture->arguments) : EXIT_DONE;
}

static int match_poses(const struct picture *picture, conus_pose_list *poses, const char *path)
{
    struct named_atlas atlas = {.atlas = picture->atlas};
    const struct render_settings *settings = picture->settings;
    return pose_settings_match_list(poses, path, &(struct atlases){.items = &atlas, .count = 1}, &settings->file,
                                    &settings->common);
}

/* The file's one pose. */
static int load_camera(struct picture *picture)
{
    const char *path = picture->settings->camera;
    conus_pose_list *list = NULL;
    int code = load_poses(&list, picture, path);
    code = code ? code : match_poses(picture, list, path);
    const conus_pose_row *row = conus_pose_list_row(list, 0);
    if (!code && conus_pose_list_count(list) != 1) {
        code = print_usage_error("%s has %zu poses, a camera takes one", path, conus_pose_list_count(list));
    } else if (!code && pose_settings_row_error(row)) {
        code = print_data_error("%s:%zu: %s", path, row->line, pose_settings_row_error(row));
    } else if (!code) {
        picture->camera = row->pose;
        conus_frame_turn_pose(&picture->camera, &(conus_frame){.space = CONUS_SPACE_RAS}, true); /* no mirror image */
    }
    conus_pose_list_destroy(list);
    return code;
}

static int find_camera(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    int code = EXIT_DONE;
    picture->has_camera = has_camera(picture->arguments);
    if (settings->camera) {
        code = load_camera(picture);
    } else if (picture->has_camera) {
        code = settings_pose_toward(&picture->camera, NULL, &picture->places,
                                    (const char *const[]){"camera-origin", "camera-toward"},
                                    (const char *const[]){settings->camera_origin, settings->camera_toward},
                                    option_given(picture->arguments, "camera-up") ? settings->camera_up : NULL);
    }
    return code;
}

/* Refuses options about cones where one picture shows all rows as balls, and about balls where each has a cone. */
static int check_points(const struct picture *picture)
{
    static const char *const of_cones[] = {"angle", "level", "aperture-diameter"};
    const struct arguments *arguments = picture->arguments;
    const struct option *of_rays = option_with(arguments, OPTION_OF_RAYS);
    const char *unused = of_rays ? of_rays->name : NULL;
    for (size_t i = 0; i < sizeof of_cones / sizeof *of_cones && !unused; i++) {
        unused = option_given(arguments, of_cones[i]) ? of_cones[i] : NULL;
    }
    if (picture->has_points && unused) {
        return print_usage_error("--%s has no effect: a picture of several poses, or of points, shows them as balls; "
                                 "{query} or {row} in --output's name draws a cone for each pose",
                                 unused);
    }
    return picture->has_points || !picture->settings->colour_by
               ? EXIT_DONE
               : print_usage_error("--colour-by has no effect on the cone of one pose: it is for several poses, or for "
                                   "points, in one picture");
}

static int find_rows(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    const char *path = settings->aim.pose;
    if (!path) {
        return EXIT_DONE;
    }
    const struct drawn_rows *rows = &picture->rows;
    picture->rows.file = pose_settings_file_name(path);
    const bool is_one = !render_pattern_varies(settings->output);
    int code = load_poses(&picture->poses, picture, path);
    code =
        code ? code : render_rows_choose(&picture->rows, picture->poses, &settings->choice, settings->output, is_one);
    if (code || settings->strips) {
        return code;
    }
    picture->has_points = is_one && (rows->count > 1 || (!rows->items[0].row->error && rows->items[0].row->is_point));
    code = check_points(picture);
    if (code || picture->has_points) {
        return code;
    }
    bool have_own = false;
    bool has_angle = settings->aim.angle != 0 || option_restated(picture->arguments, "angle");
    for (size_t i = 0; i < rows->count && has_angle; i++) { /* which is of poses without their own */
        const conus_pose_row *row = rows->items[i].row;
        have_own = have_own || !row->error;
        if (!row->error && row->angle == 0) {
            return EXIT_DONE;
        }
    }
    return have_own ? print_usage_error("--angle has no effect: %s pose in %s has its own",
                                        rows->count == 1 ? "the" : "every", rows->file)
                    : EXIT_DONE;
}

static int check_outputs(const struct picture *picture)
{
    size_t count = picture->poses ? picture->rows.count : 1;
    conus_inputs_add(picture->settings->transfer); /* read with the renderer */
    for (size_t i = 0; i < count; i++) {
        const char *output = picture->poses ? picture->rows.items[i].path : picture->settings->output;
        if (!output_spares_inputs("--output", output)) {
            return EXIT_USAGE;
        }
    }
    return output_spares_inputs("--caption", picture->settings->caption) ? EXIT_DONE : EXIT_USAGE;
}

/* Whether the pose is of a beam, which goes through the head: other areas would hide it. */
static bool is_beam(const struct picture *picture)
{
    return picture->settings->aim.aperture > 0;
}

static bool has_shell(const struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    const bool is_chosen = settings->transfer || settings->translucent.opacity.count ||
                           settings->translucent.pathways.count || option_given(picture->arguments, "context-opacity");
    return settings->has_shell || (is_beam(picture) && !is_chosen);
}

/* Draws no area around which the shell is unless it is hit, but pathways, which somebody added. */
static int leave_areas_out(struct translucent *out, const conus_atlas *atlas)
{
    if (out->no_pale || out->pale > 0) { /* as asked */
        return EXIT_DONE;
    }
    out->no_pale = true;
    out->opacity = out->opacity ? out->opacity : make_opacities(atlas);
    if (!out->opacity) {
        return print_no_memory();
    }
    for (uint32_t n = 1; n <= conus_atlas_object_count(atlas); n++) {
        bool is_haze = false;
        for (size_t i = 0; i < out->pathway_count; i++) {
            is_haze = is_haze || !out->pathways[i].pathway || out->pathways[i].pathway == n;
        }
        bool is_pathway = conus_atlas_object(atlas, n)->kind == CONUS_KIND_PATHWAY;
        out->opacity[n] = is_pathway && !is_haze && isnan(out->opacity[n]) ? 1 : out->opacity[n];
    }
    return EXIT_DONE;
}

static int load_atlas(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    int code = atlas_input_load(&picture->atlas, picture->arguments->operands[0], &settings->atlas);
    code = code ? code : context_choice_load(picture->atlas, &settings->context, &settings->atlas);
    code = code ? code : translucent_find(&picture->translucent, picture->atlas, &settings->translucent);
    if (!code && has_shell(picture)) {
        conus_status status = conus_atlas_add_shell(picture->atlas, 0);
        bool has_none = status == CONUS_ERROR_ARGUMENT && !settings->has_shell; /* surfaces, which nobody asked about */
        code = has_none ? EXIT_DONE
               : status ? print_status(status)
                        : leave_areas_out(&picture->translucent, picture->atlas);
    }
    return code;
}

static conus_status make_selector(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    struct engine_settings engine = settings->engine;
    engine.numbers.slices = engine.sampling == CONUS_SAMPLING_SLICES ? settings->slices : 0;
    const conus_selector_options options = settings_engine(&engine, &settings->aim, &settings->common);
    conus_status status = conus_selector_create(&picture->selector, picture->atlas, &options);
    return status ? status : conus_pose_check_create(&picture->aims, picture->selector);
}

/* Cuts need none. */
static conus_status make_renderer(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    if (!render_cuts_need_space(&settings->cuts)) {
        return CONUS_OK;
    }
    const bool hides_volume = has_shell(picture) && !settings->transfer;
    const conus_renderer_options options = {.transfer = hides_volume ? "none" : settings->transfer,
                                            .max_memory = settings->atlas.max_memory,
                                            .pathways = picture->translucent.pathways,
                                            .pathway_count = picture->translucent.pathway_count,
                                            .streamline_colour = settings->figure.streamline_colour,
                                            .log = settings->common.verbose ? log_line : NULL,
                                            .engine = (conus_engine)settings->engine.engine};
    conus_status status = conus_renderer_create(&picture->renderer, picture->atlas, &options);
    if (!status && settings->common.verbose) {
        print_error_line("drawn by %s", conus_renderer_device(picture->renderer));
    }
    return status;
}

/* Draws the picture in space, or of the cuts. */
static conus_status draw_view(conus_image **out, const struct picture *picture, const conus_view *view,
                              const conus_cut_plane *planes, size_t count)
{
    const struct cut_settings *cuts = &picture->settings->cuts;
    if (!cuts->cuts) {
        return conus_render(out, picture->renderer, view);
    }
    conus_cut_view look = render_cuts_look(cuts, picture->arguments);
    look.pathways = picture->translucent.pathways;
    look.pathway_count = picture->translucent.pathway_count;
    return conus_render_cuts(out, picture->atlas, planes, count, &look, picture->renderer, view);
}

/* What part of the width a legend, or strips, leave at least. */
static double room_of(const struct picture *picture, const conus_view *view)
{
    const bool has_colours = picture->settings->figure.streamline_colour || picture->translucent.pathway_count;
    const bool is_auto = view->legend == CONUS_LEGEND_AUTO && (has_colours || view->legend_rows);
    return view->legend == CONUS_LEGEND_RIGHT || is_auto || view->probe_count ? 0.5 : 1;
}

/* Draws the frames of a turntable, or the one picture that there is without. */
static int draw_frames(struct picture *picture, const conus_view *view, const conus_cut_plane *planes, size_t count,
                       const char *path)
{
    const struct turn_settings *turn = &picture->settings->turn;
    double field_of_view = view->field_of_view;
    int code = EXIT_DONE;
    if (turn->frames && !picture->has_camera && field_of_view == 0) {
        code = print_status(turn_fit(&field_of_view, picture->atlas, picture->renderer, view, room_of(picture, view)));
    }
    for (uint32_t frame = 0; (frame == 0 || frame < turn->frames) && !code; frame++) {
        conus_image *image = NULL;
        conus_pose camera;
        conus_view of_frame = *view;
        conus_status status = CONUS_OK;
        char *name = turn->frames ? turn_path(path, turn, frame) : strdup(path);
        if (!name) {
            return print_no_memory();
        }
        if (turn->frames) {
            status =
                turn_camera(&camera, turn, frame, picture->has_camera ? &picture->camera : NULL, picture->atlas, view);
            of_frame.camera = &camera;
            of_frame.side = CONUS_SIDE_OF_CONE;
            of_frame.field_of_view = field_of_view;
        }
        status = status ? status : draw_view(&image, picture, &of_frame, planes, count);
        status = status ? status : conus_image_write(image, name);
        code = print_status(status);
        code = code || !picture->settings->caption ? code : caption_take(&picture->caption, image);
        conus_image_destroy(image);
        free(name);
    }
    return code;
}

/* Opacities with those of areas that the beam only passes, which are glass, so that it is seen among them; NULL without
 * memory. To be freed. */
static double *beam_opacities(const struct picture *picture, const conus_selection *selection)
{
    double *opacity = make_opacities(picture->atlas);
    if (opacity) {
        memcpy(opacity, picture->translucent.opacity, (conus_atlas_object_count(picture->atlas) + 1) * sizeof *opacity);
    }
    for (size_t i = 0; opacity && i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        bool is_passed = result->object && !result->pixels && isnan(opacity[result->object]);
        opacity[result->object] = is_passed ? PASSED : opacity[result->object];
    }
    return opacity;
}

/* What of points is said: how many have a line to what their poses point at, how many poses point at nothing, and how
 * many others lie outside of the box around all that the atlas shows. */
struct point_counts {
    size_t lines, hollow, outside;
};

static struct point_counts count_points(const struct picture *picture, const conus_view *view)
{
    double low[3], high[3];
    struct point_counts counts = {0};
    const bool has_box = !conus_atlas_bounds(low, high, picture->atlas);
    for (size_t i = 0; i < view->point_count; i++) {
        const conus_drawn_point *point = &view->points[i];
        const bool has_line = !isnan(point->end[0]);
        bool is_out = false;
        for (int a = 0; a < 3 && has_box; a++) {
            is_out = is_out || point->at[a] < low[a] || point->at[a] > high[a];
        }
        counts.lines += has_line;
        counts.hollow += point->hollow;
        counts.outside += is_out && !has_line && !point->hollow;
    }
    return counts;
}

/* Of a file's rows, or one place of the options, what is drawn, what of it is far off, and what is not drawn. */
static void describe_rows(FILE *out, const struct picture *picture, const conus_view *view)
{
    const size_t drawn = view->point_count + view->probe_count;
    const struct point_counts counts = count_points(picture, view);
    const char *file = picture->rows.file;
    fprintf(out, ", with %zu %s%s%s", drawn,
            view->probe_count               ? "probes"
            : counts.lines || counts.hollow ? "poses"
                                            : "points",
            file ? " of " : "", file ? path_name(file) : "");
    if (counts.outside) {
        fprintf(out, ", %zu of them outside of the atlas", counts.outside);
    }
    if (counts.hollow) {
        fprintf(out, ", %zu of them hollow, which point at nothing", counts.hollow);
    }
    if (picture->rows.count > drawn) {
        fprintf(out, "; %zu of %zu rows could not be drawn", picture->rows.count - drawn, picture->rows.count);
    }
}

/* What the picture shows, in a sentence; NULL without memory. */
static char *describe_picture(const struct picture *picture, const conus_view *view)
{
    static const char *const from[] = {"the cone's side", "the left", "the right",       "the front",      "the back",
                                       "above",           "below",    "beside the cone", "across the beam"};
    const struct render_settings *settings = picture->settings;
    const char *atlas = picture->arguments->operands[0];
    const bool has_side = view->side || view->selection;
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (!out) {
        return system_text_close(&text);
    }
    fprintf(out, settings->cuts.cuts ? "Cuts of the atlas %s: %s" : "The atlas %s", path_name(atlas),
            settings->cuts.cuts ? settings->cuts.cuts : "");
    if (!settings->cuts.cuts && !view->camera && has_side) {
        fprintf(out, ", seen from %s", from[view->side]);
    }
    if (view->selection) {
        fprintf(out, ", with %s%s%s",
                view->is_beam                 ? "a beam"
                : settings->engine.radius > 0 ? "a cylinder along the axis of the device"
                                              : "a cone from the device",
                view->title ? " at " : "", view->title ? view->title : "");
    } else if (view->point_count || view->probe_count) {
        describe_rows(out, picture, view);
    }
    return system_text_close(&text);
}

/* Keeps what the caption says of a picture, before it is drawn. */
static int prepare_caption(struct picture *picture, const conus_view *view)
{
    if (!picture->settings->caption) {
        return EXIT_DONE;
    }
    picture->caption.shown = describe_picture(picture, view);
    return !picture->caption.shown ? print_no_memory()
           : view->selection
               ? caption_ask(&picture->caption, picture->selector, view->selection, &picture->frame, picture->arguments,
                             picture->settings->engine.radius > 0 ? "cylinder" : "cone")
               : EXIT_DONE;
}

/* Draws a picture, of a cone if there is one: `selection` is its selection at `pose`. */
static int draw_picture(struct picture *picture, const conus_selection *selection, const conus_pose *pose,
                        const char *path)
{
    const struct render_settings *settings = picture->settings;
    conus_cut_plane *planes = NULL;
    size_t count = 0;
    const double *f = settings->frustum;
    conus_view view = {.slices = settings->slices,
                       .field_of_view = settings->field_of_view,
                       .frustum = {f[0], f[1], f[2], f[3]},
                       .camera = picture->has_camera ? &picture->camera : NULL,
                       .selection = selection,
                       .opacity = picture->translucent.opacity,
                       .pale = picture->translucent.pale,
                       .no_pale = picture->translucent.no_pale,
                       .listed = picture->translucent.listed,
                       .probes = picture->probes,
                       .probe_count = picture->probe_count,
                       .points = picture->points,
                       .point_count = picture->point_count,
                       .group_title = settings->colour_by,
                       .title = picture->title,
                       .no_covered_context =
                           !settings->transfer && !option_given(picture->arguments, "context-opacity"),
                       .is_beam = is_beam(picture),
                       .frame = &picture->frame};
    figure_view(&view, &settings->figure);
    if (is_beam(picture) && !settings->figure.side && !view.camera) {
        view.side = CONUS_SIDE_ACROSS_CONE;
    }
    const bool has_glass = is_beam(picture) && view.opacity && !settings->translucent.opacity.count;
    double *glass = has_glass ? beam_opacities(picture, selection) : NULL;
    view.opacity = glass ? glass : view.opacity;
    if ((picture->probe_count || picture->point_count) && !settings->translucent.opacity.count) {
        view.pale = FAINT;
    }
    const bool has_own = settings->turn.frames && !option_given(picture->arguments, "legend"); /* each other rows */
    if (!view.legend_rows && view.legend != CONUS_LEGEND_NONE && !picture->probe_count && (selection || !has_own)) {
        view.legend_rows = LEGEND_ROWS; /* without a cone, too */
    }
    view.shapes = path_ends_in(path, ".svg") || path_ends_in(path, ".pdf");
    if (settings->cuts.cuts && !option_given(picture->arguments, "size") &&
        !option_given(picture->arguments, "height-mm")) {
        view.height = 0;
    }
    if (settings->turn.frames && (selection || picture->point_count) && !option_given(picture->arguments, "legend")) {
        view.legend = CONUS_LEGEND_BELOW; /* all frames are as large */
    }
    int code = settings->cuts.cuts
                   ? render_cuts_find(&planes, &count, &settings->cuts, picture->has_cut_at ? picture->cut_at : NULL,
                                      picture->atlas, &picture->frame, picture->selector, selection, pose,
                                      settings->engine.radius > 0)
                   : EXIT_DONE;
    code = code ? code : prepare_caption(picture, &view);
    code = code ? code : draw_frames(picture, &view, planes, count, path);
    free(planes);
    free(glass);
    return code;
}

/* Draws a cone; *fault where the pose itself is at fault, which is the caller's to say. */
static int draw_cone(struct picture *picture, const conus_pose *pose, double angle, const char *path, bool *fault)
{
    conus_selection *selection = NULL;
    conus_status status = conus_select(&selection, picture->selector, pose, angle);
    *fault = status == CONUS_ERROR_ARGUMENT;
    int code = !status ? draw_picture(picture, selection, pose, path) : *fault ? EXIT_DONE : print_status(status);
    conus_selection_destroy(selection);
    return code;
}

/* Gives the exit code where this is the only pose; of several, the others are drawn. */
static int refuse_row(struct picture *picture, const conus_pose_row *row, const char *why, int code)
{
    print_error_line("%s:%zu: %s", picture->rows.file, row->line, why);
    picture->failed = true;
    return picture->rows.count == 1 ? code : EXIT_DONE;
}

static int draw_row(struct picture *picture, const struct drawn_row *drawn)
{
    const struct render_settings *settings = picture->settings;
    const conus_pose_row *row = drawn->row;
    if (pose_settings_row_error(row)) {
        return refuse_row(picture, row, pose_settings_row_error(row), EXIT_DATA);
    }
    double angle = row->angle != 0 ? row->angle : settings_angle(&settings->aim, &settings->engine);
    picture->title = row->id[strspn(row->id, "0123456789")] ? row->id : NULL; /* not of one that is the row's number */
    bool fault = conus_selector_set_range(picture->selector, row->range) != CONUS_OK;
    int code = fault ? EXIT_DONE : draw_cone(picture, &row->pose, angle, drawn->path, &fault);
    if (fault) {
        return refuse_row(picture, row, conus_message(), EXIT_USAGE);
    }
    if (settings->aim.aperture == 0) { /* a beam begins inside */
        conus_pose_check_add(picture->aims, row->line, &row->pose, angle);
    }
    return code;
}

/* Notes the probe in `found`, and in picture->aims, if it passes nothing. */
static void note_probe(struct picture *picture, conus_pose_findings *found, const conus_table *segments,
                       const conus_pose_row *row)
{
    for (size_t i = 0; i < conus_table_rows(segments); i++) {
        if (conus_table_objects(segments)[i]) {
            return;
        }
    }
    conus_pose_check_add(picture->aims, row->line, &row->pose, NARROW);
    if (!found->away.count++) {
        found->away = (conus_pose_finding){.count = 1, .first = row->line, .pose = row->pose, .angle = NARROW};
    }
}

/* In one picture; those that cannot be drawn are named, and those that pass nothing noted. */
static int draw_probes(struct picture *picture, const struct drawn_row *rows, size_t row_count)
{
    conus_pose_findings found = {0};
    conus_drawn_probe *probes = calloc(row_count + 1, sizeof *probes);
    conus_table **segments = calloc(row_count + 1, sizeof(void *));
    size_t count = 0;
    int code = probes && segments ? EXIT_DONE : print_no_memory();
    for (size_t i = 0; probes && segments && i < row_count && !code; i++) {
        const conus_pose_row *row = rows[i].row;
        const char *error = pose_settings_row_error(row);
        conus_status status = error ? CONUS_ERROR_DATA : conus_selector_set_range(picture->selector, row->range);
        status = status ? status : conus_segments(&segments[count], picture->selector, &row->pose);
        if (status) {
            code = refuse_row(picture, row, error ? error : conus_message(), error ? EXIT_DATA : EXIT_USAGE);
        } else {
            probes[count] = (conus_drawn_probe){row->id, segments[count]};
            note_probe(picture, &found, segments[count++], row);
        }
    }
    picture->probes = probes;
    picture->probe_count = count;
    code = code || !count ? code : draw_picture(picture, NULL, NULL, picture->settings->output);
    picture->probes = NULL;
    for (size_t i = 0; i < count; i++) {
        conus_table_destroy(segments[i]);
    }
    free(segments);
    free(probes);
    if (!code && found.away.count) {
        const conus_pose_finding away = found.away;
        found = *conus_pose_check_found(picture->aims);
        found.away = away;
        found.poses = count;
        const struct aimed aimed = {found, picture->selector, picture->atlas, NULL, &picture->frame, true, 0};
        aim_notes_say(&aimed, 1, row_count > 1 ? picture->rows.file : NULL, &picture->settings->common);
    }
    return code;
}

/* Of sorted coordinates, the one that is near most others; of several that nearest to the middle of all. */
static double find_crowd(const double *sorted, size_t count)
{
    double middle = 0;
    double best = NAN;
    size_t most = 0;
    for (size_t i = 0; i < count; i++) {
        middle += sorted[i] / (double)count;
    }
    for (size_t i = 0, first = 0, end = 0; i < count; i++) {
        const double at = sorted[i];
        while (at - sorted[first] > CONUS_POINT_NEAR_CUT) {
            first++;
        }
        while (end < count && sorted[end] - at <= CONUS_POINT_NEAR_CUT) {
            end++;
        }
        const size_t others = end - first;
        if (others > most || (others == most && fabs(at - middle) < fabs(best - middle))) {
            most = others;
            best = at;
        }
    }
    return best;
}

/* Lets cuts go where most points are, if that is in the atlas. */
static int place_cuts(struct picture *picture, const conus_drawn_point *points, size_t count)
{
    double low[3], high[3];
    double *sorted = calloc(count + 1, sizeof *sorted);
    if (!sorted) {
        return print_no_memory();
    }
    picture->has_cut_at = !conus_atlas_bounds(low, high, picture->atlas);
    for (int a = 0; a < 3; a++) {
        for (size_t i = 0; i < count; i++) {
            sorted[i] = points[i].at[a];
        }
        order_sort(sorted, count, sizeof *sorted, compare_f64);
        const double at = picture->cut_at[a] = find_crowd(sorted, count);
        picture->has_cut_at = picture->has_cut_at && at > low[a] && at < high[a];
    }
    free(sorted);
    return EXIT_DONE;
}

/* Draws all rows in one picture; those that cannot be drawn are named. */
static int draw_points(struct picture *picture)
{
    const struct drawn_rows *rows = &picture->rows;
    conus_drawn_point *points = calloc(rows->count + 1, sizeof *points);
    size_t count = 0;
    size_t poses = 0; /* not only points */
    int code = points ? EXIT_DONE : print_no_memory();
    for (size_t i = 0; points && i < rows->count && !code; i++) {
        const conus_pose_row *row = rows->items[i].row;
        conus_status status =
            row->error ? CONUS_ERROR_DATA
                       : contacts_place(&points[count], row, picture->settings->engine.radius, picture->selector);
        if (status) {
            code = refuse_row(picture, row, row->error ? row->error : conus_message(), EXIT_DATA);
        } else {
            count++;
            poses += !row->is_point;
        }
    }
    if (!code && poses) {
        say_note(CONUS_SEVERITY_NOTE, picture->settings->common.quiet,
                 "%s: %zu poses in one picture, as balls with lines to their ends, or what their axes meet first; "
                 "{query} or {row} in "
                 "--output's name draws a cone for each",
                 rows->file, poses);
    }
    bool has_electrodes = false;
    if (!code && !picture->settings->colour_by && !contacts_group(&has_electrodes, points, count)) {
        code = print_no_memory();
    }
    if (!code && !picture->has_cut_at && picture->settings->cuts.cuts && count) {
        code = place_cuts(picture, points, count);
    }
    picture->points = points;
    picture->point_count = count;
    code = code || !count ? code : draw_picture(picture, NULL, NULL, picture->settings->output);
    picture->points = NULL;
    if (has_electrodes) {
        contacts_ungroup(points, count);
    }
    free(points);
    return code;
}

static int draw_rows(struct picture *picture)
{
    const struct drawn_rows *rows = &picture->rows;
    int code = EXIT_DONE;
    if (!rows->count) {
        pose_settings_say_none(picture->settings->aim.pose, &picture->settings->common);
    }
    if (picture->has_points) {
        return draw_points(picture);
    }
    if (picture->settings->strips) {
        return draw_probes(picture, rows->items, rows->count);
    }
    struct progress progress;
    progress_start(&progress, PROGRESS_AUTO, picture->settings->common.quiet, "pictures", rows->count);
    for (size_t i = 0; i < rows->count && !code; i++) {
        code = draw_row(picture, &rows->items[i]);
        progress_update(&progress, i + 1, 0);
    }
    progress_finish(&progress, 0, 0);
    return code;
}

static int draw_origin(struct picture *picture)
{
    const struct render_settings *settings = picture->settings;
    const conus_pose pose = picture->aim;
    conus_pose_row row = {.id = "", .pose = pose, .radius = NAN};
    double angle;
    int code = settings_pose_cone(&angle, row.range, picture->aim_target, &settings->aim, &settings->engine);
    if (code) {
        return code;
    }
    if (settings->strips) {
        return draw_probes(picture, &(struct drawn_row){.row = &row}, 1);
    }
    conus_status status = conus_selector_set_range(picture->selector, row.range);
    if (status) {
        return print_status(status);
    }
    bool fault = false;
    code = draw_cone(picture, &pose, angle, settings->output, &fault);
    if (fault) {
        return print_status(CONUS_ERROR_ARGUMENT);
    }
    if (settings->aim.aperture == 0) {
        conus_pose_check_add(picture->aims, 1, &pose, angle);
    }
    return code;
}

static int run_render(const void *given, const struct arguments *arguments)
{
    const struct render_settings *settings = given;
    if (!check_settings(settings, arguments)) {
        return EXIT_USAGE;
    }
    struct picture picture = {.settings = settings, .arguments = arguments};
    int code = load_atlas(&picture);
    struct named_atlas named = {.atlas = picture.atlas};
    code = code ? code
                : space_settings_frame(&picture.frame, &(struct atlases){.items = &named, .count = 1},
                                       &settings->aim.space, settings->common.quiet);
    code = code ? code : find_rows(&picture);
    picture.places = (struct named_places){.atlas = picture.atlas, .frame = &picture.frame};
    code = code ? code : find_camera(&picture);
    code = code || !has_option_pose(arguments)
               ? code
               : settings_pose(&picture.aim, &picture.aim_target, &picture.places, &settings->aim, arguments);
    picture.has_cut_at = settings->cuts.at;
    code = code || !settings->cuts.at
               ? code
               : named_places_find(picture.cut_at, &picture.places, "at", settings->cuts.at, NULL);
    if (!code && !settings->common.quiet) {
        named_places_say(&picture.places);
    }
    code = code || !picture.poses ? code : match_poses(&picture, picture.poses, settings->aim.pose);
    code = code ? code : figure_colour_atlas(picture.atlas, &settings->figure);
    code = code ? code : check_outputs(&picture);
    if (!code) {
        bool cone = picture.poses || has_option_pose(arguments);
        conus_status status = cone ? make_selector(&picture) : CONUS_OK;
        status = status ? status : make_renderer(&picture);
        code = status ? print_status(status) : cone ? EXIT_DONE : draw_picture(&picture, NULL, NULL, settings->output);
    }
    if (!code && picture.selector) {
        code = picture.poses ? draw_rows(&picture) : draw_origin(&picture);
    }
    if (!code && picture.selector && !settings->strips && !picture.has_points) {
        const struct aimed aimed = {
            *conus_pose_check_found(picture.aims), picture.selector, picture.atlas, NULL, &picture.frame, false, 0};
        aim_notes_say(&aimed, 1, picture.rows.count > 1 ? picture.rows.file : NULL, &settings->common);
    }
    if (!code) {
        atlas_notes_say(picture.atlas, &settings->common);
        code = !settings->caption || !picture.caption.shown
                   ? EXIT_DONE
                   : caption_write(&picture.caption, settings->caption, arguments->operands[0], picture.atlas);
        code = code || !picture.failed ? code : EXIT_DIFFERENT;
    }
    picture_finish(&picture);
    return code;
}

static void list_transfers(FILE *out)
{
    const char *preset;
    fputs("Presets of --transfer:", out);
    for (size_t i = 0; (preset = conus_transfer_preset(i)); i++) {
        fprintf(out, " %s", preset);
    }
    fputs("\n\n", out);
    help_scores(out);
}

const struct command cmd_render = {
    .name = "render",
    .summary = "draw the atlas, a cone in it and the cone's first hits",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "-o FILE",
    .description = "Draws areas, pathways and bundles, the context around them, and a cone with its axis, contacts\n"
                   "and a legend of its first hits, by OpenGL 4.5 or, without it, by rays on the processor.",
    .examples = "  conus render aal.nii.gz -o aal.png --context ch2bet.nii.gz\n"
                "  conus render aal.nii.gz -o cone.png --origin -90,20,20 --toward 0,-10,10 --angle 20\n"
                "  conus render aal.nii.gz --poses session.tsv -o 'fig-{query}.png'\n"
                "  conus render aal.nii.gz --pose contacts.csv --cuts 3d,axial,coronal,sagittal -o contacts.png\n"
                "  conus render aal.nii.gz --poses shanks.tsv --range 0,25 --strips -o shanks.png\n"
                "  conus render aal.nii.gz -o top.exr --camera-origin 0,0,500 --camera-toward 0,0,0\n",
    .groups = groups,
    .settings_size = sizeof(struct render_settings),
    .more_help = list_transfers,
    .run = run_render,
};
