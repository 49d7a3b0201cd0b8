/* SPDX-License-Identifier: BSD-3-Clause */
/* The options of files of poses, and the check that poses and atlas share a space. */
#include "settings/settings.h"

#include "base/path.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "sources/names.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In the order of conus_axis. */
static const char *const axes[] = {"format", "+x", "-x", "+y", "-y", "+z", "-z", NULL};

const struct option pose_file_options[] = {
    {OPTION_VALUED("poses-format", struct pose_file_settings, format, "FORMAT"),
     .help = "format of the file of poses; auto detects it from the content:", .choice_at = conus_pose_format_name,
     .needs = "pose|poses|camera|from"},
    {OPTION_VALUED("axis", struct pose_file_settings, axis, "AXIS"),
     .help = "axis of the device, in the file's frame, along which it points; each format has its own, tables and "
             "matrices -z:",
     .choices = axes, .needs = "pose|poses|camera"},
    {OPTION_NAMED("along-shafts", struct pose_file_settings, along_shafts),
     .help = "contacts of electrodes (BIDS) point along their shafts, each to the next", .needs = "pose|poses|camera"},
    {OPTION_NAMED("any-space", struct pose_file_settings, any_space),
     .help = "accept positions even if the file names another space than the atlas, or the scalp is of another head",
     .needs = "pose|poses|camera|from|scalp"},
    {0},
};

const struct option keep_options[] = {
    {OPTION_VALUED("keep", struct keep_settings, columns, "COLUMN,..."),
     .help =
         "give the rows of the answer these columns of the table of poses, by their names in its header, as they are",
     .words = "group, subject, condition, copy", .role = OPTION_ASKS, .needs = "pose|poses"},
    {0},
};

int keep_settings_names(struct kept_names *out, const struct keep_settings *settings)
{
    *out = (struct kept_names){0};
    if (!settings->columns) {
        return EXIT_DONE;
    }
    if (strlen(settings->columns) >= sizeof out->text) {
        return print_usage_error("--keep: the names are longer than %d bytes", KEPT_SIZE - 1);
    }
    snprintf(out->text, sizeof out->text, "%s", settings->columns);
    for (char *name = out->text, *next; name; name = next) {
        next = strchr(name, ',');
        if (next) {
            *next++ = '\0';
        }
        if (!*name || out->count == KEPT_COLUMNS) {
            return print_usage_error("--keep: %s", *name ? "more than 64 columns"
                                                         : "a name is empty: COLUMN,COLUMN is "
                                                           "wanted");
        }
        out->at[out->count++] = name;
    }
    return EXIT_DONE;
}

const struct option probe_settings_options[] = {
    {OPTION_VALUED("probe", struct probe_settings, path, "FILE"),
     .help = "instead of a cone, what is at each contact of a probe that ProbeInterface (.json), SpikeGLX (.ap.meta, "
             ".imro) or Open Ephys (settings.xml) describes, and within --radius MM (default 0.000001) of it: the tip "
             "is where the pose is, or at the far end of --range, and the shank "
             "points along the axis; several poses are insertions of one probe",
     .words = "ProbeInterface, Neuropixels, SpikeGLX, Open Ephys, electrodes, contacts",
     .excludes = "point,angle,aperture-diameter,segments,clearance,image,mask,streamlines-out,connectivity",
     OPTION_READING(PROBE)},
    {OPTION_MM("probe-tip", struct probe_settings, tip),
     .help = "distance from the tip to the lowest contact, in place of the contour in the probe's file; of a recording "
             "to the lowest row that the probe has",
     OPTION_ABOVE_TO(0, 1000), .needs = "probe"},
    {OPTION_DEGREES("probe-roll", struct probe_settings, roll),
     .help = "turn the probe about its shank, the device's +y towards its +x, as conus plan --roll does; at 0 the "
             "probe's x axis is the device's +x",
     OPTION_FROM_TO(-360, 360), .needs = "probe"},
    {0},
};

/* The longest edge of the box around the atlas's objects, mm; 0 while there is none. Of MNI's brain, which is 181 mm
 * long, at least nearly that, also where the atlas has parts of it alone. */
