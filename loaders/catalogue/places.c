/* SPDX-License-Identifier: BSD-3-Clause */
/* Where programs keep their atlases. A new place is a line of the table. */
#include "loaders/catalogue/catalogue.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/file_trace.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/text.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/** A rule begins with a variable, whose folders have ':' between them; with "(program)", the folder of a program in
 * $PATH; or with "(bg_config.conf)", the folder in BrainGlobe's settings. */
struct place {
    const char *source, *rule;
    struct folder_rule how;
};

enum { SETTINGS_LIMIT = 1 << 16 };

static const char *const segmentations[] = {"*_dseg.nii.gz", "*_dseg.nii", NULL};

static const struct place places[] = {
    {"own", "$CONUS_ATLAS_PATH", {.depth = 2}},
    {"mricron", "$XDG_DATA_HOME/mricron/templates", {0}},
    {"mricron", "$XDG_DATA_DIRS/mricron/templates", {0}},
    {"fsl", "$FSLDIR/data/atlases", {.depth = 1}},
    {"fsl", "$XDG_DATA_DIRS/fsl/data/atlases", {.depth = 1}},
    {"freesurfer", "$SUBJECTS_DIR", {.subjects = true}},
    {"freesurfer", "$FREESURFER_HOME/subjects", {.subjects = true}},
    {"brainglobe", "$HOME/.brainglobe", {.depth = 1}},
    {"brainglobe", "$HOME/.brainglobe/brainglobe-atlasapi/atlases", {.versions = true}},
    {"brainglobe", "(bg_config.conf)", {.depth = 1}},
    {"brainglobe", "(bg_config.conf)/brainglobe-atlasapi/atlases", {.versions = true}},
    {"templateflow", "$TEMPLATEFLOW_HOME", {.depth = 2, .patterns = segmentations, .cut = "_dseg"}},
    {"templateflow", "$XDG_CACHE_HOME/templateflow", {.depth = 2, .patterns = segmentations, .cut = "_dseg"}},
    {"afni", "$AFNI_ATLAS_PATH", {0}},
    {"afni", "$AFNI_SUPP_ATLAS_DIR", {0}},
    {"afni", "$AFNI_PLUGINPATH", {0}},
    {"afni", "(afni)", {0}},
    {"afni", "$XDG_DATA_DIRS/afni/atlases", {0}},
    {"spm", "$SPM_DIR/tpm", {0}},
    {"spm", "$SPM_DIR/atlas", {0}},
    {"spm", "$SPM_DIR/toolbox/AAL3", {0}},
    {"cat12", "$SPM_DIR/toolbox/cat12", {.depth = 1}},
    {"nilearn", "$NILEARN_SHARED_DATA", {.depth = 4}},
    {"nilearn", "$NILEARN_DATA", {.depth = 4}},
    {"nilearn", "$HOME/nilearn_data", {.depth = 4}},
    {"mricrogl", "$MRICROGL_DIR/atlas", {0}},
    {"mricrogl", "$MRICROGL_DIR/Resources/atlas", {0}},
    {"mricrogl", "(MRIcroGL)/Resources/atlas", {0}},
    {"mricrogl", "$XDG_DATA_DIRS/MRIcroGL/Resources/atlas", {0}},
};

static struct text variable(struct text name)
{
    char text[64] = "";
    memcpy(text, name.data, name.size < sizeof text ? name.size : sizeof text - 1);
    const char *value = getenv(text);
    return text_from(value ? value : "");
}

/* The XDG base directories without their variables; those in $HOME are relative to it. */
static const struct {
    const char *name, *value;
    bool in_home;
} defaults[] = {{"XDG_DATA_DIRS", "/usr/local/share:/usr/share", false},
                {"XDG_DATA_HOME", "/.local/share", true},
                {"XDG_CACHE_HOME", "/.cache", true}};

/* The real folder of the program, which may be a link; nothing where it is not installed. */
static void append_program_folder(struct buffer *out, struct text program)
{
    struct text path = variable(text_from("PATH"));
    struct text folder;
    for (bool more = true; text_field(&path, ':', &more, &folder);) {
        char file[PATH_MAX];
        char real[PATH_MAX];
        int size =
            snprintf(file, sizeof file, "%.*s/%.*s", (int)folder.size, folder.data, (int)program.size, program.data);
        if (folder.size && size < PATH_MAX && access(file, X_OK) == 0 && realpath(file, real) && file_exists(real)) {
            buffer_append(out, real, (size_t)(strrchr(real, '/') - real));
            return;
        }
    }
}

/* The value of the key in the section of an INI file; the last, as Python's configparser takes it. */
static struct text find_setting(struct text text, const char *section, const char *key)
{
    struct text found = {0};
    struct text line;
    bool inside = false;
    while (text_line(&text, &line)) {
        line = text_trim(line);
        size_t at = 0;
        while (at < line.size && line.data[at] != '=' && line.data[at] != ':') {
            at++;
        }
        if (line.size && line.data[0] == '[') {
            inside = text_equal(line, section);
        } else if (inside && at < line.size && text_equal_ignoring_case(text_trim((struct text){line.data, at}), key)) {
            found = text_trim((struct text){line.data + at + 1, line.size - at - 1});
        }
    }
    return found;
}

