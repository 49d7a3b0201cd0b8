/* SPDX-License-Identifier: BSD-3-Clause */
/* Where programs keep their atlases. A new place is a line of the table. */
#include "loaders/catalogue/catalogue.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/system/system.h"
#include "conus/own.h"

#include <stdlib.h>
#include <string.h>

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
    {"fsl", "$FSLDIR/data/standard", {0}},
    {"fsl", "$XDG_DATA_DIRS/fsl/data/standard", {0}},
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

/* What the environment says, "" where it does not. */
static struct text variable(struct job *job, struct text name)
{
    const char *value = system_variable(job_copy(job, name));
    return text_from(value ? value : "");
}

/* The XDG base directories without their variables; those in $HOME are relative to it. */
static const struct {
    const char *name, *value;
    bool in_home;
} defaults[] = {{"XDG_DATA_DIRS", SYSTEM_DATA_FOLDERS, false},
                {"XDG_DATA_HOME", "/.local/share", true},
                {"XDG_CACHE_HOME", "/.cache", true}};

/* The real folder of the program, which may be a link; "" where it is not installed. */
static const char *program_folder(struct job *job, struct text program)
{
    struct text path = variable(job, text_from("PATH"));
    struct text folder;
    for (bool more = true; text_field(&path, SYSTEM_LIST, &more, &folder);) {
        char real[SYSTEM_PATH];
        const char *file = job_format(job, "%.*s/%.*s", (int)folder.size, folder.data, (int)program.size, program.data);
        if (folder.size && system_allows(file, SYSTEM_RUN) && system_real_path(real, file) && job_has_file(job, real)) {
            return job_format(job, "%.*s", (int)(strrchr(real, '/') - real), real);
        }
    }
    return "";
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

/* The folder that BrainGlobe's settings name; "" where there are none. */
static const char *brainglobe_folder(struct job *job)
{
    const char *own = variable(job, text_from("BRAINGLOBE_CONFIG_DIR")).data;
    const char *home = variable(job, text_from("HOME")).data;
    const char *path =
        job_format(job, "%s%s", own[0] ? own : home, own[0] ? "/bg_config.conf" : "/.config/brainglobe/bg_config.conf");
    struct job reading = {0}; /* whose errors do not matter, a file that is too large for instance */
    struct bytes bytes = job_has_file(job, path) ? job_read(&reading, path, SETTINGS_LIMIT, "") : (struct bytes){0};
    struct text folder = find_setting(text_from_bytes(bytes.data, bytes.size), "[default_dirs]", "brainglobe_dir");
    bool in_home = text_starts(folder, "~/");
    const char *found = "";
    if (folder.size) {
        found = job_format(job, "%s%.*s", in_home ? home : "", (int)folder.size - in_home, folder.data + in_home);
    }
    job_end(&reading);
    return found;
}

/* Expands the beginning of the rule to folders with ':' between them; *rest is the remainder. */
static struct text expand_rule(struct job *job, const char **rest, const char *rule)
{
    bool is_file = rule[0] == '(';
    size_t length = strcspn(rule, is_file ? ")" : "/");
    struct text name = {rule + 1, length - 1};
    *rest = rule + length + is_file;
    if (is_file) {
        return text_from(text_equal(name, "bg_config.conf") ? brainglobe_folder(job) : program_folder(job, name));
    }
    struct text folders = variable(job, name);
    struct text home = variable(job, text_from("HOME"));
    for (size_t i = 0; !folders.size && i < sizeof defaults / sizeof defaults[0]; i++) {
        if (text_equal(name, defaults[i].name) && (!defaults[i].in_home || home.size)) {
            return text_from(job_format(job, "%s%s", defaults[i].in_home ? home.data : "", defaults[i].value));
        }
    }
    return folders;
}

static const char *note_place(conus_catalogue *catalogue, const struct place *place, struct text folder,
                              const char *rest)
{
    const char *path = job_format(&catalogue->job, "%.*s%s", (int)folder.size, folder.data, rest);
    *LIST_ADD(&catalogue->job, &catalogue->places) =
        (conus_catalogue_place){place->source, place->rule, path, file_is_folder(path)};
    return path;
}

static conus_status look_at_place(conus_catalogue *catalogue, const struct place *place)
{
    struct job job = {0};
    const char *rest;
    struct text folder;
    struct text folders = expand_rule(&job, &rest, place->rule);
    if (!folders.size) {
        (void)note_place(catalogue, place, folders, "");
    }
    for (bool more = true; text_field(&folders, SYSTEM_LIST, &more, &folder);) {
        if (folder.size) {
            const char *path = note_place(catalogue, place, folder, rest);
            if (place->how.subjects) {
                freesurfer_look(&job, catalogue, path);
            } else if (place->how.versions) {
                brainglobe_look(&job, catalogue, path);
            } else {
                folder_look(&job, catalogue, path, &place->how);
            }
        }
    }
    return job_close(&job, NULL, NULL);
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
    catalogue->job.sink = &catalogue->sink;
    conus_status status = CONUS_OK;
    bool before = inputs_search(true);
    for (size_t i = 0; !status && i < sizeof places / sizeof places[0]; i++) {
        const char *source = catalogue->source.name;
        if (!source || strcmp(source, places[i].source) != 0) {
            catalogue->source = (struct catalogue_source){
                .name = places[i].source, .first = catalogue->items.count, .first_image = catalogue->images.count};
        }
        status = look_at_place(catalogue, &places[i]);
    }
    inputs_search(before);
    catalogue->job.sink = NULL;
    if (!status && job_ok(&catalogue->job)) {
        *out = catalogue;
        return CONUS_OK;
    }
    status = status ? status : job_close(&catalogue->job, NULL, NULL);
    conus_catalogue_destroy(catalogue);
    return status;
}