static double longest_edge(const conus_atlas *atlas)
{
    static const double LEAST = 170;
    double low[3];
    double high[3];
    double longest = 0;
    const bool has_box = atlas && !conus_atlas_bounds(low, high, atlas);
    for (int a = 0; a < 3 && has_box; a++) {
        longest = high[a] - low[a] > longest ? high[a] - low[a] : longest;
    }
    const conus_brain brain = has_box ? conus_atlas_brain(atlas).brain : CONUS_BRAIN_UNKNOWN;
    bool is_of_mni = brain == CONUS_BRAIN_MNI152 || brain == CONUS_BRAIN_COLIN27;
    return is_of_mni && longest < LEAST ? LEAST : longest;
}

conus_pose_options pose_settings_options(const struct pose_file_settings *settings, const struct aim_settings *aim,
                                         const struct engine_settings *engine, const conus_frame *frame,
                                         const conus_atlas *atlas, uint64_t max_memory)
{
    const struct depth_range range = aim ? settings_range(aim, engine) : (struct depth_range){0};
    return (conus_pose_options){.frame = frame,
                                .to_target = range.to_target,
                                .near = range.ends[0],
                                .beyond = range.beyond,
                                .aperture = aim ? aim->aperture : 0,
                                .inward = aim && aim->inward,
                                .longest = longest_edge(atlas),
                                .any_space = settings->any_space,
                                .atlas = atlas,
                                .find_place = conus_place_find,
                                .of_mni305 = atlas && conus_atlas_brain(atlas).brain == CONUS_BRAIN_MNI305,
                                .axis = (conus_axis)settings->axis,
                                .format = conus_pose_format_name(settings->format),
                                .along_shafts = settings->along_shafts,
                                .max_memory = max_memory};
}

void pose_settings_text(char out[128], const struct pose_file_settings *settings, const struct aim_settings *aim,
                        const struct engine_settings *engine)
{
    const struct depth_range range = settings_range(aim, engine);
    char target[96] = "";
    if (range.to_target) {
        snprintf(target, sizeof target, " target %.17g %.17g %.17g", range.ends[0], range.beyond, aim->aperture);
    }
    snprintf(out, 128, "%s %s%s%s%s%s", conus_pose_format_name(settings->format), axes[settings->axis],
             settings->along_shafts ? " along-shafts" : "", aim->inward ? " inward" : "",
             settings->any_space ? " any-space" : "", target);
}

const char *pose_settings_file_name(const char *path)
{
    return poses_are_stdin(path) ? "standard input" : path;
}

/* Whether it is the name of an installed atlas, or a file that only an atlas can be. */
static bool is_atlas(const char *path)
{
    const size_t length = strlen(path);
    if (ending_length(path, length, ROLES_ATLAS) > ending_length(path, length, ROLE_POSES | ROLE_TRACTS)) {
        return true;
    }
    conus_catalogue *catalogue = NULL;
    const conus_installed *found = NULL;
    bool is_name = !output_is_stdout(path) && !conus_atlas_is_path(path) && !conus_catalogue_create(&catalogue, NULL) &&
                   !conus_catalogue_find(&found, catalogue, path);
    conus_catalogue_destroy(catalogue);
    return is_name;
}

int pose_settings_check_file(const char *path, const char *option, const struct arguments *arguments)
{
    if (!path || !arguments->operand_count || !is_atlas(path)) {
        return EXIT_DONE;
    }
    const char *first = arguments->operands[0];
    return is_atlas(first)
               ? print_data_error(
                     "%s: is an atlas by its name, not a file of poses; a table of points is called .csv or .tsv", path)
               : print_data_error(
                     "%s: is an atlas by its name, not a file of poses; the atlas comes first: conus %s %s "
                     "--%s %s; a table of points is called .csv or .tsv",
                     path, arguments->command->name, path, option, first);
}

int pose_settings_print_error(conus_status status, const char *path, const char *option,
                              const struct arguments *arguments)
{
    int code = exit_code_of(status);
    char why[1024];
    snprintf(why, sizeof why, "%s", conus_message()); /* which the catalogue would replace */
    if (conus_path_is_tractogram(path)) {
        print_error_line("%s: is a tractogram, not a file of poses; --streamlines %s adds it to the atlas", path, path);
    } else if (!pose_settings_check_file(path, option, arguments)) {
        print_error_line("%s", why);
    }
    return code;
}