/* The folder that BrainGlobe's settings name; nothing where there are none. */
static void append_brainglobe_folder(struct buffer *out)
{
    struct bytes bytes = {0};
    struct buffer path = {0};
    struct text own = variable(text_from("BRAINGLOBE_CONFIG_DIR"));
    struct text home = variable(text_from("HOME"));
    buffer_append(&path, own.size ? own.data : home.data, own.size ? own.size : home.size);
    buffer_text(&path, own.size ? "/bg_config.conf" : "/.config/brainglobe/bg_config.conf");
    if (!buffer_status(&path) && file_exists(path.data) && !file_read(&bytes, path.data, SETTINGS_LIMIT)) {
        struct text folder = find_setting(text_from_bytes(bytes.data, bytes.size), "[default_dirs]", "brainglobe_dir");
        bool in_home = text_starts(folder, "~/");
        buffer_append(out, home.data, in_home ? home.size : 0);
        buffer_append(out, folder.data + in_home, folder.size - in_home);
    }
    out->failed = out->failed || path.failed;
    buffer_finish(&path);
    bytes_finish(&bytes);
}

/* Expands the beginning of the rule to folders with ':' between them; *rest is the remainder. */
static void expand_rule(struct buffer *out, const char **rest, const char *rule)
{
    size_t length = rule[0] == '(' ? strcspn(rule, ")") : strcspn(rule, "/");
    struct text name = {rule + 1, length - 1};
    *rest = rule + length + (rule[0] == '(');
    if (text_equal(name, "bg_config.conf")) {
        append_brainglobe_folder(out);
        return;
    }
    if (rule[0] == '(') {
        append_program_folder(out, name);
        return;
    }
    struct text value = variable(name);
    struct text home = variable(text_from("HOME"));
    buffer_append(out, value.data, value.size);
    for (size_t i = 0; !value.size && i < sizeof defaults / sizeof defaults[0]; i++) {
        if (text_equal(name, defaults[i].name) && (!defaults[i].in_home || home.size)) {
            buffer_append(out, home.data, defaults[i].in_home ? home.size : 0);
            buffer_text(out, defaults[i].value);
        }
    }
}

/* Notes a place, and takes its path over. */
static conus_status note_place(conus_catalogue *catalogue, const struct place *place, char *path)
{
    bool fine = path && memory_reserve(&catalogue->places, &catalogue->place_capacity, catalogue->place_count + 1,
                                       sizeof *catalogue->places);
    if (!fine) {
        memory_free(path);
        return CONUS_ERROR_MEMORY;
    }
    catalogue->places[catalogue->place_count++] =
        (conus_catalogue_place){place->source, place->rule, path, file_is_folder(path)};
    return CONUS_OK;
}

/* Looks in each of the folders, which are separated by ':'. */
static conus_status look_in_all(conus_catalogue *catalogue, const struct place *place, struct text folders,
                                const char *rest)
{
    conus_status status = CONUS_OK;
    struct text folder;
    for (bool more = true; !status && text_field(&folders, ':', &more, &folder);) {
        if (folder.size) {
            struct buffer path = {0};
            buffer_append(&path, folder.data, folder.size);
            buffer_text(&path, rest);
            const char *kept = path.data;
            status = buffer_status(&path);
            status = status ? (buffer_finish(&path), status) : note_place(catalogue, place, path.data);
            status = status                ? status
                     : place->how.subjects ? freesurfer_look(catalogue, kept)
                     : place->how.versions ? brainglobe_look(catalogue, kept)
                                           : folder_look(catalogue, kept, &place->how);
        }
    }
    return status;
}

static conus_status look_at_place(conus_catalogue *catalogue, const struct place *place)
{
    struct buffer folders = {0};
    const char *rest;
    expand_rule(&folders, &rest, place->rule);
    conus_status status = buffer_status(&folders);
    if (!status && !folders.size) {
        status = note_place(catalogue, place, memory_text("", 0));
    } else if (!status) {
        status = look_in_all(catalogue, place, (struct text){folders.data, folders.size}, rest);
    }
    buffer_finish(&folders);
    return status;
}

conus_status conus_catalogue_create(conus_catalogue **out, const conus_catalogue_options *options)
{
    if (!out) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_catalogue_create: a result is needed");
    }
    conus_catalogue *catalogue = memory_zeroed(1, sizeof *catalogue);
    if (!catalogue) {
        return CONUS_ERROR_MEMORY;
    }
    options = options_of(conus_catalogue_options, options);
    catalogue->sink = (struct note_sink){.log = options->log, .user = options->log_user};
    catalogue->notes.sink = &catalogue->sink;
    conus_status status = CONUS_OK;
    bool before = file_trace_search(true);
    for (size_t i = 0; !status && i < sizeof places / sizeof places[0]; i++) {
        if (!catalogue->source || strcmp(catalogue->source, places[i].source) != 0) {
            catalogue->source = places[i].source;
            catalogue->first = catalogue->count;
            catalogue->seen = 0;
            catalogue->full = false;
            catalogue->folder_count = 0;
        }
        status = look_at_place(catalogue, &places[i]);
    }
    file_trace_search(before);
    if (status) {
        conus_catalogue_destroy(catalogue);
        return status;
    }
    catalogue->notes.sink = NULL;
    *out = catalogue;
    return CONUS_OK;
}
