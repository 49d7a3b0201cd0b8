/* SPDX-License-Identifier: BSD-3-Clause */
/* The options of files of poses, and the check that poses and atlas share a space. */
#include "settings/pose_settings.h"

#include "base/path.h"
#include "conus/streamlines.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <stdio.h>
#include <string.h>

/* In the order of conus_axis. */
static const char *const axes[] = {"format", "+x", "-x", "+y", "-y", "+z", "-z", NULL};

const struct option pose_file_options[] = {
    {.name = "poses-format",
     OPTION_AT(struct pose_file_settings, format),
     .value = "FORMAT",
     .help = "format of the file of poses; auto detects it from the content:",
     .choice_at = conus_pose_format_name,
     .needs = "pose|poses|camera|jobs|from"},
    {.name = "axis",
     OPTION_AT(struct pose_file_settings, axis),
     .value = "AXIS",
     .help = "axis of the device, in the file's frame, along which it points; each format has its own, tables and "
             "matrices -z:",
     .choices = axes,
     .needs = "pose|poses|camera|jobs"},
    {.name = "along-shafts",
     OPTION_AT(struct pose_file_settings, along_shafts),
     .help = "contacts of electrodes (BIDS) point along their shafts, each to the next",
     .needs = "pose|poses|camera|jobs"},
    {.name = "any-space",
     OPTION_AT(struct pose_file_settings, any_space),
     .help = "accept positions even if the file names another space than the atlas",
     .needs = "pose|poses|camera|jobs|from"},
    {0},
};

/* The longest edge of the box around the atlas's objects, mm; 0 while there is none. */
static double longest_edge(const conus_atlas *atlas)
{
    double low[3];
    double high[3];
    double longest = 0;
    for (int a = 0; a < 3 && atlas && !conus_atlas_bounds(low, high, atlas); a++) {
        longest = high[a] - low[a] > longest ? high[a] - low[a] : longest;
    }
    return longest;
}

conus_pose_options pose_settings_options(const struct pose_file_settings *settings, const conus_frame *frame,
                                         const conus_atlas *atlas, uint64_t max_memory)
{
    return (conus_pose_options){.frame = frame,
                                .longest = longest_edge(atlas),
                                .any_space = settings->any_space,
                                .axis = (conus_axis)settings->axis,
                                .format = (conus_pose_format)settings->format,
                                .along_shafts = settings->along_shafts,
                                .max_memory = max_memory};
}

void pose_settings_text(char out[64], const struct pose_file_settings *settings)
{
    snprintf(out, 64, "%s %s%s%s", conus_pose_format_name(settings->format), axes[settings->axis],
             settings->along_shafts ? " along-shafts" : "", settings->any_space ? " any-space" : "");
}

const char *pose_settings_file_name(const char *path)
{
    return output_is_stdout(path) ? "standard input" : path;
}

/* Whether it is the name of an installed atlas, or a file that only an atlas can be. */
static bool is_atlas(const char *path)
{
    static const char *const endings[] = {".nii", ".nii.gz", ".mgz", ".mgh",   ".nrrd",
                                          ".mha", ".HEAD",   ".gii", ".annot", ".atlas.json"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends_in(path, endings[i])) {
            return true;
        }
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
    return path && arguments->operand_count && is_atlas(path)
               ? print_data_error("%s: is an atlas, not a file of poses; the atlas comes first: conus %s %s --%s %s",
                                  path, arguments->command->name, path, option, arguments->operands[0])
               : EXIT_DONE;
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

int pose_settings_check_electrodes(conus_format format, const char *electrodes, const char *path)
{
    if (format != CONUS_FORMAT_BIDS || electrodes) {
        return EXIT_DONE;
    }
    return print_data_error("%s: --format bids adds to a table of electrodes, with the columns name, x, y and z",
                            pose_settings_file_name(path));
}

const char *pose_settings_row_error(const conus_pose_row *row)
{
    return row->error ? row->error : row->is_point ? POINT_HAS_NO_DIRECTION : NULL;
}

void pose_settings_say_none(const char *path, const struct common_settings *common)
{
    if (!common->quiet) {
        print_error_line("note: %s: no poses in it", pose_settings_file_name(path));
    }
}

static int print_match_error(const char *path, const struct named_atlas *atlas, bool has_any_space)
{
    return print_data_error("%s: %s%s%s; --atlas-transform FILE brings the atlas to them%s",
                            pose_settings_file_name(path), atlas->name ? atlas->name : "", atlas->name ? ": " : "",
                            conus_message(), has_any_space ? ", --any-space takes them as they are" : "");
}

/* Notes of a list or stream. */
typedef const char *note_at(const void *poses, size_t index);

static const char *note_of_list(const void *poses, size_t index)
{
    return conus_pose_list_note(poses, index);
}

static const char *note_of_stream(const void *poses, size_t index)
{
    return conus_pose_stream_note(poses, index);
}

/* A note about one atlas is not said again for the next. */
static size_t say_notes(const void *poses, note_at *at, const char *path, bool once, size_t first)
{
    const char *note;
    size_t i = first;
    for (; (note = at(poses, i)); i++) {
        bool said = false;
        for (size_t k = 0; k < i && once && !said; k++) {
            said = strcmp(at(poses, k), note) == 0;
        }
        if (!said) {
            print_error_line("note: %s: %s", pose_settings_file_name(path), note);
        }
    }
    return i;
}

int pose_settings_match_list(conus_pose_list *poses, const char *path, const struct atlases *atlases,
                             const struct pose_file_settings *settings, const struct common_settings *common)
{
    for (size_t i = 0; i < atlases->count && !(settings && settings->any_space); i++) {
        if (conus_pose_list_match(poses, atlases->items[i].atlas)) {
            return print_match_error(path, &atlases->items[i], settings);
        }
    }
    if (!common->quiet) {
        say_notes(poses, note_of_list, path, atlases->count > 1, 0);
    }
    return EXIT_DONE;
}

void pose_settings_say_late(const conus_pose_stream *poses, const char *path, size_t said,
                            const struct common_settings *common)
{
    if (!common->quiet) {
        say_notes(poses, note_of_stream, path, false, said);
    }
}

int pose_settings_match_stream(size_t *said, conus_pose_stream *poses, const char *path, const struct atlases *atlases,
                               const struct pose_file_settings *settings, const struct common_settings *common)
{
    for (size_t i = 0; i < atlases->count && !settings->any_space; i++) {
        if (conus_pose_stream_match(poses, atlases->items[i].atlas)) {
            return print_match_error(path, &atlases->items[i], true);
        }
    }
    *said = common->quiet ? 0 : say_notes(poses, note_of_stream, path, atlases->count > 1, 0);
    return EXIT_DONE;
}