int pose_settings_check_electrodes(const char *format, const char *electrodes, const char *path)
{
    if (!format_is(format, "bids") || electrodes) {
        return EXIT_DONE;
    }
    return print_data_error("%s: --format bids adds to a table of electrodes, with the columns name, x, y and z",
                            pose_settings_file_name(path));
}

int probe_settings_load(conus_probe **out, const struct probe_settings *settings, uint64_t max_memory)
{
    const conus_probe_options options = {.tip = settings->tip, .max_memory = max_memory};
    return print_status(settings->path ? conus_probe_load(out, settings->path, &options) : CONUS_OK);
}

enum { IDS_COMPARED = 1 << 20, ID_SLOTS = 2 * IDS_COMPARED };

/* Ids that were seen, by their hashes: two ids with one hash only cost a column. */
struct ids {
    uint64_t *slots; /* [ID_SLOTS] 0 = free */
    size_t count;
    bool repeated;
};

/* False without memory. The hash is FNV-1a: the same on every machine, so that shards have the same columns. */
static bool ids_add(struct ids *ids, const char *id)
{
    uint64_t hash = 0xcbf29ce484222325;
    for (; *id; id++) {
        hash = (hash ^ (unsigned char)*id) * 0x100000001b3;
    }
    hash += hash == 0;
    size_t at = (size_t)(hash ^ hash >> 32) % ID_SLOTS;
    ids->slots = ids->slots ? ids->slots : calloc(ID_SLOTS, sizeof *ids->slots);
    if (!ids->slots) {
        return false;
    }
    while (ids->slots[at] && ids->slots[at] != hash) {
        at = (at + 1) % ID_SLOTS;
    }
    ids->repeated = ids->slots[at] || ++ids->count > IDS_COMPARED;
    ids->slots[at] = hash;
    return true;
}

int pose_settings_mark_list(conus_row_marks *out, const conus_pose_list *poses)
{
    struct ids ids = {0};
    bool whole = true;
    bool has_time = false;
    for (size_t i = 0; i < conus_pose_list_count(poses); i++) {
        const conus_pose_row *row = conus_pose_list_row(poses, i);
        has_time = has_time || (!row->error && !isnan(row->time_s));
        whole = whole && (ids.repeated || ids_add(&ids, row->id));
    }
    free(ids.slots);
    out->has_time = has_time;
    out->has_number = has_time || ids.repeated;
    return whole ? EXIT_DONE : print_no_memory();
}

/* Reads ids up to the first that repeats. */
static int find_repeated(bool *out, const char *path, const conus_pose_options *options)
{
    enum { BLOCK = 256 };
    struct ids ids = {0};
    conus_pose_row rows[BLOCK];
    conus_pose_stream *poses = NULL;
    bool whole = true;
    size_t count = 0;
    conus_status status = conus_pose_stream_open(&poses, path, options);
    do {
        status = status ? status : conus_pose_stream_read(rows, &count, poses, BLOCK);
        for (size_t i = 0; !status && i < count && whole && !ids.repeated; i++) {
            whole = ids_add(&ids, rows[i].id);
        }
    } while (!status && whole && count && !ids.repeated);
    conus_pose_stream_destroy(poses);
    free(ids.slots);
    *out = ids.repeated;
    return whole ? print_status(status) : print_no_memory();
}

int pose_settings_mark_stream(conus_row_marks *out, const conus_pose_stream *poses, const char *path, bool piped,
                              const conus_pose_options *options)
{
    out->has_time = conus_pose_stream_facts(poses).has_times;
    out->has_number = out->has_time || conus_pose_stream_may_repeat_ids(poses);
    return out->has_number && !out->has_time && !piped ? find_repeated(&out->has_number, path, options) : EXIT_DONE;
}

const char *pose_settings_row_error(const conus_pose_row *row)
{
    return row->error ? row->error : row->is_point ? POINT_HAS_NO_DIRECTION : NULL;
}

void pose_settings_say_none(const char *path, const struct common_settings *common)
{
    say_note(CONUS_SEVERITY_NOTE, common->quiet, "%s: no poses in it", pose_settings_file_name(path));
}

/* Poses of a list, or else a stream. */
struct pose_source {
    conus_pose_list *list;
    conus_pose_stream *stream;
};

static const char *note_at(const struct pose_source *from, size_t index)
{
    return from->list ? conus_pose_list_note(from->list, index) : conus_pose_stream_note(from->stream, index);
}

/* Says the notes from the first on; @p once: one about one atlas not again for the next. Returns how many there are. */
static size_t say_notes(const struct pose_source *from, const char *path, bool once, size_t first, bool quiet)
{
    const char *note;
    size_t i = first;
    for (; (note = note_at(from, i)); i++) {
        bool said = false;
        for (size_t k = 0; k < i && once && !said; k++) {
            said = strcmp(note_at(from, k), note) == 0;
        }
        if (!said) {
            say_note(from->list ? conus_pose_list_note_severity(from->list, i)
                                : conus_pose_stream_note_severity(from->stream, i),
                     quiet, "%s: %s", pose_settings_file_name(path), note);
        }
    }
    return i;
}

static int match(size_t *said, const struct pose_source *from, const char *path, const struct atlases *atlases,
                 const struct pose_file_settings *settings, const struct common_settings *common)
{
    for (size_t i = 0; i < atlases->count && !(settings && settings->any_space); i++) {
        const struct named_atlas *atlas = &atlases->items[i];
        if (from->list ? conus_pose_list_match(from->list, atlas->atlas)
                       : conus_pose_stream_match(from->stream, atlas->atlas)) {
            char name[ATLAS_PREFIX_SIZE];
            return print_data_error("%s: %s%s, or move the atlas there (--atlas-transform)%s",
                                    pose_settings_file_name(path), atlases_prefix(name, atlas), conus_message(),
                                    settings ? "; only if they are in the atlas's space, type --any-space" : "");
        }
    }
    *said = say_notes(from, path, atlases->count > 1, 0, common->quiet);
    return EXIT_DONE;
}

int pose_settings_match_list(conus_pose_list *poses, const char *path, const struct atlases *atlases,
                             const struct pose_file_settings *settings, const struct common_settings *common)
{
    return match(&(size_t){0}, &(struct pose_source){.list = poses}, path, atlases, settings, common);
}

int pose_settings_match_stream(size_t *said, conus_pose_stream *poses, const char *path, const struct atlases *atlases,
                               const struct pose_file_settings *settings, const struct common_settings *common)
{
    return match(said, &(struct pose_source){.stream = poses}, path, atlases, settings, common);
}

static void warn_of_gap(const conus_name_gap *gap, const char *what, const conus_pose_list *poses, const char *path,
                        const struct named_atlas *atlas)
{
    const conus_pose_row *row = gap->is_far ? conus_pose_list_row(poses, gap->farthest) : NULL;
    if (!row) {
        return;
    }
    say_warning("%s%s%s%s: %zu points are called as %s, and half of them lie %.0f mm or more from there (%.60s in line "
                "%zu: %.0f mm); are they in its space and unit, with its sides?",
                pose_settings_file_name(path), atlas->name ? " (" : "", atlas->name ? atlas->name : "",
                atlas->name ? ")" : "", gap->named, what, gap->median, row->id, row->line, gap->farthest_mm);
}

void pose_settings_warn_of_names(const conus_pose_list *poses, const char *path, const struct atlases *atlases)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < atlases->count && !status; i++) {
        conus_name_check found = {0};
        status = conus_places_check(&found, atlases->items[i].atlas, poses);
        warn_of_gap(&found.areas, "areas of the atlas", poses, path, &atlases->items[i]);
        warn_of_gap(&found.positions, "positions of a cap", poses, path, &atlases->items[i]);
    }
    print_status(status);
}

void pose_settings_say_late(conus_pose_stream *poses, const char *path, size_t said,
                            const struct common_settings *common)
{
    say_notes(&(struct pose_source){.stream = poses}, path, false, said, common->quiet);
}
